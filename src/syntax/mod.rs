//! Text of `.rgg` files → syntax tree.
//!
//! `scan` cuts a text into words and brackets and finds what is wrong with those alone: unclosed strings, comments and
//! brackets, foreign characters, absurd nesting. [`parse()`] then reads the text with the grammar in
//! `grammar/rgg.pest`. Only when that fails does `blame` look closer: it cuts the text into declarations, statements and
//! rules (`cut`), reads each alone, and words one diagnostic for each that is broken (`explain`, `mistakes`), so that one mistake
//! does not hide the next.

pub mod ast;
mod blame;
mod brackets;
mod cut;
mod excerpt;
mod explain;
mod imports;
mod mistakes;
mod parse;
#[cfg(test)]
mod pretty;
mod scan;
#[cfg(test)]
mod tests;

pub use imports::{ImportNames, imports};

use crate::diag::{Diagnostics, FileId};

/// Reads one file. The tree holds the declarations that could be read; it is complete if there is no error.
///
/// Takes time linear in the length of `text` (about 6 MB/s) and never overflows the stack: nesting, operands of one
/// expression and `else` chains are limited, with a diagnostic.
pub fn parse(file: FileId, text: &str) -> (ast::File, Diagnostics) {
    let scan = scan::scan(text);
    if let Some(diagnostics) = blame::unreadable(file, &scan) {
        return (ast::File::default(), diagnostics);
    }
    match parse::Reader::new(file, &scan).file(&scan.plain) {
        Some((tree, mut diagnostics)) => {
            diagnostics.append(blame::empty(file, &tree, text));
            (tree, diagnostics)
        }
        None => blame::blame(file, text, &scan),
    }
}
