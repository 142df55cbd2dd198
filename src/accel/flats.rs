//! Eight triangles and parallelograms beside each other, to be tested at once.
//!
//! The test is in `f32` and only says which of them a ray *may* hit; [`crate::geometry::triangle`] then decides in `f64`. It
//! errs to one side: whatever the exact test would accept is among its candidates. Its corners and edges are those of a
//! group whose diagonal is at most 2¹³, relative to which the margins are chosen.

use super::simd::{Lanes, WIDTH};
use crate::geometry::triangle::Shear;
use crate::math::tolerance::{FLAT_DEPTH_MARGIN, FLAT_DRIFT, FLAT_MARGIN};
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
    origin: [f64; 3],
    axes: [u8; 3],
    shear: [f64; 2],
    /// ±1, the direction along the axis that becomes z.
    sign: f64,
}

impl FlatRay {
    /// Prepares the line that `shear` was made of.
    #[inline]
    #[must_use]
    pub fn new(shear: &Shear) -> Self {
        let (origin, axes, [x, y, z]) = shear.parts();
        Self {
            origin,
            axes: axes.map(|axis| axis as u8),
            shear: [x, y],
            sign: 1.0_f64.copysign(z),
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
    ///
    /// Coordinates are counted from the point of the ray at `near`, in the same parameter: the nearer that is to the block, the
    /// fewer are named in vain.
    #[inline(always)]
    #[must_use]
    pub fn candidates<V: Lanes>(&self, ray: &FlatRay, [near, start, limit]: [f32; 3]) -> u32 {
        // No closures and no `map`: what they are handed to may not be inlined, see `simd`.
        let [x, y, z] = ray.axes;
        let (x, y, z) = (usize::from(x), usize::from(y), usize::from(z));
        let (shear_x, shear_y) = (V::splat(ray.shear[0] as f32), V::splat(ray.shear[1] as f32));
        let step = f64::from(near) * ray.sign;
        let near_x = (ray.origin[0] + ray.shear[0] * step) as f32;
        let near_y = (ray.origin[1] + ray.shear[1] * step) as f32;
        let near_z = (ray.origin[2] + step) as f32;
        let zero = V::splat(0.0);

        // Into the frame where the ray is the z axis.
        let depth = V::load(&self.corner[z]).sub(V::splat(near_z));
        let corner_x = V::load(&self.corner[x]).sub(V::splat(near_x));
        let corner_y = V::load(&self.corner[y]).sub(V::splat(near_y));
        let away = corner_x.abs().add(corner_y.abs()).add(depth.abs());
        let corner = [
            corner_x.sub(shear_x.mul(depth)),
            corner_y.sub(shear_y.mul(depth)),
        ];
        let first = Edge::new(&self.edges[0], [x, y, z], [shear_x, shear_y]);
        let second = Edge::new(&self.edges[1], [x, y, z], [shear_x, shear_y]);
        let length = first.length.add(second.length);
        let error = away.add(length).mul(V::splat(FLAT_DRIFT));
        let margin = length.mul(error.add(V::splat(FLAT_MARGIN)));

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

        // Where the ray meets its plane, times the area. The error of the area counts as far as that may be.
        let rise = u.mul(first.rise).add(v.mul(second.rise));
        let at = depth.mul(area).add(rise).signed_by(area);
        let at = at.signed_by(V::splat(ray.sign as f32));
        let area = area.abs();
        let (start, limit) = (V::splat(start - near), V::splat(limit - near));
        let error = margin
            .mul(away.add(length))
            .add(area.mul(V::splat(FLAT_DEPTH_MARGIN)));
        let latest = limit.mul(area).add(error).add(margin.mul(limit.abs()));
        let earliest = start.mul(area).sub(error).sub(margin.mul(start.abs()));
        inside & at.at_most(latest) & earliest.at_most(at)
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
