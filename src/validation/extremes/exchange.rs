//! Form factors by every back end of radiosity against what is known on paper: C-1 to C-9, C-11.

use super::super::check::{Check, Setting, Trouble};
use super::super::room::{Room, gray, square};
use super::super::table::{number, parameter, rows};
use crate::geometry::Shape;
use crate::integrator::radiosity::FormFactorMethod;
use crate::integrator::radiosity::laid::{Laid, Means};
use crate::material::Material;
use crate::math::functions::{cos, sin};
use crate::math::tolerance::{SEVEN_DIGITS, SIX_DIGITS};
use crate::scene::SceneError;
use glam::{DAffine3, DQuat, DVec3};

/// The closed forms that J. R. Howell collected.
const TABLE: &str = include_str!("../tables/configuration_factors.csv");

/// Rays from each surface, all its patches together, and pixels along a hemicube.
const N_RAYS: u32 = 16_384;
const PIXELS: u32 = 32;

/// How far hemicubes may be off, as a part of the whole view: theirs are the factors of points.
const OF_HEMICUBES: f64 = 0.015;

/// What back ends there are.
pub(super) const METHODS: [(&str, FormFactorMethod); 3] = [
    ("rays", FormFactorMethod::Rays),
    ("hemicubes", FormFactorMethod::Hemicube),
    ("analytic", FormFactorMethod::Analytic),
];

/// Reflectance by which the surface that looks and the one that is looked at are told apart.
const FROM: f64 = 0.25;
const TO: f64 = 0.5;

/// A shape somewhere, and which of its sides (0 front).
type Place = (Shape, DAffine3, usize);

/// Two surfaces, with the factor from one to the other.
#[derive(Clone)]
struct Pair {
    from: Place,
    to: Place,
    expected: f64,
}

/// The checks: for each case and each back end that pair which uses most of what is allowed.
pub(super) fn checks() -> Vec<Check> {
    let mut checks = Vec::new();
    for case in ["1", "2", "3", "4", "5", "6", "7", "9", "11"] {
        let n = pairs(case).len();
        for (name, method) in METHODS {
            let allowed = match method {
                FormFactorMethod::Hemicube => "1.5 % of the view",
                FormFactorMethod::Rays | FormFactorMethod::Analytic => {
                    "4 standard errors of 16,384 rays"
                }
            };
            let what = format!(
                "radiosity, form factors by {name}, {n} pairs: largest error, in parts of {allowed}"
            );
            let measure = move |_: &Setting<'_>| {
                let mut used = pairs(case).into_iter().map(|pair| used(&pair, method));
                used.try_fold(0.0_f64, |most, used| Ok(most.max(used?)))
            };
            checks.push(
                Check::within((format!("C-{case}-{name}"), what), 0.0, 1.0, measure).of_case(case),
            );
        }
    }
    for case in ["1", "2"] {
        let what = "two patches, form factor on paper between them: largest relative error";
        let measure = move |_: &Setting<'_>| {
            let flat = pairs(case).into_iter().filter(|pair| pair.expected > 0.01);
            let mut off = flat.map(|pair| off_on_paper(&pair));
            off.try_fold(
                0.0_f64,
                |most, off: Result<f64, Trouble>| Ok(most.max(off?)),
            )
        };
        checks.push(
            Check::within(
                (format!("C-{case}-on-paper"), what),
                0.0,
                SEVEN_DIGITS,
                measure,
            )
            .of_case(case),
        );
    }
    let strips = "two strips, 1000 times as long as wide, form factor on paper: sqrt 2 - 1";
    let measure = |_: &Setting<'_>| {
        let pair = pairs("11")
            .pop()
            .ok_or_else(|| Trouble("no strips".into()))?;
        measured(&pair, FormFactorMethod::Analytic, 2)
    };
    let expected = 2.0_f64.sqrt() - 1.0;
    checks.push(Check::within(("C-11-on-paper", strips), expected, 0.001, measure).of_case("11"));
    checks
}

fn facing(normal: DVec3, position: DVec3) -> DAffine3 {
    DAffine3::from_rotation_translation(DQuat::from_rotation_arc(DVec3::Z, normal), position)
}

/// `corner + u · edge_u + v · edge_v`.
fn flat(corner: [f64; 3], edge_u: DVec3, edge_v: DVec3) -> Place {
    let corner = corner.into();
    let shape = Shape::Parallelogram {
        corner,
        edge_u,
        edge_v,
    };
    (shape, DAffine3::IDENTITY, 0)
}

/// A disk round the z axis that looks up or down.
fn disk(radius: f64, height: f64, normal: DVec3) -> Place {
    let place = facing(normal, DVec3::Z * height);
    (Shape::Disk { radius }, place, 0)
}

fn ball(radius: f64, center: DVec3, side: usize) -> Place {
    let place = DAffine3::from_translation(center);
    (Shape::Sphere { radius }, place, side)
}

/// A surface at the origin so small that it is a point.
fn spot(normal: DVec3) -> Place {
    (square(0.0005), facing(normal, DVec3::ZERO), 0)
}

/// All pairs of a case: rows of the table, and what the list of cases has beyond it.
fn pairs(case: &str) -> Vec<Pair> {
    let (x, y, z) = (DVec3::X, DVec3::Y, DVec3::Z);
    let listed = rows(TABLE).filter_map(|row| listed(case, &row));
    let mut pairs: Vec<Pair> = listed.collect();
    let mut add = |from, to, expected| {
        pairs.push(Pair { from, to, expected });
    };
    match case {
        "1" => {
            for (gap, expected) in [(0.01, 0.980_416_603), (10.0, 0.003_162_057)] {
                add(flat([0.0; 3], x, y), flat([0.0, 0.0, gap], y, x), expected);
            }
        }
        "4" => {
            for (radius, expected) in [
                (1.0, 0.5 * (1.0 - 0.5_f64.sqrt())),
                (0.6, 0.5 * (1.0 - 1.0 / 1.36_f64.sqrt())),
            ] {
                add(ball(0.5, z, 0), disk(radius, 0.0, z), expected);
            }
        }
        "6" => {
            for (degrees, radius) in [(30.0_f64, 0.5), (60.0, 0.3), (80.0, 0.1)] {
                let angle = degrees.to_radians();
                let normal = DVec3::new(sin(angle), 0.0, cos(angle));
                add(
                    spot(normal),
                    ball(radius, z, 0),
                    radius * radius * cos(angle),
                );
            }
        }
        "7" => {
            let (inner, outer) = (ball(0.4, DVec3::ZERO, 0), ball(1.0, DVec3::ZERO, 1));
            add(inner.clone(), outer.clone(), 1.0);
            add(outer, inner, 0.16);
        }
        "9" => {
            // A disk across a ball: what it sees is one half of it, and half of what a half sees is the disk.
            let around = ball(1.0, DVec3::ZERO, 1);
            add(disk(1.0, 0.0, z), around.clone(), 1.0);
            add(around, disk(1.0, 0.0, z), 0.25);
        }
        "11" => {
            let long = y * 1000.0;
            let expected = 2.0_f64.sqrt() - 1.0;
            add(
                flat([0.0; 3], x, long),
                flat([0.0, 0.0, 1.0], long, x),
                expected,
            );
        }
        _ => {}
    }
    pairs
}

/// A row of the table, if it belongs to the case.
fn listed(case: &str, row: &[&'static str]) -> Option<Pair> {
    let (name, list, expected) = (row.first()?, row.get(1)?, number(row, 2));
    let p = |key: &str| parameter(list, key);
    let (x, y, z) = (DVec3::X, DVec3::Y, DVec3::Z);
    let beginning: Vec<&str> = name.split([' ', '-']).take(2).collect();
    let (of, from, to) = match beginning[..] {
        ["C", "11"] => (
            "1",
            flat([0.0; 3], x * p("a"), y * p("b")),
            flat([0.0, 0.0, p("c")], y * p("b"), x * p("a")),
        ),
        ["C", "14"] => (
            "2",
            flat([0.0; 3], x * p("l"), y * p("w")),
            flat([0.0; 3], z * p("h"), x * p("l")),
        ),
        ["C", "41"] => ("3", disk(p("r1"), 0.0, z), disk(p("r2"), p("h"), -z)),
        ["dA", "parallel"] if name.contains("disk") => ("5", spot(z), disk(p("r"), p("h"), -z)),
        ["dA", "parallel"] => (
            "5",
            spot(z),
            flat([0.0, 0.0, p("c")], y * p("b"), x * p("a")),
        ),
        ["dA", "in"] => (
            "5",
            spot(z),
            flat([0.0, p("c"), 0.0], x * p("b"), z * p("a")),
        ),
        ["dA", "facing"] => ("6", spot(z), ball(p("r"), z * p("h"), 0)),
        ["sphere", _] => (
            "4",
            ball(0.5 * p("d"), z * p("d"), 0),
            flat([0.0; 3], x * p("l1"), y * p("l2")),
        ),
        _ => return None,
    };
    (of == case).then_some(Pair { from, to, expected })
}

/// The factor by a back end, with both surfaces cut into at most about so many patches.
fn measured(pair: &Pair, method: FormFactorMethod, most: u64) -> Result<f64, Trouble> {
    let paint = |rho: f64| Material::lambert(gray(rho));
    let room = Room::default()
        .with(pair.from.0.clone(), pair.from.1, paint(FROM))
        .with(pair.to.0.clone(), pair.to.1, paint(TO));
    let scene = room.scene()?;
    let laid = Laid::cut(&scene, most)?;
    let patches = laid.patches();
    let is_painted = |patch: usize, rho: f64| {
        let material = scene.material(patches[patch].material);
        material.sides[0].reflectance.g == rho
    };
    let from: Vec<usize> = (0..patches.len())
        .filter(|patch| is_painted(*patch, FROM))
        .collect();
    let per_row = N_RAYS.div_ceil(from.len().max(1) as u32);
    let means = Means::new(method, per_row, PIXELS);
    let rows = laid.rows(means, pair.from.2, from.iter().copied());
    let (mut area, mut exchanged) = (0.0, 0.0);
    for (patch, row) in from.into_iter().zip(rows) {
        let met = row
            .into_iter()
            .filter(|(side, _)| side % 2 == pair.to.2 && is_painted(side / 2, TO));
        area += patches[patch].area;
        exchanged += patches[patch].area * met.map(|(_, factor)| factor).sum::<f64>();
    }
    Ok(exchanged / area)
}

/// How much of what is allowed the error of a pair uses up.
fn used(pair: &Pair, method: FormFactorMethod) -> Result<f64, Trouble> {
    let is_round = |place: &Place| matches!(place.0, Shape::Sphere { .. });
    let most = match method {
        FormFactorMethod::Analytic => 48,
        _ if is_round(&pair.from) || is_round(&pair.to) => 64,
        _ => 256,
    };
    let allowed = match method {
        FormFactorMethod::Hemicube => OF_HEMICUBES,
        FormFactorMethod::Rays | FormFactorMethod::Analytic => {
            let variance = pair.expected * (1.0 - pair.expected) / f64::from(N_RAYS);
            4.0 * variance.sqrt() + SIX_DIGITS
        }
    };
    Ok((measured(pair, method, most)? - pair.expected).abs() / allowed)
}

/// The relative error of a form factor on paper between whole surfaces.
fn off_on_paper(pair: &Pair) -> Result<f64, Trouble> {
    Ok((measured(pair, FormFactorMethod::Analytic, 2)? / pair.expected - 1.0).abs())
}

/// Walls of a closed cube of 2 m, seen from inside, as six squares that look inwards, of these reflectances.
pub(super) fn cube(rho: [f64; 6]) -> Room {
    let axes = [
        DVec3::X,
        DVec3::Y,
        DVec3::Z,
        DVec3::NEG_X,
        DVec3::NEG_Y,
        DVec3::NEG_Z,
    ];
    axes.into_iter()
        .zip(rho)
        .fold(Room::default(), |room, (axis, rho)| {
            let turn = DQuat::from_rotation_arc(DVec3::Z, -axis);
            let place = DAffine3::from_rotation_translation(turn, axis);
            room.with(square(1.0), place, Material::lambert(gray(rho)))
        })
}

/// What is often built.
pub(super) fn gray_cube(rho: f64) -> Result<crate::scene::Scene, SceneError> {
    cube([rho; 6]).scene()
}
