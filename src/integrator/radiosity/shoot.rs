//! Shooting: the patches that have the most light left to give send it to all others.
//!
//! Progressive refinement ([`CohenChen1988`](crate::references#cohenchen1988)), a few patches at a time. A row tells what its patch gives
//! as well as what it gets: A F is the same both ways.

use super::system::{FormFactors, Patch, Row, Solved, first_sent, power, sent};
use crate::color::Rgb;
use rayon::prelude::*;

/// Patches that shoot together.
const SALVO: usize = 32;

/// Shots per patch after which no end is in sight.
const MOST_SHOTS: usize = 2000;

/// The factors that shots go by: kept once they are known, as long as there is room.
pub(super) struct Shots<'a> {
    pub(super) factors: &'a dyn FormFactors,
    pub(super) nodes: &'a [u32],
    /// Bytes that kept rows may take.
    pub(super) room: u64,
}

/// Solves until less than the part `tolerance` of all light is left to shoot; `go_on` is told that part after each salvo and says
/// whether to go on. What is left then is spread evenly over all patches.
pub(super) fn solve(
    patches: &[Patch],
    shots: &Shots<'_>,
    tolerance: f64,
    mut go_on: impl FnMut(f64) -> bool,
) -> Solved {
    solve_showing(patches, shots, tolerance, |left, _| go_on(left))
}

/// The same; `go_on` may also ask for what there is so far, with what is left spread evenly over all patches.
pub(super) fn solve_showing(
    patches: &[Patch],
    shots: &Shots<'_>,
    tolerance: f64,
    mut go_on: impl FnMut(f64, &dyn Fn() -> Solved) -> bool,
) -> Solved {
    let mut unshot = first_sent(patches);
    let all = power(patches, &unshot);
    let mut solved = Solved {
        irradiance: vec![Rgb::BLACK; unshot.len()],
        radiosity: unshot.clone(),
        residual: if all > 0.0 { 1.0 } else { 0.0 },
        is_converged: all == 0.0,
    };
    let mut kept: Vec<Option<Row>> = vec![None; unshot.len()];
    let mut room = shots.room;
    for _ in 0..(MOST_SHOTS * patches.len()).div_ceil(SALVO) {
        if solved.is_converged {
            break;
        }
        let salvo = brightest(patches, &unshot);
        let new: Vec<(usize, Row)> = salvo
            .par_iter()
            .filter(|side| kept[**side].is_none())
            .map(|side| (*side, shots.factors.row(shots.nodes[side / 2], side % 2)))
            .collect();
        for (side, row) in new {
            kept[side] = Some(row);
        }
        for side in salvo {
            let Some(row) = kept[side].take() else {
                continue;
            };
            shoot(patches, side, &row, &mut unshot, &mut solved);
            let bytes = row.bytes();
            if bytes <= room {
                room -= bytes;
                kept[side] = Some(row);
            }
        }
        // Much the same part of what is left comes back again and again as of all light: it is this part of the whole.
        solved.residual = power(patches, &unshot) / all;
        solved.is_converged = solved.residual <= tolerance;
        let so_far = || {
            let mut so_far = solved.clone();
            add_ambient(patches, &unshot, &mut so_far);
            so_far
        };
        if !go_on(solved.residual, &so_far) {
            break;
        }
    }
    add_ambient(patches, &unshot, &mut solved);
    solved
}

/// The sides with the most power to give, the strongest first.
fn brightest(patches: &[Patch], unshot: &[Rgb]) -> Vec<usize> {
    let strength = |side: usize| patches[side / 2].weight * unshot[side].sum();
    let mut sides: Vec<usize> = (0..unshot.len())
        .filter(|side| strength(*side) > 0.0)
        .collect();
    let by_strength = |a: &usize, b: &usize| strength(*b).total_cmp(&strength(*a)).then(a.cmp(b));
    if sides.len() > SALVO {
        sides.select_nth_unstable_by(SALVO, by_strength);
        sides.truncate(SALVO);
    }
    sides.sort_unstable_by(by_strength);
    sides
}

/// Sends out what a side has to give.
fn shoot(patches: &[Patch], from: usize, row: &Row, unshot: &mut [Rgb], solved: &mut Solved) {
    let flux = std::mem::take(&mut unshot[from]) * patches[from / 2].area;
    for (at, factor) in row.entries() {
        let patch = &patches[at / 2];
        let gained = flux * factor / patch.area;
        solved.irradiance[at] += gained;
        for to in [at, at ^ 1] {
            let thrown = sent(
                patches,
                to,
                |side| {
                    if side == at { gained } else { Rgb::BLACK }
                },
            );
            unshot[to] += thrown;
            solved.radiosity[to] += thrown;
        }
    }
}

/// Light that is left falls on all patches alike, as it would in a closed room of the mean reflectance.
fn add_ambient(patches: &[Patch], unshot: &[Rgb], solved: &mut Solved) {
    let needed = |side: &usize| patches[side / 2].sides[side % 2].is_needed();
    let (mut area, mut left, mut thrown) = (0.0, Rgb::BLACK, Rgb::BLACK);
    for side in (0..unshot.len()).filter(needed) {
        let patch = &patches[side / 2];
        let own = &patch.sides[side % 2];
        area += patch.area;
        left += unshot[side] * patch.area;
        thrown += (own.reflectance + own.transmittance) * patch.area;
    }
    if solved.is_converged || area == 0.0 {
        return;
    }
    let ambient = |left: f64, thrown: f64| {
        let kept = (1.0 - thrown / area).max(1.0 / MOST_SHOTS as f64);
        left / area / kept
    };
    let ambient = Rgb::new(
        ambient(left.r, thrown.r),
        ambient(left.g, thrown.g),
        ambient(left.b, thrown.b),
    );
    for side in (0..unshot.len()).filter(needed) {
        solved.irradiance[side] += ambient;
        for to in [side, side ^ 1] {
            solved.radiosity[to] +=
                sent(
                    patches,
                    to,
                    |at| {
                        if at == side { ambient } else { Rgb::BLACK }
                    },
                );
        }
    }
}
