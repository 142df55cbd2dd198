//! Decimal text of floating-point numbers, digit for digit as JDK 17 prints it (before JDK 19 made it the shortest text).
//!
//! Digits are developed exactly: the number is `b / s · 10^exponent` in big integers, half a unit in the last place is
//! `m / s`; digits are split off until the rest is within that half unit of zero or of the next digit. The shortcut for
//! whole numbers and the rule "at least two digits in E notation" are what makes old Java print a digit too many now and
//! then; both are kept.
//!
//! Source: [`SteeleWhite1990`](crate::references#steelewhite1990) (§3) for the method; the stopping rules are those of the platform that printed the goldens.

use std::cmp::Ordering;

/// The decimal logarithm of 2 as Java writes it, one digit short of the nearest `double`.
#[allow(
    clippy::approx_constant,
    reason = "Java's own digits decide which exponent is tried first"
)]
const JAVA_LOG10_2: f64 = 0.301_029_995_663_981;

/// Text of a `double` as Java's `Double.toString` gives it.
pub fn java_double_to_string(x: f64) -> String {
    let bits = x.to_bits();
    let fraction = bits & ((1 << 52) - 1);
    let biased = (bits >> 52) & 0x7ff;
    if biased == 0x7ff || x == 0.0 {
        return special(x);
    }
    let number = if biased == 0 {
        let zeros = fraction.leading_zeros();
        let shift = zeros - 11;
        Binary {
            fraction: fraction << shift,
            exponent: -1022 - as_int(shift),
            precision: 64 - as_int(zeros),
        }
    } else {
        Binary {
            fraction: fraction | (1 << 52),
            exponent: as_int(biased) - 1023,
            precision: 53,
        }
    };
    layout(x < 0.0, &number.digits())
}

/// Text of a `float` as Java's `Float.toString` gives it.
pub fn java_float_to_string(x: f32) -> String {
    let bits = x.to_bits();
    let fraction = u64::from(bits & ((1 << 23) - 1));
    let biased = (bits >> 23) & 0xff;
    if biased == 0xff || x == 0.0 {
        return special(f64::from(x));
    }
    let number = if biased == 0 {
        let zeros = fraction.leading_zeros();
        let shift = zeros - 40;
        Binary {
            fraction: fraction << (shift + 29),
            exponent: -126 - as_int(shift),
            precision: 64 - as_int(zeros),
        }
    } else {
        Binary {
            fraction: (fraction | (1 << 23)) << 29,
            exponent: as_int(biased) - 127,
            precision: 24,
        }
    };
    layout(x < 0.0, &number.digits())
}

fn special(x: f64) -> String {
    let text = match (x.is_nan(), x.is_infinite(), x.is_sign_negative()) {
        (true, _, _) => "NaN",
        (_, true, true) => "-Infinity",
        (_, true, false) => "Infinity",
        (_, _, true) => "-0.0",
        _ => "0.0",
    };
    text.to_owned()
}

fn as_int<T: TryInto<i32>>(n: T) -> i32 {
    n.try_into().unwrap_or(i32::MAX)
}

/// `fraction / 2^52 · 2^exponent` with bit 52 of `fraction` set; `precision` significant bits.
struct Binary {
    fraction: u64,
    exponent: i32,
    precision: i32,
}

/// `0.d₁d₂… · 10^exponent`.
struct Digits {
    digits: Vec<u8>,
    exponent: i32,
}

impl Binary {
    fn digits(&self) -> Digits {
        let significant = 53 - as_int(self.fraction.trailing_zeros());
        let tiny = (significant - self.exponent - 1).max(0);
        if tiny == 0 && self.exponent <= 62 {
            return self.whole_digits();
        }
        self.long_digits(significant, tiny)
    }

    /// Digits of a whole number below 2^63; those below its own precision are rounded away.
    fn whole_digits(&self) -> Digits {
        let shift = self.exponent - 52;
        let mut value = if shift >= 0 {
            self.fraction << shift
        } else {
            self.fraction >> -shift
        };
        let mut exponent = 0;
        let excess = self.exponent - self.precision - 1;
        if self.exponent > self.precision && excess > 1 {
            // Digits that lie wholly below 2^excess: floor(excess · log10 2), as tabulated by Java.
            let drop = (f64::from(excess) * std::f64::consts::LOG10_2).floor() as u32;
            let unit = 10_u64.pow(drop);
            let rest = value % unit;
            value = value / unit + u64::from(rest >= unit / 2 && drop > 0);
            exponent = as_int(drop);
        }
        let text = value.to_string();
        let digits = text.trim_end_matches('0').as_bytes();
        Digits {
            digits: digits.to_vec(),
            exponent: exponent + as_int(text.len()),
        }
    }

    fn long_digits(&self, significant: i32, tiny: i32) -> Digits {
        // Scale: value = b/s · 10^exponent, half a unit in the last place = m/s.
        let mut exponent = self.estimated_exponent();
        let (b5, s5) = ((-exponent).max(0), exponent.max(0));
        let mut b2 = b5 + tiny + self.exponent;
        let mut s2 = s5 + tiny;
        let mut m2 = b2 - self.precision;
        b2 -= significant - 1;
        let common = b2.min(s2);
        b2 -= common;
        s2 -= common;
        m2 -= common;
        // The lower neighbour of a power of two is only half as far away.
        if significant == 1 {
            m2 -= 1;
        }
        if m2 < 0 {
            b2 -= m2;
            s2 -= m2;
            m2 = 0;
        }
        let bits = (significant + b2 + bits_of_power(b5)).max(s2 + 1 + bits_of_power(s5 + 1));
        let width = Width::of(bits);
        let s = Big::from(1).times_power(5, s5).shifted(s2);
        let ten_s = s.times(10);
        let mut b = Big::from(self.fraction >> self.fraction.trailing_zeros())
            .times_power(5, b5)
            .shifted(b2);
        let mut m = Big::from(1).times_power(5, b5).shifted(m2);

        // Split off digits until the rest is within m of the last digit or of the one above.
        let mut digits = Vec::with_capacity(20);
        let (mut low, mut high);
        loop {
            let q = b.divide_small(&s);
            b = b.times(10);
            m = m.times(10);
            (low, high) = width.is_near(&b, &m, &ten_s);
            if digits.is_empty() && q == 0 && !high {
                exponent -= 1;
            } else {
                digits.push(q);
            }
            // E notation always shows two digits, so the first stop is ignored there.
            let is_first = digits.len() <= 1 && (digits.is_empty() || !matches!(exponent, -3..8));
            if (low || high) && !is_first {
                break;
            }
        }
        if high && (!low || round_up(width.half_digit(&b, &ten_s), &digits)) {
            increment(&mut digits, &mut exponent);
        }
        Digits {
            digits,
            exponent: exponent + 1,
        }
    }

    /// Java's estimate of the decimal exponent: exact or one too high.
    fn estimated_exponent(&self) -> i32 {
        let mantissa = f64::from_bits((1023 << 52) | (self.fraction & ((1 << 52) - 1)));
        let log = (mantissa - 1.5) * 0.289_529_654
            + 0.176_091_259
            + f64::from(self.exponent) * JAVA_LOG10_2;
        log.floor() as i32
    }
}

/// Whether the rest is above half a digit, or exactly half and the digit odd.
fn round_up(rest: Ordering, digits: &[u8]) -> bool {
    match rest {
        Ordering::Greater => true,
        Ordering::Equal => digits.last().is_some_and(|d| d % 2 == 1),
        Ordering::Less => false,
    }
}

/// In which type Java computes: `int` or `long`, whose overflow shows in the digits, or big integers.
#[derive(Clone, Copy)]
enum Width {
    Int,
    Long,
    Big,
}

impl Width {
    fn of(bits: i32) -> Self {
        match bits {
            ..32 => Self::Int,
            32..64 => Self::Long,
            _ => Self::Big,
        }
    }

    /// Whether the rest `b` is within `m` of the digit below, and of the digit above.
    fn is_near(self, b: &Big, m: &Big, ten_s: &Big) -> (bool, bool) {
        if matches!(self, Self::Big) {
            return (b < m, b.plus(m) >= *ten_s);
        }
        let (b, m, ten_s) = (
            self.wrap(b.low()),
            self.wrap(m.low()),
            self.wrap(ten_s.low()),
        );
        if m <= 0 {
            (true, true)
        } else {
            (b < m, self.wrap(b.wrapping_add(m)) > ten_s)
        }
    }

    /// How the rest `b` compares to half a digit.
    fn half_digit(self, b: &Big, ten_s: &Big) -> Ordering {
        if matches!(self, Self::Big) {
            return b.times(2).cmp(ten_s);
        }
        let difference = self.wrap(b.low()).wrapping_mul(2).wrapping_sub(ten_s.low());
        self.wrap(difference).cmp(&0)
    }

    fn wrap(self, n: i64) -> i64 {
        if matches!(self, Self::Int) {
            i64::from(n as i32)
        } else {
            n
        }
    }
}

fn increment(digits: &mut [u8], exponent: &mut i32) {
    for digit in digits.iter_mut().rev() {
        if *digit < 9 {
            *digit += 1;
            return;
        }
        *digit = 0;
    }
    if let Some(first) = digits.first_mut() {
        *first = 1;
        *exponent += 1;
    }
}

/// Bits of `5^n`, approximately beyond 26, as Java counts them.
fn bits_of_power(n: i32) -> i32 {
    if (0..27).contains(&n) && n > 0 {
        64 - as_int(5_u64.pow(n.unsigned_abs()).leading_zeros())
    } else {
        n * 3
    }
}

/// Plain notation for 1e-3 ≤ |x| < 1e7, else E notation; always a digit on both sides of the point.
fn layout(is_negative: bool, number: &Digits) -> String {
    let ascii = |d: &u8| char::from(if *d < 10 { b'0' + d } else { *d });
    let digits: String = number.digits.iter().map(ascii).collect();
    let sign = if is_negative { "-" } else { "" };
    let or_zero = |text: &str| {
        if text.is_empty() {
            "0".to_owned()
        } else {
            text.to_owned()
        }
    };
    match number.exponent {
        e @ 1..8 => {
            let point = as_usize(e);
            let (whole, rest) = digits.split_at(point.min(digits.len()));
            format!("{sign}{whole:0<point$}.{}", or_zero(rest))
        }
        e @ -2..=0 => format!("{sign}0.{}{digits}", "0".repeat(as_usize(-e))),
        e => format!("{sign}{}.{}E{}", &digits[..1], or_zero(&digits[1..]), e - 1),
    }
}

fn as_usize(n: i32) -> usize {
    usize::try_from(n).unwrap_or(0)
}

/// A natural number of any size: 32-bit limbs, least first, no leading zeros.
#[derive(Clone, PartialEq, Eq)]
struct Big(Vec<u32>);

impl From<u64> for Big {
    fn from(n: u64) -> Self {
        Self(vec![n as u32, (n >> 32) as u32]).trimmed()
    }
}

impl Big {
    fn trimmed(mut self) -> Self {
        while self.0.last() == Some(&0) {
            self.0.pop();
        }
        self
    }

    fn times(&self, factor: u32) -> Self {
        let mut carry = 0_u64;
        let mut limbs = Vec::with_capacity(self.0.len() + 1);
        for &limb in &self.0 {
            carry += u64::from(limb) * u64::from(factor);
            limbs.push(carry as u32);
            carry >>= 32;
        }
        limbs.push(carry as u32);
        Self(limbs).trimmed()
    }

    fn times_power(self, base: u32, exponent: i32) -> Self {
        (0..exponent).fold(self, |n, _| n.times(base))
    }

    fn shifted(self, bits: i32) -> Self {
        let bits = bits.unsigned_abs();
        let shifted = self.times(1 << (bits % 32));
        let mut limbs = vec![0; bits as usize / 32];
        limbs.extend(shifted.0);
        Self(limbs).trimmed()
    }

    fn plus(&self, other: &Self) -> Self {
        let mut carry = 0_u64;
        let n = self.0.len().max(other.0.len());
        let mut limbs = Vec::with_capacity(n + 1);
        for i in 0..=n {
            carry += u64::from(self.limb(i)) + u64::from(other.limb(i));
            limbs.push(carry as u32);
            carry >>= 32;
        }
        Self(limbs).trimmed()
    }

    /// The 64 lowest bits.
    fn low(&self) -> i64 {
        (u64::from(self.limb(0)) | (u64::from(self.limb(1)) << 32)) as i64
    }

    fn limb(&self, i: usize) -> u32 {
        self.0.get(i).copied().unwrap_or(0)
    }

    /// Leaves the rest of the division by `divisor`, gives the quotient (below 10).
    fn divide_small(&mut self, divisor: &Self) -> u8 {
        let mut quotient = 0;
        while *self >= *divisor {
            let mut borrow = 0_i64;
            for i in 0..self.0.len() {
                let difference = i64::from(self.0[i]) - i64::from(divisor.limb(i)) + borrow;
                self.0[i] = difference as u32;
                borrow = difference >> 32;
            }
            while self.0.last() == Some(&0) {
                self.0.pop();
            }
            quotient += 1;
        }
        quotient
    }
}

impl Ord for Big {
    fn cmp(&self, other: &Self) -> Ordering {
        self.0
            .len()
            .cmp(&other.0.len())
            .then_with(|| self.0.iter().rev().cmp(other.0.iter().rev()))
    }
}

impl PartialOrd for Big {
    fn partial_cmp(&self, other: &Self) -> Option<Ordering> {
        Some(self.cmp(other))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn doubles_print_as_the_goldens_show() {
        let known = [
            (1.0, "1.0"),
            (-7.5 % 2.0, "-1.5"),
            (2.0_f64.sqrt(), "1.4142135623730951"),
            (1e10, "1.0E10"),
            (1e7, "1.0E7"),
            (9_999_999.0, "9999999.0"),
            (0.001, "0.001"),
            (0.000_999, "9.99E-4"),
            (1000.0, "1000.0"),
            (0.1 + 0.2, "0.30000000000000004"),
            (1e20, "1.0E20"),
            (1.0 / 3.0, "0.3333333333333333"),
            (100.0, "100.0"),
            (4.9e-324, "4.9E-324"),
            (f64::MAX, "1.7976931348623157E308"),
            (f64::MIN_POSITIVE, "2.2250738585072014E-308"),
            (28.444_37, "28.44437"),
            (std::f64::consts::PI, "3.141592653589793"),
            (-0.0, "-0.0"),
        ];
        for (x, text) in known {
            assert_eq!(java_double_to_string(x), text);
        }
    }

    /// Values whose text before JDK 19 is known, some longer than needed (JDK-4511638).
    #[test]
    fn old_java_prints_a_digit_too_many() {
        let known = [
            (1e23, "9.999999999999999E22"),
            (2e23, "1.9999999999999998E23"),
            (8.41e21, "8.409999999999999E21"),
            (7.6999669989E7, "7.6999669989E7"),
            (1e-323, "1.0E-323"),
            (2e-3, "0.002"),
        ];
        for (x, text) in known {
            assert_eq!(java_double_to_string(x), text);
        }
    }

    #[test]
    fn floats_print_as_the_goldens_show() {
        let known = [
            (0.727_563_7, "0.7275637"),
            (0.054_665_208, "0.054665208"),
            (2_147_483_648.0, "2.14748365E9"),
            (1e10, "1.0E10"),
            (512.0, "512.0"),
            (0.1, "0.1"),
            (2.828_427, "2.828427"),
            (1.837_117_3, "1.8371173"),
            (6.283_185_5, "6.2831855"),
            (1.4e-45, "1.4E-45"),
            (f32::MAX, "3.4028235E38"),
            (1.0e-3, "0.001"),
            (16_777_216.0, "1.6777216E7"),
            // The last digit comes from an overflow in Java's own arithmetic.
            (2.0_f32.powi(83), "9.6714065E24"),
        ];
        for (x, text) in known {
            assert_eq!(java_float_to_string(x), text);
        }
    }

    #[test]
    fn text_reads_back_as_the_same_number() {
        let mut seed = 42_u64;
        for _ in 0..5_000 {
            seed = seed
                .wrapping_mul(6_364_136_223_846_793_005)
                .wrapping_add(1_442_695_040_888_963_407);
            let x = f64::from_bits(seed);
            if x.is_finite() {
                assert_eq!(
                    java_double_to_string(x).parse::<f64>().unwrap().to_bits(),
                    x.to_bits()
                );
            }
            let y = f32::from_bits((seed >> 32) as u32);
            if y.is_finite() {
                assert_eq!(
                    java_float_to_string(y).parse::<f32>().unwrap().to_bits(),
                    y.to_bits()
                );
            }
        }
    }
}
