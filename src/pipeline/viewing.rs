//! Preparing a scene for a method of light transport, and looking at it.

use super::audience::Audience;
use super::budget;
use super::exposing;
use super::failure::Failure;
use super::report::{Effort, PictureError};
use super::spot_check::{self, SPOTS, Spots};
use super::world::World;
use crate::camera::Camera;
use crate::film::{Filter, LinearImage, tone};
use crate::integrator::driver::{FilmResult, FilmSettings, Refinement, render_view};
use crate::integrator::photon_map::BYTES_PER_PHOTON;
use crate::integrator::{
    CancelToken, Integrator, Method, Path, PhotonMapping, Progress, RadianceEstimator, Radiosity,
    Raytracer, RenderContext, RenderError, Solution, Unreadable,
};
use crate::options::Options;
use crate::options::value::{GridSize, Renderer};
use crate::sampler::SamplerKind;
use crate::scene::Scene;
use std::ops::ControlFlow;
use std::sync::atomic::{AtomicBool, Ordering};
use std::time::Duration;

/// Longer side in pixels of the picture by which the exposure is decided.
const EXPOSURE_SIDE: f64 = 96.0;
/// Its samples per pixel: its blocks of 64 pixels then hold a thousand each.
const EXPOSURE_SAMPLES: u32 = 16;
/// With `--time`, samples are limited by the clock and by this only.
const MOST_SAMPLES: u32 = 1 << 20;
/// How often the clock is looked at with `--time`.
const TICK: Duration = Duration::from_millis(20);

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
        self.refine(prepared, camera, &mut |_| {})
    }

    /// Takes a picture, and shows it after each pass on the way.
    ///
    /// # Errors
    /// As [`shoot`](Self::shoot).
    pub fn refine(
        &self,
        prepared: &Prepared<'_>,
        camera: &Camera,
        show: &mut dyn FnMut(&FilmResult),
    ) -> Result<Shot, Failure> {
        let seen = match self.options.time.value {
            None => {
                let report =
                    |progress: Progress| self.audience.progress(progress.done, progress.total);
                let context = self.context(self.cancel, &report);
                let settings = self.settings();
                let mut on_pass = |result: &FilmResult| {
                    show(result);
                    ControlFlow::Continue(())
                };
                render_view(
                    &*prepared.estimator,
                    camera,
                    &settings,
                    &context,
                    &mut on_pass,
                )
            }
            Some(seconds) => {
                let time = Duration::from_secs_f64(seconds.0);
                self.shoot_until(prepared, camera, time, show)
            }
        };
        match seen {
            Ok(result) => Ok(shot(&result, true)),
            Err(RenderError::Cancelled {
                partial: Some(result),
            }) => {
                let is_whole = self.options.time.value.is_some() && !self.cancel.is_cancelled();
                Ok(shot(&result, is_whole))
            }
            Err(error) => Err(failure(&error)),
        }
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

    /// How wrong a picture of so many samples is that `camera` took of this scene: noise and bias together. `None` if the path tracer,
    /// by which it is judged, would not find all light there is. Always the same for the same picture, scene, options and camera.
    ///
    /// # Errors
    /// If it was stopped.
    pub fn spot_check(
        &self,
        scene: &Scene,
        camera: &Camera,
        shot: &Shot,
    ) -> Result<Option<PictureError>, Failure> {
        let path = Path::default();
        if !path.shortcomings(scene).is_empty() {
            return Ok(None);
        }
        let report = |progress: Progress| self.audience.progress(progress.done, progress.total);
        let context = RenderContext {
            seed: spot_check::seed(self.options.seed.value.cast_unsigned()),
            ..self.context(self.cancel, &report)
        };
        let image = &shot.image;
        let check = || {
            let estimator = path.prepare(scene, &context)?;
            let mut spots = Spots::draw((image.width, image.height), SPOTS, context.seed);
            let samples = 2 * spot_check::samples_of_half(shot.effort.n_samples);
            spots.sample(&*estimator, camera, &self.settings(), samples, &context)?;
            Ok(spots.error_of_image(image).root())
        };
        check()
            .map(Some)
            .map_err(|error: RenderError| failure(&error))
    }

    /// Adds samples until the time is over, but at least one to each pixel.
    fn shoot_until(
        &self,
        prepared: &Prepared<'_>,
        camera: &Camera,
        time: Duration,
        show: &mut dyn FnMut(&FilmResult),
    ) -> Result<FilmResult, RenderError> {
        let start = self.world.now();
        let elapsed = || self.world.now().saturating_sub(start);
        let report = |_: Progress| {
            self.audience.progress(
                elapsed().min(time).as_millis() as u64,
                time.as_millis() as u64,
            );
        };
        let settings = FilmSettings {
            samples_per_pixel: MOST_SAMPLES,
            ..self.settings()
        };
        let (has_picture, is_done) = (AtomicBool::new(false), AtomicBool::new(false));
        let stop = CancelToken::default();
        std::thread::scope(|scope| {
            scope.spawn(|| {
                while !is_done.load(Ordering::Relaxed) {
                    let is_over = elapsed() >= time && has_picture.load(Ordering::Relaxed);
                    if is_over || self.cancel.is_cancelled() {
                        stop.cancel();
                    }
                    std::thread::sleep(TICK);
                }
            });
            let context = self.context(&stop, &report);
            let mut on_pass = |result: &FilmResult| {
                has_picture.store(true, Ordering::Relaxed);
                show(result);
                if elapsed() >= time {
                    ControlFlow::Break(())
                } else {
                    ControlFlow::Continue(())
                }
            };
            let seen = render_view(
                &*prepared.estimator,
                camera,
                &settings,
                &context,
                &mut on_pass,
            );
            is_done.store(true, Ordering::Relaxed);
            seen
        })
    }

    fn settings(&self) -> FilmSettings {
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
            final_gather: options.final_gather.value.0,
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

fn shot(result: &FilmResult, is_whole: bool) -> Shot {
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

fn go_on(_: &FilmResult) -> ControlFlow<()> {
    ControlFlow::Continue(())
}
