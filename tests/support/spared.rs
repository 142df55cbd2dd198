//! Small scenes, none of which requires all that renderers can do.

use super::room::{Room, at, even_sky, gray, square};
use glam::{DAffine3, DVec3};
use std::f64::consts::PI;
use understory::color::Rgb;
use understory::geometry::Shape;
use understory::light::{Environment, Light};
use understory::material::Material;
use understory::math::angle::Angle;
use understory::scene::Scene;

pub(crate) fn matt(reflectance: f64) -> Material {
    Material::lambert(gray(reflectance))
}

/// A box without its front wall, of walls of this material, with a ball on its floor; and something far below, so that patches, whose size
/// goes by that of the scene, are few.
pub(crate) fn open_box(wall: &Material, on_floor: Material) -> Room {
    let turn_x = DAffine3::from_rotation_x(PI / 2.0);
    let turn_y = DAffine3::from_rotation_y(PI / 2.0);
    Room::default()
        .with(square(1.0), at(0.0, 0.0, 0.0), wall.clone())
        .with(square(1.0), at(0.0, 0.0, 2.0), wall.clone())
        .with(square(1.0), at(0.0, 1.0, 1.0) * turn_x, wall.clone())
        .with(square(1.0), at(-1.0, 0.0, 1.0) * turn_y, wall.clone())
        .with(square(1.0), at(1.0, 0.0, 1.0) * turn_y, wall.clone())
        .with(square(0.1), at(0.0, 0.0, -30.0), matt(0.0))
        .with(Shape::Sphere { radius: 0.35 }, at(0.3, 0.2, 0.35), on_floor)
}

fn leafy(room: Room) -> Room {
    let leaf = Material::leaf(gray(0.3), gray(0.4));
    room.with(square(0.3), at(-0.4, 0.0, 0.8), leaf)
}

pub(crate) fn lamp() -> Light {
    Light::point(DVec3::new(0.1, -0.2, 1.7), Rgb::new(20.0, 16.0, 12.0))
}

pub(crate) fn panel(room: Room) -> Room {
    let shine = matt(0.0).emitting(gray(9.0), gray(9.0));
    room.with(square(0.3), at(0.0, 0.0, 1.9), shine)
}

fn day() -> Environment {
    Environment::daylight(Angle::deg(-70.0), Angle::deg(35.0), 3.0, gray(0.2))
}

/// Many round shapes under an even sky.
pub(crate) fn balls() -> Room {
    let gray_box = leafy(open_box(&matt(0.6), matt(0.4)));
    let balls = (0..25).fold(gray_box, |room, k| {
        let (x, y) = (f64::from(k % 5) * 0.35 - 0.7, f64::from(k / 5) * 0.35 - 0.7);
        room.with(Shape::Sphere { radius: 0.15 }, at(x, y, 1.3), matt(0.5))
    });
    balls.under(even_sky(1.0))
}

/// Scenes with what they are called.
pub(crate) fn scenes() -> Vec<(&'static str, Scene)> {
    let gray_box = || leafy(open_box(&matt(0.6), matt(0.4)));
    let absorbing = Material::glass(1.5, 0.0, Rgb::new(0.5, 0.2, 0.9));
    let clear = Material::glass(1.5, 0.0, Rgb::BLACK);
    let mirror = Material::mirror(gray(0.9));
    let cut = matt(0.6).with_alpha(0.5);
    let pane = Material::pane(1.5, Rgb::new(0.9, 0.8, 0.7));
    vec![
        ("balls", balls().build()),
        ("lamp", gray_box().lit_by(lamp()).build()),
        (
            "two lamps",
            gray_box()
                .lit_by(lamp())
                .lit_by(Light::point(DVec3::new(-0.5, -0.8, 1.0), gray(4.0)))
                .build(),
        ),
        ("panel", panel(gray_box()).build()),
        ("sky", gray_box().under(even_sky(1.0)).build()),
        ("day", gray_box().under(day()).build()),
        (
            "day on a plain",
            open_box(&matt(0.5), matt(0.5))
                .with(Shape::Plane, at(0.0, 0.0, -0.1), matt(0.3))
                .under(day())
                .build(),
        ),
        (
            "black",
            open_box(&matt(0.0), matt(0.0)).lit_by(lamp()).build(),
        ),
        ("night", gray_box().build()),
        ("mirror", panel(open_box(&matt(0.6), mirror)).build()),
        ("glass", panel(open_box(&matt(0.6), clear)).build()),
        ("amber", panel(open_box(&matt(0.6), absorbing)).build()),
        (
            "pane",
            leafy(open_box(&matt(0.6), cut))
                .with(square(0.4), at(0.2, -0.3, 1.2), pane)
                .lit_by(lamp())
                .build(),
        ),
    ]
}
