//! The page of `validate --extremes`: what was measured and what is allowed, case by case, in one file that needs nothing else.

use super::extremes::{Protocol, share};
use super::validating::{digits, short};
use crate::validation::extremes::{CaseFinding, Effort, Group, TimedFinding};
use std::fmt::Write;

/// By what an earlier page of this kind is known.
pub(super) const MARK: &str = "<!doctype html>\n<!-- understory validate --extremes -->\n";

/// Checks up to which those of a case are shown without being asked for.
const FEW: usize = 8;

const STYLE: &str = "\
:root { color-scheme: light dark; --line: #8884; --soft: #8882; --dim: light-dark(#5a6068, #9aa3ad); \
--ok: light-dark(#1a7f37, #4ac26b); --bad: light-dark(#c4231c, #ff7b72); --none: light-dark(#8a6100, #e3b341); }
body { font: 15px/1.45 system-ui, sans-serif; max-width: 76rem; margin: 2rem auto; padding: 0 1rem; \
background: light-dark(#fff, #14181c); color: light-dark(#1c2024, #dde3e8); }
h1 { font-size: 1.5rem; margin: 0 0 .3rem; }
h2 { font-size: 1.1rem; margin: 2rem 0 .4rem; }
p { margin: .3rem 0; color: var(--dim); }
p b { color: light-dark(#1c2024, #dde3e8); }
details { border-top: 1px solid var(--line); padding: .35rem 0; }
summary { display: grid; grid-template-columns: 4.6rem 3.6rem 1fr 7rem 5rem 5rem; gap: .6rem; align-items: baseline; cursor: pointer; }
summary::marker { content: ''; }
summary:focus-visible { outline: 2px solid var(--dim); }
.ok { color: var(--ok); } .fail { color: var(--bad); font-weight: 700; } .none { color: var(--none); }
.n { text-align: right; font-variant-numeric: tabular-nums; white-space: nowrap; }
.dim { color: var(--dim); }
.bar { display: inline-block; width: 6rem; height: .55rem; background: var(--soft); border-radius: .3rem; overflow: hidden; }
.bar i { display: block; height: 100%; background: var(--ok); } .bar i.fail { background: var(--bad); }
.wide { overflow-x: auto; margin: .3rem 0 .6rem 4.6rem; }
table { border-collapse: collapse; width: 100%; font-size: .87rem; }
th { text-align: left; font-weight: 600; color: var(--dim); }
th, td { padding: .15rem .5rem .15rem 0; vertical-align: baseline; }
tr + tr td { border-top: 1px solid var(--soft); }
code { font-size: .92em; }
@media (max-width: 50rem) { summary { grid-template-columns: 4rem 3.2rem 1fr; } summary .n, summary .bar { display: none; } \
.wide { margin-left: 0; } }
";

/// The page.
pub(super) fn page(protocol: &Protocol<'_>) -> String {
    let mut out = String::from(MARK);
    out.push_str("<html lang=\"en\">\n<meta charset=\"utf-8\">\n");
    out.push_str("<meta name=\"viewport\" content=\"width=device-width, initial-scale=1\">\n");
    out.push_str("<title>understory: the extremes</title>\n<style>\n");
    out.push_str(STYLE);
    out.push_str("</style>\n");
    push(&mut out, format_args!("<h1>The extremes</h1>\n"));
    push(&mut out, format_args!("{}", summary(protocol)));
    for group in [
        Group::Exchange,
        Group::Geometry,
        Group::Photons,
        Group::Optics,
        Group::Arithmetic,
        Group::Canopies,
    ] {
        let own = protocol.cases.iter().filter(|case| case.group == group);
        let own: Vec<&CaseFinding> = own.collect();
        if own.is_empty() {
            continue;
        }
        push(&mut out, format_args!("<h2>{}</h2>\n", group.name()));
        for case in own {
            push_case(&mut out, case);
        }
    }
    out.push_str("</html>\n");
    out
}

/// Writing into memory does not fail.
fn push(out: &mut String, text: std::fmt::Arguments<'_>) {
    let _ = out.write_fmt(text);
}

fn summary(protocol: &Protocol<'_>) -> String {
    let checks: usize = protocol.cases.iter().map(|case| case.checks.len()).sum();
    let (verdict, class) = match protocol.failed {
        0 => ("all hold".to_owned(), "ok"),
        n => (format!("{n} do not hold"), "fail"),
    };
    let effort = match protocol.effort {
        Effort::Short => {
            "short: what takes minutes was done in part, as its lines say; <code>--full</code> does all"
        }
        Effort::Full => "full",
    };
    format!(
        "<p><b>{} cases, {checks} checks: <span class=\"{class}\">{verdict}</span>.</b> \
         understory {}, seed {}, {:.1} s. Run: {effort}.</p>\n\
         <p>A bar is how much of what is allowed was used up. A mean is allowed what chance makes of it, such that a right program fails \
         any of them once in {:.0} seeds; a <i>±</i> is its standard error. Seconds are those of one thread.</p>\n",
        protocol.cases.len(),
        protocol.validated,
        protocol.seed,
        protocol.seconds,
        1.0 / protocol.false_alarm,
    )
}

fn push_case(out: &mut String, case: &CaseFinding) {
    let (verdict, class) = match case.ok {
        Some(true) => ("ok", "ok"),
        Some(false) => ("FAIL", "fail"),
        None => ("elsewhere", "none"),
    };
    let is_open = case.checks.len() <= FEW || case.ok == Some(false);
    let worst = case.checks.iter().map(|check| share(&check.finding));
    let worst = worst.fold(0.0, f64::max);
    let n = match case.checks.len() {
        1 => "1 check".to_owned(),
        n => format!("{n} checks"),
    };
    push(
        out,
        format_args!(
            "<details id=\"{id}\"{open}><summary><span class=\"{class}\">{verdict}</span><b>{id}</b><span>{what}</span>{bar}\
             <span class=\"n dim\">{n}</span><span class=\"n dim\">{:.2} s</span></summary>\n<div class=\"wide\">\n",
            case.seconds,
            id = case.id,
            open = if is_open { " open" } else { "" },
            what = escaped(case.what),
            bar = bar(worst, case.ok != Some(false)),
        ),
    );
    if !case.elsewhere.is_empty() {
        let beside = if case.checks.is_empty() {
            "Tested"
        } else {
            "Not measured here"
        };
        push(
            out,
            format_args!("<p>{beside}: {}</p>\n", coded(case.elsewhere)),
        );
    }
    if !case.checks.is_empty() {
        out.push_str(
            "<table><tr><th></th><th>check</th><th>what</th><th class=\"n\">expected</th><th class=\"n\">measured</th>\
             <th class=\"n\">allowed</th><th></th><th class=\"n\">s</th></tr>\n",
        );
        for check in &case.checks {
            push_check(out, check);
        }
        out.push_str("</table>\n");
    }
    out.push_str("</div></details>\n");
}

fn push_check(out: &mut String, check: &TimedFinding) {
    let finding = &check.finding;
    let (verdict, class) = if finding.ok {
        ("ok", "ok")
    } else {
        ("FAIL", "fail")
    };
    let measured = finding.measured.map_or("–".into(), digits);
    let error = finding.standard_error.map(short);
    let error = error.map_or(String::new(), |error| format!(" ± {error}"));
    let reason = finding.reason.as_ref();
    let reason = reason.map_or(String::new(), |reason| format!(" ({reason})"));
    push(
        out,
        format_args!(
            "<tr><td class=\"{class}\">{verdict}</td><td><code>{}</code></td><td>{}{}</td><td class=\"n\">{}</td>\
             <td class=\"n\">{measured}{error}</td><td class=\"n\">± {}</td><td>{}</td><td class=\"n dim\">{:.2}</td></tr>\n",
            escaped(&finding.id),
            escaped(&finding.what),
            escaped(&reason),
            digits(finding.expected),
            short(finding.tolerance),
            bar(share(finding), finding.ok),
            check.seconds,
        ),
    );
}

/// How much of what is allowed was used up.
fn bar(share: f64, is_ok: bool) -> String {
    let class = if is_ok { "" } else { " class=\"fail\"" };
    let width = 100.0 * share.clamp(0.0, 1.0);
    format!("<span class=\"bar\"><i{class} style=\"width:{width:.0}%\"></i></span>")
}

/// As text of a page.
fn escaped(text: &str) -> String {
    let text = text.replace('&', "&amp;").replace('<', "&lt;");
    text.replace('>', "&gt;").replace('"', "&quot;")
}

/// The same, with what stands between backquotes as code.
fn coded(text: &str) -> String {
    let parts = text.split('`').enumerate();
    let part = |(at, part): (usize, &str)| match at % 2 {
        0 => escaped(part),
        _ => format!("<code>{}</code>", escaped(part)),
    };
    parts.map(part).collect()
}
