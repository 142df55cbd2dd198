//! The functions, classes and constants of the language, as tables: names, signatures, effects, meaning. No behaviour.
//!
//! Every overload is a variant of an enum ([`FunctionId`], [`ConstructorId`], [`MethodId`]), so that `eval`, which implements
//! them, cannot forget one; `check` finds them by name, and the language reference is generated from the same rows.

mod classes;
mod constants;
mod constructors;
mod fields;
mod functions;
mod methods;
mod signature;
mod types;

pub use classes::ClassId;
pub use constants::{ConstantValue, LibraryConstant, constant, constants};
pub use constructors::{ConstructorId, constructors_of};
pub use fields::{LibraryField, field_named};
pub use functions::{FunctionId, functions_named};
pub use methods::{MethodId, methods_named};
pub use signature::{Effect, Signature};
pub use types::{Type, ValueType};
