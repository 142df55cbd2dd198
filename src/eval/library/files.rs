//! Reading and writing of text files. What may be read and written is up to the [`ModelFiles`](crate::eval::files::ModelFiles) of the machine; what a model
//! writes is kept whole until the run is over.

use super::{Arguments, Context, new_object};
use std::sync::{Arc, Mutex};

use crate::eval::array::{Array, Elements};
use crate::eval::files::FileFault;
use crate::eval::memory::Charge;
use crate::eval::object::Data;
use crate::eval::trap::Trap;
use crate::eval::value::Value;
use crate::library::ClassId;

/// A text that is read line by line.
#[derive(Clone, Debug)]
pub struct TextReader {
    text: Arc<str>,
    at: usize,
    _charge: Charge,
}

/// A text that is being written.
#[derive(Clone, Debug)]
pub struct TextWriter {
    path: String,
    text: String,
    is_open: bool,
    charge: Charge,
}

fn fault(cx: &Context<'_>, fault: FileFault) -> Trap {
    match fault {
        FileFault::Missing(message) => cx.exception(ClassId::FileNotFoundException, message),
        FileFault::Failed(message) => cx.exception(ClassId::IOException, message),
        FileFault::Refused { message, hint } => {
            Trap::limit("file-access", message, &hint, Some(cx.span))
        }
    }
}

/// The path in an argument: a text or a `File`.
fn path_of(cx: &Context<'_>, args: &[Value], index: usize) -> Result<String, Trap> {
    match args.at(index) {
        Value::Text(text) => Ok(text.as_str().to_owned()),
        Value::Object(object) => match &*object.lock() {
            Data::File(path) => Ok(path.clone()),
            _ => Err(Trap::null("open a file", cx.span)),
        },
        _ => Err(Trap::null("open a file", cx.span)),
    }
}

fn content(cx: &Context<'_>, path: &str) -> Result<String, Trap> {
    let machine = &*cx.machine;
    let place = machine.files.place(path).map_err(|f| fault(cx, f))?;
    match machine.written.get(&place) {
        Some((text, _)) => Ok(text.clone()),
        None => machine.files.read(path).map_err(|f| fault(cx, f)),
    }
}

pub(super) fn make_file(
    cx: &mut Context<'_>,
    class: ClassId,
    args: &[Value],
) -> Result<Value, Trap> {
    let mut path = path_of(cx, args, 0)?;
    if args.len() > 1 {
        path = format!("{path}/{}", args.text(1));
    }
    Ok(new_object(class, Data::File(path)))
}

pub(super) fn make_reader(
    cx: &mut Context<'_>,
    class: ClassId,
    args: &[Value],
) -> Result<Value, Trap> {
    let text = content(cx, &path_of(cx, args, 0)?)?;
    cx.machine
        .check_text(text.len())
        .map_err(|trap| trap.at(cx.span))?;
    let reader = TextReader {
        _charge: cx
            .machine
            .charge(text.len() as u64)
            .map_err(|trap| trap.at(cx.span))?,
        text: text.into(),
        at: 0,
    };
    Ok(new_object(class, Data::Reader(Box::new(reader))))
}

/// `new BufferedReader(reader)`, `new PrintWriter(writer)`: the same with another name.
pub(super) fn make_same(cx: &mut Context<'_>, _: ClassId, args: &[Value]) -> Result<Value, Trap> {
    cx.object(args, 0)?;
    Ok(args.at(0).clone())
}

pub(super) fn make_writer(
    cx: &mut Context<'_>,
    class: ClassId,
    args: &[Value],
) -> Result<Value, Trap> {
    let path = path_of(cx, args, 0)?;
    let place = cx
        .machine
        .files
        .may_write(&path)
        .map_err(|f| fault(cx, f))?;
    let text = if args.at(1).as_boolean() == Some(true) {
        match cx.machine.written.get(&place) {
            Some((text, _)) => text.clone(),
            None => match cx.machine.files.read(&path) {
                Ok(text) => text,
                Err(FileFault::Missing(_)) => String::new(),
                Err(other) => return Err(fault(cx, other)),
            },
        }
    } else {
        String::new()
    };
    let writer = TextWriter {
        path: place,
        text,
        is_open: true,
        charge: Charge::none(),
    };
    let made = new_object(class, Data::Writer(Box::new(writer)));
    flush(cx, std::slice::from_ref(&made))?;
    Ok(made)
}

fn on_reader(
    cx: &Context<'_>,
    args: &[Value],
    f: impl FnOnce(&mut TextReader) -> Option<String>,
) -> Result<Option<String>, Trap> {
    Ok(match &mut *cx.object(args, 0)?.lock() {
        Data::Reader(reader) => f(reader),
        _ => None,
    })
}

fn next_line(reader: &mut TextReader) -> Option<String> {
    let rest = reader
        .text
        .get(reader.at..)
        .filter(|rest| !rest.is_empty())?;
    let end = rest.find('\n');
    let line = rest[..end.unwrap_or(rest.len())]
        .trim_end_matches('\r')
        .to_owned();
    reader.at += end.map_or(rest.len(), |end| end + 1);
    Some(line)
}

fn next_word(reader: &mut TextReader) -> Option<String> {
    let rest = reader.text.get(reader.at..)?;
    let start = rest.find(|c: char| !c.is_whitespace())?;
    let word = rest[start..].split(char::is_whitespace).next()?.to_owned();
    reader.at += start + word.len();
    Some(word)
}

/// The next line, null at the end.
pub(super) fn read_line(cx: &mut Context<'_>, args: &[Value]) -> Result<Value, Trap> {
    match on_reader(cx, args, next_line)? {
        Some(line) => cx.new_text(line),
        None => Ok(Value::Null),
    }
}

/// The next character, -1 at the end.
pub(super) fn read_char(cx: &mut Context<'_>, args: &[Value]) -> Result<Value, Trap> {
    let found = on_reader(cx, args, |reader| {
        let c = reader.text.get(reader.at..)?.chars().next()?;
        reader.at += c.len_utf8();
        Some(c.into())
    })?;
    let unit = found.and_then(|c| c.encode_utf16().next());
    Ok(Value::Int(unit.map_or(-1, i32::from)))
}

fn at_end(cx: &Context<'_>) -> Trap {
    cx.exception(
        ClassId::NoSuchElementException,
        "the text has no more of it",
    )
}

pub(super) fn scan_line(cx: &mut Context<'_>, args: &[Value]) -> Result<Value, Trap> {
    let line = on_reader(cx, args, next_line)?.ok_or_else(|| at_end(cx))?;
    cx.new_text(line)
}

pub(super) fn scan_word(cx: &mut Context<'_>, args: &[Value]) -> Result<Value, Trap> {
    let word = on_reader(cx, args, next_word)?.ok_or_else(|| at_end(cx))?;
    cx.new_text(word)
}

pub(super) fn scan_int(cx: &mut Context<'_>, args: &[Value]) -> Result<Value, Trap> {
    let word = scan_word(cx, args)?;
    super::numbers::parse_int(cx, &[word])
}

pub(super) fn scan_double(cx: &mut Context<'_>, args: &[Value]) -> Result<Value, Trap> {
    let word = scan_word(cx, args)?;
    super::numbers::parse_double(cx, &[word])
}

pub(super) fn has_line(cx: &mut Context<'_>, args: &[Value]) -> Result<Value, Trap> {
    let found = on_reader(cx, args, |reader| next_line(&mut reader.clone()))?;
    Ok(Value::Boolean(found.is_some()))
}

pub(super) fn has_word(cx: &mut Context<'_>, args: &[Value]) -> Result<Value, Trap> {
    let found = on_reader(cx, args, |reader| next_word(&mut reader.clone()))?;
    Ok(Value::Boolean(found.is_some()))
}

/// Closing a reader changes nothing; a writer gives what it has.
pub(super) fn close(cx: &mut Context<'_>, args: &[Value]) -> Result<Value, Trap> {
    flush(cx, args)?;
    if let Data::Writer(writer) = &mut *cx.object(args, 0)?.lock() {
        writer.is_open = false;
    }
    Ok(Value::Null)
}

/// What has been written so far is the content of the file, should the run end here.
pub(super) fn flush(cx: &mut Context<'_>, args: &[Value]) -> Result<Value, Trap> {
    let (path, text) = match &*cx.object(args, 0)?.lock() {
        Data::Writer(writer) if writer.is_open => (writer.path.clone(), writer.text.clone()),
        _ => return Ok(Value::Null),
    };
    let charge = cx
        .machine
        .charge(text.len() as u64)
        .map_err(|trap| trap.at(cx.span))?;
    cx.machine.written.insert(path, (text, charge));
    Ok(Value::Null)
}

fn append(cx: &Context<'_>, args: &[Value], more: &str) -> Result<Value, Trap> {
    let mut data = cx.object(args, 0)?.lock();
    let Data::Writer(writer) = &mut *data else {
        return Ok(Value::Null);
    };
    if !writer.is_open {
        return Err(cx.exception(ClassId::IOException, "the file is closed already"));
    }
    let needed = writer.text.len() + more.len();
    cx.machine
        .check_text(needed)
        .map_err(|trap| trap.at(cx.span))?;
    if needed as u64 > writer.charge.bytes() {
        writer.charge = cx
            .machine
            .charge(2 * needed as u64)
            .map_err(|trap| trap.at(cx.span))?;
    }
    writer.text.push_str(more);
    Ok(Value::Null)
}

pub(super) fn print(cx: &mut Context<'_>, args: &[Value]) -> Result<Value, Trap> {
    let mut text = String::new();
    cx.machine.append_text(args.at(1), &mut text);
    append(cx, args, &text)
}

/// `writer.printf(pattern, values)`, which gives the writer.
pub(super) fn print_formatted(cx: &mut Context<'_>, args: &[Value]) -> Result<Value, Trap> {
    let text = super::format::formatted(cx, &args[1..])?;
    append(cx, args, &text)?;
    Ok(args.at(0).clone())
}

/// `writer.append(value)`, which gives the writer.
pub(super) fn print_chain(cx: &mut Context<'_>, args: &[Value]) -> Result<Value, Trap> {
    print(cx, args)?;
    Ok(args.at(0).clone())
}

pub(super) fn println(cx: &mut Context<'_>, args: &[Value]) -> Result<Value, Trap> {
    let mut text = String::new();
    if args.len() > 1 {
        cx.machine.append_text(args.at(1), &mut text);
    }
    text.push('\n');
    append(cx, args, &text)
}

/// `write(65)` writes the character of that number.
pub(super) fn write_char(cx: &mut Context<'_>, args: &[Value]) -> Result<Value, Trap> {
    let c = crate::eval::text::char_of(args.int(1) as u16);
    append(cx, args, c.encode_utf8(&mut [0; 4]))
}

fn file_name(path: &str) -> &str {
    path.rsplit(['/', '\\']).next().unwrap_or(path)
}

pub(super) fn name(cx: &mut Context<'_>, args: &[Value]) -> Result<Value, Trap> {
    let path = path_of(cx, args, 0)?;
    cx.new_text(file_name(&path))
}

pub(super) fn path(cx: &mut Context<'_>, args: &[Value]) -> Result<Value, Trap> {
    let path = path_of(cx, args, 0)?;
    cx.new_text(path)
}

pub(super) fn exists(cx: &mut Context<'_>, args: &[Value]) -> Result<Value, Trap> {
    let path = path_of(cx, args, 0)?;
    Ok(Value::Boolean(
        is_readable(cx, &path)? || names_in(cx, &path)?.is_some(),
    ))
}

pub(super) fn is_file(cx: &mut Context<'_>, args: &[Value]) -> Result<Value, Trap> {
    Ok(Value::Boolean(is_readable(cx, &path_of(cx, args, 0)?)?))
}

pub(super) fn is_folder(cx: &mut Context<'_>, args: &[Value]) -> Result<Value, Trap> {
    let names = names_in(cx, &path_of(cx, args, 0)?)?;
    Ok(Value::Boolean(names.is_some()))
}

/// Nothing has to be made before a file is written; whether the model may write there is said now.
pub(super) fn make_folder(cx: &mut Context<'_>, args: &[Value]) -> Result<Value, Trap> {
    let path = path_of(cx, args, 0)?;
    cx.machine.files.place(&path).map_err(|f| fault(cx, f))?;
    Ok(Value::Boolean(true))
}

pub(super) fn create(cx: &mut Context<'_>, args: &[Value]) -> Result<Value, Trap> {
    let path = path_of(cx, args, 0)?;
    let is_there = is_readable(cx, &path)?;
    let files = &cx.machine.files;
    files.may_write(&path).map_err(|f| fault(cx, f))?;
    Ok(Value::Boolean(!is_there))
}

pub(super) fn parent(cx: &mut Context<'_>, args: &[Value]) -> Result<Value, Trap> {
    let path = path_of(cx, args, 0)?;
    let path = path.trim_end_matches(['/', '\\']);
    match path.rfind(['/', '\\']) {
        Some(at) => cx.new_text(&path[..at]),
        None => Ok(Value::Null),
    }
}

pub(super) fn list(cx: &mut Context<'_>, args: &[Value]) -> Result<Value, Trap> {
    let names = names_in(cx, &path_of(cx, args, 0)?)?;
    names.map_or(Ok(Value::Null), |names| {
        array_of(cx, names.into_iter().map(Value::text))
    })
}

pub(super) fn list_files(cx: &mut Context<'_>, args: &[Value]) -> Result<Value, Trap> {
    let folder = path_of(cx, args, 0)?;
    let Some(names) = names_in(cx, &folder)? else {
        return Ok(Value::Null);
    };
    let folder = folder.trim_end_matches(['/', '\\']);
    let files = names.into_iter().map(|name| {
        let path = if folder.is_empty() {
            name
        } else {
            format!("{folder}/{name}")
        };
        new_object(ClassId::File, Data::File(path))
    });
    array_of(cx, files)
}

/// What a folder holds; nothing that the model itself has written in this run.
fn names_in(cx: &Context<'_>, path: &str) -> Result<Option<Vec<String>>, Trap> {
    cx.machine.files.list(path).map_err(|f| fault(cx, f))
}

fn is_readable(cx: &Context<'_>, path: &str) -> Result<bool, Trap> {
    match content(cx, path) {
        Ok(_) => Ok(true),
        Err(trap) if trap.thrown().is_some() => Ok(false),
        Err(trap) => Err(trap),
    }
}

/// An array of objects, with its share of the memory budget.
fn array_of(cx: &Context<'_>, values: impl Iterator<Item = Value>) -> Result<Value, Trap> {
    let elements: Box<[Mutex<Value>]> = values.map(Mutex::new).collect();
    let charge = cx.machine.charge(64 * elements.len() as u64);
    let charge = charge.map_err(|trap| trap.at(cx.span))?;
    let array = Array::new(Elements::Reference(elements), charge);
    Ok(Value::Array(Arc::new(array)))
}
