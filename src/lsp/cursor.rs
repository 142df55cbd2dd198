//! What stands around a place in a text, without any grammar: also of half-typed text.

use super::place::floor;
use std::ops::Range;

/// The surroundings of a place.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Cursor {
    /// The word that the place touches; empty if there is none.
    pub word: Range<usize>,
    /// Whether it is code: no comment and no string.
    pub is_code: bool,
    /// What would close the brackets that are open here, innermost last, with the byte of each.
    pub open: Vec<(usize, &'static str)>,
    /// The first byte of the statement: behind the last `;`, brace, or beginning of a block of rules.
    pub statement: usize,
    /// The last character of code but blanks.
    previous: char,
}

/// Whether a character can stand in a name.
pub fn is_word(c: char) -> bool {
    c.is_alphanumeric() || c == '_' || c == '$'
}

impl Cursor {
    /// The surroundings of byte `at`. Takes time linear in `at`.
    pub fn new(text: &str, at: usize) -> Self {
        let at = floor(text, at);
        let before = text[..at].chars().rev().take_while(|c| is_word(*c));
        let start = at - before.map(char::len_utf8).sum::<usize>();
        let behind = text[at..].chars().take_while(|c| is_word(*c));
        let end = at + behind.map(char::len_utf8).sum::<usize>();
        let mut cursor = Self {
            word: start..end,
            is_code: true,
            open: vec![],
            statement: 0,
            previous: ';',
        };
        cursor.walk(text, start);
        cursor
    }

    /// Goes through the text from its beginning up to `end`.
    fn walk(&mut self, text: &str, end: usize) {
        let mut at = 0;
        while at < end {
            let rest = &text[at..];
            let Some((len, is_closed)) = no_code(rest) else {
                at += self.step(rest, at);
                continue;
            };
            at += len;
            self.is_code = at < end || (at == end && is_closed);
        }
    }

    /// Takes in what the code goes on with; gives its length.
    fn step(&mut self, rest: &str, at: usize) -> usize {
        if rest.starts_with("(*") && !rest.starts_with("(**") {
            self.open.push((at, "*)"));
            return 2;
        }
        let c = rest.chars().next().unwrap_or(' ');
        match c {
            '(' => self.open.push((at, ")")),
            '[' => {
                // Where code stands, a bracket behind these begins a block of rules.
                let is_code = self.open.last().is_none_or(|(_, closing)| *closing == "}");
                if is_code && matches!(self.previous, ')' | ';' | '{' | '}') {
                    self.statement = at + 1;
                }
                self.open.push((at, "]"));
            }
            '{' => self.open.push((at, "}")),
            ')' | ']' | '}' => self.close(c),
            _ => {}
        }
        if matches!(c, ';' | '{' | '}') {
            self.statement = at + 1;
        }
        if !c.is_whitespace() {
            self.previous = c;
        }
        c.len_utf8()
    }

    /// Closes the innermost bracket of this kind, and what was left open in it.
    fn close(&mut self, c: char) {
        if let Some(at) = self
            .open
            .iter()
            .rposition(|(_, closing)| closing.ends_with(c))
        {
            self.open.truncate(at);
        }
    }

    /// The last character before the word, blanks skipped, and its byte.
    pub fn before(&self, text: &str) -> Option<(usize, char)> {
        text[..self.word.start]
            .char_indices()
            .rev()
            .find(|(_, c)| !c.is_whitespace())
    }

    /// The name before a dot that stands before the word: `Math` in `Math.sin`.
    pub fn qualifier<'t>(&self, text: &'t str) -> Option<&'t str> {
        let (dot, _) = self.before(text).filter(|&(_, c)| c == '.')?;
        let head = text[..dot].trim_end();
        let len: usize = head
            .chars()
            .rev()
            .take_while(|c| is_word(*c))
            .map(char::len_utf8)
            .sum();
        Some(&head[head.len() - len..]).filter(|name| !name.is_empty())
    }
}

/// The length of the comment or string that a text begins with, and whether it is closed; `None` if it begins with code.
fn no_code(rest: &str) -> Option<(usize, bool)> {
    if rest.starts_with("//") {
        return Some((rest.find('\n').unwrap_or(rest.len()), false));
    }
    if let Some(inside) = rest.strip_prefix("/*") {
        let closed = inside.find("*/").map(|len| (len + 4, true));
        return Some(closed.unwrap_or((rest.len(), false)));
    }
    rest.starts_with(['"', '\'']).then(|| quoted_len(rest))
}

/// The words of the code of a text: names, keywords and numbers; none of comments and strings.
pub fn words(text: &str) -> impl Iterator<Item = Range<usize>> {
    let mut at = 0;
    std::iter::from_fn(move || {
        while let Some(first) = text[at..].chars().next() {
            let rest = &text[at..];
            if let Some((len, _)) = no_code(rest) {
                at += len.max(1);
            } else if is_word(first) {
                let start = at;
                at += rest.find(|c| !is_word(c)).unwrap_or(rest.len());
                return Some(start..at);
            } else {
                at += first.len_utf8();
            }
        }
        None
    })
}

/// The number of commas in a text outside of brackets, comments and strings.
pub fn commas(text: &str) -> usize {
    let (mut at, mut depth, mut n) = (0, 0_usize, 0);
    while let Some(first) = text[at..].chars().next() {
        if let Some((len, _)) = no_code(&text[at..]) {
            at += len.max(1);
            continue;
        }
        match first {
            '(' | '[' | '{' => depth += 1,
            ')' | ']' | '}' => depth = depth.saturating_sub(1),
            ',' if depth == 0 => n += 1,
            _ => {}
        }
        at += first.len_utf8();
    }
    n
}

/// The length of a string or character with its quotes, at most to the end of its line, and whether it is closed.
fn quoted_len(rest: &str) -> (usize, bool) {
    let quote = rest.chars().next().unwrap_or('"');
    let mut is_escaped = false;
    for (at, c) in rest.char_indices().skip(1) {
        if c == '\n' {
            return (at, false);
        }
        if c == quote && !is_escaped {
            return (at + 1, true);
        }
        is_escaped = c == '\\' && !is_escaped;
    }
    (rest.len(), false)
}

#[cfg(test)]
mod tests {
    use super::*;

    fn at(marked: &str) -> (String, Cursor) {
        let byte = marked.find('|').unwrap();
        let text = marked.replacen('|', "", 1);
        let cursor = Cursor::new(&text, byte);
        (text, cursor)
    }

    #[test]
    fn words_are_found_from_any_of_their_letters() {
        for marked in ["a |Blattgröße b", "a Blatt|größe b", "a Blattgröße| b"] {
            let (text, cursor) = at(marked);
            assert_eq!(&text[cursor.word.clone()], "Blattgröße");
        }
        assert!(at("a | b").1.word.is_empty());
    }

    #[test]
    fn comments_and_strings_are_no_code() {
        for (marked, is_code) in [
            ("a // b|", false),
            ("a // |", false),
            ("\"a\"|", true),
            ("a // b\n|", true),
            ("/* x| */", false),
            ("/* x */ a|", true),
            ("f(\"te|xt\")", false),
            ("f(\"t\\\"ext\", a|)", true),
            ("'a' + |", true),
            ("\"open\n a|", true),
        ] {
            assert_eq!(at(marked).1.is_code, is_code, "{marked}");
        }
    }

    #[test]
    fn words_and_commas_are_those_of_the_code() {
        let text = "a(b1, \"c, d\", /* e, f */ {g, ä}, 'h') // i";
        let found: Vec<&str> = words(text).map(|word| &text[word]).collect();
        assert_eq!(found, ["a", "b1", "g", "ä"]);
        assert_eq!(commas(&text[2..text.len() - 6]), 3);
        assert_eq!(commas("\"open, "), 0);
    }

    #[test]
    fn open_brackets_are_known() {
        let closing = |marked: &str| at(marked).1.open.iter().map(|o| o.1).collect::<Vec<_>>();
        assert_eq!(closing("void f() { int a = sum((* A |"), ["}", ")", "*)"]);
        assert_eq!(closing("f(g[1], h(|"), [")", ")"]);
        assert_eq!(closing("f(*) |"), Vec::<&str>::new());
        let (text, cursor) = at("{ a; Math . si|n }");
        assert_eq!(cursor.qualifier(&text), Some("Math"));
        assert_eq!(cursor.statement, 4);
        assert_eq!(at("void f() [ A ==> F(1) [ B |").1.statement, 10);
    }
}
