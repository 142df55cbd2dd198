//! The growth graph: typed nodes with parameters, directed edges, and extents (all nodes of a type, in order of birth).

pub mod pattern;
mod node_id;
mod types;

pub use node_id::NodeId;
pub use types::{Field, FieldId, FieldKind, NewField, NodeType, Storage, TypeId, TypeTable};
