//! What a surface does to light: scatters it, lets it through, or shines.
//!
//! Closed data, dispatched by `enum`: the inner loop has no trait objects. Directions point *away* from the surface.

mod scattering;

pub use scattering::{ScatterSample, Scattering, ScatteringFrame, Side};

use crate::color::Rgb;

/// The optical properties of a surface, per side.
#[derive(Clone, Debug, PartialEq)]
pub struct Material {
    /// How the light that the surface catches is scattered.
    pub scattering: Scattering,
    /// Fraction of the light that meets the surface at all, in 0..=1; the rest, `1 - alpha`, passes straight through
    /// undisturbed (GroIMP's alpha). Scattering and emission are multiplied by it.
    pub alpha: f64,
    /// Emitted radiance of the front and the back side, W/(m² sr) per channel, the same in all directions.
    pub emission: [Rgb; 2],
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
    pub const fn lambert(reflectance: Rgb) -> Self {
        Self::leaf(reflectance, Rgb::BLACK)
    }

    /// A bilambertian leaf, equal on both sides: it reflects ρ and transmits τ, both diffusely, and absorbs 1 - ρ - τ.
    #[must_use]
    pub const fn leaf(reflectance: Rgb, transmittance: Rgb) -> Self {
        let side = Side {
            reflectance,
            transmittance,
        };
        Self {
            scattering: Scattering::Diffuse {
                sides: [side, side],
            },
            alpha: 1.0,
            emission: [Rgb::BLACK; 2],
        }
    }

    /// The same material, of which only the fraction `alpha` (0..=1) is there.
    #[must_use]
    pub const fn with_alpha(mut self, alpha: f64) -> Self {
        self.alpha = alpha;
        self
    }

    /// The same material, shining with these radiances in W/(m² sr) on its front and back.
    #[must_use]
    pub const fn emitting(mut self, front: Rgb, back: Rgb) -> Self {
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

    /// Fraction per channel of the light falling on the given side (`true`: the front) that stays in the surface.
    #[must_use]
    pub fn absorptance(&self, is_front: bool) -> Rgb {
        self.scattering.absorptance(is_front) * self.alpha
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
        self.scattering.validate()
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
