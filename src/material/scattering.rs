//! How a surface redistributes the light it catches: value, sampling and density in one place, so that they cannot drift.

use super::MaterialError;
use super::lobe::{Lobe, LobeKind, MAX_LOBES};
use super::specular::{self, Event, Spot};
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

/// The scattering part of a surface at one point: a matt part per side, and lobes beside it. Light that goes straight
/// through is not scattered and not part of it (see [`Optics::passage`](super::Optics::passage)).
///
/// Matt: f = ρ/π when light arrives and leaves on the same side, τ/π otherwise, with ρ, τ of the side where it *arrives*.
/// That is reciprocal if τ is the same on both sides, as it is for every real flat leaf.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Scattering<'m> {
    /// The matt part: front, back.
    pub sides: [Side; 2],
    /// Everything else; at most [`MAX_LOBES`].
    pub lobes: &'m [Lobe],
}

/// The directions a scattering event is measured against, in world coordinates.
#[derive(Clone, Copy, Debug)]
pub struct ScatteringFrame {
    /// Unit normal of the front side of the true surface; decides on which side a direction lies.
    pub normal_g: DVec3,
    /// Unit normal cosines are taken with; equal to `normal_g` except on meshes with smoothed normals.
    pub normal_s: DVec3,
}

/// What a path carries, which decides what happens at boundaries of glass and under smoothed normals.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Transport {
    /// Radiance, gathered on a path that begins at the camera: `wo` points back to the camera, `wi` to where light is from.
    #[default]
    Radiance,
    /// Flux, carried on a path that begins at a light: `wo` points back to the light, `wi` to where it goes on.
    Importance,
}

/// Uniform random numbers in [0, 1) for one scattering.
#[derive(Clone, Copy, Debug, Default)]
pub struct ScatterNumbers {
    /// Choose the direction.
    pub direction: DVec2,
    /// Choose the lobe (x), and between reflection and refraction (y). Unused by matt surfaces.
    pub lobe: DVec2,
}

/// How likely a chosen direction was.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Density {
    /// Density per steradian over all smooth lobes.
    SolidAngle(f64),
    /// The only direction of its kind; no other way of choosing finds it.
    Delta,
}

/// A direction chosen by [`Scattering::sample`].
#[derive(Clone, Copy, Debug)]
pub struct ScatterSample {
    /// Unit direction in which the path goes on, away from the surface.
    pub wi: DVec3,
    /// f · |cos θ| / pdf: what the path's throughput is multiplied by. Black if nothing goes that way.
    pub weight: Rgb,
    /// With which density it was chosen.
    pub density: Density,
    /// The part of `weight` that comes from the compression of radiance at a boundary, `(n_o/n_i)²`; 1 elsewhere. It cancels
    /// when the path comes out of the glass again, so Russian roulette must not see it.
    pub compression: f64,
}

impl ScatteringFrame {
    /// Whether a direction points into the half space in front of the surface.
    #[must_use]
    pub fn is_in_front(&self, w: DVec3) -> bool {
        self.normal_g.dot(w) >= 0.0
    }

    /// The shading normal, turned to the side of `wo`.
    #[must_use]
    pub fn facing_normal(&self, wo: DVec3) -> DVec3 {
        if self.is_in_front(wo) {
            self.normal_s
        } else {
            -self.normal_s
        }
    }

    /// What a path that carries flux has to be multiplied by, because smoothed normals bend cosines:
    /// `|wo·n_s| |wi·n_g| / (|wo·n_g| |wi·n_s|)`. 1 for radiance and for true normals.
    ///
    /// Source: [Veach1997, §5.3](crate::references#veach1997).
    fn adjoint_factor(&self, wo: DVec3, wi: DVec3, transport: Transport) -> f64 {
        if transport == Transport::Radiance || self.normal_g == self.normal_s {
            return 1.0;
        }
        let (s, g) = (self.normal_s, self.normal_g);
        let factor = (wo.dot(s) * wi.dot(g)) / (wo.dot(g) * wi.dot(s));
        if factor.is_finite() {
            factor.abs()
        } else {
            0.0
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

    /// Checks that both parts are fractions, and together no more than 1.
    pub(super) fn validate(&self, side: &'static str) -> Result<(), MaterialError> {
        self.validate_parts(side)?;
        let sum = (self.reflectance + self.transmittance).max_channel();
        if sum > 1.0 + ENERGY_EXCESS {
            return Err(MaterialError::MakesLight { side, sum });
        }
        Ok(())
    }

    /// Checks that each part is a fraction.
    pub(super) fn validate_parts(&self, side: &'static str) -> Result<(), MaterialError> {
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
        Ok(())
    }
}

/// How likely each part of a surface is chosen: the matt part first, then the lobes.
struct Shares {
    matt: f64,
    lobes: [f64; MAX_LOBES],
}

impl Scattering<'_> {
    /// Whether there is nothing but the matt part.
    #[must_use]
    pub const fn is_matt(&self) -> bool {
        self.lobes.is_empty()
    }

    /// Whether there is anything that [`value_cos`](Self::value_cos) can see: light sampling is worth its while.
    #[must_use]
    pub fn is_smooth(&self) -> bool {
        let has_smooth_lobe = self.lobes.iter().any(|lobe| !lobe.is_delta());
        let is_black = |side: &Side| side.reflectance.is_black() && side.transmittance.is_black();
        has_smooth_lobe || !self.sides.iter().all(is_black)
    }

    /// Whether light from behind can leave in front, by more than single directions.
    #[must_use]
    pub fn transmits(&self) -> bool {
        let lobes = self.lobes.iter();
        let blurs = lobes.filter(|lobe| !lobe.is_delta()).any(Lobe::transmits);
        blurs || !self.sides.iter().all(|side| side.transmittance.is_black())
    }

    /// The transparent body that begins behind the surface: its absorption in 1/m, if there is one.
    #[must_use]
    pub fn body(&self) -> Option<Rgb> {
        self.lobes.iter().find_map(|lobe| match lobe.kind {
            LobeKind::Dielectric { absorption, .. } => Some(absorption),
            LobeKind::Mirror(_)
            | LobeKind::Phong { .. }
            | LobeKind::Haze { .. }
            | LobeKind::Rough { .. }
            | LobeKind::Pane { .. }
            | LobeKind::Through => None,
        })
    }

    /// ρ for light that arrives on the side of `wo`, τ for light that is transmitted from or to there.
    fn matt(&self, frame: &ScatteringFrame, wo: DVec3, transport: Transport) -> (Rgb, Rgb) {
        let (near, far) = if frame.is_in_front(wo) {
            (0, 1)
        } else {
            (1, 0)
        };
        let arrival = match transport {
            Transport::Radiance => far,
            Transport::Importance => near,
        };
        (
            self.sides[near].reflectance,
            self.sides[arrival].transmittance,
        )
    }

    /// The chance of each part; `None` if all is black.
    fn shares(&self, spot: &Spot, reflectance: Rgb, transmittance: Rgb) -> Option<Shares> {
        let mut shares = Shares {
            matt: reflectance.sum() + transmittance.sum(),
            lobes: [0.0; MAX_LOBES],
        };
        let mut total = shares.matt;
        for (share, lobe) in shares.lobes.iter_mut().zip(self.lobes) {
            if lobe.sides.include(spot.is_front) {
                *share = lobe.importance(spot.wo.z);
                total += *share;
            }
        }
        if total <= 0.0 || !total.is_finite() {
            return None;
        }
        shares.matt /= total;
        shares.lobes.iter_mut().for_each(|share| *share /= total);
        Some(shares)
    }

    /// f · |cos θ| of `wi`, in 1/sr per channel, of everything that is not sent into single directions: the part of radiance
    /// arriving from `wi` that leaves along `wo` ([`Transport::Radiance`]), or of flux arriving from `wo` that leaves along
    /// `wi` per steradian ([`Transport::Importance`]).
    ///
    /// Reflection or transmission is decided by the true normal; a direction that the shading normal puts on the wrong side
    /// contributes nothing, so smoothed meshes leak no light.
    #[must_use]
    pub fn value_cos(
        &self,
        frame: &ScatteringFrame,
        wo: DVec3,
        wi: DVec3,
        transport: Transport,
    ) -> Rgb {
        let (reflectance, transmittance) = self.matt(frame, wo, transport);
        let cos = frame.facing_normal(wo).dot(wi);
        let is_reflection = frame.is_in_front(wo) == frame.is_in_front(wi);
        let mut value = if is_reflection {
            reflectance * (cos.max(0.0) * FRAC_1_PI)
        } else {
            transmittance * ((-cos).max(0.0) * FRAC_1_PI)
        };
        if !self.is_matt()
            && let Some(spot) = Spot::new(frame, wo)
        {
            let local = spot.frame.to_local(wi);
            // Both normals must agree on the side.
            if is_reflection == (local.z > 0.0) {
                let lobes = self
                    .lobes
                    .iter()
                    .filter(|lobe| lobe.sides.include(spot.is_front));
                value += lobes
                    .map(|lobe| specular::value_cos(lobe, &spot, local, transport))
                    .sum();
            }
        }
        value * frame.adjoint_factor(wo, wi, transport)
    }

    /// Density per steradian with which [`sample`](Self::sample) chooses `wi`, leaving out the lobes that send light into
    /// single directions. 0 for a black surface. Integrates to the chance that a smooth part is chosen, less the chance
    /// that the chosen part has no direction to offer.
    #[must_use]
    pub fn pdf_solid_angle(
        &self,
        frame: &ScatteringFrame,
        wo: DVec3,
        wi: DVec3,
        transport: Transport,
    ) -> f64 {
        let (reflectance, transmittance) = self.matt(frame, wo, transport);
        let matt = || {
            let Some(chance) = Side::reflection_chance(reflectance, transmittance) else {
                return 0.0;
            };
            let cos = frame.facing_normal(wo).dot(wi);
            let lobe = if cos >= 0.0 { chance } else { 1.0 - chance };
            lobe * cos.abs() * FRAC_1_PI
        };
        if self.is_matt() {
            return matt();
        }
        let Some(spot) = Spot::new(frame, wo) else {
            return 0.0;
        };
        let Some(shares) = self.shares(&spot, reflectance, transmittance) else {
            return 0.0;
        };
        let local = spot.frame.to_local(wi);
        let lobes = self.lobes.iter().zip(shares.lobes);
        let glossy: f64 = lobes
            .filter(|(_, share)| *share > 0.0)
            .map(|(lobe, share)| share * specular::pdf_solid_angle(lobe, &spot, local))
            .sum();
        shares.matt * matt() + glossy
    }

    /// Chooses the direction in which a path goes on that arrived along `wo`, about in proportion to f · |cos θ|.
    ///
    /// `None` if the surface is black or the direction has no density.
    #[must_use]
    pub fn sample(
        &self,
        frame: &ScatteringFrame,
        wo: DVec3,
        numbers: ScatterNumbers,
        transport: Transport,
    ) -> Option<ScatterSample> {
        let (reflectance, transmittance) = self.matt(frame, wo, transport);
        if self.is_matt() {
            let wi = sample_matt(frame, wo, numbers.direction, reflectance, transmittance)?;
            return if frame.normal_g == frame.normal_s {
                matt_sample(frame, wo, wi, reflectance, transmittance)
            } else {
                self.smooth_sample(frame, wo, wi, transport)
            };
        }

        // Choose a part.
        let spot = Spot::new(frame, wo)?;
        let shares = self.shares(&spot, reflectance, transmittance)?;
        let mut rest = numbers.lobe.x - shares.matt;
        if rest < 0.0 {
            let wi = sample_matt(frame, wo, numbers.direction, reflectance, transmittance)?;
            return self.smooth_sample(frame, wo, wi, transport);
        }
        let mut chosen = None;
        for (lobe, share) in self.lobes.iter().zip(shares.lobes) {
            if share > 0.0 {
                chosen = Some((lobe, share));
                if rest < share {
                    break;
                }
                rest -= share;
            }
        }
        let (lobe, share) = chosen?;

        // Let it choose a direction; judge that of a smooth part by all smooth parts.
        match specular::sample(lobe, &spot, numbers, transport)? {
            Event::Delta {
                wi,
                weight,
                compression,
            } => {
                let wi = spot.settled(frame, wi)?;
                Some(ScatterSample {
                    wi,
                    weight: weight * (frame.adjoint_factor(wo, wi, transport) / share),
                    density: Density::Delta,
                    compression,
                })
            }
            Event::Smooth { wi } => {
                let wi = spot.frame.to_world(wi).normalize();
                self.smooth_sample(frame, wo, wi, transport)
            }
        }
    }

    /// The sample of a direction that was chosen by a smooth part.
    fn smooth_sample(
        &self,
        frame: &ScatteringFrame,
        wo: DVec3,
        wi: DVec3,
        transport: Transport,
    ) -> Option<ScatterSample> {
        let pdf_solid_angle = self.pdf_solid_angle(frame, wo, wi, transport);
        if pdf_solid_angle <= 0.0 {
            return None;
        }
        Some(ScatterSample {
            wi,
            weight: self.value_cos(frame, wo, wi, transport) / pdf_solid_angle,
            density: Density::SolidAngle(pdf_solid_angle),
            compression: self.compression(frame, wo, wi, transport),
        })
    }

    /// `(n_o/n_i)²` of a crossing from `wo` to `wi`; 1 on the same side, without a body, and for flux.
    fn compression(
        &self,
        frame: &ScatteringFrame,
        wo: DVec3,
        wi: DVec3,
        transport: Transport,
    ) -> f64 {
        if self.is_matt() || frame.is_in_front(wo) == frame.is_in_front(wi) {
            return 1.0;
        }
        let lobes = self.lobes.iter();
        let factors =
            lobes.map(|lobe| specular::compression(lobe, frame.is_in_front(wo), transport));
        factors.product()
    }
}

/// The sample of a direction that was chosen by a surface with nothing but a matt part and one normal: what
/// [`Scattering::smooth_sample`] would find, in which the cosines cancel.
fn matt_sample(
    frame: &ScatteringFrame,
    wo: DVec3,
    wi: DVec3,
    reflectance: Rgb,
    transmittance: Rgb,
) -> Option<ScatterSample> {
    let chance = Side::reflection_chance(reflectance, transmittance)?;
    let (part, share) = if frame.is_in_front(wo) == frame.is_in_front(wi) {
        (reflectance, chance)
    } else {
        (transmittance, 1.0 - chance)
    };
    let pdf = share * frame.normal_g.dot(wi).abs() * FRAC_1_PI;
    (pdf > 0.0).then(|| ScatterSample {
        wi,
        weight: part / share,
        density: Density::SolidAngle(pdf),
        compression: 1.0,
    })
}

/// A direction with density |cos θ| / π in the half space that is chosen by the reflected and the transmitted part.
fn sample_matt(
    frame: &ScatteringFrame,
    wo: DVec3,
    u: DVec2,
    reflectance: Rgb,
    transmittance: Rgb,
) -> Option<DVec3> {
    // Choose reflection or transmission with the first coordinate, and stretch what is left of it to 0..1 again.
    let chance = Side::reflection_chance(reflectance, transmittance)?;
    let normal = frame.facing_normal(wo);
    let (axis, u) = if u.x < chance {
        (normal, DVec2::new(u.x / chance, u.y))
    } else {
        (-normal, DVec2::new((u.x - chance) / (1.0 - chance), u.y))
    };
    let wi = Frame::from_normal(axis).to_world(warp::cosine_hemisphere(u));
    Some(wi.normalize())
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::material::Material;

    const RADIANCE: Transport = Transport::Radiance;

    fn numbers(direction: DVec2) -> ScatterNumbers {
        ScatterNumbers {
            direction,
            lobe: DVec2::ZERO,
        }
    }

    fn frame() -> ScatteringFrame {
        let normal = DVec3::new(0.3, -0.5, 0.8).normalize();
        ScatteringFrame {
            normal_g: normal,
            normal_s: normal,
        }
    }

    /// Two-sided leaf with different values per side and per channel.
    fn two_sided() -> Material {
        let front = Side {
            reflectance: Rgb::new(0.1, 0.5, 0.2),
            transmittance: Rgb::new(0.05, 0.4, 0.1),
        };
        let back = Side {
            reflectance: Rgb::new(0.3, 0.4, 0.6),
            transmittance: front.transmittance,
        };
        Material::matt([front, back])
    }

    #[test]
    fn weight_is_the_mean_albedo_and_never_makes_light() {
        let material = two_sided();
        let s = material.scattering();
        let wo = DVec3::new(0.1, 0.2, 0.9).normalize();
        for i in 0..64 {
            let u = DVec2::new((f64::from(i) + 0.5) / 64.0, 0.37);
            let sample = s.sample(&frame(), wo, numbers(u), RADIANCE).unwrap();
            // The mean over the channels equals ρ + τ averaged over the channels, whatever the lobe.
            assert!((sample.weight.mean() - (0.8 + 0.55) / 3.0).abs() < 1e-12);
            assert!((sample.wi.length() - 1.0).abs() < 1e-12);
        }
    }

    #[test]
    fn reciprocal_when_the_transmittances_agree() {
        let material = two_sided();
        let s = material.scattering();
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
                let ab = s.value_cos(&f, a, b, RADIANCE) / f.normal_s.dot(b).abs();
                let ba = s.value_cos(&f, b, a, RADIANCE) / f.normal_s.dot(a).abs();
                assert!(
                    (ab - ba).map(f64::abs).max_channel() < 1e-15,
                    "{a} {b}: {ab:?} {ba:?}"
                );
            }
        }
    }

    #[test]
    fn sides_are_told_apart() {
        let material = two_sided();
        let s = material.scattering();
        let f = ScatteringFrame {
            normal_g: DVec3::Z,
            normal_s: DVec3::Z,
        };
        assert_eq!(
            s.value_cos(&f, DVec3::Z, DVec3::Z, RADIANCE),
            Rgb::new(0.1, 0.5, 0.2) * FRAC_1_PI
        );
        assert_eq!(
            s.value_cos(&f, DVec3::NEG_Z, DVec3::NEG_Z, RADIANCE),
            Rgb::new(0.3, 0.4, 0.6) * FRAC_1_PI
        );
        assert_eq!(
            s.value_cos(&f, DVec3::Z, DVec3::NEG_Z, RADIANCE),
            Rgb::new(0.05, 0.4, 0.1) * FRAC_1_PI
        );
    }

    #[test]
    fn black_surfaces_scatter_nothing() {
        let material = Material::lambert(Rgb::BLACK);
        let black = material.scattering();
        assert!(
            black
                .sample(&frame(), DVec3::Z, numbers(DVec2::splat(0.5)), RADIANCE)
                .is_none()
        );
        assert_eq!(
            black.pdf_solid_angle(&frame(), DVec3::Z, DVec3::Z, RADIANCE),
            0.0
        );
        assert_eq!(material.absorptance(true), Rgb::WHITE);
    }

    /// C-53.
    #[test]
    fn a_bent_shading_normal_leaks_no_light() {
        let material = Material::lambert(Rgb::WHITE);
        let s = material.scattering();
        let f = ScatteringFrame {
            normal_g: DVec3::Z,
            normal_s: DVec3::new(0.8, 0.0, 0.6),
        };
        let below = DVec3::new(0.9, 0.0, -0.1).normalize();
        assert!(f.normal_s.dot(below) > 0.0, "the shading normal sees it");
        assert!(
            s.value_cos(&f, DVec3::Z, below, RADIANCE).is_black(),
            "the true surface does not"
        );
    }
}
