//! Final gather: indirect light at a surface by rays into its half-space, instead of from the map of photons.
//!
//! The map is blurred over its kernel and noisy; a mean of it over a half-space is neither. What a ray carries is what the
//! surface that it meets sends back as matt: direct light, asked of the [sources](crate::integrator::sources) there, focused light, and
//! indirect light from the map ([`Jensen1996`](crate::references#jensen1996)). What shines by itself is left out: it is the
//! direct light of the surface that gathers, or through mirrors and glass its caustics, which come from their own map. What a
//! ray finds behind a glossy surface counts wholly, as the photons have it.
//!
//! Rays that end nearer than the map can resolve gather on with one ray, so corners do not leak.
//!
//! Where indirect light changes slowly it comes from a [cache](super::cache), whose records send more rays where light is uneven
//! ([`hemisphere`](super::hemisphere)). Elsewhere (in corners, far away) each sample of the picture sends [`FinalGather::own_rays`]
//! rays: few, because samples add up. Every other one goes where a record nearby has found light ([`guide`](super::guide)); both
//! kinds are weighed by the balance heuristic ([`VeachGuibas1995`](crate::references#veachguibas1995)), so it costs no bias.
//! From leaves, and under a sky, it is one ray, which also finds its part of the direct light.

use super::cache::{Asked, Gather, IrradianceCache, Place};
use super::guide::Guide;
use super::hemisphere::{Gathered, Hemisphere};
use super::irradiance::IrradianceMap;
use super::stored::facing;
use super::view::{Asker, View};
use crate::color::Rgb;
use crate::integrator::RayCounts;
use crate::integrator::carrier::frame_of;
use crate::integrator::medium::Media;
use crate::integrator::viewer::LastScattering;
use crate::math::frame::Frame;
use crate::math::{Ray, rng, warp};
use crate::sampler::{Sampler, Use};
use crate::scene::{Piece, Scene, SurfacePoint};
use glam::DVec3;
use std::f64::consts::PI;

/// First vertex of the rays of a sample of the picture, and vertices from those that go everywhere to those that are guided.
const FIRST_VERTEX: u32 = 1 << 22;
const VERTICES: u32 = 1 << 9;

/// Rays of the cache for each ray of a sample of the picture: samples of a pixel add up.
const RAYS_PER_OWN: u32 = 32;

/// Rays of a first look round a place.
const LOOKS: u32 = 12;

/// How far above a place its surface is looked for, in spacings of the places, which are stored with 24 bits.
const LIFT: f64 = 0.02;

/// What the records of a cache depend on, besides scene and maps.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) struct GatherSettings {
    /// Rays of each gather for the cache.
    pub(super) rays: u32,
    /// How often rays are followed through mirrors and glass.
    pub(super) max_depth: u32,
    pub(super) seed: u64,
}

/// How indirect light is gathered.
#[derive(Debug)]
pub(super) struct FinalGather {
    pub(super) settings: GatherSettings,
    cache: IrradianceCache,
}

impl FinalGather {
    /// A gather that has not been asked yet.
    pub(super) fn new(
        scene: &Scene,
        map: Option<&IrradianceMap>,
        settings: GatherSettings,
    ) -> Self {
        let bounds = scene.bounds();
        let (center, size) = if bounds.is_empty() {
            (DVec3::ZERO, 1.0)
        } else {
            (bounds.center(), bounds.diagonal().length())
        };
        Self {
            settings,
            cache: IrradianceCache::new(map, center, size),
        }
    }

    /// Rays of a sample of the picture where the cache does not answer.
    fn own_rays(&self) -> u32 {
        self.settings.rays.div_ceil(RAYS_PER_OWN)
    }
}

/// One side of a matt surface at a point.
pub(super) struct OneSide<'a> {
    pub(super) point: &'a SurfacePoint,
    pub(super) piece: &'a Piece,
    /// Geometric normal of the side.
    pub(super) normal: DVec3,
    /// Where the point is seen from, through `media`; perhaps from the other side.
    pub(super) wo: DVec3,
    pub(super) media: &'a Media,
}

impl OneSide<'_> {
    /// A question to the cache for an eye that is so far away.
    fn asked(&self, eye: f64) -> Asked {
        // A level that is wider than a leaf knows nothing of it.
        let flat = match *self.piece {
            Piece::Flat { size, .. } => size,
            Piece::Body { flat, .. } => flat,
            Piece::Large => f64::INFINITY,
        };
        Asked {
            position: self.point.position,
            normal: self.normal,
            flat,
            eye,
        }
    }
}

impl View<'_> {
    /// Indirect irradiance of a side for an eye that is so far away, W/m² per channel, as the cache has it, and how certain
    /// that is: 1 wholly, 0 not at all.
    pub(super) fn cached_irradiance(
        &self,
        gather: &FinalGather,
        spot: &OneSide<'_>,
        eye: f64,
        rays: &mut RayCounts,
    ) -> (Rgb, f64) {
        let view = self;
        let gathering = Gathering { view, gather, rays };
        gather.cache.irradiance(&spot.asked(eye), gathering)
    }

    /// The same, with what is not certain by rays.
    pub(super) fn accurate_irradiance(
        &self,
        gather: &FinalGather,
        (spot, eye): (&OneSide<'_>, f64),
        (cached, certain): (Rgb, f64),
        sampler: &Sampler,
        rays: &mut RayCounts,
    ) -> Rgb {
        if certain >= 1.0 {
            return cached;
        }
        let view = self;
        let gathering = Gathering { view, gather, rays };
        let guide = gather.cache.guide(&spot.asked(eye), gathering);
        let own = self.irradiance_by_rays(spot, (gather.own_rays(), guide), sampler, rays);
        cached * certain + own * (1.0 - certain)
    }

    /// Irradiance of a side by `n` rays, W/m² per channel: half of them everywhere, half of them where the guide expects light.
    fn irradiance_by_rays(
        &self,
        spot: &OneSide<'_>,
        (n, guide): (u32, Option<&Guide>),
        sampler: &Sampler,
        rays: &mut RayCounts,
    ) -> Rgb {
        let n_guided = guide.map_or(0, |_| n / 2);
        let n_even = n - n_guided;
        let frame = Frame::from_normal(spot.normal);
        let mut sum = Rgb::BLACK;
        for ray in 0..n {
            let (nth, of, guided) = if ray < n_even {
                (ray, n_even, None)
            } else {
                (ray - n_even, n_guided, guide)
            };
            let vertex = FIRST_VERTEX + u32::from(guided.is_some()) * VERTICES;
            let mut sampler = sampler.part(nth, of);
            sampler.start_vertex(vertex);
            let u = sampler.point(Use::Direction);
            let wi = guided.map_or_else(
                || frame.to_world(warp::cosine_hemisphere(u)),
                |guide| guide.direction(u),
            );
            let cosine = wi.dot(spot.normal).max(0.0);
            let expected = guide.map_or(0.0, |guide| guide.pdf_solid_angle(wi));
            let density = f64::from(n_even) * cosine / PI + f64::from(n_guided) * expected;
            if cosine > 0.0 {
                let asker = Asker::Gather {
                    vertex,
                    may_go_on: true,
                    last: None,
                };
                let light = self.radiance_by_ray(spot, wi, asker, &mut sampler, rays);
                // The balance heuristic over both.
                sum += light * (cosine / density);
            }
        }
        sum
    }

    /// Irradiance of a side by a ray whose random numbers begin at a vertex, W/m² per channel; `last` tells for its direction
    /// whether sources that it meets count.
    pub(super) fn irradiance_by_ray(
        &self,
        spot: &OneSide<'_>,
        (vertex, may_go_on): (u32, bool),
        last: impl FnOnce(DVec3) -> Option<LastScattering>,
        sampler: &Sampler,
        rays: &mut RayCounts,
    ) -> Rgb {
        let mut sampler = sampler.clone();
        sampler.start_vertex(vertex);
        let frame = Frame::from_normal(spot.normal);
        let wi = frame.to_world(warp::cosine_hemisphere(sampler.point(Use::Direction)));
        let asker = Asker::Gather {
            vertex,
            may_go_on,
            last: last(wi),
        };
        self.radiance_by_ray(spot, wi, asker, &mut sampler, rays) * PI
    }

    /// Radiance along a ray from a side, W/(m² sr) per channel.
    fn radiance_by_ray(
        &self,
        spot: &OneSide<'_>,
        wi: DVec3,
        asker: Asker,
        sampler: &mut Sampler,
        rays: &mut RayCounts,
    ) -> Rgb {
        let mut media = *spot.media;
        let (bodies, frame) = (&self.viewer.carrier.bodies, frame_of(spot.point));
        bodies.cross(&mut media, spot.point, &frame, [spot.wo, wi]);
        let ray = spot.point.spawn_ray(wi);
        self.light_along(&ray, media, asker, sampler, rays).radiance
    }
}

/// Gathers for the cache. What it finds depends on nothing but the scene, the maps and the number of a place, so it does not matter
/// who asks first.
struct Gathering<'a, 's> {
    view: &'a View<'s>,
    gather: &'a FinalGather,
    rays: &'a mut RayCounts,
}

impl Gathering<'_, '_> {
    /// The surface at a place, if it is found again, and a point above it.
    fn surface(&mut self, place: &Place) -> Option<(SurfacePoint, DVec3)> {
        let scene = self.view.viewer.carrier.scene;
        let normal = place.normal.as_dvec3();
        let lift = LIFT * self.gather.cache.spacing();
        let above = self.gather.cache.position(place) + normal * lift;
        let down = Ray::new(above, -normal).until(2.0 * lift);
        self.rays.closest += 1;
        let point = scene.surface(&down, &scene.closest(&down)?);
        let is_same = point.normal_g.dot(normal).abs() >= IrradianceCache::SAME_NORMAL;
        is_same.then_some((point, above))
    }
}

impl Gather for Gathering<'_, '_> {
    fn nearest(&mut self, _at: usize, place: &Place) -> f64 {
        let Some((point, _)) = self.surface(place) else {
            return 0.0;
        };
        let side = facing(point.normal_g, place.normal.as_dvec3());
        let scene = self.view.viewer.carrier.scene;
        let looks = Hemisphere::new(side, LOOKS).middles();
        self.rays.closest += u64::from(LOOKS);
        looks
            .filter_map(|wi| Some(scene.closest(&point.spawn_ray(wi))?.t))
            .fold(f64::INFINITY, f64::min)
    }

    fn gather(&mut self, at: usize, place: &Place) -> Option<Gathered> {
        let (point, above) = self.surface(place)?;
        let media = self.view.viewer.carrier.bodies.around(above);
        let stream = rng::hash(&[self.gather.settings.seed, at as u64]);
        let side = facing(point.normal_g, place.normal.as_dvec3());
        let hemisphere = Hemisphere::new(side, self.gather.settings.rays);
        let scene = self.view.viewer.carrier.scene;
        let map = self.view.maps.global.as_ref();
        let expected = map.map_or(Rgb::BLACK, |map| {
            map.irradiance(scene, &point, &scene.piece(point.primitive), side)
        });
        let expected = expected.r + expected.g + expected.b;
        Some(hemisphere.gather(stream, expected, |wi, sampler| {
            let asker = Asker::Gather {
                vertex: 0,
                may_go_on: true,
                last: None,
            };
            let ray = point.spawn_ray(wi);
            self.view
                .light_along(&ray, media, asker, sampler, self.rays)
        }))
    }
}
