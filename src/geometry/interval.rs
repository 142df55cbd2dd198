//! The stretch of a ray that counts.

use glam::DVec3;

/// Values of t with `after < t ≤ until`.
///
/// Open below, so that asking again after a hit finds the next one.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Interval {
    /// Excluded lower end.
    pub after: f64,
    /// Included upper end.
    pub until: f64,
}

impl Interval {
    /// Whether `t` lies inside; `false` for NaN.
    #[inline]
    #[must_use]
    pub fn contains(&self, t: f64) -> bool {
        t > self.after && t <= self.until
    }
}

/// A line `origin + t · direction` in some frame; the direction need not have unit length.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Line {
    /// The point at t = 0.
    pub origin: DVec3,
    /// The change of the point per unit of t.
    pub direction: DVec3,
}

impl Line {
    /// The point at `t`.
    #[inline]
    #[must_use]
    pub fn at(&self, t: f64) -> DVec3 {
        self.origin + self.direction * t
    }
}
