//! Closed rooms and stacks of leaves, where light goes back and forth without end (C-17, C-51, C-55, C-56).

use super::check::{Check, FAULT};
use super::probe::{Experiment, Look};
use super::room::{Room, at, even_sky, gray, square};
use super::table::{number, rows};
use crate::geometry::Shape;
use crate::integrator::Path;
use crate::integrator::path::Strategies;
use crate::light::Light;
use crate::material::Material;
use crate::math::{Ray, warp};
use glam::{DAffine3, DQuat, DVec2, DVec3};
use std::f64::consts::{FRAC_1_PI, PI};

/// L after all and after so many reflections, and what a lamp makes in a cube.
const ENCLOSURE: &str = include_str!("tables/furnace_and_integrating_enclosure.csv");

/// What stacks of endless leaves reflect.
const STACKS: &str = include_str!("tables/infinite_sheet_stack.csv");

/// In all directions from a point inside.
fn all_round() -> Look {
    Box::new(|u| Ray::new(DVec3::new(0.1, -0.2, 0.3), warp::sphere(u)))
}

/// A closed room whose walls shine with radiance 1 inside and reflect ρ.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Furnace {
    Ball,
    Box,
    /// 96 squares: more sources than are all sampled at once.
    Tiles,
}

impl Furnace {
    fn room(self, rho: f64) -> Room {
        let wall = |front, back| Material::lambert(gray(rho)).emitting(gray(front), gray(back));
        match self {
            Self::Ball => Room::default().with(
                Shape::Sphere { radius: 1.0 },
                at(0., 0., 0.),
                wall(0.0, 1.0),
            ),
            Self::Box => {
                let cube = Shape::Box {
                    half_x: 0.9,
                    half_y: 1.0,
                    length: 2.0,
                };
                Room::default().with(cube, at(0.0, 0.0, -1.0), wall(0.0, 1.0))
            }
            Self::Tiles => tiles(&wall(1.0, 0.0)),
        }
    }
}

fn tiles(material: &Material) -> Room {
    let mut room = Room::default();
    for axis in [
        DVec3::X,
        DVec3::Y,
        DVec3::Z,
        DVec3::NEG_X,
        DVec3::NEG_Y,
        DVec3::NEG_Z,
    ] {
        let turn = DQuat::from_rotation_arc(DVec3::Z, -axis);
        for i in 0..16 {
            let place = DVec3::new(
                f64::from(i % 4) * 0.5 - 0.75,
                f64::from(i / 4) * 0.5 - 0.75,
                0.0,
            );
            let to_world = DAffine3::from_rotation_translation(turn, axis + turn * place);
            room = room.with(square(0.25), to_world, material.clone());
        }
    }
    room
}

/// All of them.
pub(super) fn checks() -> Vec<Check> {
    let mut checks = Vec::new();
    for row in rows(ENCLOSURE) {
        let furnaces = furnace(&row).into_iter();
        checks.extend(furnaces.map(|check| check.of_case("17")));
        checks.extend(lamp_in_a_cube(&row).map(|check| check.of_case("51")));
    }
    checks.extend(ways());
    let spheres = integrating_spheres().into_iter();
    checks.extend(spheres.map(|check| check.of_case("51")));
    checks.extend(stacks());
    checks
}

/// A shining ball, after all reflections and after 0 to 10.
fn furnace(row: &[&'static str]) -> Vec<Check> {
    let (rho, name) = (number(row, 0), row[0]);
    let mut checks = Vec::new();
    let columns = [
        (1, None),
        (2, Some(1)),
        (3, Some(2)),
        (4, Some(5)),
        (5, Some(10)),
    ];
    for (column, max_depth) in columns {
        let depth = max_depth.map_or("all".into(), |depth: u32| depth.to_string());
        let what = format!(
            "radiance in a closed ball, walls of radiance 1 and rho {name}, {depth} reflections"
        );
        let id = format!("enclosure-{name}-{depth}");
        checks.push(Check::mean(
            (id, what),
            number(row, column),
            fault(rho),
            move || {
                let path = if rho <= 0.3 {
                    // Roulette would leave the last of the series to paths so rare that nobody meets one, whose absence
                    // shows in no standard error; after so many reflections nothing is left.
                    Path {
                        max_depth: Some(max_depth.unwrap_or(40)),
                        roulette_after: None,
                        ..Path::default()
                    }
                } else {
                    Path {
                        max_depth,
                        ..Path::default()
                    }
                };
                Ok(
                    Experiment::new(Furnace::Ball.room(rho).scene()?, all_round())
                        .by(path)
                        .spread(spread(rho)),
                )
            },
        ));
    }
    checks
}

/// The mean illuminance of the walls of a cube of 4 m with a lamp of 10,000 lm in the middle: direct and indirect.
fn lamp_in_a_cube(row: &[&'static str]) -> Option<Check> {
    let (rho, flux, surface) = (number(row, 0), 10_000.0, 96.0);
    let expected = flux / surface + number(row, 6);
    let what = format!(
        "mean illuminance in a cube of 4 m with a lamp of 10,000 lm, rho {}, lx",
        row[0]
    );
    // Where nothing is reflected nothing is seen.
    (rho > 0.0).then(|| {
        Check::mean(
            (format!("cube-{}", row[0]), what),
            expected,
            fault(rho),
            move || {
                let cube = Shape::Box {
                    half_x: 2.0,
                    half_y: 2.0,
                    length: 4.0,
                };
                let scene = Room::default()
                    .with(cube, at(0., 0., -2.), Material::lambert(gray(rho)))
                    .lit_by(Light::point(DVec3::ZERO, gray(flux)))
                    .scene()?;
                Ok(Experiment::new(scene, walls_of_a_cube())
                    .times(PI / rho)
                    .spread(spread(rho)))
            },
        )
    })
}

/// At all points of the walls of a cube round the origin, 2 m to each side.
fn walls_of_a_cube() -> Look {
    Box::new(|u: DVec2| {
        let face = (6.0 * u.x).floor().min(5.0);
        let across = DVec2::new(6.0 * u.x - face, u.y) * 4.0 - DVec2::splat(2.0);
        let (axis, side) = (
            face as usize / 2,
            if face % 2.0 == 0.0 { 1.0 } else { -1.0 },
        );
        let mut outward = DVec3::ZERO;
        outward[axis] = side;
        let mut point = outward;
        point[(axis + 1) % 3] = across.x;
        point[(axis + 2) % 3] = across.y;
        Ray::new(point, outward)
    })
}

/// All ways of finding light, roulette early, late and never, in rooms of other shapes.
fn ways() -> Vec<Check> {
    let (rho, depth) = (0.7_f64, 12);
    let series = (1.0 - rho.powi(depth + 1)) / (1.0 - rho);
    let mut checks = Vec::new();
    for (room, furnace) in [("box", Furnace::Box), ("tiles", Furnace::Tiles)] {
        // Points chosen by area in the corner of a box have no finite variance: light by lights alone is for the tiles.
        for (way, strategies, roulette, after) in [
            ("both", Strategies::Both, "4", Some(4)),
            ("both", Strategies::Both, "0", Some(0)),
            ("both", Strategies::Both, "never", None),
            ("lights", Strategies::LightsOnly, "4", Some(4)),
            ("rays", Strategies::ScatteringOnly, "4", Some(4)),
        ] {
            if furnace == Furnace::Box && strategies == Strategies::LightsOnly {
                continue;
            }
            let id = format!("ways-{room}-{way}-{roulette}");
            let what = format!(
                "radiance in a closed {room}, rho 0.7, 12 reflections, light by {way}, roulette after {roulette}"
            );
            let check = Check::mean((id, what), series, FAULT, move || {
                let path = Path {
                    max_depth: Some(depth.unsigned_abs()),
                    strategies,
                    roulette_after: after,
                    ..Path::default()
                };
                Ok(Experiment::new(furnace.room(rho).scene()?, all_round()).by(path))
            });
            // What is about roulette, and what is about ways of finding light.
            let case = if after == Some(4) { "55" } else { "56" };
            checks.push(check.of_case(case));
        }
    }
    checks
}

/// The fault that must be seen in an enclosure: paths of 1/(1 - ρ) reflections are dear, and differ much in length. Where
/// there are a thousand, a fault of a fifth is one of 2 in 10,000 in each.
fn fault(rho: f64) -> f64 {
    match rho {
        ..0.85 => FAULT,
        ..0.995 => 5.0 * FAULT,
        _ => 10.0 * FAULT,
    }
}

/// Samples of one observation: few where paths are long.
fn spread(rho: f64) -> u32 {
    if rho < 0.85 { 16 } else { 4 }
}

/// A matt ball with a lamp in the middle: L = Φρ/(πA(1 - ρ)).
fn integrating_spheres() -> Vec<Check> {
    let (radius, power) = (2.0, 30.0);
    let area = 4.0 * PI * radius * radius;
    let mut checks = Vec::new();
    for rho in [0.5, 0.9, 0.99, 0.999] {
        let expected = power * rho * FRAC_1_PI / area / (1.0 - rho);
        let what = format!("radiance in an integrating sphere, rho {rho}: P rho/(pi A (1-rho))");
        checks.push(Check::mean(
            (format!("sphere-{rho}"), what),
            expected,
            fault(rho),
            move || {
                let scene = Room::default()
                    .with(
                        Shape::Sphere { radius },
                        at(0., 0., 0.),
                        Material::lambert(gray(rho)),
                    )
                    .lit_by(Light::point(DVec3::ZERO, gray(power)))
                    .scene()?;
                Ok(Experiment::new(scene, all_round()).spread(spread(rho)))
            },
        ));
    }
    checks
}

/// Endless leaves one above the other over soil, lit evenly from above: what comes back.
fn stacks() -> Vec<Check> {
    let mut checks = Vec::new();
    for (nth, row) in rows(STACKS).enumerate() {
        let [n, rho, tau, soil, back] = [0, 1, 2, 3, 4].map(|column| number(&row, column));
        let what =
            format!("reflectance of {n} endless leaves, rho {rho} tau {tau}, over soil of {soil}");
        let name = (format!("stack-{:02}", nth + 1), what);
        let make = move || {
            let leaf = Material::leaf(gray(rho), gray(tau));
            let soil =
                Room::default().with(Shape::Plane, at(0., 0., 0.), Material::lambert(gray(soil)));
            let room = (1..=n as u32).fold(soil, |room, k| {
                room.with(Shape::Plane, at(0., 0., f64::from(k)), leaf.clone())
            });
            let look: Look = Box::new(move |u| {
                let up = warp::cosine_hemisphere(u);
                Ray::new(DVec3::Z * (n + 1.0), -up)
            });
            Ok(Experiment::new(room.under(even_sky(1.0)).scene()?, look))
        };
        checks.push(Check::mean(name, back, FAULT, make));
    }
    checks
}
