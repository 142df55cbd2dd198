//! B-spline basis functions over a list of knots. Source: [`PieglTiller1997`](crate::references#piegltiller1997) §2.

use super::CurvedError;

/// The greatest degree of a curve.
pub const MAX_DEGREE: usize = 25;

/// Values of the basis functions that are not 0 at a parameter, the first of them `first`.
#[derive(Clone, Copy, Debug)]
pub struct Weights {
    /// Number of the first function that is not 0.
    pub first: usize,
    n: usize,
    values: [f64; MAX_DEGREE + 1],
    slopes: [f64; MAX_DEGREE + 1],
}

impl Weights {
    /// The values, one per function from `first` on.
    #[must_use]
    pub fn values(&self) -> &[f64] {
        &self.values[..self.n]
    }

    /// Their derivatives by the parameter.
    #[must_use]
    pub fn slopes(&self) -> &[f64] {
        &self.slopes[..self.n]
    }
}

/// The basis functions of one degree over a list of knots.
#[derive(Clone, Debug, PartialEq)]
pub struct Basis {
    degree: usize,
    knots: Vec<f64>,
}

impl Basis {
    /// A basis of `n` functions of this degree; there must be `n + degree + 1` knots, none smaller than the one before it,
    /// no more than `degree` of them equal within the range.
    ///
    /// # Errors
    /// If they are not so.
    pub fn new(degree: usize, n: usize, knots: Vec<f64>) -> Result<Self, CurvedError> {
        check_degree(degree, n)?;
        if knots.len() != n + degree + 1 {
            return Err(CurvedError::Knots(
                "are not as many as its points and its degree plus 1",
            ));
        }
        if !knots.iter().all(|knot| knot.is_finite()) {
            return Err(CurvedError::NotFinite);
        }
        if knots.windows(2).any(|pair| pair[0] > pair[1]) {
            return Err(CurvedError::Knots("go back"));
        }
        let inner = &knots[degree..=n];
        if inner[0] >= inner[inner.len() - 1] {
            return Err(CurvedError::Knots("leave it no range"));
        }
        if knots[1..n + degree]
            .windows(degree + 1)
            .any(|run| run[0] == run[degree])
        {
            return Err(CurvedError::Knots(
                "tear it apart: more of them are equal than its degree",
            ));
        }
        Ok(Self { degree, knots })
    }

    /// Equal spans from 0 to 1, the ends held by the first and the last point. `n = degree + 1` gives a Bézier curve.
    ///
    /// # Errors
    /// If there are too few points, or the degree is out of range.
    pub fn clamped(degree: usize, n: usize) -> Result<Self, CurvedError> {
        check_degree(degree, n)?;
        let spans = (n - degree) as f64;
        let knot = |i: usize| (i.saturating_sub(degree) as f64 / spans).min(1.0);
        Self::new(degree, n, (0..=n + degree).map(knot).collect())
    }

    /// Equal spans from 0 to 1 that go on beyond both ends: for points of which the first `degree` come again at the end.
    ///
    /// # Errors
    /// As [`clamped`](Self::clamped).
    pub fn periodic(degree: usize, n: usize) -> Result<Self, CurvedError> {
        check_degree(degree, n)?;
        let spans = (n - degree) as f64;
        let knot = |i: usize| (i as f64 - degree as f64) / spans;
        Self::new(degree, n, (0..=n + degree).map(knot).collect())
    }

    /// Bézier pieces of this degree, one after the other between these parameters.
    ///
    /// # Errors
    /// If the parameters do not ascend.
    pub fn pieces(degree: usize, ends: &[f64]) -> Result<Self, CurvedError> {
        let last = ends.len().saturating_sub(1);
        let times = |i: usize| {
            if i == 0 || i == last {
                degree + 1
            } else {
                degree
            }
        };
        let knots = ends
            .iter()
            .enumerate()
            .flat_map(|(i, end)| std::iter::repeat_n(*end, times(i)));
        Self::new(degree, degree * last + 1, knots.collect())
    }

    /// The degree.
    #[must_use]
    pub fn degree(&self) -> usize {
        self.degree
    }

    /// How many functions there are.
    #[must_use]
    pub fn len(&self) -> usize {
        self.knots.len() - self.degree - 1
    }

    /// Whether there is none; there always is one.
    #[must_use]
    pub fn is_empty(&self) -> bool {
        false
    }

    /// First and last parameter.
    #[must_use]
    pub fn range(&self) -> [f64; 2] {
        [self.knots[self.degree], self.knots[self.len()]]
    }

    /// The different knots within the range, both ends among them.
    #[must_use]
    pub fn breaks(&self) -> Vec<f64> {
        let mut breaks = self.knots[self.degree..=self.len()].to_vec();
        breaks.dedup();
        breaks
    }

    /// The functions at `t`, which is brought into the range.
    #[must_use]
    pub fn at(&self, t: f64) -> Weights {
        let (p, n) = (self.degree, self.len());
        let [start, end] = self.range();
        let t = t.clamp(start, end);
        // The last span that is not empty, of those that begin at or before t.
        let after = self.knots[..n].partition_point(|knot| *knot <= t);
        let mut span = after.clamp(p + 1, n) - 1;
        while span > p && self.knots[span] == self.knots[span + 1] {
            span -= 1;
        }
        let lower = self.values(span, t, p - 1);
        let values = self.values(span, t, p);
        let mut slopes = [0.0; MAX_DEGREE + 1];
        for (j, slope) in slopes.iter_mut().enumerate().take(p + 1) {
            let i = span + j - p;
            let share = |value: f64, from: usize, to: usize| {
                let width = self.knots[to] - self.knots[from];
                if width > 0.0 {
                    value * p as f64 / width
                } else {
                    0.0
                }
            };
            let rising = if j > 0 {
                share(lower[j - 1], i, i + p)
            } else {
                0.0
            };
            let falling = if j < p {
                share(lower[j], i + 1, i + p + 1)
            } else {
                0.0
            };
            *slope = rising - falling;
        }
        Weights {
            first: span - p,
            n: p + 1,
            values,
            slopes,
        }
    }

    /// The functions of `degree` that are not 0 in a span, by their recursion ([`PieglTiller1997`](crate::references#piegltiller1997) A2.2).
    fn values(&self, span: usize, t: f64, degree: usize) -> [f64; MAX_DEGREE + 1] {
        let mut values = [0.0; MAX_DEGREE + 1];
        values[0] = 1.0;
        for level in 1..=degree {
            let mut saved = 0.0;
            for (r, value) in values.iter_mut().enumerate().take(level) {
                let right = self.knots[span + r + 1] - t;
                let left = t - self.knots[span + r + 1 - level];
                let part = *value / (right + left);
                *value = saved + right * part;
                saved = left * part;
            }
            values[level] = saved;
        }
        values
    }
}

fn check_degree(degree: usize, n: usize) -> Result<(), CurvedError> {
    if !(1..=MAX_DEGREE).contains(&degree) {
        return Err(CurvedError::Degree(degree));
    }
    if n <= degree {
        return Err(CurvedError::TooFewPoints {
            points: n,
            needed: degree + 1,
            degree,
        });
    }
    Ok(())
}

#[cfg(test)]
mod tests {
    use super::*;

    fn bases() -> Vec<Basis> {
        vec![
            Basis::clamped(1, 5).unwrap(),
            Basis::clamped(3, 4).unwrap(),
            Basis::clamped(3, 9).unwrap(),
            Basis::periodic(2, 8).unwrap(),
            Basis::pieces(3, &[0.0, 0.5, 2.0]).unwrap(),
            Basis::new(2, 5, vec![0.0, 0.0, 1.0, 1.0, 2.0, 2.0, 3.0, 4.0]).unwrap(),
            Basis::clamped(MAX_DEGREE, MAX_DEGREE + 1).unwrap(),
        ]
    }

    #[test]
    fn they_add_up_to_one_everywhere_and_their_slopes_to_nothing() {
        for basis in bases() {
            let [start, end] = basis.range();
            for step in 0..=100 {
                let t = start + (end - start) * f64::from(step) / 100.0;
                let w = basis.at(t);
                assert!(w.first + w.values().len() <= basis.len());
                assert!(
                    (w.values().iter().sum::<f64>() - 1.0).abs() < 1e-12,
                    "{basis:?} {t}"
                );
                assert!(w.slopes().iter().sum::<f64>().abs() < 1e-9 * (1.0 + basis.degree as f64));
                assert!(w.values().iter().all(|v| *v >= -1e-14));
            }
        }
    }

    #[test]
    fn slopes_are_the_derivatives() {
        let value = |basis: &Basis, t: f64, i: usize| {
            let w = basis.at(t);
            i.checked_sub(w.first)
                .and_then(|j| w.values().get(j).copied())
                .unwrap_or(0.0)
        };
        for basis in bases().into_iter().take(6) {
            let [start, end] = basis.range();
            for step in 0..37 {
                let t = start + (end - start) * (f64::from(step) + 0.31) / 37.0;
                let w = basis.at(t);
                for (j, slope) in w.slopes().iter().enumerate() {
                    let h = 1e-6;
                    let i = w.first + j;
                    let found = (value(&basis, t + h, i) - value(&basis, t - h, i)) / (2.0 * h);
                    assert!(
                        (found - slope).abs() < 1e-6 * (1.0 + slope.abs()),
                        "{basis:?} {t} {i}"
                    );
                }
            }
        }
    }

    #[test]
    fn impossible_knots_are_refused() {
        for (degree, n, knots) in [
            (0, 3, vec![]),
            (26, 30, vec![]),
            (2, 3, vec![0.0; 5]),
            (2, 3, vec![0.0; 6]),
            (1, 3, vec![0.0, 0.0, f64::NAN, 1.0, 1.0]),
            (1, 3, vec![0.0, 0.0, 2.0, 1.0, 1.0]),
            (1, 4, vec![0.0, 0.0, 0.5, 0.5, 1.0, 1.0]),
        ] {
            assert!(
                Basis::new(degree, n, knots.clone()).is_err(),
                "{degree} {n} {knots:?}"
            );
        }
        assert!(Basis::clamped(3, 3).is_err() && Basis::pieces(3, &[0.0]).is_err());
    }
}
