//! Small scenes that only just require something, or only just do not.

use super::room::{Room, at, even_sky, gray, square};
use super::spared::{lamp, matt, open_box, panel};
use glam::{DAffine3, DVec3};
use std::f64::consts::PI;
use std::sync::Arc;
use understory::color::Rgb;
use understory::geometry::Shape;
use understory::light::{Environment, Light, Sky, SkyImage};
use understory::material::image::Image;
use understory::material::texture::{Filter, Layer, Pictures, Texture};
use understory::material::{Lobe, LobeKind, Material, Side};
use understory::math::angle::Angle;
use understory::scene::Scene;

/// A scene at the edge of requiring something.
pub(crate) struct Edge {
    /// What it is called.
    pub(crate) what: &'static str,
    /// What it is.
    pub(crate) scene: Scene,
    /// What it requires, of what renderers are made with.
    pub(crate) required: &'static str,
}

fn edge(what: &'static str, room: Room, required: &'static str) -> Edge {
    let scene = room.build();
    Edge {
        what,
        scene,
        required,
    }
}

/// With a board that shows its front to the camera.
fn board(room: Room, material: Material) -> Room {
    let upright = DAffine3::from_rotation_x(PI / 2.0);
    room.with(square(0.5), at(-0.3, 0.0, 1.0) * upright, material)
}

/// Black walls and a black ball.
fn dark_box() -> Room {
    open_box(&matt(0.0), matt(0.0))
}

/// Gray walls with this ball.
fn gray_box(ball: Material) -> Room {
    open_box(&matt(0.6), ball)
}

/// A closed room of these walls round the camera, with something in it.
fn closed_room(wall: Material) -> Room {
    let room = Shape::Box {
        half_x: 4.0,
        half_y: 4.0,
        length: 6.0,
    };
    let room = Room::default().with(room, at(0.0, -2.0, -2.0), wall);
    board(room, matt(0.4))
}

/// A surface of which only the pictures scatter light, as this side does where they are white.
fn painted(layers: Vec<Texture>, holes: Vec<Texture>, side: Side) -> Material {
    let layers = layers.into_iter().map(|texture| Layer {
        texture,
        sides: [side; 2],
    });
    let pictures = Pictures {
        layers: layers.collect(),
        holes,
    };
    Material {
        pictures: Some(Box::new(pictures)),
        ..matt(0.0)
    }
}

/// A row of texels of this gray and coverage.
fn picture(texels: &[[f32; 2]]) -> Texture {
    let width = u32::try_from(texels.len()).unwrap();
    let texels = texels
        .iter()
        .map(|[gray, cover]| [*gray, *gray, *gray, *cover]);
    Texture::new(Arc::new(Image::linear(width, 1, texels.collect()).unwrap()))
}

fn transmitting(share: f64) -> Side {
    Side {
        reflectance: Rgb::BLACK,
        transmittance: gray(share),
    }
}

fn reflecting(share: f64) -> Side {
    Side {
        reflectance: gray(share),
        transmittance: Rgb::BLACK,
    }
}

/// What lets this share of light through, blurred.
fn haze(share: f64) -> Material {
    let kind = LobeKind::Haze { exponent: 5.0 };
    Material::of_lobes(vec![Lobe::new(kind, gray(share))])
}

/// A picture of all round that is black but for the quarter round the nadir.
fn light_from_below() -> Environment {
    let rows = [[0.0; 3], [0.0; 3], [0.0; 3], [1.0; 3]];
    let pixels = rows.into_iter().flat_map(|row| [row; 8]).collect();
    Environment {
        sky: Sky::Image {
            image: Arc::new(SkyImage::new(8, 4, pixels).unwrap()),
            turn: Angle::deg(0.0),
            strength: 1.0,
        },
        sun: None,
    }
}

/// What surfaces only just do to light.
fn of_materials() -> Vec<Edge> {
    let behind = || Light::point(DVec3::new(-0.3, 0.6, 1.0), gray(10.0));
    let through_back = Material::matt([Side::default(), transmitting(0.5)]);
    let half_white = picture(&[[0.0, 1.0], [0.8, 1.0]]);
    let uncovered = Texture {
        filter: Filter::Nearest,
        ..picture(&[[0.8, 0.0], [0.0, 1.0]])
    };
    let white = reflecting(1.0);
    let mirror = Material::mirror(gray(0.9));
    let blue = Material::glass(1.5, 0.0, Rgb::new(0.0, 0.0, 3.0));
    let frosted = Material::glass(1.5, 0.5, Rgb::new(0.5, 0.2, 0.9));
    let gloss = Material::metal(gray(0.8), 0.5);
    let some_glass = Material::mixed(&gloss, &Material::glass(1.5, 0.0, Rgb::BLACK), 0.5);
    let some_gloss = Material::mixed(&Material::pane(1.0, Rgb::WHITE), &gloss, 0.5);
    vec![
        edge(
            "a back that lets light through",
            board(dark_box(), through_back).lit_by(behind()),
            "bounces",
        ),
        edge(
            "a picture, half of it black",
            board(dark_box(), painted(vec![half_white], vec![], white)).lit_by(lamp()),
            "bounces",
        ),
        edge(
            "a picture that is white where it is not",
            board(dark_box(), painted(vec![uncovered], vec![], white)).lit_by(lamp()),
            "none",
        ),
        edge(
            "a board that is not there",
            board(dark_box(), matt(0.8).with_alpha(0.0)).lit_by(lamp()),
            "none",
        ),
        edge(
            "a mirror among black walls",
            open_box(&matt(0.0), mirror).under(even_sky(1.0)),
            "bounces,caustics,light-hits,unasked-light",
        ),
        edge(
            "glass that absorbs blue",
            panel(gray_box(blue)),
            "bounces,caustics,guide,light-hits,bodies,clear-shadows,unasked-light,insides",
        ),
        edge(
            "frosted glass that absorbs",
            panel(gray_box(frosted)),
            "bounces,light-hits,bodies,unasked-light,insides",
        ),
        edge(
            "some smooth glass in rough metal",
            gray_box(some_glass).lit_by(lamp()),
            "bounces,caustics,clear-shadows,unasked-light,insides",
        ),
        edge(
            "some gloss on what lets light through",
            gray_box(some_gloss).lit_by(lamp()),
            "bounces,unasked-light,insides",
        ),
        edge(
            "gloss",
            gray_box(gloss).lit_by(lamp()),
            "bounces,unasked-light",
        ),
        edge(
            "a hazy ball",
            gray_box(haze(0.5)).lit_by(lamp()),
            "bounces,unasked-light,insides",
        ),
    ]
}

/// What only just shines, or from where.
fn of_light() -> Vec<Edge> {
    let gray_box = || gray_box(matt(0.4));
    let shining = |front: f64, back: f64| matt(0.0).emitting(gray(front), gray(back));
    let mirror = Material::mirror(gray(0.9));
    let dead = |x: f64| Light::point(DVec3::new(x, -0.5, 1.0), Rgb::BLACK);
    let dim = Light::point(DVec3::new(-0.5, -0.8, 1.0), gray(1e-9));
    let day = Environment::daylight(Angle::deg(-70.0), Angle::deg(35.0), 3.0, gray(0.2));
    let sun = Environment {
        sky: Sky::None,
        ..day
    };
    let land = Environment::overcast(Angle::deg(40.0), gray(0.3));
    vec![
        edge(
            "ground that shines",
            gray_box().with(Shape::Plane, at(0.0, 0.0, -0.5), shining(2.0, 0.0)),
            "bounces,unaimed-photons,light-hits,unasked-light",
        ),
        edge(
            "a mirror that shows the sky",
            board(gray_box(), mirror.clone()).under(even_sky(1.0)),
            "bounces,caustics,light-hits,unasked-light",
        ),
        edge(
            "ground that mirrors",
            gray_box()
                .with(Shape::Plane, at(0.0, 0.0, -0.5), mirror)
                .lit_by(lamp()),
            "bounces,caustics,unaimed-photons,unasked-light",
        ),
        edge("the sun alone", gray_box().under(sun), "bounces,light-hits"),
        edge(
            "a panel that shines behind",
            gray_box().with(square(0.3), at(0.0, 0.0, 1.9), shining(0.0, 9.0)),
            "bounces,light-hits",
        ),
        edge(
            "a lamp and a billionth of it",
            gray_box().lit_by(lamp()).lit_by(dim),
            "bounces,light-choice",
        ),
        edge(
            "a lamp among dead ones",
            gray_box()
                .lit_by(dead(0.0))
                .lit_by(lamp())
                .lit_by(dead(0.5)),
            "bounces",
        ),
        edge(
            "land below the horizon",
            gray_box().under(land),
            "bounces,light-hits,unasked-light",
        ),
        edge(
            "a picture of light from below",
            gray_box().under(light_from_below()),
            "bounces,light-hits",
        ),
    ]
}

/// Closed bodies with just some light in them.
fn of_bodies() -> Vec<Edge> {
    let sky = || even_sky(1.0);
    let through_back = Material::matt([reflecting(0.4), transmitting(0.4)]);
    let covered = picture(&[[0.5, 1.0], [0.5, 1.0], [0.5, 1.0], [0.5, 0.0]]);
    let holed = painted(vec![], vec![covered.clone()], reflecting(1.0));
    let holed = Material {
        sides: [reflecting(0.6); 2],
        ..holed
    };
    let papered = painted(vec![covered], vec![], transmitting(1.0));
    let shining = |front: f64, back: f64| matt(0.5).emitting(gray(front), gray(back));
    let lamp = Light::point(DVec3::new(1.0, -1.0, 2.0), gray(10.0));
    let beam = Light::Directional {
        direction: DVec3::new(0.0, 0.6, -0.8),
        irradiance: gray(1.0),
        origin: DVec3::new(0.0, 0.0, 2.5),
    };
    vec![
        edge(
            "a ball that lets light out",
            gray_box(through_back).under(sky()),
            "bounces,light-hits,insides",
        ),
        edge(
            "a ball, half of it haze",
            gray_box(Material::mixed(&matt(0.6), &haze(1.0), 0.5)).under(sky()),
            "bounces,light-hits,unasked-light,insides",
        ),
        edge(
            "a ball with holes",
            gray_box(holed).under(sky()),
            "bounces,light-hits,insides",
        ),
        edge(
            "a ball of painted paper",
            gray_box(papered).under(sky()),
            "bounces,light-hits,insides",
        ),
        edge(
            "a lamp in a room",
            closed_room(matt(0.5)).lit_by(lamp),
            "bounces",
        ),
        edge(
            "a beam in a room",
            closed_room(matt(0.5)).lit_by(beam),
            "bounces",
        ),
        edge(
            "a panel in a room",
            panel(closed_room(matt(0.5))),
            "bounces,light-hits",
        ),
        edge(
            "walls that shine",
            closed_room(shining(0.0, 0.2)),
            "bounces,light-hits,insides",
        ),
        edge(
            "ground that shines in a room",
            closed_room(matt(0.5)).with(Shape::Plane, at(0.0, 0.0, -0.5), shining(2.0, 0.0)),
            "bounces,unaimed-photons,light-hits,unasked-light",
        ),
    ]
}

/// All of them.
pub(crate) fn edges() -> Vec<Edge> {
    [of_materials(), of_light(), of_bodies()]
        .into_iter()
        .flatten()
        .collect()
}
