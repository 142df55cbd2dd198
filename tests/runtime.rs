//! What happens when a model misbehaves at run time: exceptions, budgets, a stop from outside. Never a panic, never a hang.

#![allow(clippy::unwrap_used, reason = "a helper that fails fails its test")]

use std::sync::atomic::{AtomicUsize, Ordering};
use std::sync::{Arc, Mutex};

use understory::check::{SourceModel, check};
use understory::diag::{Diagnostic, SourceMap};
use understory::eval::Limits;
use understory::growth::{Growth, GrowthOptions};
use understory::syntax::parse;

/// A model that can run, and what it prints.
struct Model {
    growth: Growth,
    printed: Arc<Mutex<String>>,
    sources: SourceMap,
}

impl Model {
    fn new(text: &str, options: GrowthOptions) -> Self {
        Self::stopped_by(text, options, Box::new(|| false))
    }

    fn stopped_by(text: &str, options: GrowthOptions, stop: understory::eval::StopSign) -> Self {
        let mut sources = SourceMap::default();
        let file = sources.add("model.rgg", text);
        let (ast, read) = parse(file, text);
        let (model, checked) = check(&[SourceModel {
            name: "model.rgg".into(),
            ast,
        }]);
        assert!(
            !read.has_errors() && !checked.has_errors(),
            "{read:#?} {checked:#?}"
        );
        let printed = Arc::new(Mutex::new(String::new()));
        let sink = Arc::clone(&printed);
        let output = Box::new(move |text: &str| sink.lock().unwrap().push_str(text));
        let growth = Growth::new(&model, options, output, stop).unwrap();
        Self {
            growth,
            printed,
            sources,
        }
    }

    fn fails(&mut self) -> Diagnostic {
        *self.growth.init().expect_err("it should fail")
    }

    fn prints(mut self) -> String {
        self.growth.init().unwrap();
        self.printed.lock().unwrap().clone()
    }

    fn line(&self, fault: &Diagnostic) -> usize {
        self.sources
            .line_column(fault.primary.as_ref().expect("a place").span)
            .0
    }
}

fn small(change: impl FnOnce(&mut Limits)) -> GrowthOptions {
    let mut options = GrowthOptions::default();
    options.limits.steps = 1_000_000;
    change(&mut options.limits);
    options
}

fn init(body: &str) -> String {
    format!(
        "module A(int v);\nint f(int n) {{ return n == 0 ? 0 : 1 + f(n - 1); }}\nprotected void init() {{\n{body}\n}}"
    )
}

/// The fault of a model whose `init` has this body from line 4 on.
fn fault(body: &str) -> (Diagnostic, usize) {
    let mut model = Model::new(&init(body), small(|_| {}));
    let fault = model.fails();
    let line = fault.primary.as_ref().map_or(0, |_| model.line(&fault));
    (fault, line)
}

#[test]
fn endless_loops_end_with_a_message_that_names_them() {
    for body in [
        "\nwhile (true) { }",
        "\nfor (;;) { int k = 1; }",
        "\ndo { } while (1 < 2);",
        "\n[ Axiom ==> for (;;) ({ int k = 0; }); ]",
        "\nlong n = 9000000000000000000L; for (long i : 0L:n) { }",
        "\nlong n = count(0L:9000000000000000000L);",
        "\nfor (apply(2000000000)) { }",
    ] {
        let (fault, line) = fault(body);
        assert_eq!((fault.slug, line), ("step-limit", 5), "{body}: {fault:?}");
    }
}

#[test]
fn deep_recursion_is_refused_without_overflowing_the_stack() {
    let (fault, line) = fault("println(f(10000));");
    assert_eq!((fault.slug, line), ("recursion-limit", 2));
    assert!(fault.message.contains("`f`"), "{fault:?}");
    assert!(fault.trace.len() < 12, "{fault:?}");
    let fine = Model::new(&init("println(f(2900));"), small(|_| {}));
    assert_eq!(fine.prints(), "2900\n");
}

#[test]
fn modules_that_make_themselves_are_refused() {
    let text = "module A { A a = new A(); }\nprotected void init() [ Axiom ==> A; ]";
    let mut model = Model::new(text, small(|_| {}));
    assert_eq!(model.fails().slug, "recursion-limit");
}

#[test]
fn a_reset_in_init_is_refused() {
    let (fault, _) = fault("reset();");
    assert_eq!(fault.slug, "recursion-limit");
}

#[test]
fn memory_is_limited() {
    let cases = [
        ("int[] a = new int[2000000000];", "memory-limit"),
        ("double[][] a = new double[100000][100000];", "memory-limit"),
        (
            "String s = \"x\"; while (true) { s = s + s; }",
            "text-limit",
        ),
        ("String s = \"x\"; while (true) { s += s; }", "text-limit"),
        (
            "java.util.ArrayList l = new java.util.ArrayList(); while (true) { l.add(\"x\"); }",
            "memory-limit",
        ),
        (
            "java.util.HashMap m = new java.util.HashMap(); int i = 0; while (true) { m.put(i++, \"x\"); }",
            "memory-limit",
        ),
        (
            "StringBuffer b = new StringBuffer(); while (true) { b.append(\"0123456789012345678901234567890123456789\"); }",
            "memory-limit",
        ),
        ("int[] a = array(0:100000000);", "memory-limit"),
        (
            "java.util.ArrayList l = new java.util.ArrayList(); for (int i : 0:100000) { l.add(\"a text of some length, longer than is free of charge, number \" + i); }",
            "memory-limit",
        ),
    ];
    for (body, slug) in cases {
        let options = small(|limits| {
            limits.memory = 4_000_000;
            if slug == "text-limit" {
                limits.memory = 1 << 40;
            }
        });
        let mut model = Model::new(&init(body), options);
        let fault = model.fails();
        assert_eq!(
            (fault.slug, model.line(&fault)),
            (slug, 4),
            "{body}: {fault:?}"
        );
    }
}

#[test]
fn memory_that_is_given_up_can_be_used_again() {
    let body = "for (int i : 0:1000) { int[] a = new int[100000]; } println(\"done\");";
    let model = Model::new(&init(body), small(|limits| limits.memory = 1_000_000));
    assert_eq!(model.prints(), "done\n");
}

#[test]
fn the_graph_is_limited() {
    let text = "module A;\nprotected void init() { [ Axiom ==> A; ] for (apply(100)) grow(); }\nvoid grow() [ A ==> A A; ]";
    let mut model = Model::new(text, small(|limits| limits.nodes = 1000));
    let fault = model.fails();
    assert_eq!(
        (fault.slug, model.line(&fault)),
        ("module-limit", 3),
        "{fault:?}"
    );
}

#[test]
fn collections_that_contain_themselves_are_printed_and_freed() {
    let body = "java.util.ArrayList l = new java.util.ArrayList(); l.add(l); println((\"\" + l).length() < 1000);
        java.util.ArrayList a = new java.util.ArrayList(); java.util.ArrayList b = new java.util.ArrayList(); a.add(b); b.add(a); println(a.equals(b));
        java.util.ArrayList deep = new java.util.ArrayList();
        for (int i : 0:300000) { java.util.ArrayList outer = new java.util.ArrayList(); outer.add(deep); deep = outer; }
        println(deep.size());";
    assert_eq!(
        Model::new(&init(body), small(|_| {})).prints(),
        "true\nfalse\n1\n"
    );
}

#[test]
fn exceptions_have_javas_names_and_a_place() {
    let cases = [
        (
            "int z = 0; println(1 / z);",
            "java.lang.ArithmeticException: / by zero",
        ),
        (
            "int z = 0; println(1 % z);",
            "java.lang.ArithmeticException: / by zero",
        ),
        (
            "int[] a = new int[2]; a[2] = 1;",
            "java.lang.ArrayIndexOutOfBoundsException: Index 2 out of bounds for length 2",
        ),
        (
            "int[] a = new int[-1];",
            "java.lang.NegativeArraySizeException: -1",
        ),
        (
            "int[] a = null; println(a.length);",
            "java.lang.NullPointerException: ",
        ),
        (
            "A a = null; a.v = 3;",
            "java.lang.NullPointerException: Cannot assign field \"v\" because the object is null",
        ),
        (
            "Object o = \"x\"; A a = (A) o;",
            "java.lang.ClassCastException: `x` is no A",
        ),
        (
            "println(\"abc\".charAt(5));",
            "java.lang.StringIndexOutOfBoundsException: Index 5 out of bounds for length 3",
        ),
        (
            "println(Integer.parseInt(\"x\"));",
            "java.lang.NumberFormatException: For input string: \"x\"",
        ),
        (
            "java.util.ArrayList l = new java.util.ArrayList(); l.get(0);",
            "java.lang.IndexOutOfBoundsException: ",
        ),
        (
            "throw new RuntimeException(\"mine\");",
            "java.lang.RuntimeException: mine",
        ),
        (
            "println(irandom(3, 1));",
            "java.lang.IllegalArgumentException: bound must be positive",
        ),
        (
            "String s = null; s.length();",
            "java.lang.NullPointerException: ",
        ),
    ];
    for (body, message) in cases {
        let (fault, line) = fault(body);
        assert!(fault.message.starts_with(message), "{body}: {fault:?}");
        assert_eq!((fault.slug, line), ("exception", 4), "{body}");
        assert!(
            fault
                .trace
                .iter()
                .any(|doing| doing.text == "in method `init`"),
            "{fault:?}"
        );
    }
}

#[test]
fn exceptions_are_caught_by_class() {
    let body = "
        int z = 0;
        try { println(1 / z); } catch (NullPointerException e) { println(\"no\"); } catch (RuntimeException e) { println(e); } finally { println(\"finally\"); }
        try { f(-1); } catch (Exception e) { println(\"not a budget\"); }";
    let mut model = Model::new(&init(body), small(|_| {}));
    assert_eq!(model.fails().slug, "recursion-limit");
    let printed = model.printed.lock().unwrap().clone();
    assert_eq!(
        printed,
        "java.lang.ArithmeticException: / by zero\nfinally\n"
    );
}

#[test]
fn a_removed_node_cannot_be_used() {
    let body =
        "[ Axiom ==> A(1); ] derive(); A a = first((* A *)); [ A ==>> ; ] derive();\nprintln(a.v);";
    let (fault, line) = fault(body);
    assert!(fault.message.contains("was removed"), "{fault:?}");
    assert_eq!(line, 5);
}

#[test]
fn the_rule_and_the_node_are_named() {
    let text = "module A(int v);\nprotected void init() [ Axiom ==> A(1) A(0); ]\npublic void run() [\n  A(x) ==> A(1 / x);\n]";
    let mut model = Model::new(text, GrowthOptions::default());
    model.growth.init().unwrap();
    let fault = model.growth.step().unwrap_err();
    assert_eq!(model.line(&fault), 4);
    let trace: Vec<&str> = fault.trace.iter().map(|d| d.text.as_str()).collect();
    assert_eq!(
        trace,
        [
            "while applying the rule at {place} to A(0)",
            "in method `run`",
            "in step 1"
        ]
    );
    assert!(fault.secondary.is_empty(), "the fault stands in the rule");
    assert_eq!(
        model.growth.string_text(),
        "A(1)A(0)",
        "nothing of the failed step is done"
    );
}

#[test]
fn an_unknown_entry_is_answered_with_those_there_are() {
    let text = "protected void init() { }\npublic void grow() { println(\"grown\"); }";
    let mut model = Model::new(
        text,
        GrowthOptions {
            entry: "grwo".into(),
            ..GrowthOptions::default()
        },
    );
    model.growth.init().unwrap();
    let fault = model.growth.step().unwrap_err();
    assert_eq!(fault.slug, "unknown-entry");
    assert!(
        fault
            .hints
            .iter()
            .any(|hint| hint.contains("`--entry grow`")),
        "{fault:?}"
    );
}

#[test]
fn a_stop_sign_ends_the_run() {
    let asked = Arc::new(AtomicUsize::new(0));
    let counter = Arc::clone(&asked);
    let stop = Box::new(move || counter.fetch_add(1, Ordering::Relaxed) > 3);
    let mut model = Model::stopped_by(&init("while (true) { }"), GrowthOptions::default(), stop);
    assert_eq!(model.fails().slug, "cancelled");
    assert_eq!(asked.load(Ordering::Relaxed), 5);
}

#[test]
fn equal_seeds_give_equal_graphs() {
    let text = "module A(float v);\nprotected void init() [ Axiom ==> A(random(0, 1)); ]\npublic void run() [ A(x) ==> A(random(0, x)) [A(random(0, 1))]; ]";
    let grown = |seed| {
        let mut model = Model::new(
            text,
            GrowthOptions {
                seed,
                ..GrowthOptions::default()
            },
        );
        model.growth.init().unwrap();
        model.growth.run(6).unwrap();
        (
            model.growth.hash(),
            model.growth.total(),
            model.growth.steps(),
        )
    };
    assert_eq!(grown(1), grown(1));
    assert_ne!(grown(1).0, grown(2).0);
    assert_eq!((grown(1).1, grown(1).2), (64, 6));
}

#[test]
fn init_can_be_run_again() {
    let text = "int n = 1;\nmodule A(int v);\nprotected void init() [ { n += irandom(1, 1000); } Axiom ==> A(n); ]\npublic void run() [ A(x) ==> A(x + 1) A(x); ]";
    let mut model = Model::new(text, GrowthOptions::default());
    for _ in 0..2 {
        model.growth.init().unwrap();
        assert_eq!(model.growth.string_text(), "A(362)");
        model.growth.run(2).unwrap();
        assert_eq!(model.growth.counts(), [("A".to_owned(), 4)]);
    }
}

#[test]
fn bodies_make_floating_nodes() {
    let text = "module A(int n) ==> for (int i : 1:n) ([F(i) B]);\nmodule B ==> Sphere(1);\nprotected void init() [ Axiom ==> A(3); ]";
    let mut model = Model::new(text, GrowthOptions::default());
    model.growth.init().unwrap();
    let graph = model.growth.graph();
    let ty = graph.types().find("A").unwrap();
    let node = graph.extent(ty).next().unwrap();
    let before = model.growth.hash();
    let made = model.growth.sketch().instantiate(node).unwrap();
    assert_eq!((made.nodes.len(), made.heads.len()), (6, 3));
    model.growth.sketch().free(made);
    assert_eq!((model.growth.hash(), model.growth.total()), (before, 1));
}
