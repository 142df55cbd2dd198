//! The sRGB transfer (IEC 61966-2-1): between linear light and the numbers stored in 8-bit pictures.

use crate::math::functions::pow;

/// Encodes one linear channel in 0..=1 for display; values outside are clamped, NaN becomes 0.
#[must_use]
pub fn encode(linear: f64) -> f64 {
    let linear = if linear.is_nan() {
        0.0
    } else {
        linear.clamp(0.0, 1.0)
    };
    if linear <= 0.003_130_8 {
        12.92 * linear
    } else {
        // The last bit of the power may fall either side of 1.
        (1.055 * pow(linear, 1.0 / 2.4) - 0.055).min(1.0)
    }
}

/// Linear light of one encoded channel in 0..=1; the inverse of [`encode`].
#[must_use]
pub fn decode(encoded: f64) -> f64 {
    let encoded = if encoded.is_nan() {
        0.0
    } else {
        encoded.clamp(0.0, 1.0)
    };
    if encoded <= 0.040_45 {
        encoded / 12.92
    } else {
        pow((encoded + 0.055) / 1.055, 2.4)
    }
}

/// Encodes one linear channel to 0..=255, rounding to the nearest.
#[must_use]
#[expect(
    clippy::cast_possible_truncation,
    clippy::cast_sign_loss,
    reason = "encode returns 0..=1, so the rounded value lies in 0..=255"
)]
pub fn encode_u8(linear: f64) -> u8 {
    (encode(linear) * 255.0).round() as u8
}

/// Linear light of one stored byte.
#[must_use]
pub fn decode_u8(byte: u8) -> f64 {
    decode(f64::from(byte) / 255.0)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_byte_survives_the_round_trip() {
        for byte in 0..=255 {
            assert_eq!(encode_u8(decode_u8(byte)), byte);
        }
    }

    #[test]
    fn known_values_and_out_of_range_input() {
        assert_eq!(encode_u8(0.18), 118); // middle grey
        assert!((encode(0.5) - 0.735_356_983).abs() < 1e-9);
        assert_eq!((encode(-1.0), encode(f64::NAN)), (0.0, 0.0));
        assert!(encode(7.0) <= 1.0 && encode(7.0) > 1.0 - 1e-15);
        assert_eq!(decode(f64::NAN), 0.0);
        // The two branches meet.
        assert!((encode(0.003_130_8) - encode(0.003_130_801)).abs() < 1e-6);
    }
}
