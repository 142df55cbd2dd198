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
    /// A library class with what its type parameters stand for: `HashMap<String, Float>`.
    Generic(ClassId, Box<[Type]>),
    Array(Box<Type>),
    /// `Object`: anything, boxed.
    Object,
}

impl Type {
    /// The library class, if it is one.
    pub fn class(&self) -> Option<ClassId> {
        match self {
            Self::Class(class) | Self::Generic(class, _) => Some(*class),
            _ => None,
        }
    }

    /// What the type parameter with this number stands for, `Object` where nothing was said.
    pub fn argument(&self, index: usize) -> Self {
        match self {
            Self::Generic(_, args) => args.get(index).cloned().unwrap_or(Self::Object),
            _ => Self::Object,
        }
    }

    /// A library class with what its type parameters stand for; plain where they all are `Object`.
    pub fn generic(class: ClassId, args: Vec<Self>) -> Self {
        if args.iter().all(|arg| *arg == Self::Object) {
            Self::Class(class)
        } else {
            Self::Generic(class, args.into())
        }
    }
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
    IntArray,
    StringArray,
    FileArray,
    ObjectArray,
    /// Last parameter only: any number of values, or an array of them.
    Objects,
    /// Results only: the type of the receiver, or of the first argument of a function.
    Same,
    /// What the type parameter with this number of the receiver (or of the first argument) stands for, `Object` if unknown.
    Argument(usize),
    /// Results only: this class with the type parameter of that number of the receiver (or of the first argument).
    Of(ClassId, usize),
    /// Results only: the entries of a map.
    Entries,
}

impl ValueType {
    /// The type of such a value; `node` is the type that all nodes extend, `of` the receiver or first argument.
    pub fn to_type(self, node: TypeId, of: Option<&Type>) -> Type {
        let array = |element| Type::Array(Box::new(element));
        let argument = |index| of.map_or(Type::Object, |of| of.argument(index));
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
            Self::IntArray => array(Type::Int),
            Self::StringArray => array(Type::String),
            Self::FileArray => array(Type::Class(ClassId::File)),
            Self::ObjectArray | Self::Objects => array(Type::Object),
            Self::Same => of.cloned().unwrap_or(Type::Object),
            Self::Argument(index) => argument(index),
            Self::Of(class, index) => Type::generic(class, vec![argument(index)]),
            Self::Entries => {
                let entry = Type::generic(ClassId::Entry, vec![argument(0), argument(1)]);
                Type::generic(ClassId::Set, vec![entry])
            }
        }
    }
}
