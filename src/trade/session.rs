//! Measures a model: reference first, then each ladder from cheap to dear, as far as the budget reaches.

use super::climb::{Climb, cheapest};
use super::fit::Floor;
use super::folder::Folder;
use super::ladder::{self, Family, Needs, Rung};
use super::objects::Objects;
use super::reference::Standard;
use super::results::{Findings, Ladder, Measured};
use super::shooting::{TURN, set};
use crate::camera::Camera;
use crate::camera::orbit::orbit;
use crate::integrator::CancelToken;
use crate::material::Lobe;
use crate::options::{Options, Origin};
use crate::pipeline::audience::Audience;
use crate::pipeline::content_hash::ContentHash;
use crate::pipeline::failure::Failure;
use crate::pipeline::studio::{Run, Studio};
use crate::pipeline::viewpoint;
use crate::pipeline::world::World;
use crate::scene::Scene;
use std::path::Path;
use std::sync::atomic::{AtomicBool, Ordering};
use std::time::Duration;

/// Longer side in pixels of the pictures that are compared, unless the user says how large they are.
const SIDE: f64 = 240.0;
/// A rung may take so many times what was expected before it is stopped, and always this part of what is left: what was once stopped is
/// measured when there is more time.
const PATIENCE: f64 = 3.0;
const FIRST_SHARE: f64 = 0.25;
/// How often the clock is looked at.
const TICK: Duration = Duration::from_millis(20);

/// What is wanted.
#[derive(Clone, Copy, Debug)]
pub struct Plan {
    /// Seconds for everything.
    pub budget: f64,
    /// How many other random numbers are tried for each setting, at least 2.
    pub seeds: u32,
}

/// What measuring needs besides the model.
#[derive(Clone, Copy)]
pub struct Means<'a> {
    /// Files and the clock.
    pub world: &'a dyn World,
    /// Who is told how far it is.
    pub audience: &'a dyn Audience,
    /// The wish to stop.
    pub cancel: &'a CancelToken,
}

/// One measurement.
pub(super) struct Session<'a> {
    pub(super) means: Means<'a>,
    pub(super) plan: Plan,
    pub(super) folder: &'a Folder<'a>,
    pub(super) scene: &'a Scene,
    /// Of the pictures that are compared.
    pub(super) options: Options,
    /// The wanted view, and the same a little later.
    pub(super) cameras: [Camera; 2],
    /// When it began, and the seconds that earlier runs have used.
    pub(super) start: Duration,
    pub(super) findings: Findings,
    /// What earlier runs have measured.
    pub(super) known: Vec<Measured>,
}

/// Measures the model of a run into the folder, and gives all that is known by then. What an earlier run has measured is not
/// measured again.
///
/// # Errors
/// If the model cannot be a scene, files cannot be written, or it was stopped: what is measured by then is kept.
pub fn measure(
    studio: &mut Studio<'_>,
    run: &Run,
    (folder, plan): (&Folder<'_>, Plan),
    means: Means<'_>,
) -> Result<Findings, Failure> {
    let scene = studio.build(run, means.cancel)?;
    let wanted = run.options.size.value;
    let mut options = run.options.clone();
    if options.size.origin != Origin::Flag {
        let scale = (SIDE / f64::from(wanted.width.max(wanted.height))).min(1.0);
        let side = |pixels: u32| ((f64::from(pixels) * scale).round() as u32).max(1);
        let size = format!("{}x{}", side(wanted.width), side(wanted.height));
        set(&mut options, "size", &size);
    }
    set(&mut options, "time", "none");
    let size = [options.size.value.width, options.size.value.height];
    let view = viewpoint::of_scene(&options, &scene);
    let cameras =
        [view, orbit(&view, TURN)].map(|view| viewpoint::camera(&run.sources, &options, &view));
    let [first, second] = cameras;
    let pixels = |[width, height]: [u32; 2]| f64::from(width) * f64::from(height);
    let before = folder.findings();
    let session = Session {
        means,
        plan,
        folder,
        scene: &scene,
        cameras: [first?, second?],
        start: means.world.now(),
        findings: Findings {
            understory_trade: env!("CARGO_PKG_VERSION").into(),
            model: short_name(run.sources.name()),
            model_hash: run.sources.model_hash.to_string(),
            size,
            scale: pixels([wanted.width, wanted.height]) / pixels(size),
            threads: rayon::current_num_threads(),
            seeds: plan.seeds,
            budget: plan.budget,
            used: 0.0,
            reference: before
                .as_ref()
                .map(|b| b.reference.clone())
                .unwrap_or_default(),
            families: vec![],
            earlier: vec![],
        },
        known: before.map_or_else(Vec::new, Findings::into_rungs),
        options,
    };
    let objects = Objects::seen(&scene, &session.cameras[0], size, studio.organs.as_deref());
    let key = Run {
        options: session.options.clone(),
        ..run.clone()
    }
    .picture_key();
    session.all(key, objects)
}

impl Session<'_> {
    pub(super) fn elapsed(&self) -> f64 {
        self.means
            .world
            .now()
            .saturating_sub(self.start)
            .as_secs_f64()
    }

    fn left(&self) -> f64 {
        self.plan.budget - self.elapsed()
    }

    /// The reference, then all ladders.
    fn all(mut self, key: ContentHash, objects: Objects) -> Result<Findings, Failure> {
        self.means.audience.begins("measuring the reference");
        let halves = self.reference(key)?;
        let standard = self.standard(&halves, objects)?;
        self.means.audience.begins("measuring");
        let needs = Needs {
            has_specular: self
                .scene
                .materials()
                .iter()
                .any(|m| m.lobes.iter().any(Lobe::is_delta)),
            radius: 0.5 * self.scene.bounds().diagonal().length(),
        };
        let only = &self.options.renderer;
        let only = (only.origin == Origin::Flag).then_some(only.value);
        let families = ladder::families(needs, only);
        self.findings.families = families.iter().map(empty).collect();
        let mut climbs: Vec<Climb<'_>> = families.iter().map(Climb::new).collect();
        // Always the cheapest next rung: all ladders are climbed to the same cost.
        while let Some(nth) = cheapest(&climbs) {
            self.step(nth, &mut climbs[nth], &standard)?;
            self.tell();
        }
        self.keep()?;
        self.means.audience.ends();
        Ok(self.findings)
    }

    /// Keeps what is known by now, and what earlier runs knew.
    pub(super) fn keep(&mut self) -> Result<(), Failure> {
        self.findings.used = self.elapsed();
        let is_new = |known: &&Measured| {
            let mut rungs = self
                .findings
                .families
                .iter()
                .flat_map(|ladder| &ladder.rungs);
            !rungs.any(|rung| rung.key == known.key)
        };
        self.findings.earlier = self.known.iter().filter(is_new).cloned().collect();
        self.folder.keep(&self.findings)
    }

    /// Measures the next rung of a family, unless it is known or will not be done in time.
    fn step(
        &mut self,
        nth: usize,
        climb: &mut Climb<'_>,
        standard: &Standard,
    ) -> Result<(), Failure> {
        let (family, at) = (climb.family, climb.costs.len());
        let rung = &family.rungs[at];
        let key = self.key(family, rung);
        if let Some(known) = self.known(&key) {
            climb.cost((known.solve + known.first + known.view) * f64::from(self.plan.seeds));
            // Two families may share a setting, each with a knob of its own.
            let knob = rung.knob;
            self.findings.families[nth]
                .rungs
                .push(Measured { knob, ..known });
            return Ok(());
        }
        let left = self.left();
        let limit = match climb.expected() {
            None => FIRST_SHARE * left,
            Some(seconds) if seconds > left => 0.0,
            Some(seconds) => (PATIENCE * seconds).max(FIRST_SHARE * left).min(left),
        };
        if limit <= 0.0 {
            climb.is_done = true;
            self.findings.families[nth].end = Some("the budget".into());
            return Ok(());
        }
        let begin = self.elapsed();
        let name = format!("{}-{at}-{}", family.name.replace([',', ' '], ""), &key[..6]);
        match self.within(limit, |stop| {
            self.rung(family, rung, standard, (&name, stop))
        }) {
            Ok(measured) => {
                climb.cost(self.elapsed() - begin);
                let measured = Measured { key, ..measured };
                self.findings.families[nth].rungs.push(measured);
                self.keep()
            }
            Err(Failure::Stopped) if !self.means.cancel.is_cancelled() => {
                climb.is_done = true;
                let why = format!("the next setting takes longer than {limit:.0} s");
                self.findings.families[nth].end = Some(why);
                Ok(())
            }
            Err(Failure::World(why)) => {
                climb.is_done = true;
                self.findings.families[nth].end = Some(why);
                Ok(())
            }
            Err(failure) => Err(failure),
        }
    }

    /// What was measured of this setting, now or earlier.
    fn known(&self, key: &str) -> Option<Measured> {
        let now = self
            .findings
            .families
            .iter()
            .flat_map(|ladder| &ladder.rungs);
        now.chain(&self.known)
            .find(|known| known.key == key)
            .cloned()
    }

    fn key(&self, family: &Family, rung: &Rung) -> String {
        let options = self.options_of(family.renderer, rung);
        let mut key = ContentHash::of([self.findings.reference.key.as_bytes()])
            .with(&format!("{}", self.plan.seeds));
        for entry in options.entries() {
            key = key.with(entry.row.key).with(&entry.canonical());
        }
        key.to_string()
    }

    /// Works until it is done, the user wants to stop, or so many seconds are over.
    fn within<T: Send>(
        &self,
        seconds: f64,
        work: impl FnOnce(&CancelToken) -> Result<T, Failure> + Send,
    ) -> Result<T, Failure> {
        let (stop, is_done) = (CancelToken::default(), AtomicBool::new(false));
        let end = self.elapsed() + seconds;
        std::thread::scope(|scope| {
            scope.spawn(|| {
                while !is_done.load(Ordering::Relaxed) {
                    if self.elapsed() >= end || self.means.cancel.is_cancelled() {
                        stop.cancel();
                    }
                    std::thread::sleep(TICK);
                }
            });
            let result = work(&stop);
            is_done.store(true, Ordering::Relaxed);
            result
        })
    }

    pub(super) fn tell(&self) {
        let milliseconds = |seconds: f64| (1000.0 * seconds) as u64;
        let all = milliseconds(self.plan.budget);
        self.means
            .audience
            .progress(milliseconds(self.elapsed()).min(all), all);
    }
}

/// The results of a family before there are any.
fn empty(family: &Family) -> Ladder {
    Ladder {
        name: family.name.into(),
        knob: family.knob.into(),
        is_contender: family.is_contender,
        has_floor: family.floor == Floor::Some,
        theory: family.theory,
        rungs: vec![],
        end: None,
    }
}

/// The name of a file without its folder.
fn short_name(path: &str) -> String {
    let name = Path::new(path).file_name();
    name.map_or_else(
        || path.to_owned(),
        |name| name.to_string_lossy().into_owned(),
    )
}
