//! Closed rooms, plates and stacks of sheets, by every back end.

use super::factors::METHODS;
use super::*;
use crate::integrator::RayCounts;
use crate::light::Light;
use crate::math::Ray;
use crate::sampler::{Sampler, SamplerKind};
use crate::validation::room::even_sky;
use std::f64::consts::PI;

/// Tells `f` the factors of every back end.
fn by_every_method(
    laid: &Laid<'_>,
    n_rays: u32,
    pixels: u32,
    mut f: impl FnMut(FormFactorMethod, &dyn FormFactors),
) {
    for method in METHODS {
        f(method, &*laid.factors(method, n_rays, pixels));
    }
}

fn sum(row: &Row) -> f64 {
    row.entries().map(|(_, factor)| factor.g).sum()
}

/// A closed room with round things in it, coarse enough to be looked at as a whole.
fn furnished() -> Room {
    let ball = Shape::Sphere { radius: 0.4 };
    let stretched = at(0.4, 0.4, -0.3) * DAffine3::from_scale(DVec3::new(1.0, 0.5, 0.7));
    gray_cube(0.5)
        .with(ball, stretched, Material::default())
        .with(square(0.4), at(-0.5, -0.5, 0.1), Material::default())
}

/// C-13, C-14, C-15: whatever the resolution, all of a row arrives somewhere, and nothing on the wall itself. A crack between the
/// polygons that are drawn would lose some.
#[test]
fn rows_are_whole_and_flat_walls_do_not_see_themselves() {
    let scene = furnished().scene().unwrap();
    let laid = Laid::cut(&scene, 300);
    let is_whole = |factors: &dyn FormFactors, what: &str, step: usize, most_lost: f64| {
        for (patch, node) in laid.mesh.patches.iter().enumerate().step_by(step) {
            let row = factors.row(*node, 0);
            let lost = 1.0 - sum(&row);
            assert!(lost > -1e-5 && lost < most_lost, "{what}, {patch}: {lost}");
            let chart = |patch: usize| {
                let node = laid.mesh.patches[patch];
                laid.mesh.nodes[node as usize].cell.chart
            };
            let is_flat = laid.mesh.charts[chart(patch) as usize].chart.is_flat();
            for (side, factor) in row.entries().filter(|_| is_flat) {
                let is_own = chart(side / 2) == chart(patch);
                assert!(
                    !is_own && factor.g <= 1.0,
                    "{what}, {patch}: {factor:?} of {side}"
                );
            }
        }
    };
    for pixels in [1, 2, 7, 32] {
        by_every_method(&laid, pixels * pixels, pixels, |method, factors| {
            // Beside closed forms few rays may find nothing that shares the rest.
            let is_few = method == FormFactorMethod::Analytic && pixels < 32;
            let most_lost = if is_few { 1.0 } else { 1e-5 };
            is_whole(factors, &format!("{method:?} {pixels}"), 29, most_lost);
        });
    }
    let fine = Hemicubes::new(&laid.mesh, &laid.carrier, 1, 1024, 1, None);
    is_whole(&fine, "hemicube of 1024", 200, 1e-5);
}

/// C-8: on the inside of a ball every patch gives every other A/4πR², itself included. Rays: the mean square of differences is that of
/// counts; hemicubes: pixels, and facets for patches, allow for 1 % of the view. C-12 follows for these; in a room with
/// things in it, both ways agree within five standard errors of rays, one wrong alarm in 1,000 rooms. Hemicubes stand for points: between
/// near patches of other sizes theirs differ, as Cohen and Greenberg's do.
#[test]
fn exchange_is_even_in_a_ball_and_the_same_both_ways() {
    let ball = Room::default().with(
        Shape::Sphere { radius: 2.0 },
        DAffine3::IDENTITY,
        Material::default(),
    );
    let scene = ball.scene().unwrap();
    let laid = Laid::cut(&scene, 32);
    let n_rays = 2048;
    by_every_method(&laid, n_rays, 32, |method, factors| {
        let (mut squares, mut n, mut largest) = (0.0, 0.0, 0.0_f64);
        for from in &laid.mesh.patches {
            let row: Vec<(usize, f64)> = factors
                .row(*from, 1)
                .entries()
                .map(|(side, f)| (side, f.g))
                .collect();
            for (to, node) in laid.mesh.patches.iter().enumerate() {
                let expected = laid.mesh.nodes[*node as usize].area / (16.0 * PI);
                let found = row
                    .iter()
                    .find(|(side, _)| *side == 2 * to + 1)
                    .map_or(0.0, |(_, f)| *f);
                squares +=
                    (found - expected).powi(2) / (expected * (1.0 - expected) / f64::from(n_rays));
                largest = largest.max((found - expected).abs());
                n += 1.0;
            }
        }
        match method {
            FormFactorMethod::Hemicube => assert!(largest < 0.01, "{largest}"),
            FormFactorMethod::Rays | FormFactorMethod::Analytic => {
                // Stratified rays do better than counts.
                assert!(squares / n < 1.2, "{method:?}: {}", squares / n);
            }
        }
    });

    let scene = furnished().scene().unwrap();
    let laid = Laid::cut(&scene, 100);
    for method in [FormFactorMethod::Rays, FormFactorMethod::Analytic] {
        let factors = laid.factors(method, n_rays, 32);
        let rows: Vec<Row> = laid
            .mesh
            .patches
            .iter()
            .map(|node| factors.row(*node, 0))
            .collect();
        let areas: Vec<f64> = laid
            .mesh
            .patches
            .iter()
            .map(|node| laid.mesh.nodes[*node as usize].area)
            .collect();
        let factor = |from: usize, to: usize| {
            let found = rows[from].entries().find(|(side, _)| *side == 2 * to);
            found.map_or(0.0, |(_, factor)| factor.g)
        };
        for one in 0..rows.len() {
            for other in 0..one {
                let (there, back) = (factor(one, other), factor(other, one));
                let off = (areas[one] * there - areas[other] * back).abs();
                // At least one count: what is rarer may be missed one way.
                let error = |f: f64| (f.max(1.0 / f64::from(n_rays)) / f64::from(n_rays)).sqrt();
                let errors = areas[one] * error(there) + areas[other] * error(back);
                assert!(
                    off < 5.0 * errors,
                    "{method:?}: {one} {other} {there} {back}"
                );
            }
        }
    }
}

/// C-16: two plates a thousandth of their width apart light each other as endless ones: B₁ = (E₁ + ρ₁ E₂)/(1 - ρ₁ ρ₂), to 1 %.
#[test]
fn close_plates_are_endless() {
    let (rho, shine) = ([0.5, 0.8], [1.0, 3.0]);
    let plate = |k: usize| Material::lambert(gray(rho[k]));
    let scene = Room::default()
        .with(square(0.5), at(0.0, 0.0, 0.0), plate(0))
        .with(
            square(0.5),
            at(0.0, 0.0, 1e-3) * DAffine3::from_rotation_x(PI),
            plate(1),
        )
        .scene()
        .unwrap();
    let laid = Laid::cut(&scene, 100);
    // What shines sends by itself what it sends when light of 1/ρ of that falls on it.
    let chart = |patch: usize| {
        laid.mesh.nodes[laid.mesh.patches[patch] as usize]
            .cell
            .chart as usize
    };
    let mut patches = laid.patches(0.0, |_| 0.0);
    for (at, patch) in patches.iter_mut().enumerate() {
        let k = chart(at);
        patch.sides[0].reflectance = gray(rho[k]);
        patch.sides[0].source = gray(shine[k] / rho[k]);
    }
    by_every_method(&laid, 64, 16, |method, factors| {
        let rows = laid.rows(factors, &patches);
        let solved = gather::solve(&patches, &rows, 1e-5, |_| true);
        for k in 0..2 {
            let expected = (shine[k] + rho[k] * shine[1 - k]) / (1.0 - rho[0] * rho[1]);
            let own = (0..patches.len()).filter(|at| chart(*at) == k);
            let sent: Vec<f64> = own.map(|at| solved.radiosity[2 * at].g).collect();
            let mean = sent.iter().sum::<f64>() / sent.len() as f64;
            assert!(
                (mean / expected - 1.0).abs() < 0.01,
                "{method:?}: {mean} {expected}"
            );
        }
    });
}

/// C-17, every row of `furnace_and_integrating_enclosure.csv`, by every back end: in a room that shines evenly L/(1 - ρ) to 1e-4, in every
/// patch; a lamp of 10,000 lm in a room of 96 m² gives φ ρ/(S (1 - ρ)) beside its direct light, in the mean, to 2 %: that of the points at
/// which lamps are asked, and of rays.
#[test]
fn furnaces_are_as_in_the_table() {
    let lamp = Light::point(DVec3::new(0.2, 0.1, 0.3), gray(10_000.0));
    let scene = gray_cube(0.5).lit_by(lamp).scene().unwrap();
    let laid = Laid::cut(&scene, 100);
    let sources = Sources::new(&scene);
    let cancel = CancelToken::default();
    let lighting = Lighting {
        mesh: &laid.mesh,
        carrier: &laid.carrier,
        sources: &sources,
        seed: 1,
        bounces: true,
        dark: &vec![false; laid.mesh.charts.len()],
        n_stray: 0,
        cancel: &cancel,
    };
    let lit = lighting.patches();
    let table = include_str!("../../../validation/tables/furnace_and_integrating_enclosure.csv");
    let rows = table.lines().filter(|line| !line.starts_with('#')).skip(1);
    let table: Vec<Vec<f64>> = rows
        .map(|line| line.split(',').map(|x| x.parse().unwrap()).collect())
        .collect();
    assert!(table.len() >= 13);
    by_every_method(&laid, 128, 16, |method, factors| {
        let rows = laid.rows(factors, &laid.patches(0.5, |_| 1.0));
        for (patch, row) in rows.iter().enumerate().step_by(2) {
            let front = row.entries().filter(|(at, _)| at % 2 == 0);
            let met: f64 = front.map(|(_, factor)| factor.g).sum();
            assert!(
                (met - 1.0).abs() < 1e-5,
                "{method:?} {patch}: {met}, {row:?}"
            );
        }
        for row in &table {
            let (rho, indirect) = (row[0], row[6]);
            let even = laid.patches(rho, |_| 1.0);
            let solved = gather::solve(&even, &rows, 1e-6, |_| true);
            assert!(solved.is_converged, "{method:?} {rho}");
            for (patch, light) in even.iter().zip(solved.irradiance.iter().step_by(2)) {
                let total = patch.sides[0].source.g + if rho > 0.0 { light.g } else { 0.0 };
                assert!(
                    (total / row[1] - 1.0).abs() < 1e-4,
                    "{method:?} {rho}: {total}"
                );
            }
            let lamp: Vec<Patch> = (lit.iter())
                .map(|patch| {
                    let mut patch = *patch;
                    patch.sides[0].reflectance = gray(rho);
                    patch
                })
                .collect();
            let solved = gather::solve(&lamp, &rows, 1e-6, |_| true);
            let of_each = lamp.iter().zip(solved.irradiance.iter().step_by(2));
            let power: f64 = of_each.map(|(patch, light)| patch.area * light.g).sum();
            // The room is half as wide as that of the table.
            let expected = 4.0 * indirect;
            let found = if rho > 0.0 { power / 24.0 } else { 0.0 };
            assert!(
                (found - expected).abs() <= 0.02 * expected,
                "{method:?} {rho}: {found} {expected}"
            );
        }
    });
}

/// One white patch, as lamps often are, does not keep solvers from seeing the end; what they then say is left is about what is left.
#[test]
fn a_white_patch_does_not_hold_up_solvers() {
    let scene = gray_cube(0.5).scene().unwrap();
    let laid = Laid::cut(&scene, 100);
    let mut patches = laid.patches(0.5, |_| 1.0);
    patches[7].sides[0].reflectance = gray(1.0);
    let rays = laid.rays(16);
    let rows = laid.rows(&rays, &patches);
    let exact = gather::solve(&patches, &rows, 1e-12, |_| true);
    let mut sweeps = 0;
    let solved = gather::solve(&patches, &rows, 1e-3, |_| {
        sweeps += 1;
        true
    });
    assert!(solved.is_converged && sweeps < 20, "{sweeps}");
    assert!(
        solved.residual > 0.0 && solved.residual <= 1e-3,
        "{}",
        solved.residual
    );
    let all = system::power(&patches, &exact.radiosity);
    let left = (all - system::power(&patches, &solved.radiosity)).abs() / all;
    assert!(left < 2e-3, "{left}");
    let mut rounds = 0;
    let thrown = stochastic::solve(&patches, &rays, 4096, 1e-3, |_| {
        rounds += 1;
        true
    });
    assert!(thrown.is_converged && rounds < 30, "{rounds}");
}

/// C-20: depth 0 leaves patches as they are; a threshold of 0 ends at the depth, and at the memory whatever the depth.
#[test]
fn splitting_ends() {
    let scene = gray_cube(0.5).scene().unwrap();
    let light = |mesh: &Mesh, first: usize| -> Vec<[Rgb; 2]> {
        let nodes = first..mesh.nodes.len();
        nodes.map(|at| [gray((at % 7) as f64); 2]).collect()
    };
    let cancel = CancelToken::default();
    for (depth, most) in [(0, 1 << 20), (1, 1 << 20), (30, 2000)] {
        let mut mesh = Laid::cut(&scene, 60).mesh;
        let n = mesh.patches.len();
        let refinement = Refinement {
            threshold: 0.0,
            depth,
            most,
            size: 2.0,
            cancel: &cancel,
        };
        let mut irradiance = light(&mesh, 0);
        refine::refine(
            &mut mesh,
            &mut irradiance,
            &refinement,
            &vec![1.0; n],
            light,
        );
        let elements = mesh.elements().count();
        match depth {
            0 | 1 => assert_eq!(elements, n << (2 * depth)),
            _ => assert!(elements > 4 * n && mesh.nodes.len() <= most, "{elements}"),
        }
        assert_eq!(irradiance.len(), mesh.nodes.len());
    }
}

/// Every row of `infinite_sheet_stack.csv`, by every solver and every back end: what endless leaves over soil reflect under an even sky, to
/// 2 %: the noise of rays, of the points at which the sky is asked, and of the view.
#[test]
fn stacks_of_leaves_reflect_what_they_should() {
    let table = include_str!("../../../validation/tables/infinite_sheet_stack.csv");
    let rows = table.lines().filter(|line| !line.starts_with('#')).skip(1);
    let cancel = CancelToken::default();
    let context = RenderContext {
        seed: 3,
        cancel: &cancel,
        progress: &|_| {},
    };
    let ways = [
        (Solver::Gather, FormFactorMethod::Rays),
        (Solver::Shoot, FormFactorMethod::Rays),
        (Solver::Stochastic, FormFactorMethod::Rays),
        (Solver::Gather, FormFactorMethod::Hemicube),
        (Solver::Gather, FormFactorMethod::Analytic),
    ];
    let mut n_rows = 0;
    for row in rows {
        let numbers: Vec<f64> = row.split(',').map_while(|x| x.parse().ok()).collect();
        let [n, rho, tau, soil, back] = numbers[..5] else {
            panic!("{row}")
        };
        let ground = Material::lambert(gray(soil));
        let mut room = Room::default().with(Shape::Plane, at(0., 0., 0.), ground);
        for k in 1..=n as u32 {
            let leaf = Material::leaf(gray(rho), gray(tau));
            room = room.with(Shape::Plane, at(0., 0., f64::from(k)), leaf);
        }
        let scene = room.under(even_sky(1.0)).scene().unwrap();
        for (solver, form_factors) in ways {
            let radiosity = Radiosity {
                solver: Some(solver),
                form_factors,
                hemicube_pixels: 32,
                ..Radiosity::default()
            };
            let solved = radiosity.prepare(&scene, &context).unwrap();
            let down = Ray::new(DVec3::Z * (n + 1.0), DVec3::new(0.3, 0.2, -1.0).normalize());
            let n_samples = 512;
            let seen = |index| {
                let mut sampler = Sampler::new(SamplerKind::OwenSobol, 5, index);
                solved
                    .incident_radiance(&down, &mut sampler, &mut RayCounts::default())
                    .g
            };
            let found = (0..n_samples).map(seen).sum::<f64>() / f64::from(n_samples);
            assert!(
                (found - back).abs() <= 0.02 * back,
                "{solver:?} {form_factors:?} {row}: {found}"
            );
        }
        n_rows += 1;
    }
    assert_eq!(n_rows, 14);
}

/// Cells of endless ground are huge: solvers still go on until leaves above it have their light, and cells count little more than
/// patches of leaves. Two leaves that face each other over bright ground have what two equations with two unknowns say.
#[test]
fn endless_ground_does_not_hide_what_stands_on_it() {
    let rho = 0.9;
    let patch = |area: f64, source: f64| Patch {
        area,
        weight: area.min(4.0),
        sides: [
            PatchSide {
                reflectance: gray(rho),
                source: gray(source),
                ..PatchSide::default()
            },
            PatchSide::default(),
        ],
    };
    let patches = [patch(1e9, 1.0), patch(1.0, 0.0), patch(1.0, 0.0)];
    let row = |other: u32| Row::of(vec![(0, gray(0.5)), (other, gray(0.5))]);
    let none = Row::default;
    let rows = [none(), none(), row(4), none(), row(2), none()];
    let solved = gather::solve(&patches, &rows, 1e-3, |_| true);
    // H = (B + ρ H)/2 with B = ρ of the ground.
    let expected = 0.5 * rho / (1.0 - 0.5 * rho);
    for side in [2, 4] {
        let found = solved.irradiance[side].g;
        assert!((found / expected - 1.0).abs() < 5e-3, "{found} {expected}");
    }

    let leaf = at(0.0, 0.0, 1.0);
    let scene = Room::default()
        .with(Shape::Plane, DAffine3::IDENTITY, Material::default())
        .with(square(0.1), leaf, Material::default())
        .scene()
        .unwrap();
    let laid = Laid::new(&scene);
    let (sources, cancel) = (Sources::new(&scene), CancelToken::default());
    let lighting = Lighting {
        mesh: &laid.mesh,
        carrier: &laid.carrier,
        sources: &sources,
        seed: 1,
        bounces: true,
        dark: &vec![false; laid.mesh.charts.len()],
        n_stray: 0,
        cancel: &cancel,
    };
    let patches = lighting.patches();
    let largest = |of: fn(&Patch) -> f64| patches.iter().map(of).fold(0.0, f64::max);
    assert!(largest(|patch| patch.area) > 1.0 && largest(|patch| patch.weight) < 1e-2);
}

/// Rows that are known.
struct Known(Vec<Row>);

impl FormFactors for Known {
    fn row(&self, node: u32, side: usize) -> Row {
        self.0[2 * node as usize + side].clone()
    }
}

/// C-20b: where patches differ in size shooting finds the same as gathering, by the same rows: what a large one shoots into a small
/// one counts for more there.
#[test]
fn shooting_and_gathering_agree_between_large_and_small() {
    let patch = |area: f64, source: f64| Patch {
        area,
        weight: area,
        sides: [
            PatchSide {
                reflectance: gray(0.6),
                source: gray(source),
                ..PatchSide::default()
            },
            PatchSide::default(),
        ],
    };
    let patches = [patch(1.0, 2.0), patch(8.0, 0.5)];
    let rows = Known(vec![
        Row::of(vec![(2, gray(0.8))]),
        Row::default(),
        Row::of(vec![(0, gray(0.1))]),
        Row::default(),
    ]);
    let gathered = gather::solve(&patches, &rows.0, 1e-6, |_| true);
    let shots = shoot::Shots {
        factors: &rows,
        nodes: &[0, 1],
        room: 1 << 20,
    };
    let shot = shoot::solve(&patches, &shots, 1e-6, |_| true);
    for side in [0, 2] {
        let (found, expected) = (shot.irradiance[side].g, gathered.irradiance[side].g);
        assert!((found / expected - 1.0).abs() < 1e-4, "{found} {expected}");
    }
}
