//! What is wrong with a model, as the page shows it: names of files without their folders, lines of text around the place.

use crate::diag::{Diagnostic, Diagnostics, Doing, Severity, SourceMap, Span};
use crate::pipeline::failure::Failure;
use serde::Serialize;

/// Characters of a line that are shown.
const LONGEST_LINE: usize = 200;
/// Problems that are shown.
const MOST: usize = 50;

/// Something wrong.
#[derive(Clone, Debug, Default, PartialEq, Serialize)]
pub struct Problem {
    /// Whether the model runs all the same.
    pub is_warning: bool,
    /// What is wrong.
    pub message: String,
    /// Where, if there is a place.
    pub place: Option<Place>,
    /// What to do about it, and what was being done.
    pub notes: Vec<String>,
}

/// A place in a file.
#[derive(Clone, Debug, Default, PartialEq, Serialize)]
pub struct Place {
    /// The number of the file among those of the model.
    pub file: u16,
    /// Its name, without folders.
    pub name: String,
    /// The line, from 1.
    pub line: usize,
    /// The column in characters, from 1.
    pub column: usize,
    /// The text of the line.
    pub text: String,
    /// The part of the text that is meant, in characters.
    pub from: usize,
    /// Where that part ends.
    pub to: usize,
    /// A remark on it; may be empty.
    pub label: String,
}

/// What a failure says of the model.
pub fn of_failure(failure: &Failure) -> Vec<Problem> {
    let text = match failure {
        Failure::Model { sources, found } => return of_diagnostics(sources, found),
        Failure::Usage(text) | Failure::World(text) => text.clone(),
        Failure::Invalid { failed, checks } => format!("{failed} of {checks} checks failed"),
        Failure::Stopped => return Vec::new(),
    };
    vec![Problem {
        message: without_folders(&text),
        ..Problem::default()
    }]
}

/// The problems in `found`, errors first.
pub fn of_diagnostics(sources: &SourceMap, found: &Diagnostics) -> Vec<Problem> {
    let mut all = found.sorted();
    all.sort_by_key(|diagnostic| diagnostic.severity);
    let all = all.into_iter().take(MOST);
    all.map(|diagnostic| problem(sources, diagnostic)).collect()
}

fn problem(sources: &SourceMap, diagnostic: &Diagnostic) -> Problem {
    let also = diagnostic.secondary.iter().map(|label| {
        let place = in_words(sources, label.span);
        format!("{place}: {}", label.text)
    });
    let trace = diagnostic.trace.iter().map(|doing| match doing.at {
        Some(span) => doing.text.replace(Doing::PLACE, &in_words(sources, span)),
        None => doing.text.clone(),
    });
    let hints = diagnostic.hints.iter().map(|hint| format!("help: {hint}"));
    let notes = also.chain(trace).chain(hints);
    let primary = diagnostic.primary.as_ref();
    Problem {
        is_warning: diagnostic.severity == Severity::Warning,
        message: without_folders(&diagnostic.message),
        place: primary.and_then(|label| place(sources, label.span, &label.text)),
        notes: notes.map(|note| without_folders(&note)).collect(),
    }
}

fn in_words(sources: &SourceMap, span: Span) -> String {
    let (line, _) = sources.line_column(span);
    let name = sources.file(span.file).map_or("", |file| &file.name);
    format!("{}:{line}", last_part(name))
}

fn place(sources: &SourceMap, span: Span, label: &str) -> Option<Place> {
    let file = sources.file(span.file)?;
    let (line, column) = sources.line_column(span);
    let text = file.text.lines().nth(line - 1).unwrap_or("");
    let length = text.chars().count();
    let from = (column - 1).min(length);
    let end = (span.end as usize).min(file.text.len());
    let meant = file.text.get(span.start as usize..end).unwrap_or("");
    let n_meant = meant
        .lines()
        .next()
        .unwrap_or("")
        .trim_end()
        .chars()
        .count();
    let to = (from + n_meant.max(1)).min(length.max(from + 1));
    // Of a line without end, the part around the place.
    let first = from
        .saturating_sub(LONGEST_LINE / 2)
        .min(length.saturating_sub(LONGEST_LINE));
    let shown: String = text.chars().skip(first).take(LONGEST_LINE).collect();
    Some(Place {
        file: span.file.0,
        name: last_part(&file.name).to_owned(),
        line,
        column,
        text: shown,
        from: from - first,
        to: (to - first).min(LONGEST_LINE),
        label: without_folders(label),
    })
}

/// The last part of a path.
pub fn last_part(path: &str) -> &str {
    path.rsplit(['/', '\\']).next().unwrap_or(path)
}

/// A message with only the last parts of the paths that it quotes: what folders a machine has is nobody's business.
fn without_folders(message: &str) -> String {
    let parts = message.split('`').enumerate();
    let shown = parts.map(|(i, part)| {
        // A quoted `a / b` is code, not a path.
        let is_path = i % 2 == 1
            && part.contains(['/', '\\'])
            && !part.contains("//")
            && !part.contains(" / ");
        if is_path { last_part(part) } else { part }
    });
    shown.collect::<Vec<_>>().join("`")
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn no_folder_is_told() {
        let message = "cannot read `/home/me/secret/plant.rgg`: no such file; `a / b` is code";
        assert_eq!(
            without_folders(message),
            "cannot read `plant.rgg`: no such file; `a / b` is code"
        );
    }

    #[test]
    fn the_place_is_that_of_the_span() {
        let mut sources = SourceMap::default();
        let id = sources.add("/home/me/plant.rgg", "one\n  twö three\n");
        let span = Span::new(id, 6, 10);
        let found = Diagnostic::error("x", span, "what")
            .label("here")
            .hint("do this");
        let problems = of_diagnostics(&sources, &found.into());
        let [problem] = problems.as_slice() else {
            panic!()
        };
        let place = problem.place.as_ref().unwrap();
        assert_eq!(
            (place.line, place.column, &*place.name),
            (2, 3, "plant.rgg")
        );
        assert_eq!((&*place.text, place.from, place.to), ("  twö three", 2, 5));
        assert_eq!(problem.notes, ["help: do this"]);
        let json = serde_json::to_string(&problems).unwrap();
        assert!(!json.contains("home"), "{json}");
    }

    #[test]
    fn of_a_line_without_end_the_place_is_shown() {
        let mut sources = SourceMap::default();
        let id = sources.add("p.rgg", "x".repeat(5000));
        let found = Diagnostic::error("x", Span::new(id, 4000, 4003), "what");
        let problems = of_diagnostics(&sources, &found.into());
        let place = problems[0].place.as_ref().unwrap();
        assert!(
            place.text.len() == LONGEST_LINE && place.from < place.to && place.to <= LONGEST_LINE
        );
        assert_eq!(place.column, 4001);
    }
}
