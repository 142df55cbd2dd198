//! Materials, each made once, and made possible.

use crate::color::{Rgb, palette};
use crate::geometry::import::MeshMaterial;
use crate::material::texture::{Layer, MAX_PICTURES, Pictures, Texture};
use crate::material::{Lobe, LobeKind, MAX_LOBES, Material, Reflection, Side};
use crate::math::tolerance::{ENERGY_EXCESS, SMOOTHEST_ALPHA};
use crate::scene::description::MaterialId;
use std::collections::HashMap;
use std::sync::Arc;

/// The materials of a scene.
#[derive(Debug, Default)]
pub(super) struct Materials {
    list: Vec<Material>,
    /// By all their bits. Looked up only, never iterated.
    by_key: HashMap<Box<[u64]>, MaterialId>,
    /// Room for the key that is looked up.
    key: Vec<u64>,
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
                let (id, _) = self.of(Material::default());
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
                let (id, _) = self.of(Material::lambert(palette::ega(index)));
                self.palette[place] = Some(id);
                id
            }
        }
    }

    /// The number of a material. Told once: what was impossible about it.
    pub(super) fn of(&mut self, mut material: Material) -> (MaterialId, Option<Problem>) {
        self.key.clear();
        write_key(&material, &mut self.key);
        if let Some(known) = self.by_key.get(&self.key[..]) {
            return (*known, None);
        }
        let problem = make_possible(&mut material);
        let id = MaterialId(u32::try_from(self.list.len()).unwrap_or(u32::MAX));
        self.list.push(material);
        self.by_key.insert(self.key.as_slice().into(), id);
        (id, problem)
    }

    /// The material of a part of a mesh file.
    ///
    /// `look` is the picture of its colour and `holes` that of where it is. Metals have its mean colour.
    pub(super) fn of_mesh(
        &mut self,
        of: &MeshMaterial,
        look: Option<Texture>,
        holes: Option<Texture>,
    ) -> (MaterialId, Option<Problem>) {
        let emission = Rgb::from_array(of.emission);
        let color = Rgb::from_array(of.base_color);
        let mean = look.as_ref().map_or(Rgb::WHITE, |look| look.image.mean());
        let mut material = match look {
            Some(texture) => in_picture(texture, color),
            None => Material::lambert(color),
        };
        if of.metallic > 0.0 {
            let metal = Material::metal(color * mean, of.roughness);
            material = Material::mixed(&material, &metal, of.metallic);
        }
        if of.transmission > 0.0 {
            let glass = Material::glass(of.ior, of.roughness, Rgb::BLACK);
            material = Material::mixed(&material, &glass, of.transmission);
        }
        let mut material = material.with_alpha(of.alpha);
        if let Some(texture) = holes {
            let pictures = material.pictures.get_or_insert_default();
            pictures.holes = vec![texture];
        }
        self.of(material.emitting(emission, Rgb::BLACK))
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

/// A matt surface in the colours of a picture, times one.
fn in_picture(texture: Texture, color: Rgb) -> Material {
    let side = Side {
        reflectance: color,
        transmittance: Rgb::BLACK,
    };
    let layer = Layer {
        texture,
        sides: [side; 2],
    };
    let pictures = Pictures {
        layers: vec![layer],
        holes: vec![],
    };
    Material {
        pictures: Some(Box::new(pictures)),
        ..Material::matt([Side::default(); 2])
    }
}

/// Writes all that a material is.
fn write_key(material: &Material, key: &mut Vec<u64>) {
    let Material {
        sides,
        lobes,
        alpha,
        emission,
        pictures,
    } = material;
    let mut rgb = |rgb: Rgb| key.extend(rgb.to_array().map(f64::to_bits));
    for side in sides {
        rgb(side.reflectance);
        rgb(side.transmittance);
    }
    emission.iter().for_each(|side| rgb(*side));
    key.push(alpha.to_bits());
    for lobe in lobes {
        let (kind, numbers, color) = match lobe.kind {
            LobeKind::Mirror(reflection) => {
                let (kind, number, color) = of_reflection(reflection);
                (kind, [number, 0.0], color)
            }
            LobeKind::Rough { alpha, reflection } => {
                let (kind, number, color) = of_reflection(reflection);
                (3 + kind, [number, alpha], color)
            }
            LobeKind::Phong { exponent } => (6, [exponent, 0.0], Rgb::BLACK),
            LobeKind::Haze { exponent } => (7, [exponent, 0.0], Rgb::BLACK),
            LobeKind::Dielectric {
                ior,
                alpha,
                absorption,
            } => (8, [ior, alpha], absorption),
            LobeKind::Pane { ior, tint } => (9, [ior, 0.0], tint),
            LobeKind::Through => (10, [0.0; 2], Rgb::BLACK),
        };
        key.push(4 * kind + lobe.sides as u64);
        key.extend(numbers.map(f64::to_bits));
        for rgb in [lobe.weight, color] {
            key.extend(rgb.to_array().map(f64::to_bits));
        }
    }
    if let Some(pictures) = pictures {
        // Between lobes and layers, so that neither is taken for the other.
        key.push(u64::MAX);
        for layer in &pictures.layers {
            write_texture(&layer.texture, key);
            for side in &layer.sides {
                for rgb in [side.reflectance, side.transmittance] {
                    key.extend(rgb.to_array().map(f64::to_bits));
                }
            }
        }
        key.push(pictures.layers.len() as u64);
        for hole in &pictures.holes {
            write_texture(hole, key);
        }
    }
}

/// Writes what a picture is. Equal pictures are one, which stays where it is as long as a material has it.
fn write_texture(texture: &Texture, key: &mut Vec<u64>) {
    let Texture {
        image,
        map,
        wrap,
        filter,
        cutoff,
    } = texture;
    key.push(Arc::as_ptr(image) as usize as u64);
    key.extend(map.to_cols_array().map(f64::to_bits));
    key.push((wrap[0] as u64) << 16 | (wrap[1] as u64) << 8 | *filter as u64);
    key.push(cutoff.map_or(u64::MAX, f64::to_bits));
}

fn of_reflection(reflection: Reflection) -> (u64, f64, Rgb) {
    match reflection {
        Reflection::Even => (0, 0.0, Rgb::BLACK),
        Reflection::Metal(color) => (1, 0.0, color),
        Reflection::Varnish(ior) => (2, ior, Rgb::BLACK),
    }
}

const OUTSIDE: Problem =
    "a shader with a value outside 0..1, which is drawn as the nearest one inside";
const BRIGHTER: Problem = "a shader that reflects and transmits more light than it gets; both are scaled down in proportion";
const NO_INDEX: Problem =
    "a shader whose index of refraction is not above 0; it is drawn as if it were 1.5";
const NO_NUMBER: Problem = "a shader with a number that is negative or none; 0 is taken";
const TWO_BODIES: Problem =
    "a mixture of two kinds of `Glass`, of which only the first is drawn; a body has one inside";
const TOO_MANY_PICTURES: Problem = "a shader of too many pictures; only the first eight are drawn";
const SHINING_HOLES: Problem =
    "a shader that shines and whose picture is transparent in places; it shines there, too";
const TOO_MANY: Problem =
    "a shader of too many glossy and clear parts; only the first four are drawn";

/// Changes a material to the nearest one that can exist, and tells what was wrong.
fn make_possible(material: &mut Material) -> Option<Problem> {
    let mut problem = None;
    let mut fraction = |part: &mut f64| {
        if !(0.0..=1.0).contains(part) {
            *part = if part.is_nan() {
                0.0
            } else {
                part.clamp(0.0, 1.0)
            };
            problem = Some(OUTSIDE);
        }
    };
    fraction(&mut material.alpha);
    for side in &mut material.sides {
        of_rgb(&mut side.reflectance, &mut fraction);
        of_rgb(&mut side.transmittance, &mut fraction);
    }
    for lobe in &mut material.lobes {
        of_rgb(&mut lobe.weight, &mut fraction);
    }
    for layer in material.pictures.iter_mut().flat_map(|p| &mut p.layers) {
        for side in &mut layer.sides {
            of_rgb(&mut side.reflectance, &mut fraction);
            of_rgb(&mut side.transmittance, &mut fraction);
        }
    }
    problem = possible_pictures(material).or(problem);
    if material.lobes.len() > MAX_LOBES {
        material.lobes = material.lobes[..MAX_LOBES].into();
        problem = Some(TOO_MANY);
    }
    if material.lobes.iter().filter(|lobe| lobe.is_body()).count() > 1 {
        let mut n_bodies = 0;
        let lobes = material.lobes.iter().filter(|lobe| {
            n_bodies += usize::from(lobe.is_body());
            !lobe.is_body() || n_bodies == 1
        });
        material.lobes = lobes.copied().collect();
        problem = Some(TWO_BODIES);
    }
    for lobe in &mut material.lobes {
        problem = possible_lobe(lobe).or(problem);
    }
    for side in &mut material.emission {
        let mut amount = |part: &mut f64| {
            if !(*part >= 0.0 && part.is_finite()) {
                *part = 0.0;
                problem = Some(NO_NUMBER);
            }
        };
        of_rgb(side, &mut amount);
    }
    scaled_down(material).or(problem)
}

/// Leaves out the pictures that are too many, and holes in what shines.
fn possible_pictures(material: &mut Material) -> Option<Problem> {
    let shines = material.is_emitter();
    let pictures = material.pictures.as_mut()?;
    let mut problem = None;
    if pictures.layers.len().max(pictures.holes.len()) > MAX_PICTURES {
        pictures.layers.truncate(MAX_PICTURES);
        pictures.holes.truncate(MAX_PICTURES);
        problem = Some(TOO_MANY_PICTURES);
    }
    if shines && !pictures.holes.is_empty() {
        pictures.holes.clear();
        problem = Some(SHINING_HOLES);
    }
    problem
}

fn of_rgb(rgb: &mut Rgb, change: &mut impl FnMut(&mut f64)) {
    change(&mut rgb.r);
    change(&mut rgb.g);
    change(&mut rgb.b);
}

/// Makes the numbers of a lobe possible.
fn possible_lobe(lobe: &mut Lobe) -> Option<Problem> {
    let mut problem = None;
    let mut fraction = |part: &mut f64| {
        if !(0.0..=1.0).contains(part) {
            *part = if *part > 1.0 { 1.0 } else { 0.0 };
            problem = Some(OUTSIDE);
        }
    };
    match &mut lobe.kind {
        LobeKind::Mirror(Reflection::Metal(color)) => of_rgb(color, &mut fraction),
        LobeKind::Rough { alpha, reflection } => {
            fraction(alpha);
            *alpha = alpha.max(SMOOTHEST_ALPHA);
            if let Reflection::Metal(color) = reflection {
                of_rgb(color, &mut fraction);
            }
        }
        LobeKind::Dielectric { alpha, .. } => fraction(alpha),
        LobeKind::Pane { tint, .. } => of_rgb(tint, &mut fraction),
        LobeKind::Mirror(_)
        | LobeKind::Phong { .. }
        | LobeKind::Haze { .. }
        | LobeKind::Through => {}
    }
    if let LobeKind::Dielectric { ior, .. } | LobeKind::Pane { ior, .. } = &mut lobe.kind
        && !(*ior > 0.0 && ior.is_finite())
    {
        *ior = 1.5;
        problem = Some(NO_INDEX);
    }
    if let LobeKind::Dielectric { absorption, .. } = &mut lobe.kind {
        let mut amount = |part: &mut f64| {
            if !(*part >= 0.0 && part.is_finite()) {
                *part = 0.0;
                problem = Some(NO_NUMBER);
            }
        };
        of_rgb(absorption, &mut amount);
    }
    problem
}

/// Scales a material that would make light.
fn scaled_down(material: &mut Material) -> Option<Problem> {
    let most = [true, false].map(|is_front| material.claim(is_front).max_channel());
    let most = most[0].max(most[1]);
    if most > 1.0 {
        for side in &mut material.sides {
            side.reflectance = side.reflectance / most;
            side.transmittance = side.transmittance / most;
        }
        for lobe in &mut material.lobes {
            lobe.weight = lobe.weight / most;
        }
        for layer in material.pictures.iter_mut().flat_map(|p| &mut p.layers) {
            for side in &mut layer.sides {
                side.reflectance = side.reflectance / most;
                side.transmittance = side.transmittance / most;
            }
        }
    }
    (most > 1.0 + ENERGY_EXCESS).then_some(BRIGHTER)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn equal_surfaces_share_a_material() {
        let mut materials = Materials::default();
        let red = Material::lambert(Rgb::new(1.0, 0.0, 0.0));
        let (a, _) = materials.of(red.clone());
        let (b, _) = materials.of(red.clone());
        let (lamp, _) = materials.of(red.emitting(Rgb::WHITE, Rgb::BLACK));
        assert_eq!(a, b);
        assert_ne!(a, lamp);
        assert!(materials.shines(lamp) && !materials.shines(a));
        assert_eq!(materials.ega(14), materials.ega(30));
        assert_eq!(materials.grey(), materials.of(Material::default()).0);
        assert_eq!(materials.into_list().len(), 4);
    }

    #[test]
    fn every_number_of_a_shader_counts() {
        let gold = Rgb::new(1.0, 0.7, 0.3);
        let clear = Rgb::BLACK;
        let all = [
            Material::mirror(gold),
            Material::mirror(Rgb::WHITE),
            Material::metal(gold, 0.0),
            Material::metal(gold, 0.3),
            Material::metal(gold, 0.4),
            Material::glass(1.5, 0.0, clear),
            Material::glass(1.6, 0.0, clear),
            Material::glass(1.5, 0.2, clear),
            Material::glass(1.5, 0.0, gold),
            Material::pane(1.5, Rgb::WHITE),
            Material::pane(1.5, gold),
            Material::two_sided(&Material::mirror(gold), &Material::default()),
            Material::two_sided(&Material::default(), &Material::mirror(gold)),
            Material::leaf(gold * 0.1, gold * 0.2),
            Material::leaf(gold * 0.2, gold * 0.1),
        ];
        let mut materials = Materials::default();
        for (number, material) in (0..).zip(&all) {
            let (id, problem) = materials.of(material.clone());
            assert_eq!((id, problem), (MaterialId(number), None), "{material:?}");
        }
        assert_eq!(materials.into_list(), all);
    }

    #[test]
    fn impossible_surfaces_are_scaled_and_told_once() {
        let mut materials = Materials::default();
        let leaf = Material::leaf(Rgb::new(0.2, 0.9, 0.1), Rgb::new(0.1, 0.6, 0.1));
        assert!(materials.of(leaf.clone()).1.is_some());
        assert!(materials.of(leaf).1.is_none());
        let bad = Rgb::new(f64::NAN, 7.0, -1.0);
        let half = Material::mirror(Rgb::splat(0.7));
        for wild in [
            Material::lambert(bad).with_alpha(2.0),
            Material::mirror(bad),
            Material::metal(bad, 3.0),
            Material::metal(bad, f64::NAN),
            Material::glass(-1.0, 0.0, Rgb::BLACK),
            Material::glass(f64::NAN, 9.0, bad),
            Material::pane(0.0, bad),
            Material::mixed(
                &Material::glass(1.5, 0.0, Rgb::BLACK),
                &Material::glass(1.3, 0.0, Rgb::BLACK),
                0.5,
            ),
            Material::default().emitting(bad, bad),
            Material {
                lobes: vec![half.lobes[0]; 6].into(),
                ..Material::default()
            },
        ] {
            assert!(materials.of(wild.clone()).1.is_some(), "{wild:?}");
        }
        let edge = Material::leaf(
            Rgb::splat(f64::from(0.7_f32)),
            Rgb::splat(f64::from(0.3_f32)),
        );
        assert!(materials.of(edge).1.is_none());
        for material in materials.into_list() {
            assert_eq!(material.validate(), Ok(()), "{material:?}");
        }
    }
}
