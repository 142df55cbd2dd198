//! What makes a picture unsharp on purpose: a lens that is not a point, and a camera that moves while its shutter is open.
//!
//! Both are integrals, over the lens and over time, that each sample of a pixel takes at a point of its own
//! ([Cook1984](crate::references#cook1984)).

use super::perspective::{Camera, Pose};
use crate::math::{Ray, warp};
use glam::{DVec2, DVec3};
use std::fmt::Debug;

/// Height of the picture of the camera that f-numbers are meant for, in metres: 24 mm, 35 mm film.
const FILM_HEIGHT: f64 = 0.024;

/// A thin lens: what lies at one distance is sharp, everything else a disk.
///
/// A point at distance z along the axis fills a disk that would have the diameter D |z - f| / f at its own distance, with D the
/// diameter of the lens and f the distance of what is sharp.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Lens {
    /// Its diameter in metres, at least 0.
    pub diameter: f64,
    /// Distance of what is sharp, along the axis of the camera, in metres; more than 0.
    pub focus: f64,
}

/// Diameter in metres of a lens with this f-number on a camera for 35 mm film with half this vertical field of view.
///
/// The focal length follows from the field of view at infinity, the diameter is the focal length over the f-number.
#[must_use]
pub fn diameter(f_number: f64, half_fov: crate::math::angle::Angle) -> f64 {
    FILM_HEIGHT / (2.0 * half_fov.tan() * f_number)
}

impl Camera {
    /// The same camera with a lens.
    #[must_use]
    pub fn with_lens(self, lens: Lens) -> Self {
        Self {
            lens: (lens.diameter > 0.0).then_some(lens),
            ..self
        }
    }

    /// The same camera, which moves through the places of the others, evenly, while the shutter is open. Between two places it
    /// goes straight on.
    #[must_use]
    pub fn moving_through(self, later: &[Self]) -> Self {
        let later: Vec<Pose> = later.iter().map(|camera| camera.first).collect();
        let moves = later.iter().any(|pose| *pose != self.first);
        Self {
            later: if moves { later } else { Vec::new() },
            ..self
        }
    }

    /// Whether it has a lens.
    pub fn has_lens(&self) -> bool {
        self.lens.is_some()
    }

    /// Whether it moves while the shutter is open.
    pub fn moves(&self) -> bool {
        !self.later.is_empty()
    }

    /// Its way while the shutter is open, in a form that is equal for equal ways: no moment tells how far it moves.
    pub fn motion(&self) -> &impl Debug {
        &self.later
    }

    /// The ray through a film point and a point of the lens at a moment: `film` as for [`ray`](Self::ray), `lens` in the unit square,
    /// `time` from 0, when the shutter opens, to 1, when it closes.
    pub fn ray_through(&self, film: DVec2, lens: DVec2, time: f64) -> Ray {
        let pose = self.pose(time);
        let toward = pose.toward(film);
        let Some(Lens { diameter, focus }) = self.lens else {
            return Ray::new(pose.eye, toward.normalize());
        };
        let point = warp::disk(lens) * (0.5 * diameter);
        let offset = pose.half_right.normalize() * point.x + pose.half_up.normalize() * point.y;
        Ray::new(pose.eye + offset, (toward * focus - offset).normalize())
    }

    fn pose(&self, time: f64) -> Pose {
        let at = time.clamp(0.0, 1.0) * self.later.len() as f64;
        let piece = (at as usize).min(self.later.len().saturating_sub(1));
        let Some(end) = self.later.get(piece) else {
            return self.first;
        };
        let start = match piece.checked_sub(1) {
            Some(before) => self.later[before],
            None => self.first,
        };
        let part = at - piece as f64;
        let between = |from: DVec3, to: DVec3| from + (to - from) * part;
        Pose {
            eye: between(start.eye, end.eye),
            forward: between(start.forward, end.forward),
            half_right: between(start.half_right, end.half_right),
            half_up: between(start.half_up, end.half_up),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::camera::View;
    use crate::math::angle::Angle;

    /// Looks along +y from `x` metres beside the origin; at distance z the picture is 2 z high.
    fn camera(x: f64) -> Camera {
        let view = View {
            eye: DVec3::new(x, 0.0, 0.0),
            target: DVec3::new(x, 1.0, 0.0),
            up: DVec3::Z,
            fov: Angle::deg(90.0),
        };
        Camera::perspective(&view, 1.5).unwrap()
    }

    /// Where a ray meets the plane y = `distance`.
    fn on_plane(ray: &Ray, distance: f64) -> DVec3 {
        ray.origin + ray.direction * ((distance - ray.origin.y) / ray.direction.y)
    }

    /// Points of the unit square, its edges among them.
    fn grid() -> impl Iterator<Item = DVec2> {
        let sides = (0..=20).map(|i| f64::from(i) / 20.0);
        sides.flat_map(|x| (0..=20).map(move |j| DVec2::new(x, f64::from(j) / 20.0)))
    }

    #[test]
    fn circles_of_confusion_have_the_width_of_the_closed_form() {
        let (diameter, focus) = (0.3, 4.0);
        let camera = camera(0.0).with_lens(Lens { diameter, focus });
        for film in [DVec2::splat(0.5), DVec2::new(0.9, 0.2)] {
            for z in [1.0, 3.0, 4.0, 6.0, 40.0] {
                let middle = on_plane(&camera.ray(film), z);
                let radii = grid()
                    .map(|lens| on_plane(&camera.ray_through(film, lens, 0.0), z).distance(middle));
                let widest = 2.0 * radii.fold(0.0, f64::max);
                let expected = diameter * (z - focus).abs() / focus;
                assert!(
                    (widest - expected).abs() < 1e-12,
                    "{z}: {widest} {expected}"
                );
            }
        }
    }

    #[test]
    fn a_blur_is_as_long_as_the_way_of_the_camera() {
        // 2 m to the right, seen at 5 m where the picture is 15 m wide: things move by 2/15 of it to the left.
        let moving =
            camera(0.0).moving_through(&[camera(0.5), camera(1.0), camera(1.5), camera(2.0)]);
        let film = DVec2::splat(0.5);
        let at = |time: f64| on_plane(&moving.ray_through(film, film, time), 5.0).x;
        for i in 0..=16 {
            let time = f64::from(i) / 16.0;
            assert!(
                (at(time) - 2.0 * time).abs() < 1e-12,
                "{time}: {}",
                at(time)
            );
        }
    }

    #[test]
    fn without_lens_and_motion_rays_are_those_of_the_pinhole_to_the_bit() {
        let plain = camera(0.3);
        let same = plain
            .clone()
            .with_lens(Lens {
                diameter: 0.0,
                focus: 2.0,
            })
            .moving_through(&[plain.clone(), plain.clone()]);
        assert!(!same.has_lens() && !same.moves());
        for film in grid() {
            assert_eq!(same.ray_through(film, film, 0.7), plain.ray(film));
        }
    }

    #[test]
    fn f_numbers_are_those_of_35_mm_film() {
        // A normal lens of 50 mm sees 24 mm under 26.99 degrees; at f/2 it is 25 mm wide.
        let half_fov = Angle::rad((12.0_f64 / 50.0).atan());
        assert!((diameter(2.0, half_fov) - 0.025).abs() < 1e-12);
    }
}
