//! From a model to a file with its lit surfaces.
//!
//! Colours are those of the picture that the camera sees: radiance times the exposure, brought down by the tone curve.

use super::budget;
use super::content_hash::ContentHash;
use super::failure::Failure;
use super::making::Making;
use super::report::Phase;
use super::store::GlbTarget;
use super::studio::{Run, Studio};
use super::viewing::failure;
use super::viewpoint;
use crate::color::Rgb;
use crate::film::tone::ToneCurve;
use crate::geometry::painted::FileCamera;
use crate::integrator::{Progress, Solution};
use crate::options::Options;
use crate::options::value::Renderer;

/// Memory that an element takes while it is made ready to be written, bytes.
const BYTES_PER_ELEMENT: u64 = 1024;

/// Elements beyond which no viewer would open the file.
const MOST_ELEMENTS: u64 = 10_000_000;

/// What was written.
#[derive(Clone, Copy, Debug)]
pub struct Exported {
    /// Triangles of the mesh, both sides counted.
    pub n_triangles: usize,
    /// Their corners.
    pub n_corners: usize,
    /// Hash of the file.
    pub hash: ContentHash,
}

/// Refuses options with which there is nothing to export.
///
/// # Errors
/// If the light is not to be solved on surfaces.
pub fn check(options: &Options) -> Result<(), Failure> {
    match options.renderer.value {
        Renderer::Radiosity => Ok(()),
        Renderer::Path | Renderer::Raytracer | Renderer::Photon => Err(Failure::Usage(
            "`export` writes surfaces with the light on them, which is what `--renderer radiosity` solves: add it"
                .into(),
        )),
    }
}

impl Making<'_> {
    /// Writes the surfaces of a model with the light on them.
    ///
    /// # Errors
    /// If any stage fails, or it was stopped.
    pub fn surfaces(
        &self,
        studio: &mut Studio<'_>,
        run: &Run,
        target: &GlbTarget,
    ) -> Result<Exported, Failure> {
        check(&run.options)?;
        let scene = studio.build(run, self.cancel)?;
        let view = viewpoint::of_scene(&run.options, &scene);
        let camera = viewpoint::camera(&run.sources, &run.options, &view)?;
        let viewing = self.viewing(run);
        self.warn(run, &viewing, &scene);

        self.audience.begins("preparing");
        let solved = studio.solve(run, &scene, &viewing)?;
        solved.warn(self.audience, &run.sources.map);
        let Solution::Radiosity(solution) = &solved.solution else {
            return Err(Failure::World("there is no light on surfaces".into()));
        };
        let prepared = studio.seconds.time(self.world, Phase::Prepare, || {
            viewing.prepare(&scene, &solved.solution)
        })?;
        let exposure = viewing.exposure(&scene, &prepared, &camera)?;
        self.audience.begins("painting");
        let shown = |radiance: Rgb| ToneCurve::default().apply(radiance * exposure);
        let report = |progress: Progress| self.audience.progress(progress.done, progress.total);
        let context = viewing.context(self.cancel, &report);
        let most = budget::memory(self.world, &run.options) / BYTES_PER_ELEMENT;
        let most = most.min(MOST_ELEMENTS);
        let painted = studio.seconds.time(self.world, Phase::Render, || {
            solution.painted(&scene, &*prepared.estimator, &shown, most, &context)
        });
        self.audience.ends();
        let painted = painted.map_err(|error| failure(&error))?;

        let [right, up] = camera.axes();
        let camera = FileCamera {
            eye: camera.eye(),
            right,
            up,
            fov: view.fov.radians(),
            aspect: run.options.size.value.aspect(),
        };
        let hash = studio.seconds.time(self.world, Phase::Write, || {
            let nothing =
                || Failure::World("the model has no surfaces that could be written".into());
            let file = painted.to_glb(Some(&camera)).ok_or_else(nothing)?;
            target.write(self.world, &file)
        })?;
        Ok(Exported {
            n_triangles: painted.triangles.len(),
            n_corners: painted.positions.len(),
            hash,
        })
    }
}
