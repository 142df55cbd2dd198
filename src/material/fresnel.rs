//! How much light smooth boundaries reflect.
//!
//! Cosines are those of the angle to the boundary's normal, on the side where the light is looked at, in 0..=1. Indices are
//! *relative*: that of the far side over that of the near side.

use crate::color::Rgb;
use crate::math::functions::pow;
use glam::DVec3;

/// What a smooth boundary between two transparent media does to unpolarised light.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Boundary {
    /// F: fraction that is reflected, 0..=1; the rest is refracted.
    pub reflectance: f64,
    /// Cosine of the refracted ray to the normal, on the far side; 0 if all is reflected.
    pub cos_far: f64,
}

/// The amplitudes that a boundary reflects of both polarisations, and the cosine on the far side; `None` if it reflects all.
///
/// Source: [`BornWolf1999`, §1.5.2](crate::references#bornwolf1999).
fn amplitudes(cos_near: f64, eta: f64) -> Option<(f64, f64, f64)> {
    if eta == 1.0 {
        // Equal media have no boundary, not even for rays along it.
        return Some((0.0, 0.0, cos_near));
    }
    let sin2_far = (1.0 - cos_near * cos_near).max(0.0) / (eta * eta);
    if sin2_far >= 1.0 {
        return None;
    }
    let cos_far = (1.0 - sin2_far).sqrt();
    let s = (cos_near - eta * cos_far) / (cos_near + eta * cos_far);
    let p = (eta * cos_near - cos_far) / (eta * cos_near + cos_far);
    Some((s, p, cos_far))
}

/// Fresnel's equations for a boundary with relative index `eta` > 0, met under the cosine `cos_near`.
#[must_use]
pub fn dielectric(cos_near: f64, eta: f64) -> Boundary {
    match amplitudes(cos_near, eta) {
        Some((s, p, cos_far)) => Boundary {
            reflectance: 0.5 * (s * s + p * p),
            cos_far,
        },
        None => Boundary {
            reflectance: 1.0,
            cos_far: 0.0,
        },
    }
}

/// The refracted direction of light that leaves along the unit direction `wo`, on the side of the unit normal `n`: where
/// it comes from on the far side. Unit length; `boundary` belongs to n · `wo` and `eta`.
#[must_use]
pub fn refracted(wo: DVec3, n: DVec3, eta: f64, boundary: &Boundary) -> DVec3 {
    n * (n.dot(wo) / eta - boundary.cos_far) - wo / eta
}

/// The mirrored direction of `wo` about the unit normal `n`.
#[must_use]
pub fn reflected(wo: DVec3, n: DVec3) -> DVec3 {
    n * (2.0 * n.dot(wo)) - wo
}

/// Schlick's approximation for metals: `at_normal` at normal incidence, 1 at grazing.
///
/// Source: [Schlick1994, eq. 15](crate::references#schlick1994).
#[must_use]
pub fn schlick(at_normal: Rgb, cos: f64) -> Rgb {
    let rest = 1.0 - cos.clamp(0.0, 1.0);
    let power = rest * rest * rest * rest * rest;
    at_normal + (Rgb::WHITE - at_normal) * power
}

/// What a plane sheet with two parallel boundaries reflects and lets straight through, all reflections between them
/// included: (reflectance, transmittance) of unpolarised light.
///
/// `eta` is the index of the sheet relative to what is around it; `tint` is the fraction of light that is left after one
/// crossing of its body at normal incidence, per channel (Beer's law makes it less at an angle).
#[must_use]
pub fn sheet(cos: f64, eta: f64, tint: Rgb) -> (Rgb, Rgb) {
    let Some((s, p, cos_far)) = amplitudes(cos, eta) else {
        return (Rgb::WHITE, Rgb::BLACK);
    };
    if cos <= 0.0 && eta != 1.0 {
        return (Rgb::WHITE, Rgb::BLACK);
    }
    let body = if tint == Rgb::WHITE {
        tint
    } else {
        tint.map(|t| pow(t, 1.0 / cos_far))
    };
    let mut through = Rgb::BLACK;
    let mut back = Rgb::BLACK;
    for amplitude in [s, p] {
        // Sum of the geometric series over the crossings, half of the light in each polarisation.
        let r = amplitude * amplitude;
        let straight = |t: f64| (1.0 - r) * (1.0 - r) * t / (1.0 - r * r * t * t);
        through += body.map(|t| 0.5 * straight(t));
        back += body.map(|t| 0.5 * (r + r * t * straight(t)));
    }
    (back, through)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::math::functions::{asin, atan, cos, sin};

    fn at(degrees: f64, eta: f64) -> Boundary {
        dielectric(cos(degrees.to_radians()), eta)
    }

    #[test]
    fn glass_and_air_of_the_table() {
        let table = include_str!("../validation/tables/glass_sheet_fresnel.csv");
        let mut n_rows = 0;
        for line in table
            .lines()
            .filter(|l| l.starts_with(|c: char| c.is_ascii_digit()))
        {
            let row: Vec<f64> = line.split(',').map(|x| x.parse().unwrap()).collect();
            assert!(
                (at(row[0], 1.5).reflectance - row[1]).abs() < 1e-8,
                "{line}"
            );
            let (back, through) = sheet(cos(row[0].to_radians()), 1.5, Rgb::WHITE);
            assert!((through.g - row[2]).abs() < 1e-8, "{line}");
            assert!((back.g - row[3]).abs() < 1e-8, "{line}");
            n_rows += 1;
        }
        assert_eq!(n_rows, 12);
    }

    /// C-49, C-50.
    #[test]
    fn brewster_and_critical_angle() {
        // At Brewster's angle only the s-polarised half is reflected.
        let brewster = atan(1.5_f64);
        let (s, p, _) = amplitudes(cos(brewster), 1.5).unwrap();
        assert!(p.abs() < 1e-15 && s.abs() > 0.3);
        assert!((brewster.to_degrees() - 56.309_932).abs() < 1e-6);
        // Beyond the critical angle all is reflected, and F rises to 1 without a step.
        let critical = asin(1.0_f64 / 1.5);
        assert!((critical.to_degrees() - 41.810_315).abs() < 1e-6);
        assert_eq!(dielectric(cos(critical + 1e-9), 1.0 / 1.5).reflectance, 1.0);
        let below = dielectric(cos(critical - 1e-12), 1.0 / 1.5).reflectance;
        assert!(below < 1.0 && below > 1.0 - 1e-4, "{below}");
        assert!((at(0.0, 1.5).reflectance - 0.04).abs() < 1e-15);
        assert!((at(0.0, 1.0 / 1.5).reflectance - 0.04).abs() < 1e-15);
        assert_eq!(dielectric(0.0, 1.5).reflectance, 1.0);
    }

    #[test]
    fn both_ways_reflect_the_same_part() {
        for degrees in [0.0, 10.0, 40.0, 70.0, 89.0_f64] {
            let outside = at(degrees, 1.5);
            let inside = dielectric(outside.cos_far, 1.0 / 1.5);
            assert!((outside.reflectance - inside.reflectance).abs() < 1e-12);
            assert!((inside.cos_far - cos(degrees.to_radians())).abs() < 1e-12);
        }
    }

    #[test]
    fn refraction_obeys_snell_and_equal_media_do_nothing() {
        let n = DVec3::new(0.48, -0.6, 0.64);
        let along = n.any_orthonormal_vector();
        for degrees in [0.0, 20.0, 60.0, 89.9_f64] {
            let angle = degrees.to_radians();
            let wo = n * cos(angle) + along * sin(angle);
            let boundary = dielectric(n.dot(wo), 1.5);
            let wt = refracted(wo, n, 1.5, &boundary);
            assert!((wt.length() - 1.0).abs() < 1e-12);
            assert!((wt.dot(along) + sin(angle) / 1.5).abs() < 1e-12);
            let none = dielectric(n.dot(wo), 1.0);
            assert_eq!(none.reflectance, 0.0);
            assert!((refracted(wo, n, 1.0, &none) + wo).length() < 1e-15);
        }
        assert_eq!(dielectric(0.0, 1.0).reflectance, 0.0);
    }

    #[test]
    fn a_sheet_keeps_all_light_it_does_not_absorb() {
        for c in [0.0, 1e-12, 0.1, 0.5, 1.0] {
            for eta in [1.0, 1.33, 1.5, 2.4, 0.7] {
                let (back, through) = sheet(c, eta, Rgb::WHITE);
                assert!((back.g + through.g - 1.0).abs() < 1e-9, "{c} {eta}");
            }
        }
        let (back, through) = sheet(1.0, 1.5, Rgb::new(1.0, 0.5, 0.0));
        assert!(through.r > through.g && through.b == 0.0 && back.b >= 0.04 - 1e-15);
        // One crossing takes half: (1 - R)² t / (1 - R² t²).
        assert!((through.g - 0.96 * 0.96 * 0.5 / (1.0 - 0.0016 * 0.25)).abs() < 1e-12);
    }

    #[test]
    fn schlick_joins_both_ends() {
        let gold = Rgb::new(1.0, 0.7, 0.3);
        assert_eq!(schlick(gold, 1.0), gold);
        assert_eq!(schlick(gold, 0.0), Rgb::WHITE);
    }
}
