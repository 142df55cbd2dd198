//! Other ways to the same mean: of finding light, of ending paths, of leaving out what a scene does not require: C-55, C-56, C-60.

use super::super::check::{Check, Setting, Trouble};
use super::super::probe::{Experiment, along};
use super::super::room::{Room, at, glow, gray, square};
use super::looks::{around, differing, largest, maps, prepared, seen};
use super::seeing::{ball, floor};
use super::{Row, checks_of};
use crate::color::Rgb;
use crate::geometry::Shape;
use crate::integrator::path::Strategies;
use crate::integrator::requirements::{Feature, Features, Promise};
use crate::integrator::{Integrator, Path, PhotonMapping};
use crate::material::{Lobe, LobeKind, Material};
use crate::math::functions::{cos, sin};
use crate::math::stats::RunningStats;
use crate::math::{Ray, rng};
use crate::scene::Scene;
use glam::{DAffine3, DVec3};
use std::f64::consts::PI;

/// The checks.
pub(super) fn checks() -> Vec<Check> {
    checks_of(ROWS)
}

/// Those that no setting changes.
const ROWS: [Row; 5] = [
    (
        "55",
        "C-55-lobes",
        "before mirror, metal, Phong and matt mixed, behind a pane: light by lamps, by directions and by both: largest difference, standard errors",
        (0.0, 6.0),
        ways_before_lobes,
    ),
    (
        "55",
        "C-55-mis",
        "a lamp of 10 cm seen in a floor: light by both ways over light by lamps only",
        (1.0, 0.02),
        mixed_over_lamps,
    ),
    (
        "56",
        "C-56-glass",
        "a shining room with a ball of glass, roulette at once and after four: mean over 1/(1-rho), farthest from 1, standard errors",
        (0.0, 6.0),
        roulette_and_glass,
    ),
    (
        "60",
        "C-60-guide",
        "a lamp in a mirror ball: guided paths less unguided, standard errors",
        (0.0, 6.0),
        guide_on_and_off,
    ),
    (
        "60",
        "C-60-kept",
        "a matt room with a lamp, by paths and photons, each feature kept that it does not require and that promises the same bits: looks that differ",
        (0.0, 0.0),
        features_kept,
    ),
];

/// Means of what is seen along rays, by paths of these settings, 4 samples each.
fn means(
    scene: &Scene,
    path: &Path,
    n: u64,
    setting: &Setting<'_>,
    ray: impl Fn(u64) -> Ray,
) -> Result<RunningStats, Trouble> {
    let estimator = prepared(path, scene, setting)?;
    let look = |k: u64| seen(&*estimator, &ray(k), rng::hash(&[setting.seed, k]), 4).g;
    Ok((0..n).map(look).collect())
}

/// How far two means are apart, in standard errors; refused where six of those are more than 12 % of the mean.
fn apart(a: &RunningStats, b: &RunningStats) -> Result<f64, Trouble> {
    let error = a.standard_error().hypot(b.standard_error());
    if error > 0.02 * b.mean() {
        return Err(Trouble(format!("{b:?} is too noisy to see 12 %")));
    }
    Ok((a.mean() - b.mean()).abs() / error)
}

fn ways_before_lobes(setting: &Setting<'_>) -> Result<f64, Trouble> {
    let lamp = Material::lambert(Rgb::BLACK).emitting(gray(4.0), gray(4.0));
    let phong = Material::of_lobes(vec![Lobe::new(
        LobeKind::Phong { exponent: 10.0 },
        gray(0.8),
    )]);
    let rough = Material::metal(gray(0.9), 0.6);
    let shiny = Material::mixed(
        &Material::mixed(&Material::mirror(gray(0.9)), &rough, 0.6),
        &Material::mixed(&phong, &Material::lambert(gray(0.6)), 0.5),
        0.5,
    );
    let scene = Room::default()
        .with(Shape::Plane, at(0., 0., 0.), shiny)
        .with(ball(0.8), at(0.0, 1.0, 1.2), lamp)
        .with(
            square(1.5),
            at(0.5, 0.8, 0.3),
            Material::pane(1.5, gray(0.8)),
        )
        .scene()?;
    let down = DVec3::new(0.0, 1.0, -0.5).normalize();
    let ray = |k: u64| {
        let x = rng::unit_f64(rng::hash(&[7, k])) - 0.5;
        Ray::new(DVec3::new(x, -1.4, 1.0), down)
    };
    let by = |strategies| {
        let path = Path {
            strategies,
            max_depth: Some(2),
            ..Path::default()
        };
        means(&scene, &path, 6000, setting, ray)
    };
    let both = by(Strategies::Both)?;
    let others = [by(Strategies::LightsOnly)?, by(Strategies::ScatteringOnly)?];
    let apart: Result<Vec<f64>, Trouble> = others.iter().map(|other| apart(&both, other)).collect();
    Ok(largest(apart?))
}

fn mixed_over_lamps(_: &Setting<'_>) -> Result<f64, Trouble> {
    let by = |strategies, spread| -> Result<RunningStats, Trouble> {
        let scene = floor().with(
            square(0.05),
            at(0., 0., 1.) * DAffine3::from_rotation_x(PI),
            glow(),
        );
        let path = Path {
            strategies,
            max_depth: Some(1),
            ..Path::default()
        };
        let look = along(DVec3::new(0.2, 0.0, 0.5), DVec3::NEG_Z);
        let experiment = Experiment::new(scene.scene()?, look)
            .by(path)
            .spread(spread);
        let cancel = crate::integrator::CancelToken::default();
        Ok(experiment.observe(1, &cancel, |seen| seen.n() >= 512))
    };
    Ok(by(Strategies::Both, 64)?.mean() / by(Strategies::LightsOnly, 64)?.mean())
}

fn roulette_and_glass(setting: &Setting<'_>) -> Result<f64, Trouble> {
    let wall = Material::lambert(gray(0.2)).emitting(gray(0.0), gray(1.0));
    let scene = Room::default()
        .with(ball(3.0), at(0., 0., 0.), wall)
        .with(
            ball(1.0),
            at(1.2, 0., 0.),
            Material::glass(1.5, 0.0, Rgb::BLACK),
        )
        .scene()?;
    let ray = |k: u64| {
        let turn = 2.0 * PI * rng::unit_f64(rng::hash(&[9, k]));
        let w = DVec3::new(cos(turn), sin(turn), 0.1).normalize();
        Ray::new(DVec3::new(-1.0, 0.1, 0.0), w)
    };
    let mut worst = Vec::new();
    for after in [Some(0), Some(4)] {
        let path = Path {
            roulette_after: after,
            ..Path::default()
        };
        let found = means(&scene, &path, 3000, setting, ray)?;
        worst.push((found.mean() - 1.25).abs() / found.standard_error());
    }
    Ok(largest(worst))
}

/// A matt room with a lamp that shines up and a mirror ball over it.
fn guide_on_and_off(setting: &Setting<'_>) -> Result<f64, Trouble> {
    let lamp = Material::lambert(Rgb::BLACK).emitting(gray(5.0), Rgb::BLACK);
    let scene = Room::default()
        .with(square(3.0), at(0., 0., 0.), Material::lambert(gray(0.5)))
        .with(
            square(3.0),
            at(0., 0., 3.) * DAffine3::from_rotation_x(PI),
            Material::lambert(gray(0.7)),
        )
        .with(ball(0.5), at(0., 0., 1.6), Material::mirror(gray(0.9)))
        .with(square(0.4), at(0., 0., 0.3), lamp)
        .scene()?;
    let ray = |k: u64| {
        let u = |of: u64| 2.0 * rng::unit_f64(rng::hash(&[5, k, of])) - 1.0;
        Ray::new(DVec3::new(2.0 * u(0), 2.0 * u(1), 2.9), DVec3::Z)
    };
    let by = |guided| {
        let path = Path {
            guided,
            max_depth: Some(2),
            ..Path::default()
        };
        means(&scene, &path, 8000, setting, ray)
    };
    apart(&by(true)?, &by(false)?)
}

/// What a matt room with a lamp does not require, and what is promised to be the same to the bit: kept one by one.
fn features_kept(setting: &Setting<'_>) -> Result<f64, Trouble> {
    let scene = floor()
        .with(ball(0.5), at(0.4, 0., 0.5), Material::lambert(gray(0.6)))
        .with(square(0.2), at(-0.6, 0., 0.9), glow())
        .scene()?;
    let picture = |kept| -> Result<Vec<f64>, Trouble> {
        let path = Path {
            kept,
            ..Path::default()
        };
        let photons = PhotonMapping {
            kept,
            ..maps(5000, 5000, None)
        };
        let mut all = Vec::new();
        for method in [&path as &dyn Integrator, &photons] {
            let estimator = prepared(method, &scene, setting)?;
            let looks = (0_u64..).zip(around(DVec3::new(0.0, -1.5, 1.0), 200));
            all.extend(looks.map(|(k, ray)| seen(&*estimator, &ray, k, 4).g));
        }
        Ok(all)
    };
    let usual = picture(Features::NONE)?;
    let mut n = 0.0;
    let is_exact = |feature: &Feature| feature.promise() == Promise::SameBits;
    for feature in Feature::ALL.into_iter().filter(is_exact) {
        n += differing(&picture(Features::NONE.with(feature))?, &usual);
    }
    Ok(n)
}
