//! A photon map made ready for questions: irradiance precomputed at some photons' places.
//!
//! Source: [`Christensen1999`](crate::references#christensen1999), with the places thinned out to a fraction of the kernel's radius,
//! whatever the number of photons, and with interpolation between them instead of the nearest one. A question then costs a search
//! among few samples, however many photons there are.

use super::estimate::{self, Hidden};
use super::grid::{Grid, cell};
use super::radius::kernel_radius;
use super::stored::{PackedNormal, Stored, facing};
use crate::color::Rgb;
use crate::math::frame::Frame;
use crate::math::{PrimitiveId, Ray};
use crate::scene::{Piece, Scene, SurfacePoint};
use glam::{DVec3, Vec3};
use rayon::prelude::*;

/// Distance between samples, in radii of the kernel.
const SPACING: f64 = 1.0 / 3.0;

/// How far a sample is used, in spacings: every point of a cell is that near to the sample in the cell.
const USE: f64 = 2.0;

/// Weight of samples of one layer that need no help of coarser ones: that of one sample half a spacing away.
const ENOUGH: f64 = 0.88;

/// Least cosine between the normals of a point and of a sample it takes light from.
const SAME_NORMAL: f64 = 0.9;

/// How far from the tangent plane of a point a sample may lie, in spacings.
const THICKNESS: f64 = 0.3;

/// How high above the surface the way from a sample to a point is looked along, in radii.
const LIFT: f64 = 0.1;

/// Irradiance at one place.
#[derive(Clone, Copy, Debug)]
pub(super) struct Sample {
    position: Vec3,
    normal: Vec3,
    /// The normal as it was found, which tells `normal` exactly.
    packed: PackedNormal,
    irradiance: Vec3,
    /// Radius of its kernel, metres, and what is hidden from it there.
    radius: f32,
    hidden: Hidden,
}

/// All that makes a sample: position, normal, irradiance, radius and what is hidden.
pub(super) type SampleParts = (Vec3, PackedNormal, Vec3, f32, Hidden);

impl Sample {
    /// The sample of these parts.
    pub(super) fn of((position, packed, irradiance, radius, hidden): SampleParts) -> Self {
        Self {
            position,
            normal: packed.unpack().as_vec3(),
            packed,
            irradiance,
            radius,
            hidden,
        }
    }

    /// What it is made of.
    pub(super) fn parts(&self) -> SampleParts {
        let Self {
            position,
            packed,
            irradiance,
            radius,
            hidden,
            ..
        } = *self;
        (position, packed, irradiance, radius, hidden)
    }

    /// Whether something stands between it and a point, both relative to `center`. A ray just above the surface tells, but only
    /// where anything at all stands near the sample.
    fn is_hidden(&self, scene: &Scene, center: DVec3, point: DVec3) -> bool {
        if self.hidden.is_none() {
            return false;
        }
        let position = self.position.as_dvec3();
        let local = Frame::from_normal(self.normal.as_dvec3()).to_local(point - position);
        if self.hidden.holds(local.truncate() / f64::from(self.radius)) {
            return true;
        }
        let lift = self.normal.as_dvec3() * (LIFT * f64::from(self.radius));
        let to = point - position;
        let distance = to.length();
        let ray = |w| Ray::new(center + position + lift, w).until(distance);
        to.try_normalize().is_some_and(|w| scene.occluded(&ray(w)))
    }
}

/// Irradiance of one side of a small flat piece: by its number and the side (front first).
#[derive(Clone, Copy, Debug)]
pub(super) struct PieceLight {
    /// The piece, and whether it is the back.
    pub(super) key: (PrimitiveId, bool),
    /// W/m².
    pub(super) irradiance: Rgb,
}

/// Samples of one density.
#[derive(Debug)]
pub(super) struct Layer {
    spacing: f64,
    samples: Grid<Sample>,
}

/// The light of one map.
#[derive(Debug)]
pub(super) struct IrradianceMap {
    /// What positions are relative to.
    pub(super) center: DVec3,
    /// Flat pieces of up to twice this size have one irradiance for each side, metres.
    pub(super) radius: f64,
    /// The finest first.
    pub(super) layers: Vec<Layer>,
    /// Sorted by key.
    pub(super) pieces: Vec<PieceLight>,
}

impl Layer {
    /// A layer of samples that are about `spacing` metres apart.
    pub(super) fn new(samples: Vec<Sample>, spacing: f64) -> Self {
        let place = |sample: &Sample| sample.position.as_dvec3();
        Self {
            spacing,
            samples: Grid::new(samples, USE * spacing, place),
        }
    }

    /// Metres between samples.
    pub(super) fn spacing(&self) -> f64 {
        self.spacing
    }

    /// All samples, in an order that [`new`](Self::new) keeps.
    pub(super) fn samples(&self) -> &[Sample] {
        self.samples.things()
    }

    /// Weighted sum of the irradiance near a point, and the weights.
    fn near(&self, scene: &Scene, center: DVec3, position: DVec3, normal: DVec3) -> (DVec3, f64) {
        let (mut sum, mut weights) = (DVec3::ZERO, 0.0);
        self.samples.near(position, |sample| {
            if let Some(share) = self.share(sample, position, normal)
                && !sample.is_hidden(scene, center, position)
            {
                let weight = (1.0 - share) * (1.0 - share);
                sum += sample.irradiance.as_dvec3() * weight;
                weights += weight;
            }
        });
        (sum, weights)
    }

    /// The nearest sample in the cell of the grid round a point.
    fn one(&self, position: DVec3, normal: DVec3) -> Option<Sample> {
        let mut best: Option<(f64, Sample)> = None;
        self.samples.around(position, |sample| {
            if let Some(share) = self.share(sample, position, normal)
                && best.is_none_or(|(least, _)| share < least)
            {
                best = Some((share, *sample));
            }
        });
        best.map(|(_, sample)| sample)
    }

    /// How far away a sample is, squared, as a share of how far it is used; `None` beyond that and on another surface.
    fn share(&self, sample: &Sample, position: DVec3, normal: DVec3) -> Option<f64> {
        let reach = USE * self.spacing;
        let to = sample.position.as_dvec3() - position;
        let share = to.length_squared() / (reach * reach);
        let is_same = sample.normal.as_dvec3().dot(normal) > SAME_NORMAL
            && to.dot(normal).abs() <= THICKNESS * self.spacing;
        (share < 1.0 && is_same).then_some(share)
    }
}

impl IrradianceMap {
    /// Makes the photons of a scene ready. `area` is that of the kernel in m², or `None` where it is to be chosen; `center` what
    /// their positions are relative to.
    pub(super) fn new(
        scene: &Scene,
        photons: Vec<Stored>,
        center: DVec3,
        area: Option<f64>,
    ) -> Option<Self> {
        let size = scene.bounds().diagonal().length();
        let radius = kernel_radius(&photons, area, size)?;
        let (on_pieces, photons): (Vec<Stored>, Vec<Stored>) = photons
            .into_par_iter()
            .partition(|photon| small_piece(scene, photon, radius).is_some());
        let pieces = piece_lights(scene, &on_pieces, radius);
        let spacing = radius * SPACING;
        let places = thinned(&photons, spacing);
        let photons = Grid::new(photons, radius, Stored::position);
        let sample = |place: &Stored| {
            // As the sample will have them, so that what is hidden is found again in the same frame.
            let (position, normal) = (place.position(), place.normal().as_vec3().as_dvec3());
            let own = radius.min(place.flat_extent());
            let at = (position, normal);
            let (light, hidden) = estimate::irradiance(scene, &photons, center, at, own);
            let light = DVec3::from_array(light.to_array()).as_vec3();
            Sample::of((
                position.as_vec3(),
                place.packed_normal(),
                light,
                own as f32,
                hidden,
            ))
        };
        let samples: Vec<Sample> = places.par_iter().map(sample).collect();
        Some(Self {
            center,
            radius,
            layers: vec![Layer::new(samples, spacing)],
            pieces,
        })
    }

    /// Radius of the kernel, metres.
    pub(super) fn radius(&self) -> f64 {
        self.radius
    }

    /// Irradiance as [`irradiance`](Self::irradiance) gives it, but from a single sample that is near: coarser, and found much
    /// faster. For what is summed over many points.
    pub(super) fn coarse_irradiance(
        &self,
        scene: &Scene,
        point: &SurfacePoint,
        piece: &Piece,
        w: DVec3,
    ) -> Rgb {
        let normal = facing(point.normal_g, w);
        if self.knows_wholly(piece) {
            return self.whole(point, piece, normal);
        }
        let position = point.position - self.center;
        for layer in &self.layers {
            if let Some(sample) = layer.one(position, normal)
                && !sample.is_hidden(scene, self.center, position)
            {
                return Rgb::from_array(sample.irradiance.as_dvec3().to_array());
            }
        }
        // None in these cells, or something stands before them: perhaps there are others.
        self.irradiance(scene, point, piece, w)
    }

    /// Irradiance of the side `normal` of a small piece.
    fn whole(&self, point: &SurfacePoint, piece: &Piece, normal: DVec3) -> Rgb {
        let Piece::Flat { first, .. } = *piece else {
            return Rgb::BLACK;
        };
        let key = (first, normal.dot(point.normal_g) < 0.0);
        let found = self.pieces.binary_search_by_key(&key, |piece| piece.key);
        found.map_or(Rgb::BLACK, |at| self.pieces[at].irradiance)
    }

    /// Whether the piece is so small that its light is known as a whole.
    pub(super) fn knows_wholly(&self, piece: &Piece) -> bool {
        matches!(piece, Piece::Flat { size, .. } if *size <= 2.0 * self.radius)
    }

    /// Places of the world on its surfaces, not farther apart than the kernel shows, with the normal of the side.
    pub(super) fn places(&self) -> impl Iterator<Item = (DVec3, DVec3)> {
        let place = |sample: &Sample| {
            let position = self.center + sample.position.as_dvec3();
            (position, sample.normal.as_dvec3())
        };
        let layers = self.layers.iter();
        layers.flat_map(|layer| layer.samples()).map(place)
    }

    /// Least distance between those places, metres.
    pub(super) fn spacing(&self) -> f64 {
        let layers = self.layers.iter().map(Layer::spacing);
        layers.fold(self.radius, f64::min)
    }

    /// Irradiance at a point, which lies on this piece, on the side that `w` points to, W/m² per channel.
    pub(super) fn irradiance(
        &self,
        scene: &Scene,
        point: &SurfacePoint,
        piece: &Piece,
        w: DVec3,
    ) -> Rgb {
        let normal = facing(point.normal_g, w);
        if self.knows_wholly(piece) {
            return self.whole(point, piece, normal);
        }
        let position = point.position - self.center;
        // Where there are fine samples they count; coarser ones fill what they leave.
        let mut left = 1.0;
        let (mut sum, mut weights) = (DVec3::ZERO, 0.0);
        for layer in &self.layers {
            let (more, weight) = layer.near(scene, self.center, position, normal);
            sum += more * left;
            weights += weight * left;
            left *= (1.0 - weight / ENOUGH).max(0.0);
            if left == 0.0 {
                break;
            }
        }
        if weights > 0.0 {
            Rgb::from_array((sum / weights).to_array())
        } else {
            Rgb::BLACK
        }
    }
}

/// The flat piece that a photon lies on and its area, if that is smaller than the kernel.
fn small_piece(scene: &Scene, photon: &Stored, radius: f64) -> Option<(PrimitiveId, f64)> {
    match scene.piece(photon.piece()?) {
        Piece::Flat { first, area, size } if size <= 2.0 * radius => Some((first, area)),
        Piece::Flat { .. } | Piece::Body(_) | Piece::Large => None,
    }
}

/// All light of each side of the small pieces, over their areas.
fn piece_lights(scene: &Scene, photons: &[Stored], radius: f64) -> Vec<PieceLight> {
    let mut found: Vec<(PrimitiveId, bool, Rgb)> = photons
        .par_iter()
        .filter_map(|photon| {
            let (first, area) = small_piece(scene, photon, radius)?;
            Some((first, !photon.is_front(), photon.power() / area))
        })
        .collect();
    // Stable: photons of a side stay in their order, so their sum is always the same.
    found.par_sort_by_key(|(first, is_back, _)| (*first, *is_back));
    let sides = found.chunk_by(|a, b| (a.0, a.1) == (b.0, b.1));
    let light = |side: &[(PrimitiveId, bool, Rgb)]| PieceLight {
        key: (side[0].0, side[0].1),
        irradiance: side.iter().map(|(_, _, irradiance)| *irradiance).sum(),
    };
    sides.map(light).collect()
}

/// Photons whose places are sampled: one of each cell of this width and of each of six main directions of the normal: the first.
fn thinned(photons: &[Stored], width: f64) -> Vec<Stored> {
    let mut keys: Vec<([i32; 3], u8, u32)> = photons
        .par_iter()
        .enumerate()
        .map(|(at, photon)| {
            let normal = photon.normal();
            let axis = normal.abs().max_position();
            let direction = 2 * axis as u8 + u8::from(normal[axis] < 0.0);
            (
                cell(photon.position(), width).to_array(),
                direction,
                at as u32,
            )
        })
        .collect();
    keys.par_sort_unstable();
    keys.dedup_by_key(|(cell, direction, _)| (*cell, *direction));
    keys.iter()
        .map(|(_, _, at)| photons[*at as usize])
        .collect()
}
