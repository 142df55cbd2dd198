//! The standard ray tracer: what lamps light directly, and what mirrors and glass show of it. Fast, and free of noise where
//! lamps are small; no light that a matt surface has thrown on.
//!
//! Source: [Whitted1980](crate::references#whitted1980), with an end by weight and not by depth alone
//! ([`HallGreenberg1983`](crate::references#hallgreenberg1983)) and reflections in rough surfaces followed along one chosen
//! direction ([Cook1984](crate::references#cook1984)).
//!
//! A ray that meets mirror or glass splits into all the directions that are sent light from there, each with its share; nothing
//! is left to chance except the point of a lamp with extent, and the direction in a rough mirror. What it leaves out: indirect
//! light, caustics. Its shadows of clear bodies are those of straight rays, which is exact for thin panes only.

use super::medium::{Bodies, Media, left_after};
use super::path::Strategies;
use super::requirements::{Feature, Features, Requirements};
use super::sources::{Reach, Shading, Shadows, Sources};
use super::split::directions;
use super::{Integrator, RadianceEstimator, RayCounts, RenderContext, RenderError};
use crate::color::Rgb;
use crate::light::Receiver;
use crate::material::{Optics, Scattering, ScatteringFrame, Side};
use crate::math::Ray;
use crate::sampler::Sampler;
use crate::scene::{Scene, SurfacePoint};
use glam::DVec3;

/// Settings of the ray tracer.
#[derive(Clone, Debug, PartialEq)]
pub struct Raytracer {
    /// How often a ray may be mirrored or refracted.
    pub max_depth: u32,
    /// A branch of rays ends where its share of the picture is less than this, 0..1. Loses at most that part of what it
    /// would have met, per branch.
    pub least_weight: f64,
    /// Points of each lamp with extent, and of the sky, that are asked for at each surface; at least 1.
    pub light_samples: u32,
    /// How clear bodies stop light on its way from a lamp.
    pub shadows: Shadows,
    /// What is done even if the scene does not require it.
    pub kept: Features,
}

impl Default for Raytracer {
    fn default() -> Self {
        Self {
            max_depth: 8,
            least_weight: 1.0 / 512.0,
            light_samples: 1,
            shadows: Shadows::Clear,
            kept: Features::NONE,
        }
    }
}

impl Integrator for Raytracer {
    fn prepare<'s>(
        &self,
        scene: &'s Scene,
        _context: &RenderContext<'_>,
    ) -> Result<Box<dyn RadianceEstimator + 's>, RenderError> {
        let requirements = Requirements::of(scene, self.kept);
        // Where there are no clear bodies both kinds of shadows are the same, and opaque ones need not be in order.
        let shadows = if requirements.has(Feature::ClearShadows) {
            self.shadows
        } else {
            Shadows::Opaque
        };
        Ok(Box::new(RaytracerEstimator {
            scene,
            sources: Sources::required(scene, &requirements).with_shadows(shadows),
            bodies: Bodies::required(scene, &requirements),
            settings: self.clone(),
        }))
    }
}

/// The ray tracer made ready for one scene.
struct RaytracerEstimator<'s> {
    scene: &'s Scene,
    sources: Sources<'s>,
    bodies: Bodies<'s>,
    settings: Raytracer,
}

/// A ray that is still to be followed.
struct Branch {
    ray: Ray,
    /// What part of its light the picture gets.
    weight: Rgb,
    /// Mirrors and refractions so far.
    depth: u32,
    media: Media,
    /// Whether light is seen where it comes from; not by rays from rough mirrors, where lamps were asked directly.
    sees_lights: bool,
}

impl RadianceEstimator for RaytracerEstimator<'_> {
    fn incident_radiance(&self, ray: &Ray, sampler: &mut Sampler, rays: &mut RayCounts) -> Rgb {
        let mut radiance = Rgb::BLACK;
        let mut draws = Draws {
            sampler,
            n_vertices: 0,
        };
        let mut open = vec![Branch {
            ray: *ray,
            weight: Rgb::WHITE,
            depth: 0,
            media: self.bodies.around(ray.origin),
            sees_lights: true,
        }];
        while let Some(branch) = open.pop() {
            radiance += self.follow(branch, &mut open, &mut draws, rays);
        }
        radiance
    }
}

impl RaytracerEstimator<'_> {
    /// The light along a ray that lamps give directly to the surfaces on it; where they send it on, branches are opened.
    fn follow(
        &self,
        branch: Branch,
        open: &mut Vec<Branch>,
        draws: &mut Draws<'_>,
        rays: &mut RayCounts,
    ) -> Rgb {
        let mut radiance = Rgb::BLACK;
        let mut weight = branch.weight;
        let absorption = branch.media.absorption();
        rays.closest += 1;
        let mut next = self.scene.closest(&branch.ray);
        while let Some(hit) = next {
            // The surface takes alpha of the light; the rest, and what panes pass, goes on to the next one.
            let point = self.scene.surface(&branch.ray, &hit);
            let optics = self.scene.optics(&point);
            let met = weight * left_after(absorption, hit.t) * optics.alpha;
            if met.max_channel() > 0.0 {
                let vertex = Vertex {
                    wo: -branch.ray.direction,
                    frame: ScatteringFrame {
                        normal_g: point.normal_g,
                        normal_s: point.normal_s,
                    },
                    point,
                    optics,
                };
                if self.shows_emission(&vertex, &branch) {
                    radiance += met * optics.emission[usize::from(!vertex.point.is_front)];
                }
                radiance += met * self.direct(&vertex, &branch.media, draws, rays);
                self.split(&vertex, met, &branch, open, draws);
            }
            if optics.is_opaque() {
                return radiance;
            }
            weight *= optics.passage(point.normal_g.dot(branch.ray.direction));
            if weight.max_channel() < self.settings.least_weight {
                return radiance;
            }
            rays.closest += 1;
            next = self.scene.closest_after(&branch.ray, &hit);
        }
        if branch.sees_lights {
            let w = branch.ray.direction;
            let dome = self.sources.sky_radiance(w) + self.sources.sun_radiance(w);
            radiance += weight * left_after(absorption, f64::INFINITY) * dome;
        }
        radiance
    }

    /// Whether light that a surface sends out by itself has not been counted where this ray comes from.
    fn shows_emission(&self, vertex: &Vertex<'_>, branch: &Branch) -> bool {
        let from = Receiver {
            position: branch.ray.origin,
            normal: None,
            is_two_sided: true,
        };
        branch.sees_lights
            || self
                .sources
                .emitter_pdf_solid_angle(&vertex.point, &from, Reach::First)
                <= 0.0
    }

    /// Light of all lamps that the smooth parts of a surface send back along the ray.
    fn direct(
        &self,
        vertex: &Vertex<'_>,
        media: &Media,
        draws: &mut Draws<'_>,
        rays: &mut RayCounts,
    ) -> Rgb {
        let scattering = &vertex.optics.scattering;
        if !scattering.is_smooth() {
            return Rgb::BLACK;
        }
        let (point, frame, wo) = (&vertex.point, &vertex.frame, vertex.wo);
        let shading = Shading {
            point,
            frame,
            scattering,
            advice: None,
            wo,
            absorption: [
                media.absorption(),
                self.bodies.beyond(media, point, frame, wo),
            ],
        };
        let n = self.settings.light_samples.max(1);
        let mut radiance = Rgb::BLACK;
        for _ in 0..n {
            let sampler = draws.next();
            let (reach, strategies) = (Reach::First, Strategies::LightsOnly);
            radiance += self
                .sources
                .direct(&shading, reach, strategies, sampler, rays);
        }
        radiance / f64::from(n)
    }

    /// Opens a branch for each direction in which a surface mirrors or refracts.
    fn split(
        &self,
        vertex: &Vertex<'_>,
        met: Rgb,
        branch: &Branch,
        open: &mut Vec<Branch>,
        draws: &mut Draws<'_>,
    ) {
        if vertex.optics.scattering.is_matt() || branch.depth >= self.settings.max_depth {
            return;
        }
        let lobes = vertex.optics.scattering.lobes;
        for lobe in lobes.chunks(1) {
            let sampler = draws.next();
            let alone = Scattering {
                sides: [Side::default(); 2],
                lobes: lobe,
            };
            let directions = directions(&alone, &vertex.frame, vertex.wo, sampler);
            for (sample, share) in directions.into_iter().flatten() {
                let weight = met * sample.weight * share;
                if weight.max_channel() < self.settings.least_weight {
                    continue;
                }
                let mut media = branch.media;
                let ends = [vertex.wo, sample.wi];
                self.bodies
                    .cross(&mut media, &vertex.point, &vertex.frame, ends);
                open.push(Branch {
                    ray: vertex.point.spawn_ray(sample.wi),
                    weight,
                    depth: branch.depth + 1,
                    media,
                    sees_lights: lobe[0].is_delta(),
                });
            }
        }
    }
}

/// Random numbers, other ones for each question that is asked along the tree of rays.
struct Draws<'a> {
    sampler: &'a mut Sampler,
    n_vertices: u32,
}

impl Draws<'_> {
    /// Those of the next question.
    fn next(&mut self) -> &Sampler {
        self.n_vertices += 1;
        self.sampler.start_vertex(self.n_vertices);
        self.sampler
    }
}

/// A surface that a ray has met.
struct Vertex<'s> {
    point: SurfacePoint,
    optics: Optics<'s>,
    frame: ScatteringFrame,
    wo: DVec3,
}
