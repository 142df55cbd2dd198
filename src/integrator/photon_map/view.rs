//! From the camera to the maps: direct light and stored light at matt surfaces, everything else followed further.

use super::PhotonSolution;
use super::final_gather::{FinalGather, OneSide};
use super::irradiance::IrradianceMap;
use super::stored::facing;
use crate::color::Rgb;
use crate::integrator::carrier::frame_of;
use crate::integrator::medium::Media;
use crate::integrator::path::Strategies;
use crate::integrator::sources::{Reach, receiver};
use crate::integrator::viewer::{Arriving, Asked, LastScattering, Seen, Viewer};
use crate::integrator::{RadianceEstimator, RayCounts};
use crate::material::{Scattering, Transport};
use crate::math::Ray;
use crate::sampler::Sampler;
use glam::DVec3;
use std::f64::consts::FRAC_1_PI;
use std::sync::Arc;

/// Vertices from a ray of a gather to the ray that the surface that it meets gathers with.
const SECOND: u32 = 1 << 7;

/// First vertex of the only ray of a sample of the picture.
const OWN: u32 = 1 << 21;

/// Rays of a gather that are shorter than so many radii of the kernel end where the map is not trusted.
const NEAR: f64 = 2.0;

/// The maps, and what looking at them needs.
pub(super) struct View<'s> {
    pub(super) viewer: Viewer<'s>,
    pub(super) maps: Arc<PhotonSolution>,
    /// How indirect light is found where the camera looks; `None`: in the map.
    pub(super) gather: Option<Arc<FinalGather>>,
}

/// Who wants to know what light comes along a ray.
#[derive(Clone, Copy, Debug)]
pub(super) enum Asker {
    /// The camera: all of it.
    Camera,
    /// A matt surface: what has been scattered into many directions on its way. Caustics it has already.
    Gather {
        /// The first vertex whose random numbers the ray may use.
        vertex: u32,
        /// Whether surfaces that the map does not resolve gather themselves.
        may_go_on: bool,
        /// The surface, if it leaves sources that the ray meets to it in part.
        last: Option<LastScattering>,
    },
}

/// Where a matt surface takes its indirect light from.
#[derive(Clone, Copy, Debug, PartialEq)]
enum Indirect {
    /// From the map.
    Stored,
    /// From a ray, whose vertices begin here. It also finds part of the light that comes straight from sources: of a wide sky
    /// between leaves it finds more than the one direction that is asked for.
    OneRay(u32),
    /// From many rays: what the cache has for the front and for the back, and how certain that is.
    Gathered([(Rgb, f64); 2]),
}

impl RadianceEstimator for View<'_> {
    fn incident_radiance(&self, ray: &Ray, sampler: &mut Sampler, rays: &mut RayCounts) -> Rgb {
        let media = self.viewer.carrier.bodies.around(ray.origin);
        self.light_along(ray, media, Asker::Camera, sampler, rays)
            .radiance
    }
}

impl View<'_> {
    /// Light that comes along a ray that starts amid `media`.
    pub(super) fn light_along(
        &self,
        ray: &Ray,
        media: Media,
        asker: Asker,
        sampler: &mut Sampler,
        rays: &mut RayCounts,
    ) -> Arriving {
        let asked = match asker {
            Asker::Camera => Asked::CAMERA,
            Asker::Gather { vertex, last, .. } => Asked {
                first_vertex: vertex,
                is_camera: false,
                last,
            },
        };
        let matt = |seen: &Seen<'_>, sampler: &Sampler, rays: &mut RayCounts| {
            self.matt_radiance(seen, asker, sampler, rays)
        };
        self.viewer
            .light_along((ray, media), asked, sampler, rays, matt)
    }

    /// Where a surface with sides that scatter so takes its indirect light from.
    ///
    /// Where a ray of a gather meets a surface the map does unless that is too near to where the ray comes from, as in corners: it
    /// blurs light that lies between the two over both. Nor on small pieces like leaves: what it knows of each is right in
    /// the mean, but a leaf of a forest has met a photon or none.
    fn indirect(
        &self,
        seen: &Seen<'_>,
        sides: &[(Rgb, OneSide<'_>); 2],
        asker: Asker,
        rays: &mut RayCounts,
    ) -> Indirect {
        let map = self.maps.global.as_ref();
        let is_small = map.is_some_and(|map| map.knows_wholly(sides[0].1.piece));
        match (asker, &self.gather) {
            (Asker::Camera, Some(gather)) if !seen.is_by_gloss => {
                if is_small {
                    return Indirect::OneRay(OWN);
                }
                let cached = |(share, side): &(Rgb, OneSide<'_>)| {
                    if share.is_black() {
                        (Rgb::BLACK, 0.0)
                    } else {
                        self.cached_irradiance(gather, side, seen.gone, rays)
                    }
                };
                let cached = sides.each_ref().map(cached);
                // Under a sky its direct light is the noise: more rays than one would do little.
                let is_unknown = cached.iter().all(|(_, certain)| *certain <= 0.0);
                if is_unknown && self.viewer.sources.has_sky() {
                    Indirect::OneRay(OWN)
                } else {
                    Indirect::Gathered(cached)
                }
            }
            (
                Asker::Gather {
                    vertex,
                    may_go_on: true,
                    ..
                },
                _,
            ) if seen.depth == 0 => {
                let radius = map.map_or(0.0, IrradianceMap::radius);
                if is_small || seen.gone < NEAR * radius {
                    Indirect::OneRay(vertex.wrapping_add(SECOND))
                } else {
                    Indirect::Stored
                }
            }
            (Asker::Camera | Asker::Gather { .. }, _) => Indirect::Stored,
        }
    }

    /// Direct, indirect and focused light that the matt part of a surface sends to where it is seen from.
    fn matt_radiance(
        &self,
        seen: &Seen<'_>,
        asker: Asker,
        sampler: &Sampler,
        rays: &mut RayCounts,
    ) -> Rgb {
        let (point, wo) = (&seen.met.point, seen.wo);
        let matt = Scattering {
            sides: seen.met.optics.scattering.sides,
            lobes: &[],
        };
        if !matt.is_smooth() {
            return Rgb::BLACK;
        }
        let scene = self.viewer.carrier.scene;
        let piece = &scene.piece(point.primitive);
        let near = usize::from(point.normal_g.dot(wo) < 0.0);
        let front = facing(point.normal_g, wo);
        let side = |normal| OneSide {
            point,
            piece,
            normal,
            wo,
            media: seen.media,
        };
        let sides = [
            (matt.sides[near].reflectance, side(front)),
            (matt.sides[1 - near].transmittance, side(-front)),
        ];
        let indirect = self.indirect(seen, &sides, asker, rays);
        let reach = match asker {
            Asker::Camera => Reach::First,
            Asker::Gather { .. } => Reach::Later,
        };
        let strategies = match indirect {
            Indirect::OneRay(_) => Strategies::Both,
            Indirect::Stored | Indirect::Gathered(_) => Strategies::LightsOnly,
        };
        let ways = (reach, strategies);
        let direct = self.viewer.direct(seen, &matt, ways, sampler, rays);
        let mut scattered = Rgb::BLACK;
        for (nth, (share, side)) in sides.iter().enumerate() {
            if share.is_black() {
                continue;
            }
            let stored = |map: &Option<IrradianceMap>| match (map, asker) {
                (Some(map), Asker::Camera) => map.irradiance(scene, point, piece, side.normal),
                (Some(map), Asker::Gather { .. }) => {
                    map.coarse_irradiance(scene, point, piece, side.normal)
                }
                (None, _) => Rgb::BLACK,
            };
            let found = match (indirect, &self.gather) {
                (Indirect::Gathered(cached), Some(gather)) => {
                    let spot = (side, seen.gone);
                    self.accurate_irradiance(gather, spot, cached[nth], sampler, rays)
                }
                (Indirect::OneRay(vertex), _) => {
                    let goes_on = matches!(asker, Asker::Camera);
                    let last = |wi| Some(scattering(seen, &matt, wi, reach));
                    self.irradiance_by_ray(side, (vertex, goes_on), last, sampler, rays)
                }
                (Indirect::Gathered(_) | Indirect::Stored, _) => stored(&self.maps.global),
            };
            scattered += *share * (found + stored(&self.maps.caustic));
        }
        direct + scattered * FRAC_1_PI
    }
}

/// A surface as that which a ray towards `wi` comes from, where part of the light of sources is left to that ray.
fn scattering(seen: &Seen<'_>, matt: &Scattering<'_>, wi: DVec3, reach: Reach) -> LastScattering {
    let frame = frame_of(&seen.met.point);
    LastScattering {
        from: receiver(&seen.met.point, &frame, matt, seen.wo),
        pdf_solid_angle: matt.pdf_solid_angle(&frame, seen.wo, wi, Transport::Radiance),
        reach,
    }
}
