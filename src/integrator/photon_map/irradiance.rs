//! A photon map made ready for questions: irradiance precomputed at some photons' places.
//!
//! Source: [`Christensen1999`](crate::references#christensen1999), with the places thinned out to a fraction of the kernel's radius,
//! whatever the number of photons, and with interpolation between them instead of the nearest one. A question then costs a search
//! among few samples, however many photons there are.
//!
//! Where kernels differ in size ([`spots`](super::spots)) there is a layer of samples for each size. Fine ones win where they are.

use super::crossings::area;
use super::estimate::Hidden;
use super::pieces::{PieceLight, small};
use super::pool::Pool;
use super::stored::PackedNormal;
use crate::color::Rgb;
use crate::integrator::carrier::facing;
use crate::integrator::grid::{Grid, Outline};
use crate::math::Ray;
use crate::math::frame::Frame;
use crate::scene::{Piece, Scene, SurfacePoint};
use glam::{DVec3, Vec3};

/// Distance between samples, in radii of the kernel.
pub(super) const SPACING: f64 = 1.0 / 3.0;

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

/// Samples of one density.
#[derive(Debug)]
pub(super) struct Layer {
    spacing: f64,
    samples: Grid<Sample>,
    outline: Outline,
}

/// The light of one map.
#[derive(Debug)]
pub(super) struct IrradianceMap {
    /// What positions are relative to.
    pub(super) center: DVec3,
    /// Pieces that are [`small`] for it have one irradiance for each side, metres.
    pub(super) radius: f64,
    /// The finest first.
    pub(super) layers: Vec<Layer>,
    /// Sorted by key.
    pub(super) pieces: Vec<PieceLight>,
    /// What pieces share that expect few photons.
    pub(super) pool: Pool,
    /// Places on the surfaces as far apart as kernels of the usual size need, if not those of the layers.
    pub(super) places: Vec<(Vec3, PackedNormal)>,
}

impl Layer {
    /// A layer of samples that are about `spacing` metres apart.
    pub(super) fn new(samples: Vec<Sample>, spacing: f64) -> Self {
        let place = |sample: &Sample| sample.position.as_dvec3();
        Self {
            spacing,
            outline: Outline::new(samples.iter().map(place), USE * spacing),
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
        if !self.outline.is_near(position) {
            return (sum, weights);
        }
        let thickness = THICKNESS * self.spacing;
        self.samples
            .near_plane(position, normal, thickness, |sample| {
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

    /// The nearest sample, if one is near enough to be used; that in the cell of the grid round the point where there is one.
    fn one(&self, position: DVec3, normal: DVec3) -> Option<Sample> {
        if !self.outline.is_near(position) {
            return None;
        }
        let nearer = |best: &mut Option<(f64, Sample)>, sample: &Sample| {
            if let Some(share) = self.share(sample, position, normal)
                && best.is_none_or(|(least, _)| share < least)
            {
                *best = Some((share, *sample));
            }
        };
        let mut best = None;
        let samples = &self.samples;
        samples.around(position, |sample| nearer(&mut best, sample));
        if best.is_none() {
            let look = |sample: &Sample| nearer(&mut best, sample);
            samples.near_plane(position, normal, THICKNESS * self.spacing, look);
        }
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
        // None is near, or something stands before it: perhaps there are others.
        self.irradiance(scene, point, piece, w)
    }

    /// Irradiance of the side `normal` of a small piece.
    fn whole(&self, point: &SurfacePoint, piece: &Piece, normal: DVec3) -> Rgb {
        let Some(first) = small(piece, self.radius) else {
            return Rgb::BLACK;
        };
        let is_back = normal.dot(point.normal_g) < 0.0;
        let own = || {
            let key = (first, is_back);
            let found = self.pieces.binary_search_by_key(&key, |piece| piece.key);
            found.map_or(Rgb::BLACK, |at| self.pieces[at].irradiance)
        };
        let is_inside = is_back && matches!(piece, Piece::Body { .. });
        let cell = self.pool.cell(point.position - self.center);
        let Some(cell) = cell.filter(|_| !is_inside) else {
            return own();
        };
        let share = cell.own_share(area(piece));
        if share >= 1.0 {
            own()
        } else if share > 0.0 {
            own() * share + cell.irradiance(normal) * (1.0 - share)
        } else {
            cell.irradiance(normal)
        }
    }

    /// Whether the piece is so small that its light is known as a whole.
    pub(super) fn knows_wholly(&self, piece: &Piece) -> bool {
        small(piece, self.radius).is_some()
    }

    /// Places of the world on its surfaces, not farther apart than the usual kernel shows, with the normal of the side.
    pub(super) fn places(&self) -> impl Iterator<Item = (DVec3, DVec3)> {
        let own = self.places.iter().copied();
        let layers = self.layers.iter().filter(|_| self.places.is_empty());
        let samples = layers.flat_map(Layer::samples);
        let places = own.chain(samples.map(|sample| (sample.position, sample.packed)));
        places.map(|(position, normal)| {
            let normal = normal.unpack().as_vec3().as_dvec3();
            (self.center + position.as_dvec3(), normal)
        })
    }

    /// Least distance between those places, metres.
    pub(super) fn spacing(&self) -> f64 {
        if self.places.is_empty() {
            let layers = self.layers.iter().map(Layer::spacing);
            layers.fold(self.radius, f64::min)
        } else {
            self.radius * SPACING
        }
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
