//! `GridClonerNode`: what follows, in a grid of copies.
//!
//! It is drawn once, as a group in the frame of the world (so that gravity acts on it as it would without the grid), and
//! placed as often as there are copies. A lamp in it shines from each copy.

use super::canvas::Canvas;
use super::failure::Failure;
use super::shapes::FIELDS;
use super::source::Body;
use super::source::Source;
use super::walk::{Painter, Place};
use crate::graph::NodeId;
use crate::scene::description::OrganId;
use crate::turtle::TurtleState;
use glam::{DAffine3, DVec3};

impl<S: Source> Painter<'_, S> {
    /// Draws what follows a node, and its body, in its grid of copies.
    pub(super) fn draw_grid(
        &mut self,
        node: NodeId,
        body: Option<Body>,
        state: &TurtleState,
        place: Place,
    ) -> Result<(), Failure> {
        self.check_nesting(node, place)?;
        self.instances.nesting += 1;
        let fresh = Canvas::beginning_with(self.canvas.given_look);
        let outer = std::mem::replace(&mut self.canvas, fresh);
        let first = self.organs.len();
        let drawn = body
            .map_or(Ok(()), |body| self.draw_body(node, body, state, place))
            .and_then(|()| self.draw_below(node, *state, place));
        let canvas = std::mem::replace(&mut self.canvas, outer);
        self.instances.nesting -= 1;
        drawn?;
        self.canvas.is_bound |= canvas.is_bound;
        self.canvas.wears_given_look |= canvas.wears_given_look;
        if canvas.is_empty() {
            return Ok(());
        }
        let group = self.add_group(canvas);
        let placing = Place {
            owner: place.owner.or(Some(OrganId::COPY)),
            ..place
        };
        let graph = self.source.graph();
        let [n_x, n_y] = FIELDS
            .counts
            .map(|f| graph.get_i32(node, f).unwrap_or(0).max(0));
        let [d_x, d_y] = FIELDS
            .distances
            .map(|f| graph.get_f64(node, f).unwrap_or(0.0));
        let copies = u64::from(n_x.unsigned_abs()) * u64::from(n_y.unsigned_abs());
        self.organs.copy(first, copies.max(1));
        if copies == 0 {
            return Ok(());
        }
        for x in 0..n_x {
            for y in 0..n_y {
                let shift = DVec3::new(f64::from(x) * d_x, f64::from(y) * d_y, 0.0);
                let moved = DAffine3::from_translation(state.transform.transform_vector3(shift));
                self.push_instance(group, moved, node, placing)?;
            }
            if self.source.is_stopped() {
                return Err(super::failure::stopped());
            }
        }
        Ok(())
    }
}
