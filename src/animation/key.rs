//! Key frames: what the user says of single moments of a flight.
//!
//! As a text, key frames are separated by `;` and consist of words `name=value`:
//! `time=0 eye=0,-9,2 target=0,0,1; time=4 eye=5,-7,3`. What a key frame leaves out goes on between its neighbours.

use crate::diag::nearest;
use crate::math::angle::Angle;
use glam::DVec3;
use std::fmt;

/// Where the sun stands.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct SunPlace {
    /// Clockwise from north (+y) as seen from above, in degrees.
    pub azimuth: f64,
    /// Above the horizon, in degrees, 0 to 90.
    pub elevation: f64,
}

/// One moment of a flight.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct KeyFrame {
    /// Seconds from the beginning.
    pub time: f64,
    /// Where the camera stands, in metres.
    pub eye: Option<DVec3>,
    /// What it looks at, in metres.
    pub target: Option<DVec3>,
    /// Its vertical field of view.
    pub fov: Option<Angle>,
    /// How far the model has grown, in steps, not always whole ones.
    pub step: Option<f64>,
    /// Where the sun stands.
    pub sun: Option<SunPlace>,
    /// By how many photographic stops it is shown brighter than the film's exposure would show it; -20 to 20.
    pub stops: Option<f64>,
}

/// What a key frame can say.
pub const NAMES: [&str; 7] = ["time", "eye", "target", "fov", "step", "sun", "stops"];
/// The most steps that a key frame may ask for.
const MOST_STEPS: f64 = u32::MAX as f64;

impl KeyFrame {
    /// Takes over one word.
    ///
    /// # Errors
    /// If there is no such name, or its value is not one of its kind: what is wrong, and what is allowed.
    pub fn set(&mut self, name: &str, text: &str) -> Result<(), String> {
        let wrong = |allowed: &str| Err(format!("`{name}` must be {allowed}, not `{text}`"));
        let one = numbers::<1>(text).map(|[number]| number);
        match name {
            "time" => match one {
                Some(time) if time >= 0.0 => self.time = time,
                _ => return wrong("a number of seconds from 0 up"),
            },
            "eye" | "target" => match numbers(text).map(DVec3::from_array) {
                Some(point) if name == "eye" => self.eye = Some(point),
                Some(point) => self.target = Some(point),
                None => return wrong("X,Y,Z (three finite numbers)"),
            },
            "fov" => match one {
                Some(fov) if fov > 0.0 && fov < 180.0 => self.fov = Some(Angle::deg(fov)),
                _ => return wrong("an angle of more than 0 and less than 180 degrees"),
            },
            "step" => match one {
                Some(step) if (0.0..=MOST_STEPS).contains(&step) => self.step = Some(step),
                _ => return wrong("a number of steps from 0 up"),
            },
            "sun" => match numbers(text) {
                Some([azimuth, elevation]) if (0.0..=90.0).contains(&elevation) => {
                    self.sun = Some(SunPlace { azimuth, elevation });
                }
                _ => return wrong("AZIMUTH,ELEVATION in degrees with an elevation from 0 to 90"),
            },
            "stops" => match one {
                Some(stops) if (-20.0..=20.0).contains(&stops) => self.stops = Some(stops),
                _ => return wrong("a number of photographic stops from -20 to 20"),
            },
            _ => {
                let hint = match nearest(name, NAMES) {
                    Some(near) => format!("did you mean `{near}`?"),
                    None => format!("it has {}", NAMES.join(", ")),
                };
                return Err(format!("a key frame has no `{name}`: {hint}"));
            }
        }
        Ok(())
    }
}

impl fmt::Display for KeyFrame {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "time={}", self.time)?;
        for (name, point) in [("eye", self.eye), ("target", self.target)] {
            if let Some(p) = point {
                write!(f, " {name}={},{},{}", p.x, p.y, p.z)?;
            }
        }
        if let Some(fov) = self.fov {
            write!(f, " fov={}", fov.degrees())?;
        }
        if let Some(step) = self.step {
            write!(f, " step={step}")?;
        }
        if let Some(sun) = self.sun {
            write!(f, " sun={},{}", sun.azimuth, sun.elevation)?;
        }
        if let Some(stops) = self.stops {
            write!(f, " stops={stops}")?;
        }
        Ok(())
    }
}

/// Two key frames or more, at increasing times.
#[derive(Clone, Debug, PartialEq)]
pub struct KeyFrames(Vec<KeyFrame>);

/// Which key frame (counted from 0) is wrong, and how.
pub type KeyFault = (usize, String);

impl KeyFrames {
    /// Checks them.
    ///
    /// # Errors
    /// If there are fewer than two, their times do not increase, or an eye is its own target.
    pub fn new(frames: Vec<KeyFrame>) -> Result<Self, KeyFault> {
        match frames.len() {
            0 => {
                return Err((
                    0,
                    "there are no key frames: a flight needs two or more".into(),
                ));
            }
            1 => {
                let message = "one key frame is no flight: it needs a second one to fly to";
                return Err((0, message.into()));
            }
            _ => {}
        }
        for (i, frame) in frames.iter().enumerate() {
            let before = i.checked_sub(1).map(|i| frames[i].time);
            if let Some(before) = before.filter(|before| *before >= frame.time) {
                let message = format!(
                    "key frame {} is at {} s, not after the one before it at {before} s: key frames stand in the order of their times",
                    i + 1,
                    frame.time
                );
                return Err((i, message));
            }
            if frame.eye.is_some() && frame.eye == frame.target {
                let message = format!(
                    "eye and target of key frame {} are the same point: the camera would look nowhere",
                    i + 1
                );
                return Err((i, message));
            }
        }
        Ok(Self(frames))
    }

    /// Reads the text form; see [the module](self).
    ///
    /// # Errors
    /// Which key frame is wrong, and how.
    pub fn parse(text: &str) -> Result<Self, KeyFault> {
        let mut frames = Vec::new();
        for (i, words) in text.split(';').enumerate() {
            if words.trim().is_empty() {
                continue;
            }
            let mut frame = KeyFrame::default();
            let mut has_time = false;
            for word in words.split_whitespace() {
                let (name, value) = word.split_once('=').ok_or_else(|| {
                    (
                        i,
                        format!("`{word}` in key frame {} is not NAME=VALUE", i + 1),
                    )
                })?;
                frame
                    .set(name, value)
                    .map_err(|why| (i, format!("key frame {}: {why}", i + 1)))?;
                has_time |= name == "time";
            }
            if !has_time {
                return Err((i, no_time(i)));
            }
            frames.push(frame);
        }
        Self::new(frames)
    }

    /// The key frames, in the order of their times.
    pub fn frames(&self) -> &[KeyFrame] {
        &self.0
    }

    /// The time of the first and that of the last, in seconds.
    pub fn span(&self) -> (f64, f64) {
        let time = |frame: Option<&KeyFrame>| frame.map_or(0.0, |frame| frame.time);
        (time(self.0.first()), time(self.0.last()))
    }
}

/// What to say of a key frame (counted from 0) without a time.
pub fn no_time(i: usize) -> String {
    format!("key frame {} has no `time`", i + 1)
}

impl fmt::Display for KeyFrames {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        for (i, frame) in self.0.iter().enumerate() {
            let gap = if i == 0 { "" } else { "; " };
            write!(f, "{gap}{frame}")?;
        }
        Ok(())
    }
}

/// `N` finite numbers between commas.
fn numbers<const N: usize>(text: &str) -> Option<[f64; N]> {
    let mut words = text.split(',');
    let mut found = [0.0; N];
    for number in &mut found {
        let word = words.next()?.trim();
        *number = word
            .parse()
            .ok()
            .filter(|number: &f64| number.is_finite())?;
    }
    words.next().is_none().then_some(found)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_text_form_is_read_as_it_is_written() {
        let text = "time=0 eye=0,-9,2 target=0,0,1 fov=40; time=2.5 eye=1,2,3 step=4.5 sun=135,40 stops=-1.5";
        let keys = KeyFrames::parse(text).unwrap();
        assert_eq!(keys.to_string(), text);
        assert_eq!(keys.span(), (0.0, 2.5));
        assert_eq!(KeyFrames::parse(&format!(" {text} ; ")), Ok(keys));
    }

    #[test]
    fn each_wrong_flight_is_told_what_is_wrong_with_it() {
        for (text, at, words) in [
            ("", 0, "no key frames"),
            ("time=1 eye=0,0,1", 0, "one key frame"),
            ("time=1; time=1", 1, "not after"),
            (
                "time=2; time=3; time=1",
                2,
                "not after the one before it at 3 s",
            ),
            ("time=0; time=1 eye=1,2,3 target=1,2,3", 1, "same point"),
            ("time=NaN; time=1", 0, "from 0 up"),
            ("time=-1; time=1", 0, "from 0 up"),
            ("time=0; time=inf", 1, "from 0 up"),
            ("time=0; time=1 eye=1,NaN,3", 1, "finite"),
            ("time=0; time=1 fov=180", 1, "less than 180"),
            ("time=0; time=1 step=-1", 1, "from 0 up"),
            ("time=0; time=1 step=1e30", 1, "from 0 up"),
            ("time=0; time=1 sun=10,91", 1, "0 to 90"),
            ("time=0; time=1 stops=21", 1, "-20 to 20"),
            ("time=0; time=1 tagret=1,2,3", 1, "`target`"),
            ("time=0; eye=1,2,3", 1, "no `time`"),
            ("time=0; 1,2,3", 1, "NAME=VALUE"),
        ] {
            let (place, message) = KeyFrames::parse(text).unwrap_err();
            assert!(
                place == at && message.contains(words),
                "{text}: {place} {message}"
            );
        }
    }
}
