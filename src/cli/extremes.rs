//! `validate --extremes`: the list of what must hold at the ends of all scales.

use super::args::ValidateArgs;
use super::extremes_page;
use super::shell::Shell;
use super::validating::{digits, short};
use crate::pipeline::audience::Audience;
use crate::pipeline::failure::Failure;
use crate::pipeline::store::{JsonTarget, PageTarget};
use crate::pipeline::threads::STACK;
use crate::pipeline::world::World;
use crate::validation::Finding;
use crate::validation::extremes::{self, Case, CaseFinding, Effort, Hooks};
use crate::validation::verdict::FALSE_ALARM;
use serde::Serialize;

/// Keys by which an earlier file of `validate --extremes --json` is known.
const KEYS: &[&str] = &["validated", "failed", "cases"];

/// The object that `--json` writes.
#[derive(Serialize)]
pub(super) struct Protocol<'a> {
    /// The version that was validated.
    pub(super) validated: &'static str,
    pub(super) seed: i64,
    pub(super) seconds: f64,
    #[serde(serialize_with = "as_word")]
    pub(super) effort: Effort,
    /// Probability that a right program fails any of the means.
    pub(super) false_alarm: f64,
    /// Checks that do not hold.
    pub(super) failed: usize,
    pub(super) cases: &'a [CaseFinding],
}

fn as_word<S: serde::Serializer>(effort: &Effort, to: S) -> Result<S::Ok, S::Error> {
    to.serialize_str(match effort {
        Effort::Short => "short",
        Effort::Full => "full",
    })
}

/// Makes the checks of all cases, prints them and writes what is asked for.
pub(super) fn validate(shell: &Shell, args: &ValidateArgs) -> Result<(), Failure> {
    let json = args.json.as_deref();
    let json = json.map(|path| JsonTarget::new(&shell.world, path, KEYS));
    let json = json.transpose()?;
    let page = args.page.as_deref();
    let page = page.map(|path| PageTarget::new(&shell.world, path, extremes_page::MARK));
    let page = page.transpose()?;
    let effort = if args.full {
        Effort::Full
    } else {
        Effort::Short
    };
    let seed = shell.flags.seed.value;
    shell.on_threads(&shell.flags, || {
        let start = shell.world.now();
        let cases = chosen(extremes::cases(effort), args.only.as_deref())?;
        let total = cases.iter().map(|case| case.checks.len() as u64).sum();
        shell.terminal.begins("validating");
        let progress = |done| shell.terminal.progress(done, total);
        let hooks = Hooks {
            seed: seed.cast_unsigned(),
            cancel: &shell.cancel,
            progress: &progress,
            clock: &|| shell.world.now(),
            stack: STACK,
        };
        let found = extremes::run(cases, &hooks);
        shell.terminal.ends();
        let found = found.ok_or(Failure::Stopped)?;
        let seconds = shell.world.now().saturating_sub(start).as_secs_f64();
        let protocol = Protocol {
            validated: env!("CARGO_PKG_VERSION"),
            seed,
            seconds,
            effort,
            false_alarm: FALSE_ALARM,
            failed: findings(&found).filter(|finding| !finding.ok).count(),
            cases: &found,
        };
        shell.terminal.print(&table(&found));
        if let Some(json) = &json {
            json.write(&shell.world, &protocol)?;
        }
        if let Some(page) = &page {
            page.write(&shell.world, &extremes_page::page(&protocol))?;
        }
        let (failed, checks) = (protocol.failed, findings(&found).count());
        if failed > 0 {
            return Err(Failure::Invalid { failed, checks });
        }
        let cases = found.len();
        let line =
            format!("{cases} cases, {checks} checks, all hold, seed {seed} ({seconds:.2} s)");
        shell.terminal.note(&line);
        Ok(())
    })
}

fn findings(cases: &[CaseFinding]) -> impl Iterator<Item = &Finding> {
    cases
        .iter()
        .flat_map(|case| &case.checks)
        .map(|check| &check.finding)
}

/// The case that is called so, or the checks whose names begin so with their cases.
fn chosen(mut cases: Vec<Case>, only: Option<&str>) -> Result<Vec<Case>, Failure> {
    let Some(only) = only else {
        return Ok(cases);
    };
    if cases.iter().any(|case| case.id == only) {
        cases.retain(|case| case.id == only);
        return Ok(cases);
    }
    for case in &mut cases {
        case.checks.retain(|check| check.id.starts_with(only));
    }
    cases.retain(|case| !case.checks.is_empty());
    if cases.is_empty() {
        let last = extremes::cases(Effort::Short).pop();
        let last = last.map_or(String::new(), |case| case.id);
        return Err(Failure::Usage(format!(
            "no case is called `{only}` and no check has a name that begins so: cases are C-1 to {last}"
        )));
    }
    Ok(cases)
}

/// How much of what is allowed a number uses up: 1 at the limit; where nothing is allowed, 0 or 1.
pub(super) fn share(finding: &Finding) -> f64 {
    let off = finding
        .measured
        .map_or(f64::INFINITY, |found| (found - finding.expected).abs());
    match finding.tolerance {
        _ if off == 0.0 => 0.0,
        allowed if allowed > 0.0 && off.is_finite() => off / allowed,
        _ => 1.0_f64.max(f64::from(!finding.ok)),
    }
}

/// A line for each case, and one for each check that does not hold.
fn table(cases: &[CaseFinding]) -> String {
    let mut out = format!(
        "{:4}  {:5}  {:>6}  {:>7}  {:>8}  what\n",
        "", "case", "checks", "used", "seconds"
    );
    for case in cases {
        let verdict = match case.ok {
            Some(true) => "ok",
            Some(false) => "FAIL",
            None => "-",
        };
        let used = case.checks.iter().map(|check| share(&check.finding));
        let used = used.fold(0.0, f64::max);
        let elsewhere = if case.checks.is_empty() {
            format!(" (tested elsewhere: {})", case.elsewhere)
        } else {
            String::new()
        };
        out.push_str(&format!(
            "{verdict:4}  {:5}  {:>6}  {:>5.0} %  {:>8.2}  {}{elsewhere}\n",
            case.id,
            case.checks.len(),
            100.0 * used.min(99.0),
            case.seconds,
            case.what
        ));
        for check in case.checks.iter().filter(|check| !check.finding.ok) {
            let finding = &check.finding;
            let reason = finding.reason.as_ref();
            let reason = reason.map_or(String::new(), |reason| format!(" ({reason})"));
            out.push_str(&format!(
                "      {}: {} instead of {} ± {}: {}{reason}\n",
                finding.id,
                finding.measured.map_or("nothing".into(), digits),
                digits(finding.expected),
                short(finding.tolerance),
                finding.what,
            ));
        }
    }
    out
}
