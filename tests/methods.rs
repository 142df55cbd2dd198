//! What every method answers where there is nothing to see, nothing that shines, too much or too little of it, and where the
//! camera is where none should be: cases C-53, C-54 and C-62 of the list of tests at the extremes.

#![allow(clippy::unwrap_used, reason = "a test may panic")]

#[path = "support/room.rs"]
#[allow(dead_code, reason = "other tests use the rest")]
mod room;

use glam::{DAffine3, DVec3};
use room::{Room, at, even_sky, gray, square};
use std::f64::consts::FRAC_1_PI;
use std::sync::Arc;
use understory::color::Rgb;
use understory::geometry::{Shape, TriangleMesh};
use understory::integrator::{
    CancelToken, Integrator, Path, PhotonMapping, RayCounts, Raytracer, RenderContext,
};
use understory::light::Light;
use understory::material::Material;
use understory::math::{Ray, rng, warp};
use understory::sampler::{Sampler, SamplerKind};
use understory::scene::Scene;

/// Every method that makes pictures.
fn methods() -> [(&'static str, Box<dyn Integrator>); 3] {
    let photons = PhotonMapping {
        global_photons: 2000,
        ..PhotonMapping::default()
    };
    [
        ("path", Box::new(Path::default())),
        ("raytracer", Box::new(Raytracer::default())),
        ("photon", Box::new(photons)),
    ]
}

/// What a method sees along the rays, four samples each, and the most queries of a sample.
fn look(scene: &Scene, method: &dyn Integrator, rays: &[Ray]) -> (Vec<Rgb>, u64) {
    let cancel = CancelToken::default();
    let context = RenderContext {
        seed: 5,
        cancel: &cancel,
        progress: &|_| {},
    };
    let estimator = method.prepare(scene, &context).unwrap();
    let mut most = 0;
    let seen = (0_u64..).zip(rays).map(|(stream, ray)| {
        let samples = (0..4).map(|index| {
            let mut sampler = Sampler::new(SamplerKind::OwenSobol, stream, index);
            let mut count = RayCounts::default();
            let seen = estimator.incident_radiance(ray, &mut sampler, &mut count);
            most = most.max(count.total());
            seen
        });
        samples.sum::<Rgb>() / 4.0
    });
    (seen.collect(), most)
}

/// In all directions from a point.
fn around(point: DVec3, n: u64) -> Vec<Ray> {
    let unit = |i, k| rng::unit_f64(rng::hash(&[17, i, k]));
    let ray = |i| {
        Ray::new(
            point,
            warp::sphere(glam::DVec2::new(unit(i, 0), unit(i, 1))),
        )
    };
    (0..n).map(ray).collect()
}

/// C-54: an empty scene, only lamps, only surfaces: black, or the sky as it is, after a query or two.
#[test]
fn where_nothing_is_or_nothing_shines_it_is_black() {
    let lamps = || {
        Room::default()
            .lit_by(Light::point(DVec3::Z, gray(100.0)))
            .lit_by(Light::point(DVec3::X, Rgb::BLACK))
    };
    let floor = |room: Room| room.with(square(9.0), at(0., 0., -1.), Material::lambert(gray(0.5)));
    let glass = |room: Room| {
        room.with(
            Shape::Sphere { radius: 0.5 },
            at(0., 0., 1.),
            Material::glass(1.5, 0.0, Rgb::BLACK),
        )
    };
    let dark_lamp = Light::point(DVec3::Z, Rgb::BLACK);
    let cases = [
        ("nothing", Room::default(), 0.0),
        ("a sky", Room::default().under(even_sky(0.75)), 0.75),
        ("only lamps", lamps(), 0.0),
        ("lamps and a sky", lamps().under(even_sky(0.75)), 0.75),
        ("only surfaces", glass(floor(Room::default())), 0.0),
        (
            "a lamp without power",
            floor(Room::default()).lit_by(dark_lamp),
            0.0,
        ),
        (
            "a sky without light",
            floor(Room::default()).under(even_sky(0.0)),
            0.0,
        ),
    ];
    let rays = around(DVec3::ZERO, 40);
    for (case, room, expected) in cases {
        let scene = room.build();
        for (name, method) in methods() {
            let (seen, most) = look(&scene, &*method, &rays);
            assert!(
                seen.iter().all(|&l| l == gray(expected)),
                "{name}, {case}: {seen:?}"
            );
            assert!(
                most <= if scene.bounds().is_empty() { 2 } else { 400 },
                "{name}, {case}: {most}"
            );
        }
    }
}

/// C-53: the camera inside a body that no light enters, inside a lamp, and inside glass.
#[test]
fn cameras_inside_bodies_see_what_is_there() {
    let ball = |material| {
        Room::default()
            .with(Shape::Sphere { radius: 1.0 }, at(0., 0., 0.), material)
            .with(square(5.0), at(0., 0., -1.5), Material::lambert(gray(0.5)))
            .lit_by(Light::point(DVec3::Z * 4.0, gray(100.0)))
            .under(even_sky(1.0))
            .build()
    };
    let closed = ball(Material::lambert(gray(0.8)));
    let lamp = ball(Material::lambert(Rgb::BLACK).emitting(gray(3.0), gray(5.0)));
    let rays: Vec<Ray> = [DVec3::ZERO, DVec3::new(0.3, -0.2, 0.999 - 0.1)]
        .into_iter()
        .flat_map(|from| around(from, 20))
        .collect();
    for (name, method) in methods() {
        let (seen, _) = look(&closed, &*method, &rays);
        assert!(seen.iter().all(|&l| l == Rgb::BLACK), "{name}: {seen:?}");
        let (seen, _) = look(&lamp, &*method, &rays);
        assert!(seen.iter().all(|&l| l == gray(5.0)), "{name}: {seen:?}");
    }
    // In the middle of glass that absorbs σ per metre: radiance is n² times what comes in, less what the glass keeps.
    let (n, sigma) = (1.5_f64, 0.7_f64);
    let scene = Room::default()
        .with(
            Shape::Sphere { radius: 1.0 },
            at(0., 0., 0.),
            Material::glass(n, 0.0, gray(sigma)),
        )
        .under(even_sky(1.0))
        .build();
    let (once, r) = ((-sigma).exp(), ((n - 1.0) / (n + 1.0)).powi(2));
    let expected = n * n * (1.0 - r) * once / (1.0 - r * once * once);
    let rays = around(DVec3::ZERO, 400);
    for (name, method) in methods() {
        let (seen, _) = look(&scene, &*method, &rays);
        let mean = seen.iter().map(|l| l.g).sum::<f64>() / seen.len() as f64;
        // 1600 paths, of which one in 25 is mirrored: standard error 0.4 %.
        assert!(
            (mean / expected - 1.0).abs() < 0.02,
            "{name}: {mean} instead of {expected}"
        );
    }
}

/// An octahedron that pretends to be a ball.
fn smooth_octahedron() -> Shape {
    let axes = DVec3::AXES;
    let positions: Vec<DVec3> = axes.into_iter().chain(axes.map(|axis| -axis)).collect();
    let triangles = (0..8_u32).map(|k| {
        let corner = |axis: u32| axis + 3 * (k >> axis & 1);
        let flips = (k & 1) + (k >> 1 & 1) + (k >> 2 & 1);
        let [a, b, c] = [corner(0), corner(1), corner(2)];
        if flips % 2 == 0 { [a, b, c] } else { [a, c, b] }
    });
    Shape::Mesh(Arc::new(TriangleMesh {
        triangles: triangles.collect(),
        normals: positions.clone(),
        positions,
        uvs: vec![],
    }))
}

/// C-53: where the smoothed surface is turned to the lamp and the true one is not, or the other way round: no NaN, no light
/// below 0, none on what is turned away, and nowhere more than a surface that faces the lamp would send.
#[test]
fn the_terminator_of_smoothed_bodies_is_dark_and_finite() {
    let (position, power, rho) = (DVec3::new(3.0, 0.4, 0.3), 100.0, 0.8);
    let scene = Room::default()
        .with(
            smooth_octahedron(),
            DAffine3::IDENTITY,
            Material::lambert(gray(rho)),
        )
        .lit_by(Light::point(position, gray(power)))
        .build();
    let inward = |ray: &Ray| Ray::new(ray.direction * 3.0, -ray.direction);
    let rays: Vec<Ray> = around(DVec3::ZERO, 2000).iter().map(inward).collect();
    for (name, method) in methods() {
        let (seen, _) = look(&scene, &*method, &rays);
        let (mut lit, mut dark) = (0, 0);
        for (ray, &light) in rays.iter().zip(&seen) {
            let point = scene.surface(ray, &scene.closest(ray).unwrap());
            let to_lamp = position - point.position;
            let distance = to_lamp.length();
            let bound = rho * FRAC_1_PI * power * FRAC_1_PI / (4.0 * distance * distance);
            assert!(light.is_finite(), "{name}: {light:?}");
            assert!(
                (0.0..=bound * (1.0 + 1e-9)).contains(&light.g),
                "{name}: {light:?} {bound}"
            );
            if point.normal_g.dot(to_lamp) <= 0.0 {
                assert_eq!(light, Rgb::BLACK, "{name}");
                dark += 1;
            } else {
                lit += i32::from(light.g > 0.0);
            }
        }
        assert!(lit > 400 && dark > 400, "{name}: {lit} {dark}");
    }
}

/// C-62: light 2¹⁰⁰ times stronger or weaker (about 1e30) is a picture so many times brighter or darker: nothing overflows,
/// nothing is lost, and no method has a threshold in watts.
#[test]
fn light_of_any_strength_makes_the_same_picture() {
    let scene = |power: f64| {
        Room::default()
            .with(square(5.0), at(0., 0., 0.), Material::lambert(gray(0.5)))
            .with(
                Shape::Sphere { radius: 0.5 },
                at(0.6, 0., 0.5),
                Material::leaf(gray(0.4), gray(0.3)),
            )
            .with(
                square(0.4),
                at(-0.8, 0., 1.5),
                Material::lambert(Rgb::BLACK).emitting(gray(power), gray(2.0 * power)),
            )
            .lit_by(Light::point(DVec3::Z * 2.0, gray(30.0 * power)))
            .under(even_sky(0.1 * power))
            .build()
    };
    let rays = around(DVec3::new(0.0, -1.5, 1.0), 60);
    for (name, method) in methods() {
        let (usual, _) = look(&scene(1.0), &*method, &rays);
        assert!(usual.iter().filter(|l| l.g > 0.0).count() > 30, "{name}");
        for exponent in [-100, 100] {
            let factor = 2_f64.powi(exponent);
            let (seen, _) = look(&scene(factor), &*method, &rays);
            for (a, b) in seen.iter().zip(&usual) {
                let (found, expected) = (a.g / factor, b.g);
                let error = (found - expected).abs();
                assert!(
                    error <= 1e-6 * expected,
                    "{name} 2^{exponent}: {found} {expected}"
                );
            }
        }
    }
}
