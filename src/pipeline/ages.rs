//! Drawings of a model between two steps: organs that are new are small, organs that fall shrink away.

use super::failure::Failure;
use super::growing::{self, Drawn};
use super::studio::Run;
use crate::diag::Diagnostics;
use crate::graph::NodeId;
use crate::growth::Growth;
use crate::integrator::CancelToken;
use crate::interpret::Purpose;
use crate::scene::description::{GroupId, MaterialId, OrganId};
use glam::{DAffine3, DVec3};
use std::collections::BTreeSet;

/// Draws a grown model as it stands `run.part` of one more step later.
///
/// # Errors
/// If that step fails, or a part of the model cannot be drawn.
pub(super) fn draw_between(
    run: &Run,
    memory: u64,
    growth: &mut Growth,
    cancel: &CancelToken,
) -> Result<(Drawn, Diagnostics), Failure> {
    let draw = |growth: &mut Growth| growing::draw(run, memory, growth, Purpose::Picture, cancel);
    let (earlier, _) = draw(growth)?;
    let numbers = growth.numbers();
    growing::step(run, memory, growth, cancel)?;
    let mut gone: BTreeSet<NodeId> = numbers.nodes().collect();
    gone.retain(|node| !growth.graph().exists(*node));
    let young = growth.go_back(&numbers, run.part);
    let (mut drawn, found) = draw(growth)?;
    drawn.shrink(&young, run.part);
    let mut fallen = earlier;
    fallen.shrink(&gone, 1.0 - run.part);
    drawn.add_from(fallen, &gone);
    Ok((drawn, found))
}

impl Drawn {
    /// The organs of these nodes at this part of their size, each where it begins.
    pub(super) fn shrink(&mut self, nodes: &BTreeSet<NodeId>, part: f64) {
        let organs = self.organs.clone();
        let is_meant = |organ: OrganId| {
            organ.is_own()
                && organs
                    .get(organ)
                    .is_some_and(|organ| nodes.contains(&organ.node))
        };
        let small = DAffine3::from_scale(DVec3::splat(part));
        let Some(group) = self
            .scene
            .root
            .and_then(|root| self.scene.groups.get_mut(root.0 as usize))
        else {
            return;
        };
        for shape in group.shapes.iter_mut().filter(|s| is_meant(s.organ)) {
            shape.to_group *= small;
        }
        for instance in group.instances.iter_mut().filter(|i| is_meant(i.organ)) {
            instance.to_group *= small;
        }
    }

    /// Adds what was drawn of these nodes in an earlier drawing.
    pub(super) fn add_from(&mut self, mut earlier: Self, nodes: &BTreeSet<NodeId>) {
        let Some(root) = earlier.scene.root else {
            return;
        };
        let organs = earlier.organs.clone();
        let is_meant = |organ: OrganId| {
            organ.is_own()
                && organs
                    .get(organ)
                    .is_some_and(|organ| nodes.contains(&organ.node))
        };
        let scene = &mut self.scene;
        let (n_materials, n_groups) = (scene.materials.len() as u32, scene.groups.len() as u32);
        for (number, group) in (0..).zip(&mut earlier.scene.groups) {
            if number == root.0 {
                group.shapes.retain(|shape| is_meant(shape.organ));
                group.instances.retain(|instance| is_meant(instance.organ));
            }
            for shape in &mut group.shapes {
                shape.material = MaterialId(shape.material.0 + n_materials);
                shape.organ = OrganId::COPY;
            }
            for instance in &mut group.instances {
                instance.group = GroupId(instance.group.0 + n_groups);
                instance.organ = OrganId::COPY;
            }
        }
        let gone = std::mem::take(&mut earlier.scene.groups[root.0 as usize]);
        if gone.shapes.is_empty() && gone.instances.is_empty() {
            return;
        }
        scene.materials.append(&mut earlier.scene.materials);
        scene.groups.append(&mut earlier.scene.groups);
        let Some(group) = scene
            .root
            .and_then(|root| scene.groups.get_mut(root.0 as usize))
        else {
            return;
        };
        group.shapes.extend(gone.shapes);
        group.instances.extend(gone.instances);
    }
}
