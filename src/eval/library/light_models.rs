//! `LightModel` and `FluxLightModel`: settings, `compute()`, and what it found.

use super::{Arguments, Context, new_object};
use crate::eval::light_model::{LightModel, LightSettings, LightSolution, NoSolver, NodeLight};
use crate::eval::object::Data;
use crate::eval::trap::Trap;
use crate::eval::value::Value;
use crate::library::ClassId;
use crate::turtle::Layers;
use glam::DVec3;
use std::sync::Arc;

/// Rays and reflections of a light model that sets none (GroIMP's).
const RAYS: i32 = 30_000;
const REFLECTIONS: i32 = 10;
/// Power in W below which rays of a light model end that sets none (GroIMP's).
const MIN_POWER: f64 = 0.001;
/// The `MeasureMode` of red, green and blue; the others are spectra.
const MEASURE_RGB: i32 = 0;

pub(super) fn make(cx: &mut Context<'_>, class: ClassId, args: &[Value]) -> Result<Value, Trap> {
    let settings = LightSettings {
        rays: match args.len() {
            0 => RAYS,
            _ => positive(cx, args.int(0), "rayCount")?,
        },
        depth: match args.len() {
            0 | 1 => REFLECTIONS,
            _ => positive(cx, args.int(1), "depth")?,
        },
        seed: 0,
        min_power: match args.len() {
            0..=2 => MIN_POWER,
            _ => positive_power(cx, args.double(2))?,
        },
        hidden: Layers::default(),
        has_sensors: !matches!(args.at(3), Value::Boolean(false)),
    };
    let model = LightModel {
        settings,
        solution: None,
        has_warned: false,
    };
    Ok(new_object(class, Data::LightModel(Box::new(model))))
}

/// A number of rays or reflections, which GroIMP wants to be at least 1.
fn positive(cx: &Context<'_>, value: i32, what: &str) -> Result<i32, Trap> {
    if value > 0 {
        return Ok(value);
    }
    let message = format!("{what} must be a positive integer but was {value}");
    Err(cx.exception(ClassId::IllegalArgumentException, message))
}

/// The least power of a ray, which GroIMP wants to be above 0.
fn positive_power(cx: &Context<'_>, value: f64) -> Result<f64, Trap> {
    if value > 0.0 {
        return Ok(value);
    }
    let message = format!("minPower must be a positive double but was {value}");
    Err(cx.exception(ClassId::IllegalArgumentException, message))
}

fn change(
    cx: &Context<'_>,
    args: &[Value],
    change: impl FnOnce(&mut LightSettings),
) -> Result<Value, Trap> {
    if let Data::LightModel(model) = &mut *cx.object(args, 0)?.lock() {
        change(&mut model.settings);
    }
    Ok(Value::Null)
}

fn setting(
    cx: &Context<'_>,
    args: &[Value],
    read: impl FnOnce(&LightSettings) -> Value,
) -> Result<Value, Trap> {
    Ok(match &*cx.object(args, 0)?.lock() {
        Data::LightModel(model) => read(&model.settings),
        _ => Value::Null,
    })
}

pub(super) fn set_seed(cx: &mut Context<'_>, args: &[Value]) -> Result<Value, Trap> {
    change(cx, args, |settings| settings.seed = args.long(1))
}

pub(super) fn set_ray_count(cx: &mut Context<'_>, args: &[Value]) -> Result<Value, Trap> {
    let rays = positive(cx, args.int(1), "rayCount")?;
    change(cx, args, |settings| settings.rays = rays)
}

pub(super) fn set_depth(cx: &mut Context<'_>, args: &[Value]) -> Result<Value, Trap> {
    let depth = positive(cx, args.int(1), "depth")?;
    change(cx, args, |settings| settings.depth = depth)
}

pub(super) fn set_min_power(cx: &mut Context<'_>, args: &[Value]) -> Result<Value, Trap> {
    let power = positive_power(cx, args.double(1))?;
    change(cx, args, |settings| settings.min_power = power)
}

pub(super) fn set_sensors(cx: &mut Context<'_>, args: &[Value]) -> Result<Value, Trap> {
    let is_on = matches!(args.at(1), Value::Boolean(true));
    change(cx, args, |settings| settings.has_sensors = is_on)
}

/// As in GroIMP all layers take part until they are hidden; a light model does not ask what pictures hide.
pub(super) fn set_layer_visible(cx: &mut Context<'_>, args: &[Value]) -> Result<Value, Trap> {
    let is_visible = matches!(args.at(2), Value::Boolean(true));
    change(cx, args, |settings| {
        settings.hidden = if is_visible {
            settings.hidden.without(args.int(1))
        } else {
            settings.hidden.with(args.int(1))
        };
    })
}

/// Only red, green and blue are traced: a model that wants more must not go on with numbers that are not there.
pub(super) fn set_measure_mode(cx: &mut Context<'_>, args: &[Value]) -> Result<Value, Trap> {
    if args.int(1) == MEASURE_RGB {
        return Ok(Value::Null);
    }
    let message =
        "spectra are not computed: use `MeasureMode.RGB`, with red, green and blue as three bands";
    Err(cx.exception(ClassId::UnsupportedOperationException, message))
}

pub(super) fn ray_count(cx: &mut Context<'_>, args: &[Value]) -> Result<Value, Trap> {
    setting(cx, args, |settings| Value::Int(settings.rays))
}

pub(super) fn depth(cx: &mut Context<'_>, args: &[Value]) -> Result<Value, Trap> {
    setting(cx, args, |settings| Value::Int(settings.depth))
}

pub(super) fn seed(cx: &mut Context<'_>, args: &[Value]) -> Result<Value, Trap> {
    setting(cx, args, |settings| Value::Long(settings.seed))
}

pub(super) fn random_seed(cx: &mut Context<'_>, args: &[Value]) -> Result<Value, Trap> {
    setting(cx, args, |settings| Value::Int(settings.seed as i32))
}

pub(super) fn min_power(cx: &mut Context<'_>, args: &[Value]) -> Result<Value, Trap> {
    setting(cx, args, |settings| Value::Double(settings.min_power))
}

pub(super) fn has_sensors(cx: &mut Context<'_>, args: &[Value]) -> Result<Value, Trap> {
    setting(cx, args, |settings| Value::Boolean(settings.has_sensors))
}

/// Traces the light of the graph as it is now. GroIMP skips this if the graph has not changed; the result is the same.
pub(super) fn compute(cx: &mut Context<'_>, args: &[Value]) -> Result<Value, Trap> {
    let settings = match &*cx.object(args, 0)?.lock() {
        Data::LightModel(model) => model.settings.clone(),
        _ => return Ok(Value::Null),
    };
    // The solver draws what the machine holds, so it cannot stay in it meanwhile.
    let mut solver = std::mem::replace(&mut cx.machine.light, Box::new(NoSolver));
    let solved = solver.solve(cx.program, cx.machine, &settings);
    cx.machine.light = solver;
    let solution = solved.map_err(|fault| Trap::of_diagnostic(*fault, cx.span))?;
    let charge = cx
        .machine
        .charge(LightSolution::bytes(solution.len()))
        .map_err(|trap| trap.at(cx.span))?;
    if let Data::LightModel(model) = &mut *cx.object(args, 0)?.lock() {
        model.solution = Some((Arc::new(solution), charge));
    }
    Ok(Value::Null)
}

/// What is known of the light on the node of the first argument.
fn light_on(cx: &mut Context<'_>, args: &[Value]) -> Result<NodeLight, Trap> {
    let node = cx.node(args, 1)?;
    let mut is_news = false;
    let light = match &mut *cx.object(args, 0)?.lock() {
        Data::LightModel(model) => {
            is_news = model.solution.is_none() && !model.has_warned;
            model.has_warned |= is_news;
            let solution = model.solution.as_ref();
            solution.map(|(solution, _)| solution.get(node))
        }
        _ => None,
    };
    if is_news {
        // In GroIMP's words, and as there without an end to the run.
        cx.machine
            .print("LightModel data has not yet been computed.\n");
    }
    Ok(light.unwrap_or_default())
}

fn spectrum(bands: [f64; 3]) -> Value {
    new_object(ClassId::Spectrum3d, Data::Tuple(DVec3::from_array(bands)))
}

pub(super) fn absorbed(cx: &mut Context<'_>, args: &[Value]) -> Result<Value, Trap> {
    Ok(spectrum(light_on(cx, args)?.absorbed))
}

pub(super) fn reflected(cx: &mut Context<'_>, args: &[Value]) -> Result<Value, Trap> {
    Ok(spectrum(light_on(cx, args)?.reflected))
}

pub(super) fn transmitted(cx: &mut Context<'_>, args: &[Value]) -> Result<Value, Trap> {
    Ok(spectrum(light_on(cx, args)?.transmitted))
}

pub(super) fn received(cx: &mut Context<'_>, args: &[Value]) -> Result<Value, Trap> {
    Ok(spectrum(light_on(cx, args)?.received))
}

pub(super) fn sensed(cx: &mut Context<'_>, args: &[Value]) -> Result<Value, Trap> {
    Ok(spectrum(light_on(cx, args)?.sensed))
}

pub(super) fn hits(cx: &mut Context<'_>, args: &[Value]) -> Result<Value, Trap> {
    let hits = light_on(cx, args)?.hits;
    Ok(Value::Int(i32::try_from(hits).unwrap_or(i32::MAX)))
}
