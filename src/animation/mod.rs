//! Films: what each frame shows, and how frames become one file.
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

mod bits;
pub mod film;
pub mod flicker;
pub mod flight;
mod gif;
pub mod h264;
pub mod key;
pub mod mp4;
pub mod plan;
pub mod route;
pub mod sheet;
pub mod spline;
mod webp;

pub use film::{FilmError, FilmFormat, FilmShape, film};
pub use flight::{Flight, Moment, Speed, frame_name};
pub use key::{KeyFrame, KeyFrames, SunPlace};
