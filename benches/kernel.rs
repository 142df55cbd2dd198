//! Rays per second of the tracing core: a tree of a million triangles, an instanced forest, and a Cornell box.
//!
//! `cargo bench --bench kernel`. Prints the best of several runs, in millions of rays per second on one thread and on all.
#![allow(clippy::print_stdout, reason = "a benchmark prints its result")]

#[path = "../tests/support/worlds.rs"]
mod worlds;

use glam::{DAffine3, DMat3, DVec3};
use rayon::prelude::*;
use std::f64::consts::PI;
use std::sync::LazyLock;
use std::time::Instant;
use understory::geometry::{Shape, TriangleMesh};
use understory::math::Ray;
use understory::scene::Scene;
use understory::scene::description::{Group, PlacedShape};
use worlds::{Random, describe, icosphere, instance, mesh, placed};

/// Pixels along one side of the picture whose rays are measured.
const SIDE: usize = 512;

fn main() {
    measure(
        "tree of 1 M triangles",
        tree_mesh(),
        DVec3::new(0.0, -22.0, 9.0),
        DVec3::Z * 7.0,
    );
    measure(
        "forest of 2000 trees, 20 k primitives each",
        forest(),
        DVec3::new(-75.0, -75.0, 35.0),
        DVec3::ZERO,
    );
    measure(
        "the same forest from inside",
        forest(),
        DVec3::new(1.0, 1.0, 1.7),
        DVec3::new(9.0, 9.0, 4.0),
    );
    measure(
        "Cornell box",
        cornell(),
        DVec3::new(2.78, -8.0, 2.73),
        DVec3::new(2.78, 2.8, 2.73),
    );
    many_instances();
}

/// Builds the groups and measures camera rays, bounces off what they hit, and rays to the sun from there.
fn measure(name: &str, groups: Vec<Group>, eye: DVec3, target: DVec3) {
    let start = Instant::now();
    let scene = Scene::build(describe(groups)).expect("the scene is valid");
    let build = start.elapsed().as_secs_f64();
    let stats = scene.stats();
    println!(
        "{name}: built in {build:.2} s, {:.1} MB, {} stored primitives",
        stats.bytes as f64 / 1e6,
        stats.primitives
    );

    let camera = camera_rays(eye, target);
    let mut random = Random(1);
    let points: Vec<_> = camera
        .iter()
        .filter_map(|ray| scene.closest(ray).map(|hit| scene.surface(ray, &hit)))
        .collect();
    let facing = |point: &understory::scene::SurfacePoint| {
        if point.is_front {
            point.normal_g
        } else {
            -point.normal_g
        }
    };
    let bounces: Vec<Ray> = points
        .iter()
        .map(|point| point.spawn_ray((facing(point) + random.direction() * 0.999).normalize()))
        .collect();
    let sun = DVec3::new(0.4, -0.3, 0.87).normalize();
    let shadows: Vec<Ray> = points.iter().map(|point| point.spawn_ray(sun)).collect();
    rate("camera", &camera, |ray| scene.closest(ray).is_some());
    rate("bounce", &bounces, |ray| scene.closest(ray).is_some());
    rate("bounce, any hit", &bounces, |ray| scene.occluded(ray));
    rate("sun", &shadows, |ray| scene.occluded(ray));
    rate("camera with shading", &camera, |ray| {
        scene
            .closest(ray)
            .is_some_and(|hit| scene.surface(ray, &hit).is_front)
    });
}

/// Prints how many rays per second a query answers, and how many of them hit.
fn rate(name: &str, rays: &[Ray], query: impl Fn(&Ray) -> bool + Sync) {
    let mut best = [0.0_f64; 2];
    let mut hits = 0;
    for _ in 0..4 {
        let start = thread_seconds();
        hits = rays.iter().filter(|ray| query(ray)).count();
        best[0] = best[0].max(rays.len() as f64 / (thread_seconds() - start));
        let start = Instant::now();
        let again = rays
            .par_chunks(256)
            .map(|rays| rays.iter().filter(|ray| query(ray)).count());
        assert_eq!(again.sum::<usize>(), hits);
        best[1] = best[1].max(rays.len() as f64 / start.elapsed().as_secs_f64());
    }
    println!(
        "    {name:20} {:6.2} / {:6.2} Mrays/s, {:3.0} % hit",
        best[0] / 1e6,
        best[1] / 1e6,
        100.0 * hits as f64 / rays.len().max(1) as f64
    );
}

/// Processor time of this thread in seconds where the system tells (other work on the machine does not count then),
/// otherwise wall clock.
fn thread_seconds() -> f64 {
    static START: LazyLock<Instant> = LazyLock::new(Instant::now);
    let text = std::fs::read_to_string("/proc/thread-self/schedstat").ok();
    let nanoseconds = text.and_then(|text| text.split(' ').next()?.parse::<f64>().ok());
    nanoseconds.map_or_else(
        || START.elapsed().as_secs_f64(),
        |nanoseconds| nanoseconds * 1e-9,
    )
}

/// Rays through the pixels in blocks of 8 × 8.
fn camera_rays(eye: DVec3, target: DVec3) -> Vec<Ray> {
    let forward = (target - eye).normalize();
    let right = forward.cross(DVec3::Z).normalize();
    let up = right.cross(forward);
    let blocks = SIDE / 8;
    (0..SIDE * SIDE)
        .map(|index| {
            let (block, within) = (index / 64, index % 64);
            let x = (block % blocks * 8 + within % 8) as f64 + 0.5;
            let y = (block / blocks * 8 + within / 8) as f64 + 0.5;
            let (x, y) = (x / SIDE as f64 - 0.5, 0.5 - y / SIDE as f64);
            Ray::new(eye, (forward + (right * x + up * y) * 0.8).normalize())
        })
        .collect()
}

/// Segments of a branching skeleton: start, end, radius; and whether it bears leaves.
fn skeleton(random: &mut Random, levels: u32) -> Vec<(DVec3, DVec3, f64, bool)> {
    let mut segments = Vec::new();
    let mut open = vec![(DVec3::ZERO, DVec3::Z, 4.0, 0.25, levels)];
    while let Some((start, direction, length, radius, level)) = open.pop() {
        let end = start + direction * length;
        segments.push((start, end, radius, level <= 2));
        if level == 0 {
            continue;
        }
        for _ in 0..3 {
            let next = (direction + random.direction() * 0.9 + DVec3::Z * 0.1).normalize();
            let at = start.lerp(end, random.between(0.5, 1.0));
            open.push((
                at,
                next,
                length * random.between(0.6, 0.85),
                radius * 0.6,
                level - 1,
            ));
        }
    }
    segments
}

fn leaf_frame(random: &mut Random, from: DVec3, to: DVec3) -> (DVec3, DVec3, DVec3) {
    let at = from.lerp(to, random.unit());
    let along = random.direction();
    let across = along.any_orthonormal_vector();
    (at, along * 0.08, across * 0.04)
}

/// About a million triangles: tubes of eight sides, and leaves of two triangles.
fn tree_mesh() -> Vec<Group> {
    let mut random = Random(7);
    let mut all = TriangleMesh::default();
    for (start, end, radius, bears) in skeleton(&mut random, 8) {
        let first = all.positions.len() as u32;
        let axis = (end - start).normalize();
        let (x, y) = axis.any_orthonormal_pair();
        for k in 0..8 {
            let angle = f64::from(k) * PI / 4.0;
            let out = (x * angle.cos() + y * angle.sin()) * radius;
            all.positions.extend([start + out, end + out * 0.7]);
            let (a, b) = (first + 2 * k, first + 2 * ((k + 1) % 8));
            all.triangles.extend([[a, b, a + 1], [b, b + 1, a + 1]]);
        }
        for _ in 0..if bears { 45 } else { 0 } {
            let (at, along, across) = leaf_frame(&mut random, start, end);
            let first = all.positions.len() as u32;
            all.positions.extend([
                at,
                at + along * 0.5 + across,
                at + along,
                at + along * 0.5 - across,
            ]);
            all.triangles
                .extend([[first, first + 1, first + 2], [first, first + 2, first + 3]]);
        }
    }
    vec![Group {
        shapes: vec![placed(mesh(all), DAffine3::IDENTITY, 0)],
        instances: vec![],
    }]
}

/// A tree of frusta and parallelograms, about 20 000.
fn tree_of_solids(seed: u64) -> Vec<PlacedShape> {
    let mut random = Random(seed);
    let mut shapes = Vec::new();
    for (start, end, radius, bears) in skeleton(&mut random, 6) {
        let axis = end - start;
        let (x, y) = axis.normalize().any_orthonormal_pair();
        let frame =
            DAffine3::from_mat3_translation(DMat3::from_cols(x, y, axis.normalize()), start);
        let branch = Shape::Frustum {
            length: axis.length(),
            base_radius: radius,
            top_radius: radius * 0.7,
            base_cap: false,
            top_cap: false,
        };
        shapes.push(placed(branch, frame, 1));
        for _ in 0..if bears { 18 } else { 0 } {
            let (corner, edge_u, edge_v) = leaf_frame(&mut random, start, end);
            let leaf = Shape::Parallelogram {
                corner,
                edge_u: edge_u * 3.0,
                edge_v: edge_v * 3.0,
            };
            shapes.push(placed(leaf, DAffine3::IDENTITY, 2));
        }
    }
    shapes
}

/// 2000 trees of four kinds, turned and scaled, on a plane.
fn forest() -> Vec<Group> {
    let mut groups: Vec<Group> = (0..4)
        .map(|seed| Group {
            shapes: tree_of_solids(seed + 1),
            instances: vec![],
        })
        .collect();
    let mut random = Random(3);
    let instances = (0..2000).map(|k| {
        let at = DVec3::new(
            random.between(-90.0, 90.0),
            random.between(-90.0, 90.0),
            0.0,
        );
        let turn = DAffine3::from_rotation_z(random.between(0.0, 2.0 * PI));
        let grow = DAffine3::from_scale(DVec3::splat(random.between(0.7, 1.3)));
        instance(k % 4, DAffine3::from_translation(at) * turn * grow, k)
    });
    let instances = instances.collect();
    groups.push(Group {
        shapes: vec![placed(Shape::Plane, DAffine3::IDENTITY, 0)],
        instances,
    });
    groups
}

fn cornell() -> Vec<Group> {
    let wall = |corner: [f64; 3], edge_u: DVec3, edge_v: DVec3| {
        let corner = DVec3::from_array(corner);
        placed(
            Shape::Parallelogram {
                corner,
                edge_u,
                edge_v,
            },
            DAffine3::IDENTITY,
            0,
        )
    };
    let (x, y, z) = (DVec3::X * 5.5, DVec3::Y * 5.6, DVec3::Z * 5.5);
    let block = |at: [f64; 2], turn: f64, length: f64| {
        let place = DAffine3::from_translation(DVec3::new(at[0], at[1], 0.0));
        let shape = Shape::Box {
            half_x: 0.83,
            half_y: 0.83,
            length,
        };
        placed(shape, place * DAffine3::from_rotation_z(turn), 1)
    };
    let ball = placed(
        mesh(icosphere(3, 0.7)),
        DAffine3::from_translation(DVec3::new(1.8, 1.7, 2.4)),
        2,
    );
    let shapes = vec![
        wall([0.0, 0.0, 0.0], x, y),
        wall([0.0, 0.0, 5.5], x, y),
        wall([0.0, 5.6, 0.0], x, z),
        wall([0.0, 0.0, 0.0], y, z),
        wall([5.5, 0.0, 0.0], y, z),
        wall([2.1, 2.3, 5.49], DVec3::X * 1.3, DVec3::Y),
        block([3.7, 3.5], 0.3, 3.3),
        block([1.8, 1.7], -0.3, 1.65),
        ball,
    ];
    vec![Group {
        shapes,
        instances: vec![],
    }]
}

/// A million instances: time to build, and bytes for each.
fn many_instances() {
    let mut groups = vec![Group {
        shapes: tree_of_solids(1),
        instances: vec![],
    }];
    let mut random = Random(4);
    let instances = (0..1_000_000).map(|k| {
        let at = DVec3::new(random.between(-2e3, 2e3), random.between(-2e3, 2e3), 0.0);
        let turn = DAffine3::from_rotation_z(random.between(0.0, 2.0 * PI));
        instance(0, DAffine3::from_translation(at) * turn, k)
    });
    let instances = instances.collect();
    groups.push(Group {
        shapes: vec![],
        instances,
    });
    let description = describe(groups);
    let start = Instant::now();
    let scene = Scene::build(description).expect("the scene is valid");
    let stats = scene.stats();
    println!(
        "a million instances: built in {:.2} s, {} bytes each",
        start.elapsed().as_secs_f64(),
        stats.instance_bytes / stats.instances
    );
    let rays = camera_rays(DVec3::new(-50.0, -50.0, 40.0), DVec3::ZERO);
    rate("camera", &rays, |ray| scene.closest(ray).is_some());
}
