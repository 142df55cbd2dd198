//! `validate`: the light transport against what is known on paper.

use super::args::ValidateArgs;
use super::extremes;
use super::shell::Shell;
use crate::math::functions::log10;
use crate::pipeline::audience::Audience;
use crate::pipeline::failure::Failure;
use crate::pipeline::store::JsonTarget;
use crate::pipeline::world::World;
use crate::validation::verdict::FALSE_ALARM;
use crate::validation::{self, Check, Finding};
use serde::Serialize;

/// Keys by which an earlier file of `validate --json` is known.
const KEYS: &[&str] = &["validated", "failed", "checks"];

/// The object that `--json` writes.
#[derive(Serialize)]
struct Protocol<'a> {
    /// The version that was validated.
    validated: &'static str,
    seed: i64,
    seconds: f64,
    /// Probability that a right program fails any of the checks.
    false_alarm: f64,
    failed: usize,
    checks: &'a [Finding],
}

/// Makes all checks and prints them.
pub(super) fn validate(shell: &Shell, args: &ValidateArgs) -> Result<(), Failure> {
    if args.extremes {
        return extremes::validate(shell, args);
    }
    let json = args.json.as_deref();
    let json = json
        .map(|json| JsonTarget::new(&shell.world, json, KEYS))
        .transpose()?;
    let seed = shell.flags.seed.value;
    shell.on_threads(&shell.flags, || {
        let start = shell.world.now();
        let mut checks = validation::all();
        if let Some(only) = &args.only {
            checks.retain(|check| check.id.starts_with(only));
            if checks.is_empty() {
                return Err(Failure::Usage(format!(
                    "no check has a name that begins with `{only}`: they begin with {}",
                    beginnings(&validation::all())
                )));
            }
        }
        let total = checks.len() as u64;
        shell.terminal.begins("validating");
        let progress = |done| shell.terminal.progress(done, total);
        let found = validation::run(&checks, seed.cast_unsigned(), &shell.cancel, &progress);
        shell.terminal.ends();
        let findings = found.ok_or(Failure::Stopped)?;
        let seconds = shell.world.now().saturating_sub(start).as_secs_f64();
        let failed = failed(&findings);
        shell.terminal.print(&table(&findings));
        if let Some(json) = &json {
            let protocol = Protocol {
                validated: env!("CARGO_PKG_VERSION"),
                seed,
                seconds,
                false_alarm: FALSE_ALARM,
                failed,
                checks: &findings,
            };
            json.write(&shell.world, &protocol)?;
        }
        judge(&findings)?;
        let all = findings.len();
        let line = format!("{all} checks, all hold, seed {seed} ({seconds:.2} s)");
        shell.terminal.note(&line);
        Ok(())
    })
}

/// How many numbers came out otherwise than on paper.
fn failed(findings: &[Finding]) -> usize {
    findings.iter().filter(|finding| !finding.ok).count()
}

/// A failure if any check failed.
fn judge(findings: &[Finding]) -> Result<(), Failure> {
    match failed(findings) {
        0 => Ok(()),
        failed => Err(Failure::Invalid {
            failed,
            checks: findings.len(),
        }),
    }
}

/// The first words of the checks' names, each once, in their order.
fn beginnings(checks: &[Check]) -> String {
    let mut words: Vec<&str> = Vec::new();
    for check in checks {
        let word = check.id.split('-').next().unwrap_or_default();
        if !words.contains(&word) {
            words.push(word);
        }
    }
    words.join(", ")
}

/// A line for each finding, under a line of headings.
fn table(findings: &[Finding]) -> String {
    let width = findings.iter().map(|finding| finding.id.len()).max();
    let width = width.unwrap_or(0);
    let mut out = format!(
        "{:4}  {:width$}  {:>12}  {:>12}  {:>10}  {:>10}  what\n",
        "", "check", "on paper", "measured", "error", "allowed"
    );
    for finding in findings {
        let verdict = if finding.ok { "ok" } else { "FAIL" };
        let measured = finding.measured.map_or("-".into(), digits);
        let error = finding.standard_error.map_or("-".into(), short);
        let reason = finding.reason.as_ref();
        let reason = reason.map_or(String::new(), |reason| format!(" ({reason})"));
        out.push_str(&format!(
            "{verdict:4}  {:width$}  {:>12}  {measured:>12}  {error:>10}  {:>10}  {}{reason}\n",
            finding.id,
            digits(finding.expected),
            short(finding.tolerance),
            finding.what,
        ));
    }
    out
}

/// A number with eight significant digits.
pub(super) fn digits(x: f64) -> String {
    significant(x, 8)
}

/// A number with two significant digits.
pub(super) fn short(x: f64) -> String {
    significant(x, 2)
}

fn significant(x: f64, n: usize) -> String {
    if x == 0.0 || !x.is_finite() {
        return x.to_string();
    }
    let decade = log10(x.abs()).floor() as i64;
    if (-4..9).contains(&decade) {
        let decimals = n as i64 - 1 - decade;
        format!("{x:.0$}", usize::try_from(decimals).unwrap_or(0))
    } else {
        format!("{x:.0$e}", n - 1)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::cli::outcome::show;
    use crate::cli::terminal::{Manner, ModelOutput, Terminal};
    use crate::integrator::CancelToken;

    #[test]
    fn numbers_are_shown_with_their_significant_digits() {
        let shown = [
            0.0,
            0.198_248_956_98,
            446.428_571_4,
            0.000_012_345,
            f64::NAN,
        ]
        .map(digits);
        assert_eq!(
            shown,
            ["0", "0.19824896", "446.42857", "1.2345000e-5", "NaN"]
        );
        assert_eq!(short(0.000_432), "0.00043");
    }

    fn finding(ok: bool) -> Finding {
        Finding {
            id: "x".into(),
            what: "what".into(),
            expected: 1.0,
            measured: None,
            standard_error: None,
            tolerance: 0.0,
            observations: 0,
            ok,
            reason: Some("why".into()),
        }
    }

    /// What people and scripts rely on: one failed check of many is exit code 1, and the message counts.
    #[test]
    fn one_failed_check_fails_the_command() {
        assert!(judge(&[]).is_ok() && judge(&[finding(true)]).is_ok());
        let failure = judge(&[finding(true), finding(false), finding(true)]).unwrap_err();
        let Failure::Invalid { failed, checks } = failure else {
            panic!("{failure:?}")
        };
        assert_eq!((failed, checks), (1, 3));
        let terminal = Terminal::new(Manner::Quiet, ModelOutput::Standard, CancelToken::default());
        assert_eq!(show(&terminal, &failure) as u8, 1);
    }

    #[test]
    fn a_failed_check_stands_out() {
        let text = table(&[finding(false)]);
        assert!(text.lines().nth(1).unwrap().starts_with("FAIL  x"));
        assert!(text.ends_with("what (why)\n"), "{text}");
    }
}
