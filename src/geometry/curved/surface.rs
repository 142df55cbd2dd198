//! Rational B-spline surfaces. Source: [`PieglTiller1997`](crate::references#piegltiller1997) §4.4, §8.5.

use super::basis::Basis;
use super::curve::{Curve, check_points, projected, turn_points};
use super::{CurvedError, Parametric};
use glam::{DVec2, DVec3, DVec4};

/// A rational B-spline surface.
#[derive(Clone, Debug, PartialEq)]
pub struct Surface {
    bases: [Basis; 2],
    /// Control points times their weight, and the weight; u runs first.
    points: Vec<DVec4>,
}

impl Surface {
    /// A surface over a grid of control points, u first, each times its weight and with the weight.
    ///
    /// # Errors
    /// If the points do not fill the grid, one is not finite, or a weight is not greater than 0.
    pub fn new(bases: [Basis; 2], points: Vec<DVec4>) -> Result<Self, CurvedError> {
        let (wanted, found) = (bases[0].len() * bases[1].len(), points.len());
        if wanted != found {
            let message = format!(
                "it has {found} points for a grid of {} by {}",
                bases[0].len(),
                bases[1].len()
            );
            return Err(CurvedError::Points(message));
        }
        check_points(&points)?;
        Ok(Self { bases, points })
    }

    /// A curve in the half plane of x ≥ 0 and z turned once round z; exact. u runs once round, v along the curve.
    ///
    /// # Errors
    /// If a control point is not finite.
    pub fn revolution(profile: &Curve) -> Result<Self, CurvedError> {
        let round = Basis::pieces(2, &[0.0, 0.25, 0.5, 0.75, 1.0])?;
        let turned = |p: &DVec4| {
            let p = *p;
            turn_points().map(move |((c, s), w)| {
                DVec4::new(p.x * c - p.y * s, p.x * s + p.y * c, p.z, p.w) * w
            })
        };
        let points = profile.control().iter().flat_map(turned).collect();
        Self::new([round, profile.basis().clone()], points)
    }

    /// A smooth skin over curves, one after the other; u runs along them, v from one to the next, one unit each.
    ///
    /// Between the curves run cubic Bézier pieces through their control points (Catmull–Rom), so that the skin contains every
    /// curve. Two curves make a ruled surface.
    ///
    /// # Errors
    /// If there are fewer than two curves, or they differ in degree, knots or number of points.
    pub fn skin(curves: &[Curve]) -> Result<Self, CurvedError> {
        let [first, _, ..] = curves else {
            return Err(CurvedError::Points(format!(
                "a skin needs two curves or more, not {}",
                curves.len()
            )));
        };
        if curves.iter().any(|curve| curve.basis() != first.basis()) {
            let message =
                "the curves of a skin must have the same degree, knots and number of points";
            return Err(CurvedError::Points(message.to_owned()));
        }
        let last = curves.len() - 1;
        let point = |row: usize, i: usize| curves[row].control()[i];
        let slope = |row: usize, i: usize| match row {
            _ if last == 1 => point(1, i) - point(0, i),
            0 => (point(1, i) - point(0, i)) * 2.0 - (point(2, i) - point(0, i)) / 2.0,
            _ if row == last => {
                (point(row, i) - point(row - 1, i)) * 2.0
                    - (point(row, i) - point(row - 2, i)) / 2.0
            }
            _ => (point(row + 1, i) - point(row - 1, i)) / 2.0,
        };
        let n = first.control().len();
        let mut rows: Vec<DVec4> = first.control().to_vec();
        for row in 0..last {
            rows.extend((0..n).map(|i| point(row, i) + slope(row, i) / 3.0));
            rows.extend((0..n).map(|i| point(row + 1, i) - slope(row + 1, i) / 3.0));
            rows.extend((0..n).map(|i| point(row + 1, i)));
        }
        let ends: Vec<f64> = (0..=last).map(|row| row as f64).collect();
        Self::new([first.basis().clone(), Basis::pieces(3, &ends)?], rows)
    }

    /// The point and its derivatives by u and v.
    #[must_use]
    pub fn at(&self, at: DVec2) -> (DVec3, [DVec3; 2]) {
        let (u, v) = (self.bases[0].at(at.x), self.bases[1].at(at.y));
        let width = self.bases[0].len();
        let (mut point, mut by_u, mut by_v) = (DVec4::ZERO, DVec4::ZERO, DVec4::ZERO);
        for (row, (value, slope)) in v.values().iter().zip(v.slopes()).enumerate() {
            let points = &self.points[(v.first + row) * width + u.first..];
            let sum = |weights: &[f64]| {
                weights
                    .iter()
                    .zip(points)
                    .map(|(w, p)| *p * *w)
                    .sum::<DVec4>()
            };
            let along = sum(u.values());
            point += along * *value;
            by_v += along * *slope;
            by_u += sum(u.slopes()) * *value;
        }
        let (at, by_u) = projected(point, by_u);
        (at, [by_u, projected(point, by_v).1])
    }
}

impl Parametric for Surface {
    fn breaks(&self) -> [Vec<f64>; 2] {
        self.bases.each_ref().map(Basis::breaks)
    }

    fn point(&self, at: DVec2) -> DVec3 {
        self.at(at).0
    }

    fn tangents(&self, at: DVec2) -> [DVec3; 2] {
        self.at(at).1
    }

    fn first_cuts(&self) -> [usize; 2] {
        // A polynomial of degree 1 is straight; of degree p it waves at most p - 1 times.
        self.bases.each_ref().map(Basis::degree)
    }
}

#[cfg(test)]
pub(super) mod tests {
    use super::*;
    use crate::geometry::curved::curve::plain;
    use std::f64::consts::FRAC_1_SQRT_2;

    /// A sphere round the origin, as a half circle turned round z.
    pub(in super::super) fn sphere(radius: f64) -> Surface {
        let arc = [(0.0, -1.0), (1.0, -1.0), (1.0, 0.0), (1.0, 1.0), (0.0, 1.0)];
        let corner = |(i, (x, z)): (usize, (f64, f64))| {
            let weight = if i % 2 == 1 { FRAC_1_SQRT_2 } else { 1.0 };
            DVec4::new(x * radius, 0.0, z * radius, 1.0) * weight
        };
        let points = arc.into_iter().enumerate().map(corner).collect();
        let profile = Curve::new(Basis::pieces(2, &[0.0, 0.5, 1.0]).unwrap(), points).unwrap();
        Surface::revolution(&profile).unwrap()
    }

    #[test]
    fn a_sphere_is_a_sphere() {
        let sphere = sphere(3.0);
        for i in 0..=40 {
            for j in 1..40 {
                let at = DVec2::new(f64::from(i) / 40.0, f64::from(j) / 40.0);
                let (point, [u, v]) = sphere.at(at);
                assert!((point.length() - 3.0).abs() < 1e-12, "{at} {point}");
                let normal = u.cross(v).normalize();
                assert!(
                    (normal - point / 3.0).length() < 1e-12,
                    "outside is the front"
                );
            }
        }
    }

    #[test]
    fn derivatives_are_those_of_the_point() {
        let bump = |i: i32, j: i32| {
            DVec4::new(f64::from(i), f64::from(j), f64::from(i * j % 3), 1.0)
                * (1.0 + 0.3 * f64::from((i + j) % 2))
        };
        let points = (0..6)
            .flat_map(|j| (0..5).map(move |i| bump(i, j)))
            .collect();
        let bases = [Basis::clamped(3, 5).unwrap(), Basis::clamped(2, 6).unwrap()];
        let surface = Surface::new(bases, points).unwrap();
        for k in 0..200 {
            let at = DVec2::new(f64::from(k * 37 % 101), f64::from(k * 53 % 97)) / 101.5 + 0.01;
            let h = 1e-6;
            let step =
                |by: DVec2| (surface.point(at + by * h) - surface.point(at - by * h)) / (2.0 * h);
            let [u, v] = surface.tangents(at);
            assert!(
                (step(DVec2::X) - u).length() < 1e-5 && (step(DVec2::Y) - v).length() < 1e-5,
                "{at}"
            );
        }
    }

    #[test]
    fn a_skin_contains_its_curves() {
        let ring = |k: i32| {
            let circle = Curve::circle(1.0 + 0.2 * f64::from(k % 3)).unwrap();
            let lifted = circle
                .control()
                .iter()
                .map(|p| *p + DVec4::Z * (f64::from(k) * p.w))
                .collect();
            Curve::new(circle.basis().clone(), lifted).unwrap()
        };
        for n in [2, 3, 6] {
            let curves: Vec<Curve> = (0..n).map(ring).collect();
            let skin = Surface::skin(&curves).unwrap();
            for (k, curve) in (0..).zip(&curves) {
                for u in [0.0, 0.1, 0.77, 1.0] {
                    let on = skin.point(DVec2::new(u, f64::from(k)));
                    assert!((on - curve.at(u).0).length() < 1e-12);
                }
            }
        }
        let line = Curve::through(&[DVec3::ZERO, DVec3::X]).unwrap();
        assert!(Surface::skin(&[ring(0), line]).is_err() && Surface::skin(&[ring(0)]).is_err());
        let bases = || [Basis::clamped(1, 2).unwrap(), Basis::clamped(1, 2).unwrap()];
        assert!(Surface::new(bases(), vec![plain(DVec3::ONE); 3]).is_err());
    }
}
