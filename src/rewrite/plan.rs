//! In which order the nodes of a pattern are looked for.

use super::automaton::Automaton;
use crate::graph::pattern::{Candidate, EdgeKind, Pattern, PatternEdge};
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
    /// Ways of several edges: as written, and from their ends.
    pub(super) automata: Vec<[Automaton; 2]>,
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
    /// Finds the node that a method gives for one found before.
    Relate(usize),
    /// Begins a part that is searched apart, and which ends at the step `end`.
    Open { choice: usize, end: usize },
    /// Ends such a part: it is found.
    Close(usize),
}

impl Plan {
    /// Plans a search.
    ///
    /// Connected parts of the pattern are searched one inside the other: first those with a node that is known
    /// beforehand, then the others from the last to the first. Within a part the search begins at the known nodes, else
    /// at the first, and follows the edges as they are written. A condition is evaluated as soon as the nodes up to the
    /// last one it needs are found. What is set apart by `(: … )` and its kin comes last, in textual order.
    pub fn new<E>(pattern: &Pattern<E>) -> Self {
        let meant = meant_nodes(pattern);
        let mut planner = Planner {
            pattern,
            meant: &meant,
            choice: None,
            is_bound: vec![false; pattern.nodes.len()],
            is_edge_done: vec![false; pattern.edges.len()],
            is_condition_done: vec![false; pattern.conditions.len()],
            steps: vec![],
        };
        planner.plan_part();
        for choice in 0..pattern.choices.len() {
            planner.plan_choice(choice);
        }
        let steps = planner.steps;
        let via = vias(pattern, &meant, &steps);
        let type_of = |&node: &usize| match pattern.nodes[node].what {
            Candidate::Type(ty) => Some(ty),
            Candidate::Any | Candidate::Root | Candidate::Value(_) | Candidate::Same(_) => None,
        };
        let types = meant.iter().map(type_of).collect();
        let once = (0..pattern.conditions.len())
            .filter(|&i| pattern.conditions[i].needs.is_empty())
            .collect();
        let both_ways = |steps| [false, true].map(|back| Automaton::new(steps, back));
        Self {
            steps,
            may_coincide: coinciding(pattern, &meant),
            meant,
            once,
            types,
            via,
            automata: pattern.walks.iter().map(|steps| both_ways(steps)).collect(),
        }
    }

    /// Whether a type that the pattern needs has no node at all, so that nothing need be tried. Conditions of partial
    /// matches may draw random numbers; where there are some, the search takes its course.
    pub(super) fn has_no_match<E, O: Payload>(
        &self,
        pattern: &Pattern<E>,
        graph: &Graph<O>,
    ) -> bool {
        let is_missing = |node: usize| {
            let ty = self.types[node].filter(|_| pattern.nodes[self.meant[node]].choice.is_none());
            ty.is_some_and(|ty| graph.count(ty) == 0)
        };
        pattern.conditions.len() == self.once.len() && (0..self.types.len()).any(is_missing)
    }
}

/// Pairs of nodes that may be the same one: those that closures join which may have no edge.
fn coinciding<E>(pattern: &Pattern<E>, meant: &[usize]) -> Vec<(usize, usize)> {
    let n = pattern.nodes.len();
    let mut group: Vec<usize> = (0..n).collect();
    let zero = || pattern.edges.iter().filter(|edge| edge.repeat.0 == 0);
    for _ in zero() {
        for edge in zero() {
            let (a, b) = (meant[edge.from], meant[edge.to]);
            let least = group[a].min(group[b]);
            (group[a], group[b]) = (least, least);
        }
    }
    let pairs = (0..n).flat_map(|a| (a + 1..n).map(move |b| (a, b)));
    pairs.filter(|&(a, b)| group[a] == group[b]).collect()
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
    /// The part searched apart that is being planned.
    choice: Option<usize>,
    is_bound: Vec<bool>,
    is_edge_done: Vec<bool>,
    is_condition_done: Vec<bool>,
    steps: Vec<Step>,
}

impl<E> Planner<'_, E> {
    /// Whether the pattern node is one to be found in the part at hand.
    fn is_own(&self, node: usize) -> bool {
        self.meant[node] == node && self.pattern.nodes[node].choice == self.choice
    }

    fn plan_choice(&mut self, choice: usize) {
        self.choice = Some(choice);
        let begin = self.steps.len();
        self.steps.push(Step::Open { choice, end: 0 });
        self.plan_part();
        let end = self.steps.len();
        self.steps.push(Step::Close(choice));
        self.steps[begin] = Step::Open { choice, end };
        self.choice = None;
        self.follow_edges();
        self.add_conditions();
    }

    fn plan_part(&mut self) {
        let is_known = |what: &Candidate<E>| matches!(what, Candidate::Value(_) | Candidate::Root);
        for node in 0..self.pattern.nodes.len() {
            if self.is_own(node) && is_known(&self.pattern.nodes[node].what) {
                self.bind(node, Step::Start(node));
            }
        }
        self.follow_edges();
        for start in self.starts() {
            if !self.is_bound[start] {
                self.bind(start, Step::Start(start));
                self.follow_edges();
            }
        }
        self.follow_edges();
        self.add_conditions();
    }

    /// Where to begin: at the first nodes of the connected parts, last part first. To what a method leads, it is best led;
    /// such nodes come after the others.
    fn starts(&self) -> Vec<usize> {
        let n = self.pattern.nodes.len();
        let mut part: Vec<usize> = (0..n).map(|i| self.meant[i]).collect();
        let mut is_led = vec![false; n];
        for _ in 0..n {
            let edges = self.pattern.edges.iter();
            for edge in edges.filter(|edge| edge.choice == self.choice) {
                if is_one_way(edge) {
                    is_led[self.meant[edge.to]] = true;
                }
                let least = part[edge.from].min(part[edge.to]);
                (part[edge.from], part[edge.to]) = (least, least);
            }
            for i in 0..n {
                part[i] = part[i].min(part[self.meant[i]]);
                part[self.meant[i]] = part[i];
            }
        }
        let own = || (0..n).filter(|&i| self.is_own(i));
        let mut starts: Vec<usize> = own().filter(|&i| !is_led[i]).collect();
        starts.sort_by_key(|&i| (std::cmp::Reverse(part[i]), i));
        starts.extend(own().filter(|&i| is_led[i]));
        starts
    }

    fn follow_edges(&mut self) {
        while let Some((edge, is_reversed)) = self.next_edge() {
            self.is_edge_done[edge] = true;
            let PatternEnds { from, to } = self.ends(edge);
            if self.is_bound[from] && self.is_bound[to] {
                self.steps.push(Step::Check(edge));
                continue;
            }
            let step = match self.pattern.edges[edge].kind {
                EdgeKind::Relation(_) => Step::Relate(edge),
                _ => Step::Follow { edge, is_reversed },
            };
            self.bind(if is_reversed { from } else { to }, step);
        }
    }

    /// The first edge in the text that has an end found already; edges with both ends found come first.
    fn next_edge(&self) -> Option<(usize, bool)> {
        let is_open =
            |&e: &usize| !self.is_edge_done[e] && self.pattern.edges[e].choice == self.choice;
        let open = || (0..self.pattern.edges.len()).filter(is_open);
        let both = |&e: &usize| {
            let PatternEnds { from, to } = self.ends(e);
            self.is_bound[from] && self.is_bound[to]
        };
        if let Some(edge) = open().find(both) {
            return Some((edge, false));
        }
        open().find_map(|e| {
            let PatternEnds { from, to } = self.ends(e);
            let is_one_way = is_one_way(&self.pattern.edges[e]);
            match (self.is_bound[from], self.is_bound[to]) {
                (true, false) if self.is_own(to) => Some((e, false)),
                (false, true) if self.is_own(from) && !is_one_way => Some((e, true)),
                _ => None,
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
        self.add_conditions();
    }

    /// Adds the conditions that can be evaluated by now.
    fn add_conditions(&mut self) {
        for (i, condition) in self.pattern.conditions.iter().enumerate() {
            let Some(&last) = condition.needs.iter().max() else {
                continue;
            };
            let is_before = |node: usize| node <= last && self.pattern.nodes[node].choice.is_none();
            let before = (0..self.meant.len()).filter(|&node| is_before(self.meant[node]));
            let mut needed = before.chain(condition.needs.iter().copied());
            let is_ready = needed.all(|node| self.is_bound[self.meant[node]]);
            if is_ready && condition.choice == self.choice && !self.is_condition_done[i] {
                self.is_condition_done[i] = true;
                self.steps.push(Step::Condition(i));
            }
        }
    }
}

/// Whether an edge can only be walked as it is written: the way back from a method is not known, and which nodes are the
/// nearest is seen from where the search begins.
fn is_one_way(edge: &PatternEdge) -> bool {
    edge.is_minimal || matches!(edge.kind, EdgeKind::Relation(_))
}

struct PatternEnds {
    from: usize,
    to: usize,
}
