//! Edges: at most one between two nodes in each direction, a set of bits; lists in order of insertion on both sides.

use super::arena::NIL;
use super::links::Links;
use super::pattern::EdgeKind;
use super::store::{Graph, GraphError, INSERTED};
use super::{NodeId, Payload};

/// What an edge is: one or several kinds at once.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash, Default, PartialOrd, Ord)]
pub struct EdgeBits(u32);

impl EdgeBits {
    /// No edge.
    pub const NONE: Self = Self(0);
    /// Successor, `>` or a blank.
    pub const SUCCESSOR: Self = Self(1 << 21);
    /// Branch, `+>` or `[`.
    pub const BRANCH: Self = Self(1 << 22);
    /// Refinement, `/>`.
    pub const REFINEMENT: Self = Self(1 << 23);
    /// Every kind.
    pub const ALL: Self = Self(u32::MAX);

    /// The bits of an edge of this kind; patterns like `-ancestor->` allow every kind.
    pub fn of(kind: EdgeKind) -> Self {
        match kind {
            EdgeKind::Successor => Self::SUCCESSOR,
            EdgeKind::Branch => Self::BRANCH,
            EdgeKind::Refinement => Self::REFINEMENT,
            EdgeKind::User(n) => Self(1 << n.min(20)),
            EdgeKind::Any
            | EdgeKind::Ancestor
            | EdgeKind::MinDescendants
            | EdgeKind::Descendants
            | EdgeKind::Walk(_)
            | EdgeKind::Relation(_) => Self::ALL,
        }
    }

    /// Whether the two have a kind in common.
    pub fn intersects(self, other: Self) -> bool {
        self.0 & other.0 != 0
    }

    /// Kinds of either.
    #[must_use]
    pub fn union(self, other: Self) -> Self {
        Self(self.0 | other.0)
    }

    /// Kinds of both.
    #[must_use]
    pub fn intersection(self, other: Self) -> Self {
        Self(self.0 & other.0)
    }

    /// Kinds of `self` that `other` has not.
    #[must_use]
    pub fn without(self, other: Self) -> Self {
        Self(self.0 & !other.0)
    }

    /// The kinds as a number, for hashes.
    pub fn number(self) -> u32 {
        self.0
    }

    pub(super) fn from_number(number: u32) -> Self {
        Self(number)
    }
}

impl<O: Payload> Graph<O> {
    /// Adds kinds to the edge from `from` to `to`, which is made (at the end of both lists) if it is not there.
    pub fn add_edge(&mut self, from: NodeId, to: NodeId, bits: EdgeBits) -> Result<(), GraphError> {
        let (source, target) = (self.live_index(from)?, self.live_index(to)?);
        if source == target {
            return Err(GraphError::SelfEdge);
        }
        if bits == EdgeBits::NONE {
            return Ok(());
        }
        if !self.links.has_room() {
            return Err(GraphError::TooManyNodes {
                limit: self.limit(),
            });
        }
        self.touch(self.nodes[source].flags & INSERTED != 0);
        let nodes = &mut self.nodes;
        match self.links.find(nodes, source as u32, target as u32) {
            Some(at) => {
                let bits = self.links.bits(nodes, at).union(bits);
                self.links.set_bits(nodes, at, bits);
            }
            None => self.links.add(nodes, source as u32, target as u32, bits),
        }
        Ok(())
    }

    /// Takes kinds from the edge from `from` to `to`; an edge without kinds is gone.
    pub fn remove_edge(&mut self, from: NodeId, to: NodeId, bits: EdgeBits) {
        let (Ok(source), Ok(target)) = (self.live_index(from), self.live_index(to)) else {
            return;
        };
        let Some(at) = self.find_edge(source, target) else {
            return;
        };
        let left = self.links.bits(&self.nodes, at).without(bits);
        if left == EdgeBits::NONE {
            self.drop_edge(at);
        } else {
            self.links.set_bits(&mut self.nodes, at, left);
        }
        self.touch(true);
    }

    /// The kinds of the edge from `from` to `to`; none if there is no edge.
    pub fn edge_bits(&self, from: NodeId, to: NodeId) -> EdgeBits {
        let (Ok(source), Ok(target)) = (self.live_index(from), self.live_index(to)) else {
            return EdgeBits::NONE;
        };
        let edge = self.find_edge(source, target);
        edge.map_or(EdgeBits::NONE, |at| self.links.bits(&self.nodes, at))
    }

    /// Edges that leave a node, with the nodes they lead to, in order of insertion. Nothing for a deleted node.
    pub fn out_edges(&self, node: NodeId) -> OutEdges<'_, O> {
        let at = self
            .live_index(node)
            .map_or(NIL, |i| self.nodes[i].first_out);
        OutEdges { graph: self, at }
    }

    /// Edges that lead to a node, with the nodes they come from, in order of insertion. Nothing for a deleted node.
    pub fn in_edges(&self, node: NodeId) -> InEdges<'_, O> {
        let at = self
            .live_index(node)
            .map_or(NIL, |i| Links::first_in(&self.nodes, i as u32));
        InEdges { graph: self, at }
    }

    /// The node whose frame a node inherits: the source of its first incoming successor or branch edge. The root has none, even
    /// where a rule has led an edge back to it: all frames begin there.
    pub fn predecessor(&self, node: NodeId) -> Option<(NodeId, EdgeBits)> {
        if node == self.root() {
            return None;
        }
        let carries = EdgeBits::SUCCESSOR.union(EdgeBits::BRANCH);
        self.in_edges(node)
            .find(|(_, bits)| bits.intersects(carries))
    }

    /// Whether every node has at most one parent and the root none, so that no walk along the edges meets a node twice.
    /// (Rings that hang on nothing are gone by then, see [`Graph::end_of_step`].)
    pub fn is_forest(&self) -> bool {
        self.links.is_single() && self.nodes[self.root().index()].link.from == NIL
    }

    /// Number of edges.
    pub fn n_edges(&self) -> usize {
        self.links.n_edges
    }

    fn find_edge(&self, source: usize, target: usize) -> Option<u32> {
        self.links.find(&self.nodes, source as u32, target as u32)
    }

    fn drop_edge(&mut self, at: u32) {
        let target = self.links.target(at) as usize;
        self.links.remove(&mut self.nodes, at);
        self.nominate_loser(target);
    }

    pub(super) fn remove_all_edges(&mut self, index: usize) {
        while self.nodes[index].first_out != NIL {
            self.drop_edge(self.nodes[index].first_out);
        }
        while self.nodes[index].link.from != NIL {
            self.drop_edge(index as u32);
        }
    }
}

/// Outgoing edges of a node.
#[derive(Debug)]
pub struct OutEdges<'a, O> {
    graph: &'a Graph<O>,
    at: u32,
}

impl<O: Payload> Iterator for OutEdges<'_, O> {
    type Item = (NodeId, EdgeBits);

    fn next(&mut self) -> Option<Self::Item> {
        if self.at == NIL {
            return None;
        }
        let (links, nodes) = (&self.graph.links, &self.graph.nodes);
        let at = self.at;
        self.at = links.link(nodes, at).next_out;
        let target = self.graph.id(links.target(at) as usize);
        Some((target, links.bits(nodes, at)))
    }
}

/// Incoming edges of a node.
#[derive(Debug)]
pub struct InEdges<'a, O> {
    graph: &'a Graph<O>,
    at: u32,
}

impl<O: Payload> Iterator for InEdges<'_, O> {
    type Item = (NodeId, EdgeBits);

    fn next(&mut self) -> Option<Self::Item> {
        if self.at == NIL {
            return None;
        }
        let (links, nodes) = (&self.graph.links, &self.graph.nodes);
        let at = self.at;
        self.at = links.next_in(nodes, at);
        let source = self.graph.id(links.link(nodes, at).from as usize);
        Some((source, links.bits(nodes, at)))
    }
}
