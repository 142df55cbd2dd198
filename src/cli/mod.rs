//! The program as people meet it: commands, messages, exit codes.

pub mod args;
mod cluster;
mod commands;
mod extremes;
mod extremes_page;
mod flying;
pub mod outcome;
mod request;
mod shell;
mod talking;
pub mod terminal;
mod trading;
mod validating;
mod watching;

use crate::integrator::CancelToken;
use crate::watch::Event;
use args::Action;
use outcome::Exit;
use request::Request;
use shell::Shell;
use std::ffi::OsString;
use std::process::ExitCode;
use std::sync::atomic::{AtomicBool, Ordering};
use std::sync::mpsc::{Sender, channel};

/// Does what a command line (the program's name first) asks for.
pub fn run(words: impl IntoIterator<Item = OsString>) -> ExitCode {
    let request = match Request::parse(words) {
        Ok(request) => request,
        Err(error) => {
            // With the terminal gone there is nobody left to tell.
            let _ = error.print();
            return if error.use_stderr() {
                Exit::Usage.into()
            } else {
                Exit::Done.into()
            };
        }
    };
    if let Action::Lsp(_) = request.action {
        return talking::talk().into();
    }
    let cancel = CancelToken::default();
    let (sender, events) = channel();
    listen_for_ctrl_c(cancel.clone(), sender.clone());
    let manners = match &request.action {
        Action::Check(_) | Action::Validate(_) | Action::Lsp(_) => None,
        Action::Derive(args) => Some(&args.manners),
        Action::Render(args) => Some(&args.manners),
        Action::Watch(args) => Some(&args.manners),
        Action::Fly(args) => Some(&args.manners),
        Action::Export(args) => Some(&args.manners),
        Action::Trade(args) => Some(&args.manners),
        Action::Light(args) => Some(&args.manners),
    };
    let mut shell = Shell::new(&request, manners, cancel);
    let presets = match &request.action {
        Action::Render(args) => args.presets.as_deref(),
        Action::Fly(args) => args.presets.as_deref(),
        _ => None,
    };
    if let Err(failure) = shell.read_presets(presets) {
        return shell.conclude(Err(failure)).into();
    }
    let result = match &request.action {
        Action::Check(args) => commands::check(&shell, args),
        Action::Derive(args) => commands::derive(&shell, args),
        Action::Render(args) => commands::render(&shell, args),
        Action::Watch(args) => watching::watch(&shell, args, sender, events),
        Action::Fly(args) => flying::fly(&shell, args),
        Action::Export(args) => commands::export(&shell, args),
        Action::Trade(args) => trading::trade(&shell, args),
        Action::Validate(args) => validating::validate(&shell, args),
        Action::Light(args) => commands::light(&shell, args),
        Action::Lsp(_) => Ok(()),
    };
    shell.conclude(result).into()
}

/// The first Ctrl-C asks for a clean stop, a second one ends the program at once.
fn listen_for_ctrl_c(cancel: CancelToken, events: Sender<Event>) {
    let is_second = AtomicBool::new(false);
    let handler = move || {
        if is_second.swap(true, Ordering::Relaxed) {
            std::process::exit(Exit::World as i32);
        }
        cancel.cancel();
        // Only `watch` reads events.
        let _ = events.send(Event::Quit);
    };
    // Without a handler Ctrl-C still ends the program, only less politely.
    let _ = ctrlc::set_handler(handler);
}
