//! `StringBuffer` and `StringBuilder`; indices count UTF-16 units, as Java's do.

use super::{Arguments, Context, new_object};
use crate::eval::machine::out_of_bounds;
use crate::eval::memory::Charge;
use crate::eval::object::Data;
use crate::eval::text::{Text, char_of};
use crate::eval::trap::Trap;
use crate::eval::value::Value;
use crate::library::ClassId;

/// `new StringBuilder()`, `new StringBuilder(text)`, `new StringBuilder(capacity)`
pub(super) fn make(cx: &mut Context<'_>, class: ClassId, args: &[Value]) -> Result<Value, Trap> {
    let text = match args.at(0) {
        Value::Text(text) => text.as_str(),
        Value::Null if !args.is_empty() => return Err(Trap::null("use a text", cx.span)),
        _ => "",
    };
    let charge = cx
        .machine
        .charge(text.len() as u64)
        .map_err(|trap| trap.at(cx.span))?;
    Ok(new_object(class, Data::Buffer(text.to_owned(), charge)))
}

/// The text of the receiver.
fn text(cx: &Context<'_>, args: &[Value]) -> Result<Text, Trap> {
    Ok(match &*cx.object(args, 0)?.lock() {
        Data::Buffer(text, _) => Text::new(text.as_str(), Charge::none()),
        _ => Text::new("", Charge::none()),
    })
}

/// Puts a text in place of what the receiver held.
fn become_(cx: &Context<'_>, args: &[Value], new: String) -> Result<Value, Trap> {
    change(cx, args, |text| *text = new)
}

/// Changes the text of the receiver and pays for it.
fn change(cx: &Context<'_>, args: &[Value], f: impl FnOnce(&mut String)) -> Result<Value, Trap> {
    if let Data::Buffer(text, charge) = &mut *cx.object(args, 0)?.lock() {
        f(text);
        let n_bytes = text.len();
        cx.machine
            .check_text(n_bytes)
            .map_err(|trap| trap.at(cx.span))?;
        // The share grows in doublings, as the buffer does.
        if n_bytes as u64 > charge.bytes() {
            *charge = cx
                .machine
                .charge(2 * n_bytes as u64)
                .map_err(|trap| trap.at(cx.span))?;
        }
    }
    Ok(args.at(0).clone())
}

pub(super) fn append(cx: &mut Context<'_>, args: &[Value]) -> Result<Value, Trap> {
    change(cx, args, |text| text.push_str(args.text(1)))
}

fn int(n: usize) -> Value {
    Value::Int(i32::try_from(n).unwrap_or(i32::MAX))
}

pub(super) fn length(cx: &mut Context<'_>, args: &[Value]) -> Result<Value, Trap> {
    Ok(int(text(cx, args)?.len()))
}

pub(super) fn is_empty(cx: &mut Context<'_>, args: &[Value]) -> Result<Value, Trap> {
    Ok(Value::Boolean(text(cx, args)?.is_empty()))
}

fn out_of_text(cx: &Context<'_>, index: i32, length: usize) -> Trap {
    let class = ClassId::StringIndexOutOfBoundsException;
    out_of_bounds(class, i64::from(index), length, cx.span)
}

/// An index in the text, or just behind it if `is_open`.
fn place(cx: &Context<'_>, index: i32, length: usize, is_open: bool) -> Result<usize, Trap> {
    let place = usize::try_from(index).ok();
    place
        .filter(|&i| i < length || is_open && i == length)
        .ok_or_else(|| out_of_text(cx, index, length))
}

pub(super) fn char_at(cx: &mut Context<'_>, args: &[Value]) -> Result<Value, Trap> {
    let text = text(cx, args)?;
    let at = place(cx, args.int(1), text.len(), false)?;
    Ok(Value::Char(text.unit(at).unwrap_or(0)))
}

/// Replaces what stands from `from` up to `to`; an end beyond the text is the end of the text.
fn splice(
    cx: &Context<'_>,
    args: &[Value],
    [from, to]: [i32; 2],
    new: &str,
) -> Result<Value, Trap> {
    let text = text(cx, args)?;
    let start = place(cx, from, text.len(), true)?;
    let end = usize::try_from(to).unwrap_or(0).min(text.len());
    if end < start {
        let message = format!("start {from}, end {to}, length {}", text.len());
        return Err(cx.exception(ClassId::StringIndexOutOfBoundsException, message));
    }
    let part = |from, to| text.slice(from, to).unwrap_or_default();
    let whole = [part(0, start).as_str(), new, part(end, text.len()).as_str()].concat();
    become_(cx, args, whole)
}

pub(super) fn insert(cx: &mut Context<'_>, args: &[Value]) -> Result<Value, Trap> {
    splice(cx, args, [args.int(1); 2], args.text(2))
}

pub(super) fn delete(cx: &mut Context<'_>, args: &[Value]) -> Result<Value, Trap> {
    splice(cx, args, [args.int(1), args.int(2)], "")
}

pub(super) fn replace(cx: &mut Context<'_>, args: &[Value]) -> Result<Value, Trap> {
    splice(cx, args, [args.int(1), args.int(2)], args.text(3))
}

pub(super) fn delete_char_at(cx: &mut Context<'_>, args: &[Value]) -> Result<Value, Trap> {
    place(cx, args.int(1), text(cx, args)?.len(), false)?;
    splice(cx, args, [args.int(1), args.int(1) + 1], "")
}

pub(super) fn set_char_at(cx: &mut Context<'_>, args: &[Value]) -> Result<Value, Trap> {
    place(cx, args.int(1), text(cx, args)?.len(), false)?;
    let new = char_of(args.int(2) as u16).to_string();
    splice(cx, args, [args.int(1), args.int(1) + 1], &new)
}

pub(super) fn reverse(cx: &mut Context<'_>, args: &[Value]) -> Result<Value, Trap> {
    let reversed = text(cx, args)?.as_str().chars().rev().collect();
    become_(cx, args, reversed)
}

/// `setLength(n)`: cuts off, or fills up with characters 0.
pub(super) fn set_length(cx: &mut Context<'_>, args: &[Value]) -> Result<Value, Trap> {
    let text = text(cx, args)?;
    let wanted = args.int(1);
    let n = usize::try_from(wanted).map_err(|_| out_of_text(cx, wanted, text.len()))?;
    cx.machine.check_text(n).map_err(|trap| trap.at(cx.span))?;
    let kept = text.slice(0, n.min(text.len())).unwrap_or_default();
    let missing = n.saturating_sub(text.len());
    become_(cx, args, kept + &"\0".repeat(missing))?;
    Ok(Value::Null)
}

fn found(at: Option<usize>) -> Value {
    at.map_or(Value::Int(-1), int)
}

pub(super) fn index_of(cx: &mut Context<'_>, args: &[Value]) -> Result<Value, Trap> {
    Ok(found(text(cx, args)?.find(args.text(1), 0)))
}

pub(super) fn last_index_of(cx: &mut Context<'_>, args: &[Value]) -> Result<Value, Trap> {
    Ok(found(text(cx, args)?.rfind(args.text(1))))
}

pub(super) fn substring(cx: &mut Context<'_>, args: &[Value]) -> Result<Value, Trap> {
    let whole = super::strings::value_of(cx, args)?;
    super::strings::substring(cx, &[whole, args.at(1).clone()])
}

pub(super) fn substring_to(cx: &mut Context<'_>, args: &[Value]) -> Result<Value, Trap> {
    let whole = super::strings::value_of(cx, args)?;
    super::strings::substring_to(cx, &[whole, args.at(1).clone(), args.at(2).clone()])
}
