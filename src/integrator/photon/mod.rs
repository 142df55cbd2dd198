//! Light that starts at its sources: photons, for whoever counts where they arrive.
//!
//! [`Emission`] turns the sources of a scene into photons with their true densities; [`trace`] follows them from surface to
//! surface and tells a [`Visitor`] of every arrival; a [`Ledger`] keeps books that balance exactly.
//!
//! Photon number `index` is a pure function of (scene, number of photons, seed, index), and photons are followed in blocks by
//! index, whose results are joined in order: the result depends on the number of threads in nothing, not even rounding.
//!
//! ```text
//! target     what photons are aimed at      source    where they leave each kind of source
//! emission   which source, how much power   tracer    one photon's way
//! ledger     exact books                    block     many photons in parallel
//! plot       where the world repeats itself  ground    what an endless plane throws back
//! ```
//! Shining infinite planes send no photons: their power is infinite. Parallel light and sky are sent through the scene's box; where
//! there is a matt infinite plane, also onto the plane round it, 64 times as wide, and what it throws back from further away is left out;
//! with several planes, or one that mirrors, through boxes nine times as wide.

mod block;
mod emission;
mod ground;
mod ledger;
mod plot;
mod source;
mod target;
mod tracer;

pub use block::{BLOCK, Photons, trace};
pub use emission::{Aim, Emission, Photon};
pub use ledger::{Account, Ledger, Quanta, Scale};
pub use plot::Plot;
pub use tracer::{History, Onward, PhotonHit, Visitor};
