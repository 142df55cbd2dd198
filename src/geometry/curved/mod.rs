//! Curved surfaces and the triangles that stand for them: NURBS and Bézier surfaces, surfaces of revolution, skins over
//! curves, generalised cylinders.
//!
//! ```text
//! basis       B-spline basis functions and their knots
//! curve       rational B-spline curves, circles, curves through points
//! surface     rational B-spline surfaces and how they are made of curves
//! sweep       a section carried along a curve
//! tessellate  any of them → triangles, to a stated error
//! ```
//! Parameters run over the knots' own range; texture coordinates over 0..=1 in both directions. The front is where u turns
//! to v counter-clockwise: it looks along ∂S/∂u × ∂S/∂v.

pub mod basis;
pub mod curve;
pub mod surface;
pub mod sweep;
pub mod tessellate;

pub use curve::Curve;
pub use surface::Surface;
pub use sweep::Sweep;
pub use tessellate::tessellate;

use glam::{DVec2, DVec3};

/// A surface over a rectangle of parameters.
pub trait Parametric {
    /// Where pieces meet, per direction, ascending; the first and the last are the ends. Within a piece the surface is smooth.
    fn breaks(&self) -> [Vec<f64>; 2];

    /// The point at these parameters.
    fn point(&self, at: DVec2) -> DVec3;

    /// The derivatives of the point by u and by v; at a corner of the surface those of the piece behind it.
    fn tangents(&self, at: DVec2) -> [DVec3; 2];

    /// How many pieces a smooth piece should at least be cut into, per direction, before it is measured.
    fn first_cuts(&self) -> [usize; 2];
}

/// Why a curve or surface cannot be.
#[derive(Clone, Debug, PartialEq, Eq, thiserror::Error)]
pub enum CurvedError {
    /// A degree that there is none of.
    #[error("its degree is {0}; it must be 1 to {most}", most = basis::MAX_DEGREE)]
    Degree(usize),
    /// Too few points for the degree.
    #[error("it has {points} points, fewer than the {needed} that its degree {degree} needs")]
    TooFewPoints {
        /// How many there are.
        points: usize,
        /// How many there must be.
        needed: usize,
        /// The degree.
        degree: usize,
    },
    /// Knots that do not fit.
    #[error("its knots {0}")]
    Knots(&'static str),
    /// Points that do not fill a grid.
    #[error("{0}")]
    Points(String),
    /// A number that is none.
    #[error("a coordinate, weight or radius of it is not a finite number")]
    NotFinite,
    /// A weight that pulls a point to infinity.
    #[error("a weight of it is not greater than 0")]
    Weight,
    /// More triangles than are sensible.
    #[error("it needs more than {0} triangles to be as exact as asked; allow a greater error")]
    TooFine(usize),
}
