//! Which light sources are asked: each with a probability that goes by what it can give.

use crate::color::Rgb;
use crate::light::alias::AliasTable;
use crate::light::{Dome, LampOutline, LampTree, Receiver, SunDisk};
use crate::scene::{EmitterId, Scene};
use std::f64::consts::PI;

/// One source.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Source {
    /// Index into the scene's lights.
    Lamp(usize),
    Sun,
    Sky,
    Emitter(EmitterId),
}

/// Share of the choices that goes by power over all sources; the rest is split evenly over the kinds of sources, so that
/// a lamp in a dark corner is not forgotten because the sun is stronger.
const SHARE_BY_POWER: f64 = 0.5;

/// Power in watts beyond which sources are told apart no more.
const BRIGHTEST: f64 = 1e150;

/// The sources that have a place, to be chosen among by what they can give to a point.
#[derive(Debug)]
pub(super) struct Tree {
    pub(super) lamps: LampTree,
    /// Of each lamp of the tree, the number of the source.
    pub(super) sources: Vec<usize>,
    /// Of each source, the number in the tree, if it is there.
    pub(super) places: Vec<Option<usize>>,
}

/// Which sources are sampled: some always, and one of the others by chance.
#[derive(Debug)]
pub(super) struct Selection {
    pub(super) always: Vec<usize>,
    pub(super) is_always: Vec<bool>,
    /// By the number of the source; one more for the tree.
    pub(super) others: AliasTable,
}

impl Tree {
    pub(super) fn new(scene: &Scene, sources: &[Source]) -> Self {
        let outline = |source: &Source| match *source {
            Source::Lamp(index) => LampOutline::of(&scene.lights()[index]),
            Source::Sun | Source::Sky => None,
            Source::Emitter(id) => {
                let emitter = &scene.emitters()[id.0 as usize];
                let material = scene.material(emitter.material);
                let [front, back] = [true, false].map(|side| material.emitted_radiance(side));
                Some(emitter.outline(front, back))
            }
        };
        let (mut outlines, mut members) = (Vec::new(), Vec::new());
        let mut places = vec![None; sources.len()];
        for (index, source) in sources.iter().enumerate() {
            if let Some(mut outline) = outline(source) {
                // What is brighter than this is chosen as if it were this bright, so that quotients stay finite.
                outline.strength = outline.strength.min(BRIGHTEST);
                places[index] = Some(members.len());
                members.push(index);
                outlines.push(outline);
            }
        }
        Self {
            lamps: LampTree::new(&outlines),
            sources: members,
            places,
        }
    }
}

impl Selection {
    pub(super) fn new(weights: &[f64], tree: &Tree, is_always: impl Fn(usize) -> bool) -> Self {
        let is_always: Vec<bool> = (0..weights.len()).map(is_always).collect();
        let mut rest = vec![0.0; weights.len() + 1];
        for (index, weight) in weights.iter().enumerate() {
            let place = tree.places[index].map_or(index, |_| weights.len());
            rest[place] += if is_always[index] { 0.0 } else { *weight };
        }
        // Weights are finite and not negative, which is all that can be wrong with them.
        let others = AliasTable::new(&rest).unwrap_or_default();
        let always = (0..weights.len())
            .filter(|index| is_always[*index])
            .collect();
        Self {
            always,
            is_always,
            others,
        }
    }

    /// Probability that a source is sampled for a point.
    pub(super) fn probability(&self, tree: &Tree, index: usize, from: &Receiver) -> f64 {
        match tree.places[index] {
            Some(place) if !self.is_always[index] => {
                let any = self.others.probability(self.is_always.len());
                any * tree.lamps.probability(from, place)
            }
            _ => self.alone(index),
        }
    }

    /// Probability that a source without a place is sampled.
    pub(super) fn alone(&self, index: usize) -> f64 {
        if self.is_always[index] {
            1.0
        } else {
            self.others.probability(index)
        }
    }
}

/// How often each source is chosen, not normalised: by power, half over all and half within each kind.
pub(super) fn weights(
    scene: &Scene,
    dome: &Dome,
    sun: Option<&SunDisk>,
    sources: &[Source],
) -> Vec<f64> {
    // Light from far away passes through the scene's disk.
    let bounds = scene.bounds();
    let diagonal = if bounds.is_empty() {
        0.0
    } else {
        bounds.diagonal().length()
    };
    let radius = if diagonal > 0.0 { 0.5 * diagonal } else { 1.0 };
    let disk = PI * radius * radius;
    let power = |source: &Source| {
        let power = match *source {
            Source::Lamp(index) => scene.lights()[index].power(radius),
            Source::Sun => sun.map_or(Rgb::BLACK, |sun| sun.irradiance * disk),
            Source::Sky => dome.typical_irradiance() * disk,
            Source::Emitter(id) => {
                let emitter = &scene.emitters()[id.0 as usize];
                let material = scene.material(emitter.material);
                let both = material.emitted_radiance(true) + material.emitted_radiance(false);
                both * (PI * emitter.area())
            }
        };
        // What is brighter than this is chosen as if it were this bright, so that sums stay finite.
        power.sum().min(BRIGHTEST)
    };
    let powers: Vec<f64> = sources.iter().map(power).collect();

    let kind = |source: &Source| match source {
        Source::Lamp(_) => 0,
        Source::Sun => 1,
        Source::Sky => 2,
        Source::Emitter(_) => 3,
    };
    let mut of_kind = [0.0; 4];
    for (source, power) in sources.iter().zip(&powers) {
        of_kind[kind(source)] += power;
    }
    let total: f64 = of_kind.iter().sum();
    let n_kinds = of_kind.iter().filter(|power| **power > 0.0).count() as f64;
    let weight = |(source, power): (&Source, &f64)| {
        if *power > 0.0 {
            let even = power / (of_kind[kind(source)] * n_kinds);
            SHARE_BY_POWER * power / total + (1.0 - SHARE_BY_POWER) * even
        } else {
            0.0
        }
    };
    sources.iter().zip(&powers).map(weight).collect()
}
