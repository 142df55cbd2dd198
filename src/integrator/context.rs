//! What a renderer is given besides the scene, and what it gives back besides light.

use super::driver::FilmResult;
use std::ops::AddAssign;
use std::sync::Arc;
use std::sync::atomic::{AtomicBool, Ordering};

/// Everything from outside that rendering depends on. Threads are those of the surrounding rayon pool.
#[derive(Clone, Copy)]
pub struct RenderContext<'a> {
    /// Decides all random choices.
    pub seed: u64,
    /// Asked often; once it is set, rendering stops within a fraction of a second.
    pub cancel: &'a CancelToken,
    /// Told how far the work is, from any thread.
    pub progress: &'a (dyn Fn(Progress) + Sync),
}

/// A switch that can be thrown once, from any thread.
#[derive(Clone, Debug, Default)]
pub struct CancelToken(Arc<AtomicBool>);

impl CancelToken {
    /// Asks whoever holds a clone of this token to stop.
    pub fn cancel(&self) {
        self.0.store(true, Ordering::Relaxed);
    }

    /// Whether it was cancelled.
    #[must_use]
    pub fn is_cancelled(&self) -> bool {
        self.0.load(Ordering::Relaxed)
    }
}

/// How far a render is.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Progress {
    /// Samples taken.
    pub done: u64,
    /// Samples there will be.
    pub total: u64,
}

/// How many ray queries a render took.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct RayCounts {
    /// Queries for the nearest surface.
    pub closest: u64,
    /// Queries for what lies between a surface and a light.
    pub shadow: u64,
}

impl RayCounts {
    /// All queries.
    #[must_use]
    pub const fn total(&self) -> u64 {
        self.closest + self.shadow
    }
}

impl AddAssign for RayCounts {
    fn add_assign(&mut self, other: Self) {
        self.closest += other.closest;
        self.shadow += other.shadow;
    }
}

/// Why there is no (whole) picture.
#[derive(Debug, thiserror::Error)]
pub enum RenderError {
    /// Somebody cancelled.
    #[error("rendering was cancelled")]
    Cancelled {
        /// The picture so far, if every pixel already has a sample: a valid picture, only noisier.
        partial: Option<Box<FilmResult>>,
    },
    /// More photons would have to be stored than memory was granted for.
    #[error("{n} photons would have to be stored, more than the {most} there is memory for")]
    TooManyPhotons {
        /// How many there are.
        n: u64,
        /// How many may be.
        most: u64,
    },
    /// More patches than memory was granted for.
    #[error("the surfaces are {n} patches at least, more than the {most} there is memory for")]
    TooManyPatches {
        /// How many there are.
        n: u64,
        /// How many may be.
        most: u64,
    },
    /// Form factors would take more memory than was granted.
    #[error("form factors would take {needed} bytes, more than the {most} there is memory for")]
    TooManyFactors {
        /// Bytes they would take.
        needed: u64,
        /// Bytes they may take.
        most: u64,
    },
}
