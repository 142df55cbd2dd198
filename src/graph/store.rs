//! The graph itself: birth and death of nodes.

use super::arena::{NIL, ObjectArena, WordArena};
use super::extents::Extents;
use super::links::{Link, Links};
use super::{FieldId, NodeId, Payload, TypeId, TypeTable};
use std::collections::HashMap;
use std::sync::Arc;

/// What can go wrong with a graph; each is the model's fault.
#[derive(Clone, Debug, PartialEq, Eq, thiserror::Error)]
pub enum GraphError {
    /// A node was used after a step that removed it.
    #[error("the node is no longer part of the graph")]
    DeletedNode,
    /// The graph would grow beyond its limit.
    #[error("more than {limit} modules")]
    TooManyNodes {
        /// Greatest number of nodes at one time.
        limit: usize,
    },
    /// A rule wants an edge from a node to itself.
    #[error("an edge from a node to itself")]
    SelfEdge,
}

/// What is kept of a node besides its words: among others the first edge that leads to it, see [`Links`].
#[derive(Clone, Copy, Debug)]
pub(super) struct Header {
    pub(super) type_id: TypeId,
    pub(super) flags: u16,
    pub(super) generation: u32,
    /// Start of the node's words.
    pub(super) words: u32,
    /// First outgoing edge, or [`NIL`].
    pub(super) first_out: u32,
    /// First incoming edge.
    pub(super) link: Link,
    /// Place in the extent of its type, while it is in the graph.
    pub(super) extent_place: u32,
}

/// The place is taken.
pub(super) const LIVE: u16 = 1;
/// The node is in its extent: queries find it.
pub(super) const INSERTED: u16 = 2;
/// The node has rare attributes.
pub(super) const HAS_SIDE: u16 = 4;
/// A rule of the running step has consumed the node.
pub(super) const CONSUMED: u16 = 8;
/// Reached by the running sweep.
pub(super) const REACHED: u16 = 16;
/// Waits to be looked at by the sweep at the end of the step.
pub(super) const CANDIDATE: u16 = 32;

/// The queue of the running step knows the node.
const QUEUED: u16 = 64;
/// The node has lost an incoming edge in the running step.
pub(super) const LOST: u16 = 128;
/// On the way that the running sweep looks at.
pub(super) const ON_WAY: u16 = 256;

/// A rare attribute.
#[derive(Clone, Debug)]
pub(super) enum SideValue<O> {
    Words([u32; 2]),
    Object(O),
}

/// Typed nodes, directed edges between them, extents. `O` is what object fields hold.
///
/// An F with three parameters and one edge takes 48 bytes: header with the edge 32, extent 4, words 12.
#[derive(Clone, Debug)]
pub struct Graph<O> {
    pub(super) types: Arc<TypeTable>,
    pub(super) nodes: Vec<Header>,
    pub(super) free_nodes: Vec<u32>,
    pub(super) words: WordArena,
    pub(super) objects: ObjectArena<O>,
    /// Rare attributes by node and field. Never iterated.
    pub(super) side: HashMap<(u32, u16), SideValue<O>>,
    pub(super) links: Links,
    pub(super) extents: Extents,
    pub(super) candidates: Vec<u32>,
    root: NodeId,
    limit: usize,
    stamp: u64,
    shape_stamp: u64,
}

impl<O: Payload> Graph<O> {
    /// A graph with a root of type `RGGRoot` and one `Axiom` as its successor. It holds at most `limit` nodes at a time.
    pub fn new(types: Arc<TypeTable>, limit: usize) -> Result<Self, GraphError> {
        let extents = Extents::new(types.len());
        // The true root replaces this name below.
        let root = NodeId::new(0, 0).ok_or(GraphError::TooManyNodes { limit })?;
        let mut graph = Self {
            types,
            nodes: vec![],
            free_nodes: vec![],
            words: WordArena::default(),
            objects: ObjectArena::default(),
            side: HashMap::new(),
            links: Links::default(),
            extents,
            candidates: vec![],
            root,
            limit,
            stamp: 0,
            shape_stamp: 0,
        };
        // A module of the model may have the same name as a built-in type, which stands first.
        let named = |name: &str| graph.types.iter().find(|(_, ty)| &*ty.name == name);
        let ty = |name| named(name).map_or(TypeId(0), |(ty, _)| ty);
        let (root_type, axiom_type) = (ty("RGGRoot"), ty("Axiom"));
        graph.root = graph.create(root_type)?;
        graph.insert(graph.root)?;
        let axiom = graph.create(axiom_type)?;
        graph.insert(axiom)?;
        graph.add_edge(graph.root, axiom, super::EdgeBits::SUCCESSOR)?;
        graph.end_of_step();
        Ok(graph)
    }

    /// By type, whether there ever was a node of exactly it.
    pub fn used_types(&self) -> Vec<bool> {
        self.extents.used()
    }

    /// What object fields hold, in no order.
    pub fn objects_mut(&mut self) -> impl Iterator<Item = &mut O> {
        let side = self.side.values_mut().filter_map(|value| match value {
            SideValue::Object(object) => Some(object),
            SideValue::Words(_) => None,
        });
        self.objects.iter_mut().chain(side)
    }

    /// Goes on with these types, equal to those it has, and this limit.
    pub fn adopt(&mut self, types: Arc<TypeTable>, limit: usize) {
        self.types = types;
        self.limit = limit;
    }

    /// Places for nodes, taken or not: a measure of the memory it takes.
    pub fn n_places(&self) -> usize {
        self.nodes.len()
    }

    /// The types of its nodes.
    pub fn types(&self) -> &Arc<TypeTable> {
        &self.types
    }

    /// The root, which is never removed.
    pub fn root(&self) -> NodeId {
        self.root
    }

    /// Greatest number of nodes at one time.
    pub fn limit(&self) -> usize {
        self.limit
    }

    /// A number that changes with every change of the graph or of a field.
    pub fn stamp(&self) -> u64 {
        self.stamp
    }

    /// A number that changes with every change that can move or reshape something: edges, nodes, fields of built-in types.
    pub fn shape_stamp(&self) -> u64 {
        self.shape_stamp
    }

    pub(super) fn touch(&mut self, is_shape: bool) {
        self.stamp += 1;
        self.shape_stamp += u64::from(is_shape);
    }

    /// Number of nodes that exist, in the graph or not.
    pub fn n_nodes(&self) -> usize {
        self.nodes.len() - self.free_nodes.len()
    }

    /// A new node with the default values of its type. Queries do not find it until [`Graph::insert`].
    pub fn create(&mut self, ty: TypeId) -> Result<NodeId, GraphError> {
        if self.n_nodes() >= self.limit.min(MOST_NODES) || self.words.len() > MOST_WORDS {
            return Err(GraphError::TooManyNodes { limit: self.limit });
        }
        self.extents.note(ty);
        let words = self.words.allocate(self.types[ty].template());
        let index = match self.free_nodes.pop() {
            Some(index) => index as usize,
            None => {
                let generation = 0;
                self.nodes.push(Header {
                    generation,
                    ..Header::VACANT
                });
                self.nodes.len() - 1
            }
        };
        let header = &mut self.nodes[index];
        let generation = header.generation;
        *header = Header {
            type_id: ty,
            flags: LIVE,
            generation,
            words,
            ..Header::VACANT
        };
        self.stamp += 1;
        NodeId::new(index, generation).ok_or(GraphError::TooManyNodes { limit: self.limit })
    }

    /// Makes a node part of its extent, as the one to be found first; nothing happens if it is already.
    pub fn insert(&mut self, node: NodeId) -> Result<(), GraphError> {
        let index = self.live_index(node)?;
        let header = &mut self.nodes[index];
        if header.flags & INSERTED == 0 {
            header.flags = header.flags & !QUEUED | INSERTED;
            header.extent_place = self.extents.push(header.type_id, index as u32);
            self.touch(true);
            self.nominate_new(index);
        }
        Ok(())
    }

    /// Removes a node with all its edges; what hung below it is looked at by [`Graph::end_of_step`]. The root stays.
    pub fn remove(&mut self, node: NodeId) {
        let Ok(index) = self.live_index(node) else {
            return;
        };
        if node == self.root {
            return;
        }
        self.remove_all_edges(index);
        let Header {
            type_id,
            flags,
            words,
            extent_place,
            ..
        } = self.nodes[index];
        if flags & INSERTED != 0 {
            self.extents.remove(type_id, extent_place, &mut self.nodes);
        }
        self.release_fields(index);
        self.words
            .release(words, self.types[type_id].template().len());
        let header = &mut self.nodes[index];
        header.flags &= CANDIDATE | LOST;
        header.generation = header.generation.wrapping_add(1);
        self.free_nodes.push(index as u32);
        self.touch(flags & INSERTED != 0);
    }

    /// Frees a floating node; nodes of the graph stay.
    pub fn discard(&mut self, node: NodeId) {
        if self.exists(node) && !self.is_inserted(node) {
            self.remove(node);
        }
    }

    /// Notes that the queue knows a floating node; false if it is in the graph or was noted before.
    pub(crate) fn mark_queued(&mut self, node: NodeId) -> bool {
        let Ok(index) = self.live_index(node) else {
            return false;
        };
        let flags = &mut self.nodes[index].flags;
        let is_first = *flags & (INSERTED | QUEUED) == 0;
        *flags |= if is_first { QUEUED } else { 0 };
        is_first
    }

    pub(crate) fn is_queued(&self, node: NodeId) -> bool {
        self.live_index(node)
            .is_ok_and(|i| self.nodes[i].flags & QUEUED != 0)
    }

    pub(super) fn release_fields(&mut self, index: usize) {
        let Header {
            type_id,
            flags,
            words,
            ..
        } = self.nodes[index];
        let ty = &self.types[type_id];
        for &offset in ty.object_words() {
            self.objects
                .release(self.words.get(words + u32::from(offset)));
        }
        if flags & HAS_SIDE != 0 {
            for field in 0..ty.fields.len() as u16 {
                self.side.remove(&(index as u32, field));
            }
        }
    }

    /// Whether the node still exists.
    pub fn exists(&self, node: NodeId) -> bool {
        self.live_index(node).is_ok()
    }

    /// Whether queries find the node.
    pub fn is_inserted(&self, node: NodeId) -> bool {
        self.live_index(node)
            .is_ok_and(|i| self.nodes[i].flags & INSERTED != 0)
    }

    /// The type of a node.
    pub fn type_of(&self, node: NodeId) -> Result<TypeId, GraphError> {
        Ok(self.nodes[self.live_index(node)?].type_id)
    }

    /// Whether the node exists and is of type `ty` or of one that extends it.
    pub fn is_a(&self, node: NodeId, ty: TypeId) -> bool {
        self.type_of(node)
            .is_ok_and(|t| t == ty || self.types.is_a(t, ty))
    }

    /// Whether [`Graph::consume`] was called for the node in this step.
    pub fn is_consumed(&self, node: NodeId) -> bool {
        self.live_index(node)
            .is_ok_and(|i| self.nodes[i].flags & CONSUMED != 0)
    }

    /// Notes that a rule has consumed the node: later rules of the step do not match it.
    pub fn consume(&mut self, node: NodeId) {
        if let Ok(index) = self.live_index(node) {
            self.nodes[index].flags |= CONSUMED;
        }
    }

    pub(crate) fn forget_consumed(&mut self, node: NodeId) {
        if let Ok(index) = self.live_index(node) {
            self.nodes[index].flags &= !CONSUMED;
        }
    }

    pub(super) fn live_index(&self, node: NodeId) -> Result<usize, GraphError> {
        let index = node.index();
        let header = self.nodes.get(index).ok_or(GraphError::DeletedNode)?;
        let is_live = header.flags & LIVE != 0 && header.generation == node.generation();
        if is_live {
            Ok(index)
        } else {
            Err(GraphError::DeletedNode)
        }
    }

    pub(super) fn id(&self, index: usize) -> NodeId {
        NodeId::new(index, self.nodes[index].generation).unwrap_or(self.root)
    }

    /// Place of a field's first word in the word arena.
    pub(super) fn word_place(&self, index: usize, offset: u16) -> u32 {
        self.nodes[index].words + u32::from(offset)
    }

    pub(super) fn field_of(&self, index: usize, field: FieldId) -> &super::Field {
        &self.types[self.nodes[index].type_id].fields[usize::from(field.0)]
    }

    /// Bytes that the graph takes in memory, objects counted without what they point to.
    pub fn memory(&self) -> usize {
        size_of::<Header>() * self.nodes.len()
            + 4 * self.words.len()
            + self.links.memory()
            + 4 * self.extents.n_places()
            + size_of::<O>() * self.objects.n_used()
            + size_of::<((u32, u16), SideValue<O>)>() * self.side.len()
    }
}

/// Nodes are numbered with 31 bits, see [`Links`].
pub(super) const MOST_NODES: usize = (1 << 31) - 2;
/// Words are numbered with 32 bits; a little room is left for the last node.
pub(super) const MOST_WORDS: usize = u32::MAX as usize - (1 << 16);

impl Header {
    pub(super) const VACANT: Self = Self {
        type_id: TypeId(0),
        flags: 0,
        generation: 0,
        words: 0,
        first_out: NIL,
        link: Link::NONE,
        extent_place: 0,
    };
}

#[cfg(test)]
mod tests {
    use super::super::testing::{V, graph, letters, new_node, type_named};
    use super::super::{EdgeBits, Graph, GraphError};

    #[test]
    fn a_new_graph_has_root_and_axiom() {
        let graph: Graph<()> = Graph::new(letters(), 10).expect("small");
        assert_eq!(graph.tree_text(), "RGGRoot\nAxiom\n");
        assert_eq!(graph.n_nodes(), 2);
    }

    #[test]
    fn a_floating_node_is_in_no_extent() {
        let mut graph = graph("S A(1)");
        let node = new_node(&mut graph, "A(2)").expect("room");
        assert_eq!(graph.count(type_named(&graph, "A")), 1);
        graph.insert(node).expect("exists");
        assert_eq!(graph.count(type_named(&graph, "A")), 2);
    }

    #[test]
    fn a_removed_node_is_not_found_again_under_its_old_name() {
        let mut graph = graph("S A(1)");
        let a = graph.extent(type_named(&graph, "A")).next().expect("one");
        graph.remove(a);
        let b = new_node(&mut graph, "B(7)").expect("room");
        assert_eq!(b.index(), a.index());
        assert_eq!(graph.get_i32(a, V), Err(GraphError::DeletedNode));
        assert_eq!(graph.get_i32(b, V), Ok(7));
        assert_eq!(graph.validate(), Ok(()));
    }

    #[test]
    fn the_limit_is_kept() {
        let mut graph: Graph<()> = Graph::new(letters(), 3).expect("small");
        assert!(new_node(&mut graph, "A").is_ok());
        assert_eq!(
            new_node(&mut graph, "A"),
            Err(GraphError::TooManyNodes { limit: 3 })
        );
    }

    #[test]
    fn extents_keep_their_order() {
        let mut graph = graph("S A(1) [B(2) A(3)] A(4) A(5) A(6)");
        let ty = type_named(&graph, "A");
        let values = |g: &Graph<()>| g.extent(ty).map(|n| g.get_i32(n, V)).collect::<Vec<_>>();
        assert_eq!(values(&graph), [Ok(1), Ok(3), Ok(4), Ok(5), Ok(6)]);
        for node in graph.extent(ty).take(3).collect::<Vec<_>>() {
            graph.remove(node);
        }
        assert_eq!(values(&graph), [Ok(5), Ok(6)]);
        assert_eq!(graph.validate(), Ok(()));
        assert_eq!(graph.extent(type_named(&graph, "Node")).count(), 5);
    }

    #[test]
    fn what_hangs_below_a_removed_node_vanishes() {
        let mut graph = graph("S A(1) [B(2) C(3)] A(4)");
        let b = graph.extent(type_named(&graph, "B")).next().expect("one");
        graph.remove(b);
        graph.end_of_step();
        assert_eq!(graph.string_text(), "S A(1)A(4)");
        assert_eq!(graph.n_nodes(), 4);
    }

    #[test]
    fn a_ring_cut_off_from_the_root_vanishes() {
        let mut graph = graph("S A(1) B(2) C(3)");
        let find = |g: &Graph<()>, name| g.extent(type_named(g, name)).next().expect("one");
        let (a, b, c) = (find(&graph, "A"), find(&graph, "B"), find(&graph, "C"));
        graph
            .add_edge(c, b, EdgeBits::SUCCESSOR)
            .expect("two nodes");
        graph.remove_edge(a, b, EdgeBits::ALL);
        graph.end_of_step();
        assert_eq!(graph.string_text(), "S A(1)");
    }

    #[test]
    fn an_edge_has_several_kinds_and_goes_with_the_last() {
        let mut graph = graph("S A(1) B(2)");
        let find = |g: &Graph<()>, name| g.extent(type_named(g, name)).next().expect("one");
        let (a, b) = (find(&graph, "A"), find(&graph, "B"));
        graph.add_edge(a, b, EdgeBits::BRANCH).expect("two nodes");
        assert_eq!(graph.n_edges(), 3);
        graph.remove_edge(a, b, EdgeBits::SUCCESSOR);
        assert_eq!(graph.string_text(), "S A(1)[B(2)]");
        graph.remove_edge(a, b, EdgeBits::BRANCH);
        assert_eq!(graph.n_edges(), 1 + 1);
        assert_eq!(
            graph.add_edge(a, a, EdgeBits::BRANCH),
            Err(GraphError::SelfEdge)
        );
    }

    #[test]
    fn a_node_takes_few_bytes() {
        assert!(size_of::<super::Header>() <= 32);
    }
}
