//! A text as words, marks and brackets, before any grammar: what the parser needs to find its limits and its mistakes.

/// Most brackets and unbraced branches (`else`, `for (…) for (…)`, `? :`) inside one another. All that walks a tree needs
/// stack for its depth, and no readable model comes near.
pub(super) const MAX_NESTING: usize = 200;

/// What a token is.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum TokenKind {
    /// A name or keyword.
    Word,
    /// A number.
    Number,
    /// A string or character with its quotes.
    Quoted,
    /// `(`, `[` or `{`
    Open,
    /// `)`, `]` or `}`
    Close,
    /// Anything else.
    Mark,
}

/// A word, number, text or mark, as a range of bytes.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) struct Token {
    pub(super) kind: TokenKind,
    pub(super) start: usize,
    pub(super) end: usize,
}

/// What is wrong with a text before any grammar.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum ProblemKind {
    /// A character that no token begins with.
    Foreign,
    /// A string whose closing quote is not on its line.
    OpenString,
    /// A character whose closing quote is not on its line.
    OpenChar,
    /// A remark without its `*/`.
    OpenComment,
    /// A NUL: this is no text.
    Binary,
    /// More than [`MAX_NESTING`] levels.
    TooDeep,
}

/// One such thing and its range of bytes.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) struct Problem {
    pub(super) kind: ProblemKind,
    pub(super) start: usize,
    pub(super) end: usize,
}

/// A text cut into tokens.
#[derive(Clone, Debug, Default)]
pub(super) struct Scan {
    /// The text with as many spaces as there are bytes for each blank and remark between tokens. This is what the grammar reads:
    /// it skips blanks in front of all it tries, which takes a multiple of the time if there are several kinds of them.
    pub(super) plain: String,
    pub(super) tokens: Vec<Token>,
    pub(super) problems: Vec<Problem>,
}

impl Scan {
    /// Where the last token that ends at or before byte `end` ends.
    pub(super) fn last_end_before(&self, end: usize) -> usize {
        let next = self.tokens.partition_point(|token| token.end <= end);
        next.checked_sub(1).map_or(0, |last| self.tokens[last].end)
    }
}

/// Marks of several characters, longer ones first where they begin alike; the others matter to nobody here.
const MARKS: [&str; 23] = [
    ":'=", "==>>", "==>", "::>", "-->", "<--", "=>", "==", "!=", "<=", ">=", "&&", "||", "++",
    "--", "+=", "-=", "*=", "/=", "%=", "**", ":=", "->",
];

/// Cuts `text` into tokens. Takes linear time.
pub(super) fn scan(text: &str) -> Scan {
    let mut scanner = Scanner {
        text,
        at: 0,
        found: Scan::default(),
        nesting: Nesting::default(),
    };
    scanner.found.plain.reserve_exact(text.len());
    while scanner.at < text.len() {
        let start = scanner.at;
        let is_blank = scanner.next();
        let Scan {
            plain, problems, ..
        } = &mut scanner.found;
        // The line break behind an unclosed string stays, so that no quote of a later line closes it.
        let is_kept = problems.last().is_some_and(|p| {
            p.end == start && matches!(p.kind, ProblemKind::OpenString | ProblemKind::OpenChar)
        });
        if is_blank && !is_kept {
            plain.extend(std::iter::repeat_n(' ', scanner.at - start));
        } else {
            plain.push_str(&text[start..scanner.at]);
        }
    }
    scanner.found
}

struct Scanner<'t> {
    text: &'t str,
    at: usize,
    found: Scan,
    nesting: Nesting,
}

impl Scanner<'_> {
    /// Goes on by a token, a problem, a blank or a remark; says whether it was one of the last two.
    fn next(&mut self) -> bool {
        let rest = &self.text[self.at..];
        let Some(c) = rest.chars().next() else {
            return true;
        };
        if c.is_whitespace() || c == '\u{FEFF}' {
            self.at += c.len_utf8();
            return true;
        }
        if rest.starts_with("//") {
            self.at += rest.find(['\n', '\r']).unwrap_or(rest.len());
            return true;
        }
        if rest.starts_with("/*") {
            return self.comment(rest);
        }
        self.token(rest, c);
        false
    }

    /// Goes on by what `rest` begins with, which is neither a blank nor a remark and has `c` as its first character.
    fn token(&mut self, rest: &str, c: char) {
        if is_word_start(c) {
            let len = rest.find(|c| !is_word_part(c)).unwrap_or(rest.len());
            self.push(TokenKind::Word, len);
        } else if c.is_ascii_digit()
            || (c == '.' && rest[1..].starts_with(|c: char| c.is_ascii_digit()))
        {
            self.push(TokenKind::Number, number_len(rest));
        } else if c == '"' || c == '\'' {
            self.quoted(rest, c);
        } else if matches!(c, '(' | '[' | '{') {
            self.push(TokenKind::Open, 1);
        } else if matches!(c, ')' | ']' | '}') {
            self.push(TokenKind::Close, 1);
        } else if c.is_ascii_graphic() && !matches!(c, '#' | '`' | '\\') {
            let len = MARKS
                .iter()
                .find(|mark| rest.starts_with(**mark))
                .map_or(1, |mark| mark.len());
            self.push(TokenKind::Mark, len);
        } else {
            let kind = if c == '\0' {
                ProblemKind::Binary
            } else {
                ProblemKind::Foreign
            };
            self.problem(kind, c.len_utf8());
        }
    }

    fn push(&mut self, kind: TokenKind, len: usize) {
        let token = Token {
            kind,
            start: self.at,
            end: self.at + len,
        };
        self.found.tokens.push(token);
        if self.nesting.add(kind, &self.text[token.start..token.end]) {
            let Token { start, end, .. } = token;
            self.found.problems.push(Problem {
                kind: ProblemKind::TooDeep,
                start,
                end,
            });
        }
        self.at += len;
    }

    /// Notes a problem; foreign characters in a row are one.
    fn problem(&mut self, kind: ProblemKind, len: usize) {
        let (start, end) = (self.at, self.at + len);
        self.at = end;
        match self.found.problems.last_mut() {
            Some(last) if last.kind == kind && last.end == start => last.end = end,
            _ => self.found.problems.push(Problem { kind, start, end }),
        }
    }

    /// Goes on by a remark; says whether it is closed.
    fn comment(&mut self, rest: &str) -> bool {
        if let Some(len) = rest[2..].find("*/") {
            self.at += len + 4;
            return true;
        }
        self.problem(ProblemKind::OpenComment, 2);
        self.at = self.text.len();
        false
    }

    fn quoted(&mut self, rest: &str, quote: char) {
        let mut is_escaped = false;
        for (i, c) in rest.char_indices().skip(1) {
            if c == '\n' || c == '\r' {
                let kind = if quote == '"' {
                    ProblemKind::OpenString
                } else {
                    ProblemKind::OpenChar
                };
                return self.problem(kind, i);
            }
            if c == quote && !is_escaped {
                return self.push(TokenKind::Quoted, i + 1);
            }
            is_escaped = c == '\\' && !is_escaped;
        }
        let kind = if quote == '"' {
            ProblemKind::OpenString
        } else {
            ProblemKind::OpenChar
        };
        self.problem(kind, rest.len());
    }
}

pub(super) fn is_word_start(c: char) -> bool {
    c.is_alphabetic() || c == '_' || c == '$'
}

/// Letters, digits, and accents that follow their letter, as macOS writes them.
pub(super) fn is_word_part(c: char) -> bool {
    c.is_alphanumeric() || c == '_' || c == '$' || ('\u{300}'..'\u{370}').contains(&c)
}

/// The bracket that closes the one `text` begins with.
pub(super) fn closing(text: &str) -> &'static str {
    match text.as_bytes().first() {
        Some(b'(') => ")",
        Some(b'[') => "]",
        _ => "}",
    }
}

fn number_len(rest: &str) -> usize {
    let mut previous = ' ';
    let is_hex = rest.starts_with("0x") || rest.starts_with("0X");
    let is_part = |c: char, previous: char| {
        is_word_part(c)
            || c == '.'
            || (matches!(c, '+' | '-') && matches!(previous, 'e' | 'E') && !is_hex)
    };
    let end = rest.char_indices().find(|&(_, c)| {
        let ends = !is_part(c, previous);
        previous = c;
        ends
    });
    end.map_or(rest.len(), |(at, _)| at)
}

/// Counts how deep the text is nested: in brackets, and by statements, choices and functions without brackets.
#[derive(Debug, Default)]
struct Nesting {
    /// Each open bracket by what closes it, and what is open in it without a bracket.
    open: Vec<(&'static str, usize)>,
    /// What is open outside of all brackets without a bracket.
    outside: usize,
    /// Sum of all.
    depth: usize,
    /// Whether the last token ended a statement, so that only `else` continues it.
    is_ended: bool,
    /// Whether the limit was exceeded already.
    is_told: bool,
}

impl Nesting {
    /// Counts a token; says whether it is the first beyond the limit.
    fn add(&mut self, kind: TokenKind, text: &str) -> bool {
        let was_ended = std::mem::replace(&mut self.is_ended, text == ";" || text == "}");
        if was_ended && text != "else" && text != ";" {
            self.change(|_| 0);
        }
        match (kind, text) {
            (TokenKind::Open, _) => {
                self.open.push((closing(text), 0));
                self.depth += 1;
            }
            (TokenKind::Close, _) => self.close(text),
            (TokenKind::Word, "if" | "for" | "while" | "do") | (_, "?" | "=>") => {
                self.change(|chain| chain + 1);
            }
            (_, ":") => self.change(|chain| chain.saturating_sub(1)),
            _ => {}
        }
        self.depth > MAX_NESTING && !std::mem::replace(&mut self.is_told, true)
    }

    /// Closes a bracket and what was left open in it, so that missing brackets do not add up.
    fn close(&mut self, text: &str) {
        let near = self.open.len().saturating_sub(MAX_NESTING);
        let at = self.open[near..]
            .iter()
            .rposition(|(closing, _)| *closing == text);
        for (_, chain) in self
            .open
            .drain(at.map_or(self.open.len(), |at| near + at)..)
        {
            self.depth -= chain + 1;
        }
    }

    fn change(&mut self, how: impl Fn(usize) -> usize) {
        let chain = self
            .open
            .last_mut()
            .map_or(&mut self.outside, |(_, chain)| chain);
        let old = std::mem::replace(chain, how(*chain));
        self.depth = self.depth - old + *chain;
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn blanks_and_remarks_become_spaces_of_the_same_length() {
        let text = "A\t// é\r\n/* x\n */B\u{A0}\"a //\t b\"\u{FEFF};";
        let plain = scan(text).plain;
        assert_eq!(plain.len(), text.len());
        let tokens: Vec<&str> = plain.split_whitespace().collect();
        assert_eq!(tokens, ["A", "B", "\"a", "//", "b\"", ";"]);
        assert!(!plain.contains(['\n', '\r', '\u{A0}', 'é']), "{plain:?}");
        assert_eq!(plain.find("\"a //\t b\""), text.find("\"a //\t b\""));
    }

    #[test]
    fn an_unclosed_string_keeps_its_line_break() {
        let scan = scan("a \"b\nc d\" e");
        assert_eq!(scan.plain, "a \"b\nc d\" e");
        assert_eq!(scan.problems.len(), 2);
    }
}
