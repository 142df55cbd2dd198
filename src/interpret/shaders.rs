//! From the shaders of a model to materials: what GroIMP's classes and our own mean in terms of light.

use super::appearance::Purpose;
use super::images::Finder;
use crate::color::Rgb;
use crate::eval::Value;
use crate::eval::object::{Data, Finish, Phong, Shaders};
use crate::eval::picture::{Paint, Picture, PictureOf};
use crate::library::ClassId;
use crate::material::image::Coverage;
use crate::material::texture::{Filter, Layer, Pictures, Texture, placement};
use crate::material::{Lobe, LobeKind, Material, Reflection, Side};
use crate::math::functions::ln;
use glam::DVec2;

/// Exponent of the gloss of a `Phong` shader whose shininess was not set (GroIMP's).
const DEFAULT_EXPONENT: f64 = 4.0;

/// How many shaders may be within each other.
const DEEPEST: u32 = 16;

/// The surface that a shader describes for this purpose; `None` of what is no shader.
pub(super) fn surface(
    value: &Value,
    purpose: Purpose,
    pictures: &mut Finder<'_>,
) -> Option<Material> {
    nested(value, purpose, DEEPEST, pictures)
}

fn nested(
    value: &Value,
    purpose: Purpose,
    deeper: u32,
    pictures: &mut Finder<'_>,
) -> Option<Material> {
    let object = value.as_object()?;
    let shaders = match &*object.lock() {
        Data::Shader(rgba) => {
            let [r, g, b, alpha] = rgba.map(f64::from);
            return Some(Material::lambert(Rgb::new(r, g, b)).with_alpha(alpha));
        }
        Data::Phong(shader) => return Some(phong(shader, pictures)),
        Data::Finish(shader) => return Some(finish(object.class, shader)),
        Data::Shaders(shaders) => Shaders::clone(shaders),
        _ => return None,
    };
    let mut part = |shader| {
        let known = deeper
            .checked_sub(1)
            .and_then(|deeper| nested(shader, purpose, deeper, pictures));
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
///
/// Pictures can be the two diffuse channels; where that of the diffuse channel is transparent, there are holes, as in GroIMP.
/// One as transparency cuts holes where it is white. Other channels take the mean colour of theirs.
fn phong(shader: &Phong, pictures: &mut Finder<'_>) -> Material {
    let mut drawn = Pictures::default();
    let through = match &shader.transparency {
        Paint::Plain(color) => Rgb::from_array(*color),
        Paint::Picture(picture) => {
            drawn
                .holes
                .extend(texture(picture, Coverage::Dark, pictures));
            Rgb::BLACK
        }
    };
    let rest = if shader.is_interpolated {
        Rgb::WHITE - through
    } else {
        Rgb::WHITE
    };
    let mut side = Side::default();
    match matt(&shader.diffuse, pictures) {
        Matt::Plain(color) => side.reflectance = color * rest,
        Matt::Picture(texture, tint) => {
            let reflectance = tint * rest;
            drawn
                .holes
                .extend(texture.image.has_holes().then(|| texture.clone()));
            drawn.layers.push(both_sides(
                texture,
                Side {
                    reflectance,
                    ..Side::default()
                },
            ));
        }
    }
    match matt(&shader.diffuse_transparency, pictures) {
        Matt::Plain(color) => side.transmittance = color,
        Matt::Picture(texture, transmittance) => {
            drawn.layers.push(both_sides(
                texture,
                Side {
                    transmittance,
                    ..Side::default()
                },
            ));
        }
    }
    let mut lobes = Vec::new();
    let specular = mean(&shader.specular, pictures) * rest;
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
    let emissive = mean(&shader.emissive, pictures);
    let is_plain = drawn.layers.is_empty() && drawn.holes.is_empty();
    Material {
        lobes: lobes.into(),
        pictures: (!is_plain).then(|| Box::new(drawn)),
        ..Material::matt([side, side])
    }
    .emitting(emissive, emissive)
}

/// What a diffuse channel is: a colour, or a picture and what it is multiplied with.
enum Matt {
    Plain(Rgb),
    Picture(Texture, Rgb),
}

fn matt(paint: &Paint, pictures: &mut Finder<'_>) -> Matt {
    match paint {
        Paint::Plain(color) => Matt::Plain(Rgb::from_array(*color)),
        Paint::Picture(picture) => {
            let tint = Rgb::from_array(picture.tint);
            match texture(picture, Coverage::Alpha, pictures) {
                Some(texture) => Matt::Picture(texture, tint),
                // GroIMP's image without a picture.
                None => Matt::Plain(tint * 0.5),
            }
        }
    }
}

fn both_sides(texture: Texture, side: Side) -> Layer {
    Layer {
        texture,
        sides: [side; 2],
    }
}

/// One colour for a channel that cannot vary.
fn mean(paint: &Paint, pictures: &mut Finder<'_>) -> Rgb {
    match matt(paint, pictures) {
        Matt::Plain(color) => color,
        Matt::Picture(texture, tint) => {
            let text =
                "has a picture as a colour other than its diffuse ones, of which the mean is drawn";
            pictures.note("picture-mean", text.to_owned());
            texture.image.mean() * tint
        }
    }
}

/// A picture as it lies on the surface; `None` if there is nothing to see.
fn texture(picture: &Picture, of: Coverage, pictures: &mut Finder<'_>) -> Option<Texture> {
    let image = match &picture.of {
        PictureOf::Nothing => None,
        PictureOf::File(name) => pictures.file(name, of),
        PictureOf::Named(name) => pictures.of_project(name, of),
        PictureOf::Checker(colors) => pictures.checker(colors.map(Rgb::from_array), of),
    }?;
    let lies = picture.lies;
    let map = placement(
        DVec2::from_array(lies.offset),
        lies.angle,
        DVec2::from_array(lies.scale),
        lies.shear,
    );
    let filter = if picture.is_smooth {
        Filter::Bilinear
    } else {
        Filter::Nearest
    };
    Some(Texture {
        map,
        filter,
        ..Texture::new(image)
    })
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

    fn drawn_phong(shader: &Phong) -> Material {
        Finder::without_files(|pictures| phong(shader, pictures))
    }

    #[test]
    fn phong_shares_the_light_as_groimp_says() {
        let mut shader = Phong {
            diffuse: Paint::Plain([0.4; 3]),
            specular: Paint::Plain([0.2; 3]),
            transparency: Paint::Plain([0.5; 3]),
            ..Phong::default()
        };
        let drawn = drawn_phong(&shader);
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
        let drawn = drawn_phong(&shader);
        assert_eq!(drawn.sides[1].reflectance, Rgb::splat(0.4));
        assert_eq!(drawn.lobes[0].weight, Rgb::splat(0.2));
        shader.shininess = Some(1.0);
        shader.emissive = Paint::Plain([3.0; 3]);
        let drawn = drawn_phong(&shader);
        assert_eq!(drawn.lobes[0].kind, LobeKind::Mirror(Reflection::Even));
        assert_eq!(drawn.emission, [Rgb::splat(3.0); 2]);
    }
}
