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

/// What each `--quality` stands for: the values here, or those of a file such as `understory trade` writes.
#[derive(Clone, Debug, PartialEq)]
pub struct Presets([Vec<(String, String)>; 3]);

impl Default for Presets {
    fn default() -> Self {
        Self(QUALITIES.map(|quality| {
            let owned = |&(key, text): &(&str, &str)| (key.to_owned(), text.to_owned());
            values(quality).iter().map(owned).collect()
        }))
    }
}

/// All qualities, in the order of their numbers.
const QUALITIES: [Quality; 3] = [Quality::Draft, Quality::Preview, Quality::Final];

impl Presets {
    /// Reads presets in TOML: a table for each quality, with options of the command line. Qualities that it does not name stay as they are.
    ///
    /// # Errors
    /// What is wrong, for people: it is no TOML, names no quality, or an option has no such value.
    pub fn parse(text: &str) -> Result<Self, String> {
        let file: toml::Table = text.parse().map_err(|error: toml::de::Error| {
            format!("it is not TOML: {}", error.message().replace('\n', "; "))
        })?;
        let mut presets = Self::default();
        for (name, table) in &file {
            let quality = QUALITIES.into_iter().find(|quality| quality.name() == name);
            let (Some(quality), Some(table)) = (quality, table.as_table()) else {
                return Err(format!(
                    "`{name}` is no preset: there are the tables `[draft]`, `[preview]` and `[final]`"
                ));
            };
            let mut tried = Options::default();
            let mut values = Vec::new();
            for (key, value) in table {
                let text = match value {
                    toml::Value::String(text) => text.clone(),
                    other => other.to_string(),
                };
                tried
                    .set(key, &text, Origin::Preset(quality.name()))
                    .map_err(|error| format!("in `[{name}]`: {error}"))?;
                values.push((key.clone(), text));
            }
            presets.0[quality as usize] = values;
        }
        Ok(presets)
    }

    /// The values of a quality, key and text.
    #[must_use]
    pub fn of(&self, quality: Quality) -> &[(String, String)] {
        &self.0[quality as usize]
    }
}

impl Options {
    /// Applies the preset that `quality` names, below what the file and the flags set.
    ///
    /// Called once, after both have been read: each of them may have chosen the preset.
    pub fn apply_preset(&mut self) {
        let quality = self.quality.value;
        for (key, text) in self.presets.clone().of(quality) {
            self.set(key, text, Origin::Preset(quality.name()))
                .expect("invariant: presets hold known options and values");
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

    #[test]
    fn presets_of_a_file_replace_those_that_it_names() {
        let text = "[draft]\nrenderer = \"photon\"\nsamples = 4\nphoton-area = 0.25";
        let mut options = Options {
            presets: Presets::parse(text).unwrap(),
            ..Options::default()
        };
        options.set("quality", "draft", Origin::Flag).unwrap();
        options.apply_preset();
        assert_eq!(options.samples.value.get(), 4);
        assert_eq!(options.samples.origin, Origin::Preset("draft"));
        assert_eq!(options.max_depth.value, None);
        let kept = options.presets.of(Quality::Final);
        assert_eq!(kept, Presets::default().of(Quality::Final));
        for (wrong, expected) in [
            ("[draft", "not TOML"),
            ("[fast]\nsamples = 1", "`fast` is no preset"),
            ("draft = 3", "`draft` is no preset"),
            ("[draft]\nsamples = 0", "in `[draft]`"),
            ("[final]\nsmaples = 3", "`samples`"),
        ] {
            let error = Presets::parse(wrong).unwrap_err();
            assert!(error.contains(expected), "{wrong}: {error}");
        }
    }
}
