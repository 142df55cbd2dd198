//! Final gather: indirect light at a surface by rays into its half-space, instead of from the solution itself.
//!
//! A map of photons is blurred over its kernel and noisy, radiosity over its elements; a mean of them over a half-space is neither
//! ([`Jensen1996`](crate::references#jensen1996), [`CohenWallace1993`](crate::references#cohenwallace1993) §10). What a ray carries is what the
//! surface that it meets sends back as matt: direct light, asked of the [sources](crate::integrator::sources) there, focused light if the
//! solution holds it apart, and indirect light from the [solution](SolvedLight). What shines by itself is left out: it is the direct light
//! of the surface that gathers; whether it counts behind mirrors and glass is for the solution to say. What a
//! ray finds behind a glossy surface counts wholly, as solutions have it.
//!
//! Rays that end nearer than the solution can resolve gather on with one ray, so corners do not leak.
//!
//! Where indirect light changes slowly it comes from a [cache], whose records send more rays where light is uneven
//! ([`hemisphere`]). Elsewhere (in corners, far away) each sample of the picture sends [`FinalGather::own_rays`]
//! rays: few, because samples add up. Every other one goes where a record nearby has found light ([`guide`]); both
//! kinds are weighed by the balance heuristic ([`VeachGuibas1995`](crate::references#veachguibas1995)), so it costs no bias.
//! Under a sky, and from leaves that the solution knows only as a whole, it is one ray, which also finds its part of the direct light.
//!
//! ```text
//! view        from the camera to the solution  hemisphere  irradiance and its gradients by rays
//! cache       gathered irradiance, kept        guide       directions that light comes from
//! ```

mod cache;
mod guide;
mod hemisphere;
mod view;

use super::RayCounts;
use super::carrier::{facing, frame_of};
use super::medium::Media;
use super::viewer::{Behind, LastScattering};
use crate::color::Rgb;
use crate::math::frame::Frame;
use crate::math::{Ray, rng, warp};
use crate::sampler::{Sampler, Use};
use crate::scene::{Hit, Piece, Scene, SurfacePoint};
use cache::{Asked, Gather, IrradianceCache, Place};
use glam::DVec3;
use guide::Guide;
use hemisphere::{Gathered, Hemisphere};
use std::f64::consts::PI;
use std::sync::{Arc, OnceLock};
use view::Asker;
pub(super) use view::View;

/// The most rays of a final gather; more are as many.
pub const MOST_GATHER_RAYS: u32 = 1 << 16;

/// First vertex of the rays of a sample of the picture, and vertices from those that go everywhere to those that are guided.
const FIRST_VERTEX: u32 = 1 << 22;
const VERTICES: u32 = 1 << 9;

/// Rays of the cache for each ray of a sample of the picture: samples of a pixel add up.
const RAYS_PER_OWN: u32 = 32;

/// Rays of a first look round a place.
const LOOKS: u32 = 12;

/// How far above a place its surface is looked for, in spacings of the places, which are stored with 24 bits.
const LIFT: f64 = 0.02;

/// A point of a surface.
#[derive(Clone, Copy)]
pub(super) struct Spot<'a> {
    pub(super) hit: &'a Hit,
    pub(super) point: &'a SurfacePoint,
    pub(super) piece: &'a Piece,
}

/// Places all over surfaces, each with the normal of a side.
#[derive(Debug)]
pub(super) struct Places {
    /// Distance between neighbours, metres.
    pub(super) spacing: f64,
    pub(super) all: Vec<(DVec3, DVec3)>,
}

impl Places {
    /// No place.
    pub(super) const NONE: Self = Self {
        spacing: 1.0,
        all: Vec::new(),
    };
}

/// The light of surfaces as a solution knows it, without what views ask sources for.
pub(super) trait SolvedLight: Send + Sync {
    /// Whether it is known by [`Piece`]s.
    const BY_PIECES: bool;

    /// Whether rays that gather count light of sources that nobody can ask for, as of endless planes that shine.
    const HAS_UNASKED: bool;

    /// Which sources behind mirrors and glass count for rays that gather: those whose light is not [focused](Self::focused).
    fn behind(&self) -> Behind;

    /// Indirect irradiance of the side of a point that this normal is of, W/m² per channel. What is one of many in a sum may be coarse.
    fn indirect(&self, scene: &Scene, spot: &Spot<'_>, side: DVec3, is_summed: bool) -> Rgb;

    /// Irradiance of light that mirrors and glass throw there from sources, if it is held apart; W/m² per channel.
    fn focused(&self, scene: &Scene, spot: &Spot<'_>, side: DVec3, is_summed: bool) -> Rgb;

    /// Both, as a view shows them that does not gather.
    fn solved(&self, scene: &Scene, spot: &Spot<'_>, side: DVec3, is_summed: bool) -> Rgb {
        self.indirect(scene, spot, side, is_summed) + self.focused(scene, spot, side, is_summed)
    }

    /// Whether a piece is so small that its light is known only as a whole.
    fn knows_wholly(&self, piece: &Piece) -> bool;

    /// How far light is blurred there, metres: rays of gathers that are shorter do not take it from here.
    fn blur(&self, spot: &Spot<'_>) -> f64;

    /// Where gathered light may be kept.
    fn places(&self, scene: &Scene) -> Places;

    /// The gather that was the first to be asked for, if anything was.
    fn kept(&self) -> &OnceLock<Arc<FinalGather>>;
}

/// What the records of a cache depend on, besides scene and solution.
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
    settings: GatherSettings,
    cache: IrradianceCache,
}

impl FinalGather {
    /// A gather over a solution: the one that it keeps if that is for the same settings, otherwise one that has not been asked yet.
    pub(super) fn over(
        light: &impl SolvedLight,
        scene: &Scene,
        settings: GatherSettings,
    ) -> Arc<Self> {
        let settings = GatherSettings {
            rays: settings.rays.min(MOST_GATHER_RAYS),
            ..settings
        };
        let new = || Arc::new(Self::new(light, scene, settings));
        let kept = light.kept().get_or_init(new);
        if kept.settings == settings {
            Arc::clone(kept)
        } else {
            new()
        }
    }

    fn new(light: &impl SolvedLight, scene: &Scene, settings: GatherSettings) -> Self {
        let bounds = scene.bounds();
        let (center, size) = if bounds.is_empty() {
            (DVec3::ZERO, 1.0)
        } else {
            (bounds.center(), bounds.diagonal().length())
        };
        Self {
            settings,
            cache: IrradianceCache::new(light.places(scene), center, size),
        }
    }

    /// Rays of a sample of the picture where the cache does not answer.
    fn own_rays(&self) -> u32 {
        self.settings.rays.div_ceil(RAYS_PER_OWN)
    }
}

/// One side of a matt surface at a point.
struct OneSide<'a> {
    spot: Spot<'a>,
    /// Geometric normal of the side.
    normal: DVec3,
    /// Where the point is seen from, through `media`; perhaps from the other side.
    wo: DVec3,
    media: &'a Media,
}

impl OneSide<'_> {
    /// A question to the cache for an eye that is so far away.
    fn asked(&self, eye: f64) -> Asked {
        // A level that is wider than a leaf knows nothing of it.
        let flat = match *self.spot.piece {
            Piece::Flat { size, .. } => size,
            Piece::Body { flat, .. } => flat,
            Piece::Large => f64::INFINITY,
        };
        Asked {
            position: self.spot.point.position,
            normal: self.normal,
            flat,
            eye,
        }
    }
}

/// The scattering that a ray of many comes from, whose point has asked sources already.
fn last_of_many<L: SolvedLight>(position: DVec3) -> Option<LastScattering> {
    L::HAS_UNASKED.then(|| LastScattering::asked_at(position))
}

impl<L: SolvedLight> View<'_, L> {
    /// Indirect irradiance of a side for an eye that is so far away, W/m² per channel, as the cache has it, and how certain
    /// that is: 1 wholly, 0 not at all.
    fn cached_irradiance(
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
    fn accurate_irradiance(
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
                    last: last_of_many::<L>(spot.spot.point.position),
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
    fn irradiance_by_ray(
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
        let (bodies, point) = (&self.viewer.carrier.bodies, spot.spot.point);
        bodies.cross(&mut media, point, &frame_of(point), [spot.wo, wi]);
        let ray = point.spawn_ray(wi);
        self.light_along(&ray, media, asker, sampler, rays).radiance
    }
}

/// Gathers for the cache. What it finds depends on nothing but the scene, the solution and the number of a place, so it does not matter
/// who asks first.
struct Gathering<'a, 's, L> {
    view: &'a View<'s, L>,
    gather: &'a FinalGather,
    rays: &'a mut RayCounts,
}

impl<L: SolvedLight> Gathering<'_, '_, L> {
    /// The surface at a place, if it is found again, and a point above it.
    fn surface(&mut self, place: &Place) -> Option<(Hit, SurfacePoint, DVec3)> {
        let scene = self.view.viewer.carrier.scene;
        let normal = place.normal.as_dvec3();
        let lift = LIFT * self.gather.cache.spacing();
        let above = self.gather.cache.position(place) + normal * lift;
        let down = Ray::new(above, -normal).until(2.0 * lift);
        self.rays.closest += 1;
        let hit = scene.closest(&down)?;
        let point = scene.surface(&down, &hit);
        let is_same = point.normal_g.dot(normal).abs() >= IrradianceCache::SAME_NORMAL;
        is_same.then_some((hit, point, above))
    }
}

impl<L: SolvedLight> Gather for Gathering<'_, '_, L> {
    fn nearest(&mut self, _at: usize, place: &Place) -> f64 {
        let Some((_, point, _)) = self.surface(place) else {
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
        let (hit, point, above) = self.surface(place)?;
        let media = self.view.viewer.carrier.bodies.around(above);
        let stream = rng::hash(&[self.gather.settings.seed, at as u64]);
        let side = facing(point.normal_g, place.normal.as_dvec3());
        let hemisphere = Hemisphere::new(side, self.gather.settings.rays);
        let scene = self.view.viewer.carrier.scene;
        let spot = Spot {
            hit: &hit,
            point: &point,
            piece: &scene.piece(point.primitive),
        };
        let expected = self.view.light.indirect(scene, &spot, side, false);
        let expected = expected.r + expected.g + expected.b;
        Some(hemisphere.gather(stream, expected, |wi, sampler| {
            let asker = Asker::Gather {
                vertex: 0,
                may_go_on: true,
                last: last_of_many::<L>(point.position),
            };
            let ray = point.spawn_ray(wi);
            self.view
                .light_along(&ray, media, asker, sampler, self.rays)
        }))
    }
}
