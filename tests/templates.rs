//! Rules that are templates are applied in bulk; the graph, what is printed, the draws and the errors must be what making
//! node by node gives, for any number of threads.

#![allow(
    clippy::unwrap_used,
    reason = "a test may stop where its data is not as it must be"
)]

use proptest::prelude::*;
use std::path::{Path, PathBuf};
use std::sync::{Arc, Mutex};

use understory::check::{SourceModel, check};
use understory::diag::SourceMap;
use understory::eval::Limits;
use understory::growth::{Growth, GrowthOptions};
use understory::syntax::parse;

/// All that can be seen of a run: what is printed, and after each step the graph or the error.
fn run(source: &str, steps: u64, limits: Limits, uses_templates: bool) -> Option<Vec<String>> {
    let mut sources = SourceMap::default();
    let id = sources.add("model.rgg", source);
    let (ast, diagnostics) = parse(id, source);
    let name = "model".to_owned();
    let (model, found) = check(&[SourceModel { name, ast }]);
    if diagnostics.has_errors() || found.has_errors() {
        return None;
    }
    let printed = Arc::new(Mutex::new(String::new()));
    let sink = Arc::clone(&printed);
    let output = Box::new(move |text: &str| sink.lock().unwrap().push_str(text));
    let options = GrowthOptions {
        limits,
        ..GrowthOptions::default()
    };
    let mut growth = Growth::new(&model, options, output, Box::new(|| false)).unwrap();
    if !uses_templates {
        growth.avoid_templates();
    }
    let mut seen = vec![];
    let mut result = growth.init();
    for _ in 0..steps {
        seen.push(match &result {
            Ok(()) => format!("{:016x} {}", growth.hash(), growth.tree_text()),
            Err(fault) => format!("{fault:?}"),
        });
        assert_eq!(growth.graph().validate(), Ok(()), "{source}");
        if result.is_err() || growth.total() > 20_000 {
            break;
        }
        result = growth.step();
    }
    seen.push(printed.lock().unwrap().clone());
    Some(seen)
}

fn assert_same(source: &str, steps: u64, limits: Limits) {
    let bulk = run(source, steps, limits, true);
    let single = run(source, steps, limits, false);
    assert!(
        bulk == single,
        "{source}\nin bulk {bulk:#?}\nelse {single:#?}"
    );
}

fn models(folder: &str) -> Vec<PathBuf> {
    let mut found = vec![];
    let mut open = vec![Path::new(env!("CARGO_MANIFEST_DIR")).join(folder)];
    while let Some(folder) = open.pop() {
        for entry in std::fs::read_dir(folder).unwrap() {
            let path = entry.unwrap().path();
            if path.is_dir() {
                open.push(path);
            } else if path.extension().is_some_and(|e| e == "rgg") {
                found.push(path);
            }
        }
    }
    found.sort();
    found
}

#[test]
fn all_models_grow_the_same_either_way() {
    let folders = ["tests/golden", "tests/abop", "examples"];
    let limits = Limits {
        steps: 1 << 22,
        ..Limits::default()
    };
    for path in folders.iter().flat_map(|folder| models(folder)) {
        let source = std::fs::read_to_string(&path).unwrap();
        assert_same(&source, 4, limits);
    }
}

/// Models in which all, some or none of the rules are templates.
const MODELS: [&str; 12] = [
    "module A(float x); protected void init() [ Axiom ==> A(1); ]
     public void run() [ A(x) ==> F(x) [RU(30) RH(90) A(x*0.8)] [RU(-30) RH(90) A(x*0.8)]; ]",
    "protected void init() [ Axiom ==> F(1); ]
     public void run() [ F(x) ==> F(x/3) RU(60) F(x/3) RU(-120) F(x/3) RU(60) F(x/3); ]",
    "module X; protected void init() [ Axiom ==> X; ]
     public void run() [ X ==> F(1) [RU(-25) X] [RU(25) X] F(1) X; F ==> F(1) F(1); ]",
    // Draws, in a condition and in arguments, in the order of the matches.
    "module A(float x, int n) extends F(x, 0.1); protected void init() [ Axiom ==> A(1, 0); ]
     public void run() [ A(x, n), (probability(0.8) && x > 0.1) ==>
        F(x * random(0.9, 1.1)) [RU(normal(30, 5)) A(x * 0.8, irandom(0, 9))] A(x * random(0.5, 1), n + 1);
        A ==> M(3); ]
     public void more() { println(random(0, 1)); }",
    // Kept nodes with children of all kinds; several branches on the replaced one.
    "module A(float x); module B(double y, long n, boolean b, byte c);
     protected void init() [ Axiom ==> M [A(1)] [A(2)] [A(3) [B(1, 2, true, 200)] [M A(9)]] A(4) [A(5)] [M] A(6); ]
     public void run() [ A(x) ==> B(x, 7, x > 2, 300) [M(x)] [M(2 * x)]; B(y, n, b, c) ==> A((float) y) [A(n)]; ]",
    // A left context; a refinement edge; nodes that no rule names.
    "module A(float x); protected void init() [ Axiom ==> A(1) A(2) [A(3)] A(4) A(5); ]
     public void run() [ (* A(y) *) A(x), (x > 1) ==> A(x - 1) /> M(y) > A(y) +> M(2); ]",
    // The second rule is no template: all goes the slow way.
    "module A(float x); protected void init() [ Axiom ==> A(1) F(1) A(2); ]
     public void run() [ A(x) ==> A(x + 1) [M] A(x); f:F(x) ==> f [A(x)]; M ==> ; ]",
    // Leading brackets, separators, deferred assignments.
    "module A(float x); protected void init() [ Axiom ==> A(1) F(1) A(2); ]
     public void run() [ A(x) ==> A(x + 1) M; f:F ::> f[length] :+= 1; M ==> [F(2)] M, ^ F(3); ]",
    // Two blocks in one step; queries and new nodes between them.
    "module A(float x); module B; protected void init() [ Axiom ==> A(1) B A(2); ]
     public void run() { [ A(x) ==> A(x + 1) [B]; ] println(count((* A *))); F f = new F(2); println(f);
        [ B ==> B B; ] derive(); println(sum((* A *)[x])); [ A(x) ==> A(x - 1) F(x); ] }",
    // An error in the middle, caught.
    "module A(int x); protected void init() [ Axiom ==> A(3) A(1) A(0) A(2); ]
     public void run() { try { [ A(x) ==> A(6 / x) M(x); ] } catch (Exception e) { println(e); } [ M(x) ==> A(1); ] }",
    // Places are used again: the population does not grow.
    "module A(float x); module B(float x); protected void init() [ Axiom ==> for (1:50) ([A(1)] [B(2)]); ]
     public void run() [ A(x) ==> B(x + 1); B(x), (x < 5) ==> A(x) F(x); F(x) ==> M(1); ]",
    // Types that extend others; a node with a constructor that does more than store.
    "module P(float x) extends F(x) { float area = 2; int n = 3; } module Q extends P(7); module R(float x) { float y = 2 * x; }
     protected void init() [ Axiom ==> P(1) Q R(3); ]
     public void run() [ P ==> Q [P(4)] R(1); R(x) ==> P(x); ]",
];

#[test]
fn templates_are_what_single_matches_are() {
    for source in MODELS {
        assert_same(source, 6, Limits::default());
    }
}

#[test]
fn limits_stop_both_ways_at_the_same_place() {
    // A single match that fails half-way keeps its first nodes from being used again; a template makes none.
    let whole = |source: &&&str| !source.contains("catch");
    for source in MODELS.iter().filter(whole) {
        for nodes in [20, 57, 200] {
            assert_same(
                source,
                8,
                Limits {
                    nodes,
                    ..Limits::default()
                },
            );
        }
        // The budget is looked at now and then only.
        let steps = 1 << 14;
        assert_same(
            source,
            12,
            Limits {
                steps,
                ..Limits::default()
            },
        );
    }
}

/// A constructor that the model wrote runs, also the one of a parent.
#[test]
fn written_constructors_run() {
    let source = "module A(float x) { int n = 5; A(float x, float y) { this.x = x + y; n = 9; println(n); } }
        module B(float y) extends A(y, 2);
        module C(super.length) extends F(length) { C(float a, float b) { length = a * b; } }
        protected void init() [ Axiom ==> A(1, 2) A(4) B(3) C(2, 3) C(7); ]
        public void run() [ A(x) ==> A(x, 1) C(x, x); ]";
    assert_same(source, 2, Limits::default());
    let seen = run(source, 1, Limits::default(), true).unwrap();
    assert!(
        seen[0].contains("A(3)") && seen[0].contains("C(6)"),
        "{seen:?}"
    );
    assert!(
        seen[0].contains("A(4)") && seen[0].contains("C(7)"),
        "{seen:?}"
    );
}

#[test]
fn the_number_of_threads_changes_nothing() {
    let folder = tempfile::tempdir().unwrap();
    let (model, report) = (folder.path().join("m.rgg"), folder.path().join("r.json"));
    let source = "protected void init() [ Axiom ==> F(1); ]
        public void run() [ F(x) ==> F(x * random(0.3, 0.4)) RU(irandom(50, 70)) F(x / 3) [M F(x)] RU(-120) F; ]";
    std::fs::write(&model, source).unwrap();
    let hash = |threads: &str| {
        let mut command = assert_cmd::Command::cargo_bin("understory").unwrap();
        command.args(["derive", "--steps", "8", "--threads", threads, "--json"]);
        command.arg(&report).arg(&model).assert().success();
        let report = std::fs::read_to_string(&report).unwrap();
        let report: serde_json::Value = serde_json::from_str(&report).unwrap();
        assert!(report["total"].as_u64().unwrap() > 3 << 13, "{report}");
        report["hash"].clone()
    };
    let single = hash("1");
    assert!(single.is_string() || single.is_number(), "{single}");
    assert_eq!([hash("2"), hash("3")], [single.clone(), single]);
}

/// A right-hand side.
fn right_side() -> impl Strategy<Value = String> {
    let node = prop_oneof![
        Just("A(x)".to_owned()),
        Just("A(x * 0.5)".to_owned()),
        Just("B(x, 1)".to_owned()),
        Just("M".to_owned()),
        Just("F(random(0, x))".to_owned()),
        Just("+> M(2)".to_owned()),
    ];
    let pieces = node.prop_recursive(3, 12, 4, |inner| {
        prop::collection::vec(inner, 1..4).prop_map(|pieces| format!("[{}]", pieces.join(" ")))
    });
    (
        prop_oneof![12 => Just("C"), 1 => Just("")],
        prop::collection::vec(pieces, 1..4),
    )
        .prop_map(|(first, rest)| format!("{first} {}", rest.join(" ")))
}

/// A rule; most are templates.
fn rule() -> impl Strategy<Value = String> {
    let left = prop_oneof![
        4 => Just("A(x)".to_owned()),
        3 => Just("B(x, n)".to_owned()),
        2 => Just("F(x)".to_owned()),
        2 => Just("A(x), (x > 0.3)".to_owned()),
        1 => Just("A(x), (probability(x))".to_owned()),
        1 => Just("(* M *) A(x)".to_owned()),
        1 => Just("A(x) M".to_owned()),
    ];
    prop_oneof![
        9 => (left, right_side()).prop_map(|(left, right)| format!("{left} ==> {right};")),
        1 => Just("F(x) ==> ;".to_owned()),
        1 => Just("c:C ==> c [A(1)];".to_owned()),
        1 => Just("M ==>> C M;".to_owned()),
        1 => Just("f:F ::> { f[length] += 1; println(f); }".to_owned()),
    ]
}

proptest! {
    #![proptest_config(ProptestConfig { cases: 150, failure_persistence: None, ..Default::default() })]

    #[test]
    fn random_models_grow_the_same_either_way(rules in prop::collection::vec(rule(), 1..4)) {
        let source = format!(
            "module A(float x); module B(float x, int n) extends F(x, 1); module C;
            protected void init() [ Axiom ==> A(1) [B(2, 1) M F(3)] [A(0.5)] M A(0.2) [F(1)] B(1, 2) M; ]
            public void run() [ {} ]",
            rules.join("\n")
        );
        prop_assert!(run(&source, 1, Limits::default(), true).is_some(), "{source}");
        assert_same(&source, 5, Limits { nodes: 3000, ..Limits::default() });
    }
}
