//! Form factors by closed forms where they hold: between flat cells that are near each other and see each other whole.
//!
//! Near pairs are where rays and hemicubes are worst ([`BaumRushmeier1989`](crate::references#baumrushmeier1989)). All other pairs have factors by
//! rays: those that are left when the rays to the near ones are taken away share what the closed forms leave of the whole.

use super::mesh::{Cell, Mesh};
use super::polygon::Contours;
use super::rays::{CosineRays, cell_point};
use super::system::{FormFactors, Row};
use crate::color::Rgb;
use crate::geometry::chart::Form;
use crate::math::tolerance::FACING_SLACK;
use glam::{DVec2, DVec3};

/// How near patches are that count as near, in sizes of the larger.
const NEAR: f64 = 5.0;

/// Pairs of points between which nothing may stand.
const LINES: u32 = 16;

/// A flat cell as a polygon.
#[derive(Clone, Debug)]
struct Flat {
    corners: Vec<DVec3>,
    center: DVec3,
    /// Of the front.
    normal: DVec3,
    size: f64,
    node: u32,
}

/// Closed forms where they hold, rays elsewhere.
pub(super) struct NearForms<'a, 's> {
    rays: CosineRays<'a, 's>,
    contours: Contours,
    /// Of each patch, if it is flat and matt.
    flats: Vec<Option<Flat>>,
}

impl<'a, 's> NearForms<'a, 's> {
    pub(super) fn new(rays: CosineRays<'a, 's>) -> Self {
        let flat = |node: &u32| {
            let placed = &rays.mesh.charts[rays.mesh.nodes[*node as usize].cell.chart as usize];
            let material = rays.carrier.scene.material(placed.material);
            let is_plain = material.is_opaque() && material.is_matt();
            flat(rays.mesh, *node).filter(|_| is_plain)
        };
        Self {
            contours: Contours::new(),
            flats: rays.mesh.patches.iter().map(flat).collect(),
            rays,
        }
    }

    /// The factor from a cell, seen from its side, to a patch, with that patch's side; `None` where no closed form holds.
    fn closed_form(&self, from: &Flat, side: usize, to: &Flat) -> Option<(usize, f64)> {
        let size = from.size.max(to.size);
        if from.center.distance(to.center) > NEAR * size {
            return None;
        }
        let up = if side == 0 { from.normal } else { -from.normal };
        let is_before = |corners: &[DVec3], at: DVec3, up: DVec3| {
            corners
                .iter()
                .all(|p| (*p - at).dot(up) >= -FACING_SLACK * size)
        };
        if !is_before(&to.corners, from.corners[0], up) {
            return None;
        }
        let other = (0..2).find(|other| {
            let up = if *other == 0 { to.normal } else { -to.normal };
            is_before(&from.corners, to.corners[0], up)
        })?;
        let is_flush = is_before(&to.corners, from.corners[0], -up);
        if is_flush {
            // In one plane: they do not see each other.
            return None;
        }
        self.sees_whole(from, side, to).then(|| {
            let area = self.rays.mesh.nodes[from.node as usize].area;
            (
                other,
                self.contours.exchange(&from.corners, &to.corners) / area,
            )
        })
    }

    /// Whether nothing stands on lines between points spread over both.
    fn sees_whole(&self, from: &Flat, side: usize, to: &Flat) -> bool {
        let (mesh, carrier) = (self.rays.mesh, self.rays.carrier);
        let cell = |flat: &Flat| mesh.nodes[flat.node as usize].cell;
        let (one, other): (Cell, Cell) = (cell(from), cell(to));
        (0..LINES).all(|k| {
            // A net of points in each, in another order.
            let (i, j) = (f64::from(k % 4), f64::from(k / 4));
            let a = (DVec2::new(i, j) + DVec2::splat(0.5)) * 0.25;
            let b = (DVec2::new(j, 3.0 - i) + DVec2::splat(0.5)) * 0.25;
            let start = cell_point(mesh, carrier, &one, side, a).point;
            let end = cell_point(mesh, carrier, &other, 0, b).point;
            let ray = start.spawn_ray_to(end.position);
            !carrier.scene.occluded(&ray)
        })
    }
}

impl FormFactors for NearForms<'_, '_> {
    fn row(&self, node: u32, side: usize) -> Row {
        let mesh = self.rays.mesh;
        let Some(from) = flat(mesh, node) else {
            return self.rays.row(node, side);
        };
        let mut known: Vec<(u32, f64)> = Vec::new();
        for (patch, to) in (0_u32..).zip(&self.flats) {
            let Some(to) = to else { continue };
            let found = self.closed_form(&from, side, to);
            known.extend(found.map(|(other, factor)| (2 * patch + other as u32, factor)));
        }
        let is_known = |side: u32| known.binary_search_by_key(&side, |known| known.0).is_ok();
        let (mut found, mut met) = (Vec::new(), 0.0);
        self.rays.follow(node, side, |side, weight| {
            if is_known(side) {
                met += weight.mean();
            } else {
                found.push((side, weight));
            }
        });
        let exact: f64 = known.iter().map(|(_, factor)| factor).sum();
        // Rays that met nothing are among those that share the rest.
        let share = if met < 1.0 {
            ((1.0 - exact) / (1.0 - met)).max(0.0)
        } else {
            0.0
        };
        for (_, weight) in &mut found {
            *weight *= share;
        }
        found.extend(
            known
                .iter()
                .map(|(side, factor)| (*side, Rgb::splat(*factor))),
        );
        Row::of(found)
    }
}

/// A cell as a polygon if it is one.
fn flat(mesh: &Mesh, node: u32) -> Option<Flat> {
    let cell = &mesh.nodes[node as usize].cell;
    let placed = &mesh.charts[cell.chart as usize];
    let chart = &placed.chart;
    let end = cell.origin + cell.size;
    // The cells at the rim of a plane stand for all that lies beyond.
    if placed.is_plane() && (cell.origin.min_element() <= 0.0 || end.max_element() >= 1.0) {
        return None;
    }
    if !matches!(chart.form, Form::Triangle | Form::Parallelogram) {
        return None;
    }
    let mut corners: Vec<DVec3> = mesh
        .corners(cell)
        .into_iter()
        .map(|uv| chart.point(uv).position)
        .collect();
    if corners.len() == 4 {
        // From order by coordinates to order round the rim.
        corners.swap(2, 3);
    }
    let center = corners.iter().sum::<DVec3>() / corners.len() as f64;
    let size = corners.iter().map(|corner| 2.0 * corner.distance(center));
    Some(Flat {
        center,
        normal: chart.point(cell.origin).normal,
        size: size.fold(0.0, f64::max),
        corners,
        node,
    })
}
