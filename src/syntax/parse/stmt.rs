//! Statements.

use super::grammar::Rule;
use super::item::with_dims;
use super::{Reader, kids};
use crate::syntax::ast::{
    Block, Catch, Class, Expr, ExprKind, ForHead, Ident, LocalVar, Modifiers, Stmt, StmtKind,
    SwitchCase, TypeRef,
};
use pest::iterators::Pair;

impl Reader<'_> {
    pub(super) fn statement(&self, pair: Pair<'_, Rule>) -> Stmt {
        let span = self.span(&pair);
        let kind = match pair.as_rule() {
            Rule::empty => StmtKind::Empty,
            Rule::block => StmtKind::Block(self.block(pair)),
            Rule::rules => StmtKind::Rules(self.rule_items(pair)),
            Rule::switch_statement => self.switch(pair),
            Rule::return_statement => {
                StmtKind::Return(kids(pair).next().map(|value| self.expr(value)))
            }
            Rule::break_statement => StmtKind::Break(self.target(pair)),
            Rule::continue_statement => StmtKind::Continue(self.target(pair)),
            Rule::try_statement => self.try_statement(pair),
            Rule::assertion => StmtKind::Empty,
            Rule::synchronized => {
                let body = kids(pair).find(|kid| kid.as_rule() == Rule::block);
                StmtKind::Block(body.map_or_else(Block::default, |body| self.block(body)))
            }
            Rule::labeled => return self.labeled(pair),
            Rule::local => self.local(pair),
            _ => self.compound(pair),
        };
        Stmt { kind, span }
    }

    /// Statements made of expressions and statements only.
    fn compound(&self, pair: Pair<'_, Rule>) -> StmtKind {
        let which = pair.as_rule();
        let (mut exprs, mut stmts, mut head) = (vec![], vec![], None);
        for kid in kids(pair) {
            match kid.as_rule() {
                Rule::expr => exprs.push(self.expr(kid)),
                Rule::for_each | Rule::for_classic | Rule::range => head = Some(self.for_head(kid)),
                _ => stmts.push(self.statement(kid)),
            }
        }
        let expr = exprs.into_iter().next();
        let mut stmts = stmts.into_iter().map(Box::new);
        match (which, expr, stmts.next(), head) {
            (Rule::if_statement, Some(cond), Some(then), _) => {
                StmtKind::If(cond, then, stmts.next())
            }
            (Rule::while_statement, Some(cond), Some(body), _) => StmtKind::While(cond, body),
            (Rule::do_statement, Some(cond), Some(body), _) => StmtKind::DoWhile(body, cond),
            (Rule::for_statement, _, Some(body), Some(head)) => StmtKind::For(head, body),
            (Rule::throw_statement, Some(value), ..) => StmtKind::Throw(value),
            (_, Some(value), ..) => StmtKind::Expr(value),
            _ => StmtKind::Broken,
        }
    }

    fn target(&self, pair: Pair<'_, Rule>) -> Option<Ident> {
        kids(pair).next().map(|label| self.ident(&label))
    }

    fn labeled(&self, pair: Pair<'_, Rule>) -> Stmt {
        let end = self.span(&pair);
        let (mut labels, mut body) = (
            vec![],
            Stmt {
                kind: StmtKind::Empty,
                span: end,
            },
        );
        for kid in kids(pair) {
            if kid.as_rule() == Rule::label {
                labels.push(self.first_ident(&kid));
            } else {
                body = self.statement(kid);
            }
        }
        labels.into_iter().rev().fold(body, |body, label| {
            let span = label.span.to(body.span);
            Stmt {
                kind: StmtKind::Labeled(label, Box::new(body)),
                span,
            }
        })
    }

    /// Variables or a class, from their modifiers on.
    fn local(&self, pair: Pair<'_, Rule>) -> StmtKind {
        let span = self.span(&pair);
        let mut modifiers = Modifiers::default();
        for kid in kids(pair) {
            match kid.as_rule() {
                Rule::modifier_word => self.modifier(&kid, &mut modifiers),
                Rule::variables => return StmtKind::Local(self.variables(kid, &modifiers)),
                Rule::class => {
                    return StmtKind::Class(Box::new(Class {
                        span,
                        ..self.class(kid, modifiers)
                    }));
                }
                _ => {}
            }
        }
        StmtKind::Empty
    }

    fn variables(&self, pair: Pair<'_, Rule>, modifiers: &Modifiers) -> Vec<LocalVar> {
        let mut ty = TypeRef {
            path: vec![],
            args: vec![],
            dims: 0,
            span: self.span(&pair),
        };
        let mut found = vec![];
        for kid in kids(pair) {
            match kid.as_rule() {
                Rule::type_ref => ty = self.type_ref(kid),
                Rule::declarator => {
                    let (name, dims, init) = self.declarator(kid);
                    found.push(LocalVar {
                        is_final: modifiers.is_final,
                        ty: with_dims(ty.clone(), dims),
                        name,
                        init,
                    });
                }
                _ => {}
            }
        }
        found
    }

    pub(super) fn for_head(&self, pair: Pair<'_, Rule>) -> ForHead {
        match pair.as_rule() {
            Rule::for_each => self.for_each(pair),
            Rule::for_classic => self.for_classic(pair),
            _ => ForHead::Sequence(self.range(pair)),
        }
    }

    fn for_each(&self, pair: Pair<'_, Rule>) -> ForHead {
        let span = self.span(&pair);
        let name = self.first_ident(&pair);
        let mut modifiers = Modifiers::default();
        let mut ty = TypeRef {
            path: vec![],
            args: vec![],
            dims: 0,
            span,
        };
        let mut sequence = Self::broken(span);
        for kid in kids(pair) {
            match kid.as_rule() {
                Rule::modifier_word => self.modifier(&kid, &mut modifiers),
                Rule::type_ref => ty = self.type_ref(kid),
                Rule::range => sequence = self.range(kid),
                _ => {}
            }
        }
        // `for (a:b)` goes from `a` to `b`; with more than one value behind the colon `a` is a variable.
        if ty.path.is_empty()
            && !matches!(sequence.kind, ExprKind::Range(..))
            && !has_query(&sequence)
        {
            let from = Expr {
                kind: ExprKind::Name(name.name),
                span: name.span,
            };
            let kind = ExprKind::Range(Box::new(from), Box::new(sequence));
            return ForHead::Sequence(Expr { kind, span });
        }
        ForHead::Each {
            var: LocalVar {
                is_final: modifiers.is_final,
                ty,
                name,
                init: None,
            },
            sequence,
        }
    }

    fn for_classic(&self, pair: Pair<'_, Rule>) -> ForHead {
        let (mut init, mut cond, mut update) = (vec![], None, vec![]);
        for kid in kids(pair) {
            match kid.as_rule() {
                Rule::for_init => init = self.for_init(kid),
                Rule::for_cond => cond = kids(kid).next().map(|cond| self.expr(cond)),
                _ => update = kids(kid).map(|part| self.expr(part)).collect(),
            }
        }
        ForHead::Classic { init, cond, update }
    }

    fn resource(&self, pair: Pair<'_, Rule>) -> Vec<LocalVar> {
        match self.local(pair) {
            StmtKind::Local(variables) => variables,
            _ => vec![],
        }
    }

    fn for_init(&self, pair: Pair<'_, Rule>) -> Vec<Stmt> {
        let span = self.span(&pair);
        let mut modifiers = Modifiers::default();
        let mut init = vec![];
        for kid in kids(pair) {
            match kid.as_rule() {
                Rule::modifier_word => self.modifier(&kid, &mut modifiers),
                Rule::variables => init.push(Stmt {
                    kind: StmtKind::Local(self.variables(kid, &modifiers)),
                    span,
                }),
                Rule::expr => init.push(Self::expr_stmt(self.expr(kid))),
                _ => {}
            }
        }
        init
    }

    fn switch(&self, pair: Pair<'_, Rule>) -> StmtKind {
        let mut value = Self::broken(self.span(&pair));
        let mut cases = vec![];
        for kid in kids(pair) {
            if kid.as_rule() == Rule::expr {
                value = self.expr(kid);
            } else {
                cases.push(self.switch_case(kid));
            }
        }
        StmtKind::Switch(value, cases)
    }

    fn switch_case(&self, pair: Pair<'_, Rule>) -> SwitchCase {
        let mut case = SwitchCase {
            value: None,
            body: vec![],
        };
        for kid in kids(pair) {
            if kid.as_rule() == Rule::expr {
                case.value = Some(self.expr(kid));
            } else {
                case.body.push(self.statement(kid));
            }
        }
        case
    }

    fn try_statement(&self, pair: Pair<'_, Rule>) -> StmtKind {
        let (mut body, mut catches, mut finally) = (Block::default(), vec![], None);
        let mut resources = vec![];
        for kid in kids(pair) {
            match kid.as_rule() {
                Rule::resources => {
                    resources.extend(kids(kid).flat_map(|part| self.resource(part)));
                }
                Rule::catch_clause => catches.push(self.catch_clause(kid)),
                Rule::finally_clause => finally = kids(kid).next().map(|block| self.block(block)),
                _ => body = self.block(kid),
            }
        }
        let body = resources.into_iter().rev().fold(body, with_resource);
        StmtKind::Try {
            body,
            catches,
            finally,
        }
    }

    fn catch_clause(&self, pair: Pair<'_, Rule>) -> Catch {
        let mut catch = Catch {
            types: vec![],
            name: self.first_ident(&pair),
            body: Block::default(),
        };
        for kid in kids(pair) {
            match kid.as_rule() {
                Rule::type_ref => catch.types.push(self.type_ref(kid)),
                Rule::block => catch.body = self.block(kid),
                _ => {}
            }
        }
        catch
    }

    /// The statements of `.( … )`.
    pub(super) fn with_block(&self, pair: Pair<'_, Rule>) -> Vec<Stmt> {
        kids(pair)
            .map(|part| Self::expr_stmt(self.expr(part)))
            .collect()
    }

    pub(super) fn args(&self, pair: Pair<'_, Rule>) -> Vec<Expr> {
        kids(pair).map(|arg| self.range(arg)).collect()
    }
}

/// `{ R r = …; try { body } finally { r.close(); } }`
fn with_resource(body: Block, resource: LocalVar) -> Block {
    let span = body.span;
    let at = |kind| Stmt { kind, span };
    let value = |kind| Expr { kind, span };
    let close = Ident {
        name: "close".into(),
        span: resource.name.span,
    };
    let object = value(ExprKind::Name(resource.name.name.clone()));
    let callee = value(ExprKind::Member(Box::new(object), close));
    let call = value(ExprKind::Call(Box::new(callee), vec![]));
    let guarded = StmtKind::Try {
        body,
        catches: vec![],
        finally: Some(Block {
            stmts: vec![at(StmtKind::Expr(call))],
            span,
        }),
    };
    Block {
        stmts: vec![at(StmtKind::Local(vec![resource])), at(guarded)],
        span,
    }
}

/// Whether an expression is a query, or goes on from one.
fn has_query(value: &Expr) -> bool {
    let mut at = value;
    loop {
        at = match &at.kind {
            ExprKind::Query(_) => return true,
            ExprKind::Member(object, _)
            | ExprKind::Index(object, _)
            | ExprKind::With(object, _)
            | ExprKind::Call(object, _) => object,
            _ => return false,
        };
    }
}
