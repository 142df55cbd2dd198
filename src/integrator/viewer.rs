//! From the camera to a solution: rays go on through mirrors, glass and gloss to matt surfaces, whose light the solution knows.
//!
//! Where all that a surface does besides being matt is to mirror or refract, rays of the camera split into all directions as long as
//! they carry much of the picture: chance would show as grain. Others choose one.

use super::RayCounts;
use super::carrier::{Carrier, Met, frame_of, lobes_of, survivor};
use super::medium::Media;
use super::mis::power_heuristic;
use super::path::Strategies;
use super::sources::{Reach, Shading, Sources, receiver};
use super::split::directions;
use crate::color::Rgb;
use crate::light::Receiver;
use crate::material::{Lobe, Scattering, Side, Transport};
use crate::math::Ray;
use crate::sampler::Sampler;
use glam::DVec3;

/// Vertices of glossy parts: their questions to lights must not be those of the matt part.
const GLOSSY: u32 = 1 << 20;

/// Vertices from a ray to the one that splits off.
const SIBLING: u32 = 1 << 12;

/// Rays that carry less than this part of the picture choose one direction instead of splitting.
const LEAST_TO_SPLIT: f64 = 0.1;

/// A scene, its sources, and rays through it.
#[derive(Debug)]
pub(super) struct Viewer<'s> {
    pub(super) carrier: Carrier<'s>,
    pub(super) sources: Sources<'s>,
}

/// A scattering that asked lights itself, and that a ray comes from.
#[derive(Clone, Copy, Debug)]
pub(super) struct LastScattering {
    pub(super) from: Receiver,
    /// Density with which it is taken to have chosen the ray, 1/sr.
    pub(super) pdf_solid_angle: f64,
    pub(super) reach: Reach,
}

impl LastScattering {
    /// A point that has asked sources for all the light that can be asked for: only of others does what a ray meets count.
    pub(super) fn asked_at(position: DVec3) -> Self {
        Self {
            from: Receiver {
                position,
                normal: None,
                is_two_sided: true,
            },
            // Next to nothing: whatever can be asked for outweighs it.
            pdf_solid_angle: f64::MIN_POSITIVE,
            reach: Reach::First,
        }
    }
}

/// Which sources count that a ray meets behind mirrors and glass.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Behind {
    /// All: the camera sees them.
    All,
    /// All but the disk of the sun, which hardly any ray would meet.
    AllButSun,
    /// None: a map of caustics knows their light.
    Nothing,
}

/// What a ray is that light is asked along.
#[derive(Clone, Copy, Debug)]
pub(super) struct Asked {
    /// The first vertex whose random numbers it may use.
    pub(super) first_vertex: u32,
    /// Whether it is the camera's: it sees sources straight away, and splits at mirrors and glass.
    pub(super) is_camera: bool,
    /// What counts behind those.
    pub(super) behind: Behind,
    /// The scattering it comes from, if sources count where it meets them straight away.
    pub(super) last: Option<LastScattering>,
}

impl Asked {
    /// A ray of the camera.
    pub(super) const CAMERA: Self = Self {
        first_vertex: 0,
        is_camera: true,
        behind: Behind::All,
        last: None,
    };
}

/// A surface that a ray has met.
pub(super) struct Seen<'a> {
    pub(super) met: &'a Met<'a>,
    /// Where it is seen from, through `media`.
    pub(super) wo: DVec3,
    pub(super) media: &'a Media,
    /// Mirrors, glass and glossy surfaces on the way.
    pub(super) depth: u32,
    /// Length of the way, metres.
    pub(super) gone: f64,
    /// Whether the last of them was glossy.
    pub(super) is_by_gloss: bool,
}

/// Light that comes along a ray.
#[derive(Clone, Copy, Debug)]
pub(super) struct Arriving {
    pub(super) radiance: Rgb,
    /// How far away the first surface is, metres.
    pub(super) distance: f64,
}

/// A ray that is still to be followed.
struct Branch {
    ray: Ray,
    media: Media,
    /// What part of its light arrives.
    throughput: Rgb,
    compression: f64,
    last: Option<LastScattering>,
    sees_sources: bool,
    first_vertex: u32,
    depth: u32,
    gone: f64,
}

impl<'s> Viewer<'s> {
    /// Light that comes along a ray that starts amid `media`. What the matt part of each surface on the way sends is told by `matt`.
    pub(super) fn light_along(
        &self,
        (ray, media): (&Ray, Media),
        asked: Asked,
        sampler: &mut Sampler,
        rays: &mut RayCounts,
        mut matt: impl FnMut(&Seen<'_>, &Sampler, &mut RayCounts) -> Rgb,
    ) -> Arriving {
        let mut radiance = Rgb::BLACK;
        let mut nearest = f64::INFINITY;
        let mut open = Vec::new();
        let mut next = Some(Branch {
            ray: *ray,
            media,
            throughput: Rgb::WHITE,
            compression: 1.0,
            last: asked.last,
            sees_sources: asked.is_camera || asked.last.is_some(),
            first_vertex: asked.first_vertex,
            depth: 0,
            gone: 0.0,
        });
        while let Some(mut branch) = next {
            // Find the surface that the light comes from.
            sampler.start_vertex(branch.first_vertex.wrapping_add(branch.depth + 1));
            let way = self
                .carrier
                .follow(&branch.ray, &branch.media, sampler, rays);
            branch.throughput *= way.weight;
            branch.gone += way.distance;
            if branch.depth == 0 {
                nearest = way.distance;
            }
            let Some(met) = way.end else {
                radiance += branch.throughput * self.escaping_radiance(&branch, asked.behind);
                next = open.pop();
                continue;
            };

            // What it sends by itself and as a matt surface.
            if branch.sees_sources {
                radiance += branch.throughput * self.emitted_radiance(&met, branch.last.as_ref());
            }
            let seen = Seen {
                met: &met,
                wo: -branch.ray.direction,
                media: &branch.media,
                depth: branch.depth,
                gone: branch.gone,
                is_by_gloss: branch.last.is_some(),
            };
            radiance += branch.throughput * matt(&seen, sampler, rays);
            if met.optics.scattering.is_matt() || branch.depth >= self.carrier.max_depth {
                next = open.pop();
                continue;
            }

            // What it mirrors, refracts or scatters glossily.
            let glossy = branch.first_vertex.wrapping_add(GLOSSY + branch.depth);
            sampler.start_vertex(glossy);
            let worth = branch.throughput.max_channel() / branch.compression;
            let splits = asked.is_camera && worth >= LEAST_TO_SPLIT;
            next = if splits && met.optics.scattering.lobes.iter().all(Lobe::is_delta) {
                self.split(&branch, &met, sampler, &mut open);
                open.pop()
            } else {
                radiance += branch.throughput * self.glossy_direct(&seen, sampler, rays);
                let onward = self.scatter(branch, &met, asked.behind, sampler);
                onward.or_else(|| open.pop())
            };
        }
        Arriving {
            radiance,
            distance: nearest,
        }
    }

    /// Chooses where the light comes from that a surface mirrors, refracts or scatters glossily.
    fn scatter(
        &self,
        branch: Branch,
        met: &Met<'_>,
        behind: Behind,
        sampler: &Sampler,
    ) -> Option<Branch> {
        let wo = -branch.ray.direction;
        let mut media = branch.media;
        let onward = self
            .carrier
            .scatter(met, wo, &mut media, Transport::Radiance, sampler)?;
        let compression = branch.compression * onward.compression;
        let throughput = branch.throughput * onward.weight;
        let last = onward
            .pdf_solid_angle
            .map(|pdf_solid_angle| LastScattering {
                from: receiver(
                    &met.point,
                    &frame_of(&met.point),
                    &lobes_of(&met.optics),
                    wo,
                ),
                pdf_solid_angle,
                reach: Reach::First,
            });
        Some(Branch {
            ray: onward.ray,
            media,
            throughput: survivor(throughput, compression, branch.depth, sampler)?,
            compression,
            last,
            sees_sources: behind != Behind::Nothing || last.is_some(),
            depth: branch.depth + 1,
            ..branch
        })
    }

    /// Opens a branch for each direction in which a surface mirrors or refracts.
    fn split(&self, branch: &Branch, met: &Met<'_>, sampler: &Sampler, open: &mut Vec<Branch>) {
        let wo = -branch.ray.direction;
        let frame = frame_of(&met.point);
        let mut first_vertex = branch.first_vertex;
        for lobe in met.optics.scattering.lobes.chunks(1) {
            let alone = Scattering {
                sides: [Side::default(); 2],
                lobes: lobe,
            };
            let found = directions(&alone, &frame, wo, sampler);
            for (sample, share) in found.into_iter().flatten() {
                let throughput = branch.throughput * sample.weight * share;
                if throughput.is_black() {
                    continue;
                }
                let mut media = branch.media;
                let bodies = &self.carrier.bodies;
                bodies.cross(&mut media, &met.point, &frame, [wo, sample.wi]);
                open.push(Branch {
                    ray: met.point.spawn_ray(sample.wi),
                    media,
                    throughput,
                    compression: branch.compression * sample.compression,
                    last: None,
                    sees_sources: true,
                    first_vertex,
                    depth: branch.depth + 1,
                    gone: branch.gone,
                });
                first_vertex = first_vertex.wrapping_add(SIBLING << branch.depth.min(7));
            }
        }
    }

    /// Direct light that the glossy parts of a surface send back along the ray.
    fn glossy_direct(&self, seen: &Seen<'_>, sampler: &Sampler, rays: &mut RayCounts) -> Rgb {
        let lobes = lobes_of(&seen.met.optics);
        if !lobes.is_smooth() {
            return Rgb::BLACK;
        }
        let ways = (Reach::First, Strategies::Both);
        self.direct(seen, &lobes, ways, sampler, rays)
    }

    /// Direct light that some parts of a surface send back along the ray.
    pub(super) fn direct(
        &self,
        seen: &Seen<'_>,
        scattering: &Scattering<'_>,
        (reach, strategies): (Reach, Strategies),
        sampler: &Sampler,
        rays: &mut RayCounts,
    ) -> Rgb {
        let (point, frame) = (&seen.met.point, frame_of(&seen.met.point));
        let beyond = self
            .carrier
            .bodies
            .beyond(seen.media, point, &frame, seen.wo);
        let shading = Shading {
            point,
            frame: &frame,
            scattering,
            wo: seen.wo,
            absorption: [seen.media.absorption(), beyond],
            advice: None,
        };
        self.sources
            .direct(&shading, reach, strategies, sampler, rays)
    }

    /// Radiance of sky and sun along a ray that meets nothing.
    fn escaping_radiance(&self, branch: &Branch, behind: Behind) -> Rgb {
        let (sources, w) = (&self.sources, branch.ray.direction);
        if !branch.sees_sources {
            return self.unsampled_radiance(w);
        }
        let weighted = |radiance: Rgb, pdf: &dyn Fn(Reach) -> f64| match &branch.last {
            Some(last) if !radiance.is_black() => {
                radiance * power_heuristic(last.pdf_solid_angle, pdf(last.reach))
            }
            Some(_) | None => radiance,
        };
        let sky = weighted(sources.sky_radiance(w), &|reach| {
            sources.sky_pdf_solid_angle(w, reach)
        });
        if behind == Behind::AllButSun && branch.last.is_none() {
            return sky;
        }
        let sun = |reach| sources.sun_pdf_solid_angle(w, reach);
        sky + weighted(sources.sun_radiance(w), &sun)
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
    fn emitted_radiance(&self, met: &Met<'_>, last: Option<&LastScattering>) -> Rgb {
        let emission = met.optics.emission[usize::from(!met.point.is_front)];
        match last {
            Some(last) if !emission.is_black() => {
                let sources = &self.sources;
                let asked = sources.emitter_pdf_solid_angle(&met.point, &last.from, last.reach);
                emission * power_heuristic(last.pdf_solid_angle, asked)
            }
            Some(_) | None => emission,
        }
    }
}
