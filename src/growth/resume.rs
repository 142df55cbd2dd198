//! Keeping a growth between two steps, and going on from there.

use super::edits::{Outline, StepTrace};
use super::grow::Growth;
use crate::check::model::Model;
use crate::diag::Diagnostic;
use crate::eval::Kept;

/// A copy of the model may take as much work as this part of the work that the steps since the last one took: it takes about
/// the time of a turn to copy so many nodes.
const NODES_PER_TURN: u64 = 4;
/// Models up to this many nodes are copied after each step.
const SMALL: u64 = 2_000;

impl Growth {
    /// About how much memory a copy takes, in bytes, and whether it is worth the work after so many turns.
    pub fn weighs(&self, turns: u64) -> (u64, bool) {
        let n_places = self.graph().n_places() as u64;
        let is_cheap = n_places <= SMALL || n_places <= turns.saturating_mul(NODES_PER_TURN);
        (self.machine.weight(), is_cheap)
    }

    /// A copy of the model as it stands; `None` if it holds what cannot be copied.
    pub fn keep(&self) -> Option<Kept> {
        self.machine.keep()
    }

    /// Goes on from where a growth was kept, in place of [`init`](Self::init): the steps until then must be the same for this
    /// model. The constants of these numbers are given their values anew.
    ///
    /// # Errors
    /// If there is no memory for its constants.
    pub fn resume(&mut self, kept: &Kept, constants: &[u32]) -> Result<(), Box<Diagnostic>> {
        let what = "where the constants of the model are set";
        self.run_deep(what.to_owned(), |program, machine| {
            machine.go_to(kept, program);
            program.initialize_some(machine, &|number| constants.contains(&number))
        })?;
        self.n_steps = kept.step();
        Ok(())
    }

    /// What the model, which this one grows, has used since this was last asked, when it has printed that meanwhile.
    pub fn take_trace(&mut self, model: &Model, printed: String) -> StepTrace {
        let trace = self.machine.trace.take();
        Outline::step(model, &trace, self.graph().used_types(), printed)
    }
}
