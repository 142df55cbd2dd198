//! How different two pictures look to a person who flips between them: ꟻLIP ([Andersson2020](crate::references#andersson2020)).
//!
//! Pictures are blurred as far as an eye at the usual distance does ([`PIXELS_PER_DEGREE`]), the distance of their colours is
//! measured in a space that is even to the eye, and differences of edges and points make it larger. 0 is the same, 1 is green
//! against blue.

use crate::color::{Rgb, srgb};
use crate::math::functions::{cbrt, exp, pow};
use rayon::prelude::*;
use std::f64::consts::{FRAC_1_SQRT_2, PI};

/// Pixels of the screen in one degree of the field of view: a screen 0.7 m wide with 3840 pixels seen from 0.7 m (§6).
pub const PIXELS_PER_DEGREE: f64 = 67.0;

/// Exponent of the colour difference, the part of the largest one up to which it is stretched, and where to (§4.1.4).
const COLOR_EXPONENT: f64 = 0.7;
const CUTOFF: f64 = 0.4;
const CUTOFF_TARGET: f64 = 0.95;
/// Width in degrees of what counts as an edge or a point, and the exponent of their difference (§4.2).
const FEATURE_WIDTH: f64 = 0.082;
const FEATURE_EXPONENT: f64 = 0.5;

/// Contrast sensitivity of the eye to lightness, red-green and blue-yellow, in the space of angles: two Gaussians
/// a √(π/b) exp(-π² x²/b) each (§4.1.1, table 1).
const SENSITIVITIES: [[(f64, f64); 2]; 3] = [
    [(1.0, 0.0047), (0.0, 0.000_01)],
    [(1.0, 0.0053), (0.0, 0.000_01)],
    [(34.1, 0.04), (13.5, 0.025)],
];

/// Linear sRGB to CIE XYZ (D65), IEC 61966-2-1.
const TO_XYZ: [[f64; 3]; 3] = [
    [
        10135552.0 / 24577794.0,
        8788810.0 / 24577794.0,
        4435075.0 / 24577794.0,
    ],
    [
        2613072.0 / 12288897.0,
        8788810.0 / 12288897.0,
        887015.0 / 12288897.0,
    ],
    [
        1425312.0 / 73733382.0,
        8788810.0 / 73733382.0,
        70074185.0 / 73733382.0,
    ],
];

/// The difference of each pixel of two pictures of the same size, 0..=1.
///
/// Both are 8-bit sRGB, three bytes a pixel, row by row.
///
/// # Panics
/// If they are not both `width` × `height` pixels.
#[must_use]
pub fn difference(reference: &[u8], test: &[u8], (width, height): (u32, u32)) -> Vec<f64> {
    let (width, height) = (width as usize, height as usize);
    for picture in [reference, test] {
        let n = picture.len();
        assert_eq!(n, 3 * width * height, "invariant: pictures are of one size");
    }
    let opponents = [reference, test].map(|bytes| opponents(bytes, width));
    let [seen_reference, seen_test] = opponents.each_ref().map(as_seen);
    let colors = seen_reference.par_iter().zip(&seen_test);
    let colors: Vec<f64> = colors.map(|(a, b)| color_difference(*a, *b)).collect();
    let [features_reference, features_test] = opponents
        .each_ref()
        .map(|[lightness, ..]| features(lightness));
    let features = features_reference.par_iter().zip(&features_test);
    let features = features.map(|(a, b)| {
        let largest = (a[0] - b[0]).abs().max((a[1] - b[1]).abs());
        pow(FRAC_1_SQRT_2 * largest, FEATURE_EXPONENT)
    });
    let features: Vec<f64> = features.collect();
    let both = colors.par_iter().zip(&features);
    both.map(|(color, feature)| pow(*color, 1.0 - feature))
        .collect()
}

/// Mean and 95th percentile of differences; 0 of none.
#[must_use]
pub fn summary(differences: &[f64]) -> (f64, f64) {
    if differences.is_empty() {
        return (0.0, 0.0);
    }
    let mut sorted = differences.to_vec();
    sorted.sort_by(f64::total_cmp);
    let at = (0.95 * (sorted.len() - 1) as f64).round() as usize;
    (sorted.iter().sum::<f64>() / sorted.len() as f64, sorted[at])
}

/// One number for each pixel.
#[derive(Clone)]
struct Plane {
    values: Vec<f64>,
    width: usize,
}

impl Plane {
    /// Convolved along rows with one kernel and along columns with another, of odd lengths; what lies outside is like the border.
    fn convolved(&self, row: &[f64], column: &[f64]) -> Self {
        let height = self.values.len() / self.width;
        let along = |x: usize, y: usize| {
            let at = |i: usize| (x + i).saturating_sub(row.len() / 2).min(self.width - 1);
            let line = &self.values[y * self.width..];
            (0..row.len()).map(|i| row[i] * line[at(i)]).sum()
        };
        let n = self.values.len();
        let rows = (0..n).into_par_iter();
        let rows: Vec<f64> = rows
            .map(|at| along(at % self.width, at / self.width))
            .collect();
        let across = |x: usize, y: usize| {
            let at = |i: usize| (y + i).saturating_sub(column.len() / 2).min(height - 1);
            let sum = (0..column.len()).map(|i| column[i] * rows[at(i) * self.width + x]);
            sum.sum()
        };
        let values = (0..n).into_par_iter();
        Self {
            values: values
                .map(|at| across(at % self.width, at / self.width))
                .collect(),
            width: self.width,
        }
    }
}

/// Lightness, red-green and blue-yellow (`YCxCz`) of each pixel.
fn opponents(bytes: &[u8], width: usize) -> [Plane; 3] {
    let pixels: Vec<[f64; 3]> = bytes
        .chunks_exact(3)
        .map(|rgb| {
            opponent(Rgb::new(
                srgb::decode_u8(rgb[0]),
                srgb::decode_u8(rgb[1]),
                srgb::decode_u8(rgb[2]),
            ))
        })
        .collect();
    [0, 1, 2].map(|channel| Plane {
        values: pixels.iter().map(|pixel| pixel[channel]).collect(),
        width,
    })
}

/// XYZ over that of white.
fn relative_xyz(color: Rgb) -> [f64; 3] {
    let [r, g, b] = color.to_array();
    TO_XYZ.map(|[x, y, z]| (x * r + y * g + z * b) / (x + y + z))
}

fn opponent(color: Rgb) -> [f64; 3] {
    let [x, y, z] = relative_xyz(color);
    [116.0 * y - 16.0, 500.0 * (x - y), 200.0 * (y - z)]
}

/// What the eye has of the pictures, in CIELAB with the chroma that is left in the dark (Hunt).
fn as_seen(planes: &[Plane; 3]) -> Vec<[f64; 3]> {
    let widest = SENSITIVITIES.iter().flatten().map(|(_, b)| *b);
    let widest = widest.fold(0.0, f64::max);
    let radius = (3.0 * (widest / (2.0 * PI * PI)).sqrt() * PIXELS_PER_DEGREE).ceil();
    let blurred = |channel: usize| {
        let kernels = SENSITIVITIES[channel].map(|(a, b)| {
            let kernel = kernel(radius, |x| {
                let angle = x / PIXELS_PER_DEGREE;
                exp(-PI * PI * angle * angle / b)
            });
            let sum: f64 = kernel.iter().sum();
            (a * (PI / b).sqrt() * sum * sum, kernel, sum)
        });
        let all: f64 = kernels.iter().map(|(weight, ..)| weight).sum();
        let mut values = vec![0.0; planes[channel].values.len()];
        for (weight, kernel, sum) in &kernels {
            if *weight > 0.0 {
                let kernel: Vec<f64> = kernel.iter().map(|x| x / sum).collect();
                let plane = planes[channel].convolved(&kernel, &kernel);
                for (value, blurred) in values.iter_mut().zip(&plane.values) {
                    *value += weight / all * blurred;
                }
            }
        }
        values
    };
    let channels = [blurred(0), blurred(1), blurred(2)];
    (0..channels[0].len())
        .into_par_iter()
        .map(|at| {
            let [y, x, z] = [channels[0][at], channels[1][at], channels[2][at]];
            lab_with_hunt(color_of([y, x, z]))
        })
        .collect()
}

/// The colour, between black and white, of lightness, red-green and blue-yellow.
fn color_of([y, x, z]: [f64; 3]) -> Rgb {
    let y = (y + 16.0) / 116.0;
    let relative = [x / 500.0 + y, y, y - z / 200.0];
    let white = TO_XYZ.map(|row| row.iter().sum::<f64>());
    let xyz = glam::DVec3::from_array([0, 1, 2].map(|i| relative[i] * white[i]));
    let rows = TO_XYZ.map(glam::DVec3::from_array);
    let matrix = glam::DMat3::from_cols(rows[0], rows[1], rows[2]).transpose();
    let rgb = matrix.inverse() * xyz;
    Rgb::from_array(rgb.clamp(glam::DVec3::ZERO, glam::DVec3::ONE).to_array())
}

/// CIELAB whose chroma falls with lightness.
fn lab_with_hunt(color: Rgb) -> [f64; 3] {
    const DELTA: f64 = 6.0 / 29.0;
    let compress = |t: f64| {
        if t > DELTA * DELTA * DELTA {
            cbrt(t)
        } else {
            t / (3.0 * DELTA * DELTA) + 4.0 / 29.0
        }
    };
    let [x, y, z] = relative_xyz(color).map(compress);
    let lightness = 116.0 * y - 16.0;
    let hunt = 0.01 * lightness;
    [lightness, hunt * 500.0 * (x - y), hunt * 200.0 * (y - z)]
}

/// Distance of lightness plus distance of chroma (`HyAB`).
fn distance(a: [f64; 3], b: [f64; 3]) -> f64 {
    (a[0] - b[0]).abs() + (a[1] - b[1]).hypot(a[2] - b[2])
}

/// The distance of two colours as seen, stretched to 0..=1.
fn color_difference(a: [f64; 3], b: [f64; 3]) -> f64 {
    let green = lab_with_hunt(Rgb::new(0.0, 1.0, 0.0));
    let blue = lab_with_hunt(Rgb::new(0.0, 0.0, 1.0));
    let largest = pow(distance(green, blue), COLOR_EXPONENT);
    let found = pow(distance(a, b), COLOR_EXPONENT);
    let cutoff = CUTOFF * largest;
    let stretched = if found < cutoff {
        CUTOFF_TARGET / cutoff * found
    } else {
        CUTOFF_TARGET + (found - cutoff) / (largest - cutoff) * (1.0 - CUTOFF_TARGET)
    };
    stretched.clamp(0.0, 1.0)
}

/// How much of an edge and how much of a point each pixel is.
fn features(lightness: &Plane) -> Vec<[f64; 2]> {
    let deviation = 0.5 * FEATURE_WIDTH * PIXELS_PER_DEGREE;
    let radius = (3.0 * deviation).ceil();
    let gauss = |x: f64| exp(-x * x / (2.0 * deviation * deviation));
    let across = kernel(radius, gauss);
    let sum: f64 = across.iter().sum();
    let across: Vec<f64> = across.iter().map(|x| x / sum).collect();
    let edge = balanced(kernel(radius, |x| -x * gauss(x)));
    let point = balanced(kernel(radius, |x| {
        (x * x / (deviation * deviation) - 1.0) * gauss(x)
    }));
    let gray = Plane {
        values: lightness
            .values
            .iter()
            .map(|y| (y + 16.0) / 116.0)
            .collect(),
        width: lightness.width,
    };
    let strength = |along: &[f64]| -> Vec<f64> {
        let x = gray.convolved(along, &across);
        let y = gray.convolved(&across, along);
        let both = x.values.iter().zip(&y.values);
        both.map(|(x, y)| x.hypot(*y)).collect()
    };
    let (edges, points) = (strength(&edge), strength(&point));
    edges.into_iter().zip(points).map(|(e, p)| [e, p]).collect()
}

/// Values of a function at whole numbers from -radius to radius.
fn kernel(radius: f64, value: impl Fn(f64) -> f64) -> Vec<f64> {
    let n = radius as i32;
    (-n..=n).map(|x| value(f64::from(x))).collect()
}

/// The kernel with positive values that sum to 1 and negative ones that sum to -1.
fn balanced(kernel: Vec<f64>) -> Vec<f64> {
    let positive: f64 = kernel.iter().filter(|x| **x > 0.0).sum();
    let negative: f64 = -kernel.iter().filter(|x| **x < 0.0).sum::<f64>();
    let balance = |x: f64| if x > 0.0 { x / positive } else { x / negative };
    kernel.into_iter().map(balance).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    const SIZE: (u32, u32) = (48, 40);

    fn of(color: impl Fn(usize, usize) -> [u8; 3]) -> Vec<u8> {
        let (width, height) = (SIZE.0 as usize, SIZE.1 as usize);
        let pixels = (0..width * height).flat_map(|at| color(at % width, at / width));
        pixels.collect()
    }

    fn mean(a: &[u8], b: &[u8]) -> f64 {
        summary(&difference(a, b, SIZE)).0
    }

    /// White against black: √ aside, (100^0.7 - 0.4 c)/(0.6 c) · 0.05 + 0.95 with c = HyAB(green, blue)^0.7: 0.967, as the authors' program prints.
    #[test]
    fn even_pictures_differ_as_their_colors_do() {
        let [black, white] = [0, 255].map(|gray| of(|_, _| [gray; 3]));
        assert_eq!(mean(&white, &white), 0.0);
        assert!((mean(&black, &white) - 0.967).abs() < 0.001);
        let (green, blue) = (of(|_, _| [0, 255, 0]), of(|_, _| [0, 0, 255]));
        assert!((mean(&green, &blue) - 1.0).abs() < 1e-9);
        assert!((mean(&green, &blue) - mean(&blue, &green)).abs() < 1e-12);
    }

    #[test]
    fn fine_noise_is_blurred_away_and_coarse_noise_is_seen() {
        let noisy = |cell: usize| {
            of(move |x, y| {
                let is_light = (x / cell + y / cell).is_multiple_of(2);
                [if is_light { 148 } else { 108 }; 3]
            })
        };
        let even = of(|_, _| [130; 3]);
        let (fine, coarse) = (mean(&even, &noisy(1)), mean(&even, &noisy(12)));
        assert!(
            0.0 < fine && fine < 0.5 * coarse && coarse < 0.5,
            "{fine} {coarse}"
        );
    }

    #[test]
    fn a_moved_edge_differs_where_it_was_and_is() {
        let edge = |at: usize| of(move |x, _| [if x < at { 40 } else { 200 }; 3]);
        let found = difference(&edge(20), &edge(23), SIZE);
        let line = &found[10 * SIZE.0 as usize..];
        assert!(line[21] > 0.5 && line[5] < 0.01 && line[40] < 0.01);
        assert_eq!(summary(&[]), (0.0, 0.0));
    }
}
