//! Showing a scene: a first impression at once, then better ones, then the picture that was asked for.

use super::live::{Finished, Live};
use super::room::{File, Room, Task};
use super::state::{Activity, Frame};
use crate::camera::Camera;
use crate::film::LinearImage;
use crate::film::tone::auto_exposure;
use crate::image::{Format, Picture, encode};
use crate::integrator::CancelToken;
use crate::integrator::driver::FilmResult;
use crate::pipeline::audience::Audience;
use crate::pipeline::exposing;
use crate::pipeline::failure::Failure;
use crate::pipeline::report::{Phase, PhaseSeconds, SolutionFacts};
use crate::pipeline::studio::Run;
use crate::pipeline::viewing::{Prepared, Shot, Viewing};
use crate::pipeline::world::World;
use crate::scene::Scene;
use std::time::Duration;

/// Shortest time between two pictures of the same view.
const BETWEEN: Duration = Duration::from_millis(120);

/// A scene with its solution, to be looked at.
pub(super) struct Sight<'a, 's> {
    pub(super) run: &'a Run,
    pub(super) scene: &'a Scene,
    pub(super) prepared: &'a Prepared<'s>,
    pub(super) camera: Camera,
    pub(super) task: &'a Task,
    pub(super) warnings: Vec<&'static str>,
    /// Where the light that all cameras share came from.
    pub(super) solution: SolutionFacts,
    /// Whether the files say something else by now.
    pub(super) is_stale: bool,
}

impl Live<'_> {
    /// Shows drafts, then the picture as it gets better.
    pub(super) fn show(&mut self, sight: &Sight<'_, '_>) -> Result<(), Failure> {
        self.audience.begins("rendering");
        self.studio.work.views += 1;
        let mut seconds = PhaseSeconds::default();
        if !self.is_once {
            self.drafts(sight)?;
        }
        let audience = self.audience.clone();
        let viewing = viewing(self.world, &*audience, sight.run, &sight.task.cancel);
        let exposure = seconds.time(self.world, Phase::Prepare, || {
            viewing.exposure(sight.scene, sight.prepared, &sight.camera)
        })?;
        self.exposure = Some(exposure);
        let start = self.world.now();
        let mut shown = start;
        let mut on_pass = |result: &FilmResult| {
            let now = self.world.now();
            let report = &result.report;
            let is_early = now.saturating_sub(shown) < BETWEEN;
            if is_early || self.is_once || sight.task.cancel.is_cancelled() {
                return;
            }
            shown = now;
            let image = result.film.image();
            let frame = frame(&image, false, report.samples_per_pixel);
            let error = report.error.map(|error| error.relative);
            self.publish(&image, exposure, Frame { error, ..frame });
        };
        let shot = viewing.refine(sight.prepared, &sight.camera, &mut on_pass)?;
        let time = self.world.now().saturating_sub(start);
        seconds.add(Phase::Render, time);
        if !shot.is_whole || sight.task.cancel.is_cancelled() {
            return Err(Failure::Stopped);
        }
        let n_pixels = f64::from(shot.image.width) * f64::from(shot.image.height);
        let n_samples = n_pixels * f64::from(shot.effort.samples_per_pixel);
        self.pace
            .measured(sight.run.options.renderer.value, n_samples, time);
        self.studio.seconds.merge(&seconds);
        self.finish(sight, &shot, exposure)
    }

    /// Shows small pictures with one sample a pixel. The first one is stopped only by what makes all of the scene useless: who
    /// drags the view along would otherwise never see one.
    fn drafts(&mut self, sight: &Sight<'_, '_>) -> Result<(), Failure> {
        let audience = self.audience.clone();
        let options = &sight.run.options;
        let (size, renderer) = (options.size.value, options.renderer.value);
        let mut cancel = &sight.task.leave;
        for (width, height) in self.pace.drafts(renderer, (size.width, size.height)) {
            let start = self.world.now();
            let viewing = viewing(self.world, &*audience, sight.run, cancel);
            let image = viewing.glimpse(sight.prepared, &sight.camera, (width, height), 1)?;
            let time = self.world.now().saturating_sub(start);
            self.pace
                .measured(renderer, f64::from(width) * f64::from(height), time);
            let exposure = match (self.exposure, options.exposure.value) {
                (_, Some(stops)) => exposing::factor(stops),
                (Some(known), None) => known,
                (None, None) => {
                    let subject = exposing::subject(sight.scene, &sight.camera, width, height);
                    auto_exposure(&image, &subject)
                }
            };
            self.exposure = Some(exposure);
            self.publish(&image, exposure, frame(&image, false, 0));
            cancel = &sight.task.cancel;
            if cancel.is_cancelled() {
                return Err(Failure::Stopped);
            }
        }
        Ok(())
    }

    /// Shows the picture that was asked for, and gives it to whoever wants it.
    fn finish(&mut self, sight: &Sight<'_, '_>, shot: &Shot, exposure: f64) -> Result<(), Failure> {
        let start = self.world.now();
        if !self.is_once {
            let picture = exposing::develop(&shot.image, Format::Png, exposure);
            let frame = Frame {
                error: shot.effort.error.map(|error| error.relative),
                ..frame(&shot.image, true, shot.effort.samples_per_pixel)
            };
            send(&self.room, &picture, Format::Png, &sight.run.texts(), frame);
        }
        let time = self.world.now().saturating_sub(start);
        self.studio.seconds.add(Phase::Write, time);
        let made = Finished {
            image: &shot.image,
            exposure,
            effort: shot.effort,
            warnings: sight.warnings.clone(),
            solution: sight.solution,
        };
        if !sight.is_stale {
            self.outlet.finished(sight.run, &mut self.studio, &made)?;
        }
        self.audience.ends();
        let (seconds, work) = (self.studio.seconds.clone(), self.studio.work);
        self.room.tell(|state| {
            state.seconds = seconds;
            state.work = work;
            state.progress = None;
            state.activity = if sight.is_stale {
                Activity::Failed
            } else {
                Activity::Done
            };
        });
        Ok(())
    }

    fn publish(&self, image: &LinearImage, exposure: f64, frame: Frame) {
        publish(&self.room, image, exposure, frame);
    }
}

/// Shows a picture that a better one will follow.
pub(super) fn publish(room: &Room, image: &LinearImage, exposure: f64, frame: Frame) {
    let picture = exposing::develop(image, Format::Jpeg, exposure);
    send(room, &picture, Format::Jpeg, &[], frame);
}

fn send(room: &Room, picture: &Picture, format: Format, texts: &[(&str, String)], frame: Frame) {
    let kind = if format == Format::Png {
        "image/png"
    } else {
        "image/jpeg"
    };
    // What is too large for a format is not shown, and still written where that is wanted.
    if let Ok(bytes) = encode(picture, format, texts) {
        let bytes = bytes.into();
        room.show(File { bytes, kind }, frame);
    }
}

/// What looking at the scene of a run needs.
pub(super) fn viewing<'v>(
    world: &'v dyn World,
    audience: &'v dyn Audience,
    run: &'v Run,
    cancel: &'v CancelToken,
) -> Viewing<'v> {
    Viewing {
        world,
        audience,
        options: &run.options,
        cancel,
    }
}

pub(super) fn frame(image: &LinearImage, is_final: bool, samples: u32) -> Frame {
    Frame {
        number: 0,
        width: image.width,
        height: image.height,
        is_final,
        samples,
        error: None,
    }
}
