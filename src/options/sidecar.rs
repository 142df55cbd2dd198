//! The file beside a model: what is not growth, in TOML.
//!
//! ```toml
//! steps = 7
//! [camera]
//! eye = [10, -20, 5]
//! [render]
//! samples = 128
//! ```
//! Keys are those of the command line. Everything wrong is reported at its place, all of it at once.

use super::Options;
use super::setting::{Origin, SetError};
use super::table::{OptionRow, Section, TABLE};
use crate::animation::key::{KeyFrame, KeyFrames, no_time};
use crate::diag::{Diagnostic, Diagnostics, FileId, Span, nearest};
use std::ops::Range;
use toml::Spanned;
use toml::de::{DeArray, DeTable, DeValue};

impl Options {
    /// Takes over the values of `text`, the content of `file`.
    pub fn read_sidecar(&mut self, file: FileId, text: &str) -> Diagnostics {
        let mut reader = Reader {
            options: self,
            file,
            found: Diagnostics::default(),
        };
        let (table, errors) = DeTable::parse_recoverable(text);
        for error in errors {
            let place = reader.span(error.span().unwrap_or(0..0));
            let message = error.message().trim_end().replace('\n', "; ");
            reader
                .found
                .push(Diagnostic::error("toml-syntax", place, message));
        }
        reader.section(Section::Model, table.get_ref());
        reader.found
    }
}

struct Reader<'a> {
    options: &'a mut Options,
    file: FileId,
    found: Diagnostics,
}

impl Reader<'_> {
    fn span(&self, range: Range<usize>) -> Span {
        Span::new(self.file, range.start, range.end)
    }

    /// Reads the keys of one section; tables in the top section are the other sections.
    fn section(&mut self, section: Section, table: &DeTable<'_>) {
        for (key, value) in table {
            let name: &str = key.get_ref();
            let place = self.span(key.span());
            if let (Section::Model, DeValue::Table(inner)) = (section, value.get_ref()) {
                self.heading(name, place, inner);
                continue;
            }
            if let (Section::Fly, "key", DeValue::Array(frames)) = (section, name, value.get_ref())
            {
                self.key_frames(place, frames);
                continue;
            }
            match TABLE.iter().find(|row| row.key == name) {
                Some(row) if row.section == section => self.value(row, value),
                Some(row) => self.misplaced(row, section, place),
                None => self.unknown(name, place),
            }
        }
    }

    /// Reads the tables `[[fly.key]]`.
    fn key_frames(&mut self, heading: Span, tables: &DeArray<'_>) {
        let places: Vec<Span> = tables.iter().map(|item| self.span(item.span())).collect();
        let mut read = Vec::new();
        for (i, (item, place)) in tables.iter().zip(&places).enumerate() {
            read.push(match item.get_ref() {
                DeValue::Table(table) => self.key_frame(i, *place, table),
                other => {
                    let kind = other.type_str();
                    self.key_fault(
                        *place,
                        format!("a key frame is a table `[[fly.key]]`, not a value of type {kind}"),
                    );
                    None
                }
            });
        }
        // What is wrong with one of them hides what is wrong with them together.
        let Some(frames) = read.into_iter().collect() else {
            return;
        };
        match KeyFrames::new(frames) {
            Ok(keys) => {
                let origin = Origin::Sidecar(places.first().copied().unwrap_or(heading));
                self.options
                    .set("key", &keys.to_string(), origin)
                    .expect("invariant: key frames are read as they are written");
            }
            Err((i, why)) => self.key_fault(places.get(i).copied().unwrap_or(heading), why),
        }
    }

    /// A key frame (counted from 0), if nothing is wrong with it.
    fn key_frame(&mut self, i: usize, place: Span, table: &DeTable<'_>) -> Option<KeyFrame> {
        let mut frame = KeyFrame::default();
        let mut is_good = true;
        for (key, value) in table {
            let (name, place) = (key.get_ref(), self.span(value.span()));
            let set = match plain(value.get_ref()) {
                Some(text) => frame.set(name, &text),
                None => {
                    let kind = value.get_ref().type_str();
                    Err(format!(
                        "`{name}` of a key frame cannot be a value of type {kind}"
                    ))
                }
            };
            if let Err(why) = set {
                is_good = false;
                self.key_fault(place, why);
            }
        }
        if table.get("time").is_none() {
            is_good = false;
            self.key_fault(place, no_time(i));
        }
        is_good.then_some(frame)
    }

    fn key_fault(&mut self, place: Span, message: String) {
        self.found
            .push(Diagnostic::error("key-frame", place, message));
    }

    fn heading(&mut self, name: &str, place: Span, table: &DeTable<'_>) {
        let headings = || Section::ALL.into_iter().filter(|s| *s != Section::Model);
        if let Some(section) = headings().find(|s| s.heading() == name) {
            self.section(section, table);
            return;
        }
        let near = nearest(name, headings().map(Section::heading));
        let error = Diagnostic::error(
            "unknown-section",
            place,
            format!("unknown section `[{name}]`"),
        );
        self.found.push(match near {
            Some(near) => error.hint(format!("did you mean `[{near}]`?")),
            None => error.hint("the sections are `[camera]`, `[render]`, `[sky]` and `[fly]`"),
        });
    }

    fn unknown(&mut self, name: &str, place: Span) {
        let error = Diagnostic::error("unknown-option", place, format!("unknown option `{name}`"));
        self.found
            .push(match nearest(name, TABLE.iter().map(|row| row.key)) {
                Some(near) => error.hint(format!("did you mean `{near}`?")),
                None => error.hint("`understory render --help` lists them"),
            });
    }

    fn misplaced(&mut self, row: &OptionRow, section: Section, place: Span) {
        let (key, here) = (row.key, describe(section));
        let error = Diagnostic::error(
            "misplaced-option",
            place,
            format!("option `{key}` stands {here}"),
        );
        self.found
            .push(error.hint(format!("it belongs {}", describe(row.section))));
    }

    fn value(&mut self, row: &'static OptionRow, value: &Spanned<DeValue<'_>>) {
        let place = self.span(value.span());
        let Some(text) = plain(value.get_ref()) else {
            let kind = value.get_ref().type_str();
            let message = format!("option `{}` cannot be a value of type {kind}", row.key);
            self.found
                .push(Diagnostic::error("option-value", place, message));
            return;
        };
        match self.options.set(row.key, &text, Origin::Sidecar(place)) {
            Ok(()) => {}
            Err(error @ (SetError::Value { .. } | SetError::Unknown { .. })) => {
                self.found
                    .push(Diagnostic::error("option-value", place, error.to_string()));
            }
        }
    }
}

fn describe(section: Section) -> String {
    match section {
        Section::Model => "before the first section".into(),
        other => format!("in section `[{}]`", other.heading()),
    }
}

/// The value as it would be written on the command line.
fn plain(value: &DeValue<'_>) -> Option<String> {
    match value {
        DeValue::String(text) => Some(text.to_string()),
        DeValue::Integer(number) => {
            let digits = number.as_str().replace('_', "");
            i64::from_str_radix(&digits, number.radix())
                .ok()
                .map(|n| n.to_string())
        }
        DeValue::Float(number) => Some(number.as_str().replace('_', "")),
        DeValue::Boolean(truth) => Some(truth.to_string()),
        DeValue::Array(items) => {
            let items: Option<Vec<String>> = items.iter().map(|v| plain(v.get_ref())).collect();
            Some(items?.join(","))
        }
        DeValue::Datetime(_) | DeValue::Table(_) => None,
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::diag::SourceMap;
    use glam::DVec3;

    fn read(text: &str) -> (Options, Vec<String>) {
        let mut sources = SourceMap::default();
        let file = sources.add("plant.toml", text);
        let mut options = Options::default();
        let found = options.read_sidecar(file, text);
        let line = |d: &Diagnostic| {
            let at = d
                .primary
                .as_ref()
                .map_or(0, |p| sources.line_column(p.span).0);
            format!("{at}: {} ({})", d.message, d.hints.join("; "))
        };
        (options, found.sorted().into_iter().map(line).collect())
    }

    #[test]
    fn keys_are_those_of_the_command_line() {
        let (options, found) = read(
            "steps = 7\nseed = -3\n[camera]\neye = [1, 2.5, 3]\nfov = 30\n[render]\nsize = [64, 48]\n\
             quality = \"draft\"\n[sky]\nsun = [135, 40.0]\nground = \"none\"\n[fly]\norbit = true\nframes = \"0..6\"\n",
        );
        assert_eq!(found, Vec::<String>::new());
        assert_eq!((options.steps.value, options.seed.value), (7, -3));
        assert_eq!(options.eye.value, Some(DVec3::new(1.0, 2.5, 3.0)));
        assert_eq!(options.size.value.width, 64);
        assert_eq!(options.frames.value, Some(0..6));
        assert!(options.orbit.value && matches!(options.steps.origin, Origin::Sidecar(_)));
    }

    #[test]
    fn everything_wrong_is_reported_with_its_line() {
        let (_, found) = read(
            "stpes = 7\nsamples = 4\n[camera]\neye = \"here\"\nfov = 200\n[randar]\nx = 1\n[render]\n\
             size = 1979-05-27\n",
        );
        let expected = [
            "1: unknown option `stpes` (did you mean `steps`?)",
            "2: option `samples` stands before the first section (it belongs in section `[render]`)",
            "4: `eye` must be X,Y,Z (three finite numbers), or `auto`, not `here` ()",
            "5: `fov` must be an angle of more than 0 and less than 180 degrees, not `200` ()",
            "6: unknown section `[randar]` (did you mean `[render]`?)",
            "9: option `size` cannot be a value of type datetime ()",
        ];
        assert_eq!(found, expected);
    }

    #[test]
    fn key_frames_are_tables_and_their_mistakes_have_lines() {
        let (options, found) =
            read("[[fly.key]]\ntime = 0\neye = [0, -9, 2]\n[[fly.key]]\ntime = 1.5\nstep = 3\n");
        assert_eq!(found, Vec::<String>::new());
        assert_eq!(options.key.text, "time=0 eye=0,-9,2; time=1.5 step=3");
        let (_, found) = read(
            "[[fly.key]]\ntime = 0\ntagret = [1, 2, 3]\n[[fly.key]]\neye = [1, nan, 2]\n[fly]\nkey = 3\n",
        );
        assert!(
            found
                .iter()
                .any(|line| line
                    .starts_with("3: a key frame has no `tagret`: did you mean `target`?")),
            "{found:?}"
        );
        assert!(
            found
                .iter()
                .any(|line| line.starts_with("5: `eye` must be X,Y,Z")),
            "{found:?}"
        );
        assert!(
            found
                .iter()
                .any(|line| line.contains("key frame 2 has no `time`")),
            "{found:?}"
        );
        let (_, found) = read("[[fly.key]]\ntime = 2\n[[fly.key]]\ntime = 1\n");
        assert!(
            found[0].starts_with("3: key frame 2 is at 1 s, not after"),
            "{found:?}"
        );
        let (_, found) = read("[[fly.key]]\ntime = 2\n");
        assert!(
            found[0].starts_with("1: one key frame is no flight"),
            "{found:?}"
        );
        let (_, found) = read("[fly]\nkey = []\n");
        assert!(found[0].contains("no key frames"), "{found:?}");
    }

    #[test]
    fn broken_toml_is_an_error_at_its_line() {
        let (options, found) = read("steps = 3\n[camera\nfov = 30\n");
        assert!(found.iter().any(|f| f.starts_with("2: ")), "{found:?}");
        assert_eq!(options.steps.value, 3);
    }
}
