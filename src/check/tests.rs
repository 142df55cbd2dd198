//! Checks of whole models: the golden ones, and small ones for what is refused.

use std::path::Path;

use super::{SourceModel, check};
use crate::diag::{Diagnostics, Severity, SourceMap};
use crate::syntax;

/// Checks one text; gives the model and `line:slug message` of each error.
pub(super) fn check_text(text: &str) -> (super::model::Model, Vec<String>) {
    check_texts(&[("model", text)])
}

/// Checks several files together.
pub(super) fn check_texts(texts: &[(&str, &str)]) -> (super::model::Model, Vec<String>) {
    let mut map = SourceMap::default();
    let mut found = Diagnostics::default();
    let mut files = vec![];
    for (name, text) in texts {
        let id = map.add(*name, *text);
        let (ast, diagnostics) = syntax::parse(id, text);
        found.append(diagnostics);
        files.push(SourceModel {
            name: (*name).into(),
            ast,
        });
    }
    let (model, diagnostics) = check(&files);
    found.append(diagnostics);
    let errors = found
        .sorted()
        .into_iter()
        .filter(|d| d.severity == Severity::Error);
    let line =
        |d: &&crate::diag::Diagnostic| d.primary.as_ref().map_or(0, |p| map.line_column(p.span).0);
    let shown = errors.map(|d| {
        let hints: String = d.hints.iter().map(|hint| format!(" | {hint}")).collect();
        format!("{}: {}: {}{hints}", line(&d), d.slug, d.message)
    });
    (model, shown.collect())
}

/// The models of `tests/golden`: name, text, and the line of the first fault where GroIMP refuses them.
fn golden_models() -> Vec<(String, String, Option<usize>)> {
    let folder = Path::new(env!("CARGO_MANIFEST_DIR")).join("tests/golden");
    let mut models = vec![];
    for entry in std::fs::read_dir(folder).unwrap() {
        let path = entry.unwrap().path();
        let Ok(text) = std::fs::read_to_string(path.join("model.rgg")) else {
            continue;
        };
        let expected = std::fs::read_to_string(path.join("expected.txt")).unwrap();
        let line = expected.strip_prefix("REFUSED").map(|rest| {
            let place = rest.split("model.rgg ").nth(1).unwrap();
            place.split(':').next().unwrap().parse().unwrap()
        });
        models.push((
            path.file_name().unwrap().to_string_lossy().into_owned(),
            text,
            line,
        ));
    }
    models.sort();
    models
}

/// Refused by GroIMP, accepted here because that harms no model.
const LENIENT: &[&str] = &["81-acc-diamond", "82-acc-string-switch"];
/// Accepted by GroIMP, not supported here.
const UNSUPPORTED: &[&str] = &["84-acc-closure"];

#[test]
fn golden_models_are_accepted_and_refused_as_in_groimp() {
    let (mut n_accepted, mut n_refused) = (0, 0);
    for (name, text, refused_at) in golden_models() {
        let (_, errors) = check_text(&text);
        let is_refused = refused_at.is_some() && !LENIENT.contains(&name.as_str())
            || UNSUPPORTED.contains(&name.as_str());
        if is_refused {
            n_refused += 1;
            let first = errors
                .first()
                .unwrap_or_else(|| panic!("{name} is accepted"));
            let line = refused_at.map_or(String::new(), |line| format!("{line}: "));
            assert!(first.starts_with(&line), "{name}: {errors:#?}");
        } else {
            n_accepted += 1;
            assert!(errors.is_empty(), "{name}: {errors:#?}");
        }
    }
    assert!(
        n_accepted >= 50 && n_refused >= 12,
        "{n_accepted} {n_refused}"
    );
}
