//! Where irradiance is sampled, and with how large a kernel.
//!
//! A given *Photon area* is one kernel for all: places on the surfaces a fraction of its radius apart, at photons. Chosen
//! automatically, the kernel is begun with far wider than most places need ([`Sizes`](super::radius::Sizes)), and halved where the photons
//! in it show that the light is not even ([`Estimate::is_even`](super::estimate::Estimate::is_even)), as long as 50 are left: smooth light is
//! calm, dim or bright, and the rims of caustics are sharp. More photons tell less uneven light, so blur and noise vanish together.
//! So [`Schregle2003`](crate::references#schregle2003) compensates bias, with as many photons as their mean allows; here the place
//! where the light changes counts too, and the real area is measured for each size.

use super::estimate::{Estimate, Measured, Spot, estimate, measure};
use super::irradiance::Sample;
use super::radius::Radii;
use super::stored::{PackedNormal, Stored, flat_extent, is_matt_somewhere};
use crate::color::Rgb;
use crate::integrator::carrier::facing;
use crate::integrator::grid::{Grid, cell};
use crate::math::Ray;
use crate::math::frame::Frame;
use crate::scene::Scene;
use glam::{DVec3, Vec3};
use rayon::prelude::*;

/// Photons that must be left in a kernel of half the radius.
const LEAST_PHOTONS: f64 = 50.0;

/// Kernels are halved so often at most.
const MOST_HALVINGS: usize = 12;

/// How high above a plane its surface is looked for, in radii.
const LIFT: f64 = 0.15;

/// How high above the surface photons are looked for, in radii.
const LOOK: f64 = 0.1;

/// Least cosine between normals of one surface.
const SAME_NORMAL: f64 = 0.9;

/// Photons whose places are thinned out at once.
const CHUNK: usize = 1 << 16;

/// The scene, and the point in it that positions are relative to.
#[derive(Clone, Copy)]
pub(super) struct World<'s> {
    pub(super) scene: &'s Scene,
    pub(super) center: DVec3,
}

/// Where irradiance is sampled.
#[derive(Clone, Copy, Debug)]
pub(super) struct Place {
    position: Vec3,
    normal: PackedNormal,
    /// How far the surface is about flat, metres.
    extent: f64,
    /// Whether no photon lies there.
    is_made: bool,
}

/// A place with its kernel and its light.
#[derive(Clone, Copy, Debug)]
pub(super) struct SpotLight {
    place: Place,
    /// Metres.
    radius: f64,
    measured: Measured,
    /// W/m².
    pub(super) irradiance: Rgb,
    /// Passes before it was there.
    pub(super) missed: u32,
}

/// Places of one density.
#[derive(Debug)]
pub(super) struct SpotLayer {
    /// Metres between them.
    pub(super) spacing: f64,
    /// The kernel's radius where the surface is flat so far, metres.
    pub(super) radius: f64,
    pub(super) spots: Vec<SpotLight>,
}

/// A cell, and one of six main directions of the normal.
pub(super) type Key = ([i32; 3], u8);

impl Place {
    fn of(photon: &Stored, scene: &Scene) -> Self {
        Self {
            position: photon.position().as_vec3(),
            normal: photon.packed_normal(),
            extent: photon.flat_extent(scene),
            is_made: false,
        }
    }

    /// As the sample will have it, so that what is hidden is found again in the same frame.
    fn spot(&self) -> Spot {
        Spot {
            position: self.position.as_dvec3(),
            normal: self.normal.unpack().as_vec3().as_dvec3(),
        }
    }

    fn key(&self, width: f64) -> Key {
        let normal = self.normal.unpack();
        let axis = normal.abs().max_position();
        let direction = 2 * axis as u8 + u8::from(normal[axis] < 0.0);
        let cell = cell(self.position.as_dvec3(), width);
        (cell.to_array(), direction)
    }
}

impl SpotLight {
    /// Measures the surface round a place.
    fn new(world: &World<'_>, place: Place, radius: f64) -> Self {
        let radius = radius.min(place.extent);
        let Spot { position, normal } = place.spot();
        Self {
            place,
            radius,
            measured: measure(world.scene, world.center + position, normal, radius),
            irradiance: Rgb::BLACK,
            missed: 0,
        }
    }

    /// The light of some photons.
    ///
    /// What is hidden is known by cells, half of which may lie before the thin wall that hides them. That does not matter where photons
    /// are on this side too; where there are none, in its shadow, each photon is looked at.
    pub(super) fn light(&self, world: &World<'_>, photons: &Grid<Stored>) -> Estimate {
        let spot = self.place.spot();
        let looks = self.place.is_made && !self.measured.hidden().is_none();
        let above = world.center + spot.position + spot.normal * (LOOK * self.radius);
        let is_hidden = |to: DVec3| {
            let ray = |w| Ray::new(above, w).until(to.length());
            looks
                && to
                    .try_normalize()
                    .is_some_and(|w| world.scene.occluded(&ray(w)))
        };
        estimate(photons, spot, self.radius, &self.measured, is_hidden)
    }

    /// The same place with a kernel of another size.
    pub(super) fn resized(&self, world: &World<'_>, radius: f64) -> Self {
        Self {
            irradiance: self.irradiance,
            missed: self.missed,
            ..Self::new(world, self.place, radius)
        }
    }

    /// What views ask for.
    pub(super) fn sample(&self) -> Sample {
        let light = DVec3::from_array(self.irradiance.to_array()).as_vec3();
        let (place, hidden) = (&self.place, self.measured.hidden());
        Sample::of((
            place.position,
            place.normal,
            light,
            self.radius as f32,
            hidden,
        ))
    }
}

/// Diagonal of a scene, metres; 0 if it has no size.
pub(super) fn scene_size(scene: &Scene) -> f64 {
    scene.bounds().diagonal().length()
}

/// Layers of places with the light of `photons` there, the coarsest first; places are `spacing` radii apart.
pub(super) fn spots(
    world: &World<'_>,
    photons: Vec<Stored>,
    radii: Radii,
    spacing: f64,
) -> Vec<SpotLayer> {
    let mut layers = Vec::new();
    let places = thinned(
        (world.scene, &photons),
        Vec::new(),
        radii.largest * spacing,
        |_| true,
    );
    let mut next = Some(Level {
        world: *world,
        radii,
        radius: radii.largest,
        width: radii.largest * spacing,
        halvings: MOST_HALVINGS,
        places,
        photons,
    });
    while let Some(level) = next {
        let (layer, finer) = level.light();
        if !layer.spots.is_empty() {
            layers.push(layer);
        }
        next = finer;
    }
    layers
}

/// Places for a kernel of one size, and the photons near them.
struct Level<'s> {
    world: World<'s>,
    radii: Radii,
    /// That of the kernel, and how far places are apart, metres.
    radius: f64,
    width: f64,
    /// How often the kernel may still be halved.
    halvings: usize,
    places: Vec<Place>,
    photons: Vec<Stored>,
}

impl<'s> Level<'s> {
    /// The places where this kernel is the right one, and those where a smaller one is.
    fn light(self) -> (SpotLayer, Option<Self>) {
        let (radius, radii) = (self.radius, self.radii);
        let may_halve = self.halvings > 0 && 0.5 * radius >= radii.smallest;
        // Round bodies are no place for kernels larger than they are.
        let is_large = |place: &Place| radius > radii.usual && place.extent < radius;
        let (mut again, places): (Vec<Place>, Vec<Place>) = self
            .places
            .into_iter()
            .partition(|place| may_halve && is_large(place));
        let grid = Grid::new(self.photons, radius, Stored::position);
        let lit: Vec<(SpotLight, bool)> = places
            .par_iter()
            .map(|place| {
                let mut spot = SpotLight::new(&self.world, *place, radius);
                let light = spot.light(&self.world, &grid);
                spot.irradiance = light.irradiance;
                let is_uneven = !light.is_even && light.photons >= 4.0 * LEAST_PHOTONS;
                (spot, may_halve && is_uneven)
            })
            .collect();
        let (uneven, even): (Vec<_>, Vec<_>) = lit.into_iter().partition(|(_, halves)| *halves);
        let uneven: Vec<Place> = uneven.iter().map(|(spot, _)| spot.place).collect();
        again.extend(&uneven);
        let layer = SpotLayer {
            spacing: self.width,
            radius,
            spots: even.iter().map(|(spot, _)| *spot).collect(),
        };
        if again.is_empty() {
            return (layer, None);
        }
        let finer = Self {
            photons: near(&again, grid, 0.5 * radius + 2.0 * self.width),
            places: Vec::new(),
            ..self
        };
        (layer, Some(finer.halved(&again, &uneven)))
    }

    /// The same cells with a kernel of half the size, whose places are half as far apart. Where the light is `uneven` all of the surface
    /// has places.
    fn halved(self, again: &[Place], uneven: &[Place]) -> Self {
        let (world, width) = (self.world, self.width);
        let more = uneven
            .par_iter()
            .flat_map_iter(|place| between(&world, place, width));
        let more: Vec<Place> = more.collect();
        let mut cells: Vec<Key> = again.iter().map(|place| place.key(width)).collect();
        cells.par_sort_unstable();
        let places = thinned(
            (self.world.scene, &self.photons),
            more,
            0.5 * width,
            |place| cells.binary_search(&place.key(width)).is_ok(),
        );
        Self {
            radius: 0.5 * self.radius,
            width: 0.5 * width,
            halvings: self.halvings - 1,
            places,
            ..self
        }
    }
}

/// The cells of this width that photons lie in, sorted.
pub(super) fn cells(photons: (&Scene, &[Stored]), width: f64) -> Vec<Key> {
    let places = thinned(photons, Vec::new(), width, |_| true);
    places.iter().map(|place| place.key(width)).collect()
}

/// A place for each of the cells of this width that photons lie in and that are not `known`, which are then; dark as yet.
pub(super) fn newly_found(
    world: &World<'_>,
    photons: &[Stored],
    (radius, width): (f64, f64),
    known: &mut Vec<Key>,
) -> Vec<SpotLight> {
    let is_new = |place: &Place| known.binary_search(&place.key(width)).is_err();
    let places = thinned((world.scene, photons), Vec::new(), width, is_new);
    known.extend(places.iter().map(|place| place.key(width)));
    known.sort_unstable();
    let spot = |place: &Place| SpotLight::new(world, *place, radius);
    places.par_iter().map(spot).collect()
}

/// Places of photons about so far apart, whatever the light there.
pub(super) fn anywhere(photons: (&Scene, &[Stored]), width: f64) -> Vec<(Vec3, PackedNormal)> {
    let places = thinned(photons, Vec::new(), width, |_| true);
    let place = |place: &Place| (place.position, place.normal);
    places.iter().map(place).collect()
}

/// The photons within `reach` of some of these places.
fn near(places: &[Place], photons: Grid<Stored>, reach: f64) -> Vec<Stored> {
    let places = Grid::new(places.to_vec(), reach, |place| place.position.as_dvec3());
    let is_near = |photon: &&Stored| {
        let position = photon.position();
        let mut is_near = false;
        places.near(position, |place| {
            let to = place.position.as_dvec3() - position;
            is_near |= to.length_squared() <= reach * reach;
        });
        is_near
    };
    photons
        .things()
        .par_iter()
        .filter(is_near)
        .copied()
        .collect()
}

/// Places on the surface in the cell of another one, so near to each other that none of its eighths is left out: dark ones have no
/// photons.
fn between(world: &World<'_>, place: &Place, width: f64) -> impl Iterator<Item = Place> {
    let Spot { position, normal } = place.spot();
    let frame = Frame::from_normal(normal);
    let middle = (cell(position, width).as_dvec3() + 0.5) * width;
    let middle = middle - normal * (middle - position).dot(normal);
    let lift = LIFT * width.min(place.extent);
    let World { scene, center } = *world;
    let steps = [-0.75, -0.25, 0.25, 0.75];
    let corners = steps.into_iter().flat_map(move |x| steps.map(|y| (x, y)));
    corners.filter_map(move |(x, y)| {
        let at = middle + frame.to_world(DVec3::new(x, y, 0.0) * width);
        let ray = Ray::new(center + at + normal * lift, -normal).until(2.0 * lift);
        let hit = scene.closest(&ray)?;
        let point = scene.surface(&ray, &hit);
        let side = facing(point.normal_g, normal);
        let is_same = side.dot(normal) > SAME_NORMAL && is_matt_somewhere(&scene.optics(&point));
        is_same.then(|| Place {
            position: (point.position - center).as_vec3(),
            normal: PackedNormal::new(side),
            extent: flat_extent(&scene.piece(point.primitive)),
            is_made: true,
        })
    })
}

/// Of the places of `photons`, then `more`, those that are `wanted`: the first in each cell of this width.
fn thinned(
    (scene, photons): (&Scene, &[Stored]),
    more: Vec<Place>,
    width: f64,
    wanted: impl Fn(&Place) -> bool + Sync,
) -> Vec<Place> {
    // Chunk by chunk, so that few keys are in memory at once.
    let chunks = photons.par_chunks(CHUNK).map(|chunk| {
        let places = chunk.iter().map(|photon| Place::of(photon, scene));
        let places = places.filter(|place| wanted(place));
        firsts(places.collect(), width)
    });
    let mut places: Vec<Place> = chunks.flatten_iter().collect();
    places.extend(more.into_iter().filter(|place| wanted(place)));
    firsts(places, width)
}

/// The first place in each cell.
fn firsts(places: Vec<Place>, width: f64) -> Vec<Place> {
    let keys = places.iter().zip(0_u32..);
    let mut keys: Vec<(Key, u32)> = keys.map(|(place, at)| (place.key(width), at)).collect();
    keys.par_sort_unstable();
    keys.dedup_by_key(|(key, _)| *key);
    keys.iter().map(|(_, at)| places[*at as usize]).collect()
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::integrator::photon_map::irradiance::SPACING;
    use crate::integrator::photon_map::radius::Sizes;
    use crate::material::Material;
    use crate::math::rng;
    use crate::validation::room::{Room, square};
    use glam::DAffine3;
    use std::f64::consts::PI;

    /// A bright spot with a sharp rim on even light, W/m².
    fn light(x: f64, y: f64) -> f64 {
        if x.hypot(y) < 0.15 { 20.0 } else { 1.0 }
    }

    fn photons(n: u64) -> Vec<Stored> {
        let mean = 20.0;
        let photon = |i: u64| {
            let u = |k| rng::unit_f64(rng::hash(&[i, k]));
            let (x, y) = (u(0) * 0.8 - 0.4, u(1) * 0.8 - 0.4);
            let is_there = u(2) * mean < light(x, y);
            let power = 0.64 * mean / n as f64;
            is_there.then(|| Stored::at(DVec3::new(x, y, 0.0), DVec3::Z, power))
        };
        (0..n).filter_map(photon).collect()
    }

    /// Mean absolute error over the middle of the floor, in the spots' own cells, and the layers.
    fn error(scene: &Scene, radii: Radii) -> (f64, Vec<SpotLayer>) {
        let world = World {
            scene,
            center: DVec3::ZERO,
        };
        let layers = spots(&world, photons(400_000), radii, SPACING);
        let (mut sum, mut area) = (0.0, 0.0);
        for layer in &layers {
            let cell = layer.spacing * layer.spacing;
            for spot in &layer.spots {
                let at = spot.place.position;
                if at.abs().max_element() < 0.3 {
                    let truth = light(f64::from(at.x), f64::from(at.y));
                    sum += (spot.irradiance.g - truth).abs() * cell;
                    area += cell;
                }
            }
        }
        (sum / area, layers)
    }

    #[test]
    fn rims_are_sharp_and_even_light_is_calm() {
        let room = Room::default().with(square(0.4), DAffine3::IDENTITY, Material::default());
        let scene = room.scene().unwrap();
        let usual = 0.02;
        let chosen = Radii {
            largest: 4.0 * usual,
            usual,
            smallest: 1e-4,
        };
        let (found, layers) = error(&scene, chosen);
        assert!(layers.len() >= 4, "{}", layers.len());
        let reach = |radius: f64| layers.iter().filter(move |layer| layer.radius == radius);
        // Far from the rim the largest kernel; at the rim hardly any that large.
        let far = |spot: &&SpotLight| (spot.place.position.length() - 0.15).abs() > 0.1;
        let (large, n_far) = (
            reach(4.0 * usual)
                .flat_map(|layer| &layer.spots)
                .filter(far)
                .count(),
            layers
                .iter()
                .flat_map(|layer| &layer.spots)
                .filter(far)
                .count(),
        );
        assert!(large * 10 > n_far * 8, "{large} of {n_far}");
        let at_rim = |spot: &&SpotLight| (spot.place.position.length() - 0.15).abs() < 0.01;
        let coarse = reach(4.0 * usual).chain(reach(2.0 * usual));
        let coarse = coarse.flat_map(|layer| &layer.spots).filter(at_rim).count();
        assert_eq!(coarse, 0);
        for radius in [4.0, 1.0] {
            let radius = radius * usual;
            let area = PI * radius * radius;
            let fixed = Radii::new(&photons(1000), Sizes::Area(area), 10.0).unwrap();
            let (with_one, _) = error(&scene, fixed);
            assert!(found < 0.75 * with_one, "{radius}: {found} {with_one}");
        }
    }

    /// Where a two hundredth of the light falls, narrow kernels hold 8 photons and are a third off, wide ones are calm. Their mean is of some
    /// dozens of independent kernels: 0.1 is exceeded by chance less than once in 10⁶.
    #[test]
    fn the_dim_is_as_calm_as_the_bright() {
        let room = Room::default().with(square(0.4), DAffine3::IDENTITY, Material::default());
        let scene = room.scene().unwrap();
        let world = World {
            scene: &scene,
            center: DVec3::ZERO,
        };
        let power = 1e-5;
        let photon = |i: u64| {
            let u = |k| rng::unit_f64(rng::hash(&[i, k]));
            let (x, y) = (u(0) * 0.4, u(1) * 0.8 - 0.4);
            let x = if i.is_multiple_of(201) { x } else { -x };
            Stored::at(DVec3::new(x, y, 0.0), DVec3::Z, power)
        };
        let photons: Vec<Stored> = (0..100_000).map(photon).collect();
        let deviation = |sizes| {
            let radii = Radii::new(&photons, sizes, 10.0).unwrap();
            let (mut sum, mut area) = (0.0, 0.0);
            for layer in spots(&world, photons.clone(), radii, SPACING) {
                let cell = layer.spacing * layer.spacing;
                for spot in &layer.spots {
                    let (x, y) = (spot.place.position.x, spot.place.position.y);
                    if x > 0.25 && y.abs() < 0.25 {
                        let truth = 100_000.0 / 201.0 * power / 0.32;
                        sum += (spot.irradiance.g / truth - 1.0).abs() * cell;
                        area += cell;
                    }
                }
            }
            sum / area
        };
        let (wide, narrow) = (deviation(Sizes::Wide), deviation(Sizes::Narrow));
        assert!(wide < 0.1 && narrow > 0.2, "{wide} {narrow}");
    }
}
