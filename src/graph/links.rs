//! How edges are kept: the first edge that leads to a node in the node's own header, further ones apart.
//!
//! In a tree every node has one parent, so that an edge there costs no memory but its place in the header. An edge is
//! named by a number: the place of its target, or [`EXTRA`] and a place in [`Links`].

use super::EdgeBits;
use super::arena::NIL;
use super::store::Header;
use std::collections::HashMap;

/// This bit of the name of an edge says that it is kept apart from its target.
pub(super) const EXTRA: u32 = 1 << 31;
/// More than one edge leads to the node; the others are in [`Links`].
const SHARED: u16 = 512;
/// The kinds of the edge in the header are in [`Links`].
const ODD: u16 = 1024;
/// Where the kinds of the edge in the header stand in its flags: successor, branch, refinement.
const BITS_SHIFT: u32 = 11;
/// All flags that describe the edge in the header.
const LINK_FLAGS: u16 = ODD | 7 << BITS_SHIFT;

/// Where an edge comes from, and its place in the list of edges that come from there. In that list `next_out` of the last
/// edge is [`NIL`] and `previous_out` of the first is the last.
#[derive(Clone, Copy, Debug)]
pub(super) struct Link {
    /// Place of the source; [`NIL`] if there is no edge.
    pub(super) from: u32,
    pub(super) next_out: u32,
    pub(super) previous_out: u32,
}

impl Link {
    pub(super) const NONE: Self = Self {
        from: NIL,
        next_out: NIL,
        previous_out: NIL,
    };
}

/// The flags that say what the edge in the header is; `None` for kinds that have no flag.
pub(super) fn link_flags(bits: EdgeBits) -> Option<u16> {
    let plain = EdgeBits::SUCCESSOR
        .union(EdgeBits::BRANCH)
        .union(EdgeBits::REFINEMENT);
    let is_plain = bits.without(plain) == EdgeBits::NONE;
    is_plain.then(|| (bits.number() >> PLAIN_SHIFT << BITS_SHIFT) as u16)
}

/// The kinds that such flags say.
pub(super) fn flags_bits(flags: u16) -> EdgeBits {
    EdgeBits::from_number(u32::from(flags >> BITS_SHIFT & 7) << PLAIN_SHIFT)
}

/// The three plain kinds are the bits of [`EdgeBits`] from here on.
const PLAIN_SHIFT: u32 = 21;

/// A second or further edge to a node. In the list of these, `next_in` of the last is [`NIL`] and `previous_in` of the
/// first is the last.
#[derive(Clone, Copy, Debug)]
struct Extra {
    link: Link,
    to: u32,
    /// None in vacant places, which are chained through `next_in`.
    bits: EdgeBits,
    next_in: u32,
    previous_in: u32,
}

/// The edges that are not in the headers.
#[derive(Clone, Debug)]
pub(super) struct Links {
    extras: Vec<Extra>,
    free: u32,
    n_free: usize,
    /// The first extra edge that leads to a node. Never iterated.
    firsts: HashMap<u32, u32>,
    /// Kinds that have no flag, by place of the target. Never iterated.
    odd: HashMap<u32, EdgeBits>,
    /// Number of all edges.
    pub(super) n_edges: usize,
}

impl Default for Links {
    fn default() -> Self {
        Self {
            extras: vec![],
            free: NIL,
            n_free: 0,
            firsts: HashMap::new(),
            odd: HashMap::new(),
            n_edges: 0,
        }
    }
}

impl Links {
    /// Whether no node has more than one incoming edge.
    pub(super) fn is_single(&self) -> bool {
        self.firsts.is_empty()
    }

    /// Whether there is room for another edge.
    pub(super) fn has_room(&self) -> bool {
        self.extras.len() < EXTRA as usize - 1
    }

    pub(super) fn memory(&self) -> usize {
        size_of::<Extra>() * self.extras.len()
            + size_of::<(u32, u32)>() * (self.firsts.len() + self.odd.len())
    }

    /// Source and neighbours of an edge.
    pub(super) fn link<'a>(&'a self, nodes: &'a [Header], at: u32) -> &'a Link {
        if at & EXTRA == 0 {
            &nodes[at as usize].link
        } else {
            &self.extras[(at & !EXTRA) as usize].link
        }
    }

    fn link_mut<'a>(&'a mut self, nodes: &'a mut [Header], at: u32) -> &'a mut Link {
        if at & EXTRA == 0 {
            &mut nodes[at as usize].link
        } else {
            &mut self.extras[(at & !EXTRA) as usize].link
        }
    }

    /// The node that an edge leads to.
    pub(super) fn target(&self, at: u32) -> u32 {
        if at & EXTRA == 0 {
            at
        } else {
            self.extras[(at & !EXTRA) as usize].to
        }
    }

    /// The kinds of an edge.
    pub(super) fn bits(&self, nodes: &[Header], at: u32) -> EdgeBits {
        if at & EXTRA != 0 {
            return self.extras[(at & !EXTRA) as usize].bits;
        }
        let flags = nodes[at as usize].flags;
        if flags & ODD != 0 {
            return self.odd.get(&at).copied().unwrap_or(EdgeBits::NONE);
        }
        flags_bits(flags)
    }

    pub(super) fn set_bits(&mut self, nodes: &mut [Header], at: u32, bits: EdgeBits) {
        if at & EXTRA != 0 {
            self.extras[(at & !EXTRA) as usize].bits = bits;
            return;
        }
        let flags = &mut nodes[at as usize].flags;
        if *flags & ODD != 0 {
            self.odd.remove(&at);
        }
        *flags &= !LINK_FLAGS;
        if let Some(plain) = link_flags(bits) {
            *flags |= plain;
        } else {
            *flags |= ODD;
            self.odd.insert(at, bits);
        }
    }

    /// The first edge that leads to a node.
    pub(super) fn first_in(nodes: &[Header], index: u32) -> u32 {
        if nodes[index as usize].link.from == NIL {
            NIL
        } else {
            index
        }
    }

    /// The next edge that leads to the same node.
    pub(super) fn next_in(&self, nodes: &[Header], at: u32) -> u32 {
        let next = if at & EXTRA != 0 {
            self.extras[(at & !EXTRA) as usize].next_in
        } else if nodes[at as usize].flags & SHARED != 0 {
            self.firsts.get(&at).copied().unwrap_or(NIL)
        } else {
            NIL
        };
        if next == NIL { NIL } else { next | EXTRA }
    }

    /// The edge between two nodes. Looks through both lists in turn, so that one long list does no harm.
    pub(super) fn find(&self, nodes: &[Header], source: u32, target: u32) -> Option<u32> {
        let mut back = Self::first_in(nodes, target);
        if back == NIL || nodes[target as usize].link.from == source {
            return (back != NIL).then_some(back);
        }
        back = self.next_in(nodes, back);
        let mut out = nodes[source as usize].first_out;
        while out != NIL && back != NIL {
            if self.target(out) == target {
                return Some(out);
            }
            let link = self.link(nodes, back);
            if link.from == source {
                return Some(back);
            }
            (out, back) = (self.link(nodes, out).next_out, self.next_in(nodes, back));
        }
        None
    }

    /// Makes an edge, as the last of both lists.
    pub(super) fn add(&mut self, nodes: &mut [Header], source: u32, target: u32, bits: EdgeBits) {
        let at = if nodes[target as usize].link.from == NIL {
            target
        } else {
            self.add_extra(nodes, target)
        };
        self.set_bits(nodes, at, bits);
        self.enter_out_list(nodes, source, at);
        self.n_edges += 1;
    }

    /// A place for a further edge to `target`, as the last one that leads there.
    fn add_extra(&mut self, nodes: &mut [Header], target: u32) -> u32 {
        let mut extra = Extra {
            link: Link::NONE,
            to: target,
            bits: EdgeBits::NONE,
            next_in: NIL,
            previous_in: NIL,
        };
        let place = if self.free == NIL {
            self.extras.push(extra);
            (self.extras.len() - 1) as u32
        } else {
            let place = self.free;
            self.free = self.extras[place as usize].next_in;
            self.n_free -= 1;
            place
        };
        extra.previous_in = place;
        if let Some(&first) = self.firsts.get(&target) {
            let last = std::mem::replace(&mut self.extras[first as usize].previous_in, place);
            self.extras[last as usize].next_in = place;
            extra.previous_in = last;
        } else {
            self.firsts.insert(target, place);
            nodes[target as usize].flags |= SHARED;
        }
        self.extras[place as usize] = extra;
        place | EXTRA
    }

    /// Removes an edge. If it is the one in the header, the next one that leads to the same node takes its place.
    pub(super) fn remove(&mut self, nodes: &mut [Header], at: u32) {
        self.leave_out_list(nodes, at);
        self.n_edges -= 1;
        if at & EXTRA != 0 {
            self.release(nodes, at & !EXTRA);
            return;
        }
        self.set_bits(nodes, at, EdgeBits::NONE);
        nodes[at as usize].link = Link::NONE;
        let next = self.next_in(nodes, at);
        if next != NIL {
            self.move_into_header(nodes, next, at);
        }
    }

    /// Makes `at` the last edge that comes from `source`.
    pub(super) fn enter_out_list(&mut self, nodes: &mut [Header], source: u32, at: u32) {
        let first = nodes[source as usize].first_out;
        let mut link = Link {
            from: source,
            next_out: NIL,
            previous_out: at,
        };
        if first == NIL {
            nodes[source as usize].first_out = at;
        } else {
            let last = std::mem::replace(&mut self.link_mut(nodes, first).previous_out, at);
            self.link_mut(nodes, last).next_out = at;
            link.previous_out = last;
        }
        *self.link_mut(nodes, at) = link;
    }

    /// Makes the edge in the header of `at`, which is in no list, the first one that comes from `source`, where all edges
    /// are in headers.
    pub(super) fn prepend(nodes: &mut [Header], source: u32, at: u32) {
        let first = std::mem::replace(&mut nodes[source as usize].first_out, at);
        let previous_out = if first == NIL {
            at
        } else {
            std::mem::replace(&mut nodes[first as usize].link.previous_out, at)
        };
        nodes[at as usize].link = Link {
            from: source,
            next_out: first,
            previous_out,
        };
    }

    /// Gives the edge in the header of `to` the kinds of that of `from`, whose own kinds mean nothing afterwards.
    pub(super) fn move_bits(&mut self, nodes: &mut [Header], from: u32, to: u32) {
        let kinds = nodes[from as usize].flags & LINK_FLAGS;
        let flags = &mut nodes[to as usize].flags;
        *flags = *flags & !LINK_FLAGS | kinds;
        if kinds & ODD != 0
            && let Some(bits) = self.odd.remove(&from)
        {
            self.odd.insert(to, bits);
        }
    }

    pub(super) fn leave_out_list(&mut self, nodes: &mut [Header], at: u32) {
        let Link {
            from,
            next_out,
            previous_out,
        } = *self.link(nodes, at);
        let first = nodes[from as usize].first_out;
        let after = if next_out == NIL { first } else { next_out };
        self.link_mut(nodes, after).previous_out = previous_out;
        if first == at {
            nodes[from as usize].first_out = next_out;
        } else {
            self.link_mut(nodes, previous_out).next_out = next_out;
        }
    }

    /// Keeps the extra edge `at` in the header of its target from now on.
    fn move_into_header(&mut self, nodes: &mut [Header], at: u32, target: u32) {
        let link = *self.link(nodes, at);
        let bits = self.bits(nodes, at);
        let first = nodes[link.from as usize].first_out;
        let before = if first == at { NIL } else { link.previous_out };
        nodes[target as usize].link = link;
        self.set_bits(nodes, target, bits);
        if before == NIL {
            nodes[link.from as usize].first_out = target;
        } else {
            self.link_mut(nodes, before).next_out = target;
        }
        let after = match (link.next_out, before) {
            (NIL, NIL) => target,
            (NIL, _) => first,
            (next, _) => next,
        };
        self.link_mut(nodes, after).previous_out = target;
        self.release(nodes, at & !EXTRA);
    }

    /// Takes an extra edge from the list of its target and frees its place.
    fn release(&mut self, nodes: &mut [Header], place: u32) {
        let Extra {
            to,
            next_in,
            previous_in,
            ..
        } = self.extras[place as usize];
        let first = self.firsts.get(&to).copied().unwrap_or(place);
        let after = if next_in == NIL { first } else { next_in };
        self.extras[after as usize].previous_in = previous_in;
        if first != place {
            self.extras[previous_in as usize].next_in = next_in;
        } else if next_in == NIL {
            self.firsts.remove(&to);
            nodes[to as usize].flags &= !SHARED;
        } else {
            self.firsts.insert(to, next_in);
        }
        let extra = &mut self.extras[place as usize];
        (extra.bits, extra.next_in) = (EdgeBits::NONE, self.free);
        self.free = place;
        self.n_free += 1;
    }
}
