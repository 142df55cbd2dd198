//! Extents: all nodes of a type, those inserted last first.
//!
//! That is GroIMP's order (golden model 29): the nodes of the newest step come before older ones. A step inserts its nodes
//! in reverse, so that among themselves they stand in the order of the rules and their right-hand sides.

use super::arena::{NIL, extend};
use super::store::{Graph, Header};
use super::{NodeId, Payload, TypeId};
use std::cmp::Reverse;

/// Nodes of exactly one type.
#[derive(Clone, Debug, Default)]
struct Extent {
    /// Node places in order of insertion; [`NIL`] where one was removed.
    places: Vec<u32>,
    n_removed: usize,
    /// Whether there ever was a node.
    is_used: bool,
}

impl Extent {
    /// Closes the gaps if they are more than half.
    fn close_gaps(&mut self, nodes: &mut [Header]) {
        if self.n_removed * 2 <= self.places.len() {
            return;
        }
        self.places.retain(|&index| index != NIL);
        self.n_removed = 0;
        for (place, &index) in self.places.iter().enumerate() {
            nodes[index as usize].extent_place = place as u32;
        }
    }
}

/// The extents of all types.
#[derive(Clone, Debug, Default)]
pub(super) struct Extents {
    by_type: Vec<Extent>,
}

impl Extents {
    pub(super) fn new(n_types: usize) -> Self {
        Self {
            by_type: vec![Extent::default(); n_types],
        }
    }

    /// Adds a node at the end and returns its place.
    pub(super) fn push(&mut self, ty: TypeId, index: u32) -> u32 {
        let extent = &mut self.by_type[usize::from(ty.0)];
        extent.is_used = true;
        let places = &mut extent.places;
        places.push(index);
        (places.len() - 1) as u32
    }

    /// Removes the node at a place; closes the gaps when they are more than half.
    pub(super) fn remove(&mut self, ty: TypeId, place: u32, nodes: &mut [Header]) {
        self.vacate(ty, place);
        self.by_type[usize::from(ty.0)].close_gaps(nodes);
    }

    /// Leaves a gap at a place, for [`Extents::close_gaps`].
    pub(super) fn vacate(&mut self, ty: TypeId, place: u32) {
        let extent = &mut self.by_type[usize::from(ty.0)];
        extent.places[place as usize] = NIL;
        extent.n_removed += 1;
    }

    /// Closes the gaps of all extents where they are more than half.
    pub(super) fn close_gaps(&mut self, nodes: &mut [Header]) {
        for extent in &mut self.by_type {
            extent.close_gaps(nodes);
        }
    }

    /// Adds `n` times `length` nodes at the end, in parallel; `node` tells their places by number and place in the group.
    pub(super) fn append(
        &mut self,
        ty: TypeId,
        n: usize,
        length: usize,
        node: impl Fn(usize, usize) -> u32 + Sync,
    ) {
        let extent = &mut self.by_type[usize::from(ty.0)];
        extent.is_used |= n * length > 0;
        extend(&mut extent.places, n, length, node);
    }

    /// Notes that there is a node of this type, in the graph or not.
    #[inline]
    pub(super) fn note(&mut self, ty: TypeId) {
        self.by_type[usize::from(ty.0)].is_used = true;
    }

    /// By type, whether there ever was a node of it.
    pub(super) fn used(&self) -> Vec<bool> {
        self.by_type.iter().map(|extent| extent.is_used).collect()
    }

    /// Number of places in the extent of a type, gaps included.
    pub(super) fn n_places_of(&self, ty: TypeId) -> usize {
        self.by_type[usize::from(ty.0)].places.len()
    }

    pub(super) fn exactly(&self, ty: TypeId) -> impl Iterator<Item = usize> {
        let places = &self.by_type[usize::from(ty.0)].places;
        places
            .iter()
            .rev()
            .filter(|&&index| index != NIL)
            .map(|&index| index as usize)
    }

    fn count(&self, ty: TypeId) -> usize {
        let extent = &self.by_type[usize::from(ty.0)];
        extent.places.len() - extent.n_removed
    }

    pub(super) fn place(&self, ty: TypeId, place: u32) -> Option<u32> {
        self.by_type[usize::from(ty.0)]
            .places
            .get(place as usize)
            .copied()
    }

    pub(super) fn n_places(&self) -> usize {
        self.by_type.iter().map(|e| e.places.len()).sum()
    }
}

impl<O: Payload> Graph<O> {
    /// The nodes of a type and of those that extend it: types in table order, of each the nodes inserted last first.
    pub fn extent(&self, ty: TypeId) -> impl Iterator<Item = NodeId> {
        let types = self.types()[ty].descendants().iter();
        types
            .flat_map(|&t| self.extents.exactly(t))
            .map(|index| self.id(index))
    }

    /// A number by which nodes of one [`Graph::extent`] are ordered as it lists them.
    pub(crate) fn extent_order(&self, node: NodeId) -> (TypeId, Reverse<u32>) {
        let header = &self.nodes[node.index()];
        (header.type_id, Reverse(header.extent_place))
    }

    /// Number of nodes of a type and of those that extend it.
    pub fn count(&self, ty: TypeId) -> usize {
        self.types()[ty]
            .descendants()
            .iter()
            .map(|&t| self.extents.count(t))
            .sum()
    }

    /// Number of nodes of exactly this type.
    pub fn count_exactly(&self, ty: TypeId) -> usize {
        self.extents.count(ty)
    }
}
