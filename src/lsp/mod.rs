//! A language server: what editors ask of a model while it is being written.
//!
//! [`server`] talks over a pipe ([`wire`]) in the Language Server Protocol, without threads but the one that reads.
//! [`workspace`] holds the open texts and finds which files make one model; [`reading`] reads half-typed text by blanking
//! out what cannot be read. What a name means comes from the check itself ([`crate::check::survey`]), what the words
//! of the language mean from the [`manual`](crate::manual). Nothing runs the model.

pub mod calling;
pub mod completion;
pub mod cursor;
pub mod faults;
pub mod meaning;
pub mod outline;
pub mod place;
pub mod reading;
pub mod renaming;
pub mod server;
pub mod symbols;
pub mod wire;
pub mod workspace;
