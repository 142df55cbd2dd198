//! The language at work: a checked model becomes closures over resolved slots ([`Program`]), which a [`Machine`] runs.
//!
//! Nothing is looked up by name, walked as a tree or typed at run time: [`compile`] has done all of it. Numbers travel
//! unboxed, in the types of Java and with Java's results to the last bit; objects are [`Value`]s. What ends an evaluation
//! early, exception or budget, is a [`Trap`].

pub mod access;
pub mod array;
pub mod code;
mod compile;
pub mod decimal;
pub mod files;
pub mod freeform;
pub mod hooks;
pub mod kept;
pub mod library;
pub mod light_model;
pub mod machine;
pub mod map;
pub mod memory;
pub mod object;
pub mod picture;
pub mod program;
pub mod random;
pub mod stack;
pub mod text;
pub mod trace;
pub mod trap;
pub mod value;

pub use kept::Kept;
pub use machine::{Limits, Machine, Output, Setup, StopSign};
pub use program::{Program, Purity};
pub use trace::Trace;
pub use trap::Trap;
pub use value::Value;
