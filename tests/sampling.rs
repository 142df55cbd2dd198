//! Every sampler against the density it claims: χ² of many samples over cells whose probabilities are integrated
//! numerically, and the density's integral.

#![allow(clippy::unwrap_used, reason = "a test may panic")]

use glam::{DVec2, DVec3};
use std::f64::consts::{PI, TAU};
use understory::color::Rgb;
use understory::light::{Dome, Environment, Sky, SunDisk};
use understory::material::{Density, Material, ScatterNumbers, ScatteringFrame, Side, Transport};
use understory::math::angle::Angle;
use understory::math::frame::Frame;
use understory::math::stats::chi_squared_upper_tail;
use understory::math::{rng, warp};

/// False-alarm probability of each χ² test here; about twenty are made.
const FALSE_ALARM: f64 = 1e-6 / 20.0;

/// Cells over the sphere: rows of equal height, columns of equal azimuth.
const ROWS: usize = 20;
const COLUMNS: usize = 24;

fn uniform(i: u64) -> DVec2 {
    let [a, b] = [0, 1].map(|k| rng::unit_f64(rng::hash(&[0x5A17, i, k])));
    DVec2::new(a, b)
}

fn cell(w: DVec3) -> usize {
    let turn = (w.y.atan2(w.x) / TAU).rem_euclid(1.0);
    let row = ((0.5 * (w.z + 1.0)) * ROWS as f64) as usize;
    let column = (turn * COLUMNS as f64) as usize;
    row.min(ROWS - 1) * COLUMNS + column.min(COLUMNS - 1)
}

/// Probability of each cell, by the midpoint rule on `fine` × `fine` points per cell.
fn integrate(pdf: impl Fn(DVec3) -> f64, fine: usize) -> Vec<f64> {
    let weight = 4.0 * PI / (ROWS * COLUMNS * fine * fine) as f64;
    let mut cells = vec![0.0; ROWS * COLUMNS];
    for row in 0..ROWS * fine {
        for column in 0..COLUMNS * fine {
            let z = 2.0 * (row as f64 + 0.5) / (ROWS * fine) as f64 - 1.0;
            let turn = (column as f64 + 0.5) / (COLUMNS * fine) as f64;
            let w = warp::direction(z, turn);
            cells[(row / fine) * COLUMNS + column / fine] += pdf(w) * weight;
        }
    }
    cells
}

/// p-value of the samples' cells under these probabilities; cells that expect fewer than five are pooled.
fn p_value(counts: &[u32], probabilities: &[f64], n: u32) -> f64 {
    let (mut chi, mut degrees) = (0.0, -1.0);
    let (mut pooled_count, mut pooled) = (0.0, 0.0);
    for (count, probability) in counts.iter().zip(probabilities) {
        let expected = probability * f64::from(n);
        if expected < 5.0 {
            pooled_count += f64::from(*count);
            pooled += expected;
        } else {
            chi += (f64::from(*count) - expected).powi(2) / expected;
            degrees += 1.0;
        }
    }
    if pooled > 5.0 {
        chi += (pooled_count - pooled).powi(2) / pooled;
        degrees += 1.0;
    } else if pooled_count > pooled + 30.0 {
        return 0.0;
    }
    chi_squared_upper_tail(chi, degrees)
}

/// Checks a sampler of directions; `fine` is how finely its density is integrated within a cell.
fn check(
    name: &str,
    sample: impl Fn(DVec2) -> Option<DVec3>,
    pdf: impl Fn(DVec3) -> f64,
    fine: usize,
) {
    let n = 60_000;
    let mut counts = vec![0_u32; ROWS * COLUMNS];
    for i in 0..n {
        let w = sample(uniform(u64::from(i))).unwrap_or_else(|| panic!("{name}: no sample"));
        assert!((w.length() - 1.0).abs() < 1e-12, "{name}: {w}");
        assert!(pdf(w) > 0.0, "{name}: sampled {w} where the density is 0");
        counts[cell(w)] += 1;
    }
    let probabilities = integrate(&pdf, fine);
    let total: f64 = probabilities.iter().sum();
    assert!(
        (total - 1.0).abs() < 2e-3,
        "{name}: the density integrates to {total}"
    );
    let p = p_value(&counts, &probabilities, n);
    assert!(p > FALSE_ALARM, "{name}: p = {p}");

    // The twin: a sampler that is stuck in one direction for 2 % of its numbers is caught.
    let stuck = cell(sample(DVec2::new(0.3, 0.3)).unwrap());
    for i in (0..n).step_by(50) {
        counts[cell(sample(uniform(u64::from(i))).unwrap())] -= 1;
        counts[stuck] += 1;
    }
    let p = p_value(&counts, &probabilities, n);
    assert!(p < FALSE_ALARM, "{name}: the planted fault has p = {p}");
}

#[test]
fn warps() {
    check(
        "sphere",
        |u| Some(warp::sphere(u)),
        |_| warp::sphere_pdf_solid_angle(),
        2,
    );
    let cosine = |w: DVec3| warp::cosine_hemisphere_pdf_solid_angle(w.z);
    check(
        "cosine hemisphere",
        |u| Some(warp::cosine_hemisphere(u)),
        cosine,
        16,
    );
    let angle: f64 = 1.1;
    let frame = Frame::from_normal(DVec3::new(0.48, -0.6, 0.64));
    let inside = |w: DVec3| {
        if frame.normal.dot(w) >= angle.cos() {
            1.0 / warp::cone_solid_angle(angle)
        } else {
            0.0
        }
    };
    check(
        "cone",
        |u| Some(frame.to_world(warp::cone(u, angle)).normalize()),
        inside,
        40,
    );
}

/// Samples of the square to the disk and the triangle, over cells of equal area.
#[test]
fn flat_warps() {
    let n = 60_000;
    let (mut disk, mut triangle) = (vec![0_u32; 64], vec![0_u32; 64]);
    for i in 0..n {
        let p = warp::disk(uniform(u64::from(i)));
        let ring = (p.length_squared() * 8.0) as usize;
        let sector = ((p.y.atan2(p.x) / TAU).rem_euclid(1.0) * 8.0) as usize;
        disk[ring.min(7) * 8 + sector.min(7)] += 1;
        // Stripes of equal area parallel to one side, halved by the ratio of the other two weights.
        let b = warp::triangle(uniform(u64::from(i)));
        let stripe = ((1.0 - b.x) * (1.0 - b.x) * 8.0) as usize;
        let along = (b.y / (1.0 - b.x) * 8.0) as usize;
        triangle[stripe.min(7) * 8 + along.min(7)] += 1;
    }
    for (name, counts) in [("disk", disk), ("triangle", triangle)] {
        let p = p_value(&counts, &[1.0 / 64.0; 64], n);
        assert!(p > FALSE_ALARM, "{name}: p = {p}");
    }
}

const RADIANCE: Transport = Transport::Radiance;

/// Numbers for surfaces that have no lobes to choose among.
fn matt(direction: DVec2) -> ScatterNumbers {
    ScatterNumbers {
        direction,
        lobe: DVec2::ZERO,
    }
}

fn tilted(normal_s: DVec3) -> ScatteringFrame {
    ScatteringFrame {
        normal_g: DVec3::new(0.6, 0.0, 0.8),
        normal_s: normal_s.normalize(),
    }
}

/// C-47.
#[test]
fn materials() {
    let side = |rho, tau| Side {
        reflectance: Rgb::splat(rho),
        transmittance: Rgb::splat(tau),
    };
    let two_sided = Material::matt([side(0.5, 0.2), side(0.1, 0.6)]);
    let flat = tilted(DVec3::new(0.6, 0.0, 0.8));
    let cases = [
        ("lambert", Material::lambert(Rgb::new(0.1, 0.5, 0.9))),
        (
            "leaf",
            Material::leaf(Rgb::new(0.1, 0.2, 0.1), Rgb::new(0.0, 0.3, 0.1)),
        ),
        ("transmitting only", Material::leaf(Rgb::BLACK, Rgb::WHITE)),
        ("two-sided", two_sided),
    ];
    for (name, material) in &cases {
        let scattering = material.scattering();
        for wo in [DVec3::Z, DVec3::NEG_Z] {
            let sample = |u| {
                scattering
                    .sample(&flat, wo, matt(u), RADIANCE)
                    .map(|s| s.wi)
            };
            let pdf = |w| scattering.pdf_solid_angle(&flat, wo, w, RADIANCE);
            check(&format!("{name} from {wo}"), sample, pdf, 24);
        }
    }
    // A bent shading normal changes cosines and density together.
    let bent = tilted(DVec3::new(0.2, 0.4, 0.9));
    let leaf = cases[1].1.scattering();
    let sample = |u| {
        leaf.sample(&bent, DVec3::Z, matt(u), RADIANCE)
            .map(|s| s.wi)
    };
    check(
        "bent",
        sample,
        |w| leaf.pdf_solid_angle(&bent, DVec3::Z, w, RADIANCE),
        24,
    );
}

/// f · cos / pdf must equal the weight that sampling hands out, and energy must be the albedo.
#[test]
fn weights_and_albedo() {
    let leaf = Material::leaf(Rgb::new(0.1, 0.2, 0.3), Rgb::new(0.05, 0.4, 0.1));
    let leaf = leaf.scattering();
    let frame = tilted(DVec3::new(0.6, 0.0, 0.8));
    let wo = DVec3::new(0.3, 0.5, 0.7).normalize();
    for i in 0..1000 {
        let s = leaf.sample(&frame, wo, matt(uniform(i)), RADIANCE).unwrap();
        let pdf = leaf.pdf_solid_angle(&frame, wo, s.wi, RADIANCE);
        let ratio = leaf.value_cos(&frame, wo, s.wi, RADIANCE) / pdf;
        assert_eq!(Density::SolidAngle(pdf), s.density);
        assert!((ratio - s.weight).map(f64::abs).max_channel() < 1e-12);
    }
    let albedo: f64 = integrate(|w| leaf.value_cos(&frame, wo, w, RADIANCE).g, 24)
        .iter()
        .sum();
    assert!((albedo - 0.6).abs() < 1e-3, "{albedo}");
}

/// C-47.
#[test]
fn reciprocity_of_leaves() {
    let leaf = Material::leaf(Rgb::new(0.1, 0.2, 0.3), Rgb::new(0.05, 0.4, 0.1));
    let leaf = leaf.scattering();
    let frame = tilted(DVec3::new(0.6, 0.0, 0.8));
    for i in 0..1000 {
        let (a, b) = (
            warp::sphere(uniform(2 * i)),
            warp::sphere(uniform(2 * i + 1)),
        );
        let ab = leaf.value_cos(&frame, a, b, RADIANCE) / frame.normal_s.dot(b).abs();
        let ba = leaf.value_cos(&frame, b, a, RADIANCE) / frame.normal_s.dot(a).abs();
        assert!((ab - ba).map(f64::abs).max_channel() < 1e-12);
    }
}

#[test]
fn skies() {
    let uniform_sky = Environment {
        sky: Sky::Uniform(Rgb::WHITE),
        sun: None,
    };
    let dome = Dome::new(&uniform_sky);
    check(
        "uniform sky",
        |u| dome.sample(u).map(|s| s.wi),
        |w| dome.pdf_solid_angle(w),
        2,
    );
    for (elevation, turbidity) in [(12.0, 2.0), (60.0, 5.0)] {
        let (azimuth, elevation) = (Angle::deg(75.0), Angle::deg(elevation));
        let day = Environment::daylight(azimuth, elevation, turbidity, Rgb::splat(0.2));
        let dome = Dome::new(&day);
        let sample = |u| dome.sample(u).map(|s| s.wi);
        check("clear sky", sample, |w| dome.pdf_solid_angle(w), 64);
    }
}

/// The sun's disk is far smaller than the cells above: rings and sectors of equal solid angle round its centre.
#[test]
fn sun() {
    let sun = SunDisk::clear(Angle::deg(10.0), Angle::deg(50.0), 3.0).unwrap();
    let frame = Frame::from_normal(sun.to_sun);
    let n = 60_000;
    let mut counts = vec![0_u32; 64];
    for i in 0..n {
        let sample = sun.sample(uniform(u64::from(i)));
        assert_eq!(sample.pdf_solid_angle, Some(sun.pdf_solid_angle(sample.wi)));
        let local = frame.to_local(sample.wi);
        let share = (0.5 * local.truncate().length().asin()).sin().powi(2)
            / (0.5 * sun.angular_radius.radians()).sin().powi(2);
        let sector = (local.y.atan2(local.x) / TAU).rem_euclid(1.0) * 8.0;
        counts[((share * 8.0) as usize).min(7) * 8 + (sector as usize).min(7)] += 1;
    }
    let p = p_value(&counts, &[1.0 / 64.0; 64], n);
    assert!(p > FALSE_ALARM, "p = {p}");
    assert!((sun.solid_angle() * sun.pdf_solid_angle(sun.to_sun) - 1.0).abs() < 1e-12);
}
