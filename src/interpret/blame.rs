//! Which node is at fault, and where it comes from.

use super::failure::{self, Failure};
use super::source::Source;
use super::walk::{Painter, Place};
use crate::diag::{Severity, Span};
use crate::graph::{NodeId, TypeId};

impl<S: Source> Painter<'_, S> {
    /// A node in words: its type, and whose body made it.
    pub(super) fn name(&self, node: NodeId, place: Place) -> String {
        let graph = self.source.graph();
        match graph.type_of(node) {
            Ok(ty) => self.within(&graph.types()[ty].name, place),
            Err(_) => self.within("deleted node", place),
        }
    }

    fn within(&self, node: &str, place: Place) -> String {
        match place.owner.and_then(|owner| self.organs.type_name(owner)) {
            Some(owner) if place.depth > 0 => format!("`{node}` in the body of `{owner}`"),
            _ => format!("`{node}`"),
        }
    }

    /// Where the module of a node, or the one whose body made it, is declared.
    pub(super) fn span(&self, node: NodeId, place: Place) -> Option<Span> {
        let ty = self.source.graph().type_of(node).ok()?;
        let own = self.source.declared_at(ty);
        own.or_else(|| self.organs.declared_at(place.owner?))
    }

    /// Notes something about a node, once for each type.
    pub(super) fn warn(&mut self, node: NodeId, slug: &'static str, what: &str) {
        let ty = self.source.graph().type_of(node).unwrap_or(TypeId(0));
        if self.warned.insert((slug, ty)) {
            self.warn_of(node, slug, what);
        }
    }

    /// Notes something about a node.
    pub(super) fn warn_of(&mut self, node: NodeId, slug: &'static str, what: &str) {
        let place = Place::default();
        let message = format!("{} {what}", self.name(node, place));
        let span = self.span(node, place);
        let warning = failure::diagnostic(Severity::Warning, slug, message, span);
        let warning = failure::made_at(warning, self.made(node));
        self.warnings.push(warning);
    }

    /// Where in the text nodes of the type of a node are made.
    pub(super) fn made(&self, node: NodeId) -> &[Span] {
        let ty = self.source.graph().type_of(node).unwrap_or(TypeId(0));
        self.source.made_at(ty)
    }

    /// The failure of a node whose size or place is no number, told of the node where that began.
    pub(super) fn not_finite(&mut self, node: NodeId, place: Place) -> Failure {
        let node = self.first_lost(node);
        let graph = self.source.graph();
        let name = self.within(&graph.node_text(node), place);
        let Ok(ty) = graph.type_of(node) else {
            return failure::not_finite(&name, None, &[]);
        };
        let made = self.source.made_at(ty);
        let owner = place.owner.filter(|_| place.depth > 0);
        match owner.and_then(|owner| self.organs.declared_at(owner)) {
            // It was made in that very body.
            Some(body) => {
                let is_inside =
                    |s: &&Span| s.file == body.file && body.start <= s.start && s.end <= body.end;
                let made: Vec<Span> = made.iter().filter(is_inside).copied().collect();
                let primary = if made.is_empty() { Some(body) } else { None };
                failure::not_finite(&name, primary, &made)
            }
            None => failure::not_finite(&name, self.source.declared_at(ty), made),
        }
    }

    /// The first node on the way to `node` behind which the turtle stands nowhere; `node` itself if the turtle does reach it.
    fn first_lost(&mut self, node: NodeId) -> NodeId {
        let graph = self.source.graph();
        let mut lost = node;
        while let Some((parent, _)) = graph.predecessor(lost) {
            let state = self.poses.after(graph, parent);
            if state.is_ok_and(|state| state.transform.is_finite()) {
                break;
            }
            lost = parent;
        }
        lost
    }
}
