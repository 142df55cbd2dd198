//! What rules do to the graph and what queries find, with the expected graph written out.
//!
//! The expectations follow from what `tests/golden/README.md` settled about GroIMP; none is copied from our own output.
//! In the tables `S` is the node at which the printed graph begins; branches stand in `[ ]`, several successors in `( )`.

#![allow(clippy::unwrap_used, reason = "a helper that fails fails its test")]

#[path = "support/models.rs"]
mod models;
use models::Model;

const MODULES: &str =
    "module S; module A(int v); module B(int v); module C(int v); module D(int v); module E(int v);
module X(int v, float w); module Late(super.v) extends A(v);
static final int PIPE = 8;
static Node above(Node n) { return first((* n <-- Node *)); }
static boolean isNext(A a, B b) { return b.v == a.v + 1; }
";

/// The graph after one step of `rules` on `S` and what follows it in `start`.
fn after(start: &str, rules: &str) -> Result<String, String> {
    let text = format!(
        "{MODULES}protected void init() [ Axiom ==> S {start}; ]\npublic void run() [ {rules} ]"
    );
    let model = Model::new(&text).map_err(|errors| errors.join(" | "))?;
    Ok(model.grown(1)?.shown())
}

#[track_caller]
fn check(table: &[(&str, &str, &str)]) {
    let mut wrong = vec![];
    for &(start, rules, expected) in table {
        let found = after(start, rules);
        if found.as_deref() != Ok(expected) {
            wrong.push(format!("{start} | {rules}\n  - {expected}\n  + {found:?}"));
        }
    }
    assert!(wrong.is_empty(), "{}", wrong.join("\n"));
}

/// Values of the nodes labelled `b` in all matches of a query over one graph.
#[track_caller]
fn check_queries(start: &str, table: &[(&str, &str)]) {
    let mut wrong = vec![];
    for &(query, expected) in table {
        let text = format!(
            "{MODULES}protected void init() {{ [ Axiom ==> S {start}; ] derive(); String s = \"\"; \
             for ((* {query} *)) {{ s += \" \" + (b == null ? \"-\" : \"\" + b.v); }} print(s.trim()); }}"
        );
        let found = Model::new(&text).map_err(|errors| errors.join(" | "));
        let found = found.and_then(|model| model.grown(0)).map(|m| m.printed());
        if found.as_deref() != Ok(expected) {
            wrong.push(format!("{query}\n  - {expected}\n  + {found:?}"));
        }
    }
    assert!(wrong.is_empty(), "{}", wrong.join("\n"));
}

#[test]
fn loops_make_what_they_say() {
    check(&[
        // The body of `do` is made before the condition is looked at for the first time.
        (
            "B(0)",
            "B ==> { int i = 5; } do (C(i) { i++; }) while (i < 3);",
            "SC5",
        ),
        (
            "B(0)",
            "B ==> { int i = 0; } do (C(i) { i++; }) while (i < 3);",
            "SC0C1C2",
        ),
        (
            "B(0)",
            "B ==> A(7) { int i = 0; } do ([C(i)] if (i == 1) { break; } { i++; }) while (i < 9) D(i);",
            "SA7[C0][C1]D1",
        ),
        (
            "B(0)",
            "B ==> { int i = 0; } do { i += 2; } while (i < 3) C(i);",
            "SC4",
        ),
        (
            "B(0)",
            "B ==> { int i = 0; } while (i < 2) (C(i) { i++; });",
            "SC0C1",
        ),
    ]);
}

#[test]
fn break_ends_the_right_hand_side_of_its_match() {
    check(&[
        (
            "A(1) A(3) A(2)",
            "A(x) ==> B(x) if (x > 1) (break) C(x);",
            "SB1C1B3B2",
        ),
        (
            "A(1) A(3)",
            "A(x) ==> B(x) { if (x > 1) break; } C(x);",
            "SB1C1B3",
        ),
        (
            "A(1) A(3)",
            "A(x) ==> for (int i : 1:9) (if (i > x) (break) B(i)) C(0);",
            "SB1C0B1B2B3C0",
        ),
    ]);
}

#[test]
fn a_query_assigns_each_of_its_values_and_the_last_stays() {
    let text = "module A(int v); int n; protected void init() {
  [ Axiom ==> A(1) A(2) A(3); ] derive();
  n = (* A *)[v]; A a; a = (* x:A, (x.v < 3) *); int none = 7; none = (* A(9) *)[v]; print(n + \" \" + a.v + \" \" + none); }";
    assert_eq!(
        Model::new(text).unwrap().grown(0).unwrap().printed(),
        "3 2 7"
    );
}

#[test]
fn any_value_can_be_passed_as_a_text() {
    let text = "module N(String s); String twice(String s) { return s + s; } int twice(int n) { return 2 * n; }
protected void init() { [ Axiom ==> N(2.5) TextLabel(7); ] derive();
  print(twice(1.5) + \" \" + twice(3) + \" \" + first((* N *)).s + \" \" + first((* TextLabel *)).caption); }";
    assert_eq!(
        Model::new(text).unwrap().grown(0).unwrap().printed(),
        "1.51.5 6 2.5 7"
    );
}

#[test]
fn a_model_can_stop_growing() {
    let text = "module A(int v); protected void init() [ Axiom ==> A(0); ]
public void run() [ a:A ::> { a.v++; if (a.v == 3) { stop(); print(a.v); } } ]";
    let model = Model::new(text).unwrap().grown(9).unwrap();
    assert_eq!(model.printed(), "3");
}

#[test]
fn the_lindenmayer_arrow_embeds() {
    check(&[
        // What leads to the first node leads to the first new one, what the last leads to hangs on the last new one.
        ("A(1) B(2) C(3)", "B(x) ==> D(x) E(x + 1);", "SA1D2E3C3"),
        (
            "A(1) B(2) [C(3)] C(4)",
            "B ==> D(5) [E(6)] E(7);",
            "SA1D5[E6]E7[C3]C4",
        ),
        ("A(1) [B(2) C(3)] C(4)", "B ==> D(5) E(6);", "SA1[D5E6C3]C4"),
        // Two nodes: what hangs on the first besides the second is lost.
        ("A(1) [C(7)] B(2) C(3)", "A B ==> D(4);", "SD4C3"),
        ("A(1) B(2) [C(7)] C(3)", "A B ==> D(4);", "SD4[C7]C3"),
        // Nothing on the right cuts the node out and joins the rest by the outgoing edge's type.
        ("A(1) B(2) C(3)", "B ==> ;", "SA1C3"),
        ("A(1) [B(2) C(3)] C(4)", "B ==> ;", "SA1(C4)(C3)"),
        ("A(1) B(2) [C(3)]", "B ==> ;", "SA1[C3]"),
        // Brackets first: a branch of the node before, the last bracket first.
        (
            "A(1) B(2) E(5)",
            "B ==> [D(9)] [D(8)] C(3);",
            "SA1[D8][D9]C3E5",
        ),
        ("A(1) B(2) E(5)", "B ==> [D(9)];", "SA1[D9]E5"),
        // A comma ends the row; only the first row is embedded. `^` hangs a row on the root.
        ("A(1) B(2) C(3)", "B ==> D(4), ^ E(5);", "SA1D4C3"),
    ]);
}

#[test]
fn the_other_arrows_embed_nothing() {
    check(&[
        ("A(1) B(2) C(3)", "B(x) ==>> D(x);", "SA1"),
        ("A(1) B(2) [C(3)] C(4)", "B ==>> ;", "SA1"),
        ("A(1) [B(2) C(3)] E(5)", "B ==>> ;", "SA1E5"),
        ("A(1) B(2) C(3)", "a:A B ==>> a D(9);", "SA1D9"),
        ("A(1) B(2) C(3)", "a:A b:B ==>> a D(9) b;", "SA1D9B2C3"),
        ("A(1) B(2) C(3)", "a:A B c:C ==>> a c;", "SA1C3"),
        ("A(1) A(2)", "a:A ::> a[v] += 10;", "SA11A12"),
        ("A(1) B(2)", "A ::> { int k = 0; }", "SA1B2"),
        // Rules inside of code make rules of the same step.
        ("A(1) B(2)", "a:A ::> [ B ==> C(4); ]", "SA1C4"),
    ]);
}

#[test]
fn a_step_is_parallel_and_the_first_rule_wins() {
    check(&[
        // New nodes are not matched in the same step.
        ("A(1) B(2)", "A(x) ==> B(x); B(x) ==> C(x);", "SB1C2"),
        ("A(1)", "A(x) ==> A(x + 1) A(x + 2);", "SA2A3"),
        // What one rule has consumed the later ones do not match.
        (
            "A(1) A(5)",
            "A(x), (x > 4) ==> B(x); A(x) ==> C(x);",
            "SC1B5",
        ),
        (
            "A(1) A(5)",
            "A(x) ==> C(x); A(x), (x > 4) ==> B(x);",
            "SC1C5",
        ),
        ("A(1) A(2) A(3)", "A(x) A(y) ==> B(x) B(y);", "SB1B2A3"),
        // What a rule keeps by its label, the later ones still match.
        ("A(1)", "a:A ==> a B(2); A(x) ==> C(x);", "SC1"),
        // Context may be consumed already.
        ("A(1) B(2)", "A ==> D(9); (* A *) B(x) ==> E(x);", "SD9E2"),
        ("A(1) B(2) C(3)", "A ==> ; B ==> ;", "SC3"),
    ]);
}

#[test]
fn labels_keep_the_node() {
    check(&[
        ("A(1) B(2)", "a:A ==> D(5) a;", "SD5A1B2"),
        ("A(1) B(2)", "a:A ==> a [D(5)] { a.v = 7; };", "SA7[D5]B2"),
        ("A(1) B(2) C(3)", "a:A b:B ==> b a;", "SB2A1C3"),
        // A deferred assignment reaches a node that is kept.
        (
            "A(1) B(2)",
            "a:A ==> D(a.v) a { a[v] := a.v + 4; };",
            "SD1A5B2",
        ),
    ]);
}

#[test]
fn contexts_are_needed_and_kept() {
    check(&[
        ("A(1) B(2) C(3) B(4)", "(* A *) B(x) ==> D(x);", "SA1D2C3B4"),
        (
            "A(1) B(2) A(3) B(4) C(5)",
            "B(x) (* C *) ==> D(x);",
            "SA1B2A3D4C5",
        ),
        (
            "A(1) B(2) C(3) B(4)",
            "(* A *) B(x) (* C *) ==> D(x);",
            "SA1D2C3B4",
        ),
        ("A(1) B(2)", "(* a:A *) B(x) ==> D(x + a.v);", "SA1D3"),
        ("A(1) [B(2)] C(3)", "(* A +> *) B(x) ==> D(x);", "SA1[D2]C3"),
        ("A(1) [B(2)] C(3)", "(* A *) B(x) ==> D(x);", "SA1[B2]C3"),
        (
            "A(1) B(2) C(3) C(4)",
            "(* A (-->)+ *) C(x) ==> D(x);",
            "SA1B2D3D4",
        ),
        (
            "B(2) A(1) C(3)",
            "(* A *) C(x), (x > 5) ==> D(x);",
            "SB2A1C3",
        ),
        (
            "A(1) B(2) C(3)",
            "C(x) (* (<--)+ a:A *) ==> D(a.v);",
            "SA1B2D1",
        ),
        // Nothing there: written as a condition.
        (
            "A(1) B(2) A(3)",
            "a:A, (empty((* a > B *))) ==> D(a.v);",
            "SA1B2D3",
        ),
        (
            "A(1) [B(2)] A(3)",
            "a:A, (!empty((* a +> B *))) ==> D(a.v);",
            "SD1[B2]A3",
        ),
        // What may be missing.
        (
            "A(1) B(2) A(3)",
            "a:A (* (? > b:B) *) ==> D(b == null ? 0 : b.v);",
            "SD2B2D0",
        ),
    ]);
}

#[test]
fn patterns_bind_and_compare() {
    check(&[
        ("X(1, 0.5) X(2, 2.5)", "X(2, ) ==> D(4);", "SX1D4"),
        ("X(1, 0.5) X(2, 2.5)", "X(, w), (w > 1) ==> D(4);", "SX1D4"),
        ("X(1, 0.5) X(1, 2.5)", "X(1, w), (w > 1) ==> D(4);", "SX1D4"),
        ("X(1, 0.5)", "X(v, .) ==> D(v);", "SD1"),
        ("A(1) B(1) A(1) B(2)", "A(x) B(x) ==> C(x);", "SC1A1B2"),
        // A pattern for a module matches what extends it.
        ("Late(3) B(1)", "A(x) ==> D(x);", "SD3B1"),
        ("Late(3) A(4)", "Late ==> D(5);", "SD5A4"),
        (
            "Late(3) A(4)",
            "a:A, (a instanceof Late) ==> D(5);",
            "SD5A4",
        ),
        // Several parts, joined by a label.
        (
            "A(1) B(2) [C(3)] A(4) B(5)",
            "A b:B, b [C(x)] ==> D(x);",
            "SD3A4B5",
        ),
        ("A(1) B(2)", "A(x), B(y) ==> D(x) E(y);", "SD1E2"),
    ]);
}

#[test]
fn right_sides_have_control_flow() {
    check(&[
        ("A(3)", "A(x) ==> for (int i : 1:x) (B(i));", "SB1B2B3"),
        (
            "A(3)",
            "A(x) ==> for (int i = 0; i < x; i++) ([C(i)]) D(9);",
            "S[C2][C1][C0]D9",
        ),
        (
            "A(3)",
            "A(x) ==> D(0) for (int i : 1:x) ([C(i)]);",
            "SD0[C1][C2][C3]",
        ),
        (
            "A(1) A(2)",
            "A(x) ==> if (x > 1) (B(x) C(x)) else (D(x));",
            "SD1B2C2",
        ),
        (
            "A(1) A(2)",
            "A(x) ==> B(0) if (x > 1) ([C(x)]);",
            "SB0B0[C2]",
        ),
        (
            "A(5)",
            "A(x) ==> for (int i : 1:x) (if (i > 2) (break) B(i));",
            "SB1B2",
        ),
        (
            "A(1)",
            "A ==> B(1) { int k = 3; } C(k) D(k * 2);",
            "SB1C3D6",
        ),
        (
            "A(1)",
            "A ==> B(1) [C(2) [D(3)] D(4)] E(5);",
            "SB1[C2[D3]D4]E5",
        ),
        ("A(1) B(2)", "A ==> C(1) +> D(2);", "SC1[D2B2]"),
        // Whole numbers stay whole, and overflow as in Java.
        ("A(7)", "A(x) ==> B(x / 2) C(x % 4) D(-x / 2);", "SB3C3D-3"),
        ("A(2147483647)", "A(x) ==> B(x + 1);", "SB-2147483648"),
        (
            "X(1, 0.1)",
            "X(, w) ==> B((int) (w * 10 * 1000000)) C(w == 0.1 ? 1 : 0);",
            "SB1000000C0",
        ),
    ]);
}

#[test]
fn deferred_assignments_wait_for_the_end_of_the_step() {
    check(&[
        ("A(1) A(2)", "a:A ::> a[v] := sum((* A *)[v]);", "SA3A3"),
        ("A(1) A(2)", "a:A ::> a[v] = sum((* A *)[v]);", "SA3A5"),
        (
            "A(1) A(2)",
            "a:A ::> { a[v] :+= 5; a[v] :+= 5; }",
            "SA11A12",
        ),
        ("A(2)", "a:A ::> { a[v] :*= 3; a[v] :+= 1; }", "SA7"),
        ("A(2)", "a:A ::> { a[v] := 5; a[v] := 6; }", "SA6"),
        // To all that a query finds.
        (
            "A(1) A(2) B(3)",
            "{ (* A *)[v] += 1; (* b:B *)[v] *= b.v; }",
            "SA2A3B9",
        ),
        (
            "A(1) A(2)",
            "{ (* a:A *)[v] := a.v * 10; (* A *).v++; }",
            "SA10A20",
        ),
    ]);
}

const TREE: &str = "A(1) [B(2) C(3)] B(4) [RU(10) B(5)] C(6) [D(7) D(8)] A(9) B(10)";

#[test]
fn every_edge_is_found() {
    check_queries(
        TREE,
        &[
            ("A b:B", "4 10"),
            ("A > b:B", "4 10"),
            ("A -successor-> b:B", "4 10"),
            ("A +> b:B", "2"),
            ("A -branch-> b:B", "2"),
            ("A --> b:B", "2 4 10"),
            ("b:B < A", "4 10"),
            ("b:B <+ A", "2"),
            ("b:B <-- A", "2 4 10"),
            ("A -- b:B", "2 4 10"),
            ("b:B -- A", "2 4 10"),
            ("A --- b:B", "4 10"),
            ("B --- b:A", "1 9"),
            ("A -+- b:B", "2"),
            ("A <-> b:B", ""),
            ("A /> b:B", ""),
            ("A [b:B]", "2"),
            ("A [B C] b:B", "4"),
            ("D -ancestor-> b:B", "4 4"),
            ("C -ancestor-> b:B", "2 4"),
            ("A -minDescendants-> b:B", "2 4 10"),
            ("B -minDescendants-> b:B", "5 10"),
            ("b:A <-ancestor- D", "1 1"),
            ("^ > S > b:A", "1"),
            ("S > . b:B", "4"),
        ],
    );
}

#[test]
fn every_closure_is_walked() {
    check_queries(
        TREE,
        &[
            ("A(1) (-->)+ b:B", "2 4 5 10"),
            ("A(1) (-->)* b:A", "1 9"),
            ("A(1) (>)* b:A", "1 9"),
            ("A(1) (>)+ b:B", "4 10"),
            ("A(1) (-->)? b:B", "2 4"),
            ("S (-->){2} b:B", "2 4"),
            ("S (-->){3,} b:B", "5 10"),
            ("S (-->){3,4} b:C", "3 6"),
            ("D(8) (<--)+ b:C", "6"),
            // `:( … )`: a way ends where a match was found, which conditions have a say in.
            ("S (-->)+ :(b:B)", "2 4"),
            ("S (-->)+ :(b:B), (b.v > 2)", "4"),
            ("S (-->)+ :(b:B), (b.v > 4)", "5 10"),
            ("A(1) (-->)+ :(b:C)", "3 6"),
            ("B(10) (<--)+ b:A", "9 1"),
            ("B(10) (<--)+ :(b:A)", "9"),
            // Several edges in a row, and ways of several edges.
            ("A > > b:C", "6"),
            ("A(1) +> > b:C", "3"),
            ("A (>)* +> b:B", "2"),
            ("S ((>)* +>)+ b:D", "7"),
            ("S ((>)* +>)+ (>)* b:D", "7 8"),
            ("A(1) (> B > C)+ > b:A", "9"),
            ("A(1) (> (+>)?)+ b:B", "4 10 5"),
            ("D(8) ((<)* <+)+ b:C", "6"),
            ("A(1) ((-->){2})+ b:A", ""),
            ("A(1) ((-->){3})+ b:A", "9"),
            // Methods as edges.
            ("b:B -above-> A", "2 4 10"),
            ("D(8) -above-> b:D", "7"),
            ("b:D <-above- D", "7"),
            ("A -isNext-> b:B", "2 10"),
            ("b:B <-isNext- A(9)", "10"),
        ],
    );
}

#[test]
fn parts_can_be_searched_apart() {
    check_queries(
        TREE,
        &[
            ("A --> b:B", "2 4 10"),
            ("A (: --> b:B)", "2 10"),
            ("A (: --> b:B, (b.v > 2))", "4 10"),
            ("A (& --> b:B)", "2 4 10"),
            ("A (? +> b:B)", "2 -"),
            ("C (? +> b:D)", "- 7"),
            ("C (? +> b:D), (b == null)", "-"),
            ("x:C (? +> b:D), (x.v > 3)", "7"),
            ("A (: +> B), b:C", "3 6"),
        ],
    );
}

#[test]
fn a_sequential_step_applies_one_match() {
    let grown = |mode: &str, steps| {
        let text = format!(
            "{MODULES}protected void init() {{ [ Axiom ==> S A(1) A(2) A(3); ] setDerivationMode({mode}); }}
             public void run() [ A(x), (x < 10) ==> A(x + 10); A(x) ==> B(x); ]"
        );
        Model::new(&text).unwrap().grown(steps).unwrap().shown()
    };
    // One application per step: of the first rule that matches, its first match. Nodes of the newest step come first
    // (golden model 29), so the last of the three is the first to become a B.
    let sequential = "SEQUENTIAL_MODE | EXCLUDE_DELETED_FLAG";
    for (steps, expected) in [
        (0, "SA1A2A3"),
        (1, "SA11A2A3"),
        (2, "SA11A12A3"),
        (3, "SA11A12A13"),
        (4, "SA11A12B13"),
    ] {
        assert_eq!(grown(sequential, steps), expected, "{steps}");
    }
    for mode in [
        "PARALLEL_NON_DETERMINISTIC_MODE",
        "PARALLEL_MODE | INTERPRETIVE_FLAG",
    ] {
        let text = format!("protected void init() {{\n setDerivationMode({mode}); }}");
        let fault = Model::new(&text)
            .unwrap()
            .grown(0)
            .err()
            .unwrap_or_default();
        assert!(
            fault.starts_with("2: ") && fault.contains("is not supported"),
            "{fault}"
        );
    }
    let parallel = "PARALLEL_MODE | EXCLUDE_DELETED_FLAG";
    assert_eq!(grown(parallel, 1), "SA11A12A13");
    assert_eq!(grown(parallel, 2), "SB11B12B13");
}

/// What has no meaning is refused at its place, with a way out.
#[test]
fn what_cannot_be_is_refused() {
    for (pattern, message) in [
        (
            "A (> | +>) B",
            "alternatives between edges are not supported",
        ),
        (
            "A (> b:B)+ C",
            "in a closure stand edges and types of nodes only",
        ),
        ("A (-->, (1 > 0))+ B", "a closure cannot hold a condition"),
        (
            "A (-ancestor->)+ B",
            "this edge leads over many edges by itself",
        ),
        (
            "A (-above->)+ B",
            "a method as an edge leads from one node to another",
        ),
        (
            "A -above- B",
            "a method as an edge leads from one node to another",
        ),
        ("A -nowhere-> B", "unknown edge `nowhere`"),
        ("A ((-->){1000}){1000} B", "this closure has"),
        ("A > > B", "an edge needs a node on either side"),
        ("A (? > B)", "what may be missing cannot be replaced"),
        ("A (: > B) C", "ends its row"),
        ("A, isNext(A)", "a condition stands in parentheses"),
    ] {
        let found = after("A(1)", &format!("\n{pattern} ==> ;"))
            .err()
            .unwrap_or_default();
        assert!(found.contains(message), "{pattern}: {found}");
        assert!(found.starts_with("8: "), "{pattern}: {found}");
        assert!(found.contains('('), "{pattern}: no hint: {found}");
    }
}
