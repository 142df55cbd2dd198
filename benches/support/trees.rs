//! The worlds of the kernel benchmark: trees, forests of them, a Cornell box.

use super::worlds::{Random, icosphere, instance, mesh, placed};
use glam::{DAffine3, DMat3, DVec3};
use std::f64::consts::PI;
use understory::geometry::{Shape, TriangleMesh};
use understory::scene::description::{Group, PlacedShape};

/// Kinds of trees in a forest.
const KINDS: usize = 4;
/// Ground per tree in a forest, in square metres.
const GROUND: f64 = 16.2;

/// A part of a skeleton.
struct Segment {
    start: DVec3,
    end: DVec3,
    radius: f64,
    bears_leaves: bool,
}

/// A branching skeleton, about 12 m high.
fn skeleton(random: &mut Random, levels: u32) -> Vec<Segment> {
    let mut segments = Vec::new();
    let mut open = vec![(DVec3::ZERO, DVec3::Z, 4.0, 0.25, levels)];
    while let Some((start, direction, length, radius, level)) = open.pop() {
        let end = start + direction * length;
        segments.push(Segment {
            start,
            end,
            radius,
            bears_leaves: level <= 2,
        });
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

/// Where a leaf sits, how it points and how wide it is.
fn leaf_frame(random: &mut Random, segment: &Segment) -> (DVec3, DVec3, DVec3) {
    let at = segment.start.lerp(segment.end, random.unit());
    let along = random.direction();
    let across = along.any_orthonormal_vector();
    (at, along * 0.08, across * 0.04)
}

/// Triangles: branches as tubes of eight sides, leaves of two triangles and `size` times 8 cm long.
fn tree_of_triangles(seed: u64, levels: u32, leaves: usize, size: f64) -> TriangleMesh {
    let mut random = Random(seed);
    let mut all = TriangleMesh::default();
    for segment in skeleton(&mut random, levels) {
        let Segment {
            start, end, radius, ..
        } = segment;
        let first = all.positions.len() as u32;
        let (x, y) = (end - start).normalize().any_orthonormal_pair();
        for k in 0..8 {
            let angle = f64::from(k) * PI / 4.0;
            let out = (x * angle.cos() + y * angle.sin()) * radius;
            all.positions.extend([start + out, end + out * 0.7]);
            let (a, b) = (first + 2 * k, first + 2 * ((k + 1) % 8));
            all.triangles.extend([[a, b, a + 1], [b, b + 1, a + 1]]);
        }
        for _ in 0..if segment.bears_leaves { leaves } else { 0 } {
            let (at, along, across) = leaf_frame(&mut random, &segment);
            let (along, across) = (along * size, across * size);
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
    all
}

/// Frusta and parallelograms, about 20 000.
fn tree_of_solids(seed: u64) -> Vec<PlacedShape> {
    let mut random = Random(seed);
    let mut shapes = Vec::new();
    for segment in skeleton(&mut random, 6) {
        let axis = segment.end - segment.start;
        let (x, y) = axis.normalize().any_orthonormal_pair();
        let turn = DMat3::from_cols(x, y, axis.normalize());
        let branch = Shape::Frustum {
            length: axis.length(),
            base_radius: segment.radius,
            top_radius: segment.radius * 0.7,
            base_cap: false,
            top_cap: false,
        };
        let frame = DAffine3::from_mat3_translation(turn, segment.start);
        shapes.push(placed(branch, frame, 1));
        for _ in 0..if segment.bears_leaves { 18 } else { 0 } {
            let (corner, edge_u, edge_v) = leaf_frame(&mut random, &segment);
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

/// One tree of about a million triangles.
pub(crate) fn big_tree() -> Vec<Group> {
    vec![Group {
        shapes: vec![placed(
            mesh(tree_of_triangles(7, 8, 45, 1.0)),
            DAffine3::IDENTITY,
            0,
        )],
        instances: vec![],
    }]
}

/// What the trees of a forest are made of.
#[derive(Clone, Copy, PartialEq)]
pub(crate) enum Parts {
    /// Triangles, about 20 000 a tree.
    Triangles,
    /// Frusta and parallelograms, about 20 000 a tree.
    Solids,
}

/// Trees of four kinds, turned and scaled, on a plane.
pub(crate) fn forest(parts: Parts, count: u32) -> Vec<Group> {
    let tree = |seed| match parts {
        Parts::Solids => tree_of_solids(seed),
        Parts::Triangles => vec![placed(
            mesh(tree_of_triangles(seed, 5, 20, 3.0)),
            DAffine3::IDENTITY,
            1,
        )],
    };
    let mut groups: Vec<Group> = (1..=KINDS as u64)
        .map(|seed| Group {
            shapes: tree(seed),
            instances: vec![],
        })
        .collect();
    let mut random = Random(3);
    let half = 0.5 * (f64::from(count) * GROUND).sqrt();
    let instances = (0..count).map(|k| {
        let (x, y) = (random.between(-half, half), random.between(-half, half));
        let turn = DAffine3::from_rotation_z(random.between(0.0, 2.0 * PI));
        let grow = DAffine3::from_scale(DVec3::splat(random.between(0.7, 1.3)));
        let at = DAffine3::from_translation(DVec3::new(x, y, 0.0));
        instance(k % KINDS as u32, at * turn * grow, k)
    });
    let instances = instances.collect();
    groups.push(Group {
        shapes: vec![placed(Shape::Plane, DAffine3::IDENTITY, 0)],
        instances,
    });
    groups
}

/// Walls, a lamp, two blocks and a ball of triangles.
pub(crate) fn cornell() -> Vec<Group> {
    let wall = |corner: [f64; 3], edge_u: DVec3, edge_v: DVec3| {
        let corner = DVec3::from_array(corner);
        let shape = Shape::Parallelogram {
            corner,
            edge_u,
            edge_v,
        };
        placed(shape, DAffine3::IDENTITY, 0)
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
