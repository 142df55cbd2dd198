//! Frames of one film with unequal samples: where frames have few, one more in all of them is too large a step for a wanted time.

/// The part of a film's frames whose pixels have one sample more than the options say, evenly all over the film.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub(super) struct OneMore(f64);

/// Parts are told in so many steps.
const STEPS: f64 = 1000.0;

impl OneMore {
    /// The whole samples of a number of them, at least one, and the part of frames that makes up for the rest.
    pub(super) fn split(samples: f64) -> (u32, Self) {
        // The conversion saturates.
        let whole = (samples as u32).max(1);
        (whole, Self::of(samples - f64::from(whole)))
    }

    /// This part, 0 to 1.
    pub(super) fn of(part: f64) -> Self {
        let steps = (part * STEPS).floor().clamp(0.0, STEPS);
        // What is no number is none.
        Self(if steps.is_finite() {
            steps / STEPS
        } else {
            0.0
        })
    }

    /// The part as a number.
    pub(super) fn part(self) -> f64 {
        self.0
    }

    /// What is said of the settings of all frames, with this.
    pub(super) fn told(self, settings: String) -> String {
        if self.0 > 0.0 {
            format!(
                "{settings}, one sample more in {:.0} % of the frames",
                100.0 * self.0
            )
        } else {
            settings
        }
    }

    /// Whether this frame is one of them.
    pub(super) fn has(self, frame: u32) -> bool {
        let before = |frame: f64| (frame * self.0).floor();
        before(f64::from(frame) + 1.0) > before(f64::from(frame))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_part_of_the_frames_evenly_has_one_more() {
        let (whole, more) = OneMore::split(3.25);
        assert_eq!((whole, more.part()), (3, 0.25));
        let frames: Vec<u32> = (0..12).filter(|frame| more.has(*frame)).collect();
        assert_eq!(frames, [3, 7, 11]);
        for samples in [1.0, 1.618, 2.5, 7.999, 1000.4] {
            let (whole, more) = OneMore::split(samples);
            for n in [1, 10, 1000] {
                let all = |frame| whole + u32::from(more.has(frame));
                let sum: u32 = (0..n).map(all).sum();
                let wanted = samples * f64::from(n);
                assert!(
                    f64::from(sum) <= wanted
                        && f64::from(sum) > wanted - 1.0 - 0.001 * f64::from(n)
                );
            }
        }
    }

    #[test]
    fn no_number_is_none() {
        for samples in [f64::NAN, -3.0, 0.0, f64::NEG_INFINITY] {
            assert_eq!(OneMore::split(samples), (1, OneMore::default()));
        }
        assert_eq!(OneMore::of(7.0).part(), 1.0);
        assert_eq!(OneMore::split(f64::INFINITY).0, u32::MAX);
    }
}
