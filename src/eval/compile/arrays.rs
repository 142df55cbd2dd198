//! Making arrays.

use std::sync::Arc;

use super::{Scope, convert};
use crate::check::model::{Expr, Type};
use crate::diag::Span;
use crate::eval::access::Access;
use crate::eval::array::{Array, Elements};
use crate::eval::code::{Code, FromCode, Source};
use crate::eval::machine::Machine;
use crate::eval::trap::Trap;
use crate::eval::value::Value;
use crate::library::ClassId;

impl Scope<'_> {
    /// `new T[n][m]`
    pub(super) fn new_array(&self, lengths: &[Expr], ty: &Type, span: Span) -> Code {
        let lengths: Vec<Source<i32>> = lengths.iter().map(|e| self.int(e)).collect();
        // Kinds of elements from the outermost array inwards.
        let mut kinds = vec![];
        let mut inner = ty;
        for _ in &lengths {
            let Type::Array(element) = inner else { break };
            kinds.push(empty(element));
            inner = element;
        }
        Code::Value(Source::code(move |p, m| {
            let mut sizes = Vec::with_capacity(lengths.len());
            for length in &lengths {
                let n = length.get(p, m)?;
                sizes.push(usize::try_from(n).map_err(|_| negative(n, span))?);
            }
            build(m, &kinds, &sizes).map_err(|trap| trap.at(span))
        }))
    }

    /// `{ a, b, c }`
    pub(super) fn array_literal(&self, values: &[Expr], ty: &Type, span: Span) -> Code {
        let element = match ty {
            Type::Array(element) => element,
            other => other,
        };
        let kind = empty(element);
        let values: Vec<Code> = values.iter().map(|v| self.as_type(v, element)).collect();
        Code::Value(Source::code(move |p, m| {
            let array = new_array(m, &kind, values.len()).map_err(|trap| trap.at(span))?;
            for (i, value) in values.iter().enumerate() {
                match value {
                    Code::Void(code) => code(p, m)?,
                    Code::Boolean(s) => put(s.get(p, m)?, &array, i),
                    Code::Int(s) => put(s.get(p, m)?, &array, i),
                    Code::Long(s) => put(s.get(p, m)?, &array, i),
                    Code::Float(s) => put(s.get(p, m)?, &array, i),
                    Code::Double(s) => put(s.get(p, m)?, &array, i),
                    Code::Node(s) => put(s.get(p, m)?, &array, i),
                    Code::Value(s) => put(s.get(p, m)?, &array, i),
                }
            }
            Ok(Value::Array(Arc::new(array)))
        }))
    }

    /// `a.length`
    pub(super) fn array_length(&self, array: &Expr, span: Span) -> Code {
        Code::Int(
            Value::from_code(self.expr(array)).try_map(move |v| match v.as_array() {
                Some(array) => Ok(i32::try_from(array.len()).unwrap_or(i32::MAX)),
                None => Err(Trap::null("read the length of an array", span)),
            }),
        )
    }
}

fn put<T: Access>(value: T, array: &Array, index: usize) {
    let is_there = value.set_element(array, index);
    debug_assert!(
        is_there.is_some(),
        "elements were converted to the type of the array"
    );
}

fn negative(n: i32, span: Span) -> Trap {
    Trap::exception(ClassId::NegativeArraySizeException, n.to_string(), span)
}

/// No elements of the kind that this type is stored in.
pub(super) fn empty(element: &Type) -> Elements {
    match element {
        Type::Boolean => Elements::Boolean(Box::new([])),
        Type::Byte => Elements::Byte(Box::new([])),
        Type::Short => Elements::Short(Box::new([])),
        Type::Char => Elements::Char(Box::new([])),
        Type::Int => Elements::Int(Box::new([])),
        Type::Long => Elements::Long(Box::new([])),
        Type::Float => Elements::Float(Box::new([])),
        Type::Double => Elements::Double(Box::new([])),
        other => {
            debug_assert!(!convert::is_primitive(other));
            Elements::Reference(Box::new([]))
        }
    }
}

/// `n` zeros of a kind, paid for.
pub(super) fn new_array(machine: &Machine, kind: &Elements, n: usize) -> Result<Array, Trap> {
    let charge = machine.charge(
        (n as u64)
            .saturating_mul(kind.element_bytes() as u64)
            .saturating_add(32),
    )?;
    Ok(Array::new(kind.zeros_like(n), charge))
}

fn build(machine: &Machine, kinds: &[Elements], sizes: &[usize]) -> Result<Value, Trap> {
    let ([kind, inner_kinds @ ..], [size, inner_sizes @ ..]) = (kinds, sizes) else {
        return Ok(Value::Null);
    };
    let array = new_array(machine, kind, *size)?;
    if !inner_sizes.is_empty() {
        for i in 0..*size {
            put(build(machine, inner_kinds, inner_sizes)?, &array, i);
        }
    }
    Ok(Value::Array(Arc::new(array)))
}
