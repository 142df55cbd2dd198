//! Preparing a scene for a method of light transport, and looking at it.

use super::audience::Audience;
use super::budget;
use super::exposing;
use super::failure::Failure;
use super::report::{Effort, PictureError};
use super::until::Until;
use super::world::World;
use crate::camera::Camera;
use crate::film::{Filter, LinearImage, tone};
use crate::integrator::driver::{FilmResult, FilmSettings, Refinement, render_view};
use crate::integrator::photon_map::BYTES_PER_PHOTON;
use crate::integrator::{
    CancelToken, Method, Path, PhotonMapping, Progress, RadianceEstimator, Radiosity, Raytracer,
    RenderContext, RenderError, Solution, Unreadable,
};
use crate::options::Options;
use crate::options::value::{GridSize, Renderer};
use crate::sampler::SamplerKind;
use crate::scene::Scene;
use std::ops::ControlFlow;
use std::time::Duration;

/// Longer side in pixels of the picture by which the exposure is decided.
const EXPOSURE_SIDE: f64 = 96.0;
/// Its samples per pixel: its blocks of 64 pixels then hold a thousand each.
const EXPOSURE_SAMPLES: u32 = 16;
/// More seconds than anybody waits, which the clock can still count.
const LONGEST: f64 = 1e9;

/// What looking at a scene needs besides the scene.
#[derive(Clone, Copy)]
pub struct Viewing<'a> {
    /// The clock.
    pub world: &'a dyn World,
    /// Who is told how far it is.
    pub audience: &'a dyn Audience,
    /// The options of the run.
    pub options: &'a Options,
    /// The wish to stop.
    pub cancel: &'a CancelToken,
}

/// A scene made ready for one method.
pub struct Prepared<'s> {
    pub(super) estimator: Box<dyn RadianceEstimator + 's>,
}

/// What the camera saw.
#[derive(Debug)]
pub struct Shot {
    /// Mean radiance of each pixel.
    pub image: LinearImage,
    /// What it took.
    pub effort: Effort,
    /// Whether it has all the samples that were asked for; otherwise somebody stopped it.
    pub is_whole: bool,
}

impl Viewing<'_> {
    /// Solves the light that all cameras share; `early` may show what there is meanwhile.
    ///
    /// # Errors
    /// If it was stopped, or needs more memory than there is.
    pub fn solve(
        &self,
        scene: &Scene,
        early: &mut dyn FnMut(&dyn Fn() -> Solution),
    ) -> Result<Solution, Failure> {
        let report = |progress: Progress| self.audience.progress(progress.done, progress.total);
        let mut method = method(self.options);
        if let Method::Photon(photon_mapping) = &mut method {
            let memory = budget::memory(self.world, self.options);
            photon_mapping.most_stored = memory / BYTES_PER_PHOTON;
        }
        if let Method::Radiosity(radiosity) = &mut method {
            radiosity.memory = budget::memory(self.world, self.options);
        }
        let context = self.context(self.cancel, &report);
        let solution = method.integrator().solve_showing(scene, &context, early);
        solution.map_err(|error| failure(&error))
    }

    /// The solution that [`Solution::to_bytes`] made these bytes of, by the same method.
    ///
    /// # Errors
    /// If they are not those of such a solution.
    pub fn restore(&self, bytes: &[u8]) -> Result<Solution, Unreadable> {
        method(self.options).integrator().restore(bytes)
    }

    /// Makes the light that all cameras share ready for looking at it.
    ///
    /// # Errors
    /// If it was stopped.
    pub fn prepare<'s>(
        &self,
        scene: &'s Scene,
        solution: &Solution,
    ) -> Result<Prepared<'s>, Failure> {
        let report = |progress: Progress| self.audience.progress(progress.done, progress.total);
        let context = self.context(self.cancel, &report);
        let view = method(self.options)
            .integrator()
            .view(scene, solution, &context);
        match view {
            Ok(estimator) => Ok(Prepared { estimator }),
            Err(error) => Err(failure(&error)),
        }
    }

    /// What pictures will lack without showing it, for people.
    pub fn shortcomings(&self, scene: &Scene) -> Vec<&'static str> {
        method(self.options).integrator().shortcomings(scene)
    }

    /// The factor that radiance is multiplied by before it is shown: what `--exposure` says, or what suits the picture
    /// that `camera` sees. Always the same for the same scene, options and camera.
    ///
    /// # Errors
    /// If it was stopped.
    pub fn exposure(
        &self,
        scene: &Scene,
        prepared: &Prepared<'_>,
        camera: &Camera,
    ) -> Result<f64, Failure> {
        if let Some(stops) = self.options.exposure.value {
            return Ok(exposing::factor(stops));
        }
        let size = self.options.size.value;
        let scale = (EXPOSURE_SIDE / f64::from(size.width.max(size.height))).min(1.0);
        let side = |pixels: u32| ((f64::from(pixels) * scale).round() as u32).max(1);
        let settings = FilmSettings {
            width: side(size.width),
            height: side(size.height),
            samples_per_pixel: EXPOSURE_SAMPLES,
            refinement: Refinement::Everywhere,
            ..self.settings()
        };
        let silent = |_: Progress| {};
        let context = self.context(self.cancel, &silent);
        let seen = render_view(
            &*prepared.estimator,
            camera,
            &settings,
            &context,
            &mut go_on,
        );
        match seen {
            Ok(result) => {
                let image = result.film.image();
                let is_subject = exposing::subject(scene, camera, image.width, image.height);
                Ok(tone::auto_exposure(&image, &is_subject))
            }
            Err(error) => Err(failure(&error)),
        }
    }

    /// Takes a picture. Stopped early, it is the picture with the samples so far.
    ///
    /// # Errors
    /// If it was stopped before each pixel had a sample.
    pub fn shoot(&self, prepared: &Prepared<'_>, camera: &Camera) -> Result<Shot, Failure> {
        self.take(prepared, camera, Until::Samples, &mut |_| {})
    }

    /// Takes a picture, and shows it after each pass on the way; with `--time`, until that is over.
    ///
    /// # Errors
    /// As [`shoot`](Self::shoot).
    pub fn refine(
        &self,
        prepared: &Prepared<'_>,
        camera: &Camera,
        show: &mut dyn FnMut(&FilmResult),
    ) -> Result<Shot, Failure> {
        let until = match self.options.time.value {
            None => Until::Samples,
            Some(seconds) => Until::Time(Duration::from_secs_f64(seconds.0.min(LONGEST))),
        };
        self.take(prepared, camera, until, show)
    }

    /// Takes a picture of another size, with this many samples everywhere: a first impression.
    ///
    /// # Errors
    /// If it was stopped.
    pub fn glimpse(
        &self,
        prepared: &Prepared<'_>,
        camera: &Camera,
        (width, height): (u32, u32),
        samples_per_pixel: u32,
    ) -> Result<LinearImage, Failure> {
        let settings = FilmSettings {
            width,
            height,
            samples_per_pixel,
            refinement: Refinement::Everywhere,
            ..self.settings()
        };
        let silent = |_: Progress| {};
        let context = self.context(self.cancel, &silent);
        let estimator = &*prepared.estimator;
        match render_view(estimator, camera, &settings, &context, &mut go_on) {
            Ok(result) => Ok(result.film.image()),
            Err(error) => Err(failure(&error)),
        }
    }

    pub(super) fn settings(&self) -> FilmSettings {
        let options = self.options;
        let size = options.size.value;
        // A number of samples that is asked for more expressly than the grid wins over it.
        let is_beaten = options.samples.origin.beats(options.supersampling.origin);
        let grid = options.supersampling.value.filter(|_| !is_beaten);
        let grid = grid.map(GridSize::samples);
        let is_free_of_noise = options.renderer.value == Renderer::Raytracer;
        FilmSettings {
            width: size.width,
            height: size.height,
            samples_per_pixel: grid.unwrap_or(options.samples.value).get(),
            refinement: if is_free_of_noise && grid.is_none() {
                Refinement::ByContrast
            } else {
                Refinement::Everywhere
            },
            filter: Filter::default(),
            sampler: SamplerKind::default(),
        }
    }

    pub(super) fn context<'c>(
        &self,
        cancel: &'c CancelToken,
        progress: &'c (dyn Fn(Progress) + Sync),
    ) -> RenderContext<'c> {
        RenderContext {
            seed: self.options.seed.value.cast_unsigned(),
            cancel,
            progress,
        }
    }
}

/// The method of light transport that the options ask for, with its settings.
fn method(options: &Options) -> Method {
    match options.renderer.value {
        Renderer::Path => Method::Path(Path {
            max_depth: options.max_depth.value,
            kept: options.require.value,
            ..Path::default()
        }),
        Renderer::Raytracer => Method::Raytracer(Raytracer {
            max_depth: options.recursion_depth.value,
            light_samples: options.light_samples.value.get(),
            kept: options.require.value,
            ..Raytracer::default()
        }),
        Renderer::Photon => Method::Photon(PhotonMapping {
            global_photons: options.global_photons.value.0,
            caustic_photons: options.caustic_photons.value.map(|photons| photons.0),
            photon_area: options.photon_area.value.map(|area| area.0),
            passes: options.passes.value.get(),
            max_depth: options.recursion_depth.value,
            final_gather: options.final_gather.value.by(Renderer::Photon),
            kept: options.require.value,
            ..PhotonMapping::default()
        }),
        Renderer::Radiosity => Method::Radiosity(Radiosity {
            solver: options.solver.value,
            hemicube_pixels: options.hemicube_pixels.value.0,
            hemicube_size: options.hemicube_size.value.map(|size| size.0),
            form_factors: options.form_factors.value,
            subdivision_threshold: options.subdivision_threshold.value.0,
            subdivision_depth: options.subdivision_depth.value.0,
            kept: options.require.value,
            max_depth: options.recursion_depth.value,
            final_gather: options.final_gather.value.by(Renderer::Radiosity),
            ..Radiosity::default()
        }),
    }
}

pub(super) fn failure(error: &RenderError) -> Failure {
    match error {
        RenderError::Cancelled { .. } => Failure::Stopped,
        RenderError::TooManyPhotons { n, most } => Failure::World(format!(
            "{n} photons would have to be stored, and there is memory for {most}: use fewer `--global-photons` or \
             `--caustic-photons` in several `--passes`, which need the memory of one, or more `--max-memory`"
        )),
        RenderError::TooManyPatches { n, most } => Failure::World(format!(
            "radiosity would cut the surfaces into at least {n} patches, and there is memory for {most}: use more \
             `--max-memory` or another `--renderer`"
        )),
        RenderError::TooManyFactors { needed, most } => Failure::World(format!(
            "form factors would take {}, and there is memory for {}: use `--solver stochastic`, fewer \
             `--hemicube-pixels` or more `--max-memory`",
            budget::readable(*needed),
            budget::readable(*most)
        )),
    }
}

pub(super) fn shot(result: &FilmResult, is_whole: bool) -> Shot {
    let report = &result.report;
    let effort = Effort {
        n_rays: report.rays.total(),
        samples_per_pixel: report.samples_per_pixel,
        n_samples: result.film.n_samples(),
        error: report.error.as_ref().map(PictureError::of_noise),
    };
    Shot {
        image: result.film.image(),
        effort,
        is_whole,
    }
}

pub(super) fn go_on(_: &FilmResult) -> ControlFlow<()> {
    ControlFlow::Continue(())
}
