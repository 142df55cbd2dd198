//! Lists and maps.

use super::{Arguments, Context, keyed, new_object};
use crate::eval::machine::out_of_bounds;
use crate::eval::map::{JavaMap, Order};
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
    JavaMap::new(match class {
        ClassId::LinkedHashMap | ClassId::LinkedHashSet => Order::Inserted,
        ClassId::TreeMap | ClassId::TreeSet => Order::Natural,
        _ => Order::Hashed,
    })
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
    let set = make_map_set(cx, class, &[])?;
    let values = elements(cx, args, 0)?;
    add_values(cx, &set, values)?;
    Ok(set)
}

/// `new HashMap(map)`
pub(super) fn make_map_copy(
    cx: &mut Context<'_>,
    class: ClassId,
    args: &[Value],
) -> Result<Value, Trap> {
    let map = make_map(cx, class, &[])?;
    keyed::put_all(cx, &[map.clone(), args.at(0).clone()])?;
    Ok(map)
}

/// Adds values to a list or a set; whether anything changed.
pub(super) fn add_values(
    cx: &mut Context<'_>,
    to: &Value,
    values: Vec<Value>,
) -> Result<Value, Trap> {
    let mut is_changed = false;
    for value in values {
        let args = [to.clone(), value];
        let is_set = matches!(&*cx.object(&args, 0)?.lock(), Data::Set(_));
        let added = if is_set {
            keyed::set_add(cx, &args)?
        } else {
            add(cx, &args)?
        };
        is_changed |= added.as_boolean() == Some(true);
    }
    Ok(Value::Boolean(is_changed))
}

/// Takes a share of the memory budget when a map has outgrown the one it has.
pub(super) fn pay_map(cx: &Context<'_>, map: &mut JavaMap) -> Result<(), Trap> {
    let needed = ENTRY_BYTES * map.len() as u64;
    if needed > map.charge.bytes() {
        map.charge = cx
            .machine
            .charge(2 * needed)
            .map_err(|trap| trap.at(cx.span))?;
    }
    Ok(())
}

/// The element at an index counted from the end that is asked for; there must be one.
pub(super) fn end(cx: &Context<'_>, values: &[Value], is_last: bool) -> Result<usize, Trap> {
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
pub(super) fn on_list<T: Default>(
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
pub(super) fn pay(cx: &Context<'_>, list: &mut List) -> Result<(), Trap> {
    let needed = ELEMENT_BYTES * list.values.len() as u64;
    if needed > list.charge.bytes() {
        list.charge = cx
            .machine
            .charge(2 * needed)
            .map_err(|trap| trap.at(cx.span))?;
    }
    Ok(())
}

pub(super) fn checked(cx: &Context<'_>, index: i32, n: usize) -> Result<usize, Trap> {
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
    let is_set = matches!(&*cx.object(args, 0)?.lock(), Data::Set(_));
    if is_set {
        return keyed::contains(cx, args);
    }
    Ok(Value::Boolean(index_of_equal(cx, args)?.is_some()))
}

pub(super) fn add(cx: &mut Context<'_>, args: &[Value]) -> Result<Value, Trap> {
    on_list(cx, args, |list| {
        list.values.push(args.at(1).clone());
        pay(cx, list)?;
        Ok(Value::Boolean(true))
    })
}

/// Appends values to a list.
pub(super) fn append(cx: &Context<'_>, args: &[Value], values: &[Value]) -> Result<Value, Trap> {
    on_list(cx, args, |list| {
        list.values.extend_from_slice(values);
        pay(cx, list)?;
        Ok(Value::Null)
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

pub(super) fn index_of_equal(cx: &mut Context<'_>, args: &[Value]) -> Result<Option<usize>, Trap> {
    let wanted = args.at(1);
    for (i, value) in elements(cx, args, 0)?.iter().enumerate() {
        if cx.equal(wanted, value)? {
            return Ok(Some(i));
        }
    }
    Ok(None)
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
pub(super) fn on_map<T: Default>(
    cx: &Context<'_>,
    args: &[Value],
    f: impl FnOnce(&mut JavaMap) -> Result<T, Trap>,
) -> Result<T, Trap> {
    match &mut *cx.object(args, 0)?.lock() {
        Data::Map(map) | Data::Set(map) => f(map),
        _ => Ok(T::default()),
    }
}

pub(super) fn list_of(cx: &Context<'_>, values: Vec<Value>) -> Result<Value, Trap> {
    let mut list = List {
        values,
        ..List::default()
    };
    pay(cx, &mut list)?;
    Ok(new_object(ClassId::ArrayList, Data::List(list)))
}
