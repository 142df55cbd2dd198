//! Boxed values: what variables of type `Object`, strings, arrays, library objects and fields of nodes hold.
//!
//! Numbers in typed variables never take this form; they live as raw words in the frames of the machine.

use std::sync::Arc;

use super::array::Array;
use super::decimal::{java_double_to_string, java_float_to_string};
use super::memory::Charge;
use super::object::Object;
use super::text::{Text, char_of};
use crate::graph::{Graph, NodeId, TypeId};
use crate::library::ClassId;

/// Longest text, in bytes.
pub const MAX_TEXT: usize = 1 << 26;
/// Collections in collections that are printed and compared.
pub(super) const MAX_NESTING: usize = 40;

/// Any value of the language. Texts, arrays and objects are shared, as Java's references are.
#[derive(Clone, Debug, Default)]
#[allow(missing_docs, reason = "the names are Java's own")]
pub enum Value {
    #[default]
    Null,
    Boolean(bool),
    Byte(i8),
    Short(i16),
    Char(u16),
    Int(i32),
    Long(i64),
    Float(f32),
    Double(f64),
    Text(Arc<Text>),
    Node(NodeId),
    Array(Arc<Array>),
    Object(Arc<Object>),
}

impl Value {
    /// A text that is part of the program (no share of the memory budget).
    pub fn text(text: impl Into<Box<str>>) -> Self {
        Self::Text(Arc::new(Text::new(text, Charge::none())))
    }

    /// The text, if it is one.
    pub fn as_text(&self) -> Option<&Text> {
        match self {
            Self::Text(text) => Some(text),
            _ => None,
        }
    }

    /// The module or class of the model that a node or an object is of.
    pub fn type_in(&self, graph: &Graph<Value>) -> Option<TypeId> {
        match self {
            Self::Node(node) => graph.type_of(*node).ok(),
            Self::Object(object) => object.instance_type(),
            _ => None,
        }
    }

    /// The library object, if it is one.
    pub fn as_object(&self) -> Option<&Arc<Object>> {
        match self {
            Self::Object(object) => Some(object),
            _ => None,
        }
    }

    /// The array, if it is one.
    pub fn as_array(&self) -> Option<&Arc<Array>> {
        match self {
            Self::Array(array) => Some(array),
            _ => None,
        }
    }

    /// Whether it is `null`.
    pub fn is_null(&self) -> bool {
        matches!(self, Self::Null)
    }

    /// The node, if it is one.
    pub fn as_node(&self) -> Option<NodeId> {
        match self {
            Self::Node(node) => Some(*node),
            _ => None,
        }
    }

    /// The truth value, if it is one.
    pub fn as_boolean(&self) -> Option<bool> {
        match self {
            Self::Boolean(b) => Some(*b),
            _ => None,
        }
    }

    /// The number as Java's `intValue()` of a boxed number, if it is one (or a character).
    pub fn as_int(&self) -> Option<i32> {
        Some(match self {
            Self::Byte(x) => i32::from(*x),
            Self::Short(x) => i32::from(*x),
            Self::Char(x) => i32::from(*x),
            Self::Int(x) => *x,
            Self::Long(x) => *x as i32,
            Self::Float(x) => *x as i32,
            Self::Double(x) => *x as i32,
            _ => return None,
        })
    }

    /// The number as Java's `longValue()`.
    pub fn as_long(&self) -> Option<i64> {
        Some(match self {
            Self::Long(x) => *x,
            Self::Float(x) => *x as i64,
            Self::Double(x) => *x as i64,
            _ => i64::from(self.as_int()?),
        })
    }

    /// The number as Java's `floatValue()`.
    pub fn as_float(&self) -> Option<f32> {
        Some(match self {
            Self::Long(x) => *x as f32,
            Self::Float(x) => *x,
            Self::Double(x) => *x as f32,
            _ => self.as_int()? as f32,
        })
    }

    /// The number as Java's `doubleValue()`.
    pub fn as_double(&self) -> Option<f64> {
        Some(match self {
            Self::Long(x) => *x as f64,
            Self::Float(x) => f64::from(*x),
            Self::Double(x) => *x,
            _ => f64::from(self.as_int()?),
        })
    }

    /// The class of a boxed number, boolean or character, or of a library object.
    pub fn class(&self) -> Option<ClassId> {
        Some(match self {
            Self::Boolean(_) => ClassId::Boolean,
            Self::Byte(_) => ClassId::Byte,
            Self::Short(_) => ClassId::Short,
            Self::Char(_) => ClassId::Character,
            Self::Int(_) => ClassId::Integer,
            Self::Long(_) => ClassId::Long,
            Self::Float(_) => ClassId::Float,
            Self::Double(_) => ClassId::Double,
            Self::Object(object) => object.class,
            Self::Null | Self::Text(_) | Self::Node(_) | Self::Array(_) => return None,
        })
    }

    /// `==` of references: texts by content (the language interns what a model can compare), numbers by value, the rest by
    /// identity.
    pub fn is_same(&self, other: &Self) -> bool {
        match (self, other) {
            (Self::Null, Self::Null) => true,
            (Self::Text(a), Self::Text(b)) => a.as_str() == b.as_str(),
            (Self::Node(a), Self::Node(b)) => a == b,
            (Self::Array(a), Self::Array(b)) => Arc::ptr_eq(a, b),
            (Self::Object(a), Self::Object(b)) => Arc::ptr_eq(a, b),
            _ => self.class() == other.class() && self.equals(other),
        }
    }

    /// `a.equals(b)`: boxed numbers by type and value, tuples and lists by content.
    pub fn equals(&self, other: &Self) -> bool {
        self.equals_nested(other, 0)
    }

    /// Whether values that stand in so many collections are equal.
    pub(super) fn equals_nested(&self, other: &Self, depth: usize) -> bool {
        match (self, other) {
            (Self::Boolean(a), Self::Boolean(b)) => a == b,
            (Self::Byte(a), Self::Byte(b)) => a == b,
            (Self::Short(a), Self::Short(b)) => a == b,
            (Self::Char(a), Self::Char(b)) => a == b,
            (Self::Int(a), Self::Int(b)) => a == b,
            (Self::Long(a), Self::Long(b)) => a == b,
            (Self::Float(a), Self::Float(b)) => {
                a.to_bits() == b.to_bits() || a.is_nan() && b.is_nan()
            }
            (Self::Double(a), Self::Double(b)) => {
                a.to_bits() == b.to_bits() || a.is_nan() && b.is_nan()
            }
            (Self::Object(a), Self::Object(b)) => {
                Arc::ptr_eq(a, b) || depth < MAX_NESTING && Object::equals(a, b, depth + 1)
            }
            (Self::Null, Self::Null) => true,
            (Self::Text(a), Self::Text(b)) => a.as_str() == b.as_str(),
            (Self::Node(a), Self::Node(b)) => a == b,
            (Self::Array(a), Self::Array(b)) => Arc::ptr_eq(a, b),
            _ => false,
        }
    }

    /// A number that equal values share, of Java's own for numbers and texts.
    pub fn hash_code(&self) -> i32 {
        let fold = |bits: u64| (bits ^ (bits >> 32)) as i32;
        match self {
            Self::Null => 0,
            Self::Boolean(b) => {
                if *b {
                    1231
                } else {
                    1237
                }
            }
            Self::Long(x) => fold(*x as u64),
            Self::Float(x) => x.to_bits() as i32,
            Self::Double(x) => fold(x.to_bits()),
            Self::Text(text) => {
                let units = text.as_str().encode_utf16();
                units.fold(0_i32, |hash, unit| {
                    hash.wrapping_mul(31).wrapping_add(i32::from(unit))
                })
            }
            Self::Object(object) => object.hash_code(),
            Self::Node(node) => node.index() as i32,
            // Identity has no number that is the same on every run; one bucket for all is right, if slow.
            Self::Array(_) => 1,
            Self::Byte(_) | Self::Short(_) | Self::Char(_) | Self::Int(_) => {
                self.as_int().unwrap_or(0)
            }
        }
    }

    /// Appends the text of anything but a node, as Java's `"" + x` does; nodes are named by the machine.
    ///
    /// Collections that contain themselves end in `…`, and nothing is appended to a text that is too long already.
    pub fn append_to(&self, out: &mut String) {
        self.append_nested(out, 0);
    }

    /// Appends the text of a value that stands in so many collections.
    pub(super) fn append_nested(&self, out: &mut String, depth: usize) {
        match self {
            _ if out.len() > MAX_TEXT => {}
            Self::Null => out.push_str("null"),
            Self::Boolean(b) => out.push_str(if *b { "true" } else { "false" }),
            Self::Char(unit) => out.push(char_of(*unit)),
            Self::Long(x) => out.push_str(&x.to_string()),
            Self::Float(x) => out.push_str(&java_float_to_string(*x)),
            Self::Double(x) => out.push_str(&java_double_to_string(*x)),
            Self::Text(text) => out.push_str(text.as_str()),
            Self::Node(_) => out.push_str("Node"),
            Self::Array(array) => out.push_str(array.type_name()),
            Self::Object(_) if depth > MAX_NESTING => out.push('…'),
            Self::Object(object) => object.append_nested(out, depth + 1),
            Self::Byte(_) | Self::Short(_) | Self::Int(_) => {
                out.push_str(&self.as_int().unwrap_or(0).to_string());
            }
        }
    }
}

/// Frees values without recursion, so that lists in lists in lists do not overflow the stack.
pub(super) fn free(mut open: Vec<Value>) {
    while let Some(value) = open.pop() {
        match value {
            Value::Object(shared) => {
                if let Some(mut object) = Arc::into_inner(shared) {
                    object.take_parts(&mut open);
                }
            }
            Value::Array(shared) => {
                if let Some(mut array) = Arc::into_inner(shared) {
                    array.take_parts(&mut open);
                }
            }
            _ => {}
        }
    }
}

impl std::fmt::Display for Value {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        let mut text = String::new();
        self.append_to(&mut text);
        f.write_str(&text)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn values_are_two_words() {
        assert_eq!(size_of::<Value>(), 16);
    }

    #[test]
    fn boxed_numbers_of_different_types_differ() {
        assert!(!Value::Int(3).equals(&Value::Long(3)));
        assert!(Value::Int(3).is_same(&Value::Int(3)));
        assert!(Value::Double(f64::NAN).equals(&Value::Double(f64::NAN)));
        assert!(!Value::Double(0.0).equals(&Value::Double(-0.0)));
    }

    #[test]
    fn hash_codes_are_javas() {
        assert_eq!(Value::text("abc").hash_code(), 96354);
        assert_eq!(Value::Int(-7).hash_code(), -7);
        assert_eq!(Value::Double(1.0).hash_code(), 1_072_693_248);
        assert_eq!(Value::Long(-1).hash_code(), 0);
    }

    #[test]
    fn values_print_as_in_java() {
        let printed = |v: Value| v.to_string();
        assert_eq!(printed(Value::Char(0x41)), "A");
        assert_eq!(printed(Value::Float(1.0)), "1.0");
        assert_eq!(printed(Value::Null), "null");
        assert_eq!(printed(Value::Byte(-56)), "-56");
    }
}
