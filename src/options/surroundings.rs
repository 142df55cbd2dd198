//! Values of the options that say what light stands round a model.

use super::value::{OptionValue, numbers};
use crate::color::Rgb;
use crate::light::sun_position::{Moment, Place, YEARS};
use std::path::PathBuf;

/// What the sky is.
#[derive(Clone, Debug, PartialEq)]
pub enum SkyKind {
    /// Clear, where the model is given daylight at all.
    Auto,
    /// Clear, with the sun.
    Clear,
    /// Covered by clouds.
    Overcast,
    /// Equally bright all round, above and below the horizon.
    Uniform,
    /// Of this radiance all round, W/(m² sr); with a sun only if one is asked for.
    Radiance(Rgb),
    /// A panorama.
    Image(PathBuf),
}

impl OptionValue for SkyKind {
    fn parse(text: &str) -> Result<Self, String> {
        if let Some(radiance) = numbers::<3>(text) {
            let is_light = radiance.iter().all(|channel| *channel >= 0.0);
            return is_light
                .then(|| Self::Radiance(Rgb::from_array(radiance)))
                .ok_or_else(|| "a radiance R,G,B of numbers from 0 up".into());
        }
        let path = PathBuf::from(text);
        let suffix = path
            .extension()
            .map(|suffix| suffix.to_string_lossy().to_lowercase());
        match (text, suffix.as_deref()) {
            ("auto", _) => Ok(Self::Auto),
            ("clear", _) => Ok(Self::Clear),
            ("overcast", _) => Ok(Self::Overcast),
            ("uniform", _) => Ok(Self::Uniform),
            (_, Some("exr" | "hdr")) => Ok(Self::Image(path)),
            _ => Err(
                "`auto`, `clear`, `overcast`, `uniform`, a radiance R,G,B, or a panorama `FILE.exr` or `FILE.hdr`"
                    .into(),
            ),
        }
    }
}

/// What the sun gives a surface that faces it, W/m² per channel.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct SunIrradiance(pub Rgb);

impl OptionValue for SunIrradiance {
    fn parse(text: &str) -> Result<Self, String> {
        numbers::<3>(text)
            .filter(|rgb| rgb.iter().all(|channel| *channel >= 0.0))
            .map(|rgb| Self(Rgb::from_array(rgb)))
            .ok_or_else(|| "R,G,B in watts per square metre, from 0 up".into())
    }
}

impl OptionValue for Place {
    fn parse(text: &str) -> Result<Self, String> {
        match numbers::<2>(text) {
            Some([latitude, longitude])
                if (-90.0..=90.0).contains(&latitude) && (-180.0..=180.0).contains(&longitude) =>
            {
                Ok(Self {
                    latitude,
                    longitude,
                })
            }
            _ => Err(
                "LATITUDE,LONGITUDE in degrees, north and east positive, such as 51.5,9.9".into(),
            ),
        }
    }
}

impl OptionValue for Moment {
    fn parse(text: &str) -> Result<Self, String> {
        moment(text).ok_or_else(|| {
            format!(
                "a date and time from {} to {}, YYYY-MM-DDThh:mm with Z or an offset from universal time, such as \
                 2026-06-21T14:00+02:00",
                YEARS.start(),
                YEARS.end()
            )
        })
    }
}

/// The moment of a date and time as ISO 8601 writes it; universal time if there is no offset.
fn moment(text: &str) -> Option<Moment> {
    let (date, time) = text.split_once(['T', ' '])?;
    let mut date = date.splitn(3, '-');
    let (year, month, day) = (date.next()?, date.next()?, date.next()?);
    let (time, offset) = match time.find(['Z', '+', '-']) {
        None => (time, 0.0),
        Some(at) if &time[at..] == "Z" => (&time[..at], 0.0),
        Some(at) => {
            let hours = clock(&time[at + 1..])?;
            let sign = if time[at..].starts_with('-') {
                -1.0
            } else {
                1.0
            };
            (&time[..at], sign * hours)
        }
    };
    let digits = |part: &str| {
        part.bytes()
            .all(|byte| byte.is_ascii_digit())
            .then_some(())
            .and_then(|()| part.parse::<u32>().ok())
    };
    let year = i32::try_from(digits(year)?).ok()?;
    Moment::new(year, digits(month)?, digits(day)?, clock(time)? - offset)
}

/// Hours of `hh:mm` or `hh:mm:ss`.
fn clock(text: &str) -> Option<f64> {
    let mut hours = 0.0;
    let mut unit = 1.0;
    let parts: Vec<&str> = text.split(':').collect();
    if !(2..=3).contains(&parts.len()) {
        return None;
    }
    for (part, limit) in parts.iter().zip([24, 60, 60]) {
        let is_number = part.len() == 2 && part.bytes().all(|byte| byte.is_ascii_digit());
        let value = part
            .parse::<u32>()
            .ok()
            .filter(|value| is_number && *value < limit)?;
        hours += f64::from(value) / unit;
        unit *= 60.0;
    }
    Some(hours)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn times_are_read_with_their_offsets() {
        let noon = Moment::new(2026, 6, 21, 12.0);
        for text in [
            "2026-06-21T12:00Z",
            "2026-06-21T12:00",
            "2026-06-21 12:00:00",
            "2026-06-21T14:00+02:00",
        ] {
            assert_eq!(moment(text), noon, "{text}");
        }
        assert_eq!(
            moment("2026-06-20T22:30-03:30"),
            Moment::new(2026, 6, 20, 26.0)
        );
        for text in [
            "",
            "noon",
            "2026-06-21",
            "2026-02-30T12:00",
            "2026-06-21T24:00",
            "2026-06-21T12:60",
            "2026-06-21T12",
            "2026-06-21T1é:00",
            "2026-06-21T12:00+2",
            "1066-10-14T09:00",
            "2026--6-21T12:00",
            "+2026-06-21T12:00",
        ] {
            assert_eq!(moment(text), None, "{text}");
        }
    }

    #[test]
    fn places_and_skies() {
        assert!(Place::parse("51.5, -9.9").is_ok());
        for text in ["91,0", "0,181", "0", "a,b", "nan,0"] {
            assert!(Place::parse(text).is_err(), "{text}");
        }
        assert_eq!(SkyKind::parse("overcast"), Ok(SkyKind::Overcast));
        assert_eq!(
            SkyKind::parse("a/b.EXR"),
            Ok(SkyKind::Image("a/b.EXR".into()))
        );
        let gray = SkyKind::Radiance(Rgb::splat(0.5));
        assert_eq!(SkyKind::parse("0.5, 0.5, 0.5"), Ok(gray));
        assert_eq!(
            SunIrradiance::parse("1,2,3"),
            Ok(SunIrradiance(Rgb::new(1.0, 2.0, 3.0)))
        );
        assert!(SunIrradiance::parse("1,2,-3").is_err());
        for text in ["", "cloudy", "sky.png", "1,2,-3", "1,2"] {
            assert!(SkyKind::parse(text).is_err(), "{text}");
        }
    }
}
