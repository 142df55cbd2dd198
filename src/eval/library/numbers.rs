//! Functions of `Math` and of the boxed numbers, with Java's own corner cases.

use super::{Arguments, Context};
use crate::eval::trap::Trap;
use crate::eval::value::Value;
use crate::library::ClassId;

/// Nearest `int`, halves upwards; NaN is 0.
pub(super) fn round_float(x: f32) -> i32 {
    (f64::from(x) + 0.5).floor() as i32
}

/// Nearest `long`, halves upwards; NaN is 0.
pub(super) fn round_double(x: f64) -> i64 {
    // Adding 0.5 would itself round up the number just below 0.5 and odd numbers beyond 2^52.
    let floor = x.floor();
    if x - floor >= 0.5 {
        floor as i64 + 1
    } else {
        floor as i64
    }
}

/// The lesser; NaN if one is, -0 before 0.
pub(super) fn min_double(a: f64, b: f64) -> f64 {
    if a.is_nan() || b.is_nan() {
        f64::NAN
    } else if a < b || (a == b && a.is_sign_negative()) {
        a
    } else {
        b
    }
}

/// The greater; NaN if one is, 0 before -0.
pub(super) fn max_double(a: f64, b: f64) -> f64 {
    if a.is_nan() || b.is_nan() {
        f64::NAN
    } else if a > b || (a == b && a.is_sign_positive()) {
        a
    } else {
        b
    }
}

/// The lesser; NaN if one is, -0 before 0.
pub(super) fn min_float(a: f32, b: f32) -> f32 {
    min_double(f64::from(a), f64::from(b)) as f32
}

/// The greater; NaN if one is, 0 before -0.
pub(super) fn max_float(a: f32, b: f32) -> f32 {
    max_double(f64::from(a), f64::from(b)) as f32
}

/// Degrees as radians.
pub(super) fn to_radians(degrees: f64) -> f64 {
    degrees * (std::f64::consts::PI / 180.0)
}

/// Radians as degrees.
pub(super) fn to_degrees(radians: f64) -> f64 {
    radians * (180.0 / std::f64::consts::PI)
}

/// Sign; zeros and NaN are their own.
pub(super) fn signum_double(x: f64) -> f64 {
    if x == 0.0 || x.is_nan() {
        x
    } else {
        x.signum()
    }
}

/// Sign; zeros and NaN are their own.
pub(super) fn signum_float(x: f32) -> f32 {
    if x == 0.0 || x.is_nan() {
        x
    } else {
        x.signum()
    }
}

pub(super) fn floor_div(cx: &mut Context<'_>, args: &[Value]) -> Result<Value, Trap> {
    let (a, b) = (args.int(0), args.int(1));
    if b == 0 {
        return Err(cx.exception(ClassId::ArithmeticException, "/ by zero"));
    }
    let quotient = a.wrapping_div(b);
    let is_below = a.wrapping_rem(b) != 0 && (a < 0) != (b < 0);
    Ok(Value::Int(quotient - i32::from(is_below)))
}

pub(super) fn floor_mod(cx: &mut Context<'_>, args: &[Value]) -> Result<Value, Trap> {
    let (a, b) = (args.int(0), args.int(1));
    if b == 0 {
        return Err(cx.exception(ClassId::ArithmeticException, "/ by zero"));
    }
    let rest = a.wrapping_rem(b);
    Ok(Value::Int(if rest != 0 && (rest < 0) != (b < 0) {
        rest + b
    } else {
        rest
    }))
}

fn no_number(cx: &Context<'_>, text: &str) -> Trap {
    cx.exception(
        ClassId::NumberFormatException,
        format!("For input string: \"{text}\""),
    )
}

pub(super) fn parse_int(cx: &mut Context<'_>, args: &[Value]) -> Result<Value, Trap> {
    args.text(0)
        .parse()
        .map(Value::Int)
        .map_err(|_| no_number(cx, args.text(0)))
}

pub(super) fn parse_long(cx: &mut Context<'_>, args: &[Value]) -> Result<Value, Trap> {
    args.text(0)
        .parse()
        .map(Value::Long)
        .map_err(|_| no_number(cx, args.text(0)))
}

pub(super) fn parse_float(cx: &mut Context<'_>, args: &[Value]) -> Result<Value, Trap> {
    floating(args.text(0))
        .and_then(|t| t.parse().ok())
        .map(Value::Float)
        .ok_or_else(|| no_number(cx, args.text(0)))
}

pub(super) fn parse_double(cx: &mut Context<'_>, args: &[Value]) -> Result<Value, Trap> {
    floating(args.text(0))
        .and_then(|t| t.parse().ok())
        .map(Value::Double)
        .ok_or_else(|| no_number(cx, args.text(0)))
}

/// The digits of a floating-point number as Java accepts it: white space around it, `f` or `d` behind it.
fn floating(text: &str) -> Option<&str> {
    let text = text.trim();
    let is_word = matches!(text.trim_start_matches(['+', '-']), "NaN" | "Infinity");
    let digits = text.strip_suffix(['f', 'F', 'd', 'D']).unwrap_or(text);
    let is_number = digits
        .bytes()
        .all(|b| b.is_ascii_digit() || b"+-.eE".contains(&b));
    match (is_word, is_number) {
        (true, _) => Some(text),
        (_, true) => Some(digits),
        _ => None,
    }
}

pub(super) fn parse_boolean(_: &mut Context<'_>, args: &[Value]) -> Result<Value, Trap> {
    Ok(Value::Boolean(args.text(0).eq_ignore_ascii_case("true")))
}

/// Boxing: the value is boxed already.
pub(super) fn same(_: &mut Context<'_>, args: &[Value]) -> Result<Value, Trap> {
    Ok(args.at(0).clone())
}

pub(super) fn to_hex(cx: &mut Context<'_>, args: &[Value]) -> Result<Value, Trap> {
    cx.new_text(format!("{:x}", args.int(0)))
}

pub(super) fn to_binary(cx: &mut Context<'_>, args: &[Value]) -> Result<Value, Trap> {
    cx.new_text(format!("{:b}", args.int(0)))
}

pub(super) fn is_nan(_: &mut Context<'_>, args: &[Value]) -> Result<Value, Trap> {
    Ok(Value::Boolean(args.double(0).is_nan()))
}

pub(super) fn is_infinite(_: &mut Context<'_>, args: &[Value]) -> Result<Value, Trap> {
    Ok(Value::Boolean(args.double(0).is_infinite()))
}

pub(super) fn int_value(_: &mut Context<'_>, args: &[Value]) -> Result<Value, Trap> {
    Ok(Value::Int(args.int(0)))
}

pub(super) fn long_value(_: &mut Context<'_>, args: &[Value]) -> Result<Value, Trap> {
    Ok(Value::Long(args.long(0)))
}

pub(super) fn float_value(_: &mut Context<'_>, args: &[Value]) -> Result<Value, Trap> {
    Ok(Value::Float(args.float(0)))
}

pub(super) fn double_value(_: &mut Context<'_>, args: &[Value]) -> Result<Value, Trap> {
    Ok(Value::Double(args.double(0)))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn rounding_is_javas() {
        let rounded = [
            2.5,
            -2.5,
            0.499_999_999_999_999_94,
            4_503_599_627_370_497.0,
            1e300,
            f64::NAN,
        ]
        .map(round_double);
        assert_eq!(rounded, [3, -2, 0, 4_503_599_627_370_497, i64::MAX, 0]);
        assert_eq!([2.4, -0.5, 8_388_609.0].map(round_float), [2, 0, 8_388_609]);
    }

    #[test]
    fn extremes_respect_signs_of_zero_and_nan() {
        assert!(
            min_double(0.0, -0.0).is_sign_negative() && max_double(-0.0, 0.0).is_sign_positive()
        );
        assert!(min_double(f64::NAN, 1.0).is_nan() && max_float(1.0, f32::NAN).is_nan());
    }

    #[test]
    fn floating_text_is_javas() {
        assert_eq!(floating(" 2.5f "), Some("2.5"));
        assert_eq!(floating("-Infinity"), Some("-Infinity"));
        assert_eq!(
            (floating("inf"), floating("nan"), floating("0x1")),
            (None, None, None)
        );
    }
}
