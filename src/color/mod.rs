//! Colours as light sees them: linear triples, the sRGB transfer, and the palettes a model can name.
//!
//! A colour that a *model* gives (a shader constant, an EGA index, a `java.awt.Color`) is a reflectance, taken as **linear**:
//! 0.5 grey absorbs half of the light that falls on it. GroIMP's renderers and its light model read them so, and absorbed
//! power would otherwise differ from GroIMP's. Only the finished picture is encoded with the sRGB transfer.

pub mod palette;
mod rgb;
pub mod srgb;

pub use rgb::Rgb;
