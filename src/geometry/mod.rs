//! Shapes and what a ray finds on them, each shape in a frame of its own.
//!
//! A shape is exact (no tessellation). Axes run along local +z from the origin, as GroIMP's primitives do.
//!
//! The files beside this one hold what a ray needs: [`triangle`] and parallelogram tests that leave no gap
//! between neighbours, and the [`mod@unit`] forms (sphere, disk, frustum, box) to which every other placed shape is an affine
//! image. All of it is `f64`.

pub mod area;
pub mod chart;
pub mod curved;
pub mod import;
pub mod interval;
pub mod painted;
pub mod polygon;
pub mod quadratic;
pub mod reduce;
pub mod triangle;
pub mod unit;

use glam::{DVec2, DVec3};
use std::sync::Arc;

/// A shape in its own frame, in metres.
#[derive(Clone, Debug, PartialEq)]
pub enum Shape {
    /// A ball of this radius round the origin.
    Sphere {
        /// Radius, greater than 0.
        radius: f64,
    },
    /// A cylinder (equal radii), cone (top radius 0) or frustum from z = 0 to z = `length`.
    Frustum {
        /// Length along +z, greater than 0.
        length: f64,
        /// Radius at z = 0, at least 0.
        base_radius: f64,
        /// Radius at z = `length`, at least 0.
        top_radius: f64,
        /// Whether the disk at z = 0 is there.
        base_cap: bool,
        /// Whether the disk at z = `length` is there.
        top_cap: bool,
    },
    /// The box `±half_x × ±half_y × 0..length`.
    Box {
        /// Half the extent along x (GroIMP's width / 2).
        half_x: f64,
        /// Half the extent along y (GroIMP's height / 2).
        half_y: f64,
        /// Extent along z.
        length: f64,
    },
    /// `corner + u·edge_u + v·edge_v`, u and v in 0..1; its front looks along `edge_u × edge_v`.
    ///
    /// Textures lie on it as on GroIMP's `Parallelogram`, whose first edge is its length: their u runs along `edge_v`,
    /// their v along `edge_u`, so that seen from the front they are mirrored.
    Parallelogram {
        /// One corner.
        corner: DVec3,
        /// First edge.
        edge_u: DVec3,
        /// Second edge.
        edge_v: DVec3,
    },
    /// A disk of this radius in the plane z = 0; its front looks along +z.
    Disk {
        /// Radius, greater than 0.
        radius: f64,
    },
    /// The whole plane z = 0; its front looks along +z.
    Plane,
    /// Triangles.
    Mesh(Arc<TriangleMesh>),
}

/// Triangles that share vertices.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct TriangleMesh {
    /// Corner positions in metres.
    pub positions: Vec<DVec3>,
    /// Three corners each; the front is where they run counter-clockwise.
    pub triangles: Vec<[u32; 3]>,
    /// Unit shading normals per corner, or empty.
    pub normals: Vec<DVec3>,
    /// Texture coordinates per corner, or empty: u to the right, v upwards in the image, whose lower left corner is (0, 0).
    pub uvs: Vec<DVec2>,
}

impl TriangleMesh {
    /// Bytes that its lists take.
    #[must_use]
    pub fn bytes(&self) -> usize {
        size_of_val(&*self.positions)
            + size_of_val(&*self.triangles)
            + size_of_val(&*self.normals)
            + size_of_val(&*self.uvs)
    }
}
