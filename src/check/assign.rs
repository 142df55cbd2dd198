//! Assignments of all kinds, and what can be assigned to.

use super::Checker;
use super::arithmetic::{Computed, computed, sign};
use super::member::Indexed;
use super::model::{Expr, ExprKind, Place, Type};
use super::names::{Binding, Target};
use super::types::{is_numeric, unboxed};
use crate::diag::{Diagnostic, Span};
use crate::syntax::ast::{self, BinaryOp};

impl Checker<'_> {
    /// The place that an expression names; reported if it names none.
    pub(super) fn target(&mut self, e: &ast::Expr) -> Option<Target> {
        match &e.kind {
            ast::ExprKind::Name(name) => match self.lookup(name, e.span) {
                Some(Binding::Target(target)) => Some(target),
                Some(Binding::Value(_)) => {
                    self.report_final(name, e.span);
                    None
                }
                Some(Binding::Poisoned) => None,
                // Says that the name is unknown.
                None => self.expr(e).and(None),
            },
            ast::ExprKind::Member(object, member) => {
                match self.member_target(object, member, e.span)? {
                    Indexed::Target(target) => Some(target),
                    Indexed::Value(_) => {
                        self.report_final(&member.name, e.span);
                        None
                    }
                }
            }
            ast::ExprKind::Index(object, index) => {
                match self.index_target(object, index, e.span)? {
                    Indexed::Target(target) => Some(target),
                    Indexed::Value(_) => {
                        self.report(Diagnostic::error(
                            "not-assignable",
                            e.span,
                            "this property can only be read",
                        ));
                        None
                    }
                }
            }
            ast::ExprKind::Broken => None,
            _ => {
                let fault =
                    Diagnostic::error("not-assignable", e.span, "this cannot be assigned to");
                self.report(fault.hint("assign to a variable, a property or an array element"));
                None
            }
        }
    }

    fn report_final(&mut self, name: &str, span: Span) {
        let fault = Diagnostic::error(
            "final-variable",
            span,
            format!("`{name}` cannot be changed"),
        );
        self.report(
            fault
                .label("is `final` or `const`")
                .hint("remove `final` where it is declared"),
        );
    }

    /// A place that may be written; notes the write.
    fn writable(&mut self, e: &ast::Expr) -> Option<Target> {
        let target = self.target(e)?;
        if target.is_final {
            let name = match &e.kind {
                ast::ExprKind::Name(name) => name.as_str(),
                ast::ExprKind::Member(_, member) => member.name.as_str(),
                _ => "this",
            };
            self.report_final(name, e.span);
            return None;
        }
        self.note_write(&target.place);
        Some(target)
    }

    /// `x = v` and `x op= v`.
    pub(super) fn assign(
        &mut self,
        op: Option<BinaryOp>,
        target: &ast::Expr,
        value: &ast::Expr,
        span: Span,
    ) -> Option<Expr> {
        let Some(op) = op else {
            let target = self.writable(target);
            let Some(target) = target else {
                // Look at the value all the same, for its own faults.
                return self.expr(value).and(None);
            };
            let value = self.initial_value(value, &target.ty)?;
            return Some(Expr {
                kind: ExprKind::Assign(target.place, Box::new(value)),
                ty: target.ty,
                span,
            });
        };
        let (target, value) = (self.writable(target), self.value(value));
        self.compound(op, target?, value?, span)
    }

    fn compound(&mut self, op: BinaryOp, target: Target, value: Expr, span: Span) -> Option<Expr> {
        let Target { place, ty, .. } = target;
        if op == BinaryOp::Add && ty == Type::String {
            let value = Box::new(self.text(value));
            let kind = ExprKind::Compound {
                place,
                op: None,
                operands: Type::String,
                value,
            };
            return Some(Expr { kind, ty, span });
        }
        let value = self.unbox(value);
        let Some(Computed {
            op: kind, operands, ..
        }) = computed(op, &ty, &value.ty)
        else {
            let (a, b) = (self.type_name(&ty), self.type_name(&value.ty));
            let message = format!("`{}=` does not work on `{a}` and `{b}`", sign(op));
            let mut fault = Diagnostic::error("bad-operands", span, message);
            if unboxed(&ty).is_some() || matches!(ty, Type::Class(_)) {
                fault = fault.hint(format!("write `x = x {} …`", sign(op)));
            }
            self.report(fault);
            return None;
        };
        let is_shift = matches!(op, BinaryOp::Shl | BinaryOp::Shr | BinaryOp::UShr);
        let value_ty = if is_shift {
            Type::Int
        } else {
            operands.clone()
        };
        let value = Box::new(self.convert(value, &value_ty));
        Some(Expr {
            kind: ExprKind::Compound {
                place,
                op: Some(kind),
                operands,
                value,
            },
            ty,
            span,
        })
    }

    /// `++x` and its kin.
    pub(super) fn inc_dec(
        &mut self,
        target: &ast::Expr,
        by: i8,
        is_prefix: bool,
        span: Span,
    ) -> Option<Expr> {
        let Target { place, ty, .. } = self.writable(target)?;
        if !is_numeric(&ty) {
            let message = format!(
                "`{}` needs a number, found `{}`",
                if by > 0 { "++" } else { "--" },
                self.type_name(&ty)
            );
            self.report(Diagnostic::error("bad-operands", span, message));
            return None;
        }
        Some(Expr {
            kind: ExprKind::IncDec {
                place,
                by,
                is_prefix,
            },
            ty,
            span,
        })
    }

    /// `x[a] := v`, `x[a] :+= v`.
    pub(super) fn deferred(
        &mut self,
        op: Option<BinaryOp>,
        target: &ast::Expr,
        value: &ast::Expr,
        span: Span,
    ) -> Option<Expr> {
        let (target_span, target, value) = (target.span, self.writable(target), self.value(value));
        let (target, value) = (target?, value?);
        let is_of_node =
            |place: &Place| matches!(place, Place::Field(e, _) if matches!(e.ty, Type::Node(_)));
        let Target {
            place: Place::Field(node, field),
            ty,
            ..
        } = Some(target).filter(|target| is_of_node(&target.place))?
        else {
            let fault = Diagnostic::error(
                "deferred-target",
                target_span,
                "`:=` needs a property of a node",
            );
            self.report(fault.hint("write `=` for variables and array elements"));
            return None;
        };
        self.cx.facts.is_impure = true;
        let Some(op) = op else {
            let value = Box::new(self.assign_value(value, &ty)?);
            return Some(Expr {
                kind: ExprKind::Deferred {
                    node,
                    field,
                    op: None,
                    value,
                },
                ty: Type::Void,
                span,
            });
        };
        let value = self.unbox(value);
        let Some(Computed { op: kind, .. }) = computed(op, &ty, &value.ty) else {
            let (a, b) = (self.type_name(&ty), self.type_name(&value.ty));
            let message = format!("`:{}=` does not work on `{a}` and `{b}`", sign(op));
            self.report(Diagnostic::error("bad-operands", span, message));
            return None;
        };
        let value = Box::new(self.assign_value(value, &ty)?);
        Some(Expr {
            kind: ExprKind::Deferred {
                node,
                field,
                op: Some(kind),
                value,
            },
            ty: Type::Void,
            span,
        })
    }
}
