//! The growth of one model.

use std::sync::Arc;

use super::deep::{SHALLOW, with_deep_stack};
use super::sketch::Sketch;
use crate::check::model::{MethodId, Model};
use crate::diag::{Diagnostic, Span, nearest};
use crate::eval::files::ModelFiles;
use crate::eval::library::data::Table;
use crate::eval::light_model::LightSolver;
use crate::eval::object::Data;
use crate::eval::{Limits, Machine, Output, Program, Setup, StopSign, Trap, Value};
use crate::graph::Graph;

/// How a model is to grow.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct GrowthOptions {
    /// Seed of the model's generator, until the model sets its own.
    pub seed: i64,
    /// Budgets.
    pub limits: Limits,
    /// Name of the method that is one step.
    pub entry: String,
}

impl Default for GrowthOptions {
    fn default() -> Self {
        Self {
            seed: 0,
            limits: Limits::default(),
            entry: "run".to_owned(),
        }
    }
}

/// A model and its graph.
///
/// Same model, seed and number of steps give the same graph on every machine.
pub struct Growth {
    program: Arc<Program>,
    pub(super) machine: Machine,
    options: GrowthOptions,
    pub(super) n_steps: u64,
}

impl Growth {
    /// A model before `init`. What it prints goes to `output`; `stop` is asked now and then whether to end early.
    ///
    /// # Errors
    /// The graph may not even have its root and axiom.
    pub fn new(
        model: &Model,
        options: GrowthOptions,
        output: Output,
        stop: StopSign,
    ) -> Result<Self, Box<Diagnostic>> {
        let program = Arc::new(Program::new(model));
        let setup = Setup {
            seed: options.seed,
            limits: options.limits,
            output,
            stop,
        };
        let machine = Machine::new(&program, setup).map_err(boxed)?;
        Ok(Self {
            program,
            machine,
            options,
            n_steps: 0,
        })
    }

    /// Applies every rule match by match from here on, for tests: rules that are templates give the same result either way.
    pub fn avoid_templates(&mut self) {
        self.machine.uses_templates = false;
    }

    /// The files that the model may use from now on; none without this.
    pub fn set_files(&mut self, files: Box<dyn ModelFiles>) {
        self.machine.files = files;
    }

    /// What the model has written so far: places as its files name them, and whole texts.
    pub fn written(&self) -> impl Iterator<Item = (&str, &str)> {
        let written = self.machine.written.iter();
        written.map(|(place, (text, _))| (place.as_str(), text.as_str()))
    }

    /// The tables that the model draws, and how (0 lines, 1 points, 2 bars).
    pub fn charts(&self) -> Vec<(Table, i32)> {
        let charts = self.machine.charts.iter();
        let tables = charts.filter_map(|(object, kind)| match &*object.lock() {
            Data::Table(table) => Some(((**table).clone(), *kind)),
            _ => None,
        });
        tables.collect()
    }

    /// Starts the model: initializes its variables, runs `init` and applies what that has queued. A model without `init`
    /// begins with its axiom alone.
    ///
    /// # Errors
    /// What went wrong at run time, with place and trace.
    pub fn init(&mut self) -> Result<(), Box<Diagnostic>> {
        self.n_steps = 0;
        self.machine.step = 0;
        let seed = self.options.seed;
        let before = "before `init`, where the variables of the model are set";
        self.run_deep(before.to_owned(), |program, machine| {
            machine.clear(program)?;
            machine.random.set_seed(seed);
            program.initialize(machine)
        })?;
        self.run_deep("before step 1".to_owned(), |program, machine| {
            program.run_startup(machine)?;
            program.run_init(machine)
        })
    }

    /// Grows by one step: one call of the entry method, then everything queued is applied. Nothing happens once the model
    /// has called `stop()`.
    ///
    /// # Errors
    /// What went wrong at run time, or that there is no such method.
    pub fn step(&mut self) -> Result<(), Box<Diagnostic>> {
        let entry = self.entry()?;
        if self.machine.is_finished {
            return Ok(());
        }
        let number = self.n_steps + 1;
        self.machine.step = number;
        self.run_deep(format!("in step {number}"), |program, machine| {
            program.run_entry(entry, machine)
        })?;
        self.n_steps = number;
        Ok(())
    }

    /// Grows by `n` steps.
    ///
    /// # Errors
    /// As [`Growth::step`]; the steps before stay done.
    pub fn run(&mut self, n: u64) -> Result<(), Box<Diagnostic>> {
        (0..n).try_for_each(|_| self.step())
    }

    /// Steps done since `init`.
    pub fn steps(&self) -> u64 {
        self.n_steps
    }

    /// Turns of loops, calls, matches and nodes tried since the last step (or `init`) began: what [`Limits::steps`]
    /// bounds. A measure of work that no clock disturbs.
    pub fn turns(&self) -> u64 {
        self.machine.turns()
    }

    /// Whether the model has an `init`.
    pub fn has_init(&self) -> bool {
        self.program.has_init()
    }

    /// Names of the methods that can be a step.
    pub fn entries(&self) -> impl Iterator<Item = &str> {
        self.program.entries().iter().map(|(name, _)| name.as_str())
    }

    /// The grown graph.
    pub fn graph(&self) -> &Graph<Value> {
        &self.machine.graph
    }

    /// Number of nodes of each type that has any, turtle commands included, root left out.
    pub fn counts(&self) -> Vec<(String, usize)> {
        self.graph().counts()
    }

    /// Number of nodes, root left out.
    pub fn total(&self) -> usize {
        self.counts().iter().map(|(_, n)| n).sum()
    }

    /// The graph one node per line.
    pub fn tree_text(&self) -> String {
        self.graph().tree_text()
    }

    /// The graph as a bracketed string.
    pub fn string_text(&self) -> String {
        self.graph().string_text()
    }

    /// A number that equal graphs share.
    pub fn hash(&self) -> u64 {
        self.graph().digest()
    }

    /// Draws: instantiation bodies that run in `draw` have room for recursion and share one budget of turns and calls.
    pub fn drawing<R: Send>(&mut self, draw: impl FnOnce(&mut Sketch<'_>) -> R + Send) -> R {
        let (program, machine, step) = (&*self.program, &mut self.machine, self.n_steps);
        with_deep_stack(|bytes| {
            machine.begin(bytes);
            // The other half is for the bodies that stand in bodies.
            draw(&mut Sketch::after_step(program, machine, step, bytes / 2))
        })
    }

    /// The graph, to be changed by who draws it between two steps.
    pub(super) fn graph_mut(&mut self) -> &mut Graph<Value> {
        &mut self.machine.graph
    }

    /// The model as it stands, drawn on the caller's own stack.
    pub fn sketch(&mut self) -> Sketch<'_> {
        Sketch::after_step(&self.program, &mut self.machine, self.n_steps, SHALLOW)
    }

    /// What traces the light of the model's light models from now on; nothing does without this.
    pub fn set_light_solver(&mut self, solver: Box<dyn LightSolver>) {
        self.machine.light = solver;
    }

    fn entry(&self) -> Result<MethodId, Box<Diagnostic>> {
        let entries = self.program.entries();
        let wanted = self.options.entry.as_str();
        if let Some((_, method)) = entries.iter().find(|(name, _)| name == wanted) {
            return Ok(*method);
        }
        let mut fault = Diagnostic::error(
            "unknown-entry",
            Span::default(),
            format!("the model has no public method `{wanted}()` to step"),
        );
        fault.primary = None;
        let mut names: Vec<&str> = self.entries().collect();
        if let Some(near) = nearest(wanted, names.iter().copied()) {
            fault = fault.hint(format!("did you mean `--entry {near}`?"));
            names.sort_by_key(|name| *name != near);
        }
        Err(Box::new(match names.as_slice() {
            [] => fault.hint("write `public void run() [ … ]` with the rules of one step"),
            names => fault.hint(format!("`--entry` can be: {}", names.join(", "))),
        }))
    }

    pub(super) fn run_deep(
        &mut self,
        what: String,
        f: impl FnOnce(&Program, &mut Machine) -> Result<(), Trap> + Send,
    ) -> Result<(), Box<Diagnostic>> {
        let (program, machine) = (&*self.program, &mut self.machine);
        let result = with_deep_stack(|bytes| {
            let mark = machine.stack.mark();
            machine.begin(bytes);
            let result = f(program, machine);
            machine.stack.release(mark);
            if result.is_err() {
                machine.queue.clear(&mut machine.graph);
            }
            result
        });
        result.map_err(|trap| Box::new(trap.into_diagnostic().during(what)))
    }
}

fn boxed(trap: Trap) -> Box<Diagnostic> {
    Box::new(trap.into_diagnostic())
}
