//! Light on single organs: C-69, C-71, C-72; units of area: C-21; books: C-43; threads: C-59; memory: C-65; nothing at all: C-54.

use super::super::check::{Check, Setting, Trouble};
use super::super::room::gray;
use super::canopies::{SIGMAS, black, solve, sun, world};
use super::looks::{coarse, largest, placed, prepared, seen};
use super::{Row, checks_of};
use crate::color::Rgb;
use crate::geometry::Shape;
use crate::integrator::Radiosity;
use crate::integrator::interception::{
    Interception, InterceptionError, Lighting, SensorField, Wanted,
};
use crate::integrator::requirements::Features;
use crate::light::{Environment, Light, Sky};
use crate::material::Material;
use crate::math::functions::{cos, sin};
use crate::math::stats::RunningStats;
use crate::math::tolerance::{AIMED_BOXES, CLOSED_FORM};
use crate::math::{Ray, rng};
use crate::scene::Scene;
use crate::scene::description::{PlacedShape, SceneDescription};
use glam::{DAffine3, DQuat, DVec3};
use std::f64::consts::{PI, TAU};

/// The checks.
pub(super) fn checks() -> Vec<Check> {
    checks_of(ROWS)
}

/// Those that no setting changes.
const ROWS: [Row; 9] = [
    (
        "69",
        "C-69-backward",
        "six black leaves under a sun and a sky, photons and rays traced back from them: largest difference, standard errors",
        (0.0, SIGMAS),
        forward_and_backward,
    ),
    (
        "69",
        "C-69-radiosity",
        "two leaves face to face, one lit: what the other absorbs by photons over what radiosity shows on it",
        (1.0, 0.04),
        forward_and_radiosity,
    ),
    (
        "71",
        "C-71-halves",
        "a leaf among others cut in two: what both absorb less what the whole does, standard errors",
        (0.0, SIGMAS),
        halves,
    ),
    (
        "72",
        "C-72-turned",
        "six leaves, turned about two axes and moved 300 m with their lights: largest difference, standard errors",
        (0.0, SIGMAS),
        turned,
    ),
    (
        "21",
        "C-21-flux",
        "what leaves absorb in units of 2^-20 and 2^20 m, over the square of the unit: largest relative difference",
        (0.0, CLOSED_FORM),
        flux_in_other_units,
    ),
    (
        "43",
        "C-43-organs",
        "40,000 photons onto six leaves: books that do not balance to the quantum",
        (0.0, 0.0),
        |setting| {
            Ok(f64::from(
                !solve(&outdoors(DAffine3::IDENTITY)?, 6, None, 40_000, setting)?
                    .books
                    .is_balanced,
            ))
        },
    ),
    (
        "59",
        "C-59-organs",
        "40,000 photons onto six leaves on 1, 2, 3, 7 and 16 threads: results that are not the same to the bit",
        (0.0, 0.0),
        on_threads,
    ),
    (
        "65",
        "C-65-organs",
        "light on six organs in 1000 bytes: not refused",
        (0.0, 0.0),
        in_no_memory,
    ),
    (
        "54",
        "C-54-organs",
        "leaves without any light, and light without leaves: power absorbed, W",
        (0.0, 0.0),
        dark_and_empty,
    ),
];

/// A leaf, half as wide as long.
fn blade() -> Shape {
    Shape::Parallelogram {
        corner: DVec3::new(-0.5, -0.25, 0.0),
        edge_u: DVec3::X,
        edge_v: DVec3::Y * 0.5,
    }
}

/// A few leaves of different kinds, some in the shade of others.
fn leaves() -> (Vec<Material>, Vec<PlacedShape>) {
    let materials = vec![
        Material::leaf(Rgb::new(0.1, 0.3, 0.45), Rgb::new(0.05, 0.2, 0.45)),
        black(),
        Material::default().with_alpha(0.4),
    ];
    let leaf = |i: u32| {
        let k = f64::from(i);
        let turn = DQuat::from_rotation_x(0.5 * k) * DQuat::from_rotation_z(k);
        let at = DVec3::new(0.2 * f64::from(i % 3), 0.1 * k, 0.3 * k);
        let mut leaf = placed(blade(), DAffine3::from_rotation_translation(turn, at), i);
        leaf.material.0 = i % 3;
        leaf
    };
    (materials, (0..6).map(leaf).collect())
}

/// Shapes under a sun, a lamp and a sky, all put elsewhere.
fn under_lights(
    shapes: Vec<PlacedShape>,
    materials: Vec<Material>,
    to: DAffine3,
) -> SceneDescription {
    let scale = to.transform_vector3(DVec3::X).length();
    let shapes = shapes.into_iter().map(|mut placed| {
        placed.to_group = to * placed.to_group;
        placed
    });
    let down = to.transform_vector3(DVec3::new(0.3, 0.2, -1.0)).normalize();
    let lights = vec![
        Light::Directional {
            direction: down,
            irradiance: Rgb::new(3.0, 2.0, 1.0),
            origin: to.transform_point3(DVec3::Z * 10.0),
        },
        // Irradiance falls with the square of the distance.
        Light::point(
            to.transform_point3(DVec3::new(0.0, -1.0, 1.0)),
            Rgb::splat(5.0 * scale * scale),
        ),
    ];
    let mut drawn = world(materials, shapes.collect(), lights);
    drawn.environment.sky = Sky::Uniform(Rgb::splat(0.2));
    drawn
}

fn outdoors(to: DAffine3) -> Result<Scene, Trouble> {
    let (materials, shapes) = leaves();
    Ok(Scene::build(under_lights(shapes, materials, to))?)
}

/// The largest difference of what organs absorb, in standard errors.
fn differing(one: &Lighting, other: &Lighting, n: usize) -> f64 {
    let pairs = one.organs.iter().zip(&other.organs).take(n);
    largest(pairs.map(|(a, b)| {
        let error = a.errors.absorbed.hypot(b.errors.absorbed);
        (a.absorbed.sum() - b.absorbed.sum()).abs() / error
    }))
}

fn halves(setting: &Setting<'_>) -> Result<f64, Trouble> {
    let (materials, shapes) = leaves();
    let whole = Scene::build(under_lights(
        shapes.clone(),
        materials.clone(),
        DAffine3::IDENTITY,
    ))?;
    let mut cut = shapes;
    let half = |from: f64| Shape::Parallelogram {
        corner: DVec3::new(-0.5 + from, -0.25, 0.0),
        edge_u: DVec3::X * 0.5,
        edge_v: DVec3::Y * 0.5,
    };
    let mut other = cut[2].clone();
    other.shape = half(0.5);
    other.organ.0 = 6;
    cut[2].shape = half(0.0);
    cut.push(other);
    let parts = Scene::build(under_lights(cut, materials, DAffine3::IDENTITY))?;
    let whole = solve(&whole, 7, None, 100_000, setting)?;
    let parts = solve(&parts, 7, None, 100_000, setting)?;
    let organs = [&whole.organs[2], &parts.organs[2], &parts.organs[6]];
    let [all, one, other] = organs.map(|organ| organ.absorbed.sum());
    let error = organs
        .iter()
        .fold(0.0, |sum: f64, organ| sum.hypot(organ.errors.absorbed));
    Ok((one + other - all).abs() / error)
}

fn turned(setting: &Setting<'_>) -> Result<f64, Trouble> {
    let turn = DQuat::from_rotation_z(1.0) * DQuat::from_rotation_x(0.7);
    let to = DAffine3::from_rotation_translation(turn, DVec3::new(300.0, -20.0, 7.0));
    let usual = solve(&outdoors(DAffine3::IDENTITY)?, 6, None, 100_000, setting)?;
    let moved = solve(&outdoors(to)?, 6, None, 100_000, setting)?;
    Ok(differing(&usual, &moved, 6))
}

fn flux_in_other_units(setting: &Setting<'_>) -> Result<f64, Trouble> {
    let usual = solve(&outdoors(DAffine3::IDENTITY)?, 6, None, 20_000, setting)?;
    let mut all = Vec::new();
    for exponent in [-20, 20] {
        let scale = 2.0_f64.powi(exponent);
        let scene = outdoors(DAffine3::from_scale(DVec3::splat(scale)))?;
        let other = solve(&scene, 6, None, 20_000, setting)?;
        let pairs = usual.organs.iter().zip(&other.organs);
        all.extend(pairs.map(|(a, b)| {
            let (a, b) = (a.absorbed.sum(), b.absorbed.sum() / (scale * scale));
            (b / a - 1.0).abs()
        }));
    }
    Ok(largest(all))
}

fn on_threads(setting: &Setting<'_>) -> Result<f64, Trouble> {
    let scene = outdoors(DAffine3::IDENTITY)?;
    super::bounds::differing_on_threads(|| solve(&scene, 6, None, 40_000, setting))
}

fn in_no_memory(setting: &Setting<'_>) -> Result<f64, Trouble> {
    let scene = outdoors(DAffine3::IDENTITY)?;
    let tight = Interception {
        photons: 10,
        batches: 16,
        max_depth: 10,
        wanted: Wanted::default(),
        most_photons: 10,
        memory: 1000,
        plants: vec![],
        kept: Features::NONE,
    };
    let refused = tight.solve(&scene, 6, &SensorField::default(), None, &setting.context());
    let is_refused = matches!(refused, Err(InterceptionError::Memory { organs: 6, .. }));
    Ok(f64::from(!is_refused))
}

fn dark_and_empty(setting: &Setting<'_>) -> Result<f64, Trouble> {
    let (materials, shapes) = leaves();
    let dark = Scene::build(world(materials, shapes, vec![]))?;
    let empty = Scene::build(world(vec![], vec![], vec![sun(0.0, 0.0)]))?;
    let mut power = 0.0;
    for (scene, n) in [(dark, 6), (empty, 0)] {
        let found = solve(&scene, n, None, 1000, setting)?;
        if !found.books.is_balanced || found.organs.len() != n {
            return Err(Trouble("the books are wrong".into()));
        }
        power += found.total.absorbed.sum();
    }
    Ok(power)
}

/// Irradiance of both sides of a leaf by rays that look where light comes from: mean and standard error, W/m².
fn looked_back(scene: &Scene, leaf: &PlacedShape, light: &Light, stream: u64) -> (f64, f64) {
    let Light::Directional {
        direction,
        irradiance,
        ..
    } = light
    else {
        return (f64::NAN, f64::NAN);
    };
    let normal = leaf.to_group.transform_vector3(DVec3::Z);
    let look = |k: u64| {
        let u = |of: u64| rng::unit_f64(rng::hash(&[stream, k, of]));
        let at = DVec3::new(u(0) - 0.5, 0.5 * u(1) - 0.25, 0.0);
        let at = leaf.to_group.transform_point3(at);
        let side = if k.is_multiple_of(2) { normal } else { -normal };
        let x = side.any_orthonormal_vector();
        let (z, angle) = (u(2).sqrt(), TAU * u(3));
        let s = (1.0 - z * z).sqrt();
        let d = x * (s * cos(angle)) + side.cross(x) * (s * sin(angle)) + side * z;
        // Irradiance π L from each side.
        let from = |side: DVec3| at + side / 1e9;
        let of_sky = scene.transmittance(&Ray::new(from(side), d.normalize())).r * TAU;
        let to_sun = -*direction;
        let lit = normal * normal.dot(to_sun).signum();
        let of_sun = scene.transmittance(&Ray::new(from(lit), to_sun)).r;
        of_sky + of_sun * irradiance.r * lit.dot(to_sun)
    };
    let seen: RunningStats = (0..20_000).map(look).collect();
    (seen.mean(), seen.standard_error())
}

fn forward_and_backward(setting: &Setting<'_>) -> Result<f64, Trouble> {
    let (_, shapes) = leaves();
    let lamp = sun(0.6, 1.0);
    let mut drawn = world(
        vec![black(), black(), black()],
        shapes.clone(),
        vec![lamp.clone()],
    );
    drawn.environment.sky = Sky::Uniform(Rgb::WHITE);
    let scene = Scene::build(drawn)?;
    let found = solve(&scene, 6, None, 200_000, setting)?;
    let off = (0_u64..)
        .zip(&shapes)
        .zip(&found.organs)
        .map(|((i, leaf), organ)| {
            let (mean, error) = looked_back(&scene, leaf, &lamp, 99 + i);
            // Three channels on half a square metre.
            let area = 1.5;
            let error = error.hypot(organ.errors.absorbed / area);
            (organ.absorbed.sum() / area - mean).abs() / (error + AIMED_BOXES * mean)
        });
    Ok(largest(off))
}

/// Two leaves face to face; a narrow lamp lights only the lower one. What the upper absorbs is its absorptance times the irradiance
/// that radiosity shows on it.
fn forward_and_radiosity(setting: &Setting<'_>) -> Result<f64, Trouble> {
    let square = super::super::room::square(0.5);
    let (lower, upper) = (0.8, 0.4);
    let above = DAffine3::from_translation(DVec3::Z * 0.6);
    let lamp = Material::lambert(Rgb::BLACK).emitting(gray(1.0), Rgb::BLACK);
    // A panel that shines on the front of the lower leaf from beside, and not on the lower side of the upper one.
    let beside = DAffine3::from_translation(DVec3::new(1.2, 0.0, 1.2))
        * DAffine3::from_rotation_y(-0.75 * PI);
    let mut drawn = world(
        vec![
            Material::lambert(gray(lower)),
            Material::lambert(gray(upper)),
            lamp,
        ],
        vec![
            placed(square.clone(), DAffine3::IDENTITY, 0),
            placed(square.clone(), above * DAffine3::from_rotation_x(PI), 1),
            placed(square, beside, 2),
        ],
        vec![],
    );
    drawn.environment = Environment::default();
    let scene = Scene::build(drawn)?;
    let found = solve(&scene, 3, None, 400_000, setting)?;
    let by_photons = found.organs[1].absorbed.g;
    let method = Radiosity {
        hemicube_pixels: 32,
        ..coarse()
    };
    let estimator = prepared(&method, &scene, setting)?;
    let mut shown = 0.0;
    let n = 20;
    for k in 0..n * n {
        let along = |k: u32| (f64::from(k) + 0.5) / f64::from(n) - 0.5;
        for (height, up) in [(0.5, DVec3::Z), (0.7, DVec3::NEG_Z)] {
            let from = DVec3::new(along(k % n), along(k / n), height);
            let light = seen(&*estimator, &Ray::new(from, up), u64::from(k), 16);
            shown += light.g * PI / upper / f64::from(n * n);
        }
    }
    Ok(by_photons / ((1.0 - upper) * shown))
}
