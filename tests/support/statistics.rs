//! Demanding of means what the validation demands: a known false-alarm probability, and never blind.

use understory::math::stats::{RunningStats, combined_error};
use understory::validation::verdict::{Family, Verdict};

/// The fault that every comparison must be able to see, as a fraction.
pub(crate) const PLANTED_FAULT: f64 = 0.02;

fn judge(difference: f64, error: f64, scale: f64, comparisons: u32) -> Verdict {
    Family::of(comparisons as usize).judge(difference, error, scale, PLANTED_FAULT)
}

/// Fails unless the observations agree with the truth *and* would not if they were 2 % higher or lower.
pub(crate) fn assert_mean(name: &str, observed: &RunningStats, truth: f64, comparisons: u32) {
    let detail = format!(
        "{name}: {} ± {} of {} observations, expected {truth}",
        observed.mean(),
        observed.standard_error(),
        observed.n()
    );
    let (difference, error) = (observed.mean() - truth, observed.standard_error());
    let found = judge(difference, error, truth, comparisons);
    assert_eq!(found, Verdict::Agrees, "{detail}");
    for fault in [1.0 - PLANTED_FAULT, 1.0 + PLANTED_FAULT] {
        let (difference, error) = (
            observed.mean() * fault - truth,
            observed.standard_error() * fault,
        );
        let seen = judge(difference, error, truth, comparisons);
        assert_eq!(
            seen,
            Verdict::Differs,
            "a planted fault of 2 % stays unseen: {detail}"
        );
    }
}

/// Fails unless two estimates of the same thing agree (Welch) and would not if one were 2 % off.
pub(crate) fn assert_same(name: &str, a: &RunningStats, b: &RunningStats, comparisons: u32) {
    let error = combined_error(a.standard_error(), b.standard_error());
    let detail = format!("{name}: {} and {} ± {error}", a.mean(), b.mean());
    let found = judge(a.mean() - b.mean(), error, a.mean(), comparisons);
    assert_eq!(found, Verdict::Agrees, "{detail}");
    let planted = judge(
        a.mean() * (1.0 + PLANTED_FAULT) - b.mean(),
        error,
        a.mean(),
        comparisons,
    );
    assert_eq!(
        planted,
        Verdict::Differs,
        "a planted fault of 2 % stays unseen: {detail}"
    );
}
