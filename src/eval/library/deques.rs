//! Lists from both ends and in bulk: `LinkedList`, `Vector`, `Stack`.

use super::collections::{add_values, checked, elements, end, list_of, on_list, pay};
use super::{Arguments, Context, arrays, keyed};
use crate::eval::object::Data;
use crate::eval::trap::Trap;
use crate::eval::value::Value;

/// Inserts in front, as `push` and `offerFirst`; gives true.
pub(super) fn offer_first(cx: &mut Context<'_>, args: &[Value]) -> Result<Value, Trap> {
    super::collections::add_first(cx, args)?;
    Ok(Value::Boolean(true))
}

/// The element at an end, removed if asked for; null if there is none.
fn polled(cx: &Context<'_>, args: &[Value], is_last: bool, is_taken: bool) -> Result<Value, Trap> {
    on_list(cx, args, |list| {
        Ok(match end(cx, &list.values, is_last) {
            Ok(at) if is_taken => list.values.remove(at),
            Ok(at) => list.values[at].clone(),
            Err(_) => Value::Null,
        })
    })
}

pub(super) fn poll_first(cx: &mut Context<'_>, args: &[Value]) -> Result<Value, Trap> {
    polled(cx, args, false, true)
}

pub(super) fn poll_last(cx: &mut Context<'_>, args: &[Value]) -> Result<Value, Trap> {
    polled(cx, args, true, true)
}

pub(super) fn peek_first(cx: &mut Context<'_>, args: &[Value]) -> Result<Value, Trap> {
    polled(cx, args, false, false)
}

pub(super) fn peek_last(cx: &mut Context<'_>, args: &[Value]) -> Result<Value, Trap> {
    polled(cx, args, true, false)
}

/// `list.addAll(index, collection)`
pub(super) fn insert_all(cx: &mut Context<'_>, args: &[Value]) -> Result<Value, Trap> {
    let added = elements(cx, args, 2)?;
    on_list(cx, args, |list| {
        let at = checked(cx, args.int(1), list.values.len() + 1)?;
        let is_changed = !added.is_empty();
        list.values.splice(at..at, added);
        pay(cx, list)?;
        Ok(Value::Boolean(is_changed))
    })
}

/// `collection.addAll(collection)`
pub(super) fn add_all(cx: &mut Context<'_>, args: &[Value]) -> Result<Value, Trap> {
    let added = elements(cx, args, 1)?;
    add_values(cx, args.at(0), added)
}

pub(super) fn last_index_of(cx: &mut Context<'_>, args: &[Value]) -> Result<Value, Trap> {
    let all = elements(cx, args, 0)?;
    for (i, value) in all.iter().enumerate().rev() {
        if cx.equal(args.at(1), value)? {
            return Ok(Value::Int(i32::try_from(i).unwrap_or(-1)));
        }
    }
    Ok(Value::Int(-1))
}

/// `list.subList(from, to)`: a copy.
pub(super) fn sub_list(cx: &mut Context<'_>, args: &[Value]) -> Result<Value, Trap> {
    let all = elements(cx, args, 0)?;
    let from = checked(cx, args.int(1), all.len() + 1)?;
    let to = checked(cx, args.int(2), all.len() + 1)?;
    if from > to {
        let message = format!("fromIndex({from}) > toIndex({to})");
        let class = crate::library::ClassId::IllegalArgumentException;
        return Err(cx.exception(class, message));
    }
    list_of(cx, all[from..to].to_vec())
}

/// `collection.toArray()`
pub(super) fn to_array(cx: &mut Context<'_>, args: &[Value]) -> Result<Value, Trap> {
    let all = elements(cx, args, 0)?;
    arrays::array_of(cx, all)
}

/// Whether the collection at `args[0]` contains `value`.
fn has(cx: &mut Context<'_>, collection: &Value, value: &Value) -> Result<bool, Trap> {
    let args = [collection.clone(), value.clone()];
    let found = super::collections::contains(cx, &args)?;
    Ok(found.as_boolean() == Some(true))
}

pub(super) fn contains_all(cx: &mut Context<'_>, args: &[Value]) -> Result<Value, Trap> {
    for value in elements(cx, args, 1)? {
        if !has(cx, args.at(0), &value)? {
            return Ok(Value::Boolean(false));
        }
    }
    Ok(Value::Boolean(true))
}

pub(super) fn remove_all(cx: &mut Context<'_>, args: &[Value]) -> Result<Value, Trap> {
    sift(cx, args, false)
}

pub(super) fn retain_all(cx: &mut Context<'_>, args: &[Value]) -> Result<Value, Trap> {
    sift(cx, args, true)
}

/// Keeps the elements that are in another collection (`true`) or are not (`false`).
fn sift(cx: &mut Context<'_>, args: &[Value], keeps_shared: bool) -> Result<Value, Trap> {
    let (mut kept, mut dropped) = (vec![], vec![]);
    for value in elements(cx, args, 0)? {
        if has(cx, args.at(1), &value)? == keeps_shared {
            kept.push(value);
        } else {
            dropped.push(value);
        }
    }
    let is_changed = !dropped.is_empty();
    let is_set = matches!(&*cx.object(args, 0)?.lock(), Data::Set(_));
    if is_set {
        for value in dropped {
            keyed::set_remove(cx, &[args.at(0).clone(), value])?;
        }
    } else {
        on_list(cx, args, |list| {
            list.values = kept;
            Ok(())
        })?;
    }
    Ok(Value::Boolean(is_changed))
}

/// `vector.insertElementAt(value, index)`
pub(super) fn insert_element(cx: &mut Context<'_>, args: &[Value]) -> Result<Value, Trap> {
    let swapped = [args.at(0).clone(), args.at(2).clone(), args.at(1).clone()];
    super::collections::insert(cx, &swapped)
}

/// `vector.setElementAt(value, index)`
pub(super) fn set_element(cx: &mut Context<'_>, args: &[Value]) -> Result<Value, Trap> {
    let swapped = [args.at(0).clone(), args.at(2).clone(), args.at(1).clone()];
    super::collections::set(cx, &swapped)
}

/// `stack.search(value)`
pub(super) fn search(cx: &mut Context<'_>, args: &[Value]) -> Result<Value, Trap> {
    let n = elements(cx, args, 0)?.len();
    let found = last_index_of(cx, args)?.as_int().unwrap_or(-1);
    let place = usize::try_from(found).ok().map(|at| n - at);
    Ok(Value::Int(
        place.and_then(|at| i32::try_from(at).ok()).unwrap_or(-1),
    ))
}
