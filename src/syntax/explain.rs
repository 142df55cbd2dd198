//! Words for what is wrong at a place: known mistakes first, then whatever small change would let the reading go on.

use super::cut::{ARROWS, Cutter, Tokens};
use super::excerpt::Excerpt;
use super::parse::{Reach, Unit, reach, reads};
use super::scan::TokenKind;
use crate::diag::{Diagnostic, FileId, Span};

/// Longest text in which changes are tried.
const MAX_TRIAL: usize = 20_000;

/// A diagnostic, and where reading can go on as if a unit had ended there.
pub(super) struct Explanation {
    pub(super) diagnostic: Diagnostic,
    pub(super) rest: Option<usize>,
}

/// Says what is wrong with a unit that can be read up to `byte` of `excerpt`.
pub(super) fn explain(
    file: FileId,
    cutter: &Cutter<'_>,
    unit: Unit,
    tokens: &Tokens,
    excerpt: &Excerpt,
    byte: usize,
) -> Explanation {
    let byte = excerpt.to_file(byte);
    let at = cutter
        .scan
        .tokens
        .partition_point(|token| token.end <= byte)
        .clamp(tokens.start, tokens.end);
    let case = |at: usize| Case {
        file,
        cutter,
        unit,
        tokens: tokens.clone(),
        at,
        excerpt,
    };
    let here = case(at);
    if let Some(found) = here.second_arrow() {
        return found;
    }
    // Reading looks some words ahead, so the mistake may be the token before the one at which it stopped.
    let before = case(at.saturating_sub(1).max(tokens.start));
    let known = here
        .unsupported()
        .or_else(|| before.unsupported())
        .or_else(|| here.misplaced())
        .or_else(|| here.wrong_word())
        .or_else(|| before.wrong_word())
        .or_else(|| here.unclosed_query())
        .or_else(|| here.bare_condition())
        .or_else(|| before.bare_condition())
        .or_else(|| here.code_without_braces())
        .or_else(|| before.condition_without_comma());
    let alone = |diagnostic| Explanation {
        diagnostic,
        rest: None,
    };
    known
        .map(alone)
        .or_else(|| here.by_trial())
        .or_else(|| before.by_trial())
        .or_else(|| here.misspelt().map(alone))
        .unwrap_or_else(|| alone(here.unexpected()))
}

/// A unit and the token at which reading it stopped.
pub(super) struct Case<'c, 't> {
    pub(super) file: FileId,
    pub(super) cutter: &'c Cutter<'t>,
    pub(super) unit: Unit,
    pub(super) tokens: Tokens,
    /// The token at which reading stopped; the end of `tokens` if nothing is left.
    pub(super) at: usize,
    excerpt: &'c Excerpt,
}

impl Case<'_, '_> {
    pub(super) fn word(&self, i: usize) -> &str {
        if i < self.tokens.end {
            self.cutter.word(i)
        } else {
            ""
        }
    }

    /// The place of token `i`; right behind the last token at the end.
    pub(super) fn span(&self, i: usize) -> Span {
        match self.cutter.scan.tokens.get(i) {
            Some(token) if i < self.tokens.end => Span::new(self.file, token.start, token.end),
            _ => self.behind(i),
        }
    }

    /// The place right behind the token before `i`.
    pub(super) fn behind(&self, i: usize) -> Span {
        let end = i
            .checked_sub(1)
            .and_then(|last| self.cutter.scan.tokens.get(last))
            .map_or(0, |token| token.end);
        Span::new(self.file, end, end)
    }

    pub(super) fn first_word(&self) -> &str {
        self.word(self.tokens.start)
    }

    /// What a unit of this kind is called.
    fn noun(&self) -> &'static str {
        match self.unit {
            Unit::Item => "declaration",
            Unit::RuleItem if self.cutter.has(self.tokens.start, self.at, &ARROWS) => "rule",
            Unit::Statement | Unit::RuleItem => "statement",
        }
    }

    pub(super) fn error(
        &self,
        slug: &'static str,
        span: Span,
        message: impl Into<String>,
    ) -> Diagnostic {
        Diagnostic::error(slug, span, message)
    }

    /// The change with which reading goes on.
    fn by_trial(&self) -> Option<Explanation> {
        let text = &self.excerpt.text;
        if text.len() > MAX_TRIAL {
            return None;
        }
        let token = self
            .cutter
            .scan
            .tokens
            .get(self.at)
            .filter(|_| self.at < self.tokens.end);
        let (head, tail) =
            text.split_at(token.map_or(text.len(), |token| self.excerpt.of_file(token.start)));
        if reads(self.unit, &format!("{head};")) {
            return Some(Explanation {
                diagnostic: self.missing_semicolon(),
                rest: Some(self.at),
            });
        }
        let goes_on = |insert: &str| match reach(self.unit, &format!("{head}{insert}{tail}")) {
            Reach::All => true,
            Reach::Byte(byte) => byte > head.len() + insert.len() + self.word(self.at).len(),
            Reach::TooDeep => false,
        };
        let diagnostic = if goes_on(" ==> ") {
            self.missing_arrow()
        } else if goes_on(" , ") {
            self.missing("missing-comma", "`,` or an operator")
        } else if goes_on(" x ") {
            self.missing_name()
        } else if goes_on(" ( ") {
            self.missing("missing-parenthesis", "`(`")
        } else {
            self.keyword_as_name(head, tail)?
        };
        Some(Explanation {
            diagnostic,
            rest: None,
        })
    }

    fn missing(&self, slug: &'static str, what: &str) -> Diagnostic {
        self.error(
            slug,
            self.span(self.at),
            format!("expected {what} before {}", self.found()),
        )
    }

    fn missing_arrow(&self) -> Diagnostic {
        self.error(
            "missing-arrow",
            self.behind(self.at),
            "expected the arrow of a rule",
        )
        .hint("write `==>`, `==>>` or `::>` between the two sides")
    }

    /// What was found, for a sentence.
    fn found(&self) -> String {
        match self.word(self.at) {
            "" => format!("the end of the {}", self.noun()),
            word => {
                let short: String = word.chars().take(30).collect();
                let dots = if short.len() < word.len() { "…" } else { "" };
                format!("`{short}{dots}`")
            }
        }
    }

    fn missing_semicolon(&self) -> Diagnostic {
        let message = format!("expected `;` after the {}", self.noun());
        let fault = self
            .error("missing-semicolon", self.behind(self.at), message)
            .label("`;` is missing here");
        let is_capital = |word: &str| word.starts_with(char::is_uppercase);
        let is_same_line = !self.cutter.is_on_new_line(self.at);
        if self.unit == Unit::RuleItem && self.cutter.has(self.tokens.start, self.at, &["::>"]) {
            fault.hint("behind `::>` stands one statement or `{ … }`; to make nodes write `==>`")
        } else if is_same_line && is_capital(self.first_word()) && is_capital(self.word(self.at)) {
            fault.hint("are these nodes of a rule? on a right-hand side nodes stand in `( )`, code in `{ }`")
        } else {
            fault
        }
    }

    fn missing_name(&self) -> Diagnostic {
        let is_param = self.unit == Unit::Item && matches!(self.word(self.at), ")" | ",");
        if is_param && self.cutter.has(self.tokens.start, self.at, &["module"]) {
            return self
                .missing("missing-name", "a name")
                .hint("each parameter has a type and a name: `module A(float x, int n)`");
        }
        let fault = self.missing("missing-name", "a name or a value");
        let before = self.at.checked_sub(1).map_or("", |i| self.word(i));
        if self.word(self.at) == "[" && matches!(before, "=" | "return") {
            return fault.hint("an array is written in braces: `float[] a = {1, 2, 3};`");
        }
        fault
    }

    /// A keyword where a name should stand.
    fn keyword_as_name(&self, head: &str, tail: &str) -> Option<Diagnostic> {
        let found = self.word(self.at);
        let is_word =
            self.at < self.tokens.end && self.cutter.scan.tokens[self.at].kind == TokenKind::Word;
        let renamed = format!("{head}x{}", tail.get(found.len()..)?);
        let goes_on = match reach(self.unit, &renamed) {
            Reach::All => true,
            Reach::Byte(byte) => byte > head.len() + 2,
            Reach::TooDeep => false,
        };
        (is_word && goes_on).then(|| {
            self.error(
                "keyword-as-name",
                self.span(self.at),
                format!("`{found}` is a word of the language and cannot be a name"),
            )
            .hint("choose another name")
        })
    }

    fn unexpected(&self) -> Diagnostic {
        let message = format!("unexpected {}", self.found());
        let mut diagnostic = self.error("unexpected", self.span(self.at), message);
        let opener = self.inside();
        if let Some(opener) = opener {
            diagnostic = diagnostic.also(self.span(opener), "inside of this");
        } else if self.at > self.tokens.start {
            diagnostic = diagnostic.also(
                self.span(self.tokens.start),
                format!("in the {} that begins here", self.noun()),
            );
        }
        diagnostic
    }

    /// The innermost bracket around the token at which reading stopped.
    fn inside(&self) -> Option<usize> {
        let mut i = self.tokens.start;
        let mut inner = None;
        while i < self.at {
            let is_open = self.cutter.scan.tokens[i].kind == TokenKind::Open;
            if is_open && self.cutter.brackets.behind(i) <= self.at {
                i = self.cutter.brackets.behind(i);
                continue;
            }
            if is_open {
                inner = Some(i);
            }
            i += 1;
        }
        inner
    }
}
