//! Calls of the library.

use std::sync::Arc;

use super::Scope;
use super::places::with_kind;
use crate::check::model::{Expr, MethodId as MethodOfModel, Type};
use crate::diag::Span;
use crate::eval::access::Access;
use crate::eval::code::{Code, Source};
use crate::eval::library::{Behaviour, Context, Maker, Native, constructor, function, method};
use crate::eval::machine::Machine;
use crate::eval::object::{Data, Object};
use crate::eval::program::Program;
use crate::eval::random::JavaRandom;
use crate::eval::trap::Trap;
use crate::eval::value::Value;
use crate::library::{ClassId, ConstructorId, FunctionId, MethodId};

/// Most arguments of a library function, receiver included: a pattern and eight values of `String.format`.
const MAX_ARGUMENTS: usize = 9;

impl Scope<'_> {
    pub(super) fn library_function(&self, id: FunctionId, args: &[Expr], e: &Expr) -> Code {
        match id {
            FunctionId::Random => Code::Float(self.drawn(args, |random, low, high| {
                random.next_float() * (high - low) + low
            })),
            FunctionId::NormalFloat => Code::Float(self.drawn(args, |random, mean, deviation| {
                random.next_gaussian() as f32 * deviation + mean
            })),
            FunctionId::NormalDouble => {
                Code::Double(self.drawn(args, |random, mean, deviation| {
                    random.next_gaussian() * deviation + mean
                }))
            }
            FunctionId::Probability => {
                let p = self.argument::<f32>(args, 0);
                Code::Boolean(Source::code(move |program, machine| {
                    let p = p.get(program, machine)?;
                    Ok(p >= 1.0 || machine.random.next_float() < p)
                }))
            }
            id => self.behave(function(id), args, &e.ty, e.span),
        }
    }

    /// A number drawn with two parameters: the functions of the library that rules use most, without boxes.
    fn drawn<T: Access>(
        &self,
        args: &[Expr],
        draw: impl Fn(&mut JavaRandom, T, T) -> T + Send + Sync + 'static,
    ) -> Source<T> {
        let (first, second) = (self.argument(args, 0), self.argument(args, 1));
        Source::code(move |program, machine| {
            let first = first.get(program, machine)?;
            let second = second.get(program, machine)?;
            Ok(draw(&mut machine.random, first, second))
        })
    }

    pub(super) fn library_method(
        &self,
        id: MethodId,
        receiver: &Expr,
        args: &[Expr],
        e: &Expr,
    ) -> Code {
        let mut all = vec![receiver.clone()];
        all.extend_from_slice(args);
        self.behave(method(id), &all, &e.ty, e.span)
    }

    pub(super) fn new_object(&self, id: ConstructorId, args: &[Expr], e: &Expr) -> Code {
        let (maker, span): (Maker, Span) = (constructor(id), e.span);
        let args = self.values(args);
        // Of `new String()` the maker does not look at it.
        let class = e.ty.class().unwrap_or(ClassId::Throwable);
        Code::Value(Source::code(move |program, machine| {
            with_arguments(&args, program, machine, |machine, args| {
                maker(
                    &mut Context {
                        program,
                        machine,
                        span,
                    },
                    class,
                    args,
                )
            })
        }))
    }

    /// A function as a value, with what its variables hold now.
    pub(super) fn function_value(&self, method: MethodOfModel, captured: &[Expr]) -> Code {
        let captured = self.values(captured);
        Code::Value(Source::code(move |program, machine| {
            let values = captured.iter().map(|value| value.get(program, machine));
            let values = values.collect::<Result<Vec<Value>, Trap>>()?;
            let function = Object::new(ClassId::Function, Data::Function(method, values));
            Ok(Value::Object(Arc::new(function)))
        }))
    }

    fn behave(&self, behaviour: Behaviour, args: &[Expr], ty: &Type, span: Span) -> Code {
        match behaviour {
            Behaviour::Int1(f) => Code::Int(self.argument(args, 0).map(f)),
            Behaviour::Int2(f) => Code::Int(self.argument(args, 0).zip(self.argument(args, 1), f)),
            Behaviour::Long1(f) => Code::Long(self.argument(args, 0).map(f)),
            Behaviour::Long2(f) => {
                Code::Long(self.argument(args, 0).zip(self.argument(args, 1), f))
            }
            Behaviour::Float1(f) => Code::Float(self.argument(args, 0).map(f)),
            Behaviour::Float2(f) => {
                Code::Float(self.argument(args, 0).zip(self.argument(args, 1), f))
            }
            Behaviour::Double1(f) => Code::Double(self.argument(args, 0).map(f)),
            Behaviour::Double2(f) => {
                Code::Double(self.argument(args, 0).zip(self.argument(args, 1), f))
            }
            Behaviour::FloatToInt(f) => Code::Int(self.argument(args, 0).map(f)),
            Behaviour::DoubleToLong(f) => Code::Long(self.argument(args, 0).map(f)),
            Behaviour::Native(native) => self.native(native, args, ty, span),
        }
    }

    fn argument<T: Access>(&self, args: &[Expr], index: usize) -> Source<T> {
        args.get(index)
            .map_or_else(|| Source::Constant(T::default()), |arg| self.source(arg))
    }

    fn native(&self, native: Native, args: &[Expr], ty: &Type, span: Span) -> Code {
        let args = self.values(args);
        let call = move |program: &Program, machine: &mut Machine| {
            with_arguments(&args, program, machine, |machine, args| {
                native(
                    &mut Context {
                        program,
                        machine,
                        span,
                    },
                    args,
                )
            })
        };
        if *ty == Type::Void {
            return Code::void(move |p, m| call(p, m).map(drop));
        }
        let source = Source::code(call);
        with_kind!(ty, self.unboxed_result(source))
    }

    fn unboxed_result<T: Access>(&self, source: Source<Value>) -> Code {
        T::into_code(source.map(|value| T::unboxed(&value)))
    }
}

/// Evaluates arguments into an array on Rust's stack and calls `f` with them.
fn with_arguments<R>(
    args: &[Source<Value>],
    program: &Program,
    machine: &mut Machine,
    f: impl FnOnce(&mut Machine, &[Value]) -> Result<R, Trap>,
) -> Result<R, Trap> {
    let mut values: [Value; MAX_ARGUMENTS] = Default::default();
    for (value, arg) in values.iter_mut().zip(args) {
        *value = arg.get(program, machine)?;
    }
    f(machine, values.get(..args.len()).unwrap_or(&values))
}
