//! What a modeller is told when a model fails while it runs: each model with its whole report.
//!
//! The snapshot is the test: read it as a user would. Where, why, in which method, rule and step, at which node.

#![allow(clippy::unwrap_used, reason = "a test fails by panicking")]

use understory::check::{SourceModel, check};
use understory::diag::{Diagnostics, SourceMap, render};
use understory::growth::{Growth, GrowthOptions};
use understory::syntax;

/// Two modules, something that is null, and a table of three numbers.
const HEAD: &str = "module Bud(float len, int order);\nmodule Leaf(float size);\nBud lost = null;\nint[] table = {1, 2, 3};\n\
                    protected void init() [ Axiom ==> Bud(1, 0) Leaf(1); ]\n";

/// What happens, and the model: one file, with `HEAD` before it if it has no `init` of its own, or several with names.
const CASES: &[(&str, &[(&str, &str)])] = &[
    (
        "null in a rule",
        &[(
            "model",
            "public void run() [\n  Bud(x, o) ==> F(lost[len]) Bud(x, o + 1);\n]",
        )],
    ),
    (
        "index in a rule, some steps on",
        &[(
            "model",
            "public void run() [\n  Bud(x, o) ==> F(table[o]) Bud(x, o + 1);\n]",
        )],
    ),
    (
        "division in a method that a rule calls",
        &[(
            "model",
            "int share(int n) {\n  return 10 / (2 - n);\n}\npublic void run() [\n  Bud(x, o) ==> F(share(o)) Bud(x, o + 1);\n]",
        )],
    ),
    (
        "wrong cast",
        &[(
            "model",
            "public void run() {\n  Object o = \"three\";\n  Bud b = (Bud) o;\n}",
        )],
    ),
    (
        "endless recursion",
        &[(
            "model",
            "float deep(int n) {\n  return deep(n + 1);\n}\npublic void run() [\n  Bud(x, o) ==> F(deep(o));\n]",
        )],
    ),
    (
        "endless loop in a rule",
        &[(
            "model",
            "public void run() [\n  b:Bud ::> {\n    while (b[len] > 0) b[len] += 1;\n  }\n]",
        )],
    ),
    (
        "too many modules",
        &[(
            "model",
            "public void run() {\n  for (apply(60)) [\n    Bud(x, o) ==> Bud(x, o) Bud(x, o);\n  ]\n}",
        )],
    ),
    (
        "condition of a rule",
        &[(
            "model",
            "public void run() [\n  b:Bud, (10 / b[order] > 1) ==> F(1);\n]",
        )],
    ),
    (
        "condition of a query",
        &[(
            "model",
            "public void run() {\n  println(count((* b:Bud, (table[3 + b[order]] > 0) *)));\n}",
        )],
    ),
    (
        "method called for each node of a query",
        &[(
            "model",
            "module Part(int n) {\n  int half() {\n    return 8 / n;\n  }\n}\nprotected void init() [ Axiom ==> Part(0); ]\n\
             public void run() {\n  println(sum((* Part *).half()));\n}",
        )],
    ),
    (
        "nothing found",
        &[(
            "model",
            "public void run() {\n  Leaf big = selectWhere((* l:Leaf *), l[size] > 5);\n  println(big[size]);\n}",
        )],
    ),
    (
        "constructor",
        &[(
            "model",
            "module Twig(int n) {\n  int share = 10 / n;\n}\nprotected void init() [ Axiom ==> Twig(1); ]\n\
             public void run() [\n  Twig(n) ==> Twig(n - 1);\n]",
        )],
    ),
    (
        "imported file",
        &[
            (
                "main",
                "import static tools.*;\nmodule Part(int n);\nprotected void init() [ Axiom ==> Part(2); ]\n\
                 public void run() [\n  Part(n) ==> F(1) Part(fewer(n));\n]",
            ),
            (
                "tools",
                "static int fewer(int n) {\n  return 8 / (n - 2);\n}",
            ),
        ],
    ),
    (
        "variable of the model",
        &[(
            "model",
            "static int[] t = new int[3];\nstatic int v = t[3];\nprotected void init() [ Axiom ==> F(v); ]",
        )],
    ),
    (
        "exception of the model's own",
        &[(
            "model",
            "public void run() [\n  Bud(x, o) ==> { if (o == 0) throw new RuntimeException(\"no order\"); } F(x);\n]",
        )],
    ),
    (
        "node that is gone",
        &[(
            "model",
            "public void run() {\n  Leaf l = first((* Leaf *));\n  [ Leaf ==>> ; ]\n  derive();\n  println(l[size]);\n}",
        )],
    ),
    (
        "edge from a node to itself",
        &[(
            "model",
            "public void run() [\n  Bud(x, o) ==> F(x);\n  l:Leaf ==>> l l;\n]",
        )],
    ),
    (
        "root behind an arrow that embeds",
        &[("model", "protected void init() [\n  Axiom ==> ^ F(1);\n]")],
    ),
    (
        "mode that is not offered",
        &[(
            "model",
            "protected void init() {\n  setDerivationMode(PARALLEL_NON_DETERMINISTIC_MODE);\n}",
        )],
    ),
    (
        "number in a text",
        &[(
            "model",
            "public void run() {\n  println(Float.parseFloat(\"1,5\"));\n}",
        )],
    ),
    (
        "no file is in reach",
        &[(
            "model",
            "public void run() {\n  java.io.FileReader r = new java.io.FileReader(\"data.csv\");\n}",
        )],
    ),
];

/// The report of a model that fails within six steps.
fn report(files: &[(&str, &str)]) -> String {
    let mut map = SourceMap::default();
    let mut sources = vec![];
    for (name, text) in files {
        let head = if text.contains("void init") || files.len() > 1 {
            ""
        } else {
            HEAD
        };
        let text = format!("{head}{text}\n");
        let file = map.add(format!("{name}.rgg"), text.clone());
        let (ast, found) = syntax::parse(file, &text);
        assert!(!found.has_errors(), "{}", render::render(&map, &found));
        let name = (*name).into();
        sources.push(SourceModel { name, ast });
    }
    let (model, found) = check(&sources);
    assert!(!found.has_errors(), "{}", render::render(&map, &found));
    let mut options = GrowthOptions::default();
    options.limits.steps = 100_000;
    options.limits.nodes = 10_000;
    let mut growth = Growth::new(&model, options, Box::new(|_| {}), Box::new(|| false)).unwrap();
    let fault = growth.init().and_then(|()| growth.run(6));
    let fault = fault.expect_err("it should fail");
    render::render(&map, &Diagnostics::from(*fault))
}

#[test]
fn failures_are_explained() {
    let mut shown = String::new();
    for (what, files) in CASES {
        shown.push_str(&format!("──── {what}\n\n"));
        for (name, text) in *files {
            if files.len() > 1 {
                shown.push_str(&format!("{name}.rgg:\n"));
            }
            shown.push_str(&format!("{text}\n\n"));
        }
        shown.push_str(&format!("{}\n", report(files)));
    }
    insta::assert_snapshot!("failures", shown);
}

#[test]
fn every_failure_names_method_or_step() {
    for (what, files) in CASES {
        let shown = report(files);
        let has_step = shown.contains("in step ") || shown.contains("before step 1");
        assert!(
            has_step || shown.contains("before `init`"),
            "{what}: {shown}"
        );
        assert!(
            !shown.contains(":1:1 ]"),
            "{what} points at nothing: {shown}"
        );
    }
}
