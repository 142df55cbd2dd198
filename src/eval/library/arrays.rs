//! The static methods of `Arrays`, and `System.arraycopy`.

use std::cmp::Ordering;
use std::sync::Arc;

use super::{Arguments, Context};
use crate::eval::array::{Array, Elements};
use crate::eval::hooks::natural;
use crate::eval::trap::Trap;
use crate::eval::value::Value;
use crate::library::ClassId;

pub(super) fn array<'v>(
    cx: &Context<'_>,
    args: &'v [Value],
    index: usize,
) -> Result<&'v Arc<Array>, Trap> {
    match args.at(index) {
        Value::Array(array) => Ok(array),
        Value::Null => Err(Trap::null("use an array", cx.span)),
        other => {
            let message = format!("`{other}` is no array");
            Err(cx.exception(ClassId::IllegalArgumentException, message))
        }
    }
}

/// The elements of an array, boxed.
pub(super) fn all(array: &Array) -> Vec<Value> {
    (0..array.len()).filter_map(|i| array.get(i)).collect()
}

/// A new array of the same kind as `like` with these elements; zeros fill it up to `length`.
fn array_like(
    cx: &Context<'_>,
    like: &Array,
    values: Vec<Value>,
    length: usize,
) -> Result<Value, Trap> {
    let charge = cx
        .machine
        .charge(16 * length as u64)
        .map_err(|trap| trap.at(cx.span))?;
    let new = Array::new(like.elements().zeros(length), charge);
    for (i, value) in values.into_iter().enumerate() {
        new.put(i, value);
    }
    Ok(Value::Array(Arc::new(new)))
}

/// An array of references.
pub(super) fn array_of(cx: &Context<'_>, values: Vec<Value>) -> Result<Value, Trap> {
    let length = values.len();
    let like = Array::new(
        Elements::Reference(Box::default()),
        crate::eval::memory::Charge::none(),
    );
    array_like(cx, &like, values, length)
}

/// The part from an index up to another, both checked against the length.
fn part(cx: &Context<'_>, from: i32, to: i32, length: usize) -> Result<(usize, usize), Trap> {
    if from > to {
        let message = format!("fromIndex({from}) > toIndex({to})");
        return Err(cx.exception(ClassId::IllegalArgumentException, message));
    }
    let place = |index: i32| usize::try_from(index).ok().filter(|&i| i <= length);
    place(from).zip(place(to)).ok_or_else(|| {
        let bad = if from < 0 { from } else { to };
        let message = format!("Array index out of range: {bad}");
        cx.exception(ClassId::ArrayIndexOutOfBoundsException, message)
    })
}

/// `Arrays.toString(array)`
pub(super) fn text(cx: &mut Context<'_>, args: &[Value]) -> Result<Value, Trap> {
    if args.at(0).is_null() {
        return cx.new_text("null");
    }
    let mut text = String::from("[");
    for (i, value) in all(array(cx, args, 0)?).iter().enumerate() {
        if i > 0 {
            text.push_str(", ");
        }
        cx.tell(value, &mut text)?;
    }
    text.push(']');
    cx.new_text(text)
}

/// `Arrays.deepToString(array)`; arrays that contain themselves end in `…`.
pub(super) fn deep_text(cx: &mut Context<'_>, args: &[Value]) -> Result<Value, Trap> {
    fn tell(
        cx: &mut Context<'_>,
        value: &Value,
        text: &mut String,
        depth: usize,
    ) -> Result<(), Trap> {
        let Value::Array(array) = value else {
            return cx.tell(value, text);
        };
        if depth > 40 {
            text.push('…');
            return Ok(());
        }
        text.push('[');
        for (i, value) in all(array).iter().enumerate() {
            if i > 0 {
                text.push_str(", ");
            }
            tell(cx, value, text, depth + 1)?;
        }
        text.push(']');
        Ok(())
    }
    let mut text = String::new();
    tell(cx, args.at(0), &mut text, 0)?;
    cx.new_text(text)
}

/// `Arrays.sort(array)`, `Arrays.sort(array, comparator)`
pub(super) fn sort(cx: &mut Context<'_>, args: &[Value]) -> Result<Value, Trap> {
    let array = array(cx, args, 0)?;
    sort_part(cx, array, (0, array.len()), args.at(1))
}

/// `Arrays.sort(array, from, to)`
pub(super) fn sort_range(cx: &mut Context<'_>, args: &[Value]) -> Result<Value, Trap> {
    let array = array(cx, args, 0)?;
    let bounds = part(cx, args.int(1), args.int(2), array.len())?;
    sort_part(cx, array, bounds, &Value::Null)
}

fn sort_part(
    cx: &mut Context<'_>,
    array: &Array,
    (from, to): (usize, usize),
    comparator: &Value,
) -> Result<Value, Trap> {
    let values = (from..to).filter_map(|i| array.get(i)).collect();
    let sorted = cx.program.sorted(cx.machine, values, comparator, cx.span)?;
    for (i, value) in sorted.into_iter().enumerate() {
        array.put(from + i, value);
    }
    Ok(Value::Null)
}

/// `Arrays.fill(array, value)`
pub(super) fn fill(cx: &mut Context<'_>, args: &[Value]) -> Result<Value, Trap> {
    let array = array(cx, args, 0)?;
    for i in 0..array.len() {
        array.put(i, args.at(1).clone());
    }
    Ok(Value::Null)
}

/// `Arrays.fill(array, from, to, value)`
pub(super) fn fill_range(cx: &mut Context<'_>, args: &[Value]) -> Result<Value, Trap> {
    let array = array(cx, args, 0)?;
    let (from, to) = part(cx, args.int(1), args.int(2), array.len())?;
    for i in from..to {
        array.put(i, args.at(3).clone());
    }
    Ok(Value::Null)
}

/// `Arrays.asList(values)`
pub(super) fn as_list(cx: &mut Context<'_>, args: &[Value]) -> Result<Value, Trap> {
    let values = all(array(cx, args, 0)?);
    super::collections::list_of(cx, values)
}

/// `array.clone()`
pub(super) fn copy(cx: &mut Context<'_>, args: &[Value]) -> Result<Value, Trap> {
    let array = array(cx, args, 0)?;
    array_like(cx, array, all(array), array.len())
}

/// `Arrays.copyOf(array, length)`
pub(super) fn copy_of(cx: &mut Context<'_>, args: &[Value]) -> Result<Value, Trap> {
    let array = array(cx, args, 0)?;
    let Ok(length) = usize::try_from(args.int(1)) else {
        let message = args.int(1).to_string();
        return Err(cx.exception(ClassId::NegativeArraySizeException, message));
    };
    let values = (0..array.len().min(length)).filter_map(|i| array.get(i));
    array_like(cx, array, values.collect(), length)
}

/// `Arrays.copyOfRange(array, from, to)`
pub(super) fn copy_of_range(cx: &mut Context<'_>, args: &[Value]) -> Result<Value, Trap> {
    let array = array(cx, args, 0)?;
    let (from, to) = (args.int(1), args.int(2));
    let start = usize::try_from(from).ok().filter(|&i| i <= array.len());
    let (Some(start), true) = (start, from <= to) else {
        let message = if from > to {
            format!("{from} > {to}")
        } else {
            format!("Array index out of range: {from}")
        };
        let class = if from > to {
            ClassId::IllegalArgumentException
        } else {
            ClassId::ArrayIndexOutOfBoundsException
        };
        return Err(cx.exception(class, message));
    };
    let length = usize::try_from(to.wrapping_sub(from)).unwrap_or(0);
    let values = (start..array.len().min(start + length)).filter_map(|i| array.get(i));
    array_like(cx, array, values.collect(), length)
}

/// `Arrays.equals(a, b)`
pub(super) fn equal(cx: &mut Context<'_>, args: &[Value]) -> Result<Value, Trap> {
    if args.at(0).is_null() || args.at(1).is_null() {
        return Ok(Value::Boolean(args.at(0).is_null() && args.at(1).is_null()));
    }
    let (a, b) = (all(array(cx, args, 0)?), all(array(cx, args, 1)?));
    let mut is_equal = a.len() == b.len();
    for (a, b) in a.iter().zip(&b) {
        is_equal = is_equal && cx.equal(a, b)?;
    }
    Ok(Value::Boolean(is_equal))
}

/// `Arrays.hashCode(array)`
pub(super) fn hash_code(cx: &mut Context<'_>, args: &[Value]) -> Result<Value, Trap> {
    if args.at(0).is_null() {
        return Ok(Value::Int(0));
    }
    let mut hash = 1_i32;
    for value in all(array(cx, args, 0)?) {
        let own = cx.program.hash(cx.machine, &value, cx.span)?;
        hash = hash.wrapping_mul(31).wrapping_add(own);
    }
    Ok(Value::Int(hash))
}

/// `Arrays.binarySearch(array, value)`
pub(super) fn binary_search(cx: &mut Context<'_>, args: &[Value]) -> Result<Value, Trap> {
    let values = all(array(cx, args, 0)?);
    let order = |value: &Value| natural(value, args.at(1)).unwrap_or(Ordering::Less);
    let found = values.binary_search_by(order);
    let place = |i: usize| i32::try_from(i).unwrap_or(i32::MAX - 1);
    Ok(Value::Int(match found {
        Ok(i) => place(i),
        Err(i) => -place(i) - 1,
    }))
}

/// `System.arraycopy(from, at, to, at, n)`; the arrays may be the same.
pub(super) fn copy_elements(cx: &mut Context<'_>, args: &[Value]) -> Result<Value, Trap> {
    let (from, to) = (array(cx, args, 0)?, array(cx, args, 2)?);
    if std::mem::discriminant(from.elements()) != std::mem::discriminant(to.elements()) {
        let message = "arraycopy: the arrays hold different types";
        return Err(cx.exception(ClassId::ArrayStoreException, message));
    }
    let range = |at: i32, length: usize| {
        let at = usize::try_from(at).ok()?;
        let n = usize::try_from(args.int(4)).ok()?;
        (at.checked_add(n)? <= length).then_some(at..at + n)
    };
    let (source, target) = (range(args.int(1), from.len()), range(args.int(3), to.len()));
    let (Some(source), Some(target)) = (source, target) else {
        let message = format!(
            "arraycopy: {} elements from {} of {} to {} of {}",
            args.int(4),
            args.int(1),
            from.len(),
            args.int(3),
            to.len()
        );
        return Err(cx.exception(ClassId::ArrayIndexOutOfBoundsException, message));
    };
    let values: Vec<Value> = source.filter_map(|i| from.get(i)).collect();
    for (i, value) in target.zip(values) {
        to.put(i, value);
    }
    Ok(Value::Null)
}
