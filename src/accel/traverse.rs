//! Walking a hierarchy along a ray.

use super::node::{Bvh, Node, WIDTH};
use super::stack::{TraversalStack, Waiting};
use crate::math::tolerance::BOX_SLACK;
use glam::DVec3;
use std::ops::{ControlFlow, Range, RangeInclusive};

/// What a leaf answers: go on looking, as far as this parameter and no farther, or stop.
pub type Step = ControlFlow<(), f32>;

/// A ray prepared for box tests in `f32`.
///
/// Its parameter is scaled so that the largest component of the direction is 1: the numbers of the box tests are then no
/// larger than the boxes' own, and nothing can overflow.
#[derive(Clone, Copy, Debug)]
pub struct BoxRay {
    origin: [f32; 3],
    inverse: [f32; 3],
    /// Index of the plane where the ray enters a box, per axis; it leaves by the opposite one.
    near: [usize; 3],
    /// Box parameter per unit of the ray's own parameter.
    scale: f64,
}

impl BoxRay {
    /// Prepares the line `origin + t · direction`; `direction` must not be zero.
    #[must_use]
    pub fn new(origin: DVec3, direction: DVec3) -> Self {
        let scale = direction.abs().max_element();
        let unit = (direction / scale).to_array();
        Self {
            origin: origin.to_array().map(|x| x as f32),
            // A component of ±0 gives ±∞, which the box test knows how to read.
            inverse: unit.map(|x| 1.0 / x as f32),
            near: std::array::from_fn(|axis| {
                if unit[axis].is_sign_negative() {
                    axis + 3
                } else {
                    axis
                }
            }),
            scale,
        }
    }

    /// The parameter `t` of the line in the scaled parameter of the box tests, rounded up; always finite, because
    /// a box beside a ray that is parallel to it is entered at infinity.
    #[inline]
    #[must_use]
    pub fn limit(&self, t: f64) -> f32 {
        ((t * self.scale) as f32 * BOX_SLACK).min(f32::MAX)
    }

    /// The same, rounded down and at least 0.
    #[inline]
    #[must_use]
    pub fn start(&self, t: f64) -> f32 {
        ((t * self.scale) as f32 / BOX_SLACK).clamp(0.0, f32::MAX)
    }
}

impl Bvh {
    /// Calls `leaf` with the item ranges of all leaves whose boxes the ray meets in `part` (from a result of
    /// [`BoxRay::start`] to one of [`BoxRay::limit`]), roughly from near to far. `leaf` may shorten the limit or stop the walk.
    ///
    /// The walk leaves `stack` as it found it; `leaf` gets it for walks through hierarchies nested in this one.
    pub fn traverse(
        &self,
        ray: &BoxRay,
        part: RangeInclusive<f32>,
        stack: &mut TraversalStack,
        mut leaf: impl FnMut(Range<usize>, &mut TraversalStack) -> Step,
    ) -> ControlFlow<()> {
        if self.nodes.is_empty() {
            return ControlFlow::Continue(());
        }
        let (start, mut limit) = part.into_inner();
        let bottom = stack.len();
        let mut next = Waiting::default();
        loop {
            if next.count == 0 {
                self.nodes[next.first as usize].push_entered(ray, start, limit, stack);
            } else {
                let first = next.first as usize;
                match leaf(first..first + next.count as usize, stack) {
                    ControlFlow::Continue(nearer) => limit = nearer,
                    ControlFlow::Break(()) => {
                        stack.truncate(bottom);
                        return ControlFlow::Break(());
                    }
                }
            }

            // Take the nearest box that is still worth a look.
            loop {
                if stack.len() == bottom {
                    return ControlFlow::Continue(());
                }
                next = stack.pop();
                if next.enter <= limit {
                    break;
                }
            }
        }
    }
}

impl Node {
    /// Pushes the children that the ray meets between `start` and `limit`, the farthest first.
    #[inline]
    fn push_entered(&self, ray: &BoxRay, start: f32, limit: f32, stack: &mut TraversalStack) {
        // Where the ray is inside all three slabs. A NaN, from 0 · ∞ for a ray in the plane of a face, compares false and
        // changes nothing, so such a ray is inside that slab.
        let mut enter = [start; WIDTH];
        let mut exit = [limit; WIDTH];
        for axis in 0..3 {
            let near = &self.planes[ray.near[axis]];
            let far = &self.planes[(ray.near[axis] + 3) % 6];
            let (origin, inverse) = (ray.origin[axis], ray.inverse[axis]);
            for lane in 0..WIDTH {
                let t = (near[lane] - origin) * inverse;
                enter[lane] = if t > enter[lane] { t } else { enter[lane] };
                let t = (far[lane] - origin) * inverse * BOX_SLACK;
                exit[lane] = if t < exit[lane] { t } else { exit[lane] };
            }
        }

        let mut lanes = 0_u32;
        for lane in 0..WIDTH {
            lanes |= u32::from(enter[lane] <= exit[lane]) << lane;
        }

        // Sort the entered children in; there are rarely more than three.
        let mut entered = [Waiting::default(); WIDTH];
        let mut count = 0;
        while lanes != 0 {
            let lane = lanes.trailing_zeros() as usize % WIDTH;
            lanes &= lanes - 1;
            let child = self.children[lane];
            let waiting = Waiting {
                enter: enter[lane],
                first: child.first,
                count: child.count,
            };
            let mut at = count;
            while at > 0 && entered[at - 1].enter < waiting.enter {
                entered[at] = entered[at - 1];
                at -= 1;
            }
            entered[at] = waiting;
            count += 1;
        }
        for waiting in &entered[..count] {
            stack.push(*waiting);
        }
    }
}
