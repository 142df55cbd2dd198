//! Boxes that a ray has yet to look into.

/// A box on the waiting list.
#[derive(Clone, Copy, Debug, Default)]
pub(super) struct Waiting {
    /// Where the ray enters it, in the ray's scaled parameter.
    pub(super) enter: f32,
    /// As in [`super::node::Child`].
    pub(super) first: u32,
    /// As in [`super::node::Child`].
    pub(super) count: u32,
}

/// Entries that need no heap: eight levels of full nodes.
const INLINE: usize = 64;

/// The waiting list of one ray, shared by all nested hierarchies it visits. It cannot overflow.
#[derive(Clone, Debug)]
pub struct TraversalStack {
    inline: [Waiting; INLINE],
    len: usize,
    /// What does not fit into `inline`; deep hierarchies only.
    overflow: Vec<Waiting>,
}

impl Default for TraversalStack {
    fn default() -> Self {
        Self {
            inline: [Waiting::default(); INLINE],
            len: 0,
            overflow: Vec::new(),
        }
    }
}

impl TraversalStack {
    #[inline]
    pub(super) fn len(&self) -> usize {
        self.len
    }

    #[inline]
    pub(super) fn push(&mut self, waiting: Waiting) {
        if let Some(slot) = self.inline.get_mut(self.len) {
            *slot = waiting;
        } else {
            self.overflow.push(waiting);
        }
        self.len += 1;
    }

    #[inline]
    pub(super) fn pop(&mut self) -> Waiting {
        self.len -= 1;
        match self.inline.get(self.len) {
            Some(waiting) => *waiting,
            None => self.overflow.pop().unwrap_or_default(),
        }
    }

    /// Drops all but the first `len` entries.
    pub(super) fn truncate(&mut self, len: usize) {
        self.len = len;
        self.overflow.truncate(len.saturating_sub(INLINE));
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn entries_come_back_in_reverse_past_the_inline_part() {
        let mut stack = TraversalStack::default();
        let entry = |first| Waiting {
            enter: 0.0,
            first,
            count: 0,
        };
        (0..200).for_each(|first| stack.push(entry(first)));
        assert_eq!(stack.pop().first, 199);
        stack.truncate(100);
        (0..100)
            .rev()
            .for_each(|first| assert_eq!(stack.pop().first, first));
        assert_eq!(stack.len(), 0);
    }
}
