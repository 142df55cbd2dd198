//! How far a hierarchy reaches in a direction.

use super::node::{Bvh, Child};
use super::simd::WIDTH;
use glam::DVec3;

impl Bvh {
    /// Looks for the largest value of `normal · p` over all points p of what the leaves hold.
    ///
    /// `reach` tells of a leaf, as [`Bvh::relabel`] called it, how far it reaches, given the largest value so far; boxes that cannot add
    /// more than `slack` to it are left out. Starts from `least` and returns the largest value found.
    pub fn extreme(
        &self,
        normal: DVec3,
        slack: f64,
        least: f64,
        reach: &mut impl FnMut(u32, f64) -> f64,
    ) -> f64 {
        let mut best = least;
        let mut open: Vec<(f64, Child)> = Vec::new();
        self.open(Child::ROOT.as_node(), normal, &mut open);
        while let Some((bound, child)) = open.pop() {
            if bound <= best + slack {
                continue;
            }
            match child.as_node() {
                None => best = best.max(reach(child.0, best)),
                node => self.open(node, normal, &mut open),
            }
        }
        best
    }

    /// Puts the children of a node on the list, the one that reaches furthest last.
    fn open(&self, node: Option<usize>, normal: DVec3, open: &mut Vec<(f64, Child)>) {
        let Some(node) = node.and_then(|node| self.nodes.get(node)) else {
            return;
        };
        let first = open.len();
        for index in 0..WIDTH {
            let plane = |side: usize| f64::from(node.planes[side][index]);
            if plane(0) <= plane(3) {
                let along =
                    |axis: usize| (normal[axis] * plane(axis)).max(normal[axis] * plane(axis + 3));
                open.push((along(0) + along(1) + along(2), node.children[index]));
            }
        }
        open[first..].sort_by(|a, b| a.0.total_cmp(&b.0));
    }
}
