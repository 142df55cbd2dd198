//! A plot that repeats itself without end along x and y: a photon that leaves it on one side comes in on the other.

use crate::math::{Bounds3, Ray};
use glam::{DVec2, DVec3};

/// A plot, and how high what stands in it reaches.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Plot {
    bounds: Bounds3,
    size: DVec2,
}

/// What is next on the way of a photon through a plot.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) enum Leg {
    /// It leaves the height in which anything stands.
    Last,
    /// After so many metres it comes to a side, where it is moved by this.
    Side(f64, DVec3),
}

impl Plot {
    /// The plot of this size, in metres, round the middle of `bounds`, which hold all that stands in it and its neighbours'
    /// parts that hang over. `None` if there is no such plot.
    #[must_use]
    pub fn new(size: DVec2, bounds: Bounds3) -> Option<Self> {
        let is_possible = size.is_finite() && size.min_element() > 0.0 && !bounds.is_empty();
        if !is_possible {
            return None;
        }
        let (middle, half) = (bounds.center().truncate(), size * 0.5);
        let min = (middle - half).extend(bounds.min.z);
        let max = (middle + half).extend(bounds.max.z);
        Some(Self {
            bounds: Bounds3 { min, max },
            size,
        })
    }

    /// The plot as a box.
    #[must_use]
    pub fn bounds(&self) -> Bounds3 {
        self.bounds
    }

    /// The upper side of the box, which all light from above passes exactly once.
    #[must_use]
    pub(super) fn top(&self) -> Bounds3 {
        Bounds3 {
            min: self.bounds.min.with_z(self.bounds.max.z),
            max: self.bounds.max,
        }
    }

    /// Where light that passes `point` at the top along `direction` has not met anything yet.
    pub(super) fn before_all(&self, point: DVec3, direction: DVec3) -> DVec3 {
        let height = self.bounds.max.z - self.bounds.min.z;
        if direction.z > 0.0 {
            point - direction * (height / direction.z)
        } else {
            point
        }
    }

    /// How often a plot must be put beside itself to each side so that all that stands in `bounds` is there where it hangs over.
    #[must_use]
    pub fn overhang(&self, bounds: &Bounds3) -> [u32; 2] {
        let over = (self.bounds.min - bounds.min).max(bounds.max - self.bounds.max);
        [over.x / self.size.x, over.y / self.size.y].map(|n| n.ceil().clamp(0.0, 1e6) as u32)
    }

    /// A ray from outside of the plot, begun where it comes to the height of what stands in it, in the plot.
    pub(super) fn enter(&self, ray: &Ray) -> Ray {
        let (z, dz) = (ray.origin.z, ray.direction.z);
        let to = if dz < 0.0 && z > self.bounds.max.z {
            (self.bounds.max.z - z) / dz
        } else if dz > 0.0 && z < self.bounds.min.z {
            (self.bounds.min.z - z) / dz
        } else {
            0.0
        };
        let at = ray.at(to);
        let turns = ((at - self.bounds.min).truncate() / self.size).floor();
        Ray {
            origin: at - (turns * self.size).extend(0.0),
            ..*ray
        }
    }

    /// What is next for a ray that begins in the plot.
    pub(super) fn leg(&self, ray: &Ray) -> Leg {
        let mut side = (f64::INFINITY, DVec3::ZERO);
        for axis in 0..2 {
            let d = ray.direction[axis];
            let (wall, turn) = if d > 0.0 {
                (self.bounds.max[axis], -self.size[axis])
            } else {
                (self.bounds.min[axis], self.size[axis])
            };
            let t = (wall - ray.origin[axis]) / d;
            if d != 0.0 && t < side.0 {
                let mut shift = DVec3::ZERO;
                shift[axis] = turn;
                side = (t.max(0.0), shift);
            }
        }
        let (z, dz) = (ray.origin.z, ray.direction.z);
        let is_out = dz > 0.0 && z > self.bounds.max.z || dz < 0.0 && z < self.bounds.min.z;
        if is_out || side.0 == f64::INFINITY {
            Leg::Last
        } else {
            Leg::Side(side.0, side.1)
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn plot() -> Plot {
        let bounds = Bounds3::of([DVec3::new(-1.0, -1.0, 0.0), DVec3::new(1.0, 1.0, 3.0)]);
        Plot::new(DVec2::new(2.0, 4.0), bounds).unwrap()
    }

    #[test]
    fn rays_go_round_until_they_are_above_all() {
        let plot = plot();
        let d = DVec3::new(0.8, 0.0, 0.6);
        let ray = Ray::new(DVec3::new(0.0, 0.0, 0.0), d);
        let Leg::Side(t, shift) = plot.leg(&ray) else {
            panic!("a side")
        };
        assert_eq!((t, shift), (1.25, DVec3::new(-2.0, 0.0, 0.0)));
        let up = Ray::new(DVec3::new(0.0, 0.0, 3.1), d);
        assert_eq!(plot.leg(&up), Leg::Last);
        assert_eq!(plot.leg(&Ray::new(DVec3::ZERO, DVec3::Z)), Leg::Last);
    }

    #[test]
    fn light_from_far_away_enters_at_the_top_and_inside() {
        let ray = Ray::new(DVec3::new(100.0, 0.0, 103.0), DVec3::new(-0.6, 0.0, -0.8));
        let inside = plot().enter(&ray);
        assert_eq!(inside.origin.z, 3.0);
        assert!(
            plot().bounds().min.x <= inside.origin.x && inside.origin.x <= plot().bounds().max.x
        );
        assert!((inside.origin.x - 25.0).rem_euclid(2.0) < 1e-9);
    }

    #[test]
    fn what_hangs_over_is_put_on_the_other_side() {
        let wide = Bounds3::of([DVec3::new(-1.5, -1.0, 0.0), DVec3::new(3.5, 1.0, 3.0)]);
        assert_eq!(plot().overhang(&wide), [2, 0]);
        assert!(Plot::new(DVec2::new(0.0, 1.0), wide).is_none());
        assert!(Plot::new(DVec2::ONE, Bounds3::EMPTY).is_none());
    }
}
