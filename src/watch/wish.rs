//! What the page asks for beyond what the files and the command line say.

use crate::options::{Options, Origin};
use crate::pipeline::constants::Change;
use serde::Deserialize;
use std::collections::BTreeMap;

/// Options that the page may set. None of them names a file or a budget.
const OPTIONS: [&str; 12] = [
    "eye", "exposure", "fov", "quality", "renderer", "samples", "seed", "size", "steps", "sun",
    "target", "up",
];
/// Those of them that only say from where the picture is taken.
const VIEW: [&str; 4] = ["eye", "fov", "target", "up"];
/// Constants that the page may change at once.
const MOST_CONSTANTS: usize = 1000;
/// Longest side of a picture on the page, in pixels.
const LONGEST_SIDE: u32 = 4096;

/// What the page asks for. All of it is in memory only.
#[derive(Clone, Debug, Default, PartialEq, Eq, Deserialize)]
#[serde(deny_unknown_fields, default)]
pub struct Wish {
    /// Options by key, as they would be written on the command line.
    pub options: BTreeMap<String, String>,
    /// Numbers by the constant's [`id`](crate::pipeline::constants::Constant::id).
    pub constants: BTreeMap<String, String>,
}

impl Wish {
    /// Refuses what cannot be.
    ///
    /// # Errors
    /// What is wrong, for people.
    pub fn check(&self, base: &Options) -> Result<(), String> {
        if let Some(key) = self.options.keys().find(|key| !OPTIONS.contains(&&***key)) {
            return Err(format!("the page cannot set `{key}`"));
        }
        let mut options = base.clone();
        for (key, text) in &self.options {
            options
                .set(key, text, Origin::Flag)
                .map_err(|error| error.to_string())?;
        }
        let size = options.size.value;
        if self.options.contains_key("size") && size.width.max(size.height) > LONGEST_SIDE {
            return Err(format!(
                "pictures on the page have at most {LONGEST_SIDE} pixels along a side"
            ));
        }
        if self.constants.len() > MOST_CONSTANTS {
            return Err(format!("at most {MOST_CONSTANTS} constants can be changed"));
        }
        let is_number = |text: &&String| text.parse::<f64>().is_ok_and(f64::is_finite);
        match self.constants.values().find(|text| !is_number(text)) {
            Some(text) => Err(format!("`{text}` is not a number")),
            None => Ok(()),
        }
    }

    /// The options of the command line with those of the page over them.
    pub fn over(&self, base: &Options) -> Options {
        let mut options = base.clone();
        for (key, text) in &self.options {
            // Checked when it came in.
            let _ = options.set(key, text, Origin::Flag);
        }
        options
    }

    /// The constants it changes.
    pub fn changes(&self) -> Vec<Change> {
        let changes = self.constants.iter().map(|(name, text)| Change {
            name: name.clone(),
            text: text.clone(),
        });
        changes.collect()
    }

    /// Whether the two differ in nothing but the place that the picture is taken from.
    pub fn differs_in_view_only(&self, other: &Self) -> bool {
        let rest = |wish: &Self| -> Vec<(String, String)> {
            let options = wish.options.iter();
            options
                .filter(|(key, _)| !VIEW.contains(&&***key))
                .map(|(key, text)| (key.clone(), text.clone()))
                .collect()
        };
        self.constants == other.constants && rest(self) == rest(other)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn wish(json: &str) -> Wish {
        serde_json::from_str(json).unwrap()
    }

    #[test]
    fn only_harmless_options_with_valid_values_are_taken() {
        let check = |json: &str| wish(json).check(&Options::default());
        assert_eq!(check(r#"{"options":{"steps":"3","eye":"1,2,3"}}"#), Ok(()));
        for bad in [
            r#"{"options":{"sky":"secret.exr"}}"#,
            r#"{"options":{"max-memory":"1"}}"#,
            r#"{"options":{"steps":"-1"}}"#,
            r#"{"options":{"size":"100000x1"}}"#,
            r#"{"constants":{"A.B":"1; x"}}"#,
            r#"{"constants":{"A.B":"inf"}}"#,
        ] {
            assert!(check(bad).is_err(), "{bad}");
        }
        assert!(serde_json::from_str::<Wish>(r#"{"path":"x"}"#).is_err());
    }

    #[test]
    fn a_view_is_only_where_the_picture_is_taken_from() {
        let one = wish(r#"{"options":{"eye":"1,2,3","steps":"3"}}"#);
        let moved = wish(r#"{"options":{"eye":"4,2,3","steps":"3","fov":"20"}}"#);
        let grown = wish(r#"{"options":{"eye":"1,2,3","steps":"4"}}"#);
        assert!(one.differs_in_view_only(&moved));
        assert!(!one.differs_in_view_only(&grown));
        assert!(!one.differs_in_view_only(&wish(r#"{"constants":{"A.B":"1"}}"#)));
    }
}
