//! Sources, and mirrors and glass, that so few photons stand for that no estimate of an error would see what they lack.
//!
//! Halves of the samples, and checks on pixels, see what the photons have found. A lamp that sent ten of a million, or a drop of glass that
//! three of them met, leave light out of the picture, or in a few spots, wherever one looks.

use crate::scene::description::OrganId;
use std::collections::BTreeMap;

/// Photons that stand well enough for a source or a specular body: the noise of their sum is a tenth.
pub const ENOUGH: u64 = 100;

/// How many photons stand for the sources of a scene, or for its mirrors and glass.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Coverage {
    /// How many there are of them.
    pub all: u64,
    /// How many of these have fewer than [`ENOUGH`] photons.
    pub few: u64,
    /// Photons of the one that has fewest.
    pub fewest: u64,
}

impl Coverage {
    /// Of photons counted one by one.
    pub(super) fn of(counts: impl IntoIterator<Item = u64>) -> Self {
        let mut found = Self::default();
        for n in counts {
            found.fewest = if found.all == 0 {
                n
            } else {
                found.fewest.min(n)
            };
            found.all += 1;
            found.few += u64::from(n < ENOUGH);
        }
        found
    }

    /// Of specular organs with these areas, m², of which photons met those in `met`.
    ///
    /// One that none met may lie in the dark: it counts only if, met as densely as the others, it would still have had too few.
    pub(super) fn of_specular(
        areas: &BTreeMap<OrganId, f64>,
        met: &BTreeMap<OrganId, u64>,
    ) -> Self {
        // Infinite planes have no area.
        let known = met
            .iter()
            .filter_map(|(organ, n)| Some((n, areas.get(organ)?)));
        let (n, area) = known.fold((0.0, 0.0), |(sum, all), (n, area)| {
            (sum + *n as f64, all + area)
        });
        let density = if area > 0.0 { n / area } else { 0.0 };
        let is_small = |area: &f64| density * area < ENOUGH as f64;
        let unmet = areas
            .iter()
            .filter(|(organ, area)| !met.contains_key(organ) && is_small(area));
        Self::of(met.values().copied().chain(unmet.map(|_| 0)))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_fewest_and_the_few_are_counted() {
        let found = Coverage::of([5_000, 99, 100, 7]);
        assert_eq!((found.all, found.few, found.fewest), (4, 2, 7));
        assert_eq!(Coverage::of([]), Coverage::default());
    }

    /// A drop a thousandth as large as the ball that 10,000 photons met is too small for them; a second ball is in the dark.
    #[test]
    fn what_no_photon_met_is_missing_only_if_it_is_small() {
        let [ball, drop, dark] = [1, 2, 3].map(OrganId);
        let areas = BTreeMap::from([(ball, 1.0), (drop, 0.001), (dark, 1.0)]);
        let found = Coverage::of_specular(&areas, &BTreeMap::from([(ball, 10_000)]));
        assert_eq!((found.all, found.few, found.fewest), (2, 1, 0));
        // Where none met anything, nothing is known to be lit.
        let none = Coverage::of_specular(&areas, &BTreeMap::new());
        assert_eq!((none.all, none.few), (3, 3));
    }
}
