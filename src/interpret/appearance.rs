//! What the interpreter reads of the shaders and lights that fields of nodes hold.

use super::images::Finder;
use crate::eval::freeform::Freeform;
use crate::graph::Payload;
use crate::material::Material;

/// Objects of the model that say how a surface looks or what a lamp sends out.
pub trait Appearance: Payload {
    /// The surface it describes for this purpose, if it is a shader. Its numbers are the model's and may be impossible; pictures
    /// that are missing are left out, and the finder remembers them.
    fn surface(&self, purpose: Purpose, pictures: &mut Finder<'_>) -> Option<Material>;

    /// The lamp it describes, if it is a light.
    fn lamp(&self) -> Option<Lamp>;

    /// The curve, surface or mesh it describes, if it does; an array of numbers is a list of points.
    fn freeform(&self) -> Option<Freeform>;

    /// The text it is, if it is one, such as the name of a file.
    fn words(&self) -> Option<&str>;
}

/// What a model is drawn for: an `AlgorithmSwitchShader` looks different for each.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Purpose {
    /// To be looked at.
    #[default]
    Picture,
    /// To know what light its organs get.
    LightModel,
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
