//! Curves over two logarithmic axes, as SVG that is readable on light and on dark pages.

use crate::math::functions::{log10, pow};
use std::fmt::Write;

/// Size of a picture, and of the margins round its plot: left, right, top, bottom.
const SIZE: [f64; 2] = [760.0, 430.0];
const MARGINS: [f64; 4] = [64.0, 190.0, 34.0, 48.0];
/// Pixels between two lines of the legend.
const LINE: f64 = 18.0;

/// How points are joined.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Style {
    /// Points with bars, joined by a line.
    Points,
    /// A thin line.
    Thin,
    /// A broad, pale line.
    Broad,
}

/// A curve.
#[derive(Clone, Debug, PartialEq)]
pub struct Series {
    /// Its name in the legend; empty for none.
    pub name: String,
    /// Its colour, `#rrggbb`.
    pub color: &'static str,
    /// How it is drawn.
    pub style: Style,
    /// Points, and the half length of the bar of each; what is not positive is left out.
    pub points: Vec<[f64; 3]>,
}

/// Curves over the same axes.
#[derive(Clone, Debug, PartialEq)]
pub struct Plot {
    /// What it shows.
    pub title: String,
    /// What the axes are, with units.
    pub axes: [&'static str; 2],
    /// The curves; later ones on top.
    pub series: Vec<Series>,
}

/// Where numbers stand.
struct Frame {
    x: [f64; 2],
    y: [f64; 2],
}

impl Plot {
    /// As a picture.
    #[must_use]
    pub fn svg(&self) -> String {
        let marked = self
            .series
            .iter()
            .filter(|series| series.style == Style::Points);
        let points: Vec<[f64; 3]> = marked
            .flat_map(|s| s.points.iter().copied())
            .filter(is_drawn)
            .collect();
        let frame = Frame {
            x: range(points.iter().map(|p| p[0])),
            y: range(points.iter().map(|p| p[1])),
        };
        let mut out = String::new();
        let _ = write!(
            out,
            "<svg xmlns=\"http://www.w3.org/2000/svg\" viewBox=\"0 0 {0} {1}\" width=\"{0}\" height=\"{1}\" \
             font-family=\"system-ui,sans-serif\" font-size=\"12\" role=\"img\" aria-label=\"{2}\">\n\
             <style>.ink{{fill:#333}}.rule{{stroke:#0003}}\
             @media(prefers-color-scheme:dark){{.ink{{fill:#ddd}}.rule{{stroke:#fff4}}}}</style>\n",
            SIZE[0],
            SIZE[1],
            escaped(&self.title)
        );
        self.axes(&frame, &mut out);
        let clip = format!("c{:x}", self.title.len() * 31 + points.len());
        let [left, top] = [MARGINS[0], MARGINS[2]];
        let [width, height] = inner();
        let _ = writeln!(
            out,
            "<clipPath id=\"{clip}\"><rect x=\"{left}\" y=\"{top}\" width=\"{width}\" height=\"{height}\"/></clipPath>\
             <g clip-path=\"url(#{clip})\">"
        );
        for series in &self.series {
            frame.draw(series, &mut out);
        }
        out.push_str("</g>\n");
        self.legend(&mut out);
        out.push_str("</svg>\n");
        out
    }

    fn axes(&self, frame: &Frame, out: &mut String) {
        let [left, top] = [MARGINS[0], MARGINS[2]];
        let [width, height] = inner();
        let (right, bottom) = (left + width, top + height);
        for mark in marks(frame.x) {
            let x = frame.place([mark, frame.y[0]])[0];
            let _ = writeln!(
                out,
                "<path class=\"rule\" d=\"M{x:.1} {top}V{bottom}\"/><text class=\"ink\" x=\"{x:.1}\" y=\"{:.1}\" text-anchor=\"middle\">{}</text>",
                bottom + 17.0,
                number(mark)
            );
        }
        for mark in marks(frame.y) {
            let y = frame.place([frame.x[0], mark])[1];
            let _ = writeln!(
                out,
                "<path class=\"rule\" d=\"M{left} {y:.1}H{right}\"/><text class=\"ink\" x=\"{:.1}\" y=\"{:.1}\" text-anchor=\"end\">{}</text>",
                left - 7.0,
                y + 4.0,
                number(mark)
            );
        }
        let [x_name, y_name] = self.axes.map(escaped);
        let _ = writeln!(
            out,
            "<text class=\"ink\" x=\"{left}\" y=\"20\" font-size=\"14\" font-weight=\"600\">{}</text>\n\
             <text class=\"ink\" x=\"{:.1}\" y=\"{:.1}\" text-anchor=\"middle\">{x_name}</text>\n\
             <text class=\"ink\" transform=\"translate(15 {:.1}) rotate(-90)\" text-anchor=\"middle\">{y_name}</text>",
            escaped(&self.title),
            left + width / 2.0,
            bottom + 38.0,
            top + height / 2.0,
        );
    }

    fn legend(&self, out: &mut String) {
        let named = self.series.iter().filter(|series| !series.name.is_empty());
        for (i, series) in named.enumerate() {
            let (x, y) = (
                SIZE[0] - MARGINS[1] + 16.0,
                MARGINS[2] + 12.0 + LINE * i as f64,
            );
            let width = if series.style == Style::Broad { 9 } else { 2 };
            let opacity = if series.style == Style::Broad {
                0.3
            } else {
                1.0
            };
            let _ = writeln!(
                out,
                "<path d=\"M{x} {0}h18\" stroke=\"{1}\" stroke-width=\"{width}\" opacity=\"{opacity}\"/>\
                 <text class=\"ink\" x=\"{2}\" y=\"{3}\">{4}</text>",
                y - 4.0,
                series.color,
                x + 26.0,
                y,
                escaped(&series.name)
            );
        }
    }
}

impl Frame {
    fn place(&self, [x, y]: [f64; 2]) -> [f64; 2] {
        let [width, height] = inner();
        let share = |v: f64, [a, b]: [f64; 2]| (log10(v) - log10(a)) / (log10(b) - log10(a));
        [
            MARGINS[0] + share(x, self.x) * width,
            MARGINS[2] + (1.0 - share(y, self.y)) * height,
        ]
    }

    fn draw(&self, series: &Series, out: &mut String) {
        let points: Vec<[f64; 3]> = series.points.iter().copied().filter(is_drawn).collect();
        if points.is_empty() {
            return;
        }
        let path: Vec<String> = points
            .iter()
            .map(|p| {
                let [x, y] = self.place([p[0], p[1]]);
                format!("{x:.1} {y:.1}")
            })
            .collect();
        let color = series.color;
        let (width, opacity) = match series.style {
            Style::Points => (1.6, 1.0),
            Style::Thin => (1.0, 0.7),
            Style::Broad => (11.0, 0.25),
        };
        let dashes = if series.style == Style::Thin {
            " stroke-dasharray=\"3 3\""
        } else {
            ""
        };
        let _ = writeln!(
            out,
            "<path d=\"M{}\" fill=\"none\" stroke=\"{color}\" stroke-width=\"{width}\" opacity=\"{opacity}\" stroke-linejoin=\"round\"{dashes}/>",
            path.join("L")
        );
        if series.style != Style::Points {
            return;
        }
        for [x, y, bar] in points {
            let [at, middle] = self.place([x, y]);
            let low = self.place([x, (y - bar).max(0.05 * y)])[1];
            let high = self.place([x, y + bar])[1];
            let _ = writeln!(
                out,
                "<path d=\"M{at:.1} {low:.1}V{high:.1}\" stroke=\"{color}\"/><circle cx=\"{at:.1}\" cy=\"{middle:.1}\" r=\"3.4\" fill=\"{color}\"/>"
            );
        }
    }
}

/// Width and height of the plot itself.
fn inner() -> [f64; 2] {
    [
        SIZE[0] - MARGINS[0] - MARGINS[1],
        SIZE[1] - MARGINS[2] - MARGINS[3],
    ]
}

fn is_drawn(point: &[f64; 3]) -> bool {
    point.iter().all(|v| v.is_finite()) && point[0] > 0.0 && point[1] > 0.0
}

/// Least and greatest of the values with a little room; a decade if there is none.
fn range(values: impl Iterator<Item = f64>) -> [f64; 2] {
    let [least, greatest] = values.fold([f64::INFINITY, 0.0], |[a, b]: [f64; 2], v| {
        [a.min(v), b.max(v)]
    });
    if least > greatest {
        return [0.1, 1.0];
    }
    [least / 1.4, greatest * 1.4]
}

/// Round numbers of the range: 1, 2 and 5 of each decade; of many decades only 1.
fn marks([from, to]: [f64; 2]) -> Vec<f64> {
    let decades = log10(to) - log10(from);
    let factors: &[f64] = if decades > 3.5 {
        &[1.0]
    } else {
        &[1.0, 2.0, 5.0]
    };
    let first = log10(from).floor() as i32;
    let last = log10(to).ceil() as i32;
    (first..=last)
        .flat_map(|power| {
            factors
                .iter()
                .map(move |factor| factor * pow(10.0, f64::from(power)))
        })
        .filter(|mark| (from..=to).contains(mark))
        .collect()
}

/// A number as people write it, with no more digits than it has as a mark.
pub(super) fn number(x: f64) -> String {
    if !(0.000_1..100_000.0).contains(&x) {
        return format!("{x:.0e}");
    }
    let text = format!("{x:.5}");
    text.trim_end_matches('0').trim_end_matches('.').to_owned()
}

/// Text as it stands in XML.
pub(super) fn escaped(text: &str) -> String {
    text.replace('&', "&amp;")
        .replace('<', "&lt;")
        .replace('>', "&gt;")
        .replace('"', "&quot;")
}

#[cfg(test)]
mod tests {
    use super::*;

    fn plot(points: Vec<[f64; 3]>) -> Plot {
        Plot {
            title: "a < b".into(),
            axes: ["s", "%"],
            series: vec![Series {
                name: "path & more".into(),
                color: "#0072b2",
                style: Style::Points,
                points,
            }],
        }
    }

    #[test]
    fn every_point_that_has_a_place_is_drawn() {
        let svg = plot(vec![
            [0.1, 3.0, 0.2],
            [1.0, 2.0, 5.0],
            [0.0, 1.0, 0.0],
            [1.0, f64::NAN, 0.0],
        ])
        .svg();
        assert_eq!(svg.matches("<circle").count(), 2);
        assert!(
            svg.contains("a &lt; b") && svg.contains("path &amp; more") && !svg.contains("NaN")
        );
    }

    #[test]
    fn nothing_to_draw_is_an_empty_plot() {
        let svg = plot(vec![]).svg();
        assert!(!svg.contains("NaN") && !svg.contains("inf") && svg.ends_with("</svg>\n"));
    }

    #[test]
    fn marks_are_round_and_inside() {
        assert_eq!(marks([0.15, 12.0]), [0.2, 0.5, 1.0, 2.0, 5.0, 10.0]);
        assert_eq!(marks([0.5, 5e4]).len(), 5);
        assert_eq!(
            [0.2, 10.0, 1e-5, 2e6].map(number),
            ["0.2", "10", "1e-5", "2e6"]
        );
    }
}
