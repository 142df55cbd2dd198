//! Named sets of values for `--quality`.

use super::value::{Quality, Renderer};
use super::{Options, Origin};

/// Values of each quality, for each method, that differ from the defaults: points of the fronts that `cargo bench --bench corpus` has
/// measured over the scenes of `tests/corpus.csv`; `tests/presets.rs` demands it.
const BUILT_IN: [(Quality, Renderer, Values); 9] = [
    (
        Quality::Draft,
        Renderer::Path,
        &[("samples", "8"), ("max-depth", "6")],
    ),
    (
        Quality::Draft,
        Renderer::Photon,
        &[
            ("samples", "8"),
            ("global-photons", "100000"),
            ("caustic-photons", "100000"),
            ("final-gather", "0"),
        ],
    ),
    (
        Quality::Draft,
        Renderer::Radiosity,
        &[
            ("samples", "4"),
            ("subdivision-threshold", "0.3"),
            ("subdivision-depth", "1"),
            ("hemicube-pixels", "16"),
        ],
    ),
    (Quality::Draft, Renderer::Raytracer, &[("samples", "8")]),
    (
        Quality::Preview,
        Renderer::Photon,
        &[
            ("samples", "32"),
            ("global-photons", "1600000"),
            ("final-gather", "0"),
        ],
    ),
    (Quality::Preview, Renderer::Radiosity, &[("samples", "16")]),
    (Quality::Final, Renderer::Path, &[("samples", "512")]),
    (
        Quality::Final,
        Renderer::Photon,
        &[
            ("samples", "64"),
            ("global-photons", "6400000"),
            ("caustic-photons", "6400000"),
            ("final-gather", "0"),
        ],
    ),
    (
        Quality::Final,
        Renderer::Radiosity,
        &[
            ("samples", "32"),
            ("subdivision-threshold", "0.05"),
            ("subdivision-depth", "4"),
            ("hemicube-pixels", "48"),
        ],
    ),
];

/// Options and their values.
type Values = &'static [(&'static str, &'static str)];

/// What each `--quality` stands for: what is built in, for each method its own; or what a file says, such as `understory trade` writes.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Presets([Option<Vec<(String, String)>>; 3]);

/// All qualities, in the order of their numbers.
pub const QUALITIES: [Quality; 3] = [Quality::Draft, Quality::Preview, Quality::Final];

impl Presets {
    /// Reads presets in TOML: a table for each quality, with options of the command line. Qualities that it does not name stay as they are.
    ///
    /// # Errors
    /// What is wrong, for people: it is no TOML, names no quality, or an option has no such value.
    pub fn parse(text: &str) -> Result<Self, String> {
        let file: toml::Table = text.parse().map_err(|error: toml::de::Error| {
            let before = error.span().and_then(|span| text.get(..span.start));
            let line = before.map_or(1, |before| 1 + before.matches('\n').count());
            let why = error.message().replace('\n', "; ");
            format!("line {line} is not TOML: {why}")
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
            presets.0[quality as usize] = Some(values);
        }
        Ok(presets)
    }

    /// The values of a quality, key and text. Those of a file may name the method, and hold for any; those that are built in are for
    /// this method.
    #[must_use]
    pub fn of(&self, quality: Quality, renderer: Renderer) -> Vec<(&str, &str)> {
        if let Some(values) = &self.0[quality as usize] {
            let pairs = values.iter();
            return pairs
                .map(|(key, text)| (key.as_str(), text.as_str()))
                .collect();
        }
        let fitting = BUILT_IN
            .iter()
            .filter(|row| row.0 == quality && row.1 == renderer);
        fitting.flat_map(|row| row.2.iter().copied()).collect()
    }
}

impl Options {
    /// Applies the preset that `quality` names, below what the file and the flags set.
    ///
    /// Called once, after both have been read: each of them may have chosen the preset.
    pub fn apply_preset(&mut self) {
        let quality = self.quality.value;
        let presets = self.presets.clone();
        for (key, text) in presets.of(quality, self.renderer.value) {
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
            for renderer in ["path", "photon", "radiosity", "raytracer"] {
                let mut options = Options::default();
                options.set("quality", quality, Origin::Flag).unwrap();
                options.set("renderer", renderer, Origin::Flag).unwrap();
                options.set("max-depth", "2", Origin::Flag).unwrap();
                options.apply_preset();
                assert_eq!(options.max_depth.value, Some(2));
                let samples = options.samples.value.get();
                if renderer == "path" {
                    assert_eq!(samples, [8, 64, 512][options.quality.value as usize]);
                }
            }
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
        let of = |presets: &Presets| {
            let values = presets.of(Quality::Final, Renderer::Photon);
            values
                .iter()
                .map(|(key, _)| (*key).to_owned())
                .collect::<Vec<_>>()
        };
        assert_eq!(of(&options.presets), of(&Presets::default()));
        assert!(of(&options.presets).contains(&"global-photons".to_owned()));
        for (wrong, expected) in [
            ("\n\n[draft", "line 3 is not TOML"),
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
