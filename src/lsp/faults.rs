//! What is wrong with a model, as an editor shows it.

use super::workspace::{Analysis, FileView};
use crate::diag::{self, Label, Severity};
use lsp_types::{
    Diagnostic, DiagnosticRelatedInformation, DiagnosticSeverity, DiagnosticTag, Location,
    NumberOrString, PublishDiagnosticsParams, Range, Uri,
};
use std::str::FromStr;

/// The faults of one file; `None` if its address is none.
pub fn of_file(analysis: &Analysis, file: &FileView) -> Option<PublishDiagnosticsParams> {
    let is_here = |d: &&diag::Diagnostic| match &d.primary {
        Some(label) => label.span.file == file.id,
        None => analysis
            .files
            .first()
            .is_some_and(|first| first.id == file.id),
    };
    let found = analysis.found.sorted();
    Some(PublishDiagnosticsParams {
        uri: Uri::from_str(&file.uri).ok()?,
        diagnostics: found
            .into_iter()
            .filter(is_here)
            .map(|d| shown(analysis, file, d))
            .collect(),
        version: file.version,
    })
}

fn shown(analysis: &Analysis, file: &FileView, fault: &diag::Diagnostic) -> Diagnostic {
    let mut message = fault.message.clone();
    if let Some(label) = fault
        .primary
        .as_ref()
        .filter(|label| !label.text.is_empty())
    {
        message.push_str(&format!(": {}", label.text));
    }
    for hint in &fault.hints {
        message.push_str(&format!("\nhelp: {hint}"));
    }
    let severity = match fault.severity {
        Severity::Error => DiagnosticSeverity::ERROR,
        Severity::Warning => DiagnosticSeverity::WARNING,
    };
    let is_idle = ["unused-module", "unreachable", "dead-rule"].contains(&fault.slug);
    let related: Vec<_> = fault
        .secondary
        .iter()
        .filter_map(|label| related(analysis, label))
        .collect();
    Diagnostic {
        range: fault
            .primary
            .as_ref()
            .map_or_else(Range::default, |label| range(file, label)),
        severity: Some(severity),
        code: Some(NumberOrString::String(fault.slug.into())),
        source: Some("understory".into()),
        message,
        related_information: (!related.is_empty()).then_some(related),
        tags: is_idle.then(|| vec![DiagnosticTag::UNNECESSARY]),
        ..Diagnostic::default()
    }
}

/// The place of a label; a place between two characters becomes the character before it, so that it can be seen.
fn range(file: &FileView, label: &Label) -> Range {
    let (mut start, end) = (label.span.start as usize, label.span.end as usize);
    if start == end {
        let before = file
            .text
            .get(..start)
            .and_then(|text| text.chars().next_back());
        start -= before.filter(|c| *c != '\n').map_or(0, char::len_utf8);
    }
    file.lines.range(&file.text, start..end)
}

fn related(analysis: &Analysis, label: &Label) -> Option<DiagnosticRelatedInformation> {
    let file = analysis.file(label.span)?;
    let location = Location {
        uri: Uri::from_str(&file.uri).ok()?,
        range: range(file, label),
    };
    Some(DiagnosticRelatedInformation {
        location,
        message: label.text.clone(),
    })
}
