//! What the interpreter reads of the shaders and lights that fields of nodes hold.

use crate::graph::Payload;

/// Objects of the model that say how a surface looks or what a lamp sends out.
pub trait Appearance: Payload {
    /// The surface it describes, if it is a shader.
    fn surface(&self) -> Option<Surface>;

    /// The lamp it describes, if it is a light.
    fn lamp(&self) -> Option<Lamp>;

    /// The text it is, if it is one, such as the name of a file.
    fn words(&self) -> Option<&str>;
}

/// How a surface looks, both sides alike; linear red, green, blue. Values are the model's and may be impossible.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Surface {
    /// Fraction that is scattered back, 0..=1.
    pub reflectance: [f64; 3],
    /// Fraction that is scattered through, 0..=1.
    pub transmittance: [f64; 3],
    /// Fraction of the light that meets the surface at all, 0..=1; the rest passes straight through.
    pub alpha: f64,
}

impl Surface {
    /// An opaque surface that transmits nothing.
    #[must_use]
    pub const fn opaque(reflectance: [f64; 3]) -> Self {
        Self {
            reflectance,
            transmittance: [0.0; 3],
            alpha: 1.0,
        }
    }
}

/// A lamp, as the model describes it.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Lamp {
    /// What kind of lamp.
    pub kind: LampKind,
    /// Its colour; only the proportions count.
    pub color: [f64; 3],
    /// Watts (point, spot, area) or watts per square metre (directional, sky), summed over red, green and blue.
    pub power: f64,
}

/// Kinds of lamps. Angles are half angles in radians.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum LampKind {
    /// Shines into all directions from a point.
    Point,
    /// Shines into a cone along the head.
    Spot {
        /// Up to here it is fully bright.
        inner: f64,
        /// Here it has faded to nothing.
        outer: f64,
    },
    /// Parallel light along the head.
    Directional,
    /// Makes the parallelogram that carries it shine to its local +y side.
    Area {
        /// Exponent of the cosine by which it shines; 1 is a matt surface.
        exponent: f64,
    },
    /// Light from all directions of the sky.
    Sky,
}
