//! What the camera has seen so far, in linear light, and how sure we are of it.
//!
//! A [`Film`] adds up samples per pixel in `f64`, in two halves that are scrambled independently: their difference measures
//! the noise of the whole without a reference. [`tone`] turns a finished picture into bytes for a screen.

pub mod contrast;
mod error;
pub mod filter;
pub mod tone;

pub use error::ErrorEstimate;
pub use filter::Filter;

use crate::color::Rgb;

/// Edge of a tile in pixels: one unit of parallel work.
pub const TILE_SIZE: u32 = 16;

/// Sum of the samples of one half of one pixel.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct HalfPixel {
    /// Sum of radiances, W/(m² sr).
    pub sum: Rgb,
    /// How many samples it holds.
    pub n_samples: u32,
}

/// One pixel: two independent halves.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Pixel {
    /// Samples 0, 2, 4 … and samples 1, 3, 5 …
    pub halves: [HalfPixel; 2],
    /// Samples that were NaN or infinite and were left out.
    pub n_rejected: u32,
}

impl HalfPixel {
    /// Mean radiance of this half; black without samples.
    #[must_use]
    pub fn mean(&self) -> Rgb {
        if self.n_samples == 0 {
            Rgb::BLACK
        } else {
            self.sum / f64::from(self.n_samples)
        }
    }
}

impl Pixel {
    /// Adds sample number `index`; a value that is not finite is counted and left out.
    pub fn add(&mut self, index: u32, radiance: Rgb) {
        if !radiance.is_finite() {
            self.n_rejected += 1;
            return;
        }
        let half = &mut self.halves[usize::from(index % 2 == 1)];
        half.sum += radiance;
        half.n_samples += 1;
    }

    /// Mean radiance of all samples; black without samples.
    #[must_use]
    pub fn mean(&self) -> Rgb {
        let [a, b] = self.halves;
        HalfPixel {
            sum: a.sum + b.sum,
            n_samples: a.n_samples + b.n_samples,
        }
        .mean()
    }

    /// Estimated variance of the luminance of [`mean`](Self::mean), from the two halves; `None` unless both hold samples.
    ///
    /// E (A - B)² = σ² (1/a + 1/b) with a, b samples, so the mean's variance σ²/(a + b) is (A - B)² ab / (a + b)².
    #[must_use]
    pub fn variance(&self) -> Option<f64> {
        let [a, b] = self.halves;
        let (n_a, n_b) = (f64::from(a.n_samples), f64::from(b.n_samples));
        let difference = a.mean().luminance() - b.mean().luminance();
        (a.n_samples > 0 && b.n_samples > 0)
            .then(|| difference * difference * n_a * n_b / ((n_a + n_b) * (n_a + n_b)))
    }
}

/// A square part of the film that one task fills alone.
#[derive(Clone, Debug, PartialEq)]
pub struct Tile {
    /// Column of its first pixel.
    pub x: u32,
    /// Row of its first pixel, from the top.
    pub y: u32,
    /// Its width in pixels, at most [`TILE_SIZE`].
    pub width: u32,
    /// Its pixels, row by row.
    pub pixels: Vec<Pixel>,
}

/// The samples of a whole picture, tile by tile.
#[derive(Clone, Debug, PartialEq)]
pub struct Film {
    width: u32,
    height: u32,
    tiles: Vec<Tile>,
}

impl Film {
    /// An empty film of this many pixels.
    #[must_use]
    pub fn new(width: u32, height: u32) -> Self {
        let starts = |size: u32| (0..size).step_by(TILE_SIZE as usize);
        let tiles = starts(height)
            .flat_map(|y| starts(width).map(move |x| (x, y)))
            .map(|(x, y)| {
                let (tile_width, tile_height) =
                    (TILE_SIZE.min(width - x), TILE_SIZE.min(height - y));
                let pixels = vec![Pixel::default(); (tile_width * tile_height) as usize];
                Tile {
                    x,
                    y,
                    width: tile_width,
                    pixels,
                }
            })
            .collect();
        Self {
            width,
            height,
            tiles,
        }
    }

    /// Width in pixels.
    #[must_use]
    pub const fn width(&self) -> u32 {
        self.width
    }

    /// Height in pixels.
    #[must_use]
    pub const fn height(&self) -> u32 {
        self.height
    }

    /// The tiles, in rows from the top left; together they cover every pixel once.
    #[must_use]
    pub fn tiles(&self) -> &[Tile] {
        &self.tiles
    }

    /// The tiles, to be filled.
    pub fn tiles_mut(&mut self) -> &mut [Tile] {
        &mut self.tiles
    }

    /// The pixel in column `x` and row `y` from the top left.
    ///
    /// # Panics
    /// If it lies outside of the film.
    #[must_use]
    pub fn pixel(&self, x: u32, y: u32) -> &Pixel {
        let columns = self.width.div_ceil(TILE_SIZE);
        let tile = &self.tiles[((y / TILE_SIZE) * columns + x / TILE_SIZE) as usize];
        &tile.pixels[((y % TILE_SIZE) * tile.width + x % TILE_SIZE) as usize]
    }

    /// Mean radiance of each pixel.
    #[must_use]
    pub fn image(&self) -> LinearImage {
        self.image_of(Pixel::mean)
    }

    /// Mean radiance of each pixel of one half (0 or 1): the two are independent pictures of the same scene.
    #[must_use]
    pub fn half_image(&self, half: usize) -> LinearImage {
        self.image_of(|pixel| pixel.halves[half % 2].mean())
    }

    fn image_of(&self, value: impl Fn(&Pixel) -> Rgb) -> LinearImage {
        let rows = (0..self.height).flat_map(|y| (0..self.width).map(move |x| (x, y)));
        LinearImage {
            width: self.width,
            height: self.height,
            pixels: rows.map(|(x, y)| value(self.pixel(x, y))).collect(),
        }
    }

    /// How many samples were NaN or infinite and were left out. Anything but 0 is a fault worth reporting.
    #[must_use]
    pub fn n_rejected(&self) -> u64 {
        self.all_pixels()
            .map(|pixel| u64::from(pixel.n_rejected))
            .sum()
    }

    /// How many samples the film holds.
    #[must_use]
    pub fn n_samples(&self) -> u64 {
        let halves = self.all_pixels().flat_map(|pixel| pixel.halves);
        halves.map(|half| u64::from(half.n_samples)).sum()
    }

    /// How exact the picture is, from the difference of its halves; `None` until every pixel has two samples.
    #[must_use]
    pub fn error_estimate(&self) -> Option<ErrorEstimate> {
        ErrorEstimate::of(self)
    }

    fn all_pixels(&self) -> impl Iterator<Item = &Pixel> {
        self.tiles.iter().flat_map(|tile| &tile.pixels)
    }
}

/// A finished picture in linear light, row by row from the top left.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct LinearImage {
    /// Width in pixels.
    pub width: u32,
    /// Height in pixels.
    pub height: u32,
    /// Radiance of each pixel, W/(m² sr) per channel.
    pub pixels: Vec<Rgb>,
}

impl LinearImage {
    /// Whether it shows no light at all.
    #[must_use]
    pub fn is_black(&self) -> bool {
        self.pixels.iter().all(|pixel| pixel.is_black())
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn tiles_cover_every_pixel_once_for_odd_sizes() {
        for (width, height) in [(1, 1), (16, 16), (17, 33), (3, 100), (0, 5)] {
            let mut film = Film::new(width, height);
            for tile in film.tiles_mut() {
                let (x0, y0, w) = (tile.x, tile.y, tile.width);
                for (i, pixel) in (0..).zip(&mut tile.pixels) {
                    let value = f64::from((y0 + i / w) * 1000 + x0 + i % w);
                    pixel.add(0, Rgb::splat(value));
                }
            }
            assert_eq!(film.n_samples(), u64::from(width) * u64::from(height));
            for y in 0..height {
                for x in 0..width {
                    assert_eq!(film.pixel(x, y).mean(), Rgb::splat(f64::from(y * 1000 + x)));
                }
            }
            let image = film.image();
            assert_eq!(image.pixels.len(), (width * height) as usize);
        }
    }

    #[test]
    fn variance_needs_both_halves_and_is_a_quarter_of_the_squared_difference() {
        let mut pixel = Pixel::default();
        pixel.add(0, Rgb::splat(1.0));
        assert_eq!(pixel.variance(), None);
        pixel.add(1, Rgb::splat(3.0));
        assert!((pixel.variance().unwrap() - 1.0).abs() < 1e-12);
    }
}
