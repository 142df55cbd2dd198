//! Mistakes that are known by their looks: those of beginners, of other languages, and of what is not offered here.

use super::cut::{ARROWS, Tokens};
use super::explain::{Case, Explanation};
use super::parse::Unit;
use super::scan::TokenKind;
use crate::diag::{Diagnostic, Span, nearest};

impl Case<'_, '_> {
    /// `A ==> B  C ==> D;`: the `;` between two rules is missing.
    pub(super) fn second_arrow(&self) -> Option<Explanation> {
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
    pub(super) fn misplaced(&self) -> Option<Diagnostic> {
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

    /// Something of GroIMP's language that is not offered here.
    pub(super) fn unsupported(&self) -> Option<Diagnostic> {
        let (found, span) = (self.word(self.at), self.span(self.at));
        let refuse = |span: Span, what: &str, instead: &str| {
            let message = format!("{what} are not supported");
            Some(self.error("unsupported", span, message).hint(instead))
        };
        match found {
            ":'=" => refuse(
                span,
                "rates (`:'=`)",
                "compute the step yourself: `x[v] :+= rate * dt`",
            ),
            "in" if self.first_word() != "for" => refuse(
                span,
                "regions (`x in cone(…)`)",
                "compare positions: `location(x)`, `distance(x, y)` and `u.angle(v)` say where nodes stand",
            ),
            "{" if self.follows_new() => refuse(
                span,
                "classes without a name",
                "declare a class and write `new` with its name",
            ),
            ">" | "+>" | "/>" | "-->" | "<" | "<+" | "<--" if self.word(self.at + 1) == "|" => {
                refuse(
                    span,
                    "alternatives between edges",
                    "write `-->` for an edge of any kind",
                )
            }
            _ => None,
        }
    }

    /// `A ==> B  n = n + 1;`: code on the right-hand side without braces.
    pub(super) fn code_without_braces(&self) -> Option<Diagnostic> {
        const ASSIGNMENTS: [&str; 12] = [
            "=", "+=", "-=", "*=", "/=", "%=", "**=", "++", "--", ":=", "|=", "&=",
        ];
        let is_code = self.unit == Unit::RuleItem
            && ASSIGNMENTS.contains(&self.word(self.at))
            && self
                .cutter
                .has(self.tokens.start, self.at, &["==>", "==>>"]);
        is_code.then(|| {
            self.error(
                "code-without-braces",
                self.span(self.at),
                "an assignment cannot stand on the right-hand side of a rule",
            )
            .hint("put code into braces: `A ==> B { n = n + 1; };`")
            .hint("or write `::>` for a rule that only runs code: `a:A ::> a[n] = 2;`")
        })
    }

    /// Whether `new T(…)` stands right before.
    fn follows_new(&self) -> bool {
        let Some(close) = self.at.checked_sub(1).filter(|&i| self.word(i) == ")") else {
            return false;
        };
        let open = self.cutter.brackets.opener(close);
        let is_name = |i: &usize| !matches!(self.word(*i), "new" | "(" | "=" | ";" | ",");
        let head = (self.tokens.start..open).rev().find(|i| !is_name(i));
        head.is_some_and(|i| self.word(i) == "new")
    }

    /// A word or mark from another language, or a misspelt one.
    pub(super) fn wrong_word(&self) -> Option<Diagnostic> {
        let (found, span) = (self.word(self.at), self.span(self.at));
        if matches!(found, "=>" | "->") && !self.cutter.has(self.tokens.start, self.at, &ARROWS) {
            let diagnostic = self.error(
                "wrong-arrow",
                span,
                format!("`{found}` is not an arrow of a rule"),
            );
            return Some(diagnostic.hint("write `==>`, `==>>` or `::>`"));
        }
        let first = self.first_word();
        if let Some(before) = self.at.checked_sub(1).filter(|&i| self.word(i) == "not") {
            let message = "`not` is no word of the language";
            let diagnostic = self.error("wrong-word", self.span(before), message);
            return Some(diagnostic.hint("write `!`"));
        }
        if matches!(first, "elif" | "elsif" | "elseif") && self.unit != Unit::Item {
            let span = self.span(self.tokens.start);
            let message = format!("`{first}` is no word of the language");
            let diagnostic = self.error("wrong-word", span, message);
            return Some(diagnostic.hint("write `else if`"));
        }
        let hint = match found {
            "in" if first == "for" => "write `:`, as in `for (int i : 1:3)`",
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

    /// `(* Leaf )`: the query is not closed.
    pub(super) fn unclosed_query(&self) -> Option<Diagnostic> {
        let open = (self.tokens.start..self.at)
            .rev()
            .find(|&i| self.opens_query(i))?;
        let close = self.cutter.brackets.behind(open).checked_sub(1)?;
        let is_open = self.at <= close && self.word(close) == ")" && self.word(close - 1) != "*";
        is_open.then(|| {
            self.error(
                "unclosed-query",
                self.span(open),
                "this query is never closed",
            )
            .label("its `*)` is missing")
            .also(self.span(close), "expected `*)` here")
        })
    }

    fn opens_query(&self, i: usize) -> bool {
        self.word(i) == "(*" || (self.word(i) == "(" && self.word(i + 1) == "*")
    }

    /// `(* l:Leaf, l[size] > 1 *)`, `A(x), x > 3 ==> B;`: a condition without parentheses.
    pub(super) fn bare_condition(&self) -> Option<Diagnostic> {
        const COMPARISONS: [&str; 9] = [">", "<", ">=", "<=", "==", "!=", "&&", "||", "!"];
        let in_query = (self.tokens.start..self.at)
            .any(|i| self.opens_query(i) && self.cutter.brackets.behind(i) > self.at);
        let on_left = self.unit == Unit::RuleItem
            && self
                .cutter
                .find(self.at, self.tokens.end, &ARROWS)
                .is_some();
        let is_bare = COMPARISONS.contains(&self.word(self.at)) && (in_query || on_left);
        is_bare.then(|| {
            let message = format!("unexpected `{}`", self.word(self.at));
            self.error("bare-condition", self.span(self.at), message)
                .hint("a condition stands in parentheses, behind a comma: `x:A, (x[n] > 4)`")
        })
    }

    /// `A(x) (x > 4) ==> B;`: the comma before a condition is missing.
    pub(super) fn condition_without_comma(&self) -> Option<Diagnostic> {
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
    pub(super) fn misspelt(&self) -> Option<Diagnostic> {
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
