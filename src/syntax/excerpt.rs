//! A part of a file without what its brackets hold, to judge the part alone.

use super::cut::{Body, Cutter, Tokens};
use std::ops::Range;

/// The text of a unit with its bodies left out.
pub(super) struct Excerpt {
    pub(super) text: String,
    /// Where each piece begins in `text`, and its bytes in the file.
    pieces: Vec<(usize, Range<usize>)>,
}

impl Excerpt {
    /// The text of `tokens` without what is inside `bodies`.
    pub(super) fn new(cutter: &Cutter<'_>, tokens: &Tokens, bodies: &[Body]) -> Self {
        let mut excerpt = Self {
            text: String::new(),
            pieces: vec![],
        };
        let mut start = tokens.start;
        for body in bodies {
            excerpt.add(cutter, &(start..body.open + 1));
            start = (body.behind - 1).max(body.open + 1);
        }
        excerpt.add(cutter, &(start..tokens.end));
        excerpt
    }

    fn add(&mut self, cutter: &Cutter<'_>, tokens: &Tokens) {
        if tokens.is_empty() {
            return;
        }
        let bytes = cutter.bytes(tokens);
        self.pieces.push((self.text.len(), bytes.clone()));
        self.text.push_str(&cutter.scan.plain[bytes]);
        self.text.push(' ');
    }

    /// The bytes of the file that the text is made of.
    pub(super) fn pieces(&self) -> impl Iterator<Item = &Range<usize>> {
        self.pieces.iter().map(|(_, bytes)| bytes)
    }

    /// The byte of the file for a byte of the text.
    pub(super) fn to_file(&self, byte: usize) -> usize {
        let piece = self.pieces.iter().rev().find(|(start, _)| *start <= byte);
        piece.map_or(0, |(start, bytes)| {
            (bytes.start + byte - start).min(bytes.end)
        })
    }

    /// The byte of the text for a byte of the file.
    pub(super) fn of_file(&self, byte: usize) -> usize {
        let piece = self
            .pieces
            .iter()
            .rev()
            .find(|(_, bytes)| bytes.start <= byte);
        piece.map_or(0, |(start, bytes)| {
            start + (byte - bytes.start).min(bytes.len())
        })
    }
}
