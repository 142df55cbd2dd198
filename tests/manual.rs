//! What is written about the language follows the tables of the program.

#![allow(clippy::unwrap_used, reason = "a test fails by panicking")]

use serde_json::Value;
use std::collections::BTreeSet;
use std::fs;
use std::path::Path;
use understory::library::{ClassId, FunctionId, constants};
use understory::manual::words::{AGGREGATES, KEYWORDS};
use understory::turtle::{Effect, builtin_types};

#[test]
fn the_reference_page_follows_the_tables() {
    let path = Path::new(env!("CARGO_MANIFEST_DIR")).join("grammar/REFERENCE.md");
    let page = understory::manual::page::markdown();
    if std::env::var_os("UPDATE").is_some() {
        fs::write(&path, &page).unwrap();
    }
    let shown = fs::read_to_string(&path).unwrap_or_default();
    assert!(
        shown == page,
        "grammar/REFERENCE.md is stale; renew it with `UPDATE=1 cargo test --test manual`"
    );
}

/// The lists of words that the highlighting knows: entry of the grammar and its words.
fn word_lists() -> Vec<(&'static str, BTreeSet<&'static str>)> {
    let commands = |is_wanted: &dyn Fn(Effect) -> bool| -> BTreeSet<&'static str> {
        let rows = builtin_types().filter(|row| is_wanted(row.effect));
        rows.map(|row| row.name).collect()
    };
    let is_thing = |effect| {
        matches!(
            effect,
            Effect::Draw(_) | Effect::None | Effect::Group | Effect::Instance
        )
    };
    let primitives = [
        "boolean", "byte", "short", "char", "int", "long", "float", "double", "void", "String",
        "Object",
    ];
    let control = [
        "if",
        "else",
        "for",
        "while",
        "do",
        "switch",
        "case",
        "default",
        "break",
        "continue",
        "return",
        "throw",
        "try",
        "catch",
        "finally",
        "new",
        "instanceof",
        "import",
        "package",
    ];
    let values = ["true", "false", "null"];
    let this = ["this", "super"];
    let rest = KEYWORDS.iter().map(|word| word.name);
    let is_storage = |name: &&str| {
        !primitives.contains(name)
            && !control.contains(name)
            && !values.contains(name)
            && !this.contains(name)
    };
    let owners = FunctionId::ALL
        .iter()
        .map(|id| id.signature().owner)
        .filter(|owner| !owner.contains('.'));
    let classes = ClassId::ALL
        .iter()
        .map(|class| class.name())
        .chain(owners)
        .filter(|name| !name.is_empty());
    let is_class = |name: &&str| !primitives.contains(name);
    let aggregates: BTreeSet<&str> = AGGREGATES.iter().map(|word| word.name).collect();
    let functions = FunctionId::ALL.iter().map(|id| id.signature());
    let functions = functions
        .filter(|row| row.owner != "Attributes")
        .map(|row| row.name);
    vec![
        ("control", control.into()),
        ("storage", rest.filter(is_storage).collect()),
        ("primitives", primitives.into()),
        ("values", values.into()),
        ("this", this.into()),
        ("commands", commands(&|effect| !is_thing(effect))),
        ("geometry", commands(&is_thing)),
        ("classes", classes.filter(is_class).collect()),
        (
            "constants",
            // A single letter, such as `Math.E`, is more often a module of the user's.
            constants()
                .iter()
                .map(|row| row.name)
                .filter(|name| name.len() > 1)
                .collect(),
        ),
        (
            "functions",
            functions
                .filter(|name| !aggregates.contains(name))
                .collect(),
        ),
        ("aggregates", aggregates),
    ]
}

#[test]
fn the_highlighting_knows_all_words() {
    let path =
        Path::new(env!("CARGO_MANIFEST_DIR")).join("grammar/vscode/syntaxes/rgg.tmLanguage.json");
    let mut text = fs::read_to_string(&path).unwrap();
    let grammar: Value = serde_json::from_str(&text).unwrap();
    let lists = word_lists();
    for keyword in KEYWORDS {
        assert!(
            lists.iter().any(|(_, words)| words.contains(keyword.name)),
            "{}",
            keyword.name
        );
    }
    for (entry, words) in lists {
        let words: Vec<&str> = words.into_iter().collect();
        let pattern = Value::from(format!("\\b(?:{})\\b", words.join("|")));
        let found = &grammar["repository"][entry];
        if found["match"] != pattern && std::env::var_os("UPDATE").is_some() {
            let head = format!("\"{entry}\": {{ \"name\": {}, \"match\": ", found["name"]);
            text = text.replacen(
                &format!("{head}{}", found["match"]),
                &format!("{head}{pattern}"),
                1,
            );
            fs::write(&path, &text).unwrap();
            continue;
        }
        assert!(
            found["match"] == pattern,
            "`{entry}` in grammar/vscode/syntaxes/rgg.tmLanguage.json is stale; renew it with `UPDATE=1 cargo test --test manual`"
        );
        let is_included = |include: &Value| include["include"] == format!("#{entry}");
        assert!(
            grammar["patterns"]
                .as_array()
                .unwrap()
                .iter()
                .any(is_included),
            "{entry} is not used"
        );
    }
}

#[test]
fn the_extension_is_whole() {
    let folder = Path::new(env!("CARGO_MANIFEST_DIR")).join("grammar/vscode");
    let read = |name: &str| -> Value {
        serde_json::from_str(&fs::read_to_string(folder.join(name)).unwrap()).unwrap()
    };
    let package = read("package.json");
    assert_eq!(package["version"], env!("CARGO_PKG_VERSION"));
    let languages = &package["contributes"]["languages"][0];
    let grammars = &package["contributes"]["grammars"][0];
    for file in [
        &languages["configuration"],
        &grammars["path"],
        &package["main"],
    ] {
        assert!(folder.join(file.as_str().unwrap()).is_file(), "{file}");
    }
    assert_eq!(
        read(grammars["path"].as_str().unwrap())["scopeName"],
        grammars["scopeName"]
    );
    read(languages["configuration"].as_str().unwrap());
}
