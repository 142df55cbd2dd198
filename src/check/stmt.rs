//! Statements.

use super::Checker;
use super::constant;
use super::context::{Collector, Label, Local};
use super::model::{Expr, Sequence, Slot, Stmt, StmtKind, Type};
use crate::diag::{Diagnostic, Span};
use crate::library::ClassId;
use crate::syntax::ast::{self, ForHead};

impl Checker<'_> {
    /// Statements in order, in the block at hand; wrong ones are left out.
    pub(super) fn stmts(&mut self, stmts: &[ast::Stmt]) -> Vec<Stmt> {
        stmts.iter().filter_map(|stmt| self.stmt(stmt)).collect()
    }

    /// Statements in a block of their own.
    pub(super) fn block(&mut self, block: &ast::Block) -> Vec<Stmt> {
        self.cx.open();
        let stmts = self.stmts(&block.stmts);
        self.cx.close();
        stmts
    }

    /// One statement; `None` if there is nothing to do or it is wrong.
    pub(super) fn stmt(&mut self, stmt: &ast::Stmt) -> Option<Stmt> {
        self.labeled_stmt(stmt, None)
    }

    /// A statement with the label before it, if any.
    fn labeled_stmt(&mut self, stmt: &ast::Stmt, label: Option<u16>) -> Option<Stmt> {
        let span = stmt.span;
        let kind = match &stmt.kind {
            ast::StmtKind::Empty | ast::StmtKind::Broken => return None,
            ast::StmtKind::Block(block) => StmtKind::Block(self.block(block)),
            ast::StmtKind::Rules(items) => StmtKind::Block(self.rules(items)),
            ast::StmtKind::Local(vars) => self.locals(vars),
            ast::StmtKind::Expr(e) => self.expr_stmt(e)?,
            ast::StmtKind::If(cond, yes, no) => {
                let cond = self.condition_of(cond);
                let yes = self.inner(yes);
                let no = no.as_ref().map(|no| Box::new(self.inner(no)));
                StmtKind::If(cond?, Box::new(yes), no)
            }
            ast::StmtKind::While(cond, body) => {
                let cond = self.condition_of(cond);
                let body = Box::new(self.loop_body(body));
                StmtKind::Loop {
                    label,
                    init: vec![],
                    cond: Some(cond?),
                    is_do: false,
                    update: vec![],
                    body,
                }
            }
            ast::StmtKind::DoWhile(body, cond) => {
                let body = Box::new(self.loop_body(body));
                let cond = self.condition_of(cond);
                StmtKind::Loop {
                    label,
                    init: vec![],
                    cond: Some(cond?),
                    is_do: true,
                    update: vec![],
                    body,
                }
            }
            ast::StmtKind::For(head, body) => {
                self.cx.open();
                let kind = self.for_stmt(head, body, label, span);
                self.cx.close();
                kind?
            }
            ast::StmtKind::Switch(value, cases) => self.switch(value, cases)?,
            ast::StmtKind::Return(value) => self.return_stmt(value.as_ref(), span)?,
            ast::StmtKind::Break(target) => {
                StmtKind::Break(self.jump_target(target.as_ref(), true, span)?)
            }
            ast::StmtKind::Continue(target) => {
                StmtKind::Continue(self.jump_target(target.as_ref(), false, span)?)
            }
            ast::StmtKind::Labeled(name, inner) => return self.label(name, inner, span),
            ast::StmtKind::Throw(value) => self.throw(value)?,
            ast::StmtKind::Try {
                body,
                catches,
                finally,
            } => self.try_stmt(body, catches, finally.as_ref()),
            ast::StmtKind::Class(class) => {
                self.refuse_class(class);
                return None;
            }
        };
        Some(Stmt { kind, span })
    }

    /// A statement as the body of another: always one, in a block of its own.
    fn inner(&mut self, stmt: &ast::Stmt) -> Stmt {
        self.cx.open();
        let checked = self.stmt(stmt);
        self.cx.close();
        checked.unwrap_or(Stmt {
            kind: StmtKind::Block(vec![]),
            span: stmt.span,
        })
    }

    fn loop_body(&mut self, stmt: &ast::Stmt) -> Stmt {
        self.cx.loops += 1;
        let body = self.inner(stmt);
        self.cx.loops -= 1;
        body
    }

    /// A condition of `if` and loops.
    pub(super) fn condition_of(&mut self, e: &ast::Expr) -> Option<Expr> {
        let cond = self.value(e)?;
        self.boolean(cond)
    }

    /// An expression as a statement: it must do something.
    fn expr_stmt(&mut self, e: &ast::Expr) -> Option<StmtKind> {
        let does_something = matches!(
            e.kind,
            ast::ExprKind::Call(..)
                | ast::ExprKind::Assign(..)
                | ast::ExprKind::Deferred(..)
                | ast::ExprKind::IncDec { .. }
                | ast::ExprKind::New(..)
                | ast::ExprKind::With(..)
                | ast::ExprKind::Comma(_)
                | ast::ExprKind::Broken
        );
        // A query or a range in it makes it a loop: `(* Leaf *).grow();` is done for every leaf.
        self.cx.open();
        let outer = std::mem::replace(&mut self.cx.collector, Collector::Open);
        let checked = self.expr(e);
        let found = std::mem::replace(&mut self.cx.collector, outer);
        self.cx.close();
        let checked = checked?;
        if !does_something {
            self.report(
                Diagnostic::error("no-effect", e.span, "this statement does nothing")
                    .label("a value that is not used"),
            );
            return None;
        }
        let Collector::Found(sequence, slot) = found else {
            return Some(StmtKind::Expr(checked));
        };
        if super::aggregate::keeps_last(e) {
            let message = "of several values only the last one is kept";
            let warning = Diagnostic::warning("last-value", e.span, message);
            self.report(
                warning.hint("write `first( … )`, `sum( … )` or the like around the query"),
            );
        }
        let body = Stmt {
            kind: StmtKind::Expr(checked),
            span: e.span,
        };
        Some(StmtKind::ForEach {
            label: None,
            slot: Some(slot),
            sequence,
            body: Box::new(body),
        })
    }

    /// `int a = 1, b;`: one statement per variable.
    fn locals(&mut self, vars: &[ast::LocalVar]) -> StmtKind {
        let mut checked: Vec<Stmt> = vec![];
        for var in vars {
            let span = var.name.span;
            let ty = self.resolve_value_type(&var.ty);
            let init = match (&var.init, &ty) {
                (Some(init), Some(ty)) => self.initial_value(init, ty),
                (Some(init), None) => self.expr(init).and(None),
                (None, _) => None,
            };
            let value = if var.is_final {
                init.as_ref().and_then(constant::value_of)
            } else {
                None
            };
            let is_final = var.is_final && var.init.is_some();
            let slot = self.declare_local(&var.name, ty, is_final, value);
            checked.push(Stmt {
                kind: StmtKind::Local(slot, init),
                span,
            });
        }
        match checked.pop() {
            Some(only) if checked.is_empty() => only.kind,
            last => {
                checked.extend(last);
                StmtKind::Block(checked)
            }
        }
    }

    /// Adds a variable to the innermost block; two of one name in the same block are a fault.
    pub(super) fn declare_local(
        &mut self,
        name: &ast::Ident,
        ty: Option<Type>,
        is_final: bool,
        value: Option<super::model::Constant>,
    ) -> Slot {
        if let Some(first) = self.cx.local_here(&name.name) {
            let message = format!("variable `{}` is declared twice in this block", name.name);
            let fault = Diagnostic::error("duplicate-variable", name.span, message);
            let first = self.cx.slot_span(first.slot);
            self.report(first.map_or(fault.clone(), |first| fault.also(first, "first here")));
        }
        let slot = self.cx.slot(ty.clone().unwrap_or(Type::Object), name.span);
        self.cx.declare(Local {
            name: name.name.clone(),
            ty,
            slot,
            is_final,
            value,
        });
        slot
    }

    fn for_stmt(
        &mut self,
        head: &ForHead,
        body: &ast::Stmt,
        label: Option<u16>,
        span: Span,
    ) -> Option<StmtKind> {
        match head {
            ForHead::Classic { init, cond, update } => {
                let init = self.stmts(init);
                let has_cond = cond.is_some();
                let cond = cond.as_ref().and_then(|cond| self.condition_of(cond));
                let update = update.iter().filter_map(|e| self.expr(e)).collect();
                let body = Box::new(self.loop_body(body));
                (cond.is_some() || !has_cond).then_some(StmtKind::Loop {
                    label,
                    init,
                    cond,
                    is_do: false,
                    update,
                    body,
                })
            }
            ForHead::Each { var, sequence } => {
                let head = self.for_each_head(var, sequence, span);
                let body = Box::new(self.loop_body(body));
                let (slot, sequence) = head?;
                Some(StmtKind::ForEach {
                    label,
                    slot: Some(slot),
                    sequence,
                    body,
                })
            }
            ForHead::Sequence(sequence) => {
                let sequence = self.for_sequence(sequence);
                let body = Box::new(self.loop_body(body));
                Some(StmtKind::ForEach {
                    label,
                    slot: None,
                    sequence: sequence?.0,
                    body,
                })
            }
        }
    }

    /// `T x : sequence`: the variable's slot, and the values converted to its type.
    pub(super) fn for_each_head(
        &mut self,
        var: &ast::LocalVar,
        sequence: &ast::Expr,
        span: Span,
    ) -> Option<(Slot, Sequence)> {
        let is_typed = !var.ty.path.is_empty();
        let ty = is_typed.then(|| self.resolve_value_type(&var.ty));
        let sequence = self.for_sequence(sequence);
        let inferred = || sequence.as_ref().map(|(_, element)| element.clone());
        let ty = ty.unwrap_or_else(inferred);
        let slot = self.declare_local(&var.name, ty.clone(), var.is_final, None);
        let (ty, (sequence, element)) = (ty?, sequence?);
        if element == ty {
            return Some((slot, sequence));
        }
        // Elements of lists are cast to the variable's type, as if the list had that type argument.
        let is_open = element == Type::Object;
        if self.fit(&element, &ty).is_none() && !is_open {
            let fault = self.mismatch(&element, &ty, var.name.span);
            self.report(fault);
            return None;
        }
        let mapped = if is_open {
            self.opened(sequence, &ty, span)
        } else {
            self.converted(sequence, &element, &ty, span)
        };
        Some((slot, mapped))
    }

    /// The objects of a list, each cast to a type.
    pub(super) fn opened(&mut self, sequence: Sequence, ty: &Type, span: Span) -> Sequence {
        use super::model::{ExprKind, Place};
        let slot = self.cx.slot(Type::Object, span);
        let read = Expr {
            kind: ExprKind::Read(Place::Local(slot)),
            ty: Type::Object,
            span,
        };
        let object = super::types::boxed(ty).map_or(ty.clone(), Type::Class);
        let cast = Expr {
            kind: ExprKind::Cast(Box::new(read)),
            ty: object,
            span,
        };
        let body = self.convert(cast, ty);
        Sequence::Map {
            source: Box::new(sequence),
            slot,
            body: Box::new(body),
        }
    }

    fn return_stmt(&mut self, value: Option<&ast::Expr>, span: Span) -> Option<StmtKind> {
        let result = self.cx.result.clone();
        let Some(value) = value else {
            if let Some(result) = result.filter(|r| *r != Type::Void) {
                let message = format!("`return` must give a `{}` here", self.type_name(&result));
                self.report(Diagnostic::error("missing-value", span, message));
                return None;
            }
            return Some(StmtKind::Return(None));
        };
        match result {
            Some(Type::Void) => {
                self.expr(value);
                self.report(Diagnostic::error(
                    "unwanted-value",
                    value.span,
                    "this method gives no value, it is `void`",
                ));
                None
            }
            Some(result) => Some(StmtKind::Return(Some(self.initial_value(value, &result)?))),
            None => self.expr(value).and(None),
        }
    }

    /// The label a jump goes to; `Some(None)` is the innermost loop (or switch).
    fn jump_target(
        &mut self,
        target: Option<&ast::Ident>,
        is_break: bool,
        span: Span,
    ) -> Option<Option<u16>> {
        let word = if is_break { "break" } else { "continue" };
        let Some(target) = target else {
            let is_inside = self.cx.loops > 0 || (is_break && self.cx.switches > 0);
            if !is_inside {
                self.report(Diagnostic::error(
                    "loose-break",
                    span,
                    format!("`{word}` stands in no loop"),
                ));
            }
            return is_inside.then_some(None);
        };
        match self
            .cx
            .labels
            .iter()
            .rev()
            .find(|label| label.name == target.name)
        {
            Some(label) if is_break || label.is_loop => Some(Some(label.number)),
            Some(_) => {
                let message = format!("`{}` is no loop", target.name);
                self.report(Diagnostic::error("bad-label", target.span, message));
                None
            }
            None => {
                let fault = Diagnostic::error(
                    "unknown-label",
                    target.span,
                    format!("unknown label `{}`", target.name),
                );
                let names: Vec<&str> = self
                    .cx
                    .labels
                    .iter()
                    .map(|label| label.name.as_str())
                    .collect();
                let fault = self.did_you_mean(fault, &target.name, names);
                self.report(fault);
                None
            }
        }
    }

    fn label(&mut self, name: &ast::Ident, inner: &ast::Stmt, span: Span) -> Option<Stmt> {
        use ast::StmtKind as Kind;
        let is_loop = matches!(
            inner.kind,
            Kind::While(..) | Kind::DoWhile(..) | Kind::For(..)
        );
        let number = self.cx.n_labels;
        self.cx.n_labels = self.cx.n_labels.saturating_add(1);
        self.cx.labels.push(Label {
            name: name.name.clone(),
            number,
            is_loop,
        });
        let checked = self.labeled_stmt(inner, is_loop.then_some(number));
        self.cx.labels.pop();
        let checked = checked?;
        if is_loop {
            return Some(checked);
        }
        Some(Stmt {
            kind: StmtKind::Labeled(number, Box::new(checked)),
            span,
        })
    }

    fn throw(&mut self, value: &ast::Expr) -> Option<StmtKind> {
        let value = self.value(value)?;
        let is_throwable = self.is_subtype(&value.ty, &Type::Class(ClassId::Throwable));
        if !is_throwable && value.ty != Type::String {
            let message = format!(
                "only exceptions can be thrown, found `{}`",
                self.type_name(&value.ty)
            );
            let fault = Diagnostic::error("bad-throw", value.span, message);
            self.report(fault.hint("write `throw new RuntimeException(\"…\")`"));
            return None;
        }
        Some(StmtKind::Throw(value))
    }

    /// The type of an exception that is caught; reported if it cannot be thrown.
    fn caught_type(&mut self, ty: &ast::TypeRef) -> Option<Type> {
        let found = self.resolve_value_type(ty)?;
        if !self.is_subtype(&found, &Type::Class(ClassId::Throwable)) {
            let message = format!(
                "only exceptions can be caught, found `{}`",
                self.type_name(&found)
            );
            self.report(Diagnostic::error("bad-catch", ty.span, message));
        }
        Some(found)
    }

    fn try_stmt(
        &mut self,
        body: &ast::Block,
        catches: &[ast::Catch],
        finally: Option<&ast::Block>,
    ) -> StmtKind {
        let body = self.block(body);
        let mut handlers = vec![];
        for catch in catches {
            self.cx.open();
            let mut types = vec![];
            for ty in &catch.types {
                types.extend(self.caught_type(ty));
            }
            // What several types have in common is that they can be thrown.
            let ty = match types.as_slice() {
                [] => None,
                [only] => Some(only.clone()),
                _ => Some(Type::Class(ClassId::Throwable)),
            };
            let slot = self.declare_local(&catch.name, ty, false, None);
            let handler = self.stmts(&catch.body.stmts);
            self.cx.close();
            handlers.push((types, slot, handler));
        }
        let finally = finally.map_or(vec![], |block| self.block(block));
        StmtKind::Try {
            body,
            catches: handlers,
            finally,
        }
    }
}
