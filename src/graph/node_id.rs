//! The name of a node.

use std::num::NonZeroU32;

/// A node of one graph. Copies stay cheap and safe: once the node is gone, access through them fails instead of finding
/// another node in its place.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash, PartialOrd, Ord)]
pub struct NodeId {
    /// Place in the arena, plus one.
    place: NonZeroU32,
    /// How often the place had been used before.
    generation: u32,
}

impl NodeId {
    pub(super) fn new(index: usize, generation: u32) -> Option<Self> {
        let place = u32::try_from(index + 1).ok().and_then(NonZeroU32::new)?;
        Some(Self { place, generation })
    }

    /// Place of the node in the arena; unique among the nodes that exist at one time, and reused afterwards.
    pub fn index(self) -> usize {
        self.place.get() as usize - 1
    }

    pub(super) fn generation(self) -> u32 {
        self.generation
    }
}
