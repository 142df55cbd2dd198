//! Conversions between numbers, and between numbers and their boxes, by Java's rules.

use super::Scope;
use crate::check::model::{Expr, Type};
use crate::diag::Span;
use crate::eval::code::{Code, FromCode, Source};
use crate::eval::stack::Kind;
use crate::eval::trap::Trap;
use crate::eval::value::Value;
use crate::library::ClassId;

impl Scope<'_> {
    /// `expr` converted to `to`.
    pub(super) fn convert(&self, expr: &Expr, to: &Type) -> Code {
        let code = self.expr(expr);
        match (&expr.ty, to) {
            (from, to) if from == to => code,
            (from, to) if is_primitive(from) && is_primitive(to) => number(code, to),
            (from, to) if is_primitive(from) => Code::Value(boxed(code, box_type(from, to))),
            (_, to) if is_primitive(to) => unboxed(Value::from_code(code), to, expr.span),
            (_, Type::Node(_)) => Code::Node(FromCode::from_code(code)),
            _ => Code::Value(FromCode::from_code(code)),
        }
    }
}

/// Whether variables of this type are numbers, characters or booleans.
pub(super) fn is_primitive(ty: &Type) -> bool {
    match ty {
        Type::Boolean | Type::Byte | Type::Short | Type::Char | Type::Int => true,
        Type::Long | Type::Float | Type::Double => true,
        Type::Void | Type::Null | Type::String | Type::Node(_) => false,
        Type::Class(_) | Type::Generic(..) | Type::Instance(_) | Type::Array(_) | Type::Object => {
            false
        }
    }
}

/// The type of the box: that of the class asked for, if it is a box of its own, else of the value.
fn box_type<'t>(from: &'t Type, to: &'t Type) -> &'t Type {
    match to {
        Type::Class(ClassId::Byte) => &Type::Byte,
        Type::Class(ClassId::Short) => &Type::Short,
        Type::Class(ClassId::Integer) => &Type::Int,
        Type::Class(ClassId::Long) => &Type::Long,
        Type::Class(ClassId::Float) => &Type::Float,
        Type::Class(ClassId::Double) => &Type::Double,
        Type::Class(ClassId::Character) => &Type::Char,
        _ => from,
    }
}

/// A number in another numeric type: rounds, saturates (floating to integer) or wraps (integer to integer).
pub(super) fn number(code: Code, to: &Type) -> Code {
    match to {
        Type::Byte => Code::Int(int(code).map(|x| i32::from(x as i8))),
        Type::Short => Code::Int(int(code).map(|x| i32::from(x as i16))),
        Type::Char => Code::Int(int(code).map(|x| i32::from(x as u16))),
        Type::Int => Code::Int(int(code)),
        Type::Long => Code::Long(match code {
            Code::Int(s) => s.map(i64::from),
            Code::Float(s) => s.map(|x| x as i64),
            Code::Double(s) => s.map(|x| x as i64),
            other => FromCode::from_code(other),
        }),
        Type::Float => Code::Float(match code {
            Code::Int(s) => s.map(|x| x as f32),
            Code::Long(s) => s.map(|x| x as f32),
            Code::Double(s) => s.map(|x| x as f32),
            other => FromCode::from_code(other),
        }),
        Type::Double => Code::Double(match code {
            Code::Int(s) => s.map(f64::from),
            Code::Long(s) => s.map(|x| x as f64),
            Code::Float(s) => s.map(f64::from),
            other => FromCode::from_code(other),
        }),
        _ => code,
    }
}

fn int(code: Code) -> Source<i32> {
    match code {
        Code::Long(s) => s.map(|x| x as i32),
        Code::Float(s) => s.map(|x| x as i32),
        Code::Double(s) => s.map(|x| x as i32),
        other => FromCode::from_code(other),
    }
}

/// A number in the box of type `ty`; anything else as the value it is.
pub(super) fn boxed(code: Code, ty: &Type) -> Source<Value> {
    match (number(code, ty), ty) {
        (Code::Int(s), Type::Byte) => s.map(|x| Value::Byte(x as i8)),
        (Code::Int(s), Type::Short) => s.map(|x| Value::Short(x as i16)),
        (Code::Int(s), Type::Char) => s.map(|x| Value::Char(x as u16)),
        (code, _) => FromCode::from_code(code),
    }
}

/// The number in a box.
fn unboxed(value: Source<Value>, to: &Type, span: Span) -> Code {
    fn taken<T: Kind>(
        value: Source<Value>,
        span: Span,
        take: impl Fn(&Value) -> Option<T> + Send + Sync + 'static,
    ) -> Source<T> {
        value.try_map(move |v| match take(&v) {
            Some(x) => Ok(x),
            None if v.is_null() => Err(Trap::null("take the number out of a box", span)),
            None => Err(Trap::exception(
                ClassId::ClassCastException,
                format!("`{v}` is not of the type wanted here"),
                span,
            )),
        })
    }
    match to {
        Type::Boolean => Code::Boolean(taken(value, span, Value::as_boolean)),
        Type::Byte | Type::Short | Type::Char | Type::Int => {
            number(Code::Int(taken(value, span, Value::as_int)), to)
        }
        Type::Long => Code::Long(taken(value, span, Value::as_long)),
        Type::Float => Code::Float(taken(value, span, Value::as_float)),
        _ => Code::Double(taken(value, span, Value::as_double)),
    }
}
