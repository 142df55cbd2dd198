//! Left-hand sides and the insides of queries.

use std::collections::HashMap;

use super::Checker;
use super::context::Local;
use super::model::{Expr, Slot, Type};
use crate::diag::{Diagnostic, Span};
use crate::graph::TypeId;
use crate::graph::pattern::{
    Candidate, Choice, Condition, EdgeKind, Pattern, PatternEdge, PatternNode, WalkStep,
};
use crate::syntax::ast::{self, PatternItem, PatternPart};

/// A checked pattern.
pub(super) struct Checked {
    pub(super) pattern: Pattern<Expr>,
    /// The node that a query gives, and its type: the rightmost one outside of branches.
    pub(super) result: Option<(usize, TypeId)>,
}

/// A pattern in the making.
#[derive(Default)]
pub(super) struct Builder {
    pub(super) nodes: Vec<PatternNode<Expr>>,
    pub(super) types: Vec<TypeId>,
    pub(super) edges: Vec<PatternEdge>,
    pub(super) conditions: Vec<Condition<Expr>>,
    pub(super) choices: Vec<Choice>,
    pub(super) walks: Vec<Vec<WalkStep>>,
    pub(super) relations: Vec<Expr>,
    pub(super) labels: HashMap<String, usize>,
    /// The pattern node that sets a slot.
    pub(super) slots: HashMap<Slot, usize>,
    first: Option<usize>,
    last: Option<usize>,
    result: Option<usize>,
    /// Whether it is a query's: nothing is consumed.
    is_query: bool,
    pub(super) is_wrong: bool,
}

/// Where in a pattern an item stands.
#[derive(Clone, Copy)]
pub(super) struct At {
    is_context: bool,
    in_branch: bool,
    /// The part searched apart that it belongs to.
    pub(super) choice: Option<usize>,
    /// The edge before the first node where none is written.
    pub(super) default: EdgeKind,
}

/// What the next node is linked from.
#[derive(Default)]
struct Cursor<'i> {
    /// The node before.
    previous: Option<usize>,
    /// The edge written after it.
    edge: Option<&'i ast::EdgePattern>,
    /// The part searched apart that has ended the row.
    ended_by: Option<Span>,
}

impl Checker<'_> {
    /// Checks the left side of a rule; its labels and variables go into the innermost block.
    pub(super) fn rule_pattern(&mut self, pattern: &ast::Pattern) -> Option<Checked> {
        self.pattern(pattern, Builder::default())
    }

    /// Checks the inside of a query; its labels and variables go into the innermost block.
    pub(super) fn query_pattern(&mut self, pattern: &ast::Pattern) -> Option<Checked> {
        let builder = Builder {
            is_query: true,
            ..Builder::default()
        };
        self.pattern(pattern, builder)
    }

    fn pattern(&mut self, pattern: &ast::Pattern, mut builder: Builder) -> Option<Checked> {
        let at = At {
            is_context: false,
            in_branch: false,
            choice: None,
            default: EdgeKind::Successor,
        };
        self.parts(&mut builder, &pattern.parts, at, Cursor::default());
        let result = builder.result.map(|at| (at, builder.types[at]));
        let is_wrong = builder.is_wrong;
        let pattern = Pattern {
            nodes: builder.nodes,
            edges: builder.edges,
            conditions: builder.conditions,
            choices: builder.choices,
            walks: builder.walks,
            relations: builder.relations,
            first: builder.first,
            last: builder.last,
            span: pattern.span,
        };
        (!is_wrong).then_some(Checked { pattern, result })
    }

    /// Parts joined by commas, the first row of which goes on from `start`.
    fn parts<'i>(
        &mut self,
        builder: &mut Builder,
        parts: &'i [PatternPart],
        at: At,
        start: Cursor<'i>,
    ) {
        let mut start = Some(start);
        for part in parts {
            match part {
                PatternPart::Path(items) => {
                    let cursor = start.take().unwrap_or_default();
                    self.whole_path(builder, items, at, cursor);
                }
                PatternPart::Condition(written) => {
                    let before = self.cx.touched.len();
                    let checked = self.value(written).and_then(|value| self.boolean(value));
                    match checked {
                        Some(expr) => self.pattern_condition(builder, expr, before, at.choice),
                        None => builder.is_wrong = true,
                    }
                }
            }
        }
    }

    /// Adds a condition; the locals it reads (those touched since there were `before`) tell which nodes it needs.
    pub(super) fn pattern_condition(
        &mut self,
        builder: &mut Builder,
        expr: Expr,
        before: usize,
        choice: Option<usize>,
    ) {
        let read = self.cx.touched[before..].iter();
        let mut needs: Vec<usize> = read
            .filter_map(|slot| builder.slots.get(slot).copied())
            .collect();
        needs.sort_unstable();
        needs.dedup();
        builder.conditions.push(Condition {
            expr,
            needs,
            choice,
        });
    }

    /// Adds a row of nodes that ends here: at the end of a part or of a branch.
    fn whole_path<'i>(
        &mut self,
        builder: &mut Builder,
        items: &'i [PatternItem],
        at: At,
        mut cursor: Cursor<'i>,
    ) {
        self.path(builder, items, at, &mut cursor);
        if let Some(edge) = cursor.edge
            && !builder.is_wrong
        {
            self.report_loose_edge(builder, edge.span);
        }
    }

    /// Adds a row of nodes and leaves the cursor behind them.
    fn path<'i>(
        &mut self,
        builder: &mut Builder,
        items: &'i [PatternItem],
        mut at: At,
        cursor: &mut Cursor<'i>,
    ) {
        for item in items {
            if let Some(end) = cursor.ended_by {
                self.report_row_after_choice(builder, end);
                return;
            }
            match item {
                PatternItem::Node(node) => {
                    self.linked_node(builder, node, at, cursor);
                    at.default = EdgeKind::Successor;
                }
                PatternItem::Edge(written) => self.loose_edge(builder, written, at, cursor),
                PatternItem::Branch(items) => self.branch(builder, items, at, cursor),
                PatternItem::Context(items) => {
                    let inner = At {
                        is_context: true,
                        ..at
                    };
                    self.path(builder, items, inner, cursor);
                    at.default = EdgeKind::Successor;
                }
                PatternItem::Choice(choice, parts, span) => {
                    let start = Cursor {
                        edge: cursor.edge.take(),
                        ..*cursor
                    };
                    self.choice(builder, (*choice, parts, *span), at, start);
                    cursor.ended_by = Some(*span);
                }
            }
        }
    }

    /// An edge, whose right node follows. Between two edges in a row stands any node, which has no name.
    fn loose_edge<'i>(
        &mut self,
        builder: &mut Builder,
        written: &'i ast::EdgePattern,
        at: At,
        cursor: &mut Cursor<'i>,
    ) {
        match (cursor.previous, cursor.edge.take()) {
            (None, _) if !builder.is_wrong => self.report_loose_edge(builder, written.span),
            (Some(from), Some(edge)) if builder.is_query || at.is_context => {
                let between = At {
                    is_context: true,
                    ..at
                };
                let node = (Candidate::Any, self.node);
                let index = builder.add_node(node, None, between, written.span);
                self.pattern_edge(builder, (from, index), Some(edge), at);
                cursor.previous = Some(index);
            }
            (_, Some(_)) => self.report_loose_edge(builder, written.span),
            (_, None) => {}
        }
        cursor.edge = Some(written);
    }

    fn branch<'i>(
        &mut self,
        builder: &mut Builder,
        items: &'i [PatternItem],
        at: At,
        cursor: &mut Cursor<'i>,
    ) {
        if cursor.previous.is_none() && !builder.is_wrong {
            self.report_loose_branch(builder, first_span(items));
        }
        let inner = At {
            in_branch: true,
            default: EdgeKind::Branch,
            ..at
        };
        let start = Cursor {
            edge: cursor.edge.take(),
            ..*cursor
        };
        self.whole_path(builder, items, inner, start);
    }

    /// Adds a part that is searched apart.
    fn choice<'i>(
        &mut self,
        builder: &mut Builder,
        (choice, parts, span): (ast::Choice, &'i [PatternPart], Span),
        at: At,
        start: Cursor<'i>,
    ) {
        let is_consuming = !builder.is_query && !at.is_context;
        if at.choice.is_some() || choice == ast::Choice::Optional && is_consuming {
            self.report_misplaced_choice(builder, at.choice.is_some(), span);
        }
        builder.choices.push(match choice {
            ast::Choice::First => Choice::First,
            ast::Choice::Late => Choice::Late,
            ast::Choice::Optional => Choice::Optional,
        });
        let at = At {
            choice: Some(builder.choices.len() - 1),
            ..at
        };
        self.parts(builder, parts, at, start);
    }

    /// Adds a node and the edge from the one before it.
    fn linked_node(
        &mut self,
        builder: &mut Builder,
        node: &ast::NodePattern,
        at: At,
        cursor: &mut Cursor<'_>,
    ) {
        let Some(index) = self.pattern_node(builder, node, at) else {
            self.poison_args(node.args.as_deref().unwrap_or_default());
            builder.is_wrong = true;
            *cursor = Cursor::default();
            return;
        };
        match (cursor.previous, cursor.edge.take()) {
            (Some(from), edge) => {
                self.pattern_edge(builder, (from, index), edge, at);
                if node.is_nearest
                    && let Some(edge) = builder.edges.last_mut()
                {
                    edge.is_minimal = true;
                }
            }
            (None, Some(edge)) if !builder.is_wrong => self.report_loose_edge(builder, edge.span),
            (None, _) => {}
        }
        cursor.previous = Some(index);
    }

    fn pattern_node(
        &mut self,
        builder: &mut Builder,
        node: &ast::NodePattern,
        at: At,
    ) -> Option<usize> {
        let index = builder.nodes.len();
        let (what, ty) = self.candidate(builder, node)?;
        let slot = match &node.label {
            Some(label) => Some(self.pattern_label(builder, label, ty, index)?),
            None => None,
        };
        builder.add_node((what, ty), slot, at, node.span);
        if !at.is_context {
            builder.first.get_or_insert(index);
            if !at.in_branch {
                builder.last = Some(index);
            }
        }
        if !at.in_branch {
            builder.result = Some(index);
        }
        if let Some(args) = &node.args {
            let args = self.pattern_args(builder, ty, args, node.span, index)?;
            builder.nodes[index].args = args;
        }
        Some(index)
    }

    fn pattern_label(
        &mut self,
        builder: &mut Builder,
        label: &ast::Ident,
        ty: TypeId,
        index: usize,
    ) -> Option<Slot> {
        if builder.labels.insert(label.name.clone(), index).is_some() {
            let message = format!("label `{}` is given twice", label.name);
            let fault = Diagnostic::error("duplicate-label", label.span, message);
            self.report(fault.hint(format!(
                "write `{}` alone to mean the same node again",
                label.name
            )));
            return None;
        }
        Some(self.bind(builder, &label.name, Type::Node(ty), index, label.span))
    }

    /// A variable that pattern node `index` sets.
    pub(super) fn bind(
        &mut self,
        builder: &mut Builder,
        name: &str,
        ty: Type,
        index: usize,
        span: Span,
    ) -> Slot {
        let slot = self.cx.slot(ty.clone(), span);
        builder.slots.insert(slot, index);
        self.cx.declare(Local {
            name: name.into(),
            ty: Some(ty),
            slot,
            is_final: false,
            value: None,
        });
        slot
    }
}

impl Builder {
    /// Adds a node of this type; returns its index.
    fn add_node(
        &mut self,
        (what, ty): (Candidate<Expr>, TypeId),
        slot: Option<Slot>,
        at: At,
        span: Span,
    ) -> usize {
        self.nodes.push(PatternNode {
            what,
            slot: slot.map(|s| s.0),
            args: vec![],
            is_context: at.is_context,
            choice: at.choice,
            span,
        });
        self.types.push(ty);
        self.nodes.len() - 1
    }

    /// Whether a pattern node may be missing in a match.
    pub(super) fn is_optional(&self, node: usize) -> bool {
        let choice = self.nodes.get(node).and_then(|node| node.choice);
        choice.is_some_and(|choice| self.choices[choice] == Choice::Optional)
    }
}

/// The place of the first thing in a row.
fn first_span(items: &[PatternItem]) -> Span {
    match items.first() {
        Some(PatternItem::Node(node)) => node.span,
        Some(PatternItem::Edge(edge)) => edge.span,
        Some(PatternItem::Branch(items) | PatternItem::Context(items)) => first_span(items),
        Some(PatternItem::Choice(_, _, span)) => *span,
        None => Span::default(),
    }
}
