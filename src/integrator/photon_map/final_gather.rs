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
//! Where indirect light changes slowly it comes from a [cache](super::cache). Elsewhere (in corners, far away) each sample of
//! the picture sends [`FinalGather::own_rays`] rays: few, because samples add up. From leaves, and under a sky, it is one, which
//! also finds its part of the direct light.

use super::cache::{Asked, Gather, IrradianceCache, Place};
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

/// First vertex of the rays of a sample of the picture, and vertices of each.
const FIRST_VERTEX: u32 = 1 << 22;
const VERTICES: u32 = 1 << 8;

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
        // A level that is wider than a leaf knows nothing of it.
        let flat = match *spot.piece {
            Piece::Flat { size, .. } => size,
            Piece::Body { flat, .. } => flat,
            Piece::Large => f64::INFINITY,
        };
        let asked = Asked {
            position: spot.point.position,
            normal: spot.normal,
            flat,
            eye,
        };
        let view = self;
        let gathering = Gathering { view, gather, rays };
        gather.cache.irradiance(&asked, gathering)
    }

    /// The same, with what is not certain by rays.
    pub(super) fn accurate_irradiance(
        &self,
        gather: &FinalGather,
        spot: &OneSide<'_>,
        (cached, certain): (Rgb, f64),
        sampler: &Sampler,
        rays: &mut RayCounts,
    ) -> Rgb {
        if certain >= 1.0 {
            return cached;
        }
        let n = gather.own_rays();
        let own = self.irradiance_by_rays(spot, n, sampler, rays);
        cached * certain + own * (1.0 - certain)
    }

    /// Irradiance of a side by `n` rays whose random numbers begin at a vertex, W/m² per channel.
    fn irradiance_by_rays(
        &self,
        spot: &OneSide<'_>,
        n: u32,
        sampler: &Sampler,
        rays: &mut RayCounts,
    ) -> Rgb {
        let sum: Rgb = (0..n)
            .map(|ray| {
                let vertex = FIRST_VERTEX.wrapping_add(ray.wrapping_mul(VERTICES));
                self.irradiance_by_ray(spot, (vertex, true), |_| None, sampler, rays)
            })
            .sum();
        sum / f64::from(n.max(1))
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
        let mut media = *spot.media;
        let bodies = &self.viewer.carrier.bodies;
        let ends = [spot.wo, wi];
        bodies.cross(&mut media, spot.point, &frame_of(spot.point), ends);
        let asker = Asker::Gather {
            vertex,
            may_go_on,
            last: last(wi),
        };
        let ray = spot.point.spawn_ray(wi);
        let arriving = self.light_along(&ray, media, asker, &mut sampler, rays);
        arriving.radiance * PI
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
        Some(hemisphere.gather(stream, |wi, sampler| {
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
