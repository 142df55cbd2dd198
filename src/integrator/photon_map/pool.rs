//! Light that small pieces near each other share.
//!
//! A needle that expects a hundredth of a photon meets one or none; its own light is right in the mean and useless. So pieces that expect
//! few photons put the power of theirs together with that of pieces near them, and all get it back by area: power over area in each of
//! the cells of an octree, which are as small as there are photons for. As a kernel does on a surface, this trades noise for blur,
//! and nothing is lost: what one piece gives others get.
//!
//! Light is kept for six directions of the normal, between which it is blended with the squares of the normal's coordinates (their sum is
//! 1). The area is [counted by lines](super::crossings), because most pieces of a forest met no photon.

use super::crossings::{Crossings, Cube, area};
use super::pieces::PiecePower;
use crate::color::Rgb;
use crate::math::rng;
use crate::scene::{Piece, Scene};
use glam::{DVec3, UVec3, Vec3};
use rayon::prelude::*;
use std::ops::Range;

/// A cell with so many pieces that met photons is split into eight.
const SPLIT: usize = 100;

/// Splittings of the scene: cells are at least 2⁻²¹ of it.
const DEEPEST: u32 = 21;

/// Photons that a piece expects that has a light of its own in part, and wholly.
const FEW: f64 = 8.0;
const MANY: f64 = 32.0;

/// Crossings without which the area is not known.
const LEAST_CROSSINGS: usize = 8;

/// The light of small pieces in cells.
#[derive(Debug, Default)]
pub(super) struct Pool {
    /// A corner of the cube that holds all cells, relative to the middle of the scene, and its edge, metres.
    pub(super) low: DVec3,
    pub(super) edge: f64,
    /// In the order of places; they do not overlap.
    pub(super) cells: Vec<Cell>,
}

/// What pieces in a cell share.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Cell {
    /// The first place in it.
    pub(super) begin: u64,
    /// How often the scene is split for it.
    pub(super) level: u32,
    /// Area of one side of pieces from which on they have their own light, m².
    pub(super) whole: f32,
    /// Irradiance by direction of the normal: -x, +x, -y, …, W/m².
    pub(super) lobes: [Vec3; 6],
}

impl Cell {
    /// What share of the light of a piece with this area of one side is its own.
    pub(super) fn own_share(&self, area: f64) -> f64 {
        own_share(area, f64::from(self.whole))
    }

    /// Irradiance of a side with this normal, W/m² per channel.
    pub(super) fn irradiance(&self, normal: DVec3) -> Rgb {
        let parts = lobes(normal).map(|(lobe, share)| self.lobes[lobe].as_dvec3() * share);
        Rgb::from_array((parts[0] + parts[1] + parts[2]).to_array())
    }
}

fn own_share(area: f64, whole: f64) -> f64 {
    let few = FEW / MANY * whole;
    ((area - few) / (whole - few)).clamp(0.0, 1.0)
}

/// The three directions that a normal lies between, and their shares.
fn lobes(normal: DVec3) -> [(usize, f64); 3] {
    [0, 1, 2].map(|axis| {
        let share = normal[axis] * normal[axis];
        (2 * axis + usize::from(normal[axis] > 0.0), share)
    })
}

impl Pool {
    /// Of the light of pieces, as power, that are small for this radius; `photons` have brought it.
    pub(super) fn new(
        scene: &Scene,
        center: DVec3,
        lights: &[PiecePower],
        photons: u64,
        radius: f64,
    ) -> Self {
        let bounds = scene.bounds();
        let edge = bounds.diagonal().max_element();
        let is_extended = edge > 0.0;
        if lights.is_empty() || !is_extended {
            return Self::default();
        }
        let mut pool = Self {
            low: bounds.center() - center - DVec3::splat(0.5 * edge),
            edge,
            cells: Vec::new(),
        };
        let mut placed: Vec<(u64, u32)> = lights
            .iter()
            .zip(0_u32..)
            .filter(|(light, _)| takes_part(scene, light))
            .map(|(light, at)| (pool.place(light.position.as_dvec3()), at))
            .collect();
        placed.par_sort_unstable();
        let power: f64 = lights.iter().map(|light| light.power.sum()).sum();
        let sharing = Sharing {
            scene,
            center,
            lights,
            radius,
            photon: power / photons as f64,
        };
        let mut leaves = Vec::new();
        split(&placed, (0..placed.len(), 0), &mut leaves);
        let cells = leaves
            .par_iter()
            .filter_map(|(range, level)| sharing.cell(&pool, &placed[range.clone()], *level));
        pool.cells = cells.collect();
        pool
    }

    /// Whether cells are as [`new`](Self::new) makes them.
    pub(super) fn is_sound(&self) -> bool {
        let ends = |cell: &Cell| cell.begin.checked_add(places(cell.level));
        let is_cell = |cell: &Cell| {
            let lobes = &cell.lobes;
            cell.level <= DEEPEST
                && cell.begin.is_multiple_of(places(cell.level))
                && cell.whole > 0.0
                && lobes.iter().all(|lobe| lobe.min_element() >= 0.0)
        };
        self.cells.iter().all(is_cell)
            && self
                .cells
                .is_sorted_by(|a, b| ends(a).is_some_and(|end| end <= b.begin))
            && (self.edge > 0.0 || self.cells.is_empty())
    }

    /// The number of a place: those of a cell follow one another.
    fn place(&self, position: DVec3) -> u64 {
        let unit = (position - self.low) / self.edge;
        let last = f64::from((1_u32 << DEEPEST) - 1);
        let at = (unit * f64::from(1_u32 << DEEPEST)).clamp(DVec3::ZERO, DVec3::splat(last));
        let UVec3 { x, y, z } = at.as_uvec3();
        spread(x) | spread(y) << 1 | spread(z) << 2
    }

    /// The cell that a position lies in, relative to the middle of the scene; `None` where pieces share nothing.
    pub(super) fn cell(&self, position: DVec3) -> Option<&Cell> {
        if self.cells.is_empty() {
            return None;
        }
        let place = self.place(position);
        let after = self.cells.partition_point(|cell| cell.begin <= place);
        let cell = &self.cells[after.checked_sub(1)?];
        (place - cell.begin < places(cell.level)).then_some(cell)
    }

    /// The cube of a cell, relative to the middle of the scene.
    fn cube(&self, begin: u64, level: u32) -> Cube {
        let unit = self.edge / f64::from(1_u32 << DEEPEST);
        let corner = DVec3::new(gathered(begin), gathered(begin >> 1), gathered(begin >> 2));
        Cube {
            low: self.low + corner * unit,
            edge: self.edge / f64::from(1_u32 << level),
        }
    }
}

/// Whether a piece shares light: the inside of bodies is a place of its own.
fn takes_part(scene: &Scene, light: &PiecePower) -> bool {
    let (first, is_back) = light.key;
    !is_back || matches!(scene.piece(first), Piece::Flat { .. })
}

/// Places of a cell.
fn places(level: u32) -> u64 {
    1 << (3 * (DEEPEST - level))
}

/// 21 bits with two zeros after each.
fn spread(bits: u32) -> u64 {
    let bits = u64::from(bits);
    (0..DEEPEST).fold(0, |all, bit| all | (bits >> bit & 1) << (3 * bit))
}

/// The opposite.
fn gathered(place: u64) -> f64 {
    (0..DEEPEST).fold(0, |all, bit| all | (place >> (3 * bit) & 1) << bit) as f64
}

/// The cells of those places, in order, that are not to be split any more.
fn split(
    placed: &[(u64, u32)],
    (range, level): (Range<usize>, u32),
    leaves: &mut Vec<(Range<usize>, u32)>,
) {
    let own = &placed[range.clone()];
    let Some((first, _)) = own.first() else {
        return;
    };
    if own.len() < SPLIT || level == DEEPEST {
        leaves.push((range, level));
        return;
    }
    let begin = first & !(places(level) - 1);
    let mut from = range.start;
    for child in 1..=8 {
        let until = begin + child * places(level + 1);
        let to = range.start + own.partition_point(|(place, _)| *place < until);
        split(placed, (from..to, level + 1), leaves);
        from = to;
    }
}

/// What cells are made from.
struct Sharing<'a> {
    scene: &'a Scene,
    center: DVec3,
    lights: &'a [PiecePower],
    /// Pieces are small for it, metres.
    radius: f64,
    /// Mean power of photons, W, channels added.
    photon: f64,
}

impl Sharing<'_> {
    /// What the pieces in a cell share; `None` where they are too few for their area to be known.
    fn cell(&self, pool: &Pool, placed: &[(u64, u32)], level: u32) -> Option<Cell> {
        let begin = placed.first()?.0 & !(places(level) - 1);
        let mut cube = pool.cube(begin, level);
        cube.low += self.center;
        let seed = rng::hash(&[begin, u64::from(level)]);
        let crossings = cube.crossings(self.scene, self.radius, seed);
        if crossings.found.len() < LEAST_CROSSINGS {
            return None;
        }
        let lights = || placed.iter().map(|(_, at)| &self.lights[*at as usize]);
        let surface: f64 = crossings
            .found
            .iter()
            .map(|crossing| crossings.each * if crossing.is_thin { 2.0 } else { 1.0 })
            .sum();
        let power: f64 = lights().map(|light| light.power.sum()).sum();
        let whole = (MANY * self.photon * surface / power).min(f64::from(f32::MAX));
        let mut powers = [DVec3::ZERO; 6];
        for light in lights() {
            let area = area(&self.scene.piece(light.key.0));
            let shared = DVec3::from_array(light.power.to_array()) * (1.0 - own_share(area, whole));
            for (lobe, share) in lobes(light.normal.unpack()) {
                powers[lobe] += shared * share;
            }
        }
        let areas = areas(&crossings, whole);
        let (all, total) = (powers.iter().sum::<DVec3>(), areas.iter().sum::<f64>());
        let mean = if total > 0.0 {
            all / total
        } else {
            DVec3::ZERO
        };
        // Where lines have found next to nothing that is turned so, it has the mean of all.
        let little = crossings.each;
        let light = |lobe: usize| {
            let light = (powers[lobe] + mean * little) / (areas[lobe] + little);
            light.as_vec3()
        };
        Some(Cell {
            begin,
            level,
            whole: whole as f32,
            lobes: [0, 1, 2, 3, 4, 5].map(light),
        })
    }
}

/// The area that shares light, by direction; enlarged by as much as makes its reciprocal right in the mean.
fn areas(crossings: &Crossings, whole: f64) -> [f64; 6] {
    let (mut sums, mut squares) = ([0.0; 7], [0.0; 7]);
    for line in crossings.found.chunk_by(|a, b| a.line == b.line) {
        let mut own = [0.0; 7];
        for crossing in line {
            let shared = crossings.each * (1.0 - own_share(crossing.area, whole));
            let sides = if crossing.is_thin { 2 } else { 1 };
            for normal in [crossing.normal, -crossing.normal].iter().take(sides) {
                for (lobe, share) in lobes(*normal) {
                    own[lobe] += shared * share;
                    own[6] += shared * share;
                }
            }
        }
        for lobe in 0..7 {
            sums[lobe] += own[lobe];
            squares[lobe] += own[lobe] * own[lobe];
        }
    }
    let variance = |lobe: usize| {
        if sums[lobe] > 0.0 {
            squares[lobe] / (sums[lobe] * sums[lobe])
        } else {
            0.0
        }
    };
    // Where lines went on until there were enough crossings, the reciprocal of the whole is right as it is.
    let known = if crossings.are_enough {
        variance(6)
    } else {
        0.0
    };
    [0, 1, 2, 3, 4, 5].map(|lobe| sums[lobe] * (1.0 + (variance(lobe) - known).max(0.0)))
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::geometry::Shape;
    use crate::integrator::photon_map::irradiance::IrradianceMap;
    use crate::integrator::photon_map::progressive::Progressive;
    use crate::integrator::photon_map::radius::Sizes;
    use crate::integrator::photon_map::spots::World;
    use crate::integrator::photon_map::stored::Stored;
    use crate::material::Material;
    use crate::math::{Ray, warp};
    use crate::scene::SurfacePoint;
    use crate::validation::room::{Room, gray};
    use glam::{DAffine3, DMat3, DVec2};
    use std::f64::consts::PI;

    /// Edge of a leaf, metres.
    const EDGE: f64 = 0.008;

    fn number(i: u64, k: u64) -> f64 {
        rng::unit_f64(rng::hash(&[i, k]))
    }

    /// Middle and normal of a leaf of a cloud that fills the unit cube.
    fn leaf(i: u64) -> (DVec3, DVec3) {
        let normal = warp::sphere(DVec2::new(number(i, 3), number(i, 4)));
        (DVec3::from_array([0, 1, 2].map(|k| number(i, k))), normal)
    }

    /// Leaves of the cloud, in the frames that `place` gives, all of them mirrored if wanted.
    fn cloud(n: u64, is_mirrored: bool) -> Scene {
        let square = Shape::Parallelogram {
            corner: DVec3::new(-0.5, -0.5, 0.0) * EDGE,
            edge_u: DVec3::X * EDGE,
            edge_v: DVec3::Y * EDGE,
        };
        let material = Material::leaf(gray(0.3), gray(0.2));
        let mut room = Room::default();
        for i in 0..n {
            let (middle, normal) = leaf(i);
            let (u, v) = normal.any_orthonormal_pair();
            let u = if is_mirrored { -u } else { u };
            let to_world = DAffine3 {
                matrix3: DMat3::from_cols(u, v, normal),
                translation: middle,
            };
            room = room.with(square.clone(), to_world, material.clone());
        }
        room.scene().unwrap()
    }

    /// The light that photons bring.
    fn truth(position: DVec3, normal: DVec3) -> f64 {
        1.0 + 0.5 * position.x + 0.4 * normal.z
    }

    /// A leaf, seen from one of its sides.
    fn seen(scene: &Scene, (middle, side): (DVec3, DVec3)) -> SurfacePoint {
        // Others may be before it.
        let ray = Ray::new(middle + side * 1e-5, -side).until(2e-5);
        scene.surface(&ray, &scene.closest(&ray).unwrap())
    }

    /// The map after passes, in each of which as many photons meet a side of a leaf as chance has it, `expected` in the mean.
    fn map(scene: &Scene, n: u64, expected: f64, n_passes: u32) -> IrradianceMap {
        let photon = EDGE * EDGE / (expected * f64::from(n_passes));
        let photons = |pass: u32| {
            let sides = (0..n).flat_map(|i| [1.0, -1.0].map(|sign| (i, sign)));
            let photons = sides.flat_map(|(i, sign)| {
                let (middle, normal) = leaf(i);
                let side = normal * sign;
                let mean = expected * truth(middle, side);
                let key = move |k: u64| number(rng::hash(&[i, u64::from(sign > 0.0)]), k);
                // Poisson: so many exponential steps fit in.
                let mut at = 0.0;
                let steps = (0_u64..).take_while(move |k| {
                    let u = key(k + 1000 * u64::from(pass));
                    at -= crate::math::functions::ln(1.0 - u);
                    at < mean
                });
                let point = seen(scene, (middle, side));
                steps.map(move |_| Stored::on(scene, &point, side, photon))
            });
            photons.collect::<Vec<Stored>>()
        };
        let world = World {
            scene,
            center: DVec3::ZERO,
        };
        let sizes = Sizes::Area(PI * 0.02 * 0.02);
        let mut light = Progressive::begin(world, photons(0), sizes, n_passes).unwrap();
        for pass in 1..n_passes {
            light.add(pass + 1, photons(pass));
        }
        light.finish()
    }

    /// Mean of the found irradiance over that of the truth, and relative squared error, over the sides of all leaves; and the error of
    /// what each of them has met itself.
    fn errors(scene: &Scene, n: u64, map: &IrradianceMap) -> [f64; 3] {
        let (mut sums, mut errors) = ([0.0; 2], [0.0; 3]);
        for i in 0..n {
            let (middle, normal) = leaf(i);
            for side in [normal, -normal] {
                let point = seen(scene, (middle, side));
                let piece = scene.piece(point.primitive);
                let truth = truth(middle, side);
                let found = map.irradiance(scene, &point, &piece, side).g;
                let key = (point.primitive, !point.is_front);
                let own = map.pieces.binary_search_by_key(&key, |piece| piece.key);
                let own = own.map_or(0.0, |at| map.pieces[at].irradiance.g);
                sums[0] += found;
                sums[1] += truth;
                errors[0] += (found - truth) * (found - truth);
                errors[1] += (own - truth) * (own - truth);
                errors[2] += truth * truth;
            }
        }
        [
            sums[0] / sums[1],
            errors[0] / errors[2],
            errors[1] / errors[2],
        ]
    }

    /// Nine in ten of the sides meet no photon. The standard error of the mean is 3 %: 2 % of 3000 photons, 2 % of lines in some 60
    /// cells; by chance it is 12 % off once in 10⁴. That of one side of a leaf instead of two, or of a cell whose area is only that of the
    /// leaves that met photons, is off by half and more.
    #[test]
    fn leaves_that_meet_a_photon_or_none_share_their_light() {
        for is_mirrored in [false, true] {
            let (n, scene) = (12_000, cloud(12_000, is_mirrored));
            let map = map(&scene, n, 0.1, 1);
            let [mean, error, own] = errors(&scene, n, &map);
            assert!((mean - 1.0).abs() < 0.12, "{mean}");
            assert!(own > 7.0, "{own}");
            assert!(error < own / 15.0, "{error} {own}");
        }
    }

    /// With 64 photons each leaf has its own light, to the last photon.
    #[test]
    fn leaves_that_meet_many_photons_share_nothing() {
        let (n, scene) = (200, cloud(200, false));
        let map = map(&scene, n, 64.0, 1);
        let [_, error, own] = errors(&scene, n, &map);
        assert_eq!(error, own);
        assert!(own < 2.0 / 64.0, "{own}");
    }

    /// With half a photon they share; with 64 times as many, in passes, they have their own light.
    #[test]
    fn what_leaves_have_gets_better_with_passes() {
        let (n, scene) = (3000, cloud(3000, false));
        let [few, many] = [1, 64].map(|n_passes| errors(&scene, n, &map(&scene, n, 0.5, n_passes)));
        assert!(
            few[1] < 0.1 * few[2] && many[1] < 0.5 * few[1],
            "{few:?} {many:?}"
        );
        assert!((many[0] - 1.0).abs() < 0.04, "{}", many[0]);
    }

    #[test]
    fn places_of_a_cell_follow_one_another_and_lie_in_its_cube() {
        let pool = Pool {
            low: DVec3::new(-1.0, 2.0, 0.0),
            edge: 4.0,
            cells: Vec::new(),
        };
        for i in 0..200 {
            let position = pool.low + DVec3::from_array([0, 1, 2].map(|k| number(i, k))) * 4.0;
            let place = pool.place(position);
            for level in [0, 3, 8] {
                let begin = place & !(places(level) - 1);
                let Cube { low, edge } = pool.cube(begin, level);
                let within = (position - low) / edge;
                assert!(within.min_element() >= 0.0 && within.max_element() < 1.0);
            }
        }
    }
}
