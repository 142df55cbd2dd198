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

    /// The whole name as one number, never 0.
    pub fn to_bits(self) -> u64 {
        (u64::from(self.generation) << 32) | u64::from(self.place.get())
    }

    /// The name that [`Self::to_bits`] made this number of; `None` for 0.
    pub fn from_bits(bits: u64) -> Option<Self> {
        let place = NonZeroU32::new(bits as u32)?;
        Some(Self {
            place,
            generation: (bits >> 32) as u32,
        })
    }

    pub(super) fn generation(self) -> u32 {
        self.generation
    }
}
