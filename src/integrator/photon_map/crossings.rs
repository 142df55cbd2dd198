//! How much surface of small pieces there is in a cube: counted by lines across it.
//!
//! Lines that are spread evenly over places and directions cross a surface in proportion to its area, however it is turned: where a cube
//! of edge h is crossed by n lines that meet surface c times, 3 h² c / n of surface is expected in it (Crofton's formula). So nothing
//! need be known of instances that are part in the cube.

use super::pieces::small;
use super::stored::is_matt_somewhere;
use crate::math::frame::Frame;
use crate::math::{Ray, rng, warp};
use crate::scene::{Piece, Scene};
use glam::{DVec2, DVec3};

/// Crossings that are enough.
const ENOUGH: usize = 96;

/// Lines of a cube, at least and at most.
const LEAST_LINES: u64 = 32;
const MOST_LINES: u64 = 1024;

/// Surfaces that a line is followed through.
const DEEPEST: usize = 1 << 12;

/// Where a line crosses a piece.
#[derive(Clone, Copy, Debug)]
pub(super) struct Crossing {
    /// Unit normal of the front.
    pub(super) normal: DVec3,
    /// Area of one side of the whole piece, m²; of bodies about that.
    pub(super) area: f64,
    /// Whether light on the back counts too, as on leaves.
    pub(super) is_thin: bool,
    /// The number of the line.
    pub(super) line: u64,
}

/// Crossings of all lines through a cube.
#[derive(Clone, Debug, Default)]
pub(super) struct Crossings {
    /// In the order of the lines.
    pub(super) found: Vec<Crossing>,
    /// Surface that each of them stands for, m².
    pub(super) each: f64,
    /// Whether lines ended because there were enough crossings.
    pub(super) are_enough: bool,
}

/// A cube of the world.
#[derive(Clone, Copy, Debug)]
pub(super) struct Cube {
    pub(super) low: DVec3,
    /// Metres.
    pub(super) edge: f64,
}

impl Cube {
    /// A line across it; those of all numbers are spread evenly.
    fn line(&self, seed: u64, nth: u64) -> Ray {
        let number = |k: u64| rng::unit_f64(rng::hash(&[seed, nth, k]));
        // A place of the cube's surface, and a direction into it by the cosine law.
        let (axis, is_high) = ((nth % 3) as usize, nth / 3 % 2 == 1);
        let mut place = DVec3::ZERO;
        place[axis] = if is_high { 1.0 } else { 0.0 };
        place[(axis + 1) % 3] = number(0);
        place[(axis + 2) % 3] = number(1);
        let mut inwards = DVec3::ZERO;
        inwards[axis] = 1.0 - 2.0 * place[axis];
        let local = warp::cosine_hemisphere(DVec2::new(number(2), number(3)));
        let direction = Frame::from_normal(inwards).to_world(local);
        let end = |axis: usize| {
            let w = direction[axis];
            let rest = if w > 0.0 {
                1.0 - place[axis]
            } else {
                place[axis]
            };
            if w == 0.0 {
                f64::INFINITY
            } else {
                rest / w.abs()
            }
        };
        let end = end(0).min(end(1)).min(end(2));
        Ray::new(self.low + place * self.edge, direction).until(end * self.edge)
    }

    /// The pieces in it that are [`small`] for this radius, where lines cross them.
    pub(super) fn crossings(&self, scene: &Scene, radius: f64, seed: u64) -> Crossings {
        let mut crossings = Crossings::default();
        let mut line = 0;
        while line < MOST_LINES && !crossings.are_enough {
            follow(
                scene,
                &self.line(seed, line),
                radius,
                line,
                &mut crossings.found,
            );
            line += 1;
            crossings.are_enough = line >= LEAST_LINES && crossings.found.len() >= ENOUGH;
        }
        crossings.each = 3.0 * self.edge * self.edge / line as f64;
        crossings
    }
}

/// Adds the crossings of a line.
fn follow(scene: &Scene, ray: &Ray, radius: f64, line: u64, found: &mut Vec<Crossing>) {
    let mut next = scene.closest(ray);
    for _ in 0..DEEPEST {
        let Some(hit) = next else {
            return;
        };
        let piece = scene.piece(hit.primitive);
        if small(&piece, radius).is_some() {
            let point = scene.surface(ray, &hit);
            if is_matt_somewhere(&scene.optics(&point)) {
                found.push(Crossing {
                    normal: point.normal_g,
                    area: area(&piece),
                    is_thin: matches!(piece, Piece::Flat { .. }),
                    line,
                });
            }
        }
        next = scene.closest_after(ray, &hit);
    }
}

/// Area of one side of a piece, m²; of bodies about that.
pub(super) fn area(piece: &Piece) -> f64 {
    match *piece {
        Piece::Flat { area, .. } | Piece::Body { area, .. } => area,
        Piece::Large => 0.0,
    }
}
