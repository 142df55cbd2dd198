//! How the error of a method falls with the work: y(x) = b² + c x^-p.
//!
//! b² is what no work removes (bias), p is known from theory for most methods, c is the price. All three are found in logarithms, so
//! that the smallest errors count as much as the largest, by trying p and b² on a grid that is refined around the best; for each of
//! them c is found in closed form of the residuals' mean.

use crate::math::functions::{exp, ln, pow};
use crate::math::tolerance::{FIT_FLOORS, FIT_STEP};

/// Powers that are considered.
const POWERS: [f64; 2] = [0.02, 4.0];
/// Points of each grid along each axis, and how often the grid is refined.
const GRID: usize = 41;
const REFINEMENTS: usize = 5;
/// Steps of the search for c.
const STEPS: usize = 30;

/// Whether a method has an error that no work removes.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Floor {
    /// It has none: b = 0.
    None,
    /// It may have one.
    Some,
}

/// A fitted curve.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Fit {
    /// What remains: b².
    pub floor: f64,
    /// The price: c.
    pub price: f64,
    /// How fast the rest falls: p.
    pub power: f64,
    /// p lies between these with a probability of 95 %, if residuals in logarithms are normal.
    pub interval: [f64; 2],
}

impl Fit {
    /// The error after so much work.
    #[must_use]
    pub fn at(&self, x: f64) -> f64 {
        self.floor + self.price * pow(x, -self.power)
    }

    /// The work after which the error is `y`; `None` if it never is.
    #[must_use]
    pub fn work_to(&self, y: f64) -> Option<f64> {
        let rest = y - self.floor;
        (rest > 0.0).then(|| pow(self.price / rest, 1.0 / self.power))
    }
}

/// Fits points (x, y), both positive; others are left out. `None` if fewer points than unknowns and one more are left.
#[must_use]
pub fn fit(points: &[(f64, f64)], floor: Floor) -> Option<Fit> {
    let is_usable = |v: f64| v.is_finite() && v > 0.0;
    let usable = points
        .iter()
        .filter(|(x, y)| is_usable(*x) && is_usable(*y));
    let points: Vec<(f64, f64)> = usable.map(|(x, y)| (ln(*x), *y)).collect();
    let unknowns = if floor == Floor::None { 2 } else { 3 };
    let least = points.iter().map(|(_, y)| *y).fold(f64::INFINITY, f64::min);
    if points.len() <= unknowns {
        return None;
    }
    let best = Search {
        points: &points,
        floor,
        least,
    }
    .best();
    // Where the sum of squares is not larger than chance makes it, all other unknowns being what suits best.
    let degrees = (points.len() - unknowns) as u32;
    let most = best.residual * (1.0 + t_quantile(degrees).powi(2) / f64::from(degrees));
    let profile = |power: f64| {
        let search = Search {
            points: &points,
            floor,
            least,
        };
        search.best_with_power(power).residual
    };
    let bound = |end: f64| {
        bisect(best.power, end, |power| {
            profile(power) <= most + f64::MIN_POSITIVE
        })
    };
    Some(Fit {
        floor: best.floor,
        price: best.price,
        power: best.power,
        interval: [bound(POWERS[0]), bound(POWERS[1])],
    })
}

/// The 97.5 % quantile of Student's t with so many degrees of freedom: 95 % lie between its negative and it.
#[must_use]
pub fn t_quantile(degrees: u32) -> f64 {
    const TABLE: [f64; 10] = [
        12.706, 4.303, 3.182, 2.776, 2.571, 2.447, 2.365, 2.306, 2.262, 2.228,
    ];
    let n = f64::from(degrees.max(1));
    match TABLE.get(degrees.max(1) as usize - 1) {
        Some(t) => *t,
        // Cornish-Fisher to the second order: right to 0.003 beyond ten.
        None => {
            let z: f64 = 1.959_964;
            z + (z.powi(3) + z) / (4.0 * n)
                + (5.0 * z.powi(5) + 16.0 * z.powi(3) + 3.0 * z) / (96.0 * n * n)
        }
    }
}

/// The farthest point from `inside` towards `end` for which `holds`, if it holds in between as well.
fn bisect(inside: f64, end: f64, holds: impl Fn(f64) -> bool) -> f64 {
    if holds(end) {
        return end;
    }
    let (mut inside, mut outside) = (inside, end);
    for _ in 0..40 {
        let middle = 0.5 * (inside + outside);
        if holds(middle) {
            inside = middle;
        } else {
            outside = middle;
        }
    }
    inside
}

/// One choice of the unknowns.
#[derive(Clone, Copy, Debug)]
struct Candidate {
    floor: f64,
    price: f64,
    power: f64,
    /// Sum of squared differences of logarithms.
    residual: f64,
}

struct Search<'a> {
    /// Logarithm of x, and y.
    points: &'a [(f64, f64)],
    floor: Floor,
    /// The smallest y.
    least: f64,
}

impl Search<'_> {
    fn best(&self) -> Candidate {
        minimum(POWERS, |power| self.best_with_power(power))
    }

    fn best_with_power(&self, power: f64) -> Candidate {
        let none = self.candidate(power, 0.0);
        if self.floor == Floor::None {
            return none;
        }
        // Floors below a thousandth of the least error are as good as none; at the least error itself nothing could still fall.
        let with = minimum([ln(FIT_FLOORS[0]), ln(FIT_FLOORS[1])], |part| {
            self.candidate(power, self.least * exp(part))
        });
        if with.residual < none.residual {
            with
        } else {
            none
        }
    }

    /// With the best c: Gauss-Newton on its logarithm.
    fn candidate(&self, power: f64, floor: f64) -> Candidate {
        let n = self.points.len() as f64;
        let rest = |y: f64| ln((y - floor).max(FIT_FLOORS[0] * y));
        let start = self.points.iter().map(|(x, y)| rest(*y) + power * x);
        let mut log_price = start.sum::<f64>() / n;
        let mut residual = f64::INFINITY;
        for _ in 0..STEPS {
            let (mut slope, mut curvature, mut sum) = (0.0, 0.0, 0.0);
            for (x, y) in self.points {
                let falling = exp(log_price - power * x);
                let difference = ln(*y) - ln(floor + falling);
                let part = falling / (floor + falling);
                slope += part * difference;
                curvature += part * part;
                sum += difference * difference;
            }
            residual = sum;
            let step = slope / curvature.max(FIT_STEP);
            if !step.is_finite() || step.abs() < FIT_STEP {
                break;
            }
            log_price += step.clamp(-2.0, 2.0);
        }
        Candidate {
            floor,
            price: exp(log_price),
            power,
            residual,
        }
    }
}

/// The best of a function on an interval: a grid, refined around its best point.
fn minimum([mut from, mut to]: [f64; 2], value: impl Fn(f64) -> Candidate) -> Candidate {
    let mut best: Option<(f64, Candidate)> = None;
    for _ in 0..REFINEMENTS {
        let step = (to - from) / (GRID - 1) as f64;
        for i in 0..GRID {
            let at = from + step * i as f64;
            let found = value(at);
            if best.is_none_or(|(_, best)| found.residual < best.residual) {
                best = Some((at, found));
            }
        }
        let middle = best.map_or(from, |(at, _)| at);
        (from, to) = ((middle - step).max(from), (middle + step).min(to));
    }
    best.expect("invariant: a grid has points").1
}

#[cfg(test)]
mod tests {
    use super::*;

    fn curve(floor: f64, power: f64, wobble: f64) -> Vec<(f64, f64)> {
        (0..8)
            .map(|i| {
                let x = 4.0_f64.powi(i);
                let off = 1.0 + wobble * if i % 2 == 0 { 1.0 } else { -1.0 };
                (x, off * (floor + 0.3 * x.powf(-power)))
            })
            .collect()
    }

    #[test]
    fn known_curves_are_found() {
        for (floor, power) in [(0.0, 1.0), (0.0, 2.0 / 3.0), (1e-3, 1.0), (0.01, 1.5)] {
            let kind = if floor > 0.0 {
                Floor::Some
            } else {
                Floor::None
            };
            let found = fit(&curve(floor, power, 0.0), kind).unwrap();
            assert!((found.power - power).abs() < 0.01, "{found:?}");
            assert!((found.floor - floor).abs() <= 0.01 * floor, "{found:?}");
            assert!((found.at(4.0) / (floor + 0.3 * 4.0_f64.powf(-power)) - 1.0).abs() < 0.01);
            let x = found.work_to(2.0 * floor + 0.02).unwrap();
            assert!((found.at(x) / (2.0 * floor + 0.02) - 1.0).abs() < 1e-9);
        }
    }

    #[test]
    fn intervals_hold_the_truth_and_widen_with_the_scatter() {
        let [calm, wild] = [0.02, 0.2].map(|wobble| {
            let found = fit(&curve(0.0, 1.0, wobble), Floor::None).unwrap();
            assert!(
                found.interval[0] <= 1.0 && found.interval[1] >= 1.0,
                "{found:?}"
            );
            found.interval[1] - found.interval[0]
        });
        assert!(wild > 5.0 * calm, "{calm} {wild}");
        // A power of 2/3 is not taken for 1.
        let found = fit(&curve(0.0, 2.0 / 3.0, 0.05), Floor::None).unwrap();
        assert!(found.interval[1] < 0.9, "{found:?}");
    }

    #[test]
    fn floors_are_never_reached_and_few_points_fit_nothing() {
        let found = fit(&curve(0.01, 1.0, 0.0), Floor::Some).unwrap();
        assert_eq!(found.work_to(0.005), None);
        assert_eq!(fit(&curve(0.0, 1.0, 0.0)[..2], Floor::None), None);
        assert_eq!(
            fit(&[(1.0, 0.0), (2.0, f64::NAN), (-1.0, 3.0)], Floor::None),
            None
        );
    }

    #[test]
    fn quantiles_of_student_are_those_of_the_tables() {
        for (degrees, t) in [
            (1, 12.706),
            (4, 2.776),
            (11, 2.201),
            (30, 2.042),
            (1000, 1.962),
        ] {
            assert!((t_quantile(degrees) - t).abs() < 0.003, "{degrees}");
        }
    }
}
