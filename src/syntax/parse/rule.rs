//! Rules: patterns on the left, graphs on the right.

use super::grammar::Rule;
use super::{Reader, kids};
use crate::diag::{Diagnostic, Span};
use crate::syntax::ast::{
    self, Arrow, Choice, EdgeDirection, EdgeKind, EdgePattern, Expr, ExprKind, ForHead, Ident,
    NodePattern, Pattern, PatternItem, PatternPart, RhsItem, RhsNode, RuleItem, TypeRef, WalkItem,
};
use pest::iterators::Pair;

impl Reader<'_> {
    pub(super) fn rule_items(&self, pair: Pair<'_, Rule>) -> Vec<RuleItem> {
        let item = |kid: Pair<'_, Rule>| match kid.as_rule() {
            Rule::rule => RuleItem::Rule(Box::new(self.rule(kid))),
            _ => RuleItem::Stmt(self.statement(kid)),
        };
        kids(pair).map(item).collect()
    }

    fn rule(&self, pair: Pair<'_, Rule>) -> ast::Rule {
        let span = self.span(&pair);
        let lhs = Pattern {
            parts: vec![],
            span: Span {
                end: span.start,
                ..span
            },
        };
        let mut rule = ast::Rule {
            lhs,
            arrow: Arrow::Execution,
            rhs: vec![],
            exec: None,
            span,
        };
        for kid in kids(pair) {
            match kid.as_rule() {
                Rule::pattern => rule.lhs = self.pattern(kid),
                Rule::arrow if kid.as_str() == "==>" => rule.arrow = Arrow::Lindenmayer,
                Rule::arrow => rule.arrow = Arrow::Spo,
                Rule::execution_arrow => rule.arrow = Arrow::Execution,
                _ if rule.arrow == Arrow::Execution => {
                    rule.exec = Some(Box::new(self.statement(kid)));
                }
                _ => rule.rhs.push(self.rhs_item(kid)),
            }
        }
        rule
    }

    // ── left sides ──

    pub(super) fn pattern(&self, pair: Pair<'_, Rule>) -> Pattern {
        let span = self.span(&pair);
        let mut parts = vec![];
        for part in kids(pair).flat_map(kids) {
            if part.as_rule() == Rule::condition {
                parts.extend(
                    kids(part)
                        .next()
                        .map(|cond| PatternPart::Condition(self.expr(cond))),
                );
            } else {
                self.pattern_path(part, &mut parts);
            }
        }
        Pattern { parts, span }
    }

    /// Adds a path. A context of several parts, `(* A, (c) *) B`, means the same as its first part in place and the
    /// others as parts of their own.
    fn pattern_path(&self, pair: Pair<'_, Rule>, parts: &mut Vec<PatternPart>) {
        let at = parts.len();
        let items = kids(pair)
            .map(|kid| self.pattern_item(kid, parts))
            .collect();
        parts.insert(at, PatternPart::Path(items));
    }

    fn pattern_item(&self, pair: Pair<'_, Rule>, parts: &mut Vec<PatternPart>) -> PatternItem {
        match pair.as_rule() {
            Rule::context => self.context(pair, parts),
            Rule::choice => self.choice(pair),
            Rule::pattern_branch => {
                let items = kids(pair)
                    .flat_map(kids)
                    .map(|kid| self.pattern_item(kid, parts))
                    .collect();
                PatternItem::Branch(items)
            }
            Rule::closure => PatternItem::Edge(self.closure(pair)),
            Rule::edge => PatternItem::Edge(self.edge(pair)),
            Rule::nearest => {
                let node = kids(pair).next().map(|kid| self.pattern_node(kid));
                let is_nearest = true;
                PatternItem::Node(NodePattern {
                    is_nearest,
                    ..node.expect("invariant: the rule holds a node")
                })
            }
            _ => PatternItem::Node(self.pattern_node(pair)),
        }
    }

    fn context(&self, pair: Pair<'_, Rule>, parts: &mut Vec<PatternPart>) -> PatternItem {
        let mut own = None;
        for part in kids(pair).flat_map(|pattern| self.pattern(pattern).parts) {
            match part {
                PatternPart::Path(items) if own.is_none() => own = Some(items),
                PatternPart::Path(items) => {
                    parts.push(PatternPart::Path(vec![PatternItem::Context(items)]));
                }
                PatternPart::Condition(cond) => parts.push(PatternPart::Condition(cond)),
            }
        }
        PatternItem::Context(own.unwrap_or_default())
    }

    fn choice(&self, pair: Pair<'_, Rule>) -> PatternItem {
        let span = self.span(&pair);
        let (mut choice, mut parts) = (Choice::First, vec![]);
        for kid in kids(pair) {
            match (kid.as_rule(), kid.as_str()) {
                (Rule::choice_mark, "&") => choice = Choice::Late,
                (Rule::choice_mark, "?") => choice = Choice::Optional,
                (Rule::choice_mark, _) => choice = Choice::First,
                _ => parts = self.pattern(kid).parts,
            }
        }
        PatternItem::Choice(choice, parts, span)
    }

    fn pattern_node(&self, pair: Pair<'_, Rule>) -> NodePattern {
        let span = self.span(&pair);
        let mut node = NodePattern {
            label: None,
            name: TypeRef {
                path: vec![],
                args: vec![],
                dims: 0,
                span,
            },
            args: None,
            is_nearest: false,
            span,
        };
        for kid in kids(pair) {
            match kid.as_rule() {
                Rule::ident => node.name.path.push(self.ident(&kid)),
                Rule::label_mark => node.label = node.name.path.pop(),
                Rule::pattern_args => node.args = Some(self.pattern_args(kid)),
                _ => node.name = self.plain_type(kid),
            }
        }
        if let (Some(first), Some(last)) = (node.name.path.first(), node.name.path.last()) {
            node.name.span = first.span.to(last.span);
        }
        node
    }

    fn pattern_args(&self, pair: Pair<'_, Rule>) -> Vec<Option<Expr>> {
        let mut args: Vec<_> = kids(pair)
            .map(|arg| kids(arg).next().map(|value| self.expr(value)))
            .collect();
        if args.len() == 1 && args[0].is_none() {
            args.clear();
        }
        args
    }

    // ── edges ──

    fn closure(&self, pair: Pair<'_, Rule>) -> EdgePattern {
        let span = self.span(&pair);
        let (mut items, mut repeat) = (vec![], None);
        for kid in kids(pair) {
            match kid.as_rule() {
                Rule::edge => items.push(WalkItem::Edge(self.edge(kid))),
                Rule::inner_closure => items.push(WalkItem::Edge(self.closure(kid))),
                Rule::pattern_node => items.push(WalkItem::Node(self.pattern_node(kid))),
                Rule::condition => {
                    let conds = kids(kid).map(|cond| WalkItem::Condition(self.expr(cond)));
                    items.extend(conds);
                }
                Rule::any_number => repeat = Some((0, None)),
                _ => repeat = kids(kid).next().map(|times| self.repeat(times)),
            }
        }
        if let [WalkItem::Edge(edge)] = items.as_slice()
            && edge.repeat.is_none()
        {
            let edge = edge.clone();
            return EdgePattern {
                repeat,
                span,
                ..edge
            };
        }
        EdgePattern {
            kind: EdgeKind::Walk(items),
            direction: EdgeDirection::Forward,
            repeat,
            span,
        }
    }

    fn repeat(&self, pair: Pair<'_, Rule>) -> (u32, Option<u32>) {
        match pair.as_rule() {
            Rule::zero_or_more => (0, None),
            Rule::one_or_more => (1, None),
            Rule::zero_or_one => (0, Some(1)),
            _ => self.times(pair),
        }
    }

    fn times(&self, pair: Pair<'_, Rule>) -> (u32, Option<u32>) {
        let span = self.span(&pair);
        let (mut numbers, mut is_open) = (vec![], false);
        for kid in kids(pair) {
            is_open |= kid.as_rule() == Rule::up_to;
            if kid.as_rule() == Rule::int {
                numbers.push(kid.as_str().parse::<u32>().unwrap_or(u32::MAX));
            }
        }
        let least = numbers.first().copied().unwrap_or(0);
        let most = if is_open {
            numbers.get(1).copied()
        } else {
            Some(least)
        };
        if most.is_some_and(|most| most < least) {
            let message = "the closure ends before it begins";
            self.report(
                Diagnostic::error("empty-closure", span, message).hint("write `{least, most}`"),
            );
        }
        (least, most)
    }

    fn edge(&self, pair: Pair<'_, Rule>) -> EdgePattern {
        use {EdgeDirection as D, EdgeKind as K};
        let span = self.span(&pair);
        let text = pair.as_str().trim_end();
        let (kind, direction) = match text {
            "<-->" => (K::Any, D::Both),
            "-->" => (K::Any, D::Forward),
            "<--" => (K::Any, D::Backward),
            "--" => (K::Any, D::Undirected),
            "<->" => (K::Successor, D::Both),
            "<" => (K::Successor, D::Backward),
            ">" => (K::Successor, D::Forward),
            "---" => (K::Successor, D::Undirected),
            "<+>" => (K::Branch, D::Both),
            "<+" => (K::Branch, D::Backward),
            "+>" => (K::Branch, D::Forward),
            "-+-" => (K::Branch, D::Undirected),
            "</>" => (K::Refinement, D::Both),
            "</" => (K::Refinement, D::Backward),
            "/>" => (K::Refinement, D::Forward),
            "-/-" => (K::Refinement, D::Undirected),
            _ => {
                return EdgePattern {
                    span,
                    ..self.named_edge(pair)
                };
            }
        };
        EdgePattern {
            kind,
            direction,
            repeat: None,
            span,
        }
    }

    fn named_edge(&self, pair: Pair<'_, Rule>) -> EdgePattern {
        let span = self.span(&pair);
        let (mut name, mut args) = (String::new(), vec![]);
        let (mut is_backward, mut is_forward) = (false, false);
        for kid in kids(pair).flat_map(kids) {
            match kid.as_rule() {
                Rule::edge_tail => is_backward = kid.as_str() == "<-",
                Rule::edge_tip => is_forward = kid.as_str() == "->",
                _ => (name, args) = self.relation(kid),
            }
        }
        let direction = match (is_backward, is_forward) {
            (true, true) => EdgeDirection::Both,
            (true, false) => EdgeDirection::Backward,
            (false, true) => EdgeDirection::Forward,
            (false, false) => EdgeDirection::Undirected,
        };
        EdgePattern {
            kind: EdgeKind::Named(name, args),
            direction,
            repeat: None,
            span,
        }
    }

    fn relation(&self, pair: Pair<'_, Rule>) -> (String, Vec<Expr>) {
        let (mut name, mut args) = (String::new(), vec![]);
        for kid in kids(pair) {
            if kid.as_rule() == Rule::args {
                args = self.args(kid);
            } else {
                let parts: Vec<String> = self.path(kid).into_iter().map(|part| part.name).collect();
                name = parts.join(".");
            }
        }
        (name, args)
    }

    // ── right sides ──

    pub(super) fn rhs(&self, pair: Pair<'_, Rule>) -> Vec<RhsItem> {
        kids(pair).map(|kid| self.rhs_item(kid)).collect()
    }

    fn rhs_item(&self, pair: Pair<'_, Rule>) -> RhsItem {
        let span = self.span(&pair);
        match pair.as_rule() {
            Rule::rhs_branch => RhsItem::Branch(self.rhs(pair), span),
            Rule::rhs_group => RhsItem::Group(self.rhs(pair), span),
            Rule::rhs_for | Rule::rhs_while | Rule::rhs_do | Rule::rhs_if => self.rhs_choice(pair),
            Rule::rhs_break => RhsItem::Break(span),
            Rule::separator => RhsItem::Separator(span),
            Rule::cut => RhsItem::Cut(span),
            Rule::block => RhsItem::Code(self.block(pair)),
            Rule::edge => RhsItem::Edge(self.edge(pair)),
            _ => RhsItem::Node(self.rhs_node(pair)),
        }
    }

    fn rhs_choice(&self, pair: Pair<'_, Rule>) -> RhsItem {
        let (span, which) = (self.span(&pair), pair.as_rule());
        let (mut head, mut cond, mut bodies) = (None, None, vec![]);
        for kid in kids(pair) {
            match kid.as_rule() {
                Rule::rhs_body => bodies.push(self.rhs_body(kid)),
                Rule::expr => cond = Some(self.expr(kid)),
                _ => head = Some(self.for_head(kid)),
            }
        }
        let mut bodies = bodies.into_iter();
        let body = bodies.next().unwrap_or_default();
        let cond = Box::new(cond.unwrap_or_else(|| Self::broken(span)));
        match which {
            Rule::rhs_while => RhsItem::While(cond, body, span),
            Rule::rhs_do => RhsItem::DoWhile(body, cond, span),
            Rule::rhs_if => RhsItem::If(cond, body, bodies.next().unwrap_or_default(), span),
            _ => {
                let head = head.unwrap_or_else(|| ForHead::Sequence(Self::broken(span)));
                RhsItem::For(Box::new(head), body, span)
            }
        }
    }

    /// What stands in the parentheses of a body, or the one thing without parentheses.
    fn rhs_body(&self, pair: Pair<'_, Rule>) -> Vec<RhsItem> {
        let mut items = vec![];
        for kid in kids(pair) {
            if kid.as_rule() == Rule::rhs_group {
                items.extend(self.rhs(kid));
            } else {
                items.push(self.rhs_item(kid));
            }
        }
        items
    }

    fn rhs_node(&self, pair: Pair<'_, Rule>) -> RhsNode {
        let span = self.span(&pair);
        let (mut label, mut name): (Option<Ident>, Option<Ident>) = (None, None);
        let mut expr = Self::broken(span);
        if self.is_too_long(&pair) {
            return RhsNode { label, expr, span };
        }
        for kid in kids(pair) {
            if let Some(name) = name.take_if(|_| kid.as_rule() != Rule::label_mark) {
                if matches!(kid.as_rule(), Rule::args | Rule::lambda_tail) {
                    expr = self.name_of(name, Some(kid));
                    continue;
                }
                expr = self.name_of(name, None);
            }
            match kid.as_rule() {
                Rule::ident => name = Some(self.ident(&kid)),
                Rule::label_mark => label = name.take(),
                Rule::root => {
                    expr = Expr {
                        kind: ExprKind::Name("^".to_owned()),
                        span: self.span(&kid),
                    }
                }
                Rule::with_block | Rule::member_access => expr = self.postfix(expr, kid),
                _ => expr = self.primary(kid),
            }
        }
        if let Some(name) = name {
            expr = self.name_of(name, None);
        }
        RhsNode { label, expr, span }
    }
}
