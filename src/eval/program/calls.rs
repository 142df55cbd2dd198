//! Methods of the model that the library calls, with boxed arguments.

use super::Program;
use crate::check::model::{MethodId, Type};
use crate::diag::Span;
use crate::eval::machine::Machine;
use crate::eval::stack::Kind;
use crate::eval::trap::Trap;
use crate::eval::value::Value;
use crate::graph::{NodeId, TypeId};
use crate::library::ClassId;

impl Program {
    /// Calls a method of the model from inside of the library: on `this`, with boxed arguments, for a boxed value.
    pub(in crate::eval) fn call_method(
        &self,
        m: &mut Machine,
        id: MethodId,
        this: &Value,
        args: &[Value],
        span: Span,
    ) -> Result<Value, Trap> {
        let method = &self.methods[id.0 as usize];
        let mark = m.stack.mark();
        if method.this.is_some() {
            match this {
                Value::Node(node) => Some(*node).push(&mut m.stack),
                object => object.clone().push(&mut m.stack),
            }
        }
        for (ty, arg) in method.params.iter().zip(args) {
            if let Err(trap) = self.push_argument(m, ty, arg, span) {
                m.stack.release(mark);
                return Err(trap);
            }
        }
        self.run_method(id, m, mark, span)?;
        let stack = &mut m.stack;
        Ok(match &method.result {
            Type::Void => Value::Null,
            Type::Boolean => Value::Boolean(bool::take_result(stack)),
            Type::Byte | Type::Short | Type::Char | Type::Int => {
                Value::Int(i32::take_result(stack))
            }
            Type::Long => Value::Long(i64::take_result(stack)),
            Type::Float => Value::Float(f32::take_result(stack)),
            Type::Double => Value::Double(f64::take_result(stack)),
            Type::Node(_) => Option::<NodeId>::take_result(stack).map_or(Value::Null, Value::Node),
            _ => Value::take_result(stack),
        })
    }

    /// Pushes a boxed value as an argument of type `ty`; a value of another type is an exception.
    fn push_argument(
        &self,
        m: &mut Machine,
        ty: &Type,
        arg: &Value,
        span: Span,
    ) -> Result<(), Trap> {
        let is_foreign = match ty {
            Type::Node(wanted) => match arg {
                Value::Null => false,
                Value::Node(node) => !m.graph.is_a(*node, *wanted),
                _ => true,
            },
            Type::Instance(wanted) => {
                let is_one = |ty: TypeId| {
                    let interfaces = self.interfaces.get(&ty);
                    self.types.is_a(ty, *wanted) || interfaces.is_some_and(|i| i.contains(wanted))
                };
                !arg.is_null() && !arg.type_in(&m.graph).is_some_and(is_one)
            }
            Type::Boolean => arg.as_boolean().is_none(),
            Type::Byte
            | Type::Short
            | Type::Char
            | Type::Int
            | Type::Long
            | Type::Float
            | Type::Double => arg.as_double().is_none(),
            Type::String => arg.as_text().is_none() && !arg.is_null(),
            _ => false,
        };
        if is_foreign {
            let mut text = String::new();
            m.append_text(arg, &mut text);
            let message = format!("`{text}` is not of the type that the method takes");
            return Err(Trap::exception(ClassId::ClassCastException, message, span));
        }
        let stack = &mut m.stack;
        match ty {
            Type::Boolean => arg.as_boolean().unwrap_or(false).push(stack),
            Type::Byte | Type::Short | Type::Char | Type::Int => {
                arg.as_int().unwrap_or(0).push(stack);
            }
            Type::Long => arg.as_long().unwrap_or(0).push(stack),
            Type::Float => arg.as_float().unwrap_or(0.0).push(stack),
            Type::Double => arg.as_double().unwrap_or(0.0).push(stack),
            Type::Node(_) => arg.as_node().push(stack),
            _ => arg.clone().push(stack),
        }
        Ok(())
    }
}
