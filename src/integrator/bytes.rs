//! Numbers as bytes, and back: how solutions are written.
//!
//! All are little-endian, one after the other. Whoever reads trusts nothing: counts are compared with the bytes that are left before
//! memory is asked for, and numbers that are not finite are refused.

use super::Unreadable;
use crate::color::Rgb;
use glam::{DVec3, Vec3};

/// Adds these bytes.
pub(super) fn put<const N: usize>(out: &mut Vec<u8>, bytes: [u8; N]) {
    out.extend_from_slice(&bytes);
}

/// What is left to read.
pub(super) struct Reader<'b>(pub(super) &'b [u8]);

impl Reader<'_> {
    pub(super) fn take<const N: usize>(&mut self) -> Result<[u8; N], Unreadable> {
        let (taken, rest) = self
            .0
            .split_first_chunk::<N>()
            .ok_or(Unreadable("it ends too early"))?;
        self.0 = rest;
        Ok(*taken)
    }

    pub(super) fn u8(&mut self) -> Result<u8, Unreadable> {
        let [byte] = self.take()?;
        Ok(byte)
    }

    pub(super) fn u32(&mut self) -> Result<u32, Unreadable> {
        Ok(u32::from_le_bytes(self.take()?))
    }

    pub(super) fn u64(&mut self) -> Result<u64, Unreadable> {
        Ok(u64::from_le_bytes(self.take()?))
    }

    pub(super) fn flag(&mut self) -> Result<bool, Unreadable> {
        match self.take()? {
            [0] => Ok(false),
            [1] => Ok(true),
            _ => Err(Unreadable("a switch is neither off nor on")),
        }
    }

    pub(super) fn f64(&mut self) -> Result<f64, Unreadable> {
        let number = f64::from_le_bytes(self.take()?);
        finite(number.is_finite())?;
        Ok(number)
    }

    pub(super) fn f32(&mut self) -> Result<f32, Unreadable> {
        let number = f32::from_le_bytes(self.take()?);
        finite(number.is_finite())?;
        Ok(number)
    }

    /// A length, m: more than 0.
    pub(super) fn length(&mut self) -> Result<f64, Unreadable> {
        let length = self.f64()?;
        if length > 0.0 {
            Ok(length)
        } else {
            Err(Unreadable("a length is not positive"))
        }
    }

    pub(super) fn vec3(&mut self) -> Result<Vec3, Unreadable> {
        Ok(Vec3::new(self.f32()?, self.f32()?, self.f32()?))
    }

    pub(super) fn dvec3(&mut self) -> Result<DVec3, Unreadable> {
        Ok(DVec3::new(self.f64()?, self.f64()?, self.f64()?))
    }

    /// Light: not negative.
    pub(super) fn light(&mut self) -> Result<Rgb, Unreadable> {
        let light = Rgb::from_array(self.dvec3()?.to_array());
        if light.to_array().iter().all(|c| *c >= 0.0) {
            Ok(light)
        } else {
            Err(Unreadable("light is negative"))
        }
    }

    /// How many things of at least `size` bytes follow: no more than there are bytes for.
    pub(super) fn count(&mut self, size: usize) -> Result<usize, Unreadable> {
        let n = self.u64()?;
        let fits = n <= (self.0.len() / size) as u64 && n < u64::from(u32::MAX);
        if fits {
            Ok(n as usize)
        } else {
            Err(Unreadable("it ends too early"))
        }
    }

    /// That nothing is left.
    pub(super) fn end(&self) -> Result<(), Unreadable> {
        if self.0.is_empty() {
            Ok(())
        } else {
            Err(Unreadable("more follows after its end"))
        }
    }
}

fn finite(is_finite: bool) -> Result<(), Unreadable> {
    if is_finite {
        Ok(())
    } else {
        Err(Unreadable("a number is not finite"))
    }
}
