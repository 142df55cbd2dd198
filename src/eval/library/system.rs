//! Printing, steps, time.

use super::{Arguments, Context};
use crate::eval::trap::Trap;
use crate::eval::value::Value;
use crate::library::ClassId;

pub(super) fn nothing(_: &mut Context<'_>, _: &[Value]) -> Result<Value, Trap> {
    Ok(Value::Null)
}

pub(super) fn println(cx: &mut Context<'_>, _: &[Value]) -> Result<Value, Trap> {
    cx.machine.print("\n");
    Ok(Value::Null)
}

pub(super) fn println_text(cx: &mut Context<'_>, args: &[Value]) -> Result<Value, Trap> {
    let mut line = String::new();
    cx.machine.append_text(args.at(0), &mut line);
    line.push('\n');
    cx.machine.print(&line);
    Ok(Value::Null)
}

pub(super) fn print_text(cx: &mut Context<'_>, args: &[Value]) -> Result<Value, Trap> {
    let mut text = String::new();
    cx.machine.append_text(args.at(0), &mut text);
    cx.machine.print(&text);
    Ok(Value::Null)
}

/// A window that does nothing.
pub(super) fn view(_: &mut Context<'_>, _: &[Value]) -> Result<Value, Trap> {
    Ok(super::new_object(
        ClassId::View3D,
        crate::eval::object::Data::Throwable(None),
    ))
}

/// `stop()`.
pub(super) fn stop(cx: &mut Context<'_>, _: &[Value]) -> Result<Value, Trap> {
    cx.machine.is_finished = true;
    Ok(Value::Null)
}

/// `System.exit(n)`.
pub(super) fn exit(cx: &mut Context<'_>, args: &[Value]) -> Result<Value, Trap> {
    let message = format!("the model ended the run by `System.exit({})`", args.int(0));
    let hint = "end the growth with `--steps`, and leave this call out";
    Err(Trap::limit("model-exit", message, hint, Some(cx.span)))
}

/// Applies what the rules have queued.
pub(super) fn derive(cx: &mut Context<'_>, _: &[Value]) -> Result<Value, Trap> {
    cx.machine.derive(cx.span)?;
    Ok(Value::Null)
}

/// Starts the model again from an empty graph.
pub(super) fn reset(cx: &mut Context<'_>, _: &[Value]) -> Result<Value, Trap> {
    cx.machine
        .clear(cx.program)
        .map_err(|trap| trap.at(cx.span))?;
    cx.program.run_init(cx.machine)?;
    Ok(Value::Null)
}

pub(super) fn set_derivation_mode(cx: &mut Context<'_>, args: &[Value]) -> Result<Value, Trap> {
    let mode = args.int(0);
    let missing = match mode {
        _ if mode & INTERPRETIVE != 0 => "INTERPRETIVE_FLAG",
        _ if mode & KINDS == PARALLEL_NON_DETERMINISTIC => "PARALLEL_NON_DETERMINISTIC_MODE",
        _ => {
            cx.machine.derivation_mode = mode;
            return Ok(Value::Null);
        }
    };
    let message = format!(
        "{missing} is not supported; there are PARALLEL_MODE, SEQUENTIAL_MODE and SEQUENTIAL_NON_DETERMINISTIC_MODE, \
         each with or without EXCLUDE_DELETED_FLAG"
    );
    Err(cx.exception(ClassId::IllegalArgumentException, message))
}

/// Bits of the derivation mode that say which matches are applied.
const KINDS: i32 = 3;
/// One of them.
const PARALLEL_NON_DETERMINISTIC: i32 = 1;
/// Bit of the derivation mode for interpretive rules.
const INTERPRETIVE: i32 = 4;

pub(super) fn derivation_mode(cx: &mut Context<'_>, _: &[Value]) -> Result<Value, Trap> {
    Ok(Value::Int(cx.machine.derivation_mode))
}

/// Growth knows no clock, so that a run repeats: time is the number of the step, in milliseconds.
pub(super) fn time(cx: &mut Context<'_>, _: &[Value]) -> Result<Value, Trap> {
    Ok(Value::Long(
        i64::try_from(cx.machine.step).unwrap_or(i64::MAX),
    ))
}
