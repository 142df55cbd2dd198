//! What is read, as trees; what is refused, as messages; and that nothing breaks the reader.

use super::*;
use crate::diag::{Diagnostic, SourceMap, render};
use std::path::Path;

/// The models of a folder of `tests/`, by name.
fn models(folder: &str) -> Vec<(String, String)> {
    let mut found = vec![];
    let mut folders = vec![
        Path::new(env!("CARGO_MANIFEST_DIR"))
            .join("tests")
            .join(folder),
    ];
    while let Some(folder) = folders.pop() {
        for entry in std::fs::read_dir(folder).unwrap() {
            let path = entry.unwrap().path();
            if path.is_dir() {
                folders.push(path);
            } else if path.extension().is_some_and(|suffix| suffix == "rgg") {
                found.push((
                    path.to_string_lossy().into_owned(),
                    std::fs::read_to_string(&path).unwrap(),
                ));
            }
        }
    }
    found.sort();
    found
}

#[test]
fn all_models_are_read() {
    let models = [models("golden"), models("abop")].concat();
    assert!(models.len() >= 75, "{}", models.len());
    for (name, text) in models {
        let (file, diagnostics) = parse(FileId(0), &text);
        assert!(diagnostics.is_empty(), "{name}: {diagnostics:#?}");
        assert!(!file.items.is_empty(), "{name}");
    }
}

/// Reads `text` as a file and compares the tree with `expected`.
#[track_caller]
fn check_file(text: &str, expected: &str) {
    let (file, diagnostics) = parse(FileId(0), text);
    assert!(diagnostics.is_empty(), "{text}: {diagnostics:#?}");
    assert_eq!(pretty::file(&file), expected, "{text}");
}

#[track_caller]
fn check_stmt(text: &str, expected: &str) {
    check_file(
        &format!("void f() {{ {text} }}"),
        &format!("void f() {{ {expected} }}"),
    );
}

#[track_caller]
fn check_expr(text: &str, expected: &str) {
    check_stmt(&format!("x = {text};"), &format!("(x = {expected});"));
}

#[track_caller]
fn check_rule(text: &str, expected: &str) {
    check_file(
        &format!("void f() [ {text} ]"),
        &format!("void f() {{ [ {expected} ] }}"),
    );
}

#[test]
fn files() {
    check_file(
        "\u{FEFF}import a.b.C;\r\nimport static other.*;\r\n/* x */ module A; module B; // y",
        "import a.b.C;\nimport static other.*;\nmodule A();\nmodule B();",
    );
    check_file("package a.b; int x = 1;;", "int x = 1;");
    check_file(
        "module Größe(int ä); int ø;",
        "module Größe(int ä);\nint ø;",
    );
}

#[test]
fn modules() {
    let cases = [
        (
            "module M(int a, super.length, float[] x, int b = 3) extends B(a, 2);",
            "module M(int a, super.length, float[] x, int b = 3) extends B(a, 2);",
        ),
        (
            "abstract module A(int v) { abstract int f(); }",
            "abstract module A(int v) { abstract int f(); };",
        ),
        (
            "module S extends Sphere(0.5).(setColor(1, 0), x = 2);",
            "module S() extends Sphere(0.5).(setColor(1, 0); (x = 2););",
        ),
        (
            "module Q(float l) extends F(l) {{ length = 2; }};",
            "module Q(float l) extends F(l) { { (length = 2); } };",
        ),
        (
            "module A implements B, C<D> { int x, y = 2; { x = 1; } A() { } module I; };",
            "module A() implements B, C<D> { int x; int y = 2; { (x = 1); } A() {  } module I(); };",
        ),
        (
            "module L(float s) ==> RL(60) P(s).(setShader(G));",
            "module L(float s) ==> RL(60) P(s).(setShader(G););",
        ),
        (
            "module L extends N { int a; } ==> for (int i : 1:n) ([F]) if (r > 1) (B);",
            "module L() extends N { int a; } ==> for (int i : (1:n)) ([F]) if ((r > 1)) (B) else ();",
        ),
        (
            "@Range(min=(0), s=\")\") @X public static module A(@R(1) final int x) ;",
            "public static module A(int x);",
        ),
    ];
    for (text, expected) in cases {
        check_file(text, expected);
    }
}

#[test]
fn classes_methods_and_fields() {
    let cases = [
        (
            "class X extends Exception { X(String s) { super(s); } static int n; static { n = 1; } }",
            "class X extends Exception { ; X(String s) { super(s); } static int n; static { (n = 1); } }",
        ),
        (
            "interface I<T extends A> extends J, K { int f(int x); }",
            "interface I extends J { ; int f(int x); }",
        ),
        (
            "enum Stage { SEED, LEAF, ; int n; }",
            "enum Stage { SEED, LEAF; int n; }",
        ),
        (
            "protected void init() [ A ==> B; ]",
            "protected void init() { [ A ==> B; ] }",
        ),
        (
            "static float[] f(final int[] a, String... s) throws E, a.B { return null; }",
            "static float[] f(int[] a, String... s) { return null; }",
        ),
        (
            "private const int a[] = {1, 2}, b, c[][] = {{}};",
            "private final int[] a = {1, 2};\nprivate final int b;\nprivate final int[][] c = {{}};",
        ),
        (
            "HashMap<String, List<Map<A, B[]>>>[] m = new HashMap<>();",
            "HashMap<String, List<Map<A, B[]>>>[] m = new HashMap();",
        ),
    ];
    for (text, expected) in cases {
        check_file(text, expected);
    }
}

#[test]
fn statements() {
    let cases = [
        (
            "final int a = 1, b[] = {2}; Foo<A> c; a.b.C[] d;",
            "final int a = 1, final int[] b = {2}; Foo<A> c; a.b.C[] d;",
        ),
        (
            "if (a) b(); else if (c) ; else { }",
            "if (a) b(); else if (c) ; else {  }",
        ),
        (
            "outer: for (int i = 0, j = 9; i < j; i++, j -= 2) { continue outer; break; }",
            "outer: for (int i = 0, int j = 9; | (i < j) | (i++), (j -= 2)) { continue outer; break; }",
        ),
        (
            "for (;;) ; for (i = 0; ; ) ;",
            "for ( |  | ) ; for ((i = 0); |  | ) ;",
        ),
        (
            "for (1:3) f(); for ((1:3)) f(); for (apply(3)) f(); for (int i : 1:n - 1) f();",
            "for ((1:3)) f(); for ((1:3)) f(); for (apply(3)) f(); for (int i : (1:(n - 1))) f();",
        ),
        (
            "for ((* x:T, (x.v > 1) *)) g(x); for (float[] r : m) for (final float v : r) t += v;",
            "for ((* x:T, ?(x.v > 1) *)) g(x); for (float[] r : m) for (final float v : r) (t += v);",
        ),
        (
            "while (a) { } do k += 2; while (k < 5);",
            "while (a) {  } do (k += 2); while ((k < 5));",
        ),
        (
            "switch (n) { case 1: case 2 + 3: f(); break; default: g(); }",
            "switch (n) { case 1:  case (2 + 3): f(); break; default: g(); }",
        ),
        (
            "try { f(); } catch (E e) { } finally { g(); } throw new E(\"x\");",
            "try { f(); } catch (E e) {  } finally { g(); } throw new E(\"x\");",
        ),
        (
            "class P { int a; } return; return a;",
            "class P { ; int a; } return; return a;",
        ),
        (
            "[ A ==> B; ] a[v] := 1; a[v] :+= 2; a.b :**= 3;",
            "[ A ==> B; ] (a[v] := 1); (a[v] :+= 2); (a.b :**= 3);",
        ),
        (
            "a < b; i = a < b ? c : d;",
            "(a < b); (i = ((a < b) ? c : d));",
        ),
    ];
    for (text, expected) in cases {
        check_stmt(text, expected);
    }
}

#[test]
fn operators() {
    let cases = [
        ("2 + 3 * 4 - 6 / 4", "((2 + (3 * 4)) - (6 / 4))"),
        ("-2 ** 2", "((-2) ** 2)"),
        ("2 ** -3 ** 2", "(2 ** ((-3) ** 2))"),
        ("3 * 2 ** 3 * 4", "((3 * (2 ** 3)) * 4)"),
        ("a = b += c **= d", "(a = (b += (c **= d)))"),
        ("a ? b : c ? d : e", "(a ? b : (c ? d : e))"),
        ("a ? b ? 1 : 2 : 3", "(a ? (b ? 1 : 2) : 3)"),
        (
            "a || b && c | d ^ e & f == g < h << i",
            "(a || (b && (c | (d ^ (e & (f == (g < (h << i))))))))",
        ),
        (
            "x instanceof A && a < b == true",
            "((x instanceof A) && ((a < b) == true))",
        ),
        ("a + b instanceof C", "((a + b) instanceof C)"),
        ("a >>> 2 >> 1 >= 3 != b", "((((a >>> 2) >> 1) >= 3) != b)"),
        ("a >>>= b >>= c <<= d", "(a >>>= (b >>= (c <<= d)))"),
        (
            "k++ + ++k - k-- - --k",
            "((((k++) + (++k)) - (k--)) - (--k))",
        ),
        ("!a.b[c]++ + ~-+d", "((!(a.b[c]++)) + (~(-(+d))))"),
        ("a - -b", "(a - (-b))"),
    ];
    for (text, expected) in cases {
        check_expr(text, expected);
    }
}

#[test]
fn operands() {
    let cases = [
        ("(int) -3.99", "((int) (-3.99))"),
        ("(char) (c + 1)", "((char) (c + 1))"),
        ("((A) n).v", "((A) n).v"),
        ("(A) (B) c.d", "((A) ((B) c.d))"),
        ("(a) + b - (a.b) * c", "((a + b) - (a.b * c))"),
        ("(a) instanceof B", "(a instanceof B)"),
        (
            "(float[]) f + (Foo<A>[]) g",
            "(((float[]) f) + ((Foo<A>[]) g))",
        ),
        ("(T) (* A *)", "((T) (* A *))"),
        ("(1, 2)", "comma(1, 2)"),
        ("sum(1:3)", "sum((1:3))"),
        ("new int[] {7, 8}[1]", "new int[]{7, 8}[1]"),
        ("new float[n][2 * m][]", "new float[n][(2 * m)][]"),
        (
            "new a.B<C>(1).(x = 1, setY(2)).z()",
            "new a.B<C>(1).((x = 1); setY(2);).z()",
        ),
        (
            "f[de.grogra.Attributes.RADIUS]",
            "f[de.grogra.Attributes.RADIUS]",
        ),
        (
            "first((* F *))[length] + sum((* F *)[length]).x",
            "(first((* F *))[length] + sum((* F *)[length]).x)",
        ),
        (
            "this.a + super.f(1) + Foo.class",
            "((this.a + super.f(1)) + Foo.class)",
        ),
        (
            "float t => float t * t + 1",
            "(float t => ((float) ((t * t) + 1)))",
        ),
        ("map(Node n => n.f())", "map((Node n => n.f()))"),
    ];
    for (text, expected) in cases {
        check_expr(text, expected);
    }
}

#[test]
fn literals() {
    let cases = [
        ("0xFF + 017 + 0b11 + 1_000", "(((255 + 15) + 3) + 1000)"),
        ("0xFFFFFFFF", "-1"),
        ("-2147483648", "-2147483648"),
        ("-9223372036854775808L", "-9223372036854775808L"),
        ("5L + 0l", "(5L + 0L)"),
        (
            ".5 + 1. + 1e-3 + 1E3f + 3f + 2d",
            "(((((0.5 + 1.0) + 0.001) + 1000.0f) + 3.0f) + 2.0)",
        ),
        (
            "'a' + '\\n' + '\\'' + '\\u0041' + '\\101'",
            "(((('\\u0061' + '\\u000a') + '\\u0027') + '\\u0041') + '\\u0041')",
        ),
        (r#""a\t\"b\"\\ \u00e4""#, r#""a\t\"b\"\\ ä""#),
        ("true == false != null", "((true == false) != null)"),
    ];
    for (text, expected) in cases {
        check_expr(text, expected);
    }
}

#[test]
fn left_sides() {
    let cases = [
        ("==>> ^ A;", " ==>> ^ A;"),
        (
            "A(x), (x > 4), (x < 8) ==> ;",
            "A(x), ?(x > 4), ?(x < 8) ==> ;",
        ),
        ("a:A(, y, ) b:de.B() ==>> ;", "a:A(_, y, _) b:de.B() ==>> ;"),
        (
            "(* A > B *) C [D E] < F ==> ;",
            "(* A -succ-> B *) C [D E] <-succ- F ==> ;",
        ),
        (
            "(* a:A, (a.v > 1), B *) C ==> ;",
            "(* a:A *) C, ?(a.v > 1), (* B *) ==> ;",
        ),
        ("^ > this +> . ==> ;", "^ -succ-> this -branch-> . ==> ;"),
        (
            "A --> B <-- C -- D --- E <+ F -+- G <-> H <--> I /> J </ K ==> ;",
            "A -any-> B <-any- C -any- D -succ- E <-branch- F -branch- G <-succ-> H <-any-> I -refine-> J <-refine- K ==> ;",
        ),
        (
            "A -ancestor-> B <-a.b- C <-(e)-> D -e- E ==> ;",
            "A -ancestor-> B <-a.b- C <-e-> D -e- E ==> ;",
        ),
        (
            "A (-->)+ B (>)* C (<+)? D (-->){2} E (-e->){1,3} F (-->){2, } G ==> ;",
            "A -any->{1,} B -succ->{0,} C <-branch-{0,1} D -any->{2,2} E -e->{1,3} F -any->{2,} G ==> ;",
        ),
        ("A, b:B, b C ==> ;", "A, b:B, b C ==> ;"),
        (
            "i:I, (!empty((* i -minDescendants-> I *))) ==> ;",
            "i:I, ?(!empty((* i -minDescendants-> I *))) ==> ;",
        ),
    ];
    for (text, expected) in cases {
        check_rule(text, expected);
    }
}

#[test]
fn right_sides() {
    let cases = [
        (
            "A ==> a l:Leaf(0.2).(x = 1) [RU(30) B] (C D), ^ E;",
            "A ==> a l:Leaf(0.2).((x = 1);) [RU(30) B] (C D) , ^ E;",
        ),
        (
            "A ==> B > C +> D <- e - E %;",
            "A ==> B -succ-> C -branch-> D <-e- E %;",
        ),
        (
            "A ==> for (int i = 0; i < 3; i++) (F break) for ((1:3)) [F];",
            "A ==> for (int i = 0; | (i < 3) | (i++)) (F break) for ((1:3)) ([F]);",
        ),
        (
            "A ==> if (c) (A B) else if (d) C else { f(); } while (k) F;",
            "A ==> if (c) (A B) else (if (d) (C) else ({ f(); })) while (k) (F);",
        ),
        (
            "A ==> B { int k = 1; k++; } make(3).x new C(1) this;",
            "A ==> B { int k = 1; (k++); } make(3).x new C(1) this;",
        ),
        (
            "a:A ::> a[v] += 5; b:B ::> { f(); } c:C ::> [ D ==> E; ] F ::> if (x) g();",
            "a:A ::> (a[v] += 5); b:B ::> { f(); } c:C ::> [ D ==> E; ] F ::> if (x) g();",
        ),
        (
            "{ int k = 0; } f(x); x[v] = 1; Foo y = z; A(x) ==> B; ; g.h(x)[v] := 3; for (1:3) [ A ==> B; ]",
            "{ int k = 0; } f(x); (x[v] = 1); Foo y = z; A(x) ==> B; ; (g.h(x)[v] := 3); for ((1:3)) [ A ==> B; ]",
        ),
    ];
    for (text, expected) in cases {
        check_rule(text, expected);
    }
}

#[test]
fn spans_hold_the_text_and_no_blanks() {
    let text = "module A ; // x\nvoid f() { int a = 1 + b /* c */ ; }";
    let (file, _) = parse(FileId(0), text);
    let show = |span: crate::diag::Span| &text[span.start as usize..span.end as usize];
    let [ast::Item::Module(module), ast::Item::Method(method)] = file.items.as_slice() else {
        panic!("{file:?}")
    };
    assert_eq!(show(module.span), "module A ;");
    let ast::StmtKind::Local(vars) = &method.body.as_ref().unwrap().stmts[0].kind else {
        panic!("{method:?}")
    };
    assert_eq!(show(vars[0].init.as_ref().unwrap().span), "1 + b");
}

/// All messages for `text`.
fn messages(text: &str) -> String {
    let mut sources = SourceMap::default();
    let file = sources.add("model.rgg", text);
    let (_, found) = parse(file, text);
    for diagnostic in found.sorted() {
        let Diagnostic { message, .. } = diagnostic;
        assert!(
            !message.ends_with('.') && !message.starts_with(char::is_uppercase),
            "{message}"
        );
    }
    render::render(&sources, &found)
}

#[test]
fn broken_models_get_precise_messages() {
    let cases = [
        "missing semicolon after a rule\nmodule A; module B;\nvoid f() [\n\tA ==> B\n\tB ==> A;\n\tA ==> B B\n]",
        "missing semicolon after a statement\nvoid f() {\n\tint a = 1\n\tint b = 2;\n\tg(a b);\n}",
        "several broken rules\nvoid f() [\n\tA ==> B(;\n\tC ==> D(1 2);\n\tE(x) (x > 1) ==> F;\n\tG => H;\n]\nint x = ;",
        "unclosed brace\nvoid f() {\n\tif (a) {\n\t\tg();\n}\nvoid h() { }",
        "wrong bracket\nvoid f() [ A ==> B; }",
        "stray bracket\nvoid f() [ A ==> B; ] ]\nmodule C;",
        "unclosed string\nvoid f() { g(\"abc); }\nmodule C",
        "unclosed comment\nmodule A;\n/* abc",
        "a rule outside of brackets\nmodule A;\nA ==> A A;",
        "a rule in braces\nvoid f() { A ==> B; }",
        "missing module\nmodul A;\nLeaf(float x) extends Null;\nStem(int n) ==> F(n);",
        "a statement outside of a method\nmodule A;\nprintln(\"x\");",
        "parameter without a name\nmodule A(x, int y);",
        "keyword as a name\nvoid f() { int new = 3; float class; }",
        "numbers\nint a = 3000000000; int b = 2147483648; int c = 089; String s = \"\\q\"; float f = 1e50f; char d = 'ab';",
        "foreign characters\nvoid f() { g(“x”); int n = a – b; }",
        "nothing\n// only a remark",
        "no value\nvoid f() { x = a + ; y = * b; if a > b { } }",
        "words of other languages\nvoid f() { if (a and b) c(); }",
        "no semicolon at the end\nmodule A\nmodule B(int x) extends C(\nint x = 3",
        "not supported\nvoid f() {\n\tx[v] :'= 3;\n\tC c = new C() { int a; };\n\ty = 1 +;\n}\nvoid g() [ A (? B) ==> C; A ==> {# B #}; ]",
        "scales\nscaleclass Plant;",
        "a rule without an arrow\nvoid f() [ A(x), (x > 3); A B; a:A b:B; ]",
        "broken inside of a module\nmodule A(int x) {\n\tint y = 3\n\tvoid f() { y = 4 }\n}\nmodule B;",
    ];
    for case in cases {
        let (title, text) = case.split_once('\n').unwrap();
        let name = title.replace(' ', "_");
        insta::with_settings!({ description => text, omit_expression => true }, {
            insta::assert_snapshot!(name, messages(text));
        });
    }
}

/// Reads `text` and wants at least one error and an answer within `limit`; says how long it took.
#[track_caller]
fn check_refused(what: &str, text: &str) {
    let (file, diagnostics) = parse(FileId(0), text);
    assert!(diagnostics.has_errors(), "{what}");
    drop(file);
    let mut sources = SourceMap::default();
    sources.add("model.rgg", text);
    let shown = render::render(&sources, &diagnostics);
    assert!(
        shown.len() < 20_000,
        "{what}: {} bytes of messages",
        shown.len()
    );
}

#[test]
fn absurd_depth_is_refused_without_overflow() {
    let in_statement = [
        ("", "("),
        ("", "["),
        ("", "{"),
        ("", "if (a) "),
        ("", "for (1:3) "),
        ("", "do "),
        ("", "try { "),
        ("", "if (a) ; else "),
        ("", "switch (a) { case 1: "),
        ("", "a: "),
        ("", "++"),
        ("", "A<"),
        ("", "a < "),
        ("", "a ? "),
        ("x = ", "a ? b ? c : "),
        ("x = ", "(a = "),
        ("x = ", "f(float t => "),
        ("x = ", "T t => "),
        ("x = ", "!"),
        ("x = ", "- "),
        ("x = ", "(int) "),
        ("x = ", "(A) "),
        ("x = a", ".a"),
        ("x = a", "[1]"),
        ("x = a", "(1)"),
        ("x = ", "1 + "),
        ("x = ", "x = "),
        ("x = ", "2 ** "),
        ("x = ", "new A<"),
        ("x = ", "(* A("),
        ("x = ", "{"),
        ("x = ", "new int["),
        ("x = a", ".(b"),
        ("if (a) ; ", "else if (a) ; "),
        ("", "x = a[1]"),
        ("", "a b "),
        ("", "[A ==> "),
        ("", "[A ::> "),
        ("", "{ [ A ::> "),
    ];
    for (prefix, part) in in_statement {
        let deep = format!("{prefix}{}", part.repeat(4_000));
        check_refused(part, &format!("void f() {{ {deep}"));
        check_refused(part, &format!("void f() {{ {deep} 1; }}"));
    }
    let in_rule = [
        "A(",
        "[",
        "(",
        "A [",
        "A > ",
        "(* A ",
        "if (a) ",
        "for (1:3) ",
        "if (a) B else ",
        "(A(",
        "(>",
        "{ [ A ==> ",
        "-a",
        "A.(",
        ".a",
        "a:",
        "A, ",
    ];
    for part in in_rule {
        let deep = part.repeat(4_000);
        check_refused(part, &format!("void f() [ A ==> {deep} ]"));
        check_refused(part, &format!("void f() [ {deep} ==> A ]"));
    }
    let in_file = [
        "module A(",
        "module A { ",
        "class A { ",
        "int a = {",
        "A<",
        "@A(",
        "void f() [ ",
        "public ",
        "int[] ",
        "{",
        "}",
        "module A ==> ",
        "import a.",
    ];
    for part in in_file {
        check_refused(part, &part.repeat(4_000));
    }
}

#[test]
fn brackets_of_any_depth_that_are_closed_are_refused() {
    for (open, close) in [
        ("(", ")"),
        ("[", "]"),
        ("{", "}"),
        ("{ [ A ::> ", "] }"),
        ("f(", ")"),
        ("x[", "]"),
        ("a ? ", ": b"),
    ] {
        let deep = format!("{}{}", open.repeat(100_000), close.repeat(100_000));
        check_refused(open, &format!("void f() {{ {deep} }}"));
        check_refused(open, &format!("void f() {{ x = {deep}; }}"));
        check_refused(open, &format!("void f() [ A ==> {deep}; ]"));
    }
}

#[test]
fn nesting_within_the_limit_is_read_fast() {
    let nest = |open: &str, middle: &str, close: &str| {
        let levels = open.matches(['(', '[', '{', '?']).count() + open.matches("=>").count();
        let n = 190 / levels.max(2);
        format!("{}{middle}{}", open.repeat(n), close.repeat(n))
    };
    let texts = [
        format!("void f() {{ x = {}; }}", nest("(", "1", ")")),
        format!("void f() {{ x = {}; }}", nest("(a < ", "1", ")")),
        format!("void f() {{ x = {}; }}", nest("a ? ", "1", ": 2")),
        format!("void f() {{ x = {}; }}", nest("f(a, (b) c < d, ", "1", ")")),
        format!("void f() {{ x = {}; }}", nest("(int) (A) -", "1", "")),
        format!("void f() {{ x = {}; }}", nest("f((* A(", "1", ") *))")),
        format!("void f() {{ x = {}; }}", nest("(float t => ", "1", ")")),
        format!("void f() {{ x = {}; }}", nest("a.(b[c(", "1", ")])")),
        format!("void f() {{ x = {}; }}", nest("new A<B<C>>(", "1", ")")),
        format!("void f() {{ {} }}", nest("a < b; {", "", "}")),
        format!("void f() {{ {} }}", nest("if (a) {", "b();", "} else c();")),
        format!("void f() {{ {} }}", nest("for (int i : 1:3) ", "b();", "")),
        format!("void f() [ {} ]", nest("[", "A ==> B;", "]")),
        format!("void f() [ A ==> {}; ]", nest("[A(1) ", "B", "]")),
        format!(
            "void f() [ A ==> {}; ]",
            nest("if (a) (B) else (", "C", ")")
        ),
        format!("void f() [ {} ==> A; ]", nest("A [", "B", "]")),
        format!("int[] a = {};", nest("{", "1", "}")),
        nest("module A { int x; ", "", "}"),
        format!("void f() {{ x = {}; }}", vec!["a < b"; 300].join(" && ")),
        format!("void f() {{ {} }}", "a < b; ".repeat(300)),
    ];
    for text in texts {
        // A reader that tries alternatives again and again would not come to an end here.
        let (_, diagnostics) = parse(FileId(0), &text);
        assert!(diagnostics.is_empty(), "{text}: {diagnostics:#?}");
    }
}

/// Bytes that look random and are always the same.
fn noise(n: usize) -> impl Iterator<Item = u32> {
    let mut state = 12_345_u32;
    (0..n).map(move |_| {
        state = state.wrapping_mul(1_664_525).wrapping_add(1_013_904_223);
        state >> 16
    })
}

#[test]
fn garbage_is_refused() {
    let binary: Vec<u8> = noise(1_000_000).map(|n| n as u8).collect();
    check_refused("binary", &String::from_utf8_lossy(&binary));
    let printable: String = noise(1_000_000)
        .map(|n| char::from(32 + (n % 95) as u8))
        .collect();
    check_refused("printable", &printable);
    let words = [
        "A", "(", ")", "[", "]", "{", "}", "==>", ";", ",", "x", "1", "+", "if", "void f()",
        "module", "\n", "<", ":", "=", ".", "(*", "*)",
    ];
    let tokens: String = noise(300_000)
        .map(|n| format!("{} ", words[n as usize % words.len()]))
        .collect();
    check_refused("tokens", &tokens);
    let lines = "protected void init() [ Axiom ==> A(1) B(2; ]\n".repeat(20_000);
    check_refused("broken lines", &lines);
}

#[test]
fn one_long_line_is_read_or_refused() {
    let line = "module A(int x); void f() [ A(x), (x > 4) ==> B(x * 2 + 1) [RU(30) C]; ] static int g(int y) { return y < 3 ? 1 : 2; } ";
    let text = line.repeat(2_000_000 / line.len());
    let (file, diagnostics) = parse(FileId(0), &text);
    assert!(
        diagnostics.is_empty() && file.items.len() > 10_000,
        "{diagnostics:#?}"
    );
    check_refused(
        "broken at its end",
        &format!("{text} void f() [ A ==> (; ]"),
    );
    let table = format!("float[] a = {{ {} 1 2 }};", "1.5, ".repeat(30_000));
    check_refused("broken table", &table);
}

proptest::proptest! {
    #![proptest_config(proptest::prelude::ProptestConfig { cases: 300, failure_persistence: None, ..Default::default() })]

    /// Any part of any model replaced by any other: never a panic, always an answer, and messages that can be shown.
    #[test]
    fn mutated_models_never_break_the_reader(
        model in 0..60_usize, donor in 0..60_usize, from in 0.0..1.0_f64, len in 0..40_usize, at in 0.0..1.0_f64, cut in 0..20_usize,
    ) {
        let models = models("golden");
        let slice = |text: &str, start: f64, len: usize| -> String {
            let chars: Vec<char> = text.chars().collect();
            let start = (start * chars.len() as f64) as usize;
            chars[start..(start + len).min(chars.len())].iter().collect()
        };
        let text = &models[model].1;
        let chars: Vec<char> = text.chars().collect();
        let place = (at * chars.len() as f64) as usize;
        let head: String = chars[..place].iter().collect();
        let tail: String = chars[(place + cut).min(chars.len())..].iter().collect();
        let mutated = format!("{head}{}{tail}", slice(&models[donor].1, from, len));
        messages(&mutated);
    }
}
