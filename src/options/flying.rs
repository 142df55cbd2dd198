//! The kinds of values that options of films have.

use super::value::OptionValue;
use crate::animation::KeyFrames;
use std::num::NonZeroU32;

/// How many frames a film has: 1 to 1,000,000.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct FrameCount(pub NonZeroU32);

/// The most frames of a film: their files have six digits.
const MOST_FRAMES: u32 = 1_000_000;

impl OptionValue for FrameCount {
    fn parse(text: &str) -> Result<Self, String> {
        match text.replace('_', "").parse::<NonZeroU32>() {
            Ok(n) if n.get() <= MOST_FRAMES => Ok(Self(n)),
            _ => Err(format!("a whole number from 1 to {MOST_FRAMES}")),
        }
    }
}

/// Frames per second: 1 to 240.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct FrameRate(pub NonZeroU32);

impl OptionValue for FrameRate {
    fn parse(text: &str) -> Result<Self, String> {
        match text.parse::<NonZeroU32>() {
            Ok(rate) if rate.get() <= 240 => Ok(Self(rate)),
            _ => Err("a whole number from 1 to 240".into()),
        }
    }
}

/// A height or a distance in metres, more than 0.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Metres(pub f64);

impl OptionValue for Metres {
    fn parse(text: &str) -> Result<Self, String> {
        match text.parse::<f64>() {
            Ok(metres) if metres > 0.0 && metres.is_finite() => Ok(Self(metres)),
            _ => Err("a number of metres greater than 0".into()),
        }
    }
}

/// How wide a lens is.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Aperture {
    /// Its diameter in metres, more than 0.
    Diameter(f64),
    /// Its focal length over its diameter, more than 0; the focal length is that of a camera for 35 mm film.
    FNumber(f64),
}

impl OptionValue for Aperture {
    fn parse(text: &str) -> Result<Self, String> {
        let (number, make): (_, fn(f64) -> Self) = match text.strip_prefix("f/") {
            Some(number) => (number, Self::FNumber),
            None => (text, Self::Diameter),
        };
        match number.parse::<f64>() {
            Ok(number) if number > 0.0 && number.is_finite() => Ok(make(number)),
            _ => Err("a diameter in metres greater than 0, or an f-number such as `f/2.8`".into()),
        }
    }
}

/// Part of the time between two frames in which the shutter is open: 0 (an instant) to 1.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Shutter(pub f64);

impl OptionValue for Shutter {
    fn parse(text: &str) -> Result<Self, String> {
        match text.parse::<f64>() {
            Ok(part) if (0.0..=1.0).contains(&part) => Ok(Self(part)),
            _ => Err("a number from 0 (no blur) to 1 (open from frame to frame)".into()),
        }
    }
}

/// What the files of single frames are.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum FrameFormat {
    /// 8-bit sRGB.
    Png,
    /// Linear radiance.
    Exr,
}

impl OptionValue for FrameFormat {
    fn parse(text: &str) -> Result<Self, String> {
        match text {
            "png" => Ok(Self::Png),
            "exr" => Ok(Self::Exr),
            _ => Err("`png` or `exr`".into()),
        }
    }
}

impl OptionValue for KeyFrames {
    fn parse(text: &str) -> Result<Self, String> {
        Self::parse(text).map_err(|(_, why)| {
            format!(
                "key frames such as `time=0 eye=0,-9,2 target=0,0,1; time=4 eye=5,-7,3` ({why})"
            )
        })
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn counts_rates_and_distances_have_limits() {
        assert!(FrameCount::parse("0").is_err() && FrameCount::parse("1000001").is_err());
        assert!(FrameRate::parse("241").is_err() && FrameRate::parse("24").is_ok());
        assert!(Metres::parse("-1").is_err() && Metres::parse("inf").is_err());
        assert_eq!(Aperture::parse("f/2.8"), Ok(Aperture::FNumber(2.8)));
        assert_eq!(Aperture::parse("0.1"), Ok(Aperture::Diameter(0.1)));
        for wrong in ["0", "-1", "f/0", "f/", "inf", "NaN", "f2"] {
            assert!(Aperture::parse(wrong).is_err(), "{wrong}");
        }
        assert_eq!(Shutter::parse("0.5"), Ok(Shutter(0.5)));
        assert!(Shutter::parse("1.01").is_err() && Shutter::parse("NaN").is_err());
        let why = <KeyFrames as OptionValue>::parse("time=1").unwrap_err();
        assert!(why.contains("one key frame"), "{why}");
    }
}
