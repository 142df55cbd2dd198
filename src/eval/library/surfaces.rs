//! Shaders with everyday names: mirrors, metals, glass, panes, leaves, and two shaders in one.

use super::{Arguments, Context, new_object, pictures};
use crate::eval::object::{Data, Finish, Phong, Shaders};
use crate::eval::picture::Paint;
use crate::eval::trap::Trap;
use crate::eval::value::Value;
use crate::library::ClassId;

/// Index of refraction of ordinary glass, relative to air.
const GLASS: f64 = 1.5;

fn finish(class: ClassId, color: [f64; 3]) -> Finish {
    // Clear glass absorbs nothing, a clear pane leaves all.
    let color = match class {
        ClassId::Glass => [0.0; 3],
        ClassId::Pane => [1.0; 3],
        _ => color,
    };
    Finish {
        color,
        through: [0.0; 3],
        ior: GLASS,
        roughness: 0.0,
    }
}

fn made(class: ClassId, finish: Finish) -> Result<Value, Trap> {
    Ok(new_object(class, Data::Finish(Box::new(finish))))
}

pub(super) fn make_mirror(_: &mut Context<'_>, class: ClassId, _: &[Value]) -> Result<Value, Trap> {
    made(class, finish(class, [1.0; 3]))
}

pub(super) fn make_gray(
    _: &mut Context<'_>,
    class: ClassId,
    args: &[Value],
) -> Result<Value, Trap> {
    made(class, finish(class, [args.double(0); 3]))
}

/// From red, green, blue, and perhaps roughness.
pub(super) fn make_colored(
    _: &mut Context<'_>,
    class: ClassId,
    args: &[Value],
) -> Result<Value, Trap> {
    let roughness = if args.len() > 3 { args.double(3) } else { 0.0 };
    let color = [0, 1, 2].map(|i| args.double(i));
    made(
        class,
        Finish {
            roughness,
            ..finish(class, color)
        },
    )
}

/// Perhaps from an index of refraction.
pub(super) fn make_clear(
    _: &mut Context<'_>,
    class: ClassId,
    args: &[Value],
) -> Result<Value, Trap> {
    let ior = if args.is_empty() {
        GLASS
    } else {
        args.double(0)
    };
    made(
        class,
        Finish {
            ior,
            ..finish(class, [1.0; 3])
        },
    )
}

pub(super) fn make_leaf(
    _: &mut Context<'_>,
    class: ClassId,
    args: &[Value],
) -> Result<Value, Trap> {
    let through = [3, 4, 5].map(|i| args.double(i));
    let color = [0, 1, 2].map(|i| args.double(i));
    made(
        class,
        Finish {
            through,
            ..finish(class, color)
        },
    )
}

pub(super) fn make_leaf_of_colors(
    cx: &mut Context<'_>,
    class: ClassId,
    args: &[Value],
) -> Result<Value, Trap> {
    let of = |index| {
        let paint = pictures::paint(cx, args, index)?;
        Ok::<_, Trap>(paint.unwrap_or(Paint::Plain([0.0; 3])))
    };
    Ok(leaf(class, of(0)?, of(1)?))
}

/// From what a leaf looks like, and which part of that light it scatters through.
pub(super) fn make_leaf_of_look(
    cx: &mut Context<'_>,
    class: ClassId,
    args: &[Value],
) -> Result<Value, Trap> {
    let through = args.double(1);
    let times = |paint: &Paint, factor: f64| match paint {
        Paint::Plain(color) => Paint::Plain(color.map(|part| part * factor)),
        Paint::Picture(picture) => Paint::Picture(picture.times(factor).into()),
    };
    let look = pictures::paint(cx, args, 0)?.unwrap_or(Paint::Plain([0.0; 3]));
    Ok(leaf(
        class,
        times(&look, 1.0 - through),
        times(&look, through),
    ))
}

fn leaf(class: ClassId, diffuse: Paint, diffuse_transparency: Paint) -> Value {
    let phong = Phong {
        diffuse,
        diffuse_transparency,
        ..Phong::default()
    };
    new_object(class, Data::Phong(Box::new(phong)))
}

pub(super) fn make_mix(_: &mut Context<'_>, class: ClassId, args: &[Value]) -> Result<Value, Trap> {
    pair(class, args, args.double(2))
}

pub(super) fn make_sides(
    _: &mut Context<'_>,
    class: ClassId,
    args: &[Value],
) -> Result<Value, Trap> {
    // As GroIMP does: a side without a shader looks like the other.
    match (args.at(0), args.at(1)) {
        (one, Value::Null) | (Value::Null, one) => Ok(one.clone()),
        _ => pair(class, args, 0.5),
    }
}

/// `AlgorithmSwitchShader(view, light)`
pub(super) fn make_switch(
    _: &mut Context<'_>,
    class: ClassId,
    args: &[Value],
) -> Result<Value, Trap> {
    pair(class, args, 0.0)
}

/// `AlgorithmSwitchShader(window, view, light)`; as in GroIMP pictures without a shader show that of the window.
pub(super) fn make_switch_of_three(
    _: &mut Context<'_>,
    class: ClassId,
    args: &[Value],
) -> Result<Value, Trap> {
    let view = match args.at(1) {
        Value::Null => args.at(0),
        view => view,
    };
    pair(class, &[view.clone(), args.at(2).clone()], 0.0)
}

fn pair(class: ClassId, args: &[Value], share: f64) -> Result<Value, Trap> {
    let (first, second) = (args.at(0).clone(), args.at(1).clone());
    let shaders = Shaders {
        first,
        second,
        share,
    };
    Ok(new_object(class, Data::Shaders(Box::new(shaders))))
}

fn change(
    cx: &Context<'_>,
    args: &[Value],
    change: impl FnOnce(&mut Finish),
) -> Result<Value, Trap> {
    if let Data::Finish(finish) = &mut *cx.object(args, 0)?.lock() {
        change(finish);
    }
    Ok(Value::Null)
}

pub(super) fn set_roughness(cx: &mut Context<'_>, args: &[Value]) -> Result<Value, Trap> {
    change(cx, args, |finish| finish.roughness = args.double(1))
}

/// The tint of a pane, the absorption of glass.
pub(super) fn set_color(cx: &mut Context<'_>, args: &[Value]) -> Result<Value, Trap> {
    change(cx, args, |finish| {
        finish.color = [1, 2, 3].map(|i| args.double(i));
    })
}
