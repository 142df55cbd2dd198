//! What a run can be told beside the model itself: one table of options, and where each value came from.
//!
//! An option is one row of [`table`]. From that row come its field, its default, the command-line flag, the key in the
//! file beside the model, the line of `--explain-options` and the line of the README. Values win in the order
//! default < preset < sidecar file < flag, whatever the order in which they are set.
//!
//! This module is plain data: it reads no file and no command line.
//!
//! ```
//! use understory::options::{Options, Origin};
//! let mut options = Options::default();
//! options.set("samples", "16", Origin::Flag).unwrap();
//! options.set("samples", "4", Origin::Preset("draft")).unwrap();
//! assert_eq!(options.samples.value.get(), 16);
//! assert!(options.set("smaples", "1", Origin::Flag).unwrap_err().to_string().contains("`samples`"));
//! ```

pub mod explain;
pub mod flying;
pub mod lighting;
pub mod preset;
pub mod radiosity;
pub mod setting;
pub mod sidecar;
pub mod surroundings;
pub mod table;
pub mod value;

pub use preset::Presets;
pub use setting::{Origin, SetError, Setting};
pub use table::{Command, OptionRow, Options, Section, Stage, TABLE};
