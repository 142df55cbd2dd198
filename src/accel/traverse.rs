//! Walking hierarchies along a ray, from group to group, in one loop.
//!
//! Tried and dropped, beside Embree in turns (`benches/kernel.rs`): children gathered by a table and sorted by a network instead of one by one
//! (Cornell box 0.70 of Embree's rate instead of 0.77, forests the same); one instance to a leaf instead of two (2 % faster,
//! but 121 bytes per instance instead of 108); large pages (no difference beyond the noise). Asking for the memory of
//! children ahead is kept: 15 % in a tree of a million triangles.

use super::node::{Bvh, Child, Node};
use super::simd::{Lanes, WIDTH};
use super::stack::{TraversalStack, Waiting};
use crate::math::tolerance::BOX_SLACK;
use glam::DVec3;
use std::ops::ControlFlow;

/// A ray prepared for box tests in `f32`.
///
/// Its parameter is scaled so that the largest component of the direction is 1: the numbers of the box tests are then no
/// larger than the boxes' own, and nothing can overflow.
#[derive(Clone, Copy, Debug)]
pub struct BoxRay {
    origin: [f32; 3],
    inverse: [f32; 3],
    /// Index of the plane where the ray enters a box, per axis; it leaves by the opposite one.
    near: [u8; 3],
    /// Box parameter per unit of the ray's own parameter.
    scale: f64,
}

impl BoxRay {
    /// Prepares the line `origin + t · direction`, given 1 / `direction`, which must not be zero.
    #[inline(always)]
    #[must_use]
    pub fn new(origin: DVec3, direction: DVec3, inverse: DVec3) -> Self {
        let scale = direction.abs().max_element();
        // A component of ±0 gives ±∞, which the box test knows how to read.
        let inverse = inverse.to_array();
        Self {
            origin: origin.to_array().map(|x| x as f32),
            inverse: inverse.map(|x| (x * scale) as f32),
            near: std::array::from_fn(|axis| {
                axis as u8
                    + if inverse[axis].is_sign_negative() {
                        3
                    } else {
                        0
                    }
            }),
            scale,
        }
    }

    /// The parameter `t` of the line in the scaled parameter of the box tests, rounded up; always finite, because
    /// a box beside a ray that is parallel to it is entered at infinity.
    #[inline(always)]
    #[must_use]
    pub fn limit(&self, t: f64) -> f32 {
        ((t * self.scale) as f32 * BOX_SLACK).min(f32::MAX)
    }

    /// The same, rounded down and at least 0 (and not -0, whose bits would be the largest).
    #[inline(always)]
    #[must_use]
    pub fn start(&self, t: f64) -> f32 {
        ((t * self.scale) as f32 / BOX_SLACK).clamp(0.0, f32::MAX) + 0.0
    }
}

/// A hierarchy that is being walked: with which ray, and in which part of it (from a result of [`BoxRay::start`] to one of
/// [`BoxRay::limit`]).
#[derive(Clone, Copy, Debug)]
pub struct Walking<'b> {
    /// The hierarchy.
    pub bvh: &'b Bvh,
    /// The ray in its frame.
    pub ray: BoxRay,
    /// What ends before this is left out.
    pub start: f32,
    /// What begins after this is left out.
    pub limit: f32,
}

/// What a leaf answers.
pub enum Step<'b> {
    /// Go on looking, as far as this parameter and no farther.
    Continue(f32),
    /// Walk another hierarchy that is in the leaf, then come back and show the rest of it, if there is any, as a leaf of this
    /// name.
    Enter(Walking<'b>, Option<u32>),
    /// Look into the leaf of this name, which is in it.
    Look(u32),
    /// Stop.
    Stop,
}

/// Who wants to know what a ray meets. The functions should be `#[inline(always)]`, see [`Kernel`](super::Kernel).
pub trait Visitor<'b> {
    /// Whether near boxes should come before far ones.
    const NEAREST_FIRST: bool;
    /// Is shown a leaf that the ray meets, as [`Bvh::relabel`] called it, from where the ray enters its box to the end of what
    /// counts.
    fn leaf<V: Lanes>(&mut self, leaf: u32, part: [f32; 2]) -> Step<'b>;
    /// Is told of a leaf that it will probably be shown soon, so that memory can be asked for.
    fn soon<V: Lanes>(&self, leaf: u32);
    /// Is told that the hierarchy entered last is done; answers with the one around it.
    fn leave(&mut self) -> Walking<'b>;
}

/// Shows the visitor all leaves whose boxes the ray meets, roughly from near to far.
#[inline(always)]
pub fn walk<'b, V: Lanes, W: Visitor<'b>>(
    mut walking: Walking<'b>,
    visitor: &mut W,
) -> ControlFlow<()> {
    let mut stack = TraversalStack::new();
    let mut next = Waiting::new(0.0, Child::ROOT);
    loop {
        if let Some(number) = next.child().as_node() {
            if let Some(node) = walking.bvh.nodes.get(number)
                && let Some(nearest) = node.push_entered::<V, W>(&walking, &mut stack, visitor)
            {
                next = nearest;
                continue;
            }
        } else {
            match visitor.leaf::<V>(next.child().0, [next.enter(), walking.limit]) {
                Step::Continue(nearer) => walking.limit = nearer,
                Step::Enter(inner, rest) => {
                    if let Some(rest) = rest {
                        stack.push(Waiting::new(0.0, Child(rest)));
                    }
                    stack.push(Waiting::new(0.0, Child::LEAVE));
                    walking = inner;
                    next = Waiting::new(0.0, Child::ROOT);
                    continue;
                }
                Step::Look(leaf) => {
                    next = Waiting::new(next.enter(), Child(leaf));
                    continue;
                }
                Step::Stop => return ControlFlow::Break(()),
            }
        }

        // Take the nearest box that is still worth a look.
        next = loop {
            let Some(waiting) = stack.pop() else {
                return ControlFlow::Continue(());
            };
            if waiting.child() == Child::LEAVE {
                walking = visitor.leave();
            } else if waiting.enter() <= walking.limit {
                break waiting;
            }
        };
    }
}

impl Node {
    /// Answers with one child that the ray meets, the nearest if the visitor cares, and pushes the others.
    #[inline(always)]
    fn push_entered<'b, V: Lanes, W: Visitor<'b>>(
        &self,
        walking: &Walking<'b>,
        stack: &mut TraversalStack,
        visitor: &W,
    ) -> Option<Waiting> {
        let ray = &walking.ray;
        // Where the ray is inside all three slabs. A NaN, from 0 · ∞ for a ray in the plane of a face, compares false and
        // changes nothing, so such a ray is inside that slab.
        let mut enter = V::splat(walking.start);
        let mut exit = V::splat(f32::INFINITY);
        for axis in 0..3 {
            let near = usize::from(ray.near[axis]);
            let far = 2 * axis + 3 - near;
            let (origin, inverse) = (V::splat(ray.origin[axis]), V::splat(ray.inverse[axis]));
            let near = V::load(&self.planes[near]).sub(origin).mul(inverse);
            let far = V::load(&self.planes[far]).sub(origin).mul(inverse);
            enter = near.max(enter);
            exit = far.min(exit);
        }
        let exit = exit.mul(V::splat(BOX_SLACK)).min(V::splat(walking.limit));
        let mut lanes = enter.at_most(exit);

        if lanes == 0 {
            return None;
        }
        let lane = lanes.trailing_zeros() as usize % WIDTH;
        lanes &= lanes - 1;
        let enters = enter.store();
        let mut nearest = Waiting::new(enters[lane], self.children[lane]);
        let mut fresh = 0;
        while lanes != 0 {
            let lane = lanes.trailing_zeros() as usize % WIDTH;
            lanes &= lanes - 1;
            let mut other = Waiting::new(enters[lane], self.children[lane]);
            if let Some(number) = self.children[lane].as_node() {
                if let Some(node) = walking.bvh.nodes.get(number) {
                    V::prefetch(node);
                }
            } else {
                visitor.soon::<V>(self.children[lane].0);
            }
            if W::NEAREST_FIRST {
                (nearest, other) = (nearest.min(other), nearest.max(other));
            }
            stack.push(other);
            fresh += 1;
            if W::NEAREST_FIRST {
                stack.settle(fresh);
            }
        }
        Some(nearest)
    }
}
