//! What is thin, flat, doubled, or no number at all: C-25 to C-29, and singular instances: C-30.

use super::super::check::{Check, Setting, Trouble};
use super::super::worlds::{Random, describe, icosphere, instance, mesh, placed, soup, try_build};
use super::looks::{largest, methods, prepared, seen};
use crate::geometry::{Shape, TriangleMesh};
use crate::math::{PrimitiveId, Ray};
use crate::scene::description::{Group, PlacedShape};
use crate::scene::{Hit, Problem, Scene, SceneError};
use glam::{DAffine3, DMat3, DVec3};

/// A case, the name of a check, what is counted, and how: faults, of which there must be none.
type Counted = (
    &'static str,
    &'static str,
    &'static str,
    fn(&Setting<'_>) -> Result<usize, Trouble>,
);

/// The checks.
pub(super) fn checks() -> Vec<Check> {
    let check = |(case, id, what, count): Counted| {
        let measure = move |setting: &Setting<'_>| Ok(count(setting)? as f64);
        Check::within((id, what), 0.0, 0.0, measure).of_case(case)
    };
    let mut checks: Vec<Check> = COUNTS.into_iter().map(check).collect();
    checks.push(
        Check::within(
            (
                "C-28-floor",
                "a lit floor seen at elevations of 10^-1 to 10^-8: largest relative difference from what is seen from above",
            ),
            0.0,
            crate::math::tolerance::CLOSED_FORM,
            grazing_floor,
        )
        .of_case("28"),
    );
    checks
}

const COUNTS: [Counted; 10] = [
    (
        "25",
        "C-25-layers",
        "20 layers 10^-5, 10^-6 and 10^-7 m apart, 200 slanted rays each through all of them: layers missed or out of order",
        |_| layers_out_of_order(),
    ),
    (
        "26",
        "C-26-coincident",
        "100 coincident triangles, 201 coincident leaves in instances on a plane, from 1, 1e3 and 1e9 m: not found, found twice, or out of order",
        |_| coincident_out_of_order(),
    ),
    (
        "26",
        "C-26-no-area",
        "three triangles without area and a needle of 1:1e6: rays that do not find the needle, or find one of the others",
        |_| without_area_found(),
    ),
    (
        "26",
        "C-26-pictures",
        "the same under a lamp, shining and lit, by every method: samples that are no numbers",
        without_area_seen,
    ),
    (
        "27",
        "C-27-numbers",
        "NaN, infinite and 1e30 corners, radii and places, negative sizes, missing corners: accepted, or refused without the organ",
        |_| impossible_accepted(),
    ),
    (
        "27",
        "C-27-possible",
        "tiny (10^-9), huge (1e9) and very uneven (10^-6 to 1e6, mirrored) placements: refused",
        |_| possible_refused(),
    ),
    (
        "28",
        "C-28-axis-parallel",
        "rays along an axis with ±0 components, from 3 and 1e7 m, at six shapes 0, 1 and 1e5 m away, and at the corners of a grid: missed or not finite",
        |_| axis_parallel_missed(),
    ),
    (
        "28",
        "C-28-grazing",
        "rays that rise or sink by 1 to 10^-19 over a plane, or lie in it: wrongly hit, or not finite",
        |_| grazing_wrong(),
    ),
    (
        "29",
        "C-29-order",
        "ten coincident balls, a hundred rays each, in two builds: organs that differ",
        |_| order_differs(),
    ),
    (
        "30",
        "C-30-singular",
        "flat, point-like and linearly dependent placements of shapes and instances: accepted",
        |_| singular_accepted(),
    ),
];

/// A level square round the origin, `half` to each side.
fn leaf(half: f64, height: f64) -> Shape {
    Shape::Parallelogram {
        corner: DVec3::new(-half, -half, height),
        edge_u: DVec3::X * (2.0 * half),
        edge_v: DVec3::Y * (2.0 * half),
    }
}

fn layers_out_of_order() -> Result<usize, Trouble> {
    let mut wrong = 0;
    for decimals in [1e5, 1e6, 1e7] {
        let gap = 1.0 / decimals;
        let layer = |k: u32| placed(leaf(5.0, -gap * f64::from(k)), DAffine3::IDENTITY, k);
        let scene = try_build((0..20).map(layer).collect())?;
        let mut random = Random(2);
        for _ in 0..200 {
            let start = DVec3::new(0.0, 0.0, 100.0) + random.in_cube();
            let target = random.in_cube() * DVec3::new(4.0, 4.0, 0.0);
            let mut ray = Ray::new(start, (target - start).normalize());
            for k in 0..20 {
                let Some(hit) = scene.closest(&ray) else {
                    wrong += 1;
                    continue;
                };
                let point = scene.surface(&ray, &hit);
                wrong += usize::from(point.organ.0 != k);
                ray = point.spawn_ray(ray.direction);
            }
            wrong += usize::from(scene.closest(&ray).is_some());
        }
    }
    Ok(wrong)
}

/// All that lies along a ray, one after the other.
fn all_along(scene: &Scene, ray: &Ray) -> Vec<Hit> {
    let next = |hit: &Hit| scene.closest_after(ray, hit);
    std::iter::successors(scene.closest(ray), next)
        .take(1000)
        .collect()
}

fn coincident_out_of_order() -> Result<usize, Trouble> {
    let corners = [DVec3::NEG_ONE, DVec3::X * 3.0, DVec3::Y * 3.0];
    let same = mesh(soup(&[corners; 100]));
    let scene = try_build(vec![placed(same, DAffine3::IDENTITY, 0)])?;
    let ray = Ray::new(DVec3::new(0.1, 0.1, 5.0), DVec3::NEG_Z);
    let found = all_along(&scene, &ray);
    let in_order = (0..100).map(PrimitiveId);
    let mut wrong = found.len().abs_diff(100);
    wrong += found
        .iter()
        .zip(in_order)
        .filter(|(hit, expected)| hit.primitive != *expected)
        .count();

    // The same through instances, on a plane and from far away: what rounds differently still comes once each, in order.
    let leaves = Group {
        shapes: (0..20)
            .map(|k| placed(leaf(1.5, 0.0), DAffine3::IDENTITY, k))
            .collect(),
        instances: vec![],
    };
    let turned = |k: u32| instance(0, DAffine3::from_rotation_z(0.1 * f64::from(k)), k);
    let stand = Group {
        shapes: vec![placed(Shape::Plane, DAffine3::IDENTITY, 20)],
        instances: (0..10).map(turned).collect(),
    };
    let scene = Scene::build(describe(vec![leaves, stand]))?;
    for start in [1.0, 1e3, 1e9] {
        let slanted = DVec3::new(0.1, 0.2, -1.0).normalize();
        let found = all_along(&scene, &Ray::new(slanted * -start, slanted));
        let mut primitives: Vec<PrimitiveId> = found.iter().map(|hit| hit.primitive).collect();
        primitives.sort_unstable();
        primitives.dedup();
        wrong += found.len().abs_diff(201) + primitives.len().abs_diff(201);
        wrong += usize::from(!found.is_sorted_by_key(|hit| hit.t));
    }
    Ok(wrong)
}

/// Triangles without area, and a needle.
fn without_area() -> [[DVec3; 3]; 4] {
    [
        [DVec3::ZERO; 3],
        [DVec3::ZERO, DVec3::X, DVec3::X * 2.0],
        [DVec3::ONE, DVec3::ONE, DVec3::ZERO],
        [DVec3::ZERO, DVec3::X * 1e3, DVec3::new(1e3, 0.001, 0.0)],
    ]
}

fn without_area_found() -> Result<usize, Trouble> {
    let corners = without_area();
    let build = |corners: &[[DVec3; 3]]| {
        try_build(vec![placed(mesh(soup(corners)), DAffine3::IDENTITY, 0)])
    };
    let (all, flat) = (build(&corners)?, build(&corners[..3])?);
    let [a, b, c] = corners[3];
    let target = (a + b + c) / 3.0;
    let ray = Ray::new(
        target + DVec3::new(0.0, 0.3, 50.0),
        DVec3::new(0.0, -0.3, -50.0).normalize(),
    );
    let found = all.closest(&ray);
    let is_needle = found.is_some_and(|hit| {
        let normal = all.surface(&ray, &hit).normal_g;
        hit.primitive == PrimitiveId(3) && (normal - DVec3::Z).length() < f64::EPSILON * 64.0
    });
    Ok(usize::from(!is_needle) + usize::from(flat.closest(&ray).is_some()))
}

fn without_area_seen(setting: &Setting<'_>) -> Result<usize, Trouble> {
    use super::super::room::{Room, at, even_sky, gray};
    use crate::light::Light;
    use crate::material::Material;
    let shape = mesh(soup(&without_area()));
    let lamp = Material::lambert(gray(0.5)).emitting(gray(1.0), gray(1.0));
    let room = Room::default()
        .with(shape.clone(), at(0., 0., 0.), lamp)
        .with(shape, at(0., 0., 0.5), Material::leaf(gray(0.4), gray(0.4)))
        .with(
            leaf(2.0, -0.5),
            at(0., 0., 0.),
            Material::lambert(gray(0.5)),
        )
        .lit_by(Light::point(DVec3::new(0.2, 0.1, 2.0), gray(10.0)))
        .under(even_sky(0.3));
    let scene = room.scene()?;
    let mut wrong = 0;
    for (_, method) in methods() {
        let estimator = prepared(&*method, &scene, setting)?;
        let look = |k: u64| {
            let x = (k as f64 + 0.5) / 32.0 - 1.0;
            let ray = Ray::new(DVec3::new(x, 0.0, 3.0), DVec3::NEG_Z);
            seen(&*estimator, &ray, k, 2)
        };
        wrong += (0..64).filter(|k| !look(*k).is_finite()).count();
    }
    Ok(wrong)
}

/// Why a world with this shape in it is refused, and which organ is blamed; `None` if it is not.
fn problem(shape: Shape, to_group: DAffine3) -> Option<(u32, Problem)> {
    let good = placed(Shape::Sphere { radius: 1.0 }, DAffine3::IDENTITY, 0);
    match try_build(vec![good, placed(shape, to_group, 42)]) {
        Err(SceneError::Organ { organ, problem }) => Some((organ.0, problem)),
        _ => None,
    }
}

fn impossible_accepted() -> Result<usize, Trouble> {
    let vertex = |x: f64| mesh(soup(&[[DVec3::new(x, 0.0, 0.0), DVec3::Y, DVec3::Z]]));
    let ball = |radius| Shape::Sphere { radius };
    let moved = |x: f64| DAffine3::from_translation(DVec3::X * x);
    let here = DAffine3::IDENTITY;
    let no_corner = TriangleMesh {
        positions: vec![DVec3::ZERO; 3],
        triangles: vec![[0, 1, 2], [0, 1, 3]],
        ..TriangleMesh::default()
    };
    let is_huge = |problem: &Problem| matches!(problem, Problem::TooLarge { .. });
    let is_no_number = |problem: &Problem| *problem == Problem::NotFinite;
    let is_negative = |problem: &Problem| matches!(problem, Problem::Negative { .. });
    let has_no_corner = |problem: &Problem| *problem == Problem::NoCorner(1);
    type Told<'a> = &'a dyn Fn(&Problem) -> bool;
    let cases: [(Shape, DAffine3, Told<'_>); 10] = [
        (vertex(f64::NAN), here, &is_no_number),
        (vertex(f64::INFINITY), here, &is_no_number),
        (vertex(f64::NEG_INFINITY), here, &is_no_number),
        (ball(f64::NAN), here, &is_no_number),
        (ball(f64::INFINITY), here, &is_no_number),
        (ball(1.0), moved(f64::NAN), &is_no_number),
        (vertex(1e30), here, &is_huge),
        (ball(1.0), moved(1e30), &is_huge),
        (Shape::Disk { radius: -1.0 }, here, &is_negative),
        (mesh(no_corner), here, &has_no_corner),
    ];
    let is_right = |(shape, place, told): &(Shape, DAffine3, Told<'_>)| {
        problem(shape.clone(), *place).is_some_and(|(organ, problem)| organ == 42 && told(&problem))
    };
    Ok(cases.iter().filter(|case| !is_right(case)).count())
}

fn possible_refused() -> Result<usize, Trouble> {
    let scales = [
        DVec3::splat(1.0 / 1e9),
        DVec3::splat(1e9),
        DVec3::new(1.0 / 1e6, 1e6, -1.0),
    ];
    let build = |scale: &DVec3| {
        let ball = placed(
            Shape::Sphere { radius: 1.0 },
            DAffine3::from_scale(*scale),
            0,
        );
        try_build(vec![ball])
    };
    Ok(scales.iter().filter(|scale| build(scale).is_err()).count())
}

fn singular_accepted() -> Result<usize, Trouble> {
    let dependent = DMat3::from_cols(DVec3::X, DVec3::Y, DVec3::X + DVec3::Y);
    let flat = DAffine3::from_scale(DVec3::new(1.0, 0.0, 1.0));
    let maps = [
        flat,
        DAffine3::from_scale(DVec3::ZERO),
        DAffine3::from_mat3(dependent),
    ];
    let is_refused = |map: &DAffine3| {
        let shape = problem(Shape::Sphere { radius: 1.0 }, *map) == Some((42, Problem::Singular));
        let ball = Group {
            shapes: vec![placed(Shape::Sphere { radius: 1.0 }, DAffine3::IDENTITY, 0)],
            instances: vec![],
        };
        let root = Group {
            shapes: vec![],
            instances: vec![instance(0, *map, 42)],
        };
        let built = Scene::build(describe(vec![ball, root]));
        shape && built.is_err()
    };
    Ok(maps.iter().filter(|map| !is_refused(map)).count())
}

/// Closed and flat shapes of sizes near 1 that cover the line x = y = 0.1.
fn covering() -> [Shape; 6] {
    [
        Shape::Sphere { radius: 0.8 },
        Shape::Frustum {
            length: 1.5,
            base_radius: 0.7,
            top_radius: 0.3,
            base_cap: true,
            top_cap: true,
        },
        Shape::Box {
            half_x: 0.5,
            half_y: 0.7,
            length: 0.9,
        },
        Shape::Disk { radius: 0.9 },
        leaf(0.5, 0.1),
        mesh(icosphere(2, 0.9)),
    ]
}

fn axis_parallel_missed() -> Result<usize, Trouble> {
    let mut wrong = 0;
    for shape in covering() {
        // Placed so that the box of the group has faces exactly in the planes of the rays, too.
        for offset in [0.0, 1.0, 1e5] {
            let moved = DAffine3::from_translation(DVec3::splat(offset));
            let scene = try_build(vec![placed(shape.clone(), moved, 0)])?;
            for zeros in [[0.0, 0.0], [-0.0, 0.0], [0.0, -0.0], [-0.0, -0.0]] {
                for distance in [3.0, 1e7] {
                    let start = DVec3::new(0.1, 0.1, distance) + DVec3::splat(offset);
                    let ray = Ray::new(start, DVec3::new(zeros[0], zeros[1], -1.0));
                    let found = scene.closest(&ray);
                    let is_right = found.is_some_and(|hit| {
                        let is_there = hit.t > distance - 2.0 && hit.t < distance + 1.0;
                        is_there && scene.surface(&ray, &hit).position.is_finite()
                    });
                    wrong += usize::from(!is_right);
                }
            }
        }
    }
    // A grid whose corners and edges lie exactly under the rays.
    let corner = |x: i32, y: i32| DVec3::new(f64::from(x), f64::from(y), 0.0);
    let mut triangles = Vec::new();
    for x in -4..4 {
        for y in -4..4 {
            triangles.push([corner(x, y), corner(x + 1, y), corner(x + 1, y + 1)]);
            triangles.push([corner(x, y), corner(x + 1, y + 1), corner(x, y + 1)]);
        }
    }
    let scene = try_build(vec![placed(mesh(soup(&triangles)), DAffine3::IDENTITY, 0)])?;
    for x in -8..=8 {
        for y in -8..=8 {
            let start = DVec3::new(f64::from(x) / 2.0, f64::from(y) / 2.0, 1e6);
            let found = scene.closest(&Ray::new(start, DVec3::NEG_Z));
            wrong += usize::from(found.map(|hit| hit.t) != Some(1e6));
        }
    }
    Ok(wrong)
}

fn grazing_wrong() -> Result<usize, Trouble> {
    let above = DAffine3::from_translation(DVec3::Z * 5.0);
    let scene = try_build(vec![
        placed(Shape::Plane, DAffine3::IDENTITY, 0),
        placed(Shape::Sphere { radius: 1.0 }, above, 1),
    ])?;
    let mut wrong = 0;
    for k in 0..20 {
        let tilt = if k == 0 { 0.0 } else { 10.0_f64.powi(-k) };
        for sign in [1.0, -1.0] {
            let direction = DVec3::new(1.0, 0.0, tilt * sign).normalize();
            let found = scene.closest(&Ray::new(DVec3::Z * 0.001, direction));
            let is_right = match found {
                Some(hit) => hit.t.is_finite() && sign < 0.0 && tilt > 0.0,
                None => sign > 0.0 || tilt == 0.0,
            };
            wrong += usize::from(!is_right);
        }
    }
    let within = Ray::new(DVec3::ZERO, DVec3::X);
    Ok(wrong + usize::from(scene.closest(&within).is_some()))
}

/// A matt floor under parallel light looks the same from everywhere.
fn grazing_floor(setting: &Setting<'_>) -> Result<f64, Trouble> {
    use super::super::room::{Room, at, gray};
    use crate::light::Light;
    use crate::material::Material;
    let light = Light::Directional {
        direction: DVec3::new(0.6, 0.0, -0.8),
        irradiance: gray(10.0),
        origin: DVec3::Z * 1e12,
    };
    let scene = Room::default()
        .with(Shape::Plane, at(0., 0., 0.), Material::lambert(gray(0.5)))
        .lit_by(light)
        .scene()?;
    let mut all = Vec::new();
    for (name, method) in methods() {
        // The indirect light of an endless plane by photons and patches is nothing, but only nearly.
        if ["photon", "radiosity"].contains(&name) {
            continue;
        }
        let estimator = prepared(&*method, &scene, setting)?;
        let look = |tilt: f64| {
            let ray = Ray::new(DVec3::Z, DVec3::new(0.0, 1.0, -tilt).normalize());
            seen(&*estimator, &ray, 1, 2).g
        };
        let above = look(1e3);
        all.extend((1..=8).map(|k| (look(10.0_f64.powi(-k)) / above - 1.0).abs()));
    }
    Ok(largest(all))
}

fn order_differs() -> Result<usize, Trouble> {
    let ball = |k: u32| placed(Shape::Sphere { radius: 1.0 }, DAffine3::IDENTITY, k);
    let build = || try_build((0..10).map(ball).collect::<Vec<PlacedShape>>());
    let (one, other) = (build()?, build()?);
    let mut random = Random(4);
    let mut wrong = 0;
    for _ in 0..100 {
        let start = random.direction() * 3.0;
        let ray = Ray::new(start, (random.in_cube() * 0.4 - start).normalize());
        let organ = |scene: &Scene| {
            scene
                .closest(&ray)
                .map(|hit| scene.surface(&ray, &hit).organ.0)
        };
        let (a, b) = (organ(&one), organ(&other));
        wrong += usize::from(a != b || a != Some(0));
    }
    Ok(wrong)
}
