//! Checks of whole models: the golden ones, and small ones for what is refused.

use std::path::Path;

use super::{SourceModel, check};
use crate::diag::{Diagnostics, Severity, SourceMap};
use crate::syntax;

/// Checks one text; gives the model and `line:slug message` of each error.
pub(super) fn check_text(text: &str) -> (super::model::Model, Vec<String>) {
    check_texts(&[("model", text)])
}

/// Checks several files together.
pub(super) fn check_texts(texts: &[(&str, &str)]) -> (super::model::Model, Vec<String>) {
    let mut map = SourceMap::default();
    let mut found = Diagnostics::default();
    let mut files = vec![];
    for (name, text) in texts {
        let id = map.add(*name, *text);
        let (ast, diagnostics) = syntax::parse(id, text);
        found.append(diagnostics);
        files.push(SourceModel {
            name: (*name).into(),
            ast,
        });
    }
    let (model, diagnostics) = check(&files);
    found.append(diagnostics);
    let errors = found
        .sorted()
        .into_iter()
        .filter(|d| d.severity == Severity::Error);
    let line =
        |d: &&crate::diag::Diagnostic| d.primary.as_ref().map_or(0, |p| map.line_column(p.span).0);
    let shown = errors.map(|d| {
        let hints: String = d.hints.iter().map(|hint| format!(" | {hint}")).collect();
        format!("{}: {}: {}{hints}", line(&d), d.slug, d.message)
    });
    (model, shown.collect())
}

/// `line:slug` of everything found in a model, in order of place.
pub(super) fn found_in(texts: &[(&str, &str)]) -> Vec<String> {
    let mut map = SourceMap::default();
    let mut found = Diagnostics::default();
    let mut files = vec![];
    for (name, text) in texts {
        let id = map.add(*name, *text);
        let (ast, diagnostics) = syntax::parse(id, text);
        found.append(diagnostics);
        let name = (*name).into();
        files.push(SourceModel { name, ast });
    }
    found.append(check(&files).1);
    let line =
        |d: &crate::diag::Diagnostic| d.primary.as_ref().map_or(0, |p| map.line_column(p.span).0);
    found
        .sorted()
        .into_iter()
        .map(|d| format!("{}:{}", line(d), d.slug))
        .collect()
}

#[test]
fn models_that_are_meant_so_get_no_warning() {
    let root = Path::new(env!("CARGO_MANIFEST_DIR"));
    let mut n_models = 0;
    let mut check_one = |name: &str, text: &str| {
        let found = found_in(&[("model", text)]);
        let expected = WARNED
            .iter()
            .find(|(warned, _)| *warned == name)
            .map_or(&[][..], |(_, w)| w);
        assert_eq!(found, expected, "{name}");
        n_models += 1;
    };
    for (name, text, refused_at) in golden_models() {
        if refused_at.is_none() {
            check_one(&name, &text);
        }
    }
    for folder in ["examples", "examples/course", "tests/abop"] {
        for entry in std::fs::read_dir(root.join(folder)).unwrap() {
            let path = entry.unwrap().path();
            if path.extension().is_some_and(|e| e == "rgg") {
                check_one(
                    &path.display().to_string(),
                    &std::fs::read_to_string(&path).unwrap(),
                );
            }
        }
    }
    assert!(n_models > 60, "{n_models}");
}

/// Golden models that do on purpose, or for brevity, what is warned of.
const WARNED: &[(&str, &[&str])] = &[
    ("84-acc-closure", &["1:unused-module"]),
    // `rule7`: "second not".
    ("16-conditions", &["63:dead-rule"]),
    ("17-rule-order", &["52:dead-rule"]),
    ("22-select-where", &["36:no-match"]),
    ("63-acc-int-from-sum", &["1:unused-module"]),
    ("67-acc-float-param-double", &["1:unused-module"]),
    ("74-acc-uninitialised", &["1:unused-module"]),
    (
        "75-acc-missing-return",
        &["1:unused-module", "2:missing-return"],
    ),
    ("77-acc-byte-200", &["1:unused-module"]),
    ("87-acc-private-field", &["1:unused-module"]),
    ("89-acc-return-in-rules", &["1:unused-module"]),
    ("90-acc-annotation", &["1:unused-module", "4:unused-module"]),
    ("92-acc-null-first", &["3:no-match"]),
    ("93-acc-mean-empty", &["3:no-match"]),
    ("96-acc-multiple-assign", &["1:unused-module"]),
];

/// The models of `tests/golden`: name, text, and the line of the first fault where GroIMP refuses them.
fn golden_models() -> Vec<(String, String, Option<usize>)> {
    let folder = Path::new(env!("CARGO_MANIFEST_DIR")).join("tests/golden");
    let mut models = vec![];
    for entry in std::fs::read_dir(folder).unwrap() {
        let path = entry.unwrap().path();
        let Ok(text) = std::fs::read_to_string(path.join("model.rgg")) else {
            continue;
        };
        let expected = std::fs::read_to_string(path.join("expected.txt")).unwrap();
        let line = expected.strip_prefix("REFUSED").map(|rest| {
            let place = rest.split("model.rgg ").nth(1).unwrap();
            place.split(':').next().unwrap().parse().unwrap()
        });
        models.push((
            path.file_name().unwrap().to_string_lossy().into_owned(),
            text,
            line,
        ));
    }
    models.sort();
    models
}

/// Refused by GroIMP, accepted here because that harms no model.
const LENIENT: &[&str] = &[
    "79-acc-list",
    "81-acc-diamond",
    "82-acc-string-switch",
    "98-acc-enum",
];

#[test]
fn golden_models_are_accepted_and_refused_as_in_groimp() {
    let (mut n_accepted, mut n_refused) = (0, 0);
    for (name, text, refused_at) in golden_models() {
        let (_, errors) = check_text(&text);
        let is_refused = refused_at.is_some() && !LENIENT.contains(&name.as_str());
        if is_refused {
            n_refused += 1;
            let first = errors
                .first()
                .unwrap_or_else(|| panic!("{name} is accepted"));
            let line = refused_at.map_or(String::new(), |line| format!("{line}: "));
            assert!(first.starts_with(&line), "{name}: {errors:#?}");
        } else {
            n_accepted += 1;
            assert!(errors.is_empty(), "{name}: {errors:#?}");
        }
    }
    assert!(
        n_accepted >= 50 && n_refused >= 9,
        "{n_accepted} {n_refused}"
    );
}

mod show;
use show::Show;

/// The statements of `f`, for a body put into `void f() { … }` of a file with a few modules.
fn body_of(body: &str) -> String {
    let text = format!("{PRELUDE} void f() {{ {body} }}");
    let (model, errors) = check_text(&text);
    assert!(errors.is_empty(), "{body}: {errors:#?}");
    let (_, id) = model.entries.iter().find(|(name, _)| name == "f").unwrap();
    let method = &model.methods[id.0 as usize];
    Show(&model).stmts(method.body.as_ref().unwrap())
}

const PRELUDE: &str = "module A(int v, float w) extends F(w) { int n = 3; double[] d; int get() { return v; } } \
    module B(A a); int count = 0; const int TWO = 2; static float half(float x) { return x / 2; }";

fn check_bodies(cases: &[(&str, &str)]) {
    let wrong: Vec<String> = cases
        .iter()
        .map(|(body, expected)| (body, body_of(body), expected))
        .filter(|(_, found, expected)| found != *expected)
        .map(|(body, found, expected)| format!("{body}\n  found    {found}\n  expected {expected}"))
        .collect();
    assert!(wrong.is_empty(), "{}", wrong.join("\n"));
}

#[test]
fn numbers_are_promoted_and_narrowed_as_in_java() {
    check_bodies(&[
        ("int a = 7 / 2;", "let #0 = (7 Div:int 2)"),
        ("float f = 7 / 2.0;", "let #0 = (float)(7.0 Div:double 2.0)"),
        (
            "byte b = 100; b += 1;",
            "let #0 = 100:byte; #0 Some(Add):int= 1",
        ),
        (
            "char c = 'a'; c++;",
            "let #0 = 97:char; incdec(#0, 1, false)",
        ),
        ("int i; i += 2.9;", "let #0; #0 Some(Add):double= 2.9"),
        ("long l = 1 << 31;", "let #0 = (long)(1 Shl:int 31)"),
        ("long l = 1L << 33L;", "let #0 = (1L Shl:long 33)"),
        (
            "double d = 2 ** 3;",
            "let #0 = (double)(2.0f Pow:float 3.0f)",
        ),
        ("boolean b = 1 < 2L;", "let #0 = (1L Lt:long 2L)"),
        (
            "boolean b = true & false ^ true;",
            "let #0 = ((true And:boolean false) Xor:boolean true)",
        ),
        ("int x, y; x = y = 4;", "{ let #0; let #1 }; #0 = #1 = 4"),
        ("int s = -'a';", "let #0 = -97"),
        ("float f = TWO;", "let #0 = 2.0f"),
    ]);
}

#[test]
fn conditionals_find_the_common_type() {
    check_bodies(&[
        (
            "println(false ? 1 : 'a');",
            "PrintlnText(concat((false ? 1:char : 97:char)))",
        ),
        (
            "println(true ? 1 : 2.0);",
            "PrintlnText(concat((true ? 1.0 : 2.0)))",
        ),
        (
            "println(true ? 100000 : 'a');",
            "PrintlnText(concat((true ? 100000 : 97)))",
        ),
        (
            "String s = true ? null : \"s\";",
            "let #0 = (true ? null : \"s\")",
        ),
        (
            "Node n = true ? new A(1, 2) : new F();",
            "let #0 = (true ? new A<>(1, 2.0f) : new F<>())",
        ),
        (
            "Object o = true ? 1 : 2;",
            "let #0 = (object)(true ? 1 : 2)",
        ),
    ]);
}

#[test]
fn overloads_are_chosen_by_java_phases() {
    check_bodies(&[
        (
            "println(Math.max(1, 2.0));",
            "PrintlnText(concat(MaxDouble(1.0, 2.0)))",
        ),
        (
            "println(Math.max(1f, 2));",
            "PrintlnText(concat(MaxFloat(1.0f, 2.0f)))",
        ),
        ("println(Math.abs(-2));", "PrintlnText(concat(AbsInt(-2)))"),
        (
            "println(Math.round(2.4f));",
            "PrintlnText(concat(RoundFloat(2.4f)))",
        ),
        (
            "println(normal(0, 1));",
            "PrintlnText(concat(NormalFloat(0.0f, 1.0f)))",
        ),
        (
            "println(normal(0.0, 1));",
            "PrintlnText(concat(NormalDouble(0.0, 1.0)))",
        ),
        (
            "println(half(Math.PI));",
            "PrintlnText(concat(half<float>(3.1415927f)))",
        ),
        (
            "println(random(0, 0.5));",
            "PrintlnText(concat(Random(0.0f, 0.5f)))",
        ),
        (
            "ArrayList l = new ArrayList(); l.add(3);",
            "let #0 = new ArrayList:List(); #0.ListAdd((object)3)",
        ),
        (
            "ArrayList l; l.remove(3); l.remove(\"a\");",
            "let #0; #0.ListRemoveAt(3); #0.ListRemove(\"a\")",
        ),
    ]);
}

#[test]
fn text_is_one_row_of_parts() {
    check_bodies(&[
        (
            "String s = 1 + 2 + \"x\" + 1 + 2;",
            "let #0 = concat((1 Add:int 2), \"x\", 1, 2)",
        ),
        (
            "String s = \"a\" + (\"b\" + 1);",
            "let #0 = concat(\"a\", \"b\", 1)",
        ),
        ("String s; s += 1;", "let #0; #0 None:string= concat(1)"),
        ("println(\"x\");", "PrintlnText(\"x\")"),
    ]);
}

#[test]
fn nodes_have_properties_getters_and_setters() {
    check_bodies(&[
        (
            "A a; a[v] += 2; a.w = 1.5;",
            "let #0; #0.v Some(Add):int= 2; #0.w = 1.5f",
        ),
        (
            "A a; a[n]++; a.get();",
            "let #0; incdec(#0.n, 1, false); virtual #0.get<>()",
        ),
        (
            "A a; a[length] :+= 1;",
            "let #0; #0.length :Some(Add)= 1.0f",
        ),
        (
            "A a; a.setLength(2); println(a.getLength());",
            "let #0; #0.length = 2.0f; PrintlnText(concat(#0.length))",
        ),
        ("A a; a.d[0] = 1;", "let #0; #0.d[0] = 1.0"),
        (
            "Box b = new Box(1).(width = 2, setHeight(3));",
            "let #1 = with #0 = new Box<length>(1.0f) { #0.width = 2.0f; #0.height = 3.0f }",
        ),
        (
            "B b; println(b.a.v);",
            "let #0; PrintlnText(concat(#0.a.v))",
        ),
        (
            "Point3d p = location(new F()); p.x += 1;",
            "let #0 = Location(new F<>()); #0.x Some(Add):double= 1.0",
        ),
        (
            "F f; println(f[de.grogra.turtle.Attributes.RADIUS]);",
            "let #0; PrintlnText(concat(AttributeRadius(#0)))",
        ),
        (
            "Vector3d v = 2 * new Vector3d(1, 0, 0);",
            "let #0 = new Vector3d:TupleOf(1.0, 0.0, 0.0).VectorTimes(2.0)",
        ),
        (
            "Object o; Integer i = (Integer) o; int j = i; float f = (float) 1.5;",
            "let #0; let #1 = cast(Integer)#0; let #2 = (int)#1; let #3 = 1.5f",
        ),
    ]);
}

#[test]
fn queries_become_sequences() {
    check_bodies(&[
        (
            "println(count((* A *)));",
            "PrintlnText(concat(Count:long(query[A]#0)))",
        ),
        (
            "int s = sum((* A *)[v]);",
            "let #1 = Sum:int(map #0 in query[A]#0: #0.v)",
        ),
        (
            "float m = mean((* A *)[w] * 2);",
            "let #1 = Mean:float(map #0 in query[A]#0: (#0.w Mul:float 2.0f))",
        ),
        (
            "A a = first((* x:A, (x.v > 3) *));",
            "let #2 = First:A(query[#0:A if Some(0) (#0.v Gt:int 3)]#0)",
        ),
        (
            "A a = selectWhereMin((* x:A *), x[v]);",
            "let #3 = select(Least, query[#0:A]#0, #0.v)",
        ),
        (
            "for ((* x:A y:F *)) { x.v = 1; }",
            "for query[#0:A #1:F 0-SuccessorF-1]#1 { #0.v = 1 }",
        ),
        (
            "A a; for ((* a +> F *)) {}",
            "let #0; for query[=#0 F 0-BranchF-1]#1 {  }",
        ),
        ("for (int i : 1:3) {}", "for #1 in 1:3 {  }"),
        (
            "for (double i : 1:3) {}",
            "for #1 in map #2 in 1:3: (double)#2 {  }",
        ),
        (
            "int[] a = {1, 2}; for (int i : a) {}",
            "let #0 = int[]{1, 2}; for #1 in elements #0 {  }",
        ),
        ("for (apply(3)) {}", "for apply 3 {  }"),
        (
            "println(first((* A *)).n);",
            "PrintlnText(concat(First:A(query[A]#0).n))",
        ),
        (
            "println(max((* A *)[v]));",
            "PrintlnText(concat(Max:int(map #0 in query[A]#0: #0.v)))",
        ),
    ]);
}

#[test]
fn patterns_bind_compare_and_know_what_conditions_need() {
    check_bodies(&[
        (
            "[ A(x, y) ==> A(x, y); ]",
            "{ rule A(v->#0, w->#1) Lindenmayer }",
        ),
        (
            "[ A(x,), (x > 1) ==> ; ]",
            "{ rule A(v->#0) if Some(0) (#0 Gt:int 1) Lindenmayer }",
        ),
        ("[ A(count,) ==> ; ]", "{ rule A(v==@0) Lindenmayer }"),
        (
            "[ A(x,) A(x,) ==> ; ]",
            "{ rule A(v->#0) A(v==#0) 0-SuccessorF-1 Lindenmayer }",
        ),
        (
            "[ A(,2f), (probability(0.5)) ==> ; ]",
            "{ rule A(w==2.0f) if None Probability(0.5f) Lindenmayer }",
        ),
        (
            "[ (* F *) a:A ==>> a; ]",
            "{ rule F* #0:A 0-SuccessorF-1 Spo }",
        ),
        (
            "[ A [F] RU ==> ; ]",
            "{ rule A F RU 0-BranchF-1 0-SuccessorF-2 Lindenmayer }",
        ),
        (
            "[ A [F RU (* M *) RL] ==> ; ]",
            "{ rule A F RU M* RL 0-BranchF-1 1-SuccessorF-2 2-SuccessorF-3 3-SuccessorF-4 Lindenmayer }",
        ),
        (
            "[ a:A, a F ::> a.v = 1; ]",
            "{ rule #0:A same 0 F 1-SuccessorF-2 Execution }",
        ),
        (
            "[ A (-->)+ F ==> ; ]",
            "{ rule A F 0-AnyF(1, None)-1 Lindenmayer }",
        ),
        (
            "[ A <-minDescendants- F ==> ; ]",
            "{ rule A F 0-MinDescendantsB-1 Lindenmayer }",
        ),
    ]);
}

#[test]
fn constructors_store_parameters_after_the_parents_constructor() {
    let (model, errors) = check_text(
        "module S(super.radius, int k) extends Sphere(radius).(setRadius(k)) { int w = k; { w = w + 1; } } module T extends S;",
    );
    assert!(errors.is_empty(), "{errors:?}");
    let show = Show(&model);
    let body = show.stmts(&model.modules[0].constructor.body);
    assert_eq!(
        body,
        "super Sphere(#1); #0.radius = #1; #0.k = #2; #0.radius = (float)#0.k; #0.w = #0.k; { #0.w = (#0.w Add:int 1) }"
    );
    assert_eq!(show.stmts(&model.modules[1].constructor.body), "super S()");
}

#[test]
fn overrides_are_listed_for_every_module_that_has_them() {
    let (model, errors) = check_text(
        "module C extends A { int g() { return super.g() + f(); } } module A { int f() { return 1; } int g() { return 2; } } \
         module B extends A { int f() { return 3; } } module D extends B;",
    );
    assert!(errors.is_empty(), "{errors:?}");
    let overrides = |name: &str| {
        let id = model.types.find(name).unwrap();
        let module = model.modules.iter().find(|m| m.type_id == id).unwrap();
        module
            .overrides
            .iter()
            .map(|(old, new)| format!("{}->{}", old.0, new.0))
            .collect::<Vec<_>>()
    };
    // Methods in textual order of the modules as they were added: A's f, g, then C's g, then B's f.
    assert_eq!(overrides("A"), Vec::<String>::new());
    assert_eq!(overrides("C"), ["1->2"]);
    assert_eq!(overrides("B"), ["0->3"]);
    assert_eq!(overrides("D"), ["0->3"]);
}

#[test]
fn instantiations_are_pure_only_if_they_see_nothing_but_their_node() {
    let cases = [
        ("==> F(len) Sphere(len / 2).(setShader(GREEN));", true),
        ("==> for (int i : 1:3) ([RU(i * 90) F(len)]);", true),
        ("==> F(random(0, 1));", false),
        ("==> F(changing);", false),
        ("==> F(fixed);", true),
        ("==> F(pure(len));", true),
        ("==> F(impure());", false),
        ("==> Other;", false),
        ("==> F(count((* F *)));", false),
        ("==> { len = 2; } F(len);", false),
    ];
    for (body, is_pure) in cases {
        let text = format!(
            "float changing = 1; float fixed = 2; float pure(float x) {{ return x * fixed; }} float impure() {{ return random(0, 1); }} \
             void step() {{ changing = 3; }} module Other {{ float x = random(0, 1); }} module M(float len) {body}"
        );
        let (model, errors) = check_text(&text);
        assert!(errors.is_empty(), "{body}: {errors:?}");
        let found = model
            .modules
            .iter()
            .find_map(|m| m.instantiation.as_ref())
            .unwrap()
            .is_pure;
        assert_eq!(found, is_pure, "{body}");
    }
}

#[test]
fn files_see_each_other_and_initialize_what_they_import_first() {
    let files = [
        (
            "main.rgg",
            "import static param.parameters.*; static float twice = 2 * length; void f() { println(Par.x + parameters.length); g(); }",
        ),
        (
            "param/parameters .rgg",
            "const float length = 1.5; void g() {}",
        ),
        ("Par", "int x = 1; { x = 2; }"),
    ];
    let (model, errors) = check_texts(&files);
    assert!(errors.is_empty(), "{errors:?}");
    let names: Vec<&str> = model.statics.iter().map(|s| s.name.as_str()).collect();
    assert_eq!(names, ["length", "twice", "x", "{…}"]);
    assert_eq!(
        model
            .statics
            .iter()
            .map(|s| s.is_constant)
            .collect::<Vec<_>>(),
        [true, true, false, true]
    );
}

/// A faulty text, and what is said about it: `line: slug: message | hint`.
fn check_faults(cases: &[(&str, &[&str])]) {
    let wrong: Vec<String> = cases
        .iter()
        .map(|(text, expected)| (text, check_text(text).1, expected))
        .filter(|(_, found, expected)| found != *expected)
        .map(|(text, found, expected)| {
            format!("{text}\n  found    {found:#?}\n  expected {expected:#?}")
        })
        .collect();
    assert!(wrong.is_empty(), "{}", wrong.join("\n"));
}

#[test]
fn faults_are_named_once_each_with_advice() {
    check_faults(&[
        (
            "module Internode;\nvoid f() [ Axiom ==> Intenode; ]",
            &["2: unknown-module: unknown module `Intenode` | did you mean `Internode`?"],
        ),
        (
            "void f() {\n int length = 1;\n println(lenght); }",
            &["3: unknown-name: unknown variable `lenght` | did you mean `length`?"],
        ),
        (
            "module A(int age);\nvoid f() { A a; a[agee] = 1; }",
            &["2: unknown-property: `A` has no property `agee` | did you mean `age`?"],
        ),
        (
            "void f() { int n = count((* F *)); }",
            &[
                "1: type-mismatch: expected `int`, found `long` | write `(int)` in front to convert it",
            ],
        ),
        (
            "void f() { if (1) {} }",
            &[
                "1: type-mismatch: expected `boolean`, found `int` | compare it with something, such as `!= 0`",
            ],
        ),
        (
            "void f() { final int n = 1; n = 2; }",
            &["1: final-variable: `n` cannot be changed | remove `final` where it is declared"],
        ),
        (
            "const int N = 1; void f() { N++; }",
            &["1: final-variable: `N` cannot be changed | remove `final` where it is declared"],
        ),
        (
            "void f() { sqrt(2); }",
            &[
                "1: unknown-function: unknown function `sqrt` | write `Math.sqrt(…)`, or begin the file with `import static java.lang.Math.*;`",
            ],
        ),
        (
            "import static java.lang.Math.*; void f() { println(sqrt(2) + PI); }",
            &[],
        ),
        (
            "module A(int a, int b); void f() [ A(x) ==> ; ]",
            &[
                "1: pattern-arguments: `A` has 2 parameters, the pattern gives 1 | leave gaps for the others: `A(x,)`",
            ],
        ),
        (
            "module A extends B; module B extends A;",
            &[
                "1: inheritance-cycle: module `A` extends itself | a module can extend only modules that do not extend it",
            ],
        ),
        (
            "module A extends Bee; void f() { A a; a.foo = 1; a.bar(); }",
            &["1: unknown-module: unknown module `Bee`"],
        ),
        (
            "module A; module A;",
            &["1: duplicate-module: module `A` is declared twice"],
        ),
        (
            "int x; int x;",
            &["1: duplicate-variable: variable `x` is declared twice"],
        ),
        (
            "void f() { int a; int a; }",
            &["1: duplicate-variable: variable `a` is declared twice in this block"],
        ),
        ("void f() { int a; { int a; } }", &[]),
        (
            "void f() { foo(bar(1)); }",
            &["1: unknown-function: unknown function `bar`"],
        ),
        (
            "void f() { Foo x = new Foo(); x.y = 1; x.z(); }",
            &[
                "1: unknown-type: unknown type `Foo`",
                "1: unknown-type: unknown type `Foo`",
            ],
        ),
        (
            "class C { } void f() { C c = new C(); c.x = 1; C.y(); new C(3); }",
            &[
                "1: unknown-property: `C` has no property `x`",
                "1: unknown-function: `C` has no function `y`",
                "1: wrong-arguments: `C` has no constructor with arguments | write `C(…) { … }` in the class",
            ],
        ),
        (
            "abstract class A { abstract int f(); } interface I { void g(); } class B extends A { } class C implements I { } class D extends String { } void f() { new A(); }",
            &[
                "1: missing-method: `B` lacks the method `f` of its parent | write it, or put `abstract` in front of the declaration",
                "1: missing-method: `C` lacks the method `g` of its parent | write it, or put `abstract` in front of the declaration",
                "1: bad-extends: a class of the model cannot extend `String` | of the library only exceptions can be extended; keep the object in a field",
                "1: abstract-module: `A` is abstract and cannot be made | make a class that extends it",
            ],
        ),
        (
            "void f() { F f = (* F *); }",
            &[
                "1: several-values: a query gives several values, but one is needed here | put it into `first( … )`, `sum( … )` or the like, or go through it with `for`",
            ],
        ),
        (
            "void f() { println(sum((* F *))); }",
            &[
                "1: bad-aggregate: `sum` does not work on values of type `F` | name a property: `(* X *)[length]`",
            ],
        ),
        (
            "int f() { return; } void g() { return 1; }",
            &[
                "1: missing-value: `return` must give a `int` here",
                "1: unwanted-value: this method gives no value, it is `void`",
            ],
        ),
        (
            "void f() { break; }",
            &["1: loose-break: `break` stands in no loop"],
        ),
        (
            "void f() { \"a\".lenght(); }",
            &["1: unknown-method: `String` has no method `lenght` | did you mean `length`?"],
        ),
        (
            "void f() { F f; f.setLenght(1); }",
            &["1: unknown-method: `F` has no method `setLenght` | did you mean `setLength`?"],
        ),
        (
            "void f() { int x = 1; x + 1; }",
            &["1: no-effect: this statement does nothing"],
        ),
        (
            "abstract module A { abstract int f(); } module B extends A; void g() [ Axiom ==> A; ]",
            &[
                "1: missing-method: `B` lacks the method `f` of its parent | write it, or put `abstract` in front of the declaration",
                "1: abstract-module: `A` is abstract and cannot be made | make a module that extends it",
            ],
        ),
        (
            "void f() { switch (1) { case 1: break; case 1: } }",
            &["1: duplicate-case: this `case` stands twice"],
        ),
        (
            "void f() { Quat4d m; }",
            &[
                "1: unsupported-type: type `Quat4d` is not supported | write `Translate`, `Rotate` and `Scale` nodes, or turn with a `Matrix4d`",
            ],
        ),
        (
            "module P(float f); void f() [ P(2.5) ==> ; ]",
            &[
                "1: type-mismatch: expected `float`, found `double` | patterns compare exactly: write the number with an `f` at its end",
            ],
        ),
        (
            "void f() [ Axiom ==> Cylinder(2); ]",
            &[
                "1: wrong-arguments: `Cylinder` takes 0 or 2 arguments, 1 is given | it can be called as `Cylinder()`, `Cylinder(float length, float radius)`",
            ],
        ),
    ]);
}

/// Cuts a text into words, spaces and signs.
fn words(text: &str) -> Vec<&str> {
    let mut words = vec![];
    let mut rest = text;
    while let Some(first) = rest.chars().next() {
        let is_word = |c: char| c.is_alphanumeric() || c == '_';
        let end = if is_word(first) {
            rest.find(|c| !is_word(c)).unwrap_or(rest.len())
        } else {
            first.len_utf8()
        };
        words.push(&rest[..end]);
        rest = &rest[end..];
    }
    words
}

proptest::proptest! {
    #![proptest_config(proptest::prelude::ProptestConfig::with_cases(400))]

    /// Whatever becomes of a model, the check ends without a panic; a model without errors is untouched by it.
    #[test]
    fn mutated_models_never_panic(
        which in 0usize..1000,
        changes in proptest::collection::vec((0usize..100_000, 0usize..100_000, 0u8..3), 1..6),
    ) {
        let models = golden_models();
        let (_, text, _) = &models[which % models.len()];
        let mut words = words(text);
        for (at, from, kind) in changes {
            if words.is_empty() {
                break;
            }
            let (at, from) = (at % words.len(), from % words.len());
            match kind {
                0 => { words.remove(at); }
                1 => words[at] = words[from],
                _ => words.insert(at, words[from]),
            }
        }
        check_text(&words.concat());
    }
}

#[test]
fn the_abop_models_are_accepted() {
    let folder = Path::new(env!("CARGO_MANIFEST_DIR")).join("tests/abop");
    let mut n_checked = 0;
    for entry in std::fs::read_dir(folder).unwrap() {
        let path = entry.unwrap().path();
        if path.extension().is_some_and(|suffix| suffix == "rgg") {
            let (_, errors) = check_text(&std::fs::read_to_string(&path).unwrap());
            assert!(errors.is_empty(), "{}: {errors:#?}", path.display());
            n_checked += 1;
        }
    }
    assert!(n_checked >= 10, "{n_checked}");
}
