//! Bringing the shapes of a group into its frame.

use super::Stop;
use super::arrange::{arrange, number_instances};
use super::error::{Problem, SceneError};
use super::group::{
    Group, GroupFrame, Item, MeshShading, PlacedGroup, Quad, ShapeRecord, Solid, Triangle,
};
use super::placement::Placement;
use super::plan::{PlannedGroup, PlannedShape, primitive_count};
use super::validate::{check_bounds, check_shape};
use crate::accel;
use crate::geometry::Shape;
use crate::geometry::reduce::Reduced;
use crate::material::Material;
use crate::math::Bounds3;
use crate::math::tolerance::MIN_EXTENT;
use glam::DVec3;
use rayon::prelude::*;

/// Builds a group whose instances refer to groups in `built`.
pub(super) fn bake(
    planned: &PlannedGroup,
    built: &[Group],
    (materials, stop): (&[Material], Stop<'_>),
) -> Result<Group, SceneError> {
    let frame = frame_of(planned, built, (materials.len(), stop))?;
    let mut group = empty_group(frame);
    store_shapes(&mut group, planned, stop)?;
    store_instances(&mut group, (planned, built), stop)?;
    let is_opaque = |shape: &ShapeRecord| materials[shape.material.0 as usize].is_opaque();
    group.is_opaque = group.shapes.iter().all(is_opaque)
        && group
            .instances
            .iter()
            .all(|instance| built[instance.group as usize].is_opaque);
    arrange(&mut group, built, stop)?;
    number_instances(&mut group, built)?;
    Ok(group)
}

/// A prototype of the same shapes in the same places as one that was built before, of other materials and organs perhaps.
pub(super) fn dressed(
    planned: &PlannedGroup,
    known: &Group,
    materials: &[Material],
) -> Result<Group, SceneError> {
    let mut group = known.clone();
    for (record, planned) in group.shapes.iter_mut().zip(&planned.shapes) {
        check_shape(planned, materials.len())?;
        record.material = planned.material;
        record.organ = planned.organ;
        record.instance_organ = planned.instance_organ;
    }
    let is_opaque = |shape: &ShapeRecord| materials[shape.material.0 as usize].is_opaque();
    group.is_opaque = group.shapes.iter().all(is_opaque);
    Ok(group)
}

fn empty_group(frame: GroupFrame) -> Group {
    Group {
        frame,
        bounds: Bounds3::EMPTY,
        cover: Vec::new(),
        triangles: Vec::new(),
        quads: Vec::new(),
        solids: Vec::new(),
        instances: Vec::new(),
        matrices: Vec::new(),
        blocks: Vec::new(),
        places: Vec::new(),
        shapes: Vec::new(),
        meshes: Vec::new(),
        bvh: accel::Bvh::default(),
        total: 0,
        is_opaque: true,
    }
}

/// Checks everything in the group and finds the frame that fits it.
fn frame_of(
    planned: &PlannedGroup,
    built: &[Group],
    (n_materials, stop): (usize, Stop<'_>),
) -> Result<GroupFrame, SceneError> {
    // Asked for each shape: next to what is done for it that costs nothing.
    let go_on = || {
        if stop() {
            Err(SceneError::Stopped)
        } else {
            Ok(())
        }
    };
    let shapes = planned.shapes.par_iter().map(|shape| {
        go_on()?;
        check_shape(shape, n_materials)?;
        let bounds = bounds_of(shape);
        check_bounds(&bounds, shape.organ)?;
        Ok(bounds)
    });
    let instances = planned.instances.par_iter().map(|instance| {
        go_on()?;
        let child = &built[instance.group];
        let bounds = child
            .bounds
            .transformed(&(instance.to_group * child.frame.to_group()));
        check_bounds(&bounds, instance.organ)?;
        Ok(bounds)
    });
    // Collected before looking for errors, so that it is always the first that is reported.
    let all: Vec<Result<Bounds3, SceneError>> = shapes.chain(instances).collect();
    let mut whole = Bounds3::EMPTY;
    for bounds in all {
        whole = whole.union(&bounds?);
    }

    if whole.is_empty() {
        return Ok(GroupFrame {
            center: DVec3::ZERO,
            scale: 1.0,
        });
    }
    let extent = whole.diagonal().length().max(MIN_EXTENT);
    let scale = libm::scalbn(1.0, 12 - libm::ilogb(extent));
    Ok(GroupFrame {
        center: whole.center(),
        scale,
    })
}

/// The box of a shape in its group; empty for a plane, which is not stored with the group.
fn bounds_of(planned: &PlannedShape) -> Bounds3 {
    let map = &planned.to_group;
    match (planned.shape.reduced(), planned.shape) {
        (Reduced::Unit(form, to_shape), _) => form.bounds_under(&(*map * to_shape)),
        (Reduced::Parallelogram(corner, [u, v]), _) => {
            let corners = [corner, corner + u, corner + v, corner + u + v];
            Bounds3::of(corners.map(|corner| map.transform_point3(corner)))
        }
        (Reduced::Mesh, Shape::Mesh(mesh)) => {
            let corners = mesh.triangles.iter().flatten();
            // NaN and infinities have been refused, so the smallest box is the box of finite numbers.
            Bounds3::of(corners.map(|at| map.transform_point3(mesh.positions[*at as usize])))
        }
        _ => Bounds3::EMPTY,
    }
}

/// A shape in the group's frame.
enum Baked {
    Nothing,
    Quad(Quad),
    Solid(Solid),
    Mesh(Vec<DVec3>),
}

fn store_shapes(
    group: &mut Group,
    planned: &PlannedGroup,
    stop: Stop<'_>,
) -> Result<(), SceneError> {
    let count: usize = planned
        .shapes
        .iter()
        .map(|planned| primitive_count(planned.shape))
        .sum();
    let corners = planned
        .shapes
        .iter()
        .map(|planned| corner_count(planned.shape));
    let largest = count.max(planned.instances.len()).max(corners.sum());
    if largest > Item::LIMIT {
        return Err(SceneError::GroupTooLarge(largest));
    }
    let frame = group.frame;
    let baked: Vec<Baked> = planned
        .shapes
        .par_iter()
        .map(|shape| {
            if stop() {
                Baked::Nothing
            } else {
                bake_shape(shape, frame)
            }
        })
        .collect();
    let mut next = 0_u32;
    for (planned, baked) in planned.shapes.iter().zip(baked) {
        if stop() {
            return Err(SceneError::Stopped);
        }
        let first = next;
        next += primitive_count(planned.shape) as u32;
        let mut record = ShapeRecord {
            first,
            material: planned.material,
            organ: planned.organ,
            instance_organ: planned.instance_organ,
            mesh: None,
            is_mirrored: planned.to_group.matrix3.determinant() < 0.0,
        };
        match baked {
            Baked::Nothing => {}
            Baked::Quad(quad) => group.quads.push(Quad {
                number: first,
                ..quad
            }),
            Baked::Solid(solid) => group.solids.push(Solid {
                number: first,
                ..solid
            }),
            Baked::Mesh(corners) => store_mesh(group, planned, &corners, &mut record),
        }
        group.shapes.push(record);
    }
    group.total = u64::from(next);
    group.places = vec![None; next as usize];
    Ok(())
}

fn corner_count(shape: &Shape) -> usize {
    match shape {
        Shape::Mesh(mesh) => mesh.positions.len(),
        _ => 0,
    }
}

fn bake_shape(planned: &PlannedShape, frame: GroupFrame) -> Baked {
    let map = frame.after(&planned.to_group);
    match (planned.shape.reduced(), planned.shape) {
        (Reduced::Unit(form, to_shape), _) => {
            let to_unit = (map * to_shape).inverse();
            if !to_unit.is_finite() {
                return Baked::Nothing;
            }
            Baked::Solid(Solid {
                to_unit,
                form,
                number: 0,
            })
        }
        (Reduced::Parallelogram(corner, edges), _) => {
            let corner = map.transform_point3(corner);
            let edges = edges.map(|edge| map.transform_vector3(edge));
            Baked::Quad(Quad {
                corner,
                edges,
                number: 0,
                is_turned: is_turned(planned.shape),
            })
        }
        (Reduced::Mesh, Shape::Mesh(mesh)) => Baked::Mesh(
            mesh.positions
                .iter()
                .map(|at| map.transform_point3(*at))
                .collect(),
        ),
        _ => Baked::Nothing,
    }
}

/// Whether textures run along the second edge of the parallelogram that a shape is, then along the first, as GroIMP's do:
/// across a `Parallelogram`, then along it.
fn is_turned(shape: &Shape) -> bool {
    match shape {
        Shape::Parallelogram { .. } => true,
        // The plate y = 0 has edges z and x.
        Shape::Box { half_x, half_y, .. } => *half_x != 0.0 && *half_y == 0.0,
        _ => false,
    }
}

fn store_mesh(
    group: &mut Group,
    planned: &PlannedShape,
    corners: &[DVec3],
    record: &mut ShapeRecord,
) {
    let Shape::Mesh(mesh) = planned.shape else {
        return;
    };
    for (index, triangle) in mesh.triangles.iter().enumerate() {
        let [a, b, c] = triangle.map(|corner| corners[corner as usize]);
        // Without area it can neither be hit nor shine.
        if (b - a).cross(c - a) != DVec3::ZERO {
            let number = record.first + index as u32;
            let corners = [a, b, c].map(|corner| corner.to_array());
            group.triangles.push(Triangle { corners, number });
        }
    }
    if !mesh.normals.is_empty() || !mesh.uvs.is_empty() {
        record.mesh = Some(group.meshes.len() as u32);
        let map = group.frame.after(&planned.to_group).matrix3;
        let shading = MeshShading {
            mesh: mesh.clone(),
            normal_map: map.inverse().transpose(),
        };
        group.meshes.push(shading);
    }
}

fn store_instances(
    group: &mut Group,
    (planned, built): (&PlannedGroup, &[Group]),
    stop: Stop<'_>,
) -> Result<(), SceneError> {
    for instance in &planned.instances {
        if stop() {
            return Err(SceneError::Stopped);
        }
        let child = &built[instance.group];
        // Nothing in it, or only planes, which are kept elsewhere.
        if child.bounds.is_empty() {
            continue;
        }
        let to_parent = group
            .frame
            .after(&(instance.to_group * child.frame.to_group()));
        let to_child = to_parent.inverse();
        if !to_child.is_finite() {
            let problem = Problem::Singular;
            return Err(SceneError::Organ {
                organ: instance.organ,
                problem,
            });
        }
        let placement = Placement::new(&to_child, &mut group.matrices);
        group.instances.push(PlacedGroup {
            placement,
            first: 0,
            group: instance.group as u32,
            organ: instance.organ,
        });
    }
    Ok(())
}
