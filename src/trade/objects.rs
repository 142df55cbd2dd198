//! Which object each pixel shows, so that a bias can be blamed.

use crate::camera::Camera;
use crate::interpret::Organs;
use crate::scene::Scene;
use crate::scene::description::OrganId;
use glam::DVec2;
use std::collections::BTreeMap;

/// With more visible organs than this, all of one type count as one object.
const MOST_ORGANS: usize = 24;
/// An object with fewer pixels is not told: nothing can be said about it.
const FEWEST_PIXELS: usize = 16;

/// The objects of a picture.
#[derive(Clone, Debug, Default, PartialEq)]
pub(super) struct Objects {
    /// Their names.
    pub(super) names: Vec<String>,
    /// Of each pixel, the number of the object; that of the names where there is none worth a name.
    pub(super) of_pixel: Vec<usize>,
}

impl Objects {
    /// What the middle of each pixel shows.
    #[must_use]
    pub(super) fn seen(
        scene: &Scene,
        camera: &Camera,
        [width, height]: [u32; 2],
        organs: Option<&Organs>,
    ) -> Self {
        let size = DVec2::new(f64::from(width), f64::from(height));
        let pixels = (0..height).flat_map(|y| (0..width).map(move |x| (x, y)));
        let organ = |(x, y): (u32, u32)| {
            let ray = camera.ray((DVec2::new(f64::from(x), f64::from(y)) + 0.5) / size);
            scene
                .closest(&ray)
                .map(|hit| scene.surface(&ray, &hit).organ)
        };
        let seen: Vec<Option<OrganId>> = pixels.map(organ).collect();
        Self::named(&seen, &|id| {
            organs
                .and_then(|organs| organs.type_name(id))
                .unwrap_or("ground")
                .to_owned()
        })
    }

    fn named(seen: &[Option<OrganId>], type_name: &dyn Fn(OrganId) -> String) -> Self {
        let mut counts: BTreeMap<OrganId, usize> = BTreeMap::new();
        for id in seen.iter().flatten() {
            *counts.entry(*id).or_default() += 1;
        }
        let are_few = counts.len() <= MOST_ORGANS;
        let name = |id: OrganId| {
            if are_few {
                format!("{} {}", type_name(id), id.0)
            } else {
                type_name(id)
            }
        };
        let mut sizes: BTreeMap<String, usize> = BTreeMap::new();
        for (id, n) in &counts {
            *sizes.entry(name(*id)).or_default() += n;
        }
        sizes.retain(|_, n| *n >= FEWEST_PIXELS);
        let names: Vec<String> = sizes.into_keys().collect();
        let number: BTreeMap<OrganId, usize> = counts
            .keys()
            .map(|&id| (id, names.binary_search(&name(id)).unwrap_or(names.len())))
            .collect();
        let of_pixel = seen
            .iter()
            .map(|id| id.map_or(names.len(), |id| number[&id]));
        Self {
            of_pixel: of_pixel.collect(),
            names,
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn seen(organs: impl IntoIterator<Item = u32>) -> Vec<Option<OrganId>> {
        organs.into_iter().map(|id| Some(OrganId(id))).collect()
    }

    #[test]
    fn few_organs_have_names_of_their_own_and_many_those_of_their_types() {
        let mut few = seen([3; 20]);
        few.extend(seen([5; 16]));
        few.extend([None, Some(OrganId(9))]);
        let found = Objects::named(&few, &|_| "Leaf".to_owned());
        assert_eq!(found.names, ["Leaf 3", "Leaf 5"]);
        assert_eq!(found.of_pixel[19..22], [0, 1, 1]);
        // The sky, and what is too small to speak of.
        assert_eq!(found.of_pixel[36..], [2, 2]);
        let kind = |id: OrganId| {
            if id.0.is_multiple_of(2) {
                "Leaf"
            } else {
                "Shoot"
            }
            .to_owned()
        };
        let found = Objects::named(&seen((0..400).map(|i| i % 100)), &kind);
        assert_eq!(found.names, ["Leaf", "Shoot"]);
    }
}
