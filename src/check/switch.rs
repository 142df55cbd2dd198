//! `switch`.

use super::Checker;
use super::constant;
use super::enumeration;
use super::model::{Constant, Expr, Stmt, StmtKind, Type};
use super::types::promote;
use crate::diag::Diagnostic;
use crate::graph::TypeId;
use crate::syntax::ast;

impl Checker<'_> {
    /// `switch (value) { … }` over whole numbers or strings.
    pub(super) fn switch(
        &mut self,
        value: &ast::Expr,
        cases: &[ast::SwitchCase],
    ) -> Option<StmtKind> {
        let value = self.value(value).map(|value| self.unbox(value));
        let enumeration = value
            .as_ref()
            .and_then(|value| self.enumeration_of(&value.ty));
        let value = match enumeration {
            Some(of) => value.and_then(|value| self.ordinal(value, of)),
            None => value,
        };
        let ty = value.as_ref().map(|value| value.ty.clone());
        let is_good = |ty: &Type| *ty == Type::String || Self::is_index(ty);
        if let Some((bad, value)) = ty
            .as_ref()
            .zip(value.as_ref())
            .filter(|(ty, _)| !is_good(ty))
        {
            let message = format!(
                "`switch` needs a whole number or a string, found `{}`",
                self.type_name(bad)
            );
            self.report(Diagnostic::error("bad-switch", value.span, message));
        }
        let (mut starts, mut default, mut body) = (vec![], None, vec![]);
        self.cx.open();
        self.cx.switches += 1;
        for case in cases {
            match &case.value {
                Some(label) => {
                    let constant = match enumeration {
                        Some(of) => self.enumeration_case(label, of, &starts),
                        None => self.case_label(label, ty.as_ref(), &starts),
                    };
                    if let Some(constant) = constant {
                        starts.push((constant, body.len()));
                    }
                }
                None if default.is_some() => {
                    let span = case
                        .body
                        .first()
                        .map_or_else(crate::diag::Span::default, |stmt: &ast::Stmt| stmt.span);
                    self.report(Diagnostic::error(
                        "duplicate-case",
                        span,
                        "`switch` has two `default`",
                    ));
                }
                None => default = Some(body.len()),
            }
            let stmts: Vec<Stmt> = self.stmts(&case.body);
            body.extend(stmts);
        }
        self.cx.switches -= 1;
        self.cx.close();
        let value = value?;
        let ty = promote(&value.ty);
        Some(StmtKind::Switch {
            value: self.convert(value, &ty),
            cases: starts,
            default,
            body,
        })
    }

    /// The enumeration that a type is, if it is one.
    fn enumeration_of(&self, ty: &Type) -> Option<TypeId> {
        let Type::Instance(id) = *ty else { return None };
        let name = &self.types[id].name;
        let mut classes = self.classes.iter();
        classes
            .any(|class| class.is_enumeration && *class.module.name.name == **name)
            .then_some(id)
    }

    /// The place of a value among those of its enumeration.
    fn ordinal(&mut self, value: Expr, of: TypeId) -> Option<Expr> {
        let span = value.span;
        let field = self.visible_field(of, enumeration::ORDINAL)?;
        let target = self.field_target(value, of, field)?;
        Some(self.read(target, span))
    }

    /// The place of the value named after `case`; reported if it is none of the enumeration.
    fn enumeration_case(
        &mut self,
        label: &ast::Expr,
        of: TypeId,
        earlier: &[(Constant, usize)],
    ) -> Option<Constant> {
        let name = super::member::dotted(label)?.last().copied()?.to_owned();
        let index = usize::from(of.0).checked_sub(self.n_builtin)?;
        let members = &self.modules[index].ast.members;
        let mut constants = members.iter().filter_map(|item| match item {
            ast::Item::Field(field) if field.modifiers.is_static => Some(&field.name.name),
            _ => None,
        });
        let Some(place) = constants.position(|constant| *constant == name) else {
            let message = format!("`{}` has no value `{name}`", self.types[of].name);
            self.report(Diagnostic::error("bad-case", label.span, message));
            return None;
        };
        let constant = Constant::Int(i32::try_from(place).unwrap_or(i32::MAX));
        if earlier.iter().any(|(value, _)| *value == constant) {
            let message = "this `case` stands twice";
            self.report(Diagnostic::error("duplicate-case", label.span, message));
            return None;
        }
        Some(constant)
    }

    /// The constant after `case`; reported if it is none.
    fn case_label(
        &mut self,
        label: &ast::Expr,
        ty: Option<&Type>,
        earlier: &[(Constant, usize)],
    ) -> Option<Constant> {
        let checked = self.value(label)?;
        let ty = ty?;
        let checked = self.assign_value(checked, ty)?;
        let Some(constant) = constant::value_of(&checked) else {
            let fault = Diagnostic::error(
                "bad-case",
                label.span,
                "what stands after `case` must be a constant",
            );
            self.report(fault.hint("use a number, a text or a `final` variable with such a value"));
            return None;
        };
        if earlier.iter().any(|(value, _)| *value == constant) {
            self.report(Diagnostic::error(
                "duplicate-case",
                label.span,
                "this `case` stands twice",
            ));
            return None;
        }
        Some(constant)
    }
}
