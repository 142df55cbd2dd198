//! Searches among photons: the grid of photon mapping beside kiddo's k-d tree, on photons of a Cornell box with a mirror ball.
//!
//! `cargo bench --bench photon`. Both get the same searches in turns, in chunks on two threads; the best of several turns counts.
//! Rates are of two threads: searches over half of the processor time of both together, so other work on the machine counts little.
#![allow(clippy::print_stdout, reason = "a benchmark prints its result")]
#![allow(clippy::unwrap_used, reason = "a benchmark may panic")]

#[path = "../tests/support/room.rs"]
#[allow(dead_code, reason = "tests use the rest")]
mod room;

use glam::{DAffine3, DVec3};
use kiddo::{ImmutableKdTree, SquaredEuclidean};
use room::{Room, at, gray, square};
use rustix::time::{ClockId, clock_gettime};
use std::f64::consts::PI;
use std::hint::black_box;
use std::num::NonZeroUsize;
use std::time::Instant;
use understory::geometry::Shape;
use understory::integrator::grid::Grid;
use understory::integrator::photon::{Aim, Emission, Onward, PhotonHit, Photons, Visitor, trace};
use understory::integrator::{CancelToken, RenderContext};
use understory::light::Light;
use understory::material::Material;
use understory::scene::Scene;

/// Photons sent.
const SENT: u64 = 1_000_000;
/// Searches of a turn.
const SEARCHES: usize = 100_000;
/// Turns of each.
const TURNS: usize = 4;

/// A closed room of 2 m with a mirror ball, lit by a point.
fn cornell() -> Scene {
    let gray_wall = || Material::lambert(gray(0.75));
    let wall = |shift: DVec3, turn: DAffine3| at(shift.x, shift.y, shift.z) * turn;
    Room::default()
        .with(square(1.0), DAffine3::IDENTITY, gray_wall())
        .with(square(1.0), at(0.0, 0.0, 2.0), gray_wall())
        .with(
            square(1.0),
            wall(
                DVec3::new(1.0, 0.0, 1.0),
                DAffine3::from_rotation_y(PI / 2.0),
            ),
            gray_wall(),
        )
        .with(
            square(1.0),
            wall(
                DVec3::new(-1.0, 0.0, 1.0),
                DAffine3::from_rotation_y(PI / 2.0),
            ),
            gray_wall(),
        )
        .with(
            square(1.0),
            wall(
                DVec3::new(0.0, 1.0, 1.0),
                DAffine3::from_rotation_x(PI / 2.0),
            ),
            gray_wall(),
        )
        .with(
            Shape::Sphere { radius: 0.4 },
            at(0.4, 0.2, 0.4),
            Material::mirror(gray(0.9)),
        )
        .lit_by(Light::point(DVec3::new(0.0, 0.0, 1.9), gray(10.0)))
        .build()
}

/// Where photons arrive.
struct Places(Vec<DVec3>);

impl Visitor for Places {
    fn arrives(&mut self, hit: &PhotonHit<'_>) -> Onward {
        self.0.push(hit.point.position);
        Onward::Go
    }
}

fn photons(scene: &Scene) -> Vec<DVec3> {
    let cancel = CancelToken::default();
    let context = RenderContext {
        seed: 1,
        cancel: &cancel,
        progress: &|_| {},
    };
    let mut all = Vec::new();
    let emission = Emission::new(scene, Aim::Everything);
    let sent = Photons::all(SENT, 1, 64);
    trace(
        &emission,
        &sent,
        &context,
        || Places(Vec::new()),
        |block: Places| all.extend(block.0),
    )
    .unwrap();
    all
}

/// Seconds of processor time of this process.
fn cpu() -> f64 {
    let time = clock_gettime(ClockId::ProcessCPUTime);
    time.tv_sec as f64 + time.tv_nsec as f64 * 1e-9
}

/// Searches per second of two threads, and the sum of what they found: the same for equal searches.
fn rate(queries: &[DVec3], search: impl Fn(DVec3) -> f64 + Sync) -> (f64, f64) {
    let (mut best, mut found) = (0.0_f64, 0.0);
    for _ in 0..TURNS {
        let start = cpu();
        let halves = queries.split_at(queries.len() / 2);
        let sum = |half: &[DVec3]| half.iter().map(|query| search(*query)).sum::<f64>();
        found = std::thread::scope(|scope| {
            let other = scope.spawn(|| sum(halves.1));
            sum(halves.0) + other.join().unwrap()
        });
        best = best.max(2.0 * queries.len() as f64 / (cpu() - start));
    }
    (best, black_box(found))
}

fn main() {
    let points = photons(&cornell());
    println!("{} photons of {SENT} sent", points.len());
    let step = points.len() / SEARCHES;
    let queries: Vec<DVec3> = points.iter().step_by(step).copied().collect();
    let start = (cpu(), Instant::now());
    let arrays: Vec<[f64; 3]> = points.iter().map(DVec3::to_array).collect();
    let tree = ImmutableKdTree::<f64, 3>::new_from_slice(&arrays).unwrap();
    println!(
        "k-d tree built in {:.2} s of processor time",
        cpu() - start.0
    );
    println!(
        "| radius, m | photons found | grid, searches/s | k-d tree, searches/s | ratio | grid built, s |"
    );
    println!("|---|---|---|---|---|---|");
    for radius in [0.005, 0.01, 0.02, 0.04] {
        let start = cpu();
        let grid = Grid::new(points.clone(), radius, |p| *p);
        let built = cpu() - start;
        let square = radius * radius;
        let (by_grid, found) = rate(&queries, |query| {
            let mut n = 0.0;
            grid.near(query, |p| {
                n += f64::from(u8::from((*p - query).length_squared() < square));
            });
            n
        });
        let (by_tree, same) = rate(&queries, |query| {
            let place = query.to_array();
            let mut n = 0.0;
            let search = tree.query(&place).within::<SquaredEuclidean<f64>>(square);
            search
                .unsorted()
                .visit(|item| n += f64::from(u8::from(item.distance < square)));
            n
        });
        assert_eq!(found, same);
        let mean = found / queries.len() as f64;
        println!(
            "| {radius} | {mean:.0} | {by_grid:.0} | {by_tree:.0} | {:.1} | {built:.2} |",
            by_grid / by_tree
        );
    }
    for n in [12, 100, 500] {
        let n = NonZeroUsize::new(n).unwrap();
        let (by_tree, _) = rate(&queries, |query| {
            let place = query.to_array();
            let search = tree.query(&place).nearest_n::<SquaredEuclidean<f64>>(n);
            search.execute().last().map_or(0.0, |last| last.distance)
        });
        println!("{n} nearest by the k-d tree: {by_tree:.0} searches/s");
    }
}
