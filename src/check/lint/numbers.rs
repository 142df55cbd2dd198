//! Quotients of whole numbers where a fraction was meant.

use super::walk::{self, Visitor};
use crate::check::model::{Constant, Expr, ExprKind, Model, Operator, Type};
use crate::diag::{Diagnostic, Diagnostics};

/// Warns of `4 / 3 * PI`: the quotient of two written whole numbers loses its fraction and is then used as a number with one.
pub(super) fn check(model: &Model, found: &mut Diagnostics) {
    walk::model(model, &mut Numbers { found });
}

struct Numbers<'f> {
    found: &'f mut Diagnostics,
}

impl Visitor for Numbers<'_> {
    fn expr(&mut self, expr: &Expr) {
        let (ExprKind::Convert(inner), Type::Float | Type::Double) = (&expr.kind, &expr.ty) else {
            return;
        };
        let ExprKind::Binary {
            op: Operator::Div,
            left,
            right,
            ..
        } = &inner.kind
        else {
            return;
        };
        let (ExprKind::Constant(Constant::Int(a)), ExprKind::Constant(Constant::Int(b))) =
            (&left.kind, &right.kind)
        else {
            return;
        };
        let Some(quotient) = a.checked_div(*b) else {
            return;
        };
        if a.checked_rem(*b) == Some(0) {
            return;
        }
        let message = format!("`{a} / {b}` is divided as whole numbers: it is {quotient}");
        let warning = Diagnostic::warning("integer-division", inner.span, message)
            .label(format!("loses its fraction, {quotient} is left"))
            .hint(format!("write `{a}.0 / {b}`"));
        self.found.push(warning);
    }
}
