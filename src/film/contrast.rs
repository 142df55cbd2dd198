//! Where a picture that is hardly sampled yet needs more samples: at edges, and where its samples disagree.

use super::Film;

/// Contrast, (brightest - darkest) / (brightest + darkest), above which an edge would show its steps: red, green, blue.
///
/// Source: [Mitchell1987, §3](crate::references#mitchell1987).
const THRESHOLDS: [f64; 3] = [0.4, 0.3, 0.6];

/// Some of the pixels of a film.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct PixelMask {
    width: u32,
    /// Row by row from the top left.
    pixels: Vec<bool>,
}

impl PixelMask {
    /// Whether the pixel in column `x` and row `y` is one of them.
    #[must_use]
    pub fn has(&self, x: u32, y: u32) -> bool {
        self.pixels[y as usize * self.width as usize + x as usize]
    }

    /// How many there are.
    #[must_use]
    pub fn count(&self) -> usize {
        self.pixels.iter().filter(|wanted| **wanted).count()
    }
}

/// The pixels around which samples differ by more than the eye lets pass: those of the two halves of the pixel and of its eight
/// neighbours.
#[must_use]
pub fn pixels_to_refine(film: &Film) -> PixelMask {
    let (width, height) = (film.width(), film.height());
    let halves = [film.half_image(0), film.half_image(1)];
    let at = |x: u32, y: u32| {
        let index = y as usize * width as usize + x as usize;
        halves.iter().map(move |half| half.pixels[index])
    };
    let needs_more = |x: u32, y: u32| {
        let (mut low, mut high) = ([f64::INFINITY; 3], [0.0_f64; 3]);
        for near_y in y.saturating_sub(1)..=(y + 1).min(height - 1) {
            for near_x in x.saturating_sub(1)..=(x + 1).min(width - 1) {
                for value in at(near_x, near_y) {
                    let value = value.to_array();
                    low = std::array::from_fn(|i| low[i].min(value[i]));
                    high = std::array::from_fn(|i| high[i].max(value[i]));
                }
            }
        }
        let channels = low.into_iter().zip(high);
        channels
            .zip(THRESHOLDS)
            .any(|((low, high), most)| high - low > most * (high + low))
    };
    let rows = (0..height).flat_map(|y| (0..width).map(move |x| (x, y)));
    PixelMask {
        width,
        pixels: rows.map(|(x, y)| needs_more(x, y)).collect(),
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::color::Rgb;

    /// A film of two samples a pixel.
    fn film(width: u32, height: u32, value: impl Fn(u32, u32, u32) -> f64) -> Film {
        let mut film = Film::new(width, height);
        for tile in film.tiles_mut() {
            for (i, pixel) in (0..).zip(&mut tile.pixels) {
                let (x, y) = (tile.x + i % tile.width, tile.y + i / tile.width);
                for sample in 0..2 {
                    pixel.add(sample, Rgb::splat(value(x, y, sample)));
                }
            }
        }
        film
    }

    #[test]
    fn edges_are_refined_on_both_sides_and_slow_changes_are_not() {
        let edge = pixels_to_refine(&film(40, 20, |x, _, _| if x < 23 { 1.0 } else { 3.0 }));
        assert_eq!(edge.count(), 2 * 20);
        assert!(edge.has(22, 0) && edge.has(23, 19) && !edge.has(21, 5) && !edge.has(24, 5));
        let slow = film(40, 20, |x, y, _| 1.0 + 0.05 * f64::from(x + y));
        assert_eq!(pixels_to_refine(&slow).count(), 0);
        assert_eq!(pixels_to_refine(&film(40, 20, |_, _, _| 0.0)).count(), 0);
    }

    #[test]
    fn samples_that_disagree_are_refined_with_their_neighbours() {
        let noisy = film(40, 20, |x, y, sample| {
            if (x, y, sample) == (10, 10, 1) {
                9.0
            } else {
                1.0
            }
        });
        assert_eq!(pixels_to_refine(&noisy).count(), 9);
        let corner = film(40, 20, |x, y, _| f64::from(u8::from((x, y) == (0, 0))));
        assert_eq!(pixels_to_refine(&corner).count(), 4);
    }
}
