//! placeholder
use super::ast;
use super::parse::{Reach, Unit, reach};
use super::scan::Scan;
use crate::diag::{Diagnostic, Diagnostics, FileId, Span};

pub(super) fn unreadable(_: FileId, _: &Scan) -> Option<Diagnostics> {
    None
}
pub(super) fn blame(file: FileId, text: &str, scan: &Scan) -> (ast::File, Diagnostics) {
    if let Some(p) = scan.problems.first() {
        return (
            ast::File::default(),
            Diagnostic::error(
                "syntax",
                Span::new(file, p.start, p.end),
                format!("{:?}", p.kind),
            )
            .into(),
        );
    }
    let mut f = ast::File::default();
    let at = match reach(Unit::Item, text) {
        Reach::Byte(b) => b,
        _ => 0,
    };
    let _ = super::parse::Reader::new(file, scan).item_at(0, "", &mut f);
    (
        f,
        Diagnostic::error("syntax", Span::new(file, at, at + 1), "unexpected text").into(),
    )
}
