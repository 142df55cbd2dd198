//! The linear triple all light is carried in.

use std::iter::Sum;
use std::ops::{Add, AddAssign, Div, Index, Mul, MulAssign, Sub};

/// Three channels of light or reflectance on the linear sRGB primaries (white D65).
///
/// The unit is the context's: dimensionless for a reflectance in 0..=1, W/(m² sr) per channel for a radiance, W/m² for an
/// irradiance. A source of power P has channels that *sum* to P. There is no alpha and no gamma here.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Rgb {
    /// Red.
    pub r: f64,
    /// Green.
    pub g: f64,
    /// Blue.
    pub b: f64,
}

impl Rgb {
    /// No light, or a perfect absorber.
    pub const BLACK: Self = Self::splat(0.0);
    /// One in each channel: the perfect diffuse reflector.
    pub const WHITE: Self = Self::splat(1.0);

    /// The triple `(r, g, b)`.
    #[must_use]
    pub const fn new(r: f64, g: f64, b: f64) -> Self {
        Self { r, g, b }
    }

    /// The same value in the three channels.
    #[must_use]
    pub const fn splat(value: f64) -> Self {
        Self::new(value, value, value)
    }

    /// The three channels in the order red, green, blue.
    #[must_use]
    pub const fn to_array(self) -> [f64; 3] {
        [self.r, self.g, self.b]
    }

    /// From the three channels in the order red, green, blue.
    #[must_use]
    pub const fn from_array([r, g, b]: [f64; 3]) -> Self {
        Self::new(r, g, b)
    }

    /// Relative luminance Y of the linear sRGB primaries: what the eye calls brightness. Rows of IEC 61966-2-1 (Rec. 709).
    #[must_use]
    pub const fn luminance(self) -> f64 {
        0.2126 * self.r + 0.7152 * self.g + 0.0722 * self.b
    }

    /// Sum over the channels: for a flux in watts per channel, the watts.
    #[must_use]
    pub const fn sum(self) -> f64 {
        self.r + self.g + self.b
    }

    /// Mean of the channels.
    #[must_use]
    pub const fn mean(self) -> f64 {
        self.sum() / 3.0
    }

    /// The largest channel.
    #[must_use]
    pub const fn max_channel(self) -> f64 {
        self.r.max(self.g).max(self.b)
    }

    /// The smallest channel.
    #[must_use]
    pub const fn min_channel(self) -> f64 {
        self.r.min(self.g).min(self.b)
    }

    /// Whether no channel is NaN or infinite.
    #[must_use]
    pub const fn is_finite(self) -> bool {
        self.r.is_finite() && self.g.is_finite() && self.b.is_finite()
    }

    /// Whether all channels are exactly 0.
    #[must_use]
    pub fn is_black(self) -> bool {
        self == Self::BLACK
    }

    /// `f` of every channel.
    #[must_use]
    pub fn map(self, mut f: impl FnMut(f64) -> f64) -> Self {
        Self::new(f(self.r), f(self.g), f(self.b))
    }

    /// `(1 - t)·self + t·other`.
    #[must_use]
    pub fn lerp(self, other: Self, t: f64) -> Self {
        self * (1.0 - t) + other * t
    }
}

impl Add for Rgb {
    type Output = Self;
    fn add(self, o: Self) -> Self {
        Self::new(self.r + o.r, self.g + o.g, self.b + o.b)
    }
}

impl Sub for Rgb {
    type Output = Self;
    fn sub(self, o: Self) -> Self {
        Self::new(self.r - o.r, self.g - o.g, self.b - o.b)
    }
}

impl Mul for Rgb {
    type Output = Self;
    fn mul(self, o: Self) -> Self {
        Self::new(self.r * o.r, self.g * o.g, self.b * o.b)
    }
}

impl Mul<f64> for Rgb {
    type Output = Self;
    fn mul(self, k: f64) -> Self {
        self.map(|c| c * k)
    }
}

impl Mul<Rgb> for f64 {
    type Output = Rgb;
    fn mul(self, c: Rgb) -> Rgb {
        c * self
    }
}

impl Div<f64> for Rgb {
    type Output = Self;
    fn div(self, k: f64) -> Self {
        self.map(|c| c / k)
    }
}

impl AddAssign for Rgb {
    fn add_assign(&mut self, o: Self) {
        *self = *self + o;
    }
}

impl MulAssign for Rgb {
    fn mul_assign(&mut self, o: Self) {
        *self = *self * o;
    }
}

impl MulAssign<f64> for Rgb {
    fn mul_assign(&mut self, k: f64) {
        *self = *self * k;
    }
}

impl Sum for Rgb {
    fn sum<I: Iterator<Item = Self>>(iter: I) -> Self {
        iter.fold(Self::BLACK, Add::add)
    }
}

impl Index<usize> for Rgb {
    type Output = f64;
    fn index(&self, channel: usize) -> &f64 {
        match channel {
            0 => &self.r,
            1 => &self.g,
            _ => &self.b,
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn white_has_luminance_one_and_channels_keep_their_places() {
        assert!((Rgb::WHITE.luminance() - 1.0).abs() < 1e-15);
        let c = Rgb::new(1.0, 2.0, 4.0);
        assert_eq!(c * c - c + Rgb::WHITE, Rgb::new(1.0, 3.0, 13.0));
        assert_eq!((c * 2.0 / 4.0).to_array(), [0.5, 1.0, 2.0]);
        assert_eq!((c[0], c[1], c[2]), (1.0, 2.0, 4.0));
        assert_eq!(c.sum(), 7.0);
        assert_eq!((c.max_channel(), c.min_channel()), (4.0, 1.0));
        assert_eq!([c, c].into_iter().sum::<Rgb>(), c * 2.0);
        assert_eq!(c.lerp(Rgb::WHITE, 0.5), Rgb::new(1.0, 1.5, 2.5));
    }

    #[test]
    fn nan_and_infinity_are_not_finite() {
        assert!(!Rgb::new(f64::NAN, 0.0, 0.0).is_finite());
        assert!(!Rgb::new(0.0, f64::INFINITY, 0.0).is_finite());
        assert!(Rgb::WHITE.is_finite());
    }
}
