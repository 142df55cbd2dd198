//! Cameras and lamps where none should be, and scenes with nothing in them, by every method: C-48, C-52 to C-54, C-62.

use super::super::check::{Check, Setting, Trouble};
use super::super::room::{Room, at, even_sky, glow, gray, square};
use super::looks::{around, largest, methods, prepared, seen};
use super::{Row, checks_of};
use crate::color::Rgb;
use crate::geometry::{Shape, TriangleMesh};
use crate::integrator::{Path, RayCounts};
use crate::light::Light;
use crate::material::Material;
use crate::math::functions::exp;
use crate::math::tolerance::{ANY_STRENGTH, CLOSED_FORM};
use crate::math::{Ray, rng};
use crate::sampler::{Sampler, SamplerKind};
use crate::scene::{Scene, SceneError};
use glam::{DAffine3, DVec3};
use std::f64::consts::FRAC_1_PI;
use std::sync::Arc;

/// The checks.
pub(super) fn checks() -> Vec<Check> {
    checks_of(ROWS)
}

/// Those that no setting changes.
const ROWS: [Row; 9] = [
    (
        "48",
        "C-48-same",
        "40 rays past a ball of index 1 over a lit floor: largest relative difference from what is seen without it",
        (0.0, CLOSED_FORM),
        equal_index,
    ),
    (
        "52",
        "C-52-nowhere",
        "a floor that a lamp without extent lies in, at it and up to 10^-300 m beside it, by every method: samples that are no numbers",
        (0.0, 0.0),
        lamp_in_the_floor,
    ),
    (
        "53",
        "C-53-closed",
        "40 looks from inside a closed matt ball under a lamp and a sky, by every method: those that are not black",
        (0.0, 0.0),
        |setting| from_inside(Material::lambert(gray(0.8)), 0.0, setting),
    ),
    (
        "53",
        "C-53-lamp",
        "the same from inside a lamp that shines with 5 behind: those that are not 5",
        (0.0, 0.0),
        |setting| {
            let lamp = Material::lambert(Rgb::BLACK).emitting(gray(3.0), gray(5.0));
            from_inside(lamp, 5.0, setting)
        },
    ),
    (
        "53",
        "C-53-glass",
        "from the middle of glass that absorbs 0.7/m, under a sky, by every method: mean over n²(1-R)e^-σ/(1-R e^-2σ), farthest from 1",
        (1.0, 0.02),
        from_inside_glass,
    ),
    (
        "53",
        "C-53-terminator",
        "2000 looks at an octahedron smoothed to a ball under a lamp, by path tracing, ray tracing and photons: negative, no numbers, too bright, or lit though turned away",
        (0.0, 0.0),
        terminator,
    ),
    (
        "54",
        "C-54-pictures",
        "nothing; a sky; only lamps; only surfaces; lamps and skies without light; 40 looks by every method: those that are not black or the sky",
        (0.0, 0.0),
        |setting| Ok(empty_scenes(setting)?.0),
    ),
    (
        "54",
        "C-54-queries",
        "those of them without surfaces: most queries of a look",
        (1.0, 1.0),
        |setting| Ok(empty_scenes(setting)?.1),
    ),
    (
        "62",
        "C-62-strength",
        "light 2^100 times stronger and weaker, by every method: largest relative difference of a picture, scaled back",
        (0.0, ANY_STRENGTH),
        any_strength,
    ),
];

pub(super) fn ball(radius: f64) -> Shape {
    Shape::Sphere { radius }
}

pub(super) fn floor() -> Room {
    Room::default().with(square(5.0), at(0., 0., 0.), Material::lambert(gray(0.5)))
}

fn equal_index(setting: &Setting<'_>) -> Result<f64, Trouble> {
    let lit = |room: Room| {
        let lamp = Light::point(DVec3::Z * 2.0, gray(9.0));
        room.lit_by(lamp).under(even_sky(1.0)).scene()
    };
    let clear = Material::glass(1.0, 0.0, Rgb::BLACK);
    let (open, with) = (
        lit(floor())?,
        lit(floor().with(ball(0.5), at(0., 0., 0.9), clear))?,
    );
    let look = |scene: &Scene| -> Result<Vec<f64>, Trouble> {
        let estimator = prepared(&Path::default(), scene, setting)?;
        let down = DVec3::new(0.0, 1.0, -0.4).normalize();
        let from = |i: u64| DVec3::new(4.0 * rng::unit_f64(rng::hash(&[7, i])) - 2.0, -3.0, 1.5);
        let seen = (0..40).map(|i| seen(&*estimator, &Ray::new(from(i), down), i, 16).g);
        Ok(seen.collect())
    };
    let (without, with) = (look(&open)?, look(&with)?);
    let pairs = without.iter().zip(with);
    Ok(largest(pairs.map(|(a, b)| (b / a - 1.0).abs())))
}

fn lamp_in_the_floor(setting: &Setting<'_>) -> Result<f64, Trouble> {
    let mut wrong = 0;
    for exponent in [0, 4, 8, 15, 30, 150, 300] {
        // At the very place, and ever nearer to it.
        let height = if exponent == 0 {
            0.0
        } else {
            10.0_f64.powi(-exponent)
        };
        let lamps = [
            Light::point(DVec3::Z * height, gray(10.0)),
            Light::point(DVec3::new(0.3, 0.0, height), gray(10.0)),
        ];
        let scene = lamps.into_iter().fold(floor(), Room::lit_by).scene()?;
        for (_, method) in methods() {
            let estimator = prepared(&*method, &scene, setting)?;
            for x in [0.0, 0.3, 0.3 + height, 0.5] {
                let ray = Ray::new(DVec3::new(x, 0.0, 1.0), DVec3::NEG_Z);
                let light = seen(&*estimator, &ray, 1, 4);
                wrong += u32::from(!light.is_finite() || light.g < 0.0);
            }
        }
    }
    Ok(f64::from(wrong))
}

fn from_inside(material: Material, expected: f64, setting: &Setting<'_>) -> Result<f64, Trouble> {
    let scene = Room::default()
        .with(ball(1.0), at(0., 0., 0.), material)
        .with(square(5.0), at(0., 0., -1.5), Material::lambert(gray(0.5)))
        .lit_by(Light::point(DVec3::Z * 4.0, gray(100.0)))
        .under(even_sky(1.0))
        .scene()?;
    let mut looks = around(DVec3::ZERO, 20);
    looks.extend(around(DVec3::new(0.3, -0.2, 0.899), 20));
    let mut wrong = 0;
    for (_, method) in methods() {
        let estimator = prepared(&*method, &scene, setting)?;
        let is_wrong = |ray: &&Ray| seen(&*estimator, ray, 3, 4) != gray(expected);
        wrong += looks.iter().filter(is_wrong).count();
    }
    Ok(wrong as f64)
}

/// Radiance is n² times what comes in, less what the glass keeps.
fn from_inside_glass(setting: &Setting<'_>) -> Result<f64, Trouble> {
    let (n, sigma) = (1.5_f64, 0.7);
    let scene = Room::default()
        .with(
            ball(1.0),
            at(0., 0., 0.),
            Material::glass(n, 0.0, gray(sigma)),
        )
        .under(even_sky(1.0))
        .scene()?;
    let (once, r) = (exp(-sigma), ((n - 1.0) / (n + 1.0)).powi(2));
    let expected = n * n * (1.0 - r) * once / (1.0 - r * once * once);
    let looks = around(DVec3::ZERO, 400);
    let mut worst = 0.0_f64;
    for (_, method) in methods() {
        let estimator = prepared(&*method, &scene, setting)?;
        // 1600 paths, of which one in 25 is mirrored: standard error 0.4 %.
        let sum: f64 = (0_u64..)
            .zip(&looks)
            .map(|(k, ray)| seen(&*estimator, ray, k, 4).g)
            .sum();
        worst = largest([worst, (sum / looks.len() as f64 / expected - 1.0).abs()]);
    }
    Ok(1.0 + worst)
}

/// An octahedron that pretends to be a ball.
fn smooth_octahedron() -> Shape {
    let axes = DVec3::AXES;
    let positions: Vec<DVec3> = axes.into_iter().chain(axes.map(|axis| -axis)).collect();
    let triangles = (0..8_u32).map(|k| {
        let corner = |axis: u32| axis + 3 * (k >> axis & 1);
        let [a, b, c] = [corner(0), corner(1), corner(2)];
        if k.count_ones().is_multiple_of(2) {
            [a, b, c]
        } else {
            [a, c, b]
        }
    });
    Shape::Mesh(Arc::new(TriangleMesh {
        triangles: triangles.collect(),
        normals: positions.clone(),
        positions,
        uvs: vec![],
    }))
}

fn terminator(setting: &Setting<'_>) -> Result<f64, Trouble> {
    let (position, power, rho) = (DVec3::new(3.0, 0.4, 0.3), 100.0, 0.8);
    let scene = Room::default()
        .with(
            smooth_octahedron(),
            DAffine3::IDENTITY,
            Material::lambert(gray(rho)),
        )
        .lit_by(Light::point(position, gray(power)))
        .scene()?;
    let mut wrong = 0;
    for (name, method) in methods() {
        // Radiosity lights true surfaces.
        if name == "radiosity" {
            continue;
        }
        let estimator = prepared(&*method, &scene, setting)?;
        let (mut lit, mut dark) = (0, 0);
        for (k, ray) in (0_u64..).zip(around(DVec3::ZERO, 2000)) {
            let ray = Ray::new(ray.direction * 3.0, -ray.direction);
            let Some(hit) = scene.closest(&ray) else {
                wrong += 1;
                continue;
            };
            let point = scene.surface(&ray, &hit);
            let light = seen(&*estimator, &ray, k, 4);
            let to_lamp = position - point.position;
            let bound = rho * FRAC_1_PI * power * FRAC_1_PI / (4.0 * to_lamp.length_squared());
            let is_away = point.normal_g.dot(to_lamp) <= 0.0;
            let most = if is_away {
                0.0
            } else {
                bound * (1.0 + CLOSED_FORM)
            };
            wrong += u32::from(!light.is_finite() || !(0.0..=most).contains(&light.g));
            dark += u32::from(is_away);
            lit += u32::from(light.g > 0.0);
        }
        if lit < 400 || dark < 400 {
            return Err(Trouble(format!("{name}: {lit} lit, {dark} turned away")));
        }
    }
    Ok(f64::from(wrong))
}

/// Scenes with nothing in them, or nothing that shines, and what is seen in all directions.
fn emptinesses() -> Result<[(Scene, f64); 8], SceneError> {
    let lamps = || {
        Room::default()
            .lit_by(Light::point(DVec3::Z, gray(100.0)))
            .lit_by(Light::point(DVec3::X, Rgb::BLACK))
    };
    let ground =
        || Room::default().with(square(9.0), at(0., 0., -1.), Material::lambert(gray(0.5)));
    let glass = Material::glass(1.5, 0.0, Rgb::BLACK);
    let dark_lamp = Light::point(DVec3::Z, Rgb::BLACK);
    let nothing = Shape::Sphere { radius: 0.0 };
    Ok([
        (Room::default().scene()?, 0.0),
        (Room::default().under(even_sky(0.75)).scene()?, 0.75),
        (lamps().scene()?, 0.0),
        (lamps().under(even_sky(0.75)).scene()?, 0.75),
        (
            ground().with(ball(0.5), at(0., 0., 1.), glass).scene()?,
            0.0,
        ),
        (ground().lit_by(dark_lamp).scene()?, 0.0),
        (ground().under(even_sky(0.0)).scene()?, 0.0),
        (
            Room::default()
                .with(nothing, at(0., 0., 0.), glow())
                .scene()?,
            0.0,
        ),
    ])
}

/// How many looks see something else, and the most queries of one where there are no surfaces.
fn empty_scenes(setting: &Setting<'_>) -> Result<(f64, f64), Trouble> {
    let (mut wrong, mut most) = (0, 0);
    for (scene, expected) in emptinesses()? {
        for (_, method) in methods() {
            let estimator = prepared(&*method, &scene, setting)?;
            for (k, ray) in (0_u64..).zip(around(DVec3::ZERO, 40)) {
                let mut sampler = Sampler::new(SamplerKind::OwenSobol, k, 0);
                let mut count = RayCounts::default();
                let light = estimator.incident_radiance(&ray, &mut sampler, &mut count);
                wrong += u32::from(light != gray(expected));
                if scene.bounds().is_empty() {
                    most = most.max(count.total());
                }
            }
        }
    }
    Ok((f64::from(wrong), most as f64))
}

fn any_strength(setting: &Setting<'_>) -> Result<f64, Trouble> {
    let scene = |power: f64| {
        let lamp = Material::lambert(Rgb::BLACK).emitting(gray(power), gray(2.0 * power));
        floor()
            .with(
                ball(0.5),
                at(0.6, 0., 0.5),
                Material::leaf(gray(0.4), gray(0.3)),
            )
            .with(square(0.4), at(-0.8, 0., 1.5), lamp)
            .lit_by(Light::point(DVec3::Z * 2.0, gray(30.0 * power)))
            .under(even_sky(0.1 * power))
            .scene()
    };
    let looks = around(DVec3::new(0.0, -1.5, 1.0), 60);
    let mut all = Vec::new();
    for (name, method) in methods() {
        let look = |power: f64| -> Result<Vec<f64>, Trouble> {
            let scene = scene(power)?;
            let estimator = prepared(&*method, &scene, setting)?;
            let seen = (0_u64..)
                .zip(&looks)
                .map(|(k, ray)| seen(&*estimator, ray, k, 4).g / power);
            Ok(seen.collect())
        };
        let usual = look(1.0)?;
        if usual.iter().filter(|light| **light > 0.0).count() <= 30 {
            return Err(Trouble(format!("{name} sees almost nothing")));
        }
        for exponent in [-100, 100] {
            let other = look(2.0_f64.powi(exponent))?;
            let off = usual.iter().zip(other).map(|(a, b)| match *a {
                0.0 => b.abs(),
                a => (b / a - 1.0).abs(),
            });
            all.extend(off);
        }
    }
    Ok(largest(all))
}
