//! The model's generator, and generators of the model's own.

use std::sync::Arc;

use super::{Arguments, Context, new_object};
use crate::eval::object::{Data, Object};
use crate::eval::random::JavaRandom;
use crate::eval::trap::Trap;
use crate::eval::value::Value;
use crate::library::ClassId;
use crate::math::functions::exp;

/// Uniform between two floats, computed in `float`.
pub(super) fn random(cx: &mut Context<'_>, args: &[Value]) -> Result<Value, Trap> {
    let (low, high) = (args.float(0), args.float(1));
    Ok(Value::Float(
        cx.machine.random.next_float() * (high - low) + low,
    ))
}

/// Uniform among the integers from one to another, both included.
pub(super) fn irandom(cx: &mut Context<'_>, args: &[Value]) -> Result<Value, Trap> {
    let (low, high) = (args.int(0), args.int(1));
    let n = high.wrapping_add(1).wrapping_sub(low);
    match cx.machine.random.next_int_below(n) {
        Some(drawn) => Ok(Value::Int(drawn.wrapping_add(low))),
        None => Err(not_positive(cx)),
    }
}

fn not_positive(cx: &Context<'_>) -> Trap {
    cx.exception(ClassId::IllegalArgumentException, "bound must be positive")
}

pub(super) fn normal_float(cx: &mut Context<'_>, args: &[Value]) -> Result<Value, Trap> {
    let deviate = cx.machine.random.next_gaussian() as f32;
    Ok(Value::Float(deviate * args.float(1) + args.float(0)))
}

pub(super) fn normal_double(cx: &mut Context<'_>, args: &[Value]) -> Result<Value, Trap> {
    let deviate = cx.machine.random.next_gaussian();
    Ok(Value::Double(deviate * args.double(1) + args.double(0)))
}

/// Log-normal with given mean and standard deviation of the variable itself.
pub(super) fn lognormal(cx: &mut Context<'_>, args: &[Value]) -> Result<Value, Trap> {
    let (mean, deviation) = (args.double(0), args.double(1));
    let ratio = deviation / mean;
    let squared = ratio * ratio;
    let deviate = cx.machine.random.next_gaussian();
    Ok(Value::Double(
        mean / (1.0 + squared).sqrt() * exp(libm::log1p(squared).sqrt() * deviate),
    ))
}

/// True with a given probability; certainty draws no number, impossibility draws one.
pub(super) fn probability(cx: &mut Context<'_>, args: &[Value]) -> Result<Value, Trap> {
    let p = args.float(0);
    Ok(Value::Boolean(
        p >= 1.0 || cx.machine.random.next_float() < p,
    ))
}

/// An index, drawn with the probabilities in an array; the last index takes what is missing to 1.
pub(super) fn distribution(cx: &mut Context<'_>, args: &[Value]) -> Result<Value, Trap> {
    let Some(array) = args.at(0).as_array() else {
        return Err(Trap::null("draw from an array", cx.span));
    };
    let mut rest = cx.machine.random.next_float();
    let last = array.len().saturating_sub(1);
    for i in 0..last {
        rest -= array.get(i).and_then(|p| p.as_float()).unwrap_or(0.0);
        if rest < 0.0 {
            return Ok(Value::Int(i as i32));
        }
    }
    Ok(Value::Int(last as i32))
}

pub(super) fn set_seed(cx: &mut Context<'_>, args: &[Value]) -> Result<Value, Trap> {
    cx.machine.random.set_seed(args.long(0));
    Ok(Value::Null)
}

pub(super) fn uniform_double(cx: &mut Context<'_>, _: &[Value]) -> Result<Value, Trap> {
    Ok(Value::Double(cx.machine.random.next_double()))
}

/// `new Random()`: Java would take the clock; runs must repeat, so the model's generator gives the seed.
pub(super) fn make(cx: &mut Context<'_>, class: ClassId, _: &[Value]) -> Result<Value, Trap> {
    let seed = cx.machine.random.next_long();
    Ok(new_object(
        class,
        Data::Random(Box::new(JavaRandom::new(seed))),
    ))
}

pub(super) fn make_seeded(
    _: &mut Context<'_>,
    class: ClassId,
    args: &[Value],
) -> Result<Value, Trap> {
    Ok(new_object(
        class,
        Data::Random(Box::new(JavaRandom::new(args.long(0)))),
    ))
}

/// Draws from the generator that is the receiver.
fn draw<T>(object: &Arc<Object>, f: impl FnOnce(&mut JavaRandom) -> T) -> Option<T> {
    match &mut *object.lock() {
        Data::Random(random) => Some(f(random)),
        _ => None,
    }
}

fn drawn(
    cx: &Context<'_>,
    args: &[Value],
    f: impl FnOnce(&mut JavaRandom) -> Value,
) -> Result<Value, Trap> {
    Ok(draw(cx.object(args, 0)?, f).unwrap_or_default())
}

pub(super) fn own_set_seed(cx: &mut Context<'_>, args: &[Value]) -> Result<Value, Trap> {
    let seed = args.long(1);
    drawn(cx, args, |r| {
        r.set_seed(seed);
        Value::Null
    })
}

pub(super) fn own_int(cx: &mut Context<'_>, args: &[Value]) -> Result<Value, Trap> {
    drawn(cx, args, |r| Value::Int(r.next_int()))
}

pub(super) fn own_int_below(cx: &mut Context<'_>, args: &[Value]) -> Result<Value, Trap> {
    let bound = args.int(1);
    let n = draw(cx.object(args, 0)?, |r| r.next_int_below(bound)).flatten();
    n.map(Value::Int).ok_or_else(|| not_positive(cx))
}

pub(super) fn own_long(cx: &mut Context<'_>, args: &[Value]) -> Result<Value, Trap> {
    drawn(cx, args, |r| Value::Long(r.next_long()))
}

pub(super) fn own_float(cx: &mut Context<'_>, args: &[Value]) -> Result<Value, Trap> {
    drawn(cx, args, |r| Value::Float(r.next_float()))
}

pub(super) fn own_double(cx: &mut Context<'_>, args: &[Value]) -> Result<Value, Trap> {
    drawn(cx, args, |r| Value::Double(r.next_double()))
}

pub(super) fn own_boolean(cx: &mut Context<'_>, args: &[Value]) -> Result<Value, Trap> {
    drawn(cx, args, |r| Value::Boolean(r.next_boolean()))
}

pub(super) fn own_gaussian(cx: &mut Context<'_>, args: &[Value]) -> Result<Value, Trap> {
    drawn(cx, args, |r| Value::Double(r.next_gaussian()))
}
