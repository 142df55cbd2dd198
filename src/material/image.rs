//! Pictures as data: decoded PNG and JPEG files.
//!
//! Colours are sRGB in the file and become linear; coverage (alpha) is linear already. Colour profiles and the turns that
//! cameras note are not looked at. Nothing here touches the disk.

use crate::color::{Rgb, srgb};
use image::{DynamicImage, ImageDecoder, ImageFormat, ImageReader, Limits};
use std::fmt;
use std::io::Cursor;
use std::sync::LazyLock;

/// Texels along a side, at most.
const LARGEST_SIDE: u32 = 32_768;

/// Texels of a picture, at most: what 8 bits per channel hold in half a gigabyte.
const MOST_TEXELS: u64 = 1 << 27;

/// A picture.
#[derive(Clone, PartialEq)]
pub struct Image {
    width: u32,
    height: u32,
    texels: Texels,
    mean: Rgb,
    most: Rgb,
    least_coverage: f64,
}

/// Texels row by row from above.
#[derive(Clone, PartialEq)]
enum Texels {
    /// Encoded colour and coverage.
    Srgb(Box<[[u8; 4]]>),
    /// Linear colour and coverage.
    Linear(Box<[[f32; 4]]>),
}

/// What of a picture cuts holes.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub enum Coverage {
    /// Its alpha channel.
    Alpha,
    /// Nothing: it is opaque whatever its alpha channel says.
    Opaque,
    /// Its brightness: white is there.
    Bright,
    /// Its brightness, the other way round: white is a hole.
    Dark,
}

/// Why a file is no picture to lay on a surface. The texts do not name the file.
#[derive(Debug, thiserror::Error)]
pub enum ImageFault {
    /// Neither PNG nor JPEG.
    #[error("it is neither a PNG nor a JPEG picture; save it as one of these")]
    Format,
    /// It cannot be decoded.
    #[error("it cannot be decoded: {0}")]
    Decode(#[from] image::ImageError),
    /// It ends too early.
    #[error("it is cut off: the end of the picture is missing; copy the file again")]
    CutOff,
    /// It has no texels, or not as many as it should have.
    #[error("it has no pixels")]
    Empty,
    /// It would take too much memory.
    #[error("its {width} × {height} pixels are too many; scale it down to at most {most} pixels")]
    TooLarge {
        /// Pixels across.
        width: u32,
        /// Pixels down.
        height: u32,
        /// Pixels that would be read.
        most: u64,
    },
}

impl Image {
    /// Decodes a PNG or JPEG file that may take `memory` bytes. The size that the file claims is checked first.
    ///
    /// # Errors
    /// If it is no such file, broken, or too large.
    pub fn decode(file: &[u8], memory: u64) -> Result<Self, ImageFault> {
        let format = image::guess_format(file).map_err(|_| ImageFault::Format)?;
        match format {
            ImageFormat::Png => {}
            ImageFormat::Jpeg if is_whole_jpeg(file) => {}
            ImageFormat::Jpeg => return Err(ImageFault::CutOff),
            _ => return Err(ImageFault::Format),
        }
        let mut reader = ImageReader::with_format(Cursor::new(file), format);
        // What the file claims is looked at before anything is allocated for it.
        let mut limits = Limits::default();
        limits.max_alloc = Some(memory.clamp(1 << 24, 1 << 34));
        reader.limits(limits);
        let decoder = reader.into_decoder()?;
        let (width, height) = decoder.dimensions();
        let is_fine = decoder.color_type().bytes_per_pixel() > decoder.color_type().channel_count();
        let kept = if is_fine {
            size_of::<[f32; 4]>()
        } else {
            size_of::<[u8; 4]>()
        };
        let texels = u64::from(width) * u64::from(height);
        // The decoded picture, a conversion of it, and what is kept are there at the same time.
        let each = kept * 2 + usize::from(decoder.color_type().bytes_per_pixel());
        let most = MOST_TEXELS.min(memory / each as u64);
        if width.max(height) > LARGEST_SIDE || texels > most {
            let most = most.min(u64::from(LARGEST_SIDE).pow(2));
            return Err(ImageFault::TooLarge {
                width,
                height,
                most,
            });
        }
        let picture = DynamicImage::from_decoder(decoder)?;
        if is_fine {
            let picture = picture.into_rgba32f();
            let linear = |[r, g, b, a]: [f32; 4]| {
                let [r, g, b] = [r, g, b].map(|x| srgb::decode(f64::from(x)) as f32);
                [r, g, b, a.clamp(0.0, 1.0)]
            };
            let texels = picture.pixels().map(|pixel| linear(pixel.0)).collect();
            Self::new(width, height, Texels::Linear(texels))
        } else {
            let picture = picture.into_rgba8();
            let texels = picture.pixels().map(|pixel| pixel.0).collect();
            Self::new(width, height, Texels::Srgb(texels))
        }
    }

    /// A picture of linear colours and coverages, row by row from above. What is no fraction is brought into 0..=1.
    ///
    /// # Errors
    /// If there are no texels, or not `width × height`.
    pub fn linear(width: u32, height: u32, texels: Vec<[f32; 4]>) -> Result<Self, ImageFault> {
        let sound = |x: f32| if x.is_nan() { 0.0 } else { x.clamp(0.0, 1.0) };
        let texels = texels.into_iter().map(|texel| texel.map(sound)).collect();
        Self::new(width, height, Texels::Linear(texels))
    }

    fn new(width: u32, height: u32, texels: Texels) -> Result<Self, ImageFault> {
        let n = match &texels {
            Texels::Srgb(texels) => texels.len(),
            Texels::Linear(texels) => texels.len(),
        };
        if n == 0 || n as u64 != u64::from(width) * u64::from(height) {
            return Err(ImageFault::Empty);
        }
        let mut image = Self {
            width,
            height,
            texels,
            mean: Rgb::BLACK,
            most: Rgb::BLACK,
            least_coverage: 1.0,
        };
        image.measure();
        Ok(image)
    }

    /// The same picture with holes where something else of it says so.
    #[must_use]
    pub fn with_coverage(mut self, of: Coverage) -> Self {
        let bright = |color: Rgb| match of {
            Coverage::Bright => color.mean(),
            Coverage::Dark => 1.0 - color.mean(),
            Coverage::Alpha | Coverage::Opaque => 1.0,
        };
        if of == Coverage::Alpha {
            return self;
        }
        match &mut self.texels {
            // Brightness is kept to 8 bits, as the picture is.
            Texels::Srgb(texels) => texels.iter_mut().for_each(|texel| {
                texel[3] = (bright(decoded(*texel)) * 255.0).round() as u8;
            }),
            Texels::Linear(texels) => texels.iter_mut().for_each(|texel| {
                let [r, g, b, _] = texel.map(f64::from);
                texel[3] = bright(Rgb::new(r, g, b)) as f32;
            }),
        }
        self.measure();
        self
    }

    /// Finds mean, most and least.
    fn measure(&mut self) {
        let (mut sum, mut weight) = (Rgb::BLACK, 0.0);
        self.most = Rgb::BLACK;
        self.least_coverage = 1.0;
        for row in 0..self.height {
            for column in 0..self.width {
                let (color, coverage) = self.texel(column, row);
                sum += color * coverage;
                weight += coverage;
                if coverage > 0.0 {
                    let (most, color) = (self.most.to_array(), color.to_array());
                    self.most = Rgb::from_array(std::array::from_fn(|i| most[i].max(color[i])));
                }
                self.least_coverage = self.least_coverage.min(coverage);
            }
        }
        self.mean = if weight > 0.0 {
            sum / weight
        } else {
            Rgb::BLACK
        };
    }

    /// Texels across.
    #[must_use]
    pub const fn width(&self) -> u32 {
        self.width
    }

    /// Texels down.
    #[must_use]
    pub const fn height(&self) -> u32 {
        self.height
    }

    /// Its mean linear colour, as far as it covers.
    #[must_use]
    pub const fn mean(&self) -> Rgb {
        self.mean
    }

    /// The largest linear value of each channel, as far as it covers.
    #[must_use]
    pub const fn most(&self) -> Rgb {
        self.most
    }

    /// Whether some of it is a hole, or half of one.
    #[must_use]
    pub fn has_holes(&self) -> bool {
        self.least_coverage < 1.0
    }

    /// Bytes that it takes.
    #[must_use]
    pub fn bytes(&self) -> usize {
        match &self.texels {
            Texels::Srgb(texels) => size_of_val(&**texels),
            Texels::Linear(texels) => size_of_val(&**texels),
        }
    }

    /// Linear colour and coverage of a texel, counted from the upper left corner; it must be inside.
    #[inline]
    pub(super) fn texel(&self, column: u32, row: u32) -> (Rgb, f64) {
        let at = row as usize * self.width as usize + column as usize;
        match &self.texels {
            Texels::Srgb(texels) => (decoded(texels[at]), f64::from(texels[at][3]) / 255.0),
            Texels::Linear(texels) => {
                let [r, g, b, a] = texels[at].map(f64::from);
                (Rgb::new(r, g, b), a)
            }
        }
    }
}

impl fmt::Debug for Image {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "Image({} × {})", self.width, self.height)
    }
}

/// The linear colour of encoded bytes.
#[inline]
fn decoded([r, g, b, _]: [u8; 4]) -> Rgb {
    static LINEAR: LazyLock<[f64; 256]> =
        LazyLock::new(|| std::array::from_fn(|byte| srgb::decode_u8(byte as u8)));
    let linear = &*LINEAR;
    Rgb::new(
        linear[usize::from(r)],
        linear[usize::from(g)],
        linear[usize::from(b)],
    )
}

/// Whether a JPEG file has its end mark: the decoder fills up what is missing without a word.
fn is_whole_jpeg(file: &[u8]) -> bool {
    // Within the coded picture neither mark occurs; before it, in a thumbnail, both may.
    let last = |mark: [u8; 2]| file.windows(2).rposition(|two| two == mark);
    let (scan, end) = (last([0xff, 0xda]), last([0xff, 0xd9]));
    matches!((scan, end), (Some(scan), Some(end)) if end > scan)
}

#[cfg(test)]
mod tests {
    use super::*;

    const ROOM: u64 = 1 << 28;

    fn png(width: u32, height: u32, texels: &[[u8; 4]]) -> Vec<u8> {
        let picture = image::RgbaImage::from_raw(width, height, texels.concat()).unwrap();
        let mut file = Cursor::new(vec![]);
        picture.write_to(&mut file, ImageFormat::Png).unwrap();
        file.into_inner()
    }

    fn jpeg(width: u32, height: u32) -> Vec<u8> {
        let shade = |x: u32, y: u32| image::Rgb([(x * 7 % 256) as u8, (y * 5 % 256) as u8, 40]);
        let picture = image::RgbImage::from_fn(width, height, shade);
        let mut file = Cursor::new(vec![]);
        picture.write_to(&mut file, ImageFormat::Jpeg).unwrap();
        file.into_inner()
    }

    #[test]
    fn colours_become_linear_and_coverage_stays() {
        let file = png(2, 1, &[[255, 188, 0, 255], [0, 0, 0, 51]]);
        let image = Image::decode(&file, ROOM).unwrap();
        let (color, coverage) = image.texel(0, 0);
        assert_eq!((color.r, color.b, coverage), (1.0, 0.0, 1.0));
        assert!((color.g - 0.5028).abs() < 1e-3, "{}", color.g);
        assert!((image.texel(1, 0).1 - 0.2).abs() < 1e-12);
        assert!(image.has_holes());
        assert_eq!(image.most().r, 1.0);
        assert!((image.mean().r - 1.0 / 1.2).abs() < 1e-12);
        assert!(!image.clone().with_coverage(Coverage::Opaque).has_holes());
        let (_, dark) = image.clone().with_coverage(Coverage::Dark).texel(1, 0);
        let (_, bright) = image.with_coverage(Coverage::Bright).texel(1, 0);
        assert_eq!((dark, bright), (1.0, 0.0));
    }

    #[test]
    fn sixteen_bits_are_kept() {
        let picture = image::ImageBuffer::from_fn(1, 1, |_, _| image::Luma([40_000_u16]));
        let mut file = Cursor::new(vec![]);
        picture.write_to(&mut file, ImageFormat::Png).unwrap();
        let image = Image::decode(file.get_ref(), ROOM).unwrap();
        let expected = srgb::decode(40_000.0 / 65_535.0);
        assert!((image.texel(0, 0).0.g - expected).abs() < 1e-7);
    }

    /// Every cut of a file is an error, not a picture of half of it: the decoder alone would fill up JPEGs with gray.
    #[test]
    fn cut_off_files_are_refused() {
        let texels: Vec<[u8; 4]> = (0..64).map(|i| [i * 3, 255 - i, i, 255]).collect();
        for file in [png(8, 8, &texels), jpeg(40, 24)] {
            assert!(Image::decode(&file, ROOM).is_ok());
            for length in 0..file.len().saturating_sub(13) {
                assert!(Image::decode(&file[..length], ROOM).is_err(), "{length}");
            }
        }
    }

    #[test]
    fn what_a_header_claims_is_checked_before_memory_is_taken() {
        let mut file = png(1, 1, &[[0; 4]]);
        // Width and height of the header chunk, whose checksum then has to fit.
        file[16..24].copy_from_slice(&[0, 0, 0x7f, 0xff, 0, 0, 0x7f, 0xff]);
        let sum = crc(&file[12..29]);
        file[29..33].copy_from_slice(&sum.to_be_bytes());
        let fault = Image::decode(&file, u64::MAX).unwrap_err();
        assert!(matches!(fault, ImageFault::TooLarge { .. }), "{fault}");
        let fine = jpeg(100, 100);
        let fault = Image::decode(&fine, 10_000).unwrap_err();
        assert!(matches!(fault, ImageFault::TooLarge { .. }), "{fault}");
    }

    /// The checksum of PNG chunks (ISO 3309).
    fn crc(bytes: &[u8]) -> u32 {
        !bytes.iter().fold(u32::MAX, |crc, byte| {
            (0..8).fold(crc ^ u32::from(*byte), |crc, _| {
                (crc >> 1) ^ (0xedb8_8320 & (crc & 1).wrapping_neg())
            })
        })
    }

    #[test]
    fn other_kinds_of_files_are_refused() {
        for wrong in [
            &b""[..],
            b"GIF89a",
            b"<svg/>",
            b"P6 1 1 255 abc",
            &[0xff, 0xd8, 0xff],
        ] {
            assert!(Image::decode(wrong, ROOM).is_err());
        }
        assert!(Image::linear(0, 0, vec![]).is_err());
        assert!(Image::linear(2, 1, vec![[0.0; 4]]).is_err());
        let wild = Image::linear(1, 1, vec![[f32::NAN, -1.0, 7.0, 2.0]]).unwrap();
        assert_eq!(wild.texel(0, 0), (Rgb::new(0.0, 0.0, 1.0), 1.0));
    }
}
