//! Statements without loops.

use super::Scope;
use super::expressions::TypeTest;
use crate::check::model::{Constant, Expr, ExprKind, Slot, Stmt, StmtKind, Type};
use crate::diag::Span;
use crate::eval::code::{Code, Exec, Flow, Label, Source};
use crate::eval::machine::Machine;
use crate::eval::program::Program;
use crate::eval::stack::{Kind, Local};
use crate::eval::trap::{Cause, Trap};
use crate::eval::value::Value;
use crate::graph::NodeId;
use crate::library::ClassId;

impl Scope<'_> {
    /// Statements in order.
    pub(super) fn block(&self, body: &[Stmt]) -> Exec {
        let mut statements: Vec<Exec> = body.iter().map(|s| self.statement(s)).collect();
        match statements.len() {
            0 => Box::new(|_, _| Ok(Flow::Next)),
            1 => statements.remove(0),
            _ => Box::new(move |p, m| run_all(&statements, p, m)),
        }
    }

    /// The code of a statement.
    pub(super) fn statement(&self, s: &Stmt) -> Exec {
        match &s.kind {
            StmtKind::Expr(e) => self.effect(e).into_exec(),
            StmtKind::Local(slot, value) => self.declare(*slot, value.as_ref()),
            StmtKind::Block(body) => self.block(body),
            StmtKind::If(condition, yes, no) => self.branch(condition, yes, no.as_deref()),
            StmtKind::Loop { .. } => self.counted_loop(s),
            StmtKind::ForEach {
                label,
                slot,
                sequence,
                body,
            } => self.for_each(*label, *slot, sequence, body, s.span),
            StmtKind::Switch {
                value,
                cases,
                default,
                body,
            } => self.switch(value, cases, *default, body),
            StmtKind::Return(value) => self.return_value(value.as_ref()),
            StmtKind::Break(label) => {
                let label = label.map_or(Label::Innermost, Label::Named);
                Box::new(move |_, _| Ok(Flow::Break(label)))
            }
            StmtKind::Continue(label) => {
                let label = label.map_or(Label::Innermost, Label::Named);
                Box::new(move |_, _| Ok(Flow::Continue(label)))
            }
            StmtKind::Labeled(label, body) => {
                let (own, body) = (*label, self.statement(body));
                Box::new(move |p, m| match body(p, m)? {
                    Flow::Break(Label::Named(label)) if label == own => Ok(Flow::Next),
                    flow => Ok(flow),
                })
            }
            StmtKind::Throw(value) => self.throw(value, s.span),
            StmtKind::Try {
                body,
                catches,
                finally,
            } => self.try_catch(body, catches, finally),
            StmtKind::Rule(rule) => self.rule(rule),
            StmtKind::SuperConstructor(new) if matches!(self.local(Slot(0)), Local::Value(_)) => {
                let fill = self.fill_instance(new, s.span);
                Box::new(move |p, m| {
                    let this = Value::load(&m.stack, 0);
                    fill(p, m, this).map(|()| Flow::Next)
                })
            }
            StmtKind::SuperConstructor(new) => {
                let fill = self.fill_node(new, s.span);
                Box::new(move |p, m| match Option::<NodeId>::load(&m.stack, 0) {
                    Some(node) => fill(p, m, node).map(|()| Flow::Next),
                    None => Ok(Flow::Next),
                })
            }
        }
    }

    /// An expression of which only the effect counts: `i++` is `++i` then, which keeps no old value.
    pub(super) fn effect(&self, e: &Expr) -> Code {
        match &e.kind {
            ExprKind::IncDec { place, by, .. } => self.inc_dec(place, *by, true, e),
            _ => self.expr(e),
        }
    }

    fn declare(&self, slot: Slot, value: Option<&Expr>) -> Exec {
        fn store<T: Kind>(source: Source<T>, at: u32) -> Exec {
            Box::new(move |p, m| {
                let value = source.get(p, m)?;
                value.store(&mut m.stack, at);
                Ok(Flow::Next)
            })
        }
        match (self.local(slot), value) {
            (Local::Word(at), None) => store(Source::Constant(0_i64), at),
            (Local::Value(at), None) => store(Source::Constant(Value::Null), at),
            (Local::Value(at), Some(e)) => store(self.value(e), at),
            (Local::Word(at), Some(e)) => match self.expr(e) {
                Code::Boolean(s) => store(s, at),
                Code::Int(s) => store(s, at),
                Code::Long(s) => store(s, at),
                Code::Float(s) => store(s, at),
                Code::Double(s) => store(s, at),
                // A null stored in a variable for nodes.
                other => store(
                    <Option<NodeId> as crate::eval::code::FromCode>::from_code(other),
                    at,
                ),
            },
        }
    }

    fn branch(&self, condition: &Expr, yes: &Stmt, no: Option<&Stmt>) -> Exec {
        let (condition, yes) = (self.boolean(condition), self.statement(yes));
        match no.map(|no| self.statement(no)) {
            None => Box::new(move |p, m| {
                if condition.get(p, m)? {
                    yes(p, m)
                } else {
                    Ok(Flow::Next)
                }
            }),
            Some(no) => Box::new(move |p, m| {
                if condition.get(p, m)? {
                    yes(p, m)
                } else {
                    no(p, m)
                }
            }),
        }
    }

    fn return_value(&self, value: Option<&Expr>) -> Exec {
        fn leave<T: Kind>(source: Source<T>) -> Exec {
            Box::new(move |p, m| {
                let value = source.get(p, m)?;
                value.leave_result(&mut m.stack);
                Ok(Flow::Return)
            })
        }
        let Some(value) = value else {
            return Box::new(|_, _| Ok(Flow::Return));
        };
        match self.as_type(value, self.result) {
            Code::Void(code) => Box::new(move |p, m| code(p, m).map(|()| Flow::Return)),
            Code::Boolean(s) => leave(s),
            Code::Int(s) => leave(s),
            Code::Long(s) => leave(s),
            Code::Float(s) => leave(s),
            Code::Double(s) => leave(s),
            Code::Node(s) => leave(s),
            Code::Value(s) => leave(s),
        }
    }

    fn switch(
        &self,
        value: &Expr,
        cases: &[(Constant, usize)],
        default: Option<usize>,
        body: &[Stmt],
    ) -> Exec {
        let value = self.value(value);
        let cases: Vec<(Value, usize)> = cases
            .iter()
            .map(|(c, start)| (case_value(c), *start))
            .collect();
        let body: Vec<Exec> = body.iter().map(|s| self.statement(s)).collect();
        let default = default.unwrap_or(body.len());
        Box::new(move |p, m| {
            let value = value.get(p, m)?;
            let is_it = |case: &Value| match (case.as_int(), value.as_int()) {
                (Some(a), Some(b)) => a == b,
                _ => case.equals(&value),
            };
            let start = cases
                .iter()
                .find(|(case, _)| is_it(case))
                .map_or(default, |(_, start)| *start);
            match run_all(body.get(start..).unwrap_or_default(), p, m)? {
                Flow::Break(Label::Innermost) => Ok(Flow::Next),
                flow => Ok(flow),
            }
        })
    }

    fn throw(&self, value: &Expr, span: Span) -> Exec {
        let value = self.value(value);
        Box::new(move |p, m| match value.get(p, m)? {
            Value::Null => Err(Trap::null("throw an exception", span)),
            thrown => Err(Trap::new(Cause::Exception(thrown), Some(span))),
        })
    }

    /// Whether something thrown is of type `ty`; texts that are thrown count as exceptions.
    fn caught(&self, ty: &Type) -> TypeTest {
        match ty {
            Type::Class(ClassId::Exception | ClassId::Throwable) => Box::new(|_, _| true),
            ty => self.type_test(ty),
        }
    }

    fn try_catch(
        &self,
        body: &[Stmt],
        catches: &[(Vec<Type>, Slot, Vec<Stmt>)],
        finally: &[Stmt],
    ) -> Exec {
        let body = self.block(body);
        let handlers: Vec<Handler> = catches
            .iter()
            .map(|(types, slot, handler)| Handler {
                tests: types.iter().map(|ty| self.caught(ty)).collect(),
                variable: self.local(*slot),
                code: self.block(handler),
            })
            .collect();
        let finally = self.block(finally);
        Box::new(move |p, m| {
            let mark = m.stack.mark();
            let outcome = body(p, m).or_else(|trap| {
                m.stack.release(mark);
                handle(&handlers, trap, p, m)
            });
            m.stack.release(mark);
            match finally(p, m)? {
                Flow::Next => outcome,
                flow => Ok(flow),
            }
        })
    }
}

fn run_all(statements: &[Exec], p: &Program, m: &mut Machine) -> Result<Flow, Trap> {
    for statement in statements {
        match statement(p, m)? {
            Flow::Next => {}
            flow => return Ok(flow),
        }
    }
    Ok(Flow::Next)
}

fn case_value(constant: &Constant) -> Value {
    match constant {
        Constant::Int(x) => Value::Int(*x),
        Constant::Long(x) => Value::Long(*x),
        Constant::String(text) => Value::text(text.as_str()),
        Constant::Boolean(b) => Value::Boolean(*b),
        Constant::Float(x) => Value::Float(*x),
        Constant::Double(x) => Value::Double(*x),
        Constant::Null => Value::Null,
    }
}

/// A `catch`.
struct Handler {
    /// What it catches: anything for which one of them is true.
    tests: Vec<TypeTest>,
    variable: Local,
    code: Exec,
}

fn handle(handlers: &[Handler], trap: Trap, p: &Program, m: &mut Machine) -> Result<Flow, Trap> {
    let Some(thrown) = trap.thrown().cloned() else {
        return Err(trap);
    };
    let catches = |h: &&Handler| h.tests.iter().any(|test| test(&m.graph, &thrown));
    let Some(handler) = handlers.iter().find(catches) else {
        return Err(trap);
    };
    if let Local::Value(at) = handler.variable {
        m.stack.set_value(at, thrown);
    }
    (handler.code)(p, m)
}
