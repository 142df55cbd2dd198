//! What views ask of the maps.

use super::PhotonSolution;
use super::irradiance::IrradianceMap;
use crate::color::Rgb;
use crate::integrator::final_gather::{FinalGather, Places, SolvedLight, Spot};
use crate::integrator::viewer::Behind;
use crate::scene::{Piece, Scene};
use glam::DVec3;
use std::sync::{Arc, OnceLock};

/// Rays of a gather that are shorter than so many radii of the kernel end where the map is not trusted.
const NEAR: f64 = 2.0;

impl SolvedLight for PhotonSolution {
    const BY_PIECES: bool = true;
    const HAS_UNASKED: bool = false;

    fn behind(&self) -> Behind {
        Behind::Nothing
    }

    fn indirect(&self, scene: &Scene, spot: &Spot<'_>, side: DVec3, is_summed: bool) -> Rgb {
        stored(self.global.as_ref(), scene, spot, side, is_summed)
    }

    fn focused(&self, scene: &Scene, spot: &Spot<'_>, side: DVec3, is_summed: bool) -> Rgb {
        stored(self.caustic.as_ref(), scene, spot, side, is_summed)
    }

    fn knows_wholly(&self, piece: &Piece) -> bool {
        let map = self.global.as_ref();
        map.is_some_and(|map| map.knows_wholly(piece))
    }

    fn blur(&self, _: &Spot<'_>) -> f64 {
        NEAR * self.global.as_ref().map_or(0.0, IrradianceMap::radius)
    }

    fn places(&self, _: &Scene) -> Places {
        self.global.as_ref().map_or(Places::NONE, |map| Places {
            spacing: map.spacing(),
            all: map.places().collect(),
        })
    }

    fn kept(&self) -> &OnceLock<Arc<FinalGather>> {
        &self.gather
    }
}

/// Irradiance of a side as a map has it.
fn stored(
    map: Option<&IrradianceMap>,
    scene: &Scene,
    spot: &Spot<'_>,
    side: DVec3,
    is_summed: bool,
) -> Rgb {
    let (point, piece) = (spot.point, spot.piece);
    match map {
        Some(map) if is_summed => map.coarse_irradiance(scene, point, piece, side),
        Some(map) => map.irradiance(scene, point, piece, side),
        None => Rgb::BLACK,
    }
}
