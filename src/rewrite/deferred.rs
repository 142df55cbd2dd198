//! Assignments that take effect at the end of the step: `:=`, `:+=` and their kin.

use super::queue::RewriteError;
use crate::check::model::Operator;
use crate::graph::{FieldId, FieldKind, Graph, NodeId, Payload};

/// A value of a deferred assignment, already of the field's type.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum DeferredValue<O> {
    /// For booleans (0 or 1), bytes, shorts, chars and ints.
    Int(i32),
    /// For longs.
    Long(i64),
    /// For floats.
    Float(f32),
    /// For doubles.
    Double(f64),
    /// For everything else.
    Object(O),
}

/// An assignment to a field of a node, computed from the field's value at the end of the step.
#[derive(Clone, Debug)]
pub struct Assignment<O> {
    /// The node; if it is gone by then, nothing happens.
    pub node: NodeId,
    /// Its field.
    pub field: FieldId,
    /// How the value is combined with the old one; `None` sets it. Objects are always set.
    pub op: Option<Operator>,
    /// The right operand.
    pub value: DeferredValue<O>,
}

impl<O: Payload> Assignment<O> {
    pub(super) fn apply(self, graph: &mut Graph<O>) -> Result<(), RewriteError> {
        let Self {
            node,
            field,
            op,
            value,
        } = self;
        let Ok(ty) = graph.type_of(node) else {
            return Ok(());
        };
        let kind = graph.types()[ty].fields[usize::from(field.0)].kind;
        match (kind, value) {
            (FieldKind::Object, DeferredValue::Object(value)) => {
                graph.set_object(node, field, value)?;
            }
            (FieldKind::Object, _) | (_, DeferredValue::Object(_)) => {}
            (FieldKind::Long, value) => {
                let old = graph.get_i64(node, field)?;
                graph.set_i64(node, field, integer(op, old, as_long(&value))?)?;
            }
            (FieldKind::Float, value) => {
                let old = graph.get_f32(node, field)?;
                graph.set_f32(node, field, single(op, old, as_double(&value) as f32))?;
            }
            (FieldKind::Double, value) => {
                let old = graph.get_f64(node, field)?;
                graph.set_f64(node, field, double(op, old, as_double(&value)))?;
            }
            (
                FieldKind::Boolean
                | FieldKind::Byte
                | FieldKind::Short
                | FieldKind::Char
                | FieldKind::Int,
                value,
            ) => {
                let old = graph.get_i32(node, field)?;
                let new = integer(op, i64::from(old), as_long(&value))?;
                graph.set_i32(node, field, new as i32)?;
            }
        }
        Ok(())
    }
}

fn as_long<O>(value: &DeferredValue<O>) -> i64 {
    match *value {
        DeferredValue::Int(x) => i64::from(x),
        DeferredValue::Long(x) => x,
        DeferredValue::Float(x) => x as i64,
        DeferredValue::Double(x) => x as i64,
        DeferredValue::Object(_) => 0,
    }
}

fn as_double<O>(value: &DeferredValue<O>) -> f64 {
    match *value {
        DeferredValue::Int(x) => f64::from(x),
        DeferredValue::Long(x) => x as f64,
        DeferredValue::Float(x) => f64::from(x),
        DeferredValue::Double(x) => x,
        DeferredValue::Object(_) => 0.0,
    }
}

/// Wraps around in the field's width when stored: the low bits of sums and products depend on low bits only.
fn integer(op: Option<Operator>, old: i64, value: i64) -> Result<i64, RewriteError> {
    Ok(match op {
        Some(Operator::Add) => old.wrapping_add(value),
        Some(Operator::Sub) => old.wrapping_sub(value),
        Some(Operator::Mul) => old.wrapping_mul(value),
        Some(Operator::Div | Operator::Rem) if value == 0 => {
            return Err(RewriteError::DivisionByZero);
        }
        Some(Operator::Div) => old.wrapping_div(value),
        Some(Operator::Rem) => old.wrapping_rem(value),
        Some(Operator::Pow) => crate::math::functions::pow(old as f64, value as f64) as i64,
        Some(Operator::And) => old & value,
        Some(Operator::Or) => old | value,
        Some(Operator::Xor) => old ^ value,
        Some(Operator::Shl) => old.wrapping_shl(value as u32),
        Some(Operator::Shr) => old.wrapping_shr(value as u32),
        Some(Operator::UShr) => (old as u64).wrapping_shr(value as u32) as i64,
        // Comparisons are no assignments.
        Some(
            Operator::Eq | Operator::Ne | Operator::Lt | Operator::Le | Operator::Gt | Operator::Ge,
        )
        | None => value,
    })
}

fn single(op: Option<Operator>, old: f32, value: f32) -> f32 {
    match op {
        Some(Operator::Add) => old + value,
        Some(Operator::Sub) => old - value,
        Some(Operator::Mul) => old * value,
        Some(Operator::Div) => old / value,
        Some(Operator::Rem) => old % value,
        Some(Operator::Pow) => crate::math::functions::pow(f64::from(old), f64::from(value)) as f32,
        Some(_) | None => value,
    }
}

fn double(op: Option<Operator>, old: f64, value: f64) -> f64 {
    match op {
        Some(Operator::Add) => old + value,
        Some(Operator::Sub) => old - value,
        Some(Operator::Mul) => old * value,
        Some(Operator::Div) => old / value,
        Some(Operator::Rem) => old % value,
        Some(Operator::Pow) => crate::math::functions::pow(old, value),
        Some(_) | None => value,
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::graph::testing::{V, graph, type_named};

    fn after(assignments: &[(Option<Operator>, i32)]) -> Result<i32, RewriteError> {
        let mut graph = graph("S A(7)");
        let node = graph.extent(type_named(&graph, "A")).next().expect("one");
        for &(op, value) in assignments {
            let value = DeferredValue::Int(value);
            Assignment {
                node,
                field: V,
                op,
                value,
            }
            .apply(&mut graph)?;
        }
        Ok(graph.get_i32(node, V)?)
    }

    #[test]
    fn assignments_apply_in_order() {
        let (add, mul) = (Some(Operator::Add), Some(Operator::Mul));
        assert_eq!(after(&[(mul, 2), (add, 1)]), Ok(15));
        assert_eq!(after(&[(None, 5), (None, 8)]), Ok(8));
        assert_eq!(after(&[(add, i32::MAX)]), Ok(i32::MIN + 6));
        assert_eq!(
            after(&[(Some(Operator::Div), 0)]),
            Err(RewriteError::DivisionByZero)
        );
    }
}
