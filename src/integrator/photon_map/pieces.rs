//! Pieces smaller than the kernel: leaves, twigs. All their light over their area, for each side, which is exact in the mean. Those that
//! expect so few photons that it is little else than noise [share](super::pool) it with those near them.
//!
//! A kernel as small as a twig would hold a photon or none. Its light would be asked for only where there is one, and reach farther
//! than the kernel does: the fewer photons, the brighter (a hundred thousandfold on the twigs of a forest, before bodies counted as
//! pieces).

use super::stored::{PackedNormal, Stored};
use crate::color::Rgb;
use crate::math::PrimitiveId;
use crate::scene::{Piece, Scene};
use glam::Vec3;
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

/// Power on one side of a small piece.
#[derive(Clone, Copy, Debug)]
pub(super) struct PiecePower {
    /// The piece, and whether it is the back.
    pub(super) key: (PrimitiveId, bool),
    /// W.
    pub(super) power: Rgb,
    /// Where its first photon lies, relative to the middle of the scene, and the normal there.
    pub(super) position: Vec3,
    pub(super) normal: PackedNormal,
}

/// The primitive that names a piece, if the piece is so small that its light is known as a whole where the usual kernel has this radius.
pub(super) fn small(piece: &Piece, radius: f64) -> Option<PrimitiveId> {
    match *piece {
        Piece::Flat { first, size, .. } if size <= 2.0 * radius => Some(first),
        Piece::Body { first, flat, .. } if flat <= BODY_SHARE * radius => Some(first),
        Piece::Flat { .. } | Piece::Body { .. } | Piece::Large => None,
    }
}

/// The power on the pieces that are [`small`] for this radius, sorted by key, and the photons that lie elsewhere.
pub(super) fn split_off_pieces(
    scene: &Scene,
    mut photons: Vec<Stored>,
    radius: f64,
) -> (Vec<PiecePower>, Vec<Stored>) {
    let key = |photon: &Stored| {
        let first = small(&photon.piece(scene), radius)?;
        Some((first, !photon.is_front()))
    };
    let found = photons.par_iter().filter_map(|photon| {
        Some(PiecePower {
            key: key(photon)?,
            power: photon.power(),
            position: photon.position().as_vec3(),
            normal: photon.packed_normal(),
        })
    });
    let mut found: Vec<PiecePower> = found.collect();
    if !found.is_empty() {
        photons.retain(|photon| key(photon).is_none());
    }
    // Stable: photons of a side stay in their order, so their sum is always the same.
    found.par_sort_by_key(|piece| piece.key);
    (sums(&found), photons)
}

/// Power over area.
pub(super) fn over_area(scene: &Scene, powers: &[PiecePower]) -> Vec<PieceLight> {
    let light = |piece: &PiecePower| {
        let area = match scene.piece(piece.key.0) {
            Piece::Flat { area, .. } => area,
            Piece::Body { first, .. } => scene.area_of(first),
            Piece::Large => 0.0,
        };
        PieceLight {
            key: piece.key,
            // What has no area has no light: a photon that met it met it by chance of rounding.
            irradiance: if area > 0.0 {
                piece.power / area
            } else {
                Rgb::BLACK
            },
        }
    };
    powers.par_iter().map(light).collect()
}

/// The power of both.
pub(super) fn together(powers: &[PiecePower], more: &[PiecePower]) -> Vec<PiecePower> {
    let mut all = [powers, more].concat();
    all.sort_by_key(|piece| piece.key);
    sums(&all)
}

/// One for each key.
fn sums(powers: &[PiecePower]) -> Vec<PiecePower> {
    let sides = powers.chunk_by(|a, b| a.key == b.key);
    let sum = |side: &[PiecePower]| PiecePower {
        power: side.iter().map(|piece| piece.power).sum(),
        ..side[0]
    };
    sides.map(sum).collect()
}
