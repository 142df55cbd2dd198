//! Sums that do not lose their small terms.

/// A running sum whose error does not grow with the number of terms: Neumaier's variant of Kahan's summation.
///
/// Source: [Neumaier1974](crate::references#neumaier1974).
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Sum {
    sum: f64,
    lost: f64,
}

impl Sum {
    /// The sum of nothing.
    pub const ZERO: Self = Self {
        sum: 0.0,
        lost: 0.0,
    };

    /// Adds one term.
    pub fn add(&mut self, term: f64) {
        let sum = self.sum + term;
        // What the larger of the two did not take over of the smaller.
        self.lost += if self.sum.abs() >= term.abs() {
            (self.sum - sum) + term
        } else {
            (term - sum) + self.sum
        };
        self.sum = sum;
    }

    /// The sum so far.
    #[must_use]
    pub fn value(&self) -> f64 {
        self.sum + self.lost
    }
}

impl FromIterator<f64> for Sum {
    fn from_iter<I: IntoIterator<Item = f64>>(terms: I) -> Self {
        let mut sum = Self::ZERO;
        for term in terms {
            sum.add(term);
        }
        sum
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn small_terms_survive_large_ones() {
        let terms = [1.0, 1e100, 1.0, -1e100];
        assert_eq!(terms.iter().sum::<f64>(), 0.0);
        assert_eq!(terms.into_iter().collect::<Sum>().value(), 2.0);
    }
}
