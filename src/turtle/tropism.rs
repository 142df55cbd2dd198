//! Turns whose angle depends on where the head looks in the world: gravitropism, tropisms, `HDir`, `AdjustLU`, `RG`.
//!
//! All work in the world's frame and leave the turtle's place as it is. h is the head as a unit vector.

use super::state::TurtleState;
use crate::math::functions::{acos, cos, sin, sin_cos};
use crate::math::tolerance::{PARALLEL_SINE, TROPISM_ANGLE};
use glam::{DMat3, DVec3};

impl TurtleState {
    /// Gravitropism (`RV`): the new head is h + e·(0, 0, -1), made a unit vector. A vertical head stays.
    pub(super) fn bend_down(&mut self, e: f64) {
        let h = self.head();
        if level_part(h) < PARALLEL_SINE {
            return;
        }
        self.turn_head_to((h - DVec3::new(0.0, 0.0, e)).normalize_or_zero());
    }

    /// `RG`: the head straight down, by the shortest turn; from straight up, half a turn about the left axis.
    pub(super) fn look_down(&mut self) {
        let h = self.head();
        if level_part(h) >= PARALLEL_SINE {
            self.turn_head_to(DVec3::NEG_Z);
        } else if h.z > 0.0 {
            let m = &mut self.transform.matrix3;
            (m.y_axis, m.z_axis) = (-m.y_axis, -m.z_axis);
        }
    }

    /// Directional tropism (`RD`): by e·|h × d| radians about h × d, so that positive e bends towards d.
    pub(super) fn bend_towards(&mut self, d: DVec3, e: f64) {
        let axis = self.head().cross(d);
        self.bend(axis, e * axis.length());
    }

    /// Orthogonal tropism (`RO`): by -e·h·d radians about h × d, so that positive e bends towards the plane
    /// perpendicular to d.
    pub(super) fn bend_across(&mut self, d: DVec3, e: f64) {
        let h = self.head();
        self.bend(h.cross(d), -e * h.dot(d));
    }

    /// Positional tropism (`RP`): [`bend_towards`](Self::bend_towards) the unit vector to a point.
    pub(super) fn bend_to_point(&mut self, target: DVec3, e: f64) {
        self.bend_towards((target - self.position()).normalize_or_zero(), e);
    }

    /// `HDir`: the head to `inclination` radians from straight up, in the vertical plane it lies in. A vertical head turns
    /// about the left axis, away from local y.
    pub(super) fn incline(&mut self, inclination: f64) {
        let h = self.head();
        let away_from_up = DVec3::new(-h.y, h.x, 0.0);
        let axis = if level_part(h) < PARALLEL_SINE {
            self.transform.matrix3.x_axis.normalize_or_zero()
        } else {
            away_from_up.normalize_or_zero()
        };
        let (s, c) = sin_cos(inclination - acos(h.z.clamp(-1.0, 1.0)));
        self.turn_world(axis, s, c);
    }

    /// `AdjustLU`: rolls about the head until local y has its greatest height. A vertical head stays.
    pub(super) fn roll_up(&mut self) {
        let m = &mut self.transform.matrix3;
        let (x, y) = (m.x_axis, m.y_axis);
        // The height of -s·x + c·y is greatest for (s, c) in proportion to (-x.z, y.z).
        let reach = (x.z * x.z + y.z * y.z).sqrt();
        if reach > PARALLEL_SINE * x.length().max(y.length()) {
            let (s, c) = (-x.z / reach, y.z / reach);
            m.x_axis = x * c + y * s;
            m.y_axis = y * c - x * s;
        }
    }

    /// Turns by `angle` radians about a direction given in the world.
    ///
    /// As in GroIMP the axis is taken into the local frame first, which matters under uneven scale only.
    fn bend(&mut self, axis: DVec3, angle: f64) {
        if angle.abs() < TROPISM_ANGLE {
            return;
        }
        let m = self.transform.matrix3;
        let local = (m.inverse() * axis).normalize_or_zero();
        if local.is_finite() && local != DVec3::ZERO {
            self.transform.matrix3 = m * rotation(local, sin(angle), cos(angle));
        }
    }

    /// The shortest turn that takes the head to the unit vector `to`; none if that is zero or opposite.
    fn turn_head_to(&mut self, to: DVec3) {
        let h = self.head();
        let axis = h.cross(to);
        let s = axis.length();
        if s > 0.0 {
            self.turn_world(axis / s, s, h.dot(to));
        }
    }

    /// Turns the frame about a unit vector of the world by the angle with this sine and cosine.
    fn turn_world(&mut self, axis: DVec3, s: f64, c: f64) {
        if axis.is_finite() && axis != DVec3::ZERO {
            self.transform.matrix3 = rotation(axis, s, c) * self.transform.matrix3;
        }
    }
}

/// Length of the horizontal part of a vector. (`f64::hypot` may differ between machines in the last bit.)
fn level_part(v: DVec3) -> f64 {
    v.truncate().length()
}

/// The right-handed rotation about a unit vector by the angle with this sine and cosine (Rodrigues).
fn rotation(axis: DVec3, s: f64, c: f64) -> DMat3 {
    let turned = |v: DVec3| v * c + axis.cross(v) * s + axis * (axis.dot(v) * (1.0 - c));
    DMat3::from_cols(turned(DVec3::X), turned(DVec3::Y), turned(DVec3::Z))
}
