//! How each kind of value is read from and written to fields of nodes and elements of arrays.

use std::sync::PoisonError;
use std::sync::atomic::Ordering::Relaxed;

use glam::{DAffine3, DVec3};

use super::array::{Array, Elements};
use super::code::FromCode;
use super::object::Data;
use super::value::Value;
use crate::graph::{FieldId, Graph, GraphError, NodeId, Payload};

/// Kinds of values that fields and elements hold.
pub trait Access: FromCode {
    /// Reads a field of a node.
    fn field(graph: &Graph<Value>, node: NodeId, field: FieldId) -> Result<Self, GraphError>;
    /// Writes a field of a node.
    fn set_field(
        self,
        graph: &mut Graph<Value>,
        node: NodeId,
        field: FieldId,
    ) -> Result<(), GraphError>;
    /// Reads an element; `None` if the index is out of bounds.
    fn element(array: &Array, index: usize) -> Option<Self>;
    /// Writes an element; `None` if the index is out of bounds.
    fn set_element(self, array: &Array, index: usize) -> Option<()>;
    /// Whether a pattern that asks for `other` is satisfied with this value.
    fn is_equal(&self, other: &Self) -> bool;
}

/// Pastes the field accessors of a kind that the graph knows by name.
macro_rules! field_access {
    ($get:ident, $set:ident) => {
        fn field(graph: &Graph<Value>, node: NodeId, field: FieldId) -> Result<Self, GraphError> {
            graph.$get(node, field)
        }

        fn set_field(
            self,
            graph: &mut Graph<Value>,
            node: NodeId,
            field: FieldId,
        ) -> Result<(), GraphError> {
            graph.$set(node, field, self)
        }
    };
}

impl Access for bool {
    field_access!(get_bool, set_bool);

    fn is_equal(&self, other: &Self) -> bool {
        self == other
    }

    fn element(array: &Array, index: usize) -> Option<Self> {
        match array.elements() {
            Elements::Boolean(e) => Some(e.get(index)?.load(Relaxed) != 0),
            _ => None,
        }
    }

    fn set_element(self, array: &Array, index: usize) -> Option<()> {
        match array.elements() {
            Elements::Boolean(e) => e.get(index)?.store(i8::from(self), Relaxed),
            _ => return None,
        }
        Some(())
    }
}

impl Access for i32 {
    field_access!(get_i32, set_i32);

    fn is_equal(&self, other: &Self) -> bool {
        self == other
    }

    #[inline]
    fn element(array: &Array, index: usize) -> Option<Self> {
        match array.elements() {
            Elements::Int(e) => Some(e.get(index)?.load(Relaxed)),
            Elements::Byte(e) => Some(Self::from(e.get(index)?.load(Relaxed))),
            Elements::Short(e) => Some(Self::from(e.get(index)?.load(Relaxed))),
            Elements::Char(e) => Some(Self::from(e.get(index)?.load(Relaxed))),
            _ => None,
        }
    }

    #[inline]
    fn set_element(self, array: &Array, index: usize) -> Option<()> {
        match array.elements() {
            Elements::Int(e) => e.get(index)?.store(self, Relaxed),
            Elements::Byte(e) => e.get(index)?.store(self as i8, Relaxed),
            Elements::Short(e) => e.get(index)?.store(self as i16, Relaxed),
            Elements::Char(e) => e.get(index)?.store(self as u16, Relaxed),
            _ => return None,
        }
        Some(())
    }
}

impl Access for i64 {
    field_access!(get_i64, set_i64);

    fn is_equal(&self, other: &Self) -> bool {
        self == other
    }

    fn element(array: &Array, index: usize) -> Option<Self> {
        match array.elements() {
            Elements::Long(e) => Some(e.get(index)?.load(Relaxed)),
            _ => None,
        }
    }

    fn set_element(self, array: &Array, index: usize) -> Option<()> {
        match array.elements() {
            Elements::Long(e) => e.get(index)?.store(self, Relaxed),
            _ => return None,
        }
        Some(())
    }
}

impl Access for f32 {
    field_access!(get_f32, set_f32);

    fn is_equal(&self, other: &Self) -> bool {
        self == other
    }

    #[inline]
    fn element(array: &Array, index: usize) -> Option<Self> {
        match array.elements() {
            Elements::Float(e) => Some(Self::from_bits(e.get(index)?.load(Relaxed))),
            _ => None,
        }
    }

    #[inline]
    fn set_element(self, array: &Array, index: usize) -> Option<()> {
        match array.elements() {
            Elements::Float(e) => e.get(index)?.store(self.to_bits(), Relaxed),
            _ => return None,
        }
        Some(())
    }
}

impl Access for f64 {
    field_access!(get_f64, set_f64);

    fn is_equal(&self, other: &Self) -> bool {
        self == other
    }

    #[inline]
    fn element(array: &Array, index: usize) -> Option<Self> {
        match array.elements() {
            Elements::Double(e) => Some(Self::from_bits(e.get(index)?.load(Relaxed))),
            _ => None,
        }
    }

    #[inline]
    fn set_element(self, array: &Array, index: usize) -> Option<()> {
        match array.elements() {
            Elements::Double(e) => e.get(index)?.store(self.to_bits(), Relaxed),
            _ => return None,
        }
        Some(())
    }
}

impl Access for Value {
    field_access!(get_object, set_object);

    fn is_equal(&self, other: &Self) -> bool {
        self.equals(other)
    }

    fn element(array: &Array, index: usize) -> Option<Self> {
        array.get(index)
    }

    fn set_element(self, array: &Array, index: usize) -> Option<()> {
        match array.elements() {
            Elements::Reference(e) => {
                *e.get(index)?.lock().unwrap_or_else(PoisonError::into_inner) = self;
                Some(())
            }
            _ => None,
        }
    }
}

impl Access for Option<NodeId> {
    fn is_equal(&self, other: &Self) -> bool {
        self == other
    }

    fn field(graph: &Graph<Value>, node: NodeId, field: FieldId) -> Result<Self, GraphError> {
        Ok(graph.peek_object(node, field)?.and_then(Value::as_node))
    }

    fn set_field(
        self,
        graph: &mut Graph<Value>,
        node: NodeId,
        field: FieldId,
    ) -> Result<(), GraphError> {
        graph.set_object(node, field, self.map_or(Value::Null, Value::Node))
    }

    fn element(array: &Array, index: usize) -> Option<Self> {
        Some(array.get(index)?.as_node())
    }

    fn set_element(self, array: &Array, index: usize) -> Option<()> {
        self.map_or(Value::Null, Value::Node)
            .set_element(array, index)
    }
}

impl Payload for Value {
    fn is_null(&self) -> bool {
        Self::is_null(self)
    }

    fn as_node(&self) -> Option<NodeId> {
        Self::as_node(self)
    }

    fn as_vector(&self) -> Option<DVec3> {
        self.as_object()?.tuple()
    }

    fn as_transform(&self) -> Option<DAffine3> {
        match &*self.as_object()?.lock() {
            Data::Tuple(v) => Some(DAffine3::from_translation(*v)),
            _ => None,
        }
    }

    fn text(&self) -> String {
        self.to_string()
    }
}
