//! The state of a running model: graph, stack, variables, generator, output, budgets.

use std::collections::BTreeMap;
use std::sync::Arc;

use super::files::{ModelFiles, NoFiles};
use super::light_model::{LightSolver, NoSolver};
use super::memory::{Charge, Meter};
use super::object::Object;
use super::program::Program;
use super::random::JavaRandom;
use super::stack::{Kind, Local, Stack};
use super::text::Text;
use super::trace::Trace;
use super::trap::{Cause, Trap};
use super::value::{MAX_TEXT, Value};
use crate::diag::Span;
use crate::graph::{Graph, GraphError, NodeId};
use crate::library::ClassId;
use crate::rewrite::{Derivation, Mode, Queue, RewriteError, ScratchPool};
use crate::turtle::Poses;

/// What a model may use before it is stopped.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Limits {
    /// Turns of loops, calls of methods and nodes tried by searches in one step.
    pub steps: u64,
    /// Methods active at one time.
    pub depth: u32,
    /// Bytes of texts, arrays and collections.
    pub memory: u64,
    /// Nodes in the graph.
    pub nodes: u64,
}

impl Default for Limits {
    /// Bounds that no sensible model meets: an endless loop ends after some seconds, not after hours.
    fn default() -> Self {
        Self {
            steps: 1 << 30,
            depth: 3_000,
            memory: 1 << 31,
            nodes: 50_000_000,
        }
    }
}

/// Bit of the derivation mode: nodes that a rule has consumed are matched no more.
const EXCLUDE_DELETED: i32 = 8;
/// Parallel, deleted nodes excluded.
const DEFAULT_MODE: i32 = EXCLUDE_DELETED;
/// Texts up to this length take no share of the memory budget.
const FREE_TEXT: usize = 64;
/// So many rules of a step are named when the step as a whole fails.
const MOST_RULES: usize = 4;
/// Turns between two looks at the cancellation token.
const CHECK_EVERY: u64 = 1 << 14;

/// Takes what the model prints, exactly as printed.
pub type Output = Box<dyn FnMut(&str) + Send>;
/// Tells whether the model shall stop as soon as possible.
pub type StopSign = Box<dyn Fn() -> bool + Send>;

/// A model while it runs.
pub struct Machine {
    /// The growth graph.
    pub graph: Graph<Value>,
    /// What the rules of this step want done.
    pub queue: Queue<Value>,
    /// The model's generator.
    pub random: JavaRandom,
    /// Local variables.
    pub stack: Stack,
    /// Where nodes are.
    pub poses: Poses,
    /// Buffers of searches.
    pub scratch: ScratchPool,
    /// Variables of the model, as locals of one frame.
    pub statics: Statics,
    /// Memory of texts, arrays and collections.
    pub meter: Arc<Meter>,
    /// Tables of the model by name.
    pub tables: BTreeMap<String, Arc<Object>>,
    /// Tables that `chart` was called for, and how to draw them.
    pub charts: Vec<(Arc<Object>, i32)>,
    /// The files that the model may use.
    pub files: Box<dyn ModelFiles>,
    /// What traces the light of its light models.
    pub light: Box<dyn LightSolver>,
    /// What the model has written, by place: the whole text, and its share of the memory budget.
    pub written: BTreeMap<String, (String, Charge)>,
    /// Bits of `setDerivationMode`.
    pub derivation_mode: i32,
    /// Number of the step that runs, from 1; 0 is `init`.
    pub step: u64,
    /// Whether the model has called `stop()`: no further step is made.
    pub is_finished: bool,
    /// Whether rules that are templates are applied in bulk; the result is the same.
    pub uses_templates: bool,
    /// What of the text was used since somebody last asked.
    pub trace: Trace,
    /// A step that could not be applied. The model goes on without it and fails when the entry method ends.
    failed_step: Option<Trap>,
    /// Rules that this step has applied so far, the first few, for messages.
    applied: Vec<Span>,
    limits: Limits,
    output: Output,
    stop: StopSign,
    n_ticks: u64,
    check_at: u64,
    stack_floor: usize,
}

/// Variables of the model.
#[derive(Debug, Default)]
pub struct Statics {
    /// Numbers and nodes.
    pub words: Vec<u64>,
    /// Everything else.
    pub values: Vec<Value>,
}

impl Statics {
    /// The value of a variable.
    pub fn read<T: Kind>(&self, local: Local) -> T {
        let (Local::Word(at) | Local::Value(at)) = local;
        T::read_from(&self.words, &self.values, at)
    }

    /// Sets a variable.
    pub fn write<T: Kind>(&mut self, local: Local, value: T) {
        let (Local::Word(at) | Local::Value(at)) = local;
        value.write_to(&mut self.words, &mut self.values, at);
    }
}

/// What a machine needs to begin.
pub struct Setup {
    /// Seed of the model's generator.
    pub seed: i64,
    /// Budgets.
    pub limits: Limits,
    /// Where `println` goes.
    pub output: Output,
    /// Asked now and then; true ends the run.
    pub stop: StopSign,
}

impl Machine {
    /// A machine with a graph of root and axiom.
    ///
    /// # Errors
    /// The budget has no room for the two.
    pub fn new(program: &Program, setup: Setup) -> Result<Self, Trap> {
        let limit = usize::try_from(setup.limits.nodes).unwrap_or(usize::MAX);
        Ok(Self {
            graph: Graph::new(Arc::clone(program.types()), limit)?,
            poses: Poses::default(),
            scratch: ScratchPool::default(),
            queue: Queue::default(),
            random: JavaRandom::new(setup.seed),
            stack: Stack::default(),
            statics: program.new_statics(),
            meter: Meter::new(setup.limits.memory),
            tables: BTreeMap::new(),
            charts: vec![],
            files: Box::new(NoFiles),
            light: Box::new(NoSolver),
            written: BTreeMap::new(),
            derivation_mode: DEFAULT_MODE,
            step: 0,
            is_finished: false,
            uses_templates: true,
            trace: Trace::new(program.n_methods()),
            failed_step: None,
            applied: vec![],
            limits: setup.limits,
            output: setup.output,
            stop: setup.stop,
            n_ticks: 0,
            check_at: CHECK_EVERY,
            stack_floor: 0,
        })
    }

    /// Empties the graph and forgets what is queued, for a new start of the model.
    pub fn clear(&mut self, program: &Program) -> Result<(), Trap> {
        let limit = self.graph.limit();
        self.queue = Queue::default();
        self.graph = Graph::new(Arc::clone(program.types()), limit)?;
        self.poses = Poses::default();
        self.derivation_mode = DEFAULT_MODE;
        Ok(())
    }

    /// What the model may use.
    pub fn limits(&self) -> &Limits {
        &self.limits
    }

    /// Turns counted since the step began.
    pub fn turns(&self) -> u64 {
        self.n_ticks
    }

    /// Begins a step: the count of turns starts again, and the stack of the thread that calls may grow by `stack_bytes`.
    pub fn begin(&mut self, stack_bytes: usize) {
        self.n_ticks = 0;
        self.failed_step = None;
        self.applied.clear();
        self.check_at = CHECK_EVERY;
        self.stand(stack_bytes);
    }

    /// From here on the stack of the thread that calls may grow by `stack_bytes`; the count of turns goes on.
    pub fn stand(&mut self, stack_bytes: usize) {
        self.stack_floor = stack_address().saturating_sub(stack_bytes);
    }

    /// Whether the user wants the model to stop.
    pub fn is_stopped(&self) -> bool {
        (self.stop)()
    }

    /// Prints `text` as it is.
    pub fn print(&mut self, text: &str) {
        (self.output)(text);
    }

    /// Counts a turn of the loop (or an application of the rule) at `span`.
    #[inline]
    pub fn tick(&mut self, span: Span) -> Result<(), Trap> {
        self.n_ticks += 1;
        if self.n_ticks < self.check_at {
            Ok(())
        } else {
            self.check_budget(span)
        }
    }

    /// Counts `n` nodes that the search for the pattern at `span` has tried; each is worth a turn of a loop.
    #[inline]
    pub fn spend_visits(&mut self, n: u32, span: Span) -> Result<(), Trap> {
        self.n_ticks = self.n_ticks.saturating_add(u64::from(n));
        if self.n_ticks < self.check_at || self.has_budget(span)? {
            return Ok(());
        }
        let message = format!(
            "this search does not end in time: {} nodes were tried in one step",
            self.limits.steps
        );
        let hint = "parts of a pattern that only a comma joins are tried in all combinations: join them by edges, \
                    by a label used again, or begin at a known node";
        Err(Trap::limit("step-limit", message, hint, Some(span)))
    }

    /// Counts `n` matches of the query at `span`, each tried and found.
    pub fn spend_matches(&mut self, n: usize, span: Span) -> Result<(), Trap> {
        let n = u32::try_from(n.saturating_mul(2)).unwrap_or(u32::MAX);
        self.spend_visits(n, span)
    }

    #[cold]
    fn check_budget(&mut self, span: Span) -> Result<(), Trap> {
        if self.has_budget(span)? {
            return Ok(());
        }
        let message = format!(
            "this loop does not end: {} turns and calls in one step",
            self.limits.steps
        );
        let hint = "does its condition ever become false? does a rule multiply without end?";
        Err(Trap::limit("step-limit", message, hint, Some(span)))
    }

    /// Whether turns are left; an error if the user wants an end.
    #[cold]
    fn has_budget(&mut self, span: Span) -> Result<bool, Trap> {
        self.check_at = self.n_ticks.saturating_add(CHECK_EVERY);
        if (self.stop)() {
            return Err(Trap::new(Cause::Cancelled, Some(span)));
        }
        Ok(self.n_ticks <= self.limits.steps)
    }

    /// Counts a call made at `span`, of the method `name`.
    #[inline]
    pub fn enter_call(&mut self, name: &str, span: Span) -> Result<(), Trap> {
        self.tick(span)?;
        if self.stack.depth < self.limits.depth && stack_address() > self.stack_floor {
            return Ok(());
        }
        Err(too_deep(self.stack.depth, name, span))
    }

    /// A text with its share of the memory budget.
    pub fn new_text(&self, text: String) -> Result<Value, Trap> {
        let n_bytes = text.len();
        self.check_text(n_bytes)?;
        let charge = if n_bytes > FREE_TEXT {
            self.charge(n_bytes as u64)?
        } else {
            Charge::none()
        };
        Ok(Value::Text(Arc::new(Text::new(text, charge))))
    }

    /// Refuses a text of so many bytes if that is too long.
    pub fn check_text(&self, n_bytes: usize) -> Result<(), Trap> {
        if n_bytes <= MAX_TEXT {
            return Ok(());
        }
        let message = format!("a text of {n_bytes} bytes is longer than the {MAX_TEXT} allowed");
        Err(Trap::limit(
            "text-limit",
            message,
            "does a loop append to a text without end?",
            None,
        ))
    }

    /// Queues one by one the matches that were noted in bulk, before anything that is no template is made or queued.
    pub fn settle(&mut self, span: Span) -> Result<(), Trap> {
        self.queue
            .settle(&mut self.graph)
            .map_err(|error| Trap::from(error).at(span))
    }

    /// Notes that the rule at `span` has queued something.
    pub fn note_rule(&mut self, span: Span) {
        self.trace.rules.insert(span);
        if self.applied.len() < MOST_RULES && !self.applied.contains(&span) {
            self.applied.push(span);
        }
    }

    /// Applies what the rules have queued, for the call of `derive()` (or the end of the method) at `span`.
    pub fn derive(&mut self, span: Span) -> Result<(), Trap> {
        let applied = self.queue.apply(&mut self.graph);
        let rules = std::mem::take(&mut self.applied);
        let Err(error) = applied else { return Ok(()) };
        let is_dropped = matches!(error, RewriteError::Graph(GraphError::SelfEdge));
        let trap = match error {
            RewriteError::Graph(error) => Trap::from(error),
            RewriteError::DivisionByZero => {
                Trap::exception(ClassId::ArithmeticException, "/ by zero", span)
            }
        };
        let trap = blame(trap, &rules, span);
        if !is_dropped {
            return Err(trap);
        }
        // As in GroIMP the whole step is dropped, but the method that called goes on.
        self.failed_step.get_or_insert(trap);
        Ok(())
    }

    /// The failure of a step that was dropped since the last call.
    pub fn take_failure(&mut self) -> Result<(), Trap> {
        self.failed_step.take().map_or(Ok(()), Err)
    }

    /// How rules are applied.
    pub fn mode(&self) -> Mode {
        let derivation = match self.derivation_mode & 3 {
            2 => Derivation::Sequential,
            3 => Derivation::SequentialRandom,
            _ => Derivation::Parallel,
        };
        Mode {
            derivation,
            excludes_consumed: self.derivation_mode & EXCLUDE_DELETED != 0,
        }
    }

    /// What a fault of the graph means to the model that used `node` at `span`.
    #[cold]
    pub fn graph_trap(&self, error: &GraphError, node: NodeId, span: Span) -> Trap {
        match error {
            GraphError::DeletedNode => {
                let message = format!(
                    "{} was removed from the graph in an earlier step",
                    self.node_name(node)
                );
                Trap::exception(ClassId::IllegalStateException, message, span)
            }
            other => Trap::from(other.clone()).at(span),
        }
    }

    /// A share of the memory budget.
    pub fn charge(&self, bytes: u64) -> Result<Charge, Trap> {
        self.meter
            .charge(bytes)
            .map_err(|over| Trap::memory(over, None))
    }

    /// Appends the text of any value, nodes by type and number.
    pub fn append_text(&self, value: &Value, out: &mut String) {
        match value {
            Value::Node(node) => out.push_str(&self.node_name(*node)),
            other => other.append_to(out),
        }
    }

    /// Type and number of a node, for messages: `Bud[12]`.
    pub fn node_name(&self, node: NodeId) -> String {
        match self.graph.type_of(node) {
            Ok(ty) => format!("{}[{}]", self.graph.types()[ty].name, node.index()),
            Err(_) => format!("deleted node [{}]", node.index()),
        }
    }
}

/// A step failed as a whole, at `span`, after these rules were applied.
#[cold]
fn blame(trap: Trap, rules: &[Span], span: Span) -> Trap {
    let doing = "while the new graph was made, at {place}".to_owned();
    let trap = match rules {
        [] => trap.at(span),
        [rule] => trap.at(*rule),
        rules => {
            let trap = trap.at(span);
            rules.iter().fold(trap, |trap, rule| {
                trap.pointing(*rule, "one of the rules of this step")
            })
        }
    };
    trap.during(doing, Some(span))
}

#[cold]
fn too_deep(depth: u32, name: &str, span: Span) -> Trap {
    let message = format!("method `{name}` is called {depth} deep");
    let hint = "a method that calls itself needs a condition under which it stops";
    Trap::limit("recursion-limit", message, hint, Some(span))
}

/// About where the stack of this thread stands.
fn stack_address() -> usize {
    let here = 0_u8;
    std::ptr::from_ref(std::hint::black_box(&here)) as usize
}

/// An exception with the text Java gives an index that is out of bounds.
pub fn out_of_bounds(class: ClassId, index: i64, length: usize, span: Span) -> Trap {
    Trap::exception(
        class,
        format!("Index {index} out of bounds for length {length}"),
        span,
    )
}
