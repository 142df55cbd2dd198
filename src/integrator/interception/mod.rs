//! Light that plants feel: what each organ of a scene gets of the light of its sources.
//!
//! Photons are followed from the sources ([`photon`](super::photon)) and counted where they arrive, in whole quanta, so that the
//! books balance exactly and no result depends on the number of threads. The photons of a run are split into batches that are
//! spread over the sources independently of each other; standard errors come from the differences between batches, since
//! photons of one batch are not independent (their error falls faster than with independent ones, and cannot be told from them).
//!
//! ```text
//! bins        what arrives at each organ and side    sums     batches together: means and standard errors
//! sensors     discs that count what passes them
//! ```

mod bins;
mod sensors;
mod sums;

pub use sensors::SensorField;
pub use sums::{Books, Errors, Lighting, OrganLight};

use super::photon::{Aim, Emission, Photons, Plot, trace};
use super::requirements::{Features, Requirements};
use super::{Progress, RenderContext, RenderError};
use crate::math::rng;
use crate::scene::Scene;
use bins::{Bin, Tally};
use sums::Sums;

/// How to find out.
#[derive(Clone, Debug, PartialEq)]
pub struct Interception {
    /// Photons of the first round, all batches together; at least 1.
    pub photons: u64,
    /// Batches of a round; at least 1. Standard errors need 2 and are worth something from 8 on.
    pub batches: u32,
    /// Scatterings after which a photon is given up and its power counted as lost.
    pub max_depth: u32,
    /// Standard errors that further rounds shall reach.
    pub wanted: Wanted,
    /// No round begins that would use more photons than this, all rounds together.
    pub most_photons: u64,
    /// Bytes that bins may take.
    pub memory: u64,
    /// The plant that each organ belongs to, by organ number; `None` for what is no plant, such as the ground, which then counts
    /// in no total either. Organs beyond the list belong to no plant; an empty list puts all organs into the total.
    pub plants: Vec<Option<u32>>,
    /// What is done even if the scene does not require it.
    pub kept: Features,
}

/// Standard errors to reach, as fractions of what is measured.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Wanted {
    /// Of the power that an organ absorbs; 19 of 20 lit organs shall reach it.
    pub of_organs: Option<f64>,
    /// Of the power that the organs of a plant absorb together; 19 of 20 lit plants shall reach it.
    pub of_plants: Option<f64>,
    /// Of the power that all organs together absorb.
    pub of_total: Option<f64>,
}

/// Why there is no answer.
#[derive(Debug, thiserror::Error)]
pub enum InterceptionError {
    /// Somebody cancelled.
    #[error("the light was stopped before it had been counted")]
    Cancelled,
    /// The bins would not fit.
    #[error("counting the light on {organs} organs needs {bytes} bytes of memory")]
    Memory {
        /// Number of organs.
        organs: usize,
        /// Bytes they would need.
        bytes: u64,
    },
}

/// Photons of a further round are at most so many times those before it: the error of a short round is not well known.
const FASTEST_GROWTH: f64 = 8.0;

/// With which power of the number of photons errors are expected to fall: between that of independent photons (0.5) and what
/// parallel light reaches (measured for a tree's leaves: 0.72).
const EXPECTED_RATE: f64 = 0.6;

impl Interception {
    /// Follows photons and counts them. Organs are those that surfaces of the scene [belong to](crate::scene::SurfacePoint::owner),
    /// with numbers below `n_organs`; what has another number is counted as [`Lighting::rest`]. With a `plot` the world repeats
    /// itself; the scene must hold what hangs over its sides on the opposite side as well, and nothing that shines may do so.
    ///
    /// # Errors
    /// If the context is cancelled, or there is no room.
    pub fn solve(
        &self,
        scene: &Scene,
        n_organs: usize,
        sensors: &SensorField,
        plot: Option<Plot>,
        context: &RenderContext<'_>,
    ) -> Result<Lighting, InterceptionError> {
        let n_plants = self.plants.iter().flatten().max();
        let n_plants = n_plants.map_or(0, |last| *last as usize + 1);
        let bytes = Sums::bytes(n_organs + n_plants + 1, sensors.len());
        if bytes > self.memory {
            return Err(InterceptionError::Memory {
                organs: n_organs,
                bytes,
            });
        }
        let emission = match plot {
            Some(plot) => Emission::into_plot(scene, plot),
            None => {
                let requirements = Requirements::of(scene, self.kept);
                Emission::required(&requirements, scene, Aim::Everything, sensors.bounds())
            }
        };
        let mut sums = Sums::new(n_organs + 1, sensors.len(), (&self.plants, n_plants));
        let mut next = self.photons.max(1);
        for round in 0_u64.. {
            self.round([round, next], &emission, sensors, &mut sums, context)?;
            let excess = sums.excess(self.wanted);
            let done = sums.n_photons();
            let room = self.most_photons.saturating_sub(done);
            if excess <= 1.0 || room < u64::from(self.batches) || emission.is_dark() {
                break;
            }
            let factor = excess.powf(1.0 / EXPECTED_RATE) - 1.0;
            let more = done as f64 * factor.clamp(1.0, FASTEST_GROWTH);
            next = room.min(more as u64);
        }
        let is_reached = sums.excess(self.wanted) <= 1.0;
        Ok(sums.finish(is_reached))
    }

    /// Adds a round, with its number, of batches of together `photons` photons.
    fn round(
        &self,
        [round, photons]: [u64; 2],
        emission: &Emission<'_>,
        sensors: &SensorField,
        sums: &mut Sums<'_>,
        context: &RenderContext<'_>,
    ) -> Result<(), InterceptionError> {
        let n_batches = u64::from(self.batches.max(1));
        let n = photons.div_ceil(n_batches);
        let n_bins = sums.n_bins();
        for batch in 0..n_batches {
            let seed = rng::hash(&[context.seed, round, batch]);
            let set = Photons::all(n, seed, self.max_depth);
            let (done, total) = (batch * n, n_batches * n);
            let report = |progress: Progress| {
                (context.progress)(Progress {
                    done: done + progress.done,
                    total,
                });
            };
            let context = RenderContext {
                progress: &report,
                ..*context
            };
            let scale = set.scale(emission);
            let mut bins = vec![Bin::default(); n_bins];
            let mut sensed = sensors.accounts();
            let visitor = || Tally::new(scale, n_bins, sensors);
            let ledger = trace(emission, &set, &context, visitor, |tally| {
                tally.join(&mut bins, &mut sensed);
            });
            let ledger = ledger.map_err(|_: RenderError| InterceptionError::Cancelled)?;
            sums.add_batch(&bins, sensors, &sensed, &ledger);
        }
        sums.end_round(n_batches, n);
        Ok(())
    }
}
