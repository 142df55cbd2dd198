//! Moments and how they are written, numbers after a pattern, and what the model may use.

use super::{Arguments, Context, new_object};
use crate::eval::object::Data;
use crate::eval::trap::Trap;
use crate::eval::value::Value;
use crate::library::ClassId;

/// A moment as a date in the calendar of today, at Greenwich.
struct Calendar {
    year: i64,
    month: usize,
    day: i64,
    weekday: usize,
    /// Milliseconds of the day.
    time: i64,
}

const MONTHS: [&str; 12] = [
    "Jan", "Feb", "Mar", "Apr", "May", "Jun", "Jul", "Aug", "Sep", "Oct", "Nov", "Dec",
];
const WEEKDAYS: [&str; 7] = ["Thu", "Fri", "Sat", "Sun", "Mon", "Tue", "Wed"];
const DAY: i64 = 86_400_000;

impl Calendar {
    /// The date of a moment in milliseconds since 1970.
    fn of(millis: i64) -> Self {
        let days = millis.div_euclid(DAY);
        // Days since the first of March of year 0; leap days then stand at the end of a year of 400.
        let shifted = days + 719_468;
        let era = shifted.div_euclid(146_097);
        let of_era = shifted.rem_euclid(146_097);
        let year = (of_era - of_era / 1460 + of_era / 36_524 - of_era / 146_096) / 365;
        let of_year = of_era - (365 * year + year / 4 - year / 100);
        let month = (5 * of_year + 2) / 153;
        let day = of_year - (153 * month + 2) / 5 + 1;
        let index = if month < 10 { month + 2 } else { month - 10 };
        Self {
            year: year + era * 400 + i64::from(index < 2),
            month: usize::try_from(index).unwrap_or(0),
            day,
            weekday: usize::try_from(days.rem_euclid(7)).unwrap_or(0),
            time: millis.rem_euclid(DAY),
        }
    }

    fn hour(&self) -> i64 {
        self.time / 3_600_000
    }

    fn minute(&self) -> i64 {
        self.time / 60_000 % 60
    }

    fn second(&self) -> i64 {
        self.time / 1000 % 60
    }
}

/// The text of a `Date`, `Thu Jan 01 00:00:00 UTC 1970`.
pub fn text_of(millis: i64) -> String {
    let c = Calendar::of(millis);
    format!(
        "{} {} {:02} {:02}:{:02}:{:02} UTC {}",
        WEEKDAYS[c.weekday],
        MONTHS[c.month],
        c.day,
        c.hour(),
        c.minute(),
        c.second(),
        c.year
    )
}

/// `new Date()`: growth knows no clock, the moment is the number of the step; `new Date(millis)`.
pub(super) fn make_date(
    cx: &mut Context<'_>,
    class: ClassId,
    args: &[Value],
) -> Result<Value, Trap> {
    let now = i64::try_from(cx.machine.step).unwrap_or(i64::MAX);
    let millis = args.at(0).as_long().unwrap_or(now);
    // Java's own dates reach as far; beyond the sums here would overflow.
    let millis = millis.clamp(-8_640_000_000_000_000, 8_640_000_000_000_000);
    Ok(new_object(class, Data::Moment(millis)))
}

fn millis(cx: &Context<'_>, args: &[Value], index: usize) -> Result<i64, Trap> {
    Ok(match &*cx.object(args, index)?.lock() {
        Data::Moment(millis) => *millis,
        _ => 0,
    })
}

pub(super) fn time(cx: &mut Context<'_>, args: &[Value]) -> Result<Value, Trap> {
    Ok(Value::Long(millis(cx, args, 0)?))
}

/// `new SimpleDateFormat(pattern)`, `new DecimalFormat(pattern)`
pub(super) fn make_pattern(
    cx: &mut Context<'_>,
    class: ClassId,
    args: &[Value],
) -> Result<Value, Trap> {
    if args.at(0).is_null() {
        return Err(Trap::null("use a pattern", cx.span));
    }
    Ok(new_object(class, Data::Pattern(args.text(0).into())))
}

fn pattern(cx: &Context<'_>, args: &[Value]) -> Result<String, Trap> {
    Ok(match &*cx.object(args, 0)?.lock() {
        Data::Pattern(pattern) => pattern.to_string(),
        _ => String::new(),
    })
}

/// `format.format(date)`
pub(super) fn format_date(cx: &mut Context<'_>, args: &[Value]) -> Result<Value, Trap> {
    let (pattern, date) = (pattern(cx, args)?, Calendar::of(millis(cx, args, 1)?));
    let mut out = String::new();
    let mut rest = pattern.chars().peekable();
    while let Some(letter) = rest.next() {
        if letter == '\'' {
            out.extend(rest.by_ref().take_while(|&c| c != '\''));
            continue;
        }
        if !letter.is_ascii_alphabetic() {
            out.push(letter);
            continue;
        }
        let mut n = 1;
        while rest.next_if_eq(&letter).is_some() {
            n += 1;
        }
        let number = match letter {
            'y' if n == 2 => date.year.rem_euclid(100),
            'y' => date.year,
            'M' if n >= 3 => {
                out.push_str(MONTHS[date.month]);
                continue;
            }
            'M' => i64::try_from(date.month).unwrap_or(0) + 1,
            'd' => date.day,
            'H' => date.hour(),
            'm' => date.minute(),
            's' => date.second(),
            'S' => date.time % 1000,
            'E' => {
                out.push_str(WEEKDAYS[date.weekday]);
                continue;
            }
            _ => {
                let message = format!("the letter `{letter}` of a date pattern is not supported");
                return Err(cx.exception(ClassId::IllegalArgumentException, message));
            }
        };
        out.push_str(&format!("{number:0n$}"));
    }
    cx.new_text(out)
}

/// A pattern of `DecimalFormat`, taken apart.
struct Decimal<'p> {
    before: &'p str,
    behind: &'p str,
    /// Least digits before the point, least and most digits behind it.
    digits: [usize; 3],
    /// Digits in a group; 0 for none.
    group: usize,
    is_percent: bool,
}

impl<'p> Decimal<'p> {
    /// The pattern; `None` if it has signs that are not known.
    fn of(pattern: &'p str) -> Option<Self> {
        let pattern = pattern.split(';').next()?;
        let is_digit = |c: char| matches!(c, '#' | '0' | ',' | '.');
        let start = pattern.find(is_digit)?;
        let end = pattern.rfind(is_digit)? + 1;
        let (number, behind) = (&pattern[start..end], &pattern[end..]);
        if !number.chars().all(is_digit) || behind.starts_with('E') || number.len() > 100 {
            return None;
        }
        let (whole, fraction) = number.split_once('.').unwrap_or((number, ""));
        let count = |text: &str, c: char| text.matches(c).count();
        Some(Self {
            before: &pattern[..start],
            behind,
            digits: [count(whole, '0'), count(fraction, '0'), fraction.len()],
            group: whole.rsplit_once(',').map_or(0, |(_, last)| last.len()),
            is_percent: behind.contains('%') || pattern[..start].contains('%'),
        })
    }

    /// A number after the pattern, halves to the even digit, as Java does.
    fn write(&self, x: f64) -> String {
        if x.is_nan() {
            return "NaN".into();
        }
        let sign = if x.is_sign_negative() { "-" } else { "" };
        let magnitude = if self.is_percent { x * 100.0 } else { x }.abs();
        if magnitude.is_infinite() {
            return format!("{sign}{}∞{}", self.before, self.behind);
        }
        let [least_whole, least, most] = self.digits;
        let text = format!("{magnitude:.most$}");
        let (whole, fraction) = text.split_once('.').unwrap_or((&text, ""));
        let mut fraction = fraction.to_owned();
        while fraction.len() > least && fraction.ends_with('0') {
            fraction.pop();
        }
        let whole = whole.trim_start_matches('0');
        let needs_zero = least_whole == 0 && whole.is_empty() && fraction.is_empty();
        let n_zeros = least_whole.saturating_sub(whole.len()) + usize::from(needs_zero);
        let whole = self.grouped(&("0".repeat(n_zeros) + whole));
        let point = if fraction.is_empty() { "" } else { "." };
        let [before, behind] = [self.before, self.behind];
        format!("{sign}{before}{whole}{point}{fraction}{behind}")
    }

    fn grouped(&self, digits: &str) -> String {
        let mut out = String::new();
        for (i, digit) in digits.chars().enumerate() {
            let n_left = digits.len() - i;
            if i > 0 && self.group > 0 && n_left.is_multiple_of(self.group) {
                out.push(',');
            }
            out.push(digit);
        }
        out
    }
}

/// `format.format(number)`
pub(super) fn format_number(cx: &mut Context<'_>, args: &[Value]) -> Result<Value, Trap> {
    let pattern = pattern(cx, args)?;
    match Decimal::of(&pattern) {
        Some(decimal) => cx.new_text(decimal.write(args.double(1))),
        None => {
            let message = format!(
                "the number pattern \"{pattern}\" is not supported; known are `0`, `#`, `,` and `.`"
            );
            Err(cx.exception(ClassId::IllegalArgumentException, message))
        }
    }
}

/// `Runtime.getRuntime()`
pub(super) fn runtime(_: &mut Context<'_>, _: &[Value]) -> Result<Value, Trap> {
    Ok(new_object(ClassId::Runtime, Data::Opaque))
}

/// The memory budget of the model.
pub(super) fn total_memory(cx: &mut Context<'_>, _: &[Value]) -> Result<Value, Trap> {
    let memory = cx.machine.limits().memory;
    Ok(Value::Long(i64::try_from(memory).unwrap_or(i64::MAX)))
}

/// What is left of it.
pub(super) fn free_memory(cx: &mut Context<'_>, _: &[Value]) -> Result<Value, Trap> {
    let left = cx
        .machine
        .limits()
        .memory
        .saturating_sub(cx.machine.meter.used());
    Ok(Value::Long(i64::try_from(left).unwrap_or(i64::MAX)))
}

pub(super) fn n_processors(_: &mut Context<'_>, _: &[Value]) -> Result<Value, Trap> {
    Ok(Value::Int(1))
}

/// `System.getProperty(name)`: what is the same on every machine, null for the rest.
pub(super) fn property(cx: &mut Context<'_>, args: &[Value]) -> Result<Value, Trap> {
    match args.text(0) {
        "line.separator" => cx.new_text("\n"),
        "file.separator" => cx.new_text("/"),
        "path.separator" => cx.new_text(":"),
        "user.dir" => cx.new_text("."),
        _ => Ok(Value::Null),
    }
}

pub(super) fn line_separator(cx: &mut Context<'_>, _: &[Value]) -> Result<Value, Trap> {
    cx.new_text("\n")
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn moments_are_written_as_java_writes_them() {
        assert_eq!(text_of(0), "Thu Jan 01 00:00:00 UTC 1970");
        assert_eq!(text_of(951_825_599_000), "Tue Feb 29 11:59:59 UTC 2000");
        assert_eq!(text_of(-1), "Wed Dec 31 23:59:59 UTC 1969");
    }

    #[test]
    fn numbers_follow_their_pattern() {
        let write = |pattern, x| Decimal::of(pattern).unwrap().write(x);
        assert_eq!(write("0.00", 2.345), "2.35");
        assert_eq!(write("0.00", 0.125), "0.12");
        assert_eq!(write("#.##", 0.5), ".5");
        assert_eq!(write("#.##", 3.0), "3");
        assert_eq!(write("#,##0.0#", -1_234_567.891), "-1,234,567.89");
        assert_eq!(write("#", 0.0), "0");
        assert_eq!(write("00.0 m", 4.14), "04.1 m");
        assert_eq!(write("0%", 0.256), "26%");
        assert!(Decimal::of("0.0E0").is_none());
    }
}
