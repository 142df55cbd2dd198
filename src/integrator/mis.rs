//! Combining two ways of finding the same light.
//!
//! Source: [`VeachGuibas1995`](crate::references#veachguibas1995). With one sample of each strategy the weights of both sum
//! to 1 for every direction, so the combination is unbiased whatever the heuristic.

/// Weight of a sample found with density `own`, when the other strategy would have found it with density `other` (the
/// same measure): the power heuristic with exponent 2.
///
/// 1 if the other strategy could not have found it. 0 if this one could not.
#[must_use]
pub fn power_heuristic(own: f64, other: f64) -> f64 {
    if own <= 0.0 {
        return 0.0;
    }
    // The ratio, not the squares: densities of the sun's disk squared are large, and infinity over infinity is no number.
    let ratio = other / own;
    1.0 / (1.0 + ratio * ratio)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn weights_of_both_strategies_sum_to_one() {
        for (a, b) in [(1.0, 1.0), (0.3, 14_000.0), (1e-300, 1e300), (2.0, 1e-12)] {
            let sum = power_heuristic(a, b) + power_heuristic(b, a);
            assert!((sum - 1.0).abs() < 1e-15, "{a} {b}: {sum}");
        }
    }

    #[test]
    fn a_strategy_alone_has_the_whole_weight() {
        assert_eq!(power_heuristic(0.7, 0.0), 1.0);
        assert_eq!(power_heuristic(0.0, 0.7), 0.0);
        assert_eq!(power_heuristic(0.0, 0.0), 0.0);
    }
}
