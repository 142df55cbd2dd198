//! Closed rooms, plates and stacks of sheets, by every back end.

use super::*;
use crate::integrator::RayCounts;
use crate::light::Light;
use crate::math::Ray;
use crate::sampler::{Sampler, SamplerKind};
use crate::validation::room::even_sky;

/// Tells `f` the factors of every back end.
fn by_every_method(
    laid: &Laid<'_>,
    n_rays: u32,
    pixels: u32,
    mut f: impl FnMut(FormFactorMethod, &dyn FormFactors),
) {
    for method in [
        FormFactorMethod::Rays,
        FormFactorMethod::Hemicube,
        FormFactorMethod::Analytic,
    ] {
        f(method, &*laid.factors(Means::new(method, n_rays, pixels)));
    }
}

/// C-17, every row of `furnace_and_integrating_enclosure.csv`, by every back end: in a room that shines evenly L/(1 - ρ) to 1e-4, in every
/// patch; a lamp of 10,000 lm in a room of 96 m² gives φ ρ/(S (1 - ρ)) beside its direct light, in the mean, to 2 %: that of the points at
/// which lamps are asked, and of rays.
#[test]
fn furnaces_are_as_in_the_table() {
    let lamp = Light::point(DVec3::new(0.2, 0.1, 0.3), gray(10_000.0));
    let scene = gray_cube(0.5).lit_by(lamp).scene().unwrap();
    let laid = cut(&scene, 100);
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
        let rows = super::rows(&laid, factors, &even(&laid, 0.5));
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
            let shining = even(&laid, rho);
            let solved = gather::solve(&shining, &rows, 1e-6, |_| true);
            assert!(solved.is_converged, "{method:?} {rho}");
            for (patch, light) in shining.iter().zip(solved.irradiance.iter().step_by(2)) {
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
    let laid = cut(&scene, 100);
    let mut patches = even(&laid, 0.5);
    patches[7].sides[0].reflectance = gray(1.0);
    let rays = laid.rays(16);
    let rows = rows(&laid, &rays, &patches);
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
    let thrown = stochastic::solve(&patches, &rays, 4096, 1e-3, &CancelToken::default(), |_| {
        rounds += 1;
        true
    });
    assert!(thrown.is_converged && rounds < 30, "{rounds}");
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
    let laid = cut(&scene, 1 << 20);
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
