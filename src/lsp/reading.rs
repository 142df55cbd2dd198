//! Reading a text that is being typed: what cannot be read is blanked out, so that all else keeps its meaning and its place.

use super::place::Lines;
use crate::diag::{Diagnostics, FileId, Severity};
use crate::syntax::{self, ast};

/// How often more is blanked out before the rest is given up.
const MAX_ROUNDS: usize = 8;
/// Longer texts are read as they are.
const MAX_LEN: usize = 1 << 20;

/// A text as it could be read.
#[derive(Clone, Debug)]
pub struct Reading {
    /// The tree, without what could not be read.
    pub ast: ast::File,
    /// What is wrong with the text as it is.
    pub found: Diagnostics,
}

/// Reads a text.
pub fn read(file: FileId, text: &str) -> Reading {
    let (mut ast, found) = syntax::parse(file, text);
    if found.has_errors() && text.len() <= MAX_LEN {
        ast = readable(file, text, &found).unwrap_or(ast);
    }
    Reading { ast, found }
}

/// The tree of a text with its broken lines blanked out; `None` if that does not help.
fn readable(file: FileId, text: &str, found: &Diagnostics) -> Option<ast::File> {
    let lines = Lines::of(text);
    let mut patched = text.as_bytes().to_vec();
    let mut errors = error_bytes(found);
    let mut tried: Vec<usize> = vec![];
    for _ in 0..MAX_ROUNDS {
        let broken = errors
            .iter()
            .map(|byte| lines.line((*byte).min(text.len())));
        // A line that begins a block holds all of it: as long as others are broken too, they come first.
        let (outer, inner): (Vec<_>, Vec<_>) = broken.partition(|line| {
            text[lines.bytes(text, *line)]
                .trim_end()
                .ends_with(['{', '['])
        });
        for line in if inner.is_empty() { outer } else { inner } {
            let n_before = tried.iter().filter(|known| **known == line).count();
            tried.push(line);
            // First the words, then the brackets of rules and indices, then all.
            let first: &[u8] = if holds_blocks(&text[lines.bytes(text, line)]) {
                b"{}[]"
            } else {
                b""
            };
            let kept: &[u8] = [first, b"{}", b""][n_before.min(2)];
            for at in lines.bytes(text, line) {
                if !kept.contains(&patched[at]) && !patched[at].is_ascii_whitespace() {
                    patched[at] = b' ';
                }
            }
        }
        // Whole characters were replaced, byte by byte.
        let next = String::from_utf8_lossy(&patched).into_owned();
        let (ast, found) = syntax::parse(file, &next);
        if !found.has_errors() {
            return Some(ast);
        }
        errors = error_bytes(&found);
    }
    None
}

/// Whether the brackets of a line belong to blocks that other lines need: they are balanced, or stand at its ends.
fn holds_blocks(line: &str) -> bool {
    let line = line.trim();
    let count = |wanted: char| line.matches(wanted).count();
    let is_balanced = count('[') == count(']') && count('{') == count('}');
    is_balanced || line.ends_with(['{', '[']) || line.starts_with(['}', ']'])
}

/// Where the errors are.
fn error_bytes(found: &Diagnostics) -> Vec<usize> {
    let errors = found
        .sorted()
        .into_iter()
        .filter(|d| d.severity == Severity::Error);
    errors
        .filter_map(|d| d.primary.as_ref())
        .map(|label| label.span.start as usize)
        .collect()
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::syntax::ast::Item;

    fn names(text: &str) -> Vec<String> {
        let reading = read(FileId(0), text);
        assert!(reading.found.has_errors(), "{text}");
        let name = |item: &Item| match item {
            Item::Module(module) => module.name.name.clone(),
            Item::Method(method) => {
                let n_stmts = method.body.as_ref().map_or(0, |body| body.stmts.len());
                format!("{}:{n_stmts}", method.name.name)
            }
            _ => "?".into(),
        };
        reading.ast.items.iter().map(name).collect()
    }

    #[test]
    fn what_is_half_typed_does_not_hide_the_rest() {
        assert_eq!(
            names("module A;\nvoid f() {\n int a = 1;\n a.\n}\nmodule B;"),
            ["A", "f:1", "B"]
        );
        assert_eq!(
            names("void f() [\n A ==> F(1) [RU(\n A ==> F;\n]\nmodule B;"),
            ["f:1", "B"]
        );
        assert_eq!(names("module A;\nmodule\nvoid f() { g(); }"), ["A", "f:1"]);
        assert_eq!(
            names("void f() {\n g(\"ä\n h();\n}\nmodule B;"),
            ["f:1", "B"]
        );
    }
}
