//! Instantiation bodies: what a module draws where it stands, without moving what follows.
//!
//! A pure body gives the same for nodes with equal fields under a turtle with equal registers. It is drawn once, in a frame
//! of its own, and then placed: copied if it is small, as an instance if not.

use super::canvas::Canvas;
use super::failure::{self, Failure};
use super::source::{Body, Source};
use super::walk::{Painter, Place};
use crate::graph::{FieldKind, NodeId, TypeId};
use crate::rewrite::Instantiated;
use crate::scene::description::{GroupId, PlacedShape};
use crate::turtle::TurtleState;
use std::collections::HashMap;

/// Prototypes of at most this many shapes are copied: each shape then belongs to the organ that drew it.
const COPIED: usize = 4;
/// After so many prototypes of a type, sharing must have paid off or it ends: continuous parameters never repeat.
const TRIAL: u32 = 1024;

/// Bodies drawn before.
#[derive(Debug, Default)]
pub(super) struct Prototypes {
    /// By type, fields and registers. Looked up only, never iterated.
    by_key: HashMap<Box<[u64]>, usize>,
    list: Vec<Prototype>,
    /// By type.
    sharing: Vec<Sharing>,
    /// Room for a key.
    key: Vec<u64>,
}

/// A body drawn in a frame of its own.
#[derive(Debug)]
enum Prototype {
    Small(Vec<PlacedShape>),
    Large(GroupId),
}

/// How well sharing works for a type.
#[derive(Clone, Copy, Debug, Default)]
struct Sharing {
    is_over: bool,
    /// Whether such bodies take their look from outside, so that the look belongs to the key.
    wears_given_look: bool,
    drawn: u32,
    placed: u32,
}

impl Prototypes {
    fn sharing(&mut self, ty: TypeId) -> &mut Sharing {
        let place = usize::from(ty.0);
        if self.sharing.len() <= place {
            self.sharing.resize(place + 1, Sharing::default());
        }
        &mut self.sharing[place]
    }
}

impl<S: Source> Painter<'_, S> {
    /// Draws the body of a node, whose children would start from `state`.
    pub(super) fn draw_body(
        &mut self,
        node: NodeId,
        body: Body,
        state: &TurtleState,
        place: Place,
    ) -> Result<(), Failure> {
        if place.depth >= self.limits.body_depth {
            let (name, span) = (self.name(node, place), self.span(node, place));
            return Err(failure::too_deep(&name, self.limits.body_depth, span));
        }
        let owner = Some(self.organ(node, place));
        let inside = Place {
            owner,
            depth: place.depth + 1,
        };
        let ty = self.source.graph().type_of(node).unwrap_or(TypeId(0));
        if body.is_pure && !self.prototypes.sharing(ty).is_over && self.find_key(node, ty, state) {
            return self.draw_shared(node, ty, state, inside);
        }
        let made = self.run_body(node)?;
        let drawn = self.draw_made(&made, state, inside);
        self.source.release(made);
        drawn
    }

    /// Places the prototype under the key just found, drawing it first if need be.
    fn draw_shared(
        &mut self,
        node: NodeId,
        ty: TypeId,
        state: &TurtleState,
        inside: Place,
    ) -> Result<(), Failure> {
        if let Some(known) = self.prototypes.by_key.get(&*self.prototypes.key).copied() {
            let sharing = self.prototypes.sharing(ty);
            sharing.placed += 1;
            if sharing.wears_given_look {
                self.canvas.note_look(state.look);
            }
            return self.place_prototype(known, node, state, inside);
        }
        let made = self.run_body(node)?;
        let fresh = Canvas::beginning_with(state.look);
        let outer = std::mem::replace(&mut self.canvas, fresh);
        let mut drawn = self.draw_made(&made, &state.at_origin(), inside);
        let canvas = std::mem::replace(&mut self.canvas, outer);
        if canvas.wears_given_look {
            self.prototypes.sharing(ty).wears_given_look = true;
            self.canvas.note_look(state.look);
        }
        if canvas.is_bound && drawn.is_ok() {
            // It looks different wherever it stands: draw it here, and the others of its type where they are.
            self.prototypes.sharing(ty).is_over = true;
            drawn = self.draw_made(&made, state, inside);
            self.source.release(made);
            return drawn;
        }
        self.source.release(made);
        drawn?;
        // Drawing may have asked for other keys, and now the look may belong to this one.
        self.find_key(node, ty, state);
        let key: Box<[u64]> = self.prototypes.key.as_slice().into();
        let known = self.keep_prototype(canvas, key, ty);
        self.place_prototype(known, node, state, inside)
    }

    fn keep_prototype(&mut self, canvas: Canvas, key: Box<[u64]>, ty: TypeId) -> usize {
        let sharing = self.prototypes.sharing(ty);
        sharing.drawn += 1;
        sharing.is_over = sharing.drawn >= TRIAL && sharing.placed < sharing.drawn;
        let group = &canvas.group;
        let is_small = group.shapes.len() <= COPIED
            && group.instances.is_empty()
            && canvas.about.lights.is_empty()
            && canvas.about.sensors.is_empty();
        let prototype = if is_small {
            Prototype::Small(canvas.group.shapes)
        } else {
            Prototype::Large(self.add_group(canvas))
        };
        let number = self.prototypes.list.len();
        self.prototypes.list.push(prototype);
        self.prototypes.by_key.insert(key, number);
        number
    }

    fn place_prototype(
        &mut self,
        number: usize,
        node: NodeId,
        state: &TurtleState,
        inside: Place,
    ) -> Result<(), Failure> {
        let n_shapes = match &self.prototypes.list[number] {
            Prototype::Large(group) => {
                return self.push_instance(*group, state.transform, node, inside);
            }
            Prototype::Small(shapes) => shapes.len(),
        };
        for i in 0..n_shapes {
            let Prototype::Small(shapes) = &self.prototypes.list[number] else {
                return Ok(());
            };
            let mut shape = shapes[i].clone();
            shape.to_group = state.transform * shape.to_group;
            shape.organ = self.organ(node, inside);
            if !shape.to_group.is_finite() {
                return Err(self.not_finite(node, inside));
            }
            if self.has_extent(node, &shape.to_group) {
                self.push_shape(shape, node, inside)?;
            }
        }
        Ok(())
    }

    /// Writes all that a pure body can depend on into the key; `false` if that is not known (objects in fields).
    fn find_key(&mut self, node: NodeId, ty: TypeId, state: &TurtleState) -> bool {
        let graph = self.source.graph();
        let key = &mut self.prototypes.key;
        key.clear();
        key.push(u64::from(ty.0));
        for (number, field) in (0u16..).zip(&graph.types()[ty].fields) {
            let id = crate::graph::FieldId(number);
            let bits = match field.kind {
                FieldKind::Object => match graph.peek_object(node, id) {
                    Ok(None) => continue,
                    _ => return false,
                },
                FieldKind::Float | FieldKind::Double => {
                    graph.get_f64(node, id).unwrap_or(0.0).to_bits()
                }
                FieldKind::Boolean
                | FieldKind::Byte
                | FieldKind::Short
                | FieldKind::Char
                | FieldKind::Int
                | FieldKind::Long => graph.get_i64(node, id).unwrap_or(0).cast_unsigned(),
            };
            key.push(bits);
        }
        key.extend(state.registers.key().map(u64::from));
        if self.prototypes.sharing(ty).wears_given_look {
            let look = self.look_number(state.look);
            self.prototypes.key.push(look);
        }
        true
    }

    fn run_body(&mut self, node: NodeId) -> Result<Instantiated, Failure> {
        self.source.instantiate(node)
    }

    /// Draws what a body made; each of its parts begins from `start`.
    fn draw_made(
        &mut self,
        made: &Instantiated,
        start: &TurtleState,
        place: Place,
    ) -> Result<(), Failure> {
        made.heads.iter().try_for_each(|&(head, is_branch)| {
            let mut state = *start;
            if is_branch {
                state.enter_branch();
            }
            if self.draw_node(head, &mut state, place)? {
                self.draw_below(head, state, place)
            } else {
                Ok(())
            }
        })
    }
}
