//! `String.format`.

use super::{Arguments, Context};
use crate::eval::trap::Trap;
use crate::eval::value::Value;
use crate::library::ClassId;

/// Greatest width and precision of a field.
const MAX_WIDTH: usize = 10_000;

/// The text of values after a pattern such as `%.2f`: conversions `d i s S f e g x X c b n %`, flags `- 0 + , ` and blank.
pub(super) fn format(cx: &mut Context<'_>, args: &[Value]) -> Result<Value, Trap> {
    let pattern = args.text(0);
    let mut out = String::new();
    let mut values = args.iter().skip(1);
    let mut rest = pattern;
    while let Some(at) = rest.find('%') {
        out.push_str(&rest[..at]);
        let Some((field, behind)) = Field::parse(&rest[at + 1..]) else {
            return Err(bad_pattern(cx, pattern));
        };
        rest = behind;
        match field.conversion {
            'n' => out.push('\n'),
            '%' => out.push('%'),
            _ => {
                let value = values.next().ok_or_else(|| bad_pattern(cx, pattern))?;
                let text = field
                    .text_of(cx, value)
                    .ok_or_else(|| bad_pattern(cx, pattern))?;
                out.push_str(&field.padded(text));
            }
        }
    }
    out.push_str(rest);
    cx.new_text(out)
}

fn bad_pattern(cx: &Context<'_>, pattern: &str) -> Trap {
    cx.exception(
        ClassId::IllegalArgumentException,
        format!("the format \"{pattern}\" does not fit its values"),
    )
}

/// One `%…` of a pattern.
struct Field<'p> {
    flags: &'p str,
    width: usize,
    precision: Option<usize>,
    conversion: char,
}

impl<'p> Field<'p> {
    /// The field at the start of `text` (behind its `%`) and what follows it.
    fn parse(text: &'p str) -> Option<(Self, &'p str)> {
        let after_flags = text.trim_start_matches(['-', '0', '+', ',', ' ', '#', '(']);
        let flags = &text[..text.len() - after_flags.len()];
        let after_width = after_flags.trim_start_matches(|c: char| c.is_ascii_digit());
        let width = &after_flags[..after_flags.len() - after_width.len()];
        let width = if width.is_empty() {
            0
        } else {
            width.parse().ok().filter(|&w| w <= MAX_WIDTH)?
        };
        let (precision, rest) = match after_width.strip_prefix('.') {
            None => (None, after_width),
            Some(digits) => {
                let rest = digits.trim_start_matches(|c: char| c.is_ascii_digit());
                let precision = digits[..digits.len() - rest.len()]
                    .parse()
                    .ok()
                    .filter(|&p| p <= MAX_WIDTH)?;
                (Some(precision), rest)
            }
        };
        let conversion = rest.chars().next()?;
        Some((
            Self {
                flags,
                width,
                precision,
                conversion,
            },
            &rest[conversion.len_utf8()..],
        ))
    }

    fn text_of(&self, cx: &Context<'_>, value: &Value) -> Option<String> {
        Some(match self.conversion {
            'd' | 'i' => self.signed(value.as_long().filter(|_| !is_floating(value))?.to_string()),
            'f' => self.signed(format!(
                "{:.*}",
                self.precision.unwrap_or(6),
                value.as_double().filter(|_| is_floating(value))?
            )),
            'e' | 'E' => scientific(value.as_double()?, self.precision.unwrap_or(6)),
            'g' => self.signed(format!(
                "{:.*}",
                self.precision.unwrap_or(6),
                value.as_double()?
            )),
            'x' => format!("{:x}", value.as_int()?),
            'X' => format!("{:X}", value.as_int()?),
            'c' | 'b' | 's' | 'S' => {
                let mut text = String::new();
                cx.machine.append_text(value, &mut text);
                let text = if self.conversion == 'S' {
                    text.to_uppercase()
                } else {
                    text
                };
                match self.precision {
                    Some(n) => text.chars().take(n).collect(),
                    None => text,
                }
            }
            _ => return None,
        })
    }

    fn signed(&self, text: String) -> String {
        let text = if self.flags.contains(',') {
            grouped(&text)
        } else {
            text
        };
        let plus = ["+", " "]
            .into_iter()
            .find(|flag| self.flags.contains(flag));
        match plus {
            Some(plus) if !text.starts_with('-') => format!("{plus}{text}"),
            _ => text,
        }
    }

    fn padded(&self, text: String) -> String {
        let missing = self.width.saturating_sub(text.chars().count());
        if self.flags.contains('-') {
            return text + &" ".repeat(missing);
        }
        if self.flags.contains('0') && !matches!(self.conversion, 's' | 'S' | 'c' | 'b') {
            let n_signs = text.len() - text.trim_start_matches(['-', '+', ' ']).len();
            let (sign, digits) = text.split_at(n_signs);
            return format!("{sign}{}{digits}", "0".repeat(missing));
        }
        " ".repeat(missing) + &text
    }
}

fn is_floating(value: &Value) -> bool {
    matches!(value, Value::Float(_) | Value::Double(_))
}

/// C's `%e`: at least two digits of exponent.
fn scientific(x: f64, precision: usize) -> String {
    let text = format!("{x:.precision$e}");
    match text.split_once('e') {
        Some((digits, exponent)) => {
            let n: i32 = exponent.parse().unwrap_or(0);
            format!("{digits}e{}{:02}", if n < 0 { '-' } else { '+' }, n.abs())
        }
        None => text,
    }
}

/// Commas between thousands.
fn grouped(text: &str) -> String {
    let (sign, digits) = text.split_at(text.len() - text.trim_start_matches('-').len());
    let (whole, fraction) = digits.split_at(digits.find('.').unwrap_or(digits.len()));
    let mut out = sign.to_owned();
    for (i, digit) in whole.chars().enumerate() {
        if i > 0 && (whole.len() - i) % 3 == 0 {
            out.push(',');
        }
        out.push(digit);
    }
    out + fraction
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn fields_are_read_whole() {
        let (field, rest) = Field::parse("-08.3f m").unwrap();
        assert_eq!(
            (field.flags, field.width, field.precision, field.conversion),
            ("-0", 8, Some(3), 'f')
        );
        assert_eq!(rest, " m");
        assert!(Field::parse("").is_none());
        assert!(Field::parse("99999999999d").is_none());
    }

    #[test]
    fn numbers_are_laid_out_as_c_does() {
        assert_eq!(scientific(12345.678, 2), "1.23e+04");
        assert_eq!(scientific(0.001, 1), "1.0e-03");
        assert_eq!(grouped("-1234567.5"), "-1,234,567.5");
        let (field, _) = Field::parse("06d").unwrap();
        assert_eq!(field.padded("-42".into()), "-00042");
    }
}
