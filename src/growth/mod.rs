//! A model while it grows: `init`, one step after the other, and what can be said of the result.

mod between;
mod deep;
mod edits;
mod grow;
mod resume;
mod sketch;

pub use between::Earlier;
pub use edits::{Outline, StepTrace};
pub use grow::{Growth, GrowthOptions};
pub use sketch::Sketch;
