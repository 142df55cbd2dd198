//! Judging means: accepted or refused with a known false-alarm probability, and never blind.

use crate::math::stats::{RunningStats, family_z};
use crate::math::tolerance::CLOSED_FORM;

/// Probability that a right program fails any comparison of one family. Seeds are fixed, so a failure means a fault or a
/// changed random stream, not bad luck.
pub const FALSE_ALARM: f64 = 1.0 / 1_000_000.0;

/// What a comparison found.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Verdict {
    /// The difference is what chance does.
    Agrees,
    /// The means differ by more than chance allows.
    Differs,
    /// The fault that must be seen could hide in the noise.
    Blind,
}

/// Comparisons that are made together and share one [`FALSE_ALARM`].
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Family {
    /// So many standard errors are still chance.
    z: f64,
}

impl Family {
    /// So many comparisons.
    #[must_use]
    pub fn of(comparisons: usize) -> Self {
        let comparisons = u32::try_from(comparisons).unwrap_or(u32::MAX);
        Self {
            z: family_z(FALSE_ALARM, comparisons),
        }
    }

    /// The difference that chance still explains at this standard error, for values of size `scale`: those that are equal on
    /// paper differ by rounding even where nothing is random.
    #[must_use]
    pub fn allowance(self, error: f64, scale: f64) -> f64 {
        self.z * error + CLOSED_FORM * scale.abs()
    }

    /// Whether a fault of the part `fault` of `scale` would be seen for certain (but for one time in 700) at this standard
    /// error.
    #[must_use]
    pub fn sees(self, error: f64, fault: f64, scale: f64) -> bool {
        (self.z + 3.0) * error <= fault * scale.abs()
    }

    /// Judges a difference between values of size `scale`, of this standard error, where a fault of the part `fault` must
    /// not stay unseen. What is no number differs.
    #[must_use]
    pub fn judge(self, difference: f64, error: f64, scale: f64, fault: f64) -> Verdict {
        let is_near = difference.abs() <= self.allowance(error, scale);
        if !is_near {
            Verdict::Differs
        } else if self.sees(error, fault, scale) {
            Verdict::Agrees
        } else {
            Verdict::Blind
        }
    }

    /// Judges a mean of independent observations.
    #[must_use]
    pub fn verdict(self, observed: &RunningStats, truth: f64, fault: f64) -> Verdict {
        let (difference, error) = (observed.mean() - truth, observed.standard_error());
        self.judge(difference, error, truth, fault)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::math::rng;

    #[test]
    fn agreement_fault_and_blindness_are_told_apart() {
        let noise = |spread: f64, n: u64| -> RunningStats {
            let number = |i| 1.0 + spread * (rng::unit_f64(rng::hash(&[11, i])) - 0.5);
            (0..n).map(number).collect()
        };
        let one = Family::of(1);
        assert_eq!(one.verdict(&noise(0.1, 1000), 1.0, 0.02), Verdict::Agrees);
        assert_eq!(one.verdict(&noise(0.1, 1000), 1.02, 0.02), Verdict::Differs);
        assert_eq!(one.verdict(&noise(2.0, 100), 1.0, 0.02), Verdict::Blind);
        assert_eq!(one.judge(f64::NAN, 0.0, 1.0, 0.02), Verdict::Differs);
        assert_eq!(one.judge(0.0, f64::NAN, 1.0, 0.02), Verdict::Differs);
        assert_eq!(one.judge(0.0, 0.0, f64::NAN, 0.02), Verdict::Differs);
    }

    #[test]
    fn larger_families_allow_more() {
        let (one, many) = (Family::of(1), Family::of(300));
        assert!(one.allowance(1.0, 0.0) < many.allowance(1.0, 0.0));
        assert!(many.allowance(1.0, 0.0) < 6.5);
    }
}
