//! What the graph and the turtle need to know of the objects that fields hold.

use super::NodeId;
use glam::{DAffine3, DVec3};

/// The value of an object field. The graph stores and copies it; only `eval` knows all it can be.
pub trait Payload: Clone + Default {
    /// Whether it is `null`, which is also what `default()` gives.
    fn is_null(&self) -> bool;

    /// The node it names, if it names one.
    fn as_node(&self) -> Option<NodeId>;

    /// The vector or point it is, if it is one.
    fn as_vector(&self) -> Option<DVec3>;

    /// The transformation it is, if it is one (a vector is a translation).
    fn as_transform(&self) -> Option<DAffine3>;

    /// How `derive` prints it; equal values have equal texts. Nodes are printed by the graph, not by this.
    fn text(&self) -> String;
}

/// No objects at all, for graphs without a language.
impl Payload for () {
    fn is_null(&self) -> bool {
        true
    }

    fn as_node(&self) -> Option<NodeId> {
        None
    }

    fn as_vector(&self) -> Option<DVec3> {
        None
    }

    fn as_transform(&self) -> Option<DAffine3> {
        None
    }

    fn text(&self) -> String {
        "null".to_owned()
    }
}
