//! Models that get a warning, and near misses that get none.

use crate::check::tests::found_in;

/// The warnings of a model, one `line:slug` each.
fn warnings(text: &str) -> Vec<String> {
    found_in(&[("model", text)])
}

fn check_cases(cases: &[(&str, &[&str])]) {
    for (text, expected) in cases {
        assert_eq!(warnings(text), *expected, "{text}");
    }
}

/// `A` and `B extends A` are made; `rules` is the body of `run`.
fn with_rules(rules: &str) -> String {
    format!(
        "module A(int n); module B extends A(1); module C; int k = 0; void go() {{ derive(); }} void calm() {{ k++; }}\n\
         protected void init() [ Axiom ==> A(1) B C; ]\n\
         public void run() [\n{rules}\n]"
    )
}

#[test]
fn a_rule_behind_one_that_takes_all_is_told() {
    let cases: &[(&str, &[&str])] = &[
        ("A(n) ==> C;\nA(x) ==> C C;", &["5:dead-rule"]),
        ("A ==>> ;\nB ==> C;", &["5:dead-rule"]),
        ("A(n) ==> C;\nC A(x) ==> C C;", &["5:dead-rule"]),
        ("A(n) ==> C;\nx:A ::> x[n]++;", &["5:dead-rule"]),
        (
            "A(n) ==> C;\nB ==> C;\nA(x) ==> C;",
            &["5:dead-rule", "6:dead-rule"],
        ),
        ("A(n) ==> C; { calm(); }\nA(x) ==> C C;", &["5:dead-rule"]),
        // The second may still apply.
        ("B ==> C;\nA(x) ==> C C;", &[]),
        ("A(n), (n > 1) ==> C;\nA(x) ==> C C;", &[]),
        ("A(1) ==> C;\nA(x) ==> C C;", &[]),
        ("a:A ==> C a;\nA(x) ==> C C;", &[]),
        ("a:A ==> C if (k > 0) (a);\nA(x) ==> C C;", &[]),
        ("(* A *) C ==> C;\nA(x) ==> C;", &[]),
        ("A(n) ==> C;\n(* A *) C ==> C C;", &[]),
        ("x:A ::> x[n]++;\nA(x) ==> C;", &[]),
        ("A(n) ==> C; { derive(); }\nA(x) ==> C C;", &[]),
        ("A(n) ==> C; { go(); }\nA(x) ==> C C;", &[]),
        ("A(n) ==> C; { for (apply(2)) calm(); }\nA(x) ==> C C;", &[]),
        ("{ if (k > 0) [ A(n) ==> C; ] }\nA(x) ==> C C;", &[]),
        ("{ setDerivationMode(2); } A(n) ==> C;\nA(x) ==> C C;", &[]),
    ];
    for (rules, expected) in cases {
        assert_eq!(warnings(&with_rules(rules)), *expected, "{rules}");
    }
}

#[test]
fn modules_that_are_never_used_or_never_made_are_told() {
    let init = "protected void init() [ Axiom ==> F(1); ]\n";
    let check = |rest: &str, expected: &[&str]| {
        assert_eq!(warnings(&format!("{init}{rest}")), expected, "{rest}");
    };
    check("module A;", &["2:unused-module"]);
    check("module A { int f() { return 1; } }", &["2:unused-module"]);
    check(
        "abstract module A;\nmodule B extends A;",
        &["3:unused-module"],
    );
    check("module A; void run() [ Axiom ==> A; ]", &[]);
    check(
        "module A ==> F(2); module B ==> A; void run() [ Axiom ==> B; ]",
        &[],
    );
    check("module A; void run() [\nA ==> F(1); ]", &["3:no-match"]);
    check(
        "module A; int n() { return\n(int) count((* A *)); }",
        &["3:no-match"],
    );
    check(
        "abstract module A; module B extends A; void run() [\nA ==> ; Axiom ==> B; ]",
        &[],
    );
    check(
        "abstract module A; module B extends A; void run() [\nA ==> F(1);\nB ==> F(2); ]",
        &["3:no-match", "4:dead-rule", "4:no-match"],
    );
    check("class A { int n; } interface B { void f(); }", &[]);
    // Without `init` it may be a part of a model.
    assert!(warnings("module A; void run() [ A ==> F(1); ]").is_empty());
    // Of several files one may use what another declares.
    let files = [
        ("organs", "module A;"),
        ("main", "protected void init() [ Axiom ==> A; ]"),
    ];
    assert!(found_in(&files).is_empty());
}

#[test]
fn code_behind_a_jump_is_told_once() {
    check_cases(&[
        (
            "int f() {\nreturn 1;\nint a = 2;\nint b; }",
            &["3:unreachable"],
        ),
        (
            "void f() { for (int i : 1:3) { if (i > 1) break; println(i); } }",
            &[],
        ),
        (
            "void f() { while (true) {\nbreak;\nprintln(1); } }",
            &["3:unreachable"],
        ),
        (
            "void f(int n) { switch (n) { case 1: println(1); break; case 2: return; default: break; } }",
            &[],
        ),
        (
            "void f() [ { return; }\nAxiom ==> F(1); ]",
            &["2:unreachable"],
        ),
        (
            "void f() [ Axiom ==> { return; }\nF(1); ]",
            &["2:unreachable"],
        ),
        ("void f() { if (true) return; println(1); }", &[]),
    ]);
}

#[test]
fn methods_that_may_give_nothing_are_told() {
    check_cases(&[
        (
            "int f(int n) { if (n > 1) return 2; }",
            &["1:missing-return"],
        ),
        (
            "int f(int n) { while (n > 1) { return 2; } }",
            &["1:missing-return"],
        ),
        (
            "int f(int n) { while (true) { if (n > 1) break; } }",
            &["1:missing-return"],
        ),
        (
            "int f(int n) { switch (n) { case 1: return 2; } }",
            &["1:missing-return"],
        ),
        ("int f() [ Axiom ==> F(1); ]", &["1:missing-return"]),
        ("int f(int n) { if (n > 1) return 2; else return 3; }", &[]),
        ("int f(int n) { if (n > 1) { return 2; } return 3; }", &[]),
        (
            "int f(int n) { while (true) { if (n > 1) return 3; n++; } }",
            &[],
        ),
        (
            "int f(int n) { for (;;) { n++; if (n > 9) return n; } }",
            &[],
        ),
        (
            "int f(int n) { switch (n) { case 1: return 2; default: return 3; } }",
            &[],
        ),
        (
            "int f(int n) { try { return n; } catch (Exception e) { return 2; } }",
            &[],
        ),
        ("int f(int n) { try { n++; } finally { return 2; } }", &[]),
        ("int f(int n) { throw new Exception(); }", &[]),
        ("abstract module A { abstract int f(); } void g() { }", &[]),
    ]);
}

#[test]
fn whole_quotients_that_become_fractions_are_told() {
    check_cases(&[
        (
            "float v(float r) {\nreturn 4 / 3 * r; }",
            &["2:integer-division"],
        ),
        ("float v(float r) { return 6 / 3 * r; }", &[]),
        ("float v(float r) { return 4.0 / 3 * r; }", &[]),
        ("int v(int r) { return 4 / 3 * r; }", &[]),
        ("float v(int r) { return r / 3; }", &[]),
    ]);
}

#[test]
fn keeping_the_last_of_several_values_is_told() {
    let cases: &[(&str, &[&str])] = &[
        ("{ k = (* A *)[n]; }", &["4:last-value"]),
        ("{ k += (* A *)[n]; }", &[]),
        ("{ (* A *)[n] = k; }", &[]),
        ("{ k = sum((* A *)[n]); }", &[]),
    ];
    for (rules, expected) in cases {
        assert_eq!(warnings(&with_rules(rules)), *expected, "{rules}");
    }
}
