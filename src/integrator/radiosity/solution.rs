//! What is found out about the light of all surfaces, whatever the camera.

use super::mesh::Mesh;
use super::system::{Patch, Solved};
use super::vertices::Vertices;
use crate::color::Rgb;
use crate::integrator::final_gather::FinalGather;
use std::sync::{Arc, OnceLock};

/// Part of the mean light of a scene: where there is less, differences are compared with so much.
const DARKEST: f64 = 0.125;

/// The light of all surfaces, whatever the camera.
#[derive(Debug)]
pub struct RadiositySolution {
    pub(super) mesh: Mesh,
    pub(super) vertices: Vertices,
    /// The part of the light at corners that mirrors and glass threw there from sources; `None`: nobody knows, or there is none.
    pub(super) focused: Option<Vec<[Rgb; 2]>>,
    /// Whether its faces are those of the scene, once somebody has seen to that.
    pub(super) fits: OnceLock<bool>,
    /// What views have gathered with the settings of the first of them. Not written: any view finds it again.
    pub(super) gather: OnceLock<Arc<FinalGather>>,
    /// Patches into which surfaces are cut.
    pub patches: u64,
    /// Part of all light that was still to be sent when the solver ended.
    pub residual: f64,
    /// Whether that is as little as it was to be: not so where nothing is ever lost.
    pub is_converged: bool,
    /// Whether elements were split as far as was wanted: not so where there was no memory for more. Not written.
    pub is_split: bool,
}

impl RadiositySolution {
    /// What is known of the light while patches are being solved: elements are patches.
    pub(super) fn early(mesh: &Mesh, patches: &[Patch], solved: &Solved, size: f64) -> Self {
        Self {
            vertices: Vertices::new(mesh, &of_patches(mesh, patches, solved), size),
            mesh: mesh.clone(),
            fits: OnceLock::from(true),
            gather: OnceLock::new(),
            patches: patches.len() as u64,
            residual: solved.residual,
            is_converged: false,
            is_split: true,
            focused: None,
        }
    }
}

/// The light of patches that views do not ask for, front and back by node.
pub(super) fn of_patches(mesh: &Mesh, patches: &[Patch], solved: &Solved) -> Vec<[Rgb; 2]> {
    let mut irradiance = vec![[Rgb::BLACK; 2]; mesh.nodes.len()];
    for (at, (patch, node)) in patches.iter().zip(&mesh.patches).enumerate() {
        irradiance[*node as usize] =
            [0, 1].map(|side| solved.irradiance[2 * at + side] + patch.sides[side].stray.all);
    }
    irradiance
}

/// The part of it that mirrors and glass threw there from sources.
pub(super) fn focused_on_patches(mesh: &Mesh, patches: &[Patch]) -> Vec<[Rgb; 2]> {
    let mut focused = vec![[Rgb::BLACK; 2]; mesh.nodes.len()];
    for (patch, node) in patches.iter().zip(&mesh.patches) {
        focused[*node as usize] = [0, 1].map(|side| patch.sides[side].stray.focused);
    }
    focused
}

/// The light of each patch that differences on it are compared with: irradiance of its brighter side, direct light included, mean
/// over channels, but at least a part of the mean of all; W/m².
pub(super) fn light_of(patches: &[Patch], solved: &Solved) -> Vec<f64> {
    let light = |(at, patch): (usize, &Patch)| {
        let side = |side: usize| {
            let total = patch.sides[side].source + solved.irradiance[2 * at + side];
            total.mean()
        };
        side(0).max(side(1))
    };
    let mut all: Vec<f64> = patches.iter().enumerate().map(light).collect();
    let areas = patches.iter().map(|patch| patch.area);
    let sum: f64 = all
        .iter()
        .zip(areas.clone())
        .map(|(light, area)| light * area)
        .sum();
    let least = DARKEST * sum / areas.sum::<f64>();
    all.iter_mut().for_each(|light| *light = light.max(least));
    all
}
