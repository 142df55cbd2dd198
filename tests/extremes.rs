//! Pictures that must not depend on the unit of length or on where the world lies: cases C-21, C-22, C-29 and C-30 of the list of
//! tests at the extremes. What single rays find there is in `tests/scene` and `tests/watertight.rs`.

#![allow(clippy::unwrap_used, reason = "a test may panic")]

#[path = "support/room.rs"]
#[allow(dead_code, reason = "each test binary uses a part of it")]
mod room;

use glam::{DAffine3, DMat3, DVec3};
use room::{gray, square};
use understory::color::Rgb;
use understory::geometry::Shape;
use understory::integrator::{CancelToken, Integrator, Path, RayCounts, RenderContext};
use understory::light::{Environment, Light, Sky};
use understory::material::Material;
use understory::math::{Ray, rng};
use understory::sampler::{Sampler, SamplerKind};
use understory::scene::Scene;
use understory::scene::description::{
    Group, GroupId, Instance, MaterialId, OrganId, PlacedShape, SceneDescription,
};

/// Pixels along a side.
const SIDE: u64 = 24;
/// Samples of a pixel.
const SAMPLES: u32 = 4;

fn sky(radiance: f64) -> Environment {
    Environment {
        sky: Sky::Uniform(gray(radiance)),
        sun: None,
    }
}

/// A shining ball, a box and leaves that overlap, on soil, below a lamp: everything times `scale`, then moved.
fn world(scale: f64, offset: DVec3) -> Scene {
    let put = |map: DAffine3| {
        let grow = DAffine3::from_scale(DVec3::splat(scale));
        DAffine3::from_translation(offset) * grow * map
    };
    let placed = |shape: Shape, map: DAffine3, material: u32| PlacedShape {
        shape,
        to_group: map,
        material: MaterialId(material),
        organ: OrganId(material),
    };
    let at = |x, y, z| DAffine3::from_translation(DVec3::new(x, y, z));
    let cube = Shape::Box {
        half_x: 0.3,
        half_y: 0.4,
        length: 0.5,
    };
    let leaf = |turn: f64| DAffine3::from_rotation_x(turn) * at(0.0, 0.0, 0.9);
    let plant = Group {
        shapes: (0..20)
            .map(|k| placed(square(0.15), leaf(0.25 * f64::from(k)), 1))
            .collect(),
        instances: vec![],
    };
    let plants = (0..4).map(|k| Instance {
        group: GroupId(0),
        to_group: put(at(f64::from(k) - 1.5, 0.7, 0.2) * DAffine3::from_rotation_z(f64::from(k))),
        organ: OrganId(10 + k),
    });
    let root = Group {
        shapes: vec![
            placed(square(3.0), put(DAffine3::IDENTITY), 0),
            placed(Shape::Sphere { radius: 0.3 }, put(at(1.0, -0.5, 0.6)), 2),
            placed(cube, put(at(-0.8, -0.6, 0.0)), 0),
        ],
        instances: plants.collect(),
    };
    Scene::build(SceneDescription {
        materials: vec![
            Material::lambert(gray(0.4)),
            Material::leaf(gray(0.3), gray(0.4)),
            Material::lambert(gray(0.2)).emitting(gray(3.0), Rgb::BLACK),
        ],
        groups: vec![plant, root],
        root: Some(GroupId(1)),
        // What arrives from a lamp falls with the square of the distance.
        lights: vec![Light::point(
            offset + DVec3::new(0.3, -1.5, 2.0) * scale,
            gray(30.0 * scale * scale),
        )],
        environment: sky(0.5),
        ..SceneDescription::default()
    })
    .unwrap()
}

/// The picture of [`world`], green only.
fn picture(scene: &Scene, scale: f64, offset: DVec3) -> Vec<f64> {
    let cancel = CancelToken::default();
    let context = RenderContext {
        seed: 0,
        cancel: &cancel,
        progress: &|_| {},
    };
    let path = Path::default();
    let estimator = path.prepare(scene, &context).unwrap();
    let eye = DVec3::new(0.5, -4.0, 2.5);
    let pixel = |index: u64| {
        let (x, y) = ((index % SIDE) as f64, (index / SIDE) as f64);
        let target = DVec3::new(x / SIDE as f64 - 0.5, 0.0, 0.6 - y / SIDE as f64) * 3.0;
        let ray = Ray::new(offset + eye * scale, (target - eye).normalize());
        let samples = (0..SAMPLES).map(|sample| {
            let mut sampler = Sampler::new(SamplerKind::OwenSobol, rng::hash(&[index]), sample);
            let mut counts = RayCounts::default();
            estimator
                .incident_radiance(&ray, &mut sampler, &mut counts)
                .g
        });
        samples.sum::<f64>() / f64::from(SAMPLES)
    };
    (0..SIDE * SIDE).map(pixel).collect()
}

/// The mean of (a - b)² / (b² + 1 % of the mean of b²).
fn relative_mse(a: &[f64], b: &[f64]) -> f64 {
    let mean = b.iter().sum::<f64>() / b.len() as f64;
    let floor = 0.01 * mean * mean;
    let errors = a
        .iter()
        .zip(b)
        .map(|(a, b)| (a - b).powi(2) / (b * b + floor));
    errors.sum::<f64>() / b.len() as f64
}

/// C-21: the unit of length does not matter; powers of two change no bit of the picture.
#[test]
fn a_picture_does_not_depend_on_the_unit_of_length() {
    let one = picture(&world(1.0, DVec3::ZERO), 1.0, DVec3::ZERO);
    assert!(one.iter().all(|value| value.is_finite() && *value > 0.0));
    for exponent in [-20, -7, -1, 3, 10, 20] {
        let scale = 2.0_f64.powi(exponent);
        let other = picture(&world(scale, DVec3::ZERO), scale, DVec3::ZERO);
        assert!(
            one.iter()
                .zip(&other)
                .all(|(a, b)| a.to_bits() == b.to_bits()),
            "2^{exponent}"
        );
    }
    for exponent in [-6, -3, 3, 6] {
        let scale = 10.0_f64.powi(exponent);
        let other = picture(&world(scale, DVec3::ZERO), scale, DVec3::ZERO);
        let error = relative_mse(&other, &one);
        assert!(error < 1e-5, "1e{exponent}: {error}");
    }
}

/// C-22: nor does it matter where the world lies.
#[test]
fn a_picture_does_not_depend_on_where_the_world_lies() {
    let one = picture(&world(1.0, DVec3::ZERO), 1.0, DVec3::ZERO);
    for distance in [1e5, 1e6, 1e7] {
        let offset = DVec3::new(distance, -0.7 * distance, 0.3 * distance);
        let other = picture(&world(1.0, offset), 1.0, offset);
        let error = relative_mse(&other, &one);
        assert!(error < 1e-6, "{distance}: {error}");
    }
}

/// C-29: of squares that coincide and shine differently, the one with the lowest number is seen, wherever they stand.
#[test]
fn of_coincident_lamps_the_first_is_seen() {
    for first in [0_u32, 5] {
        let lamps = (0..10).map(|k| PlacedShape {
            shape: square(1.0),
            to_group: DAffine3::IDENTITY,
            material: MaterialId((k + first) % 10),
            organ: OrganId(k),
        });
        let materials = (0..10)
            .map(|k| Material::lambert(Rgb::BLACK).emitting(gray(f64::from(k) + 1.0), Rgb::BLACK));
        let scene = Scene::build(SceneDescription {
            materials: materials.collect(),
            groups: vec![Group {
                shapes: lamps.collect(),
                instances: vec![],
            }],
            root: Some(GroupId(0)),
            ..SceneDescription::default()
        })
        .unwrap();
        for k in 0..100 {
            let x = f64::from(k) / 50.0 - 0.99;
            let ray = Ray::new(DVec3::new(x, 0.3, 2.0), DVec3::NEG_Z);
            let point = scene.surface(&ray, &scene.closest(&ray).unwrap());
            assert_eq!((point.organ.0, point.material.0), (0, first));
        }
    }
}

/// C-30: a ball whose inside and outside shine differently shows the right side through instances of all kinds.
#[test]
fn instances_show_the_right_side() {
    let ball = Group {
        shapes: (0..20)
            .map(|k| PlacedShape {
                shape: Shape::Sphere { radius: 1.0 },
                to_group: DAffine3::from_translation(DVec3::X * 10.0 * f64::from(k)),
                material: MaterialId(0),
                organ: OrganId(k),
            })
            .collect(),
        instances: vec![],
    };
    for scale in [1e-3, 1.0, 1e3] {
        for stretch in [
            DVec3::ONE,
            DVec3::new(0.5, 2.0, 1.0),
            DVec3::new(1.0, -1.0, 3.0),
            DVec3::NEG_ONE,
        ] {
            let map = DAffine3::from_mat3(DMat3::from_diagonal(stretch * scale));
            let aside = DAffine3::from_translation(DVec3::Y * 1e3 * scale);
            let instance = |to_group, organ| Instance {
                group: GroupId(0),
                to_group,
                organ: OrganId(organ),
            };
            let scene = Scene::build(SceneDescription {
                materials: vec![Material::lambert(gray(0.5)).emitting(gray(1.0), gray(2.0))],
                groups: vec![
                    ball.clone(),
                    Group {
                        shapes: vec![],
                        instances: vec![instance(map, 1), instance(aside * map, 2)],
                    },
                ],
                root: Some(GroupId(1)),
                ..SceneDescription::default()
            })
            .unwrap();
            assert_eq!(scene.stats().instances, 2);
            for k in 0..50 {
                let angle = f64::from(k) * 0.7;
                let out = DVec3::new(0.0, angle.cos(), angle.sin());
                let inside = Ray::new(DVec3::ZERO, out);
                let point = scene.surface(&inside, &scene.closest(&inside).unwrap());
                assert!(!point.is_front, "{scale} {stretch}");
                assert!(
                    point.normal_g.dot(point.position) > 0.0,
                    "normals point outwards"
                );
                let outside = Ray::new(out * (20.0 * scale), -out);
                let point = scene.surface(&outside, &scene.closest(&outside).unwrap());
                assert!(point.is_front, "{scale} {stretch}");
            }
        }
    }
}
