//! The exposure of a film: one for all frames, found in a small picture of the brightest with the film's own light.

use super::exposing;
use super::failure::Failure;
use super::filming::{Job, Shooting};
use super::report::Phase;
use super::viewing::Viewing;

impl Shooting<'_, '_> {
    /// The factor for the radiance of all frames: what suits this one. It is looked for once, and does not depend on the number of samples.
    ///
    /// # Errors
    /// If it was stopped, or the light of its scene cannot be solved.
    pub(super) fn exposure(&mut self, job: &Job) -> Result<f64, Failure> {
        if let Some(stops) = self.base.exposure.value {
            return Ok(exposing::factor(stops));
        }
        if let Some(exposure) = self.exposure {
            return Ok(exposure);
        }
        let options = self.base.clone();
        let exposure = self.look(job, &options, |this, scene, prepared| {
            let viewing = Viewing {
                options: &options,
                ..this.making.viewing(this.run)
            };
            let world = this.making.world;
            let decide = || viewing.exposure(scene, prepared, &job.camera);
            this.studio.seconds.time(world, Phase::Prepare, decide)
        })?;
        self.exposure = Some(exposure);
        Ok(exposure)
    }
}
