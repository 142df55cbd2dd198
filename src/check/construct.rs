//! `new` of library objects.

use super::Checker;
use super::model::{Expr, ExprKind, Type};
use super::overload::Overload;
use crate::diag::{Diagnostic, Span};
use crate::library::{self, ClassId, ConstructorId};

impl Checker<'_> {
    /// `new C(args)` of a library class.
    pub(super) fn new_library_object(
        &mut self,
        class: ClassId,
        args: Vec<Expr>,
        span: Span,
    ) -> Option<Expr> {
        let all = library::constructors_of(class);
        if all.is_empty() {
            let message = format!("`{}` cannot be made with `new`", class.name());
            self.report(Diagnostic::error("bad-new", span, message));
            return None;
        }
        let (id, args) = self.choose_constructor(class.name(), all, args, span)?;
        Some(Expr {
            kind: ExprKind::NewObject(id, args),
            ty: Type::Class(class),
            span,
        })
    }

    /// `new String(…)`.
    pub(super) fn new_string(&mut self, args: Vec<Expr>, span: Span) -> Option<Expr> {
        let all = [
            ConstructorId::String,
            ConstructorId::StringCopy,
            ConstructorId::StringOfChars,
        ];
        let (id, args) = self.choose_constructor("String", &all, args, span)?;
        Some(Expr {
            kind: ExprKind::NewObject(id, args),
            ty: Type::String,
            span,
        })
    }

    fn choose_constructor(
        &mut self,
        name: &str,
        all: &[ConstructorId],
        args: Vec<Expr>,
        span: Span,
    ) -> Option<(ConstructorId, Vec<Expr>)> {
        let overloads: Vec<_> = all
            .iter()
            .map(|&id| Overload::of_signature(id, id.signature(), self, None))
            .collect();
        let (id, args) = self.choose(name, span, &overloads, args)?;
        self.note_effect(id.signature().effect);
        Some((id, args))
    }
}
