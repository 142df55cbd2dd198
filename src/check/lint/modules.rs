//! Modules that nothing uses, and patterns that look for modules that are never made.

use super::walk::{self, Visitor};
use crate::check::model::{Expr, ExprKind, Model, Type};
use crate::diag::{Diagnostic, Diagnostics, Span};
use crate::graph::TypeId;
use crate::graph::pattern::{Candidate, Pattern};
use std::collections::{BTreeMap, BTreeSet};

/// Warns of them. Only of whole models: a file without `init` may be a part of one.
pub(super) fn check(model: &Model, found: &mut Diagnostics) {
    if model.init.is_none() {
        return;
    }
    let uses = Uses::of(model);
    // Classes are not followed here: their objects stand in no graph.
    let node = model.types.find("Node");
    let is_node = |ty: TypeId| node.is_some_and(|node| model.types.is_a(ty, node));
    for module in model
        .modules
        .iter()
        .filter(|module| is_node(module.type_id))
    {
        let name = &model.types[module.type_id].name;
        let is_used = |ty: TypeId| {
            uses.made.contains(&ty) || uses.looked_for.contains_key(&ty) || uses.named.contains(&ty)
        };
        if !uses.has_heirs(model, module.type_id) && !is_used(module.type_id) {
            let warning = Diagnostic::warning(
                "unused-module",
                module.name_span,
                format!("module `{name}` is never used"),
            )
            .hint(format!(
                "make one in a rule (`Axiom ==> {name};`), or delete it"
            ));
            found.push(warning);
            continue;
        }
        let is_made = |made: &TypeId| model.types.is_a(*made, module.type_id);
        if let Some(&place) = uses.looked_for.get(&module.type_id)
            && !uses.made.iter().any(is_made)
        {
            let what = if model.types[module.type_id].is_abstract {
                format!("`{name}` is abstract, and no module that extends it is ever made")
            } else {
                format!("no `{name}` is ever made")
            };
            let warning =
                Diagnostic::warning("no-match", place, format!("this matches nothing: {what}"))
                    .label("nothing to find")
                    .also(module.name_span, "declared here")
                    .hint("make one on the right-hand side of a rule");
            found.push(warning);
        }
    }
}

/// Where the types of a model occur.
#[derive(Default)]
struct Uses {
    made: BTreeSet<TypeId>,
    /// With the first pattern that looks for them.
    looked_for: BTreeMap<TypeId, Span>,
    /// In casts, `instanceof` and types of variables.
    named: BTreeSet<TypeId>,
}

impl Uses {
    fn of(model: &Model) -> Self {
        let mut uses = Self::default();
        walk::model(model, &mut uses);
        for method in &model.methods {
            // Slot 0 is `this`: that a module has methods is no use of it.
            let own = usize::from(method.this.is_some());
            let types = method.frame.iter().skip(own).chain([&method.result]);
            types.for_each(|ty| uses.name(ty));
        }
        for module in &model.modules {
            module
                .constructor
                .params
                .iter()
                .for_each(|ty| uses.name(ty));
        }
        for variable in &model.statics {
            uses.name(&variable.ty);
        }
        uses
    }

    fn name(&mut self, ty: &Type) {
        let mut inner = ty;
        while let Type::Array(element) = inner {
            inner = element;
        }
        if let Type::Node(id) = inner {
            self.named.insert(*id);
        }
    }

    fn has_heirs(&self, model: &Model, ty: TypeId) -> bool {
        model
            .modules
            .iter()
            .any(|other| model.types[other.type_id].parent == Some(ty))
    }
}

impl Visitor for Uses {
    fn expr(&mut self, expr: &Expr) {
        match &expr.kind {
            ExprKind::NewNode(made) => {
                self.made.insert(made.type_id);
            }
            ExprKind::InstanceOf(_, ty) => self.name(ty),
            ExprKind::Cast(_) => self.name(&expr.ty),
            _ => {}
        }
    }

    fn pattern(&mut self, pattern: &Pattern<Expr>) {
        for node in &pattern.nodes {
            if let Candidate::Type(ty) = node.what {
                let first = self.looked_for.entry(ty).or_insert(node.span);
                *first = (*first).min(node.span);
            }
        }
    }
}
