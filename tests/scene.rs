//! What rays find in a scene: every shape, everywhere, through instances, and whatever is wrong with it.

#[path = "support/worlds.rs"]
mod worlds;

use glam::{DAffine3, DMat3, DQuat, DVec2, DVec3};
use std::f64::consts::PI;
use understory::color::Rgb;
use understory::geometry::{Shape, TriangleMesh};
use understory::material::Material;
use understory::math::{PrimitiveId, Ray};
use understory::scene::description::{
    Group, GroupId, MaterialId, OrganId, PlacedShape, SceneDescription,
};
use understory::scene::{Problem, Scene, SceneError};
use worlds::{Random, build, describe, icosphere, instance, mesh, placed, soup, try_build};

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
fn shapes() -> Vec<Shape> {
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
fn inward(random: &mut Random, reach: f64) -> Ray {
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

#[test]
fn coincident_surfaces_are_hit_in_the_order_of_their_numbers_each_once() {
    let square = [DVec3::NEG_ONE, DVec3::X * 3.0, DVec3::Y * 3.0];
    let scene = build(vec![placed(
        mesh(soup(&[square; 100])),
        DAffine3::IDENTITY,
        0,
    )]);
    let ray = Ray::new(DVec3::new(0.1, 0.1, 5.0), DVec3::NEG_Z);
    assert_eq!(scene.closest(&ray).unwrap().primitive, PrimitiveId(0));
}

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
            (None, 1.0)
        );
        assert!(scene.bounds().is_empty() && scene.emitters().is_empty() && !scene.occluded(&ray));
    }
}

/// A forest: prototypes of many shapes, some nested, planted many times.
fn forest(random: &mut Random, n_instances: usize) -> Vec<Group> {
    let all = shapes();
    let plant = |random: &mut Random, count: usize| {
        let shapes = (0..count).map(|k| {
            placed(
                all[random.below(all.len())].clone(),
                random.affine(0.2),
                k as u32,
            )
        });
        Group {
            shapes: shapes.collect(),
            instances: vec![],
        }
    };
    let small = plant(random, 3);
    let large = plant(random, 40);
    let mut nested = plant(random, 20);
    for k in 0..5 {
        nested
            .instances
            .push(instance((k % 2) as u32, random.affine(0.5), 100 + k as u32));
    }
    let mut root = plant(random, 5);
    for k in 0..n_instances {
        root.instances.push(instance(
            random.below(3) as u32,
            random.affine(1.0),
            200 + k as u32,
        ));
    }
    vec![small, large, nested, root]
}

/// The same world with all instances written out: placed shapes with the organ of their outermost instance.
fn written_out(groups: &[Group]) -> Vec<(PlacedShape, Option<OrganId>)> {
    let mut open = vec![(groups.len() - 1, DAffine3::IDENTITY, None)];
    let mut all = Vec::new();
    while let Some((group, map, outer)) = open.pop() {
        for shape in &groups[group].shapes {
            all.push((
                PlacedShape {
                    to_group: map * shape.to_group,
                    ..shape.clone()
                },
                outer,
            ));
        }
        for instance in &groups[group].instances {
            let outer = outer.or(Some(instance.organ));
            open.push((instance.group.0 as usize, map * instance.to_group, outer));
        }
    }
    all
}

#[test]
fn instances_show_what_their_contents_written_out_show() {
    let mut random = Random(31);
    for _ in 0..4 {
        let groups = forest(&mut random, 30);
        let all = written_out(&groups);
        let flat = build(all.iter().map(|(shape, _)| shape.clone()).collect());
        let instanced = Scene::build(describe(groups)).unwrap();
        assert!(instanced.stats().instances >= 20 && flat.stats().instances == 0);
        let world = instanced.stats().world_primitives;
        assert_eq!(world, flat.stats().world_primitives);
        let mut hits = 0;
        for _ in 0..4000 {
            let ray = inward(&mut random, 5.0);
            let (a, b) = (instanced.closest(&ray), flat.closest(&ray));
            assert_eq!(a.is_some(), b.is_some(), "{ray:?}");
            let (Some(a), Some(b)) = (a, b) else { continue };
            hits += 1;
            assert!((a.t - b.t).abs() < 1e-10, "{a:?} {b:?}");
            let (p, q) = (instanced.surface(&ray, &a), flat.surface(&ray, &b));
            assert!((p.position - q.position).length() < 1e-10, "{p:?} {q:?}");
            assert!((p.normal_g - q.normal_g).length() < 1e-7, "{p:?} {q:?}");
            assert!((p.uv - q.uv).length() < 1e-6 || (p.uv - q.uv).length() > 0.99);
            assert_eq!(
                (p.organ, p.material, p.is_front),
                (q.organ, q.material, q.is_front)
            );
            assert!(a.primitive.0 < world && p.instance_organ.is_none_or(|organ| organ.0 >= 100));
            assert_eq!(instanced.transmittance(&ray), flat.transmittance(&ray));
        }
        assert!(hits > 1000, "{hits}");
    }
}

#[test]
fn the_hierarchy_finds_what_trying_everything_finds() {
    let mut random = Random(77);
    for _ in 0..4 {
        let groups = forest(&mut random, 20);
        let all = written_out(&groups);
        let alone: Vec<Scene> = all
            .iter()
            .map(|(shape, _)| build(vec![shape.clone()]))
            .collect();
        let scene = Scene::build(describe(groups)).unwrap();
        for _ in 0..300 {
            let ray = inward(&mut random, 5.0);
            let nearest = alone
                .iter()
                .zip(&all)
                .filter_map(|(scene, (_, outer))| Some((scene.closest(&ray)?.t, *outer)))
                .min_by(|a, b| a.0.total_cmp(&b.0));
            let found = scene.closest(&ray);
            assert_eq!(found.is_some(), nearest.is_some());
            let (Some(found), Some((t, outer))) = (found, nearest) else {
                continue;
            };
            assert!((found.t - t).abs() < 1e-10);
            assert_eq!(scene.surface(&ray, &found).instance_organ, outer);
        }
    }
}

#[test]
fn scaling_by_a_power_of_two_changes_no_bit() {
    let shapes = |scale: f64| {
        let mut random = Random(9);
        let all = worlds_of_all(&mut random);
        build(
            all.into_iter()
                .map(|shape| PlacedShape {
                    to_group: DAffine3::from_scale(DVec3::splat(scale)) * shape.to_group,
                    ..shape
                })
                .collect(),
        )
    };
    let one = shapes(1.0);
    for exponent in [-20, -3, 7, 20] {
        let scale = 2.0_f64.powi(exponent);
        let other = shapes(scale);
        let mut random = Random(10);
        for _ in 0..2000 {
            let ray = inward(&mut random, 3.0);
            let scaled = Ray::new(ray.origin * scale, ray.direction);
            let (a, b) = (one.closest(&ray), other.closest(&scaled));
            assert_eq!(a.map(|hit| hit.t * scale), b.map(|hit| hit.t));
        }
    }
}

fn worlds_of_all(random: &mut Random) -> Vec<PlacedShape> {
    let all = shapes();
    (0..60)
        .map(|k| placed(all[k % all.len()].clone(), random.affine(0.4), k as u32))
        .collect()
}

#[test]
fn distance_of_the_eye_costs_no_digits() {
    // A plant of a metre, seen from a million kilometres away.
    let mut random = Random(12);
    let scene = build(worlds_of_all(&mut random));
    let mut hits = 0;
    for _ in 0..2000 {
        let direction = random.direction();
        let target = random.in_cube();
        let near = Ray::new(target - direction * 20.0, direction);
        let far = Ray::new(target - direction * 1e9, direction);
        let (a, b) = (scene.closest(&near), scene.closest(&far));
        let (Some(a), Some(b)) = (a, b) else { continue };
        hits += 1;
        let (p, q) = (scene.surface(&near, &a), scene.surface(&far, &b));
        // The start itself is rounded to 1e-7 m there; nothing else may add to that.
        assert!((p.position - q.position).length() < 1e-4 || p.organ != q.organ);
    }
    assert!(hits > 300, "{hits}");
}

#[test]
fn light_goes_straight_through_what_alpha_leaves_open() {
    let mut random = Random(14);
    let glassy = |alpha: f64| Material::default().with_alpha(alpha);
    let ball = |material, k: u32| PlacedShape {
        material: MaterialId(material),
        ..placed(
            Shape::Sphere { radius: 1.0 },
            DAffine3::from_translation(DVec3::X * 3.0 * f64::from(k)),
            k,
        )
    };
    // 20 balls, so that the group stays a group.
    let scene = |last: u32| {
        let shapes = (0..20)
            .map(|k| ball(if k == 19 { last } else { 0 }, k))
            .collect();
        let groups = vec![
            Group {
                shapes,
                instances: vec![],
            },
            Group {
                shapes: vec![],
                instances: vec![
                    instance(0, DAffine3::IDENTITY, 0),
                    instance(0, DAffine3::from_translation(DVec3::Y * 10.0), 0),
                ],
            },
        ];
        let materials = vec![glassy(0.1), glassy(1.0), glassy(0.0)];
        Scene::build(SceneDescription {
            materials,
            ..describe(groups)
        })
        .unwrap()
    };
    let (open, closed, clear) = (scene(0), scene(1), scene(2));
    for _ in 0..100 {
        let aim = random.in_cube() * 0.3;
        let ray = Ray::new(DVec3::new(-5.0, aim.y, aim.z), DVec3::X);
        let near = |found: f64, power: i32| (found / 0.9_f64.powi(power) - 1.0).abs() < 1e-12;
        assert!(near(open.transmittance(&ray), 40) && near(clear.transmittance(&ray), 38));
        assert!(!open.occluded(&ray) && closed.occluded(&ray));
        // As far as the middle of the third ball: five surfaces.
        assert!(near(closed.transmittance(&ray.until(11.0)), 5));
        let inside = Ray {
            t_min: 5.0,
            ..ray.until(8.0)
        };
        assert!(near(closed.transmittance(&inside), 2));
    }
}

#[test]
fn rays_to_a_point_stop_short_of_it() {
    let mut random = Random(16);
    for scale in [1e-4, 1.0, 1e4] {
        let floor = Shape::Parallelogram {
            corner: DVec3::new(-scale, -scale, 0.0),
            edge_u: DVec3::X * 2.0 * scale,
            edge_v: DVec3::Y * 2.0 * scale,
        };
        let lamp = Shape::Sphere { radius: scale };
        let up = DAffine3::from_translation(DVec3::Z * 3.0 * scale);
        let scene = build(vec![
            placed(floor, DAffine3::IDENTITY, 0),
            placed(lamp, up, 1),
        ]);
        for _ in 0..5000 {
            let down = Ray::new(
                random.in_cube() * DVec3::new(scale, scale, 0.0) + DVec3::Z * scale,
                DVec3::NEG_Z,
            );
            let point = scene.surface(&down, &scene.closest(&down).unwrap());
            let normal = random.direction();
            let target = DVec3::Z * 3.0 * scale + normal * scale;
            let ray = point.spawn_ray_to(target);
            let faces = normal.dot(target - point.position) < 0.0;
            assert_eq!(scene.occluded(&ray), !faces, "{ray:?}");
        }
        let down = Ray::new(DVec3::Z * scale, DVec3::NEG_Z);
        let point = scene.surface(&down, &scene.closest(&down).unwrap());
        let nowhere = point.spawn_ray_to(point.position);
        assert!(nowhere.direction.is_finite() && !scene.occluded(&nowhere));
    }
}

#[test]
fn emitters_are_where_rays_find_them() {
    let mut random = Random(18);
    let glowing = |shape: PlacedShape| PlacedShape {
        material: MaterialId(1),
        ..shape
    };
    let mut groups = forest(&mut random, 12);
    for group in &mut groups {
        group.shapes = group.shapes.drain(..).map(glowing).collect();
    }
    groups[1].shapes.truncate(20);
    let lamp = Material::default().emitting(Rgb::WHITE, Rgb::BLACK);
    let description = SceneDescription {
        materials: vec![Material::default(), lamp],
        ..describe(groups)
    };
    let scene = Scene::build(description).unwrap();
    assert_eq!(
        scene.emitters().len() as u64,
        scene.stats().world_primitives
    );
    for (index, emitter) in scene.emitters().iter().enumerate() {
        if index % 7 != 0 {
            continue;
        }
        let n = 32;
        let mut area = 0.0;
        for k in 0..n * n {
            let u = [
                (f64::from(k / n) + random.unit()) / 32.0,
                (f64::from(k % n) + 0.5) / 32.0,
            ];
            let sample = emitter.sample(u);
            area += 1.0 / sample.pdf_area / f64::from(n * n);
            assert_eq!(sample.pdf_area, emitter.pdf_area(sample.normal));
            // A ray against the normal finds the emitter there, from its front.
            let out = 1e-6;
            let ray =
                Ray::new(sample.position + sample.normal * out, -sample.normal).until(2.0 * out);
            if k % 37 == 0
                && let Some(hit) = scene.closest(&ray)
                && hit.primitive == emitter.primitive
            {
                let id = scene.emitter_of(&hit).unwrap();
                assert_eq!(id.0 as usize, index);
                let point = scene.surface(&ray, &hit);
                assert!((point.position - sample.position).length() < 1e-8 && point.is_front);
                assert!(
                    (point.normal_g - sample.normal).length() < 1e-5,
                    "{point:?} {sample:?}"
                );
                assert_eq!(
                    (point.organ, point.material),
                    (emitter.organ, emitter.material)
                );
            } else if k % 37 == 0 {
                // Only other surfaces may be in the way.
                assert!(scene.closest(&ray).is_some(), "{emitter:?} {sample:?}");
            }
        }
        assert!(
            (area / emitter.area() - 1.0).abs() < 0.02,
            "{area} {}",
            emitter.area()
        );
    }
}

#[test]
fn meshes_interpolate_their_normals_and_texture() {
    let mut ball = icosphere(3, 1.0);
    ball.normals = ball.positions.clone();
    ball.uvs = ball
        .positions
        .iter()
        .map(|p| DVec2::new(p.x, p.y))
        .collect();
    let mut random = Random(20);
    let map = random.affine(2.0);
    let scene = build(vec![placed(mesh(ball), map, 0)]);
    for _ in 0..500 {
        let local = inward(&mut random, 0.5);
        let start = map.transform_point3(local.origin);
        let ray = Ray::new(start, map.transform_vector3(local.direction).normalize());
        let Some(hit) = scene.closest(&ray) else {
            continue;
        };
        let point = scene.surface(&ray, &hit);
        let at = map.inverse().transform_point3(point.position);
        let expected = (map.inverse().matrix3.transpose() * at).normalize();
        assert!((point.normal_s - expected).length() < 1e-9);
        assert!((point.uv - at.truncate()).length() < 1e-9);
        assert!(point.normal_g.dot(point.normal_s) > 0.9);
    }
}

fn problem(shape: Shape, to_group: DAffine3) -> Option<(u32, Problem)> {
    let good = placed(Shape::Sphere { radius: 1.0 }, DAffine3::IDENTITY, 0);
    match try_build(vec![good, placed(shape, to_group, 42)]) {
        Ok(_) => None,
        Err(SceneError::Organ { organ, problem }) => Some((organ.0, problem)),
        Err(other) => panic!("{other}"),
    }
}

#[test]
fn impossible_numbers_are_refused_with_the_organ() {
    let vertex = |x: f64| mesh(soup(&[[DVec3::new(x, 0.0, 0.0), DVec3::Y, DVec3::Z]]));
    let ball = || Shape::Sphere { radius: 1.0 };
    let not_finite = Some((42, Problem::NotFinite));
    assert_eq!(problem(vertex(f64::NAN), DAffine3::IDENTITY), not_finite);
    assert_eq!(
        problem(vertex(f64::INFINITY), DAffine3::IDENTITY),
        not_finite
    );
    assert_eq!(
        problem(Shape::Sphere { radius: f64::NAN }, DAffine3::IDENTITY),
        not_finite
    );
    assert_eq!(
        problem(ball(), DAffine3::from_translation(DVec3::X * f64::NAN)),
        not_finite
    );
    let too_large = Some((42, Problem::TooLarge { limit: 1e15 }));
    assert_eq!(problem(vertex(1e30), DAffine3::IDENTITY), too_large);
    assert_eq!(
        problem(ball(), DAffine3::from_translation(DVec3::X * 1e30)),
        too_large
    );
    let singular = Some((42, Problem::Singular));
    assert_eq!(
        problem(ball(), DAffine3::from_scale(DVec3::new(1.0, 0.0, 1.0))),
        singular
    );
    assert_eq!(problem(ball(), DAffine3::from_scale(DVec3::ZERO)), singular);
    let flat = DAffine3::from_mat3(DMat3::from_cols(DVec3::X, DVec3::Y, DVec3::X + DVec3::Y));
    assert_eq!(problem(ball(), flat), singular);
    let negative = Problem::Negative {
        size: "radius",
        value: -1.0,
    };
    assert_eq!(
        problem(Shape::Disk { radius: -1.0 }, DAffine3::IDENTITY),
        Some((42, negative))
    );
    let no_corner = TriangleMesh {
        positions: vec![DVec3::ZERO; 3],
        triangles: vec![[0, 1, 2], [0, 1, 3]],
        ..TriangleMesh::default()
    };
    assert_eq!(
        problem(mesh(no_corner), DAffine3::IDENTITY),
        Some((42, Problem::NoCorner(1)))
    );
    // Fine: tiny, huge, mirrored and very uneven.
    for scale in [
        DVec3::splat(1e-9),
        DVec3::splat(1e9),
        DVec3::new(1e-6, 1e6, -1.0),
    ] {
        assert_eq!(problem(ball(), DAffine3::from_scale(scale)), None);
    }
}

#[test]
fn impossible_groups_are_refused() {
    let build = |groups| Scene::build(describe(groups)).map(|_| ());
    let only = |instances| Group {
        shapes: vec![],
        instances,
    };
    let error = |problem| {
        Err(SceneError::Organ {
            organ: OrganId(42),
            problem,
        })
    };
    let here = DAffine3::IDENTITY;
    assert_eq!(
        build(vec![only(vec![instance(7, here, 42)])]),
        error(Problem::NoGroup(7))
    );
    let cycle = vec![
        only(vec![instance(1, here, 42)]),
        only(vec![instance(0, here, 1)]),
    ];
    assert_eq!(build(cycle), error(Problem::Cycle(1)));
    let flat = DAffine3::from_scale(DVec3::new(1.0, 1.0, 0.0));
    let singular = vec![only(vec![]), only(vec![instance(0, flat, 42)])];
    assert_eq!(build(singular), error(Problem::Singular));
    let no_root = SceneDescription {
        root: Some(GroupId(3)),
        ..SceneDescription::default()
    };
    assert_eq!(
        Scene::build(no_root).map(|_| ()),
        Err(SceneError::NoRoot(3))
    );
    let wrong = PlacedShape {
        material: MaterialId(5),
        ..placed(Shape::Plane, here, 42)
    };
    assert_eq!(
        try_build(vec![wrong]).map(|_| ()),
        error(Problem::NoMaterial(5))
    );
    let bad = vec![Material::default().with_alpha(2.0)];
    let bad = Scene::build(SceneDescription {
        materials: bad,
        ..describe(vec![])
    });
    assert!(matches!(bad, Err(SceneError::Material { index: 0, .. })));
}

/// Each group holds twice the one before it.
fn doubling(levels: u32) -> Vec<Group> {
    let ball = placed(Shape::Sphere { radius: 0.4 }, DAffine3::IDENTITY, 0);
    let shapes = (0..20).map(|k| PlacedShape {
        to_group: DAffine3::from_translation(DVec3::X * f64::from(k)),
        ..ball.clone()
    });
    let mut groups = vec![Group {
        shapes: shapes.collect(),
        instances: vec![],
    }];
    for level in 0..levels {
        let aside = DAffine3::from_translation(DVec3::Y * 2.0_f64.powi(level as i32));
        let instances = vec![
            instance(level, DAffine3::IDENTITY, 1),
            instance(level, aside, 2 + level),
        ];
        groups.push(Group {
            shapes: vec![],
            instances,
        });
    }
    groups
}

#[test]
fn deep_nesting_works_up_to_its_limit_and_is_refused_beyond() {
    let scene = Scene::build(describe(doubling(16))).unwrap();
    assert_eq!(scene.stats().world_primitives, 20 << 16);
    for y in [0, 1, 4097, 65_535] {
        let ray = Ray::new(DVec3::new(7.0, f64::from(y), 9.0), DVec3::NEG_Z);
        let hit = scene.closest(&ray).unwrap();
        let point = scene.surface(&ray, &hit);
        assert!((point.position - DVec3::new(7.0, f64::from(y), 0.4)).length() < 1e-9);
        let outermost = if y >= 32_768 { 17 } else { 1 };
        assert_eq!(point.instance_organ, Some(OrganId(outermost)));
    }
    let deeper = Scene::build(describe(doubling(17))).map(|_| ());
    assert_eq!(deeper, Err(SceneError::TooDeep { limit: 16 }));
    // A chain of groups used once has no depth at all.
    let mut chain = vec![Group {
        shapes: vec![placed(Shape::Sphere { radius: 1.0 }, DAffine3::IDENTITY, 0)],
        instances: vec![],
    }];
    for k in 0..100_000 {
        let step = DAffine3::from_translation(DVec3::X * 1e-3);
        chain.push(Group {
            shapes: vec![],
            instances: vec![instance(k, step, k)],
        });
    }
    let scene = Scene::build(describe(chain)).unwrap();
    let hit = scene
        .closest(&Ray::new(DVec3::X * 200.0, DVec3::NEG_X))
        .unwrap();
    assert!((hit.t - 99.0).abs() < 1e-6);
}

#[test]
fn two_hundred_thousand_things_in_one_place_are_built() {
    let triangle = [DVec3::ZERO, DVec3::X, DVec3::Y];
    let same = build(vec![placed(
        mesh(soup(&vec![triangle; 200_000])),
        DAffine3::IDENTITY,
        0,
    )]);
    let plant = Group {
        shapes: (0..20)
            .map(|k| {
                placed(
                    Shape::Sphere {
                        radius: 1.0 + f64::from(k),
                    },
                    DAffine3::IDENTITY,
                    0,
                )
            })
            .collect(),
        instances: vec![],
    };
    let turned = (0..200_000).map(|k| {
        instance(
            0,
            DAffine3::from_quat(DQuat::from_rotation_z(f64::from(k))),
            k,
        )
    });
    let forest = vec![
        plant,
        Group {
            shapes: vec![],
            instances: turned.collect(),
        },
    ];
    let forest = Scene::build(describe(forest)).unwrap();
    let ray = Ray::new(DVec3::new(0.1, 0.1, 50.0), DVec3::NEG_Z);
    assert!(same.closest(&ray).is_some() && forest.closest(&ray).is_some());
    assert!(forest.occluded(&ray));
}

#[test]
fn the_number_of_threads_changes_nothing() {
    let build = |threads: usize| {
        let pool = rayon::ThreadPoolBuilder::new()
            .num_threads(threads)
            .build()
            .unwrap();
        let groups = forest(&mut Random(55), 3000);
        pool.install(|| Scene::build(describe(groups)).unwrap())
    };
    let (one, four) = (build(1), build(4));
    let mut random = Random(56);
    for _ in 0..3000 {
        let ray = inward(&mut random, 5.0);
        assert_eq!(one.closest(&ray), four.closest(&ray));
    }
}

#[test]
fn an_instance_of_a_forest_costs_little_memory() {
    let mut random = Random(57);
    let mut groups = forest(&mut random, 0);
    let turned = |k: u32| {
        let turn = DAffine3::from_axis_angle(random.direction(), random.between(0.0, 6.0));
        let at = DAffine3::from_translation(random.in_cube() * DVec3::new(1e3, 1e3, 1.0));
        let scale = DAffine3::from_scale(DVec3::splat(random.between(-1.5, -0.5)));
        instance(1, at * turn * scale, k)
    };
    groups[3].instances = (0..20_000).map(turned).collect();
    let stats = Scene::build(describe(groups)).unwrap().stats();
    let each = stats.instance_bytes / stats.instances;
    assert!(each <= 125 && stats.instances == 20_000, "{each}");
}
