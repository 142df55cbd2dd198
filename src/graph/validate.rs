//! Checks every invariant of a graph; for tests and debug builds.

use super::arena::NIL;
use super::store::{Graph, INSERTED, LIVE};
use super::{EdgeBits, Payload};

impl<O: Payload> Graph<O> {
    /// Whether all invariants hold; the text names the first that does not.
    ///
    /// Both lists of every node are chained correctly and hold each edge once; no edge ends at a missing node or is
    /// empty; no two edges join the same nodes the same way; extents hold exactly the nodes of the graph.
    pub fn validate(&self) -> Result<(), String> {
        let (mut n_out, mut n_in, mut n_inserted) = (0, 0, 0);
        for (index, header) in self.nodes.iter().enumerate() {
            if header.flags & LIVE == 0 {
                continue;
            }
            n_out += self.check_list(index, true)?;
            n_in += self.check_list(index, false)?;
            if header.flags & INSERTED != 0 {
                n_inserted += 1;
                if self.extents.place(header.type_id, header.extent_place) != Some(index as u32) {
                    return Err(format!("node {index} is not at its place in the extent"));
                }
            }
        }
        let n_in_extents: usize = self
            .types()
            .iter()
            .map(|(ty, _)| self.count_exactly(ty))
            .sum();
        if (n_out, n_in) != (self.n_edges(), self.n_edges()) {
            return Err(format!(
                "{} edges, but {n_out} out, {n_in} in",
                self.n_edges()
            ));
        }
        if n_in_extents != n_inserted {
            return Err(format!("{n_inserted} nodes, but {n_in_extents} in extents"));
        }
        Ok(())
    }

    fn check_list(&self, index: usize, is_out: bool) -> Result<usize, String> {
        let header = &self.nodes[index];
        let first = if is_out {
            header.first_out
        } else {
            header.first_in
        };
        let (mut at, mut previous, mut count) = (first, NIL, 0);
        while at != NIL {
            let edge = &self.edges.edges[at as usize];
            let (own, other, next, back) = if is_out {
                (edge.from, edge.to, edge.next_out, edge.previous_out)
            } else {
                (edge.to, edge.from, edge.next_in, edge.previous_in)
            };
            let twin = self.edge_bits(self.id(edge.from as usize), self.id(edge.to as usize));
            if own as usize != index || edge.bits == EdgeBits::NONE || twin != edge.bits {
                return Err(format!(
                    "edge {at} in the list of node {index} does not belong there"
                ));
            }
            if self.nodes[other as usize].flags & LIVE == 0 {
                return Err(format!("edge {at} of node {index} ends at a missing node"));
            }
            if previous != NIL && back != previous {
                return Err(format!("edge {at} of node {index} does not point back"));
            }
            (previous, at, count) = (at, next, count + 1);
            if count > self.n_edges() {
                return Err(format!("the list of node {index} runs in a ring"));
            }
        }
        let edge = self.edges.edges.get(first as usize);
        let last = edge.map_or(NIL, |e| {
            if is_out {
                e.previous_out
            } else {
                e.previous_in
            }
        });
        if last == previous {
            Ok(count)
        } else {
            Err(format!("wrong last edge of node {index}"))
        }
    }
}
