//! Surfaces by their everyday names.

use super::lobe::{Lobe, LobeKind, LobeSides, Reflection};
use super::texture::Pictures;
use super::{Material, Side};
use crate::color::Rgb;
use crate::math::tolerance::SMOOTHEST_ALPHA;

/// Perceived roughness (0 smooth, 1 as rough as can be) to the α of the facets: its square, as is usual, so that equal steps
/// look equal ([Burley2012, §5.4](crate::references#burley2012)). 0 for what is as good as smooth.
fn facet_alpha(roughness: f64) -> f64 {
    let alpha = roughness * roughness;
    if alpha < SMOOTHEST_ALPHA { 0.0 } else { alpha }
}

impl Material {
    /// A surface of these lobes alone.
    #[must_use]
    pub fn of_lobes(lobes: Vec<Lobe>) -> Self {
        Self {
            lobes: lobes.into(),
            ..Self::matt([Side::default(); 2])
        }
    }

    /// A mirror that reflects this fraction at every angle.
    #[must_use]
    pub fn mirror(reflectance: Rgb) -> Self {
        Self::of_lobes(vec![Lobe::new(
            LobeKind::Mirror(Reflection::Even),
            reflectance,
        )])
    }

    /// A metal of this colour (at normal incidence), with `roughness` in 0..=1.
    #[must_use]
    pub fn metal(color: Rgb, roughness: f64) -> Self {
        let (alpha, reflection) = (facet_alpha(roughness), Reflection::Metal(color));
        let kind = if alpha == 0.0 {
            LobeKind::Mirror(reflection)
        } else {
            LobeKind::Rough { alpha, reflection }
        };
        Self::of_lobes(vec![Lobe::new(kind, Rgb::WHITE)])
    }

    /// The skin of a clear body with index of refraction `ior` (relative to what it is in), which absorbs `absorption` 1/m,
    /// with `roughness` in 0..=1. For closed shapes. With index 1 and no absorption there is nothing to see.
    #[must_use]
    pub fn glass(ior: f64, roughness: f64, absorption: Rgb) -> Self {
        let kind = if ior == 1.0 && absorption.is_black() {
            LobeKind::Through
        } else {
            let alpha = if ior == 1.0 {
                0.0
            } else {
                facet_alpha(roughness)
            };
            LobeKind::Dielectric {
                ior,
                alpha,
                absorption,
            }
        };
        Self::of_lobes(vec![Lobe::new(kind, Rgb::WHITE)])
    }

    /// A thin flat sheet of glass: all reflections inside it are counted, and light goes straight on behind it. `tint` is
    /// left after crossing its body once at normal incidence. For single faces, not for bodies.
    #[must_use]
    pub fn pane(ior: f64, tint: Rgb) -> Self {
        let kind = if ior == 1.0 && tint == Rgb::WHITE {
            LobeKind::Through
        } else {
            LobeKind::Pane { ior, tint }
        };
        Self::of_lobes(vec![Lobe::new(kind, Rgb::WHITE)])
    }

    /// A surface that looks like `front` from the front and like `back` from the back.
    ///
    /// What goes through in single directions or straight on must pass both: if the two differ in that, nothing does. The
    /// larger alpha counts, so that light sees the same holes from both sides. Too many lobes are an error of
    /// [`validate`](Self::validate). Holes that pictures cut in one are holes of both.
    #[must_use]
    pub fn two_sided(front: &Self, back: &Self) -> Self {
        let alpha = front.alpha.max(back.alpha);
        let share = |part: &Self| if alpha > 0.0 { part.alpha / alpha } else { 0.0 };
        let (of_front, of_back) = (share(front), share(back));
        let scaled = |side: Side, share: f64| Side {
            reflectance: side.reflectance * share,
            transmittance: side.transmittance * share,
        };
        let mut lobes = Vec::new();
        for (part, other, share, sides) in [
            (front, back, of_front, LobeSides::Front),
            (back, front, of_back, LobeSides::Back),
        ] {
            for lobe in part.lobes.iter().filter(|l| l.sides != opposite(sides)) {
                let is_shared = other.lobes.contains(lobe) && of_front == of_back;
                let (weight, sides) = if is_shared {
                    (lobe.weight, lobe.sides)
                } else {
                    (lobe.weight * share, sides)
                };
                let lobe = Lobe {
                    weight,
                    sides,
                    ..*lobe
                };
                let is_one_way = lobe.transmits() && !is_shared;
                if !is_one_way && !lobes.contains(&lobe) {
                    lobes.push(lobe);
                }
            }
        }
        Self {
            sides: [
                scaled(front.sides[0], of_front),
                scaled(back.sides[1], of_back),
            ],
            lobes: lobes.into(),
            alpha,
            emission: [front.emission[0] * of_front, back.emission[1] * of_back],
            pictures: Pictures::joined([(front, [of_front, 0.0]), (back, [0.0, of_back])]),
        }
    }

    /// The fraction `share` (0..=1) of `b` and the rest of `a`, mixed finely. Holes that pictures cut in one are holes of both.
    #[must_use]
    pub fn mixed(a: &Self, b: &Self, share: f64) -> Self {
        let alpha = a.alpha * (1.0 - share) + b.alpha * share;
        let norm = |part: f64| if alpha > 0.0 { part / alpha } else { 0.0 };
        let (of_a, of_b) = (norm((1.0 - share) * a.alpha), norm(share * b.alpha));
        let side = |at: usize| Side {
            reflectance: a.sides[at].reflectance * of_a + b.sides[at].reflectance * of_b,
            transmittance: a.sides[at].transmittance * of_a + b.sides[at].transmittance * of_b,
        };
        let mut lobes: Vec<Lobe> = Vec::new();
        for (part, share) in [(a, of_a), (b, of_b)] {
            for lobe in part.lobes.iter().filter(|_| share > 0.0) {
                let weight = lobe.weight * share;
                // Equal lobes of both are one.
                let same = |known: &&mut Lobe| known.kind == lobe.kind && known.sides == lobe.sides;
                match lobes.iter_mut().find(same) {
                    Some(known) => known.weight += weight,
                    None => lobes.push(Lobe { weight, ..*lobe }),
                }
            }
        }
        Self {
            sides: [side(0), side(1)],
            lobes: lobes.into(),
            alpha,
            emission: [0, 1].map(|at| a.emission[at] * of_a + b.emission[at] * of_b),
            pictures: Pictures::joined([(a, [of_a; 2]), (b, [of_b; 2])]),
        }
    }
}

/// The other side.
const fn opposite(sides: LobeSides) -> LobeSides {
    match sides {
        LobeSides::Front => LobeSides::Back,
        LobeSides::Back => LobeSides::Front,
        LobeSides::Both => LobeSides::Both,
    }
}
