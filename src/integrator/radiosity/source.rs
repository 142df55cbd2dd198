//! What patches get from light sources, and what they do with light.

use super::mesh::{Mesh, Node};
use super::rays::{cell_point, cosine_ray};
use super::system::{Patch, PatchSide, Stray};
use crate::color::Rgb;
use crate::integrator::carrier::{Carrier, frame_of, lobes_of, survivor};
use crate::integrator::mis::power_heuristic;
use crate::integrator::path::Strategies;
use crate::integrator::sources::{Reach, Shading, Sources, receiver};
use crate::integrator::{CancelToken, RayCounts};
use crate::light::Receiver;
use crate::material::{Scattering, ScatteringFrame, Side, Transport};
use crate::math::{Ray, rng};
use crate::sampler::{Sampler, SamplerKind, Use};
use glam::DVec2;
use rayon::prelude::*;
use std::f64::consts::PI;

/// What the random numbers are for.
const DIRECT: u64 = 0x6469_7265;
const STRAY: u64 = 0x7374_7261;

/// Points of a cell at which light sources are asked: of few patches each at more, so that all together are asked this often.
const LIGHT_POINTS: std::ops::RangeInclusive<usize> = 16..=1024;
const LIGHT_POINTS_OF_ALL: usize = 1 << 14;

/// How many times as much as the mean of other patches a patch counts at most.
const LARGEST_WEIGHT: f64 = 4.0;

/// Points along each side of a cell at which pictures on it are looked at.
const PICTURE_POINTS: u32 = 8;

/// Pads of glossy parts: their questions to lights must not be those of the matt part.
const GLOSSY: u32 = 1 << 20;

/// Asks light sources for patches.
pub(super) struct Lighting<'a, 's> {
    pub(super) mesh: &'a Mesh,
    pub(super) carrier: &'a Carrier<'s>,
    pub(super) sources: &'a Sources<'s>,
    pub(super) seed: u64,
    /// Whether surfaces send light to each other at all.
    pub(super) bounces: bool,
    /// By face, whether its back is the inside of a body that no light is in.
    pub(super) dark: &'a [bool],
    /// Rays by which light is looked for that sources are not asked for; 0 where there is none.
    pub(super) n_stray: u32,
    /// Once it is set, nothing more is asked.
    pub(super) cancel: &'a CancelToken,
}

impl Lighting<'_, '_> {
    /// All patches, with what light sources give them.
    pub(super) fn patches(&self) -> Vec<Patch> {
        let most = self.largest_weight();
        let patch = |node: &u32| {
            let at = &self.mesh.nodes[*node as usize];
            let optics = self.optics(at);
            let sides = [0, 1].map(|side| {
                if !self.bounces {
                    return PatchSide::default();
                }
                let mut own = PatchSide {
                    reflectance: optics[side].reflectance,
                    transmittance: optics[side].transmittance,
                    is_dark: side == 1 && self.dark[at.cell.chart as usize],
                    ..PatchSide::default()
                };
                if own.is_needed() && !self.cancel.is_cancelled() {
                    own.stray = self.stray(*node, side);
                    own.source = self.direct(*node, side) + own.stray.all;
                }
                own
            });
            Patch {
                area: at.area,
                weight: at.area.min(most),
                sides,
            }
        };
        self.mesh.patches.par_iter().map(patch).collect()
    }

    /// The area with which a cell of a plane counts at most: some times the mean of the patches of all else.
    fn largest_weight(&self) -> f64 {
        let nodes = self.mesh.patches.iter();
        let nodes = nodes.map(|node| &self.mesh.nodes[*node as usize]);
        let is_plane = |node: &&Node| self.mesh.charts[node.cell.chart as usize].is_plane();
        let (n, sum) = nodes
            .filter(|node| !is_plane(node))
            .fold((0.0, 0.0), |(n, sum), node| (n + 1.0, sum + node.area));
        if n > 0.0 {
            LARGEST_WEIGHT * sum / n
        } else {
            f64::INFINITY
        }
    }

    /// What the matt part of a cell does, mean over the cell.
    fn optics(&self, node: &Node) -> [Side; 2] {
        let scene = self.carrier.scene;
        let material = scene.material(self.mesh.charts[node.cell.chart as usize].material);
        if material.pictures.is_none() {
            return material.sides;
        }
        let n = f64::from(PICTURE_POINTS);
        let mut sum = [Side::default(); 2];
        for k in 0..PICTURE_POINTS * PICTURE_POINTS {
            let step = DVec2::new(f64::from(k % PICTURE_POINTS), f64::from(k / PICTURE_POINTS));
            let u = (step + DVec2::splat(0.5)) / n;
            let at = cell_point(self.mesh, self.carrier, &node.cell, 0, u);
            let sides = scene.optics(&at.point).scattering.sides;
            for (sum, side) in sum.iter_mut().zip(sides) {
                sum.reflectance += side.reflectance / (n * n);
                sum.transmittance += side.transmittance / (n * n);
            }
        }
        sum
    }

    /// Irradiance straight from light sources, mean over a side of a cell, W/m².
    pub(super) fn direct(&self, node: u32, side: usize) -> Rgb {
        let white = Side {
            reflectance: Rgb::WHITE,
            transmittance: Rgb::BLACK,
        };
        let stream = rng::hash(&[self.seed, DIRECT, u64::from(node), side as u64]);
        let cell = &self.mesh.nodes[node as usize].cell;
        let (mut sum, mut weights) = (Rgb::BLACK, 0.0);
        let mut rays = RayCounts::default();
        let n_points = (LIGHT_POINTS_OF_ALL / self.mesh.patches.len().max(1))
            .clamp(*LIGHT_POINTS.start(), *LIGHT_POINTS.end());
        for index in 0..n_points as u32 {
            let mut sampler = Sampler::new(SamplerKind::OwenSobol, stream, index);
            let at = sampler.point(Use::Direction);
            let at = cell_point(self.mesh, self.carrier, cell, side, at);
            sampler.start_vertex(1);
            let wo = if side == 0 {
                at.point.normal_g
            } else {
                -at.point.normal_g
            };
            let media = self.carrier.bodies.around(at.point.spawn_ray(wo).origin);
            let shading = Shading {
                point: &at.point,
                frame: &ScatteringFrame {
                    normal_g: at.point.normal_g,
                    normal_s: at.point.normal_g,
                },
                scattering: &Scattering {
                    sides: [white; 2],
                    lobes: &[],
                },
                wo,
                absorption: [media.absorption(); 2],
                advice: None,
            };
            let ways = Strategies::LightsOnly;
            let radiance = self
                .sources
                .direct(&shading, Reach::First, ways, &sampler, &mut rays);
            sum += radiance * (PI * at.weight);
            weights += at.weight;
        }
        sum / weights
    }

    /// Irradiance of a side of a cell from sources on ways on which they are not asked, W/m².
    pub(super) fn stray(&self, node: u32, side: usize) -> Stray {
        let stream = rng::hash(&[self.seed, STRAY, u64::from(node), side as u64]);
        let cell = &self.mesh.nodes[node as usize].cell;
        let (mut sum, mut weights) = (Stray::default(), 0.0);
        let mut rays = RayCounts::default();
        for index in 0..self.n_stray {
            let mut sampler = Sampler::new(SamplerKind::OwenSobol, stream, index);
            let at = sampler.point(Use::Choice);
            let at = cell_point(self.mesh, self.carrier, cell, side, at);
            let ray = cosine_ray(&at.point, side, sampler.point(Use::Direction));
            let found = self.stray_radiance(&ray, &mut sampler, &mut rays);
            sum.all += found.all * (PI * at.weight);
            sum.focused += found.focused * (PI * at.weight);
            weights += at.weight;
        }
        if weights > 0.0 {
            sum.all = sum.all / weights;
            sum.focused = sum.focused / weights;
        }
        sum
    }

    /// Radiance along a ray from sources that nobody asks for it; without the disk of the sun, which hardly any ray would meet.
    fn stray_radiance(&self, ray: &Ray, sampler: &mut Sampler, rays: &mut RayCounts) -> Stray {
        let carrier = self.carrier;
        let mut media = carrier.bodies.around(ray.origin);
        let mut ray = *ray;
        let (mut radiance, mut throughput, mut compression) = (Stray::default(), Rgb::WHITE, 1.0);
        let mut last = Last::Straight(Receiver {
            position: ray.origin,
            normal: None,
            is_two_sided: true,
        });
        for depth in 0..=carrier.max_depth {
            sampler.start_vertex(depth + 1);
            let way = carrier.follow(&ray, &media, sampler, rays);
            throughput *= way.weight;
            let Some(met) = way.end else {
                let pdf = || {
                    self.sources
                        .sky_pdf_solid_angle(ray.direction, Reach::First)
                };
                let sky = self.sources.sky_radiance(ray.direction);
                let found = throughput * sky * last.share(&|_| pdf());
                // Land below the horizon is asked for by nobody, so every ray counts it.
                let is_focused = last.is_focused() && pdf() > 0.0;
                radiance.add(found, is_focused);
                return radiance;
            };
            let emission = met.optics.emission[usize::from(!met.point.is_front)];
            if !emission.is_black() {
                let ask = |from: &Receiver| {
                    let sources = self.sources;
                    sources.emitter_pdf_solid_angle(&met.point, from, Reach::First)
                };
                radiance.add(throughput * emission * last.share(&ask), last.is_focused());
            }
            if met.optics.scattering.is_matt() {
                return radiance;
            }
            let (wo, frame) = (-ray.direction, frame_of(&met.point));
            let lobes = lobes_of(&met.optics);
            sampler.start_vertex(GLOSSY + depth);
            if lobes.is_smooth() {
                let beyond = carrier.bodies.beyond(&media, &met.point, &frame, wo);
                let shading = Shading {
                    point: &met.point,
                    frame: &frame,
                    scattering: &lobes,
                    wo,
                    absorption: [media.absorption(), beyond],
                    advice: None,
                };
                let ways = Strategies::Both;
                let sources = self.sources;
                let direct = sources.direct(&shading, Reach::First, ways, sampler, rays);
                radiance.add(throughput * direct, false);
            }
            let transport = Transport::Radiance;
            let onward = carrier.scatter(&met, wo, &mut media, transport, sampler);
            let Some(onward) = onward else { break };
            compression *= onward.compression;
            let left = survivor(throughput * onward.weight, compression, depth, sampler);
            let Some(left) = left else { break };
            throughput = left;
            last = match onward.pdf_solid_angle {
                None => Last::Mirrored,
                Some(pdf) => Last::Glossy(receiver(&met.point, &frame, &lobes, wo), pdf),
            };
            ray = onward.ray;
        }
        radiance
    }
}

/// How a ray came to where it shines.
enum Last {
    /// Straight from a matt surface, which asked for all light that can be asked for.
    Straight(Receiver),
    /// From where nobody asks.
    Mirrored,
    /// From where light is asked for as well; with the density per steradian of the ray.
    Glossy(Receiver, f64),
}

impl Last {
    /// Whether what shines at the end of the ray is thrown there by mirrors and glass.
    fn is_focused(&self) -> bool {
        matches!(self, Self::Mirrored)
    }

    /// The part of light at the end of the ray that counts, given the density with which it is asked for.
    fn share(&self, asked: &dyn Fn(&Receiver) -> f64) -> f64 {
        match self {
            Self::Straight(from) if asked(from) > 0.0 => 0.0,
            Self::Straight(_) | Self::Mirrored => 1.0,
            Self::Glossy(from, pdf) => power_heuristic(*pdf, asked(from)),
        }
    }
}
