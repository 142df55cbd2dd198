//! Renderer and settings of a film for a wanted time or error.
//!
//! They are chosen once, before the first frame, and kept in a file beside the frames: each frame is made with them whenever and wherever it
//! is made, and depends on nothing else. A wanted time is that of all frames together, with the light that they share, from grown
//! scenes on; a wanted error is that of each frame. Frames all over the film are path traced at a glance, which tells how much slower and
//! noisier some are than others; methods are tried on the noisiest of them. The light of the chosen one is solved and measured once more
//! before the number of samples is settled; for a wanted time, some frames are made with few of them, which tells what they really cost.

use super::choosing::family::Family;
use super::choosing::law::{Known, Law, Offer};
use super::choosing::pilot::Pilot;
use super::choosing::settling::settle;
use super::choosing::{Chooser, Wish};
use super::content_hash::ContentHash;
use super::failure::Failure;
use super::film_samples::OneMore;
use super::film_trial::{PLACES, evenly, places, shape};
use super::filming::{Job, Shooting};
use super::reel::Reel;
use super::report::Phase;
use super::solving::Solved;
use super::spot_check;
use super::store::may_write;
use super::until::Until;
use super::viewing::Viewing;
use super::world::{Entry, World};
use crate::animation::Flight;
use crate::camera::Camera;
use crate::options::value::Renderer;
use crate::options::{Options, Origin};
use crate::scene::Scene;
use serde::Deserialize;
use std::collections::{BTreeMap, BTreeSet};
use std::fmt::Write;
use std::path::Path;
use std::sync::Arc;
use std::time::Duration;

/// The file beside the frames.
const FILE: &str = "chosen.toml";
/// How it begins.
const HEAD: &str = "# understory: ";
/// Part of a wanted time that is planned with: single frames differ.
const PLANNED: f64 = 0.95;

/// What the file holds.
#[derive(Deserialize)]
struct Kept {
    /// A hash of all that the film is made from.
    film: String,
    /// Options with their values.
    #[serde(default)]
    chosen: BTreeMap<String, String>,
    /// The part of the frames that have one sample more.
    #[serde(default)]
    one_more_sample: f64,
}

/// Part of a wanted time for all these looks.
const PART_OF_LOOKS: f64 = 0.05;
/// Part of the time that is left after which light that is not yet solved is given up.
const PART_OF_SOLUTION: f64 = 0.8;
/// So many times the samples that were expected are never taken: then a trial was disturbed.
const FAR_OFF: f64 = 4.0;
/// Part of a wanted time that is planned with once this is known.
const TRIED: f64 = 0.97;

/// A frame as path tracing finds it at a glance.
struct Look<'j> {
    job: &'j Job,
    path: Law,
}

/// What turns the laws of a single frame into those of an average one.
#[derive(Clone, Copy)]
struct Average {
    /// The part of what frames share that each pays.
    of_shared: f64,
    /// Its seconds for those of the frame that methods are tried on.
    of_seconds: f64,
}

impl Average {
    fn frame(self, law: Law) -> Law {
        Law {
            shared: law.shared * self.of_shared,
            begin: law.begin * self.of_seconds,
            sample: law.sample * self.of_seconds,
            ..law
        }
    }
}

impl Shooting<'_, '_> {
    /// Chooses for all frames, or takes over what was chosen for them before.
    ///
    /// # Errors
    /// If it was stopped, or the file can be neither used nor written.
    pub(super) fn choose(
        &mut self,
        flight: &Flight,
        reel: &Reel,
        wish: Wish,
    ) -> Result<(), Failure> {
        let chooser = Chooser::new(&self.base, wish);
        let jobs = self.jobs(flight)?;
        let keys: Vec<&[u8]> = jobs.iter().map(|job| job.key.as_bytes()).collect();
        let key = ContentHash::of(keys).to_string();
        let path = reel.folder().join(FILE);
        let world = self.making.world;
        (self.base, self.one_more) = match read(world, &path, &key)? {
            Some(kept) => {
                let chosen: Vec<(String, String)> = kept.chosen.into_iter().collect();
                (chooser.apply(&chosen)?, OneMore::of(kept.one_more_sample))
            }
            None => {
                let leader = &jobs[flight.brightest() as usize];
                let (chosen, more) = self.measured((&jobs, leader), &chooser)?;
                write(world, &path, &key, (&chosen, more))?;
                (chosen, more)
            }
        };
        if let (Wish::Error(most), Renderer::Path, None) =
            (wish, self.base.renderer.value, chooser.samples)
        {
            self.until = Until::Error {
                most,
                expected: self.base.samples.value.get(),
            };
        }
        self.checked = Some(checked(&jobs, wish));
        Ok(())
    }

    /// The options for all frames, whose exposure suits the leader, and which have one sample more.
    fn measured(
        &mut self,
        (jobs, leader): (&[Job], &Job),
        chooser: &Chooser,
    ) -> Result<(Options, OneMore), Failure> {
        let begin = self.studio.seconds.of_light();
        let looks = self.looks(jobs, chooser.wish)?;
        let Some(choice) = self.measure(jobs, (&looks, begin), chooser)? else {
            return Ok((self.base.clone(), OneMore::default()));
        };
        let of = |samples| chooser.with(choice.family, choice.rung, Some(samples));
        let chosen = of(choice.samples)?;
        let Wish::Seconds(seconds) = chooser.wish else {
            return Ok((chosen, OneMore::default()));
        };
        let shape = shape(choice.samples, jobs.len());
        let is_open = chooser.samples.is_none() && n_scenes(jobs) == 1.0;
        let Some((n, most)) = shape.filter(|_| is_open) else {
            return Ok((chosen, OneMore::of(choice.part_of_sample)));
        };
        let some: Vec<&Look<'_>> = evenly(looks.len(), n).map(|at| &looks[at]).collect();
        let places: Vec<&Job> = some.iter().map(|look| look.job).collect();
        // What is found for all frames is not looked for again, and counts as spent.
        self.with_options(&chosen, leader, |this| this.exposure(leader))?;
        let law = self.trial(&places, jobs.len(), (&of(1)?, &of(most)?, choice.samples))?;
        let tried = some.iter().map(|look| look.path.sample).sum::<f64>() / n as f64;
        let average = Average {
            of_shared: 1.0,
            of_seconds: mean_seconds(&looks) / tried.max(f64::MIN_POSITIVE),
        };
        let law = average.frame(law);
        let spent = self.studio.seconds.of_light() - begin;
        let each = TRIED * (seconds - spent).max(0.0) / jobs.len() as f64;
        let most = FAR_OFF * f64::from(choice.samples);
        let (whole, more) = OneMore::split(law.room_within(each).min(most));
        Ok((of(whole)?, more))
    }

    /// The method, rung and samples for all frames. Some were looked at since the light had taken the seconds `begin`, which counts.
    fn measure(
        &mut self,
        jobs: &[Job],
        (looks, begin): (&[Look<'_>], f64),
        whole: &Chooser,
    ) -> Result<Option<Offer>, Failure> {
        let noise = |look: &Look<'_>| look.path.noise;
        let hardest = looks.iter().max_by(|a, b| noise(a).total_cmp(&noise(b)));
        let Some(&Look { job, path }) = hardest else {
            return Ok(None);
        };
        let average = Average {
            of_shared: n_scenes(jobs) / jobs.len() as f64,
            of_seconds: mean_seconds(looks) / path.sample.max(f64::MIN_POSITIVE),
        };
        let scene = self.scene(job)?;
        let pilot = self.pilot((&scene, &job.camera), whole.wish)?;
        let known = self.explore((&scene, &job.camera), whole, &pilot)?;
        let checked = checked(jobs, whole.wish).len() as f64 / jobs.len() as f64;
        let of_frame = |law: Law, family| average.frame(with_check(law, family, &pilot, checked));
        let known: Vec<Known> = known
            .iter()
            .map(|known| Known {
                law: of_frame(known.law, known.family),
                ..*known
            })
            .collect();
        let spent = self.studio.seconds.of_light() - begin;
        let chooser = &of_each(whole, spent, jobs.len());
        let seconds = match chooser.wish {
            Wish::Seconds(seconds) => seconds,
            Wish::Error(_) => f64::INFINITY,
        };
        let is_judged = Viewing::is_judged(&scene);
        let best = chooser.best(&known, seconds);
        let offer = best.unwrap_or_else(|| chooser.last_resort(&known, is_judged));
        let path_law = average.frame(pilot.path);
        let path_seconds = chooser.path_offer(&path_law).seconds;
        let path_seconds = (chooser.is_free() && is_judged).then_some(path_seconds);
        let mut light = None;
        let limit = match whole.wish {
            Wish::Seconds(seconds) if path_seconds.is_some() => {
                Duration::try_from_secs_f64(PART_OF_SOLUTION * (seconds - spent).max(0.0))
            }
            _ => Ok(Duration::MAX),
        };
        let limit = limit.unwrap_or(Duration::MAX);
        let settled = settle(chooser, offer, path_seconds, |offer| {
            // Where path tracing lacks light its truth is none to measure by.
            if !offer.family.has_rungs() || !is_judged {
                return Ok(((), None));
            }
            light = None;
            let options = chooser.with(offer.family, offer.rung, Some(offer.samples))?;
            let (solved, law) = self.solved((job, &scene), &options, &pilot, limit)?;
            light = Some(solved);
            Ok(((), Some(of_frame(law, offer.family))))
        })?;
        let offer = settled.map_or_else(
            || {
                // What was tried in vain took its time.
                let spent = self.studio.seconds.of_light() - begin;
                of_each(whole, spent, jobs.len()).path_offer(&path_law)
            },
            |(offer, ())| offer,
        );
        if let Some(solved) = light.filter(|_| offer.family.has_rungs()) {
            self.enter_with(job, scene.clone(), solved);
        }
        Ok(Some(offer))
    }

    /// Path traces frames all over the film at a glance.
    fn looks<'j>(&mut self, jobs: &'j [Job], wish: Wish) -> Result<Vec<Look<'j>>, Failure> {
        let seconds = match wish {
            Wish::Seconds(seconds) => PART_OF_LOOKS * seconds / PLACES as f64,
            Wish::Error(_) => f64::INFINITY,
        };
        let places = places(jobs);
        let mut looks = Vec::new();
        for group in places.chunk_by(|a, b| a.scene == b.scene) {
            let scene = self.scene(group[0])?;
            self.making.audience.begins("measuring");
            let viewing = self.making.viewing(self.run);
            let look = || {
                let judge = viewing.judge(&scene)?;
                let glance = |job: &&'j Job| {
                    let path = Pilot::glance(&viewing, (&*judge, &job.camera), seconds)?;
                    Ok(Look { job, path })
                };
                group
                    .iter()
                    .map(glance)
                    .collect::<Result<Vec<_>, Failure>>()
            };
            let phases = &mut self.studio.seconds;
            looks.extend(phases.time(self.making.world, Phase::Prepare, look)?);
        }
        Ok(looks)
    }

    /// The scene of a frame, which the options then are those of.
    fn scene(&mut self, job: &Job) -> Result<Arc<Scene>, Failure> {
        self.set_moment(job.moment.step, job.moment.sun)?;
        self.studio.build(self.run, self.making.cancel)
    }

    /// Works on a frame with other options than the user's; those of the moment stay.
    pub(super) fn with_options<T>(
        &mut self,
        options: &Options,
        job: &Job,
        work: impl FnOnce(&mut Self) -> Result<T, Failure>,
    ) -> Result<T, Failure> {
        let user = std::mem::replace(&mut self.base, options.clone());
        let moment = self.set_moment(job.moment.step, job.moment.sun);
        let done = moment.and_then(|()| work(self));
        self.base = user;
        done
    }

    fn pilot<'s>(
        &mut self,
        (scene, camera): (&'s Scene, &Camera),
        wish: Wish,
    ) -> Result<Pilot<'s>, Failure> {
        self.making.audience.begins("measuring");
        let viewing = self.making.viewing(self.run);
        let new = || Pilot::new(&viewing, scene, camera, wish);
        self.studio
            .seconds
            .time(self.making.world, Phase::Prepare, new)
    }

    /// Tries the methods that are open on one frame.
    fn explore(
        &mut self,
        sight: (&Scene, &Camera),
        chooser: &Chooser,
        pilot: &Pilot<'_>,
    ) -> Result<Vec<Known>, Failure> {
        let viewing = self.making.viewing(self.run);
        let explore = || chooser.explore(&viewing, sight, pilot);
        self.studio
            .seconds
            .time(self.making.world, Phase::Prepare, explore)
    }

    /// The light of an offer, solved within so much time, and what it costs and gives in one frame.
    fn solved(
        &mut self,
        (job, scene): (&Job, &Arc<Scene>),
        options: &Options,
        pilot: &Pilot<'_>,
        limit: Duration,
    ) -> Result<(Solved, Law), Failure> {
        let world = self.making.world;
        self.with_options(options, job, |_| Ok(()))?;
        self.making.audience.begins("preparing");
        let viewing = self.making.viewing(self.run);
        let begin = world.now();
        let (studio, run) = (&mut *self.studio, &*self.run);
        let solved = viewing.within(limit, |viewing| studio.solve(run, scene, viewing))?;
        let too_long = || Failure::World("the light takes longer than is wanted".into());
        let solved = solved.ok_or_else(too_long)?;
        let shared = world.now().saturating_sub(begin).as_secs_f64();
        self.making.audience.begins("measuring");
        let measure = || pilot.measure(&viewing, (scene, &job.camera), (&solved.solution, shared));
        let law = self.studio.seconds.time(world, Phase::Prepare, measure)?;
        Ok((solved, law))
    }
}

/// The wish for each of so many frames: its part of the seconds that are left.
fn of_each(chooser: &Chooser, spent: f64, n_frames: usize) -> Chooser {
    chooser.wishing(match chooser.wish {
        Wish::Seconds(seconds) => {
            Wish::Seconds(PLANNED * (seconds - spent).max(0.0) / n_frames as f64)
        }
        error @ Wish::Error(_) => error,
    })
}

/// How many scenes the frames show.
fn n_scenes(jobs: &[Job]) -> f64 {
    let scenes: BTreeSet<String> = jobs.iter().map(|job| job.scene.to_string()).collect();
    scenes.len() as f64
}

/// Seconds of a sample of each pixel, on average.
fn mean_seconds(looks: &[Look<'_>]) -> f64 {
    looks.iter().map(|look| look.path.sample).sum::<f64>() / looks.len() as f64
}

/// Frames that path tracing checks once they are made: all where each was promised an error, some where that would cost a part of the
/// wanted time.
fn checked(jobs: &[Job], wish: Wish) -> BTreeSet<u32> {
    match wish {
        Wish::Error(_) => jobs.iter().map(|job| job.frame).collect(),
        Wish::Seconds(_) => places(jobs).iter().map(|job| job.frame).collect(),
    }
}

/// The law of a frame where a part of all frames is checked; those that were path traced are not.
fn with_check(law: Law, family: Family, pilot: &Pilot<'_>, part: f64) -> Law {
    if family == Family::Path {
        return law;
    }
    let (at_least, of_sample) = spot_check::share_of_samples();
    Law {
        shared: law.shared + part * pilot.path.shared,
        begin: law.begin + part * at_least * pilot.seconds_of_sample,
        sample: law.sample + part * of_sample * pilot.path.sample,
        ..law
    }
}

/// What was chosen for the film with this key.
fn read(world: &dyn World, path: &Path, key: &str) -> Result<Option<Kept>, Failure> {
    if world.entry(path) != Entry::File {
        return Ok(None);
    }
    let file = world
        .read(path)
        .map_err(|error| Failure::file("read", path, &error))?;
    let text = String::from_utf8_lossy(&file);
    // One of another film, or a damaged one, is written anew, unless somebody else wrote it.
    let kept: Option<Kept> = toml::from_str(&text).ok();
    Ok(kept.filter(|kept| kept.film == key))
}

/// Keeps what was chosen.
fn write(
    world: &dyn World,
    path: &Path,
    key: &str,
    (options, more): (&Options, OneMore),
) -> Result<(), Failure> {
    let mut text = format!(
        "{HEAD}settings that were chosen for all frames of this film. Without this file they are chosen anew.\n\
         film = \"{key}\"\n\
         # The part of the frames that have one sample more, so that the wanted time is used.\n\
         one_more_sample = {:?}\n\n[chosen]\n",
        more.part()
    );
    for entry in options.entries() {
        if matches!(entry.origin, Origin::Chosen { .. }) {
            // Writing into a text does not fail. No chosen value has a quotation mark.
            let _ = writeln!(text, "{} = \"{}\"", entry.row.key, entry.text);
        }
    }
    may_write(world, path, "a file of chosen settings", |head| {
        HEAD.as_bytes().starts_with(head) || head.starts_with(HEAD.as_bytes())
    })?;
    world
        .replace(path, text.as_bytes())
        .map_err(|error| Failure::file("write", path, &error))
}
