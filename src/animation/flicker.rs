//! How much a film flickers: the change from frame to frame that is not in what is shown.
//!
//! Let A be two neighbouring frames and B the same two made with other random numbers. The noise of A and that of B know
//! nothing of each other, so the mean of (A₁ − A₀)(B₁ − B₀) over all pixels is the mean square of the change that is really
//! there, without bias and without a reference picture; what (A₁ − A₀)² has beyond it is flicker.

use serde::{Deserialize, Serialize};

/// How much a film flickers, in levels of 8-bit sRGB, root of the mean square over pixels, channels and pairs of frames.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub struct Flicker {
    /// Pairs of neighbouring frames that were looked at.
    pub pairs: u32,
    /// All change from frame to frame.
    pub change: f64,
    /// The part of it that is not in what is shown.
    pub flicker: f64,
    /// What that part would be with new random numbers in each frame.
    pub flicker_with_new_noise: f64,
}

/// Sums up pairs of frames.
#[derive(Clone, Copy, Debug, Default)]
pub struct FlickerMeter {
    pairs: u32,
    n: f64,
    change: f64,
    common: f64,
    noise: f64,
}

impl FlickerMeter {
    /// Takes two neighbouring frames of the film and the same two made with other random numbers; 8-bit sRGB of equal size.
    pub fn add(&mut self, film: [&[u8]; 2], again: [&[u8]; 2]) {
        self.pairs += 1;
        let frames = film[0].iter().zip(film[1]);
        let others = again[0].iter().zip(again[1]);
        for ((a0, a1), (b0, b1)) in frames.zip(others) {
            let [a0, a1, b0, b1] = [a0, a1, b0, b1].map(|value| f64::from(*value));
            self.n += 1.0;
            self.change += (a1 - a0) * (a1 - a0);
            self.common += (a1 - a0) * (b1 - b0);
            // The difference of two frames that show the same holds the noise of both: as much as new noise would add.
            self.noise += ((a0 - b0) * (a0 - b0) + (a1 - b1) * (a1 - b1)) / 2.0;
        }
    }

    /// What was found; `None` without a pair.
    pub fn result(&self) -> Option<Flicker> {
        if self.n == 0.0 {
            return None;
        }
        let root = |sum: f64| (sum / self.n).max(0.0).sqrt();
        Some(Flicker {
            pairs: self.pairs,
            change: root(self.change),
            flicker: root(self.change - self.common),
            flicker_with_new_noise: root(self.noise),
        })
    }
}

/// The first frames of `wanted` pairs of neighbours, evenly spread over `n_frames` frames.
pub fn pairs(n_frames: u32, wanted: u32) -> Vec<u32> {
    let most = n_frames.saturating_sub(1);
    let n = wanted.min(most);
    (0..u64::from(n))
        .map(|i| ((2 * i + 1) * u64::from(most) / (2 * u64::from(n))) as u32)
        .collect()
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::math::rng;

    /// A gradient that moves by `shift`, with noise of standard deviation 10 drawn from `stream`.
    fn frame(shift: f64, stream: u64) -> Vec<u8> {
        (0..200_000_u64)
            .map(|i| {
                // The sum of 12 uniform numbers has variance 1.
                let noise: f64 = (0..12)
                    .map(|k| rng::hash(&[stream, i, k]) as f64 / u64::MAX as f64)
                    .sum::<f64>()
                    - 6.0;
                (100.0 + (i % 50) as f64 + shift + 10.0 * noise).round() as u8
            })
            .collect()
    }

    #[test]
    fn flicker_is_what_noise_adds_and_motion_is_not_flicker() {
        // 200,000 values: the relative standard error of each sum is below 1 %; a meter that counts motion gives 14.9, one that
        // misses half of the noise 10.
        let frames =
            [(0.0, 1), (5.0, 2), (0.0, 3), (5.0, 4)].map(|(shift, stream)| frame(shift, stream));
        let mut meter = FlickerMeter::default();
        meter.add([&frames[0], &frames[1]], [&frames[2], &frames[3]]);
        let found = meter.result().unwrap();
        let expected = 200_f64.sqrt();
        assert!((found.flicker - expected).abs() < 0.2, "{found:?}");
        assert!(
            (found.flicker_with_new_noise - expected).abs() < 0.2,
            "{found:?}"
        );
        assert!((found.change - 225_f64.sqrt()).abs() < 0.2, "{found:?}");
        // Noise that stays where it is does not flicker.
        let still =
            [(0.0, 1), (5.0, 1), (0.0, 3), (5.0, 3)].map(|(shift, stream)| frame(shift, stream));
        let mut meter = FlickerMeter::default();
        meter.add([&still[0], &still[1]], [&still[2], &still[3]]);
        assert!(meter.result().unwrap().flicker < 1.0, "{meter:?}");
    }

    #[test]
    fn pairs_are_spread_and_exist() {
        assert_eq!(pairs(120, 2), [29, 89]);
        assert_eq!(pairs(2, 5), [0]);
        assert!(pairs(1, 5).is_empty() && pairs(0, 1).is_empty() && pairs(9, 0).is_empty());
    }
}
