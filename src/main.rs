//! The command-line program.

use std::process::ExitCode;

fn main() -> ExitCode {
    understory::cli::run(std::env::args_os())
}
