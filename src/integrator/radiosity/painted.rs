//! The solution as a mesh with a colour at each corner, for programs that know nothing of light.
//!
//! Elements are split further until colours between their corners are about straight lines: direct light too, which the solution
//! itself does not hold, is asked for at each corner. What is approximated:
//!
//! - Shadows are as sharp as the smallest elements are, [`FINEST`] along the diagonal of the scene, and pictures on surfaces too. What
//!   lies between the corners and the middle of an element goes unseen.
//! - A corner has one colour, whoever looks: that of the surface seen straight from above it. So mirrors and glass show what is seen
//!   in them from there.
//! - Round faces are flat between corners, as far as [`FINEST`] lets see.
//! - Insides of closed shapes are left out if no light is there: at outlines a pixel may show what lies behind an edge.

use super::mesh::{Mesh, Node};
use super::vertices::{EDGES, Welder, crowded};
use super::{RadiositySolution, size_of_scene};
use crate::color::Rgb;
use crate::geometry::chart::Form;
use crate::geometry::painted::PaintedMesh;
use crate::geometry::unit::Face;
use crate::integrator::{Progress, RadianceEstimator, RayCounts, RenderContext, RenderError};
use crate::math::tolerance::ABOVE_SURFACE;
use crate::math::{Ray, rng};
use crate::sampler::{Sampler, SamplerKind};
use crate::scene::{PlacedChart, Scene};
use glam::{DVec2, DVec3};
use rayon::prelude::*;
use std::collections::HashMap;
use std::sync::atomic::{AtomicU64, Ordering};

/// What the random numbers are for.
const PAINT: u64 = 0x7061_696e;

/// The smallest elements along the diagonal of the scene, and what is seen of its shape.
const FINEST: f64 = 1024.0;

/// How often an element of the solution is split at most.
const MOST_SPLITS: u32 = 5;

/// Difference of shown colours between the middle of an element and the mean of its corners beyond which it is split, and between
/// corners, of 1.
const BENT: f64 = 0.03;
const STEEP: f64 = 0.25;

/// Samples for each corner of an element; four elements share most of them.
const SAMPLES: u32 = 8;

/// Part of the way from a corner to the middle at which light is asked for: at the corner itself there may be a wall.
const INWARD: f64 = 1.0 / 64.0;

/// Parts of a turn that a cell may go round: the corners of larger ones would lie on a line.
const WIDEST_TURN: f64 = 0.25;

/// Elements beyond which nothing is split for the sake of colours.
const MANY: usize = 300_000;

/// Radiance at the corners of an element, and in its middle (the last that counts), by side.
type Colors = [[Rgb; 5]; 2];

impl RadiositySolution {
    /// The surfaces of `scene`, of which this is the solution, with colours that `shown` makes of radiance, display-linear, 0..=1.
    /// `view` looks at the solution. Front and back have faces of their own.
    ///
    /// # Errors
    /// If it was stopped, or there are more than `most` elements.
    pub fn painted(
        &self,
        scene: &Scene,
        view: &dyn RadianceEstimator,
        shown: &(dyn Fn(Rgb) -> Rgb + Sync),
        most: u64,
        context: &RenderContext<'_>,
    ) -> Result<PaintedMesh, RenderError> {
        let mut painter = Painter {
            mesh: self.mesh.clone(),
            colors: Vec::new(),
            scene,
            view,
            shown,
            size: size_of_scene(scene),
            context,
        };
        painter.split_round(most)?;
        painter.paint()?;
        for _ in 0..MOST_SPLITS {
            let wanted = painter.wanted();
            let n = painter.mesh.elements().count() + 3 * wanted.len();
            if wanted.is_empty() || n > MANY.min(most as usize) {
                break;
            }
            wanted.into_iter().for_each(|node| painter.mesh.split(node));
            painter.balance();
            painter.paint()?;
        }
        Ok(painter.assembled())
    }
}

/// Elements and their colours so far.
struct Painter<'a> {
    mesh: Mesh,
    /// By node; those of nodes that are no elements are not used.
    colors: Vec<Colors>,
    scene: &'a Scene,
    view: &'a dyn RadianceEstimator,
    shown: &'a (dyn Fn(Rgb) -> Rgb + Sync),
    /// Metres.
    size: f64,
    context: &'a RenderContext<'a>,
}

impl Painter<'_> {
    /// Splits cells that go so far round that they have no area between their corners.
    fn split_round(&mut self, most: u64) -> Result<(), RenderError> {
        loop {
            let is_wide = |node: &u32| {
                let cell = &self.mesh.nodes[*node as usize].cell;
                let chart = &self.mesh.charts[cell.chart as usize].chart;
                chart.is_round() && cell.size.x > WIDEST_TURN
            };
            let wide: Vec<u32> = self.mesh.elements().filter(is_wide).collect();
            let n = (self.mesh.elements().count() + 3 * wide.len()) as u64;
            if n > most {
                return Err(RenderError::TooManyPatches { n, most });
            }
            if wide.is_empty() {
                return Ok(());
            }
            wide.into_iter().for_each(|node| self.mesh.split(node));
        }
    }

    /// Finds the colours of elements that have none yet.
    fn paint(&mut self) -> Result<(), RenderError> {
        let first = self.colors.len();
        let total = (self.mesh.nodes.len() - first) as u64;
        let done = AtomicU64::new(0);
        let colors = |node: usize| {
            let is_element = self.mesh.nodes[node].children == super::NONE;
            if !is_element || self.context.cancel.is_cancelled() {
                return Colors::default();
            }
            let colors = self.colors_of(node as u32);
            let done = done.fetch_add(1, Ordering::Relaxed) + 1;
            if done.is_multiple_of(256) {
                (self.context.progress)(Progress { done, total });
            }
            colors
        };
        let nodes = (first..self.mesh.nodes.len()).into_par_iter();
        let new: Vec<Colors> = nodes.map(colors).collect();
        self.colors.extend(new);
        if self.context.cancel.is_cancelled() {
            return Err(RenderError::Cancelled { partial: None });
        }
        Ok(())
    }

    fn colors_of(&self, node: u32) -> Colors {
        let cell = &self.mesh.nodes[node as usize].cell;
        let middle = self.middle(node);
        let mut places = self.mesh.corners(cell);
        for place in &mut places {
            *place = place.lerp(middle, INWARD);
        }
        places.push(middle);
        let mut colors = Colors::default();
        for (side, colors) in colors.iter_mut().enumerate() {
            for (k, (color, uv)) in colors.iter_mut().zip(&places).enumerate() {
                *color = self.seen((node, k as u64), *uv, side);
            }
        }
        colors
    }

    /// Coordinates of the middle of an element.
    fn middle(&self, node: u32) -> DVec2 {
        let corners = self.mesh.corners(&self.mesh.nodes[node as usize].cell);
        corners.iter().sum::<DVec2>() / corners.len() as f64
    }

    /// Radiance of a point of an element, seen from straight above its front (0) or back.
    fn seen(&self, (node, k): (u32, u64), uv: DVec2, side: usize) -> Rgb {
        let cell = &self.mesh.nodes[node as usize].cell;
        let placed = &self.mesh.charts[cell.chart as usize];
        let point = self.scene.point_on(placed, uv, side == 0);
        let out = if side == 0 {
            point.normal_g
        } else {
            -point.normal_g
        };
        let eye = point.spawn_ray(out).origin + out * (ABOVE_SURFACE * self.size);
        let ray = Ray::new(eye, -out);
        let seed = self.context.seed;
        let stream = rng::hash(&[seed, PAINT, u64::from(node), k, side as u64]);
        let mut rays = RayCounts::default();
        let mut sum = Rgb::BLACK;
        for index in 0..SAMPLES {
            let mut sampler = Sampler::new(SamplerKind::OwenSobol, stream, index);
            sum += self.view.incident_radiance(&ray, &mut sampler, &mut rays);
        }
        sum / f64::from(SAMPLES)
    }

    /// Elements that are to be split.
    fn wanted(&self) -> Vec<u32> {
        let finest = self.size / FINEST;
        let is_wanted = |node: &u32| {
            let ends = self.positions(*node);
            let edges = EDGES[ends.len() - 3];
            let longest = edges
                .iter()
                .map(|[a, b]| ends[*a].distance(ends[*b]))
                .fold(0.0, f64::max);
            longest > finest
                && !self.mesh.is_tiny(*node)
                && (self.is_bent(*node) || self.is_uneven(*node, ends.len()))
        };
        let elements: Vec<u32> = self.mesh.elements().collect();
        elements.into_par_iter().filter(is_wanted).collect()
    }

    fn positions(&self, node: u32) -> Vec<DVec3> {
        let cell = &self.mesh.nodes[node as usize].cell;
        let chart = &self.mesh.charts[cell.chart as usize].chart;
        let corners = self.mesh.corners(cell).into_iter();
        corners.map(|uv| chart.point(uv).position).collect()
    }

    /// Whether an edge of an element leaves the straight line between its ends so far that it is seen.
    fn is_bent(&self, node: u32) -> bool {
        let cell = &self.mesh.nodes[node as usize].cell;
        let chart = &self.mesh.charts[cell.chart as usize].chart;
        if !chart.is_round() {
            return false;
        }
        let (uvs, ends) = (self.mesh.corners(cell), self.positions(node));
        EDGES[1].iter().any(|[a, b]| {
            let middle = chart.point((uvs[*a] + uvs[*b]) * 0.5).position;
            let chord = (ends[*a] + ends[*b]) * 0.5;
            middle.distance(chord) > self.size / FINEST
        })
    }

    /// Whether colours between the corners of an element are not what they are in the middle, or are far apart.
    fn is_uneven(&self, node: u32, n: usize) -> bool {
        self.colors[node as usize].iter().any(|colors| {
            let shown = |k: usize| (self.shown)(colors[k]);
            let corners = || (0..n).map(shown);
            let mean: Rgb = corners().sum::<Rgb>() / n as f64;
            let differ = |a: Rgb, b: Rgb, most: f64| (a - b).map(f64::abs).max_channel() > most;
            differ(mean, shown(n), BENT) || corners().any(|corner| differ(corner, mean, STEEP))
        })
    }

    /// Splits what has neighbours more than one split smaller.
    fn balance(&mut self) {
        loop {
            let large = crowded(&self.mesh, self.size).into_iter();
            let large: Vec<u32> = large.filter(|node| !self.mesh.is_tiny(*node)).collect();
            if large.is_empty() || self.context.cancel.is_cancelled() {
                return;
            }
            large.into_iter().for_each(|node| self.mesh.split(node));
        }
    }

    /// Corners that elements share get the mean of their colours there; elements become triangles.
    fn assembled(&self) -> PaintedMesh {
        let mut corners = Corners {
            welder: Welder::new(self.size),
            groups: HashMap::new(),
            sums: Vec::new(),
            positions: Vec::new(),
        };
        let elements: Vec<u32> = self.mesh.elements().collect();
        for node in &elements {
            self.add_corners(*node, &mut corners);
        }
        let mut painted = PaintedMesh::default();
        for (position, (sums, n)) in corners.positions.iter().zip(&corners.sums) {
            for sum in sums {
                painted.positions.push(*position);
                painted.colors.push((self.shown)(*sum / *n));
            }
        }
        let are_dark = self.are_dark();
        for node in elements {
            self.add_triangles(node, &corners, &are_dark, &mut painted);
        }
        painted.compact()
    }

    /// Of each face, whether its back is inside a closed shape without light.
    fn are_dark(&self) -> Vec<bool> {
        let charts = &self.mesh.charts;
        let mut are_lit = vec![false; charts.len()];
        for node in self.mesh.elements() {
            let back = &self.colors[node as usize][1];
            are_lit[self.mesh.nodes[node as usize].cell.chart as usize] |=
                back.iter().any(|color| !color.is_black());
        }
        let mut are_dark = Vec::with_capacity(charts.len());
        for same in charts.chunk_by(|a, b| a.primitive == b.primitive) {
            let first = are_dark.len();
            let is_dark = is_closed(same)
                && are_lit[first..first + same.len()]
                    .iter()
                    .all(|is_lit| !is_lit);
            are_dark.resize(first + same.len(), is_dark);
        }
        are_dark
    }

    /// Corners with the same mark share their colours.
    fn mark(&self, node: &Node) -> u64 {
        let placed = &self.mesh.charts[node.cell.chart as usize];
        if self.scene.material(placed.material).pictures.is_some() {
            // The same point may look otherwise on another face.
            u64::from(node.cell.chart) | 1 << 32
        } else {
            u64::from(placed.material.0)
        }
    }

    fn add_corners(&self, node: u32, corners: &mut Corners) {
        let at = &self.mesh.nodes[node as usize];
        let chart = &self.mesh.charts[at.cell.chart as usize].chart;
        let mark = self.mark(at);
        for (k, uv) in self.mesh.corners(&at.cell).into_iter().enumerate() {
            let point = chart.point(uv);
            let vertex = corners.welder.find_or_add(point.position, point.normal);
            let next = corners.sums.len() as u32;
            let group = *corners.groups.entry((vertex, mark)).or_insert(next);
            if group == next {
                corners.sums.push(([Rgb::BLACK; 2], 0.0));
                corners.positions.push(point.position);
            }
            let (sums, n) = &mut corners.sums[group as usize];
            *n += 1.0;
            for (sum, colors) in sums.iter_mut().zip(&self.colors[node as usize]) {
                *sum += colors[k];
            }
        }
    }

    /// An element, front and back, with the corners of smaller neighbours on its edges.
    fn add_triangles(
        &self,
        node: u32,
        corners: &Corners,
        are_dark: &[bool],
        painted: &mut PaintedMesh,
    ) {
        let at = &self.mesh.nodes[node as usize];
        let chart = &self.mesh.charts[at.cell.chart as usize].chart;
        let mark = self.mark(at);
        let uvs = self.mesh.corners(&at.cell);
        let group = |uv: DVec2| {
            let point = chart.point(uv);
            let vertex = corners.welder.find(point.position, point.normal)?;
            corners.groups.get(&(vertex, mark)).copied()
        };
        let mut outline: Vec<u32> = Vec::new();
        for [a, b] in EDGES[uvs.len() - 3] {
            outline.extend(group(uvs[*a]));
            outline.extend(group((uvs[*a] + uvs[*b]) * 0.5));
        }
        outline.dedup();
        if outline.len() > 1 && outline.first() == outline.last() {
            outline.pop();
        }
        let middle = chart.point(self.middle(node));
        let position = |group: u32| corners.positions[group as usize];
        let turn: DVec3 = (0..outline.len())
            .map(|k| {
                let next = outline[(k + 1) % outline.len()];
                (position(outline[k]) - middle.position).cross(position(next) - middle.position)
            })
            .sum();
        if turn.dot(middle.normal) < 0.0 {
            outline.reverse();
        }
        let n_sides = if are_dark[at.cell.chart as usize] {
            1
        } else {
            2
        };
        for side in 0..n_sides {
            let colors = &self.colors[node as usize][side];
            let color = (self.shown)(colors[uvs.len()]);
            let ring: Vec<u32> = outline
                .iter()
                .map(|group| 2 * group + side as u32)
                .collect();
            painted.add_face(&ring, (middle.position, color), side == 1);
        }
    }
}

/// Whether the faces of a primitive enclose a space.
fn is_closed(faces: &[PlacedChart]) -> bool {
    let has = |face: Face| faces.iter().any(|other| other.face == face);
    match faces {
        [only] if only.chart.form == Form::Sphere => true,
        [first, ..] => match first.chart.form {
            Form::Side { base, top } => {
                (base == 0.0 || has(Face::Base)) && (top == 0.0 || has(Face::Top))
            }
            _ => faces.len() == 6 && matches!(first.face, Face::Cube(..)),
        },
        [] => false,
    }
}

/// Corners of elements, by place, normal and mark.
struct Corners {
    welder: Welder,
    /// Only looked up, never gone through.
    groups: HashMap<(u32, u64), u32>,
    /// Sums of colours, front and back, and their number.
    sums: Vec<([Rgb; 2], f64)>,
    positions: Vec<DVec3>,
}
