//! Messages that several parts of the check give.

use super::Checker;
use super::model::Type;
use crate::diag::{Diagnostic, Span, nearest};
use crate::graph::TypeId;

impl Checker<'_> {
    /// Adds the nearest of the names that could have been meant.
    pub(super) fn did_you_mean<'n>(
        &self,
        fault: Diagnostic,
        name: &str,
        candidates: impl IntoIterator<Item = &'n str>,
    ) -> Diagnostic {
        match nearest(
            name,
            candidates
                .into_iter()
                .filter(|c| *c != name && !c.contains('.')),
        ) {
            Some(near) => fault.hint(format!("did you mean `{near}`?")),
            None => fault,
        }
    }

    /// A field that a node type does not have.
    pub(super) fn unknown_field(&self, ty: TypeId, name: &str, span: Span) -> Diagnostic {
        let message = format!("`{}` has no property `{name}`", self.types[ty].name);
        let fault = Diagnostic::error("unknown-property", span, message).label("no such property");
        let known: Vec<&str> = self.types[ty].fields.iter().map(|f| &*f.name).collect();
        self.did_you_mean(fault, name, known)
    }

    /// A value of a wrong type.
    pub(super) fn mismatch(&self, from: &Type, to: &Type, span: Span) -> Diagnostic {
        let (from_name, to_name) = (self.type_name(from), self.type_name(to));
        let message = format!("expected `{to_name}`, found `{from_name}`");
        let fault = Diagnostic::error("type-mismatch", span, message)
            .label(format!("this is `{from_name}`"));
        if *from != *to && self.is_castable(from, to) {
            return fault.hint(format!("write `({to_name})` in front to convert it"));
        }
        if *to == Type::Boolean && super::types::is_numeric(from) {
            return fault.hint("compare it with something, such as `!= 0`");
        }
        fault
    }
}
