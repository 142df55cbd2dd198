//! Solving the light equation: the seam that all renderers share, and the driver that fills a film with them.
//!
//! An [`Integrator`] does its view-independent work once ([`prepare`](Integrator::prepare)) and hands out a
//! [`RadianceEstimator`], which answers one question: how much light arrives along this ray? [`driver::render_view`] asks
//! it for every sample of every pixel; it alone knows of tiles, threads, progress and cancellation.
//!
//! Methods whose view-independent work is large do it in two steps: [`solve`](Integrator::solve) gives a [`Solution`], which borrows
//! nothing and can be kept or saved, and [`view`](Integrator::view) looks at it.
//!
//! Every method is asked through the same ray queries of the [`scene`](crate::scene), the same sources ([`sources`]) and the
//! same [`sampler`](crate::sampler), so that a fix is made once.

mod carrier;
mod bytes;
mod clear_shadow;
mod context;
pub mod driver;
pub mod final_gather;
pub mod grid;
pub mod guide;
pub mod interception;
pub mod medium;
pub mod mis;
pub mod path;
pub mod photon;
pub mod photon_map;
pub mod radiosity;
pub mod raytracer;
pub mod requirements;
mod selection;
mod solution;
pub mod sources;
mod split;
mod viewer;

pub use context::{CancelToken, Progress, RayCounts, RenderContext, RenderError};
pub use path::Path;
pub use photon_map::PhotonMapping;
pub use radiosity::Radiosity;
pub use raytracer::Raytracer;
pub use solution::{Solution, Unreadable};

use crate::color::Rgb;
use crate::math::Ray;
use crate::sampler::Sampler;
use crate::scene::Scene;

/// A method of light transport with its settings.
pub trait Integrator {
    /// Does the work that does not depend on the camera. A fly-through calls it once.
    ///
    /// # Errors
    /// [`RenderError::Cancelled`] if the context was cancelled meanwhile; whatever else the method cannot do.
    fn prepare<'s>(
        &self,
        scene: &'s Scene,
        context: &RenderContext<'_>,
    ) -> Result<Box<dyn RadianceEstimator + 's>, RenderError>;

    /// The first step of [`prepare`](Self::prepare): what is found out about the scene once, whatever the camera and whatever the
    /// settings that only views need. Methods without a solution find out nothing.
    ///
    /// # Errors
    /// As [`prepare`](Self::prepare).
    fn solve(&self, _scene: &Scene, _context: &RenderContext<'_>) -> Result<Solution, RenderError> {
        Ok(Solution::Nothing)
    }

    /// The same; `early` is told now and then that there is something to see already, and may ask for it. Methods that have nothing
    /// before the end tell nothing. What comes out does not depend on it.
    ///
    /// # Errors
    /// As [`prepare`](Self::prepare).
    fn solve_showing(
        &self,
        scene: &Scene,
        context: &RenderContext<'_>,
        _early: &mut dyn FnMut(&dyn Fn() -> Solution),
    ) -> Result<Solution, RenderError> {
        self.solve(scene, context)
    }

    /// The second step: makes ready for rays what [`solve`](Self::solve) found out about the same scene. Methods without a solution
    /// do all their work here; so does any method that is given the solution of another.
    ///
    /// # Errors
    /// As [`prepare`](Self::prepare).
    fn view<'s>(
        &self,
        scene: &'s Scene,
        _solution: &Solution,
        context: &RenderContext<'_>,
    ) -> Result<Box<dyn RadianceEstimator + 's>, RenderError> {
        self.prepare(scene, context)
    }

    /// The solution that [`Solution::to_bytes`] made these bytes of.
    ///
    /// # Errors
    /// If they are not those of a solution of this method.
    fn restore(&self, _bytes: &[u8]) -> Result<Solution, Unreadable> {
        Err(Unreadable("this method has no solutions"))
    }

    /// What pictures of `scene` by this method will lack without showing it, for people; nothing by default.
    fn shortcomings(&self, _scene: &Scene) -> Vec<&'static str> {
        Vec::new()
    }
}

/// A method made ready for one scene.
pub trait RadianceEstimator: Sync {
    /// Estimates the radiance arriving at the origin of `ray` from along it, W/(m² sr) per channel.
    ///
    /// A pure function of the ray and the sampler. `rays` counts the queries it took.
    fn incident_radiance(&self, ray: &Ray, sampler: &mut Sampler, rays: &mut RayCounts) -> Rgb;
}

/// The methods there are.
#[derive(Clone, Debug, PartialEq)]
pub enum Method {
    /// Path tracing: unbiased, the reference for all others.
    Path(Path),
    /// Standard ray tracing: direct light, mirrors and glass.
    Raytracer(Raytracer),
    /// Photon mapping: one solve for all cameras.
    Photon(PhotonMapping),
    /// Radiosity: what surfaces send each other, solved once for all cameras.
    Radiosity(Radiosity),
}

impl Method {
    /// The integrator of this method.
    #[must_use]
    pub fn integrator(&self) -> &dyn Integrator {
        match self {
            Self::Path(path) => path,
            Self::Raytracer(raytracer) => raytracer,
            Self::Photon(photon_mapping) => photon_mapping,
            Self::Radiosity(radiosity) => radiosity,
        }
    }
}
