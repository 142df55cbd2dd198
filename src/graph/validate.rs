//! Checks every invariant of a graph; for tests and debug builds.

use super::arena::NIL;
use super::links::Links;
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
        let (links, nodes) = (&self.links, &self.nodes);
        let first = if is_out {
            nodes[index].first_out
        } else {
            Links::first_in(nodes, index as u32)
        };
        let (mut at, mut previous, mut count) = (first, NIL, 0);
        while at != NIL {
            let link = *links.link(nodes, at);
            let (from, to) = (link.from as usize, links.target(at) as usize);
            let (own, other) = if is_out { (from, to) } else { (to, from) };
            let bits = links.bits(nodes, at);
            let twin = self.edge_bits(self.id(from), self.id(to));
            if own != index || bits == EdgeBits::NONE || twin != bits {
                return Err(format!(
                    "edge {at} in the list of node {index} does not belong there"
                ));
            }
            if nodes[other].flags & LIVE == 0 {
                return Err(format!("edge {at} of node {index} ends at a missing node"));
            }
            if is_out && previous != NIL && link.previous_out != previous {
                return Err(format!("edge {at} of node {index} does not point back"));
            }
            let next = if is_out {
                link.next_out
            } else {
                links.next_in(nodes, at)
            };
            (previous, at, count) = (at, next, count + 1);
            if count > self.n_edges() {
                return Err(format!("the list of node {index} runs in a ring"));
            }
        }
        if !is_out || first == NIL || links.link(nodes, first).previous_out == previous {
            Ok(count)
        } else {
            Err(format!("wrong last edge of node {index}"))
        }
    }
}
