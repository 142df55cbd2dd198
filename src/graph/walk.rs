//! Depth-first walk over the graph, without recursion: chains of millions of nodes are usual.

use super::{EdgeBits, Graph, NodeId, Payload};

/// What a walk meets.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Event {
    /// A node, for the first time: its children follow.
    Node(NodeId),
    /// A node that was met before (rings, several parents): its children do not follow.
    Again(NodeId),
    /// A child that hangs on the node by this edge; until the matching [`Event::Close`] all belongs to it. The only
    /// successor of a node follows without.
    Open(EdgeBits),
    /// End of what began with [`Event::Open`].
    Close,
}

impl<O: Payload> Graph<O> {
    /// Walks over all that is reachable from `start`: of each node first the branches, then other edges, then successors,
    /// each in order of insertion.
    pub fn walk(&self, start: NodeId, mut visit: impl FnMut(Event)) {
        let mut seen = vec![false; self.nodes.len()];
        let mut open = vec![Event::Node(start)];
        let mut children = vec![];
        while let Some(event) = open.pop() {
            match event {
                Event::Node(node) if std::mem::replace(&mut seen[node.index()], true) => {
                    visit(Event::Again(node));
                }
                Event::Node(node) => {
                    visit(event);
                    self.push_children(node, &mut children);
                    open.extend(children.drain(..).rev());
                }
                Event::Again(_) | Event::Open(_) | Event::Close => visit(event),
            }
        }
    }

    fn push_children(&self, node: NodeId, children: &mut Vec<Event>) {
        let rank = |bits: EdgeBits| match bits {
            _ if bits.intersects(EdgeBits::SUCCESSOR) => 2,
            _ if bits.intersects(EdgeBits::BRANCH) => 0,
            _ => 1,
        };
        let n_successors = self
            .out_edges(node)
            .filter(|&(_, bits)| rank(bits) == 2)
            .count();
        for wanted in 0..3 {
            for (child, bits) in self
                .out_edges(node)
                .filter(|&(_, bits)| rank(bits) == wanted)
            {
                let is_inline = wanted == 2 && n_successors == 1;
                if is_inline {
                    children.push(Event::Node(child));
                } else {
                    children.extend([Event::Open(bits), Event::Node(child), Event::Close]);
                }
            }
        }
    }
}
