//! Eight triangles and parallelograms beside each other, to be tested at once.
//!
//! The test is in `f32` and says which of them a ray *may* hit, and which it certainly hits. Of the former,
//! [`crate::geometry::triangle`] then decides in `f64`: whatever it would accept is among them. The latter are enough for rays that only
//! ask whether anything is in the way. Corners and edges are those of a group whose diagonal is at most 2¹³, relative to
//! which the margins are chosen; coordinates are counted from where the ray enters the block, so that they are small.
//!
//! In the tree of a million triangles (`cargo bench --bench kernel`) a bounce tests 10.7 blocks; of the primitives in them 2.1 are
//! tested exactly and 1.4 are hit. With coordinates counted from the start of the ray and depths compared by extent it was 4.2.

use super::simd::{Lanes, WIDTH};
use crate::geometry::triangle::Shear;
use crate::math::tolerance::{FLAT_DEPTH_MARGIN, FLAT_DRIFT, FLAT_FLOOR, FLAT_MARGIN};
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

    /// Which of them the ray may hit, and which it certainly hits, between `start` and `limit` in the parameter of
    /// [`BoxRay`](super::BoxRay).
    ///
    /// Coordinates are counted from the point of the ray at `near`, in the same parameter: the nearer that is to the block, the
    /// fewer are named in vain.
    #[inline(always)]
    #[must_use]
    pub fn candidates<V: Lanes>(&self, ray: &Shear, [near, start, limit]: [f32; 3]) -> Candidates {
        // No closures and no `map`: what they are handed to may not be inlined, see `simd`.
        let (origin, [x, y, z], shear) = ray.parts();
        let sign = 1.0_f64.copysign(shear[2]);
        let (shear_x, shear_y) = (V::splat(shear[0] as f32), V::splat(shear[1] as f32));
        let step = f64::from(near) * sign;
        let near_x = (origin[0] + shear[0] * step) as f32;
        let near_y = (origin[1] + shear[1] * step) as f32;
        let near_z = (origin[2] + step) as f32;
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
        let at = at.signed_by(V::splat(sign as f32));
        let area = area.abs();
        let (start, limit) = (V::splat(start - near), V::splat(limit - near));
        let error = margin
            .mul(away.add(length))
            .add(area.mul(V::splat(FLAT_DEPTH_MARGIN)));
        let (latest, later) = (limit.mul(area), error.add(margin.mul(limit.abs())));
        let (earliest, earlier) = (start.mul(area), error.add(margin.mul(start.abs())));
        let possible = inside & at.at_most(latest.add(later)) & earliest.sub(earlier).at_most(at);
        let margin = margin.add(V::splat(FLAT_FLOOR));
        let well_inside = margin.at_most(least) | most.at_most(zero.sub(margin));
        let certain =
            well_inside & at.at_most(latest.sub(later)) & earliest.add(earlier).at_most(at);
        Candidates { possible, certain }
    }
}

/// Which of eight flat primitives a ray hits: bit i tells of the one in place i.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Candidates {
    /// It may, and only the exact test can tell.
    pub possible: u32,
    /// It does.
    pub certain: u32,
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

#[cfg(test)]
mod tests {
    use super::*;
    use crate::accel::{BoxRay, Kernel, dispatch};
    use crate::geometry::interval::{Interval, Line};
    use crate::geometry::triangle::intersect_triangle;
    use crate::math::rng;

    /// The question of [`FlatBlock::candidates`].
    struct Ask<'a>(&'a FlatBlock, &'a Shear, [f32; 3]);

    impl Kernel for Ask<'_> {
        type Output = Candidates;

        #[inline(always)]
        fn run<V: Lanes>(self) -> Candidates {
            self.0.candidates::<V>(self.1, self.2)
        }
    }

    /// A stream of numbers between -1 and 1.
    struct Random(u64);

    impl Random {
        fn number(&mut self) -> f64 {
            self.0 += 1;
            2.0 * rng::unit_f64(rng::hash(&[self.0])) - 1.0
        }

        fn vector(&mut self) -> DVec3 {
            DVec3::new(self.number(), self.number(), self.number())
        }
    }

    /// Eight triangles of one size, from a thousandth of a unit to the whole group, some of them needles.
    fn triangles(random: &mut Random) -> [[DVec3; 3]; WIDTH] {
        let size = 10.0_f64.powf(2.0 * random.number()) * 10.0;
        let middle = random.vector() * 2000.0;
        std::array::from_fn(|k| {
            let a = middle + random.vector() * size;
            let b = a + random.vector() * size;
            let thin = if k < 3 { 1e-3 } else { 1.0 };
            let c = a + (b - a) * random.number() + random.vector() * (size * thin);
            [a, b, c]
        })
    }

    #[test]
    fn candidates_hold_every_hit_and_certain_ones_are_hits() {
        let mut random = Random(0);
        let (mut hits, mut certain, mut possible) = (0, 0, 0);
        for _ in 0..20_000 {
            let triangles = triangles(&mut random);
            let mut block = FlatBlock::EMPTY;
            for (lane, [a, b, c]) in triangles.iter().enumerate().skip(1) {
                block.set(lane, *a, [*b - *a, *c - *a], lane as u32);
            }
            // At corners, edges and points between, from near and far.
            let [a, b, c] = triangles[random.0 as usize % WIDTH];
            let target = match random.0 % 4 {
                0 => a,
                1 => a.lerp(b, random.number().abs()),
                _ => (a + b + c) / 3.0,
            };
            let origin = target + random.vector() * 10.0_f64.powf(1.5 * random.number() + 1.5);
            let line = Line {
                origin,
                direction: (target - origin) * random.number().abs().max(0.1),
            };
            let shear = Shear::new(&line);
            let box_ray = BoxRay::new(line.origin, line.direction, 1.0 / line.direction);
            // Between the middle of the way and a little beyond it, exactly to the target, or on and on.
            let after = if random.0.is_multiple_of(3) { 0.5 } else { 0.0 };
            let whole = intersect_triangle(
                &shear,
                [a.as_ref(), b.as_ref(), c.as_ref()],
                Interval {
                    after: 0.0,
                    until: f64::INFINITY,
                },
            );
            let until = match random.0 % 5 {
                0 => f64::INFINITY,
                1 => whole.map_or(2.0, |hit| hit.t),
                2 => 1.0,
                _ => 10.0,
            };
            let near = box_ray.limit(random.number().abs());
            let part = [near, box_ray.start(after), box_ray.limit(until)];
            let found = dispatch(Ask(&block, &shear, part));
            assert_eq!(
                found,
                Ask(&block, &shear, part).run::<super::super::simd::Scalar>()
            );
            for (lane, corners) in triangles.iter().enumerate() {
                let corners = corners.each_ref().map(|corner| corner.as_ref());
                let is_hit = lane > 0
                    && intersect_triangle(&shear, corners, Interval { after, until }).is_some();
                let [may, does] = [found.possible, found.certain].map(|set| set >> lane & 1 != 0);
                assert!(
                    is_hit <= may && does <= is_hit,
                    "{lane}: {line:?} {triangles:?}"
                );
                hits += usize::from(is_hit);
                certain += usize::from(does);
                possible += usize::from(may);
            }
        }
        // It is worth something, too.
        assert!(
            hits > 10_000 && certain > 300 && possible >= hits,
            "{hits} {certain} {possible}"
        );
    }
}
