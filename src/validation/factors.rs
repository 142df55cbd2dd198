//! Configuration factors: the share of the diffuse flux of one surface that arrives at another, between rectangles, disks,
//! spheres and small areas.
//!
//! The factor from A to B is the irradiance that B, shining with radiance 1, makes on A, over π: A is a matt surface here, and
//! each factor is found twice (the smallest once), by sampling the shining surface and by rays that leave A with the density cos θ / π.

use super::check::{Check, FAULT};
use super::probe::{Experiment, Look};
use super::room::{Room, at, glow, gray, square};
use super::table::{number, parameter, rows};
use crate::geometry::{Shape, TriangleMesh};
use crate::integrator::Path;
use crate::integrator::path::Strategies;
use crate::material::Material;
use crate::math::functions::{asin, cos, sin};
use crate::math::{Ray, warp};
use crate::scene::{Scene, SceneError};
use glam::{DAffine3, DMat3, DVec2, DVec3};
use std::f64::consts::{FRAC_1_PI, PI};
use std::sync::Arc;

/// The closed forms that J. R. Howell collected, evaluated in double precision.
const TABLE: &str = include_str!("tables/configuration_factors.csv");

/// Distance from which a surface is looked at, in parts of the size of the arrangement.
const NEAR: f64 = 1.0 / 1024.0;

/// Smaller factors are not asked of rays.
const SELDOM: f64 = 0.05;

/// Disks with larger factors fill the view.
const NEARLY_ALL: f64 = 0.9;

/// Fraction that the receiving surface reflects.
const RHO: f64 = 0.5;

/// Both surfaces.
#[derive(Clone)]
struct Arrangement {
    receiver: Receiver,
    /// Shines on its front only.
    emitter: (Shape, DAffine3),
}

/// The surface whose irradiance is wanted.
#[derive(Clone, Copy)]
enum Receiver {
    /// A small one at the origin that faces this way.
    Spot(DVec3),
    /// `0..a × 0..b`, facing up.
    Rectangle(f64, f64),
    /// Round the origin, facing up.
    Disk(f64),
    /// A ball.
    Ball(DVec3, f64),
    /// The inside of a ball round the origin.
    Hollow(f64),
}

impl Receiver {
    /// A point of it, uniform by area, and its normal there.
    fn point(self, u: DVec2) -> (DVec3, DVec3) {
        match self {
            Self::Spot(normal) => (DVec3::ZERO, normal),
            Self::Rectangle(a, b) => (DVec3::new(u.x * a, u.y * b, 0.0), DVec3::Z),
            Self::Disk(radius) => ((warp::disk(u) * radius).extend(0.0), DVec3::Z),
            Self::Ball(center, radius) => {
                let normal = warp::sphere(u);
                (center + normal * radius, normal)
            }
            Self::Hollow(radius) => {
                let outward = warp::sphere(u);
                (outward * radius, -outward)
            }
        }
    }

    fn size(self) -> f64 {
        match self {
            Self::Spot(_) => NEAR,
            Self::Rectangle(a, b) => a.min(b),
            Self::Disk(radius) | Self::Ball(_, radius) | Self::Hollow(radius) => radius,
        }
    }

    /// Along normals at points that cover it.
    fn look(self) -> Look {
        let clearance = NEAR * self.size();
        Box::new(move |u| {
            let (point, normal) = self.point(u);
            Ray::new(point + normal * clearance, -normal)
        })
    }

    fn shape(self) -> (Shape, DAffine3) {
        match self {
            Self::Spot(normal) => (square(NEAR), facing(normal, DVec3::ZERO)),
            Self::Rectangle(a, b) => (
                flat([0.0; 3], DVec3::X * a, DVec3::Y * b),
                DAffine3::IDENTITY,
            ),
            Self::Disk(radius) => (Shape::Disk { radius }, DAffine3::IDENTITY),
            Self::Ball(center, radius) => {
                (Shape::Sphere { radius }, DAffine3::from_translation(center))
            }
            Self::Hollow(radius) => (Shape::Sphere { radius }, DAffine3::IDENTITY),
        }
    }
}

impl Arrangement {
    fn scene(self) -> Result<Scene, SceneError> {
        let (shape, place) = self.receiver.shape();
        let (emitter, to_world) = self.emitter;
        Room::default()
            .with(shape, place, Material::lambert(gray(RHO)))
            .with(emitter, to_world, glow())
            .scene()
    }

    /// The share that arrives, found in this way.
    fn experiment(self, strategies: Strategies, spread: u32) -> Result<Experiment, SceneError> {
        let path = Path {
            max_depth: Some(1),
            strategies,
            ..Path::default()
        };
        let look = self.receiver.look();
        // L = ρ/π · π F · 1.
        let experiment = Experiment::new(self.scene()?, look).by(path);
        Ok(experiment.times(1.0 / RHO).spread(spread))
    }
}

/// A parallelogram; its front looks along `edge_u × edge_v`.
fn flat(corner: [f64; 3], edge_u: DVec3, edge_v: DVec3) -> Shape {
    Shape::Parallelogram {
        corner: corner.into(),
        edge_u,
        edge_v,
    }
}

/// Turns +z to this normal.
fn facing(normal: DVec3, place: DVec3) -> DAffine3 {
    let frame = crate::math::frame::Frame::from_normal(normal);
    let turn = DMat3::from_cols(frame.tangent, frame.bitangent, frame.normal);
    DAffine3::from_mat3_translation(turn, place)
}

/// The arrangement of a row of the table.
fn arrangement(name: &str, list: &str) -> Option<Arrangement> {
    let p = |name| parameter(list, name);
    let (a, b, c) = (p("a"), p("b"), p("c"));
    let up = Receiver::Spot(DVec3::Z);
    let (receiver, emitter) = if name.starts_with("C-11 ") {
        let opposite = flat([0.0, 0.0, c], DVec3::Y * b, DVec3::X * a);
        (Receiver::Rectangle(a, b), (opposite, DAffine3::IDENTITY))
    } else if name.starts_with("C-14 ") {
        let upright = flat([0.0; 3], DVec3::Z * p("h"), DVec3::X * p("l"));
        (
            Receiver::Rectangle(p("l"), p("w")),
            (upright, DAffine3::IDENTITY),
        )
    } else if name.starts_with("C-41 ") {
        let place = facing(DVec3::NEG_Z, DVec3::Z * p("h"));
        (
            Receiver::Disk(p("r1")),
            (Shape::Disk { radius: p("r2") }, place),
        )
    } else if name.starts_with("dA parallel to disk") {
        let place = facing(DVec3::NEG_Z, DVec3::Z * p("h"));
        (up, (Shape::Disk { radius: p("r") }, place))
    } else if name.starts_with("dA parallel to rectangle") {
        let opposite = flat([0.0, 0.0, c], DVec3::Y * b, DVec3::X * a);
        (up, (opposite, DAffine3::IDENTITY))
    } else if name.starts_with("dA in plane perpendicular") {
        let upright = flat([0.0, c, 0.0], DVec3::X * b, DVec3::Z * a);
        (up, (upright, DAffine3::IDENTITY))
    } else if name.starts_with("sphere ") {
        let ground = flat([0.0; 3], DVec3::X * p("l1"), DVec3::Y * p("l2"));
        let center = DVec3::Z * p("d");
        (
            Receiver::Ball(center, 0.5 * p("d")),
            (ground, DAffine3::IDENTITY),
        )
    } else if name.starts_with("dA facing sphere") {
        (up, (Shape::Sphere { radius: p("r") }, at(0.0, 0.0, p("h"))))
    } else {
        return None;
    };
    Some(Arrangement { receiver, emitter })
}

/// The checks of an arrangement: by sampling what shines, and by rays unless they hardly ever meet it.
fn both_ways(id: &str, what: &str, expected: f64, arrangement: &Arrangement) -> Vec<Check> {
    let (one, other) = (arrangement.clone(), arrangement.clone());
    let mut checks = Vec::new();
    // Points of a disk close by are chosen by area, which is hopelessly noisy there.
    if expected < NEARLY_ALL || !matches!(arrangement.emitter.0, Shape::Disk { .. }) {
        checks.push(Check::mean(
            (
                format!("{id}-by-light"),
                format!("{what}, by sampling what shines"),
            ),
            expected,
            FAULT,
            move || one.clone().experiment(Strategies::LightsOnly, 64),
        ));
    }
    if expected >= SELDOM {
        // Rays that seldom meet what shines are noisy: less must do.
        let fault = if expected < 2.0 * SELDOM { 5.0 } else { 2.5 } * FAULT;
        checks.push(Check::mean(
            (
                format!("{id}-by-rays"),
                format!("{what}, by rays of density cos/pi"),
            ),
            expected,
            fault,
            move || other.clone().experiment(Strategies::ScatteringOnly, 256),
        ));
    }
    checks
}

/// All rows of the table (C-1, C-2, C-3, C-5, C-6, C-10), rectangles of triangles, slanted spots below a ball, and shapes of all
/// kinds inside a ball (C-7).
pub(super) fn checks() -> Vec<Check> {
    let mut checks = Vec::new();
    for (nth, row) in rows(TABLE).enumerate() {
        let first = checks.len();
        let (name, list) = (row[0], row.get(1).copied().unwrap_or_default());
        let what = format!("factor, {name}: {list}");
        let id = format!("factor-{:02}", nth + 1);
        let Some(arrangement) = arrangement(name, list) else {
            // A row that nobody knows must not pass unseen.
            checks.push(Check::exact((id, what), number(&row, 2), 0.0, || {
                Ok(f64::NAN)
            }));
            continue;
        };
        checks.extend(both_ways(&id, &what, number(&row, 2), &arrangement));
        // Triangles are sampled by area: from a small area some way off.
        let is_spot = matches!(arrangement.receiver, Receiver::Spot(_));
        if let Some(mesh) = of_triangles(&arrangement).filter(|_| is_spot) {
            let what = format!("{what}, of two triangles, by sampling them");
            checks.push(Check::mean(
                (format!("{id}-mesh"), what),
                number(&row, 2),
                FAULT,
                move || mesh.clone().experiment(Strategies::LightsOnly, 64),
            ));
        }
        let case = case_of(name);
        checks[first..]
            .iter_mut()
            .for_each(|check| check.case = case);
    }
    let in_case =
        |checks: Vec<Check>, case| checks.into_iter().map(move |check| check.of_case(case));
    checks.extend(in_case(slanted_spots(), "6"));
    checks.extend(in_case(inside_a_ball(), "7"));
    checks
}

/// Which case of the list of tests a row of the table belongs to.
fn case_of(name: &str) -> Option<&'static str> {
    let cases = [
        ("C-11 ", "1"),
        ("C-14 ", "2"),
        ("C-41 ", "3"),
        ("dA facing sphere", "6"),
        ("dA ", "5"),
    ];
    let found = cases
        .iter()
        .find(|(beginning, _)| name.starts_with(beginning));
    found.map(|(_, case)| *case)
}

/// The arrangement with its shining parallelogram as a mesh.
fn of_triangles(arrangement: &Arrangement) -> Option<Arrangement> {
    let Shape::Parallelogram {
        corner,
        edge_u,
        edge_v,
    } = arrangement.emitter.0
    else {
        return None;
    };
    let positions = vec![
        corner,
        corner + edge_u,
        corner + edge_u + edge_v,
        corner + edge_v,
    ];
    let mesh = TriangleMesh {
        positions,
        triangles: vec![[0, 1, 2], [0, 2, 3]],
        ..TriangleMesh::default()
    };
    Some(Arrangement {
        emitter: (Shape::Mesh(Arc::new(mesh)), arrangement.emitter.1),
        ..arrangement.clone()
    })
}

/// A small area and a ball wholly above its horizon: (r/d)² cos θ.
fn slanted_spots() -> Vec<Check> {
    let mut checks = Vec::new();
    for (degrees, radius) in [(30.0_f64, 0.5), (60.0, 0.3), (80.0, 0.1)] {
        let angle = degrees.to_radians();
        let arrangement = Arrangement {
            receiver: Receiver::Spot(DVec3::new(sin(angle), 0.0, cos(angle))),
            emitter: (Shape::Sphere { radius }, at(0.0, 0.0, 1.0)),
        };
        let expected = radius * radius * cos(angle);
        let what = format!("factor, dA turned {degrees} deg from a ball: r={radius} d=1");
        let id = format!("factor-slanted-{degrees}");
        checks.extend(both_ways(&id, &what, expected, &arrangement));
    }
    checks
}

/// What shines in the middle of a hollow ball and is convex sends all its light there: the factor is A/4πR².
fn inside_a_ball() -> Vec<Check> {
    let frustum = |base_radius, top_radius| Shape::Frustum {
        length: 1.0,
        base_radius,
        top_radius,
        base_cap: true,
        top_cap: true,
    };
    let cube = Shape::Box {
        half_x: 0.4,
        half_y: 0.3,
        length: 1.0,
    };
    let tetrahedron = TriangleMesh {
        positions: vec![DVec3::ZERO, DVec3::X, DVec3::Y, DVec3::Z],
        triangles: vec![[0, 2, 1], [0, 1, 3], [0, 3, 2], [1, 2, 3]],
        ..TriangleMesh::default()
    };
    let slope = (1.0 + 0.25 * 0.25_f64).sqrt();
    let eccentricity = (1.0 - 0.25_f64).sqrt();
    let prolate = 1.0 + asin(eccentricity) / (0.5 * eccentricity);
    let stretched = DAffine3::from_scale(DVec3::new(1.0, 1.0, 2.0));
    let cases = [
        (
            "ball",
            Shape::Sphere { radius: 0.5 },
            DAffine3::IDENTITY,
            PI,
        ),
        (
            "stretched-ball",
            Shape::Sphere { radius: 0.5 },
            stretched,
            0.5 * PI * prolate,
        ),
        ("cylinder", frustum(0.5, 0.5), at(0.0, 0.0, -0.5), 1.5 * PI),
        (
            "cone",
            frustum(0.5, 0.0),
            at(0.1, 0.0, -0.5),
            PI * (0.25 + 0.5 * 1.25_f64.sqrt()),
        ),
        (
            "frustum",
            frustum(0.5, 0.25),
            at(0.0, 0.1, -0.5),
            PI * (0.3125 + 0.75 * slope),
        ),
        ("box", cube, at(0.0, 0.1, -0.5), 2.0 * (0.48 + 0.8 + 0.6)),
        (
            "mesh",
            Shape::Mesh(Arc::new(tetrahedron)),
            at(0.0, 0.0, 0.0),
            1.5 + 0.75_f64.sqrt(),
        ),
    ];
    let mut checks = Vec::new();
    for (name, shape, place, area) in cases {
        let radius = 1.5;
        let arrangement = Arrangement {
            receiver: Receiver::Hollow(radius),
            emitter: (shape, place),
        };
        let expected = 0.25 * FRAC_1_PI * area / (radius * radius);
        let what = format!("factor, inside of a ball to a {name} in it: A/(4 pi R^2)");
        checks.extend(both_ways(
            &format!("factor-around-{name}"),
            &what,
            expected,
            &arrangement,
        ));
    }
    checks
}
