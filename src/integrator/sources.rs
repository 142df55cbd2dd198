//! All light sources of a scene as one: choosing among them, sampling them, and the density with which that is done.
//!
//! Up to [`FEW`] sources are all sampled at the first vertex of a path. Of more, and at later vertices, one is chosen by chance:
//! sky, sun, a parallel light, or all lamps and shining surfaces together; among these a tree chooses by what each can give to
//! the point ([`LampTree`](crate::light::LampTree)). Where there is only one, nothing is chosen.

use super::RayCounts;
use super::clear_shadow;
use super::guide::Advice;
use super::medium::left_after;
use super::mis::power_heuristic;
use super::path::Strategies;
use super::requirements::{Feature, Features, Requirements};
use super::selection::{Selection, Source, Tree, weights};
use crate::color::Rgb;
use crate::light::{Dome, Light, LightSample, Receiver, SunDisk};
use crate::material::{Scattering, ScatteringFrame, Transport};
use crate::math::Ray;
use crate::sampler::{Sampler, Use};
use crate::scene::{EmitterId, Scene, SurfacePoint};
use glam::{DVec2, DVec3};

/// Up to this many sources are all sampled at the first vertex of a path; of more, only sky and sun are, and one other.
const FEW: usize = 16;

/// How far along a path light is sampled; noise of the first vertex is seen directly, so more is spent there.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Reach {
    /// At the surface that the camera sees.
    First,
    /// At all others.
    Later,
}

/// How clear bodies, which bend light, stop it on its way from a lamp.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Shadows {
    /// Wholly: light that they bend arrives elsewhere and is found otherwise, if at all.
    #[default]
    Opaque,
    /// As if they did not bend it: less dark, and not exact.
    Clear,
}

/// A surface point that waits for light, and the direction it is seen from.
#[derive(Clone, Copy, Debug)]
pub struct Shading<'a> {
    /// The point.
    pub point: &'a SurfacePoint,
    /// Its normals.
    pub frame: &'a ScatteringFrame,
    /// What it does to light.
    pub scattering: &'a Scattering<'a>,
    /// What else decides where a path goes on.
    pub advice: Option<Advice<'a>>,
    /// Unit direction from the point to where it is seen from.
    pub wo: DVec3,
    /// What is absorbed per metre on the side of `wo` and on the other side, 1/m.
    pub absorption: [Rgb; 2],
}

impl Shading<'_> {
    /// f · |cos θ| for light from `wi`.
    fn value_cos(&self, wi: DVec3) -> Rgb {
        let scattering = self.scattering;
        scattering.value_cos(self.frame, self.wo, wi, Transport::Radiance)
    }

    /// The point as lamps are chosen for it.
    fn receiver(&self) -> Receiver {
        receiver(self.point, self.frame, self.scattering, self.wo)
    }

    /// Density with which a path that goes on finds `wi`.
    fn pdf_solid_angle(&self, wi: DVec3) -> f64 {
        let scattering = self.scattering;
        let own = scattering.pdf_solid_angle(self.frame, self.wo, wi, Transport::Radiance);
        match self.advice {
            Some(advice) => advice.combined_pdf(own, wi),
            None => own,
        }
    }

    /// What is absorbed on the side of `wi`, 1/m.
    fn absorption_toward(&self, wi: DVec3) -> Rgb {
        let is_near = self.frame.is_in_front(self.wo) == self.frame.is_in_front(wi);
        self.absorption[usize::from(!is_near)]
    }
}

/// A surface point, seen along `wo`, as lamps are chosen for it.
#[must_use]
pub fn receiver(
    point: &SurfacePoint,
    frame: &ScatteringFrame,
    scattering: &Scattering<'_>,
    wo: DVec3,
) -> Receiver {
    Receiver {
        position: point.position,
        normal: Some(frame.facing_normal(wo)),
        is_two_sided: scattering.transmits(),
    }
}

/// The sources of a scene, ready for sampling.
#[derive(Debug)]
pub struct Sources<'s> {
    scene: &'s Scene,
    dome: Dome,
    sun: Option<SunDisk>,
    sources: Vec<Source>,
    /// Where the emitters begin in `sources`; they are in the order of the scene.
    first_emitter: usize,
    tree: Tree,
    first: Selection,
    later: Selection,
    shadows: Shadows,
}

impl<'s> Sources<'s> {
    /// Gathers the sources of `scene`.
    #[must_use]
    pub fn new(scene: &'s Scene) -> Self {
        Self::required(scene, &Requirements::of(scene, Features::NONE))
    }

    /// Gathers the sources of a scene that requires this.
    #[must_use]
    pub fn required(scene: &'s Scene, requirements: &Requirements) -> Self {
        let environment = scene.environment();
        let dome = Dome::new(environment);
        let sun = environment
            .sun
            .clone()
            .filter(|sun| !sun.irradiance.is_black());
        let mut sources: Vec<Source> = (0..scene.lights().len()).map(Source::Lamp).collect();
        sources.extend(sun.as_ref().map(|_| Source::Sun));
        sources.extend((!dome.is_dark()).then_some(Source::Sky));
        let first_emitter = sources.len();
        let n_emitters = u32::try_from(scene.emitters().len()).unwrap_or(u32::MAX);
        sources.extend((0..n_emitters).map(|id| Source::Emitter(EmitterId(id))));

        let weights = weights(scene, &dome, sun.as_ref(), &sources);
        let is_always = |index: usize| {
            let is_everywhere = matches!(sources[index], Source::Sun | Source::Sky);
            weights[index] > 0.0 && (is_everywhere || sources.len() <= FEW)
        };
        let tree = Tree::new(scene, &sources);
        let first = Selection::new(&weights, &tree, is_always);
        // The only one is not chosen.
        let is_only = !requirements.has(Feature::LightChoice);
        let later = Selection::new(&weights, &tree, |index| is_only && weights[index] > 0.0);
        Self {
            scene,
            dome,
            sun,
            sources,
            first_emitter,
            tree,
            first,
            later,
            shadows: Shadows::default(),
        }
    }

    /// The same sources with other shadows of clear bodies.
    #[must_use]
    pub fn with_shadows(self, shadows: Shadows) -> Self {
        Self { shadows, ..self }
    }

    fn selection(&self, reach: Reach) -> &Selection {
        match reach {
            Reach::First => &self.first,
            Reach::Later => &self.later,
        }
    }

    /// Estimates the radiance that leaves along `wo` after a single scattering of the light of all sources.
    pub fn direct(
        &self,
        shading: &Shading<'_>,
        reach: Reach,
        strategies: Strategies,
        sampler: &Sampler,
        rays: &mut RayCounts,
    ) -> Rgb {
        let selection = self.selection(reach);
        let mut radiance = Rgb::BLACK;
        let always = selection.always.iter().map(|index| (*index, 1.0));
        let chosen = self.choose(selection, shading, sampler.point(Use::Choice));
        for (nth, (index, probability)) in (0_u16..).zip(always.chain(chosen)) {
            let u = sampler.point(Use::Light(nth));
            let Some((light, ray)) = self.sample(self.sources[index], shading.point, u) else {
                continue;
            };
            let weight = weight(shading, &light, probability, strategies);
            let scattered = shading.value_cos(light.wi);
            let unshaded = scattered * light.facing_irradiance * (weight / probability);
            if !unshaded.is_black() {
                let absorption = shading.absorption_toward(light.wi);
                rays.shadow += 1;
                radiance += unshaded
                    * match self.shadows {
                        Shadows::Opaque => {
                            left_after(absorption, light.distance) * self.scene.transmittance(&ray)
                        }
                        Shadows::Clear => {
                            clear_shadow::transmittance(self.scene, &ray, absorption, rays)
                        }
                    };
            }
        }
        radiance
    }

    /// Chooses one of the sources that are not always sampled, with its probability.
    ///
    /// The second number also decides whether the path goes on. That is another term of the same sum, so no mean changes.
    fn choose(
        &self,
        selection: &Selection,
        shading: &Shading<'_>,
        u: DVec2,
    ) -> Option<(usize, f64)> {
        let index = selection.others.sample(u.x)?;
        let probability = selection.others.probability(index);
        if index < self.sources.len() {
            return Some((index, probability));
        }
        let chosen = self.tree.lamps.sample(&shading.receiver(), u.y)?;
        Some((
            self.tree.sources[chosen.index],
            probability * chosen.probability,
        ))
    }

    /// Light of one source at a point, and the ray on which it may be blocked.
    fn sample(&self, source: Source, point: &SurfacePoint, u: DVec2) -> Option<(LightSample, Ray)> {
        let light = match source {
            Source::Lamp(index) => return self.sample_lamp(index, point),
            Source::Sun => self.sun.as_ref()?.sample(u),
            Source::Sky => self.dome.sample(u)?,
            Source::Emitter(id) => return self.sample_emitter(id, point, u),
        };
        Some((light, point.spawn_ray(light.wi).until(light.distance)))
    }

    fn sample_lamp(&self, index: usize, point: &SurfacePoint) -> Option<(LightSample, Ray)> {
        let lamp = &self.scene.lights()[index];
        let light = lamp.illuminate(point.position)?;
        let ray = match lamp {
            // The ray ends just before the lamp, which may sit on a surface.
            Light::Point { position, .. } | Light::Spot { position, .. } => {
                point.spawn_ray_to(*position)
            }
            Light::Directional { .. } => point.spawn_ray(light.wi).until(light.distance),
        };
        Some((light, ray))
    }

    fn sample_emitter(
        &self,
        id: EmitterId,
        point: &SurfacePoint,
        u: DVec2,
    ) -> Option<(LightSample, Ray)> {
        let emitter = &self.scene.emitters()[id.0 as usize];
        let target = emitter.sample_toward(point.position, u.to_array())?;
        let to_light = target.position - point.position;
        let distance = to_light.length();
        let wi = to_light.try_normalize()?;
        let cos = -wi.dot(target.normal);
        let radiance = self
            .scene
            .material(emitter.material)
            .emitted_radiance(cos > 0.0);
        let pdf = target.pdf_solid_angle;
        let light = LightSample {
            wi,
            distance,
            facing_irradiance: radiance / pdf,
            pdf_solid_angle: Some(pdf),
        };
        Some((light, point.spawn_ray_to(target.position)))
    }

    /// Whether the sky shines, besides the disk of the sun.
    #[must_use]
    pub fn has_sky(&self) -> bool {
        !self.dome.is_dark()
    }

    /// Radiance of the sky in a direction, without the disk of the sun.
    #[must_use]
    pub fn sky_radiance(&self, w: DVec3) -> Rgb {
        self.dome.radiance(w)
    }

    /// Radiance of the disk of the sun in a direction; black beside it.
    #[must_use]
    pub fn sun_radiance(&self, w: DVec3) -> Rgb {
        self.sun.as_ref().map_or(Rgb::BLACK, |sun| sun.radiance(w))
    }

    /// Density per steradian, choice of source included, with which sampling the sky finds `w`.
    #[must_use]
    pub fn sky_pdf_solid_angle(&self, w: DVec3, reach: Reach) -> f64 {
        self.probability_of(Source::Sky, reach) * self.dome.pdf_solid_angle(w)
    }

    /// Density per steradian, choice of source included, with which sampling the sun finds `w`.
    #[must_use]
    pub fn sun_pdf_solid_angle(&self, w: DVec3, reach: Reach) -> f64 {
        let pdf = self.sun.as_ref().map_or(0.0, |sun| sun.pdf_solid_angle(w));
        self.probability_of(Source::Sun, reach) * pdf
    }

    /// Density per steradian, choice of source included, with which sampling lights for `from` finds the point `at` of
    /// a shining surface that a ray from there has hit; 0 if that surface is not sampled.
    #[must_use]
    pub fn emitter_pdf_solid_angle(&self, at: &SurfacePoint, from: &Receiver, reach: Reach) -> f64 {
        let emitters = self.scene.emitters();
        let found = emitters.binary_search_by_key(&at.primitive, |emitter| emitter.primitive);
        let Ok(index) = found else { return 0.0 };
        let pdf = emitters[index].pdf_toward(from.position, at.position, at.normal_g);
        let source = self.first_emitter + index;
        self.selection(reach).probability(&self.tree, source, from) * pdf
    }

    /// Probability that sky or sun is sampled.
    fn probability_of(&self, source: Source, reach: Reach) -> f64 {
        let infinite = &self.sources[..self.first_emitter];
        let index = infinite.iter().rposition(|candidate| *candidate == source);
        index.map_or(0.0, |index| self.selection(reach).alone(index))
    }
}

/// Weight of a light sample against having found the same light by scattering.
fn weight(
    shading: &Shading<'_>,
    light: &LightSample,
    probability: f64,
    strategies: Strategies,
) -> f64 {
    let Some(pdf) = light.pdf_solid_angle else {
        return 1.0;
    };
    match strategies {
        Strategies::LightsOnly => 1.0,
        Strategies::ScatteringOnly => 0.0,
        Strategies::Both => power_heuristic(probability * pdf, shading.pdf_solid_angle(light.wi)),
    }
}
