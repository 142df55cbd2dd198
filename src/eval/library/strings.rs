//! Texts, characters, and buffers of text.

use super::{Arguments, Context};
use crate::eval::array::{Array, Elements};
use crate::eval::machine::out_of_bounds;
use crate::eval::text::{Text, char_of};
use crate::eval::trap::Trap;
use crate::eval::value::Value;
use crate::library::ClassId;
use std::sync::Arc;
use std::sync::Mutex;
use std::sync::atomic::AtomicU16;

/// The receiver.
fn receiver<'v>(cx: &Context<'_>, args: &'v [Value]) -> Result<&'v Text, Trap> {
    args.at(0)
        .as_text()
        .ok_or_else(|| Trap::null("use a text", cx.span))
}

/// The first argument behind the receiver, which must not be null.
fn other<'v>(cx: &Context<'_>, args: &'v [Value]) -> Result<&'v str, Trap> {
    args.at(1)
        .as_text()
        .map(Text::as_str)
        .ok_or_else(|| Trap::null("use a text", cx.span))
}

fn place(found: Option<usize>) -> Value {
    Value::Int(found.and_then(|at| i32::try_from(at).ok()).unwrap_or(-1))
}

pub(super) fn make_empty(_: &mut Context<'_>, _: ClassId, _: &[Value]) -> Result<Value, Trap> {
    Ok(Value::text(""))
}

pub(super) fn make_copy(_: &mut Context<'_>, _: ClassId, args: &[Value]) -> Result<Value, Trap> {
    Ok(args.at(0).clone())
}

pub(super) fn value_of(cx: &mut Context<'_>, args: &[Value]) -> Result<Value, Trap> {
    if args.at(0).as_text().is_some() {
        return Ok(args.at(0).clone());
    }
    let mut text = String::new();
    cx.tell(args.at(0), &mut text)?;
    cx.new_text(text)
}

/// `object.toString()`
pub(super) fn to_string(cx: &mut Context<'_>, args: &[Value]) -> Result<Value, Trap> {
    if args.at(0).is_null() {
        return Err(Trap::null("call `toString` of an object", cx.span));
    }
    value_of(cx, args)
}

pub(super) fn length(cx: &mut Context<'_>, args: &[Value]) -> Result<Value, Trap> {
    Ok(Value::Int(
        i32::try_from(receiver(cx, args)?.len()).unwrap_or(i32::MAX),
    ))
}

pub(super) fn char_at(cx: &mut Context<'_>, args: &[Value]) -> Result<Value, Trap> {
    let (text, index) = (receiver(cx, args)?, args.int(1));
    let unit = usize::try_from(index).ok().and_then(|i| text.unit(i));
    let class = ClassId::StringIndexOutOfBoundsException;
    unit.map(Value::Char)
        .ok_or_else(|| out_of_bounds(class, i64::from(index), text.len(), cx.span))
}

pub(super) fn substring(cx: &mut Context<'_>, args: &[Value]) -> Result<Value, Trap> {
    let end = i32::try_from(receiver(cx, args)?.len()).unwrap_or(i32::MAX);
    slice(cx, args, args.int(1), end)
}

pub(super) fn substring_to(cx: &mut Context<'_>, args: &[Value]) -> Result<Value, Trap> {
    slice(cx, args, args.int(1), args.int(2))
}

fn slice(cx: &Context<'_>, args: &[Value], begin: i32, end: i32) -> Result<Value, Trap> {
    let text = receiver(cx, args)?;
    let part = usize::try_from(begin)
        .ok()
        .zip(usize::try_from(end).ok())
        .and_then(|(a, b)| text.slice(a, b));
    match part {
        Some(part) => cx.new_text(part),
        None => {
            let message = format!("begin {begin}, end {end}, length {}", text.len());
            Err(cx.exception(ClassId::StringIndexOutOfBoundsException, message))
        }
    }
}

pub(super) fn index_of(cx: &mut Context<'_>, args: &[Value]) -> Result<Value, Trap> {
    Ok(place(receiver(cx, args)?.find(other(cx, args)?, 0)))
}

pub(super) fn index_of_from(cx: &mut Context<'_>, args: &[Value]) -> Result<Value, Trap> {
    let from = usize::try_from(args.int(2)).unwrap_or(0);
    Ok(place(receiver(cx, args)?.find(other(cx, args)?, from)))
}

pub(super) fn index_of_char(cx: &mut Context<'_>, args: &[Value]) -> Result<Value, Trap> {
    let wanted = char_of(args.int(1) as u16).to_string();
    Ok(place(receiver(cx, args)?.find(&wanted, 0)))
}

pub(super) fn last_index_of(cx: &mut Context<'_>, args: &[Value]) -> Result<Value, Trap> {
    Ok(place(receiver(cx, args)?.rfind(other(cx, args)?)))
}

pub(super) fn equals_ignore_case(cx: &mut Context<'_>, args: &[Value]) -> Result<Value, Trap> {
    let text = receiver(cx, args)?.as_str();
    let is_equal = args
        .at(1)
        .as_text()
        .is_some_and(|t| t.as_str().to_lowercase() == text.to_lowercase());
    Ok(Value::Boolean(is_equal))
}

/// Difference of the first units that differ, else of the lengths.
pub(super) fn compare_to(cx: &mut Context<'_>, args: &[Value]) -> Result<Value, Trap> {
    let (a, b) = (receiver(cx, args)?.as_str(), other(cx, args)?);
    let mut pairs = a.encode_utf16().zip(b.encode_utf16());
    let difference = pairs
        .find(|(a, b)| a != b)
        .map(|(a, b)| i32::from(a) - i32::from(b));
    let length = |text: &str| i32::try_from(text.encode_utf16().count()).unwrap_or(i32::MAX);
    Ok(Value::Int(
        difference.unwrap_or_else(|| length(a) - length(b)),
    ))
}

pub(super) fn to_upper_case(cx: &mut Context<'_>, args: &[Value]) -> Result<Value, Trap> {
    cx.new_text(receiver(cx, args)?.as_str().to_uppercase())
}

pub(super) fn to_lower_case(cx: &mut Context<'_>, args: &[Value]) -> Result<Value, Trap> {
    cx.new_text(receiver(cx, args)?.as_str().to_lowercase())
}

/// Java trims everything up to the blank.
pub(super) fn trim(cx: &mut Context<'_>, args: &[Value]) -> Result<Value, Trap> {
    cx.new_text(receiver(cx, args)?.as_str().trim_matches(|c| c <= ' '))
}

pub(super) fn starts_with(cx: &mut Context<'_>, args: &[Value]) -> Result<Value, Trap> {
    Ok(Value::Boolean(
        receiver(cx, args)?.as_str().starts_with(other(cx, args)?),
    ))
}

pub(super) fn ends_with(cx: &mut Context<'_>, args: &[Value]) -> Result<Value, Trap> {
    Ok(Value::Boolean(
        receiver(cx, args)?.as_str().ends_with(other(cx, args)?),
    ))
}

pub(super) fn contains(cx: &mut Context<'_>, args: &[Value]) -> Result<Value, Trap> {
    Ok(Value::Boolean(
        receiver(cx, args)?.as_str().contains(other(cx, args)?),
    ))
}

pub(super) fn replace(cx: &mut Context<'_>, args: &[Value]) -> Result<Value, Trap> {
    let (text, from, to) = (receiver(cx, args)?.as_str(), other(cx, args)?, args.text(2));
    // Grows by this much at most; refuse before the text is made.
    let n_found = text.matches(from).count();
    cx.machine
        .check_text(text.len().saturating_add(n_found.saturating_mul(to.len())))
        .map_err(|t| t.at(cx.span))?;
    cx.new_text(text.replace(from, to))
}

pub(super) fn replace_char(cx: &mut Context<'_>, args: &[Value]) -> Result<Value, Trap> {
    let [from, to] = [1, 2].map(|i| char_of(args.int(i) as u16));
    let text: String = receiver(cx, args)?
        .as_str()
        .chars()
        .map(|c| if c == from { to } else { c })
        .collect();
    cx.new_text(text)
}

pub(super) fn is_empty(cx: &mut Context<'_>, args: &[Value]) -> Result<Value, Trap> {
    Ok(Value::Boolean(receiver(cx, args)?.is_empty()))
}

/// Parts between occurrences of a plain separator (of the regular expressions only `\\s+`, `\\t`, `\\|`, `\\.` and their
/// kin are known); empty parts at the end are dropped.
pub(super) fn split(cx: &mut Context<'_>, args: &[Value]) -> Result<Value, Trap> {
    split_into(cx, args, 0)
}

/// As [`split`], into at most `limit` parts if that is above 0; empty parts at the end are kept unless it is 0.
pub(super) fn split_limit(cx: &mut Context<'_>, args: &[Value]) -> Result<Value, Trap> {
    split_into(cx, args, args.int(2))
}

fn split_into(cx: &Context<'_>, args: &[Value], limit: i32) -> Result<Value, Trap> {
    let (text, separator) = (receiver(cx, args)?.as_str(), other(cx, args)?);
    let mut parts: Vec<&str> = match Separator::of(separator) {
        Some(Separator::Blanks) => split_at_blanks(text),
        Some(Separator::Text(t)) if t.is_empty() => {
            text.split_inclusive(|_| true).chain([""]).collect()
        }
        Some(Separator::Text(t)) => text.split(&*t).collect(),
        Some(Separator::Any(set)) => text.split(|c| set.contains(&c)).collect(),
        None => return Err(no_pattern(cx, separator)),
    };
    if limit > 0 {
        join_rest(text, &mut parts, limit.unsigned_abs() as usize);
    }
    // A text in which the separator does not occur is its own only part, even if it is empty.
    if limit == 0 && parts.len() > 1 {
        let end = parts.iter().rposition(|part| !part.is_empty());
        parts.truncate(end.map_or(0, |last| last + 1));
    }
    let charge = cx
        .machine
        .charge(64 * parts.len() as u64)
        .map_err(|trap| trap.at(cx.span))?;
    let elements: Vec<Mutex<Value>> = parts
        .iter()
        .map(|part| Mutex::new(Value::text(*part)))
        .collect();
    Ok(Value::Array(Arc::new(Array::new(
        Elements::Reference(elements.into()),
        charge,
    ))))
}

/// Leaves `n` parts of `text`, of which the last is all that follows the others.
fn join_rest<'t>(text: &'t str, parts: &mut Vec<&'t str>, n: usize) {
    if let Some(last) = parts.get(n - 1) {
        let begin = last.as_ptr() as usize - text.as_ptr() as usize;
        parts.truncate(n);
        parts[n - 1] = &text[begin..];
    }
}

/// What a text is split at: the few patterns that models use.
enum Separator {
    Blanks,
    Text(String),
    Any(Vec<char>),
}

impl Separator {
    /// The pattern, if it is one of those.
    fn of(pattern: &str) -> Option<Self> {
        let escaped = |rest: &str| match rest {
            "t" => Some("\t".to_owned()),
            "n" => Some("\n".to_owned()),
            c if c.chars().count() == 1 && !c.contains(char::is_alphanumeric) => Some(c.to_owned()),
            _ => None,
        };
        if matches!(
            pattern,
            "\\s+" | " +" | "\\s" | "[ ]+" | "\\s*" | "[\\s]+" | "[ \t]+"
        ) {
            return Some(Self::Blanks);
        }
        if let Some(rest) = pattern.strip_prefix('\\') {
            return escaped(rest).map(Self::Text);
        }
        let set = pattern.strip_prefix('[').and_then(|p| p.strip_suffix(']'));
        if let Some(set) = set {
            let is_plain = !set.contains(['\\', '-', '^', '[', ']', '&']);
            return is_plain.then(|| Self::Any(set.chars().collect()));
        }
        let meta = [
            '\\', '[', ']', '(', ')', '{', '}', '*', '+', '?', '^', '$', '.', '|',
        ];
        // One sign alone that means something in patterns only together with others is meant as it stands.
        let is_plain = !pattern.contains(meta) || matches!(pattern, "{" | "}" | "]");
        is_plain.then(|| Self::Text(pattern.to_owned()))
    }
}

fn no_pattern(cx: &Context<'_>, pattern: &str) -> Trap {
    let message = format!(
        "the regular expression \"{pattern}\" is not supported; known are plain texts, `[,;]` and `\\s+`"
    );
    cx.exception(ClassId::UnsupportedOperationException, message)
}

/// `text.replaceAll(pattern, text)`
pub(super) fn replace_all(cx: &mut Context<'_>, args: &[Value]) -> Result<Value, Trap> {
    let (text, pattern) = (receiver(cx, args)?.as_str(), other(cx, args)?);
    let new = args.text(2);
    let replaced = match Separator::of(pattern) {
        Some(Separator::Text(t)) => text.replace(&*t, new),
        Some(Separator::Any(set)) => text.replace(&*set, new),
        Some(Separator::Blanks) => replace_blanks(text, new, pattern.contains('+')),
        None => return Err(no_pattern(cx, pattern)),
    };
    cx.new_text(replaced)
}

/// With every blank, or every run of blanks, replaced.
fn replace_blanks(text: &str, new: &str, is_run: bool) -> String {
    let (mut out, mut was_blank) = (String::new(), false);
    for c in text.chars() {
        let is_blank = c.is_whitespace();
        if !is_blank {
            out.push(c);
        } else if !(is_run && was_blank) {
            out.push_str(new);
        }
        was_blank = is_blank;
    }
    out
}

pub(super) fn replace_first(cx: &mut Context<'_>, args: &[Value]) -> Result<Value, Trap> {
    let (text, pattern) = (receiver(cx, args)?.as_str(), other(cx, args)?);
    match Separator::of(pattern) {
        Some(Separator::Text(t)) => cx.new_text(text.replacen(&*t, args.text(2), 1)),
        Some(Separator::Any(set)) => cx.new_text(text.replacen(&*set, args.text(2), 1)),
        _ => Err(no_pattern(cx, pattern)),
    }
}

pub(super) fn index_of_char_from(cx: &mut Context<'_>, args: &[Value]) -> Result<Value, Trap> {
    let wanted = char_of(args.int(1) as u16).to_string();
    let from = usize::try_from(args.int(2)).unwrap_or(0);
    Ok(place(receiver(cx, args)?.find(&wanted, from)))
}

pub(super) fn last_index_of_char(cx: &mut Context<'_>, args: &[Value]) -> Result<Value, Trap> {
    let wanted = char_of(args.int(1) as u16).to_string();
    Ok(place(receiver(cx, args)?.rfind(&wanted)))
}

/// A text that begins with blanks has an empty first part, as in Java; one that ends with blanks an empty last one.
fn split_at_blanks(text: &str) -> Vec<&str> {
    let first = text.starts_with(char::is_whitespace).then_some("");
    let last = text.ends_with(char::is_whitespace).then_some("");
    let words = first.into_iter().chain(text.split_whitespace());
    words.chain(last).collect()
}

pub(super) fn concat(cx: &mut Context<'_>, args: &[Value]) -> Result<Value, Trap> {
    cx.new_text([receiver(cx, args)?.as_str(), other(cx, args)?].concat())
}

pub(super) fn to_char_array(cx: &mut Context<'_>, args: &[Value]) -> Result<Value, Trap> {
    let text = receiver(cx, args)?;
    let charge = cx
        .machine
        .charge(2 * text.len() as u64)
        .map_err(|trap| trap.at(cx.span))?;
    let units = text.as_str().encode_utf16().map(AtomicU16::new).collect();
    Ok(Value::Array(Arc::new(Array::new(
        Elements::Char(units),
        charge,
    ))))
}

pub(super) fn is_digit(_: &mut Context<'_>, args: &[Value]) -> Result<Value, Trap> {
    Ok(Value::Boolean(char_of(args.int(0) as u16).is_ascii_digit()))
}

pub(super) fn is_letter(_: &mut Context<'_>, args: &[Value]) -> Result<Value, Trap> {
    Ok(Value::Boolean(char_of(args.int(0) as u16).is_alphabetic()))
}

pub(super) fn is_whitespace(_: &mut Context<'_>, args: &[Value]) -> Result<Value, Trap> {
    Ok(Value::Boolean(char_of(args.int(0) as u16).is_whitespace()))
}

/// The text of an array of characters.
fn text_of_chars(cx: &Context<'_>, value: &Value) -> Result<String, Trap> {
    let Value::Array(array) = value else {
        return Err(Trap::null("use an array of characters", cx.span));
    };
    let units = (0..array.len()).filter_map(|i| array.get(i)?.as_int());
    let units: Vec<u16> = units.map(|unit| unit as u16).collect();
    Ok(String::from_utf16_lossy(&units))
}

/// `String.valueOf(chars)`
pub(super) fn of_chars(cx: &mut Context<'_>, args: &[Value]) -> Result<Value, Trap> {
    cx.new_text(text_of_chars(cx, args.at(0))?)
}

/// `new String(chars)`
pub(super) fn make_of_chars(
    cx: &mut Context<'_>,
    _: ClassId,
    args: &[Value],
) -> Result<Value, Trap> {
    of_chars(cx, args)
}

/// `String.join(between, texts)`, of values or of a collection.
pub(super) fn join(cx: &mut Context<'_>, args: &[Value]) -> Result<Value, Trap> {
    let parts = match args.at(1) {
        Value::Array(array) => super::arrays::all(array),
        _ => super::collections::elements(cx, args, 1)?,
    };
    let mut text = String::new();
    for (i, part) in parts.iter().enumerate() {
        if i > 0 {
            text.push_str(args.text(0));
        }
        cx.tell(part, &mut text)?;
    }
    cx.new_text(text)
}

/// Java strips all white space of Unicode, where `trim` takes everything up to the blank.
pub(super) fn strip(cx: &mut Context<'_>, args: &[Value]) -> Result<Value, Trap> {
    cx.new_text(receiver(cx, args)?.as_str().trim())
}

pub(super) fn is_blank(cx: &mut Context<'_>, args: &[Value]) -> Result<Value, Trap> {
    Ok(Value::Boolean(
        receiver(cx, args)?.as_str().trim().is_empty(),
    ))
}

pub(super) fn repeat(cx: &mut Context<'_>, args: &[Value]) -> Result<Value, Trap> {
    let text = receiver(cx, args)?.as_str();
    let Ok(n) = usize::try_from(args.int(1)) else {
        let message = format!("count is negative: {}", args.int(1));
        return Err(cx.exception(ClassId::IllegalArgumentException, message));
    };
    let n_bytes = text.len().saturating_mul(n);
    cx.machine
        .check_text(n_bytes)
        .map_err(|trap| trap.at(cx.span))?;
    cx.new_text(text.repeat(n))
}

pub(super) fn compare_ignoring_case(cx: &mut Context<'_>, args: &[Value]) -> Result<Value, Trap> {
    let (a, b) = (receiver(cx, args)?.as_str(), other(cx, args)?);
    let folded = [a, b].map(|text| Value::text(text.to_uppercase().to_lowercase()));
    compare_to(cx, &folded)
}

/// `text.startsWith(prefix, at)`
pub(super) fn starts_with_at(cx: &mut Context<'_>, args: &[Value]) -> Result<Value, Trap> {
    let (text, prefix) = (receiver(cx, args)?, other(cx, args)?);
    let at = usize::try_from(args.int(2)).ok();
    let rest = at.and_then(|at| text.slice(at, text.len()));
    Ok(Value::Boolean(
        rest.is_some_and(|rest| rest.starts_with(prefix)),
    ))
}
