//! `Matrix3d` and `Matrix4d` of `javax.vecmath`: columns are where the axes go, points are columns.
//!
//! A `Matrix3d` is kept as a 4 × 4 matrix whose last row and column are those of the identity.

use glam::{DMat4, DVec3, DVec4};

use super::{Arguments, Context, new_object};
use crate::eval::decimal::java_double_to_string;
use crate::eval::object::Data;
use crate::eval::trap::Trap;
use crate::eval::value::Value;
use crate::library::ClassId;

/// The zero matrix of a class.
fn zero(class: ClassId) -> DMat4 {
    if class.is_a(ClassId::Matrix3d) {
        DMat4::from_cols(DVec4::ZERO, DVec4::ZERO, DVec4::ZERO, DVec4::W)
    } else {
        DMat4::ZERO
    }
}

fn made(class: ClassId, matrix: DMat4) -> Value {
    new_object(class, Data::Matrix(Box::new(matrix)))
}

/// All zero, as Java makes it.
pub(super) fn make(_: &mut Context<'_>, class: ClassId, _: &[Value]) -> Result<Value, Trap> {
    Ok(made(class, zero(class)))
}

pub(super) fn make_copy(
    cx: &mut Context<'_>,
    class: ClassId,
    args: &[Value],
) -> Result<Value, Trap> {
    Ok(made(class, matrix(cx, args, 0)?))
}

/// `new Matrix3d(m00, m01, … m22)`, row by row.
pub(super) fn make_rows(
    _: &mut Context<'_>,
    class: ClassId,
    args: &[Value],
) -> Result<Value, Trap> {
    let mut new = zero(class);
    for i in 0..9 {
        new.col_mut(i % 3)[i / 3] = args.double(i);
    }
    Ok(made(class, new))
}

/// The matrix of a place: what makes coordinates at a node those of the world.
pub(super) fn of_place(transform: glam::DAffine3) -> Value {
    made(ClassId::Matrix34d, DMat4::from(transform))
}

fn matrix(cx: &Context<'_>, args: &[Value], index: usize) -> Result<DMat4, Trap> {
    Ok(match &*cx.object(args, index)?.lock() {
        Data::Matrix(found) => **found,
        _ => DMat4::IDENTITY,
    })
}

/// Puts a new matrix in place of the receiver.
fn become_(cx: &Context<'_>, args: &[Value], new: DMat4) -> Result<Value, Trap> {
    let object = cx.object(args, 0)?;
    let is_small = object.class.is_a(ClassId::Matrix3d);
    if let Data::Matrix(old) = &mut *object.lock() {
        **old = new;
        if is_small {
            old.w_axis = DVec4::W;
            for column in 0..3 {
                old.col_mut(column)[3] = 0.0;
            }
        }
    }
    Ok(Value::Null)
}

/// Reads the element in row `R`, column `C`.
pub(super) fn element<const R: usize, const C: usize>(data: &Data) -> Value {
    match data {
        Data::Matrix(found) => Value::Double(found.col(C)[R]),
        _ => Value::Double(0.0),
    }
}

/// Sets the element in row `R`, column `C`.
pub(super) fn set_element<const R: usize, const C: usize>(data: &mut Data, value: &Value) {
    if let Data::Matrix(found) = data {
        found.col_mut(C)[R] = value.as_double().unwrap_or(0.0);
    }
}

/// Row and column, checked.
fn place(cx: &Context<'_>, args: &[Value]) -> Result<(usize, usize), Trap> {
    let n = if cx.object(args, 0)?.class.is_a(ClassId::Matrix3d) {
        3
    } else {
        4
    };
    let known = |index: i32| usize::try_from(index).ok().filter(|&i| i < n);
    known(args.int(1)).zip(known(args.int(2))).ok_or_else(|| {
        let message = format!("row {}, column {} of {n}", args.int(1), args.int(2));
        cx.exception(ClassId::ArrayIndexOutOfBoundsException, message)
    })
}

pub(super) fn get_element(cx: &mut Context<'_>, args: &[Value]) -> Result<Value, Trap> {
    let (row, column) = place(cx, args)?;
    Ok(Value::Double(matrix(cx, args, 0)?.col(column)[row]))
}

pub(super) fn put_element(cx: &mut Context<'_>, args: &[Value]) -> Result<Value, Trap> {
    let (row, column) = place(cx, args)?;
    let mut new = matrix(cx, args, 0)?;
    new.col_mut(column)[row] = args.double(3);
    become_(cx, args, new)
}

pub(super) fn set_identity(cx: &mut Context<'_>, args: &[Value]) -> Result<Value, Trap> {
    become_(cx, args, DMat4::IDENTITY)
}

pub(super) fn set_zero(cx: &mut Context<'_>, args: &[Value]) -> Result<Value, Trap> {
    become_(cx, args, DMat4::ZERO)
}

/// `m.set(other)`
pub(super) fn set(cx: &mut Context<'_>, args: &[Value]) -> Result<Value, Trap> {
    become_(cx, args, matrix(cx, args, 1)?)
}

/// `m.set(vector)`: a move.
pub(super) fn set_move(cx: &mut Context<'_>, args: &[Value]) -> Result<Value, Trap> {
    become_(cx, args, DMat4::from_translation(tuple(cx, args, 1)?))
}

/// `m.set(scale)`
pub(super) fn set_scale(cx: &mut Context<'_>, args: &[Value]) -> Result<Value, Trap> {
    become_(cx, args, DMat4::from_scale(DVec3::splat(args.double(1))))
}

/// `m.setTranslation(vector)`: the rest stays.
pub(super) fn set_translation(cx: &mut Context<'_>, args: &[Value]) -> Result<Value, Trap> {
    let mut new = matrix(cx, args, 0)?;
    let [x, y, z] = tuple(cx, args, 1)?.to_array();
    new.w_axis = DVec4::new(x, y, z, new.w_axis.w);
    become_(cx, args, new)
}

/// `m.get(vector)`: the vector becomes the move.
pub(super) fn get_translation(cx: &mut Context<'_>, args: &[Value]) -> Result<Value, Trap> {
    let moved = matrix(cx, args, 0)?.w_axis.truncate();
    put_tuple(cx, args, 1, moved)
}

/// A rotation about a unit axis; sine and cosine are those of every machine.
fn rotation(cx: &Context<'_>, args: &[Value], axis: usize) -> Result<Value, Trap> {
    let (sine, cosine) = crate::math::functions::sin_cos(args.double(1));
    let (next, last) = ((axis + 1) % 3, (axis + 2) % 3);
    let mut new = DMat4::IDENTITY;
    new.col_mut(next)[next] = cosine;
    new.col_mut(next)[last] = sine;
    new.col_mut(last)[next] = -sine;
    new.col_mut(last)[last] = cosine;
    become_(cx, args, new)
}

pub(super) fn rotate_x(cx: &mut Context<'_>, args: &[Value]) -> Result<Value, Trap> {
    rotation(cx, args, 0)
}

pub(super) fn rotate_y(cx: &mut Context<'_>, args: &[Value]) -> Result<Value, Trap> {
    rotation(cx, args, 1)
}

pub(super) fn rotate_z(cx: &mut Context<'_>, args: &[Value]) -> Result<Value, Trap> {
    rotation(cx, args, 2)
}

/// `m.mul(other)`
pub(super) fn mul(cx: &mut Context<'_>, args: &[Value]) -> Result<Value, Trap> {
    become_(cx, args, matrix(cx, args, 0)? * matrix(cx, args, 1)?)
}

/// `m.mul(a, b)`
pub(super) fn mul_of(cx: &mut Context<'_>, args: &[Value]) -> Result<Value, Trap> {
    become_(cx, args, matrix(cx, args, 1)? * matrix(cx, args, 2)?)
}

/// `m.mul(number)`
pub(super) fn mul_number(cx: &mut Context<'_>, args: &[Value]) -> Result<Value, Trap> {
    become_(cx, args, matrix(cx, args, 0)? * args.double(1))
}

pub(super) fn add(cx: &mut Context<'_>, args: &[Value]) -> Result<Value, Trap> {
    become_(cx, args, matrix(cx, args, 0)? + matrix(cx, args, 1)?)
}

pub(super) fn sub(cx: &mut Context<'_>, args: &[Value]) -> Result<Value, Trap> {
    become_(cx, args, matrix(cx, args, 0)? - matrix(cx, args, 1)?)
}

/// `m.transpose()`, `m.transpose(other)`
pub(super) fn transpose(cx: &mut Context<'_>, args: &[Value]) -> Result<Value, Trap> {
    become_(cx, args, matrix(cx, args, args.len() - 1)?.transpose())
}

/// `m.invert()`, `m.invert(other)`; a matrix without an inverse is an exception, as in Java.
pub(super) fn invert(cx: &mut Context<'_>, args: &[Value]) -> Result<Value, Trap> {
    let old = matrix(cx, args, args.len() - 1)?;
    let new = old.inverse();
    if old.determinant() == 0.0 || !new.is_finite() {
        let message = "the matrix has no inverse";
        return Err(cx.exception(ClassId::ArithmeticException, message));
    }
    become_(cx, args, new)
}

pub(super) fn determinant(cx: &mut Context<'_>, args: &[Value]) -> Result<Value, Trap> {
    Ok(Value::Double(matrix(cx, args, 0)?.determinant()))
}

fn tuple(cx: &Context<'_>, args: &[Value], index: usize) -> Result<DVec3, Trap> {
    Ok(cx.object(args, index)?.tuple().unwrap_or_default())
}

fn put_tuple(cx: &Context<'_>, args: &[Value], index: usize, new: DVec3) -> Result<Value, Trap> {
    if let Data::Tuple(old) = &mut *cx.object(args, index)?.lock() {
        *old = new;
    }
    Ok(Value::Null)
}

/// `m.transform(tuple)`, `m.transform(tuple, result)`: points are moved too, vectors are only turned and scaled.
pub(super) fn transform(cx: &mut Context<'_>, args: &[Value]) -> Result<Value, Trap> {
    let (matrix, old) = (matrix(cx, args, 0)?, tuple(cx, args, 1)?);
    let is_point = cx.object(args, 1)?.class.is_a(ClassId::Point3d);
    let new = matrix * old.extend(f64::from(u8::from(is_point)));
    put_tuple(cx, args, args.len() - 1, new.truncate())
}

/// The text of a matrix as Java gives it: a row in a line.
pub fn text_of(matrix: &DMat4, is_small: bool) -> String {
    let n = if is_small { 3 } else { 4 };
    let row = |row: usize| {
        let cells: Vec<String> = (0..n)
            .map(|column| java_double_to_string(matrix.col(column)[row]))
            .collect();
        cells.join(", ") + "\n"
    };
    (0..n).map(row).collect()
}
