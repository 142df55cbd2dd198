//! A bounding volume hierarchy over boxes. It knows nothing of what is in them.
//!
//! ```text
//! boxes → build (by obvhs, then 8-wide) → Bvh { nodes } + order of the boxes in the leaves
//! Bvh::relabel → the leaves get the names that their owner knows them by
//! walk(Walking, Visitor) → shows the visitor the leaves that a ray meets, nearest first, in hierarchies within hierarchies
//! FlatBlock::candidates → which of eight triangles and parallelograms a ray may hit
//! ```
//! Boxes and box tests are `f32`. They are conservative only if the caller widens the boxes by what rounding the ray to
//! `f32` can do; [`crate::scene`] does so by normalising every group to the same size.

mod build;
mod cover;
mod extreme;
mod flats;
mod node;
mod simd;
mod stack;
mod traverse;

pub use build::{Box3, BoxKind, Leaves, build, build_unless};
pub use flats::{Candidates, FlatBlock};
pub use node::Bvh;
pub use simd::{Kernel, Lanes, WIDTH, dispatch};
pub use traverse::{BoxRay, Step, Visitor, Walking, walk};
