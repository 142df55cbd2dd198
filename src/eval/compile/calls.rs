//! Calls of methods, and the making of nodes and objects.

use std::sync::Arc;

use super::{Scope, convert, places};
use crate::check::model::{Expr, MethodId, Model, NewNode, Slot, Stmt, Type};
use crate::diag::Span;
use crate::eval::access::Access;
use crate::eval::code::{Code, FromCode, Source};
use crate::eval::machine::Machine;
use crate::eval::object::{Data, Instance, Object};
use crate::eval::program::Program;
use crate::eval::stack::{Kind, Local, is_word};
use crate::eval::trap::Trap;
use crate::eval::value::Value;
use crate::graph::{FieldKind, NodeId, TypeId};
use crate::library::ClassId;

/// A call as the checker resolved it.
pub(super) struct CallSite<'e> {
    pub(super) method: MethodId,
    pub(super) receiver: Option<&'e Expr>,
    pub(super) args: &'e [Expr],
    pub(super) is_virtual: bool,
}

/// Runs a method and leaves its result in the stack.
type Invoke = Box<dyn Fn(&Program, &mut Machine) -> Result<(), Trap> + Send + Sync>;

impl Scope<'_> {
    /// An expression as the kind of code that variables of type `ty` are computed in.
    pub(super) fn as_type(&self, expr: &Expr, ty: &Type) -> Code {
        let code = self.expr(expr);
        match ty {
            _ if convert::is_primitive(ty) => convert::number(code, ty),
            Type::Node(_) => Code::Node(FromCode::from_code(code)),
            _ => Code::Value(convert::boxed(code, &expr.ty)),
        }
    }

    /// A call of a method of the model.
    pub(super) fn call(&self, site: &CallSite<'_>, ty: &Type, span: Span) -> Code {
        let method = &self.model.methods[site.method.0 as usize];
        let args: Vec<Code> = site
            .args
            .iter()
            .zip(&method.params)
            .map(|(a, ty)| self.as_type(a, ty))
            .collect();
        let invoke = match site.receiver {
            Some(receiver) if matches!(receiver.ty, Type::Node(_)) => {
                self.invoke_on(site, self.node(receiver), args, span)
            }
            Some(receiver) => self.invoke_on_object(site, self.value(receiver), args, span),
            None => invoke_static(site.method, args, span),
        };
        fn result<T: FromCode>(invoke: Invoke) -> Code {
            T::into_code(Source::code(move |p, m| {
                invoke(p, m)?;
                Ok(T::take_result(&mut m.stack))
            }))
        }
        match ty {
            Type::Void => Code::Void(invoke),
            Type::Boolean => result::<bool>(invoke),
            Type::Byte | Type::Short | Type::Char | Type::Int => result::<i32>(invoke),
            Type::Long => result::<i64>(invoke),
            Type::Float => result::<f32>(invoke),
            Type::Double => result::<f64>(invoke),
            Type::Node(_) => result::<Option<NodeId>>(invoke),
            _ => result::<Value>(invoke),
        }
    }

    fn invoke_on(
        &self,
        site: &CallSite<'_>,
        receiver: Source<Option<NodeId>>,
        args: Vec<Code>,
        span: Span,
    ) -> Invoke {
        let name = self.model.methods[site.method.0 as usize].name.clone();
        let own = site.method;
        let overrides = site.is_virtual.then(|| override_table(self.model, own));
        Box::new(move |p, m| {
            let Some(node) = receiver.get(p, m)? else {
                return Err(Trap::null(
                    &format!("call the method `{name}` of a node"),
                    span,
                ));
            };
            let method = match &overrides {
                Some(table) => {
                    let ty = m
                        .graph
                        .type_of(node)
                        .map_err(|error| m.graph_trap(&error, node, span))?;
                    table[usize::from(ty.0)]
                }
                None => own,
            };
            let mark = m.stack.mark();
            Some(node).push(&mut m.stack);
            push_all(&args, p, m)?;
            p.run_method(method, m, mark, span)
        })
    }

    /// A call on an object of a class of the model, or on whatever implements an interface.
    fn invoke_on_object(
        &self,
        site: &CallSite<'_>,
        receiver: Source<Value>,
        args: Vec<Code>,
        span: Span,
    ) -> Invoke {
        let name = self.model.methods[site.method.0 as usize].name.clone();
        let own = site.method;
        let overrides = site.is_virtual.then(|| override_table(self.model, own));
        Box::new(move |p, m| {
            let receiver = receiver.get(p, m)?;
            let Some(ty) = receiver.type_in(&m.graph) else {
                let what = format!("call the method `{name}` of an object");
                return Err(Trap::null(&what, span));
            };
            let method = overrides
                .as_ref()
                .map_or(own, |table| table[usize::from(ty.0)]);
            let mark = m.stack.mark();
            match receiver {
                Value::Node(node) => Some(node).push(&mut m.stack),
                object => object.push(&mut m.stack),
            }
            push_all(&args, p, m)?;
            p.run_method(method, m, mark, span)
        })
    }

    /// `x.(a = 1, setB(2))`
    pub(super) fn with(&self, object: &Expr, slot: Slot, body: &[Stmt]) -> Code {
        let (object, body) = (self.expr(object), self.block(body));
        fn run<T: Access>(object: Code, slot: u32, body: crate::eval::code::Exec) -> Code {
            let object = T::from_code(object);
            T::into_code(Source::code(move |p, m| {
                let value = object.get(p, m)?;
                value.clone().store(&mut m.stack, slot);
                body(p, m)?;
                Ok(value)
            }))
        }
        match self.local(slot) {
            Local::Word(at) => run::<Option<NodeId>>(object, at, body),
            Local::Value(at) => run::<Value>(object, at, body),
        }
    }

    /// `new F(1)`: a node that is not in the graph yet.
    pub(super) fn new_node(&self, new: &NewNode, span: Span) -> Code {
        if let Some(class) = self.class_of(new.type_id) {
            return self.new_instance(new, class, span);
        }
        let (ty, fill) = (new.type_id, self.fill_node(new, span));
        Code::Node(Source::code(move |p, m| {
            m.settle(span)?;
            let node = m
                .graph
                .create(ty)
                .map_err(|error| Trap::from(error).at(span))?;
            fill(p, m, node)?;
            Ok(Some(node))
        }))
    }

    /// The library class of the objects of a class of the model; `None` for modules and built-in types.
    fn class_of(&self, ty: TypeId) -> Option<ClassId> {
        let mut modules = self.model.modules.iter();
        modules.find(|module| module.type_id == ty)?.class
    }

    /// `new C(1)` of a class of the model.
    fn new_instance(&self, new: &NewNode, class: ClassId, span: Span) -> Code {
        let (ty, fill) = (new.type_id, self.fill_instance(new, span));
        let info = &self.model.types[ty];
        let name = Arc::clone(&info.name);
        let fields: Vec<Value> = info
            .fields
            .iter()
            .map(|field| first_value(field.kind))
            .collect();
        let bytes = INSTANCE_BYTES + VALUE_BYTES * fields.len() as u64;
        Code::Value(Source::code(move |p, m| {
            let instance = Instance {
                ty,
                name: Arc::clone(&name),
                fields: fields.clone(),
                message: None,
                charge: m.charge(bytes).map_err(|trap| trap.at(span))?,
            };
            let data = Data::Instance(Box::new(instance));
            let object = Value::Object(Arc::new(Object::new(class, data)));
            fill(p, m, object.clone())?;
            Ok(object)
        }))
    }

    /// Runs the constructor of `new`'s type on a node that exists already.
    pub(super) fn fill_node(&self, new: &NewNode, span: Span) -> FillNode {
        let fill: FillAny<Option<NodeId>> = match self.constructor_of(new) {
            Some(params) => self.fill_any(new, &params, span),
            None => return self.fill_builtin(new, span),
        };
        Box::new(move |p, m, node| fill(p, m, Some(node)))
    }

    /// Runs the constructor of `new`'s class on an object that exists already.
    pub(super) fn fill_instance(&self, new: &NewNode, span: Span) -> FillAny<Value> {
        let params = self.constructor_of(new).unwrap_or_default();
        self.fill_any(new, &params, span)
    }

    /// The parameters of the constructor that is called; `None` for built-in types.
    fn constructor_of(&self, new: &NewNode) -> Option<Vec<Type>> {
        if let Some(method) = new.constructor {
            return Some(self.model.methods[method.0 as usize].params.clone());
        }
        let mut modules = self.model.modules.iter();
        let module = modules.find(|module| module.type_id == new.type_id)?;
        Some(module.constructor.params.clone())
    }

    fn fill_any<T: Kind>(&self, new: &NewNode, params: &[Type], span: Span) -> FillAny<T> {
        let mut args: Vec<Code> = new
            .args
            .iter()
            .zip(params)
            .map(|(a, ty)| self.as_type(a, ty))
            .collect();
        args.extend(params[args.len()..].iter().map(zero));
        let (ty, constructor) = (new.type_id, new.constructor);
        Box::new(move |p, m, this| {
            let mark = m.stack.mark();
            this.push(&mut m.stack);
            push_all(&args, p, m)?;
            match constructor {
                Some(method) => p.run_method(method, m, mark, span),
                None => p.run_constructor(ty, m, mark, span),
            }
        })
    }

    fn fill_builtin(&self, new: &NewNode, span: Span) -> FillNode {
        let owner = Type::Node(new.type_id);
        let field = |id| self.field(&owner, id);
        let setters: Vec<FillNode> = new
            .fields
            .iter()
            .zip(&new.args)
            .map(|(id, arg)| set_field(field(*id), self.expr(arg), span))
            .collect();
        Box::new(move |p, m, node| setters.iter().try_for_each(|set| set(p, m, node)))
    }
}

/// Bytes that an object takes besides its fields, and that a field takes.
const INSTANCE_BYTES: u64 = 160;
const VALUE_BYTES: u64 = 16;

/// Runs a constructor on a new node or object.
pub(super) type FillAny<T> =
    Box<dyn Fn(&Program, &mut Machine, T) -> Result<(), Trap> + Send + Sync>;

/// What a field of a new object holds.
fn first_value(kind: FieldKind) -> Value {
    match kind {
        FieldKind::Boolean => Value::Boolean(false),
        FieldKind::Byte | FieldKind::Short | FieldKind::Char | FieldKind::Int => Value::Int(0),
        FieldKind::Long => Value::Long(0),
        FieldKind::Float => Value::Float(0.0),
        FieldKind::Double => Value::Double(0.0),
        FieldKind::Object => Value::Null,
    }
}

/// Fills a new node.
pub(super) type FillNode =
    Box<dyn Fn(&Program, &mut Machine, NodeId) -> Result<(), Trap> + Send + Sync>;

fn set_field(field: places::Field, value: Code, span: Span) -> FillNode {
    fn set<T: Access>(field: places::Field, value: Source<T>, span: Span) -> FillNode {
        Box::new(move |p, m, node| {
            let value = value.get(p, m)?;
            places::write_field(m, Some(node), &field, value, span)
        })
    }
    match value {
        Code::Boolean(s) => set(field, s, span),
        Code::Int(s) => set(field, s, span),
        Code::Long(s) => set(field, s, span),
        Code::Float(s) => set(field, s, span),
        Code::Double(s) => set(field, s, span),
        Code::Node(s) => set(field, s, span),
        other => set(field, Value::from_code(other), span),
    }
}

fn invoke_static(method: MethodId, args: Vec<Code>, span: Span) -> Invoke {
    Box::new(move |p, m| {
        let mark = m.stack.mark();
        push_all(&args, p, m)?;
        p.run_method(method, m, mark, span)
    })
}

fn push_all(args: &[Code], p: &Program, m: &mut Machine) -> Result<(), Trap> {
    fn push<T: Kind>(source: &Source<T>, p: &Program, m: &mut Machine) -> Result<(), Trap> {
        let value = source.get(p, m)?;
        value.push(&mut m.stack);
        Ok(())
    }
    args.iter().try_for_each(|arg| match arg {
        Code::Void(code) => code(p, m),
        Code::Boolean(s) => push(s, p, m),
        Code::Int(s) => push(s, p, m),
        Code::Long(s) => push(s, p, m),
        Code::Float(s) => push(s, p, m),
        Code::Double(s) => push(s, p, m),
        Code::Node(s) => push(s, p, m),
        Code::Value(s) => push(s, p, m),
    })
}

/// What a variable of this type holds before anything is stored.
fn zero(ty: &Type) -> Code {
    match ty {
        Type::Node(_) => Code::Node(Source::Constant(None)),
        _ if is_word(ty) => Code::Long(Source::Constant(0)),
        _ => Code::Value(Source::Constant(Value::Null)),
    }
}

/// The method that each node type runs when `method` is called on it.
fn override_table(model: &Model, method: MethodId) -> Vec<MethodId> {
    let overrides_of = |ty: TypeId| {
        let module = model.modules.iter().find(|module| module.type_id == ty);
        module.map_or(&[][..], |module| module.overrides.as_slice())
    };
    // An override may itself be overridden under its own number.
    let stands_for = |mut found: MethodId| {
        loop {
            if found == method {
                return true;
            }
            let origin = model
                .modules
                .iter()
                .flat_map(|m| &m.overrides)
                .find(|(_, new)| *new == found);
            match origin {
                Some((old, new)) if old != new => found = *old,
                _ => return false,
            }
        }
    };
    let resolve = |ty: TypeId| {
        let lineage = std::iter::successors(Some(ty), |&t| model.types[t].parent);
        let mut candidates = lineage.flat_map(|t| overrides_of(t).iter());
        candidates
            .find(|(old, _)| stands_for(*old))
            .map_or(method, |(_, new)| *new)
    };
    model.types.iter().map(|(ty, _)| resolve(ty)).collect()
}
