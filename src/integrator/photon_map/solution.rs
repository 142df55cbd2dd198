//! The maps of a scene as bytes, and back.
//!
//! Little-endian numbers, one after the other: photons emitted and stored, then each map as its middle, its size of pieces, its layers
//! of samples, its pieces and its places. Only what views ask for is kept, not the photons: 35 bytes for a sample (49 where something hides a part of
//! its surroundings), of which there are fewer than photons. Whoever reads trusts nothing: counts are compared with the bytes that are
//! left before memory is asked for, and numbers that no solution has are refused.

use super::estimate::Hidden;
use super::final_gather::FinalGather;
use super::irradiance::{IrradianceMap, Layer, Sample};
use super::pieces::PieceLight;
use super::stored::PackedNormal;
use crate::color::Rgb;
use crate::integrator::Unreadable;
use crate::math::PrimitiveId;
use glam::{DVec3, Vec3};
use std::sync::{Arc, OnceLock};

/// Bytes of a sample from which nothing is hidden.
const SAMPLE: usize = 35;

/// Bytes of what is hidden from a sample.
const HIDDEN: usize = 14;

/// Bytes of a place without light.
const PLACE: usize = 18;

/// Bytes of a piece.
const PIECE: usize = 33;

/// The most layers that a map has.
const MOST_LAYERS: u32 = 64;

/// The maps of a scene: all that its views need.
#[derive(Debug, Default)]
pub struct PhotonSolution {
    pub(super) global: Option<IrradianceMap>,
    pub(super) caustic: Option<IrradianceMap>,
    /// Photons sent.
    pub emitted: u64,
    /// Photons that arrived where they are stored, and were.
    pub stored: u64,
    /// What views have gathered with the settings of the first of them. Not written: any view finds it again.
    pub(super) gather: OnceLock<Arc<FinalGather>>,
}

impl PhotonSolution {
    /// The solution as bytes.
    #[must_use]
    pub fn to_bytes(&self) -> Vec<u8> {
        let mut out = Vec::new();
        put(&mut out, self.emitted.to_le_bytes());
        put(&mut out, self.stored.to_le_bytes());
        for map in [&self.global, &self.caustic] {
            out.push(u8::from(map.is_some()));
            if let Some(map) = map {
                put_map(&mut out, map);
            }
        }
        out
    }

    /// The solution that these bytes are of.
    ///
    /// # Errors
    /// If they are of none.
    pub fn from_bytes(bytes: &[u8]) -> Result<Self, Unreadable> {
        let mut reader = Reader(bytes);
        let (emitted, stored) = (reader.u64()?, reader.u64()?);
        let (global, caustic) = (reader.perhaps_map()?, reader.perhaps_map()?);
        if !reader.0.is_empty() {
            return Err(Unreadable("more follows after its end"));
        }
        Ok(Self {
            global,
            caustic,
            emitted,
            stored,
            gather: OnceLock::new(),
        })
    }
}

fn put<const N: usize>(out: &mut Vec<u8>, bytes: [u8; N]) {
    out.extend_from_slice(&bytes);
}

fn put_map(out: &mut Vec<u8>, map: &IrradianceMap) {
    for number in [map.center.x, map.center.y, map.center.z, map.radius] {
        put(out, number.to_le_bytes());
    }
    put(out, (map.layers.len() as u32).to_le_bytes());
    for layer in &map.layers {
        put(out, layer.spacing().to_le_bytes());
        put(out, (layer.samples().len() as u64).to_le_bytes());
        out.reserve(layer.samples().len() * SAMPLE);
        layer
            .samples()
            .iter()
            .for_each(|sample| put_sample(out, sample));
    }
    put(out, (map.pieces.len() as u64).to_le_bytes());
    for piece in &map.pieces {
        put(out, piece.key.0.0.to_le_bytes());
        out.push(u8::from(piece.key.1));
        let light = piece.irradiance.to_array();
        light.iter().for_each(|c| put(out, c.to_le_bytes()));
    }
    put(out, (map.places.len() as u64).to_le_bytes());
    for (position, normal) in &map.places {
        let position = position.to_array();
        position.iter().for_each(|c| put(out, c.to_le_bytes()));
        normal.0.iter().for_each(|c| put(out, c.to_le_bytes()));
    }
}

fn put_sample(out: &mut Vec<u8>, sample: &Sample) {
    let (position, normal, irradiance, radius, hidden) = sample.parts();
    let numbers = position.to_array().into_iter();
    let numbers = numbers.chain(irradiance.to_array()).chain([radius]);
    numbers.for_each(|number| put(out, number.to_le_bytes()));
    normal.0.iter().for_each(|c| put(out, c.to_le_bytes()));
    out.push(u8::from(!hidden.is_none()));
    if !hidden.is_none() {
        out.extend_from_slice(&hidden.bits().to_le_bytes()[..HIDDEN]);
    }
}

/// What is left to read.
struct Reader<'b>(&'b [u8]);

impl Reader<'_> {
    fn take<const N: usize>(&mut self) -> Result<[u8; N], Unreadable> {
        let (taken, rest) = self
            .0
            .split_first_chunk::<N>()
            .ok_or(Unreadable("it ends too early"))?;
        self.0 = rest;
        Ok(*taken)
    }

    fn u64(&mut self) -> Result<u64, Unreadable> {
        Ok(u64::from_le_bytes(self.take()?))
    }

    fn flag(&mut self) -> Result<bool, Unreadable> {
        match self.take()? {
            [0] => Ok(false),
            [1] => Ok(true),
            _ => Err(Unreadable("a switch is neither off nor on")),
        }
    }

    fn f64(&mut self) -> Result<f64, Unreadable> {
        let number = f64::from_le_bytes(self.take()?);
        finite(number.is_finite())?;
        Ok(number)
    }

    fn f32(&mut self) -> Result<f32, Unreadable> {
        let number = f32::from_le_bytes(self.take()?);
        finite(number.is_finite())?;
        Ok(number)
    }

    /// A length, m: more than 0.
    fn length(&mut self) -> Result<f64, Unreadable> {
        let length = self.f64()?;
        if length > 0.0 {
            Ok(length)
        } else {
            Err(Unreadable("a length is not positive"))
        }
    }

    fn vec3(&mut self) -> Result<Vec3, Unreadable> {
        Ok(Vec3::new(self.f32()?, self.f32()?, self.f32()?))
    }

    /// How many things of at least `size` bytes follow: no more than there are bytes for.
    fn count(&mut self, size: usize) -> Result<usize, Unreadable> {
        let n = self.u64()?;
        let fits = n <= (self.0.len() / size) as u64 && n < u64::from(u32::MAX);
        if fits {
            Ok(n as usize)
        } else {
            Err(Unreadable("it ends too early"))
        }
    }

    fn perhaps_map(&mut self) -> Result<Option<IrradianceMap>, Unreadable> {
        self.flag()?.then(|| self.map()).transpose()
    }

    fn map(&mut self) -> Result<IrradianceMap, Unreadable> {
        let center = DVec3::new(self.f64()?, self.f64()?, self.f64()?);
        let radius = self.length()?;
        let n_layers = u32::from_le_bytes(self.take()?);
        if n_layers > MOST_LAYERS {
            return Err(Unreadable("it has too many layers"));
        }
        let layers = (0..n_layers).map(|_| self.layer());
        let layers = layers.collect::<Result<Vec<_>, _>>()?;
        let n_pieces = self.count(PIECE)?;
        let pieces = (0..n_pieces).map(|_| self.piece());
        let pieces = pieces.collect::<Result<Vec<_>, _>>()?;
        if !pieces.is_sorted_by(|a, b| a.key < b.key) {
            return Err(Unreadable("its pieces are not in order"));
        }
        let n_places = self.count(PLACE)?;
        let places = (0..n_places).map(|_| Ok((self.vec3()?, self.normal()?)));
        let places = places.collect::<Result<Vec<_>, _>>()?;
        Ok(IrradianceMap {
            center,
            radius,
            layers,
            pieces,
            places,
        })
    }

    fn layer(&mut self) -> Result<Layer, Unreadable> {
        let spacing = self.length()?;
        let n = self.count(SAMPLE)?;
        let samples = (0..n).map(|_| self.sample());
        Ok(Layer::new(samples.collect::<Result<_, _>>()?, spacing))
    }

    fn normal(&mut self) -> Result<PackedNormal, Unreadable> {
        let mut normal = [0; 3];
        for coordinate in &mut normal {
            *coordinate = i16::from_le_bytes(self.take()?);
        }
        Ok(PackedNormal(normal))
    }

    fn sample(&mut self) -> Result<Sample, Unreadable> {
        let (position, irradiance, radius) = (self.vec3()?, self.vec3()?, self.f32()?);
        let normal = self.normal()?;
        let mut bits = [0; 16];
        if self.flag()? {
            bits[..HIDDEN].copy_from_slice(&self.take::<HIDDEN>()?);
        }
        let hidden = Hidden::from_bits(u128::from_le_bytes(bits));
        let hidden = hidden.ok_or(Unreadable("a sample has cells that there are not"))?;
        if irradiance.min_element() < 0.0 || radius <= 0.0 {
            return Err(Unreadable("a sample has negative light or no size"));
        }
        Ok(Sample::of((position, normal, irradiance, radius, hidden)))
    }

    fn piece(&mut self) -> Result<PieceLight, Unreadable> {
        let key = (PrimitiveId(self.u64()?), self.flag()?);
        let irradiance = Rgb::new(self.f64()?, self.f64()?, self.f64()?);
        if irradiance.to_array().iter().any(|c| *c < 0.0) {
            return Err(Unreadable("a piece has negative light"));
        }
        Ok(PieceLight { key, irradiance })
    }
}

fn finite(is_finite: bool) -> Result<(), Unreadable> {
    if is_finite {
        Ok(())
    } else {
        Err(Unreadable("a number is not finite"))
    }
}
