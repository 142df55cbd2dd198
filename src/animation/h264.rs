//! Pictures become a stream of H.264: conversion of colors, encoding, and the description of the stream.
//!
//! The encoder writes a stream without a word on its colors; what players need to know of them is added here.
//!
//! Source: [H264](crate::references#h264) (Annex E: description of colors and time), [BT709](crate::references#bt709)
//! (from `R'G'B'` to `Y'CbCr`).

use super::bits::{BitReader, BitWriter};
use rusty_h264::{Encoder, EncoderConfig, Preset, Profile, YuvFrame};

/// Quantization of the encoder, 0 (largest files) to 51: at this one differences are not seen at normal size.
const QUANTIZATION: u8 = 20;
/// Seconds between frames at which players can begin.
const KEY_SECONDS: u32 = 2;
/// The levels of the standard: their number, the most macroblocks of a frame, and the most in a second.
const LEVELS: [(u8, u64, u64); 9] = [
    (30, 1_620, 40_500),
    (31, 3_600, 108_000),
    (32, 5_120, 216_000),
    (40, 8_192, 245_760),
    (50, 22_080, 589_824),
    (51, 36_864, 983_040),
    (52, 36_864, 2_073_600),
    (60, 139_264, 4_177_920),
    (62, 139_264, 16_711_680),
];

/// A picture of the stream.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Sample {
    /// Its units, each after its length in 4 bytes.
    pub data: Vec<u8>,
    /// Whether players can begin here.
    pub is_key: bool,
}

/// What players must know before the first picture.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct ParameterSets {
    /// The sequence parameter set, with its header.
    pub sequence: Vec<u8>,
    /// The picture parameter set, with its header.
    pub picture: Vec<u8>,
}

/// Encodes the frames of one film.
#[derive(Debug)]
pub struct Stream {
    encoder: Encoder,
    width: usize,
    height: usize,
    fps: u32,
    /// Known after the first frame.
    sets: ParameterSets,
}

/// Why there is no such stream.
#[derive(Clone, Debug, PartialEq, Eq, thiserror::Error)]
pub enum StreamError {
    /// Colors are stored for blocks of 2×2 pixels.
    #[error(
        "an MP4 film needs an even width and height, not {width}x{height}: `--size {}x{}`",
        width.next_multiple_of(2),
        height.next_multiple_of(2)
    )]
    OddSize {
        /// Columns.
        width: u32,
        /// Rows.
        height: u32,
    },
    /// No level of the standard allows it.
    #[error(
        "H.264 knows no film of {width}x{height} pixels at {fps} frames per second: make it smaller"
    )]
    TooLarge {
        /// Columns.
        width: u32,
        /// Rows.
        height: u32,
        /// Frames per second.
        fps: u32,
    },
    /// The encoder refused; its own words.
    #[error("cannot encode as H.264: {0}")]
    Encoder(String),
}

/// The lowest level that allows such a film.
///
/// # Errors
/// If none does, or width or height is odd.
pub fn level(width: u32, height: u32, fps: u32) -> Result<u8, StreamError> {
    if width % 2 == 1 || height % 2 == 1 {
        return Err(StreamError::OddSize { width, height });
    }
    let (columns, rows) = (
        u64::from(width.div_ceil(16)),
        u64::from(height.div_ceil(16)),
    );
    let macroblocks = columns * rows;
    let fits = |&&(_, frame, second): &&(u8, u64, u64)| {
        // A side is at most the root of eight times the area.
        let side = columns.max(rows);
        macroblocks <= frame && side * side <= 8 * frame && macroblocks * u64::from(fps) <= second
    };
    let found = LEVELS.iter().find(fits);
    found
        .map(|(level, _, _)| *level)
        .ok_or(StreamError::TooLarge { width, height, fps })
}

impl Stream {
    /// A stream of frames of this size, `fps` of them in a second.
    ///
    /// # Errors
    /// If the standard has no such stream.
    pub fn new(width: u32, height: u32, fps: u32) -> Result<Self, StreamError> {
        let level_idc = level(width, height, fps)?;
        let (width, height) = (width as usize, height as usize);
        let gop_size = (KEY_SECONDS * fps).max(1);
        // One picture out for each picture in, in the same order: what is not named here reorders or looks ahead.
        let config = EncoderConfig {
            profile: Profile::High,
            level_idc,
            qp: QUANTIZATION,
            gop_size,
            min_keyint: gop_size,
            scenecut: 0,
            lookahead: 0,
            mbtree: false,
            bitrate: 0,
            framerate: fps as f32,
            preset: Preset::Balanced,
            ..EncoderConfig::new(width, height)
        };
        let encoder = Encoder::new(config).map_err(|e| StreamError::Encoder(e.to_string()))?;
        Ok(Self {
            encoder,
            width,
            height,
            fps,
            sets: ParameterSets::default(),
        })
    }

    /// Encodes the next frame: 8-bit sRGB, three bytes for each pixel, row by row.
    ///
    /// # Errors
    /// If the frame has another size, or the encoder refuses it.
    pub fn encode(&mut self, rgb: &[u8]) -> Result<Sample, StreamError> {
        let frame = yuv(rgb, self.width, self.height);
        let unit = self
            .encoder
            .try_encode(&frame)
            .map_err(|e| StreamError::Encoder(e.to_string()))?;
        let mut sample = Sample {
            data: Vec::new(),
            is_key: false,
        };
        for nal in nal_units(&unit) {
            match nal.first().map(|header| header & 31) {
                Some(7) => self.sets.sequence = described(nal, self.fps),
                Some(8) => self.sets.picture = nal.to_vec(),
                Some(kind) => {
                    sample.is_key |= kind == 5;
                    let length = u32::try_from(nal.len()).unwrap_or(u32::MAX);
                    sample.data.extend_from_slice(&length.to_be_bytes());
                    sample.data.extend_from_slice(nal);
                }
                None => {}
            }
        }
        Ok(sample)
    }

    /// What players must know before the first picture; empty before the first [`encode`](Self::encode).
    pub fn parameter_sets(&self) -> &ParameterSets {
        &self.sets
    }
}

/// From sRGB to `Y'CbCr` of BT.709 with values in 16..=235 (16..=240 for colors); colors are means of 2×2 pixels.
fn yuv(rgb: &[u8], width: usize, height: usize) -> YuvFrame {
    let mut frame = YuvFrame {
        width,
        height,
        y: vec![0; width * height],
        u: vec![0; width * height / 4],
        v: vec![0; width * height / 4],
    };
    // K_r and K_b of BT.709 in units of 1/10000; scaled so that all sums are exact in 64-bit integers.
    let luma = |r: i64, g: i64, b: i64| 2126 * r + 7152 * g + 722 * b;
    for (y, pixel) in frame.y.iter_mut().zip(rgb.chunks_exact(3)) {
        let [r, g, b] = [pixel[0], pixel[1], pixel[2]].map(i64::from);
        let sum = 219 * luma(r, g, b);
        *y = (16 + (sum + 1_275_000) / 2_550_000) as u8;
    }
    let colors = frame.u.iter_mut().zip(&mut frame.v);
    for (i, (u, v)) in colors.enumerate() {
        let (column, row) = (2 * (i % (width / 2)), 2 * (i / (width / 2)));
        let mut sums = [0; 3];
        for (dx, dy) in [(0, 0), (1, 0), (0, 1), (1, 1)] {
            let at = 3 * ((row + dy) * width + column + dx);
            for (sum, value) in sums.iter_mut().zip(rgb.get(at..at + 3).unwrap_or(&[0; 3])) {
                *sum += i64::from(*value);
            }
        }
        let [r, g, b] = sums;
        let y = luma(r, g, b);
        // (B - Y) / (2 (1 - K_b)) and (R - Y) / (2 (1 - K_r)), over four pixels of 255 levels, to 224 levels.
        *u = color(224 * (10_000 * b - y), 4 * 255 * 18_556);
        *v = color(224 * (10_000 * r - y), 4 * 255 * 15_748);
    }
    frame
}

/// 128 + a quotient, rounded.
fn color(numerator: i64, denominator: i64) -> u8 {
    let rounded = (2 * numerator + denominator).div_euclid(2 * denominator);
    (128 + rounded).clamp(16, 240) as u8
}

/// The units of a stream in which each begins with 0 0 1.
fn nal_units(stream: &[u8]) -> Vec<&[u8]> {
    let starts: Vec<usize> = (0..stream.len().saturating_sub(2))
        .filter(|&i| stream[i..i + 3] == [0, 0, 1])
        .collect();
    let ends = starts.iter().skip(1).copied().chain([stream.len()]);
    starts
        .iter()
        .zip(ends)
        .map(|(&start, end)| {
            let unit = &stream[start + 3..end];
            let length = unit
                .iter()
                .rposition(|&byte| byte != 0)
                .map_or(0, |i| i + 1);
            &unit[..length]
        })
        .collect()
}

/// The sequence parameter set with a description of its colors (BT.709, 16..=235) and its time added.
///
/// The set of the encoder ends with the word that there is no such description, in its last bit.
fn described(set: &[u8], fps: u32) -> Vec<u8> {
    let (header, payload) = set.split_at(set.len().min(1));
    let mut reader = BitReader::without_escapes(payload);
    reader.drop_trailing();
    let mut out = BitWriter::default();
    for bit in reader.bits(reader.remaining().saturating_sub(1)) {
        out.bit(bit);
    }
    out.bit(true); // vui_parameters_present_flag
    out.bits(0, 2); // no aspect ratio, no overscan
    out.bit(true); // video_signal_type_present_flag
    out.bits(5, 3); // video format: unspecified
    out.bit(false); // values in 16..=235
    out.bit(true); // colour_description_present_flag
    out.bits(1, 8); // primaries of BT.709, which are those of sRGB
    out.bits(1, 8); // transfer of BT.709: players show sRGB tagged so as it is
    out.bits(1, 8); // matrix of BT.709
    out.bit(false); // no chroma location
    out.bit(true); // timing_info_present_flag
    out.bits(1, 32); // a tick is half a frame
    out.bits(2 * fps, 32);
    out.bit(true); // fixed_frame_rate_flag
    out.bits(0, 4); // no buffer models, no picture structure, no restrictions
    let mut unit = header.to_vec();
    unit.extend(out.finish_with_escapes());
    unit
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn levels_follow_size_and_rate() {
        assert_eq!(level(640, 360, 25), Ok(30));
        assert_eq!(level(1920, 1080, 30), Ok(40));
        assert_eq!(level(3840, 2160, 60), Ok(52));
        let odd = level(641, 359, 25).unwrap_err().to_string();
        assert!(
            odd.contains("641x359") && odd.contains("--size 642x360"),
            "{odd}"
        );
        assert!(matches!(
            level(20_000, 20_000, 25),
            Err(StreamError::TooLarge { .. })
        ));
    }

    #[test]
    fn grays_and_primaries_have_the_values_of_the_standard() {
        // Y', Cb, Cr of 8-bit BT.709: white, black, and the 100 % bars.
        let cases = [
            ([255, 255, 255], [235, 128, 128]),
            ([0, 0, 0], [16, 128, 128]),
            ([255, 0, 0], [63, 102, 240]),
            ([0, 255, 0], [173, 42, 26]),
            ([0, 0, 255], [32, 240, 118]),
        ];
        for (rgb, expected) in cases {
            let frame = yuv(&rgb.repeat(4), 2, 2);
            assert_eq!([frame.y[3], frame.u[0], frame.v[0]], expected, "{rgb:?}");
        }
    }

    #[test]
    fn units_are_found_between_start_codes() {
        let stream = [0, 0, 0, 1, 7, 9, 0, 0, 0, 1, 8, 0, 0, 1, 5, 1, 2];
        assert_eq!(nal_units(&stream), [&[7, 9][..], &[8], &[5, 1, 2]]);
        assert!(nal_units(&[]).is_empty());
    }

    #[test]
    fn the_first_frame_is_a_key_and_tells_the_colors() {
        let mut stream = Stream::new(32, 16, 25).unwrap();
        let samples: Vec<Sample> = (0..3)
            .map(|i| stream.encode(&vec![40 * i; 32 * 16 * 3]).unwrap())
            .collect();
        assert_eq!(
            samples.iter().map(|s| s.is_key).collect::<Vec<_>>(),
            [true, false, false]
        );
        let sets = stream.parameter_sets();
        assert_eq!((sets.sequence[0] & 31, sets.picture[0] & 31), (7, 8));
        // A decoder still understands the changed set.
        let mut bytes = Vec::new();
        for unit in [&sets.sequence, &sets.picture] {
            bytes.extend_from_slice(&[0, 0, 0, 1]);
            bytes.extend_from_slice(unit);
        }
        for sample in &samples {
            bytes.extend_from_slice(&[0, 0, 0, 1]);
            bytes.extend_from_slice(&sample.data[4..]);
        }
        let frames = rusty_h264::Decoder::new().decode_stream(&bytes).unwrap();
        let shown: Vec<u8> = frames.iter().map(|frame| frame.y[100]).collect();
        let expected = [16, 50, 85];
        for (shown, expected) in shown.iter().zip(expected) {
            assert!(shown.abs_diff(expected) <= 2, "{shown} {expected}");
        }
        assert_eq!(
            (frames.len(), frames[0].width, frames[0].height),
            (3, 32, 16)
        );
    }
}
