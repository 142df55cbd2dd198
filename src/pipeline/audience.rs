//! Who is told how a run goes.

use crate::diag::{Diagnostics, SourceMap};

/// Who is told how a run goes, while it goes. Calls come from any thread.
pub trait Audience: Send + Sync {
    /// The model printed this; line ends are part of it.
    fn printed(&self, text: &str);

    /// Something about the model is questionable.
    fn warned(&self, sources: &SourceMap, found: &Diagnostics);

    /// A stage of the run begins (`growing`, say); the one before has ended.
    fn begins(&self, stage: &'static str);

    /// The stage is so far; both in units of its own.
    fn progress(&self, done: u64, total: u64);

    /// No stage is under way any more.
    fn ends(&self);
}

/// Nobody.
#[derive(Clone, Copy, Debug, Default)]
pub struct Silent;

impl Audience for Silent {
    fn printed(&self, _: &str) {}

    fn warned(&self, _: &SourceMap, _: &Diagnostics) {}

    fn begins(&self, _: &'static str) {}

    fn progress(&self, _: u64, _: u64) {}

    fn ends(&self) {}
}
