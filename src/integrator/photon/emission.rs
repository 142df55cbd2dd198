//! From sources to photons: which source, from where, in which direction, and with how much power.
//!
//! A photon's power is what its source sends along a ray, divided by the density with which that ray was chosen and by the number
//! of photons, so that all together carry the power of the sources, whatever the choices.

use super::ground::{Ground, surround};
use super::plot::Plot;
use super::source::{Source, Start};
use super::target::Targets;
use crate::color::Rgb;
use crate::integrator::requirements::{Feature, Features, Requirements};
use crate::light::Dome;
use crate::light::SunDisk;
use crate::material::Material;
use crate::math::{Bounds3, Ray, rng};
use crate::sampler::{Sampler, SamplerKind, Use};
use crate::scene::{EmitterId, Scene};
use std::collections::BTreeMap;

/// What photons are for.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Aim {
    /// All surfaces.
    Everything,
    /// Surfaces that mirror or refract into single directions: caustics.
    Specular,
}

/// Share of the photons that sources get by the power that is aimed at something.
const BY_POWER: f64 = 0.8;
/// Share that is split evenly over the kinds of sources, within them by power: the sky beside the sun.
const BY_KIND: f64 = 0.1;
// The rest is split evenly over kinds, and within them evenly over lamps and by area over shining surfaces: so a lamp in a dark
// corner has photons even if another is 10¹² times as strong.

/// Photons that are tried to learn how much of a source's power is aimed at something, of all sources together and of one.
const PILOTS: usize = 1 << 16;
const PILOTS_OF_ONE: usize = 1 << 10;

/// Boxes asked of the scene.
const BOXES: usize = 4096;

/// Separates the random numbers of photons from all others.
const STREAM: u64 = 0x50_4847_544f_4e53;

/// The sources of a scene, ready to send photons.
#[derive(Debug)]
pub struct Emission<'s> {
    pub(super) scene: &'s Scene,
    pub(super) dome: Dome,
    pub(super) sun: Option<SunDisk>,
    pub(super) targets: Targets,
    /// Of all that photons shall pass.
    pub(super) bounds: Bounds3,
    /// Where the world repeats itself.
    pub(super) plot: Option<Plot>,
    pub(super) aim: Aim,
    pub(super) has_planes: bool,
    /// Whether photons remember the clear bodies that they are in.
    pub(super) has_bodies: bool,
    /// The endless plane that throws light back at what stands on it.
    pub(super) ground: Option<Ground>,
    sources: Vec<Source>,
    /// Probability of each source, and the sums up to and with it.
    probabilities: Vec<f64>,
    cumulated: Vec<f64>,
    power: Rgb,
}

/// A photon that leaves a source.
#[derive(Clone, Debug)]
pub struct Photon {
    /// Where it goes.
    pub ray: Ray,
    /// What it carries, W per channel.
    pub power: Rgb,
    /// How many times stronger it is than photons that are sent to the scene itself; at least 1. More than 1 if it lands on an
    /// endless plane far from it.
    pub strength: f64,
    /// Whether the surface it meets gets this light also from [`Sources`](crate::integrator::sources::Sources), as direct light.
    pub is_direct: bool,
    /// Random numbers of the rest of its way.
    pub sampler: Sampler,
}

impl<'s> Emission<'s> {
    /// Gathers the sources of `scene`. Shining infinite planes send no photons.
    #[must_use]
    pub fn new(scene: &'s Scene, aim: Aim) -> Self {
        Self::reaching(scene, aim, Bounds3::EMPTY)
    }

    /// As [`Emission::new`], and the photons also pass all of a box besides, in which something measures them.
    #[must_use]
    pub fn reaching(scene: &'s Scene, aim: Aim, besides: Bounds3) -> Self {
        Self::required(
            &Requirements::of(scene, Features::NONE),
            scene,
            aim,
            besides,
        )
    }

    /// As [`Emission::reaching`], for a scene that requires this. Where [unaimed photons](Feature::UnaimedPhotons) are kept, photons are
    /// also sent where they can meet nothing that they are for: from lamps into all directions, from far away past all of the scene.
    #[must_use]
    pub fn required(
        requirements: &Requirements,
        scene: &'s Scene,
        aim: Aim,
        besides: Bounds3,
    ) -> Self {
        let bounds = scene.bounds().union(&besides);
        let ground = (aim == Aim::Everything)
            .then(|| Ground::of(scene, &bounds))
            .flatten();
        let mut targets = targets(scene, aim, bounds, ground.as_ref());
        let strays = requirements.keeps(Feature::UnaimedPhotons);
        if strays && !targets.is_boundless() && !bounds.is_empty() {
            targets = Targets::new(&[bounds], true);
        }
        Self {
            ground,
            has_bodies: requirements.has(Feature::Bodies),
            ..Self::aimed(scene, aim, targets, bounds)
        }
    }

    /// The light of a plot that repeats itself: from far away, what passes the plot once; from lamps in it, everything.
    #[must_use]
    pub fn into_plot(scene: &'s Scene, plot: Plot) -> Self {
        let bounds = plot.bounds();
        let targets = Targets::new(&[plot.top()], true);
        Self {
            plot: Some(plot),
            ..Self::aimed(scene, Aim::Everything, targets, bounds)
        }
    }

    fn aimed(scene: &'s Scene, aim: Aim, targets: Targets, bounds: Bounds3) -> Self {
        let environment = scene.environment();
        let sun = environment.sun.clone();
        let sun = sun.filter(|sun| !sun.irradiance.is_black());
        let mut emission = Self {
            scene,
            dome: Dome::new(environment),
            sun,
            targets,
            bounds,
            plot: None,
            aim,
            has_planes: scene.stats().planes > 0,
            has_bodies: true,
            ground: None,
            sources: Vec::new(),
            probabilities: Vec::new(),
            cumulated: Vec::new(),
            power: Rgb::BLACK,
        };
        emission.sources = emission.find_sources();
        emission.weigh();
        emission
    }

    /// Power of all photons together, W per channel: what the sources send towards the target. An estimate where that is not
    /// known on paper.
    #[must_use]
    pub fn power(&self) -> Rgb {
        self.power
    }

    /// Whether no photon carries anything.
    #[must_use]
    pub fn is_dark(&self) -> bool {
        self.cumulated.is_empty()
    }

    /// Photon number `index` of `n`; a pure function of its arguments. `None` if it carries nothing.
    ///
    /// The photons of a source are spread together over its surface and directions. With other seeds come independent photons.
    /// If the scene's box changes, as that of a growing plant does, the photons of parallel light and sky move in proportion: the
    /// same photon of the same seed falls on nearly the same place, so steps have most of their noise in common, but not all.
    #[must_use]
    pub fn photon(&self, index: u64, n: u64, seed: u64) -> Option<Photon> {
        // Systematic sampling: source s gets the photons whose number falls into its part of 0..n, the bounds at random.
        let offset = rng::unit_f64(rng::hash(&[seed, STREAM]));
        let at = (index as f64 + offset) / n as f64;
        let chosen = self.cumulated.partition_point(|end| *end <= at);
        let chosen = chosen.min(self.cumulated.len().checked_sub(1)?);
        let begin = chosen
            .checked_sub(1)
            .map_or(0.0, |last| self.cumulated[last]);
        let first = (begin * n as f64 - offset).ceil().max(0.0) as u64;
        let nth = index.saturating_sub(first);
        let stream = rng::hash(&[seed, STREAM, chosen as u64, nth >> 32]);
        let sampler = Sampler::new(SamplerKind::OwenSobol, stream, nth as u32);
        let start = self.start(self.sources[chosen], &sampler)?;
        let share = n as f64 * self.probabilities[chosen];
        let power = start.power / share;
        (!power.is_black() && power.is_finite()).then_some(Photon {
            ray: start.ray,
            power,
            strength: start.strength,
            is_direct: start.is_direct,
            sampler,
        })
    }

    /// How many of `n` photons each source sends at the least, shining surfaces organ by organ.
    #[must_use]
    pub fn sent(&self, n: u64) -> Vec<u64> {
        let mut shares: BTreeMap<(usize, u32), f64> = BTreeMap::new();
        for (source, probability) in self.sources.iter().zip(&self.probabilities) {
            let one = match source {
                Source::Lamp(index) => *index as u32,
                Source::Sun | Source::Sky | Source::Land => 0,
                Source::Emitter(id, _) => self.scene.emitters()[id.0 as usize].organ.0,
            };
            // What sends nothing is no source.
            if *probability > 0.0 {
                *shares.entry((source.kind(), one)).or_default() += probability;
            }
        }
        shares
            .into_values()
            .map(|share| (share * n as f64) as u64)
            .collect()
    }

    fn start(&self, source: Source, sampler: &Sampler) -> Option<Start> {
        let place = sampler.point(Use::Light(0));
        let direction = sampler.point(Use::Direction);
        self.leave(source, place, direction)
    }

    fn find_sources(&self) -> Vec<Source> {
        let scene = self.scene;
        let mut sources: Vec<Source> = (0..scene.lights().len()).map(Source::Lamp).collect();
        sources.extend(self.sun.as_ref().map(|_| Source::Sun));
        if !self.dome.is_dark() {
            sources.push(Source::Sky);
            if !self.land_radiance().is_black() {
                sources.push(Source::Land);
            }
        }
        for (id, emitter) in (0..).zip(scene.emitters()) {
            let material = scene.material(emitter.material);
            let shining = [true, false].into_iter();
            let shining = shining.filter(|side| !material.emitted_radiance(*side).is_black());
            sources.extend(shining.map(|side| Source::Emitter(EmitterId(id), side)));
        }
        sources
    }

    /// Decides how often each source is chosen.
    fn weigh(&mut self) {
        let n_pilots = (PILOTS / self.sources.len().max(1)).clamp(4, PILOTS_OF_ONE);
        let (powers, wanted): (Vec<Rgb>, Vec<Rgb>) = (0..)
            .zip(&self.sources)
            .map(|(at, source)| {
                let known = self.known_power(*source).map(|power| (power, power));
                known.unwrap_or_else(|| self.pilot(*source, at, n_pilots))
            })
            .unzip();
        let shares = shares(&self.sources, &wanted, |source| self.size(source));
        let total: f64 = shares.iter().sum();
        if !(total > 0.0 && total.is_finite()) {
            self.sources.clear();
            return;
        }
        self.power = powers.into_iter().sum();
        self.probabilities = shares.iter().map(|share| share / total).collect();
        let mut sum = 0.0;
        let sums = self.probabilities.iter().map(|p| {
            sum += p;
            sum
        });
        self.cumulated = sums.collect();
    }

    /// The mean power of a few photons of a source, and what it would be if they were as strong as those that are sent to the
    /// scene itself.
    fn pilot(&self, source: Source, at: u64, n: usize) -> (Rgb, Rgb) {
        let sampler = |index| Sampler::new(SamplerKind::OwenSobol, rng::hash(&[STREAM, at]), index);
        let starts = (0..n as u32).filter_map(|index| self.start(source, &sampler(index)));
        let (mut power, mut wanted) = (Rgb::BLACK, Rgb::BLACK);
        for start in starts.filter(|start| start.power.is_finite()) {
            power += start.power / n as f64;
            wanted += start.power / (n as f64 * start.strength);
        }
        (power, wanted)
    }

    /// What sources of one kind share evenly: one for each, or the area of what has one, m².
    fn size(&self, source: Source) -> f64 {
        match source {
            Source::Emitter(id, _) => self.scene.emitters()[id.0 as usize].area(),
            Source::Lamp(_) | Source::Sun | Source::Sky | Source::Land => 1.0,
        }
    }
}

/// How often each source is chosen, not normalised.
fn shares(sources: &[Source], powers: &[Rgb], size: impl Fn(Source) -> f64) -> Vec<f64> {
    // Beyond any number of watts that makes sense sources are told apart no more, so that sums stay finite.
    let watts: Vec<f64> = powers.iter().map(|power| power.sum().min(1e150)).collect();
    let (mut of_kind, mut sizes) = ([0.0; Source::KINDS], [0.0; Source::KINDS]);
    for (source, watts) in sources.iter().zip(&watts) {
        if *watts > 0.0 {
            of_kind[source.kind()] += watts;
            sizes[source.kind()] += size(*source);
        }
    }
    let total: f64 = of_kind.iter().sum();
    let n_kinds = of_kind.iter().filter(|watts| **watts > 0.0).count() as f64;
    let share = |(source, watts): (&Source, &f64)| {
        if *watts <= 0.0 {
            return 0.0;
        }
        let kind = source.kind();
        let within = watts / of_kind[kind];
        let even = size(*source) / sizes[kind];
        BY_POWER * watts / total
            + BY_KIND * within / n_kinds
            + (1.0 - BY_POWER - BY_KIND) * even / n_kinds
    };
    sources.iter().zip(&watts).map(share).collect()
}

/// What light is aimed at.
fn targets(scene: &Scene, aim: Aim, bounds: Bounds3, ground: Option<&Ground>) -> Targets {
    let has_planes = scene.stats().planes > 0;
    if aim == Aim::Specular {
        let found = scene.extents_of(Material::is_specular, BOXES);
        if !found.has_planes {
            return Targets::new(&found.boxes, false);
        }
    }
    if bounds.is_empty() {
        return Targets::new(&[], has_planes);
    }
    let mut targets = Targets::new(&[bounds], has_planes);
    if has_planes && aim == Aim::Everything {
        surround(&mut targets, scene, &bounds, ground);
    }
    targets
}
