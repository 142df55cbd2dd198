//! The ways besides matt scattering in which a surface throws light back or lets it through.

use super::MaterialError;
use super::fresnel::{dielectric, schlick, sheet};
use crate::color::Rgb;
use crate::math::tolerance::SMOOTHEST_ALPHA;

/// How many lobes a material may have besides its matt part.
pub const MAX_LOBES: usize = 4;

/// One way of scattering, and how much of it there is.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Lobe {
    /// What it does.
    pub kind: LobeKind,
    /// Its share of the light, per channel, 0..=1; it colours what the lobe scatters.
    pub weight: Rgb,
    /// On which sides of the surface it works.
    pub sides: LobeSides,
}

/// The sides of a surface that a lobe works on. Lobes that transmit work on both: light that passes one way passes the other.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum LobeSides {
    /// Both, which is what a surface has unless its sides were told apart.
    #[default]
    Both,
    /// For light that comes from the front.
    Front,
    /// For light that comes from the back.
    Back,
}

/// What a lobe does to light.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum LobeKind {
    /// Mirrors.
    Mirror(Reflection),
    /// Phong's lobe round the mirrored direction, f = (n + 2)/2π · cosⁿ, with exponent n ≥ 0; reciprocal, and never more light
    /// out than in (GroIMP's normalisation, [Lafortune1994](crate::references#lafortune1994)).
    Phong {
        /// n.
        exponent: f64,
    },
    /// Phong's lobe round the direction straight on, behind the surface: light passes, blurred.
    Haze {
        /// n.
        exponent: f64,
    },
    /// Mirrors in tiny facets that are tilted at random (GGX).
    Rough {
        /// α: the squared perceived roughness, above 0, at most 1.
        alpha: f64,
        /// What each facet reflects.
        reflection: Reflection,
    },
    /// The skin of a transparent body that begins behind the surface: reflects and refracts by Fresnel's equations.
    Dielectric {
        /// Index of refraction of the body (behind) relative to what it is in (in front), above 0.
        ior: f64,
        /// α of its facets, at most 1; 0 is smooth.
        alpha: f64,
        /// What the body absorbs, 1/m per channel: e^(-σ d) is left after d metres.
        absorption: Rgb,
    },
    /// A thin flat sheet: reflects like a mirror and lets the rest straight through, reflections inside it included.
    Pane {
        /// Index of refraction of the sheet relative to what is around it, above 0.
        ior: f64,
        /// Fraction of light that is left after crossing the sheet's body once at normal incidence, per channel.
        tint: Rgb,
    },
    /// Lets light straight through, undisturbed.
    Through,
}

/// How much a mirror reflects of what its lobe's weight gives it.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Reflection {
    /// All, at every angle.
    Even,
    /// This colour at normal incidence, everything at grazing, by Schlick's approximation: metals.
    Metal(Rgb),
    /// What the skin of a transparent medium of this relative index of refraction reflects: varnish, wax.
    Varnish(f64),
}

impl Reflection {
    /// Fraction reflected under the cosine `cos` to the normal.
    #[must_use]
    pub fn at(&self, cos: f64) -> Rgb {
        match *self {
            Self::Even => Rgb::WHITE,
            Self::Metal(color) => schlick(color, cos),
            Self::Varnish(ior) => Rgb::splat(dielectric(cos, ior).reflectance),
        }
    }
}

impl LobeSides {
    /// Whether the front (`true`) or back side is among them.
    pub(super) const fn include(self, is_front: bool) -> bool {
        match self {
            Self::Both => true,
            Self::Front => is_front,
            Self::Back => !is_front,
        }
    }
}

impl Lobe {
    /// A lobe of this weight on both sides.
    #[must_use]
    pub const fn new(kind: LobeKind, weight: Rgb) -> Self {
        Self {
            kind,
            weight,
            sides: LobeSides::Both,
        }
    }

    /// Whether each direction is sent into single directions only, so that chance never finds it.
    #[must_use]
    pub const fn is_delta(&self) -> bool {
        match self.kind {
            LobeKind::Mirror(_) | LobeKind::Pane { .. } | LobeKind::Through => true,
            LobeKind::Dielectric { alpha, .. } => alpha < SMOOTHEST_ALPHA,
            LobeKind::Phong { .. } | LobeKind::Haze { .. } | LobeKind::Rough { .. } => false,
        }
    }

    /// Whether a transparent body begins behind it.
    #[must_use]
    pub const fn is_body(&self) -> bool {
        matches!(self.kind, LobeKind::Dielectric { .. })
    }

    /// Whether it lets light through in any way.
    #[must_use]
    pub const fn transmits(&self) -> bool {
        match self.kind {
            LobeKind::Haze { .. }
            | LobeKind::Dielectric { .. }
            | LobeKind::Pane { .. }
            | LobeKind::Through => true,
            LobeKind::Mirror(_) | LobeKind::Phong { .. } | LobeKind::Rough { .. } => false,
        }
    }

    /// Fraction of the light, met under the cosine `cos` to the true normal, that it lets straight through.
    #[must_use]
    pub fn passage(&self, cos: f64) -> Rgb {
        match self.kind {
            LobeKind::Through => self.weight,
            LobeKind::Pane { ior, tint } => self.weight * sheet(cos.abs(), ior, tint).1,
            LobeKind::Mirror(_)
            | LobeKind::Phong { .. }
            | LobeKind::Haze { .. }
            | LobeKind::Rough { .. }
            | LobeKind::Dielectric { .. } => Rgb::BLACK,
        }
    }

    /// About how much light it scatters, not counting what goes straight through, seen under the cosine `cos`. Only for
    /// choosing among lobes: no more than a guess for rough ones.
    pub(super) fn importance(&self, cos: f64) -> f64 {
        let scattered = match self.kind {
            LobeKind::Mirror(reflection) | LobeKind::Rough { reflection, .. } => {
                self.weight * reflection.at(cos)
            }
            LobeKind::Phong { .. } | LobeKind::Haze { .. } | LobeKind::Dielectric { .. } => {
                self.weight
            }
            LobeKind::Pane { ior, tint } => self.weight * sheet(cos, ior, tint).0,
            LobeKind::Through => Rgb::BLACK,
        };
        scattered.sum()
    }

    /// Checks that its numbers make sense.
    pub(super) fn validate(&self) -> Result<(), MaterialError> {
        let fraction = |quantity, rgb: Rgb| {
            let wrong = rgb
                .to_array()
                .into_iter()
                .find(|c| !(0.0..=1.0).contains(c));
            wrong.map_or(Ok(()), |value| Err(MaterialError::Lobe { quantity, value }))
        };
        let index = |value: f64| {
            let is_index = value > 0.0 && value.is_finite();
            let wrong = MaterialError::Lobe {
                quantity: "index of refraction",
                value,
            };
            if is_index { Ok(()) } else { Err(wrong) }
        };
        let reflects = |reflection| match reflection {
            Reflection::Even => Ok(()),
            Reflection::Metal(color) => fraction("reflectance", color),
            Reflection::Varnish(ior) => index(ior),
        };
        fraction("weight", self.weight)?;
        if self.transmits() && self.sides != LobeSides::Both {
            return Err(MaterialError::OneWay);
        }
        match self.kind {
            LobeKind::Mirror(reflection) => reflects(reflection),
            LobeKind::Phong { exponent } | LobeKind::Haze { exponent }
                if exponent >= 0.0 && exponent.is_finite() =>
            {
                Ok(())
            }
            LobeKind::Phong { exponent } | LobeKind::Haze { exponent } => {
                Err(MaterialError::Lobe {
                    quantity: "shininess",
                    value: exponent,
                })
            }
            LobeKind::Rough { alpha, reflection } => {
                if !(SMOOTHEST_ALPHA..=1.0).contains(&alpha) {
                    return Err(rough(alpha));
                }
                reflects(reflection)
            }
            LobeKind::Dielectric {
                ior,
                alpha,
                absorption,
            } => {
                if !(0.0..=1.0).contains(&alpha) {
                    return Err(rough(alpha));
                }
                let least = absorption.min_channel();
                if !absorption.is_finite() || least < 0.0 {
                    return Err(MaterialError::Lobe {
                        quantity: "absorption",
                        value: least,
                    });
                }
                index(ior)
            }
            LobeKind::Pane { ior, tint } => {
                fraction("tint", tint)?;
                index(ior)
            }
            LobeKind::Through => Ok(()),
        }
    }
}

fn rough(value: f64) -> MaterialError {
    MaterialError::Lobe {
        quantity: "roughness",
        value,
    }
}
