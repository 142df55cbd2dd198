//! Arithmetic, comparisons and logic.

use super::Scope;
use super::convert::number;
use crate::check::model::{Expr, Operator, Type};
use crate::diag::Span;
use crate::eval::code::{Code, FromCode, Source};
use crate::eval::library::pow;
use crate::eval::trap::Trap;
use crate::eval::value::Value;
use crate::graph::NodeId;
use crate::library::ClassId;

impl Scope<'_> {
    pub(super) fn binary(
        &self,
        op: Operator,
        operands: &Type,
        sides: [&Expr; 2],
        span: Span,
    ) -> Code {
        let [left, right] = sides.map(|side| self.expr(side));
        combine(op, operands, left, right, span)
    }

    pub(super) fn and_then(&self, left: &Expr, right: &Expr) -> Code {
        let (left, right) = (self.boolean(left), self.boolean(right));
        Code::Boolean(Source::code(move |p, m| {
            Ok(left.get(p, m)? && right.get(p, m)?)
        }))
    }

    pub(super) fn or_else(&self, left: &Expr, right: &Expr) -> Code {
        let (left, right) = (self.boolean(left), self.boolean(right));
        Code::Boolean(Source::code(move |p, m| {
            Ok(left.get(p, m)? || right.get(p, m)?)
        }))
    }

    pub(super) fn negate(&self, operand: &Expr, ty: &Type) -> Code {
        match number(self.expr(operand), ty) {
            Code::Int(s) => Code::Int(s.map(i32::wrapping_neg)),
            Code::Long(s) => Code::Long(s.map(i64::wrapping_neg)),
            Code::Float(s) => Code::Float(s.map(|x| -x)),
            Code::Double(s) => Code::Double(s.map(|x| -x)),
            other => other,
        }
    }

    pub(super) fn complement(&self, operand: &Expr, ty: &Type) -> Code {
        match number(self.expr(operand), ty) {
            Code::Int(s) => Code::Int(s.map(|x| !x)),
            Code::Long(s) => Code::Long(s.map(|x| !x)),
            other => other,
        }
    }
}

/// `left op right`, both already of the type `operands` (but for the distance of a shift).
pub(super) fn combine(op: Operator, operands: &Type, left: Code, right: Code, span: Span) -> Code {
    match operands {
        Type::Boolean => booleans(op, FromCode::from_code(left), FromCode::from_code(right)),
        Type::Byte | Type::Short | Type::Char | Type::Int => ints(
            op,
            FromCode::from_code(left),
            FromCode::from_code(number(right, &Type::Int)),
            span,
        ),
        Type::Long => longs(op, FromCode::from_code(left), right, span),
        Type::Float => floats(op, FromCode::from_code(left), FromCode::from_code(right)),
        Type::Double => doubles(op, FromCode::from_code(left), FromCode::from_code(right)),
        Type::Node(_) => nodes(op, FromCode::from_code(left), FromCode::from_code(right)),
        _ => values(op, FromCode::from_code(left), FromCode::from_code(right)),
    }
}

fn booleans(op: Operator, a: Source<bool>, b: Source<bool>) -> Code {
    Code::Boolean(match op {
        Operator::And => a.zip(b, |a, b| a & b),
        Operator::Or => a.zip(b, |a, b| a | b),
        Operator::Eq => a.zip(b, |a, b| a == b),
        _ => a.zip(b, |a, b| a != b),
    })
}

/// Pastes the comparisons, which all numeric types share.
macro_rules! comparison {
    ($op:expr, $a:expr, $b:expr) => {
        Code::Boolean(match $op {
            Operator::Eq => $a.zip($b, |a, b| a == b),
            Operator::Ne => $a.zip($b, |a, b| a != b),
            Operator::Lt => $a.zip($b, |a, b| a < b),
            Operator::Le => $a.zip($b, |a, b| a <= b),
            Operator::Gt => $a.zip($b, |a, b| a > b),
            _ => $a.zip($b, |a, b| a >= b),
        })
    };
}

fn divided_by_zero(span: Span) -> Trap {
    Trap::exception(ClassId::ArithmeticException, "/ by zero", span)
}

fn ints(op: Operator, a: Source<i32>, b: Source<i32>, span: Span) -> Code {
    Code::Int(match op {
        Operator::Add => a.zip(b, i32::wrapping_add),
        Operator::Sub => a.zip(b, i32::wrapping_sub),
        Operator::Mul => a.zip(b, i32::wrapping_mul),
        Operator::Div => a.try_zip(b, move |a, b| {
            if b == 0 {
                Err(divided_by_zero(span))
            } else {
                Ok(a.wrapping_div(b))
            }
        }),
        Operator::Rem => a.try_zip(b, move |a, b| {
            if b == 0 {
                Err(divided_by_zero(span))
            } else {
                Ok(a.wrapping_rem(b))
            }
        }),
        // Only the five lowest bits of the distance count, as in Java.
        Operator::Shl => a.zip(b, |a, b| a.wrapping_shl(b as u32)),
        Operator::Shr => a.zip(b, |a, b| a.wrapping_shr(b as u32)),
        Operator::UShr => a.zip(b, |a, b| (a as u32).wrapping_shr(b as u32) as i32),
        Operator::And => a.zip(b, |a, b| a & b),
        Operator::Or => a.zip(b, |a, b| a | b),
        Operator::Xor => a.zip(b, |a, b| a ^ b),
        Operator::Pow => {
            return Code::Float(a.zip(b, |a, b| pow(f64::from(a), f64::from(b)) as f32));
        }
        op => return comparison!(op, a, b),
    })
}

fn longs(op: Operator, a: Source<i64>, right: Code, span: Span) -> Code {
    if matches!(op, Operator::Shl | Operator::Shr | Operator::UShr) {
        let distance: Source<i32> = FromCode::from_code(number(right, &Type::Int));
        return Code::Long(match op {
            Operator::Shl => a.zip(distance, |a, b| a.wrapping_shl(b as u32)),
            Operator::Shr => a.zip(distance, |a, b| a.wrapping_shr(b as u32)),
            _ => a.zip(distance, |a, b| (a as u64).wrapping_shr(b as u32) as i64),
        });
    }
    let b: Source<i64> = FromCode::from_code(right);
    Code::Long(match op {
        Operator::Add => a.zip(b, i64::wrapping_add),
        Operator::Sub => a.zip(b, i64::wrapping_sub),
        Operator::Mul => a.zip(b, i64::wrapping_mul),
        Operator::Div => a.try_zip(b, move |a, b| {
            if b == 0 {
                Err(divided_by_zero(span))
            } else {
                Ok(a.wrapping_div(b))
            }
        }),
        Operator::Rem => a.try_zip(b, move |a, b| {
            if b == 0 {
                Err(divided_by_zero(span))
            } else {
                Ok(a.wrapping_rem(b))
            }
        }),
        Operator::And => a.zip(b, |a, b| a & b),
        Operator::Or => a.zip(b, |a, b| a | b),
        Operator::Xor => a.zip(b, |a, b| a ^ b),
        Operator::Pow => return Code::Float(a.zip(b, |a, b| pow(a as f64, b as f64) as f32)),
        op => return comparison!(op, a, b),
    })
}

fn floats(op: Operator, a: Source<f32>, b: Source<f32>) -> Code {
    Code::Float(match op {
        Operator::Add => a.zip(b, |a, b| a + b),
        Operator::Sub => a.zip(b, |a, b| a - b),
        Operator::Mul => a.zip(b, |a, b| a * b),
        Operator::Div => a.zip(b, |a, b| a / b),
        Operator::Rem => a.zip(b, |a, b| a % b),
        Operator::Pow => a.zip(b, |a, b| pow(f64::from(a), f64::from(b)) as f32),
        op => return comparison!(op, a, b),
    })
}

fn doubles(op: Operator, a: Source<f64>, b: Source<f64>) -> Code {
    Code::Double(match op {
        Operator::Add => a.zip(b, |a, b| a + b),
        Operator::Sub => a.zip(b, |a, b| a - b),
        Operator::Mul => a.zip(b, |a, b| a * b),
        Operator::Div => a.zip(b, |a, b| a / b),
        Operator::Rem => a.zip(b, |a, b| a % b),
        Operator::Pow => a.zip(b, pow),
        op => return comparison!(op, a, b),
    })
}

fn nodes(op: Operator, a: Source<Option<NodeId>>, b: Source<Option<NodeId>>) -> Code {
    Code::Boolean(match op {
        Operator::Eq => a.zip(b, |a, b| a == b),
        _ => a.zip(b, |a, b| a != b),
    })
}

fn values(op: Operator, a: Source<Value>, b: Source<Value>) -> Code {
    Code::Boolean(match op {
        Operator::Eq => a.zip(b, |a, b| a.is_same(&b)),
        _ => a.zip(b, |a, b| !a.is_same(&b)),
    })
}
