//! The kinds of values options have, and how each is written.

use crate::color::Rgb;
use crate::integrator::final_gather::MOST_GATHER_RAYS;
use crate::integrator::requirements::Features;
use crate::math::angle::Angle;
use crate::turtle::Layers;
use glam::DVec3;
use std::fmt::Debug;
use std::num::{NonZeroU32, NonZeroU64, NonZeroUsize};
use std::ops::Range;

/// A value that can be read from a word of the command line or of the file beside a model.
///
/// Its `Debug` text is canonical: equal values have equal texts, and that text is what caches are keyed by.
pub trait OptionValue: Sized + Clone + Debug {
    /// Reads it.
    ///
    /// # Errors
    /// What is allowed, as it continues the sentence "`key` must be …".
    fn parse(text: &str) -> Result<Self, String>;
}

/// Which method computes the light.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Renderer {
    /// Path tracing: unbiased, all light paths, noise that falls with the number of samples.
    Path,
    /// Standard ray tracing: direct light, and what mirrors and glass show of it.
    Raytracer,
    /// Photon mapping: light is followed once from its sources and stored, for every camera.
    Photon,
    /// Radiosity: what matt surfaces send each other, solved once on the surfaces, for every camera.
    Radiosity,
}

impl Renderer {
    /// Its name, as it is written.
    pub fn name(self) -> &'static str {
        match self {
            Self::Path => "path",
            Self::Raytracer => "raytracer",
            Self::Photon => "photon",
            Self::Radiosity => "radiosity",
        }
    }
}

/// How many photons, 0 to 10⁹.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct PhotonCount(pub u64);

/// The most photons that may be asked for.
const MOST_PHOTONS: u64 = 1_000_000_000;

impl OptionValue for PhotonCount {
    fn parse(text: &str) -> Result<Self, String> {
        match text.replace('_', "").parse() {
            Ok(n) if n <= MOST_PHOTONS => Ok(Self(n)),
            _ => Err("a whole number from 0 to 1000000000".into()),
        }
    }
}

/// Rays of a final gather, 0 (none) to 65536; as many as suit the renderer if nobody says.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct GatherRays(pub Option<u32>);

/// Rays of a gather over photons where nobody says: a map is always blurred.
const RAYS_OVER_PHOTONS: u32 = 256;

impl GatherRays {
    /// How many they are by this renderer.
    #[must_use]
    pub fn by(self, renderer: Renderer) -> u32 {
        match (self.0, renderer) {
            (Some(n), _) => n,
            (None, Renderer::Photon) => RAYS_OVER_PHOTONS,
            (None, Renderer::Path | Renderer::Raytracer | Renderer::Radiosity) => 0,
        }
    }
}

impl OptionValue for GatherRays {
    fn parse(text: &str) -> Result<Self, String> {
        match text.replace('_', "").parse() {
            Ok(n) if n <= MOST_GATHER_RAYS => Ok(Self(Some(n))),
            _ if text == "auto" => Ok(Self(None)),
            _ => Err("a whole number from 0 to 65536, or `auto`".into()),
        }
    }
}

impl OptionValue for Features {
    fn parse(text: &str) -> Result<Self, String> {
        text.parse()
    }
}

/// An area in square metres, more than 0.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Area(pub f64);

impl OptionValue for Area {
    fn parse(text: &str) -> Result<Self, String> {
        match text.parse::<f64>() {
            Ok(area) if area > 0.0 && area.is_finite() => Ok(Self(area)),
            _ => Err("a number of square metres greater than 0".into()),
        }
    }
}

/// How many samples a pixel has along each side.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct GridSize(pub NonZeroU32);

impl GridSize {
    /// Samples per pixel.
    pub fn samples(self) -> NonZeroU32 {
        self.0.saturating_mul(self.0)
    }
}

impl OptionValue for GridSize {
    fn parse(text: &str) -> Result<Self, String> {
        let side = text.parse::<NonZeroU32>().ok();
        side.filter(|side| side.get() <= 1000)
            .map(Self)
            .ok_or_else(|| "a whole number from 1 to 1000".into())
    }
}

/// A named set of values between haste and care.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Quality {
    /// Seconds: to see the shape.
    Draft,
    /// The defaults.
    Preview,
    /// For keeping.
    Final,
}

impl Quality {
    /// Its name, as it is written.
    pub fn name(self) -> &'static str {
        match self {
            Self::Draft => "draft",
            Self::Preview => "preview",
            Self::Final => "final",
        }
    }
}

/// Width and height of a picture in pixels, each at least 1.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Size {
    /// Columns.
    pub width: u32,
    /// Rows.
    pub height: u32,
}

impl Size {
    /// Width over height.
    pub fn aspect(self) -> f64 {
        f64::from(self.width) / f64::from(self.height)
    }

    /// Number of pixels.
    pub fn pixels(self) -> u64 {
        u64::from(self.width) * u64::from(self.height)
    }
}

/// Whether a model is given daylight.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Daylight {
    /// If it has no light of its own.
    Auto,
    /// Never.
    None,
    /// Always, with the sun here.
    Sun {
        /// Clockwise from north (+y) as seen from above: 90° is east (+x).
        azimuth: Angle,
        /// Above the horizon, 0° to 90°.
        elevation: Angle,
    },
}

/// Whether a model is given a ground to stand on.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Ground {
    /// If it stands in the daylight that [`Daylight::Auto`] gave it and has no ground of its own.
    Auto,
    /// Never.
    None,
    /// Always, of this reflectance.
    Color(Rgb),
}

impl OptionValue for Renderer {
    fn parse(text: &str) -> Result<Self, String> {
        match text {
            "path" => Ok(Self::Path),
            "raytracer" => Ok(Self::Raytracer),
            "photon" => Ok(Self::Photon),
            "radiosity" => Ok(Self::Radiosity),
            _ => Err("`path`, `raytracer`, `photon` or `radiosity`".into()),
        }
    }
}

impl OptionValue for Quality {
    fn parse(text: &str) -> Result<Self, String> {
        match text {
            "draft" => Ok(Self::Draft),
            "preview" => Ok(Self::Preview),
            "final" => Ok(Self::Final),
            _ => Err("`draft`, `preview` or `final`".into()),
        }
    }
}

impl OptionValue for Size {
    fn parse(text: &str) -> Result<Self, String> {
        let side = |t: &str| t.trim().parse::<NonZeroU32>().ok().map(NonZeroU32::get);
        text.split_once(['x', '×', ','])
            .and_then(|(w, h)| {
                Some(Self {
                    width: side(w)?,
                    height: side(h)?,
                })
            })
            .ok_or_else(|| "WIDTHxHEIGHT in pixels, such as 960x640".into())
    }
}

impl OptionValue for Daylight {
    fn parse(text: &str) -> Result<Self, String> {
        match text {
            "auto" => return Ok(Self::Auto),
            "none" => return Ok(Self::None),
            _ => {}
        }
        match numbers::<2>(text) {
            Some([azimuth, elevation]) if (0.0..=90.0).contains(&elevation) => Ok(Self::Sun {
                azimuth: Angle::deg(azimuth),
                elevation: Angle::deg(elevation),
            }),
            _ => Err(
                "AZIMUTH,ELEVATION in degrees with an elevation from 0 to 90, \
                      or `auto` or `none`"
                    .into(),
            ),
        }
    }
}

impl OptionValue for Ground {
    fn parse(text: &str) -> Result<Self, String> {
        match text {
            "auto" => return Ok(Self::Auto),
            "none" => return Ok(Self::None),
            _ => {}
        }
        match numbers::<3>(text) {
            Some(rgb) if rgb.iter().all(|c| (0.0..=1.0).contains(c)) => {
                Ok(Self::Color(Rgb::new(rgb[0], rgb[1], rgb[2])))
            }
            _ => Err("R,G,B (reflectances from 0 to 1), or `auto` or `none`".into()),
        }
    }
}

impl OptionValue for Layers {
    fn parse(text: &str) -> Result<Self, String> {
        text.parse().map_err(str::to_owned)
    }
}

impl OptionValue for DVec3 {
    fn parse(text: &str) -> Result<Self, String> {
        let expected = || "X,Y,Z (three finite numbers)".to_owned();
        numbers::<3>(text)
            .map(Self::from_array)
            .ok_or_else(expected)
    }
}

/// A field of view: more than 0° and less than 180°.
impl OptionValue for Angle {
    fn parse(text: &str) -> Result<Self, String> {
        match text.parse::<f64>() {
            Ok(degrees) if degrees > 0.0 && degrees < 180.0 => Ok(Self::deg(degrees)),
            _ => Err("an angle of more than 0 and less than 180 degrees".into()),
        }
    }
}

/// A half-open range of frame numbers that holds at least one.
impl OptionValue for Range<u32> {
    fn parse(text: &str) -> Result<Self, String> {
        text.split_once("..")
            .and_then(|(a, b)| Some(a.trim().parse().ok()?..b.trim().parse().ok()?))
            .filter(|range: &Self| !range.is_empty())
            .ok_or_else(|| "A..B with A less than B (B itself is not among them)".into())
    }
}

/// A number of bytes.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Bytes(pub u64);

impl OptionValue for Bytes {
    fn parse(text: &str) -> Result<Self, String> {
        let shift = match text.bytes().last() {
            Some(b'K' | b'k') => 10,
            Some(b'M' | b'm') => 20,
            Some(b'G' | b'g') => 30,
            _ => 0,
        };
        let digits = if shift == 0 {
            text
        } else {
            &text[..text.len() - 1]
        };
        let bytes = digits.trim().parse::<NonZeroU64>().ok();
        bytes
            .and_then(|n| n.get().checked_mul(1 << shift))
            .map(Self)
            .ok_or_else(|| "a number of bytes, such as 512M or 8G".into())
    }
}

/// A number of threads, 1 to 1024.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Threads(pub NonZeroUsize);

impl OptionValue for Threads {
    fn parse(text: &str) -> Result<Self, String> {
        match text.parse::<NonZeroUsize>() {
            Ok(threads) if threads.get() <= 1024 => Ok(Self(threads)),
            _ => Err("a whole number from 1 to 1024".into()),
        }
    }
}

/// Seconds, more than 0.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Seconds(pub f64);

impl OptionValue for Seconds {
    fn parse(text: &str) -> Result<Self, String> {
        match text.parse::<f64>() {
            Ok(seconds) if seconds > 0.0 && seconds.is_finite() => Ok(Self(seconds)),
            _ => Err("a number of seconds greater than 0".into()),
        }
    }
}

/// Haze of the air: 1 clear, 10 thick.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Turbidity(pub f64);

impl OptionValue for Turbidity {
    fn parse(text: &str) -> Result<Self, String> {
        match text.parse::<f64>() {
            Ok(turbidity) if (1.0..=10.0).contains(&turbidity) => Ok(Self(turbidity)),
            _ => Err("a number from 1 (clear) to 10 (haze)".into()),
        }
    }
}

/// How bright the sky is, watts per square metre; greater than 0.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Brightness(pub f64);

impl OptionValue for Brightness {
    fn parse(text: &str) -> Result<Self, String> {
        match text.parse::<f64>() {
            Ok(power) if power > 0.0 && power.is_finite() => Ok(Self(power)),
            _ => Err("a number of watts per square metre above 0".into()),
        }
    }
}

impl OptionValue for f64 {
    fn parse(text: &str) -> Result<Self, String> {
        match text.parse::<Self>() {
            Ok(number) if number.is_finite() => Ok(number),
            _ => Err("a finite number".into()),
        }
    }
}

impl OptionValue for bool {
    fn parse(text: &str) -> Result<Self, String> {
        text.parse().map_err(|_| "`true` or `false`".into())
    }
}

impl OptionValue for String {
    fn parse(text: &str) -> Result<Self, String> {
        if text.is_empty() {
            Err("a name".into())
        } else {
            Ok(text.to_owned())
        }
    }
}

/// `auto` or `none`, or a value.
impl<T: OptionValue> OptionValue for Option<T> {
    fn parse(text: &str) -> Result<Self, String> {
        match text {
            "auto" | "none" => Ok(None),
            // Which of the two words fits is known by the default.
            _ => T::parse(text).map(Some),
        }
    }
}

/// Whole numbers: each type with the words for its range.
macro_rules! whole_numbers {
    ($($type:ty: $expected:literal;)*) => {$(
        impl OptionValue for $type {
            fn parse(text: &str) -> Result<Self, String> {
                text.replace('_', "").parse().map_err(|_| $expected.into())
            }
        }
    )*};
}

whole_numbers! {
    u32: "a whole number from 0 up";
    i64: "a whole number of 64 bits";
    NonZeroU32: "a whole number from 1 up";
    NonZeroU64: "a whole number from 1 up";
}

/// `N` finite numbers between commas.
pub(super) fn numbers<const N: usize>(text: &str) -> Option<[f64; N]> {
    let mut numbers = [0.0; N];
    let mut words = text.split(',');
    for number in &mut numbers {
        *number = words
            .next()?
            .trim()
            .parse()
            .ok()
            .filter(|n: &f64| n.is_finite())?;
    }
    words.next().is_none().then_some(numbers)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn values_are_read_as_they_are_written() {
        assert_eq!(
            Size::parse("640x480"),
            Ok(Size {
                width: 640,
                height: 480
            })
        );
        assert_eq!(
            DVec3::parse("1, -2.5,3e2"),
            Ok(DVec3::new(1.0, -2.5, 300.0))
        );
        assert_eq!(Range::parse("2..4"), Ok(2..4));
        assert_eq!(Bytes::parse("2G"), Ok(Bytes(2 << 30)));
        assert_eq!(Option::<f64>::parse("auto"), Ok(None));
        assert_eq!(
            NonZeroU64::parse("50_000_000").map(NonZeroU64::get),
            Ok(50_000_000)
        );
        let sun = Daylight::Sun {
            azimuth: Angle::deg(135.0),
            elevation: Angle::deg(40.0),
        };
        assert_eq!(Daylight::parse("135,40"), Ok(sun));
    }

    #[test]
    fn values_that_are_none_are_refused_with_what_is_allowed() {
        assert!(Size::parse("0x480").unwrap_err().contains("WIDTHxHEIGHT"));
        assert!(Size::parse("640").is_err());
        assert!(DVec3::parse("1,NaN,3").unwrap_err().contains("finite"));
        assert!(DVec3::parse("1,2").is_err() && DVec3::parse("1,2,3,4").is_err());
        assert!(Range::parse("5..2").unwrap_err().contains("A less than B"));
        assert!(Range::parse("2..2").is_err());
        assert!(NonZeroU32::parse("0").unwrap_err().contains("from 1"));
        assert!(Bytes::parse("G").is_err() && Bytes::parse("99999999999G").is_err());
        assert!(Bytes::parse("é").is_err() && Bytes::parse("").is_err());
        assert!(Angle::parse("180").is_err() && Angle::parse("nan").is_err());
        assert!(
            Renderer::parse("radiance")
                .unwrap_err()
                .contains("`radiosity`")
        );
        assert!(Daylight::parse("10,91").is_err());
        assert!(Ground::parse("1,1,2").is_err());
        assert!(Threads::parse("0").is_err() && Threads::parse("100000").is_err());
    }
}
