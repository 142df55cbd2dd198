//! Taking the picture of a run: as the options say, or with what is [chosen](super::choosing) for a wanted time or error.

mod error;
mod time;

use super::choosing::Wish;
use super::failure::Failure;
use super::making::Making;
use super::report::{Phase, SolutionFacts};
use super::solving::Solved;
use super::spot_check::samples_of_half;
use super::studio::{Run, Studio};
use super::until::Until;
use super::viewing::{Shot, Viewing};
use crate::camera::Camera;
use crate::integrator::RadianceEstimator;
use crate::options::value::Renderer;
use crate::scene::Scene;
use std::sync::Arc;

/// A picture with what was found out on the way.
pub(super) struct Taken {
    pub(super) shot: Shot,
    pub(super) exposure: f64,
    pub(super) facts: SolutionFacts,
    /// For people: what was chosen, what was missed.
    pub(super) notes: Vec<String>,
}

/// What is looked at.
#[derive(Clone, Copy)]
struct Sight<'s> {
    scene: &'s Arc<Scene>,
    camera: &'s Camera,
}

/// A picture under way.
struct Taking<'t, 'a, 'w, 's> {
    making: Making<'a>,
    studio: &'t mut Studio<'w>,
    run: &'t mut Run,
    sight: Sight<'s>,
}

impl Making<'_> {
    /// Takes the picture of a run; its options then are those that the picture was made with.
    ///
    /// # Errors
    /// If it was stopped before there was a picture, or anything fails.
    pub(super) fn take(
        &self,
        studio: &mut Studio<'_>,
        run: &mut Run,
        (scene, camera): (&Arc<Scene>, &Camera),
    ) -> Result<Taken, Failure> {
        let wish = Wish::of(&run.options)?;
        let mut taking = Taking {
            making: *self,
            studio,
            run,
            sight: Sight { scene, camera },
        };
        match wish {
            None => taking.as_told(),
            Some(Wish::Seconds(seconds)) => taking.in_time(seconds),
            Some(Wish::Error(error)) => taking.reach_error(error),
        }
    }
}

impl<'s> Taking<'_, '_, '_, 's> {
    /// With the options as they are.
    fn as_told(&mut self) -> Result<Taken, Failure> {
        let solved = self.solve()?;
        self.warn(&solved);
        let (mut shot, exposure) = self.shoot(&solved, || Until::Samples)?;
        if self.run.options.renderer.value != Renderer::Path && shot.is_whole {
            let n = samples_of_half(shot.effort.n_samples);
            self.check(None, &mut shot, n)?;
        }
        Ok(Taken {
            shot,
            exposure,
            facts: solved.facts,
            notes: Vec::new(),
        })
    }

    /// Tells people what the light of a picture lacks.
    fn warn(&self, solved: &Solved) {
        solved.warn(self.making.audience, &self.run.sources.map);
    }

    /// The light that all views share.
    fn solve(&mut self) -> Result<Solved, Failure> {
        self.making.audience.begins("preparing");
        let viewing = self.making.viewing(self.run);
        self.studio.solve(self.run, self.sight.scene, &viewing)
    }

    /// Exposes and takes the picture; `until` is asked last.
    fn shoot(
        &mut self,
        solved: &Solved,
        until: impl FnOnce() -> Until,
    ) -> Result<(Shot, f64), Failure> {
        let Sight { scene, camera } = self.sight;
        let world = self.making.world;
        let viewing = self.making.viewing(self.run);
        let seconds = &mut self.studio.seconds;
        let (prepared, exposure) = seconds.time(world, Phase::Prepare, || {
            let prepared = viewing.prepare(scene, &solved.solution)?;
            let exposure = viewing.exposure(scene, &prepared, camera)?;
            Ok::<_, Failure>((prepared, exposure))
        })?;
        self.making.audience.begins("rendering");
        self.studio.work.views += 1;
        let shot = seconds.time(world, Phase::Render, || {
            viewing.take(&prepared, camera, until(), &mut |_| {})
        })?;
        Ok((shot, exposure))
    }

    /// Finds out how wrong a picture is, by a method that is wrong in other ways. Stopped meanwhile, the picture is as good as it was;
    /// only how good is not known.
    fn check(
        &mut self,
        judge: Option<&dyn RadianceEstimator>,
        shot: &mut Shot,
        samples_of_half: u32,
    ) -> Result<(), Failure> {
        let Sight { scene, camera } = self.sight;
        shot.effort.error = None;
        if !Viewing::is_judged(scene) {
            return Ok(());
        }
        self.making.audience.begins("checking");
        let viewing = self.making.viewing(self.run);
        let check = || match judge {
            Some(judge) => viewing.spot_check(judge, camera, shot, samples_of_half),
            None => {
                let judge = viewing.judge(scene)?;
                viewing.spot_check(&*judge, camera, shot, samples_of_half)
            }
        };
        let world = self.making.world;
        match self.studio.seconds.time(world, Phase::Check, check) {
            Ok(error) => shot.effort.error = Some(error),
            Err(Failure::Stopped) => {}
            Err(failure) => return Err(failure),
        }
        Ok(())
    }
}
