//! Stochastic shooting: all patches shoot at once, each by as many rays as it has light.
//!
//! The stochastic Jacobi iteration of [`Neumann1995`](crate::references#neumann1995) with incremental shooting
//! ([`Bekaert1999`](crate::references#bekaert1999)): every ray carries about the same power, form factors are never stored, and the time
//! grows with the number of patches only as a ray's does. For plants, whose leaves are many and small.

use super::rays::{CosineRays, cell_point, cosine_ray};
use super::system::{Patch, Solved, first_sent, power, sent};
use crate::color::Rgb;
use crate::integrator::{CancelToken, RayCounts};
use crate::material::Transport;
use crate::math::rng;
use crate::sampler::{Sampler, SamplerKind, Use};
use rayon::prelude::*;

/// What the random numbers are for.
const SHOTS: u64 = 0x7368_6f74;

/// Iterations after which no end is in sight.
const MOST_ITERATIONS: u64 = 5000;

/// Part of the rays that tells how to share out the others.
const PILOT: f64 = 1.0 / 16.0;

/// Part of the rays that the first iteration has at least.
const LEAST_SHARE: f64 = 1.0 / 64.0;

/// Sides whose rays are followed before what they found is added up: what bounds memory.
const BLOCK: usize = 1 << 14;

/// Solves with about `n_rays` rays, until less than the part `tolerance` of all light is left to shoot; `go_on` is told that part after
/// each iteration and says whether to go on. Once `cancel` is set, no more rays are followed, and the answer is of no use.
pub(super) fn solve(
    patches: &[Patch],
    shots: &CosineRays<'_, '_>,
    n_rays: u64,
    tolerance: f64,
    cancel: &CancelToken,
    mut go_on: impl FnMut(f64) -> bool,
) -> Solved {
    let shoot_all = |unshot: &[Rgb], way| shoot_all(patches, shots, unshot, way, cancel);
    let mut unshot = first_sent(patches);
    let all = power(patches, &unshot);
    let mut solved = Solved {
        irradiance: vec![Rgb::BLACK; unshot.len()],
        radiosity: unshot.clone(),
        residual: if all > 0.0 { 1.0 } else { 0.0 },
        is_converged: all == 0.0,
    };
    let (mut shot, mut thrown) = (0.0, 0.0);
    if all > 0.0 {
        // A few rays tell how much of what is shot comes back.
        let n = (n_rays as f64 * PILOT).ceil();
        let gained = shoot_all(&unshot, (all / n, MOST_ITERATIONS));
        (shot, thrown) = (all, power(patches, &thrown_by(patches, &gained)));
    }
    for iteration in 0..MOST_ITERATIONS {
        if solved.is_converged {
            break;
        }
        let left = power(patches, &unshot);
        // Rays are shared out over all that will ever be shot.
        let ever = all / (1.0 - thrown / shot).clamp(LEAST_SHARE, 1.0);
        let n = (n_rays as f64 * left / ever).ceil().max(1.0);
        let gained = shoot_all(&unshot, (left / n, iteration));
        unshot = thrown_by(patches, &gained);
        for (side, (gained, thrown)) in gained.into_iter().zip(&unshot).enumerate() {
            solved.irradiance[side] += gained;
            solved.radiosity[side] += *thrown;
        }
        let next = power(patches, &unshot);
        (shot, thrown) = (shot + left, thrown + next);
        // Much the same part of what is left comes back again and again as of all light: it is this part of the whole.
        solved.residual = next / all;
        solved.is_converged = solved.residual <= tolerance;
        if !go_on(solved.residual) {
            break;
        }
    }
    solved
}

/// What all sides send out when they have gained so much.
fn thrown_by(patches: &[Patch], gained: &[Rgb]) -> Vec<Rgb> {
    let each = 0..gained.len();
    each.map(|side| sent(patches, side, |at| gained[at]))
        .collect()
}

/// A side and its rays.
struct Shooter {
    side: usize,
    n: u32,
    /// What each ray carries, W.
    power: Rgb,
}

/// Shoots what all sides have to give, in rays of about this power; gives by how much their irradiances grew.
fn shoot_all(
    patches: &[Patch],
    shots: &CosineRays<'_, '_>,
    unshot: &[Rgb],
    (per_ray, iteration): (f64, u64),
    cancel: &CancelToken,
) -> Vec<Rgb> {
    let mut shooters = Vec::new();
    // Rays are dealt out to the running sum of power, from a random start: none is favoured.
    let start = rng::unit_f64(rng::hash(&[shots.seed, SHOTS, iteration]));
    let (mut sum, mut dealt) = (start, 0.0);
    for (side, sent) in unshot.iter().enumerate() {
        let patch = &patches[side / 2];
        let total = patch.weight * sent.sum();
        sum += total / per_ray;
        let n = (sum.floor() - dealt).max(0.0);
        dealt += n;
        if n > 0.0 {
            shooters.push(Shooter {
                side,
                n: n as u32,
                power: *sent * (patch.area * per_ray / total),
            });
        }
    }
    let mut gained = vec![Rgb::BLACK; unshot.len()];
    for block in shooters.chunks(BLOCK) {
        let found: Vec<Vec<(u32, Rgb)>> = block
            .par_iter()
            .filter(|_| !cancel.is_cancelled())
            .map(|shooter| shoot(shots, shooter, iteration))
            .collect();
        for (side, power) in found.into_iter().flatten() {
            gained[side as usize] += power / patches[side as usize / 2].area;
        }
    }
    gained
}

/// The sides that the rays of a shooter meet, and with what power.
fn shoot(shots: &CosineRays<'_, '_>, shooter: &Shooter, iteration: u64) -> Vec<(u32, Rgb)> {
    let (patch, side) = (shooter.side / 2, shooter.side % 2);
    let node = shots.mesh.patches[patch];
    let node = &shots.mesh.nodes[node as usize];
    let mean = node.area / (node.cell.size.x * node.cell.size.y).abs();
    let mean = if shots.mesh.is_triangle(&node.cell) {
        2.0 * mean
    } else {
        mean
    };
    let stream = rng::hash(&[shots.seed, SHOTS, iteration, shooter.side as u64]);
    let mut rays = RayCounts::default();
    let mut found = Vec::with_capacity(shooter.n as usize);
    for index in 0..shooter.n {
        let mut sampler = Sampler::new(SamplerKind::OwenSobol, stream, index);
        let at = sampler.point(Use::Choice);
        let from = cell_point(shots.mesh, shots.carrier, &node.cell, side, at);
        let ray = cosine_ray(&from.point, side, sampler.point(Use::Direction));
        let power = shooter.power * (from.weight / mean);
        shots.carrier.carry(
            &ray,
            Transport::Importance,
            &mut sampler,
            &mut rays,
            |met, weight| {
                if let Some(patch) = shots.mesh.patch_at(&met.hit, met.point.position) {
                    found.push((2 * patch + u32::from(!met.point.is_front), power * weight));
                }
            },
        );
    }
    found
}
