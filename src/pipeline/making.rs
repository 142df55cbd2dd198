//! From a model to a picture file. Films: [`filming`](super::filming).

use super::audience::Audience;
use super::choosing::Wish;
use super::content_hash::ContentHash;
use super::exposing;
use super::failure::Failure;
use super::report::{Effort, Phase, SolutionFacts};
use super::store::PictureTarget;
use super::studio::{Run, Studio};
use super::viewing::Viewing;
use super::viewpoint;
use super::wished::Taken;
use super::world::World;
use crate::animation::flicker::Flicker;
use crate::diag::{Diagnostic, Diagnostics, Span};
use crate::integrator::CancelToken;
use crate::scene::Scene;
use std::sync::Arc;

/// What came out of a run.
#[derive(Debug)]
pub struct Made {
    /// What it took.
    pub effort: Effort,
    /// Hash of the picture file, or of the film; of all frames' files if there are only those.
    pub hash: ContentHash,
    /// Whether all that was asked for is there.
    pub is_whole: bool,
    /// Frames that were there already.
    pub n_kept: u32,
    /// Frames (or pictures) that were made.
    pub n_made: u32,
    /// What the pictures lack without showing it.
    pub warnings: Vec<&'static str>,
    /// The light that they share.
    pub solution: SolutionFacts,
    /// How much the film flickers, if that was measured.
    pub flicker: Option<Flicker>,
    /// Whether a film was written, not only frames.
    pub has_film: bool,
    /// For people: what was chosen, and what was missed.
    pub notes: Vec<String>,
}

/// What people are told of a black picture.
pub(super) const UNLIT: &str = "no light reaches what the camera sees; `--eye` and `--target` look elsewhere, `--sun` and lamps give light";

/// What becomes of a picture that was stopped before it had all its samples.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Partial {
    /// It is written: the user wants what there is.
    Keep,
    /// It is dropped: what it shows is no longer true.
    Drop,
}

/// What making pictures needs besides the model.
#[derive(Clone, Copy)]
pub struct Making<'a> {
    /// Files and the clock.
    pub world: &'a dyn World,
    /// Who is told how far it is.
    pub audience: &'a dyn Audience,
    /// The wish to stop.
    pub cancel: &'a CancelToken,
    /// What becomes of a picture when it is stopped.
    pub partial: Partial,
}

impl Making<'_> {
    pub(super) fn viewing<'v>(&'v self, run: &'v Run) -> Viewing<'v> {
        let Self {
            world,
            audience,
            cancel,
            ..
        } = *self;
        Viewing {
            world,
            audience,
            options: &run.options,
            cancel,
        }
    }

    /// Tells what pictures of the scene will lack, and gives it back.
    pub(super) fn warn(
        &self,
        run: &Run,
        viewing: &Viewing<'_>,
        scene: &Scene,
    ) -> Vec<&'static str> {
        let warnings = viewing.shortcomings(scene);
        let mut found = Diagnostics::default();
        for text in &warnings {
            let hint =
                "a lamp with extent (an `AreaLight`) or rough glass gives a complete picture";
            found.push(Diagnostic {
                primary: None,
                ..Diagnostic::warning("missing-light", Span::default(), *text).hint(hint)
            });
        }
        if !warnings.is_empty() {
            self.audience.warned(&run.sources.map, &found);
        }
        warnings
    }

    /// Makes the picture of a run. Stopped early, the picture is written with the samples so far. The options of the run are then those
    /// that it was made with, also where they were chosen for a wanted time or error.
    ///
    /// # Errors
    /// If any stage fails, or it was stopped before there was a picture.
    pub fn picture(
        &self,
        studio: &mut Studio<'_>,
        run: &mut Run,
        target: &PictureTarget,
    ) -> Result<Made, Failure> {
        let scene = studio.build(run, self.cancel)?;
        self.picture_of(studio, run, &scene, target)
    }

    /// The same of a scene that is there.
    ///
    /// # Errors
    /// As [`picture`](Self::picture).
    pub fn picture_of(
        &self,
        studio: &mut Studio<'_>,
        run: &mut Run,
        scene: &Arc<Scene>,
        target: &PictureTarget,
    ) -> Result<Made, Failure> {
        let view = viewpoint::of_scene(&run.options, scene);
        let camera = viewpoint::camera(&run.sources, &run.options, &view)?;
        // Of a method that is chosen, once it is.
        let is_named = Wish::of(&run.options)?.is_none();
        let early = is_named.then(|| self.warn(run, &self.viewing(run), scene));
        let taken = self.take(studio, run, (scene, &camera))?;
        self.audience.ends();
        let Taken {
            shot,
            exposure,
            facts,
            mut notes,
        } = taken;
        if !shot.is_whole && self.partial == Partial::Drop {
            return Err(Failure::Stopped);
        }
        let warnings = early.unwrap_or_else(|| self.warn(run, &self.viewing(run), scene));
        if shot.image.is_black() {
            notes.push(format!("the picture is black: {UNLIT}"));
        }
        let hash = studio.seconds.time(self.world, Phase::Write, || {
            let picture = exposing::develop(&shot.image, target.format(), exposure);
            target.write(self.world, &picture, &run.texts())
        })?;
        Ok(Made {
            effort: shot.effort,
            hash,
            is_whole: shot.is_whole,
            n_kept: 0,
            n_made: 1,
            warnings,
            solution: facts,
            flicker: None,
            has_film: false,
            notes,
        })
    }
}
