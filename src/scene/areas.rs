//! How much surface each organ has.

use super::Scene;
use super::emitter::Emitter;
use crate::math::PrimitiveId;

/// Primitives of the world beyond which areas are not added up: it would take minutes.
const MOST: u64 = 1 << 25;

impl Scene {
    /// Area of the surfaces that [belong](super::SurfacePoint::owner) to each organ below `n_organs`, m², each counted once however
    /// many sides it has, and without infinite planes; `None` of a scene that is too large for that.
    #[must_use]
    pub fn areas(&self, n_organs: usize) -> Option<Vec<f64>> {
        let mut areas = vec![0.0; n_organs];
        let Some(root) = self.groups.len().checked_sub(1) else {
            return Some(areas);
        };
        if self.groups[root].total > MOST {
            return None;
        }
        let mut open = vec![(root, None, self.to_root.inverse())];
        while let Some((index, outer, to_world)) = open.pop() {
            let group = &self.groups[index];
            for (at, shape) in group.shapes.iter().enumerate() {
                let next = group.shapes.get(at + 1);
                let end = next.map_or(group.places.len(), |next| next.first as usize);
                let inner = shape
                    .instance_organ
                    .filter(crate::scene::description::OrganId::is_own);
                let owner = outer.or(inner).unwrap_or(shape.organ);
                let Some(sum) = areas.get_mut(owner.0 as usize) else {
                    continue;
                };
                for item in group.places[shape.first as usize..end].iter().flatten() {
                    let primitive = PrimitiveId::NONE;
                    let surface = Emitter::new(group, item.kind(), shape, &to_world, primitive);
                    *sum += surface.map_or(0.0, |surface| surface.area());
                }
            }
            for instance in &group.instances {
                let own = Some(instance.organ).filter(|organ| organ.is_own());
                let to_world = to_world * group.to_child(instance).inverse();
                open.push((instance.group as usize, outer.or(own), to_world));
            }
        }
        Some(areas)
    }
}
