//! From the camera to the solution: direct light and solved light at matt surfaces, everything else followed further.

use super::RadiositySolution;
use super::carry::{Carrier, Met, frame_of, lobes_of, survivor};
use crate::color::Rgb;
use crate::integrator::medium::Media;
use crate::integrator::mis::power_heuristic;
use crate::integrator::path::Strategies;
use crate::integrator::sources::{Reach, Shading, Sources, receiver};
use crate::integrator::{RadianceEstimator, RayCounts};
use crate::light::Receiver;
use crate::material::{Scattering, Transport};
use crate::math::Ray;
use crate::sampler::Sampler;
use glam::DVec3;
use std::f64::consts::FRAC_1_PI;
use std::sync::Arc;

/// Pads of glossy parts: their questions to lights must not be those of the matt part.
const GLOSSY: u32 = 1 << 20;

/// The solution, and what looking at it needs.
pub(super) struct View<'s> {
    pub(super) carrier: Carrier<'s>,
    pub(super) sources: Sources<'s>,
    pub(super) solution: Arc<RadiositySolution>,
}

/// The glossy scattering that a ray comes from, if lights were asked there.
struct LastScattering {
    from: Receiver,
    pdf_solid_angle: f64,
}

impl RadianceEstimator for View<'_> {
    fn incident_radiance(&self, ray: &Ray, sampler: &mut Sampler, rays: &mut RayCounts) -> Rgb {
        let carrier = &self.carrier;
        let (mut radiance, mut throughput, mut compression) = (Rgb::BLACK, Rgb::WHITE, 1.0);
        let mut last: Option<LastScattering> = None;
        let mut media = carrier.bodies.around(ray.origin);
        let mut ray = *ray;
        for depth in 0.. {
            sampler.start_vertex(depth + 1);
            let way = carrier.follow(&ray, &media, sampler, rays);
            throughput *= way.weight;
            let Some(met) = way.end else {
                radiance += throughput * self.escaping_radiance(ray.direction, last.as_ref());
                break;
            };
            radiance += throughput * self.emitted_radiance(&met, last.as_ref());
            let wo = -ray.direction;
            radiance += throughput * self.matt_radiance(&met, wo, &media, sampler, rays);
            if met.optics.scattering.is_matt() || depth >= carrier.max_depth {
                break;
            }
            sampler.start_vertex(GLOSSY + depth);
            let lobes = lobes_of(&met.optics);
            if lobes.is_smooth() {
                let ways = (Strategies::Both, &*sampler);
                radiance += throughput * self.direct((&met, wo, &media), &lobes, ways, rays);
            }
            let transport = Transport::Radiance;
            let onward = carrier.scatter(&met, wo, &mut media, transport, sampler);
            let Some(onward) = onward else { break };
            compression *= onward.compression;
            let left = survivor(throughput * onward.weight, compression, depth, sampler);
            let Some(left) = left else { break };
            throughput = left;
            last = onward
                .pdf_solid_angle
                .map(|pdf_solid_angle| LastScattering {
                    from: receiver(&met.point, &frame_of(&met.point), &lobes, wo),
                    pdf_solid_angle,
                });
            ray = onward.ray;
        }
        radiance
    }
}

impl View<'_> {
    /// Direct and solved light that the matt part of a surface sends along `wo`.
    fn matt_radiance(
        &self,
        met: &Met<'_>,
        wo: DVec3,
        media: &Media,
        sampler: &Sampler,
        rays: &mut RayCounts,
    ) -> Rgb {
        let matt = Scattering {
            sides: met.optics.scattering.sides,
            lobes: &[],
        };
        if !matt.is_smooth() {
            return Rgb::BLACK;
        }
        let ways = (Strategies::LightsOnly, sampler);
        let direct = self.direct((met, wo, media), &matt, ways, rays);
        let RadiositySolution { mesh, vertices, .. } = &*self.solution;
        let Some(place) = mesh.element_at(&met.hit, met.point.position) else {
            return direct;
        };
        let cell = &mesh.nodes[place.node as usize].cell;
        let is_triangle = mesh.is_triangle(cell);
        let solved = vertices.at(place.node, place.within, is_triangle);
        let near = usize::from(met.point.normal_g.dot(wo) < 0.0);
        let sent = matt.sides[near].reflectance * solved[near]
            + matt.sides[1 - near].transmittance * solved[1 - near];
        direct + sent * FRAC_1_PI
    }

    fn direct(
        &self,
        (met, wo, media): (&Met<'_>, DVec3, &Media),
        scattering: &Scattering<'_>,
        (strategies, sampler): (Strategies, &Sampler),
        rays: &mut RayCounts,
    ) -> Rgb {
        let frame = frame_of(&met.point);
        let beyond = self.carrier.bodies.beyond(media, &met.point, &frame, wo);
        let shading = Shading {
            point: &met.point,
            frame: &frame,
            scattering,
            wo,
            absorption: [media.absorption(), beyond],
            advice: None,
        };
        self.sources
            .direct(&shading, Reach::First, strategies, sampler, rays)
    }

    /// Radiance of sky and sun along a ray that meets nothing.
    fn escaping_radiance(&self, w: DVec3, last: Option<&LastScattering>) -> Rgb {
        let sources = &self.sources;
        let weighted = |radiance: Rgb, pdf: &dyn Fn() -> f64| match last {
            Some(last) if !radiance.is_black() => {
                radiance * power_heuristic(last.pdf_solid_angle, pdf())
            }
            Some(_) | None => radiance,
        };
        weighted(sources.sky_radiance(w), &|| {
            sources.sky_pdf_solid_angle(w, Reach::First)
        }) + weighted(sources.sun_radiance(w), &|| {
            sources.sun_pdf_solid_angle(w, Reach::First)
        })
    }

    /// Radiance that a surface sends back by itself along the ray that met it.
    fn emitted_radiance(&self, met: &Met<'_>, last: Option<&LastScattering>) -> Rgb {
        let emission = met.optics.emission[usize::from(!met.point.is_front)];
        match last {
            Some(last) if !emission.is_black() => {
                let asked =
                    self.sources
                        .emitter_pdf_solid_angle(&met.point, &last.from, Reach::First);
                emission * power_heuristic(last.pdf_solid_angle, asked)
            }
            Some(_) | None => emission,
        }
    }
}
