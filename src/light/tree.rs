//! Choosing one of many lamps by what each can give to a point: a binary tree over their outlines.
//!
//! On the way down each branch is taken with the probability of its part of what both could give
//! ([`ContyKulla2018`](crate::references#contykulla2018)), by one of two measures: strength times nearness; for a share
//! of the choices the distance of the nearest point alone, so that lamps close by are found, and a weak lamp is still found in
//! its own dark corner when another lamp, which the tree cannot know to be hidden behind walls, is 10¹² times as strong (C-45).
//! Lamps that surely give nothing are not chosen; every other lamp can be.

use super::outline::{Beam, LampOutline, Receiver};
use crate::math::Bounds3;
use glam::DVec3;

/// Share of the choices that goes by nearness alone.
const SHARE_BY_NEARNESS: f64 = 0.5;

/// Intervals of the boxes' middles that are tried as places to divide at, along each axis.
const BUCKETS: usize = 12;

/// From this depth on lamps are divided into equal halves, so that no way down is longer than 64 steps.
const DEEPEST: u32 = 30;

/// The largest number below 1.
const BELOW_ONE: f64 = 1.0 - 0.5 * f64::EPSILON;

/// A tree over lamps.
#[derive(Clone, Debug, Default)]
pub struct LampTree {
    /// Each before its left branch, which stands directly behind it.
    nodes: Vec<Node>,
    /// For each lamp its way down: bit k says whether step k goes to the right. `None` for lamps without strength.
    ways: Vec<Option<Way>>,
}

#[derive(Clone, Copy, Debug)]
struct Way {
    bits: u64,
    length: u32,
}

#[derive(Clone, Debug)]
struct Node {
    beam: Beam,
    strength: f64,
    n_lamps: f64,
    next: Next,
}

#[derive(Clone, Copy, Debug)]
enum Next {
    /// Where the right branch stands.
    Right(u32),
    /// The lamp.
    Lamp(u32),
}

/// A lamp that was chosen.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct ChosenLamp {
    /// Its number in the list that the tree was built from.
    pub index: usize,
    /// With which probability it was chosen.
    pub probability: f64,
}

/// Probabilities by strength and nearness, and by nearness alone.
#[derive(Clone, Copy)]
struct Odds([f64; 2]);

impl Odds {
    fn mixed(self) -> f64 {
        (1.0 - SHARE_BY_NEARNESS) * self.0[0] + SHARE_BY_NEARNESS * self.0[1]
    }
}

/// A lamp on its way into the tree.
#[derive(Clone, Copy)]
struct Item {
    index: u32,
    outline: LampOutline,
    center: DVec3,
}

impl LampTree {
    /// A tree over lamps of these outlines; lamps without strength stay out. Cost O(n log n).
    #[must_use]
    pub fn new(outlines: &[LampOutline]) -> Self {
        let strongest = outlines
            .iter()
            .fold(0.0, |most, lamp| lamp.strength.max(most));
        let mut items: Vec<Item> = (0_u32..)
            .zip(outlines)
            .filter(|(_, outline)| outline.strength > 0.0)
            .map(|(index, outline)| Item {
                index,
                // In parts of the strongest, so that sums stay finite.
                outline: LampOutline {
                    strength: outline.strength / strongest,
                    ..*outline
                },
                center: outline.bounds.center(),
            })
            .collect();
        let mut tree = Self {
            nodes: Vec::with_capacity(2 * items.len()),
            ways: vec![None; outlines.len()],
        };
        if !items.is_empty() {
            tree.grow(&mut items, Way { bits: 0, length: 0 });
        }
        tree
    }

    /// Whether there is nothing to choose.
    #[must_use]
    pub fn is_empty(&self) -> bool {
        self.nodes.is_empty()
    }

    fn grow(&mut self, items: &mut [Item], way: Way) {
        let here = self.nodes.len();
        let outlines = items.iter().map(|item| item.outline);
        let Some(outline) = outlines.reduce(|a, b| a.union(&b)) else {
            return;
        };
        self.nodes.push(Node {
            beam: Beam::new(&outline),
            strength: outline.strength,
            n_lamps: items.len() as f64,
            next: Next::Lamp(items[0].index),
        });
        if let [only] = items {
            self.ways[only.index as usize] = Some(way);
            return;
        }
        let middle = divide(items, &outline, way.length);
        let (left, right) = items.split_at_mut(middle);
        let length = way.length + 1;
        self.grow(left, Way { length, ..way });
        self.nodes[here].next = Next::Right(self.nodes.len() as u32);
        let bits = way.bits | 1 << way.length;
        self.grow(right, Way { bits, length });
    }

    /// Chooses a lamp for a point by a uniform number in [0, 1). `None` if none can give it light.
    #[must_use]
    pub fn sample(&self, receiver: &Receiver, u: f64) -> Option<ChosenLamp> {
        if self.nodes.is_empty() {
            return None;
        }
        let (measure, mut u) = if u < SHARE_BY_NEARNESS {
            (1, u / SHARE_BY_NEARNESS)
        } else {
            (0, (u - SHARE_BY_NEARNESS) / (1.0 - SHARE_BY_NEARNESS))
        };
        let (mut at, mut odds) = (0, Odds([1.0; 2]));
        loop {
            match self.nodes[at].next {
                Next::Lamp(index) => {
                    return Some(ChosenLamp {
                        index: index as usize,
                        probability: odds.mixed(),
                    });
                }
                Next::Right(right) => {
                    let branches = [at + 1, right as usize];
                    let left_odds = self.left_odds(receiver, branches);
                    let chance = left_odds[measure]?;
                    let goes_right = u >= chance;
                    odds.take(left_odds, goes_right);
                    u = if goes_right {
                        (u - chance) / (1.0 - chance)
                    } else {
                        u / chance
                    };
                    // Rounded up to 1 it would take branches of no chance.
                    u = u.min(BELOW_ONE);
                    at = branches[usize::from(goes_right)];
                }
            }
        }
    }

    /// The probability with which [`sample`](Self::sample) chooses a lamp for a point.
    #[must_use]
    pub fn probability(&self, receiver: &Receiver, index: usize) -> f64 {
        let Some(way) = self.ways.get(index).copied().flatten() else {
            return 0.0;
        };
        let (mut at, mut odds) = (0, Odds([1.0; 2]));
        for step in 0..way.length {
            let Next::Right(right) = self.nodes[at].next else {
                return 0.0;
            };
            let branches = [at + 1, right as usize];
            let goes_right = way.bits >> step & 1 == 1;
            odds.take(self.left_odds(receiver, branches), goes_right);
            at = branches[usize::from(goes_right)];
        }
        odds.mixed()
    }

    /// The chance of the left branch by each measure; `None` where neither can give anything.
    fn left_odds(&self, receiver: &Receiver, branches: [usize; 2]) -> [Option<f64>; 2] {
        let [left, right] = branches.map(|branch| {
            let node = &self.nodes[branch];
            let nearness = node.beam.nearness(receiver);
            [nearness[0] * node.strength, nearness[1] * node.n_lamps]
        });
        let chance = |k: usize| {
            let sum: f64 = left[k] + right[k];
            (sum > 0.0).then(|| left[k] / sum)
        };
        [chance(0), chance(1)]
    }
}

impl Odds {
    /// Goes down one branch.
    fn take(&mut self, left: [Option<f64>; 2], goes_right: bool) {
        for (odds, left) in self.0.iter_mut().zip(left) {
            *odds *= left.map_or(0.0, |left| if goes_right { 1.0 - left } else { left });
        }
    }
}

/// Puts the lamps in order and says where the right half begins, never at an end: where boxes and cones of both halves are
/// smallest for the strength in them.
///
/// Source: [`ContyKulla2018`](crate::references#contykulla2018). The square of the diagonal stands for the area of a box,
/// which is 0 for lamps in a line, and lamps are counted besides their strength, since they are also chosen without it.
fn divide(items: &mut [Item], whole: &LampOutline, depth: u32) -> usize {
    let mut best: Option<(f64, usize, f64)> = None;
    let middles = Bounds3::of(items.iter().map(|item| item.center));
    let extent = middles.diagonal();
    for axis in 0..3 {
        if depth >= DEEPEST || extent[axis] <= 0.0 || !extent[axis].is_finite() {
            continue;
        }
        let stretch = whole.bounds.diagonal().max_element() / whole.bounds.diagonal()[axis];
        let mut buckets: [Option<Bucket>; BUCKETS] = [None; BUCKETS];
        for item in items.iter() {
            let place = bucket(item.center[axis], middles.min[axis], extent[axis]);
            let other = Bucket::of(item);
            buckets[place] = Some(buckets[place].map_or(other, |bucket| bucket.and(&other)));
        }
        for cut in 1..BUCKETS {
            let cost = |part: &[Option<Bucket>]| {
                part.iter()
                    .flatten()
                    .copied()
                    .reduce(|a, b| a.and(&b))
                    .map(|part| part.cost())
            };
            if let (Some(left), Some(right)) = (cost(&buckets[..cut]), cost(&buckets[cut..])) {
                let cost = stretch * (left + right);
                if best.is_none_or(|(least, ..)| cost < least) {
                    best = Some((cost, axis, cut as f64));
                }
            }
        }
    }
    match best {
        Some((_, axis, cut)) => {
            let is_left = |item: &Item| {
                (bucket(item.center[axis], middles.min[axis], extent[axis]) as f64) < cut
            };
            items.sort_by_key(|item| !is_left(item));
            items.partition_point(is_left)
        }
        None => {
            // All in one place, or too deep: halves along the longest axis.
            let axis = (0..3)
                .max_by(|&a, &b| extent[a].total_cmp(&extent[b]))
                .unwrap_or(0);
            items.sort_by(|a, b| a.center[axis].total_cmp(&b.center[axis]));
            items.len() / 2
        }
    }
}

/// The bucket of a coordinate.
fn bucket(x: f64, min: f64, extent: f64) -> usize {
    let at = (x - min) / extent * BUCKETS as f64;
    (at as usize).min(BUCKETS - 1)
}

/// Lamps in an interval.
#[derive(Clone, Copy)]
struct Bucket {
    outline: LampOutline,
    n_lamps: f64,
}

impl Bucket {
    fn of(item: &Item) -> Self {
        Self {
            outline: item.outline,
            n_lamps: 1.0,
        }
    }

    fn and(&self, other: &Self) -> Self {
        Self {
            outline: self.outline.union(&other.outline),
            n_lamps: self.n_lamps + other.n_lamps,
        }
    }

    fn cost(&self) -> f64 {
        let size = self.outline.bounds.diagonal().length_squared();
        (self.outline.strength + self.n_lamps) * self.outline.orientation() * size
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::color::Rgb;
    use crate::light::Light;
    use crate::math::angle::Angle;
    use crate::math::{rng, warp};
    use glam::DVec2;
    use std::f64::consts::FRAC_PI_2;

    fn unit(keys: &[u64]) -> f64 {
        rng::unit_f64(rng::hash(keys))
    }

    fn place(key: u64, i: u64) -> DVec3 {
        DVec3::from_array([0, 1, 2].map(|k| unit(&[key, i, k]))) * 10.0
    }

    fn direction(key: u64, i: u64) -> DVec3 {
        warp::sphere(DVec2::new(unit(&[key, i, 3]), unit(&[key, i, 4])))
    }

    /// Points, spots and small squares that shine on one or both sides.
    fn lamps(n: u64) -> Vec<LampOutline> {
        let lamp = |i: u64| {
            let (at, axis) = (place(1, i), direction(1, i));
            let strength = Rgb::splat(unit(&[1, i, 5]).powi(4));
            match i % 4 {
                0 => LampOutline::of(&Light::point(at, strength)).unwrap(),
                1 => {
                    let (inner, outer) =
                        (Angle::deg(10.0), Angle::deg(20.0 + 100.0 * unit(&[1, i])));
                    LampOutline::of(&Light::spot(at, axis, inner, outer, strength)).unwrap()
                }
                k => LampOutline {
                    bounds: Bounds3::of([at, at + place(2, i) * 0.1]),
                    axis,
                    spread: 0.0,
                    emission: FRAC_PI_2,
                    is_two_sided: k == 2,
                    strength: strength.sum(),
                },
            }
        };
        (0..n).map(lamp).collect()
    }

    fn receivers() -> impl Iterator<Item = Receiver> {
        (0..40).map(|i| Receiver {
            position: place(3, i) * 1.5 - DVec3::splat(2.0),
            normal: (i % 3 > 0).then(|| direction(3, i)),
            is_two_sided: i % 3 == 2,
        })
    }

    #[test]
    fn probabilities_sum_to_one_or_what_surely_gives_nothing() {
        let lamps = lamps(300);
        let tree = LampTree::new(&lamps);
        for receiver in receivers() {
            let sum: f64 = (0..300).map(|k| tree.probability(&receiver, k)).sum();
            // Branches that turn out to give nothing take their share with them.
            assert!(sum <= 1.0 + 1e-9, "{sum}");
        }
        let points: Vec<LampOutline> = lamps.into_iter().step_by(4).collect();
        let tree = LampTree::new(&points);
        for receiver in receivers().filter(|receiver| receiver.normal.is_none()) {
            let sum: f64 = (0..75).map(|k| tree.probability(&receiver, k)).sum();
            assert!((sum - 1.0).abs() < 1e-9, "{sum}");
        }
    }

    #[test]
    fn lamps_are_chosen_as_often_as_stated() {
        let lamps = lamps(50);
        let tree = LampTree::new(&lamps);
        for receiver in receivers() {
            let n = 20_000_u32;
            let mut counts = [0_u32; 50];
            for i in 0..n {
                // Spread evenly: each count is exact but for a few.
                let u = (f64::from(i) + 0.5) / f64::from(n);
                if let Some(chosen) = tree.sample(&receiver, u) {
                    let stated = tree.probability(&receiver, chosen.index);
                    assert!((chosen.probability / stated - 1.0).abs() < 1e-12);
                    counts[chosen.index] += 1;
                }
            }
            for (index, count) in counts.into_iter().enumerate() {
                let expected = tree.probability(&receiver, index) * f64::from(n);
                assert!(
                    (f64::from(count) - expected).abs() < 4.0,
                    "{count} {expected}"
                );
            }
        }
    }

    /// What light a lamp could give, by brute force over its box, must be possible to choose.
    #[test]
    fn what_can_give_light_can_be_chosen() {
        let lamps = lamps(400);
        let tree = LampTree::new(&lamps);
        let (mut n_lit, mut n_dark) = (0, 0);
        for receiver in receivers() {
            for (index, lamp) in lamps.iter().enumerate() {
                let gives = lamp.bounds.corners().into_iter().any(|corner| {
                    let wi = (corner - receiver.position).normalize();
                    let leaving = -wi.dot(lamp.axis);
                    let leaving = if lamp.is_two_sided {
                        leaving.abs()
                    } else {
                        leaving
                    };
                    let cos = receiver.normal.map_or(1.0, |normal| normal.dot(wi));
                    leaving > lamp.emission.cos() && (cos > 0.0 || receiver.is_two_sided)
                });
                let can = tree.probability(&receiver, index) > 0.0;
                assert!(can || !gives, "lamp {index} from {receiver:?}");
                n_lit += usize::from(gives);
                n_dark += usize::from(!can);
            }
        }
        assert!(n_lit > 5000 && n_dark > 1500, "{n_lit} {n_dark}");
    }

    /// The variance of one sample of a thousand lamps over a floor, by the tree and by power alone, without any sampling: each
    /// is Σ f²/p - (Σ f)². `cargo test --lib lamps_by_what_they_give -- --nocapture` prints how many times less noise that is.
    #[test]
    #[allow(clippy::print_stdout, reason = "the figure is wanted")]
    fn lamps_by_what_they_give_are_less_noisy_than_by_power() {
        let lamps: Vec<Light> = (0..1000)
            .map(|i| {
                let at = place(1, i) * DVec3::new(10.0, 10.0, 0.3) + DVec3::Z * 0.5;
                Light::point(at, Rgb::splat(0.1 + unit(&[1, i, 5])))
            })
            .collect();
        let outlines: Vec<LampOutline> = lamps.iter().filter_map(LampOutline::of).collect();
        let total: f64 = outlines.iter().map(|lamp| lamp.strength).sum();
        let tree = LampTree::new(&outlines);
        let (mut by_tree, mut by_power) = (0.0, 0.0);
        for i in 0..100 {
            let receiver = Receiver {
                position: place(3, i) * DVec3::new(10.0, 10.0, 0.0),
                normal: Some(DVec3::Z),
                is_two_sided: false,
            };
            let gives = |k: usize| {
                let light = lamps[k].illuminate(receiver.position).unwrap();
                light.facing_irradiance.sum() * light.wi.z
            };
            let sum: f64 = (0..1000).map(gives).sum();
            let variance = |p: &dyn Fn(usize) -> f64| {
                let squares: f64 = (0..1000).map(|k| gives(k).powi(2) / p(k)).sum();
                squares / (sum * sum) - 1.0
            };
            by_tree += variance(&|k| tree.probability(&receiver, k)) / 100.0;
            by_power += variance(&|k| outlines[k].strength / total) / 100.0;
        }
        let ratio = by_power / by_tree;
        println!(
            "relative variance {by_tree:.3} by the tree, {by_power:.3} by power: {ratio:.1} times less"
        );
        assert!(ratio > 3.0, "{by_tree} {by_power}");
    }

    #[test]
    fn extremes_stay_choosable() {
        let point =
            |at: DVec3, power: f64| LampOutline::of(&Light::point(at, Rgb::splat(power))).unwrap();
        // Many in one place, one of no power, one 1e12 times as strong far away (C-45).
        let mut lamps = vec![point(DVec3::ZERO, 1.0); 100];
        lamps.push(point(DVec3::X, 0.0));
        lamps.push(point(DVec3::X * 50.0, 1e12));
        let tree = LampTree::new(&lamps);
        for position in [DVec3::ZERO, DVec3::Y * 1e-3, DVec3::Y, DVec3::splat(1e9)] {
            let receiver = Receiver {
                position,
                normal: None,
                is_two_sided: true,
            };
            let sum: f64 = (0..102).map(|k| tree.probability(&receiver, k)).sum();
            assert!((sum - 1.0).abs() < 1e-9, "{position}: {sum}");
            assert_eq!(tree.probability(&receiver, 100), 0.0);
            // Where lamps stand they give all there is to give; beside them the strong one gives most, and hides none.
            let weak: f64 = (0..100).map(|k| tree.probability(&receiver, k)).sum();
            if position.length() < 2.0 {
                assert!(weak > 0.2, "{position}: {weak}");
            }
            if position != DVec3::ZERO {
                assert!(tree.probability(&receiver, 101) > 1e-6);
            }
        }
        assert!(LampTree::new(&[]).is_empty());
        assert!(LampTree::new(&[point(DVec3::ZERO, 0.0)]).is_empty());
        // Positions that crowd towards one end make deep trees.
        let crowded: Vec<LampOutline> = (0..2000)
            .map(|i| point(DVec3::X * 2.0_f64.powi(-(i % 1000)), 1.0))
            .collect();
        let tree = LampTree::new(&crowded);
        let receiver = Receiver {
            position: DVec3::Y,
            normal: None,
            is_two_sided: true,
        };
        let sum: f64 = (0..2000).map(|k| tree.probability(&receiver, k)).sum();
        assert!((sum - 1.0).abs() < 1e-9, "{sum}");
    }
}
