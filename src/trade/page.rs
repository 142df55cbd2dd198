//! One page with everything that was measured, for a browser, from disk. Pictures lie in the folder beside it.

use super::figures::{self, percent};
use super::fit::Fit;
use super::folder::PICTURES;
use super::front::{self, CAMERAS, Point};
use super::plot::escaped;
use super::results::{Findings, Ladder, Measured};
use std::fmt::Write;

const STYLE: &str = "
:root{color-scheme:light dark;--ink:#222;--soft:#666;--line:#0002;--card:#f6f6f4;--page:#fff;--mark:#0072b2}
@media(prefers-color-scheme:dark){:root{--ink:#ddd;--soft:#999;--line:#fff2;--card:#222;--page:#161616;--mark:#6ab7e8}}
*{box-sizing:border-box}
body{margin:0 auto;max-width:1180px;padding:24px 20px 80px;font:15px/1.5 system-ui,sans-serif;color:var(--ink);background:var(--page)}
h1{font-size:26px;margin:8px 0}h2{font-size:19px;margin:44px 0 8px}h3{font-size:15px;margin:22px 0 6px}
p{max-width:78ch;margin:6px 0}.soft{color:var(--soft)}
table{border-collapse:collapse;font-variant-numeric:tabular-nums;font-size:13.5px}
th,td{padding:4px 12px 4px 0;text-align:right;border-bottom:1px solid var(--line);white-space:nowrap}
th{font-weight:600;color:var(--soft)}th:first-child,td:first-child,.left{text-align:left}
.wide{overflow-x:auto}.plots{display:grid;grid-template-columns:repeat(auto-fit,minmax(min(520px,100%),1fr));gap:12px 24px}
svg,img{max-width:100%;height:auto}img{display:block;border-radius:3px;image-rendering:auto}
.pictures{display:grid;grid-template-columns:repeat(auto-fill,minmax(240px,1fr));gap:16px}
figure{margin:0}figcaption{font-size:12.5px;color:var(--soft);margin-top:4px}
.cards{display:grid;grid-template-columns:repeat(auto-fit,minmax(280px,1fr));gap:14px}
.card{background:var(--card);border-radius:8px;padding:12px 16px}.card b{font-size:17px}
code{font:12.5px ui-monospace,monospace;overflow-wrap:anywhere}summary{cursor:pointer;color:var(--mark);margin:14px 0}
";

/// The page.
#[must_use]
pub fn html(findings: &Findings) -> String {
    let mut out = String::new();
    let name = escaped(&findings.model);
    let _ = write!(
        out,
        "<!doctype html>\n<html lang=\"en\"><meta charset=\"utf-8\">\n\
         <meta name=\"viewport\" content=\"width=device-width,initial-scale=1\">\n\
         <title>Speed against accuracy: {name}</title>\n<style>{STYLE}</style>\n\
         <h1>Speed against accuracy: {name}</h1>\n"
    );
    introduction(findings, &mut out);
    fronts(findings, &mut out);
    presets(findings, &mut out);
    pictures(findings, &mut out);
    fits(findings, &mut out);
    objects(findings, &mut out);
    everything(findings, &mut out);
    out.push_str("</html>\n");
    out
}

fn introduction(findings: &Findings, out: &mut String) {
    let [width, height] = findings.size;
    let reference = &findings.reference;
    let _ = writeln!(
        out,
        "<p>Every setting was rendered with {} different seeds at {width} × {height} pixels on {} threads and compared with a \
         picture of {} samples per pixel by <b>{}</b>, whose own noise is {:.2} % and does not count. Errors are root mean \
         square relative errors of luminance, with the worst thousandth of the pixels left out. Seconds are of this size; a \
         picture of the size that the model asks for has {:.1} times as many pixels.</p>",
        findings.seeds,
        findings.threads,
        reference.samples,
        escaped(&reference.method),
        percent(reference.noise),
        findings.scale
    );
    for lack in &reference.lacks {
        let _ = writeln!(
            out,
            "<p>The path tracer could not be the judge: {}.</p>",
            escaped(lack)
        );
    }
}

fn fronts(findings: &Findings, out: &mut String) {
    out.push_str("<h2>What nobody beats</h2>\n");
    let best = front::front(findings, 1, 1.0);
    for crossing in front::crossings(&best) {
        let _ = writeln!(
            out,
            "<p>For one picture, from {:.2} s on (error {:.2} %) <b>{}</b> is better than <b>{}</b>.</p>",
            crossing.seconds,
            percent(crossing.error),
            escaped(crossing.after),
            escaped(crossing.before)
        );
    }
    out.push_str("<div class=\"plots\">\n");
    for cameras in CAMERAS {
        let _ = writeln!(
            out,
            "<div>{}</div>",
            figures::error_over_seconds(findings, cameras).svg()
        );
    }
    out.push_str("</div>\n");
    for cameras in [1, 100] {
        let title = if cameras == 1 {
            "one picture".to_owned()
        } else {
            format!("{cameras} pictures")
        };
        let _ = write!(
            out,
            "<h3>The front for {title}</h3>\n<div class=\"wide\"><table><tr><th>seconds</th><th>error</th><th>ꟻLIP</th>\
             <th>all light</th><th class=\"left\">settings</th></tr>\n"
        );
        for point in front::front(findings, cameras, 1.0) {
            let rung = point.rung;
            let _ = writeln!(
                out,
                "<tr><td>{}</td><td>{}</td><td>{:.3}</td><td>{}</td><td class=\"left\"><code>{}</code></td></tr>",
                seconds(point.seconds),
                error(rung),
                rung.flip[0],
                signed(rung.energy),
                flags(rung)
            );
        }
        out.push_str("</table></div>\n");
    }
}

fn presets(findings: &Findings, out: &mut String) {
    out.push_str(
        "<h2>Presets</h2>\n<p>The most exact settings of the front for 1, 10 and 100 seconds a picture of the wanted size. \
         <code>render --presets presets.toml --quality draft</code> takes them from the file beside this page.</p>\n<div class=\"cards\">\n",
    );
    for (name, point) in front::presets(findings) {
        let Point {
            rung,
            seconds: time,
            ..
        } = point;
        let _ = writeln!(
            out,
            "<div class=\"card\"><b>{name}</b><br>{} s, error {}<br><code>{}</code></div>",
            seconds(time),
            error(rung),
            flags(rung)
        );
    }
    out.push_str("</div>\n");
}

fn pictures(findings: &Findings, out: &mut String) {
    let _ = write!(
        out,
        "<h2>Pictures</h2>\n<p>The cheapest and the dearest setting of each method, and how they differ from the reference for an \
         eye (ꟻLIP: black is no difference, white the largest).</p>\n<div class=\"pictures\">\n\
         <figure><img src=\"{PICTURES}/reference.png\" alt=\"reference\"><figcaption>reference</figcaption></figure></div>\n"
    );
    for ladder in findings
        .families
        .iter()
        .filter(|ladder| !ladder.rungs.is_empty())
    {
        let _ = write!(
            out,
            "<h3>{}</h3>\n<div class=\"pictures\">\n",
            escaped(&ladder.name)
        );
        let last = ladder.rungs.len() - 1;
        let mut shown = vec![0];
        if last > 0 {
            shown.push(last);
        }
        for rung in shown.into_iter().map(|at| &ladder.rungs[at]) {
            for (picture, what) in rung.pictures.iter().zip(["", "difference, "]) {
                let _ = writeln!(
                    out,
                    "<figure><img src=\"{}\" alt=\"{what}{}\" loading=\"lazy\"><figcaption>{what}{} s, error {}</figcaption></figure>",
                    escaped(picture),
                    escaped(&ladder.name),
                    seconds(rung.seconds(1, 1.0)),
                    error(rung)
                );
            }
        }
        out.push_str("</div>\n");
    }
}

fn fits(findings: &Findings, out: &mut String) {
    out.push_str(
        "<h2>How errors fall</h2>\n<p>The squared error is fitted by b² + c x<sup>−p</sup>. b is the error that no work removes; p is \
         how fast the rest falls, with the interval that holds it with 95 % if residuals are normal. Over work all pixels count, over seconds \
         all but the worst thousandth.</p>\n\
         <div class=\"wide\"><table><tr><th>method</th><th>p over seconds</th><th>p over work</th><th>work</th><th>theory</th>\
         <th>b</th><th class=\"left\">end of the ladder</th></tr>\n",
    );
    for ladder in &findings.families {
        let [over_time, over_work] = front::fits(ladder);
        let _ = writeln!(
            out,
            "<tr><td>{}</td><td>{}</td><td>{}</td><td>{}</td><td>{}</td><td>{}</td><td class=\"left soft\">{}</td></tr>",
            escaped(&ladder.name),
            power(over_time),
            power(over_work),
            escaped(figures::split(ladder).axes[0]),
            theory(ladder, over_work),
            over_work.map_or("–".into(), |fit| format!("{:.2} %", percent(fit.floor))),
            escaped(ladder.end.as_deref().unwrap_or(""))
        );
    }
    out.push_str("</table></div>\n<h3>Bias and variance</h3>\n<div class=\"plots\">\n");
    for ladder in findings
        .families
        .iter()
        .filter(|ladder| ladder.rungs.len() > 1)
    {
        let _ = writeln!(out, "<div>{}</div>", figures::split(ladder).svg());
    }
    out.push_str("</div>\n");
}

fn objects(findings: &Findings, out: &mut String) {
    let dearest = |ladder: &Ladder| ladder.rungs.last().cloned();
    let shown = findings
        .families
        .iter()
        .filter(|ladder| ladder.is_contender);
    let shown: Vec<(&str, Measured)> = shown
        .filter_map(|ladder| Some((ladder.name.as_str(), dearest(ladder)?)))
        .collect();
    let Some((_, first)) = shown.first() else {
        return;
    };
    if first.objects.is_empty() {
        return;
    }
    out.push_str(
        "<h2>Where bias is</h2>\n<p>Light of each object in the picture, relative to the reference, by the dearest setting of each \
         method; ± is one standard error.</p>\n<div class=\"wide\"><table><tr><th>object</th><th>pixels</th>",
    );
    for (name, _) in &shown {
        let _ = write!(out, "<th>{}</th>", escaped(name));
    }
    out.push_str("</tr>\n");
    for object in &first.objects {
        let _ = write!(
            out,
            "<tr><td>{}</td><td>{}</td>",
            escaped(&object.name),
            object.pixels
        );
        for (_, rung) in &shown {
            let same = rung.objects.iter().find(|other| other.name == object.name);
            let _ = write!(
                out,
                "<td>{}</td>",
                signed(same.map(|o| [o.relative, o.deviation]))
            );
        }
        out.push_str("</tr>\n");
    }
    out.push_str("</table></div>\n");
}

fn everything(findings: &Findings, out: &mut String) {
    out.push_str(
        "<details><summary>All settings that were measured</summary><div class=\"wide\"><table><tr><th>method</th><th>solve, s</th>\
         <th>first view besides, s</th><th>view, s</th><th>error</th><th>all pixels</th><th>variance</th><th>bias²</th><th>all light</th><th>ꟻLIP</th>\
         <th>95 %</th><th>flicker</th><th>rays</th><th class=\"left\">settings</th></tr>\n",
    );
    for ladder in &findings.families {
        for rung in &ladder.rungs {
            let flicker = rung
                .flicker
                .map_or("–".to_owned(), |f| format!("{:.2}", f.flicker));
            let _ = writeln!(
                out,
                "<tr><td>{}</td><td>{:.3}</td><td>{:.3}</td><td>{:.3}</td><td>{}</td><td>{:.2} %</td><td>{:.1e}</td><td>{:.1e}</td><td>{}</td>\
                 <td>{:.3}</td><td>{:.3}</td><td>{flicker}</td><td>{:.1} M</td><td class=\"left\"><code>{}</code></td></tr>",
                escaped(&ladder.name),
                rung.solve,
                rung.first,
                rung.view,
                error(rung),
                percent(rung.error_of_all),
                rung.variance,
                rung.bias_squared,
                signed(rung.energy),
                rung.flip[0],
                rung.flip[1],
                rung.rays as f64 / 1_000_000.0,
                flags(rung)
            );
        }
    }
    out.push_str(
        "</table></div>\n<p class=\"soft\">Flicker: change of a frame to the next beyond what is shown, in 8-bit levels, the camera \
         turning half a degree. The same numbers are in <a href=\"trade.csv\">trade.csv</a> and <a href=\"trade.json\">trade.json</a>.</p></details>\n",
    );
}

fn power(fit: Option<Fit>) -> String {
    fit.map_or("–".into(), |fit| {
        format!(
            "{:.2} ({:.2} to {:.2})",
            fit.power, fit.interval[0], fit.interval[1]
        )
    })
}

fn theory(ladder: &Ladder, fit: Option<Fit>) -> String {
    let Some(theory) = ladder.theory else {
        return "–".into();
    };
    match fit {
        Some(fit) if (fit.interval[0]..=fit.interval[1]).contains(&theory) => {
            format!("{theory:.2}: yes")
        }
        Some(_) => format!("{theory:.2}: no"),
        None => format!("{theory:.2}"),
    }
}

/// The error with the standard error of itself: of a root, half of the relative one.
fn error(rung: &Measured) -> String {
    let squared = rung.resolved_error();
    let deviation = percent(squared) * 0.5 * rung.error_deviation / squared;
    format!("{:.2} ± {deviation:.2} %", percent(squared))
}

fn seconds(seconds: f64) -> String {
    if seconds < 10.0 {
        format!("{seconds:.2}")
    } else {
        format!("{seconds:.0}")
    }
}

fn signed(part: Option<[f64; 2]>) -> String {
    part.map_or("–".into(), |[part, deviation]| {
        format!("{:+.2} ± {:.2} %", 100.0 * part, 100.0 * deviation)
    })
}

fn flags(rung: &Measured) -> String {
    let flags = rung
        .settings
        .iter()
        .map(|(key, value)| format!("--{key} {value}"));
    escaped(&flags.collect::<Vec<_>>().join(" "))
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::trade::front::tests::findings;
    use crate::trade::results::ObjectBias;

    #[test]
    fn the_page_shows_everything_and_loads_nothing_from_elsewhere() {
        let mut findings = findings();
        findings.model = "a<b>.rgg".into();
        for rung in findings
            .families
            .iter_mut()
            .flat_map(|ladder| &mut ladder.rungs)
        {
            rung.objects.push(ObjectBias {
                name: "Leaf 3".into(),
                pixels: 20,
                relative: -0.031,
                deviation: 0.002,
            });
        }
        let page = html(&findings);
        assert!(page.contains("a&lt;b&gt;.rgg") && !page.contains("a<b>"));
        assert!(page.contains("-3.10 ± 0.20 %") && page.contains("1.00: yes"));
        assert_eq!(page.matches("<svg").count(), CAMERAS.len() + 2);
        for outside in ["http:", "https:", "<script", "@import"] {
            let found = page.replace("http://www.w3.org/2000/svg", "");
            assert!(!found.contains(outside), "{outside}");
        }
    }

    #[test]
    fn a_measurement_that_found_nothing_is_still_a_page() {
        let mut findings = findings();
        for ladder in &mut findings.families {
            ladder.rungs.clear();
            ladder.end = Some("the budget".into());
        }
        let page = html(&findings);
        assert!(page.contains("the budget") && !page.contains("NaN"));
    }
}
