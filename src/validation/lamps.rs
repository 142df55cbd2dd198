//! Sources without extent, and the sun: the irradiance of a matt floor.

use super::check::{Check, FAULT};
use super::probe::{Experiment, along};
use super::room::{Room, at, gray, square};
use crate::color::Rgb;
use crate::geometry::Shape;
use crate::integrator::Path;
use crate::integrator::path::Strategies;
use crate::light::environment::direction;
use crate::light::{Environment, Light, Sky, SunDisk};
use crate::material::Material;
use crate::math::angle::Angle;
use crate::math::functions::acos;
use crate::math::tolerance::CLOSED_FORM;
use glam::DVec3;
use std::f64::consts::{PI, TAU};

/// Fraction that the floor reflects.
const RHO: f64 = 0.6;

/// Height of the lamps above the floor, metres.
const HEIGHT: f64 = 2.0;

fn floor() -> Room {
    Room::default().with(Shape::Plane, at(0., 0., 0.), Material::lambert(gray(RHO)))
}

/// The irradiance of the floor at distance `x` from the foot of the lamps.
fn irradiance(
    id: impl Into<String>,
    what: impl Into<String>,
    light: Light,
    x: f64,
    expected: f64,
) -> Check {
    Check::exact((id, what), expected, CLOSED_FORM, move || {
        let scene = floor().lit_by(light.clone()).scene()?;
        let look = along(DVec3::new(x, 0.0, 1.0), DVec3::NEG_Z);
        Ok(Experiment::new(scene, look).times(PI / RHO).once())
    })
}

/// Points, spots with their soft edge, parallel light, the sun, and what half-transparent things leave of them (C-52).
pub(super) fn checks() -> Vec<Check> {
    let mut checks = points();
    checks.extend(spots());
    checks.extend(parallel());
    checks.extend(suns());
    checks.extend(veils());
    checks
        .into_iter()
        .map(|check| check.of_case("52"))
        .collect()
}

fn points() -> Vec<Check> {
    let lamp = Light::point(DVec3::Z * HEIGHT, gray(4.0 * PI));
    let mut checks = Vec::new();
    for x in [0.0, 0.5, 3.0] {
        let squares: f64 = x * x + HEIGHT * HEIGHT;
        let expected = HEIGHT / squares / squares.sqrt();
        let what =
            format!("irradiance of a point source of 4 pi W, 2 m up, {x} m aside: I cos/r^2");
        checks.push(irradiance(
            format!("lamp-point-{x}"),
            what,
            lamp.clone(),
            x,
            expected,
        ));
    }
    checks
}

fn spots() -> Vec<Check> {
    let (inner, outer) = (Angle::deg(20.0), Angle::deg(40.0));
    let power = 50.0;
    let spot = Light::spot(DVec3::Z * HEIGHT, DVec3::NEG_Z, inner, outer, gray(power));
    // The soft edge counts half: ∫ (3 - 2t)t² dt = ½ over the cosines between.
    let beam = TAU * (1.0 - 0.5 * (inner.cos() + outer.cos()));
    let mut checks = Vec::new();
    for t in [-1.0_f64, 0.0, 0.25, 0.5, 0.75, 1.0, 1.2] {
        let cos = outer.cos() + t * (inner.cos() - outer.cos());
        let x = HEIGHT * (1.0 - cos * cos).sqrt() / cos;
        let inside = t.clamp(0.0, 1.0);
        let falloff = (3.0 - 2.0 * inside) * inside * inside;
        let squares = HEIGHT * HEIGHT / (cos * cos);
        let expected = power / beam * falloff * cos / squares;
        let degrees = acos(cos).to_degrees();
        let what =
            format!("irradiance of a spot of 50 W (20 to 40 deg) at {degrees:.2} deg of its axis");
        // At the very edge a rounding decides between nothing and next to nothing.
        if t != 0.0 {
            checks.push(irradiance(
                format!("lamp-spot-{t}"),
                what,
                spot.clone(),
                x,
                expected,
            ));
        }
    }
    checks
}

fn parallel() -> Vec<Check> {
    let light = |height: f64| Light::Directional {
        direction: DVec3::new(0.6, 0.0, -0.8),
        irradiance: gray(10.0),
        origin: DVec3::Z * height,
    };
    vec![
        irradiance(
            "lamp-parallel",
            "irradiance of parallel light of 10 W/m2: E cos",
            light(5.0),
            1.0,
            8.0,
        ),
        irradiance(
            "lamp-parallel-behind",
            "behind the plane where it begins",
            light(-5.0),
            1.0,
            0.0,
        ),
    ]
}

fn suns() -> Vec<Check> {
    let mut checks = Vec::new();
    for elevation in [5.0, 30.0, 90.0] {
        let angle = Angle::deg(elevation);
        let sun = SunDisk {
            to_sun: direction(Angle::deg(50.0), angle),
            irradiance: gray(1000.0),
            angular_radius: Angle::deg(0.2666),
        };
        let what = format!("irradiance of a sun disk of 1000 W/m2, {elevation} deg up: E sin h");
        let id = format!("lamp-sun-{elevation}");
        checks.push(Check::mean(
            (id, what),
            1000.0 * angle.sin(),
            FAULT,
            move || {
                let sky = Environment {
                    sky: Sky::None,
                    sun: Some(sun.clone()),
                };
                let look = along(DVec3::Z, DVec3::NEG_Z);
                Ok(Experiment::new(floor().under(sky).scene()?, look).times(PI / RHO))
            },
        ));
    }
    checks
}

/// A veil of alpha 0.3 takes 30 % of the light that passes it; a lamp of alpha 0.4 gives 40 % of its radiance.
fn veils() -> Vec<Check> {
    let veil = || {
        let veil = Material::lambert(Rgb::BLACK).with_alpha(0.3);
        let lamp = Light::point(DVec3::Z * HEIGHT, gray(4.0 * PI));
        floor().with(square(9.0), at(0., 0., 1.), veil).lit_by(lamp)
    };
    let mut checks = vec![
        Check::exact(
            (
                "veil-below",
                "irradiance of a point source through a veil of alpha 0.3",
            ),
            0.7 / 4.0,
            CLOSED_FORM,
            move || {
                let look = along(DVec3::Z * 0.5, DVec3::NEG_Z);
                Ok(Experiment::new(veil().scene()?, look)
                    .times(PI / RHO)
                    .once())
            },
        ),
        Check::mean(
            ("veil-above", "the same, seen through the veil"),
            0.49 / 4.0,
            FAULT,
            move || {
                let look = along(DVec3::Z * 1.5, DVec3::NEG_Z);
                Ok(Experiment::new(veil().scene()?, look).times(PI / RHO))
            },
        ),
    ];
    for (name, strategies) in [
        ("by-light", Strategies::LightsOnly),
        ("by-rays", Strategies::ScatteringOnly),
    ] {
        let what = format!("irradiance of a disk lamp of alpha 0.4 on its axis, {name}");
        checks.push(Check::mean(
            (format!("veil-lamp-{name}"), what),
            0.2 * PI,
            FAULT,
            move || {
                let lamp = Material::lambert(Rgb::BLACK)
                    .emitting(gray(1.0), gray(1.0))
                    .with_alpha(0.4);
                let scene = floor()
                    .with(Shape::Disk { radius: 1.0 }, at(0., 0., 1.), lamp)
                    .scene()?;
                let path = Path {
                    strategies,
                    max_depth: Some(1),
                    ..Path::default()
                };
                let look = along(DVec3::Z * 0.5, DVec3::NEG_Z);
                Ok(Experiment::new(scene, look).by(path).times(PI / RHO))
            },
        ));
    }
    checks
}
