//! Every model of `examples/course/` begins with the command that draws it, is free of errors and warnings, grows what it grew
//! before, and makes a picture of something.

#![allow(clippy::unwrap_used, reason = "a test fails by panicking")]

#[path = "support/opened.rs"]
mod opened;

use opened::{Drawn, Opened};
use rayon::prelude::*;
use std::fmt::Write;
use std::path::{Path, PathBuf};

const FOLDER: &str = "examples/course";

/// Models whose pictures take long to grow are tested younger.
const YOUNGER: [(&str, &str); 4] = [
    ("11-conditions-2.rgg", "8"),
    ("22-dispersal-2.rgg", "6"),
    ("35-poplar-prototype.rgg", "22"),
    ("37-cone-of-shadow.rgg", "5"),
];

/// The models, in order of their numbers.
fn models() -> Vec<PathBuf> {
    let entries = std::fs::read_dir(FOLDER).unwrap();
    let paths = entries.map(|entry| entry.unwrap().path());
    let mut models: Vec<_> = paths
        .filter(|path| path.extension().is_some_and(|e| e == "rgg"))
        .collect();
    models.sort();
    models
}

fn name(path: &Path) -> &str {
    path.file_name().unwrap().to_str().unwrap()
}

/// The steps that the command in a model's first lines asks for.
fn steps(path: &Path) -> String {
    let text = std::fs::read_to_string(path).unwrap();
    let start = format!("//     understory render {FOLDER}/{} --steps ", name(path));
    let command = text
        .lines()
        .take(4)
        .find_map(|line| line.strip_prefix(&start))
        .unwrap_or_else(|| panic!("{}: no line `{start}N -o …png`", name(path)));
    let (n, file) = command.split_once(" -o ").unwrap();
    assert!(file.ends_with(".png"), "{}: {file}", name(path));
    n.to_owned()
}

/// Share of the pixels that differ from the same picture without the plant, and the mean radiance.
fn looks(path: &Path, drawn: &Drawn) -> (f64, f64) {
    let luminances: Vec<f64> = drawn.image.pixels.iter().map(|p| p.luminance()).collect();
    let n = luminances.len() as f64;
    let mean = luminances.iter().sum::<f64>() / n;
    assert!(mean.is_finite(), "{}: {mean}", name(path));
    // The corner at the lower left shows the ground in all of them.
    let ground = luminances[luminances.len() - drawn.image.width as usize];
    let differs = |l: &&f64| (**l - ground).abs() > 0.25 * ground;
    let n_other = luminances.iter().filter(differs).count();
    (n_other as f64 / n, mean)
}

/// What is recorded of a model, and what its picture has to be.
fn facts(path: &Path) -> String {
    let younger = YOUNGER.iter().find(|(file, _)| *file == name(path));
    let steps = younger.map_or_else(|| steps(path), |(_, n)| (*n).to_owned());
    let flags = [
        ("steps", steps.as_str()),
        ("size", "48x32"),
        ("samples", "2"),
    ];
    let model = Opened::new(path, &flags);
    let growth = model.grow();
    let mut text = format!(
        "{}: {} modules after {steps} steps\n",
        name(path),
        growth.total()
    );
    for (module, n) in growth.counts() {
        let _ = write!(text, " {module} {n}");
    }
    if let Some(last) = model.printed().lines().last() {
        let _ = write!(text, "\n prints: {last}");
    }
    let drawn = model.draw();
    let size = drawn.bounds.max - drawn.bounds.min;
    let _ = writeln!(text, "\n size: {:.4} {:.4} {:.4} m", size.x, size.y, size.z);
    let (share, mean) = looks(path, &drawn);
    assert!(mean > 1.0, "{}: black, mean radiance {mean}", name(path));
    assert!(share > 0.02, "{}: empty, {share} of the pixels", name(path));
    text
}

#[test]
fn the_list_is_complete() {
    let models = models();
    let numbers: Vec<_> = models.iter().map(|path| &name(path)[..3]).collect();
    let expected: Vec<_> = (1..=37).map(|n| format!("{n:02}-")).collect();
    assert_eq!(numbers, expected);
    let table = std::fs::read_to_string(Path::new(FOLDER).join("README.md")).unwrap();
    for path in &models {
        let link = format!("]({})", name(path));
        assert_eq!(table.matches(&link).count(), 1, "{}", name(path));
        steps(path);
    }
}

#[test]
fn every_model_grows_and_can_be_seen() {
    let models = models();
    let facts: Vec<String> = models.par_iter().map(|path| facts(path)).collect();
    insta::assert_snapshot!(facts.concat());
}
