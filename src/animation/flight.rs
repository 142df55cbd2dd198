//! What each frame of a film shows: where the camera stands, how far the model has grown, where the sun is, how bright it is shown.

use super::key::{KeyFrame, KeyFrames, SunPlace};
use super::spline::{EvenSpeed, Spline, Track};
use crate::camera::View;
use crate::camera::orbit::orbit;
use crate::math::angle::Angle;
use glam::DVec3;
use std::num::NonZeroU32;
use std::ops::Range;

/// What one frame shows.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Moment {
    /// The camera.
    pub view: View,
    /// How far the model has grown, in steps; `None`: as the options say.
    pub step: Option<f64>,
    /// Where the sun stands; `None`: as the options say.
    pub sun: Option<SunPlace>,
    /// By how many photographic stops it is shown brighter than the film's exposure would show it.
    pub stops: f64,
}

/// How fast a way through key frames is flown.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Speed {
    /// Each key frame at its time.
    Timed,
    /// The eye moves evenly from the first key frame to the last; the times of those between only order them.
    Even,
}

/// What moves in a film besides what the options fix.
#[derive(Clone, Debug, PartialEq)]
enum Way {
    /// Nothing of the camera.
    Still,
    /// Once round the target.
    Orbit,
    /// Once round the target, the sun with the camera: as if the model turned.
    Turntable { sun: Option<SunPlace> },
    /// Through points.
    Tracks(Box<Tracks>),
}

/// Curves through key frames.
#[derive(Clone, Debug, PartialEq)]
struct Tracks {
    span: (f64, f64),
    eye: Option<Track>,
    target: Option<Track>,
    fov: Option<Spline>,
    step: Option<Spline>,
    sun: Option<[Spline; 2]>,
    stops: Option<Spline>,
    clock: Option<EvenSpeed>,
}

/// What each frame of a film shows. A pure function of the frame's number.
#[derive(Clone, Debug, PartialEq)]
pub struct Flight {
    start: View,
    n_frames: NonZeroU32,
    way: Way,
    /// Growth from the first step to the second over the whole film.
    growth: Option<(u32, u32)>,
}

impl Flight {
    /// Once round the target of `start` in `n_frames` frames, so that the frame after the last would be the first.
    pub fn orbit(start: View, n_frames: NonZeroU32) -> Self {
        Self::new(start, n_frames, Way::Orbit)
    }

    /// As if the model turned once on a plate before the camera: round its target, and a sun that stands at `sun` first goes
    /// with the camera.
    pub fn turntable(start: View, n_frames: NonZeroU32, sun: Option<SunPlace>) -> Self {
        Self::new(start, n_frames, Way::Turntable { sun })
    }

    /// A camera that stands still.
    pub fn still(start: View, n_frames: NonZeroU32) -> Self {
        Self::new(start, n_frames, Way::Still)
    }

    /// Through key frames; what none of them says is as in `start`.
    pub fn keys(start: View, n_frames: NonZeroU32, keys: &KeyFrames, speed: Speed) -> Self {
        let tracks = Tracks::new(keys, speed);
        Self::new(start, n_frames, Way::Tracks(Box::new(tracks)))
    }

    /// The same flight while the model grows from step `growth.start` in the first frame to step `growth.end` in the last.
    #[must_use]
    pub fn growing(self, growth: &Range<u32>) -> Self {
        Self {
            growth: Some((growth.start, growth.end)),
            ..self
        }
    }

    fn new(start: View, n_frames: NonZeroU32, way: Way) -> Self {
        Self {
            start,
            n_frames,
            way,
            growth: None,
        }
    }

    /// What frame `frame` shows; a round that goes on after its last frame begins again.
    pub fn moment(&self, frame: u32) -> Moment {
        let mut moment = self.moment_of_way(frame, 0.0);
        if let Some((from, to)) = self.growth {
            let part = self.part(frame, 0.0);
            moment.step = Some(f64::from(from) + (f64::from(to) - f64::from(from)) * part);
        }
        moment
    }

    /// What frame `frame` shows of the way so many frames later, 0 to 1.
    fn moment_of_way(&self, frame: u32, later: f64) -> Moment {
        let n_frames = self.n_frames.get();
        let turn = (f64::from(frame % n_frames) + later) / f64::from(n_frames);
        let still = Moment {
            view: self.start,
            step: None,
            sun: None,
            stops: 0.0,
        };
        match &self.way {
            Way::Still => still,
            Way::Orbit => Moment {
                view: orbit(&self.start, turn),
                ..still
            },
            // Counter-clockwise as seen from above is against the sense of azimuths.
            Way::Turntable { sun } => Moment {
                view: orbit(&self.start, turn),
                sun: sun.map(|sun| SunPlace {
                    azimuth: (sun.azimuth - 360.0 * turn).rem_euclid(360.0),
                    ..sun
                }),
                ..still
            },
            Way::Tracks(tracks) => {
                let (start, end) = tracks.span;
                tracks.moment(start + (end - start) * self.part(frame, later), still)
            }
        }
    }

    /// How much of the film has passed so many frames after this one, 0 in the first frame and 1 from the last one on.
    fn part(&self, frame: u32, later: f64) -> f64 {
        let last = self.n_frames.get() - 1;
        if last == 0 {
            0.0
        } else {
            ((f64::from(frame.min(last)) + later) / f64::from(last)).min(1.0)
        }
    }

    /// The camera's place in frame `frame`.
    pub fn view(&self, frame: u32) -> View {
        self.moment(frame).view
    }

    /// The camera's place so many frames, 0 to 1, after frame `frame`.
    pub fn view_after(&self, frame: u32, later: f64) -> View {
        self.moment_of_way(frame, later).view
    }

    /// The numbers of all frames.
    pub fn all(&self) -> Range<u32> {
        0..self.n_frames.get()
    }

    /// The frame in which the sun stands highest, the first of several: the one to decide the exposure by.
    pub fn brightest(&self) -> u32 {
        let height = |frame: u32| self.moment(frame).sun.map_or(0.0, |sun| sun.elevation);
        let mut best = 0;
        for frame in self.all() {
            if height(frame) > height(best) {
                best = frame;
            }
        }
        best
    }
}

impl Tracks {
    fn new(keys: &KeyFrames, speed: Speed) -> Self {
        let points = |pick: fn(&KeyFrame) -> Option<DVec3>| {
            let points = said(keys, pick);
            (!points.is_empty()).then(|| Track::new(&points))
        };
        let curve = |pick: fn(&KeyFrame) -> Option<f64>| {
            let values = said(keys, pick);
            (!values.is_empty()).then(|| Spline::new(&values))
        };
        let eye = points(|key| key.eye);
        let clock = match speed {
            Speed::Timed => None,
            Speed::Even => eye.as_ref().map(EvenSpeed::new),
        };
        Self {
            span: keys.span(),
            clock,
            eye,
            target: points(|key| key.target),
            fov: curve(|key| key.fov.map(Angle::degrees)),
            step: curve(|key| key.step),
            sun: sun_curves(&said(keys, |key| key.sun)),
            stops: curve(|key| key.stops),
        }
    }

    fn moment(&self, time: f64, still: Moment) -> Moment {
        let time = self.clock.as_ref().map_or(time, |clock| clock.time(time));
        let point =
            |track: &Option<Track>, other: DVec3| track.as_ref().map_or(other, |t| t.at(time));
        let view = still.view;
        let fov = self.fov.as_ref().map(|fov| Angle::deg(fov.at(time)));
        Moment {
            view: View {
                eye: point(&self.eye, view.eye),
                target: point(&self.target, view.target),
                fov: fov.unwrap_or(view.fov),
                ..view
            },
            step: self.step.as_ref().map(|step| step.at(time)),
            sun: self.sun.as_ref().map(|[azimuth, elevation]| SunPlace {
                azimuth: azimuth.at(time).rem_euclid(360.0),
                elevation: elevation.at(time),
            }),
            stops: self.stops.as_ref().map_or(0.0, |stops| stops.at(time)),
        }
    }
}

/// What the key frames that say anything of it say, with their times.
fn said<T>(keys: &KeyFrames, pick: fn(&KeyFrame) -> Option<T>) -> Vec<(f64, T)> {
    let frames = keys.frames().iter();
    frames
        .filter_map(|key| Some((key.time, pick(key)?)))
        .collect()
}

/// The curves of azimuth and elevation; from key to key the azimuth goes the shorter way round.
fn sun_curves(keys: &[(f64, SunPlace)]) -> Option<[Spline; 2]> {
    let mut azimuths: Vec<(f64, f64)> = Vec::new();
    for (time, sun) in keys {
        let last = azimuths.last().map_or(sun.azimuth, |(_, last)| *last);
        let step = (sun.azimuth - last + 180.0).rem_euclid(360.0) - 180.0;
        azimuths.push((*time, last + step));
    }
    let elevations: Vec<(f64, f64)> = keys.iter().map(|(t, sun)| (*t, sun.elevation)).collect();
    (!keys.is_empty()).then(|| [Spline::new(&azimuths), Spline::new(&elevations)])
}

/// The name of the file of frame `frame`, with this suffix.
pub fn frame_name(frame: u32, suffix: &str) -> String {
    format!("frame-{frame:06}.{suffix}")
}

#[cfg(test)]
mod tests {
    use super::*;

    fn start() -> View {
        View {
            eye: DVec3::new(3.0, -4.0, 2.0),
            target: DVec3::ZERO,
            up: DVec3::Z,
            fov: Angle::deg(40.0),
        }
    }

    fn n(frames: u32) -> NonZeroU32 {
        NonZeroU32::new(frames).unwrap()
    }

    #[test]
    fn the_flight_closes_on_itself_to_the_bit() {
        let flight = Flight::orbit(start(), n(7));
        assert_eq!(flight.all(), 0..7);
        assert_eq!(flight.view(0), start());
        assert_eq!(flight.view(9), flight.view(2));
        assert!(flight.view(2).eye.distance(flight.view(3).eye) > 1.0);
    }

    #[test]
    fn on_a_turntable_the_light_keeps_its_side() {
        let sun = SunPlace {
            azimuth: 30.0,
            elevation: 20.0,
        };
        let flight = Flight::turntable(start(), n(8), Some(sun));
        let side = |frame: u32| {
            let moment = flight.moment(frame);
            let azimuth = moment.sun.unwrap().azimuth.to_radians();
            let sun = DVec3::new(azimuth.sin(), azimuth.cos(), 0.0);
            let towards = (moment.view.eye - moment.view.target)
                .with_z(0.0)
                .normalize();
            (sun.dot(towards), sun.cross(towards).z)
        };
        for frame in 1..8 {
            let ((a, b), (c, d)) = (side(0), side(frame));
            assert!((a - c).abs() < 1e-12 && (b - d).abs() < 1e-12, "{frame}");
        }
    }

    #[test]
    fn key_frames_are_met_and_what_they_leave_out_goes_on() {
        let keys = KeyFrames::parse(
            "time=0 eye=0,-9,2 sun=350,10; time=1 target=0,0,1; time=2 eye=4,-9,2 step=3 sun=10,50; time=4 step=5",
        )
        .unwrap();
        let flight = Flight::keys(start(), n(5), &keys, Speed::Timed);
        assert_eq!(flight.view(0).eye, DVec3::new(0.0, -9.0, 2.0));
        assert_eq!(flight.view(1).eye, DVec3::new(2.0, -9.0, 2.0));
        assert_eq!(flight.view(4).eye, DVec3::new(4.0, -9.0, 2.0));
        assert_eq!(flight.view(3).target, DVec3::Z);
        assert_eq!(flight.view(3).fov, start().fov);
        let steps: Vec<f64> = (0..5).map(|i| flight.moment(i).step.unwrap()).collect();
        assert_eq!(steps, [3.0, 3.0, 3.0, 4.0, 5.0]);
        // Through north, not round the south.
        let sun = flight.moment(1).sun.unwrap();
        assert!(
            sun.azimuth.min(360.0 - sun.azimuth) < 1e-9 && sun.elevation == 30.0,
            "{sun:?}"
        );
        assert_eq!(flight.brightest(), 2);
    }

    #[test]
    fn growth_begins_and_ends_with_the_film() {
        let flight = Flight::still(start(), n(5)).growing(&(2..10));
        let steps: Vec<f64> = (0..5).map(|i| flight.moment(i).step.unwrap()).collect();
        assert_eq!(steps, [2.0, 4.0, 6.0, 8.0, 10.0]);
        assert_eq!(
            Flight::still(start(), n(1))
                .growing(&(2..10))
                .moment(0)
                .step,
            Some(2.0)
        );
    }

    #[test]
    fn names_sort_as_frames_do() {
        assert_eq!(frame_name(0, "png"), "frame-000000.png");
        assert!(frame_name(9, "png") < frame_name(10, "png"));
        assert!(frame_name(99_999, "exr") < frame_name(100_000, "exr"));
    }
}
