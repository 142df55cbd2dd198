//! Opening a place of the model in the user's editor.
//!
//! The page only says which file of the model, by number, and which line: a link such as `vscode://file/…` would need the
//! path on the page, and would fit one editor only.

use std::ffi::OsString;
use std::io;
use std::path::Path;
use std::process::{Command, Stdio};

/// How editors with a window of their own are told a place. Editors that live in a terminal cannot be opened from here.
const KNOWN: [(&[&str], &[&str]); 6] = [
    (
        &[
            "code",
            "code-insiders",
            "codium",
            "vscodium",
            "cursor",
            "windsurf",
        ],
        &["--goto", "{file}:{line}:{column}"],
    ),
    (
        &["subl", "sublime_text", "zed", "zeditor", "atom"],
        &["{file}:{line}:{column}"],
    ),
    (
        &["gedit", "gnome-text-editor"],
        &["{file}", "+{line}:{column}"],
    ),
    (
        &["gvim", "mvim", "emacsclient", "mousepad"],
        &["+{line}", "{file}"],
    ),
    (
        &["kate", "kwrite"],
        &["--line", "{line}", "--column", "{column}", "{file}"],
    ),
    (
        &["idea", "pycharm", "webstorm", "clion", "rustrover"],
        &["--line", "{line}", "{file}"],
    ),
];

/// A command that opens files.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Editor {
    words: Vec<String>,
}

impl Editor {
    /// The command that the user wants: a program and its arguments, with `{file}`, `{line}` and `{column}` where those
    /// belong. Of known editors the program alone is enough.
    ///
    /// # Errors
    /// If it is neither.
    pub fn parse(command: &str) -> Result<Self, String> {
        let mut words: Vec<String> = command.split_whitespace().map(str::to_owned).collect();
        let Some(program) = words.first() else {
            return Err("the editor's command is empty".to_owned());
        };
        if !words.iter().any(|word| word.contains("{file}")) {
            let known = arguments(program).ok_or_else(|| {
                format!(
                    "where does `{program}` want the place? Write `{program} … {{file}} … {{line}}`"
                )
            })?;
            words.extend(known.iter().map(|&word| word.to_owned()));
        }
        Ok(Self { words })
    }

    /// The editor that the user's environment names in `VISUAL` or `EDITOR`, if it is known to open a window.
    pub fn of_environment() -> Option<Self> {
        let named = ["VISUAL", "EDITOR"].iter().filter_map(std::env::var_os);
        named
            .filter_map(|command| Self::parse(&command.into_string().ok()?).ok())
            .next()
    }

    /// Opens a place; line and column count from 1. Does not wait for the editor to end.
    ///
    /// # Errors
    /// If the program cannot be started.
    pub fn open(&self, file: &Path, line: usize, column: usize) -> io::Result<()> {
        let words = self.filled(file, line, column);
        let Some((program, arguments)) = words.split_first() else {
            return Ok(());
        };
        let mut child = Command::new(program)
            .args(arguments)
            .stdin(Stdio::null())
            .stdout(Stdio::null())
            .stderr(Stdio::null())
            .spawn()?;
        // Somebody has to hear that it ended, or the system keeps its number.
        std::thread::spawn(move || child.wait());
        Ok(())
    }

    fn filled(&self, file: &Path, line: usize, column: usize) -> Vec<OsString> {
        let fill = |word: &String| {
            let word = word
                .replace("{line}", &line.to_string())
                .replace("{column}", &column.to_string());
            let mut parts = word.split("{file}");
            let mut filled = OsString::from(parts.next().unwrap_or(""));
            for part in parts {
                filled.push(file);
                filled.push(part);
            }
            filled
        };
        self.words.iter().map(fill).collect()
    }
}

fn arguments(program: &str) -> Option<&'static [&'static str]> {
    let name = Path::new(program).file_stem()?.to_str()?;
    let known = KNOWN.iter().find(|(names, _)| names.contains(&name));
    known.map(|(_, arguments)| *arguments)
}

#[cfg(test)]
mod tests {
    use super::*;

    fn command(editor: &str) -> Vec<OsString> {
        let editor = Editor::parse(editor).unwrap();
        editor.filled(Path::new("a b/p.rgg"), 7, 3)
    }

    #[test]
    fn known_editors_and_patterns_are_filled_in() {
        assert_eq!(
            command("code -n"),
            ["code", "-n", "--goto", "a b/p.rgg:7:3"]
        );
        assert_eq!(
            command("/opt/bin/gvim"),
            ["/opt/bin/gvim", "+7", "a b/p.rgg"]
        );
        assert_eq!(
            command("term -e vim +{line} {file}"),
            ["term", "-e", "vim", "+7", "a b/p.rgg"]
        );
    }

    #[test]
    fn unknown_editors_need_a_pattern() {
        assert!(Editor::parse("vim").unwrap_err().contains("{file}"));
        assert!(Editor::parse(" ").is_err());
    }
}
