//! Photons one by one, and the books of their power: C-37, C-40, C-43 to C-45.

use super::super::check::{Check, Setting, Trouble};
use super::super::room::{Room, at, gray, square};
use super::looks::largest;
use super::{Row, checks_of};
use crate::color::Rgb;
use crate::geometry::Shape;
use crate::integrator::photon::{
    Aim, Emission, Ledger, Onward, PhotonHit, Photons, Visitor, trace,
};
use crate::light::{Environment, Light, Sky};
use crate::material::Material;
use crate::math::angle::Angle;
use crate::math::stats::RunningStats;
use crate::math::tolerance::CLOSED_FORM;
use crate::scene::description::MaterialId;
use crate::scene::{Scene, SceneError};
use glam::{DAffine3, DQuat, DVec3};
use std::f64::consts::PI;

/// Power of photons that are lost to chance and to the end of paths, as a part of all: what tens of thousands of them leave of it.
const CHANCE: f64 = 0.02;

/// The checks.
pub(super) fn checks() -> Vec<Check> {
    let mut checks = checks_of(ROWS);
    let weak = (
        "C-45-weak",
        "a lamp of 1 W in the room beside it: difference, standard errors and a millionth of a per cent",
    );
    checks.push(Check::within(weak, 0.0, 6.0, |setting| rooms_apart(setting, 1)).of_case("45"));
    let blind = (
        "C-45-noise",
        "standard error of the weak lamp's light, as a part of it",
    );
    checks.push(Check::within(blind, 0.0, 0.02, noise_of_the_weak).of_case("45"));
    checks
}

/// Those that no setting changes.
const ROWS: [Row; 10] = [
    (
        "37",
        "C-37-none",
        "no photon, no light, no surfaces, nothing at all: arrivals and photons on the books",
        (0.0, 0.0),
        nothing_arrives,
    ),
    (
        "37",
        "C-37-one",
        "one photon of a lamp of 6 W in a black ball: power that it brings",
        (6.0, 6.0 * CLOSED_FORM),
        one_photon,
    ),
    (
        "40",
        "C-40-mean",
        "direct light of small mirrors and glass by 24 runs of aimed photons and of others: difference, standard errors",
        (0.0, 5.0),
        aimed_difference,
    ),
    (
        "40",
        "C-40-noise",
        "standard error by 6000 aimed photons over that by 60,000 others",
        (0.25, 0.25),
        aimed_noise,
    ),
    (
        "43",
        "C-43-quanta",
        "20,000 photons in a room of all materials, depth 0, 1, 5 and 64: emitted less absorbed, escaped, lost and chance, quanta",
        (0.0, 0.0),
        imbalance,
    ),
    (
        "43",
        "C-43-closed",
        "the same: power that leaves the closed room, quanta",
        (0.0, 0.0),
        escaped,
    ),
    (
        "43",
        "C-43-power",
        "what it emits over what its lamps have",
        (1.0, CLOSED_FORM),
        emitted_over_power,
    ),
    (
        "44",
        "C-44-outside",
        "100,000 photons in a closed box and in a closed ball: power outside, W",
        (0.0, 0.0),
        outside_of_boxes,
    ),
    (
        "44",
        "C-44-inside",
        "the same: what stays inside over what the lamp has, the one farther from 1",
        (1.0, CHANCE),
        inside_of_boxes,
    ),
    (
        "45",
        "C-45-strong",
        "a lamp of 1e12 W in its room, 24 runs of 4000 photons: difference, standard errors and a millionth of a per cent",
        (0.0, 6.0),
        |setting| rooms_apart(setting, 0),
    ),
];

/// What arrived: material (each shape of a [`Room`] has its own), front, power.
#[derive(Clone, Debug, Default)]
struct Arrivals(Vec<(u32, bool, Rgb)>);

impl Visitor for Arrivals {
    fn arrives(&mut self, hit: &PhotonHit<'_>) -> Onward {
        let MaterialId(shape) = hit.point.material;
        self.0.push((shape, hit.point.is_front, hit.power));
        Onward::Go
    }
}

impl Arrivals {
    /// Green power on the wanted shapes and sides.
    fn power(&self, wanted: impl Fn(u32, bool) -> bool) -> f64 {
        let found = self
            .0
            .iter()
            .filter(|(shape, front, _)| wanted(*shape, *front));
        found.map(|(.., power)| power.g).sum()
    }
}

/// Follows photons with a seed of their own.
fn follow(
    scene: &Scene,
    aim: Aim,
    (n, seed, max_depth): (u64, u64, u32),
    setting: &Setting<'_>,
) -> Result<(Arrivals, Ledger), Trouble> {
    let emission = Emission::new(scene, aim);
    let photons = Photons::all(n, setting.seed.wrapping_add(seed), max_depth);
    let mut all = Arrivals::default();
    let join = |block: Arrivals| all.0.extend(block.0);
    let ledger = trace(
        &emission,
        &photons,
        &setting.context(),
        Arrivals::default,
        join,
    )?;
    Ok((all, ledger))
}

fn black() -> Material {
    Material::lambert(Rgb::BLACK)
}

fn nothing_arrives(setting: &Setting<'_>) -> Result<f64, Trouble> {
    let dark = Room::default().with(square(1.0), at(0., 0., 0.), black());
    let lamp = Room::default().lit_by(Light::point(DVec3::ZERO, gray(6.0)));
    let mut n = 0.0;
    for (scene, photons) in [
        (full_room()?, 0),
        (dark.scene()?, 1000),
        (Room::default().scene()?, 1000),
        (lamp.scene()?, 0),
    ] {
        let (seen, books) = follow(&scene, Aim::Everything, (photons, 1, 64), setting)?;
        n += (seen.0.len() as u64 + books.n_photons) as f64;
    }
    Ok(n)
}

fn one_photon(setting: &Setting<'_>) -> Result<f64, Trouble> {
    let scene = Room::default()
        .with(Shape::Sphere { radius: 2.0 }, at(0., 0., 0.), black())
        .lit_by(Light::point(DVec3::ZERO, gray(6.0)))
        .scene()?;
    let (seen, books) = follow(&scene, Aim::Everything, (1, 1, 64), setting)?;
    if books.absorbed != books.emitted {
        return Err(Trouble("what was emitted was not absorbed".into()));
    }
    Ok(seen.power(|_, _| true))
}

/// A small mirror ball and a glass one in a large room, under lamps of every kind.
fn small_mirrors() -> Result<Scene, SceneError> {
    let room = Room::default()
        .with(square(6.0), at(0.0, 0.0, -3.0), black())
        .with(
            Shape::Sphere { radius: 0.3 },
            at(1.0, 0.0, 0.0),
            Material::mirror(Rgb::WHITE),
        )
        .with(
            Shape::Sphere { radius: 0.2 },
            at(-1.0, 0.5, 1.0),
            Material::glass(1.5, 0.0, Rgb::BLACK),
        )
        .with(
            square(0.4),
            at(3.0, 0.0, 3.0),
            black().emitting(gray(3.0), gray(3.0)),
        );
    let (inner, outer) = (Angle::deg(10.0), Angle::deg(60.0));
    room.lit_by(Light::point(DVec3::new(0.0, 3.0, 2.0), gray(100.0)))
        .lit_by(Light::spot(
            DVec3::Z * 4.0,
            DVec3::NEG_Z,
            inner,
            outer,
            gray(50.0),
        ))
        .lit_by(Light::Directional {
            direction: DVec3::NEG_Z,
            irradiance: gray(1.0),
            origin: DVec3::Z * 9.0,
        })
        .under(Environment {
            sky: Sky::Uniform(gray(0.1)),
            sun: None,
        })
        .scene()
}

/// Direct light of what is specular, by 24 runs.
fn on_specular(aim: Aim, n: u64, setting: &Setting<'_>) -> Result<RunningStats, Trouble> {
    let scene = small_mirrors()?;
    let mut all = RunningStats::default();
    for seed in 0..24 {
        let (seen, _) = follow(&scene, aim, (n, seed, 0), setting)?;
        all.push(seen.power(|shape, _| shape == 1 || shape == 2));
    }
    Ok(all)
}

fn aimed_difference(setting: &Setting<'_>) -> Result<f64, Trouble> {
    let all = on_specular(Aim::Everything, 60_000, setting)?;
    let aimed = on_specular(Aim::Specular, 6000, setting)?;
    let error = all.standard_error().hypot(aimed.standard_error());
    if 5.0 * error > 0.1 * all.mean() {
        return Err(Trouble("too noisy to see a tenth".into()));
    }
    Ok((all.mean() - aimed.mean()).abs() / error)
}

fn aimed_noise(setting: &Setting<'_>) -> Result<f64, Trouble> {
    let all = on_specular(Aim::Everything, 60_000, setting)?;
    let aimed = on_specular(Aim::Specular, 6000, setting)?;
    Ok(aimed.standard_error() / all.standard_error())
}

/// A room with every kind of surface: matt, leaf, mirror, glass that absorbs, pane, alpha.
fn full_room() -> Result<Scene, SceneError> {
    let colour = Rgb::new(0.7, 0.4, 0.2);
    let glass = Material::glass(1.5, 0.0, Rgb::new(0.1, 0.3, 0.9));
    let ball = |radius| Shape::Sphere { radius };
    let leaf = Material::leaf(colour * 0.6, colour * 0.4);
    let pane = Material::pane(1.5, Rgb::new(0.9, 0.8, 0.7));
    let lamp = black().emitting(gray(1.0), gray(2.0));
    Room::default()
        .with(ball(5.0), DAffine3::IDENTITY, Material::lambert(colour))
        .with(square(0.8), at(0.0, 0.0, -1.0), leaf)
        .with(ball(0.5), at(1.0, 0.0, 0.0), glass)
        .with(ball(0.5), at(-1.0, 0.0, 0.0), Material::mirror(colour))
        .with(square(0.6), at(0.0, 2.0, 0.0), pane)
        .with(
            square(0.6),
            at(0.0, -2.0, 0.0),
            Material::lambert(colour).with_alpha(0.5),
        )
        .with(square(0.2), at(0.0, 0.0, 3.0), lamp)
        .lit_by(Light::point(
            DVec3::new(0.0, 0.3, 2.0),
            Rgb::new(10.0, 5.0, 1.0),
        ))
        .scene()
}

/// The sum of what `of` finds in the books of the room, over several depths.
fn of_books(setting: &Setting<'_>, of: impl Fn(&Ledger) -> [i128; 3]) -> Result<f64, Trouble> {
    let scene = full_room()?;
    let mut sum = 0;
    for max_depth in [0, 1, 5, 64] {
        let (_, books) = follow(&scene, Aim::Everything, (20_000, 7, max_depth), setting)?;
        sum += of(&books)
            .iter()
            .map(|quanta| quanta.unsigned_abs())
            .sum::<u128>();
    }
    Ok(sum as f64)
}

fn imbalance(setting: &Setting<'_>) -> Result<f64, Trouble> {
    of_books(setting, Ledger::imbalance)
}

fn escaped(setting: &Setting<'_>) -> Result<f64, Trouble> {
    of_books(setting, |books| books.escaped.quanta())
}

fn emitted_over_power(_: &Setting<'_>) -> Result<f64, Trouble> {
    let power = Emission::new(&full_room()?, Aim::Everything).power();
    Ok(power.r / (10.0 + 3.0 * PI * 0.16))
}

/// A lamp of 6 W in a closed white shape, in a larger black ball.
fn boxed() -> Result<[Scene; 2], SceneError> {
    let turned = DAffine3::from_quat(DQuat::from_euler(glam::EulerRot::XYZ, 0.4, 1.1, 2.0));
    let cube = Shape::Box {
        half_x: 1.0,
        half_y: 1.0,
        length: 1.0,
    };
    let around = |shape| {
        Room::default()
            .with(shape, turned, Material::lambert(gray(0.8)))
            .with(Shape::Sphere { radius: 9.0 }, at(0., 0., 0.), black())
            .lit_by(Light::point(DVec3::new(0.1, 0.2, 0.3), gray(6.0)))
            .scene()
    };
    Ok([around(cube)?, around(Shape::Sphere { radius: 1.0 })?])
}

fn outside_of_boxes(setting: &Setting<'_>) -> Result<f64, Trouble> {
    let mut outside = 0.0;
    for scene in boxed()? {
        let (seen, books) = follow(&scene, Aim::Everything, (100_000, 1, 64), setting)?;
        outside += seen.power(|shape, _| shape == 1) + books.watts(&books.escaped).sum().abs();
    }
    Ok(outside)
}

fn inside_of_boxes(setting: &Setting<'_>) -> Result<f64, Trouble> {
    let mut all = Vec::new();
    for scene in boxed()? {
        let (_, books) = follow(&scene, Aim::Everything, (100_000, 1, 64), setting)?;
        let kept = books.watts(&books.absorbed).g + books.watts(&books.lost).g;
        all.push((kept / 6.0 - 1.0).abs());
    }
    Ok(1.0 + largest(all))
}

/// Light in each of two rooms apart, by 24 runs, whose lamps have 10¹² W and 1 W.
fn in_rooms_apart(setting: &Setting<'_>, room: u32) -> Result<RunningStats, Trouble> {
    let ball = || Shape::Sphere { radius: 1.0 };
    let scene = Room::default()
        .with(ball(), at(0.0, 0.0, 0.0), black())
        .with(ball(), at(10.0, 0.0, 0.0), black())
        .lit_by(Light::point(DVec3::ZERO, gray(1e12)))
        .lit_by(Light::point(DVec3::X * 10.0, gray(1.0)))
        .scene()?;
    let mut all = RunningStats::default();
    for seed in 0..24 {
        let (seen, _) = follow(&scene, Aim::Everything, (4000, seed, 64), setting)?;
        all.push(seen.power(|shape, front| shape == room && !front));
    }
    Ok(all)
}

fn rooms_apart(setting: &Setting<'_>, room: u32) -> Result<f64, Trouble> {
    let truth = if room == 0 { 1e12 } else { 1.0 };
    let seen = in_rooms_apart(setting, room)?;
    Ok((seen.mean() - truth).abs() / (seen.standard_error() + CLOSED_FORM * truth))
}

fn noise_of_the_weak(setting: &Setting<'_>) -> Result<f64, Trouble> {
    Ok(in_rooms_apart(setting, 1)?.standard_error())
}
