//! A camera that moves from frame to frame.

use crate::camera::View;
use crate::camera::orbit::orbit;
use std::num::NonZeroU32;
use std::ops::Range;

/// Where the camera stands in each frame of a film.
#[derive(Clone, Debug, PartialEq)]
pub struct Flight {
    start: View,
    n_frames: NonZeroU32,
}

impl Flight {
    /// Once round the target of `start` in `n_frames` frames, so that the frame after the last would be the first.
    pub fn orbit(start: View, n_frames: NonZeroU32) -> Self {
        Self { start, n_frames }
    }

    /// The camera's place in frame `frame`; a flight that goes on after its last frame begins again.
    pub fn view(&self, frame: u32) -> View {
        let n_frames = self.n_frames.get();
        orbit(
            &self.start,
            f64::from(frame % n_frames) / f64::from(n_frames),
        )
    }

    /// The numbers of all frames.
    pub fn all(&self) -> Range<u32> {
        0..self.n_frames.get()
    }
}

/// The name of the file of frame `frame`.
pub fn frame_name(frame: u32) -> String {
    format!("frame-{frame:06}.png")
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::math::angle::Angle;
    use glam::DVec3;

    #[test]
    fn the_flight_closes_on_itself_to_the_bit() {
        let eye = DVec3::new(3.0, -4.0, 2.0);
        let start = View {
            eye,
            target: DVec3::ZERO,
            up: DVec3::Z,
            fov: Angle::deg(40.0),
        };
        let flight = Flight::orbit(start, NonZeroU32::new(7).unwrap());
        assert_eq!(flight.all(), 0..7);
        assert_eq!(flight.view(0), start);
        assert_eq!(flight.view(9), flight.view(2));
        assert!(flight.view(2).eye.distance(flight.view(3).eye) > 1.0);
    }

    #[test]
    fn names_sort_as_frames_do() {
        assert_eq!(frame_name(0), "frame-000000.png");
        assert!(frame_name(9) < frame_name(10) && frame_name(99_999) < frame_name(100_000));
    }
}
