//! What views ask of the solution.

use super::RadiositySolution;
use super::mesh::{Cell, Mesh, parts};
use crate::color::Rgb;
use crate::integrator::final_gather::{FinalGather, Places, SolvedLight, Spot};
use crate::integrator::viewer::Behind;
use crate::math::rng;
use crate::scene::{Piece, Scene};
use glam::{DVec2, DVec3};
use std::sync::{Arc, OnceLock};

/// Places for gathered light in a scene, about.
const PLACES: f64 = 131_072.0;

/// Cells of planes that are wider than this part of the scene's size hold none: they lie far outside.
const WIDEST: f64 = 1.0 / 16.0;

/// Times a cell is halved at most for places.
const MOST_HALVINGS: u32 = 12;

impl SolvedLight for RadiositySolution {
    const BY_PIECES: bool = false;
    const HAS_UNASKED: bool = true;

    /// Where it is not known which part of the light of elements mirrors and glass threw there, gathers must find that part: the disk of
    /// the sun is in neither.
    fn behind(&self) -> Behind {
        if self.focused.is_some() {
            Behind::Nothing
        } else {
            Behind::AllButSun
        }
    }

    fn indirect(&self, scene: &Scene, spot: &Spot<'_>, side: DVec3, is_summed: bool) -> Rgb {
        let all = self.solved(scene, spot, side, is_summed);
        let focused = self.focused(scene, spot, side, is_summed);
        (all - focused).map(|light| light.max(0.0))
    }

    fn focused(&self, _: &Scene, spot: &Spot<'_>, side: DVec3, _: bool) -> Rgb {
        let focused = self.focused.as_ref();
        focused.map_or(Rgb::BLACK, |focused| self.between(focused, spot, side))
    }

    fn solved(&self, _: &Scene, spot: &Spot<'_>, side: DVec3, _: bool) -> Rgb {
        self.between(&self.vertices.values, spot, side)
    }

    fn knows_wholly(&self, _: &Piece) -> bool {
        false
    }

    fn blur(&self, spot: &Spot<'_>) -> f64 {
        let place = self.mesh.element_at(spot.hit, spot.point.position);
        place.map_or(0.0, |place| {
            self.mesh.nodes[place.node as usize].area.sqrt()
        })
    }

    fn places(&self, scene: &Scene) -> Places {
        places(&self.mesh, scene)
    }

    fn kept(&self) -> &OnceLock<Arc<FinalGather>> {
        &self.gather
    }
}

impl RadiositySolution {
    /// What such values at corners come to at a point of a side.
    fn between(&self, values: &[[Rgb; 2]], spot: &Spot<'_>, side: DVec3) -> Rgb {
        let Self { mesh, vertices, .. } = self;
        let Some(place) = mesh.element_at(spot.hit, spot.point.position) else {
            return Rgb::BLACK;
        };
        let is_triangle = mesh.is_triangle(&mesh.nodes[place.node as usize].cell);
        let both = vertices.between(values, (place.node, place.within), is_triangle);
        both[usize::from(spot.point.normal_g.dot(side) < 0.0)]
    }
}

/// Places all over the surfaces, on both sides, in an order that knows nothing of rows.
fn places(mesh: &Mesh, scene: &Scene) -> Places {
    let widest = WIDEST * super::size_of_scene(scene);
    let nodes = mesh.patches.iter().map(|node| &mesh.nodes[*node as usize]);
    let nodes = nodes.filter(|node| {
        let is_plane = mesh.charts[node.cell.chart as usize].is_plane();
        !is_plane || node.area <= widest * widest
    });
    let area: f64 = nodes.clone().map(|node| node.area).sum();
    let spacing = (2.0 * area / PLACES).sqrt();
    if !(spacing > 0.0 && spacing.is_finite()) {
        return Places::NONE;
    }
    // On what is smaller no record would be asked for.
    let is_wide = |chart: u32| {
        let chart = &mesh.charts[chart as usize].chart;
        chart.area(DVec2::ZERO, DVec2::ONE) > spacing * spacing
    };
    let mut all = Vec::new();
    for node in nodes.filter(|node| is_wide(node.cell.chart)) {
        add_places(mesh, (&node.cell, MOST_HALVINGS), spacing, &mut all);
    }
    // The first of a cell of the cache is its place: not always that in the same corner.
    let mut keyed: Vec<_> = (0_u64..).map(|at| rng::hash(&[at])).zip(all).collect();
    keyed.sort_unstable_by_key(|(key, _)| *key);
    Places {
        spacing,
        all: keyed.into_iter().map(|(_, place)| place).collect(),
    }
}

/// Adds the middles of the parts of a cell that are no larger than `spacing` in the square, each for front and back.
fn add_places(
    mesh: &Mesh,
    (cell, halvings): (&Cell, u32),
    spacing: f64,
    all: &mut Vec<(DVec3, DVec3)>,
) {
    let chart = &mesh.charts[cell.chart as usize].chart;
    // A little more than that: halves of what is just larger would be four times as many.
    let is_large = chart.area(cell.origin, cell.size) > 2.0 * spacing * spacing;
    let is_triangle = mesh.is_triangle(cell);
    if is_large && halvings > 0 {
        for part in parts(cell, is_triangle) {
            add_places(mesh, (&part, halvings - 1), spacing, all);
        }
        return;
    }
    let middle = if is_triangle { 1.0 / 3.0 } else { 0.5 };
    let point = chart.point(cell.origin + cell.size * middle);
    all.push((point.position, point.normal));
    all.push((point.position, -point.normal));
}
