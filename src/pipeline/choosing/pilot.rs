//! Trying methods on a few pixels of the picture that is wanted.
//!
//! The pixels are path traced once, as truth; what a method makes of the same pixels then tells its noise, its bias and its seconds.

use super::Wish;
use super::law::Law;
use crate::camera::Camera;
use crate::integrator::driver::{FilmSettings, Refinement};
use crate::integrator::{RadianceEstimator, RenderContext, RenderError, Solution};
use crate::pipeline::failure::Failure;
use crate::pipeline::spot_check::{SPOTS, Spots, SquaredError};
use crate::pipeline::viewing::{Viewing, failure};
use crate::scene::Scene;

/// Samples of each pixel to begin with, half of them for each estimate.
const FIRST_SAMPLES: u32 = 2;
/// Samples of each pixel at least, for a wanted error, however small the picture is.
const FEWEST: f64 = 64.0;
/// Samples of each pixel at most.
const MOST_SAMPLES: u32 = 1 << 18;
/// Samples that a method takes of each pixel, and those of them that tell what the view costs once.
const SAMPLES: u32 = 16;
const COLD_SAMPLES: u32 = 2;
/// Samples that it takes at most, where fewer do not tell its noise well enough.
const MOST_TRIED: u32 = 256;
/// The squared error of another method is to be known to this part of the squared error that is wanted: as far as noise of the truth
/// goes, and its own.
const PRECISION: f64 = 0.15;
const OWN_PRECISION: f64 = 0.05;
/// Part of the wanted time for which the truth is sampled.
const PART_OF_TIME: f64 = 0.05;
/// Part of the samples of a whole path-traced picture that its pilot takes at most.
const PART_OF_SAMPLES: f64 = 0.05;
/// Samples of each pixel for a glance, at most.
const GLANCE: u32 = 16;

/// Some pixels of a picture and their truth.
pub struct Pilot<'s> {
    /// Path tracing, ready: what all else is judged by.
    pub judge: Box<dyn RadianceEstimator + 's>,
    /// The pixels with their samples by path tracing.
    truth: Spots,
    /// What path tracing costs and how noisy it is.
    pub path: Law,
    /// Seconds of a sample of a single pixel by path tracing.
    pub seconds_of_sample: f64,
    /// Pixels of the picture for each of these.
    share: f64,
    /// The squared error that is wanted, if one is.
    wanted: Option<f64>,
}

impl<'s> Pilot<'s> {
    /// Path traces the pixels: as long as the wish lets, or until they are known well enough to judge others by.
    ///
    /// # Errors
    /// If it was stopped.
    pub fn new(
        viewing: &Viewing<'_>,
        scene: &'s Scene,
        camera: &Camera,
        wish: Wish,
    ) -> Result<Self, Failure> {
        let n_pixels = viewing.options.size.value.pixels() as f64;
        let is_enough = |truth: &Spots, samples: u32, passed: f64| match wish {
            // The next step takes as long as all before.
            Wish::Seconds(seconds) => 2.0 * passed > PART_OF_TIME * seconds,
            Wish::Error(error) => {
                let is_known = truth.judge_error() <= PRECISION * error * error;
                let n = f64::from(samples);
                let n_spots = truth.pixels.len().max(1) as f64;
                let whole = truth.noise().mean * n / (error * error) * n_pixels / n_spots;
                n >= FEWEST && (is_known || n >= PART_OF_SAMPLES * whole)
            }
        };
        let begin = viewing.world.now();
        let judge = viewing.judge(scene)?;
        let shared = viewing.world.now().saturating_sub(begin).as_secs_f64();
        let (truth, path) = sampled(viewing, (&*judge, camera), is_enough)?;
        let path = Law { shared, ..path };
        let share = n_pixels / truth.pixels.len().max(1) as f64;
        Ok(Self {
            judge,
            truth,
            path,
            seconds_of_sample: path.sample / n_pixels.max(1.0),
            share,
            wanted: match wish {
                Wish::Error(error) => Some(error * error),
                Wish::Seconds(_) => None,
            },
        })
    }

    /// What path tracing by a judge that is ready costs and how noisy it is, from few samples that take no more than about so many seconds:
    /// enough to compare views.
    ///
    /// # Errors
    /// If it was stopped.
    pub fn glance(
        viewing: &Viewing<'_>,
        (judge, camera): (&dyn RadianceEstimator, &Camera),
        seconds: f64,
    ) -> Result<Law, Failure> {
        let is_enough =
            |_: &Spots, samples: u32, passed: f64| samples >= GLANCE || 2.0 * passed > seconds;
        sampled(viewing, (judge, camera), is_enough).map(|(_, path)| path)
    }

    /// Samples of each pixel that were taken for the truth.
    #[must_use]
    pub fn samples(&self) -> u32 {
        self.truth.samples()
    }

    /// What the method of the options of `viewing` costs and how wrong it is, given the light that all views share and the seconds
    /// that it took.
    ///
    /// # Errors
    /// If it was stopped.
    pub fn measure(
        &self,
        viewing: &Viewing<'_>,
        (scene, camera): (&Scene, &Camera),
        (solution, shared): (&Solution, f64),
    ) -> Result<Law, Failure> {
        let world = viewing.world;
        let now = || world.now().as_secs_f64();
        let begin = now();
        let prepared = viewing.prepare(scene, solution)?;
        let context = viewing.context(viewing.cancel, &|_| {});
        let settings = everywhere(viewing);
        let mut shots = self.truth.emptied();
        let sample = |shots: &mut Spots, n: u32| -> Result<f64, RenderError> {
            shots.sample(&*prepared.estimator, camera, &settings, n, &context)?;
            Ok(now())
        };
        let cold = sample(&mut shots, COLD_SAMPLES).map_err(|error| failure(&error))?;
        let warm = sample(&mut shots, SAMPLES).map_err(|error| failure(&error))?;
        let each = (warm - cold) / f64::from(SAMPLES - COLD_SAMPLES);
        let once = (cold - begin - f64::from(COLD_SAMPLES) * each).max(0.0);
        let mut noise = shots.noise();
        let mut n = SAMPLES;
        let is_vague = |noise: SquaredError| {
            let wanted = self.wanted;
            wanted.is_some_and(|wanted| noise.standard_error > OWN_PRECISION * wanted)
        };
        while n < MOST_TRIED && is_vague(noise) {
            n *= 2;
            sample(&mut shots, n).map_err(|error| failure(&error))?;
            noise = shots.noise();
        }
        let seen = self.truth.error_of(&shots.luminances());
        let bias = without(seen, noise);
        Ok(Law {
            shared,
            // What is gathered and kept for neighbouring pixels grows with the picture, but more slowly: between not at all and in
            // proportion.
            begin: once * self.share.max(1.0).sqrt(),
            sample: each * self.share,
            noise: noise.mean * f64::from(n),
            bias: bias.mean,
            bias_error: bias.standard_error,
            judge_error: self.truth.judge_error().min(bias.standard_error),
        })
    }
}

/// Path traces some pixels of the picture, twice as many samples in each step, until these samples, which took so many seconds, are enough.
fn sampled(
    viewing: &Viewing<'_>,
    (judge, camera): (&dyn RadianceEstimator, &Camera),
    is_enough: impl Fn(&Spots, u32, f64) -> bool,
) -> Result<(Spots, Law), Failure> {
    let world = viewing.world;
    let begin = world.now();
    let passed = || world.now().saturating_sub(begin).as_secs_f64();
    let size = viewing.options.size.value;
    let context = RenderContext {
        seed: viewing.check_seed(2),
        ..viewing.context(viewing.cancel, &|_| {})
    };
    let mut truth = Spots::draw((size.width, size.height), SPOTS, context.seed);
    let settings = everywhere(viewing);
    let mut samples = FIRST_SAMPLES;
    loop {
        truth
            .sample(judge, camera, &settings, samples, &context)
            .map_err(|error| failure(&error))?;
        if samples >= MOST_SAMPLES || is_enough(&truth, samples, passed()) {
            break;
        }
        samples *= 2;
    }
    let n_spots = truth.pixels.len().max(1) as f64;
    let path = Law {
        sample: passed() / (f64::from(samples) * n_spots) * size.pixels() as f64,
        noise: truth.noise().mean * f64::from(samples),
        ..Law::default()
    };
    Ok((truth, path))
}

/// An error without that part of it.
fn without(whole: SquaredError, part: SquaredError) -> SquaredError {
    SquaredError {
        mean: whole.mean - part.mean,
        standard_error: whole.standard_error.hypot(part.standard_error),
    }
}

/// The picture that is wanted, with all samples for all pixels.
fn everywhere(viewing: &Viewing<'_>) -> FilmSettings {
    FilmSettings {
        refinement: Refinement::Everywhere,
        ..viewing.settings()
    }
}
