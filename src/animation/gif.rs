//! Films as GIF: 256 colors, the same ones for all frames, so that still parts of the picture stay still.
//!
//! Each frame is compared with the palette through a table of 32×32×32 colors; what lies between two colors of the palette is
//! a pattern fixed to the picture, not to the frame.

use color_quant::NeuQuant;
use gif::{Encoder, Frame, Repeat};
use std::borrow::Cow;

/// Pixels by which the palette is chosen, at most: as many as a picture of 640×640.
const MOST_SAMPLES: usize = 409_600;
/// One pixel in so many trains the palette: the best of the algorithm.
const CARE: i32 = 1;
/// How far the pattern moves a value of 8 bits up or down.
const PATTERN: i32 = 8;
/// Bits of each channel in the table.
const BITS: u32 = 5;
/// Thresholds of Bayer's 4×4 pattern.
///
/// Source: [Bayer1973](crate::references#bayer1973).
const BAYER: [[i32; 4]; 4] = [[0, 8, 2, 10], [12, 4, 14, 6], [3, 11, 1, 9], [15, 7, 13, 5]];

/// Collects pixels of all frames for the palette.
#[derive(Clone, Debug)]
pub(super) struct PaletteSampler {
    stride: usize,
    offset: usize,
    rgba: Vec<u8>,
}

impl PaletteSampler {
    /// For a film of so many pixels in all its frames.
    pub(super) fn new(n_pixels: u64) -> Self {
        let stride = n_pixels.div_ceil(MOST_SAMPLES as u64).max(1);
        Self {
            stride: usize::try_from(stride).unwrap_or(usize::MAX),
            offset: 0,
            rgba: Vec::new(),
        }
    }

    /// Looks at a frame.
    pub(super) fn look(&mut self, rgb: &[u8]) {
        let n = rgb.len() / 3;
        while self.offset < n {
            let at = 3 * self.offset;
            self.rgba.extend_from_slice(&rgb[at..at + 3]);
            self.rgba.push(255);
            self.offset += self.stride;
        }
        self.offset -= n;
    }

    /// The palette.
    fn palette(self) -> NeuQuant {
        let mut rgba = self.rgba;
        // The algorithm needs some pixels to begin with.
        while rgba.len() < 4 * 512 {
            let again = rgba
                .get(..4)
                .map_or([0, 0, 0, 255], |p| [p[0], p[1], p[2], p[3]]);
            rgba.extend_from_slice(&again);
        }
        NeuQuant::new(CARE, 256, &rgba)
    }
}

/// Writes a GIF film.
pub(super) struct GifWriter {
    encoder: Encoder<Vec<u8>>,
    table: Vec<u8>,
    width: u16,
    height: u16,
    fps: u32,
    n: u32,
}

impl GifWriter {
    /// A film that repeats for ever. `width` and `height` at most 65535.
    pub(super) fn new(
        (width, height): (u16, u16),
        fps: u32,
        sampler: PaletteSampler,
    ) -> Result<Self, gif::EncodingError> {
        let palette = sampler.palette();
        let mut encoder = Encoder::new(Vec::new(), width, height, &palette.color_map_rgb())?;
        encoder.set_repeat(Repeat::Infinite)?;
        let side = 1_usize << BITS;
        // The middle of each cell of the table.
        let value = |cell: usize| ((cell << (8 - BITS)) + (1 << (7 - BITS))) as u8;
        let table = (0..side.pow(3))
            .map(|i| {
                let [r, g, b] = [i / (side * side), i / side % side, i % side].map(value);
                palette.index_of(&[r, g, b, 255]) as u8
            })
            .collect();
        Ok(Self {
            encoder,
            table,
            width,
            height,
            fps,
            n: 0,
        })
    }

    /// Adds a frame.
    pub(super) fn push(&mut self, rgb: &[u8]) -> Result<(), gif::EncodingError> {
        let width = usize::from(self.width);
        let indices = rgb.chunks_exact(3).enumerate().map(|(i, pixel)| {
            let threshold = BAYER[i / width % 4][i % width % 4];
            let shift = (2 * threshold - 15) * PATTERN / 32;
            let cell = |value: u8| {
                let moved = (i32::from(value) + shift).clamp(0, 255) as usize;
                moved >> (8 - BITS)
            };
            let [r, g, b] = [pixel[0], pixel[1], pixel[2]].map(cell);
            self.table[(((r << BITS) + g) << BITS) + b]
        });
        let frame = Frame {
            width: self.width,
            height: self.height,
            delay: duration(self.n, self.fps, 100) as u16,
            buffer: Cow::Owned(indices.collect()),
            ..Frame::default()
        };
        self.n += 1;
        self.encoder.write_frame(&frame)
    }

    /// The file.
    pub(super) fn finish(self) -> Result<Vec<u8>, gif::EncodingError> {
        self.encoder.into_inner()
    }
}

/// How long frame `n` is shown in units of which `per_second` make a second: rounded so that the film as a whole is not.
pub(super) fn duration(n: u32, fps: u32, per_second: u64) -> u32 {
    let until = |n: u64| (n * per_second + u64::from(fps) / 2) / u64::from(fps);
    (until(u64::from(n) + 1) - until(u64::from(n))) as u32
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn rounded_durations_add_up() {
        for fps in [1, 12, 24, 25, 30, 50] {
            let total: u32 = (0..fps * 7).map(|n| duration(n, fps, 100)).sum();
            assert_eq!(total, 700, "{fps}");
        }
    }

    #[test]
    fn every_frame_gives_pixels_to_the_palette() {
        let mut sampler = PaletteSampler::new(4 * 1_000_000);
        for value in 0..4 {
            sampler.look(&vec![value; 3_000_000]);
        }
        for value in 0..4 {
            let n = sampler.rgba.chunks(4).filter(|p| p[0] == value).count();
            assert!((90_000..115_000).contains(&n), "{n}");
        }
    }
}
