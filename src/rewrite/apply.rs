//! Applying a step: births, embedding, edges, assignments, deaths, in this order.
//!
//! The embedding follows GroIMP. Where a node and its predecessor are both replaced, the replacement of the one is linked
//! to the replacement of the other, whatever the order of the rules; all such links are found first and made afterwards,
//! the last one first, so the replaced children of a node change their order.

use super::queue::{Connection, EdgeRequest, Queue, RewriteError};
use crate::graph::{EdgeBits, Graph, GraphError, NodeId, Payload};

/// Memory of [`Queue::apply`], kept from step to step.
#[derive(Debug, Default)]
pub(super) struct Buffers {
    incoming: Chains,
    outgoing: Chains,
    links: Vec<EdgeRequest>,
    edges: Vec<(NodeId, EdgeBits)>,
}

/// Lists by node, the item added last first.
#[derive(Debug, Default)]
struct Chains {
    /// Number of the last item of a node plus one, by place of the node; 0 for none.
    heads: Vec<u32>,
    items: Vec<Replacement>,
}

/// A node of the right-hand side that takes the place of one of the left-hand side, in one direction.
#[derive(Clone, Copy, Debug)]
struct Replacement {
    source: NodeId,
    target: NodeId,
    as_branch: bool,
    /// The item added before for the same node, plus one.
    next: u32,
}

impl Chains {
    fn add(&mut self, source: NodeId, target: NodeId, as_branch: bool) {
        if self.heads.len() <= source.index() {
            self.heads.resize(source.index() + 1, 0);
        }
        let head = &mut self.heads[source.index()];
        self.items.push(Replacement {
            source,
            target,
            as_branch,
            next: *head,
        });
        *head = self.items.len() as u32;
    }

    fn of(&self, node: NodeId) -> impl Iterator<Item = &Replacement> {
        let first = self.heads.get(node.index()).copied().unwrap_or(0);
        let item = |number: u32| self.items.get((number as usize).checked_sub(1)?);
        std::iter::successors(item(first), move |replacement| item(replacement.next))
    }

    fn clear(&mut self) {
        for item in self.items.drain(..) {
            self.heads[item.source.index()] = 0;
        }
    }
}

impl<O: Payload> Queue<O> {
    /// Does all that is queued and ends the step. After an error the graph is in order, but the step is done in part.
    pub fn apply(&mut self, graph: &mut Graph<O>) -> Result<(), RewriteError> {
        let result = self.apply_all(graph);
        self.clear_operations(graph);
        graph.end_of_step();
        result
    }

    fn apply_all(&mut self, graph: &mut Graph<O>) -> Result<(), RewriteError> {
        if self.apply_batches(graph)? {
            return Ok(());
        }
        for node in self.born.drain(..).rev() {
            graph.insert(node)?;
        }
        let mut buffers = std::mem::take(&mut self.buffers);
        let embedded = self.embed(graph, &mut buffers);
        buffers.incoming.clear();
        buffers.outgoing.clear();
        buffers.links.clear();
        self.buffers = buffers;
        embedded?;
        for (from, to, bits) in self.new_edges.drain(..) {
            graph.add_edge(from, to, bits)?;
        }
        for (from, to, bits) in self.new_undirected.drain(..) {
            let is_reversed = graph.edge_bits(from, to) == EdgeBits::NONE
                && graph.edge_bits(to, from) != EdgeBits::NONE;
            let (from, to) = if is_reversed { (to, from) } else { (from, to) };
            graph.add_edge(from, to, bits)?;
        }
        for assignment in self.assignments.drain(..) {
            assignment.apply(graph)?;
        }
        for (from, to, bits) in self.dead_edges.drain(..) {
            graph.remove_edge(from, to, bits);
        }
        for node in self.dead_nodes.drain(..) {
            graph.forget_consumed(node);
            graph.remove(node);
        }
        Ok(())
    }

    fn embed(&mut self, graph: &mut Graph<O>, buffers: &mut Buffers) -> Result<(), GraphError> {
        for connection in self.connections.drain(..) {
            match connection {
                Connection::Incoming {
                    source,
                    target,
                    as_branch,
                } => {
                    buffers.incoming.add(source, target, as_branch);
                }
                Connection::Outgoing { source, target } => {
                    buffers.outgoing.add(source, target, false);
                }
                Connection::Adjacent { start, end } => {
                    join_around(graph, start, end, &mut buffers.edges)?;
                }
            }
        }
        find_links(graph, buffers);
        for (from, to, bits) in buffers.links.drain(..).rev() {
            graph.add_edge(from, to, bits)?;
        }
        Ok(())
    }
}

/// Cuts out the nodes from `start` to `end`: what `end` leads to hangs on the predecessor of `start` afterwards.
fn join_around<O: Payload>(
    graph: &mut Graph<O>,
    start: NodeId,
    end: NodeId,
    edges: &mut Vec<(NodeId, EdgeBits)>,
) -> Result<(), GraphError> {
    let Some((predecessor, _)) = graph.predecessor(start) else {
        return Ok(());
    };
    edges.clear();
    edges.extend(graph.out_edges(end));
    for &(target, bits) in &*edges {
        graph.remove_edge(end, target, bits);
        if target != predecessor {
            graph.add_edge(predecessor, target, bits)?;
        }
    }
    Ok(())
}

/// Finds all edges that the embedding makes.
fn find_links<O: Payload>(graph: &Graph<O>, buffers: &mut Buffers) {
    let Buffers {
        incoming,
        outgoing,
        links,
        ..
    } = buffers;
    for &Replacement { source, target, .. } in &outgoing.items {
        for (child, bits) in graph.out_edges(source) {
            let mut is_replaced = false;
            for child in incoming.of(child) {
                // A leading bracket follows its predecessor's replacement only along a branch.
                let link = if child.as_branch {
                    bits.intersection(EdgeBits::BRANCH)
                } else {
                    bits
                };
                if link != EdgeBits::NONE {
                    is_replaced = true;
                    links.push((target, child.target, link));
                }
            }
            if !is_replaced {
                links.push((target, child, bits));
            }
        }
    }
    let carries = EdgeBits::SUCCESSOR.union(EdgeBits::BRANCH);
    for &Replacement {
        source,
        target,
        as_branch,
        ..
    } in &incoming.items
    {
        for (parent, bits) in graph.in_edges(source) {
            if outgoing.of(parent).next().is_some() {
                continue;
            }
            if !as_branch {
                links.push((parent, target, bits));
            } else if bits.intersects(carries) {
                links.push((parent, target, EdgeBits::BRANCH));
            }
        }
    }
}
