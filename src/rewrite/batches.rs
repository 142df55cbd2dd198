//! Matches whose right-hand side is a template: noted in bulk, applied in bulk.
//!
//! Only a step that is all templates is applied so. As soon as anything else is queued, or at the end if the graph is no
//! tree, the matches noted so far are queued one by one as any other; the result is the same.

use super::queue::Queue;
use crate::check::model::Arrow;
use crate::graph::{Batch, Graph, GraphError, NodeId, Payload, Template};
use std::sync::Arc;

impl<O: Payload> Queue<O> {
    /// Whether matches can be noted in bulk: nothing is queued that is no template.
    pub fn takes_batches(&self) -> bool {
        self.depth == 0 && self.has_no_operations()
    }

    /// Whether a match of this template can be noted in bulk now: there must be room for its nodes.
    pub fn has_room_for(&self, graph: &Graph<O>, template: &Template) -> bool {
        let n_nodes = self.n_noted_nodes + template.n_nodes();
        let n_words = self.n_noted_words + template.n_words();
        self.takes_batches() && graph.has_room(n_nodes, n_words)
    }

    /// Notes a match, if [`Queue::has_room_for`] it: copies of `template` with the words `given` replace `node`.
    pub fn note_match(
        &mut self,
        graph: &mut Graph<O>,
        template: &Arc<Template>,
        node: NodeId,
        given: &[u32],
    ) {
        graph.consume(node);
        self.n_noted_nodes += template.n_nodes();
        self.n_noted_words += template.n_words();
        let last = self.batches.last();
        if !last.is_some_and(|last| Arc::ptr_eq(&last.template, template)) {
            self.batches.push(Batch::new(Arc::clone(template)));
        }
        if let Some(batch) = self.batches.last_mut() {
            batch.matched.push(node);
            batch.given.extend_from_slice(given);
        }
    }

    /// Queues all matches noted in bulk one by one, so that anything else can be queued behind them.
    pub fn settle(&mut self, graph: &mut Graph<O>) -> Result<(), GraphError> {
        if self.batches.is_empty() {
            return Ok(());
        }
        let mut nodes = vec![];
        for batch in self.take_batches() {
            for (number, &node) in batch.matched.iter().enumerate() {
                self.settle_one(graph, &batch, number, node, &mut nodes)?;
            }
        }
        Ok(())
    }

    fn settle_one(
        &mut self,
        graph: &mut Graph<O>,
        batch: &Batch,
        number: usize,
        node: NodeId,
        nodes: &mut Vec<NodeId>,
    ) -> Result<(), GraphError> {
        let (template, given) = (&*batch.template, batch.given(number));
        nodes.clear();
        for part in 0..template.n_nodes() as u32 {
            nodes.push(graph.create_part(template, part, given)?);
        }
        let edges = (0..template.n_nodes() as u32).filter_map(|part| {
            let (parent, bits) = template.parent(part)?;
            Some((nodes[parent as usize], nodes[part as usize], bits))
        });
        self.replace_node(
            graph,
            Arrow::Lindenmayer,
            node,
            (nodes[0], nodes[template.last() as usize]),
            edges,
        );
        Ok(())
    }

    /// All batches, which are then no longer noted.
    pub(super) fn take_batches(&mut self) -> Vec<Batch> {
        (self.n_noted_nodes, self.n_noted_words) = (0, 0);
        std::mem::take(&mut self.batches)
    }

    /// Applies the step in bulk if it can be; else it is queued match by match.
    pub(super) fn apply_batches(&mut self, graph: &mut Graph<O>) -> Result<bool, GraphError> {
        if self.batches.is_empty() {
            return Ok(false);
        }
        if self.takes_batches() && graph.can_replace(&self.batches) {
            let batches = self.take_batches();
            graph.replace(&batches);
            return Ok(true);
        }
        self.settle(graph)?;
        Ok(false)
    }
}
