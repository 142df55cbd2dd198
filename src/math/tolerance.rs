//! Every numeric tolerance of the program, each with what it bounds and what breaks if it were another.

/// The sine of the angle below which two directions count as parallel.
///
/// A cross product of unit vectors has rounding errors near 1e-16; at this sine its direction is still right to about
/// eight digits. Ten times larger would refuse cameras that look almost straight down and are well defined; ten times
/// smaller would give their horizon fewer digits. Used by [`crate::camera`].
pub const PARALLEL_SINE: f64 = 1e-8;

/// How far reflectance + transmittance may exceed 1 before a material counts as making light. Dimensionless.
///
/// A model's colours are `f32`, so a sum that is 1 on paper carries up to two roundings of 2⁻²⁴. Used by
/// `material`. Ten times larger would let 0.01 ‰ of extra light through per bounce; ten times smaller refuses 0.7 + 0.3.
pub const ENERGY_EXCESS: f64 = 2.0 * f32::EPSILON as f64;

/// What a pixel's squared luminance is raised by before an error is divided by it, as a share of the picture's mean
/// luminance squared. Dimensionless.
///
/// Pixels darker than a tenth of the mean are judged by absolute, not relative, error. Ten times larger would hide
/// the grain of shadows; ten times smaller would let a few nearly black pixels decide. Used by [`crate::film`].
pub const DARK_PIXEL_FLOOR: f64 = 0.01;

/// How far the length of a given unit vector may be from 1.
///
/// A direction that went through a model's `f32` vectors and a product of matrices carries about ten roundings of
/// 2⁻²⁴. Ten times larger would let a vector pass that nobody normalised; ten times smaller would refuse turned lamps.
/// Used by [`crate::light`].
pub const UNIT_LENGTH: f64 = 1e-6;
