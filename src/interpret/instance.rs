//! `Instance(node)`: what hangs below a node, drawn again somewhere else.
//!
//! The subgraph is drawn once, in the frame its node's children start from, as a group. Gravity and tropisms act in that
//! frame, lamps are placed with each instance, and surfaces that shine keep their radiance whatever the scale.

use super::canvas::Canvas;
use super::failure::{self, Failure};
use super::shapes::FIELDS;
use super::source::Source;
use super::walk::{Painter, Place};
use crate::graph::{NodeId, Payload};
use crate::scene::description::GroupId;
use crate::turtle::TurtleState;
use std::collections::HashMap;

/// How deep instances may stand in what instances draw.
const MAX_NESTING: usize = 16;

/// Subgraphs drawn as groups.
#[derive(Debug, Default)]
pub(super) struct Instances {
    /// Looked up only, never iterated.
    by_node: HashMap<NodeId, Subgraph>,
    pub(super) nesting: usize,
}

#[derive(Clone, Copy, Debug)]
enum Subgraph {
    /// It is being drawn just now.
    Open,
    /// Nothing hangs there.
    Empty,
    Drawn(GroupId),
}

impl<S: Source> Painter<'_, S> {
    /// Draws an instance node.
    pub(super) fn draw_instance(
        &mut self,
        node: NodeId,
        state: &TurtleState,
        place: Place,
    ) -> Result<(), Failure> {
        let graph = self.source.graph();
        let target = graph.peek_object(node, FIELDS.prototype).ok().flatten();
        let Some(target) = target.and_then(Payload::as_node) else {
            self.warn(node, "instance-of-null", "has no node to draw again");
            return Ok(());
        };
        match self.subgraph(target, node, place)? {
            Subgraph::Drawn(group) => self.push_instance(group, state.transform, node, place),
            Subgraph::Open | Subgraph::Empty => Ok(()),
        }
    }

    fn subgraph(
        &mut self,
        target: NodeId,
        node: NodeId,
        place: Place,
    ) -> Result<Subgraph, Failure> {
        match self.instances.by_node.get(&target) {
            Some(Subgraph::Open) => {
                return Err(failure::endless_instance(self.span(node, place)));
            }
            Some(known) => return Ok(*known),
            None => {}
        }
        self.check_nesting(node, place)?;
        let Ok(start) = self.poses.after(self.source.graph(), target) else {
            return Err(failure::instance_of_nothing(self.span(node, place)));
        };
        self.instances.by_node.insert(target, Subgraph::Open);
        self.instances.nesting += 1;
        let below = Place {
            owner: None,
            depth: place.depth,
        };
        let fresh = Canvas::beginning_with(start.look);
        let outer = std::mem::replace(&mut self.canvas, fresh);
        let drawn = self.draw_below(target, start.at_origin(), below);
        let canvas = std::mem::replace(&mut self.canvas, outer);
        self.instances.nesting -= 1;
        drawn?;
        let found = if canvas.is_empty() {
            Subgraph::Empty
        } else {
            Subgraph::Drawn(self.add_group(canvas))
        };
        self.instances.by_node.insert(target, found);
        Ok(found)
    }

    /// Refuses a further group within groups if there are too many already.
    pub(super) fn check_nesting(&self, node: NodeId, place: Place) -> Result<(), Failure> {
        if self.instances.nesting < MAX_NESTING {
            return Ok(());
        }
        let span = self.span(node, place);
        Err(failure::instances_too_deep(MAX_NESTING, span))
    }
}
