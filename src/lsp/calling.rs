//! What can be passed where a call is being typed.

use super::cursor::Cursor;
use super::meaning::{self, Thing};
use super::symbols::{Symbol, SymbolKind};
use super::workspace::{Analysis, FileView};
use crate::library::{Signature, constructors_of};
use crate::manual::signature;
use crate::turtle::BuiltinType;
use lsp_types::{
    Documentation, ParameterInformation, ParameterLabel, SignatureHelp, SignatureInformation,
};

/// One way of calling something: `F(float length, float diameter)`, its parameters with their meaning, its own meaning.
struct Form {
    label: String,
    params: Vec<(String, String)>,
    doc: String,
}

/// The ways of calling what stands before the innermost parenthesis that is open at byte `at`.
pub fn help(analysis: &Analysis, file: &FileView, at: usize) -> Option<SignatureHelp> {
    let text = &*file.text;
    let cursor = Cursor::new(text, at);
    if !cursor.is_code {
        return None;
    }
    let (open, name_end) = cursor.open.iter().rev().find_map(|&(open, closing)| {
        let head = text[..open].trim_end();
        let is_call = closing == ")" && head.ends_with(super::cursor::is_word);
        is_call.then_some((open, head.len()))
    })?;
    // Code in braces inside of a call is no part of its arguments.
    let inner = cursor.open.iter().filter(|(at, _)| *at > open);
    if inner.into_iter().any(|(_, closing)| *closing == "}") {
        return None;
    }
    let (_, thing) = meaning::at(analysis, file, name_end)?;
    let forms = forms(analysis, &thing);
    let number = super::cursor::commas(&text[open + 1..at.max(open + 1)]);
    let fitting = forms.iter().position(|form| form.params.len() > number);
    let active = fitting.or(forms.len().checked_sub(1))?;
    Some(SignatureHelp {
        signatures: forms.into_iter().map(Form::information).collect(),
        active_signature: u32::try_from(active).ok(),
        active_parameter: u32::try_from(number).ok(),
    })
}

fn forms(analysis: &Analysis, thing: &Thing<'_>) -> Vec<Form> {
    match thing {
        Thing::Symbol(symbol) if symbol.kind == SymbolKind::Method => {
            let same = |other: &&Symbol| {
                other.name == symbol.name
                    && other.kind == symbol.kind
                    && other.owner == symbol.owner
            };
            analysis.symbols().filter(same).map(of_symbol).collect()
        }
        Thing::Symbol(symbol) if symbol.kind == SymbolKind::Class => {
            let is_constructor = |other: &&Symbol| {
                other.name == symbol.name && other.owner.as_deref() == Some(&*symbol.name)
            };
            let constructors = analysis.symbols().filter(is_constructor);
            constructors.map(of_symbol).collect()
        }
        Thing::Symbol(symbol) => vec![of_symbol(symbol)],
        Thing::Library(rows) => rows.iter().copied().map(of_row).collect(),
        Thing::Builtin(row) => of_builtin(row),
        Thing::Class(class) => {
            let rows = constructors_of(*class).iter().map(|id| id.signature());
            rows.map(of_row).collect()
        }
        Thing::Word(word) => vec![Form {
            label: word.form.into(),
            params: vec![],
            doc: word.doc.into(),
        }],
        Thing::Local(_) | Thing::File(_) | Thing::Property(_) | Thing::Constant(_) => vec![],
    }
}

/// What the model declares: the parameters stand in its signature.
fn of_symbol(symbol: &Symbol) -> Form {
    let label = symbol.signature.clone();
    let inside = label
        .split_once('(')
        .and_then(|(_, rest)| Some(rest.split_once(')')?.0));
    let params = inside.unwrap_or_default().split(',').map(str::trim);
    let params = params.filter(|param| !param.is_empty());
    Form {
        params: params
            .map(|param| (param.to_owned(), String::new()))
            .collect(),
        label,
        doc: symbol.doc.clone(),
    }
}

fn of_row(row: &'static Signature) -> Form {
    let params = signature::params(row).into_iter();
    let unit = if row.unit.is_empty() {
        String::new()
    } else {
        format!(" ({})", row.unit)
    };
    Form {
        label: signature::call(row),
        params: params.map(|param| (param, String::new())).collect(),
        doc: format!("{}{unit}", row.doc),
    }
}

fn of_builtin(row: &'static BuiltinType) -> Vec<Form> {
    let form = |fields: Vec<&'static crate::turtle::BuiltinField>| {
        let typed = |field: &&crate::turtle::BuiltinField| {
            let (ty, name) = (
                signature::field_type_name(field.ty),
                signature::field_name(field.name),
            );
            let unit = if field.unit.is_empty() {
                String::new()
            } else {
                format!(" ({})", field.unit)
            };
            (format!("{ty} {name}"), format!("{}{unit}", field.doc))
        };
        let params: Vec<(String, String)> = fields.iter().map(typed).collect();
        let names: Vec<&str> = params.iter().map(|(param, _)| param.as_str()).collect();
        Form {
            label: format!("{}({})", row.name, names.join(", ")),
            params,
            doc: row.doc.into(),
        }
    };
    signature::constructor_fields(row)
        .into_iter()
        .map(form)
        .collect()
}

impl Form {
    fn information(self) -> SignatureInformation {
        let words = |text: String| (!text.is_empty()).then_some(Documentation::String(text));
        let params = self
            .params
            .into_iter()
            .map(|(label, doc)| ParameterInformation {
                label: ParameterLabel::Simple(label),
                documentation: words(doc),
            });
        SignatureInformation {
            label: self.label,
            documentation: words(self.doc),
            parameters: Some(params.collect()),
            active_parameter: None,
        }
    }
}
