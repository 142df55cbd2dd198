//! Triangles and parallelograms that share an edge leave no gap: a ray that passes the edge hits at least one of them.
//!
//! The corners are translated to the ray's start and sheared so that the ray becomes the z axis. What is left is a
//! two-dimensional question, whose edge functions are, bit for bit, each other's negatives for the two neighbours of an
//! edge. Nothing may be contracted to fused multiply-adds here (Rust never does so by itself).
//!
//! Source: [Woop2013](crate::references#woop2013).

use super::interval::{Interval, Line};
use glam::DVec3;

/// A line prepared for tests against flat shapes.
#[derive(Clone, Copy, Debug)]
pub struct Shear {
    /// Start of the line, in the order of `axes`.
    origin: [f64; 3],
    axes: [usize; 3],
    /// Shear of x and y per unit of z, and 1 / (z of the direction).
    shear: [f64; 3],
}

/// Where a line meets a flat shape.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct FlatHit {
    /// Parameter of the line.
    pub t: f64,
    /// Triangle: weight of the second corner. Parallelogram: fraction along the first edge.
    pub u: f64,
    /// Triangle: weight of the third corner. Parallelogram: fraction along the second edge.
    pub v: f64,
}

impl Shear {
    /// Prepares `line`; its direction must not be zero.
    #[inline(always)]
    #[must_use]
    pub fn new(line: &Line) -> Self {
        let d = line.direction.to_array();
        let [x, y, z] = [d[0].abs(), d[1].abs(), d[2].abs()];
        // Without branches: which axis it is differs from ray to ray.
        let is_first = (x > y) & (x > z);
        let is_second = (x <= y) & (y > z);
        let z = 2 - 2 * usize::from(is_first) - usize::from(is_second);
        let (x, y) = ([1, 2, 0][z], [2, 0, 1][z]);
        Self {
            origin: [line.origin[x], line.origin[y], line.origin[z]],
            axes: [x, y, z],
            shear: [d[x] / d[z], d[y] / d[z], 1.0 / d[z]],
        }
    }

    /// The start of the line and the axes x, y and z of the sheared frame in that order, then the shear of x and y per unit of z
    /// and 1 / (z of the direction).
    #[inline(always)]
    #[must_use]
    pub fn parts(&self) -> ([f64; 3], [usize; 3], [f64; 3]) {
        (self.origin, self.axes, self.shear)
    }

    /// A point in the frame where the line is the z axis; z is still in units of the coordinate.
    #[inline(always)]
    fn apply(&self, point: &[f64; 3]) -> [f64; 3] {
        let [x, y, z] = self.axes;
        let depth = point[z] - self.origin[2];
        [
            (point[x] - self.origin[0]) - self.shear[0] * depth,
            (point[y] - self.origin[1]) - self.shear[1] * depth,
            depth,
        ]
    }
}

/// Which side of the edge from `a` to `b` the z axis passes; its sign flips exactly when the ends are exchanged.
#[inline(always)]
fn edge(a: [f64; 3], b: [f64; 3]) -> f64 {
    a[0] * b[1] - a[1] * b[0]
}

/// Whether no two of `values` have opposite signs; zero agrees with both.
#[inline(always)]
fn agree<const N: usize>(values: [f64; N]) -> bool {
    let (mut up, mut down) = (true, true);
    // All of them, without branches: which differs is not foreseeable.
    for value in values {
        up &= value >= 0.0;
        down &= value <= 0.0;
    }
    up | down
}

/// Where the line meets the triangle, edges and corners included. A triangle seen exactly from its edge is not met.
#[inline(always)]
#[must_use]
pub fn intersect_triangle(
    shear: &Shear,
    corners: [&[f64; 3]; 3],
    interval: Interval,
) -> Option<FlatHit> {
    // Not by `map`, which costs a call for each corner in the inner loop of everything.
    let [a, b, c] = corners;
    let (a, b, c) = (shear.apply(a), shear.apply(b), shear.apply(c));

    // The weight of each corner is the edge function of the opposite edge.
    let weights = [edge(b, c), edge(c, a), edge(a, b)];
    if !agree(weights) {
        return None;
    }
    let sum = weights[0] + weights[1] + weights[2];
    if sum == 0.0 {
        return None;
    }

    let depth = (weights[0] * a[2] + weights[1] * b[2] + weights[2] * c[2]) / sum;
    let t = depth * shear.shear[2];
    interval.contains(t).then(|| FlatHit {
        t,
        u: weights[1] / sum,
        v: weights[2] / sum,
    })
}

/// Where the line meets the parallelogram `corner + u·edges[0] + v·edges[1]`, its border included.
#[inline(always)]
#[must_use]
pub fn intersect_parallelogram(
    shear: &Shear,
    corner: DVec3,
    edges: [DVec3; 2],
    interval: Interval,
) -> Option<FlatHit> {
    let a = shear.apply(corner.as_ref());
    let b = shear.apply((corner + edges[0]).as_ref());
    let c = shear.apply((corner + edges[0] + edges[1]).as_ref());
    let d = shear.apply((corner + edges[1]).as_ref());

    // Opposite edge functions add up to the area, so each pair gives one coordinate.
    let around = [edge(a, b), edge(b, c), edge(c, d), edge(d, a)];
    if !agree(around) {
        return None;
    }
    let (across_v, across_u) = (around[0] + around[2], around[1] + around[3]);
    if across_v == 0.0 || across_u == 0.0 {
        return None;
    }

    let (u, v) = (around[3] / across_u, around[0] / across_v);
    let t = (a[2] + u * (b[2] - a[2]) + v * (d[2] - a[2])) * shear.shear[2];
    interval.contains(t).then_some(FlatHit { t, u, v })
}

#[cfg(test)]
mod tests {
    use super::*;

    fn triangle(shear: &Shear, corners: [DVec3; 3], interval: Interval) -> Option<FlatHit> {
        intersect_triangle(
            shear,
            corners.each_ref().map(|corner| corner.as_ref()),
            interval,
        )
    }

    const ALL: Interval = Interval {
        after: 0.0,
        until: f64::INFINITY,
    };

    fn line(origin: [f64; 3], direction: [f64; 3]) -> Line {
        Line {
            origin: DVec3::from_array(origin),
            direction: DVec3::from_array(direction),
        }
    }

    #[test]
    fn weights_rebuild_the_point() {
        let corners = [
            DVec3::new(1.0, 0.0, 5.0),
            DVec3::new(3.0, 0.5, 4.0),
            DVec3::new(1.5, 2.0, 6.0),
        ];
        let target = corners[0] * 0.2 + corners[1] * 0.3 + corners[2] * 0.5;
        for origin in [
            DVec3::ZERO,
            DVec3::new(-9.0, 3.0, 1.0),
            DVec3::new(2.0, 1.0, 50.0),
        ] {
            let line = Line {
                origin,
                direction: (target - origin) / 4.0,
            };
            let hit = triangle(&Shear::new(&line), corners, ALL).unwrap();
            assert!((hit.t - 4.0).abs() < 1e-12 && (hit.u - 0.3).abs() < 1e-12);
            assert!((hit.v - 0.5).abs() < 1e-12, "{hit:?}");
        }
    }

    #[test]
    fn corners_edges_and_signed_zeros_count_as_inside() {
        let corners = [DVec3::ZERO, DVec3::X, DVec3::Y];
        let quad = (DVec3::ZERO, [DVec3::X, DVec3::Y]);
        for zero in [0.0, -0.0] {
            for down in [-1.0, 1.0] {
                for at in [[0.0, 0.0], [1.0, 0.0], [0.0, 1.0], [0.5, 0.5], [0.5, 0.0]] {
                    let line = line([at[0], at[1], -down], [zero, -zero, down]);
                    let shear = Shear::new(&line);
                    assert!(triangle(&shear, corners, ALL).is_some(), "{line:?}");
                    let hit = intersect_parallelogram(&shear, quad.0, quad.1, ALL).unwrap();
                    assert_eq!((hit.t, hit.u, hit.v), (1.0, at[0], at[1]));
                }
            }
        }
        let beside = line([0.6, 0.6, 1.0], [0.0, 0.0, -1.0]);
        assert!(triangle(&Shear::new(&beside), corners, ALL).is_none());
    }

    #[test]
    fn degenerate_triangles_and_edge_on_views_are_not_met() {
        let down = Shear::new(&line([0.5, 0.0, 1.0], [0.0, 0.0, -1.0]));
        let along = Shear::new(&line([-1.0, 0.2, 0.0], [1.0, 0.0, 0.0]));
        assert_eq!(
            triangle(&down, [DVec3::ZERO, DVec3::X, DVec3::X * 2.0], ALL),
            None
        );
        assert_eq!(triangle(&down, [DVec3::X; 3], ALL), None);
        assert_eq!(
            triangle(&along, [DVec3::ZERO, DVec3::X, DVec3::Y], ALL),
            None
        );
        assert_eq!(
            intersect_parallelogram(&along, DVec3::ZERO, [DVec3::X, DVec3::Y], ALL),
            None
        );
    }

    #[test]
    fn the_interval_is_open_below_and_closed_above() {
        let corners = [DVec3::NEG_ONE, DVec3::X * 4.0, DVec3::Y * 4.0];
        let shear = Shear::new(&line([0.0, 0.0, 5.0], [0.0, 0.0, -1.0]));
        let t = triangle(&shear, corners, ALL).unwrap().t;
        let test = |after, until| triangle(&shear, corners, Interval { after, until });
        assert!(test(t, f64::INFINITY).is_none() && test(0.0, t).is_some());
        assert!(test(0.0, t * 0.999).is_none());
    }
}
