//! Light whose exact value is known on paper, for every renderer.
//!
//! Means are judged as `support/statistics.rs` says: false-alarm probability 1e-6 per test, never blind, and every
//! comparison is made twice more with a planted fault of 2 %, which must be seen.

#![allow(clippy::unwrap_used, reason = "a test may panic")]

#[path = "support/statistics.rs"]
mod statistics;
#[path = "support/room.rs"]
mod room;

use glam::{DAffine3, DQuat, DVec2, DVec3};
use room::{Room, at, gray, shaded_ground, square};
use statistics::{Verdict, assert_mean, assert_same, verdict};
use std::f64::consts::{FRAC_1_PI, PI};
use understory::color::Rgb;
use understory::geometry::Shape;
use understory::integrator::path::Strategies;
use understory::integrator::{CancelToken, Integrator, Path, RayCounts, RenderContext};
use understory::light::{Dome, Environment, Light, Sky};
use understory::material::Material;
use understory::math::angle::Angle;
use understory::math::stats::RunningStats;
use understory::math::{Ray, rng, warp};
use understory::sampler::{Sampler, SamplerKind};
use understory::scene::Scene;
use understory::scene::description::{
    Group, GroupId, Instance, MaterialId, OrganId, PlacedShape, SceneDescription,
};

fn uniform_sky(radiance: f64) -> Environment {
    Environment {
        sky: Sky::Uniform(gray(radiance)),
        sun: None,
    }
}

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

/// A ray from the origin in a direction that depends on `i`.
fn all_round(i: u64) -> Ray {
    let u = DVec2::new(
        rng::unit_f64(rng::hash(&[1, i])),
        rng::unit_f64(rng::hash(&[2, i])),
    );
    Ray::new(DVec3::new(0.1, -0.2, 0.3), warp::sphere(u))
}

// ── furnaces ──

/// Closed rooms whose walls shine with radiance 1 inside and reflect ρ.
fn furnaces(rho: f64) -> Vec<(&'static str, Scene)> {
    let wall = |front, back| Material::lambert(gray(rho)).emitting(gray(front), gray(back));
    let sphere = Room::default().with(
        Shape::Sphere { radius: 1.0 },
        at(0., 0., 0.),
        wall(0.0, 1.0),
    );
    let cube = Shape::Box {
        half_x: 0.9,
        half_y: 1.0,
        length: 2.0,
    };
    let cube = Room::default().with(cube, at(0.0, 0.0, -1.0), wall(0.0, 1.0));
    // A room of 96 tiles that look inwards: more sources than are all sampled at once.
    let mut tiles = Room::default();
    for axis in [
        DVec3::X,
        DVec3::Y,
        DVec3::Z,
        DVec3::NEG_X,
        DVec3::NEG_Y,
        DVec3::NEG_Z,
    ] {
        let turn = DQuat::from_rotation_arc(DVec3::Z, -axis);
        for i in 0..16 {
            let place = DVec3::new(
                f64::from(i % 4) * 0.5 - 0.75,
                f64::from(i / 4) * 0.5 - 0.75,
                0.0,
            );
            let to_world = DAffine3::from_rotation_translation(turn, axis + turn * place);
            tiles = tiles.with(square(0.25), to_world, wall(1.0, 0.0));
        }
    }
    vec![
        ("sphere", sphere.build()),
        ("box", cube.build()),
        ("tiles", tiles.build()),
    ]
}

#[test]
fn furnace() {
    for rho in [0.0, 0.5, 0.8, 0.95] {
        for (name, scene) in furnaces(rho) {
            let seen = observe(&scene, &path(None), all_round);
            assert_mean(&format!("{name}, rho {rho}"), &seen, 1.0 / (1.0 - rho), 12);
        }
    }
}

#[test]
fn depth_counts_scattering_events() {
    for (rho, depths) in [(0.5, 0..=5), (1.0, 3..=3)] {
        let scenes = furnaces(rho);
        for depth in depths {
            let series: f64 = (0..=depth).map(|k| f64::powi(rho, k)).sum();
            let limit = path(Some(u32::try_from(depth).unwrap()));
            for (name, scene) in &scenes {
                let seen = observe(scene, &limit, all_round);
                assert_mean(
                    &format!("{name}, rho {rho}, depth {depth}"),
                    &seen,
                    series,
                    21,
                );
            }
        }
    }
}

#[test]
fn roulette_changes_no_mean() {
    let scenes = furnaces(0.7);
    let truth = (1.0 - 0.7_f64.powi(13)) / 0.3;
    for roulette_after in [None, Some(0), Some(4)] {
        let settings = Path {
            max_depth: Some(12),
            roulette_after,
            ..Path::default()
        };
        let seen = observe(&scenes[1].1, &settings, all_round);
        assert_mean(&format!("{roulette_after:?}"), &seen, truth, 3);
    }
}

#[test]
fn a_fault_of_two_percent_in_the_walls_is_caught() {
    // Not a scaled result but a wrong program: the room absorbs a little less than it says.
    let rho = 0.5 + 0.01;
    let seen = observe(&furnaces(rho)[1].1, &path(None), all_round);
    assert_eq!(verdict(&seen, 2.0, 1), Verdict::Differs);
}

#[test]
fn objects_that_absorb_nothing_vanish_in_an_even_sky() {
    let leaf = Material::leaf(gray(0.3), gray(0.7));
    let mut crown = Room::default().under(uniform_sky(3.0));
    for i in 0..60 {
        let h = |k: u64| rng::unit_f64(rng::hash(&[i, k]));
        let turn = DQuat::from_rotation_arc(DVec3::Z, warp::sphere(DVec2::new(h(0), h(1))));
        let place = DVec3::new(h(2) - 0.5, h(3) - 0.5, h(4) - 0.5);
        let to_world = DAffine3::from_rotation_translation(turn, place);
        crown = crown.with(square(0.2), to_world, leaf.clone());
    }
    let mirrored = DAffine3::from_scale(DVec3::new(-1.0, 2.0, 0.5));
    let ball = Room::default().under(uniform_sky(3.0)).with(
        Shape::Sphere { radius: 1.0 },
        mirrored,
        Material::lambert(Rgb::WHITE),
    );
    for (name, scene) in [("crown", crown.build()), ("ball", ball.build())] {
        let seen = observe(&scene, &path(None), |i| {
            let u = DVec2::new(
                rng::unit_f64(rng::hash(&[3, i])),
                rng::unit_f64(rng::hash(&[4, i])),
            );
            Ray::new(DVec3::new(u.x - 0.5, u.y - 0.5, 9.0), DVec3::NEG_Z)
        });
        assert_mean(name, &seen, 3.0, 2);
    }
}

// ── lamps ──

#[test]
fn integrating_sphere() {
    for rho in [0.5, 0.9] {
        let (intensity, radius) = (7.0, 2.0);
        let scene = Room::default()
            .with(
                Shape::Sphere { radius },
                at(0., 0., 0.),
                Material::lambert(gray(rho)),
            )
            .lit_by(Light::Point {
                position: DVec3::ZERO,
                intensity: gray(intensity),
            })
            .build();
        let truth = rho * FRAC_1_PI * intensity / (radius * radius) / (1.0 - rho);
        let seen = observe(&scene, &path(None), all_round);
        assert_mean(&format!("rho {rho}"), &seen, truth, 2);
    }
}

#[test]
fn lamps_without_extent_are_exact() {
    let floor = || Room::default().with(Shape::Plane, at(0., 0., 0.), Material::lambert(gray(0.6)));
    let lamp = DVec3::new(0.0, 0.0, 2.0);
    let inner = Angle::deg(20.0);
    let outer = Angle::deg(40.0);
    let spot = Light::spot(lamp, DVec3::NEG_Z, inner, outer, gray(50.0));
    let Light::Spot { intensity, .. } = spot else {
        panic!("a spot is a spot")
    };
    let direction = DVec3::new(0.6, 0.0, -0.8);
    let parallel = |height: f64| Light::Directional {
        direction,
        irradiance: gray(10.0),
        origin: DVec3::new(0.0, 0.0, height),
    };
    let cos: f64 = 2.0 / 5.0_f64.sqrt();
    let cases = [
        ("point", Light::point(lamp, gray(4.0 * PI)), 1.0, cos / 5.0),
        (
            "spot, inside",
            spot.clone(),
            0.3,
            intensity.g * 2.0 / 4.09_f64.powf(1.5),
        ),
        ("spot, outside", spot, 2.0, 0.0),
        ("parallel", parallel(5.0), 1.0, 8.0),
        ("parallel, downstream only", parallel(-5.0), 1.0, 0.0),
    ];
    for (name, light, x, irradiance) in cases {
        let scene = floor().lit_by(light).build();
        let seen = look(&scene, ray([x, 0.0, 1.0], [0.0, 0.0, -1.0]));
        let truth = 0.6 * FRAC_1_PI * irradiance;
        assert!(
            (seen - truth).abs() <= 1e-6 * truth,
            "{name}: {seen} {truth}"
        );
    }
}

#[test]
fn disk_light_on_its_axis() {
    for strategies in [
        Strategies::Both,
        Strategies::LightsOnly,
        Strategies::ScatteringOnly,
    ] {
        for (radius, height) in [(1.0, 1.0), (1.0, 0.3), (3.0, 5.0)] {
            let down = DAffine3::from_rotation_translation(
                DQuat::from_rotation_x(PI),
                DVec3::new(0.0, 0.0, height),
            );
            let lamp = Material::lambert(Rgb::BLACK).emitting(gray(5.0), gray(99.0));
            let scene = Room::default()
                .with(Shape::Disk { radius }, down, lamp)
                .with(
                    square(0.5 * height),
                    at(0., 0., 0.),
                    Material::lambert(gray(0.5)),
                )
                .build();
            let squares = radius * radius + height * height;
            let truth = 0.5 * FRAC_1_PI * PI * 5.0 * radius * radius / squares;
            let settings = Path {
                strategies,
                ..Path::default()
            };
            let slanted = ray([0.0, -0.5 * height, 0.5 * height], [0.0, 1.0, -1.0]);
            let seen = observe(&scene, &settings, slanted);
            assert_mean(
                &format!("{strategies:?} {radius} {height}"),
                &seen,
                truth,
                9,
            );
        }
    }
}

#[test]
fn half_transparent_things() {
    // A veil of alpha 0.3 between lamp and floor takes 30 % of the light, and hides 30 % of the floor from above.
    let veil = Material::lambert(Rgb::BLACK).with_alpha(0.3);
    let scene = Room::default()
        .with(Shape::Plane, at(0., 0., 0.), Material::lambert(gray(0.6)))
        .with(square(9.0), at(0., 0., 1.0), veil)
        .lit_by(Light::point(DVec3::new(0.0, 0.0, 2.0), gray(4.0 * PI)))
        .build();
    let lit = 0.6 * FRAC_1_PI * 0.7 / 4.0;
    let below = look(&scene, ray([0.0, 0.0, 0.5], [0.0, 0.0, -1.0]));
    assert!((below / lit - 1.0).abs() < 1e-6);
    let above = observe(&scene, &path(None), ray([0.0, 0.0, 1.5], [0.0, 0.0, -1.0]));
    assert_mean("through the veil", &above, 0.7 * lit, 2);

    // A lamp of alpha 0.4 gives 40 % of its radiance, whichever way it is found.
    for strategies in [Strategies::LightsOnly, Strategies::ScatteringOnly] {
        let lamp = Material::lambert(Rgb::BLACK)
            .emitting(gray(5.0), gray(5.0))
            .with_alpha(0.4);
        let scene = Room::default()
            .with(Shape::Disk { radius: 1.0 }, at(0., 0., 1.0), lamp)
            .with(square(0.5), at(0., 0., 0.), Material::lambert(gray(0.5)))
            .build();
        let settings = Path {
            strategies,
            ..Path::default()
        };
        let seen = observe(&scene, &settings, ray([0.0, -0.4, 0.4], [0.0, 1.0, -1.0]));
        assert_mean(&format!("{strategies:?}"), &seen, 0.5 * 5.0 * 0.4 * 0.5, 2);
    }
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
                .under(uniform_sky(1.0))
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

// ── daylight ──

#[test]
fn open_ground_receives_the_stated_daylight() {
    let albedo = gray(0.4);
    for elevation in [10.0, 35.0, 80.0] {
        let day = Environment::daylight(Angle::deg(40.0), Angle::deg(elevation), 3.0, albedo);
        let sky = Dome::new(&day).horizontal_irradiance().g;
        let sun = day.sun.clone().unwrap();
        let truth = 0.4 * FRAC_1_PI * (sky + sun.irradiance.g * sun.to_sun.z);
        let ground = Room::default().with(Shape::Plane, at(0., 0., 0.), Material::lambert(albedo));
        let seen = observe(&ground.under(day).build(), &path(None), |i| {
            ray([i as f64, 0.0, 2.0], [0.3, 0.1, -1.0])(i)
        });
        assert_mean(&format!("{elevation}"), &seen, truth, 3);
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
    let dark = furnaces(0.5).remove(0).1;
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
    let (environment, leaf) = (uniform_sky(1.0), Material::leaf(gray(0.2), gray(0.5)));
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
        environment: uniform_sky(f64::INFINITY),
        ..SceneDescription::default()
    };
    let messages =
        [lamp, sky].map(|description| Scene::build(description).unwrap_err().to_string());
    assert!(messages[0].starts_with("light 0: "), "{}", messages[0]);
    assert!(messages[1].starts_with("sky or sun: "), "{}", messages[1]);
}

#[test]
fn the_judge_itself_tells_agreement_fault_and_blindness_apart() {
    let noise = |spread: f64, n: u64| -> RunningStats {
        let number = |i| 1.0 + spread * (rng::unit_f64(rng::hash(&[11, i])) - 0.5);
        (0..n).map(number).collect()
    };
    assert_eq!(verdict(&noise(0.1, 1000), 1.0, 1), Verdict::Agrees);
    assert_eq!(verdict(&noise(0.1, 1000), 1.02, 1), Verdict::Differs);
    assert_eq!(verdict(&noise(2.0, 100), 1.0, 1), Verdict::Blind);
}
