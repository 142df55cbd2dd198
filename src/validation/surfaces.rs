//! White furnaces: what absorbs nothing vanishes in an even surrounding (C-46).

use super::check::{Check, FAULT};
use super::probe::{Experiment, Look, along};
use super::room::{Room, at, even_sky, gray, square};
use crate::color::Rgb;
use crate::geometry::Shape;
use crate::material::{Lobe, LobeKind, Material};
use crate::math::functions::{cos, ln, sin};
use crate::math::{Ray, rng, warp};
use glam::{DAffine3, DQuat, DVec2, DVec3};

/// Down onto all of a ball of radius 1 at the origin, almost to its rim.
fn onto_a_ball() -> Look {
    Box::new(|u: DVec2| Ray::new((0.99 * warp::disk(u)).extend(5.0), DVec3::NEG_Z))
}

fn clear(ior: f64) -> Material {
    Material::glass(ior, 0.0, Rgb::BLACK)
}

fn ball(material: Material) -> Room {
    Room::default().with(Shape::Sphere { radius: 1.0 }, at(0., 0., 0.), material)
}

/// A room that builds itself.
type Make = fn() -> Room;

/// Every surface that loses nothing, and what facets and Phong's lobe are known to lose.
pub(super) fn checks() -> Vec<Check> {
    let cases: [(&str, &str, Make); 12] = [
        ("lambert", "a matt ball", || {
            ball(Material::lambert(Rgb::WHITE))
        }),
        ("leaf", "a ball of leaf, rho 0.3 tau 0.7", || {
            ball(Material::leaf(gray(0.3), gray(0.7)))
        }),
        ("mirror", "a mirror ball", || {
            ball(Material::mirror(Rgb::WHITE))
        }),
        ("glass", "a ball of glass, index 1.5", || ball(clear(1.5))),
        ("diamond", "a ball of glass, index 2.4", || ball(clear(2.4))),
        ("bubble", "a bubble, index 1/1.5", || ball(clear(1.0 / 1.5))),
        ("nested", "a bubble in a ball of glass", || {
            let inner = Shape::Sphere { radius: 0.5 };
            ball(clear(1.5)).with(inner, at(0., 0., 0.), clear(1.0 / 1.5))
        }),
        ("pane", "a ball of pane", || {
            ball(Material::pane(1.5, Rgb::WHITE))
        }),
        ("mixture", "a ball of mirror, leaf and glass", || {
            let leaf = Material::leaf(gray(0.4), gray(0.6));
            let solid = Material::mixed(&Material::mirror(Rgb::WHITE), &leaf, 0.3);
            ball(Material::mixed(&solid, &clear(1.3), 0.5))
        }),
        ("mirrored", "a matt ball, mirrored and stretched", || {
            let uneven = DAffine3::from_scale(DVec3::new(-1.0, 2.0, 0.5));
            Room::default().with(
                Shape::Sphere { radius: 1.0 },
                uneven,
                Material::lambert(Rgb::WHITE),
            )
        }),
        ("half", "a matt ball of alpha 0.4", || {
            ball(Material::lambert(Rgb::WHITE).with_alpha(0.4))
        }),
        ("crown", "a crown of 60 leaves, rho 0.3 tau 0.7", crown),
    ];
    let mut checks = Vec::new();
    for (id, what, make) in cases {
        let what = format!("white furnace: {what} in an even sky of radiance 1");
        checks.push(Check::mean(
            (format!("furnace-{id}"), what),
            1.0,
            FAULT,
            move || {
                Ok(Experiment::new(
                    make().under(even_sky(1.0)).scene()?,
                    onto_a_ball(),
                ))
            },
        ));
    }
    checks.extend(lossy());
    checks
        .into_iter()
        .map(|check| check.of_case("46"))
        .collect()
}

/// Leaves in all directions round the origin.
fn crown() -> Room {
    let leaf = Material::leaf(gray(0.3), gray(0.7));
    (0..60).fold(Room::default(), |room, i| {
        let h = |k: u64| rng::unit_f64(rng::hash(&[i, k]));
        let turn = DQuat::from_rotation_arc(DVec3::Z, warp::sphere(DVec2::new(h(0), h(1))));
        let place = DVec3::new(h(2) - 0.5, h(3) - 0.5, h(4) - 0.5);
        let to_world = DAffine3::from_rotation_translation(turn, place);
        room.with(square(0.2), to_world, leaf.clone())
    })
}

/// The share that is left of light that arrives at this angle.
fn left(id: &str, what: &str, material: Material, degrees: f64, expected: f64) -> Check {
    let (id, what) = (
        format!("furnace-{id}"),
        format!("directional albedo: {what}, at {degrees} deg"),
    );
    Check::mean((id, what), expected, FAULT, move || {
        let radians = degrees.to_radians();
        let scene = Room::default()
            .with(Shape::Plane, at(0., 0., 0.), material.clone())
            .under(even_sky(1.0))
            .scene()?;
        let down = DVec3::new(sin(radians), 0.0, -cos(radians));
        Ok(Experiment::new(scene, along(DVec3::Z, down)))
    })
}

/// Facets lose what would meet a second one: α = 1 keeps ∫ (2 - 1/u) du over ½..1 = 1 - ln 2 at normal incidence. Phong's
/// normalisation is exact there, (n + 2)/2π ∫ cosⁿ⁺¹ = 1; at the angle θ the lobe of exponent 0 (f = 1/π) is a matt surface.
fn lossy() -> Vec<Check> {
    let of = |kind| Material::of_lobes(vec![Lobe::new(kind, Rgb::WHITE)]);
    vec![
        left(
            "facets",
            "metal, as rough as can be: 1 - ln 2",
            Material::metal(Rgb::WHITE, 1.0),
            0.0,
            1.0 - ln(2.0),
        ),
        left(
            "phong-20",
            "Phong, exponent 20",
            of(LobeKind::Phong { exponent: 20.0 }),
            0.0,
            1.0,
        ),
        left(
            "haze-20",
            "haze, exponent 20",
            of(LobeKind::Haze { exponent: 20.0 }),
            0.0,
            1.0,
        ),
        left(
            "metal-smooth",
            "smooth metal of 0.7, by Schlick",
            Material::metal(gray(0.7), 0.0),
            60.0,
            0.7 + 0.3 / 32.0,
        ),
    ]
}
