//! From the shaders of a model to materials: what GroIMP's classes and our own mean in terms of light.

use super::appearance::Purpose;
use crate::color::Rgb;
use crate::eval::Value;
use crate::eval::object::{Data, Finish, Phong, Shaders};
use crate::library::ClassId;
use crate::material::{Lobe, LobeKind, Material, Reflection, Side};
use crate::math::functions::ln;

/// Exponent of the gloss of a `Phong` shader whose shininess was not set (GroIMP's).
const DEFAULT_EXPONENT: f64 = 4.0;

/// How many shaders may be within each other.
const DEEPEST: u32 = 16;

/// The surface that a shader describes for this purpose; `None` of what is no shader.
pub(super) fn surface(value: &Value, purpose: Purpose) -> Option<Material> {
    nested(value, purpose, DEEPEST)
}

fn nested(value: &Value, purpose: Purpose, deeper: u32) -> Option<Material> {
    let object = value.as_object()?;
    let shaders = match &*object.lock() {
        Data::Shader(rgba) => {
            let [r, g, b, alpha] = rgba.map(f64::from);
            return Some(Material::lambert(Rgb::new(r, g, b)).with_alpha(alpha));
        }
        Data::Phong(shader) => return Some(phong(shader)),
        Data::Finish(shader) => return Some(finish(object.class, shader)),
        Data::Shaders(shaders) => Shaders::clone(shaders),
        _ => return None,
    };
    let part = |shader| {
        let known = deeper
            .checked_sub(1)
            .and_then(|deeper| nested(shader, purpose, deeper));
        known.unwrap_or_default()
    };
    if object.class == ClassId::AlgorithmSwitchShader {
        // Where nothing is said for light models, light meets what is seen.
        let has_second = purpose == Purpose::LightModel && !shaders.second.is_null();
        return Some(part(if has_second {
            &shaders.second
        } else {
            &shaders.first
        }));
    }
    let (first, second) = (part(&shaders.first), part(&shaders.second));
    Some(match object.class {
        ClassId::MixShader => {
            let share = shaders.share;
            let share = if share.is_nan() { 0.0 } else { share };
            Material::mixed(&first, &second, share.clamp(0.0, 1.0))
        }
        _ => Material::two_sided(&first, &second),
    })
}

fn finish(class: ClassId, shader: &Finish) -> Material {
    let color = Rgb::from_array(shader.color);
    match class {
        ClassId::Metal => Material::metal(color, shader.roughness),
        ClassId::Glass => Material::glass(shader.ior, shader.roughness, color),
        ClassId::Pane => Material::pane(shader.ior, color),
        ClassId::LeafShader => Material::leaf(color, Rgb::from_array(shader.through)),
        _ => Material::mirror(color),
    }
}

/// GroIMP's `Phong`, after the formulas in its documentation. With `c_t` the transparency, what does not pass, `1 - c_t`, is what
/// the matt and glossy parts get (unless `interpolatedTransparency` is off); the diffuse transparency gets it all.
fn phong(shader: &Phong) -> Material {
    let through = Rgb::from_array(shader.transparency);
    let rest = if shader.is_interpolated {
        Rgb::WHITE - through
    } else {
        Rgb::WHITE
    };
    let side = Side {
        reflectance: Rgb::from_array(shader.diffuse) * rest,
        transmittance: Rgb::from_array(shader.diffuse_transparency),
    };
    let mut lobes = Vec::new();
    let specular = Rgb::from_array(shader.specular) * rest;
    if !specular.is_black() {
        let kind = match shader.shininess.map_or(Some(DEFAULT_EXPONENT), exponent) {
            Some(exponent) => LobeKind::Phong { exponent },
            None => LobeKind::Mirror(Reflection::Even),
        };
        lobes.push(Lobe::new(kind, specular));
    }
    if !through.is_black() {
        let kind = match shader.transparency_shininess.and_then(exponent) {
            Some(exponent) => LobeKind::Haze { exponent },
            None => LobeKind::Through,
        };
        lobes.push(Lobe::new(kind, through));
    }
    let emissive = Rgb::from_array(shader.emissive);
    Material {
        lobes: lobes.into(),
        ..Material::matt([side, side])
    }
    .emitting(emissive, emissive)
}

/// The exponent of a sharpness as GroIMP converts it: with s = x (2 - x), -2 / ln s; 0 below, `None` (a mirror) from 1 on.
fn exponent(sharpness: f64) -> Option<f64> {
    let s = sharpness * (2.0 - sharpness);
    if s >= 1.0 {
        None
    } else if s > 0.0 {
        let exponent = -2.0 / ln(s);
        exponent.is_finite().then_some(exponent)
    } else {
        Some(0.0)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn sharpness_becomes_an_exponent() {
        assert_eq!(exponent(0.0), Some(0.0));
        assert_eq!(exponent(-1.0), Some(0.0));
        assert_eq!(exponent(1.0), None);
        // GroIMP takes 2 as 0 and what is beyond as below 0.
        assert_eq!(exponent(2.0), Some(0.0));
        assert!((exponent(0.5).unwrap() - -2.0 / 0.75_f64.ln()).abs() < 1e-12);
    }

    #[test]
    fn phong_shares_the_light_as_groimp_says() {
        let mut shader = Phong {
            diffuse: [0.4; 3],
            specular: [0.2; 3],
            transparency: [0.5; 3],
            ..Phong::default()
        };
        let drawn = phong(&shader);
        assert!((drawn.sides[0].reflectance.g - 0.2).abs() < 1e-15);
        assert_eq!(
            drawn.lobes[0],
            Lobe::new(LobeKind::Phong { exponent: 4.0 }, Rgb::splat(0.1))
        );
        assert_eq!(
            drawn.lobes[1],
            Lobe::new(LobeKind::Through, Rgb::splat(0.5))
        );
        shader.is_interpolated = false;
        let drawn = phong(&shader);
        assert_eq!(drawn.sides[1].reflectance, Rgb::splat(0.4));
        assert_eq!(drawn.lobes[0].weight, Rgb::splat(0.2));
        shader.shininess = Some(1.0);
        shader.emissive = [3.0; 3];
        let drawn = phong(&shader);
        assert_eq!(drawn.lobes[0].kind, LobeKind::Mirror(Reflection::Even));
        assert_eq!(drawn.emission, [Rgb::splat(3.0); 2]);
    }
}
