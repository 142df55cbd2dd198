//! How what a node draws looks: shader, colour, lamp.

use super::appearance::{Appearance, Lamp, LampKind};
use super::failure::Failure;
use super::lamps::{Shining, emission, is_possible, shine};
use super::shapes::{FIELDS, parallelogram_area};
use super::source::Source;
use super::walk::{Painter, Place};
use crate::color::Rgb;
use crate::geometry::Shape;
use crate::graph::NodeId;
use crate::material::Material;
use crate::scene::description::MaterialId;
use crate::turtle::effect::{Effect, Primitive};
use crate::turtle::reading::shoot_color;
use crate::turtle::{Look, TurtleState};
use glam::DAffine3;

const IMPOSSIBLE_LAMP: &str =
    "has a lamp whose power or colour is negative or no number; it does not shine";

impl<S: Source> Painter<'_, S> {
    /// The material a node's shape is drawn with: that of the shader or colour the turtle wears, else grey.
    pub(super) fn material_of(
        &mut self,
        node: NodeId,
        does: Effect,
        state: &TurtleState,
        (shape, to_group): (&Shape, &DAffine3),
        place: Place,
    ) -> Result<MaterialId, Failure> {
        let graph = self.source.graph();
        let (dressed, index) = match state.look {
            Look::Of(dressed) => (Some(dressed), shoot_color(graph, node, state)),
            Look::Ega(index) => (None, Some(index)),
            Look::Grey => (None, None),
        };
        let lamp = match does {
            Effect::Draw(Primitive::Parallelogram) => {
                let light = graph.peek_object(node, FIELDS.area_light).ok().flatten();
                light.and_then(Appearance::lamp)
            }
            _ => None,
        };
        if let Some(lamp) = lamp {
            let surface = self.surface_of(dressed.unwrap_or(node), place)?;
            return Ok(self.shining_material(node, &lamp, surface, shape, to_group));
        }
        let dressed = match dressed {
            Some(dressed) => self.shader_material(dressed, place)?,
            None => None,
        };
        Ok(match (dressed, index) {
            (Some(material), _) => material,
            (None, Some(index)) => self.materials.ega(index),
            (None, None) => self.materials.grey(),
        })
    }

    /// The surface of the shader that a node has of its own, if it has one.
    pub(super) fn surface_of(
        &mut self,
        node: NodeId,
        place: Place,
    ) -> Result<Option<Material>, Failure> {
        let purpose = self.limits.purpose;
        self.with_pictures(node, place, |source, pictures| {
            let shader = source.graph().peek_object(node, FIELDS.shader);
            shader.ok().flatten()?.surface(purpose, pictures)
        })
    }

    /// The material of the shader that a node has of its own, if it has one.
    pub(super) fn shader_material(
        &mut self,
        node: NodeId,
        place: Place,
    ) -> Result<Option<MaterialId>, Failure> {
        let Some(surface) = self.surface_of(node, place)? else {
            return Ok(None);
        };
        let (material, problem) = self.materials.of(surface);
        if let Some(problem) = problem {
            self.warn(node, "impossible-shader", &format!("has {problem}"));
        }
        Ok(Some(material))
    }

    /// The material of what has no look of its own where the turtle looks so.
    pub(super) fn look_material(
        &mut self,
        look: Look,
        place: Place,
    ) -> Result<MaterialId, Failure> {
        let material = match look {
            Look::Grey => None,
            Look::Ega(index) => Some(self.materials.ega(index)),
            Look::Of(node) => self.shader_material(node, place)?,
        };
        Ok(material.unwrap_or_else(|| self.materials.grey()))
    }

    /// A number that is equal for looks that give the same material.
    pub(super) fn look_number(&mut self, look: Look) -> u64 {
        // What is wrong with a look is told where something is drawn with it.
        let material = self.look_material(look, Place::default());
        u64::from(material.unwrap_or_else(|_| self.materials.grey()).0)
    }

    /// The material of a parallelogram with a lamp of its own. A lamp without a shader shines white.
    fn shining_material(
        &mut self,
        node: NodeId,
        lamp: &Lamp,
        surface: Option<Material>,
        shape: &Shape,
        to_group: &DAffine3,
    ) -> MaterialId {
        self.canvas.is_bound = true;
        match lamp.kind {
            LampKind::Area { exponent } if exponent != 1.0 => self.warn(
                node,
                "area-light-exponent",
                "has an area light with an exponent other than 1; it shines like a matt surface",
            ),
            LampKind::Area { .. } => {}
            _ => self.warn(
                node,
                "area-light-kind",
                "carries a lamp that is no `AreaLight`; it shines like one",
            ),
        }
        let filter = surface.as_ref();
        let filter = filter.map_or(Rgb::WHITE, |surface| surface.mean_sides()[0].reflectance);
        let surface = surface.unwrap_or_default();
        let radiance = if is_possible(lamp) {
            emission(
                lamp,
                filter,
                surface.alpha,
                parallelogram_area(shape, to_group),
            )
        } else {
            self.warn(node, "impossible-lamp", IMPOSSIBLE_LAMP);
            Rgb::BLACK
        };
        let (material, problem) = self.materials.of(surface.emitting(radiance, Rgb::BLACK));
        if let Some(problem) = problem {
            self.warn(node, "impossible-shader", &format!("has {problem}"));
        }
        material
    }

    /// Adds the source that a light node carries.
    pub(super) fn draw_light_node(
        &mut self,
        node: NodeId,
        state: &TurtleState,
    ) -> Result<(), Failure> {
        let graph = self.source.graph();
        let light = graph.peek_object(node, FIELDS.light).ok().flatten();
        let Some(lamp) = light.and_then(Appearance::lamp) else {
            return Ok(());
        };
        self.draw_lamp(node, &lamp, state)
    }

    /// Adds the light of a sky of its own power and of the colour of its own shader.
    pub(super) fn draw_sky(
        &mut self,
        node: NodeId,
        state: &TurtleState,
        place: Place,
    ) -> Result<(), Failure> {
        let surface = self.surface_of(node, place)?;
        let color = surface.map(|surface| surface.mean_sides()[0].reflectance);
        let graph = self.source.graph();
        let lamp = Lamp {
            kind: LampKind::Sky,
            color: color.map_or([1.0; 3], Rgb::to_array),
            power: graph.get_f64(node, FIELDS.sky_power).unwrap_or(0.0),
        };
        self.draw_lamp(node, &lamp, state)
    }

    fn draw_lamp(&mut self, node: NodeId, lamp: &Lamp, state: &TurtleState) -> Result<(), Failure> {
        if !is_possible(lamp) {
            self.warn(node, "impossible-lamp", IMPOSSIBLE_LAMP);
            return Ok(());
        }
        if !state.transform.is_finite() {
            let place = Place::default();
            return Err(self.not_finite(node, place));
        }
        match shine(lamp, state) {
            Shining::Dark => {}
            Shining::Source(light) => self.canvas.about.lights.push(light),
            Shining::Sky(radiance) => {
                self.canvas.is_bound = true;
                self.sky += radiance;
            }
            Shining::NoSurface => self.warn(
                node,
                "area-light-without-area",
                "carries an `AreaLight`, which needs a `Parallelogram` to shine from",
            ),
        }
        Ok(())
    }
}
