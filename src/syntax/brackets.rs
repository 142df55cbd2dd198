//! Which bracket closes which, and what to say when one does not.

use super::scan::{Scan, Token, TokenKind, closing};
use crate::diag::{Diagnostic, FileId, Span};

/// Words a declaration can begin with. At the beginning of a line one of them tells that brackets before it are unclosed.
pub(super) const DECLARATION_WORDS: [&str; 13] = [
    "import",
    "module",
    "class",
    "interface",
    "enum",
    "public",
    "protected",
    "private",
    "static",
    "final",
    "const",
    "abstract",
    "void",
];

/// A bracket that does not fit, by number of token.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Fault {
    /// Never closed; `before` is the token that shows it, or the number of tokens.
    Unclosed { open: usize, before: usize },
    /// Closed by a bracket of another kind.
    Mismatched { open: usize, close: usize },
    /// Closes nothing.
    Stray { close: usize },
}

/// The brackets of a text.
pub(super) struct Brackets {
    /// For each opening bracket the token behind its group; for each closing one its opening one; else the token itself.
    partner: Vec<usize>,
    /// What does not fit.
    pub(super) faults: Vec<Fault>,
}

impl Brackets {
    /// Pairs the brackets of `text`.
    pub(super) fn new(text: &str, scan: &Scan) -> Self {
        let plain = Pairing::new(text, &scan.tokens).run(false);
        let is_open_at_end = |fault: &Fault| matches!(fault, Fault::Unclosed { before, .. } if *before == scan.tokens.len());
        if plain.faults.iter().any(is_open_at_end) {
            // Better believe the declarations than report the outermost bracket only.
            return Pairing::new(text, &scan.tokens).run(true);
        }
        if let [Fault::Stray { close }] = plain.faults[..] {
            return plain.with_early_stray(text, scan, close).unwrap_or(plain);
        }
        plain
    }

    /// Where one closing bracket is too many, one before it that ends a method in the middle of a rule is rather it.
    fn with_early_stray(&self, text: &str, scan: &Scan, stray: usize) -> Option<Self> {
        let word = |i: usize| {
            scan.tokens
                .get(i)
                .map_or("", |token| &text[token.start..token.end])
        };
        let ends_method = |close: usize| {
            let open = self.opener(close);
            word(close) == "]" && open > 0 && word(open) == "[" && word(open - 1) == ")"
        };
        let cuts_rule = |close: usize| !matches!(word(close - 1), ";" | "}" | "[");
        let early = (1..stray)
            .rev()
            .find(|&close| ends_method(close) && cuts_rule(close))?;
        let mut pairing = Pairing::new(text, &scan.tokens);
        pairing.skipped = Some(early);
        let mut found = pairing.run(false);
        let is_better = found.faults.is_empty();
        found.faults.push(Fault::Stray { close: early });
        is_better.then_some(found)
    }

    /// The token behind the group that opens at token `open`.
    pub(super) fn behind(&self, open: usize) -> usize {
        self.partner[open].max(open + 1)
    }

    /// The bracket that token `close` closes.
    pub(super) fn opener(&self, close: usize) -> usize {
        self.partner[close].min(close)
    }
}

struct Pairing<'t> {
    text: &'t str,
    tokens: &'t [Token],
    open: Vec<usize>,
    /// Which brackets open a branch on the right-hand side of a rule.
    is_branch: Vec<bool>,
    /// A bracket that is passed over.
    skipped: Option<usize>,
    found: Brackets,
}

impl<'t> Pairing<'t> {
    fn new(text: &'t str, tokens: &'t [Token]) -> Self {
        let found = Brackets {
            partner: (0..tokens.len()).collect(),
            faults: vec![],
        };
        Self {
            text,
            tokens,
            open: vec![],
            is_branch: branches(text, tokens),
            skipped: None,
            found,
        }
    }

    fn run(mut self, trusts_declarations: bool) -> Brackets {
        for (i, token) in self.tokens.iter().enumerate() {
            let text = &self.text[token.start..token.end];
            match token.kind {
                _ if self.skipped == Some(i) => {}
                TokenKind::Open => self.open.push(i),
                TokenKind::Close => self.close(i, text),
                TokenKind::Mark if text == ";" => self.end_parentheses(i),
                TokenKind::Word if trusts_declarations && self.starts_declaration(token, text) => {
                    self.give_up(0, i);
                }
                _ => {}
            }
        }
        self.give_up(0, self.tokens.len());
        self.found
    }

    fn close(&mut self, close: usize, text: &str) {
        let fits = |open: &usize| closing(&self.text[self.tokens[*open].start..]) == text;
        match self.open.iter().rposition(fits) {
            Some(at) => {
                self.give_up(at + 1, close);
                if let Some(open) = self.open.pop() {
                    self.pair(open, close);
                }
            }
            None => match self.open.pop() {
                Some(open) => {
                    self.pair(open, close);
                    self.found.faults.push(Fault::Mismatched { open, close });
                }
                None => self.found.faults.push(Fault::Stray { close }),
            },
        }
    }

    fn pair(&mut self, open: usize, close: usize) {
        self.found.partner[open] = close + 1;
        self.found.partner[close] = open;
    }

    /// A `;` ends what is in parentheses, except in `for (;;)` and `.( ; )`, and branches of right-hand sides.
    fn end_parentheses(&mut self, at: usize) {
        let holds_semicolons = |open: usize| {
            let before = open.checked_sub(1).map(|i| self.tokens[i]);
            before.is_some_and(|token| matches!(&self.text[token.start..token.end], "for" | "."))
        };
        let is_broken = |open: usize| {
            let is_parenthesis = self.text[self.tokens[open].start..].starts_with('(');
            self.is_branch[open] || (is_parenthesis && !holds_semicolons(open))
        };
        let keep = self
            .open
            .iter()
            .rposition(|&open| !is_broken(open))
            .map_or(0, |at| at + 1);
        self.give_up(keep, at);
    }

    /// All open brackets from the `keep`-th on end before token `before`; the innermost is reported.
    fn give_up(&mut self, keep: usize, before: usize) {
        if let Some(&open) = self.open[keep..].last() {
            self.found.faults.push(Fault::Unclosed { open, before });
        }
        for open in self.open.drain(keep..) {
            self.found.partner[open] = before;
        }
    }

    fn starts_declaration(&self, token: &Token, text: &str) -> bool {
        let is_first = token.start == 0 || self.text[..token.start].ends_with('\n');
        is_first && DECLARATION_WORDS.contains(&text)
    }
}

/// Which tokens open a branch on the right-hand side of a rule: `[` behind an arrow, before the rule's `;`.
fn branches(text: &str, tokens: &[Token]) -> Vec<bool> {
    let mut found = vec![false; tokens.len()];
    // Whether an arrow came before, at the top and in each open bracket.
    let mut is_right = vec![false];
    for (i, token) in tokens.iter().enumerate() {
        let here = is_right.last().copied().unwrap_or(false);
        match &text[token.start..token.end] {
            "[" => {
                found[i] = here;
                is_right.push(here);
            }
            "(" | "{" => is_right.push(false),
            ")" | "]" | "}" if is_right.len() > 1 => {
                is_right.pop();
            }
            arrow @ ("==>" | "==>>" | ";") => {
                if let Some(last) = is_right.last_mut() {
                    *last = arrow != ";";
                }
            }
            _ => {}
        }
    }
    found
}

impl Fault {
    /// The tokens it is about.
    pub(super) fn tokens(self) -> [usize; 2] {
        match self {
            Self::Unclosed { open, .. } => [open, open],
            Self::Mismatched { open, close } => [open, close],
            Self::Stray { close } => [close, close],
        }
    }

    /// The message.
    pub(super) fn diagnostic(self, file: FileId, text: &str, scan: &Scan) -> Diagnostic {
        let span = |i: usize| Span::new(file, scan.tokens[i].start, scan.tokens[i].end);
        let word = |i: usize| &text[scan.tokens[i].start..scan.tokens[i].end];
        match self {
            Self::Unclosed { open, before } => {
                let missing = closing(word(open));
                let diagnostic = Diagnostic::error(
                    "unclosed-bracket",
                    span(open),
                    format!("this `{}` is never closed", word(open)),
                )
                .label(format!("its `{missing}` is missing"));
                if before < scan.tokens.len() {
                    diagnostic.also(span(before), format!("expected `{missing}` before this"))
                } else {
                    diagnostic.hint(format!("add `{missing}` where the part ends"))
                }
            }
            Self::Mismatched { open, close } => {
                let missing = closing(word(open));
                let message = format!("`{}` does not close `{}`", word(close), word(open));
                Diagnostic::error("mismatched-bracket", span(close), message)
                    .label(format!("expected `{missing}`"))
                    .also(span(open), "opened here")
            }
            Self::Stray { close } => {
                let message = format!("`{}` closes nothing", word(close));
                Diagnostic::error("stray-bracket", span(close), message)
                    .label("one bracket too many")
                    .hint("remove it, or add the bracket it should close")
            }
        }
    }
}
