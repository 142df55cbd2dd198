//! What the functions, methods and constructors of the library do.
//!
//! [`functions`], [`methods`] and [`constructors`] map every number of the library's tables to a [`Behaviour`], by an
//! exhaustive `match`: an entry of the table without behaviour does not compile. Arithmetic stays unboxed; the rest takes
//! and gives boxed values, receiver first.

mod collections;
mod values;
mod ordering;
mod keyed;
mod exact;
mod deques;
mod buffers;
mod arrays;
mod constructors;
pub mod data;
pub mod files;
mod format;
mod freeform;
mod functions;
mod light;
mod light_models;
pub mod moments;
pub mod matrices;
mod lists;
mod methods;
pub mod more;
mod numbers;
mod pictures;
mod places;
mod precise;
mod random;
mod shaders;
mod strings;
mod surfaces;
mod system;
mod vectors;

use std::sync::Arc;

use super::machine::Machine;
use super::object::{Data, Object};
use super::program::Program;
use super::trap::Trap;
use super::value::Value;
use crate::diag::Span;
use crate::graph::NodeId;
use crate::library::{ClassId, MethodId};

pub use constructors::constructor;
pub use functions::function;
pub use methods::method;
pub(super) use precise::pow;

/// Where a library function runs.
pub struct Context<'a> {
    /// The program that calls it.
    pub program: &'a Program,
    /// The machine it runs on.
    pub machine: &'a mut Machine,
    /// The call.
    pub span: Span,
}

/// A library function on boxed values; a method finds its receiver first.
pub type Native = fn(&mut Context<'_>, &[Value]) -> Result<Value, Trap>;
/// The constructor of a class.
pub type Maker = fn(&mut Context<'_>, ClassId, &[Value]) -> Result<Value, Trap>;
/// Reads a public field of a library object.
pub type Getter = fn(&Data) -> Value;
/// Writes a public field of a library object.
pub type Setter = fn(&mut Data, &Value);

/// What a function or method does.
#[derive(Clone, Copy)]
#[allow(
    missing_docs,
    reason = "the names are those of the types of arguments and result"
)]
pub enum Behaviour {
    Int1(fn(i32) -> i32),
    Int2(fn(i32, i32) -> i32),
    Long1(fn(i64) -> i64),
    Long2(fn(i64, i64) -> i64),
    Float1(fn(f32) -> f32),
    Float2(fn(f32, f32) -> f32),
    Double1(fn(f64) -> f64),
    Double2(fn(f64, f64) -> f64),
    FloatToInt(fn(f32) -> i32),
    DoubleToLong(fn(f64) -> i64),
    Native(Native),
}

/// The getter behind a method of a public field.
pub fn getter(id: MethodId) -> Getter {
    match id {
        MethodId::TupleX => vectors::x,
        MethodId::TupleY => vectors::y,
        MethodId::TupleZ => vectors::z,
        MethodId::Matrix00 => matrices::element::<0, 0>,
        MethodId::Matrix01 => matrices::element::<0, 1>,
        MethodId::Matrix02 => matrices::element::<0, 2>,
        MethodId::Matrix03 => matrices::element::<0, 3>,
        MethodId::Matrix10 => matrices::element::<1, 0>,
        MethodId::Matrix11 => matrices::element::<1, 1>,
        MethodId::Matrix12 => matrices::element::<1, 2>,
        MethodId::Matrix13 => matrices::element::<1, 3>,
        MethodId::Matrix20 => matrices::element::<2, 0>,
        MethodId::Matrix21 => matrices::element::<2, 1>,
        MethodId::Matrix22 => matrices::element::<2, 2>,
        MethodId::Matrix23 => matrices::element::<2, 3>,
        MethodId::Matrix30 => matrices::element::<3, 0>,
        MethodId::Matrix31 => matrices::element::<3, 1>,
        MethodId::Matrix32 => matrices::element::<3, 2>,
        MethodId::Matrix33 => matrices::element::<3, 3>,
        MethodId::ShaderRed => shaders::red,
        MethodId::ShaderGreen => shaders::green,
        MethodId::ShaderBlue => shaders::blue,
        MethodId::ShaderAlpha => shaders::alpha,
        _ => |_| Value::Null,
    }
}

/// The setter behind a method of a public field.
pub fn setter(id: MethodId) -> Setter {
    match id {
        MethodId::TupleSetX => vectors::set_x,
        MethodId::TupleSetY => vectors::set_y,
        MethodId::TupleSetZ => vectors::set_z,
        MethodId::MatrixSet00 => matrices::set_element::<0, 0>,
        MethodId::MatrixSet01 => matrices::set_element::<0, 1>,
        MethodId::MatrixSet02 => matrices::set_element::<0, 2>,
        MethodId::MatrixSet03 => matrices::set_element::<0, 3>,
        MethodId::MatrixSet10 => matrices::set_element::<1, 0>,
        MethodId::MatrixSet11 => matrices::set_element::<1, 1>,
        MethodId::MatrixSet12 => matrices::set_element::<1, 2>,
        MethodId::MatrixSet13 => matrices::set_element::<1, 3>,
        MethodId::MatrixSet20 => matrices::set_element::<2, 0>,
        MethodId::MatrixSet21 => matrices::set_element::<2, 1>,
        MethodId::MatrixSet22 => matrices::set_element::<2, 2>,
        MethodId::MatrixSet23 => matrices::set_element::<2, 3>,
        MethodId::MatrixSet30 => matrices::set_element::<3, 0>,
        MethodId::MatrixSet31 => matrices::set_element::<3, 1>,
        MethodId::MatrixSet32 => matrices::set_element::<3, 2>,
        MethodId::MatrixSet33 => matrices::set_element::<3, 3>,
        MethodId::ShaderSetRed => shaders::set_red,
        MethodId::ShaderSetGreen => shaders::set_green,
        MethodId::ShaderSetBlue => shaders::set_blue,
        MethodId::ShaderSetAlpha => shaders::set_alpha,
        _ => |_, _| {},
    }
}

/// Arguments by place and type. The checker has converted them, so a missing or foreign one reads as zero or null.
trait Arguments {
    fn at(&self, index: usize) -> &Value;

    fn int(&self, index: usize) -> i32 {
        self.at(index).as_int().unwrap_or_default()
    }

    fn long(&self, index: usize) -> i64 {
        self.at(index).as_long().unwrap_or_default()
    }

    fn float(&self, index: usize) -> f32 {
        self.at(index).as_float().unwrap_or_default()
    }

    fn double(&self, index: usize) -> f64 {
        self.at(index).as_double().unwrap_or_default()
    }

    /// The text of an argument of type `String`, `null` for null.
    fn text(&self, index: usize) -> &str {
        self.at(index).as_text().map_or("null", |t| t.as_str())
    }
}

impl Arguments for [Value] {
    fn at(&self, index: usize) -> &Value {
        self.get(index).unwrap_or(&Value::Null)
    }
}

impl Context<'_> {
    /// The library object at `index`.
    fn object<'v>(&self, args: &'v [Value], index: usize) -> Result<&'v Arc<Object>, Trap> {
        args.at(index)
            .as_object()
            .ok_or_else(|| Trap::null("use an object", self.span))
    }

    /// The node at `index`.
    fn node(&self, args: &[Value], index: usize) -> Result<NodeId, Trap> {
        match args.at(index) {
            Value::Node(node) => Ok(*node),
            _ => Err(Trap::null("use a node", self.span)),
        }
    }

    /// Appends the text of any value.
    fn tell(&mut self, value: &Value, out: &mut String) -> Result<(), Trap> {
        self.program.tell(self.machine, value, out, self.span)?;
        self.machine
            .check_text(out.len())
            .map_err(|trap| trap.at(self.span))
    }

    /// `a.equals(b)`
    fn equal(&mut self, a: &Value, b: &Value) -> Result<bool, Trap> {
        self.program.equal(self.machine, a, b, self.span)
    }

    /// A new text.
    fn new_text(&self, text: impl Into<String>) -> Result<Value, Trap> {
        self.machine
            .new_text(text.into())
            .map_err(|trap| trap.at(self.span))
    }

    fn exception(&self, class: ClassId, message: impl Into<Box<str>>) -> Trap {
        Trap::exception(class, message, self.span)
    }
}

/// A new object of a library class.
fn new_object(class: ClassId, data: Data) -> Value {
    Value::Object(Arc::new(Object::new(class, data)))
}
