//! Values that are known before the model runs: for narrowing, `case` labels and the variables declared `final` or `const`.

use super::model::{Constant, Expr, ExprKind, Operator, Type};
use crate::syntax::ast;

/// The value of a literal with an optional minus, before its type is checked.
pub(super) fn of_literal(expr: &ast::Expr) -> Option<Constant> {
    match &expr.kind {
        ast::ExprKind::Literal(literal) => Some(literal_value(literal)),
        ast::ExprKind::Unary(ast::UnaryOp::Minus, operand) => match of_literal(operand)? {
            Constant::Int(v) => Some(Constant::Int(v.wrapping_neg())),
            Constant::Long(v) => Some(Constant::Long(v.wrapping_neg())),
            Constant::Float(v) => Some(Constant::Float(-v)),
            Constant::Double(v) => Some(Constant::Double(-v)),
            Constant::Null | Constant::Boolean(_) | Constant::String(_) => None,
        },
        _ => None,
    }
}

/// The value of a literal.
pub(super) fn literal_value(literal: &ast::Literal) -> Constant {
    match literal {
        ast::Literal::Int(v) => Constant::Int(*v),
        ast::Literal::Long(v) => Constant::Long(*v),
        ast::Literal::Float(v) => Constant::Float(*v),
        ast::Literal::Double(v) => Constant::Double(*v),
        ast::Literal::Boolean(v) => Constant::Boolean(*v),
        ast::Literal::Char(v) => Constant::Int(i32::from(*v)),
        ast::Literal::String(v) => Constant::String(v.clone()),
        ast::Literal::Null => Constant::Null,
    }
}

/// The type of a literal.
pub(super) fn literal_type(literal: &ast::Literal) -> Type {
    match literal {
        ast::Literal::Int(_) => Type::Int,
        ast::Literal::Long(_) => Type::Long,
        ast::Literal::Float(_) => Type::Float,
        ast::Literal::Double(_) => Type::Double,
        ast::Literal::Boolean(_) => Type::Boolean,
        ast::Literal::Char(_) => Type::Char,
        ast::Literal::String(_) => Type::String,
        ast::Literal::Null => Type::Null,
    }
}

/// The value of an expression that the language counts as constant, in the expression's own type.
pub(super) fn value_of(expr: &Expr) -> Option<Constant> {
    match &expr.kind {
        ExprKind::Constant(value) => Some(value.clone()),
        ExprKind::Convert(inner) => convert(&value_of(inner)?, &expr.ty),
        ExprKind::Negate(inner) => Some(match value_of(inner)? {
            Constant::Int(v) => Constant::Int(v.wrapping_neg()),
            Constant::Long(v) => Constant::Long(v.wrapping_neg()),
            Constant::Float(v) => Constant::Float(-v),
            Constant::Double(v) => Constant::Double(-v),
            Constant::Null | Constant::Boolean(_) | Constant::String(_) => return None,
        }),
        ExprKind::Binary {
            op, left, right, ..
        } => match (value_of(left)?, value_of(right)?) {
            (Constant::Int(a), Constant::Int(b)) => int_operation(*op, a, b).map(Constant::Int),
            _ => None,
        },
        _ => None,
    }
}

fn int_operation(op: Operator, a: i32, b: i32) -> Option<i32> {
    Some(match op {
        Operator::Add => a.wrapping_add(b),
        Operator::Sub => a.wrapping_sub(b),
        Operator::Mul => a.wrapping_mul(b),
        Operator::Div if b != 0 => a.wrapping_div(b),
        Operator::Rem if b != 0 => a.wrapping_rem(b),
        Operator::Shl => a.wrapping_shl(b as u32),
        Operator::Shr => a.wrapping_shr(b as u32),
        Operator::And => a & b,
        Operator::Or => a | b,
        Operator::Xor => a ^ b,
        _ => return None,
    })
}

/// The value as one of a primitive type, by Java's conversions; `None` if it is not a number.
pub(super) fn convert(value: &Constant, to: &Type) -> Option<Constant> {
    let narrow = |v: i64| match to {
        Type::Byte => Some(Constant::Int(i32::from(v as i8))),
        Type::Short => Some(Constant::Int(i32::from(v as i16))),
        Type::Char => Some(Constant::Int(i32::from(v as u16))),
        Type::Int => Some(Constant::Int(v as i32)),
        Type::Long => Some(Constant::Long(v)),
        _ => None,
    };
    // Rust's casts from floating point saturate and send NaN to 0, as Java's do; to byte, short and char Java goes by int.
    let from_float = |v: f64| match to {
        Type::Long => Some(Constant::Long(v as i64)),
        _ => narrow(i64::from(v as i32)),
    };
    match (value, to) {
        (Constant::Int(v), Type::Float) => Some(Constant::Float(*v as f32)),
        (Constant::Int(v), Type::Double) => Some(Constant::Double(f64::from(*v))),
        (Constant::Int(v), _) => narrow(i64::from(*v)),
        (Constant::Long(v), Type::Float) => Some(Constant::Float(*v as f32)),
        (Constant::Long(v), Type::Double) => Some(Constant::Double(*v as f64)),
        (Constant::Long(v), _) => narrow(*v),
        (Constant::Float(v), Type::Float) => Some(Constant::Float(*v)),
        (Constant::Float(v), Type::Double) => Some(Constant::Double(f64::from(*v))),
        (Constant::Float(v), _) => from_float(f64::from(*v)),
        (Constant::Double(v), Type::Float) => Some(Constant::Float(*v as f32)),
        (Constant::Double(v), Type::Double) => Some(Constant::Double(*v)),
        (Constant::Double(v), _) => from_float(*v),
        (Constant::Boolean(v), Type::Boolean) => Some(Constant::Boolean(*v)),
        (Constant::String(v), Type::String) => Some(Constant::String(v.clone())),
        _ => None,
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn conversions_follow_java() {
        assert_eq!(
            convert(&Constant::Int(200), &Type::Byte),
            Some(Constant::Int(-56))
        );
        assert_eq!(
            convert(&Constant::Double(1e20), &Type::Int),
            Some(Constant::Int(i32::MAX))
        );
        assert_eq!(
            convert(&Constant::Double(-3.99), &Type::Int),
            Some(Constant::Int(-3))
        );
        assert_eq!(
            convert(&Constant::Long(4_294_967_297), &Type::Int),
            Some(Constant::Int(1))
        );
        assert_eq!(convert(&Constant::Boolean(true), &Type::Int), None);
    }
}
