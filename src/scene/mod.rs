//! The world as light sees it: immutable once built, ignorant of grammars.
//!
//! ```text
//! SceneDescription (f64 data) → Scene::build → Scene { closest, occluded, surface, lights, bounds }
//! ```

pub mod description;
