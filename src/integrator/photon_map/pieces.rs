//! Pieces smaller than the kernel: leaves, twigs. All their light over their area, for each side, which is exact in the mean.
//!
//! A kernel as small as a twig would hold a photon or none. Its light would be asked for only where there is one, and reach farther
//! than the kernel does: the fewer photons, the brighter (a hundred thousandfold on the twigs of a forest, before bodies counted as
//! pieces).

use super::stored::Stored;
use crate::color::Rgb;
use crate::math::PrimitiveId;
use crate::scene::{Piece, Scene};
use rayon::prelude::*;

/// A body counts as a piece if it is flat no farther than over this part of the usual kernel's radius, which holds a hundred photons: a
/// kernel of that size would hold sixteen.
const BODY_SHARE: f64 = 0.4;

/// Irradiance of one side of a small piece.
#[derive(Clone, Copy, Debug)]
pub(super) struct PieceLight {
    /// The piece, and whether it is the back.
    pub(super) key: (PrimitiveId, bool),
    /// W/m².
    pub(super) irradiance: Rgb,
}

/// The primitive that names a piece, if the piece is so small that its light is known as a whole where the usual kernel has this radius.
pub(super) fn small(piece: &Piece, radius: f64) -> Option<PrimitiveId> {
    match *piece {
        Piece::Flat { first, size, .. } if size <= 2.0 * radius => Some(first),
        Piece::Body { first, flat } if flat <= BODY_SHARE * radius => Some(first),
        Piece::Flat { .. } | Piece::Body { .. } | Piece::Large => None,
    }
}

/// The light of the pieces that are [`small`] for this radius, sorted by key, and the photons that lie elsewhere.
pub(super) fn split_off_pieces(
    scene: &Scene,
    mut photons: Vec<Stored>,
    radius: f64,
) -> (Vec<PieceLight>, Vec<Stored>) {
    let key = |photon: &Stored| {
        let first = small(&photon.piece(scene), radius)?;
        Some((first, !photon.is_front()))
    };
    // As a sum of power first: areas are asked for once a piece.
    let found = photons.par_iter().filter_map(|photon| {
        Some(PieceLight {
            key: key(photon)?,
            irradiance: photon.power(),
        })
    });
    let mut found: Vec<PieceLight> = found.collect();
    if !found.is_empty() {
        photons.retain(|photon| key(photon).is_none());
    }
    // Stable: photons of a side stay in their order, so their sum is always the same.
    found.par_sort_by_key(|light| light.key);
    let mut lights = sums(&found);
    lights.par_iter_mut().for_each(|light| {
        let area = area(scene, light.key.0);
        // What has no area has no light: a photon that met it met it by chance of rounding.
        light.irradiance = if area > 0.0 {
            light.irradiance / area
        } else {
            Rgb::BLACK
        };
    });
    (lights, photons)
}

/// Area of one side of a piece, m².
fn area(scene: &Scene, first: PrimitiveId) -> f64 {
    match scene.piece(first) {
        Piece::Flat { area, .. } => area,
        Piece::Body { first, .. } => scene.area_of(first),
        Piece::Large => 0.0,
    }
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
