//! Building small scenes for tests.

use glam::{DAffine3, DVec3};
use understory::color::Rgb;
use understory::geometry::Shape;
use understory::light::{Environment, Light};
use understory::material::Material;
use understory::math::angle::Angle;
use understory::scene::Scene;
use understory::scene::description::{
    Group, GroupId, MaterialId, OrganId, PlacedShape, SceneDescription,
};

/// A scene under construction.
#[derive(Default)]
pub(crate) struct Room {
    description: SceneDescription,
    group: Group,
}

impl Room {
    pub(crate) fn with(mut self, shape: Shape, to_world: DAffine3, material: Material) -> Self {
        let number = u32::try_from(self.description.materials.len()).unwrap();
        self.description.materials.push(material);
        self.group.shapes.push(PlacedShape {
            shape,
            to_group: to_world,
            material: MaterialId(number),
            organ: OrganId(0),
        });
        self
    }

    pub(crate) fn lit_by(mut self, light: Light) -> Self {
        self.description.lights.push(light);
        self
    }

    pub(crate) fn under(mut self, environment: Environment) -> Self {
        self.description.environment = environment;
        self
    }

    pub(crate) fn build(mut self) -> Scene {
        self.description.groups.push(self.group);
        self.description.root = Some(GroupId(0));
        Scene::build(self.description).unwrap()
    }
}

pub(crate) fn at(x: f64, y: f64, z: f64) -> DAffine3 {
    DAffine3::from_translation(DVec3::new(x, y, z))
}

/// A horizontal square round the origin that looks up.
pub(crate) fn square(half: f64) -> Shape {
    let edge = 2.0 * half;
    Shape::Parallelogram {
        corner: DVec3::new(-half, -half, 0.0),
        edge_u: DVec3::X * edge,
        edge_v: DVec3::Y * edge,
    }
}

pub(crate) fn gray(value: f64) -> Rgb {
    Rgb::splat(value)
}

/// A sphere lamp and a bright sky over ground with a ball that shades it, without the sun (which no scattered ray finds).
pub(crate) fn shaded_ground() -> Scene {
    let day = Environment::daylight(Angle::deg(0.0), Angle::deg(30.0), 4.0, gray(0.3));
    let lamp = Material::lambert(gray(0.2)).emitting(gray(80.0), Rgb::BLACK);
    Room::default()
        .with(Shape::Plane, at(0., 0., 0.), Material::lambert(gray(0.5)))
        .with(
            Shape::Sphere { radius: 0.6 },
            at(0.0, 0.0, 0.6),
            Material::lambert(gray(0.7)),
        )
        .with(Shape::Sphere { radius: 0.4 }, at(1.4, 0.0, 1.0), lamp)
        .with(
            square(0.5),
            at(-1.0, 0.3, 0.4),
            Material::leaf(gray(0.3), gray(0.4)),
        )
        .under(Environment { sun: None, ..day })
        .build()
}
