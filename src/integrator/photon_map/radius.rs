//! How large the kernel is.

use super::stored::Stored;
use crate::math::functions::{exp, ln};
use crate::math::tolerance::{LARGEST_KERNEL, SMALLEST_KERNEL};
use rayon::prelude::*;
use std::f64::consts::PI;

/// Photons within the kernel where its size is chosen: 10 % noise.
const PHOTONS: usize = 100;

/// Places where that is tried.
const PLACES: usize = 64;

/// Photons that each place looks at.
const LOOKED_AT: usize = 1 << 20;

/// The radius of the kernel in metres: of a disk of this area, or such that it holds [`PHOTONS`] photons in the (geometric) mean
/// over photons. `None` if there are no photons or the area is nothing. Bounded by the scene's `size`.
pub(super) fn kernel_radius(photons: &[Stored], area: Option<f64>, size: f64) -> Option<f64> {
    if photons.is_empty() {
        return None;
    }
    // Infinite planes have no size; where there is nothing else, a metre is as good as any.
    let size = if size > 0.0 { size } else { 1.0 };
    let (least, most) = (SMALLEST_KERNEL * size, LARGEST_KERNEL * size);
    if let Some(area) = area {
        let radius = (area / PI).sqrt();
        return (radius > 0.0).then(|| radius.clamp(least, size));
    }
    // Every photon of few, or every so-manieth of many, which are then as many times as far apart in area.
    let step = photons.len().div_ceil(LOOKED_AT);
    let looked: Vec<_> = photons.iter().step_by(step).map(Stored::position).collect();
    let wanted = (PHOTONS / step).clamp(1, looked.len());
    let scale = (PHOTONS as f64 / (wanted * step) as f64).sqrt();
    let n = PLACES.min(looked.len());
    let logarithms: Vec<f64> = (0..n)
        .into_par_iter()
        .map(|place| {
            let at = looked[place * looked.len() / n];
            let mut squares: Vec<f64> = looked.iter().map(|p| p.distance_squared(at)).collect();
            let (_, nth, _) = squares.select_nth_unstable_by(wanted - 1, f64::total_cmp);
            ln(nth.sqrt().max(least))
        })
        .collect();
    let mean = logarithms.iter().sum::<f64>() / n as f64;
    Some((exp(mean) * scale).clamp(least, most))
}
