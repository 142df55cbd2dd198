//! How large a picture can be made in a moment.

use crate::options::value::Renderer;
use std::time::Duration;

/// How long a first impression may take.
const MOMENT: Duration = Duration::from_millis(30);
/// How long the second one may take, where the whole picture takes much longer.
const WHILE: Duration = Duration::from_millis(250);
/// Samples per second before anything was measured.
const UNKNOWN: f64 = 40_000.0;
/// Shortest side of a first impression, in pixels.
const LEAST_SIDE: f64 = 24.0;
/// A picture nearly as large as the whole one takes its place.
const NEARLY: f64 = 0.8;

/// How many samples a second each renderer takes, of the scene at hand.
#[derive(Clone, Debug, Default)]
pub struct Pace {
    measured: Vec<(Renderer, f64)>,
}

impl Pace {
    /// Tells that so many samples took so long.
    pub fn measured(&mut self, renderer: Renderer, n_samples: f64, time: Duration) {
        let rate = n_samples / time.as_secs_f64().max(f64::MIN_POSITIVE);
        self.measured.retain(|(known, _)| *known != renderer);
        self.measured.push((renderer, rate));
    }

    fn rate(&self, renderer: Renderer) -> f64 {
        let known = self.measured.iter().find(|(known, _)| *known == renderer);
        known.map_or(UNKNOWN, |(_, rate)| *rate)
    }

    /// Sizes of pictures with one sample a pixel to show before the whole one of `size`, in this order.
    pub fn drafts(&self, renderer: Renderer, size: (u32, u32)) -> Vec<(u32, u32)> {
        let rate = self.rate(renderer);
        let all = f64::from(size.0) * f64::from(size.1);
        let sized = |time: Duration| {
            let wanted = (rate * time.as_secs_f64() / all).sqrt();
            let least = (LEAST_SIDE / f64::from(size.0.min(size.1))).min(1.0);
            let scale = wanted.max(least);
            let side = |pixels: u32| ((f64::from(pixels) * scale).round() as u32).max(1);
            (scale < NEARLY).then(|| (side(size.0), side(size.1)))
        };
        let first = sized(MOMENT);
        let second = sized(WHILE).filter(|second| {
            let is_larger = |(width, _)| f64::from(second.0) > 1.5 * f64::from(width);
            first.is_none_or(is_larger)
        });
        first.into_iter().chain(second).collect()
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn drafts_fit_into_their_moment() {
        let mut pace = Pace::default();
        let second = Duration::from_secs(1);
        pace.measured(Renderer::Path, 1e5, second);
        pace.measured(Renderer::Raytracer, 1e9, second);
        let drafts = pace.drafts(Renderer::Path, (960, 640));
        let samples: Vec<f64> = drafts
            .iter()
            .map(|(w, h)| f64::from(*w) * f64::from(*h))
            .collect();
        assert!((samples[0] - 3000.0).abs() < 200.0 && (samples[1] - 25000.0).abs() < 500.0);
        assert!(pace.drafts(Renderer::Raytracer, (960, 640)).is_empty());
        pace.measured(Renderer::Path, 1.0, second);
        assert_eq!(pace.drafts(Renderer::Path, (960, 640))[0].1, 24);
        assert!(pace.drafts(Renderer::Path, (10, 10)).is_empty());
    }
}
