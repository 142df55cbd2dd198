//! The end of a step: what is no longer reachable from the root vanishes.
//!
//! A node without an incoming edge goes, then what hung only below it, and so on. What lost an edge and still has one may
//! hang on a ring that hangs on nothing: where every node has one parent, a walk up decides; else all that is reachable is
//! marked. (Only a ring of new nodes to which nothing ever led stays; nothing can come near it.)

use super::Payload;
use super::arena::NIL;
use super::store::{CANDIDATE, Graph, Header, INSERTED, LIVE, LOST, ON_WAY, REACHED};

impl<O: Payload> Graph<O> {
    /// Notes that a new node may not be reachable.
    pub(super) fn nominate_new(&mut self, index: usize) {
        self.nominate(index, 0);
    }

    /// Notes that a node has lost an incoming edge.
    pub(super) fn nominate_loser(&mut self, index: usize) {
        self.nominate(index, LOST);
    }

    fn nominate(&mut self, index: usize, loss: u16) {
        let flags = &mut self.nodes[index].flags;
        if *flags & INSERTED == 0 {
            return;
        }
        if *flags & CANDIDATE == 0 {
            self.candidates.push(index as u32);
        }
        *flags |= CANDIDATE | loss;
    }

    /// Removes all nodes of the graph that are no longer reachable from the root. Costs what the step has touched and the
    /// ways from there to the root, or the whole graph where nodes have several parents.
    pub fn end_of_step(&mut self) {
        let mut doubtful = self.remove_orphans();
        doubtful.retain(|&index| self.nodes[index as usize].flags & INSERTED != 0);
        let is_all_well =
            doubtful.is_empty() || self.is_forest() && self.all_lead_to_root(&doubtful);
        if !is_all_well {
            self.mark_and_sweep();
        }
        #[cfg(debug_assertions)]
        if self.nodes.len() <= SMALL {
            debug_assert_eq!(self.validate(), Ok(()));
        }
    }

    /// Removes nodes without incoming edges; returns those that have lost one and still have another.
    fn remove_orphans(&mut self) -> Vec<u32> {
        let mut doubtful = vec![];
        while let Some(index) = self.candidates.pop() {
            let flags = self.nodes[index as usize].flags;
            self.nodes[index as usize].flags &= !(CANDIDATE | LOST);
            let is_root = index as usize == self.root().index();
            if flags & (LIVE | INSERTED) != LIVE | INSERTED || is_root {
                continue;
            }
            if self.nodes[index as usize].link.from == NIL {
                self.remove(self.id(index as usize));
            } else if flags & LOST != 0 {
                doubtful.push(index);
            }
        }
        doubtful
    }

    /// Whether the way up from each of these nodes ends at the root. Each node has one parent at most.
    fn all_lead_to_root(&mut self, nodes: &[u32]) -> bool {
        let mut marked = vec![];
        let leads = nodes
            .iter()
            .all(|&node| self.leads_to_root(node as usize, &mut marked));
        for index in marked {
            self.nodes[index as usize].flags &= !(REACHED | ON_WAY);
        }
        leads
    }

    /// Whether the way up from a node ends at the root, or at a node whose way is known to.
    fn leads_to_root(&mut self, start: usize, marked: &mut Vec<u32>) -> bool {
        let first = marked.len();
        let mut at = start;
        while at != self.root().index() && self.nodes[at].flags & REACHED == 0 {
            let Header { flags, link, .. } = self.nodes[at];
            if link.from == NIL || flags & ON_WAY != 0 {
                return false;
            }
            self.nodes[at].flags |= ON_WAY;
            marked.push(at as u32);
            at = link.from as usize;
        }
        for &index in &marked[first..] {
            self.nodes[index as usize].flags |= REACHED;
        }
        true
    }

    fn mark_and_sweep(&mut self) {
        let mut open = vec![self.root().index()];
        self.nodes[open[0]].flags |= REACHED;
        while let Some(index) = open.pop() {
            let mut at = self.nodes[index].first_out;
            while at != NIL {
                let to = self.links.target(at) as usize;
                at = self.links.link(&self.nodes, at).next_out;
                let target = &mut self.nodes[to];
                if target.flags & REACHED == 0 {
                    target.flags |= REACHED;
                    open.push(to);
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
            self.nodes[index as usize].flags &= !(CANDIDATE | LOST);
        }
    }
}

/// Graphs up to this size are checked after every step of a debug build.
#[cfg(debug_assertions)]
const SMALL: usize = 256;
