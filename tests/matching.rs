//! What finding matches costs: no search outlasts its budget or the user's patience, and rules cost what they match, not
//! what exists. Work is counted in turns (nodes tried, matches, calls), never in seconds.

#![allow(clippy::unwrap_used, reason = "a helper that fails fails its test")]

use std::sync::Arc;
use std::sync::atomic::{AtomicUsize, Ordering};

use understory::growth::GrowthOptions;

#[path = "support/models.rs"]
mod models;
use models::Model;

/// A stand of 30 trees, each a stem of 40 internodes with one leaf each: about 2500 nodes.
const STAND: &str = "module Tree(int id); module I(int k); module Leaf(float area); module Stake(int id);
protected void init() [ Axiom ==> for (int t : 1:30) ([Tree(t) for (int k : 1:40) (I(k) [Leaf(k)])]); ]
";

/// Turns that a step with this body takes in the stand.
fn turns(body: &str) -> u64 {
    let text = format!("{STAND}public void run() {{ {body} }}");
    let model = Model::new(&text).unwrap().grown(1).unwrap();
    model.growth.turns()
}

#[test]
fn endless_searches_end_with_a_message_that_names_them() {
    for body in [
        "long n = count((* I, I, I *));",
        "long n = count((* a:I, b:Leaf, c:I, (a.k > 100 && b.area > 0 && c.k > 0) *));",
        "long n = count((* I (--)* Leaf, Leaf *));",
        "for (1:10000) { Leaf l = first((* l:Leaf, (l.area > 1000) *)); }",
        "for (1:10000) { long n = count((* Tree -minDescendants-> Leaf *)); }",
        "for (1:10000) { Leaf l = first((* I (--){3000} Leaf *)); }",
        "[ I, I, I ::> ; ]",
        "[ a:I (-->)* I, b:I, c:I, (a == b && b == c) ::> ; ]",
    ] {
        let text = format!("{STAND}public void run() {{\n{body}\n}}");
        let mut options = GrowthOptions::default();
        options.limits.steps = 200_000;
        let model = Model::with(&[("model.rgg", &text)], options, Box::new(|| false)).unwrap();
        let fault = model.grown(1).err().unwrap_or_default();
        assert!(fault.starts_with("4: this "), "{body}: {fault}");
        assert!(fault.contains("200000"), "{body}: {fault}");
    }
}

#[test]
fn a_stop_sign_ends_a_search() {
    for body in [
        "long n = count((* I, I, I, I *));",
        "long n = count((* I (--)* I (--)* I (--)* I *));",
        "[ I, I, I, I ::> ; ]",
    ] {
        let asked = Arc::new(AtomicUsize::new(0));
        let counter = Arc::clone(&asked);
        let stop = Box::new(move || counter.fetch_add(1, Ordering::Relaxed) > 3);
        let text = format!("{STAND}public void run() {{ {body} }}");
        let options = GrowthOptions::default();
        let model = Model::with(&[("model.rgg", &text)], options, stop).unwrap();
        let fault = model.grown(1).err().unwrap_or_default();
        assert!(fault.contains("stopped"), "{body}: {fault}");
        assert_eq!(asked.load(Ordering::Relaxed), 5, "{body}");
    }
}

/// Searches cost what they find and the ways to it. The bounds leave a factor of about 1.5.
#[test]
fn searches_cost_what_they_match() {
    const TREES: u64 = 30;
    const LEAVES: u64 = 30 * 40;
    for (body, most) in [
        // Nothing of the type: nothing to do.
        (
            "[ Stake ==> ; (* I *) Stake ==> ; I (* Stake *) ==> ; I > Stake ==> ; I --> Stake ==> ; ]",
            30,
        ),
        (
            "long n = count((* Stake (-->)+ Leaf *)) + count((* Tree, Stake, Leaf *));",
            30,
        ),
        // By type.
        ("[ t:Tree ::> t[id] += 1; ]", 4 * TREES),
        ("[ Tree (* I *) ::> ; ]", 6 * TREES),
        ("[ (* Tree *) I ::> ; ]", 6 * TREES),
        ("[ (* I *) +> Leaf(3) ::> ; ]", 6 * LEAVES),
        // From the known end.
        (
            "Tree t = first((* Tree *)); long n = count((* t (-->)+ Leaf *));",
            3 * TREES + 6 * 80,
        ),
        (
            "Tree t = first((* Tree *)); long n = count((* I < t *));",
            3 * TREES + 20,
        ),
        (
            "for ((* t:Tree *)) { long n = count((* t (-->)+ Leaf *)); }",
            6 * 2 * LEAVES,
        ),
        (
            "for ((* l:Leaf *)) { Tree t = first((* l -ancestor-> Tree *)); }",
            8 * LEAVES + 24 * LEAVES,
        ),
        // Up to the tree: half a stem each.
        (
            "long n = count((* l:Leaf -ancestor-> t:Tree *));",
            6 * LEAVES + 24 * LEAVES,
        ),
        (
            "long n = count((* t:Tree -minDescendants-> i:I *));",
            6 * TREES,
        ),
        (
            "for ((* t:Tree *)) { double a = sum((* t -descendants-> Leaf *)[area]); }",
            6 * 2 * LEAVES,
        ),
    ] {
        let spent = turns(body);
        assert!(
            spent <= most,
            "{body}: {spent} turns, {most} expected at most"
        );
    }
}
