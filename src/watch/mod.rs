//! Running a model again whenever it changes.
//!
//! One thread owns the state ([`desk::Desk`]) and reads [`Event`]s; a second one runs the model. What counts is content:
//! events of the file system only say when to look, and a look once a second finds what they missed (network folders,
//! replaced folders). A change while a run is under way cancels that run.

pub mod desk;
pub mod files;
pub mod session;
pub mod snapshot;

pub use session::{Event, Runner, watch};
