//! Building the hierarchy: top down, eight children at a time, by the surface area heuristic on binned centroids.
//!
//! A set of boxes is split where the sum of area × count of both halves is smallest, the largest set first, until there
//! are eight. Boxes with one common centroid are split by number, so that any input, however degenerate, gives a tree
//! whose depth is logarithmic: neither its building nor its traversal can degrade to the quadratic behaviour that
//! agglomerative builders show for coincident boxes. (obvhs's `Bvh2` was counted beside it: about as many nodes per ray on
//! trees and forests, a fifth fewer on a million instances, but quadratic time for coincident boxes.)
//!
//! Source: [Wald2007](crate::references#wald2007).

use super::node::{Bvh, Child, Node, WIDTH};
use rayon::prelude::*;

/// Classes of centroids per axis.
const BINS: usize = 16;
/// Sets of at least this many boxes are built in parallel.
const PARALLEL: usize = 4096;

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

    fn grow(&mut self, other: &Self) {
        for axis in 0..3 {
            self.min[axis] = self.min[axis].min(other.min[axis]);
            self.max[axis] = self.max[axis].max(other.max[axis]);
        }
    }

    /// Twice the centre, which serves as centroid without a rounding.
    fn centroid(&self, axis: usize) -> f32 {
        self.min[axis] + self.max[axis]
    }

    /// Half of the surface area; 0 if the box is empty.
    fn half_area(&self) -> f32 {
        let d: [f32; 3] = std::array::from_fn(|axis| (self.max[axis] - self.min[axis]).max(0.0));
        d[0] * d[1] + d[1] * d[2] + d[2] * d[0]
    }
}

/// Builds a hierarchy over `boxes` (all finite) whose leaves hold at most `leaf_size` boxes.
///
/// Also returns the order in which the leaves list the boxes: item i of the hierarchy is box `order[i]`. O(n log n); the
/// result does not depend on the number of threads.
#[must_use]
pub fn build(boxes: &[Box3], leaf_size: usize) -> (Bvh, Vec<u32>) {
    let mut entries: Vec<Entry> = boxes
        .iter()
        .enumerate()
        .map(|(index, bounds)| Entry {
            bounds: *bounds,
            index: index as u32,
        })
        .collect();
    let mut bvh = Bvh::default();
    if !entries.is_empty() {
        let whole = Set::of(&entries, 0);
        let tree = grow(&mut entries, whole, leaf_size.max(1));
        tree.store(&mut bvh.nodes);
    }
    (bvh, entries.into_iter().map(|entry| entry.index).collect())
}

/// A box and its number.
#[derive(Clone, Copy)]
struct Entry {
    bounds: Box3,
    index: u32,
}

/// A run of entries, with their common box and the box of their centroids.
#[derive(Clone, Copy)]
struct Set {
    first: usize,
    count: usize,
    bounds: Box3,
    centroids: Box3,
}

impl Set {
    fn of(entries: &[Entry], first: usize) -> Self {
        let mut set = Self {
            first,
            count: entries.len(),
            bounds: Box3::EMPTY,
            centroids: Box3::EMPTY,
        };
        for entry in entries {
            set.bounds.grow(&entry.bounds);
            let centroid = std::array::from_fn(|axis| entry.bounds.centroid(axis));
            set.centroids.grow(&Box3 {
                min: centroid,
                max: centroid,
            });
        }
        set
    }
}

/// A node under construction with its children's boxes; leaves are `count > 0`.
struct Tree {
    children: Vec<(Box3, Branch)>,
}

enum Branch {
    Leaf(Child),
    Inner(Tree),
}

/// Builds the node over all `entries`; `whole.first` is where they stand in the final order.
fn grow(entries: &mut [Entry], whole: Set, leaf_size: usize) -> Tree {
    // Split the largest set until there are eight.
    let mut sets = vec![Set { first: 0, ..whole }];
    while sets.len() < WIDTH {
        let Some(largest) = next_to_split(&sets, whole.count, leaf_size) else {
            break;
        };
        let set = sets[largest];
        let (left, right) = split(
            &mut entries[set.first..set.first + set.count],
            set.first,
            &set,
        );
        sets[largest] = left;
        sets.push(right);
    }
    sets.sort_by_key(|set| set.first);

    // Hand each child its own part of the entries.
    let mut rest = entries;
    let mut parts = Vec::with_capacity(sets.len());
    for set in &sets {
        let (part, tail) = rest.split_at_mut(set.count);
        rest = tail;
        parts.push((*set, part));
    }
    let branch = |(set, part): (Set, &mut [Entry])| {
        let first = whole.first + set.first;
        let branch = if set.count <= leaf_size {
            Branch::Leaf(Child {
                first: first as u32,
                count: set.count as u32,
            })
        } else {
            Branch::Inner(grow(part, Set { first, ..set }, leaf_size))
        };
        (set.bounds, branch)
    };
    let children = if whole.count >= PARALLEL {
        parts.into_par_iter().map(branch).collect()
    } else {
        parts.into_iter().map(branch).collect()
    };
    Tree { children }
}

/// The set to split next: of those too large for a leaf the one with the largest area. When all are small enough, the
/// places left in the node are filled by splitting further, which costs no memory and tests fewer items.
///
/// If all boxes could be in leaves of this node, the largest number counts before the area: then the nodes at the bottom,
/// which are most of all nodes, are well filled.
fn next_to_split(sets: &[Set], total: usize, leaf_size: usize) -> Option<usize> {
    let is_bottom = total <= WIDTH * WIDTH * leaf_size;
    let by_size = |a: &usize, b: &usize| {
        let (a, b) = (&sets[*a], &sets[*b]);
        let count = a.count.cmp(&b.count);
        let area = a.bounds.half_area().total_cmp(&b.bounds.half_area());
        if is_bottom {
            count.then(area)
        } else {
            area.then(count)
        }
    };
    let above = |size: usize| (0..sets.len()).filter(move |index| sets[*index].count > size);
    above(leaf_size)
        .max_by(by_size)
        .or_else(|| above(1).max_by(by_size))
}

/// Splits a set of at least two entries into two that are not empty.
fn split(entries: &mut [Entry], first: usize, set: &Set) -> (Set, Set) {
    let middle = match best_plane(entries, set) {
        Some(plane) => partition(entries, |entry| plane.class(entry) <= plane.last_left),
        None => 0,
    };
    // Without a plane that separates anything the numbers decide.
    let middle = if middle == 0 || middle == entries.len() {
        entries.len() / 2
    } else {
        middle
    };
    let (left, right) = entries.split_at(middle);
    (Set::of(left, first), Set::of(right, first + middle))
}

/// A place to split: between two classes of centroids along an axis.
#[derive(Clone, Copy)]
struct Plane {
    axis: usize,
    start: f32,
    per_unit: f32,
    last_left: usize,
}

impl Plane {
    fn class(&self, entry: &Entry) -> usize {
        let place = (entry.bounds.centroid(self.axis) - self.start) * self.per_unit;
        (place as usize).min(BINS - 1)
    }
}

/// The plane with the least area × count on both sides, or `None` if all centroids coincide.
fn best_plane(entries: &[Entry], set: &Set) -> Option<Plane> {
    let mut best: Option<(f32, Plane)> = None;
    for axis in 0..3 {
        let start = set.centroids.min[axis];
        let extent = set.centroids.max[axis] - start;
        if extent <= 0.0 {
            continue;
        }
        let per_unit = BINS as f32 / extent;
        let plane = Plane {
            axis,
            start,
            per_unit,
            last_left: 0,
        };
        let mut bins = [(Box3::EMPTY, 0_usize); BINS];
        for entry in entries {
            let (bounds, count) = &mut bins[plane.class(entry)];
            bounds.grow(&entry.bounds);
            *count += 1;
        }
        for (last_left, cost) in costs(&bins) {
            if best.is_none_or(|(least, _)| cost < least) {
                best = Some((cost, Plane { last_left, ..plane }));
            }
        }
    }
    best.map(|(_, plane)| plane)
}

/// The cost of splitting after each class; splits with an empty side are left out.
fn costs(bins: &[(Box3, usize); BINS]) -> impl Iterator<Item = (usize, f32)> {
    let mut right = [(0.0_f32, 0_usize); BINS];
    let (mut bounds, mut count) = (Box3::EMPTY, 0);
    for index in (1..BINS).rev() {
        bounds.grow(&bins[index].0);
        count += bins[index].1;
        right[index - 1] = (bounds.half_area(), count);
    }
    let mut left = [(0.0_f32, 0_usize); BINS];
    (bounds, count) = (Box3::EMPTY, 0);
    for index in 0..BINS - 1 {
        bounds.grow(&bins[index].0);
        count += bins[index].1;
        left[index] = (bounds.half_area(), count);
    }
    (0..BINS - 1)
        .filter(move |index| left[*index].1 > 0 && right[*index].1 > 0)
        .map(move |index| {
            let cost = |(area, count): (f32, usize)| area * count as f32;
            (index, cost(left[index]) + cost(right[index]))
        })
}

/// Moves the entries that are `left` to the front, and returns how many there are.
fn partition(entries: &mut [Entry], left: impl Fn(&Entry) -> bool) -> usize {
    let mut middle = 0;
    for index in 0..entries.len() {
        if left(&entries[index]) {
            entries.swap(middle, index);
            middle += 1;
        }
    }
    middle
}

impl Tree {
    /// Appends the nodes, this one first, and returns its number.
    fn store(&self, nodes: &mut Vec<Node>) -> u32 {
        let number = nodes.len();
        nodes.push(Node::EMPTY);
        for (index, (bounds, branch)) in self.children.iter().enumerate() {
            let child = match branch {
                Branch::Leaf(child) => *child,
                Branch::Inner(tree) => Child {
                    first: tree.store(nodes),
                    count: 0,
                },
            };
            nodes[number].set(index, bounds, child);
        }
        number as u32
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

    /// Checks that every box stands in exactly one leaf, inside the boxes of all nodes above, and returns the depth.
    fn validate(bvh: &Bvh, order: &[u32], boxes: &[Box3], leaf_size: usize) -> usize {
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
                if child.count == 0 {
                    assert!(child.first as usize > node);
                    open.push((child.first as usize, depth + 1, inner));
                } else {
                    assert!(child.count as usize <= leaf_size);
                    for item in child.first..child.first + child.count {
                        let index = order[item as usize] as usize;
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
                let (bvh, order) = build(&boxes, leaf_size);
                let depth = validate(&bvh, &order, &boxes, leaf_size);
                assert!(depth < 20, "{count}: {depth}");
            }
        }
        assert_eq!(build(&[], 4), (Bvh::default(), Vec::new()));
    }

    #[test]
    fn coincident_nested_and_clustered_boxes_stay_shallow_and_quick() {
        let same = vec![
            Box3 {
                min: [0.0; 3],
                max: [1.0; 3]
            };
            200_000
        ];
        let nested: Vec<_> = (1..=200_000)
            .map(|k| k as f32 / 64.0)
            .map(|r| Box3 {
                min: [-r; 3],
                max: [r; 3],
            })
            .collect();
        let clustered: Vec<_> = (0..50_000)
            .map(|k| 4096.0 * 0.999_f32.powi(k))
            .map(|x| Box3 {
                min: [x; 3],
                max: [x + 0.01; 3],
            })
            .collect();
        for boxes in [same, nested, clustered] {
            let (bvh, order) = build(&boxes, 4);
            let depth = validate(&bvh, &order, &boxes, 4);
            assert!(depth < 24, "{depth}");
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
            pool.install(|| build(&boxes, 4))
        };
        assert!(with(1) == with(3));
    }
}
