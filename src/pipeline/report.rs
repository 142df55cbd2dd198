//! What was done, what it took, and what came out: the object that `--report` writes.

use super::content_hash::ContentHash;
use super::lighting::FoundLight;
use super::studio::Run;
use super::world::World;
use crate::animation::flicker::Flicker;
use crate::diag::SourceMap;
use crate::film::ErrorEstimate;
use crate::integrator::requirements::{Finding, Requirements};
use crate::options::{Options, explain};
use serde::Serialize;
use std::collections::BTreeMap;
use std::time::Duration;

/// Distance of the ends of an interval that holds 95 % of a normal distribution from its middle, in standard deviations.
pub(super) const Z_95: f64 = 1.959_964;

/// Keys by which an earlier report is known when it is to be replaced.
pub const REPORT_KEYS: &[&str] = &["version", "model_hash", "seconds", "image_hash"];

/// A part of a run that takes time.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Phase {
    /// Reading and checking the model.
    Read,
    /// Growing it.
    Derive,
    /// Turning the grown graph into shapes, materials and lights.
    Scene,
    /// Building the acceleration structure.
    Accel,
    /// View-independent preparation of the renderer, and deciding the exposure.
    Prepare,
    /// Tracing light.
    Render,
    /// Finding out how wrong the picture is.
    Check,
    /// Encoding and writing.
    Write,
}

/// Seconds spent in each phase.
#[derive(Clone, Debug, Default, PartialEq, Serialize)]
pub struct PhaseSeconds {
    /// See [`Phase::Read`].
    pub read: f64,
    /// See [`Phase::Derive`].
    pub derive: f64,
    /// See [`Phase::Scene`].
    pub scene: f64,
    /// See [`Phase::Accel`].
    pub accel: f64,
    /// See [`Phase::Prepare`].
    pub prepare: f64,
    /// See [`Phase::Render`].
    pub render: f64,
    /// See [`Phase::Check`].
    pub check: f64,
    /// See [`Phase::Write`].
    pub write: f64,
}

impl PhaseSeconds {
    /// Adds time to a phase.
    pub fn add(&mut self, phase: Phase, time: Duration) {
        let total = match phase {
            Phase::Read => &mut self.read,
            Phase::Derive => &mut self.derive,
            Phase::Scene => &mut self.scene,
            Phase::Accel => &mut self.accel,
            Phase::Prepare => &mut self.prepare,
            Phase::Render => &mut self.render,
            Phase::Check => &mut self.check,
            Phase::Write => &mut self.write,
        };
        *total += time.as_secs_f64();
    }

    /// Adds the time of all phases.
    pub fn merge(&mut self, other: &Self) {
        self.read += other.read;
        self.derive += other.derive;
        self.scene += other.scene;
        self.accel += other.accel;
        self.prepare += other.prepare;
        self.render += other.render;
        self.check += other.check;
        self.write += other.write;
    }

    /// Does some work and adds its time to a phase.
    pub fn time<T>(&mut self, world: &dyn World, phase: Phase, work: impl FnOnce() -> T) -> T {
        let start = world.now();
        let result = work();
        self.add(phase, world.now().saturating_sub(start));
        result
    }

    /// Seconds for light: what a wanted time is that of, models grown and scenes built.
    pub(super) fn of_light(&self) -> f64 {
        self.prepare + self.render + self.check
    }

    /// Phases that took noticeable time, for a line of status: `derive 0.52 s, render 3.10 s`.
    pub fn summary(&self) -> String {
        let phases = [
            ("read", self.read),
            ("derive", self.derive),
            ("scene", self.scene),
            ("accel", self.accel),
            ("prepare", self.prepare),
            ("render", self.render),
            ("check", self.check),
            ("write", self.write),
        ];
        let noticeable = phases.iter().filter(|(_, seconds)| *seconds >= 0.005);
        let parts: Vec<String> = noticeable
            .map(|(name, seconds)| format!("{name} {seconds:.2} s"))
            .collect();
        if parts.is_empty() {
            "nothing to do".into()
        } else {
            parts.join(", ")
        }
    }
}

/// How often each stage has run since the program began: `watch` repeats only what a change touches.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize)]
pub struct Work {
    /// Texts read and checked.
    pub checks: u64,
    /// Models grown, from their beginning or on from the last step before an edit matters.
    pub growths: u64,
    /// Steps of growth that were made.
    pub steps: u64,
    /// Steps that were taken over from the growth before.
    pub kept_steps: u64,
    /// Graphs turned into shapes.
    pub drawings: u64,
    /// Acceleration structures built.
    pub accels: u64,
    /// Prototypes (parts that are drawn many times) that one was built for.
    pub prototypes: u64,
    /// Prototypes that kept theirs from the scene before.
    pub kept_prototypes: u64,
    /// Scenes set up: with other light or colours, say, round shapes that are there.
    pub scenes: u64,
    /// View-independent solutions of a renderer.
    pub solutions: u64,
    /// Pictures begun.
    pub views: u64,
}

/// What tracing light amounted to.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Effort {
    /// Rays traced.
    pub n_rays: u64,
    /// Samples in each pixel (the fewest, if not all have equally many).
    pub samples_per_pixel: u32,
    /// Samples of all pixels together.
    pub n_samples: u64,
    /// Estimated error of the picture (the largest that is known, of several); `None` if it cannot be told.
    pub error: Option<PictureError>,
}

/// What an estimate of an error covers.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize)]
pub enum Covers {
    /// The noise of the samples. All there is, of a method without bias.
    #[default]
    #[serde(rename = "noise")]
    Noise,
    /// Whatever is wrong with the picture: a [`spot_check`](super::spot_check).
    #[serde(rename = "noise and bias")]
    NoiseAndBias,
}

/// Estimated root mean square of the pixels' relative errors of luminance; 0.02 means "2 %".
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct PictureError {
    /// The estimate.
    pub relative: f64,
    /// The error is larger than this …
    pub low: f64,
    /// … and smaller than this, with 95 % probability.
    pub high: f64,
    /// What it covers.
    pub covers: Covers,
}

impl PictureError {
    /// The noise of a film.
    pub fn of_noise(noise: &ErrorEstimate) -> Self {
        let reach = Z_95 * noise.uncertainty;
        Self {
            relative: noise.relative,
            low: (noise.relative - reach).max(0.0),
            high: noise.relative + reach,
            covers: Covers::Noise,
        }
    }

    /// The estimate with its uncertainty and what it covers: `1.8 % ± 0.2 %, noise and bias`.
    pub fn text(&self) -> String {
        let covers = match self.covers {
            Covers::Noise => "noise",
            Covers::NoiseAndBias => "noise and bias",
        };
        let percent = |error: f64| format!("{:.1} %", 100.0 * error);
        if self.low <= 0.0 && self.high > 0.0 {
            return format!("below {}, {covers}", percent(self.high));
        }
        let reach = (self.high - self.relative).max(self.relative - self.low);
        let (error, reach) = (percent(self.relative), percent(reach));
        format!("{error} ± {reach}, {covers}")
    }
}

impl Effort {
    /// This and another picture of the same film.
    #[must_use]
    pub fn and(self, other: Self) -> Self {
        let worst = |a: PictureError, b: PictureError| if a.relative < b.relative { b } else { a };
        Self {
            n_rays: self.n_rays + other.n_rays,
            samples_per_pixel: self.samples_per_pixel.min(other.samples_per_pixel),
            n_samples: self.n_samples + other.n_samples,
            error: self.error.into_iter().chain(other.error).reduce(worst),
        }
    }
}

/// Where the light that all cameras share came from.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize)]
#[serde(rename_all = "lowercase")]
pub enum SolutionOrigin {
    /// It was solved for this run.
    Made,
    /// It was there from the run before.
    Kept,
    /// It was read from a file.
    Read,
}

/// The light that all cameras share, as reports tell of it. All `None` for methods that have none.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct SolutionFacts {
    /// Where it came from.
    pub origin: Option<SolutionOrigin>,
    /// Photons emitted and photons stored for it, whenever that was.
    pub photons: Option<(u64, u64)>,
    /// Patches into which surfaces were cut for it.
    pub patches: Option<u64>,
    /// Part of all light that was still missing when it was left.
    pub residual: Option<f64>,
}

/// Something that a scene requires or not.
#[derive(Serialize)]
struct RequirementFact<'a> {
    feature: &'static str,
    /// `needed`, `left out` or `kept`.
    state: &'static str,
    why: &'a str,
}

#[derive(Serialize)]
struct OptionValue<'a> {
    value: &'a str,
    origin: String,
}

/// The object that `--report` writes.
#[derive(Serialize)]
pub struct Report<'a> {
    version: &'static str,
    model_hash: String,
    seed: i64,
    options: BTreeMap<&'static str, OptionValue<'a>>,
    seconds: &'a PhaseSeconds,
    rays: u64,
    samples_per_pixel: u32,
    /// Where the light that all cameras share came from.
    solution: Option<SolutionOrigin>,
    /// How often it was solved: 1 for all frames of a film, 0 if it was there already.
    solves: u32,
    /// Photons emitted for it.
    photons_emitted: Option<u64>,
    /// Photons stored for it.
    photons_stored: Option<u64>,
    /// Patches into which radiosity cut the surfaces.
    patches: Option<u64>,
    /// No method of this version has a solver.
    solver_residual: Option<f64>,
    relative_error: Option<f64>,
    /// What holds it with 95 % probability.
    relative_error_interval: Option<[f64; 2]>,
    /// What it covers: noise, or noise and bias.
    relative_error_covers: Option<Covers>,
    peak_memory_bytes: Option<u64>,
    image_hash: String,
    /// How often each stage has run.
    work: Work,
    /// What the pictures lack without showing it.
    warnings: &'a [&'static str],
    /// What the scene requires, and what was left out.
    requirements: Vec<RequirementFact<'a>>,
    /// How much a film flickers.
    flicker: Option<Flicker>,
    /// Frames that were made, and frames that were there already.
    frames: Option<(u32, u32)>,
}

/// Keys by which an earlier report of `light` is known when it is to be replaced.
pub const LIGHT_REPORT_KEYS: &[&str] = &["version", "model_hash", "seconds", "table_hash"];

/// The object that `light --report` writes. Powers in W, summed over red, green and blue.
#[derive(Serialize)]
pub struct LightReport<'a> {
    version: &'static str,
    model_hash: String,
    seed: i64,
    options: BTreeMap<&'static str, OptionValue<'a>>,
    seconds: &'a PhaseSeconds,
    rays: u64,
    photons_emitted: u64,
    organs: usize,
    /// By organs together, and its standard error.
    absorbed: f64,
    absorbed_error: f64,
    reflected: f64,
    transmitted: f64,
    /// By what belongs to no organ, such as the ground.
    absorbed_elsewhere: f64,
    /// emitted = absorbed by all + escaped + lost + roulette.
    emitted: f64,
    escaped: f64,
    lost: f64,
    roulette: f64,
    books_balance: bool,
    error_reached: bool,
    peak_memory_bytes: Option<u64>,
    table_hash: String,
}

impl<'a> LightReport<'a> {
    /// The report of a run whose table has the hash `table`.
    pub fn new(
        world: &dyn World,
        run: &'a Run,
        seconds: &'a PhaseSeconds,
        found: &FoundLight,
        table: ContentHash,
    ) -> Self {
        let lighting = &found.lighting;
        let (total, books) = (&lighting.total, &lighting.books);
        Self {
            version: env!("CARGO_PKG_VERSION"),
            model_hash: run.sources.model_hash.to_string(),
            seed: run.options.seed.value,
            options: values(&run.options, &run.sources.map),
            seconds,
            rays: lighting.n_rays,
            photons_emitted: lighting.n_photons,
            organs: lighting.organs.len(),
            absorbed: total.absorbed.sum(),
            absorbed_error: total.errors.absorbed,
            reflected: total.reflected.sum(),
            transmitted: total.transmitted.sum(),
            absorbed_elsewhere: lighting.rest.absorbed.sum(),
            emitted: books.emitted.sum(),
            escaped: books.escaped.sum(),
            lost: books.lost.sum(),
            roulette: books.roulette.sum(),
            books_balance: books.is_balanced,
            error_reached: lighting.is_reached,
            peak_memory_bytes: world.peak_memory(),
            table_hash: table.to_string(),
        }
    }
}

/// All options with their values and who set them.
fn values<'a>(
    options: &'a Options,
    sources: &SourceMap,
) -> BTreeMap<&'static str, OptionValue<'a>> {
    let values = options.entries().into_iter().map(|entry| {
        let origin = explain::describe(entry.origin, sources);
        (
            entry.row.key,
            OptionValue {
                value: entry.text,
                origin,
            },
        )
    });
    values.collect()
}

impl<'a> Report<'a> {
    /// The report of a run whose result has the hash `image`.
    pub fn new(
        world: &dyn World,
        model: (&SourceMap, ContentHash),
        options: &'a Options,
        seconds: &'a PhaseSeconds,
        effort: Effort,
        image: ContentHash,
    ) -> Self {
        let (sources, model_hash) = model;
        Self {
            version: env!("CARGO_PKG_VERSION"),
            model_hash: model_hash.to_string(),
            seed: options.seed.value,
            options: values(options, sources),
            seconds,
            rays: effort.n_rays,
            samples_per_pixel: effort.samples_per_pixel,
            solution: None,
            solves: 0,
            photons_emitted: None,
            photons_stored: None,
            patches: None,
            solver_residual: None,
            relative_error: effort.error.map(|error| error.relative),
            relative_error_interval: effort.error.map(|error| [error.low, error.high]),
            relative_error_covers: effort.error.map(|error| error.covers),
            peak_memory_bytes: world.peak_memory(),
            image_hash: image.to_string(),
            work: Work::default(),
            warnings: &[],
            requirements: Vec::new(),
            flicker: None,
            frames: None,
        }
    }

    /// The same report, which also tells of the light that all cameras share.
    #[must_use]
    pub fn solved(self, facts: SolutionFacts) -> Self {
        Self {
            solution: facts.origin,
            solves: u32::from(facts.origin == Some(SolutionOrigin::Made)),
            photons_emitted: facts.photons.map(|(emitted, _)| emitted),
            photons_stored: facts.photons.map(|(_, stored)| stored),
            patches: facts.patches,
            solver_residual: facts.residual,
            ..self
        }
    }

    /// The same report, of a film: frames made, frames kept, and how much it flickers.
    #[must_use]
    pub fn flown(self, made: u32, kept: u32, flicker: Option<Flicker>) -> Self {
        Self {
            frames: Some((made, kept)),
            flicker,
            ..self
        }
    }

    /// The same report, which also tells what the pictures lack.
    #[must_use]
    pub fn warning(self, warnings: &'a [&'static str]) -> Self {
        Self { warnings, ..self }
    }

    /// The same report, which also tells what the scene requires.
    #[must_use]
    pub fn requiring(self, requirements: Option<&'a Requirements>) -> Self {
        let findings = requirements.into_iter().flat_map(Requirements::findings);
        let fact = |found: &'a Finding| RequirementFact {
            feature: found.feature.name(),
            state: found.state.words(),
            why: &found.why,
        };
        Self {
            requirements: findings.map(fact).collect(),
            ..self
        }
    }

    /// The same report, which also tells how often each stage has run.
    #[must_use]
    pub fn working(self, work: Work) -> Self {
        Self { work, ..self }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::pipeline::world::fake::FakeWorld;

    #[test]
    fn a_report_names_each_option_with_its_origin_and_is_known_again() {
        let world = FakeWorld::default();
        let mut seconds = PhaseSeconds::default();
        let answer = seconds.time(&world, Phase::Derive, || 42);
        assert_eq!((answer, seconds.derive, seconds.render), (42, 0.01, 0.0));
        assert_eq!(seconds.summary(), "derive 0.01 s");
        let hash = ContentHash::of([]);
        let options = Options::default();
        let sources = SourceMap::default();
        let model = (&sources, hash);
        let report = Report::new(&world, model, &options, &seconds, Effort::default(), hash);
        let json = serde_json::to_value(&report).unwrap();
        assert!(REPORT_KEYS.iter().all(|key| json.get(key).is_some()));
        assert_eq!(json["options"]["samples"]["origin"], "default");
        assert_eq!(json["options"]["samples"]["value"], "64");
        assert!(json["photons_stored"].is_null() && json["relative_error"].is_null());
    }

    #[test]
    fn the_error_of_a_film_is_that_of_its_worst_frame() {
        let error = |relative: f64| PictureError {
            relative,
            low: relative - 0.01,
            high: relative + 0.02,
            covers: Covers::NoiseAndBias,
        };
        let one = Effort {
            n_rays: 5,
            samples_per_pixel: 4,
            n_samples: 40,
            error: Some(error(0.1)),
        };
        let other = Effort {
            n_rays: 6,
            samples_per_pixel: 2,
            n_samples: 20,
            error: Some(error(0.3)),
        };
        let both = Effort {
            n_rays: 11,
            samples_per_pixel: 2,
            n_samples: 60,
            error: Some(error(0.3)),
        };
        assert_eq!(error(0.1).text(), "10.0 % ± 2.0 %, noise and bias");
        assert_eq!(one.and(other), both);
        let unknown = Effort {
            error: None,
            ..other
        };
        assert_eq!(one.and(unknown).error, one.error);
        assert_eq!(unknown.and(one).error, one.error);
    }
}
