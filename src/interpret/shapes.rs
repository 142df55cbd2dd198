//! One node, one shape.

use crate::geometry::Shape;
use crate::graph::{FieldId, Graph, NodeId, Payload};
use crate::math::Bounds3;
use crate::turtle::effect::{Effect, Primitive};
use crate::turtle::reading::{action, shoot_radius};
use crate::turtle::{Action, TurtleState, types};
use glam::{DAffine3, DVec3};
use std::sync::LazyLock;

/// The fields that shapes are read from. Modules inherit them with their numbers.
pub(super) struct Fields {
    sphere_radius: FieldId,
    box_width: FieldId,
    box_height: FieldId,
    cylinder: [FieldId; 3],
    cone: [FieldId; 2],
    frustum: [FieldId; 4],
    /// Full width, slant of half the width along y and along z.
    parallelogram: [FieldId; 3],
    /// Length of the primitives that have one.
    length: FieldId,
    /// The lamp of a parallelogram.
    pub(super) area_light: FieldId,
    /// The lamp of a light node.
    pub(super) light: FieldId,
    /// The shader of what has a surface.
    pub(super) shader: FieldId,
    /// What a curved surface is made of, a mesh, the points of a sweep.
    pub(super) surface: FieldId,
    pub(super) polygons: FieldId,
    pub(super) sweep_points: FieldId,
    /// How far triangles may be from a curved surface; whether the ends of a sweep are missing.
    pub(super) curved_error: FieldId,
    pub(super) sweep_open: [FieldId; 2],
    /// The file of a mesh.
    pub(super) mesh_file: FieldId,
    /// What an instance draws again.
    pub(super) prototype: FieldId,
    /// The power density of a sky.
    pub(super) sky_power: FieldId,
    /// Radius and exponent of a sensor; whether both of its sides sense.
    pub(super) sensor: [FieldId; 2],
    pub(super) sensor_two_sided: FieldId,
    /// The layer of a node.
    pub(super) layer: FieldId,
    /// Numbers of copies along x and y of a grid.
    pub(super) counts: [FieldId; 2],
    /// Their distances.
    pub(super) distances: [FieldId; 2],
}

pub(super) static FIELDS: LazyLock<Fields> = LazyLock::new(|| {
    let table = types();
    let field = |ty: &str, name: &str| {
        let ty = table.find(ty).expect("invariant: a built-in type");
        table
            .field(ty, name)
            .expect("invariant: a field of that type")
    };
    Fields {
        sphere_radius: field("Sphere", "radius"),
        box_width: field("Box", "width"),
        box_height: field("Box", "height"),
        cylinder: ["radius", "baseOpen", "topOpen"].map(|f| field("Cylinder", f)),
        cone: ["radius", "baseOpen"].map(|f| field("Cone", f)),
        frustum: ["baseRadius", "topRadius", "baseOpen", "topOpen"].map(|f| field("Frustum", f)),
        parallelogram: ["width.full", "axis.y", "axis.z"].map(|f| field("Parallelogram", f)),
        length: field("Cylinder", "length"),
        area_light: field("Parallelogram", "light"),
        light: field("LightNode", "light"),
        shader: field("ShadedNull", "shader"),
        surface: field("NURBSSurface", "surface"),
        polygons: field("MeshNode", "polygons"),
        sweep_points: field("Sweep", "points"),
        curved_error: field("CurvedBase", "error"),
        sweep_open: ["baseOpen", "topOpen"].map(|f| field("CurvedBase", f)),
        mesh_file: field("Mesh", "file"),
        prototype: field("Instance", "prototype"),
        sky_power: field("Sky", "powerDensity"),
        sensor: ["radius", "exponent"].map(|f| field("SensorNode", f)),
        sensor_two_sided: field("SensorNode", "twoSided"),
        layer: field("Node", "layer"),
        counts: ["xCount", "yCount"].map(|f| field("GridClonerNode", f)),
        distances: ["xDistance", "yDistance"].map(|f| field("GridClonerNode", f)),
    }
});

/// A shape and how far along the head it is moved from where the turtle stands.
pub(super) type Drawn = (Shape, f64);

/// What a node of this effect draws in this state; `None` for what has no extent or is not drawn at all.
pub(super) fn shape_of<O: Payload>(
    graph: &Graph<O>,
    node: NodeId,
    effect: Effect,
    state: &TurtleState,
) -> Option<Drawn> {
    let f = &*FIELDS;
    let number = |field| graph.get_f64(node, field).unwrap_or(0.0);
    let is_set = |field| graph.get_bool(node, field).unwrap_or(false);
    let length = || number(f.length);
    match effect {
        Effect::Step { is_shoot: true, .. } => {
            let Action::Step { length, own, .. } = action(graph, node, &mut |_| None) else {
                return None;
            };
            let length = state.step_length(length, own, true);
            let radius = shoot_radius(graph, node, state)?;
            (length != 0.0).then(|| frustum(length, [radius; 2], [true; 2]))?
        }
        Effect::Draw(primitive) => match primitive {
            Primitive::Sphere => {
                let radius = number(f.sphere_radius).abs();
                (radius != 0.0).then_some((Shape::Sphere { radius }, 0.0))
            }
            Primitive::Box => cuboid(length(), number(f.box_width), number(f.box_height)),
            Primitive::Cylinder => {
                let [radius, base, top] = f.cylinder;
                frustum(length(), [number(radius); 2], [!is_set(base), !is_set(top)])
            }
            Primitive::Cone => {
                let [radius, base] = f.cone;
                frustum(length(), [number(radius), 0.0], [!is_set(base), false])
            }
            Primitive::Frustum => {
                let [low, high, base, top] = f.frustum;
                let radii = [number(low), number(high)];
                frustum(length(), radii, [!is_set(base), !is_set(top)])
            }
            Primitive::Parallelogram => {
                let [width, y, z] = f.parallelogram.map(number);
                parallelogram(length(), DVec3::new(width / 2.0, y, z))
            }
            Primitive::Plane => Some((Shape::Plane, 0.0)),
            Primitive::Text
            | Primitive::Light
            | Primitive::Sky
            | Primitive::Sensor
            | Primitive::Mesh
            | Primitive::Surface
            | Primitive::Sweep
            | Primitive::Polygons => None,
        },
        _ => None,
    }
}

/// A cylinder, cone or frustum; a negative length reaches back from the turtle, length 0 leaves the larger of the disks.
fn frustum(length: f64, radii: [f64; 2], caps: [bool; 2]) -> Option<Drawn> {
    let [base, top] = radii.map(f64::abs);
    if base == 0.0 && top == 0.0 {
        return None;
    }
    if length == 0.0 {
        let radius = base.max(top);
        return caps
            .contains(&true)
            .then_some((Shape::Disk { radius }, 0.0));
    }
    let ((base_radius, top_radius), (base_cap, top_cap), shift) = if length < 0.0 {
        ((top, base), (caps[1], caps[0]), length)
    } else {
        ((base, top), (caps[0], caps[1]), 0.0)
    };
    let shape = Shape::Frustum {
        length: length.abs(),
        base_radius,
        top_radius,
        base_cap: base_cap && base_radius != 0.0,
        top_cap: top_cap && top_radius != 0.0,
    };
    Some((shape, shift))
}

/// A box; one without extent along one axis is a flat plate.
fn cuboid(length: f64, width: f64, height: f64) -> Option<Drawn> {
    let (half_x, half_y) = (width.abs() / 2.0, height.abs() / 2.0);
    let n_flat = [half_x, half_y, length]
        .iter()
        .filter(|s| **s == 0.0)
        .count();
    let shape = Shape::Box {
        half_x,
        half_y,
        length: length.abs(),
    };
    (n_flat < 2).then_some((shape, length.min(0.0)))
}

/// A parallelogram of this length along the head between ∓`axis`; its front looks to local +y.
fn parallelogram(length: f64, axis: DVec3) -> Option<Drawn> {
    let (along, across) = (DVec3::Z * length, axis * 2.0);
    let normal = along.cross(across);
    if normal == DVec3::ZERO {
        return None;
    }
    let (edge_u, edge_v) = if normal.y < 0.0 {
        (across, along)
    } else {
        (along, across)
    };
    let shape = Shape::Parallelogram {
        corner: -axis,
        edge_u,
        edge_v,
    };
    Some((shape, 0.0))
}

/// Whether all sizes of a shape are finite numbers.
pub(super) fn is_finite(shape: &Shape) -> bool {
    match shape {
        Shape::Sphere { radius } | Shape::Disk { radius } => radius.is_finite(),
        Shape::Frustum {
            length,
            base_radius,
            top_radius,
            ..
        } => length.is_finite() && base_radius.is_finite() && top_radius.is_finite(),
        Shape::Box {
            half_x,
            half_y,
            length,
        } => half_x.is_finite() && half_y.is_finite() && length.is_finite(),
        Shape::Parallelogram {
            corner,
            edge_u,
            edge_v,
        } => corner.is_finite() && edge_u.is_finite() && edge_v.is_finite(),
        Shape::Plane | Shape::Mesh(_) => true,
    }
}

/// The smallest box round a placed shape; empty for endless planes.
pub(super) fn bounds(shape: &Shape, to: &DAffine3) -> Bounds3 {
    let m = &to.matrix3;
    let at = |local: DVec3| to.transform_point3(local);
    // Half extents of a placed unit disk in the plane of local x and y, and of a placed unit ball.
    let disk = || (m.x_axis * m.x_axis + m.y_axis * m.y_axis).map(f64::sqrt);
    let ball = || {
        let squares = m.x_axis * m.x_axis + m.y_axis * m.y_axis + m.z_axis * m.z_axis;
        squares.map(f64::sqrt)
    };
    let round = |center: DVec3, half: DVec3| Bounds3 {
        min: center - half,
        max: center + half,
    };
    match shape {
        Shape::Sphere { radius } => round(to.translation, ball() * *radius),
        Shape::Disk { radius } => round(to.translation, disk() * *radius),
        Shape::Frustum {
            length,
            base_radius,
            top_radius,
            ..
        } => {
            let disk = disk();
            let top = at(DVec3::Z * *length);
            round(to.translation, disk * *base_radius).union(&round(top, disk * *top_radius))
        }
        Shape::Box {
            half_x,
            half_y,
            length,
        } => {
            let half = m.x_axis.abs() * *half_x
                + m.y_axis.abs() * *half_y
                + m.z_axis.abs() * (*length / 2.0);
            round(at(DVec3::Z * (*length / 2.0)), half)
        }
        Shape::Parallelogram {
            corner,
            edge_u,
            edge_v,
        } => {
            let (u, v) = (*corner + *edge_u, *corner + *edge_v);
            Bounds3::of([at(*corner), at(u), at(v), at(u + *edge_v)])
        }
        Shape::Plane => Bounds3::EMPTY,
        Shape::Mesh(mesh) => Bounds3::of(mesh.positions.iter().map(|p| at(*p))),
    }
}

/// Area in m² of a placed parallelogram; 0 for other shapes.
pub(super) fn parallelogram_area(shape: &Shape, to: &DAffine3) -> f64 {
    let Shape::Parallelogram { edge_u, edge_v, .. } = shape else {
        return 0.0;
    };
    let side = |edge: &DVec3| to.transform_vector3(*edge);
    side(edge_u).cross(side(edge_v)).length()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn negative_lengths_reach_back() {
        let (shape, shift) = frustum(-2.0, [0.5, 0.1], [true, false]).unwrap();
        assert_eq!(shift, -2.0);
        let expected = Shape::Frustum {
            length: 2.0,
            base_radius: 0.1,
            top_radius: 0.5,
            base_cap: false,
            top_cap: true,
        };
        assert_eq!(shape, expected);
        assert_eq!(cuboid(-2.0, 1.0, 1.0).unwrap().1, -2.0);
    }

    #[test]
    fn what_has_no_extent_is_not_drawn() {
        assert!(frustum(1.0, [0.0; 2], [true; 2]).is_none());
        assert!(frustum(0.0, [1.0; 2], [false; 2]).is_none());
        assert!(matches!(
            frustum(0.0, [1.0; 2], [true; 2]),
            Some((Shape::Disk { .. }, _))
        ));
        assert!(cuboid(1.0, 0.0, 0.0).is_none());
        assert!(parallelogram(0.0, DVec3::X).is_none());
        assert!(parallelogram(1.0, DVec3::ZERO).is_none());
    }

    #[test]
    fn plates_stay_where_the_box_was() {
        for size in [[0.0, 2.0, 4.0], [2.0, 0.0, 4.0], [2.0, 4.0, 0.0]] {
            let (shape, _) = cuboid(size[2], size[0], size[1]).unwrap();
            let found = bounds(&shape, &DAffine3::IDENTITY);
            let half = DVec3::new(size[0], size[1], 0.0) / 2.0;
            assert_eq!(found.min, -half);
            assert_eq!(found.max, half + DVec3::Z * size[2]);
        }
    }

    #[test]
    fn the_front_of_a_parallelogram_looks_to_local_y() {
        for (length, half_width) in [(1.0, 0.5), (-1.0, 0.5), (1.0, -0.5), (-2.0, -0.5)] {
            let (shape, _) = parallelogram(length, DVec3::X * half_width).unwrap();
            let Shape::Parallelogram { edge_u, edge_v, .. } = shape else {
                panic!("a parallelogram")
            };
            assert!(edge_u.cross(edge_v).y > 0.0, "{length} {half_width}");
        }
    }

    #[test]
    fn bounds_are_tight() {
        let turned = DAffine3::from_rotation_x(std::f64::consts::FRAC_PI_2);
        let cylinder = Shape::Frustum {
            length: 4.0,
            base_radius: 1.0,
            top_radius: 1.0,
            base_cap: true,
            top_cap: true,
        };
        let found = bounds(&cylinder, &turned);
        let expected = Bounds3::of([DVec3::new(-1.0, -4.0, -1.0), DVec3::new(1.0, 0.0, 1.0)]);
        assert!((found.min - expected.min).length() < 1e-15);
        assert!((found.max - expected.max).length() < 1e-15);
        let ball = Shape::Sphere { radius: 2.0 };
        let stretched = DAffine3::from_scale(DVec3::new(1.0, 1.0, 3.0));
        assert_eq!(bounds(&ball, &stretched).max, DVec3::new(2.0, 2.0, 6.0));
        let area = parallelogram_area(&parallelogram(2.0, DVec3::X).unwrap().0, &stretched);
        assert_eq!(area, 12.0);
    }
}
