//! Shaders and the colour maps they are made of.

use super::{Arguments, Context, new_object, pictures};
use crate::color::Rgb;
use crate::eval::object::{Data, Phong};
use crate::eval::picture::Paint;
use crate::eval::trap::Trap;
use crate::eval::value::Value;
use crate::library::ClassId;

/// An opaque `RGBAShader`.
pub(super) fn opaque(color: Rgb) -> Value {
    let [r, g, b] = color.to_array().map(|x| x as f32);
    new_object(ClassId::RGBAShader, Data::Shader([r, g, b, 1.0]))
}

/// What surfaces without a shader look like.
pub(super) fn half_gray() -> Value {
    new_object(ClassId::RGBAShader, Data::Shader([0.5, 0.5, 0.5, 1.0]))
}

pub(super) fn make_gray(_: &mut Context<'_>, _: ClassId, _: &[Value]) -> Result<Value, Trap> {
    Ok(half_gray())
}

pub(super) fn make_rgb(_: &mut Context<'_>, class: ClassId, args: &[Value]) -> Result<Value, Trap> {
    Ok(new_object(
        class,
        Data::Shader([args.float(0), args.float(1), args.float(2), 1.0]),
    ))
}

/// From 0xRRGGBB, as colours are numbered in Java.
pub(super) fn make_bits(
    _: &mut Context<'_>,
    class: ClassId,
    args: &[Value],
) -> Result<Value, Trap> {
    let [_, red, green, blue] = args.int(0).to_be_bytes().map(|c| f32::from(c) / 255.0);
    Ok(new_object(class, Data::Shader([red, green, blue, 1.0])))
}

pub(super) fn make_rgba(
    _: &mut Context<'_>,
    class: ClassId,
    args: &[Value],
) -> Result<Value, Trap> {
    Ok(new_object(
        class,
        Data::Shader([0, 1, 2, 3].map(|i| args.float(i))),
    ))
}

pub(super) fn make_of_color(
    cx: &mut Context<'_>,
    class: ClassId,
    args: &[Value],
) -> Result<Value, Trap> {
    let color = match &*cx.object(args, 0)?.lock() {
        Data::Color(c) => c.map(|x| x as f32),
        _ => [0.5; 3],
    };
    let [r, g, b] = color;
    Ok(new_object(class, Data::Shader([r, g, b, 1.0])))
}

/// `color.set(…)`; of the colour of a light it changes the light.
pub(super) fn set_rgb(cx: &mut Context<'_>, args: &[Value]) -> Result<Value, Trap> {
    let new = if args.len() > 2 {
        [1, 2, 3].map(|i| args.double(i))
    } else {
        match &*cx.object(args, 1)?.lock() {
            Data::Color(c) => *c,
            _ => return Ok(Value::Null),
        }
    };
    let light = match &mut *cx.object(args, 0)?.lock() {
        Data::Color(c) => {
            *c = new;
            return Ok(Value::Null);
        }
        Data::LightColor(light) => std::sync::Arc::clone(light),
        _ => return Ok(Value::Null),
    };
    if let Data::Light(light) = &mut *light.lock() {
        light.color = new.map(|x| x as f32);
    }
    Ok(Value::Null)
}

/// `light.getColor()`.
pub(super) fn light_color(cx: &mut Context<'_>, args: &[Value]) -> Result<Value, Trap> {
    let light = std::sync::Arc::clone(cx.object(args, 0)?);
    Ok(new_object(ClassId::RGBColor, Data::LightColor(light)))
}

pub(super) fn make_color(
    _: &mut Context<'_>,
    class: ClassId,
    args: &[Value],
) -> Result<Value, Trap> {
    Ok(new_object(
        class,
        Data::Color([0, 1, 2].map(|i| args.double(i))),
    ))
}

pub(super) fn make_graytone(
    _: &mut Context<'_>,
    class: ClassId,
    args: &[Value],
) -> Result<Value, Trap> {
    Ok(new_object(class, Data::Color([args.double(0); 3])))
}

pub(super) fn make_phong(_: &mut Context<'_>, class: ClassId, _: &[Value]) -> Result<Value, Trap> {
    Ok(new_object(class, Data::Phong(Box::default())))
}

fn component(data: &Data, index: usize) -> Value {
    match data {
        Data::Shader(c) => Value::Float(c[index]),
        _ => Value::Float(0.0),
    }
}

fn set_component(data: &mut Data, index: usize, value: &Value) {
    if let Data::Shader(c) = data {
        c[index] = value.as_float().unwrap_or(0.0);
    }
}

pub(super) fn red(data: &Data) -> Value {
    component(data, 0)
}

pub(super) fn green(data: &Data) -> Value {
    component(data, 1)
}

pub(super) fn blue(data: &Data) -> Value {
    component(data, 2)
}

pub(super) fn alpha(data: &Data) -> Value {
    component(data, 3)
}

pub(super) fn set_red(data: &mut Data, value: &Value) {
    set_component(data, 0, value);
}

pub(super) fn set_green(data: &mut Data, value: &Value) {
    set_component(data, 1, value);
}

pub(super) fn set_blue(data: &mut Data, value: &Value) {
    set_component(data, 2, value);
}

pub(super) fn set_alpha(data: &mut Data, value: &Value) {
    set_component(data, 3, value);
}

/// Colour as `0xAARRGGBB`; of a picture, which is not read yet, half gray.
pub(super) fn average_color(cx: &mut Context<'_>, args: &[Value]) -> Result<Value, Trap> {
    let shader = match &*cx.object(args, 0)?.lock() {
        Data::Shaders(pair) => Some(pair.first.clone()),
        _ => None,
    };
    if let Some(shader) = shader.filter(|shader| !shader.is_null()) {
        return average_color(cx, &[shader]);
    }
    let rgba = match &*cx.object(args, 0)?.lock() {
        Data::Shader(c) => c.map(f64::from),
        Data::Phong(p) => {
            let plain = |paint: &Paint, else_: f64| match paint {
                Paint::Plain(color) => *color,
                Paint::Picture(_) => [else_; 3],
            };
            let [r, g, b] = plain(&p.diffuse, 0.5);
            let through: f64 = plain(&p.transparency, 0.0).iter().sum();
            [r, g, b, 1.0 - through / 3.0]
        }
        _ => [0.5, 0.5, 0.5, 1.0],
    };
    let [r, g, b, a] = rgba.map(|x| (x.clamp(0.0, 1.0) * 255.0).round() as u32);
    Ok(Value::Int(((a << 24) | (r << 16) | (g << 8) | b) as i32))
}

/// Sets one channel of a `Phong` shader to the map in the second argument.
fn set_channel(
    cx: &Context<'_>,
    args: &[Value],
    channel: fn(&mut Phong) -> &mut Paint,
) -> Result<Value, Trap> {
    let Some(paint) = pictures::paint(cx, args, 1)? else {
        return Ok(Value::Null);
    };
    if let Data::Phong(phong) = &mut *cx.object(args, 0)?.lock() {
        *channel(phong) = paint;
    }
    Ok(Value::Null)
}

pub(super) fn set_diffuse(cx: &mut Context<'_>, args: &[Value]) -> Result<Value, Trap> {
    set_channel(cx, args, |p| &mut p.diffuse)
}

pub(super) fn set_diffuse_transparency(
    cx: &mut Context<'_>,
    args: &[Value],
) -> Result<Value, Trap> {
    set_channel(cx, args, |p| &mut p.diffuse_transparency)
}

pub(super) fn set_specular(cx: &mut Context<'_>, args: &[Value]) -> Result<Value, Trap> {
    set_channel(cx, args, |p| &mut p.specular)
}

pub(super) fn set_transparency(cx: &mut Context<'_>, args: &[Value]) -> Result<Value, Trap> {
    set_channel(cx, args, |p| &mut p.transparency)
}

pub(super) fn set_ambient(cx: &mut Context<'_>, args: &[Value]) -> Result<Value, Trap> {
    set_channel(cx, args, |p| &mut p.ambient)
}

pub(super) fn set_emissive(cx: &mut Context<'_>, args: &[Value]) -> Result<Value, Trap> {
    set_channel(cx, args, |p| &mut p.emissive)
}

/// The mean of a map.
fn mean(cx: &Context<'_>, args: &[Value]) -> Result<Option<f64>, Trap> {
    Ok(match &*cx.object(args, 1)?.lock() {
        Data::Color(c) => Some(c.iter().sum::<f64>() / 3.0),
        Data::Picture(_) => {
            let message =
                "a picture cannot say how sharp a gloss is: give a number or a `Graytone`";
            return Err(cx.exception(ClassId::UnsupportedOperationException, message));
        }
        _ => None,
    })
}

fn change(
    cx: &Context<'_>,
    args: &[Value],
    change: impl FnOnce(&mut Phong),
) -> Result<Value, Trap> {
    if let Data::Phong(phong) = &mut *cx.object(args, 0)?.lock() {
        change(phong);
    }
    Ok(Value::Null)
}

/// The sharpness of the gloss as a map: its mean counts.
pub(super) fn set_shininess_map(cx: &mut Context<'_>, args: &[Value]) -> Result<Value, Trap> {
    let mean = mean(cx, args)?;
    change(cx, args, |phong| phong.shininess = mean)
}

pub(super) fn set_shininess(cx: &mut Context<'_>, args: &[Value]) -> Result<Value, Trap> {
    change(cx, args, |phong| phong.shininess = Some(args.double(1)))
}

pub(super) fn set_transparency_shininess(
    cx: &mut Context<'_>,
    args: &[Value],
) -> Result<Value, Trap> {
    let mean = mean(cx, args)?;
    change(cx, args, |phong| phong.transparency_shininess = mean)
}

pub(super) fn set_interpolated(cx: &mut Context<'_>, args: &[Value]) -> Result<Value, Trap> {
    let is_interpolated = args.at(1).as_boolean().unwrap_or(true);
    change(cx, args, |phong| phong.is_interpolated = is_interpolated)
}
