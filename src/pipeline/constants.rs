//! The numbers at the head of a model's files (`const float ANGLE = 22.5;`): finding them, and giving them other values.
//!
//! A value is changed in the text, in the place of the number alone. A model that was changed so is in everything, its hash
//! included, the model that is there once the change is written into its file.

use super::inputs::class_name;
use super::sources::placeless;
use crate::diag::{Diagnostic, FileId, SourceMap, Span, nearest};
use crate::syntax::ast::{self, Expr, ExprKind, Item, Literal, UnaryOp};
use std::path::Path;

/// What kind of number it is.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Kind {
    /// A whole number.
    Whole,
    /// A real one.
    Real,
}

/// A `const` or `static` number of a model.
#[derive(Clone, Debug, PartialEq)]
pub struct Constant {
    /// The class of its file.
    pub class: String,
    /// Its name.
    pub name: String,
    /// What kind of number it may be.
    pub kind: Kind,
    /// Its place: the number, with its sign.
    pub span: Span,
    /// The number as it is written.
    pub text: String,
    /// The remark behind it in its line; may be empty.
    pub remark: String,
}

/// A wish that a constant be another number: `ANGLE` or `Bush.ANGLE`, and the number.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Change {
    /// Which one.
    pub name: String,
    /// The number, as it is to be written.
    pub text: String,
}

impl Change {
    /// Reads `NAME=NUMBER`.
    ///
    /// # Errors
    /// If it is not written so.
    pub fn parse(text: &str) -> Result<Self, String> {
        let parts = text
            .split_once('=')
            .map(|(name, number)| (name.trim(), number.trim()));
        match parts {
            Some((name, number)) if !name.is_empty() && !number.is_empty() => Ok(Self {
                name: name.to_owned(),
                text: number.to_owned(),
            }),
            _ => Err(format!("`{text}` is not NAME=NUMBER")),
        }
    }
}

impl Constant {
    /// Its name with that of its class, which no other has.
    pub fn id(&self) -> String {
        format!("{}.{}", self.class, self.name)
    }

    /// Whether `name` means it.
    pub fn is_called(&self, name: &str) -> bool {
        name == self.name || name == self.id()
    }

    /// `text` as it is written in the place of this number.
    fn written(&self, text: &str) -> Result<String, String> {
        let refuse = |what: &str| Err(format!("`{}` is {what}, not `{text}`", self.id()));
        match self.kind {
            Kind::Whole => match text.parse::<i32>() {
                Ok(number) => Ok(number.to_string()),
                Err(_) => refuse("a whole number"),
            },
            Kind::Real => match text.parse::<f64>() {
                // Debug form: the shortest text that means this number, always with a point or an exponent.
                Ok(number) if number.is_finite() => Ok(format!("{number:?}")),
                _ => refuse("a number"),
            },
        }
    }
}

/// The constants of these files, in the order in which they are written. Files with errors have those that could be read.
pub fn find(map: &SourceMap, files: &[FileId]) -> Vec<Constant> {
    let mut found = Vec::new();
    for &id in files {
        let Some(file) = map.file(id) else { continue };
        let (tree, _) = crate::syntax::parse(id, &file.text);
        let class = class_name(Path::new(&*file.name));
        for item in &tree.items {
            if let Item::Field(field) = item {
                found.extend(constant(&class, field, &file.text));
            }
        }
    }
    found
}

fn constant(class: &str, field: &ast::Field, text: &str) -> Option<Constant> {
    let modifiers = &field.modifiers;
    if !(modifiers.is_static || modifiers.is_final) || field.ty.dims > 0 {
        return None;
    }
    let [ty] = field.ty.path.as_slice() else {
        return None;
    };
    let kind = match ty.name.as_str() {
        "int" => Kind::Whole,
        "float" | "double" => Kind::Real,
        _ => return None,
    };
    let init = field.init.as_ref()?;
    let span = init.span;
    let literal = text.get(span.start as usize..span.end as usize)?;
    is_number(init).then(|| Constant {
        class: class.to_owned(),
        name: field.name.name.clone(),
        kind,
        span,
        text: literal.to_owned(),
        remark: remark(text, span.end as usize),
    })
}

/// Whether an expression is a number as it stands, perhaps with a sign.
fn is_number(expr: &Expr) -> bool {
    match &expr.kind {
        ExprKind::Literal(literal) => matches!(
            literal,
            Literal::Int(_) | Literal::Float(_) | Literal::Double(_)
        ),
        ExprKind::Unary(UnaryOp::Minus, inner) => {
            matches!(inner.kind, ExprKind::Literal(_)) && is_number(inner)
        }
        _ => false,
    }
}

/// The remark that follows in the line of byte `at`.
fn remark(text: &str, at: usize) -> String {
    let line = text[at..].lines().next().unwrap_or("");
    let remark = line.split_once("//").map_or("", |(_, remark)| remark);
    remark.trim().to_owned()
}

/// Changes constants in the texts of these files.
///
/// # Errors
/// If there is no such constant, more than one, or the number is none for it.
pub(super) fn change(
    map: &mut SourceMap,
    files: &[FileId],
    changes: &[Change],
) -> Result<(), Box<Diagnostic>> {
    if changes.is_empty() {
        return Ok(());
    }
    let known = find(map, files);
    let mut edits = Vec::new();
    for change in changes {
        let mut fitting = known.iter().filter(|c| c.is_called(&change.name));
        let (first, second) = (fitting.next(), fitting.next());
        let constant = match (first, second) {
            (Some(one), None) => one,
            (Some(one), Some(other)) => return Err(Box::new(ambiguous(&change.name, one, other))),
            (None, _) => return Err(Box::new(unknown(&change.name, &known))),
        };
        let text = constant.written(&change.text);
        let text = text.map_err(|message| Box::new(placeless("constant-value", message)))?;
        edits.push((constant.span, text));
    }
    for &id in files {
        let here = edits.iter().filter(|(span, _)| span.file == id);
        let here: Vec<(Span, String)> = here.cloned().collect();
        let old = map.file(id).filter(|_| !here.is_empty());
        if let Some(new) = old.map(|file| edited(&file.text, &here)) {
            map.replace(id, new);
        }
    }
    Ok(())
}

fn unknown(name: &str, known: &[Constant]) -> Diagnostic {
    let message = format!("the model has no `const` or `static` number `{name}`");
    let fault = placeless("unknown-constant", message);
    match nearest(name, known.iter().map(|constant| constant.name.as_str())) {
        Some(near) => fault.hint(format!("did you mean `{near}`?")),
        None => fault
            .hint("numbers that are computed, or stand inside of modules, cannot be changed so"),
    }
}

fn ambiguous(name: &str, one: &Constant, other: &Constant) -> Diagnostic {
    let (one, other) = (one.id(), other.id());
    let message = format!("several numbers are called `{name}`");
    placeless("unknown-constant", message).hint(format!("write `{one}` or `{other}`"))
}

/// `text` with other numbers in these places, which must not overlap.
pub fn edited(text: &str, edits: &[(Span, String)]) -> String {
    let mut edits: Vec<&(Span, String)> = edits.iter().collect();
    edits.sort_by_key(|(span, _)| span.start);
    let mut out = String::with_capacity(text.len());
    let mut at = 0;
    for (span, number) in edits {
        out.push_str(&text[at..span.start as usize]);
        // `a-` before a negative number would read `a--`.
        if number.starts_with('-') && out.ends_with('-') {
            out.push(' ');
        }
        out.push_str(number);
        at = span.end as usize;
    }
    out.push_str(&text[at..]);
    out
}

/// `text`, the content of one file of the model, with these constants changed; nothing else in it differs.
///
/// # Errors
/// If a constant is not in it, or the number is none for it.
pub fn rewritten(name: &str, text: &str, changes: &[Change]) -> Result<String, String> {
    let mut map = SourceMap::default();
    let id = map.add(name, text);
    let known = find(&map, &[id]);
    let mut edits = Vec::new();
    for change in changes {
        let constant = known.iter().find(|c| c.is_called(&change.name));
        let constant =
            constant.ok_or_else(|| format!("`{}` is no longer in the file", change.name))?;
        edits.push((constant.span, constant.written(&change.text)?));
    }
    Ok(edited(text, &edits))
}

#[cfg(test)]
mod tests {
    use super::*;

    const TEXT: &str = "const float ANGLE = 22.5;   // degrees\nstatic int n = -3, m = 4;\nconst float X = 2 * 3;\n\
                        int loose = 1;\nconst int[] LIST = {1};\nmodule A { static int inside = 1; }\n";

    fn found() -> Vec<Constant> {
        let mut map = SourceMap::default();
        let id = map.add("d/Bush.rgg", TEXT);
        find(&map, &[id])
    }

    #[test]
    fn plain_numbers_of_the_file_are_found_with_their_remarks() {
        let found = found();
        let all: Vec<_> = found.iter().map(|c| (c.id(), &*c.text, c.kind)).collect();
        assert_eq!(
            all,
            [
                ("Bush.ANGLE".to_owned(), "22.5", Kind::Real),
                ("Bush.n".to_owned(), "-3", Kind::Whole),
                ("Bush.m".to_owned(), "4", Kind::Whole),
            ]
        );
        assert_eq!(found[0].remark, "degrees");
    }

    #[test]
    fn only_the_number_is_replaced() {
        let change = |name: &str, text: &str| Change {
            name: name.to_owned(),
            text: text.to_owned(),
        };
        let changes = [change("ANGLE", "30"), change("Bush.n", "17")];
        let new = rewritten("Bush.rgg", TEXT, &changes).unwrap();
        assert_eq!(new, TEXT.replace("22.5", "30.0").replace("-3", "17"));
        for (name, text) in [
            ("n", "1.5"),
            ("ANGLE", "inf"),
            ("loose", "2"),
            ("ANGLE", "1; x"),
        ] {
            assert!(rewritten("Bush.rgg", TEXT, &[change(name, text)]).is_err());
        }
    }

    #[test]
    fn a_change_is_a_name_and_a_number() {
        assert_eq!(Change::parse(" a.b = 3 ").unwrap().text, "3");
        assert!(Change::parse("a").is_err() && Change::parse("=3").is_err());
    }
}
