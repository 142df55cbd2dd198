//! The picture with the least error in a wanted time.

use super::{Sight, Taken, Taking};
use crate::pipeline::choosing::family::Family;
use crate::pipeline::choosing::law::{Known, Law, Offer};
use crate::pipeline::choosing::pilot::Pilot;
use crate::pipeline::choosing::{Chooser, Wish, readable, told};
use crate::pipeline::failure::Failure;
use crate::pipeline::report::Phase;
use crate::pipeline::solving::Solved;
use crate::pipeline::spot_check::SPOTS;
use crate::pipeline::until::Until;
use crate::pipeline::viewing::Viewing;
use std::ops::RangeInclusive;
use std::time::Duration;

/// Part of the wanted time that is left for the check of the picture.
const PART_OF_CHECK: f64 = 0.04;
/// Samples of each half of a check by the clock.
const SAMPLES_OF_HALF: RangeInclusive<u32> = 16..=512;
/// Part of the time that is left after which light that is not yet solved is given up.
const PART_OF_SOLUTION: f64 = 0.8;
/// Beyond this part of the wanted time people are told.
const KEPT: f64 = 1.1;
/// More seconds than anybody waits, which the clock can still count.
const LONGEST: f64 = 1e9;

impl<'s> Taking<'_, '_, '_, 's> {
    /// With what gives the least error in this time.
    pub(super) fn in_time(&mut self, wanted: f64) -> Result<Taken, Failure> {
        let world = self.making.world;
        let begin = world.now();
        let passed = || world.now().saturating_sub(begin).as_secs_f64();
        let chooser = Chooser::new(&self.run.options, Wish::Seconds(wanted));
        let (pilot, offer) = self.offer_in_time(&chooser, wanted, &passed)?;
        let (offer, solved) = self.solve_in_time(&chooser, offer, wanted - passed())?;
        let is_checked = offer.family != Family::Path;
        let (n_half, reserve) = check_in_time(pilot.as_ref().filter(|_| is_checked), wanted);
        let until = || match chooser.samples {
            Some(_) => Until::Samples,
            None => {
                let left = (wanted - passed() - reserve).clamp(0.0, LONGEST);
                Until::Time(Duration::from_secs_f64(left))
            }
        };
        self.warn(&solved);
        let (mut shot, exposure) = self.shoot(&solved, until)?;
        if is_checked && shot.is_whole {
            let judge = pilot.as_ref().map(|pilot| &*pilot.judge);
            self.check(judge, &mut shot, n_half)?;
        }
        let n = shot.effort.samples_per_pixel;
        self.run.options = chooser.with(offer.family, offer.rung, Some(n))?;
        let mut notes: Vec<String> = told(self.run).into_iter().collect();
        let took = passed();
        if took > KEPT * wanted && shot.is_whole {
            let (took, wanted) = (readable(took), readable(wanted));
            notes.push(format!(
                "the light took {took}, not the {wanted} that `time` wants: each pixel needs a sample, and the exposure a small picture"
            ));
        }
        Ok(Taken {
            shot,
            exposure,
            facts: solved.facts,
            notes,
        })
    }

    /// What gives the least error in the time that is left, and the pilot that says so.
    fn offer_in_time(
        &mut self,
        chooser: &Chooser,
        wanted: f64,
        passed: &dyn Fn() -> f64,
    ) -> Result<(Option<Pilot<'s>>, Offer), Failure> {
        if chooser.is_hasty() {
            return Ok((None, chooser.last_resort(&[], true)));
        }
        let Sight { scene, camera } = self.sight;
        let is_judged = Viewing::is_judged(scene);
        self.making.audience.begins("measuring");
        let viewing = self.making.viewing(self.run);
        let world = self.making.world;
        self.studio.seconds.time(world, Phase::Prepare, || {
            let pilot = Pilot::new(&viewing, scene, camera, chooser.wish)?;
            let is_scarce = pilot.path.samples_within(wanted - passed()) < 2;
            let known = if is_scarce && chooser.is_free() {
                Vec::new()
            } else {
                chooser.explore(&viewing, (scene, camera), &pilot)?
            };
            let left = wanted * (1.0 - PART_OF_CHECK) - passed();
            let offer = chooser.best(&known, left);
            let offer = offer.unwrap_or_else(|| chooser.last_resort(&known, is_judged));
            Ok((Some(pilot), offer))
        })
    }

    /// Solves the light of an offer, unless that takes longer than expected: then path tracing, which has none to solve, takes its place.
    fn solve_in_time(
        &mut self,
        chooser: &Chooser,
        offer: Offer,
        left: f64,
    ) -> Result<(Offer, Solved), Failure> {
        self.run.options = chooser.with(offer.family, offer.rung, Some(offer.samples))?;
        if offer.family == Family::Path || !chooser.is_free() {
            return Ok((offer, self.solve()?));
        }
        let limit = Duration::from_secs_f64((PART_OF_SOLUTION * left).clamp(0.0, LONGEST));
        self.making.audience.begins("preparing");
        let viewing = self.making.viewing(self.run);
        let (studio, run, scene) = (&mut *self.studio, &*self.run, self.sight.scene);
        if let Some(solved) = viewing.within(limit, |v| studio.solve(run, scene, v))? {
            return Ok((offer, solved));
        }
        let path = Known {
            family: Family::Path,
            rung: 0,
            law: Law::default(),
        };
        self.run.options = chooser.with(Family::Path, 0, Some(1))?;
        Ok((path.offer(1), self.solve()?))
    }
}

/// Samples of each half of a check, as many as a part of the wanted time allows, and the seconds that they take; for what is not checked,
/// none.
fn check_in_time(pilot: Option<&Pilot<'_>>, wanted: f64) -> (u32, f64) {
    let Some(pilot) = pilot else {
        return (*SAMPLES_OF_HALF.start(), 0.0);
    };
    let of_one = f64::from(2 * SPOTS) * pilot.seconds_of_sample;
    // Saturates.
    let n = (PART_OF_CHECK * wanted / of_one) as u32;
    let n = 1
        << n.clamp(*SAMPLES_OF_HALF.start(), *SAMPLES_OF_HALF.end())
            .ilog2();
    (n, f64::from(n) * of_one)
}
