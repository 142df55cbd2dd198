//! Worlds to try rays in, by the builders of the validation.
#![allow(
    dead_code,
    unused_imports,
    reason = "each test binary uses a part of it"
)]

use understory::scene::Scene;
use understory::scene::description::PlacedShape;
pub(crate) use understory::validation::worlds::{
    Random, describe, icosphere, instance, mesh, placed, soup, tetrahedron, try_build,
};

pub(crate) fn build(shapes: Vec<PlacedShape>) -> Scene {
    try_build(shapes).expect("the shapes are valid")
}

/// Whether the long versions of tests are wanted: `UNDERSTORY_FULL=1 cargo test --release`.
pub(crate) fn full() -> bool {
    std::env::var_os("UNDERSTORY_FULL").is_some()
}
