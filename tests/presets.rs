//! `--quality draft`, `preview` and `final` are points of measured fronts: over the scenes of `corpus.csv`, no other setting of the same
//! method is faster and more exact on average.
//!
//! The table is what `cargo bench --bench corpus` measured on one thread in twelve minutes and more a scene; each preset in at least six scenes.

#![allow(clippy::unwrap_used, reason = "a test may panic")]

use std::collections::{BTreeMap, BTreeSet};
use understory::options::preset::QUALITIES;
use understory::options::value::Renderer;
use understory::options::{Options, Origin, Presets};

/// Measured on a noisy machine: what is less than this much faster and more exact is not better.
const GAIN: f64 = 0.95;
/// Scenes in which two settings must both have been measured to be compared.
const FEWEST: usize = 6;

/// Seconds and error of each scene.
type Curve = BTreeMap<String, (f64, f64)>;

/// What was measured of each setting, written as its options that are not those of the default.
fn table() -> BTreeMap<String, Curve> {
    let mut found: BTreeMap<String, Curve> = BTreeMap::new();
    for line in include_str!("corpus.csv").lines().skip(1) {
        // The name of the method may hold a comma.
        let (scene, rest) = line.split_once(',').unwrap();
        let rest = rest.rsplit_once('"').unwrap().1;
        let cells: Vec<&str> = rest.trim_start_matches(',').splitn(3, ',').collect();
        let [seconds, error] = [cells[0], cells[1]].map(|cell| cell.parse::<f64>().unwrap());
        let pairs = cells[2]
            .split(' ')
            .map(|pair| pair.split_once('=').unwrap());
        let key = canonical(pairs);
        found
            .entry(key)
            .or_default()
            .insert(scene.to_owned(), (seconds, error));
    }
    found
}

/// Equal for equal settings, whichever of them are written out. Photons to mirrors and glass are those there are: scenes without any get
/// none.
fn canonical<'a>(pairs: impl Iterator<Item = (&'a str, &'a str)>) -> String {
    let mut options = Options::default();
    let mut renderer = "path";
    for (key, text) in pairs {
        if key == "renderer" {
            renderer = text;
        }
        if key != "caustic-photons" {
            options.set(key, text, Origin::Flag).unwrap();
        }
    }
    let entries = options.entries();
    let told = entries
        .iter()
        .filter(|entry| entry.canonical() != default(entry.row.key));
    let told = told
        .filter(|entry| entry.row.key != "renderer")
        .map(|entry| format!("{}={}", entry.row.key, entry.canonical()));
    format!("{renderer} {}", told.collect::<Vec<_>>().join(" "))
}

fn default(key: &str) -> String {
    Options::default().entry_of(key).unwrap().canonical()
}

/// Geometric means of how much slower and how much less exact the other one is, over the scenes of both.
fn ratios(found: &BTreeMap<String, Curve>, one: &str, other: &str) -> Option<[f64; 2]> {
    let both: Vec<[f64; 2]> = found[one]
        .iter()
        .filter_map(|(scene, (seconds, error))| {
            let (other_seconds, other_error) = found[other].get(scene)?;
            Some([other_seconds / seconds, other_error / error])
        })
        .collect();
    let mean =
        |i: usize| (both.iter().map(|pair| pair[i].ln()).sum::<f64>() / both.len() as f64).exp();
    (both.len() >= FEWEST).then(|| [mean(0), mean(1)])
}

#[test]
fn the_corpus_is_whole() {
    let found = table();
    let scenes: BTreeSet<&String> = found.values().flat_map(Curve::keys).collect();
    assert!(scenes.len() >= 12, "{scenes:?}");
    for scene in ["spruce", "crop", "forest"] {
        assert!(scenes.contains(&scene.to_owned()));
    }
    assert_eq!(
        scenes
            .iter()
            .filter(|scene| scene.starts_with("study/"))
            .count(),
        9
    );
}

#[test]
fn no_setting_beats_a_preset() {
    let found = table();
    for renderer in [Renderer::Path, Renderer::Photon, Renderer::Radiosity] {
        for quality in QUALITIES {
            let presets = Presets::default();
            let values = presets.of(quality, renderer);
            let pairs = values.into_iter().chain([("renderer", renderer.name())]);
            let key = canonical(pairs);
            let what = format!("{} of {}", quality.name(), renderer.name());
            let preset = found.get(&key).unwrap_or_else(|| panic!("{what}: {key}"));
            assert!(preset.len() >= FEWEST, "{what} ({key}) was hardly measured");
            for other in found.keys() {
                if other.split(' ').next() != Some(renderer.name()) {
                    continue;
                }
                if let Some([seconds, error]) = ratios(&found, &key, other) {
                    assert!(
                        seconds > GAIN || error > GAIN,
                        "{what}: {other} takes {seconds:.2} of its time and has {error:.2} of its error"
                    );
                }
            }
        }
    }
}
