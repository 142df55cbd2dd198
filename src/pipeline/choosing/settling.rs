//! From an offer to light that keeps its promise: what a pilot expects of a method is measured again once the light is solved.

use super::family::TOP;
use super::law::{Law, Offer};
use super::{Chooser, Wish};
use crate::pipeline::failure::Failure;
use std::ops::RangeInclusive;

/// A rung that leaves more than this part of the bias has gained nothing.
const NO_GAIN: f64 = 0.8;
/// Where bias keeps a wanted error out of reach, noise alone is brought to this part of it.
const NOISE_BESIDE_BIAS: f64 = 0.5;
/// The fewest and the most samples that are taken then.
const SAMPLES_BESIDE_BIAS: RangeInclusive<f64> = 4.0..=4096.0;

/// What becomes of an offer once its light is solved.
enum Verdict {
    /// It keeps the wish.
    Kept(Offer),
    /// The rung above may.
    Climb(Offer),
    /// Path tracing does sooner.
    Dropped,
}

/// Solves the light of an offer and measures again what comes of it: with a wanted error rung by rung until it is kept, `None` if path tracing,
/// in so many seconds, is the better way; with a wanted time, only the number of samples changes.
///
/// `solve` solves the light of an offer and measures its law; without a law there is nothing to go by, and the offer stands.
///
/// # Errors
/// Those of `solve`; more memory than there is only on the first rung, and where path tracing is no way.
pub fn settle<T>(
    chooser: &Chooser,
    offer: Offer,
    path_seconds: Option<f64>,
    mut solve: impl FnMut(&Offer) -> Result<(T, Option<Law>), Failure>,
) -> Result<Option<(Offer, T)>, Failure> {
    let mut offer = offer;
    let mut before: Option<Law> = None;
    let mut is_last = false;
    loop {
        let (solved, law) = match solve(&offer) {
            Ok((solved, Some(law))) => (solved, law),
            Ok((solved, None)) => return Ok(Some((offer, solved))),
            // More memory than there is: the rung below fitted.
            Err(Failure::World(_)) if before.is_some() && !is_last => {
                (offer.rung, is_last) = (offer.rung - 1, true);
                continue;
            }
            Err(Failure::World(_)) if path_seconds.is_some() => return Ok(None),
            Err(failure) => return Err(failure),
        };
        match verdict(chooser, offer, law, before, (path_seconds, is_last)) {
            Verdict::Dropped => return Ok(None),
            Verdict::Climb(above) => (offer, before) = (above, Some(law)),
            Verdict::Kept(kept) => return Ok(Some((kept, solved))),
        }
    }
}

/// Whether an offer whose light was measured keeps the wanted error, and what to do if it does not.
fn verdict(
    chooser: &Chooser,
    offer: Offer,
    law: Law,
    before: Option<Law>,
    (path_seconds, is_last): (Option<f64>, bool),
) -> Verdict {
    let with = |n: u32, part: f64| {
        let samples = chooser.samples.unwrap_or(n);
        Verdict::Kept(Offer {
            samples,
            part_of_sample: if chooser.samples.is_none() { part } else { 0.0 },
            error: law.error(samples),
            ..offer
        })
    };
    let wanted = match chooser.wish {
        Wish::Error(wanted) => wanted,
        Wish::Seconds(seconds) => {
            let room = law.room_within(seconds).max(1.0);
            return with(room as u32, room.fract());
        }
    };
    if let Some(n) = law.samples_for(wanted) {
        let n = n.max(4).next_multiple_of(2);
        // What is solved is solved.
        let left = law.seconds(n) - law.shared;
        return match path_seconds {
            Some(path) if left > path => Verdict::Dropped,
            _ => with(n, 0.0),
        };
    }
    let above = law.climbed(offer.family, 1);
    let is_sooner = path_seconds.is_none_or(|path| above.seconds(4) < path);
    let has_gained = before.is_none_or(|before| law.bias < NO_GAIN * before.bias);
    if is_sooner && has_gained && offer.rung < TOP && !is_last {
        return Verdict::Climb(Offer {
            rung: offer.rung + 1,
            ..offer
        });
    }
    if path_seconds.is_some() {
        return Verdict::Dropped;
    }
    let n = law.noise / (NOISE_BESIDE_BIAS * wanted).powi(2);
    let n = n.clamp(*SAMPLES_BESIDE_BIAS.start(), *SAMPLES_BESIDE_BIAS.end());
    with((n as u32).next_multiple_of(2), 0.0)
}
