//! Where light comes from at a place, as a density of directions for rays that look for it nearby.
//!
//! Source: [`Jensen1995`](crate::references#jensen1995), who takes the directions from photons; here they are those of a
//! [record](super::cache), which has sent rays everywhere already. A density that is wrong costs noise, no bias: whoever asks along such
//! directions divides by it, and sends other rays everywhere.

use super::hemisphere::Hemisphere;
use glam::{DVec2, DVec3};
use std::f64::consts::PI;

/// A density of directions over a half-space, even in each cell.
#[derive(Clone, Debug)]
pub(super) struct Guide {
    cells: Hemisphere,
    /// Probability of each cell and all before it, in 1 / [`u16::MAX`].
    sums: Box<[u16]>,
}

impl Guide {
    /// The most cells that are worth their memory.
    pub(super) const CELLS: u32 = 256;

    /// Directions in proportion to the light from each cell and from those around it: seen from nearby it comes from beside.
    /// `None` in the dark.
    pub(super) fn new(cells: Hemisphere, light: &[f64]) -> Option<Self> {
        let spread = |at: usize| {
            let (sum, n) = cells.around(at).fold((light[at], 1.0), |(sum, n), other| {
                (sum + light[other], n + 1.0)
            });
            sum / n
        };
        let spread: Vec<f64> = (0..light.len()).map(spread).collect();
        let total: f64 = spread.iter().sum();
        if !(total > 0.0 && total < f64::INFINITY) {
            return None;
        }
        let mut sum = 0.0;
        let mut sums: Box<[u16]> = spread
            .iter()
            .map(|light| {
                sum += light;
                (sum / total * f64::from(u16::MAX)) as u16
            })
            .collect();
        if let Some(last) = sums.last_mut() {
            *last = u16::MAX;
        }
        Some(Self { cells, sums })
    }

    /// A direction, told by a point in [0, 1)².
    pub(super) fn direction(&self, u: DVec2) -> DVec3 {
        let chosen = u.x * f64::from(u16::MAX);
        let at = self.sums.partition_point(|sum| f64::from(*sum) <= chosen);
        let at = at.min(self.sums.len() - 1);
        let (begin, share) = self.share(at);
        let along = ((chosen - f64::from(begin)) / f64::from(share)).clamp(0.0, 1.0 - f64::EPSILON);
        self.cells.direction(at as u32, DVec2::new(along, u.y))
    }

    /// Density of a direction, 1/sr.
    pub(super) fn pdf_solid_angle(&self, w: DVec3) -> f64 {
        self.cells.cell_of(w).map_or(0.0, |(at, cosine)| {
            let probability = f64::from(self.share(at).1) / f64::from(u16::MAX);
            probability * self.sums.len() as f64 * cosine / PI
        })
    }

    /// Where the share of a cell begins, and how large it is, in 1 / [`u16::MAX`].
    fn share(&self, at: usize) -> (u16, u16) {
        let begin = if at > 0 { self.sums[at - 1] } else { 0 };
        (begin, self.sums[at] - begin)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::math::rng;

    /// A guide of cells as bright as their numbers say, in some of which and round which it is dark.
    fn guide(n_rays: u32) -> (Hemisphere, Guide) {
        let cells = Hemisphere::new(DVec3::new(0.48, -0.6, 0.64), n_rays);
        let bright = |at: u64| (rng::unit_f64(rng::hash(&[at])) * 8.0 - 6.0).max(0.0);
        let light: Vec<f64> = (0..cells.n_cells() as u64).map(bright).collect();
        (cells, Guide::new(cells, &light).unwrap())
    }

    #[test]
    fn directions_come_as_often_as_the_density_says() {
        for n_rays in [1, 2, 7, 64, 256] {
            let (cells, guide) = guide(n_rays);
            let n = 1 << 13;
            // The share of each cell as its density has it, which is even under the cosine, and what it covers, told by rays.
            let share = |w| guide.pdf_solid_angle(w) / cells.cell_of(w).unwrap().1;
            let middles: Vec<DVec3> = cells.middles().collect();
            let each = PI / middles.len() as f64;
            let total: f64 = middles.iter().map(|w| share(*w) * each).sum();
            assert!((total - 1.0).abs() < 1e-9, "{n_rays}: {total}");
            let mut covered = vec![0.0; middles.len()];
            for i in 0..n {
                let turn = 0.618 * (f64::from(i) + 0.5) % 1.0;
                let w = guide.direction(DVec2::new((f64::from(i) + 0.5) / f64::from(n), turn));
                assert!(share(w) > 0.0, "{n_rays} {i}");
                covered[cells.cell_of(w).unwrap().0] += 1.0 / (share(w) * f64::from(n));
            }
            for (covered, w) in covered.into_iter().zip(middles) {
                let off = (covered / each - 1.0).abs() * share(w) * each;
                assert!(off < 2.0 / f64::from(n), "{n_rays}: {covered} {each}");
            }
        }
    }

    #[test]
    fn the_dark_has_no_guide() {
        let cells = Hemisphere::new(DVec3::Z, 64);
        assert!(Guide::new(cells, &vec![0.0; cells.n_cells()]).is_none());
        assert!(Guide::new(cells, &vec![f64::NAN; cells.n_cells()]).is_none());
        assert!(Guide::new(cells, &vec![f64::INFINITY; cells.n_cells()]).is_none());
    }
}
