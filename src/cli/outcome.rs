//! How a command ended, as a message and an exit code.

use super::terminal::Terminal;
use crate::pipeline::failure::Failure;
use std::io;
use std::process::ExitCode;

/// How a command ended.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[repr(u8)]
pub enum Exit {
    /// All that was asked for is there.
    Done = 0,
    /// The model has errors; or the program itself has, by its own checks.
    Model = 1,
    /// What was asked for makes no sense.
    Usage = 2,
    /// A file, memory, the machine; or it was stopped.
    World = 3,
}

impl From<Exit> for ExitCode {
    fn from(exit: Exit) -> Self {
        Self::from(exit as u8)
    }
}

/// Tells the user how the command ended.
pub fn conclude(terminal: &Terminal, result: Result<(), Failure>) -> Exit {
    let written = terminal.finish();
    if written
        .as_ref()
        .is_err_and(|error| error.kind() == io::ErrorKind::BrokenPipe)
    {
        // Whoever read the output has seen enough.
        return Exit::Done;
    }
    let exit = result.map_or_else(|failure| show(terminal, &failure), |()| Exit::Done);
    match written {
        Err(error) if exit == Exit::Done => {
            terminal.tell(&format!(
                "error: cannot write to standard output: {error}\n"
            ));
            Exit::World
        }
        _ => exit,
    }
}

/// Shows a failure.
pub fn show(terminal: &Terminal, failure: &Failure) -> Exit {
    match failure {
        Failure::Model { sources, found } => {
            terminal.diagnose(sources, found);
            Exit::Model
        }
        Failure::Usage(text) => {
            terminal.tell(&format!("error: {text}\n"));
            Exit::Usage
        }
        Failure::World(text) => {
            terminal.tell(&format!("error: {text}\n"));
            Exit::World
        }
        Failure::Invalid { failed, checks } => {
            terminal.tell(&format!(
                "error: {failed} of {checks} checks failed: this build of the program computes light wrongly\n"
            ));
            Exit::Model
        }
        Failure::Stopped => {
            terminal.tell("stopped\n");
            Exit::World
        }
    }
}
