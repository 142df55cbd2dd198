//! Left-hand sides and the insides of queries.

use std::collections::HashMap;

use super::Checker;
use super::context::Local;
use super::model::{Expr, Slot, Type};
use super::names::Binding;
use crate::diag::{Diagnostic, Span};
use crate::graph::TypeId;
use crate::graph::pattern::{
    Candidate, Condition, EdgeKind, EdgeWay, Pattern, PatternEdge, PatternNode,
};
use crate::syntax::ast::{self, EdgeDirection, PatternItem, PatternPart};

/// Greatest number of a user's own edge kind.
const MAX_USER_EDGE: u8 = 20;

/// A checked pattern.
pub(super) struct Checked {
    pub(super) pattern: Pattern<Expr>,
    /// The node that a query gives, and its type: the rightmost one outside of branches.
    pub(super) result: Option<(usize, TypeId)>,
}

/// A pattern in the making.
#[derive(Default)]
pub(super) struct Builder {
    nodes: Vec<PatternNode<Expr>>,
    types: Vec<TypeId>,
    edges: Vec<PatternEdge>,
    labels: HashMap<String, usize>,
    /// The pattern node that sets a slot.
    slots: HashMap<Slot, usize>,
    first: Option<usize>,
    last: Option<usize>,
    result: Option<usize>,
    pub(super) is_wrong: bool,
}

/// Where in a pattern an item stands.
#[derive(Clone, Copy)]
struct At {
    is_context: bool,
    in_branch: bool,
    /// The edge before the first node where none is written.
    default: EdgeKind,
}

/// What the next node is linked from.
#[derive(Default)]
struct Cursor<'i> {
    /// The node before.
    previous: Option<usize>,
    /// The edge written after it.
    edge: Option<&'i ast::EdgePattern>,
}

impl Checker<'_> {
    /// Checks a pattern; its labels and variables go into the innermost block.
    pub(super) fn pattern(&mut self, pattern: &ast::Pattern) -> Option<Checked> {
        let mut builder = Builder::default();
        let mut conditions = vec![];
        for part in &pattern.parts {
            match part {
                PatternPart::Path(items) => {
                    let at = At {
                        is_context: false,
                        in_branch: false,
                        default: EdgeKind::Successor,
                    };
                    self.whole_path(&mut builder, items, at, Cursor::default());
                }
                PatternPart::Condition(condition) => {
                    conditions.extend(self.condition(&builder, condition));
                }
            }
        }
        let is_wrong = builder.is_wrong || conditions.len() != count_conditions(pattern);
        let result = builder.result.map(|at| (at, builder.types[at]));
        let Builder {
            nodes,
            edges,
            first,
            last,
            ..
        } = builder;
        let pattern = Pattern {
            nodes,
            edges,
            conditions,
            first,
            last,
            span: pattern.span,
        };
        (!is_wrong).then_some(Checked { pattern, result })
    }

    fn condition(&mut self, builder: &Builder, condition: &ast::Expr) -> Option<Condition<Expr>> {
        let before = self.cx.touched.len();
        let expr = self.value(condition)?;
        let expr = self.boolean(expr)?;
        let used = self.cx.touched[before..]
            .iter()
            .filter_map(|slot| builder.slots.get(slot));
        Some(Condition {
            expr,
            needs: used.copied().max(),
        })
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
        if let Some(edge) = cursor.edge {
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
            match item {
                PatternItem::Node(node) => {
                    self.linked_node(builder, node, at, cursor);
                    at.default = EdgeKind::Successor;
                }
                PatternItem::Edge(written) => {
                    let is_loose = cursor.previous.is_none() && !builder.is_wrong;
                    if is_loose || cursor.edge.is_some() {
                        self.report_loose_edge(builder, written.span);
                    }
                    cursor.edge = Some(written);
                }
                PatternItem::Branch(items) => {
                    if cursor.previous.is_none() && !builder.is_wrong {
                        self.report_loose_branch(builder, first_span(items));
                    }
                    let inner = At {
                        in_branch: true,
                        default: EdgeKind::Branch,
                        ..at
                    };
                    let start = Cursor {
                        previous: cursor.previous,
                        edge: cursor.edge.take(),
                    };
                    self.whole_path(builder, items, inner, start);
                }
                PatternItem::Context(items) => {
                    self.path(
                        builder,
                        items,
                        At {
                            is_context: true,
                            ..at
                        },
                        cursor,
                    );
                    at.default = EdgeKind::Successor;
                }
            }
        }
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
            builder.is_wrong = true;
            *cursor = Cursor::default();
            return;
        };
        match (cursor.previous, cursor.edge.take()) {
            (Some(from), edge) => self.pattern_edge(builder, from, index, edge, at.default),
            (None, Some(edge)) => self.report_loose_edge(builder, edge.span),
            (None, None) => {}
        }
        cursor.previous = Some(index);
    }

    fn report_loose_branch(&mut self, builder: &mut Builder, span: Span) {
        builder.is_wrong = true;
        let fault = Diagnostic::error("loose-branch", span, "a branch needs a node before it");
        self.report(fault.hint("write `. [ … ]` for a branch of any node"));
    }

    fn report_loose_edge(&mut self, builder: &mut Builder, span: Span) {
        builder.is_wrong = true;
        let fault = Diagnostic::error("loose-edge", span, "an edge needs a node on either side");
        self.report(fault.hint("write `.` for any node"));
    }

    fn pattern_edge(
        &mut self,
        builder: &mut Builder,
        from: usize,
        to: usize,
        edge: Option<&ast::EdgePattern>,
        default: EdgeKind,
    ) {
        let Some(edge) = edge else {
            let repeat = (1, Some(1));
            builder.edges.push(PatternEdge {
                from,
                to,
                kind: default,
                way: EdgeWay::Forward,
                repeat,
            });
            return;
        };
        let Some(kind) = self.edge_kind(edge) else {
            builder.is_wrong = true;
            return;
        };
        let repeat = edge.repeat.unwrap_or((1, Some(1)));
        if repeat.1.is_some_and(|most| most < repeat.0) {
            self.report(Diagnostic::error(
                "bad-closure",
                edge.span,
                "the greatest number is below the least",
            ));
            builder.is_wrong = true;
        }
        builder.edges.push(PatternEdge {
            from,
            to,
            kind,
            way: edge_way(edge.direction),
            repeat,
        });
    }

    /// The kind of an edge; reported if it is not known.
    pub(super) fn edge_kind(&mut self, edge: &ast::EdgePattern) -> Option<EdgeKind> {
        Some(match &edge.kind {
            ast::EdgeKind::Any => EdgeKind::Any,
            ast::EdgeKind::Successor => EdgeKind::Successor,
            ast::EdgeKind::Branch => EdgeKind::Branch,
            ast::EdgeKind::Refinement => EdgeKind::Refinement,
            ast::EdgeKind::Named(name) => match name.as_str() {
                "ancestor" => EdgeKind::Ancestor,
                "minDescendants" => EdgeKind::MinDescendants,
                "descendants" => EdgeKind::Descendants,
                "successor" => EdgeKind::Successor,
                "branch" => EdgeKind::Branch,
                _ => match name
                    .strip_prefix("EDGE_")
                    .and_then(|n| n.parse::<u8>().ok())
                {
                    Some(bit) if bit <= MAX_USER_EDGE => EdgeKind::User(bit),
                    _ => {
                        let fault = Diagnostic::error(
                            "unknown-edge",
                            edge.span,
                            format!("unknown edge `{name}`"),
                        );
                        let hint = "there are `ancestor`, `minDescendants`, `descendants` and `EDGE_0` … `EDGE_20`";
                        self.report(fault.hint(hint));
                        return None;
                    }
                },
            },
        })
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
        builder.nodes.push(PatternNode {
            what,
            slot: slot.map(|s| s.0),
            args: vec![],
            is_context: at.is_context,
            span: node.span,
        });
        builder.types.push(ty);
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

    /// What a pattern node may be, and its type.
    fn candidate(
        &mut self,
        builder: &Builder,
        node: &ast::NodePattern,
    ) -> Option<(Candidate<Expr>, TypeId)> {
        let [name] = node.name.path.as_slice() else {
            return match node.name.path.last() {
                None => Some((Candidate::Any, self.node)),
                Some(_) => match self.resolve_value_type(&node.name)? {
                    Type::Node(id) => Some((Candidate::Type(id), id)),
                    ty => {
                        let message = format!("`{}` is no module", self.type_name(&ty));
                        self.report(Diagnostic::error("not-a-node", node.span, message));
                        None
                    }
                },
            };
        };
        let (name, span) = (name.name.as_str(), name.span);
        match name {
            "." => return Some((Candidate::Any, self.node)),
            "^" => return Some((Candidate::Root, self.root_type())),
            _ => {}
        }
        if let Some(&same) = builder.labels.get(name) {
            return Some((Candidate::Same(same), builder.types[same]));
        }
        if name == "this" {
            let this = self.expr(&ast::Expr {
                kind: ast::ExprKind::This,
                span,
            })?;
            let Type::Node(ty) = this.ty else { return None };
            return Some((Candidate::Value(this), ty));
        }
        let is_local = self.cx.has_local(name);
        if !is_local && let Some(id) = self.node_type(name) {
            return Some((Candidate::Type(id), id));
        }
        self.variable_candidate(name, span)
    }

    /// A variable that holds a node.
    fn variable_candidate(&mut self, name: &str, span: Span) -> Option<(Candidate<Expr>, TypeId)> {
        let value = match self.lookup(name, span) {
            Some(Binding::Target(target)) => self.read(target, span),
            Some(Binding::Value(value)) => value,
            Some(Binding::Poisoned) => return None,
            None => {
                if !self.refused.contains(name) {
                    let fault = self.unknown_node_type(name, span);
                    self.report(fault);
                }
                return None;
            }
        };
        let Type::Node(ty) = value.ty else {
            if let Some(id) = self.node_type(name) {
                return Some((Candidate::Type(id), id));
            }
            let message = format!("`{name}` is no node but `{}`", self.type_name(&value.ty));
            self.report(Diagnostic::error("not-a-node", span, message));
            return None;
        };
        Some((Candidate::Value(value), ty))
    }
}

fn count_conditions(pattern: &ast::Pattern) -> usize {
    pattern
        .parts
        .iter()
        .filter(|part| matches!(part, PatternPart::Condition(_)))
        .count()
}

/// The way of an edge.
pub(super) fn edge_way(direction: EdgeDirection) -> EdgeWay {
    match direction {
        EdgeDirection::Forward => EdgeWay::Forward,
        EdgeDirection::Backward => EdgeWay::Backward,
        EdgeDirection::Both => EdgeWay::Both,
        EdgeDirection::Undirected => EdgeWay::Undirected,
    }
}

/// The place of the first thing in a row.
fn first_span(items: &[PatternItem]) -> Span {
    match items.first() {
        Some(PatternItem::Node(node)) => node.span,
        Some(PatternItem::Edge(edge)) => edge.span,
        Some(PatternItem::Branch(items) | PatternItem::Context(items)) => first_span(items),
        None => Span::default(),
    }
}
