//! A ray: what of a straight line may be seen from its start.

use glam::DVec3;

/// The number of one primitive as it stands in one place of the world.
///
/// A triangle of a tree that is planted a thousand times has a thousand numbers. Numbers are dense from 0 in each scene
/// and mean nothing outside it.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash, PartialOrd, Ord)]
pub struct PrimitiveId(pub u64);

impl PrimitiveId {
    /// No primitive at all.
    pub const NONE: Self = Self(u64::MAX);
}

/// The points `origin + t · direction` with `t` in `t_min..=t_max`, in metres.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Ray {
    /// Where it starts.
    pub origin: DVec3,
    /// Where it goes; unit length.
    pub direction: DVec3,
    /// The nearest distance that counts, at least 0.
    pub t_min: f64,
    /// The farthest distance that counts; may be infinite.
    pub t_max: f64,
    /// The flat primitive that the ray starts on and therefore cannot meet; [`PrimitiveId::NONE`] if there is none.
    pub skip: PrimitiveId,
}

impl Ray {
    /// The whole half-line from `origin` along `direction` (unit length).
    #[must_use]
    pub const fn new(origin: DVec3, direction: DVec3) -> Self {
        Self {
            origin,
            direction,
            t_min: 0.0,
            t_max: f64::INFINITY,
            skip: PrimitiveId::NONE,
        }
    }

    /// The same ray, seen only as far as `t_max` metres.
    #[must_use]
    pub const fn until(mut self, t_max: f64) -> Self {
        self.t_max = t_max;
        self
    }

    /// The point `t` metres along the ray.
    #[must_use]
    pub fn at(&self, t: f64) -> DVec3 {
        self.origin + self.direction * t
    }
}
