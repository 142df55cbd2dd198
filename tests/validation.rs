//! The numbers that are known on paper: each is met, and none is forgotten.

#![allow(clippy::unwrap_used, reason = "a test may panic")]

use std::collections::BTreeSet;
use understory::integrator::CancelToken;
use understory::validation::{all, run};

/// False-alarm probability 1e-6 for all together; a fault of 2 % (5 % where the id ends in `-by-rays` and the factor is small)
/// in any is seen, or the check itself fails as too noisy.
#[test]
fn every_number_on_paper_is_met() {
    let findings = run(&all(), 1, &CancelToken::default(), &|_| {}).unwrap();
    let failed: Vec<String> = findings
        .iter()
        .filter(|finding| !finding.ok)
        .map(|finding| format!("{finding:#?}"))
        .collect();
    assert!(failed.is_empty(), "{}", failed.join("\n"));
}

#[test]
fn every_row_of_the_tables_has_its_checks() {
    let checks = all();
    let ids: BTreeSet<&str> = checks.iter().map(|check| &*check.id).collect();
    assert_eq!(ids.len(), checks.len(), "ids are unique");
    assert!(ids.iter().all(|id| !id.contains(char::is_whitespace)));
    let n = |start: &str, end: &str| {
        let of_kind = |id: &&&str| id.starts_with(start) && id.ends_with(end);
        ids.iter().filter(of_kind).count()
    };
    // 40 rows and ten arrangements beside them.
    // All but two disks close by.
    assert_eq!(n("factor-", "-by-light"), 48);
    assert_eq!(n("factor-", "-mesh"), 7);
    // All but the eight smallest.
    assert_eq!(n("factor-", "-by-rays"), 42);
    assert_eq!([n("glass-boundary-", ""), n("glass-sheet-", "")], [12, 36]);
    assert_eq!([n("enclosure-", ""), n("stack-", "")], [65, 14]);
    assert_eq!(n("sky-uniform", "") + n("sky-CIE", ""), 5);
    assert!(checks.iter().all(|check| check.expected.is_finite()));
}

#[test]
fn a_wish_to_stop_is_heard() {
    let cancel = CancelToken::default();
    cancel.cancel();
    assert!(run(&all(), 1, &cancel, &|_| {}).is_none());
}
