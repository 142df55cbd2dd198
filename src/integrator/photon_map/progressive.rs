//! Photons in passes: as many as one likes, in the memory of one pass.
//!
//! Statistics are kept at places on the surfaces, not in pixels, so all cameras share them: the light gathered so far, and the kernel.
//! Each pass adds the light of other photons with a kernel that is a little smaller, so that in the mean over passes both noise and
//! blur vanish: r²(i+1) = r²(i) (i + α)/(i + 1) with α = 2/3, for which the squared error falls fastest, with the power -2/3 of the
//! number of passes. Sources: [`Hachisuka2008`](crate::references#hachisuka2008) for the idea, [`Knaus2011`](crate::references#knaus2011)
//! for radii that depend on the pass alone.
//!
//! The kernel is kept for a few passes and then takes the size it should have had reached, so that the surface under it is measured
//! only so often as passes double, twice. Places are as near to each other as the last kernel needs. Where the first pass has left gaps
//! later ones find places; what these missed is made up for.

use super::irradiance::{IrradianceMap, Layer, SPACING};
use super::pieces::{PiecePower, over_area, split_off_pieces, together};
use super::pool::Pool;
use super::radius::{Radii, Sizes};
use super::spots::{
    Key, SpotLayer, SpotLight, World, anywhere, cells, newly_found, scene_size, spots,
};
use super::stored::{PackedNormal, Stored};
use crate::integrator::grid::Grid;
use glam::Vec3;
use rayon::prelude::*;

/// What becomes of the squared radius: the best for the squared error.
const ALPHA: f64 = 2.0 / 3.0;

/// The light of a scene after some passes.
pub(super) struct Progressive<'s> {
    world: World<'s>,
    /// Pieces that are small for it have their light as a whole, metres.
    usual: f64,
    /// The coarsest first; radii are those of the first pass.
    layers: Vec<SpotLayer>,
    /// Their power, and how many photons brought it.
    pieces: Vec<PiecePower>,
    n_on_pieces: u64,
    places: Vec<(Vec3, PackedNormal)>,
    /// Cells of the coarsest layer in which there are places, sorted.
    known: Vec<Key>,
    n_passes: u32,
    /// The present radius of kernels in those of the first pass.
    shrunk: f64,
}

impl<'s> Progressive<'s> {
    /// Begins with the photons of the first of `n_passes` passes; `None` if there is nothing to see.
    pub(super) fn begin(
        world: World<'s>,
        photons: Vec<Stored>,
        sizes: Sizes,
        n_passes: u32,
    ) -> Option<Self> {
        let radii = Radii::new(&photons, sizes, scene_size(world.scene))?;
        let last = shrunk(n_passes);
        let usual = radii.usual * last;
        let n_photons = photons.len();
        let (pieces, photons) = split_off_pieces(world.scene, photons, usual);
        let n_on_pieces = (n_photons - photons.len()) as u64;
        let places = if radii.largest > radii.usual {
            anywhere((world.scene, &photons), usual * SPACING)
        } else {
            Vec::new()
        };
        let width = radii.largest * SPACING * last;
        let known = cells((world.scene, &photons), width);
        let mut layers = spots(&world, photons, radii, SPACING * last);
        if layers.first().is_none_or(|layer| layer.spacing != width) {
            let empty = SpotLayer {
                spacing: width,
                radius: radii.largest,
                spots: Vec::new(),
            };
            layers.insert(0, empty);
        }
        Some(Self {
            world,
            usual,
            places,
            known,
            n_passes,
            layers,
            pieces,
            n_on_pieces,
            shrunk: 1.0,
        })
    }

    /// Adds the photons of a pass, counted from 1; the first was that of [`begin`](Self::begin).
    pub(super) fn add(&mut self, pass: u32, photons: Vec<Stored>) {
        let n_photons = photons.len();
        let (pieces, mut photons) = split_off_pieces(self.world.scene, photons, self.usual);
        self.n_on_pieces += (n_photons - photons.len()) as u64;
        self.pieces = together(&self.pieces, &pieces);
        let now = shrunk(pass);
        let has_shrunk = now < self.shrunk;
        self.shrunk = now;
        let world = self.world;
        for layer in &mut self.layers {
            let radius = layer.radius * now;
            let grid = Grid::new(photons, radius, Stored::position);
            layer.spots.par_iter_mut().for_each(|spot: &mut SpotLight| {
                if has_shrunk {
                    *spot = spot.resized(&world, radius);
                }
                spot.irradiance += spot.light(&world, &grid).irradiance;
            });
            photons = grid.into_things();
        }
        self.fill_gaps(pass, &photons);
    }

    /// Finds places where there were none; they count from the next pass on, because that photons found them is no chance.
    fn fill_gaps(&mut self, pass: u32, photons: &[Stored]) {
        let Some(layer) = self.layers.first_mut() else {
            return;
        };
        if pass < self.n_passes {
            let size = (layer.radius * self.shrunk, layer.spacing);
            let mut found = newly_found(&self.world, photons, size, &mut self.known);
            found.iter_mut().for_each(|spot| spot.missed = pass);
            layer.spots.extend(found);
        }
    }

    /// What views ask for.
    pub(super) fn finish(mut self) -> IrradianceMap {
        for layer in &mut self.layers {
            for spot in layer.spots.iter_mut().filter(|spot| spot.missed > 0) {
                let seen = f64::from(self.n_passes - spot.missed);
                spot.irradiance *= f64::from(self.n_passes) / seen;
            }
        }
        self.layers.retain(|layer| !layer.spots.is_empty());
        let layers = self.layers.into_iter().rev().map(|layer| {
            let samples = layer.spots.iter().map(SpotLight::sample);
            Layer::new(samples.collect(), layer.spacing)
        });
        let World { scene, center } = self.world;
        let pool = Pool::new(scene, center, &self.pieces, self.n_on_pieces, self.usual);
        IrradianceMap {
            center,
            radius: self.usual,
            layers: layers.collect(),
            pieces: over_area(scene, &self.pieces),
            pool,
            places: self.places,
        }
    }
}

/// The radius of kernels in a pass, counted from 1, in those of the first pass.
pub(crate) fn shrunk(pass: u32) -> f64 {
    let pass = pass.max(1);
    let power = 1 << pass.ilog2();
    let half_more = power + power / 2;
    let step = if power > 1 && pass >= half_more {
        half_more
    } else {
        power
    };
    let factor = |i: u32| (f64::from(i) + ALPHA) / (f64::from(i) + 1.0);
    (1..step).map(factor).product::<f64>().sqrt()
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::math::functions::ln;

    #[test]
    fn c41_kernels_shrink_for_ever_as_the_theory_has_it() {
        let radii: Vec<f64> = (1..5000).map(shrunk).collect();
        assert_eq!(radii[0], 1.0);
        assert!(radii.windows(2).all(|pair| pair[1] <= pair[0]));
        assert!((radii[1] * radii[1] - (1.0 + ALPHA) / 2.0).abs() < 1e-15);
        // r² falls with the power α - 1.
        let slope = (ln(shrunk(1 << 20)) - ln(shrunk(1 << 10))) * 2.0 / ln(1024.0);
        assert!((slope + 1.0 / 3.0).abs() < 1e-3, "{slope}");
        let last = shrunk(u32::MAX >> 8);
        assert!(last > 0.0 && last < 0.1);
        // A surface is measured again twice for each doubling.
        let sizes = radii.windows(2).filter(|pair| pair[0] != pair[1]).count();
        assert!(sizes < 26, "{sizes}");
    }
}
