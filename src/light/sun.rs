//! How bright the disk of the sun is through a clear atmosphere.
//!
//! The solar spectrum outside the atmosphere and the transmittance of air, haze, ozone, water vapour and oxygen at 36
//! wavelengths ([`BirdRiordan1986`](crate::references#birdriordan1986)), weighted with the CIE 1931 colour-matching functions.
//! Haze follows the turbidity that also shapes the sky, so sun and sky belong together.
//!
//! One channel's W/m² is the spectral irradiance integrated with the sRGB matching functions, the same convention as the
//! data of Hosek and Wilkie. The sum of the three channels is close to the power between 400 and 700 nm (for an even
//! spectrum 7 % more), so absorbed daylight can be read as visible (photosynthetically active) watts.

use super::environment::direction;
use super::{LightSample, SunDisk};
use crate::color::Rgb;
use crate::math::angle::Angle;
use crate::math::frame::Frame;
use crate::math::functions::{asin, exp, pow};
use crate::math::warp;
use glam::{DVec2, DVec3};
use std::f64::consts::PI;

/// Half the angle the sun subtends, in degrees: its mean as seen from Earth.
pub const ANGULAR_RADIUS_DEGREES: f64 = 0.2666;

/// Ozone column in cm at standard pressure.
const OZONE: f64 = 0.35;

/// Precipitable water in cm.
const WATER: f64 = 2.0;

/// Ångström's exponent: how haze weakens with wavelength.
const HAZE_EXPONENT: f64 = 1.3;

/// One line of the tables of Bird and Riordan.
struct Band {
    /// Wavelength, nm.
    wavelength: f64,
    /// Irradiance outside the atmosphere, W/(m² nm).
    outside: f64,
    /// Absorption coefficients: ozone (1/cm), water vapour (1/cm), mixed gases (1/km).
    ozone: f64,
    water: f64,
    gas: f64,
}

const fn band(wavelength: f64, outside: f64, ozone: f64, water: f64, gas: f64) -> Band {
    Band {
        wavelength,
        outside,
        ozone,
        water,
        gas,
    }
}

/// [`BirdRiordan1986`](crate::references#birdriordan1986), table 1, 360 to 780 nm.
const BANDS: [Band; 36] = [
    band(360.0, 0.9759, 0.0, 0.0, 0.0),
    band(370.0, 1.1199, 0.0, 0.0, 0.0),
    band(380.0, 1.1038, 0.0, 0.0, 0.0),
    band(390.0, 1.0338, 0.0, 0.0, 0.0),
    band(400.0, 1.4791, 0.0, 0.0, 0.0),
    band(410.0, 1.7013, 0.0, 0.0, 0.0),
    band(420.0, 1.7404, 0.0, 0.0, 0.0),
    band(430.0, 1.5872, 0.0, 0.0, 0.0),
    band(440.0, 1.837, 0.0, 0.0, 0.0),
    band(450.0, 2.005, 0.003, 0.0, 0.0),
    band(460.0, 2.043, 0.006, 0.0, 0.0),
    band(470.0, 1.987, 0.009, 0.0, 0.0),
    band(480.0, 2.027, 0.014, 0.0, 0.0),
    band(490.0, 1.896, 0.021, 0.0, 0.0),
    band(500.0, 1.909, 0.03, 0.0, 0.0),
    band(510.0, 1.927, 0.04, 0.0, 0.0),
    band(520.0, 1.831, 0.048, 0.0, 0.0),
    band(530.0, 1.891, 0.063, 0.0, 0.0),
    band(540.0, 1.898, 0.075, 0.0, 0.0),
    band(550.0, 1.892, 0.085, 0.0, 0.0),
    band(570.0, 1.84, 0.12, 0.0, 0.0),
    band(593.0, 1.768, 0.119, 0.075, 0.0),
    band(610.0, 1.728, 0.12, 0.0, 0.0),
    band(630.0, 1.658, 0.09, 0.0, 0.0),
    band(656.0, 1.524, 0.065, 0.0, 0.0),
    band(667.6, 1.531, 0.051, 0.0, 0.0),
    band(690.0, 1.42, 0.028, 0.016, 0.15),
    band(710.0, 1.399, 0.018, 0.0125, 0.0),
    band(718.0, 1.374, 0.015, 1.8, 0.0),
    band(724.4, 1.373, 0.012, 2.5, 0.0),
    band(740.0, 1.298, 0.01, 0.061, 0.0),
    band(752.5, 1.269, 0.008, 0.0008, 0.0),
    band(757.5, 1.245, 0.007, 0.0001, 0.0),
    band(762.5, 1.223, 0.006, 0.000_01, 4.0),
    band(767.5, 1.205, 0.005, 0.000_01, 0.35),
    band(780.0, 1.183, 0.0, 0.0006, 0.0),
];

impl SunDisk {
    /// The sun of a clear day at this azimuth (from +x towards +y) and elevation; `None` if it stands below the horizon.
    ///
    /// `turbidity` is that of the sky, 1 (pure air) to 10 (hazy), and is clamped to it.
    #[must_use]
    pub fn clear(azimuth: Angle, elevation: Angle, turbidity: f64) -> Option<Self> {
        let to_sun = direction(azimuth, elevation);
        // An elevation beyond 90° is one below 90° on the other side.
        let height = Angle::rad(asin(to_sun.z.clamp(-1.0, 1.0)));
        (to_sun.is_finite() && to_sun.z > 0.0).then(|| Self {
            to_sun,
            irradiance: direct_irradiance(height, turbidity),
            angular_radius: Angle::deg(ANGULAR_RADIUS_DEGREES),
        })
    }

    /// Solid angle of the disk in steradian.
    #[must_use]
    pub fn solid_angle(&self) -> f64 {
        warp::cone_solid_angle(self.angular_radius.radians())
    }

    /// Radiance from the direction `w` (unit): that of the disk inside, 0 outside; W/(m² sr) per channel.
    ///
    /// The disk is evenly bright, so that it gives its irradiance on a facing surface (∫ cos θ dω = π sin² of its radius).
    #[must_use]
    pub fn radiance(&self, w: DVec3) -> Rgb {
        if self.contains(w) {
            self.disk_radiance()
        } else {
            Rgb::BLACK
        }
    }

    /// A direction on the disk, uniform in solid angle, from a point of the unit square.
    #[must_use]
    pub fn sample(&self, u: DVec2) -> LightSample {
        let local = warp::cone(u, self.angular_radius.radians());
        LightSample {
            wi: Frame::from_normal(self.to_sun).to_world(local).normalize(),
            distance: f64::INFINITY,
            facing_irradiance: self.disk_radiance() * self.solid_angle(),
            pdf_solid_angle: Some(1.0 / self.solid_angle()),
        }
    }

    /// Density per steradian with which [`sample`](Self::sample) chooses `w`.
    #[must_use]
    pub fn pdf_solid_angle(&self, w: DVec3) -> f64 {
        if self.contains(w) {
            1.0 / self.solid_angle()
        } else {
            0.0
        }
    }

    fn contains(&self, w: DVec3) -> bool {
        // |w - s| = 2 sin(angle/2): keeps the digits that the cosine of a small angle loses.
        let half_chord = self.angular_radius.half().sin();
        (w - self.to_sun).length_squared() <= 4.0 * half_chord * half_chord
    }

    fn disk_radiance(&self) -> Rgb {
        let sin = self.angular_radius.sin();
        self.irradiance / (PI * sin * sin)
    }
}

/// Irradiance of the direct sun on a surface that faces it, W/m² per channel.
fn direct_irradiance(elevation: Angle, turbidity: f64) -> Rgb {
    let mass = air_mass(elevation);
    let haze = haze(turbidity.clamp(1.0, 10.0));
    let at = |b: &Band| b.outside * transmittance(b, mass, haze);
    let mut xyz = [0.0; 3];
    for pair in BANDS.windows(2) {
        // Trapezoids: the bands are not evenly spaced.
        let (a, b) = (&pair[0], &pair[1]);
        let half_step = 0.5 * (b.wavelength - a.wavelength);
        let (at_a, at_b) = (at(a), at(b));
        let (match_a, match_b) = (matching(a.wavelength), matching(b.wavelength));
        for channel in 0..3 {
            xyz[channel] += half_step * (at_a * match_a[channel] + at_b * match_b[channel]);
        }
    }
    // A very low sun is redder than the red primary; what cannot be shown is cut off.
    linear_srgb(xyz).map(|c| c.max(0.0))
}

/// Air mass relative to the zenith, [`KastenYoung1989`](crate::references#kastenyoung1989).
fn air_mass(elevation: Angle) -> f64 {
    let degrees = elevation.degrees();
    1.0 / (elevation.sin() + 0.505_72 * pow(degrees + 6.079_95, -1.6364))
}

/// Ångström's turbidity coefficient β of a turbidity, [Preetham1999, appendix](crate::references#preetham1999).
fn haze(turbidity: f64) -> f64 {
    (0.046_083_658_2 * turbidity - 0.045_860_259_3).max(0.0)
}

/// What the atmosphere lets through at one wavelength: [`BirdRiordan1986`](crate::references#birdriordan1986), equations
/// for Rayleigh scattering, water vapour, ozone and mixed gases; haze by Ångström's formula with β = `haze`.
fn transmittance(band: &Band, mass: f64, haze: f64) -> f64 {
    let micrometres = band.wavelength / 1000.0;
    let squared = micrometres * micrometres;
    let rayleigh = mass / (squared * squared * (115.6406 - 1.335 / squared));
    let aerosol = haze * pow(micrometres, -HAZE_EXPONENT) * mass;
    let ozone = band.ozone * OZONE * mass;
    let wet = band.water * WATER * mass;
    let water = 0.2385 * wet / pow(1.0 + 20.07 * wet, 0.45);
    let mixed = band.gas * mass;
    let gas = 1.41 * mixed / pow(1.0 + 118.93 * mixed, 0.45);
    exp(-(rayleigh + aerosol + ozone + water + gas))
}

/// CIE 1931 colour-matching functions x̄, ȳ, z̄ at a wavelength in nm, by the fit of
/// [Wyman2013, listing 1](crate::references#wyman2013).
fn matching(wavelength: f64) -> [f64; 3] {
    let lobe = |height: f64, centre: f64, below: f64, above: f64| {
        let t = (wavelength - centre) * if wavelength < centre { below } else { above };
        height * exp(-0.5 * t * t)
    };
    [
        lobe(0.362, 442.0, 0.0624, 0.0374) + lobe(1.056, 599.8, 0.0264, 0.0323)
            - lobe(0.065, 501.1, 0.0490, 0.0382),
        lobe(0.821, 568.8, 0.0213, 0.0247) + lobe(0.286, 530.9, 0.0613, 0.0322),
        lobe(1.217, 437.0, 0.0845, 0.0278) + lobe(0.681, 459.0, 0.0385, 0.0725),
    ]
}

/// Linear sRGB of CIE XYZ (IEC 61966-2-1; white D65).
fn linear_srgb([x, y, z]: [f64; 3]) -> Rgb {
    Rgb::new(
        3.2406 * x - 1.5372 * y - 0.4986 * z,
        -0.9689 * x + 1.8758 * y + 0.0415 * z,
        0.0557 * x - 0.2040 * y + 1.0570 * z,
    )
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn matching_functions_have_the_known_area() {
        for channel in 0..3 {
            let area: f64 = (360..830).map(|nm| matching(f64::from(nm))[channel]).sum();
            assert!((area - 106.86).abs() < 1.5, "{channel}: {area}");
        }
    }

    #[test]
    fn air_mass_of_the_table() {
        // Kasten & Young 1989: 1 at the zenith, 2 at 30°, about 38 at the horizon.
        for (degrees, mass) in [(90.0, 0.9997), (30.0, 1.994), (10.0, 5.5889), (0.0, 37.92)] {
            assert!(
                (air_mass(Angle::deg(degrees)) / mass - 1.0).abs() < 3e-3,
                "{degrees}"
            );
        }
    }

    #[test]
    fn brightness_is_that_of_daylight() {
        // Outside the atmosphere the sun gives about 133 klx; a clear noon sun 90 to 110 klx (683 lm per V-weighted watt).
        let klx = |elevation: f64, turbidity: f64| {
            direct_irradiance(Angle::deg(elevation), turbidity).luminance() * 0.683
        };
        assert!(
            (85.0..115.0).contains(&klx(60.0, 2.5)),
            "{}",
            klx(60.0, 2.5)
        );
        assert!(klx(60.0, 2.0) > klx(60.0, 6.0));
        let mut last = 0.0;
        for degrees in 1..=90 {
            let now = klx(f64::from(degrees), 3.0);
            assert!(now > last, "{degrees}");
            last = now;
        }
    }

    #[test]
    fn a_low_sun_is_red_and_a_set_sun_is_gone() {
        let low = SunDisk::clear(Angle::deg(0.0), Angle::deg(3.0), 3.0).unwrap();
        assert!(low.irradiance.r > 2.0 * low.irradiance.g && low.irradiance.min_channel() >= 0.0);
        for degrees in [0.0, -0.001, -45.0, -90.0, f64::NAN] {
            assert_eq!(
                SunDisk::clear(Angle::deg(0.0), Angle::deg(degrees), 3.0),
                None
            );
        }
    }

    #[test]
    fn the_disk_gives_its_irradiance() {
        let sun = SunDisk::clear(Angle::deg(20.0), Angle::deg(40.0), 3.0).unwrap();
        let (n, mut sum) = (64, Rgb::BLACK);
        for i in 0..n * n {
            let u = DVec2::new(f64::from(i % n) + 0.5, f64::from(i / n) + 0.5) / f64::from(n);
            let sample = sun.sample(u);
            assert_eq!(Some(sun.pdf_solid_angle(sample.wi)), sample.pdf_solid_angle);
            assert_eq!(
                sun.radiance(sample.wi) * sun.solid_angle(),
                sample.facing_irradiance
            );
            sum += sample.facing_irradiance * sample.wi.dot(sun.to_sun) / f64::from(n * n);
        }
        assert!((sum.g / sun.irradiance.g - 1.0).abs() < 1e-12);
        assert_eq!(sun.radiance(DVec3::Z), Rgb::BLACK);
        let beside = Frame::from_normal(sun.to_sun).to_world(warp::cone(DVec2::X, 0.004_66));
        assert_eq!(sun.pdf_solid_angle(beside), 0.0);
    }
}
