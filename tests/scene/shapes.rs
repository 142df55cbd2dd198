//! What rays find of single shapes and planes, and of many in one place.

use crate::worlds::{Random, build, describe, icosphere, instance, mesh, placed, soup};
use glam::{DAffine3, DVec2, DVec3};
use std::f64::consts::PI;
use understory::color::Rgb;
use understory::geometry::Shape;
use understory::math::{PrimitiveId, Ray};
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

/// C-28: directions with ±0.
#[test]
fn axis_parallel_rays_with_signed_zeros_hit_everything_and_stay_finite() {
    for shape in shapes() {
        // Placed so that the box of the group has faces exactly in the planes of the rays, too.
        for offset in [0.0, 1.0, 1e5] {
            let moved = DAffine3::from_translation(DVec3::splat(offset));
            let scene = build(vec![placed(shape.clone(), moved, 0)]);
            for zeros in [[0.0, 0.0], [-0.0, 0.0], [0.0, -0.0], [-0.0, -0.0]] {
                for distance in [3.0, 1e7] {
                    let start = DVec3::new(0.1, 0.1, distance) + DVec3::splat(offset);
                    let ray = Ray::new(start, DVec3::new(zeros[0], zeros[1], -1.0));
                    // An open funnel is seen through its hole from above: its wall is hit further down or not at all.
                    let Some(hit) = scene.closest(&ray) else {
                        assert!(matches!(
                            shape,
                            Shape::Frustum {
                                base_cap: false,
                                ..
                            }
                        ));
                        continue;
                    };
                    assert!(
                        hit.t > distance - 2.0 && hit.t < distance + 1.0,
                        "{shape:?} {hit:?}"
                    );
                    assert!(scene.surface(&ray, &hit).position.is_finite());
                }
            }
        }
    }
    // A grid whose corners and edges lie exactly under the rays.
    let corner = |x: i32, y: i32| DVec3::new(f64::from(x), f64::from(y), 0.0);
    let mut triangles = Vec::new();
    for x in -4..4 {
        for y in -4..4 {
            triangles.push([corner(x, y), corner(x + 1, y), corner(x + 1, y + 1)]);
            triangles.push([corner(x, y), corner(x + 1, y + 1), corner(x, y + 1)]);
        }
    }
    let scene = build(vec![placed(mesh(soup(&triangles)), DAffine3::IDENTITY, 0)]);
    for x in -8..=8 {
        for y in -8..=8 {
            let start = DVec3::new(f64::from(x) / 2.0, f64::from(y) / 2.0, 1e6);
            assert_eq!(
                scene
                    .closest(&Ray::new(start, DVec3::NEG_Z))
                    .map(|hit| hit.t),
                Some(1e6)
            );
        }
    }
}

/// C-28: grazing rays.
#[test]
fn grazing_rays_are_finite_and_a_plane_is_not_met_from_within() {
    let shapes = vec![
        placed(Shape::Plane, DAffine3::IDENTITY, 0),
        placed(
            Shape::Sphere { radius: 1.0 },
            DAffine3::from_translation(DVec3::Z * 5.0),
            1,
        ),
    ];
    let scene = build(shapes);
    for k in 0..20 {
        let tilt = if k == 0 { 0.0 } else { 10.0_f64.powi(-k) };
        for sign in [1.0, -1.0] {
            let ray = Ray::new(
                DVec3::Z * 1e-3,
                DVec3::new(1.0, 0.0, tilt * sign).normalize(),
            );
            match scene.closest(&ray) {
                Some(hit) => assert!(hit.t.is_finite() && sign < 0.0 && tilt > 0.0),
                None => assert!(sign > 0.0 || tilt == 0.0),
            }
        }
    }
    let within = Ray::new(DVec3::ZERO, DVec3::X);
    assert_eq!(scene.closest(&within), None);
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

/// C-25.
#[test]
fn thin_layers_are_seen_in_order() {
    for gap in [1e-5, 1e-7] {
        let layers = (0..20).map(|k| {
            let square = Shape::Parallelogram {
                corner: DVec3::new(-5.0, -5.0, -gap * f64::from(k)),
                edge_u: DVec3::X * 10.0,
                edge_v: DVec3::Y * 10.0,
            };
            placed(square, DAffine3::IDENTITY, k as u32)
        });
        let scene = build(layers.collect());
        let mut random = Random(2);
        for _ in 0..200 {
            let start = DVec3::new(0.0, 0.0, 100.0) + random.in_cube();
            let target = random.in_cube() * DVec3::new(4.0, 4.0, 0.0);
            let mut ray = Ray::new(start, (target - start).normalize());
            for k in 0..20 {
                let point = scene.surface(&ray, &scene.closest(&ray).unwrap());
                assert_eq!(point.organ.0, k);
                ray = point.spawn_ray(ray.direction);
            }
            assert_eq!(scene.closest(&ray), None);
        }
    }
}

/// C-26, C-29: each of what coincides is hit once, in the order of numbers.
#[test]
fn coincident_surfaces_are_hit_in_the_order_of_their_numbers_each_once() {
    let square = [DVec3::NEG_ONE, DVec3::X * 3.0, DVec3::Y * 3.0];
    let scene = build(vec![placed(
        mesh(soup(&[square; 100])),
        DAffine3::IDENTITY,
        0,
    )]);
    let ray = Ray::new(DVec3::new(0.1, 0.1, 5.0), DVec3::NEG_Z);
    let found = all_along(&scene, &ray);
    assert!(
        (0..100)
            .map(PrimitiveId)
            .eq(found.iter().map(|hit| hit.primitive))
    );

    // The same through instances, on a plane and from far away: what rounds differently still comes once each, in order.
    let leaf = Shape::Parallelogram {
        corner: DVec3::NEG_ONE * DVec3::new(1.0, 1.0, 0.0),
        edge_u: DVec3::X * 3.0,
        edge_v: DVec3::Y * 3.0,
    };
    let leaves = Group {
        shapes: (0..20)
            .map(|k| placed(leaf.clone(), DAffine3::IDENTITY, k))
            .collect(),
        instances: vec![],
    };
    let turned = |k: u32| instance(0, DAffine3::from_rotation_z(0.1 * f64::from(k)), k);
    let stand = Group {
        shapes: vec![placed(Shape::Plane, DAffine3::IDENTITY, 20)],
        instances: (0..10).map(turned).collect(),
    };
    let scene = Scene::build(describe(vec![leaves, stand])).unwrap();
    for start in [1.0, 1e3, 1e9] {
        let slanted = DVec3::new(0.1, 0.2, -1.0).normalize();
        let found = all_along(&scene, &Ray::new(slanted * -start, slanted));
        let mut primitives: Vec<_> = found.iter().map(|hit| hit.primitive).collect();
        primitives.sort_unstable();
        primitives.dedup();
        assert_eq!((found.len(), primitives.len()), (201, 201));
        assert!(found.is_sorted_by_key(|hit| hit.t));
    }
}

/// All that lies along a ray, one after the other.
pub(crate) fn all_along(scene: &Scene, ray: &Ray) -> Vec<Hit> {
    std::iter::successors(scene.closest(ray), |hit| scene.closest_after(ray, hit)).collect()
}

/// C-26.
#[test]
fn degenerate_triangles_and_needles_do_no_harm() {
    let needle = [DVec3::ZERO, DVec3::X * 1e3, DVec3::new(1e3, 1e-3, 0.0)];
    let corners = [
        [DVec3::ZERO; 3],
        [DVec3::ZERO, DVec3::X, DVec3::X * 2.0],
        [DVec3::ONE, DVec3::ONE, DVec3::ZERO],
        needle,
    ];
    let scene = build(vec![placed(mesh(soup(&corners)), DAffine3::IDENTITY, 0)]);
    let target = (needle[0] + needle[1] + needle[2]) / 3.0;
    let ray = Ray::new(
        target + DVec3::new(0.0, 0.3, 50.0),
        DVec3::new(0.0, -0.3, -50.0).normalize(),
    );
    let hit = scene.closest(&ray).unwrap();
    assert_eq!(hit.primitive, PrimitiveId(3));
    assert!(
        scene
            .surface(&ray, &hit)
            .normal_g
            .abs_diff_eq(DVec3::Z, 1e-12)
    );
    let only_degenerate = build(vec![placed(
        mesh(soup(&corners[..3])),
        DAffine3::IDENTITY,
        0,
    )]);
    assert_eq!(only_degenerate.closest(&ray), None);
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
