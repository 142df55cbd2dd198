//! The stored hierarchy.

use super::build::Box3;
use super::simd::WIDTH;

/// An inner node with up to eight children, 224 bytes.
///
/// | bytes | what |
/// |---|---|
/// | 0..96 | smallest x, y and z of the eight boxes |
/// | 96..192 | largest x, y and z of the eight boxes |
/// | 192..224 | the eight children |
///
/// A missing child has a box from +∞ to -∞, which no ray meets.
#[derive(Clone, Copy, Debug, PartialEq)]
#[repr(C, align(32))]
pub(super) struct Node {
    /// Smallest x, y, z, then largest x, y, z of each child.
    pub(super) planes: [[f32; WIDTH]; 6],
    /// What is in each box.
    pub(super) children: [Child; WIDTH],
}

/// What is in a box: a node, if the upper three bits are set, with its number in the others; or a leaf, with its name.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) struct Child(pub(super) u32);

/// Names of leaves are smaller than this.
const FIRST_NODE: u32 = 7 << 29;

impl Child {
    /// The root of a hierarchy.
    pub(super) const ROOT: Self = Self(FIRST_NODE);
    /// Not a child: the end of a hierarchy within another, on the waiting list.
    pub(super) const LEAVE: Self = Self(u32::MAX);

    /// A node.
    pub(super) fn node(number: usize) -> Self {
        Self(FIRST_NODE | number as u32)
    }

    /// The number of the node, or `None` for a leaf.
    #[inline(always)]
    pub(super) fn as_node(self) -> Option<usize> {
        (self.0 >= FIRST_NODE).then_some((self.0 & !FIRST_NODE) as usize)
    }
}

impl Node {
    /// A node without children.
    pub(super) const EMPTY: Self = Self {
        planes: [
            [f32::INFINITY; WIDTH],
            [f32::INFINITY; WIDTH],
            [f32::INFINITY; WIDTH],
            [f32::NEG_INFINITY; WIDTH],
            [f32::NEG_INFINITY; WIDTH],
            [f32::NEG_INFINITY; WIDTH],
        ],
        children: [Child(0); WIDTH],
    };

    /// Puts a child into place `index`.
    pub(super) fn set(&mut self, index: usize, bounds: &Box3, child: Child) {
        for axis in 0..3 {
            self.planes[axis][index] = bounds.min[axis];
            self.planes[axis + 3][index] = bounds.max[axis];
        }
        self.children[index] = child;
    }
}

/// A hierarchy of boxes with eight children per node.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Bvh {
    /// The root first, every node before its children; empty if there is nothing to hold.
    pub(super) nodes: Vec<Node>,
}

impl Bvh {
    /// Gives the leaves names of their own, below 7 · 2²⁹; `name` is told their numbers.
    pub fn relabel(&mut self, mut name: impl FnMut(u32) -> u32) {
        for node in &mut self.nodes {
            for lane in 0..WIDTH {
                let is_there = node.planes[0][lane] <= node.planes[3][lane];
                let child = &mut node.children[lane];
                if is_there && child.as_node().is_none() {
                    child.0 = name(child.0).min(FIRST_NODE - 1);
                }
            }
        }
    }

    /// Memory of the nodes, in bytes.
    #[must_use]
    pub fn bytes(&self) -> usize {
        self.nodes.len() * size_of::<Node>()
    }
}
