//! Building the hierarchy: obvhs joins boxes to a binary tree, batch by batch; eight of its subtrees make one of our nodes.
//!
//! ```text
//! boxes → halved at the median until ≤ BATCH are left → obvhs: locally ordered clustering, then reinsertion
//!       → the CARRIED largest subtrees of each batch are the boxes of the batch above → … → one binary tree
//!       → eight-wide: the subtrees are shared out to nodes and leaves so that rays spend least, by the areas of the boxes
//! ```
//! Batches, and not one run of obvhs over everything, because its clustering joins only pairs that choose each other: boxes
//! that are equal, nested, evenly spaced or in a geometric series can give one pair per pass, that is quadratic time and a
//! tree as deep as there are boxes. A batch bounds both, since its size does not grow with the input. A batch whose tree
//! is too deep all the same is split by number. What is decided badly inside a batch because of its borders is mended
//! above, where its subtrees meet those of its neighbours.
//!
//! Beside the top-down builder on binned centroids that stood here before, in million rays per second of one thread
//! (`cargo bench --bench kernel`, two cores of an AMD EPYC that others used too):
//!
//! | | before: camera, bounce, sun | now |
//! |---|---|---|
//! | tree of a million triangles | 2.62, 0.28, 0.51 | 2.98, 0.30, 0.57 |
//! | forest of 2000 instances, from above | 0.43, 0.35, 0.90 | 0.53, 0.43, 1.16 |
//! | the same from inside | 0.32, 0.25, 1.01 | 0.38, 0.27, 1.21 |
//! | Cornell box | 8.27, 4.89, 5.73 | 9.42, 5.36, 9.20 |
//! | a million instances, camera | 0.21 | 0.34 |
//!
//! Building the tree of a million triangles took 1.97 s before and 1.25 s now, by the clock, on the busy machine.
//!
//! obvhs runs without threads of its own; batches run in parallel. The tree therefore depends on the boxes only.
//!
//! Sources: [Meister2018a](crate::references#meister2018a), [Meister2018b](crate::references#meister2018b),
//! [Benthin2024](crate::references#benthin2024).

use super::node::{Bvh, Child, Node};
use super::simd::WIDTH;
use glam::DVec3;
use obvhs::Boundable;
use obvhs::aabb::Aabb;
use obvhs::bvh2::{Bvh2, reinsertion::ReinsertionOptimizer};
use obvhs::ploc::{PlocBuilder, PlocSearchDistance, SortPrecision};
use rayon::prelude::*;
use std::ops::Range;

/// Most boxes that obvhs gets at once.
const BATCH: usize = 256;
/// Subtrees that a batch hands to the one above.
const CARRIED: usize = 32;
/// What a leaf has room for. Boxes weigh whole parts of it, for leaves of up to eight boxes.
const FULL: usize = 840;
/// What it costs to look into a node, and into a leaf.
const NODE_COST: f64 = 1.0;
const LEAF_COST: f64 = 1.0;
/// Fraction of the nodes of a batch that obvhs tries to move to better places; it repeats that with ever smaller fractions.
const REINSERTED: f32 = 1.0;

/// An axis-parallel box in `f32`.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Box3 {
    /// Smallest x, y, z.
    pub min: [f32; 3],
    /// Largest x, y, z.
    pub max: [f32; 3],
}

impl Box3 {
    /// The box that holds nothing.
    pub const EMPTY: Self = Self {
        min: [f32::INFINITY; 3],
        max: [f32::NEG_INFINITY; 3],
    };

    /// The smallest box around both; exact.
    fn union(&self, other: &Self) -> Self {
        Self {
            min: std::array::from_fn(|axis| self.min[axis].min(other.min[axis])),
            max: std::array::from_fn(|axis| self.max[axis].max(other.max[axis])),
        }
    }

    fn corners(&self) -> [DVec3; 2] {
        [self.min, self.max].map(|corner| DVec3::from_array(corner.map(f64::from)))
    }

    /// Twice the centre, which serves as centroid. In `f64` no finite box overflows.
    fn centroid(&self) -> DVec3 {
        let [min, max] = self.corners();
        min + max
    }

    /// Half of the surface area of a box that is not empty.
    fn half_area(&self) -> f64 {
        let [min, max] = self.corners();
        let d = max - min;
        d.x * d.y + d.y * d.z + d.z * d.x
    }
}

/// Boxes of one kind. They share leaves with each other, not with those of other kinds.
#[derive(Clone, Copy, Debug)]
pub struct BoxKind {
    /// The number after their last; the next kind begins there.
    pub end: usize,
    /// How many of them fit into a leaf, 1 to 8.
    pub per_leaf: usize,
}

/// Builds a hierarchy over `boxes` (all finite), which come sorted by kinds.
///
/// O(n log n), for whatever boxes; the result does not depend on the number of threads.
#[must_use]
pub fn build(boxes: &[Box3], kinds: &[BoxKind]) -> (Bvh, Leaves) {
    build_unless(boxes, kinds, &|| false)
}

/// As [`build`], but once `stop` says so it ends soon, with a hierarchy that is good for nothing.
#[must_use]
pub fn build_unless(
    boxes: &[Box3],
    kinds: &[BoxKind],
    stop: &(dyn Fn() -> bool + Sync),
) -> (Bvh, Leaves) {
    let mut bvh = Bvh::default();
    let mut leaves = Leaves {
        ends: Vec::new(),
        order: Vec::with_capacity(boxes.len()),
    };
    if !boxes.is_empty() {
        let items = boxes.par_iter().zip(0_u32..boxes.len() as u32);
        let mut items: Vec<_> = items.map(|(bounds, index)| (*bounds, index)).collect();
        let weigh = |index: u32| {
            let kind = kinds.partition_point(|kind| kind.end <= index as usize);
            (
                kind,
                kinds
                    .get(kind)
                    .map_or(FULL, |kind| FULL.div_ceil(kind.per_leaf.max(1))),
            )
        };
        let tree = merge(cluster(&mut items, &weigh, stop));
        store(tree, (&mut bvh.nodes, &mut leaves), stop);
    }
    (bvh, leaves)
}

/// What the leaves hold.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Leaves {
    /// Where in `order` each leaf ends, and the next begins.
    ends: Vec<u32>,
    /// The numbers of the boxes, leaf after leaf.
    pub order: Vec<u32>,
}

impl Leaves {
    /// The part of `order` that is in a leaf.
    #[must_use]
    pub fn range(&self, leaf: u32) -> Range<usize> {
        let leaf = leaf as usize;
        let start = leaf.checked_sub(1).map_or(0, |before| self.ends[before]);
        start as usize..self.ends[leaf] as usize
    }
}

/// A box and its number.
type Entry = (Box3, u32);

/// A box, or two subtrees and the box around them.
struct Subtree {
    bounds: Box3,
    /// The kind of the boxes in it, if there is only one.
    kind: usize,
    /// Of the boxes in it, in parts of a [`FULL`] leaf; more than that if they are of several kinds.
    weight: usize,
    /// What rays spend in it at least if it takes up to 1, 2, … places of a node, up to a factor.
    costs: [f64; WIDTH],
    content: Content,
}

enum Content {
    /// The number of a box.
    Item(u32),
    Pair(Box<[Subtree; 2]>),
}

impl Subtree {
    fn item(&(bounds, index): &Entry, (kind, weight): (usize, usize)) -> Self {
        Self {
            bounds,
            kind,
            weight,
            costs: [bounds.half_area() * LEAF_COST; WIDTH],
            content: Content::Item(index),
        }
    }

    fn pair(left: Self, right: Self) -> Self {
        let bounds = left.bounds.union(&right.bounds);
        let (kind, mut weight) = (left.kind, left.weight + right.weight);
        if kind != right.kind {
            weight = weight.max(FULL + 1);
        }
        let area = bounds.half_area();
        let as_node = area * NODE_COST + split(&left, &right, WIDTH).0;
        let as_leaf = area * LEAF_COST;
        let mut costs = [as_node; WIDTH];
        if weight <= FULL {
            costs[0] = as_leaf.min(as_node);
        }
        for places in 2..=WIDTH {
            costs[places - 1] = costs[places - 2].min(split(&left, &right, places).0);
        }
        Self {
            bounds,
            kind,
            weight,
            costs,
            content: Content::Pair(Box::new([left, right])),
        }
    }

    /// Whether it had better be a leaf, if it takes one place.
    fn is_leaf(&self) -> bool {
        let is_item = matches!(self.content, Content::Item(_));
        is_item || (self.weight <= FULL && self.bounds.half_area() * LEAF_COST <= self.costs[0])
    }
}

/// Joins the items to at most half a batch of subtrees.
fn cluster(
    items: &mut [Entry],
    weigh: &(impl Fn(u32) -> (usize, usize) + Sync),
    stop: &(dyn Fn() -> bool + Sync),
) -> Vec<Subtree> {
    let parts = if stop() {
        return vec![Subtree::item(&items[0], weigh(items[0].1))];
    } else if items.len() <= BATCH {
        let item = |entry: &Entry| Subtree::item(entry, weigh(entry.1));
        items.iter().map(item).collect()
    } else {
        let [left, right] = halve(items);
        let (mut parts, others) = rayon::join(
            || cluster(left, weigh, stop),
            || cluster(right, weigh, stop),
        );
        parts.extend(others);
        parts
    };
    if parts.len() <= BATCH / 2 {
        return parts;
    }
    open(merge(parts), CARRIED)
}

/// Splits at the median of the centroids along the axis where they differ most; where they are equal, by number.
fn halve(items: &mut [Entry]) -> [&mut [Entry]; 2] {
    let axis = widest_axis(items.iter().map(|(bounds, _)| bounds));
    let middle = items.len() / 2;
    items.select_nth_unstable_by(middle, |a, b| {
        let place = |item: &Entry| item.0.centroid()[axis];
        place(a).total_cmp(&place(b)).then(a.1.cmp(&b.1))
    });
    items.split_at_mut(middle).into()
}

/// The axis along which the centroids differ most.
fn widest_axis<'b>(boxes: impl Iterator<Item = &'b Box3>) -> usize {
    let (mut min, mut max) = (DVec3::INFINITY, DVec3::NEG_INFINITY);
    for bounds in boxes {
        min = min.min(bounds.centroid());
        max = max.max(bounds.centroid());
    }
    (max - min).max_position()
}

/// Joins at least one and at most a batch of subtrees to one.
fn merge(mut parts: Vec<Subtree>) -> Subtree {
    if let Some(tree) = clustered(&parts) {
        let mut parts: Vec<_> = parts.into_iter().map(Some).collect();
        return assemble(&tree, 0, &mut parts);
    }
    let axis = widest_axis(parts.iter().map(|part| &part.bounds));
    parts.sort_by(|a, b| {
        let place = |part: &Subtree| part.bounds.centroid()[axis];
        let size = |part: &Subtree| part.bounds.half_area();
        let by_place = place(a).total_cmp(&place(b));
        by_place.then(size(a).total_cmp(&size(b)))
    });
    balanced(parts)
}

/// The tree of obvhs over the parts, whose leaves are numbers of parts; `None` if it would be too deep.
fn clustered(parts: &[Subtree]) -> Option<Bvh2> {
    let first = parts.first()?.bounds;
    // obvhs takes as many passes as there are boxes, only to find that any pair is as good as any other.
    if parts
        .iter()
        .all(|part| part.bounds.centroid() == first.centroid())
    {
        return None;
    }
    let boxes = scaled(parts);
    let numbers = (0..parts.len() as u32).collect();
    let (distance, precision) = (PlocSearchDistance::Medium, SortPrecision::U64);
    let mut tree = PlocBuilder::new().build(distance, &boxes, numbers, precision, 0);
    let deepest = 8 + 2 * parts.len().ilog2() as usize;
    if tree.depth(0) > deepest {
        return None;
    }
    // The optimizer's stack holds twice this, and cannot hold more than there are parts.
    tree.max_depth = tree.max_depth.max(parts.len().div_ceil(2));
    ReinsertionOptimizer::default().run(&mut tree, REINSERTED, None);
    (tree.depth(0) <= deepest).then_some(tree)
}

/// A box as obvhs wants it.
struct Scaled(Aabb);

impl Boundable for Scaled {
    fn aabb(&self) -> Aabb {
        self.0
    }
}

/// The boxes of the parts, moved and scaled into the unit cube: areas can then neither overflow nor all vanish, which obvhs
/// does not expect. Rounding here changes only which boxes are joined.
fn scaled(parts: &[Subtree]) -> Vec<Scaled> {
    let whole = parts
        .iter()
        .fold(Box3::EMPTY, |whole, part| whole.union(&part.bounds));
    let [start, end] = whole.corners();
    // The smallest positive number keeps a single point from 0 / 0.
    let extent = (end - start).max_element().max(f64::MIN_POSITIVE);
    let into_cube = |corner: DVec3| ((corner - start) / extent).as_vec3a();
    let scale = |part: &Subtree| {
        let [min, max] = part.bounds.corners().map(into_cube);
        Scaled(Aabb::new(min, max))
    };
    parts.iter().map(scale).collect()
}

/// Makes subtrees of obvhs' nodes from `index` down; takes the parts that are their leaves.
fn assemble(tree: &Bvh2, index: usize, parts: &mut [Option<Subtree>]) -> Subtree {
    let node = &tree.nodes[index];
    let first = node.first_index as usize;
    if node.is_leaf() {
        return parts[first]
            .take()
            .expect("invariant: obvhs puts every box into one leaf");
    }
    let left = assemble(tree, first, parts);
    Subtree::pair(left, assemble(tree, first + 1, parts))
}

/// Joins the parts in their order to a tree of the least depth.
fn balanced(mut parts: Vec<Subtree>) -> Subtree {
    while parts.len() > 1 {
        let mut rest = parts.into_iter();
        parts = Vec::new();
        while let Some(left) = rest.next() {
            parts.push(match rest.next() {
                Some(right) => Subtree::pair(left, right),
                None => left,
            });
        }
    }
    parts.swap_remove(0)
}

/// Opens the largest pair, again and again, until there are `most` subtrees or nothing but items.
fn open(root: Subtree, most: usize) -> Vec<Subtree> {
    let mut parts = vec![root];
    while parts.len() < most {
        let is_pair = |index: &usize| matches!(parts[*index].content, Content::Pair(_));
        let area = |index: &usize| parts[*index].bounds.half_area();
        let pairs = (0..parts.len()).filter(is_pair);
        let Some(best) = pairs.max_by(|a, b| area(a).total_cmp(&area(b))) else {
            break;
        };
        if let Content::Pair(pair) = parts.remove(best).content {
            parts.splice(best..best, *pair);
        }
    }
    parts
}

/// The best way to share at least two places of a node between two subtrees: what it costs, and how many the left one gets.
fn split(left: &Subtree, right: &Subtree, places: usize) -> (f64, usize) {
    let cost = |share: usize| left.costs[share - 1] + right.costs[places - share - 1];
    // Where it makes no difference, half and half.
    let mut best = (cost(places / 2), places / 2);
    for share in 1..places {
        if cost(share) < best.0 {
            best = (cost(share), share);
        }
    }
    best
}

/// Shares `places` places of a node among the parts of a subtree that is not a leaf.
fn share_places(part: Subtree, places: usize, parts: &mut Vec<Subtree>) {
    match part.content {
        Content::Pair(pair) => {
            let [left, right] = *pair;
            let (_, share) = split(&left, &right, places);
            for (part, places) in [(left, share), (right, places - share)] {
                place(part, places, parts);
            }
        }
        Content::Item(_) => parts.push(part),
    }
}

/// Gives a subtree at most so many places: the least of them that cost as little, but more where one costs the same.
fn place(part: Subtree, places: usize, parts: &mut Vec<Subtree>) {
    let is_divided = |places: usize| {
        places > 1
            && matches!(&part.content, Content::Pair(pair)
                if split(&pair[0], &pair[1], places).0 <= part.costs[places - 2])
    };
    match (1..=places).rev().find(|places| is_divided(*places)) {
        Some(places) => share_places(part, places, parts),
        None => parts.push(part),
    }
}

/// Appends the nodes of a tree, its root first, and its leaves; returns the root. Once `stop` says so, nothing more.
fn store(
    tree: Subtree,
    (nodes, leaves): (&mut Vec<Node>, &mut Leaves),
    stop: &(dyn Fn() -> bool + Sync),
) -> Child {
    let number = nodes.len();
    nodes.push(Node::EMPTY);
    if stop() {
        // To give back millions of small pieces of memory takes longer than whoever waits would like.
        rayon::spawn(move || drop(tree));
        return Child::node(number);
    }
    let mut children = Vec::with_capacity(WIDTH);
    if tree.is_leaf() {
        children.push(tree);
    } else {
        share_places(tree, WIDTH, &mut children);
    }
    for (index, part) in children.into_iter().enumerate() {
        let bounds = part.bounds;
        let child = if part.is_leaf() {
            list(part, &mut leaves.order);
            leaves.ends.push(leaves.order.len() as u32);
            Child(leaves.ends.len() as u32 - 1)
        } else {
            store(part, (&mut *nodes, &mut *leaves), stop)
        };
        nodes[number].set(index, &bounds, child);
    }
    Child::node(number)
}

/// Appends the items of a tree.
fn list(tree: Subtree, order: &mut Vec<u32>) {
    match tree.content {
        Content::Item(index) => order.push(index),
        Content::Pair(pair) => pair.into_iter().for_each(|part| list(part, order)),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Boxes from a fixed pseudo-random sequence, of all sizes.
    fn boxes(count: u32) -> Vec<Box3> {
        let number = |k: u32| (k.wrapping_mul(2_654_435_769) >> 8) as f32 / 16_777_216.0;
        (0..count)
            .map(|i| {
                let min = std::array::from_fn(|axis| number(i * 7 + axis as u32) * 100.0 - 50.0);
                let size = number(i * 7 + 5).powi(8) * 50.0;
                Box3 {
                    min,
                    max: min.map(|x| x + size),
                }
            })
            .collect()
    }

    /// All boxes are of one kind.
    fn all(boxes: &[Box3], per_leaf: usize) -> [BoxKind; 1] {
        let end = boxes.len();
        [BoxKind { end, per_leaf }]
    }

    #[test]
    fn kinds_do_not_share_leaves() {
        let boxes = boxes(3000);
        let kind = |end, per_leaf| BoxKind { end, per_leaf };
        let kinds = [kind(1000, 8), kind(2000, 1), kind(3000, 2)];
        let (_, leaves) = build(&boxes, &kinds);
        let kind_of = |item: &u32| kinds.partition_point(|kind| kind.end <= *item as usize);
        let mut shared = [0; 3];
        for leaf in 0..leaves.ends.len() as u32 {
            let items = &leaves.order[leaves.range(leaf)];
            let kind = kind_of(&items[0]);
            assert!(items.len() <= kinds[kind].per_leaf);
            assert!(items.iter().all(|item| kind_of(item) == kind));
            shared[kind] += usize::from(items.len() > 1);
        }
        assert!(
            shared[0] > 0 && shared[1] == 0 && shared[2] > 0,
            "{shared:?}"
        );
    }

    /// Checks that every box stands in exactly one leaf, inside the boxes of all nodes above, and returns the depth.
    fn validate(bvh: &Bvh, leaves: &Leaves, boxes: &[Box3], leaf_size: usize) -> usize {
        let mut seen = vec![false; boxes.len()];
        let mut deepest = 0;
        let everything = Box3 {
            min: [f32::NEG_INFINITY; 3],
            max: [f32::INFINITY; 3],
        };
        let mut open = vec![(0_usize, 1_usize, everything)];
        while let Some((node, depth, outer)) = open.pop() {
            deepest = deepest.max(depth);
            for lane in 0..WIDTH {
                let planes = &bvh.nodes[node].planes;
                let inner = Box3 {
                    min: std::array::from_fn(|axis| planes[axis][lane]),
                    max: std::array::from_fn(|axis| planes[axis + 3][lane]),
                };
                if inner == Box3::EMPTY {
                    continue;
                }
                let holds = |a: &Box3, b: &Box3| {
                    (0..3).all(|axis| a.min[axis] <= b.min[axis] && a.max[axis] >= b.max[axis])
                };
                assert!(holds(&outer, &inner));
                let child = bvh.nodes[node].children[lane];
                if let Some(below) = child.as_node() {
                    assert!(below > node);
                    open.push((below, depth + 1, inner));
                } else {
                    let items = leaves.range(child.0);
                    assert!(items.len() <= leaf_size);
                    for item in items {
                        let index = leaves.order[item] as usize;
                        assert!(holds(&inner, &boxes[index]) && !seen[index]);
                        seen[index] = true;
                    }
                }
            }
        }
        assert!(seen.iter().all(|seen| *seen));
        deepest
    }

    #[test]
    fn every_box_stands_in_one_leaf() {
        for count in [1, 2, 7, 8, 9, 64, 1000, 20_000] {
            for leaf_size in [1, 4, 8] {
                let boxes = boxes(count);
                let (bvh, leaves) = build(&boxes, &all(&boxes, leaf_size));
                let depth = validate(&bvh, &leaves, &boxes, leaf_size);
                assert!(depth < 20, "{count}: {depth}");
            }
        }
        assert_eq!(build(&[], &[]), (Bvh::default(), Leaves::default()));
    }

    /// `count` cubes with the given centre along x and half an edge.
    fn cubes(count: i32, cube: impl Fn(i32) -> (f32, f32)) -> Vec<Box3> {
        let cubes = (0..count).map(|k| {
            let (x, r) = cube(k);
            Box3 {
                min: [x - r, -r, -r],
                max: [x + r, r, r],
            }
        });
        cubes.collect()
    }

    #[test]
    fn whatever_the_boxes_the_tree_is_shallow() {
        let whimsical = |k: i32| {
            let size = 10_f32.powi(k * 7 % 61 - 30);
            (size * (k % 5 - 2) as f32, size * (k % 3) as f32)
        };
        for (name, boxes) in [
            ("coincident", cubes(100_000, |_| (0.5, 0.5))),
            ("points in one place", cubes(50_000, |_| (7.0, 0.0))),
            (
                "nearly coincident",
                cubes(10_000, |k| (1.0, 1.0 + (k % 7) as f32 * f32::EPSILON)),
            ),
            ("nested", cubes(10_000, |k| (0.0, k as f32 / 64.0))),
            (
                "nested and touching",
                cubes(10_000, |k| (k as f32, k as f32)),
            ),
            ("evenly spaced", cubes(10_000, |k| (k as f32 * 2.0, 0.5))),
            ("points in a row", cubes(10_000, |k| (k as f32, 0.0))),
            (
                "in a series",
                cubes(10_000, |k| (4096.0 * 0.999_f32.powi(k), 0.01)),
            ),
            (
                "in a shrinking series",
                cubes(10_000, |k| (0.999_f32.powi(k), 1e-4 * 0.999_f32.powi(k))),
            ),
            ("of all magnitudes", cubes(10_000, whimsical)),
            ("huge", cubes(1000, |k| (1e35 * k as f32, 1e38))),
        ] {
            let (bvh, leaves) = build(&boxes, &all(&boxes, 4));
            let depth = validate(&bvh, &leaves, &boxes, 4);
            assert!(depth <= 24, "{name}: {depth}");
            assert!(
                bvh.nodes.len() <= boxes.len() / 2,
                "{name}: {}",
                bvh.nodes.len()
            );
        }
    }

    #[test]
    fn the_number_of_threads_does_not_matter() {
        let boxes = boxes(30_000);
        let with = |threads| {
            let pool = rayon::ThreadPoolBuilder::new()
                .num_threads(threads)
                .build()
                .unwrap();
            pool.install(|| build(&boxes, &all(&boxes, 4)))
        };
        let alone = with(1);
        assert!(alone == with(2) && alone == with(3));
    }
}
