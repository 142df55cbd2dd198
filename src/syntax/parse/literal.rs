//! Values of literals, and what is wrong with them.

use crate::diag::{Diagnostic, Span};
use crate::syntax::ast::Literal;

type Value = Result<Literal, Box<Diagnostic>>;

/// The message for a whole number that its type cannot hold.
pub(super) fn out_of_range(span: Span, ty: &str) -> Diagnostic {
    let diagnostic = Diagnostic::error(
        "number-out-of-range",
        span,
        format!("this number does not fit into `{ty}`"),
    );
    if ty == "int" {
        diagnostic.hint("write an `L` behind it to make it a `long`, or `.0` to make it a `double`")
    } else {
        diagnostic.hint("write `.0` behind it to make it a `double`")
    }
}

/// `1`, `0xFF`, `017`, `0b11`, `5L`. As in Java, numbers of base 2, 8 and 16 fill the sign bit.
pub(super) fn int(text: &str, span: Span) -> Value {
    let clean = text.replace('_', "").to_ascii_lowercase();
    let (digits, is_long) = match clean.strip_suffix('l') {
        Some(digits) => (digits, true),
        None => (clean.as_str(), false),
    };
    let (digits, radix) = if let Some(hex) = digits.strip_prefix("0x") {
        (hex, 16)
    } else if let Some(binary) = digits.strip_prefix("0b") {
        (binary, 2)
    } else if digits.len() > 1 && digits.starts_with('0') {
        (&digits[1..], 8)
    } else {
        (digits, 10)
    };
    if radix == 8 && digits.contains(['8', '9']) {
        let diagnostic = Diagnostic::error(
            "bad-octal",
            span,
            "a number that begins with `0` counts in eights",
        );
        return Err(Box::new(diagnostic.hint("leave out the leading `0`")));
    }
    let fitting = u64::from_str_radix(digits, radix).ok();
    let limit = match (is_long, radix) {
        (true, 10) => i64::MAX as u64,
        (true, _) => u64::MAX,
        (false, 10) => i32::MAX as u64,
        (false, _) => u64::from(u32::MAX),
    };
    match fitting.filter(|&value| value <= limit) {
        Some(value) if is_long => Ok(Literal::Long(value as i64)),
        Some(value) => Ok(Literal::Int(value as u32 as i32)),
        None => Err(Box::new(out_of_range(
            span,
            if is_long { "long" } else { "int" },
        ))),
    }
}

/// `1.5`, `1e-3`, `3f`, `2d`.
pub(super) fn float(text: &str, span: Span) -> Value {
    let clean = text.replace('_', "").to_ascii_lowercase();
    let (digits, is_float) = match clean.strip_suffix('f') {
        Some(digits) => (digits, true),
        None => (clean.trim_end_matches('d'), false),
    };
    let read = if is_float {
        digits
            .parse::<f32>()
            .ok()
            .filter(|value| value.is_finite())
            .map(Literal::Float)
    } else {
        digits
            .parse::<f64>()
            .ok()
            .filter(|value| value.is_finite())
            .map(Literal::Double)
    };
    read.ok_or_else(|| {
        Box::new(out_of_range(
            span,
            if is_float { "float" } else { "double" },
        ))
    })
}

/// `"text"` with its quotes.
pub(super) fn string(text: &str, span: Span) -> Value {
    unescape(&text[1..text.len() - 1], span)
        .map(|units| Literal::String(String::from_utf16_lossy(&units)))
}

/// `'a'` with its quotes.
pub(super) fn character(text: &str, span: Span) -> Value {
    let units = unescape(&text[1..text.len() - 1], span)?;
    match units.as_slice() {
        [unit] => Ok(Literal::Char(*unit)),
        _ => {
            let diagnostic =
                Diagnostic::error("bad-char", span, "a `char` holds exactly one character");
            Err(Box::new(diagnostic.hint("write a text in double quotes")))
        }
    }
}

/// UTF-16 units of a text with its escapes resolved.
fn unescape(text: &str, span: Span) -> Result<Vec<u16>, Box<Diagnostic>> {
    let mut units = vec![];
    let mut chars = text.chars().peekable();
    while let Some(c) = chars.next() {
        if c != '\\' {
            units.extend_from_slice(c.encode_utf16(&mut [0; 2]));
            continue;
        }
        let escape = chars.next();
        let unit = match escape {
            Some('n') => Some(0x0A),
            Some('t') => Some(0x09),
            Some('r') => Some(0x0D),
            Some('b') => Some(0x08),
            Some('f') => Some(0x0C),
            Some('s') => Some(0x20),
            Some(c @ ('"' | '\'' | '\\')) => Some(c as u16),
            Some('u') => hex_unit(&mut chars),
            Some(c) if c.is_digit(8) => Some(octal_unit(c, &mut chars)),
            _ => None,
        };
        match unit {
            Some(unit) => units.push(unit),
            None => return Err(Box::new(bad_escape(escape, span))),
        }
    }
    Ok(units)
}

fn hex_unit(chars: &mut std::iter::Peekable<std::str::Chars<'_>>) -> Option<u16> {
    while chars.next_if_eq(&'u').is_some() {} // Java allows any number of them.
    let mut value = 0;
    for _ in 0..4 {
        value = value * 16 + u16::try_from(chars.next()?.to_digit(16)?).ok()?;
    }
    Some(value)
}

/// Up to three octal digits, at most `\377`.
fn octal_unit(first: char, chars: &mut std::iter::Peekable<std::str::Chars<'_>>) -> u16 {
    let digit = |c: char| c.to_digit(8).unwrap_or(0) as u16;
    let mut value = digit(first);
    let most = if first <= '3' { 2 } else { 1 };
    for _ in 0..most {
        let Some(next) = chars.next_if(|c| c.is_digit(8)) else {
            break;
        };
        value = value * 8 + digit(next);
    }
    value
}

fn bad_escape(escape: Option<char>, span: Span) -> Diagnostic {
    let shown = escape.map_or_else(String::new, String::from);
    Diagnostic::error("bad-escape", span, format!("`\\{shown}` is not an escape"))
        .hint("write `\\\\` for a backslash; `\\n`, `\\t`, `\\\"`, `\\'` and `\\u0041` are escapes")
}
