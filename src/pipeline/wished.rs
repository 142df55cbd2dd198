//! Taking the picture of a run: as the options say, or with what is [chosen](super::choosing) for a wanted time or error.

use super::choosing::family::{Family, TOP};
use super::choosing::law::{Known, Law, Offer};
use super::choosing::pilot::Pilot;
use super::choosing::{Chooser, Wish, readable, told};
use super::failure::Failure;
use super::making::Making;
use super::report::{Phase, SolutionFacts};
use super::solving::Solved;
use super::spot_check::{SPOTS, samples_of_half};
use super::studio::{Run, Studio};
use super::until::Until;
use super::viewing::{Shot, Viewing};
use crate::camera::Camera;
use crate::integrator::RadianceEstimator;
use crate::options::value::Renderer;
use crate::scene::Scene;
use std::ops::RangeInclusive;
use std::sync::Arc;
use std::time::Duration;

/// Part of the wanted time that is left for the check of the picture.
const PART_OF_CHECK: f64 = 0.04;
/// Samples of each half of a check by the clock.
const SAMPLES_OF_HALF: RangeInclusive<u32> = 16..=512;
/// Part of the time that is left after which light that is not yet solved is given up.
const PART_OF_SOLUTION: f64 = 0.8;
/// Beyond this part of the wanted time people are told.
const KEPT: f64 = 1.1;
/// A rung that leaves more than this part of the bias has gained nothing.
const NO_GAIN: f64 = 0.8;
/// Where bias keeps a wanted error out of reach, noise alone is brought to this part of it.
const NOISE_BESIDE_BIAS: f64 = 0.5;
/// The fewest and the most samples that are taken then.
const SAMPLES_BESIDE_BIAS: RangeInclusive<f64> = 4.0..=4096.0;
/// More seconds than anybody waits, which the clock can still count.
const LONGEST: f64 = 1e9;

/// A picture with what was found out on the way.
pub(super) struct Taken {
    pub(super) shot: Shot,
    pub(super) exposure: f64,
    pub(super) facts: SolutionFacts,
    /// For people: what was chosen, what was missed.
    pub(super) notes: Vec<String>,
}

/// What is looked at.
#[derive(Clone, Copy)]
struct Sight<'s> {
    scene: &'s Arc<Scene>,
    camera: &'s Camera,
}

/// A picture under way.
struct Taking<'t, 'a, 'w, 's> {
    making: Making<'a>,
    studio: &'t mut Studio<'w>,
    run: &'t mut Run,
    sight: Sight<'s>,
}

/// What becomes of an offer once its light is solved.
enum Verdict {
    /// It keeps the wish.
    Kept(Offer),
    /// The rung above may.
    Climb(Offer),
    /// Path tracing does sooner.
    Dropped,
}

impl Making<'_> {
    /// Takes the picture of a run; its options then are those that the picture was made with.
    ///
    /// # Errors
    /// If it was stopped before there was a picture, or anything fails.
    pub(super) fn take(
        &self,
        studio: &mut Studio<'_>,
        run: &mut Run,
        (scene, camera): (&Arc<Scene>, &Camera),
    ) -> Result<Taken, Failure> {
        let wish = Wish::of(&run.options)?;
        let mut taking = Taking {
            making: *self,
            studio,
            run,
            sight: Sight { scene, camera },
        };
        match wish {
            None => taking.as_told(),
            Some(Wish::Seconds(seconds)) => taking.in_time(seconds),
            Some(Wish::Error(error)) => taking.reach_error(error),
        }
    }
}

impl<'s> Taking<'_, '_, '_, 's> {
    /// With the options as they are.
    fn as_told(&mut self) -> Result<Taken, Failure> {
        let solved = self.solve()?;
        let (mut shot, exposure) = self.shoot(&solved, || Until::Samples)?;
        if self.run.options.renderer.value != Renderer::Path && shot.is_whole {
            let n = samples_of_half(shot.effort.n_samples);
            self.check(None, &mut shot, n)?;
        }
        Ok(Taken {
            shot,
            exposure,
            facts: solved.facts,
            notes: Vec::new(),
        })
    }

    /// With what gives the least error in this time.
    fn in_time(&mut self, wanted: f64) -> Result<Taken, Failure> {
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

    /// With what reaches this error soonest.
    fn reach_error(&mut self, wanted: f64) -> Result<Taken, Failure> {
        let chooser = Chooser::new(&self.run.options, Wish::Error(wanted));
        let is_judged = Viewing::is_judged(self.sight.scene);
        let (pilot, mut offer) = self.offer_for_error(&chooser)?;
        let path_samples = pilot.path.samples_for(wanted).filter(|_| is_judged);
        let path_seconds = path_samples.map(|n| pilot.path.seconds(n));
        let is_open = chooser.is_free() && is_judged;
        let mut notes = Vec::new();
        let (shot, exposure, facts) = loop {
            let rest = path_seconds.filter(|_| is_open);
            if let Some((settled, solved)) = self.settle(&chooser, &pilot, offer, rest)? {
                offer = settled;
                let (shot, exposure) = self.shoot_to_error(&chooser, &pilot, offer, &solved)?;
                let missed = shot.effort.error.filter(|error| error.relative > wanted);
                match missed {
                    Some(error) if is_open && offer.family != Family::Path => notes.push(format!(
                        "`{}` seemed to do, but its error is {}: path traced instead",
                        self.run.options.renderer.text,
                        error.text()
                    )),
                    _ => break (shot, exposure, solved.facts),
                }
            }
            offer = chooser.path_offer(&pilot.path);
        };
        let n = shot.effort.samples_per_pixel;
        self.run.options = chooser.with(offer.family, offer.rung, Some(n))?;
        notes.extend(told(self.run));
        if shot.is_whole {
            notes.extend(missed(&shot, wanted, offer.family, path_seconds));
        }
        Ok(Taken {
            shot,
            exposure,
            facts,
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
            let n = samples_of_half(shot.effort.n_samples).max(pilot.samples() / 2);
            self.check(Some(&*pilot.judge), &mut shot, n)?;
        }
        Ok((shot, exposure))
    }

    /// Solves the light of an offer and measures again what comes of it: rung by rung until it keeps the wanted error. `None` if path tracing,
    /// in so many seconds, is the better way.
    fn settle(
        &mut self,
        chooser: &Chooser,
        pilot: &Pilot<'_>,
        offer: Offer,
        path_seconds: Option<f64>,
    ) -> Result<Option<(Offer, Solved)>, Failure> {
        let world = self.making.world;
        let mut offer = offer;
        let mut before: Option<Law> = None;
        let mut is_last = false;
        loop {
            self.run.options = chooser.with(offer.family, offer.rung, Some(offer.samples))?;
            let begin = world.now();
            let solved = match self.solve() {
                Ok(solved) => solved,
                // More memory than there is: the rung below fitted.
                Err(Failure::World(_)) if before.is_some() && !is_last => {
                    (offer.rung, is_last) = (offer.rung - 1, true);
                    continue;
                }
                Err(Failure::World(_)) if path_seconds.is_some() => return Ok(None),
                Err(failure) => return Err(failure),
            };
            if !offer.family.has_rungs() || !Viewing::is_judged(self.sight.scene) {
                return Ok(Some((offer, solved)));
            }
            let shared = world.now().saturating_sub(begin).as_secs_f64();
            let law = self.measure(pilot, &solved, shared)?;
            match verdict(chooser, offer, law, before, (path_seconds, is_last)) {
                Verdict::Dropped => return Ok(None),
                Verdict::Climb(above) => (offer, before) = (above, Some(law)),
                Verdict::Kept(kept) => {
                    let n = Some(kept.samples);
                    self.run.options = chooser.with(kept.family, kept.rung, n)?;
                    return Ok(Some((kept, solved)));
                }
            }
        }
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

    /// The light that all views share.
    fn solve(&mut self) -> Result<Solved, Failure> {
        self.making.audience.begins("preparing");
        let viewing = self.making.viewing(self.run);
        self.studio.solve(self.run, self.sight.scene, &viewing)
    }

    /// Exposes and takes the picture; `until` is asked last.
    fn shoot(
        &mut self,
        solved: &Solved,
        until: impl FnOnce() -> Until,
    ) -> Result<(Shot, f64), Failure> {
        let Sight { scene, camera } = self.sight;
        let world = self.making.world;
        let viewing = self.making.viewing(self.run);
        let seconds = &mut self.studio.seconds;
        let (prepared, exposure) = seconds.time(world, Phase::Prepare, || {
            let prepared = viewing.prepare(scene, &solved.solution)?;
            let exposure = viewing.exposure(scene, &prepared, camera)?;
            Ok::<_, Failure>((prepared, exposure))
        })?;
        self.making.audience.begins("rendering");
        self.studio.work.views += 1;
        let shot = seconds.time(world, Phase::Render, || {
            viewing.take(&prepared, camera, until(), &mut |_| {})
        })?;
        Ok((shot, exposure))
    }

    /// Finds out how wrong a picture is, by a method that is wrong in other ways. Stopped meanwhile, the picture is as good as it was;
    /// only how good is not known.
    fn check(
        &mut self,
        judge: Option<&dyn RadianceEstimator>,
        shot: &mut Shot,
        samples_of_half: u32,
    ) -> Result<(), Failure> {
        let Sight { scene, camera } = self.sight;
        shot.effort.error = None;
        if !Viewing::is_judged(scene) {
            return Ok(());
        }
        self.making.audience.begins("checking");
        let viewing = self.making.viewing(self.run);
        let check = || match judge {
            Some(judge) => viewing.spot_check(judge, camera, shot, samples_of_half),
            None => {
                let judge = viewing.judge(scene)?;
                viewing.spot_check(&*judge, camera, shot, samples_of_half)
            }
        };
        let world = self.making.world;
        match self.studio.seconds.time(world, Phase::Check, check) {
            Ok(error) => shot.effort.error = Some(error),
            Err(Failure::Stopped) => {}
            Err(failure) => return Err(failure),
        }
        Ok(())
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

/// Whether an offer whose light was measured keeps the wanted error, and what to do if it does not.
fn verdict(
    chooser: &Chooser,
    offer: Offer,
    law: Law,
    before: Option<Law>,
    (path_seconds, is_last): (Option<f64>, bool),
) -> Verdict {
    let Wish::Error(wanted) = chooser.wish else {
        return Verdict::Kept(offer);
    };
    let with = |n: u32| {
        let samples = chooser.samples.unwrap_or(n);
        Verdict::Kept(Offer {
            samples,
            error: law.error(samples),
            ..offer
        })
    };
    if let Some(n) = law.samples_for(wanted) {
        let n = n.max(4).next_multiple_of(2);
        // What is solved is solved.
        let left = law.seconds(n) - law.shared;
        return match path_seconds {
            Some(path) if left > path => Verdict::Dropped,
            _ => with(n),
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
    with((n as u32).next_multiple_of(2))
}

/// What people are told of a picture that is more wrong than they want, and what would not be.
fn missed(shot: &Shot, most: f64, family: Family, path_seconds: Option<f64>) -> Option<String> {
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
