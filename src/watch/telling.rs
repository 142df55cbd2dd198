//! Who is told how a run goes: the terminal, and the page.

use super::problems;
use super::room::Room;
use super::state::Activity;
use crate::diag::{Diagnostics, SourceMap};
use crate::pipeline::audience::Audience;
use std::sync::Arc;
use std::sync::atomic::{AtomicU64, Ordering};

/// Parts of a stage after which the page hears of it.
const PARTS: u64 = 50;

/// Tells the terminal and the page.
pub struct Both {
    terminal: Arc<dyn Audience>,
    room: Arc<Room>,
    /// The part of the stage that the page was told last.
    part: AtomicU64,
}

impl Both {
    /// An audience of these.
    pub fn new(terminal: Arc<dyn Audience>, room: Arc<Room>) -> Self {
        Self {
            terminal,
            room,
            part: AtomicU64::new(0),
        }
    }
}

impl Audience for Both {
    fn printed(&self, text: &str) {
        self.terminal.printed(text);
    }

    fn warned(&self, sources: &SourceMap, found: &Diagnostics) {
        self.terminal.warned(sources, found);
        let warnings = problems::of_diagnostics(sources, found);
        self.room.tell(|state| state.problems.extend(warnings));
    }

    fn begins(&self, stage: &'static str) {
        self.terminal.begins(stage);
        self.part.store(0, Ordering::Relaxed);
        self.room.tell(|state| {
            state.activity = Activity::Busy(stage);
            state.progress = None;
        });
    }

    fn progress(&self, done: u64, total: u64) {
        self.terminal.progress(done, total);
        let part = PARTS.saturating_mul(done) / total.max(1);
        if self.part.swap(part, Ordering::Relaxed) != part {
            let progress = done as f64 / total.max(1) as f64;
            self.room
                .tell(|state| state.progress = Some(progress.min(1.0)));
        }
    }

    fn ends(&self) {
        self.terminal.ends();
    }
}
