//! Numbers and space, with no knowledge of plants or light. Vectors and matrices are `glam`'s, in `f64`.

pub mod angle;
pub mod bounds;
pub mod frame;
pub mod functions;
pub mod ray;
pub mod rng;
pub mod stats;
pub mod sum;
pub mod tolerance;
pub mod warp;

pub use bounds::Bounds3;
pub use ray::{PrimitiveId, Ray};
