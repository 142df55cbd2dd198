//! Only what a scene requires: one look at its materials, lights and prototypes tells what a renderer may leave out.
//!
//! Each [`Feature`] is something that renderers can do, and that some scenes do not require. [`Requirements`] is the record of all of
//! them for one scene, each with its reason in words; renderers ask it, and so do people (`--explain-scene`). What was left out can be
//! kept (`--require`): the answer is the same, to the bit or within its noise as [`Feature::promise`] says, and only slower. Tests hold
//! every switch to that.
//!
//! A wrong "not required" is worse than slow, so the look is conservative: materials count whether anything is made of them or not,
//! pictures count with all that they could be, and lights wherever they are.
//!
//! ```text
//! feature   what can be left out      survey    the conditions
//! focused   light that is missed      record    what was found
//! ```

mod feature;
mod focused;
mod record;
mod survey;

pub use feature::{Feature, Features, Promise};
pub use focused::has_focused_light;
pub use record::{Finding, Requirements, State};
