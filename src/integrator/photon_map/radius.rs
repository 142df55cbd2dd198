//! How large kernels are.
//!
//! Neighbours are found by kiddo's k-d tree, which is the right tool where it is not known how far away they are; where it is known, the
//! [grid](crate::integrator::grid) is. Trees that never change take any number of coincident points; those that can be changed refuse them.

use super::stored::Stored;
use crate::math::functions::{exp, ln};
use crate::math::tolerance::{LARGEST_KERNEL, SMALLEST_KERNEL};
use glam::DVec3;
use kiddo::{ImmutableKdTree, SquaredEuclidean};
use rayon::prelude::*;
use std::f64::consts::PI;
use std::num::NonZeroUsize;

/// Photons within the usual kernel where its size is chosen: 10 % noise.
const PHOTONS: usize = 100;

/// The largest kernel in usual ones, where light is even: 1600 photons, 3 % noise.
const LARGEST: f64 = 4.0;

/// Places where that is tried.
const PLACES: usize = 1024;

/// Photons among which they look for neighbours.
const LOOKED_AT: usize = 1 << 17;

/// Radii of kernels, metres.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Radii {
    /// Where there is no reason for a smaller one.
    pub(super) largest: f64,
    /// As large as the scene asks for as a whole: pieces that are smaller have their light as a whole.
    pub(super) usual: f64,
    /// Never smaller.
    pub(super) smallest: f64,
}

impl Radii {
    /// All the same, of a disk of this area; or chosen, such that the usual kernel holds [`PHOTONS`] photons in the (geometric)
    /// mean over photons. `None` if there are no photons or the area is nothing. Bounded by the scene's `size`.
    pub(super) fn new(photons: &[Stored], area: Option<f64>, size: f64) -> Option<Self> {
        if photons.is_empty() {
            return None;
        }
        // Infinite planes have no size; where there is nothing else, a metre is as good as any.
        let size = if size > 0.0 { size } else { 1.0 };
        let (least, most) = (SMALLEST_KERNEL * size, LARGEST_KERNEL * size);
        if let Some(area) = area {
            let radius = (area / PI).sqrt();
            return (radius > 0.0).then(|| Self::same(radius.clamp(least, size)));
        }
        let usual = usual(photons, least).clamp(least, most);
        Some(Self {
            largest: (LARGEST * usual).min(most),
            usual,
            smallest: least,
        })
    }

    fn same(radius: f64) -> Self {
        Self {
            largest: radius,
            usual: radius,
            smallest: radius,
        }
    }
}

/// The radius that holds [`PHOTONS`] photons in the geometric mean over places.
fn usual(photons: &[Stored], least: f64) -> f64 {
    // Every photon of few, or every so-manieth of many, which are then as many times as far apart in area.
    let step = photons.len().div_ceil(LOOKED_AT);
    let looked: Vec<[f64; 3]> = photons
        .iter()
        .step_by(step)
        .map(|photon| turned(photon.position()))
        .collect();
    let wanted = (PHOTONS / step).clamp(1, looked.len());
    let wanted = NonZeroUsize::new(wanted).unwrap_or(NonZeroUsize::MIN);
    let scale = (PHOTONS as f64 / (wanted.get() * step) as f64).sqrt();
    let tree = ImmutableKdTree::<f64, 3>::new_from_slice(&looked)
        .expect("invariant: trees that never change can be built of any points");
    let n = PLACES.min(looked.len());
    let logarithms: Vec<f64> = (0..n)
        .into_par_iter()
        .map(|place| {
            let query = tree.query(&looked[place * looked.len() / n]);
            let nearest = query.nearest_n::<SquaredEuclidean<f64>>(wanted).execute();
            let square = nearest.last().map_or(0.0, |last| last.distance);
            ln(square.sqrt().max(least))
        })
        .collect();
    let mean = logarithms.iter().sum::<f64>() / n as f64;
    exp(mean) * scale
}

/// The point turned so that walls and floors lie across no axis: the tree splits along each axis in turn, in vain where all
/// points have the same coordinate.
fn turned(point: DVec3) -> [f64; 3] {
    const ACROSS: [DVec3; 3] = [
        DVec3::new(0.36, 0.48, -0.8),
        DVec3::new(-0.8, 0.6, 0.0),
        DVec3::new(0.48, 0.64, 0.6),
    ];
    ACROSS.map(|axis| axis.dot(point))
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::math::rng;

    fn photons(n: u64, place: impl Fn(f64, f64) -> DVec3) -> Vec<Stored> {
        let number = |i, k| rng::unit_f64(rng::hash(&[i, k]));
        let photon = |i| Stored::at(place(number(i, 0), number(i, 1)), DVec3::Z, 1.0);
        (0..n).map(photon).collect()
    }

    #[test]
    fn the_usual_kernel_holds_a_hundred_photons() {
        // 0.5 % of noise over places; a wrong count or a wrong sample of many photons is off by tens of per cent.
        for n in [20_000, 400_000] {
            let even = photons(n, |u, v| DVec3::new(u, v, 0.3));
            let radii = Radii::new(&even, None, 10.0).unwrap();
            let held = PI * radii.usual * radii.usual * n as f64;
            assert!((held / 100.0 - 1.0).abs() < 0.15, "{n}: {held}");
            assert!((radii.largest / radii.usual - 4.0).abs() < 1e-12);
        }
    }

    #[test]
    fn c38_coincident_and_coplanar_photons_have_a_kernel() {
        let least = SMALLEST_KERNEL * 10.0;
        let one = photons(100_000, |_, _| DVec3::new(0.1, 0.7, -0.3));
        let radii = Radii::new(&one, None, 10.0).unwrap();
        assert_eq!(radii.usual, least);
        let line = photons(50_000, |u, _| DVec3::new(u, 0.0, 0.0));
        let radii = Radii::new(&line, None, 10.0).unwrap();
        assert!((radii.usual / 1e-3 - 1.0).abs() < 0.3, "{radii:?}");
        let single = Radii::new(&one[..1], None, 0.0).unwrap();
        assert!(single.smallest > 0.0 && single.usual >= single.smallest);
        assert_eq!(Radii::new(&[], None, 1.0), None);
        assert_eq!(Radii::new(&one, Some(0.0), 1.0), None);
    }
}
