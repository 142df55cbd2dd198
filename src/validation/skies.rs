//! Skies: the irradiance of a matt area that lies or stands under them.

use super::check::{Check, FAULT};
use super::probe::{Experiment, along};
use super::room::{Room, at, even_sky, gray, square};
use super::table::{number, rows};
use crate::color::Rgb;
use crate::geometry::Shape;
use crate::integrator::Path;
use crate::light::{Dome, Environment, Sky, SkyImage};
use crate::material::Material;
use crate::math::angle::Angle;
use crate::math::functions::{cos, sin};
use crate::scene::SceneError;
use glam::{DAffine3, DQuat, DVec3};
use std::f64::consts::{FRAC_PI_2, PI};
use std::sync::Arc;

/// Horizontal irradiance per radiance of the zenith, and vertical per horizontal.
const TABLE: &str = include_str!("tables/sky_models_ratios.csv");

/// Fraction that the area reflects.
const RHO: f64 = 0.5;

/// The irradiance of a small area at the origin that is turned by `tilt` about the x axis (0 lies, π/2 stands).
fn irradiance(environment: &Environment, tilt: f64) -> Result<Experiment, SceneError> {
    let turn = DAffine3::from_quat(DQuat::from_rotation_x(tilt));
    let scene = Room::default()
        .with(square(0.1), turn, Material::lambert(gray(RHO)))
        .under(environment.clone())
        .scene()?;
    let normal = DVec3::new(0.0, -sin(tilt), cos(tilt));
    let path = Path {
        max_depth: Some(1),
        ..Path::default()
    };
    Ok(Experiment::new(scene, along(normal, -normal))
        .by(path)
        .times(PI / RHO))
}

fn check(id: &str, what: &str, expected: f64, environment: Environment, tilt: f64) -> Check {
    Check::mean((id, what), expected, FAULT, move || {
        irradiance(&environment, tilt)
    })
}

/// Skies of one formula, clear skies against what they state, and panoramas.
pub(super) fn checks() -> Vec<Check> {
    let mut checks = Vec::new();
    for row in rows(TABLE) {
        let environment = match row[0] {
            // The even sky shines from below too: a standing area sees only half of it above.
            "uniform" => even_sky(1.0),
            _ => Environment {
                sky: Sky::Overcast {
                    zenith: Rgb::WHITE,
                    ground_albedo: Rgb::BLACK,
                },
                sun: None,
            },
        };
        let (name, horizontal) = (row[0], number(&row, 1));
        let vertical = match name {
            "uniform" => horizontal,
            _ => horizontal * number(&row, 2),
        };
        let what = format!("irradiance of lying ground under the {name} sky of zenith 1");
        checks.push(check(
            &format!("sky-{name}-lying"),
            &what,
            horizontal,
            environment.clone(),
            0.0,
        ));
        let what = match name {
            "uniform" => {
                "irradiance of a standing wall in an even surrounding of radiance 1".into()
            }
            _ => format!(
                "irradiance of a standing wall under the {name} sky of zenith 1, on black ground"
            ),
        };
        checks.push(check(
            &format!("sky-{name}-standing"),
            &what,
            vertical,
            environment,
            FRAC_PI_2,
        ));
    }
    checks.push(half_of_an_even_sky());
    checks.extend(clear());
    checks.extend(panoramas());
    checks
        .into_iter()
        .map(|check| check.of_case("70"))
        .collect()
}

/// A standing wall on black ground sees half of what lying ground sees.
fn half_of_an_even_sky() -> Check {
    let expected = rows(TABLE)
        .find(|row| row[0] == "uniform")
        .map_or(f64::NAN, |row| number(&row, 1) * number(&row, 2));
    let name = (
        "sky-uniform-above",
        "irradiance of a standing wall under the uniform sky, on black ground",
    );
    Check::mean(name, expected, FAULT, || {
        let scene = Room::default()
            .with(Shape::Plane, at(0., 0., 0.), Material::lambert(Rgb::BLACK))
            .with(
                square(0.1),
                DAffine3::from_translation(DVec3::Z * 0.2) * DAffine3::from_rotation_x(FRAC_PI_2),
                Material::lambert(gray(RHO)),
            )
            .under(even_sky(1.0))
            .scene()?;
        let look = along(DVec3::new(0.0, -1.0, 0.2), DVec3::Y);
        Ok(Experiment::new(scene, look).times(PI / RHO))
    })
}

/// Open ground receives the daylight that sky and sun state.
fn clear() -> Vec<Check> {
    let mut checks = Vec::new();
    for elevation in [3.0, 10.0, 35.0, 80.0] {
        let day = Environment::daylight(Angle::deg(40.0), Angle::deg(elevation), 3.0, gray(0.4));
        let sky = Dome::new(&day).horizontal_irradiance().g;
        let sun = day
            .sun
            .as_ref()
            .map_or(0.0, |sun| sun.irradiance.g * sun.to_sun.z);
        let id = format!("sky-clear-{elevation}");
        let what = format!(
            "irradiance of lying ground on a clear day, sun {elevation} deg up: as stated, W/m2"
        );
        checks.push(check(&id, &what, sky + sun, day, 0.0));
    }
    checks
}

/// A picture of one colour, and one of the overcast sky, turned.
fn panoramas() -> Vec<Check> {
    let height = 128_usize;
    let picture = |value: fn(f64) -> f64| {
        let row = |y: usize| {
            let up = cos(PI * (y as f64 + 0.5) / height as f64);
            [value(up) as f32; 3]
        };
        let pixels = (0..height).flat_map(|y| std::iter::repeat_n(row(y), 2 * height));
        SkyImage::new(2 * height, height, pixels.collect()).map(|image| Environment {
            sky: Sky::Image {
                image: Arc::new(image),
                turn: Angle::deg(33.0),
                strength: 2.0,
            },
            sun: None,
        })
    };
    let overcast = |up: f64| {
        if up > 0.0 {
            (1.0 + 2.0 * up) / 3.0
        } else {
            0.0
        }
    };
    let cases = [
        ("even", picture(|_| 0.25), 0.5 * PI),
        ("overcast", picture(overcast), 2.0 * 7.0 * PI / 9.0),
    ];
    let mut checks = Vec::new();
    for (name, environment, expected) in cases {
        let id = format!("sky-image-{name}");
        let what = format!("irradiance of lying ground under a panorama, {name}");
        checks.push(match environment {
            Ok(environment) => check(&id, &what, expected, environment, 0.0),
            Err(_) => Check::exact((id, what), expected, 0.0, || Ok(f64::NAN)),
        });
    }
    checks
}
