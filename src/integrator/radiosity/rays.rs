//! Form factors by rays: a patch looks around from points all over it, with the density of the cosine.
//!
//! [`Malley1988`](crate::references#malley1988): the share of rays that meet a patch is the form factor to it, mean over the whole cell
//! and free of bias; all rays of a closed room meet something, so a row's sum is exact. Mirrors, glass, panes and holes need
//! nothing more than going on: these are the extended form factors of
//! [`SillionPuech1989`](crate::references#sillionpuech1989).

use super::mesh::{Cell, Mesh};
use super::system::{FormFactors, Row};
use crate::color::Rgb;
use crate::integrator::RayCounts;
use crate::integrator::carrier::Carrier;
use crate::material::Transport;
use crate::math::frame::Frame;
use crate::math::{Ray, rng, warp};
use crate::sampler::{Sampler, SamplerKind, Use};
use crate::scene::SurfacePoint;
use glam::DVec2;

/// What the random numbers of rows are for.
const ROWS: u64 = 0x726f_7773;

/// Rays from the sides of cells.
#[derive(Clone, Copy, Debug)]
pub(super) struct CosineRays<'a, 's> {
    pub(super) mesh: &'a Mesh,
    pub(super) carrier: &'a Carrier<'s>,
    pub(super) seed: u64,
    /// Rays for each row.
    pub(super) n: u32,
}

/// A point of a cell, with its share of the cell's area in parts of the mean.
pub(super) struct CellPoint {
    pub(super) point: SurfacePoint,
    pub(super) weight: f64,
}

/// The point of a cell that two uniform numbers choose, seen from one side (0 front).
pub(super) fn cell_point(
    mesh: &Mesh,
    carrier: &Carrier<'_>,
    cell: &Cell,
    side: usize,
    u: DVec2,
) -> CellPoint {
    let placed = &mesh.charts[cell.chart as usize];
    let uv = mesh.choose(cell, u);
    CellPoint {
        point: carrier.scene.point_on(placed, uv, side == 0),
        weight: placed.chart.density(uv),
    }
}

/// A ray that leaves a side of a surface with the density of the cosine.
pub(super) fn cosine_ray(point: &SurfacePoint, side: usize, u: DVec2) -> Ray {
    let normal = if side == 0 {
        point.normal_g
    } else {
        -point.normal_g
    };
    let direction = Frame::from_normal(normal).to_world(warp::cosine_hemisphere(u));
    point.spawn_ray(direction)
}

impl CosineRays<'_, '_> {
    /// Follows the rays of one side of a node; `meets` is told of the sides of patches they meet, `2 · patch + side`, each with
    /// its part of the form factor.
    pub(super) fn follow(&self, node: u32, side: usize, mut meets: impl FnMut(u32, Rgb)) {
        let cell = &self.mesh.nodes[node as usize].cell;
        let stream = rng::hash(&[self.seed, ROWS, u64::from(node), side as u64]);
        let at = |index: u32| {
            let sampler = Sampler::new(SamplerKind::OwenSobol, stream, index);
            let from = cell_point(
                self.mesh,
                self.carrier,
                cell,
                side,
                sampler.point(Use::Choice),
            );
            (sampler, from)
        };
        let is_even = self.mesh.charts[cell.chart as usize].chart.is_even();
        let total = if is_even {
            let middle = at(0).1.weight;
            middle * f64::from(self.n)
        } else {
            (0..self.n).map(|index| at(index).1.weight).sum()
        };
        let mut rays = RayCounts::default();
        for index in 0..self.n {
            let (mut sampler, from) = at(index);
            let ray = cosine_ray(&from.point, side, sampler.point(Use::Direction));
            let share = from.weight / total;
            self.carrier.carry(
                &ray,
                Transport::Radiance,
                &mut sampler,
                &mut rays,
                |met, weight| {
                    if let Some(patch) = self.mesh.patch_at(&met.hit, met.point.position) {
                        meets(2 * patch + u32::from(!met.point.is_front), weight * share);
                    }
                },
            );
        }
    }
}

impl FormFactors for CosineRays<'_, '_> {
    fn row(&self, node: u32, side: usize) -> Row {
        let mut found = Vec::with_capacity(self.n as usize);
        self.follow(node, side, |side, weight| found.push((side, weight)));
        Row::of(found)
    }
}
