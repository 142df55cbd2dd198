//! `FloatList` and `IntList`: numbers in order, which meshes are made of.

use super::{Arguments, Context, collections, new_object};
use crate::eval::object::{Data, List};
use crate::eval::trap::Trap;
use crate::eval::value::Value;
use crate::library::ClassId;

/// `new FloatList(array)`, `new IntList(array)`
pub(super) fn make_list_of(
    cx: &mut Context<'_>,
    class: ClassId,
    args: &[Value],
) -> Result<Value, Trap> {
    let mut list = List {
        values: elements(cx, args, 0)?,
        ..List::default()
    };
    collections::pay(cx, &mut list)?;
    Ok(new_object(class, Data::List(list)))
}

/// `list.push(x, y, z)`
pub(super) fn push_three(cx: &mut Context<'_>, args: &[Value]) -> Result<Value, Trap> {
    collections::append(cx, args, args.get(1..).unwrap_or_default())
}

/// `list.addAll(array, begin, n)`
pub(super) fn add_part(cx: &mut Context<'_>, args: &[Value]) -> Result<Value, Trap> {
    let values = elements(cx, args, 1)?;
    let (begin, n) = (args.int(2), args.int(3));
    let end = i64::from(begin) + i64::from(n);
    let part = usize::try_from(begin).ok().zip(usize::try_from(end).ok());
    match part.and_then(|(begin, end)| values.get(begin..end)) {
        Some(part) => collections::append(cx, args, part),
        None => {
            let message = format!("{n} numbers from {begin} on, of {}", values.len());
            Err(cx.exception(ClassId::ArrayIndexOutOfBoundsException, message))
        }
    }
}

/// The elements of an array or a list.
pub(super) fn elements(cx: &Context<'_>, args: &[Value], index: usize) -> Result<Vec<Value>, Trap> {
    match args.at(index) {
        Value::Array(array) => Ok((0..array.len()).filter_map(|i| array.get(i)).collect()),
        _ => match &*cx.object(args, index)?.lock() {
            Data::List(list) => Ok(list.values.clone()),
            _ => Ok(vec![]),
        },
    }
}
