//! Smaller elements where light changes fast.
//!
//! [`CohenGreenberg1986`](crate::references#cohengreenberg1986): patches stay as they are and go on sending light as a whole; only the new
//! elements collect it anew. An element is split where the light between its corners differs by more than a part of the light of its
//! patch, weighed by its width. Neighbours differ by one split at most.

use super::mesh::{Mesh, NONE};
use super::vertices::{Vertices, crowded};
use crate::color::Rgb;
use crate::integrator::CancelToken;

/// When elements are split.
#[derive(Clone, Copy, Debug)]
pub(super) struct Refinement<'a> {
    /// Difference over an element as wide as a patch, as a part of the light of its patch.
    pub(super) threshold: f64,
    /// How often a patch is split at most.
    pub(super) depth: u32,
    /// Cells there may be.
    pub(super) most: usize,
    /// Size of the scene, metres.
    pub(super) size: f64,
    /// The wish to stop.
    pub(super) cancel: &'a CancelToken,
}

/// Splits elements and finds the light of the new ones by `gathered`, of nodes from a number on, front and back. `light` tells the
/// light of each patch that differences are compared with, W/m². Stops where there would be too many, and tells whether it did not.
pub(super) fn refine(
    mesh: &mut Mesh,
    irradiance: &mut Vec<[Rgb; 2]>,
    refinement: &Refinement<'_>,
    light: &[f64],
    gathered: impl Fn(&Mesh, usize) -> Vec<[Rgb; 2]>,
) -> bool {
    let areas = mesh
        .patches
        .iter()
        .map(|node| mesh.nodes[*node as usize].area);
    let mean_area = areas.sum::<f64>() / mesh.patches.len().max(1) as f64;
    for _ in 0..refinement.depth {
        let vertices = Vertices::new(mesh, irradiance, refinement.size);
        let wanted: Vec<u32> = mesh
            .elements()
            .filter(|node| {
                let own = irradiance[*node as usize];
                let at = &mesh.nodes[*node as usize];
                let width = (at.area / mean_area).sqrt();
                let limit = refinement.threshold * light[at.patch as usize];
                !mesh.is_tiny(*node) && range(&vertices, *node, own) * width > limit
            })
            .collect();
        if wanted.is_empty() || refinement.cancel.is_cancelled() {
            return true;
        }
        let start = mesh.nodes.len();
        if start + 4 * wanted.len() > refinement.most {
            return false;
        }
        wanted.into_iter().for_each(|node| mesh.split(node));
        let is_balanced = balance(mesh, refinement);
        irradiance.extend(gathered(mesh, start));
        if !is_balanced {
            return false;
        }
    }
    true
}

/// Splits what has neighbours more than one split smaller; whether there was room.
fn balance(mesh: &mut Mesh, refinement: &Refinement<'_>) -> bool {
    loop {
        let large: Vec<u32> = crowded(mesh, refinement.size)
            .into_iter()
            .filter(|node| !mesh.is_tiny(*node))
            .collect();
        if large.is_empty() || refinement.cancel.is_cancelled() {
            return true;
        }
        if mesh.nodes.len() + 4 * large.len() > refinement.most {
            return false;
        }
        for node in large {
            if mesh.nodes[node as usize].children == NONE {
                mesh.split(node);
            }
        }
    }
}

/// The largest difference, over an element, of the light of either side.
fn range(vertices: &Vertices, node: u32, own: [Rgb; 2]) -> f64 {
    let of_side = |side: usize| {
        let corners = vertices.of(node).map(|corner| corner[side].mean());
        let start = own[side].mean();
        let (low, high) = corners.fold((start, start), |(low, high), light| {
            (low.min(light), high.max(light))
        });
        high - low
    };
    of_side(0).max(of_side(1))
}
