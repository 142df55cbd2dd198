//! Points found by place: a hash grid.
//!
//! Each point lies in one cell of a grid as wide as the search, each cell in one slot of a table; points are sorted by slot once.
//! A search looks into the slots of the 27 cells round it, each slot once even if two cells share it, and tests distances.
//!
//! A fixed radius asks for no tree: `light.md` §0.3 measured 7 million searches per second for such a grid against 0.8 million of
//! a k-d tree (kiddo 6.3, two cores, 80 photons found), and coincident points are nothing special to it.

use crate::math::rng;
use glam::{DVec3, IVec3};

/// Things with a place, sorted for searches of one radius.
#[derive(Clone, Debug)]
pub struct Grid<T> {
    things: Vec<T>,
    /// Where the things of each slot begin, and the end.
    starts: Vec<u32>,
    cell: f64,
}

impl<T: Copy> Grid<T> {
    /// Sorts at most 2³² - 1 things for searches of up to `radius` metres, more than 0. Sorting them again changes nothing.
    pub fn new(mut things: Vec<T>, radius: f64, place: impl Fn(&T) -> DVec3) -> Self {
        let n_slots = things.len().next_power_of_two().max(1);
        let slot = |thing: &T| slot(cell(place(thing), radius), n_slots);
        let mut starts = vec![0_u32; n_slots + 1];
        for thing in &things {
            starts[slot(thing) + 1] += 1;
        }
        for at in 0..n_slots {
            starts[at + 1] += starts[at];
        }
        // In place, as an American flag sort: each thing is swapped to the next free place of its slot.
        let mut next = starts.clone();
        for at in 0..n_slots {
            while next[at] < starts[at + 1] {
                let here = next[at] as usize;
                let there = slot(&things[here]);
                if there != at {
                    things.swap(here, next[there] as usize);
                }
                next[there] += 1;
            }
        }
        Self {
            things,
            starts,
            cell: radius,
        }
    }

    /// All things, in an order that sorting them again keeps.
    #[must_use]
    pub fn things(&self) -> &[T] {
        &self.things
    }

    /// Shows `visit` all things in the grid's cell round `center`, and some that are not there.
    pub(super) fn around(&self, center: DVec3, visit: impl FnMut(&T)) {
        let slot = slot(cell(center, self.cell), self.starts.len() - 1);
        let (begin, end) = (self.starts[slot] as usize, self.starts[slot + 1] as usize);
        self.things[begin..end].iter().for_each(visit);
    }

    /// The things alone, so sorted.
    #[must_use]
    pub fn into_things(self) -> Vec<T> {
        self.things
    }

    /// Shows `visit` all things that may be within the grid's radius of `center`, each once, and some that are not.
    pub fn near(&self, center: DVec3, mut visit: impl FnMut(&T)) {
        let n_slots = self.starts.len() - 1;
        let middle = cell(center, self.cell);
        let mut seen = [usize::MAX; 27];
        let mut n_seen = 0;
        for dz in -1..=1 {
            for dy in -1..=1 {
                for dx in -1..=1 {
                    let slot = slot(middle.wrapping_add(IVec3::new(dx, dy, dz)), n_slots);
                    let (begin, end) = (self.starts[slot] as usize, self.starts[slot + 1] as usize);
                    if begin == end || seen[..n_seen].contains(&slot) {
                        continue;
                    }
                    seen[n_seen] = slot;
                    n_seen += 1;
                    self.things[begin..end].iter().for_each(&mut visit);
                }
            }
        }
    }
}

/// The cell of a point; beyond ± 2³¹ cells the last one.
pub(super) fn cell(point: DVec3, width: f64) -> IVec3 {
    (point / width).floor().as_ivec3()
}

fn slot(cell: IVec3, n_slots: usize) -> usize {
    let [x, y, z] = cell.to_array().map(|c| u64::from(c.cast_unsigned()));
    rng::mix((x << 32 | y).wrapping_add(rng::mix(z.wrapping_add(1)))) as usize & (n_slots - 1)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn searches_find_what_a_look_at_all_points_finds() {
        let point = |i: u64| {
            let u = |k| rng::unit_f64(rng::hash(&[i, k])) * 2.0 - 1.0;
            DVec3::new(u(0), u(1), u(2))
        };
        let points: Vec<DVec3> = (0..3000).map(point).collect();
        for radius in [0.01, 0.2, 5.0] {
            let grid = Grid::new(points.clone(), radius, |p| *p);
            for i in 0..50 {
                let center = point(10_000 + i);
                let is_near = |p: &&DVec3| (**p - center).length() <= radius;
                let truth = points.iter().filter(is_near).count();
                let mut found = 0;
                grid.near(center, |p| found += usize::from(is_near(&p)));
                assert_eq!(found, truth, "{radius}");
            }
        }
    }

    #[test]
    fn c38_a_hundred_thousand_coincident_points_are_all_found() {
        let points = vec![DVec3::new(0.3, -0.7, 0.1); 100_000];
        let grid = Grid::new(points, 0.5, |p| *p);
        let mut found = 0;
        grid.near(DVec3::new(0.2, -0.6, 0.0), |_| found += 1);
        assert_eq!(found, 100_000);
        // All in a plane.
        let flat = (0..100_000).map(|i| DVec3::new(f64::from(i % 300), f64::from(i / 300), 0.0));
        let grid = Grid::new(flat.collect(), 1.5, |p| *p);
        let mut found = 0;
        grid.near(DVec3::new(100.0, 100.0, 0.1), |p| {
            found += usize::from((*p - DVec3::new(100.0, 100.0, 0.1)).length() <= 1.5);
        });
        assert_eq!(found, 9);
    }

    #[test]
    fn no_points_and_points_at_the_end_of_the_world() {
        let none = Grid::new(Vec::<DVec3>::new(), 1.0, |p| *p);
        none.near(DVec3::ZERO, |_| panic!());
        let far = Grid::new(vec![DVec3::splat(1e300), DVec3::splat(-1e300)], 1.0, |p| *p);
        let mut found = 0;
        far.near(DVec3::splat(1e300), |_| found += 1);
        assert!(found >= 1);
    }
}
