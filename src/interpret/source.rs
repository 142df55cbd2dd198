//! What the interpreter asks of a grown model.

use super::appearance::Appearance;
use super::failure::Failure;
use crate::diag::Span;
use crate::graph::{Graph, NodeId, TypeId};

/// A grown model: its graph, and what runs the instantiation bodies of its modules.
pub trait Source {
    /// What object fields hold.
    type Object: Appearance;

    /// The graph.
    fn graph(&self) -> &Graph<Self::Object>;

    /// The instantiation body of a type, its own or inherited.
    fn body(&self, ty: TypeId) -> Option<Body>;

    /// Runs the body of a node and appends what it makes. The nodes exist until they are [released](Self::release) but are
    /// in no extent and linked to nothing.
    ///
    /// # Errors
    /// The body failed.
    fn instantiate(&mut self, node: NodeId, events: &mut Vec<BodyEvent>) -> Result<(), Failure>;

    /// Frees the nodes that a body made.
    fn release(&mut self, events: &[BodyEvent]);

    /// Where a module is declared.
    fn declared_at(&self, ty: TypeId) -> Option<Span>;
}

/// What is known of an instantiation body without running it.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Body {
    /// Whether it depends on nothing but the node's own fields, so that equal fields give equal geometry.
    pub is_pure: bool,
}

/// What a body makes, in order.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum BodyEvent {
    /// A node, linked to the one before.
    Node(NodeId),
    /// `[`
    Push,
    /// `]`
    Pop,
    /// `,`: what follows begins where the body began.
    Restart,
}
