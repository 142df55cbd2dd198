//! Gathering: each patch in turn collects what all others send, again and again.
//!
//! Gauss and Seidel's method, which counts a patch's new light at once. Its error falls with each sweep at least by the largest
//! reflectance ([`CohenWallace1993`, §5.3](crate::references#cohenwallace1993)). In white rooms that is slow, and changes soon shrink
//! by the same factor each time: now and then all that is still to come is then added at once, as a geometric series. That factor,
//! not the whitest surface, also tells how much is still to come: a single white patch would let it go on without end.

use super::system::{Patch, Row, Solved, first_sent, power, sent, whitest};
use crate::color::Rgb;

/// Sweeps after which no end is in sight.
const MOST_SWEEPS: u32 = 5000;

/// Sweeps from one sum of the series to the next, and by how much, as a part of 1 - ratio, successive ratios may differ then.
const STRIDE: u32 = 10;
const STEADY: f64 = 0.1;

/// Solves until a sweep changes so little that less than the part `tolerance` of all light is still to come; `go_on` is told that
/// part after each sweep and says whether to go on.
pub(super) fn solve(
    patches: &[Patch],
    rows: &[Row],
    tolerance: f64,
    mut go_on: impl FnMut(f64) -> bool,
) -> Solved {
    let mut solved = Solved {
        irradiance: vec![Rgb::BLACK; rows.len()],
        radiosity: first_sent(patches),
        residual: 0.0,
        is_converged: power(patches, &first_sent(patches)) == 0.0,
    };
    let whitest = whitest(patches);
    let (mut before, mut last_ratio, mut summed_ratio) = (0.0, 0.0, 0.0_f64);
    for nth in 1..=MOST_SWEEPS {
        if solved.is_converged {
            break;
        }
        let old = if nth.is_multiple_of(STRIDE) {
            solved.radiosity.clone()
        } else {
            Vec::new()
        };
        let change = sweep(patches, rows, &mut solved);
        let ratio = if before > 0.0 {
            change / before
        } else {
            whitest
        };
        let is_steady = (ratio - last_ratio).abs() < STEADY * (1.0 - ratio);
        // What a sweep changes is followed by changes that get smaller by this factor each time, at most that of the whitest surface.
        // A sweep after a sum of the series seems better than those that follow.
        let slowest = ratio.max(last_ratio).max(summed_ratio).min(whitest);
        (before, last_ratio) = (change, ratio);
        let all = power(patches, &solved.radiosity);
        let to_come = if slowest < 1.0 {
            change * slowest / (1.0 - slowest)
        } else {
            all
        };
        solved.residual = to_come.min(all) / all;
        solved.is_converged = change == 0.0 || solved.residual <= tolerance;
        if !go_on(solved.residual) {
            break;
        }
        if is_steady && !old.is_empty() && !solved.is_converged {
            summed_ratio = ratio;
            for (now, old) in solved.radiosity.iter_mut().zip(old) {
                let next = *now + (*now - old) * (ratio / (1.0 - ratio));
                *now = next.map(|c| c.max(0.0));
            }
        }
    }
    solved
}

/// Gathers once for each side; gives by how much power the patches' light has changed.
fn sweep(patches: &[Patch], rows: &[Row], solved: &mut Solved) -> f64 {
    let mut change = 0.0;
    for (side, row) in rows.iter().enumerate() {
        let patch = &patches[side / 2];
        if !patch.sides[side % 2].is_needed() {
            continue;
        }
        solved.irradiance[side] = row.gather(&solved.radiosity);
        for to in [side, side ^ 1] {
            let total = |at: usize| patch.sides[at % 2].source + solved.irradiance[at];
            let now = sent(patches, to, total);
            change += patch.weight * (now - solved.radiosity[to]).map(f64::abs).sum();
            solved.radiosity[to] = now;
        }
    }
    change
}
