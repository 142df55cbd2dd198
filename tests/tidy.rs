//! Rules about the source text itself: what the house style promises, a machine checks.

#![allow(clippy::unwrap_used, reason = "a test fails by panicking")]

use std::fs;
use std::path::{Path, PathBuf};

/// Longest non-test part of a file, in lines.
const LONGEST_FILE: usize = 500;
/// Files that may be longer: lists of kinds, one entry after the other.
const LONG_FILES: [&str; 3] = [
    "src/syntax/ast.rs",
    "src/check/model.rs",
    "src/turtle/table.rs",
];

/// A source file, without its tests.
struct Source {
    name: String,
    code: Vec<(usize, String)>,
    whole: String,
}

fn root() -> &'static Path {
    Path::new(env!("CARGO_MANIFEST_DIR"))
}

fn sources() -> Vec<Source> {
    let mut files = Vec::new();
    collect(&root().join("src"), &mut files);
    files.sort();
    assert!(
        files.len() > 20,
        "the sources are not where they were: {}",
        files.len()
    );
    files.iter().map(|file| source(file)).collect()
}

fn collect(folder: &Path, files: &mut Vec<PathBuf>) {
    for entry in fs::read_dir(folder).unwrap() {
        let path = entry.unwrap().path();
        if path.is_dir() {
            collect(&path, files);
        } else if path.extension().is_some_and(|suffix| suffix == "rs") {
            files.push(path);
        }
    }
}

fn source(file: &Path) -> Source {
    let whole = fs::read_to_string(file).unwrap();
    let name = file
        .strip_prefix(root())
        .unwrap()
        .to_string_lossy()
        .replace('\\', "/");
    let is_test_file = name.ends_with("/tests.rs") || name.contains("/tests/");
    let lines = whole
        .lines()
        .enumerate()
        .map(|(i, line)| (i + 1, line.to_owned()));
    let code = lines
        .take_while(|(_, line)| !is_test_file && !line.starts_with("#[cfg(test)]"))
        .collect();
    Source { name, code, whole }
}

/// What stands before a `//` comment.
fn without_comment(line: &str) -> &str {
    line.split("//").next().unwrap_or("")
}

/// The modules of the ladder, bottom first, as `src/lib.rs` lists them.
fn ladder() -> Vec<String> {
    let text = fs::read_to_string(root().join("src/lib.rs")).unwrap();
    let modules = text
        .lines()
        .filter_map(|line| line.strip_prefix("pub mod ")?.strip_suffix(';'));
    modules.map(str::to_owned).collect()
}

/// The first folder or file name below `src/`.
fn top_module(name: &str) -> &str {
    let inside = name.strip_prefix("src/").unwrap();
    inside.split('/').next().unwrap().trim_end_matches(".rs")
}

/// The modules that a line names as `crate::NAME`, also inside `crate::{…}` on one line.
fn named_modules(line: &str) -> Vec<String> {
    let word = |text: &str| -> String {
        text.chars()
            .take_while(|c| c.is_alphanumeric() || *c == '_')
            .collect()
    };
    let after = line.split("crate::").skip(1);
    after
        .flat_map(|rest| match rest.strip_prefix('{') {
            Some(list) => list
                .split(['}', ';'])
                .next()
                .unwrap()
                .split(',')
                .map(str::trim)
                .collect(),
            None => vec![rest],
        })
        .map(word)
        .filter(|name| !name.is_empty())
        .collect()
}

#[test]
fn dependencies_point_down_the_ladder() {
    let ladder = ladder();
    assert_eq!(ladder.first().map(String::as_str), Some("math"));
    let rung = |name: &str| ladder.iter().position(|module| module == name);
    let mut wrong = Vec::new();
    for file in sources() {
        let top = top_module(&file.name);
        if ["lib", "main"].contains(&top) {
            continue;
        }
        let here =
            rung(top).unwrap_or_else(|| panic!("{}: `{top}` is not in src/lib.rs", file.name));
        for (number, line) in &file.code {
            for used in named_modules(without_comment(line)) {
                if rung(&used).is_some_and(|there| there > here) {
                    wrong.push(format!(
                        "{}:{number}: `{top}` must not use `{used}`",
                        file.name
                    ));
                }
            }
        }
    }
    assert!(wrong.is_empty(), "{}", wrong.join("\n"));
}

#[test]
fn files_stay_short() {
    let long: Vec<String> = sources()
        .iter()
        .filter(|file| file.code.len() > LONGEST_FILE && !LONG_FILES.contains(&&*file.name))
        .map(|file| format!("{}: {} lines", file.name, file.code.len()))
        .collect();
    assert!(long.is_empty(), "split these by idea:\n{}", long.join("\n"));
}

#[test]
fn tolerances_live_in_one_file() {
    let mut stray = Vec::new();
    for file in sources() {
        if file.name == "src/math/tolerance.rs" {
            continue;
        }
        for (number, line) in &file.code {
            let code = without_comment(line);
            let is_tolerance = code.match_indices("e-").any(|(at, _)| {
                let before = &code[..at];
                let digits =
                    before.len() - before.trim_end_matches(|c: char| c.is_ascii_digit()).len();
                digits > 0 && code[at + 2..].starts_with(|c: char| c.is_ascii_digit())
            });
            if is_tolerance {
                stray.push(format!("{}:{number}: {}", file.name, line.trim()));
            }
        }
    }
    assert!(
        stray.is_empty(),
        "move these to src/math/tolerance.rs:\n{}",
        stray.join("\n")
    );
}

#[test]
fn only_the_shell_touches_the_machine() {
    let ladder = ladder();
    let shell = ladder
        .iter()
        .position(|module| module == "pipeline")
        .unwrap();
    let mut wrong = Vec::new();
    for file in sources() {
        let rung = ladder
            .iter()
            .position(|module| module == top_module(&file.name));
        if rung.is_none_or(|rung| rung >= shell) {
            continue;
        }
        for (number, line) in &file.code {
            let code = without_comment(line);
            let contact = [
                "std::fs",
                "std::env",
                "std::process",
                "Instant::now",
                "SystemTime",
                "println!",
                "eprint",
            ];
            if let Some(what) = contact.iter().find(|what| code.contains(**what)) {
                wrong.push(format!("{}:{number}: {what}", file.name));
            }
        }
    }
    assert!(wrong.is_empty(), "{}", wrong.join("\n"));
}

#[test]
fn cited_works_are_listed() {
    let list = fs::read_to_string(root().join("src/references.rs")).unwrap();
    let keys: Vec<&str> = list
        .lines()
        .filter_map(|line| line.strip_prefix("//! # "))
        .collect();
    let mut unknown = Vec::new();
    for file in sources() {
        for cited in file.whole.split("Source: [").skip(1) {
            let key = cited.split([']', ' ', ',']).next().unwrap();
            if !keys.contains(&key.trim_start_matches('`').trim_end_matches('`')) {
                unknown.push(format!("{}: {key}", file.name));
            }
        }
    }
    assert!(
        unknown.is_empty(),
        "add to src/references.rs:\n{}",
        unknown.join("\n")
    );
}

#[test]
fn the_readme_lists_the_options_as_they_are() {
    let Ok(readme) = fs::read_to_string(root().join("README.md")) else {
        return;
    };
    let (start, end) = ("<!-- options -->\n", "<!-- /options -->");
    let shown = readme
        .split(start)
        .nth(1)
        .and_then(|rest| rest.split(end).next());
    let table = understory::options::explain::markdown();
    let message = "put this between `<!-- options -->` and `<!-- /options -->` in README.md";
    assert!(shown == Some(&*table), "{message}:\n{table}");
}
