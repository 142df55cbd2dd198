//! Choosing one of many in proportion to their weights, in constant time.

/// A table that turns one uniform number into an index with given probabilities.
///
/// Source: [Vose1991](crate::references#vose1991). Built in `f64`; cost O(n) to build, O(1) to ask.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct AliasTable {
    cells: Vec<Cell>,
    probabilities: Vec<f64>,
}

#[derive(Clone, Copy, Debug, PartialEq)]
struct Cell {
    /// Share of the cell that belongs to the index itself.
    keep: f64,
    /// Whom the rest belongs to.
    alias: usize,
}

/// Why weights are no weights.
#[derive(Clone, Copy, Debug, PartialEq, thiserror::Error)]
pub enum AliasError {
    /// A weight is negative, infinite or NaN.
    #[error("weight {index} is {weight}, not a finite number from 0 up")]
    Weight {
        /// Whose weight.
        index: usize,
        /// The weight.
        weight: f64,
    },
}

impl AliasTable {
    /// A table for these weights (any positive scale). If all are 0 the table is empty: there is nothing to choose.
    ///
    /// # Errors
    /// A weight that is negative or not finite.
    pub fn new(weights: &[f64]) -> Result<Self, AliasError> {
        let wrong = weights.iter().position(|w| !w.is_finite() || *w < 0.0);
        if let Some(index) = wrong {
            return Err(AliasError::Weight {
                index,
                weight: weights[index],
            });
        }

        // Scale by the largest first, so that sums of huge or tiny weights neither overflow nor vanish.
        let largest = weights.iter().copied().fold(0.0, f64::max);
        if largest == 0.0 {
            return Ok(Self::default());
        }
        let total: f64 = weights.iter().map(|w| w / largest).sum();
        let probabilities: Vec<f64> = weights.iter().map(|w| w / largest / total).collect();
        let cells = fill(&probabilities);
        Ok(Self {
            cells,
            probabilities,
        })
    }

    /// How many things there are to choose from; 0 if none has weight.
    #[must_use]
    pub fn len(&self) -> usize {
        self.cells.len()
    }

    /// Whether there is nothing to choose.
    #[must_use]
    pub fn is_empty(&self) -> bool {
        self.cells.is_empty()
    }

    /// The index for `u` in [0, 1); `None` if the table is empty.
    #[must_use]
    pub fn sample(&self, u: f64) -> Option<usize> {
        let at = u * self.cells.len() as f64;
        let index = (at as usize).min(self.cells.len().checked_sub(1)?);
        let cell = self.cells[index];
        Some(if at - (index as f64) < cell.keep {
            index
        } else {
            cell.alias
        })
    }

    /// Probability of `index`; 0 if it is not in the table.
    #[must_use]
    pub fn probability(&self, index: usize) -> f64 {
        self.probabilities.get(index).copied().unwrap_or(0.0)
    }
}

/// Pairs every index of less than average probability with one of more.
fn fill(probabilities: &[f64]) -> Vec<Cell> {
    let n = probabilities.len();
    let mut scaled: Vec<f64> = probabilities.iter().map(|p| p * n as f64).collect();
    let mut cells: Vec<Cell> = (0..n).map(|alias| Cell { keep: 1.0, alias }).collect();
    let (mut small, mut large): (Vec<usize>, Vec<usize>) = (0..n).partition(|&i| scaled[i] < 1.0);
    while let (Some(&less), Some(&more)) = (small.last(), large.last()) {
        small.pop();
        cells[less] = Cell {
            keep: scaled[less],
            alias: more,
        };
        scaled[more] -= 1.0 - scaled[less];
        if scaled[more] < 1.0 {
            large.pop();
            small.push(more);
        }
    }
    // Rounding may leave an index of weight 0 alone; it must stay impossible.
    if let Some(heaviest) = (0..n).max_by(|&a, &b| probabilities[a].total_cmp(&probabilities[b])) {
        for index in small {
            if probabilities[index] == 0.0 {
                cells[index] = Cell {
                    keep: 0.0,
                    alias: heaviest,
                };
            }
        }
    }
    cells
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Probability of each index by the areas of the table itself.
    fn realised(table: &AliasTable) -> Vec<f64> {
        let n = table.len() as f64;
        let mut shares = vec![0.0; table.len()];
        for (i, cell) in table.cells.iter().enumerate() {
            shares[i] += cell.keep / n;
            shares[cell.alias] += (1.0 - cell.keep) / n;
        }
        shares
    }

    /// C-63: one weight, weights of 0, weights 60 decades apart.
    #[test]
    fn shares_equal_the_weights() {
        let cases: [&[f64]; 6] = [
            &[3.0],
            &[1.0, 0.0, 2.0],
            &[1e-30, 1e30, 1.0],
            &[0.1; 10],
            &[1e308, 1e308, 1e308],
            &[5e-324, 5e-324],
        ];
        for weights in cases {
            let table = AliasTable::new(weights).unwrap();
            let sum: f64 = (0..weights.len()).map(|i| table.probability(i)).sum();
            assert!((sum - 1.0).abs() < 1e-14, "{weights:?}");
            for (i, share) in realised(&table).into_iter().enumerate() {
                assert!(
                    (share - table.probability(i)).abs() < 1e-15,
                    "{weights:?} {i}"
                );
            }
        }
    }

    #[test]
    fn weight_zero_is_never_chosen() {
        let table = AliasTable::new(&[0.0, 1.0 / 3.0, 0.0, 2.0 / 3.0, 0.0]).unwrap();
        for i in 0..10_000 {
            let chosen = table.sample(f64::from(i) / 10_000.0).unwrap();
            assert!(chosen == 1 || chosen == 3);
        }
    }

    /// C-63, C-54.
    #[test]
    fn no_weight_is_an_empty_table_and_bad_weights_are_refused() {
        for weights in [&[][..], &[0.0, 0.0]] {
            let table = AliasTable::new(weights).unwrap();
            assert_eq!(
                (table.is_empty(), table.sample(0.5), table.probability(0)),
                (true, None, 0.0)
            );
        }
        assert!(AliasTable::new(&[1.0, f64::NAN]).is_err());
        assert!(AliasTable::new(&[1.0, -1.0]).is_err());
        assert!(AliasTable::new(&[f64::INFINITY]).is_err());
    }

    #[test]
    fn edge_numbers_stay_in_range() {
        let table = AliasTable::new(&[1.0, 2.0, 3.0]).unwrap();
        assert!(table.sample(0.0).unwrap() < 3);
        assert!(table.sample(1.0).unwrap() < 3);
    }
}
