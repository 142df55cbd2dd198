//! What a hierarchy covers, in a few boxes.

use super::node::{Bvh, Child};
use super::simd::WIDTH;
use crate::math::Bounds3;
use glam::DVec3;

impl Bvh {
    /// At most `most` boxes (but at least those of the root) that together hold everything. They fit closer than the one
    /// box around them, above all once they are turned.
    #[must_use]
    pub fn cover(&self, most: usize) -> Vec<Bounds3> {
        let mut boxes: Vec<(Bounds3, Child)> = Vec::new();
        let mut next = Some(Child::ROOT);
        while let Some(node) = next.take().and_then(Child::as_node) {
            boxes.extend(self.boxes(node));
            if boxes.len() + WIDTH > most + 1 {
                break;
            }
            // The largest that can be opened; of equals the last, so that the order is fixed.
            let is_node = |index: &usize| boxes[*index].1.as_node().is_some();
            let area = |index: &usize| boxes[*index].0.surface_area();
            let largest = (0..boxes.len())
                .filter(is_node)
                .max_by(|a, b| area(a).total_cmp(&area(b)));
            next = largest.map(|index| boxes.swap_remove(index).1);
        }
        boxes.into_iter().map(|(bounds, _)| bounds).collect()
    }

    /// The children of a node.
    fn boxes(&self, node: usize) -> impl Iterator<Item = (Bounds3, Child)> {
        let node = self.nodes.get(node);
        let lanes = node
            .into_iter()
            .flat_map(|node| (0..WIDTH).map(move |lane| (node, lane)));
        let boxes = lanes.map(|(node, lane)| {
            let corner = |first: usize| {
                DVec3::from_array(std::array::from_fn(|axis| {
                    f64::from(node.planes[first + axis][lane])
                }))
            };
            let (min, max) = (corner(0), corner(3));
            (Bounds3 { min, max }, node.children[lane])
        });
        boxes.filter(|(bounds, _)| !bounds.is_empty())
    }
}
