//! Rough surfaces as landscapes of tiny facets: the GGX distribution.
//!
//! All directions are local: z is the normal, `wo.z` > 0. α is the *squared* perceived roughness, 0 < α ≤ 1. Light is
//! followed over one facet only; what would meet a second one is lost (a known deficit: white furnaces of α = 1 darken).
//!
//! Sources: distribution and refraction [Walter2007](crate::references#walter2007); masking
//! [Heitz2014](crate::references#heitz2014); sampling of the visible facets
//! [`DupuyBenyoub2023`](crate::references#dupuybenyoub2023), which draws from the same density as
//! [Heitz2018](crate::references#heitz2018).

use crate::math::functions::{cos, sin};
use glam::{DVec2, DVec3};
use std::f64::consts::{PI, TAU};

/// D: area of facets with the unit normal `m` per unit area of surface and steradian.
fn distribution(m: DVec3, alpha: f64) -> f64 {
    let a2 = alpha * alpha;
    let flat = m.x * m.x + m.y * m.y + a2 * m.z * m.z;
    a2 / (PI * flat * flat)
}

/// Λ of Smith's masking function: hidden area per visible area, seen along `w`.
fn lambda(w: DVec3, alpha: f64) -> f64 {
    let tan2 = (w.x * w.x + w.y * w.y) / (w.z * w.z);
    0.5 * ((1.0 + alpha * alpha * tan2).sqrt() - 1.0)
}

/// Density per steradian of [`visible_normal`]: facets in proportion to the area with which they are seen along `wo`.
fn visible_density(wo: DVec3, m: DVec3, alpha: f64) -> f64 {
    distribution(m, alpha) * wo.dot(m).max(0.0) / (wo.z * (1.0 + lambda(wo, alpha)))
}

/// The normal of a facet, chosen among those seen along `wo` in proportion to their area as seen.
pub(super) fn visible_normal(wo: DVec3, alpha: f64, u: DVec2) -> DVec3 {
    // Stretch the facets to a hemisphere, take a point of the spherical cap that its mirror images fill, and go back.
    let stretched = DVec3::new(alpha * wo.x, alpha * wo.y, wo.z).normalize();
    let z = (1.0 - u.y) * (1.0 + stretched.z) - stretched.z;
    let radius = (1.0 - z * z).max(0.0).sqrt();
    let cap = DVec3::new(radius * cos(TAU * u.x), radius * sin(TAU * u.x), z);
    let half = cap + stretched;
    let m = DVec3::new(alpha * half.x, alpha * half.y, half.z.max(0.0));
    // Straight below and straight above cancel; any facet will do for that single point.
    m.try_normalize().unwrap_or(DVec3::Z)
}

/// A pair of directions and what the facets do between them, without the Fresnel term.
#[derive(Clone, Copy, Debug)]
pub(super) struct Scatter {
    /// Cosine of `wo` to the facet that does it.
    pub(super) cos_facet: f64,
    /// f · |cos θi| without Fresnel and η², 1/sr.
    pub(super) value_cos: f64,
    /// Density of `wi` per steradian, without the chance of reflection or refraction.
    pub(super) pdf_solid_angle: f64,
}

/// Reflection from `wi` to `wo`; `None` if `wi` is below the surface.
pub(super) fn reflection(wo: DVec3, wi: DVec3, alpha: f64) -> Option<Scatter> {
    if wi.z <= 0.0 {
        return None;
    }
    let m = (wo + wi).try_normalize()?;
    let cos_facet = wo.dot(m);
    if cos_facet <= 0.0 {
        return None;
    }
    let (hidden_o, hidden_i) = (lambda(wo, alpha), lambda(wi, alpha));
    let value_cos = distribution(m, alpha) / (4.0 * wo.z * (1.0 + hidden_o + hidden_i));
    let pdf_solid_angle = visible_density(wo, m, alpha) / (4.0 * cos_facet);
    finite(Scatter {
        cos_facet,
        value_cos,
        pdf_solid_angle,
    })
}

/// Refraction from `wi`, below the surface, to `wo`; `eta` is the index below over that above. `None` if no facet does it.
pub(super) fn refraction(wo: DVec3, wi: DVec3, alpha: f64, eta: f64) -> Option<Scatter> {
    if wi.z >= 0.0 {
        return None;
    }
    let m = (wi * eta + wo).try_normalize()?;
    let m = if m.z < 0.0 { -m } else { m };
    let (o, i) = (wo.dot(m), wi.dot(m));
    if o <= 0.0 || i >= 0.0 {
        return None;
    }
    // Facets per steradian of `wi` ([Walter2007, eq. 17]).
    let denominator = i + o / eta;
    let jacobian = -i / (denominator * denominator);
    let (hidden_o, hidden_i) = (lambda(wo, alpha), lambda(wi, alpha));
    let value_cos = distribution(m, alpha) * o * jacobian / (wo.z * (1.0 + hidden_o + hidden_i));
    let pdf_solid_angle = visible_density(wo, m, alpha) * jacobian;
    finite(Scatter {
        cos_facet: o,
        value_cos,
        pdf_solid_angle,
    })
}

/// Directions along the surface can have densities beyond all numbers; nothing is ever found there.
fn finite(scatter: Scatter) -> Option<Scatter> {
    let is_finite = scatter.value_cos.is_finite() && scatter.pdf_solid_angle.is_finite();
    is_finite.then_some(scatter)
}

#[cfg(test)]
mod tests {
    use super::*;

    /// ∫ over the hemisphere by the midpoint rule in (z, azimuth).
    fn integrate(f: impl Fn(DVec3) -> f64) -> f64 {
        let (rows, columns) = (2000, 64);
        let mut sum = 0.0;
        for row in 0..rows {
            for column in 0..columns {
                let z = (f64::from(row) + 0.5) / f64::from(rows);
                let phi = TAU * (f64::from(column) + 0.5) / f64::from(columns);
                let r = (1.0 - z * z).sqrt();
                sum += f(DVec3::new(r * phi.cos(), r * phi.sin(), z));
            }
        }
        sum * TAU / f64::from(rows * columns)
    }

    #[test]
    fn facets_cover_the_surface_once_and_what_is_seen_is_the_surface() {
        for alpha in [0.1, 0.3, 1.0] {
            let covered = integrate(|m| distribution(m, alpha) * m.z);
            assert!((covered - 1.0).abs() < 2e-3, "{alpha}: {covered}");
            for z in [1.0, 0.5, 0.05_f64] {
                let wo = DVec3::new((1.0 - z * z).sqrt(), 0.0, z);
                let seen = integrate(|m| visible_density(wo, m, alpha));
                assert!((seen - 1.0).abs() < 5e-3, "{alpha} {z}: {seen}");
            }
        }
    }
}
