//! A view that shows the whole of something.

use super::View;
use crate::math::Bounds3;
use crate::math::angle::Angle;
use glam::DVec3;

/// Room left round what is framed, as a part of its size.
const MARGIN: f64 = 0.06;

/// Looks at `bounds` from the south-east and a little above, near enough that all of it fills the picture.
///
/// Empty bounds are taken as a ball of 1 m round the origin. `aspect` is width over height; `up` is +z.
pub fn frame(bounds: &Bounds3, fov: Angle, aspect: f64) -> View {
    let towards_eye = DVec3::new(0.5, -1.0, 0.35).normalize();
    frame_from(bounds, towards_eye, fov, aspect)
}

/// Looks at `bounds` from the direction `towards_eye` (unit, not vertical).
///
/// The eye moves out until each of the eight corners lies inside the picture, so a tall thing fills a tall picture and
/// a wide one a wide picture.
pub fn frame_from(bounds: &Bounds3, towards_eye: DVec3, fov: Angle, aspect: f64) -> View {
    let (min, max) = if bounds.is_empty() {
        (DVec3::splat(-1.0), DVec3::splat(1.0))
    } else {
        (bounds.min, bounds.max)
    };
    let target = min + (max - min) / 2.0;
    let half = (max - min) / 2.0;
    let right = (-towards_eye).cross(DVec3::Z).normalize();
    let top = right.cross(-towards_eye);
    let tan_up = fov.half().tan();
    let tan_right = tan_up * aspect;

    // For each corner: how far out the eye must be for that corner to stay within the edges of the picture.
    let mut distance = 0.0_f64;
    for sign in CORNER_SIGNS {
        let corner = half * sign;
        let nearer = corner.dot(towards_eye);
        let sideways = corner.dot(right).abs() / tan_right;
        let upwards = corner.dot(top).abs() / tan_up;
        distance = distance.max(nearer + sideways.max(upwards) * (1.0 + MARGIN));
    }

    // A single point has no size; 1 m is as good a distance as any.
    let distance = if distance > 0.0 { distance } else { 1.0 };
    View {
        eye: target + towards_eye * distance,
        target,
        up: DVec3::Z,
        fov,
    }
}

const CORNER_SIGNS: [DVec3; 8] = {
    let mut signs = [DVec3::ONE; 8];
    let mut i = 0;
    while i < 8 {
        signs[i] = DVec3::new(
            if i & 1 == 0 { -1.0 } else { 1.0 },
            if i & 2 == 0 { -1.0 } else { 1.0 },
            if i & 4 == 0 { -1.0 } else { 1.0 },
        );
        i += 1;
    }
    signs
};

#[cfg(test)]
mod tests {
    use super::*;
    use crate::camera::Camera;

    /// Film coordinates of a point, by the geometry of the view (not by the camera's own code).
    fn film(view: &View, aspect: f64, point: DVec3) -> (f64, f64) {
        let forward = (view.target - view.eye).normalize();
        let right = forward.cross(view.up).normalize();
        let up = right.cross(forward);
        let d = point - view.eye;
        let tan = view.fov.half().tan();
        let depth = d.dot(forward);
        (
            d.dot(right) / depth / (tan * aspect),
            d.dot(up) / depth / tan,
        )
    }

    #[test]
    fn all_corners_are_inside_and_one_is_near_the_edge() {
        for (min, max) in [
            (DVec3::new(-1.0, -1.0, 0.0), DVec3::new(1.0, 1.0, 30.0)),
            (DVec3::new(-50.0, -40.0, 0.0), DVec3::new(50.0, 40.0, 3.0)),
            (DVec3::splat(1e6), DVec3::splat(1e6 + 1.0)),
            (DVec3::splat(-1e-6), DVec3::splat(1e-6)),
        ] {
            for aspect in [0.5, 1.0, 16.0 / 9.0] {
                let bounds = Bounds3 { min, max };
                let view = frame(&bounds, Angle::deg(40.0), aspect);
                assert!(Camera::perspective(&view, aspect).is_ok());
                let mut widest = 0.0_f64;
                for i in 0..8 {
                    let pick = |bit: u32, a: f64, b: f64| if i & (1 << bit) == 0 { a } else { b };
                    let corner = DVec3::new(
                        pick(0, min.x, max.x),
                        pick(1, min.y, max.y),
                        pick(2, min.z, max.z),
                    );
                    let (x, y) = film(&view, aspect, corner);
                    widest = widest.max(x.abs()).max(y.abs());
                }
                assert!(
                    widest < 1.0 && widest > 0.9,
                    "{bounds:?} {aspect}: {widest}"
                );
            }
        }
    }

    #[test]
    fn nothing_and_a_single_point_are_framed_too() {
        let point = Bounds3 {
            min: DVec3::ONE,
            max: DVec3::ONE,
        };
        for bounds in [Bounds3::EMPTY, point] {
            let view = frame(&bounds, Angle::deg(40.0), 1.0);
            assert!(Camera::perspective(&view, 1.0).is_ok());
        }
    }
}
