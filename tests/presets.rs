//! `--quality draft`, `preview` and `final` are points of measured fronts: over the scenes of `corpus.csv`, no other setting of the same
//! method is both faster and more exact.
//!
//! The table is what `cargo bench --bench corpus` measured in four minutes a scene on one thread. `draft` and `preview` were measured in at
//! least six scenes. Settings that were too dear for so short a time in most of them, those of `final`, are held to something weaker: they
//! are further rungs of the ladders whose first ones the table has.

#![allow(clippy::unwrap_used, reason = "a test may panic")]

use std::collections::{BTreeMap, BTreeSet};
use understory::options::preset::QUALITIES;
use understory::options::value::{Quality, Renderer};
use understory::options::{Options, Origin, Presets};
use understory::trade::ladder::{Needs, families};

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
fn ratios(one: &Curve, other: &Curve) -> Option<[f64; 2]> {
    let both: Vec<[f64; 2]> = one
        .iter()
        .filter_map(|(scene, (seconds, error))| {
            let (other_seconds, other_error) = other.get(scene)?;
            Some([(other_seconds / seconds).ln(), (other_error / error).ln()])
        })
        .collect();
    let mean = |i: usize| (both.iter().map(|pair| pair[i]).sum::<f64>() / both.len() as f64).exp();
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

/// Settings of the ladders that `trade` climbs, and of the path tracer any number of samples: its error falls with them and its time
/// grows.
fn is_on_a_ladder(key: &str, renderer: Renderer) -> bool {
    let needs = Needs {
        has_specular: true,
        radius: 1.0,
    };
    let ladders = families(needs, Some(renderer));
    let ladders = ladders.iter().filter(|family| family.is_contender);
    let mut rungs = ladders.flat_map(|family| &family.rungs).map(|rung| {
        let pairs = rung
            .settings
            .iter()
            .map(|(key, text)| (*key, text.as_str()));
        canonical(pairs.chain([("renderer", renderer.name())]))
    });
    rungs.any(|rung| rung == key)
        || (renderer == Renderer::Path
            && key.starts_with("path samples=")
            && key.matches('=').count() == 1)
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
            let empty = Curve::new();
            let preset = found.get(&key).unwrap_or(&empty);
            if preset.len() < FEWEST {
                assert!(
                    quality == Quality::Final,
                    "{what} ({key}) was hardly measured"
                );
                let is_default = key == canonical([("renderer", renderer.name())].into_iter());
                assert!(
                    is_default || is_on_a_ladder(&key, renderer),
                    "{what}: {key}"
                );
                continue;
            }
            for (other, curve) in &found {
                if other.split(' ').next() != Some(renderer.name()) {
                    continue;
                }
                if let Some([seconds, error]) = ratios(preset, curve) {
                    assert!(
                        seconds > GAIN || error > GAIN,
                        "{what}: {other} takes {seconds:.2} of its time and has {error:.2} of its error"
                    );
                }
            }
        }
    }
}
