//! Ways of several edges, `((>)* +> B)+`, as automata that are walked together with the graph.

use crate::graph::TypeId;
use crate::graph::pattern::{EdgeKind, EdgeWay, WalkStep};

/// A state; the first one is 0.
pub(super) type State = u32;

/// How to get from a state to another.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Move {
    /// At once.
    Free(State),
    /// If the node has the type.
    Type(TypeId, State),
    /// By an edge, to the next node.
    Edge(EdgeKind, EdgeWay, State),
}

/// A way as states and moves between them.
#[derive(Clone, Debug)]
pub(super) struct Automaton {
    /// Moves from each state, the one to try first in front.
    moves: Vec<Vec<Move>>,
    /// Where the way ends.
    end: State,
}

impl Automaton {
    /// The automaton of a way, or of the same way walked from its end.
    pub(super) fn new(steps: &[WalkStep], is_reversed: bool) -> Self {
        let mut automaton = Self {
            moves: vec![vec![]],
            end: 0,
        };
        automaton.end = automaton.row(steps, 0, is_reversed);
        automaton
    }

    /// What can be done in a state.
    pub(super) fn moves(&self, state: State) -> &[Move] {
        self.moves.get(state as usize).map_or(&[], Vec::as_slice)
    }

    /// Whether the way may end in this state.
    pub(super) fn is_end(&self, state: State) -> bool {
        state == self.end
    }

    fn state(&mut self) -> State {
        self.moves.push(vec![]);
        (self.moves.len() - 1) as State
    }

    fn add(&mut self, from: State, step: Move) {
        self.moves[from as usize].push(step);
    }

    /// Adds steps one behind the other; returns the state they end in.
    fn row(&mut self, steps: &[WalkStep], from: State, is_reversed: bool) -> State {
        let mut at = from;
        for i in 0..steps.len() {
            let i = if is_reversed { steps.len() - 1 - i } else { i };
            at = self.step(&steps[i], at, is_reversed);
        }
        at
    }

    fn step(&mut self, step: &WalkStep, from: State, is_reversed: bool) -> State {
        let (kind, way) = match step {
            WalkStep::Repeat(steps, least, most) => {
                return self.repeat(steps, (*least, *most), from, is_reversed);
            }
            WalkStep::Type(ty) => {
                let to = self.state();
                self.add(from, Move::Type(*ty, to));
                return to;
            }
            WalkStep::Edge(kind, way) => (*kind, *way),
        };
        let way = match way {
            EdgeWay::Forward if is_reversed => EdgeWay::Backward,
            EdgeWay::Backward if is_reversed => EdgeWay::Forward,
            other => other,
        };
        let to = self.state();
        self.add(from, Move::Edge(kind, way, to));
        to
    }

    /// Leaving comes before going on, so that near nodes are found first.
    fn repeat(
        &mut self,
        steps: &[WalkStep],
        (least, most): (u32, Option<u32>),
        from: State,
        is_reversed: bool,
    ) -> State {
        let mut at = from;
        for _ in 0..least {
            at = self.row(steps, at, is_reversed);
        }
        let end = self.state();
        let Some(most) = most else {
            let turn = self.state();
            self.add(at, Move::Free(turn));
            self.add(turn, Move::Free(end));
            let again = self.row(steps, turn, is_reversed);
            self.add(again, Move::Free(turn));
            return end;
        };
        for _ in least..most {
            self.add(at, Move::Free(end));
            at = self.row(steps, at, is_reversed);
        }
        self.add(at, Move::Free(end));
        end
    }
}
