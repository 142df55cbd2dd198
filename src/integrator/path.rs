//! Path tracing: the reference that every other method is measured against.
//!
//! Source: [Kajiya1986](crate::references#kajiya1986), with light sampling at every vertex combined with scattered rays
//! ([`mis`](super::mis)) and Russian roulette. Unbiased: no clamping, no depth limit unless one is asked for.
//!
//! What lets light straight through (alpha, panes) is met by chance and otherwise not there at all, which is not a scattering
//! event; shadow rays multiply the fraction that passes instead. Both have the same mean.
//!
//! Where mirrors or glass make caustics, a [guide] learns from which directions light comes, and matt surfaces
//! scatter there more often.
//!
//! Mirrors and smooth glass send light into single directions, which light sampling cannot meet: light found behind them counts
//! in full. So light of a lamp without extent, or of the small disk of the sun, that comes through curved glass is not found.

use super::guide::{self, Advice, Guide};
use super::medium::{Bodies, left_after};
use super::mis::power_heuristic;
use super::requirements::{Feature, Features, Requirements, has_focused_light};
use super::sources::{Reach, Shading, Sources, receiver};
use super::{Integrator, RadianceEstimator, RayCounts, RenderContext, RenderError};
use crate::color::Rgb;
use crate::light::Receiver;
use crate::material::{Density, Optics, ScatterNumbers, ScatteringFrame, Transport};
use crate::math::Ray;
use crate::sampler::{Sampler, Use};
use crate::scene::{Scene, SurfacePoint};
use glam::{DVec2, DVec3};

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
    /// Whether paths may be guided to where light is. The mean is the same, the noise is not.
    pub guided: bool,
    /// What is done even if the scene does not require it.
    pub kept: Features,
}

impl Default for Path {
    fn default() -> Self {
        Self {
            max_depth: None,
            strategies: Strategies::Both,
            roulette_after: Some(4),
            guided: true,
            kept: Features::NONE,
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

/// Highest chance to go on in Russian roulette after so many scattering events, `1 - 3/(n + 3000)`: even where nothing is
/// absorbed every path ends, after 1500 events on average.
///
/// A bound that stays below 1 would give paths in a room of albedo ρ, for ρ² above it, weights whose mean square grows with
/// each event: no finite variance. Under this one the chance to be alive falls as `(3000/n)³`, so the mean square grows as n³
/// at most, which `ρ^(2n)` outweighs for every ρ < 1; and up to ρ = 0.999 it never binds.
pub(super) fn highest_survival(n_scatterings: u32) -> f64 {
    1.0 - 3.0 / (f64::from(n_scatterings) + 3000.0)
}

impl Integrator for Path {
    fn prepare<'s>(
        &self,
        scene: &'s Scene,
        context: &RenderContext<'_>,
    ) -> Result<Box<dyn RadianceEstimator + 's>, RenderError> {
        let requirements = Requirements::of(scene, self.kept);
        let may_guide = self.guided && self.strategies == Strategies::Both;
        let guide = if may_guide && requirements.has(Feature::Guide) {
            Some(Guide::new(scene, context)?)
        } else {
            None
        };
        let max_depth = if requirements.has(Feature::Bounces) {
            self.max_depth
        } else {
            Some(0)
        };
        Ok(Box::new(PathEstimator {
            scene,
            sources: Sources::required(scene, &requirements),
            bodies: Bodies::required(scene, &requirements),
            guide,
            may_meet_light: requirements.has(Feature::LightHits),
            settings: Self {
                max_depth,
                ..self.clone()
            },
        }))
    }

    fn shortcomings(&self, scene: &Scene) -> Vec<&'static str> {
        let focused = "light that smooth curved glass throws onto other surfaces is missing: `path` does not find \
                       light of a point, spot or parallel light or of the sun behind glass that bends it";
        let lacks = has_focused_light(scene);
        lacks.then_some(focused).into_iter().collect()
    }
}

/// The path tracer made ready for one scene.
struct PathEstimator<'s> {
    scene: &'s Scene,
    sources: Sources<'s>,
    bodies: Bodies<'s>,
    guide: Option<Guide>,
    /// Whether rays can meet anything that shines.
    may_meet_light: bool,
    settings: Path,
}

/// The scattering that a ray comes from.
#[derive(Clone, Copy)]
struct LastScattering {
    /// The point as lamps are chosen for it.
    from: Receiver,
    /// With which density the ray's direction was chosen.
    density: Density,
    /// Which lights were sampled there.
    reach: Reach,
}

/// What a ray leads to.
struct Way<'s> {
    /// The surface that its light comes from, unless it meets none.
    end: Option<(SurfacePoint, Optics<'s>)>,
    /// How far away that is, metres.
    distance: f64,
    /// What the chances taken on the way have to be made up for with.
    weight: Rgb,
}

impl RadianceEstimator for PathEstimator<'_> {
    fn incident_radiance(&self, ray: &Ray, sampler: &mut Sampler, rays: &mut RayCounts) -> Rgb {
        // L radiance so far, β throughput, p_b density of the last scattering ([Kajiya1986]; Veach's thesis, §9 and §10).
        let mut radiance = Rgb::BLACK;
        let mut throughput = Rgb::WHITE;
        let mut worth = Rgb::WHITE;
        let mut last: Option<LastScattering> = None;
        let mut media = self.bodies.around(ray.origin);
        let mut reach = Reach::First;
        let mut ray = *ray;

        for n_scatterings in 0_u32.. {
            sampler.start_vertex(n_scatterings.saturating_add(1));

            // Find the next path vertex, or add the sky and stop.
            let way = self.follow(&ray, sampler, rays);
            throughput *= way.weight * left_after(media.absorption(), way.distance);
            let Some((point, optics)) = way.end else {
                if self.may_meet_light {
                    radiance += throughput * self.escaping_radiance(ray.direction, last);
                }
                break;
            };

            // Add what the surface emits, weighted against having sampled it as a light from the last vertex.
            if self.may_meet_light {
                radiance += throughput * self.emitted_radiance(&point, &optics, last);
            }
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
            let choice = sampler.point(Use::Choice);
            let advice = self.advice(&point, &optics, n_scatterings);
            if optics.scattering.is_smooth() {
                let shading = Shading {
                    point: &point,
                    frame: &frame,
                    scattering: &optics.scattering,
                    advice,
                    wo,
                    absorption: [
                        media.absorption(),
                        self.bodies.beyond(&media, &point, &frame, wo),
                    ],
                };
                let strategies = self.settings.strategies;
                radiance += throughput
                    * self
                        .sources
                        .direct(&shading, reach, strategies, sampler, rays);
            }

            // Scatter.
            let scattered = scatter(&frame, &optics, advice, wo, sampler);
            let Some(scattered) = scattered else { break };
            throughput *= scattered.weight;
            if throughput.is_black() {
                break;
            }
            self.bodies
                .cross(&mut media, &point, &frame, [wo, scattered.wi]);

            // Go on with a probability that falls with the throughput, so that long dim paths stay affordable and the
            // estimate stays unbiased. That light is compressed inside glass makes no path more worthy, and that a path was
            // guided, where there is more light than its throughput tells, makes none less worthy.
            worth *= scattered.worth;
            if self
                .settings
                .roulette_after
                .is_some_and(|after| n_scatterings >= after)
            {
                let survival = worth.max_channel().min(highest_survival(n_scatterings));
                if choice.y >= survival {
                    break;
                }
                throughput *= 1.0 / survival;
                worth *= 1.0 / survival;
            }
            if self.may_meet_light {
                last = Some(LastScattering {
                    from: receiver(&point, &frame, &optics.scattering, wo),
                    density: scattered.density,
                    reach,
                });
            }
            // What a mirror shows is seen as directly as the mirror.
            if scattered.density != Density::Delta {
                reach = Reach::Later;
            }
            ray = point.spawn_ray(scattered.wi);
        }
        radiance
    }
}

impl Way<'_> {
    /// Decides by chance whether the light passes a surface, met under the cosine `cos`, straight through, and keeps the mean.
    fn pass(&mut self, optics: &Optics<'_>, cos: f64, chance: f64) -> bool {
        if optics.scattering.is_matt() {
            // One fraction for all channels: nothing to make up for.
            return chance >= optics.alpha;
        }
        let passage = optics.passage(cos);
        let met = if optics.is_nothing_else() {
            0.0
        } else {
            1.0 - passage.mean()
        };
        let passes = chance >= met;
        self.weight *= if passes {
            passage / (1.0 - met)
        } else {
            Rgb::splat(optics.alpha / met)
        };
        passes
    }
}

/// How a path goes on.
struct Scattered {
    wi: DVec3,
    /// f · |cos θ| / pdf.
    weight: Rgb,
    density: Density,
    /// The same weight, had the surface alone chosen the direction, without the compression of light in glass.
    worth: Rgb,
}

/// Chooses the direction in which a path goes on, by advice if there is any and by what the surface does to light.
fn scatter(
    frame: &ScatteringFrame,
    optics: &Optics<'_>,
    advice: Option<Advice<'_>>,
    wo: DVec3,
    sampler: &Sampler,
) -> Option<Scattered> {
    let scattering = &optics.scattering;
    let needs_lobe = advice.is_some() || !scattering.is_matt();
    let numbers = ScatterNumbers {
        direction: sampler.point(Use::Direction),
        lobe: if needs_lobe {
            sampler.point(Use::Lobe)
        } else {
            DVec2::ZERO
        },
    };
    let Some(advice) = advice else {
        let sample = scattering.sample(frame, wo, numbers, Transport::Radiance)?;
        return Some(Scattered {
            wi: sample.wi,
            weight: sample.weight,
            density: sample.density,
            worth: sample.weight / sample.compression,
        });
    };

    // One of the two chooses; the density is that of both together.
    let wi = if numbers.lobe.x < advice.share {
        advice.sample(numbers.direction)
    } else {
        scattering
            .sample(frame, wo, numbers, Transport::Radiance)?
            .wi
    };
    let value = scattering.value_cos(frame, wo, wi, Transport::Radiance);
    let own = scattering.pdf_solid_angle(frame, wo, wi, Transport::Radiance);
    if value.is_black() {
        return None;
    }
    let pdf = advice.combined_pdf(own, wi);
    Some(Scattered {
        wi,
        weight: value / pdf,
        density: Density::SolidAngle(pdf),
        worth: value / own,
    })
}

impl PathEstimator<'_> {
    /// What the guide knows of the light that arrives where a path does.
    fn advice(
        &self,
        point: &SurfacePoint,
        optics: &Optics<'_>,
        n_scatterings: u32,
    ) -> Option<Advice<'_>> {
        let guide = self.guide.as_ref()?;
        guide::is_guided(optics)
            .then(|| guide.advice(point, n_scatterings))
            .flatten()
    }

    /// Follows a ray to the surface that its light comes from.
    ///
    /// It looks on along the same ray after each surface that it passes through, not along a ray that starts there: that would
    /// start off the surface, and so also off one that coincides with it.
    fn follow(&self, ray: &Ray, sampler: &Sampler, rays: &mut RayCounts) -> Way<'_> {
        let mut way = Way {
            end: None,
            distance: f64::INFINITY,
            weight: Rgb::WHITE,
        };
        rays.closest += 1;
        let mut next = self.scene.closest(ray);
        let mut passages = 0..u16::MAX;
        while let Some(hit) = next {
            let point = self.scene.surface(ray, &hit);
            let optics = self.scene.optics(&point);
            // At the last number the surface counts as met: 65,535 layers of glass are opaque.
            let passes = match passages.next() {
                Some(passage) if !optics.is_opaque() => {
                    let chance = sampler.point(Use::Passage(passage)).x;
                    let cos = point.normal_g.dot(ray.direction);
                    way.pass(&optics, cos, chance)
                }
                _ => false,
            };
            if !passes {
                way.end = Some((point, optics));
                way.distance = hit.t;
                break;
            }
            rays.closest += 1;
            next = self.scene.closest_after(ray, &hit);
        }
        way
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

    /// Radiance that a surface sends back along the ray that met it.
    fn emitted_radiance(
        &self,
        point: &SurfacePoint,
        optics: &Optics<'_>,
        last: Option<LastScattering>,
    ) -> Rgb {
        let emission = optics.emission[usize::from(!point.is_front)];
        if emission.is_black() {
            return Rgb::BLACK;
        }
        let weight = self.hit_weight(last, |last| {
            self.sources
                .emitter_pdf_solid_angle(point, &last.from, last.reach)
        });
        emission * weight
    }

    /// Weight of light found by following a ray from `last`, when sampling lights there would have found it with the
    /// density `light_pdf`. 1 for camera rays and behind mirrors.
    fn hit_weight(
        &self,
        last: Option<LastScattering>,
        light_pdf: impl Fn(LastScattering) -> f64,
    ) -> f64 {
        let Some(last) = last else { return 1.0 };
        let Density::SolidAngle(pdf) = last.density else {
            return 1.0;
        };
        match self.settings.strategies {
            Strategies::Both => power_heuristic(pdf, light_pdf(last)),
            Strategies::LightsOnly if light_pdf(last) > 0.0 => 0.0,
            Strategies::LightsOnly | Strategies::ScatteringOnly => 1.0,
        }
    }
}
