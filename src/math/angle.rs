//! A plane angle that cannot be mistaken for degrees or radians.

use std::f64::consts::PI;

/// A plane angle.
///
/// Its functions are `libm`'s, so their bits are the same on every machine.
///
/// ```
/// use understory::math::angle::Angle;
/// assert_eq!(Angle::deg(180.0), Angle::rad(std::f64::consts::PI));
/// ```
#[derive(Clone, Copy, Debug, PartialEq, PartialOrd, Default)]
pub struct Angle {
    radians: f64,
}

impl Angle {
    /// An angle of so many degrees.
    pub const fn deg(degrees: f64) -> Self {
        Self {
            radians: degrees / 180.0 * PI,
        }
    }

    /// An angle of so many radians.
    pub const fn rad(radians: f64) -> Self {
        Self { radians }
    }

    /// This angle in degrees.
    pub const fn degrees(self) -> f64 {
        self.radians / PI * 180.0
    }

    /// This angle in radians.
    pub const fn radians(self) -> f64 {
        self.radians
    }

    /// Half of it.
    #[must_use]
    pub const fn half(self) -> Self {
        Self {
            radians: self.radians / 2.0,
        }
    }

    /// Its sine.
    pub fn sin(self) -> f64 {
        libm::sin(self.radians)
    }

    /// Its cosine.
    pub fn cos(self) -> f64 {
        libm::cos(self.radians)
    }

    /// Its tangent.
    pub fn tan(self) -> f64 {
        libm::tan(self.radians)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn degrees_and_radians_are_two_readings_of_one_angle() {
        let right = Angle::deg(90.0);
        assert_eq!(right.radians(), PI / 2.0);
        assert_eq!(right.degrees(), 90.0);
        assert_eq!(right.half(), Angle::rad(PI / 4.0));
        assert_eq!(
            (right.sin(), Angle::deg(60.0).cos() > 0.5 - 1e-15),
            (1.0, true)
        );
        assert!((Angle::deg(45.0).tan() - 1.0).abs() < 1e-15);
    }
}
