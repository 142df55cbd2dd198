//! A model while it grows: `init`, one step after the other, and what can be said of the result.

mod between;
mod deep;
mod grow;
mod sketch;

pub use between::Earlier;
pub use grow::{Growth, GrowthOptions};
pub use sketch::Sketch;
