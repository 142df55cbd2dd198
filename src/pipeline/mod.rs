//! From a model on disk to a picture on disk: the stages, what each depends on, and all contact with the machine.
//!
//! read → check → derive → describe → build → solve → view → write. Each stage is keyed by what it depends on (texts,
//! and the options of its [`Stage`](crate::options::Stage)), so who runs a model twice repeats only what changed: a
//! [`Studio`](studio::Studio) keeps the stages up to the light that all cameras share, [`Making`](making::Making) takes pictures of it.

mod ages;
pub mod assets;
pub mod audience;
pub mod budget;
pub mod charts;
pub mod choosing;
pub mod constants;
pub mod content_hash;
pub mod course;
pub mod exporting;
pub mod exposing;
pub mod failure;
mod film_choice;
mod film_exposure;
mod film_flicker;
mod film_samples;
mod film_trial;
pub mod filming;
mod frame;
pub mod growing;
mod hashes;
mod history;
pub mod inputs;
pub mod light_models;
pub mod lighting;
pub mod making;
pub mod packed;
pub mod project_files;
pub mod reads;
pub mod reel;
pub mod report;
pub mod solution_file;
pub mod solving;
pub mod sources;
pub mod spot_check;
pub mod store;
pub mod studio;
pub mod surroundings;
pub mod threads;
pub mod until;
pub mod viewing;
pub mod viewpoint;
mod wished;
pub mod world;
