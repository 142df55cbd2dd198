//! Guided paths see the same light as unguided ones, with less noise where there are caustics.
//!
//! Means are judged as `support/statistics.rs` says: false-alarm probability 1e-6 per test, never blind.

#![allow(clippy::unwrap_used, reason = "a test may panic")]

#[path = "support/statistics.rs"]
#[allow(dead_code, reason = "shared with tests that use more of it")]
mod statistics;
#[path = "support/room.rs"]
#[allow(dead_code, reason = "shared with tests that use more of it")]
mod room;

use glam::{DAffine3, DQuat, DVec3};
use room::{Room, at, gray, square};
use statistics::assert_same;
use std::f64::consts::PI;
use understory::color::Rgb;
use understory::geometry::Shape;
use understory::integrator::requirements::{Feature, Features, Requirements};
use understory::integrator::{CancelToken, Integrator, Path, RayCounts, RenderContext};
use understory::light::{Environment, Sky};
use understory::material::Material;
use understory::math::stats::RunningStats;
use understory::math::{Ray, rng};
use understory::sampler::{Sampler, SamplerKind};
use understory::scene::Scene;

/// A box of matt walls, 2 m wide, with a lamp `2 half` wide under its ceiling and a ball.
fn ball_room(ball: Material, half: f64) -> Room {
    let wall = |reflectance: f64| Material::lambert(gray(reflectance));
    let tilted = |axis: DVec3, angle: f64, to: DVec3| {
        DAffine3::from_rotation_translation(DQuat::from_axis_angle(axis, angle), to)
    };
    let lamp = wall(0.0).emitting(gray(60.0), Rgb::BLACK);
    let side = PI / 2.0;
    Room::default()
        .with(square(1.0), at(0.0, 0.0, 0.0), wall(0.6))
        .with(square(1.0), at(0.0, 0.0, 2.0), wall(0.7))
        .with(
            square(1.0),
            tilted(DVec3::X, side, DVec3::new(0.0, 1.0, 1.0)),
            wall(0.4),
        )
        .with(
            square(1.0),
            tilted(DVec3::X, side, DVec3::new(0.0, -1.0, 1.0)),
            wall(0.4),
        )
        .with(
            square(1.0),
            tilted(DVec3::Y, side, DVec3::new(1.0, 0.0, 1.0)),
            wall(0.5),
        )
        .with(
            square(1.0),
            tilted(DVec3::Y, side, DVec3::new(-1.0, 0.0, 1.0)),
            wall(0.5),
        )
        .with(
            square(half),
            tilted(DVec3::X, PI, DVec3::new(0.2, 0.1, 1.95)),
            lamp,
        )
        .with(Shape::Sphere { radius: 0.4 }, at(-0.3, -0.2, 0.4), ball)
}

fn context(cancel: &CancelToken) -> RenderContext<'_> {
    RenderContext {
        seed: 3,
        cancel,
        progress: &|_| {},
    }
}

/// Radiance of a point of the ceiling, observations of which each is the mean of 16 samples that are spread together.
fn ceiling(scene: &Scene, path: &Path, n: u64) -> RunningStats {
    let cancel = CancelToken::default();
    let context = context(&cancel);
    let estimator = path.prepare(scene, &context).unwrap();
    let mut seen = RunningStats::default();
    let eye = DVec3::new(0.1, 0.1, 1.2);
    let ray = Ray::new(eye, (DVec3::new(-0.5, -0.4, 2.0) - eye).normalize());
    for i in 0..n {
        let samples = (0..16).map(|index| {
            let mut sampler = Sampler::new(SamplerKind::OwenSobol, rng::hash(&[9, i]), index);
            estimator
                .incident_radiance(&ray, &mut sampler, &mut RayCounts::default())
                .g
        });
        seen.push(samples.sum::<f64>() / 16.0);
    }
    seen
}

/// C-60: the guide is switched on where a scene requires it.
#[test]
fn a_guide_changes_the_noise_and_not_the_mean() {
    // Two events on the way are enough for the lamp in the mirror.
    let with = Path {
        max_depth: Some(2),
        ..Path::default()
    };
    let without = Path {
        guided: false,
        ..with.clone()
    };
    let mirror = Material::mirror(gray(0.9));

    // A large lamp has little noise. Catches any density that is not the one directions are chosen with: guiding with a share of
    // 0.5 and weighting as if it were 0.45 is seen.
    let large = ball_room(mirror.clone(), 0.8).build();
    let (guided, unguided) = (
        ceiling(&large, &with, 24_000),
        ceiling(&large, &without, 24_000),
    );
    assert_same("ceiling", &guided, &unguided, 1);

    // A small one is hard to find. Seen 1.8 times; 1.0 is a guide that nobody follows.
    let small = ball_room(mirror, 0.15).build();
    let guided = ceiling(&small, &with, 12_000).variance();
    let gain = ceiling(&small, &without, 12_000).variance() / guided;
    assert!(gain > 1.4, "guiding lowers the variance {gain} times only");
}

#[test]
fn there_is_a_guide_only_where_it_pays() {
    let has_guide = |scene: &Scene| Requirements::of(scene, Features::NONE).has(Feature::Guide);
    let mirror = Material::mirror(gray(0.9));
    let scene = ball_room(mirror.clone(), 0.15).build();
    assert!(has_guide(&scene));
    let matt = ball_room(Material::lambert(gray(0.5)), 0.15).build();
    assert!(!has_guide(&matt));
    let day = Environment {
        sky: Sky::Uniform(gray(1.0)),
        sun: None,
    };
    let open = ball_room(mirror, 0.15).under(day).build();
    assert!(!has_guide(&open));
}
