//! Going through all of a checked model, depth first, in the order of the text.

use crate::check::model::{
    Expr, ExprKind, Instantiation, Model, NewNode, Place, Production, Rule, Sequence, Stmt,
    StmtKind,
};
use crate::graph::pattern::{Candidate, Pattern, PatternArg};

/// What is met on the way. Every method may be left out.
pub(super) trait Visitor {
    /// Statements that run one after the other.
    fn stmts(&mut self, _list: &[Stmt]) {}
    /// Parts of a right-hand side, one after the other.
    fn productions(&mut self, _list: &[Production]) {}
    /// A statement, before what is in it.
    fn stmt(&mut self, _stmt: &Stmt) {}
    /// An expression, before what is in it.
    fn expr(&mut self, _expr: &Expr) {}
    /// A pattern, before what is in it.
    fn pattern(&mut self, _pattern: &Pattern<Expr>) {}
    /// Anything that applies the rules queued so far from within a loop: `apply(n)`.
    fn apply(&mut self) {}
}

/// Goes through all bodies of a model.
pub(super) fn model(model: &Model, visitor: &mut impl Visitor) {
    for variable in &model.statics {
        all(variable.init.iter(), visitor);
    }
    for module in &model.modules {
        stmts(&module.constructor.body, visitor);
        if let Some(Instantiation { body, .. }) = &module.instantiation {
            productions(body, visitor);
        }
    }
    for method in &model.methods {
        stmts(method.body.as_deref().unwrap_or_default(), visitor);
    }
}

pub(super) fn stmts(list: &[Stmt], visitor: &mut impl Visitor) {
    visitor.stmts(list);
    for stmt in list {
        one_stmt(stmt, visitor);
    }
}

pub(super) fn one_stmt(stmt: &Stmt, visitor: &mut impl Visitor) {
    visitor.stmt(stmt);
    match &stmt.kind {
        StmtKind::Expr(e) | StmtKind::Throw(e) => expr(e, visitor),
        StmtKind::Local(_, e) | StmtKind::Return(e) => all(e.iter(), visitor),
        StmtKind::Block(list) => stmts(list, visitor),
        StmtKind::If(cond, yes, no) => {
            expr(cond, visitor);
            for branch in [Some(yes), no.as_ref()].into_iter().flatten() {
                one_stmt(branch, visitor);
            }
        }
        StmtKind::Loop {
            init,
            cond,
            update,
            body,
            ..
        } => {
            stmts(init, visitor);
            all(cond.iter().chain(update), visitor);
            one_stmt(body, visitor);
        }
        StmtKind::ForEach {
            sequence: s, body, ..
        } => {
            sequence(s, visitor);
            one_stmt(body, visitor);
        }
        StmtKind::Switch { value, body, .. } => {
            expr(value, visitor);
            // Cases begin anywhere in the list: its statements do not simply run one after the other.
            for stmt in body {
                one_stmt(stmt, visitor);
            }
        }
        StmtKind::Break(_) | StmtKind::Continue(_) => {}
        StmtKind::Labeled(_, inner) => one_stmt(inner, visitor),
        StmtKind::Try {
            body,
            catches,
            finally,
        } => {
            stmts(body, visitor);
            for (_, _, handler) in catches {
                stmts(handler, visitor);
            }
            stmts(finally, visitor);
        }
        StmtKind::Rule(one) => rule(one, visitor),
        StmtKind::SuperConstructor(call) => all(call.args.iter(), visitor),
    }
}

fn rule(rule: &Rule, visitor: &mut impl Visitor) {
    pattern(&rule.pattern, visitor);
    productions(&rule.rhs, visitor);
    if let Some(exec) = &rule.exec {
        one_stmt(exec, visitor);
    }
}

fn pattern(found: &Pattern<Expr>, visitor: &mut impl Visitor) {
    visitor.pattern(found);
    for node in &found.nodes {
        if let Candidate::Value(e) = &node.what {
            expr(e, visitor);
        }
        for arg in &node.args {
            if let PatternArg::Equal(_, e) = arg {
                expr(e, visitor);
            }
        }
    }
    all(
        found.conditions.iter().map(|condition| &condition.expr),
        visitor,
    );
}

fn productions(list: &[Production], visitor: &mut impl Visitor) {
    visitor.productions(list);
    for production in list {
        match production {
            Production::Node { node, .. } => expr(node, visitor),
            Production::Edge(..) | Production::Separator | Production::Break | Production::Cut => {}
            Production::Branch(inner) | Production::Group(inner) => productions(inner, visitor),
            Production::ForEach(_, over, body) => {
                sequence(over, visitor);
                productions(body, visitor);
            }
            Production::Loop {
                init,
                cond,
                update,
                body,
                ..
            } => {
                stmts(init, visitor);
                all(cond.iter().chain(update), visitor);
                productions(body, visitor);
            }
            Production::If(cond, yes, no) => {
                expr(cond, visitor);
                productions(yes, visitor);
                productions(no, visitor);
            }
            Production::Code(list) => stmts(list, visitor),
        }
    }
}

fn sequence(found: &Sequence, visitor: &mut impl Visitor) {
    match found {
        Sequence::Query { pattern: p, .. } => pattern(p, visitor),
        Sequence::Range(from, to) => all([&**from, &**to], visitor),
        Sequence::Elements(e) | Sequence::List(e) | Sequence::One(e) => expr(e, visitor),
        Sequence::Apply(e) => {
            visitor.apply();
            expr(e, visitor);
        }
        Sequence::Map { source, body, .. } => {
            sequence(source, visitor);
            expr(body, visitor);
        }
    }
}

fn all<'e>(list: impl IntoIterator<Item = &'e Expr>, visitor: &mut impl Visitor) {
    for e in list {
        expr(e, visitor);
    }
}

fn place(target: &Place, visitor: &mut impl Visitor) {
    match target {
        Place::Local(_) | Place::Static(_) => {}
        Place::Field(object, _) | Place::Member(object, _, _) => expr(object, visitor),
        Place::Element(array, index) => all([&**array, &**index], visitor),
    }
}

pub(super) fn expr(e: &Expr, visitor: &mut impl Visitor) {
    visitor.expr(e);
    match &e.kind {
        ExprKind::Constant(_) | ExprKind::Root => {}
        ExprKind::Read(from) => place(from, visitor),
        ExprKind::Convert(x)
        | ExprKind::Cast(x)
        | ExprKind::InstanceOf(x, _)
        | ExprKind::Negate(x)
        | ExprKind::Complement(x)
        | ExprKind::Not(x)
        | ExprKind::ArrayLength(x) => expr(x, visitor),
        ExprKind::Binary { left, right, .. } => all([&**left, &**right], visitor),
        ExprKind::AndThen(a, b) | ExprKind::OrElse(a, b) => all([&**a, &**b], visitor),
        ExprKind::Conditional(c, a, b) => all([&**c, &**a, &**b], visitor),
        ExprKind::Assign(to, value)
        | ExprKind::Compound {
            place: to, value, ..
        } => {
            place(to, visitor);
            expr(value, visitor);
        }
        ExprKind::IncDec { place: to, .. } => place(to, visitor),
        ExprKind::Deferred { node, value, .. } => all([&**node, &**value], visitor),
        ExprKind::Call { receiver, args, .. } => {
            all(receiver.iter().map(|r| &**r).chain(args), visitor);
        }
        ExprKind::Library(_, args)
        | ExprKind::NewObject(_, args)
        | ExprKind::NewArray(args)
        | ExprKind::ArrayLiteral(args)
        | ExprKind::Concat(args)
        | ExprKind::Function(_, args)
        | ExprKind::Comma(args) => all(args, visitor),
        ExprKind::LibraryMethod(_, object, args) => {
            expr(object, visitor);
            all(args, visitor);
        }
        ExprKind::NewNode(made) => {
            let NewNode { args, .. } = &**made;
            all(args, visitor);
        }
        ExprKind::With { object, body, .. } => {
            expr(object, visitor);
            stmts(body, visitor);
        }
        ExprKind::Aggregate(_, over) => sequence(over, visitor),
        ExprKind::SelectWhere {
            sequence: over,
            key,
            ..
        } => {
            sequence(over, visitor);
            expr(key, visitor);
        }
    }
}
