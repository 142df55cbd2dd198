//! What a step wants done, collected until [`Queue::apply`] does it all at once.

use super::deferred::Assignment;
use super::env::Flow;
use super::producer::Frame;
use crate::graph::{Batch, EdgeBits, Graph, GraphError, NodeId, Payload};

/// What can go wrong when a step is applied; each is the model's fault.
#[derive(Clone, Debug, PartialEq, Eq, thiserror::Error)]
pub enum RewriteError {
    /// A node is gone, there are too many, or an edge would lead to its own node.
    #[error(transparent)]
    Graph(#[from] GraphError),
    /// A deferred `:/=` or `:%=` of an integer field by 0.
    #[error("/ by zero")]
    DivisionByZero,
}

/// How many matches a step applies.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Default)]
pub enum Derivation {
    /// All.
    #[default]
    Parallel,
    /// One: the first match of the first rule that has any.
    Sequential,
    /// One, drawn from all matches of all rules.
    SequentialRandom,
}

/// The derivation mode.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Mode {
    /// How many matches a step applies.
    pub derivation: Derivation,
    /// Whether nodes that a rule has consumed are out of reach for later rules of the step.
    pub excludes_consumed: bool,
}

impl Default for Mode {
    fn default() -> Self {
        Self {
            derivation: Derivation::Parallel,
            excludes_consumed: true,
        }
    }
}

impl Mode {
    /// Whether a search goes on after a match, applied or not.
    pub fn after_match(self) -> Flow {
        match self.derivation {
            Derivation::Sequential => Flow::Stop,
            Derivation::Parallel | Derivation::SequentialRandom => Flow::Continue,
        }
    }
}

/// How a node of the right-hand side inherits edges of the left-hand side.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Connection {
    /// What leads to `source` shall lead to `target`; as a branch if `as_branch`.
    Incoming {
        source: NodeId,
        target: NodeId,
        as_branch: bool,
    },
    /// What `source` leads to, `target` shall lead to.
    Outgoing { source: NodeId, target: NodeId },
    /// What `end` leads to shall hang on the predecessor of `start`.
    Adjacent { start: NodeId, end: NodeId },
}

/// An edge that shall be or not be.
pub(super) type EdgeRequest = (NodeId, NodeId, EdgeBits);

/// The operations of a step. `O` is what object fields hold.
#[derive(Debug)]
pub struct Queue<O> {
    /// New nodes, in the order in which queries of the next step find them.
    pub(super) born: Vec<NodeId>,
    /// New nodes that nothing leads to.
    pub(super) strays: Vec<NodeId>,
    pub(super) connections: Vec<Connection>,
    pub(super) new_edges: Vec<EdgeRequest>,
    pub(super) new_undirected: Vec<EdgeRequest>,
    pub(super) dead_edges: Vec<EdgeRequest>,
    pub(super) dead_nodes: Vec<NodeId>,
    pub(super) assignments: Vec<Assignment<O>>,
    /// Right-hand sides under way, the innermost last; those from `depth` on are kept for reuse.
    pub(super) frames: Vec<Frame>,
    pub(super) depth: usize,
    /// Where the operations of the one match of a sequential step begin, and how many matches were offered so far.
    chosen: Option<(Mark, i32)>,
    pub(super) buffers: super::apply::Buffers,
    /// Matches noted in bulk; all came before anything else that is queued.
    pub(super) batches: Vec<Batch>,
    /// New nodes and words that they will need.
    pub(super) n_noted_nodes: usize,
    pub(super) n_noted_words: usize,
}

impl<O> Default for Queue<O> {
    fn default() -> Self {
        Self {
            born: vec![],
            strays: vec![],
            connections: vec![],
            new_edges: vec![],
            new_undirected: vec![],
            dead_edges: vec![],
            dead_nodes: vec![],
            assignments: vec![],
            frames: vec![],
            depth: 0,
            chosen: None,
            buffers: super::apply::Buffers::default(),
            batches: vec![],
            n_noted_nodes: 0,
            n_noted_words: 0,
        }
    }
}

/// How long each list was at some moment.
#[derive(Clone, Copy, Debug)]
struct Mark([usize; 7]);

impl<O: Payload> Queue<O> {
    /// Whether there is nothing to do.
    pub fn is_empty(&self) -> bool {
        self.has_no_operations() && self.batches.is_empty()
    }

    /// Whether nothing is queued but matches noted in bulk.
    pub(super) fn has_no_operations(&self) -> bool {
        self.mark().0.iter().all(|&n| n == 0) && self.assignments.is_empty()
    }

    /// Whether the match just found shall be applied; asked before [`Queue::begin`]. In random sequential mode a later
    /// match may take the place of an earlier one: match number n with probability 1/n. `next_int(n)` draws from 0..n.
    pub fn admit(
        &mut self,
        graph: &mut Graph<O>,
        mode: Mode,
        mut next_int: impl FnMut(i32) -> i32,
    ) -> bool {
        if mode.derivation == Derivation::Parallel {
            return true;
        }
        let Some((mark, n_offered)) = self.chosen else {
            self.chosen = Some((self.mark(), 1));
            return true;
        };
        let n_offered = n_offered + 1;
        self.chosen = Some((mark, n_offered));
        if mode.derivation == Derivation::Sequential || next_int(n_offered) > 0 {
            return false;
        }
        self.reset_to(mark, graph);
        true
    }

    /// Queues a deferred assignment.
    pub fn defer(&mut self, assignment: Assignment<O>) {
        self.assignments.push(assignment);
    }

    /// Forgets all that is queued, and right-hand sides under way; new nodes are freed.
    pub fn clear(&mut self, graph: &mut Graph<O>) {
        self.depth = 0;
        self.clear_operations(graph);
    }

    /// Forgets all that is queued; right-hand sides under way go on.
    pub(super) fn clear_operations(&mut self, graph: &mut Graph<O>) {
        for batch in self.take_batches() {
            for &node in &batch.matched {
                graph.forget_consumed(node);
            }
        }
        self.reset_to(Mark([0; 7]), graph);
        self.assignments.clear();
        self.chosen = None;
    }

    fn mark(&self) -> Mark {
        Mark([
            self.born.len(),
            self.strays.len(),
            self.connections.len(),
            self.new_edges.len(),
            self.new_undirected.len(),
            self.dead_edges.len(),
            self.dead_nodes.len(),
        ])
    }

    fn reset_to(&mut self, mark: Mark, graph: &mut Graph<O>) {
        let [
            born,
            strays,
            connections,
            new_edges,
            new_undirected,
            dead_edges,
            dead_nodes,
        ] = mark.0;
        for node in self.born.drain(born..).chain(self.strays.drain(strays..)) {
            graph.discard(node);
        }
        for node in self.dead_nodes.drain(dead_nodes..) {
            graph.forget_consumed(node);
        }
        self.connections.truncate(connections);
        self.new_edges.truncate(new_edges);
        self.new_undirected.truncate(new_undirected);
        self.dead_edges.truncate(dead_edges);
    }

    /// Notes a new node that something will lead to; its place in the extent is the order of these notes.
    pub(super) fn mention(&mut self, graph: &mut Graph<O>, node: NodeId) {
        if graph.mark_queued(node) {
            self.born.push(node);
        }
    }
}
