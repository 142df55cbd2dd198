//! Path tracing: the reference that every other method is measured against.
//!
//! Source: [Kajiya1986](crate::references#kajiya1986), with light sampling at every vertex combined with scattered rays
//! ([`mis`](super::mis)) and Russian roulette. Unbiased: no clamping, no depth limit unless one is asked for.
//!
//! A surface of alpha below 1 is met with probability alpha and otherwise not there at all, which is not a scattering event;
//! shadow rays multiply `1 - alpha` instead. Both have the same mean.

use super::mis::power_heuristic;
use super::sources::{Reach, Shading, Sources};
use super::{Integrator, RadianceEstimator, RayCounts, RenderContext, RenderError};
use crate::color::Rgb;
use crate::material::{Material, ScatteringFrame};
use crate::math::Ray;
use crate::sampler::{Sampler, Use};
use crate::scene::{Scene, SurfacePoint};
use glam::DVec3;

/// Settings of the path tracer.
#[derive(Clone, Debug, PartialEq)]
pub struct Path {
    /// Longest path, counted in scattering events between the camera and the light: 0 shows emission only, 1 direct light,
    /// `None` has no limit. In a closed room of albedo ρ and emission `L_e` depth k gives `L_e` (1 - ρ^(k+1)) / (1 - ρ).
    pub max_depth: Option<u32>,
    /// How light is found. Anything but [`Strategies::Both`] is for measuring.
    pub strategies: Strategies,
    /// Scattering events after which dim paths are ended by chance; `None` never ends them (then set `max_depth`).
    pub roulette_after: Option<u32>,
}

impl Default for Path {
    fn default() -> Self {
        Self {
            max_depth: None,
            strategies: Strategies::Both,
            roulette_after: Some(4),
        }
    }
}

/// How light is found. All have the same mean wherever light can be found at all.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Strategies {
    /// Sampling lights and following scattered rays, weighted by their densities.
    #[default]
    Both,
    /// Sampling lights; scattered rays count only for light that cannot be sampled.
    LightsOnly,
    /// Scattered rays; lights are sampled only if no ray can hit them.
    ScatteringOnly,
}

/// Highest chance to go on in Russian roulette: even where nothing is absorbed, every path ends.
const HIGHEST_SURVIVAL: f64 = 0.99;

impl Integrator for Path {
    fn prepare<'s>(
        &self,
        scene: &'s Scene,
        _context: &RenderContext<'_>,
    ) -> Result<Box<dyn RadianceEstimator + 's>, RenderError> {
        Ok(Box::new(PathEstimator {
            scene,
            sources: Sources::new(scene),
            settings: self.clone(),
        }))
    }
}

/// The path tracer made ready for one scene.
struct PathEstimator<'s> {
    scene: &'s Scene,
    sources: Sources<'s>,
    settings: Path,
}

/// The scattering that a ray comes from.
#[derive(Clone, Copy)]
struct LastScattering {
    position: DVec3,
    /// Density of the ray's direction per steradian.
    pdf_solid_angle: f64,
    /// Which lights were sampled there.
    reach: Reach,
}

impl RadianceEstimator for PathEstimator<'_> {
    fn incident_radiance(&self, ray: &Ray, sampler: &mut Sampler, rays: &mut RayCounts) -> Rgb {
        // L radiance so far, β throughput, p_b density of the last scattering ([Kajiya1986]; Veach's thesis, §9 and §10).
        let mut radiance = Rgb::BLACK;
        let mut throughput = Rgb::WHITE;
        let mut last: Option<LastScattering> = None;
        let mut ray = *ray;

        for n_scatterings in 0_u32.. {
            sampler.start_vertex(n_scatterings.saturating_add(1));

            // Find the next path vertex, or add the sky and stop.
            let Some(point) = self.next_surface(&ray, sampler, rays) else {
                radiance += throughput * self.escaping_radiance(ray.direction, last);
                break;
            };
            let material = self.scene.material(point.material);

            // Add what the surface emits, weighted against having sampled it as a light from the last vertex.
            radiance += throughput * self.emitted_radiance(&point, material, &ray, last);
            if self
                .settings
                .max_depth
                .is_some_and(|limit| n_scatterings >= limit)
            {
                break;
            }

            // Add the light that arrives from sampled sources.
            let wo = -ray.direction;
            let frame = ScatteringFrame {
                normal_g: point.normal_g,
                normal_s: point.normal_s,
            };
            let reach = if n_scatterings == 0 {
                Reach::First
            } else {
                Reach::Later
            };
            let choice = sampler.point(Use::Choice);
            let shading = Shading {
                point: &point,
                frame: &frame,
                scattering: &material.scattering,
                wo,
            };
            let direct =
                self.sources
                    .direct(&shading, reach, self.settings.strategies, sampler, rays);
            radiance += throughput * direct;

            // Scatter.
            let u = sampler.point(Use::Direction);
            let Some(scattered) = material.scattering.sample(&frame, wo, u) else {
                break;
            };
            throughput *= scattered.weight;
            if throughput.is_black() {
                break;
            }

            // Go on with a probability that falls with the throughput, so that long dim paths stay affordable and the
            // estimate stays unbiased.
            if self
                .settings
                .roulette_after
                .is_some_and(|after| n_scatterings >= after)
            {
                let survival = throughput.max_channel().min(HIGHEST_SURVIVAL);
                if choice.y >= survival {
                    break;
                }
                throughput *= 1.0 / survival;
            }
            last = Some(LastScattering {
                position: point.position,
                pdf_solid_angle: scattered.pdf_solid_angle,
                reach,
            });
            ray = point.spawn_ray(scattered.wi);
        }
        radiance
    }
}

impl PathEstimator<'_> {
    /// The next surface that the light on this ray meets.
    ///
    /// It looks on along the same ray after each surface that it passes through, not along a ray that starts there: that would
    /// start off the surface, and so also off one that coincides with it.
    fn next_surface(
        &self,
        ray: &Ray,
        sampler: &Sampler,
        rays: &mut RayCounts,
    ) -> Option<SurfacePoint> {
        rays.closest += 1;
        let mut hit = self.scene.closest(ray)?;
        for passage in 0_u16.. {
            let point = self.scene.surface(ray, &hit);
            let alpha = self.scene.material(point.material).alpha;
            // At the last number the surface counts as met: 65,535 layers of glass are opaque.
            if alpha >= 1.0 || sampler.point(Use::Passage(passage)).x < alpha || passage == u16::MAX
            {
                return Some(point);
            }
            rays.closest += 1;
            hit = self.scene.closest_after(ray, &hit)?;
        }
        None
    }

    /// Radiance of sky and sun along a ray that meets nothing.
    fn escaping_radiance(&self, direction: DVec3, last: Option<LastScattering>) -> Rgb {
        let weight = |pdf: &dyn Fn(Reach) -> f64| self.hit_weight(last, |last| pdf(last.reach));
        let dome = &self.sources;
        let sky = dome.sky_radiance(direction);
        let sun = dome.sun_radiance(direction);
        let mut radiance = Rgb::BLACK;
        if !sky.is_black() {
            radiance += sky * weight(&|reach| dome.sky_pdf_solid_angle(direction, reach));
        }
        if !sun.is_black() {
            radiance += sun * weight(&|reach| dome.sun_pdf_solid_angle(direction, reach));
        }
        radiance
    }

    /// Radiance that a surface sends back along `ray`.
    fn emitted_radiance(
        &self,
        point: &SurfacePoint,
        material: &Material,
        ray: &Ray,
        last: Option<LastScattering>,
    ) -> Rgb {
        let emission = material.emission[usize::from(!point.is_front)];
        if emission.is_black() {
            return Rgb::BLACK;
        }
        let weight = self.hit_weight(last, |last| {
            self.sources
                .emitter_pdf_solid_angle(point, last.position, ray.direction, last.reach)
        });
        emission * weight
    }

    /// Weight of light found by following a ray from `last`, when sampling lights there would have found it with the
    /// density `light_pdf`. 1 for camera rays.
    fn hit_weight(
        &self,
        last: Option<LastScattering>,
        light_pdf: impl Fn(LastScattering) -> f64,
    ) -> f64 {
        let Some(last) = last else { return 1.0 };
        match self.settings.strategies {
            Strategies::Both => power_heuristic(last.pdf_solid_angle, light_pdf(last)),
            Strategies::LightsOnly if light_pdf(last) > 0.0 => 0.0,
            Strategies::LightsOnly | Strategies::ScatteringOnly => 1.0,
        }
    }
}
