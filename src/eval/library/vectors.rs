//! Points, vectors, spectra.

use glam::DVec3;

use super::{Arguments, Context, new_object};
use crate::eval::object::Data;
use crate::eval::trap::Trap;
use crate::eval::value::Value;
use crate::library::ClassId;

pub(super) fn make_zero(_: &mut Context<'_>, class: ClassId, _: &[Value]) -> Result<Value, Trap> {
    Ok(new_object(class, Data::Tuple(DVec3::ZERO)))
}

pub(super) fn make(_: &mut Context<'_>, class: ClassId, args: &[Value]) -> Result<Value, Trap> {
    Ok(new_object(class, Data::Tuple(triple(args, 0))))
}

pub(super) fn make_copy(
    cx: &mut Context<'_>,
    class: ClassId,
    args: &[Value],
) -> Result<Value, Trap> {
    Ok(new_object(class, Data::Tuple(tuple(cx, args, 0)?)))
}

/// Three numbers from `index` on.
fn triple(args: &[Value], index: usize) -> DVec3 {
    DVec3::new(
        args.double(index),
        args.double(index + 1),
        args.double(index + 2),
    )
}

fn tuple(cx: &Context<'_>, args: &[Value], index: usize) -> Result<DVec3, Trap> {
    Ok(cx.object(args, index)?.tuple().unwrap_or_default())
}

fn coordinate(data: &Data, index: usize) -> Value {
    match data {
        Data::Tuple(v) => Value::Double(v[index]),
        _ => Value::Double(0.0),
    }
}

fn set_coordinate(data: &mut Data, index: usize, value: &Value) {
    if let Data::Tuple(v) = data {
        v[index] = value.as_double().unwrap_or(0.0);
    }
}

pub(super) fn x(data: &Data) -> Value {
    coordinate(data, 0)
}

pub(super) fn y(data: &Data) -> Value {
    coordinate(data, 1)
}

pub(super) fn z(data: &Data) -> Value {
    coordinate(data, 2)
}

pub(super) fn set_x(data: &mut Data, value: &Value) {
    set_coordinate(data, 0, value);
}

pub(super) fn set_y(data: &mut Data, value: &Value) {
    set_coordinate(data, 1, value);
}

pub(super) fn set_z(data: &mut Data, value: &Value) {
    set_coordinate(data, 2, value);
}

/// Replaces the receiver's coordinates.
fn become_(cx: &Context<'_>, args: &[Value], new: DVec3) -> Result<Value, Trap> {
    if let Data::Tuple(v) = &mut *cx.object(args, 0)?.lock() {
        *v = new;
    }
    Ok(Value::Null)
}

pub(super) fn set(cx: &mut Context<'_>, args: &[Value]) -> Result<Value, Trap> {
    become_(cx, args, triple(args, 1))
}

pub(super) fn set_tuple(cx: &mut Context<'_>, args: &[Value]) -> Result<Value, Trap> {
    become_(cx, args, tuple(cx, args, 1)?)
}

pub(super) fn add(cx: &mut Context<'_>, args: &[Value]) -> Result<Value, Trap> {
    become_(cx, args, tuple(cx, args, 0)? + tuple(cx, args, 1)?)
}

pub(super) fn add_of(cx: &mut Context<'_>, args: &[Value]) -> Result<Value, Trap> {
    become_(cx, args, tuple(cx, args, 1)? + tuple(cx, args, 2)?)
}

pub(super) fn sub(cx: &mut Context<'_>, args: &[Value]) -> Result<Value, Trap> {
    become_(cx, args, tuple(cx, args, 0)? - tuple(cx, args, 1)?)
}

pub(super) fn sub_of(cx: &mut Context<'_>, args: &[Value]) -> Result<Value, Trap> {
    become_(cx, args, tuple(cx, args, 1)? - tuple(cx, args, 2)?)
}

pub(super) fn scale(cx: &mut Context<'_>, args: &[Value]) -> Result<Value, Trap> {
    become_(cx, args, tuple(cx, args, 0)? * args.double(1))
}

pub(super) fn scale_of(cx: &mut Context<'_>, args: &[Value]) -> Result<Value, Trap> {
    become_(cx, args, tuple(cx, args, 2)? * args.double(1))
}

pub(super) fn scale_add(cx: &mut Context<'_>, args: &[Value]) -> Result<Value, Trap> {
    become_(
        cx,
        args,
        tuple(cx, args, 2)? * args.double(1) + tuple(cx, args, 3)?,
    )
}

pub(super) fn negate(cx: &mut Context<'_>, args: &[Value]) -> Result<Value, Trap> {
    become_(cx, args, -tuple(cx, args, 0)?)
}

pub(super) fn interpolate(cx: &mut Context<'_>, args: &[Value]) -> Result<Value, Trap> {
    let (a, b, share) = (tuple(cx, args, 0)?, tuple(cx, args, 1)?, args.double(2));
    become_(cx, args, a * (1.0 - share) + b * share)
}

pub(super) fn normalize(cx: &mut Context<'_>, args: &[Value]) -> Result<Value, Trap> {
    let v = tuple(cx, args, 0)?;
    become_(cx, args, v / v.length())
}

pub(super) fn normalize_of(cx: &mut Context<'_>, args: &[Value]) -> Result<Value, Trap> {
    let v = tuple(cx, args, 1)?;
    become_(cx, args, v / v.length())
}

pub(super) fn cross(cx: &mut Context<'_>, args: &[Value]) -> Result<Value, Trap> {
    become_(cx, args, tuple(cx, args, 1)?.cross(tuple(cx, args, 2)?))
}

pub(super) fn length(cx: &mut Context<'_>, args: &[Value]) -> Result<Value, Trap> {
    Ok(Value::Double(tuple(cx, args, 0)?.length()))
}

pub(super) fn length_squared(cx: &mut Context<'_>, args: &[Value]) -> Result<Value, Trap> {
    Ok(Value::Double(tuple(cx, args, 0)?.length_squared()))
}

pub(super) fn dot(cx: &mut Context<'_>, args: &[Value]) -> Result<Value, Trap> {
    Ok(Value::Double(tuple(cx, args, 0)?.dot(tuple(cx, args, 1)?)))
}

/// Angle between two vectors in radians, 0 to π.
pub(super) fn angle(cx: &mut Context<'_>, args: &[Value]) -> Result<Value, Trap> {
    let (a, b) = (tuple(cx, args, 0)?, tuple(cx, args, 1)?);
    let cosine = a.dot(b) / (a.length() * b.length());
    Ok(Value::Double(crate::math::functions::acos(
        cosine.clamp(-1.0, 1.0),
    )))
}

pub(super) fn distance(cx: &mut Context<'_>, args: &[Value]) -> Result<Value, Trap> {
    Ok(Value::Double(
        tuple(cx, args, 0)?.distance(tuple(cx, args, 1)?),
    ))
}

pub(super) fn distance_squared(cx: &mut Context<'_>, args: &[Value]) -> Result<Value, Trap> {
    Ok(Value::Double(
        tuple(cx, args, 0)?.distance_squared(tuple(cx, args, 1)?),
    ))
}

fn vector(v: DVec3) -> Value {
    new_object(ClassId::Vector3d, Data::Tuple(v))
}

fn point(v: DVec3) -> Value {
    new_object(ClassId::Point3d, Data::Tuple(v))
}

pub(super) fn vector_plus(cx: &mut Context<'_>, args: &[Value]) -> Result<Value, Trap> {
    Ok(vector(tuple(cx, args, 0)? + tuple(cx, args, 1)?))
}

pub(super) fn point_plus(cx: &mut Context<'_>, args: &[Value]) -> Result<Value, Trap> {
    Ok(point(tuple(cx, args, 0)? + tuple(cx, args, 1)?))
}

pub(super) fn vector_minus(cx: &mut Context<'_>, args: &[Value]) -> Result<Value, Trap> {
    Ok(vector(tuple(cx, args, 0)? - tuple(cx, args, 1)?))
}

pub(super) fn point_minus(cx: &mut Context<'_>, args: &[Value]) -> Result<Value, Trap> {
    Ok(point(tuple(cx, args, 0)? - tuple(cx, args, 1)?))
}

pub(super) fn times(cx: &mut Context<'_>, args: &[Value]) -> Result<Value, Trap> {
    Ok(vector(tuple(cx, args, 0)? * args.double(1)))
}

pub(super) fn over(cx: &mut Context<'_>, args: &[Value]) -> Result<Value, Trap> {
    Ok(vector(tuple(cx, args, 0)? / args.double(1)))
}

/// Sum over red, green and blue.
pub(super) fn integrate(cx: &mut Context<'_>, args: &[Value]) -> Result<Value, Trap> {
    Ok(Value::Double(tuple(cx, args, 0)?.element_sum()))
}
