//! Curved shapes and boxes in their simplest frame: every placed sphere, disk, frustum or box is the affine image of one
//! of these.
//!
//! Folding sizes into the affine map keeps every number here near 1, whatever the size of the shape, and needles and
//! flakes are no worse than balls.

use super::interval::{Interval, Line};
use super::quadratic::roots;
use crate::math::Bounds3;
use crate::math::functions::{acos, atan2};
use crate::math::tolerance::RIM_OVERLAP;
use glam::{DAffine3, DVec2, DVec3};
use std::f64::consts::PI;

/// A shape of unit size.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum UnitShape {
    /// The sphere of radius 1 round the origin.
    Sphere,
    /// The disk of radius 1 in the plane z = 0; its front looks along +z.
    Disk,
    /// The cube -1..=1 in all three coordinates.
    Cube,
    /// A body of revolution round z from z = 0 to z = 1.
    Frustum(UnitFrustum),
}

/// A frustum whose larger radius and whose length are 1.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct UnitFrustum {
    /// Radius at z = 0, in 0..=1.
    pub base: f64,
    /// Radius at z = 1, in 0..=1.
    pub top: f64,
    /// Whether the disks at z = 0 and z = 1 are there.
    pub caps: [bool; 2],
    /// Length per larger radius of the shape it stands for, before any placement.
    pub aspect: f64,
}

/// The part of a unit shape that was hit.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Face {
    /// The only surface of a shape, or the side of a frustum.
    #[default]
    Side,
    /// The disk of a frustum at z = 0.
    Base,
    /// The disk of a frustum at z = 1.
    Top,
    /// A face of a cube: axis 0..=2, and whether it is the one at +1.
    Cube(u8, bool),
}

/// A point on a unit shape.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct UnitPoint {
    /// The point, moved onto the surface.
    pub position: DVec3,
    /// Unit normal of the front: outwards, or +z for the disk.
    pub normal: DVec3,
    /// Texture coordinates in 0..=1, u to the right and v upwards in the image, as GroIMP lays them out.
    ///
    /// Round shapes: turns round z from +x through +y, and height (of the sphere the angle from -z, per half turn). Disks
    /// and the faces of a cube: the square round them, seen from outside, so that the image is not mirrored; u runs along
    /// x on the disks and on the faces across y and z, along the rim on those across x.
    pub uv: DVec2,
}

impl UnitShape {
    /// Where `line` first meets the surface within `interval`.
    #[inline]
    #[must_use]
    pub fn intersect(&self, line: &Line, interval: Interval) -> Option<(f64, Face)> {
        match self {
            Self::Sphere => intersect_sphere(line, interval).map(|t| (t, Face::Side)),
            Self::Disk => intersect_disk(line, 0.0, 1.0, interval).map(|t| (t, Face::Side)),
            Self::Cube => intersect_cube(line, interval),
            Self::Frustum(frustum) => frustum.intersect(line, interval),
        }
    }

    /// The largest value of `normal · p` over its points p.
    #[must_use]
    pub fn reach(&self, normal: DVec3) -> f64 {
        match self {
            Self::Sphere => normal.length(),
            Self::Disk => normal.truncate().length(),
            Self::Cube => normal.abs().element_sum(),
            Self::Frustum(frustum) => {
                let sideways = normal.truncate().length();
                (frustum.base * sideways).max(frustum.top * sideways + normal.z)
            }
        }
    }

    /// Whether the surface lies in one plane, so that a ray that starts on it cannot meet it again.
    #[must_use]
    pub fn is_flat(&self) -> bool {
        matches!(self, Self::Disk)
    }

    /// Whether it bounds a body on all sides.
    #[must_use]
    pub fn is_closed(&self) -> bool {
        match self {
            Self::Sphere | Self::Cube => true,
            Self::Disk => false,
            Self::Frustum(UnitFrustum {
                base, top, caps, ..
            }) => (caps[0] || *base <= 0.0) && (caps[1] || *top <= 0.0),
        }
    }

    /// The point of `face` that is meant by `near`, a point computed with rounding errors.
    ///
    /// It keeps at least `margin` (in units of this frame, far below 1) away from the edges of the face: where two faces
    /// meet, a point that is off by a rounding could lie on the wrong side of the other face.
    #[must_use]
    pub fn point(&self, face: Face, near: DVec3, margin: f64) -> UnitPoint {
        self.point_with(face, near, margin, true)
    }

    /// The same, with texture coordinates of what is round only if they are wanted: they are dear. They are 0 otherwise.
    #[must_use]
    pub fn point_with(&self, face: Face, near: DVec3, margin: f64, has_uv: bool) -> UnitPoint {
        match (self, face) {
            (Self::Sphere, _) => sphere_point(near, has_uv),
            (Self::Disk, _) => disk_point(near, 0.0, 1.0, DVec3::Z),
            (Self::Frustum(frustum), Face::Base) => {
                let inside = near
                    .truncate()
                    .clamp_length_max(frustum.base * (1.0 - margin));
                disk_point(inside.extend(0.0), 0.0, frustum.base, DVec3::NEG_Z)
            }
            (Self::Frustum(frustum), Face::Top) => {
                let inside = near
                    .truncate()
                    .clamp_length_max(frustum.top * (1.0 - margin));
                disk_point(inside.extend(1.0), 1.0, frustum.top, DVec3::Z)
            }
            (Self::Frustum(frustum), _) => frustum.side_point(near, margin, has_uv),
            (Self::Cube, face) => cube_point(face, near, margin),
        }
    }

    /// The smallest box that holds the image of the shape under `map`.
    #[must_use]
    pub fn bounds_under(&self, map: &DAffine3) -> Bounds3 {
        let [x, y, z] = [map.matrix3.x_axis, map.matrix3.y_axis, map.matrix3.z_axis];
        // The extent of an ellipse or ellipsoid along an axis is the root of the summed squares of its radii there.
        let rows = map.matrix3.transpose();
        let rows = [rows.x_axis, rows.y_axis, rows.z_axis];
        let disk = |height: f64, radius: f64| {
            let center = map.translation + z * height;
            let reach = DVec3::from_array(rows.map(|row| row.truncate().length())) * radius;
            Bounds3 {
                min: center - reach,
                max: center + reach,
            }
        };
        let around = |reach: DVec3| Bounds3 {
            min: map.translation - reach,
            max: map.translation + reach,
        };
        match self {
            Self::Sphere => around(DVec3::from_array(rows.map(DVec3::length))),
            Self::Cube => around(x.abs() + y.abs() + z.abs()),
            Self::Disk => disk(0.0, 1.0),
            Self::Frustum(frustum) => disk(0.0, frustum.base).union(&disk(1.0, frustum.top)),
        }
    }
}

impl UnitFrustum {
    /// The radius at height `z`.
    #[inline]
    fn radius(&self, z: f64) -> f64 {
        self.base + (self.top - self.base) * z
    }

    fn intersect(&self, line: &Line, interval: Interval) -> Option<(f64, Face)> {
        let mut best: Option<(f64, Face)> = None;
        let mut offer = |t: Option<f64>, face| {
            if let Some(t) = t
                && best.is_none_or(|(nearest, _)| t < nearest)
            {
                best = Some((t, face));
            }
        };
        offer(self.intersect_side(line, interval), Face::Side);
        if self.caps[0] {
            offer(intersect_disk(line, 0.0, self.base, interval), Face::Base);
        }
        if self.caps[1] {
            offer(intersect_disk(line, 1.0, self.top, interval), Face::Top);
        }
        best
    }

    /// Solves x² + y² = radius(z)² along the line.
    fn intersect_side(&self, line: &Line, interval: Interval) -> Option<f64> {
        // A start far away costs digits: begin at the point nearest to the middle instead. A start near the surface keeps
        // its place, because only then the sign of the near root is reliable.
        let d = line.direction;
        let to_middle = DVec3::new(0.0, 0.0, 0.5) - line.origin;
        let shift = if to_middle.length_squared() > 16.0 {
            to_middle.dot(d) / d.length_squared()
        } else {
            0.0
        };
        let o = line.at(shift);

        let slope = self.top - self.base;
        let (o2, d2) = (o.truncate(), d.truncate());
        let (radius, growth) = (self.radius(o.z), slope * d.z);
        let a = d2.length_squared() - growth * growth;
        let b = o2.dot(d2) - radius * growth;
        let c = o2.length_squared() - radius * radius;
        // b² - a·c, rearranged so that the large terms have already cancelled.
        let reach = (d2 * radius - o2 * growth).length();
        let miss = o2.perp_dot(d2).abs();
        let apart = (reach - miss) * (reach + miss);

        roots(a, b, c, apart).into_iter().find_map(|root| {
            let z = o.z + root * d.z;
            let on_side = (-RIM_OVERLAP..=1.0 + RIM_OVERLAP).contains(&z);
            let t = shift + root;
            (on_side && interval.contains(t)).then_some(t)
        })
    }

    fn side_point(&self, near: DVec3, margin: f64, has_uv: bool) -> UnitPoint {
        let z = near.z.clamp(margin, 1.0 - margin);
        let slope = self.top - self.base;
        let around = near.truncate().try_normalize().unwrap_or(DVec2::X);
        UnitPoint {
            position: (around * self.radius(z)).extend(z),
            normal: around.extend(-slope).normalize(),
            uv: if has_uv {
                DVec2::new(turns(around), z)
            } else {
                DVec2::ZERO
            },
        }
    }
}

fn intersect_sphere(line: &Line, interval: Interval) -> Option<f64> {
    let (o, d) = (line.origin, line.direction);
    let a = d.length_squared();
    let b = o.dot(d);
    let c = o.length_squared() - 1.0;
    // The distance from the centre to the line has no cancellation even if the start is far away (Haines2019).
    let miss = (o - d * (b / a)).length_squared();
    roots(a, b, c, a * (1.0 - miss))
        .into_iter()
        .find(|t| interval.contains(*t))
}

fn intersect_disk(line: &Line, height: f64, radius: f64, interval: Interval) -> Option<f64> {
    let t = (height - line.origin.z) / line.direction.z;
    let at = line.origin.truncate() + line.direction.truncate() * t;
    let limit = radius * (1.0 + RIM_OVERLAP);
    (interval.contains(t) && at.length_squared() <= limit * limit).then_some(t)
}

fn intersect_cube(line: &Line, interval: Interval) -> Option<(f64, Face)> {
    let (o, d) = (line.origin.to_array(), line.direction.to_array());
    let (mut enter, mut exit) = (f64::NEG_INFINITY, f64::INFINITY);
    let (mut enter_face, mut exit_face) = (Face::default(), Face::default());
    for axis in 0..3 {
        if d[axis] == 0.0 {
            if o[axis].abs() > 1.0 {
                return None;
            }
            continue;
        }
        let side = 1.0_f64.copysign(d[axis]);
        let (near, far) = ((-side - o[axis]) / d[axis], (side - o[axis]) / d[axis]);
        if near > enter {
            enter = near;
            enter_face = Face::Cube(axis as u8, side < 0.0);
        }
        if far < exit {
            exit = far;
            exit_face = Face::Cube(axis as u8, side > 0.0);
        }
    }
    if enter > exit {
        return None;
    }
    [(enter, enter_face), (exit, exit_face)]
        .into_iter()
        .find(|(t, _)| interval.contains(*t))
}

/// The angle of a direction in the plane, in turns from +x through +y, 0..=1.
fn turns(direction: DVec2) -> f64 {
    let turns = atan2(direction.y, direction.x) / (2.0 * PI);
    if turns < 0.0 { turns + 1.0 } else { turns }
}

fn sphere_point(near: DVec3, has_uv: bool) -> UnitPoint {
    let n = near.try_normalize().unwrap_or(DVec3::Z);
    let uv = if has_uv {
        DVec2::new(turns(n.truncate()), acos(-n.z) / PI)
    } else {
        DVec2::ZERO
    };
    UnitPoint {
        position: n,
        normal: n,
        uv,
    }
}

fn disk_point(near: DVec3, height: f64, radius: f64, normal: DVec3) -> UnitPoint {
    let position = near.truncate().extend(height);
    // Seen from below, y runs downwards.
    let across = near.truncate() * DVec2::new(1.0, normal.z);
    let uv = across / (2.0 * radius) + DVec2::splat(0.5);
    UnitPoint {
        position,
        normal,
        uv,
    }
}

fn cube_point(face: Face, near: DVec3, margin: f64) -> UnitPoint {
    let Face::Cube(axis, is_positive) = face else {
        return UnitPoint {
            position: near,
            normal: DVec3::Z,
            uv: DVec2::ZERO,
        };
    };
    let axis = usize::from(axis);
    let inside = DVec3::splat(1.0 - margin);
    let mut position = near.clamp(-inside, inside);
    let side = if is_positive { 1.0 } else { -1.0 };
    position[axis] = side;
    let mut normal = DVec3::ZERO;
    normal[axis] = side;
    let p = position;
    let across = match axis {
        0 => DVec2::new(side * p.y, p.z),
        1 => DVec2::new(p.x, -side * p.z),
        _ => DVec2::new(p.x, side * p.y),
    };
    UnitPoint {
        position,
        normal,
        uv: across * 0.5 + DVec2::splat(0.5),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    const ALL: Interval = Interval {
        after: 0.0,
        until: f64::INFINITY,
    };

    fn shapes() -> Vec<UnitShape> {
        let frustum = |base, top| UnitFrustum {
            base,
            top,
            caps: [true; 2],
            aspect: 1.0,
        };
        vec![
            UnitShape::Sphere,
            UnitShape::Cube,
            UnitShape::Frustum(frustum(1.0, 1.0)),
            UnitShape::Frustum(frustum(1.0, 0.0)),
            UnitShape::Frustum(frustum(0.0, 1.0)),
            UnitShape::Frustum(frustum(0.4, 1.0)),
        ]
    }

    /// Points of a regular grid inside all of the shapes, and directions all round.
    fn lines(distance: f64) -> Vec<Line> {
        let mut lines = Vec::new();
        for i in 0..4000 {
            let k = f64::from(i);
            let through = DVec3::new((k * 0.61).sin() * 0.02, (k * 0.37).cos() * 0.02, 0.5);
            let z = 1.0 - 2.0 * (k + 0.5) / 4000.0;
            let direction =
                DVec2::from_angle(k * 2.399_963).extend(0.0) * (1.0 - z * z).sqrt() + DVec3::Z * z;
            lines.push(Line {
                origin: through - direction * distance,
                direction,
            });
        }
        lines
    }

    #[test]
    fn closed_shapes_are_entered_and_left_on_their_surface() {
        for shape in shapes() {
            for distance in [5.0, 1e4, 1e9] {
                for line in lines(distance) {
                    let (enter, face) = shape.intersect(&line, ALL).unwrap_or_else(|| {
                        panic!("{shape:?} missed by {line:?}");
                    });
                    let rest = Interval {
                        after: enter,
                        until: f64::INFINITY,
                    };
                    let (exit, exit_face) = shape.intersect(&line, rest).unwrap();
                    for (t, face, sign) in [(enter, face, -1.0), (exit, exit_face, 1.0)] {
                        let near = line.at(t);
                        let point = shape.point(face, near, 0.0);
                        let slack = 1e-14 * (1.0 + distance);
                        assert!(
                            (point.position - near).length() < slack,
                            "{shape:?} {line:?}"
                        );
                        assert!((point.normal.length() - 1.0).abs() < 1e-15);
                        assert!(
                            line.direction.dot(point.normal) * sign > -1e-12,
                            "{shape:?}"
                        );
                        assert!(point.uv.cmpge(DVec2::splat(-1e-6)).all());
                        assert!(point.uv.cmple(DVec2::splat(1.0 + 1e-6)).all());
                    }
                }
            }
        }
    }

    #[test]
    fn rays_that_start_just_outside_never_come_back() {
        let mut tested = 0;
        for shape in shapes() {
            for line in lines(5.0) {
                let (t, face) = shape.intersect(&line, ALL).unwrap();
                let point = shape.point(face, line.at(t), 1e-13);
                let origin = point.position + point.normal * 1e-14;
                for other in lines(1.0).iter().step_by(397) {
                    let side = other.direction.dot(point.normal);
                    let grazing = other.direction - point.normal * side * (1.0 - 1e-9);
                    for direction in [other.direction * side.signum(), grazing * side.signum()] {
                        let line = Line { origin, direction };
                        assert_eq!(shape.intersect(&line, ALL), None, "{shape:?} {line:?}");
                        tested += 1;
                    }
                }
            }
        }
        assert!(tested > 400_000);
    }

    #[test]
    fn axis_parallel_lines_with_signed_zeros_hit() {
        for shape in shapes() {
            for zero in [0.0, -0.0] {
                for (origin, direction) in [
                    (DVec3::new(0.1, 0.1, 9.0), DVec3::new(zero, -zero, -1.0)),
                    (DVec3::new(9.0, 0.0, 0.5), DVec3::new(-1.0, zero, zero)),
                    (DVec3::new(0.0, -9.0, 0.5), DVec3::new(-zero, 1.0, zero)),
                ] {
                    let line = Line { origin, direction };
                    let (t, _) = shape.intersect(&line, ALL).unwrap();
                    assert!(t > 7.0 && t < 9.5, "{shape:?} {line:?} {t}");
                }
            }
        }
    }

    #[test]
    fn an_open_frustum_is_seen_from_inside() {
        let tube = UnitFrustum {
            base: 1.0,
            top: 1.0,
            caps: [false; 2],
            aspect: 1.0,
        };
        let line = Line {
            origin: DVec3::new(0.0, 0.0, 3.0),
            direction: DVec3::new(0.0, 0.4, -1.0),
        };
        let (t, face) = UnitShape::Frustum(tube).intersect(&line, ALL).unwrap();
        assert!((t - 2.5).abs() < 1e-14 && face == Face::Side);
        let along = Line {
            origin: DVec3::new(0.0, 0.3, 3.0),
            direction: DVec3::NEG_Z,
        };
        assert_eq!(UnitShape::Frustum(tube).intersect(&along, ALL), None);
    }

    fn uv(shape: UnitShape, face: Face, at: [f64; 3]) -> [f64; 2] {
        shape.point(face, DVec3::from_array(at), 0.0).uv.to_array()
    }

    #[test]
    fn textures_lie_as_groimp_lays_them() {
        let tube = shapes()[2];
        let (side, sphere) = (Face::Side, UnitShape::Sphere);
        for (shape, face, at, expected) in [
            // Once round from +x through +y, from the lowest point to the highest.
            (sphere, side, [1.0, 0.0, 0.0], [0.0, 0.5]),
            (sphere, side, [0.0, 1.0, 0.0], [0.25, 0.5]),
            (sphere, side, [-1.0, 0.0, 0.0], [0.5, 0.5]),
            (sphere, side, [0.0, -1.0, 0.0], [0.75, 0.5]),
            (sphere, side, [0.0, 0.0, -1.0], [0.0, 0.0]),
            (sphere, side, [0.0, 0.0, 1.0], [0.0, 1.0]),
            (tube, side, [0.0, 1.0, 0.25], [0.25, 0.25]),
            (tube, Face::Top, [0.5, 0.5, 1.0], [0.75, 0.75]),
            (tube, Face::Base, [0.5, 0.5, 0.0], [0.75, 0.25]),
            (UnitShape::Disk, side, [-1.0, 0.5, 0.0], [0.0, 0.75]),
            (
                UnitShape::Cube,
                Face::Cube(0, true),
                [1.0, 1.0, -1.0],
                [1.0, 0.0],
            ),
            (
                UnitShape::Cube,
                Face::Cube(0, false),
                [-1.0, 1.0, -1.0],
                [0.0, 0.0],
            ),
            (
                UnitShape::Cube,
                Face::Cube(1, false),
                [1.0, -1.0, -1.0],
                [1.0, 0.0],
            ),
            (
                UnitShape::Cube,
                Face::Cube(1, true),
                [1.0, 1.0, -1.0],
                [1.0, 1.0],
            ),
            (
                UnitShape::Cube,
                Face::Cube(2, true),
                [1.0, -1.0, 1.0],
                [1.0, 0.0],
            ),
            (
                UnitShape::Cube,
                Face::Cube(2, false),
                [1.0, -1.0, -1.0],
                [1.0, 1.0],
            ),
        ] {
            let found = uv(shape, face, at);
            let near = found
                .iter()
                .zip(expected)
                .all(|(a, b)| (a - b).abs() < 1e-12);
            assert!(near, "{shape:?} {face:?} {at:?}: {found:?}");
        }
    }

    #[test]
    fn textures_are_smooth_fill_their_square_and_are_not_mirrored() {
        for shape in shapes().into_iter().chain([UnitShape::Disk]) {
            let faces: Vec<Face> = match shape {
                UnitShape::Cube => (0..6).map(|k| Face::Cube(k / 2, k % 2 == 0)).collect(),
                UnitShape::Frustum(f) => {
                    [(Face::Side, 1.0), (Face::Base, f.base), (Face::Top, f.top)]
                        .into_iter()
                        .filter(|(_, radius)| *radius > 0.0)
                        .map(|(face, _)| face)
                        .collect()
                }
                UnitShape::Sphere | UnitShape::Disk => vec![Face::Side],
            };
            for (face, line) in faces
                .iter()
                .flat_map(|f| lines(0.0).into_iter().map(move |l| (f, l)))
            {
                let near = line.direction + DVec3::Z * 0.5;
                let here = shape.point(*face, near, 0.0);
                assert!(here.uv.cmpge(DVec2::ZERO).all() && here.uv.cmple(DVec2::ONE).all());
                // A small step along the surface is a small step in the image, and turns the same way round.
                let along = here.normal.any_orthonormal_vector();
                let steps = [along, here.normal.cross(along)].map(|step| {
                    let there = shape.point(*face, here.position + step * 1e-6, 0.0);
                    (there.uv - here.uv, there.position - here.position)
                });
                let is_seam = steps.iter().any(|(uv, _)| uv.length() > 0.1);
                let is_flat = steps.iter().all(|(_, step)| step.length() > 0.9e-6);
                let is_pole = here.normal.truncate().length() < 0.05
                    || here.position.truncate().length() < 0.05;
                if !is_seam && is_flat && !(is_pole && *face == Face::Side) {
                    let turn = steps[0].0.perp_dot(steps[1].0);
                    assert!(turn > 0.0, "{shape:?} {face:?} {here:?} {turn}");
                }
            }
        }
    }

    #[test]
    fn the_disk_has_an_edge() {
        let at = |x| Line {
            origin: DVec3::new(x, 0.0, 2.0),
            direction: DVec3::NEG_Z,
        };
        assert_eq!(
            UnitShape::Disk.intersect(&at(1.0), ALL),
            Some((2.0, Face::Side))
        );
        assert_eq!(UnitShape::Disk.intersect(&at(1.0 + 1e-12), ALL), None);
        let within = Line {
            origin: DVec3::new(-3.0, 0.0, 0.0),
            direction: DVec3::X,
        };
        assert_eq!(UnitShape::Disk.intersect(&within, ALL), None);
    }
}
