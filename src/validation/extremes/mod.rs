//! What must hold at the ends of all scales: the list of cases, each with what was measured and what is allowed.
//!
//! A case is one line of a fixed list, numbered C-1 to C-72; its checks are those of [`validation`](super) that belong to it and
//! others that are made only here. `understory validate --extremes` makes them all; the tests demand that all hold.
//!
//! ```text
//! list        the cases                       looks       looking at scenes, a world to look at
//! exchange    form factors                    rows        rows of form factors in closed rooms
//! rooms       solvers in closed rooms         ways        other ways to the same mean
//! scale       units, places                   solids      closed bodies, instances
//! degenerate  thin, flat, doubled, no number  photons     photon maps
//! laid        photons laid out by hand        books       photons one by one
//! seeing      cameras, lamps, empty scenes    lobes       scattering
//! arithmetic  sums, random numbers, choices   bounds      threads, stopping, bytes, memory
//! canopies    leaves at random                organs      light on single organs
//! ```

mod arithmetic;
mod books;
mod bounds;
mod canopies;
mod degenerate;
mod exchange;
mod laid;
mod list;
mod lobes;
mod looks;
mod organs;
mod photons;
mod rooms;
mod rows;
mod scale;
mod seeing;
mod solids;
mod ways;

use super::check::{Check, Finding, Setting, Trouble};
use super::verdict::Family;
use crate::integrator::CancelToken;
pub use list::Group;
use list::LINES;
use serde::Serialize;
use std::sync::Mutex;
use std::sync::atomic::{AtomicUsize, Ordering};
use std::time::Duration;

/// How much is done.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Effort {
    /// What takes long is done in part; what is measured says so.
    Short,
    /// All of it, such as 10⁹ samples and 10⁸ photons: minutes, and 8 GiB.
    Full,
}

/// A line of the list with its checks.
pub struct Case {
    /// `C-1` to `C-72`.
    pub id: String,
    /// What it is about.
    pub group: Group,
    /// What must hold.
    pub what: &'static str,
    /// How it is measured.
    pub checks: Vec<Check>,
    /// What of it is not measured here, and where it is tested.
    pub elsewhere: &'static str,
}

/// What came of a case.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct CaseFinding {
    /// `C-1` to `C-72`.
    pub id: String,
    /// What it is about.
    pub group: Group,
    /// What must hold.
    pub what: &'static str,
    /// Whether all its checks hold; `None` if nothing was measured.
    pub ok: Option<bool>,
    /// What its checks took, seconds on one thread.
    pub seconds: f64,
    /// What of it is not measured here, and where it is tested.
    #[serde(skip_serializing_if = "str::is_empty")]
    pub elsewhere: &'static str,
    /// What was measured.
    pub checks: Vec<TimedFinding>,
}

/// What came of a check, and how long it took.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct TimedFinding {
    /// What came of it.
    #[serde(flatten)]
    pub finding: Finding,
    /// On one thread.
    pub seconds: f64,
}

/// What making checks depends on besides them.
#[derive(Clone, Copy)]
pub struct Hooks<'a> {
    /// Decides all random choices.
    pub seed: u64,
    /// Asked often; once it is set, checks end within a few seconds.
    pub cancel: &'a CancelToken,
    /// Told, from any thread, how many checks are done.
    pub progress: &'a (dyn Fn(u64) + Sync),
    /// The time since some moment.
    pub clock: &'a (dyn Fn() -> Duration + Sync),
    /// Stack of each thread, bytes.
    pub stack: usize,
}

/// All cases in their order.
#[must_use]
pub fn cases(effort: Effort) -> Vec<Case> {
    let mut checks = own(effort);
    checks.extend(super::all());
    let case = |line: &'static list::Line| Case {
        id: format!("C-{}", line.case),
        group: line.group,
        what: line.what,
        checks: take(&mut checks, line.case),
        elsewhere: line.elsewhere,
    };
    LINES.iter().map(case).collect()
}

/// The checks that are made only here.
fn own(effort: Effort) -> Vec<Check> {
    let mut checks = exchange::checks();
    checks.extend(rows::checks());
    checks.extend(rooms::checks());
    checks.extend(scale::checks());
    checks.extend(solids::checks(effort));
    checks.extend(degenerate::checks());
    checks.extend(photons::checks(effort));
    checks.extend(books::checks());
    checks.extend(seeing::checks());
    checks.extend(ways::checks());
    checks.extend(lobes::checks());
    checks.extend(arithmetic::checks(effort));
    checks.extend(bounds::checks());
    checks.extend(canopies::checks());
    checks.extend(organs::checks());
    checks
}

/// A check written as a row: the case, its name, what is measured, what that should be and how far it may be off, and how it is
/// measured.
type Row = (
    &'static str,
    &'static str,
    &'static str,
    (f64, f64),
    fn(&Setting<'_>) -> Result<f64, Trouble>,
);

fn checks_of(rows: impl IntoIterator<Item = Row>) -> Vec<Check> {
    let check = |(case, id, what, (expected, allowed), measure): Row| {
        Check::within((id, what), expected, allowed, measure).of_case(case)
    };
    rows.into_iter().map(check).collect()
}

/// Those that belong to a case, which are then gone from the others.
fn take(checks: &mut Vec<Check>, case: &str) -> Vec<Check> {
    let belongs = |check: &mut Check| check.case == Some(case);
    checks.extract_if(.., belongs).collect()
}

/// Makes the checks of all cases, each on one thread, as many at a time as there are threads in the surrounding pool. What is found
/// does not depend on that.
///
/// `None` if it was cancelled.
#[must_use]
pub fn run(cases: Vec<Case>, hooks: &Hooks<'_>) -> Option<Vec<CaseFinding>> {
    let checks: Vec<&Check> = cases.iter().flat_map(|case| &case.checks).collect();
    let n_means = checks.iter().filter(|check| check.is_mean()).count();
    let queue = Queue {
        family: Family::of(n_means),
        found: Mutex::new(vec![None; checks.len()]),
        next: AtomicUsize::new(0),
        done: AtomicUsize::new(0),
        checks,
        hooks,
    };
    let n_threads = rayon::current_num_threads();
    // Threads that do not share their work: what one takes is its own time.
    std::thread::scope(|scope| {
        for _ in 0..n_threads {
            scope.spawn(|| queue.work());
        }
    });
    let found = queue.found.into_inner().ok()?;
    let mut found = found.into_iter();
    let of_case = |case: &Case| -> Option<CaseFinding> {
        let checks = found.by_ref().take(case.checks.len());
        let checks: Vec<TimedFinding> = checks.collect::<Option<_>>()?;
        Some(CaseFinding {
            id: case.id.clone(),
            group: case.group,
            what: case.what,
            ok: (!checks.is_empty()).then(|| checks.iter().all(|check| check.finding.ok)),
            seconds: checks.iter().map(|check| check.seconds).sum(),
            elsewhere: case.elsewhere,
            checks,
        })
    };
    cases.iter().map(of_case).collect()
}

/// Checks that are waiting for a thread.
struct Queue<'a> {
    checks: Vec<&'a Check>,
    hooks: &'a Hooks<'a>,
    family: Family,
    found: Mutex<Vec<Option<TimedFinding>>>,
    next: AtomicUsize,
    done: AtomicUsize,
}

impl Queue<'_> {
    /// Makes one check after the other until there are no more.
    fn work(&self) {
        // What a check does in parallel it does here, or where there are no more threads to be had, in the pool of all.
        let builder = rayon::ThreadPoolBuilder::new().num_threads(1);
        let alone = builder.stack_size(self.hooks.stack).build();
        loop {
            let at = self.next.fetch_add(1, Ordering::Relaxed);
            let Some(check) = self.checks.get(at) else {
                return;
            };
            let found = match &alone {
                Ok(alone) => alone.install(|| self.make(check)),
                Err(_) => self.make(check),
            };
            let Some(found) = found else { return };
            if let Ok(mut all) = self.found.lock() {
                all[at] = Some(found);
            }
            let done = self.done.fetch_add(1, Ordering::Relaxed) + 1;
            (self.hooks.progress)(done as u64);
        }
    }

    fn make(&self, check: &Check) -> Option<TimedFinding> {
        let start = (self.hooks.clock)();
        let finding = check.make(self.hooks.seed, self.family, self.hooks.cancel)?;
        let seconds = (self.hooks.clock)().saturating_sub(start).as_secs_f64();
        Some(TimedFinding { finding, seconds })
    }
}
