//! Many photons, in parallel, with a result that does not depend on it.

use super::emission::Emission;
use super::ledger::{Ledger, Scale};
use super::tracer::{Tracer, Visitor};
use crate::integrator::medium::Bodies;
use crate::integrator::{Progress, RenderContext, RenderError};
use rayon::prelude::*;
use std::ops::Range;

/// Photons of a block: what one visitor sees.
pub const BLOCK: u64 = 4096;

/// Blocks that are followed before the first of them is joined: what all their visitors hold is in memory at once.
const BATCH: usize = 64;

/// Which photons to follow.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Photons {
    /// Their numbers; those of `0..n` together carry the power of the sources.
    pub range: Range<u64>,
    /// How many there are in all.
    pub n: u64,
    /// Decides all random choices; other seeds give independent photons.
    pub seed: u64,
    /// Scatterings after which a photon is given up and its power counted as lost.
    pub max_depth: u32,
}

impl Photons {
    /// All of `n` photons.
    #[must_use]
    pub const fn all(n: u64, seed: u64, max_depth: u32) -> Self {
        Self {
            range: 0..n,
            n,
            seed,
            max_depth,
        }
    }

    /// The scale of their books.
    #[must_use]
    pub fn scale(&self, emission: &Emission<'_>) -> Scale {
        Scale::for_mean(emission.power().max_channel() / self.n.max(1) as f64)
    }
}

/// Follows photons. Each block of [`BLOCK`] consecutive ones is told to a visitor of its own, made by `visitor`; `join` gets these
/// in the order of their blocks.
///
/// # Errors
/// [`RenderError::Cancelled`] once the context is cancelled. Its seed is not used: that of `photons` is.
pub fn trace<V: Visitor>(
    emission: &Emission<'_>,
    photons: &Photons,
    context: &RenderContext<'_>,
    visitor: impl Fn() -> V + Sync,
    mut join: impl FnMut(V),
) -> Result<Ledger, RenderError> {
    let scale = photons.scale(emission);
    let mut ledger = Ledger::new(scale);
    let tracer = Tracer {
        scene: emission.scene,
        bodies: Bodies::remembered(emission.scene, emission.has_bodies),
        max_depth: photons.max_depth,
        plot: emission.plot,
        ground: emission.ground,
    };
    let Range { start, end } = photons.range;
    let total = end.saturating_sub(start);
    let n_blocks = if emission.is_dark() {
        0
    } else {
        total.div_ceil(BLOCK)
    };
    let mut first = 0;
    while first < n_blocks {
        let batch = first..n_blocks.min(first + BATCH as u64);
        first = batch.end;
        let done: Vec<(V, Ledger)> = batch
            .into_par_iter()
            .map(|block| {
                let mut seen = visitor();
                let mut books = Ledger::new(scale);
                if !context.cancel.is_cancelled() {
                    let begin = start + block * BLOCK;
                    for index in begin..end.min(begin + BLOCK) {
                        if let Some(photon) = emission.photon(index, photons.n, photons.seed) {
                            tracer.follow(&photon, &mut seen, &mut books);
                        }
                    }
                }
                (seen, books)
            })
            .collect();
        if context.cancel.is_cancelled() {
            return Err(RenderError::Cancelled { partial: None });
        }
        for (seen, books) in done {
            ledger += books;
            join(seen);
        }
        (context.progress)(Progress {
            done: total.min(first * BLOCK),
            total,
        });
    }
    Ok(ledger)
}
