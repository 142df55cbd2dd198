//! Sets, iterators, tokens, and the static methods of `Arrays` and `Collections`.

use std::cmp::Ordering;
use std::sync::Arc;

use super::{Arguments, Context, new_object};
use crate::eval::array::Array;
use crate::eval::memory::Charge;
use crate::eval::object::{Data, List};
use crate::eval::trap::Trap;
use crate::eval::value::Value;
use crate::library::ClassId;

/// Texts that come one after the other.
#[derive(Clone, Debug)]
pub struct Tokens {
    rest: std::collections::VecDeque<Value>,
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
        Data::Tokens(tokens) => tokens.rest.pop_front(),
        _ => None,
    };
    found.ok_or_else(|| cx.exception(ClassId::NoSuchElementException, "there is no next one"))
}

/// Java's natural order of numbers and texts; others stay as they are.
fn natural(a: &Value, b: &Value) -> Ordering {
    match (a.as_text(), b.as_text()) {
        (Some(a), Some(b)) => a.as_str().encode_utf16().cmp(b.as_str().encode_utf16()),
        _ => match (a.as_long(), b.as_long(), a.as_double(), b.as_double()) {
            (Some(x), Some(y), ..) if is_whole(a) && is_whole(b) => x.cmp(&y),
            (.., Some(x), Some(y)) => x.total_cmp(&y),
            _ => Ordering::Equal,
        },
    }
}

fn is_whole(value: &Value) -> bool {
    !matches!(value, Value::Float(_) | Value::Double(_))
}

fn array<'v>(cx: &Context<'_>, args: &'v [Value], index: usize) -> Result<&'v Arc<Array>, Trap> {
    args.at(index)
        .as_array()
        .ok_or_else(|| Trap::null("use an array", cx.span))
}

fn all(array: &Array) -> Vec<Value> {
    (0..array.len()).filter_map(|i| array.get(i)).collect()
}

/// `Arrays.toString(array)`.
pub(super) fn array_text(cx: &mut Context<'_>, args: &[Value]) -> Result<Value, Trap> {
    if args.at(0).is_null() {
        return cx.new_text("null");
    }
    let mut text = String::from("[");
    for (i, value) in all(array(cx, args, 0)?).iter().enumerate() {
        if i > 0 {
            text.push_str(", ");
        }
        cx.machine.append_text(value, &mut text);
        cx.machine
            .check_text(text.len())
            .map_err(|t| t.at(cx.span))?;
    }
    text.push(']');
    cx.new_text(text)
}

/// `Arrays.sort(array)`.
pub(super) fn sort_array(cx: &mut Context<'_>, args: &[Value]) -> Result<Value, Trap> {
    let array = array(cx, args, 0)?;
    let mut values = all(array);
    values.sort_by(natural);
    for (i, value) in values.into_iter().enumerate() {
        array.put(i, value);
    }
    Ok(Value::Null)
}

/// `Arrays.fill(array, value)`.
pub(super) fn fill_array(cx: &mut Context<'_>, args: &[Value]) -> Result<Value, Trap> {
    let array = array(cx, args, 0)?;
    for i in 0..array.len() {
        array.put(i, args.at(1).clone());
    }
    Ok(Value::Null)
}

/// `Arrays.asList(array)`.
pub(super) fn as_list(cx: &mut Context<'_>, args: &[Value]) -> Result<Value, Trap> {
    let values = all(array(cx, args, 0)?);
    super::collections::list_of(cx, values)
}

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

pub(super) fn sort(cx: &mut Context<'_>, args: &[Value]) -> Result<Value, Trap> {
    on_values(cx, args, |values| values.sort_by(natural))
}

pub(super) fn reverse(cx: &mut Context<'_>, args: &[Value]) -> Result<Value, Trap> {
    on_values(cx, args, |values| values.reverse())
}

/// `Collections.shuffle(list)`, by the generator of the model.
pub(super) fn shuffle(cx: &mut Context<'_>, args: &[Value]) -> Result<Value, Trap> {
    let list = Arc::clone(cx.object(args, 0)?);
    if let Data::List(List { values, .. }) = &mut *list.lock() {
        for i in (1..values.len()).rev() {
            let bound = i32::try_from(i + 1).unwrap_or(i32::MAX);
            let j = cx.machine.random.next_int_below(bound).unwrap_or(0);
            values.swap(i, usize::try_from(j).unwrap_or(0));
        }
    }
    Ok(Value::Null)
}

fn extreme(cx: &Context<'_>, args: &[Value], wanted: Ordering) -> Result<Value, Trap> {
    let values = super::collections::elements(cx, args, 0)?;
    let best = values
        .into_iter()
        .reduce(|a, b| if natural(&b, &a) == wanted { b } else { a });
    best.ok_or_else(|| cx.exception(ClassId::NoSuchElementException, "the collection is empty"))
}

pub(super) fn least(cx: &mut Context<'_>, args: &[Value]) -> Result<Value, Trap> {
    extreme(cx, args, Ordering::Less)
}

pub(super) fn greatest(cx: &mut Context<'_>, args: &[Value]) -> Result<Value, Trap> {
    extreme(cx, args, Ordering::Greater)
}
