//! Renderer and settings for a wanted time (`--time`) or a wanted error (`--error`), chosen on the user's own picture.
//!
//! A [pilot] path traces a thousand pixels of the picture. That tells how long path tracing takes, and it is the truth by which
//! the other methods are judged on the same pixels, each on a low rung of its [ladder](family). A [law] for each method carries what
//! was measured to more samples and higher rungs; the best offer is taken. Light that all views share is measured again, on those pixels,
//! once it is solved, before the picture is made of it; and the picture is checked on pixels that nothing was chosen by.
//!
//! # What is kept
//! A setting that the user names as expressly as the wish, or more, stays: a flag always, a line of the file beside the model unless the
//! wish is a flag. The same rule decides between `--samples` and a grid in that file.
//!
//! # What depends on the clock
//! Which method is chosen. With `--error` the picture itself does not: path tracing stops at the first pass whose own halves tell that it is
//! good enough, other methods have settings that the error decides. The chosen settings make the same picture again.

pub mod family;
pub mod law;
pub mod pilot;
pub mod settling;

use super::failure::Failure;
use super::studio::Run;
use super::viewing::Viewing;
use super::world::World;
use crate::camera::Camera;
use crate::integrator::Solution;
use crate::options::value::Renderer;
use crate::options::{Options, Origin, Stage};
use crate::scene::Scene;
use family::Family;
use law::{Known, Law, Offer};
use pilot::Pilot;
use std::time::Duration;

/// A path-traced picture that is good enough in so many seconds needs no other method.
const SOON: f64 = 3.0;
/// Part of the wanted time that one step of trying a method may take, and all of them together. Were path tracing best, a sixth of its time
/// is lost, a twelfth of its error; a method that is not tried because of less may be worth a quarter of the error.
const PART_OF_TRIAL: f64 = 0.08;
const PART_OF_TRIALS: f64 = 0.16;
/// Part of the time of path tracing to a wanted error that a step may take.
const PART_OF_PATH: f64 = 0.03;
/// Seconds that a step may take in any case, if all may.
const SHORT_TRIAL: f64 = 0.25;
/// More seconds than anybody lets a trial take.
const LONGEST_TRIAL: f64 = 1e6;
/// Another method is taken for a wanted error if it promises it in this part of the time of path tracing: that keeps its promise.
const CLEARLY_SOONER: f64 = 0.7;
/// Less time than this is not spent on trials.
const TOO_SHORT: f64 = 0.5;
/// What a sample costs may be off by this part.
const CAUTION: f64 = 0.9;
/// Rung on which a named renderer begins where there is nothing to judge it by.
const BLIND_RUNG: u32 = 3;

/// What the user wants of a picture besides what it shows.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Wish {
    /// That its light takes so many seconds.
    Seconds(f64),
    /// That its relative error is at most so much.
    Error(f64),
}

impl Wish {
    /// The wish that the options hold, if any.
    ///
    /// # Errors
    /// If they hold two.
    pub fn of(options: &Options) -> Result<Option<Self>, Failure> {
        match (options.time.value, options.error.value) {
            (None, None) => Ok(None),
            (Some(seconds), None) => Ok(Some(Self::Seconds(seconds.0))),
            (None, Some(error)) => Ok(Some(Self::Error(error.0))),
            (Some(_), Some(_)) => Err(Failure::Usage(
                "`time` and `error` are two wishes that exclude each other: give one of them"
                    .into(),
            )),
        }
    }

    /// Refuses what cannot be chosen, before the model is grown.
    ///
    /// # Errors
    /// Two wishes; a wish and a file of light that was or is to be solved with settings of the user.
    pub fn check(options: &Options, has_files: bool) -> Result<(), Failure> {
        match Self::of(options)? {
            Some(_) if has_files => Err(Failure::Usage(
                "`--solution` and `--save-solution` are for light with settings that you name; `time` and `error` choose them: \
                 leave one of the two out"
                    .into(),
            )),
            _ => Ok(()),
        }
    }
}

/// Chooses for one run.
pub struct Chooser {
    /// The options as the user gave them.
    base: Options,
    /// What is wanted.
    pub wish: Wish,
    /// How strong a choice is.
    origin: Origin,
    /// Samples per pixel, if the user has named them.
    pub samples: Option<u32>,
}

impl Chooser {
    /// For a run with these options.
    #[must_use]
    pub fn new(options: &Options, wish: Wish) -> Self {
        let wished = match wish {
            Wish::Seconds(_) => options.time.origin,
            Wish::Error(_) => options.error.origin,
        };
        let origin = Origin::Chosen {
            over_file: wished == Origin::Flag,
        };
        let is_named = |of: Origin| of.beats(origin);
        let samples = is_named(options.samples.origin).then(|| options.samples.value.get());
        let grid = options.supersampling.value;
        let grid = grid.filter(|_| is_named(options.supersampling.origin));
        Self {
            base: options.clone(),
            wish,
            origin,
            samples: samples.or(grid.map(|grid| grid.samples().get())),
        }
    }

    /// The same for another wish.
    #[must_use]
    pub fn wishing(&self, wish: Wish) -> Self {
        Self {
            wish,
            base: self.base.clone(),
            ..*self
        }
    }

    /// The methods that are open.
    #[must_use]
    pub fn families(&self, is_judged: bool) -> Vec<Family> {
        let options = &self.base;
        let named = options.renderer.origin.beats(self.origin);
        let rays = &options.final_gather;
        let rays_named = rays.value.0.filter(|_| rays.origin.beats(self.origin));
        let gathers = rays_named.map(|n| n > 0);
        let is_open = |family: &Family| {
            let renderer = family.renderer();
            let is_right = !named || renderer == options.renderer.value;
            // Without a judge only photon mapping finds all light.
            let finds_all = named || is_judged || renderer == Renderer::Photon;
            let gathers_right = match family {
                Family::PhotonMap => gathers != Some(true),
                Family::PhotonGather => gathers != Some(false),
                Family::Path | Family::Raytracer | Family::Radiosity => true,
            };
            is_right && finds_all && gathers_right
        };
        Family::ALL.into_iter().filter(is_open).collect()
    }

    /// Whether the renderer may be chosen.
    #[must_use]
    pub fn is_free(&self) -> bool {
        !self.base.renderer.origin.beats(self.origin)
    }

    /// The options of the user with those of a method on a rung. What they are already is not touched.
    ///
    /// # Errors
    /// If the ladder names values that options do not have.
    pub fn with(
        &self,
        family: Family,
        rung: u32,
        samples: Option<u32>,
    ) -> Result<Options, Failure> {
        let mut settings = family.settings(rung);
        if let (Some(n), None) = (samples, self.samples) {
            settings.push(("samples", n.to_string()));
            // A grid in the file would be counted before.
            settings.push(("supersampling", "auto".into()));
        }
        let settings: Vec<(String, String)> = settings
            .into_iter()
            .map(|(key, text)| (key.to_owned(), text))
            .collect();
        self.apply(&settings)
    }

    /// The options of the user with these as well, as far as they may be chosen.
    ///
    /// # Errors
    /// If they are no options, or have no such values.
    pub fn apply(&self, settings: &[(String, String)]) -> Result<Options, Failure> {
        let mut options = self.base.clone();
        for (key, text) in settings {
            let mut next = options.clone();
            next.set(key, text, self.origin)
                .map_err(|error| Failure::Usage(error.to_string()))?;
            let canonical = |options: &Options| options.entry_of(key).map(|e| e.canonical());
            if canonical(&next) != canonical(&options) {
                options = next;
            }
        }
        Ok(options)
    }

    /// Tries the methods that are open.
    ///
    /// # Errors
    /// If it was stopped.
    pub fn explore(
        &self,
        viewing: &Viewing<'_>,
        (scene, camera): (&Scene, &Camera),
        pilot: &Pilot<'_>,
    ) -> Result<Vec<Known>, Failure> {
        let mut families = self.families(Viewing::is_judged(scene));
        let path = Known {
            family: Family::Path,
            rung: 0,
            law: pilot.path,
        };
        let mut known = Vec::new();
        let mut path_seconds = None;
        if families.contains(&Family::Path) {
            known.push(path);
            families.retain(|family| *family != Family::Path);
            if let Wish::Error(error) = self.wish {
                path_seconds = path.fastest_for(error, self.samples).map(|o| o.seconds);
                if path_seconds.is_some_and(|seconds| seconds < SOON) {
                    return Ok(known);
                }
            }
        }
        let mut trial = Trial {
            viewing: *viewing,
            scene,
            camera,
            pilot,
            limits: Limits::new(viewing.world, self.wish, path_seconds),
            last: None,
        };
        for family in families {
            let options = self.with(family, 0, None)?;
            if let Some(law) = trial.law(family, &options)? {
                known.push(Known {
                    family,
                    rung: 0,
                    law,
                });
            }
        }
        Ok(known)
    }

    /// The best way of those that are known, with so many seconds left; `None` if none keeps the wish.
    #[must_use]
    pub fn best(&self, known: &[Known], seconds: f64) -> Option<Offer> {
        match self.wish {
            Wish::Seconds(_) => {
                let seconds = CAUTION * seconds;
                let offers = known.iter();
                let offers = offers.filter_map(|k| k.best_within(seconds, self.samples));
                offers.min_by(|a, b| a.error.total_cmp(&b.error))
            }
            Wish::Error(error) => {
                let offers = known
                    .iter()
                    .filter_map(|k| k.fastest_for(error, self.samples));
                let weight = |offer: &Offer| match offer.family {
                    Family::Path => offer.seconds * CLEARLY_SOONER,
                    _ => offer.seconds,
                };
                offers.min_by(|a, b| weight(a).total_cmp(&weight(b)))
            }
        }
    }

    /// What is done where no way is known to keep the wish: path tracing if that is open, otherwise what the user named.
    #[must_use]
    pub fn last_resort(&self, known: &[Known], is_judged: bool) -> Offer {
        let families = self.families(is_judged);
        let family = families.first().copied().unwrap_or(Family::Path);
        let rung = match self.wish {
            Wish::Error(_) if family.has_rungs() => BLIND_RUNG,
            _ => 0,
        };
        let law = known.iter().find(|known| known.family == family);
        let law = law.map_or(Law::default(), |k| k.law.climbed(family, rung));
        let samples = match (self.samples, self.wish) {
            (Some(samples), _) => samples,
            (None, Wish::Seconds(_)) => 1,
            (None, Wish::Error(error)) => Law {
                bias: 0.0,
                bias_error: 0.0,
                ..law
            }
            .samples_for(error)
            .unwrap_or(law::MOST_SAMPLES)
            .max(4),
        };
        Known { family, rung, law }.offer(samples)
    }

    /// Path tracing, as long as the wish needs; with one sample where the time has no room for any.
    #[must_use]
    pub fn path_offer(&self, law: &Law) -> Offer {
        let path = Known {
            family: Family::Path,
            rung: 0,
            law: *law,
        };
        let (offer, otherwise) = match self.wish {
            Wish::Error(error) => (path.fastest_for(error, self.samples), law::MOST_SAMPLES),
            Wish::Seconds(seconds) => (path.best_within(seconds, self.samples), 1),
        };
        offer.unwrap_or_else(|| path.offer(self.samples.unwrap_or(otherwise)))
    }

    /// Whether this time is so short that it is path traced without trials.
    #[must_use]
    pub fn is_hasty(&self) -> bool {
        matches!(self.wish, Wish::Seconds(seconds) if seconds < TOO_SHORT)
            && self.families(true).contains(&Family::Path)
    }
}

/// How long steps of trials may take.
struct Limits<'a> {
    world: &'a dyn World,
    begin: Duration,
    /// Seconds for one step; `None`: as long as it takes, where only what the user named is tried.
    of_step: Option<f64>,
    /// Seconds for all steps.
    of_all: f64,
}

impl<'a> Limits<'a> {
    fn new(world: &'a dyn World, wish: Wish, path_seconds: Option<f64>) -> Self {
        let (of_step, of_all) = match wish {
            Wish::Seconds(seconds) => {
                let of_step = (PART_OF_TRIAL * seconds).max(SHORT_TRIAL);
                (Some(of_step), PART_OF_TRIALS * seconds)
            }
            // What is tried once pays for itself where a picture takes minutes.
            Wish::Error(_) => {
                let of_step = path_seconds.map(|seconds| (PART_OF_PATH * seconds).max(SHORT_TRIAL));
                (of_step, f64::INFINITY)
            }
        };
        Self {
            world,
            begin: world.now(),
            of_step,
            of_all,
        }
    }

    /// The time for the next step.
    fn for_step(&self) -> Duration {
        let Some(seconds) = self.of_step else {
            return Duration::MAX;
        };
        let spent = self.world.now().saturating_sub(self.begin).as_secs_f64();
        let seconds = seconds.min(self.of_all - spent);
        Duration::from_secs_f64(seconds.clamp(0.0, LONGEST_TRIAL))
    }
}

/// Trying methods one after the other.
struct Trial<'t, 'p> {
    viewing: Viewing<'t>,
    scene: &'t Scene,
    camera: &'t Camera,
    pilot: &'t Pilot<'p>,
    limits: Limits<'t>,
    /// The last light that was solved, what for, and its seconds: methods that look at the same light in two ways share it.
    last: Option<(String, Solution, f64)>,
}

impl Trial<'_, '_> {
    /// The law of a method with these options; `None` if it is too slow for a trial, or too large for the memory there is.
    fn law(&mut self, family: Family, options: &Options) -> Result<Option<Law>, Failure> {
        let viewing = Viewing {
            options,
            ..self.viewing
        };
        let shared = options.fingerprint(Stage::Solution);
        if self
            .last
            .as_ref()
            .is_none_or(|(known, ..)| *known != shared)
        {
            let world = viewing.world;
            let begin = world.now();
            let solve = |v: &Viewing<'_>| v.solve(self.scene, &mut |_| {});
            let solved = viewing.within(self.limits.for_step(), solve);
            let seconds = world.now().saturating_sub(begin).as_secs_f64();
            self.last = match solved {
                Ok(Some(solution)) => Some((shared, solution, seconds)),
                Ok(None) | Err(Failure::World(_)) => None,
                Err(failure) => return Err(failure),
            };
        }
        let Some((_, solution, seconds)) = &self.last else {
            return Ok(None);
        };
        let sight = (self.scene, self.camera);
        let measure = |v: &Viewing<'_>| self.pilot.measure(v, sight, (solution, *seconds));
        let mut law = viewing.within(self.limits.for_step(), measure)?;
        if let Some(law) = &mut law
            && !Viewing::is_judged(self.scene)
        {
            (law.bias, law.bias_error) = (family.usual_bias(), 0.0);
        }
        Ok(law)
    }
}

/// The options that were chosen, as a part of a command line.
#[must_use]
pub fn command_line(options: &Options) -> String {
    let entries = options.entries();
    let chosen = entries
        .iter()
        .filter(|entry| matches!(entry.origin, Origin::Chosen { .. }));
    let words: Vec<String> = chosen
        .map(|entry| format!("--{} {}", entry.row.key, entry.text))
        .collect();
    words.join(" ")
}

/// What the chosen settings are, for people; nothing if all is as the user named it.
#[must_use]
pub fn told(run: &Run) -> Option<String> {
    let chosen = command_line(&run.options);
    (!chosen.is_empty()).then(|| format!("chosen: {chosen}"))
}

/// A time for people: `14 min`.
#[must_use]
pub fn readable(seconds: f64) -> String {
    if seconds < 99.5 {
        format!("{seconds:.1} s")
    } else if seconds < 99.5 * 60.0 {
        format!("{:.0} min", seconds / 60.0)
    } else {
        format!("{:.0} h", seconds / 3600.0)
    }
}

#[cfg(test)]
mod tests;
