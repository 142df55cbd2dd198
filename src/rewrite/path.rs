//! Following an edge of a pattern through the graph: one edge, a closure of edges, or to the nearest nodes of a type.

use super::automaton::{Automaton, Move};
use crate::graph::pattern::{EdgeKind, EdgeWay, PatternEdge};
use crate::graph::{EdgeBits, Graph, NodeId, Payload, TypeId};
use std::collections::HashSet;

/// A node to be visited and its distance in edges; on a way of several edges the state of its automaton.
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
    /// Of a way of several edges.
    automaton: Option<&'p Automaton>,
}

/// What to do with a node on a path.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) struct Visit {
    pub(super) is_found: bool,
    pub(super) goes_on: bool,
}

impl<'p> Path<'p> {
    /// The path of `edge` from its left node to its right one, or the other way round. `left` and `right` are the types of
    /// the two, `automaton` that of a way of several edges in the direction it is walked.
    pub(super) fn new(
        edge: &'p PatternEdge,
        is_reversed: bool,
        (left, right): (Option<TypeId>, Option<TypeId>),
        automaton: Option<&'p Automaton>,
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
            automaton,
        }
    }

    /// Whether at most one edge is walked.
    pub(super) fn is_single(&self) -> bool {
        is_single_edge(self.edge)
    }

    /// Puts the first nodes of the path on `stack`, the one to visit first on top.
    pub(super) fn begin<O: Payload>(&self, graph: &Graph<O>, from: NodeId, stack: &mut Vec<Open>) {
        if self.edge.repeat.0 == 0 || self.automaton.is_some() {
            stack.push((from, 0));
        } else {
            self.go_on(graph, (from, 0), stack);
        }
    }

    /// What a node on the path means.
    pub(super) fn visit<O: Payload>(&self, graph: &Graph<O>, (node, distance): Open) -> Visit {
        if let Some(automaton) = self.automaton {
            return Visit {
                is_found: automaton.is_end(distance),
                goes_on: true,
            };
        }
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
            | EdgeKind::User(_)
            | EdgeKind::Walk(_)
            | EdgeKind::Relation(_) => {
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
        let base = stack.len();
        match self.automaton {
            Some(automaton) => {
                for &step in automaton.moves(distance) {
                    match step {
                        Move::Free(next) => stack.push((node, next)),
                        Move::Type(ty, next) if graph.is_a(node, ty) => stack.push((node, next)),
                        Move::Type(..) => {}
                        Move::Edge(kind, way, next) => {
                            push_neighbors(graph, node, (EdgeBits::of(kind), way), next, stack);
                        }
                    }
                }
            }
            None => {
                let way = match (self.edge.kind, self.way) {
                    (EdgeKind::Ancestor, EdgeWay::Forward) => EdgeWay::Backward,
                    (EdgeKind::Ancestor, EdgeWay::Backward) => EdgeWay::Forward,
                    (_, way) => way,
                };
                let bits = EdgeBits::of(self.edge.kind);
                push_neighbors(graph, node, (bits, way), distance.saturating_add(1), stack);
            }
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
            if !visited.is_new(self, open) {
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

/// Pushes the nodes that edges with one of the `bits` join to `node`, each with `mark`, in the order of the edges.
fn push_neighbors<O: Payload>(
    graph: &Graph<O>,
    node: NodeId,
    (bits, way): (EdgeBits, EdgeWay),
    mark: u32,
    stack: &mut Vec<Open>,
) {
    let fits = |&(_, b): &(NodeId, EdgeBits)| b.intersects(bits);
    if matches!(way, EdgeWay::Backward | EdgeWay::Undirected) {
        stack.extend(graph.in_edges(node).filter(fits).map(|(n, _)| (n, mark)));
    }
    if way != EdgeWay::Backward {
        let is_mutual = |&(other, _): &(NodeId, EdgeBits)| {
            way != EdgeWay::Both || graph.edge_bits(other, node).intersects(bits)
        };
        let out = graph.out_edges(node).filter(fits).filter(is_mutual);
        stack.extend(out.map(|(n, _)| (n, mark)));
    }
}

/// Whether a pattern edge stands for at most one edge of the graph.
pub(super) fn is_single_edge(edge: &PatternEdge) -> bool {
    let is_nearest = matches!(
        edge.kind,
        EdgeKind::Ancestor
            | EdgeKind::MinDescendants
            | EdgeKind::Descendants
            | EdgeKind::Walk(_)
            | EdgeKind::Relation(_)
    );
    !is_nearest && edge.repeat.1 == Some(1)
}

/// What a path has met, so that it ends in graphs with rings and finds each node once.
#[derive(Debug)]
pub(super) struct Visited {
    /// Nodes, with how far they are as far as that matters.
    met: Option<HashSet<Open>>,
    found: HashSet<NodeId>,
    /// In a forest nothing is met twice; this many visits are possible at most.
    n_left: usize,
}

impl Visited {
    pub(super) fn new<O: Payload>(graph: &Graph<O>, path: &Path<'_>) -> Self {
        let is_one_way = matches!(path.way, EdgeWay::Forward | EdgeWay::Backward);
        let meets_none_twice = is_one_way && graph.is_forest() && path.automaton.is_none();
        let is_needed = !path.is_single() && !meets_none_twice;
        let n_left = if path.is_single() {
            usize::MAX
        } else {
            graph.n_nodes() + 1
        };
        Self {
            met: is_needed.then(HashSet::new),
            found: HashSet::new(),
            n_left,
        }
    }

    /// Notes a visit; false if there was one before from which the same ways go on.
    pub(super) fn is_new(&mut self, path: &Path<'_>, (node, distance): Open) -> bool {
        let Some(met) = &mut self.met else {
            self.n_left = self.n_left.saturating_sub(1);
            return self.n_left > 0;
        };
        let (least, most) = path.edge.repeat;
        let mark = match path.automaton {
            Some(_) => distance,
            None => distance.min(most.unwrap_or(least)),
        };
        met.insert((node, mark))
    }

    /// Notes that the path has found a node; false if it has found it before.
    pub(super) fn is_first_find(&mut self, node: NodeId) -> bool {
        self.met.is_none() || self.found.insert(node)
    }
}
