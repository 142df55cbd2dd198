//! From the checked model to closures.
//!
//! Each file makes code of one kind of construct; all are methods of [`Scope`], which knows the frame that the code will
//! run in. Nothing here runs anything.

mod aggregates;
mod arrays;
mod calls;
mod convert;
mod expressions;
mod held;
mod library;
mod loops;
mod operators;
mod places;
mod plain;
mod productions;
mod rules;
mod sequences;
mod statements;

use std::cell::Cell;

use super::code::{Exec, FromCode, Source};
use super::program::Outline;
use super::stack::{Layout, Local, is_word};
use super::value::Value;
use crate::check::model::{Expr, Model, Production, Slot, Stmt, Type};
use crate::graph::NodeId;

/// The frame for which code is made.
pub(super) struct Scope<'m> {
    /// The whole model.
    pub(super) model: &'m Model,
    /// Where the variables of the model live.
    pub(super) outline: &'m Outline,
    locals: Layout,
    /// What `return` gives.
    result: &'m Type,
    /// Words and values of the frame so far, temporaries included.
    n_words: Cell<u32>,
    n_values: Cell<u32>,
}

impl<'m> Scope<'m> {
    /// A frame with slots of these types.
    pub(super) fn new(
        model: &'m Model,
        outline: &'m Outline,
        frame: &[Type],
        result: &'m Type,
    ) -> Self {
        let locals = Layout::new(frame);
        let (n_words, n_values) = locals.size();
        Self {
            model,
            outline,
            locals,
            result,
            n_words: Cell::new(n_words),
            n_values: Cell::new(n_values),
        }
    }

    /// The layout that the code made needs.
    pub(super) fn into_layout(self) -> Layout {
        self.locals
            .with_size(self.n_words.get(), self.n_values.get())
    }

    fn local(&self, slot: Slot) -> Local {
        self.locals.local(slot)
    }

    fn static_local(&self, id: u32) -> Local {
        self.outline.statics.local_at(id as usize)
    }

    /// Place for a value that no variable of the model holds.
    fn temporary(&self, ty: &Type) -> u32 {
        let counter = if is_word(ty) {
            &self.n_words
        } else {
            &self.n_values
        };
        let at = counter.get();
        counter.set(at.saturating_add(1));
        at
    }

    /// An expression as the kind of value that the caller needs.
    fn source<T: FromCode>(&self, expr: &Expr) -> Source<T> {
        T::from_code(self.expr(expr))
    }

    fn boolean(&self, expr: &Expr) -> Source<bool> {
        self.source(expr)
    }

    fn int(&self, expr: &Expr) -> Source<i32> {
        self.source(expr)
    }

    fn node(&self, expr: &Expr) -> Source<Option<NodeId>> {
        self.source(expr)
    }

    /// An expression as a boxed value, numbers in the box of their own type.
    fn value(&self, expr: &Expr) -> Source<Value> {
        convert::boxed(self.expr(expr), &expr.ty)
    }

    /// Many expressions as boxed values.
    fn values(&self, exprs: &[Expr]) -> Vec<Source<Value>> {
        exprs.iter().map(|e| self.value(e)).collect()
    }

    /// The code of a method or constructor.
    pub(super) fn body(&self, body: &[Stmt]) -> Exec {
        self.block(body)
    }

    /// The code of an instantiation body.
    pub(super) fn instantiation(&self, body: &[Production]) -> Exec {
        self.productions(body)
    }
}
