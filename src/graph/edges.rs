//! Edges: at most one between two nodes in each direction, a set of bits; lists in order of insertion on both sides.

use super::arena::NIL;
use super::pattern::EdgeKind;
use super::store::{Graph, GraphError, Header, INSERTED};
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
            | EdgeKind::Descendants => Self::ALL,
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
}

/// An edge in the arena. In each list, `next` of the last edge is [`NIL`] and `previous` of the first is the last.
#[derive(Clone, Copy, Debug)]
pub(super) struct Edge {
    pub(super) from: u32,
    pub(super) to: u32,
    /// 0 in vacant places.
    pub(super) bits: EdgeBits,
    pub(super) next_out: u32,
    pub(super) previous_out: u32,
    pub(super) next_in: u32,
    pub(super) previous_in: u32,
}

/// All edges; vacant ones are chained through `next_out`.
#[derive(Clone, Debug)]
pub(super) struct EdgeArena {
    pub(super) edges: Vec<Edge>,
    free: u32,
    n_free: usize,
    /// Number of nodes with two or more incoming edges.
    n_shared: usize,
}

impl Default for EdgeArena {
    fn default() -> Self {
        Self {
            edges: vec![],
            free: NIL,
            n_free: 0,
            n_shared: 0,
        }
    }
}

impl EdgeArena {
    fn allocate(&mut self, edge: Edge) -> u32 {
        if self.free == NIL {
            self.edges.push(edge);
            return (self.edges.len() - 1) as u32;
        }
        let at = self.free;
        self.free = self.edges[at as usize].next_out;
        self.n_free -= 1;
        self.edges[at as usize] = edge;
        at
    }

    fn release(&mut self, at: u32) {
        let edge = &mut self.edges[at as usize];
        (edge.bits, edge.next_out) = (EdgeBits::NONE, self.free);
        self.free = at;
        self.n_free += 1;
    }

    pub(super) fn len(&self) -> usize {
        self.edges.len() - self.n_free
    }

    pub(super) fn memory(&self) -> usize {
        size_of::<Edge>() * self.edges.len()
    }

    /// Appends edge `at` to the lists of both its ends.
    fn link(&mut self, at: u32, nodes: &mut [Header]) {
        let Edge { from, to, .. } = self.edges[at as usize];
        let first = &mut nodes[from as usize].first_out;
        if *first == NIL {
            *first = at;
            self.edges[at as usize].previous_out = at;
        } else {
            let last = std::mem::replace(&mut self.edges[*first as usize].previous_out, at);
            self.edges[last as usize].next_out = at;
            self.edges[at as usize].previous_out = last;
        }
        let first = &mut nodes[to as usize].first_in;
        if *first == NIL {
            *first = at;
            self.edges[at as usize].previous_in = at;
        } else {
            let last = std::mem::replace(&mut self.edges[*first as usize].previous_in, at);
            self.n_shared += usize::from(last == *first);
            self.edges[last as usize].next_in = at;
            self.edges[at as usize].previous_in = last;
        }
    }

    /// Takes edge `at` out of the lists of both its ends.
    fn unlink(&mut self, at: u32, nodes: &mut [Header]) {
        let Edge {
            from,
            to,
            next_out,
            previous_out,
            next_in,
            previous_in,
            ..
        } = self.edges[at as usize];
        let first = &mut nodes[from as usize].first_out;
        if next_out == NIL {
            self.edges[*first as usize].previous_out = previous_out;
        } else {
            self.edges[next_out as usize].previous_out = previous_out;
        }
        if *first == at {
            *first = next_out;
        } else {
            self.edges[previous_out as usize].next_out = next_out;
        }
        let first = &mut nodes[to as usize].first_in;
        if next_in == NIL {
            self.edges[*first as usize].previous_in = previous_in;
        } else {
            self.edges[next_in as usize].previous_in = previous_in;
        }
        if *first == at {
            *first = next_in;
        } else {
            self.edges[previous_in as usize].next_in = next_in;
        }
        let is_single = *first != NIL && self.edges[*first as usize].next_in == NIL;
        self.n_shared -= usize::from(is_single);
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
        self.touch(self.nodes[source].flags & INSERTED != 0);
        if let Some(at) = self.find_edge(source, target) {
            let edge = &mut self.edges.edges[at as usize];
            edge.bits = edge.bits.union(bits);
            return Ok(());
        }
        let edge = Edge {
            from: source as u32,
            to: target as u32,
            bits,
            next_out: NIL,
            previous_out: NIL,
            next_in: NIL,
            previous_in: NIL,
        };
        let at = self.edges.allocate(edge);
        self.edges.link(at, &mut self.nodes);
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
        let edge = &mut self.edges.edges[at as usize];
        edge.bits = edge.bits.without(bits);
        if edge.bits == EdgeBits::NONE {
            self.drop_edge(at);
        }
        self.touch(true);
    }

    /// The kinds of the edge from `from` to `to`; none if there is no edge.
    pub fn edge_bits(&self, from: NodeId, to: NodeId) -> EdgeBits {
        let (Ok(source), Ok(target)) = (self.live_index(from), self.live_index(to)) else {
            return EdgeBits::NONE;
        };
        let edge = self.find_edge(source, target);
        edge.map_or(EdgeBits::NONE, |at| self.edges.edges[at as usize].bits)
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
            .map_or(NIL, |i| self.nodes[i].first_in);
        InEdges { graph: self, at }
    }

    /// The node whose frame a node inherits: the source of its first incoming successor or branch edge.
    pub fn predecessor(&self, node: NodeId) -> Option<(NodeId, EdgeBits)> {
        let carries = EdgeBits::SUCCESSOR.union(EdgeBits::BRANCH);
        self.in_edges(node)
            .find(|(_, bits)| bits.intersects(carries))
    }

    /// Whether every node has at most one parent and the root none, so that no walk along the edges meets a node twice.
    /// (Rings that hang on nothing are gone by then, see [`Graph::end_of_step`].)
    pub fn is_forest(&self) -> bool {
        self.edges.n_shared == 0 && self.nodes[self.root().index()].first_in == NIL
    }

    /// Number of edges.
    pub fn n_edges(&self) -> usize {
        self.edges.len()
    }

    /// Looks through both lists in turn, so that one long list does no harm.
    fn find_edge(&self, source: usize, target: usize) -> Option<u32> {
        let edges = &self.edges.edges;
        let (mut out, mut back) = (self.nodes[source].first_out, self.nodes[target].first_in);
        while out != NIL && back != NIL {
            let (a, b) = (&edges[out as usize], &edges[back as usize]);
            if a.to as usize == target {
                return Some(out);
            }
            if b.from as usize == source {
                return Some(back);
            }
            (out, back) = (a.next_out, b.next_in);
        }
        None
    }

    fn drop_edge(&mut self, at: u32) {
        let target = self.edges.edges[at as usize].to as usize;
        self.edges.unlink(at, &mut self.nodes);
        self.edges.release(at);
        self.nominate_loser(target);
    }

    pub(super) fn remove_all_edges(&mut self, index: usize) {
        while self.nodes[index].first_out != NIL {
            self.drop_edge(self.nodes[index].first_out);
        }
        while self.nodes[index].first_in != NIL {
            self.drop_edge(self.nodes[index].first_in);
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
        let edge = self.graph.edges.edges.get(self.at as usize)?;
        self.at = edge.next_out;
        Some((self.graph.id(edge.to as usize), edge.bits))
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
        let edge = self.graph.edges.edges.get(self.at as usize)?;
        self.at = edge.next_in;
        Some((self.graph.id(edge.from as usize), edge.bits))
    }
}
