//! Films: which camera sees which frame.
//!
//! A frame is a function of the model, the options and its number, and of nothing else: any part of a film can be made
//! alone, in any order, again, and is the same part.
//!
//! ```
//! use glam::DVec3;
//! use std::num::NonZeroU32;
//! use understory::animation::Flight;
//! use understory::camera::View;
//! use understory::math::angle::Angle;
//! let start = View { eye: DVec3::X, target: DVec3::ZERO, up: DVec3::Z, fov: Angle::deg(40.0) };
//! let flight = Flight::orbit(start, NonZeroU32::new(4).unwrap());
//! assert!(flight.view(1).eye.distance(DVec3::Y) < 1e-12);
//! ```

pub mod flight;

pub use flight::{Flight, frame_name};
