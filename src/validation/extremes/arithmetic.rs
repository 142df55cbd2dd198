//! Sums, random numbers and choices: C-57, C-58, C-62, C-63; and Fresnel's equations: C-49, C-50.

use super::super::check::{Check, Setting, Trouble};
use super::looks::largest;
use super::{Effort, Row, checks_of};
use crate::color::Rgb;
use crate::film::Pixel;
use crate::light::alias::AliasTable;
use crate::material::fresnel::dielectric;
use crate::math::functions::{asin, atan, cos};
use crate::math::rng;
use crate::math::stats::chi_squared_upper_tail;
use crate::math::tolerance::{EXACT_SHARES, LONG_SUM, STEEP_FRESNEL};

/// Probability below which a test of random numbers counts as failed: false alarms of a right generator.
const UNLIKELY: f64 = 1.0 / 1e6;

/// Neighbouring counters.
const COUNTERS: u64 = 1 << 20;

/// The checks.
pub(super) fn checks(effort: Effort) -> Vec<Check> {
    let mut checks = checks_of(ROWS);
    checks.extend(long_sums(effort));
    let brewster = Check::within(
        (
            "C-50-brewster",
            "Brewster's angle of glass, where half of what is reflected straight from the s wave is: reflectance",
        ),
        0.5 * (1.25_f64 / 3.25).powi(2),
        EXACT_SHARES,
        |_| Ok(dielectric(cos(atan(1.5)), 1.5).reflectance),
    );
    checks.push(brewster.of_case("50"));
    checks
}

/// Those that no setting changes.
const ROWS: [Row; 15] = [
    (
        "58",
        "C-58-equal",
        "2^20 neighbouring counters: numbers that occur twice",
        (0.0, 0.0),
        |setting| Ok(equal_numbers(setting.seed)),
    ),
    (
        "58",
        "C-58-bytes",
        "the same: eight places of bytes by chi squared, those less likely than 10^-6 / 8",
        (0.0, 0.0),
        |setting| Ok(uneven_bytes(setting.seed)),
    ),
    (
        "58",
        "C-58-lag",
        "the same as uniform numbers: correlation with the next, in its standard errors",
        (0.0, 5.0),
        |setting| {
            Ok(correlation(
                |i| rng::hash(&[setting.seed, i]),
                |i| rng::hash(&[setting.seed, i + 1]),
            ))
        },
    ),
    (
        "58",
        "C-58-streams",
        "the same counters of two neighbouring streams: correlation, in its standard errors",
        (0.0, 5.0),
        |setting| {
            let next = setting.seed.wrapping_add(1);
            Ok(correlation(
                |i| rng::hash(&[setting.seed, i]),
                |i| rng::hash(&[next, i]),
            ))
        },
    ),
    (
        "58",
        "C-58-pairs",
        "pairs of neighbours in 64 × 64 cells by chi squared: how much less likely than 10^-6 (0: not)",
        (0.0, 0.0),
        |setting| Ok(uneven_pairs(setting.seed)),
    ),
    (
        "58",
        "C-58-bits",
        "one flipped bit of a counter, 64 places: mean number of bits of 64 that flip, the one farthest from 32",
        (0.0, 2.0),
        |_| Ok(avalanche()),
    ),
    (
        "62",
        "C-62-film",
        "means of 1000 samples of 1e30 and of 10^-30 in one pixel: largest relative error",
        (0.0, EXACT_SHARES),
        |_| Ok(huge_and_tiny()),
    ),
    (
        "62",
        "C-62-rejected",
        "samples of 2, NaN, infinity, -infinity and 4 in a pixel: those left out",
        (3.0, 0.0),
        |_| Ok(f64::from(strange_pixel().n_rejected)),
    ),
    (
        "62",
        "C-62-rest",
        "the same: mean of what is left",
        (3.0, 0.0),
        |_| Ok(strange_pixel().mean().g),
    ),
    (
        "63",
        "C-63-sums",
        "weights {3}, {1 0 2}, {10^-30 1e30 1}, ten alike, {1e308 1e308 1e308}, the two least: probabilities, sum less 1 and share less weight",
        (0.0, EXACT_SHARES),
        |_| shares(),
    ),
    (
        "63",
        "C-63-zero",
        "100,000 choices among weights of which three are 0: those chosen",
        (0.0, 0.0),
        |_| zero_chosen(),
    ),
    (
        "63",
        "C-63-wrong",
        "no weights, weights of 0, NaN, negative, infinite: something chosen, or accepted",
        (0.0, 0.0),
        |_| Ok(wrong_weights()),
    ),
    (
        "49",
        "C-49-critical",
        "reflectance from inside, a billionth of a radian beyond asin(1/1.5) = 41.8103 deg",
        (1.0, 0.0),
        |_| Ok(dielectric(cos(asin(1.0 / 1.5) + 1.0 / 1e9), 1.0 / 1.5).reflectance),
    ),
    (
        "49",
        "C-49-continuous",
        "the same, 10^-12 radians before it: no step",
        (1.0, STEEP_FRESNEL),
        |_| Ok(dielectric(cos(asin(1.0 / 1.5) - 1.0 / 1e12), 1.0 / 1.5).reflectance),
    ),
    (
        "50",
        "C-50-normal",
        "reflectance of glass straight on, from outside and inside: largest difference from 0.04",
        (0.0, EXACT_SHARES),
        |_| {
            Ok(largest([1.5, 1.0 / 1.5].map(|eta| {
                (dielectric(1.0, eta).reflectance - 0.04).abs()
            })))
        },
    ),
];

/// C-57. A sum that has come so far must still feel each sample that is added; `f32` sums stop at 2²⁴.
fn long_sums(effort: Effort) -> Vec<Check> {
    let (n, what) = match effort {
        Effort::Short => (
            10_000_000,
            "1e7 samples of a pixel (short; in full 1e9): relative error of the mean",
        ),
        Effort::Full => (
            1_000_000_000,
            "1e9 samples of a pixel: relative error of the mean",
        ),
    };
    let added = Check::within(("C-57-added", what), 0.0, LONG_SUM, move |setting| {
        Ok(error_of_a_long_mean(Pixel::default(), 0, n, setting))
    });
    let last = "the last 100,000 of 1e9 samples of a pixel, onto the sum of the others: relative error of the mean";
    let last = Check::within(("C-57-last", last), 0.0, LONG_SUM, |setting| {
        let before = 999_900_000_u32;
        let mut pixel = Pixel::default();
        for half in &mut pixel.halves {
            half.n_samples = before / 2;
            half.sum = Rgb::splat(MEAN * f64::from(before / 2));
        }
        Ok(error_of_a_long_mean(pixel, before, 1_000_000_000, setting))
    });
    [added, last].map(|check| check.of_case("57")).into()
}

/// The mean of 0, 1/1000, …, 999/1000.
const MEAN: f64 = 0.4995;

/// Adds samples up to a number to a pixel: 0, 1/1000, …, 999/1000 in turn, but a thousand at a time of one of them.
fn error_of_a_long_mean(mut pixel: Pixel, from: u32, to: u32, setting: &Setting<'_>) -> f64 {
    for i in from..to {
        if i.is_multiple_of(1 << 20) && setting.cancel.is_cancelled() {
            return f64::NAN;
        }
        pixel.add(i, Rgb::splat(f64::from(i % 1000) / 1000.0));
    }
    (pixel.mean().g / MEAN - 1.0).abs()
}

fn numbers(seed: u64) -> Vec<u64> {
    (0..COUNTERS).map(|i| rng::hash(&[seed, i])).collect()
}

fn equal_numbers(seed: u64) -> f64 {
    let mut numbers = numbers(seed);
    numbers.sort_unstable();
    numbers.windows(2).filter(|pair| pair[0] == pair[1]).count() as f64
}

fn uneven_bytes(seed: u64) -> f64 {
    let numbers = numbers(seed);
    let is_uneven = |place: &u32| {
        let mut counts = [0_u32; 256];
        for number in &numbers {
            counts[(number >> (8 * place) & 255) as usize] += 1;
        }
        p_value(&counts) < UNLIKELY / 8.0
    };
    (0..8).filter(is_uneven).count() as f64
}

/// Probability of counts that are so uneven.
fn p_value(counts: &[u32]) -> f64 {
    let n: f64 = counts.iter().map(|count| f64::from(*count)).sum();
    let expected = n / counts.len() as f64;
    let squares = counts
        .iter()
        .map(|count| (f64::from(*count) - expected).powi(2));
    chi_squared_upper_tail(squares.sum::<f64>() / expected, (counts.len() - 1) as f64)
}

/// Correlation of two streams of uniform numbers, in its standard errors.
fn correlation(one: impl Fn(u64) -> u64, other: impl Fn(u64) -> u64) -> f64 {
    let centered = |bits: u64| rng::unit_f64(bits) - 0.5;
    let products = (0..COUNTERS).map(|i| centered(one(i)) * centered(other(i)) * 12.0);
    (products.sum::<f64>() / (COUNTERS as f64).sqrt()).abs()
}

fn uneven_pairs(seed: u64) -> f64 {
    let mut counts = vec![0_u32; 64 * 64];
    let place = |i: u64| (rng::unit_f64(rng::hash(&[seed, i])) * 64.0) as usize;
    for i in (0..COUNTERS).step_by(2) {
        counts[place(i) * 64 + place(i + 1)] += 1;
    }
    (UNLIKELY - p_value(&counts)).max(0.0)
}

fn avalanche() -> f64 {
    let off = |bit: u32| {
        let flips = |i: u64| (rng::hash(&[i, 3]) ^ rng::hash(&[i ^ (1 << bit), 3])).count_ones();
        let sum: u32 = (0..256).map(flips).sum();
        (f64::from(sum) / 256.0 - 32.0).abs()
    };
    largest((0..64).map(off))
}

fn huge_and_tiny() -> f64 {
    let (huge, tiny) = (1e30, 1.0 / 1e30);
    let mut pixel = Pixel::default();
    for i in 0..1000 {
        pixel.add(i, Rgb::new(huge, tiny, 0.0));
    }
    let mean = pixel.mean();
    largest([
        (mean.r / huge - 1.0).abs(),
        (mean.g / tiny - 1.0).abs(),
        mean.b,
    ])
}

fn strange_pixel() -> Pixel {
    let mut pixel = Pixel::default();
    let samples = [2.0, f64::NAN, f64::INFINITY, f64::NEG_INFINITY, 4.0];
    for (i, sample) in (0..).zip(samples) {
        pixel.add(i, Rgb::splat(sample));
    }
    pixel
}

fn shares() -> Result<f64, Trouble> {
    let tiny = 1.0 / 1e30;
    let cases: [&[f64]; 6] = [
        &[3.0],
        &[1.0, 0.0, 2.0],
        &[tiny, 1e30, 1.0],
        &[0.1; 10],
        &[1e308, 1e308, 1e308],
        &[f64::from_bits(1), f64::from_bits(1)],
    ];
    let mut all = Vec::new();
    for weights in cases {
        let table = AliasTable::new(weights)?;
        let probabilities: Vec<f64> = (0..weights.len()).map(|i| table.probability(i)).collect();
        all.push((probabilities.iter().sum::<f64>() - 1.0).abs());
        let most = weights.iter().copied().fold(0.0, f64::max);
        let sum: f64 = weights.iter().map(|weight| weight / most).sum();
        let off = probabilities.iter().zip(weights);
        all.extend(off.map(|(found, weight)| (found - weight / most / sum).abs()));
    }
    Ok(largest(all))
}

fn zero_chosen() -> Result<f64, Trouble> {
    let table = AliasTable::new(&[0.0, 1.0 / 3.0, 0.0, 2.0 / 3.0, 0.0])?;
    let n = 100_000;
    let is_wrong = |i: &i32| {
        let chosen = table.sample(f64::from(*i) / f64::from(n));
        chosen != Some(1) && chosen != Some(3)
    };
    Ok((0..n).filter(is_wrong).count() as f64)
}

fn wrong_weights() -> f64 {
    let nothing: [&[f64]; 2] = [&[], &[0.0, 0.0]];
    let chooses = |weights: &&&[f64]| {
        AliasTable::new(weights).map_or(true, |table| table.sample(0.5).is_some())
    };
    let wrong = [f64::NAN, -1.0, f64::INFINITY];
    let accepts = |weight: &&f64| AliasTable::new(&[1.0, **weight]).is_ok();
    (nothing.iter().filter(chooses).count() + wrong.iter().filter(accepts).count()) as f64
}
