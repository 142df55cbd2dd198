//! The plots of a measurement.

use super::front;
use super::plot::{Plot, Series, Style};
use super::results::{Findings, Ladder, Measured};

/// Colours that people with any eyes tell apart (M. Okabe, K. Ito: Color Universal Design, 2008).
const COLORS: [(&str, &str); 6] = [
    ("path", "#0072b2"),
    ("photon", "#d55e00"),
    ("photon, gathered", "#cc79a7"),
    ("photon, passes", "#e69f00"),
    ("radiosity", "#009e73"),
    ("raytracer", "#56b4e9"),
];
/// Of families without one, and of fronts.
const GRAY: &str = "#888888";
/// Points of a fitted curve.
const N_CURVE: usize = 60;

/// Error over seconds for so many cameras: what was measured, what was fitted, and the front.
#[must_use]
pub fn error_over_seconds(findings: &Findings, cameras: u32) -> Plot {
    let mut series = vec![Series {
        name: "nobody beats these".into(),
        color: GRAY,
        style: Style::Broad,
        points: front::front(findings, cameras, 1.0)
            .iter()
            .map(|point| [point.seconds, percent(point.rung.resolved_error()), 0.0])
            .collect(),
    }];
    for ladder in findings
        .families
        .iter()
        .filter(|ladder| ladder.is_contender)
    {
        let color = color(&ladder.name);
        if cameras == 1
            && let [Some(fit), _] = front::fits(ladder)
        {
            let seconds = ladder.rungs.iter().map(|rung| rung.seconds(1, 1.0));
            series.push(Series {
                name: String::new(),
                color,
                style: Style::Thin,
                points: curve(seconds, |x| percent(fit.at(x))),
            });
        }
        let points = ladder.rungs.iter().map(|rung| {
            let error = rung.resolved_error();
            // Of a root: half of the relative deviation; two of them are 95 %.
            let bar = percent(error) * rung.error_deviation / error;
            [rung.seconds(cameras, 1.0), percent(error), bar]
        });
        series.push(Series {
            name: ladder.name.clone(),
            color,
            style: Style::Points,
            points: points.collect(),
        });
    }
    Plot {
        title: match cameras {
            1 => "One picture".into(),
            n => format!("{n} pictures of one scene"),
        },
        axes: ["seconds", "relative error, %"],
        series,
    }
}

/// Bias and variance of a family, over its knob.
#[must_use]
pub fn split(ladder: &Ladder) -> Plot {
    let part = |name: &str, color, value: &dyn Fn(&Measured) -> f64| Series {
        name: name.into(),
        color,
        style: Style::Points,
        points: ladder
            .rungs
            .iter()
            .map(|rung| [rung.knob, value(rung), 0.0])
            .collect(),
    };
    let mut series = vec![
        part("variance", "#0072b2", &|rung| rung.variance),
        part("bias²", "#d55e00", &|rung| rung.bias_squared),
        part("both", GRAY, &|rung| rung.error_of_all),
    ];
    if let [_, Some(fit)] = front::fits(ladder) {
        series.push(Series {
            name: String::new(),
            color: GRAY,
            style: Style::Thin,
            points: curve(ladder.rungs.iter().map(|rung| rung.knob), |x| fit.at(x)),
        });
    }
    Plot {
        title: ladder.name.clone(),
        axes: [
            match ladder.knob.as_str() {
                "samples" => "samples per pixel",
                "photons" => "photons",
                "passes" => "passes",
                "photon area" => "photon area, m²",
                "patches" => "patches, in those of the coarsest",
                _ => "step",
            },
            "relative squared error",
        ],
        series,
    }
}

/// Points of a function between the least and greatest of some numbers.
fn curve(over: impl Iterator<Item = f64>, value: impl Fn(f64) -> f64) -> Vec<[f64; 3]> {
    let [least, greatest] = over.fold([f64::INFINITY, 0.0], |[a, b]: [f64; 2], x| {
        [a.min(x), b.max(x)]
    });
    if !(least > 0.0 && greatest > least) {
        return vec![];
    }
    let step = (greatest / least).powf(1.0 / (N_CURVE - 1) as f64);
    (0..N_CURVE)
        .map(|i| {
            let x = least * step.powi(i as i32);
            [x, value(x), 0.0]
        })
        .collect()
}

/// A relative squared error as people read it.
#[must_use]
pub fn percent(squared: f64) -> f64 {
    100.0 * squared.max(0.0).sqrt()
}

/// The colour of a family.
#[must_use]
pub fn color(family: &str) -> &'static str {
    COLORS
        .iter()
        .find(|(name, _)| *name == family)
        .map_or(GRAY, |(_, color)| color)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::trade::front::tests::findings;

    #[test]
    fn fronts_and_splits_show_all_that_was_measured() {
        let findings = findings();
        let plot = error_over_seconds(&findings, 1);
        let svg = plot.svg();
        assert_eq!(svg.matches("<circle").count(), 10);
        assert!(!svg.contains("evidence") && svg.contains("nobody beats"));
        let svg = split(&findings.families[1]).svg();
        assert_eq!(svg.matches("<circle").count(), 12);
        assert!((percent(4e-4) - 2.0).abs() < 1e-12 && percent(-1.0) == 0.0);
    }
}
