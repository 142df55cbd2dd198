//! `switch`.

use super::Checker;
use super::constant;
use super::model::{Constant, Stmt, StmtKind, Type};
use super::types::promote;
use crate::diag::Diagnostic;
use crate::syntax::ast;

impl Checker<'_> {
    /// `switch (value) { … }` over whole numbers or strings.
    pub(super) fn switch(
        &mut self,
        value: &ast::Expr,
        cases: &[ast::SwitchCase],
    ) -> Option<StmtKind> {
        let value = self.value(value).map(|value| self.unbox(value));
        let ty = value.as_ref().map(|value| value.ty.clone());
        let is_good = |ty: &Type| *ty == Type::String || Self::is_index(ty);
        if let Some((bad, value)) = ty
            .as_ref()
            .zip(value.as_ref())
            .filter(|(ty, _)| !is_good(ty))
        {
            let message = format!(
                "`switch` needs a whole number or a string, found `{}`",
                self.type_name(bad)
            );
            self.report(Diagnostic::error("bad-switch", value.span, message));
        }
        let (mut starts, mut default, mut body) = (vec![], None, vec![]);
        self.cx.open();
        self.cx.switches += 1;
        for case in cases {
            match &case.value {
                Some(label) => {
                    if let Some(constant) = self.case_label(label, ty.as_ref(), &starts) {
                        starts.push((constant, body.len()));
                    }
                }
                None if default.is_some() => {
                    let span = case
                        .body
                        .first()
                        .map_or_else(crate::diag::Span::default, |stmt: &ast::Stmt| stmt.span);
                    self.report(Diagnostic::error(
                        "duplicate-case",
                        span,
                        "`switch` has two `default`",
                    ));
                }
                None => default = Some(body.len()),
            }
            let stmts: Vec<Stmt> = self.stmts(&case.body);
            body.extend(stmts);
        }
        self.cx.switches -= 1;
        self.cx.close();
        let value = value?;
        let ty = promote(&value.ty);
        Some(StmtKind::Switch {
            value: self.convert(value, &ty),
            cases: starts,
            default,
            body,
        })
    }

    /// The constant after `case`; reported if it is none.
    fn case_label(
        &mut self,
        label: &ast::Expr,
        ty: Option<&Type>,
        earlier: &[(Constant, usize)],
    ) -> Option<Constant> {
        let checked = self.value(label)?;
        let ty = ty?;
        let checked = self.assign_value(checked, ty)?;
        let Some(constant) = constant::value_of(&checked) else {
            let fault = Diagnostic::error(
                "bad-case",
                label.span,
                "what stands after `case` must be a constant",
            );
            self.report(fault.hint("use a number, a text or a `final` variable with such a value"));
            return None;
        };
        if earlier.iter().any(|(value, _)| *value == constant) {
            self.report(Diagnostic::error(
                "duplicate-case",
                label.span,
                "this `case` stands twice",
            ));
            return None;
        }
        Some(constant)
    }
}
