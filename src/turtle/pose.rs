//! Where a node is: `location`, `direction` and their kin, without drawing anything.
//!
//! A node's frame is its predecessor's after that one's move. Asking for a node walks up to the nearest ancestor whose
//! state is known and comes back down. One state in eight on the way is kept, so asking for all nodes of a chain
//! costs eight steps each at most, and memory stays far below that of the graph.

use super::reading::{action, dress, is_transforming, own_transform};
use super::state::TurtleState;
use crate::graph::{EdgeBits, Graph, GraphError, NodeId, Payload};
use glam::DVec3;

/// Steps between two states that are kept.
const STRIDE: usize = 8;
/// How many `RN` may wait for each other's targets; beyond that they do not turn.
const MAX_NESTING: usize = 16;

/// The states of nodes, remembered until something moves.
#[derive(Clone, Debug, Default)]
pub struct Poses {
    /// The graph's shape stamp these states belong to.
    stamp: u64,
    /// Counts the stamps seen; entries of other epochs are void.
    epoch: u32,
    /// By node place: epoch and number in `states`.
    index: Vec<(u32, u32)>,
    /// States that the children of nodes start from.
    states: Vec<TurtleState>,
    /// The last one asked for.
    recent: Option<(NodeId, TurtleState)>,
    /// Room for the way up.
    way: Vec<(NodeId, EdgeBits)>,
    nesting: usize,
}

impl Poses {
    /// The state a node is drawn with: after its predecessor, with its own transformation applied.
    ///
    /// # Errors
    /// The node was deleted.
    pub fn at<O: Payload>(
        &mut self,
        graph: &Graph<O>,
        node: NodeId,
    ) -> Result<TurtleState, GraphError> {
        graph.type_of(node)?;
        self.forget_what_moved(graph);
        let mut state = match graph.predecessor(node) {
            Some((predecessor, bits)) => {
                let mut state = self.state_after(graph, predecessor);
                follow(&mut state, bits);
                state
            }
            None => TurtleState::default(),
        };
        apply_own_transform(graph, node, &mut state);
        Ok(state)
    }

    /// The state a node's children start from.
    ///
    /// # Errors
    /// The node was deleted.
    pub fn after<O: Payload>(
        &mut self,
        graph: &Graph<O>,
        node: NodeId,
    ) -> Result<TurtleState, GraphError> {
        graph.type_of(node)?;
        self.forget_what_moved(graph);
        Ok(self.state_after(graph, node))
    }

    /// Where a node is, in metres of the world.
    ///
    /// # Errors
    /// The node was deleted.
    pub fn location<O: Payload>(
        &mut self,
        graph: &Graph<O>,
        node: NodeId,
    ) -> Result<DVec3, GraphError> {
        Ok(self.at(graph, node)?.position())
    }

    fn forget_what_moved<O: Payload>(&mut self, graph: &Graph<O>) {
        if self.stamp == graph.shape_stamp() && self.epoch != 0 {
            return;
        }
        self.stamp = graph.shape_stamp();
        self.states.clear();
        self.recent = None;
        self.epoch = self.epoch.wrapping_add(1);
        if self.epoch == 0 {
            self.index.clear();
            self.epoch = 1;
        }
    }

    fn known(&self, node: NodeId) -> Option<TurtleState> {
        if let Some((recent, state)) = &self.recent
            && *recent == node
        {
            return Some(*state);
        }
        let &(epoch, number) = self.index.get(node.index())?;
        let is_valid = epoch == self.epoch;
        is_valid
            .then(|| self.states.get(number as usize).copied())
            .flatten()
    }

    fn keep(&mut self, node: NodeId, state: &TurtleState) {
        let Ok(number) = u32::try_from(self.states.len()) else {
            return;
        };
        if self.index.len() <= node.index() {
            self.index.resize(node.index() + 1, (0, 0));
        }
        self.index[node.index()] = (self.epoch, number);
        self.states.push(*state);
    }

    fn state_after<O: Payload>(&mut self, graph: &Graph<O>, node: NodeId) -> TurtleState {
        // Up to the nearest known state. A ring of edges has no root; its end is taken to be where the walk began.
        let mut way = std::mem::take(&mut self.way);
        way.clear();
        let mut at = Some((node, EdgeBits::NONE));
        let mut state = TurtleState::default();
        while let Some((node, _)) = at {
            if let Some(known) = self.known(node) {
                state = known;
                break;
            }
            let predecessor = graph.predecessor(node);
            way.push((node, predecessor.map_or(EdgeBits::NONE, |(_, bits)| bits)));
            at = predecessor.filter(|_| way.len() <= graph.n_nodes());
        }

        // Down again.
        for (i, &(node, bits)) in way.iter().rev().enumerate() {
            follow(&mut state, bits);
            let before = state.transform;
            apply_own_transform(graph, node, &mut state);
            dress(graph, node, &mut state);
            let does = action(graph, node, &mut |target| self.locate(graph, target));
            state.execute(&does);
            if !is_transforming(graph, node) {
                state.transform = before;
            }
            if (i + 1).is_multiple_of(STRIDE) {
                self.keep(node, &state);
            }
        }
        self.recent = Some((node, state));
        self.way = way;
        state
    }

    /// Where the target of an `RN` is, if that does not depend on too many others.
    fn locate<O: Payload>(&mut self, graph: &Graph<O>, node: NodeId) -> Option<DVec3> {
        if self.nesting >= MAX_NESTING {
            return None;
        }
        self.nesting += 1;
        let found = self.location(graph, node).ok();
        self.nesting -= 1;
        found
    }
}

/// What an edge does to the turtle that follows it.
pub fn follow(state: &mut TurtleState, bits: EdgeBits) {
    if bits.intersects(EdgeBits::BRANCH) {
        state.enter_branch();
    }
}

/// Applies a node's own transformation, if it has one.
pub fn apply_own_transform<O: Payload>(graph: &Graph<O>, node: NodeId, state: &mut TurtleState) {
    if let Some(own) = own_transform(graph, node) {
        state.transform *= own;
    }
}

#[cfg(test)]
mod tests;
