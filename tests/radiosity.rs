//! Radiosity: what it shows is what the path tracer shows, whatever the lamps, the surfaces and the solver.
//!
//! Numbers such as C-20b are those of the list of tests in the design notes. Closed forms of form factors and solvers are tested
//! beside them in the library.

#![allow(clippy::unwrap_used, reason = "a test may panic")]

#[path = "support/room.rs"]
#[allow(dead_code, reason = "other tests use the rest")]
mod room;

use glam::{DAffine3, DQuat, DVec3, EulerRot};
use room::{Room, at, even_sky, gray, square};
use std::f64::consts::PI;
use understory::color::Rgb;
use understory::geometry::Shape;
use understory::integrator::radiosity::{FormFactorMethod, Solver};
use understory::integrator::{
    CancelToken, Integrator, Path, RadianceEstimator, Radiosity, RayCounts, RenderContext,
    RenderError,
};
use understory::light::{Environment, Light, SunDisk};
use understory::material::Material;
use understory::math::angle::Angle;
use understory::math::{Ray, rng};
use understory::sampler::{Sampler, SamplerKind};
use understory::scene::Scene;

/// Where the rooms are looked at from: up at what lamps that shine down never light directly, and down. Where light comes from
/// above, all that is seen above is solved light.
const LOOKS: [(DVec3, DVec3); 2] = [
    (DVec3::new(-0.4, -0.3, 0.0), DVec3::Z),
    (DVec3::new(-0.4, -0.3, 0.0), DVec3::NEG_Z),
];

/// Rays along each side of a look, samples of each by the path tracer, and as many of views of solutions.
const ACROSS: u32 = 8;
const TRACED: u32 = 160;
const VIEWED: u32 = 16;

/// Coarse and quick, as the tests need it: 64 rays for each of about 2,000 patches.
fn quick(solver: Solver) -> Radiosity {
    Radiosity {
        solver: Some(solver),
        hemicube_pixels: 16,
        subdivision_depth: 0,
        ..Radiosity::default()
    }
}

fn prepared<'s>(method: &dyn Integrator, scene: &'s Scene) -> Box<dyn RadianceEstimator + 's> {
    let cancel = CancelToken::default();
    let context = RenderContext {
        seed: 3,
        cancel: &cancel,
        progress: &|_| {},
    };
    method.prepare(scene, &context).unwrap()
}

/// Mean radiance seen from a point in directions spread over a cone round `toward`, of so many samples each.
fn looked(
    estimator: &dyn RadianceEstimator,
    (from, toward): (DVec3, DVec3),
    n_samples: u32,
) -> Rgb {
    let n = ACROSS;
    let side = toward.any_orthonormal_vector() * 0.7 / f64::from(n);
    let up = toward.cross(side);
    let mut sum = Rgb::BLACK;
    for k in 0..n * n {
        let place = |k: u32| 2.0 * (f64::from(k) + 0.5) - f64::from(n);
        let w = (toward + side * place(k % n) + up * place(k / n)).normalize();
        let ray = Ray::new(from, w);
        for index in 0..n_samples {
            let stream = rng::hash(&[u64::from(k), toward.z.to_bits()]);
            let mut sampler = Sampler::new(SamplerKind::OwenSobol, stream, index);
            sum += estimator.incident_radiance(&ray, &mut sampler, &mut RayCounts::default());
        }
    }
    sum / f64::from(n * n * n_samples)
}

/// A closed room of 2 m, one wall red, one a leaf, with a block in it: without a lamp.
fn chamber() -> Room {
    let wall = |room: Room, axis: DVec3, material: Material| {
        let turn = DQuat::from_rotation_arc(DVec3::Z, -axis);
        let place = DAffine3::from_rotation_translation(turn, axis);
        room.with(square(1.0), place, material)
    };
    let white = || Material::lambert(gray(0.7));
    let red = Material::lambert(Rgb::new(0.7, 0.2, 0.1));
    let leaf = Material::leaf(gray(0.4), gray(0.0));
    let room = wall(Room::default(), DVec3::X, red);
    let room = wall(room, DVec3::NEG_X, leaf);
    let room = wall(room, DVec3::Y, white());
    let room = wall(room, DVec3::NEG_Y, white());
    let room = wall(room, DVec3::Z, white());
    let room = wall(room, DVec3::NEG_Z, white());
    let block = Shape::Box {
        half_x: 0.3,
        half_y: 0.3,
        length: 0.6,
    };
    room.with(block, at(0.2, 0.3, -0.97), white())
}

/// Floor, ceiling and a green wall: open to the right and to the sides.
fn open_room() -> Room {
    let white = || Material::lambert(gray(0.7));
    let green = Material::lambert(Rgb::new(0.2, 0.7, 0.3));
    let down = DAffine3::from_rotation_x(PI);
    let right = DAffine3::from_rotation_y(PI / 2.0);
    Room::default()
        .with(square(1.0), at(0.0, 0.0, -1.0), white())
        .with(square(1.0), at(0.0, 0.0, 1.0) * down, white())
        .with(square(1.0), at(-1.0, 0.0, 0.0) * right, green)
}

/// A square lamp under the ceiling.
fn with_lamp(room: Room) -> Room {
    let lamp = Material::lambert(Rgb::BLACK).emitting(gray(20.0), Rgb::BLACK);
    let down = at(0.0, 0.0, 0.98) * DAffine3::from_rotation_x(PI);
    room.with(square(0.3), down, lamp)
}

/// Whether all methods see what the path tracer sees.
fn compare(
    what: &str,
    scene: &Scene,
    methods: &[Radiosity],
    looks: &[(DVec3, DVec3)],
    (samples, traced_samples, limit): (u32, u32, f64),
) {
    let traced = prepared(&Path::default(), scene);
    let expected: Vec<Rgb> = looks
        .iter()
        .map(|look| looked(&*traced, *look, traced_samples))
        .collect();
    for method in methods {
        let solved = prepared(method, scene);
        for (look, expected) in looks.iter().zip(&expected) {
            let found = looked(&*solved, *look, samples);
            for (found, expected) in found.to_array().into_iter().zip(expected.to_array()) {
                let off = found / expected - 1.0;
                let (solver, factors) = (method.solver, method.form_factors);
                let told = format!("{what}, {solver:?} {factors:?}, {}: {off:+.4}", look.1);
                assert!(off.abs() < limit, "{told}: {found} instead of {expected}");
            }
        }
    }
}

const SOLVERS: [Solver; 3] = [Solver::Gather, Solver::Shoot, Solver::Stochastic];

/// C-20b: with every solver and every back end, to 4 %: the means over a seventh of ceiling and floor, with noise of path and rows
/// below 1 %. Without the second reflection the ceiling would be darker by a third.
#[test]
fn a_closed_room_is_as_the_path_tracer_sees_it() {
    let mut methods: Vec<Radiosity> = SOLVERS.into_iter().map(quick).collect();
    for form_factors in [FormFactorMethod::Hemicube, FormFactorMethod::Analytic] {
        methods.push(Radiosity {
            form_factors,
            hemicube_pixels: 8,
            ..quick(Solver::Gather)
        });
    }
    let scene = with_lamp(chamber()).build();
    compare("room", &scene, &methods, &LOOKS, (VIEWED, TRACED, 0.04));
}

/// Lamps without extent, to 4 %.
#[test]
fn lamps_without_extent_give_the_light_they_give_others() {
    let (inside, above) = (DVec3::new(0.0, 0.0, 0.4), DVec3::new(0.1, 0.0, 0.9));
    let (narrow, wide) = (Angle::deg(20.0), Angle::deg(35.0));
    let slanting = DVec3::new(-1.0, 0.3, -0.8).normalize();
    let scenes = [
        ("point", chamber().lit_by(Light::point(inside, gray(30.0)))),
        (
            "spot",
            chamber().lit_by(Light::spot(above, DVec3::NEG_Z, narrow, wide, gray(30.0))),
        ),
        (
            "directional",
            open_room().lit_by(Light::Directional {
                direction: slanting,
                irradiance: gray(3.0),
                origin: slanting * -10.0,
            }),
        ),
    ];
    for (name, room) in scenes {
        let methods = [quick(Solver::Gather)];
        compare(
            name,
            &room.build(),
            &methods,
            &LOOKS,
            (VIEWED, TRACED, 0.04),
        );
    }
}

/// Sun and sky come in where walls are missing, to 5 %: light of the sky is noisy in views.
#[test]
fn sun_and_sky_light_a_room_through_its_window() {
    let sun = SunDisk::clear(Angle::deg(90.0), Angle::deg(35.0), 3.0);
    let sunny = Environment {
        sun,
        ..Environment::default()
    };
    for (name, sky) in [("sun", sunny), ("sky", even_sky(1.0))] {
        let methods = [quick(Solver::Gather)];
        let scene = open_room().under(sky).build();
        compare(name, &scene, &methods, &LOOKS, (64, TRACED, 0.05));
    }
}

/// So many leaves that let light through, over this soil, under an even sky.
fn canopy(n_leaves: u64, soil: Shape) -> Scene {
    let mut room = Room::default().with(soil, at(0.0, 0.0, -0.6), Material::lambert(gray(0.3)));
    let number = |k: u64, what: u64| rng::unit_f64(rng::hash(&[k, what])) - 0.5;
    for k in 0..n_leaves {
        let place = DVec3::new(number(k, 0), number(k, 1), number(k, 2)) * 0.9;
        let turns = [3, 4, 5].map(|what| number(k, what));
        let turn = DQuat::from_euler(EulerRot::XYZ, turns[0], turns[1], turns[2]);
        let place = DAffine3::from_rotation_translation(turn, place);
        room = room.with(square(0.12), place, Material::leaf(gray(0.45), gray(0.4)));
    }
    room.under(even_sky(1.0)).build()
}

/// From above and from below.
const AROUND: [(DVec3, DVec3); 2] = [
    (DVec3::new(0.0, 0.0, 1.2), DVec3::NEG_Z),
    (DVec3::new(0.0, 0.0, -0.55), DVec3::Z),
];

/// By all solvers, to 4 %: noise of the sky in views and of paths about 1 %, and patches a third of a leaf wide.
#[test]
fn a_canopy_is_as_the_path_tracer_sees_it() {
    let methods = SOLVERS.map(quick);
    let scene = canopy(60, square(0.8));
    compare("canopy", &scene, &methods, &AROUND, (128, 320, 0.04));
}

/// Over ground without end, whose cells far away are huge, to 5 %. Stopped after the first round, as it would be if these counted by
/// their area, gathering leaves the undersides of leaves darker by a fifth.
#[test]
fn a_canopy_over_endless_ground_is_as_the_path_tracer_sees_it() {
    let coarse = |solver| Radiosity {
        hemicube_pixels: 8,
        ..quick(solver)
    };
    let methods = [coarse(Solver::Gather), coarse(Solver::Stochastic)];
    let scene = canopy(30, Shape::Plane);
    compare("ground", &scene, &methods, &AROUND, (128, 320, 0.05));
}

/// Mirrors and glass take part: rooms with them are as the path tracer sees them, to 5 %: light comes off the mirror and through the
/// glass onto the matt surfaces, which lamps are not asked for. Below the glass ball, where it gathers the light of the lamp, patches
/// are too coarse here: only what lies above is looked at.
#[test]
fn mirrors_and_glass_take_part() {
    let mirror = at(0.0, 0.99, 0.0) * DAffine3::from_rotation_x(PI / 2.0);
    let mirrored = with_lamp(chamber()).with(square(0.9), mirror, Material::mirror(gray(0.9)));
    let ball = Shape::Sphere { radius: 0.35 };
    let glass = Material::glass(1.5, 0.0, Rgb::BLACK);
    let glassy = with_lamp(chamber()).with(ball, at(-0.4, -0.3, -0.6), glass);
    for (name, room, looks) in [("mirror", mirrored, 2), ("glass", glassy, 1)] {
        let methods = [quick(Solver::Gather), quick(Solver::Stochastic)];
        let looks = &LOOKS[..looks];
        compare(name, &room.build(), &methods, looks, (VIEWED, TRACED, 0.05));
    }
}

#[test]
fn pictures_do_not_depend_on_threads() {
    let scene = with_lamp(chamber()).build();
    for solver in SOLVERS {
        let radiosity = Radiosity {
            hemicube_pixels: 4,
            subdivision_depth: 1,
            subdivision_threshold: 0.5,
            ..quick(solver)
        };
        let pictures = [1, 3, 8].map(|n| {
            let pool = rayon::ThreadPoolBuilder::new().num_threads(n).build();
            pool.unwrap().install(|| {
                let solved = prepared(&radiosity, &scene);
                LOOKS.map(|look| looked(&*solved, look, 1))
            })
        });
        assert!(
            pictures.iter().all(|picture| *picture == pictures[0]),
            "{solver:?}"
        );
        assert!(pictures[0].iter().all(|light| light.g > 0.0));
    }
}

#[test]
fn what_does_not_fit_is_refused() {
    let lamp = Light::point(DVec3::new(0.0, 0.0, 0.4), gray(30.0));
    let scene = chamber().lit_by(lamp).build();
    let cancel = CancelToken::default();
    let context = RenderContext {
        seed: 3,
        cancel: &cancel,
        progress: &|_| {},
    };
    let with = |memory: u64, solver| Radiosity {
        memory,
        solver,
        hemicube_pixels: 256,
        ..Radiosity::default()
    };
    let refused = with(4096, None).prepare(&scene, &context);
    assert!(matches!(
        refused.err(),
        Some(RenderError::TooManyPatches { most: 4, .. })
    ));
    let refused = with(1 << 20, Some(Solver::Gather)).prepare(&scene, &context);
    assert!(matches!(
        refused.err(),
        Some(RenderError::TooManyFactors { .. })
    ));
    cancel.cancel();
    let stopped = with(1 << 30, Some(Solver::Stochastic)).prepare(&scene, &context);
    assert!(matches!(stopped.err(), Some(RenderError::Cancelled { .. })));
}
