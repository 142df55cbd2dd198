//! Left-hand sides and the insides of queries.

use std::collections::HashMap;

use super::Checker;
use super::context::Local;
use super::model::{Expr, ExprKind, Slot, Type};
use super::names::Binding;
use super::types::Fit;
use crate::diag::{Diagnostic, Span};
use crate::graph::pattern::{
    Candidate, Condition, EdgeKind, EdgeWay, Pattern, PatternArg, PatternEdge, PatternNode,
};
use crate::graph::{FieldId, TypeId};
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
struct Builder {
    nodes: Vec<PatternNode<Expr>>,
    types: Vec<TypeId>,
    edges: Vec<PatternEdge>,
    labels: HashMap<String, usize>,
    /// The pattern node that sets a slot.
    slots: HashMap<Slot, usize>,
    first: Option<usize>,
    last: Option<usize>,
    result: Option<usize>,
    is_wrong: bool,
}

/// Where in a pattern an item stands.
#[derive(Clone, Copy)]
struct At {
    is_context: bool,
    in_branch: bool,
    /// The edge before the first node where none is written.
    default: EdgeKind,
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
                    self.path(&mut builder, items, at, &mut None, &mut None);
                }
                PatternPart::Condition(condition) => {
                    conditions.extend(self.condition(&builder, condition))
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

    /// Adds a row of nodes. `previous` is the node before, `edge` an edge written after it.
    fn path<'i>(
        &mut self,
        builder: &mut Builder,
        items: &'i [PatternItem],
        at: At,
        previous: &mut Option<usize>,
        edge: &mut Option<&'i ast::EdgePattern>,
    ) {
        let mut default = at.default;
        for item in items {
            match item {
                PatternItem::Node(node) => {
                    let Some(index) = self.pattern_node(builder, node, at) else {
                        builder.is_wrong = true;
                        (*previous, *edge) = (None, None);
                        continue;
                    };
                    if let Some(from) = *previous {
                        self.pattern_edge(builder, from, index, edge.take(), default);
                    } else if let Some(edge) = edge.take() {
                        self.report_loose_edge(builder, edge.span);
                    }
                    (*previous, default) = (Some(index), EdgeKind::Successor);
                }
                PatternItem::Edge(written) => {
                    if previous.is_none() && !builder.is_wrong || edge.is_some() {
                        self.report_loose_edge(builder, written.span);
                    }
                    *edge = Some(written);
                }
                PatternItem::Branch(items) => {
                    if previous.is_none() && !builder.is_wrong {
                        let fault = Diagnostic::error(
                            "loose-branch",
                            first_span(items),
                            "a branch needs a node before it",
                        );
                        self.report(fault.hint("write `. [ … ]` for a branch of any node"));
                        builder.is_wrong = true;
                    }
                    let at = At {
                        in_branch: true,
                        default: EdgeKind::Branch,
                        ..at
                    };
                    let mut inner_edge = edge.take();
                    self.path(builder, items, at, &mut previous.clone(), &mut inner_edge);
                }
                PatternItem::Context(items) => {
                    self.path(
                        builder,
                        items,
                        At {
                            is_context: true,
                            default,
                            ..at
                        },
                        previous,
                        edge,
                    );
                    default = EdgeKind::Successor;
                }
            }
        }
        if !at.is_context
            && let Some(edge) = edge.take()
        {
            self.report_loose_edge(builder, edge.span);
        }
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
    fn bind(
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
        let is_local = self.cx.local_names().iter().any(|local| local == name);
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

    /// Positional parameters.
    fn pattern_args(
        &mut self,
        builder: &mut Builder,
        ty: TypeId,
        args: &[Option<ast::Expr>],
        span: Span,
        index: usize,
    ) -> Option<Vec<PatternArg<Expr>>> {
        let params = self.positions(ty);
        let is_module = usize::from(ty.0) >= self.n_builtin;
        let n_given = args.len();
        if n_given > params.len() || (is_module && n_given > 0 && n_given < params.len()) {
            if self.is_orphan(ty) {
                return None;
            }
            let name = self.types[ty].name.to_string();
            let message = format!(
                "`{name}` has {} parameters, the pattern gives {n_given}",
                params.len()
            );
            let mut fault = Diagnostic::error("pattern-arguments", span, message);
            if n_given < params.len() {
                fault = fault.hint(format!(
                    "leave gaps for the others: `{name}(x{})`",
                    ",".repeat(params.len() - 1)
                ));
            }
            self.report(fault);
            return None;
        }
        let mut checked = vec![];
        for (arg, &field) in args.iter().zip(&params) {
            let Some(arg) = arg else { continue };
            match self.pattern_arg(builder, ty, field, arg, index) {
                Some(arg) => checked.push(arg),
                None => builder.is_wrong = true,
            }
        }
        Some(checked)
    }

    /// Fields that positional parameters stand for: of modules their parameters, of built-in types those of the longest constructor.
    pub(super) fn positions(&self, ty: TypeId) -> Vec<FieldId> {
        if let Some(module) = usize::from(ty.0).checked_sub(self.n_builtin) {
            return self.modules[module].params.clone();
        }
        let constructors = crate::turtle::builtin(ty).map_or(&[][..], |row| row.constructors);
        let longest = constructors
            .iter()
            .max_by_key(|fields| fields.len())
            .copied()
            .unwrap_or_default();
        longest
            .iter()
            .filter_map(|name| self.types.field(ty, name))
            .collect()
    }

    fn pattern_arg(
        &mut self,
        builder: &mut Builder,
        ty: TypeId,
        field: FieldId,
        arg: &ast::Expr,
        index: usize,
    ) -> Option<PatternArg<Expr>> {
        let field_ty = self.fields[usize::from(ty.0)]
            .get(usize::from(field.0))?
            .ty
            .clone()?;
        if let ast::ExprKind::Name(name) = &arg.kind
            && name != "^"
            && self.lookup(name, arg.span).is_none()
        {
            let slot = self.bind(builder, name, field_ty, index, arg.span);
            return Some(PatternArg::Bind(field, slot.0));
        }
        let value = self.value(arg)?;
        if self.fit(&value.ty, &field_ty) == Some(Fit::Direct) {
            return Some(PatternArg::Equal(field, self.convert(value, &field_ty)));
        }
        let mut fault = self.mismatch(&value.ty, &field_ty, value.span);
        if (&value.ty, &field_ty) == (&Type::Double, &Type::Float)
            && matches!(value.kind, ExprKind::Constant(_))
        {
            fault.hints =
                vec!["patterns compare exactly: write the number with an `f` at its end".into()];
        }
        self.report(fault);
        None
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
