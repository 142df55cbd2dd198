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
//! What needs no switch, because it is decided where it matters at no cost, or is not there to be left out:
//! - Photons have no directions: they are stored on matt surfaces only, whatever else a scene has.
//! - Smoothed normals, panes, alpha and pictures are looked at where a ray meets them. Panes are straight through in closed form.
//! - Glass and panes of index 1 that take no light are nothing when they are made already.
//! - Dark paths end by chance, which keeps the mean; a number of bounces that is "enough" for dark leaves would not.
//! - Lamps without power are never asked and send no photons. A lamp in a closed body is kept: a camera may be there too, and what is
//!   lit there absorbs.
//! - Balls, cylinders, frusta, disks and boxes are met as such; cutting them into triangles would be another scene.
//! - Light has three channels and fills no space: there are no other bands and no fog to leave out.
//! - What stands far away is drawn as it is, and every organ counts its light: leaving either out would change the answer.
//! - Between growth steps what stays the same is kept by the [scene](crate::scene::Scene::build_like).
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
