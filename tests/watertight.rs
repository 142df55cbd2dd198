//! No ray leaves a closed surface, and no ray finds the surface it starts on.
//!
//! The full-size run, 2 million rays per case: `UNDERSTORY_FULL=1 cargo test --release --test watertight`.

#[path = "support/worlds.rs"]
mod worlds;

use glam::{DAffine3, DMat3, DVec3};
use understory::geometry::{Shape, TriangleMesh};
use understory::math::Ray;
use understory::scene::Scene;
use understory::scene::description::Group;
use worlds::{Random, build, describe, full, icosphere, instance, mesh, placed, soup};

fn rays() -> usize {
    if full() { 2_000_000 } else { 60_000 }
}

/// A corner, a point of an edge, or a point between, as critical as rays can be aimed.
fn critical_target(mesh: &TriangleMesh, random: &mut Random) -> DVec3 {
    let triangle = mesh.triangles[random.below(mesh.triangles.len())];
    let [a, b, c] = triangle.map(|corner| mesh.positions[corner as usize]);
    match random.below(8) {
        0..3 => a,
        3..6 => a.lerp(b, random.unit()),
        6 => a.lerp(b, 0.5),
        _ => (a + b + c) / 3.0,
    }
}

/// Sends rays from inside a closed mesh at its corners and edges and counts those that find nothing.
fn escapes(scene: &Scene, mesh: &TriangleMesh, to_world: &DAffine3, radius: f64) -> usize {
    let mut random = Random(1);
    let mut escaped = 0;
    for _ in 0..rays() {
        let target = to_world.transform_point3(critical_target(mesh, &mut random));
        let start = to_world.transform_point3(random.in_cube() * 0.5 * radius);
        let ray = Ray::new(start, (target - start).normalize());
        escaped += usize::from(scene.closest(&ray).is_none());
    }
    escaped
}

/// C-23.
#[test]
fn nothing_escapes_from_a_closed_mesh_of_any_size_anywhere() {
    for radius in [1e-6, 1.0, 1e6] {
        let ball = icosphere(4, radius);
        for offset in [0.0, 1e4, 1e6] {
            // Both ways to put it there: by its placement, and by the numbers of its corners.
            let offset = DVec3::new(offset, -offset * 0.7, offset * 0.3);
            let moved = DAffine3::from_translation(offset);
            let scene = build(vec![placed(mesh(ball.clone()), moved, 0)]);
            assert_eq!(
                escapes(&scene, &ball, &moved, radius),
                0,
                "{radius} {offset}"
            );

            let mut ball = ball.clone();
            ball.positions.iter_mut().for_each(|at| *at += offset);
            let scene = build(vec![placed(mesh(ball.clone()), DAffine3::IDENTITY, 0)]);
            let mut random = Random(2);
            let inside = |random: &mut Random| offset + random.in_cube() * 0.5 * radius;
            for _ in 0..rays() / 4 {
                let start = inside(&mut random);
                let target = critical_target(&ball, &mut random);
                let ray = Ray::new(start, (target - start).normalize());
                assert!(scene.closest(&ray).is_some(), "{radius} {offset} {ray:?}");
            }
        }
    }
}

/// C-23, in instances; C-30.
#[test]
fn nothing_escapes_through_mirrored_and_stretched_instances() {
    let ball = icosphere(4, 1.0);
    let tiny_far = DAffine3 {
        matrix3: DMat3::from_diagonal(DVec3::new(1e-3, -2e-3, 5e-4)),
        translation: DVec3::new(1e5, -3e4, 2e4),
    };
    let maps = [
        Random(5).affine(1.0),
        Random(6).affine(1e3),
        Random(7).affine(1e-3),
        tiny_far,
    ];
    for map in maps {
        let groups = vec![
            Group {
                shapes: vec![placed(mesh(ball.clone()), DAffine3::IDENTITY, 0)],
                instances: vec![],
            },
            // Twice, or the group would dissolve.
            Group {
                shapes: vec![],
                instances: vec![
                    instance(0, map, 1),
                    instance(0, DAffine3::from_translation(DVec3::splat(1e4)) * map, 2),
                ],
            },
        ];
        let scene = Scene::build(describe(groups)).unwrap();
        assert_eq!(scene.stats().instances, 2);
        assert_eq!(escapes(&scene, &ball, &map, 1.0), 0, "{map:?}");
    }
}

/// A closed mesh with acute edges, its front outside, round the origin.
fn tetrahedron(size: f64) -> TriangleMesh {
    let corners = [
        [1.0, 1.0, 1.0],
        [-1.0, -1.0, 1.0],
        [-1.0, 1.0, -1.0],
        [1.0, -1.0, -1.0],
    ];
    TriangleMesh {
        positions: corners
            .map(|corner| DVec3::from_array(corner) * size)
            .to_vec(),
        triangles: vec![[0, 1, 3], [0, 2, 1], [0, 3, 2], [1, 2, 3]],
        ..TriangleMesh::default()
    }
}

/// Lets a ray bounce about inside, and rays leave outwards, and counts what cannot be: inside a convex body every bounce
/// finds another part of the wall, outside nothing.
fn false_hits(scene: &Scene, center: DVec3, size: f64, n: usize) -> (usize, usize) {
    let mut random = Random(11);
    let (mut lost, mut returned) = (0, 0);
    let mut ray = Ray::new(center, random.direction());
    for _ in 0..n {
        let Some(hit) = scene.closest(&ray) else {
            lost += 1;
            ray = Ray::new(center, random.direction());
            continue;
        };
        let point = scene.surface(&ray, &hit);
        assert!(!point.is_front, "seen from inside");
        // Some directions graze.
        let mut inward = random.direction();
        inward *= -inward.dot(point.normal_g).signum();
        if random.unit() < 0.2 {
            let flat = inward - point.normal_g * inward.dot(point.normal_g);
            let tilt = 10.0_f64.powf(random.between(-12.0, -1.0));
            inward = (flat.normalize() - point.normal_g * tilt).normalize();
        }
        let outward = inward - point.normal_g * (2.0 * inward.dot(point.normal_g));
        if let Some(hit) = scene.closest(&point.spawn_ray(outward)) {
            returned += 1;
            assert!(
                hit.t > 1e-3 * size || returned < 10,
                "returned {hit:?} {point:?}"
            );
        }
        ray = point.spawn_ray(inward);
    }
    (lost, returned)
}

/// C-24: convex bodies of all sizes, near and far, grazing directions among them.
#[test]
fn bounces_inside_and_outside_convex_bodies_never_meet_their_own_surface() {
    let frustum = |s: f64| Shape::Frustum {
        length: 2.0 * s,
        base_radius: s,
        top_radius: 0.4 * s,
        base_cap: true,
        top_cap: true,
    };
    type OfSize = fn(f64) -> Shape;
    let shapes: [(&str, OfSize); 4] = [
        ("sphere", |radius| Shape::Sphere { radius }),
        ("box", |s| Shape::Box {
            half_x: s,
            half_y: 2.0 * s,
            length: s,
        }),
        ("mesh", |radius| mesh(icosphere(3, radius))),
        ("sharp mesh", |size| mesh(tetrahedron(size))),
    ];
    let n = rays() / 10;
    for size in [1e-6, 1e-3, 1.0, 1e3, 1e6] {
        for offset in [0.0, 1e5 * size] {
            let center = DVec3::splat(offset);
            let check = |name: &str, shape: Shape, lift: f64| {
                let down = DVec3::new(0.0, 0.0, -lift);
                let scene = build(vec![placed(
                    shape,
                    DAffine3::from_translation(center + down),
                    0,
                )]);
                assert_eq!(
                    false_hits(&scene, center, size, n),
                    (0, 0),
                    "{name} {size} {offset}"
                );
            };
            for (name, shape) in &shapes {
                check(
                    name,
                    shape(size),
                    if *name == "box" { 0.5 * size } else { 0.0 },
                );
            }
            check("frustum", frustum(size), size);
        }
    }
}

/// C-24: one large triangle that passes close to the origin.
#[test]
fn bounces_off_a_large_triangle_through_the_origin_meet_nothing() {
    let mut random = Random(3);
    for size in [1e-6, 1e-3, 1.0, 4096.0, 1e6] {
        let corners = [
            [-0.31, -0.52, 0.011],
            [0.73, -0.11, -0.02],
            [-0.2, 0.61, 0.007],
        ]
        .map(|corner| DVec3::from_array(corner) * size);
        let scene = build(vec![placed(mesh(soup(&[corners])), DAffine3::IDENTITY, 0)]);
        for _ in 0..rays() / 4 {
            let (u, v) = (random.unit(), random.unit());
            let (u, v) = if u + v > 1.0 {
                (1.0 - u, 1.0 - v)
            } else {
                (u, v)
            };
            let target = corners[0] + (corners[1] - corners[0]) * u + (corners[2] - corners[0]) * v;
            let start = target + random.direction() * size;
            let ray = Ray::new(start, (target - start).normalize());
            let Some(hit) = scene.closest(&ray) else {
                continue;
            };
            let point = scene.surface(&ray, &hit);
            assert!((point.position - target).length() < 1e-9 * size);
            let next = point.spawn_ray(random.direction());
            assert_eq!(scene.closest(&next), None);
            // Excluded by number, but the start alone must be enough on the side it is on, too.
            let off = (next.origin - point.position).length();
            assert!(off > 0.0 && off < 1e-12 * size, "{off}");
        }
    }
}

/// C-24, in instances; C-30.
#[test]
fn bounces_in_instances_meet_nothing() {
    let mut random = Random(8);
    for scale in [1e-3, 1.0, 1e3] {
        for shape in [Shape::Sphere { radius: 1.0 }, mesh(icosphere(3, 1.0))] {
            let map = random.affine(scale);
            // Many, so that they stay instances whatever their size.
            let shapes = (0..20).map(|k| {
                let aside = DAffine3::from_translation(DVec3::X * 100.0 * f64::from(k));
                placed(shape.clone(), aside, k as u32)
            });
            let groups = vec![
                Group {
                    shapes: shapes.collect(),
                    instances: vec![],
                },
                Group {
                    shapes: vec![],
                    instances: vec![
                        instance(0, map, 1),
                        instance(
                            0,
                            DAffine3::from_translation(DVec3::Z * 1e5 * scale) * map,
                            2,
                        ),
                    ],
                },
            ];
            let scene = Scene::build(describe(groups)).unwrap();
            assert_eq!(scene.stats().instances, 2);
            let center = map.translation;
            let mut ray = Ray::new(center, random.direction());
            for _ in 0..rays() / 10 {
                let hit = scene.closest(&ray).unwrap();
                let point = scene.surface(&ray, &hit);
                assert_eq!((point.is_front, point.organ.0), (false, 0));
                let inward = random.direction();
                let inward = inward * -inward.dot(point.normal_g).signum();
                ray = point.spawn_ray(inward);
                // Outwards there may be one of the others, but never the one it starts from.
                let outward = point.spawn_ray(-inward);
                if let Some(hit) = scene.closest(&outward) {
                    assert_ne!(scene.surface(&outward, &hit).organ.0, 0);
                }
            }
        }
    }
}
