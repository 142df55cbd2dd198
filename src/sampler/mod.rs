//! Where the points of the unit square come from that decide every random choice of a picture.
//!
//! A [`Sampler`] stands for one sample of one pixel. Each *use* of randomness on a path has its own number (a *pad*: two
//! dimensions that are well spread together), counted from the path's vertex, so that the third scattering always draws from
//! the same pads, whatever happened before. All points are pure functions of (stream, sample index, pad).

mod sobol;

use crate::math::rng;
use glam::DVec2;

/// How the points of successive samples are spread.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum SamplerKind {
    /// Owen-scrambled Sobol points, pads of two dimensions, by hashing ([Burley2020](crate::references#burley2020)).
    ///
    /// The first 2^k samples of a pixel put exactly one point in every elementary interval of every pad, so the error of a
    /// smooth integrand falls as N^-1.5, never worse than with independent numbers.
    #[default]
    OwenSobol,
    /// Independent random numbers: for measuring what good spreading is worth.
    Independent,
}

/// What a random choice on a path is for; each use has a pad of its own at every vertex.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Use {
    /// Position in the pixel (vertex 0), direction of scattering (all others).
    Direction,
    /// Which light (x), whether the path goes on (y).
    Choice,
    /// Position on the so-manieth light that is asked at this vertex.
    Light(u16),
    /// Whether light meets the so-manieth half-transparent surface on the way to this vertex.
    Passage(u16),
    /// Which part of the surface scatters (x), and whether it reflects or refracts (y).
    Lobe,
    /// Position on the lens (vertex 0).
    Lens,
    /// When the shutter is passed (x; vertex 0).
    Time,
}

impl Use {
    /// The pad within a vertex. The two counted uses take the even and the odd numbers from 2 on.
    const fn pad(self) -> u32 {
        match self {
            Self::Direction => 0,
            Self::Choice => 1,
            Self::Light(nth) => 2 + 2 * nth as u32,
            Self::Passage(nth) => 3 + 2 * nth as u32,
            Self::Lobe => 2 + 2 * (1 << 16),
            Self::Lens => 3 + 2 * (1 << 16),
            Self::Time => 4 + 2 * (1 << 16),
        }
    }
}

/// Pads per vertex: five fixed uses and two counted ones of 65,536 each, rounded up.
const PADS_PER_VERTEX: u64 = 1 << 18;

/// The points of one sample.
#[derive(Clone, Debug)]
pub struct Sampler {
    kind: SamplerKind,
    /// Hash of the stream, which chooses the scrambling: the same for all samples of one half of one pixel, and for nothing else.
    stream: u64,
    index: u32,
    first_pad: u64,
}

impl Sampler {
    /// Sample number `index` of the stream `stream`.
    ///
    /// Samples of one stream are spread together and add up to one estimate; different streams are independent.
    #[must_use]
    pub const fn new(kind: SamplerKind, stream: u64, index: u32) -> Self {
        Self {
            kind,
            stream: rng::hash_one(stream),
            index,
            first_pad: 0,
        }
    }

    /// One of several samples that take the place of this one, spread together with those of the others of its stream.
    #[must_use]
    pub fn part(&self, nth: u32, of: u32) -> Self {
        Self {
            index: self.index.wrapping_mul(of).wrapping_add(nth),
            ..self.clone()
        }
    }

    /// Moves to the pads of path vertex `vertex` (0: the camera).
    pub const fn start_vertex(&mut self, vertex: u32) {
        self.first_pad = vertex as u64 * PADS_PER_VERTEX;
    }

    /// The point in [0, 1)² for a use at this vertex. The same use at the same vertex gives the same point.
    #[must_use]
    pub fn point(&self, purpose: Use) -> DVec2 {
        self.pad(self.first_pad + u64::from(purpose.pad()))
    }

    /// The point of pad `pad`.
    fn pad(&self, pad: u64) -> DVec2 {
        let key = rng::hash_on(self.stream, pad);
        let [x, y] = match self.kind {
            SamplerKind::OwenSobol => sobol::scrambled_pad(self.index, key),
            SamplerKind::Independent => {
                split(rng::hash_on(rng::hash_one(key), u64::from(self.index)))
            }
        };
        DVec2::new(rng::unit_f64_from_u32(x), rng::unit_f64_from_u32(y))
    }
}

/// The high and the low half of 64 bits.
#[expect(
    clippy::cast_possible_truncation,
    reason = "the halves are what is wanted"
)]
const fn split(bits: u64) -> [u32; 2] {
    [(bits >> 32) as u32, bits as u32]
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::collections::BTreeSet;

    /// Points of one pad of the first `n` samples of a stream.
    fn points(kind: SamplerKind, stream: u64, vertex: u32, purpose: Use, n: u32) -> Vec<DVec2> {
        (0..n)
            .map(|index| {
                let mut sampler = Sampler::new(kind, stream, index);
                sampler.start_vertex(vertex);
                sampler.point(purpose)
            })
            .collect()
    }

    #[test]
    fn every_elementary_interval_holds_one_point() {
        for stream in 0..8 {
            for vertex in [0, 1, 5] {
                for log_n in [0_u32, 1, 4, 8] {
                    let n = 1 << log_n;
                    let points = points(SamplerKind::OwenSobol, stream, vertex, Use::Light(0), n);
                    for log_columns in 0..=log_n {
                        let columns = f64::from(1_u32 << log_columns);
                        let rows = f64::from(1_u32 << (log_n - log_columns));
                        let cells: BTreeSet<[u64; 2]> = points
                            .iter()
                            .map(|p| [(p.x * columns) as u64, (p.y * rows) as u64])
                            .collect();
                        assert_eq!(cells.len(), n as usize, "{stream} {vertex} {n} {columns}");
                    }
                }
            }
        }
    }

    /// Correlation of two lists of numbers in 0..1.
    fn correlation(a: &[f64], b: &[f64]) -> f64 {
        let products = a.iter().zip(b).map(|(a, b)| (a - 0.5) * (b - 0.5));
        12.0 * products.sum::<f64>() / a.len() as f64
    }

    #[test]
    fn pads_streams_and_vertices_are_independent() {
        let n = 4096;
        let xs = |p: Vec<DVec2>| p.into_iter().map(|p| p.x).collect::<Vec<_>>();
        let ys = |p: Vec<DVec2>| p.into_iter().map(|p| p.y).collect::<Vec<_>>();
        for kind in [SamplerKind::OwenSobol, SamplerKind::Independent] {
            let lists = [
                xs(points(kind, 1, 1, Use::Direction, n)),
                ys(points(kind, 1, 1, Use::Direction, n)),
                xs(points(kind, 1, 1, Use::Light(0), n)),
                xs(points(kind, 1, 1, Use::Choice, n)),
                xs(points(kind, 1, 2, Use::Direction, n)),
                xs(points(kind, 2, 1, Use::Direction, n)),
            ];
            for (i, a) in lists.iter().enumerate() {
                for b in &lists[..i] {
                    // Five standard errors of independent numbers; 15 comparisons.
                    let in_errors = correlation(a, b) * f64::from(n).sqrt();
                    assert!(in_errors.abs() < 5.0, "{kind:?} {i}: {in_errors}");
                }
            }
        }
    }

    #[test]
    fn scrambling_is_uniform_over_streams() {
        // One sample of many streams must be uniform in the square: χ² over 16 × 16 cells.
        let mut counts = [0_u32; 256];
        let n = 1_u32 << 16;
        for stream in 0..n {
            let p = Sampler::new(SamplerKind::OwenSobol, u64::from(stream), 3).point(Use::Light(0));
            counts[(p.x * 16.0) as usize * 16 + (p.y * 16.0) as usize] += 1;
        }
        let expected = f64::from(n) / 256.0;
        let chi: f64 = counts
            .iter()
            .map(|&c| (f64::from(c) - expected).powi(2) / expected)
            .sum();
        assert!(
            crate::math::stats::chi_squared_upper_tail(chi, 255.0) > 1e-6,
            "{chi}"
        );
    }

    #[test]
    fn no_two_uses_share_a_pad() {
        let counted = (0..=u16::MAX).flat_map(|k| [Use::Light(k), Use::Passage(k)]);
        let pads: BTreeSet<u32> = counted
            .chain([Use::Direction, Use::Choice, Use::Lobe, Use::Lens, Use::Time])
            .map(Use::pad)
            .collect();
        assert_eq!(pads.len(), 5 + 2 * 65_536);
        assert!(pads.iter().all(|pad| u64::from(*pad) < PADS_PER_VERTEX));
    }
}
