//! How exact a picture is, judged from the picture alone.

use super::Film;
use crate::math::tolerance::DARK_PIXEL_FLOOR;

/// Estimated noise of a whole picture.
///
/// Only noise: a method's bias and light that no sample has found yet do not show.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct ErrorEstimate {
    /// Root mean square of the pixels' relative errors of luminance; 0.02 means "2 %".
    ///
    /// √ of the mean over pixels of variance / (L² + ε), ε = 0.01 · (mean L)², so that black pixels do not divide by 0.
    pub relative: f64,
    /// Standard error of `relative` itself.
    pub uncertainty: f64,
}

impl ErrorEstimate {
    pub(super) fn of(film: &Film) -> Option<Self> {
        let n_pixels = film.all_pixels().count();
        if n_pixels == 0 {
            return None;
        }
        let mean = film.all_pixels().map(|p| p.mean().luminance()).sum::<f64>() / n_pixels as f64;
        let floor = DARK_PIXEL_FLOOR * mean * mean;

        // Mean squared relative error of each tile. Tiles are the blocks whose spread tells how far to trust the mean.
        let mut blocks = Vec::with_capacity(film.tiles().len());
        let mut fourth = 0.0;
        for tile in film.tiles() {
            let mut sum = 0.0;
            for pixel in &tile.pixels {
                let luminance = pixel.mean().luminance();
                let variance = pixel.variance()?;
                let scale = luminance * luminance + floor;
                // A black picture is exactly black: no error, not 0/0.
                let relative = if scale > 0.0 { variance / scale } else { 0.0 };
                sum += relative;
                fourth += relative * relative;
            }
            blocks.push((sum, tile.pixels.len() as f64));
        }

        let squared = blocks.iter().map(|(sum, _)| sum).sum::<f64>() / n_pixels as f64;
        let relative = squared.sqrt();
        // Ratio estimator over blocks of unequal size; d√s = ds / 2√s.
        let n = blocks.len() as f64;
        let mean_size = n_pixels as f64 / n;
        let spread = blocks
            .iter()
            .map(|(sum, size)| (sum - squared * size).powi(2))
            .sum::<f64>();
        let by_blocks = (spread / (n * (n - 1.0).max(1.0))).sqrt() / mean_size;
        // Each pixel's variance is known from one difference of two halves: a square of a normal number, whose own variance is two thirds of
        // its second moment. Small pictures have few tiles, the smallest a single one, whose spread tells nothing.
        let by_pixels = (2.0 / 3.0 * fourth).sqrt() / n_pixels as f64;
        let squared_error = by_blocks.max(by_pixels);
        let uncertainty = if relative > 0.0 {
            0.5 * squared_error / relative
        } else {
            0.0
        };
        Some(Self {
            relative,
            uncertainty,
        })
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::color::Rgb;
    use crate::math::rng;

    /// A film of uniform noise 0..2 (mean 1, standard deviation 1/√3) with `n` samples per pixel.
    fn noise(n: u32) -> Film {
        noise_of((100, 60), n, 0)
    }

    fn noise_of((width, height): (u32, u32), n: u32, seed: u64) -> Film {
        let mut film = Film::new(width, height);
        for (t, tile) in (0..).zip(film.tiles_mut()) {
            for (p, pixel) in (0..).zip(&mut tile.pixels) {
                for i in 0..n {
                    let u = rng::unit_f64(rng::hash(&[seed, t, p, u64::from(i)]));
                    pixel.add(i, Rgb::splat(2.0 * u));
                }
            }
        }
        film
    }

    #[test]
    fn noise_of_known_size_is_found() {
        for n in [64, 256, 257] {
            let estimate = noise(n).error_estimate().unwrap();
            let truth = (1.0 / 3.0 / f64::from(n)).sqrt() / 1.01_f64.sqrt();
            let off = (estimate.relative - truth).abs();
            assert!(
                off < 4.0 * estimate.uncertainty + 0.005 * truth,
                "{n}: {estimate:?} {truth}"
            );
            assert!(estimate.uncertainty < 0.05 * truth);
        }
    }

    /// A picture within one tile, and one of a single pixel, say how far their error is known: by how much it scatters from seed to seed. 400
    /// seeds know that to 4 %; a single pixel is known from one number, whose square root is no normal one. An uncertainty by tiles alone is 0.
    #[test]
    fn small_films_know_how_little_they_know() {
        for (size, range) in [((12, 10), 0.85..1.15), ((1, 1), 0.5..1.5)] {
            let seeds = 0..400;
            let found = seeds.map(|seed| noise_of(size, 64, seed).error_estimate().unwrap());
            let found: Vec<ErrorEstimate> = found.collect();
            let n = found.len() as f64;
            let mean = found.iter().map(|e| e.relative).sum::<f64>() / n;
            let spread = found.iter().map(|e| (e.relative - mean).powi(2));
            let scatter = (spread.sum::<f64>() / (n - 1.0)).sqrt();
            let told = found.iter().map(|e| e.uncertainty).sum::<f64>() / n;
            assert!(
                range.contains(&(told / scatter)),
                "{size:?}: {told} {scatter}"
            );
        }
    }

    #[test]
    fn black_and_empty_films_have_no_error_and_no_nan() {
        let mut film = Film::new(20, 20);
        assert_eq!(film.error_estimate(), None);
        for tile in film.tiles_mut() {
            for pixel in &mut tile.pixels {
                pixel.add(0, Rgb::BLACK);
                pixel.add(1, Rgb::BLACK);
            }
        }
        let expected = ErrorEstimate {
            relative: 0.0,
            uncertainty: 0.0,
        };
        assert_eq!(film.error_estimate(), Some(expected));
        assert_eq!(Film::new(0, 0).error_estimate(), None);
    }
}
