//! What the user sees while the program works.

#![allow(
    clippy::print_stderr,
    reason = "this is the one place that speaks to the user"
)]

use crate::diag::{Diagnostics, SourceMap, render};
use crate::integrator::CancelToken;
use crate::pipeline::audience::Audience;
use indicatif::{ProgressBar, ProgressDrawTarget, ProgressStyle};
use std::io::{self, BufWriter, IsTerminal, Write};
use std::sync::mpsc::{RecvTimeoutError, Sender, channel};
use std::sync::{Mutex, PoisonError};
use std::time::Duration;

/// Progress shows only if a stage takes longer than this.
const PATIENCE: Duration = Duration::from_secs(1);
/// How often the bar is drawn when nothing is heard of the stage.
const TICK: Duration = Duration::from_millis(120);

/// Where the texts go that a model prints.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum ModelOutput {
    /// To standard output: it is what the user asked for.
    Standard,
    /// To standard error: the user asked for a picture.
    Error,
}

/// Whether the user wants to see how it goes.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Manner {
    /// Summaries, and progress on a terminal.
    Talkative,
    /// Only what went wrong.
    Quiet,
}

/// The terminal, or what takes its place.
pub struct Terminal {
    manner: Manner,
    model_output: ModelOutput,
    out: Mutex<Out>,
    bar: Mutex<Option<Bar>>,
    /// Told to stop when nobody reads standard output any more.
    cancel: CancelToken,
}

struct Out {
    stream: Box<dyn Write + Send>,
    /// Why nothing can be written any more.
    failed: Option<io::Error>,
}

struct Bar {
    bar: ProgressBar,
    /// Dropped with the bar, which ends the thread that waits to show it.
    _curtain: Sender<()>,
}

impl Terminal {
    /// The terminal of a command.
    pub fn new(manner: Manner, model_output: ModelOutput, cancel: CancelToken) -> Self {
        let stdout = io::stdout();
        // A reader at a terminal wants each line at once; a file or pipe is served in blocks.
        let stream: Box<dyn Write + Send> = if stdout.is_terminal() {
            Box::new(stdout)
        } else {
            Box::new(BufWriter::new(stdout))
        };
        let out = Mutex::new(Out {
            stream,
            failed: None,
        });
        Self {
            manner,
            model_output,
            out,
            bar: Mutex::new(None),
            cancel,
        }
    }

    /// Writes to standard output. After a failure nothing more is written; [`finish`](Self::finish) tells.
    pub fn print(&self, text: &str) {
        let mut out = self.out.lock().unwrap_or_else(PoisonError::into_inner);
        if out.failed.is_none()
            && let Err(error) = out.stream.write_all(text.as_bytes())
        {
            out.failed = Some(error);
            self.cancel.cancel();
        }
    }

    /// Writes a line about how it went, unless the user wants none.
    pub fn note(&self, line: &str) {
        if self.manner == Manner::Talkative {
            self.tell(&format!("{line}\n"));
        }
    }

    /// Shows what is wrong with a model.
    pub fn diagnose(&self, sources: &SourceMap, found: &Diagnostics) {
        let wants_color = io::stderr().is_terminal() && std::env::var_os("NO_COLOR").is_none();
        let text = if wants_color {
            render::render_colored(sources, found)
        } else {
            render::render(sources, found)
        };
        self.tell(&text);
    }

    /// Writes to standard error, above the bar if there is one.
    pub fn tell(&self, text: &str) {
        let bar = self.bar.lock().unwrap_or_else(PoisonError::into_inner);
        let write = || {
            // A closed standard error leaves nobody to tell.
            let _ = io::stderr().write_all(text.as_bytes());
        };
        match &*bar {
            Some(bar) => bar.bar.suspend(write),
            None => write(),
        }
    }

    /// Takes down the bar of a stage that ended in a failure.
    pub fn finish_stage(&self) {
        self.ends();
    }

    /// Writes what is still held back; the first failure of standard output, if there was one.
    pub fn finish(&self) -> io::Result<()> {
        self.ends();
        let mut out = self.out.lock().unwrap_or_else(PoisonError::into_inner);
        match out.failed.take() {
            Some(error) => Err(error),
            None => out.stream.flush(),
        }
    }
}

impl Audience for Terminal {
    fn printed(&self, text: &str) {
        match self.model_output {
            ModelOutput::Standard => self.print(text),
            ModelOutput::Error => self.tell(text),
        }
    }

    fn warned(&self, sources: &SourceMap, found: &Diagnostics) {
        if self.manner == Manner::Talkative {
            self.diagnose(sources, found);
        }
    }

    fn begins(&self, stage: &'static str) {
        self.ends();
        if self.manner == Manner::Talkative && io::stderr().is_terminal() {
            let mut bar = self.bar.lock().unwrap_or_else(PoisonError::into_inner);
            *bar = Some(Bar::new(stage));
        }
    }

    fn progress(&self, done: u64, total: u64) {
        let bar = self.bar.lock().unwrap_or_else(PoisonError::into_inner);
        if let Some(Bar { bar, .. }) = &*bar {
            if bar.length() != Some(total) {
                bar.set_style(bar_style());
                bar.set_length(total);
            }
            bar.set_position(done);
        }
    }

    fn ends(&self) {
        let bar = self
            .bar
            .lock()
            .unwrap_or_else(PoisonError::into_inner)
            .take();
        if let Some(Bar { bar, .. }) = bar {
            bar.finish_and_clear();
        }
    }
}

impl Bar {
    fn new(stage: &'static str) -> Self {
        let bar = ProgressBar::with_draw_target(None, ProgressDrawTarget::hidden());
        bar.set_style(style("{spinner} {msg} {elapsed}"));
        bar.set_message(stage);
        let (curtain, waiting) = channel::<()>();
        let shown = bar.clone();
        std::thread::spawn(move || {
            if waiting.recv_timeout(PATIENCE) == Err(RecvTimeoutError::Timeout) {
                shown.set_draw_target(ProgressDrawTarget::stderr());
                shown.enable_steady_tick(TICK);
            }
        });
        Self {
            bar,
            _curtain: curtain,
        }
    }
}

/// A bar with rate and time left. Units differ between stages, so the rate is that of the whole.
fn bar_style() -> ProgressStyle {
    style("{msg} {wide_bar} {percent:>3} %  {per_sec}  {eta} left").with_key(
        "per_sec",
        |state: &indicatif::ProgressState, out: &mut dyn std::fmt::Write| {
            let share = 100.0 * state.per_sec() / state.len().unwrap_or(1).max(1) as f64;
            // Writing into the line of the bar does not fail.
            let _ = write!(out, "{share:.1} %/s");
        },
    )
}

fn style(template: &str) -> ProgressStyle {
    ProgressStyle::with_template(template).unwrap_or_else(|_| ProgressStyle::default_bar())
}
