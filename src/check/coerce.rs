//! Putting values where another type is wanted: the implicit conversions, made explicit.

use super::Checker;
use super::constant;
use super::model::{Constant, Expr, ExprKind, Type};
use super::types::{Fit, is_primitive, unboxed};
use crate::diag::Span;

impl Checker<'_> {
    /// The value as one of type `to`, for a pair of types that fit (or are castable numbers).
    pub(super) fn convert(&self, value: Expr, to: &Type) -> Expr {
        if value.ty == *to || !(is_primitive(&value.ty) || is_primitive(to)) {
            return value;
        }
        // A boxed number is unboxed first and then widened.
        if let Some(inner) = unboxed(&value.ty)
            && inner != *to
        {
            let span = value.span;
            let plain = Expr {
                kind: ExprKind::Convert(Box::new(value)),
                ty: inner,
                span,
            };
            return self.convert(plain, to);
        }
        if let ExprKind::Constant(c) = &value.kind
            && is_primitive(to)
            && let Some(c) = constant::convert(c, to)
        {
            return Expr {
                kind: ExprKind::Constant(c),
                ty: to.clone(),
                span: value.span,
            };
        }
        let span = value.span;
        Expr {
            kind: ExprKind::Convert(Box::new(value)),
            ty: to.clone(),
            span,
        }
    }

    /// The value as it is stored in a variable, field or parameter of type `to`; reported if it cannot be.
    pub(super) fn assign_value(&mut self, value: Expr, to: &Type) -> Option<Expr> {
        if let Some(Fit::Direct | Fit::Loose) = self.fit(&value.ty, to) {
            return Some(self.convert(value, to));
        }
        if let Some(narrowed) = narrow_constant(&value, to) {
            return Some(Expr {
                kind: ExprKind::Constant(narrowed),
                ty: to.clone(),
                span: value.span,
            });
        }
        let fault = self.mismatch(&value.ty, to, value.span);
        self.report(fault);
        None
    }

    /// The value as a condition.
    pub(super) fn boolean(&mut self, value: Expr) -> Option<Expr> {
        if matches!(value.kind, ExprKind::Assign(..)) && value.ty != Type::Boolean {
            let fault = self.mismatch(&value.ty, &Type::Boolean, value.span);
            let hints = vec!["`=` assigns; write `==` to compare".into()];
            self.report(crate::diag::Diagnostic { hints, ..fault });
            return None;
        }
        self.assign_value(value, &Type::Boolean)
    }

    /// The value as an `int` without narrowing (indices, lengths, bounds).
    pub(super) fn int(&mut self, value: Expr) -> Option<Expr> {
        self.assign_value(value, &Type::Int)
    }

    /// The value as text, as Java prints it.
    pub(super) fn text(&self, value: Expr) -> Expr {
        match (&value.kind, &value.ty) {
            (ExprKind::Concat(_), _) | (ExprKind::Constant(Constant::String(_)), _) => value,
            _ => {
                let span = value.span;
                Expr {
                    kind: ExprKind::Concat(vec![value]),
                    ty: Type::String,
                    span,
                }
            }
        }
    }

    /// The value as a number: boxed numbers unboxed; `None` (unreported) if it is none.
    pub(super) fn unbox(&self, value: Expr) -> Expr {
        match unboxed(&value.ty) {
            Some(inner) => self.convert(value, &inner),
            None => value,
        }
    }
}

/// A constant `int` (or smaller) that fits in `byte`, `short` or `char`.
fn narrow_constant(value: &Expr, to: &Type) -> Option<Constant> {
    if !matches!(value.ty, Type::Int | Type::Short | Type::Char | Type::Byte) {
        return None;
    }
    let range = match to {
        Type::Byte => -128..=127,
        Type::Short => -32768..=32767,
        Type::Char => 0..=65535,
        _ => return None,
    };
    match constant::value_of(value)? {
        Constant::Int(v) if range.contains(&v) => Some(Constant::Int(v)),
        _ => None,
    }
}

/// A constant of type `int`.
pub(super) fn int_constant(value: i32, span: Span) -> Expr {
    Expr {
        kind: ExprKind::Constant(Constant::Int(value)),
        ty: Type::Int,
        span,
    }
}
