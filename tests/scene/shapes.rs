//! What rays find of single shapes and planes, and of many in one place.

use crate::worlds::{Random, build, describe, icosphere, instance, mesh, placed};
use glam::{DAffine3, DVec2, DVec3};
use std::f64::consts::PI;
use understory::color::Rgb;
use understory::geometry::Shape;
use understory::math::Ray;
use understory::scene::description::{Group, OrganId, SceneDescription};
use understory::scene::{Hit, Scene};

fn frustum(length: f64, base_radius: f64, top_radius: f64, caps: bool) -> Shape {
    Shape::Frustum {
        length,
        base_radius,
        top_radius,
        base_cap: caps,
        top_cap: caps,
    }
}

/// All finite kinds, each of a size near 1.
pub(crate) fn shapes() -> Vec<Shape> {
    vec![
        Shape::Sphere { radius: 0.8 },
        frustum(1.5, 0.5, 0.5, true),
        frustum(1.5, 0.7, 0.0, true),
        frustum(1.2, 0.3, 0.8, false),
        Shape::Box {
            half_x: 0.5,
            half_y: 0.7,
            length: 0.9,
        },
        Shape::Disk { radius: 0.9 },
        Shape::Parallelogram {
            corner: DVec3::new(-0.5, -0.5, 0.1),
            edge_u: DVec3::new(1.0, 0.2, 0.0),
            edge_v: DVec3::new(0.3, 1.1, 0.4),
        },
        mesh(icosphere(2, 0.9)),
    ]
}

/// A ray from outside towards somewhere near the middle.
pub(crate) fn inward(random: &mut Random, reach: f64) -> Ray {
    let start = random.direction() * reach * 3.0;
    let target = random.in_cube() * reach * 0.6;
    Ray::new(start, (target - start).normalize())
}

/// The distance of a point from the surface of a shape in its own frame, by the shape's equation, and its normal.
fn residual(shape: &Shape, p: DVec3, normal: DVec3) -> (f64, DVec3) {
    match shape {
        Shape::Sphere { radius } => ((p.length() - radius).abs(), p.normalize()),
        Shape::Disk { .. } => (p.z.abs(), DVec3::Z),
        Shape::Frustum {
            length,
            base_radius,
            top_radius,
            ..
        } => {
            let slope = (top_radius - base_radius) / length;
            let side = (p.truncate().length() - base_radius - slope * p.z).abs();
            let outward = p.truncate().normalize_or_zero().extend(-slope).normalize();
            if normal.z < -0.999 {
                (p.z.abs(), DVec3::NEG_Z)
            } else if normal.z > 0.999 {
                ((p.z - length).abs(), DVec3::Z)
            } else {
                (side, outward)
            }
        }
        Shape::Box {
            half_x,
            half_y,
            length,
        } => {
            let q = DVec3::new(p.x / half_x, p.y / half_y, p.z / length * 2.0 - 1.0);
            let axis = (0..3)
                .max_by(|a, b| q[*a].abs().total_cmp(&q[*b].abs()))
                .expect("there are three axes");
            (
                (q[axis].abs() - 1.0).abs(),
                DVec3::AXES[axis] * q[axis].signum(),
            )
        }
        Shape::Parallelogram {
            corner,
            edge_u,
            edge_v,
        } => {
            let n = edge_u.cross(*edge_v).normalize();
            ((p - corner).dot(n).abs(), n)
        }
        Shape::Plane | Shape::Mesh(_) => unreachable!("not measured"),
    }
}

#[test]
fn points_lie_on_the_shape_with_outward_unit_normals_under_any_placement() {
    let mut random = Random(21);
    for shape in shapes()
        .into_iter()
        .filter(|shape| !matches!(shape, Shape::Mesh(_)))
    {
        for scale in [1e-3, 1.0, 1e3] {
            let map = random.affine(scale);
            let scene = build(vec![placed(shape.clone(), map, 4)]);
            let mut hits = 0;
            for _ in 0..2000 {
                let ray = inward(&mut random, 1.5);
                let start = map.transform_point3(ray.origin);
                let ray = Ray::new(start, map.transform_vector3(ray.direction).normalize());
                let Some(hit) = scene.closest(&ray) else {
                    continue;
                };
                hits += 1;
                let point = scene.surface(&ray, &hit);
                assert!((point.position - ray.at(hit.t)).length() < 1e-11 * scale);
                assert!((point.normal_g.length() - 1.0).abs() < 1e-12);
                assert_eq!(point.is_front, ray.direction.dot(point.normal_g) < 0.0);
                assert_eq!((point.organ, point.instance_organ), (OrganId(4), None));
                // Back in the shape's own frame.
                let local = map.inverse().transform_point3(point.position);
                let normal = (map.matrix3.transpose() * point.normal_g).normalize();
                let (distance, expected) = residual(&shape, local, normal);
                assert!(distance < 1e-12, "{shape:?} {distance}");
                assert!(
                    (normal - expected).length() < 1e-9,
                    "{shape:?} {normal} {expected}"
                );
                assert!(
                    point.error.max_element() < 1e-13 * scale && point.error.min_element() >= 0.0
                );
            }
            assert!(hits > 200, "{shape:?} {hits}");
        }
    }
}

#[test]
fn parallel_rays_count_the_projected_area() {
    // Convex bodies: the shadow along a direction. Ellipses and boxes have closed forms.
    let n = 400;
    let direction = DVec3::new(0.3, -0.5, -0.8).normalize();
    let (side, up) = direction.any_orthonormal_pair();
    let project = |normal: DVec3, area: f64| area * normal.dot(direction).abs();
    let cases: Vec<(Shape, f64)> = vec![
        (Shape::Sphere { radius: 0.8 }, PI * 0.64),
        (Shape::Disk { radius: 0.9 }, project(DVec3::Z, PI * 0.81)),
        (
            Shape::Box {
                half_x: 0.5,
                half_y: 0.7,
                length: 0.9,
            },
            project(DVec3::X, 1.4 * 0.9) + project(DVec3::Y, 0.9) + project(DVec3::Z, 1.4),
        ),
        (
            // A cylinder's shadow: a rectangle and an ellipse.
            frustum(1.5, 0.5, 0.5, true),
            2.0 * 0.5 * 1.5 * direction.truncate().length() + project(DVec3::Z, PI * 0.25),
        ),
        (
            Shape::Parallelogram {
                corner: DVec3::ZERO,
                edge_u: DVec3::X,
                edge_v: DVec3::Y * 2.0,
            },
            project(DVec3::Z, 2.0),
        ),
    ];
    for (shape, expected) in cases {
        let scene = build(vec![placed(shape.clone(), DAffine3::IDENTITY, 0)]);
        let mut hits = 0;
        for i in 0..n * n {
            let at = DVec2::new(f64::from(i / n), f64::from(i % n)) + DVec2::splat(0.5);
            let at = (at / f64::from(n) - DVec2::splat(0.5)) * 6.0;
            let start = side * at.x + up * at.y - direction * 10.0;
            hits += u32::from(scene.closest(&Ray::new(start, direction)).is_some());
        }
        let found = f64::from(hits) * 36.0 / f64::from(n * n);
        assert!(
            (found / expected - 1.0).abs() < 0.01,
            "{shape:?}: {found} for {expected}"
        );
    }
}

#[test]
fn a_plane_is_seen_from_both_sides_wherever_it_is_put() {
    let mut random = Random(4);
    for _ in 0..50 {
        let map = random.affine(10.0);
        let groups = vec![
            Group {
                shapes: vec![placed(Shape::Plane, DAffine3::IDENTITY, 3)],
                instances: vec![],
            },
            Group {
                shapes: vec![],
                instances: vec![instance(0, map, 9)],
            },
        ];
        let scene = Scene::build(describe(groups)).unwrap();
        assert!(scene.bounds().is_empty() && scene.stats().planes == 1);
        let normal = (map.inverse().matrix3.transpose() * DVec3::Z).normalize();
        for side in [1.0, -1.0] {
            let target = map.transform_point3(DVec3::new(1.5, -2.5, 0.0));
            let start = target + normal * side * 7.0 + random.in_cube();
            let ray = Ray::new(start, (target - start).normalize());
            let point = scene.surface(&ray, &scene.closest(&ray).unwrap());
            assert!((point.position - target).length() < 1e-11);
            assert!((point.normal_g - normal).length() < 1e-12);
            assert!((point.uv - DVec2::new(1.5, -2.5)).length() < 1e-11);
            assert_eq!((point.is_front, point.organ.0), (side > 0.0, 3));
            assert_eq!(point.instance_organ, Some(OrganId(9)));
            assert_eq!(scene.closest(&point.spawn_ray(random.direction())), None);
        }
    }
}

/// All that lies along a ray, one after the other.
pub(crate) fn all_along(scene: &Scene, ray: &Ray) -> Vec<Hit> {
    std::iter::successors(scene.closest(ray), |hit| scene.closest_after(ray, hit)).collect()
}

/// C-54.
#[test]
fn what_is_empty_answers_nothing() {
    let no_groups = Scene::build(SceneDescription::default()).unwrap();
    let empty_group = build(vec![]);
    let nothing = build(vec![placed(
        Shape::Sphere { radius: 0.0 },
        DAffine3::IDENTITY,
        0,
    )]);
    let empty_instance = Scene::build(describe(vec![
        Group::default(),
        Group {
            shapes: vec![],
            instances: vec![
                instance(0, DAffine3::IDENTITY, 0),
                instance(0, DAffine3::IDENTITY, 1),
            ],
        },
    ]))
    .unwrap();
    for scene in [no_groups, empty_group, nothing, empty_instance] {
        let ray = Ray::new(DVec3::ZERO, DVec3::X);
        assert_eq!(
            (scene.closest(&ray), scene.transmittance(&ray)),
            (None, Rgb::WHITE)
        );
        assert!(scene.bounds().is_empty() && scene.emitters().is_empty() && !scene.occluded(&ray));
    }
}

/// Across and then along a parallelogram; x and then y, y and then z, x and then z on plates that were boxes.
#[test]
fn textures_lie_across_and_along_flat_shapes() {
    let leaf = Shape::Parallelogram {
        corner: DVec3::new(-1.0, 0.0, 0.0),
        edge_u: DVec3::Z * 4.0,
        edge_v: DVec3::X * 2.0,
    };
    let plate = |half_x, half_y, length| Shape::Box {
        half_x,
        half_y,
        length,
    };
    for (shape, from) in [
        (leaf, DVec3::new(-0.5, 3.0, 3.0)),
        (plate(1.0, 0.0, 4.0), DVec3::new(-0.5, 3.0, 3.0)),
        (plate(0.0, 1.0, 4.0), DVec3::new(3.0, -0.5, 3.0)),
        (plate(1.0, 2.0, 0.0), DVec3::new(-0.5, 1.0, 3.0)),
    ] {
        let scene = build(vec![placed(shape.clone(), DAffine3::IDENTITY, 0)]);
        let axis = from.to_array().iter().position(|x| *x == 3.0).unwrap();
        let toward = -DVec3::from_array(std::array::from_fn(|i| f64::from(u8::from(i == axis))));
        let ray = Ray::new(from, toward);
        let uv = scene.surface(&ray, &scene.closest(&ray).unwrap()).uv;
        assert!(
            (uv - DVec2::new(0.25, 0.75)).length() < 1e-9,
            "{shape:?} {uv}"
        );
    }
}
