//! The growth before, kept step by step, so that the next one begins where it first differs.

use super::audience::Audience;
use super::content_hash::ContentHash;
use super::reads::{Reader, Reads};
use super::studio::Run;
use crate::diag::Diagnostic;
use crate::eval::Kept;
use crate::growth::{Growth, Outline, StepTrace};
use crate::options::Stage;
use std::sync::{Arc, Mutex, PoisonError};

/// Most bytes of copies.
const MOST_BYTES: u64 = 1 << 29;
/// … and this part of the memory that a model may have.
const SHARE: u64 = 8;
/// Most bytes of printed text that are kept.
const MOST_PRINTED: usize = 1 << 16;

/// What [`Outline::constants`] were.
type Constants = Arc<[Option<u64>]>;

/// What was grown last.
pub(super) struct History {
    /// What growth depends on besides the text and the number of steps.
    key: ContentHash,
    outline: Outline,
    /// What `init` and each step after it have used.
    traces: Vec<StepTrace>,
    /// Copies, those of early steps first, with the constants of the model at that time.
    kept: Vec<(Kept, Constants)>,
    /// Bytes that they may take.
    room: u64,
    /// Turns since the last copy.
    turns: u64,
    /// What the model prints in the step under way.
    printed: Arc<Mutex<String>>,
    reads: Reads,
    /// Whether later steps cannot be kept: they depend on more than the text.
    is_closed: bool,
}

impl History {
    /// Gets ready for a growth of `run`: of `before`, what holds for it is kept.
    pub(super) fn begin(before: Option<Self>, run: &Run, memory: u64, reads: &Reads) -> Self {
        let outline = Outline::of(&run.model);
        let fingerprint = run.options.fingerprint(Stage::Growth);
        let lines = fingerprint.lines();
        let rest: Vec<&str> = lines.filter(|line| !line.starts_with("steps=")).collect();
        let key = ContentHash::of([rest.join("\n").as_bytes()]);
        let mut history = Self {
            key,
            outline,
            traces: vec![],
            kept: vec![],
            room: MOST_BYTES.min(memory / SHARE),
            turns: 0,
            printed: Arc::default(),
            reads: reads.clone(),
            is_closed: false,
        };
        if let Some(mut before) = before
            && before.key == key
        {
            let unchanged = before.outline.unchanged(&history.outline, &before.traces);
            before.traces.truncate(unchanged);
            let is_alike = |(kept, _): &(Kept, _)| (kept.step() as usize) < unchanged;
            before.kept.retain(is_alike);
            (history.traces, history.kept) = (before.traces, before.kept);
            history.thin();
        }
        history
    }

    /// Where the model's printing is to be copied to.
    pub(super) fn notebook(&self) -> impl Fn(&str) + Send + use<> {
        let printed = self.printed.clone();
        move |text| {
            let mut printed = printed.lock().unwrap_or_else(PoisonError::into_inner);
            // Of too much, no more than it takes to know that it is too much.
            if printed.len() <= MOST_PRINTED {
                printed.push_str(text);
            }
        }
    }

    /// Brings a growth to the last step of at most `n_steps` that is known, and prints what it printed until then; `None` if
    /// it has to begin at its beginning.
    pub(super) fn resume(
        &mut self,
        growth: &mut Growth,
        n_steps: u32,
        audience: &dyn Audience,
    ) -> Result<Option<u32>, Box<Diagnostic>> {
        let mut known = self.kept.iter().rev();
        let is_on_the_way = |(kept, _): &&(Kept, _)| kept.step() <= u64::from(n_steps);
        let Some((kept, constants)) = known.find(is_on_the_way) else {
            self.traces.clear();
            return Ok(None);
        };
        let both = constants.iter().zip(self.outline.constants()).zip(0..);
        let others = both.filter(|((then, now), _)| then != now);
        let others: Vec<u32> = others.map(|(_, number)| number).collect();
        growth.resume(kept, &others)?;
        for trace in &self.traces[..=kept.step() as usize] {
            if !trace.printed.is_empty() {
                audience.printed(&trace.printed);
            }
        }
        Ok(Some(kept.step() as u32))
    }

    /// A growth has made `init` or a step; it is the last of this growth or not.
    pub(super) fn note(&mut self, growth: &mut Growth, run: &Run, is_last: bool) {
        let mut printed = self.printed.lock().unwrap_or_else(PoisonError::into_inner);
        let text = std::mem::take(&mut *printed);
        drop(printed);
        let step = growth.steps() as usize;
        let trace = growth.take_trace(&run.model, text);
        if self.is_closed || step > self.traces.len() {
            return;
        }
        if step == self.traces.len() {
            self.traces.push(trace);
        }
        let n_printed: usize = self.traces.iter().map(|trace| trace.printed.len()).sum();
        self.is_closed = n_printed > MOST_PRINTED || self.reads.has_any(Reader::Growth);
        self.turns += growth.turns();
        let (bytes, is_cheap) = growth.weighs(self.turns);
        let is_known = self.kept.iter().any(|(kept, _)| kept.step() == step as u64);
        if self.is_closed || is_known || bytes > self.room || !(is_cheap || is_last) {
            return;
        }
        if let Some(kept) = growth.keep() {
            self.turns = 0;
            let is_before = |(known, _): &(Kept, _)| known.step() < kept.step();
            let place = self.kept.partition_point(is_before);
            self.kept
                .insert(place, (kept, self.outline.constants().into()));
            self.thin();
        }
    }

    /// Gives every second copy back, the last one never, until there is room for the rest.
    fn thin(&mut self) {
        let bytes = |kept: &[(Kept, _)]| kept.iter().map(|(kept, _)| kept.bytes()).sum::<u64>();
        while bytes(&self.kept) > self.room && !self.kept.is_empty() {
            let n = self.kept.len();
            let mut place = 0;
            self.kept.retain(|_| {
                place += 1;
                n > 1 && (n - place).is_multiple_of(2)
            });
        }
    }
}
