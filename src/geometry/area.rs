//! Areas of placed round shapes, and points chosen on them.

use super::unit::{UnitFrustum, UnitShape};
use crate::math::Bounds3;
use crate::math::functions::sin_cos;
use glam::{DAffine3, DMat3, DVec3};
use std::f64::consts::PI;

/// Nodes of the quadrature over an angle and over a height.
const NODES: [usize; 2] = [256, 64];

/// The surface of a sphere, disk or frustum somewhere in the world.
///
/// Points are chosen uniformly on the shape before it was placed. An affine map then changes areas by a factor that depends
/// only on the normal, so the density after it is known exactly, and constant if the map keeps angles.
#[derive(Clone, Debug)]
pub struct RoundArea {
    form: Metric,
    /// From the shape with its true proportions to the world.
    to_world: DAffine3,
    normal_map: DMat3,
    determinant: f64,
    /// Area before placing.
    own_area: f64,
    area: f64,
}

/// A shape in a frame in which its proportions are those it was described with, its larger radius 1.
#[derive(Clone, Copy, Debug)]
enum Metric {
    Sphere,
    Disk,
    Frustum(UnitFrustum),
}

impl RoundArea {
    /// The surface of `form` under the map `to_world` of the unit shape; `None` for a cube, which is not round, or if the
    /// map has no inverse.
    #[must_use]
    pub fn new(form: UnitShape, to_world: &DAffine3) -> Option<Self> {
        let (form, proportions) = match form {
            UnitShape::Sphere => (Metric::Sphere, 1.0),
            UnitShape::Disk => (Metric::Disk, 1.0),
            UnitShape::Frustum(frustum) => (Metric::Frustum(frustum), frustum.aspect),
            UnitShape::Cube => return None,
        };
        let to_world = *to_world * DAffine3::from_scale(DVec3::new(1.0, 1.0, 1.0 / proportions));
        let inverse = to_world.matrix3.inverse();
        if !inverse.is_finite() {
            return None;
        }
        let mut round = Self {
            form,
            to_world,
            normal_map: inverse.transpose(),
            determinant: to_world.matrix3.determinant().abs(),
            own_area: form.area(),
            area: 0.0,
        };
        round.area = round.measure();
        Some(round)
    }

    /// Its area in the world, in square metres; for an unevenly stretched one by quadrature, to about 1e-9.
    #[must_use]
    pub fn area(&self) -> f64 {
        self.area
    }

    /// A box that holds it.
    #[must_use]
    pub fn bounds(&self) -> Bounds3 {
        let (low, high) = match self.form {
            Metric::Sphere => (DVec3::NEG_ONE, DVec3::ONE),
            Metric::Disk => (DVec3::new(-1.0, -1.0, 0.0), DVec3::new(1.0, 1.0, 0.0)),
            Metric::Frustum(frustum) => (
                DVec3::new(-1.0, -1.0, 0.0),
                DVec3::new(1.0, 1.0, frustum.aspect),
            ),
        };
        let own = Bounds3 {
            min: low,
            max: high,
        };
        own.transformed(&self.to_world)
    }

    /// The unit normal of the front, if it is the same everywhere.
    #[must_use]
    pub fn flat_normal(&self) -> Option<DVec3> {
        let is_flat = matches!(self.form, Metric::Disk);
        is_flat.then(|| (self.normal_map * DVec3::Z).normalize())
    }

    /// A point and the unit normal of the front there; `u` are uniform random numbers in [0, 1).
    #[must_use]
    pub fn sample(&self, u: [f64; 2]) -> (DVec3, DVec3) {
        let (point, normal) = self.form.sample(u, self.own_area);
        (
            self.to_world.transform_point3(point),
            (self.normal_map * normal).normalize(),
        )
    }

    /// The density of [`RoundArea::sample`] where the front has this unit normal, per square metre.
    #[must_use]
    pub fn pdf_area(&self, normal: DVec3) -> f64 {
        // With A the map, a world normal m came from a normal along Aᵀm, and areas grew by |det A| / |Aᵀm|.
        let shrink = (self.to_world.matrix3.transpose() * normal).length() / self.determinant;
        shrink / self.own_area
    }

    /// How much larger areas with this unit normal become in the world.
    fn growth(&self, normal: DVec3) -> f64 {
        self.determinant * (self.normal_map * normal).length()
    }

    /// The area in the world: the growth, averaged over the shape.
    fn measure(&self) -> f64 {
        let turn = |k: usize| sin_cos(2.0 * PI * (k as f64 + 0.5) / NODES[0] as f64);
        let over_turn = |height: f64, radius: f64| {
            let growths = (0..NODES[0]).map(turn);
            let growths = growths
                .map(|(sin, cos)| self.growth(DVec3::new(radius * cos, radius * sin, height)));
            growths.sum::<f64>() / NODES[0] as f64
        };
        match self.form {
            Metric::Disk => PI * self.growth(DVec3::Z),
            Metric::Sphere => {
                // Area is proportional to height, and the growth is smooth in it.
                let average = gauss_legendre(NODES[1], |z| over_turn(z, (1.0 - z * z).sqrt()));
                4.0 * PI * average
            }
            Metric::Frustum(frustum) => {
                let (slope, slant) = slope_and_slant(&frustum);
                let side = side_area(&frustum) * over_turn(-slope / slant, 1.0 / slant);
                let caps = self.growth(DVec3::Z) * (cap_area(&frustum, 0) + cap_area(&frustum, 1));
                side + caps
            }
        }
    }
}

impl Metric {
    fn area(&self) -> f64 {
        match self {
            Self::Sphere => 4.0 * PI,
            Self::Disk => PI,
            Self::Frustum(frustum) => {
                side_area(frustum) + cap_area(frustum, 0) + cap_area(frustum, 1)
            }
        }
    }

    /// A point, uniform by area, and its unit normal.
    fn sample(&self, u: [f64; 2], area: f64) -> (DVec3, DVec3) {
        let (sin, cos) = sin_cos(2.0 * PI * u[1]);
        match self {
            Self::Sphere => {
                let z = 1.0 - 2.0 * u[0];
                let radius = (1.0 - z * z).max(0.0).sqrt();
                let point = DVec3::new(radius * cos, radius * sin, z);
                (point, point)
            }
            Self::Disk => {
                let radius = u[0].sqrt();
                (DVec3::new(radius * cos, radius * sin, 0.0), DVec3::Z)
            }
            Self::Frustum(frustum) => sample_frustum(frustum, u[0] * area, [sin, cos]),
        }
    }
}

/// Chooses side or cap by the area counted off, and the place on it by what is left.
fn sample_frustum(frustum: &UnitFrustum, mut area: f64, [sin, cos]: [f64; 2]) -> (DVec3, DVec3) {
    for (end, sign) in [(0, -1.0), (1, 1.0)] {
        let cap = cap_area(frustum, end);
        if area < cap {
            let radius = [frustum.base, frustum.top][end] * (area / cap).sqrt();
            let height = end as f64 * frustum.aspect;
            return (
                DVec3::new(radius * cos, radius * sin, height),
                DVec3::Z * sign,
            );
        }
        area -= cap;
    }
    // The area below a height is quadratic in it; its stable root.
    let fraction = (area / side_area(frustum)).min(1.0);
    let (r0, r1) = (frustum.base, frustum.top);
    let square = r0 * r0 + fraction * (r1 * r1 - r0 * r0);
    let height = fraction * (r0 + r1) / (r0 + square.sqrt());
    let height = if height.is_finite() {
        height.min(1.0)
    } else {
        0.0
    };
    let radius = r0 + (r1 - r0) * height;
    let (slope, slant) = slope_and_slant(frustum);
    let normal = DVec3::new(cos, sin, -slope) / slant;
    (
        DVec3::new(radius * cos, radius * sin, height * frustum.aspect),
        normal,
    )
}

/// Growth of the radius per height, and the length of the slant per height.
fn slope_and_slant(frustum: &UnitFrustum) -> (f64, f64) {
    let slope = (frustum.top - frustum.base) / frustum.aspect;
    (slope, (1.0 + slope * slope).sqrt())
}

fn side_area(frustum: &UnitFrustum) -> f64 {
    let (_, slant) = slope_and_slant(frustum);
    PI * (frustum.base + frustum.top) * slant * frustum.aspect
}

fn cap_area(frustum: &UnitFrustum, end: usize) -> f64 {
    let radius = [frustum.base, frustum.top][end];
    if frustum.caps[end] {
        PI * radius * radius
    } else {
        0.0
    }
}

/// The average of a smooth function over -1..=1, by Gauss-Legendre quadrature.
fn gauss_legendre(n: usize, function: impl Fn(f64) -> f64) -> f64 {
    let mut sum = 0.0;
    for k in 0..n {
        // Newton's method from Chebyshev's estimate of the root; the recurrence gives value and derivative.
        let mut x = sin_cos(PI * (k as f64 + 0.75) / (n as f64 + 0.5)).1;
        let mut derivative = 1.0;
        for _ in 0..6 {
            let (mut previous, mut value) = (1.0, x);
            for degree in 2..=n {
                let degree = degree as f64;
                let next = ((2.0 * degree - 1.0) * x * value - (degree - 1.0) * previous) / degree;
                (previous, value) = (value, next);
            }
            derivative = n as f64 * (x * value - previous) / (x * x - 1.0);
            x -= value / derivative;
        }
        sum += function(x) / ((1.0 - x * x) * derivative * derivative);
    }
    sum
}

#[cfg(test)]
mod tests {
    use super::*;

    fn rel(a: f64, b: f64) -> f64 {
        (a / b - 1.0).abs()
    }

    fn frustum(base: f64, top: f64, aspect: f64) -> UnitShape {
        UnitShape::Frustum(UnitFrustum {
            base,
            top,
            caps: [true, false],
            aspect,
        })
    }

    #[test]
    fn areas_agree_with_closed_forms() {
        let scaled = |x, y, z| DAffine3::from_scale(DVec3::new(x, y, z));
        let area = |form, map: DAffine3| RoundArea::new(form, &map).unwrap().area();
        assert!(rel(area(UnitShape::Sphere, scaled(3.0, -3.0, 3.0)), 36.0 * PI) < 1e-12);
        assert!(rel(area(UnitShape::Disk, scaled(2.0, 5.0, 1.0)), 10.0 * PI) < 1e-14);
        // Prolate spheroid with half axes 1, 1, 2: 2π(1 + (2/e)·asin e), e = √3/2.
        let e = 0.75_f64.sqrt();
        let prolate = 2.0 * PI * (1.0 + 2.0 / e * e.asin());
        for map in [scaled(1.0, 1.0, 2.0), scaled(2.0, 1.0, 1.0)] {
            assert!(rel(area(UnitShape::Sphere, map), prolate) < 1e-9);
        }
        // A cone of radius 3 and height 4 has slant 5.
        let cone = area(frustum(1.0, 0.0, 4.0 / 3.0), scaled(3.0, 3.0, 4.0));
        assert!(rel(cone, PI * 15.0 + PI * 9.0) < 1e-12);
    }

    #[test]
    fn densities_are_those_of_the_points() {
        // The average of 1/pdf over samples is the area, whatever the density.
        let maps = [
            DAffine3::from_scale(DVec3::new(1.0, 2.0, 0.5)),
            DAffine3::from_scale(DVec3::new(-3.0, 3.0, 3.0)),
        ];
        let forms = [
            UnitShape::Sphere,
            UnitShape::Disk,
            frustum(0.5, 1.0, 2.0),
            frustum(1.0, 0.0, 0.1),
        ];
        for map in maps {
            for form in forms {
                let round = RoundArea::new(form, &map).unwrap();
                let (n, mut sum) = ([4096, 16], 0.0);
                for i in 0..n[0] * n[1] {
                    let u = [i / n[1], i % n[1]].map(|k| f64::from(k) + 0.5);
                    let u = [u[0] / f64::from(n[0]), u[1] / f64::from(n[1])];
                    let (point, normal) = round.sample(u);
                    assert!((normal.length() - 1.0).abs() < 1e-14 && point.is_finite());
                    sum += 1.0 / round.pdf_area(normal);
                }
                let found = sum / f64::from(n[0] * n[1]);
                assert!(
                    rel(found, round.area()) < 5e-4,
                    "{form:?}: {found} {}",
                    round.area()
                );
            }
        }
    }

    #[test]
    fn points_lie_on_the_surface() {
        for (base, top) in [(1.0, 0.3), (0.0, 1.0), (1.0, 1.0)] {
            let map = DAffine3::from_scale(DVec3::new(1.0, 1.0, 2.0));
            let round = RoundArea::new(frustum(base, top, 2.0), &map).unwrap();
            for i in 0..100 {
                let (point, _) = round.sample([f64::from(i) / 100.0, 0.3]);
                let radius = base + (top - base) * point.z / 2.0;
                let distance = point.truncate().length();
                let on_cap = point.z == 0.0 && distance <= base;
                assert!(on_cap || (distance - radius).abs() < 1e-14, "{point}");
            }
        }
    }
}
