//! `SensorNode`: discs that measure the light that passes them, and change nothing about it.

use super::appearance::Purpose;
use super::failure::Failure;
use super::shapes::FIELDS;
use super::source::Source;
use super::walk::{Painter, Place};
use crate::color::Rgb;
use crate::graph::NodeId;
use crate::scene::description::OrganId;
use crate::turtle::TurtleState;
use glam::DAffine3;

/// A disc in the plane of x and y of its frame, round the origin, that measures light.
#[derive(Clone, Debug, PartialEq)]
pub struct Sensor {
    /// The organ it is.
    pub organ: OrganId,
    /// Its radius in its own frame, greater than 0.
    pub radius: f64,
    /// From its frame to the world. Its front looks along its +z.
    pub to_world: DAffine3,
    /// Whether light that arrives on the back counts too.
    pub is_two_sided: bool,
    /// Light that arrives under the cosine c to the axis counts c^(exponent - 1) times: with 1, the default, the reading is
    /// the irradiance on the disc.
    pub exponent: f64,
    /// What part of each band it counts.
    pub color: Rgb,
}

impl<S: Source> Painter<'_, S> {
    /// Notes the sensor of a node, if it is drawn for a light model.
    pub(super) fn draw_sensor(
        &mut self,
        node: NodeId,
        state: &TurtleState,
        place: Place,
    ) -> Result<(), Failure> {
        if self.limits.purpose != Purpose::LightModel {
            return Ok(());
        }
        let graph = self.source.graph();
        let [radius, exponent] = FIELDS
            .sensor
            .map(|field| graph.get_f64(node, field).unwrap_or(0.0));
        let is_two_sided = graph
            .get_bool(node, FIELDS.sensor_two_sided)
            .unwrap_or(false);
        let surface = self.surface_of(node, place)?;
        let color = surface.map_or(Rgb::WHITE, |surface| surface.mean_sides()[0].reflectance);
        if !state.transform.is_finite() || !radius.is_finite() || !exponent.is_finite() {
            return Err(self.not_finite(node, place));
        }
        if radius == 0.0 || !self.has_extent(node, &state.transform) {
            return Ok(());
        }
        self.charge(size_of::<Sensor>(), node, place)?;
        let organ = self.organ(node, place);
        self.canvas.about.sensors.push(Sensor {
            organ,
            radius: radius.abs(),
            to_world: state.transform,
            is_two_sided,
            exponent,
            color,
        });
        Ok(())
    }
}
