//! Code behind a `return`, `break`, `continue` or `throw`.

use super::walk::{self, Visitor};
use crate::check::model::{Model, Production, Stmt, StmtKind};
use crate::diag::{Diagnostic, Diagnostics, Span};

/// Warns of it, once for each list of statements.
pub(super) fn check(model: &Model, found: &mut Diagnostics) {
    walk::model(model, &mut Reach { found });
}

struct Reach<'f> {
    found: &'f mut Diagnostics,
}

impl Visitor for Reach<'_> {
    fn stmts(&mut self, list: &[Stmt]) {
        for pair in list.windows(2) {
            let [jump, next] = pair else { continue };
            if let Some(word) = jump_word(jump) {
                self.warn(word, jump.span, next.span);
                return;
            }
        }
    }

    fn productions(&mut self, list: &[Production]) {
        for pair in list.windows(2) {
            let [Production::Code(code), Production::Node { node, .. }] = pair else {
                continue;
            };
            let Some(jump) = code.last() else { continue };
            if let Some(word) = jump_word(jump) {
                self.warn(word, jump.span, node.span);
                return;
            }
        }
    }
}

impl Reach<'_> {
    fn warn(&mut self, word: &str, jump: Span, next: Span) {
        let warning = Diagnostic::warning("unreachable", next, "this is never reached")
            .label("never runs")
            .also(jump, format!("`{word}` always leaves here"))
            .hint(format!("delete it, or give `{word}` a condition"));
        self.found.push(warning);
    }
}

/// The word of a statement after which the next one never runs.
fn jump_word(stmt: &Stmt) -> Option<&'static str> {
    match stmt.kind {
        StmtKind::Return(_) => Some("return"),
        StmtKind::Break(_) => Some("break"),
        StmtKind::Continue(_) => Some("continue"),
        StmtKind::Throw(_) => Some("throw"),
        _ => None,
    }
}
