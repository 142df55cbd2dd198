use super::*;
use crate::graph::{FieldKind, NewField, TypeTable};
use crate::turtle::types;
use glam::DAffine3;
use std::sync::Arc;

/// What object fields hold here.
#[derive(Clone, Debug, Default)]
enum Object {
    #[default]
    Null,
    Vector(DVec3),
    Node(NodeId),
}

impl Payload for Object {
    fn is_null(&self) -> bool {
        matches!(self, Self::Null)
    }

    fn as_node(&self) -> Option<NodeId> {
        match self {
            Self::Node(node) => Some(*node),
            Self::Null | Self::Vector(_) => None,
        }
    }

    fn as_vector(&self) -> Option<DVec3> {
        match self {
            Self::Vector(v) => Some(*v),
            Self::Null | Self::Node(_) => None,
        }
    }

    fn as_transform(&self) -> Option<DAffine3> {
        self.as_vector().map(DAffine3::from_translation)
    }

    fn text(&self) -> String {
        String::new()
    }
}

fn new_graph() -> Graph<Object> {
    let mut table: TypeTable = types();
    let parent = table.find("F").unwrap();
    table.add_module(
        "Internode",
        parent,
        false,
        &[NewField::new("age", FieldKind::Int)],
    );
    Graph::new(Arc::new(table), 2_000_000).unwrap()
}

fn add(
    graph: &mut Graph<Object>,
    on: NodeId,
    bits: EdgeBits,
    name: &str,
    fields: &[(&str, f64)],
) -> NodeId {
    let ty = graph.types().find(name).unwrap();
    let node = graph.create(ty).unwrap();
    for (field, value) in fields {
        let field = graph.types().field(ty, field).unwrap();
        graph.set_f64(node, field, *value).unwrap();
    }
    graph.insert(node).unwrap();
    graph.add_edge(on, node, bits).unwrap();
    node
}

fn set(graph: &mut Graph<Object>, node: NodeId, field: &str, value: Object) {
    let field = graph
        .types()
        .field(graph.type_of(node).unwrap(), field)
        .unwrap();
    graph.set_object(node, field, value).unwrap();
}

const NEXT: EdgeBits = EdgeBits::SUCCESSOR;
const BRANCH: EdgeBits = EdgeBits::BRANCH;

#[test]
fn a_node_stands_where_its_predecessor_ends() {
    let mut graph = new_graph();
    let mut poses = Poses::default();
    let root = graph.root();
    let stem = add(&mut graph, root, NEXT, "Internode", &[("length", 2.0)]);
    let turn = add(&mut graph, stem, BRANCH, "RU", &[("angle", 90.0)]);
    let twig = add(
        &mut graph,
        turn,
        NEXT,
        "F",
        &[("length", 3.0), ("diameter", 0.5)],
    );
    let ball = add(&mut graph, stem, NEXT, "Sphere", &[("transform.x", 5.0)]);
    let tip = add(&mut graph, ball, NEXT, "Node", &[]);

    assert_eq!(poses.location(&graph, stem), Ok(DVec3::ZERO));
    assert_eq!(
        poses.after(&graph, stem).map(|s| s.position()),
        Ok(DVec3::new(0.0, 0.0, 2.0))
    );
    assert_eq!(poses.at(&graph, turn).map(|s| s.head()), Ok(DVec3::Z));
    assert_eq!(poses.at(&graph, twig).map(|s| s.head()), Ok(DVec3::X));
    assert_eq!(
        poses.after(&graph, twig).map(|s| s.position()),
        Ok(DVec3::new(3.0, 0.0, 2.0))
    );
    // An own transformation moves the node and what follows.
    assert_eq!(poses.location(&graph, ball), Ok(DVec3::new(5.0, 0.0, 2.0)));
    assert_eq!(poses.location(&graph, tip), Ok(DVec3::new(5.0, 0.0, 2.0)));
    let order = |poses: &mut Poses, node| poses.at(&graph, node).unwrap().order;
    assert_eq!(
        [
            order(&mut poses, stem),
            order(&mut poses, twig),
            order(&mut poses, tip)
        ],
        [0, 1, 0]
    );
    let state = poses.at(&graph, twig).unwrap();
    assert_eq!(
        super::super::reading::shoot_radius(&graph, twig, &state),
        Some(0.25)
    );
    assert_eq!(
        super::super::reading::shoot_color(&graph, stem, &state),
        Some(14)
    );
    assert_eq!(
        super::super::reading::shoot_radius(&graph, ball, &state),
        None
    );
}

#[test]
fn poses_follow_changes() {
    let mut graph = new_graph();
    let mut poses = Poses::default();
    let root = graph.root();
    let stem = add(&mut graph, root, NEXT, "F", &[("length", 2.0)]);
    let tip = add(&mut graph, stem, NEXT, "Node", &[]);
    assert_eq!(poses.location(&graph, tip), Ok(DVec3::Z * 2.0));
    let length = graph
        .types()
        .field(graph.type_of(stem).unwrap(), "length")
        .unwrap();
    graph.set_f32(stem, length, 7.0).unwrap();
    assert_eq!(poses.location(&graph, tip), Ok(DVec3::Z * 7.0));
    graph.remove(tip);
    assert_eq!(poses.location(&graph, tip), Err(GraphError::DeletedNode));
}

#[test]
fn long_chains_and_rings_end() {
    let mut graph = new_graph();
    let mut poses = Poses::default();
    let mut at = graph.root();
    let mut chain = vec![];
    for _ in 0..1_000_000 {
        at = add(&mut graph, at, NEXT, "M", &[]);
        chain.push(at);
    }
    // All of them from the far end and from the near end: amortised a few steps each, or this would never end.
    for (i, node) in chain.iter().enumerate().rev().step_by(7) {
        assert_eq!(poses.location(&graph, *node).unwrap().z, i as f64);
    }
    let mut poses = Poses::default();
    for (i, node) in chain.iter().enumerate() {
        assert_eq!(poses.location(&graph, *node).unwrap().z, i as f64);
    }

    let mut ring = new_graph();
    let ty = ring.types().find("M").unwrap();
    let (a, b) = (ring.create(ty).unwrap(), ring.create(ty).unwrap());
    ring.add_edge(a, b, NEXT).unwrap();
    ring.add_edge(b, a, NEXT).unwrap();
    assert!(Poses::default().location(&ring, a).unwrap().is_finite());
}

#[test]
fn a_head_bends_to_a_node_even_below_itself() {
    let mut graph = new_graph();
    let mut poses = Poses::default();
    let root = graph.root();
    let aside = add(
        &mut graph,
        root,
        BRANCH,
        "Translate",
        &[("translateX", 4.0)],
    );
    let target = add(&mut graph, aside, NEXT, "Node", &[]);
    let bend = add(&mut graph, root, BRANCH, "RN", &[("strength", 0.5)]);
    let tip = add(&mut graph, bend, NEXT, "M", &[]);
    set(&mut graph, bend, "targetNode", Object::Node(target));
    let head = poses.at(&graph, tip).unwrap().head();
    assert!((head.x - libm::sin(0.5)).abs() < 1e-15, "{head}");
    set(&mut graph, bend, "targetNode", Object::Node(tip));
    assert!(poses.at(&graph, tip).unwrap().head().is_finite());
}

#[test]
fn directions_are_read_from_objects_and_null_does_nothing() {
    let mut graph = new_graph();
    let mut poses = Poses::default();
    let root = graph.root();
    let bend = add(&mut graph, root, NEXT, "RD", &[("strength", 1.0)]);
    let tip = add(&mut graph, bend, NEXT, "Node", &[]);
    assert_eq!(poses.at(&graph, tip).map(|s| s.head()), Ok(DVec3::Z));
    set(&mut graph, bend, "direction", Object::Vector(DVec3::Y));
    let head = poses.at(&graph, tip).unwrap().head();
    assert!((head.y - libm::sin(1.0)).abs() < 1e-15, "{head}");
}
