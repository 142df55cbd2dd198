//! Reading and writing variables, fields, elements and members.

use std::sync::Arc;

use super::Scope;
use super::convert::{is_primitive, number};
use super::held::{Held, is_still};
use super::operators::combine;
use crate::check::model::{Expr, Operator, Place, StaticId, Type};
use crate::diag::Span;
use crate::eval::access::Access;
use crate::eval::code::{Code, Source};
use crate::eval::library::{Getter, Setter, getter, setter};
use crate::eval::machine::{Machine, out_of_bounds};
use crate::eval::object::Data;
use crate::eval::program::Program;
use crate::eval::stack::{Kind, Local};
use crate::eval::trap::Trap;
use crate::eval::value::Value;
use crate::graph::{FieldId, NodeId, TypeId};
use crate::library::ClassId;

/// A field of a node, with its name for messages.
#[derive(Clone)]
pub(super) struct Field {
    id: FieldId,
    name: Arc<str>,
}

/// A place whose sub-expressions are compiled.
enum Target {
    Local(Local),
    Static(Local),
    Field(Source<Option<NodeId>>, Field),
    /// A field of an object of a class of the model.
    Slot(Source<Value>, Field),
    Element(Source<Value>, Source<i32>),
    /// An element of an array that a variable holds and goes on holding while index and value are computed.
    HeldElement(Held, Source<i32>),
    Member(Source<Value>, Getter, Setter),
}

/// Calls a generic method with the kind of values that variables of a type are computed in.
macro_rules! with_kind {
    ($ty:expr, $scope:ident . $method:ident ($($args:expr),* $(,)?)) => {
        match $ty {
            Type::Boolean => $scope.$method::<bool>($($args),*),
            Type::Byte | Type::Short | Type::Char | Type::Int => $scope.$method::<i32>($($args),*),
            Type::Long => $scope.$method::<i64>($($args),*),
            Type::Float => $scope.$method::<f32>($($args),*),
            Type::Double => $scope.$method::<f64>($($args),*),
            Type::Node(_) => $scope.$method::<Option<crate::graph::NodeId>>($($args),*),
            _ => $scope.$method::<Value>($($args),*),
        }
    };
}
pub(super) use with_kind;

impl Scope<'_> {
    /// A place to which something is done while `others` are evaluated.
    fn target(&self, place: &Place, others: &[&Expr]) -> Target {
        match place {
            Place::Local(slot) => Target::Local(self.local(*slot)),
            Place::Static(StaticId(id)) => Target::Static(self.static_local(*id)),
            Place::Field(object, field) if matches!(object.ty, Type::Instance(_)) => {
                Target::Slot(self.value(object), self.field(&object.ty, *field))
            }
            Place::Field(node, field) => {
                Target::Field(self.node(node), self.field(&node.ty, *field))
            }
            Place::Element(array, index) => {
                let is_still = is_still(index) && others.iter().all(|other| is_still(other));
                match self.held(array).filter(|_| is_still) {
                    Some(held) => Target::HeldElement(held, self.int(index)),
                    None => Target::Element(self.value(array), self.int(index)),
                }
            }
            Place::Member(object, get, set) => {
                Target::Member(self.value(object), getter(*get), setter(*set))
            }
        }
    }

    /// A field of nodes of type `owner`.
    pub(super) fn field(&self, owner: &Type, id: FieldId) -> Field {
        let fields = match owner {
            Type::Node(ty) | Type::Instance(ty) => self.model.types[*ty].fields.as_slice(),
            _ => &[],
        };
        let name = fields
            .get(usize::from(id.0))
            .map_or_else(|| "?".into(), |f| Arc::clone(&f.name));
        Field { id, name }
    }

    /// The value of a place of type `ty`.
    pub(super) fn read(&self, place: &Place, ty: &Type, span: Span) -> Code {
        with_kind!(ty, self.read_kind(place, span))
    }

    fn read_kind<T: Access>(&self, place: &Place, span: Span) -> Code {
        T::into_code(match self.target(place, &[]) {
            Target::Local(Local::Word(at) | Local::Value(at)) => Source::Local(at),
            Target::Static(local) => Source::code(move |_, m| Ok(read_static(m, local))),
            Target::Field(node, field) => Source::code(move |p, m| {
                let node = node.get(p, m)?;
                read_field(m, node, &field, span)
            }),
            Target::Slot(object, field) => Source::code(move |p, m| {
                let object = object.get(p, m)?;
                read_slot(&object, &field, span)
            }),
            Target::Element(array, index) => Source::code(move |p, m| {
                let array = array.get(p, m)?;
                let index = index.get(p, m)?;
                read_element(&array, index, span)
            }),
            Target::HeldElement(held, index) => Source::code(move |p, m| {
                let index = index.get(p, m)?;
                read_element(held.array(m), index, span)
            }),
            Target::Member(object, get, _) => Source::code(move |p, m| {
                let object = object.get(p, m)?;
                read_member(&object, get, span)
            }),
        })
    }

    /// `place = value`; the value of the expression is the value stored.
    pub(super) fn assign(&self, place: &Place, value: &Expr, span: Span) -> Code {
        with_kind!(
            &self.stored_type(place, &value.ty),
            self.assign_kind(place, value, span)
        )
    }

    /// The type in which a value is stored: its own, but an untyped null becomes what the place holds.
    fn stored_type(&self, place: &Place, value: &Type) -> Type {
        let local = match place {
            Place::Local(slot) => self.local(*slot),
            Place::Static(StaticId(id)) => self.static_local(*id),
            Place::Field(..) | Place::Element(..) | Place::Member(..) => return value.clone(),
        };
        match local {
            Local::Word(_) if is_primitive(value) => value.clone(),
            Local::Word(_) => Type::Node(TypeId(0)),
            Local::Value(_) => Type::Object,
        }
    }

    fn assign_kind<T: Access>(&self, place: &Place, assigned: &Expr, span: Span) -> Code {
        let value = self.source::<T>(assigned);
        T::into_code(match self.target(place, &[assigned]) {
            Target::Local(Local::Word(at) | Local::Value(at)) => Source::code(move |p, m| {
                let new = value.get(p, m)?;
                new.clone().store(&mut m.stack, at);
                Ok(new)
            }),
            Target::Static(local) => Source::code(move |p, m| {
                let new = value.get(p, m)?;
                write_static(m, local, new.clone());
                Ok(new)
            }),
            Target::Field(node, field) => Source::code(move |p, m| {
                let node = node.get(p, m)?;
                let new = value.get(p, m)?;
                write_field(m, node, &field, new.clone(), span)?;
                Ok(new)
            }),
            Target::Slot(object, field) => Source::code(move |p, m| {
                let object = object.get(p, m)?;
                let new = value.get(p, m)?;
                write_slot(&object, &field, new.clone(), span)?;
                Ok(new)
            }),
            Target::Element(array, index) => Source::code(move |p, m| {
                let array = array.get(p, m)?;
                let index = index.get(p, m)?;
                let new = value.get(p, m)?;
                write_element(&array, index, new.clone(), span)?;
                Ok(new)
            }),
            Target::HeldElement(held, index) => Source::code(move |p, m| {
                let index = index.get(p, m)?;
                let new = value.get(p, m)?;
                write_element(held.array(m), index, new.clone(), span)?;
                Ok(new)
            }),
            Target::Member(object, _, set) => Source::code(move |p, m| {
                let object = object.get(p, m)?;
                let new = value.get(p, m)?;
                write_member(&object, set, new.clone(), span)?;
                Ok(new)
            }),
        })
    }

    /// `place op= value`, computed in `operands`, narrowed to the place's type.
    pub(super) fn compound(
        &self,
        place: &Place,
        op: Operator,
        operands: &Type,
        value: &Expr,
        result: &Expr,
    ) -> Code {
        with_kind!(
            &result.ty,
            self.compound_kind(place, op, operands, value, result)
        )
    }

    fn compound_kind<T: Access>(
        &self,
        place: &Place,
        op: Operator,
        operands: &Type,
        value: &Expr,
        result: &Expr,
    ) -> Code {
        let (ty, span) = (&result.ty, result.span);
        // A local is its own left operand; other places are read into a temporary first.
        let target = self.target(place, &[value]);
        let old = match target {
            Target::Local(Local::Word(at) | Local::Value(at)) => at,
            _ => self.temporary(ty),
        };
        let left = number(T::into_code(Source::Local(old)), operands);
        let new: Source<T> = T::from_code(number(
            combine(op, operands, left, self.expr(value), span),
            ty,
        ));
        T::into_code(modify(target, old, new, span))
    }

    /// `place += text`.
    pub(super) fn append(&self, place: &Place, value: &Expr, span: Span) -> Code {
        let target = self.target(place, &[value]);
        let old = match target {
            Target::Local(Local::Word(at) | Local::Value(at)) => at,
            _ => self.temporary(&Type::String),
        };
        let right = self.text_writer(value);
        let new = Source::code(move |p: &Program, m: &mut Machine| {
            let left = Value::load(&m.stack, old);
            let mut text = String::new();
            m.append_text(&left, &mut text);
            right(p, m, &mut text)?;
            m.new_text(text).map_err(|trap| trap.at(span))
        });
        Code::Value(modify::<Value>(target, old, new, span))
    }

    /// `++place` and its kin; `old` is the value of the postfix forms.
    pub(super) fn inc_dec(&self, place: &Place, by: i8, is_prefix: bool, result: &Expr) -> Code {
        with_kind!(&result.ty, self.inc_dec_kind(place, by, is_prefix, result))
    }

    fn inc_dec_kind<T: Access>(
        &self,
        place: &Place,
        by: i8,
        is_prefix: bool,
        result: &Expr,
    ) -> Code {
        let (ty, span) = (&result.ty, result.span);
        if let (Place::Local(slot), Type::Int, true) = (place, ty, is_prefix)
            && let Local::Word(at) = self.local(*slot)
        {
            let by = i32::from(by);
            return Code::Int(Source::code(move |_, m| {
                let new = i32::load(&m.stack, at).wrapping_add(by);
                new.store(&mut m.stack, at);
                Ok(new)
            }));
        }
        let old = self.temporary(ty);
        let one = number(Code::Int(Source::Constant(i32::from(by))), ty);
        let left = T::into_code(Source::Local(old));
        let new: Source<T> = T::from_code(number(combine(Operator::Add, ty, left, one, span), ty));
        let update = modify(self.target(place, &[]), old, new, span);
        if is_prefix {
            return T::into_code(update);
        }
        T::into_code(Source::code(move |p, m| {
            update.get(p, m)?;
            Ok(T::load(&m.stack, old))
        }))
    }
}

/// Puts the value of `target` into the temporary `old`, computes `new` and stores it.
fn modify<T: Access>(target: Target, old: u32, new: Source<T>, span: Span) -> Source<T> {
    match target {
        Target::Local(Local::Word(at) | Local::Value(at)) => Source::code(move |p, m| {
            if at != old {
                T::load(&m.stack, at).store(&mut m.stack, old);
            }
            let new = new.get(p, m)?;
            new.clone().store(&mut m.stack, at);
            Ok(new)
        }),
        Target::Static(local) => Source::code(move |p, m| {
            read_static::<T>(m, local).store(&mut m.stack, old);
            let new = new.get(p, m)?;
            write_static(m, local, new.clone());
            Ok(new)
        }),
        Target::Field(node, field) => Source::code(move |p, m| {
            let node = node.get(p, m)?;
            read_field::<T>(m, node, &field, span)?.store(&mut m.stack, old);
            let new = new.get(p, m)?;
            write_field(m, node, &field, new.clone(), span)?;
            Ok(new)
        }),
        Target::Slot(object, field) => Source::code(move |p, m| {
            let object = object.get(p, m)?;
            read_slot::<T>(&object, &field, span)?.store(&mut m.stack, old);
            let new = new.get(p, m)?;
            write_slot(&object, &field, new.clone(), span)?;
            Ok(new)
        }),
        Target::Element(array, index) => Source::code(move |p, m| {
            let array = array.get(p, m)?;
            let index = index.get(p, m)?;
            read_element::<T>(&array, index, span)?.store(&mut m.stack, old);
            let new = new.get(p, m)?;
            write_element(&array, index, new.clone(), span)?;
            Ok(new)
        }),
        Target::HeldElement(held, index) => Source::code(move |p, m| {
            let index = index.get(p, m)?;
            read_element::<T>(held.array(m), index, span)?.store(&mut m.stack, old);
            let new = new.get(p, m)?;
            write_element(held.array(m), index, new.clone(), span)?;
            Ok(new)
        }),
        Target::Member(object, get, set) => Source::code(move |p, m| {
            let object = object.get(p, m)?;
            read_member::<T>(&object, get, span)?.store(&mut m.stack, old);
            let new = new.get(p, m)?;
            write_member(&object, set, new.clone(), span)?;
            Ok(new)
        }),
    }
}

fn read_static<T: Access>(machine: &mut Machine, local: Local) -> T {
    machine.statics.read(local)
}

fn write_static<T: Access>(machine: &mut Machine, local: Local, value: T) {
    machine.statics.write(local, value);
}

/// Reads a field of a node that may be null or gone.
pub(super) fn read_field<T: Access>(
    machine: &Machine,
    node: Option<NodeId>,
    field: &Field,
    span: Span,
) -> Result<T, Trap> {
    match node {
        Some(id) => T::field(&machine.graph, id, field.id)
            .map_err(|error| machine.graph_trap(&error, id, span)),
        None => Err(null_field("read", field, span)),
    }
}

/// Writes a field of a node that may be null or gone.
pub(super) fn write_field<T: Access>(
    machine: &mut Machine,
    node: Option<NodeId>,
    field: &Field,
    value: T,
    span: Span,
) -> Result<(), Trap> {
    let Some(id) = node else {
        return Err(null_field("assign", field, span));
    };
    value
        .set_field(&mut machine.graph, id, field.id)
        .map_err(|error| machine.graph_trap(&error, id, span))
}

/// Reads a field of an object of a class of the model that may be null.
fn read_slot<T: Access>(object: &Value, field: &Field, span: Span) -> Result<T, Trap> {
    let Some(found) = object.as_object() else {
        return Err(null_field("read", field, span));
    };
    let value = match &*found.lock() {
        Data::Instance(instance) => instance.fields.get(usize::from(field.id.0)).cloned(),
        _ => None,
    };
    Ok(value.map_or_else(T::default, |value| T::unboxed(&value)))
}

/// Writes a field of an object of a class of the model that may be null.
fn write_slot<T: Access>(object: &Value, field: &Field, value: T, span: Span) -> Result<(), Trap> {
    let Some(found) = object.as_object() else {
        return Err(null_field("assign", field, span));
    };
    let value = value.boxed();
    // The old value is dropped after the lock is given back: it may be the last reference to a long chain.
    let old = match &mut *found.lock() {
        Data::Instance(instance) => instance
            .fields
            .get_mut(usize::from(field.id.0))
            .map(|slot| std::mem::replace(slot, value)),
        _ => None,
    };
    drop(old);
    Ok(())
}

#[cold]
fn null_field(verb: &str, field: &Field, span: Span) -> Trap {
    let message = format!(
        "Cannot {verb} field \"{}\" because the object is null",
        field.name
    );
    Trap::exception(ClassId::NullPointerException, message, span)
}

fn read_element<T: Access>(array: &Value, index: i32, span: Span) -> Result<T, Trap> {
    let Some(array) = array.as_array() else {
        return Err(Trap::null("read an element of an array", span));
    };
    let found = usize::try_from(index)
        .ok()
        .and_then(|i| T::element(array, i));
    found.ok_or_else(|| bad_index(index, array.len(), span))
}

fn write_element<T: Access>(array: &Value, index: i32, value: T, span: Span) -> Result<(), Trap> {
    let Some(array) = array.as_array() else {
        return Err(Trap::null("write an element of an array", span));
    };
    let written = usize::try_from(index)
        .ok()
        .and_then(|i| value.set_element(array, i));
    written.ok_or_else(|| bad_index(index, array.len(), span))
}

#[cold]
fn bad_index(index: i32, length: usize, span: Span) -> Trap {
    out_of_bounds(
        ClassId::ArrayIndexOutOfBoundsException,
        i64::from(index),
        length,
        span,
    )
}

fn read_member<T: Access>(object: &Value, get: Getter, span: Span) -> Result<T, Trap> {
    let Some(found) = object.as_object() else {
        return Err(Trap::null("read a member of an object", span));
    };
    let value = get(&found.lock());
    Ok(T::unboxed(&value))
}

fn write_member<T: Access>(object: &Value, set: Setter, value: T, span: Span) -> Result<(), Trap> {
    let Some(found) = object.as_object() else {
        return Err(Trap::null("write a member of an object", span));
    };
    set(&mut found.lock(), &value.boxed());
    Ok(())
}
