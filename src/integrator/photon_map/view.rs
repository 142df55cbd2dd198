//! From the camera to the maps: direct light and stored light at matt surfaces, everything else followed further.

use super::PhotonSolution;
use super::final_gather::{FinalGather, Spot};
use super::irradiance::IrradianceMap;
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

/// Vertices from a ray of a gather to the ray that the surface that it meets gathers with.
const SECOND: u32 = 1 << 7;

/// Rays of a gather that are shorter than so many radii of the kernel end where the map is not trusted.
const NEAR: f64 = 2.0;

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
    /// How indirect light is found where the camera looks; `None`: in the map.
    pub(super) gather: Option<Arc<FinalGather>>,
}

/// Who wants to know what light comes along a ray.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Asker {
    /// The camera: all of it.
    Camera,
    /// A matt surface that has the light of sources and caustics already: what has been scattered into many directions on its way.
    Gather {
        /// The first vertex whose random numbers the ray may use.
        vertex: u32,
        /// Whether surfaces nearer than the map can resolve gather themselves.
        may_go_on: bool,
    },
}

/// Light that comes along a ray.
#[derive(Clone, Copy, Debug)]
pub(super) struct Arriving {
    pub(super) radiance: Rgb,
    /// How far away the first surface is, metres.
    pub(super) distance: f64,
}

/// Where a matt surface takes its indirect light from.
#[derive(Clone, Copy, Debug, PartialEq)]
enum Indirect {
    /// From the map.
    Stored,
    /// From a ray, whose vertices begin here.
    OneRay(u32),
    /// From many rays, for an eye at this distance in metres.
    Gathered(f64),
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
    /// How far away that is, metres.
    distance: f64,
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
    /// What is around the way there.
    media: &'a Media,
}

impl RadianceEstimator for View<'_> {
    fn incident_radiance(&self, ray: &Ray, sampler: &mut Sampler, rays: &mut RayCounts) -> Rgb {
        let media = self.bodies.around(ray.origin);
        self.light_along(ray, media, Asker::Camera, sampler, rays)
            .radiance
    }
}

impl<'s> View<'s> {
    /// Light that comes along a ray that starts amid `media`.
    pub(super) fn light_along(
        &self,
        ray: &Ray,
        mut media: Media,
        asker: Asker,
        sampler: &mut Sampler,
        rays: &mut RayCounts,
    ) -> Arriving {
        let mut radiance = Rgb::BLACK;
        let mut throughput = Rgb::WHITE;
        let mut compression = 1.0;
        let mut last: Option<LastScattering> = None;
        let (first_vertex, mut sees_sources) = match asker {
            Asker::Camera => (0, true),
            Asker::Gather { vertex, .. } => (vertex, false),
        };
        let mut ray = *ray;
        let (mut nearest, mut gone) = (f64::INFINITY, 0.0);
        for depth in 0.. {
            // Find the surface that the light comes from.
            sampler.start_vertex(first_vertex.wrapping_add(depth + 1));
            let way = self.follow(&ray, &media, sampler, rays);
            throughput *= way.weight;
            gone += way.distance;
            if depth == 0 {
                nearest = way.distance;
            }
            let Some((point, optics)) = way.end else {
                radiance += throughput
                    * if sees_sources {
                        self.escaping_radiance(ray.direction, last)
                    } else {
                        self.unsampled_radiance(ray.direction)
                    };
                break;
            };

            // What it sends by itself and as a matt surface.
            if sees_sources {
                radiance += throughput * self.emitted_radiance(&point, &optics, last);
            }
            let seen = Seen {
                point: &point,
                optics: &optics,
                wo: -ray.direction,
                media: &media,
            };
            let indirect = match asker {
                Asker::Camera if last.is_none() => Indirect::Gathered(gone),
                Asker::Gather { vertex, may_go_on } if may_go_on && depth == 0 => {
                    self.indirect_at(&point, nearest, vertex)
                }
                Asker::Camera | Asker::Gather { .. } => Indirect::Stored,
            };
            radiance += throughput * self.matt_radiance(&seen, (asker, indirect), sampler, rays);
            if optics.scattering.is_matt() || depth >= self.max_depth {
                break;
            }

            // What it mirrors, refracts or scatters glossily.
            sampler.start_vertex(first_vertex.wrapping_add(GLOSSY + depth));
            radiance += throughput * self.glossy_direct(&seen, sampler, rays);
            let onward = self.scatter(&point, &optics, -ray.direction, &mut media, sampler);
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
            sees_sources |= last.is_some();
        }
        Arriving {
            radiance,
            distance: nearest,
        }
    }

    /// Where a surface takes its indirect light from that a ray of a gather has met at this distance. The map would not do where
    /// that is too near to where the ray comes from, as in corners: it blurs light that lies between the two over both. Nor on small
    /// pieces like leaves: what it knows of each is right in the mean, but a leaf of a forest has met a photon or none.
    fn indirect_at(&self, point: &SurfacePoint, distance: f64, vertex: u32) -> Indirect {
        let Some(map) = &self.maps.global else {
            return Indirect::Stored;
        };
        let is_near = distance < NEAR * map.radius();
        if is_near || map.knows_wholly(&self.scene.piece(point.primitive)) {
            Indirect::OneRay(vertex.wrapping_add(SECOND))
        } else {
            Indirect::Stored
        }
    }

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
                    distance: hit.t,
                };
            }
            rays.closest += 1;
            next = self.scene.closest_after(ray, &hit);
        }
        Way {
            end: None,
            weight: weight * left_after(absorption, f64::INFINITY),
            distance: f64::INFINITY,
        }
    }

    /// Direct, indirect and focused light that the matt part of a surface sends to where it is seen from.
    fn matt_radiance(
        &self,
        seen: &Seen<'_>,
        (asker, indirect): (Asker, Indirect),
        sampler: &Sampler,
        rays: &mut RayCounts,
    ) -> Rgb {
        let Seen {
            point, optics, wo, ..
        } = *seen;
        let matt = Scattering {
            sides: optics.scattering.sides,
            lobes: &[],
        };
        if !matt.is_smooth() {
            return Rgb::BLACK;
        }
        let reach = match asker {
            Asker::Camera => Reach::First,
            Asker::Gather { .. } => Reach::Later,
        };
        let strategies = (reach, Strategies::LightsOnly);
        let direct = self.direct(seen, &matt, strategies, sampler, rays);
        let near = usize::from(point.normal_g.dot(wo) < 0.0);
        let side = facing(point.normal_g, wo);
        let piece = self.scene.piece(point.primitive);
        let mut scattered = Rgb::BLACK;
        for (share, normal) in [
            (matt.sides[near].reflectance, side),
            (matt.sides[1 - near].transmittance, -side),
        ] {
            if share.is_black() {
                continue;
            }
            let spot = Spot {
                point,
                piece: &piece,
                normal,
                wo,
                media: seen.media,
            };
            let stored = |map: &Option<IrradianceMap>| match (map, asker) {
                (Some(map), Asker::Camera) => map.irradiance(self.scene, point, &piece, normal),
                (Some(map), Asker::Gather { .. }) => {
                    map.coarse_irradiance(self.scene, point, &piece, normal)
                }
                (None, _) => Rgb::BLACK,
            };
            let indirect = match (indirect, &self.gather) {
                (Indirect::Gathered(eye), Some(gather)) => {
                    self.accurate_irradiance(gather, &spot, eye, sampler, rays)
                }
                (Indirect::OneRay(vertex), _) => {
                    self.irradiance_by_rays(&spot, 1, (vertex, false), sampler, rays)
                }
                (Indirect::Gathered(_) | Indirect::Stored, _) => stored(&self.maps.global),
            };
            scattered += share * (indirect + stored(&self.maps.caustic));
        }
        direct + scattered * FRAC_1_PI
    }

    /// Direct light that the glossy parts of a surface send along `wo`.
    fn glossy_direct(&self, seen: &Seen<'_>, sampler: &Sampler, rays: &mut RayCounts) -> Rgb {
        let lobes = lobes_of(seen.optics);
        if !lobes.is_smooth() {
            return Rgb::BLACK;
        }
        let strategies = (Reach::First, Strategies::Both);
        self.direct(seen, &lobes, strategies, sampler, rays)
    }

    fn direct(
        &self,
        seen: &Seen<'_>,
        scattering: &Scattering<'_>,
        (reach, strategies): (Reach, Strategies),
        sampler: &Sampler,
        rays: &mut RayCounts,
    ) -> Rgb {
        let Seen {
            point, wo, media, ..
        } = *seen;
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
            .direct(&shading, reach, strategies, sampler, rays)
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

    /// Radiance of what shines from far away and is not sampled as a source: land below the horizon of a sky.
    fn unsampled_radiance(&self, w: DVec3) -> Rgb {
        let radiance = self.sources.sky_radiance(w);
        if radiance.is_black() || self.sources.sky_pdf_solid_angle(w, Reach::First) > 0.0 {
            Rgb::BLACK
        } else {
            radiance
        }
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

pub(super) fn frame_of(point: &SurfacePoint) -> ScatteringFrame {
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
