//! Methods that can end without giving their value: Java refuses them, GroIMP gives zero.

use super::walk::{self, Visitor};
use crate::check::model::{Constant, Expr, ExprKind, Model, Stmt, StmtKind, Type};
use crate::diag::{Diagnostic, Diagnostics};

/// Warns of them.
pub(super) fn check(model: &Model, found: &mut Diagnostics) {
    for method in &model.methods {
        let Some(body) = method.body.as_ref().filter(|_| method.result != Type::Void) else {
            continue;
        };
        // An empty body stands for a method that others write.
        if !body.is_empty() && goes_on(body) {
            let message = format!("`{}` can end without giving a value", method.name);
            let warning = Diagnostic::warning("missing-return", method.name_span, message)
                .label("gives 0, `false` or `null` then")
                .hint("end it with `return …;`");
            found.push(warning);
        }
    }
}

/// Whether statements can be left at their end, by Java's rules.
fn goes_on(list: &[Stmt]) -> bool {
    list.iter().all(is_passed)
}

fn is_passed(stmt: &Stmt) -> bool {
    match &stmt.kind {
        StmtKind::Return(_) | StmtKind::Throw(_) => false,
        StmtKind::Block(list) => goes_on(list),
        StmtKind::If(_, yes, Some(no)) => is_passed(yes) || is_passed(no),
        StmtKind::Loop { cond, body, .. } => !is_always(cond.as_ref()) || holds_break(body),
        StmtKind::Switch { default, body, .. } => {
            let last = body.last().is_none_or(is_passed);
            default.is_none() || last || body.iter().any(holds_break)
        }
        StmtKind::Labeled(_, inner) => is_passed(inner) || holds_break(inner),
        StmtKind::Try {
            body,
            catches,
            finally,
        } => {
            let handled = catches.iter().any(|(_, _, handler)| goes_on(handler));
            goes_on(finally) && (goes_on(body) || handled)
        }
        _ => true,
    }
}

fn is_always(cond: Option<&Expr>) -> bool {
    cond.is_none_or(|cond| matches!(cond.kind, ExprKind::Constant(Constant::Boolean(true))))
}

/// Whether a `break` stands in a statement; which loop it leaves is not asked.
fn holds_break(stmt: &Stmt) -> bool {
    #[derive(Default)]
    struct Search(bool);
    impl Visitor for Search {
        fn stmt(&mut self, stmt: &Stmt) {
            self.0 |= matches!(stmt.kind, StmtKind::Break(_));
        }
    }
    let mut search = Search::default();
    walk::one_stmt(stmt, &mut search);
    search.0
}
