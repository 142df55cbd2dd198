//! Where declarations, statements and rules begin and end in a text that does not follow the grammar, judged by brackets,
//! semicolons and a few words.

use super::brackets::{Brackets, DECLARATION_WORDS};
use super::parse::Unit;
use super::scan::{Scan, Token, TokenKind};
use std::ops::Range;

/// Tokens by number, the end excluded.
pub(super) type Tokens = Range<usize>;

/// What a pair of brackets holds.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) struct Body {
    /// What its parts are.
    pub(super) parts: Unit,
    /// The opening bracket.
    pub(super) open: usize,
    /// The token behind the closing bracket.
    pub(super) behind: usize,
}

/// What stands in a unit, outside of brackets, before the place in question.
#[derive(Clone, Copy, Debug, Default)]
struct Seen {
    /// `==>` or `==>>`
    is_rule: bool,
    /// `=`
    is_value: bool,
    /// `module`, `class` or `interface`
    is_class: bool,
    /// `enum`
    is_enum: bool,
    /// `throws`
    throws: bool,
}

impl Seen {
    fn add(&mut self, word: &str) {
        match word {
            "==>" | "==>>" => self.is_rule = true,
            "=" => self.is_value = true,
            "module" | "class" | "interface" => self.is_class = true,
            "enum" => self.is_enum = true,
            "throws" => self.throws = true,
            _ => {}
        }
    }
}

/// A text with its tokens and brackets.
pub(super) struct Cutter<'t> {
    pub(super) text: &'t str,
    pub(super) scan: &'t Scan,
    pub(super) brackets: Brackets,
}

const CONTROL_WORDS: [&str; 13] = [
    "if", "for", "while", "do", "switch", "try", "return", "throw", "break", "continue", "int",
    "float", "double",
];
const TYPE_WORDS: [&str; 9] = [
    "int", "float", "double", "boolean", "long", "char", "byte", "short", "String",
];
pub(super) const ARROWS: [&str; 3] = ["==>", "==>>", "::>"];

impl Cutter<'_> {
    /// The text of a token; empty beyond the last.
    pub(super) fn word(&self, i: usize) -> &str {
        self.scan
            .tokens
            .get(i)
            .map_or("", |token| &self.text[token.start..token.end])
    }

    fn kind(&self, i: usize) -> Option<TokenKind> {
        self.scan.tokens.get(i).map(|token| token.kind)
    }

    /// The bytes of tokens that are not empty.
    pub(super) fn bytes(&self, tokens: &Tokens) -> Range<usize> {
        let all = &self.scan.tokens;
        let start = all
            .get(tokens.start)
            .map_or(self.text.len(), |token| token.start);
        let last: Option<&Token> = tokens.end.checked_sub(1).and_then(|last| all.get(last));
        start..last.map_or(start, |token| token.end).max(start)
    }

    /// The parts of a body.
    pub(super) fn parts(&self, unit: Unit, tokens: &Tokens) -> Vec<Tokens> {
        let mut parts = vec![];
        let mut at = tokens.start;
        while at < tokens.end {
            let end = match unit {
                Unit::Item => self.item_end(at, tokens.end),
                Unit::Statement => self.statement_end(at, at, tokens.end),
                Unit::RuleItem => self.rule_item_end(at, tokens.end),
            };
            let end = end.clamp(at + 1, tokens.end);
            parts.push(at..end);
            at = end;
        }
        parts
    }

    fn item_end(&self, start: usize, limit: usize) -> usize {
        let mut seen = Seen::default();
        let mut i = start;
        while i < limit {
            let word = self.word(i);
            if word == ";" {
                return i + 1;
            }
            if i > start && self.begins_item(start, i) {
                return i;
            }
            if self.kind(i) != Some(TokenKind::Open) {
                seen.add(word);
                i += 1;
                continue;
            }
            let is_body = self.body_kind(Unit::Item, start, i, seen).is_some();
            i = self.brackets.behind(i);
            if is_body && self.word(i) != "==>" {
                return i;
            }
        }
        limit
    }

    /// Whether a declaration word at the beginning of a line ends the declaration before it.
    fn begins_item(&self, start: usize, i: usize) -> bool {
        let word = self.word(i);
        let is_word = DECLARATION_WORDS.contains(&word) || TYPE_WORDS.contains(&word);
        let follows_modifier =
            self.word(start) == "@" || DECLARATION_WORDS[5..12].contains(&self.word(i - 1));
        is_word && self.is_on_new_line(i) && !follows_modifier
    }

    /// Whether token `i` is the first of its line.
    pub(super) fn is_on_new_line(&self, i: usize) -> bool {
        let (before, this) = (
            self.scan.tokens.get(i.wrapping_sub(1)),
            self.scan.tokens.get(i),
        );
        match (before, this) {
            (Some(before), Some(this)) => self.text[before.end..this.start].contains('\n'),
            _ => true,
        }
    }

    /// The end of the statement that begins at `first`; `start` is where its unit begins.
    fn statement_end(&self, start: usize, first: usize, limit: usize) -> usize {
        let mut seen = Seen::default();
        let mut i = first;
        while i < limit {
            let word = self.word(i);
            if word == ";" {
                i += 1;
            } else if self.kind(i) == Some(TokenKind::Open) {
                let is_body = self.body_kind(Unit::Statement, start, i, seen).is_some()
                    || self.is_switch_body(i);
                i = self.brackets.behind(i);
                if !is_body {
                    continue;
                }
            } else {
                seen.add(word);
                i += 1;
                continue;
            }
            let goes_on = match self.word(i) {
                "else" | "catch" | "finally" => true,
                "while" => self.word(first) == "do",
                _ => false,
            };
            if !goes_on || i >= limit {
                return i;
            }
        }
        limit
    }

    fn rule_item_end(&self, start: usize, limit: usize) -> usize {
        if matches!(self.word(start), "{" | "[") {
            return self.brackets.behind(start);
        }
        if CONTROL_WORDS.contains(&self.word(start)) {
            return self.statement_end(start, start, limit);
        }
        let mut i = start;
        while i < limit {
            match (self.word(i), self.kind(i)) {
                (";", _) => return i + 1,
                ("::>", _) => return self.statement_end(start, i + 1, limit),
                (_, Some(TokenKind::Open)) => i = self.brackets.behind(i),
                _ => i += 1,
            }
        }
        limit
    }

    /// The brackets of a unit that hold declarations, statements or rules.
    pub(super) fn bodies(&self, unit: Unit, tokens: &Tokens) -> Vec<Body> {
        let mut bodies = vec![];
        let mut seen = Seen::default();
        let mut i = tokens.start;
        while i < tokens.end {
            if self.kind(i) != Some(TokenKind::Open) {
                seen.add(self.word(i));
                i += 1;
                continue;
            }
            let behind = self.brackets.behind(i).min(tokens.end);
            if let Some(parts) = self.body_kind(unit, tokens.start, i, seen) {
                bodies.push(Body {
                    parts,
                    open: i,
                    behind,
                });
            }
            i = behind;
        }
        bodies
    }

    /// What the brackets that open at token `i` of a unit hold, if it is declarations, statements or rules.
    fn body_kind(&self, unit: Unit, start: usize, i: usize, seen: Seen) -> Option<Unit> {
        let is_first = i == start;
        match (unit, self.word(i)) {
            (Unit::Item, "{") => {
                let follows_head = is_first
                    || matches!(self.word(i - 1), ")" | ">")
                    || self.kind(i - 1) == Some(TokenKind::Word);
                let parts = if seen.is_class {
                    Unit::Item
                } else {
                    Unit::Statement
                };
                (follows_head && !seen.is_value && !seen.is_rule && !seen.is_enum).then_some(parts)
            }
            (Unit::Item, "[") => {
                let follows_head = !is_first && (self.word(i - 1) == ")" || seen.throws);
                (follows_head && !seen.is_value && !seen.is_rule).then_some(Unit::RuleItem)
            }
            (_, "{") if seen.is_class => Some(Unit::Item),
            (_, "{") => {
                let is_block = is_first
                    || matches!(
                        self.word(i - 1),
                        "::>" | "else" | "do" | "try" | "finally" | ":"
                    )
                    || self.follows_head(i, &["if", "for", "while", "catch"])
                    || seen.is_rule;
                is_block.then_some(Unit::Statement)
            }
            (_, "[") => {
                let is_block = is_first
                    || self.word(i - 1) == "::>"
                    || self.follows_head(i, &["if", "for", "while"]);
                (is_block && !seen.is_rule).then_some(Unit::RuleItem)
            }
            _ => None,
        }
    }

    /// Whether `(…)` behind one of `words`, or `else` or `do`, stands right before token `i`.
    fn follows_head(&self, i: usize, words: &[&str]) -> bool {
        let Some(before) = i.checked_sub(1) else {
            return false;
        };
        match self.word(before) {
            "else" | "do" => true,
            ")" => self
                .brackets
                .opener(before)
                .checked_sub(1)
                .is_some_and(|head| words.contains(&self.word(head))),
            _ => false,
        }
    }

    fn is_switch_body(&self, i: usize) -> bool {
        self.word(i) == "{" && self.follows_head(i, &["switch"])
    }

    /// Whether one of `words` stands among tokens `start..end`, outside of brackets.
    pub(super) fn has(&self, start: usize, end: usize, words: &[&str]) -> bool {
        self.find(start, end, words).is_some()
    }

    /// The first of `words` among tokens `start..end`, outside of brackets.
    pub(super) fn find(&self, start: usize, end: usize, words: &[&str]) -> Option<usize> {
        let mut i = start;
        while i < end {
            if words.contains(&self.word(i)) {
                return Some(i);
            }
            i = if self.kind(i) == Some(TokenKind::Open) {
                self.brackets.behind(i)
            } else {
                i + 1
            };
        }
        None
    }
}
