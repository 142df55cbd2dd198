//! A single frame of a film, as people hear of it.

use super::audience::Audience;
use crate::animation::Moment;
use crate::diag::{Diagnostics, SourceMap};

/// A moment in words, for the texts of its frame.
pub(super) fn describe(moment: &Moment) -> String {
    let view = &moment.view;
    let mut text = format!(
        "eye={} target={} fov={}",
        view.eye,
        view.target,
        view.fov.degrees()
    );
    if let Some(step) = moment.step {
        text.push_str(&format!(" step={step}"));
    }
    if let Some(sun) = moment.sun {
        text.push_str(&format!(" sun={},{}", sun.azimuth, sun.elevation));
    }
    if moment.stops != 0.0 {
        text.push_str(&format!(" stops={}", moment.stops));
    }
    text
}

/// Turns the progress of a single frame into that of the film.
pub(super) struct FrameAudience<'a> {
    pub(super) audience: &'a dyn Audience,
    pub(super) index: u64,
    pub(super) n_frames: u64,
}

impl Audience for FrameAudience<'_> {
    fn printed(&self, text: &str) {
        self.audience.printed(text);
    }

    fn warned(&self, sources: &SourceMap, found: &Diagnostics) {
        self.audience.warned(sources, found);
    }

    fn begins(&self, _: &'static str) {}

    fn progress(&self, done: u64, total: u64) {
        self.audience
            .progress(self.index * total + done, self.n_frames * total);
    }

    fn ends(&self) {}
}
