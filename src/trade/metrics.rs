//! How far pictures are from the truth, when the truth is known only with noise.
//!
//! Errors are of luminance and relative: divided by r² + ε with r the truth and ε = 0.01 · (mean r)², so that what is dark counts
//! less than what is black divides by 0; the same measure as [`ErrorEstimate`](crate::film::ErrorEstimate). Its root is what people
//! read as "2 %".
//!
//! The truth is a [`Truth`]: two independent pictures a and b without bias. (x - a)(x - b) has the mean (x - truth)², whatever the
//! noise of a and b: the reference's own noise makes an error uncertain, not too large (but for what it is divided by: by about three
//! times the relative squared noise of the reference, which is small long before it matters).

use crate::color::Rgb;
use crate::film::LinearImage;
use crate::math::stats::RunningStats;
use crate::math::tolerance::DARK_PIXEL_FLOOR;

/// Part of the pixels that is left out of errors, those with the largest ones: single fireflies, which would decide everything.
/// Their error is told beside it ([`Decomposition::error_of_all`]).
pub const WORST: f64 = 0.001;

/// Two independent pictures, both without bias.
#[derive(Clone, Debug, PartialEq)]
pub struct Truth {
    a: Vec<f64>,
    b: Vec<f64>,
    /// What squared errors of each pixel are divided by; 1 where all is black.
    scale: Vec<f64>,
    mean: f64,
}

/// The error of a setting, split.
///
/// All of relative squared luminance.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Decomposition {
    /// Mean of the error over seeds, without the worst pixels.
    pub error: f64,
    /// Standard error of `error`, from its spread over seeds; 0 of one seed.
    pub error_deviation: f64,
    /// Mean of the error with all pixels: what theories speak of.
    pub error_of_all: f64,
    /// The part of `error_of_all` that changes from seed to seed; 0 of one seed.
    pub variance: f64,
    /// The part that does not. Of a method without bias it scatters about 0, and so may be negative.
    pub bias_squared: f64,
}

/// How far a sum of light is from the truth.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Excess {
    /// (found - true) / true.
    pub relative: f64,
    /// Its standard error from its spread over seeds and the reference's two halves.
    pub deviation: f64,
}

impl Truth {
    /// The truth that these two pictures of the same size tell.
    ///
    /// # Panics
    /// If they are not of the same size.
    #[must_use]
    pub fn new(a: &LinearImage, b: &LinearImage) -> Self {
        assert_eq!(
            (a.width, a.height),
            (b.width, b.height),
            "invariant: references are of one size"
        );
        let (a, b) = (luminance(a), luminance(b));
        let means = a.iter().zip(&b).map(|(a, b)| 0.5 * (a + b));
        let means: Vec<f64> = means.collect();
        let mean = mean_of(means.iter().copied());
        let floor = DARK_PIXEL_FLOOR * mean * mean;
        let scale = means.iter().map(|r| r * r + floor);
        let scale = scale.map(|scale| if scale > 0.0 { scale } else { 1.0 });
        Self {
            scale: scale.collect(),
            a,
            b,
            mean,
        }
    }

    /// Relative squared noise of the mean of both pictures.
    #[must_use]
    pub fn noise(&self) -> f64 {
        let squared = self.a.iter().zip(&self.b).zip(&self.scale);
        let squared = squared.map(|((a, b), scale)| 0.25 * (a - b) * (a - b) / scale);
        trimmed(squared.collect())
    }

    /// The errors of pictures that differ in their random numbers only.
    #[must_use]
    pub fn decompose(&self, seeds: &[LinearImage]) -> Decomposition {
        let seeds: Vec<Vec<f64>> = seeds.iter().map(luminance).collect();
        if seeds.is_empty() {
            return Decomposition::default();
        }
        let n = self.a.len();
        let error_of = |found: &[f64], at: usize| {
            (found[at] - self.a[at]) * (found[at] - self.b[at]) / self.scale[at]
        };
        let pixels: Vec<f64> = (0..n)
            .map(|at| mean_of(seeds.iter().map(|found| error_of(found, at))))
            .collect();
        let kept = without_worst(&pixels);
        let stats: RunningStats = seeds
            .iter()
            .map(|found| mean_of(kept.iter().map(|&at| error_of(found, at))))
            .collect();
        let variance = mean_of((0..n).map(|at| {
            let values: RunningStats = seeds.iter().map(|found| found[at]).collect();
            values.variance() / self.scale[at]
        }));
        let error_of_all = mean_of(pixels.iter().copied());
        Decomposition {
            error: stats.mean(),
            error_deviation: stats.standard_error(),
            error_of_all,
            variance,
            bias_squared: error_of_all - variance,
        }
    }

    /// How much more light the pictures hold than is true, in the pixels for which `is_meant` says so; `None` if there should be none.
    #[must_use]
    pub fn excess(
        &self,
        seeds: &[LinearImage],
        is_meant: &dyn Fn(usize) -> bool,
    ) -> Option<Excess> {
        let sum = |values: &dyn Fn(usize) -> f64| -> f64 {
            (0..self.a.len())
                .filter(|&at| is_meant(at))
                .map(values)
                .sum()
        };
        let (a, b) = (sum(&|at| self.a[at]), sum(&|at| self.b[at]));
        let truth = 0.5 * (a + b);
        if truth <= 0.0 {
            return None;
        }
        let found: RunningStats = seeds
            .iter()
            .map(|image| sum(&|at| image.pixels[at].luminance()) / truth)
            .collect();
        let own = 0.5 * (a - b) / truth;
        Some(Excess {
            relative: found.mean() - 1.0,
            deviation: found.standard_error().hypot(own),
        })
    }

    /// Mean luminance.
    #[must_use]
    pub const fn mean(&self) -> f64 {
        self.mean
    }
}

/// The mean of pictures of the same size; `None` of none.
#[must_use]
pub fn mean_image(images: &[LinearImage]) -> Option<LinearImage> {
    let first = images.first()?;
    let n = images.len() as f64;
    let mean = |at: usize| {
        let sum = images
            .iter()
            .map(|image| image.pixels[at])
            .fold(Rgb::BLACK, |sum, pixel| sum + pixel);
        sum / n
    };
    Some(LinearImage {
        width: first.width,
        height: first.height,
        pixels: (0..first.pixels.len()).map(mean).collect(),
    })
}

fn luminance(image: &LinearImage) -> Vec<f64> {
    image.pixels.iter().map(|pixel| pixel.luminance()).collect()
}

/// Their mean; 0 of none.
fn mean_of(values: impl Iterator<Item = f64>) -> f64 {
    let (sum, n) = values.fold((0.0, 0.0), |(sum, n), value| (sum + value, n + 1.0));
    if n > 0.0 { sum / n } else { 0.0 }
}

/// Which values are not among the worst, in order.
fn without_worst(values: &[f64]) -> Vec<usize> {
    let mut order: Vec<usize> = (0..values.len()).collect();
    order.sort_by(|&i, &j| values[i].abs().total_cmp(&values[j].abs()).then(i.cmp(&j)));
    order.truncate(values.len() - (WORST * values.len() as f64) as usize);
    order.sort_unstable();
    order
}

fn trimmed(values: Vec<f64>) -> f64 {
    mean_of(without_worst(&values).into_iter().map(|at| values[at]))
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::math::rng;

    const SIZE: u32 = 64;

    /// A ramp of gray with noise of this standard deviation and an error of this size everywhere.
    fn picture(seed: u64, noise: f64, off: f64) -> LinearImage {
        let n = u64::from(SIZE * SIZE);
        let pixel = |at: u64| {
            let uniform = rng::unit_f64(rng::hash(&[seed, at])) - 0.5;
            let truth = 1.0 + (at % u64::from(SIZE)) as f64 / f64::from(SIZE);
            Rgb::splat(truth * (1.0 + off + noise * 12.0_f64.sqrt() * uniform))
        };
        LinearImage {
            width: SIZE,
            height: SIZE,
            pixels: (0..n).map(pixel).collect(),
        }
    }

    fn pictures(first: u64, n: u64, noise: f64, off: f64) -> Vec<LinearImage> {
        (first..first + n)
            .map(|seed| picture(seed, noise, off))
            .collect()
    }

    /// A reference with as much noise as the pictures themselves: its own error does not count. The means over 4096 pixels and 8
    /// seeds have standard errors below 3 % of the variance; 15 % are five of them. A reference that counted would be 50 % off.
    #[test]
    fn errors_are_split_into_bias_and_variance_whatever_the_noise_of_the_reference() {
        let truth = Truth::new(&picture(1, 0.1, 0.0), &picture(2, 0.1, 0.0));
        let found = truth.decompose(&pictures(10, 8, 0.1, 0.0));
        let close = |found: f64, expected: f64| (found - expected).abs() < 0.15 * 0.01;
        assert!(close(found.error, 0.01), "{found:?}");
        assert!(close(found.variance, 0.01) && close(found.bias_squared, 0.0));
        assert!(close(truth.noise(), 0.005));
        // What errors are divided by holds the noise of the reference, which makes large errors larger by a few times its square.
        let truth = Truth::new(&picture(1, 0.03, 0.0), &picture(2, 0.03, 0.0));
        let found = truth.decompose(&pictures(20, 8, 0.1, 0.2));
        assert!(close(found.bias_squared, 0.04), "{found:?}");
        assert!(close(found.variance, 0.01) && close(found.error, 0.05));
    }

    #[test]
    fn sums_of_light_tell_what_is_missing_and_how_sure_that_is() {
        let truth = Truth::new(&picture(1, 0.01, 0.0), &picture(2, 0.01, 0.0));
        let seeds = pictures(10, 4, 0.01, -0.05);
        let all = truth.excess(&seeds, &|_| true).unwrap();
        assert!((all.relative + 0.05).abs() < 5.0 * all.deviation + 1e-9);
        assert!(all.deviation > 0.0 && all.deviation < 0.002, "{all:?}");
        assert_eq!(truth.excess(&seeds, &|_| false), None);
    }

    #[test]
    fn one_firefly_is_left_out_and_told() {
        let truth = Truth::new(&picture(1, 0.0, 0.0), &picture(2, 0.0, 0.0));
        let mut image = picture(3, 0.0, 0.0);
        image.pixels[77] = Rgb::splat(1000.0);
        let found = truth.decompose(&[image]);
        assert_eq!(found.error, 0.0);
        assert!(found.error_of_all > 1.0);
    }

    #[test]
    fn black_pictures_have_no_error() {
        let black = LinearImage {
            width: 2,
            height: 1,
            pixels: vec![Rgb::BLACK; 2],
        };
        let truth = Truth::new(&black, &black);
        assert_eq!(truth.decompose(std::slice::from_ref(&black)).error, 0.0);
        assert_eq!(mean_image(&[black.clone(), black.clone()]), Some(black));
        assert_eq!(mean_image(&[]), None);
    }
}
