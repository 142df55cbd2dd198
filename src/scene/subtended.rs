//! Points of an emitter chosen evenly over the solid angle that it subtends, for the forms where that has a closed form.
//!
//! Compared with points chosen evenly by area this leaves no noise of distance and slant, and of a ball none of the half
//! that is turned away.

use crate::math::frame::Frame;
use crate::math::functions::{acos, asin, sin_cos};
use crate::math::tolerance::{BALL_HORIZON, LEAST_SOLID_ANGLE, SIMILARITY};
use crate::math::warp;
use glam::{DVec2, DVec3};
use std::f64::consts::TAU;

/// A rectangle as it is seen from a point.
///
/// Source: [Urena2013](crate::references#urena2013).
#[derive(Clone, Copy, Debug)]
pub(super) struct SeenRectangle {
    from: DVec3,
    /// Unit vectors along the edges, and the normal that points away from the viewer.
    axes: [DVec3; 3],
    /// The rectangle in coordinates along the axes round the viewer.
    low: DVec2,
    high: DVec2,
    /// Distance of its plane as a coordinate along the third axis: negative.
    z: f64,
    /// Heights of the normals of two faces of the pyramid over it.
    b0: f64,
    b1: f64,
    /// The angle at which the sampled one begins.
    k: f64,
    solid_angle: f64,
}

impl SeenRectangle {
    /// The rectangle with this corner and these edges, seen from `from`; `None` if its edges are not at right angles, or it
    /// looks too small, or the point is in its plane.
    pub(super) fn new(from: DVec3, corner: DVec3, edges: [DVec3; 2]) -> Option<Self> {
        let lengths = edges.map(DVec3::length);
        let [x, y] = [edges[0] / lengths[0], edges[1] / lengths[1]];
        if x.dot(y).abs() > SIMILARITY {
            return None;
        }
        let mut normal = x.cross(y);
        let to_corner = corner - from;
        let mut z = to_corner.dot(normal);
        if z > 0.0 {
            (z, normal) = (-z, -normal);
        }
        let low = DVec2::new(to_corner.dot(x), to_corner.dot(y));
        let high = low + DVec2::new(lengths[0], lengths[1]);

        // The faces of the pyramid from the viewer over the rectangle, round from low y: of their normals only the part along
        // the axis is needed, since neighbours share no other.
        let face = |edge: f64| edge / (edge * edge + z * z).sqrt();
        let faces = [face(-low.y), face(high.x), face(high.y), face(-low.x)];
        if faces.iter().any(|part| part.is_nan()) {
            return None;
        }
        let angle = |i: usize| acos((-faces[i] * faces[(i + 1) % 4]).clamp(-1.0, 1.0));
        let k = TAU - angle(2) - angle(3);
        let solid_angle = angle(0) + angle(1) - k;
        (solid_angle >= LEAST_SOLID_ANGLE).then_some(Self {
            from,
            axes: [x, y, normal],
            low,
            high,
            z,
            b0: faces[0],
            b1: faces[2],
            k,
            solid_angle,
        })
    }

    /// Steradian.
    pub(super) fn solid_angle(&self) -> f64 {
        self.solid_angle
    }

    /// A point of the rectangle from a point of the unit square.
    pub(super) fn sample(&self, u: [f64; 2]) -> DVec3 {
        // The column of points with this x cuts off the share u[0] of the solid angle.
        let angle = u[0] * self.solid_angle + self.k;
        let (sin, cos) = sin_cos(angle);
        let f = (cos * self.b0 - self.b1) / sin;
        let c = (1.0 / (f * f + self.b0 * self.b0).sqrt())
            .copysign(f)
            .clamp(-1.0, 1.0);
        let x = -(c * self.z) / (1.0 - c * c).max(f64::MIN_POSITIVE).sqrt();
        let x = x.clamp(self.low.x, self.high.x);

        // Along that column the solid angle grows with the height of the unit vector.
        let distance = (x * x + self.z * self.z).sqrt();
        let height = |y: f64| y / (distance * distance + y * y).sqrt();
        let (low, high) = (height(self.low.y), height(self.high.y));
        let h = low + u[1] * (high - low);
        let y = h * distance / (1.0 - h * h).max(f64::MIN_POSITIVE).sqrt();
        let y = y.clamp(self.low.y, self.high.y);
        let [axis_x, axis_y, axis_z] = self.axes;
        self.from + axis_x * x + axis_y * y + axis_z * self.z
    }
}

/// A ball as it is seen from a point outside.
#[derive(Clone, Copy, Debug)]
pub(super) struct SeenBall {
    from: DVec3,
    center: DVec3,
    radius: f64,
    /// Distance of the centre, larger than the radius.
    distance: f64,
    /// Half of the angle it subtends, radians.
    half_angle: f64,
}

impl SeenBall {
    /// The ball round `center`, seen from `from`; `None` from inside or too near to its surface.
    pub(super) fn new(from: DVec3, center: DVec3, radius: f64) -> Option<Self> {
        let distance = (center - from).length();
        let sine = radius / distance;
        // Nearer than that rounding could bring the cone's edge past the horizon.
        (sine < 1.0 - BALL_HORIZON).then(|| Self {
            from,
            center,
            radius,
            distance,
            half_angle: asin(sine),
        })
    }

    /// Steradian.
    pub(super) fn solid_angle(&self) -> f64 {
        warp::cone_solid_angle(self.half_angle)
    }

    /// A point of the near side and the outward normal there, from a point of the unit square.
    pub(super) fn sample(&self, u: [f64; 2]) -> (DVec3, DVec3) {
        let local = warp::cone(DVec2::from_array(u), self.half_angle);
        let toward = (self.center - self.from) / self.distance;
        let w = Frame::from_normal(toward).to_world(local);
        // Where the ray along w meets the ball first; the angle at the centre gives the normal without cancellation.
        let sine = (1.0 - local.z * local.z).max(0.0).sqrt();
        let across = self.distance * sine;
        let along = self.distance * local.z
            - (self.radius * self.radius - across * across)
                .max(0.0)
                .sqrt();
        let normal = (self.from + w * along - self.center).normalize_or(-toward);
        (self.center + normal * self.radius, normal)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Solid angle of a rectangle by brute force, and the means of two functions of direction over it.
    fn by_area(from: DVec3, corner: DVec3, edges: [DVec3; 2]) -> (f64, DVec3) {
        let normal = edges[0].cross(edges[1]).normalize();
        let area = edges[0].cross(edges[1]).length();
        let n = 800;
        let (mut solid_angle, mut mean) = (0.0, DVec3::ZERO);
        for i in 0..n * n {
            let (u, v) = (
                (f64::from(i % n) + 0.5) / f64::from(n),
                (f64::from(i / n) + 0.5) / f64::from(n),
            );
            let to = corner + edges[0] * u + edges[1] * v - from;
            let share =
                area / f64::from(n * n) * to.normalize().dot(normal).abs() / to.length_squared();
            solid_angle += share;
            mean += to.normalize() * share;
        }
        (solid_angle, mean / solid_angle)
    }

    #[test]
    fn rectangles_are_sampled_evenly_over_their_solid_angle() {
        let turn = glam::DQuat::from_euler(glam::EulerRot::XYZ, 0.3, -1.1, 2.0);
        for (from, corner, a, b) in [
            (DVec3::ZERO, DVec3::new(-1.0, -1.0, 1.0), 2.0, 2.0),
            (DVec3::ZERO, DVec3::new(0.4, 0.2, -0.7), 1.5, 0.3),
            (
                DVec3::new(5.0, 2.0, 0.1),
                DVec3::new(-3.0, 1.0, 0.0),
                10.0,
                4.0,
            ),
            (DVec3::ZERO, DVec3::new(10.0, 10.0, 3.0), 4.0, 4.0),
        ] {
            let (from, corner) = (turn * from, turn * corner);
            let edges = [turn * (DVec3::X * a), turn * (DVec3::Y * b)];
            let seen = SeenRectangle::new(from, corner, edges).unwrap();
            let (solid_angle, mean) = by_area(from, corner, edges);
            assert!(
                (seen.solid_angle() / solid_angle - 1.0).abs() < 2e-3,
                "{solid_angle}"
            );
            let n = 300;
            let mut found = DVec3::ZERO;
            for i in 0..n * n {
                let u = [
                    (f64::from(i % n) + 0.5) / f64::from(n),
                    (f64::from(i / n) + 0.5) / f64::from(n),
                ];
                let point = seen.sample(u);
                let inside = point - corner;
                for (edge, length) in edges.iter().zip([a, b]) {
                    let along = inside.dot(*edge) / length;
                    assert!((-1e-9..=length + 1e-9).contains(&along), "{along}");
                }
                assert!(inside.dot(edges[0].cross(edges[1])).abs() < 1e-8);
                found += (point - from).normalize() / f64::from(n * n);
            }
            assert!((found - mean).length() < 1e-3, "{found} {mean}");
        }
        // A face of a cube round the viewer is a sixth of all directions.
        let cube = SeenRectangle::new(
            DVec3::ZERO,
            DVec3::new(-1.0, -1.0, 1.0),
            [DVec3::X * 2.0, DVec3::Y * 2.0],
        );
        assert!((cube.unwrap().solid_angle() - 2.0 * TAU / 6.0).abs() < 1e-12);
    }

    #[test]
    fn what_has_no_closed_form_is_left_to_areas() {
        let corner = DVec3::new(-1.0, -1.0, 1.0);
        let slanted = [DVec3::X, DVec3::new(0.5, 1.0, 0.0)];
        assert!(SeenRectangle::new(DVec3::ZERO, corner, slanted).is_none());
        let square = [DVec3::X, DVec3::Y];
        assert!(SeenRectangle::new(DVec3::Z * 1e4, corner, square).is_none());
        assert!(SeenRectangle::new(DVec3::new(4.0, 4.0, 1.0), corner, square).is_none());
        assert!(SeenRectangle::new(corner, corner, square).is_none());
        assert!(SeenBall::new(DVec3::X * 0.5, DVec3::ZERO, 1.0).is_none());
        assert!(SeenBall::new(DVec3::X, DVec3::ZERO, 1.0).is_none());
    }

    #[test]
    fn balls_are_sampled_on_the_side_that_is_seen() {
        let center = DVec3::new(3.0, -2.0, 7.0);
        for (radius, distance) in [(1.0, 1.001), (1.0, 4.0), (1e-4, 1e3)] {
            let from = center + DVec3::new(2.0, 1.0, -2.0) / 3.0 * distance;
            let ball = SeenBall::new(from, center, radius).unwrap();
            let half: f64 = (radius / distance).asin();
            let exact = TAU * 2.0 * (half / 2.0).sin().powi(2);
            assert!((ball.solid_angle() / exact - 1.0).abs() < 1e-6);
            for i in 0..1000 {
                let u = [(f64::from(i % 32) + 0.5) / 32.0, f64::from(i) / 1000.0];
                let (point, normal) = ball.sample(u);
                assert!(((point - center).length() / radius - 1.0).abs() < 1e-9);
                assert!((point - center).normalize().dot(normal) > 1.0 - 1e-9);
                assert!(
                    normal.dot(from - point) > -1e-6 * distance,
                    "{radius} {u:?}"
                );
            }
        }
    }
}
