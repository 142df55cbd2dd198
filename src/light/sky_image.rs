//! A picture of all that is round about: an equirectangular panorama with linear, unbounded values.

use crate::color::Rgb;
use crate::math::functions::{acos, atan2};
use glam::DVec3;
use image::{DynamicImage, ImageFormat, ImageReader, Limits};
use std::f64::consts::{PI, TAU};
use std::fmt;
use std::io::Cursor;

/// Pixels along a side, at most.
const LARGEST_SIDE: u32 = 16_384;

/// Memory of a picture while it is read, bytes: 16,384 × 8,192 pixels of four floats.
const MOST_MEMORY: u64 = 1 << 31;

/// Radiance by direction. The middle of the picture lies in the north (+y) at the horizon, its right half in the east, its
/// upper edge is the zenith.
#[derive(Clone, PartialEq)]
pub struct SkyImage {
    width: usize,
    height: usize,
    /// Rows from the zenith down, each from south over west, north and east to south.
    pixels: Vec<[f32; 3]>,
}

/// Why a file is no panorama.
#[derive(Debug, thiserror::Error)]
pub enum SkyImageError {
    /// Neither OpenEXR nor Radiance.
    #[error("it is neither an OpenEXR (.exr) nor a Radiance (.hdr) picture")]
    Format,
    /// It cannot be decoded.
    #[error("it cannot be decoded: {0}")]
    Decode(image::ImageError),
    /// A panorama is twice as wide as high.
    #[error(
        "it has {width} × {height} pixels; a panorama of the whole sphere is twice as wide as high"
    )]
    Shape {
        /// Pixels across.
        width: usize,
        /// Pixels down.
        height: usize,
    },
    /// A value is negative, infinite or NaN.
    #[error("its pixel ({x}, {y}) is {value:?}, not a radiance")]
    Value {
        /// From the left.
        x: usize,
        /// From the top.
        y: usize,
        /// Red, green, blue.
        value: [f32; 3],
    },
}

impl SkyImage {
    /// Decodes an OpenEXR or Radiance file.
    ///
    /// # Errors
    /// If it is no such file, no panorama, or holds a value that is no radiance.
    pub fn decode(file: &[u8]) -> Result<Self, SkyImageError> {
        let format = image::guess_format(file).map_err(|_| SkyImageError::Format)?;
        if !matches!(format, ImageFormat::OpenExr | ImageFormat::Hdr) {
            return Err(SkyImageError::Format);
        }
        let mut reader = ImageReader::with_format(Cursor::new(file), format);
        let mut limits = Limits::default();
        limits.max_image_width = Some(LARGEST_SIDE);
        limits.max_image_height = Some(LARGEST_SIDE);
        limits.max_alloc = Some(MOST_MEMORY);
        reader.limits(limits);
        let picture = match reader.decode().map_err(SkyImageError::Decode)? {
            DynamicImage::ImageRgb32F(picture) => picture,
            other => other.into_rgb32f(),
        };
        let (width, height) = (picture.width() as usize, picture.height() as usize);
        let pixels = picture.pixels().map(|pixel| pixel.0).collect();
        Self::new(width, height, pixels)
    }

    /// A panorama of these pixels, row by row from the zenith down.
    ///
    /// # Errors
    /// If it is not twice as wide as high, or holds a value that is no radiance.
    pub fn new(width: usize, height: usize, pixels: Vec<[f32; 3]>) -> Result<Self, SkyImageError> {
        if height == 0 || width != 2 * height || pixels.len() != width * height {
            return Err(SkyImageError::Shape { width, height });
        }
        let is_radiance = |value: &f32| value.is_finite() && *value >= 0.0;
        if let Some(at) = pixels
            .iter()
            .position(|pixel| !pixel.iter().all(is_radiance))
        {
            return Err(SkyImageError::Value {
                x: at % width,
                y: at / width,
                value: pixels[at],
            });
        }
        Ok(Self {
            width,
            height,
            pixels,
        })
    }

    /// Pixels across.
    #[must_use]
    pub fn width(&self) -> usize {
        self.width
    }

    /// Pixels down.
    #[must_use]
    pub fn height(&self) -> usize {
        self.height
    }

    /// The value of a pixel, `x` from the left and `y` from the top; beyond the sides it goes on at the other side, beyond
    /// the top and the bottom the last row is repeated.
    pub(super) fn pixel(&self, x: isize, y: isize) -> Rgb {
        let x = x.rem_euclid(self.width as isize) as usize;
        let y = y.clamp(0, self.height as isize - 1) as usize;
        Rgb::from_array(self.pixels[y * self.width + x].map(f64::from))
    }

    /// The value in direction `w` (unit, z up), linear between the middles of the pixels.
    #[must_use]
    pub fn value(&self, w: DVec3) -> Rgb {
        let turn = 0.5 + atan2(w.x, w.y) / TAU;
        let down = acos(w.z.clamp(-1.0, 1.0)) / PI;
        let x = turn * self.width as f64 - 0.5;
        let y = down * self.height as f64 - 0.5;
        let (left, top) = (x.floor(), y.floor());
        let (right, bottom) = (x - left, y - top);
        let at = |dx, dy| self.pixel(left as isize + dx, top as isize + dy);
        (at(0, 0) * (1.0 - right) + at(1, 0) * right) * (1.0 - bottom)
            + (at(0, 1) * (1.0 - right) + at(1, 1) * right) * bottom
    }
}

impl fmt::Debug for SkyImage {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "SkyImage({} × {})", self.width, self.height)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// 4 × 2 pixels: the upper row 1, 2, 3, 4, the lower 5, 6, 7, 8.
    fn eight() -> SkyImage {
        SkyImage::new(4, 2, (1..9_u8).map(|i| [f32::from(i); 3]).collect()).unwrap()
    }

    #[test]
    fn north_is_in_the_middle_and_east_right_of_it() {
        let sky = eight();
        let toward = |azimuth: f64, elevation: f64| {
            let (a, h) = (azimuth.to_radians(), elevation.to_radians());
            sky.value(DVec3::new(a.sin() * h.cos(), a.cos() * h.cos(), h.sin()))
                .r
        };
        // Middles of pixels: azimuths -135, -45, 45, 135 from north, elevations 45 and -45.
        for (azimuth, elevation, value) in [
            (-135.0, 45.0, 1.0),
            (-45.0, 45.0, 2.0),
            (45.0, 45.0, 3.0),
            (135.0, 45.0, 4.0),
            (45.0, -45.0, 7.0),
            // Between four pixels, and across the edge in the south.
            (0.0, 0.0, 4.5),
            (180.0, 45.0, 2.5),
            (45.0, 80.0, 3.0),
        ] {
            let found = toward(azimuth, elevation);
            assert!(
                (found - value).abs() < 1e-9,
                "{azimuth} {elevation}: {found}"
            );
        }
    }

    #[test]
    fn what_is_no_panorama_is_refused() {
        assert!(matches!(
            SkyImage::new(0, 0, vec![]),
            Err(SkyImageError::Shape { .. })
        ));
        assert!(matches!(
            SkyImage::new(1, 1, vec![[0.0; 3]]),
            Err(SkyImageError::Shape { .. })
        ));
        for value in [-1.0, f32::NAN, f32::INFINITY] {
            let wrong = SkyImage::new(2, 1, vec![[0.0; 3], [0.0, value, 0.0]]);
            assert!(matches!(
                wrong,
                Err(SkyImageError::Value { x: 1, y: 0, .. })
            ));
        }
        assert!(matches!(
            SkyImage::decode(b"no picture"),
            Err(SkyImageError::Format)
        ));
        let broken = SkyImage::decode(b"#?RADIANCE\nFORMAT=32-bit_rle_rgbe\n\n-Y 2 +X 4\n");
        assert!(
            matches!(broken, Err(SkyImageError::Decode(_))),
            "{broken:?}"
        );
    }

    #[test]
    fn files_are_read_as_they_were_written() {
        for format in [ImageFormat::OpenExr, ImageFormat::Hdr] {
            let picture =
                image::Rgb32FImage::from_fn(4, 2, |x, y| image::Rgb([x as f32, y as f32, 256.0]));
            let mut file = Cursor::new(Vec::new());
            picture.write_to(&mut file, format).unwrap();
            let sky = SkyImage::decode(file.get_ref()).unwrap();
            assert_eq!(sky.pixel(3, 1).b, 256.0);
            assert_eq!(sky.pixel(3 - 4, 7).g, sky.pixel(3, 1).g);
        }
    }
}
