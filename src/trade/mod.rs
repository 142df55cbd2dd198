//! What accuracy costs: error against time of every method on the user's own model, measured, shown, and made presets of.
//!
//! ```text
//! ladder    settings from cheap to dear      session   measures them, within a budget
//! reference what they are compared with      shooting  one setting with several seeds
//! climb     which setting is next            page      one page for a browser
//! metrics   how far pictures are from truth  flip      how different they look
//! objects   what to blame for a bias         folder    keeps it all, so that it can go on
//! results   what was measured; CSV           front     what nobody beats; presets
//! fit       error over work                  plot      curves as SVG
//! figures   which curves                     heat      numbers as colours
//! ```
//!
//! The truth is the path tracer's picture, or, where light is lacking in it, that of many passes of photon mapping; its two halves are
//! independent, and so its own noise adds nothing to errors ([`metrics`]). Every setting is tried with several seeds, which split its
//! error into what changes with the seed and what stays ([Celarek2019](crate::references#celarek2019)).

mod climb;
pub mod figures;
pub mod fit;
pub mod flip;
pub mod folder;
pub mod front;
mod heat;
pub mod ladder;
pub mod metrics;
mod objects;
pub mod page;
mod plot;
mod reference;
pub mod results;
pub mod session;
mod shooting;

pub use folder::Folder;
pub use session::{Means, Plan, measure};

use crate::pipeline::failure::Failure;
use results::Findings;

/// Writes table, plots, page and presets of what was measured.
///
/// # Errors
/// If a file cannot be written.
pub fn write_all(folder: &Folder<'_>, findings: &Findings) -> Result<(), Failure> {
    folder.write("trade.csv", results::csv(findings).as_bytes())?;
    folder.write("presets.toml", front::toml(findings).as_bytes())?;
    for cameras in front::CAMERAS {
        let plot = figures::error_over_seconds(findings, cameras);
        folder.write(&format!("front-{cameras}.svg"), plot.svg().as_bytes())?;
    }
    for ladder in findings
        .families
        .iter()
        .filter(|ladder| !ladder.rungs.is_empty())
    {
        let name = ladder.name.replace([',', ' '], "");
        folder.write(
            &format!("split-{name}.svg"),
            figures::split(ladder).svg().as_bytes(),
        )?;
    }
    folder.write("index.html", page::html(findings).as_bytes())
}
