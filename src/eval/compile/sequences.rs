//! Sequences: what `for` loops and aggregates go through.

use super::Scope;
use super::places::with_kind;
use super::rules::{CompiledPattern, Env};
use crate::check::model::{Expr, Sequence, Slot, Type};
use crate::eval::access::Access;
use crate::eval::code::{Code, FromCode};
use crate::eval::machine::Machine;
use crate::eval::object::Data;
use crate::eval::program::Program;
use crate::eval::stack::{Kind, Local};
use crate::eval::trap::Trap;
use crate::eval::value::Value;
use crate::graph::{NodeId, TypeId};
use crate::rewrite;

/// Whether a sequence goes on.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Turn {
    /// To the next element.
    Next,
    /// No more elements are wanted.
    Stop,
}

/// What is done with each element, which stands in a local variable then.
pub(super) type Visit<'a> = &'a mut dyn FnMut(&Program, &mut Machine) -> Result<Turn, Trap>;

/// Goes through a sequence.
pub(super) type Iterate =
    Box<dyn Fn(&Program, &mut Machine, Visit<'_>) -> Result<Turn, Trap> + Send + Sync>;

impl Scope<'_> {
    /// The type of a sequence's elements.
    pub(super) fn element_type(&self, sequence: &Sequence) -> Type {
        match sequence {
            Sequence::Query { .. } => Type::Node(TypeId(0)),
            Sequence::Range(from, _) => from.ty.clone(),
            Sequence::Elements(array) => match &array.ty {
                Type::Array(element) => (**element).clone(),
                other => other.clone(),
            },
            Sequence::List(_) => Type::Object,
            Sequence::Apply(_) => Type::Void,
            Sequence::Map { body, .. } => body.ty.clone(),
            Sequence::One(value) => value.ty.clone(),
        }
    }

    /// The code that goes through a sequence and puts each element into `to`, where there is one.
    pub(super) fn sequence(&self, sequence: &Sequence, to: Option<Local>) -> Iterate {
        let at = to.map(|(Local::Word(at) | Local::Value(at))| at);
        match sequence {
            Sequence::Query { pattern, result } => self.query(pattern, *result, at),
            Sequence::Range(from, until) => self.range(from, until, at),
            Sequence::Elements(array) => match &array.ty {
                Type::Array(element) => with_kind!(&**element, self.elements(array, at)),
                _ => self.elements::<Value>(array, at),
            },
            Sequence::List(list) => self.list(list, at),
            Sequence::Apply(n) => self.apply(n),
            Sequence::Map { source, slot, body } => {
                with_kind!(&body.ty, self.map(source, *slot, body, at))
            }
            Sequence::One(value) => with_kind!(&value.ty, self.one(value, at)),
        }
    }

    fn query(
        &self,
        pattern: &crate::graph::pattern::Pattern<Expr>,
        result: usize,
        at: Option<u32>,
    ) -> Iterate {
        let (compiled, span): (CompiledPattern, _) = (self.pattern("query", pattern), pattern.span);
        Box::new(move |program, machine, visit| {
            let mut turn = Turn::Next;
            let mut env = Env {
                program,
                machine,
                compiled: &compiled,
                tried: None,
            };
            rewrite::search(
                &compiled.pattern,
                &compiled.plan,
                false,
                &mut env,
                &mut |env, found| {
                    if let Some(at) = at {
                        found.node(result).store(&mut env.machine.stack, at);
                    }
                    env.machine.tick(span)?;
                    turn = visit(env.program, env.machine)
                        .map_err(|trap| env.note_found(trap, found.node(result)))?;
                    Ok(if turn == Turn::Next {
                        rewrite::Flow::Continue
                    } else {
                        rewrite::Flow::Stop
                    })
                },
            )?;
            Ok(turn)
        })
    }

    fn range(&self, from: &Expr, until: &Expr, at: Option<u32>) -> Iterate {
        let (is_long, span) = (from.ty == Type::Long, from.span);
        let [from, until] = [from, until]
            .map(|e| i64::from_code(super::convert::number(self.expr(e), &Type::Long)));
        Box::new(move |p, m, visit| {
            let from = from.get(p, m)?;
            let until = until.get(p, m)?;
            for i in from..=until {
                m.tick(span)?;
                match at {
                    Some(at) if is_long => i.store(&mut m.stack, at),
                    Some(at) => (i as i32).store(&mut m.stack, at),
                    None => {}
                }
                if visit(p, m)? == Turn::Stop {
                    return Ok(Turn::Stop);
                }
            }
            Ok(Turn::Next)
        })
    }

    fn elements<T: Access>(&self, array: &Expr, at: Option<u32>) -> Iterate {
        let span = array.span;
        let array = self.value(array);
        Box::new(move |p, m, visit| {
            let Value::Array(array) = array.get(p, m)? else {
                return Err(Trap::null("go through an array", span));
            };
            for i in 0..array.len() {
                if let (Some(at), Some(element)) = (at, T::element(&array, i)) {
                    element.store(&mut m.stack, at);
                }
                if visit(p, m)? == Turn::Stop {
                    return Ok(Turn::Stop);
                }
            }
            Ok(Turn::Next)
        })
    }

    /// Elements of a list; one that grows meanwhile is gone through to its new end.
    fn list(&self, list: &Expr, at: Option<u32>) -> Iterate {
        let span = list.span;
        let list = self.value(list);
        Box::new(move |p, m, visit| {
            let Value::Object(list) = list.get(p, m)? else {
                return Err(Trap::null("go through a list", span));
            };
            let keys: Option<Vec<Value>> = match &*list.lock() {
                Data::Set(map) => Some(map.entries().iter().map(|(key, _)| key.clone()).collect()),
                _ => None,
            };
            for i in 0.. {
                let element = match (&keys, &*list.lock()) {
                    (Some(keys), _) => keys.get(i).cloned(),
                    (None, Data::List(list)) => list.values.get(i).cloned(),
                    (None, _) => None,
                };
                let Some(element) = element else { break };
                if let Some(at) = at {
                    element.store(&mut m.stack, at);
                }
                if visit(p, m)? == Turn::Stop {
                    return Ok(Turn::Stop);
                }
            }
            Ok(Turn::Next)
        })
    }

    fn apply(&self, n: &Expr) -> Iterate {
        let span = n.span;
        let n = i64::from_code(super::convert::number(self.expr(n), &Type::Long));
        Box::new(move |p, m, visit| {
            for _ in 0..n.get(p, m)? {
                if visit(p, m)? == Turn::Stop {
                    return Ok(Turn::Stop);
                }
                m.derive(span)?;
            }
            Ok(Turn::Next)
        })
    }

    fn map<T: Access>(
        &self,
        source: &Sequence,
        slot: Slot,
        body: &Expr,
        at: Option<u32>,
    ) -> Iterate {
        let source = self.sequence(source, Some(self.local(slot)));
        let body = self.source::<T>(body);
        Box::new(move |p, m, visit| {
            source(p, m, &mut |p, m| {
                let value = body.get(p, m)?;
                if let Some(at) = at {
                    value.store(&mut m.stack, at);
                }
                visit(p, m)
            })
        })
    }

    fn one<T: Access>(&self, value: &Expr, at: Option<u32>) -> Iterate {
        let value = self.source::<T>(value);
        Box::new(move |p, m, visit| {
            let value = value.get(p, m)?;
            if let Some(at) = at {
                value.store(&mut m.stack, at);
            }
            visit(p, m)
        })
    }

    /// A place for the elements of a sequence.
    pub(super) fn element_place(&self, ty: &Type) -> Local {
        let at = self.temporary(ty);
        if crate::eval::stack::is_word(ty) {
            Local::Word(at)
        } else {
            Local::Value(at)
        }
    }
}

/// The code that reads a place made by [`Scope::element_place`].
pub(super) fn read_place(ty: &Type, place: Local) -> Code {
    use crate::eval::code::Source;
    let (Local::Word(at) | Local::Value(at)) = place;
    match ty {
        Type::Boolean => Code::Boolean(Source::Local(at)),
        Type::Byte | Type::Short | Type::Char | Type::Int => Code::Int(Source::Local(at)),
        Type::Long => Code::Long(Source::Local(at)),
        Type::Float => Code::Float(Source::Local(at)),
        Type::Double => Code::Double(Source::Local(at)),
        Type::Node(_) => Code::Node(Source::<Option<NodeId>>::Local(at)),
        _ => Code::Value(Source::Local(at)),
    }
}
