//! `understory` grows plants and forests from growth grammars (`.rgg` files, the language XL of GroIMP) and renders them
//! with its own light transport.
//!
//! # The road of a model
//! text → [`syntax`] → [`check`] (every name resolved, every expression typed) → [`eval`] and [`growth`] (rules rewrite the
//! [`graph`]) → [`interpret`] (turtle and instantiation bodies turn the graph into geometry) → [`scene`] with its
//! acceleration structure → [`integrator`] → [`film`] → [`image`].
//!
//! # The ladder
//! The modules below stand in dependency order: each uses only modules above it in this file. `tests/tidy.rs` enforces it.
//!
//! # Invariants
//! - Nothing below [`pipeline`] touches the file system, the clock, the environment or the terminal.
//! - [`syntax`] knows no meaning; [`check`] is the last module to see the syntax tree; [`interpret`] is the last to see the graph.
//! - A [`scene`] is immutable once built and knows no grammar: primitives carry an opaque organ number.
//! - Coordinates, directions and radiance are `f64` everywhere except in the stored acceleration structure (`f32`,
//!   conservatively rounded) and in the language's own `float`.
//! - Same model, seed and options give the same bytes, whatever the number of threads.

// ── ground ──
pub mod math;
pub mod color;
pub mod diag;
pub mod references;

// ── language ──
pub mod syntax;
pub mod graph;
pub mod turtle;
pub mod library;
pub mod check;
pub mod manual;
pub mod rewrite;
pub mod eval;
pub mod growth;

// ── world ──
pub mod geometry;
pub mod material;
pub mod light;
pub mod camera;
pub mod accel;
pub mod scene;
pub mod interpret;

// ── light transport ──
pub mod sampler;
pub mod film;
pub mod integrator;
pub mod validation;

// ── output and shell ──
pub mod image;
pub mod animation;
pub mod options;
pub mod pipeline;
pub mod trade;
pub mod watch;
pub mod lsp;
pub mod cli;
