//! In which order the nodes of a pattern are looked for.

use crate::graph::pattern::{Candidate, Pattern};
use crate::graph::{Graph, Payload, TypeId};

/// A pattern made ready for searching; made once per rule or query.
#[derive(Clone, Debug)]
pub struct Plan {
    pub(super) steps: Vec<Step>,
    /// For each pattern node the earlier one it stands for, or itself.
    pub(super) meant: Vec<usize>,
    /// Pairs of pattern nodes that may be one and the same node of the graph.
    pub(super) may_coincide: Vec<(usize, usize)>,
    /// Conditions that use no node: evaluated once per search, first of all.
    pub(super) once: Vec<usize>,
    /// The type that pattern nodes must have, if one is given (by pattern node).
    pub(super) types: Vec<Option<TypeId>>,
    /// How each node is found, by pattern node: by which edge, and whether against it. `None` if it is a start.
    pub(super) via: Vec<Option<Via>>,
}

/// How a pattern node is found from another one.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) struct Via {
    pub(super) edge: usize,
    pub(super) is_reversed: bool,
    /// The pattern node it is found from.
    pub(super) from: usize,
}

/// One step of a search.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Step {
    /// Tries all candidates for a node that nothing leads to.
    Start(usize),
    /// Finds a node by an edge from one found before; `is_reversed` if that one is the edge's right node.
    Follow { edge: usize, is_reversed: bool },
    /// Looks whether an edge joins two nodes found before.
    Check(usize),
    /// Evaluates a condition.
    Condition(usize),
}

impl Plan {
    /// Plans a search.
    ///
    /// Connected parts of the pattern are searched one inside the other: first those with a node that is known
    /// beforehand, then the others from the last to the first. Within a part the search begins at the known nodes, else
    /// at the first, and follows the edges as they are written. A condition is evaluated as soon as the nodes up to the
    /// last one it needs are found.
    pub fn new<E>(pattern: &Pattern<E>) -> Self {
        let meant = meant_nodes(pattern);
        let mut planner = Planner {
            pattern,
            meant: &meant,
            is_bound: vec![false; pattern.nodes.len()],
            is_edge_done: vec![false; pattern.edges.len()],
            is_condition_done: vec![false; pattern.conditions.len()],
            steps: vec![],
        };
        let is_known = |&node: &usize| {
            matches!(
                pattern.nodes[node].what,
                Candidate::Value(_) | Candidate::Root
            )
        };
        let own = |&node: &usize| meant[node] == node;
        for node in (0..pattern.nodes.len()).filter(own).filter(is_known) {
            planner.bind(node, Step::Start(node));
        }
        planner.follow_edges();
        for start in planner.starts_of_parts() {
            if !planner.is_bound[start] {
                planner.bind(start, Step::Start(start));
                planner.follow_edges();
            }
        }
        let steps = planner.steps;
        let via = vias(pattern, &meant, &steps);
        let type_of = |&node: &usize| match pattern.nodes[node].what {
            Candidate::Type(ty) => Some(ty),
            Candidate::Any | Candidate::Root | Candidate::Value(_) | Candidate::Same(_) => None,
        };
        let types = meant.iter().map(type_of).collect();
        let once = (0..pattern.conditions.len())
            .filter(|&i| pattern.conditions[i].needs.is_none())
            .collect();
        let zero = pattern.edges.iter().filter(|e| e.repeat.0 == 0);
        let may_coincide = zero.map(|e| (meant[e.from], meant[e.to])).collect();
        Self {
            steps,
            meant,
            may_coincide,
            once,
            types,
            via,
        }
    }
}

impl Plan {
    /// Whether a type that the pattern needs has no node at all, so that nothing need be tried. Conditions of partial
    /// matches may draw random numbers; where there are some, the search takes its course.
    pub(super) fn has_no_match<E, O: Payload>(
        &self,
        pattern: &Pattern<E>,
        graph: &Graph<O>,
    ) -> bool {
        pattern.conditions.len() == self.once.len()
            && self.types.iter().flatten().any(|&ty| graph.count(ty) == 0)
    }
}

/// How each pattern node is found, from the steps that find it.
fn vias<E>(pattern: &Pattern<E>, meant: &[usize], steps: &[Step]) -> Vec<Option<Via>> {
    let mut via = vec![None; pattern.nodes.len()];
    for step in steps {
        if let Step::Follow { edge, is_reversed } = *step {
            let ends = &pattern.edges[edge];
            let (left, right) = (meant[ends.from], meant[ends.to]);
            let (from, to) = if is_reversed {
                (right, left)
            } else {
                (left, right)
            };
            via[to] = Some(Via {
                edge,
                is_reversed,
                from,
            });
        }
    }
    via
}

/// Follows labels that are used again to the node they stand for.
fn meant_nodes<E>(pattern: &Pattern<E>) -> Vec<usize> {
    let mut meant: Vec<usize> = Vec::with_capacity(pattern.nodes.len());
    for (i, node) in pattern.nodes.iter().enumerate() {
        let target = match node.what {
            Candidate::Same(earlier) => meant.get(earlier).copied().unwrap_or(i),
            Candidate::Any | Candidate::Type(_) | Candidate::Root | Candidate::Value(_) => i,
        };
        meant.push(target);
    }
    meant
}

struct Planner<'a, E> {
    pattern: &'a Pattern<E>,
    meant: &'a [usize],
    is_bound: Vec<bool>,
    is_edge_done: Vec<bool>,
    is_condition_done: Vec<bool>,
    steps: Vec<Step>,
}

impl<E> Planner<'_, E> {
    /// First nodes of the connected parts, last part first.
    fn starts_of_parts(&self) -> Vec<usize> {
        let n = self.pattern.nodes.len();
        let mut part: Vec<usize> = (0..n).map(|i| self.meant[i]).collect();
        for _ in 0..n {
            for edge in &self.pattern.edges {
                let least = part[edge.from].min(part[edge.to]);
                (part[edge.from], part[edge.to]) = (least, least);
            }
            for i in 0..n {
                part[i] = part[i].min(part[self.meant[i]]);
                part[self.meant[i]] = part[i];
            }
        }
        (0..n).rev().filter(|&i| part[i] == i).collect()
    }

    fn follow_edges(&mut self) {
        while let Some((edge, is_reversed)) = self.next_edge() {
            self.is_edge_done[edge] = true;
            let PatternEnds { from, to } = self.ends(edge);
            if self.is_bound[from] && self.is_bound[to] {
                self.steps.push(Step::Check(edge));
            } else {
                let new = if is_reversed { from } else { to };
                self.bind(new, Step::Follow { edge, is_reversed });
            }
        }
    }

    /// The first edge in the text that has an end found already; edges with both ends found come first.
    fn next_edge(&self) -> Option<(usize, bool)> {
        let open = || (0..self.pattern.edges.len()).filter(|&e| !self.is_edge_done[e]);
        let both = |&e: &usize| {
            let PatternEnds { from, to } = self.ends(e);
            self.is_bound[from] && self.is_bound[to]
        };
        if let Some(edge) = open().find(both) {
            return Some((edge, false));
        }
        open().find_map(|e| {
            let PatternEnds { from, to } = self.ends(e);
            match (self.is_bound[from], self.is_bound[to]) {
                (true, false) => Some((e, false)),
                (false, true) => Some((e, true)),
                (true, true) | (false, false) => None,
            }
        })
    }

    fn ends(&self, edge: usize) -> PatternEnds {
        let edge = &self.pattern.edges[edge];
        PatternEnds {
            from: self.meant[edge.from],
            to: self.meant[edge.to],
        }
    }

    fn bind(&mut self, node: usize, step: Step) {
        self.is_bound[node] = true;
        self.steps.push(step);
        let meant = self.meant;
        let is_bound = |i: usize, bound: &[bool]| bound[meant[i]];
        for (i, condition) in self.pattern.conditions.iter().enumerate() {
            let Some(last) = condition.needs else {
                continue;
            };
            if !self.is_condition_done[i] && (0..=last).all(|n| is_bound(n, &self.is_bound)) {
                self.is_condition_done[i] = true;
                self.steps.push(Step::Condition(i));
            }
        }
    }
}

struct PatternEnds {
    from: usize,
    to: usize,
}
