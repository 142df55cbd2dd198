//! Which flight the options ask for.

use super::failure::Failure;
use super::studio::Run;
use super::viewpoint;
use crate::animation::route::{self, RouteError};
use crate::animation::{FilmShape, Flight, KeyFrames, Moment, Speed, SunPlace};
use crate::camera::{Camera, CameraError, View};
use crate::diag::Diagnostic;
use crate::options::value::Daylight;
use crate::options::{Options, Origin};
use crate::scene::Scene;
use glam::DVec3;
use std::num::NonZeroU32;

/// Frames of a flight that has no times of its own.
const USUAL_FRAMES: NonZeroU32 = NonZeroU32::new(120).unwrap();
/// Straight pieces of the camera's way while the shutter is open. An orbit of 24 frames then is off by a tenth of a thousandth of its
/// radius.
const SHUTTER_PIECES: u32 = 8;
/// What a flight can be, for people.
const WAYS: &str = "`--orbit` flies once round the model, `--turntable` turns it, `--flyover METRES` and `--walk METRES` cross it, \
                    `--key` or `[[fly.key]]` in the file beside the model flies through key frames, `--grow A..B` lets it grow";

/// Refuses what cannot be a flight, before the model is grown.
///
/// # Errors
/// No way or several, frames that the flight does not have.
pub fn check(options: &Options) -> Result<(), Failure> {
    let usage = |text: String| Err(Failure::Usage(text));
    let ways = ways(options);
    match ways[..] {
        [] if options.grow.value.is_none() => {
            return usage(format!("a flight needs a path: {WAYS}"));
        }
        [one, other, ..] => {
            return usage(format!(
                "`{one}` and `{other}` are two paths: a flight has one"
            ));
        }
        _ => {}
    }
    let keys = options.key.value.as_ref();
    let has_step = keys.is_some_and(|keys| keys.frames().iter().any(|key| key.step.is_some()));
    if has_step && options.grow.value.is_some() {
        return usage("the steps of the key frames and `grow` both say how far the model has grown: give one of them".into());
    }
    if options.even_speed.value
        && keys.is_none_or(|keys| keys.frames().iter().all(|key| key.eye.is_none()))
    {
        return usage(
            "`even-speed` needs key frames with an `eye`: nothing else has a speed of its own"
                .into(),
        );
    }
    if let Some(keys) = keys {
        check_length(keys, options)?;
    }
    let length = n_frames(options);
    match &options.frames.value {
        Some(frames) if frames.end > length.get() => usage(format!(
            "`frames` {}..{} reach beyond the flight's {length} frames; `--flight-frames {}` makes it longer",
            frames.start, frames.end, frames.end
        )),
        _ => Ok(()),
    }
}

/// Whether rays find the way.
fn is_found(options: &Options) -> bool {
    options.flyover.value.is_some() || options.walk.value.is_some()
}

/// The way that rays find through the scene, if the options want one. What key frames say of sun, steps and field of view comes
/// along: their times are spread over the way.
fn found(options: &Options, scene: &Scene) -> Result<Option<KeyFrames>, RouteError> {
    let keys = options
        .key
        .value
        .as_ref()
        .map_or(&[][..], KeyFrames::frames);
    let eyes: Vec<DVec3> = keys.iter().filter_map(|key| key.eye).collect();
    let way = if eyes.len() >= 2 {
        eyes.iter().map(|eye| eye.truncate()).collect()
    } else {
        route::across(scene)?
    };
    let found = if let Some(height) = options.flyover.value {
        route::flyover(scene, &way, height.0)?
    } else if let Some(height) = options.walk.value {
        let level = eyes.first().filter(|_| eyes.len() >= 2).map(|eye| eye.z);
        route::walk(scene, &way, level, height.0)?
    } else {
        return Ok(None);
    };
    let mut frames = found.frames().to_vec();
    let span = (
        keys.first().map_or(0.0, |key| key.time),
        keys.last().map_or(1.0, |key| key.time),
    );
    let last = frames.len() - 1;
    for key in keys {
        let part = (key.time - span.0) / (span.1 - span.0);
        let frame = &mut frames[(part * last as f64).round() as usize];
        (frame.fov, frame.step, frame.sun) = (key.fov, key.step, key.sun);
        frame.stops = key.stops;
    }
    Ok(KeyFrames::new(frames).ok())
}

/// The ways of the camera that the options name.
fn ways(options: &Options) -> Vec<&'static str> {
    let all = [
        ("orbit", options.orbit.value),
        ("turntable", options.turntable.value),
        ("flyover", options.flyover.value.is_some()),
        ("walk", options.walk.value.is_some()),
        ("key", options.key.value.is_some() && !is_found(options)),
    ];
    all.iter()
        .filter(|(_, is_wanted)| *is_wanted)
        .map(|(name, _)| *name)
        .collect()
}

/// Refuses key frames that take longer than any film.
fn check_length(keys: &KeyFrames, options: &Options) -> Result<(), Failure> {
    let (start, end) = keys.span();
    let frames = (end - start) * f64::from(options.fps.value.0.get());
    if options.flight_frames.value.is_none() && frames >= 1_000_000.0 {
        let message = format!(
            "the key frames take {} s, which is {frames:.0} frames at {} per second: times are in seconds, and a film has at most 1000000 frames",
            end - start,
            options.fps.value.0
        );
        return Err(Failure::Usage(message));
    }
    Ok(())
}

/// How many frames the flight has.
fn n_frames(options: &Options) -> NonZeroU32 {
    if let Some(n) = options.flight_frames.value {
        return n.0;
    }
    let Some(keys) = &options.key.value else {
        return USUAL_FRAMES;
    };
    let (start, end) = keys.span();
    let frames = ((end - start) * f64::from(options.fps.value.0.get())).round();
    // One more than there are gaps between frames.
    NonZeroU32::MIN.saturating_add(frames as u32)
}

/// Size, rate and length of the film.
pub fn shape(options: &Options) -> FilmShape {
    FilmShape {
        width: options.size.value.width,
        height: options.size.value.height,
        fps: options.fps.value.0.get(),
        n_frames: n_frames(options).get(),
    }
}

/// The step of the largest model that the film shows, if it grows: the one to choose the view by.
pub fn last_step(options: &Options) -> Option<f64> {
    if let Some(growth) = &options.grow.value {
        return Some(f64::from(growth.end));
    }
    let keys = options.key.value.as_ref()?;
    keys.frames()
        .iter()
        .filter_map(|key| key.step)
        .reduce(f64::max)
}

/// The flight that the options ask for through a scene.
///
/// # Errors
/// If rays are to find the way and find none.
pub fn flight_through(options: &Options, start: View, scene: &Scene) -> Result<Flight, Failure> {
    let keys = found(options, scene).map_err(|error| Failure::Usage(error.to_string()))?;
    let Some(keys) = keys else {
        return Ok(flight(options, start));
    };
    let flight = Flight::keys(start, n_frames(options), &keys, Speed::Even);
    Ok(match &options.grow.value {
        Some(growth) => flight.growing(growth),
        None => flight,
    })
}

/// The flight that the options ask for, from this view, if no rays are to find the way.
pub fn flight(options: &Options, start: View) -> Flight {
    let n = n_frames(options);
    let flight = if options.orbit.value {
        Flight::orbit(start, n)
    } else if options.turntable.value {
        let sun = match options.sun.value {
            Daylight::Sun { azimuth, elevation } => Some(SunPlace {
                azimuth: azimuth.degrees(),
                elevation: elevation.degrees(),
            }),
            Daylight::Auto | Daylight::None => None,
        };
        Flight::turntable(start, n, sun)
    } else if let Some(keys) = &options.key.value {
        let speed = if options.even_speed.value {
            Speed::Even
        } else {
            Speed::Timed
        };
        Flight::keys(start, n, keys, speed)
    } else {
        Flight::still(start, n)
    };
    match &options.grow.value {
        Some(growth) => flight.growing(growth),
        None => flight,
    }
}

/// The camera of each frame.
///
/// # Errors
/// The first frame in which there can be no camera, and why.
pub fn cameras(run: &Run, flight: &Flight) -> Result<Vec<(Moment, Camera)>, Failure> {
    let options = &run.options;
    let made = flight.all().map(|frame| {
        let moment = flight.moment(frame);
        let camera = exposed(options, flight, frame).map_err(|error| {
            let seconds = f64::from(frame) / f64::from(options.fps.value.0.get());
            let message = format!("in frame {frame} of the flight ({seconds:.2} s) {error}");
            match options.key.origin {
                Origin::Sidecar(span) if options.key.value.is_some() => {
                    let fault = Diagnostic::error("camera", span, message);
                    Failure::model(&run.sources.map, fault)
                }
                _ => Failure::Usage(message),
            }
        })?;
        Ok((moment, camera))
    });
    made.collect()
}

/// The camera of one frame, which moves while the shutter is open.
fn exposed(options: &Options, flight: &Flight, frame: u32) -> Result<Camera, CameraError> {
    let camera_of = |view: &View| viewpoint::through_lens(options, view);
    let camera = camera_of(&flight.view(frame))?;
    let shutter = options.shutter.value.0;
    if shutter == 0.0 {
        return Ok(camera);
    }
    let later: Result<Vec<Camera>, CameraError> = (1..=SHUTTER_PIECES)
        .map(|i| f64::from(i) / f64::from(SHUTTER_PIECES) * shutter)
        .map(|part| camera_of(&flight.view_after(frame, part)))
        .collect();
    Ok(camera.moving_through(&later?))
}

/// The view that the options alone decide, if no scene is needed for it.
pub fn decided(options: &Options) -> Option<View> {
    if is_found(options) {
        return None;
    }
    let says_all = options.key.value.as_ref().is_some_and(|keys| {
        let keys = keys.frames();
        keys.iter().any(|key| key.eye.is_some()) && keys.iter().any(|key| key.target.is_some())
    });
    viewpoint::decided(options, says_all)
}

#[cfg(test)]
mod tests {
    use super::*;

    fn options(set: &[(&str, &str)]) -> Options {
        let mut options = Options::default();
        for (key, text) in set {
            options.set(key, text, Origin::Flag).unwrap();
        }
        options
    }

    #[test]
    fn a_flight_has_one_path() {
        let refused = |set: &[(&str, &str)]| match check(&options(set)) {
            Err(Failure::Usage(text)) => text,
            other => panic!("{other:?}"),
        };
        assert!(refused(&[]).contains("--orbit"));
        assert!(refused(&[("orbit", "true"), ("turntable", "true")]).contains("two paths"));
        assert!(refused(&[("walk", "1.7"), ("flyover", "9")]).contains("two paths"));
        let eyes = ("key", "time=0 eye=0,0,0; time=1 eye=9,0,0");
        assert!(check(&options(&[("walk", "1.7"), eyes])).is_ok());
        assert!(refused(&[("orbit", "true"), ("even-speed", "true")]).contains("key frames"));
        assert!(
            refused(&[("orbit", "true"), ("frames", "119..121")]).contains("--flight-frames 121")
        );
        let keys = "time=0 step=1; time=9 step=4";
        assert!(refused(&[("key", keys), ("grow", "0..4")]).contains("both"));
        assert!(refused(&[("key", "time=0; time=1e9")]).contains("1000000 frames"));
        assert!(check(&options(&[("grow", "0..4")])).is_ok());
        assert!(check(&options(&[("orbit", "true"), ("grow", "0..4")])).is_ok());
    }

    #[test]
    fn key_frames_take_as_many_frames_as_their_times() {
        let keys = ("key", "time=1; time=5");
        assert_eq!(shape(&options(&[keys])).n_frames, 101);
        assert_eq!(shape(&options(&[keys, ("fps", "10")])).n_frames, 41);
        assert_eq!(shape(&options(&[keys, ("flight-frames", "7")])).n_frames, 7);
        assert_eq!(shape(&options(&[("orbit", "true")])).n_frames, 120);
    }
}
