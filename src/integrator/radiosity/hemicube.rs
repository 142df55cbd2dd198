//! Form factors by hemicubes: all surfaces are drawn onto half a cube around the middle of a cell, the nearest in each pixel wins.
//!
//! [`CohenGreenberg1985`](crate::references#cohengreenberg1985): each pixel has its own small form factor, and a row is the sum over the
//! pixels in which a patch is seen. As GroIMP does it, but with the right weights on the sides of the cube, two by two cubes on each
//! cell, and the sum of all pixels made 1. Its error is that of points: a cube stands for the part of the cell around it, however near
//! others are, and what is smaller than a pixel may be lost.
//!
//! Drawn are flat faces as they are, disks pixel by pixel, and round ones in small facets. Where a pixel shows a surface that is not
//! matt, or nothing while there are infinite planes, a ray goes on through its middle.

use super::mesh::{Cell, Mesh};
use super::rays::cell_point;
use super::system::{FormFactors, Row};
use crate::color::Rgb;
use crate::geometry::chart::Form;
use crate::integrator::RayCounts;
use crate::integrator::carrier::Carrier;
use crate::material::Transport;
use crate::math::frame::Frame;
use crate::math::rng;
use crate::math::tolerance::{HEMICUBE_HORIZON, HEMICUBE_NEAR, PIXEL_SLACK};
use crate::sampler::{Sampler, SamplerKind};
use crate::scene::SurfacePoint;
use glam::{DVec2, DVec3};
use std::f64::consts::PI;

/// What the random numbers of rays through pixels are for.
const PIXELS: u64 = 0x7069_7865;

/// Parts along each side into which patches of round faces are cut to be drawn.
const FACETS: u32 = 4;

/// No polygon.
const NOTHING: u32 = u32::MAX;

/// A flat thing that is drawn.
#[derive(Clone, Debug)]
struct Polygon {
    corners: [DVec3; 4],
    n: usize,
    chart: u32,
    /// The patch if it is known whatever pixel shows it.
    patch: Option<u32>,
}

/// Hemicubes over the cells of a mesh.
pub(super) struct Hemicubes<'a, 's> {
    mesh: &'a Mesh,
    carrier: &'a Carrier<'s>,
    seed: u64,
    /// Pixels along an edge of a cube.
    pixels: usize,
    /// Cubes along a side of a cell.
    cubes: u32,
    /// Geometry nearer than half of this, metres, is not drawn; `None`: very near.
    size: Option<f64>,
    polygons: Vec<Polygon>,
    has_planes: bool,
    faces: Vec<Face>,
}

/// A face of the cube: its axes in the frame of the cell, and its pixels.
struct Face {
    right: DVec3,
    up: DVec3,
    forward: DVec3,
    /// Rows of pixels; those of the sides begin at the plane of the cell.
    rows: usize,
    lowest: f64,
    /// Form factor of each pixel.
    factors: Vec<f64>,
}

impl Face {
    fn new(right: DVec3, up: DVec3, forward: DVec3, pixels: usize) -> Self {
        let is_top = forward.z > 0.5;
        let (rows, lowest) = if is_top {
            (pixels, -1.0)
        } else {
            (pixels.div_ceil(2), 0.0)
        };
        let mut face = Self {
            right,
            up,
            forward,
            rows,
            lowest,
            factors: Vec::new(),
        };
        let area = 2.0 / pixels as f64 * face.height();
        for k in 0..pixels * rows {
            let at = face.pixel(k, pixels);
            // On top the cosines at both ends are those of the pixel's direction; on a side one is that of its height.
            let square = at.length_squared() + 1.0;
            let height = if is_top { 1.0 } else { at.y };
            face.factors.push(height * area / (PI * square * square));
        }
        face
    }

    /// Height of a row of pixels.
    fn height(&self) -> f64 {
        (1.0 - self.lowest) / self.rows as f64
    }

    /// The middle of a pixel, on the plane at distance 1.
    fn pixel(&self, k: usize, pixels: usize) -> DVec2 {
        let (x, y) = ((k % pixels) as f64 + 0.5, (k / pixels) as f64 + 0.5);
        DVec2::new(
            2.0 * x / pixels as f64 - 1.0,
            self.lowest + y * self.height(),
        )
    }

    fn direction(&self, at: DVec2) -> DVec3 {
        self.right * at.x + self.up * at.y + self.forward
    }
}

/// What the pixels of a face show.
struct Buffer {
    /// 1 / distance along the face's axis.
    depths: Vec<f64>,
    polygons: Vec<u32>,
}

impl<'a, 's> Hemicubes<'a, 's> {
    pub(super) fn new(
        mesh: &'a Mesh,
        carrier: &'a Carrier<'s>,
        seed: u64,
        pixels: u32,
        cubes: u32,
        size: Option<f64>,
    ) -> Self {
        let n = pixels.max(1) as usize;
        let (x, y, z) = (DVec3::X, DVec3::Y, DVec3::Z);
        let mut faces = vec![
            Face::new(x, y, z, n),
            Face::new(y, z, x, n),
            Face::new(-x, z, y, n),
            Face::new(-y, z, -x, n),
            Face::new(x, z, -y, n),
        ];
        let sum: f64 = faces.iter().flat_map(|face| &face.factors).sum();
        let all = faces.iter_mut().flat_map(|face| &mut face.factors);
        all.for_each(|factor| *factor /= sum);
        Self {
            mesh,
            carrier,
            seed,
            pixels: n,
            cubes: cubes.max(1),
            size,
            polygons: polygons(mesh),
            has_planes: mesh.charts.iter().any(|chart| chart.is_plane()),
            faces,
        }
    }

    /// Draws what is seen from a point onto one face.
    fn draw(&self, face: &Face, frame: &Frame, eye: DVec3, near: f64, buffer: &mut Buffer) {
        buffer.depths.clear();
        buffer.depths.resize(self.pixels * face.rows, 0.0);
        buffer.polygons.clear();
        buffer.polygons.resize(self.pixels * face.rows, NOTHING);
        let axes = [face.right, face.up, face.forward].map(|axis| frame.to_world(axis));
        for (number, polygon) in (0_u32..).zip(&self.polygons) {
            let seen = |corner: &DVec3| {
                let to = *corner - eye;
                DVec3::from_array(axes.map(|axis| axis.dot(to)))
            };
            let corners: Vec<DVec3> = polygon.corners[..polygon.n].iter().map(seen).collect();
            let clipped = clip(&corners, face.lowest, near);
            if clipped.len() >= 3 {
                self.fill(
                    face,
                    (number, polygon),
                    (&corners, &clipped),
                    (axes, eye),
                    buffer,
                );
            }
        }
    }

    /// Fills the pixels whose middle lies in a polygon, given in the face's axes whole and clipped, where it is the nearest.
    fn fill(
        &self,
        face: &Face,
        (number, polygon): (u32, &Polygon),
        (corners, clipped): (&[DVec3], &[DVec3]),
        (axes, eye): ([DVec3; 3], DVec3),
        buffer: &mut Buffer,
    ) {
        let normal = (corners[1] - corners[0]).cross(corners[2] - corners[0]);
        let offset = normal.dot(corners[0]);
        if offset == 0.0 {
            return;
        }
        let chart = &self.mesh.charts[polygon.chart as usize].chart;
        let flat: Vec<DVec2> = clipped.iter().map(|p| p.truncate() / p.z).collect();
        let (low, high) = flat
            .iter()
            .fold((f64::INFINITY, f64::NEG_INFINITY), |(low, high), p| {
                (low.min(p.y), high.max(p.y))
            });
        // Middles that lie on an edge that two share belong to both: roundings must not make them belong to none.
        // Just within its ends a polygon is as wide as there: at the very end, of an edge that is not quite level, only a corner is met.
        let inset = (PIXEL_SLACK * face.height()).min(0.5 * (high - low));
        let row = |y: f64| (y - face.lowest) / face.height() - 0.5;
        let last = (row(high) + PIXEL_SLACK)
            .floor()
            .min(face.rows as f64 - 1.0);
        let mut y = (row(low) - PIXEL_SLACK).ceil().max(0.0);
        while y <= last {
            let middle = face.lowest + (y + 0.5) * face.height();
            let (left, right) = span(&flat, middle.max(low + inset).min(high - inset));
            let column = |x: f64| (x + 1.0) * 0.5 * self.pixels as f64 - 0.5;
            let end = (column(right) + PIXEL_SLACK)
                .floor()
                .min(self.pixels as f64 - 1.0);
            let mut x = (column(left) - PIXEL_SLACK).ceil().max(0.0);
            while x <= end {
                let at = y as usize * self.pixels + x as usize;
                let plane = face.pixel(at, self.pixels);
                let depth = normal.dot(plane.extend(1.0)) / offset;
                if depth > buffer.depths[at] {
                    let is_there = chart.form != Form::Disk || polygon.patch.is_some() || {
                        let to = axes[0] * plane.x + axes[1] * plane.y + axes[2];
                        let local = chart.to_world.inverse().transform_point3(eye + to / depth);
                        local.truncate().length_squared() <= 1.0
                    };
                    if is_there {
                        buffer.depths[at] = depth;
                        buffer.polygons[at] = number;
                    }
                }
                x += 1.0;
            }
            y += 1.0;
        }
    }

    /// Adds what one cube sees.
    fn look(
        &self,
        from: &SurfacePoint,
        side: usize,
        near: f64,
        stream: u64,
        meets: &mut impl FnMut(u32, Rgb),
    ) {
        let normal = if side == 0 {
            from.normal_g
        } else {
            -from.normal_g
        };
        let frame = Frame::from_normal(normal);
        let eye = from.position;
        let mut buffer = Buffer {
            depths: Vec::new(),
            polygons: Vec::new(),
        };
        let mut rays = RayCounts::default();
        for (nth, face) in self.faces.iter().enumerate() {
            self.draw(face, &frame, eye, near, &mut buffer);
            for (at, factor) in face.factors.iter().enumerate() {
                let direction = frame.to_world(face.direction(face.pixel(at, self.pixels)));
                let polygon = self.polygons.get(buffer.polygons[at] as usize);
                let shown = polygon.filter(|polygon| self.is_matt(polygon));
                if let Some(polygon) = shown {
                    let position = eye + direction / buffer.depths[at];
                    meets(self.side_seen(polygon, position, eye), Rgb::splat(*factor));
                } else if polygon.is_some() || self.has_planes {
                    let index = (nth * self.pixels * self.pixels + at) as u32;
                    let mut sampler = Sampler::new(SamplerKind::OwenSobol, stream, index);
                    let ray = from.spawn_ray(direction.normalize());
                    let transport = Transport::Radiance;
                    self.carrier
                        .carry(&ray, transport, &mut sampler, &mut rays, |met, weight| {
                            if let Some(patch) = self.mesh.patch_at(&met.hit, met.point.position) {
                                let side = 2 * patch + u32::from(!met.point.is_front);
                                meets(side, weight * *factor);
                            }
                        });
                }
            }
        }
    }

    /// Whether a polygon shows nothing but a matt surface without holes.
    fn is_matt(&self, polygon: &Polygon) -> bool {
        let placed = &self.mesh.charts[polygon.chart as usize];
        let material = self.carrier.scene.material(placed.material);
        material.is_matt() && material.is_opaque()
    }

    /// The side of a patch, `2 · patch + side`, that is seen at a place.
    fn side_seen(&self, polygon: &Polygon, position: DVec3, eye: DVec3) -> u32 {
        let chart = &self.mesh.charts[polygon.chart as usize].chart;
        let uv = chart.coordinates(position);
        let patch = polygon
            .patch
            .unwrap_or_else(|| self.mesh.patch_of(polygon.chart as usize, uv));
        let is_back = chart.point(uv).normal.dot(eye - position) < 0.0;
        2 * patch + u32::from(is_back)
    }
}

impl FormFactors for Hemicubes<'_, '_> {
    fn row(&self, node: u32, side: usize) -> Row {
        let cell = self.mesh.nodes[node as usize].cell;
        let width = self.mesh.nodes[node as usize].area.sqrt();
        let near = self.size.map_or(HEMICUBE_NEAR * width, |size| 0.5 * size);
        let stream = rng::hash(&[self.seed, PIXELS, u64::from(node), side as u64]);
        let mut found = Vec::new();
        let places = cube_places(self.mesh, &cell, self.cubes);
        let share = 1.0 / places.len() as f64;
        let mut last: Option<(u32, Rgb)> = None;
        for (nth, u) in places.into_iter().enumerate() {
            let from = cell_point(self.mesh, self.carrier, &cell, side, u).point;
            let stream = rng::hash_on(stream, nth as u64);
            self.look(&from, side, near, stream, &mut |at, weight| {
                // Neighbouring pixels mostly show the same patch.
                let weight = weight * share;
                match &mut last {
                    Some((side, sum)) if *side == at => *sum += weight,
                    last => found.extend(last.replace((at, weight))),
                }
            });
        }
        found.extend(last);
        Row::of(found)
    }
}

/// Where the cubes of a cell stand: the numbers that choose the middles of its parts.
fn cube_places(mesh: &Mesh, cell: &Cell, cubes: u32) -> Vec<DVec2> {
    let n = f64::from(cubes);
    let place = |k: u32| DVec2::new(f64::from(k % cubes) + 0.5, f64::from(k / cubes) + 0.5) / n;
    if cubes == 1 && mesh.is_triangle(cell) {
        // The number in the middle of the square is not that of the middle of a triangle: the map folds.
        return vec![DVec2::splat(2.0 / 3.0)];
    }
    (0..cubes * cubes).map(place).collect()
}

/// All that is drawn.
fn polygons(mesh: &Mesh) -> Vec<Polygon> {
    let mut polygons = Vec::new();
    for (at, placed) in (0_u32..).zip(&mesh.charts) {
        let m = placed.chart.to_world.matrix3;
        let (corner, x, y) = (placed.chart.to_world.translation, m.x_axis, m.y_axis);
        let (corners, n) = match placed.chart.form {
            Form::Triangle => ([corner, corner + x, corner + y, corner], 3),
            Form::Parallelogram => ([corner, corner + x, corner + x + y, corner + y], 4),
            Form::Disk => (
                [
                    corner - x - y,
                    corner + x - y,
                    corner + x + y,
                    corner - x + y,
                ],
                4,
            ),
            Form::Sphere | Form::Side { .. } => continue,
        };
        polygons.push(Polygon {
            corners,
            n,
            chart: at,
            patch: None,
        });
    }
    for (patch, node) in (0_u32..).zip(&mesh.patches) {
        let cell = &mesh.nodes[*node as usize].cell;
        if !mesh.charts[cell.chart as usize].chart.is_flat() {
            facets(mesh, cell, patch, &mut polygons);
        }
    }
    polygons
}

/// Adds the facets of a patch of a round face.
fn facets(mesh: &Mesh, cell: &Cell, patch: u32, polygons: &mut Vec<Polygon>) {
    let chart = &mesh.charts[cell.chart as usize].chart;
    let step = cell.size / f64::from(FACETS);
    for k in 0..FACETS * FACETS {
        let low = cell.origin + step * DVec2::new(f64::from(k % FACETS), f64::from(k / FACETS));
        let at = |x: f64, y: f64| chart.point(low + step * DVec2::new(x, y)).position;
        let [a, b, c, d] = [at(0.0, 0.0), at(1.0, 0.0), at(1.0, 1.0), at(0.0, 1.0)];
        for corners in [[a, b, c, a], [a, c, d, a]] {
            polygons.push(Polygon {
                corners,
                n: 3,
                chart: cell.chart,
                patch: Some(patch),
            });
        }
    }
}

/// The part of a polygon, in the axes of a face (right, up, forward), that the face shows.
fn clip(corners: &[DVec3], lowest: f64, near: f64) -> Vec<DVec3> {
    let beyond: [&dyn Fn(&DVec3) -> f64; 5] = [
        &|p| p.z - near,
        &|p| p.z - p.x,
        &|p| p.z + p.x,
        &|p| p.z - p.y,
        &|p| {
            if lowest < 0.0 {
                p.z + p.y
            } else {
                p.y - HEMICUBE_HORIZON * p.z
            }
        },
    ];
    let mut polygon = corners.to_vec();
    for inside in beyond {
        let mut kept = Vec::with_capacity(polygon.len() + 1);
        for (k, here) in polygon.iter().enumerate() {
            let next = &polygon[(k + 1) % polygon.len()];
            let (a, b) = (inside(here), inside(next));
            if a >= 0.0 {
                kept.push(*here);
            }
            if (a >= 0.0) != (b >= 0.0) {
                kept.push(*here + (*next - *here) * (a / (a - b)));
            }
        }
        polygon = kept;
        if polygon.len() < 3 {
            return Vec::new();
        }
    }
    polygon
}

/// Where a horizontal line that meets a convex polygon, rim included, enters and leaves it.
fn span(polygon: &[DVec2], y: f64) -> (f64, f64) {
    let (mut left, mut right) = (f64::INFINITY, f64::NEG_INFINITY);
    for (k, a) in polygon.iter().enumerate() {
        let b = polygon[(k + 1) % polygon.len()];
        if y < a.y.min(b.y) || y > a.y.max(b.y) {
            continue;
        }
        let ends = if a.y == b.y {
            [a.x, b.x]
        } else {
            [a.x + (b.x - a.x) * ((y - a.y) / (b.y - a.y)); 2]
        };
        for x in ends {
            (left, right) = (left.min(x), right.max(x));
        }
    }
    (left, right)
}
