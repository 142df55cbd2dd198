//! The static methods of `Collections`, and comparators.

use std::cmp::Ordering;
use std::sync::Arc;

use super::{Arguments, Context, arrays, collections, new_object};
use crate::eval::object::{Data, List};
use crate::eval::trap::Trap;
use crate::eval::value::Value;
use crate::library::ClassId;

/// Works on the elements of the list at `args[0]`.
fn on_values(
    cx: &Context<'_>,
    args: &[Value],
    f: impl FnOnce(&mut Vec<Value>),
) -> Result<Value, Trap> {
    if let Data::List(List { values, .. }) = &mut *cx.object(args, 0)?.lock() {
        f(values);
    }
    Ok(Value::Null)
}

/// `Collections.sort(list)`, `Collections.sort(list, comparator)`, `list.sort(comparator)`
pub(super) fn sort(cx: &mut Context<'_>, args: &[Value]) -> Result<Value, Trap> {
    let values = collections::elements(cx, args, 0)?;
    let sorted = cx.program.sorted(cx.machine, values, args.at(1), cx.span)?;
    on_values(cx, args, |values| *values = sorted)
}

pub(super) fn reverse(cx: &mut Context<'_>, args: &[Value]) -> Result<Value, Trap> {
    on_values(cx, args, |values| values.reverse())
}

/// `Collections.shuffle(list)`, by the generator of the model; `Collections.shuffle(list, random)`.
pub(super) fn shuffle(cx: &mut Context<'_>, args: &[Value]) -> Result<Value, Trap> {
    let mut values = collections::elements(cx, args, 0)?;
    for i in (1..values.len()).rev() {
        let bound = i32::try_from(i + 1).unwrap_or(i32::MAX);
        let j = match args.at(1) {
            Value::Object(own) => match &mut *own.lock() {
                Data::Random(random) => random.next_int_below(bound),
                _ => None,
            },
            _ => cx.machine.random.next_int_below(bound),
        };
        values.swap(i, usize::try_from(j.unwrap_or(0)).unwrap_or(0));
    }
    on_values(cx, args, |old| *old = values)
}

fn extreme(cx: &mut Context<'_>, args: &[Value], wanted: Ordering) -> Result<Value, Trap> {
    let mut values = collections::elements(cx, args, 0)?.into_iter();
    let Some(mut best) = values.next() else {
        let message = "the collection is empty";
        return Err(cx.exception(ClassId::NoSuchElementException, message));
    };
    for value in values {
        let pair = [&value, &best];
        if cx.program.order(cx.machine, pair, &Value::Null, cx.span)? == wanted {
            best = value;
        }
    }
    Ok(best)
}

pub(super) fn least(cx: &mut Context<'_>, args: &[Value]) -> Result<Value, Trap> {
    extreme(cx, args, Ordering::Less)
}

pub(super) fn greatest(cx: &mut Context<'_>, args: &[Value]) -> Result<Value, Trap> {
    extreme(cx, args, Ordering::Greater)
}

/// `Collections.swap(list, i, j)`
pub(super) fn swap(cx: &mut Context<'_>, args: &[Value]) -> Result<Value, Trap> {
    let n = collections::elements(cx, args, 0)?.len();
    let (i, j) = (
        collections::checked(cx, args.int(1), n)?,
        collections::checked(cx, args.int(2), n)?,
    );
    on_values(cx, args, |values| values.swap(i, j))
}

/// `Collections.frequency(collection, value)`
pub(super) fn frequency(cx: &mut Context<'_>, args: &[Value]) -> Result<Value, Trap> {
    let mut n = 0_i32;
    for value in collections::elements(cx, args, 0)? {
        n += i32::from(cx.equal(args.at(1), &value)?);
    }
    Ok(Value::Int(n))
}

/// `Collections.addAll(collection, values)`
pub(super) fn add_all(cx: &mut Context<'_>, args: &[Value]) -> Result<Value, Trap> {
    let added = arrays::all(arrays::array(cx, args, 1)?);
    collections::add_values(cx, args.at(0), added)
}

pub(super) fn empty_list(cx: &mut Context<'_>, _: &[Value]) -> Result<Value, Trap> {
    collections::list_of(cx, vec![])
}

/// `Collections.nCopies(n, value)`
pub(super) fn copies(cx: &mut Context<'_>, args: &[Value]) -> Result<Value, Trap> {
    let Ok(n) = usize::try_from(args.int(0)) else {
        let message = format!("List length = {}", args.int(0));
        return Err(cx.exception(ClassId::IllegalArgumentException, message));
    };
    // The budget is asked before the memory is taken.
    let room = cx.machine.charge(32 * n as u64);
    drop(room.map_err(|trap| trap.at(cx.span))?);
    collections::list_of(cx, vec![args.at(1).clone(); n])
}

/// `Collections.reverseOrder()`
pub(super) fn reverse_order(_: &mut Context<'_>, _: &[Value]) -> Result<Value, Trap> {
    Ok(new_object(ClassId::Comparator, Data::Reversed(Value::Null)))
}

/// `comparator.reversed()`
pub(super) fn reversed(cx: &mut Context<'_>, args: &[Value]) -> Result<Value, Trap> {
    let inner = Value::Object(Arc::clone(cx.object(args, 0)?));
    Ok(new_object(ClassId::Comparator, Data::Reversed(inner)))
}

fn answer(order: Ordering) -> Value {
    Value::Int(match order {
        Ordering::Less => -1,
        Ordering::Equal => 0,
        Ordering::Greater => 1,
    })
}

/// `comparator.compare(a, b)`
pub(super) fn compare(cx: &mut Context<'_>, args: &[Value]) -> Result<Value, Trap> {
    cx.object(args, 0)?;
    let pair = [args.at(1), args.at(2)];
    Ok(answer(cx.program.order(
        cx.machine,
        pair,
        args.at(0),
        cx.span,
    )?))
}

/// `a.compareTo(b)`
pub(super) fn compare_to(cx: &mut Context<'_>, args: &[Value]) -> Result<Value, Trap> {
    let pair = [args.at(0), args.at(1)];
    if pair.iter().any(|value| value.is_null()) {
        return Err(Trap::null("compare an object", cx.span));
    }
    Ok(answer(cx.program.order(
        cx.machine,
        pair,
        &Value::Null,
        cx.span,
    )?))
}
