//! Runs every golden model through parser, checker and evaluator and compares what it prints with what GroIMP printed.

#![allow(clippy::unwrap_used, reason = "a helper that fails fails its test")]

use std::path::{Path, PathBuf};
use std::sync::{Arc, Mutex};

use understory::check::{SourceModel, check};
use understory::diag::{Diagnostic, Diagnostics, Severity, SourceMap};
use understory::growth::{Growth, GrowthOptions};
use understory::integrator::CancelToken;
use understory::interpret::DecodedPictures;
use understory::pipeline::audience::Audience;
use understory::pipeline::light_models::SceneLight;
use understory::syntax::parse;

/// Models whose numbers GroIMP found by chance: they are compared up to that.
const BY_CHANCE: &[&str] = &["50-light-directional", "52-light-area", "54-light-position"];

/// How far GroIMP's own numbers are from the truth where that is known: 1.051 of 1 in model 54.
const CHANCE: f64 = 0.055;

/// Models that GroIMP refuses and that may run here: generics, enums and string switches harm no model.
const LENIENT: &[&str] = &[
    "79-acc-list",
    "81-acc-diamond",
    "82-acc-string-switch",
    "98-acc-enum",
];

fn golden_folder() -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).join("tests/golden")
}

/// Who hears nothing.
struct Nobody;

impl Audience for Nobody {
    fn printed(&self, _: &str) {}
    fn warned(&self, _: &SourceMap, _: &Diagnostics) {}
    fn begins(&self, _: &'static str) {}
    fn progress(&self, _: u64, _: u64) {}
    fn ends(&self) {}
}

/// Whether two texts are the same but for numbers that chance has made a little different.
fn is_same_up_to_chance(found: &str, expected: &str) -> bool {
    let words = |text: &str| -> Vec<String> { text.split(' ').map(str::to_owned).collect() };
    let (found, expected) = (words(found), words(expected));
    let is_close = |(a, b): (&String, &String)| match (a.parse::<f64>(), b.parse::<f64>()) {
        // What is dark is dark; printed numbers are rounded to 0.001.
        (Ok(a), Ok(b)) => (a - b).abs() <= CHANCE * b.abs() + if b == 0.0 { 0.0 } else { 0.001 },
        _ => a == b,
    };
    found.len() == expected.len() && found.iter().zip(&expected).all(is_close)
}

/// What a model did.
struct Run {
    printed: String,
    errors: Vec<Diagnostic>,
    thrown: Option<Diagnostic>,
    sources: SourceMap,
}

fn run(text: &str) -> Run {
    let mut sources = SourceMap::default();
    let file = sources.add("model.rgg", text);
    let (ast, mut diagnostics) = parse(file, text);
    let (model, checked) = check(&[SourceModel {
        name: "model.rgg".into(),
        ast,
    }]);
    diagnostics.append(checked);
    let errors: Vec<Diagnostic> = diagnostics
        .sorted()
        .into_iter()
        .filter(|d| d.severity == Severity::Error)
        .cloned()
        .collect();
    if !errors.is_empty() {
        return Run {
            printed: String::new(),
            errors,
            thrown: None,
            sources,
        };
    }
    let printed = Arc::new(Mutex::new(String::new()));
    let sink = Arc::clone(&printed);
    let output = Box::new(move |text: &str| sink.lock().unwrap().push_str(text));
    let mut growth =
        Growth::new(&model, GrowthOptions::default(), output, Box::new(|| false)).unwrap();
    growth.set_light_solver(Box::new(SceneLight {
        pictures: DecodedPictures::default(),
        memory: 1 << 30,
        body_nodes: 1 << 20,
        cancel: CancelToken::default(),
        audience: Arc::new(Nobody),
    }));
    let thrown = growth.init().err().map(|fault| *fault);
    let printed = printed.lock().unwrap().clone();
    Run {
        printed,
        errors,
        thrown,
        sources,
    }
}

/// `None` if the model did as GroIMP did, else what is different.
fn difference(name: &str, text: &str, expected: &str) -> Option<String> {
    let run = run(text);
    if expected.starts_with("REFUSED") && !LENIENT.contains(&name) {
        let wanted = refused_line(expected);
        let lines: Vec<usize> = run
            .errors
            .iter()
            .filter_map(|d| Some(run.sources.line_column(d.primary.as_ref()?.span).0))
            .collect();
        return (!lines.contains(&wanted))
            .then(|| format!("should be refused at line {wanted}, errors at {lines:?}"));
    }
    if !run.errors.is_empty() && expected.starts_with("REFUSED") {
        return None;
    }
    if !run.errors.is_empty() {
        return Some(format!("refused: {:#?}", run.errors));
    }
    let (expected, exception) = match expected.split_once("EXCEPTION ") {
        Some((lines, exception)) => (lines, Some(exception.trim())),
        None => (expected, None),
    };
    if LENIENT.contains(&name) {
        return run.thrown.map(|d| d.message);
    }
    if BY_CHANCE.contains(&name) {
        let pairs = run.printed.lines().zip(expected.lines());
        let wrong: Vec<String> = pairs
            .filter(|(found, wanted)| !is_same_up_to_chance(found, wanted))
            .map(|(found, wanted)| format!("  - {wanted}\n  + {found}"))
            .collect();
        let n = (run.printed.lines().count(), expected.lines().count());
        let is_same = wrong.is_empty() && n.0 == n.1 && run.thrown.is_none();
        return (!is_same).then(|| format!("{n:?} lines\n{}\n{:?}", wrong.join("\n"), run.thrown));
    }
    if run.printed.trim_end() != expected.trim_end() {
        let thrown = run.thrown.map(|d| format!("{d:?}"));
        let pairs = run.printed.lines().map(Some).chain(std::iter::repeat(None));
        let wrong: Vec<String> = expected
            .trim_end()
            .lines()
            .zip(pairs)
            .filter(|(wanted, found)| Some(*wanted) != *found)
            .map(|(wanted, found)| format!("  - {wanted}\n  + {}", found.unwrap_or("(nothing)")))
            .take(12)
            .collect();
        return Some(format!("{}\nthrown: {thrown:?}", wrong.join("\n")));
    }
    match (exception, run.thrown) {
        (None, None) => None,
        (Some(wanted), Some(found)) => {
            // The wording of what was null is ours.
            let is_null = wanted
                .starts_with("java.lang.NullPointerException: Cannot read field \"v\" because");
            let is_same =
                found.message == wanted || is_null && found.message.starts_with(&wanted[..66]);
            (!is_same).then(|| format!("  - {wanted}\n  + {}", found.message))
        }
        (wanted, found) => Some(format!("exception wanted: {wanted:?}, found: {found:?}")),
    }
}

fn refused_line(expected: &str) -> usize {
    let place = expected
        .lines()
        .find_map(|line| line.strip_prefix("pfs:model.rgg "))
        .expect("a place");
    place.split(':').next().unwrap().parse().unwrap()
}

#[test]
fn golden_models_do_as_groimp_did() {
    let mut folders: Vec<PathBuf> = std::fs::read_dir(golden_folder())
        .unwrap()
        .map(|e| e.unwrap().path())
        .filter(|p| p.is_dir())
        .collect();
    folders.sort();
    assert!(folders.len() >= 60);
    let mut wrong = vec![];
    for folder in folders {
        let name = folder.file_name().unwrap().to_string_lossy().into_owned();
        let mut text = std::fs::read_to_string(folder.join("model.rgg")).unwrap();
        if BY_CHANCE.contains(&&*name) {
            // Photons that are spread evenly need no millions.
            text = text.replace("LightModel(4000000,", "LightModel(40000,");
            text = text.replace("LightModel(300000,", "LightModel(30000,");
        }
        let expected = std::fs::read_to_string(folder.join("expected.txt")).unwrap();
        let difference = difference(&name, &text, &expected);
        if let Some(difference) = difference {
            wrong.push(format!("{name}:\n{difference}"));
        }
    }
    assert!(
        wrong.is_empty(),
        "{} models differ\n{}",
        wrong.len(),
        wrong.join("\n\n")
    );
}
