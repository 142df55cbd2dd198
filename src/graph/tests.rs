//! Random changes of a graph against a simple model of it.

use super::pattern::EdgeKind;
use super::testing::{letters, new_node};
use super::{EdgeBits, Graph, NodeId};
use proptest::prelude::*;
use std::collections::{BTreeMap, BTreeSet};

/// What may be done to a graph; numbers choose among the nodes there are.
#[derive(Clone, Debug)]
enum Change {
    Grow(usize, bool),
    Link(usize, usize, bool),
    Cut(usize, usize),
    Remove(usize),
    EndOfStep,
}

fn changes() -> impl Strategy<Value = Vec<Change>> {
    let pick = 0..1000_usize;
    let change = prop_oneof![
        6 => (pick.clone(), any::<bool>()).prop_map(|(at, branch)| Change::Grow(at, branch)),
        3 => (pick.clone(), pick.clone(), any::<bool>())
            .prop_map(|(a, b, own)| Change::Link(a, b, own)),
        2 => (pick.clone(), pick.clone()).prop_map(|(a, b)| Change::Cut(a, b)),
        1 => pick.prop_map(Change::Remove),
        2 => Just(Change::EndOfStep),
    ];
    prop::collection::vec(change, 1..80)
}

/// Nodes and edges, kept in the plainest way.
#[derive(Default)]
struct Model {
    nodes: Vec<NodeId>,
    edges: BTreeMap<(NodeId, NodeId), EdgeBits>,
}

impl Model {
    fn remove(&mut self, gone: &BTreeSet<NodeId>) {
        self.nodes.retain(|node| !gone.contains(node));
        self.edges
            .retain(|(a, b), _| !gone.contains(a) && !gone.contains(b));
    }

    fn unreachable(&self, root: NodeId) -> BTreeSet<NodeId> {
        let mut reached = BTreeSet::from([root]);
        loop {
            let next = self
                .edges
                .keys()
                .filter(|(a, b)| reached.contains(a) && !reached.contains(b));
            let next: Vec<NodeId> = next.map(|&(_, b)| b).collect();
            if next.is_empty() {
                break;
            }
            reached.extend(next);
        }
        self.nodes
            .iter()
            .copied()
            .filter(|node| !reached.contains(node))
            .collect()
    }
}

fn apply(change: &Change, graph: &mut Graph<()>, model: &mut Model) {
    let root = graph.root();
    let pick = |model: &Model, i: usize| {
        let all = model.nodes.len() + 1;
        model.nodes.get(i % all).copied().unwrap_or(root)
    };
    match *change {
        Change::Grow(at, is_branch) => {
            let parent = pick(model, at);
            let bits = if is_branch {
                EdgeBits::BRANCH
            } else {
                EdgeBits::SUCCESSOR
            };
            let node = new_node(graph, "A(1)").expect("room");
            graph.insert(node).expect("exists");
            graph.add_edge(parent, node, bits).expect("two nodes");
            model.nodes.push(node);
            model.edges.insert((parent, node), bits);
        }
        Change::Link(a, b, is_own) => {
            let (a, b) = (pick(model, a), pick(model, b));
            let kind = if is_own {
                EdgeBits::of(EdgeKind::User(3))
            } else {
                EdgeBits::REFINEMENT
            };
            if a != b {
                graph.add_edge(a, b, kind).expect("two nodes");
                let bits = model.edges.entry((a, b)).or_default();
                *bits = bits.union(kind);
            }
        }
        Change::Cut(a, b) => {
            let edge = model
                .edges
                .keys()
                .nth((a + b) % model.edges.len().max(1))
                .copied();
            if let Some((a, b)) = edge {
                graph.remove_edge(a, b, EdgeBits::ALL);
                model.edges.remove(&(a, b));
            }
        }
        Change::Remove(at) => {
            let node = pick(model, at);
            if node != root {
                graph.remove(node);
                model.remove(&BTreeSet::from([node]));
            }
        }
        Change::EndOfStep => {
            graph.end_of_step();
            let gone = model.unreachable(root);
            model.remove(&gone);
        }
    }
}

proptest! {
    #![proptest_config(ProptestConfig { cases: 200, failure_persistence: None, ..Default::default() })]

    #[test]
    fn a_graph_is_what_was_done_to_it(changes in changes()) {
        let mut graph: Graph<()> = Graph::new(letters(), 1000).expect("small");
        let axiom = graph.out_edges(graph.root()).next().expect("axiom").0;
        graph.remove(axiom);
        let mut model = Model::default();
        for change in &changes {
            apply(change, &mut graph, &mut model);
            prop_assert_eq!(graph.validate(), Ok(()));
            prop_assert_eq!(graph.n_nodes(), model.nodes.len() + 1);
            prop_assert_eq!(graph.n_edges(), model.edges.len());
            for (&(a, b), &bits) in &model.edges {
                prop_assert_eq!(graph.edge_bits(a, b), bits);
            }
        }
    }
}
