//! The command that runs again whenever an input changes.

use super::args::WatchArgs;
use super::commands::{check_wishes, run, summary};
use super::outcome;
use super::shell::Shell;
use crate::integrator::CancelToken;
use crate::options::Command;
use crate::pipeline::failure::Failure;
use crate::pipeline::making::{Making, Partial};
use crate::pipeline::report::PhaseSeconds;
use crate::pipeline::store::{JsonTarget, PictureTarget};
use crate::pipeline::studio::{Keep, Studio};
use crate::watch::{Event, Runner, files, watch as attend};
use std::path::Path;
use std::sync::mpsc::{Receiver, Sender};

/// `watch`: makes the picture, and makes it again whenever an input changes, until Ctrl-C.
pub(super) fn watch(
    shell: &Shell,
    args: &WatchArgs,
    sender: Sender<Event>,
    events: Receiver<Event>,
) -> Result<(), Failure> {
    let model = args.model.model.as_path();
    let output = match &args.output {
        Some(output) if !args.manners.explain_options => output,
        _ => return shell.explain(model, Command::Watch),
    };
    let target = PictureTarget::new(&shell.world, output)?;
    let report = shell.report_target(args.report.as_deref())?;
    let follower = files::follow(&shell.world, model, sender.clone());
    if let Err(error) = &follower {
        let why = format!("no file events here ({error}); looking once a second instead");
        shell.terminal.note(&why);
    }
    let mut studio = studio(shell, model);
    studio.access = args.model.access()?;
    let mut runner = PictureRunner {
        shell,
        model,
        target,
        report,
        studio,
    };
    attend(&shell.world, model, &mut runner, sender, events);
    Ok(())
}

fn studio<'s>(shell: &'s Shell, model: &Path) -> Studio<'s> {
    Studio::new(
        &shell.world,
        shell.terminal.clone(),
        model.to_owned(),
        Keep::All,
    )
}

/// Makes the picture once for each change.
struct PictureRunner<'s> {
    shell: &'s Shell,
    model: &'s Path,
    target: PictureTarget,
    report: Option<JsonTarget>,
    studio: Studio<'s>,
}

impl Runner for PictureRunner<'_> {
    fn run(&mut self, changed: &[String], cancel: &CancelToken) {
        let shell = self.shell;
        if !changed.is_empty() {
            shell
                .terminal
                .note(&format!("{} changed", changed.join(", ")));
        }
        self.studio.seconds = PhaseSeconds::default();
        let result = self.make(cancel);
        shell.terminal.finish_stage();
        match result {
            Ok(line) => shell.terminal.note(&line),
            // A stale run ends without a word: the next one is about to begin.
            Err(Failure::Stopped) => {}
            Err(failure) => {
                outcome::show(&shell.terminal, &failure);
                shell.terminal.note("waiting for a change");
            }
        }
    }

    fn recover(&mut self) {
        self.studio = studio(self.shell, self.model);
        self.shell.terminal.finish_stage();
        let message = "error: understory itself failed on this model; that is a fault of the program, please report it\n";
        self.shell.terminal.tell(message);
    }
}

impl PictureRunner<'_> {
    fn make(&mut self, cancel: &CancelToken) -> Result<String, Failure> {
        let (shell, target, report) = (self.shell, &self.target, &self.report);
        run(shell, &mut self.studio, |studio, run| {
            check_wishes(&shell.world, run)?;
            // A stale picture does not take the place of the last good one.
            let making = Making {
                cancel,
                ..shell.making(Partial::Drop)
            };
            let made = making.picture(studio, run, target)?;
            shell.report(report.as_ref(), run, &studio.seconds, &made)?;
            Ok(summary(target.path(), run, studio, &made))
        })
    }
}
