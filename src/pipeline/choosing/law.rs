//! What time buys: how seconds and error of a method depend on its rung and on samples.
//!
//! ```text
//! seconds(n) = shared + begin + n · sample          squared error(n) = bias + noise / n
//! ```
//!
//! `shared` and `bias` belong to a rung of the [ladder](super::family) of a method; a rung up costs more and is less wrong, by what theory
//! says of that method. A pilot measures one low rung; the rungs above follow from it, and are measured again before they are relied on.

use super::family::{Family, TOP};

/// The fewest samples of a pixel where the method is not path tracing: edges need some.
const FEWEST: u32 = 4;
/// The most samples of a pixel.
pub const MOST_SAMPLES: u32 = 1 << 20;
/// Standard errors above which a normal number lies once in twenty.
const SURE: f64 = 1.645;
/// A wanted error is aimed at from so far below, as a part of it: estimates may be off.
const AIM: f64 = 0.9;

/// Seconds and squared relative error of a method on one rung for one view.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Law {
    /// Seconds for what all views share.
    pub shared: f64,
    /// Seconds that the view takes however few samples it has.
    pub begin: f64,
    /// Seconds for one sample of each pixel.
    pub sample: f64,
    /// Squared error by noise of a picture with one sample.
    pub noise: f64,
    /// Squared error that no number of samples mends.
    pub bias: f64,
    /// Standard error of `bias`.
    pub bias_error: f64,
    /// The part of it that is noise of the truth: it stays the same on all rungs.
    pub judge_error: f64,
}

/// A law that was measured.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Known {
    /// Of which method.
    pub family: Family,
    /// On which rung.
    pub rung: u32,
    /// The law there.
    pub law: Law,
}

/// A way to make a picture, and what is expected of it.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Offer {
    /// The method.
    pub family: Family,
    /// Its rung.
    pub rung: u32,
    /// Samples per pixel.
    pub samples: u32,
    /// The part of one more sample that a wanted time has room for.
    pub part_of_sample: f64,
    /// Seconds that the picture will take.
    pub seconds: f64,
    /// Relative error that it will have.
    pub error: f64,
}

impl Law {
    /// Seconds of a picture with so many samples per pixel.
    #[must_use]
    pub fn seconds(&self, samples: u32) -> f64 {
        self.shared + self.begin + self.sample * f64::from(samples)
    }

    /// The bias as it may well be: with 95 % probability it is no larger. Of several rungs the first that seems to do is taken, so an estimate
    /// alone would be too small more often than not.
    #[must_use]
    pub fn likely_bias(&self) -> f64 {
        (self.bias + SURE * self.bias_error).max(0.0)
    }

    /// Relative error of a picture with so many samples per pixel.
    #[must_use]
    pub fn error(&self, samples: u32) -> f64 {
        (self.likely_bias() + self.noise / f64::from(samples)).sqrt()
    }

    /// Samples for which there is time, at most [`MOST_SAMPLES`]; 0 if not even for one.
    #[must_use]
    pub fn samples_within(&self, seconds: f64) -> u32 {
        // The conversion saturates; 0/0 is 0.
        self.room_within(seconds) as u32
    }

    /// The same with the part of a sample that there would be time for too.
    #[must_use]
    pub fn room_within(&self, seconds: f64) -> f64 {
        let left = seconds - self.shared - self.begin;
        (left / self.sample).clamp(0.0, f64::from(MOST_SAMPLES))
    }

    /// Samples with which the error is a little below this one, if there is such a number.
    #[must_use]
    pub fn samples_for(&self, error: f64) -> Option<u32> {
        let left = (AIM * error).powi(2) - self.likely_bias();
        if left <= 0.0 {
            return None;
        }
        let n = (self.noise / left).ceil();
        (n <= f64::from(MOST_SAMPLES)).then(|| (n as u32).max(1))
    }

    /// The law so many rungs above.
    #[must_use]
    pub fn climbed(&self, family: Family, rungs: u32) -> Self {
        let (cost, gain) = family.step();
        let rungs = i32::try_from(rungs).unwrap_or(i32::MAX);
        let gain = gain.powi(rungs);
        let judge = self.judge_error;
        let own = (self.bias_error.powi(2) - judge.powi(2)).max(0.0).sqrt();
        Self {
            shared: self.shared * cost.powi(rungs),
            bias: self.bias * gain,
            bias_error: (own * gain).hypot(judge),
            ..*self
        }
    }
}

impl Known {
    /// All rungs from the measured one up.
    fn ladder(self) -> impl Iterator<Item = Self> {
        let top = TOP.max(self.rung);
        let last = if self.family.has_rungs() {
            top
        } else {
            self.rung
        };
        (self.rung..=last).map(move |rung| Self {
            rung,
            law: self.law.climbed(self.family, rung - self.rung),
            ..self
        })
    }

    /// What this rung gives with so many samples.
    #[must_use]
    pub fn offer(&self, samples: u32) -> Offer {
        Offer {
            family: self.family,
            rung: self.rung,
            samples,
            part_of_sample: 0.0,
            seconds: self.law.seconds(samples),
            error: self.law.error(samples),
        }
    }

    /// The least error in this time; `samples` if their number is not to be chosen.
    #[must_use]
    pub fn best_within(self, seconds: f64, samples: Option<u32>) -> Option<Offer> {
        let in_time = |known: Self| {
            let room = known.law.room_within(seconds);
            let most = known.law.samples_within(seconds);
            let n = samples.unwrap_or(most);
            let part_of_sample = if samples.is_none() { room.fract() } else { 0.0 };
            (n >= 1 && n <= most).then(|| Offer {
                part_of_sample,
                ..known.offer(n)
            })
        };
        self.ladder()
            .filter_map(in_time)
            .min_by(|a, b| a.error.total_cmp(&b.error))
    }

    /// The least time for this error; `samples` if their number is not to be chosen.
    #[must_use]
    pub fn fastest_for(self, error: f64, samples: Option<u32>) -> Option<Offer> {
        let reaches = |known: Self| {
            let fewest = known.law.samples_for(error)?;
            let n = match samples {
                Some(n) => (n >= fewest).then_some(n)?,
                None if known.family == Family::Path => fewest,
                None => fewest.max(FEWEST).next_multiple_of(2),
            };
            Some(known.offer(n))
        };
        self.ladder()
            .filter_map(reaches)
            .min_by(|a, b| a.seconds.total_cmp(&b.seconds))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn photons() -> Known {
        Known {
            family: Family::PhotonMap,
            rung: 0,
            law: Law {
                shared: 0.1,
                begin: 0.0,
                sample: 0.1,
                noise: 0.01,
                bias: 0.01,
                bias_error: 0.0,
                judge_error: 0.0,
            },
        }
    }

    fn path() -> Known {
        Known {
            family: Family::Path,
            rung: 0,
            law: Law {
                sample: 0.2,
                noise: 1.0,
                ..Law::default()
            },
        }
    }

    #[test]
    fn noise_alone_needs_the_squared_number_of_samples() {
        let offer = path().fastest_for(0.1, None).unwrap();
        assert_eq!(offer.samples, 124);
        assert!((offer.seconds - 24.8).abs() < 1e-9 && offer.error < 0.1);
        let half = path().fastest_for(0.05, None).unwrap();
        assert!((half.seconds / offer.seconds - 4.0).abs() < 0.02);
    }

    /// Photons 4^k times as many: MSE falls as their number to the power of 2/3.
    #[test]
    fn a_bias_is_bought_off_rung_by_rung() {
        let known = photons();
        assert!(known.law.samples_for(0.1).is_none());
        let offer = known.fastest_for(0.05, None).unwrap();
        assert_eq!(offer.rung, 2);
        assert!(offer.error <= 0.05 && offer.samples >= 4);
        let two = known.law.climbed(Family::PhotonMap, 3);
        assert!((two.bias / known.law.bias - 64_f64.powf(-2.0 / 3.0)).abs() < 1e-12);
        assert!((two.shared / known.law.shared - 64.0).abs() < 1e-9);
        // Nothing is promised beyond the top.
        assert_eq!(known.fastest_for(1e-4, None), None);
    }

    /// What a better map cannot mend is not promised of it: a truth that is known to no more than the wanted square.
    #[test]
    fn no_rung_is_surer_than_the_truth() {
        let mut known = photons();
        (known.law.bias_error, known.law.judge_error) = (0.005, 0.003);
        assert_eq!(known.fastest_for(0.05, None), None);
        let above = known.law.climbed(Family::PhotonMap, 30);
        assert!((above.bias_error - 0.003).abs() < 1e-6, "{above:?}");
        known.law.judge_error = 0.0;
        assert!(known.fastest_for(0.05, None).is_some());
    }

    #[test]
    fn more_time_gives_no_larger_error_and_is_not_exceeded() {
        let mut before = f64::INFINITY;
        for seconds in [0.3, 1.0, 3.0, 10.0, 100.0] {
            let offer = photons().best_within(seconds, None).unwrap();
            assert!(
                offer.seconds <= seconds && offer.error <= before,
                "{offer:?}"
            );
            let rest = offer.part_of_sample * photons().law.sample;
            assert!((seconds - offer.seconds - rest).abs() < 1e-9, "{offer:?}");
            before = offer.error;
        }
        assert_eq!(photons().best_within(0.1, None), None);
        assert_eq!(path().best_within(0.1, None), None);
    }

    #[test]
    fn samples_that_the_user_names_stay() {
        assert_eq!(path().fastest_for(0.1, Some(100)), None);
        assert_eq!(
            path().fastest_for(0.1, Some(200)).map(|o| o.samples),
            Some(200)
        );
        let offer = photons().best_within(10.0, Some(3)).unwrap();
        assert_eq!((offer.samples, offer.part_of_sample), (3, 0.0));
    }
}
