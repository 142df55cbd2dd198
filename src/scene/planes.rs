//! Infinite planes: kept beside the groups, for no hierarchy can hold them.

use super::description::OrganId;
use super::error::SceneError;
use super::group::ShapeRecord;
use super::plan::PlannedGroup;
use crate::geometry::Shape;
use glam::DAffine3;

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
