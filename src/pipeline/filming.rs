//! From a model to a film: which frames are missing, the scenes they need, the frames, the film.
//!
//! Frames that show the same scene share it and the light in it. The random numbers of a pixel come from the seed and the
//! pixel, not from the frame, and those of photon mapping lie on the surfaces: where nothing moves, nothing changes.

use super::choosing::{Wish, told};
use super::content_hash::ContentHash;
use super::course;
use super::exposing;
use super::failure::Failure;
use super::film_samples::OneMore;
use super::frame::{FrameAudience, describe};
use super::making::{Made, Making, UNLIT};
use super::reel::Reel;
use super::report::{Effort, Phase, SolutionFacts};
use super::solving::Solved;
use super::spot_check::samples_of_half;
use super::studio::{Run, Studio};
use super::until::Until;
use super::viewing::{Prepared, Viewing};
use super::viewpoint;
use crate::animation::flicker::Flicker;
use crate::animation::plan;
use crate::animation::{FilmShape, Flight, Moment};
use crate::camera::{Camera, View};
use crate::image::Picture;
use crate::integrator::RadianceEstimator;
use crate::options::value::Renderer;
use crate::options::{Options, Origin};
use crate::scene::Scene;
use std::collections::BTreeSet;
use std::num::NonZeroU32;
use std::sync::Arc;

/// A frame to be.
pub(super) struct Job {
    pub(super) frame: u32,
    pub(super) moment: Moment,
    pub(super) camera: Camera,
    /// Equal for frames that show the same scene.
    pub(super) scene: ContentHash,
    /// All that the frame is made from.
    pub(super) key: String,
    /// Samples of its pixels.
    samples: NonZeroU32,
}

impl Job {
    /// The factor for its radiance where that of the film is this one.
    pub(super) fn exposed(&self, film: f64) -> f64 {
        film * exposing::factor(self.moment.stops)
    }
}

/// A scene with the light that all cameras share.
struct Set {
    key: ContentHash,
    scene: Arc<Scene>,
    solved: Solved,
}

/// A film under way.
pub(super) struct Shooting<'a, 'w> {
    pub(super) making: Making<'a>,
    pub(super) studio: &'a mut Studio<'w>,
    pub(super) run: &'a mut Run,
    /// The options as the user gave them, and as they were chosen for a wanted time or error.
    pub(super) base: Options,
    /// When a frame is done.
    pub(super) until: Until,
    /// Where the film has a wanted time or error: frames that path tracing checks, unless it made them.
    pub(super) checked: Option<BTreeSet<u32>>,
    /// Frames that have one sample more than the options say.
    pub(super) one_more: OneMore,
    /// The exposure of all frames once it is known.
    pub(super) exposure: Option<f64>,
    set: Option<Set>,
    done: Done,
}

/// What has become of the frames so far.
#[derive(Default)]
struct Done {
    hashes: Vec<(u32, ContentHash)>,
    effort: Option<Effort>,
    /// Frames whose error is known.
    n_judged: u32,
    /// Frames that show no light at all.
    black: Vec<u32>,
    n_kept: u32,
    n_made: u32,
    warnings: Option<Vec<&'static str>>,
    solution: SolutionFacts,
}

impl Making<'_> {
    /// The map of the flight that the options ask for.
    ///
    /// # Errors
    /// If growth or the flight fails.
    pub fn plan(&self, studio: &mut Studio<'_>, run: &mut Run) -> Result<Picture, Failure> {
        let mut shooting = Shooting::new(self, studio, run);
        let flight = shooting.flight()?;
        shooting.set_moment(course::last_step(&shooting.base), None)?;
        let scene = shooting.studio.build(shooting.run, self.cancel)?;
        let views: Vec<View> = flight.all().map(|frame| flight.view(frame)).collect();
        shooting.run.options = shooting.base;
        Ok(plan::plan(&scene, &views))
    }

    /// Makes the frames that the options ask for, and the film once all its frames are there. Frames that are there already
    /// and were made from the same are kept. Stopped early, what is finished stays.
    ///
    /// # Errors
    /// If any stage fails.
    pub fn film(
        &self,
        studio: &mut Studio<'_>,
        run: &mut Run,
        reel: &Reel,
    ) -> Result<Made, Failure> {
        let shape = course::shape(&run.options);
        let mut shooting = Shooting::new(self, studio, run);
        let flight = shooting.flight()?;
        if let Some(wish) = Wish::of(&shooting.base)? {
            shooting.choose(&flight, reel, wish)?;
        }
        let jobs = shooting.jobs(&flight)?;
        let wanted = shooting.base.frames.value.clone().unwrap_or(flight.all());
        let (mut missing, mut is_elsewhere_whole) = (Vec::new(), true);
        for job in &jobs {
            let kept = reel.kept(self.world, job.frame, &job.key)?;
            match (kept, wanted.contains(&job.frame)) {
                (Some(hash), true) => shooting.done.keep(job.frame, hash),
                (None, true) => missing.push(job),
                (None, false) => is_elsewhere_whole = false,
                (Some(_), false) => {}
            }
        }
        let exposure = match missing[..] {
            [] => None,
            _ => Some(shooting.exposure(&jobs[flight.brightest() as usize])?),
        };
        if let Some(exposure) = exposure
            && !shooting.shoot(&missing, reel, exposure)?
        {
            return Ok(shooting.end(false, None, None));
        }
        let flicker = match exposure {
            Some(exposure) => shooting.flicker(&jobs, wanted, reel, exposure)?,
            None => None,
        };
        let film = if is_elsewhere_whole && reel.film().is_some() {
            shooting.assemble(reel, shape)?
        } else {
            None
        };
        Ok(shooting.end(true, flicker, film))
    }
}

impl<'a, 'w> Shooting<'a, 'w> {
    fn new(making: &Making<'a>, studio: &'a mut Studio<'w>, run: &'a mut Run) -> Self {
        Self {
            making: *making,
            studio,
            base: run.options.clone(),
            run,
            until: Until::Samples,
            checked: None,
            one_more: OneMore::default(),
            exposure: None,
            set: None,
            done: Done::default(),
        }
    }

    /// The flight, whose view is that of the largest model unless the options decide it.
    fn flight(&mut self) -> Result<Flight, Failure> {
        if let Some(view) = course::decided(&self.base) {
            return Ok(course::flight(&self.base, view));
        }
        self.set_moment(course::last_step(&self.base), None)?;
        let scene = self.studio.build(self.run, self.making.cancel)?;
        let view = viewpoint::of_scene(&self.base, &scene);
        course::flight_through(&self.base, view, &scene)
    }

    /// Sets the options to those of one moment.
    pub(super) fn set_moment(
        &mut self,
        step: Option<f64>,
        sun: Option<crate::animation::SunPlace>,
    ) -> Result<(), Failure> {
        let mut options = self.base.clone();
        let mut set = |key: &str, text: String| {
            options
                .set(key, &text, Origin::Flag)
                .map_err(|error| Failure::Usage(error.to_string()))
        };
        if let Some(step) = step {
            set("steps", step.floor().to_string())?;
        }
        self.run.part = step.map_or(0.0, |step| step - step.floor());
        if let Some(sun) = sun {
            set("sun", format!("{},{}", sun.azimuth, sun.elevation))?;
            set("date", "none".into())?;
        }
        self.run.options = options;
        Ok(())
    }

    /// Sets the options to this number of samples.
    fn set_samples(&mut self, samples: NonZeroU32) -> Result<(), Failure> {
        let origin = self.base.samples.origin;
        let options = &mut self.run.options;
        if options.samples.value == samples {
            return Ok(());
        }
        options
            .set("samples", &samples.to_string(), origin)
            .map_err(|error| Failure::Usage(error.to_string()))
    }

    /// All frames of the flight with all that each is made from.
    pub(super) fn jobs(&mut self, flight: &Flight) -> Result<Vec<Job>, Failure> {
        let cameras = course::cameras(self.run, flight)?;
        let panorama = self.studio.panorama(self.run)?;
        let panorama = ContentHash::of(panorama.as_ref().map(|(_, file)| &file[..]));
        // All frames have the exposure of this one.
        let leader = format!(
            "{:?}",
            cameras.get(flight.brightest() as usize).map(|(m, _)| m)
        );
        let mut jobs = Vec::with_capacity(cameras.len());
        for (frame, (moment, camera)) in (0..).zip(cameras) {
            self.set_moment(moment.step, moment.sun)?;
            let samples = self.base.samples.value;
            let samples = samples.saturating_add(self.one_more.has(frame).into());
            self.set_samples(samples)?;
            let key = self
                .run
                .picture_key()
                .with(&panorama.to_string())
                .with(&leader)
                .with(&format!("{moment:?} {:?}", camera.motion()));
            jobs.push(Job {
                frame,
                moment,
                camera,
                scene: self.run.scene_key(),
                key: key.to_string(),
                samples,
            });
        }
        Ok(jobs)
    }

    /// Builds the scene of a frame and solves its light, unless both are there.
    fn enter(&mut self, job: &Job) -> Result<(), Failure> {
        if self.set.as_ref().is_some_and(|set| set.key == job.scene) {
            return Ok(());
        }
        self.set = None;
        self.set_moment(job.moment.step, job.moment.sun)?;
        let scene = self.studio.build(self.run, self.making.cancel)?;
        let viewing = self.making.viewing(self.run);
        self.making.audience.begins("preparing");
        let solved = self.studio.solve(self.run, &scene, &viewing)?;
        self.enter_with(job, scene, solved);
        Ok(())
    }

    /// Keeps the scene of a frame with its light, so that frames which show it have them.
    pub(super) fn enter_with(&mut self, job: &Job, scene: Arc<Scene>, solved: Solved) {
        if self.done.warnings.is_none() {
            let viewing = self.making.viewing(self.run);
            self.done.warnings = Some(self.making.warn(self.run, &viewing, &scene));
        }
        solved.warn(self.making.audience, &self.run.sources.map);
        self.done.solution = solved.facts;
        self.set = Some(Set {
            key: job.scene,
            scene,
            solved,
        });
    }

    /// Looks at the scene of a frame, with these options.
    pub(super) fn look<T>(
        &mut self,
        job: &Job,
        options: &Options,
        work: impl FnOnce(&mut Self, &Scene, &Prepared<'_>) -> Result<T, Failure>,
    ) -> Result<T, Failure> {
        self.enter(job)?;
        let Some(set) = &self.set else {
            return Err(Failure::Stopped);
        };
        let (scene, solution) = (set.scene.clone(), set.solved.solution.clone());
        let (world, making) = (self.making.world, self.making);
        let viewing = Viewing {
            options,
            ..making.viewing(self.run)
        };
        let prepare = || viewing.prepare(&scene, &solution);
        let prepared = self.studio.seconds.time(world, Phase::Prepare, prepare)?;
        work(self, &scene, &prepared)
    }

    /// Makes frames, those of each scene together; whether it got to the end.
    fn shoot(&mut self, missing: &[&Job], reel: &Reel, exposure: f64) -> Result<bool, Failure> {
        let n_frames = missing.len() as u64;
        let mut index = 0;
        for group in missing.chunk_by(|a, b| a.scene == b.scene) {
            let Some(first) = group.first() else { continue };
            let options = self.base.clone();
            let is_whole = self.look(first, &options, |this, scene, prepared| {
                let viewing = this.making.viewing(this.run);
                let checked = this.checked.as_ref();
                let is_checked = |job: &&Job| checked.is_some_and(|c| c.contains(&job.frame));
                let judge = || viewing.needed_judge(scene);
                let judge = if group.iter().any(is_checked) {
                    let phases = &mut this.studio.seconds;
                    phases.time(this.making.world, Phase::Check, judge)?
                } else {
                    None
                };
                this.making.audience.begins("flying");
                for job in group {
                    let progress = FrameAudience {
                        audience: this.making.audience,
                        index,
                        n_frames,
                    };
                    index += 1;
                    let ready = (prepared, judge.as_deref());
                    if !this.shoot_one(job, ready, &progress, reel, exposure)? {
                        return Ok(false);
                    }
                }
                Ok(true)
            });
            match is_whole {
                Ok(true) => {}
                Ok(false) | Err(Failure::Stopped) => {
                    self.making.audience.ends();
                    return Ok(false);
                }
                Err(failure) => return Err(failure),
            }
        }
        self.making.audience.ends();
        Ok(true)
    }

    /// Makes one frame and writes it; whether it has all its samples.
    fn shoot_one(
        &mut self,
        job: &Job,
        (prepared, judge): (&Prepared<'_>, Option<&dyn RadianceEstimator>),
        progress: &FrameAudience<'_>,
        reel: &Reel,
        exposure: f64,
    ) -> Result<bool, Failure> {
        let world = self.making.world;
        self.set_samples(job.samples)?;
        let viewing = Viewing {
            audience: progress,
            ..self.making.viewing(self.run)
        };
        let shoot = || viewing.take(prepared, &job.camera, self.until, &mut |_| {});
        let mut shot = self.studio.seconds.time(world, Phase::Render, shoot)?;
        if !shot.is_whole {
            return Ok(false);
        }
        let is_path = viewing.options.renderer.value == Renderer::Path;
        if let Some(checked) = self.checked.as_ref().filter(|_| !is_path) {
            let n = samples_of_half(shot.effort.n_samples);
            let judge = judge.filter(|_| checked.contains(&job.frame));
            let check = |judge| viewing.spot_check(judge, &job.camera, &shot, n);
            let check = || judge.map(check).transpose();
            shot.effort.error = self.studio.seconds.time(world, Phase::Check, check)?;
        }
        if shot.image.is_black() {
            self.done.black.push(job.frame);
        }
        let run = &*self.run;
        let hash = self.studio.seconds.time(world, Phase::Write, || {
            let exposure = job.exposed(exposure);
            let picture = exposing::develop(&shot.image, reel.frame_format(), exposure);
            let mut texts = run.texts();
            texts.push(("Moment", describe(&job.moment)));
            reel.put(world, job.frame, &job.key, &picture, texts)
        })?;
        self.done.make(job.frame, hash, shot.effort);
        Ok(true)
    }

    fn assemble(&mut self, reel: &Reel, shape: FilmShape) -> Result<Option<ContentHash>, Failure> {
        let (world, audience) = (self.making.world, self.making.audience);
        audience.begins("writing the film");
        let mut told = |frame: u32| audience.progress(frame.into(), shape.n_frames.into());
        let film = self.studio.seconds.time(world, Phase::Write, || {
            reel.assemble(world, shape, &mut told)
        });
        audience.ends();
        film
    }

    fn end(self, is_whole: bool, flicker: Option<Flicker>, film: Option<ContentHash>) -> Made {
        // Single frames had options of their own.
        self.run.options = self.base;
        self.run.part = 0.0;
        let notes = match self.until {
            Until::Error { .. } => {
                let text =
                    "chosen: `--renderer path`, each frame with as many samples as its error needs";
                vec![text.to_owned()]
            }
            Until::Samples | Until::Time(_) => told(self.run)
                .map(|told| self.one_more.told(told))
                .into_iter()
                .collect(),
        };
        let mut notes = notes;
        let mut done = self.done;
        let error = done.effort.and_then(|effort| effort.error);
        notes.extend(error.map(|error| match done.n_judged {
            n if n == done.n_made => {
                format!("estimated error of the worst frame: {}", error.text())
            }
            n => format!(
                "estimated error of the worst of {n} frames: {}",
                error.text()
            ),
        }));
        notes.extend(told_black(&done.black, done.n_made));
        done.hashes.sort_unstable_by_key(|(frame, _)| *frame);
        let all: String = done
            .hashes
            .iter()
            .map(|(_, hash)| hash.to_string())
            .collect();
        Made {
            effort: done.effort.unwrap_or_default(),
            hash: film.unwrap_or_else(|| ContentHash::of([all.as_bytes()])),
            is_whole,
            n_kept: done.n_kept,
            n_made: done.n_made,
            warnings: done.warnings.unwrap_or_default(),
            solution: done.solution,
            flicker,
            has_film: film.is_some(),
            notes,
        }
    }
}

/// What people are told of black frames among those that were made.
fn told_black(black: &[u32], n_made: u32) -> Option<String> {
    let (first, last) = (black.first()?, black.last()?);
    let n = black.len();
    Some(if n == n_made as usize {
        format!("all frames are black: {UNLIT}")
    } else {
        format!(
            "{n} of {n_made} frames are black (the first is frame {first}, the last frame {last}): {UNLIT}"
        )
    })
}

impl Done {
    fn keep(&mut self, frame: u32, hash: ContentHash) {
        self.hashes.push((frame, hash));
        self.n_kept += 1;
    }

    fn make(&mut self, frame: u32, hash: ContentHash, effort: Effort) {
        self.hashes.push((frame, hash));
        self.n_judged += u32::from(effort.error.is_some());
        self.effort = Some(self.effort.map_or(effort, |all| all.and(effort)));
        self.n_made += 1;
    }
}
