//! Memory of a graph: words and objects of nodes, recycled block by block.

use rayon::iter::{
    IndexedParallelIterator, IntoParallelIterator, ParallelExtend, ParallelIterator,
};

/// No place in an arena.
pub(super) const NIL: u32 = u32::MAX;

/// Blocks of 32-bit words. Blocks of equal length are chained in a free list through their first word.
#[derive(Clone, Debug, Default)]
pub(super) struct WordArena {
    words: Vec<u32>,
    /// First free block of each length, or [`NIL`].
    free: Vec<u32>,
}

impl WordArena {
    /// A block that holds a copy of `template`; 0 for an empty one.
    pub(super) fn allocate(&mut self, template: &[u32]) -> u32 {
        let length = template.len();
        if length == 0 {
            return 0;
        }
        let recycled = self.free.get(length).copied().filter(|&at| at != NIL);
        if let Some(at) = recycled {
            self.free[length] = self.words[at as usize];
            self.words[at as usize..][..length].copy_from_slice(template);
            return at;
        }
        let at = self.words.len() as u32;
        self.words.extend_from_slice(template);
        at
    }

    /// Writes `n` new blocks of `length` words each, in parallel, and returns where the first begins.
    pub(super) fn append(
        &mut self,
        n: usize,
        length: usize,
        word: impl Fn(usize, usize) -> u32 + Sync,
    ) -> u32 {
        let at = self.words.len() as u32;
        extend(&mut self.words, n, length, word);
        at
    }

    pub(super) fn release(&mut self, at: u32, length: usize) {
        if length == 0 {
            return;
        }
        if self.free.len() <= length {
            self.free.resize(length + 1, NIL);
        }
        self.words[at as usize] = self.free[length];
        self.free[length] = at;
    }

    pub(super) fn get(&self, at: u32) -> u32 {
        self.words[at as usize]
    }

    pub(super) fn set(&mut self, at: u32, word: u32) {
        self.words[at as usize] = word;
    }

    /// Words that hold something or are kept for reuse.
    pub(super) fn len(&self) -> usize {
        self.words.len()
    }
}

/// Appends `n` groups of `length` items each, in parallel; `item` makes them by number of the group and place in it.
pub(super) fn extend<T: Send>(
    items: &mut Vec<T>,
    n: usize,
    length: usize,
    item: impl Fn(usize, usize) -> T + Sync,
) {
    if n * length < MIN_SHARE {
        items.reserve(n * length);
        for group in 0..n {
            items.extend((0..length).map(|at| item(group, at)));
        }
    } else if length == 1 {
        let all = (0..n).into_par_iter().with_min_len(MIN_SHARE);
        items.par_extend(all.map(|i| item(i, 0)));
    } else {
        // A division of numbers below 2^32 as a multiplication by the rounded-up inverse; exact, see Lemire, Kaser and
        // Kurz, Faster remainder by direct computation, 2019.
        let inverse = u64::MAX / length as u64 + 1;
        let all = (0..n * length).into_par_iter().with_min_len(MIN_SHARE);
        items.par_extend(all.map(|i| {
            let group = ((u128::from(inverse) * i as u128) >> 64) as usize;
            item(group, i - group * length)
        }));
    }
}

/// Items that one thread writes at least; fewer are not worth the handing over.
pub(super) const MIN_SHARE: usize = 1 << 13;

/// Objects that words refer to by number; 0 is null and never stored.
#[derive(Clone, Debug, Default)]
pub(super) struct ObjectArena<O> {
    objects: Vec<O>,
    free: Vec<u32>,
}

impl<O: Clone + Default> ObjectArena<O> {
    pub(super) fn peek(&self, number: u32) -> Option<&O> {
        self.objects.get((number as usize).checked_sub(1)?)
    }

    /// Stores `value` under `number` if that is not 0, else under a new number, which is returned.
    pub(super) fn put(&mut self, number: u32, value: O) -> u32 {
        if number != 0 {
            self.objects[number as usize - 1] = value;
            return number;
        }
        match self.free.pop() {
            Some(number) => {
                self.objects[number as usize - 1] = value;
                number
            }
            None => {
                self.objects.push(value);
                self.objects.len() as u32
            }
        }
    }

    pub(super) fn release(&mut self, number: u32) {
        if number != 0 {
            self.objects[number as usize - 1] = O::default();
            self.free.push(number);
        }
    }

    pub(super) fn iter_mut(&mut self) -> impl Iterator<Item = &mut O> {
        self.objects.iter_mut()
    }

    pub(super) fn n_used(&self) -> usize {
        self.objects.len() - self.free.len()
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn blocks_of_equal_length_are_reused() {
        let mut arena = WordArena::default();
        let a = arena.allocate(&[1, 2, 3]);
        let b = arena.allocate(&[4]);
        arena.release(a, 3);
        arena.release(b, 1);
        assert_eq!(arena.allocate(&[7, 8, 9]), a);
        assert_eq!((arena.get(a + 1), arena.len()), (8, 4));
        let c = arena.allocate(&[7, 8, 9]);
        assert_eq!(c, 4);
    }

    #[test]
    fn groups_are_numbered_exactly() {
        for length in [1, 2, 3, 7, 10, 4097] {
            let mut items = vec![(9, 9)];
            for n in [0, 5, (1 << 17) / length + 3] {
                items.truncate(1);
                extend(&mut items, n, length, |group, at| (group, at));
                let wanted = (0..n).flat_map(|group| (0..length).map(move |at| (group, at)));
                assert!(items[1..].iter().copied().eq(wanted));
            }
        }
    }

    #[test]
    fn objects_are_reused() {
        let mut arena = ObjectArena::default();
        let a = arena.put(0, "a".to_owned());
        arena.release(a);
        assert_eq!(arena.put(0, "b".to_owned()), a);
        assert_eq!(
            (arena.peek(a), arena.peek(0), arena.n_used()),
            (Some(&"b".to_owned()), None, 1)
        );
    }
}
