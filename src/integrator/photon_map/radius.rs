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

/// The largest kernel of light that falls nearly everywhere, in usual ones: where a thousandth of the usual photons fall, it still holds
/// as many.
const WIDE: f64 = 32.0;

/// The largest kernel of light in small places, in usual ones: 1600 photons, 3 % noise.
const NARROW: f64 = 4.0;

/// Places where that is tried.
const PLACES: usize = 1024;

/// Photons among which they look for neighbours.
const LOOKED_AT: usize = 1 << 17;

/// The fewest neighbours they look for.
const FEWEST: usize = 10;

/// How sizes of kernels are found.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) enum Sizes {
    /// All are disks of this area, m².
    Area(f64),
    /// Chosen for light that falls nearly everywhere: begun with so wide that the dim is as calm as the bright.
    Wide,
    /// Chosen for light in small places, between which it is dark, as that of caustics.
    Narrow,
}

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
    /// All the same, of a disk of a given area; or chosen, such that the usual kernel holds [`PHOTONS`] photons in the (geometric)
    /// mean over photons. `None` if there are no photons or the area is nothing. Bounded by the scene's `size`.
    pub(super) fn new(photons: &[Stored], sizes: Sizes, size: f64) -> Option<Self> {
        if photons.is_empty() {
            return None;
        }
        // Infinite planes have no size; where there is nothing else, a metre is as good as any.
        let size = if size > 0.0 { size } else { 1.0 };
        let (least, most) = (SMALLEST_KERNEL * size, LARGEST_KERNEL * size);
        let in_usual = match sizes {
            Sizes::Area(area) => {
                let radius = (area / PI).sqrt();
                return (radius > 0.0).then(|| Self::same(radius.clamp(least, size)));
            }
            Sizes::Wide => WIDE,
            Sizes::Narrow => NARROW,
        };
        let usual = usual(photons, LOOKED_AT, least).clamp(least, most);
        Some(Self {
            largest: (in_usual * usual).min(most),
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
fn usual(photons: &[Stored], looked_at: usize, least: f64) -> f64 {
    // Every photon of few, or every so-manieth of many, which are then as many times as far apart in area.
    let step = photons.len().div_ceil(looked_at);
    let looked: Vec<[f64; 3]> = photons
        .iter()
        .step_by(step)
        .map(|photon| turned(photon.position()))
        .collect();
    // Each is the nearest to itself; of fewer the distance would be too much by chance.
    let others = (PHOTONS / step).max(FEWEST).min(looked.len() - 1).max(1);
    let wanted = NonZeroUsize::new(others + 1).unwrap_or(NonZeroUsize::MIN);
    let scale = (PHOTONS as f64 / (others * step) as f64).sqrt();
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
            let radii = Radii::new(&even, Sizes::Narrow, 10.0).unwrap();
            let held = PI * radii.usual * radii.usual * n as f64;
            assert!((held / 100.0 - 1.0).abs() < 0.15, "{n}: {held}");
            assert!((radii.largest / radii.usual - 4.0).abs() < 1e-12);
            // A twentieth of the scene at most.
            let wide = Radii::new(&even, Sizes::Wide, 10.0).unwrap().largest;
            assert!((wide - (32.0 * radii.usual).min(0.5)).abs() < 1e-12);
        }
    }

    /// Of photons of which only every fourth or four hundredth is looked at too: then the tenth neighbour must stand for the hundredth. 1 % of
    /// noise; the nearest one, which is itself, would be nowhere.
    #[test]
    fn of_many_photons_some_are_looked_at() {
        let n = 400_000;
        let even = photons(n, |u, v| DVec3::new(u, v, 0.3));
        for looked_at in [100_000, 1_000] {
            let radius = usual(&even, looked_at, 1e-4);
            let held = PI * radius * radius * n as f64;
            assert!((held / 100.0 - 1.0).abs() < 0.2, "{looked_at}: {held}");
        }
    }

    #[test]
    fn c38_coincident_and_coplanar_photons_have_a_kernel() {
        let least = SMALLEST_KERNEL * 10.0;
        let one = photons(100_000, |_, _| DVec3::new(0.1, 0.7, -0.3));
        let radii = Radii::new(&one, Sizes::Wide, 10.0).unwrap();
        assert_eq!(radii.usual, least);
        let line = photons(50_000, |u, _| DVec3::new(u, 0.0, 0.0));
        let radii = Radii::new(&line, Sizes::Wide, 10.0).unwrap();
        assert!((radii.usual / 1e-3 - 1.0).abs() < 0.3, "{radii:?}");
        let single = Radii::new(&one[..1], Sizes::Wide, 0.0).unwrap();
        assert!(single.smallest > 0.0 && single.usual >= single.smallest);
        assert_eq!(Radii::new(&[], Sizes::Wide, 1.0), None);
        assert_eq!(Radii::new(&one, Sizes::Area(0.0), 1.0), None);
    }
}
