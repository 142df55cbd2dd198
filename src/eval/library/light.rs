//! Sources of light and the settings of light models.

use super::{Arguments, Context, new_object};
use crate::eval::object::{Data, Light, LightModel};
use crate::eval::trap::Trap;
use crate::eval::value::Value;
use crate::library::ClassId;
use crate::turtle::Layers;

/// Power of lamps that set none, in W (GroIMP's).
const LAMP_POWER: f32 = 100.0;
/// Power density of directional light that sets none, in W/m² (GroIMP's).
const SUN_DENSITY: f32 = 10.0;
/// Rays and reflections of a light model that sets none (GroIMP's).
const RAYS: i32 = 30_000;
const REFLECTIONS: i32 = 10;
/// Power in W below which rays of a light model end that sets none (GroIMP's).
const MIN_POWER: f64 = 0.001;

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
            min_power: if args.len() > 2 {
                args.double(2)
            } else {
                MIN_POWER
            },
            hidden: Layers::default(),
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

pub(super) fn set_min_power(cx: &mut Context<'_>, args: &[Value]) -> Result<Value, Trap> {
    set_model(cx, args, |model| model.min_power = args.double(1))
}

/// As in GroIMP all layers take part until they are hidden; a light model does not ask what pictures hide.
pub(super) fn set_layer_visible(cx: &mut Context<'_>, args: &[Value]) -> Result<Value, Trap> {
    let is_visible = matches!(args.at(2), Value::Boolean(true));
    set_model(cx, args, |model| {
        model.hidden = if is_visible {
            model.hidden.without(args.int(1))
        } else {
            model.hidden.with(args.int(1))
        };
    })
}

fn of_model(cx: &Context<'_>, args: &[Value], read: fn(&LightModel) -> i32) -> Result<Value, Trap> {
    Ok(match &*cx.object(args, 0)?.lock() {
        Data::LightModel(model) => Value::Int(read(model)),
        _ => Value::Int(0),
    })
}

pub(super) fn ray_count(cx: &mut Context<'_>, args: &[Value]) -> Result<Value, Trap> {
    of_model(cx, args, |model| model.rays)
}

pub(super) fn depth(cx: &mut Context<'_>, args: &[Value]) -> Result<Value, Trap> {
    of_model(cx, args, |model| model.depth)
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

/// Tracing light needs the scene, which growth does not know: refused with a clear message.
pub(super) fn unsupported(cx: &mut Context<'_>, _: &[Value]) -> Result<Value, Trap> {
    let message = "light models are not computed during growth";
    Err(cx.exception(ClassId::UnsupportedOperationException, message))
}
