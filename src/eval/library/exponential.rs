//! `Math.exp`, correctly rounded but for one case in some million, as the processor library behind Java's is.
//!
//! `libm`'s is off by one unit in the last place now and then (`exp(1)` is not `Math.E`). Here the number is carried as an
//! unevaluated sum of two doubles: exp(x) = 2^k · exp(r/64)^64 with |r| ≤ ln 2 / 2 and a Taylor series for the inner one.
//!
//! Source: [Dekker1971](crate::references#dekker1971) for sums and products in twice the precision.

use std::f64::consts::LOG2_E;

/// ln 2 in two parts; the first has zeros at its end, so that its multiples up to 2^11 are exact.
const LN2_HIGH: f64 = f64::from_bits(0x3fe6_2e42_fee0_0000);
const LN2_LOW: f64 = f64::from_bits(0x3dea_39ef_3579_3c76);
/// Beyond this, results are infinite, subnormal or zero.
const GREATEST: f64 = 700.0;
/// Halvings of the argument before the series, and terms of the series.
const HALVINGS: u32 = 6;
const TERMS: u32 = 9;

/// e to the power `x`.
pub(super) fn exp(x: f64) -> f64 {
    if x.is_nan() || x.abs() > GREATEST {
        return crate::math::functions::exp(x);
    }
    // Reduce: x = k ln 2 + r.
    let k = (x * LOG2_E).round();
    let r = Double::sum(x - k * LN2_HIGH, -k * LN2_LOW);
    let s = r.times(1.0 / f64::from(1_u32 << HALVINGS));

    // exp(s) - 1 = s (1 + s/2 (1 + s/3 (…))).
    let mut series = Double::from(1.0);
    for n in (2..=TERMS).rev() {
        series = Double::from(1.0).plus(s.multiplied(series).divided(f64::from(n)));
    }
    let mut power = s.multiplied(series);

    // (1 + p)² - 1 = 2 p + p², as often as the argument was halved.
    for _ in 0..HALVINGS {
        power = power.times(2.0).plus(power.multiplied(power));
    }
    let result = Double::from(1.0).plus(power);
    (result.high + result.low) * 2.0_f64.powi(k as i32)
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

    /// Values of JDK 17's `Math.exp`.
    #[test]
    fn values_are_javas() {
        let known = [
            (1.0, std::f64::consts::E),
            (0.0, 1.0),
            (2.0, 7.389_056_098_930_65),
            (-1.0, 0.367_879_441_171_442_33),
            (0.5, 1.648_721_270_700_128_2),
            (10.0, 22_026.465_794_806_718),
            (-700.0, 9.859_676_543_759_77e-305),
        ];
        for (x, y) in known {
            assert_eq!(exp(x), y, "exp({x})");
        }
        assert_eq!((exp(1000.0), exp(-1000.0)), (f64::INFINITY, 0.0));
        assert!(exp(f64::NAN).is_nan());
    }
}
