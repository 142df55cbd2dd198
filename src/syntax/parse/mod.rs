//! Pairs of the pest grammar → syntax tree. This module and its children are the only ones that name grammar rules.
//!
//! Speed: scanning, reading and building the tree together take 1 s for 6 to 7 MB of models (one core of an AMD EPYC,
//! `cargo bench --bench growth -- parse` prints it), and a broken model of 1 kB takes 0.35 ms with its diagnostics. Nearly all
//! of that is pest, which pays about 15 ns for each rule, sequence, repetition and look-ahead it tries; so the grammar asks
//! for the first character before it tries many rules, and reads names once where rules that begin alike need them.

mod expr;
mod item;
mod literal;
mod rule;
mod stmt;

use super::ast::{Block, Expr, ExprKind, File, Ident, Stmt, StmtKind, TypeRef};
use super::scan::Scan;
use crate::diag::{Diagnostic, Diagnostics, FileId, Span};
use grammar::{Rgg, Rule};
use pest::Parser as _;
use pest::error::ErrorVariant;
use pest::iterators::Pair;
use std::cell::{Cell, RefCell};
use std::sync::{Mutex, PoisonError};

#[allow(
    missing_docs,
    unreachable_pub,
    reason = "generated from grammar/rgg.pest, where each rule is explained"
)]
mod grammar {
    /// The parser generated from the grammar.
    #[derive(pest_derive::Parser)]
    #[grammar = "../grammar/rgg.pest"]
    pub(super) struct Rgg;
}

/// What a piece of text should be.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Unit {
    /// A declaration, an import, or a stray `;`.
    Item,
    /// A statement.
    Statement,
    /// A rule or a statement between rules.
    RuleItem,
}

/// How far a piece of text could be read.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Reach {
    /// All of it is fine.
    All,
    /// It is fine up to this byte.
    Byte(usize),
    /// The stack would not have sufficed.
    TooDeep,
}

/// Reads pieces of one file.
pub(super) struct Reader<'s> {
    file: FileId,
    /// Byte at which the piece being read begins in its file.
    base: Cell<usize>,
    scan: &'s Scan,
    diagnostics: RefCell<Diagnostics>,
    /// Place of a `2147483648` whose minus sign has not been met yet.
    lone_minimum: Cell<Option<Span>>,
}

impl<'s> Reader<'s> {
    /// A reader for the text that was scanned.
    pub(super) fn new(file: FileId, scan: &'s Scan) -> Self {
        Self {
            file,
            base: Cell::new(0),
            scan,
            diagnostics: RefCell::default(),
            lone_minimum: Cell::new(None),
        }
    }

    /// Reads a whole file; `None` if it does not follow the grammar.
    pub(super) fn file(self, text: &str) -> Option<(File, Diagnostics)> {
        let pair = Rgg::parse(Rule::file, text).ok()?.next()?;
        let mut file = File::default();
        self.items(pair, &mut file);
        Some((file, self.diagnostics.into_inner()))
    }

    /// Reads one declaration that begins at byte `base` of the file into `file`; says whether it follows the grammar.
    pub(super) fn item_at(&self, base: usize, text: &str, file: &mut File) -> bool {
        let Ok(mut pairs) = Rgg::parse(Rule::single_item, text) else {
            return false;
        };
        self.base.set(base);
        if let Some(pair) = pairs.next() {
            self.items(pair, file);
        }
        true
    }

    /// What was wrong with numbers, characters and sizes in what was read.
    pub(super) fn into_diagnostics(self) -> Diagnostics {
        self.diagnostics.into_inner()
    }

    fn items(&self, pair: Pair<'_, Rule>, file: &mut File) {
        for kid in kids(pair) {
            match kid.as_rule() {
                Rule::import => file.imports.push(self.import(kid)),
                Rule::item => self.item(kid, &mut file.items),
                _ => {}
            }
        }
    }

    fn report(&self, diagnostic: Diagnostic) {
        self.diagnostics.borrow_mut().push(diagnostic);
    }

    /// The place of a pair, without the blanks behind it that pest counts in.
    fn span(&self, pair: &Pair<'_, Rule>) -> Span {
        let span = pair.as_span();
        let base = self.base.get();
        let (start, mut end) = (base + span.start(), base + span.end());
        let last = span.as_str().as_bytes().last().copied().unwrap_or(b' ');
        if last == b' ' {
            end = self.scan.last_end_before(end).max(start);
        }
        Span::new(self.file, start, end)
    }

    fn ident(&self, pair: &Pair<'_, Rule>) -> Ident {
        Ident {
            name: pair.as_str().trim_end().to_owned(),
            span: self.span(pair),
        }
    }

    /// The first name among the children of `pair`.
    fn first_ident(&self, pair: &Pair<'_, Rule>) -> Ident {
        let first = pair
            .clone()
            .into_inner()
            .find(|kid| kid.as_rule() == Rule::ident);
        self.ident(first.as_ref().unwrap_or(pair))
    }

    /// A type from its parts: a built-in name or a qualified one, arguments, dimensions.
    fn type_ref(&self, pair: Pair<'_, Rule>) -> TypeRef {
        let span = self.span(&pair);
        let mut ty = TypeRef {
            path: vec![],
            args: vec![],
            dims: 0,
            span,
        };
        for kid in kids(pair) {
            match kid.as_rule() {
                Rule::dim => ty.dims = ty.dims.saturating_add(1),
                Rule::primitive | Rule::qualified => ty.path = self.path(kid),
                Rule::type_args => ty.args = self.type_args(kid),
                _ => {}
            }
        }
        ty
    }

    /// The arguments of a generic type, at any depth.
    fn type_args(&self, pair: Pair<'_, Rule>) -> Vec<TypeRef> {
        kids(pair).map(|arg| self.type_arg(arg)).collect()
    }

    fn type_arg(&self, pair: Pair<'_, Rule>) -> TypeRef {
        let span = self.span(&pair);
        let mut ty = TypeRef {
            path: vec![],
            args: vec![],
            dims: 0,
            span,
        };
        for kid in kids(pair) {
            match kid.as_rule() {
                Rule::dim => ty.dims = ty.dims.saturating_add(1),
                Rule::primitive | Rule::qualified => ty.path = self.path(kid),
                Rule::inner_args | Rule::innermost_args => ty.args = self.type_args(kid),
                _ => {}
            }
        }
        ty
    }

    /// A type from a built-in or a qualified name alone.
    fn plain_type(&self, pair: Pair<'_, Rule>) -> TypeRef {
        let span = self.span(&pair);
        TypeRef {
            path: self.path(pair),
            args: vec![],
            dims: 0,
            span,
        }
    }

    fn path(&self, pair: Pair<'_, Rule>) -> Vec<Ident> {
        if pair.as_rule() == Rule::qualified {
            pair.into_inner().map(|part| self.ident(&part)).collect()
        } else {
            vec![self.ident(&pair)]
        }
    }

    fn block(&self, pair: Pair<'_, Rule>) -> Block {
        let span = self.span(&pair);
        Block {
            stmts: kids(pair).map(|kid| self.statement(kid)).collect(),
            span,
        }
    }

    fn expr_stmt(expr: Expr) -> Stmt {
        Stmt {
            span: expr.span,
            kind: StmtKind::Expr(expr),
        }
    }

    fn broken(span: Span) -> Expr {
        Expr {
            kind: ExprKind::Broken,
            span,
        }
    }
}

/// The children of a pair without keywords and the end of the file.
fn kids(pair: Pair<'_, Rule>) -> impl Iterator<Item = Pair<'_, Rule>> {
    pair.into_inner().filter(|kid| !is_keyword(kid.as_rule()))
}

fn is_keyword(which: Rule) -> bool {
    use Rule as R;
    matches!(
        which,
        R::EOI
            | R::kw_assert
            | R::kw_break
            | R::kw_case
            | R::kw_catch
            | R::kw_class
            | R::kw_continue
            | R::kw_default
            | R::kw_do
            | R::kw_else
            | R::kw_enum
            | R::kw_extends
            | R::kw_finally
            | R::kw_for
            | R::kw_if
            | R::kw_implements
            | R::kw_import
            | R::kw_instanceof
            | R::kw_interface
            | R::kw_module
            | R::kw_new
            | R::kw_package
            | R::kw_return
            | R::kw_static
            | R::kw_super
            | R::kw_switch
            | R::kw_synchronized
            | R::kw_this
            | R::kw_throw
            | R::kw_throws
            | R::kw_try
            | R::kw_while
    )
}

impl Unit {
    fn rule(self) -> Rule {
        match self {
            Self::Item => Rule::single_item,
            Self::Statement => Rule::single_statement,
            Self::RuleItem => Rule::single_rule_item,
        }
    }
}

/// Whether all of `text` can be read as one `unit`.
pub(super) fn reads(unit: Unit, text: &str) -> bool {
    Rgg::parse(unit.rule(), text).is_ok()
}

/// How far `text` can be read as one `unit`.
///
/// pest keeps the furthest byte only while its process-wide switch for detailed errors is on, which makes all parsing
/// several times slower; so the switch is on only while this function runs, one caller at a time, and it is for texts
/// that [`reads`] refused.
pub(super) fn reach(unit: Unit, text: &str) -> Reach {
    static SWITCH: Mutex<()> = Mutex::new(());
    let _guard = SWITCH.lock().unwrap_or_else(PoisonError::into_inner);
    pest::set_error_detail(true);
    let result = Rgg::parse(unit.rule(), text);
    pest::set_error_detail(false);
    match result {
        Ok(_) => Reach::All,
        Err(error) if matches!(error.variant, ErrorVariant::CustomError { .. }) => Reach::TooDeep,
        Err(error) => Reach::Byte(
            error
                .parse_attempts()
                .map_or(0, |attempts| attempts.max_position),
        ),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    const GRAMMAR: &str = include_str!("../../../grammar/rgg.pest");

    /// Names of rules with the example in the comment above each.
    fn rules_with_examples() -> Vec<(&'static str, Option<&'static str>)> {
        let mut example = None;
        let mut found = vec![];
        for line in GRAMMAR.lines() {
            if let Some(text) = line.strip_prefix("// e.g. ") {
                example = Some(text);
            } else if let Some((name, _)) = line.split_once(" = ")
                && name.chars().all(|c| c.is_ascii_alphanumeric() || c == '_')
            {
                found.push((name, example.take()));
            }
        }
        found
    }

    #[test]
    fn every_rule_reads_its_own_example() {
        let rules = rules_with_examples();
        assert!(rules.len() > 150, "{}", rules.len());
        for (name, example) in rules {
            if name == "WHITESPACE" {
                continue;
            }
            let example = example.unwrap_or_else(|| panic!("`{name}` has no example"));
            // Silent rules are no variants that could be parsed alone; they are covered by those that use them.
            let Some(&start) = Rule::all_rules().iter().find(|r| format!("{r:?}") == name) else {
                continue;
            };
            let is_silent = GRAMMAR.contains(&format!("\n{name} = _"));
            match Rgg::parse(start, example) {
                Ok(mut pairs) => {
                    let read = pairs.next().map_or(0, |pair| pair.as_span().end());
                    assert!(
                        is_silent || read == example.len(),
                        "`{name}` reads {read} bytes of `{example}`"
                    );
                }
                Err(error) => panic!("`{name}` does not read `{example}`: {error}"),
            }
        }
    }
}
