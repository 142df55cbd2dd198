//! Photons that show where light comes from.

use super::Photon;
use super::directions::Arrival;
use crate::integrator::photon::{
    Aim, Emission, History, Onward, PhotonHit, Photons, Visitor, trace,
};
use crate::integrator::{RenderContext, RenderError};
use crate::scene::Scene;

/// Photons that are sent out.
const N_PHOTONS: u64 = 1 << 18;

/// Scatterings of a photon, at most. What comes later teaches little.
const DEEPEST: u32 = 32;

/// Keeps the photons that guide paths.
#[derive(Default)]
struct Arrivals(Vec<Photon>);

impl Visitor for Arrivals {
    fn arrives(&mut self, hit: &PhotonHit<'_>) -> Onward {
        // Light straight from a source is sampled anyway.
        if hit.history != History::Direct && super::is_guided(hit.optics) {
            self.0.push(Photon {
                position: hit.point.position.as_vec3(),
                side: super::side(super::facing(hit.point)),
                arrival: Arrival::new(hit.wo, hit.power.mean() as f32),
            });
        }
        Onward::Go
    }
}

/// Follows photons from all sources, and keeps where they arrive on matt surfaces after at least one event.
pub(super) fn photons(
    scene: &Scene,
    context: &RenderContext<'_>,
) -> Result<Vec<Photon>, RenderError> {
    let emission = Emission::new(scene, Aim::Everything);
    let all = Photons::all(N_PHOTONS, context.seed, DEEPEST);
    let mut photons = Vec::new();
    trace(&emission, &all, context, Arrivals::default, |seen| {
        photons.extend(seen.0);
    })?;
    Ok(photons)
}
