//! Surfaces with coordinates of their own: each point of a flat or round face is named by two numbers.
//!
//! The coordinates of all faces keep areas in proportion, unless a round face is stretched unevenly: equal parts of the square
//! of coordinates are then equal parts of the face.

use crate::math::functions::{atan2, sin_cos};
use crate::math::tolerance::SIMILARITY;
use glam::{DAffine3, DVec2, DVec3};
use std::f64::consts::PI;

/// What kind of face it is.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Form {
    /// `corner + u·x + v·y` with u + v up to 1.
    Triangle,
    /// `corner + u·x + v·y`.
    Parallelogram,
    /// A disk: u turns round its middle, v the square of the distance from there.
    Disk,
    /// A sphere: u turns round z, v the height from the lowest point to the highest.
    Sphere,
    /// The side of a frustum with these radii at z = 0 and z = 1: u turns round z, v the share of its area below.
    Side {
        /// Radius at z = 0.
        base: f64,
        /// Radius at z = 1.
        top: f64,
    },
}

/// A face somewhere in the world, with coordinates.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Chart {
    /// From the face's own frame to the world. Of a triangle or parallelogram: its corner, its two edges, and the front normal.
    pub to_world: DAffine3,
    /// What face it is.
    pub form: Form,
}

/// A point of a face.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct ChartPoint {
    /// Where it is, metres.
    pub position: DVec3,
    /// Unit normal of the front.
    pub normal: DVec3,
}

/// Points along each side of a cell over which the area of an unevenly stretched one is added up.
const AREA_POINTS: u32 = 16;

impl Chart {
    /// A triangle or parallelogram.
    #[must_use]
    pub fn flat(form: Form, corner: DVec3, edges: [DVec3; 2], front: DVec3) -> Self {
        let mut to_world = DAffine3::IDENTITY;
        to_world.matrix3.x_axis = edges[0];
        to_world.matrix3.y_axis = edges[1];
        to_world.matrix3.z_axis = front;
        to_world.translation = corner;
        Self { to_world, form }
    }

    /// Whether it lies in one plane.
    #[must_use]
    pub fn is_flat(&self) -> bool {
        !matches!(self.form, Form::Sphere | Form::Side { .. })
    }

    /// Whether its first coordinate goes round, so that 0 and 1 are the same place.
    #[must_use]
    pub fn is_round(&self) -> bool {
        matches!(self.form, Form::Disk | Form::Sphere | Form::Side { .. })
    }

    /// The point with these coordinates, each in 0..=1.
    #[must_use]
    pub fn point(&self, uv: DVec2) -> ChartPoint {
        let (local, normal) = self.local(uv);
        let position = self.to_world.transform_point3(local);
        let normal = match self.form {
            Form::Triangle | Form::Parallelogram => self.to_world.matrix3.z_axis,
            Form::Disk | Form::Sphere | Form::Side { .. } => {
                // The cofactors carry normals up to the sign of the determinant.
                let sign = self.to_world.matrix3.determinant().signum();
                (self.cofactors(normal) * sign).normalize_or_zero()
            }
        };
        ChartPoint { position, normal }
    }

    /// The point and a normal as long as the area that a unit of the square of coordinates has there, both in the face's frame.
    fn local(&self, uv: DVec2) -> (DVec3, DVec3) {
        let around = || {
            let (sin, cos) = sin_cos(2.0 * PI * uv.x);
            DVec2::new(cos, sin)
        };
        match self.form {
            Form::Triangle | Form::Parallelogram => (uv.extend(0.0), DVec3::Z),
            Form::Disk => ((around() * uv.y.sqrt()).extend(0.0), DVec3::Z * PI),
            Form::Sphere => {
                let z = 2.0 * uv.y - 1.0;
                let radius = (1.0 - z * z).max(0.0).sqrt();
                let point = (around() * radius).extend(z);
                (point, point * (4.0 * PI))
            }
            Form::Side { base, top } => {
                let square = base * base + uv.y * (top * top - base * base);
                let radius = square.max(0.0).sqrt();
                let below = base + radius;
                let height = if below > 0.0 {
                    (uv.y * (base + top) / below).min(1.0)
                } else {
                    0.0
                };
                let around = around();
                let normal = around.extend(base - top) * (PI * (base + top));
                ((around * radius).extend(height), normal)
            }
        }
    }

    /// The image of a normal that is as long as an area: as long as the area's image.
    fn cofactors(&self, normal: DVec3) -> DVec3 {
        let m = self.to_world.matrix3;
        m.y_axis.cross(m.z_axis) * normal.x
            + m.z_axis.cross(m.x_axis) * normal.y
            + m.x_axis.cross(m.y_axis) * normal.z
    }

    /// Area per unit of the square of coordinates, m².
    #[must_use]
    pub fn density(&self, uv: DVec2) -> f64 {
        let (_, normal) = self.local(uv);
        self.cofactors(normal).length()
    }

    /// Whether [`Chart::density`] is the same everywhere.
    #[must_use]
    pub fn is_even(&self) -> bool {
        let m = self.to_world.matrix3;
        let axes = [m.x_axis, m.y_axis, m.z_axis];
        let length = axes[0].length();
        let alike = |i: usize| (axes[i].length() / length - 1.0).abs() <= SIMILARITY;
        let apart = |i: usize, j: usize| {
            axes[i].dot(axes[j]).abs() <= SIMILARITY * axes[i].length() * axes[j].length()
        };
        match self.form {
            Form::Triangle | Form::Parallelogram | Form::Disk => true,
            Form::Side { .. } => alike(1) && apart(0, 1) && apart(1, 2) && apart(2, 0),
            Form::Sphere => alike(1) && alike(2) && apart(0, 1) && apart(1, 2) && apart(2, 0),
        }
    }

    /// The coordinates, each in 0..=1, of the point of the face that is nearest to what these coordinates would be.
    #[must_use]
    pub fn coordinates(&self, position: DVec3) -> DVec2 {
        let turn = |p: DVec3| {
            let turn = atan2(p.y, p.x) / (2.0 * PI);
            if turn < 0.0 { turn + 1.0 } else { turn }
        };
        let uv = match self.form {
            Form::Triangle | Form::Parallelogram => {
                let m = self.to_world.matrix3;
                let normal = m.x_axis.cross(m.y_axis);
                let to = (position - self.to_world.translation) / normal.length_squared();
                DVec2::new(
                    to.cross(m.y_axis).dot(normal),
                    m.x_axis.cross(to).dot(normal),
                )
            }
            Form::Disk | Form::Sphere | Form::Side { .. } => {
                let p = self.to_world.inverse().transform_point3(position);
                let v = match self.form {
                    Form::Sphere => 0.5 + 0.5 * p.z,
                    Form::Side { base, top } => {
                        let radius = base + (top - base) * p.z;
                        p.z * (base + radius) / (base + top)
                    }
                    _ => p.truncate().length_squared(),
                };
                DVec2::new(turn(p), v)
            }
        };
        let uv = uv.clamp(DVec2::ZERO, DVec2::ONE);
        let over = uv.x + uv.y;
        if self.form == Form::Triangle && over > 1.0 {
            uv / over
        } else {
            uv
        }
    }

    /// Area of the part with coordinates from `origin` to `origin + size`: a parallelogram of the square of coordinates, or, of a
    /// triangle, the half of it at `origin`; m².
    #[must_use]
    pub fn area(&self, origin: DVec2, size: DVec2) -> f64 {
        let share = (size.x * size.y).abs();
        match self.form {
            Form::Triangle => 0.5 * share * self.density(origin),
            _ if self.is_even() => share * self.density(origin),
            _ => {
                let n = f64::from(AREA_POINTS);
                let at = |i: u32, j: u32| {
                    let within = DVec2::new(f64::from(i) + 0.5, f64::from(j) + 0.5) / n;
                    self.density(origin + size * within)
                };
                let rows = 0..AREA_POINTS;
                let points = rows.flat_map(|i| (0..AREA_POINTS).map(move |j| at(i, j)));
                share * points.sum::<f64>() / (n * n)
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::geometry::area::RoundArea;
    use crate::geometry::unit::{UnitFrustum, UnitShape};

    fn maps() -> [DAffine3; 3] {
        let turn = DAffine3::from_axis_angle(DVec3::new(1.0, 2.0, 3.0).normalize(), 0.7);
        [
            DAffine3::IDENTITY,
            DAffine3::from_translation(DVec3::new(3.0, -1.0, 2.0)) * turn,
            turn * DAffine3::from_scale(DVec3::new(1.0, -2.0, 0.5)),
        ]
    }

    fn forms() -> [Form; 6] {
        [
            Form::Triangle,
            Form::Parallelogram,
            Form::Disk,
            Form::Sphere,
            Form::Side {
                base: 1.0,
                top: 0.0,
            },
            Form::Side {
                base: 0.5,
                top: 1.0,
            },
        ]
    }

    #[test]
    fn coordinates_name_points_and_back() {
        for to_world in maps() {
            for form in forms() {
                let chart = Chart { to_world, form };
                for k in 0..100 {
                    let uv = DVec2::new(f64::from(k % 10) + 0.5, f64::from(k / 10) + 0.5) / 20.0;
                    let point = chart.point(uv);
                    let back = chart.coordinates(point.position);
                    assert!((back - uv).length() < 1e-10, "{form:?} {uv} {back}");
                    if chart.is_round() {
                        assert!((point.normal.length() - 1.0).abs() < 1e-12);
                    }
                }
            }
        }
    }

    /// The cross product of steps along the coordinates is the density times the normal.
    #[test]
    fn densities_and_normals_are_those_of_small_steps() {
        let step = 1e-6;
        for to_world in maps() {
            for form in forms() {
                let chart = Chart { to_world, form };
                for k in 0..64 {
                    let uv = DVec2::new(f64::from(k % 8) + 0.5, f64::from(k / 8) + 0.5) / 16.0;
                    let at = |uv| chart.point(uv).position;
                    let along_u = (at(uv + DVec2::X * step) - at(uv - DVec2::X * step)) / 2e-6;
                    let along_v = (at(uv + DVec2::Y * step) - at(uv - DVec2::Y * step)) / 2e-6;
                    let cross = along_u.cross(along_v);
                    let density = chart.density(uv);
                    assert!(
                        (cross.length() / density - 1.0).abs() < 1e-6,
                        "{form:?} {uv}"
                    );
                    if chart.is_round() {
                        let cos = cross.normalize().dot(chart.point(uv).normal).abs();
                        assert!(cos > 1.0 - 1e-9, "{form:?} {uv} {cos}");
                    }
                }
            }
        }
    }

    #[test]
    fn areas_are_those_of_the_whole_shape() {
        for to_world in maps() {
            for (form, unit) in [
                (Form::Sphere, UnitShape::Sphere),
                (Form::Disk, UnitShape::Disk),
                (
                    Form::Side {
                        base: 0.5,
                        top: 1.0,
                    },
                    UnitShape::Frustum(UnitFrustum {
                        base: 0.5,
                        top: 1.0,
                        caps: [false; 2],
                        aspect: 1.0,
                    }),
                ),
            ] {
                let chart = Chart { to_world, form };
                let expected = RoundArea::new(unit, &to_world).unwrap().area();
                let mut sum = 0.0;
                for k in 0..64 {
                    let origin = DVec2::new(f64::from(k % 8), f64::from(k / 8)) / 8.0;
                    sum += chart.area(origin, DVec2::splat(0.125));
                }
                assert!(
                    (sum / expected - 1.0).abs() < 1e-4,
                    "{form:?} {sum} {expected}"
                );
            }
        }
    }

    #[test]
    fn normals_of_closed_shapes_look_outwards() {
        for to_world in maps() {
            for form in [
                Form::Sphere,
                Form::Side {
                    base: 1.0,
                    top: 1.0,
                },
            ] {
                let chart = Chart { to_world, form };
                let inside = to_world.transform_point3(DVec3::Z * 0.1);
                for k in 0..16 {
                    let point = chart.point(DVec2::new(f64::from(k) / 16.0, 0.55));
                    assert!(point.normal.dot(point.position - inside) > 0.0, "{form:?}");
                }
            }
        }
    }
}
