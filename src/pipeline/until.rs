//! Taking a picture until it has its samples, until time is over, or until it is good enough; and judging it afterwards.

use super::failure::Failure;
use super::report::PictureError;
use super::spot_check::{self, SPOTS, Spots};
use super::viewing::{Prepared, Shot, Viewing, failure, shot};
use crate::camera::Camera;
use crate::film::ErrorEstimate;
use crate::integrator::driver::{FilmResult, FilmSettings, render_view};
use crate::integrator::{
    CancelToken, Integrator, Path, Progress, RadianceEstimator, RenderContext, RenderError,
};
use crate::options::value::Renderer;
use crate::scene::Scene;
use std::ops::ControlFlow;
use std::sync::atomic::{AtomicBool, Ordering};
use std::time::Duration;

/// Samples of a picture that ends by the clock or by its error, at most.
const MOST_SAMPLES: u32 = 1 << 20;
/// How often the clock is looked at.
const TICK: Duration = Duration::from_millis(20);
/// Samples of a pixel before which the halves of a picture are not trusted to tell its error.
const FEWEST_FOR_ERROR: u32 = 8;
/// A picture is good enough when its error, estimated with so many standard errors more, is: 95 % of pictures then are.
const SURE: f64 = 1.645;

/// When a picture is done.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Until {
    /// With as many samples as the options say.
    Samples,
    /// When so much time is over, but not before each pixel has a sample.
    Time(Duration),
    /// When its noise, as its halves tell it, is at most so much. Does not depend on the clock.
    Error {
        /// Relative error.
        most: f64,
        /// Samples per pixel that it will probably take: for the display of progress.
        expected: u32,
    },
}

/// Whether a film is at most so wrong, noise alone.
fn is_good(result: &FilmResult, most: f64) -> bool {
    let is_below = |error: ErrorEstimate| error.relative + SURE * error.uncertainty <= most;
    result.report.samples_per_pixel >= FEWEST_FOR_ERROR && result.report.error.is_some_and(is_below)
}

impl Viewing<'_> {
    /// Takes a picture, and shows it after each pass on the way.
    ///
    /// # Errors
    /// If it was stopped before each pixel had a sample.
    pub fn take(
        &self,
        prepared: &Prepared<'_>,
        camera: &Camera,
        until: Until,
        show: &mut dyn FnMut(&FilmResult),
    ) -> Result<Shot, Failure> {
        let seen = match until {
            Until::Samples => {
                let mut on_pass = |result: &FilmResult| {
                    show(result);
                    ControlFlow::Continue(())
                };
                self.take_samples(prepared, camera, None, &mut on_pass)
            }
            Until::Error { most, expected } => {
                let mut on_pass = |result: &FilmResult| {
                    show(result);
                    if is_good(result, most) {
                        ControlFlow::Break(())
                    } else {
                        ControlFlow::Continue(())
                    }
                };
                self.take_samples(prepared, camera, Some(expected), &mut on_pass)
            }
            Until::Time(time) => self.take_until(prepared, camera, time, show),
        };
        match seen {
            Ok(result) => Ok(shot(&result, true)),
            Err(RenderError::Cancelled {
                partial: Some(result),
            }) => {
                let is_whole = matches!(until, Until::Time(_)) && !self.cancel.is_cancelled();
                Ok(shot(&result, is_whole))
            }
            Err(error) => Err(failure(&error)),
        }
    }

    /// Adds the samples of the options; with a number that is expected, on and on.
    fn take_samples(
        &self,
        prepared: &Prepared<'_>,
        camera: &Camera,
        expected: Option<u32>,
        on_pass: &mut dyn FnMut(&FilmResult) -> ControlFlow<()>,
    ) -> Result<FilmResult, RenderError> {
        let mut settings = self.settings();
        let n_pixels = u64::from(settings.width) * u64::from(settings.height);
        let samples = expected.unwrap_or(settings.samples_per_pixel).max(1);
        let total = n_pixels * u64::from(samples);
        if expected.is_some() {
            settings.samples_per_pixel = MOST_SAMPLES;
        }
        let report = |progress: Progress| self.audience.progress(progress.done.min(total), total);
        let context = self.context(self.cancel, &report);
        render_view(&*prepared.estimator, camera, &settings, &context, on_pass)
    }

    /// Adds samples until the time is over, but at least one to each pixel.
    fn take_until(
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
        let has_picture = AtomicBool::new(false);
        let is_over = || elapsed() >= time && has_picture.load(Ordering::Relaxed);
        self.watched(&is_over, |stop| {
            let context = self.context(stop, &report);
            let mut on_pass = |result: &FilmResult| {
                has_picture.store(true, Ordering::Relaxed);
                show(result);
                if elapsed() >= time {
                    ControlFlow::Break(())
                } else {
                    ControlFlow::Continue(())
                }
            };
            render_view(
                &*prepared.estimator,
                camera,
                &settings,
                &context,
                &mut on_pass,
            )
        })
    }

    /// Does work whose token is cancelled once `is_over`, or once this is.
    fn watched<T>(
        &self,
        is_over: &(dyn Fn() -> bool + Sync),
        work: impl FnOnce(&CancelToken) -> T,
    ) -> T {
        let (stop, is_done) = (CancelToken::default(), AtomicBool::new(false));
        std::thread::scope(|scope| {
            scope.spawn(|| {
                while !is_done.load(Ordering::Relaxed) {
                    if is_over() || self.cancel.is_cancelled() {
                        stop.cancel();
                    }
                    std::thread::sleep(TICK);
                }
            });
            // Also where the work panics: the thread must end.
            let _done = Raised(&is_done);
            work(&stop)
        })
    }

    /// Does work that is stopped when so much time is over; `None` then.
    ///
    /// # Errors
    /// What the work fails with; if it was stopped for another reason.
    pub(super) fn within<T>(
        &self,
        time: Duration,
        work: impl FnOnce(&Viewing<'_>) -> Result<T, Failure>,
    ) -> Result<Option<T>, Failure> {
        let start = self.world.now();
        let is_over = || self.world.now().saturating_sub(start) >= time;
        let done = self.watched(&is_over, |stop| {
            work(&Viewing {
                cancel: stop,
                ..*self
            })
        });
        match done {
            Err(Failure::Stopped) if !self.cancel.is_cancelled() => Ok(None),
            done => done.map(Some),
        }
    }

    /// Whether path tracing finds all light of a scene: only then are pictures judged by it.
    pub(super) fn is_judged(scene: &Scene) -> bool {
        Path::default().shortcomings(scene).is_empty()
    }

    /// What pictures of a scene are judged by: path tracing with random numbers of its own.
    ///
    /// # Errors
    /// If it was stopped.
    pub(super) fn judge<'s>(
        &self,
        scene: &'s Scene,
    ) -> Result<Box<dyn RadianceEstimator + 's>, Failure> {
        let context = RenderContext {
            seed: self.check_seed(0),
            ..self.context(self.cancel, &|_| {})
        };
        Path::default()
            .prepare(scene, &context)
            .map_err(|error| failure(&error))
    }

    /// How wrong a picture is that `camera` took: noise and bias together. Always the same for the same picture, scene, options, camera and
    /// number of samples of each half of a check.
    ///
    /// # Errors
    /// If it was stopped.
    pub(super) fn spot_check(
        &self,
        judge: &dyn RadianceEstimator,
        camera: &Camera,
        shot: &Shot,
        samples_of_half: u32,
    ) -> Result<PictureError, Failure> {
        let report = |progress: Progress| self.audience.progress(progress.done, progress.total);
        let context = RenderContext {
            seed: self.check_seed(1),
            ..self.context(self.cancel, &report)
        };
        let image = &shot.image;
        let mut spots = Spots::draw((image.width, image.height), SPOTS, context.seed);
        let samples = 2 * samples_of_half;
        spots
            .sample(judge, camera, &self.settings(), samples, &context)
            .map_err(|error| failure(&error))?;
        Ok(spots.error_of_image(image).root())
    }

    /// What tells how wrong pictures of a scene are: nothing for path tracing, whose own noise tells, and where path tracing does not find
    /// all light.
    ///
    /// # Errors
    /// If it was stopped.
    pub(super) fn needed_judge<'s>(
        &self,
        scene: &'s Scene,
    ) -> Result<Option<Box<dyn RadianceEstimator + 's>>, Failure> {
        let is_needed = self.options.renderer.value != Renderer::Path && Self::is_judged(scene);
        is_needed.then(|| self.judge(scene)).transpose()
    }

    /// Seeds of checks, other than those of pictures and of each other.
    pub(super) fn check_seed(&self, which: u64) -> u64 {
        spot_check::seed(self.options.seed.value.cast_unsigned(), which)
    }
}

/// Raises a flag when it is dropped.
struct Raised<'a>(&'a AtomicBool);

impl Drop for Raised<'_> {
    fn drop(&mut self) {
        self.0.store(true, Ordering::Relaxed);
    }
}
