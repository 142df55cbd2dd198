//! Light whose exact value is known on paper, measured with the queries and estimators that make the pictures.
//!
//! Each [`Check`] has a closed form and a way to measure the same number: a small scene that the path tracer looks at, or,
//! where nothing is left to chance, a single question. `understory validate` prints them all; the tests demand that all hold.
//!
//! ```text
//! check       a check and what came of it      verdict     when a mean agrees with the truth
//! probe       looking at a small scene         room        building one
//! table       the published numbers            tables/     their files
//! worlds      what rays are tried in
//! factors     configuration factors            lamps       sources without and with extent
//! skies       sky, sun, panorama               boundaries  glass
//! enclosures  closed rooms, stacks of leaves   surfaces    white furnaces
//! extremes    what must hold at the ends of all scales
//! ```
//!
//! # What a figure means
//! A mean is judged by its own standard error, such that a right program fails any of all the checks with probability
//! [`FALSE_ALARM`](verdict::FALSE_ALARM), and it counts only if a fault of 2 % of the value (5 or 10 % for rays that seldom meet
//! what shines, and in the whitest rooms) could not have hidden in the noise. Random numbers depend on the seed and the check's id alone, so a verdict is reproducible.

mod boundaries;
mod check;
mod enclosures;
pub mod extremes;
mod factors;
mod lamps;
pub mod probe;
pub mod room;
mod skies;
mod surfaces;
mod table;
pub mod verdict;
pub mod worlds;

pub use check::{Check, Finding};

use crate::integrator::CancelToken;
use rayon::prelude::*;
use std::sync::atomic::{AtomicU64, Ordering};

/// All checks, in the order in which they are told.
#[must_use]
pub fn all() -> Vec<Check> {
    let mut checks = Vec::new();
    checks.extend(factors::checks());
    checks.extend(lamps::checks());
    checks.extend(skies::checks());
    checks.extend(boundaries::checks());
    checks.extend(surfaces::checks());
    checks.extend(enclosures::checks());
    checks
}

/// Makes the checks, in parallel; what is found stands in their order and does not depend on the number of threads.
///
/// `None` if it was cancelled. `progress` is told, from any thread, how many are done.
#[must_use]
pub fn run(
    checks: &[Check],
    seed: u64,
    cancel: &CancelToken,
    progress: &(dyn Fn(u64) + Sync),
) -> Option<Vec<Finding>> {
    let n_means = checks.iter().filter(|check| check.is_mean()).count();
    let family = verdict::Family::of(n_means);
    let done = AtomicU64::new(0);
    let findings = checks.par_iter().map(|check| {
        let finding = check.make(seed, family, cancel)?;
        progress(done.fetch_add(1, Ordering::Relaxed) + 1);
        Some(finding)
    });
    findings.collect()
}
