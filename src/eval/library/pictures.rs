//! Pictures: `ImageMap`, `Checker`, and how they lie on a surface.

use super::{Arguments, Context, new_object};
use crate::eval::object::{Data, Phong};
use crate::eval::picture::{Paint, Picture, PictureOf, Placement};
use crate::eval::trap::Trap;
use crate::eval::value::Value;
use crate::library::ClassId;
use std::sync::Arc;

fn made(class: ClassId, picture: Picture) -> Value {
    new_object(class, Data::Picture(Box::new(picture)))
}

/// `shader("leaf.png")`: a matt surface with the colours and the holes of a picture.
pub(super) fn named_shader(_: &mut Context<'_>, args: &[Value]) -> Result<Value, Trap> {
    Ok(shader(ClassId::ShaderRef, args.text(0)))
}

pub(super) fn make_shader(
    _: &mut Context<'_>,
    class: ClassId,
    args: &[Value],
) -> Result<Value, Trap> {
    Ok(shader(class, args.text(0)))
}

fn shader(class: ClassId, name: &str) -> Value {
    let phong = Phong {
        diffuse: Paint::Picture(Arc::new(Picture::called(name))),
        ..Phong::default()
    };
    new_object(class, Data::Phong(Box::new(phong)))
}

/// `image("leaf.png")`
pub(super) fn named(_: &mut Context<'_>, args: &[Value]) -> Result<Value, Trap> {
    Ok(made(ClassId::ImageRef, Picture::called(args.text(0))))
}

pub(super) fn make_image(
    _: &mut Context<'_>,
    class: ClassId,
    args: &[Value],
) -> Result<Value, Trap> {
    let picture = match args.at(0) {
        Value::Text(name) => Picture::called(name.as_str()),
        _ => Picture::new(PictureOf::Nothing),
    };
    Ok(made(class, picture))
}

/// From two colours, or white and black as in GroIMP.
pub(super) fn make_checker(
    cx: &mut Context<'_>,
    class: ClassId,
    args: &[Value],
) -> Result<Value, Trap> {
    let mut picture = Picture::new(PictureOf::Checker([[1.0; 3], [0.0; 3]]));
    picture.is_smooth = false;
    let made = made(class, picture);
    for (index, color) in args.iter().enumerate().take(2) {
        set_checker(cx, &[made.clone(), color.clone()], index)?;
    }
    Ok(made)
}

pub(super) fn make_placement(
    _: &mut Context<'_>,
    class: ClassId,
    _: &[Value],
) -> Result<Value, Trap> {
    Ok(new_object(class, Data::Placement(Placement::default())))
}

/// What an argument paints with; `None` of what is neither colour nor picture.
pub(super) fn paint(cx: &Context<'_>, args: &[Value], index: usize) -> Result<Option<Paint>, Trap> {
    Ok(match &*cx.object(args, index)?.lock() {
        Data::Color(color) => Some(Paint::Plain(*color)),
        Data::Picture(picture) => Some(Paint::Picture(Arc::new(Picture::clone(picture)))),
        _ => None,
    })
}

/// Changes the picture that a method is called on.
fn change(
    cx: &Context<'_>,
    args: &[Value],
    change: impl FnOnce(&mut Picture),
) -> Result<Value, Trap> {
    if let Data::Picture(picture) = &mut *cx.object(args, 0)?.lock() {
        change(picture);
    }
    Ok(Value::Null)
}

pub(super) fn set_image(cx: &mut Context<'_>, args: &[Value]) -> Result<Value, Trap> {
    if let Some(Paint::Picture(given)) = paint(cx, args, 1)? {
        change(cx, args, |picture| picture.of = given.of.clone())?;
    }
    Ok(Value::Null)
}

pub(super) fn set_filter(cx: &mut Context<'_>, args: &[Value]) -> Result<Value, Trap> {
    let is_smooth = args.at(1).as_boolean().unwrap_or(true);
    change(cx, args, |picture| picture.is_smooth = is_smooth)
}

pub(super) fn set_input(cx: &mut Context<'_>, args: &[Value]) -> Result<Value, Trap> {
    let lies = match &*cx.object(args, 1)?.lock() {
        Data::Placement(lies) => *lies,
        _ => return Ok(Value::Null),
    };
    change(cx, args, |picture| picture.lies = lies)
}

pub(super) fn set_repeat(cx: &mut Context<'_>, args: &[Value]) -> Result<Value, Trap> {
    let scale = [args.double(1), args.double(2)];
    change(cx, args, |picture| picture.lies.scale = scale)
}

pub(super) fn set_offset(cx: &mut Context<'_>, args: &[Value]) -> Result<Value, Trap> {
    let offset = [args.double(1), args.double(2)];
    change(cx, args, |picture| picture.lies.offset = offset)
}

pub(super) fn set_turn(cx: &mut Context<'_>, args: &[Value]) -> Result<Value, Trap> {
    let angle = args.double(1).to_radians();
    change(cx, args, |picture| picture.lies.angle = angle)
}

fn set_checker(cx: &Context<'_>, args: &[Value], index: usize) -> Result<Value, Trap> {
    let color = match paint(cx, args, 1)? {
        Some(Paint::Plain(color)) => color,
        Some(Paint::Picture(_)) => {
            let message = "a `Checker` of pictures cannot be drawn: give it colours";
            return Err(cx.exception(ClassId::UnsupportedOperationException, message));
        }
        None => return Ok(Value::Null),
    };
    change(cx, args, |picture| {
        if let PictureOf::Checker(colors) = &mut picture.of {
            colors[index] = color;
        }
    })
}

pub(super) fn set_color1(cx: &mut Context<'_>, args: &[Value]) -> Result<Value, Trap> {
    set_checker(cx, args, 0)
}

pub(super) fn set_color2(cx: &mut Context<'_>, args: &[Value]) -> Result<Value, Trap> {
    set_checker(cx, args, 1)
}

fn place(
    cx: &Context<'_>,
    args: &[Value],
    number: fn(&mut Placement) -> &mut f64,
) -> Result<Value, Trap> {
    if let Data::Placement(lies) = &mut *cx.object(args, 0)?.lock() {
        *number(lies) = args.double(1);
    }
    Ok(Value::Null)
}

pub(super) fn set_offset_u(cx: &mut Context<'_>, args: &[Value]) -> Result<Value, Trap> {
    place(cx, args, |lies| &mut lies.offset[0])
}

pub(super) fn set_offset_v(cx: &mut Context<'_>, args: &[Value]) -> Result<Value, Trap> {
    place(cx, args, |lies| &mut lies.offset[1])
}

pub(super) fn set_scale_u(cx: &mut Context<'_>, args: &[Value]) -> Result<Value, Trap> {
    place(cx, args, |lies| &mut lies.scale[0])
}

pub(super) fn set_scale_v(cx: &mut Context<'_>, args: &[Value]) -> Result<Value, Trap> {
    place(cx, args, |lies| &mut lies.scale[1])
}

pub(super) fn set_angle(cx: &mut Context<'_>, args: &[Value]) -> Result<Value, Trap> {
    place(cx, args, |lies| &mut lies.angle)
}

pub(super) fn set_shear(cx: &mut Context<'_>, args: &[Value]) -> Result<Value, Trap> {
    place(cx, args, |lies| &mut lies.shear)
}
