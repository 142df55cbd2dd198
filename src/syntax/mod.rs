//! Text of `.rgg` files → syntax tree.
//!
//! [`scan`] cuts a text into words and brackets and finds what is wrong with those alone: unclosed strings, comments and
//! brackets, foreign characters, absurd nesting. [`parse`](self::parse()) then reads the text with the grammar in
//! `grammar/rgg.pest`. Only when that fails does [`blame`] look closer: it cuts the text into declarations, statements and
//! rules, reads each alone, and words one diagnostic for each that is broken, so that one mistake does not hide the next.

pub mod ast;
mod blame;
mod parse;
mod scan;

use crate::diag::{Diagnostics, FileId};

/// Reads one file. The tree holds the declarations that could be read; it is complete if there is no error.
///
/// Takes time linear in the length of `text` (about 3 MB/s) and never overflows the stack: nesting, operands of one
/// expression and `else` chains are limited, with a diagnostic.
pub fn parse(file: FileId, text: &str) -> (ast::File, Diagnostics) {
    let scan = scan::scan(text);
    if let Some(diagnostics) = blame::unreadable(file, &scan) {
        return (ast::File::default(), diagnostics);
    }
    if scan.problems.is_empty()
        && let Some(read) = parse::Reader::new(file, &scan).file(text)
    {
        return read;
    }
    blame::blame(file, text, &scan)
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::path::Path;

    /// The models of `tests/golden`, by name.
    fn golden_models() -> Vec<(String, String)> {
        let folder = Path::new(env!("CARGO_MANIFEST_DIR")).join("tests/golden");
        let mut models: Vec<(String, String)> = std::fs::read_dir(folder)
            .unwrap()
            .filter_map(|entry| {
                let path = entry.unwrap().path();
                let text = std::fs::read_to_string(path.join("model.rgg")).ok()?;
                Some((
                    path.file_name().unwrap().to_string_lossy().into_owned(),
                    text,
                ))
            })
            .collect();
        models.sort();
        models
    }

    #[test]
    fn all_golden_models_are_read() {
        let models = golden_models();
        assert!(models.len() >= 62, "{}", models.len());
        for (name, text) in models {
            let (file, diagnostics) = parse(FileId(0), &text);
            assert!(diagnostics.is_empty(), "{name}: {diagnostics:#?}");
            assert!(!file.items.is_empty(), "{name}");
        }
    }
}
