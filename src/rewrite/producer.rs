//! The right-hand side of a match: which nodes and edges it asks for.

use super::path::is_single_edge;
use super::plan::Plan;
use super::queue::{Connection, EdgeRequest, Queue};
use crate::check::model::Arrow;
use crate::graph::pattern::{EdgeKind, EdgeWay, Pattern, PatternEdge};
use crate::graph::{EdgeBits, Graph, GraphError, NodeId, Payload};

/// A right-hand side under way.
#[derive(Debug)]
pub(super) struct Frame {
    /// `None` while an instantiation body is drawn.
    arrow: Option<Arrow>,
    /// Nodes of the left-hand side.
    matched: Vec<NodeId>,
    /// Which of them stay: context, or used on the right.
    is_kept: Vec<bool>,
    /// Edges of the left-hand side that vanish unless made again.
    matched_edges: Vec<EdgeRequest>,
    /// First and last node of the left-hand side that are not context.
    ends: (Option<NodeId>, Option<NodeId>),
    /// What the next node is linked to.
    previous: Option<NodeId>,
    /// How the next node is linked, unless said otherwise.
    standard: EdgeBits,
    /// Said otherwise.
    explicit: Option<(EdgeKind, EdgeWay)>,
    /// Whether no comma was met.
    is_first_part: bool,
    brackets: Vec<(Option<NodeId>, EdgeBits, bool)>,
    /// First and last node outside brackets, before the first comma.
    first: Option<NodeId>,
    last: Option<NodeId>,
    /// Nodes that begin a bracket before any node outside brackets.
    deep: Vec<NodeId>,
    /// Nodes that nothing on the right leads to, and whether they begin a bracket.
    heads: Vec<(NodeId, bool)>,
    edges: Vec<EdgeRequest>,
    undirected: Vec<EdgeRequest>,
    is_cut: bool,
    /// Nodes made for an instantiation body.
    made: Vec<NodeId>,
}

impl Default for Frame {
    fn default() -> Self {
        Self {
            arrow: None,
            matched: vec![],
            is_kept: vec![],
            matched_edges: vec![],
            ends: (None, None),
            previous: None,
            standard: EdgeBits::SUCCESSOR,
            explicit: None,
            is_first_part: true,
            brackets: vec![],
            first: None,
            last: None,
            deep: vec![],
            heads: vec![],
            edges: vec![],
            undirected: vec![],
            is_cut: false,
            made: vec![],
        }
    }
}

impl Frame {
    /// Empties the frame and keeps its memory.
    fn reset(&mut self, arrow: Option<Arrow>) {
        self.arrow = arrow;
        self.matched.clear();
        self.is_kept.clear();
        self.matched_edges.clear();
        (self.ends, self.previous, self.explicit) = ((None, None), None, None);
        (self.standard, self.is_first_part) = (EdgeBits::SUCCESSOR, true);
        self.brackets.clear();
        (self.first, self.last, self.is_cut) = (None, None, false);
        self.deep.clear();
        self.heads.clear();
        self.edges.clear();
        self.undirected.clear();
        self.made.clear();
    }

    /// Puts a node in its place; returns the edge that shall lead to it.
    fn place(&mut self, node: NodeId) -> Option<(NodeId, EdgeBits, EdgeWay)> {
        let (bits, way) = match self.explicit.take() {
            Some((kind, way)) => (EdgeBits::of(kind), way),
            None => (self.standard, EdgeWay::Forward),
        };
        let link = self.previous.map(|previous| (previous, bits, way));
        if link.is_none() {
            self.heads.push((node, !self.brackets.is_empty()));
        }
        if self.is_first_part {
            match (link, self.brackets.is_empty()) {
                (None, true) => self.first = Some(node),
                (None, false) => self.deep.push(node),
                (Some(_), _) => {}
            }
            if self.brackets.is_empty() {
                self.last = Some(node);
            }
        }
        self.previous = Some(node);
        self.standard = EdgeBits::SUCCESSOR;
        link
    }

    /// Notes an edge of the left-hand side that vanishes unless it is made again.
    ///
    /// An edge between context nodes stays. One between a context node and another is GroIMP's business only with
    /// `==>>`; with `==>` the embedding decides, so that `(* A *) b:B ==> b C` does not cut `b` off.
    fn match_edge<O: Payload>(
        &mut self,
        graph: &Graph<O>,
        edge: &PatternEdge,
        matched: &[NodeId],
        is_context: impl Fn(usize) -> bool,
    ) {
        let n_context = u8::from(is_context(edge.from)) + u8::from(is_context(edge.to));
        let stays = match self.arrow {
            Some(Arrow::Spo) => n_context == 2,
            Some(Arrow::Lindenmayer | Arrow::Execution) | None => n_context > 0,
        };
        if stays || !is_single_edge(edge) || edge.repeat.0 == 0 {
            return;
        }
        let bits = EdgeBits::of(edge.kind);
        let (from, to) = (matched[edge.from], matched[edge.to]);
        if edge.way != EdgeWay::Backward {
            self.matched_edges
                .push((from, to, graph.edge_bits(from, to).intersection(bits)));
        }
        if edge.way != EdgeWay::Forward {
            self.matched_edges
                .push((to, from, graph.edge_bits(to, from).intersection(bits)));
        }
    }

    fn keep(&mut self, node: NodeId) {
        for (matched, is_kept) in self.matched.iter().zip(&mut self.is_kept) {
            *is_kept |= *matched == node;
        }
    }
}

/// What an instantiation body has made: floating nodes that are drawn and freed again.
#[derive(Debug, Default)]
pub struct Instantiated {
    /// Nodes that nothing leads to, each to be drawn from the state of the module, with all that hangs on it; and whether
    /// it stands in a bracket.
    pub heads: Vec<(NodeId, bool)>,
    /// All nodes; freed by [`Queue::free_instantiated`].
    pub nodes: Vec<NodeId>,
}

impl<O: Payload> Queue<O> {
    /// Begins the right-hand side of a match of `pattern` (its nodes in `matched`).
    pub fn begin<E>(
        &mut self,
        graph: &Graph<O>,
        pattern: &Pattern<E>,
        plan: &Plan,
        arrow: Arrow,
        matched: &[NodeId],
    ) {
        let frame = self.push_frame(Some(arrow));
        frame.matched.extend_from_slice(matched);
        // A label used again stands for one node: it is consumed if any use of it is.
        let is_context = |i: usize| {
            let uses = pattern
                .nodes
                .iter()
                .zip(&plan.meant)
                .filter(|&(_, &meant)| meant == i);
            uses.into_iter().all(|(node, _)| node.is_context)
        };
        frame
            .is_kept
            .extend((0..matched.len()).map(|i| plan.meant[i] != i || is_context(i)));
        frame.ends = (
            pattern.first.map(|i| matched[i]),
            pattern.last.map(|i| matched[i]),
        );
        for edge in &pattern.edges {
            frame.match_edge(graph, edge, matched, |i| pattern.nodes[i].is_context);
        }
    }

    /// Begins an instantiation body: its nodes are linked at once, apart from the graph.
    pub fn begin_instantiation(&mut self) {
        self.push_frame(None);
    }

    /// Whether an instantiation body is at work that did not make this node: it can draw a copy of it only.
    pub fn is_foreign(&mut self, node: NodeId) -> bool {
        let frame = self.frame();
        frame.arrow.is_none() && !frame.made.contains(&node)
    }

    /// The next node, new or existing. New ones enter the graph when the step is applied. An instantiation body can only
    /// use new ones; others are left out.
    pub fn node(&mut self, graph: &mut Graph<O>, node: NodeId) -> Result<(), GraphError> {
        graph.type_of(node)?;
        let frame = self.frame();
        let link = frame.place(node);
        frame.keep(node);
        if frame.arrow.is_none() {
            return self.instantiate(graph, node, link);
        }
        let Some((previous, bits, way)) = link else {
            return Ok(());
        };
        match way {
            EdgeWay::Forward => frame.edges.push((previous, node, bits)),
            EdgeWay::Backward => frame.edges.push((node, previous, bits)),
            EdgeWay::Both => frame
                .edges
                .extend([(previous, node, bits), (node, previous, bits)]),
            EdgeWay::Undirected => frame.undirected.push((previous, node, bits)),
        }
        Ok(())
    }

    /// The next node is linked by this edge.
    pub fn edge(&mut self, kind: EdgeKind, way: EdgeWay) {
        self.frame().explicit = Some((kind, way));
    }

    /// `[`
    pub fn push(&mut self) {
        let frame = self.frame();
        frame
            .brackets
            .push((frame.previous, frame.standard, frame.is_first_part));
        frame.standard = EdgeBits::BRANCH;
    }

    /// `]`
    pub fn pop(&mut self) {
        let frame = self.frame();
        if let Some(saved) = frame.brackets.pop() {
            (frame.previous, frame.standard, frame.is_first_part) = saved;
        }
    }

    /// `,`
    pub fn separator(&mut self) {
        let frame = self.frame();
        (frame.previous, frame.is_first_part) = (None, false);
    }

    /// `%`: what the last node of the left-hand side leads to is not embedded.
    pub fn cut(&mut self) {
        self.frame().is_cut = true;
    }

    /// Ends the right-hand side: its operations are queued, nodes of the left-hand side that it did not use are consumed.
    pub fn end(&mut self, graph: &mut Graph<O>) {
        let Some(mut frame) = self.take_frame() else {
            return;
        };
        for (&node, &is_kept) in frame.matched.iter().zip(&frame.is_kept) {
            if !is_kept {
                graph.consume(node);
                self.dead_nodes.push(node);
            }
        }
        self.queue_edges(graph, &mut frame);
        if frame.arrow == Some(Arrow::Lindenmayer) {
            self.queue_embedding(graph, &frame);
        }
        for &(node, _) in &frame.heads {
            if !graph.is_inserted(node) && !graph.is_queued(node) {
                self.strays.push(node);
            }
        }
        self.give_back(frame);
    }

    /// Queues the replacement of one node by a tree of new ones, joined by `edges` in the order of the nodes they lead to;
    /// `ends` are the first node and the last one outside brackets.
    pub(super) fn replace_node(
        &mut self,
        graph: &mut Graph<O>,
        arrow: Arrow,
        node: NodeId,
        (first, last): (NodeId, NodeId),
        edges: impl Iterator<Item = EdgeRequest>,
    ) {
        let frame = self.push_frame(Some(arrow));
        frame.matched.push(node);
        frame.is_kept.push(false);
        frame.ends = (Some(node), Some(node));
        (frame.first, frame.last) = (Some(first), Some(last));
        frame.heads.push((first, false));
        frame.edges.extend(edges);
        self.end(graph);
    }

    /// Gives up a right-hand side that failed half-way; nothing of it is queued.
    pub fn abort(&mut self) {
        if let Some(frame) = self.take_frame() {
            self.give_back(frame);
        }
    }

    /// Ends an instantiation body.
    pub fn end_instantiation(&mut self) -> Instantiated {
        let Some(mut frame) = self.take_frame() else {
            return Instantiated::default();
        };
        let nodes = std::mem::take(&mut frame.made);
        let heads = std::mem::take(&mut frame.heads);
        self.give_back(frame);
        Instantiated { heads, nodes }
    }

    /// Frees what an instantiation body has made.
    pub fn free_instantiated(&mut self, graph: &mut Graph<O>, instantiated: &mut Instantiated) {
        for node in instantiated.nodes.drain(..) {
            graph.discard(node);
        }
        instantiated.heads.clear();
    }

    fn instantiate(
        &mut self,
        graph: &mut Graph<O>,
        node: NodeId,
        link: Option<(NodeId, EdgeBits, EdgeWay)>,
    ) -> Result<(), GraphError> {
        let is_new = !graph.is_inserted(node);
        let frame = self.frame();
        if !is_new {
            frame.heads.retain(|&(head, _)| head != node);
            return Ok(());
        }
        frame.made.push(node);
        match link {
            Some((previous, ..)) if graph.is_inserted(previous) => {
                frame.heads.push((node, false));
                Ok(())
            }
            Some((previous, bits, EdgeWay::Backward)) => graph.add_edge(node, previous, bits),
            Some((previous, bits, _)) => graph.add_edge(previous, node, bits),
            None => Ok(()),
        }
    }

    fn queue_edges(&mut self, graph: &mut Graph<O>, frame: &mut Frame) {
        for &(from, to, bits) in &frame.matched_edges {
            let same = frame
                .edges
                .iter()
                .filter(|&&(s, t, _)| (s, t) == (from, to));
            let kept = same.fold(EdgeBits::NONE, |kept, &(_, _, bits)| kept.union(bits));
            let lost = bits.without(kept);
            let goes_anyway = graph.is_consumed(from) || graph.is_consumed(to);
            if lost != EdgeBits::NONE && !goes_anyway {
                self.dead_edges.push((from, to, lost));
            }
        }
        for &(from, to, _) in frame.edges.iter().chain(&frame.undirected) {
            self.mention(graph, from);
            self.mention(graph, to);
        }
        self.new_edges.append(&mut frame.edges);
        self.new_undirected.append(&mut frame.undirected);
    }

    fn queue_embedding(&mut self, graph: &mut Graph<O>, frame: &Frame) {
        let (start, end) = frame.ends;
        let is_consumed = |node: NodeId| {
            frame
                .matched
                .iter()
                .zip(&frame.is_kept)
                .any(|(&m, &kept)| m == node && !kept)
        };
        if let Some(source) = start {
            for &target in frame.deep.iter().filter(|&&deep| deep != source) {
                self.mention(graph, target);
                self.connections.push(Connection::Incoming {
                    source,
                    target,
                    as_branch: true,
                });
            }
        }
        let (Some(first), Some(last)) = (frame.first, frame.last) else {
            if let (Some(start), Some(end), false) = (start, end, frame.is_cut) {
                self.connections.push(Connection::Adjacent { start, end });
            }
            return;
        };
        if let Some(source) = start.filter(|&start| start != first) {
            self.mention(graph, first);
            let target = first;
            self.connections.push(Connection::Incoming {
                source,
                target,
                as_branch: false,
            });
            if !is_consumed(source) {
                self.dead_edges
                    .extend(graph.in_edges(source).map(|(s, bits)| (s, source, bits)));
            }
        }
        if let Some(source) = end.filter(|&end| end != last && !frame.is_cut) {
            self.mention(graph, last);
            self.connections.push(Connection::Outgoing {
                source,
                target: last,
            });
            if !is_consumed(source) {
                self.dead_edges
                    .extend(graph.out_edges(source).map(|(t, bits)| (source, t, bits)));
            }
        }
    }

    fn push_frame(&mut self, arrow: Option<Arrow>) -> &mut Frame {
        if self.frames.len() == self.depth {
            self.frames.push(Frame::default());
        }
        self.depth += 1;
        let frame = self.frame();
        frame.reset(arrow);
        frame
    }

    /// The innermost right-hand side.
    fn frame(&mut self) -> &mut Frame {
        if self.depth == 0 {
            self.push_frame(None);
        }
        &mut self.frames[self.depth - 1]
    }

    fn take_frame(&mut self) -> Option<Frame> {
        self.depth = self.depth.checked_sub(1)?;
        Some(std::mem::take(&mut self.frames[self.depth]))
    }

    fn give_back(&mut self, frame: Frame) {
        self.frames[self.depth] = frame;
    }
}
