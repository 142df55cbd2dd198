//! Bringing the shapes of a group into its frame.

use super::Stop;
use super::description::OrganId;
use super::error::{Problem, SceneError};
use super::group::{
    Group, GroupFrame, Item, ItemKind, MeshShading, PlacedGroup, Quad, ShapeRecord, Solid, Triangle,
};
use super::placement::Placement;
use super::plan::{PlannedGroup, PlannedShape, primitive_count};
use super::validate::{check_bounds, check_shape};
use crate::accel::{self, Box3, BoxKind, FlatBlock, Leaves};
use crate::geometry::Shape;
use crate::geometry::reduce::Reduced;
use crate::material::Material;
use crate::math::Bounds3;
use crate::math::tolerance::{BOX_PADDING, MIN_EXTENT};
use glam::{DAffine3, DVec3};
use rayon::prelude::*;

/// Triangles and parallelograms per leaf: as many as are tested at once.
const LEAF_SIZE: usize = accel::WIDTH;

/// Most boxes that stand for a group when the boxes of its instances are made.
const COVER: usize = 32;

/// Builds a group whose instances refer to groups in `built`.
pub(super) fn bake(
    planned: &PlannedGroup,
    built: &[Group],
    (materials, stop): (&[Material], Stop<'_>),
) -> Result<Group, SceneError> {
    let frame = frame_of(planned, built, materials.len())?;
    let mut group = empty_group(frame);
    store_shapes(&mut group, planned)?;
    store_instances(&mut group, planned, built)?;
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
    n_materials: usize,
) -> Result<GroupFrame, SceneError> {
    let shapes = planned.shapes.par_iter().map(|shape| {
        check_shape(shape, n_materials)?;
        let bounds = bounds_of(shape);
        check_bounds(&bounds, shape.organ)?;
        Ok(bounds)
    });
    let instances = planned.instances.par_iter().map(|instance| {
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

fn store_shapes(group: &mut Group, planned: &PlannedGroup) -> Result<(), SceneError> {
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
        .map(|shape| bake_shape(shape, frame))
        .collect();
    let mut next = 0_u32;
    for (planned, baked) in planned.shapes.iter().zip(baked) {
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
    planned: &PlannedGroup,
    built: &[Group],
) -> Result<(), SceneError> {
    for instance in &planned.instances {
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

/// Builds the hierarchy and puts everything into the order of its leaves.
fn arrange(group: &mut Group, built: &[Group], stop: Stop<'_>) -> Result<(), SceneError> {
    let boxes = boxes(group, built);
    let flats = group.triangles.len() + group.quads.len();
    let kind = |end, per_leaf| BoxKind { end, per_leaf };
    let kinds = [
        kind(flats, LEAF_SIZE),
        // Curved shapes are dear to test: each has a box of its own.
        kind(flats + group.solids.len(), 1),
        // Instances are dearer to enter, but a million of them want to be stored small.
        kind(boxes.len(), 2),
    ];
    let (bvh, leaves) = accel::build_unless(&boxes, &kinds, stop);
    if stop() {
        return Err(SceneError::Stopped);
    }
    group.bvh = bvh;
    group.cover = group.bvh.cover(COVER);
    group.bounds = boxes.iter().fold(Bounds3::EMPTY, |bounds, part| {
        let corner = |x: [f32; 3]| DVec3::from_array(x.map(f64::from));
        bounds.with(corner(part.min)).with(corner(part.max))
    });

    let old = (
        std::mem::take(&mut group.triangles),
        std::mem::take(&mut group.quads),
        std::mem::take(&mut group.solids),
        std::mem::take(&mut group.instances),
    );
    let ends = [
        old.0.len(),
        old.0.len() + old.1.len(),
        old.0.len() + old.1.len() + old.2.len(),
    ];
    let mut items = Vec::with_capacity(leaves.order.len());
    for index in &leaves.order {
        let index = *index as usize;
        let (kind, number) = if index < ends[0] {
            group.triangles.push(old.0[index]);
            let kind = ItemKind::Triangle(group.triangles.len() - 1);
            (kind, Some(old.0[index].number))
        } else if index < ends[1] {
            let quad = old.1[index - ends[0]];
            group.quads.push(quad);
            (ItemKind::Quad(group.quads.len() - 1), Some(quad.number))
        } else if index < ends[2] {
            let solid = old.2[index - ends[1]];
            group.solids.push(solid);
            (ItemKind::Solid(group.solids.len() - 1), Some(solid.number))
        } else {
            group.instances.push(old.3[index - ends[2]]);
            (ItemKind::Instance(group.instances.len() - 1), None)
        };
        let item = Item::new(kind);
        items.push(item);
        if let Some(number) = number {
            group.places[number as usize] = Some(item);
        }
    }
    name_leaves(group, &leaves, &items);
    Ok(())
}

/// Calls each leaf by the item it holds; triangles and parallelograms, up to eight, are packed into a block for that.
fn name_leaves(group: &mut Group, leaves: &Leaves, items: &[Item]) {
    let mut bvh = std::mem::take(&mut group.bvh);
    bvh.relabel(|leaf| {
        let items = &items[leaves.range(leaf)];
        match items.first().map(|item| item.kind()) {
            // Instances stand in the order of the leaves.
            Some(ItemKind::Instance(first)) if items.len() > 1 => {
                return Item::new(ItemKind::TwoInstances(first)).bits();
            }
            Some(ItemKind::Instance(_) | ItemKind::Solid(_)) => return items[0].bits(),
            _ => {}
        }
        let mut block = FlatBlock::EMPTY;
        for (lane, item) in items.iter().enumerate() {
            let (corner, edges) = group.parallelogram(item.kind());
            block.set(lane, corner, edges, item.bits());
        }
        group.blocks.push(block);
        Item::new(ItemKind::Block(group.blocks.len() - 1)).bits()
    });
    group.bvh = bvh;
}

/// Numbers the primitives of the instances after the group's own, in the order of the leaves.
fn number_instances(group: &mut Group, built: &[Group]) -> Result<(), SceneError> {
    for instance in &mut group.instances {
        instance.first = group.total;
        group.total += built[instance.group as usize].total;
        // Far enough from the end of the range that neither this sum nor the number of a plane can overflow.
        if group.total > 1 << 62 {
            return Err(SceneError::TooManyPrimitives);
        }
    }
    Ok(())
}

/// The widened boxes of triangles, quads, solids and instances, in this order.
fn boxes(group: &Group, built: &[Group]) -> Vec<Box3> {
    let triangles = group
        .triangles
        .par_iter()
        .map(|triangle| Bounds3::of(triangle.corners()));
    let quads = group.quads.par_iter().map(|quad| {
        let [u, v] = quad.edges;
        Bounds3::of([
            quad.corner,
            quad.corner + u,
            quad.corner + v,
            quad.corner + u + v,
        ])
    });
    let solids = group
        .solids
        .par_iter()
        .map(|solid| solid.form.bounds_under(&solid.to_unit.inverse()));
    let instances = group.instances.par_iter().map(|instance| {
        let to_parent = group.to_child(instance).inverse();
        let cover = &built[instance.group as usize].cover;
        cover.iter().fold(Bounds3::EMPTY, |bounds, part| {
            bounds.union(&part.transformed(&to_parent))
        })
    });
    triangles
        .chain(quads)
        .chain(solids)
        .chain(instances)
        .map(|bounds| widened(&bounds))
        .collect()
}

/// The stored box: rounding to `f32` is far less than the padding.
fn widened(bounds: &Bounds3) -> Box3 {
    Box3 {
        min: bounds.min.to_array().map(|x| x as f32 - BOX_PADDING),
        max: bounds.max.to_array().map(|x| x as f32 + BOX_PADDING),
    }
}

/// A plane of the world with the map from world coordinates to those in which it is z = 0.
#[derive(Clone, Copy, Debug)]
pub(super) struct WorldPlane {
    pub(super) to_plane: DAffine3,
    pub(super) shape: ShapeRecord,
}

/// Collects all planes, wherever instances put them: they are infinite, so no hierarchy can hold them.
pub(super) fn world_planes(groups: &[PlannedGroup]) -> Result<Vec<WorldPlane>, SceneError> {
    /// Each ray tries every plane.
    const LIMIT: usize = 4096;
    let mut has_planes: Vec<bool> = Vec::with_capacity(groups.len());
    for group in groups {
        let own = group
            .shapes
            .iter()
            .any(|shape| matches!(shape.shape, Shape::Plane));
        let below = group
            .instances
            .iter()
            .any(|instance| has_planes[instance.group]);
        has_planes.push(own || below);
    }
    let mut planes = Vec::new();
    let root = groups.len().checked_sub(1);
    let mut open: Vec<_> = root
        .map(|root| (root, DAffine3::IDENTITY, None))
        .into_iter()
        .collect();
    while let Some((group, to_world, outer)) = open.pop() {
        for planned in &groups[group].shapes {
            if matches!(planned.shape, Shape::Plane) {
                planes.push(WorldPlane {
                    to_plane: (to_world * planned.to_group).inverse(),
                    shape: ShapeRecord {
                        first: 0,
                        material: planned.material,
                        organ: planned.organ,
                        instance_organ: outer.filter(OrganId::is_own).or(planned.instance_organ),
                        mesh: None,
                        is_mirrored: false,
                    },
                });
            }
        }
        if planes.len() > LIMIT || open.len() > LIMIT {
            return Err(SceneError::TooManyPlanes { limit: LIMIT });
        }
        for instance in groups[group]
            .instances
            .iter()
            .filter(|instance| has_planes[instance.group])
        {
            let organ = outer.filter(OrganId::is_own).unwrap_or(instance.organ);
            open.push((instance.group, to_world * instance.to_group, Some(organ)));
        }
    }
    Ok(planes)
}
