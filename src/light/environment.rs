//! Light from infinitely far away: the sky and the disk of the sun, as plain data.

use crate::color::Rgb;
use crate::math::angle::Angle;
use glam::DVec3;

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
            },
            sun: SunDisk::clear(azimuth, elevation, turbidity),
        }
    }
}

/// The unit vector at this azimuth (from +x towards +y) and elevation above the horizon (z up).
#[must_use]
pub fn direction(azimuth: Angle, elevation: Angle) -> DVec3 {
    DVec3::new(
        elevation.cos() * azimuth.cos(),
        elevation.cos() * azimuth.sin(),
        elevation.sin(),
    )
}
