//! Finding the matches of a pattern.

use super::env::{Flow, Found, Match, MatchEnv};
use super::path::{Open, Path, Visit, Visited, is_single_edge};
use super::plan::{Plan, Step};
use crate::graph::pattern::{Candidate, Choice, EdgeKind, Pattern, PatternArg};
use crate::graph::{NodeId, TypeId};

/// Buffers for searches, kept from one search to the next. Searches inside searches take one each.
#[derive(Debug, Default)]
pub struct ScratchPool {
    spare: Vec<Scratch>,
}

#[derive(Debug, Default)]
struct Scratch {
    /// What each pattern node has found.
    nodes: Vec<NodeId>,
    /// Which pattern nodes have found anything.
    is_bound: Vec<bool>,
    /// Which parts searched apart have found anything.
    is_met: Vec<bool>,
    /// Candidates of all steps that are under way, those of the innermost on top.
    open: Vec<Open>,
}

/// Calls `found` for each match of a pattern, with the graph's node for each pattern node; labels and parameters stand in
/// their local variables then.
///
/// Matches come in the order of the first node's extent as it is when the search begins, then in order of edges. With
/// `excludes_consumed` (rules) a node that an earlier rule of the step has consumed matches only as context. Two pattern
/// nodes never match the same node, except over a closure that may have length 0.
pub fn search<E, M: MatchEnv<E>>(
    pattern: &Pattern<E>,
    plan: &Plan,
    excludes_consumed: bool,
    env: &mut M,
    found: &mut Found<'_, M, M::Error>,
) -> Result<(), M::Error> {
    for &i in &plan.once {
        if !env.condition(&pattern.conditions[i].expr)? {
            return Ok(());
        }
    }
    if plan.has_no_match(pattern, env.graph()) {
        return Ok(());
    }
    let mut scratch = env.scratch().spare.pop().unwrap_or_default();
    scratch.nodes.clear();
    scratch
        .nodes
        .resize(pattern.nodes.len(), env.graph().root());
    scratch.is_bound.clear();
    scratch.is_bound.resize(pattern.nodes.len(), false);
    scratch.is_met.clear();
    scratch.is_met.resize(pattern.choices.len(), false);
    scratch.open.clear();
    let mut search = Search {
        pattern,
        plan,
        excludes_consumed,
        env,
        found,
        scratch,
        n_visits: 0,
        n_found: 0,
    };
    let result = search.step(0).and_then(|_| search.visits(0, 1));
    let scratch = search.scratch;
    env.scratch().spare.push(scratch);
    result
}

/// So many visits are spent at once: the budget is looked at often enough, and the inner loop only counts.
const BATCH: u32 = 1 << 10;

/// What comes after a candidate.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Turn {
    /// The next one.
    Next,
    /// None of the part searched apart that is under way: its first match is found.
    Leave,
    /// None at all.
    Stop,
}

struct Search<'a, E, M: MatchEnv<E>> {
    pattern: &'a Pattern<E>,
    plan: &'a Plan,
    excludes_consumed: bool,
    env: &'a mut M,
    found: &'a mut Found<'a, M, M::Error>,
    scratch: Scratch,
    /// Candidates tried and nodes visited that are not spent yet.
    n_visits: u32,
    /// Matches found so far.
    n_found: u64,
}

impl<'a, E, M: MatchEnv<E>> Search<'a, E, M> {
    /// Counts visits, and spends what was counted when it is `batch` or more.
    #[inline]
    fn visits(&mut self, n: usize, batch: u32) -> Result<(), M::Error> {
        self.n_visits = self
            .n_visits
            .saturating_add(u32::try_from(n).unwrap_or(u32::MAX));
        if self.n_visits < batch {
            return Ok(());
        }
        self.env.spend(std::mem::take(&mut self.n_visits))
    }

    fn step(&mut self, at: usize) -> Result<Turn, M::Error> {
        let Some(&step) = self.plan.steps.get(at) else {
            return self.found();
        };
        match step {
            Step::Start(node) => self.start(node, at),
            Step::Follow { edge, is_reversed } => self.follow(edge, is_reversed, at),
            Step::Check(edge) => {
                let holds = self.check(edge)?;
                self.step_if(holds, at)
            }
            Step::Condition(i) => {
                let holds = self.env.condition(&self.pattern.conditions[i].expr)?;
                self.step_if(holds, at)
            }
            Step::Relate(edge) => match self.related(edge)? {
                Some(found) => {
                    self.try_node(self.plan.meant[self.pattern.edges[edge].to], found, at)
                }
                None => Ok(Turn::Next),
            },
            Step::Open { choice, end } => self.choice(choice, end, at),
            Step::Close(choice) => {
                self.scratch.is_met[choice] = true;
                let turn = self.step(at + 1)?;
                let is_first = self.pattern.choices[choice] == Choice::First;
                Ok(if is_first && turn == Turn::Next {
                    Turn::Leave
                } else {
                    turn
                })
            }
        }
    }

    fn step_if(&mut self, holds: bool, at: usize) -> Result<Turn, M::Error> {
        if holds {
            self.step(at + 1)
        } else {
            Ok(Turn::Next)
        }
    }

    fn found(&mut self) -> Result<Turn, M::Error> {
        self.n_found += 1;
        let found = Match {
            nodes: &self.scratch.nodes,
            is_bound: &self.scratch.is_bound,
            meant: &self.plan.meant,
        };
        Ok(match (self.found)(self.env, &found)? {
            Flow::Continue => Turn::Next,
            Flow::Stop => Turn::Stop,
        })
    }

    /// Searches a part that is set apart, then the rest of the plan.
    fn choice(&mut self, choice: usize, end: usize, at: usize) -> Result<Turn, M::Error> {
        self.scratch.is_met[choice] = false;
        if self.step(at + 1)? == Turn::Stop {
            return Ok(Turn::Stop);
        }
        let is_missing = !self.scratch.is_met[choice];
        if !is_missing || self.pattern.choices[choice] != Choice::Optional {
            return Ok(Turn::Next);
        }
        for i in 0..self.pattern.nodes.len() {
            let node = &self.pattern.nodes[i];
            if node.choice != Some(choice) || self.scratch.is_bound[self.plan.meant[i]] {
                continue;
            }
            if let Some(slot) = node.slot {
                self.env.bind_node(slot, None);
            }
            // No edge of the pattern may seem to be there: an edge never leads to its own node.
            let edges = self
                .pattern
                .edges
                .iter()
                .filter(|edge| edge.choice == Some(choice));
            let other = edges.clone().find_map(|edge| match (edge.from, edge.to) {
                (from, to) if to == i => Some(from),
                (from, to) if from == i => Some(to),
                _ => None,
            });
            self.scratch.nodes[i] = self.scratch.nodes[other.unwrap_or(i)];
        }
        self.step(end + 1)
    }

    fn start(&mut self, node: usize, at: usize) -> Result<Turn, M::Error> {
        let base = self.scratch.open.len();
        match &self.pattern.nodes[node].what {
            Candidate::Root => {
                let root = self.env.graph().root();
                return self.try_node(node, root, at);
            }
            Candidate::Value(value) => {
                return match self.env.node_value(value)? {
                    Some(found) if self.env.graph().exists(found) => self.try_node(node, found, at),
                    Some(_) | None => Ok(Turn::Next),
                };
            }
            Candidate::Type(ty) => match self.rare_end(node, *ty) {
                Some((count, rare)) => {
                    self.visits(count, BATCH)?;
                    self.open_from(rare);
                }
                None => self.open_extent(*ty),
            },
            // All types extend the first one.
            Candidate::Any | Candidate::Same(_) => self.open_extent(TypeId(0)),
        }
        let end = self.scratch.open.len();
        self.visits(end - base, BATCH)?;
        for i in base..end {
            let candidate = self.scratch.open[i].0;
            let turn = self.try_node(node, candidate, at)?;
            if turn != Turn::Next {
                self.scratch.open.truncate(base);
                return Ok(turn);
            }
        }
        self.scratch.open.truncate(base);
        Ok(Turn::Next)
    }

    fn open_extent(&mut self, ty: TypeId) {
        self.scratch
            .open
            .extend(self.env.graph().extent(ty).map(|node| (node, 0)));
    }

    /// Takes as candidates only the nodes from which a node for the pattern node `rare` can be reached by the pattern's
    /// edges. The order stays that of the extent.
    fn open_from(&mut self, rare: usize) {
        let base = self.scratch.open.len();
        let graph = self.env.graph();
        let open = &mut self.scratch.open;
        if let Some(ty) = self.plan.types[rare] {
            open.extend(graph.extent(ty).map(|node| (node, 0)));
        }
        let mut at = rare;
        while let Some(via) = self.plan.via[at] {
            let (path, _, _) = path(self.pattern, self.plan, via.edge, !via.is_reversed);
            let wanted = self.plan.types[via.from];
            let end = open.len();
            for i in base..end {
                path.begin(graph, open[i].0, open);
            }
            open.drain(base..end);
            let fits = |node| wanted.is_none_or(|ty| graph.is_a(node, ty));
            let mut kept = base;
            for i in base..open.len() {
                if fits(open[i].0) {
                    open[kept] = open[i];
                    kept += 1;
                }
            }
            open.truncate(kept);
            at = via.from;
        }
        open[base..].sort_unstable_by_key(|&(node, _)| graph.extent_order(node));
        let mut kept = base;
        for i in base..open.len() {
            if kept == base || open[kept - 1].0 != open[i].0 {
                open[kept] = open[i];
                kept += 1;
            }
        }
        open.truncate(kept);
    }

    /// The pattern node of the rarest type among those that single edges join to `start`, if it is much rarer than `ty`;
    /// and how many nodes have that type.
    fn rare_end(&self, start: usize, ty: TypeId) -> Option<(usize, usize)> {
        let is_joined = |&node: &usize| {
            let mut at = node;
            while let Some(via) = self.plan.via[at] {
                let edge = &self.pattern.edges[via.edge];
                if !is_single_edge(edge) || edge.repeat.0 == 0 {
                    return false;
                }
                at = via.from;
            }
            at == start && node != start && self.pattern.nodes[node].choice.is_none()
        };
        let graph = self.env.graph();
        let typed = (0..self.plan.via.len()).filter(is_joined);
        let counted = typed.filter_map(|node| Some((graph.count(self.plan.types[node]?), node)));
        let (count, rare) = counted.min()?;
        (count.saturating_mul(MUCH_RARER) < graph.count(ty)).then_some((count, rare))
    }

    fn follow(&mut self, edge: usize, is_reversed: bool, at: usize) -> Result<Turn, M::Error> {
        let (path, from, to) = self.path(edge, is_reversed);
        let from = self.scratch.nodes[from];
        let base = self.scratch.open.len();
        let is_minimal = self.pattern.edges[edge].is_minimal;
        let mut visited = Visited::new(self.env.graph(), &path);
        path.begin(self.env.graph(), from, &mut self.scratch.open);
        while self.scratch.open.len() > base {
            let Some(open) = self.scratch.open.pop() else {
                break;
            };
            self.visits(1, BATCH)?;
            if !visited.is_new(&path, open) {
                continue;
            }
            let Visit {
                is_found,
                mut goes_on,
            } = path.visit(self.env.graph(), open);
            if is_found && visited.is_first_find(open.0) {
                let n_before = self.n_found;
                let turn = self.try_node(to, open.0, at)?;
                goes_on &= !(is_minimal && self.n_found > n_before);
                if turn != Turn::Next {
                    self.scratch.open.truncate(base);
                    return Ok(turn);
                }
            }
            if goes_on {
                path.go_on(self.env.graph(), open, &mut self.scratch.open);
            }
        }
        Ok(Turn::Next)
    }

    /// The node that a method gives for the node the edge begins at.
    fn related(&mut self, edge: usize) -> Result<Option<NodeId>, M::Error> {
        let EdgeKind::Relation(number) = self.pattern.edges[edge].kind else {
            return Ok(None);
        };
        let found = self
            .env
            .node_value(&self.pattern.relations[usize::from(number)])?;
        Ok(found.filter(|&node| self.env.graph().exists(node)))
    }

    /// Looks from the far end, which is quicker in trees: every node has one parent.
    fn check(&mut self, edge: usize) -> Result<bool, M::Error> {
        if let EdgeKind::Relation(_) = self.pattern.edges[edge].kind {
            let to = self.scratch.nodes[self.plan.meant[self.pattern.edges[edge].to]];
            return Ok(self.related(edge)? == Some(to));
        }
        let (path, from, to) = self.path(edge, true);
        let (from, to) = (self.scratch.nodes[from], self.scratch.nodes[to]);
        let mut n_visits = 0;
        let graph = self.env.graph();
        let is_reached = path.reaches(graph, from, to, &mut self.scratch.open, &mut n_visits);
        self.visits(n_visits, BATCH)?;
        Ok(is_reached)
    }

    fn path(&self, edge: usize, is_reversed: bool) -> (Path<'a>, usize, usize) {
        path(self.pattern, self.plan, edge, is_reversed)
    }

    /// Tries a node of the graph for a pattern node, then the rest of the plan.
    fn try_node(&mut self, node: usize, found: NodeId, at: usize) -> Result<Turn, M::Error> {
        if !self.fits(node, found) {
            return Ok(Turn::Next);
        }
        self.scratch.nodes[node] = found;
        self.scratch.is_bound[node] = true;
        let turn = if self.bind(node, found)? {
            self.step(at + 1)?
        } else {
            Turn::Next
        };
        self.scratch.is_bound[node] = false;
        Ok(turn)
    }

    fn fits(&self, node: usize, found: NodeId) -> bool {
        let graph = self.env.graph();
        let has_type = match self.plan.types[node] {
            Some(ty) => graph.is_a(found, ty),
            None => graph.exists(found),
        };
        if !has_type {
            return false;
        }
        let is_context = |i: usize| self.pattern.nodes[i].is_context;
        let is_consuming =
            (node..self.pattern.nodes.len()).any(|i| self.plan.meant[i] == node && !is_context(i));
        if self.excludes_consumed && is_consuming && graph.is_consumed(found) {
            return false;
        }
        let bound = (0..self.scratch.nodes.len()).filter(|&i| self.scratch.is_bound[i]);
        let mut equal = bound.filter(|&i| self.scratch.nodes[i] == found);
        equal.all(|other| {
            let pair =
                |&(a, b): &(usize, usize)| (a, b) == (node, other) || (b, a) == (node, other);
            self.plan.may_coincide.iter().any(pair)
        })
    }

    /// Fills local variables and compares parameters, for all pattern nodes that mean `node`.
    fn bind(&mut self, node: usize, found: NodeId) -> Result<bool, M::Error> {
        for i in node..self.pattern.nodes.len() {
            if self.plan.meant[i] != node {
                continue;
            }
            self.scratch.nodes[i] = found;
            if let Some(slot) = self.pattern.nodes[i].slot {
                self.env.bind_node(slot, Some(found));
            }
            for arg in &self.pattern.nodes[i].args {
                match arg {
                    PatternArg::Bind(field, slot) => self.env.bind_field(*slot, found, *field)?,
                    PatternArg::Equal(field, value) => {
                        if !self.env.field_equals(found, *field, value)? {
                            return Ok(false);
                        }
                    }
                }
            }
        }
        Ok(true)
    }
}

/// A search begins at the other end of an edge if the nodes there are so many times fewer.
const MUCH_RARER: usize = 8;

/// The path along a pattern edge, with the pattern nodes it leads from and to.
fn path<'p, E>(
    pattern: &'p Pattern<E>,
    plan: &'p Plan,
    edge: usize,
    is_reversed: bool,
) -> (Path<'p>, usize, usize) {
    let edge = &pattern.edges[edge];
    let types = (plan.types[edge.from], plan.types[edge.to]);
    let automaton = match edge.kind {
        EdgeKind::Walk(number) => plan.automata.get(usize::from(number)),
        _ => None,
    };
    let automaton = automaton.map(|both| &both[usize::from(is_reversed)]);
    let path = Path::new(edge, is_reversed, types, automaton);
    let (left, right) = (plan.meant[edge.from], plan.meant[edge.to]);
    if is_reversed {
        (path, right, left)
    } else {
        (path, left, right)
    }
}
