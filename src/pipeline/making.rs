//! From a model to a picture file. Films: [`filming`](super::filming).

use super::audience::Audience;
use super::content_hash::ContentHash;
use super::exposing;
use super::failure::Failure;
use super::report::{Effort, Phase, SolutionFacts};
use super::store::PictureTarget;
use super::studio::{Run, Studio};
use super::viewing::{Shot, Viewing};
use super::viewpoint;
use super::world::World;
use crate::animation::flicker::Flicker;
use crate::camera::Camera;
use crate::diag::{Diagnostic, Diagnostics, Span};
use crate::integrator::CancelToken;
use crate::options::value::Renderer;
use crate::scene::Scene;

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
}

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

    /// Finds out how wrong a picture is, by a method that is wrong in other ways than noise. Stopped meanwhile, the picture is as good
    /// as it was; only how good is not known.
    fn check(
        &self,
        studio: &mut Studio<'_>,
        run: &Run,
        (scene, camera): (&Scene, &Camera),
        shot: &mut Shot,
    ) -> Result<(), Failure> {
        if run.options.renderer.value == Renderer::Path {
            return Ok(());
        }
        shot.effort.error = None;
        self.audience.begins("checking");
        let viewing = self.viewing(run);
        let check = || viewing.spot_check(scene, camera, shot);
        match studio.seconds.time(self.world, Phase::Check, check) {
            Ok(error) => shot.effort.error = error,
            Err(Failure::Stopped) => {}
            Err(failure) => return Err(failure),
        }
        Ok(())
    }

    /// Makes the picture of a run. Stopped early, the picture is written with the samples so far.
    ///
    /// # Errors
    /// If any stage fails, or it was stopped before there was a picture.
    pub fn picture(
        &self,
        studio: &mut Studio<'_>,
        run: &Run,
        target: &PictureTarget,
    ) -> Result<Made, Failure> {
        let scene = studio.build(run, self.cancel)?;
        let view = viewpoint::of_scene(&run.options, &scene);
        let camera = viewpoint::camera(&run.sources, &run.options, &view)?;
        let viewing = self.viewing(run);
        let warnings = self.warn(run, &viewing, &scene);

        self.audience.begins("preparing");
        let solved = studio.solve(run, &scene, &viewing)?;
        let (prepared, exposure) = studio.seconds.time(self.world, Phase::Prepare, || {
            let prepared = viewing.prepare(&scene, &solved.solution)?;
            let exposure = viewing.exposure(&scene, &prepared, &camera)?;
            Ok::<_, Failure>((prepared, exposure))
        })?;
        self.audience.begins("rendering");
        studio.work.views += 1;
        let mut shot = studio.seconds.time(self.world, Phase::Render, || {
            viewing.shoot(&prepared, &camera)
        })?;
        self.check(studio, run, (&scene, &camera), &mut shot)?;
        self.audience.ends();

        if !shot.is_whole && self.partial == Partial::Drop {
            return Err(Failure::Stopped);
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
            solution: solved.facts,
            flicker: None,
            has_film: false,
        })
    }
}
