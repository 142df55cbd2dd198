//! Compiled expressions and statements: closures over resolved slots.
//!
//! Constants and local variables are no closures but variants of [`Source`], so that `x + 1` costs one call, not three.

use super::machine::Machine;
use super::program::Program;
use super::stack::Kind;
use super::trap::Trap;
use super::value::Value;
use crate::graph::NodeId;

/// A computation of a `T`.
pub type Eval<T> = Box<dyn Fn(&Program, &mut Machine) -> Result<T, Trap> + Send + Sync>;

/// A statement.
pub type Exec = Eval<Flow>;

/// Where control goes after a statement.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Flow {
    /// To the next statement.
    Next,
    /// Behind the loop, switch or statement with this label.
    Break(Label),
    /// To the next turn of the loop with this label.
    Continue(Label),
    /// To the caller; the result stands in the stack.
    Return,
}

/// Which enclosing statement a `break` or `continue` means.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Label {
    /// The innermost.
    Innermost,
    /// The one with this number.
    Named(u16),
}

impl Label {
    /// Whether a jump to this label is caught by a loop with label `own`.
    pub fn means(self, own: Option<u16>) -> bool {
        match self {
            Self::Innermost => true,
            Self::Named(label) => own == Some(label),
        }
    }
}

/// Where a `T` comes from.
pub enum Source<T> {
    /// Known when the program is built.
    Constant(T),
    /// A local variable, at this offset of the frame.
    Local(u32),
    /// Computed.
    Code(Eval<T>),
}

impl<T: Kind> Source<T> {
    /// A computed source.
    pub fn code(
        f: impl Fn(&Program, &mut Machine) -> Result<T, Trap> + Send + Sync + 'static,
    ) -> Self {
        Self::Code(Box::new(f))
    }

    /// The value now.
    #[inline]
    pub fn get(&self, program: &Program, machine: &mut Machine) -> Result<T, Trap> {
        match self {
            Self::Constant(value) => Ok(value.clone()),
            Self::Local(offset) => Ok(T::load(&machine.stack, *offset)),
            Self::Code(code) => code(program, machine),
        }
    }

    /// `f` of the value; computed now if the value is constant.
    pub fn map<R: Kind>(self, f: impl Fn(T) -> R + Send + Sync + 'static) -> Source<R> {
        match self {
            Self::Constant(value) => Source::Constant(f(value)),
            source => Source::code(move |p, m| Ok(f(source.get(p, m)?))),
        }
    }

    /// `f` of the value, which may fail.
    pub fn try_map<R: Kind>(
        self,
        f: impl Fn(T) -> Result<R, Trap> + Send + Sync + 'static,
    ) -> Source<R> {
        Source::code(move |p, m| f(self.get(p, m)?))
    }

    /// `f` of both values, left first; computed now if both are constant.
    pub fn zip<U: Kind, R: Kind>(
        self,
        other: Source<U>,
        f: impl Fn(T, U) -> R + Send + Sync + 'static,
    ) -> Source<R> {
        match (self, other) {
            (Self::Constant(a), Source::Constant(b)) => Source::Constant(f(a, b)),
            (a, b) => Source::code(move |p, m| {
                let left = a.get(p, m)?;
                let right = b.get(p, m)?;
                Ok(f(left, right))
            }),
        }
    }

    /// `f` of both values, left first, which may fail.
    pub fn try_zip<U: Kind, R: Kind>(
        self,
        other: Source<U>,
        f: impl Fn(T, U) -> Result<R, Trap> + Send + Sync + 'static,
    ) -> Source<R> {
        Source::code(move |p, m| {
            let left = self.get(p, m)?;
            let right = other.get(p, m)?;
            f(left, right)
        })
    }
}

/// A compiled expression of any type.
#[allow(missing_docs, reason = "the names are those of the kinds of values")]
pub enum Code {
    Void(Eval<()>),
    Boolean(Source<bool>),
    /// Also byte, short and char.
    Int(Source<i32>),
    Long(Source<i64>),
    Float(Source<f32>),
    Double(Source<f64>),
    /// A node or null.
    Node(Source<Option<NodeId>>),
    /// Texts, arrays, objects, boxed values.
    Value(Source<Value>),
}

impl Code {
    /// A computation for its effects only.
    pub fn void(
        f: impl Fn(&Program, &mut Machine) -> Result<(), Trap> + Send + Sync + 'static,
    ) -> Self {
        Self::Void(Box::new(f))
    }

    /// The same computation, its value dropped.
    pub fn into_void(self) -> Eval<()> {
        self.followed_by(())
    }

    /// The same computation as a statement.
    pub fn into_exec(self) -> Exec {
        self.followed_by(Flow::Next)
    }

    fn followed_by<R: Copy + Send + Sync + 'static>(self, result: R) -> Eval<R> {
        fn followed<T: Kind, R: Copy + Send + Sync + 'static>(
            source: Source<T>,
            result: R,
        ) -> Eval<R> {
            match source {
                Source::Constant(_) | Source::Local(_) => Box::new(move |_, _| Ok(result)),
                Source::Code(code) => Box::new(move |p, m| code(p, m).map(|_| result)),
            }
        }
        match self {
            Self::Void(code) => Box::new(move |p, m| code(p, m).map(|()| result)),
            Self::Boolean(s) => followed(s, result),
            Self::Int(s) => followed(s, result),
            Self::Long(s) => followed(s, result),
            Self::Float(s) => followed(s, result),
            Self::Double(s) => followed(s, result),
            Self::Node(s) => followed(s, result),
            Self::Value(s) => followed(s, result),
        }
    }
}

/// Kinds of values that code can be asked for.
///
/// The checker has put explicit conversions wherever the language converts; what remains here is null to a node, a node to
/// a reference, and a void to nothing.
pub trait FromCode: Kind {
    /// The source of a value of this kind.
    fn from_code(code: Code) -> Source<Self>;
    /// The same as an expression of any type.
    fn into_code(source: Source<Self>) -> Code;
    /// Takes it out of its box; zero or null if something else is in there.
    fn unboxed(value: &Value) -> Self;
    /// Puts it into its box.
    fn boxed(self) -> Value;
}

macro_rules! from_code {
    ($($ty:ty, $variant:ident, $from_value:ident;)*) => {$(
        impl FromCode for $ty {
            fn from_code(code: Code) -> Source<Self> {
                match code {
                    Code::$variant(source) => source,
                    other => Value::from_code(other).map(|v| Self::unboxed(&v)),
                }
            }

            fn into_code(source: Source<Self>) -> Code {
                Code::$variant(source)
            }

            fn unboxed(value: &Value) -> Self {
                value.$from_value().unwrap_or_default()
            }

            fn boxed(self) -> Value {
                Value::$variant(self)
            }
        }
    )*};
}

from_code! {
    bool, Boolean, as_boolean;
    i32, Int, as_int;
    i64, Long, as_long;
    f32, Float, as_float;
    f64, Double, as_double;
}

impl FromCode for Option<NodeId> {
    fn from_code(code: Code) -> Source<Self> {
        match code {
            Code::Node(source) => source,
            other => Value::from_code(other).map(|v| v.as_node()),
        }
    }

    fn into_code(source: Source<Self>) -> Code {
        Code::Node(source)
    }

    fn unboxed(value: &Value) -> Self {
        value.as_node()
    }

    fn boxed(self) -> Value {
        self.map_or(Value::Null, Value::Node)
    }
}

impl FromCode for Value {
    fn from_code(code: Code) -> Source<Self> {
        match code {
            Code::Value(source) => source,
            Code::Node(source) => source.map(|n| n.map_or(Self::Null, Self::Node)),
            Code::Boolean(source) => source.map(Self::Boolean),
            Code::Int(source) => source.map(Self::Int),
            Code::Long(source) => source.map(Self::Long),
            Code::Float(source) => source.map(Self::Float),
            Code::Double(source) => source.map(Self::Double),
            Code::Void(code) => Source::code(move |p, m| code(p, m).map(|()| Self::Null)),
        }
    }

    fn into_code(source: Source<Self>) -> Code {
        Code::Value(source)
    }

    fn unboxed(value: &Value) -> Self {
        value.clone()
    }

    fn boxed(self) -> Value {
        self
    }
}
