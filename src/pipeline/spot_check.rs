//! How wrong a picture is, noise and bias together, found without a reference picture: a few of its pixels are path traced.
//!
//! Let `x` be the luminance of a pixel as the picture has it, `r` the true one, and `a`, `b` two estimates of `r` by path tracing that
//! are independent of each other and of `x`. Then
//!
//! ```text
//! E (x - a)(x - b) = (x - r)²
//! ```
//!
//! whatever the noise of `a` and `b`: a few thousand samples tell the error of a whole picture. The mean over pixels that are drawn evenly
//! (one at random in each cell of a grid) is an unbiased estimate of the mean over all pixels.
//!
//! # What the squares are relative to
//! Each is divided by `s² + ε`, `ε = 0.01 · mean²`, as [`crate::film::ErrorEstimate`] does: `s` is the picture's own `x`. Were it an
//! estimate of `r` by the same `a` and `b`, it would be small where their product is, and the mean would be off by about `1.5 (σ/r)⁴` for
//! a noise σ of each: as much as the error itself where that is a few per cent. Only where the picture has less than half of the light
//! that `a` and `b` found is `s` their mean, and where it has far more, `s` is bounded: a pixel a million times too bright would otherwise
//! be wrong by all of itself, which is 1. In the dark `x` as a measure would make any error of dark pixels look enormous, and the noise
//! of `a` and `b` no longer decides.
//!
//! All that asks the samples what is bright. Where few of them find any light (behind a door that is ajar, most pixels have none, and some a
//! hundred times theirs), each pixel is measured by the picture alone: were those with a lucky sample measured by it, the others, which
//! seem to lack all, would not be made up for, and the error of a good picture was seen to be told three times as large as it was.
//!
//! A pixel that is far too bright (a firefly, the edge of a thin lamp) counts as wrong by 100 % at most, here as in
//! [`crate::film::ErrorEstimate`]: measured by the truth it would be many times that, but nothing that is known of it tells how many.
//!
//! # Why this and not two radii or two meshes
//! To judge a photon map by a second radius, or radiosity by a coarser mesh, sees one kind of bias each and needs as much time again.
//! This sees all of them (blur, leaks, lost bounces, light left out), the same way for every method, for about a thirtieth of the time of
//! the picture. It sees only what the path tracer finds: where [that lacks light](crate::integrator::Integrator::shortcomings), it must
//! not be asked. An error in very few pixels is likely to be missed; the interval does not know of pixels that were not drawn.

use super::report::{Covers, PictureError, Z_95};
use crate::camera::Camera;
use crate::film::{Film, LinearImage, Pixel};
use crate::integrator::driver::{FilmSettings, Spot, render_spots};
use crate::integrator::{RadianceEstimator, RayCounts, RenderContext, RenderError};
use crate::math::rng;
use crate::math::tolerance::DARK_PIXEL_FLOOR;
use std::ops::Range;

/// Pixels that are looked at, about.
pub const SPOTS: u32 = 1024;
/// Samples of each estimate of a pixel: at least, and at most.
const SAMPLES_OF_HALF: Range<u32> = 8..512;
/// A check takes a sample for so many of the picture.
const PICTURE_SAMPLES: u64 = 32;
/// Keeps the random numbers of a check apart from those of pictures.
const CHECK: u64 = 0x0063_6865_636b;
/// Where a picture has less than this part of the light, its error is relative to the light.
const MOSTLY_MISSING: f64 = 0.5;
/// Where it has more than so many times the light, and more than the mean, it is relative to that: light that is not there does not make
/// itself small.
const FAR_TOO_MUCH: f64 = 8.0;
/// Halves of a pixel that differ by more than this part of their sum do not tell how bright it is, and of so many pixels with light at least
/// that must be true for all to be measured by the picture alone.
const TORN: f64 = 0.5;
const VAGUE: f64 = 0.25;

/// Some pixels of a picture, drawn evenly, with independent samples.
#[derive(Clone, Debug, PartialEq)]
pub struct Spots {
    /// The pixels.
    pub pixels: Vec<Spot>,
    /// How many pixels of the picture each stands for.
    weights: Vec<f64>,
    /// Samples that each has.
    samples: u32,
}

/// An estimate of a mean squared relative error, or of a part of one.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct SquaredError {
    /// The estimate; by chance it may be negative.
    pub mean: f64,
    /// Its standard error.
    pub standard_error: f64,
}

/// The seed of the samples of a check of a picture with this seed; checks that must not know of each other have different numbers.
#[must_use]
pub fn seed(picture: u64, which: u64) -> u64 {
    rng::hash(&[picture, CHECK, which])
}

/// Samples of each of the two estimates of each pixel in a check of a picture of so many samples: a power of two.
#[must_use]
pub fn samples_of_half(picture_samples: u64) -> u32 {
    let affordable = picture_samples / PICTURE_SAMPLES / u64::from(2 * SPOTS);
    let affordable = u32::try_from(affordable).unwrap_or(u32::MAX);
    let n = affordable.clamp(SAMPLES_OF_HALF.start, SAMPLES_OF_HALF.end);
    1 << n.ilog2()
}

/// Path-traced samples of the check of a picture, at most: so many in any case, and so many for each sample of the picture.
#[must_use]
pub fn share_of_samples() -> (f64, f64) {
    let fewest = 2 * SPOTS * SAMPLES_OF_HALF.start;
    (f64::from(fewest), 1.0 / PICTURE_SAMPLES as f64)
}

impl Spots {
    /// Draws about `most` pixels, at least 1, of a picture of this size; all, if it has no more.
    #[must_use]
    pub fn draw((width, height): (u32, u32), most: u32, seed: u64) -> Self {
        let (w, h) = (f64::from(width), f64::from(height));
        let columns = (f64::from(most) * w / h.max(1.0)).sqrt().round() as u32;
        let columns = columns.clamp(1, width.max(1)).min(most.max(1));
        let rows = (most / columns).clamp(1, height.max(1));
        // Products of 32-bit numbers; the quotient is at most the size.
        let edge = |i: u32, n: u32, size: u32| {
            u32::try_from(u64::from(i) * u64::from(size) / u64::from(n)).unwrap_or(size)
        };
        let mut spots = Self {
            pixels: Vec::new(),
            weights: Vec::new(),
            samples: 0,
        };
        for row in 0..rows {
            for column in 0..columns {
                let xs = edge(column, columns, width)..edge(column + 1, columns, width);
                let ys = edge(row, rows, height)..edge(row + 1, rows, height);
                let place = |range: &Range<u32>, axis: u64| {
                    let bits = rng::hash(&[seed, u64::from(column), u64::from(row), axis]);
                    let n = range.end - range.start;
                    let offset = (rng::unit_f64(bits) * f64::from(n)) as u32;
                    range.start + offset.min(n.saturating_sub(1))
                };
                if xs.is_empty() || ys.is_empty() {
                    continue;
                }
                spots.pixels.push(Spot {
                    x: place(&xs, 0),
                    y: place(&ys, 1),
                    pixel: Pixel::default(),
                });
                let area = u64::from(xs.end - xs.start) * u64::from(ys.end - ys.start);
                spots.weights.push(area as f64);
            }
        }
        spots
    }

    /// The same pixels, without samples.
    #[must_use]
    pub fn emptied(&self) -> Self {
        let mut spots = self.clone();
        for spot in &mut spots.pixels {
            spot.pixel = Pixel::default();
        }
        spots.samples = 0;
        spots
    }

    /// The same pixels as a film has them.
    ///
    /// # Panics
    /// If the film is not of the size for which they were drawn.
    #[must_use]
    pub fn of_film(&self, film: &Film) -> Self {
        let mut spots = self.clone();
        for spot in &mut spots.pixels {
            spot.pixel = *film.pixel(spot.x, spot.y);
        }
        spots
    }

    /// Samples that each pixel has.
    #[must_use]
    pub fn samples(&self) -> u32 {
        self.samples
    }

    /// Adds samples to each pixel until it has so many.
    ///
    /// # Errors
    /// [`RenderError::Cancelled`].
    pub fn sample(
        &mut self,
        estimator: &dyn RadianceEstimator,
        camera: &Camera,
        settings: &FilmSettings,
        samples: u32,
        context: &RenderContext<'_>,
    ) -> Result<RayCounts, RenderError> {
        let range = self.samples..samples.max(self.samples);
        let spots = (&mut self.pixels[..], range);
        let rays = render_spots(estimator, camera, settings, spots, context)?;
        self.samples = samples.max(self.samples);
        Ok(rays)
    }

    /// Error of a picture whose pixels at these spots have the luminances `picture`, one for each, if these samples are of the truth.
    #[must_use]
    pub fn error_of(&self, picture: &[f64]) -> SquaredError {
        let truth = |spot: &Spot| spot.pixel.mean().luminance();
        let mean = self.mean(self.pixels.iter().map(truth));
        let seen = self.mean(picture.iter().copied());
        // Where the samples found no light at all there is only what the picture claims.
        let floor = self.floor(if mean > 0.0 { mean } else { seen });
        let is_vague = self.is_vague();
        let squares = self.pixels.iter().zip(picture).map(|(spot, x)| {
            let [a, b] = spot.pixel.halves.map(|half| half.mean().luminance());
            let found = truth(spot);
            let most = FAR_TOO_MUCH * found + mean;
            let measure = if is_vague {
                *x
            } else if *x < MOSTLY_MISSING * found {
                found
            } else if *x > most && mean > 0.0 {
                most
            } else {
                *x
            };
            let scale = measure * measure + floor;
            // A black picture of a black scene is exactly right, not 0/0.
            if scale > 0.0 {
                (x - a) * (x - b) / scale
            } else {
                0.0
            }
        });
        self.estimate(squares)
    }

    /// Whether the samples found light so seldom that it does not tell where there is some: of the pixels with light, many have it in one
    /// half only.
    fn is_vague(&self) -> bool {
        let halves = |spot: &Spot| spot.pixel.halves.map(|half| half.mean().luminance());
        let lit = self.pixels.iter().map(halves).filter(|[a, b]| a + b > 0.0);
        let (mut n, mut n_torn) = (0_u32, 0_u32);
        for [a, b] in lit {
            n += 1;
            n_torn += u32::from((a - b).abs() > TORN * (a + b));
        }
        f64::from(n_torn) > VAGUE * f64::from(n)
    }

    /// Error of the picture at these spots.
    ///
    /// # Panics
    /// If the picture is not of the size for which they were drawn.
    #[must_use]
    pub fn error_of_image(&self, image: &LinearImage) -> SquaredError {
        let width = image.width as usize;
        let luminance = |spot: &Spot| {
            let index = spot.y as usize * width + spot.x as usize;
            image.pixels[index].luminance()
        };
        let picture: Vec<f64> = self.pixels.iter().map(luminance).collect();
        self.error_of(&picture)
    }

    /// Mean squared relative noise of these samples themselves, from the difference of their halves.
    #[must_use]
    pub fn noise(&self) -> SquaredError {
        let luminances = self.luminances();
        let floor = self.floor(self.mean(luminances.iter().copied()));
        let squares = self.pixels.iter().zip(&luminances).map(|(spot, x)| {
            let scale = x * x + floor;
            let variance = spot.pixel.variance().unwrap_or(0.0);
            if scale > 0.0 { variance / scale } else { 0.0 }
        });
        self.estimate(squares)
    }

    /// Standard error of [`Self::error_of`] by the noise of these samples alone: that of a picture without any error. From the fourth power
    /// of what the halves differ by, which is 12 times what is looked for if noise is normal, and more than that if few samples are very
    /// bright: then this is too large rather than too small.
    #[must_use]
    pub fn judge_error(&self) -> f64 {
        let luminances = self.luminances();
        let floor = self.floor(self.mean(luminances.iter().copied()));
        let total: f64 = self.weights.iter().sum();
        let each = self.pixels.iter().zip(&luminances).zip(&self.weights);
        let fourth = each.map(|((spot, x), weight)| {
            let scale = x * x + floor;
            // A quarter of the squared difference.
            let variance = spot.pixel.variance().unwrap_or(0.0);
            let relative = if scale > 0.0 { variance / scale } else { 0.0 };
            (weight * relative).powi(2) * 16.0 / 12.0
        });
        let sum: f64 = fourth.sum();
        if total > 0.0 { sum.sqrt() / total } else { 0.0 }
    }

    /// Luminance of each pixel.
    #[must_use]
    pub fn luminances(&self) -> Vec<f64> {
        let of = |spot: &Spot| spot.pixel.mean().luminance();
        self.pixels.iter().map(of).collect()
    }

    fn floor(&self, mean: f64) -> f64 {
        DARK_PIXEL_FLOOR * mean * mean
    }

    fn mean(&self, values: impl Iterator<Item = f64>) -> f64 {
        let total: f64 = self.weights.iter().sum();
        let sum: f64 = self.weights.iter().zip(values).map(|(w, v)| w * v).sum();
        if total > 0.0 { sum / total } else { 0.0 }
    }

    /// The mean over the picture of what these are the values of at the spots. That one was drawn in each cell makes it surer than this
    /// tells: the standard error is that of spots without cells.
    fn estimate(&self, values: impl Iterator<Item = f64>) -> SquaredError {
        let values: Vec<f64> = values.collect();
        let mean = self.mean(values.iter().copied());
        let total: f64 = self.weights.iter().sum();
        let n = values.len() as f64;
        let spread: f64 = self
            .weights
            .iter()
            .zip(&values)
            .map(|(w, v)| (w * (v - mean)).powi(2))
            .sum();
        let standard_error = if total > 0.0 {
            (spread * n / (n - 1.0).max(1.0)).sqrt() / total
        } else {
            0.0
        };
        SquaredError {
            mean,
            standard_error,
        }
    }
}

impl SquaredError {
    /// The error itself, with the interval that holds it with 95 % probability.
    #[must_use]
    pub fn root(self) -> PictureError {
        let reach = Z_95 * self.standard_error;
        let root = |squared: f64| squared.max(0.0).sqrt();
        PictureError {
            relative: root(self.mean),
            low: root(self.mean - reach),
            high: root(self.mean + reach),
            covers: Covers::NoiseAndBias,
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::color::Rgb;

    /// The truth of [`planted`], with a range of brightness of a hundred.
    fn truth(x: u32, y: u32) -> f64 {
        0.02 + 2.0 * f64::from((7 * x + 13 * y) % 101) / 101.0
    }

    /// Spots with noise of a relative size that is large beside the errors that are looked for.
    fn planted(size: (u32, u32), seed: u64) -> Spots {
        let mut spots = Spots::draw(size, SPOTS, seed);
        for (i, spot) in (0..).zip(&mut spots.pixels) {
            for sample in 0..64 {
                let u = rng::unit_f64(rng::hash(&[seed, i, u64::from(sample), 9]));
                // Mean 1, standard deviation 1.41.
                let noise = if u < 1.0 / 3.0 { 3.0 } else { 0.0 };
                spot.pixel
                    .add(sample, Rgb::splat(noise * truth(spot.x, spot.y)));
            }
        }
        spots
    }

    /// A picture of this relative bias.
    fn biased((width, height): (u32, u32), bias: f64) -> LinearImage {
        let rows = (0..height).flat_map(|y| (0..width).map(move |x| (x, y)));
        LinearImage {
            width,
            height,
            pixels: rows
                .map(|(x, y)| Rgb::splat((1.0 + bias) * truth(x, y)))
                .collect(),
        }
    }

    /// The truth by the definition.
    fn squared_error((width, height): (u32, u32), bias: f64) -> f64 {
        let image = biased((width, height), bias);
        let n = image.pixels.len() as f64;
        let mean = image.pixels.iter().map(|p| p.luminance()).sum::<f64>() / n / (1.0 + bias);
        let floor = DARK_PIXEL_FLOOR * mean * mean;
        let square = |p: &Rgb| {
            let x = p.luminance();
            (x - x / (1.0 + bias)).powi(2) / (x * x + floor)
        };
        image.pixels.iter().map(square).sum::<f64>() / n
    }

    /// Light that one sample in a hundred finds: most pixels have none, some a dozen times theirs. A right picture is told to be right within
    /// three standard errors (of 100 runs three may fail at most: once in 10⁴). Measured by the lucky samples it would be wrong by 80 %.
    #[test]
    fn light_that_is_seldom_found_is_not_held_against_a_picture() {
        let size = (60, 60);
        let n_wrong = (0..100)
            .filter(|seed| {
                let mut spots = Spots::draw(size, SPOTS, *seed);
                for (i, spot) in (0..).zip(&mut spots.pixels) {
                    for sample in 0..16 {
                        let u = rng::unit_f64(rng::hash(&[*seed, i, u64::from(sample), 5]));
                        let light = if u < 0.01 { 100.0 } else { 0.0 };
                        spot.pixel.add(sample, Rgb::splat(light));
                    }
                }
                let right = vec![1.0; spots.pixels.len()];
                let error = spots.error_of(&right);
                error.mean.abs() > 3.0 * error.standard_error
            })
            .count();
        assert!(n_wrong <= 3, "{n_wrong}");
    }

    #[test]
    fn spots_cover_the_picture_evenly_and_all_of_a_small_one() {
        for size in [(64, 48), (1, 1), (3, 1000), (1000, 3), (960, 640), (7, 5)] {
            let spots = Spots::draw(size, SPOTS, 1);
            let total: f64 = spots.weights.iter().sum();
            assert_eq!(total, f64::from(size.0) * f64::from(size.1), "{size:?}");
            assert!(spots.pixels.len() <= SPOTS as usize);
            assert!(spots.pixels.iter().all(|s| s.x < size.0 && s.y < size.1));
            assert_ne!(spots, Spots::draw(size, SPOTS, 2).clone_unless(size));
        }
        assert_eq!(Spots::draw((7, 5), SPOTS, 1).pixels.len(), 35);
        assert!(Spots::draw((960, 640), SPOTS, 1).pixels.len() > 950);
        assert_eq!(Spots::draw((0, 5), SPOTS, 1).pixels.len(), 0);
    }

    impl Spots {
        /// Itself, unless all pixels of a picture of this size are spots: then nothing.
        fn clone_unless(mut self, (width, height): (u32, u32)) -> Self {
            if width * height <= SPOTS {
                self.pixels.clear();
            }
            self
        }
    }

    /// Pixels a million times too bright do not hide behind themselves, nor raise the floor for all others.
    #[test]
    fn light_that_is_not_there_is_an_enormous_error() {
        let size = (90, 60);
        let mut image = biased(size, 0.0);
        for pixel in image.pixels.iter_mut().step_by(20) {
            *pixel *= 1e6;
        }
        let found = planted(size, 3).error_of_image(&image);
        assert!(found.mean > 1e6, "{found:?}");
    }

    /// Unbiased: the mean of 200 checks meets the error within 4 standard errors of that mean (chance to fail by itself: 6e-5 each),
    /// for no bias, a small and a large one. It fails if the scale is taken from the noisy samples (off by 10 % and more), and if the
    /// square of the difference to the mean of `a` and `b` is taken (off by the variance, 0.03).
    #[test]
    fn the_mean_of_many_checks_is_the_error() {
        let size = (90, 60);
        for bias in [0.0, 0.05, 0.6] {
            let image = biased(size, bias);
            let mut stats = crate::math::stats::RunningStats::default();
            for seed in 0..200 {
                stats.push(planted(size, seed).error_of_image(&image).mean);
            }
            let expected = squared_error(size, bias);
            let off = (stats.mean() - expected).abs();
            assert!(
                off < 4.0 * stats.standard_error(),
                "{bias}: {} ± {}, not {expected}",
                stats.mean(),
                stats.standard_error()
            );
        }
    }

    /// The interval holds the error in 95 % of cases: of 200, at least 178 (chance to fail by itself below 1e-3), and it is no wider than
    /// it must be: not in more than 199.
    #[test]
    fn the_interval_holds_the_error_as_often_as_it_says() {
        let size = (90, 60);
        let (image, expected) = (biased(size, 0.2), squared_error(size, 0.2).sqrt());
        let holds = |seed: &u64| {
            let error = planted(size, *seed).error_of_image(&image).root();
            (error.low..=error.high).contains(&expected)
        };
        let n = (0..200).filter(holds).count();
        assert!((178..200).contains(&n), "{n} of 200");
    }

    #[test]
    fn a_planted_bias_is_seen_and_none_is_not() {
        let size = (90, 60);
        let seen = planted(size, 3).error_of_image(&biased(size, 0.3)).root();
        assert!(seen.low > 0.15 && seen.high < 0.35, "{seen:?}");
        let none = planted(size, 3).error_of_image(&biased(size, 0.0)).root();
        assert!(none.low == 0.0 && none.high < 0.1, "{none:?}");
    }

    #[test]
    fn missing_light_is_an_error_of_its_own_size_and_black_is_exact() {
        let size = (60, 60);
        let black = LinearImage {
            pixels: vec![Rgb::BLACK; 3600],
            ..biased(size, 0.0)
        };
        let error = planted(size, 5).error_of_image(&black).root();
        assert!((0.8..1.2).contains(&error.relative), "{error:?}");
        let dark = Spots::draw(size, SPOTS, 1).error_of_image(&black);
        assert_eq!(dark, SquaredError::default());
        let nothing = LinearImage::default();
        assert_eq!(
            Spots::draw((0, 0), SPOTS, 1).error_of_image(&nothing),
            SquaredError::default()
        );
    }

    #[test]
    fn noise_is_that_of_the_samples() {
        let noise = planted((90, 60), 8).noise();
        // 2 / 64, less what dark pixels are spared.
        assert!((0.02..0.04).contains(&noise.mean), "{noise:?}");
    }

    /// Of a picture that is exactly right, 200 checks differ by what one says, within 20 % (the chance that they do not is below 1e-3).
    #[test]
    fn noise_of_the_truth_is_told_apart() {
        let size = (90, 60);
        let image = biased(size, 0.0);
        let mut stats = crate::math::stats::RunningStats::default();
        for seed in 0..200 {
            stats.push(planted(size, seed).error_of_image(&image).mean);
        }
        let told = planted(size, 777).judge_error();
        let ratio = told / stats.variance().sqrt();
        assert!((0.8..1.25).contains(&ratio), "{ratio}");
    }

    #[test]
    fn larger_pictures_are_checked_with_more_samples() {
        assert_eq!(samples_of_half(0), 8);
        assert_eq!(samples_of_half(960 * 640 * 16), 128);
        assert_eq!(samples_of_half(u64::MAX), 512);
    }
}
