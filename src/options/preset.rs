//! Named sets of values for `--quality`.

use super::value::Quality;
use super::{Options, Origin};

/// The values of a quality. `preview` is the defaults themselves.
const fn values(quality: Quality) -> &'static [(&'static str, &'static str)] {
    match quality {
        Quality::Draft => &[
            ("samples", "8"),
            ("max-depth", "6"),
            ("global-photons", "100000"),
            ("caustic-photons", "100000"),
            ("final-gather", "0"),
        ],
        Quality::Preview => &[],
        Quality::Final => &[
            ("samples", "512"),
            ("global-photons", "10000000"),
            ("final-gather", "1024"),
        ],
    }
}

impl Options {
    /// Applies the preset that `quality` names, below what the file and the flags set.
    ///
    /// Called once, after both have been read: each of them may have chosen the preset.
    pub fn apply_preset(&mut self) {
        let quality = self.quality.value;
        for (key, text) in values(quality) {
            self.set(key, text, Origin::Preset(quality.name()))
                .expect("invariant: presets name known options and values");
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_preset_applies_and_yields_to_flags() {
        for quality in ["draft", "preview", "final"] {
            let mut options = Options::default();
            options.set("quality", quality, Origin::Flag).unwrap();
            options.set("max-depth", "2", Origin::Flag).unwrap();
            options.apply_preset();
            assert_eq!(options.max_depth.value, Some(2));
            let samples = options.samples.value.get();
            assert_eq!(samples, [8, 64, 512][options.quality.value as usize]);
        }
    }
}
