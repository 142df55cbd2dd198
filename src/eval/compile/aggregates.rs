//! Functions over sequences: `sum`, `count`, `first` and their kin, in the types that the goldens show.

use std::sync::Arc;

use super::sequences::{Iterate, Turn, read_place};
use super::{Scope, arrays, convert};
use crate::check::model::{Aggregate, Expr, ExprKind, Place, Selection, Sequence, Slot, Type};
use crate::diag::Span;
use crate::eval::access::Access;
use crate::eval::array::{Array, Elements};
use crate::eval::code::{Code, FromCode, Source};
use crate::eval::machine::Machine;
use crate::eval::stack::{Kind, Local};
use crate::eval::trap::Trap;
use crate::eval::value::Value;
use crate::graph::pattern::Candidate;
use crate::graph::{FieldId, FieldKind, NodeId, Storage, TypeId};
use crate::library::ClassId;

/// Elements of a list that grows are counted in this unit by the memory budget.
const GROWTH: usize = 1024;

impl Scope<'_> {
    pub(super) fn aggregate(&self, aggregate: Aggregate, sequence: &Sequence, e: &Expr) -> Code {
        let ty = self.element_type(sequence);
        if let Some(code) = self.whole(aggregate, sequence, &ty, e) {
            return code;
        }
        let place = self.element_place(&ty);
        let (Local::Word(at) | Local::Value(at)) = place;
        let elements = self.sequence(sequence, Some(place));
        let is_boolean = ty == Type::Boolean;
        match aggregate {
            Aggregate::Count => Code::Long(Source::code(move |p, m| {
                let mut n = 0_i64;
                elements(p, m, &mut |_, _| {
                    n += 1;
                    Ok(Turn::Next)
                })?;
                Ok(n)
            })),
            Aggregate::Empty => Code::Boolean(any(elements, None).map(|is_any| !is_any)),
            Aggregate::Exist => Code::Boolean(any(elements, is_boolean.then_some((at, true)))),
            Aggregate::Forall => {
                Code::Boolean(any(elements, Some((at, false))).map(|is_any| !is_any))
            }
            Aggregate::First => self.pick(elements, &ty, at, Pick::First),
            Aggregate::Last => self.pick(elements, &ty, at, Pick::Last),
            Aggregate::SelectRandomly => self.pick(elements, &ty, at, Pick::Random),
            Aggregate::Sum
            | Aggregate::Prod
            | Aggregate::Min
            | Aggregate::Max
            | Aggregate::Mean => convert::number(fold(aggregate, elements, &ty, at, e.span), &e.ty),
            Aggregate::Array => collected(elements, &ty, place, e.span),
            Aggregate::String => joined(elements, &ty, place, e.span),
        }
    }

    /// What can be told of all nodes of a type without going from match to match: how many they are, and sums and the like
    /// of a field.
    fn whole(
        &self,
        aggregate: Aggregate,
        sequence: &Sequence,
        ty: &Type,
        e: &Expr,
    ) -> Option<Code> {
        if aggregate == Aggregate::Count {
            let (ty, span) = all_nodes(sequence)?;
            return Some(Code::Long(Source::code(move |_, m| {
                let n = m.graph.count(ty);
                m.spend_matches(n, span)?;
                Ok(n as i64)
            })));
        }
        if let (Aggregate::First | Aggregate::Empty | Aggregate::Exist, Type::Node(_)) =
            (aggregate, ty)
        {
            return first_node(aggregate, sequence);
        }
        let Sequence::Map { source, slot, body } = sequence else {
            return None;
        };
        let ExprKind::Read(Place::Field(of, field)) = &body.kind else {
            return None;
        };
        if !matches!(&of.kind, ExprKind::Read(Place::Local(read)) if read == slot) {
            return None;
        }
        let (of, span) = all_nodes(source)?;
        let declared = self.model.types[of].fields.get(usize::from(field.0))?;
        let column = Column {
            of,
            field: *field,
            span: e.span,
            query: span,
        };
        let is_folded = matches!(
            aggregate,
            Aggregate::Sum | Aggregate::Prod | Aggregate::Min | Aggregate::Max | Aggregate::Mean
        );
        if !is_folded || declared.storage == Storage::Side {
            return None;
        }
        let code = match (declared.kind, ty) {
            (FieldKind::Float, Type::Float) => column.folded::<f32>(aggregate),
            (FieldKind::Double, Type::Double) => column.folded::<f64>(aggregate),
            (FieldKind::Long, Type::Long) => column.folded::<i64>(aggregate),
            (FieldKind::Int, Type::Int) => column.folded::<i32>(aggregate),
            _ => return None,
        };
        Some(convert::number(code, &e.ty))
    }

    /// `selectWhereMin` and `selectWhereMax`: of several elements whose key is extreme the last; `selectWhere`: the first
    /// whose key is true.
    pub(super) fn select_where(
        &self,
        selection: Selection,
        sequence: &Sequence,
        slot: Slot,
        key: &Expr,
        ty: &Type,
    ) -> Code {
        let elements = self.sequence(sequence, Some(self.local(slot)));
        let (Local::Word(at) | Local::Value(at)) = self.local(slot);
        fn select<T: Access>(
            elements: Iterate,
            key: Source<f64>,
            at: u32,
            selection: Selection,
        ) -> Code {
            T::into_code(Source::code(move |p, m| {
                let mut best: Option<(f64, T)> = None;
                elements(p, m, &mut |p, m| {
                    let value = T::load(&m.stack, at);
                    let key = key.get(p, m)?;
                    let is_better = match (selection, &best) {
                        (Selection::First, _) => key > 0.0,
                        (_, None) => true,
                        (Selection::Least, Some((old, _))) => key <= *old,
                        (Selection::Greatest, Some((old, _))) => key >= *old,
                    };
                    if !is_better {
                        return Ok(Turn::Next);
                    }
                    best = Some((key, value));
                    Ok(match selection {
                        Selection::First => Turn::Stop,
                        Selection::Least | Selection::Greatest => Turn::Next,
                    })
                })?;
                Ok(best.map(|(_, value)| value).unwrap_or_default())
            }))
        }
        let key = match selection {
            Selection::First => self.boolean(key).map(|b| f64::from(u8::from(b))),
            Selection::Least | Selection::Greatest => {
                f64::from_code(convert::number(self.expr(key), &Type::Double))
            }
        };
        match ty {
            Type::Boolean => select::<bool>(elements, key, at, selection),
            Type::Byte | Type::Short | Type::Char | Type::Int => {
                select::<i32>(elements, key, at, selection)
            }
            Type::Long => select::<i64>(elements, key, at, selection),
            Type::Float => select::<f32>(elements, key, at, selection),
            Type::Double => select::<f64>(elements, key, at, selection),
            Type::Node(_) => select::<Option<NodeId>>(elements, key, at, selection),
            _ => select::<Value>(elements, key, at, selection),
        }
    }

    fn pick(&self, elements: Iterate, ty: &Type, at: u32, pick: Pick) -> Code {
        match ty {
            Type::Boolean => picked::<bool>(elements, at, pick),
            Type::Byte | Type::Short | Type::Char | Type::Int => picked::<i32>(elements, at, pick),
            Type::Long => picked::<i64>(elements, at, pick),
            Type::Float => picked::<f32>(elements, at, pick),
            Type::Double => picked::<f64>(elements, at, pick),
            Type::Node(_) => picked::<Option<NodeId>>(elements, at, pick),
            _ => picked::<Value>(elements, at, pick),
        }
    }
}

/// Which element is wanted.
#[derive(Clone, Copy)]
enum Pick {
    First,
    Last,
    /// Each with the same probability: the n-th takes the place of the one before with probability 1/n.
    Random,
}

fn picked<T: Access>(elements: Iterate, at: u32, pick: Pick) -> Code {
    T::into_code(Source::code(move |p, m| {
        let mut found = T::default();
        let mut n = 0_i32;
        elements(p, m, &mut |_, m| {
            n = n.saturating_add(1);
            if !matches!(pick, Pick::Random) || m.random.next_int_below(n) == Some(0) {
                found = T::load(&m.stack, at);
            }
            Ok(if matches!(pick, Pick::First) {
                Turn::Stop
            } else {
                Turn::Next
            })
        })?;
        Ok(found)
    }))
}

/// Whether any element is there, or any that is the boolean asked for.
fn any(elements: Iterate, wanted: Option<(u32, bool)>) -> Source<bool> {
    Source::code(move |p, m| {
        let turn = elements(p, m, &mut |_, m| {
            let is_wanted = wanted.is_none_or(|(at, value)| bool::load(&m.stack, at) == value);
            Ok(if is_wanted { Turn::Stop } else { Turn::Next })
        })?;
        Ok(turn == Turn::Stop)
    })
}

/// How numbers of one type are summed, compared and averaged.
trait Number: Access + Copy + PartialOrd {
    const ZERO: Self;
    const ONE: Self;
    const LEAST: Self;
    const GREATEST: Self;
    fn plus(self, other: Self) -> Self;
    fn times(self, other: Self) -> Self;
    /// The number that these words of a field are.
    fn from_words(words: [u32; 2]) -> Self;
    /// The mean of `n` numbers with this sum.
    fn over(self, n: i64, span: Span) -> Result<Self, Trap>;
}

macro_rules! whole_number {
    ($($ty:ty),*) => {$(
        impl Number for $ty {
            const ZERO: Self = 0;
            const ONE: Self = 1;
            const LEAST: Self = <$ty>::MIN;
            const GREATEST: Self = <$ty>::MAX;

            fn plus(self, other: Self) -> Self {
                self.wrapping_add(other)
            }

            fn times(self, other: Self) -> Self {
                self.wrapping_mul(other)
            }

            fn from_words([low, high]: [u32; 2]) -> Self {
                (u64::from(low) | u64::from(high) << 32) as Self
            }

            fn over(self, n: i64, span: Span) -> Result<Self, Trap> {
                if n == 0 {
                    return Err(Trap::exception(ClassId::ArithmeticException, "/ by zero", span));
                }
                Ok((self as i64).wrapping_div(n) as Self)
            }
        }
    )*};
}
whole_number!(i32, i64);

macro_rules! floating_number {
    ($($ty:ty, $from_words:expr;)*) => {$(
        impl Number for $ty {
            const ZERO: Self = 0.0;
            const ONE: Self = 1.0;
            const LEAST: Self = <$ty>::NEG_INFINITY;
            const GREATEST: Self = <$ty>::INFINITY;

            fn plus(self, other: Self) -> Self {
                self + other
            }

            fn times(self, other: Self) -> Self {
                self * other
            }

            fn from_words(words: [u32; 2]) -> Self {
                $from_words(words)
            }

            fn over(self, n: i64, _: Span) -> Result<Self, Trap> {
                Ok(self / n as Self)
            }
        }
    )*};
}
floating_number! {
    f32, |[low, _]: [u32; 2]| f32::from_bits(low);
    f64, |[low, high]: [u32; 2]| f64::from_bits(u64::from(low) | u64::from(high) << 32);
}

/// The type of a query for all nodes of a type, and its place.
fn all_nodes(sequence: &Sequence) -> Option<(TypeId, Span)> {
    let Sequence::Query { pattern, .. } = sequence else {
        return None;
    };
    let [node] = pattern.nodes.as_slice() else {
        return None;
    };
    let Candidate::Type(ty) = node.what else {
        return None;
    };
    let is_free = node.args.is_empty() && pattern.edges.is_empty() && pattern.conditions.is_empty();
    is_free.then_some((ty, pattern.span))
}

/// The first of all nodes of a type, or whether there is one: the others are not looked at.
fn first_node(aggregate: Aggregate, sequence: &Sequence) -> Option<Code> {
    let (ty, span) = all_nodes(sequence)?;
    let first = Source::code(move |_, m: &mut Machine| {
        let first = m.graph.extent(ty).next();
        m.spend_matches(1, span)?;
        Ok(first)
    });
    Some(match aggregate {
        Aggregate::First => Code::Node(first),
        Aggregate::Empty => Code::Boolean(first.map(|node: Option<NodeId>| node.is_none())),
        _ => Code::Boolean(first.map(|node: Option<NodeId>| node.is_some())),
    })
}

/// A field of all nodes of a type.
#[derive(Clone, Copy)]
struct Column {
    of: TypeId,
    field: FieldId,
    span: Span,
    query: Span,
}

impl Column {
    fn folded<T: Number>(self, aggregate: Aggregate) -> Code {
        let (start, step) = steps::<T>(aggregate);
        let is_mean = aggregate == Aggregate::Mean;
        T::into_code(Source::code(move |_, m| {
            let n = m.graph.count(self.of);
            m.spend_matches(n, self.query)?;
            let mut total = start;
            m.graph.scan(self.of, self.field, |words| {
                total = step(total, T::from_words(words));
            });
            if is_mean {
                total.over(n as i64, self.span)
            } else {
                Ok(total)
            }
        }))
    }
}

/// What an aggregate begins with, and what it does with each number.
fn steps<T: Number>(aggregate: Aggregate) -> (T, fn(T, T) -> T) {
    match aggregate {
        Aggregate::Prod => (T::ONE, T::times),
        Aggregate::Min => (T::GREATEST, |a, b| if b < a { b } else { a }),
        Aggregate::Max => (T::LEAST, |a, b| if b > a { b } else { a }),
        _ => (T::ZERO, T::plus),
    }
}

fn fold(aggregate: Aggregate, elements: Iterate, ty: &Type, at: u32, span: Span) -> Code {
    match ty {
        Type::Long => folded::<i64>(aggregate, elements, at, span),
        Type::Float => folded::<f32>(aggregate, elements, at, span),
        Type::Double => folded::<f64>(aggregate, elements, at, span),
        _ => folded::<i32>(aggregate, elements, at, span),
    }
}

fn folded<T: Number>(aggregate: Aggregate, elements: Iterate, at: u32, span: Span) -> Code {
    let (start, step) = steps::<T>(aggregate);
    let is_mean = aggregate == Aggregate::Mean;
    T::into_code(Source::code(move |p, m| {
        let (mut total, mut n) = (start, 0_i64);
        elements(p, m, &mut |_, m| {
            total = step(total, T::load(&m.stack, at));
            n += 1;
            Ok(Turn::Next)
        })?;
        if is_mean {
            total.over(n, span)
        } else {
            Ok(total)
        }
    }))
}

/// `array(seq)`
fn collected(elements: Iterate, ty: &Type, place: Local, span: Span) -> Code {
    let kind = arrays::empty(ty);
    let element = convert::boxed(read_place(ty, place), ty);
    Code::Value(Source::code(move |p, m| {
        let (mut values, mut charge) = (vec![], m.charge(0)?);
        elements(p, m, &mut |p, m| {
            if values.len() % GROWTH == 0 {
                charge = m
                    .charge((values.len() + GROWTH) as u64 * size_of::<Value>() as u64)
                    .map_err(|t| t.at(span))?;
            }
            values.push(element.get(p, m)?);
            Ok(Turn::Next)
        })?;
        drop(charge);
        let array = arrays::new_array(m, &kind, values.len()).map_err(|trap| trap.at(span))?;
        for (i, value) in values.into_iter().enumerate() {
            put_boxed(&array, i, value);
        }
        Ok(Value::Array(Arc::new(array)))
    }))
}

fn put_boxed(array: &Array, index: usize, value: Value) {
    let written = match array.elements() {
        Elements::Boolean(_) => bool::unboxed(&value).set_element(array, index),
        Elements::Byte(_) | Elements::Short(_) | Elements::Char(_) | Elements::Int(_) => {
            i32::unboxed(&value).set_element(array, index)
        }
        Elements::Long(_) => i64::unboxed(&value).set_element(array, index),
        Elements::Float(_) => f32::unboxed(&value).set_element(array, index),
        Elements::Double(_) => f64::unboxed(&value).set_element(array, index),
        Elements::Reference(_) => value.set_element(array, index),
    };
    debug_assert!(written.is_some(), "the array was made for these elements");
}

/// `string(seq)`: `[a, b, c]`
fn joined(elements: Iterate, ty: &Type, place: Local, span: Span) -> Code {
    let element = convert::boxed(read_place(ty, place), ty);
    Code::Value(Source::code(move |p, m| {
        let mut text = String::from("[");
        elements(p, m, &mut |p, m| {
            if text.len() > 1 {
                text.push_str(", ");
            }
            let value = element.get(p, m)?;
            m.append_text(&value, &mut text);
            m.check_text(text.len()).map_err(|trap| trap.at(span))?;
            Ok(Turn::Next)
        })?;
        text.push(']');
        m.new_text(text).map_err(|trap| trap.at(span))
    }))
}
