//! The turtle's way through the graph.

use super::body::Prototypes;
use super::canvas::{About, Canvas};
use super::curved::CurvedShapes;
use super::failure::{self, Failure};
use super::images::Images;
use super::instance::Instances;
use super::materials::Materials;
use super::meshes::MeshFiles;
use super::organs::Organs;
use super::shapes::{FIELDS, is_finite, shape_of};
use super::source::{Body, Source};
use super::{Interpretation, Limits, Summary};
use crate::color::Rgb;
use crate::diag::Diagnostics;
use crate::graph::{EdgeBits, NodeId, TypeId};
use crate::light::{Environment, Sky};
use crate::scene::description::{Group, GroupId, Instance, OrganId, PlacedShape, SceneDescription};
use crate::turtle::effect::{Effect, Primitive};
use crate::turtle::pose::{apply_own_transform, follow};
use crate::turtle::reading::{action, dress, effect, is_transforming};
use crate::turtle::{Poses, TurtleState};
use glam::{DAffine3, DVec3};
use std::collections::BTreeSet;

/// Nodes between two looks at whether the drawing shall stop.
const CHECK_EVERY: u64 = 1 << 12;

/// Where in the model the turtle draws.
#[derive(Clone, Copy, Debug, Default)]
pub(super) struct Place {
    /// The organ all belongs to, inside bodies.
    pub(super) owner: Option<OrganId>,
    /// How many bodies stand round it.
    pub(super) depth: usize,
}

/// What is still to be drawn of a walk.
#[derive(Debug, Default)]
struct Way {
    /// Children of open forks, the next one of the innermost fork last.
    pending: Vec<(NodeId, EdgeBits)>,
    /// Open forks: where their children begin in `pending`, and the state they start from.
    forks: Vec<(usize, TurtleState)>,
}

/// Draws a model.
pub(super) struct Painter<'s, S: Source> {
    pub(super) source: &'s mut S,
    pub(super) limits: Limits,
    pub(super) canvas: Canvas,
    pub(super) groups: Vec<Group>,
    /// What is known of each of `groups`.
    pub(super) about: Vec<About>,
    pub(super) poses: Poses,
    pub(super) prototypes: Prototypes,
    pub(super) instances: Instances,
    pub(super) mesh_files: MeshFiles,
    pub(super) images: Images,
    pub(super) curved: CurvedShapes,
    n_nodes: u64,
    body_nodes: u64,
    /// Emptied, to be used again.
    spare_ways: Vec<Way>,
    bodies: Vec<Option<Body>>,
    pub(super) materials: Materials,
    pub(super) sky: Rgb,
    pub(super) organs: Organs,
    memory: u64,
    pub(super) warnings: Diagnostics,
    /// Warnings given already, by slug and type.
    pub(super) warned: BTreeSet<(&'static str, TypeId)>,
}

impl<'s, S: Source> Painter<'s, S> {
    pub(super) fn new(source: &'s mut S, limits: Limits) -> Self {
        let types = source.graph().types().clone();
        let bodies = types.iter().map(|(ty, _)| source.body(ty)).collect();
        let spans = types.iter().map(|(ty, _)| source.declared_at(ty)).collect();
        let made = types.iter().map(|(ty, _)| source.made_at(ty).to_vec());
        let made = made.collect();
        Self {
            source,
            limits,
            canvas: Canvas::default(),
            groups: Vec::new(),
            about: Vec::new(),
            poses: Poses::default(),
            prototypes: Prototypes::default(),
            instances: Instances::default(),
            mesh_files: MeshFiles::default(),
            images: Images::default(),
            curved: CurvedShapes::default(),
            n_nodes: 0,
            body_nodes: 0,
            spare_ways: Vec::new(),
            bodies,
            materials: Materials::default(),
            organs: Organs::new(types, spans, made),
            memory: 0,
            sky: Rgb::BLACK,
            warnings: Diagnostics::default(),
            warned: BTreeSet::new(),
        }
    }

    /// Draws all that hangs on the root.
    pub(super) fn draw_world(&mut self) -> Result<(), Failure> {
        let root = self.source.graph().root();
        self.draw_below(root, TurtleState::default(), Place::default())
    }

    pub(super) fn finish(mut self) -> Interpretation {
        let canvas = std::mem::take(&mut self.canvas);
        let (lights, sensors) = (canvas.about.lights.clone(), canvas.about.sensors.clone());
        let summary = Summary {
            has_light: canvas.about.shines || !lights.is_empty() || !self.sky.is_black(),
            has_plane: canvas.about.has_plane,
            bounds: canvas.about.bounds,
        };
        let root = self.add_group(canvas);
        let environment = Environment {
            sky: if self.sky.is_black() {
                Sky::None
            } else {
                Sky::Uniform(self.sky)
            },
            sun: None,
        };
        Interpretation {
            scene: SceneDescription {
                materials: self.materials.into_list(),
                groups: self.groups,
                root: Some(root),
                lights,
                environment,
                ..SceneDescription::default()
            },
            organs: self.organs,
            summary,
            sensors,
            warnings: self.warnings,
        }
    }

    pub(super) fn add_group(&mut self, canvas: Canvas) -> GroupId {
        let id = GroupId(u32::try_from(self.groups.len()).unwrap_or(u32::MAX));
        self.groups.push(canvas.group);
        self.about.push(canvas.about);
        id
    }

    /// Draws all that hangs on a node, whose children start from `state`. Chains of any length: only forks are remembered.
    pub(super) fn draw_below(
        &mut self,
        start: NodeId,
        state: TurtleState,
        place: Place,
    ) -> Result<(), Failure> {
        let mut way = self.spare_ways.pop().unwrap_or_default();
        let drawn = self.follow_ways(start, state, place, &mut way);
        way.pending.clear();
        way.forks.clear();
        self.spare_ways.push(way);
        drawn
    }

    fn follow_ways(
        &mut self,
        start: NodeId,
        state: TurtleState,
        place: Place,
        way: &mut Way,
    ) -> Result<(), Failure> {
        let Way { pending, forks } = way;
        let (mut node, mut state) = (start, state);
        let mut goes_on = true;
        loop {
            let floor = pending.len();
            if goes_on {
                self.push_children(node, pending);
            }
            let n_children = pending.len() - floor;
            if n_children > 1 {
                forks.push((floor, state));
            }
            let Some((child, bits)) = pending.pop() else {
                return Ok(());
            };
            // An only child goes on from where its parent ended, all others from their fork.
            if n_children != 1
                && let Some(&(floor, at_fork)) = forks.last()
            {
                state = at_fork;
                if pending.len() == floor {
                    forks.pop();
                }
            }
            follow(&mut state, bits);
            goes_on = self.draw_node(child, &mut state, place)?;
            node = child;
        }
    }

    /// Appends the nodes that inherit a node's frame, the first one last.
    fn push_children(&self, node: NodeId, pending: &mut Vec<(NodeId, EdgeBits)>) {
        let graph = self.source.graph();
        let carries = EdgeBits::SUCCESSOR.union(EdgeBits::BRANCH);
        let floor = pending.len();
        pending.extend(graph.out_edges(node).filter(|(child, bits)| {
            let inherits = || {
                graph
                    .predecessor(*child)
                    .is_some_and(|(from, _)| from == node)
            };
            bits.intersects(carries) && inherits()
        }));
        pending[floor..].reverse();
    }

    /// Draws one node and turns `state` into the one its children start from. Whether they are still to be drawn.
    pub(super) fn draw_node(
        &mut self,
        node: NodeId,
        state: &mut TurtleState,
        place: Place,
    ) -> Result<bool, Failure> {
        self.n_nodes += 1;
        if self.n_nodes.is_multiple_of(CHECK_EVERY) && self.source.is_stopped() {
            return Err(failure::stopped());
        }
        if place.depth > 0 {
            self.count_body_node(node, place)?;
        }
        let graph = self.source.graph();
        let does = effect(graph, node);
        let before = state.transform;
        apply_own_transform(graph, node, state);
        let has_own_look = dress(graph, node, state);
        self.canvas.is_bound |= depends_on_world(does);
        if self.is_shown(node) {
            self.draw_own(node, does, state, has_own_look, place)?;
        }
        let graph = self.source.graph();
        let poses = &mut self.poses;
        let moves = action(graph, node, &mut |to| poses.location(graph, to).ok());
        state.execute(&moves);
        if !is_transforming(graph, node) {
            state.transform = before;
        }
        let body = self.body_of(node);
        if does == Effect::Grid {
            self.draw_grid(node, body, state, place)?;
            return Ok(false);
        }
        if let Some(body) = body {
            self.draw_body(node, body, state, place)?;
        }
        Ok(true)
    }

    /// Whether a node is in no hidden layer.
    fn is_shown(&self, node: NodeId) -> bool {
        let hidden = self.limits.hidden;
        let layer = || self.source.graph().get_i32(node, FIELDS.layer).unwrap_or(0);
        hidden.is_empty() || !hidden.contains(layer())
    }

    /// Draws what a node itself is, without what follows it and without its body.
    fn draw_own(
        &mut self,
        node: NodeId,
        does: Effect,
        state: &TurtleState,
        has_own_look: bool,
        place: Place,
    ) -> Result<(), Failure> {
        match does {
            Effect::Draw(Primitive::Light) => self.draw_light_node(node, state),
            Effect::Draw(Primitive::Sky) => self.draw_sky(node, state, place),
            Effect::Draw(Primitive::Sensor) => self.draw_sensor(node, state, place),
            Effect::Draw(Primitive::Mesh) => self.draw_mesh(node, state, place),
            Effect::Draw(
                primitive @ (Primitive::Surface | Primitive::Sweep | Primitive::Polygons),
            ) => {
                if !has_own_look {
                    self.canvas.note_look(state.look);
                }
                self.draw_curved(node, primitive, state, place)
            }
            Effect::Step { is_shoot: true, .. } | Effect::Draw(_) => {
                if !has_own_look {
                    self.canvas.note_look(state.look);
                }
                self.draw_shape(node, does, state, place)
            }
            Effect::Instance => self.draw_instance(node, state, place),
            _ => Ok(()),
        }
    }

    fn count_body_node(&mut self, node: NodeId, place: Place) -> Result<(), Failure> {
        self.body_nodes += 1;
        if self.body_nodes <= self.limits.body_nodes {
            return Ok(());
        }
        let (name, span) = (self.name(node, place), self.span(node, place));
        let limit = self.limits.body_nodes;
        Err(failure::too_many_body_nodes(&name, limit, span))
    }

    fn body_of(&self, node: NodeId) -> Option<Body> {
        let ty = self.source.graph().type_of(node).ok()?;
        self.bodies.get(usize::from(ty.0)).copied().flatten()
    }

    fn draw_shape(
        &mut self,
        node: NodeId,
        does: Effect,
        state: &TurtleState,
        place: Place,
    ) -> Result<(), Failure> {
        let Some((shape, shift)) = shape_of(self.source.graph(), node, does, state) else {
            return Ok(());
        };
        let mut to_group = state.transform;
        to_group.translation += to_group.matrix3.z_axis * shift;
        if !is_finite(&shape) || !to_group.is_finite() {
            return Err(self.not_finite(node, place));
        }
        if !self.has_extent(node, &to_group) {
            return Ok(());
        }
        let material = self.material_of(node, does, state, (&shape, &to_group), place)?;
        let organ = self.organ(node, place);
        let placed = PlacedShape {
            shape,
            to_group,
            material,
            organ,
        };
        self.push_shape(placed, node, place)
    }

    /// Adds a shape, if there is room.
    pub(super) fn push_shape(
        &mut self,
        shape: PlacedShape,
        node: NodeId,
        place: Place,
    ) -> Result<(), Failure> {
        self.charge(size_of::<PlacedShape>(), node, place)?;
        let shines = self.materials.shines(shape.material);
        self.canvas.push_shape(shape, shines);
        Ok(())
    }

    /// Adds a group that was drawn before, if there is room.
    pub(super) fn push_instance(
        &mut self,
        group: GroupId,
        to_group: DAffine3,
        node: NodeId,
        place: Place,
    ) -> Result<(), Failure> {
        if !to_group.is_finite() {
            return Err(self.not_finite(node, place));
        }
        if !self.has_extent(node, &to_group) {
            return Ok(());
        }
        let organ = self.organ(node, place);
        // Shapes of an instance cost nothing, but its lamps and sensors are placed one by one.
        let own = self.about.get(group.0 as usize).map_or(0, About::own_bytes);
        let bytes = size_of::<Instance>() + own;
        self.charge(bytes, node, place)?;
        if let Some(about) = self.about.get(group.0 as usize) {
            self.canvas.push_instance(group, about, to_group, organ);
        }
        Ok(())
    }

    /// Bytes that may still be taken.
    pub(super) const fn memory_left(&self) -> u64 {
        self.limits.memory.saturating_sub(self.memory)
    }

    pub(super) fn charge(
        &mut self,
        bytes: usize,
        node: NodeId,
        place: Place,
    ) -> Result<(), Failure> {
        self.memory += bytes as u64;
        if self.memory <= self.limits.memory {
            return Ok(());
        }
        let name = self.name(node, place);
        Err(failure::too_much(
            &name,
            self.limits.memory,
            self.span(node, place),
        ))
    }

    /// Whether a placement leaves anything to see. What does not is told.
    pub(super) fn has_extent(&mut self, node: NodeId, placement: &DAffine3) -> bool {
        let m = &placement.matrix3;
        let axes = [m.x_axis, m.y_axis, m.z_axis];
        let n_lost = axes.iter().filter(|axis| **axis == DVec3::ZERO).count();
        if n_lost > 0 && n_lost < 3 {
            self.warn(
                node,
                "flat-scale",
                "is scaled to 0 along one axis; it is not drawn",
            );
        } else if n_lost == 3 {
            self.warn(node, "zero-scale", "is scaled to 0; it is not drawn");
        }
        n_lost == 0
    }

    /// The organ that what a node draws belongs to.
    pub(super) fn organ(&mut self, node: NodeId, place: Place) -> OrganId {
        match place.owner {
            Some(owner) => owner,
            None => {
                let ty = self.source.graph().type_of(node).unwrap_or(TypeId(0));
                self.organs.number(node, ty)
            }
        }
    }
}

/// Whether what a node does depends on how the turtle stands in the world.
const fn depends_on_world(does: Effect) -> bool {
    matches!(
        does,
        Effect::SetInclination
            | Effect::AdjustUp
            | Effect::HeadDown
            | Effect::Gravitropism
            | Effect::RegisterGravitropism
            | Effect::Tropism(_)
    )
}
