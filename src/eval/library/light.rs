//! Sources of light.

use super::{Arguments, Context, new_object};
use crate::eval::object::{Data, Light};
use crate::eval::trap::Trap;
use crate::eval::value::Value;
use crate::library::ClassId;

/// Power of lamps that set none, in W (GroIMP's).
const LAMP_POWER: f32 = 100.0;
/// Power density of directional light that sets none, in W/m² (GroIMP's).
const SUN_DENSITY: f32 = 10.0;

pub(super) fn make_lamp(_: &mut Context<'_>, class: ClassId, _: &[Value]) -> Result<Value, Trap> {
    Ok(new_object(class, Data::Light(Light::new(LAMP_POWER))))
}

pub(super) fn make_directional(
    _: &mut Context<'_>,
    class: ClassId,
    _: &[Value],
) -> Result<Value, Trap> {
    Ok(new_object(class, Data::Light(Light::new(SUN_DENSITY))))
}

fn set(cx: &Context<'_>, args: &[Value], change: impl FnOnce(&mut Light)) -> Result<Value, Trap> {
    if let Data::Light(light) = &mut *cx.object(args, 0)?.lock() {
        change(light);
    }
    Ok(Value::Null)
}

pub(super) fn set_color(cx: &mut Context<'_>, args: &[Value]) -> Result<Value, Trap> {
    set(cx, args, |light| {
        light.color = [1, 2, 3].map(|i| args.float(i));
    })
}

pub(super) fn set_color_map(cx: &mut Context<'_>, args: &[Value]) -> Result<Value, Trap> {
    let color = match &*cx.object(args, 1)?.lock() {
        Data::Color(c) => c.map(|x| x as f32),
        _ => return Ok(Value::Null),
    };
    set(cx, args, |light| light.color = color)
}

pub(super) fn set_power(cx: &mut Context<'_>, args: &[Value]) -> Result<Value, Trap> {
    set(cx, args, |light| light.power = args.float(1))
}

pub(super) fn set_inner_angle(cx: &mut Context<'_>, args: &[Value]) -> Result<Value, Trap> {
    set(cx, args, |light| light.inner_angle = args.float(1))
}

pub(super) fn set_outer_angle(cx: &mut Context<'_>, args: &[Value]) -> Result<Value, Trap> {
    set(cx, args, |light| light.outer_angle = args.float(1))
}

pub(super) fn set_exponent(cx: &mut Context<'_>, args: &[Value]) -> Result<Value, Trap> {
    set(cx, args, |light| light.exponent = args.float(1))
}

fn of_light(cx: &Context<'_>, args: &[Value], read: fn(&Light) -> f32) -> Result<Value, Trap> {
    Ok(match &*cx.object(args, 0)?.lock() {
        Data::Light(light) => Value::Float(read(light)),
        _ => Value::Float(0.0),
    })
}

pub(super) fn power(cx: &mut Context<'_>, args: &[Value]) -> Result<Value, Trap> {
    of_light(cx, args, |light| light.power)
}

pub(super) fn inner_angle(cx: &mut Context<'_>, args: &[Value]) -> Result<Value, Trap> {
    of_light(cx, args, |light| light.inner_angle)
}

pub(super) fn outer_angle(cx: &mut Context<'_>, args: &[Value]) -> Result<Value, Trap> {
    of_light(cx, args, |light| light.outer_angle)
}
