//! Sources of light and the settings of light models.

use super::{Arguments, Context, new_object};
use crate::eval::object::{Data, Light, LightModel};
use crate::eval::trap::Trap;
use crate::eval::value::Value;
use crate::library::ClassId;

/// Power of lamps that set none, in W (GroIMP's).
const LAMP_POWER: f32 = 100.0;
/// Power density of directional light that sets none, in W/m² (GroIMP's).
const SUN_DENSITY: f32 = 10.0;
/// Power density of a sky that sets none, in W/m² (GroIMP's).
const SKY_DENSITY: f32 = 50.0;
/// Rays and reflections of a light model that sets none (GroIMP's).
const RAYS: i32 = 30_000;
const REFLECTIONS: i32 = 10;

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

pub(super) fn make_sky(_: &mut Context<'_>, class: ClassId, _: &[Value]) -> Result<Value, Trap> {
    Ok(new_object(class, Data::Light(Light::new(SKY_DENSITY))))
}

pub(super) fn make_model(
    _: &mut Context<'_>,
    class: ClassId,
    args: &[Value],
) -> Result<Value, Trap> {
    let (rays, depth) = if args.is_empty() {
        (RAYS, REFLECTIONS)
    } else {
        (args.int(0), args.int(1))
    };
    Ok(new_object(
        class,
        Data::LightModel(LightModel {
            rays,
            depth,
            seed: 0,
        }),
    ))
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

fn set_model(
    cx: &Context<'_>,
    args: &[Value],
    change: impl FnOnce(&mut LightModel),
) -> Result<Value, Trap> {
    if let Data::LightModel(model) = &mut *cx.object(args, 0)?.lock() {
        change(model);
    }
    Ok(Value::Null)
}

pub(super) fn set_seed(cx: &mut Context<'_>, args: &[Value]) -> Result<Value, Trap> {
    set_model(cx, args, |model| model.seed = args.long(1))
}

pub(super) fn set_ray_count(cx: &mut Context<'_>, args: &[Value]) -> Result<Value, Trap> {
    set_model(cx, args, |model| model.rays = args.int(1))
}

pub(super) fn set_depth(cx: &mut Context<'_>, args: &[Value]) -> Result<Value, Trap> {
    set_model(cx, args, |model| model.depth = args.int(1))
}

/// Tracing light needs the scene, which growth does not know: refused with a clear message.
pub(super) fn unsupported(cx: &mut Context<'_>, _: &[Value]) -> Result<Value, Trap> {
    let message = "light models are not computed during growth";
    Err(cx.exception(ClassId::UnsupportedOperationException, message))
}
