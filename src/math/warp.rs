//! Maps from the unit square to disks, spheres, cones and triangles, each with the density it produces.
//!
//! A map from area-uniform points: `u` in [0, 1)² gives points with exactly the stated density. All are continuous, so that
//! well-spread points of the square stay well spread. Densities per unit area (`pdf_area`) or per steradian
//! (`pdf_solid_angle`) are named; they never share a name.

use crate::math::functions::{cos, sin, sin_cos};
use glam::{DVec2, DVec3};
use std::f64::consts::{FRAC_1_PI, FRAC_PI_4, TAU};

/// A point of the unit disk, uniform (density 1/π per area), by the concentric map of [Shirley1997](crate::references#shirley1997).
#[must_use]
pub fn disk(u: DVec2) -> DVec2 {
    let p = u * 2.0 - DVec2::ONE;
    if p == DVec2::ZERO {
        return DVec2::ZERO;
    }
    if p.x.abs() > p.y.abs() {
        let (sin, cos) = sin_cos(FRAC_PI_4 * (p.y / p.x));
        DVec2::new(p.x * cos, p.x * sin)
    } else {
        // The angle is the rest to a right one; the smaller angle is the quicker one.
        let (sin, cos) = sin_cos(FRAC_PI_4 * (p.x / p.y));
        DVec2::new(p.y * sin, p.y * cos)
    }
}

/// A unit direction of the hemisphere round +z with density cos θ / π per steradian (Malley's method: a disk point, lifted).
#[must_use]
pub fn cosine_hemisphere(u: DVec2) -> DVec3 {
    let p = disk(u);
    DVec3::new(p.x, p.y, (1.0 - p.length_squared()).max(0.0).sqrt())
}

/// Density of [`cosine_hemisphere`] per steradian, from the cosine to +z.
#[must_use]
pub fn cosine_hemisphere_pdf_solid_angle(cos_theta: f64) -> f64 {
    cos_theta.max(0.0) * FRAC_1_PI
}

/// A unit direction, uniform over the sphere (density 1/4π per steradian).
#[must_use]
pub fn sphere(u: DVec2) -> DVec3 {
    direction(1.0 - 2.0 * u.x, u.y)
}

/// Density of [`sphere`] per steradian.
#[must_use]
pub const fn sphere_pdf_solid_angle() -> f64 {
    0.25 * FRAC_1_PI
}

/// Solid angle of the cone of directions within `angle` (radians, 0..=π) of an axis, in steradian.
///
/// Written as 4π sin²(angle/2), which keeps all digits for cones as narrow as the sun's disk.
#[must_use]
pub fn cone_solid_angle(angle: f64) -> f64 {
    let s = sin(0.5 * angle);
    2.0 * TAU * s * s
}

/// A unit direction, uniform over the cone of directions within `angle` (radians) of +z; density 1 / [`cone_solid_angle`].
#[must_use]
pub fn cone(u: DVec2, angle: f64) -> DVec3 {
    // 1 - cos θ = u·(1 - cos angle); sin θ from the half angle so that narrow cones keep their digits.
    let s = sin(0.5 * angle);
    let one_minus_cos = 2.0 * u.x * s * s;
    let sin_theta = (one_minus_cos * (2.0 - one_minus_cos)).max(0.0).sqrt();
    let phi = TAU * u.y;
    DVec3::new(
        sin_theta * cos(phi),
        sin_theta * sin(phi),
        1.0 - one_minus_cos,
    )
}

/// Barycentric weights (of the second and third corner), uniform over a triangle, by the square-folding of
/// [Heitz2019](crate::references#heitz2019), which distorts well-spread points least.
#[must_use]
pub fn triangle(u: DVec2) -> DVec2 {
    let half = u * 0.5;
    let offset = half.y - half.x;
    if offset > 0.0 {
        DVec2::new(half.x, half.y + offset)
    } else {
        DVec2::new(half.x - offset, half.y)
    }
}

/// The unit direction with z = `cos_theta` at the fraction `turn` of a full turn about z, from +x towards +y.
#[must_use]
pub fn direction(cos_theta: f64, turn: f64) -> DVec3 {
    let sin_theta = (1.0 - cos_theta * cos_theta).max(0.0).sqrt();
    let phi = TAU * turn;
    DVec3::new(sin_theta * cos(phi), sin_theta * sin(phi), cos_theta)
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::f64::consts::PI;

    /// Mean of `f` over a fine midpoint grid on the square.
    fn mean(f: impl Fn(DVec2) -> f64) -> f64 {
        let n = 400;
        let mut sum = 0.0;
        for i in 0..n {
            for j in 0..n {
                sum += f(DVec2::new(f64::from(i) + 0.5, f64::from(j) + 0.5) / f64::from(n));
            }
        }
        sum / f64::from(n * n)
    }

    #[test]
    fn moments_match_the_densities() {
        assert!((mean(|u| disk(u).length_squared()) - 0.5).abs() < 1e-5);
        assert!((mean(|u| cosine_hemisphere(u).z) - 2.0 / 3.0).abs() < 1e-4);
        assert!(mean(|u| sphere(u).z).abs() < 1e-9);
        assert!((mean(|u| sphere(u).x.powi(2)) - 1.0 / 3.0).abs() < 1e-4);
        let angle: f64 = 0.7;
        assert!((mean(|u| cone(u, angle).z) - (1.0 + angle.cos()) / 2.0).abs() < 1e-9);
        assert!((mean(|u| triangle(u).x) - 1.0 / 3.0).abs() < 1e-4);
        assert!((mean(|u| triangle(u).x * triangle(u).y) - 1.0 / 12.0).abs() < 1e-4);
    }

    #[test]
    fn narrow_and_full_cones() {
        let sun = 0.2666_f64.to_radians();
        assert!((cone_solid_angle(sun) / (PI * sun * sun) - 1.0).abs() < 1e-5);
        assert!((cone_solid_angle(PI) - 4.0 * PI).abs() < 1e-12);
        let edge = cone(DVec2::new(1.0, 0.3), sun);
        assert!((edge.truncate().length() / sun.sin() - 1.0).abs() < 1e-12);
    }

    #[test]
    fn corners_of_the_square_stay_inside() {
        for u in [
            DVec2::ZERO,
            DVec2::X,
            DVec2::Y,
            DVec2::ONE,
            DVec2::splat(0.5),
        ] {
            assert!(disk(u).length() <= 1.0 + 1e-15);
            assert!((cosine_hemisphere(u).length() - 1.0).abs() < 1e-12);
            let b = triangle(u);
            assert!(b.x >= 0.0 && b.y >= 0.0 && b.x + b.y <= 1.0);
        }
    }
}
