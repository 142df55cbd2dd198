//! Glass, panes and mirrors in the path tracer against what is known on paper.
//!
//! Means are judged as `support/statistics.rs` says: false-alarm probability 1e-6 per test, never blind, and every
//! comparison is made twice more with a planted fault of 2 %, which must be seen.

#![allow(clippy::unwrap_used, reason = "a test may panic")]

#[path = "support/statistics.rs"]
mod statistics;
#[path = "support/room.rs"]
#[allow(dead_code, reason = "shared with tests that need more of it")]
mod room;

use glam::DVec3;
use room::{Room, at, gray, square};
use statistics::{assert_mean, assert_same};
use std::f64::consts::PI;
use understory::color::Rgb;
use understory::geometry::Shape;
use understory::integrator::path::Strategies;
use understory::integrator::{CancelToken, Integrator, Path, RayCounts, RenderContext};
use understory::light::{Environment, Light, Sky};
use understory::material::Material;
use understory::material::fresnel::sheet;
use understory::math::stats::RunningStats;
use understory::math::{Ray, rng};
use understory::sampler::{Sampler, SamplerKind};
use understory::scene::Scene;

fn even_sky() -> Environment {
    Environment {
        sky: Sky::Uniform(gray(1.0)),
        sun: None,
    }
}

fn ball(radius: f64) -> Shape {
    Shape::Sphere { radius }
}

fn clear(ior: f64) -> Material {
    Material::glass(ior, 0.0, Rgb::BLACK)
}

/// At least `n` independent observations of the radiance that arrives along `ray(i)`, each the mean of 4 samples; if it is more
/// than a look, until the mean is known to 0.15 %.
fn observe(scene: &Scene, path: &Path, n: u64, ray: impl Fn(u64) -> Ray) -> RunningStats {
    observe_to(scene, path, n, 0.0015, ray)
}

/// The same, until the mean is known to this part of itself.
fn observe_to(
    scene: &Scene,
    path: &Path,
    n: u64,
    precision: f64,
    ray: impl Fn(u64) -> Ray,
) -> RunningStats {
    let cancel = CancelToken::default();
    let context = RenderContext {
        seed: 0,
        cancel: &cancel,
        progress: &|_| {},
    };
    let estimator = path.prepare(scene, &context).unwrap();
    let observation = |i| {
        let samples = (0..4).map(|index| {
            let stream = rng::hash(&[0x61A55, i]);
            let mut sampler = Sampler::new(SamplerKind::OwenSobol, stream, index);
            let mut rays = RayCounts::default();
            estimator.incident_radiance(&ray(i), &mut sampler, &mut rays)
        });
        samples.map(|radiance| radiance.g).sum::<f64>() / 4.0
    };
    let mut seen: RunningStats = (0..n).map(observation).collect();
    while n > 100 && seen.standard_error() > precision * seen.mean() && seen.n() < 60_000 {
        seen.push(observation(seen.n()));
    }
    seen
}

fn look(scene: &Scene, n: u64, ray: Ray) -> RunningStats {
    observe(scene, &Path::default(), n, |_| ray)
}

/// Rays that meet a ball of radius 1 at the origin everywhere.
fn towards_ball(i: u64) -> Ray {
    let x = 2.0 * rng::unit_f64(rng::hash(&[3, i])) - 1.0;
    let y = 0.2 * rng::unit_f64(rng::hash(&[4, i]));
    Ray::new(DVec3::new(0.99 * x, y * 0.3, 5.0), DVec3::NEG_Z)
}

#[test]
fn what_absorbs_nothing_vanishes_in_an_even_sky() {
    let glass_in_glass = Room::default()
        .with(ball(1.0), at(0., 0., 0.), clear(1.5))
        .with(ball(0.5), at(0., 0., 0.), clear(1.0 / 1.5));
    let mixture = Material::mixed(
        &Material::mirror(Rgb::WHITE),
        &Material::leaf(gray(0.4), gray(0.6)),
        0.3,
    );
    let single = |material| Room::default().with(ball(1.0), at(0., 0., 0.), material);
    let rooms = [
        ("glass", single(clear(1.5))),
        ("bubble", single(clear(1.0 / 1.5))),
        ("bubble in glass", glass_in_glass),
        ("mirror", single(Material::mirror(Rgb::WHITE))),
        ("mixture", single(mixture)),
        ("panes", single(Material::pane(1.5, Rgb::WHITE))),
    ];
    for (name, room) in rooms {
        let scene = room.under(even_sky()).build();
        let seen = observe(&scene, &Path::default(), 1500, towards_ball);
        assert_mean(name, &seen, 1.0, 6);
    }
}

/// A ray through the middle: R is reflected; of what enters, e^(-2σr) is left per crossing, and 1 - R of that leaves.
#[test]
fn coloured_ball_in_an_even_sky() {
    let (sigma, radius) = (0.7, 1.0);
    let left = (-2.0_f64 * sigma * radius).exp();
    let straight = Ray::new(DVec3::new(0.0, 0.0, 5.0), DVec3::NEG_Z);
    for ior in [1.0, 1.5, 1.0 / 1.5] {
        let glass = Material::glass(ior, 0.0, gray(sigma));
        let scene = Room::default()
            .with(ball(radius), at(0., 0., 0.), glass)
            .under(even_sky())
            .build();
        let r = ((ior - 1.0_f64) / (ior + 1.0)).powi(2);
        let expected = r + (1.0 - r) * (1.0 - r) * left / (1.0 - r * left);
        let seen = look(&scene, 2000, straight);
        assert_mean(&format!("index {ior}"), &seen, expected, 6);

        // From the middle of the ball: half a crossing first, and radiance is n² as dense inside.
        let inside = look(&scene, 2000, Ray::new(DVec3::ZERO, DVec3::X));
        let expected = ior * ior * (1.0 - r) * left.sqrt() / (1.0 - r * left);
        assert_mean(&format!("inside index {ior}"), &inside, expected, 6);
    }
}

/// Beer's law along a chord, exactly, and through bodies within bodies.
#[test]
fn absorption_follows_the_path() {
    let body = |sigma| Material::glass(1.0, 0.0, gray(sigma));
    let scene = Room::default()
        .with(ball(2.0), at(0., 0., 0.), body(0.3))
        .with(ball(1.0), at(0., 0., 0.), body(1.1))
        .under(even_sky())
        .build();
    let seen =
        |x: f64, z: f64| look(&scene, 1, Ray::new(DVec3::new(x, 0.0, z), DVec3::NEG_Z)).mean();
    let error = |seen: f64, depth: f64| (seen / (-depth).exp() - 1.0).abs();
    let chord = |r: f64, x: f64| (r * r - x * x).sqrt();
    assert!(error(seen(1.5, 9.0), 0.3 * 2.0 * chord(2.0, 1.5)) < 1e-9);
    let (outer, inner) = (chord(2.0, 0.6), chord(1.0, 0.6));
    assert!(
        error(
            seen(0.6, 9.0),
            0.3 * 2.0 * (outer - inner) + 1.1 * 2.0 * inner
        ) < 1e-9
    );
    // The camera inside both, and between them.
    assert!(error(seen(0.0, 0.25), 1.1 * 1.25 + 0.3) < 1e-9);
    assert!(error(seen(0.0, 1.5), 0.3 * 0.5 + 2.2 + 0.3) < 1e-9);
    assert!(error(seen(0.0, -1.5), 0.3 * 0.5) < 1e-9);
}

#[test]
fn equal_index_is_no_object() {
    let rays = |i: u64| {
        let x = 4.0 * rng::unit_f64(rng::hash(&[7, i])) - 2.0;
        Ray::new(
            DVec3::new(x, -3.0, 1.5),
            DVec3::new(0.0, 1.0, -0.4).normalize(),
        )
    };
    let floor = || Room::default().with(Shape::Plane, at(0., 0., 0.), Material::default());
    let lit = |room: Room| room.lit_by(Light::point(DVec3::new(0.0, 0.0, 2.0), gray(9.0)));
    let open = lit(floor()).under(even_sky()).build();
    let with = lit(floor().with(ball(0.5), at(0.0, 0.0, 0.9), clear(1.0)))
        .under(even_sky())
        .build();
    for i in 0..40 {
        let [a, b] = [&open, &with].map(|scene| look(scene, 1, rays(i)).mean());
        assert_eq!(a.to_bits(), b.to_bits(), "ray {i}: {a} {b}");
    }
}

/// A lamp above a pane above matt ground: the shadow ray passes, straight, with the sheet's share.
#[test]
fn lamps_shine_through_panes() {
    let tint = Rgb::new(0.9, 0.6, 0.2);
    let scene = Room::default()
        .with(Shape::Plane, at(0., 0., 0.), Material::lambert(gray(0.5)))
        .with(square(5.0), at(0., 0., 1.0), Material::pane(1.5, tint))
        .lit_by(Light::point(DVec3::new(0.0, 0.0, 2.0), gray(8.0)))
        .build();
    let depth_one = Path {
        max_depth: Some(1),
        ..Path::default()
    };
    for x in [0.0, 1.0, 3.0] {
        // Seen from below the pane, so that only the lamp's light passes it.
        let to = DVec3::new(x, 0.0, 0.0);
        let from = DVec3::new(x, 0.3, 0.5);
        let seen = observe(&scene, &depth_one, 2, |_| {
            Ray::new(from, (to - from).normalize())
        });
        let distance = (x * x + 4.0_f64).sqrt();
        let cos = 2.0 / distance;
        let passed = sheet(cos, 1.5, tint).1.g;
        let intensity = 8.0 / (4.0 * PI);
        let expected = 0.5 / PI * intensity * cos / (distance * distance) * passed;
        assert!(
            (seen.mean() / expected - 1.0).abs() < 1e-9,
            "{x}: {} {expected}",
            seen.mean()
        );
    }
}

/// A glowing wall behind a pane, and its mirror image in it.
#[test]
fn panes_show_what_is_behind_and_before_them() {
    let glow = |value| Material::lambert(Rgb::BLACK).emitting(gray(value), gray(value));
    let scene = Room::default()
        .with(square(50.0), at(0., 0., -3.0), glow(2.0))
        .with(
            square(50.0),
            at(0., 0., 0.0),
            Material::pane(1.5, Rgb::WHITE),
        )
        .with(square(50.0), at(0., 0., 3.0), glow(5.0))
        .build();
    for degrees in [0.0, 45.0, 75.0_f64] {
        let angle = degrees.to_radians();
        let down = DVec3::new(angle.sin(), 0.0, -angle.cos());
        let seen = look(&scene, 6000, Ray::new(DVec3::new(0.0, 0.0, 1.0), down));
        let (back, through) = sheet(angle.cos(), 1.5, Rgb::WHITE);
        assert_mean(
            &format!("{degrees}°"),
            &seen,
            2.0 * through.g + 5.0 * back.g,
            3,
        );
    }
}

/// All ways of finding light have the same mean before shiny, rough and mixed surfaces, and behind panes.
#[test]
fn strategies_agree_before_every_lobe() {
    let lamp = Material::lambert(Rgb::BLACK).emitting(gray(4.0), gray(4.0));
    let phong = Material::of_lobes(vec![understory::material::Lobe::new(
        understory::material::LobeKind::Phong { exponent: 10.0 },
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
        .build();
    let seen = [
        Strategies::Both,
        Strategies::LightsOnly,
        Strategies::ScatteringOnly,
    ]
    .map(|strategies| {
        let settings = Path {
            strategies,
            max_depth: Some(2),
            ..Path::default()
        };
        observe_to(&scene, &settings, 9000, 0.001, |i| {
            let x = rng::unit_f64(rng::hash(&[7, i])) - 0.5;
            let down = DVec3::new(0.0, 1.0, -0.5).normalize();
            Ray::new(DVec3::new(x, -1.4, 1.0), down)
        })
    });
    assert_same("both, lights only", &seen[0], &seen[1], 2);
    assert_same("both, scattering only", &seen[0], &seen[2], 2);
}

/// Russian roulette changes no mean, in a room full of glass.
#[test]
fn roulette_and_glass() {
    let wall = Material::lambert(gray(0.2)).emitting(gray(0.0), gray(1.0));
    let scene = Room::default()
        .with(ball(3.0), at(0., 0., 0.), wall)
        .with(ball(1.0), at(1.2, 0., 0.), clear(1.5))
        .build();
    // A closed room of radiance L_e/(1 - ρ) = 1.25 everywhere, whatever glass is in it.
    for after in [Some(0), Some(4)] {
        let settings = Path {
            roulette_after: after,
            ..Path::default()
        };
        let seen = observe(&scene, &settings, 4000, |i| {
            let turn = 6.3 * rng::unit_f64(rng::hash(&[9, i]));
            Ray::new(
                DVec3::new(-1.0, 0.1, 0.0),
                DVec3::new(turn.cos(), turn.sin(), 0.1).normalize(),
            )
        });
        assert_mean(&format!("after {after:?}"), &seen, 1.25, 2);
    }
}
