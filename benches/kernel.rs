//! Rays per second of the tracing core, beside Embree where that is installed (Debian: `libembree-dev`).
//!
//! `cargo bench --bench kernel`, or with part of a scene's name after `--`. Both programs get the same rays in turns; the best of several
//! turns counts. Rates are those of two threads: rays, divided by half of the processor time that both threads used
//! together, so that other work on the machine counts as little as possible.
#![allow(clippy::print_stdout, reason = "a benchmark prints its result")]

#[path = "support/embree.rs"]
mod embree;
#[path = "support/trees.rs"]
mod trees;
#[path = "../tests/support/worlds.rs"]
mod worlds;

use embree::{Embree, Server};
use glam::DVec3;
use rustix::time::{ClockId, clock_gettime};
use std::sync::atomic::{AtomicUsize, Ordering};
use std::time::Instant;
use trees::{Parts, big_tree, cornell, forest};
use understory::math::Ray;
use understory::scene::description::Group;
use understory::scene::{Scene, SurfacePoint};
use worlds::{Random, describe};

/// Pixels along one side of the picture whose rays are measured.
const SIDE: usize = 512;
/// Threads that send rays.
const THREADS: usize = 2;
/// Turns of each program.
const TURNS: usize = 4;
/// Rays that a thread takes at once.
const CHUNK: usize = 256;
/// Where rays from surfaces begin to count, in metres: Embree's coordinates have seven digits.
const NEAREST: f64 = 1e-3;

/// A name, the world, and the views of it: from where, at what.
type Case = (String, Box<dyn Fn() -> Vec<Group>>, Vec<(DVec3, DVec3)>);

fn main() {
    let wanted: Vec<String> = std::env::args()
        .skip(1)
        .filter(|word| !word.starts_with('-'))
        .collect();
    let is_wanted = |name: &str| wanted.is_empty() || wanted.iter().any(|part| name.contains(part));
    let embree = Embree::new()
        .inspect_err(|problem| println!("without Embree: {problem}"))
        .ok();

    println!(
        "| scene | rays | million rays/s | Embree | ratio | Embree's packets | same t | hits |"
    );
    println!("|---|---|---|---|---|---|---|---|");
    let above = |half: f64| (DVec3::new(-half, -half, 35.0), DVec3::ZERO);
    let inside = (DVec3::new(1.0, 1.0, 1.7), DVec3::new(9.0, 9.0, 4.0));
    let mut cases: Vec<Case> = vec![
        (
            "tree of a million triangles".into(),
            Box::new(big_tree),
            vec![(DVec3::new(0.0, -22.0, 9.0), DVec3::Z * 7.0)],
        ),
        (
            "Cornell box".into(),
            Box::new(cornell),
            vec![(DVec3::new(2.78, -8.0, 2.73), DVec3::new(2.78, 2.8, 2.73))],
        ),
        (
            "2000 trees of frusta and parallelograms".into(),
            Box::new(|| forest(Parts::Solids, 2000)),
            vec![above(75.0), inside],
        ),
        (
            "2000 trees of triangles".into(),
            Box::new(|| forest(Parts::Triangles, 2000)),
            vec![above(75.0), inside],
        ),
    ];
    for exponent in 0..=6 {
        let count = 10_u32.pow(exponent);
        cases.push((
            format!("curve, {count} trees"),
            Box::new(move || forest(Parts::Triangles, count)),
            vec![above(50.0), inside],
        ));
    }
    for (name, groups, views) in cases.iter().filter(|case| is_wanted(&case.0)) {
        measure(name, groups(), views, embree.as_ref());
    }
}

/// Builds the groups and measures, for each view, camera rays, bounces off what they hit, and rays to the sun from there.
fn measure(name: &str, groups: Vec<Group>, views: &[(DVec3, DVec3)], embree: Option<&Embree>) {
    let mut server = embree.and_then(|embree| {
        let server = embree.start(&groups);
        server
            .inspect_err(|problem| println!("Embree fails: {problem}"))
            .ok()
    });
    let start = Instant::now();
    let scene = Scene::build(describe(groups)).expect("the scene is valid");
    let build = start.elapsed().as_secs_f64();
    for (view, (eye, target)) in views.iter().enumerate() {
        let name = match (views.len(), view) {
            (1, _) => name.to_owned(),
            (_, 0) => format!("{name}, from above"),
            _ => format!("{name}, from inside"),
        };
        let [camera, bounces, shadows] = rays(&scene, *eye, *target);
        compare(&scene, server.as_mut(), &name, "camera", &camera);
        compare(&scene, server.as_mut(), &name, "bounce", &bounces);
        compare(&scene, server.as_mut(), &name, "sun", &shadows);
    }
    let stats = scene.stats();
    let mut line = format!(
        "{name}: built in {build:.2} s, {:.1} MB",
        stats.bytes as f64 / 1e6
    );
    if let Some(bytes) = stats.instance_bytes.checked_div(stats.instances) {
        line += &format!(", {bytes} bytes per instance");
    }
    if let Some(server) = server {
        line += &format!(
            "; Embree {:.2} s, {:.1} MB",
            server.build,
            server.bytes / 1e6
        );
    }
    println!("{line}");
}

/// Rays from the camera, bounces off what they meet, and rays to the sun from there.
fn rays(scene: &Scene, eye: DVec3, target: DVec3) -> [Vec<Ray>; 3] {
    let camera = camera_rays(eye, target);
    let hits = camera
        .iter()
        .filter_map(|ray| scene.closest(ray).map(|hit| scene.surface(ray, &hit)));
    let points: Vec<SurfacePoint> = hits.collect();
    let spawn = |point: &SurfacePoint, direction: DVec3| Ray {
        t_min: NEAREST,
        ..point.spawn_ray(direction)
    };
    let mut random = Random(1);
    let mut bounce = |point: &SurfacePoint| {
        let side = if point.is_front { 1.0 } else { -1.0 };
        (point.normal_g * side + random.direction() * 0.999).normalize()
    };
    let sun = DVec3::new(0.4, -0.3, 0.87).normalize();
    let bounces = points.iter().map(|point| spawn(point, bounce(point)));
    let bounces = bounces.collect();
    let shadows = points.iter().map(|point| spawn(point, sun)).collect();
    [camera, bounces, shadows]
}

/// Prints the rates of both programs for some rays; those to the sun ask only whether there is anything.
fn compare(
    scene: &Scene,
    mut server: Option<&mut Server>,
    scene_name: &str,
    name: &str,
    rays: &[Ray],
) {
    let is_any = name == "sun";
    let question = if is_any { "any" } else { "closest" };
    if let Some(server) = server.as_mut() {
        server.rays(rays).expect("Embree takes rays");
    }
    let mut best = [f64::INFINITY; 3];
    let mut hits = 0;
    for _ in 0..TURNS {
        let (seconds, count) = if is_any {
            run(rays, |ray| scene.occluded(ray))
        } else {
            run(rays, |ray| scene.closest(ray).is_some())
        };
        (best[0], hits) = (best[0].min(seconds), count);
        if let Some(server) = server.as_mut() {
            let mut ask = |question| server.ask(question, THREADS).expect("Embree answers").0;
            best[1] = best[1].min(ask(question));
            if name == "camera" {
                best[2] = best[2].min(ask("packets"));
            }
        }
    }
    let rate = |seconds: f64| rays.len() as f64 * THREADS as f64 / seconds / 1e6;
    let share = 100.0 * hits as f64 / rays.len().max(1) as f64;
    let same = server.map(|server| {
        if is_any {
            let (_, count) = server.ask("any", 1).expect("Embree answers");
            100.0 - 100.0 * (count - hits as f64).abs() / rays.len().max(1) as f64
        } else {
            agreement(scene, server, rays)
        }
    });
    print!("| {scene_name} | {name} | {:.2} | ", rate(best[0]));
    if let Some(same) = same {
        print!("{:.2} | {:.2} | ", rate(best[1]), best[1] / best[0]);
        if best[2].is_finite() {
            print!("{:.2}", rate(best[2]));
        }
        print!(" | {same:.2} % | ");
    } else {
        print!(" | | | | ");
    }
    println!("{share:.0} % |");
}

/// How many rays in a hundred find a hit at the same distance, or none, in both programs.
fn agreement(scene: &Scene, server: &mut Server, rays: &[Ray]) -> f64 {
    let theirs = server.distances().expect("Embree answers");
    let same = rays.iter().zip(theirs).filter(|(ray, theirs)| {
        let theirs = f64::from(*theirs);
        match scene.closest(ray) {
            Some(hit) => (hit.t - theirs).abs() <= 2e-3 + 1e-4 * hit.t,
            None => theirs.is_infinite(),
        }
    });
    100.0 * same.count() as f64 / rays.len().max(1) as f64
}

/// Asks all rays with two threads: the processor seconds of both together, and how many answers are yes.
fn run(rays: &[Ray], query: impl Fn(&Ray) -> bool + Sync) -> (f64, usize) {
    let next = AtomicUsize::new(0);
    let work = || {
        let start = thread_seconds();
        let mut count = 0;
        loop {
            let from = next.fetch_add(CHUNK, Ordering::Relaxed);
            let Some(rays) = rays.get(from..) else { break };
            if rays.is_empty() {
                break;
            }
            let chunk = &rays[..rays.len().min(CHUNK)];
            count += chunk.iter().filter(|ray| query(ray)).count();
        }
        (thread_seconds() - start, count)
    };
    std::thread::scope(|scope| {
        let threads: Vec<_> = (0..THREADS).map(|_| scope.spawn(work)).collect();
        threads.into_iter().fold((0.0, 0), |sum, thread| {
            let (seconds, count) = thread.join().expect("the threads end");
            (sum.0 + seconds, sum.1 + count)
        })
    })
}

/// Processor time of this thread, in seconds.
fn thread_seconds() -> f64 {
    let time = clock_gettime(ClockId::ThreadCPUTime);
    time.tv_sec as f64 + time.tv_nsec as f64 * 1e-9
}

/// Rays through the pixels in blocks of 8 × 8.
fn camera_rays(eye: DVec3, target: DVec3) -> Vec<Ray> {
    let forward = (target - eye).normalize();
    let right = forward.cross(DVec3::Z).normalize();
    let up = right.cross(forward);
    let blocks = SIDE / 8;
    (0..SIDE * SIDE)
        .map(|index| {
            let (block, within) = (index / 64, index % 64);
            let x = (block % blocks * 8 + within % 8) as f64 + 0.5;
            let y = (block / blocks * 8 + within / 8) as f64 + 0.5;
            let (x, y) = (x / SIDE as f64 - 0.5, 0.5 - y / SIDE as f64);
            Ray::new(eye, (forward + (right * x + up * y) * 0.8).normalize())
        })
        .collect()
}
