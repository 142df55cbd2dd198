//! Final gather: what it shows is what closed forms and the path tracer say, corner or leaf, whoever asks first.

#![allow(clippy::unwrap_used, reason = "a test may panic")]

#[path = "support/room.rs"]
#[allow(dead_code, reason = "other tests use the rest")]
mod room;

use glam::{DAffine3, DQuat, DVec3};
use rayon::prelude::*;
use room::{Room, at, gray, square};
use std::f64::consts::PI;
use understory::color::Rgb;
use understory::geometry::Shape;
use understory::integrator::radiosity::Solver;
use understory::integrator::{
    CancelToken, Integrator, Path, PhotonMapping, RadianceEstimator, Radiosity, RayCounts,
    RenderContext,
};
use understory::light::{Environment, Light, Sky};
use understory::material::Material;
use understory::math::angle::Angle;
use understory::math::{Ray, rng};
use understory::sampler::{Sampler, SamplerKind};
use understory::scene::Scene;

/// So many photons for each map, gathered with so many rays.
fn gathered(photons: [u64; 2], rays: u32) -> PhotonMapping {
    PhotonMapping {
        global_photons: photons[0],
        caustic_photons: Some(photons[1]),
        final_gather: rays,
        ..PhotonMapping::default()
    }
}

/// Radiosity of patches a 32nd of the scene wide, gathered with so many rays.
fn coarse(rays: u32) -> Radiosity {
    Radiosity {
        solver: Some(Solver::Gather),
        hemicube_pixels: 24,
        subdivision_depth: 0,
        final_gather: rays,
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

/// Mean green radiance along a ray over samples.
fn seen(estimator: &dyn RadianceEstimator, ray: Ray, n: u32) -> f64 {
    let samples = (0..n).map(|index| {
        let [x, y, z] = ray.origin.to_array().map(f64::to_bits);
        let stream = rng::hash(&[x, y, z, ray.direction.x.to_bits()]);
        let mut sampler = Sampler::new(SamplerKind::OwenSobol, stream, index);
        estimator.incident_radiance(&ray, &mut sampler, &mut RayCounts::default())
    });
    samples.sum::<Rgb>().g / f64::from(n)
}

/// The same over a grid of n × n points that are `from(u, v)` in direction `w`.
fn mean_over(
    estimator: &dyn RadianceEstimator,
    (n, samples): (u32, u32),
    from: impl Fn(f64, f64) -> DVec3 + Sync,
    w: DVec3,
) -> f64 {
    let value = |i: u32| {
        let (u, v) = (f64::from(i % n) + 0.5, f64::from(i / n) + 0.5);
        let point = from(u / f64::from(n), v / f64::from(n));
        seen(estimator, Ray::new(point, w), samples)
    };
    let all: Vec<f64> = (0..n * n).into_par_iter().map(value).collect();
    all.iter().sum::<f64>() / f64::from(n * n)
}

/// The six faces of a cube from -1 to 1 that face inward, each with this material.
fn closed_box(material: &Material) -> Room {
    let turns = [
        DQuat::IDENTITY,
        DQuat::from_rotation_x(PI),
        DQuat::from_rotation_x(PI / 2.0),
        DQuat::from_rotation_x(-PI / 2.0),
        DQuat::from_rotation_y(PI / 2.0),
        DQuat::from_rotation_y(-PI / 2.0),
    ];
    turns.into_iter().fold(Room::default(), |room, turn| {
        let place = DAffine3::from_quat(turn) * at(0.0, 0.0, -1.0);
        room.with(square(1.0), place, material.clone())
    })
}

#[test]
fn a_shining_closed_box_is_as_bright_in_its_corners_as_anywhere() {
    // L = L_e / (1 - ρ) everywhere; the direct part is ρ L_e.
    let albedo = 0.6;
    let wall = Material::lambert(gray(albedo)).emitting(gray(1.0), Rgb::BLACK);
    let scene = closed_box(&wall).build();
    let truth = 1.0 / (1.0 - albedo);
    let photons = gathered([200_000, 0], 256);
    for method in [&photons as &dyn Integrator, &coarse(256)] {
        let estimator = prepared(method, &scene);
        // The middle of the floor, along an edge, into a corner.
        for (x, y, tolerance) in [(0.0, 0.0, 0.02), (0.985, 0.0, 0.03), (0.985, 0.985, 0.03)] {
            let from = |u: f64, v: f64| DVec3::new(x + 0.01 * u, y + 0.01 * v, 0.0);
            let found = mean_over(&*estimator, (8, 16), from, DVec3::NEG_Z);
            assert!(
                (found / truth - 1.0).abs() < tolerance,
                "{x} {y}: {found} {truth}"
            );
        }
    }
}

#[test]
fn a_lamp_in_a_white_ball_gives_even_light() {
    // L = Φ ρ / (π A (1 - ρ)), at every point and not only in the mean: without gathering, single points differ by 10 %.
    let albedo = 0.8;
    let scene = Room::default()
        .with(
            Shape::Sphere { radius: 2.0 },
            DAffine3::IDENTITY,
            Material::lambert(gray(albedo)),
        )
        .lit_by(Light::point(DVec3::ZERO, gray(6.0)))
        .build();
    let truth = 6.0 * albedo / (PI * 16.0 * PI * (1.0 - albedo));
    let estimator = prepared(&gathered([100_000, 0], 256), &scene);
    let mut squares = 0.0;
    for i in 0..200 {
        let u = glam::DVec2::new((f64::from(i) + 0.5) / 200.0, f64::from(i) * 0.618 % 1.0);
        let w = understory::math::warp::sphere(u);
        squares += (seen(&*estimator, Ray::new(DVec3::ZERO, w), 4) / truth - 1.0).powi(2) / 200.0;
    }
    assert!(squares.sqrt() < 0.02, "{}", squares.sqrt());
}

/// Two rooms with a doorway between them; the lamp in the first does not shine through it. A wall stands on the floor of the second.
fn two_rooms() -> Scene {
    let white = Material::lambert(gray(0.7));
    let lamp = Light::spot(
        DVec3::new(0.5, -0.7, 0.6),
        DVec3::NEG_Z,
        Angle::deg(50.0),
        Angle::deg(60.0),
        gray(100.0),
    );
    let wall = |half_x: f64, half_z: f64, to| {
        let shape = Shape::Parallelogram {
            corner: DVec3::new(-half_x, 0.0, -half_z),
            edge_u: DVec3::X * (2.0 * half_x),
            edge_v: DVec3::Z * (2.0 * half_z),
        };
        (shape, to)
    };
    let (left, left_at) = wall(0.8, 1.0, at(-0.2, 0.0, 0.0));
    let (low, low_at) = wall(0.6, 0.25, at(-0.2, 0.6, -0.75));
    closed_box(&white)
        .with(left, left_at, white.clone())
        .with(low, low_at, Material::lambert(gray(0.3)))
        .lit_by(lamp)
        .build()
}

#[test]
fn rooms_lit_through_a_door_agree_with_the_path_tracer_object_by_object() {
    let scene = two_rooms();
    let (photon, path) = (
        prepared(&gathered([400_000, 0], 256), &scene),
        prepared(&Path::default(), &scene),
    );
    // Floor, back wall, ceiling, the low wall's two sides and strips of floor at its foot, narrower than the kernel.
    let views: [(&str, DVec3, DVec3, DVec3, DVec3); 6] = [
        (
            "floor",
            DVec3::new(-0.9, 0.1, -0.9),
            DVec3::X * 1.8,
            DVec3::Y * 0.3,
            DVec3::NEG_Z,
        ),
        (
            "back wall",
            DVec3::new(-0.9, 0.9, -0.4),
            DVec3::X * 1.8,
            DVec3::Z * 1.3,
            DVec3::Y,
        ),
        (
            "ceiling",
            DVec3::new(-0.9, 0.1, 0.9),
            DVec3::X * 1.8,
            DVec3::Y * 0.8,
            DVec3::Z,
        ),
        (
            "its front",
            DVec3::new(-0.7, 0.5, -0.95),
            DVec3::X,
            DVec3::Z * 0.4,
            DVec3::Y,
        ),
        (
            "before it",
            DVec3::new(-0.7, 0.57, -0.95),
            DVec3::X,
            DVec3::Y * 0.02,
            DVec3::NEG_Z,
        ),
        (
            "behind it",
            DVec3::new(-0.7, 0.61, -0.95),
            DVec3::X,
            DVec3::Y * 0.02,
            DVec3::NEG_Z,
        ),
    ];
    for (name, corner, along, across, w) in views {
        let from = |u: f64, v: f64| corner + along * u + across * v;
        // 400 path samples at 144 places: about 1 % of noise.
        let found = mean_over(&*photon, (12, 8), from, w);
        let truth = mean_over(&*path, (12, 400), from, w);
        assert!(
            (found / truth - 1.0).abs() < 0.04,
            "{name}: {found} {truth}"
        );
    }
}

/// A closed room of patches 0.11 m wide with a block in it, region by region to 5 %, and the mean of all to 2 %. Noise is about 0.7 % of
/// a region and a third of that of all: chance fails it less than once in 10⁴ seeds. Without a gather the strips at the foot of the block,
/// narrower than patches, are off by up to a third.
#[test]
fn a_room_with_a_block_agrees_with_the_path_tracer_region_by_region_over_radiosity() {
    let white = || Material::lambert(gray(0.7));
    let block = Shape::Box {
        half_x: 0.3,
        half_y: 0.3,
        length: 0.7,
    };
    let scene = closed_box(&white())
        .with(block, at(0.25, 0.2, -1.0), white())
        .lit_by(Light::point(DVec3::new(-0.5, -0.4, 0.5), gray(10.0)))
        .build();
    let [plain, radiosity] = [0, 256].map(|rays| prepared(&coarse(rays), &scene));
    let path = prepared(&Path::default(), &scene);
    // Corner, along, across, direction. In the shadow behind the block: strips at its foot, and wider floor; what it is seen to be.
    let (x, y, z) = (DVec3::X, DVec3::Y, DVec3::Z);
    let views: [(&str, DVec3, DVec3, DVec3, DVec3); 7] = [
        (
            "foot behind",
            DVec3::new(0.0, 0.505, -0.9),
            x * 0.5,
            y * 0.03,
            -z,
        ),
        (
            "foot beside",
            DVec3::new(0.555, 0.0, -0.9),
            x * 0.03,
            y * 0.4,
            -z,
        ),
        (
            "foot before",
            DVec3::new(0.0, -0.13, -0.9),
            x * 0.5,
            y * 0.025,
            -z,
        ),
        ("floor", DVec3::new(-0.9, -0.9, -0.5), x * 0.8, y * 1.8, -z),
        (
            "back of block",
            DVec3::new(0.0, 0.55, -0.95),
            x * 0.5,
            z * 0.6,
            -y,
        ),
        ("ceiling", DVec3::new(-0.9, -0.9, 0.9), x * 1.8, y * 1.8, z),
        ("wall", DVec3::new(0.9, -0.9, -0.9), y * 1.8, z * 1.8, x),
    ];
    let off = |found: f64, truth: f64| found / truth - 1.0;
    let mut told = Vec::new();
    let mut sums = [0.0; 2];
    for (name, corner, along, across, w) in views {
        let from = |u: f64, v: f64| corner + along * u + across * v;
        let truth = mean_over(&*path, (16, 256), from, w);
        let found = mean_over(&*radiosity, (16, 8), from, w);
        let without = mean_over(&*plain, (16, 8), from, w);
        told.push((name, off(found, truth), off(without, truth)));
        sums[0] += found;
        sums[1] += truth;
    }
    let is_right = |(_, with, _): &(&str, f64, f64)| with.abs() < 0.05;
    assert!(told.iter().all(is_right), "{told:?}");
    assert!(off(sums[0], sums[1]).abs() < 0.02, "{told:?}");
    let is_seen = |(_, _, without): &(&str, f64, f64)| without.abs() > 0.2;
    assert!(told.iter().any(is_seen), "nothing to be seen: {told:?}");
}

#[test]
fn light_does_not_leave_a_closed_room() {
    let scene = closed_box(&Material::lambert(gray(0.8)))
        .with(
            square(5.0),
            at(0.0, 0.0, -1.0),
            Material::lambert(gray(0.8)),
        )
        .lit_by(Light::point(DVec3::new(0.2, 0.0, 0.0), gray(10.0)))
        .build();
    let estimator = prepared(&gathered([50_000, 0], 64), &scene);
    // The ground outside, on the very plane of the room's floor, beside its thin walls; and the roof.
    for (x, z) in [(1.001, 0.0), (1.05, 0.0), (2.0, 0.0), (0.5, 2.0)] {
        let ray = Ray::new(DVec3::new(x, 0.1, z), DVec3::NEG_Z);
        assert_eq!(seen(&*estimator, ray, 4), 0.0, "{x}");
    }
    let inside = Ray::new(DVec3::new(0.9, 0.1, 0.0), DVec3::NEG_Z);
    assert!(seen(&*estimator, inside, 4) > 0.1);
}

#[test]
fn leaves_smaller_than_the_kernel_show_how_light_lies_on_them() {
    // A bright wall beside a leaf: the half that is nearer to it gets more, on both sides of the leaf; the map has one value.
    let leaf = Material::leaf(gray(0.4), gray(0.3));
    let upright = at(0.35, 0.0, 0.3) * DAffine3::from_rotation_y(-PI / 2.0);
    let scene = Room::default()
        .with(square(0.2), DAffine3::IDENTITY, leaf)
        .with(square(0.3), upright, Material::lambert(gray(0.8)))
        .lit_by(Light::spot(
            DVec3::new(-1.0, 0.0, 0.5),
            DVec3::new(1.35, 0.0, -0.2).normalize(),
            Angle::deg(8.0),
            Angle::deg(9.0),
            gray(100.0),
        ))
        .build();
    let method = PhotonMapping {
        photon_area: Some(0.5),
        ..gathered([100_000, 0], 128)
    };
    let (photon, path) = (
        prepared(&method, &scene),
        prepared(&Path::default(), &scene),
    );
    for w in [DVec3::Z, DVec3::NEG_Z] {
        for x in [-0.18, 0.02, 0.14] {
            let from = |u: f64, v: f64| DVec3::new(x + 0.04 * u, 0.3 * v - 0.15, 0.0) - w * 0.01;
            let found = mean_over(&*photon, (8, 512), from, w);
            let truth = mean_over(&*path, (8, 1024), from, w);
            assert!(
                (found / truth - 1.0).abs() < 0.04,
                "{w} {x}: {found} {truth}"
            );
        }
    }
}

#[test]
fn mirrors_and_glass_throw_light_once() {
    // Above a matt floor a glass ball, which gathers light of the lamp, and a mirror, which shows the floor a lit wall.
    let lamp = Material::lambert(Rgb::BLACK).emitting(gray(40.0), Rgb::BLACK);
    let down = DAffine3::from_rotation_x(PI);
    let wall = |x: f64, turn: f64| at(x, 0.0, 0.8) * DAffine3::from_rotation_y(turn);
    let scene = Room::default()
        .with(
            square(0.8),
            DAffine3::IDENTITY,
            Material::lambert(gray(0.8)),
        )
        .with(
            Shape::Sphere { radius: 0.3 },
            at(0.0, 0.0, 0.5),
            Material::glass(1.5, 0.0, Rgb::BLACK),
        )
        .with(
            square(0.8),
            wall(0.8, -PI / 2.0),
            Material::lambert(gray(0.7)),
        )
        .with(
            square(0.8),
            wall(-0.8, PI / 2.0),
            Material::mirror(gray(0.9)),
        )
        .with(square(0.3), at(0.2, 0.0, 2.0) * down, lamp)
        .build();
    let (photon, path) = (
        prepared(&gathered([200_000, 200_000], 128), &scene),
        prepared(&Path::default(), &scene),
    );
    // Under the ball the caustic's own blur is in both maps: there the light must be what photons alone say.
    let photons = prepared(&gathered([200_000, 200_000], 0), &scene);
    for (low, high, truth) in [
        (-0.75, -0.4, (&path, 200)),
        (-0.3, 0.3, (&photons, 16)),
        (0.4, 0.75, (&path, 200)),
    ] {
        let from = |u: f64, v: f64| DVec3::new(low + u * (high - low), 1.2 * v - 0.6, 0.1);
        let found = mean_over(&*photon, (16, 16), from, DVec3::NEG_Z);
        let truth = mean_over(&**truth.0, (16, truth.1), from, DVec3::NEG_Z);
        assert!((found / truth - 1.0).abs() < 0.03, "{low}: {found} {truth}");
    }
}

#[test]
fn without_photons_for_caustics_they_are_not_lost() {
    // The map of all light holds them then, and is asked itself: the same light as without rays.
    let scene = Room::default()
        .with(
            square(0.8),
            DAffine3::IDENTITY,
            Material::lambert(gray(0.8)),
        )
        .with(
            Shape::Sphere { radius: 0.3 },
            at(0.0, 0.0, 0.5),
            Material::glass(1.5, 0.0, Rgb::BLACK),
        )
        .lit_by(Light::point(DVec3::Z * 2.0, gray(10.0)))
        .build();
    let light = |rays| {
        let estimator = prepared(&gathered([50_000, 0], rays), &scene);
        let from = |u: f64, v: f64| DVec3::new(0.2 * u - 0.1, 0.2 * v - 0.1, 0.1);
        mean_over(&*estimator, (8, 1), from, DVec3::NEG_Z)
    };
    let without = light(0);
    assert!(without > 0.0);
    assert_eq!(light(64), without);
}

#[test]
fn leaves_and_ground_under_a_sky_agree_with_the_path_tracer() {
    // The land below the horizon shines at what hangs over the edge of the ground.
    let sky = Environment {
        sky: Sky::Overcast {
            zenith: gray(3.0),
            ground_albedo: gray(0.5),
        },
        sun: None,
    };
    let scene = Room::default()
        .with(
            square(1.0),
            DAffine3::IDENTITY,
            Material::lambert(gray(0.5)),
        )
        .with(
            square(0.5),
            at(0.0, 0.0, 0.5),
            Material::leaf(gray(0.3), gray(0.4)),
        )
        .with(square(0.3), at(1.5, 0.0, 0.5), Material::lambert(gray(0.6)))
        .with(
            Shape::Sphere { radius: 0.3 },
            at(-0.7, 0.0, 0.3),
            Material::lambert(gray(0.7)),
        )
        .under(sky)
        .build();
    let methods = [
        prepared(&gathered([200_000, 0], 128), &scene),
        prepared(&coarse(128), &scene),
    ];
    let path = prepared(&Path::default(), &scene);
    for (name, eye, w) in [
        ("leaf from below", DVec3::new(-0.1, 0.0, 0.2), DVec3::Z),
        ("leaf from above", DVec3::new(0.2, 0.1, 2.0), DVec3::NEG_Z),
        ("over the land", DVec3::new(1.5, 0.0, 0.2), DVec3::Z),
        (
            "ground under the leaf",
            DVec3::new(0.1, 0.0, 0.3),
            DVec3::NEG_Z,
        ),
        ("ball", DVec3::new(-0.7, -2.0, 0.2), DVec3::Y),
    ] {
        let (side, up) = (DVec3::X * 0.2, w.cross(DVec3::X) * 0.2);
        let from = |u: f64, v: f64| eye + side * (u - 0.5) + up * (v - 0.5);
        let truth = mean_over(&*path, (6, 1024), from, w);
        for (method, over) in methods.iter().zip(["photons", "radiosity"]) {
            let found = mean_over(&**method, (6, 64), from, w);
            assert!(
                (found / truth - 1.0).abs() < 0.03,
                "{name}, {over}: {found} {truth}"
            );
        }
    }
}

#[test]
fn what_is_seen_depends_neither_on_threads_nor_on_what_was_seen_before() {
    let scene = two_rooms();
    let rays: Vec<Ray> = (0..400)
        .map(|i| {
            let (x, y) = (f64::from(i % 20) / 20.0, f64::from(i / 20) / 20.0);
            let eye = DVec3::new(-0.5, 0.3, 0.3);
            let target = DVec3::new(1.8 * x - 0.9, 0.95, 1.8 * y - 0.99);
            Ray::new(eye, (target - eye).normalize())
        })
        .collect();
    let photons = gathered([20_000, 0], 32);
    for method in [&photons as &(dyn Integrator + Sync), &coarse(32)] {
        does_not_depend_on_order(&scene, method, &rays);
    }
}

fn does_not_depend_on_order(scene: &Scene, method: &(dyn Integrator + Sync), rays: &[Ray]) {
    let on = |threads, backwards: bool| {
        let pool = rayon::ThreadPoolBuilder::new()
            .num_threads(threads)
            .build()
            .unwrap();
        pool.install(|| {
            let estimator = prepared(method, scene);
            if backwards {
                for ray in rays.iter().rev() {
                    seen(&*estimator, *ray, 1);
                }
            }
            let all: Vec<f64> = rays
                .par_iter()
                .map(|ray| seen(&*estimator, *ray, 2))
                .collect();
            all
        })
    };
    let one = on(1, false);
    assert!(one.iter().all(|light| *light > 0.0));
    assert!(one == on(3, false) && one == on(8, false));
    assert!(one == on(1, true));
}

#[test]
fn no_photons_and_one_ray_are_enough_for_one_bounce() {
    let scene = two_rooms();
    let one_bounce = Path {
        max_depth: Some(2),
        ..Path::default()
    };
    let of = |method: &dyn Integrator, samples| {
        let from = |u: f64, v: f64| DVec3::new(0.4 + 0.4 * u, -0.9 + 0.4 * v, 0.5);
        mean_over(&*prepared(method, &scene), (6, samples), from, DVec3::Z)
    };
    let (found, truth) = (of(&gathered([0, 0], 1), 256), of(&one_bounce, 256));
    assert!((found / truth - 1.0).abs() < 0.03, "{found} {truth}");
}

/// Of 60 leaves in a closed white box with a lamp, what is seen from above and from below, leaves and walls, both sides: by reflection
/// and by transmission. 256 paths at 400 places: about 0.5 % of noise; six times that would be 3 %.
#[test]
fn leaves_in_a_box_pass_on_all_their_light_over_radiosity() {
    let number = |k: u64, what: u64| rng::unit_f64(rng::hash(&[k, what])) - 0.5;
    let mut room = closed_box(&Material::lambert(gray(0.5)));
    for k in 0..60 {
        let turns = [3, 4, 5].map(|what| number(k, what));
        let turn = DQuat::from_euler(glam::EulerRot::XYZ, turns[0], turns[1], turns[2]);
        let place = DVec3::new(number(k, 0), number(k, 1), 0.6 * number(k, 2)) * 1.6;
        let place = DAffine3::from_rotation_translation(turn, place);
        room = room.with(square(0.12), place, Material::leaf(gray(0.45), gray(0.4)));
    }
    let lamp = Light::point(DVec3::new(0.0, 0.0, 0.8), gray(10.0));
    let scene = room.lit_by(lamp).build();
    let radiosity = prepared(&coarse(128), &scene);
    let path = prepared(&Path::default(), &scene);
    for (z, w) in [(0.9, DVec3::NEG_Z), (-0.9, DVec3::Z)] {
        let from = |u: f64, v: f64| DVec3::new(1.4 * u - 0.7, 1.4 * v - 0.7, z);
        let found = mean_over(&*radiosity, (20, 16), from, w);
        let truth = mean_over(&*path, (20, 256), from, w);
        assert!((found / truth - 1.0).abs() < 0.03, "{w}: {found} {truth}");
    }
}

/// What sources cannot be asked for counts in a gather, and once: an endless plane that shines covers the half-space, so the light is ρ L.
#[test]
fn what_sources_are_not_asked_for_is_gathered_over_radiosity() {
    let shining = Material::lambert(Rgb::BLACK).emitting(gray(2.0), gray(2.0));
    let scene = Room::default()
        .with(
            square(1.0),
            DAffine3::IDENTITY,
            Material::lambert(gray(0.5)),
        )
        .with(Shape::Plane, at(0.0, 0.0, 2.0), shining)
        .build();
    for rays in [0, 64] {
        let estimator = prepared(&coarse(rays), &scene);
        let from = |u: f64, v: f64| DVec3::new(u - 0.5, v - 0.5, 0.5);
        let found = mean_over(&*estimator, (8, 16), from, DVec3::NEG_Z);
        assert!((found - 1.0).abs() < 0.03, "{rays}: {found}");
    }
}

/// A floor beside a mirror under a lamp, with a wall across: light of the lamp by the mirror is found by rays of the gather, light of the
/// wall by the mirror as well. 400 paths at 256 places: 0.5 %.
#[test]
fn mirrors_throw_light_once_over_radiosity() {
    let lamp = Material::lambert(Rgb::BLACK).emitting(gray(40.0), Rgb::BLACK);
    let down = DAffine3::from_rotation_x(PI);
    let wall = |x: f64, turn: f64| at(x, 0.0, 0.8) * DAffine3::from_rotation_y(turn);
    let scene = Room::default()
        .with(
            square(0.8),
            DAffine3::IDENTITY,
            Material::lambert(gray(0.8)),
        )
        .with(
            square(0.8),
            wall(0.8, -PI / 2.0),
            Material::lambert(gray(0.7)),
        )
        .with(
            square(0.8),
            wall(-0.8, PI / 2.0),
            Material::mirror(gray(0.9)),
        )
        .with(square(0.3), at(0.2, 0.0, 2.0) * down, lamp)
        .build();
    let radiosity = prepared(&coarse(256), &scene);
    let path = prepared(&Path::default(), &scene);
    for (low, high) in [(-0.75, -0.4), (-0.3, 0.3), (0.4, 0.75)] {
        let from = |u: f64, v: f64| DVec3::new(low + u * (high - low), 1.2 * v - 0.6, 0.1);
        let found = mean_over(&*radiosity, (16, 32), from, DVec3::NEG_Z);
        let truth = mean_over(&*path, (16, 400), from, DVec3::NEG_Z);
        assert!((found / truth - 1.0).abs() < 0.03, "{low}: {found} {truth}");
    }
}
