//! From the camera to the maps: direct light and stored light at matt surfaces, everything else followed further.

use super::PhotonSolution;
use super::stored::facing;
use crate::color::Rgb;
use crate::integrator::medium::{Bodies, Media, left_after};
use crate::integrator::mis::power_heuristic;
use crate::integrator::path::Strategies;
use crate::integrator::sources::{Reach, Shading, Sources, receiver};
use crate::integrator::{RadianceEstimator, RayCounts};
use crate::light::Receiver;
use crate::material::{
    Density, Optics, ScatterNumbers, Scattering, ScatteringFrame, Side, Transport,
};
use crate::math::Ray;
use crate::sampler::{Sampler, Use};
use crate::scene::{Scene, SurfacePoint};
use glam::DVec3;
use std::f64::consts::FRAC_1_PI;
use std::sync::Arc;

/// Pads of glossy parts: their questions to lights must not be those of the matt part.
const GLOSSY: u32 = 1 << 20;

/// Scatterings after which dim paths end by chance, and the highest chance to go on.
const ROULETTE_AFTER: u32 = 3;
const HIGHEST_SURVIVAL: f64 = 0.99;

/// The maps, and what looking at them needs.
pub(super) struct View<'s> {
    pub(super) scene: &'s Scene,
    pub(super) sources: Sources<'s>,
    pub(super) bodies: Bodies<'s>,
    pub(super) maps: Arc<PhotonSolution>,
    pub(super) max_depth: u32,
}

/// The glossy scattering that a ray comes from, if lights were asked there.
#[derive(Clone, Copy)]
struct LastScattering {
    from: Receiver,
    pdf_solid_angle: f64,
}

/// The surface that a ray's light comes from, unless it meets none.
struct Way<'s> {
    end: Option<(SurfacePoint, Optics<'s>)>,
    /// What is left of the light on the way, what chance took made up for.
    weight: Rgb,
}

/// A ray that is still to be followed.
struct Onward {
    ray: Ray,
    /// What scattering multiplies its light with.
    weight: Rgb,
    compression: f64,
    last: Option<LastScattering>,
}

/// A surface, and the direction it is seen from.
struct Seen<'a> {
    point: &'a SurfacePoint,
    optics: &'a Optics<'a>,
    wo: DVec3,
}

impl RadianceEstimator for View<'_> {
    fn incident_radiance(&self, ray: &Ray, sampler: &mut Sampler, rays: &mut RayCounts) -> Rgb {
        let mut radiance = Rgb::BLACK;
        let mut throughput = Rgb::WHITE;
        let mut compression = 1.0;
        let mut last: Option<LastScattering> = None;
        let mut media = self.bodies.around(ray.origin);
        let mut ray = *ray;
        for depth in 0.. {
            sampler.start_vertex(depth + 1);
            let way = self.follow(&ray, &media, sampler, rays);
            throughput *= way.weight;
            let Some((point, optics)) = way.end else {
                radiance += throughput * self.escaping_radiance(ray.direction, last);
                break;
            };
            radiance += throughput * self.emitted_radiance(&point, &optics, last);
            let wo = -ray.direction;
            let seen = Seen {
                point: &point,
                optics: &optics,
                wo,
            };
            radiance += throughput * self.matt_radiance(&seen, &media, sampler, rays);
            if optics.scattering.is_matt() || depth >= self.max_depth {
                break;
            }
            sampler.start_vertex(GLOSSY + depth);
            radiance += throughput * self.glossy_direct(&seen, &media, sampler, rays);
            let onward = self.scatter(&point, &optics, wo, &mut media, sampler);
            let Some(onward) = onward else { break };
            throughput *= onward.weight;
            compression *= onward.compression;
            if throughput.is_black() {
                break;
            }
            if depth >= ROULETTE_AFTER {
                let worth = throughput.max_channel() / compression;
                let survival = worth.min(HIGHEST_SURVIVAL);
                if sampler.point(Use::Choice).y >= survival {
                    break;
                }
                throughput *= 1.0 / survival;
            }
            (ray, last) = (onward.ray, onward.last);
        }
        radiance
    }
}

impl<'s> View<'s> {
    /// Follows a ray to the surface that its light comes from; what lets light straight through is met by chance.
    fn follow(&self, ray: &Ray, media: &Media, sampler: &Sampler, rays: &mut RayCounts) -> Way<'s> {
        let absorption = media.absorption();
        let mut weight = Rgb::WHITE;
        let mut passages = 0..u16::MAX;
        rays.closest += 1;
        let mut next = self.scene.closest(ray);
        while let Some(hit) = next {
            let point = self.scene.surface(ray, &hit);
            let optics = self.scene.optics(&point);
            let meets = match passages.next() {
                Some(passage) if !optics.is_opaque() => {
                    let through = optics.passage(point.normal_g.dot(ray.direction));
                    let met = if optics.is_nothing_else() {
                        0.0
                    } else {
                        1.0 - through.mean()
                    };
                    let meets = sampler.point(Use::Passage(passage)).x < met;
                    weight *= if meets {
                        Rgb::splat(optics.alpha / met)
                    } else {
                        through / (1.0 - met)
                    };
                    meets
                }
                _ => true,
            };
            if meets {
                return Way {
                    end: Some((point, optics)),
                    weight: weight * left_after(absorption, hit.t),
                };
            }
            rays.closest += 1;
            next = self.scene.closest_after(ray, &hit);
        }
        Way {
            end: None,
            weight: weight * left_after(absorption, f64::INFINITY),
        }
    }

    /// Direct and stored light that the matt part of a surface sends along `wo`.
    fn matt_radiance(
        &self,
        seen: &Seen<'_>,
        media: &Media,
        sampler: &Sampler,
        rays: &mut RayCounts,
    ) -> Rgb {
        let Seen { point, optics, wo } = *seen;
        let matt = Scattering {
            sides: optics.scattering.sides,
            lobes: &[],
        };
        if !matt.is_smooth() {
            return Rgb::BLACK;
        }
        let direct = self.direct(seen, &matt, media, (Strategies::LightsOnly, sampler), rays);
        let near = usize::from(point.normal_g.dot(wo) < 0.0);
        let (reflectance, transmittance) = (
            matt.sides[near].reflectance,
            matt.sides[1 - near].transmittance,
        );
        let mut stored = Rgb::BLACK;
        let side = facing(point.normal_g, wo);
        let piece = self.scene.piece(point.primitive);
        for map in [&self.maps.global, &self.maps.caustic]
            .into_iter()
            .flatten()
        {
            if !reflectance.is_black() {
                stored += reflectance * map.irradiance(self.scene, point, &piece, side);
            }
            if !transmittance.is_black() {
                stored += transmittance * map.irradiance(self.scene, point, &piece, -side);
            }
        }
        direct + stored * FRAC_1_PI
    }

    /// Direct light that the glossy parts of a surface send along `wo`.
    fn glossy_direct(
        &self,
        seen: &Seen<'_>,
        media: &Media,
        sampler: &Sampler,
        rays: &mut RayCounts,
    ) -> Rgb {
        let lobes = lobes_of(seen.optics);
        if !lobes.is_smooth() {
            return Rgb::BLACK;
        }
        self.direct(seen, &lobes, media, (Strategies::Both, sampler), rays)
    }

    fn direct(
        &self,
        seen: &Seen<'_>,
        scattering: &Scattering<'_>,
        media: &Media,
        (strategies, sampler): (Strategies, &Sampler),
        rays: &mut RayCounts,
    ) -> Rgb {
        let Seen { point, wo, .. } = *seen;
        let frame = frame_of(point);
        let shading = Shading {
            point,
            frame: &frame,
            scattering,
            wo,
            absorption: [
                media.absorption(),
                self.bodies.beyond(media, point, &frame, wo),
            ],
            advice: None,
        };
        self.sources
            .direct(&shading, Reach::First, strategies, sampler, rays)
    }

    /// Chooses where the light comes from that a surface mirrors, refracts or scatters glossily.
    fn scatter(
        &self,
        point: &SurfacePoint,
        optics: &Optics<'_>,
        wo: DVec3,
        media: &mut Media,
        sampler: &Sampler,
    ) -> Option<Onward> {
        let numbers = ScatterNumbers {
            direction: sampler.point(Use::Direction),
            lobe: sampler.point(Use::Lobe),
        };
        let frame = frame_of(point);
        let lobes = lobes_of(optics);
        let sample = lobes.sample(&frame, wo, numbers, Transport::Radiance)?;
        self.bodies.cross(media, point, &frame, [wo, sample.wi]);
        Some(Onward {
            ray: point.spawn_ray(sample.wi),
            weight: sample.weight,
            compression: sample.compression,
            last: match sample.density {
                Density::Delta => None,
                Density::SolidAngle(pdf_solid_angle) => Some(LastScattering {
                    from: receiver(point, &frame, &lobes, wo),
                    pdf_solid_angle,
                }),
            },
        })
    }

    /// Radiance of sky and sun along a ray that meets nothing.
    fn escaping_radiance(&self, w: DVec3, last: Option<LastScattering>) -> Rgb {
        let dome = &self.sources;
        let weighted = |radiance: Rgb, pdf: &dyn Fn() -> f64| match last {
            Some(last) if !radiance.is_black() => {
                radiance * power_heuristic(last.pdf_solid_angle, pdf())
            }
            Some(_) | None => radiance,
        };
        weighted(dome.sky_radiance(w), &|| {
            dome.sky_pdf_solid_angle(w, Reach::First)
        }) + weighted(dome.sun_radiance(w), &|| {
            dome.sun_pdf_solid_angle(w, Reach::First)
        })
    }

    /// Radiance that a surface sends back by itself along the ray that met it.
    fn emitted_radiance(
        &self,
        point: &SurfacePoint,
        optics: &Optics<'_>,
        last: Option<LastScattering>,
    ) -> Rgb {
        let emission = optics.emission[usize::from(!point.is_front)];
        match last {
            Some(last) if !emission.is_black() => {
                let light = self
                    .sources
                    .emitter_pdf_solid_angle(point, &last.from, Reach::First);
                emission * power_heuristic(last.pdf_solid_angle, light)
            }
            Some(_) | None => emission,
        }
    }
}

fn frame_of(point: &SurfacePoint) -> ScatteringFrame {
    ScatteringFrame {
        normal_g: point.normal_g,
        normal_s: point.normal_s,
    }
}

/// A surface without its matt part.
fn lobes_of<'o>(optics: &Optics<'o>) -> Scattering<'o> {
    Scattering {
        sides: [Side::default(); 2],
        lobes: optics.scattering.lobes,
    }
}
