//! Iterators and tokens.

use super::{Arguments, Context, new_object};
use crate::eval::memory::Charge;
use crate::eval::object::{Data, Object};
use crate::eval::trap::Trap;
use crate::eval::value::Value;
use crate::library::ClassId;
use std::sync::Arc;

/// Texts that come one after the other.
#[derive(Clone, Debug)]
pub struct Tokens {
    rest: std::collections::VecDeque<Value>,
    /// What an iterator goes through, and what it gave last.
    source: Option<Arc<Object>>,
    last: Option<Value>,
    /// Place of the next element in a list, less what was removed.
    place: usize,
    _charge: Charge,
}

/// `new StringTokenizer(text, separators)`.
pub(super) fn make_tokens(
    cx: &mut Context<'_>,
    class: ClassId,
    args: &[Value],
) -> Result<Value, Trap> {
    let separators = if args.len() > 1 {
        args.text(1)
    } else {
        " \t\n\r\u{c}"
    };
    let words: Vec<&str> = args
        .text(0)
        .split(|c| separators.contains(c))
        .filter(|word| !word.is_empty())
        .collect();
    let charge = cx
        .machine
        .charge(64 * words.len() as u64)
        .map_err(|trap| trap.at(cx.span))?;
    let tokens = Tokens {
        rest: words.into_iter().map(Value::text).collect(),
        source: None,
        last: None,
        place: 0,
        _charge: charge,
    };
    Ok(new_object(class, Data::Tokens(Box::new(tokens))))
}

/// `collection.iterator()`: goes through the elements that are there now.
pub(super) fn iterator(cx: &mut Context<'_>, args: &[Value]) -> Result<Value, Trap> {
    let values = super::collections::elements(cx, args, 0)?;
    let charge = cx
        .machine
        .charge(32 * values.len() as u64)
        .map_err(|trap| trap.at(cx.span))?;
    let tokens = Tokens {
        rest: values.into(),
        source: Some(Arc::clone(cx.object(args, 0)?)),
        last: None,
        place: 0,
        _charge: charge,
    };
    Ok(new_object(
        ClassId::Iterator,
        Data::Tokens(Box::new(tokens)),
    ))
}

fn left(cx: &Context<'_>, args: &[Value]) -> Result<usize, Trap> {
    Ok(match &*cx.object(args, 0)?.lock() {
        Data::Tokens(tokens) => tokens.rest.len(),
        _ => 0,
    })
}

pub(super) fn has_next(cx: &mut Context<'_>, args: &[Value]) -> Result<Value, Trap> {
    Ok(Value::Boolean(left(cx, args)? > 0))
}

pub(super) fn count_tokens(cx: &mut Context<'_>, args: &[Value]) -> Result<Value, Trap> {
    Ok(Value::Int(left(cx, args)? as i32))
}

pub(super) fn next(cx: &mut Context<'_>, args: &[Value]) -> Result<Value, Trap> {
    let found = match &mut *cx.object(args, 0)?.lock() {
        Data::Tokens(tokens) => {
            tokens.last = tokens.rest.pop_front();
            tokens.place += 1;
            tokens.last.clone()
        }
        _ => None,
    };
    found.ok_or_else(|| cx.exception(ClassId::NoSuchElementException, "there is no next one"))
}

/// `iterator.remove()`: takes what `next` gave out of the collection.
pub(super) fn remove(cx: &mut Context<'_>, args: &[Value]) -> Result<Value, Trap> {
    let (last, source, place) = match &mut *cx.object(args, 0)?.lock() {
        Data::Tokens(tokens) => (tokens.last.take(), tokens.source.clone(), tokens.place),
        _ => (None, None, 0),
    };
    let (Some(last), Some(source)) = (last, source) else {
        let message = "`next` must come before `remove`";
        return Err(cx.exception(ClassId::IllegalStateException, message));
    };
    if source.class == ClassId::Set && matches!(&*source.lock(), Data::List(_)) {
        let message = "entries of a map cannot be removed through an iterator: collect the keys and call `map.remove(key)`";
        return Err(cx.exception(ClassId::UnsupportedOperationException, message));
    }
    let removed = match &mut *source.lock() {
        Data::List(list) if place <= list.values.len() => Some(list.values.remove(place - 1)),
        _ => None,
    };
    if removed.is_none() {
        super::keyed::set_remove(cx, &[Value::Object(source), last])?;
    } else if let Data::Tokens(tokens) = &mut *cx.object(args, 0)?.lock() {
        tokens.place -= 1;
    }
    Ok(Value::Null)
}
