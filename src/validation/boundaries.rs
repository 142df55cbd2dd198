//! Glass: what boundaries and panes reflect and let through, by rays in scenes.

use super::check::{Check, FAULT};
use super::probe::{Experiment, along};
use super::room::{Room, at, even_sky, glow, gray, square};
use super::table::{number, rows};
use crate::color::Rgb;
use crate::geometry::Shape;
use crate::integrator::Path;
use crate::light::Light;
use crate::material::Material;
use crate::math::Ray;
use crate::math::functions::{asin, atan, cos, exp, sin};
use crate::math::tolerance::{CLOSED_FORM, PRINTED_DIGITS};
use crate::scene::SceneError;
use glam::DVec3;
use std::f64::consts::PI;

/// Reflectance of a boundary, transmittance and reflectance of a sheet, by angle; index 1.5.
const TABLE: &str = include_str!("tables/glass_sheet_fresnel.csv");

const IOR: f64 = 1.5;

/// Half the edge of walls and panes, metres: no ray here leaves beside them.
const HALF: f64 = 1000.0;

/// The direction that comes down at this angle to the vertical.
fn down(radians: f64) -> DVec3 {
    DVec3::new(sin(radians), 0.0, -cos(radians))
}

/// A ceiling that shines down.
fn ceiling(height: f64) -> (Shape, glam::DAffine3, Material) {
    let shape = Shape::Parallelogram {
        corner: DVec3::new(-HALF, -HALF, 0.0),
        edge_u: DVec3::Y * (2.0 * HALF),
        edge_v: DVec3::X * (2.0 * HALF),
    };
    (shape, at(0., 0., height), glow())
}

/// The reflectance of the boundary to glass of index `ior` below, by a ray at this angle, under a ceiling of radiance 1.
fn reflected(radians: f64, ior: f64) -> Result<Experiment, SceneError> {
    let (shape, place, material) = ceiling(1.0);
    let scene = Room::default()
        .with(
            Shape::Plane,
            at(0., 0., 0.),
            Material::glass(ior, 0.0, Rgb::BLACK),
        )
        .with(shape, place, material)
        .scene()?;
    Ok(Experiment::new(scene, along(DVec3::Z * 0.5, down(radians))).spread(256))
}

/// The angles of the table, special angles, bodies and panes (C-46 to C-50).
pub(super) fn checks() -> Vec<Check> {
    let mut checks: Vec<Check> = rows(TABLE).flat_map(|row| angle(&row)).collect();
    checks.extend(special_angles());
    checks.extend(bodies());
    checks.extend(lamp_through_pane());
    let case = |id: &str| match id {
        "glass-index-1" | "body-through-1" | "body-inside-1" => "48",
        _ if id.starts_with("glass-inside") || id.starts_with("glass-beyond") => "49",
        _ if id.starts_with("body") => "46",
        _ => "50",
    };
    let with_case = |check: Check| {
        let case = case(&check.id);
        check.of_case(case)
    };
    checks.into_iter().map(with_case).collect()
}

/// A row of the table.
fn angle(row: &[&'static str]) -> Vec<Check> {
    let (degrees, name) = (number(row, 0), row[0]);
    let radians = degrees.to_radians();
    let pane = || {
        Room::default().with(
            square(HALF),
            at(0., 0., 0.),
            Material::pane(IOR, Rgb::WHITE),
        )
    };
    let boundary = format!("reflectance of glass, index 1.5, at {name} deg");
    let tau = format!("transmittance of a sheet of glass at {name} deg");
    let rho = format!("reflectance of a sheet of glass at {name} deg");
    vec![
        Check::mean(
            (format!("glass-boundary-{name}"), boundary),
            number(row, 1),
            FAULT,
            move || reflected(radians, IOR),
        ),
        Check::exact(
            (
                format!("glass-sheet-shadow-{name}"),
                format!("{tau}, by a shadow ray"),
            ),
            number(row, 2),
            PRINTED_DIGITS,
            move || {
                Ok(pane()
                    .scene()?
                    .transmittance(&Ray::new(DVec3::Z, down(radians)))
                    .g)
            },
        ),
        Check::mean(
            (
                format!("glass-sheet-through-{name}"),
                format!("{tau}, by paths"),
            ),
            number(row, 2),
            FAULT,
            move || {
                let scene = pane().with(square(HALF), at(0., 0., -1.), glow()).scene()?;
                Ok(Experiment::new(scene, along(DVec3::Z, down(radians))).spread(256))
            },
        ),
        Check::mean(
            (
                format!("glass-sheet-back-{name}"),
                format!("{rho}, by paths"),
            ),
            number(row, 3),
            FAULT,
            move || {
                let (shape, place, material) = ceiling(2.0);
                let scene = pane().with(shape, place, material).scene()?;
                Ok(Experiment::new(scene, along(DVec3::Z, down(radians))).spread(256))
            },
        ),
    ]
}

/// Brewster's angle, where only one polarisation is reflected, and the critical angle, beyond which all is.
fn special_angles() -> Vec<Check> {
    let amplitude = (IOR * IOR - 1.0) / (IOR * IOR + 1.0);
    let critical = asin(1.0 / IOR).to_degrees();
    let beyond = critical + 1.0 / 1024.0;
    let normal_inside = ((1.0 / IOR - 1.0) / (1.0 / IOR + 1.0)).powi(2);
    let from_inside = |degrees: f64| move || reflected(degrees.to_radians(), 1.0 / IOR);
    let named = |id: &'static str, what: &'static str| (id, what);
    vec![
        Check::mean(
            named(
                "glass-brewster",
                "reflectance of glass at Brewster's angle, 56.3099 deg: ((n2-1)/(n2+1))^2 / 2",
            ),
            0.5 * amplitude * amplitude,
            FAULT,
            || reflected(atan(IOR), IOR),
        ),
        Check::mean(
            named(
                "glass-inside-0",
                "reflectance of glass from inside, straight",
            ),
            normal_inside,
            FAULT,
            from_inside(0.0),
        ),
        Check::mean(
            named(
                "glass-beyond-critical",
                "reflectance from inside beyond the critical angle, 41.8103 deg",
            ),
            1.0,
            FAULT,
            from_inside(beyond),
        ),
        Check::mean(
            named("glass-inside-60", "reflectance from inside at 60 deg"),
            1.0,
            FAULT,
            from_inside(60.0),
        ),
        Check::exact(
            named(
                "glass-index-1",
                "transmittance of a boundary between equal media at 80 deg",
            ),
            1.0,
            CLOSED_FORM,
            || {
                let none = Material::glass(1.0, 0.0, Rgb::BLACK);
                let scene = Room::default().with(Shape::Plane, at(0., 0., 0.), none);
                let scene = scene.under(even_sky(1.0)).scene()?;
                Ok(Experiment::new(scene, along(DVec3::Z, down(80.0_f64.to_radians()))).once())
            },
        ),
    ]
}

/// A ball that absorbs, straight through its middle: R is reflected, e^(-2σr) is left per crossing, 1 - R of that leaves.
fn bodies() -> Vec<Check> {
    let (sigma, left) = (0.7, exp(-1.4));
    let mut checks = Vec::new();
    for (name, ior) in [("1", 1.0), ("1.5", 1.5), ("0.667", 1.0 / 1.5)] {
        let r = ((ior - 1.0_f64) / (ior + 1.0)).powi(2);
        let cases = [
            (
                "through",
                5.0,
                r + (1.0 - r) * (1.0 - r) * left / (1.0 - r * left),
            ),
            // From the middle: half a crossing first, and radiance is n² as dense inside.
            (
                "inside",
                0.0,
                ior * ior * (1.0 - r) * left.sqrt() / (1.0 - r * left),
            ),
        ];
        for (where_from, height, expected) in cases {
            let id = format!("body-{where_from}-{name}");
            let what = format!(
                "radiance {where_from} a ball, index {name}, that absorbs 0.7/m, in an even sky"
            );
            checks.push(Check::mean((id, what), expected, FAULT, move || {
                let glass = Material::glass(ior, 0.0, gray(sigma));
                let ball = Shape::Sphere { radius: 1.0 };
                let scene = Room::default()
                    .with(ball, at(0., 0., 0.), glass)
                    .under(even_sky(1.0))
                    .scene()?;
                Ok(Experiment::new(
                    scene,
                    along(DVec3::Z * height, DVec3::NEG_Z),
                ))
            }));
        }
    }
    checks
}

/// A point source shines through a pane: the shadow ray passes straight, with the share of the sheet.
fn lamp_through_pane() -> Vec<Check> {
    let table = |degrees: &str| rows(TABLE).find(|row| row[0] == degrees);
    let mut checks = Vec::new();
    for degrees in ["0", "45", "75"] {
        let row = table(degrees).unwrap_or_default();
        let angle = number(&row, 0).to_radians();
        let c = cos(angle);
        let expected = number(&row, 2) * c * c * c / 4.0;
        let what = format!(
            "irradiance of a point source of 4 pi W, 2 m up, through a pane at {degrees} deg"
        );
        checks.push(Check::exact(
            (format!("glass-lamp-{degrees}"), what),
            expected,
            PRINTED_DIGITS,
            move || {
                let foot = 2.0 * sin(angle) / cos(angle);
                let scene = Room::default()
                    .with(Shape::Plane, at(0., 0., 0.), Material::lambert(gray(0.5)))
                    .with(
                        square(HALF),
                        at(0., 0., 1.),
                        Material::pane(IOR, Rgb::WHITE),
                    )
                    .lit_by(Light::point(DVec3::Z * 2.0, gray(4.0 * PI)))
                    .scene()?;
                let path = Path {
                    max_depth: Some(1),
                    ..Path::default()
                };
                let look = along(DVec3::new(foot, 0.0, 0.5), DVec3::NEG_Z);
                Ok(Experiment::new(scene, look).by(path).times(2.0 * PI).once())
            },
        ));
    }
    checks
}
