//! Closed bodies from within and without, at all scales: C-23, C-24; and instances: C-30.

use super::super::check::{Check, Setting, Trouble};
use super::super::room::gray;
use super::super::worlds::{
    Random, describe, icosphere, instance, mesh, placed, soup, tetrahedron, try_build,
};
use super::Effort;
use crate::geometry::{Shape, TriangleMesh};
use crate::material::Material;
use crate::math::Ray;
use crate::math::functions::{cos, ln, sin};
use crate::scene::Scene;
use crate::scene::description::Group;
use glam::{DAffine3, DMat3, DVec3};

/// The checks.
pub(super) fn checks(effort: Effort) -> Vec<Check> {
    let n = match effort {
        Effort::Short => 10_000,
        Effort::Full => 2_000_000,
    };
    let mut checks = Vec::new();
    for (name, radius) in [("1um", 1.0 / 1e6), ("1m", 1.0), ("1000km", 1e6)] {
        checks.push(none(
            ("23", format!("C-23-ball-{name}")),
            format!("{n} rays each from inside a ball of 5120 triangles, r {name}, at its edges and corners, 0, 1e4 and 1e6 m from the origin, by its place and by its numbers: rays that leave"),
            move |setting| escapes_of_balls(radius, n, setting),
        ));
    }
    checks.push(none(
        ("23", "C-23-instances".into()),
        format!("{n} rays each in four mirrored and stretched instances, one of a millimetre 1e5 m away: rays that leave"),
        move |setting| escapes_of_instances(n, setting),
    ));
    for (name, size) in [
        ("1um", 1.0 / 1e6),
        ("1mm", 1.0 / 1e3),
        ("1m", 1.0),
        ("1km", 1e3),
        ("1000km", 1e6),
    ] {
        checks.push(none(
            ("24", format!("C-24-bodies-{name}")),
            format!("{} bounces in a ball, a frustum, a box and two meshes, size {name}, at the origin and 1e5 sizes away, a fifth of them grazing: lost or returned", n / 10),
            move |setting| false_hits_of_bodies(size, n / 10, setting),
        ));
    }
    checks.push(none(
        ("24", "C-24-large-triangle".into()),
        format!("{} bounces each off a triangle near the origin, 1 µm to 1000 km large: what meets it again", n / 4),
        move |setting| false_hits_of_a_triangle(n / 4, setting),
    ));
    checks.push(none(
        ("30", "C-30-bounces".into()),
        format!("{} bounces in each of six turned, stretched and mirrored instances, 1/1000 to 1000 m large: of the wrong side, lost, or met again", n / 10),
        move |setting| false_hits_of_instances(n / 10, setting),
    ));
    checks.push(none(
        ("30", "C-30-sides".into()),
        "600 looks at balls of two colours from inside and outside, in instances of 1/1000 to 1000 m, uneven and mirrored: wrong sides".into(),
        |_| wrong_sides(),
    ));
    checks
}

/// A count of faults, of which there must be none.
fn none(
    (case, id): (&'static str, String),
    what: String,
    count: impl Fn(&Setting<'_>) -> Result<usize, Trouble> + Send + Sync + 'static,
) -> Check {
    let measure = move |setting: &Setting<'_>| Ok(count(setting)? as f64);
    Check::within((id, what), 0.0, 0.0, measure).of_case(case)
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

/// Sends rays from inside a closed mesh round the origin, put elsewhere by `to_world`, at its corners and edges and counts those that
/// find nothing.
fn escapes(
    scene: &Scene,
    (mesh, to_world, radius): (&TriangleMesh, &DAffine3, f64),
    n: usize,
    setting: &Setting<'_>,
) -> usize {
    let mut random = Random(setting.seed.wrapping_add(1));
    let mut escaped = 0;
    for _ in 0..n {
        if setting.cancel.is_cancelled() {
            break;
        }
        let target = to_world.transform_point3(critical_target(mesh, &mut random));
        let start = to_world.transform_point3(random.in_cube() * 0.5 * radius);
        let ray = Ray::new(start, (target - start).normalize());
        escaped += usize::from(scene.closest(&ray).is_none());
    }
    escaped
}

fn escapes_of_balls(radius: f64, n: usize, setting: &Setting<'_>) -> Result<usize, Trouble> {
    let ball = icosphere(4, radius);
    let mut escaped = 0;
    for offset in [0.0, 1e4, 1e6] {
        // Both ways to put it there: by its placement, and by the numbers of its corners.
        let offset = DVec3::new(offset, -offset * 0.7, offset * 0.3);
        let moved = DAffine3::from_translation(offset);
        let scene = try_build(vec![placed(mesh(ball.clone()), moved, 0)])?;
        escaped += escapes(&scene, (&ball, &moved, radius), n, setting);

        let mut there = ball.clone();
        there.positions.iter_mut().for_each(|at| *at += offset);
        let scene = try_build(vec![placed(mesh(there.clone()), DAffine3::IDENTITY, 0)])?;
        // Corners that were rounded to where they are: aimed at as they are, from starts that are moved.
        let mut random = Random(setting.seed.wrapping_add(2));
        for _ in 0..n {
            let start = offset + random.in_cube() * 0.5 * radius;
            let target = critical_target(&there, &mut random);
            let ray = Ray::new(start, (target - start).normalize());
            escaped += usize::from(scene.closest(&ray).is_none());
        }
    }
    Ok(escaped)
}

fn escapes_of_instances(n: usize, setting: &Setting<'_>) -> Result<usize, Trouble> {
    let ball = icosphere(4, 1.0);
    let tiny_far = DAffine3 {
        matrix3: DMat3::from_diagonal(DVec3::new(0.001, -0.002, 0.0005)),
        translation: DVec3::new(1e5, -3e4, 2e4),
    };
    let maps = [
        Random(5).affine(1.0),
        Random(6).affine(1e3),
        Random(7).affine(0.001),
        tiny_far,
    ];
    let mut escaped = 0;
    for map in maps {
        let aside = DAffine3::from_translation(DVec3::splat(1e4)) * map;
        // Twice, or the group would dissolve.
        let groups = vec![
            Group {
                shapes: vec![placed(mesh(ball.clone()), DAffine3::IDENTITY, 0)],
                instances: vec![],
            },
            Group {
                shapes: vec![],
                instances: vec![instance(0, map, 1), instance(0, aside, 2)],
            },
        ];
        let scene = Scene::build(describe(groups))?;
        if scene.stats().instances != 2 {
            return Err(Trouble("instances have dissolved".into()));
        }
        escaped += escapes(&scene, (&ball, &map, 1.0), n, setting);
    }
    Ok(escaped)
}

/// Lets a ray bounce about inside a convex body, and rays leave outwards, and counts what cannot be: inside every bounce finds another
/// part of the wall, outside nothing.
fn false_hits(scene: &Scene, center: DVec3, n: usize, setting: &Setting<'_>) -> usize {
    let mut random = Random(setting.seed.wrapping_add(11));
    let mut wrong = 0;
    let mut ray = Ray::new(center, random.direction());
    for _ in 0..n {
        if setting.cancel.is_cancelled() {
            break;
        }
        let Some(hit) = scene.closest(&ray) else {
            wrong += 1;
            ray = Ray::new(center, random.direction());
            continue;
        };
        let point = scene.surface(&ray, &hit);
        wrong += usize::from(point.is_front);
        // Some directions graze.
        let mut inward = random.direction();
        inward *= -inward.dot(point.normal_g).signum();
        if random.unit() < 0.2 {
            let flat = inward - point.normal_g * inward.dot(point.normal_g);
            let tilt = crate::math::functions::exp(ln(10.0) * random.between(-12.0, -1.0));
            inward = (flat.normalize() - point.normal_g * tilt).normalize();
        }
        let outward = inward - point.normal_g * (2.0 * inward.dot(point.normal_g));
        wrong += usize::from(scene.closest(&point.spawn_ray(outward)).is_some());
        ray = point.spawn_ray(inward);
    }
    wrong
}

/// Convex bodies of a size, each with how far below the middle its frame is.
fn bodies(size: f64) -> [(Shape, f64); 5] {
    let frustum = Shape::Frustum {
        length: 2.0 * size,
        base_radius: size,
        top_radius: 0.4 * size,
        base_cap: true,
        top_cap: true,
    };
    let cube = Shape::Box {
        half_x: size,
        half_y: 2.0 * size,
        length: size,
    };
    [
        (Shape::Sphere { radius: size }, 0.0),
        (cube, 0.5 * size),
        (mesh(icosphere(3, size)), 0.0),
        (mesh(tetrahedron(size)), 0.0),
        (frustum, size),
    ]
}

fn false_hits_of_bodies(size: f64, n: usize, setting: &Setting<'_>) -> Result<usize, Trouble> {
    let mut wrong = 0;
    for offset in [0.0, 1e5 * size] {
        let center = DVec3::splat(offset);
        for (shape, lift) in bodies(size) {
            let place = DAffine3::from_translation(center - DVec3::Z * lift);
            let scene = try_build(vec![placed(shape, place, 0)])?;
            wrong += false_hits(&scene, center, n, setting);
        }
    }
    Ok(wrong)
}

fn false_hits_of_a_triangle(n: usize, setting: &Setting<'_>) -> Result<usize, Trouble> {
    let mut random = Random(setting.seed.wrapping_add(3));
    let (mut wrong, mut met) = (0, 0);
    for size in [1.0 / 1e6, 0.001, 1.0, 4096.0, 1e6] {
        let corners = [
            [-0.31, -0.52, 0.011],
            [0.73, -0.11, -0.02],
            [-0.2, 0.61, 0.007],
        ]
        .map(|corner| DVec3::from_array(corner) * size);
        let scene = try_build(vec![placed(mesh(soup(&[corners])), DAffine3::IDENTITY, 0)])?;
        for _ in 0..n {
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
            met += 1;
            let point = scene.surface(&ray, &hit);
            let next = point.spawn_ray(random.direction());
            // Excluded by number, but the start alone must be enough on the side it is on, too.
            let off = (next.origin - point.position).length();
            let is_off = off > 0.0 && off * 1e12 < size;
            wrong += usize::from(scene.closest(&next).is_some() || !is_off);
        }
    }
    if met < 4 * n {
        return Err(Trouble(format!("only {met} of {} rays met it", 5 * n)));
    }
    Ok(wrong)
}

fn false_hits_of_instances(n: usize, setting: &Setting<'_>) -> Result<usize, Trouble> {
    let mut random = Random(setting.seed.wrapping_add(8));
    let mut wrong = 0;
    for scale in [0.001, 1.0, 1e3] {
        for shape in [Shape::Sphere { radius: 1.0 }, mesh(icosphere(3, 1.0))] {
            let map = random.affine(scale);
            // Many, so that they stay instances whatever their size.
            let shapes = (0..20).map(|k| {
                let aside = DAffine3::from_translation(DVec3::X * 100.0 * f64::from(k));
                placed(shape.clone(), aside, k)
            });
            let above = DAffine3::from_translation(DVec3::Z * 1e5 * scale) * map;
            let groups = vec![
                Group {
                    shapes: shapes.collect(),
                    instances: vec![],
                },
                Group {
                    shapes: vec![],
                    instances: vec![instance(0, map, 1), instance(0, above, 2)],
                },
            ];
            let scene = Scene::build(describe(groups))?;
            let center = map.translation;
            let mut ray = Ray::new(center, random.direction());
            for _ in 0..n {
                let Some(hit) = scene.closest(&ray) else {
                    wrong += 1;
                    ray = Ray::new(center, random.direction());
                    continue;
                };
                let point = scene.surface(&ray, &hit);
                wrong += usize::from(point.is_front || point.organ.0 != 0);
                let inward = random.direction();
                let inward = inward * -inward.dot(point.normal_g).signum();
                ray = point.spawn_ray(inward);
                // Outwards there may be one of the others, but never the one it starts from.
                let outward = point.spawn_ray(-inward);
                let met = scene.closest(&outward);
                let met = met.map(|hit| scene.surface(&outward, &hit).organ.0);
                wrong += usize::from(met == Some(0));
            }
        }
    }
    Ok(wrong)
}

/// C-30: a ball whose inside and outside shine differently shows the right side through instances of all kinds.
fn wrong_sides() -> Result<usize, Trouble> {
    let ball = Group {
        shapes: (0..20)
            .map(|k| {
                let aside = DAffine3::from_translation(DVec3::X * 10.0 * f64::from(k));
                placed(Shape::Sphere { radius: 1.0 }, aside, k)
            })
            .collect(),
        instances: vec![],
    };
    let mut wrong = 0;
    for scale in [0.001, 1.0, 1e3] {
        for stretch in [
            DVec3::ONE,
            DVec3::new(0.5, 2.0, 1.0),
            DVec3::new(1.0, -1.0, 3.0),
            DVec3::NEG_ONE,
        ] {
            let map = DAffine3::from_mat3(DMat3::from_diagonal(stretch * scale));
            let aside = DAffine3::from_translation(DVec3::Y * 1e3 * scale);
            let pair = Group {
                shapes: vec![],
                instances: vec![instance(0, map, 1), instance(0, aside * map, 2)],
            };
            let mut drawn = describe(vec![ball.clone(), pair]);
            drawn.materials = vec![Material::lambert(gray(0.5)).emitting(gray(1.0), gray(2.0))];
            let scene = Scene::build(drawn)?;
            if scene.stats().instances != 2 {
                return Err(Trouble("instances have dissolved".into()));
            }
            for k in 0..50 {
                let angle = f64::from(k) * 0.7;
                let out = DVec3::new(0.0, cos(angle), sin(angle));
                let inside = Ray::new(DVec3::ZERO, out);
                let outside = Ray::new(out * (20.0 * scale), -out);
                let looks = [(inside, false), (outside, true)];
                wrong += looks
                    .iter()
                    .filter(|(ray, is_front)| {
                        let point = scene.closest(ray).map(|hit| scene.surface(ray, &hit));
                        !point.is_some_and(|point| {
                            let is_outward = point.normal_g.dot(point.position) > 0.0;
                            point.is_front == *is_front && is_outward
                        })
                    })
                    .count();
            }
        }
    }
    Ok(wrong)
}
