//! What a model without errors probably does not mean: warnings.
//!
//! Each is given only where it is sure; a model that does what its author wants should see none.

mod modules;
mod numbers;
mod reach;
mod results;
mod rules;
#[cfg(test)]
mod tests;
mod walk;

use super::model::Model;
use crate::diag::Diagnostics;

/// The warnings of a model without errors. Cost: linear in its size, but for long chains of calls.
pub(super) fn lint(model: &Model) -> Diagnostics {
    let mut found = Diagnostics::default();
    rules::check(model, &mut found);
    reach::check(model, &mut found);
    results::check(model, &mut found);
    modules::check(model, &mut found);
    numbers::check(model, &mut found);
    found
}
