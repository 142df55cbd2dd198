//! Means with their uncertainty, and how far a mean may lie from the truth by chance.

use super::functions::{exp, ln};
use libm::{erfc, lgamma};

/// Running mean and variance of a stream of numbers (Welford), mergeable.
///
/// Source: [Welford1962](crate::references#welford1962); merging after [Chan1983](crate::references#chan1983).
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct RunningStats {
    n: u64,
    mean: f64,
    sum_of_squares: f64,
}

impl RunningStats {
    /// Adds one number.
    pub fn push(&mut self, x: f64) {
        self.n += 1;
        let delta = x - self.mean;
        self.mean += delta / self.n as f64;
        self.sum_of_squares += delta * (x - self.mean);
    }

    /// The statistics of both streams together.
    #[must_use]
    pub fn merged(&self, other: &Self) -> Self {
        if other.n == 0 {
            return *self;
        }
        let n = self.n + other.n;
        let delta = other.mean - self.mean;
        let share = other.n as f64 / n as f64;
        Self {
            n,
            mean: self.mean + delta * share,
            sum_of_squares: self.sum_of_squares
                + other.sum_of_squares
                + delta * delta * self.n as f64 * share,
        }
    }

    /// How many numbers there were.
    #[must_use]
    pub const fn n(&self) -> u64 {
        self.n
    }

    /// Their mean; 0 of none.
    #[must_use]
    pub const fn mean(&self) -> f64 {
        self.mean
    }

    /// Unbiased variance of one number; 0 of fewer than two.
    #[must_use]
    pub fn variance(&self) -> f64 {
        if self.n < 2 {
            0.0
        } else {
            self.sum_of_squares / (self.n - 1) as f64
        }
    }

    /// Standard error of the mean.
    #[must_use]
    pub fn standard_error(&self) -> f64 {
        if self.n == 0 {
            0.0
        } else {
            (self.variance() / self.n as f64).sqrt()
        }
    }
}

impl FromIterator<f64> for RunningStats {
    fn from_iter<I: IntoIterator<Item = f64>>(numbers: I) -> Self {
        let mut stats = Self::default();
        numbers.into_iter().for_each(|x| stats.push(x));
        stats
    }
}

/// Probability that a standard normal variable exceeds `z`.
#[must_use]
pub fn normal_upper_tail(z: f64) -> f64 {
    0.5 * erfc(z / std::f64::consts::SQRT_2)
}

/// The number of standard errors that `comparisons` independent means exceed together, on either side, only with
/// probability `alpha` (0..1): the two-sided normal quantile at the Šidák level 1 - (1 - α)^(1/m).
#[must_use]
pub fn family_z(alpha: f64, comparisons: u32) -> f64 {
    let each = -libm::expm1(libm::log1p(-alpha) / f64::from(comparisons.max(1)));
    // Bisection: the tail falls monotonically from ½ at 0 to less than the smallest number at 40.
    let (mut low, mut high) = (0.0, 40.0);
    for _ in 0..80 {
        let middle = 0.5 * (low + high);
        if 2.0 * normal_upper_tail(middle) > each {
            low = middle;
        } else {
            high = middle;
        }
    }
    0.5 * (low + high)
}

/// Probability that a χ² variable with `degrees` of freedom exceeds `x`: the regularised upper incomplete gamma function.
///
/// Series below the mean, continued fraction above ([`NumericalRecipes`, §6.2](crate::references#numericalrecipes)).
#[must_use]
pub fn chi_squared_upper_tail(x: f64, degrees: f64) -> f64 {
    let (a, x) = (0.5 * degrees, 0.5 * x);
    if x <= 0.0 {
        return 1.0;
    }
    let scale = exp(a * ln(x) - x - lgamma(a));
    if x < a + 1.0 {
        // Series of the lower function.
        let (mut term, mut sum, mut k) = (1.0 / a, 1.0 / a, a);
        while term > sum * f64::EPSILON {
            k += 1.0;
            term *= x / k;
            sum += term;
        }
        (1.0 - scale * sum).max(0.0)
    } else {
        // Lentz's evaluation of the continued fraction of the upper function.
        let mut b = x + 1.0 - a;
        let mut c = f64::MAX;
        let mut d = 1.0 / b;
        let mut value = d;
        for i in 1..10_000 {
            let i = f64::from(i);
            let numerator = -i * (i - a);
            b += 2.0;
            d = 1.0 / (numerator * d + b);
            c = b + numerator / c;
            value *= d * c;
            if (d * c - 1.0).abs() < f64::EPSILON {
                break;
            }
        }
        scale * value
    }
}

/// Square root of the sum of two squared standard errors: the error of a difference of independent means.
#[must_use]
pub fn combined_error(a: f64, b: f64) -> f64 {
    (a * a + b * b).sqrt()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn merging_equals_one_stream() {
        let numbers: Vec<f64> = (0..100).map(|i| f64::from(i * i % 37)).collect();
        let whole: RunningStats = numbers.iter().copied().collect();
        let (a, b) = numbers.split_at(23);
        let merged = a
            .iter()
            .copied()
            .collect::<RunningStats>()
            .merged(&b.iter().copied().collect());
        assert!((whole.mean() - merged.mean()).abs() < 1e-12);
        assert!((whole.variance() - merged.variance()).abs() < 1e-9);
        assert_eq!(whole.merged(&RunningStats::default()), whole);
        assert_eq!(RunningStats::default().merged(&whole).mean(), whole.mean());
    }

    #[test]
    fn variance_of_a_known_list() {
        let stats: RunningStats = [2.0, 4.0, 4.0, 4.0, 5.0, 5.0, 7.0, 9.0]
            .into_iter()
            .collect();
        assert_eq!((stats.n(), stats.mean()), (8, 5.0));
        assert!((stats.variance() - 32.0 / 7.0).abs() < 1e-12);
    }

    #[test]
    fn quantiles_of_the_tables() {
        assert!((family_z(0.05, 1) - 1.959_963_985).abs() < 1e-8);
        assert!((family_z(1e-6, 1) - 4.891_638_475).abs() < 1e-8);
        assert!(family_z(1e-6, 100) > family_z(1e-6, 1));
        assert!((normal_upper_tail(1.0) - 0.158_655_253_9).abs() < 1e-10);
    }

    #[test]
    fn chi_squared_of_the_tables() {
        // Upper 5 % points: 3.841 (1), 18.307 (10), 124.342 (100 degrees of freedom).
        for (x, degrees) in [(3.841_458_8, 1.0), (18.307_038, 10.0), (124.342_113, 100.0)] {
            assert!((chi_squared_upper_tail(x, degrees) - 0.05).abs() < 1e-7);
        }
        assert_eq!(chi_squared_upper_tail(0.0, 5.0), 1.0);
        assert!((chi_squared_upper_tail(2.0, 2.0) - (-1.0_f64).exp()).abs() < 1e-14);
    }
}
