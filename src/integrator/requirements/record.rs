//! What was found about a scene.

use super::feature::{Feature, Features};
use super::survey::Survey;
use crate::scene::Scene;
use std::fmt::Write;

/// What becomes of a feature.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum State {
    /// The scene requires it.
    Needed,
    /// The scene does not.
    LeftOut,
    /// The scene does not, but the user wants it kept.
    Kept,
}

impl State {
    /// In words.
    #[must_use]
    pub const fn words(self) -> &'static str {
        match self {
            Self::Needed => "needed",
            Self::LeftOut => "left out",
            Self::Kept => "kept",
        }
    }
}

/// What was found about one feature.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Finding {
    /// The feature.
    pub feature: Feature,
    /// What becomes of it.
    pub state: State,
    /// Why the scene requires it, or not; with numbers.
    pub why: String,
}

/// What a scene requires of renderers.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Requirements {
    findings: Vec<Finding>,
    /// Needed or kept.
    there: Features,
}

impl Requirements {
    /// Looks at a scene; `kept` are features that are there even if it does not require them. Cost O(materials + lights + stored
    /// shapes).
    #[must_use]
    pub fn of(scene: &Scene, kept: Features) -> Self {
        let survey = Survey::new(scene);
        let finding = |feature: Feature| {
            let (is_needed, why) = survey.look(feature);
            let state = match is_needed {
                true => State::Needed,
                false if kept.contains(feature) => State::Kept,
                false => State::LeftOut,
            };
            Finding {
                feature,
                state,
                why,
            }
        };
        let findings: Vec<Finding> = Feature::ALL.into_iter().map(finding).collect();
        let there = findings.iter().filter(|f| f.state != State::LeftOut);
        Self {
            there: there.map(|finding| finding.feature).collect(),
            findings,
        }
    }

    /// Whether a feature is there: required or kept.
    #[must_use]
    pub const fn has(&self, feature: Feature) -> bool {
        self.there.contains(feature)
    }

    /// Whether a feature is there only because it is kept.
    #[must_use]
    pub fn keeps(&self, feature: Feature) -> bool {
        let mut findings = self.findings.iter();
        findings.any(|found| found.feature == feature && found.state == State::Kept)
    }

    /// What was found, one for each feature.
    #[must_use]
    pub fn findings(&self) -> &[Finding] {
        &self.findings
    }

    /// A table for people, a line for each feature: its name, what becomes of it, why, the work that it is, and who uses it.
    #[must_use]
    pub fn table(&self) -> String {
        self.table_for(|_| true)
    }

    /// The same of what some [users](Feature::users) use, without the others.
    #[must_use]
    pub fn table_for(&self, is_asked: impl Fn(&str) -> bool) -> String {
        let users = |feature: Feature| -> Vec<&str> {
            let users = feature.users().iter().copied();
            users.filter(|user| is_asked(user)).collect()
        };
        let findings = self.findings.iter();
        let findings: Vec<&Finding> = findings
            .filter(|found| !users(found.feature).is_empty())
            .collect();
        let names = findings.iter().map(|found| found.feature.name().len());
        let names = names.max().unwrap_or(0);
        let reasons = findings.iter().map(|found| found.why.chars().count());
        let reasons = reasons.max().unwrap_or(0);
        let mut out = String::new();
        for Finding {
            feature,
            state,
            why,
        } in findings
        {
            let (name, state, work) = (feature.name(), state.words(), feature.work());
            let users = users(*feature).join(", ");
            let _ = writeln!(
                out,
                "{name:names$}  {state:8}  {why:reasons$}  {work} ({users})"
            );
        }
        out
    }
}
