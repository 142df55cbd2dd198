//! Which node of the graph a primitive belongs to.

use crate::diag::Span;
use crate::graph::{Graph, NodeId, Payload, TypeId, TypeTable};
use crate::scene::description::OrganId;
use std::collections::HashMap;
use std::sync::Arc;

/// A node that was drawn.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Organ {
    /// The node.
    pub node: NodeId,
    /// Its type.
    pub type_id: TypeId,
    /// How often it stands in the scene: more than once in the grid of a `GridClonerNode`.
    pub copies: u64,
}

/// All nodes that were drawn, by organ number, in the order they were drawn. What a body draws belongs to the node that
/// has the body.
#[derive(Clone, Debug)]
pub struct Organs {
    types: Arc<TypeTable>,
    /// Where each type is declared.
    spans: Vec<Option<Span>>,
    /// Where nodes of each type are made.
    made: Vec<Vec<Span>>,
    list: Vec<Organ>,
}

impl Organs {
    pub(super) const fn new(
        types: Arc<TypeTable>,
        spans: Vec<Option<Span>>,
        made: Vec<Vec<Span>>,
    ) -> Self {
        Self {
            types,
            spans,
            made,
            list: Vec::new(),
        }
    }

    /// The node behind an organ number.
    #[must_use]
    pub fn get(&self, organ: OrganId) -> Option<Organ> {
        self.list.get(organ.0 as usize).copied()
    }

    /// Name of the organ's type.
    #[must_use]
    pub fn type_name(&self, organ: OrganId) -> Option<&str> {
        Some(&self.types[self.get(organ)?.type_id].name)
    }

    /// Where the organ's module is declared; `None` for built-in types.
    #[must_use]
    pub fn declared_at(&self, organ: OrganId) -> Option<Span> {
        let ty = self.get(organ)?.type_id;
        self.spans.get(usize::from(ty.0)).copied().flatten()
    }

    /// Where in the text nodes of the organ's type are made.
    #[must_use]
    pub fn made_at(&self, organ: OrganId) -> &[Span] {
        let ty = self.get(organ).map(|organ| usize::from(organ.type_id.0));
        ty.and_then(|ty| self.made.get(ty))
            .map_or(&[], Vec::as_slice)
    }

    /// All organs, in the order of their numbers.
    #[must_use]
    pub fn list(&self) -> &[Organ] {
        &self.list
    }

    /// The plant that each organ belongs to: what hangs on one edge of the root of the graph. Plants are numbered in the order in
    /// which their first organs are drawn.
    #[must_use]
    pub fn plants<O: Payload>(&self, graph: &Graph<O>) -> Vec<u32> {
        // Looked up only, never iterated. Each node is climbed over once.
        let mut known: HashMap<NodeId, u32> = HashMap::new();
        let mut n_plants = 0;
        let mut plant_of = |organ: &Organ| {
            let (mut node, mut climbed) = (organ.node, Vec::new());
            let plant = loop {
                if let Some(plant) = known.get(&node) {
                    break *plant;
                }
                // Also ends the climb round a ring.
                known.insert(node, n_plants);
                climbed.push(node);
                match graph.predecessor(node) {
                    Some((above, _)) if above != graph.root() => node = above,
                    _ => break n_plants,
                }
            };
            if plant == n_plants {
                n_plants += 1;
            } else {
                known.extend(climbed.into_iter().map(|node| (node, plant)));
            }
            plant
        };
        self.list.iter().map(&mut plant_of).collect()
    }

    /// Number of organs so far.
    pub(super) fn len(&self) -> usize {
        self.list.len()
    }

    /// Notes that the organs from number `first` on stand in a grid of so many copies.
    pub(super) fn copy(&mut self, first: usize, copies: u64) {
        for organ in self.list.iter_mut().skip(first) {
            organ.copies = organ.copies.saturating_mul(copies);
        }
    }

    /// The number of a node: that of the last organ, or a new one.
    pub(super) fn number(&mut self, node: NodeId, type_id: TypeId) -> OrganId {
        if self.list.last().is_none_or(|last| last.node != node) {
            self.list.push(Organ {
                node,
                type_id,
                copies: 1,
            });
        }
        // Beyond four thousand million organs all share the last number; memory ends long before.
        OrganId(u32::try_from(self.list.len() - 1).unwrap_or(u32::MAX))
    }
}
