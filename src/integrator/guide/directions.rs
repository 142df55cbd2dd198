//! Densities over all directions, learnt from where light came from: quadtrees over the square that an octahedron unfolds to.
//!
//! The map has no sines, so its bits are cheap and the same everywhere; that it does not keep areas is put right by its
//! density. Source of the trees: [Muller2017](crate::references#muller2017); of the map:
//! [Cigolle2014](crate::references#cigolle2014).

use glam::{DVec2, DVec3};

/// Levels of a quadtree, at most: cells are not smaller than about a degree and a half.
const DEEPEST: u32 = 7;

/// A cell is divided if it holds more than this share of the light …
const LARGEST_SHARE: f64 = 0.01;

/// … that at least so many photons brought.
const FEWEST: usize = 6;

/// Binary digits of a coordinate of the square that are kept.
const DIGITS: u32 = 16;

/// Just below 1.
const ALMOST_ONE: f64 = 1.0 - f64::EPSILON;

/// Light that arrived from a direction.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Arrival {
    /// The direction it came from: coordinates in the square, digit by digit in turns, those of y first.
    code: u32,
    /// How much.
    pub(super) flux: f32,
}

/// All trees of a guide.
#[derive(Debug, Default)]
pub(super) struct Forest {
    nodes: Vec<Node>,
}

/// A tree of a [`Forest`].
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) struct Root(u32);

/// A cell of the square that is divided into four.
#[derive(Clone, Copy, Debug)]
struct Node {
    /// The share of its light in the lower half of x.
    below_x: f32,
    /// The share of the light of the lower and the upper half of x that is in the lower half of y.
    below_y: [f32; 2],
    /// The quarters, x first; 0 is a quarter that is not divided.
    quarters: [u32; 4],
}

impl Arrival {
    /// Light from the unit direction `w`.
    pub(super) fn new(w: DVec3, flux: f32) -> Self {
        let [x, y] = digits(to_square(w)).map(spread);
        Self {
            code: x | y << 1,
            flux,
        }
    }
}

impl Forest {
    /// Plants a tree that has learnt from these arrivals, which it sorts; `None` if they bring no light.
    pub(super) fn plant(&mut self, arrivals: &mut [Arrival]) -> Option<Root> {
        arrivals.sort_by_key(|arrival| arrival.code);
        let total = flux(arrivals);
        (total > 0.0).then(|| Root(self.grow(arrivals, total, 0)))
    }

    /// Divides a cell that holds `arrivals`; answers with its number.
    fn grow(&mut self, arrivals: &[Arrival], total: f64, level: u32) -> u32 {
        let shift = 2 * (DIGITS - 1 - level);
        let end = |quarter: u32| arrivals.partition_point(|a| (a.code >> shift) & 3 < quarter);
        let ends = [0, end(1), end(2), end(3), arrivals.len()];
        let quarter = |i: usize| &arrivals[ends[i]..ends[i + 1]];
        let light: [f64; 4] = std::array::from_fn(|i| flux(quarter(i)));

        let number = self.nodes.len() as u32;
        self.nodes.push(Node {
            below_x: share(light[0] + light[2], light[1] + light[3]),
            below_y: [share(light[0], light[2]), share(light[1], light[3])],
            quarters: [0; 4],
        });
        for (i, light) in light.into_iter().enumerate() {
            let is_large = light > LARGEST_SHARE * total && quarter(i).len() >= FEWEST;
            if is_large && level + 1 < DEEPEST {
                let grown = self.grow(quarter(i), total, level + 1);
                self.nodes[number as usize].quarters[i] = grown;
            }
        }
        number
    }

    /// A unit direction from a point of the unit square, with the density that the tree has learnt.
    pub(super) fn sample(&self, root: Root, u: DVec2) -> DVec3 {
        let mut u = u;
        let (mut corner, mut size) = (DVec2::ZERO, 1.0);
        let mut next = root.0;
        loop {
            let node = &self.nodes[next as usize];
            let (x, y);
            (x, u.x) = choose(node.below_x, u.x);
            (y, u.y) = choose(node.below_y[x], u.y);
            size *= 0.5;
            corner += DVec2::new(x as f64, y as f64) * size;
            next = node.quarters[x + 2 * y];
            if next == 0 {
                return to_direction(corner + u * size);
            }
        }
    }

    /// Density per steradian with which [`sample`](Self::sample) finds the unit direction `w`.
    pub(super) fn pdf_solid_angle(&self, root: Root, w: DVec3) -> f64 {
        let [x, y] = digits(to_square(w));
        let mut density = square_density(w);
        let mut next = root.0;
        let mut digit = DIGITS;
        loop {
            digit -= 1;
            let node = &self.nodes[next as usize];
            let x = (x >> digit & 1) as usize;
            let y = (y >> digit & 1) as usize;
            density *= 4.0 * of_half(node.below_x, x) * of_half(node.below_y[x], y);
            next = node.quarters[x + 2 * y];
            if next == 0 {
                return density;
            }
        }
    }
}

fn flux(arrivals: &[Arrival]) -> f64 {
    arrivals.iter().map(|arrival| f64::from(arrival.flux)).sum()
}

/// The share of `a` of both, rounded as it is stored; a half of nothing.
fn share(a: f64, b: f64) -> f32 {
    if a + b > 0.0 {
        (a / (a + b)) as f32
    } else {
        0.5
    }
}

/// The share of one half, of which the lower one has the share `below`.
fn of_half(below: f32, half: usize) -> f64 {
    let below = f64::from(below);
    if half == 0 { below } else { 1.0 - below }
}

/// Chooses a half by a number, and stretches what is left of the number to 0..1 again.
fn choose(below: f32, u: f64) -> (usize, f64) {
    let below = f64::from(below);
    let (half, rest) = if u < below {
        (0, u / below)
    } else {
        (1, (u - below) / (1.0 - below))
    };
    (half, rest.min(ALMOST_ONE))
}

/// The unit direction as a point of the unit square.
fn to_square(w: DVec3) -> DVec2 {
    let scale = 1.0 / (w.x.abs() + w.y.abs() + w.z.abs());
    let p = DVec2::new(w.x, w.y) * scale;
    let p = if w.z < 0.0 { folded(p) } else { p };
    p * 0.5 + 0.5
}

/// The unit direction that belongs to a point of the unit square.
fn to_direction(u: DVec2) -> DVec3 {
    let p = u * 2.0 - 1.0;
    let z = 1.0 - p.x.abs() - p.y.abs();
    let p = if z < 0.0 { folded(p) } else { p };
    DVec3::new(p.x, p.y, z).normalize()
}

/// Between the lower half of the octahedron and the corners of the square.
fn folded(p: DVec2) -> DVec2 {
    DVec2::new(
        (1.0 - p.y.abs()).copysign(p.x),
        (1.0 - p.x.abs()).copysign(p.y),
    )
}

/// Density per steradian of directions whose points in the square are uniform.
fn square_density(w: DVec3) -> f64 {
    // The octahedron |x| + |y| + |z| = 1 is met at the distance 1 / (|x| + |y| + |z|); its faces have the distance 1/√3.
    let sum = w.x.abs() + w.y.abs() + w.z.abs();
    0.25 / (sum * sum * sum)
}

/// The first digits of coordinates in 0..=1.
fn digits(u: DVec2) -> [u32; 2] {
    let scale = f64::from(1_u32 << DIGITS);
    let digits = |x: f64| ((x * scale) as u32).min((1 << DIGITS) - 1);
    [digits(u.x), digits(u.y)]
}

/// Puts a zero before each of 16 digits.
const fn spread(x: u32) -> u32 {
    let x = (x | x << 8) & 0x00FF_00FF;
    let x = (x | x << 4) & 0x0F0F_0F0F;
    let x = (x | x << 2) & 0x3333_3333;
    (x | x << 1) & 0x5555_5555
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::math::{rng, stats, warp};

    /// A tree that has learnt from a narrow lamp, half of the sky and a few stray photons.
    fn tree() -> (Forest, Root) {
        let number = |i: u64, k: u64| rng::unit_f64(rng::hash(&[i, k]));
        let mut arrivals: Vec<Arrival> = (0..4000)
            .map(|i| {
                let w = warp::sphere(DVec2::new(number(i, 0), number(i, 1)));
                let w = match i % 4 {
                    0 => (DVec3::new(0.3, -0.5, 0.8) + w * 0.05).normalize(),
                    1 | 2 => w.with_z(w.z.abs()),
                    _ => w,
                };
                Arrival::new(w, 0.5 + number(i, 2) as f32)
            })
            .collect();
        let mut forest = Forest::default();
        let root = forest.plant(&mut arrivals).unwrap();
        (forest, root)
    }

    #[test]
    fn the_square_and_the_sphere_are_the_same() {
        for i in 0..4096_u32 {
            let u = DVec2::new(f64::from(i % 64) + 0.5, f64::from(i / 64) + 0.5) / 64.0;
            let w = to_direction(u);
            assert!((w.length() - 1.0).abs() < 1e-14);
            assert!((to_square(w) - u).length() < 1e-14, "{u} {w}");
        }
    }

    #[test]
    fn densities_integrate_to_one() {
        let (forest, root) = tree();
        let n = 1200;
        let mut sums = [0.0; 2];
        for i in 0..n * n {
            let u = DVec2::new(f64::from(i % n) + 0.5, f64::from(i / n) + 0.5) / f64::from(n);
            let w = warp::sphere(u);
            let cell = 4.0 * std::f64::consts::PI / f64::from(n * n);
            sums[0] += square_density(w) * cell;
            sums[1] += forest.pdf_solid_angle(root, w) * cell;
        }
        // The map has edges, and cells have more, which a grid meets with an error of about their length times its spacing. A
        // power too few in the map's density would be off by a third.
        assert!((sums[0] - 1.0).abs() < 2e-4, "{sums:?}");
        assert!((sums[1] - 1.0).abs() < 3e-3, "{sums:?}");
    }

    #[test]
    fn directions_have_the_density_that_is_claimed() {
        // χ² over 12 × 24 bands and sectors; expected counts by 40 × 40 points in each. A density off by 5 % in a tenth of
        // the sphere adds about 500 here. Error probability 1e-6.
        let (forest, root) = tree();
        let (rows, columns, n) = (12_usize, 24_usize, 2_000_000_u64);
        let mut counts = vec![0.0; rows * columns];
        for i in 0..n {
            let u = [0, 1].map(|k| rng::unit_f64(rng::hash(&[77, i, k])));
            let w = forest.sample(root, DVec2::from_array(u));
            let turn = (w.y.atan2(w.x) / std::f64::consts::TAU).rem_euclid(1.0);
            let row = ((1.0 - w.z) * 0.5 * rows as f64).min(rows as f64 - 1.0) as usize;
            counts[row * columns + (turn * columns as f64) as usize % columns] += 1.0;
        }
        let fine = 60;
        let mut chi = 0.0;
        let mut cells = 0.0;
        for (i, count) in counts.iter().enumerate() {
            let mut share = 0.0;
            for k in 0..fine * fine {
                let u = DVec2::new(
                    ((i / columns) as f64 + (f64::from(k / fine) + 0.5) / f64::from(fine))
                        / rows as f64,
                    ((i % columns) as f64 + (f64::from(k % fine) + 0.5) / f64::from(fine))
                        / columns as f64,
                );
                share += forest.pdf_solid_angle(root, warp::sphere(u));
            }
            let solid_angle = 4.0 * std::f64::consts::PI / (rows * columns) as f64;
            let expected = share / f64::from(fine * fine) * solid_angle * n as f64;
            if expected > 100.0 {
                // The expected counts have an error of their own, of about half a percent.
                let variance = expected + (0.005 * expected).powi(2);
                chi += (count - expected).powi(2) / variance;
                cells += 1.0;
            }
        }
        let tail = stats::chi_squared_upper_tail(chi, cells);
        assert!(tail > 1e-6, "{chi} in {cells}");
    }
}
