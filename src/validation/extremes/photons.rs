//! The photon map: C-31 to C-42, and what stays in closed rooms: C-44.

use super::super::check::{Check, Setting, Trouble};
use super::super::room::{Room, at, gray, square};
use super::laid;
use super::looks::{largest, maps, mean_over, prepared, seen};
use super::{Effort, Row, checks_of};
use crate::color::Rgb;
use crate::geometry::Shape;
use crate::integrator::grid::Grid;
use crate::integrator::photon_map::BYTES_PER_PHOTON;
use crate::integrator::{
    Integrator, Path, PhotonMapping, Progress, RadianceEstimator, RenderContext, RenderError,
};
use crate::light::Light;
use crate::material::Material;
use crate::math::Ray;
use crate::math::angle::Angle;
use crate::math::tolerance::{BINNED_LIGHT, CLOSED_FORM};
use crate::scene::{Scene, SceneError};
use glam::{DAffine3, DVec3};
use std::f64::consts::PI;
use std::sync::atomic::{AtomicU64, Ordering};

/// The checks.
pub(super) fn checks(effort: Effort) -> Vec<Check> {
    let mut checks = checks_of(ROWS);
    checks.extend(many_photons(effort));
    checks.push(
        Check::within(
            (
                "C-41-slope",
                "power of the number of passes, 4 to 64, with which the squared error falls",
            ),
            -2.0 / 3.0,
            0.1,
            |_| laid::slope_of_passes(),
        )
        .of_case("41"),
    );
    checks.push(
        Check::within(
            (
                "C-41-kernels",
                "power with which the squared radius falls from pass 2^10 to pass 2^20",
            ),
            -1.0 / 3.0,
            0.001,
            |_| Ok(laid::slope_of_radii()),
        )
        .of_case("41"),
    );
    checks
}

/// Those that no setting changes.
const ROWS: [Row; 19] = [
    (
        "31",
        "C-31-area",
        "indirect light of a floor by photon areas of ×1/4, ×1, ×4 and ×16: largest relative difference from ×1",
        (0.0, 0.02),
        light_by_area,
    ),
    (
        "31",
        "C-31-truth",
        "the same by area ×1, over what the path tracer finds",
        (1.0, 0.02),
        light_over_truth,
    ),
    (
        "32",
        "C-32-mean",
        "even light by 600 maps of random photons: difference from it, standard errors",
        (0.0, 5.0),
        |_| laid::bias_of_even_light(),
    ),
    (
        "32",
        "C-32-noise",
        "its relative variance times the photons in the kernel: 4/3 for Epanechnikov's",
        (4.0 / 3.0, 0.3 * 4.0 / 3.0),
        |_| laid::noise_of_even_light(),
    ),
    (
        "33",
        "C-33-slope",
        "bias where light rises evenly, of 1 W/m²",
        (0.0, 0.0001),
        |_| laid::bias_of_a_slope(),
    ),
    (
        "33",
        "C-33-curvature",
        "bias where its Laplacian is 8 W/m⁴, by r²: for radii of 0.05, 0.1, 0.2 m the one farthest from 8/12",
        (8.0 / 12.0, 0.01),
        |_| laid::bias_of_curvature(),
    ),
    (
        "34",
        "C-34-sizes",
        "kernels of 10^-300, 10^-12, 1e12 and 1e300 m²: means that are negative or no numbers",
        (0.0, 0.0),
        kernels_that_fail,
    ),
    (
        "34",
        "C-34-nothing",
        "light by a kernel of no area",
        (0.0, 0.0),
        |setting| indirect(&maps(20_000, 0, Some(0.0)), (-1.0, 1.0), setting),
    ),
    (
        "35",
        "C-35-edge",
        "a strip at the edge of a floor, narrower than the kernel, over what the path tracer finds",
        (1.0, 0.1),
        |setting| strip_over_truth((-1.99, -1.93), setting),
    ),
    (
        "35",
        "C-35-middle",
        "a strip in the middle, over what the path tracer finds",
        (1.0, 0.1),
        |setting| strip_over_truth((0.0, 0.1), setting),
    ),
    (
        "35",
        "C-35-leak",
        "light on the dark face of a cube whose other faces are lit",
        (0.0, 0.0),
        leak,
    ),
    (
        "36",
        "C-36-kernel",
        "both sides of a leaf of 0.3 m under kernels of 0.5 and of 0.9 m²: largest relative difference",
        (0.0, BINNED_LIGHT),
        leaf_by_kernel,
    ),
    (
        "36",
        "C-36-truth",
        "both sides over what the path tracer finds: the one farther from 1",
        (1.0, 0.06),
        leaf_over_truth,
    ),
    (
        "37",
        "C-37-no-photon",
        "without photons: a floor with indirect light only, W/(m² sr)",
        (0.0, 0.0),
        |setting| indirect(&maps(0, 0, None), (-1.0, 1.0), setting),
    ),
    (
        "37",
        "C-37-direct",
        "without photons and with one or two: direct light of a wall over the path tracer's, farthest from 1; without: only that",
        (1.0, CLOSED_FORM),
        direct_alone,
    ),
    (
        "38",
        "C-38-coincident",
        "100,000 coincident points: how many a search finds",
        (100_000.0, 0.0),
        |_| Ok(coincident_found()),
    ),
    (
        "38",
        "C-38-map",
        "a map of 20,000 photons that a lamp sends onto one spot of a millimetre: means that are no numbers",
        (0.0, 0.0),
        focused_fail,
    ),
    (
        "42",
        "C-42-wrong-side",
        "10,000 photons of the other side, of a wall and of a layer 2 cm above: irradiance on the plane",
        (0.0, 0.0),
        |_| laid::wrong_sides(),
    ),
    (
        "44",
        "C-44-map",
        "stored light that is seen outside of a closed ball with a lamp in it, from above and on the ground, W/(m² sr)",
        (0.0, 0.0),
        outside_of_a_ball,
    ),
];

/// A black lamp box above a white floor: all that the floor has is what a gray wall throws at it.
fn corner() -> Result<Scene, SceneError> {
    let upright = at(2.0, 0.0, 2.0) * DAffine3::from_rotation_y(-PI / 2.0);
    let (inner, outer) = (Angle::deg(20.0), Angle::deg(25.0));
    let from = DVec3::new(-1.5, 0.0, 2.0);
    Room::default()
        .with(square(2.0), at(0., 0., 0.), Material::lambert(gray(0.5)))
        .with(square(2.0), upright, Material::lambert(gray(0.8)))
        .lit_by(Light::spot(from, DVec3::X, inner, outer, gray(100.0)))
        .scene()
}

/// Radiance of the floor of [`corner`] between two values of its first coordinate.
fn strip(estimator: &dyn RadianceEstimator, (low, high): (f64, f64), samples: u32) -> f64 {
    let from = |u: f64, v: f64| DVec3::new(low + u * (high - low), v * 2.0 - 1.0, 0.0);
    let n = if samples == 1 { 32 } else { 16 };
    mean_over(estimator, (n, samples), from, DVec3::NEG_Z)
}

/// The same by a map.
fn indirect(map: &PhotonMapping, range: (f64, f64), setting: &Setting<'_>) -> Result<f64, Trouble> {
    let scene = corner()?;
    let estimator = prepared(map, &scene, setting)?;
    Ok(strip(&*estimator, range, 1))
}

/// The same by paths.
fn truth(range: (f64, f64), setting: &Setting<'_>) -> Result<f64, Trouble> {
    let scene = corner()?;
    let estimator = prepared(&Path::default(), &scene, setting)?;
    Ok(strip(&*estimator, range, 128))
}

/// Where no edge is near.
const INSIDE: (f64, f64) = (-1.2, 1.2);

fn light_by_area(setting: &Setting<'_>) -> Result<f64, Trouble> {
    let by_area = |area: f64| indirect(&maps(600_000, 0, Some(area)), INSIDE, setting);
    let usual = by_area(0.04)?;
    let mut all = Vec::new();
    for area in [0.01, 0.16, 0.64] {
        all.push((by_area(area)? / usual - 1.0).abs());
    }
    Ok(largest(all))
}

fn light_over_truth(setting: &Setting<'_>) -> Result<f64, Trouble> {
    let found = indirect(&maps(600_000, 0, Some(0.04)), INSIDE, setting)?;
    Ok(found / truth(INSIDE, setting)?)
}

fn strip_over_truth(range: (f64, f64), setting: &Setting<'_>) -> Result<f64, Trouble> {
    let found = indirect(&maps(300_000, 0, Some(0.04)), range, setting)?;
    Ok(found / truth(range, setting)?)
}

fn kernels_that_fail(setting: &Setting<'_>) -> Result<f64, Trouble> {
    let tiny = 1.0 / 1e300;
    let mut failed = 0;
    for area in [tiny, 1.0 / 1e12, 1e12, 1e300] {
        let light = indirect(&maps(20_000, 0, Some(area)), (-1.0, 1.0), setting)?;
        failed += u32::from(!light.is_finite() || light < 0.0);
    }
    Ok(f64::from(failed))
}

/// A cube, lit on one side only, through a wall: its dark side stays dark.
fn leak(setting: &Setting<'_>) -> Result<f64, Trouble> {
    let cube = Shape::Box {
        half_x: 0.5,
        half_y: 0.5,
        length: 1.0,
    };
    let bright = at(3.0, 0.0, 0.5) * DAffine3::from_rotation_y(-PI / 2.0);
    let (inner, outer) = (Angle::deg(8.0), Angle::deg(10.0));
    let down = DVec3::new(2.0, 0.0, -2.0).normalize();
    let lamp = Light::spot(DVec3::new(1.0, 0.0, 2.5), down, inner, outer, gray(100.0));
    let scene = Room::default()
        .with(cube, at(0., 0., 0.), Material::lambert(gray(0.5)))
        .with(square(0.8), bright, Material::lambert(gray(0.9)))
        .lit_by(lamp)
        .scene()?;
    let estimator = prepared(&maps(100_000, 0, Some(0.09)), &scene, setting)?;
    let face = |x: f64| {
        let from = move |u: f64, v: f64| DVec3::new(x, u - 0.5, v);
        mean_over(&*estimator, (12, 1), from, DVec3::X * -x.signum())
    };
    if face(0.5) > 0.1 {
        Ok(face(-0.5))
    } else {
        Err(Trouble("the lit face is dark too".into()))
    }
}

/// Under a matt dome that glows indirectly, two leaves: radiance of the first, seen along a direction.
fn leaf(
    method: &dyn Integrator,
    samples: u32,
    w: DVec3,
    setting: &Setting<'_>,
) -> Result<f64, Trouble> {
    let leaf = Material::leaf(gray(0.4), gray(0.3));
    let dome = Shape::Sphere { radius: 1.0 };
    let wide = Angle::deg(30.0);
    let scene = Room::default()
        .with(dome, at(0., 0., 0.), Material::lambert(gray(0.7)))
        .with(square(0.15), at(0.3, 0.0, 0.0), leaf.clone())
        .with(square(0.15), at(-0.3, 0.0, 0.05), leaf)
        .lit_by(Light::spot(
            DVec3::Z * 0.5,
            DVec3::Z,
            wide,
            wide,
            gray(10.0),
        ))
        .scene()?;
    let estimator = prepared(method, &scene, setting)?;
    let from = |u: f64, v: f64| DVec3::new(0.16 + 0.28 * u, 0.28 * v - 0.14, 0.0);
    Ok(mean_over(&*estimator, (6, samples), from, w))
}

const BOTH_WAYS: [DVec3; 2] = [DVec3::Z, DVec3::NEG_Z];

fn leaf_by_kernel(setting: &Setting<'_>) -> Result<f64, Trouble> {
    let mut all = Vec::new();
    for w in BOTH_WAYS {
        let one = leaf(&maps(100_000, 0, Some(0.5)), 1, w, setting)?;
        let other = leaf(&maps(100_000, 0, Some(0.9)), 1, w, setting)?;
        all.push((one / other - 1.0).abs());
    }
    Ok(largest(all))
}

fn leaf_over_truth(setting: &Setting<'_>) -> Result<f64, Trouble> {
    let mut all = Vec::new();
    for w in BOTH_WAYS {
        let found = leaf(&maps(800_000, 0, Some(0.5)), 1, w, setting)?;
        all.push(found / leaf(&Path::default(), 512, w, setting)?);
    }
    Ok(farthest(1.0, all))
}

/// That of some numbers which is farthest from `from`; NaN if any is.
fn farthest(from: f64, numbers: Vec<f64>) -> f64 {
    let off = |x: &f64| (x - from).abs();
    let farther = |a: f64, b: f64| if off(&b) <= off(&a) { a } else { b };
    numbers.into_iter().fold(from, farther)
}

fn direct_alone(setting: &Setting<'_>) -> Result<f64, Trouble> {
    let scene = corner()?;
    let wall = Ray::new(DVec3::new(0.0, 0.0, 2.0), DVec3::X);
    let path = Path {
        max_depth: Some(1),
        ..Path::default()
    };
    let direct = seen(&*prepared(&path, &scene, setting)?, &wall, 7, 4).g;
    let of = |n| {
        Ok::<f64, Trouble>(seen(&*prepared(&maps(n, n, None), &scene, setting)?, &wall, 7, 4).g)
    };
    for n in [1, 2] {
        if !of(n)?.is_finite() {
            return Ok(f64::NAN);
        }
    }
    Ok(of(0)? / direct)
}

fn coincident_found() -> f64 {
    let points = vec![DVec3::new(0.3, -0.7, 0.1); 100_000];
    let grid = Grid::new(points, 0.5, |p| *p);
    let mut found = 0_u32;
    grid.near(DVec3::new(0.2, -0.6, 0.0), |_| found += 1);
    f64::from(found)
}

/// A narrow lamp onto a tiny mirror sends all photons to the same spot of a wall.
fn focused_fail(setting: &Setting<'_>) -> Result<f64, Trouble> {
    let narrow = Angle::deg(0.01);
    let scene = Room::default()
        .with(square(1.0), at(0., 0., 0.), Material::lambert(gray(0.8)))
        .with(square(1.0), at(0., 0., 2.), Material::lambert(gray(0.8)))
        .lit_by(Light::spot(
            DVec3::Z,
            DVec3::NEG_Z,
            narrow,
            narrow,
            gray(10.0),
        ))
        .scene()?;
    let mut failed = 0;
    for area in [None, Some(0.01)] {
        let estimator = prepared(&maps(20_000, 0, area), &scene, setting)?;
        for k in 0..64 {
            let x = f64::from(k) / 40.0 - 0.8;
            for w in BOTH_WAYS {
                let ray = Ray::new(DVec3::new(x, 0.0, 1.0), w);
                failed += u32::from(!seen(&*estimator, &ray, 1, 1).is_finite());
            }
        }
    }
    Ok(f64::from(failed))
}

fn outside_of_a_ball(setting: &Setting<'_>) -> Result<f64, Trouble> {
    let white = || Material::lambert(gray(0.8));
    let scene = Room::default()
        .with(Shape::Sphere { radius: 1.0 }, at(0., 0., 0.), white())
        .with(square(5.0), at(0.0, 0.0, -1.5), white())
        .lit_by(Light::point(DVec3::new(0.2, 0.0, 0.0), gray(10.0)))
        .scene()?;
    let estimator = prepared(&maps(50_000, 0, None), &scene, setting)?;
    let looks = [
        Ray::new(DVec3::Z * 3.0, DVec3::NEG_Z),
        Ray::new(DVec3::new(2.0, 0.0, 3.0), DVec3::NEG_Z),
    ];
    let all: Rgb = looks.iter().map(|ray| seen(&*estimator, ray, 1, 4)).sum();
    Ok(all.sum())
}

/// C-39: a number that will not fit is refused before photons are sent; one that is sent in passes fits.
fn many_photons(effort: Effort) -> Vec<Check> {
    let refused = Check::within(
        (
            "C-39-refused",
            "1e8 photons into a closed room, with 3.9 GB: photons sent before it is refused (-1: not refused)",
        ),
        0.0,
        0.0,
        sent_before_refusal,
    );
    let (passes, of_each, what) = match effort {
        Effort::Short => (
            20,
            5000,
            "1e5 photons in 20 passes (short; in full 1e8 in 100)",
        ),
        Effort::Full => (100, 1_000_000, "1e8 photons in 100 passes"),
    };
    let made = Check::within(
        (
            "C-39-made",
            format!("{what}, with room for those of one: light of a floor over the path tracer's"),
        ),
        1.0,
        0.05,
        move |setting| {
            let map = PhotonMapping {
                passes,
                most_stored: 2 * of_each,
                ..maps(of_each, 0, None)
            };
            Ok(indirect(&map, INSIDE, setting)? / truth(INSIDE, setting)?)
        },
    );
    [refused, made].map(|check| check.of_case("39")).into()
}

fn sent_before_refusal(setting: &Setting<'_>) -> Result<f64, Trouble> {
    let white = Material::lambert(gray(0.8));
    let scene = Room::default()
        .with(Shape::Sphere { radius: 1.0 }, at(0., 0., 0.), white)
        .lit_by(Light::point(DVec3::new(0.1, 0.2, 0.3), gray(1.0)))
        .scene()?;
    let sent = AtomicU64::new(0);
    let progress = |progress: Progress| sent.store(progress.done, Ordering::Relaxed);
    let context = RenderContext {
        progress: &progress,
        ..setting.context()
    };
    let map = PhotonMapping {
        most_stored: 3_900_000_000 / BYTES_PER_PHOTON,
        ..maps(100_000_000, 0, None)
    };
    match map.solve(&scene, &context) {
        Err(RenderError::TooManyPhotons { n, most }) if n > most => {
            Ok(sent.load(Ordering::Relaxed) as f64)
        }
        _ => Ok(-1.0),
    }
}
