//! A camera that goes once round its target.

use super::View;
use crate::math::angle::Angle;
use glam::{DMat3, DVec3};

/// `start`, moved along a circle round the axis through its target, by the part `turn` of a full circle (1 is once round,
/// counter-clockwise seen from the tip of `up`).
#[must_use]
pub fn orbit(start: &View, turn: f64) -> View {
    let axis = start.up.try_normalize().unwrap_or(DVec3::Z);
    let angle = Angle::deg(360.0 * turn);
    let (sin, cos) = (angle.sin(), angle.cos());

    // Rodrigues' rotation, written out so that sine and cosine are libm's on every machine.
    let cross = DMat3::from_cols(
        DVec3::new(0.0, axis.z, -axis.y),
        DVec3::new(-axis.z, 0.0, axis.x),
        DVec3::new(axis.y, -axis.x, 0.0),
    );
    let rotation = DMat3::IDENTITY + cross * sin + cross * cross * (1.0 - cos);
    View {
        eye: start.target + rotation * (start.eye - start.target),
        ..*start
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_eye_keeps_its_distance_and_height() {
        let start = View {
            eye: DVec3::new(3.0, 1.0, 7.0),
            target: DVec3::new(1.0, 1.0, 5.0),
            up: DVec3::Z * 4.0,
            fov: Angle::deg(40.0),
        };
        assert_eq!(orbit(&start, 0.0), start);
        let quarter = orbit(&start, 0.25);
        assert!(
            quarter.eye.distance(DVec3::new(1.0, 3.0, 7.0)) < 1e-12,
            "{quarter:?}"
        );
        assert!(orbit(&start, 0.5).eye.distance(DVec3::new(-1.0, 1.0, 7.0)) < 1e-12);
        assert_eq!(quarter.target, start.target);
    }
}
