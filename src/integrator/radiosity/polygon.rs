//! Form factors between polygons that see each other whole, by integrals along their edges.
//!
//! A₁ F₁₂ = 1/(2π) |∮ ∮ ln r dx₁ · dx₂| ([`Sparrow1963`](crate::references#sparrow1963); Stokes' theorem twice). The inner integral along an edge
//! has a closed form; the outer one is done by a rule that does not mind edges that touch, where the logarithm is infinite
//! ([`TakahasiMori1974`](crate::references#takahasimori1974)).

use crate::math::functions::{atan, exp, ln};
use glam::DVec3;
use std::f64::consts::{FRAC_PI_2, PI};

/// Points of the rule for edges near each other, and for others, on each side of the middle; and how far apart in its variable.
const NEAR_RULE: (i32, f64) = (32, 0.1);
const FAR_RULE: (i32, f64) = (11, 0.25);

/// A rule for integrals over 0..=1: where, and with what weight.
#[derive(Clone, Debug)]
struct Rule(Vec<[f64; 2]>);

impl Rule {
    fn new((n, step): (i32, f64)) -> Self {
        let node = |k: i32| {
            let t = f64::from(k) * step;
            let (up, down) = (exp(t), exp(-t));
            let (sinh, cosh) = (0.5 * (up - down), 0.5 * (up + down));
            // 1 / (1 + exp(-2 u)) keeps its digits near 0, and the mirrored node near 1.
            let tail = exp(-2.0 * FRAC_PI_2 * sinh);
            let x = 1.0 / (1.0 + tail);
            let weight = step * 2.0 * FRAC_PI_2 * cosh * x * (1.0 - x);
            [x, weight]
        };
        let nodes: Vec<[f64; 2]> = (-n..=n).map(node).collect();
        let sum: f64 = nodes.iter().map(|[_, weight]| weight).sum();
        Self(nodes.iter().map(|[x, weight]| [*x, weight / sum]).collect())
    }
}

/// Integrals along edges.
#[derive(Clone, Debug)]
pub(super) struct Contours {
    near: Rule,
    far: Rule,
}

impl Contours {
    pub(super) fn new() -> Self {
        Self {
            near: Rule::new(NEAR_RULE),
            far: Rule::new(FAR_RULE),
        }
    }

    /// The form factor from a polygon of this area to another times that area, m²; each must lie wholly before the other.
    pub(super) fn exchange(&self, from: &[DVec3], to: &[DVec3]) -> f64 {
        let mut sum = 0.0;
        for (a, b) in edges(from) {
            for (c, d) in edges(to) {
                sum += self.edge_pair([a, b], [c, d]);
            }
        }
        (sum / (2.0 * PI)).abs()
    }

    /// ∫ ∫ ln r dx₁ · dx₂ along two edges.
    fn edge_pair(&self, [a, b]: [DVec3; 2], [c, d]: [DVec3; 2]) -> f64 {
        let (along, other) = (b - a, d - c);
        let dot = along.dot(other);
        let length = other.length();
        if dot.abs() <= f64::EPSILON * along.length() * length {
            return 0.0;
        }
        let direction = other / length;
        let apart = [(a, [c, d]), (b, [c, d]), (c, [a, b]), (d, [a, b])]
            .map(|(point, edge)| distance(point, edge));
        let is_far = apart.iter().all(|x| *x > along.length().max(length));
        let rule = if is_far { &self.far } else { &self.near };
        let inner = |x: f64| {
            let to = c - (a + along * x);
            let start = to.dot(direction);
            let off = (to - direction * start).length();
            primitive(start + length, off) - primitive(start, off)
        };
        let terms = rule.0.iter().map(|[x, weight]| weight * inner(*x));
        terms.sum::<f64>() * dot / length
    }
}

/// ∫ ln √(s² + h²) ds.
fn primitive(s: f64, h: f64) -> f64 {
    let square = s * s + h * h;
    if square == 0.0 {
        return 0.0;
    }
    let turned = if h > 0.0 { h * atan(s / h) } else { 0.0 };
    0.5 * s * ln(square) - s + turned
}

/// How far a point is from an edge.
fn distance(point: DVec3, [a, b]: [DVec3; 2]) -> f64 {
    let along = b - a;
    let share = (point - a).dot(along) / along.length_squared();
    (point - a - along * share.clamp(0.0, 1.0)).length()
}

fn edges(polygon: &[DVec3]) -> impl Iterator<Item = (DVec3, DVec3)> {
    let next = polygon.iter().cycle().skip(1);
    polygon.iter().copied().zip(next.copied())
}

#[cfg(test)]
mod tests {
    use super::*;

    fn rectangle(corner: DVec3, u: DVec3, v: DVec3) -> [DVec3; 4] {
        [corner, corner + u, corner + u + v, corner + v]
    }

    /// C-1, C-2 and the rectangles of the table, C-10: to 1e-9.
    #[test]
    fn rectangles_have_the_factors_of_the_table() {
        let contours = Contours::new();
        let opposite = |a: f64, b: f64, c: f64| {
            let one = rectangle(DVec3::ZERO, DVec3::X * a, DVec3::Y * b);
            let other = rectangle(DVec3::Z * c, DVec3::Y * b, DVec3::X * a);
            contours.exchange(&one, &other) / (a * b)
        };
        let upright = |w: f64, h: f64, l: f64| {
            let one = rectangle(DVec3::ZERO, DVec3::X * l, DVec3::Y * w);
            let other = rectangle(DVec3::ZERO, DVec3::Z * h, DVec3::X * l);
            contours.exchange(&one, &other) / (l * w)
        };
        let table = include_str!("../../validation/tables/configuration_factors.csv");
        let mut n_found = 0;
        for line in table.lines() {
            let part = |name: &str| -> f64 {
                let found = line
                    .split([' ', '"', ','])
                    .find_map(|word| word.strip_prefix(name));
                found.unwrap().parse().unwrap()
            };
            let expected = || -> f64 { line.rsplit(',').next().unwrap().parse().unwrap() };
            let found = if line.starts_with("\"C-11 ") {
                opposite(part("a="), part("b="), part("c="))
            } else if line.starts_with("\"C-14 ") {
                upright(part("w="), part("h="), part("l="))
            } else {
                continue;
            };
            n_found += 1;
            assert!((found / expected() - 1.0).abs() < 1e-9, "{line}: {found}");
        }
        assert_eq!(n_found, 17);
        let cube = opposite(1.0, 1.0, 1.0) + 4.0 * upright(1.0, 1.0, 1.0);
        assert!((cube - 1.0).abs() < 1e-9, "{cube}");
        for (gap, expected) in [(0.01, 0.980_416_603), (10.0, 0.003_162_057)] {
            assert!((opposite(1.0, 1.0, gap) - expected).abs() < 1e-9);
        }
    }

    #[test]
    fn the_way_back_exchanges_as_much() {
        let contours = Contours::new();
        let one = [DVec3::ZERO, DVec3::X, DVec3::Y * 2.0];
        let other = rectangle(
            DVec3::new(0.2, 0.1, 1.0),
            DVec3::Y * 0.7,
            DVec3::new(0.9, 0.0, 0.4),
        );
        let there = contours.exchange(&one, &other);
        let back = contours.exchange(&other, &one);
        assert!(
            (there / back - 1.0).abs() < 1e-8 && there > 0.01,
            "{there} {back}"
        );
    }
}
