//! From shaders and colours to materials, each made once.

use super::appearance::Surface;
use crate::color::{Rgb, palette};
use crate::geometry::import::MeshMaterial;
use crate::material::Material;
use crate::math::tolerance::ENERGY_EXCESS;
use crate::scene::description::MaterialId;
use std::collections::HashMap;

/// Reflectance of what has no shader: GroIMP's grey.
const GREY: [f64; 3] = [0.5; 3];

/// The bits of a surface and its emission.
type Key = [u64; 10];

/// The materials of a scene.
#[derive(Debug, Default)]
pub(super) struct Materials {
    list: Vec<Material>,
    /// Looked up only, never iterated.
    by_key: HashMap<Key, MaterialId>,
    grey: Option<MaterialId>,
    palette: [Option<MaterialId>; 16],
}

/// What a material had to be changed in to be possible.
pub(super) type Problem = &'static str;

impl Materials {
    /// The default grey.
    pub(super) fn grey(&mut self) -> MaterialId {
        match self.grey {
            Some(known) => known,
            None => {
                let (id, _) = self.of(&Surface::opaque(GREY), Rgb::BLACK);
                self.grey = Some(id);
                id
            }
        }
    }

    /// The EGA colour of this index; only its low four bits count.
    pub(super) fn ega(&mut self, index: i32) -> MaterialId {
        let place = index.rem_euclid(16) as usize;
        match self.palette[place] {
            Some(known) => known,
            None => {
                let color = palette::ega(index).to_array();
                let (id, _) = self.of(&Surface::opaque(color), Rgb::BLACK);
                self.palette[place] = Some(id);
                id
            }
        }
    }

    /// The material of a surface that shines with this radiance on its front. Told once: what was impossible about it.
    pub(super) fn of(&mut self, surface: &Surface, emission: Rgb) -> (MaterialId, Option<Problem>) {
        let key = key(surface, emission);
        if let Some(known) = self.by_key.get(&key) {
            return (*known, None);
        }
        let (possible, problem) = made_possible(surface);
        let rgb = Rgb::from_array;
        let material = Material::leaf(rgb(possible.reflectance), rgb(possible.transmittance))
            .with_alpha(possible.alpha)
            .emitting(emission, Rgb::BLACK);
        let id = MaterialId(u32::try_from(self.list.len()).unwrap_or(u32::MAX));
        self.list.push(material);
        self.by_key.insert(key, id);
        (id, problem)
    }

    /// The material of a part of a mesh file.
    pub(super) fn of_mesh(&mut self, of: &MeshMaterial) -> MaterialId {
        let surface = Surface {
            alpha: of.alpha,
            ..Surface::opaque(of.base_color)
        };
        self.of(&surface, Rgb::from_array(of.emission)).0
    }

    /// Whether this material shines.
    pub(super) fn shines(&self, id: MaterialId) -> bool {
        self.list
            .get(id.0 as usize)
            .is_some_and(Material::is_emitter)
    }

    pub(super) fn into_list(self) -> Vec<Material> {
        self.list
    }
}

fn key(surface: &Surface, emission: Rgb) -> Key {
    let [a, b, c] = surface.reflectance;
    let [d, e, f] = surface.transmittance;
    let [g, h, i] = emission.to_array();
    [a, b, c, d, e, f, surface.alpha, g, h, i].map(f64::to_bits)
}

/// The nearest surface that can exist, and what was wrong.
fn made_possible(surface: &Surface) -> (Surface, Option<Problem>) {
    let mut possible = *surface;
    let mut problem = None;
    let parts = possible
        .reflectance
        .iter_mut()
        .chain(&mut possible.transmittance)
        .chain(std::iter::once(&mut possible.alpha));
    for part in parts {
        if !(0.0..=1.0).contains(part) {
            *part = if part.is_nan() {
                0.0
            } else {
                part.clamp(0.0, 1.0)
            };
            problem = Some(
                "a shader with a value outside 0..1, which is drawn as the nearest one inside",
            );
        }
    }
    let sums = (0..3).map(|i| possible.reflectance[i] + possible.transmittance[i]);
    let most = sums.fold(0.0, f64::max);
    if most > 1.0 {
        possible.reflectance = possible.reflectance.map(|part| part / most);
        possible.transmittance = possible.transmittance.map(|part| part / most);
    }
    if most > 1.0 + ENERGY_EXCESS {
        problem = Some(
            "a shader that reflects and transmits more light than it gets; both are scaled down in proportion",
        );
    }
    (possible, problem)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn equal_surfaces_share_a_material() {
        let mut materials = Materials::default();
        let red = Surface::opaque([1.0, 0.0, 0.0]);
        let (a, _) = materials.of(&red, Rgb::BLACK);
        let (b, _) = materials.of(&red, Rgb::BLACK);
        let (lamp, _) = materials.of(&red, Rgb::WHITE);
        assert_eq!(a, b);
        assert_ne!(a, lamp);
        assert!(materials.shines(lamp) && !materials.shines(a));
        assert_eq!(materials.ega(14), materials.ega(30));
        assert_eq!(
            materials.grey(),
            materials.of(&Surface::opaque(GREY), Rgb::BLACK).0
        );
        assert_eq!(materials.into_list().len(), 4);
    }

    #[test]
    fn impossible_surfaces_are_scaled_and_told_once() {
        let mut materials = Materials::default();
        let leaf = Surface {
            reflectance: [0.2, 0.9, 0.1],
            transmittance: [0.1, 0.6, 0.1],
            alpha: 1.0,
        };
        assert!(materials.of(&leaf, Rgb::BLACK).1.is_some());
        assert!(materials.of(&leaf, Rgb::BLACK).1.is_none());
        let wild = Surface {
            reflectance: [f64::NAN, 7.0, -1.0],
            transmittance: [0.0; 3],
            alpha: 2.0,
        };
        assert!(materials.of(&wild, Rgb::BLACK).1.is_some());
        let edge = Surface {
            reflectance: [f64::from(0.7_f32); 3],
            transmittance: [f64::from(0.3_f32); 3],
            alpha: 1.0,
        };
        assert!(materials.of(&edge, Rgb::BLACK).1.is_none());
        for material in materials.into_list() {
            assert_eq!(material.validate(), Ok(()));
        }
    }
}
