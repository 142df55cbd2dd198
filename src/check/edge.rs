//! Edges of patterns: single ones, closures, ways of several edges, and methods that lead from node to node.

use super::Checker;
use super::context::Local;
use super::model::{Constant, Expr, Slot, Type};
use super::names::Binding;
use super::pattern::{At, Builder};
use crate::diag::{Diagnostic, Span};
use crate::graph::TypeId;
use crate::graph::pattern::{EdgeKind, EdgeWay, PatternEdge, WalkStep};
use crate::syntax::ast::{self, EdgeDirection, WalkItem};

/// Greatest number of a user's own edge kind.
const MAX_USER_EDGE: u8 = 20;

/// Most steps of a way of several edges, with all its repetitions written out.
const LONGEST_WALK: u64 = 4096;

/// How often a plain edge is walked.
const ONCE: (u32, Option<u32>) = (1, Some(1));

impl Checker<'_> {
    /// Adds the edge between two nodes, as written or as it is by default.
    pub(super) fn pattern_edge(
        &mut self,
        builder: &mut Builder,
        (from, to): (usize, usize),
        edge: Option<&ast::EdgePattern>,
        at: At,
    ) {
        let plain = PatternEdge {
            from,
            to,
            kind: at.default,
            way: EdgeWay::Forward,
            repeat: ONCE,
            is_minimal: false,
            choice: at.choice,
        };
        let added = match edge.map(|edge| (edge, &edge.kind)) {
            None => Some(plain),
            Some((edge, ast::EdgeKind::Walk(items))) => self.walk_edge(builder, plain, items, edge),
            Some((edge, ast::EdgeKind::Named(name, args)))
                if self.method_names.contains_key(name) =>
            {
                self.relation(builder, plain, (name, args), edge);
                return;
            }
            Some((edge, _)) => self.single_edge(plain, edge),
        };
        match added {
            Some(edge) => builder.edges.push(edge),
            None => builder.is_wrong = true,
        }
    }

    /// One kind of edge, perhaps repeated.
    fn single_edge(&mut self, plain: PatternEdge, edge: &ast::EdgePattern) -> Option<PatternEdge> {
        let kind = self.edge_kind(edge)?;
        self.check_repeat(kind, edge)?;
        Some(PatternEdge {
            kind,
            way: edge_way(edge.direction),
            repeat: edge.repeat.unwrap_or(ONCE),
            ..plain
        })
    }

    /// Refuses closures that end before they begin, and those of edges that are closures already.
    fn check_repeat(&mut self, kind: EdgeKind, edge: &ast::EdgePattern) -> Option<()> {
        let (least, most) = edge.repeat.unwrap_or(ONCE);
        let is_nearest = matches!(
            kind,
            EdgeKind::Ancestor | EdgeKind::MinDescendants | EdgeKind::Descendants
        );
        let fault = if most.is_some_and(|most| most < least) {
            let message = "the greatest number is below the least";
            Diagnostic::error("bad-closure", edge.span, message)
        } else if is_nearest && edge.repeat.is_some() {
            let message = "this edge leads over many edges by itself and cannot be repeated";
            let fault = Diagnostic::error("bad-closure", edge.span, message);
            fault.hint("write it without parentheses, or `(-->)+` for all below and `(<--)+` for all above")
        } else {
            return Some(());
        };
        self.report(fault);
        None
    }

    /// The kind of an edge; reported if it is not known.
    pub(super) fn edge_kind(&mut self, edge: &ast::EdgePattern) -> Option<EdgeKind> {
        Some(match &edge.kind {
            ast::EdgeKind::Any => EdgeKind::Any,
            ast::EdgeKind::Successor => EdgeKind::Successor,
            ast::EdgeKind::Branch => EdgeKind::Branch,
            ast::EdgeKind::Refinement => EdgeKind::Refinement,
            ast::EdgeKind::Named(name, args) => match self.named_kind(name, edge.span) {
                Some(kind) if args.is_empty() => kind,
                _ => {
                    self.report_unknown_edge(name, edge.span);
                    return None;
                }
            },
            ast::EdgeKind::Walk(_) => {
                let message = "several edges in a row cannot be made at once";
                let fault = Diagnostic::error("bad-edge", edge.span, message);
                self.report(fault.hint("write a node between them"));
                return None;
            }
        })
    }

    /// The kind of edge that has a name, or whose number a constant holds.
    fn named_kind(&mut self, name: &str, span: Span) -> Option<EdgeKind> {
        let word = name.rsplit('.').next().unwrap_or(name);
        let known = match word {
            "ancestor" => Some(EdgeKind::Ancestor),
            "minDescendants" => Some(EdgeKind::MinDescendants),
            "descendants" => Some(EdgeKind::Descendants),
            "successor" | "SUCCESSOR_EDGE" => Some(EdgeKind::Successor),
            "branch" | "BRANCH_EDGE" => Some(EdgeKind::Branch),
            "REFINEMENT_EDGE" => Some(EdgeKind::Refinement),
            _ => None,
        };
        if known.is_some() {
            return known;
        }
        let number = word.strip_prefix("EDGE_").and_then(|n| n.parse().ok());
        let bit = number.or_else(|| self.constant_bit(word, span));
        bit.filter(|&bit| bit <= MAX_USER_EDGE).map(EdgeKind::User)
    }

    /// The only bit of the constant of this name.
    fn constant_bit(&mut self, name: &str, span: Span) -> Option<u8> {
        let Some(Binding::Value(value)) = self.lookup(name, span) else {
            return None;
        };
        match super::constant::value_of(&value)? {
            Constant::Int(bits) if bits.count_ones() == 1 => {
                u8::try_from(bits.trailing_zeros()).ok()
            }
            _ => None,
        }
    }

    fn report_unknown_edge(&mut self, name: &str, span: Span) {
        let fault = Diagnostic::error("unknown-edge", span, format!("unknown edge `{name}`"));
        self.report(fault.hint(
            "there are `ancestor`, `minDescendants`, `descendants`, `EDGE_0` … `EDGE_20`, constants with one of their values, \
             and methods that get a node and give a node or a boolean",
        ));
    }

    pub(super) fn report_loose_branch(&mut self, builder: &mut Builder, span: Span) {
        builder.is_wrong = true;
        let fault = Diagnostic::error("loose-branch", span, "a branch needs a node before it");
        self.report(fault.hint("write `. [ … ]` for a branch of any node"));
    }

    pub(super) fn report_loose_edge(&mut self, builder: &mut Builder, span: Span) {
        builder.is_wrong = true;
        let fault = Diagnostic::error("loose-edge", span, "an edge needs a node on either side");
        self.report(fault.hint("write `.` for any node"));
    }

    // ── ways of several edges ──

    fn walk_edge(
        &mut self,
        builder: &mut Builder,
        plain: PatternEdge,
        items: &[WalkItem],
        edge: &ast::EdgePattern,
    ) -> Option<PatternEdge> {
        let steps = vec![self.repeated(items, edge)?];
        let size = size_of_walk(&steps);
        let number = u16::try_from(builder.walks.len()).ok();
        let (Some(number), true) = (number, size <= LONGEST_WALK) else {
            let message = format!("this closure has {size} steps, {LONGEST_WALK} are allowed");
            let fault = Diagnostic::error("long-closure", edge.span, message);
            self.report(fault.hint("write `*` or `+` instead of great numbers"));
            return None;
        };
        let least = u32::from(!may_stay(&steps));
        builder.walks.push(steps);
        Some(PatternEdge {
            kind: EdgeKind::Walk(number),
            repeat: (least, None),
            ..plain
        })
    }

    fn repeated(&mut self, items: &[WalkItem], edge: &ast::EdgePattern) -> Option<WalkStep> {
        let (least, most) = edge.repeat.unwrap_or(ONCE);
        if most.is_some_and(|most| most < least) {
            self.check_repeat(EdgeKind::Any, edge)?;
        }
        let (mut steps, mut is_after_node) = (vec![], false);
        for item in items {
            match item {
                WalkItem::Edge(inner) => steps.push(self.walk_step(inner)?),
                WalkItem::Node(node) => {
                    if is_after_node {
                        steps.push(WalkStep::Edge(EdgeKind::Successor, EdgeWay::Forward));
                    }
                    steps.extend(self.node_on_walk(node)?);
                }
                WalkItem::Condition(condition) => {
                    let message = "a closure cannot hold a condition";
                    let fault = Diagnostic::error("bad-closure", condition.span, message);
                    self.report(fault.hint(
                        "give the nodes on the way a module of their own, or go through the matches with `for`",
                    ));
                    return None;
                }
            }
            is_after_node = matches!(item, WalkItem::Node(_));
        }
        Some(WalkStep::Repeat(steps, least, most))
    }

    fn walk_step(&mut self, edge: &ast::EdgePattern) -> Option<WalkStep> {
        if let ast::EdgeKind::Walk(items) = &edge.kind {
            return self.repeated(items, edge);
        }
        let kind = self.edge_kind(edge)?;
        if matches!(
            kind,
            EdgeKind::Ancestor | EdgeKind::MinDescendants | EdgeKind::Descendants
        ) {
            let message = "this edge cannot be part of a closure";
            let fault = Diagnostic::error("bad-closure", edge.span, message);
            self.report(fault.hint("write `(-->)+` for all below, `(<--)+` for all above"));
            return None;
        }
        let step = WalkStep::Edge(kind, edge_way(edge.direction));
        let Some((least, most)) = edge.repeat else {
            return Some(step);
        };
        self.check_repeat(kind, edge)?;
        Some(WalkStep::Repeat(vec![step], least, most))
    }

    /// The type of a node on the way; none for any node.
    fn node_on_walk(&mut self, node: &ast::NodePattern) -> Option<Option<WalkStep>> {
        let name = node.name.path.last().map_or(".", |name| name.name.as_str());
        let is_plain = node.label.is_none() && node.args.is_none();
        let found: Option<Option<TypeId>> = match name {
            "." => Some(None),
            _ => self.node_type(name).map(Some),
        };
        match found {
            Some(ty) if is_plain => Some(ty.map(WalkStep::Type)),
            None if is_plain && name != "^" && name != "this" => {
                let fault = self.unknown_node_type(name, node.span);
                self.report(fault);
                None
            }
            _ => {
                let message =
                    "in a closure stand edges and types of nodes only, no labels and no parameters";
                let fault = Diagnostic::error("bad-closure", node.span, message);
                self.report(
                    fault.hint("there may be many nodes on the way: which one would it be?"),
                );
                None
            }
        }
    }

    // ── methods as edges ──

    /// `a -method(args)-> b`: the method is called with `a`. One that gives a node gives `b`; one that gives a boolean is
    /// called with `b` as well and tells whether the two match.
    fn relation(
        &mut self,
        builder: &mut Builder,
        plain: PatternEdge,
        (name, args): (&str, &[ast::Expr]),
        edge: &ast::EdgePattern,
    ) {
        let (from, to) = match edge.direction {
            EdgeDirection::Forward => (plain.from, plain.to),
            EdgeDirection::Backward => (plain.to, plain.from),
            EdgeDirection::Both | EdgeDirection::Undirected => {
                return self.bad_relation(builder, edge);
            }
        };
        if edge.repeat.is_some() {
            return self.bad_relation(builder, edge);
        }
        let ends = [from, to].map(|node| self.name_of_node(builder, node, edge.span));
        let before = self.cx.touched.len();
        let gives_node = self.one_node_method(name, args.len());
        let given = if gives_node { &ends[..1] } else { &ends[..] };
        let Some(value) = self.call_with(name, given, args, edge.span) else {
            builder.is_wrong = true;
            return;
        };
        match value.ty {
            Type::Boolean => self.pattern_condition(builder, value, before, plain.choice),
            Type::Node(_) => self.node_relation(builder, (from, to), value, plain),
            _ => self.bad_relation(builder, edge),
        }
    }

    fn node_relation(
        &mut self,
        builder: &mut Builder,
        (from, to): (usize, usize),
        value: Expr,
        plain: PatternEdge,
    ) {
        let Ok(number) = u16::try_from(builder.relations.len()) else {
            builder.is_wrong = true;
            return;
        };
        builder.relations.push(value);
        builder.edges.push(PatternEdge {
            from,
            to,
            kind: EdgeKind::Relation(number),
            ..plain
        });
    }

    /// Whether a method of this name is called with one node (and the other arguments) alone.
    fn one_node_method(&self, name: &str, n_args: usize) -> bool {
        let mut mine = self.method_names.get(name).into_iter().flatten();
        mine.any(|id| self.methods[id.0 as usize].params.len() == n_args + 1)
    }

    /// `name(nodes…, args…)`
    fn call_with(
        &mut self,
        name: &str,
        nodes: &[String],
        args: &[ast::Expr],
        span: Span,
    ) -> Option<Expr> {
        let named = |name: &str| ast::Expr {
            kind: ast::ExprKind::Name(name.to_owned()),
            span,
        };
        let mut all: Vec<ast::Expr> = nodes.iter().map(|node| named(node)).collect();
        all.extend_from_slice(args);
        let kind = ast::ExprKind::Call(Box::new(named(name)), all);
        self.value(&ast::Expr { kind, span })
    }

    /// A name, which no text can spell, by which expressions read a node of the pattern.
    fn name_of_node(&mut self, builder: &mut Builder, node: usize, span: Span) -> String {
        let name = format!("(node {node})");
        let ty = Type::Node(builder.types[node]);
        match builder.nodes[node].slot {
            Some(slot) => self.cx.declare(Local {
                name: name.clone(),
                ty: Some(ty),
                slot: Slot(slot),
                is_final: true,
                value: None,
            }),
            None => {
                let slot = self.bind(builder, &name, ty, node, span);
                builder.nodes[node].slot = Some(slot.0);
            }
        }
        name
    }

    fn bad_relation(&mut self, builder: &mut Builder, edge: &ast::EdgePattern) {
        builder.is_wrong = true;
        let message = "a method as an edge leads from one node to another";
        let fault = Diagnostic::error("bad-edge", edge.span, message);
        self.report(fault.hint(
            "write `a -method-> b` or `b <-method- a`, once, with a method that gets a node and gives a node or a boolean",
        ));
    }
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

/// Number of steps with repetitions written out.
fn size_of_walk(steps: &[WalkStep]) -> u64 {
    let size = |step: &WalkStep| match step {
        WalkStep::Edge(..) | WalkStep::Type(_) => 1,
        WalkStep::Repeat(inner, least, most) => {
            let times = u64::from(most.map_or(least.saturating_add(1), |most| most));
            size_of_walk(inner)
                .saturating_add(1)
                .saturating_mul(times.max(1))
        }
    };
    steps.iter().map(size).fold(0, u64::saturating_add)
}

/// Whether a way can have no edge at all.
fn may_stay(steps: &[WalkStep]) -> bool {
    steps.iter().all(|step| match step {
        WalkStep::Edge(..) => false,
        WalkStep::Type(_) => true,
        WalkStep::Repeat(inner, least, _) => *least == 0 || may_stay(inner),
    })
}
