//! Reducing shapes to the few kinds that rays are tested against.

use super::Shape;
use super::unit::{UnitFrustum, UnitShape};
use glam::{DAffine3, DMat3, DVec3};

/// What a shape is for a ray.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Reduced {
    /// Nothing: it has no area.
    Nothing,
    /// The image of a unit shape under an affine map into the shape's frame.
    Unit(UnitShape, DAffine3),
    /// A parallelogram: a corner and two edges.
    Parallelogram(DVec3, [DVec3; 2]),
    /// The plane z = 0.
    Plane,
    /// The triangles of the mesh.
    Mesh,
}

impl Shape {
    /// The kind of this shape. Sizes must be finite and not negative.
    ///
    /// Growth makes many shapes of size 0. A box that is flat in one direction becomes a parallelogram, a frustum without
    /// length becomes its larger cap, and what has no area at all becomes nothing.
    #[must_use]
    pub fn reduced(&self) -> Reduced {
        let scaled = |x, y, z| DAffine3::from_scale(DVec3::new(x, y, z));
        match *self {
            Self::Sphere { radius } if radius > 0.0 => {
                Reduced::Unit(UnitShape::Sphere, scaled(radius, radius, radius))
            }
            Self::Disk { radius } if radius > 0.0 => {
                Reduced::Unit(UnitShape::Disk, scaled(radius, radius, radius))
            }
            Self::Sphere { .. } | Self::Disk { .. } => Reduced::Nothing,
            Self::Frustum {
                length,
                base_radius,
                top_radius,
                base_cap,
                top_cap,
            } => reduced_frustum(length, [base_radius, top_radius], [base_cap, top_cap]),
            Self::Box {
                half_x,
                half_y,
                length,
            } => reduced_box(half_x, half_y, length),
            Self::Parallelogram {
                corner,
                edge_u,
                edge_v,
            } => {
                if edge_u.cross(edge_v) == DVec3::ZERO {
                    Reduced::Nothing
                } else {
                    Reduced::Parallelogram(corner, [edge_u, edge_v])
                }
            }
            Self::Plane => Reduced::Plane,
            Self::Mesh(_) => Reduced::Mesh,
        }
    }
}

fn reduced_frustum(length: f64, radii: [f64; 2], caps: [bool; 2]) -> Reduced {
    let widest = radii[0].max(radii[1]);
    if widest == 0.0 {
        return Reduced::Nothing;
    }
    if length == 0.0 {
        let capped = |end: usize| if caps[end] { radii[end] } else { 0.0 };
        return Shape::Disk {
            radius: capped(0).max(capped(1)),
        }
        .reduced();
    }
    let frustum = UnitFrustum {
        base: radii[0] / widest,
        top: radii[1] / widest,
        // A cap of radius 0 has no area.
        caps: [caps[0] && radii[0] > 0.0, caps[1] && radii[1] > 0.0],
        aspect: length / widest,
    };
    let scale = DAffine3::from_scale(DVec3::new(widest, widest, length));
    Reduced::Unit(UnitShape::Frustum(frustum), scale)
}

fn reduced_box(half_x: f64, half_y: f64, length: f64) -> Reduced {
    let corner = DVec3::new(-half_x, -half_y, 0.0);
    let edges = [
        DVec3::X * (2.0 * half_x),
        DVec3::Y * (2.0 * half_y),
        DVec3::Z * length,
    ];
    let flat = |a: usize, b: usize| {
        Shape::Parallelogram {
            corner,
            edge_u: edges[a],
            edge_v: edges[b],
        }
        .reduced()
    };
    if half_x == 0.0 {
        flat(1, 2)
    } else if half_y == 0.0 {
        flat(2, 0)
    } else if length == 0.0 {
        flat(0, 1)
    } else {
        Reduced::Unit(
            UnitShape::Cube,
            DAffine3 {
                matrix3: DMat3::from_cols(edges[0] * 0.5, edges[1] * 0.5, edges[2] * 0.5),
                translation: DVec3::new(0.0, 0.0, 0.5 * length),
            },
        )
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn shapes_without_area_are_nothing() {
        let frustum = |length, base_radius, top_radius, cap| Shape::Frustum {
            length,
            base_radius,
            top_radius,
            base_cap: cap,
            top_cap: cap,
        };
        let nothing = [
            Shape::Sphere { radius: 0.0 },
            Shape::Disk { radius: 0.0 },
            frustum(1.0, 0.0, 0.0, true),
            frustum(0.0, 1.0, 1.0, false),
            Shape::Box {
                half_x: 0.0,
                half_y: 0.0,
                length: 1.0,
            },
            Shape::Parallelogram {
                corner: DVec3::X,
                edge_u: DVec3::X,
                edge_v: DVec3::X * 2.0,
            },
        ];
        for shape in nothing {
            assert_eq!(shape.reduced(), Reduced::Nothing, "{shape:?}");
        }
        let flat = Shape::Box {
            half_x: 1.0,
            half_y: 2.0,
            length: 0.0,
        }
        .reduced();
        let edges = [DVec3::X * 2.0, DVec3::Y * 4.0];
        assert_eq!(
            flat,
            Reduced::Parallelogram(DVec3::new(-1.0, -2.0, 0.0), edges)
        );
        let disk = Shape::Disk { radius: 2.0 }.reduced();
        assert_eq!(frustum(0.0, 1.0, 2.0, true).reduced(), disk);
    }

    #[test]
    fn sizes_move_into_the_map() {
        let Reduced::Unit(UnitShape::Frustum(unit), map) = (Shape::Frustum {
            length: 4.0,
            base_radius: 0.5,
            top_radius: 2.0,
            base_cap: true,
            top_cap: false,
        })
        .reduced() else {
            panic!("not a unit shape")
        };
        assert_eq!((unit.base, unit.top, unit.aspect), (0.25, 1.0, 2.0));
        assert_eq!(map.transform_point3(DVec3::ONE), DVec3::new(2.0, 2.0, 4.0));
    }
}
