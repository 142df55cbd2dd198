//! From radiance to the bytes of a screen: exposure, tone curve, sRGB.

use super::LinearImage;
use crate::color::{Rgb, srgb};
use crate::math::functions::{exp, ln};

/// How values above what a screen can show are brought down.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum ToneCurve {
    /// Cut off at 1, channel by channel: exact below, hard and discoloured above. For measuring.
    Clamp,
    /// Exact up to a knee, then a shoulder that reaches white only in the limit.
    ///
    /// The largest channel is compressed and the others follow in proportion, so hues stay; what is far too bright fades to
    /// white, as it does on film. Follows the idea of [`KhronosNeutral`](crate::references#khronosneutral), with a lower
    /// knee for the range of sunlit leaves and without its black offset.
    #[default]
    Shoulder,
}

/// Where the shoulder begins, in display-linear light. Mid-grey leaves and soil lie below, clouds and sunlit petals above.
const KNEE: f64 = 0.55;

/// How fast colours beyond the shoulder fade to white.
const FADING: f64 = 0.12;

/// What `auto_exposure` makes the typical pixel: the middle grey of photography, 18 % of white.
pub const MIDDLE_GRAY: f64 = 0.18;

/// A subject that fills less of the picture does not decide how bright it is.
pub const LEAST_SUBJECT: f64 = 0.02;

/// Edge in pixels of the blocks that are averaged before their logarithm is taken.
const BLOCK: u32 = 8;

impl ToneCurve {
    /// Display-linear light, 0..=1 per channel, of exposed light.
    #[must_use]
    pub fn apply(self, exposed: Rgb) -> Rgb {
        let clamped = |c: f64| if c.is_nan() { 0.0 } else { c.clamp(0.0, 1.0) };
        match self {
            Self::Clamp => exposed.map(clamped),
            Self::Shoulder => shoulder(exposed.map(|c| c.max(0.0))).map(clamped),
        }
    }
}

/// The shoulder of [`ToneCurve::Shoulder`]: slope 1 at the knee, white at infinity.
fn shoulder(c: Rgb) -> Rgb {
    let peak = c.max_channel();
    if peak <= KNEE {
        return c;
    }
    let room = 1.0 - KNEE;
    let compressed = 1.0 - room * room / (peak - KNEE + room);
    let fade = 1.0 - 1.0 / (FADING * (peak - compressed) + 1.0);
    // Division by an infinite peak would give NaN; such a pixel is white anyway.
    if peak.is_finite() {
        (c * (compressed / peak)).lerp(Rgb::splat(compressed), fade)
    } else {
        Rgb::WHITE
    }
}

/// The factor that brings the typical luminance of a picture's subject to [`MIDDLE_GRAY`].
///
/// `is_subject` says of each pixel whether it shows a surface that does not shine by itself: the sky and lamps are shown as
/// they come out, as a photographer would. If the subject fills less than [`LEAST_SUBJECT`] of the picture, all pixels count.
/// The typical luminance is a geometric mean over blocks of 8 × 8 pixels, as the log-average of
/// [Reinhard2002, eq. 1](crate::references#reinhard2002), over blocks so that the grain of a picture with few samples does
/// not pull it down. Each block weighs with the root of its luminance, so that a large dark ground beyond the reach of a
/// lamp does not count, and one that is black not at all. 1 for a black picture. For a film, decide it once.
///
/// # Panics
/// If `is_subject` does not have one entry for each pixel.
#[must_use]
pub fn auto_exposure(image: &LinearImage, is_subject: &[bool]) -> f64 {
    assert_eq!(
        image.pixels.len(),
        is_subject.len(),
        "invariant: one entry for each pixel"
    );
    let n_subject = is_subject.iter().filter(|&&is| is).count();
    let counts_all = (n_subject as f64) < LEAST_SUBJECT * is_subject.len() as f64;
    let (mut sum, mut weights) = (0.0, 0.0);
    for y0 in (0..image.height).step_by(BLOCK as usize) {
        for x0 in (0..image.width).step_by(BLOCK as usize) {
            let counts = |pixel: usize| counts_all || is_subject[pixel];
            let (luminance, n) = block_luminance(image, x0, y0, counts);
            if luminance > 0.0 && luminance.is_finite() {
                let weight = n * luminance.sqrt();
                sum += weight * ln(luminance);
                weights += weight;
            }
        }
    }
    if weights > 0.0 {
        MIDDLE_GRAY / exp(sum / weights)
    } else {
        1.0
    }
}

/// Mean luminance, and number, of the pixels that count in the block with this first pixel.
fn block_luminance(
    image: &LinearImage,
    x0: u32,
    y0: u32,
    counts: impl Fn(usize) -> bool,
) -> (f64, f64) {
    let (x1, y1) = (
        (x0 + BLOCK).min(image.width),
        (y0 + BLOCK).min(image.height),
    );
    let rows = (y0..y1).map(|y| (y as usize) * image.width as usize);
    let pixels = rows.flat_map(|row| row + x0 as usize..row + x1 as usize);
    let (sum, n) = pixels
        .filter(|&pixel| counts(pixel))
        .fold((0.0, 0.0), |(sum, n), pixel| {
            (sum + image.pixels[pixel].luminance(), n + 1.0)
        });
    (sum / f64::max(n, 1.0), n)
}

/// The picture as sRGB bytes, red, green, blue, row by row: radiance × `exposure`, tone curve, sRGB transfer.
#[must_use]
pub fn to_srgb8(image: &LinearImage, exposure: f64, curve: ToneCurve) -> Vec<u8> {
    let shown = image
        .pixels
        .iter()
        .map(|pixel| curve.apply(*pixel * exposure));
    shown
        .flat_map(|c| c.to_array().map(srgb::encode_u8))
        .collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    fn flat(width: u32, height: u32, value: Rgb) -> LinearImage {
        LinearImage {
            width,
            height,
            pixels: vec![value; (width * height) as usize],
        }
    }

    fn exposed(image: &LinearImage) -> f64 {
        auto_exposure(image, &vec![true; image.pixels.len()])
    }

    /// A picture of 64 × 64 pixels with a square of `side` pixels in a corner.
    fn square(side: usize, inside: f64, outside: f64) -> (LinearImage, Vec<bool>) {
        let mut image = flat(64, 64, Rgb::splat(outside));
        let mut is_subject = vec![false; 64 * 64];
        for y in 0..side {
            image.pixels[y * 64..y * 64 + side].fill(Rgb::splat(inside));
            is_subject[y * 64..y * 64 + side].fill(true);
        }
        (image, is_subject)
    }

    #[test]
    fn a_flat_picture_becomes_middle_gray() {
        for luminance in [1e-20, 0.3, 1e20] {
            let image = flat(19, 7, Rgb::splat(luminance));
            let exposure = exposed(&image);
            assert!((exposure * luminance - 0.18).abs() < 1e-12);
            assert_eq!(to_srgb8(&image, exposure, ToneCurve::Shoulder)[0], 118);
        }
    }

    #[test]
    fn black_around_the_subject_does_not_count_and_black_pictures_are_safe() {
        assert_eq!(exposed(&flat(64, 64, Rgb::BLACK)), 1.0);
        assert_eq!(exposed(&flat(0, 0, Rgb::BLACK)), 1.0);
        assert!((exposed(&square(16, 0.5, 0.0).0) - 0.36).abs() < 1e-12);
    }

    #[test]
    fn what_the_lamp_does_not_reach_hardly_counts() {
        // A sixth of a picture is lit, the rest is 10,000 times darker: a plain log-average would overexpose 2000 times.
        let exposure = exposed(&square(26, 1.0, 1e-4).0);
        assert!(exposure < 3.0 * 0.18, "{exposure}");
    }

    #[test]
    fn the_sky_round_the_subject_does_not_count_unless_the_subject_is_tiny() {
        let (plant, is_subject) = square(16, 0.1, 3.0);
        assert!((auto_exposure(&plant, &is_subject) - 1.8).abs() < 1e-12);
        let (dot, is_subject) = square(4, 0.1, 3.0);
        assert!(auto_exposure(&dot, &is_subject) < 0.07);
    }

    #[test]
    fn shoulder_is_exact_below_monotone_above_and_reaches_white() {
        let gray = |v: f64| ToneCurve::Shoulder.apply(Rgb::splat(v)).r;
        assert_eq!(gray(0.4), 0.4);
        let mut last = 0.0;
        for i in 0..2000 {
            let now = gray(f64::from(i) * 0.01);
            assert!(now >= last && now <= 1.0, "{i}");
            last = now;
        }
        assert!(last > 0.97);
        for extreme in [f64::INFINITY, 1e300] {
            assert!((gray(extreme) - 1.0).abs() < 1e-12);
        }
        assert_eq!(gray(f64::NAN), 0.0);
    }

    #[test]
    fn hues_survive_the_shoulder_until_they_fade() {
        let green = ToneCurve::Shoulder.apply(Rgb::new(0.4, 0.9, 0.1));
        assert!(green.g > green.r && green.r > green.b);
        assert!((green.r - green.b) / (green.g - green.b) > 0.3);
        let blinding = ToneCurve::Shoulder.apply(Rgb::new(1.0, 1e4, 1.0));
        assert!(blinding.min_channel() > 0.95);
    }
}
