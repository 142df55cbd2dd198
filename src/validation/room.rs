//! Building small scenes.

use crate::color::Rgb;
use crate::geometry::Shape;
use crate::light::{Environment, Light, Sky};
use crate::material::Material;
use crate::scene::description::{
    Extras, Group, GroupId, MaterialId, OrganId, PlacedShape, SceneDescription,
};
use crate::scene::{Scene, SceneError};
use glam::{DAffine3, DVec3};

/// A scene under construction, of one group.
#[derive(Debug, Default)]
pub struct Room {
    description: SceneDescription,
    group: Group,
}

impl Room {
    /// With this shape in it, of a material of its own.
    #[must_use]
    pub fn with(mut self, shape: Shape, to_world: DAffine3, material: Material) -> Self {
        let number = self.description.materials.len();
        self.description.materials.push(material);
        self.group.shapes.push(PlacedShape {
            shape,
            to_group: to_world,
            // More materials than numbers do not fit into memory.
            material: MaterialId(u32::try_from(number).unwrap_or(u32::MAX)),
            organ: OrganId(0),
        });
        self
    }

    /// Lit by this lamp too.
    #[must_use]
    pub fn lit_by(mut self, light: Light) -> Self {
        self.description.lights.push(light);
        self
    }

    /// Under this sky and sun.
    #[must_use]
    pub fn under(mut self, environment: Environment) -> Self {
        self.description.environment = environment;
        self
    }

    /// With what light does not require.
    #[must_use]
    pub fn with_extras(mut self, extras: Extras) -> Self {
        self.description.extras = extras;
        self
    }

    /// The scene.
    ///
    /// # Errors
    /// The first thing that cannot be part of one.
    pub fn scene(mut self) -> Result<Scene, SceneError> {
        self.description.groups.push(self.group);
        self.description.root = Some(GroupId(0));
        Scene::build(self.description)
    }
}

/// A place.
#[must_use]
pub fn at(x: f64, y: f64, z: f64) -> DAffine3 {
    DAffine3::from_translation(DVec3::new(x, y, z))
}

/// A horizontal square round the origin that looks up, `half` metres to each side.
#[must_use]
pub fn square(half: f64) -> Shape {
    let edge = 2.0 * half;
    Shape::Parallelogram {
        corner: DVec3::new(-half, -half, 0.0),
        edge_u: DVec3::X * edge,
        edge_v: DVec3::Y * edge,
    }
}

/// The same in all channels.
#[must_use]
pub fn gray(value: f64) -> Rgb {
    Rgb::splat(value)
}

/// A surface that reflects nothing and shines with radiance 1 in front; behind so brightly that nobody could miss it.
#[must_use]
pub fn glow() -> Material {
    Material::lambert(Rgb::BLACK).emitting(gray(1.0), gray(99.0))
}

/// The same radiance from everywhere.
#[must_use]
pub fn even_sky(radiance: f64) -> Environment {
    Environment {
        sky: Sky::Uniform(gray(radiance)),
        sun: None,
    }
}
