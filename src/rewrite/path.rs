//! Following an edge of a pattern through the graph: one edge, a closure of edges, or to the nearest nodes of a type.

use crate::graph::pattern::{EdgeKind, EdgeWay, PatternEdge};
use crate::graph::{EdgeBits, Graph, NodeId, Payload, TypeId};
use std::collections::HashSet;

/// A node to be visited and its distance in edges.
pub(super) type Open = (NodeId, u32);

/// How to get from one end of a pattern edge to the other.
#[derive(Clone, Copy, Debug)]
pub(super) struct Path<'p> {
    edge: &'p PatternEdge,
    way: EdgeWay,
    /// Whether the path is walked from the edge's far end to the node it starts from.
    is_against_arrow: bool,
    /// Type of the node the arrow points to (nearest nodes of a type).
    target: Option<TypeId>,
}

/// What to do with a node on a path.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) struct Visit {
    pub(super) is_found: bool,
    pub(super) goes_on: bool,
}

impl<'p> Path<'p> {
    /// The path of `edge` from its left node to its right one, or the other way round. `left` and `right` are the types of
    /// the two.
    pub(super) fn new(
        edge: &'p PatternEdge,
        is_reversed: bool,
        left: Option<TypeId>,
        right: Option<TypeId>,
    ) -> Self {
        let way = match (edge.way, is_reversed) {
            (EdgeWay::Forward, true) | (EdgeWay::Backward, false) => EdgeWay::Backward,
            (EdgeWay::Backward, true) | (EdgeWay::Forward, false) => EdgeWay::Forward,
            (other, _) => other,
        };
        let target = if edge.way == EdgeWay::Backward {
            left
        } else {
            right
        };
        Self {
            edge,
            way,
            is_against_arrow: way == EdgeWay::Backward,
            target,
        }
    }

    /// Whether at most one edge is walked.
    pub(super) fn is_single(&self) -> bool {
        is_single_edge(self.edge)
    }

    /// Puts the first nodes of the path on `stack`, the one to visit first on top.
    pub(super) fn begin<O: Payload>(&self, graph: &Graph<O>, from: NodeId, stack: &mut Vec<Open>) {
        if self.edge.repeat.0 == 0 {
            stack.push((from, 0));
        } else {
            self.go_on(graph, (from, 0), stack);
        }
    }

    /// What a node on the path means.
    pub(super) fn visit<O: Payload>(&self, graph: &Graph<O>, (node, distance): Open) -> Visit {
        let is_target = || self.target.is_none_or(|ty| graph.is_a(node, ty));
        match self.edge.kind {
            EdgeKind::Ancestor | EdgeKind::MinDescendants => {
                let is_target = is_target();
                Visit {
                    is_found: is_target || self.is_against_arrow,
                    goes_on: !is_target,
                }
            }
            EdgeKind::Descendants => Visit {
                is_found: true,
                goes_on: true,
            },
            EdgeKind::Any
            | EdgeKind::Successor
            | EdgeKind::Branch
            | EdgeKind::Refinement
            | EdgeKind::User(_) => {
                let (least, most) = self.edge.repeat;
                Visit {
                    is_found: distance >= least,
                    goes_on: most.is_none_or(|most| distance < most),
                }
            }
        }
    }

    /// Puts the nodes one edge further on `stack`.
    pub(super) fn go_on<O: Payload>(
        &self,
        graph: &Graph<O>,
        (node, distance): Open,
        stack: &mut Vec<Open>,
    ) {
        let bits = EdgeBits::of(self.edge.kind);
        let base = stack.len();
        let next = distance + 1;
        let fits = |&(_, b): &(NodeId, EdgeBits)| b.intersects(bits);
        let way = match (self.edge.kind, self.way) {
            (EdgeKind::Ancestor, EdgeWay::Forward) => EdgeWay::Backward,
            (EdgeKind::Ancestor, EdgeWay::Backward) => EdgeWay::Forward,
            (_, way) => way,
        };
        if matches!(way, EdgeWay::Backward | EdgeWay::Undirected) {
            stack.extend(graph.in_edges(node).filter(fits).map(|(n, _)| (n, next)));
        }
        if way != EdgeWay::Backward {
            let is_mutual = |&(other, _): &(NodeId, EdgeBits)| {
                way != EdgeWay::Both || graph.edge_bits(other, node).intersects(bits)
            };
            let out = graph.out_edges(node).filter(fits).filter(is_mutual);
            stack.extend(out.map(|(n, _)| (n, next)));
        }
        // `-descendants->` visits later children first.
        if self.edge.kind != EdgeKind::Descendants {
            stack[base..].reverse();
        }
    }

    /// Whether the path from `from` leads to `to`; adds the nodes visited to `n_visits`.
    pub(super) fn reaches<O: Payload>(
        &self,
        graph: &Graph<O>,
        from: NodeId,
        to: NodeId,
        stack: &mut Vec<Open>,
        n_visits: &mut usize,
    ) -> bool {
        let base = stack.len();
        let mut visited = Visited::new(graph, self);
        self.begin(graph, from, stack);
        let mut is_reached = false;
        while stack.len() > base && !is_reached {
            let Some(open) = stack.pop() else { break };
            *n_visits += 1;
            if !visited.is_new(open.0) {
                continue;
            }
            let Visit { is_found, goes_on } = self.visit(graph, open);
            is_reached = is_found && open.0 == to;
            if goes_on {
                self.go_on(graph, open, stack);
            }
        }
        stack.truncate(base);
        is_reached
    }
}

/// Whether a pattern edge stands for at most one edge of the graph.
pub(super) fn is_single_edge(edge: &PatternEdge) -> bool {
    let is_nearest = matches!(
        edge.kind,
        EdgeKind::Ancestor | EdgeKind::MinDescendants | EdgeKind::Descendants
    );
    !is_nearest && edge.repeat.1 == Some(1)
}

/// Nodes that an endless path has met, so that it ends in graphs with rings.
#[derive(Debug)]
pub(super) struct Visited {
    nodes: Option<HashSet<NodeId>>,
    /// In a forest nothing is met twice; this many visits are possible at most.
    n_left: usize,
}

impl Visited {
    pub(super) fn new<O: Payload>(graph: &Graph<O>, path: &Path<'_>) -> Self {
        let is_one_way = matches!(path.way, EdgeWay::Forward | EdgeWay::Backward);
        let meets_none_twice = is_one_way && graph.is_forest();
        let is_needed = !path.is_single() && !meets_none_twice;
        let n_left = if path.is_single() {
            usize::MAX
        } else {
            graph.n_nodes() + 1
        };
        Self {
            nodes: is_needed.then(HashSet::new),
            n_left,
        }
    }

    /// Notes a visit; false if the node was met before.
    pub(super) fn is_new(&mut self, node: NodeId) -> bool {
        match &mut self.nodes {
            Some(nodes) => nodes.insert(node),
            None => {
                self.n_left = self.n_left.saturating_sub(1);
                self.n_left > 0
            }
        }
    }
}
