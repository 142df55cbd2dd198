//! What each lobe beside the matt part does, in the frame of the surface: value, density and sampling.

use super::fresnel::{Boundary, dielectric, reflected, refracted, sheet};
use super::lobe::{Lobe, LobeKind};
use super::microfacet;
use super::scattering::{ScatterNumbers, ScatteringFrame, Transport};
use crate::color::Rgb;
use crate::math::frame::Frame;
use crate::math::functions::{cos, pow, sin};
use crate::math::tolerance::SMOOTHEST_ALPHA;
use glam::{DVec2, DVec3};
use std::f64::consts::TAU;

/// A surface point seen from one side.
pub(super) struct Spot {
    /// z is the normal cosines are taken with, on the side of `wo`.
    pub(super) frame: Frame,
    /// Where the path comes from, local; z > 0.
    pub(super) wo: DVec3,
    /// Whether that is the front side.
    pub(super) is_front: bool,
    /// Cosine of `wo` to the true normal.
    cos_g: f64,
}

/// A direction chosen by a lobe.
pub(super) enum Event {
    /// One of few directions: local, its part of the light, and `(n_o/n_i)²` (already in the weight).
    Delta {
        wi: DVec3,
        weight: Rgb,
        compression: f64,
    },
    /// One of very many, local.
    Smooth { wi: DVec3 },
}

impl Spot {
    /// The point as seen from `wo`; `None` along the surface.
    ///
    /// Where a smoothed normal turns away from `wo`, which cannot be, the true one takes its place.
    pub(super) fn new(frame: &ScatteringFrame, wo: DVec3) -> Option<Self> {
        let is_front = frame.is_in_front(wo);
        let sign = if is_front { 1.0 } else { -1.0 };
        let true_normal = frame.normal_g * sign;
        let smoothed = frame.normal_s * sign;
        let normal = if smoothed.dot(wo) > 0.0 {
            smoothed
        } else {
            true_normal
        };
        let frame = Frame::from_normal(normal);
        let local = frame.to_local(wo);
        (local.z > 0.0).then_some(Self {
            frame,
            wo: local,
            is_front,
            cos_g: true_normal.dot(wo),
        })
    }

    /// A local direction of a mirror or of smooth glass in the world, put on the side of the true surface where it belongs: a
    /// smoothed normal may mirror light into the surface, which the true one does not. `None` for refraction that stays outside.
    pub(super) fn settled(&self, frame: &ScatteringFrame, wi: DVec3) -> Option<DVec3> {
        let world = self.frame.to_world(wi).normalize();
        let is_reflection = wi.z > 0.0;
        if (frame.is_in_front(world) == self.is_front) == is_reflection {
            return Some(world);
        }
        let wo = self.frame.to_world(self.wo);
        is_reflection.then(|| reflected(wo, frame.normal_g).normalize())
    }
}

/// Index of refraction on the far side of a body's skin over that on the near side.
fn relative_index(ior: f64, is_front: bool) -> f64 {
    if is_front { ior } else { 1.0 / ior }
}

/// `(n_o/n_i)²` of light that crosses a lobe's boundary, seen from the front or back; 1 without boundary and for flux.
pub(super) fn compression(lobe: &Lobe, is_front: bool, transport: Transport) -> f64 {
    match (lobe.kind, transport) {
        (LobeKind::Dielectric { ior, .. }, Transport::Radiance) => {
            let eta = relative_index(ior, is_front);
            1.0 / (eta * eta)
        }
        _ => 1.0,
    }
}

/// f · |cos θ| of a lobe, 1/sr; black for what goes into single directions.
pub(super) fn value_cos(lobe: &Lobe, spot: &Spot, wi: DVec3, transport: Transport) -> Rgb {
    let wo = spot.wo;
    match lobe.kind {
        LobeKind::Phong { exponent } if wi.z > 0.0 => {
            lobe.weight * (phong(reflected(wo, DVec3::Z), wi, exponent) * wi.z)
        }
        LobeKind::Haze { exponent } if wi.z < 0.0 => {
            lobe.weight * (phong(-wo, wi, exponent) * -wi.z)
        }
        LobeKind::Rough { alpha, reflection } => match microfacet::reflection(wo, wi, alpha) {
            Some(facets) => lobe.weight * reflection.at(facets.cos_facet) * facets.value_cos,
            None => Rgb::BLACK,
        },
        LobeKind::Dielectric { ior, alpha, .. } if alpha >= SMOOTHEST_ALPHA => {
            let eta = relative_index(ior, spot.is_front);
            let facets = if wi.z > 0.0 {
                microfacet::reflection(wo, wi, alpha)
            } else {
                microfacet::refraction(wo, wi, alpha, eta)
            };
            let Some(facets) = facets else {
                return Rgb::BLACK;
            };
            let reflectance = dielectric(facets.cos_facet, eta).reflectance;
            let part = if wi.z > 0.0 {
                reflectance
            } else {
                (1.0 - reflectance) * compression(lobe, spot.is_front, transport)
            };
            lobe.weight * (part * facets.value_cos)
        }
        _ => Rgb::BLACK,
    }
}

/// Density per steradian with which a lobe chooses `wi`; 0 for what goes into single directions.
pub(super) fn pdf_solid_angle(lobe: &Lobe, spot: &Spot, wi: DVec3) -> f64 {
    let wo = spot.wo;
    match lobe.kind {
        LobeKind::Phong { exponent } if wi.z > 0.0 => {
            phong_density(reflected(wo, DVec3::Z), wi, exponent)
        }
        LobeKind::Haze { exponent } if wi.z < 0.0 => phong_density(-wo, wi, exponent),
        LobeKind::Rough { alpha, .. } => {
            microfacet::reflection(wo, wi, alpha).map_or(0.0, |facets| facets.pdf_solid_angle)
        }
        LobeKind::Dielectric { ior, alpha, .. } if alpha >= SMOOTHEST_ALPHA => {
            let eta = relative_index(ior, spot.is_front);
            let chance = |cos| dielectric(cos, eta).reflectance;
            if wi.z > 0.0 {
                microfacet::reflection(wo, wi, alpha)
                    .map_or(0.0, |f| f.pdf_solid_angle * chance(f.cos_facet))
            } else {
                microfacet::refraction(wo, wi, alpha, eta)
                    .map_or(0.0, |f| f.pdf_solid_angle * (1.0 - chance(f.cos_facet)))
            }
        }
        _ => 0.0,
    }
}

/// Lets a lobe choose a direction; `None` if it points to where the lobe sends nothing.
pub(super) fn sample(
    lobe: &Lobe,
    spot: &Spot,
    numbers: ScatterNumbers,
    transport: Transport,
) -> Option<Event> {
    let (wo, u) = (spot.wo, numbers.direction);
    match lobe.kind {
        LobeKind::Mirror(reflection) => Some(mirrored(wo, lobe.weight * reflection.at(wo.z))),
        LobeKind::Pane { ior, tint } => {
            Some(mirrored(wo, lobe.weight * sheet(spot.cos_g, ior, tint).0))
        }
        LobeKind::Phong { exponent } => {
            let wi = sample_phong(reflected(wo, DVec3::Z), exponent, u);
            (wi.z > 0.0).then_some(Event::Smooth { wi })
        }
        LobeKind::Haze { exponent } => {
            let wi = sample_phong(-wo, exponent, u);
            (wi.z < 0.0).then_some(Event::Smooth { wi })
        }
        LobeKind::Rough { alpha, .. } => {
            let wi = reflected(wo, microfacet::visible_normal(wo, alpha, u));
            (wi.z > 0.0).then_some(Event::Smooth { wi })
        }
        LobeKind::Dielectric { ior, alpha, .. } => {
            let eta = relative_index(ior, spot.is_front);
            if alpha < SMOOTHEST_ALPHA {
                let boundary = dielectric(wo.z, eta);
                let is_reflected = numbers.lobe.y < boundary.reflectance;
                Some(if is_reflected {
                    mirrored(wo, lobe.weight)
                } else {
                    let compression = compression(lobe, spot.is_front, transport);
                    Event::Delta {
                        wi: refracted(wo, DVec3::Z, eta, &boundary),
                        weight: lobe.weight * compression,
                        compression,
                    }
                })
            } else {
                let facet = microfacet::visible_normal(wo, alpha, u);
                let boundary = dielectric(wo.dot(facet).max(0.0), eta);
                rough_glass(wo, facet, eta, &boundary, numbers.lobe.y)
            }
        }
        LobeKind::Through => None,
    }
}

/// (n + 2)/2π cosⁿ of the angle to the axis: with a further cosine to the surface it integrates to at most 1.
fn phong(axis: DVec3, wi: DVec3, exponent: f64) -> f64 {
    (exponent + 2.0) / TAU * lobe_power(axis, wi, exponent)
}

/// (n + 1)/2π cosⁿ: density per steradian of [`sample_phong`].
fn phong_density(axis: DVec3, wi: DVec3, exponent: f64) -> f64 {
    (exponent + 1.0) / TAU * lobe_power(axis, wi, exponent)
}

/// cosⁿ of the angle to the axis; 0 behind it, for n = 0 too.
fn lobe_power(axis: DVec3, wi: DVec3, exponent: f64) -> f64 {
    let cos = axis.dot(wi);
    if cos > 0.0 { pow(cos, exponent) } else { 0.0 }
}

fn sample_phong(axis: DVec3, exponent: f64, u: DVec2) -> DVec3 {
    let z = pow(1.0 - u.x, 1.0 / (exponent + 1.0));
    let radius = (1.0 - z * z).max(0.0).sqrt();
    let round = DVec3::new(radius * cos(TAU * u.y), radius * sin(TAU * u.y), z);
    Frame::from_normal(axis).to_world(round)
}

fn mirrored(wo: DVec3, weight: Rgb) -> Event {
    Event::Delta {
        wi: DVec3::new(-wo.x, -wo.y, wo.z),
        weight,
        compression: 1.0,
    }
}

/// Reflects or refracts on a facet, by chance; `None` if the facet sends light to the wrong side.
fn rough_glass(
    wo: DVec3,
    facet: DVec3,
    eta: f64,
    boundary: &Boundary,
    chance: f64,
) -> Option<Event> {
    let is_reflected = chance < boundary.reflectance;
    let wi = if is_reflected {
        reflected(wo, facet)
    } else {
        refracted(wo, facet, eta, boundary)
    };
    (is_reflected == (wi.z > 0.0) && wi.z != 0.0).then_some(Event::Smooth { wi })
}
