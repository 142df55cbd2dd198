//! From the camera to a solution: direct and solved light at matt surfaces, or what rays gather there; everything else followed further.

use super::{FinalGather, OneSide, SolvedLight, Spot};
use crate::color::Rgb;
use crate::integrator::carrier::{facing, frame_of};
use crate::integrator::medium::Media;
use crate::integrator::path::Strategies;
use crate::integrator::sources::{Reach, receiver};
use crate::integrator::viewer::{Arriving, Asked, LastScattering, Seen, Viewer};
use crate::integrator::{RadianceEstimator, RayCounts};
use crate::material::{Scattering, Transport};
use crate::math::Ray;
use crate::sampler::Sampler;
use crate::scene::Piece;
use glam::DVec3;
use std::f64::consts::FRAC_1_PI;
use std::sync::Arc;

/// Vertices from a ray of a gather to the ray that the surface that it meets gathers with.
const SECOND: u32 = 1 << 7;

/// First vertex of the only ray of a sample of the picture.
const OWN: u32 = 1 << 21;

/// A solution, and what looking at it needs.
pub(in crate::integrator) struct View<'s, L> {
    pub(in crate::integrator) viewer: Viewer<'s>,
    pub(in crate::integrator) light: Arc<L>,
    /// How indirect light is found where the camera looks; `None`: the solution knows it.
    pub(in crate::integrator) gather: Option<Arc<FinalGather>>,
}

/// Who wants to know what light comes along a ray.
#[derive(Clone, Copy, Debug)]
pub(super) enum Asker {
    /// The camera: all of it.
    Camera,
    /// A matt surface: what has been scattered into many directions on its way, and of sources what [`SolvedLight::behind`] says.
    Gather {
        /// The first vertex whose random numbers the ray may use.
        vertex: u32,
        /// Whether surfaces whose light the solution does not resolve gather themselves.
        may_go_on: bool,
        /// The surface, if it leaves sources that the ray meets to it in part.
        last: Option<LastScattering>,
    },
}

/// Where a matt surface takes its indirect light from.
#[derive(Clone, Copy, Debug, PartialEq)]
enum Indirect {
    /// From the solution.
    Solved,
    /// From a ray, whose vertices begin here. It also finds part of the light that comes straight from sources: of a wide sky
    /// between leaves it finds more than the one direction that is asked for.
    OneRay(u32),
    /// From many rays: what the cache has for the front and for the back, and how certain that is.
    Gathered([(Rgb, f64); 2]),
}

impl<L: SolvedLight> RadianceEstimator for View<'_, L> {
    fn incident_radiance(&self, ray: &Ray, sampler: &mut Sampler, rays: &mut RayCounts) -> Rgb {
        let media = self.viewer.carrier.bodies.around(ray.origin);
        self.light_along(ray, media, Asker::Camera, sampler, rays)
            .radiance
    }
}

impl<L: SolvedLight> View<'_, L> {
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
                behind: self.light.behind(),
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
    /// Where a ray of a gather meets a surface the solution knows, unless that is too near to where the ray comes from, as in corners:
    /// it blurs light that lies between the two over both. Nor is it asked on small pieces like leaves that it knows only as a
    /// whole: it is right in the mean, but a leaf of a forest has met a photon or none.
    fn indirect(
        &self,
        seen: &Seen<'_>,
        sides: &[(Rgb, OneSide<'_>); 2],
        asker: Asker,
        rays: &mut RayCounts,
    ) -> Indirect {
        let spot = &sides[0].1.spot;
        let is_small = self.light.knows_wholly(spot.piece);
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
                if is_small || seen.gone < self.light.blur(spot) {
                    Indirect::OneRay(vertex.wrapping_add(SECOND))
                } else {
                    Indirect::Solved
                }
            }
            (Asker::Camera | Asker::Gather { .. }, _) => Indirect::Solved,
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
        let piece = if L::BY_PIECES || self.gather.is_some() {
            scene.piece(point.primitive)
        } else {
            Piece::Large
        };
        let spot = Spot {
            hit: &seen.met.hit,
            point,
            piece: &piece,
        };
        let near = usize::from(point.normal_g.dot(wo) < 0.0);
        let front = facing(point.normal_g, wo);
        let side = |normal| OneSide {
            spot,
            normal,
            wo,
            media: seen.media,
        };
        let sides = [
            (matt.sides[near].reflectance, side(front)),
            (matt.sides[1 - near].transmittance, side(-front)),
        ];
        let indirect = self.indirect(seen, &sides, asker, rays);
        let (reach, is_summed) = match asker {
            Asker::Camera => (Reach::First, false),
            Asker::Gather { .. } => (Reach::Later, true),
        };
        let strategies = match indirect {
            Indirect::OneRay(_) => Strategies::Both,
            Indirect::Solved | Indirect::Gathered(_) => Strategies::LightsOnly,
        };
        let ways = (reach, strategies);
        let direct = self.viewer.direct(seen, &matt, ways, sampler, rays);
        let mut scattered = Rgb::BLACK;
        for (nth, (share, side)) in sides.iter().enumerate() {
            if share.is_black() {
                continue;
            }
            let focused = || self.light.focused(scene, &spot, side.normal, is_summed);
            let found = match (indirect, &self.gather) {
                (Indirect::Gathered(cached), Some(gather)) => {
                    let spot = (side, seen.gone);
                    self.accurate_irradiance(gather, spot, cached[nth], sampler, rays) + focused()
                }
                (Indirect::OneRay(vertex), _) => {
                    let goes_on = matches!(asker, Asker::Camera);
                    let last = |wi| Some(scattering(seen, &matt, wi, reach));
                    self.irradiance_by_ray(side, (vertex, goes_on), last, sampler, rays) + focused()
                }
                (Indirect::Gathered(_) | Indirect::Solved, _) => {
                    self.light.solved(scene, &spot, side.normal, is_summed)
                }
            };
            scattered += *share * found;
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
