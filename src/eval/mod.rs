//! Compiles a checked model into closures and runs them.

pub mod decimal;
pub mod random;
