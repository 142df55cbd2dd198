//! Rational B-spline curves in space. Source: [`PieglTiller1997`](crate::references#piegltiller1997) §4 and §7.

use super::CurvedError;
use super::basis::Basis;
use glam::{DVec3, DVec4};
use std::f64::consts::{FRAC_1_SQRT_2, PI};

/// A rational B-spline curve.
#[derive(Clone, Debug, PartialEq)]
pub struct Curve {
    basis: Basis,
    /// Control points times their weight, and the weight.
    points: Vec<DVec4>,
}

/// A control point of weight 1.
#[must_use]
pub fn plain(point: DVec3) -> DVec4 {
    point.extend(1.0)
}

/// Checks control points: finite, weights greater than 0.
pub(super) fn check_points(points: &[DVec4]) -> Result<(), CurvedError> {
    if !points.iter().all(|point| point.is_finite()) {
        return Err(CurvedError::NotFinite);
    }
    if !points.iter().all(|point| point.w > 0.0) {
        return Err(CurvedError::Weight);
    }
    Ok(())
}

/// The point and its derivative, of a homogeneous point and its derivative.
pub(super) fn projected(point: DVec4, slope: DVec4) -> (DVec3, DVec3) {
    let at = point.truncate() / point.w;
    (at, (slope.truncate() - at * slope.w) / point.w)
}

impl Curve {
    /// A curve of control points, each times its weight and with the weight.
    ///
    /// # Errors
    /// If a point is not finite, a weight not greater than 0, or there are not as many points as functions.
    pub fn new(basis: Basis, points: Vec<DVec4>) -> Result<Self, CurvedError> {
        if points.len() != basis.len() {
            let (points, needed) = (points.len(), basis.len());
            let degree = basis.degree();
            return Err(CurvedError::TooFewPoints {
                points,
                needed,
                degree,
            });
        }
        check_points(&points)?;
        Ok(Self { basis, points })
    }

    /// A circle of this radius round the origin in the plane of x and y, once round from +x through +y; exact.
    ///
    /// # Errors
    /// If the radius is not finite.
    pub fn circle(radius: f64) -> Result<Self, CurvedError> {
        let corner = |i: usize| {
            let (x, y) = CIRCLE[i];
            let weight = if i % 2 == 1 { FRAC_1_SQRT_2 } else { 1.0 };
            DVec4::new(x * radius, y * radius, 0.0, 1.0) * weight
        };
        let basis = Basis::pieces(2, &[0.0, 0.25, 0.5, 0.75, 1.0])?;
        Self::new(basis, (0..9).map(corner).collect())
    }

    /// A regular polygon with its corners at this distance from the origin, in the plane of x and y, from +x through +y.
    ///
    /// # Errors
    /// If it has fewer than three sides or too many, or the distance is not finite.
    pub fn polygon(radius: f64, sides: usize) -> Result<Self, CurvedError> {
        if !(3..=1 << 12).contains(&sides) {
            return Err(CurvedError::Points(format!(
                "a polygon has 3 to 4096 sides, not {sides}"
            )));
        }
        let corner = |i: usize| {
            let angle = 2.0 * PI * (i % sides) as f64 / sides as f64;
            let (sin, cos) = (
                crate::math::functions::sin(angle),
                crate::math::functions::cos(angle),
            );
            plain(DVec3::new(cos, sin, 0.0) * radius)
        };
        Self::new(
            Basis::clamped(1, sides + 1)?,
            (0..=sides).map(corner).collect(),
        )
    }

    /// The smooth curve through these points; two make a line. If the last one is the first one, it closes smoothly.
    ///
    /// Cubic Bézier pieces with the tangents of a centripetal Catmull–Rom spline, which makes no loops or cusps of its own.
    /// Points that come twice in a row count once. Source: [Yuksel2011](crate::references#yuksel2011).
    ///
    /// # Errors
    /// If there are fewer than two different points, or one is not finite.
    pub fn through(points: &[DVec3]) -> Result<Self, CurvedError> {
        let mut points = points.to_vec();
        if !points.iter().all(|point| point.is_finite()) {
            return Err(CurvedError::NotFinite);
        }
        points.dedup();
        let n = points.len();
        if n < 2 {
            return Err(CurvedError::TooFewPoints {
                points: n,
                needed: 2,
                degree: 1,
            });
        }
        let steps: Vec<f64> = points
            .windows(2)
            .map(|p| (p[1] - p[0]).length().sqrt())
            .collect();
        let is_closed = n > 3 && points[0] == points[n - 1];
        let slopes: Vec<DVec3> = (0..n)
            .map(|i| slope(&points, &steps, i, is_closed))
            .collect();
        let mut ends = vec![0.0];
        let mut control = vec![plain(points[0])];
        for (i, step) in steps.iter().enumerate() {
            ends.push(ends[i] + step);
            let (from, to) = (points[i], points[i + 1]);
            control.push(plain(from + slopes[i] * (step / 3.0)));
            control.push(plain(to - slopes[i + 1] * (step / 3.0)));
            control.push(plain(to));
        }
        Self::new(Basis::pieces(3, &ends)?, control)
    }

    /// Its basis functions.
    #[must_use]
    pub fn basis(&self) -> &Basis {
        &self.basis
    }

    /// Its control points, each times its weight and with the weight.
    #[must_use]
    pub fn control(&self) -> &[DVec4] {
        &self.points
    }

    /// The point at `t` and its derivative.
    #[must_use]
    pub fn at(&self, t: f64) -> (DVec3, DVec3) {
        let w = self.basis.at(t);
        let points = &self.points[w.first..];
        let sum = |weights: &[f64]| weights.iter().zip(points).map(|(w, p)| *p * *w).sum();
        projected(sum(w.values()), sum(w.slopes()))
    }

    /// Whether it ends where it begins.
    #[must_use]
    pub fn is_closed(&self) -> bool {
        let [start, end] = self.basis.range();
        let size = self
            .points
            .iter()
            .map(|p| (p.truncate() / p.w).abs().max_element())
            .fold(0.0, f64::max);
        (self.at(start).0 - self.at(end).0).abs().max_element()
            <= size * crate::math::tolerance::SEAM
    }
}

/// The control points of a circle as nine corners of the square round it.
const CIRCLE: [(f64, f64); 9] = [
    (1.0, 0.0),
    (1.0, 1.0),
    (0.0, 1.0),
    (-1.0, 1.0),
    (-1.0, 0.0),
    (-1.0, -1.0),
    (0.0, -1.0),
    (1.0, -1.0),
    (1.0, 0.0),
];

/// The control points of a turn once round z, for a point (1, 0): places and weights.
pub(super) fn turn_points() -> impl Iterator<Item = ((f64, f64), f64)> {
    let weights = [1.0, FRAC_1_SQRT_2].into_iter().cycle();
    CIRCLE.into_iter().zip(weights)
}

/// The derivative of a curve through `points` at point `i`, by a parameter that grows by `steps`.
fn slope(points: &[DVec3], steps: &[f64], i: usize, is_closed: bool) -> DVec3 {
    let last = points.len() - 1;
    let rate = |piece: usize| (points[piece + 1] - points[piece]) / steps[piece];
    let between = |before: usize, after: usize| {
        let (a, b) = (steps[before], steps[after]);
        (rate(before) * b + rate(after) * a) / (a + b)
    };
    match i {
        _ if (i == 0 || i == last) && is_closed => between(last - 1, 0),
        // The parabola through the end and its neighbours: the line if there is but one.
        0 if last > 1 => rate(0) * 2.0 - between(0, 1),
        _ if i == last && last > 1 => rate(last - 1) * 2.0 - between(last - 2, last - 1),
        0 => rate(0),
        _ if i == last => rate(last - 1),
        _ => between(i - 1, i),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn circles_are_round() {
        let circle = Curve::circle(2.5).unwrap();
        for i in 0..=1000 {
            let (at, slope) = circle.at(f64::from(i) / 1000.0);
            assert!((at.length() - 2.5).abs() < 1e-14 && at.z == 0.0);
            assert!(at.dot(slope).abs() < 1e-12 && at.cross(slope).z > 0.0);
        }
        assert!(circle.is_closed());
        assert_eq!(circle.at(0.25).0.y, 2.5);
    }

    #[test]
    fn curves_go_through_their_points_without_corners() {
        let mut points: Vec<DVec3> = (0..9)
            .map(|i| DVec3::new(f64::from(i * i), f64::from(i % 3), f64::from(i % 2) * 0.1))
            .collect();
        for close in [false, true] {
            if close {
                points.push(points[0]);
            }
            let curve = Curve::through(&points).unwrap();
            for (t, point) in curve.basis().breaks().into_iter().zip(&points) {
                assert!((curve.at(t).0 - *point).length() < 1e-12);
                let h = 1e-9;
                let [before, after] = [curve.at(t - h).1, curve.at(t + h).1].map(DVec3::normalize);
                assert!(before.dot(after) > 1.0 - 1e-9, "{t}");
            }
            let [start, end] = curve.basis().range().map(|t| curve.at(t).1.normalize());
            assert_eq!(curve.is_closed(), close);
            assert!(!close || start.dot(end) > 1.0 - 1e-12);
        }
        let line = Curve::through(&[DVec3::ZERO, DVec3::ZERO, DVec3::X]).unwrap();
        assert!((line.at(0.5).0 - DVec3::X * 0.5).length() < 1e-15);
        assert!(Curve::through(&[DVec3::X; 3]).is_err());
        assert!(Curve::through(&[DVec3::X, DVec3::NAN]).is_err());
    }

    #[test]
    fn impossible_points_are_refused() {
        let basis = || Basis::clamped(1, 2).unwrap();
        assert!(Curve::new(basis(), vec![DVec4::ONE]).is_err());
        assert_eq!(
            Curve::new(basis(), vec![DVec4::ONE, DVec4::ZERO]),
            Err(CurvedError::Weight)
        );
        assert_eq!(
            Curve::new(basis(), vec![DVec4::ONE, DVec4::NAN]),
            Err(CurvedError::NotFinite)
        );
        assert!(Curve::polygon(1.0, 2).is_err() && Curve::circle(f64::INFINITY).is_err());
    }
}
