//! What the estimates of the map say of photons that are laid out by hand, for [`crate::validation::extremes`].

use super::estimate::{Spot, estimate, measure};
use super::irradiance::Layer;
use super::progressive::Progressive;
pub(crate) use super::progressive::shrunk;
use super::radius::Sizes;
use super::spots::World;
use super::stored::Stored;
use crate::integrator::grid::Grid;
use crate::scene::Scene;
use glam::DVec3;

/// A photon on a large surface: where, the normal of its side, and its power, W in each channel.
pub(crate) type Laid = (DVec3, DVec3, f64);

/// The irradiance of a level surface at a place, W/m², by photons within `radius` of it.
pub(crate) fn irradiance(
    scene: &Scene,
    photons: impl Iterator<Item = Laid>,
    position: DVec3,
    radius: f64,
) -> f64 {
    let normal = DVec3::Z;
    let grid = Grid::new(stored(photons), radius, Stored::position);
    let measured = measure(scene, position, normal, radius);
    let spot = Spot { position, normal };
    let found = estimate(&grid, spot, radius, &measured, |_| false);
    found.irradiance.g
}

/// Places and their irradiance, W/m², after so many passes of photons, the kernel of the first of this area, m².
pub(crate) fn after_passes<P: Iterator<Item = Laid>>(
    scene: &Scene,
    area: f64,
    n_passes: u32,
    photons: impl Fn(u32) -> P,
) -> Vec<(DVec3, f64)> {
    let world = World {
        scene,
        center: DVec3::ZERO,
    };
    let Some(mut light) =
        Progressive::begin(world, stored(photons(0)), Sizes::Area(area), n_passes)
    else {
        return Vec::new();
    };
    for pass in 1..n_passes {
        light.add(pass + 1, stored(photons(pass)));
    }
    let map = light.finish();
    let samples = map.layers.iter().flat_map(Layer::samples);
    let shown = samples.map(|sample| {
        let (position, _, irradiance, ..) = sample.parts();
        (position.as_dvec3(), f64::from(irradiance.y))
    });
    shown.collect()
}

fn stored(photons: impl Iterator<Item = Laid>) -> Vec<Stored> {
    let stored = photons.map(|(position, normal, power)| Stored::at(position, normal, power));
    stored.collect()
}
