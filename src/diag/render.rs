//! Diagnostics as text for people: what, where with an excerpt, why, and what to do about it.

use super::{Diagnostic, Diagnostics, Doing, Label, Severity, SourceMap, Span};
use ariadne::{Cache, Color, Config, IndexType, Report, ReportKind};
use std::fmt::Write as _;
use std::ops::Range;

/// Longest line, in bytes, that is shown whole; of a longer one only the surroundings of the place are shown.
const MAX_LINE: usize = 240;

/// Characters shown on each side of a place in a line that is too long.
const SURROUNDINGS: usize = 50;

/// All of `found`, sorted by place, as plain text.
pub fn render(sources: &SourceMap, found: &Diagnostics) -> String {
    Renderer::new(sources, false).all(found)
}

/// All of `found`, sorted by place, with the colors of a terminal (ANSI escapes).
pub fn render_colored(sources: &SourceMap, found: &Diagnostics) -> String {
    Renderer::new(sources, true).all(found)
}

/// The `n` errors and `m` warnings of `found` in words, such as `2 errors and 1 warning`.
pub fn summary(found: &Diagnostics) -> String {
    let count = |severity| {
        found
            .sorted()
            .iter()
            .filter(|d| d.severity == severity)
            .count()
    };
    let words = |n: usize, noun: &str| match n {
        0 => None,
        1 => Some(format!("1 {noun}")),
        _ => Some(format!("{n} {noun}s")),
    };
    let parts = [
        words(count(Severity::Error), "error"),
        words(count(Severity::Warning), "warning"),
    ];
    let parts: Vec<String> = parts.into_iter().flatten().collect();
    if parts.is_empty() {
        "no errors".to_owned()
    } else {
        parts.join(" and ")
    }
}

struct Renderer<'s> {
    sources: &'s SourceMap,
    config: Config,
}

impl<'s> Renderer<'s> {
    fn new(sources: &'s SourceMap, has_color: bool) -> Self {
        let config = Config::new()
            .with_index_type(IndexType::Byte)
            .with_color(has_color);
        Self { sources, config }
    }

    fn all(&self, found: &Diagnostics) -> String {
        let files = self.sources.files().iter();
        let mut cache =
            ariadne::sources(files.map(|file| (file.name.to_string(), file.text.to_string())));
        let sorted = found.sorted();
        sorted
            .iter()
            .map(|diagnostic| self.one(diagnostic, &mut cache))
            .collect()
    }

    fn one(&self, diagnostic: &Diagnostic, cache: &mut impl Cache<String>) -> String {
        let Some(primary) = &diagnostic.primary else {
            return self.without_excerpt(diagnostic, None);
        };
        if self.place(primary.span).is_none()
            || self
                .labels(diagnostic)
                .any(|label| self.is_on_long_line(label.span))
        {
            return self.without_excerpt(diagnostic, Some(primary));
        }
        let mut text = Vec::new();
        let report = self.report(diagnostic, primary);
        match report.write(cache, &mut text) {
            Ok(()) => String::from_utf8_lossy(&text).into_owned(),
            Err(_) => self.without_excerpt(diagnostic, Some(primary)),
        }
    }

    fn report(
        &self,
        diagnostic: &Diagnostic,
        primary: &Label,
    ) -> Report<'static, (String, Range<usize>)> {
        let (kind, color) = match diagnostic.severity {
            Severity::Error => (ReportKind::Error, Color::Red),
            Severity::Warning => (ReportKind::Warning, Color::Yellow),
        };
        let place = |span| self.place(span).unwrap_or_default();
        let mut labels: Vec<&Label> = self
            .labels(diagnostic)
            .filter(|label| self.place(label.span).is_some())
            .collect();
        labels.sort_by_key(|label| (label.span.file != primary.span.file, label.span));
        let labels = labels.into_iter().map(|label| {
            let is_primary = std::ptr::eq(label, primary);
            let color = if is_primary { color } else { Color::Cyan };
            let shown = ariadne::Label::new(place(label.span)).with_color(color);
            match label.text.as_str() {
                // Without any words nothing would be underlined.
                "" if is_primary => shown.with_message("here"),
                "" => shown,
                text => shown.with_message(text),
            }
        });
        let mut report = Report::build(kind, place(primary.span))
            .with_config(self.config)
            .with_message(&diagnostic.message)
            .with_labels(labels);
        // One note: each line of it goes on where the one above ends.
        let trace = self.trace(diagnostic);
        report.with_notes((!trace.is_empty()).then(|| trace.join("\n")));
        report.with_helps(&diagnostic.hints);
        report.finish()
    }

    /// What was being done, with places in words.
    fn trace(&self, diagnostic: &Diagnostic) -> Vec<String> {
        let line = |doing: &Doing| match doing.at {
            Some(span) => doing.text.replace(Doing::PLACE, &self.in_words(span)),
            None => doing.text.clone(),
        };
        diagnostic.trace.iter().map(line).collect()
    }

    /// `line 40`, or `organs.rgg:40` in a model of several files.
    fn in_words(&self, span: Span) -> String {
        let (line, _) = self.sources.line_column(span);
        match self.sources.file(span.file) {
            Some(file) if self.sources.files().len() > 1 => {
                let name = file.name.rsplit(['/', '\\']).next().unwrap_or_default();
                format!("{name}:{line}")
            }
            _ => format!("line {line}"),
        }
    }

    fn labels<'d>(&self, diagnostic: &'d Diagnostic) -> impl Iterator<Item = &'d Label> {
        diagnostic.primary.iter().chain(&diagnostic.secondary)
    }

    /// The file's name and the bytes of a span, moved to whole characters inside of the text and off line ends.
    fn place(&self, span: Span) -> Option<(String, Range<usize>)> {
        let file = self.sources.file(span.file)?;
        let floor = |at: u32| {
            let mut at = (at as usize).min(file.text.len());
            while !file.text.is_char_boundary(at) {
                at -= 1;
            }
            at
        };
        let start = floor(span.start);
        let end = start
            + file.text[start..floor(span.end).max(start)]
                .trim_end()
                .len();
        Some((file.name.to_string(), start..end))
    }

    /// The line that holds byte `at`, without its end, and where it begins.
    fn line(text: &str, at: usize) -> (usize, &str) {
        let start = text[..at].rfind('\n').map_or(0, |end| end + 1);
        let end = text[at..].find('\n').map_or(text.len(), |len| at + len);
        (start, text[start..end].trim_end_matches('\r'))
    }

    fn is_on_long_line(&self, span: Span) -> bool {
        let (Some(file), Some((_, place))) = (self.sources.file(span.file), self.place(span))
        else {
            return false;
        };
        Self::line(&file.text, place.start).1.len() > MAX_LINE
            || Self::line(&file.text, place.end).1.len() > MAX_LINE
    }

    /// Message, place and hints in lines of their own.
    fn without_excerpt(&self, diagnostic: &Diagnostic, primary: Option<&Label>) -> String {
        let word = match diagnostic.severity {
            Severity::Error => "Error",
            Severity::Warning => "Warning",
        };
        let mut text = format!("{word}: {}\n", diagnostic.message);
        for label in primary.into_iter().chain(&diagnostic.secondary) {
            self.surroundings(label, &mut text);
        }
        for (word, lines) in [
            ("Note", &self.trace(diagnostic)),
            ("Help", &diagnostic.hints),
        ] {
            for line in lines {
                let _ = writeln!(text, "  {word}: {line}"); // Writing to a string cannot fail.
            }
        }
        text
    }

    fn surroundings(&self, label: &Label, text: &mut String) {
        let (Some(file), Some((name, place))) =
            (self.sources.file(label.span.file), self.place(label.span))
        else {
            return;
        };
        let (line, column) = self.sources.line_column(label.span);
        let (start, content) = Self::line(&file.text, place.start);
        let (before, rest) = content.split_at((place.start - start).min(content.len()));
        let left: Vec<char> = before.chars().rev().take(SURROUNDINGS).collect();
        let left: String = left.into_iter().rev().collect();
        let right: String = rest.chars().take(SURROUNDINGS).collect();
        let marked = file.text[place]
            .chars()
            .count()
            .clamp(1, right.chars().count().max(1));
        let clean = |s: &str| s.replace(|c: char| c.is_control(), " ");
        let dots = |is_cut| if is_cut { "…" } else { "" };
        let (head, tail) = (
            dots(left.len() < before.len()),
            dots(right.len() < rest.len()),
        );
        let indent = " ".repeat(left.chars().count() + head.chars().count());
        let _ = writeln!(
            text,
            "   ╭─[ {name}:{line}:{column} ]\n   │ {head}{}{}{tail}\n   │ {indent}{} {}",
            clean(&left),
            clean(&right),
            "^".repeat(marked),
            label.text
        ); // Writing to a string cannot fail.
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn sources(text: &str) -> SourceMap {
        let mut sources = SourceMap::default();
        sources.add("plant.rgg", text);
        sources
    }

    fn span(text: &str, part: &str) -> Span {
        let start = text.find(part).unwrap();
        Span::new(super::super::FileId(0), start, start + part.len())
    }

    #[test]
    fn a_report_shows_place_labels_trace_and_hints() {
        let text = "module Größe(int ä);\nvoid grow() [\n\tGröße(x) ==> Intenode Größe(x);\n]\n";
        let diagnostic = Diagnostic::error(
            "unknown-module",
            span(text, "Intenode"),
            "unknown module `Intenode`",
        )
        .label("no such module")
        .also(span(text, "Größe(int"), "the only module")
        .during_at(
            "while applying the rule at {place} to Größe(2)",
            Some(span(text, "Größe(x)")),
        )
        .during("in method `grow`")
        .during("in step 7")
        .hint("did you mean `Internode`?");
        insta::assert_snapshot!(render(&sources(text), &diagnostic.into()));
    }

    #[test]
    fn colors_are_ansi_escapes() {
        let text = "x";
        let found = Diagnostics::from(Diagnostic::warning("w", span(text, "x"), "odd"));
        assert!(render_colored(&sources(text), &found).contains("\u{1b}["));
        assert!(!render(&sources(text), &found).contains('\u{1b}'));
    }

    #[test]
    fn long_lines_are_cut() {
        let text = format!("{}@{}\n", "ab ".repeat(100_000), " cd".repeat(100_000));
        let found = Diagnostics::from(
            Diagnostic::error("e", span(&text, "@"), "odd")
                .label("this")
                .hint("remove it"),
        );
        let shown = render(&sources(&text), &found);
        assert!(
            shown.contains("plant.rgg:1:300001") && shown.contains("^ this"),
            "{shown}"
        );
        assert!(shown.len() < 500, "{}", shown.len());
    }

    #[test]
    fn no_span_breaks_a_report() {
        let text = "äöü\r\n€\u{2028}x\n";
        for start in 0..=text.len() + 2 {
            for end in start.saturating_sub(2)..=text.len() + 2 {
                for file in 0..2 {
                    let span = Span {
                        file: super::super::FileId(file),
                        start: start as u32,
                        end: end as u32,
                    };
                    let found =
                        Diagnostics::from(Diagnostic::error("e", span, "odd").label("here"));
                    assert!(render(&sources(text), &found).contains("odd"));
                }
            }
        }
        let found = Diagnostics::from(Diagnostic {
            primary: None,
            ..Diagnostic::error("e", Span::default(), "odd")
        });
        assert_eq!(render(&sources(""), &found), "Error: odd\n");
    }

    #[test]
    fn a_summary_counts() {
        let mut found = Diagnostics::default();
        assert_eq!(summary(&found), "no errors");
        found.push(Diagnostic::error("e", Span::default(), "a"));
        found.push(Diagnostic::error("e", Span::default(), "b"));
        found.push(Diagnostic::warning("e", Span::default(), "c"));
        assert_eq!(summary(&found), "2 errors and 1 warning");
    }
}
