//! The camera: a pinhole, or a [lens](super::lens), that stands still or moves while the shutter is open.

use super::lens::Lens;
use crate::math::Ray;
use crate::math::angle::Angle;
use crate::math::tolerance::PARALLEL_SINE;
use glam::{DVec2, DVec3};

/// Where a camera stands and what it looks at, in world coordinates.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct View {
    /// The pinhole, in metres.
    pub eye: DVec3,
    /// The point in the middle of the picture, in metres.
    pub target: DVec3,
    /// The direction that points up in the picture; any length but 0.
    pub up: DVec3,
    /// Vertical field of view, more than 0° and less than 180°.
    pub fov: Angle,
}

/// A camera that sees in perspective: everything sharp, unless it has a [`Lens`] or moves.
#[derive(Clone, Debug, PartialEq)]
pub struct Camera {
    /// Where it stands when the shutter opens.
    pub(super) first: Pose,
    /// Where it stands later, evenly spread until the shutter closes; none if it stands still.
    pub(super) later: Vec<Pose>,
    pub(super) lens: Option<Lens>,
}

/// Where a camera stands at one moment.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Pose {
    pub(super) eye: DVec3,
    pub(super) forward: DVec3,
    /// From the middle of the film to its right edge, at distance 1.
    pub(super) half_right: DVec3,
    /// From the middle of the film to its upper edge, at distance 1.
    pub(super) half_up: DVec3,
}

/// Why there is no such camera.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
pub enum CameraError {
    /// A coordinate is not a finite number.
    #[error("the camera's {0} is not a finite point")]
    NotFinite(&'static str),
    /// It looks nowhere.
    #[error("the camera's eye and target are the same point {0}")]
    NoDirection(DVec3),
    /// Its top is undefined.
    #[error("the camera looks along its own up direction {0}: choose another `up`")]
    UpAlongView(DVec3),
    /// The opening is none, or half the world.
    #[error("the field of view must be more than 0 and less than 180 degrees, not {0}")]
    FieldOfView(f64),
}

impl Camera {
    /// The camera of `view` whose picture is `aspect` times as wide as high.
    ///
    /// # Errors
    /// If a point is not finite, eye and target coincide, `up` is zero or parallel to the view, or the field of view
    /// is outside (0°, 180°).
    pub fn perspective(view: &View, aspect: f64) -> Result<Self, CameraError> {
        for (name, point) in [("eye", view.eye), ("target", view.target), ("up", view.up)] {
            if !point.is_finite() {
                return Err(CameraError::NotFinite(name));
            }
        }
        let degrees = view.fov.degrees();
        if !(degrees > 0.0 && degrees < 180.0) {
            return Err(CameraError::FieldOfView(degrees));
        }

        // Scale before normalising: the squared length of a tiny or huge difference would leave the range of f64.
        let towards = view.target - view.eye;
        let forward = (towards / towards.abs().max_element())
            .try_normalize()
            .ok_or(CameraError::NoDirection(view.eye))?;
        let up = (view.up / view.up.abs().max_element())
            .try_normalize()
            .ok_or(CameraError::UpAlongView(view.up))?;
        let right = forward.cross(up);
        if right.length() < PARALLEL_SINE {
            return Err(CameraError::UpAlongView(view.up));
        }

        let right = right.normalize();
        let half_height = view.fov.half().tan();
        Ok(Self {
            first: Pose {
                eye: view.eye,
                forward,
                half_right: right * (half_height * aspect),
                half_up: right.cross(forward) * half_height,
            },
            later: Vec::new(),
            lens: None,
        })
    }

    /// The ray through a film point and the middle of the lens when the shutter opens; `film` in the unit square, y down, (0, 0) the
    /// upper left corner of the picture.
    pub fn ray(&self, film: DVec2) -> Ray {
        Ray::new(self.first.eye, self.first.toward(film).normalize())
    }

    /// Where the camera stands when the shutter opens, in metres.
    pub fn eye(&self) -> DVec3 {
        self.first.eye
    }

    /// Unit vectors to the right edge of the picture and to its upper edge.
    pub fn axes(&self) -> [DVec3; 2] {
        [self.first.half_right, self.first.half_up].map(DVec3::normalize)
    }
}

impl Pose {
    /// The direction to what a film point shows, of length 1 along the axis of the camera.
    pub(super) fn toward(&self, film: DVec2) -> DVec3 {
        let (x, y) = (2.0 * film.x - 1.0, 1.0 - 2.0 * film.y);
        self.forward + self.half_right * x + self.half_up * y
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn view() -> View {
        View {
            eye: DVec3::new(0.0, -10.0, 0.0),
            target: DVec3::ZERO,
            up: DVec3::Z,
            fov: Angle::deg(90.0),
        }
    }

    #[test]
    fn rows_run_down_and_columns_right() {
        let camera = Camera::perspective(&view(), 2.0).unwrap();
        let corner = |x, y| {
            let d = camera.ray(DVec2::new(x, y)).direction;
            d / d.y
        };
        assert!(corner(0.0, 0.0).distance(DVec3::new(-2.0, 1.0, 1.0)) < 1e-12);
        assert!(corner(1.0, 1.0).distance(DVec3::new(2.0, 1.0, -1.0)) < 1e-12);
    }

    #[test]
    fn impossible_cameras_are_refused() {
        let refused = |change: fn(&mut View)| {
            let mut view = view();
            change(&mut view);
            Camera::perspective(&view, 1.0).unwrap_err()
        };
        assert_eq!(
            refused(|v| v.eye.x = f64::NAN),
            CameraError::NotFinite("eye")
        );
        assert_eq!(
            refused(|v| v.target = v.eye),
            CameraError::NoDirection(view().eye)
        );
        assert_eq!(
            refused(|v| v.up = DVec3::Y),
            CameraError::UpAlongView(DVec3::Y)
        );
        assert_eq!(
            refused(|v| v.up = DVec3::ZERO),
            CameraError::UpAlongView(DVec3::ZERO)
        );
        assert_eq!(
            refused(|v| v.fov = Angle::deg(0.0)),
            CameraError::FieldOfView(0.0)
        );
        assert!(matches!(
            refused(|v| v.fov = Angle::deg(180.0)),
            CameraError::FieldOfView(_)
        ));
        assert!(matches!(
            refused(|v| v.fov = Angle::deg(f64::NAN)),
            CameraError::FieldOfView(_)
        ));
    }

    #[test]
    fn tiny_and_huge_distances_still_give_a_direction() {
        for distance in [1e-200, 1e-6, 1e6, 1e200] {
            let view = View {
                eye: DVec3::new(0.0, -distance, 0.0),
                ..view()
            };
            let camera = Camera::perspective(&view, 1.0).unwrap();
            assert_eq!(camera.ray(DVec2::splat(0.5)).direction, DVec3::Y);
        }
    }
}
