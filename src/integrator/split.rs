//! All directions into which mirrors and glass send light, for rays that split where others choose.

use crate::material::{
    LobeKind, ScatterNumbers, ScatterSample, Scattering, ScatteringFrame, Transport, fresnel,
};
use crate::sampler::{Sampler, Use};
use glam::{DVec2, DVec3};

/// The directions into which the only lobe of `alone` sends light to be seen from `wo`, each with the share it has besides the
/// weight of its sample: both of smooth glass, the one of a mirror, one of a rough lobe.
pub(super) fn directions(
    alone: &Scattering<'_>,
    frame: &ScatteringFrame,
    wo: DVec3,
    sampler: &Sampler,
) -> [Option<(ScatterSample, f64)>; 2] {
    let lobe = &alone.lobes[0];
    let toward = |choice: f64| {
        let numbers = ScatterNumbers {
            direction: sampler.point(Use::Direction),
            lobe: DVec2::new(0.0, choice),
        };
        alone.sample(frame, wo, numbers, Transport::Radiance)
    };
    match lobe.kind {
        LobeKind::Dielectric { ior, .. } if lobe.is_delta() => {
            let eta = if frame.is_in_front(wo) {
                ior
            } else {
                1.0 / ior
            };
            let reflectance = fresnel::dielectric(facing_cos(frame, wo), eta).reflectance;
            let of_chance = |choice, share: f64| {
                let wanted = share > 0.0;
                wanted.then(|| toward(choice)).flatten().map(|s| (s, share))
            };
            [
                of_chance(0.0, reflectance),
                of_chance(1.0 - f64::EPSILON, 1.0 - reflectance),
            ]
        }
        LobeKind::Through => [None, None],
        LobeKind::Mirror(_) | LobeKind::Pane { .. } => [toward(0.0).map(|s| (s, 1.0)), None],
        LobeKind::Phong { .. }
        | LobeKind::Haze { .. }
        | LobeKind::Rough { .. }
        | LobeKind::Dielectric { .. } => {
            [toward(sampler.point(Use::Lobe).y).map(|s| (s, 1.0)), None]
        }
    }
}

/// Cosine of `wo` to the normal that mirrors; where a smoothed normal turns away, the true one takes its place.
fn facing_cos(frame: &ScatteringFrame, wo: DVec3) -> f64 {
    let sign = if frame.is_in_front(wo) { 1.0 } else { -1.0 };
    let smoothed = frame.normal_s.dot(wo) * sign;
    if smoothed > 0.0 {
        smoothed
    } else {
        frame.normal_g.dot(wo) * sign
    }
}
