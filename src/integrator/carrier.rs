//! Rays that go on through what is not matt: panes, holes, mirrors, glass, gloss.

use super::RayCounts;
use super::medium::{Bodies, Media, left_after};
use super::path::highest_survival;
use crate::color::Rgb;
use crate::material::{
    Density, Optics, ScatterNumbers, Scattering, ScatteringFrame, Side, Transport,
};
use crate::math::Ray;
use crate::sampler::{Sampler, Use};
use crate::scene::{Hit, Scene, SurfacePoint};
use glam::DVec3;

/// Scatterings after which dim rays end by chance.
const ROULETTE_AFTER: u32 = 3;

/// What carrying rays needs to know.
#[derive(Debug)]
pub(super) struct Carrier<'s> {
    pub(super) scene: &'s Scene,
    pub(super) bodies: Bodies<'s>,
    /// How often a ray is mirrored, refracted or scattered glossily.
    pub(super) max_depth: u32,
}

/// The surface that a ray meets, unless it meets none.
pub(super) struct Way<'s> {
    pub(super) end: Option<Met<'s>>,
    /// What is left of the light on the way, what chance took made up for.
    pub(super) weight: Rgb,
    /// How far away that is, metres; infinite where there is none.
    pub(super) distance: f64,
}

/// A surface that a ray meets.
pub(super) struct Met<'s> {
    pub(super) hit: Hit,
    pub(super) point: SurfacePoint,
    pub(super) optics: Optics<'s>,
}

/// A ray that goes on.
pub(super) struct Onward {
    pub(super) ray: Ray,
    /// What scattering multiplies its light with.
    pub(super) weight: Rgb,
    pub(super) compression: f64,
    /// Density per steradian with which its direction was chosen, unless there was only one.
    pub(super) pdf_solid_angle: Option<f64>,
}

/// Roulette: the weight of what goes on, if it does.
pub(super) fn survivor(
    throughput: Rgb,
    compression: f64,
    depth: u32,
    sampler: &Sampler,
) -> Option<Rgb> {
    if throughput.is_black() {
        return None;
    }
    if depth < ROULETTE_AFTER {
        return Some(throughput);
    }
    let worth = throughput.max_channel() / compression;
    let survival = worth.min(highest_survival(depth));
    (sampler.point(Use::Choice).y < survival).then(|| throughput / survival)
}

impl<'s> Carrier<'s> {
    /// Follows a ray to the surface that it meets; what lets light straight through is met by chance.
    pub(super) fn follow(
        &self,
        ray: &Ray,
        media: &Media,
        sampler: &Sampler,
        rays: &mut RayCounts,
    ) -> Way<'s> {
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
                    end: Some(Met { hit, point, optics }),
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

    /// Chooses where a ray goes on that meets a surface which mirrors, refracts or scatters glossily.
    pub(super) fn scatter(
        &self,
        met: &Met<'_>,
        wo: DVec3,
        media: &mut Media,
        transport: Transport,
        sampler: &Sampler,
    ) -> Option<Onward> {
        let numbers = ScatterNumbers {
            direction: sampler.point(Use::Direction),
            lobe: sampler.point(Use::Lobe),
        };
        let frame = frame_of(&met.point);
        let sample = lobes_of(&met.optics).sample(&frame, wo, numbers, transport)?;
        self.bodies
            .cross(media, &met.point, &frame, [wo, sample.wi]);
        Some(Onward {
            ray: met.point.spawn_ray(sample.wi),
            weight: sample.weight,
            compression: sample.compression,
            pdf_solid_angle: match sample.density {
                Density::Delta => None,
                Density::SolidAngle(pdf) => Some(pdf),
            },
        })
    }

    /// Carries a ray from surface to surface, as long as there is more than a matt part to go on from; `meets` is told of all
    /// of them, each with what is left of the light.
    pub(super) fn carry(
        &self,
        ray: &Ray,
        transport: Transport,
        sampler: &mut Sampler,
        rays: &mut RayCounts,
        mut meets: impl FnMut(&Met<'s>, Rgb),
    ) {
        let mut media = self.bodies.around(ray.origin);
        let mut ray = *ray;
        let mut throughput = Rgb::WHITE;
        let mut compression = 1.0;
        for depth in 0..=self.max_depth {
            sampler.start_vertex(depth + 1);
            let way = self.follow(&ray, &media, sampler, rays);
            throughput *= way.weight;
            let Some(met) = way.end else { return };
            meets(&met, throughput);
            if met.optics.scattering.is_matt() {
                return;
            }
            let wo = -ray.direction;
            let onward = self.scatter(&met, wo, &mut media, transport, sampler);
            let Some(onward) = onward else { return };
            compression *= onward.compression;
            let left = survivor(throughput * onward.weight, compression, depth, sampler);
            let Some(left) = left else { return };
            throughput = left;
            ray = onward.ray;
        }
    }
}

pub(super) fn frame_of(point: &SurfacePoint) -> ScatteringFrame {
    ScatteringFrame {
        normal_g: point.normal_g,
        normal_s: point.normal_s,
    }
}

/// The normal, turned to the side of `w`.
pub(super) fn facing(normal: DVec3, w: DVec3) -> DVec3 {
    if normal.dot(w) >= 0.0 {
        normal
    } else {
        -normal
    }
}

/// A surface without its matt part.
pub(super) fn lobes_of<'o>(optics: &Optics<'o>) -> Scattering<'o> {
    Scattering {
        sides: [Side::default(); 2],
        lobes: optics.scattering.lobes,
    }
}
