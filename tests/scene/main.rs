//! What rays find in a scene: every shape, everywhere, through instances, and whatever is wrong with it.

mod instances;
mod limits;
mod shapes;
#[path = "../support/worlds.rs"]
mod worlds;
