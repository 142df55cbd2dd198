//! Light in scenes that need more than a closed form (those are in `tests/validation.rs`): coincident surfaces, instances, all
//! strategies together, nothing at all.
//!
//! Means are judged as `support/statistics.rs` says: false-alarm probability 1e-6 per test, never blind, and every
//! comparison is made twice more with a planted fault of 2 %, which must be seen.

#![allow(clippy::unwrap_used, reason = "a test may panic")]

#[path = "support/statistics.rs"]
mod statistics;
#[path = "support/room.rs"]
mod room;

use glam::{DAffine3, DVec3};
use room::{Room, at, even_sky, gray, shaded_ground, square};
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
use understory::scene::description::{
    Group, GroupId, Instance, MaterialId, OrganId, PlacedShape, SceneDescription,
};

fn path(max_depth: Option<u32>) -> Path {
    Path {
        max_depth,
        ..Path::default()
    }
}

/// The mean of 16 samples that are spread together, of the green radiance that arrives along `ray(i)`; independent for
/// each `i`.
fn observation<'a>(
    scene: &'a Scene,
    path: &Path,
    ray: impl Fn(u64) -> Ray + 'a,
) -> impl Fn(u64) -> f64 + 'a {
    let cancel = CancelToken::default();
    let context = RenderContext {
        seed: 0,
        cancel: &cancel,
        progress: &|_| {},
    };
    let estimator = path.prepare(scene, &context).unwrap();
    move |i| {
        let samples = (0..16).map(|index| {
            let stream = rng::hash(&[0xABCD, i]);
            let mut sampler = Sampler::new(SamplerKind::OwenSobol, stream, index);
            estimator
                .incident_radiance(&ray(i), &mut sampler, &mut RayCounts::default())
                .g
        });
        samples.sum::<f64>() / 16.0
    }
}

/// Observations until their mean is known to 0.16 %, at least a thousand.
fn observe(scene: &Scene, path: &Path, ray: impl Fn(u64) -> Ray) -> RunningStats {
    let observation = observation(scene, path, ray);
    let mut seen = RunningStats::default();
    while seen.n() < 1000 || (seen.standard_error() > 0.0016 * seen.mean() && seen.n() < 100_000) {
        seen.push(observation(seen.n()));
    }
    seen
}

/// One observation, where nothing is left to chance.
fn look(scene: &Scene, ray: impl Fn(u64) -> Ray) -> f64 {
    observation(scene, &path(None), ray)(0)
}

fn ray(origin: [f64; 3], direction: [f64; 3]) -> impl Fn(u64) -> Ray {
    move |_| Ray::new(origin.into(), DVec3::from(direction).normalize())
}

#[test]
fn a_half_transparent_leaf_lies_on_a_surface() {
    // Half of the light meets the leaf, which is first by its number, and half what it lies on; nothing is lost between.
    let leaf = Material::lambert(gray(0.2)).with_alpha(0.5);
    let grounds = [
        (Material::lambert(gray(0.8)), 0.5 * 0.2 + 0.5 * 0.8),
        (
            Material::lambert(Rgb::BLACK).emitting(gray(3.0), gray(3.0)),
            0.5 * 0.2 + 0.5 * 3.0,
        ),
    ];
    for (ground, truth) in grounds {
        for place in [at(0., 0., 1.), at(0.3, -7.1, 1234.5)] {
            let scene = Room::default()
                .with(square(2.0), place, leaf.clone())
                .with(square(2.0), place, ground.clone())
                .under(even_sky(1.0))
                .build();
            let eye = place.transform_point3(DVec3::new(0.1, 0.2, 1.0));
            let down = ray(eye.to_array(), [0.2, 0.1, -1.0]);
            assert_mean(
                "on a surface",
                &observe(&scene, &path(None), down),
                truth,
                4,
            );
        }
    }
}

#[test]
fn all_strategies_have_the_same_mean() {
    let scene = shaded_ground();
    let seen = [
        Strategies::Both,
        Strategies::LightsOnly,
        Strategies::ScatteringOnly,
    ]
    .map(|strategies| {
        let settings = Path {
            strategies,
            max_depth: Some(4),
            ..Path::default()
        };
        observe(&scene, &settings, |i| {
            let x = 4.0 * rng::unit_f64(rng::hash(&[7, i])) - 2.0;
            ray([x, -3.0, 1.5], [0.0, 1.0, -0.4])(i)
        })
    });
    assert_same("both, lights only", &seen[0], &seen[1], 3);
    assert_same("both, scattering only", &seen[0], &seen[2], 3);
    assert_same("lights only, scattering only", &seen[1], &seen[2], 3);
}

#[test]
fn nothing_gives_no_light_and_no_nan() {
    let empty = Scene::build(SceneDescription::default()).unwrap();
    let inside = Material::lambert(gray(0.5)).emitting(Rgb::BLACK, gray(1.0));
    let dark = Room::default()
        .with(Shape::Sphere { radius: 1.0 }, at(0., 0., 0.), inside)
        .build();
    let only_lamp = Room::default()
        .lit_by(Light::point(DVec3::ONE, gray(1.0)))
        .build();
    let down = ray([0.0, 0.0, 3.0], [0.0, 0.0, -1.0]);
    for scene in [&empty, &only_lamp, &dark] {
        let seen = look(scene, &down);
        assert_eq!(seen, 0.0);
    }
    let huge = Room::default()
        .with(Shape::Plane, at(0., 0., 0.), Material::default())
        .lit_by(Light::point(DVec3::Z, gray(1e30)))
        .lit_by(Light::point(DVec3::Z, gray(1e-30)))
        .build();
    assert!(look(&huge, down).is_finite());
}

#[test]
fn instances_are_lit_like_what_they_copy() {
    // The same leaf, placed directly or through two instances, one of them mirrored.
    let (environment, leaf) = (even_sky(1.0), Material::leaf(gray(0.2), gray(0.5)));
    let shape = PlacedShape {
        shape: square(0.5),
        to_group: at(0.0, 0.0, 0.0),
        material: MaterialId(0),
        organ: OrganId(0),
    };
    let mirror = DAffine3::from_scale(DVec3::new(1.0, 1.0, -1.0));
    let instance = |group, to_group| Instance {
        group: GroupId(group),
        to_group,
        organ: OrganId(1),
    };
    let description = SceneDescription {
        materials: vec![leaf],
        groups: vec![
            Group {
                shapes: vec![shape],
                instances: vec![],
            },
            Group {
                shapes: vec![],
                instances: vec![instance(0, mirror)],
            },
            Group {
                shapes: vec![],
                instances: vec![instance(1, at(0.0, 0.0, 1.0))],
            },
        ],
        root: Some(GroupId(2)),
        environment,
        ..SceneDescription::default()
    };
    let scene = Scene::build(description).unwrap();
    let seen = observe(&scene, &path(None), ray([0.1, 0.1, 3.0], [0.0, 0.0, -1.0]));
    assert_mean("leaf", &seen, 0.7, 1);
}

#[test]
fn impossible_light_is_refused_when_the_scene_is_built() {
    let lamp = SceneDescription {
        lights: vec![Light::point(DVec3::NAN, gray(1.0))],
        ..SceneDescription::default()
    };
    let sky = SceneDescription {
        environment: even_sky(f64::INFINITY),
        ..SceneDescription::default()
    };
    let messages =
        [lamp, sky].map(|description| Scene::build(description).unwrap_err().to_string());
    assert!(messages[0].starts_with("light 0: "), "{}", messages[0]);
    assert!(messages[1].starts_with("sky or sun: "), "{}", messages[1]);
}
