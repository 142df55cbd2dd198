//! Light from infinitely far away: the sky and the disk of the sun, as plain data.

use super::lamp::{LightError, check_brightness, check_finite, check_unit};
use super::sky_image::SkyImage;
use crate::color::Rgb;
use crate::math::angle::Angle;
use glam::DVec3;
use std::f64::consts::PI;
use std::sync::Arc;

/// Everything that shines from infinitely far away; dark by default.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Environment {
    /// The sky.
    pub sky: Sky,
    /// The disk of the sun, if it is up.
    pub sun: Option<SunDisk>,
}

/// Radiance of the sky without the disk of the sun.
#[derive(Clone, Debug, Default, PartialEq)]
pub enum Sky {
    /// No light.
    #[default]
    None,
    /// The same radiance, W/(m² sr) per channel, from every direction of the whole sphere (below the horizon too).
    Uniform(Rgb),
    /// A cloudless sky by Hosek and Wilkie.
    ///
    /// Below the horizon it shows ground that stretches to infinity, Lambertian with `ground_albedo` and lit by this sky
    /// and its sun. With the sun below the horizon it is dark.
    ClearSky {
        /// Azimuth of the sun, from +x towards +y.
        sun_azimuth: Angle,
        /// Elevation of the sun above the horizon, -π/2..=π/2.
        sun_elevation: Angle,
        /// Haziness, 1 (pure air) ..=10 (hazy); 2 to 3 is a clear day.
        turbidity: f64,
        /// Reflectance of the ground round about, 0..=1 per channel.
        ground_albedo: Rgb,
        /// Brightness as a multiple of the natural one.
        strength: f64,
    },
    /// The standard overcast sky: three times as bright at the zenith as at the horizon, the same all round.
    ///
    /// L(h) = `zenith` · (1 + 2 sin h) / 3 at the elevation h ([`MoonSpencer1942`](crate::references#moonspencer1942), CIE
    /// standard). Below the horizon it shows ground as [`Sky::ClearSky`] does.
    Overcast {
        /// Radiance of the zenith, W/(m² sr) per channel.
        zenith: Rgb,
        /// Reflectance of the ground round about, 0..=1 per channel.
        ground_albedo: Rgb,
    },
    /// A picture of all that is round about.
    Image {
        /// The picture.
        image: Arc<SkyImage>,
        /// How far it is turned about the vertical, counter-clockwise as seen from above.
        turn: Angle,
        /// What its values are multiplied by to give W/(m² sr).
        strength: f64,
    },
}

/// The disk of the sun: uniform radiance within a small cone.
#[derive(Clone, Debug, PartialEq)]
pub struct SunDisk {
    /// Unit vector from the ground to the centre of the disk.
    pub to_sun: DVec3,
    /// Irradiance on a surface that faces it, W/m² per channel.
    pub irradiance: Rgb,
    /// Half of the angle it subtends; 0.2666° from Earth.
    pub angular_radius: Angle,
}

impl Environment {
    /// Checks that no number in it is NaN, infinite or negative where it must not be. Turbidity and ground albedo are
    /// clamped to the range of the data when the sky is made ready, and a sun below the horizon is night.
    ///
    /// # Errors
    /// The first thing that is wrong.
    pub fn validate(&self) -> Result<(), LightError> {
        match &self.sky {
            Sky::None => {}
            Sky::Uniform(radiance) => check_brightness(*radiance)?,
            Sky::ClearSky {
                sun_azimuth,
                sun_elevation,
                turbidity,
                ground_albedo,
                strength,
            } => {
                let toward = direction(*sun_azimuth, *sun_elevation);
                check_finite(toward, "direction of the sun")?;
                check_brightness(Rgb::splat(*turbidity))?;
                check_brightness(*ground_albedo)?;
                check_brightness(Rgb::splat(*strength))?;
            }
            Sky::Overcast {
                zenith,
                ground_albedo,
            } => {
                check_brightness(*zenith)?;
                check_brightness(*ground_albedo)?;
            }
            Sky::Image { turn, strength, .. } => {
                check_finite(DVec3::splat(turn.radians()), "turn of the sky")?;
                check_brightness(Rgb::splat(*strength))?;
            }
        }
        self.sun.as_ref().map_or(Ok(()), |sun| {
            check_unit(sun.to_sun, "direction of the sun")?;
            check_brightness(sun.irradiance)?;
            let radius = sun.angular_radius.degrees();
            let is_disk = radius > 0.0 && radius < 90.0;
            is_disk.then_some(()).ok_or(LightError::SunDisk { radius })
        })
    }

    /// The daylight of a clear day: sky and sun that belong together.
    ///
    /// `azimuth` of the sun from +x towards +y, `elevation` above the horizon; `turbidity` 1 (pure air) ..=10 (hazy);
    /// `ground_albedo` 0..=1 of the land round about. Dark if the sun is not above the horizon.
    #[must_use]
    pub fn daylight(azimuth: Angle, elevation: Angle, turbidity: f64, ground_albedo: Rgb) -> Self {
        Self {
            sky: Sky::ClearSky {
                sun_azimuth: azimuth,
                sun_elevation: elevation,
                turbidity,
                ground_albedo,
                strength: 1.0,
            },
            sun: SunDisk::clear(azimuth, elevation, turbidity),
        }
    }

    /// The light of a day when clouds cover all of the sky and hide the sun, which stands at this elevation.
    ///
    /// Grey, with the mean illuminance measured under overcast skies, 300 + 21,000 sin(elevation) lux on the ground
    /// ([`KrochmannSeidl1974`](crate::references#krochmannseidl1974)). Dark if the sun is not above the horizon.
    #[must_use]
    pub fn overcast(elevation: Angle, ground_albedo: Rgb) -> Self {
        let height = elevation.sin();
        let lux = if height > 0.0 {
            300.0 + 21_000.0 * height
        } else {
            0.0
        };
        let zenith = Rgb::splat(lux / LUMENS_PER_WATT / OVERCAST_IRRADIANCE);
        Self {
            sky: Sky::Overcast {
                zenith,
                ground_albedo,
            },
            sun: None,
        }
    }

    /// The same surroundings, `factor` times as bright.
    #[must_use]
    pub fn brightened(mut self, factor: f64) -> Self {
        match &mut self.sky {
            Sky::None => {}
            Sky::Uniform(radiance) => *radiance *= factor,
            Sky::Overcast { zenith, .. } => *zenith *= factor,
            Sky::ClearSky { strength, .. } | Sky::Image { strength, .. } => *strength *= factor,
        }
        if let Some(sun) = &mut self.sun {
            sun.irradiance *= factor;
        }
        self
    }
}

/// Luminous efficacy of radiation that is weighted with the eye's sensitivity, lm/W (SI, definition of the candela).
const LUMENS_PER_WATT: f64 = 683.0;

/// Horizontal irradiance under the overcast sky per radiance of its zenith: ∫ (1 + 2 sin h)/3 · sin h dω = 7π/9.
pub(super) const OVERCAST_IRRADIANCE: f64 = 7.0 * PI / 9.0;

/// The unit vector at this azimuth (from +x towards +y) and elevation above the horizon (z up).
#[must_use]
pub fn direction(azimuth: Angle, elevation: Angle) -> DVec3 {
    DVec3::new(
        elevation.cos() * azimuth.cos(),
        elevation.cos() * azimuth.sin(),
        elevation.sin(),
    )
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn impossible_skies_are_refused_and_night_is_not() {
        let albedo = Rgb::splat(0.2);
        let day = |elevation: f64| {
            Environment::daylight(Angle::deg(20.0), Angle::deg(elevation), 3.0, albedo)
        };
        for fine in [Environment::default(), day(40.0), day(-40.0)] {
            assert_eq!(fine.validate(), Ok(()));
        }
        let uniform = |radiance| Environment {
            sky: Sky::Uniform(Rgb::splat(radiance)),
            sun: None,
        };
        let mut wide = day(40.0);
        if let Some(sun) = &mut wide.sun {
            sun.angular_radius = Angle::deg(90.0);
        }
        let mut crooked = day(40.0);
        if let Some(sun) = &mut crooked.sun {
            sun.to_sun *= 2.0;
        }
        let wrong = [
            uniform(f64::NAN),
            uniform(-1.0),
            day(f64::NAN),
            wide,
            crooked,
        ];
        for environment in wrong {
            assert!(environment.validate().is_err(), "{environment:?}");
        }
    }
}
