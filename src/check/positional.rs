//! Positional parameters of patterns: `A(x, 3)` binds and compares.

use super::Checker;
use super::context::Local;
use super::model::{Expr, ExprKind, Type};
use super::pattern::Builder;
use super::types::Fit;
use crate::diag::{Diagnostic, Span};
use crate::graph::pattern::PatternArg;
use crate::graph::{FieldId, TypeId};
use crate::syntax::ast;

impl Checker<'_> {
    /// Positional parameters.
    pub(super) fn pattern_args(
        &mut self,
        builder: &mut Builder,
        ty: TypeId,
        args: &[Option<ast::Expr>],
        span: Span,
        index: usize,
    ) -> Option<Vec<PatternArg<Expr>>> {
        let params = self.positions(ty);
        let is_module = usize::from(ty.0) >= self.n_builtin;
        let n_given = args.len();
        if n_given > params.len() || (is_module && n_given > 0 && n_given < params.len()) {
            if self.is_orphan(ty) {
                return None;
            }
            let name = self.types[ty].name.to_string();
            let noun = if params.len() == 1 {
                "parameter"
            } else {
                "parameters"
            };
            let message = format!(
                "`{name}` has {} {noun}, the pattern gives {n_given}",
                params.len()
            );
            let mut fault = Diagnostic::error("pattern-arguments", span, message);
            if args.last().is_some_and(is_comparison) {
                fault = fault.hint("a condition stands behind a comma: `x:A, (x[n] > 4)`");
            } else if n_given < params.len() {
                fault = fault.hint(format!(
                    "leave gaps for the others: `{name}(x{})`",
                    ",".repeat(params.len() - 1)
                ));
            }
            self.report(fault);
            self.poison_args(args);
            return None;
        }
        let mut checked = vec![];
        for (arg, &field) in args.iter().zip(&params) {
            let Some(arg) = arg else { continue };
            match self.pattern_arg(builder, ty, field, arg, index) {
                Some(arg) => checked.push(arg),
                None => builder.is_wrong = true,
            }
        }
        Some(checked)
    }

    /// Declares the names among the parameters of a node that could not be read, so that their uses are not reported too.
    pub(super) fn poison_args(&mut self, args: &[Option<ast::Expr>]) {
        for arg in args.iter().flatten() {
            let ast::ExprKind::Name(name) = &arg.kind else {
                continue;
            };
            if name == "^" || self.lookup(name, arg.span).is_some() {
                continue;
            }
            let slot = self.cx.slot(Type::Object, arg.span);
            let name = name.clone();
            self.cx.declare(Local {
                name,
                ty: None,
                slot,
                is_final: false,
                value: None,
            });
        }
    }

    /// Fields that positional parameters stand for: of modules their parameters, of built-in types those of the longest constructor.
    pub(super) fn positions(&self, ty: TypeId) -> Vec<FieldId> {
        if let Some(module) = usize::from(ty.0).checked_sub(self.n_builtin) {
            return self.modules[module].params.clone();
        }
        let constructors = crate::turtle::builtin(ty).map_or(&[][..], |row| row.constructors);
        let longest = constructors
            .iter()
            .max_by_key(|fields| fields.len())
            .copied()
            .unwrap_or_default();
        longest
            .iter()
            .filter_map(|name| self.types.field(ty, name))
            .collect()
    }

    fn pattern_arg(
        &mut self,
        builder: &mut Builder,
        ty: TypeId,
        field: FieldId,
        arg: &ast::Expr,
        index: usize,
    ) -> Option<PatternArg<Expr>> {
        let field_ty = self.fields[usize::from(ty.0)]
            .get(usize::from(field.0))?
            .ty
            .clone()?;
        if let ast::ExprKind::Name(name) = &arg.kind
            && name != "^"
            && self.lookup(name, arg.span).is_none()
        {
            if builder.is_optional(index) {
                let message = "a node that may be missing cannot set a variable by its parameter";
                let fault = Diagnostic::error("misplaced-choice", arg.span, message);
                self.report(fault.hint("give the node a label and ask whether that is null"));
                return None;
            }
            let slot = self.bind(builder, name, field_ty, index, arg.span);
            return Some(PatternArg::Bind(field, slot.0));
        }
        let value = self.value(arg)?;
        if self.fit(&value.ty, &field_ty) == Some(Fit::Direct) {
            return Some(PatternArg::Equal(field, self.convert(value, &field_ty)));
        }
        let mut fault = self.mismatch(&value.ty, &field_ty, value.span);
        if (&value.ty, &field_ty) == (&Type::Double, &Type::Float)
            && matches!(value.kind, ExprKind::Constant(_))
        {
            fault.hints =
                vec!["patterns compare exactly: write the number with an `f` at its end".into()];
        }
        if value.ty == Type::Boolean {
            fault = fault.hint("a condition stands behind a comma: `A(x), (x > 4)`");
        }
        self.report(fault);
        None
    }
}

/// `x > 3`: as an argument of a pattern most likely a condition.
fn is_comparison(arg: &Option<ast::Expr>) -> bool {
    use ast::BinaryOp::{And, Eq, Ge, Gt, Le, Lt, Ne, Or};
    let kind = arg.as_ref().map(|arg| &arg.kind);
    matches!(
        kind,
        Some(ast::ExprKind::Binary(
            And | Or | Eq | Ne | Lt | Le | Gt | Ge,
            ..
        ))
    )
}
