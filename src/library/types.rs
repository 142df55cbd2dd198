//! Types of values: what an expression can be ([`Type`]) and what a table row can say ([`ValueType`]).

use super::ClassId;
use crate::graph::TypeId;

/// The static type of an expression.
#[derive(Clone, Debug, PartialEq, Eq, Hash)]
#[allow(missing_docs, reason = "the names are Java's own")]
pub enum Type {
    Void,
    /// The type of `null`.
    Null,
    Boolean,
    Byte,
    Short,
    Char,
    Int,
    Long,
    Float,
    Double,
    String,
    /// A node of this type or of one that extends it.
    Node(TypeId),
    /// An object of this class of the model, or of one that extends it.
    Instance(TypeId),
    /// A library class.
    Class(ClassId),
    Array(Box<Type>),
    /// `Object`: anything, boxed.
    Object,
}

/// A type as the tables of the library write it; [`ValueType::to_type`] makes a [`Type`] of it.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
#[allow(missing_docs, reason = "the names are Java's own")]
pub enum ValueType {
    Void,
    Boolean,
    Char,
    Int,
    Long,
    Float,
    Double,
    String,
    /// Parameters only: a value of any type, converted to its text (as by Java's `"" + x`) before the call.
    Text,
    Object,
    /// A node of any type.
    Node,
    Class(ClassId),
    CharArray,
    FloatArray,
    StringArray,
    FileArray,
}

impl ValueType {
    /// The type of such a value; `node` is the type that all nodes extend.
    pub fn to_type(self, node: TypeId) -> Type {
        let array = |element| Type::Array(Box::new(element));
        match self {
            Self::Void => Type::Void,
            Self::Boolean => Type::Boolean,
            Self::Char => Type::Char,
            Self::Int => Type::Int,
            Self::Long => Type::Long,
            Self::Float => Type::Float,
            Self::Double => Type::Double,
            Self::String | Self::Text => Type::String,
            Self::Object => Type::Object,
            Self::Node => Type::Node(node),
            Self::Class(class) => Type::Class(class),
            Self::CharArray => array(Type::Char),
            Self::FloatArray => array(Type::Float),
            Self::StringArray => array(Type::String),
            Self::FileArray => array(Type::Class(ClassId::File)),
        }
    }
}
