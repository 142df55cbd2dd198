//! What the word at a place means: for hover and "go to definition".

use super::cursor::Cursor;
use super::symbols::{Symbol, SymbolKind};
use super::workspace::{Analysis, FileView};
use crate::check::{LocalVariable, Meaning};
use crate::diag::Span;
use crate::library::{self, ClassId, FunctionId, LibraryConstant, MethodId, Signature, constant};
use crate::manual::signature::{self, builtin_named};
use crate::manual::words::{Word, word_named};
use crate::turtle::{BuiltinField, BuiltinType};
use std::ops::Range;

/// Something that has a name.
#[derive(Clone, Debug)]
pub enum Thing<'a> {
    /// Something the model declares.
    Symbol(&'a Symbol),
    /// A local variable.
    Local(&'a LocalVariable),
    /// A file of the model.
    File(&'a FileView),
    /// Functions or methods of the library, all of one name.
    Library(Vec<&'static Signature>),
    /// A property of a built-in type.
    Property(&'static BuiltinField),
    /// A built-in type.
    Builtin(&'static BuiltinType),
    /// A class of the library.
    Class(ClassId),
    /// A constant of the library.
    Constant(&'static LibraryConstant),
    /// A word of the syntax.
    Word(&'static Word),
}

/// What the word at byte `at` of a file means, with its range.
pub fn at<'a>(
    analysis: &'a Analysis,
    file: &'a FileView,
    at: usize,
) -> Option<(Range<usize>, Thing<'a>)> {
    let cursor = Cursor::new(&file.text, at);
    if !cursor.is_code || cursor.word.is_empty() {
        return None;
    }
    let name = &file.text[cursor.word.clone()];
    let span = Span::new(file.id, cursor.word.start, cursor.word.end);
    let qualifier = cursor.qualifier(&file.text);
    let thing = surveyed(analysis, span)
        .or_else(|| qualifier.and_then(|owner| qualified(analysis, owner, name)))
        .or_else(|| global(analysis, name))?;
    Some((cursor.word, thing))
}

/// What the check found out about the name in this very place.
fn surveyed(analysis: &Analysis, span: Span) -> Option<Thing<'_>> {
    let survey = &analysis.survey;
    if let Some(thing) = declared_at(analysis, span) {
        return Some(thing);
    }
    let (_, meaning) = survey.uses.iter().find(|(place, _)| *place == span)?;
    match *meaning {
        Meaning::Declared(span) => declared_at(analysis, span),
        Meaning::Library(row) => Some(Thing::Library(overloads(row))),
        Meaning::Property(field) => Some(Thing::Property(field)),
    }
}

/// What is declared by the name in this place.
fn declared_at(analysis: &Analysis, span: Span) -> Option<Thing<'_>> {
    let symbol = analysis
        .files
        .iter()
        .flat_map(|file| &file.symbols)
        .find(|s| s.name_span == span);
    let local = || {
        analysis
            .survey
            .locals
            .iter()
            .find(|local| local.declared == span)
    };
    symbol
        .map(Thing::Symbol)
        .or_else(|| local().map(Thing::Local))
}

/// A row of the library with the other overloads of its name.
fn overloads(row: &'static Signature) -> Vec<&'static Signature> {
    let functions = library::functions_named(row.owner, row.name)
        .iter()
        .map(|id| id.signature());
    let methods = library::methods_named(row.owner, row.name)
        .iter()
        .map(|id| id.signature());
    let others = functions
        .chain(methods)
        .filter(|other| !std::ptr::eq(*other, row));
    std::iter::once(row).chain(others).collect()
}

/// `owner.name`
fn qualified<'a>(analysis: &'a Analysis, owner: &str, name: &str) -> Option<Thing<'a>> {
    let functions: Vec<_> = library::functions_named(owner, name)
        .iter()
        .map(|id| id.signature())
        .collect();
    if !functions.is_empty() {
        return Some(Thing::Library(functions));
    }
    constant(owner, name).map(Thing::Constant).or_else(|| {
        let file = analysis.files.iter().find(|file| file.name() == owner)?;
        file.symbols
            .iter()
            .find(|s| s.owner.is_none() && s.name == name)
            .map(Thing::Symbol)
    })
}

/// What a name means wherever it stands.
fn global<'a>(analysis: &'a Analysis, name: &str) -> Option<Thing<'a>> {
    let module = analysis
        .symbols()
        .find(|s| matches!(s.kind, SymbolKind::Module | SymbolKind::Class) && s.name == name);
    let functions = || {
        let rows: Vec<&Signature> = FunctionId::ALL
            .iter()
            .map(|id| id.signature())
            .filter(|row| row.name == name && row.owner.is_empty())
            .collect();
        (!rows.is_empty()).then_some(Thing::Library(rows))
    };
    let methods = || {
        let rows: Vec<&Signature> = MethodId::ALL
            .iter()
            .filter(|id| !id.is_hidden())
            .map(|id| id.signature())
            .filter(|row| row.name == name)
            .collect();
        (!rows.is_empty()).then_some(Thing::Library(rows))
    };
    module
        .map(Thing::Symbol)
        .or_else(|| builtin_named(name).map(Thing::Builtin))
        .or_else(|| word_named(name).map(Thing::Word))
        .or_else(|| ClassId::named(name).map(Thing::Class))
        .or_else(|| constant("", name).map(Thing::Constant))
        .or_else(functions)
        .or_else(|| {
            analysis
                .symbols()
                .find(|s| s.name == name)
                .map(Thing::Symbol)
        })
        .or_else(|| {
            analysis
                .files
                .iter()
                .find(|file| file.name() == name)
                .map(|file| Thing::File(file))
        })
        .or_else(methods)
}

impl Thing<'_> {
    /// How it is written, as lines of code.
    pub fn code(&self) -> String {
        match self {
            Self::Symbol(symbol) => symbol.signature.clone(),
            Self::Local(local) => format!("{} {}", local.ty, local.name).trim().to_owned(),
            Self::File(file) => format!("{}.rgg", file.name()),
            Self::Library(rows) => {
                let lines: Vec<String> = rows.iter().map(|row| signature::call(row)).collect();
                lines.join("\n")
            }
            Self::Property(field) => signature::property(field),
            Self::Builtin(row) => {
                let forms = signature::constructors(row);
                if forms.is_empty() {
                    format!("abstract module {}", row.name)
                } else {
                    forms.join("\n")
                }
            }
            Self::Class(class) => format!("class {}", signature::class(*class)),
            Self::Constant(row) => signature::constant(row),
            Self::Word(word) => word.form.into(),
        }
    }

    /// What it means, as markdown.
    pub fn text(&self) -> String {
        match self {
            Self::Symbol(symbol) => symbol.doc.replace('\n', "  \n"),
            Self::Local(_) => String::new(),
            Self::File(_) => "A file of this model.".into(),
            Self::Library(rows) => {
                let mut lines: Vec<String> = rows
                    .iter()
                    .map(|row| with_unit(row.doc, row.unit))
                    .collect();
                lines.dedup();
                lines.join("  \n")
            }
            Self::Property(field) => field.doc.into(),
            Self::Builtin(row) => builtin_text(row),
            Self::Class(class) => class.doc().into(),
            Self::Constant(row) => row.doc.into(),
            Self::Word(word) => word.doc.into(),
        }
    }

    /// Both, for a hover.
    pub fn markdown(&self) -> String {
        let (code, text) = (self.code(), self.text());
        let code = format!("```rgg\n{code}\n```");
        if text.is_empty() {
            code
        } else {
            format!("{code}\n\n{text}")
        }
    }
}

fn with_unit(doc: &str, unit: &str) -> String {
    if unit.is_empty() {
        doc.into()
    } else {
        format!("{doc} ({unit})")
    }
}

fn builtin_text(row: &BuiltinType) -> String {
    let mut text = row.doc.to_owned();
    let is_shown =
        |name: &str| !name.contains('.') || name.starts_with("transform.") || name == "width.full";
    for (at, field) in row
        .fields
        .iter()
        .filter(|field| is_shown(field.name))
        .enumerate()
    {
        text.push_str(if at == 0 { "\n\n" } else { "\n" });
        text.push_str(&format!(
            "- `{}`: {}",
            signature::property(field),
            field.doc
        ));
    }
    if !row.parent.is_empty() && row.parent != "Node" {
        text.push_str(&format!("\n\nExtends `{}`.", row.parent));
    }
    text
}
