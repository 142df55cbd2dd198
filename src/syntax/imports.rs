//! Which other files a text asks for, found without reading all of it.

use super::scan::{TokenKind, scan};

/// An `import` line, as far as its names go.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct ImportNames {
    /// The names between the dots; a trailing `*` is not included.
    pub path: Vec<String>,
    /// Whether `static` stands there.
    pub is_static: bool,
    /// Whether it ends in `.*`.
    pub is_wildcard: bool,
}

/// The imports of a text, even of one that is broken elsewhere. Takes linear time.
pub fn imports(text: &str) -> Vec<ImportNames> {
    if !text.contains("import") {
        return vec![];
    }
    let mut found: Vec<ImportNames> = vec![];
    let mut is_open = false;
    for token in scan(text).tokens {
        let word = &text[token.start..token.end];
        let is_name = token.kind == TokenKind::Word;
        match (word, found.last_mut()) {
            ("import", _) => {
                is_open = true;
                found.push(ImportNames {
                    path: vec![],
                    is_static: false,
                    is_wildcard: false,
                });
            }
            ("static", Some(import)) if is_open && import.path.is_empty() => {
                import.is_static = true;
            }
            (name, Some(import)) if is_open && is_name => import.path.push(name.to_owned()),
            ("*" | ".*", Some(import)) if is_open => import.is_wildcard = true,
            (".", Some(_)) if is_open => {}
            _ => is_open = false,
        }
    }
    found.retain(|import| !import.path.is_empty());
    found
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn imports_are_found_in_broken_texts_and_not_in_comments() {
        let text = "import static sub.Params.*; // import a.B;\nimport a.B;\nimport static c.D.e;\n\
                    String s = \"import x.Y;\"; module A( ==> {{ import java . lang .*;";
        let told: Vec<String> = imports(text)
            .iter()
            .map(|i| format!("{} {} {}", i.path.join("."), i.is_static, i.is_wildcard))
            .collect();
        assert_eq!(
            told,
            [
                "sub.Params true true",
                "a.B false false",
                "c.D.e true false",
                "java.lang false true"
            ]
        );
    }
}
