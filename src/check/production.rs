//! Right-hand sides.

use super::Checker;
use super::context::Local;
use super::edge::edge_way;
use super::model::{Expr, Production, Type};
use super::names::Binding;
use crate::diag::{Diagnostic, Span};
use crate::graph::pattern::EdgeKind;
use crate::syntax::ast::{self, ForHead, RhsItem};

impl Checker<'_> {
    /// The items of a right-hand side, in order; wrong ones are left out.
    pub(super) fn productions(&mut self, items: &[RhsItem]) -> Vec<Production> {
        items
            .iter()
            .filter_map(|item| self.production(item))
            .collect()
    }

    /// A whole right-hand side or instantiation body. `break` outside of the loops in it ends it: for a rule, what was made
    /// until then is applied, and the next match follows.
    pub(super) fn whole_production(&mut self, items: &[RhsItem]) -> Vec<Production> {
        let outer = std::mem::replace(&mut self.cx.loops, 1);
        let body = self.productions(items);
        self.cx.loops = outer;
        body
    }

    /// Items with a block of their own for labels.
    fn inner_productions(&mut self, items: &[RhsItem]) -> Vec<Production> {
        self.cx.open();
        let inner = self.productions(items);
        self.cx.close();
        inner
    }

    fn production(&mut self, item: &RhsItem) -> Option<Production> {
        Some(match item {
            RhsItem::Node(node) => self.rhs_node(node)?,
            RhsItem::Edge(edge) => self.rhs_edge(edge)?,
            RhsItem::Branch(items, _) => Production::Branch(self.productions(items)),
            RhsItem::Group(items, _) => Production::Group(self.productions(items)),
            RhsItem::Separator(_) => Production::Separator,
            RhsItem::For(head, body, span) => return self.rhs_for(head, body, *span),
            RhsItem::While(cond, body, _) | RhsItem::DoWhile(body, cond, _) => {
                let cond = self.condition_of(cond);
                let body = self.loop_productions(body);
                Production::Loop {
                    init: vec![],
                    cond: Some(cond?),
                    is_first_free: matches!(item, RhsItem::DoWhile(..)),
                    update: vec![],
                    body,
                }
            }
            RhsItem::If(cond, yes, no, _) => {
                let cond = self.condition_of(cond);
                let (yes, no) = (self.inner_productions(yes), self.inner_productions(no));
                Production::If(cond?, yes, no)
            }
            RhsItem::Code(block) => Production::Code(self.stmts(&block.stmts)),
            RhsItem::Break(_) => Production::Break,
            RhsItem::Cut(_) => Production::Cut,
        })
    }

    fn loop_productions(&mut self, items: &[RhsItem]) -> Vec<Production> {
        self.cx.loops += 1;
        let inner = self.inner_productions(items);
        self.cx.loops -= 1;
        inner
    }

    fn rhs_edge(&mut self, edge: &ast::EdgePattern) -> Option<Production> {
        let kind = self.edge_kind(edge)?;
        let is_made = matches!(
            kind,
            EdgeKind::Successor | EdgeKind::Branch | EdgeKind::Refinement | EdgeKind::User(_)
        );
        if !is_made || edge.repeat.is_some() {
            let fault = Diagnostic::error(
                "bad-edge",
                edge.span,
                "this edge can be looked for, but not be made",
            );
            self.report(
                fault.hint("make `>` (successor), `+>` (branch), `/>` (refinement) or `-EDGE_0->`"),
            );
            return None;
        }
        Some(Production::Edge(kind, edge_way(edge.direction)))
    }

    fn rhs_node(&mut self, node: &ast::RhsNode) -> Option<Production> {
        let checked = self.rhs_expr(&node.expr);
        let Some(checked) = checked else {
            // The label is known all the same, so that its uses are not reported too.
            if let Some(label) = &node.label {
                let slot = self.cx.slot(Type::Node(self.node), label.span);
                self.cx.declare(Local {
                    name: label.name.clone(),
                    ty: None,
                    slot,
                    is_final: true,
                    value: None,
                });
            }
            return None;
        };
        if !matches!(checked.ty, Type::Node(_)) {
            let message = format!(
                "a node is needed here, found `{}`",
                self.type_name(&checked.ty)
            );
            let fault = Diagnostic::error("not-a-node", node.expr.span, message);
            self.report(fault.hint("put code into `{ … }`"));
            return None;
        }
        let slot = node.label.as_ref().map(|label| {
            let slot = self.cx.slot(checked.ty.clone(), label.span);
            let ty = Some(checked.ty.clone());
            self.cx.declare(Local {
                name: label.name.clone(),
                ty,
                slot,
                is_final: false,
                value: None,
            });
            slot
        });
        Some(Production::Node {
            node: checked,
            slot,
        })
    }

    /// What stands for a node: here `F` and `F(1)` make new nodes.
    fn rhs_expr(&mut self, e: &ast::Expr) -> Option<Expr> {
        match &e.kind {
            ast::ExprKind::Name(name) if name != "^" => self.rhs_name(name, e.span),
            ast::ExprKind::Call(callee, args) => match &callee.kind {
                ast::ExprKind::Name(name) => match self.node_type(name) {
                    Some(id) => {
                        let args = self.exprs(args)?;
                        self.new_node(id, args, e.span)
                    }
                    None if self.method_names.contains_key(name) || self.is_function(name) => {
                        self.called_node(e)
                    }
                    None => {
                        let _args = self.exprs(args);
                        if !self.refused.contains(name) {
                            let fault = self.unknown_node_type(name, callee.span);
                            self.report(fault);
                        }
                        None
                    }
                },
                _ => self.value(e),
            },
            ast::ExprKind::With(object, body) => {
                let object = self.rhs_expr(object)?;
                self.with(object, body, e.span)
            }
            _ => self.value(e),
        }
    }

    /// A call that gives a node.
    fn called_node(&mut self, e: &ast::Expr) -> Option<Expr> {
        let called = self.expr(e)?;
        if called.ty == Type::Void {
            let message = "a node is needed here; this gives no value";
            let fault = Diagnostic::error("not-a-node", e.span, message).label("is `void`");
            self.report(fault.hint("put code into `{ … }`"));
            return None;
        }
        Some(called)
    }

    fn is_function(&self, name: &str) -> bool {
        !crate::library::functions_named("", name).is_empty()
            || super::aggregate::NAMES.contains(&name)
    }

    /// A bare name: a label or a variable that holds a node, else a type.
    fn rhs_name(&mut self, name: &str, span: Span) -> Option<Expr> {
        let is_local = self.cx.has_local(name);
        if !is_local && let Some(id) = self.node_type(name) {
            return self.new_node(id, vec![], span);
        }
        match self.lookup(name, span) {
            Some(Binding::Target(target)) if matches!(target.ty, Type::Node(_)) => {
                Some(self.read(target, span))
            }
            Some(Binding::Poisoned) => None,
            Some(Binding::Target(_) | Binding::Value(_)) => match self.node_type(name) {
                // A variable of another type with the name of a module.
                Some(id) => self.new_node(id, vec![], span),
                None => self.value(&ast::Expr {
                    kind: ast::ExprKind::Name(name.into()),
                    span,
                }),
            },
            None => {
                if !self.refused.contains(name) {
                    let fault = self.unknown_node_type(name, span);
                    self.report(fault);
                }
                None
            }
        }
    }

    fn rhs_for(&mut self, head: &ForHead, body: &[RhsItem], span: Span) -> Option<Production> {
        self.cx.open();
        let production = match head {
            ForHead::Classic { init, cond, update } => {
                let init = self.stmts(init);
                let has_cond = cond.is_some();
                let cond = cond.as_ref().and_then(|cond| self.condition_of(cond));
                let update: Vec<Expr> = update.iter().filter_map(|e| self.expr(e)).collect();
                let body = self.loop_productions(body);
                (cond.is_some() || !has_cond).then_some(Production::Loop {
                    init,
                    cond,
                    is_first_free: false,
                    update,
                    body,
                })
            }
            ForHead::Each { var, sequence } => {
                let head = self.for_each_head(var, sequence, span);
                let body = self.loop_productions(body);
                head.map(|(slot, sequence)| Production::ForEach(Some(slot), sequence, body))
            }
            ForHead::Sequence(sequence) => {
                let sequence = self.for_sequence(sequence);
                let body = self.loop_productions(body);
                sequence.map(|(sequence, _)| Production::ForEach(None, sequence, body))
            }
        };
        self.cx.close();
        production
    }
}
