//! Right-hand sides: nodes, edges, brackets, and the control flow around them.

use super::Scope;
use super::sequences::Turn;
use crate::check::model::{Expr, ExprKind, Production, Slot};
use crate::eval::code::{Eval, Exec, Flow, Label};
use crate::eval::stack::{Kind, Local};
use crate::eval::trap::Trap;

impl Scope<'_> {
    /// Pieces of a right-hand side in order.
    pub(super) fn productions(&self, pieces: &[Production]) -> Exec {
        let mut pieces: Vec<Exec> = pieces.iter().map(|piece| self.production(piece)).collect();
        if pieces.len() == 1 {
            return pieces.remove(0);
        }
        Box::new(move |p, m| {
            for piece in &pieces {
                match piece(p, m)? {
                    Flow::Next => {}
                    flow => return Ok(flow),
                }
            }
            Ok(Flow::Next)
        })
    }

    fn production(&self, piece: &Production) -> Exec {
        match piece {
            Production::Node { node, slot } => self.produce_node(node, *slot),
            Production::Edge(kind, way) => {
                let (kind, way) = (*kind, *way);
                Box::new(move |_, m| {
                    m.queue.edge(kind, way);
                    Ok(Flow::Next)
                })
            }
            Production::Branch(pieces) => {
                let body = self.productions(pieces);
                Box::new(move |p, m| {
                    m.queue.push();
                    let flow = body(p, m)?;
                    m.queue.pop();
                    Ok(flow)
                })
            }
            Production::Group(pieces) => self.productions(pieces),
            Production::Separator => Box::new(|_, m| {
                m.queue.separator();
                Ok(Flow::Next)
            }),
            Production::ForEach(slot, sequence, pieces) => {
                let sequence = self.sequence(sequence, slot.map(|s| self.local(s)));
                repeated(
                    sequence,
                    self.productions(pieces),
                    self.production_span(pieces),
                )
            }
            Production::Loop {
                init,
                cond,
                is_first_free,
                update,
                body,
            } => {
                let is_first_free = *is_first_free;
                let cond = cond.as_ref().map(|c| self.boolean(c));
                let update: Vec<Eval<()>> =
                    update.iter().map(|e| self.effect(e).into_void()).collect();
                let span = self.production_span(body);
                let (init, body) = (self.block(init), self.productions(body));
                Box::new(move |p, m| {
                    init(p, m)?;
                    let mut is_free = is_first_free;
                    loop {
                        if let Some(cond) = &cond
                            && !std::mem::take(&mut is_free)
                            && !cond.get(p, m)?
                        {
                            return Ok(Flow::Next);
                        }
                        match body(p, m)? {
                            Flow::Next | Flow::Continue(Label::Innermost) => {}
                            Flow::Break(Label::Innermost) => return Ok(Flow::Next),
                            flow => return Ok(flow),
                        }
                        for effect in &update {
                            effect(p, m)?;
                        }
                        m.tick(span)?;
                    }
                })
            }
            Production::If(condition, yes, no) => {
                let (condition, yes, no) = (
                    self.boolean(condition),
                    self.productions(yes),
                    self.productions(no),
                );
                Box::new(move |p, m| {
                    if condition.get(p, m)? {
                        yes(p, m)
                    } else {
                        no(p, m)
                    }
                })
            }
            Production::Code(statements) => self.block(statements),
            Production::Break => Box::new(|_, _| Ok(Flow::Break(Label::Innermost))),
            Production::Cut => Box::new(|_, m| {
                m.queue.cut();
                Ok(Flow::Next)
            }),
        }
    }

    fn produce_node(&self, node: &Expr, slot: Option<Slot>) -> Exec {
        let span = node.span;
        let is_new = makes_node(node);
        let node = self.node(node);
        let slot = slot.map(|slot| {
            let (Local::Word(at) | Local::Value(at)) = self.local(slot);
            at
        });
        Box::new(move |p, m| {
            let Some(mut node) = node.get(p, m)? else {
                return Err(Trap::null("add a node to the graph", span));
            };
            // A node that stood in a variable belongs to the model, not to the drawing; one of the graph is drawn there.
            if !is_new && m.queue.is_foreign(node) && !m.graph.is_inserted(node) {
                let copy = m.graph.twin(node);
                node = copy.map_err(|error| m.graph_trap(&error, node, span))?;
            }
            if let Some(at) = slot {
                Some(node).store(&mut m.stack, at);
            }
            m.queue
                .node(&mut m.graph, node)
                .map_err(|error| m.graph_trap(&error, node, span))?;
            Ok(Flow::Next)
        })
    }

    /// A place to name when a loop over `pieces` does not end: its first node.
    fn production_span(&self, pieces: &[Production]) -> crate::diag::Span {
        let nested = |piece: &Production| match piece {
            Production::Node { node, .. } => Some(node.span),
            Production::If(condition, ..) => Some(condition.span),
            Production::Branch(inner) | Production::Group(inner) => {
                Some(self.production_span(inner))
            }
            Production::Code(statements) => statements.first().map(|s| s.span),
            _ => None,
        };
        pieces.iter().find_map(nested).unwrap_or_default()
    }
}

/// Whether an expression makes the node it gives.
fn makes_node(node: &Expr) -> bool {
    match &node.kind {
        ExprKind::NewNode(_) => true,
        ExprKind::With { object, .. } => makes_node(object),
        _ => false,
    }
}

/// Runs `body` for each element; `break` ends it.
fn repeated(sequence: super::sequences::Iterate, body: Exec, span: crate::diag::Span) -> Exec {
    Box::new(move |p, m| {
        let mut left_by = Flow::Next;
        sequence(p, m, &mut |p, m| {
            m.tick(span)?;
            Ok(match body(p, m)? {
                Flow::Next | Flow::Continue(Label::Innermost) => Turn::Next,
                Flow::Break(Label::Innermost) => Turn::Stop,
                flow => {
                    left_by = flow;
                    Turn::Stop
                }
            })
        })?;
        Ok(left_by)
    })
}
