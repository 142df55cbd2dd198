//! Sources without a surface: what reaches a point, and their power.

use super::{Light, LightSample};
use crate::color::Rgb;
use crate::math::angle::Angle;
use crate::math::frame::Frame;
use crate::math::tolerance::UNIT_LENGTH;
use crate::math::warp;
use glam::{DVec2, DVec3};
use std::f64::consts::{PI, TAU};

/// Why a source cannot exist.
#[derive(Clone, Copy, Debug, PartialEq, thiserror::Error)]
pub enum LightError {
    /// A position or direction is infinite or NaN, or a direction does not have unit length.
    #[error("a {0} is not a finite vector (directions: of length 1)")]
    Vector(&'static str),
    /// Brightness is negative, infinite or NaN.
    #[error("brightness {0:?} is negative or not finite")]
    Brightness([f64; 3]),
    /// The angles of a beam are not 0 ≤ inner ≤ outer ≤ 180°.
    #[error("beam angles {inner}° and {outer}° are not 0 ≤ inner ≤ outer ≤ 180")]
    Angles {
        /// Half angle of full intensity, degrees.
        inner: f64,
        /// Half angle of no intensity, degrees.
        outer: f64,
    },
    /// The disk of a sun is nothing, or half the sky.
    #[error("the angular radius of the sun is {radius}°, not between 0 and 90")]
    SunDisk {
        /// What was given, degrees.
        radius: f64,
    },
}

impl Light {
    /// A point source of this power (W per channel) in all directions together.
    #[must_use]
    pub fn point(position: DVec3, power: Rgb) -> Self {
        Self::Point {
            position,
            intensity: power / (2.0 * TAU),
        }
    }

    /// A spot of this power (W per channel) in its whole beam, as GroIMP's: narrowing the beam makes it brighter.
    #[must_use]
    pub fn spot(position: DVec3, axis: DVec3, inner: Angle, outer: Angle, power: Rgb) -> Self {
        let solid_angle = beam_solid_angle(inner, outer);
        let intensity = if solid_angle > 0.0 {
            power / solid_angle
        } else {
            Rgb::BLACK
        };
        Self::Spot {
            position,
            axis,
            inner,
            outer,
            intensity,
        }
    }

    /// The light that reaches `point` if nothing is in the way; `None` if none does.
    #[must_use]
    pub fn illuminate(&self, point: DVec3) -> Option<LightSample> {
        match *self {
            Self::Point {
                position,
                intensity,
            } => from_point(point, position, |_| intensity),
            Self::Spot {
                position,
                axis,
                inner,
                outer,
                intensity,
            } => {
                let falloff = |w: DVec3| intensity * falloff(w.dot(axis), inner, outer);
                from_point(point, position, falloff)
            }
            Self::Directional {
                direction,
                irradiance,
                origin,
            } => {
                let downstream = (point - origin).dot(direction);
                (downstream > 0.0 && !irradiance.is_black()).then_some(LightSample {
                    wi: -direction,
                    // Beyond the plane where the light begins nothing can shade it.
                    distance: downstream,
                    facing_irradiance: irradiance,
                    pdf_solid_angle: None,
                })
            }
        }
    }

    /// A direction in which light leaves a lamp at a point, chosen with a density in proportion to the intensity in that
    /// direction: all carry the same power. `None` for parallel light. `u` is a point of the unit square.
    #[must_use]
    pub fn emit(&self, u: DVec2) -> Option<DVec3> {
        match *self {
            Self::Point { .. } => Some(warp::sphere(u)),
            Self::Spot {
                axis, inner, outer, ..
            } => {
                let local = warp::direction(beam_cosine(inner, outer, u.x), u.y);
                Some(Frame::from_normal(axis).to_world(local).normalize())
            }
            Self::Directional { .. } => None,
        }
    }

    /// Its power, W per channel; of parallel light what passes a disk of `scene_radius` metres.
    #[must_use]
    pub fn power(&self, scene_radius: f64) -> Rgb {
        match *self {
            Self::Point { intensity, .. } => intensity * (2.0 * TAU),
            Self::Spot {
                inner,
                outer,
                intensity,
                ..
            } => intensity * beam_solid_angle(inner, outer),
            Self::Directional { irradiance, .. } => irradiance * (PI * scene_radius * scene_radius),
        }
    }

    /// Checks that the numbers describe a source that can exist.
    ///
    /// # Errors
    /// The first thing that is wrong.
    pub fn validate(&self) -> Result<(), LightError> {
        match *self {
            Self::Point {
                position,
                intensity,
            } => {
                check_finite(position, "position")?;
                check_brightness(intensity)
            }
            Self::Spot {
                position,
                axis,
                inner,
                outer,
                intensity,
            } => {
                check_finite(position, "position")?;
                check_unit(axis, "direction")?;
                let (i, o) = (inner.degrees(), outer.degrees());
                if !(0.0 <= i && i <= o && o <= 180.0) {
                    return Err(LightError::Angles { inner: i, outer: o });
                }
                check_brightness(intensity)
            }
            Self::Directional {
                direction,
                irradiance,
                origin,
            } => {
                check_finite(origin, "position")?;
                check_unit(direction, "direction")?;
                check_brightness(irradiance)
            }
        }
    }
}

/// Checks that a vector is finite.
pub(super) fn check_finite(v: DVec3, what: &'static str) -> Result<(), LightError> {
    v.is_finite().then_some(()).ok_or(LightError::Vector(what))
}

/// Checks that a vector has unit length.
pub(super) fn check_unit(v: DVec3, what: &'static str) -> Result<(), LightError> {
    let is_unit = (v.length() - 1.0).abs() <= UNIT_LENGTH;
    is_unit.then_some(()).ok_or(LightError::Vector(what))
}

/// Checks that a brightness is finite and not negative.
pub(super) fn check_brightness(c: Rgb) -> Result<(), LightError> {
    let is_fine = c.is_finite() && c.min_channel() >= 0.0;
    is_fine
        .then_some(())
        .ok_or(LightError::Brightness(c.to_array()))
}

/// Light of a point source whose intensity depends on the unit direction away from it.
fn from_point(
    point: DVec3,
    position: DVec3,
    intensity: impl Fn(DVec3) -> Rgb,
) -> Option<LightSample> {
    let to_light = position - point;
    let distance = to_light.length();
    // At the source itself the irradiance is infinite; one point of no area contributes nothing.
    if !(distance > 0.0 && distance.is_finite()) {
        return None;
    }
    let wi = to_light / distance;
    let facing_irradiance = intensity(-wi) / distance / distance;
    let reaches = !facing_irradiance.is_black() && facing_irradiance.is_finite();
    reaches.then_some(LightSample {
        wi,
        distance,
        facing_irradiance,
        pdf_solid_angle: None,
    })
}

/// GroIMP's soft edge of a beam: (3 - 2t)t² with t linear in the cosine from `outer` (0) to `inner` (1).
fn falloff(cos: f64, inner: Angle, outer: Angle) -> f64 {
    let (cos_inner, cos_outer) = (inner.cos(), outer.cos());
    if cos >= cos_inner {
        1.0
    } else if cos <= cos_outer {
        0.0
    } else {
        let t = (cos - cos_outer) / (cos_inner - cos_outer);
        (3.0 - 2.0 * t) * t * t
    }
}

/// The cosine of an angle in a beam, chosen in proportion to the falloff by a uniform number.
fn beam_cosine(inner: Angle, outer: Angle, u: f64) -> f64 {
    let (one, half) = (1.0 - inner.cos(), 0.5 * (inner.cos() - outer.cos()));
    let flux = u * (one + half);
    if flux < one || half <= 0.0 {
        return 1.0 - flux;
    }
    // From the outer edge in, the falloff t²(3 - 2t) has the integral t³ - t⁴/2: bisection, since it only grows.
    let wanted = 0.5 * (1.0 - (flux - one) / half);
    let (mut low, mut high) = (0.0, 1.0);
    for _ in 0..53 {
        let t: f64 = 0.5 * (low + high);
        if t * t * t * (1.0 - 0.5 * t) < wanted {
            low = t;
        } else {
            high = t;
        }
    }
    outer.cos() + 0.5 * (low + high) * (inner.cos() - outer.cos())
}

/// ∫ of the falloff over the sphere, in steradian: the soft edge counts half.
fn beam_solid_angle(inner: Angle, outer: Angle) -> f64 {
    TAU * (1.0 - 0.5 * (inner.cos() + outer.cos()))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_lamp_emits_its_power() {
        let power = Rgb::new(10.0, 20.0, 70.0);
        let axis = DVec3::new(1.0, 2.0, -2.0) / 3.0;
        let lamps = [
            Light::point(DVec3::ONE, power),
            Light::spot(
                DVec3::ONE,
                axis,
                Angle::rad(PI / 8.0),
                Angle::rad(PI / 6.0),
                power,
            ),
            Light::spot(DVec3::ONE, axis, Angle::deg(30.0), Angle::deg(30.0), power),
            Light::spot(DVec3::ONE, axis, Angle::deg(0.0), Angle::deg(180.0), power),
        ];
        for lamp in lamps {
            assert_eq!(lamp.validate(), Ok(()));
            // Flux through a sphere of radius 3 round the lamp.
            let (n, mut flux) = (1000, Rgb::BLACK);
            for i in 0..n * n {
                let u = DVec2::new(f64::from(i % n) + 0.5, f64::from(i / n) + 0.5) / f64::from(n);
                let at = DVec3::ONE + 3.0 * warp::sphere(u);
                if let Some(light) = lamp.illuminate(at) {
                    flux += light.facing_irradiance * (4.0 * PI * 9.0 / f64::from(n * n));
                }
            }
            assert!((flux.b / 70.0 - 1.0).abs() < 2e-3, "{lamp:?}: {flux:?}");
            assert!((lamp.power(1.0) - power).map(f64::abs).max_channel() < 1e-12);
        }
    }

    #[test]
    fn beams_are_emitted_in_proportion_to_their_intensity() {
        // The cosines of directions chosen evenly have the distribution that integrating the falloff gives.
        for (inner, outer) in [(20.0, 35.0), (0.0, 180.0), (30.0, 30.0), (0.0, 1.0)] {
            let (inner, outer) = (Angle::deg(inner), Angle::deg(outer));
            let lamp = Light::spot(DVec3::ZERO, DVec3::X, inner, outer, Rgb::WHITE);
            let n = 2000;
            let cosine = |i| {
                let u = DVec2::new((f64::from(i) + 0.5) / f64::from(n), 0.3);
                lamp.emit(u).unwrap().x
            };
            for quantile in [200, 900, 1500, 1999] {
                let cut = cosine(quantile);
                // Flux within that cosine, in 4000 steps of the midpoint rule.
                let steps = 4000;
                let width = (1.0 - cut) / f64::from(steps);
                let flux: f64 = (0..steps)
                    .map(|k| {
                        falloff(cut + (f64::from(k) + 0.5) * width, inner, outer) * width * TAU
                    })
                    .sum();
                let share = (f64::from(quantile) + 0.5) / f64::from(n);
                let found = flux / beam_solid_angle(inner, outer);
                assert!(
                    (found - share).abs() < 1e-4,
                    "{inner:?} {outer:?}: {found} {share}"
                );
            }
        }
    }

    #[test]
    fn parallel_light_begins_at_its_plane() {
        let (direction, irradiance) = (DVec3::NEG_Z, Rgb::WHITE);
        let sun = Light::Directional {
            direction,
            irradiance,
            origin: DVec3::new(5.0, 5.0, 2.0),
        };
        let below = sun.illuminate(DVec3::ZERO).unwrap();
        assert_eq!((below.wi, below.distance), (DVec3::Z, 2.0));
        assert_eq!(sun.illuminate(DVec3::new(0.0, 0.0, 2.0)), None);
        assert_eq!(sun.illuminate(DVec3::new(0.0, 0.0, 3.0)), None);
        assert!((sun.power(2.0).r - 4.0 * PI).abs() < 1e-12);
    }

    #[test]
    fn points_at_or_far_from_a_lamp_are_finite() {
        let lamp = Light::point(DVec3::ZERO, Rgb::WHITE);
        assert_eq!(lamp.illuminate(DVec3::ZERO), None);
        assert_eq!(lamp.illuminate(DVec3::splat(1e-300)), None);
        assert_eq!(lamp.illuminate(DVec3::splat(1e300)), None);
        let near = lamp.illuminate(DVec3::new(1e-9, 0.0, 0.0)).unwrap();
        assert!(near.facing_irradiance.is_finite());
    }

    #[test]
    fn impossible_lamps_are_refused() {
        let (zero, white) = (DVec3::ZERO, Rgb::WHITE);
        let (wide, narrow) = (Angle::deg(40.0), Angle::deg(20.0));
        let lamps = [
            Light::point(DVec3::NAN, white),
            Light::point(zero, Rgb::splat(-1.0)),
            Light::spot(zero, zero, narrow, wide, white),
            Light::spot(zero, DVec3::Z, wide, narrow, white),
            Light::Directional {
                direction: DVec3::Z * 2.0,
                irradiance: white,
                origin: zero,
            },
            Light::Directional {
                direction: DVec3::Z,
                irradiance: Rgb::splat(f64::NAN),
                origin: zero,
            },
        ];
        for lamp in lamps {
            assert!(lamp.validate().is_err(), "{lamp:?}");
        }
    }
}
