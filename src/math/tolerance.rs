//! Every numeric tolerance of the program, each with what it bounds and what breaks if it were another.

/// The sine of the angle below which two directions count as parallel.
///
/// A cross product of unit vectors has rounding errors near 1e-16; at this sine its direction is still right to about
/// eight digits. Ten times larger would refuse cameras that look almost straight down and are well defined; ten times
/// smaller would give their horizon fewer digits. Used by [`crate::camera`].
pub const PARALLEL_SINE: f64 = 1e-8;
