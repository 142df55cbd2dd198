//! The table of options as people read it.

use super::table::{Command, Entry, Section, TABLE};
use super::{Options, Origin};
use crate::diag::SourceMap;
use std::fmt::Write;

/// Each option that `command` knows with its value and where that came from, one a line.
///
/// `sources` must hold the file beside the model if there is one.
pub fn explain(options: &Options, command: Command, sources: &SourceMap) -> String {
    let entries = options.entries();
    let known: Vec<&Entry<'_>> = entries
        .iter()
        .filter(|entry| entry.row.commands.contains(&command))
        .collect();
    let width = |of: fn(&Entry<'_>) -> usize| known.iter().map(|e| of(e)).max().unwrap_or(0);
    let (keys, texts) = (width(|e| e.row.key.len()), width(|e| e.text.len()));
    let mut out = String::new();
    for entry in known {
        let origin = describe(entry.origin, sources);
        let _ = writeln!(
            out,
            "{:keys$}  {:texts$}  {origin}",
            entry.row.key, entry.text
        );
    }
    out
}

/// Where a value came from, for people.
pub fn describe(origin: Origin, sources: &SourceMap) -> String {
    match origin {
        Origin::Default => "default".into(),
        Origin::Preset(name) => format!("preset {name}"),
        Origin::Chosen { .. } => "chosen".into(),
        Origin::Sidecar(span) => {
            let name = sources.file(span.file).map_or("file", |file| &file.name);
            format!("{name}:{}", sources.line_column(span).0)
        }
        Origin::Flag => "command line".into(),
    }
}

/// The table for the README, in Markdown.
pub fn markdown() -> String {
    let mut out = String::from(
        "| option | default | what it does | section of `NAME.toml` |\n|---|---|---|---|\n",
    );
    for section in Section::ALL {
        for row in TABLE.iter().filter(|row| row.section == section) {
            let unit = if row.is_switch() {
                String::new()
            } else {
                format!(" {}", row.unit)
            };
            let heading = match section {
                Section::Model => "(top)".into(),
                other => format!("`[{}]`", other.heading()),
            };
            let default = if row.is_switch() {
                "off".into()
            } else {
                format!("`{}`", row.default)
            };
            let doc = row.doc.replace('|', "\\|");
            let _ = writeln!(
                out,
                "| `--{}{unit}` | {default} | {doc} | {heading} |",
                row.key
            );
        }
    }
    out
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn each_value_is_shown_with_its_origin() {
        let mut sources = SourceMap::default();
        let file = sources.add("plant.toml", "\n[render]\nmax-depth = 3\n");
        let mut options = Options::default();
        let found = options.read_sidecar(file, "\n[render]\nmax-depth = 3\n");
        assert!(found.is_empty());
        options.set("quality", "draft", Origin::Flag).unwrap();
        options.apply_preset();
        let text = explain(&options, Command::Render, &sources);
        let line = |key: &str| {
            let line = text.lines().find(|line| line.starts_with(key)).unwrap();
            line.split_whitespace().collect::<Vec<_>>().join(" ")
        };
        assert_eq!(line("quality"), "quality draft command line");
        assert_eq!(line("samples"), "samples 8 preset draft");
        assert_eq!(line("max-depth"), "max-depth 3 plant.toml:3");
        assert_eq!(line("fov"), "fov 40 default");
        assert!(!text.contains("flight-frames"));
    }

    #[test]
    fn the_readme_table_has_a_line_for_each_option() {
        assert_eq!(markdown().lines().count(), TABLE.len() + 2);
    }
}
