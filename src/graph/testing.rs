//! Small graphs written as text, for tests.

use super::{EdgeBits, FieldId, FieldKind, Graph, GraphError, NewField, NodeId, TypeId, TypeTable};
use std::sync::Arc;

/// A table like that of the golden models: `Node`, `RGGRoot`, `Axiom`, `S`, `Z` and `A`..`E` with an int `v`.
pub(crate) fn letters() -> Arc<TypeTable> {
    let mut table = TypeTable::default();
    let node = table.add_builtin("Node", None, false, &[]);
    for name in ["RGGRoot", "Axiom", "S", "Z"] {
        table.add_builtin(name, Some(node), false, &[]);
    }
    for name in ["A", "B", "C", "D", "E"] {
        let ty = table.add_module(name, node, false, &[NewField::new("v", FieldKind::Int)]);
        table.set_constructors(ty, vec![vec![FieldId(0)]]);
    }
    Arc::new(table)
}

/// The only field of the letters.
pub(crate) const V: FieldId = FieldId(0);

/// A graph whose root has what `text` says as successors, such as `S A(1) [B(2) C(3)] D(4)`; the axiom is gone.
pub(crate) fn graph(text: &str) -> Graph<()> {
    let mut graph = Graph::new(letters(), 10_000).expect("small");
    let axiom = graph.out_edges(graph.root()).next().expect("axiom").0;
    grow(&mut graph, text).expect("well formed");
    graph.remove(axiom);
    graph.end_of_step();
    graph
}

/// Hangs what `text` says on the root.
pub(crate) fn grow(graph: &mut Graph<()>, text: &str) -> Result<(), GraphError> {
    let mut previous = graph.root();
    let mut stack = vec![];
    let mut bits = EdgeBits::SUCCESSOR;
    let mut born = vec![];
    for token in tokens(text) {
        match token {
            "[" => {
                stack.push(previous);
                bits = EdgeBits::BRANCH;
            }
            "]" => {
                previous = stack.pop().expect("balanced");
                bits = EdgeBits::SUCCESSOR;
            }
            name => {
                let node = new_node(graph, name)?;
                born.push(node);
                graph.add_edge(previous, node, bits)?;
                (previous, bits) = (node, EdgeBits::SUCCESSOR);
            }
        }
    }
    born.into_iter()
        .rev()
        .try_for_each(|node| graph.insert(node))
}

/// A floating node from a text such as `A(7)`.
pub(crate) fn new_node(graph: &mut Graph<()>, text: &str) -> Result<NodeId, GraphError> {
    let (name, value) = split(text);
    let node = graph.create(type_named(graph, name))?;
    if let Some(value) = value {
        graph.set_i32(node, V, value.parse().expect("a number"))?;
    }
    Ok(node)
}

pub(crate) fn type_named(graph: &Graph<()>, name: &str) -> TypeId {
    graph
        .types()
        .find(name)
        .unwrap_or_else(|| panic!("type {name}"))
}

/// `A(7)` → (`A`, `7`).
pub(crate) fn split(text: &str) -> (&str, Option<&str>) {
    match text.split_once('(') {
        Some((name, rest)) => (name, Some(rest.trim_end_matches(')'))),
        None => (text, None),
    }
}

/// Words and brackets of a text.
pub(crate) fn tokens(text: &str) -> Vec<&str> {
    let mut found = vec![];
    for word in text.split_whitespace() {
        let mut rest = word;
        while let Some(at) = rest.find(['[', ']', ',']) {
            if at > 0 {
                found.push(&rest[..at]);
            }
            found.push(&rest[at..=at]);
            rest = &rest[at + 1..];
        }
        if !rest.is_empty() {
            found.push(rest);
        }
    }
    found
}
