//! From the camera to the solution: direct light and solved light at matt surfaces, everything else followed further.

use super::RadiositySolution;
use crate::color::Rgb;
use crate::integrator::path::Strategies;
use crate::integrator::sources::Reach;
use crate::integrator::viewer::{Asked, Seen, Viewer};
use crate::integrator::{RadianceEstimator, RayCounts};
use crate::material::Scattering;
use crate::math::Ray;
use crate::sampler::Sampler;
use std::f64::consts::FRAC_1_PI;
use std::sync::Arc;

/// The solution, and what looking at it needs.
pub(super) struct View<'s> {
    pub(super) viewer: Viewer<'s>,
    pub(super) solution: Arc<RadiositySolution>,
}

impl RadianceEstimator for View<'_> {
    fn incident_radiance(&self, ray: &Ray, sampler: &mut Sampler, rays: &mut RayCounts) -> Rgb {
        let media = self.viewer.carrier.bodies.around(ray.origin);
        let matt = |seen: &Seen<'_>, sampler: &Sampler, rays: &mut RayCounts| {
            self.matt_radiance(seen, sampler, rays)
        };
        self.viewer
            .light_along((ray, media), Asked::CAMERA, sampler, rays, matt)
            .radiance
    }
}

impl View<'_> {
    /// Direct and solved light that the matt part of a surface sends back along the ray.
    fn matt_radiance(&self, seen: &Seen<'_>, sampler: &Sampler, rays: &mut RayCounts) -> Rgb {
        let met = seen.met;
        let matt = Scattering {
            sides: met.optics.scattering.sides,
            lobes: &[],
        };
        if !matt.is_smooth() {
            return Rgb::BLACK;
        }
        let ways = (Reach::First, Strategies::LightsOnly);
        let direct = self.viewer.direct(seen, &matt, ways, sampler, rays);
        let RadiositySolution { mesh, vertices, .. } = &*self.solution;
        let Some(place) = mesh.element_at(&met.hit, met.point.position) else {
            return direct;
        };
        let cell = &mesh.nodes[place.node as usize].cell;
        let is_triangle = mesh.is_triangle(cell);
        let solved = vertices.at(place.node, place.within, is_triangle);
        let near = usize::from(met.point.normal_g.dot(seen.wo) < 0.0);
        let sent = matt.sides[near].reflectance * solved[near]
            + matt.sides[1 - near].transmittance * solved[1 - near];
        direct + sent * FRAC_1_PI
    }
}
