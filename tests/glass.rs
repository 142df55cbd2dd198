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
use room::{Room, at, even_sky, gray, square};
use statistics::{assert_mean, assert_same};
use understory::color::Rgb;
use understory::geometry::Shape;
use understory::integrator::path::Strategies;
use understory::integrator::{CancelToken, Integrator, Path, RayCounts, RenderContext};
use understory::light::Light;
use understory::material::Material;
use understory::math::stats::RunningStats;
use understory::math::{Ray, rng};
use understory::sampler::{Sampler, SamplerKind};
use understory::scene::Scene;

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

/// Beer's law along a chord, exactly, and through bodies within bodies.
#[test]
fn absorption_follows_the_path() {
    let body = |sigma| Material::glass(1.0, 0.0, gray(sigma));
    let scene = Room::default()
        .with(ball(2.0), at(0., 0., 0.), body(0.3))
        .with(ball(1.0), at(0., 0., 0.), body(1.1))
        .under(even_sky(1.0))
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

/// C-48: to the last bit.
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
    let open = lit(floor()).under(even_sky(1.0)).build();
    let with = lit(floor().with(ball(0.5), at(0.0, 0.0, 0.9), clear(1.0)))
        .under(even_sky(1.0))
        .build();
    for i in 0..40 {
        let [a, b] = [&open, &with].map(|scene| look(scene, 1, rays(i)).mean());
        assert_eq!(a.to_bits(), b.to_bits(), "ray {i}: {a} {b}");
    }
}

/// C-55: all ways of finding light have the same mean before shiny, rough and mixed surfaces, and behind panes.
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

/// C-56: Russian roulette changes no mean, in a room full of glass.
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
