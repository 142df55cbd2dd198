//! What is outside of the tiers of the language: refused by name, with the place and what to write instead. One case, at least,
//! for each entry of the list.

#![allow(clippy::unwrap_used, reason = "a test fails by panicking")]

use understory::check::{SourceModel, check};
use understory::diag::{Diagnostic, SourceMap, render};
use understory::syntax;

/// The entry of the list, the model, what the message names, and what the advice does.
const CASES: &[(&str, &str, &str, &str)] = &[
    (
        "scales",
        "scaleclass Plant;\nmodule A;",
        "scaleclass",
        "one module",
    ),
    ("scales", "module A extends SRoot;", "SRoot", "one module"),
    (
        "scales",
        "protected void init() [ Axiom ==> TypeAxiom; ]",
        "TypeAxiom",
        "one module",
    ),
    (
        "scales",
        "protected void init() [ Axiom {# A #} ==> A; ]",
        "#",
        "scales",
    ),
    (
        "regions",
        "module A;\nvoid f() { println(count((* a:A, (a in cone(a, false, 45)) *))); }",
        "in cone",
        "location(x)",
    ),
    (
        "rates",
        "module A(float x);\nvoid f() [ a:A ::> a[x] :'= 1; ]",
        ":'=",
        ":+=",
    ),
    (
        "rates",
        "void f() { integrate(1); }",
        "integrate",
        "one step of the integration",
    ),
    (
        "rates",
        "void f() { ODE o = null; }",
        "ODE",
        "one step of the integration",
    ),
    (
        "reflection",
        "void f() { Method m = null; }",
        "Method",
        "in the text",
    ),
    (
        "reflection",
        "void f() { Class c = Class.forName(\"A\"); }",
        "Class",
        "in the text",
    ),
    (
        "threads",
        "void f() { Thread t = new Thread(); }",
        "Thread",
        "call the method",
    ),
    (
        "sockets",
        "import java.net.*;\nvoid f() { Socket s = new Socket(\"a\", 1); }",
        "Socket",
        "read a file",
    ),
    (
        "Jackson",
        "void f() { ObjectMapper m = new ObjectMapper(); }",
        "ObjectMapper",
        "PrintWriter",
    ),
    (
        "commons-math",
        "void f() { NormalDistribution d = null; }",
        "NormalDistribution",
        "as a method",
    ),
    (
        "commons-cli",
        "void f() { CommandLine c = null; }",
        "CommandLine",
        "in the model",
    ),
    ("JUnit", "void f() { Assert a = null; }", "Assert", "print"),
    (
        "jsc",
        "import jsc.distributions.Lognormal;\nvoid f() { Lognormal l = new Lognormal(1, 2); }",
        "Lognormal",
        "lognormal(",
    ),
    (
        "workbench",
        "void f() { Workbench w = null; }",
        "Workbench",
        "leave it out",
    ),
    (
        "registry",
        "void f() { Registry r = null; }",
        "Registry",
        "leave it out",
    ),
    (
        "transactions",
        "void f() { Transaction t = null; }",
        "Transaction",
        "leave it out",
    ),
    (
        "user interface",
        "void f() { JFrame w = new JFrame(); }",
        "JFrame",
        "leave it out",
    ),
    (
        "curves of knots",
        "void f() { NURBSCurve c = null; }",
        "NURBSCurve",
        "Sweep",
    ),
    (
        "height fields",
        "void f() { HeightField h = null; }",
        "HeightField",
        "curved shapes",
    ),
    (
        "solid geometry",
        "protected void init() [ Axiom ==> CSGNode; ]",
        "CSGNode",
        "curved shapes",
    ),
    (
        "interpretive rules",
        "void f() { applyInterpretation(); }",
        "applyInterpretation",
        "body",
    ),
    (
        "operators",
        "float operator$add(float a, float b) { return a; }",
        "operator$add",
        "method",
    ),
    (
        "vertex-vertex",
        "void f() { VVProducer p = null; }",
        "VVProducer",
        "Parallelogram",
    ),
    (
        "POV-Ray",
        "void f() { povray(); }",
        "povray",
        "understory render",
    ),
    (
        "import of geometry",
        "void f() { import3d(\"a.obj\"); }",
        "import3d",
        "obj",
    ),
];

fn faults(text: &str) -> (SourceMap, Vec<Diagnostic>) {
    let mut map = SourceMap::default();
    let file = map.add("model.rgg", text);
    let (ast, mut found) = syntax::parse(file, text);
    if !found.has_errors() {
        let name = "model".into();
        found.append(check(&[SourceModel { name, ast }]).1);
    }
    let found = found.sorted().into_iter().cloned().collect();
    (map, found)
}

#[test]
fn what_is_refused_is_named_with_what_to_write_instead() {
    let mut wrong = String::new();
    for (entry, text, named, advice) in CASES {
        let (map, found) = faults(text);
        let tells = |fault: &Diagnostic| {
            fault.primary.is_some()
                && fault.message.contains(named)
                && fault.hints.iter().any(|hint| hint.contains(advice))
        };
        // The type of a variable and the class that is made of it are two places.
        if found.len() > 2 || !found.iter().all(tells) || found.is_empty() {
            let shown: String = found
                .into_iter()
                .map(|f| render::render(&map, &f.into()))
                .collect();
            wrong.push_str(&format!("── {entry}: {text}\n{shown}\n"));
        }
    }
    assert!(wrong.is_empty(), "{wrong}");
}
