//! Eight triangles and parallelograms beside each other, to be tested at once.
//!
//! The test is in `f32` and only says which of them a ray *may* hit; [`crate::geometry::triangle`] then decides in `f64`. It
//! errs to one side: whatever the exact test would accept is among its candidates. Its corners and edges are those of a
//! group whose diagonal is at most 2¹³, relative to which the margins are chosen.

use super::simd::{Lanes, WIDTH};
use crate::geometry::triangle::Shear;
use crate::math::tolerance::{FLAT_DEPTH_MARGIN, FLAT_MARGIN};
use glam::DVec3;

/// Eight flat primitives, 320 bytes.
#[derive(Clone, Copy, Debug, PartialEq)]
#[repr(C, align(64))]
pub struct FlatBlock {
    corner: [[f32; WIDTH]; 3],
    edges: [[[f32; WIDTH]; 3]; 2],
    /// What each of them is to its owner, 0 if it is not there; the highest bit is set for parallelograms.
    names: [u32; WIDTH],
}

/// A ray prepared for blocks.
#[derive(Clone, Copy, Debug)]
pub struct FlatRay {
    origin: [f32; 3],
    axes: [u8; 3],
    shear: [f32; 2],
    /// ±1, the direction along the axis that becomes z.
    sign: f32,
}

impl FlatRay {
    /// Prepares the line that `shear` was made of.
    #[inline]
    #[must_use]
    pub fn new(shear: &Shear) -> Self {
        let (origin, axes, [x, y, z]) = shear.parts();
        Self {
            origin: origin.map(|x| x as f32),
            axes: axes.map(|axis| axis as u8),
            shear: [x as f32, y as f32],
            sign: 1.0_f32.copysign(z as f32),
        }
    }
}

impl FlatBlock {
    /// Nothing yet. A corner that is not a number is hit by no ray.
    pub const EMPTY: Self = Self {
        corner: [[f32::NAN; WIDTH]; 3],
        edges: [[[0.0; WIDTH]; 3]; 2],
        names: [0; WIDTH],
    };

    /// Puts a corner and the two edges from there into place `lane`. The highest bit of the name tells a parallelogram
    /// from a triangle.
    pub fn set(&mut self, lane: usize, corner: DVec3, edges: [DVec3; 2], name: u32) {
        for axis in 0..3 {
            self.corner[axis][lane] = corner[axis] as f32;
            for (stored, edge) in self.edges.iter_mut().zip(edges) {
                stored[axis][lane] = edge[axis] as f32;
            }
        }
        self.names[lane] = name;
    }

    /// The names of all that are there.
    pub fn names(&self) -> impl Iterator<Item = u32> {
        self.names.into_iter().filter(|name| *name != 0)
    }

    /// The name of the one in place `lane`.
    #[inline(always)]
    #[must_use]
    pub fn name(&self, lane: usize) -> u32 {
        self.names[lane % WIDTH]
    }

    /// Bit i is set if the ray may hit the one in place i, between `start` and `limit` in the parameter of
    /// [`BoxRay`](super::BoxRay).
    #[inline(always)]
    #[must_use]
    pub fn candidates<V: Lanes>(&self, ray: &FlatRay, start: f32, limit: f32) -> u32 {
        // No closures and no `map`: what they are handed to may not be inlined, see `simd`.
        let [x, y, z] = ray.axes;
        let (x, y, z) = (usize::from(x), usize::from(y), usize::from(z));
        let (shear_x, shear_y) = (V::splat(ray.shear[0]), V::splat(ray.shear[1]));
        let zero = V::splat(0.0);

        // Into the frame where the ray is the z axis.
        let depth = V::load(&self.corner[z]).sub(V::splat(ray.origin[2]));
        let corner_x = V::load(&self.corner[x]).sub(V::splat(ray.origin[0]));
        let corner_y = V::load(&self.corner[y]).sub(V::splat(ray.origin[1]));
        let corner = [
            corner_x.sub(shear_x.mul(depth)),
            corner_y.sub(shear_y.mul(depth)),
        ];
        let first = Edge::new(&self.edges[0], [x, y, z], [shear_x, shear_y]);
        let second = Edge::new(&self.edges[1], [x, y, z], [shear_x, shear_y]);
        let margin = first.length.add(second.length).mul(V::splat(FLAT_MARGIN));

        // Coordinates of the z axis along the edges, times the area; all have the sign of the area if it passes inside.
        let area = cross(first.flat, second.flat);
        let u = cross(second.flat, corner);
        let v = cross(corner, first.flat);
        let (rest_u, rest_v) = (area.sub(u), area.sub(v));
        // A triangle ends at the diagonal, a parallelogram does not.
        let diagonal = rest_u.sub(v).or_where(u, &self.names);
        let least = u.min(v).min(rest_u.min(rest_v)).min(diagonal);
        let most = u.max(v).max(rest_u.max(rest_v)).max(diagonal);
        let inside = zero.sub(margin).at_most(least) | most.at_most(margin);

        // The part of z that it can reach into.
        let sign = V::splat(ray.sign);
        let depth = depth.mul(sign);
        let (rise, other) = (first.rise.mul(sign), second.rise.mul(sign));
        let nearest = depth.add(rise.min(zero)).add(other.min(zero));
        let farthest = depth.add(rise.max(zero)).add(other.max(zero));
        inside
            & nearest.at_most(V::splat(limit + FLAT_DEPTH_MARGIN))
            & V::splat(start - FLAT_DEPTH_MARGIN).at_most(farthest)
    }
}

/// Eight edges in the frame of a ray.
struct Edge<V> {
    /// Sheared x and y.
    flat: [V; 2],
    /// z, which shearing does not change.
    rise: V,
    /// |x| + |y| + |z| before shearing.
    length: V,
}

impl<V: Lanes> Edge<V> {
    #[inline(always)]
    fn new(edges: &[[f32; WIDTH]; 3], [x, y, z]: [usize; 3], shear: [V; 2]) -> Self {
        let (x, y, z) = (V::load(&edges[x]), V::load(&edges[y]), V::load(&edges[z]));
        Self {
            flat: [x.sub(shear[0].mul(z)), y.sub(shear[1].mul(z))],
            rise: z,
            length: x.abs().add(y.abs()).add(z.abs()),
        }
    }
}

#[inline(always)]
fn cross<V: Lanes>(a: [V; 2], b: [V; 2]) -> V {
    a[0].mul(b[1]).sub(a[1].mul(b[0]))
}
