//! What could stand where something is being typed.
//!
//! The word at the cursor is replaced by a name that nothing is called ([`MARKER`]), the brackets that are still open are
//! closed, and the model is checked: the check notes what it knows when it meets the marker (locals in scope, the type in
//! front of a dot). The text need not be right for that, as what cannot be read is blanked out.

use super::cursor::Cursor;
use super::meaning::Thing;
use super::place::Lines;
use super::reading;
use super::symbols::{Symbol, SymbolKind};
use super::workspace::{Analysis, FileView};
use crate::check::model::{Model, Type};
use crate::check::{MARKER, Probe};
use crate::graph::TypeId;
use crate::library::{ClassId, FunctionId, MethodId, Signature, constants, field_named};
use crate::manual::signature;
use crate::manual::words::{AGGREGATES, KEYWORDS, Word};
use crate::turtle::{self, builtin_types};
use lsp_types::{
    CompletionItem, CompletionItemKind as Kind, Documentation, MarkupContent, MarkupKind,
};
use std::rc::Rc;

/// What comes first in the list.
#[derive(Clone, Copy)]
enum Rank {
    Local,
    Member,
    Model,
    Builtin,
    Function,
    Other,
    Keyword,
}

/// The words that could stand at byte `at` of a file.
pub fn complete(analysis: &Analysis, file: &FileView, at: usize) -> Vec<CompletionItem> {
    let text = &*file.text;
    let cursor = Cursor::new(text, at);
    let is_number = |c: char| c.is_ascii_digit();
    if !cursor.is_code || text[cursor.word.clone()].starts_with(is_number) {
        return vec![];
    }
    let before = cursor.before(text);
    let is_member = before.is_some_and(|(_, c)| c == '.');
    if is_member
        && cursor
            .qualifier(text)
            .is_some_and(|name| name.starts_with(is_number))
    {
        return vec![];
    }
    let probed = probe(analysis, file, &cursor);
    let (probe, model) = match &probed {
        Some((probe, at_probe)) => (Some(probe), &at_probe.model),
        None => (None, &analysis.model),
    };
    let mut list = List {
        analysis,
        model,
        items: vec![],
    };
    let object = probe.and_then(|probe| probe.object.clone());
    match object {
        Some(ty) => list.members(&ty, is_member),
        None if is_member => list.after_dot(file, cursor.qualifier(text)),
        None => list.everything(file, probe, at),
    }
    list.finish()
}

/// What the check knows at the cursor, and the check that knew it.
fn probe(analysis: &Analysis, file: &FileView, cursor: &Cursor) -> Option<(Probe, Analysis)> {
    let (head, tail) = (
        &file.text[..cursor.word.start],
        &file.text[cursor.word.end..],
    );
    let mut endings = endings(cursor);
    endings.dedup();
    endings.into_iter().find_map(|ending| {
        let text = format!("{head}{MARKER}{ending}{tail}");
        let reading = reading::read(file.id, &text);
        let marked = Rc::new(FileView {
            lines: Lines::of(&text),
            text: text.into(),
            reading,
            ..file.clone()
        });
        let files = analysis.files.iter().map(|other| {
            if other.id == file.id {
                marked.clone()
            } else {
                other.clone()
            }
        });
        let mut at_probe = Analysis::of(files.collect());
        let probe = at_probe.survey.probe.take()?;
        Some((probe, at_probe))
    })
}

/// What might be missing behind the cursor, most likely first: nothing, the end of the statement, brackets,
/// the arrow of a rule.
fn endings(cursor: &Cursor) -> Vec<String> {
    let own = cursor
        .open
        .iter()
        .filter(|(at, closing)| *at >= cursor.statement && *closing != "}");
    let own: Vec<&str> = own.rev().map(|(_, closing)| *closing).collect();
    let inner = own.iter().copied().take_while(|closing| *closing != "]");
    let mut endings = vec![
        String::new(),
        ";".into(),
        format!("{};", inner.collect::<String>()),
    ];
    endings.push(format!("{};", own.concat()));
    endings.push(format!("{} ==> ;", own.concat()));
    // Also the blocks, but not those of the method and its module.
    for n_outer in [2, 1] {
        let all = cursor
            .open
            .iter()
            .skip(n_outer)
            .rev()
            .map(|(_, closing)| *closing);
        let mut ending = String::new();
        for closing in all {
            ending.push_str(if closing == "}" { ";}" } else { closing });
        }
        endings.push(format!("{ending};"));
    }
    endings
}

struct List<'a> {
    analysis: &'a Analysis,
    model: &'a Model,
    items: Vec<CompletionItem>,
}

impl List<'_> {
    fn add(&mut self, rank: Rank, kind: Kind, label: &str, thing: &Thing<'_>) {
        self.push(rank, kind, label, &thing.code(), thing.text());
    }

    fn push(&mut self, rank: Rank, kind: Kind, label: &str, code: &str, doc: String) {
        let doc = MarkupContent {
            kind: MarkupKind::Markdown,
            value: doc,
        };
        self.items.push(CompletionItem {
            label: label.into(),
            kind: Some(kind),
            detail: code.lines().last().map(str::to_owned),
            documentation: (!doc.value.is_empty()).then_some(Documentation::MarkupContent(doc)),
            sort_text: Some(format!("{}{label}", rank as u8)),
            ..CompletionItem::default()
        });
    }

    /// Each name once, what came first in the list.
    fn finish(self) -> Vec<CompletionItem> {
        let mut seen = std::collections::BTreeSet::new();
        let is_new =
            |item: &CompletionItem| item.label != MARKER && seen.insert(item.label.clone());
        self.items.into_iter().filter(is_new).collect()
    }

    fn symbol(&mut self, rank: Rank, symbol: &Symbol) {
        let kind = match symbol.kind {
            SymbolKind::Module | SymbolKind::Class => Kind::CLASS,
            SymbolKind::Method if symbol.owner.is_some() => Kind::METHOD,
            SymbolKind::Method => Kind::FUNCTION,
            SymbolKind::Field => Kind::FIELD,
            SymbolKind::Variable => Kind::VARIABLE,
        };
        self.add(rank, kind, &symbol.name, &Thing::Symbol(symbol));
    }

    /// What can stand behind `x.` and, if there is no dot, in `x[ ]`.
    fn members(&mut self, ty: &Type, is_dot: bool) {
        match ty {
            Type::Node(id) => self.node_members(*id, is_dot),
            Type::Class(class) | Type::Generic(class, _) => self.class_members(*class),
            Type::String => self.methods_of(&["String", "Object"]),
            Type::Array(_) => self.push(
                Rank::Member,
                Kind::FIELD,
                "length",
                "int length",
                "Number of elements.".into(),
            ),
            _ => {}
        }
    }

    /// A type and those it extends.
    fn lineage(&self, id: TypeId) -> Vec<TypeId> {
        std::iter::successors(Some(id), |id| self.model.types[*id].parent).collect()
    }

    fn node_members(&mut self, id: TypeId, with_methods: bool) {
        let analysis = self.analysis;
        for id in self.lineage(id) {
            let name = self.model.types[id].name.to_string();
            let own = analysis
                .symbols()
                .filter(|s| s.owner.as_deref() == Some(&*name));
            for symbol in own.filter(|s| with_methods || s.kind == SymbolKind::Field) {
                self.symbol(Rank::Member, symbol);
            }
            let fields = turtle::builtin(id).map_or(&[][..], |row| row.fields);
            for field in fields.iter().filter(|field| !field.name.contains('.')) {
                self.add(
                    Rank::Builtin,
                    Kind::PROPERTY,
                    field.name,
                    &Thing::Property(field),
                );
            }
        }
    }

    /// `setShader(…)` and its kin, for `.( … )`.
    fn setters(&mut self, id: TypeId) {
        for id in self.lineage(id) {
            let fields = turtle::builtin(id).map_or(&[][..], |row| row.fields);
            for field in fields.iter().filter(|field| !field.name.contains('.')) {
                let mut letters = field.name.chars();
                let first = letters
                    .next()
                    .map_or(String::new(), |c| c.to_uppercase().to_string());
                let label = format!("set{first}{}", letters.as_str());
                let code = format!("{label}({})", signature::property(field));
                self.push(Rank::Local, Kind::METHOD, &label, &code, field.doc.into());
            }
            let names = [
                (
                    "shader",
                    "setColor",
                    "setColor(float, float, float)",
                    "A matt shader of this red, green and blue, 0..=1.",
                ),
                (
                    "transform.x",
                    "setTransform",
                    "setTransform(double, double, double)",
                    "Moves by this much along local x, y, z, in metres.",
                ),
            ];
            for (field, label, code, doc) in names {
                if fields.iter().any(|f| f.name == field) {
                    self.push(Rank::Local, Kind::METHOD, label, code, doc.into());
                }
            }
        }
    }

    fn class_members(&mut self, class: ClassId) {
        for id in MethodId::ALL
            .iter()
            .filter(|id| id.is_hidden() && id.signature().params.is_empty())
        {
            let row = id.signature();
            if field_named(class, row.name).is_some()
                && class.lineage().any(|c| c.name() == row.owner)
            {
                let code = format!("{} {}", signature::type_name(row.result), row.name);
                self.push(Rank::Member, Kind::FIELD, row.name, &code, row.doc.into());
            }
        }
        let owners: Vec<&str> = class
            .lineage()
            .map(ClassId::name)
            .chain(["Object"])
            .collect();
        self.methods_of(&owners);
    }

    fn methods_of(&mut self, owners: &[&str]) {
        let rows = MethodId::ALL
            .iter()
            .filter(|id| !id.is_hidden())
            .map(|id| id.signature());
        for row in rows.filter(|row| owners.contains(&row.owner)) {
            self.add(
                Rank::Member,
                Kind::METHOD,
                row.name,
                &Thing::Library(vec![row]),
            );
        }
    }

    /// Behind the dot of something that is no value: a class or a file; or a value in a text too broken to check.
    fn after_dot(&mut self, file: &FileView, qualifier: Option<&str>) {
        let Some(owner) = qualifier else { return };
        let analysis = self.analysis;
        let functions = FunctionId::ALL.iter().map(|id| id.signature());
        self.functions(functions.filter(|row| row.owner == owner), Rank::Member);
        let colors = ["RGBAShader", "Color"].contains(&owner);
        for row in constants()
            .iter()
            .filter(|row| row.owner == owner || (colors && row.owner.is_empty()))
        {
            self.add(Rank::Other, Kind::CONSTANT, row.name, &Thing::Constant(row));
        }
        if let Some(file) = analysis.files.iter().find(|file| file.name() == owner) {
            for symbol in file.symbols.iter().filter(|s| s.owner.is_none()) {
                self.symbol(Rank::Member, symbol);
            }
        }
        let locals = analysis.survey.locals.iter().rev();
        let local = locals
            .filter(|local| local.declared.file == file.id)
            .find(|local| local.name == owner);
        if let Some(ty) = local.and_then(|local| self.type_named(&local.ty)) {
            self.members(&ty, true);
        }
    }

    fn type_named(&self, name: &str) -> Option<Type> {
        let node = self.model.types.find(name).map(Type::Node);
        let class = || ClassId::named(name).map(Type::Class);
        node.or_else(class)
            .or_else(|| (name == "String").then_some(Type::String))
    }

    fn functions(&mut self, rows: impl Iterator<Item = &'static Signature>, rank: Rank) {
        for row in rows {
            self.add(rank, Kind::FUNCTION, row.name, &Thing::Library(vec![row]));
        }
    }

    fn words(&mut self, words: &'static [Word], rank: Rank, kind: Kind) {
        for word in words {
            self.add(rank, kind, word.name, &Thing::Word(word));
        }
    }

    /// All that can stand where nothing in particular is wanted.
    fn everything(&mut self, file: &FileView, probe: Option<&Probe>, at: usize) {
        let analysis = self.analysis;
        match probe {
            Some(probe) => self.in_scope(probe),
            None => self.nearby_locals(file, at),
        }
        for symbol in analysis.symbols().filter(|s| s.owner.is_none()) {
            self.symbol(Rank::Model, symbol);
        }
        for row in builtin_types() {
            self.add(Rank::Builtin, Kind::CLASS, row.name, &Thing::Builtin(row));
        }
        let functions = FunctionId::ALL.iter().map(|id| id.signature());
        let (own, of_classes): (Vec<_>, Vec<_>) = functions.partition(|row| row.owner.is_empty());
        self.functions(own.into_iter(), Rank::Function);
        self.words(AGGREGATES, Rank::Function, Kind::FUNCTION);
        for row in constants().iter().filter(|row| row.owner.is_empty()) {
            self.add(Rank::Other, Kind::CONSTANT, row.name, &Thing::Constant(row));
        }
        for &class in ClassId::ALL {
            self.add(Rank::Other, Kind::CLASS, class.name(), &Thing::Class(class));
        }
        for row in of_classes.iter().filter(|row| !row.owner.contains('.')) {
            self.push(
                Rank::Other,
                Kind::MODULE,
                row.owner,
                row.owner,
                String::new(),
            );
        }
        self.words(KEYWORDS, Rank::Keyword, Kind::KEYWORD);
    }

    fn in_scope(&mut self, probe: &Probe) {
        for ty in &probe.with {
            match ty {
                Type::Node(id) => {
                    self.setters(*id);
                    self.node_members(*id, true);
                }
                other => self.members(other, true),
            }
        }
        for (name, ty) in &probe.locals {
            let code = format!("{ty} {name}");
            self.push(
                Rank::Local,
                Kind::VARIABLE,
                name,
                code.trim(),
                String::new(),
            );
        }
        if let Some(this) = probe.this {
            self.node_members(this, true);
        }
    }

    /// Locals of the declaration that the place is in, for texts too broken to check.
    fn nearby_locals(&mut self, file: &FileView, at: usize) {
        let analysis = self.analysis;
        let begins = |symbol: &&Symbol| symbol.span.start as usize <= at;
        let inside = file
            .symbols
            .iter()
            .filter(|s| s.kind != SymbolKind::Field)
            .filter(begins);
        let start = inside.map(|s| s.span.start).max().unwrap_or(0);
        let is_near = |span: crate::diag::Span| {
            span.file == file.id && span.start >= start && (span.end as usize) < at
        };
        for local in analysis
            .survey
            .locals
            .iter()
            .filter(|local| is_near(local.declared))
        {
            self.add(
                Rank::Local,
                Kind::VARIABLE,
                &local.name,
                &Thing::Local(local),
            );
        }
    }
}
