//! How a surface redistributes the light it catches: value, sampling and density in one place, so that they cannot drift.

use super::MaterialError;
use crate::color::Rgb;
use crate::math::frame::Frame;
use crate::math::tolerance::ENERGY_EXCESS;
use crate::math::warp;
use glam::{DVec2, DVec3};
use std::f64::consts::FRAC_1_PI;

/// Lambertian reflection and transmission of light that falls on one side.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Side {
    /// ρ: fraction of the arriving flux that is reflected, diffusely, per channel, 0..=1.
    pub reflectance: Rgb,
    /// τ: fraction of the arriving flux that is sent out of the other side, diffusely, per channel, 0..=1; ρ + τ ≤ 1.
    pub transmittance: Rgb,
}

/// The scattering part of a material.
#[derive(Clone, Debug, PartialEq)]
pub enum Scattering {
    /// Lambertian reflection and transmission with own values for the light falling on the front and on the back.
    ///
    /// f = ρ/π when light arrives and leaves on the same side, τ/π otherwise, with ρ, τ of the side where it *arrives*. It is
    /// reciprocal if τ is the same on both sides, as it is for every real flat leaf.
    Diffuse {
        /// Front, back.
        sides: [Side; 2],
    },
}

/// The directions a scattering event is measured against, in world coordinates.
#[derive(Clone, Copy, Debug)]
pub struct ScatteringFrame {
    /// Unit normal of the front side of the true surface; decides on which side a direction lies.
    pub normal_g: DVec3,
    /// Unit normal cosines are taken with; equal to `normal_g` except on meshes with smoothed normals.
    pub normal_s: DVec3,
}

/// A direction chosen by [`Scattering::sample`].
#[derive(Clone, Copy, Debug)]
pub struct ScatterSample {
    /// Unit direction the light comes from (camera paths), away from the surface.
    pub wi: DVec3,
    /// f · |cos θ| / pdf: what the path's throughput is multiplied by.
    pub weight: Rgb,
    /// Density of `wi` per steradian.
    pub pdf_solid_angle: f64,
}

impl ScatteringFrame {
    /// Whether a direction points into the half space in front of the surface.
    #[must_use]
    pub fn is_in_front(&self, w: DVec3) -> bool {
        self.normal_g.dot(w) >= 0.0
    }

    /// The shading normal, turned to the side of `wo`.
    fn facing_normal(&self, wo: DVec3) -> DVec3 {
        if self.is_in_front(wo) {
            self.normal_s
        } else {
            -self.normal_s
        }
    }
}

impl Side {
    /// Chance that a sampled direction is a reflection rather than a transmission; `None` if the side is black.
    ///
    /// In proportion to the mean of the channels, so that a grey surface is sampled with constant weight.
    fn reflection_chance(reflected: Rgb, transmitted: Rgb) -> Option<f64> {
        let total = reflected.sum() + transmitted.sum();
        (total > 0.0).then(|| reflected.sum() / total)
    }

    fn validate(&self, side: &'static str) -> Result<(), MaterialError> {
        for (quantity, rgb) in [
            ("reflectance", self.reflectance),
            ("transmittance", self.transmittance),
        ] {
            if let Some(&value) = rgb.to_array().iter().find(|c| !(0.0..=1.0).contains(*c)) {
                return Err(MaterialError::OutOfRange {
                    quantity,
                    side,
                    value,
                });
            }
        }
        let sum = (self.reflectance + self.transmittance).max_channel();
        if sum > 1.0 + ENERGY_EXCESS {
            return Err(MaterialError::MakesLight { side, sum });
        }
        Ok(())
    }
}

impl Scattering {
    /// ρ for light that leaves along `wo` by reflection, τ for light that leaves along `wo` by transmission.
    fn lobes(&self, frame: &ScatteringFrame, wo: DVec3) -> (Rgb, Rgb) {
        match self {
            Self::Diffuse { sides } => {
                let (near, far) = if frame.is_in_front(wo) {
                    (0, 1)
                } else {
                    (1, 0)
                };
                (sides[near].reflectance, sides[far].transmittance)
            }
        }
    }

    /// f(wi → wo) · |cos θ| of `wi`, in 1/sr per channel: the part of radiance arriving from `wi` that leaves along `wo`.
    ///
    /// Reflection or transmission is decided by the true normal; a direction that the shading normal puts on the wrong side
    /// contributes nothing, so smoothed meshes leak no light.
    #[must_use]
    pub fn value_cos(&self, frame: &ScatteringFrame, wo: DVec3, wi: DVec3) -> Rgb {
        let (reflectance, transmittance) = self.lobes(frame, wo);
        let cos = frame.facing_normal(wo).dot(wi);
        let is_reflection = frame.is_in_front(wo) == frame.is_in_front(wi);
        if is_reflection {
            reflectance * (cos.max(0.0) * FRAC_1_PI)
        } else {
            transmittance * ((-cos).max(0.0) * FRAC_1_PI)
        }
    }

    /// Density per steradian with which [`sample`](Self::sample) chooses `wi`; 0 for a black surface.
    #[must_use]
    pub fn pdf_solid_angle(&self, frame: &ScatteringFrame, wo: DVec3, wi: DVec3) -> f64 {
        let (reflectance, transmittance) = self.lobes(frame, wo);
        let Some(chance) = Side::reflection_chance(reflectance, transmittance) else {
            return 0.0;
        };
        let cos = frame.facing_normal(wo).dot(wi);
        let lobe = if cos >= 0.0 { chance } else { 1.0 - chance };
        lobe * cos.abs() * FRAC_1_PI
    }

    /// Chooses `wi` for light leaving along `wo`, in proportion to f · |cos θ|, from a point in the unit square.
    ///
    /// `None` if the surface is black or the direction has no density.
    #[must_use]
    pub fn sample(&self, frame: &ScatteringFrame, wo: DVec3, u: DVec2) -> Option<ScatterSample> {
        // Choose reflection or transmission with the first coordinate, and stretch what is left of it to 0..1 again.
        let (reflectance, transmittance) = self.lobes(frame, wo);
        let chance = Side::reflection_chance(reflectance, transmittance)?;
        let normal = frame.facing_normal(wo);
        let (axis, u) = if u.x < chance {
            (normal, DVec2::new(u.x / chance, u.y))
        } else {
            (-normal, DVec2::new((u.x - chance) / (1.0 - chance), u.y))
        };

        // Choose the direction in that half space with density |cos θ| / π.
        let wi = Frame::from_normal(axis)
            .to_world(warp::cosine_hemisphere(u))
            .normalize();
        let pdf_solid_angle = self.pdf_solid_angle(frame, wo, wi);
        if pdf_solid_angle <= 0.0 {
            return None;
        }
        let weight = self.value_cos(frame, wo, wi) / pdf_solid_angle;
        Some(ScatterSample {
            wi,
            weight,
            pdf_solid_angle,
        })
    }

    /// Fraction per channel of the light arriving on the given side (`true`: the front) that is not scattered.
    #[must_use]
    pub fn absorptance(&self, is_front: bool) -> Rgb {
        match self {
            Self::Diffuse { sides } => {
                let side = sides[usize::from(!is_front)];
                (Rgb::WHITE - side.reflectance - side.transmittance).map(|c| c.max(0.0))
            }
        }
    }

    /// Checks ranges and energy; see [`Material::validate`](super::Material::validate).
    pub(super) fn validate(&self) -> Result<(), MaterialError> {
        match self {
            Self::Diffuse { sides } => {
                sides[0].validate("front")?;
                sides[1].validate("back")
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::material::Material;

    fn frame() -> ScatteringFrame {
        let normal = DVec3::new(0.3, -0.5, 0.8).normalize();
        ScatteringFrame {
            normal_g: normal,
            normal_s: normal,
        }
    }

    /// Two-sided leaf with different values per side and per channel.
    fn two_sided() -> Scattering {
        let front = Side {
            reflectance: Rgb::new(0.1, 0.5, 0.2),
            transmittance: Rgb::new(0.05, 0.4, 0.1),
        };
        let back = Side {
            reflectance: Rgb::new(0.3, 0.4, 0.6),
            transmittance: front.transmittance,
        };
        Scattering::Diffuse {
            sides: [front, back],
        }
    }

    #[test]
    fn weight_is_the_mean_albedo_and_never_makes_light() {
        let s = two_sided();
        let wo = DVec3::new(0.1, 0.2, 0.9).normalize();
        for i in 0..64 {
            let u = DVec2::new((f64::from(i) + 0.5) / 64.0, 0.37);
            let sample = s.sample(&frame(), wo, u).unwrap();
            // The mean over the channels equals ρ + τ averaged over the channels, whatever the lobe.
            assert!((sample.weight.mean() - (0.8 + 0.55) / 3.0).abs() < 1e-12);
            assert!((sample.wi.length() - 1.0).abs() < 1e-12);
        }
    }

    #[test]
    fn reciprocal_when_the_transmittances_agree() {
        let s = two_sided();
        let f = frame();
        let directions = [
            DVec3::X,
            DVec3::NEG_X,
            DVec3::Z,
            DVec3::NEG_Z,
            DVec3::new(0.6, 0.0, 0.8),
        ];
        for a in directions {
            for b in directions {
                let ab = s.value_cos(&f, a, b) / f.normal_s.dot(b).abs();
                let ba = s.value_cos(&f, b, a) / f.normal_s.dot(a).abs();
                assert!(
                    (ab - ba).map(f64::abs).max_channel() < 1e-15,
                    "{a} {b}: {ab:?} {ba:?}"
                );
            }
        }
    }

    #[test]
    fn sides_are_told_apart() {
        let s = two_sided();
        let f = ScatteringFrame {
            normal_g: DVec3::Z,
            normal_s: DVec3::Z,
        };
        assert_eq!(
            s.value_cos(&f, DVec3::Z, DVec3::Z),
            Rgb::new(0.1, 0.5, 0.2) * FRAC_1_PI
        );
        assert_eq!(
            s.value_cos(&f, DVec3::NEG_Z, DVec3::NEG_Z),
            Rgb::new(0.3, 0.4, 0.6) * FRAC_1_PI
        );
        assert_eq!(
            s.value_cos(&f, DVec3::Z, DVec3::NEG_Z),
            Rgb::new(0.05, 0.4, 0.1) * FRAC_1_PI
        );
    }

    #[test]
    fn black_surfaces_scatter_nothing() {
        let black = Material::lambert(Rgb::BLACK).scattering;
        assert!(
            black
                .sample(&frame(), DVec3::Z, DVec2::splat(0.5))
                .is_none()
        );
        assert_eq!(black.pdf_solid_angle(&frame(), DVec3::Z, DVec3::Z), 0.0);
        assert_eq!(black.absorptance(true), Rgb::WHITE);
    }

    #[test]
    fn a_bent_shading_normal_leaks_no_light() {
        let s = Material::lambert(Rgb::WHITE).scattering;
        let f = ScatteringFrame {
            normal_g: DVec3::Z,
            normal_s: DVec3::new(0.8, 0.0, 0.6),
        };
        let below = DVec3::new(0.9, 0.0, -0.1).normalize();
        assert!(f.normal_s.dot(below) > 0.0, "the shading normal sees it");
        assert!(
            s.value_cos(&f, DVec3::Z, below).is_black(),
            "the true surface does not"
        );
    }
}
