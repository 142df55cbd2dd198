//! The stored hierarchy.

use super::build::Box3;

/// Children of a node.
pub(super) const WIDTH: usize = 8;

/// An inner node with up to eight children, 256 bytes.
///
/// | bytes | what |
/// |---|---|
/// | 0..96 | smallest x, y and z of the eight boxes |
/// | 96..192 | largest x, y and z of the eight boxes |
/// | 192..256 | the eight children |
///
/// A missing child has a box from +∞ to -∞, which no ray meets.
#[derive(Clone, Copy, Debug, PartialEq)]
#[repr(C, align(64))]
pub(super) struct Node {
    /// Smallest x, y, z, then largest x, y, z of each child.
    pub(super) planes: [[f32; WIDTH]; 6],
    /// What is in each box.
    pub(super) children: [Child; WIDTH],
}

/// What is in a box: a node or a leaf.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) struct Child {
    /// Number of the node, or of the first item of the leaf.
    pub(super) first: u32,
    /// Number of items of the leaf, 0 for a node.
    pub(super) count: u32,
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
        children: [Child { first: 0, count: 0 }; WIDTH],
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
    /// Memory of the nodes, in bytes.
    #[must_use]
    pub fn bytes(&self) -> usize {
        self.nodes.len() * size_of::<Node>()
    }
}
