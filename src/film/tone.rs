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

/// The factor that brings the typical luminance of a picture to [`MIDDLE_GRAY`].
///
/// The typical luminance is the geometric mean over blocks of 8 × 8 pixels that are not black (nothing seen is not
/// darkness): the log-average of [Reinhard2002, eq. 1](crate::references#reinhard2002), over blocks so that the grain of a
/// picture with few samples does not pull it down. 1 for a black picture. For a film, decide it once.
#[must_use]
pub fn auto_exposure(image: &LinearImage) -> f64 {
    let (mut sum, mut n) = (0.0, 0.0);
    for y0 in (0..image.height).step_by(BLOCK as usize) {
        for x0 in (0..image.width).step_by(BLOCK as usize) {
            let luminance = block_luminance(image, x0, y0);
            if luminance > 0.0 && luminance.is_finite() {
                sum += ln(luminance);
                n += 1.0;
            }
        }
    }
    if n > 0.0 {
        MIDDLE_GRAY / exp(sum / n)
    } else {
        1.0
    }
}

/// Mean luminance of the block with this first pixel.
fn block_luminance(image: &LinearImage, x0: u32, y0: u32) -> f64 {
    let (x1, y1) = (
        (x0 + BLOCK).min(image.width),
        (y0 + BLOCK).min(image.height),
    );
    let rows = (y0..y1).map(|y| (y as usize) * image.width as usize);
    let pixels = rows.flat_map(|row| &image.pixels[row + x0 as usize..row + x1 as usize]);
    let sum: f64 = pixels.map(|pixel| pixel.luminance()).sum();
    sum / f64::from((x1 - x0) * (y1 - y0))
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

    #[test]
    fn a_flat_picture_becomes_middle_gray() {
        for luminance in [1e-20, 0.3, 1e20] {
            let image = flat(19, 7, Rgb::splat(luminance));
            let exposure = auto_exposure(&image);
            assert!((exposure * luminance - 0.18).abs() < 1e-12);
            assert_eq!(to_srgb8(&image, exposure, ToneCurve::Shoulder)[0], 118);
        }
    }

    #[test]
    fn black_around_the_subject_does_not_count_and_black_pictures_are_safe() {
        let mut image = flat(64, 64, Rgb::BLACK);
        assert_eq!(auto_exposure(&image), 1.0);
        for y in 0..16 {
            image.pixels[y * 64..y * 64 + 16].fill(Rgb::splat(0.5));
        }
        assert!((auto_exposure(&image) - 0.36).abs() < 1e-12);
        assert_eq!(auto_exposure(&flat(0, 0, Rgb::BLACK)), 1.0);
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
