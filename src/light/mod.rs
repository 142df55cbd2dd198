//! Where light comes from: lamps, the sky and the sun. (Surfaces that shine have an emitting material.)
//!
//! Sources answer two questions: how much light reaches a point from a direction they choose ([`LightSample`]), and with
//! which density they would have chosen it. Visibility is not their business.

pub mod alias;
mod clear_sky;
pub mod environment;
pub mod sun;

pub use environment::{Environment, Sky, SunDisk};

use crate::color::Rgb;
use crate::math::angle::Angle;
use glam::DVec3;

/// A source without a surface, in world coordinates.
#[derive(Clone, Debug, PartialEq)]
pub enum Light {
    /// Shines equally in all directions from a point.
    Point {
        /// Where it is, metres.
        position: DVec3,
        /// Radiant intensity, W/sr per channel.
        intensity: Rgb,
    },
    /// Shines from a point into a cone, with GroIMP's soft edge between two angles.
    Spot {
        /// Where it is, metres.
        position: DVec3,
        /// Unit vector along the middle of the beam.
        axis: DVec3,
        /// Half angle of full intensity, 0..=π.
        inner: Angle,
        /// Half angle at which it has faded to nothing, `inner`..=π.
        outer: Angle,
        /// Radiant intensity inside `inner`, W/sr per channel.
        intensity: Rgb,
    },
    /// Parallel light from far away, which reaches only what lies downstream of the plane through `origin`.
    Directional {
        /// Unit vector the light travels along.
        direction: DVec3,
        /// Irradiance on a surface that faces the light, W/m² per channel.
        irradiance: Rgb,
        /// A point of the plane, perpendicular to `direction`, where the light begins.
        origin: DVec3,
    },
}
