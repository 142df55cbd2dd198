//! A ray: what of a straight line may be seen from its start.

use glam::DVec3;

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
}
