//! Pixels become the bytes of a file.

use super::format::Format;
use super::png_text;
use image::codecs::jpeg::JpegEncoder;
use image::codecs::openexr::OpenExrEncoder;
use image::codecs::png::PngEncoder;
use image::codecs::webp::WebPEncoder;
use image::{ExtendedColorType, ImageEncoder};
use std::io::Cursor;

/// Quality of written JPEG files, of 100: differences are not seen at normal size.
const JPEG_QUALITY: u8 = 85;

/// A finished picture.
#[derive(Clone, Debug, PartialEq)]
pub struct Picture {
    /// Columns, at least 1.
    pub width: u32,
    /// Rows, at least 1.
    pub height: u32,
    /// Row by row from the top, from left to right, three values each.
    pub pixels: Pixels,
}

/// The values of a picture.
#[derive(Clone, Debug, PartialEq)]
pub enum Pixels {
    /// Encoded in sRGB.
    Srgb(Vec<u8>),
    /// Linear radiance, W/(m² sr).
    Linear(Vec<f32>),
}

/// Why a picture does not become a file.
#[derive(Debug, thiserror::Error)]
pub enum ImageError {
    /// No format has this suffix.
    #[error("`{path}` does not end in the suffix of a picture; known are {known}")]
    UnknownSuffix {
        /// The path as given.
        path: String,
        /// The suffixes there are.
        known: String,
    },
    /// The format cannot hold it.
    #[error("a picture of {width}x{height} pixels cannot be encoded as {format:?}")]
    Encode {
        /// Columns.
        width: u32,
        /// Rows.
        height: u32,
        /// The format.
        format: Format,
        /// What its encoder said.
        source: image::ImageError,
    },
}

/// The bytes of a file of this format; `texts` (key and value) are kept in PNG files and left out elsewhere.
///
/// The same picture and texts always give the same bytes. The pixels must be of the format's
/// [`encoding`](Format::encoding).
///
/// # Errors
/// If the format cannot hold a picture of that size or those values.
pub fn encode(
    picture: &Picture,
    format: Format,
    texts: &[(&str, String)],
) -> Result<Vec<u8>, ImageError> {
    let mut file = Cursor::new(Vec::new());
    let (width, height) = (picture.width, picture.height);
    let written = match (&picture.pixels, format) {
        (Pixels::Srgb(rgb), Format::Png) => {
            PngEncoder::new(&mut file).write_image(rgb, width, height, ExtendedColorType::Rgb8)
        }
        (Pixels::Srgb(rgb), Format::Jpeg) => JpegEncoder::new_with_quality(&mut file, JPEG_QUALITY)
            .write_image(rgb, width, height, ExtendedColorType::Rgb8),
        (Pixels::Srgb(rgb), Format::Webp) => WebPEncoder::new_lossless(&mut file).write_image(
            rgb,
            width,
            height,
            ExtendedColorType::Rgb8,
        ),
        (Pixels::Linear(rgb), Format::Exr) => OpenExrEncoder::new(&mut file).write_image(
            &native_bytes(rgb),
            width,
            height,
            ExtendedColorType::Rgb32F,
        ),
        (Pixels::Linear(rgb), Format::Hdr) => image::codecs::hdr::HdrEncoder::new(&mut file)
            .write_image(&native_bytes(rgb), width, height, ExtendedColorType::Rgb32F),
        (Pixels::Linear(_), Format::Png | Format::Jpeg | Format::Webp)
        | (Pixels::Srgb(_), Format::Exr | Format::Hdr) => {
            unreachable!("invariant: pixels are of the format's encoding")
        }
    };
    written.map_err(|source| ImageError::Encode {
        width,
        height,
        format,
        source,
    })?;
    let bytes = file.into_inner();
    Ok(if format == Format::Png {
        png_text::insert(bytes, texts)
    } else {
        bytes
    })
}

/// The floats as the `image` crate wants them: in the byte order of the machine.
fn native_bytes(values: &[f32]) -> Vec<u8> {
    values
        .iter()
        .flat_map(|value| value.to_ne_bytes())
        .collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    const SRGB: [Format; 3] = [Format::Png, Format::Jpeg, Format::Webp];

    #[test]
    fn files_start_as_their_format_and_read_back() {
        let pixels: Vec<u8> = (0..8 * 4 * 3).map(|i| (i * 2) as u8).collect();
        let picture = Picture {
            width: 8,
            height: 4,
            pixels: Pixels::Srgb(pixels.clone()),
        };
        for format in SRGB {
            let bytes = encode(&picture, format, &[("Software", "understory".into())]).unwrap();
            assert!(format.begins(&bytes), "{format:?}");
            let read = image::load_from_memory(&bytes).unwrap().to_rgb8();
            assert_eq!(read.dimensions(), (8, 4));
            assert!(
                format == Format::Jpeg || read.into_raw() == pixels,
                "{format:?}"
            );
        }
    }

    #[test]
    fn linear_files_keep_radiance() {
        let values: Vec<f32> = (0..8 * 2 * 3).map(|i| 0.01 * 1.3_f32.powi(i)).collect();
        let picture = Picture {
            width: 8,
            height: 2,
            pixels: Pixels::Linear(values.clone()),
        };
        for (format, worst) in [(Format::Exr, 0.0), (Format::Hdr, 0.01)] {
            let bytes = encode(&picture, format, &[]).unwrap();
            assert!(format.begins(&bytes), "{format:?}");
            let read = image::load_from_memory(&bytes)
                .unwrap()
                .to_rgb32f()
                .into_raw();
            for (triple, kept) in values.chunks(3).zip(read.chunks(3)) {
                let brightest = triple[2];
                for (a, b) in triple.iter().zip(kept) {
                    assert!((a - b).abs() <= worst * brightest, "{format:?}: {a} {b}");
                }
            }
        }
    }

    #[test]
    fn sizes_that_a_format_cannot_hold_are_errors() {
        let width = 70_000;
        let pixels = Pixels::Srgb(vec![0; width * 3]);
        let picture = Picture {
            width: width as u32,
            height: 1,
            pixels,
        };
        assert!(encode(&picture, Format::Jpeg, &[]).is_err());
        assert!(encode(&picture, Format::Webp, &[]).is_err());
    }
}
