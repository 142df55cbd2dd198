//! Light on the organs of canopies: C-66 to C-69, C-71, C-72; units of area: C-21; threads: C-59; memory: C-65.

use super::super::check::{Check, Setting, Trouble};
use super::super::room::gray;
use super::looks::placed;
use super::{Row, checks_of};
use crate::color::Rgb;
use crate::geometry::Shape;
use crate::integrator::interception::{Interception, Lighting, SensorField, Wanted};
use crate::integrator::photon::Plot;
use crate::integrator::requirements::Features;
use crate::light::Light;
use crate::material::Material;
use crate::math::functions::{cos, exp, ln, sin};
use crate::math::stats::RunningStats;
use crate::math::tolerance::{AIMED_BOXES, CLOSED_FORM, EXACT_SHARES};
use crate::math::{rng, warp};
use crate::scene::Scene;
use crate::scene::description::{Group, GroupId, PlacedShape, SceneDescription};
use glam::{DAffine3, DQuat, DVec2, DVec3};
use std::f64::consts::PI;

/// Standard errors that a result may be off: with other seeds a right tracer fails one comparison in 40,000.
pub(super) const SIGMAS: f64 = 6.0;

/// Independent canopies.
const REALISATIONS: u64 = 12;

/// The checks.
pub(super) fn checks() -> Vec<Check> {
    let mut checks = checks_of(ROWS);
    checks.extend(level_leaves());
    checks.extend(spherical_leaves());
    checks
}

/// Those that no setting changes.
const ROWS: [Row; 2] = [
    (
        "68",
        "C-68-absorbed",
        "300 leaves of rho = tau = 0.5 over white soil without end: absorbed, of what comes in",
        (0.0, EXACT_SHARES),
        |setting| Ok(white_canopy(setting)?.0),
    ),
    (
        "68",
        "C-68-reflected",
        "the same: what comes back, of what comes in",
        (1.0, CLOSED_FORM),
        |setting| Ok(white_canopy(setting)?.1),
    ),
];

pub(super) fn black() -> Material {
    Material::lambert(Rgb::BLACK)
}

/// Parallel light of irradiance 1 W/m² in each channel on level ground, from this zenith angle.
pub(super) fn sun(zenith: f64, azimuth: f64) -> Light {
    let to_sun = DVec3::new(
        sin(zenith) * cos(azimuth),
        sin(zenith) * sin(azimuth),
        cos(zenith),
    );
    Light::Directional {
        direction: -to_sun,
        irradiance: Rgb::splat(1.0 / to_sun.z),
        origin: to_sun * 1e4,
    }
}

pub(super) fn world(
    materials: Vec<Material>,
    shapes: Vec<PlacedShape>,
    lights: Vec<Light>,
) -> SceneDescription {
    SceneDescription {
        materials,
        groups: vec![Group {
            shapes,
            instances: vec![],
        }],
        root: Some(GroupId(0)),
        lights,
        ..SceneDescription::default()
    }
}

/// Photons onto organs.
pub(super) fn solve(
    scene: &Scene,
    n_organs: usize,
    plot: Option<Plot>,
    photons: u64,
    setting: &Setting<'_>,
) -> Result<Lighting, Trouble> {
    let how = Interception {
        photons,
        batches: 16,
        max_depth: 10_000,
        wanted: Wanted::default(),
        most_photons: photons,
        memory: 1 << 30,
        plants: vec![],
        kept: Features::NONE,
    };
    let sensors = SensorField::default();
    Ok(how.solve(scene, n_organs, &sensors, plot, &setting.context())?)
}

/// `n` discs of radius `r` in a box over a plot of 1 m², level or in all directions.
fn canopy(n: u32, r: f64, is_level: bool, seed: u64) -> SceneDescription {
    let number = |i: u32, of: u64| rng::unit_f64(rng::hash(&[seed, u64::from(i), of]));
    let disc = |i: u32| {
        let at = DVec3::new(
            number(i, 0) - 0.5,
            number(i, 1) - 0.5,
            0.1 + number(i, 2) * 2.0,
        );
        let normal = if is_level {
            DVec3::Z
        } else {
            warp::sphere(DVec2::new(number(i, 3), number(i, 4)))
        };
        let turn = DQuat::from_rotation_arc(DVec3::Z, normal);
        let place = DAffine3::from_rotation_translation(turn, at);
        let mut disc = placed(Shape::Disk { radius: r }, place, 0);
        disc.organ.0 = 0;
        disc
    };
    world(vec![black()], (0..n).map(disc).collect(), vec![])
}

/// The canopy without end: what hangs over the sides of the plot is copied to the other side.
fn endless(drawn: SceneDescription) -> Result<(Scene, Plot), Trouble> {
    let bounds = Scene::build(drawn.clone())?.bounds();
    let plot = Plot::new(DVec2::ONE, bounds).ok_or_else(|| Trouble("no plot".into()))?;
    let drawn = drawn.beside_itself(DVec2::ONE, plot.overhang(&bounds));
    Ok((Scene::build(drawn)?, plot))
}

/// Leaves of 6 cm: how many make this much leaf area on a square metre.
const LEAF_RADIUS: f64 = 0.03;

/// What leaves intercept whose light is `exp(-x)` by Beer: exactly so many leaves, not a Poisson number of them, in standard errors
/// of independent canopies.
fn off_beer(
    (lai, is_level): (f64, bool),
    zenith: f64,
    attenuation: f64,
    setting: &Setting<'_>,
) -> Result<f64, Trouble> {
    let n = (lai / (PI * LEAF_RADIUS * LEAF_RADIUS)).round();
    let x = lai * attenuation;
    let expected = 1.0 - exp(n * ln(1.0 - x / n));
    let mut seen = RunningStats::default();
    for seed in 0..REALISATIONS {
        let seed = setting.seed.wrapping_add(seed);
        let mut drawn = canopy(n as u32, LEAF_RADIUS, is_level, seed);
        drawn.lights = vec![sun(zenith.to_radians(), 0.3)];
        let (scene, plot) = endless(drawn)?;
        let found = solve(&scene, 1, Some(plot), 2048, setting)?;
        seen.push(found.total.absorbed.sum() / found.books.emitted.sum());
    }
    if seen.standard_error() > 0.02 {
        return Err(Trouble("too noisy".into()));
    }
    Ok((seen.mean() - expected).abs() / (seen.standard_error() + AIMED_BOXES))
}

/// A check of Beer's law for leaves over a square metre, by 12 canopies.
fn beer(
    case: &'static str,
    (lai, is_level): (f64, bool),
    elevation: f64,
    attenuation: f64,
) -> Check {
    let kind = if is_level {
        "level"
    } else {
        "of all directions"
    };
    let what = format!(
        "black leaves {kind}, LAI {lai}, sun {elevation} deg up, 12 canopies: difference from Beer's law, standard errors"
    );
    let measure = move |setting: &Setting<'_>| {
        off_beer((lai, is_level), 90.0 - elevation, attenuation, setting)
    };
    let id = format!("C-{case}-lai-{lai}-sun-{elevation}");
    Check::within((id, what), 0.0, SIGMAS, measure).of_case(case)
}

fn level_leaves() -> Vec<Check> {
    let cases = [(0.5, 90.0), (0.5, 30.0), (2.0, 90.0), (2.0, 40.0)];
    cases
        .map(|(lai, elevation)| beer("66", (lai, true), elevation, 1.0))
        .into()
}

fn spherical_leaves() -> Vec<Check> {
    let cases = [(0.5, 90.0), (0.5, 54.0), (2.0, 90.0), (2.0, 30.0)];
    let check = |(lai, elevation): (f64, f64)| {
        let attenuation = 0.5 / sin(elevation.to_radians());
        beer("67", (lai, false), elevation, attenuation)
    };
    cases.map(check).into()
}

/// What is absorbed and what comes back of what comes in.
fn white_canopy(setting: &Setting<'_>) -> Result<(f64, f64), Trouble> {
    let mut drawn = canopy(300, 0.06, false, 5);
    drawn.materials = vec![
        Material::leaf(gray(0.5), gray(0.5)),
        Material::lambert(Rgb::WHITE),
    ];
    let soil = placed(Shape::Plane, DAffine3::IDENTITY, 1);
    drawn.groups[0].shapes.push(soil);
    drawn.lights = vec![sun(0.5, 0.1)];
    let (scene, plot) = endless(drawn)?;
    let found = solve(&scene, 2, Some(plot), 4096, setting)?;
    let emitted = found.books.emitted.sum();
    let part = |power: Rgb| power.sum() / emitted;
    Ok((part(found.books.absorbed).abs(), part(found.books.escaped)))
}
