//! The program as people meet it: commands, messages, exit codes.

pub mod args;
pub mod terminal;
