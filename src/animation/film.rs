//! Frames become one file: a film.

use super::gif::{GifWriter, PaletteSampler};
use super::h264::{Sample, Stream, StreamError, level};
use super::mp4;
use super::webp::{LONGEST_SIDE, WebpWriter};
use crate::image::{Format, ImageError, Picture, Pixels, encode};
use std::path::Path;

/// A format of films.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum FilmFormat {
    /// MP4 with H.264: small, lossy, plays everywhere.
    Mp4,
    /// Animated PNG: lossless.
    Apng,
    /// GIF: 256 colors.
    Gif,
    /// Animated WebP: lossless.
    Webp,
}

/// The suffixes of films.
const SUFFIXES: [(&str, FilmFormat); 6] = [
    ("mp4", FilmFormat::Mp4),
    ("m4v", FilmFormat::Mp4),
    ("png", FilmFormat::Apng),
    ("apng", FilmFormat::Apng),
    ("gif", FilmFormat::Gif),
    ("webp", FilmFormat::Webp),
];
/// Players show GIF frames that are shorter than 1/50 s for 1/10 s.
const FASTEST_GIF: u32 = 50;

/// What all frames of a film have in common.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct FilmShape {
    /// Columns.
    pub width: u32,
    /// Rows.
    pub height: u32,
    /// Frames per second, at least 1.
    pub fps: u32,
    /// How many frames.
    pub n_frames: u32,
}

/// Why frames do not become a film.
#[derive(Debug, thiserror::Error)]
pub enum FilmError {
    /// No format has this suffix.
    #[error(
        "`{path}` does not end in the suffix of a film; known are {known}, and a path without a suffix is a folder for frames"
    )]
    UnknownSuffix {
        /// The path as given.
        path: String,
        /// The suffixes there are.
        known: String,
    },
    /// The format has no such sizes.
    #[error("a film in this format has at most {most}x{most} pixels, not {width}x{height}")]
    TooLarge {
        /// Longest side.
        most: u32,
        /// Columns.
        width: u32,
        /// Rows.
        height: u32,
    },
    /// The format has no such times.
    #[error("GIF films have at most {FASTEST_GIF} frames per second, not {0}")]
    TooFast(u32),
    /// The file would be too large.
    #[error("the film is larger than its format allows (4 GiB): make it shorter or smaller")]
    TooLong,
    /// H.264 has no such film.
    #[error(transparent)]
    Stream(#[from] StreamError),
    /// A frame cannot be encoded.
    #[error(transparent)]
    Frame(#[from] ImageError),
    /// The encoder of GIF.
    #[error("cannot encode as GIF")]
    Gif(#[from] gif::EncodingError),
    /// The encoder of PNG.
    #[error("cannot encode as animated PNG")]
    Apng(#[from] png::EncodingError),
}

impl FilmFormat {
    /// The format that the suffix of `path` stands for, in capitals or not.
    ///
    /// # Errors
    /// If the suffix stands for none.
    pub fn of_path(path: &Path) -> Result<Self, FilmError> {
        let suffix = path.extension().unwrap_or_default();
        let suffix = suffix.to_string_lossy().to_lowercase();
        let known = SUFFIXES.iter().find(|(name, _)| *name == suffix);
        known
            .map(|(_, format)| *format)
            .ok_or_else(|| FilmError::UnknownSuffix {
                path: path.display().to_string(),
                known: SUFFIXES.map(|(name, _)| format!(".{name}")).join(", "),
            })
    }

    /// Whether a file that starts with `head` (at least 12 bytes, unless it is shorter) is of this format.
    pub fn begins(self, head: &[u8]) -> bool {
        match self {
            Self::Mp4 => head.get(4..8) == Some(b"ftyp"),
            Self::Apng => Format::Png.begins(head),
            Self::Gif => head.starts_with(b"GIF8"),
            Self::Webp => Format::Webp.begins(head),
        }
    }

    /// Refuses a film that the format cannot hold.
    ///
    /// # Errors
    /// Its size or its frame rate.
    pub fn check(self, shape: FilmShape) -> Result<(), FilmError> {
        let FilmShape {
            width, height, fps, ..
        } = shape;
        let at_most = |most: u32| {
            if width.max(height) <= most {
                Ok(())
            } else {
                Err(FilmError::TooLarge {
                    most,
                    width,
                    height,
                })
            }
        };
        match self {
            Self::Mp4 => Ok(level(width, height, fps).map(drop)?),
            Self::Apng => Ok(()),
            Self::Gif if fps > FASTEST_GIF => Err(FilmError::TooFast(fps)),
            Self::Gif => at_most(u32::from(u16::MAX)),
            Self::Webp => at_most(LONGEST_SIDE),
        }
    }
}

/// The frames of a film, one after the other, as often as they are asked for.
pub type Frames<'a, E> = dyn FnMut(u32) -> Result<Vec<u8>, E> + 'a;

/// The file of a film whose frame `i` is what `frame(i)` gives: 8-bit sRGB, three bytes for each pixel, row by row. The same
/// frames always give the same bytes.
///
/// # Errors
/// If the format cannot hold it, or what `frame` fails with.
pub fn film<E: From<FilmError>>(
    format: FilmFormat,
    shape: FilmShape,
    frame: &mut Frames<'_, E>,
) -> Result<Vec<u8>, E> {
    format.check(shape)?;
    match format {
        FilmFormat::Mp4 => {
            let mut stream =
                Stream::new(shape.width, shape.height, shape.fps).map_err(FilmError::from)?;
            let mut samples: Vec<Sample> = Vec::new();
            for i in 0..shape.n_frames {
                samples.push(stream.encode(&frame(i)?).map_err(FilmError::from)?);
            }
            Ok(mp4::file(&mp4::Track {
                width: shape.width,
                height: shape.height,
                fps: shape.fps,
                sets: stream.parameter_sets(),
                samples: &samples,
            }))
        }
        FilmFormat::Apng => apng(shape, frame),
        FilmFormat::Gif => {
            let pixels =
                u64::from(shape.width) * u64::from(shape.height) * u64::from(shape.n_frames);
            let mut sampler = PaletteSampler::new(pixels);
            for i in 0..shape.n_frames {
                sampler.look(&frame(i)?);
            }
            // The sizes fit: they were checked.
            let size = (shape.width as u16, shape.height as u16);
            let mut writer = GifWriter::new(size, shape.fps, sampler).map_err(FilmError::from)?;
            for i in 0..shape.n_frames {
                writer.push(&frame(i)?).map_err(FilmError::from)?;
            }
            Ok(writer.finish().map_err(FilmError::from)?)
        }
        FilmFormat::Webp => {
            let mut writer = WebpWriter::new(shape.width, shape.height, shape.fps);
            for i in 0..shape.n_frames {
                let picture = Picture {
                    width: shape.width,
                    height: shape.height,
                    pixels: Pixels::Srgb(frame(i)?),
                };
                writer.push(&encode(&picture, Format::Webp, &[]).map_err(FilmError::from)?);
            }
            Ok(writer.finish().ok_or(FilmError::TooLong)?)
        }
    }
}

/// An animated PNG that repeats for ever.
fn apng<E: From<FilmError>>(shape: FilmShape, frame: &mut Frames<'_, E>) -> Result<Vec<u8>, E> {
    let mut out = Vec::new();
    let begin = |out| {
        let mut encoder = png::Encoder::new(out, shape.width, shape.height);
        encoder.set_color(png::ColorType::Rgb);
        encoder.set_depth(png::BitDepth::Eight);
        encoder.set_animated(shape.n_frames, 0)?;
        encoder.set_frame_delay(1, u16::try_from(shape.fps).unwrap_or(u16::MAX))?;
        encoder.write_header()
    };
    let mut writer = begin(&mut out).map_err(FilmError::from)?;
    for i in 0..shape.n_frames {
        writer
            .write_image_data(&frame(i)?)
            .map_err(FilmError::from)?;
    }
    writer.finish().map_err(FilmError::from)?;
    Ok(out)
}

#[cfg(test)]
mod tests {
    use super::*;

    const SHAPE: FilmShape = FilmShape {
        width: 32,
        height: 16,
        fps: 24,
        n_frames: 5,
    };

    fn frame(i: u32) -> Result<Vec<u8>, FilmError> {
        Ok((0..32 * 16 * 3).map(|at| (at / 6 + i * 20) as u8).collect())
    }

    #[test]
    fn each_format_is_known_by_its_suffix_and_its_first_bytes() {
        for name in ["a.mp4", "a.GIF", "a.apng", "a.webp"] {
            let format = FilmFormat::of_path(Path::new(name)).unwrap();
            let file = film(format, SHAPE, &mut frame).unwrap();
            assert!(format.begins(&file), "{name}");
            assert!(
                file == film(format, SHAPE, &mut frame).unwrap(),
                "{name}: other bytes"
            );
        }
        let message = FilmFormat::of_path(Path::new("a.avi"))
            .unwrap_err()
            .to_string();
        assert!(
            message.contains(".mp4") && message.contains("a.avi"),
            "{message}"
        );
    }

    #[test]
    fn films_that_a_format_cannot_hold_are_refused() {
        let odd = FilmShape { width: 31, ..SHAPE };
        let fast = FilmShape { fps: 60, ..SHAPE };
        let wide = FilmShape {
            width: 20_000,
            ..SHAPE
        };
        assert!(FilmFormat::Mp4.check(odd).is_err() && FilmFormat::Gif.check(odd).is_ok());
        assert!(FilmFormat::Gif.check(fast).is_err() && FilmFormat::Mp4.check(fast).is_ok());
        assert!(FilmFormat::Webp.check(wide).is_err() && FilmFormat::Apng.check(wide).is_ok());
    }
}
