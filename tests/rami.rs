//! A published benchmark: the bidirectional reflectance factor (BRF) of the RAMI-3 canopy HET01 (15 spheres of 49,999 leaf
//! discs over soil, near infrared, sun at 20°) in the principal plane.
//!
//! The reference is Eradiate's (see the head of `tests/refdata/rami3_het01_brfpp_eradiate.csv`), itself validated against
//! the RAMI consensus. The usual run takes 13 of the 76 angles. `UNDERSTORY_FULL=1 cargo test --release --test rami --
//! --nocapture` takes all of them with eight times the samples, and prints every angle.

#![allow(
    clippy::unwrap_used,
    clippy::print_stdout,
    reason = "a test may panic and print"
)]

use glam::{DAffine3, DQuat, DVec2, DVec3};
use rayon::prelude::*;
use std::f64::consts::PI;
use understory::color::Rgb;
use understory::geometry::Shape;
use understory::integrator::{
    CancelToken, Integrator, Path, RadianceEstimator, RayCounts, RenderContext,
};
use understory::light::Light;
use understory::material::Material;
use understory::math::stats::{RunningStats, combined_error};
use understory::math::{Ray, rng};
use understory::sampler::{Sampler, SamplerKind, Use};
use understory::scene::Scene;
use understory::scene::description::{
    Group, GroupId, Instance, MaterialId, OrganId, PlacedShape, SceneDescription,
};

/// Edge of the square cell that is repeated, metres.
const CELL: f64 = 100.0;
/// Copies of the cell on each side; the reference used as many.
const PADDING: i32 = 20;
/// Height of the target plane, metres.
const TARGET_HEIGHT: f64 = 30.0;
/// Irradiance of the sun on a facing surface, W/m².
const SUN: f64 = 10.0;
/// Independent blocks of samples per angle; their spread is the standard error.
const BLOCKS: u64 = 64;

/// Relative standard error of the reference: the scatter of its neighbouring angles about a smooth curve, away from the
/// hot spot (root mean square third difference / √20). Its own variance column is smaller than that scatter.
const REFERENCE_ERROR: f64 = 0.0007;

/// Rows of a table in `tests/refdata`, without comments and header.
fn table(name: &str) -> Vec<Vec<f64>> {
    let path = format!("{}/tests/refdata/{name}", env!("CARGO_MANIFEST_DIR"));
    let text = std::fs::read_to_string(path).unwrap();
    let lines = text.lines().filter(|line| !line.starts_with('#')).skip(1);
    lines
        .map(|line| {
            line.split(',')
                .map(|cell| cell.trim().parse().unwrap())
                .collect()
        })
        .collect()
}

fn to_sun() -> DVec3 {
    let zenith = 20.0_f64.to_radians();
    DVec3::new(zenith.sin(), 0.0, zenith.cos())
}

fn canopy() -> Scene {
    let organ = OrganId(0);
    let discs = table("rami3_het01_sphere_discs.csv");
    assert_eq!(discs.len(), 49_999);
    let disc = |row: &Vec<f64>| {
        let normal = DVec3::new(row[4], row[5], row[6]).normalize();
        let turn = DQuat::from_rotation_arc(DVec3::Z, normal);
        PlacedShape {
            shape: Shape::Disk { radius: row[0] },
            to_group: DAffine3::from_rotation_translation(turn, DVec3::new(row[1], row[2], row[3])),
            material: MaterialId(0),
            organ,
        }
    };
    let sphere = Group {
        shapes: discs.iter().map(disc).collect(),
        instances: vec![],
    };
    let centre = |row: &Vec<f64>| Instance {
        group: GroupId(0),
        to_group: DAffine3::from_translation(DVec3::new(row[0], row[1], row[2])),
        organ,
    };
    let centres = table("rami3_het01_sphere_centres.csv");
    assert_eq!(centres.len(), 15);
    let cell = Group {
        shapes: vec![],
        instances: centres.iter().map(centre).collect(),
    };
    let copies = -PADDING..=PADDING;
    let cells = copies
        .clone()
        .flat_map(|x| copies.clone().map(move |y| (x, y)));
    let world = cells.map(|(x, y)| Instance {
        group: GroupId(1),
        to_group: DAffine3::from_translation(CELL * DVec3::new(f64::from(x), f64::from(y), 0.0)),
        organ,
    });
    let soil = PlacedShape {
        shape: Shape::Plane,
        to_group: DAffine3::IDENTITY,
        material: MaterialId(1),
        organ,
    };
    Scene::build(SceneDescription {
        materials: vec![
            Material::leaf(Rgb::splat(0.4957), Rgb::splat(0.4409)),
            Material::lambert(Rgb::splat(0.159)),
        ],
        groups: vec![
            sphere,
            cell,
            Group {
                shapes: vec![soil],
                instances: world.collect(),
            },
        ],
        root: Some(GroupId(2)),
        lights: vec![Light::Directional {
            direction: -to_sun(),
            irradiance: Rgb::splat(SUN),
            origin: to_sun() * 1e5,
        }],
        ..SceneDescription::default()
    })
    .unwrap()
}

/// BRF seen from the zenith angle `vza` (degrees, negative on the side of the sun), averaged over the target plane.
fn brf(estimator: &dyn RadianceEstimator, vza: f64, samples_per_block: u32) -> RunningStats {
    let zenith = vza.to_radians();
    let down = -DVec3::new(-zenith.sin(), 0.0, zenith.cos());
    let block = |block: u64| {
        let stream = rng::hash(&[0xE7_01, vza.to_bits(), block]);
        let mut rays = RayCounts::default();
        let mut sum = 0.0;
        for index in 0..samples_per_block {
            let mut sampler = Sampler::new(SamplerKind::OwenSobol, stream, index);
            let at = (sampler.point(Use::Direction) - DVec2::splat(0.5)) * CELL;
            let ray = Ray::new(at.extend(TARGET_HEIGHT), down);
            sum += estimator.incident_radiance(&ray, &mut sampler, &mut rays).g;
        }
        PI * sum / f64::from(samples_per_block) / (SUN * to_sun().z)
    };
    let blocks: Vec<f64> = (0..BLOCKS).into_par_iter().map(block).collect();
    blocks.into_iter().collect()
}

#[test]
fn het01_principal_plane() {
    let is_full = std::env::var("UNDERSTORY_FULL").is_ok_and(|value| value == "1");
    let (step, samples_per_block) = if is_full { (1, 4096) } else { (6, 512) };
    let scene = canopy();
    let cancel = CancelToken::default();
    let context = RenderContext {
        seed: 0,
        cancel: &cancel,
        progress: &|_| {},
    };
    let estimator = Path::default().prepare(&scene, &context).unwrap();

    let reference = table("rami3_het01_brfpp_eradiate.csv");
    assert_eq!(reference.len(), 76);
    let mut z_scores = Vec::new();
    for row in reference.iter().step_by(step) {
        let (vza, expected) = (row[0], row[2]);
        let seen = brf(&*estimator, vza, samples_per_block);
        let blind = seen.standard_error() / seen.mean();
        let error = combined_error(seen.standard_error(), REFERENCE_ERROR * expected);
        let z = (seen.mean() - expected) / error;
        println!(
            "vza {vza:6.1}: {:.5} ± {blind:.3e}, reference {expected:.5}, z {z:5.2}",
            seen.mean()
        );
        assert!(blind <= 0.01, "vza {vza}: standard error {blind}");
        z_scores.push(z);
    }
    let worst = z_scores.iter().fold(0.0_f64, |worst, z| worst.max(z.abs()));
    let chi: f64 = z_scores.iter().map(|z| z * z).sum();
    println!(
        "{} angles: largest |z| {worst:.2}, chi² {chi:.1}",
        z_scores.len()
    );
    assert!(z_scores.len() >= 9);
    assert!(worst <= 4.0, "largest |z| {worst}");
}
