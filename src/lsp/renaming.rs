//! Renaming what a model declares, in all its files, and finding where it is used.
//!
//! The check knows every use of variables, fields and methods; modules, whose names mean one thing wherever they stand, are
//! found by their name. A new name must be new to the model, and the renamed model is checked before anything is told
//! to the editor: it must hold the same names in the same places, without an error.

use super::cursor::words;
use super::meaning::{self, Thing};
use super::place::Lines;
use super::reading;
use super::symbols::{self, SymbolKind};
use super::workspace::{Analysis, FileView};
use crate::check::Meaning;
use crate::diag::Span;
use crate::library::{ClassId, FunctionId, constants};
use crate::manual::signature::builtin_named;
use crate::manual::words::word_named;
use lsp_types::TextEdit;
use std::collections::{BTreeMap, BTreeSet};
use std::ops::Range;
use std::rc::Rc;

/// Changes of texts, by the address of the file.
pub type Edits = BTreeMap<String, Vec<TextEdit>>;

/// The word at byte `at` and all places in the model that mean the same, its declaration among them, sorted.
pub fn occurrences(
    analysis: &Analysis,
    file: &FileView,
    at: usize,
) -> Option<(Range<usize>, Vec<Span>)> {
    let (word, thing) = meaning::at(analysis, file, at)?;
    let declared = match thing {
        Thing::Symbol(symbol) => symbol.name_span,
        Thing::Local(local) => local.declared,
        _ => return None,
    };
    let is_type = matches!(thing, Thing::Symbol(symbol)
        if matches!(symbol.kind, SymbolKind::Module | SymbolKind::Class));
    let declared = origin(analysis, declared);
    let name = text_of(analysis, declared)?;
    let mut found = BTreeSet::from([declared]);
    let mut open = vec![declared];
    while let Some(place) = open.pop() {
        open.extend(uses_of(analysis, place).filter(|used| found.insert(*used)));
    }
    if is_type {
        found.extend(named(analysis, &name));
    }
    // A use may begin where the name does and be longer, or stand for something that is spelt otherwise.
    found.retain(|span| text_of(analysis, *span).as_deref() == Some(&name));
    let own = Span::new(file.id, word.start, word.end);
    found
        .contains(&own)
        .then(|| (word, found.into_iter().collect()))
}

fn text_of(analysis: &Analysis, span: Span) -> Option<String> {
    let text = &analysis.file(span)?.text;
    text.get(span.start as usize..span.end as usize)
        .map(str::to_owned)
}

/// Where a name is declared first: `super.size` declares a parameter and is a use of the parent's field.
fn origin(analysis: &Analysis, declared: Span) -> Span {
    let uses = analysis.survey.uses.iter();
    let mut others = uses.filter_map(|(span, meaning)| match meaning {
        Meaning::Declared(at) if *span == declared && *at != declared => Some(*at),
        _ => None,
    });
    others.next().unwrap_or(declared)
}

/// The places that mean what is declared in this one.
fn uses_of(analysis: &Analysis, declared: Span) -> impl Iterator<Item = Span> {
    let uses = analysis.survey.uses.iter();
    uses.filter_map(move |(span, meaning)| match meaning {
        Meaning::Declared(at) if *at == declared => Some(*span),
        _ => None,
    })
}

/// The places of a name in code that mean no variable, field or method.
fn named(analysis: &Analysis, name: &str) -> Vec<Span> {
    let others: BTreeSet<Span> = {
        let uses = analysis.survey.uses.iter().map(|(span, _)| *span);
        let locals = analysis.survey.locals.iter().map(|local| local.declared);
        let is_type = |kind| matches!(kind, SymbolKind::Module | SymbolKind::Class);
        let members = analysis.symbols().filter(|s| {
            // A constructor has the name of its class.
            !is_type(s.kind) && s.owner.as_deref() != Some(name)
        });
        uses.chain(locals)
            .chain(members.map(|symbol| symbol.name_span))
            .collect()
    };
    let mut found = vec![];
    for file in &analysis.files {
        let places = words(&file.text).filter(|word| &file.text[word.clone()] == name);
        found.extend(places.map(|word| Span::new(file.id, word.start, word.end)));
    }
    found.retain(|span| !others.contains(span));
    found
}

/// The edits that give what stands at byte `at` the name `new`.
///
/// # Errors
/// Why it cannot have that name, as a sentence for the user.
pub fn rename(analysis: &Analysis, file: &FileView, at: usize, new: &str) -> Result<Edits, String> {
    if analysis.found.has_errors() {
        return Err("mend the errors of the model first: a name is safe to change only where all is understood".into());
    }
    let (word, places) =
        occurrences(analysis, file, at).ok_or("this is no name that the model declares")?;
    if file.text[word] == *new {
        return Ok(Edits::new());
    }
    check_name(analysis, new)?;
    let is_same = |span: &Span, file: &FileView| span.file == file.id;
    let renamed = analysis.files.iter().map(|file| {
        let own: Vec<Span> = places
            .iter()
            .filter(|span| is_same(span, file))
            .copied()
            .collect();
        if own.is_empty() {
            return file.clone();
        }
        let mut text = file.text.to_string();
        for span in own.iter().rev() {
            text.replace_range(span.start as usize..span.end as usize, new);
        }
        let reading = reading::read(file.id, &text);
        Rc::new(FileView {
            lines: Lines::of(&text),
            symbols: symbols::of_file(&text, &reading.ast),
            text: text.into(),
            reading,
            ..(**file).clone()
        })
    });
    let after = Analysis::of(renamed.collect());
    let sizes = |analysis: &Analysis| (analysis.survey.uses.len(), analysis.survey.locals.len());
    if after.found.has_errors() || sizes(&after) != sizes(analysis) {
        return Err(format!(
            "with the name `{new}` the model would no longer mean the same; nothing was changed"
        ));
    }
    let mut changes = Edits::new();
    for span in places {
        let Some(file) = analysis.file(span) else {
            continue;
        };
        let range = file
            .lines
            .range(&file.text, span.start as usize..span.end as usize);
        changes.entry(file.uri.clone()).or_default().push(TextEdit {
            range,
            new_text: new.to_owned(),
        });
    }
    Ok(changes)
}

/// Whether a name can be given: a name at all, and one that means nothing yet.
fn check_name(analysis: &Analysis, new: &str) -> Result<(), String> {
    let starts_well = new.starts_with(|c: char| c.is_alphabetic() || c == '_');
    if !starts_well || !new.chars().all(super::cursor::is_word) {
        return Err(format!(
            "`{new}` is no name: letters, digits and `_`, not beginning with a digit"
        ));
    }
    let is_library = builtin_named(new).is_some()
        || word_named(new).is_some()
        || ClassId::named(new).is_some()
        || constants().iter().any(|row| row.name == new)
        || FunctionId::ALL.iter().any(|id| id.signature().name == new);
    if is_library {
        return Err(format!("`{new}` has a meaning in the language already"));
    }
    for file in &analysis.files {
        let mut places = words(&file.text);
        if let Some(word) = places.find(|word| file.text[word.clone()] == *new) {
            let line = file.lines.line(word.start) + 1;
            return Err(format!(
                "`{new}` stands in {}.rgg already, at line {line}",
                file.name()
            ));
        }
    }
    Ok(())
}
