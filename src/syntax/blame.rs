//! What is wrong with a text that does not follow the grammar: one diagnostic for each broken part.

use super::ast::File;
use super::brackets::Brackets;
use super::cut::{Cutter, Tokens};
use super::excerpt::Excerpt;
use super::explain::{Explanation, explain};
use super::parse::{Reach, Reader, Unit, reach, reads};
use super::scan::{MAX_NESTING, Problem, ProblemKind, Scan};
use crate::diag::{Diagnostic, Diagnostics, FileId, Span};

/// Most diagnostics for one file; what follows is mostly noise.
const MAX_DIAGNOSTICS: usize = 20;

/// The diagnostic for a text that should not even be tried: not a text, or nested absurdly deep.
pub(super) fn unreadable(file: FileId, scan: &Scan) -> Option<Diagnostics> {
    let is_hopeless = |p: &&Problem| matches!(p.kind, ProblemKind::Binary | ProblemKind::TooDeep);
    let problem = scan.problems.iter().find(is_hopeless)?;
    let span = Span::new(file, problem.start, problem.end);
    let diagnostic = if problem.kind == ProblemKind::Binary {
        Diagnostic::error("not-a-text", span, "this file is not a text")
            .hint("save the model as plain text in UTF-8")
    } else {
        Diagnostic::error(
            "nested-too-deeply",
            span,
            format!("more than {MAX_NESTING} levels of nesting"),
        )
        .label("too deep here")
        .hint("put inner parts into methods of their own")
    };
    Some(diagnostic.into())
}

/// A warning for a file in which nothing stands.
pub(super) fn empty(file: FileId, tree: &File, text: &str) -> Diagnostics {
    if !tree.items.is_empty() || !tree.imports.is_empty() {
        return Diagnostics::default();
    }
    let span = Span::new(file, 0, text.len().min(1));
    Diagnostic::warning("empty-file", span, "this file declares nothing")
        .hint("the smallest model is `protected void init() [ Axiom ==> F(1); ]`")
        .into()
}

/// Reads the declarations that can be read and says what is wrong with the others.
pub(super) fn blame(file: FileId, text: &str, scan: &Scan) -> (File, Diagnostics) {
    let brackets = Brackets::new(text, scan);
    let mut faulty: Vec<usize> = scan.problems.iter().map(|problem| problem.start).collect();
    let mut found = Vec::new();
    for problem in &scan.problems {
        found.push(problem_diagnostic(file, text, problem));
    }
    // An unclosed string swallows brackets, so faults of brackets tell little then.
    let swallows = |p: &Problem| p.kind != ProblemKind::Foreign;
    if !scan.problems.iter().any(swallows) {
        found.extend(
            brackets
                .faults
                .iter()
                .map(|fault| fault.diagnostic(file, text, scan)),
        );
    }
    let places = brackets.faults.iter().flat_map(|fault| fault.tokens());
    faulty.extend(places.map(|token| scan.tokens[token].start));
    faulty.sort_unstable();
    let mut blamer = Blamer {
        file,
        cutter: Cutter {
            text,
            scan,
            brackets,
        },
        faulty,
        found,
        // Parts that fail are read again inside; the budget keeps that linear.
        budget: 16 * text.len() + 1_000_000,
    };
    let tree = blamer.file(scan);
    (tree.0, blamer.finish(tree.1))
}

fn problem_diagnostic(file: FileId, text: &str, problem: &Problem) -> Diagnostic {
    let span = Span::new(file, problem.start, problem.end);
    match problem.kind {
        ProblemKind::OpenString => Diagnostic::error(
            "unclosed-string",
            span,
            "this string is not closed on its line",
        )
        .label("its closing `\"` is missing"),
        ProblemKind::OpenChar => {
            Diagnostic::error("unclosed-char", span, "this `'` is not closed on its line")
                .hint("a `char` is one character in single quotes; a text stands in double quotes")
        }
        ProblemKind::OpenComment => {
            Diagnostic::error("unclosed-comment", span, "this comment is never closed")
                .label("its `*/` is missing")
        }
        ProblemKind::Foreign | ProblemKind::Binary | ProblemKind::TooDeep => {
            foreign(span, &text[problem.start..problem.end])
        }
    }
}

fn foreign(span: Span, text: &str) -> Diagnostic {
    let shown: String = text.chars().take(10).collect();
    let diagnostic = Diagnostic::error(
        "foreign-character",
        span,
        format!("`{}` has no meaning here", shown.escape_debug()),
    );
    let instead = match text.chars().next() {
        Some('“' | '”' | '„' | '«' | '»') => "write straight quotes: `\"`",
        Some('‘' | '’' | '‚') => "write straight quotes: `'`",
        Some('–' | '—' | '−') => "write a plain minus: `-`",
        Some('×' | '·') => "write `*`",
        Some('÷') => "write `/`",
        Some('≤') => "write `<=`",
        Some('≥') => "write `>=`",
        Some('≠') => "write `!=`",
        Some('→' | '⇒' | '⟶') => "write `==>`",
        Some('…') => "write three dots",
        Some('²' | '³') => "write `** 2` or `** 3`",
        Some('#') => "remove it; blocks of scales, `{# … #}`, are not supported",
        _ => "remove it",
    };
    diagnostic.hint(instead)
}

struct Blamer<'t> {
    file: FileId,
    cutter: Cutter<'t>,
    /// Bytes with problems and faults of brackets, sorted; what holds one is not read.
    faulty: Vec<usize>,
    found: Vec<Diagnostic>,
    budget: usize,
}

impl Blamer<'_> {
    fn file(&mut self, scan: &Scan) -> (File, Diagnostics) {
        let mut tree = File::default();
        let reader = Reader::new(self.file, scan);
        for item in self.cutter.parts(Unit::Item, &(0..scan.tokens.len())) {
            let bytes = self.cutter.bytes(&item);
            let reads = !self.is_faulty(bytes.start, bytes.end)
                && reader.item_at(bytes.start, &scan.plain[bytes], &mut tree);
            if !reads && !self.is_full() {
                self.unit(Unit::Item, &item);
            }
        }
        (tree, reader.into_diagnostics())
    }

    fn finish(mut self, mut diagnostics: Diagnostics) -> Diagnostics {
        if self.found.is_empty() {
            // The parts are fine and the whole is not: say at least that.
            let span = Span::new(self.file, 0, self.cutter.text.len().min(1));
            self.found.push(Diagnostic::error(
                "syntax",
                span,
                "this file does not follow the grammar",
            ));
        }
        self.found
            .sort_by_key(|diagnostic| diagnostic.primary.as_ref().map(|label| label.span));
        self.found.truncate(MAX_DIAGNOSTICS);
        for diagnostic in self.found {
            diagnostics.push(diagnostic);
        }
        diagnostics
    }

    fn is_full(&self) -> bool {
        self.found.len() >= MAX_DIAGNOSTICS
    }

    fn is_faulty(&self, start: usize, end: usize) -> bool {
        let at = self.faulty.partition_point(|&byte| byte < start);
        self.faulty.get(at).is_some_and(|&byte| byte < end)
    }

    /// Adds a diagnostic, unless its line holds a problem of its own, of which it would only be a consequence.
    fn add(&mut self, diagnostic: Diagnostic) {
        let text = self.cutter.text;
        let at = diagnostic
            .primary
            .as_ref()
            .map_or(0, |label| label.span.start as usize);
        let start = text[..at].rfind('\n').map_or(0, |end| end + 1);
        let end = text[at..].find('\n').map_or(text.len(), |len| at + len);
        let is_problem = |p: &Problem| (start..end).contains(&p.start);
        if !self.cutter.scan.problems.iter().any(is_problem) {
            self.found.push(diagnostic);
        }
    }

    /// Takes the cost of reading `len` bytes from the budget, if it suffices.
    fn afford(&mut self, len: usize) -> bool {
        let suffices = len <= self.budget;
        if suffices {
            self.budget -= len;
        }
        suffices
    }

    /// Finds what is wrong with a unit: first with itself, its bodies left out, then with its bodies.
    fn unit(&mut self, unit: Unit, tokens: &Tokens) {
        let bodies = self.cutter.bodies(unit, tokens);
        let before = self.found.len();
        let excerpt = Excerpt::new(&self.cutter, tokens, &bodies);
        let is_faulty = excerpt
            .pieces()
            .any(|piece| self.is_faulty(piece.start, piece.end));
        let mut end = tokens.end;
        if !is_faulty
            && self.afford(excerpt.text.len())
            && (bodies.is_empty() || !reads(unit, &excerpt.text))
            && let Reach::Byte(byte) = reach(unit, &excerpt.text)
        {
            let Explanation { diagnostic, rest } =
                explain(self.file, &self.cutter, unit, tokens, &excerpt, byte);
            self.add(diagnostic);
            if let Some(rest) = rest.filter(|&rest| rest > tokens.start) {
                end = rest.min(tokens.end);
            }
        }
        for body in bodies.iter().filter(|body| body.open < end) {
            let behind = body.behind.min(end);
            let is_closed = self.cutter.brackets.opener(behind - 1) == body.open;
            self.units(
                body.parts,
                &(body.open + 1..if is_closed { behind - 1 } else { behind }),
            );
        }
        self.units(unit, &(end..tokens.end));
        if self.found.len() == before && !is_faulty {
            self.whole(unit, tokens);
        }
    }

    /// Finds what is wrong with the units among `tokens`.
    fn units(&mut self, unit: Unit, tokens: &Tokens) {
        for part in self.cutter.parts(unit, tokens) {
            if self.is_full() {
                return;
            }
            let bytes = self.cutter.bytes(&part);
            let is_clean = !self.is_faulty(bytes.start, bytes.end)
                && self.afford(bytes.len())
                && reads(unit, &self.cutter.scan.plain[bytes]);
            if !is_clean {
                self.unit(unit, &part);
            }
        }
    }

    /// Says where a unit breaks whose parts look fine.
    fn whole(&mut self, unit: Unit, tokens: &Tokens) {
        let bytes = self.cutter.bytes(tokens);
        if self.is_faulty(bytes.start, bytes.end) || !self.afford(bytes.len()) {
            return;
        }
        let excerpt = Excerpt::new(&self.cutter, tokens, &[]);
        if let Reach::Byte(byte) = reach(unit, &excerpt.text) {
            self.add(explain(self.file, &self.cutter, unit, tokens, &excerpt, byte).diagnostic);
        }
    }
}
