//! GroIMP's own results (golden models 10, 11, 13, 14, 16, 17, 19, 20, 25, 29, 49) on rules written as text.

mod world;

use super::*;
use crate::check::model::Arrow;
use crate::graph::testing::{self, new_node};
use crate::graph::{Graph, GraphError, NodeId};
use world::World;

/// One step of `rules` (separated by `;`) on `S` and what follows it in `start`.
#[track_caller]
fn check(start: &str, rules: &str, expected: &str) {
    let mut world = World::new(&format!("S {start}"));
    let rules: Vec<&str> = rules.split(';').filter(|r| !r.trim().is_empty()).collect();
    world.step(&rules).expect("no errors");
    assert_eq!(world.show(), expected, "{start} by {rules:?}");
    assert_eq!(world.graph.validate(), Ok(()));
}

#[test]
fn lindenmayer_arrow() {
    check("A(1) B(2) C(3)", "B(x) ==> D(x)", "SA1D2C3");
    check("A(1) B(2) C(3)", "B(x) ==> D(x) E(x+1)", "SA1D2E3C3");
    check("A(1) B(2) C(3)", "B(x) ==> D(x) [E(9)]", "SA1D2[E9]C3");
    check("A(1) B(2) C(3)", "B(x) ==> [E(9)] D(x)", "SA1[E9]D2C3");
    check("A(1) B(2) C(3)", "B(x) ==> [D(8)] [E(9)]", "SA1[E9][D8]C3");
    check(
        "A(1) B(2) [C(3)] C(4)",
        "B(x) ==> D(x) E(5)",
        "SA1D2E5[C3]C4",
    );
    check(
        "A(1) [B(2) C(3)] C(4)",
        "B(x) ==> D(x) E(5)",
        "SA1[D2E5C3]C4",
    );
    check("A(1) B(2) [C(3)] C(4)", "B ==> ", "SA1[C3]C4");
    check("A(1) [B(2) C(3)] C(4)", "B ==> ", "SA1(C4)(C3)");
    check("A(1) B(2)", "B ==> ", "SA1");
    check("A(1) B(2) C(3)", "A B ==> ", "SC3");
    check("A(1) B(2) C(3)", "A(x), B(y) ==> D(x) E(y)", "SD1E2C3");
    check(
        "A(1) B(2) [C(7)] C(3)",
        "A(x) B(y) ==> D(x*10+y)",
        "SD12[C7]C3",
    );
    check("A(1) [C(7)] B(2) C(3)", "A(x) B(y) ==> D(x*10+y)", "SD12C3");
    check("A(1) A(2) A(3) A(4)", "A(x) A(y) ==> B(x*10+y)", "SB12B34");
}

#[test]
fn single_push_out_arrow() {
    check("A(1) B(2) C(3)", "B(x) ==>> D(x)", "SA1");
    check("A(1) B(2) C(3)", "B(x) ==>> ^ D(x)", "SA1");
    check("A(1) B(2) C(3) [D(4)] E(5)", "B ==>> ", "SA1");
    check("A(1) [B(2) C(3)] E(5)", "B ==>> ", "SA1E5");
    check("A(1) B(2) C(3)", "a:A B ==>> a D(9)", "SA1D9");
    check("A(1) [C(7)] B(2) C(3)", "a:A B ==>> a D(9)", "SA1[C7]D9");
    check("A(1) B(2) C(3)", "a:A b:B ==>> a D(9) b", "SA1D9B2C3");
    check("A(1) B(2) C(3)", "a:A b:B ==>> b a", "SA1");
    check("A(1) B(2)", "a:A ==>> a [D(9)]", "SA1[D9]B2");
    check(
        "A(1) B(2) C(3)",
        "b:B ==>> b [D(9)] E(8)",
        "SA1B2[D9](C3)(E8)",
    );
    check("A(1) B(2) C(3)", "a:A B c:C ==>> a c", "SA1C3");
}

#[test]
fn leading_brackets() {
    check("A(1) B(2)", "B ==> [D(9)] C(3)", "SA1[D9]C3");
    check(
        "A(1) B(2) E(5)",
        "B ==> [D(9)] [D(8)] C(3)",
        "SA1[D8][D9]C3E5",
    );
    check("A(1) B(2) E(5)", "B ==> [D(9)]", "SA1[D9]E5");
    check(
        "A(1) [B(2) E(5)] E(6)",
        "B ==> [D(9)] C(3)",
        "SA1[C3E5][D9]E6",
    );
    check("B(2) E(5)", "B ==> [D(9)] C(3)", "S[D9]C3E5");
    check(
        "A(1) B(2) E(5)",
        "B ==> C(3) [D(9)] [D(8)]",
        "SA1C3[D9][D8]E5",
    );
    check(
        "A(1) B(2) E(5)",
        "B ==> C(3) [D(9) D(8) [D(7)] D(6)]",
        "SA1C3[D9D8[D7]D6]E5",
    );
    check("A(1) B(2) E(5)", "B ==> C(3) [[D(9)]]", "SA1C3[D9]E5");
    check(
        "A(1) B(2) E(5)",
        "B ==> C(3) [[D(9)] D(8)]",
        "SA1C3[D9][D8]E5",
    );
}

#[test]
fn conditions() {
    check("A(1) A(5) A(9)", "A(x), (x > 4) ==> B(x)", "SA1B5B9");
    check(
        "A(1) A(5) A(9)",
        "A(x), (x > 4), (x < 8) ==> B(x)",
        "SA1B5A9",
    );
    check("A(1) A(5) A(9)", "A(5) ==> B(0)", "SA1B0A9");
    check("A(1) A(5) A(9)", "a:A, (a == 9) ==> B(3)", "SA1A5B3");
    check(
        "A(1) A(5)",
        "A(x), (x > 4) ==> B(x); A(x) ==> C(x)",
        "SC1B5",
    );
    check(
        "A(1) A(5)",
        "A(x) ==> C(x); A(x), (x > 4) ==> B(x)",
        "SC1C5",
    );
    check(
        "A(1) A(1) A(2) A(2)",
        "A(x) A(y), (x == y) ==> B(x)",
        "SB1B2",
    );
}

#[test]
fn rules_of_one_step() {
    check("A(1) B(2)", "A(x) ==> B(x); B(x) ==> C(x)", "SB1C2");
    check("A(1)", "A(x) ==> A(x+1) A(x+2)", "SA2A3");
    check("A(1) B(2) B(3)", "A(x) B ==> C(x); B(x) ==> D(x)", "SC1D3");
    check(
        "A(1) B(2) B(3)",
        "B(x) ==> D(x); A(x) B ==> C(x)",
        "SA1D2D3",
    );
    check("A(1) A(2) A(3)", "A(x) A(y) ==> B(x) B(y)", "SB1B2A3");
    check("A(1)", "a:A ==> a B(2); A(x) ==> C(x)", "SC1");
    check("A(1)", "a:A ==> a B(2); a:A ==> a C(3)", "SA1(B2)(C3)");
    check(
        "A(1) B(2) C(3)",
        "A(x) ==> D(x); B(x) ==> E(x); C(x) ==> D(x)",
        "SD1E2D3",
    );
    check("A(1) B(2) C(3)", "A ==> ; B ==> ", "SC3");
    check(
        "A(1) B(2) C(3)",
        "A ==> D(1); B ==> ; C ==> [E(4)] E(5)",
        "SD1E5",
    );
    check("A(1) B(2)", "A ==> D(9); (* A *) B(x) ==> E(x)", "SD9E2");
}

#[test]
fn what_the_blank_matches() {
    check("A(1) [B(2)]", "A(x) B(y) ==> D(10*x+y)", "SA1[B2]");
    check("A(1) [B(2)]", "A(x) [B(y)] ==> D(10*x+y)", "SD12");
    check("A(1) [B(2)]", "A(x) +> B(y) ==> D(10*x+y)", "SD12");
    check("A(1) B(2)", "A(x) > B(y) ==> D(10*x+y)", "SD12");
    check("A(1) [B(2)]", "A(x) > B(y) ==> D(10*x+y)", "SA1[B2]");
    check("A(1) [B(2)]", "A(x) --> B(y) ==> D(10*x+y)", "SD12");
    check("A(1) B(2)", "A(x) --> B(y) ==> D(10*x+y)", "SD12");
    check(
        "A(1) [B(4)] B(2) [C(5)] C(3)",
        "A(x) B(y) C(z) ==> D(x*100+y*10+z)",
        "SD123",
    );
    check(
        "A(1) [B(4)] C(3)",
        "A(x) [B(y)] C(z) ==> D(x*100+y*10+z)",
        "SD143",
    );
    check(
        "A(1) [B(4)] [C(5)] E(6)",
        "A(x) [B(y)] [C(z)] ==> D(x*100+y*10+z)",
        "SD145E6",
    );
    check("A(1) C(5) B(2)", "A(x) B(y) ==> D(x*10+y)", "SA1C5B2");
}

#[test]
fn paths_in_queries() {
    let start = "S A(1) [B(2) C(3)] B(4) [E(10) B(5)] C(6) [D(7) D(8)] A(9) B(10)";
    let mut world = World::new(start);
    for (query, expected) in [
        ("A b:B", "4 10"),
        ("A > b:B", "4 10"),
        ("A +> b:B", "2"),
        ("A --> b:B", "2 4 10"),
        ("b:B < A", "4 10"),
        ("b:B <-- A", "2 4 10"),
        ("b:B <+ A", "2"),
        ("B +> b:B", ""),
        ("C < b:B", "2 4"),
        ("A -- b:B", "2 4 10"),
        ("A --- b:B", "4 10"),
        ("A (-->)+ b:B", "2 4 5 10 10"),
        ("A(1) (-->)+ b:B", "2 4 5 10"),
        ("A(1) (>)+ b:B", "4 10"),
        ("A(1) (-->)* b:B", "2 4 5 10"),
        ("B (-->)* b:B", "2 4 5 10 5 10"),
        ("A (-->){2} b:B", ""),
        ("A (-->){1,3} b:B", "2 4 5 10"),
        ("A (-->)? b:B", "2 4 10"),
        ("B(10) (<--)+ b:A", "9 1"),
        ("C(6) (<--)+ b:B", "4"),
        ("A [b:B] C", ""),
        ("A [B] b:B", "4"),
        ("A, b:B", "2 2 4 4 5 5 10 10"),
        ("A b:B, b C", "4"),
        ("B -minDescendants-> b:B", "5 10"),
        ("A -minDescendants-> b:B", "2 4 10"),
        ("B -ancestor-> b:A", "1 1 1 9"),
        ("D -ancestor-> b:B", "4 4"),
        ("A -descendants-> b:B", "4 10 5 2 10"),
        ("S (-->)+ b:A", "1 9"),
        ("S (-->)+ b:B", "2 4 5 10"),
        ("B(10) <-minDescendants- b:A", "9"),
    ] {
        assert_eq!(world.query(query), expected, "{query}");
    }
}

#[test]
fn root_and_axiom() {
    let mut world = World::new("Axiom");
    world
        .step(&["Axiom ==> S A(1), ^ B(2), ^ [C(3)]"])
        .expect("no errors");
    assert_eq!(world.query("^ b:B"), "2");
    assert_eq!(world.query("^ +> b:C"), "3");
    world.step(&["A(x) ==>> ^ D(x)"]).expect("no errors");
    assert_eq!(world.show(), "S");
    assert_eq!(world.query("^ b:D"), "1");
    assert_eq!(
        world.step(&["D(x) ==> ^ E(x)"]),
        Err(RewriteError::Graph(GraphError::SelfEdge))
    );
}

#[test]
fn sequential_steps_and_steps_without_exclusion() {
    let mut world = World::new("S A(1) A(2) A(3)");
    world.mode.derivation = Derivation::Sequential;
    for expected in ["SA11A2A3", "SA21A2A3"] {
        world
            .step(&["A(x) ==> A(x+10)", "B(x) ==> C(x)"])
            .expect("no errors");
        assert_eq!(world.show(), expected);
    }
    world.mode = Mode {
        excludes_consumed: true,
        ..Mode::default()
    };
    world
        .step(&["A(x) ==> A(x+10)", "B(x) ==> C(x)"])
        .expect("no errors");
    assert_eq!(world.show(), "SA31A12A13");
    world.mode = Mode {
        excludes_consumed: false,
        ..Mode::default()
    };
    world
        .step(&["A(x), (x > 5) ==> B(x)", "A(x) ==> C(x)"])
        .expect("no errors");
    let expected = "S(C31(B12(B13)(C13))(C12(B13)(C13)))(B31(B12(B13)(C13))(C12(B13)(C13)))";
    assert_eq!(world.show(), expected);
}

#[test]
fn self_and_subtree() {
    let mut world = World::new("S A(1) B(20) [C(3) C(4)] D(5) E(6)");
    world.step(&["c:C, (c == 3) ==>> "]).expect("no errors");
    assert_eq!(world.show(), "SA1B20D5E6");
    world.step(&["a:A b:B ==>> a, ^ b"]).expect("no errors");
    assert_eq!(world.show(), "SA1");
    assert_eq!(world.query("^ b:B"), "20");
}

#[test]
fn a_context_does_not_cut_off_what_is_kept() {
    check("A(1) B(2) C(3)", "(* A *) b:B ==> b D(4)", "SA1B2D4C3");
}

#[test]
fn nodes_of_a_bracket_that_stands_first_are_born_last() {
    let mut world = World::new("S Z");
    world
        .step(&["Z ==> [A(1)] [B(2) A(3)] [A(4)]"])
        .expect("no errors");
    assert_eq!(world.query("b:A"), "3 1 4");
}

#[test]
fn a_long_run_does_not_leak() {
    let mut world = World::new("S A(1)");
    world
        .step(&["A(x) ==> A(x) A(x) A(x) A(x)"])
        .expect("no errors");
    let mut memory = vec![];
    for _ in 0..20 {
        world
            .step(&["A(x) ==> B(x)", "B(x) ==> A(x)"])
            .expect("no errors");
        memory.push(world.graph.memory());
    }
    assert_eq!(memory[4], memory[19]);
    assert_eq!(world.graph.n_nodes(), 2 + 4);
}

#[test]
fn known_nodes_are_all_respected() {
    let mut world = World::new("S A(1) [C(9)] B(2) B(3)");
    assert_eq!(world.query("$A > b:$B"), "2");
    assert_eq!(world.query("$A b:$C"), "");
    assert_eq!(world.query("$A [b:$C]"), "9");
    assert_eq!(world.query("B < b:$B"), "2");
    assert_eq!(world.query("b:$E"), "");
}

#[test]
fn a_walk_both_ways_ends() {
    let mut world = World::new("S A(1) [B(2) B(3)] B(4)");
    assert_eq!(world.query("A (--)+ b:B"), "2 3 4");
}

#[test]
fn the_order_of_matches_does_not_depend_on_where_the_search_begins() {
    let chain: String = (1..=30).map(|i| format!("A({i}) ")).collect();
    let mut world = World::new(&format!("S {chain}"));
    for (at, value) in [(20, 1), (3, 2), (11, 3)] {
        world
            .step(&[&format!("a:A, (a == {at}) ==> a [B({value})]")])
            .expect("no errors");
    }
    assert_eq!(world.query("b:B"), "3 2 1");
    assert_eq!(world.query("A +> b:B"), "2 3 1");
    assert_eq!(world.query("A A [b:B]"), "2 3 1");
    assert_eq!(world.query("b:A --> B"), "3 11 20");
}

#[test]
fn nodes_of_the_newest_step_come_first() {
    let mut world = World::new("S A(1) A(2) A(3)");
    world.step(&["A(2) ==> A(8) A(9)"]).expect("no errors");
    assert_eq!(world.query("b:A"), "8 9 1 3");
}

#[test]
fn a_step_may_end_inside_a_right_hand_side() {
    let mut world = World::new("S A(1)");
    let plan_of = |world: &mut World| {
        let pattern = world.pattern("A", false);
        (Plan::new(&pattern), pattern)
    };
    let (plan, pattern) = plan_of(&mut world);
    let a = world
        .graph
        .extent(testing::type_named(&world.graph, "A"))
        .next()
        .expect("one");
    let World { graph, queue, .. } = &mut world;
    queue.begin(graph, &pattern, &plan, Arrow::Lindenmayer, &[a]);
    let b = new_node(graph, "B(2)").expect("room");
    queue.node(graph, b).expect("exists");
    queue.apply(graph).expect("no errors");
    let c = new_node(graph, "C(3)").expect("room");
    queue.node(graph, c).expect("exists");
    queue.end(graph);
    queue.apply(graph).expect("no errors");
    assert_eq!(world.show(), "SB2C3");
}

#[test]
fn a_right_hand_side_that_fails_leaves_nothing() {
    let mut world = World::new("S A(1)");
    let pattern = world.pattern("A", false);
    let plan = Plan::new(&pattern);
    let a = world
        .graph
        .extent(testing::type_named(&world.graph, "A"))
        .next()
        .expect("one");
    world
        .queue
        .begin(&world.graph, &pattern, &plan, Arrow::Lindenmayer, &[a]);
    world.queue.abort();
    assert!(world.queue.is_empty());
    world.step(&[]).expect("no errors");
    assert_eq!(world.show(), "SA1");
}

#[test]
fn an_instantiation_body_is_linked_apart_from_the_graph() {
    let mut world = World::new("S A(1)");
    let stamp = world.graph.stamp();
    let before = world.graph.n_nodes();
    let shape = world.graph.shape_stamp();
    world.queue.begin_instantiation();
    for text in ["B(1)", "C(2)"] {
        let node = new_node(&mut world.graph, text).expect("room");
        world.queue.node(&mut world.graph, node).expect("exists");
        world.queue.push();
    }
    let mut made = world.queue.end_instantiation();
    assert_eq!((made.heads.len(), made.nodes.len()), (1, 2));
    let child = world.graph.out_edges(made.nodes[0]).next().expect("linked");
    assert_eq!(child, (made.nodes[1], crate::graph::EdgeBits::BRANCH));
    world.queue.free_instantiated(&mut world.graph, &mut made);
    assert_eq!(world.graph.n_nodes(), before);
    assert_ne!(world.graph.stamp(), stamp);
    assert_eq!(world.graph.shape_stamp(), shape);
    assert_eq!(world.graph.validate(), Ok(()));
}

/// Node by node, branches in alphabetical order: parallel steps turn the order of branches round.
fn canonical(graph: &Graph<()>, node: NodeId) -> String {
    use crate::graph::EdgeBits;
    let ty = graph.type_of(node).expect("exists");
    let children = |bits: EdgeBits| {
        let found = graph
            .out_edges(node)
            .filter(move |(_, b)| b.intersects(bits));
        let mut texts: Vec<_> = found.map(|(child, _)| canonical(graph, child)).collect();
        texts.sort();
        texts
    };
    let branches = children(EdgeBits::BRANCH).concat();
    let successors = children(EdgeBits::SUCCESSOR).concat();
    format!("{}[{branches}]{successors}", graph.types()[ty].name)
}

proptest::proptest! {
    #![proptest_config(proptest::prelude::ProptestConfig { cases: 200, failure_persistence: None, ..Default::default() })]

    /// Rules with one node on the left rewrite the graph as bracketed strings are rewritten.
    #[test]
    fn single_node_rules_are_those_of_bracketed_strings(
        start in "[A-E]( \\[ [A-E]( [A-E])? \\]){0,2}( [A-E]){0,3}",
        rules in proptest::collection::vec("[A-E]( [A-E]){0,2}( \\[ [A-E] \\])?( [A-E])?", 5),
        which in 1..32_usize,
    ) {
        let letters = ["A", "B", "C", "D", "E"];
        let chosen = |letter: &str| {
            let i = letters.iter().position(|l| *l == letter)?;
            (which >> i & 1 == 1).then(|| rules[i].as_str())
        };
        let mut world = World::new(&format!("S {start}"));
        let mut text = start;
        for _ in 0..3 {
            let all: Vec<String> = letters
                .iter()
                .filter_map(|letter| Some(format!("{letter} ==> {}", chosen(letter)?)))
                .collect();
            let all: Vec<&str> = all.iter().map(String::as_str).collect();
            world.step(&all).expect("no errors");
            let rewritten = text.split(' ').map(|symbol| chosen(symbol).unwrap_or(symbol));
            text = rewritten.collect::<Vec<_>>().join(" ");
            let expected = World::new(&format!("S {text}"));
            proptest::prop_assert_eq!(
                canonical(&world.graph, world.graph.root()),
                canonical(&expected.graph, expected.graph.root())
            );
            proptest::prop_assert_eq!(world.graph.validate(), Ok(()));
            if text.len() > 4000 {
                break;
            }
        }
    }
}
