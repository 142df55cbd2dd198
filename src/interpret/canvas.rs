//! What has been drawn so far, of the world or of a group.

use super::lamps::placed;
use super::sensors::Sensor;
use super::shapes::bounds;
use crate::light::Light;
use crate::math::Bounds3;
use crate::scene::description::{Group, GroupId, Instance, OrganId, PlacedShape};
use crate::turtle::Look;
use glam::DAffine3;

/// A group while it is drawn.
#[derive(Debug)]
pub(super) struct Canvas {
    /// Its shapes and instances.
    pub(super) group: Group,
    /// What else is known of it.
    pub(super) about: About,
    /// Whether something in it depends on where and how it is placed, so that it cannot be drawn again elsewhere.
    pub(super) is_bound: bool,
    /// How the turtle looked where this began.
    pub(super) given_look: Look,
    /// Whether something in it may look so, so that it looks otherwise where the turtle does.
    pub(super) wears_given_look: bool,
}

/// What is known of a group without looking at its shapes.
#[derive(Clone, Debug)]
pub(super) struct About {
    /// Bounds of all that is finite, in the group's frame.
    pub(super) bounds: Bounds3,
    /// Whether there is an endless plane.
    pub(super) has_plane: bool,
    /// Whether a surface shines.
    pub(super) shines: bool,
    /// Sources without a surface, in the group's frame.
    pub(super) lights: Vec<Light>,
    /// Sensors, in the group's frame.
    pub(super) sensors: Vec<Sensor>,
}

impl About {
    /// Bytes that every placement of the group takes for itself.
    pub(super) fn own_bytes(&self) -> usize {
        size_of_val(&*self.lights) + size_of_val(&*self.sensors)
    }
}

impl Default for Canvas {
    fn default() -> Self {
        Self {
            group: Group::default(),
            about: About {
                bounds: Bounds3::EMPTY,
                has_plane: false,
                shines: false,
                lights: Vec::new(),
                sensors: Vec::new(),
            },
            is_bound: false,
            given_look: Look::Grey,
            wears_given_look: false,
        }
    }
}

impl Canvas {
    /// Whether nothing was drawn.
    pub(super) fn is_empty(&self) -> bool {
        self.group.shapes.is_empty()
            && self.group.instances.is_empty()
            && self.about.lights.is_empty()
            && self.about.sensors.is_empty()
    }

    /// An empty one for what begins where the turtle looks so.
    pub(super) fn beginning_with(given_look: Look) -> Self {
        Self {
            given_look,
            ..Self::default()
        }
    }

    /// Notes that something was drawn that has no look of its own.
    pub(super) fn note_look(&mut self, look: Look) {
        self.wears_given_look |= look == self.given_look;
    }

    /// Adds a shape.
    pub(super) fn push_shape(&mut self, shape: PlacedShape, shines: bool) {
        let about = &mut self.about;
        about.bounds = about.bounds.union(&bounds(&shape.shape, &shape.to_group));
        about.has_plane |= matches!(shape.shape, crate::geometry::Shape::Plane);
        about.shines |= shines;
        self.group.shapes.push(shape);
    }

    /// Adds a group that stands elsewhere already.
    pub(super) fn push_instance(
        &mut self,
        group: GroupId,
        of: &About,
        to_group: DAffine3,
        organ: OrganId,
    ) {
        let about = &mut self.about;
        about.bounds = about.bounds.union(&of.bounds.transformed(&to_group));
        about.has_plane |= of.has_plane;
        about.shines |= of.shines;
        let lights = of.lights.iter().map(|light| placed(light, &to_group));
        about.lights.extend(lights);
        let sensors = of.sensors.iter().map(|sensor| Sensor {
            organ: if organ.is_own() { organ } else { sensor.organ },
            to_world: to_group * sensor.to_world,
            ..sensor.clone()
        });
        about.sensors.extend(sensors);
        self.group.instances.push(Instance {
            group,
            to_group,
            organ,
        });
    }
}
