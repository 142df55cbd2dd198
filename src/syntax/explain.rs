//! Words for what is wrong at a place: known mistakes first, then whatever small change would let the reading go on.

use super::cut::{ARROWS, Body, Cutter, Tokens};
use super::parse::{Reach, Unit, reach};
use super::scan::TokenKind;
use crate::diag::{Diagnostic, FileId, Span, nearest};
use std::ops::Range;

/// Longest text in which changes are tried.
const MAX_TRIAL: usize = 20_000;

/// The text of a unit with its bodies left out.
pub(super) struct Excerpt {
    pub(super) text: String,
    /// Where each piece begins in `text`, and its bytes in the file.
    pieces: Vec<(usize, Range<usize>)>,
}

impl Excerpt {
    /// The text of `tokens` without what is inside `bodies`.
    pub(super) fn new(cutter: &Cutter<'_>, tokens: &Tokens, bodies: &[Body]) -> Self {
        let mut excerpt = Self {
            text: String::new(),
            pieces: vec![],
        };
        let mut start = tokens.start;
        for body in bodies {
            excerpt.add(cutter, &(start..body.open + 1));
            start = (body.behind - 1).max(body.open + 1);
        }
        excerpt.add(cutter, &(start..tokens.end));
        excerpt
    }

    fn add(&mut self, cutter: &Cutter<'_>, tokens: &Tokens) {
        if tokens.is_empty() {
            return;
        }
        let bytes = cutter.bytes(tokens);
        self.pieces.push((self.text.len(), bytes.clone()));
        self.text.push_str(&cutter.text[bytes]);
        self.text.push(' ');
    }

    /// The bytes of the file that the text is made of.
    pub(super) fn pieces(&self) -> impl Iterator<Item = &Range<usize>> {
        self.pieces.iter().map(|(_, bytes)| bytes)
    }

    /// The byte of the file for a byte of the text.
    fn to_file(&self, byte: usize) -> usize {
        let piece = self.pieces.iter().rev().find(|(start, _)| *start <= byte);
        piece.map_or(0, |(start, bytes)| {
            (bytes.start + byte - start).min(bytes.end)
        })
    }

    /// The byte of the text for a byte of the file.
    fn of_file(&self, byte: usize) -> usize {
        let piece = self
            .pieces
            .iter()
            .rev()
            .find(|(_, bytes)| bytes.start <= byte);
        piece.map_or(0, |(start, bytes)| {
            start + (byte - bytes.start).min(bytes.len())
        })
    }
}

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
        .misplaced()
        .or_else(|| here.wrong_word())
        .or_else(|| before.wrong_word())
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

struct Case<'c, 't> {
    file: FileId,
    cutter: &'c Cutter<'t>,
    unit: Unit,
    tokens: Tokens,
    /// The token at which reading stopped; the end of `tokens` if nothing is left.
    at: usize,
    excerpt: &'c Excerpt,
}

impl Case<'_, '_> {
    fn word(&self, i: usize) -> &str {
        if i < self.tokens.end {
            self.cutter.word(i)
        } else {
            ""
        }
    }

    /// The place of token `i`; right behind the last token at the end.
    fn span(&self, i: usize) -> Span {
        match self.cutter.scan.tokens.get(i) {
            Some(token) if i < self.tokens.end => Span::new(self.file, token.start, token.end),
            _ => self.behind(i),
        }
    }

    /// The place right behind the token before `i`.
    fn behind(&self, i: usize) -> Span {
        let end = i
            .checked_sub(1)
            .and_then(|last| self.cutter.scan.tokens.get(last))
            .map_or(0, |token| token.end);
        Span::new(self.file, end, end)
    }

    fn first_word(&self) -> &str {
        self.word(self.tokens.start)
    }

    /// What a unit of this kind is called.
    fn noun(&self) -> &'static str {
        match self.unit {
            Unit::Item => "declaration",
            Unit::RuleItem if self.cutter.has(self.tokens.start, self.tokens.end, &ARROWS) => {
                "rule"
            }
            Unit::Statement | Unit::RuleItem => "statement",
        }
    }

    fn error(&self, slug: &'static str, span: Span, message: impl Into<String>) -> Diagnostic {
        Diagnostic::error(slug, span, message)
    }

    // ── known mistakes ──

    /// `A ==> B  C ==> D;`: the `;` between two rules is missing.
    fn second_arrow(&self) -> Option<Explanation> {
        let is_arrow = ARROWS.contains(&self.word(self.at));
        let first = self.cutter.find(self.tokens.start, self.at, &ARROWS)?;
        if !is_arrow || self.unit != Unit::RuleItem {
            return None;
        }
        let rest = self.lhs_before(self.at).max(first + 1);
        let diagnostic = self
            .error(
                "missing-semicolon",
                self.behind(rest),
                "expected `;` after the rule",
            )
            .label("`;` is missing here")
            .also(self.span(self.at), "the next rule's arrow");
        Some(Explanation {
            diagnostic,
            rest: Some(rest),
        })
    }

    /// Where the left side before an arrow seems to begin: at its line, or at its last node.
    fn lhs_before(&self, arrow: usize) -> usize {
        let line = (self.tokens.start..arrow)
            .rev()
            .find(|&i| self.cutter.is_on_new_line(i));
        if let Some(line) = line.filter(|&line| line > self.tokens.start && line < arrow) {
            return line;
        }
        let mut i = arrow;
        while i > self.tokens.start {
            i -= 1;
            i = self.cutter.brackets.opener(i);
            let is_node = self.cutter.scan.tokens[i].kind == TokenKind::Word;
            if is_node && self.word(i - 1) == ":" {
                i -= 2;
            }
            if is_node && self.word(i.wrapping_sub(1)) != "," {
                return i;
            }
        }
        i
    }

    /// A rule or a statement where none can stand.
    fn misplaced(&self) -> Option<Diagnostic> {
        let Tokens { start, end } = self.tokens;
        let arrow = self.cutter.find(start, end, &ARROWS);
        match (self.unit, arrow) {
            (Unit::Item, Some(arrow)) if !self.cutter.has(start, arrow, &["module"]) => {
                if self.is_module_head() {
                    return Some(self.missing_module());
                }
                let span = self.span(start).to(self.span(arrow));
                let diagnostic =
                    self.error("misplaced-rule", span, "a rule stands outside of `[ ]`");
                Some(
                    diagnostic
                        .hint("put rules into a method with brackets: `void grow() [ A ==> B; ]`"),
                )
            }
            (Unit::Statement, Some(arrow)) => {
                let diagnostic = self.error(
                    "misplaced-rule",
                    self.span(arrow),
                    "a rule stands among the statements of `{ }`",
                );
                Some(diagnostic.hint("put rules into brackets: `[ A ==> B; ]`"))
            }
            (Unit::Item, None) if self.is_module_head() => Some(self.missing_module()),
            (Unit::Item, None) if self.is_statement() => {
                let diagnostic = self.error(
                    "misplaced-statement",
                    self.span(start),
                    "a statement stands outside of a method",
                );
                Some(diagnostic.hint("put it into a method: `void run() { … }`"))
            }
            _ => None,
        }
    }

    /// `Leaf(float size) extends Null` without `module`.
    fn is_module_head(&self) -> bool {
        let Tokens { start, .. } = self.tokens;
        let is_name = self.cutter.scan.tokens[start].kind == TokenKind::Word
            && nearest_keyword(self.first_word()).is_none();
        if !is_name {
            return false;
        }
        if self.word(start + 1) != "(" {
            return self.word(start + 1) == "extends";
        }
        let behind = self.cutter.brackets.behind(start + 1);
        let inside = start + 2..behind - 1;
        let is_typed = inside.len() >= 2 && {
            let kinds = inside.clone().map(|i| self.cutter.scan.tokens[i].kind);
            kinds.take(2).all(|kind| kind == TokenKind::Word)
        };
        is_typed || self.word(start + 2) == "super" || self.word(behind) == "extends"
    }

    fn missing_module(&self) -> Diagnostic {
        let name = self.first_word();
        self.error(
            "missing-module",
            self.span(self.tokens.start),
            format!("expected `module` before `{name}`"),
        )
        .hint(format!("write `module {name}…`"))
    }

    fn is_statement(&self) -> bool {
        let start = self.tokens.start;
        let is_control = matches!(
            self.first_word(),
            "if" | "for" | "while" | "do" | "switch" | "try" | "return"
        );
        let is_word = self.cutter.scan.tokens[start].kind == TokenKind::Word;
        is_control
            || (is_word && matches!(self.word(start + 1), "(" | "." | "=" | "+=" | "-=" | "++"))
    }

    /// A word or mark from another language, or a misspelt one.
    fn wrong_word(&self) -> Option<Diagnostic> {
        let (found, span) = (self.word(self.at), self.span(self.at));
        if matches!(found, "=>" | "->") && !self.cutter.has(self.tokens.start, self.at, &ARROWS) {
            let diagnostic = self.error(
                "wrong-arrow",
                span,
                format!("`{found}` is not an arrow of a rule"),
            );
            return Some(diagnostic.hint("write `==>`, `==>>` or `::>`"));
        }
        let hint = match found {
            "and" => "write `&&`",
            "or" => "write `||`",
            "then" => "leave it out",
            "elif" | "elsif" | "elseif" => "write `else if`",
            _ => return None,
        };
        Some(
            self.error(
                "wrong-word",
                span,
                format!("`{found}` is no word of the language"),
            )
            .hint(hint),
        )
    }

    /// `A(x) (x > 4) ==> B;`: the comma before a condition is missing.
    fn condition_without_comma(&self) -> Option<Diagnostic> {
        let is_condition = self.unit == Unit::RuleItem
            && self.word(self.at) == "("
            && self.at > self.tokens.start
            && ARROWS.contains(&self.word(self.cutter.brackets.behind(self.at)));
        is_condition.then(|| {
            self.error(
                "missing-comma",
                self.behind(self.at),
                "expected `,` before the condition",
            )
            .label("`,` is missing here")
            .hint("conditions stand behind a comma: `A(x), (x > 4) ==> B;`")
        })
    }

    /// A declaration that begins with almost a keyword.
    fn misspelt(&self) -> Option<Diagnostic> {
        let first = self.first_word();
        let keyword = nearest_keyword(first).filter(|_| self.unit == Unit::Item)?;
        let span = self.span(self.tokens.start);
        let diagnostic = self.error(
            "unknown-word",
            span,
            format!("`{first}` begins no declaration"),
        );
        Some(diagnostic.hint(format!("did you mean `{keyword}`?")))
    }

    // ── trials ──

    /// The change with which reading goes on.
    fn by_trial(&self) -> Option<Explanation> {
        if self.excerpt.text.len() > MAX_TRIAL {
            return None;
        }
        let at_byte = self
            .cutter
            .scan
            .tokens
            .get(self.at)
            .map_or(0, |token| token.start);
        let at = if self.at < self.tokens.end {
            self.excerpt.of_file(at_byte)
        } else {
            self.excerpt.text.len()
        };
        let (head, tail) = self.excerpt.text.split_at(at);
        if reach(self.unit, &format!("{head};")) == Reach::All {
            return Some(Explanation {
                diagnostic: self.missing_semicolon(),
                rest: Some(self.at),
            });
        }
        let goes_on = |insert: &str| match reach(self.unit, &format!("{head}{insert}{tail}")) {
            Reach::All => true,
            Reach::Byte(byte) => byte > at + insert.len() + self.word(self.at).len(),
            Reach::TooDeep => false,
        };
        let diagnostic = if goes_on(" ==> ") {
            self.error(
                "missing-arrow",
                self.behind(self.at),
                "expected the arrow of a rule",
            )
            .hint("write `==>`, `==>>` or `::>` between the two sides")
        } else if goes_on(" , ") {
            self.missing_comma()
        } else if goes_on(" x ") {
            self.missing_name()
        } else if goes_on(" ( ") {
            self.error(
                "missing-parenthesis",
                self.span(self.at),
                format!("expected `(` before {}", self.found()),
            )
        } else {
            self.keyword_as_name(head, tail)?
        };
        Some(Explanation {
            diagnostic,
            rest: None,
        })
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
        self.error("missing-semicolon", self.behind(self.at), message)
            .label("`;` is missing here")
    }

    fn missing_comma(&self) -> Diagnostic {
        self.error(
            "missing-comma",
            self.span(self.at),
            format!("expected `,` or an operator before {}", self.found()),
        )
    }

    fn missing_name(&self) -> Diagnostic {
        let is_param = self.unit == Unit::Item && matches!(self.word(self.at), ")" | ",");
        if is_param && self.cutter.has(self.tokens.start, self.at, &["module"]) {
            return self
                .error(
                    "missing-name",
                    self.span(self.at),
                    format!("expected a name before {}", self.found()),
                )
                .hint("each parameter has a type and a name: `module A(float x, int n)`");
        }
        self.error(
            "missing-name",
            self.span(self.at),
            format!("expected a name or a value before {}", self.found()),
        )
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

/// The keyword that a word at the beginning of a declaration was meant to be.
fn nearest_keyword(word: &str) -> Option<&'static str> {
    const KEYWORDS: [&str; 9] = [
        "module",
        "import",
        "class",
        "public",
        "protected",
        "private",
        "static",
        "abstract",
        "interface",
    ];
    if KEYWORDS.contains(&word) || word.len() < 4 {
        return None;
    }
    nearest(word, KEYWORDS).filter(|keyword| keyword.len().abs_diff(word.len()) <= 2)
}
