//! What is known of a lamp, or of many together, without asking it: where it is, where to it shines, and how strongly.

use super::Light;
use crate::math::Bounds3;
use crate::math::functions::{acos, cos, sin};
use crate::math::tolerance::CONE_SLACK;
use glam::DVec3;
use std::f64::consts::{FRAC_PI_2, PI, TAU};

/// Bounds on the light of some lamps.
///
/// Source: [`ContyKulla2018`](crate::references#contykulla2018): a box, a cone of normals, and the angle to a normal up to
/// which light leaves. Angles in radians.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct LampOutline {
    /// Holds the lamps.
    pub bounds: Bounds3,
    /// Middle of the cone of normals, unit length.
    pub axis: DVec3,
    /// θₒ: half angle of the cone of normals, 0..=π.
    pub spread: f64,
    /// θₑ: how far from a normal light leaves, 0..=π.
    pub emission: f64,
    /// Whether light leaves to the other side of the normals too.
    pub is_two_sided: bool,
    /// The largest radiant intensity, in W/sr summed over the channels, in the direction in which there is most.
    pub strength: f64,
}

/// An outline made ready to be asked from many points.
#[derive(Clone, Copy, Debug)]
pub(super) struct Beam {
    bounds: Bounds3,
    center: DVec3,
    /// Squared radius of the ball round the box.
    radius2: f64,
    axis: DVec3,
    spread: Bend,
    cos_emission: f64,
    is_two_sided: bool,
    /// Whether light leaves by the cosine to the normal.
    is_surface: bool,
}

/// Within its box a lamp counts as this part of the squared radius away, at least.
const INSIDE: f64 = 1.0 / 65_536.0;

/// A point that waits for light.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Receiver {
    /// Where it is, metres.
    pub position: DVec3,
    /// Unit normal of the side that is looked at; `None` if light from everywhere counts alike.
    pub normal: Option<DVec3>,
    /// Whether light from behind counts too.
    pub is_two_sided: bool,
}

impl LampOutline {
    /// The outline of a source without a surface; `None` of parallel light, which has no place.
    #[must_use]
    pub fn of(light: &Light) -> Option<Self> {
        let (position, axis, emission, intensity) = match *light {
            Light::Point {
                position,
                intensity,
            } => (position, DVec3::Z, PI, intensity),
            Light::Spot {
                position,
                axis,
                outer,
                intensity,
                ..
            } => (position, axis, outer.radians(), intensity),
            Light::Directional { .. } => return None,
        };
        Some(Self {
            bounds: Bounds3::of([position]),
            axis,
            spread: 0.0,
            emission,
            is_two_sided: false,
            strength: intensity.sum(),
        })
    }

    /// The outline of both.
    ///
    /// Source: [`ContyKulla2018`](crate::references#contykulla2018).
    #[must_use]
    pub fn union(&self, other: &Self) -> Self {
        let (axis, spread) = cone_of_both((self.axis, self.spread), (other.axis, other.spread));
        Self {
            bounds: self.bounds.union(&other.bounds),
            axis,
            spread,
            emission: self.emission.max(other.emission),
            is_two_sided: self.is_two_sided || other.is_two_sided,
            strength: self.strength + other.strength,
        }
    }

    /// Measure of the directions that light leaves in, for comparing ways to divide lamps.
    ///
    /// Source: [`ContyKulla2018`](crate::references#contykulla2018).
    pub(super) fn orientation(&self) -> f64 {
        let (o, w) = (self.spread, (self.spread + self.emission).min(PI));
        let sides = if self.is_two_sided { 2.0 } else { 1.0 };
        let rest = 2.0 * w * sin(o) - cos(o - 2.0 * w) - 2.0 * o * sin(o) + cos(o);
        sides * (TAU * (1.0 - cos(o)) + FRAC_PI_2 * rest)
    }
}

impl Beam {
    pub(super) fn new(outline: &LampOutline) -> Self {
        Self {
            bounds: outline.bounds,
            center: outline.bounds.center(),
            radius2: 0.25 * outline.bounds.diagonal().length_squared(),
            axis: outline.axis,
            spread: Bend::of(outline.spread),
            cos_emission: cos(outline.emission),
            is_two_sided: outline.is_two_sided,
            is_surface: outline.emission == FRAC_PI_2,
        }
    }

    /// How much of its light arrives at a point at most, per strength, 1/m²: cosines at both ends over the squared distance, as
    /// good as the outline knows. 0 only if none arrives.
    ///
    /// Source: [`ContyKulla2018`](crate::references#contykulla2018), with cosines and sines for angles as in
    /// [`PBRT4`, §12.6.3](crate::references#pbrt4).
    ///
    /// The second number is 1 over the squared distance of the nearest point of the box, 0 with the first. By the middles of boxes
    /// alone a lamp close by, at the rim of all boxes that hold it, would hardly be chosen.
    pub(super) fn nearness(&self, receiver: &Receiver) -> [f64; 2] {
        let least = f64::MIN_POSITIVE.sqrt();
        let nearest = receiver.position.clamp(self.bounds.min, self.bounds.max);
        let gap2 = (nearest - receiver.position).length_squared();
        let close = 1.0 / gap2.max(INSIDE * self.radius2).max(least);
        let to = self.center - receiver.position;
        let distance2 = to.length_squared();
        // Nearer than its own size a lamp is as bright as at that distance. Never 0, so that quotients stay numbers.
        let near2 = distance2.max(self.radius2).max(least);
        let Some(wi) = to.try_normalize().filter(|_| distance2 > self.radius2) else {
            return [1.0 / near2, close];
        };
        // The box looks smaller than this cone.
        let sin2 = self.radius2 / distance2;
        let seen = Bend {
            sin: sin2.sqrt(),
            cos: (1.0 - sin2).sqrt(),
        };
        let toward = -wi.dot(self.axis);
        let leaving = Bend::of_cos(if self.is_two_sided {
            toward.abs()
        } else {
            toward
        });
        let leaving = leaving.less(self.spread).less(seen);
        if leaving.cos < self.cos_emission - CONE_SLACK {
            return [0.0; 2];
        }
        let sent = if self.is_surface {
            leaving.cos.max(CONE_SLACK)
        } else {
            1.0
        };
        let received = receiver.normal.map_or(1.0, |normal| {
            let cos = normal.dot(wi);
            let arriving = Bend::of_cos(if receiver.is_two_sided {
                cos.abs()
            } else {
                cos
            });
            arriving.less(seen).cos + CONE_SLACK
        });
        if received > 0.0 {
            [sent * received / near2, close]
        } else {
            [0.0; 2]
        }
    }
}

/// Cosine and sine of an angle in 0..=π.
#[derive(Clone, Copy, Debug)]
struct Bend {
    cos: f64,
    sin: f64,
}

impl Bend {
    fn of(angle: f64) -> Self {
        Self {
            cos: cos(angle),
            sin: sin(angle),
        }
    }

    fn of_cos(cos: f64) -> Self {
        Self {
            cos,
            sin: (1.0 - cos * cos).max(0.0).sqrt(),
        }
    }

    /// The difference of both angles, 0 if it is negative.
    fn less(self, other: Self) -> Self {
        if self.cos > other.cos {
            return Self { cos: 1.0, sin: 0.0 };
        }
        Self {
            cos: self.cos * other.cos + self.sin * other.sin,
            sin: self.sin * other.cos - self.cos * other.sin,
        }
    }
}

/// The smallest cone that holds two: its axis and half angle.
fn cone_of_both(a: (DVec3, f64), b: (DVec3, f64)) -> (DVec3, f64) {
    let (a, b) = if a.1 >= b.1 { (a, b) } else { (b, a) };
    let between = acos(a.0.dot(b.0).clamp(-1.0, 1.0));
    if (between + b.1).min(PI) <= a.1 {
        return a;
    }
    let spread = 0.5 * (a.1 + between + b.1);
    // Opposite axes have no direction between them.
    let Some(across) = (b.0 - a.0 * a.0.dot(b.0)).try_normalize() else {
        return (a.0, PI);
    };
    if spread >= PI {
        return (a.0, PI);
    }
    let turn = spread - a.1;
    let axis = a.0 * cos(turn) + across * sin(turn);
    (axis.normalize(), (spread + CONE_SLACK).min(PI))
}
