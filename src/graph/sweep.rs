//! The end of a step: what is no longer reachable from the root vanishes.
//!
//! A node that lost its last incoming edge goes, then what hung only below it, and so on. That is exact unless edges run
//! in rings; where a step may have made one or left one behind, everything reachable is marked and the rest goes.

use super::Payload;
use super::arena::NIL;
use super::store::{CANDIDATE, Graph, INSERTED, LIVE, REACHED};

impl<O: Payload> Graph<O> {
    /// Notes that a node may have become unreachable.
    pub(super) fn nominate(&mut self, index: usize) {
        let flags = &mut self.nodes[index].flags;
        if *flags & (CANDIDATE | INSERTED) == INSERTED {
            *flags |= CANDIDATE;
            self.candidates.push(index as u32);
        }
    }

    /// Removes all nodes of the graph that are no longer reachable from the root. Costs what the step has touched, or
    /// the whole graph if there may be rings.
    pub fn end_of_step(&mut self) {
        let mut has_several_parents = false;
        while let Some(index) = self.candidates.pop() {
            let index = index as usize;
            self.nodes[index].flags &= !CANDIDATE;
            let header = self.nodes[index];
            if header.flags & (LIVE | INSERTED) != LIVE | INSERTED || index == self.root().index() {
                continue;
            }
            if header.first_in == NIL {
                self.remove(self.id(index));
            } else {
                has_several_parents |= self.edges.edges[header.first_in as usize].next_in != NIL;
            }
        }
        if has_several_parents || self.may_have_rings {
            self.mark_and_sweep();
        }
        self.may_have_rings = false;
        #[cfg(debug_assertions)]
        if self.nodes.len() <= SMALL {
            debug_assert_eq!(self.validate(), Ok(()));
        }
    }

    fn mark_and_sweep(&mut self) {
        let mut open = vec![self.root().index()];
        self.nodes[open[0]].flags |= REACHED;
        while let Some(index) = open.pop() {
            let mut at = self.nodes[index].first_out;
            while at != NIL {
                let edge = self.edges.edges[at as usize];
                at = edge.next_out;
                let target = &mut self.nodes[edge.to as usize];
                if target.flags & REACHED == 0 {
                    target.flags |= REACHED;
                    open.push(edge.to as usize);
                }
            }
        }
        for index in 0..self.nodes.len() {
            let flags = self.nodes[index].flags;
            self.nodes[index].flags &= !REACHED;
            if flags & (LIVE | INSERTED | REACHED) == LIVE | INSERTED {
                self.remove(self.id(index));
            }
        }
        for index in std::mem::take(&mut self.candidates) {
            self.nodes[index as usize].flags &= !CANDIDATE;
        }
    }
}

/// Graphs up to this size are checked after every step of a debug build.
#[cfg(debug_assertions)]
const SMALL: usize = 256;
