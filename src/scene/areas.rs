//! How much surface each organ has.

use super::Scene;
use super::description::OrganId;
use super::emitter::Emitter;
use crate::material::Material;
use crate::math::PrimitiveId;
use std::collections::BTreeMap;

/// Primitives of the world beyond which areas are not added up: it would take minutes.
const MOST: u64 = 1 << 25;

impl Scene {
    /// Area of the surfaces that [belong](super::SurfacePoint::owner) to each organ below `n_organs`, m², each counted once however
    /// many sides it has, and without infinite planes; `None` of a scene that is too large for that.
    #[must_use]
    pub fn areas(&self, n_organs: usize) -> Option<Vec<f64>> {
        let mut areas = vec![0.0; n_organs];
        let all = |_: &Material| true;
        self.each_area(all, |organ, area| {
            if let Some(sum) = areas.get_mut(organ.0 as usize) {
                *sum += area;
            }
        })?;
        Some(areas)
    }

    /// The same of the organs that have surfaces of a material that `wanted` picks, these surfaces alone.
    #[must_use]
    pub fn areas_of(&self, wanted: impl Fn(&Material) -> bool) -> Option<BTreeMap<OrganId, f64>> {
        let mut areas = BTreeMap::new();
        self.each_area(wanted, |organ, area| {
            *areas.entry(organ).or_default() += area;
        })?;
        Some(areas)
    }

    /// Tells the owner and the area of each surface whose material `wanted` picks; `None` of a scene that is too large for that.
    fn each_area(
        &self,
        wanted: impl Fn(&Material) -> bool,
        mut found: impl FnMut(OrganId, f64),
    ) -> Option<()> {
        let Some(root) = self.groups.len().checked_sub(1) else {
            return Some(());
        };
        let wanted: Vec<bool> = self.materials.iter().map(wanted).collect();
        if self.groups[root].total > MOST {
            return None;
        }
        let mut open = vec![(root, None, self.to_root.inverse())];
        while let Some((index, outer, to_world)) = open.pop() {
            let group = &self.groups[index];
            for (at, shape) in group.shapes.iter().enumerate() {
                let next = group.shapes.get(at + 1);
                let end = next.map_or(group.places.len(), |next| next.first as usize);
                let inner = shape.instance_organ.filter(OrganId::is_own);
                let owner = outer.or(inner).unwrap_or(shape.organ);
                if !wanted[shape.material.0 as usize] {
                    continue;
                }
                for item in group.places[shape.first as usize..end].iter().flatten() {
                    let primitive = PrimitiveId::NONE;
                    let surface = Emitter::new(group, item.kind(), shape, &to_world, primitive);
                    found(owner, surface.map_or(0.0, |surface| surface.area()));
                }
            }
            for instance in &group.instances {
                let own = Some(instance.organ).filter(|organ| organ.is_own());
                let to_world = to_world * group.to_child(instance).inverse();
                open.push((instance.group as usize, outer.or(own), to_world));
            }
        }
        Some(())
    }
}
