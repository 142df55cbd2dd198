//! The growth graph: typed nodes with parameters, directed edges, and extents (all nodes of a type, in order of birth).
//!
//! It knows no language: what rules look for is described by [`pattern`], object fields hold whatever implements
//! [`Payload`]. Nodes come into being floating ([`Graph::create`]), become part of the graph ([`Graph::insert`]), and
//! vanish at the end of a step ([`Graph::end_of_step`]) when nothing links them to the root any more.

pub mod pattern;
mod arena;
mod edges;
mod extents;
mod links;
mod fields;
mod node_id;
mod payload;
mod print;
mod replace;
mod store;
mod sweep;
mod template;
mod types;
mod validate;
mod walk;
#[cfg(test)]
pub(crate) mod testing;
#[cfg(test)]
mod tests;

pub use edges::{EdgeBits, InEdges, OutEdges};
pub use node_id::NodeId;
pub use payload::Payload;
pub use store::{Graph, GraphError};
pub use template::{Batch, Template};
pub use types::{Field, FieldId, FieldKind, NewField, NodeType, Storage, TypeId, TypeTable};
pub use walk::Event;
