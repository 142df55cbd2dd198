//! Several values: queries, ranges, and the functions over them.
//!
//! `sum((* A *)[v] * 2)` is checked as the expression `x[v] * 2` with `x` standing for the query's values one after the
//! other: inside an aggregate (or the head of a `for`) a query is replaced by a slot, and what is around it becomes the body
//! of a [`Sequence::Map`].

use super::Checker;
use super::context::Collector;
use super::model::{Aggregate, Expr, ExprKind, Place, Selection, Sequence, Slot, Type};
use super::names::Target;
use super::types::{is_numeric, promote};
use crate::diag::{Diagnostic, Span};
use crate::library::ClassId;
use crate::syntax::ast;

/// Names of all functions over several values.
pub const NAMES: &[&str] = &[
    "sum",
    "prod",
    "count",
    "mean",
    "min",
    "max",
    "first",
    "last",
    "empty",
    "exist",
    "forall",
    "selectRandomly",
    "array",
    "string",
    "selectWhere",
    "selectWhereMin",
    "selectWhereMax",
];

fn aggregate_named(name: &str) -> Option<Aggregate> {
    Some(match name {
        "sum" => Aggregate::Sum,
        "prod" => Aggregate::Prod,
        "count" => Aggregate::Count,
        "mean" => Aggregate::Mean,
        "min" => Aggregate::Min,
        "max" => Aggregate::Max,
        "first" => Aggregate::First,
        "last" => Aggregate::Last,
        "empty" => Aggregate::Empty,
        "exist" => Aggregate::Exist,
        "forall" => Aggregate::Forall,
        "selectRandomly" => Aggregate::SelectRandomly,
        "array" => Aggregate::Array,
        "string" => Aggregate::String,
        _ => return None,
    })
}

impl Checker<'_> {
    /// A call of a function over several values; `None` if it is none.
    pub(super) fn aggregate_call(
        &mut self,
        name: &str,
        args: &[ast::Expr],
        span: Span,
    ) -> Option<Option<Expr>> {
        match (name, args) {
            ("selectWhere", [sequence, key]) => {
                Some(self.select_where(Selection::First, sequence, key, span))
            }
            ("selectWhereMin", [sequence, key]) => {
                Some(self.select_where(Selection::Least, sequence, key, span))
            }
            ("selectWhereMax", [sequence, key]) => {
                Some(self.select_where(Selection::Greatest, sequence, key, span))
            }
            (_, [sequence]) => {
                let aggregate = aggregate_named(name)?;
                self.cx.open();
                let sequence = self.sequence(sequence);
                self.cx.close();
                Some(sequence.and_then(|(sequence, element)| {
                    self.aggregate(name, aggregate, sequence, element, span)
                }))
            }
            _ => None,
        }
    }

    fn aggregate(
        &mut self,
        name: &str,
        aggregate: Aggregate,
        sequence: Sequence,
        element: Type,
        span: Span,
    ) -> Option<Expr> {
        let ty = match aggregate {
            Aggregate::Count => Type::Long,
            Aggregate::Empty | Aggregate::Exist => Type::Boolean,
            Aggregate::Forall if element == Type::Boolean => Type::Boolean,
            Aggregate::Sum
            | Aggregate::Prod
            | Aggregate::Mean
            | Aggregate::Min
            | Aggregate::Max
                if is_numeric(&element) =>
            {
                promote(&element)
            }
            Aggregate::First | Aggregate::Last | Aggregate::SelectRandomly
                if element != Type::Void =>
            {
                element.clone()
            }
            Aggregate::Array if element != Type::Void => Type::Array(Box::new(element.clone())),
            Aggregate::String => Type::String,
            _ => {
                let message = format!(
                    "`{name}` does not work on values of type `{}`",
                    self.type_name(&element)
                );
                let fault = Diagnostic::error("bad-aggregate", span, message);
                let is_node = matches!(element, Type::Node(_));
                self.report(if is_node {
                    fault.hint("name a property: `(* X *)[length]`")
                } else {
                    fault
                });
                return None;
            }
        };
        if aggregate == Aggregate::SelectRandomly {
            self.cx.facts.is_impure = true;
        }
        // Small integers are added as `int`.
        let sequence =
            if is_numeric(&element) && ty != element && is_numeric(&ty) && ty != Type::Long {
                self.converted(sequence, &element, &ty, span)
            } else {
                sequence
            };
        Some(Expr {
            kind: ExprKind::Aggregate(aggregate, Box::new(sequence)),
            ty,
            span,
        })
    }

    /// The sequence with each element converted from one type to another.
    pub(super) fn converted(
        &mut self,
        sequence: Sequence,
        from: &Type,
        to: &Type,
        span: Span,
    ) -> Sequence {
        let slot = self.cx.slot(from.clone(), span);
        let read = Expr {
            kind: ExprKind::Read(Place::Local(slot)),
            ty: from.clone(),
            span,
        };
        let body = self.convert(read, to);
        Sequence::Map {
            source: Box::new(sequence),
            slot,
            body: Box::new(body),
        }
    }

    fn select_where(
        &mut self,
        selection: Selection,
        sequence: &ast::Expr,
        key: &ast::Expr,
        span: Span,
    ) -> Option<Expr> {
        self.cx.open();
        let sequence = self.sequence(sequence);
        let key = self.value(key);
        self.cx.close();
        let ((sequence, ty), key) = (sequence?, key?);
        let mut key = self.unbox(key);
        if selection == Selection::First {
            key = self.boolean(key)?;
        } else if !is_numeric(&key.ty) {
            let message = format!(
                "what is least or greatest must be a number, found `{}`",
                self.type_name(&key.ty)
            );
            self.report(Diagnostic::error("bad-aggregate", key.span, message));
            return None;
        }
        // Labels of the query are set while the key is evaluated; the element has a slot of its own.
        let slot = self.cx.slot(ty.clone(), span);
        let kind = ExprKind::SelectWhere {
            selection,
            sequence: Box::new(sequence),
            slot,
            key: Box::new(key),
        };
        Some(Expr { kind, ty, span })
    }

    /// Several values and their type. Labels of a query are declared in the innermost block, which the caller opens.
    pub(super) fn sequence(&mut self, e: &ast::Expr) -> Option<(Sequence, Type)> {
        let outer = std::mem::replace(&mut self.cx.collector, Collector::Open);
        let value = self.expr(e);
        let found = std::mem::replace(&mut self.cx.collector, outer);
        let value = value?;
        let ty = value.ty.clone();
        if let Collector::Found(source, slot) = found {
            if matches!(value.kind, ExprKind::Read(Place::Local(s)) if s == slot) {
                return Some((source, ty));
            }
            return Some((
                Sequence::Map {
                    source: Box::new(source),
                    slot,
                    body: Box::new(value),
                },
                ty,
            ));
        }
        Some(match &ty {
            Type::Array(element) => ((Sequence::Elements(Box::new(value))), (**element).clone()),
            _ if ty
                .class()
                .is_some_and(|class| class.is_a(ClassId::Collection)) =>
            {
                let list = Sequence::List(Box::new(value));
                match ty.argument(0) {
                    Type::Object => (list, Type::Object),
                    element => (self.opened(list, &element, e.span), element),
                }
            }
            _ => (Sequence::One(Box::new(value)), ty),
        })
    }

    /// What a `for` goes through: as [`sequence`](Self::sequence), also `apply(n)`; a single value is a fault.
    pub(super) fn for_sequence(&mut self, e: &ast::Expr) -> Option<(Sequence, Type)> {
        if let ast::ExprKind::Call(callee, args) = &e.kind
            && let (ast::ExprKind::Name(name), [n]) = (&callee.kind, args.as_slice())
            && name == "apply"
            && !self.method_names.contains_key("apply")
        {
            let n = self.value(n)?;
            let n = self.int(n)?;
            self.cx.facts.is_impure = true;
            return Some((Sequence::Apply(Box::new(n)), Type::Void));
        }
        let (sequence, element) = self.sequence(e)?;
        if matches!(sequence, Sequence::One(_)) {
            let message = format!(
                "expected several values, found one `{}`",
                self.type_name(&element)
            );
            let fault = Diagnostic::error("bad-for", e.span, message);
            self.report(
                fault.hint(
                    "a range `1:n`, a query `(* X *)`, an array or a list can be gone through",
                ),
            );
            return None;
        }
        Some((sequence, element))
    }

    /// `(* pattern *)`
    pub(super) fn query(&mut self, pattern: &ast::Pattern, span: Span) -> Option<Expr> {
        self.cx.facts.is_impure = true;
        if !self.may_collect("a query", span) {
            return None;
        }
        // Expressions inside the pattern are no part of what is around the query.
        let outer = std::mem::take(&mut self.cx.collector);
        let checked = self.query_pattern(pattern);
        self.cx.collector = outer;
        let checked = checked?;
        let Some((result, ty)) = checked.result else {
            self.report(Diagnostic::error(
                "empty-query",
                span,
                "this query looks for nothing",
            ));
            return None;
        };
        let sequence = Sequence::Query {
            pattern: Box::new(checked.pattern),
            result,
        };
        Some(self.collect(sequence, Type::Node(ty), span))
    }

    /// `from:to`
    pub(super) fn range(&mut self, from: &ast::Expr, to: &ast::Expr, span: Span) -> Option<Expr> {
        if !self.may_collect("a range", span) {
            return None;
        }
        let outer = std::mem::take(&mut self.cx.collector);
        let (from, to) = (self.value(from), self.value(to));
        self.cx.collector = outer;
        let (from, to) = (self.unbox(from?), self.unbox(to?));
        let is_long = from.ty == Type::Long || to.ty == Type::Long;
        let ty = if is_long { Type::Long } else { Type::Int };
        let (from, to) = (self.assign_value(from, &ty), self.assign_value(to, &ty));
        Some(self.collect(Sequence::Range(Box::new(from?), Box::new(to?)), ty, span))
    }

    /// Whether several values may stand here; reported if not.
    fn may_collect(&mut self, what: &str, span: Span) -> bool {
        let message = match self.cx.collector {
            Collector::Open => return true,
            Collector::Closed => format!("{what} gives several values, but one is needed here"),
            Collector::Found(..) => {
                format!("{what} cannot be combined with another query or range")
            }
        };
        let fault = Diagnostic::error("several-values", span, message);
        self.report(
            fault.hint(
                "put it into `first( … )`, `sum( … )` or the like, or go through it with `for`",
            ),
        );
        false
    }

    fn collect(&mut self, sequence: Sequence, ty: Type, span: Span) -> Expr {
        let slot: Slot = self.cx.slot(ty.clone(), span);
        self.cx.collector = Collector::Found(sequence, slot);
        let target = Target {
            place: Place::Local(slot),
            ty,
            is_final: true,
        };
        self.read(target, span)
    }
}

/// Whether a statement that is done for each of several values keeps the last one only: `x = (* Leaf *).area;`
pub(super) fn keeps_last(e: &ast::Expr) -> bool {
    matches!(&e.kind, ast::ExprKind::Assign(None, target, _) if !begins_with_query(target))
}

/// Whether an expression is an attribute or a member of what a query finds.
fn begins_with_query(e: &ast::Expr) -> bool {
    match &e.kind {
        ast::ExprKind::Query(_) => true,
        ast::ExprKind::Member(object, _) | ast::ExprKind::Index(object, _) => {
            begins_with_query(object)
        }
        _ => false,
    }
}
