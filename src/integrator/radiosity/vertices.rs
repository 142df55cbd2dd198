//! Irradiance between the middles of elements: shared by elements that meet at a corner without a crease.
//!
//! A corner has the mean of the elements around it, weighted by area and angle; within an element it is interpolated. Where
//! small elements end at the edge of a large one, their corners have what the large one has there: no edge shows.

use super::mesh::{Mesh, NONE};
use crate::color::Rgb;
use crate::math::functions::{acos, cos};
use crate::math::tolerance::WELD;
use glam::{DVec2, DVec3, I64Vec3};
use std::collections::HashMap;

/// Angle between normals from which on an edge is a crease, radians: 30°.
const CREASE: f64 = std::f64::consts::FRAC_PI_6;

/// A corner that elements share.
#[derive(Clone, Copy, Debug)]
struct Vertex {
    position: DVec3,
    normal: DVec3,
    /// Sums over elements, front and back, and of weights.
    sums: [Rgb; 2],
    weight: f64,
}

/// Irradiance at the corners of all elements.
#[derive(Debug)]
pub(super) struct Vertices {
    /// Of each node, the vertices at its corners; of elements only.
    pub(super) corners: Vec<[u32; 4]>,
    /// Front and back.
    pub(super) values: Vec<[Rgb; 2]>,
}

/// Corners by place.
pub(super) struct Welder {
    width: f64,
    /// Vertices in each cell of space. Only looked up, never gone through.
    cells: HashMap<I64Vec3, Vec<u32>>,
    vertices: Vec<Vertex>,
    most_turn: f64,
}

impl Welder {
    /// For a scene of this size, metres.
    pub(super) fn new(size: f64) -> Self {
        Self {
            width: size * WELD,
            cells: HashMap::new(),
            vertices: Vec::new(),
            most_turn: cos(CREASE),
        }
    }

    fn cell(&self, position: DVec3) -> I64Vec3 {
        (position / self.width).round().as_i64vec3()
    }

    /// The vertex at a place with about this normal.
    pub(super) fn find(&self, position: DVec3, normal: DVec3) -> Option<u32> {
        let cell = self.cell(position);
        for k in 0..27 {
            let step = I64Vec3::new(k % 3 - 1, k / 3 % 3 - 1, k / 9 - 1);
            for at in self.cells.get(&(cell + step)).into_iter().flatten() {
                let vertex = &self.vertices[*at as usize];
                let is_near = vertex.position.distance(position) <= self.width;
                if is_near && vertex.normal.dot(normal) >= self.most_turn {
                    return Some(*at);
                }
            }
        }
        None
    }

    pub(super) fn find_or_add(&mut self, position: DVec3, normal: DVec3) -> u32 {
        self.find(position, normal).unwrap_or_else(|| {
            let at = self.vertices.len() as u32;
            self.vertices.push(Vertex {
                position,
                normal,
                sums: [Rgb::BLACK; 2],
                weight: 0.0,
            });
            self.cells.entry(self.cell(position)).or_default().push(at);
            at
        })
    }
}

/// Pairs of corners that an edge joins, for cells of three and of four corners.
pub(super) const EDGES: [&[[usize; 2]]; 2] =
    [&[[0, 1], [1, 2], [2, 0]], &[[0, 1], [1, 3], [3, 2], [2, 0]]];

impl Vertices {
    /// Shares the irradiance of elements, given per node (front, back). `size` is that of the scene in metres.
    pub(super) fn new(mesh: &Mesh, irradiance: &[[Rgb; 2]], size: f64) -> Self {
        let mut welder = Welder::new(size);
        let mut corners = vec![[NONE; 4]; mesh.nodes.len()];
        for node in mesh.elements() {
            let ends = corner_points(mesh, node);
            let positions: Vec<DVec3> = ends.iter().map(|end| end.0).collect();
            let area = mesh.nodes[node as usize].area;
            for (k, (position, normal)) in ends.iter().enumerate() {
                let at = welder.find_or_add(*position, *normal);
                corners[node as usize][k] = at;
                let weight = area * angle_at(&positions, k);
                let vertex = &mut welder.vertices[at as usize];
                vertex.weight += weight;
                for (sum, own) in vertex.sums.iter_mut().zip(irradiance[node as usize]) {
                    *sum += own * weight;
                }
            }
        }
        let mean = |vertex: &Vertex| {
            let share = if vertex.weight > 0.0 {
                1.0 / vertex.weight
            } else {
                0.0
            };
            vertex.sums.map(|sum| sum * share)
        };
        let mut values: Vec<[Rgb; 2]> = welder.vertices.iter().map(mean).collect();
        hang(mesh, &welder, &corners, &mut values);
        Self { corners, values }
    }

    /// Front and back at the corners of an element.
    pub(super) fn of(&self, node: u32) -> impl Iterator<Item = &[Rgb; 2]> {
        let corners = self.corners[node as usize].iter();
        corners.filter_map(|corner| self.values.get(*corner as usize))
    }

    /// Front and back at a place in an element, of such values at corners.
    pub(super) fn between(
        &self,
        values: &[[Rgb; 2]],
        (node, within): (u32, DVec2),
        is_triangle: bool,
    ) -> [Rgb; 2] {
        let DVec2 { x, y } = within;
        let weights = if is_triangle {
            [1.0 - x - y, x, y, 0.0].map(|weight| weight.max(0.0))
        } else {
            [(1.0 - x) * (1.0 - y), x * (1.0 - y), (1.0 - x) * y, x * y]
        };
        let mut sum = [Rgb::BLACK; 2];
        for (corner, weight) in self.corners[node as usize].iter().zip(weights) {
            if let Some(value) = values.get(*corner as usize) {
                sum[0] += value[0] * weight;
                sum[1] += value[1] * weight;
            }
        }
        sum
    }
}

/// Elements with edges at which others end that are more than one split smaller: corners lie at a quarter of the edge. An edge
/// without length, as at the middle of a disk, has its own corners there, which do not count.
pub(super) fn crowded(mesh: &Mesh, size: f64) -> Vec<u32> {
    let mut welder = Welder::new(size);
    for node in mesh.elements() {
        for (position, normal) in corner_points(mesh, node) {
            welder.find_or_add(position, normal);
        }
    }
    let is_crowded = |node: &u32| {
        let cell = &mesh.nodes[*node as usize].cell;
        let chart = &mesh.charts[cell.chart as usize].chart;
        let ends = mesh.corners(cell);
        let vertex = |uv: DVec2| {
            let point = chart.point(uv);
            welder.find(point.position, point.normal)
        };
        EDGES[ends.len() - 3].iter().any(|[a, b]| {
            let own = [vertex(ends[*a]), vertex(ends[*b])];
            [0.25, 0.75].into_iter().any(|share| {
                let found = vertex(ends[*a].lerp(ends[*b], share));
                found.is_some() && !own.contains(&found)
            })
        })
    };
    mesh.elements().filter(is_crowded).collect()
}

/// Where the corners of an element are, and the normals there.
fn corner_points(mesh: &Mesh, node: u32) -> Vec<(DVec3, DVec3)> {
    let cell = &mesh.nodes[node as usize].cell;
    let chart = &mesh.charts[cell.chart as usize].chart;
    let corners = mesh.corners(cell).into_iter();
    corners
        .map(|uv| {
            let point = chart.point(uv);
            (point.position, point.normal)
        })
        .collect()
}

/// The angle of a cell at a corner, radians; a right one where edges have no length.
fn angle_at(positions: &[DVec3], corner: usize) -> f64 {
    let neighbours = match (positions.len(), corner) {
        (3, _) => [(corner + 1) % 3, (corner + 2) % 3],
        (_, 0 | 3) => [1, 2],
        _ => [0, 3],
    };
    let [a, b] = neighbours.map(|other| (positions[other] - positions[corner]).normalize_or_zero());
    acos(a.dot(b).clamp(-1.0, 1.0))
}

/// Gives corners that lie in the middle of an edge the mean of its ends, long edges first.
fn hang(mesh: &Mesh, welder: &Welder, corners: &[[u32; 4]], values: &mut [[Rgb; 2]]) {
    let mut hanging: Vec<(f64, [u32; 3])> = Vec::new();
    for node in mesh.elements() {
        let cell = &mesh.nodes[node as usize].cell;
        let chart = &mesh.charts[cell.chart as usize].chart;
        let ends = mesh.corners(cell);
        for [a, b] in EDGES[ends.len() - 3] {
            let middle = chart.point((ends[*a] + ends[*b]) * 0.5);
            let own = corners[node as usize];
            let found = welder.find(middle.position, middle.normal);
            if let Some(found) = found.filter(|found| *found != own[*a] && *found != own[*b]) {
                let from = chart.point(ends[*a]).position;
                let length = from.distance(chart.point(ends[*b]).position);
                hanging.push((length, [found, own[*a], own[*b]]));
            }
        }
    }
    hanging.sort_by(|a, b| b.0.total_cmp(&a.0).then(a.1.cmp(&b.1)));
    for (_, [middle, a, b]) in hanging {
        let (a, b) = (values[a as usize], values[b as usize]);
        values[middle as usize] = [0, 1].map(|side| (a[side] + b[side]) * 0.5);
    }
}
