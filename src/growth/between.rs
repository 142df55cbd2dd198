//! A model between two steps: what both steps have goes over from one to the other, what is new grows.
//!
//! Nodes are the same if they have the same name: a rule that keeps a node (`==>>`, `::>`) keeps its name, one that replaces
//! it (`==>`) makes new ones.

use super::grow::Growth;
use crate::graph::{FieldId, FieldKind, NodeId};
use std::collections::{BTreeMap, BTreeSet};

/// The fields by which a shape or a movement is large or small.
const SIZES: [&str; 7] = [
    "length",
    "diameter",
    "radius",
    "width",
    "height",
    "baseRadius",
    "topRadius",
];

/// The numbers in all nodes of a model at one step.
#[derive(Clone, Debug, Default)]
pub struct Earlier {
    nodes: BTreeMap<NodeId, Vec<(FieldId, f64)>>,
}

impl Earlier {
    /// The nodes there were.
    pub fn nodes(&self) -> impl Iterator<Item = NodeId> + '_ {
        self.nodes.keys().copied()
    }
}

impl Growth {
    /// The numbers in all nodes as they are now.
    pub fn numbers(&self) -> Earlier {
        let mut earlier = Earlier::default();
        for node in self.nodes() {
            earlier.nodes.insert(node, self.numbers_of(node));
        }
        earlier
    }

    /// Moves the model to where it stood at `part` (more than 0, at most 1) of the way from `earlier` to now: numbers of nodes
    /// that were there then lie between, new nodes have that part of their size. New nodes without a size are given back: who
    /// draws them makes them small. The model is for drawing only from here on.
    pub fn go_back(&mut self, earlier: &Earlier, part: f64) -> BTreeSet<NodeId> {
        let mut young = BTreeSet::new();
        for node in self.nodes() {
            let now = self.numbers_of(node);
            let changes: Vec<(FieldId, f64)> = match earlier.nodes.get(&node) {
                Some(then) => {
                    let pairs = then.iter().zip(&now);
                    pairs
                        .filter(|((_, then), (_, now))| then != now)
                        .map(|((field, then), (_, now))| (*field, then + (now - then) * part))
                        .collect()
                }
                None => {
                    let sizes = self.sizes_of(node);
                    let own = now.into_iter().filter(|(field, _)| sizes.contains(field));
                    own.map(|(field, size)| (field, size * part)).collect()
                }
            };
            if changes.is_empty() && !earlier.nodes.contains_key(&node) {
                young.insert(node);
            }
            for (field, value) in changes {
                // The node exists: it was just met.
                let _ = self.graph_mut().set_f64(node, field, value);
            }
        }
        young
    }

    /// All nodes that can be reached, in the order of their names.
    fn nodes(&self) -> BTreeSet<NodeId> {
        let mut nodes = BTreeSet::new();
        let graph = self.graph();
        graph.walk(graph.root(), |event| {
            if let crate::graph::Event::Node(node) = event {
                nodes.insert(node);
            }
        });
        nodes
    }

    /// The fields of a node that hold numbers with a fraction.
    fn numbers_of(&self, node: NodeId) -> Vec<(FieldId, f64)> {
        let graph = self.graph();
        let Ok(ty) = graph.type_of(node) else {
            return vec![];
        };
        let fields = (0_u16..).zip(&graph.types()[ty].fields);
        fields
            .filter(|(_, field)| matches!(field.kind, FieldKind::Float | FieldKind::Double))
            .filter_map(|(number, _)| {
                let field = FieldId(number);
                Some((field, graph.get_f64(node, field).ok()?))
            })
            .collect()
    }

    /// The fields of a node that say how large it is.
    fn sizes_of(&self, node: NodeId) -> Vec<FieldId> {
        let graph = self.graph();
        let Ok(ty) = graph.type_of(node) else {
            return vec![];
        };
        let builtin = graph.types()[ty].builtin;
        let fields = (0_u16..).zip(&graph.types()[builtin].fields);
        fields
            .filter(|(_, field)| SIZES.contains(&&*field.name))
            .map(|(number, _)| FieldId(number))
            .collect()
    }
}
