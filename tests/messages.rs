//! The mistakes that people make most often, each with the report that they see.
//!
//! The snapshot is the test: read it as a user would.

#![allow(clippy::unwrap_used, reason = "a test fails by panicking")]

use understory::check::{SourceModel, check};
use understory::diag::{SourceMap, render};
use understory::syntax;

/// A model around `rules`: two modules, a variable, a method, and `run`.
fn in_run(rules: &str) -> String {
    format!(
        "module Bud(float len);\nmodule Leaf(float size, int age) ==> Parallelogram(size, size);\nint count = 0;\n\
         protected void init() [ Axiom ==> Bud(1) Leaf(1, 0); ]\npublic void run() [\n{rules}\n]\n"
    )
}

/// What is written, and whether it stands in `run` of the model above.
const CASES: &[(&str, bool, &str)] = &[
    // Marks and brackets.
    (
        "missing semicolon behind a rule",
        true,
        "    Bud(x) ==> F(x) Bud(x)\n    Leaf(s, a) ==> ;",
    ),
    (
        "missing semicolon behind a statement",
        false,
        "void f() {\n    int a = 1\n    a = 2;\n}",
    ),
    (
        "missing semicolon behind a module",
        false,
        "module A\nmodule B;\nprotected void init() [ Axiom ==> A B; ]",
    ),
    (
        "missing bracket of a branch",
        true,
        "    Bud(x) ==> F(x) [ RU(30) Bud(x) ;\n    Leaf(s, a) ==> ;",
    ),
    (
        "one bracket too many",
        true,
        "    Bud(x) ==> F(x) RU(30) ] Bud(x);",
    ),
    (
        "missing parenthesis",
        true,
        "    Bud(x) ==> F(x RU(30) Bud(x);",
    ),
    (
        "missing brace",
        false,
        "void f() {\n    if (1 < 2) {\n        println(1);\n}\nvoid g() { }",
    ),
    (
        "unclosed string",
        true,
        "    Bud(x) ==> { println(\"here); } F(x);",
    ),
    ("unclosed comment", false, "/* A model\nmodule A;"),
    ("comma for a point", true, "    Bud(x) ==> F(0,5, 1, 2, 3);"),
    ("typographic signs", true, "    Bud(x) → F(x – 1);"),
    // Rules.
    ("short arrow", true, "    Bud(x) => F(x);"),
    ("thin arrow", true, "    Bud(x) -> F(x);"),
    ("missing arrow", true, "    Bud(x) F(x) Bud(x);"),
    ("rule outside of brackets", false, "module A;\nA ==> F(1);"),
    (
        "rule in braces",
        false,
        "module A;\npublic void run() {\n    A ==> F(1);\n}",
    ),
    (
        "condition without a comma",
        true,
        "    Bud(x) (x > 1) ==> F(x);",
    ),
    (
        "single equals sign in a condition",
        true,
        "    Leaf(s, a), (a = 3) ==> ;",
    ),
    (
        "parameter missing in a pattern",
        true,
        "    Leaf(s) ==> F(s);",
    ),
    (
        "parameter too many in a pattern",
        true,
        "    Bud(x, y) ==> F(x) F(y);",
    ),
    (
        "code without braces",
        true,
        "    Bud(x) ==> F(x) count = count + 1;",
    ),
    (
        "assignment to an attribute among rules",
        true,
        "    b:Bud ==> b[len] = 2;",
    ),
    (
        "statement among rules",
        true,
        "    count = 1\n    Bud(x) ==> F(x);",
    ),
    // Names.
    ("unknown module", true, "    Bud(x) ==> F(x) Laef(1, 0);"),
    ("unknown turtle command", true, "    Bud(x) ==> Forward(x);"),
    (
        "wrong case of a command",
        true,
        "    Bud(x) ==> f(x) ru(30) Bud(x);",
    ),
    ("wrong case of a module", true, "    bud(x) ==> F(x);"),
    ("unknown variable", true, "    Bud(x) ==> F(y);"),
    ("unknown function", true, "    Bud(x) ==> F(rand(0, 1));"),
    ("sine without Math", true, "    Bud(x) ==> F(sin(x));"),
    ("unknown attribute", true, "    b:Bud ::> b[lenght] = 2;"),
    ("unknown method", true, "    b:Bud ::> b.setLenght(2);"),
    (
        "unknown type",
        true,
        "    { flaot a = 1; } Bud(x) ==> F(a);",
    ),
    (
        "module without the word",
        false,
        "Leaf(float size) extends Null;\nprotected void init() [ Axiom ==> Leaf(1); ]",
    ),
    ("parameter without a type", false, "module Leaf(size);"),
    ("misspelt keyword", false, "modul Leaf;"),
    (
        "word of the language as a name",
        false,
        "module Leaf(float long);",
    ),
    (
        "word of the language as a variable",
        false,
        "void f() { int new = 1; }",
    ),
    (
        "variable declared twice",
        false,
        "void f() { int a = 1; int a = 2; }",
    ),
    (
        "module declared twice",
        false,
        "module A;\nmodule A(int n);",
    ),
    // Types and numbers of arguments.
    (
        "too many arguments of a command",
        true,
        "    Bud(x) ==> RU(30, 40);",
    ),
    (
        "too few arguments of a command",
        true,
        "    Bud(x) ==> DMul;",
    ),
    (
        "too many arguments of F",
        true,
        "    Bud(x) ==> F(1, 2, 3, 4);",
    ),
    (
        "wrong arguments of a module",
        true,
        "    Bud(x) ==> Leaf(x, 1, 2);",
    ),
    (
        "wrong arguments of a function",
        true,
        "    Bud(x) ==> F(random(1));",
    ),
    (
        "wrong arguments of a method",
        false,
        "int twice(int n) { return 2 * n; }\nvoid f() { twice(1.5); }",
    ),
    ("double for int", false, "void f() { int n = 2.5; }"),
    (
        "float from a method that returns int",
        false,
        "int n(float x) { return x * 2; }",
    ),
    ("number as a condition", true, "    Leaf(s, a), (a) ==> ;"),
    ("text for a number", true, "    Bud(x) ==> F(\"long\");"),
    (
        "method without a result",
        false,
        "float size(int n) {\n    float s = n;\n}",
    ),
    (
        "value from a void method",
        false,
        "void f() { int a = g(); }\nvoid g() { }",
    ),
    (
        "shader where a number is needed",
        true,
        "    Bud(x) ==> F(GREEN);",
    ),
    (
        "missing new",
        true,
        "    Bud(x) ==> Sphere(1).(setShader(RGBAShader(1, 0, 0)));",
    ),
    // Running.
    ("derive in a rule", true, "    Bud(x) ==> derive() F(x);"),
    ("init is private", false, "void init() [ Axiom ==> F(1); ]"),
    ("break outside of a loop", false, "void f() { break; }"),
    // Queries.
    (
        "query without stars",
        true,
        "    Bud(x) ==> { count = count((Leaf)); } F(x);",
    ),
    (
        "query that is not closed",
        true,
        "    Bud(x) ==> { println(count((* Leaf ))); } F(x);",
    ),
    (
        "unknown module in a query",
        true,
        "    Bud(x) ==> { println(sum((* Laef *)[size])); } F(x);",
    ),
    (
        "unknown attribute in a query",
        true,
        "    Bud(x) ==> { println(sum((* Leaf *)[siz])); } F(x);",
    ),
    (
        "condition of a query without a comma",
        true,
        "    Bud(x) ==> { println(count((* l:Leaf (l[size] > 1) *))); } F(x);",
    ),
    (
        "condition of a query without parentheses",
        true,
        "    Bud(x) ==> { println(count((* l:Leaf, l[size] > 1 *))); } F(x);",
    ),
    (
        "condition beside a query",
        true,
        "    Bud(x) ==> { println(forall((* l:Leaf *), l[size] > 1)); } F(x);",
    ),
    (
        "query that can match nothing",
        false,
        "module A; module B;\nprotected void init() [ Axiom ==> A; ]\npublic void run() [ A ==> F(1); { println(count((* B *))); } ]",
    ),
    (
        "rule that never applies",
        false,
        "module A; module B;\nprotected void init() [ Axiom ==> A; ]\npublic void run() [ A ==> F(1); A ==> B; ]",
    ),
    (
        "module that is never used",
        false,
        "module A; module B(int n);\nprotected void init() [ Axiom ==> A; ]\npublic void run() [ A ==> F(1); ]",
    ),
    // Habits from other languages.
    (
        "nodes in braces",
        true,
        "    Bud(x) ==> if (x < 3) { F(x) Bud(x) };",
    ),
    (
        "nodes behind an execution arrow",
        true,
        "    Bud(x) ::> F(x) Bud(x);",
    ),
    (
        "array in brackets",
        false,
        "void f() { float[] a = [1, 2, 3]; }",
    ),
    (
        "loop with in",
        false,
        "void f() { for (int i in 1:3) println(i); }",
    ),
    (
        "elif",
        false,
        "void f(int a) { if (a == 1) println(1); elif (a == 2) println(2); }",
    ),
    (
        "and, not",
        false,
        "void f(int a) {\n    if (a == 1 and a < 2) println(1);\n    if (not a) println(2);\n}",
    ),
    (
        "array used as a list",
        false,
        "void f(float[] a) { println(a.get(0)); println(a.length()); }",
    ),
    (
        "list used as an array",
        false,
        "void f(java.util.ArrayList a) { println(a[0]); println(a.length); }",
    ),
    (
        "printing with a small letter",
        false,
        "void f() { system.out.println(1); }",
    ),
    (
        "list without a cast",
        false,
        "void f(java.util.ArrayList a) { float x = a.get(0); }",
    ),
    (
        "text in single quotes",
        false,
        "void f() { println('hello'); }",
    ),
    (
        "method without a result type",
        false,
        "grow() [ Axiom ==> F(1); ]",
    ),
    (
        "misspelt setter",
        true,
        "    Bud(x) ==> Sphere(x).(setShader(RED), setRadus(3), setColour(1, 0, 0));",
    ),
    (
        "misspelt setter of a light",
        true,
        "    Bud(x) ==> LightNode.(setLight(new SpotLight().(setOuterAngel(1))));",
    ),
    (
        "wrong arguments of a parent",
        false,
        "module A(float x) extends Sphere(x, 3);",
    ),
    (
        "inherited property that is not there",
        false,
        "module A(super.size) extends Sphere;",
    ),
    (
        "module that extends itself",
        false,
        "module A extends B;\nmodule B extends A;",
    ),
    ("attribute without its node", true, "    Bud(x) ==> F(age);"),
    ("label given twice", true, "    b:Bud b:Leaf ==> F(1);"),
    (
        "constant changed",
        false,
        "const int N = 3;\nvoid f() { N = 4; }",
    ),
    (
        "something that is not supported",
        false,
        "void f() { Thread t = null; }",
    ),
];

fn report(text: &str) -> String {
    let mut map = SourceMap::default();
    let file = map.add("model.rgg", text);
    let (ast, mut found) = syntax::parse(file, text);
    if !found.has_errors() {
        let name = "model".into();
        found.append(check(&[SourceModel { name, ast }]).1);
    }
    assert!(!found.is_empty(), "no fault is found:\n{text}");
    render::render(&map, &found)
}

#[test]
fn common_mistakes_are_explained() {
    let mut shown = String::new();
    for (what, is_in_run, text) in CASES {
        let whole = if *is_in_run {
            in_run(text)
        } else {
            (*text).to_owned()
        };
        shown.push_str(&format!("──── {what}\n\n{text}\n\n{}\n", report(&whole)));
    }
    insta::assert_snapshot!("mistakes", shown);
}
