//! Rules that never apply because an earlier rule of the same block has replaced all they look for.

use super::walk::{self, Visitor};
use crate::check::model::{
    Arrow, Expr, ExprKind, MethodId, Model, Production, Rule, Stmt, StmtKind,
};
use crate::diag::{Diagnostic, Diagnostics, Span};
use crate::graph::TypeId;
use crate::graph::pattern::{Candidate, PatternArg};
use crate::library::FunctionId;
use std::collections::BTreeSet;

/// Warns of them.
pub(super) fn check(model: &Model, found: &mut Diagnostics) {
    let steps = Steps::of(model);
    if steps.changes_mode {
        // What is consumed in which mode is not followed here.
        return;
    }
    walk::model(
        model,
        &mut Rules {
            model,
            steps,
            found,
        },
    );
}

/// Which methods may apply the queued rules, or call one that does: after that nodes are there to be matched again.
struct Steps {
    methods: BTreeSet<MethodId>,
    changes_mode: bool,
}

impl Steps {
    fn of(model: &Model) -> Self {
        let mut changes_mode = false;
        let mut callers: Vec<(MethodId, BTreeSet<MethodId>)> = vec![];
        let mut methods = BTreeSet::new();
        for (index, method) in model.methods.iter().enumerate() {
            let id = MethodId(u32::try_from(index).unwrap_or(u32::MAX));
            let mut calls = Calls::default();
            walk::stmts(method.body.as_deref().unwrap_or_default(), &mut calls);
            changes_mode |= calls.changes_mode;
            if calls.steps {
                methods.insert(id);
            }
            callers.push((id, calls.methods));
        }
        // A virtual call may reach any override.
        let overrides = || model.modules.iter().flat_map(|module| &module.overrides);
        loop {
            let n_known = methods.len();
            for (id, calls) in &callers {
                if !calls.is_disjoint(&methods) {
                    methods.insert(*id);
                }
            }
            for (old, new) in overrides() {
                if methods.contains(new) {
                    methods.insert(*old);
                }
            }
            if methods.len() == n_known {
                break;
            }
        }
        Self {
            methods,
            changes_mode,
        }
    }

    fn may_step(&self, stmt: &Stmt) -> bool {
        let mut calls = Calls::default();
        walk::one_stmt(stmt, &mut calls);
        calls.steps || !calls.methods.is_disjoint(&self.methods)
    }
}

/// What a piece of code calls.
#[derive(Default)]
struct Calls {
    methods: BTreeSet<MethodId>,
    steps: bool,
    changes_mode: bool,
}

impl Visitor for Calls {
    fn expr(&mut self, expr: &Expr) {
        match &expr.kind {
            ExprKind::Call { method, .. } => {
                self.methods.insert(*method);
            }
            ExprKind::Library(FunctionId::Derive | FunctionId::Reset, _) => self.steps = true,
            ExprKind::Library(FunctionId::SetDerivationMode, _) => self.changes_mode = true,
            _ => {}
        }
    }

    fn apply(&mut self) {
        self.steps = true;
    }
}

/// A rule that replaces all nodes of a type.
struct Eater {
    ty: TypeId,
    span: Span,
}

struct Rules<'m> {
    model: &'m Model,
    steps: Steps,
    found: &'m mut Diagnostics,
}

impl Visitor for Rules<'_> {
    fn stmts(&mut self, list: &[Stmt]) {
        let mut eaters: Vec<Eater> = vec![];
        for stmt in list {
            if let StmtKind::Rule(rule) = &stmt.kind {
                self.check_rule(rule, &eaters);
                eaters.extend(eaten(rule).map(|ty| Eater {
                    ty,
                    span: rule.pattern.span,
                }));
            }
            if self.steps.may_step(stmt) {
                eaters.clear();
            }
        }
    }
}

impl Rules<'_> {
    fn check_rule(&mut self, rule: &Rule, eaters: &[Eater]) {
        for node in rule.pattern.nodes.iter().filter(|node| !node.is_context) {
            let Candidate::Type(ty) = node.what else {
                continue;
            };
            let Some(eater) = eaters
                .iter()
                .find(|eater| self.model.types.is_a(ty, eater.ty))
            else {
                continue;
            };
            let (name, eaten) = (&self.model.types[ty].name, &self.model.types[eater.ty].name);
            let message =
                format!("this rule never applies: an earlier one has replaced every `{eaten}`");
            let warning = Diagnostic::warning("dead-rule", rule.pattern.span, message)
                .label(format!("no `{name}` is left for it"))
                .also(eater.span, format!("takes every `{eaten}`"))
                .hint("give the earlier rule a condition, or put this rule before it");
            self.found.push(warning);
            return;
        }
    }
}

/// The type of which a rule replaces all nodes, whatever they hold.
fn eaten(rule: &Rule) -> Option<TypeId> {
    let [node] = rule.pattern.nodes.as_slice() else {
        return None;
    };
    let Candidate::Type(ty) = node.what else {
        return None;
    };
    let compares = node
        .args
        .iter()
        .any(|arg| matches!(arg, PatternArg::Equal(..)));
    let is_sure = rule.arrow != Arrow::Execution
        && !node.is_context
        && !compares
        && rule.pattern.conditions.is_empty()
        && makes_only_new(&rule.rhs);
    is_sure.then_some(ty)
}

/// Whether a right-hand side surely keeps no node of its left-hand side.
fn makes_only_new(list: &[Production]) -> bool {
    list.iter().all(|production| match production {
        Production::Node { node, .. } => is_new(node),
        Production::Edge(..)
        | Production::Separator
        | Production::Break
        | Production::Cut
        | Production::Code(_) => true,
        Production::Branch(inner)
        | Production::Group(inner)
        | Production::ForEach(_, _, inner)
        | Production::Loop { body: inner, .. } => makes_only_new(inner),
        Production::If(_, yes, no) => makes_only_new(yes) && makes_only_new(no),
    })
}

fn is_new(node: &Expr) -> bool {
    match &node.kind {
        ExprKind::NewNode(_) | ExprKind::Root => true,
        ExprKind::With { object, .. } => is_new(object),
        _ => false,
    }
}
