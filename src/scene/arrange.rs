//! Putting what a group holds into the order of the hierarchy over it.

use super::Stop;
use super::error::SceneError;
use super::group::{Group, Item, ItemKind};
use crate::accel::{self, Box3, BoxKind, FlatBlock, Leaves};
use crate::math::Bounds3;
use crate::math::tolerance::BOX_PADDING;
use glam::DVec3;
use rayon::prelude::*;

/// Triangles and parallelograms per leaf: as many as are tested at once.
const LEAF_SIZE: usize = accel::WIDTH;

/// Most boxes that stand for a group when the boxes of its instances are made.
const COVER: usize = 32;

/// Builds the hierarchy and puts everything into the order of its leaves.
pub(super) fn arrange(
    group: &mut Group,
    built: &[Group],
    stop: Stop<'_>,
) -> Result<(), SceneError> {
    let boxes = boxes(group, built, stop);
    if stop() {
        return Err(SceneError::Stopped);
    }
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
        if stop() {
            return Err(SceneError::Stopped);
        }
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
    name_leaves(group, &leaves, &items, stop);
    if stop() {
        return Err(SceneError::Stopped);
    }
    Ok(())
}

/// Calls each leaf by the item it holds; triangles and parallelograms, up to eight, are packed into a block for that.
fn name_leaves(group: &mut Group, leaves: &Leaves, items: &[Item], stop: Stop<'_>) {
    let mut bvh = std::mem::take(&mut group.bvh);
    bvh.relabel(|leaf| {
        // What is stopped is thrown away, whatever its leaves are called.
        if stop() {
            return leaf;
        }
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
pub(super) fn number_instances(group: &mut Group, built: &[Group]) -> Result<(), SceneError> {
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

/// The widened boxes of triangles, quads, solids and instances, in this order; once `stop` says so, of nothing.
fn boxes(group: &Group, built: &[Group], stop: Stop<'_>) -> Vec<Box3> {
    let triangles = group
        .triangles
        .par_iter()
        .map(|triangle| unless(stop, || Bounds3::of(triangle.corners())));
    let quads = group.quads.par_iter().map(|quad| {
        let (corner, [u, v]) = (quad.corner, quad.edges);
        unless(stop, || {
            Bounds3::of([corner, corner + u, corner + v, corner + u + v])
        })
    });
    let solids = group
        .solids
        .par_iter()
        .map(|solid| unless(stop, || solid.form.bounds_under(&solid.to_unit.inverse())));
    let instances = group.instances.par_iter().map(|instance| {
        let cover = &built[instance.group as usize].cover;
        unless(stop, || {
            let to_parent = group.to_child(instance).inverse();
            cover.iter().fold(Bounds3::EMPTY, |bounds, part| {
                bounds.union(&part.transformed(&to_parent))
            })
        })
    });
    triangles
        .chain(quads)
        .chain(solids)
        .chain(instances)
        .map(|bounds| widened(&bounds))
        .collect()
}

/// The box that `made` makes; an empty one once `stop` says so.
fn unless(stop: Stop<'_>, made: impl FnOnce() -> Bounds3) -> Bounds3 {
    if stop() { Bounds3::EMPTY } else { made() }
}

/// The stored box: rounding to `f32` is far less than the padding.
fn widened(bounds: &Bounds3) -> Box3 {
    Box3 {
        min: bounds.min.to_array().map(|x| x as f32 - BOX_PADDING),
        max: bounds.max.to_array().map(|x| x as f32 + BOX_PADDING),
    }
}
