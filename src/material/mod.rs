//! What a surface does to light: scatters it, lets it through, or shines.
//!
//! A [`Material`] has a matt part per side (Lambertian reflection and transmission), up to [`MAX_LOBES`] other lobes (mirror,
//! Phong, GGX, glass, pane), an alpha and an emission. Closed data, dispatched by `enum`: the inner loop has no trait objects
//! and takes no memory. Directions point *away* from the surface.
//!
//! Integrators never look into a material. They ask the scene for the [`Optics`] of a point, which is the material with
//! whatever varies over the surface applied, and use three things of it:
//! - [`Optics::passage`]: what goes straight through (alpha, panes). Not a scattering; shadow rays multiply it.
//! - [`Optics::scattering`]: value, density and sampling of the rest.
//! - [`Optics::emission`].
//!
//! ```text
//! fresnel     smooth boundaries and sheets      microfacet  GGX
//! lobe        the lobes as data                 specular    what each does
//! scattering  all parts of a surface together   presets     mirror, glass, metal, ...
//! image       pictures as data                  texture     how they lie on surfaces
//! ```

pub mod fresnel;
pub mod image;
mod lobe;
mod microfacet;
mod presets;
mod scattering;
mod specular;
pub mod texture;

pub use lobe::{Lobe, LobeKind, LobeSides, MAX_LOBES, Reflection};
pub use scattering::{
    Density, ScatterNumbers, ScatterSample, Scattering, ScatteringFrame, Side, Transport,
};

use crate::color::Rgb;
use crate::math::tolerance::ENERGY_EXCESS;
use texture::{MAX_PICTURES, Pictures};

/// The optical properties of a surface, per side.
#[derive(Clone, Debug, PartialEq)]
pub struct Material {
    /// The matt part: front, back.
    pub sides: [Side; 2],
    /// Everything else; at most [`MAX_LOBES`].
    pub lobes: Box<[Lobe]>,
    /// Fraction of the light that meets the surface at all, in 0..=1; the rest, `1 - alpha`, passes straight through
    /// undisturbed (GroIMP's alpha). Scattering and emission are multiplied by it.
    pub alpha: f64,
    /// Emitted radiance of the front and the back side, W/(m² sr) per channel, the same in all directions.
    pub emission: [Rgb; 2],
    /// The pictures on it, which add to the matt part and cut holes.
    pub pictures: Option<Box<Pictures>>,
}

/// What a surface does to light at one point.
#[derive(Clone, Copy, Debug)]
pub struct Optics<'m> {
    /// How the light that the surface catches is scattered; multiplied by `alpha`.
    pub scattering: Scattering<'m>,
    /// Fraction of the light that meets the surface at all.
    pub alpha: f64,
    /// Emitted radiance of the front and the back side, W/(m² sr); multiplied by `alpha`.
    pub emission: [Rgb; 2],
}

impl Optics<'_> {
    /// Whether nothing goes straight through.
    #[must_use]
    pub fn is_opaque(&self) -> bool {
        self.alpha >= 1.0 && !passes(self.scattering.lobes)
    }

    /// Whether it does nothing but let light straight through, and swallow the rest.
    #[must_use]
    pub fn is_nothing_else(&self) -> bool {
        let is_through = |lobe: &Lobe| lobe.kind == LobeKind::Through;
        self.emission.iter().all(|side| side.is_black())
            && self.scattering.sides == [Side::default(); 2]
            && self.scattering.lobes.iter().all(is_through)
    }

    /// Fraction per channel of the light, met under the cosine `cos` to the true normal, that goes straight through.
    #[must_use]
    pub fn passage(&self, cos: f64) -> Rgb {
        let lobes = self.scattering.lobes.iter();
        let through: Rgb = lobes.map(|lobe| lobe.passage(cos)).sum();
        Rgb::splat(1.0 - self.alpha) + through * self.alpha
    }
}

/// Whether any of the lobes lets light straight through.
fn passes(lobes: &[Lobe]) -> bool {
    let is_passage = |lobe: &Lobe| matches!(lobe.kind, LobeKind::Pane { .. } | LobeKind::Through);
    lobes.iter().any(is_passage)
}

impl Default for Material {
    /// GroIMP's default shader: Lambertian, 0.5 grey.
    fn default() -> Self {
        Self::lambert(Rgb::splat(0.5))
    }
}

impl Material {
    /// An opaque Lambertian surface that reflects the fraction `reflectance` (0..=1 per channel) on both sides.
    #[must_use]
    pub fn lambert(reflectance: Rgb) -> Self {
        Self::leaf(reflectance, Rgb::BLACK)
    }

    /// A bilambertian leaf, equal on both sides: it reflects ρ and transmits τ, both diffusely, and absorbs 1 - ρ - τ.
    #[must_use]
    pub fn leaf(reflectance: Rgb, transmittance: Rgb) -> Self {
        let side = Side {
            reflectance,
            transmittance,
        };
        Self::matt([side, side])
    }

    /// A matt surface with own values for light that falls on the front and on the back.
    #[must_use]
    pub fn matt(sides: [Side; 2]) -> Self {
        Self {
            sides,
            lobes: Box::default(),
            alpha: 1.0,
            emission: [Rgb::BLACK; 2],
            pictures: None,
        }
    }

    /// What it does to light beside its pictures: what does not vary over the surface.
    #[inline]
    #[must_use]
    pub fn optics(&self) -> Optics<'_> {
        Optics {
            scattering: self.scattering(),
            alpha: self.alpha,
            emission: self.emission,
        }
    }

    /// How it scatters beside its pictures.
    #[must_use]
    pub fn scattering(&self) -> Scattering<'_> {
        Scattering {
            sides: self.sides,
            lobes: &self.lobes,
        }
    }

    /// Whether it has nothing but a matt part: radiosity and stored photons without directions are exact for it.
    #[must_use]
    pub fn is_matt(&self) -> bool {
        self.lobes.is_empty()
    }

    /// Whether it sends light into single directions other than straight on: it can make caustics.
    #[must_use]
    pub fn is_specular(&self) -> bool {
        let bends = |lobe: &Lobe| lobe.is_delta() && lobe.kind != LobeKind::Through;
        self.lobes.iter().any(bends)
    }

    /// Whether a transparent body begins behind it.
    #[must_use]
    pub fn has_body(&self) -> bool {
        self.scattering().body().is_some()
    }

    /// Whether no light goes straight through.
    #[must_use]
    pub fn is_opaque(&self) -> bool {
        self.optics().is_opaque() && !self.has_holes()
    }

    /// The same material, of which only the fraction `alpha` (0..=1) is there.
    #[must_use]
    pub fn with_alpha(mut self, alpha: f64) -> Self {
        self.alpha = alpha;
        self
    }

    /// The same material, shining with these radiances in W/(m² sr) on its front and back.
    #[must_use]
    pub fn emitting(mut self, front: Rgb, back: Rgb) -> Self {
        self.emission = [front, back];
        self
    }

    /// Radiance it sends out of the given side (`true`: the front), alpha included, in W/(m² sr).
    #[must_use]
    pub fn emitted_radiance(&self, is_front: bool) -> Rgb {
        self.emission[usize::from(!is_front)] * self.alpha
    }

    /// Whether either side shines.
    #[must_use]
    pub fn is_emitter(&self) -> bool {
        self.alpha > 0.0 && self.emission.iter().any(|side| !side.is_black())
    }

    /// Fraction per channel of the light falling on the given side (`true`: the front) that stays in the surface for certain;
    /// exact for matt surfaces without pictures, mirrors, glass and panes.
    #[must_use]
    pub fn absorptance(&self, is_front: bool) -> Rgb {
        let rest = Rgb::WHITE - self.claim(is_front);
        rest.map(|c| c.max(0.0)) * self.alpha
    }

    /// The share of the light arriving on a side (`true`: the front) that all parts together are given; more than 1 is
    /// impossible. Alpha is not counted, and pictures with their largest values.
    #[must_use]
    pub fn claim(&self, is_front: bool) -> Rgb {
        let side = self.most_sides()[usize::from(!is_front)];
        let lobes = self.lobes.iter();
        let lobes = lobes.filter(|lobe| lobe.sides.include(is_front));
        let matt = side.reflectance + side.transmittance;
        lobes.fold(matt, |sum, lobe| sum + lobe.weight)
    }

    /// Checks that the numbers describe a surface that can exist: all finite, reflectance, transmittance and alpha in
    /// 0..=1, no more light out than in, no negative emission.
    ///
    /// # Errors
    /// The first thing that is wrong.
    pub fn validate(&self) -> Result<(), MaterialError> {
        if !(0.0..=1.0).contains(&self.alpha) {
            return Err(MaterialError::Alpha(self.alpha));
        }
        for radiance in self.emission {
            if !radiance.is_finite() || radiance.min_channel() < 0.0 {
                return Err(MaterialError::Emission(radiance.to_array()));
            }
        }
        self.validate_lobes()?;
        self.validate_pictures()?;
        for (name, side) in ["front", "back"].into_iter().zip(&self.sides) {
            side.validate(name)?;
        }
        for (side, is_front) in [("front", true), ("back", false)] {
            let sum = self.claim(is_front).max_channel();
            if sum > 1.0 + ENERGY_EXCESS {
                return Err(MaterialError::MakesLight { side, sum });
            }
        }
        Ok(())
    }

    fn validate_pictures(&self) -> Result<(), MaterialError> {
        let Some(pictures) = &self.pictures else {
            return Ok(());
        };
        let most = pictures.layers.len().max(pictures.holes.len());
        if most > MAX_PICTURES {
            return Err(MaterialError::TooManyPictures(most));
        }
        for layer in &pictures.layers {
            for (name, side) in ["front", "back"].into_iter().zip(&layer.sides) {
                side.validate_parts(name)?;
            }
        }
        if self.has_holes() && self.is_emitter() {
            return Err(MaterialError::ShiningHoles);
        }
        Ok(())
    }

    fn validate_lobes(&self) -> Result<(), MaterialError> {
        if self.lobes.len() > MAX_LOBES {
            return Err(MaterialError::TooManyLobes(self.lobes.len()));
        }
        if self.lobes.iter().filter(|lobe| lobe.is_body()).count() > 1 {
            return Err(MaterialError::TwoBodies);
        }
        self.lobes.iter().try_for_each(Lobe::validate)
    }
}

/// Why a material cannot exist.
#[derive(Clone, Copy, Debug, PartialEq, thiserror::Error)]
pub enum MaterialError {
    /// Alpha is NaN or outside 0..=1.
    #[error("alpha {0} is not between 0 and 1")]
    Alpha(f64),
    /// An emission is negative, infinite or NaN.
    #[error("emitted radiance {0:?} is negative or not finite")]
    Emission([f64; 3]),
    /// A reflectance or transmittance is NaN or outside 0..=1.
    #[error("{quantity} {value} of the {side} side is not between 0 and 1")]
    OutOfRange {
        /// `reflectance` or `transmittance`.
        quantity: &'static str,
        /// `front` or `back`.
        side: &'static str,
        /// What was given.
        value: f64,
    },
    /// A number of a lobe is impossible.
    #[error("{quantity} {value} is impossible")]
    Lobe {
        /// Which number.
        quantity: &'static str,
        /// What was given.
        value: f64,
    },
    /// A lobe lets light through on one side only.
    #[error("a lobe lets light through from one side only")]
    OneWay,
    /// More lobes than there is room for.
    #[error("{0} lobes, of which at most 4 are possible")]
    TooManyLobes(usize),
    /// More pictures than there is room for.
    #[error("{0} pictures, of which at most {MAX_PICTURES} are possible")]
    TooManyPictures(usize),
    /// Pictures cut holes in what shines: no light is sampled well there.
    #[error("holes in a shining surface")]
    ShiningHoles,
    /// Two transparent bodies behind one surface.
    #[error("two transparent bodies behind one surface")]
    TwoBodies,
    /// Reflectance plus transmittance exceeds 1: the surface would make light.
    #[error("reflectance + transmittance of the {side} side is {sum}, more than 1")]
    MakesLight {
        /// `front` or `back`.
        side: &'static str,
        /// The sum in the worst channel.
        sum: f64,
    },
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn impossible_materials_are_refused() {
        let cases = [
            Material::lambert(Rgb::splat(1.1)),
            Material::lambert(Rgb::splat(-0.1)),
            Material::lambert(Rgb::splat(f64::NAN)),
            Material::leaf(Rgb::splat(0.6), Rgb::splat(0.41)),
            Material::default().with_alpha(1.5),
            Material::default().with_alpha(f64::NAN),
            Material::default().emitting(Rgb::splat(-1.0), Rgb::BLACK),
            Material::default().emitting(Rgb::BLACK, Rgb::splat(f64::INFINITY)),
        ];
        for material in cases {
            assert!(material.validate().is_err(), "{material:?}");
        }
    }

    #[test]
    fn edges_of_the_allowed_range_are_fine() {
        assert_eq!(Material::lambert(Rgb::WHITE).validate(), Ok(()));
        // 0.1 + 0.9 and 0.7 + 0.2 + 0.1 are not exactly 1 in binary.
        assert_eq!(
            Material::leaf(Rgb::splat(0.1), Rgb::splat(0.9)).validate(),
            Ok(())
        );
        assert_eq!(
            Material::leaf(Rgb::splat(0.7 + 0.2), Rgb::splat(0.1)).validate(),
            Ok(())
        );
        assert_eq!(Material::default().with_alpha(0.0).validate(), Ok(()));
    }

    #[test]
    fn alpha_scales_emission_and_absorption() {
        let lamp = Material::default()
            .with_alpha(0.25)
            .emitting(Rgb::splat(8.0), Rgb::BLACK);
        assert!(lamp.is_emitter());
        assert_eq!(lamp.emitted_radiance(true), Rgb::splat(2.0));
        assert_eq!(lamp.emitted_radiance(false), Rgb::BLACK);
        assert_eq!(lamp.absorptance(true), Rgb::splat(0.125));
        assert!(!lamp.with_alpha(0.0).is_emitter());
    }
}
