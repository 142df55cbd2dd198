//! Photons: the power that arrives is what paper says, and every quantum of it is on the books.
//!
//! Means are judged as `support/statistics.rs` says: false-alarm probability 1e-6 per test, never blind to 2 %. Numbers such as C-43
//! are those of the list of tests in the design notes.

#![allow(clippy::unwrap_used, reason = "a test may panic")]

#[path = "support/room.rs"]
#[allow(dead_code, reason = "other tests use the rest")]
mod room;
#[path = "support/statistics.rs"]
#[allow(dead_code, reason = "other tests use the rest")]
mod statistics;

use glam::{DAffine3, DQuat, DVec3};
use room::{Room, at, gray, square};
use statistics::assert_mean;
use std::f64::consts::PI;
use std::sync::Arc;
use understory::color::Rgb;
use understory::geometry::{Shape, TriangleMesh};
use understory::integrator::photon::{
    Aim, BLOCK, Emission, History, Ledger, Onward, PhotonHit, Photons, Visitor, trace,
};
use understory::integrator::{CancelToken, RenderContext, RenderError};
use understory::light::{Dome, Environment, Light, Sky, SkyImage, SunDisk};
use understory::material::Material;
use understory::math::angle::Angle;
use understory::math::stats::RunningStats;
use understory::scene::Scene;
use understory::scene::description::MaterialId;

/// What arrived, by material (each shape of a `Room` has its own), side (front first) and history.
#[derive(Clone, Debug, Default, PartialEq)]
struct Arrivals(Vec<(u32, bool, History, Rgb)>);

impl Visitor for Arrivals {
    fn arrives(&mut self, hit: &PhotonHit<'_>) -> Onward {
        let MaterialId(shape) = hit.point.material;
        self.0
            .push((shape, hit.point.is_front, hit.history, hit.power));
        Onward::Go
    }
}

impl Arrivals {
    fn power(&self, wanted: impl Fn(u32, bool, History) -> bool) -> Rgb {
        let found = self
            .0
            .iter()
            .filter(|(shape, front, history, _)| wanted(*shape, *front, *history));
        found.map(|(.., power)| *power).sum()
    }
}

fn follow(scene: &Scene, aim: Aim, photons: &Photons) -> (Arrivals, Ledger) {
    let cancel = CancelToken::default();
    let context = RenderContext {
        seed: 0,
        cancel: &cancel,
        progress: &|_| {},
    };
    let emission = Emission::new(scene, aim);
    let mut all = Arrivals::default();
    let join = |block: Arrivals| all.0.extend(block.0);
    let ledger = trace(&emission, photons, &context, Arrivals::default, join).unwrap();
    (all, ledger)
}

/// Means over independent runs of a figure of each.
fn runs(n: u64, figure: impl FnMut(u64) -> f64) -> RunningStats {
    (0..n).map(figure).collect()
}

/// Green power that arrives at one side of a shape from `n` photons, many times.
fn arriving(scene: &Scene, shape: u32, front: bool, n: u64) -> RunningStats {
    runs(24, |seed| {
        let (seen, _) = follow(scene, Aim::Everything, &Photons::all(n, seed, 64));
        seen.power(|s, f, _| s == shape && f == front).g
    })
}

/// A black level square 1 m above an endless plane of reflectance 0.6, low sun, and an upright one; all turned by `turn`.
fn over_endless_ground(turn: DQuat) -> Scene {
    let turned = |to_world: DAffine3| DAffine3::from_quat(turn) * to_world;
    let upright = at(0.0, 1.0, 1.0) * DAffine3::from_rotation_x(0.5 * PI);
    let sun = Light::Directional {
        direction: turn * DVec3::new(0.8, 0.0, -0.6),
        irradiance: gray(5.0),
        origin: turn * DVec3::new(-4000.0, 0.0, 3000.0),
    };
    Room::default()
        .with(square(0.15), turned(at(0.0, 0.0, 1.0)), black())
        .with(square(0.15), turned(upright), black())
        .with(
            Shape::Plane,
            turned(DAffine3::IDENTITY),
            Material::lambert(gray(0.6)),
        )
        .lit_by(sun)
        .build()
}

/// Below the level square lies nothing but lit ground: ρE. The upright one sees as much of it as of the sky: ρE/2, less 0.6 % that
/// comes from beyond the rings. Shadows take up to 0.6 %. A fault of 10 % in any is seen.
#[test]
fn endless_ground_throws_back_what_falls_on_it() {
    for turn in [DQuat::IDENTITY, DQuat::from_rotation_y(0.7)] {
        let scene = over_endless_ground(turn);
        let (power, n) = (0.6 * 5.0 * 0.6 * 0.09, 24_u64);
        let all: Vec<Arrivals> = (0..n)
            .map(|seed| follow(&scene, Aim::Everything, &Photons::all(40_000, seed, 64)).0)
            .collect();
        for (shape, front, truth) in [
            (0, false, power),
            (1, true, 0.5 * power),
            (1, false, 0.5 * power),
        ] {
            let on = |seen: &Arrivals| seen.power(|s, f, _| s == shape && f == front).g;
            let seen: RunningStats = all.iter().map(on).collect();
            let error = seen.standard_error() / truth;
            let off = seen.mean() / truth - 1.0;
            let expected = -0.012 - 5.0 * error..5.0 * error;
            assert!(
                error < 0.02 && expected.contains(&off),
                "{shape} {front} {turn}: {off} ± {error}"
            );
        }
    }
}

/// Photons that come from near and from far are alike: none makes a spot.
#[test]
fn photons_off_endless_ground_are_about_alike() {
    let boxes = |scene: Room| {
        scene
            .with(
                Shape::Box {
                    half_x: 0.5,
                    half_y: 0.5,
                    length: 1.0,
                },
                DAffine3::IDENTITY,
                Material::lambert(gray(0.5)),
            )
            .with(
                Shape::Plane,
                DAffine3::IDENTITY,
                Material::lambert(gray(0.3)),
            )
            .under(Environment {
                sky: Sky::Uniform(gray(2.0)),
                sun: None,
            })
            .build()
    };
    let scene = boxes(Room::default());
    let (seen, books) = follow(&scene, Aim::Everything, &Photons::all(200_000, 1, 64));
    let on_box = |wanted: History| -> Vec<f64> {
        let arrivals = seen
            .0
            .iter()
            .filter(|(shape, _, history, _)| *shape == 0 && *history == wanted);
        arrivals.map(|(.., power)| power.g).collect()
    };
    let (direct, diffuse) = (on_box(History::Direct), on_box(History::Diffuse));
    let usual = direct.iter().sum::<f64>() / direct.len() as f64;
    let strongest = diffuse.iter().copied().fold(0.0, f64::max);
    assert!(
        direct.len() > 20_000 && diffuse.len() > 2000,
        "{} {}",
        direct.len(),
        diffuse.len()
    );
    assert!(strongest < 5.0 * usual, "{strongest} {usual}");
    assert_eq!(books.imbalance(), [0; 3]);
}

fn black() -> Material {
    Material::lambert(Rgb::BLACK)
}

/// Solid angle of a square of this half edge from a height over its middle.
fn square_solid_angle(half: f64, height: f64) -> f64 {
    let (a, h) = (half * half, height * height);
    4.0 * (a / (a + h)).asin()
}

#[test]
fn lamps_give_a_square_what_its_solid_angle_says() {
    let power = Rgb::new(1.0, 8.0, 2.0);
    let below = |lamp| {
        Room::default()
            .with(square(1.0), DAffine3::IDENTITY, black())
            .with(square(0.1), at(9.0, 0.0, 0.0), black())
            .lit_by(lamp)
            .build()
    };
    let point = below(Light::point(DVec3::Z * 2.0, power));
    let share = square_solid_angle(1.0, 2.0) / (4.0 * PI);
    assert_mean("point", &arriving(&point, 0, true, 4000), 8.0 * share, 2);
    // A beam wholly inside the square, aimed at whatever way is the narrower.
    let (inner, outer) = (Angle::deg(5.0), Angle::deg(20.0));
    let spot = below(Light::spot(
        DVec3::Z * 2.0,
        DVec3::NEG_Z,
        inner,
        outer,
        power,
    ));
    let seen = arriving(&spot, 0, true, 1000);
    assert!((seen.mean() - 8.0).abs() < 1e-9, "{seen:?}");
    let wide = Light::spot(DVec3::Z * 40.0, DVec3::NEG_Z, inner, outer, power);
    let scene = below(wide.clone());
    let found = wide.illuminate(DVec3::ZERO).unwrap().facing_irradiance.g * 4.0;
    // The square is so far away that it is lit evenly, up to 0.2 %.
    let seen = arriving(&scene, 0, true, 4000);
    assert!((seen.mean() / found - 1.0).abs() < 0.02, "{seen:?} {found}");
}

#[test]
fn parallel_light_sun_and_skies_give_a_square_their_irradiance() {
    let tilt = DAffine3::from_quat(DQuat::from_rotation_x(0.4));
    let room = || {
        Room::default().with(square(1.0), tilt, black()).with(
            Shape::Sphere { radius: 0.3 },
            at(3.0, 4.0, -2.0),
            black(),
        )
    };
    let normal = tilt.transform_vector3(DVec3::Z);
    let down = DVec3::new(0.3, 0.2, -0.7).normalize();
    let lamp = Light::Directional {
        direction: down,
        irradiance: gray(5.0),
        origin: DVec3::Z * 50.0,
    };
    let truth = 5.0 * -down.dot(normal) * 4.0;
    assert_mean(
        "parallel",
        &arriving(&room().lit_by(lamp).build(), 0, true, 4000),
        truth,
        8,
    );

    let sun = SunDisk {
        to_sun: -down,
        irradiance: gray(5.0),
        angular_radius: Angle::deg(0.2666),
    };
    let sunny = Environment {
        sky: Sky::None,
        sun: Some(sun),
    };
    assert_mean(
        "sun",
        &arriving(&room().under(sunny).build(), 0, true, 4000),
        truth,
        8,
    );

    let uniform = Environment {
        sky: Sky::Uniform(gray(2.0)),
        sun: None,
    };
    let scene = room().under(uniform).build();
    for front in [true, false] {
        let seen = arriving(&scene, 0, front, 5000);
        assert!((seen.mean() / (8.0 * PI) - 1.0).abs() < 0.02, "{seen:?}");
    }

    // Skies with land below and panoramas: what a level square gets.
    let level = || Room::default().with(square(1.0), DAffine3::IDENTITY, black());
    let day = Environment::daylight(Angle::deg(30.0), Angle::deg(40.0), 3.0, gray(0.3));
    let overcast = Sky::Overcast {
        zenith: gray(3.0),
        ground_albedo: gray(0.25),
    };
    let pixels = (0..32 * 16)
        .map(|i| [0.0, 1.0 + (i % 7) as f32, 0.0])
        .collect();
    let image = Arc::new(SkyImage::new(32, 16, pixels).unwrap());
    let panorama = Sky::Image {
        image,
        turn: Angle::deg(20.0),
        strength: 1.5,
    };
    for sky in [day.sky, overcast, panorama] {
        let environment = Environment { sky, sun: None };
        let dome = Dome::new(&environment);
        let truth = dome.horizontal_irradiance().g * 4.0;
        let land = dome.radiance(DVec3::NEG_Z).g * PI * 4.0;
        let has_land = dome.has_land();
        let scene = level().under(environment).build();
        // Irradiance of a clear sky is itself a sum over directions, good to 0.1 %.
        let seen = arriving(&scene, 0, true, 6000);
        assert!((seen.mean() / truth - 1.0).abs() < 3e-3, "{seen:?} {truth}");
        if has_land {
            assert_mean("land", &arriving(&scene, 0, false, 6000), land, 8);
        }
    }
}

fn shining_shapes() -> Vec<(Shape, DAffine3, f64)> {
    let turned = DAffine3::from_quat(DQuat::from_euler(glam::EulerRot::XYZ, 0.4, 1.1, 2.0));
    let far = at(1000.0, -2000.0, 500.0);
    let mesh = TriangleMesh {
        positions: vec![DVec3::ZERO, DVec3::X, DVec3::Y, DVec3::Z],
        triangles: vec![[0, 2, 1], [0, 1, 3], [1, 2, 3], [0, 3, 2]],
        ..TriangleMesh::default()
    };
    let cylinder = Shape::Frustum {
        length: 1.0,
        base_radius: 0.5,
        top_radius: 0.5,
        base_cap: true,
        top_cap: true,
    };
    vec![
        (square(0.5), turned, 1.0),
        (square(0.5), far * turned, 1.0),
        (Shape::Sphere { radius: 0.5 }, turned, PI),
        (Shape::Sphere { radius: 0.5 }, far, PI),
        (Shape::Mesh(Arc::new(mesh)), turned, 1.5 + 0.75_f64.sqrt()),
        (Shape::Disk { radius: 0.5 }, far, 0.25 * PI),
        (
            Shape::Box {
                half_x: 0.5,
                half_y: 0.25,
                length: 1.0,
            },
            turned,
            4.0,
        ),
        (cylinder, turned, 1.5 * PI),
    ]
}

#[test]
fn shining_shapes_of_all_kinds_send_their_power_and_none_of_it_into_themselves() {
    for (shape, place, area) in shining_shapes() {
        let lamp = black().emitting(gray(3.0), Rgb::BLACK);
        let around = place * DAffine3::from_scale(DVec3::splat(4.0));
        let scene = Room::default()
            .with(shape.clone(), place, lamp)
            .with(Shape::Sphere { radius: 1.0 }, around, black())
            .build();
        let (seen, ledger) = follow(&scene, Aim::Everything, &Photons::all(20_000, 3, 8));
        let truth = 3.0 * PI * area;
        assert_eq!(
            seen.power(|s, _, _| s == 0),
            Rgb::BLACK,
            "{shape:?}: lights itself"
        );
        let walls = seen.power(|s, front, _| s == 1 && !front).g;
        assert!(
            (walls / truth - 1.0).abs() < 1e-6,
            "{shape:?}: {walls} {truth}"
        );
        assert_eq!(ledger.escaped.quanta(), [0; 3]);
    }
}

#[test]
fn parallel_squares_exchange_their_form_factor() {
    // Howell's catalogue C-11: aligned unit squares at distance 1 have the form factor 0.199825.
    let lamp = black().emitting(Rgb::BLACK, gray(1.0 / PI));
    let scene = Room::default()
        .with(square(0.5), DAffine3::IDENTITY, black())
        .with(square(0.5), at(0.0, 0.0, 1.0), lamp)
        .build();
    assert_mean("squares", &arriving(&scene, 0, true, 20_000), 0.199_825, 1);
}

/// A room with every kind of surface: matt, leaf, mirror, glass that absorbs, pane, alpha.
fn full_room() -> Scene {
    let colour = Rgb::new(0.7, 0.4, 0.2);
    let glass = Material::glass(1.5, 0.0, Rgb::new(0.1, 0.3, 0.9));
    Room::default()
        .with(
            Shape::Sphere { radius: 5.0 },
            DAffine3::IDENTITY,
            Material::lambert(colour),
        )
        .with(
            square(0.8),
            at(0.0, 0.0, -1.0),
            Material::leaf(colour * 0.6, colour * 0.4),
        )
        .with(Shape::Sphere { radius: 0.5 }, at(1.0, 0.0, 0.0), glass)
        .with(
            Shape::Sphere { radius: 0.5 },
            at(-1.0, 0.0, 0.0),
            Material::mirror(colour),
        )
        .with(
            square(0.6),
            at(0.0, 2.0, 0.0),
            Material::pane(1.5, Rgb::new(0.9, 0.8, 0.7)),
        )
        .with(
            square(0.6),
            at(0.0, -2.0, 0.0),
            Material::lambert(colour).with_alpha(0.5),
        )
        .with(
            square(0.2),
            at(0.0, 0.0, 3.0),
            black().emitting(gray(1.0), gray(2.0)),
        )
        .lit_by(Light::point(
            DVec3::new(0.0, 0.3, 2.0),
            Rgb::new(10.0, 5.0, 1.0),
        ))
        .build()
}

#[test]
fn c43_emitted_is_absorbed_escaped_and_lost_to_the_last_quantum() {
    let scene = full_room();
    for max_depth in [0, 1, 5, 64] {
        let (_, books) = follow(&scene, Aim::Everything, &Photons::all(20_000, 7, max_depth));
        assert_eq!(books.imbalance(), [0; 3], "depth {max_depth}");
        let watts = |account| books.watts(account).to_array();
        let emitted = watts(&books.emitted);
        let (absorbed, lost) = (watts(&books.absorbed), watts(&books.lost));
        for channel in 0..3 {
            // Nothing leaves a closed room, and chance takes no more than it gives.
            let share = absorbed[channel] / emitted[channel];
            let rest = lost[channel] / emitted[channel];
            assert!(
                (share + rest - 1.0).abs() < 0.02,
                "{max_depth} {channel}: {share} {rest}"
            );
        }
        assert_eq!(books.escaped.quanta(), [0; 3]);
        assert!(max_depth < 64 || lost[0] < 1e-3 * emitted[0]);
    }
    let power = Emission::new(&scene, Aim::Everything).power();
    let truth = 10.0 + 3.0 * PI * 0.16;
    assert!((power.r / truth - 1.0).abs() < 1e-12, "{power:?} {truth}");
}

#[test]
fn chance_takes_what_it_gives() {
    let scene = full_room();
    let shares = runs(40, |seed| {
        let (_, books) = follow(&scene, Aim::Everything, &Photons::all(4000, seed, 64));
        books.watts(&books.absorbed).g + books.watts(&books.lost).g
    });
    assert_mean("kept", &shares, 5.0 + 3.0 * PI * 0.16, 1);
}

#[test]
fn light_in_an_integrating_sphere_is_that_of_the_series() {
    // All light that ever arrives at the wall of a sphere: Φ / (1 - ρ).
    for albedo in [0.5, 0.9] {
        let scene = Room::default()
            .with(
                Shape::Sphere { radius: 2.0 },
                DAffine3::IDENTITY,
                Material::lambert(gray(albedo)),
            )
            .lit_by(Light::point(DVec3::new(0.5, 0.0, 0.0), gray(6.0)))
            .build();
        let seen = arriving(&scene, 0, false, 6000);
        assert_mean("sphere", &seen, 6.0 / (1.0 - albedo), 2);
    }
}

/// C-59.
#[test]
fn photons_are_the_same_on_any_number_of_threads() {
    let scene = full_room();
    let photons = Photons::all(3 * BLOCK + 100, 5, 64);
    let on = |threads| {
        let pool = rayon::ThreadPoolBuilder::new()
            .num_threads(threads)
            .build()
            .unwrap();
        pool.install(|| follow(&scene, Aim::Everything, &photons))
    };
    let one = on(1);
    assert!(one.0.0.len() > 10_000);
    assert!(one == on(2) && one == on(3));
    // In two parts: the same photons.
    let part = |range| {
        follow(
            &scene,
            Aim::Everything,
            &Photons {
                range,
                ..photons.clone()
            },
        )
    };
    let (low, high) = (part(0..BLOCK), part(BLOCK..photons.n));
    assert_eq!([low.0.0, high.0.0].concat(), one.0.0);
}

/// C-64.
#[test]
fn a_cancelled_trace_stops() {
    let scene = full_room();
    let cancel = CancelToken::default();
    cancel.cancel();
    let context = RenderContext {
        seed: 0,
        cancel: &cancel,
        progress: &|_| {},
    };
    let emission = Emission::new(&scene, Aim::Everything);
    let photons = Photons::all(1 << 40, 1, 64);
    let result = trace(&emission, &photons, &context, Arrivals::default, |_| {});
    assert!(matches!(result, Err(RenderError::Cancelled { .. })));
}
