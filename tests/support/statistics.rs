//! Judging means: accepted or refused with a known false-alarm probability, and never blind.

use understory::math::stats::{RunningStats, combined_error, family_z};

/// Probability that a correct program fails any comparison of one test. Seeds are fixed, so red means a bug or a changed
/// random stream, not bad luck.
pub(crate) const FALSE_ALARM: f64 = 1e-6;

/// The fault that every comparison must be able to see, as a fraction.
pub(crate) const PLANTED_FAULT: f64 = 0.02;

/// What a comparison found.
#[derive(Debug, PartialEq, Eq)]
pub(crate) enum Verdict {
    Agrees,
    /// The means differ by more than chance allows.
    Differs,
    /// A fault of [`PLANTED_FAULT`] could hide in the noise.
    Blind,
}

/// Compares a mean of independent observations with the truth; `comparisons` is how many the whole test makes.
pub(crate) fn verdict(observed: &RunningStats, truth: f64, comparisons: u32) -> Verdict {
    judge(
        observed.mean() - truth,
        observed.standard_error(),
        truth,
        comparisons,
    )
}

fn judge(difference: f64, error: f64, scale: f64, comparisons: u32) -> Verdict {
    let z = family_z(FALSE_ALARM, comparisons);
    // Values that are equal on paper differ by rounding even where nothing is random.
    let rounding = 1e-9 * scale.abs();
    if difference.abs() > z * error + rounding {
        Verdict::Differs
    } else if (z + 3.0) * error > PLANTED_FAULT * scale.abs() {
        Verdict::Blind
    } else {
        Verdict::Agrees
    }
}

/// Fails unless the observations agree with the truth *and* would not if they were 2 % higher or lower.
pub(crate) fn assert_mean(name: &str, observed: &RunningStats, truth: f64, comparisons: u32) {
    let detail = format!(
        "{name}: {} ± {} of {} observations, expected {truth}",
        observed.mean(),
        observed.standard_error(),
        observed.n()
    );
    assert_eq!(
        verdict(observed, truth, comparisons),
        Verdict::Agrees,
        "{detail}"
    );
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
