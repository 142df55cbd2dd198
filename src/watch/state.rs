//! What the page shows: one object that is sent whole whenever a part of it changes.

use super::problems::Problem;
use crate::camera::View;
use crate::options::{Options, Origin};
use crate::pipeline::constants::{Constant, Kind};
use crate::pipeline::report::{PhaseSeconds, Work};
use serde::Serialize;
use std::collections::BTreeMap;

/// What the page shows.
#[derive(Clone, Debug, Default, Serialize)]
pub struct State {
    /// The model's name.
    pub name: String,
    /// What is being done.
    pub activity: Activity,
    /// How far it is, 0 to 1, where that is known.
    pub progress: Option<f64>,
    /// The run on files as they are now, from 1: how often there was something to do.
    pub round: u64,
    /// Names of the files that changed last.
    pub changed: Vec<String>,
    /// Whether a newer wish waits for what is being done.
    pub is_queued: bool,
    /// Seconds that the last picture took, by phase.
    pub seconds: PhaseSeconds,
    /// How often each stage has run since the program began.
    pub work: Work,
    /// The picture that can be fetched.
    pub frame: Option<Frame>,
    /// Where it is taken from.
    pub view: Option<ViewPoint>,
    /// The options as they stand.
    pub options: BTreeMap<&'static str, Value>,
    /// The model's numbers that can be changed.
    pub constants: Vec<Number>,
    /// What is wrong.
    pub problems: Vec<Problem>,
    /// The command that makes this picture.
    pub command: String,
    /// Whether places can be opened in an editor.
    pub has_editor: bool,
}

/// What is being done.
#[derive(Clone, Debug, PartialEq, Serialize)]
#[serde(rename_all = "lowercase")]
pub enum Activity {
    /// A stage of a run: `growing`, say.
    Busy(&'static str),
    /// The picture is as good as it was asked for.
    Done,
    /// Something is wrong; the next change or wish is awaited.
    Failed,
}

impl Default for Activity {
    fn default() -> Self {
        Self::Busy("reading")
    }
}

/// A picture that can be fetched.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
pub struct Frame {
    /// Its number; later ones are larger.
    pub number: u64,
    /// Columns of its pixels.
    pub width: u32,
    /// Rows.
    pub height: u32,
    /// Whether it is the picture that was asked for, with all its samples.
    pub is_final: bool,
    /// Samples per pixel; of a draft, which has fewer pixels, 0.
    pub samples: u32,
    /// Estimated relative error.
    pub error: Option<f64>,
}

/// Where a picture is taken from, in metres and degrees.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
pub struct ViewPoint {
    /// Where the camera stands.
    pub eye: [f64; 3],
    /// What it looks at.
    pub target: [f64; 3],
    /// What is up.
    pub up: [f64; 3],
    /// Vertical field of view in degrees.
    pub fov: f64,
}

impl From<View> for ViewPoint {
    fn from(view: View) -> Self {
        Self {
            eye: view.eye.to_array(),
            target: view.target.to_array(),
            up: view.up.to_array(),
            fov: view.fov.degrees(),
        }
    }
}

/// An option as it stands.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Value {
    /// Its value as it was written.
    pub text: String,
    /// `default`, `preset`, `file` or `flag`.
    pub origin: &'static str,
}

/// Options that the page shows.
const SHOWN: [&str; 10] = [
    "renderer",
    "quality",
    "samples",
    "size",
    "steps",
    "seed",
    "sun",
    "exposure",
    "fov",
    "max-depth",
];

/// The options that the page shows.
pub fn values(options: &Options) -> BTreeMap<&'static str, Value> {
    let entries = options.entries();
    let shown = entries
        .into_iter()
        .filter(|entry| SHOWN.contains(&entry.row.key));
    let values = shown.map(|entry| {
        let origin = match entry.origin {
            Origin::Default => "default",
            Origin::Preset(_) => "preset",
            Origin::Chosen { .. } => "chosen",
            Origin::Sidecar(_) => "file",
            Origin::Flag => "flag",
        };
        let text = entry.text.to_owned();
        (entry.row.key, Value { text, origin })
    });
    values.collect()
}

/// A number of the model.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Number {
    /// Its name with that of its class.
    pub id: String,
    /// Its name alone.
    pub name: String,
    /// Whether it is whole.
    pub is_whole: bool,
    /// Its value as it stands in the file.
    pub text: String,
    /// The remark behind it.
    pub remark: String,
}

impl From<&Constant> for Number {
    fn from(constant: &Constant) -> Self {
        Self {
            id: constant.id(),
            name: constant.name.clone(),
            is_whole: constant.kind == Kind::Whole,
            text: constant
                .text
                .trim_end_matches(['f', 'F', 'd', 'D'])
                .to_owned(),
            remark: constant.remark.clone(),
        }
    }
}
