//! Small scenes for tests, by the builder of the validation.

#![allow(unused_imports, reason = "each test binary uses a part of it")]

use glam::{DAffine3, DVec3};
use understory::color::Rgb;
use understory::geometry::Shape;
use understory::light::Environment;
use understory::light::Light;
use understory::material::Material;
use understory::math::angle::Angle;
use understory::scene::Scene;
use understory::scene::description::Extras;
use understory::validation::room;
pub(crate) use understory::validation::room::{at, even_sky, gray, square};

/// A scene under construction, of what cannot be refused.
#[derive(Default)]
pub(crate) struct Room(room::Room);

impl Room {
    pub(crate) fn with(self, shape: Shape, to_world: DAffine3, material: Material) -> Self {
        Self(self.0.with(shape, to_world, material))
    }

    pub(crate) fn lit_by(self, light: Light) -> Self {
        Self(self.0.lit_by(light))
    }

    pub(crate) fn under(self, environment: Environment) -> Self {
        Self(self.0.under(environment))
    }

    #[allow(dead_code, reason = "one benchmark uses it")]
    pub(crate) fn with_extras(self, extras: Extras) -> Self {
        Self(self.0.with_extras(extras))
    }

    pub(crate) fn build(self) -> Scene {
        self.0.scene().unwrap()
    }
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
