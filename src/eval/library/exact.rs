//! Arithmetic that tells when it overflows, bits of numbers, numbers in other bases, and characters.

use std::cmp::Ordering;

use super::{Arguments, Context};
use crate::eval::hooks::java_order;
use crate::eval::text::char_of;
use crate::eval::trap::Trap;
use crate::eval::value::Value;
use crate::library::ClassId;

type Answer = Result<Value, Trap>;

fn int_or_overflow(cx: &Context<'_>, x: Option<i32>) -> Answer {
    x.map(Value::Int)
        .ok_or_else(|| cx.exception(ClassId::ArithmeticException, "integer overflow"))
}

fn long_or_overflow(cx: &Context<'_>, x: Option<i64>) -> Answer {
    x.map(Value::Long)
        .ok_or_else(|| cx.exception(ClassId::ArithmeticException, "long overflow"))
}

pub(super) fn add_int(cx: &mut Context<'_>, args: &[Value]) -> Answer {
    int_or_overflow(cx, args.int(0).checked_add(args.int(1)))
}

pub(super) fn add_long(cx: &mut Context<'_>, args: &[Value]) -> Answer {
    long_or_overflow(cx, args.long(0).checked_add(args.long(1)))
}

pub(super) fn subtract_int(cx: &mut Context<'_>, args: &[Value]) -> Answer {
    int_or_overflow(cx, args.int(0).checked_sub(args.int(1)))
}

pub(super) fn subtract_long(cx: &mut Context<'_>, args: &[Value]) -> Answer {
    long_or_overflow(cx, args.long(0).checked_sub(args.long(1)))
}

pub(super) fn multiply_int(cx: &mut Context<'_>, args: &[Value]) -> Answer {
    int_or_overflow(cx, args.int(0).checked_mul(args.int(1)))
}

pub(super) fn multiply_long(cx: &mut Context<'_>, args: &[Value]) -> Answer {
    long_or_overflow(cx, args.long(0).checked_mul(args.long(1)))
}

pub(super) fn to_int(cx: &mut Context<'_>, args: &[Value]) -> Answer {
    int_or_overflow(cx, i32::try_from(args.long(0)).ok())
}

/// `Math.floorDiv` of longs.
pub(super) fn floor_div(cx: &mut Context<'_>, args: &[Value]) -> Answer {
    let (a, b) = (args.long(0), args.long(1));
    if b == 0 {
        return Err(cx.exception(ClassId::ArithmeticException, "/ by zero"));
    }
    let is_below = a.wrapping_rem(b) != 0 && (a < 0) != (b < 0);
    Ok(Value::Long(a.wrapping_div(b) - i64::from(is_below)))
}

/// `Math.floorMod` of longs.
pub(super) fn floor_mod(cx: &mut Context<'_>, args: &[Value]) -> Answer {
    let (a, b) = (args.long(0), args.long(1));
    if b == 0 {
        return Err(cx.exception(ClassId::ArithmeticException, "/ by zero"));
    }
    let rest = a.wrapping_rem(b);
    let is_other = rest != 0 && (rest < 0) != (b < 0);
    Ok(Value::Long(if is_other { rest + b } else { rest }))
}

pub(super) fn fma(_: &mut Context<'_>, args: &[Value]) -> Answer {
    let (a, b, c) = (args.double(0), args.double(1), args.double(2));
    Ok(Value::Double(libm::fma(a, b, c)))
}

/// Distance from |x| to the next greater number.
pub(super) fn ulp(x: f64) -> f64 {
    let x = x.abs();
    if x == f64::MAX {
        x - x.next_down()
    } else if x.is_finite() {
        x.next_up() - x
    } else {
        x
    }
}

/// Remainder after the nearest quotient, the even one of two that are as near.
pub(super) fn ieee_remainder(x: f64, y: f64) -> f64 {
    libm::remainder(x, y)
}

fn answer(order: Ordering) -> Answer {
    Ok(Value::Int(match order {
        Ordering::Less => -1,
        Ordering::Equal => 0,
        Ordering::Greater => 1,
    }))
}

/// `Integer.compare`, `Long.compare`
pub(super) fn compare_whole(_: &mut Context<'_>, args: &[Value]) -> Answer {
    answer(args.long(0).cmp(&args.long(1)))
}

/// `Float.compare`, `Double.compare`
pub(super) fn compare_floating(_: &mut Context<'_>, args: &[Value]) -> Answer {
    answer(java_order(args.double(0), args.double(1)))
}

pub(super) fn is_finite(_: &mut Context<'_>, args: &[Value]) -> Answer {
    Ok(Value::Boolean(args.double(0).is_finite()))
}

pub(super) fn float_bits(_: &mut Context<'_>, args: &[Value]) -> Answer {
    let x = args.float(0);
    let bits = if x.is_nan() { 0x7fc0_0000 } else { x.to_bits() };
    Ok(Value::Int(bits as i32))
}

pub(super) fn float_of_bits(_: &mut Context<'_>, args: &[Value]) -> Answer {
    Ok(Value::Float(f32::from_bits(args.int(0) as u32)))
}

pub(super) fn double_bits(_: &mut Context<'_>, args: &[Value]) -> Answer {
    let x = args.double(0);
    let bits = if x.is_nan() {
        0x7ff8_0000_0000_0000
    } else {
        x.to_bits()
    };
    Ok(Value::Long(bits as i64))
}

pub(super) fn double_of_bits(_: &mut Context<'_>, args: &[Value]) -> Answer {
    Ok(Value::Double(f64::from_bits(args.long(0) as u64)))
}

/// A base between 2 and 36; Java takes 10 for others when it writes.
fn base(cx: &Context<'_>, base: i32) -> Result<u32, Trap> {
    u32::try_from(base)
        .ok()
        .filter(|base| (2..=36).contains(base))
        .ok_or_else(|| {
            let message = format!("radix {base} is not between 2 and 36");
            cx.exception(ClassId::NumberFormatException, message)
        })
}

/// `Integer.parseInt(text, base)`
pub(super) fn parse_int(cx: &mut Context<'_>, args: &[Value]) -> Answer {
    let base = base(cx, args.int(1))?;
    i32::from_str_radix(args.text(0), base)
        .map(Value::Int)
        .map_err(|_| {
            let message = format!("For input string: \"{}\"", args.text(0));
            cx.exception(ClassId::NumberFormatException, message)
        })
}

/// `Integer.toString(n, base)`
pub(super) fn to_text(cx: &mut Context<'_>, args: &[Value]) -> Answer {
    let base = base(cx, args.int(1)).unwrap_or(10);
    let mut rest = args.int(0).unsigned_abs();
    let mut digits: Vec<char> = vec![];
    while rest > 0 || digits.is_empty() {
        digits.extend(char::from_digit(rest % base, base));
        rest /= base;
    }
    if args.int(0) < 0 {
        digits.push('-');
    }
    cx.new_text(digits.into_iter().rev().collect::<String>())
}

pub(super) fn to_octal(cx: &mut Context<'_>, args: &[Value]) -> Answer {
    cx.new_text(format!("{:o}", args.int(0)))
}

pub(super) fn long_to_hex(cx: &mut Context<'_>, args: &[Value]) -> Answer {
    cx.new_text(format!("{:x}", args.long(0)))
}

pub(super) fn long_to_binary(cx: &mut Context<'_>, args: &[Value]) -> Answer {
    cx.new_text(format!("{:b}", args.long(0)))
}

fn character(args: &[Value]) -> char {
    char_of(args.int(0) as u16)
}

pub(super) fn is_upper_case(_: &mut Context<'_>, args: &[Value]) -> Answer {
    Ok(Value::Boolean(character(args).is_uppercase()))
}

pub(super) fn is_lower_case(_: &mut Context<'_>, args: &[Value]) -> Answer {
    Ok(Value::Boolean(character(args).is_lowercase()))
}

pub(super) fn is_letter_or_digit(_: &mut Context<'_>, args: &[Value]) -> Answer {
    Ok(Value::Boolean(character(args).is_alphanumeric()))
}

/// The only character of `mapped`, else the one that was given.
fn single(mut mapped: impl Iterator<Item = char>, args: &[Value]) -> Answer {
    let unit = match (mapped.next(), mapped.next()) {
        (Some(c), None) => u16::try_from(u32::from(c)).ok(),
        _ => None,
    };
    Ok(Value::Char(unit.unwrap_or(args.int(0) as u16)))
}

pub(super) fn to_upper_case(_: &mut Context<'_>, args: &[Value]) -> Answer {
    single(character(args).to_uppercase(), args)
}

pub(super) fn to_lower_case(_: &mut Context<'_>, args: &[Value]) -> Answer {
    single(character(args).to_lowercase(), args)
}

/// `Character.getNumericValue(c)`: letters count on from 10.
pub(super) fn numeric_value(_: &mut Context<'_>, args: &[Value]) -> Answer {
    let digit = character(args).to_digit(36);
    Ok(Value::Int(
        digit.and_then(|d| i32::try_from(d).ok()).unwrap_or(-1),
    ))
}
