//! Where a picture is taken from: the perspective camera, framing, and the orbit.
//!
//! A film point `(x, y)` lies in the unit square, x to the right and y **down**, so that rows of a picture run as they
//! are stored. Cameras are plain values; what moves one is a function of a frame number ([`orbit`]).
//!
//! ```
//! use glam::{DVec2, DVec3};
//! use understory::camera::{Camera, View};
//! use understory::math::angle::Angle;
//! let view = View { eye: DVec3::new(0.0, -5.0, 0.0), target: DVec3::ZERO, up: DVec3::Z, fov: Angle::deg(40.0) };
//! let camera = Camera::perspective(&view, 1.5).unwrap();
//! assert_eq!(camera.ray(DVec2::splat(0.5)).direction, DVec3::Y);
//! ```

pub mod framing;
pub mod lens;
pub mod orbit;
pub mod perspective;

pub use lens::Lens;
pub use perspective::{Camera, CameraError, View};
