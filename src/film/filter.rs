//! How a pixel weighs the light around it, by choosing where in its neighbourhood its samples fall.
//!
//! Filter importance sampling ([Ernst2006](crate::references#ernst2006)): samples are drawn with the density of the filter,
//! so every sample has weight 1, pixels share no samples, and their errors are independent.

use crate::math::functions::cos;
use glam::DVec2;
use std::f64::consts::TAU;

/// A reconstruction filter.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Filter {
    /// The mean over the pixel's own square: no blur beyond the pixel, exact energy per pixel. The default, because what a
    /// pixel says can then be compared with a measurement of that square.
    #[default]
    Box,
    /// The four-term Blackman-Harris window over a square of 3 × 3 pixels: softer edges, hardly any aliasing.
    BlackmanHarris,
}

/// Half the width of the Blackman-Harris window in pixels.
const BLACKMAN_HARRIS_RADIUS: f64 = 1.5;

/// Cells of the inverse of the window's distribution function.
const TABLE_SIZE: usize = 1024;

/// A filter made ready for sampling.
#[derive(Clone, Debug)]
pub struct FilterSampler {
    /// Quantiles of one coordinate at multiples of 1 / [`TABLE_SIZE`]; empty for the box.
    quantiles: Vec<f64>,
}

impl FilterSampler {
    /// Prepares `filter`.
    #[must_use]
    pub fn new(filter: Filter) -> Self {
        let quantiles = match filter {
            Filter::Box => Vec::new(),
            // The ends are cut a quarter of a cell early: a straight line to the end of the window's thin tail would
            // put too much weight there.
            Filter::BlackmanHarris => (0..=TABLE_SIZE)
                .map(|i| (i as f64).clamp(0.25, TABLE_SIZE as f64 - 0.25))
                .map(|i| quantile(i / TABLE_SIZE as f64))
                .collect(),
        };
        Self { quantiles }
    }

    /// Where a sample falls, in pixels from the pixel's lower corner (0.5 is the centre; it may leave 0..1).
    #[must_use]
    pub fn offset(&self, u: DVec2) -> DVec2 {
        if self.quantiles.is_empty() {
            return u;
        }
        DVec2::new(self.coordinate(u.x), self.coordinate(u.y)) + DVec2::splat(0.5)
    }

    fn coordinate(&self, u: f64) -> f64 {
        let at = u * TABLE_SIZE as f64;
        let cell = (at as usize).min(TABLE_SIZE - 1);
        let t = at - cell as f64;
        self.quantiles[cell] * (1.0 - t) + self.quantiles[cell + 1] * t
    }
}

/// The offset that a share `u` of the Blackman-Harris window lies below, in pixels from its centre, by bisection.
fn quantile(u: f64) -> f64 {
    let (mut low, mut high) = (0.0, 1.0);
    for _ in 0..60 {
        let middle = 0.5 * (low + high);
        if distribution(middle) < u {
            low = middle;
        } else {
            high = middle;
        }
    }
    BLACKMAN_HARRIS_RADIUS * (low + high - 1.0)
}

/// Share of the Blackman-Harris window below the fraction `x` of its width ([Harris1978](crate::references#harris1978),
/// minimum 4-term window, integrated term by term).
fn distribution(x: f64) -> f64 {
    const A: [f64; 4] = [0.358_75, 0.488_29, 0.141_28, 0.011_68];
    let sin = |k: f64| cos(TAU * k * x - 0.25 * TAU) / (TAU * k);
    (A[0] * x - A[1] * sin(1.0) + A[2] * sin(2.0) - A[3] * sin(3.0)) / A[0]
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn box_is_the_identity() {
        let u = DVec2::new(0.2, 0.9);
        assert_eq!(FilterSampler::new(Filter::Box).offset(u), u);
    }

    #[test]
    fn blackman_harris_is_centred_symmetric_and_bounded() {
        let filter = FilterSampler::new(Filter::BlackmanHarris);
        let x = |u: f64| filter.offset(DVec2::splat(u)).x - 0.5;
        assert!(x(0.5).abs() < 1e-9);
        let mut second_moment = 0.0;
        for i in 0..1000 {
            let u = (f64::from(i) + 0.5) / 1000.0;
            assert!((x(u) + x(1.0 - u)).abs() < 1e-9, "{u}");
            assert!(x(u).abs() <= 1.5);
            second_moment += x(u) * x(u) / 1000.0;
        }
        // Numerically integrated variance of the window on ±1.5.
        let window = |t: f64| {
            let angle = TAU * (t / 3.0 + 0.5);
            0.35875 - 0.48829 * angle.cos() + 0.14128 * (2.0 * angle).cos()
                - 0.01168 * (3.0 * angle).cos()
        };
        let (mut total, mut moment) = (0.0, 0.0);
        for i in 0..30_000 {
            let t = (f64::from(i) + 0.5) / 10_000.0 - 1.5;
            total += window(t);
            moment += t * t * window(t);
        }
        assert!(
            (second_moment / (moment / total) - 1.0).abs() < 0.01,
            "{second_moment}"
        );
    }
}
