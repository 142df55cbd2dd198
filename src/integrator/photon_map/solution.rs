//! The maps of a scene as bytes, and back.
//!
//! Little-endian numbers, one after the other: photons emitted and stored, then each map as its middle, its size of pieces, its layers
//! of samples, its pieces, what pieces share, and its places. Only what views ask for is kept, not the photons: 35 bytes for a sample (49 where something hides a part of
//! its surroundings), of which there are fewer than photons. Numbers that no solution has are refused.

use super::coverage::Coverage;
use super::estimate::Hidden;
use super::irradiance::{IrradianceMap, Layer, Sample};
use super::pieces::PieceLight;
use super::pool::{Cell, Pool};
use super::stored::PackedNormal;
use crate::integrator::Unreadable;
use crate::integrator::bytes::{Reader, put};
use crate::integrator::final_gather::FinalGather;
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

/// Bytes of a cell of pieces.
const CELL: usize = 88;

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
    /// How many photons stand for each source, and for each mirror and glass body. Not written: who solved was told.
    pub sources: Option<Coverage>,
    /// See [`sources`](Self::sources).
    pub specular: Option<Coverage>,
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
        reader.end()?;
        Ok(Self {
            global,
            caustic,
            emitted,
            stored,
            sources: None,
            specular: None,
            gather: OnceLock::new(),
        })
    }
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
    put_pool(out, &map.pool);
    put(out, (map.places.len() as u64).to_le_bytes());
    for (position, normal) in &map.places {
        let position = position.to_array();
        position.iter().for_each(|c| put(out, c.to_le_bytes()));
        normal.0.iter().for_each(|c| put(out, c.to_le_bytes()));
    }
}

fn put_pool(out: &mut Vec<u8>, pool: &Pool) {
    let frame = pool.low.to_array().into_iter().chain([pool.edge]);
    frame.for_each(|number| put(out, number.to_le_bytes()));
    put(out, (pool.cells.len() as u64).to_le_bytes());
    for cell in &pool.cells {
        put(out, cell.begin.to_le_bytes());
        put(out, cell.level.to_le_bytes());
        let light = cell.lobes.iter().flat_map(|lobe| lobe.to_array());
        let numbers = [cell.whole].into_iter().chain(light);
        numbers.for_each(|number| put(out, number.to_le_bytes()));
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

impl Reader<'_> {
    fn perhaps_map(&mut self) -> Result<Option<IrradianceMap>, Unreadable> {
        self.flag()?.then(|| self.map()).transpose()
    }

    fn map(&mut self) -> Result<IrradianceMap, Unreadable> {
        let center = DVec3::new(self.f64()?, self.f64()?, self.f64()?);
        let radius = self.length()?;
        let n_layers = self.u32()?;
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
        let pool = self.pool()?;
        let n_places = self.count(PLACE)?;
        let places = (0..n_places).map(|_| Ok((self.vec3()?, self.normal()?)));
        let places = places.collect::<Result<Vec<_>, _>>()?;
        Ok(IrradianceMap {
            center,
            radius,
            layers,
            pieces,
            pool,
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

    fn pool(&mut self) -> Result<Pool, Unreadable> {
        let (low, edge) = (self.dvec3()?, self.f64()?);
        let n = self.count(CELL)?;
        let cells = (0..n).map(|_| self.cell());
        let pool = Pool {
            low,
            edge,
            cells: cells.collect::<Result<_, _>>()?,
        };
        if pool.is_sound() {
            Ok(pool)
        } else {
            Err(Unreadable("its cells of pieces are not in order"))
        }
    }

    fn cell(&mut self) -> Result<Cell, Unreadable> {
        let (begin, level, whole) = (self.u64()?, self.u32()?, self.f32()?);
        let mut lobes = [Vec3::ZERO; 6];
        for lobe in &mut lobes {
            *lobe = self.vec3()?;
        }
        Ok(Cell {
            begin,
            level,
            whole,
            lobes,
        })
    }

    fn piece(&mut self) -> Result<PieceLight, Unreadable> {
        let key = (PrimitiveId(self.u64()?), self.flag()?);
        let irradiance = self.light()?;
        Ok(PieceLight { key, irradiance })
    }
}
