//! Lists and maps.

use super::{Arguments, Context, new_object};
use crate::eval::machine::out_of_bounds;
use crate::eval::map::JavaMap;
use crate::eval::object::{Data, List};
use crate::eval::trap::Trap;
use crate::eval::value::Value;
use crate::library::ClassId;

/// What an element of a list, and an entry of a map, is counted as in the memory budget, in bytes.
const ELEMENT_BYTES: u64 = 32;
const ENTRY_BYTES: u64 = 128;

pub(super) fn make_list(_: &mut Context<'_>, class: ClassId, _: &[Value]) -> Result<Value, Trap> {
    Ok(new_object(class, Data::List(List::default())))
}

pub(super) fn make_list_copy(
    cx: &mut Context<'_>,
    class: ClassId,
    args: &[Value],
) -> Result<Value, Trap> {
    let mut list = List {
        values: elements(cx, args, 0)?,
        ..List::default()
    };
    pay(cx, &mut list)?;
    Ok(new_object(class, Data::List(list)))
}

pub(super) fn make_map(_: &mut Context<'_>, class: ClassId, _: &[Value]) -> Result<Value, Trap> {
    Ok(new_object(class, Data::Map(Box::new(map_of(class)))))
}

fn map_of(class: ClassId) -> JavaMap {
    let keeps_order = matches!(class, ClassId::LinkedHashMap | ClassId::LinkedHashSet);
    JavaMap::new(keeps_order)
}

/// `new HashSet()`
pub(super) fn make_map_set(
    _: &mut Context<'_>,
    class: ClassId,
    _: &[Value],
) -> Result<Value, Trap> {
    Ok(new_object(class, Data::Set(Box::new(map_of(class)))))
}

/// `new HashSet(collection)`
pub(super) fn make_set_copy(
    cx: &mut Context<'_>,
    class: ClassId,
    args: &[Value],
) -> Result<Value, Trap> {
    let mut map = map_of(class);
    for value in elements(cx, args, 0)? {
        map.insert(value, Value::Boolean(true));
    }
    pay_map(cx, &mut map)?;
    Ok(new_object(class, Data::Set(Box::new(map))))
}

/// Takes a share of the memory budget when a map has outgrown the one it has.
fn pay_map(cx: &Context<'_>, map: &mut JavaMap) -> Result<(), Trap> {
    let needed = ENTRY_BYTES * map.len() as u64;
    if needed > map.charge.bytes() {
        map.charge = cx
            .machine
            .charge(2 * needed)
            .map_err(|trap| trap.at(cx.span))?;
    }
    Ok(())
}

pub(super) fn set_add(cx: &mut Context<'_>, args: &[Value]) -> Result<Value, Trap> {
    on_map(cx, args, |map| {
        let is_new = map.get(args.at(1)).is_none();
        if is_new {
            map.insert(args.at(1).clone(), Value::Boolean(true));
            pay_map(cx, map)?;
        }
        Ok(Value::Boolean(is_new))
    })
}

pub(super) fn set_remove(cx: &mut Context<'_>, args: &[Value]) -> Result<Value, Trap> {
    on_map(cx, args, |map| {
        Ok(Value::Boolean(map.remove(args.at(1)).is_some()))
    })
}

pub(super) fn contains_value(cx: &mut Context<'_>, args: &[Value]) -> Result<Value, Trap> {
    on_map(cx, args, |map| {
        let is_there = map
            .entries()
            .iter()
            .any(|(_, value)| value.equals(args.at(1)));
        Ok(Value::Boolean(is_there))
    })
}

pub(super) fn get_or_default(cx: &mut Context<'_>, args: &[Value]) -> Result<Value, Trap> {
    on_map(cx, args, |map| {
        Ok(map.get(args.at(1)).unwrap_or(args.at(2)).clone())
    })
}

/// The element at an index counted from the end that is asked for; there must be one.
fn end(cx: &Context<'_>, values: &[Value], is_last: bool) -> Result<usize, Trap> {
    if values.is_empty() {
        return Err(cx.exception(ClassId::NoSuchElementException, "the list is empty"));
    }
    Ok(if is_last { values.len() - 1 } else { 0 })
}

pub(super) fn first(cx: &mut Context<'_>, args: &[Value]) -> Result<Value, Trap> {
    on_list(cx, args, |list| {
        Ok(list.values[end(cx, &list.values, false)?].clone())
    })
}

pub(super) fn last(cx: &mut Context<'_>, args: &[Value]) -> Result<Value, Trap> {
    on_list(cx, args, |list| {
        Ok(list.values[end(cx, &list.values, true)?].clone())
    })
}

pub(super) fn remove_first(cx: &mut Context<'_>, args: &[Value]) -> Result<Value, Trap> {
    on_list(cx, args, |list| {
        let at = end(cx, &list.values, false)?;
        Ok(list.values.remove(at))
    })
}

pub(super) fn remove_last(cx: &mut Context<'_>, args: &[Value]) -> Result<Value, Trap> {
    on_list(cx, args, |list| {
        let at = end(cx, &list.values, true)?;
        Ok(list.values.remove(at))
    })
}

pub(super) fn add_first(cx: &mut Context<'_>, args: &[Value]) -> Result<Value, Trap> {
    on_list(cx, args, |list| {
        list.values.insert(0, args.at(1).clone());
        pay(cx, list)?;
        Ok(Value::Null)
    })
}

pub(super) fn push(cx: &mut Context<'_>, args: &[Value]) -> Result<Value, Trap> {
    add(cx, args)?;
    Ok(args.at(1).clone())
}

/// A copy of the elements of the collection at `index`.
pub(super) fn elements(cx: &Context<'_>, args: &[Value], index: usize) -> Result<Vec<Value>, Trap> {
    Ok(match &*cx.object(args, index)?.lock() {
        Data::List(list) => list.values.clone(),
        Data::Map(map) | Data::Set(map) => {
            let entries = map.entries();
            entries.into_iter().map(|(key, _)| key.clone()).collect()
        }
        _ => vec![],
    })
}

/// Works on the elements of the list that is the receiver.
fn on_list<T: Default>(
    cx: &Context<'_>,
    args: &[Value],
    f: impl FnOnce(&mut List) -> Result<T, Trap>,
) -> Result<T, Trap> {
    match &mut *cx.object(args, 0)?.lock() {
        Data::List(list) => f(list),
        _ => Ok(T::default()),
    }
}

/// Takes a share of the memory budget when a list has outgrown the one it has; it then has room to double.
fn pay(cx: &Context<'_>, list: &mut List) -> Result<(), Trap> {
    let needed = ELEMENT_BYTES * list.values.len() as u64;
    if needed > list.charge.bytes() {
        list.charge = cx
            .machine
            .charge(2 * needed)
            .map_err(|trap| trap.at(cx.span))?;
    }
    Ok(())
}

fn checked(cx: &Context<'_>, index: i32, n: usize) -> Result<usize, Trap> {
    let place = usize::try_from(index).ok().filter(|&i| i < n);
    place.ok_or_else(|| {
        out_of_bounds(
            ClassId::IndexOutOfBoundsException,
            i64::from(index),
            n,
            cx.span,
        )
    })
}

pub(super) fn size(cx: &mut Context<'_>, args: &[Value]) -> Result<Value, Trap> {
    let n = match &*cx.object(args, 0)?.lock() {
        Data::List(list) => list.values.len(),
        Data::Set(map) => map.len(),
        _ => 0,
    };
    Ok(Value::Int(i32::try_from(n).unwrap_or(i32::MAX)))
}

pub(super) fn is_empty(cx: &mut Context<'_>, args: &[Value]) -> Result<Value, Trap> {
    let n = size(cx, args)?;
    Ok(Value::Boolean(n.as_int() == Some(0)))
}

pub(super) fn contains(cx: &mut Context<'_>, args: &[Value]) -> Result<Value, Trap> {
    let wanted = args.at(1);
    if let Data::Set(map) = &*cx.object(args, 0)?.lock() {
        return Ok(Value::Boolean(map.get(wanted).is_some()));
    }
    Ok(Value::Boolean(
        elements(cx, args, 0)?.iter().any(|v| v.equals(wanted)),
    ))
}

pub(super) fn add(cx: &mut Context<'_>, args: &[Value]) -> Result<Value, Trap> {
    on_list(cx, args, |list| {
        list.values.push(args.at(1).clone());
        pay(cx, list)?;
        Ok(Value::Boolean(true))
    })
}

pub(super) fn insert(cx: &mut Context<'_>, args: &[Value]) -> Result<Value, Trap> {
    on_list(cx, args, |list| {
        let place = checked(cx, args.int(1), list.values.len() + 1)?;
        list.values.insert(place, args.at(2).clone());
        pay(cx, list)?;
        Ok(Value::Null)
    })
}

pub(super) fn add_all(cx: &mut Context<'_>, args: &[Value]) -> Result<Value, Trap> {
    let added = elements(cx, args, 1)?;
    on_list(cx, args, |list| {
        let is_changed = !added.is_empty();
        list.values.extend(added);
        pay(cx, list)?;
        Ok(Value::Boolean(is_changed))
    })
}

pub(super) fn get(cx: &mut Context<'_>, args: &[Value]) -> Result<Value, Trap> {
    on_list(cx, args, |list| {
        let place = checked(cx, args.int(1), list.values.len())?;
        Ok(list.values[place].clone())
    })
}

pub(super) fn set(cx: &mut Context<'_>, args: &[Value]) -> Result<Value, Trap> {
    on_list(cx, args, |list| {
        let place = checked(cx, args.int(1), list.values.len())?;
        Ok(std::mem::replace(
            &mut list.values[place],
            args.at(2).clone(),
        ))
    })
}

pub(super) fn remove_at(cx: &mut Context<'_>, args: &[Value]) -> Result<Value, Trap> {
    on_list(cx, args, |list| {
        let place = checked(cx, args.int(1), list.values.len())?;
        Ok(list.values.remove(place))
    })
}

fn index_of_equal(cx: &Context<'_>, args: &[Value]) -> Result<Option<usize>, Trap> {
    let wanted = args.at(1);
    Ok(elements(cx, args, 0)?.iter().position(|v| v.equals(wanted)))
}

pub(super) fn remove(cx: &mut Context<'_>, args: &[Value]) -> Result<Value, Trap> {
    let found = index_of_equal(cx, args)?;
    on_list(cx, args, |list| {
        if let Some(place) = found {
            list.values.remove(place);
        }
        Ok(Value::Boolean(found.is_some()))
    })
}

pub(super) fn index_of(cx: &mut Context<'_>, args: &[Value]) -> Result<Value, Trap> {
    let found = index_of_equal(cx, args)?;
    Ok(Value::Int(
        found.and_then(|i| i32::try_from(i).ok()).unwrap_or(-1),
    ))
}

pub(super) fn clear(cx: &mut Context<'_>, args: &[Value]) -> Result<Value, Trap> {
    let old = on_list(cx, args, |list| Ok(std::mem::take(list)))?;
    drop(old);
    Ok(Value::Null)
}

/// Works on the map that is the receiver.
fn on_map<T: Default>(
    cx: &Context<'_>,
    args: &[Value],
    f: impl FnOnce(&mut JavaMap) -> Result<T, Trap>,
) -> Result<T, Trap> {
    match &mut *cx.object(args, 0)?.lock() {
        Data::Map(map) | Data::Set(map) => f(map),
        _ => Ok(T::default()),
    }
}

pub(super) fn put(cx: &mut Context<'_>, args: &[Value]) -> Result<Value, Trap> {
    on_map(cx, args, |map| {
        let old = map.insert(args.at(1).clone(), args.at(2).clone());
        pay_map(cx, map)?;
        Ok(old.unwrap_or_default())
    })
}

pub(super) fn get_key(cx: &mut Context<'_>, args: &[Value]) -> Result<Value, Trap> {
    on_map(cx, args, |map| {
        Ok(map.get(args.at(1)).cloned().unwrap_or_default())
    })
}

pub(super) fn contains_key(cx: &mut Context<'_>, args: &[Value]) -> Result<Value, Trap> {
    on_map(cx, args, |map| {
        Ok(Value::Boolean(map.get(args.at(1)).is_some()))
    })
}

pub(super) fn remove_key(cx: &mut Context<'_>, args: &[Value]) -> Result<Value, Trap> {
    on_map(cx, args, |map| {
        Ok(map.remove(args.at(1)).unwrap_or_default())
    })
}

pub(super) fn map_size(cx: &mut Context<'_>, args: &[Value]) -> Result<Value, Trap> {
    on_map(cx, args, |map| {
        Ok(Value::Int(i32::try_from(map.len()).unwrap_or(i32::MAX)))
    })
}

pub(super) fn map_is_empty(cx: &mut Context<'_>, args: &[Value]) -> Result<Value, Trap> {
    on_map(cx, args, |map| Ok(Value::Boolean(map.is_empty())))
}

pub(super) fn map_clear(cx: &mut Context<'_>, args: &[Value]) -> Result<Value, Trap> {
    let old = on_map(cx, args, |map| {
        let empty = JavaMap::new(map.keeps_order());
        Ok(std::mem::replace(map, empty))
    })?;
    drop(old);
    Ok(Value::Null)
}

pub(super) fn key_set(cx: &mut Context<'_>, args: &[Value]) -> Result<Value, Trap> {
    let keys = on_map(cx, args, |map| {
        Ok(map
            .entries()
            .into_iter()
            .map(|(key, _)| key.clone())
            .collect())
    })?;
    list_of(cx, keys)
}

pub(super) fn map_values(cx: &mut Context<'_>, args: &[Value]) -> Result<Value, Trap> {
    let values = on_map(cx, args, |map| {
        Ok(map
            .entries()
            .into_iter()
            .map(|(_, value)| value.clone())
            .collect())
    })?;
    list_of(cx, values)
}

pub(super) fn list_of(cx: &Context<'_>, values: Vec<Value>) -> Result<Value, Trap> {
    let mut list = List {
        values,
        ..List::default()
    };
    pay(cx, &mut list)?;
    Ok(new_object(ClassId::ArrayList, Data::List(list)))
}
