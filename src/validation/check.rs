//! A number that is known on paper, how it is measured, and what came of it.

use super::probe::Experiment;
use super::verdict::{Family, Verdict};
use crate::integrator::{CancelToken, RenderContext};
use crate::math::rng;
use crate::scene::SceneError;
use serde::Serialize;

/// The fault that a check must be able to see, as a part of the number, unless it says otherwise.
pub(super) const FAULT: f64 = 0.02;

/// A number that is known on paper, and how it is measured.
pub struct Check {
    /// A short name without spaces, unlike all others.
    pub id: String,
    /// What is measured, and how.
    pub what: String,
    /// The number on paper.
    pub expected: f64,
    /// The case of the list of tests at the [extremes](super::extremes) that it belongs to, such as `17`.
    pub case: Option<&'static str>,
    trial: Trial,
}

/// What a measurement may ask for.
pub(super) struct Setting<'a> {
    /// Decides all random choices.
    pub(super) seed: u64,
    /// To be asked often by what takes long; what is returned then counts for nothing.
    pub(super) cancel: &'a CancelToken,
}

impl<'a> Setting<'a> {
    /// What methods of light transport are given.
    pub(super) fn context(&self) -> RenderContext<'a> {
        RenderContext {
            seed: self.seed,
            cancel: self.cancel,
            progress: &|_| {},
        }
    }
}

/// Why there is no number.
#[derive(Debug)]
pub(super) struct Trouble(pub(super) String);

impl<E: std::error::Error> From<E> for Trouble {
    fn from(error: E) -> Self {
        Self(error.to_string())
    }
}

/// How a number is found that may be off by so much.
type Measure = Box<dyn Fn(&Setting<'_>) -> Result<f64, Trouble> + Send + Sync>;

enum Trial {
    /// A number and how far it may be off, as a number of the same kind.
    Within { allowed: f64, measure: Measure },
    /// Nothing is left to chance.
    Exact {
        /// Largest relative difference.
        tolerance: f64,
        measure: Box<dyn Fn() -> Result<f64, SceneError> + Send + Sync>,
    },
    /// A mean.
    Mean {
        /// The fault that must be seen, as a part of the number.
        fault: f64,
        experiment: Box<dyn Fn() -> Result<Experiment, SceneError> + Send + Sync>,
    },
}

/// What came of a check.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Finding {
    /// Its name.
    pub id: String,
    /// What was measured, and how.
    pub what: String,
    /// The number on paper.
    pub expected: f64,
    /// The number found; `None` if the scene could not be built.
    pub measured: Option<f64>,
    /// Standard error of a mean; `None` if nothing was left to chance.
    pub standard_error: Option<f64>,
    /// The largest difference that passes.
    pub tolerance: f64,
    /// Independent observations.
    pub observations: u64,
    /// Whether the number found is the number on paper.
    pub ok: bool,
    /// Why not, if it is not that the numbers differ.
    pub reason: Option<String>,
}

impl Check {
    /// A number that is right to the relative `tolerance`; 0 must be 0 exactly.
    pub(super) fn exact(
        name: (impl Into<String>, impl Into<String>),
        expected: f64,
        tolerance: f64,
        measure: impl Fn() -> Result<f64, SceneError> + Send + Sync + 'static,
    ) -> Self {
        let measure = Box::new(measure);
        Self {
            id: name.0.into(),
            what: name.1.into(),
            expected,
            case: None,
            trial: Trial::Exact { tolerance, measure },
        }
    }

    /// A mean, by which a fault of the part `fault` is seen.
    pub(super) fn mean(
        name: (impl Into<String>, impl Into<String>),
        expected: f64,
        fault: f64,
        experiment: impl Fn() -> Result<Experiment, SceneError> + Send + Sync + 'static,
    ) -> Self {
        let experiment = Box::new(experiment);
        Self {
            id: name.0.into(),
            what: name.1.into(),
            expected,
            case: None,
            trial: Trial::Mean { fault, experiment },
        }
    }

    /// A number that is off by `allowed` at most, of whatever kind; an error or a count of faults is expected to be 0.
    pub(super) fn within(
        name: (impl Into<String>, impl Into<String>),
        expected: f64,
        allowed: f64,
        measure: impl Fn(&Setting<'_>) -> Result<f64, Trouble> + Send + Sync + 'static,
    ) -> Self {
        let measure = Box::new(measure);
        Self {
            id: name.0.into(),
            what: name.1.into(),
            expected,
            case: None,
            trial: Trial::Within { allowed, measure },
        }
    }

    /// As part of a case of the list of tests at the extremes.
    pub(super) fn of_case(self, case: &'static str) -> Self {
        Self {
            case: Some(case),
            ..self
        }
    }

    /// Whether chance plays a part.
    #[must_use]
    pub fn is_mean(&self) -> bool {
        matches!(self.trial, Trial::Mean { .. })
    }

    /// Makes the check as one of a family; `None` if it was cancelled.
    #[must_use]
    pub fn make(&self, seed: u64, family: Family, cancel: &CancelToken) -> Option<Finding> {
        if cancel.is_cancelled() {
            return None;
        }
        let finding = match &self.trial {
            Trial::Within { allowed, measure } => {
                let setting = Setting { seed, cancel };
                measure(&setting).map(|measured| Finding {
                    measured: Some(measured),
                    tolerance: *allowed,
                    observations: 1,
                    ok: (measured - self.expected).abs() <= *allowed,
                    ..self.nothing()
                })
            }
            Trial::Exact { tolerance, measure } => {
                measure().map_err(Trouble::from).map(|measured| {
                    let tolerance = tolerance * self.expected.abs();
                    Finding {
                        measured: Some(measured),
                        tolerance,
                        observations: 1,
                        ok: (measured - self.expected).abs() <= tolerance,
                        ..self.nothing()
                    }
                })
            }
            Trial::Mean { fault, experiment } => experiment()
                .map_err(Trouble::from)
                .map(|experiment| self.observe(&experiment, *fault, seed, family, cancel)),
        };
        if cancel.is_cancelled() {
            return None;
        }
        Some(finding.unwrap_or_else(|error| Finding {
            reason: Some(error.0),
            ..self.nothing()
        }))
    }

    fn observe(
        &self,
        experiment: &Experiment,
        fault: f64,
        seed: u64,
        family: Family,
        cancel: &CancelToken,
    ) -> Finding {
        let letters: Vec<u64> = self.id.bytes().map(u64::from).collect();
        let seed = rng::hash(&[seed, rng::hash(&letters)]);
        // A little more than needed: the last observations may widen the spread again.
        let seen = experiment.observe(seed, cancel, |seen| {
            family.sees(seen.standard_error(), 0.9 * fault, self.expected)
        });
        let verdict = family.verdict(&seen, self.expected, fault);
        Finding {
            measured: Some(seen.mean()),
            standard_error: Some(seen.standard_error()),
            tolerance: family.allowance(seen.standard_error(), self.expected),
            observations: seen.n(),
            ok: verdict == Verdict::Agrees,
            reason: (verdict == Verdict::Blind)
                .then(|| format!("too noisy to see a fault of {} %", 100.0 * fault)),
            ..self.nothing()
        }
    }

    /// What is known without having measured.
    fn nothing(&self) -> Finding {
        Finding {
            id: self.id.clone(),
            what: self.what.clone(),
            expected: self.expected,
            measured: None,
            standard_error: None,
            tolerance: 0.0,
            observations: 0,
            ok: false,
            reason: None,
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::color::Rgb;
    use crate::geometry::Shape;
    use crate::material::Material;
    use crate::validation::probe::along;
    use crate::validation::room::{Room, at, gray};
    use glam::DVec3;

    /// A closed ball that shines with 1 and reflects `rho`: 1/(1 - ρ).
    fn furnace(rho: f64, material: Material) -> Check {
        Check::mean(("x", "furnace"), 1.0 / (1.0 - rho), 0.02, move || {
            let ball = Shape::Sphere { radius: 1.0 };
            let scene = Room::default().with(ball, at(0., 0., 0.), material.clone());
            Ok(Experiment::new(
                scene.scene()?,
                along(DVec3::ZERO, DVec3::X),
            ))
        })
    }

    fn find(check: &Check) -> Finding {
        let cancel = CancelToken::default();
        check.make(1, Family::of(1), &cancel).unwrap()
    }

    /// Not a scaled result but a wrong program: walls that reflect a little more than they say.
    #[test]
    fn a_fault_of_two_percent_in_the_walls_is_caught() {
        let walls = |rho| Material::lambert(gray(rho)).emitting(Rgb::BLACK, gray(1.0));
        assert!(find(&furnace(0.5, walls(0.5))).ok);
        for wrong in [0.49, 0.51] {
            let found = find(&furnace(0.5, walls(wrong)));
            assert!(!found.ok && found.reason.is_none(), "{found:?}");
        }
    }

    #[test]
    fn noise_and_impossible_scenes_do_not_pass() {
        // Half of the rays pass a veil before a lamp: too noisy to see a fault of one in 100,000.
        let noisy = Check::mean(("x", "veil"), 0.5, 0.000_01, || {
            let lamp = Material::lambert(Rgb::BLACK).emitting(gray(1.0), gray(1.0));
            let veil = Shape::Disk { radius: 1.0 };
            let room = Room::default().with(veil, at(0., 0., 0.), lamp.with_alpha(0.5));
            let look = along(DVec3::Z, DVec3::NEG_Z);
            Ok(Experiment::new(room.scene()?, look).spread(1))
        });
        let found = find(&noisy);
        assert!(!found.ok && found.reason.unwrap().starts_with("too noisy"));
        let found = find(&furnace(0.5, Material::lambert(gray(2.0))));
        assert!(!found.ok && found.measured.is_none());
        assert!(found.reason.unwrap().contains("material 0"));
    }

    #[test]
    fn exact_numbers_allow_rounding_only() {
        let check =
            |found: f64| Check::exact(("x", "y"), 2.0, 0.5 * f64::EPSILON, move || Ok(found));
        assert!(find(&check(2.0)).ok);
        for wrong in [2.0 + 4.0 * f64::EPSILON, f64::NAN, 0.0] {
            assert!(!find(&check(wrong)).ok);
        }
    }
}
