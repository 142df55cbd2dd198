//! Why a run did not reach its end.

use crate::diag::{Diagnostic, Diagnostics, SourceMap};
use std::io;
use std::path::Path;

/// Why a run did not reach its end.
#[derive(Debug)]
pub enum Failure {
    /// The model is wrong, or what stands beside it.
    Model {
        /// The texts that the diagnostics point into.
        sources: SourceMap,
        /// What is wrong.
        found: Diagnostics,
    },
    /// What was asked for makes no sense.
    Usage(String),
    /// A file, memory, the machine.
    World(String),
    /// The program itself is wrong: numbers known on paper came out otherwise.
    Invalid {
        /// How many.
        failed: usize,
        /// Of how many.
        checks: usize,
    },
    /// It was told to stop; what was finished is kept.
    Stopped,
}

impl Failure {
    /// A failed operation on a file: `cannot VERB 'PATH': why`.
    pub fn file(verb: &str, path: &Path, error: &io::Error) -> Self {
        Self::World(format!(
            "cannot {verb} `{}`: {}",
            path.display(),
            reason(error)
        ))
    }

    /// One thing wrong with the model.
    pub fn model(sources: &SourceMap, diagnostic: Diagnostic) -> Self {
        Self::Model {
            sources: sources.clone(),
            found: diagnostic.into(),
        }
    }
}

/// An error of the system in its own words, without the number.
fn reason(error: &io::Error) -> String {
    match error.kind() {
        io::ErrorKind::NotFound => "there is no such file or folder".into(),
        io::ErrorKind::PermissionDenied => "permission denied".into(),
        io::ErrorKind::IsADirectory => "it is a folder".into(),
        io::ErrorKind::NotADirectory => "a part of the path is a file, not a folder".into(),
        io::ErrorKind::StorageFull => "no space left".into(),
        io::ErrorKind::ReadOnlyFilesystem => "the file system cannot be written to".into(),
        _ => {
            let text = error.to_string();
            match text.find(" (os error") {
                Some(at) => text[..at].to_owned(),
                None => text,
            }
        }
    }
}
