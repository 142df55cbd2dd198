//! What a node of a pattern may be: any node, one of a module, one that is known already, or the value of a variable.

use super::Checker;
use super::model::{Expr, Type};
use super::names::Binding;
use super::pattern::Builder;
use crate::diag::{Diagnostic, Span};
use crate::graph::TypeId;
use crate::graph::pattern::Candidate;
use crate::syntax::ast;

impl Checker<'_> {
    /// What a pattern node may be, and its type.
    pub(super) fn candidate(
        &mut self,
        builder: &Builder,
        node: &ast::NodePattern,
    ) -> Option<(Candidate<Expr>, TypeId)> {
        let [name] = node.name.path.as_slice() else {
            return match node.name.path.last() {
                None => Some((Candidate::Any, self.node)),
                Some(_) => match self.resolve_value_type(&node.name)? {
                    Type::Node(id) => Some((Candidate::Type(id), id)),
                    ty => {
                        let message = format!("`{}` is no module", self.type_name(&ty));
                        self.report(Diagnostic::error("not-a-node", node.span, message));
                        None
                    }
                },
            };
        };
        let (name, span) = (name.name.as_str(), name.span);
        match name {
            "." => return Some((Candidate::Any, self.node)),
            "^" => return Some((Candidate::Root, self.root_type())),
            _ => {}
        }
        if let Some(&same) = builder.labels.get(name) {
            return Some((Candidate::Same(same), builder.types[same]));
        }
        if name == "this" {
            let this = self.expr(&ast::Expr {
                kind: ast::ExprKind::This,
                span,
            })?;
            let Type::Node(ty) = this.ty else { return None };
            return Some((Candidate::Value(this), ty));
        }
        let is_local = self.cx.has_local(name);
        if !is_local && let Some(id) = self.node_type(name) {
            return Some((Candidate::Type(id), id));
        }
        self.variable_candidate(name, span)
    }

    /// A variable that holds a node.
    fn variable_candidate(&mut self, name: &str, span: Span) -> Option<(Candidate<Expr>, TypeId)> {
        let value = match self.lookup(name, span) {
            Some(Binding::Target(target)) => self.read(target, span),
            Some(Binding::Value(value)) => value,
            Some(Binding::Poisoned) => return None,
            None => {
                if !self.refused.contains(name) {
                    let fault = self.unknown_node_type(name, span);
                    self.report(fault);
                }
                return None;
            }
        };
        let Type::Node(ty) = value.ty else {
            if let Some(id) = self.node_type(name) {
                return Some((Candidate::Type(id), id));
            }
            let message = format!("`{name}` is no node but `{}`", self.type_name(&value.ty));
            self.report(Diagnostic::error("not-a-node", span, message));
            return None;
        };
        Some((Candidate::Value(value), ty))
    }
}
