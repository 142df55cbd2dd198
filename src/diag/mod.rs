//! Where something stands in the user's files, and what is wrong there.
//!
//! Phases that read a model collect [`Diagnostic`]s and go on; only [`render`] turns them into text for people.

pub mod render;

use std::sync::Arc;

/// One source file of a run.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Hash, Default)]
pub struct FileId(pub u16);

/// A range of bytes in one source file, half open.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Hash, Default)]
pub struct Span {
    /// The file.
    pub file: FileId,
    /// First byte.
    pub start: u32,
    /// One past the last byte.
    pub end: u32,
}

impl Span {
    /// The range `start..end` of `file`.
    pub fn new(file: FileId, start: usize, end: usize) -> Self {
        let clamp = |at: usize| u32::try_from(at).unwrap_or(u32::MAX);
        Self {
            file,
            start: clamp(start),
            end: clamp(end),
        }
    }

    /// The smallest range of one file that holds both; `self` if the files differ.
    #[must_use]
    pub fn to(self, other: Self) -> Self {
        if self.file != other.file {
            return self;
        }
        Self {
            file: self.file,
            start: self.start.min(other.start),
            end: self.end.max(other.end),
        }
    }
}

/// The texts of a run, by [`FileId`].
#[derive(Clone, Debug, Default)]
pub struct SourceMap {
    files: Vec<SourceFile>,
}

/// A named text.
#[derive(Clone, Debug)]
pub struct SourceFile {
    /// The path as the user would write it.
    pub name: Arc<str>,
    /// The whole text.
    pub text: Arc<str>,
}

impl SourceMap {
    /// Adds a file and returns its number.
    pub fn add(&mut self, name: impl Into<Arc<str>>, text: impl Into<Arc<str>>) -> FileId {
        self.files.push(SourceFile {
            name: name.into(),
            text: text.into(),
        });
        FileId(u16::try_from(self.files.len() - 1).unwrap_or(u16::MAX))
    }

    /// Gives the file with this number another text.
    pub fn replace(&mut self, id: FileId, text: impl Into<Arc<str>>) {
        if let Some(file) = self.files.get_mut(usize::from(id.0)) {
            file.text = text.into();
        }
    }

    /// The file with this number, if there is one.
    pub fn file(&self, id: FileId) -> Option<&SourceFile> {
        self.files.get(usize::from(id.0))
    }

    /// All files, in the order in which they were added.
    pub fn files(&self) -> &[SourceFile] {
        &self.files
    }

    /// Line and column (both from 1, column in characters) where `span` begins.
    pub fn line_column(&self, span: Span) -> (usize, usize) {
        let text = self.file(span.file).map_or("", |f| &f.text);
        let mut at = (span.start as usize).min(text.len());
        while !text.is_char_boundary(at) {
            at -= 1;
        }
        let before = &text[..at];
        let line = before.bytes().filter(|&b| b == b'\n').count() + 1;
        let column = before.rsplit('\n').next().unwrap_or("").chars().count() + 1;
        (line, column)
    }
}

/// How bad a diagnostic is.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub enum Severity {
    /// The model cannot run.
    Error,
    /// The model runs, but probably not as meant.
    Warning,
}

/// A place with a remark.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Label {
    /// Where.
    pub span: Span,
    /// What about it; may be empty.
    pub text: String,
}

/// One thing wrong with the user's model.
///
/// Messages are lower case without a final period, names stand in backticks, and the hint says what to do.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Diagnostic {
    /// How bad.
    pub severity: Severity,
    /// A short stable name of this kind of message, such as `unknown-module`.
    pub slug: &'static str,
    /// What is wrong.
    pub message: String,
    /// Where; `None` only where no place exists (an empty file, say).
    pub primary: Option<Label>,
    /// Other places that explain it.
    pub secondary: Vec<Label>,
    /// What to do about it.
    pub hints: Vec<String>,
    /// For run-time errors: what was being done, innermost first ("while applying the rule at line 40 to Bud(3)").
    pub trace: Vec<Doing>,
}

/// A line of what was being done when something failed.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Doing {
    /// What, in words; [`Doing::PLACE`] stands for the place.
    pub text: String,
    /// Where in the model, if that is said.
    pub at: Option<Span>,
}

impl Doing {
    /// What [`render`] replaces by the place in words, such as `line 40`.
    pub const PLACE: &'static str = "{place}";
}

impl Diagnostic {
    /// An error at `span`.
    pub fn error(slug: &'static str, span: Span, message: impl Into<String>) -> Self {
        Self::at(Severity::Error, slug, span, message.into())
    }

    /// A warning at `span`.
    pub fn warning(slug: &'static str, span: Span, message: impl Into<String>) -> Self {
        Self::at(Severity::Warning, slug, span, message.into())
    }

    fn at(severity: Severity, slug: &'static str, span: Span, message: String) -> Self {
        let primary = Some(Label {
            span,
            text: String::new(),
        });
        Self {
            severity,
            slug,
            message,
            primary,
            secondary: vec![],
            hints: vec![],
            trace: vec![],
        }
    }

    /// Adds a remark to the primary place.
    #[must_use]
    pub fn label(mut self, text: impl Into<String>) -> Self {
        if let Some(primary) = &mut self.primary {
            primary.text = text.into();
        }
        self
    }

    /// Adds another place.
    #[must_use]
    pub fn also(mut self, span: Span, text: impl Into<String>) -> Self {
        self.secondary.push(Label {
            span,
            text: text.into(),
        });
        self
    }

    /// Adds advice.
    #[must_use]
    pub fn hint(mut self, text: impl Into<String>) -> Self {
        self.hints.push(text.into());
        self
    }

    /// Adds a line of what was being done.
    #[must_use]
    pub fn during(self, text: impl Into<String>) -> Self {
        self.during_at(text, None)
    }

    /// Adds a line of what was being done; [`Doing::PLACE`] in it stands for the place.
    #[must_use]
    pub fn during_at(mut self, text: impl Into<String>, at: Option<Span>) -> Self {
        let text = text.into();
        self.trace.push(Doing { text, at });
        self
    }
}

/// All that was found wrong so far.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct Diagnostics {
    list: Vec<Diagnostic>,
}

impl Diagnostics {
    /// Adds one.
    pub fn push(&mut self, diagnostic: Diagnostic) {
        self.list.push(diagnostic);
    }

    /// Adds all of `other`.
    pub fn append(&mut self, mut other: Self) {
        self.list.append(&mut other.list);
    }

    /// Whether any of them is an error.
    pub fn has_errors(&self) -> bool {
        self.list.iter().any(|d| d.severity == Severity::Error)
    }

    /// Whether there is none at all.
    pub fn is_empty(&self) -> bool {
        self.list.is_empty()
    }

    /// All of them, to add to.
    pub fn iter_mut(&mut self) -> impl Iterator<Item = &mut Diagnostic> {
        self.list.iter_mut()
    }

    /// All of them, sorted by place.
    pub fn sorted(&self) -> Vec<&Diagnostic> {
        let mut all: Vec<&Diagnostic> = self.list.iter().collect();
        all.sort_by_key(|d| d.primary.as_ref().map(|p| p.span));
        all
    }
}

impl From<Diagnostic> for Diagnostics {
    fn from(diagnostic: Diagnostic) -> Self {
        Self {
            list: vec![diagnostic],
        }
    }
}

/// The candidate nearest to `name` (edit distance at most 3 and less than half its length, or a substring), for hints.
pub fn nearest<'a>(name: &str, candidates: impl IntoIterator<Item = &'a str>) -> Option<&'a str> {
    let limit = (name.chars().count().div_ceil(2)).clamp(1, 3);
    let a = name.to_lowercase();
    let distance = |c: &str| {
        let b = c.to_lowercase();
        let within = a.len() >= 3 && (b.contains(&a) || (c.len() >= 3 && a.contains(&b)));
        // Each letter more or less is one edit; most candidates are told by that.
        let is_near = a.chars().count().abs_diff(b.chars().count()) <= limit;
        is_near
            .then(|| strsim::damerau_levenshtein(&a, &b))
            .filter(|&d| d <= limit)
            .or(within.then_some(limit + 1))
    };
    candidates
        .into_iter()
        .filter_map(|c| Some((distance(c)?, strsim::damerau_levenshtein(name, c), c)))
        .min()
        .map(|(_, _, c)| c)
}
