//! Instances, transparency, emitters and meshes: what a whole scene answers.

use crate::shapes::{all_along, inward, shapes};
use crate::worlds::{Random, build, describe, icosphere, instance, mesh, placed};
use glam::{DAffine3, DVec2, DVec3};
use understory::color::Rgb;
use understory::geometry::Shape;
use understory::material::Material;
use understory::math::Ray;
use understory::scene::Scene;
use understory::scene::description::{Group, MaterialId, OrganId, PlacedShape, SceneDescription};

/// A forest: prototypes of many shapes, some nested, planted many times.
pub(crate) fn forest(random: &mut Random, n_instances: usize) -> Vec<Group> {
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

/// C-21, of what rays find (the picture: `tests/extremes.rs`).
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

/// C-22, of what rays find (the picture: `tests/extremes.rs`).
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
        assert!(near(open.transmittance(&ray).g, 40) && near(clear.transmittance(&ray).g, 38));
        let found = all_along(&open, &ray);
        assert!(found.len() == 40 && found.is_sorted_by(|a, b| a.t < b.t));
        assert!(!open.occluded(&ray) && closed.occluded(&ray));
        // As far as the middle of the third ball: five surfaces.
        assert!(near(closed.transmittance(&ray.until(11.0)).g, 5));
        let inside = Ray {
            t_min: 5.0,
            ..ray.until(8.0)
        };
        assert!(near(closed.transmittance(&inside).g, 2));
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
