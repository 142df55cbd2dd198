//! Photons that have arrived, and who stores which of them.

use crate::color::Rgb;
use crate::integrator::carrier::facing;
use crate::integrator::photon::{History, Onward, PhotonHit, Visitor};
use crate::material::Optics;
use crate::math::PrimitiveId;
#[cfg(test)]
use crate::scene::SurfacePoint;
use crate::scene::description::OrganId;
use crate::scene::{Piece, Scene};
use glam::{DVec3, Vec3};
use std::collections::BTreeMap;

/// A unit normal; 16 bits per coordinate are good to 0.002°.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) struct PackedNormal(pub(super) [i16; 3]);

impl PackedNormal {
    /// Packs a unit vector.
    pub(super) fn new(normal: DVec3) -> Self {
        let scaled = (normal * f64::from(i16::MAX)).round();
        Self(scaled.to_array().map(|c| c as i16))
    }

    /// The unit vector; up, if there is none.
    pub(super) fn unpack(self) -> DVec3 {
        let [x, y, z] = self.0.map(f64::from);
        DVec3::new(x, y, z).normalize_or(DVec3::Z)
    }
}

/// A photon on a matt surface, in 40 bytes.
#[derive(Clone, Copy, Debug)]
pub(super) struct Stored {
    /// Relative to the middle of the scene.
    position: Vec3,
    /// Normal of the side that it met.
    normal: PackedNormal,
    kind: Kind,
    is_front: bool,
    power: Vec3,
    /// The number of the flat piece or the body in two halves.
    piece: [u32; 2],
}

/// What it lies on.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[repr(u8)]
enum Kind {
    Flat,
    Body,
    Large,
}

impl Stored {
    fn new(hit: &PhotonHit<'_>, center: DVec3, on: Piece) -> Self {
        // Alpha is in the scattering that the picture multiplies with; the light itself is what arrives before alpha.
        let power = hit.power / hit.optics.alpha;
        let normal = facing(hit.point.normal_g, hit.wo);
        let (kind, first) = kind(&on);
        Self {
            position: (hit.point.position - center).as_vec3(),
            normal: PackedNormal::new(normal),
            kind,
            is_front: hit.point.is_front,
            power: DVec3::from_array(power.to_array()).as_vec3(),
            piece: [(first >> 32) as u32, first as u32],
        }
    }

    /// A photon on a large surface, relative to whose middle everything is: for trials.
    pub(super) fn at(position: DVec3, normal: DVec3, power: f64) -> Self {
        Self {
            position: position.as_vec3(),
            normal: PackedNormal::new(normal),
            kind: Kind::Large,
            is_front: true,
            power: Vec3::splat(power as f32),
            piece: [0, 0],
        }
    }

    /// A photon at a point of a piece, relative to the origin, that came to the side of this normal: for trials.
    #[cfg(test)]
    pub(super) fn on(scene: &Scene, point: &SurfacePoint, side: DVec3, power: f64) -> Self {
        let (kind, first) = kind(&scene.piece(point.primitive));
        Self {
            kind,
            is_front: side.dot(point.normal_g) > 0.0,
            piece: [(first >> 32) as u32, first as u32],
            ..Self::at(point.position, side, power)
        }
    }

    /// Where it is, relative to the middle of the scene.
    pub(super) fn position(&self) -> DVec3 {
        self.position.as_dvec3()
    }

    /// Normal of the side that it met.
    pub(super) fn normal(&self) -> DVec3 {
        self.normal.unpack()
    }

    /// The same, as it is stored.
    pub(super) fn packed_normal(&self) -> PackedNormal {
        self.normal
    }

    /// W per channel.
    pub(super) fn power(&self) -> Rgb {
        Rgb::from_array(self.power.as_dvec3().to_array())
    }

    /// Whether it met the front.
    pub(super) fn is_front(&self) -> bool {
        self.is_front
    }

    /// What it lies on; a photon knows nothing of large surfaces.
    pub(super) fn piece(&self, scene: &Scene) -> Piece {
        let [high, low] = self.piece.map(u64::from);
        match self.kind {
            Kind::Flat | Kind::Body => scene.piece(PrimitiveId(high << 32 | low)),
            Kind::Large => Piece::Large,
        }
    }

    /// How far the body that it lies on is about flat, metres; infinite on others.
    pub(super) fn flat_extent(&self, scene: &Scene) -> f64 {
        // Most photons lie on others, which need not be looked at for this.
        match self.kind {
            Kind::Body => flat_extent(&self.piece(scene)),
            Kind::Flat | Kind::Large => f64::INFINITY,
        }
    }
}

/// What a piece is, and the number of its first primitive.
fn kind(piece: &Piece) -> (Kind, u64) {
    match piece {
        Piece::Flat { first, .. } => (Kind::Flat, first.0),
        Piece::Body { first, .. } => (Kind::Body, first.0),
        Piece::Large => (Kind::Large, 0),
    }
}

/// How far a body is about flat, metres; infinite of others.
pub(super) fn flat_extent(piece: &Piece) -> f64 {
    match piece {
        Piece::Body { flat, .. } => *flat,
        Piece::Flat { .. } | Piece::Large => f64::INFINITY,
    }
}

/// Whether a surface has a matt part.
pub(super) fn is_matt_somewhere(optics: &Optics<'_>) -> bool {
    let sides = &optics.scattering.sides;
    sides
        .iter()
        .any(|side| !(side.reflectance.is_black() && side.transmittance.is_black()))
}

/// Which photons are stored.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Wanted {
    /// All but direct light.
    Indirect,
    /// All but direct light and that of caustics.
    IndirectWithoutCaustics,
    /// Those of caustics.
    Caustics,
}

/// Stores the photons of a block.
pub(super) struct Collector<'s> {
    pub(super) scene: &'s Scene,
    pub(super) wanted: Wanted,
    pub(super) center: DVec3,
    pub(super) photons: Vec<Stored>,
    /// Photons for caustics that met each specular organ.
    pub(super) met: BTreeMap<OrganId, u64>,
}

impl Visitor for Collector<'_> {
    fn arrives(&mut self, hit: &PhotonHit<'_>) -> Onward {
        let is_wanted = match self.wanted {
            Wanted::Indirect => hit.history != History::Direct,
            Wanted::IndirectWithoutCaustics => {
                matches!(hit.history, History::Diffuse | History::Unsampled)
            }
            Wanted::Caustics => hit.history == History::Specular,
        };
        if is_wanted && is_matt_somewhere(hit.optics) {
            let piece = self.scene.piece(hit.point.primitive);
            self.photons.push(Stored::new(hit, self.center, piece));
        }
        let goes_on = match self.wanted {
            Wanted::Indirect | Wanted::IndirectWithoutCaustics => true,
            Wanted::Caustics => {
                let mut lobes = hit.optics.scattering.lobes.iter();
                let goes_on = matches!(hit.history, History::Direct | History::Specular)
                    && lobes.any(|lobe| lobe.is_delta());
                if goes_on {
                    *self.met.entry(hit.point.owner()).or_default() += 1;
                }
                goes_on
            }
        };
        if goes_on { Onward::Go } else { Onward::Stop }
    }
}
