//! Rules at work: finding matches of a pattern, making what comes in their place, and applying all of it at once.
//!
//! A rule costs what it matches. [`search()`] walks the extent of the pattern's first type and the edges from there; the
//! right-hand side of a match tells the [`Queue`] which nodes and edges it wants ([`Queue::begin`] … [`Queue::end`]);
//! [`Queue::apply`] changes the graph at the end of the step. There is no language here: conditions and arguments are
//! evaluated by whoever implements [`MatchEnv`].
//!
//! The order of everything (matches, births, children of a node) is GroIMP's, because models see it: in the order of
//! `println`, of random numbers, of queries in the next step.

mod apply;
mod automaton;
mod batches;
mod deferred;
mod env;
mod path;
mod plan;
mod producer;
mod queue;
mod search;
#[cfg(test)]
mod tests;

pub use deferred::{Assignment, DeferredValue};
pub use env::{Flow, Found, Match, MatchEnv};
pub use plan::Plan;
pub use producer::Instantiated;
pub use queue::{Derivation, Mode, Queue, RewriteError};
pub use search::{ScratchPool, search};
