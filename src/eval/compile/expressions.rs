//! Expressions: one arm per construct.

use std::sync::Arc;

use super::{Scope, calls};
use crate::check::model::{Constant, Expr, ExprKind, Type};
use crate::diag::Span;
use crate::eval::code::{Code, Eval, FromCode, Source};
use crate::eval::machine::Machine;
use crate::eval::program::Program;
use crate::eval::trap::Trap;
use crate::eval::value::Value;
use crate::graph::{Graph, NodeId, TypeId};
use crate::library::ClassId;

/// Appends the text of an expression's value.
pub(super) type TextWriter =
    Box<dyn Fn(&Program, &mut Machine, &mut String) -> Result<(), Trap> + Send + Sync>;

impl Scope<'_> {
    /// The code of an expression.
    pub(super) fn expr(&self, e: &Expr) -> Code {
        match &e.kind {
            ExprKind::Constant(constant) => constant_code(constant),
            ExprKind::Read(place) => self.read(place, &e.ty, e.span),
            ExprKind::Convert(operand) => self.convert(operand, &e.ty),
            ExprKind::Cast(operand) => self.cast(operand, &e.ty, e.span),
            ExprKind::InstanceOf(operand, ty) => self.instance_of(operand, ty),
            ExprKind::Negate(operand) => self.negate(operand, &e.ty),
            ExprKind::Complement(operand) => self.complement(operand, &e.ty),
            ExprKind::Not(operand) => Code::Boolean(self.boolean(operand).map(|x| !x)),
            ExprKind::Binary {
                op,
                operands,
                left,
                right,
            } => self.binary(*op, operands, [left, right], e.span),
            ExprKind::AndThen(left, right) => self.and_then(left, right),
            ExprKind::OrElse(left, right) => self.or_else(left, right),
            ExprKind::Concat(parts) => self.concat(parts, e.span),
            ExprKind::Conditional(condition, yes, no) => {
                self.conditional(condition, [yes, no], &e.ty)
            }
            ExprKind::Assign(place, value) => self.assign(place, value, e.span),
            ExprKind::Compound {
                place,
                op: Some(op),
                operands,
                value,
            } => self.compound(place, *op, operands, value, e),
            ExprKind::Compound {
                place,
                op: None,
                value,
                ..
            } => self.append(place, value, e.span),
            ExprKind::IncDec {
                place,
                by,
                is_prefix,
            } => self.inc_dec(place, *by, *is_prefix, e),
            _ => self.object_expr(e),
        }
    }

    /// Expressions that deal with nodes, objects, arrays, sequences and calls.
    fn object_expr(&self, e: &Expr) -> Code {
        match &e.kind {
            ExprKind::Deferred {
                node,
                field,
                op,
                value,
            } => self.deferred_assignment(node, *field, *op, value, e.span),
            ExprKind::Call {
                method,
                receiver,
                args,
                is_virtual,
            } => {
                let call = calls::CallSite {
                    method: *method,
                    receiver: receiver.as_deref(),
                    args,
                    is_virtual: *is_virtual,
                };
                self.call(&call, &e.ty, e.span)
            }
            ExprKind::Library(function, args) => self.library_function(*function, args, e),
            ExprKind::LibraryMethod(method, receiver, args) => {
                self.library_method(*method, receiver, args, e)
            }
            ExprKind::NewObject(constructor, args) => self.new_object(*constructor, args, e),
            ExprKind::NewNode(new) => self.new_node(new, e.span),
            ExprKind::With { object, slot, body } => self.with(object, *slot, body),
            ExprKind::NewArray(lengths) => self.new_array(lengths, &e.ty, e.span),
            ExprKind::ArrayLiteral(values) => self.array_literal(values, &e.ty, e.span),
            ExprKind::ArrayLength(array) => self.array_length(array, e.span),
            ExprKind::Aggregate(aggregate, sequence) => self.aggregate(*aggregate, sequence, e),
            ExprKind::SelectWhere {
                selection,
                sequence,
                slot,
                key,
            } => self.select_where(*selection, sequence, *slot, key, &e.ty),
            ExprKind::Root => Code::Node(Source::code(|_, m| Ok(Some(m.graph.root())))),
            ExprKind::Function(method, captured) => self.function_value(*method, captured),
            ExprKind::Comma(exprs) => self.comma(exprs),
            // `expr` has dealt with the rest.
            _ => Code::void(|_, _| Ok(())),
        }
    }

    /// `a + b` of texts.
    fn concat(&self, parts: &[Expr], span: Span) -> Code {
        let writers: Vec<TextWriter> = parts.iter().map(|part| self.text_writer(part)).collect();
        Code::Value(Source::code(move |p, m| {
            let mut text = String::new();
            for write in &writers {
                write(p, m, &mut text)?;
                m.check_text(text.len()).map_err(|trap| trap.at(span))?;
            }
            m.new_text(text).map_err(|trap| trap.at(span))
        }))
    }

    /// Appends the text of `part`, as Java prints its type.
    pub(super) fn text_writer(&self, part: &Expr) -> TextWriter {
        let value = self.value(part);
        if let Source::Constant(value) = &value {
            let text = value.to_string();
            return Box::new(move |_, _, out| {
                out.push_str(&text);
                Ok(())
            });
        }
        let span = part.span;
        if matches!(part.ty, Type::String) || super::convert::is_primitive(&part.ty) {
            return Box::new(move |p, m, out| {
                let value = value.get(p, m)?;
                m.append_text(&value, out);
                Ok(())
            });
        }
        Box::new(move |p, m, out| {
            let value = value.get(p, m)?;
            p.tell(m, &value, out, span)
        })
    }

    fn conditional(&self, condition: &Expr, branches: [&Expr; 2], ty: &Type) -> Code {
        fn choose<T: FromCode>(condition: Source<bool>, [yes, no]: [Code; 2]) -> Code {
            let (yes, no) = (T::from_code(yes), T::from_code(no));
            T::into_code(Source::code(move |p, m| {
                if condition.get(p, m)? {
                    yes.get(p, m)
                } else {
                    no.get(p, m)
                }
            }))
        }
        let condition = self.boolean(condition);
        let branches = branches.map(|branch| self.expr(branch));
        match ty {
            Type::Boolean => choose::<bool>(condition, branches),
            Type::Byte | Type::Short | Type::Char | Type::Int => choose::<i32>(condition, branches),
            Type::Long => choose::<i64>(condition, branches),
            Type::Float => choose::<f32>(condition, branches),
            Type::Double => choose::<f64>(condition, branches),
            Type::Node(_) => choose::<Option<NodeId>>(condition, branches),
            _ => choose::<Value>(condition, branches),
        }
    }

    fn comma(&self, exprs: &[Expr]) -> Code {
        let Some((last, first)) = exprs.split_last() else {
            return Code::void(|_, _| Ok(()));
        };
        let first: Vec<Eval<()>> = first.iter().map(|e| self.expr(e).into_void()).collect();
        let last = self.expr(last);
        fn after<T: FromCode>(first: Vec<Eval<()>>, last: Source<T>) -> Code {
            T::into_code(Source::code(move |p, m| {
                for effect in &first {
                    effect(p, m)?;
                }
                last.get(p, m)
            }))
        }
        match last {
            Code::Void(last) => Code::void(move |p, m| {
                for effect in &first {
                    effect(p, m)?;
                }
                last(p, m)
            }),
            Code::Boolean(last) => after(first, last),
            Code::Int(last) => after(first, last),
            Code::Long(last) => after(first, last),
            Code::Float(last) => after(first, last),
            Code::Double(last) => after(first, last),
            Code::Node(last) => after(first, last),
            Code::Value(last) => after(first, last),
        }
    }

    fn cast(&self, operand: &Expr, ty: &Type, span: Span) -> Code {
        if let Type::Node(wanted) = *ty {
            if matches!(&operand.ty, Type::Node(have) if self.model.types.is_a(*have, wanted)) {
                return self.expr(operand);
            }
            let node = self.value(operand);
            return Code::Node(Source::code(move |p, m| match node.get(p, m)? {
                Value::Null => Ok(None),
                Value::Node(node) if m.graph.is_a(node, wanted) => Ok(Some(node)),
                other => Err(bad_cast(
                    m,
                    &other,
                    &m.graph.types()[wanted].name.clone(),
                    span,
                )),
            }));
        }
        let (value, test) = (self.value(operand), self.type_test(ty));
        let name = match ty {
            Type::Instance(id) => Arc::clone(&self.model.types[*id].name),
            ty => type_name(ty),
        };
        Code::Value(Source::code(move |p, m| {
            let value = value.get(p, m)?;
            if value.is_null() || test(&m.graph, &value) {
                Ok(value)
            } else {
                Err(bad_cast(m, &value, &name, span))
            }
        }))
    }

    /// Whether a value that is not null is of type `ty`.
    pub(super) fn type_test(&self, ty: &Type) -> TypeTest {
        match ty.clone() {
            Type::Object => Box::new(|_, v| !v.is_null()),
            Type::String => Box::new(|_, v| v.as_text().is_some()),
            Type::Array(_) => Box::new(|_, v| v.as_array().is_some()),
            Type::Class(class) | Type::Generic(class, _) => {
                Box::new(move |_, v| v.class().is_some_and(|c| c.is_a(class)))
            }
            Type::Node(ty) => {
                Box::new(move |graph, v| matches!(v, Value::Node(n) if graph.is_a(*n, ty)))
            }
            Type::Instance(ty) => {
                let types = self.model.types.iter();
                let is_one: Vec<bool> = types.map(|(id, _)| self.model.is_a(id, ty)).collect();
                Box::new(move |graph, v| {
                    let found = v.type_in(graph);
                    found.is_some_and(|id| is_one.get(usize::from(id.0)) == Some(&true))
                })
            }
            _ => Box::new(|_, _| true),
        }
    }

    fn instance_of(&self, operand: &Expr, ty: &Type) -> Code {
        if let (Type::Node(wanted), Type::Node(_) | Type::Null) = (ty, &operand.ty) {
            let (wanted, node) = (*wanted, self.node(operand));
            return Code::Boolean(Source::code(move |p, m| {
                Ok(node
                    .get(p, m)?
                    .is_some_and(|node| m.graph.is_a(node, wanted)))
            }));
        }
        let (value, test) = (self.value(operand), self.type_test(ty));
        Code::Boolean(Source::code(move |p, m| {
            let value = value.get(p, m)?;
            Ok(test(&m.graph, &value))
        }))
    }
}

fn constant_code(constant: &Constant) -> Code {
    match constant {
        Constant::Null => Code::Value(Source::Constant(Value::Null)),
        Constant::Boolean(b) => Code::Boolean(Source::Constant(*b)),
        Constant::Int(x) => Code::Int(Source::Constant(*x)),
        Constant::Long(x) => Code::Long(Source::Constant(*x)),
        Constant::Float(x) => Code::Float(Source::Constant(*x)),
        Constant::Double(x) => Code::Double(Source::Constant(*x)),
        Constant::String(text) => Code::Value(Source::Constant(Value::text(text.as_str()))),
    }
}

/// Whether a value that is not null is of some type.
pub(super) type TypeTest = Box<dyn Fn(&Graph<Value>, &Value) -> bool + Send + Sync>;

#[cold]
fn bad_cast(machine: &Machine, value: &Value, wanted: &str, span: Span) -> Trap {
    let mut text = String::new();
    machine.append_text(value, &mut text);
    let message = format!("`{text}` is no {wanted}");
    Trap::exception(ClassId::ClassCastException, message, span)
}

/// The name of a type for messages.
pub(super) fn type_name(ty: &Type) -> Arc<str> {
    match ty {
        Type::Class(class) | Type::Generic(class, _) => class.name().into(),
        Type::String => "String".into(),
        Type::Array(_) => "array".into(),
        Type::Node(TypeId(_)) => "node".into(),
        _ => "Object".into(),
    }
}
