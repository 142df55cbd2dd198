//! Which settings nobody beats: no other is both faster and more exact.

use super::fit::{self, Fit};
use super::results::{Findings, Ladder, Measured};

/// Numbers of cameras for which fronts are told.
pub const CAMERAS: [u32; 4] = [1, 10, 100, 1000];

/// Seconds for the picture that is wanted, at most, of the presets `draft`, `preview` and `final`: decades.
pub const DECADES: [(&str, f64); 3] = [("draft", 1.0), ("preview", 10.0), ("final", 100.0)];

/// A setting is on a front only if its squared error is at most this part of that of any faster one: less is chance, or not worth a
/// change of the method.
pub const GAIN: f64 = 0.95;

/// A setting on a front.
#[derive(Clone, Copy, Debug)]
pub struct Point<'f> {
    /// Its family.
    pub ladder: &'f Ladder,
    /// What was measured.
    pub rung: &'f Measured,
    /// Seconds for all cameras.
    pub seconds: f64,
}

/// Where one family hands over to another.
#[derive(Clone, Copy, Debug)]
pub struct Crossing<'f> {
    /// Best below.
    pub before: &'f str,
    /// Best from here on.
    pub after: &'f str,
    /// Seconds for all cameras.
    pub seconds: f64,
    /// Relative squared error.
    pub error: f64,
}

/// The settings that nobody beats for so many cameras, of `scale` times as many pixels as were measured: from fast to exact.
#[must_use]
pub fn front(findings: &Findings, cameras: u32, scale: f64) -> Vec<Point<'_>> {
    let ladders = findings
        .families
        .iter()
        .filter(|ladder| ladder.is_contender);
    let points = ladders.flat_map(|ladder| {
        ladder.rungs.iter().map(move |rung| Point {
            ladder,
            rung,
            seconds: rung.seconds(cameras, scale),
        })
    });
    let mut points: Vec<Point<'_>> = points.collect();
    points.sort_by(|a, b| {
        a.seconds
            .total_cmp(&b.seconds)
            .then(a.rung.resolved_error().total_cmp(&b.rung.resolved_error()))
    });
    let mut least = f64::INFINITY;
    points.retain(|point| {
        let error = point.rung.resolved_error();
        let is_better = error < GAIN * least;
        if is_better {
            least = error;
        }
        is_better
    });
    points
}

/// Where the methods cross, on a front.
#[must_use]
pub fn crossings<'f>(front: &[Point<'f>]) -> Vec<Crossing<'f>> {
    let pairs = front
        .windows(2)
        .filter(|pair| pair[0].ladder.name != pair[1].ladder.name);
    pairs
        .map(|pair| Crossing {
            before: &pair[0].ladder.name,
            after: &pair[1].ladder.name,
            seconds: pair[1].seconds,
            error: pair[1].rung.resolved_error(),
        })
        .collect()
}

/// The presets: of each decade of seconds for one picture of the wanted size, the most exact setting on the front; the fastest
/// there is where none is fast enough.
#[must_use]
pub fn presets(findings: &Findings) -> Vec<(&'static str, Point<'_>)> {
    let front = front(findings, 1, findings.scale);
    let within = |seconds: f64| {
        let mut fast = front.iter().filter(|point| point.seconds <= seconds);
        fast.next_back().or(front.first()).copied()
    };
    DECADES
        .iter()
        .filter_map(|(name, seconds)| Some((*name, within(*seconds)?)))
        .collect()
}

/// How the error of a family falls: with seconds of one picture, and with its work. The second one is of all pixels, because a theory
/// speaks of means, and the mean of what is left without the worst pixels falls in its own way.
#[must_use]
pub fn fits(ladder: &Ladder) -> [Option<Fit>; 2] {
    let points = |point: &dyn Fn(&Measured) -> (f64, f64)| -> Vec<(f64, f64)> {
        ladder.rungs.iter().map(point).collect()
    };
    let over_time = points(&|rung| (rung.seconds(1, 1.0), rung.resolved_error()));
    let over_work = points(&|rung| (rung.knob, rung.error_of_all));
    [over_time, over_work].map(|points| fit::fit(&points, ladder.floor()))
}

/// The presets as a file for `render --presets`.
#[must_use]
pub fn toml(findings: &Findings) -> String {
    let [width, height] = findings.size;
    let mut out = format!(
        "# Presets from the front that `understory trade {}` measured on {} threads, at {width}x{height}.\n\
         # Use them: understory render MODEL -o FILE --presets THIS --quality draft|preview|final\n",
        findings.model, findings.threads
    );
    for (name, point) in presets(findings) {
        out.push_str(&format!(
            "\n# {:.3} s, error {:.2} %\n[{name}]\n",
            point.seconds,
            100.0 * point.rung.resolved_error().sqrt()
        ));
        for (key, value) in &point.rung.settings {
            // As text, which every option reads.
            out.push_str(&format!("{key} = \"{value}\"\n"));
        }
    }
    out
}

#[cfg(test)]
pub(super) mod tests {
    use super::*;
    use crate::trade::results::Reference;

    pub(in crate::trade) fn measured(knob: f64, solve: f64, view: f64, error: f64) -> Measured {
        Measured {
            key: String::new(),
            knob,
            settings: vec![("samples".into(), knob.to_string())],
            solve,
            first: 0.0,
            view,
            error,
            error_deviation: 0.01 * error,
            error_of_all: error,
            variance: 0.6 * error,
            bias_squared: 0.4 * error,
            energy: Some([-0.01, 0.001]),
            flip: [0.1, 0.3],
            flicker: None,
            objects: vec![],
            rays: 1000,
            patches: None,
            photons: None,
            pictures: ["a.png".into(), "b.png".into()],
        }
    }

    pub(in crate::trade) fn ladder(name: &str, is_contender: bool, rungs: Vec<Measured>) -> Ladder {
        Ladder {
            name: name.into(),
            knob: "samples".into(),
            is_contender,
            has_floor: name != "path",
            theory: (name == "path").then_some(1.0),
            rungs,
            end: None,
        }
    }

    /// Path tracing of any error, photons that are solved for a second, and what only shows something.
    pub(in crate::trade) fn findings() -> Findings {
        let path = (0..6).map(|k| 4.0_f64.powi(k));
        let path = path.map(|n| measured(n, 0.0, 0.1 * n, 0.4 / n)).collect();
        let photon = (0..4).map(|k| 4.0_f64.powi(k));
        let photon = photon
            .map(|n| measured(n, n, 0.05, 0.002 + 0.01 / n))
            .collect();
        Findings {
            understory_trade: "1".into(),
            model: "m.rgg".into(),
            model_hash: "0".into(),
            size: [8, 4],
            scale: 2.0,
            threads: 2,
            seeds: 4,
            budget: 60.0,
            used: 59.0,
            reference: Reference::default(),
            families: vec![
                ladder("path", true, path),
                ladder("photon", true, photon),
                ladder("evidence", false, vec![measured(1.0, 0.0, 1e-6, 1e-9)]),
            ],
            earlier: vec![],
        }
    }

    #[test]
    fn the_front_holds_what_nobody_beats() {
        let findings = findings();
        for cameras in CAMERAS {
            let front = front(&findings, cameras, 1.0);
            assert!(
                front.is_sorted_by(|a, b| a.seconds < b.seconds && a.rung.error > b.rung.error)
            );
            for ladder in findings.families.iter().filter(|l| l.is_contender) {
                for rung in &ladder.rungs {
                    let seconds = rung.seconds(cameras, 1.0);
                    let beaten = front
                        .iter()
                        .any(|p| p.seconds <= seconds && p.rung.error <= rung.error);
                    assert!(beaten, "{} {}", ladder.name, rung.knob);
                }
            }
        }
        // Solved light wins as soon as cameras are many.
        let many = front(&findings, 1000, 1.0);
        assert_eq!(many[0].ladder.name, "photon");
    }

    #[test]
    fn methods_cross_where_the_front_changes_its_family() {
        let findings = findings();
        let front = front(&findings, 1, 1.0);
        let found = crossings(&front);
        let names: Vec<[&str; 2]> = found.iter().map(|c| [c.before, c.after]).collect();
        assert_eq!(names, [["path", "photon"], ["photon", "path"]], "{front:?}");
        assert!(found[0].seconds > 1.0 && found[0].error < 0.02);
    }

    #[test]
    fn presets_are_points_of_the_front_and_written_as_options() {
        let findings = findings();
        let front = front(&findings, 1, findings.scale);
        let presets = presets(&findings);
        assert_eq!(presets.len(), 3);
        for ((name, preset), (_, seconds)) in presets.iter().zip(DECADES) {
            assert!(
                front
                    .iter()
                    .any(|point| std::ptr::eq(point.rung, preset.rung))
            );
            assert!(preset.seconds <= seconds, "{name}");
            let mut better = front.iter().filter(|p| p.seconds <= seconds);
            assert!(better.next_back().unwrap().rung.error >= preset.rung.error);
        }
        let text = toml(&findings);
        let table: toml::Table = text.parse().unwrap();
        assert_eq!(table["final"]["samples"].as_str(), Some("256"), "{text}");
    }

    #[test]
    fn fits_find_the_theory_of_the_path_tracer() {
        let findings = findings();
        for fit in fits(&findings.families[0]) {
            let power = fit.unwrap().power;
            assert!((power - 1.0).abs() < 1e-3, "{power}");
        }
    }
}
