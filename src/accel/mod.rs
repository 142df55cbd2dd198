//! A bounding volume hierarchy over boxes. It knows nothing of what is in them.
//!
//! ```text
//! boxes → build (by obvhs, then 8-wide) → Bvh { nodes } + order of the boxes in the leaves
//! Bvh::traverse(ray, leaf) → calls `leaf` with ranges of that order, nearest boxes first
//! ```
//! Boxes and box tests are `f32`. They are conservative only if the caller widens the boxes by what rounding the ray to
//! `f32` can do; [`crate::scene`] does so by normalising every group to the same size.

mod build;
mod extreme;
mod node;
mod stack;
mod traverse;

pub use build::{Box3, build};
pub use node::Bvh;
pub use stack::TraversalStack;
pub use traverse::{BoxRay, Step};
