//! A view that shows the whole of something.

use super::View;
use crate::math::Bounds3;
use crate::math::angle::Angle;
use glam::DVec3;

/// Room left round what is framed, as a part of its size.
const MARGIN: f64 = 0.12;

/// From what is framed to the eye: south-east of it and a little above, so that land and sky both show.
const TOWARDS_EYE: DVec3 = DVec3::new(0.5, -1.0, 0.2);

/// What is framed.
#[derive(Clone, Copy)]
pub struct Subject<'a> {
    /// Its bounds.
    pub bounds: Bounds3,
    /// The largest value of `normal · p` over its points p.
    pub reach: &'a dyn Fn(DVec3) -> f64,
}

/// Looks at the subject from the south-east and a little above, near enough that it fills the picture.
///
/// An empty subject is taken as a ball of 1 m round the origin. `aspect` is width over height; `up` is +z.
pub fn frame(subject: &Subject<'_>, fov: Angle, aspect: f64) -> View {
    if subject.bounds.is_empty() {
        let ball = |normal: DVec3| normal.length();
        let bounds = Bounds3 {
            min: DVec3::splat(-1.0),
            max: DVec3::splat(1.0),
        };
        let reach = &ball;
        return frame_from(&Subject { bounds, reach }, TOWARDS_EYE, fov, aspect);
    }
    frame_from(subject, TOWARDS_EYE, fov, aspect)
}

/// Looks at the subject, which is not empty, from the direction `towards_eye` (not vertical).
///
/// The eye is the point nearest to the subject from which all of it lies inside the picture, in the middle of the room that
/// is left. Each edge of the picture spans a plane with the eye; that no point of the subject lies outside it is a linear
/// condition on the eye, so the two pairs of opposite planes that touch the subject give the eye in closed form.
pub fn frame_from(subject: &Subject<'_>, towards_eye: DVec3, fov: Angle, aspect: f64) -> View {
    let forward = -towards_eye.normalize();
    let right = forward.cross(DVec3::Z).normalize();
    let top = right.cross(forward);
    let middle = subject.bounds.center();

    // For a pair of opposite edges: how far the eye is to the side of the middle, and how far behind it at least.
    let tan_up = fov.half().tan();
    let between = |side: DVec3, tan: f64| {
        let tan = tan / (1.0 + MARGIN);
        let touches = |normal: DVec3| (subject.reach)(normal) - normal.dot(middle);
        let (plus, minus) = (
            touches(side - forward * tan),
            touches(-side - forward * tan),
        );
        ((plus - minus) / 2.0, (plus + minus) / (2.0 * tan))
    };
    let (sideways, back_for_width) = between(right, tan_up * aspect);
    let (upwards, back_for_height) = between(top, tan_up);
    let back = back_for_width.max(back_for_height);

    // A single point has no size; 1 m is as good a distance as any.
    let is_point = back <= middle.abs().max_element() * f64::EPSILON * 4.0;
    let back = if is_point { 1.0 } else { back };
    let target = middle + right * sideways + top * upwards;
    View {
        eye: target - forward * back,
        target,
        up: DVec3::Z,
        fov,
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::camera::Camera;

    /// Film coordinates of a point, by the geometry of the view (not by the camera's own code).
    fn film(view: &View, aspect: f64, point: DVec3) -> (f64, f64) {
        let forward = (view.target - view.eye).normalize();
        let right = forward.cross(view.up).normalize();
        let up = right.cross(forward);
        let d = point - view.eye;
        let tan = view.fov.half().tan();
        let depth = d.dot(forward);
        (
            d.dot(right) / depth / (tan * aspect),
            d.dot(up) / depth / tan,
        )
    }

    fn framed(points: &[DVec3], aspect: f64) -> View {
        let reach = |normal: DVec3| {
            let along = points.iter().map(|point| normal.dot(*point));
            along.fold(f64::NEG_INFINITY, f64::max)
        };
        let bounds = Bounds3::of(points.iter().copied());
        let reach = &reach;
        frame(&Subject { bounds, reach }, Angle::deg(40.0), aspect)
    }

    #[test]
    fn all_points_are_inside_and_opposite_edges_are_equally_near() {
        let corners = |min: DVec3, max: DVec3| Bounds3 { min, max }.corners().to_vec();
        for points in [
            corners(DVec3::new(-1.0, -1.0, 0.0), DVec3::new(1.0, 1.0, 30.0)),
            corners(DVec3::new(-50.0, -40.0, 0.0), DVec3::new(50.0, 40.0, 3.0)),
            corners(DVec3::splat(1e6), DVec3::splat(1e6 + 1.0)),
            corners(DVec3::splat(-1e-6), DVec3::splat(1e-6)),
            vec![
                DVec3::ZERO,
                DVec3::new(3.0, 1.0, 0.2),
                DVec3::new(0.0, 0.5, 4.0),
            ],
        ] {
            for aspect in [0.5, 1.0, 16.0 / 9.0] {
                let view = framed(&points, aspect);
                assert!(Camera::perspective(&view, aspect).is_ok());
                let seen: Vec<_> = points.iter().map(|&p| film(&view, aspect, p)).collect();
                let extent = |pick: fn(&(f64, f64)) -> f64| {
                    let values = seen.iter().map(pick);
                    values.fold((1.0_f64, -1.0_f64), |(a, b), v| (a.min(v), b.max(v)))
                };
                let ((left, right), (bottom, top)) = (extent(|p| p.0), extent(|p| p.1));
                let widest = right.max(top);
                assert!(
                    (0.85..0.95).contains(&widest),
                    "{points:?} {aspect}: {widest}"
                );
                assert!((left + right).abs() < 0.05 || (bottom + top).abs() < 0.05);
                assert!(left > -0.99 && bottom > -0.99, "{left} {bottom}");
            }
        }
    }

    #[test]
    fn a_ball_fills_the_picture_better_than_the_box_round_it() {
        let bounds = Bounds3 {
            min: DVec3::splat(-1.0),
            max: DVec3::splat(1.0),
        };
        let ball = |normal: DVec3| normal.length();
        let boxed = |normal: DVec3| normal.abs().element_sum();
        let distance = |reach: &dyn Fn(DVec3) -> f64| {
            let view = frame(&Subject { bounds, reach }, Angle::deg(40.0), 1.0);
            view.eye.distance(view.target)
        };
        // The tangent cone of a unit ball has half the angle whose sine is 1 / distance.
        let expected = 1.0 / (20_f64.to_radians().tan() / (1.0 + MARGIN)).atan().sin();
        assert!((distance(&ball) - expected).abs() < 1e-12);
        assert!(distance(&boxed) > 1.3 * distance(&ball));
    }

    #[test]
    fn nothing_and_a_single_point_are_framed_too() {
        for points in [&[][..], &[DVec3::ONE], &[DVec3::splat(1e9)]] {
            assert!(Camera::perspective(&framed(points, 1.0), 1.0).is_ok());
        }
    }
}
