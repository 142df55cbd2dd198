//! `lsp`: the language server on standard input and output.

use super::outcome::Exit;
use crate::lsp::server::{Ended, serve};
use crate::pipeline::threads::STACK;
use crate::pipeline::world::Machine;
use std::io::{self, BufReader, ErrorKind};

/// Talks with an editor until it leaves. Nothing else may write to standard output meanwhile.
pub(super) fn talk() -> Exit {
    let work = || {
        let world = Machine::new();
        serve(&world, BufReader::new(io::stdin()), io::stdout().lock())
    };
    // What walks a deeply nested model needs room.
    let ended = std::thread::Builder::new()
        .stack_size(STACK)
        .spawn(work)
        .map(std::thread::JoinHandle::join);
    match ended {
        Ok(Ok(Ok(Ended::Politely | Ended::Silently))) => Exit::Done,
        Ok(Ok(Err(error))) if error.kind() == ErrorKind::BrokenPipe => Exit::Done,
        _ => Exit::World,
    }
}
