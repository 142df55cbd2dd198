//! What all commands share: the machine, the terminal, the threads, the wish to stop.

use super::args::Manners;
use super::outcome::{self, Exit};
use super::request::Request;
use super::terminal::{Manner, ModelOutput, Terminal};
use crate::integrator::CancelToken;
use crate::options::{Command, Options, Presets, explain};
use crate::pipeline::failure::Failure;
use crate::pipeline::inputs::Inputs;
use crate::pipeline::making::{Made, Making, Partial};
use crate::pipeline::report::{REPORT_KEYS, Report};
use crate::pipeline::store::JsonTarget;
use crate::pipeline::studio::{Run, Studio};
use crate::pipeline::threads;
use crate::pipeline::world::{Machine, World};
use std::path::Path;
use std::sync::Arc;

/// What all commands share.
pub(super) struct Shell {
    /// The machine.
    pub(super) world: Machine,
    /// The terminal.
    pub(super) terminal: Arc<Terminal>,
    /// Set by Ctrl-C.
    pub(super) cancel: CancelToken,
    /// The options set by flags.
    pub(super) flags: Options,
    /// The command line without the program's name.
    pub(super) words: Vec<String>,
}

impl Shell {
    /// The shell of a request.
    pub(super) fn new(request: &Request, manners: Option<&Manners>, cancel: CancelToken) -> Self {
        let manner = match manners {
            Some(manners) if manners.quiet => Manner::Quiet,
            _ => Manner::Talkative,
        };
        let output = match request.action.command() {
            Command::Derive => ModelOutput::Standard,
            Command::Check
            | Command::Render
            | Command::Watch
            | Command::Fly
            | Command::Export
            | Command::Trade
            | Command::Validate
            | Command::Light
            | Command::Lsp => ModelOutput::Error,
        };
        let terminal = Arc::new(Terminal::new(manner, output, cancel.clone()));
        Self {
            world: Machine::new(),
            terminal,
            cancel,
            flags: request.flags.clone(),
            words: request.words.clone(),
        }
    }

    /// Takes what `--quality` stands for from a file.
    ///
    /// # Errors
    /// If it cannot be read or holds no presets.
    pub(super) fn read_presets(&mut self, path: Option<&Path>) -> Result<(), Failure> {
        let Some(path) = path else { return Ok(()) };
        let content = self
            .world
            .read(path)
            .map_err(|error| Failure::file("read", path, &error))?;
        let presets = Presets::parse(&String::from_utf8_lossy(&content)).map_err(|why| {
            Failure::Usage(format!("`{}` holds no presets: {why}", path.display()))
        })?;
        self.flags.presets = presets;
        Ok(())
    }

    /// Does the work of a command on as many threads as the options ask for.
    ///
    /// # Errors
    /// What the work fails with, or if there are no such threads.
    pub(super) fn on_threads<T: Send>(
        &self,
        options: &Options,
        work: impl FnOnce() -> Result<T, Failure> + Send,
    ) -> Result<T, Failure> {
        threads::pool(options)?.install(work)
    }

    /// Prints the options of a model as they are for `command`.
    ///
    /// # Errors
    /// If the model or the file beside it cannot be read, or that file is wrong.
    pub(super) fn explain(&self, path: &Path, command: Command) -> Result<(), Failure> {
        let sources = Inputs::find(&self.world, path)?.read(&self.world)?;
        let (options, found) = sources.options(&self.flags);
        if found.has_errors() {
            return Err(Failure::Model {
                sources: sources.map,
                found,
            });
        }
        self.terminal
            .print(&explain::explain(&options, command, &sources.map));
        Ok(())
    }

    /// What making pictures needs.
    pub(super) fn making(&self, partial: Partial) -> Making<'_> {
        Making {
            world: &self.world,
            audience: &*self.terminal,
            cancel: &self.cancel,
            partial,
        }
    }

    /// The report file to be, if one is wanted.
    ///
    /// # Errors
    /// If it could not be written.
    pub(super) fn report_target(&self, path: Option<&Path>) -> Result<Option<JsonTarget>, Failure> {
        path.map(|path| JsonTarget::new(&self.world, path, REPORT_KEYS))
            .transpose()
    }

    /// Writes the report, if one is wanted.
    ///
    /// # Errors
    /// If it cannot be written.
    pub(super) fn report(
        &self,
        target: Option<&JsonTarget>,
        run: &Run,
        studio: &Studio<'_>,
        made: &Made,
    ) -> Result<(), Failure> {
        let Some(target) = target else { return Ok(()) };
        let model = (&run.sources.map, run.sources.model_hash);
        let requirements = studio.requirements(run);
        let report = Report::new(
            &self.world,
            model,
            &run.options,
            &studio.seconds,
            made.effort,
            made.hash,
        )
        .solved(made.solution)
        .warning(&made.warnings)
        .requiring(requirements.as_ref())
        .working(studio.work)
        .flown(made.n_made, made.n_kept, made.flicker);
        target.write(&self.world, &report)
    }

    /// Ends the command.
    pub(super) fn conclude(&self, result: Result<(), Failure>) -> Exit {
        outcome::conclude(&self.terminal, result)
    }
}
