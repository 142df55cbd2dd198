//! What the interpreter asks of a grown model.

use super::appearance::Appearance;
use super::failure::Failure;
use crate::diag::Span;
use crate::eval::files::ModelFiles;
use crate::graph::{Graph, NodeId, TypeId};
use crate::rewrite::Instantiated;

/// A grown model: its graph, and what runs the instantiation bodies of its modules.
pub trait Source {
    /// What object fields hold.
    type Object: Appearance;

    /// The graph.
    fn graph(&self) -> &Graph<Self::Object>;

    /// The instantiation body of a type, its own or inherited.
    fn body(&self, ty: TypeId) -> Option<Body>;

    /// Runs the body of a node. What it makes floats: in no extent, linked to nothing but itself, and there until it is
    /// [released](Self::release).
    ///
    /// # Errors
    /// The body failed.
    fn instantiate(&mut self, node: NodeId) -> Result<Instantiated, Failure>;

    /// Frees what a body made.
    fn release(&mut self, made: Instantiated);

    /// The files that the model may use.
    fn files(&self) -> &dyn ModelFiles;

    /// Whether the user wants the drawing to stop.
    fn is_stopped(&self) -> bool;

    /// Where a module is declared.
    fn declared_at(&self, ty: TypeId) -> Option<Span>;

    /// Where in the text nodes of a type are made.
    fn made_at(&self, ty: TypeId) -> &[Span];
}

/// What is known of an instantiation body without running it.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Body {
    /// Whether it depends on nothing but the node's own fields, so that equal fields give equal geometry.
    pub is_pure: bool,
}
