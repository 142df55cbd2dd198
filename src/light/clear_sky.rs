//! The clear sky of Hosek and Wilkie, and the ground that reflects it.

use super::environment::direction;
use crate::color::Rgb;
use crate::math::angle::Angle;
use crate::math::functions::{acos, asin, exp, pow};
use glam::DVec3;
use hw_skymodel::rgb::{SkyParams, SkyState};

/// Coefficients of one sky: a formula per channel.
///
/// Source: [`HosekWilkie2012`](crate::references#hosekwilkie2012); the coefficients of their fitted data come from the crate
/// `hw-skymodel`, the formula is evaluated here in `f64` with the same bits on every machine.
#[derive(Clone, Debug)]
pub(super) struct ClearSky {
    to_sun: DVec3,
    /// A to I of each channel.
    coefficients: [[f64; 9]; 3],
    /// Mean radiance of each channel, W/(m² sr).
    scale: [f64; 3],
}

impl ClearSky {
    /// The sky with the sun in this direction; `None` if the sun is not above the horizon. Turbidity is clamped to
    /// 1..=10 and the albedo to 0..=1, the range of the data.
    pub(super) fn new(
        azimuth: Angle,
        elevation: Angle,
        turbidity: f64,
        albedo: Rgb,
    ) -> Option<Self> {
        let to_sun = direction(azimuth, elevation);
        // An elevation beyond 90° is one below 90° on the other side.
        let height = asin(to_sun.z.clamp(-1.0, 1.0));
        if !(to_sun.is_finite() && height > 0.0) {
            return None;
        }
        let turbidity = if turbidity.is_nan() {
            1.0
        } else {
            turbidity.clamp(1.0, 10.0)
        };
        let params = SkyParams {
            elevation: (height as f32).min(std::f32::consts::FRAC_PI_2),
            turbidity: turbidity as f32,
            albedo: albedo
                .to_array()
                .map(|a| if a.is_nan() { 0.0 } else { a.clamp(0.0, 1.0) } as f32),
        };
        let (raw, scale) = SkyState::new(&params).ok()?.raw();
        let coefficients =
            std::array::from_fn(|channel| std::array::from_fn(|i| f64::from(raw[9 * channel + i])));
        Some(Self {
            to_sun,
            coefficients,
            scale: scale.map(f64::from),
        })
    }

    /// Radiance, W/(m² sr) per channel, from the direction `w` (unit, above the horizon).
    pub(super) fn radiance(&self, w: DVec3) -> Rgb {
        let cos_theta = w.z.max(0.0);
        let cos_gamma = w.dot(self.to_sun).clamp(-1.0, 1.0);
        let gamma = acos(cos_gamma);
        let zenith = cos_theta.sqrt();
        Rgb::from_array(std::array::from_fn(|channel| {
            let [a, b, c, d, e, f, g, h, i] = self.coefficients[channel];
            // The order of G, H and I is that of the published code, not of the paper.
            let (mie_weight, zenith_weight, anisotropy) = (g, h, i);
            let mie = (1.0 + cos_gamma * cos_gamma)
                / pow(
                    1.0 + anisotropy * anisotropy - 2.0 * anisotropy * cos_gamma,
                    1.5,
                );
            let gradient = 1.0 + a * exp(b / (cos_theta + 0.01));
            let glow = c
                + d * exp(e * gamma)
                + f * cos_gamma * cos_gamma
                + mie_weight * mie
                + zenith_weight * zenith;
            (self.scale[channel] * gradient * glow).max(0.0)
        }))
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use hw_skymodel::rgb::Channel;

    #[test]
    fn formula_equals_the_reference_implementation() {
        let (azimuth, elevation) = (Angle::deg(30.0), Angle::deg(42.0));
        let albedo = Rgb::new(0.1, 0.2, 0.3);
        let ours = ClearSky::new(azimuth, elevation, 3.3, albedo).unwrap();
        let params = SkyParams {
            elevation: elevation.radians() as f32,
            turbidity: 3.3,
            albedo: [0.1, 0.2, 0.3],
        };
        let theirs = SkyState::new(&params).unwrap();
        for (az, el) in [
            (0.0, 90.0),
            (30.0, 42.0),
            (200.0, 5.0),
            (120.0, 60.0),
            (31.0, 43.0),
        ] {
            let w = direction(Angle::deg(az), Angle::deg(el));
            let theta = (90.0 - el).to_radians() as f32;
            let gamma = w.dot(ours.to_sun).clamp(-1.0, 1.0).acos() as f32;
            let expected = theirs.radiance(theta, gamma, Channel::G);
            let found = ours.radiance(w).g;
            assert!(
                (found / f64::from(expected) - 1.0).abs() < 1e-3,
                "{az} {el}: {found} {expected}"
            );
        }
    }

    #[test]
    fn no_sky_without_a_sun_and_no_nan_anywhere() {
        assert!(ClearSky::new(Angle::deg(0.0), Angle::deg(-1.0), 3.0, Rgb::BLACK).is_none());
        assert!(ClearSky::new(Angle::deg(0.0), Angle::deg(f64::NAN), 3.0, Rgb::BLACK).is_none());
        for turbidity in [-5.0, 1.0, 2.5, 10.0, 99.0, f64::NAN] {
            for elevation in [0.000_001, 0.1, 10.0, 90.0] {
                let (azimuth, elevation) = (Angle::deg(0.0), Angle::deg(elevation));
                let sky = ClearSky::new(azimuth, elevation, turbidity, Rgb::splat(0.2)).unwrap();
                for w in [DVec3::Z, DVec3::X, DVec3::NEG_X, sky.to_sun] {
                    let radiance = sky.radiance(w);
                    assert!(
                        radiance.is_finite() && radiance.min_channel() >= 0.0,
                        "{w} {radiance:?}"
                    );
                }
            }
        }
    }
}
