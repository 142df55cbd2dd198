//! Pictures as files: which formats there are, and how each is encoded. Bytes in, bytes out; no file is touched here.
//!
//! Formats of finished pictures (`.png`, `.jpg`, `.webp`) hold 8-bit sRGB, those of measurements (`.exr`, `.hdr`) linear
//! radiance in 32-bit floats.
//!
//! ```
//! use understory::image::{Format, Picture, Pixels, encode};
//! let picture = Picture { width: 1, height: 1, pixels: Pixels::Srgb(vec![255, 0, 0]) };
//! let bytes = encode(&picture, Format::Png, &[("Software", "understory".into())]).unwrap();
//! assert!(Format::Png.begins(&bytes));
//! ```

pub mod encode;
pub mod format;
pub mod png_text;

pub use encode::{ImageError, Picture, Pixels, encode};
pub use format::Format;
