//! The picture that has a wanted error soonest.

use super::{Sight, Taken, Taking};
use crate::pipeline::choosing::family::Family;
use crate::pipeline::choosing::law::{Law, Offer};
use crate::pipeline::choosing::pilot::Pilot;
use crate::pipeline::choosing::settling::settle;
use crate::pipeline::choosing::{Chooser, Wish, readable, told};
use crate::pipeline::failure::Failure;
use crate::pipeline::report::{Phase, PictureError};
use crate::pipeline::solving::Solved;
use crate::pipeline::spot_check::samples_of_half;
use crate::pipeline::until::Until;
use crate::pipeline::viewing::{Shot, Viewing};

/// A picture that misses the wanted error is made again so many times by the same method: what misses by little is brought there sooner
/// than by another.
const AGAIN: u32 = 2;
/// It then aims at this part of what it aimed at, times the wanted error over that of the picture.
const BELOW: f64 = 0.9;

/// A check that could as well find so many times the wanted error is made again with so many times the samples, up to this number.
const FAR_LARGER: f64 = 1.5;
const CHECK_AGAIN: u32 = 4;
const MOST_SAMPLES_OF_HALF: u32 = 1 << 14;

/// What error is aimed at, so that the wanted one is kept.
#[derive(Clone, Copy, Debug, PartialEq)]
struct Aim {
    wanted: f64,
    error: f64,
    n_again: u32,
}

impl Aim {
    fn new(wanted: f64) -> Self {
        Self {
            wanted,
            error: wanted,
            n_again: 0,
        }
    }

    /// What to aim at once a picture with more than the wanted error was made; `None` if the method does not do.
    fn lower(self, seen: &PictureError, offer: Offer) -> Option<Self> {
        let is_hopeful = offer.error <= self.error && self.n_again < AGAIN;
        is_hopeful.then(|| Self {
            error: BELOW * self.error * self.wanted / seen.relative,
            n_again: self.n_again + 1,
            ..self
        })
    }
}

impl<'s> Taking<'_, '_, '_, 's> {
    /// With what reaches this error soonest.
    pub(super) fn reach_error(&mut self, wanted: f64) -> Result<Taken, Failure> {
        let chooser = Chooser::new(&self.run.options, Wish::Error(wanted));
        let is_judged = Viewing::is_judged(self.sight.scene);
        let (pilot, mut offer) = self.offer_for_error(&chooser)?;
        let path_samples = pilot.path.samples_for(wanted).filter(|_| is_judged);
        let path_seconds = path_samples.map(|n| pilot.path.seconds(n));
        let is_open = chooser.is_free() && is_judged;
        let mut notes = Vec::new();
        let mut aim = Aim::new(wanted);
        let (shot, exposure, solved) = loop {
            let rest = path_seconds.filter(|_| is_open);
            let settled = self.settle(
                &chooser.wishing(Wish::Error(aim.error)),
                &pilot,
                offer,
                rest,
            )?;
            let Some((settled, solved)) = settled else {
                offer = chooser.path_offer(&pilot.path);
                continue;
            };
            offer = settled;
            let (shot, exposure) = self.shoot_to_error(&chooser, &pilot, offer, &solved)?;
            let missed = shot.effort.error.filter(|error| error.relative > wanted);
            let missed = missed.filter(|_| offer.family != Family::Path);
            let next = missed.and_then(|error| aim.lower(&error, offer));
            let instead = match (missed, next) {
                (Some(_), Some(_)) => "more is taken of it",
                (Some(_), None) if is_open => "path traced instead",
                _ => break (shot, exposure, solved),
            };
            let error = missed.map(|error| error.text()).unwrap_or_default();
            let name = &self.run.options.renderer.text;
            notes.push(format!(
                "`{name}` seemed to do, but its error is {error}: {instead}"
            ));
            match next {
                Some(next) => aim = next,
                None => offer = chooser.path_offer(&pilot.path),
            }
        };
        self.warn(&solved);
        let n = shot.effort.samples_per_pixel;
        self.run.options = chooser.with(offer.family, offer.rung, Some(n))?;
        notes.extend(told(self.run));
        if shot.is_whole {
            notes.extend(unreached(&shot, wanted, offer.family, path_seconds));
        }
        Ok(Taken {
            shot,
            exposure,
            facts: solved.facts,
            notes,
        })
    }

    /// What is expected to reach the wanted error soonest, and the pilot that says so.
    fn offer_for_error(&mut self, chooser: &Chooser) -> Result<(Pilot<'s>, Offer), Failure> {
        let Sight { scene, camera } = self.sight;
        self.making.audience.begins("measuring");
        let viewing = self.making.viewing(self.run);
        let world = self.making.world;
        self.studio.seconds.time(world, Phase::Prepare, || {
            let pilot = Pilot::new(&viewing, scene, camera, chooser.wish)?;
            let known = chooser.explore(&viewing, (scene, camera), &pilot)?;
            let offer = chooser.best(&known, f64::INFINITY);
            let is_judged = Viewing::is_judged(scene);
            let offer = offer.unwrap_or_else(|| chooser.last_resort(&known, is_judged));
            Ok((pilot, offer))
        })
    }

    /// Takes the picture of an offer, and checks it unless its own halves tell all.
    fn shoot_to_error(
        &mut self,
        chooser: &Chooser,
        pilot: &Pilot<'_>,
        offer: Offer,
        solved: &Solved,
    ) -> Result<(Shot, f64), Failure> {
        let until = match (offer.family, chooser.samples, chooser.wish) {
            (Family::Path, None, Wish::Error(most)) => Until::Error {
                most,
                expected: offer.samples,
            },
            _ => Until::Samples,
        };
        let (mut shot, exposure) = self.shoot(solved, || until)?;
        if offer.family != Family::Path && shot.is_whole {
            let mut n = samples_of_half(shot.effort.n_samples).max(pilot.samples() / 2);
            self.check(Some(&*pilot.judge), &mut shot, n)?;
            while is_unsure(shot.effort.error, chooser.wish) && n < MOST_SAMPLES_OF_HALF {
                n *= CHECK_AGAIN;
                self.check(Some(&*pilot.judge), &mut shot, n)?;
            }
        }
        Ok((shot, exposure))
    }

    /// Solves the light of an offer, or of one that keeps the wanted error once its light was measured. `None` if path tracing, in so many
    /// seconds, is the better way.
    fn settle(
        &mut self,
        chooser: &Chooser,
        pilot: &Pilot<'_>,
        offer: Offer,
        path_seconds: Option<f64>,
    ) -> Result<Option<(Offer, Solved)>, Failure> {
        let world = self.making.world;
        let is_judged = Viewing::is_judged(self.sight.scene);
        let settled = settle(chooser, offer, path_seconds, |offer| {
            self.run.options = chooser.with(offer.family, offer.rung, Some(offer.samples))?;
            let begin = world.now();
            let solved = self.solve()?;
            let shared = world.now().saturating_sub(begin).as_secs_f64();
            let law = if is_judged && offer.family.has_rungs() {
                Some(self.measure(pilot, &solved, shared)?)
            } else {
                None
            };
            Ok((solved, law))
        })?;
        if let Some((kept, _)) = &settled {
            self.run.options = chooser.with(kept.family, kept.rung, Some(kept.samples))?;
        }
        Ok(settled)
    }

    /// What the picture costs and how wrong it will be, with light that is solved.
    fn measure(&mut self, pilot: &Pilot<'_>, solved: &Solved, shared: f64) -> Result<Law, Failure> {
        self.making.audience.begins("measuring");
        let viewing = self.making.viewing(self.run);
        let world = self.making.world;
        let sight = (&**self.sight.scene, self.sight.camera);
        let measure = || pilot.measure(&viewing, sight, (&solved.solution, shared));
        self.studio.seconds.time(world, Phase::Prepare, measure)
    }
}

/// Whether a check finds the wanted error kept but cannot rule out that it is far larger.
fn is_unsure(error: Option<PictureError>, wish: Wish) -> bool {
    let Wish::Error(wanted) = wish else {
        return false;
    };
    error.is_some_and(|error| error.relative <= wanted && error.high > FAR_LARGER * wanted)
}

/// What people are told of a picture that is more wrong than they want, and what would not be.
fn unreached(shot: &Shot, most: f64, family: Family, path_seconds: Option<f64>) -> Option<String> {
    let wanted = format!("{:.1} %", 100.0 * most);
    let Some(error) = &shot.effort.error else {
        return Some(format!(
            "whether the error is at most {wanted} is not known: light is focused here that path tracing does not find"
        ));
    };
    if error.relative <= most {
        return None;
    }
    let instead = match (family, path_seconds) {
        (Family::Path, _) => "without `--samples` there would be as many as it takes".to_owned(),
        (_, Some(seconds)) => format!(
            "`--renderer path` would reach it in about {}",
            readable(seconds)
        ),
        (_, None) => "`--renderer path` would come nearer to it".to_owned(),
    };
    let is_sure = error.low > most;
    let verb = if is_sure { "is" } else { "may be" };
    Some(format!(
        "the error {verb} more than the wanted {wanted}: {instead}"
    ))
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::pipeline::report::Covers;

    #[test]
    fn a_check_is_unsure_that_finds_an_error_kept_but_may_be_far_off() {
        let error = |relative, high| {
            Some(PictureError {
                relative,
                low: 0.0,
                high,
                covers: Covers::NoiseAndBias,
            })
        };
        let wish = Wish::Error(0.02);
        assert!(is_unsure(error(0.0, 0.3), wish) && is_unsure(error(0.018, 0.035), wish));
        assert!(!is_unsure(error(0.018, 0.022), wish), "it is known");
        assert!(!is_unsure(error(0.05, 0.3), wish), "it is missed");
        assert!(!is_unsure(None, wish) && !is_unsure(error(0.0, 0.3), Wish::Seconds(1.0)));
    }

    /// A picture that misses by a quarter is made again, aiming lower each time, but not for ever, and not where nothing lower was promised.
    #[test]
    fn what_misses_by_little_is_tried_again_and_not_for_ever() {
        let seen = PictureError {
            relative: 0.025,
            low: 0.02,
            high: 0.03,
            covers: Covers::NoiseAndBias,
        };
        let offer = |error: f64| Offer {
            family: Family::PhotonMap,
            rung: 2,
            samples: 8,
            part_of_sample: 0.0,
            seconds: 1.0,
            error,
        };
        let first = Aim::new(0.02).lower(&seen, offer(0.018)).unwrap();
        assert!((first.error - 0.0144).abs() < 1e-12, "{first:?}");
        let second = first.lower(&seen, offer(0.013)).unwrap();
        assert!(second.error < first.error);
        assert_eq!(second.lower(&seen, offer(0.009)), None);
        assert_eq!(Aim::new(0.02).lower(&seen, offer(0.03)), None);
    }
}
