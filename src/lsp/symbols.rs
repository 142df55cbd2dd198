//! What the files of a model declare, with the remarks that stand beside it.

use super::place::Lines;
use crate::diag::Span;
use crate::syntax::ast::{self, Item, ModuleParam, TypeRef};
use std::ops::Range;
use std::sync::Arc;

/// What a symbol is.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum SymbolKind {
    /// A module.
    Module,
    /// A class or interface.
    Class,
    /// A method.
    Method,
    /// A field or parameter of a module.
    Field,
    /// A variable of the model.
    Variable,
}

/// A declaration.
#[derive(Clone, Debug)]
pub struct Symbol {
    /// Its name.
    pub name: String,
    /// What it is.
    pub kind: SymbolKind,
    /// Its name in the declaration.
    pub name_span: Span,
    /// The whole declaration.
    pub span: Span,
    /// How it is used, as one line.
    pub signature: String,
    /// The remarks above or beside it.
    pub doc: String,
    /// The module it is a member of.
    pub owner: Option<Arc<str>>,
}

/// The declarations of a file, members behind their modules.
pub fn of_file(text: &str, ast: &ast::File) -> Vec<Symbol> {
    let mut gatherer = Gatherer {
        text,
        lines: Lines::of(text),
        found: vec![],
    };
    for item in &ast.items {
        gatherer.item(item, None);
    }
    gatherer.found
}

struct Gatherer<'t> {
    text: &'t str,
    lines: Lines,
    found: Vec<Symbol>,
}

impl Gatherer<'_> {
    fn slice(&self, span: Span) -> &str {
        self.text
            .get(span.start as usize..span.end as usize)
            .unwrap_or_default()
    }

    fn type_text(&self, ty: &TypeRef) -> String {
        one_line(self.slice(ty.span))
    }

    fn add(
        &mut self,
        kind: SymbolKind,
        name: &ast::Ident,
        span: Span,
        signature: String,
        owner: Option<&Arc<str>>,
    ) {
        let doc = self.doc(span);
        self.found.push(Symbol {
            name: name.name.clone(),
            kind,
            name_span: name.span,
            span,
            signature,
            doc,
            owner: owner.cloned(),
        });
    }

    fn item(&mut self, item: &Item, owner: Option<&Arc<str>>) {
        match item {
            Item::Module(module) => self.module(module),
            Item::Method(method) => self.method(method, owner),
            Item::Field(field) => {
                let is_of_node = owner.is_some() && !field.modifiers.is_static;
                let kind = if is_of_node {
                    SymbolKind::Field
                } else {
                    SymbolKind::Variable
                };
                let word = if field.modifiers.is_final {
                    "const "
                } else {
                    ""
                };
                let value = field
                    .init
                    .as_ref()
                    .map(|init| one_line(self.slice(init.span)));
                let value = value.map_or_else(String::new, |value| format!(" = {value}"));
                let ty = self.type_text(&field.ty);
                let signature = format!("{word}{ty} {}{value}", field.name.name);
                self.add(
                    kind,
                    &field.name,
                    field.ty.span.to(field.name.span),
                    signature,
                    owner,
                );
            }
            Item::Class(class) => self.class(class),
            Item::Initializer { .. } => {}
        }
    }

    fn class(&mut self, class: &ast::Class) {
        let extends = class
            .extends
            .as_ref()
            .map(|ty| format!(" extends {}", self.type_text(ty)));
        let (word, name) = (&class.keyword.name, &class.name.name);
        let signature = format!("{word} {name}{}", extends.unwrap_or_default());
        self.add(SymbolKind::Class, &class.name, class.span, signature, None);
        let owner: Arc<str> = name.as_str().into();
        for item in &class.members {
            self.item(item, Some(&owner));
        }
    }

    fn module(&mut self, module: &ast::Module) {
        let params: Vec<String> = module
            .params
            .iter()
            .map(|param| self.param(param))
            .collect();
        let params = if params.is_empty() {
            String::new()
        } else {
            format!("({})", params.join(", "))
        };
        let extends = module.extends.as_ref().map_or_else(String::new, |extends| {
            let args = extends.args.as_deref().unwrap_or_default();
            let args: Vec<String> = args
                .iter()
                .map(|arg| one_line(self.slice(arg.span)))
                .collect();
            let args = if args.is_empty() {
                String::new()
            } else {
                format!("({})", args.join(", "))
            };
            format!(" extends {}{args}", self.type_text(&extends.parent))
        });
        let word = if module.modifiers.is_abstract {
            "abstract "
        } else {
            ""
        };
        let signature = format!("{word}module {}{params}{extends}", module.name.name);
        self.add(
            SymbolKind::Module,
            &module.name,
            module.span,
            signature,
            None,
        );
        let owner: Arc<str> = module.name.name.as_str().into();
        for param in &module.params {
            if let ModuleParam::Field { ty, name, .. } = param {
                let signature = self.param(param);
                self.add(
                    SymbolKind::Field,
                    name,
                    ty.span.to(name.span),
                    signature,
                    Some(&owner),
                );
            }
        }
        for item in &module.members {
            self.item(item, Some(&owner));
        }
    }

    fn param(&self, param: &ModuleParam) -> String {
        match param {
            ModuleParam::Field { ty, name, default } => {
                let value = default
                    .as_ref()
                    .map(|value| one_line(self.slice(value.span)));
                let value = value.map_or_else(String::new, |value| format!(" = {value}"));
                format!("{} {}{value}", self.type_text(ty), name.name)
            }
            ModuleParam::Super(name) => format!("super.{}", name.name),
        }
    }

    fn method(&mut self, method: &ast::Method, owner: Option<&Arc<str>>) {
        let params = method.params.iter().map(|param| {
            let dots = if param.is_varargs { "..." } else { "" };
            format!("{}{dots} {}", self.type_text(&param.ty), param.name.name)
        });
        let params: Vec<String> = params.collect();
        let result = method
            .result
            .as_ref()
            .map_or_else(String::new, |ty| self.type_text(ty));
        let place = owner.map_or_else(String::new, |owner| format!("{owner}."));
        let signature = format!(
            "{result} {place}{}({})",
            method.name.name,
            params.join(", ")
        );
        self.add(
            SymbolKind::Method,
            &method.name,
            method.span,
            signature.trim().into(),
            owner,
        );
    }

    /// The remarks directly above a declaration; else the one behind it on its line.
    fn doc(&self, span: Span) -> String {
        let line = self.lines.line(span.start as usize);
        // What stands above a line belongs to what the line begins with.
        let start = self.lines.bytes(self.text, line).start;
        let before = self
            .text
            .get(start..span.start as usize)
            .unwrap_or_default();
        if before.contains(['(', '{', ';', ',']) {
            return self.remark_behind(span);
        }
        let mut above = vec![];
        let mut at = line;
        while at > 0 && self.is_remark(at - 1, !above.is_empty()) {
            at -= 1;
            above.push(at);
        }
        above.reverse();
        let text = above.into_iter().map(|line| remark_text(self.line(line)));
        let text = text.collect::<Vec<_>>().join("\n");
        let text = text.trim();
        if text.is_empty() {
            self.remark_behind(span)
        } else {
            text.to_owned()
        }
    }

    fn line(&self, line: usize) -> &str {
        self.text
            .get(self.lines.bytes(self.text, line))
            .unwrap_or_default()
            .trim()
    }

    /// Whether a line is a remark and nothing else; inside of `/* … */` only if a line below was one.
    fn is_remark(&self, line: usize, is_inside: bool) -> bool {
        let text = self.line(line);
        let is_block = |text: &str| text.starts_with("/*") || text.ends_with("*/");
        text.starts_with("//")
            || (is_block(text) && !text.contains(';'))
            || (is_inside && text.starts_with('*') && !text.is_empty())
    }

    fn remark_behind(&self, span: Span) -> String {
        let end: Range<usize> = self
            .lines
            .bytes(self.text, self.lines.line(span.end as usize));
        let rest = self
            .text
            .get(span.end as usize..end.end)
            .unwrap_or_default();
        let is_last =
            |before: &str| !before.contains([';', '{']) || before.trim_end().ends_with(';');
        match rest.split_once("//") {
            Some((before, remark)) if is_last(before) && before.matches(';').count() < 2 => {
                remark.trim().into()
            }
            _ => String::new(),
        }
    }
}

fn one_line(text: &str) -> String {
    text.split_whitespace().collect::<Vec<_>>().join(" ")
}

/// A line of a remark without its marks.
fn remark_text(line: &str) -> &str {
    let line = line.trim_start_matches('/').trim_start_matches('*');
    line.trim_end_matches("*/").trim_end_matches('*').trim()
}

#[cfg(test)]
mod tests {
    use super::*;

    fn shown(text: &str) -> Vec<String> {
        let (ast, _) = crate::syntax::parse(crate::diag::FileId(0), text);
        let symbols = of_file(text, &ast);
        symbols
            .iter()
            .map(|s| {
                format!(
                    "{:?} {} | {}",
                    s.kind,
                    s.signature,
                    s.doc.replace('\n', " / ")
                )
            })
            .collect()
    }

    #[test]
    fn declarations_have_their_remarks() {
        let text = "\
// A leaf.
// It falls.
module Leaf(float size, super.length) extends Box(size, 1) {
    int age = 0;   // in days
    /* Ages
     * it. */
    void older(int days) { age += days; }
}

const float K = 0.5; // extinction
int a; int b;

// Nothing follows this.

public void run(int... n) [ ]
// A pair.
class Pair extends Node { int a; }
";
        assert_eq!(
            shown(text),
            [
                "Module module Leaf(float size, super.length) extends Box(size, 1) | A leaf. / It falls.",
                "Field float size | ",
                "Field int age = 0 | in days",
                "Method void Leaf.older(int days) | Ages / it.",
                "Variable const float K = 0.5 | extinction",
                "Variable int a | ",
                "Variable int b | ",
                "Method void run(int... n) | ",
                "Class class Pair extends Node | A pair.",
                "Field int a | ",
            ]
        );
    }
}
