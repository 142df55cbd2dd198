//! Maps and sets: what is found by a key.
//!
//! Keys whose class has its own `equals` or `hashCode` are found by them: those run while the map is not locked, and the map
//! is asked for all keys of the same hash code first.

use super::collections::{list_of, on_map, pay_map};
use super::{Arguments, Context, new_object};
use crate::eval::map::JavaMap;
use crate::eval::object::{Data, List};
use crate::eval::trap::Trap;
use crate::eval::value::Value;
use crate::library::ClassId;
use std::sync::Arc;

/// The key under which a map holds what is equal to `key`, and its hash code; the key itself if there is none.
fn known_key(cx: &mut Context<'_>, args: &[Value]) -> Result<(Value, i32), Trap> {
    let key = args.at(1);
    if !cx.program.has_own_keys(cx.machine, key) {
        return Ok((key.clone(), key.hash_code()));
    }
    let hash = cx.program.hash(cx.machine, key, cx.span)?;
    let like = on_map(cx, args, |map| Ok(map.keys_of(hash)))?;
    for known in like {
        if cx.equal(key, &known)? {
            return Ok((known, hash));
        }
    }
    Ok((key.clone(), hash))
}

pub(super) fn set_add(cx: &mut Context<'_>, args: &[Value]) -> Result<Value, Trap> {
    let (key, hash) = known_key(cx, args)?;
    on_map(cx, args, |map| {
        let is_new = map.get(&key, hash).is_none();
        if is_new {
            map.insert(key, hash, Value::Boolean(true));
            pay_map(cx, map)?;
        }
        Ok(Value::Boolean(is_new))
    })
}

pub(super) fn set_remove(cx: &mut Context<'_>, args: &[Value]) -> Result<Value, Trap> {
    let (key, hash) = known_key(cx, args)?;
    on_map(cx, args, |map| {
        Ok(Value::Boolean(map.remove(&key, hash).is_some()))
    })
}

/// `map.containsKey(key)`, `set.contains(value)`
pub(super) fn contains(cx: &mut Context<'_>, args: &[Value]) -> Result<Value, Trap> {
    let (key, hash) = known_key(cx, args)?;
    on_map(cx, args, |map| {
        Ok(Value::Boolean(map.get(&key, hash).is_some()))
    })
}

pub(super) fn get(cx: &mut Context<'_>, args: &[Value]) -> Result<Value, Trap> {
    let (key, hash) = known_key(cx, args)?;
    on_map(cx, args, |map| {
        Ok(map.get(&key, hash).cloned().unwrap_or_default())
    })
}

pub(super) fn get_or_default(cx: &mut Context<'_>, args: &[Value]) -> Result<Value, Trap> {
    let (key, hash) = known_key(cx, args)?;
    on_map(cx, args, |map| {
        Ok(map.get(&key, hash).unwrap_or(args.at(2)).clone())
    })
}

pub(super) fn put(cx: &mut Context<'_>, args: &[Value]) -> Result<Value, Trap> {
    let (key, hash) = known_key(cx, args)?;
    on_map(cx, args, |map| {
        let old = map.insert(key, hash, args.at(2).clone());
        pay_map(cx, map)?;
        Ok(old.unwrap_or_default())
    })
}

pub(super) fn put_if_absent(cx: &mut Context<'_>, args: &[Value]) -> Result<Value, Trap> {
    let known = get(cx, args)?;
    if known.is_null() {
        put(cx, args)?;
    }
    Ok(known)
}

/// Keys and values of the map at `index`.
fn entries(cx: &Context<'_>, args: &[Value], index: usize) -> Result<Vec<(Value, Value)>, Trap> {
    Ok(match &*cx.object(args, index)?.lock() {
        Data::Map(map) => map.entries().into_iter().cloned().collect(),
        _ => vec![],
    })
}

pub(super) fn put_all(cx: &mut Context<'_>, args: &[Value]) -> Result<Value, Trap> {
    for (key, value) in entries(cx, args, 1)? {
        put(cx, &[args.at(0).clone(), key, value])?;
    }
    Ok(Value::Null)
}

pub(super) fn remove(cx: &mut Context<'_>, args: &[Value]) -> Result<Value, Trap> {
    let (key, hash) = known_key(cx, args)?;
    on_map(cx, args, |map| {
        Ok(map.remove(&key, hash).unwrap_or_default())
    })
}

/// `map.entrySet()`: the entries that are there now; `setValue` of one changes the map.
pub(super) fn entry_set(cx: &mut Context<'_>, args: &[Value]) -> Result<Value, Trap> {
    let map = cx.object(args, 0)?;
    let made = |entry| {
        new_object(
            ClassId::Entry,
            Data::Entry(Box::new(entry), Arc::clone(map)),
        )
    };
    let found = entries(cx, args, 0)?.into_iter().map(made).collect();
    view_of(cx, found)
}

/// Key (`false`) or value (`true`) of an entry.
fn half(cx: &Context<'_>, args: &[Value], is_value: bool) -> Result<Value, Trap> {
    Ok(match &*cx.object(args, 0)?.lock() {
        Data::Entry(entry, _) if is_value => entry.1.clone(),
        Data::Entry(entry, _) => entry.0.clone(),
        _ => Value::Null,
    })
}

pub(super) fn entry_key(cx: &mut Context<'_>, args: &[Value]) -> Result<Value, Trap> {
    half(cx, args, false)
}

pub(super) fn entry_value(cx: &mut Context<'_>, args: &[Value]) -> Result<Value, Trap> {
    half(cx, args, true)
}

pub(super) fn entry_set_value(cx: &mut Context<'_>, args: &[Value]) -> Result<Value, Trap> {
    let new = args.at(1).clone();
    let (key, map) = match &mut *cx.object(args, 0)?.lock() {
        Data::Entry(entry, map) => {
            entry.1 = new.clone();
            (entry.0.clone(), Value::Object(Arc::clone(map)))
        }
        _ => return Ok(Value::Null),
    };
    put(cx, &[map, key, new])
}

/// The least or greatest key, by the order of the map.
fn end_key(cx: &Context<'_>, args: &[Value], is_last: bool) -> Result<Value, Trap> {
    let found = on_map(cx, args, |map| {
        let entries = map.entries();
        let entry = if is_last {
            entries.last()
        } else {
            entries.first()
        };
        Ok(entry.map(|(key, _)| key.clone()))
    })?;
    found.ok_or_else(|| cx.exception(ClassId::NoSuchElementException, "there is no key"))
}

pub(super) fn first_key(cx: &mut Context<'_>, args: &[Value]) -> Result<Value, Trap> {
    end_key(cx, args, false)
}

pub(super) fn last_key(cx: &mut Context<'_>, args: &[Value]) -> Result<Value, Trap> {
    end_key(cx, args, true)
}

/// Elements that show a map as it is now; removing through them is refused (see `more::remove`).
fn view_of(cx: &Context<'_>, values: Vec<Value>) -> Result<Value, Trap> {
    let list = list_of(cx, values)?;
    let Value::Object(list) = list else {
        return Ok(Value::Null);
    };
    let data = match &mut *list.lock() {
        Data::List(list) => std::mem::take(list),
        _ => List::default(),
    };
    Ok(new_object(ClassId::Set, Data::List(data)))
}

pub(super) fn contains_value(cx: &mut Context<'_>, args: &[Value]) -> Result<Value, Trap> {
    for (_, value) in entries(cx, args, 0)? {
        if cx.equal(args.at(1), &value)? {
            return Ok(Value::Boolean(true));
        }
    }
    Ok(Value::Boolean(false))
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
        let empty = JavaMap::new(map.order());
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
    view_of(cx, keys)
}

pub(super) fn map_values(cx: &mut Context<'_>, args: &[Value]) -> Result<Value, Trap> {
    let values = on_map(cx, args, |map| {
        Ok(map
            .entries()
            .into_iter()
            .map(|(_, value)| value.clone())
            .collect())
    })?;
    view_of(cx, values)
}
