//! `String.format`.

use super::{Arguments, Context};
use crate::eval::decimal::java_double_to_string;
use crate::eval::text::char_of;
use crate::eval::trap::Trap;
use crate::eval::value::Value;
use crate::library::ClassId;

/// Greatest width and precision of a field.
const MAX_WIDTH: usize = 10_000;

/// `String.format(pattern, values)`, with a locale in front or not.
pub(super) fn format(cx: &mut Context<'_>, args: &[Value]) -> Result<Value, Trap> {
    let text = formatted(cx, args)?;
    cx.new_text(text)
}

/// `System.out.printf(pattern, values)`
pub(super) fn print(cx: &mut Context<'_>, args: &[Value]) -> Result<Value, Trap> {
    let text = formatted(cx, args)?;
    cx.machine.print(&text);
    Ok(Value::Null)
}

/// The text of values (an array behind the pattern) after a pattern such as `%.2f`: conversions `d s S f e E g x X o c b n %`,
/// flags `- 0 + , (` and blank, `%2$s` for the second value.
pub(super) fn formatted(cx: &mut Context<'_>, args: &[Value]) -> Result<String, Trap> {
    // The locale, if there is one, stands before the pattern.
    let args = if args.len() > 2 { &args[1..] } else { args };
    let Value::Text(pattern) = args.at(0) else {
        return Err(Trap::null("use a pattern", cx.span));
    };
    let pattern = pattern.as_str();
    let values = match args.at(1) {
        Value::Array(array) => super::arrays::all(array),
        Value::Null => vec![Value::Null],
        other => vec![other.clone()],
    };
    let (mut out, mut next, mut rest) = (String::new(), 0, pattern);
    while let Some(at) = rest.find('%') {
        out.push_str(&rest[..at]);
        let Some((field, behind)) = Field::parse(&rest[at + 1..]) else {
            return Err(bad_pattern(cx, pattern));
        };
        rest = behind;
        match field.conversion {
            'n' => out.push('\n'),
            '%' => out.push_str(&field.padded("%".into())),
            _ => {
                let index = field.index.unwrap_or(next);
                next += usize::from(field.index.is_none());
                let value = values.get(index).ok_or_else(|| missing(cx, pattern))?;
                let Some(text) = field.text_of(cx, value)? else {
                    return Err(unfit(cx, &field, value));
                };
                out.push_str(&field.padded(text));
            }
        }
        cx.machine
            .check_text(out.len())
            .map_err(|trap| trap.at(cx.span))?;
    }
    out.push_str(rest);
    Ok(out)
}

fn bad_pattern(cx: &Context<'_>, pattern: &str) -> Trap {
    cx.exception(
        ClassId::IllegalArgumentException,
        format!("the format \"{pattern}\" has a `%` that means nothing"),
    )
}

fn missing(cx: &Context<'_>, pattern: &str) -> Trap {
    cx.exception(
        ClassId::IllegalArgumentException,
        format!("the format \"{pattern}\" needs more values than it was given"),
    )
}

fn unfit(cx: &Context<'_>, field: &Field<'_>, value: &Value) -> Trap {
    let class = value.class().map_or("this value", ClassId::name);
    cx.exception(
        ClassId::IllegalArgumentException,
        format!(
            "`%{}` does not fit a value of type {class}: whole numbers need `%d`, others `%f`",
            field.conversion
        ),
    )
}

/// One `%…` of a pattern.
struct Field<'p> {
    /// The value it is for, counted from 0; the next one if none is said.
    index: Option<usize>,
    flags: &'p str,
    width: usize,
    precision: Option<usize>,
    conversion: char,
}

impl<'p> Field<'p> {
    /// The field at the start of `text` (behind its `%`) and what follows it.
    fn parse(text: &'p str) -> Option<(Self, &'p str)> {
        let digits = |text: &'p str| {
            text.len() - text.trim_start_matches(|c: char| c.is_ascii_digit()).len()
        };
        let n_index = digits(text);
        let (index, text) = match text[n_index..].strip_prefix('$') {
            Some(rest) if n_index > 0 => {
                let index: usize = text[..n_index].parse().ok()?;
                (Some(index.checked_sub(1)?), rest)
            }
            _ => (None, text),
        };
        let after_flags = text.trim_start_matches(['-', '0', '+', ',', ' ', '#', '(']);
        let flags = &text[..text.len() - after_flags.len()];
        let n_width = digits(after_flags);
        let (width, after_width) = after_flags.split_at(n_width);
        let limited = |n: &str| n.parse().ok().filter(|&n| n <= MAX_WIDTH);
        let width = if width.is_empty() { 0 } else { limited(width)? };
        let (precision, rest) = match after_width.strip_prefix('.') {
            None => (None, after_width),
            Some(behind) => {
                let (precision, rest) = behind.split_at(digits(behind));
                (Some(limited(precision)?), rest)
            }
        };
        let conversion = rest.chars().next()?;
        let field = Self {
            index,
            flags,
            width,
            precision,
            conversion,
        };
        Some((field, &rest[conversion.len_utf8()..]))
    }

    /// The text of a value; `None` if the conversion is not for such values.
    fn text_of(&self, cx: &mut Context<'_>, value: &Value) -> Result<Option<String>, Trap> {
        let upper = |text: String| {
            if self.conversion.is_uppercase() {
                text.to_uppercase()
            } else {
                text
            }
        };
        let is_whole = !is_floating(value) && value.as_int().is_some();
        Ok(match self.conversion {
            _ if value.is_null() && self.conversion != 'b' => Some("null".to_owned()),
            'd' if is_whole && !matches!(value, Value::Char(_)) => {
                value.as_long().map(|n| self.signed(n.to_string()))
            }
            'f' | 'e' | 'E' | 'g' | 'G' if is_floating(value) => {
                value.as_double().map(|x| upper(self.floating(x)))
            }
            'x' | 'X' | 'o' if is_whole => Some(upper(self.bits(value))),
            'c' | 'C' => match value {
                Value::Char(unit) => Some(upper(char_of(*unit).to_string())),
                Value::Int(n) => Some(upper(char_of(*n as u16).to_string())),
                _ => None,
            },
            'b' | 'B' => {
                let is_true = !value.is_null() && value.as_boolean() != Some(false);
                Some(upper(self.cut(is_true.to_string())))
            }
            's' | 'S' => {
                let mut text = String::new();
                cx.tell(value, &mut text)?;
                Some(upper(self.cut(text)))
            }
            _ => None,
        })
    }

    fn cut(&self, text: String) -> String {
        match self.precision {
            Some(n) => text.chars().take(n).collect(),
            None => text,
        }
    }

    fn bits(&self, value: &Value) -> String {
        let is_octal = self.conversion == 'o';
        match (value, value.as_int().unwrap_or(0)) {
            (Value::Long(n), _) if is_octal => format!("{n:o}"),
            (Value::Long(n), _) => format!("{n:x}"),
            (Value::Byte(n), _) if is_octal => format!("{n:o}"),
            (Value::Byte(n), _) => format!("{n:x}"),
            (Value::Short(n), _) if is_octal => format!("{n:o}"),
            (Value::Short(n), _) => format!("{n:x}"),
            (_, n) if is_octal => format!("{n:o}"),
            (_, n) => format!("{n:x}"),
        }
    }

    /// A number with a fraction. Java rounds the digits that it would print, halves upwards: 1.005 to two places is 1.01.
    fn floating(&self, x: f64) -> String {
        if x.is_nan() {
            return "NaN".into();
        }
        let sign = if x.is_sign_negative() { "-" } else { "" };
        if x.is_infinite() {
            return self.signed(format!("{sign}Infinity"));
        }
        let precision = self.precision.unwrap_or(6);
        let digits = Digits::of(x.abs());
        let text = match self.conversion {
            'f' => digits.plain(precision),
            'e' | 'E' => digits.scientific(precision),
            _ => {
                let n = precision.max(1);
                let rounded = Digits::of(x.abs()).rounded(n);
                let point = rounded.point;
                if x == 0.0 || point > -4 && usize::try_from(point).unwrap_or(0) <= n {
                    let whole = if x == 0.0 { 1 } else { point };
                    let n_behind = i64::try_from(n).unwrap_or(0) - i64::from(whole);
                    digits.plain(usize::try_from(n_behind).unwrap_or(0))
                } else {
                    digits.scientific(n - 1)
                }
            }
        };
        self.signed(format!("{sign}{text}"))
    }

    fn signed(&self, text: String) -> String {
        let text = if self.flags.contains(',') {
            grouped(&text)
        } else {
            text
        };
        if let (true, Some(positive)) = (self.flags.contains('('), text.strip_prefix('-')) {
            return format!("({positive})");
        }
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
        let is_number = text.contains(|c: char| c.is_ascii_hexdigit());
        let takes_zeros = !matches!(self.conversion, 's' | 'S' | 'c' | 'C' | 'b' | 'B' | '%');
        let is_special = text.ends_with("Infinity") || text == "NaN" || text == "null";
        if self.flags.contains('0') && takes_zeros && is_number && !is_special {
            let n_signs = text.len() - text.trim_start_matches(['-', '+', ' ', '(']).len();
            let (sign, digits) = text.split_at(n_signs);
            return format!("{sign}{}{digits}", "0".repeat(missing));
        }
        " ".repeat(missing) + &text
    }
}

fn is_floating(value: &Value) -> bool {
    matches!(value, Value::Float(_) | Value::Double(_))
}

/// The digits of a number that is not negative, as Java prints them: `0.d1d2d3… · 10^point`.
struct Digits {
    digits: Vec<u8>,
    point: i32,
}

impl Digits {
    fn of(x: f64) -> Self {
        let text = java_double_to_string(x);
        let (mantissa, exponent) = text.split_once('E').unwrap_or((&text, "0"));
        let (whole, fraction) = mantissa.split_once('.').unwrap_or((mantissa, ""));
        let all: Vec<u8> = [whole, fraction]
            .concat()
            .bytes()
            .map(|b| b - b'0')
            .collect();
        let n_zeros = all.iter().take_while(|&&d| d == 0).count();
        let point = whole.len() as i32 + exponent.parse::<i32>().unwrap_or(0) - n_zeros as i32;
        let mut digits = all[n_zeros..].to_vec();
        while digits.last() == Some(&0) {
            digits.pop();
        }
        let point = if digits.is_empty() { 0 } else { point };
        Self { digits, point }
    }

    /// With at most `n` digits, the last one rounded, halves upwards.
    fn rounded(&self, n: usize) -> Self {
        let mut digits = self.digits.clone();
        let mut point = self.point;
        if n < digits.len() {
            let is_up = digits[n] >= 5;
            digits.truncate(n);
            if is_up {
                let n_nines = digits.iter().rev().take_while(|&&d| d == 9).count();
                digits.truncate(n - n_nines);
                match digits.last_mut() {
                    Some(last) => *last += 1,
                    None => {
                        digits.push(1);
                        point += 1;
                    }
                }
            }
        }
        Self { digits, point }
    }

    /// The digit `index` places behind the point (before it for negative ones).
    fn at(&self, index: i32) -> char {
        let place = usize::try_from(index + self.point).ok();
        let digit = place.and_then(|i| self.digits.get(i)).copied();
        char::from(b'0' + digit.unwrap_or(0))
    }

    /// `123.46`
    fn plain(&self, precision: usize) -> String {
        let n = i64::from(self.point) + precision as i64;
        let rounded = match usize::try_from(n) {
            Ok(n) => self.rounded(n),
            Err(_) => Self {
                digits: vec![],
                point: 0,
            },
        };
        let n_whole = rounded.point.max(1);
        let mut text: String = (-n_whole..0).map(|i| rounded.at(i)).collect();
        if precision > 0 {
            text.push('.');
            text.extend((0..precision as i32).map(|i| rounded.at(i)));
        }
        text
    }

    /// `1.2346e+02`: at least two digits of exponent.
    fn scientific(&self, precision: usize) -> String {
        let rounded = self.rounded(precision + 1);
        let exponent = if rounded.digits.is_empty() {
            0
        } else {
            rounded.point - 1
        };
        let digit = |i: usize| char::from(b'0' + rounded.digits.get(i).copied().unwrap_or(0));
        let mut text = digit(0).to_string();
        if precision > 0 {
            text.push('.');
            text.extend((1..=precision).map(digit));
        }
        let sign = if exponent < 0 { '-' } else { '+' };
        format!("{text}e{sign}{:02}", exponent.abs())
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
    fn numbers_are_laid_out_as_java_does() {
        let e = |x, n| Digits::of(x).scientific(n);
        let f = |x, n| Digits::of(x).plain(n);
        assert_eq!(e(12345.678, 2), "1.23e+04");
        assert_eq!(e(0.001, 1), "1.0e-03");
        assert_eq!(e(0.0, 2), "0.00e+00");
        assert_eq!(f(1.005, 2), "1.01");
        assert_eq!(f(0.125, 2), "0.13");
        assert_eq!(f(0.004, 2), "0.00");
        assert_eq!(f(0.005, 2), "0.01");
        assert_eq!(f(0.0004, 2), "0.00");
        assert_eq!(f(9.996, 2), "10.00");
        assert_eq!(f(999.5, 0), "1000");
        assert_eq!(f(0.0, 1), "0.0");
        assert_eq!(f(1e20, 1), "100000000000000000000.0");
        assert_eq!(grouped("-1234567.5"), "-1,234,567.5");
        let (field, _) = Field::parse("06d").unwrap();
        assert_eq!(field.padded("-42".into()), "-00042");
        assert_eq!(Field::parse("3$s").unwrap().0.index, Some(2));
    }
}
