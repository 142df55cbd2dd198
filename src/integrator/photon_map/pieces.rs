//! Flat pieces smaller than the kernel: leaves. All their light over their area, for each side, which is exact.

use super::stored::Stored;
use crate::color::Rgb;
use crate::math::PrimitiveId;
use crate::scene::{Piece, Scene};
use rayon::prelude::*;

/// Irradiance of one side of a small flat piece.
#[derive(Clone, Copy, Debug)]
pub(super) struct PieceLight {
    /// The piece, and whether it is the back.
    pub(super) key: (PrimitiveId, bool),
    /// W/m².
    pub(super) irradiance: Rgb,
}

/// The light of the pieces of up to twice this radius, sorted by key, and the photons that lie elsewhere.
pub(super) fn split_off_pieces(
    scene: &Scene,
    mut photons: Vec<Stored>,
    radius: f64,
) -> (Vec<PieceLight>, Vec<Stored>) {
    let mut found: Vec<PieceLight> = photons
        .par_iter()
        .filter_map(|photon| {
            let (first, area) = small_piece(scene, photon, radius)?;
            Some(PieceLight {
                key: (first, !photon.is_front()),
                irradiance: photon.power() / area,
            })
        })
        .collect();
    if !found.is_empty() {
        photons.retain(|photon| small_piece(scene, photon, radius).is_none());
    }
    // Stable: photons of a side stay in their order, so their sum is always the same.
    found.par_sort_by_key(|light| light.key);
    (sums(&found), photons)
}

/// The light of both.
pub(super) fn together(lights: &[PieceLight], more: &[PieceLight]) -> Vec<PieceLight> {
    let mut all = [lights, more].concat();
    all.sort_by_key(|light| light.key);
    sums(&all)
}

/// One for each key.
fn sums(lights: &[PieceLight]) -> Vec<PieceLight> {
    let sides = lights.chunk_by(|a, b| a.key == b.key);
    let light = |side: &[PieceLight]| PieceLight {
        key: side[0].key,
        irradiance: side.iter().map(|light| light.irradiance).sum(),
    };
    sides.map(light).collect()
}

/// The flat piece that a photon lies on and its area, if that is smaller than the kernel.
fn small_piece(scene: &Scene, photon: &Stored, radius: f64) -> Option<(PrimitiveId, f64)> {
    match scene.piece(photon.piece()?) {
        Piece::Flat { first, area, size } if size <= 2.0 * radius => Some((first, area)),
        Piece::Flat { .. } | Piece::Body(_) | Piece::Large => None,
    }
}
