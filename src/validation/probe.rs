//! Looking at a small scene with the estimator that makes the pictures.

use crate::integrator::{CancelToken, Integrator, Path, RayCounts, RenderContext};
use crate::math::stats::RunningStats;
use crate::math::{Ray, rng};
use crate::sampler::{Sampler, SamplerKind, Use};
use crate::scene::Scene;
use glam::{DVec2, DVec3};

/// Independent observations of a mean, at least: the normal law holds for their mean, and their spread is known.
const FEWEST: u64 = 256;

/// Independent observations of a mean, at most.
const MOST: u64 = 60_000;

/// The ray to look along, from two uniform numbers: as a camera chooses a place in a pixel.
pub type Look = Box<dyn Fn(DVec2) -> Ray + Send + Sync>;

/// A scene, and how it is looked at.
pub struct Experiment {
    /// What is looked at.
    pub scene: Scene,
    /// The path tracer's settings.
    pub path: Path,
    /// Along which rays.
    pub look: Look,
    /// What the mean green radiance is multiplied by to give the number that is wanted.
    pub scale: f64,
    /// Samples of one observation, spread together; a power of two.
    pub spread: u32,
}

impl Experiment {
    /// A look with the path tracer's own settings, in observations of 16 samples.
    #[must_use]
    pub fn new(scene: Scene, look: Look) -> Self {
        Self {
            scene,
            path: Path::default(),
            look,
            scale: 1.0,
            spread: 16,
        }
    }

    /// With other settings of the path tracer.
    #[must_use]
    pub fn by(self, path: Path) -> Self {
        Self { path, ..self }
    }

    /// With what is seen multiplied by this.
    #[must_use]
    pub fn times(self, scale: f64) -> Self {
        Self { scale, ..self }
    }

    /// With so many samples in one observation.
    #[must_use]
    pub fn spread(self, spread: u32) -> Self {
        Self { spread, ..self }
    }

    /// Observes until `is_enough` or somebody cancels; streams of random numbers begin from `seed`.
    pub fn observe(
        &self,
        seed: u64,
        cancel: &CancelToken,
        is_enough: impl Fn(&RunningStats) -> bool,
    ) -> RunningStats {
        let context = RenderContext {
            seed,
            cancel,
            progress: &|_| {},
        };
        let mut seen = RunningStats::default();
        // Without an estimator (cancelled) there are no observations, and nobody asks.
        let Ok(estimator) = self.path.prepare(&self.scene, &context) else {
            return seen;
        };
        while seen.n() < FEWEST || (seen.n() < MOST && !is_enough(&seen)) {
            if cancel.is_cancelled() {
                break;
            }
            let stream = rng::hash(&[seed, seen.n()]);
            let samples = (0..self.spread).map(|index| {
                let mut sampler = Sampler::new(SamplerKind::OwenSobol, stream, index);
                let ray = (self.look)(sampler.point(Use::Direction));
                let mut rays = RayCounts::default();
                estimator.incident_radiance(&ray, &mut sampler, &mut rays).g
            });
            let mean = samples.sum::<f64>() / f64::from(self.spread);
            seen.push(mean * self.scale);
        }
        seen
    }

    /// A single sample, where nothing is left to chance.
    #[must_use]
    pub fn once(&self) -> f64 {
        let cancel = CancelToken::default();
        let context = RenderContext {
            seed: 0,
            cancel: &cancel,
            progress: &|_| {},
        };
        let Ok(estimator) = self.path.prepare(&self.scene, &context) else {
            return f64::NAN;
        };
        let mut sampler = Sampler::new(SamplerKind::OwenSobol, 0, 0);
        let ray = (self.look)(sampler.point(Use::Direction));
        let mut rays = RayCounts::default();
        let seen = estimator.incident_radiance(&ray, &mut sampler, &mut rays);
        seen.g * self.scale
    }
}

/// Always along the same ray.
#[must_use]
pub fn along(origin: DVec3, direction: DVec3) -> Look {
    let ray = Ray::new(origin, direction.normalize());
    Box::new(move |_| ray)
}
