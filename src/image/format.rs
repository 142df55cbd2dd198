//! The formats pictures are written in.

use super::encode::ImageError;
use std::path::Path;

/// A format of picture files.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Format {
    /// PNG: 8-bit sRGB, lossless, with text about its making.
    Png,
    /// OpenEXR: linear radiance, 32-bit float.
    Exr,
    /// Radiance HDR: linear radiance with a shared exponent (about 1 %).
    Hdr,
    /// JPEG: 8-bit sRGB, lossy.
    Jpeg,
    /// WebP: 8-bit sRGB, lossless.
    Webp,
}

/// What the pixels of a format are.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Encoding {
    /// Linear radiance.
    Linear,
    /// Exposed, tone-mapped, encoded in sRGB.
    Srgb,
}

/// How many bytes at the start of a file tell its format.
pub const MAGIC_LENGTH: usize = 12;

const SUFFIXES: [(&str, Format); 6] = [
    ("png", Format::Png),
    ("exr", Format::Exr),
    ("hdr", Format::Hdr),
    ("jpg", Format::Jpeg),
    ("jpeg", Format::Jpeg),
    ("webp", Format::Webp),
];

impl Format {
    /// The format that the suffix of `path` stands for, in capitals or not.
    ///
    /// # Errors
    /// If the suffix stands for none.
    pub fn of_path(path: &Path) -> Result<Self, ImageError> {
        let suffix = path
            .extension()
            .unwrap_or_default()
            .to_string_lossy()
            .to_lowercase();
        let known = SUFFIXES.iter().find(|(name, _)| *name == suffix);
        known
            .map(|(_, format)| *format)
            .ok_or_else(|| ImageError::UnknownSuffix {
                path: path.display().to_string(),
                known: SUFFIXES.map(|(name, _)| format!(".{name}")).join(", "),
            })
    }

    /// What its pixels are.
    pub fn encoding(self) -> Encoding {
        match self {
            Self::Exr | Self::Hdr => Encoding::Linear,
            Self::Png | Self::Jpeg | Self::Webp => Encoding::Srgb,
        }
    }

    /// Whether a file that starts with `head` (at least [`MAGIC_LENGTH`] bytes, unless it is shorter) is of this format.
    pub fn begins(self, head: &[u8]) -> bool {
        match self {
            Self::Png => head.starts_with(b"\x89PNG\r\n\x1a\n"),
            Self::Exr => head.starts_with(&[0x76, 0x2f, 0x31, 0x01]),
            Self::Hdr => head.starts_with(b"#?RADIANCE") || head.starts_with(b"#?RGBE"),
            Self::Jpeg => head.starts_with(&[0xff, 0xd8, 0xff]),
            Self::Webp => head.starts_with(b"RIFF") && head.get(8..12) == Some(b"WEBP"),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_suffix_decides() {
        assert_eq!(Format::of_path(Path::new("a/b.PNG")).unwrap(), Format::Png);
        assert_eq!(Format::of_path(Path::new("b.jpeg")).unwrap(), Format::Jpeg);
        for unknown in ["b.tiff", "b", "png", ".png"] {
            let message = Format::of_path(Path::new(unknown)).unwrap_err().to_string();
            assert!(
                message.contains(".webp") && message.contains(unknown),
                "{message}"
            );
        }
    }
}
