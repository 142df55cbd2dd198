//! What a search needs of the language, and what it gives back.

use super::search::ScratchPool;
use crate::graph::{FieldId, Graph, GraphError, NodeId, Payload};

/// Whether a search goes on.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Flow {
    /// To the next match.
    Continue,
    /// No more matches are wanted.
    Stop,
}

/// What a search needs of the language. `E` is an expression.
///
/// Any of the callbacks may change the graph, even apply a step: candidates that vanished are skipped.
pub trait MatchEnv<E> {
    /// What object fields hold.
    type Object: Payload;
    /// What can go wrong in an expression.
    type Error: From<GraphError>;

    /// The graph as it is now.
    fn graph(&self) -> &Graph<Self::Object>;

    /// Takes note of so many candidates tried and nodes visited. An error ends the search: a pattern whose parts no edge
    /// joins has as many candidates as the product of their numbers.
    fn spend(&mut self, n_visits: u32) -> Result<(), Self::Error>;

    /// Buffers that searches share.
    fn scratch(&mut self) -> &mut ScratchPool;

    /// Stores a matched node in a local variable; none where a part of the pattern that may be missing is.
    fn bind_node(&mut self, slot: u16, node: Option<NodeId>);

    /// Stores a field of a matched node in a local variable.
    fn bind_field(&mut self, slot: u16, node: NodeId, field: FieldId) -> Result<(), Self::Error>;

    /// Whether a field has the value of an expression, compared in the field's type.
    fn field_equals(
        &mut self,
        node: NodeId,
        field: FieldId,
        value: &E,
    ) -> Result<bool, Self::Error>;

    /// The value of a condition.
    fn condition(&mut self, condition: &E) -> Result<bool, Self::Error>;

    /// The node an expression gives; `None` for null.
    fn node_value(&mut self, value: &E) -> Result<Option<NodeId>, Self::Error>;
}

/// What is done with a match.
pub type Found<'f, M, E> = dyn FnMut(&mut M, &Match<'_>) -> Result<Flow, E> + 'f;

/// A match of a pattern.
#[derive(Clone, Copy, Debug)]
pub struct Match<'m> {
    pub(super) nodes: &'m [NodeId],
    pub(super) is_bound: &'m [bool],
    /// For each pattern node the earlier one it stands for, or itself.
    pub(super) meant: &'m [usize],
}

impl<'m> Match<'m> {
    /// The graph's node for each pattern node; where an optional part is missing, some node to which no edge of the pattern
    /// leads.
    pub fn nodes(&self) -> &'m [NodeId] {
        self.nodes
    }

    /// The graph's node for a pattern node; none where an optional part is missing.
    pub fn node(&self, index: usize) -> Option<NodeId> {
        let is_bound = *self.is_bound.get(*self.meant.get(index)?)?;
        self.nodes.get(index).copied().filter(|_| is_bound)
    }
}
