//! Where light comes from: lamps, the sky and the sun. (Surfaces that shine have an emitting material.)
//!
//! Sources answer two questions: how much light reaches a point from a direction they choose ([`LightSample`]), and with
//! which density they would have chosen it. Visibility is not their business.

pub mod alias;
mod clear_sky;
pub mod dome;
pub mod environment;
mod lamp;
pub mod outline;
pub mod sky_image;
mod sky_table;
pub mod sun;
pub mod sun_position;
pub mod tree;

pub use dome::Dome;
pub use environment::{Environment, Sky, SunDisk};
pub use lamp::LightError;
pub use outline::{LampOutline, Receiver};
pub use sky_image::SkyImage;
pub use tree::LampTree;

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

/// Light that arrives at a point from one direction, chosen by a source.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct LightSample {
    /// Unit vector from the point towards the light.
    pub wi: DVec3,
    /// How far away the light is, metres; infinite for sky, sun and parallel light.
    pub distance: f64,
    /// Estimate of the irradiance on a surface that faces `wi`, W/m² per channel, nothing being in the way: radiance
    /// divided by density for a source with extent, the exact value for one without.
    pub facing_irradiance: Rgb,
    /// Density of `wi` per steradian, or `None` for a source without extent, which no scattered ray can hit.
    pub pdf_solid_angle: Option<f64>,
}
