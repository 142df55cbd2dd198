//! `Math.exp`, `log`, `log10` and `pow`, correctly rounded but for one case in some million, as the processor
//! library behind Java's nearly is.
//!
//! `libm`'s are off by one unit in the last place now and then (`exp(1)` is not `Math.E`), which shows where a model prints
//! all digits. Here numbers are carried as unevaluated sums of two doubles: exp(x) = 2^k · exp(r/64)^64 with
//! |r| ≤ ln 2 / 2 and a Taylor series for the inner one; the others correct `libm`'s first guess by one Newton step.
//!
//! Source: [Dekker1971](crate::references#dekker1971) for sums and products in twice the precision.

use std::f64::consts::LOG2_E;

use crate::math::functions as single;

/// ln 2 in two parts; the first has zeros at its end, so that its multiples up to 2^11 are exact.
const LN2_HIGH: f64 = f64::from_bits(0x3fe6_2e42_fee0_0000);
const LN2_LOW: f64 = f64::from_bits(0x3dea_39ef_3579_3c76);
/// 1 / ln 10.
const LOG10_E: Double = Double {
    high: f64::from_bits(0x3fdb_cb7b_1526_e50e),
    low: f64::from_bits(0x3c69_5355_baaa_fad3),
};
/// Beyond this, results are infinite, subnormal or zero.
const GREATEST: f64 = 700.0;
/// Halvings of the argument before the series, and terms of the series.
const HALVINGS: u32 = 6;
const TERMS: u32 = 9;

/// e to the power `x`.
pub(super) fn exp(x: f64) -> f64 {
    if x.is_nan() || x.abs() > GREATEST {
        return single::exp(x);
    }
    Double::from(x).exp().value()
}

/// Natural logarithm.
pub(super) fn ln(x: f64) -> f64 {
    if x.is_normal() && x > 0.0 {
        Double::ln(x).value()
    } else {
        single::ln(x)
    }
}

/// Decimal logarithm.
pub(super) fn log10(x: f64) -> f64 {
    if x.is_normal() && x > 0.0 {
        Double::ln(x).multiplied(LOG10_E).value()
    } else {
        single::log10(x)
    }
}

/// Power; unlike C's, 1 to the power of infinity or NaN is NaN.
pub(in crate::eval) fn pow(base: f64, exponent: f64) -> f64 {
    if exponent.is_nan() || (base.abs() == 1.0 && exponent.is_infinite()) {
        return f64::NAN;
    }
    let guess = single::pow(base, exponent);
    if !guess.is_normal() || !base.is_normal() || !exponent.is_normal() {
        return guess;
    }
    let log = Double::ln(base.abs()).multiplied(Double::from(exponent));
    if log.high.abs() > GREATEST {
        return guess;
    }
    log.exp().value().copysign(guess)
}

/// The sum of two doubles that do not overlap.
#[derive(Clone, Copy)]
struct Double {
    high: f64,
    low: f64,
}

impl From<f64> for Double {
    fn from(high: f64) -> Self {
        Self { high, low: 0.0 }
    }
}

impl Double {
    /// `a + b` without error.
    fn sum(a: f64, b: f64) -> Self {
        let high = a + b;
        let part = high - a;
        Self {
            high,
            low: (a - (high - part)) + (b - part),
        }
    }

    /// `a · b` without error.
    fn product(a: f64, b: f64) -> Self {
        let split = |x: f64| {
            let high = x * 134_217_729.0;
            let high = high - (high - x);
            (high, x - high)
        };
        let ((a1, a2), (b1, b2), high) = (split(a), split(b), a * b);
        Self {
            high,
            low: a2 * b2 - (((high - a1 * b1) - a2 * b1) - a1 * b2),
        }
    }

    /// The one double nearest to it.
    fn value(self) -> f64 {
        self.high + self.low
    }

    /// e to its power; its size is at most [`GREATEST`].
    fn exp(self) -> Self {
        // Reduce: x = k ln 2 + r.
        let k = (self.high * LOG2_E).round();
        let r = Self::sum(self.high - k * LN2_HIGH, self.low - k * LN2_LOW);
        let s = r.times(1.0 / f64::from(1_u32 << HALVINGS));

        // exp(s) - 1 = s (1 + s/2 (1 + s/3 (…))).
        let mut series = Self::from(1.0);
        for n in (2..=TERMS).rev() {
            series = Self::from(1.0).plus(s.multiplied(series).divided(f64::from(n)));
        }
        let mut power = s.multiplied(series);

        // (1 + p)² - 1 = 2 p + p², as often as the argument was halved.
        for _ in 0..HALVINGS {
            power = power.times(2.0).plus(power.multiplied(power));
        }
        Self::from(1.0).plus(power).times(2.0_f64.powi(k as i32))
    }

    /// Natural logarithm of a normal number above 0: y + x / exp(y) - 1 for a good guess y.
    fn ln(x: f64) -> Self {
        let guess = single::ln(x);
        if guess.abs() > GREATEST {
            return Self::from(guess);
        }
        let power = Self::from(guess).exp();
        let rest = ((x - power.high) - power.low) / power.high;
        Self::sum(guess, rest)
    }

    fn plus(self, other: Self) -> Self {
        let sum = Self::sum(self.high, other.high);
        Self::sum(sum.high, sum.low + self.low + other.low)
    }

    fn multiplied(self, other: Self) -> Self {
        let product = Self::product(self.high, other.high);
        Self::sum(
            product.high,
            product.low + self.high * other.low + self.low * other.high,
        )
    }

    /// Times a power of two.
    fn times(self, factor: f64) -> Self {
        Self {
            high: self.high * factor,
            low: self.low * factor,
        }
    }

    fn divided(self, n: f64) -> Self {
        let quotient = self.high / n;
        let rest = Self::product(quotient, n);
        Self::sum(
            quotient,
            ((self.high - rest.high) - rest.low + self.low) / n,
        )
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Values of JDK 17's `Math`.
    #[test]
    fn values_are_javas() {
        let known = [
            (exp(1.0), std::f64::consts::E),
            (exp(0.0), 1.0),
            (exp(2.0), 7.389_056_098_930_65),
            (exp(-1.0), 0.367_879_441_171_442_33),
            (exp(0.5), 1.648_721_270_700_128_2),
            (exp(10.0), 22_026.465_794_806_718),
            (exp(-700.0), 9.859_676_543_759_77e-305),
            (ln(10.0), std::f64::consts::LN_10),
            (ln(1.0), 0.0),
            (log10(1000.0), 3.0),
            (log10(2.0), std::f64::consts::LOG10_2),
            (pow(2.0, 10.0), 1024.0),
            (pow(-2.0, 3.0), -8.0),
            (pow(2.0, 0.5), std::f64::consts::SQRT_2),
            (pow(10.0, -3.0), 0.001),
        ];
        for (i, (found, wanted)) in known.into_iter().enumerate() {
            assert_eq!(found, wanted, "number {i}");
        }
    }

    #[test]
    fn the_ends_of_the_range_are_javas() {
        assert_eq!((exp(1000.0), exp(-1000.0)), (f64::INFINITY, 0.0));
        assert_eq!(
            (ln(0.0), pow(0.0, -1.0)),
            (f64::NEG_INFINITY, f64::INFINITY)
        );
        assert_eq!((pow(10.0, 400.0), pow(1e-300, 2.0)), (f64::INFINITY, 0.0));
        assert_eq!(pow(f64::NAN, 0.0), 1.0);
        for nan in [
            exp(f64::NAN),
            ln(-1.0),
            pow(-2.0, 0.5),
            pow(1.0, f64::INFINITY),
            pow(1.0, f64::NAN),
        ] {
            assert!(nan.is_nan());
        }
    }
}
