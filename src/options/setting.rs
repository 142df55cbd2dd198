//! A value together with where it came from.

use super::value::OptionValue;
use crate::diag::Span;

/// Where the value of an option came from, weakest first.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Origin {
    /// The table of options.
    Default,
    /// The preset of this name (`--quality`).
    Preset(&'static str),
    /// The program, to keep to a wanted time or error (`--time`, `--error`). What the user names is stronger, unless the wish stands on
    /// the command line and the value only in the file beside the model.
    Chosen {
        /// Whether it wins over that file.
        over_file: bool,
    },
    /// The file beside the model, at this place.
    Sidecar(Span),
    /// The command line.
    Flag,
}

impl Origin {
    /// Whether a value from here wins over one from `other`.
    #[must_use]
    pub fn beats(self, other: Self) -> bool {
        self.rank() > other.rank()
    }

    fn rank(self) -> u8 {
        match self {
            Self::Default => 0,
            Self::Preset(_) => 1,
            Self::Chosen { over_file: false } => 2,
            Self::Sidecar(_) => 3,
            Self::Chosen { over_file: true } => 4,
            Self::Flag => 5,
        }
    }
}

/// The value of one option.
#[derive(Clone, Debug, PartialEq)]
pub struct Setting<T> {
    /// The value.
    pub value: T,
    /// The value as it was written.
    pub text: String,
    /// Who wrote it.
    pub origin: Origin,
}

/// Why an option cannot be set so.
#[derive(Clone, Debug, PartialEq, Eq, thiserror::Error)]
pub enum SetError {
    /// There is no option of this name.
    #[error("there is no option `{key}`{}", hint(*.nearest))]
    Unknown {
        /// What was written.
        key: String,
        /// The nearest name there is.
        nearest: Option<&'static str>,
    },
    /// The value is not one of its kind.
    #[error("`{key}` must be {expected}, not `{text}`")]
    Value {
        /// The option.
        key: &'static str,
        /// What is allowed.
        expected: String,
        /// What was written.
        text: String,
    },
}

fn hint(nearest: Option<&'static str>) -> String {
    nearest.map_or_else(String::new, |name| format!(": did you mean `{name}`?"))
}

impl<T: OptionValue> Setting<T> {
    /// The default of the table.
    ///
    /// # Panics
    /// If the default in the table is not a value of this kind, which a test of the table excludes.
    pub(super) fn from_default(text: &str) -> Self {
        let value = T::parse(text).expect("invariant: defaults of the table parse");
        Self {
            value,
            text: text.to_owned(),
            origin: Origin::Default,
        }
    }

    /// Reads `text`; keeps the old value if its origin is stronger. A default that is a word is named among what is allowed.
    pub(super) fn set(
        &mut self,
        (key, default): (&'static str, &'static str),
        text: &str,
        origin: Origin,
    ) -> Result<(), SetError> {
        let value = T::parse(text).map_err(|expected| {
            let word = matches!(default, "auto" | "none").then(|| format!("`{default}`"));
            let word = word.filter(|word| !expected.contains(word));
            let word = word.map_or_else(String::new, |word| format!(", or {word}"));
            SetError::Value {
                key,
                expected: expected + &word,
                text: text.to_owned(),
            }
        })?;
        if origin.rank() >= self.origin.rank() {
            *self = Self {
                value,
                text: text.to_owned(),
                origin,
            };
        }
        Ok(())
    }
}
