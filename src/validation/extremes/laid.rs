//! Light from photons that are laid out by hand, of which paper says what it is: C-32, C-33, C-41, C-42.

use super::super::check::Trouble;
use super::super::room::{Room, at, square};
use super::looks::largest;
use crate::integrator::photon_map::trials::{Laid, after_passes, irradiance, shrunk};
use crate::material::Material;
use crate::math::functions::{cos, ln};
use crate::math::rng;
use crate::math::stats::RunningStats;
use crate::scene::{Scene, SceneError};
use glam::DVec3;
use std::f64::consts::{PI, TAU};

/// Radius of kernels, metres.
const RADIUS: f64 = 0.1;

/// Photons per square metre of even light.
const DENSITY: f64 = 4000.0;

/// A wide floor.
fn floor() -> Result<Scene, SceneError> {
    let room = Room::default();
    room.with(square(2.0), at(0., 0., 0.), Material::default())
        .scene()
}

/// Estimates of even light of 1 W/m² by 600 sets of random photons.
fn even_light() -> Result<RunningStats, Trouble> {
    let scene = floor()?;
    let n = (DENSITY * 0.36) as u64;
    let estimate = |seed: u64| {
        let photon = |i: u64| -> Laid {
            let u = |k| rng::unit_f64(rng::hash(&[seed, i, k])) * 0.6 - 0.3;
            (DVec3::new(u(0), u(1), 0.0), DVec3::Z, 1.0 / DENSITY)
        };
        irradiance(&scene, (0..n).map(photon), DVec3::ZERO, RADIUS)
    };
    Ok((0..600).map(estimate).collect())
}

/// How far their mean is from 1, in standard errors.
pub(super) fn bias_of_even_light() -> Result<f64, Trouble> {
    let seen = even_light()?;
    Ok((seen.mean() - 1.0).abs() / seen.standard_error())
}

/// Their variance, in those of counting as many photons as there are in a kernel.
pub(super) fn noise_of_even_light() -> Result<f64, Trouble> {
    Ok(even_light()?.variance() * DENSITY * PI * RADIUS * RADIUS)
}

/// Photons on a fine lattice over the square of half edge 0.3 that carry the flux of an irradiance.
fn lattice(light: impl Fn(f64, f64) -> f64) -> impl Iterator<Item = Laid> {
    let n = 600;
    let step = 0.6 / f64::from(n);
    let at = move |i: i32| (f64::from(i) + 0.5) * step - 0.3;
    (0..n * n).map(move |i| {
        let (x, y) = (at(i % n), at(i / n));
        (DVec3::new(x, y, 0.0), DVec3::Z, light(x, y) * step * step)
    })
}

/// How far off the middle of a slope is, W/m² of 1.
pub(super) fn bias_of_a_slope() -> Result<f64, Trouble> {
    let slope = lattice(|x, y| 1.0 + x - 2.0 * y);
    Ok(irradiance(&floor()?, slope, DVec3::ZERO, RADIUS) - 1.0)
}

/// How far off 1 + 3x² + y² is in the middle, by r²: that of three radii which is farthest from 8/12.
pub(super) fn bias_of_curvature() -> Result<f64, Trouble> {
    let scene = floor()?;
    let expected = 8.0 / 12.0;
    let bias = |radius: f64| {
        let curved = lattice(|x, y| 1.0 + 3.0 * x * x + y * y);
        (irradiance(&scene, curved, DVec3::ZERO, radius) - 1.0) / (radius * radius)
    };
    let off = |radius| (bias(radius) - expected).abs();
    Ok(expected + largest([0.05, 0.1, 0.2].map(off)))
}

/// Light of the other side, of a wall and of a layer above.
pub(super) fn wrong_sides() -> Result<f64, Trouble> {
    let photon = |i: i32| -> Laid {
        let along = |k: i32| f64::from(k) * 0.002 - 0.1;
        let normals = [DVec3::NEG_Z, DVec3::X, DVec3::Z];
        let height = if i % 3 == 2 { 0.02 } else { 0.0 };
        let position = DVec3::new(along(i % 100), along(i / 100), height);
        (position, normals[i.unsigned_abs() as usize % 3], 1.0)
    };
    Ok(irradiance(
        &floor()?,
        (0..10_000).map(photon),
        DVec3::ZERO,
        RADIUS,
    ))
}

/// Half the edge of a floor that is lit in stripes, metres, and photons that a pass sends there.
const HALF: f64 = 0.3;
const SENT: u64 = 1000;

/// Light in stripes, W/m².
fn stripes(x: f64) -> f64 {
    1.0 + 0.8 * cos(TAU * x / HALF)
}

/// Photons of a pass, of `n_passes`, that together are [`stripes`].
fn photons(pass: u64, n_passes: u32) -> impl Iterator<Item = Laid> {
    let side = 3.0 * HALF;
    let power = 2.0 * side * side / (SENT as f64 * f64::from(n_passes));
    (0..SENT).filter_map(move |i| {
        let u = |k| rng::unit_f64(rng::hash(&[pass, i, k]));
        let (x, y) = ((u(0) - 0.5) * side, (u(1) - 0.5) * side);
        let is_there = u(2) * 2.0 < stripes(x);
        is_there.then_some((DVec3::new(x, y, 0.0), DVec3::Z, power))
    })
}

/// Mean squared error after so many passes, W²/m⁴, away from the edges.
fn squared_error(scene: &Scene, n_passes: u32, seed: u64) -> f64 {
    let of = |pass: u32| photons(seed << 32 | u64::from(pass), n_passes);
    let light = after_passes(scene, PI * 0.12 * 0.12, n_passes, of);
    let inside = light.iter().filter(|(at, _)| at.abs().max_element() < HALF);
    let errors: Vec<f64> = inside
        .map(|(at, found)| (found - stripes(at.x)).powi(2))
        .collect();
    errors.iter().sum::<f64>() / errors.len() as f64
}

/// With which power of the number of passes, 4 to 64, the squared error of two sets of photons falls.
///
/// The mean over samples and two sets scatters by 7 % for each number of passes, so the slope by 0.03: it leaves 0.1 once in a thousand
/// sets. A kernel that does not shrink has slope 0 in the end, one that shrinks too fast -1/3.
pub(super) fn slope_of_passes() -> Result<f64, Trouble> {
    let scene = floor()?;
    let error = |n: u32| ln((0..2).map(|seed| squared_error(&scene, n, seed)).sum());
    Ok((error(64) - error(4)) / ln(16.0))
}

/// With which power of the number of passes squared radii fall in the end.
pub(super) fn slope_of_radii() -> f64 {
    (ln(shrunk(1 << 20)) - ln(shrunk(1 << 10))) * 2.0 / ln(1024.0)
}
