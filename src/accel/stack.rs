//! Boxes that a ray has yet to look into.

use super::node::Child;

/// A box on the waiting list: above, the bits of where the ray enters it, in the ray's scaled parameter and at least 0, so
/// that nearer ones are smaller; below, what is in it.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub(super) struct Waiting(u64);

impl Waiting {
    #[inline(always)]
    pub(super) fn new(enter: f32, child: Child) -> Self {
        Self(u64::from(enter.to_bits()) << 32 | u64::from(child.0))
    }

    #[inline(always)]
    pub(super) fn enter(self) -> f32 {
        f32::from_bits((self.0 >> 32) as u32)
    }

    #[inline(always)]
    pub(super) fn child(self) -> Child {
        Child(self.0 as u32)
    }
}

/// Entries that need no heap: eight levels of full nodes.
const INLINE: usize = 64;

/// The waiting list of one ray, shared by all nested hierarchies it visits. It cannot overflow.
#[derive(Clone, Debug)]
pub(super) struct TraversalStack {
    inline: [Waiting; INLINE],
    len: usize,
    /// What does not fit into `inline`; deep hierarchies only.
    overflow: Vec<Waiting>,
}

impl TraversalStack {
    #[inline(always)]
    pub(super) fn new() -> Self {
        Self {
            inline: [Waiting(0); INLINE],
            len: 0,
            overflow: Vec::new(),
        }
    }

    #[inline(always)]
    pub(super) fn push(&mut self, waiting: Waiting) {
        if self.len == INLINE {
            self.spill();
        }
        if let Some(slot) = self.inline.get_mut(self.len) {
            *slot = waiting;
            self.len += 1;
        }
    }

    #[inline(always)]
    pub(super) fn pop(&mut self) -> Option<Waiting> {
        if self.len == 0 {
            return self.overflow.pop();
        }
        self.len -= 1;
        self.inline.get(self.len).copied()
    }

    /// Moves the last entry down past nearer ones, but not below the `fresh` last ones.
    #[inline(always)]
    pub(super) fn settle(&mut self, fresh: usize) {
        // What has been spilled stays where it is: order is a matter of speed only.
        let end = self.len.min(INLINE);
        let bottom = end.saturating_sub(fresh);
        let mut at = end;
        while at > bottom + 1 && self.inline[at - 2] < self.inline[at - 1] {
            self.inline.swap(at - 2, at - 1);
            at -= 1;
        }
    }

    /// Makes room: everything goes to the heap.
    #[cold]
    fn spill(&mut self) {
        self.overflow.extend_from_slice(&self.inline);
        self.len = 0;
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn entry(first: u32, enter: f32) -> Waiting {
        Waiting::new(enter, Child(first))
    }

    #[test]
    fn entries_come_back_in_reverse_past_the_inline_part() {
        let mut stack = TraversalStack::new();
        (0..200).for_each(|first| stack.push(entry(first, 0.0)));
        for first in (0..200).rev() {
            assert_eq!(stack.pop().map(|waiting| waiting.child().0), Some(first));
        }
        assert!(stack.pop().is_none());
    }

    #[test]
    fn settling_sorts_the_fresh_ones_only() {
        let mut stack = TraversalStack::new();
        stack.push(entry(0, 1.0));
        for (fresh, enter) in [3.0, 9.0, 5.0, 7.0].into_iter().enumerate() {
            stack.push(entry(1, enter));
            stack.settle(fresh + 1);
        }
        let order: Vec<f32> = std::iter::from_fn(|| stack.pop())
            .map(Waiting::enter)
            .collect();
        assert_eq!(order, [3.0, 5.0, 7.0, 9.0, 1.0]);
    }
}
