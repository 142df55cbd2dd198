//! From the lamps of a model to sources of light: powers to intensities, irradiances and radiances.
//!
//! Sources: `groimp-renderers` facts of GroIMP's own lights. A lamp's power is the sum over red, green and blue; its colour
//! only divides it among them.

use super::appearance::{Lamp, LampKind};
use crate::color::Rgb;
use crate::light::Light;
use crate::math::angle::Angle;
use crate::turtle::TurtleState;
use std::f64::consts::PI;

/// What a lamp at a node gives.
#[derive(Clone, Debug, PartialEq)]
pub(super) enum Shining {
    /// Nothing: no power, or black.
    Dark,
    /// A source in the turtle's world.
    Source(Light),
    /// Uniform radiance from everywhere, W/(m² sr).
    Sky(Rgb),
    /// It needs a surface, and there is none.
    NoSurface,
}

/// The light of a lamp that stands where the turtle is and shines along its head.
pub(super) fn shine(lamp: &Lamp, state: &TurtleState) -> Shining {
    let power = power(lamp, Rgb::WHITE);
    if power.is_black() {
        return Shining::Dark;
    }
    let position = state.position();
    match lamp.kind {
        LampKind::Point => Shining::Source(Light::Point {
            position,
            intensity: power / (4.0 * PI),
        }),
        LampKind::Spot { inner, outer } => {
            let inner = inner.clamp(0.0, PI);
            let (inner, outer) = (Angle::rad(inner), Angle::rad(outer.clamp(inner, PI)));
            // Full inside `inner`, half on average between: the solid angle that full intensity would fill.
            let solid_angle = 2.0 * PI * (1.0 - (inner.cos() + outer.cos()) / 2.0);
            if solid_angle <= 0.0 {
                return Shining::Dark;
            }
            Shining::Source(Light::Spot {
                position,
                axis: state.head(),
                inner,
                outer,
                intensity: power / solid_angle,
            })
        }
        LampKind::Directional => Shining::Source(Light::Directional {
            direction: state.head(),
            irradiance: power,
            origin: position,
        }),
        LampKind::Sky => Shining::Sky(power / PI),
        LampKind::Area { .. } => Shining::NoSurface,
    }
}

/// Radiance, W/(m² sr), of a matt surface of `area` m² whose front sends out the lamp's power, coloured by the surface.
pub(super) fn emission(lamp: &Lamp, surface: Rgb, alpha: f64, area: f64) -> Rgb {
    // Emission is multiplied by alpha later; the power asked for is what comes out.
    let strength = PI * area * alpha;
    if strength > 0.0 {
        power(lamp, surface) / strength
    } else {
        Rgb::BLACK
    }
}

/// The lamp's power divided among the channels by its colour and that of a filter; black if all is filtered away.
fn power(lamp: &Lamp, filter: Rgb) -> Rgb {
    let color = Rgb::from_array(lamp.color) * filter;
    let sum = color.sum();
    if sum > 0.0 && lamp.power > 0.0 {
        color * (lamp.power / sum)
    } else {
        Rgb::BLACK
    }
}

/// Whether a lamp's numbers make sense.
pub(super) fn is_possible(lamp: &Lamp) -> bool {
    let color = lamp.color.iter().all(|c| c.is_finite() && *c >= 0.0);
    let kind = match lamp.kind {
        LampKind::Spot { inner, outer } => !inner.is_nan() && !outer.is_nan(),
        LampKind::Point | LampKind::Directional | LampKind::Area { .. } | LampKind::Sky => true,
    };
    color && kind && lamp.power.is_finite() && lamp.power >= 0.0
}

/// A source carried into another frame. Powers stay as they are.
pub(super) fn placed(light: &Light, to: &glam::DAffine3) -> Light {
    let mut light = light.clone();
    match &mut light {
        Light::Point { position, .. } => *position = to.transform_point3(*position),
        Light::Spot { position, axis, .. } => {
            *position = to.transform_point3(*position);
            *axis = to.transform_vector3(*axis).normalize_or_zero();
        }
        Light::Directional {
            direction, origin, ..
        } => {
            *origin = to.transform_point3(*origin);
            *direction = to.transform_vector3(*direction).normalize_or_zero();
        }
    }
    light
}

#[cfg(test)]
mod tests {
    use super::*;
    use glam::DVec3;

    fn lamp(kind: LampKind) -> Lamp {
        Lamp {
            kind,
            color: [1.0, 1.0, 2.0],
            power: 100.0,
        }
    }

    #[test]
    fn powers_are_totals() {
        let state = TurtleState::default();
        let Shining::Source(Light::Point { intensity, .. }) = shine(&lamp(LampKind::Point), &state)
        else {
            panic!("a point light")
        };
        assert!((intensity.sum() * 4.0 * PI - 100.0).abs() < 1e-12);
        assert!((intensity.b / intensity.r - 2.0).abs() < 1e-15);
        let wide = LampKind::Spot {
            inner: PI,
            outer: PI,
        };
        let Shining::Source(Light::Spot {
            intensity: spot,
            axis,
            ..
        }) = shine(&lamp(wide), &state)
        else {
            panic!("a spot light")
        };
        assert!(
            (spot.sum() - intensity.sum()).abs() < 1e-12,
            "a full cone is a point light"
        );
        assert_eq!(axis, DVec3::Z);
        let Shining::Sky(radiance) = shine(&lamp(LampKind::Sky), &state) else {
            panic!("a sky")
        };
        assert!((radiance.sum() * PI - 100.0).abs() < 1e-12);
    }

    #[test]
    fn surfaces_filter_their_lamp_without_dimming_it() {
        let area = lamp(LampKind::Area { exponent: 1.0 });
        let red = emission(&area, Rgb::new(1.0, 0.0, 0.0), 1.0, 2.0);
        assert_eq!(red, Rgb::new(100.0 / (2.0 * PI), 0.0, 0.0));
        assert!(emission(&area, Rgb::BLACK, 1.0, 2.0).is_black());
        let thin = emission(&area, Rgb::splat(0.3), 0.5, 2.0) * 0.5;
        let full = emission(&area, Rgb::WHITE, 1.0, 2.0);
        assert!((thin.sum() - full.sum()).abs() < 1e-12);
    }

    #[test]
    fn dark_and_impossible_lamps() {
        let state = TurtleState::default();
        let dark = Lamp {
            power: 0.0,
            ..lamp(LampKind::Point)
        };
        assert_eq!(shine(&dark, &state), Shining::Dark);
        assert!(is_possible(&dark));
        let wrong = Lamp {
            power: f64::NAN,
            ..dark
        };
        assert!(!is_possible(&wrong));
        assert_eq!(
            shine(&lamp(LampKind::Area { exponent: 1.0 }), &state),
            Shining::NoSurface
        );
    }
}
