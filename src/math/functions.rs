//! Transcendental functions whose bits are the same on every machine.
//!
//! The standard library's `f64::sin` and its kin call whatever the platform offers and differ in the last bit between
//! platforms. Growth and pictures must not, so they use these, which are `libm`'s.

/// Sine of an angle in radians.
#[inline]
#[must_use]
pub fn sin(x: f64) -> f64 {
    libm::sin(x)
}

/// Cosine of an angle in radians.
#[inline]
#[must_use]
pub fn cos(x: f64) -> f64 {
    libm::cos(x)
}

/// Sine and cosine of an angle in radians.
#[inline]
#[must_use]
pub fn sin_cos(x: f64) -> (f64, f64) {
    libm::sincos(x)
}

/// Tangent of an angle in radians.
#[inline]
#[must_use]
pub fn tan(x: f64) -> f64 {
    libm::tan(x)
}

/// Arc sine in radians; NaN outside -1..=1.
#[inline]
#[must_use]
pub fn asin(x: f64) -> f64 {
    libm::asin(x)
}

/// Arc cosine in radians; NaN outside -1..=1.
#[inline]
#[must_use]
pub fn acos(x: f64) -> f64 {
    libm::acos(x)
}

/// Arc tangent in radians.
#[inline]
#[must_use]
pub fn atan(x: f64) -> f64 {
    libm::atan(x)
}

/// Angle in radians, in -π..=π, of the point (`x`, `y`) seen from the origin.
#[inline]
#[must_use]
pub fn atan2(y: f64, x: f64) -> f64 {
    libm::atan2(y, x)
}

/// e to the power `x`.
#[inline]
#[must_use]
pub fn exp(x: f64) -> f64 {
    libm::exp(x)
}

/// Natural logarithm.
#[inline]
#[must_use]
pub fn ln(x: f64) -> f64 {
    libm::log(x)
}

/// Logarithm to base 2.
#[inline]
#[must_use]
pub fn log2(x: f64) -> f64 {
    libm::log2(x)
}

/// Logarithm to base 10.
#[inline]
#[must_use]
pub fn log10(x: f64) -> f64 {
    libm::log10(x)
}

/// `base` to the power `exponent`.
#[inline]
#[must_use]
pub fn pow(base: f64, exponent: f64) -> f64 {
    libm::pow(base, exponent)
}

/// Cube root.
#[inline]
#[must_use]
pub fn cbrt(x: f64) -> f64 {
    libm::cbrt(x)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn functions_are_wired_to_their_names() {
        let x = 0.6;
        let pairs = [
            (sin(x), 0.564_642_473_395_035_4),
            (cos(x), 0.825_335_614_909_678_3),
            (tan(x), 0.684_136_808_341_692_3),
            (asin(x), 0.643_501_108_793_284_4),
            (acos(x), 0.927_295_218_001_612_3),
            (atan(x), 0.540_419_500_270_584_2),
            (atan2(3.0, -4.0), 2.498_091_544_796_509),
            (exp(x), 1.822_118_800_390_509),
            (ln(x), -0.510_825_623_765_990_7),
            (log2(8.0), 3.0),
            (log10(1000.0), 3.0),
            (pow(x, 2.5), 0.278_854_800_926_934_04),
            (cbrt(27.0), 3.0),
        ];
        for (index, (found, expected)) in pairs.into_iter().enumerate() {
            assert!(
                (found - expected).abs() <= 4e-16 * expected.abs(),
                "{index}: {found}"
            );
        }
        assert_eq!(sin_cos(x), (sin(x), cos(x)));
    }
}
