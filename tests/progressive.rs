//! Photon mapping in passes, planned memory, and kernels that are chosen place by place.
//!
//! Numbers such as C-41 are those of the list of tests in the design notes. The slope of the error itself is tested beside the code.

#![allow(clippy::unwrap_used, reason = "a test may panic")]

#[path = "support/room.rs"]
#[allow(dead_code, reason = "other tests use the rest")]
mod room;

use glam::{DAffine3, DVec3};
use room::{Room, at, gray, square};
use std::f64::consts::PI;
use std::sync::Mutex;
use understory::color::Rgb;
use understory::geometry::Shape;
use understory::integrator::{
    CancelToken, Integrator, Path, PhotonMapping, Progress, RadianceEstimator, RayCounts,
    RenderContext, RenderError,
};
use understory::material::Material;
use understory::math::{Ray, rng};
use understory::sampler::{Sampler, SamplerKind};
use understory::scene::Scene;

/// A floor before a wall, with a mirror ball that throws a caustic.
fn scene() -> Scene {
    let matt = || Material::lambert(gray(0.7));
    let lamp = Material::lambert(gray(0.0)).emitting(gray(300.0), Rgb::BLACK);
    let wall = at(-1.0, 0.0, 1.0) * DAffine3::from_rotation_y(PI / 2.0);
    Room::default()
        .with(square(1.0), DAffine3::IDENTITY, matt())
        .with(square(1.0), wall, matt())
        .with(
            Shape::Sphere { radius: 0.3 },
            at(0.1, 0.0, 0.3),
            Material::mirror(gray(0.9)),
        )
        .with(Shape::Sphere { radius: 0.1 }, at(0.6, 0.0, 1.6), lamp)
        .build()
}

fn method(photons: u64, passes: u32) -> PhotonMapping {
    PhotonMapping {
        global_photons: photons,
        caustic_photons: Some(photons),
        passes,
        ..PhotonMapping::default()
    }
}

fn prepared<'s>(
    method: &dyn Integrator,
    scene: &'s Scene,
    seed: u64,
) -> Box<dyn RadianceEstimator + 's> {
    let cancel = CancelToken::default();
    let context = RenderContext {
        seed,
        cancel: &cancel,
        progress: &|_| {},
    };
    method.prepare(scene, &context).unwrap()
}

/// Green radiance of the floor, which is matt, at 400 points beside the ball.
fn floor(estimator: &dyn RadianceEstimator, samples: u32) -> Vec<f64> {
    let look = |i: u32| {
        let (u, v) = (f64::from(i % 20) + 0.5, f64::from(i / 20) + 0.5);
        let from = DVec3::new(-0.95 + u * 0.035, -0.6 + v * 0.06, 0.2);
        let ray = Ray::new(from, DVec3::NEG_Z);
        let seen = |index| {
            let stream = rng::hash(&[u64::from(i)]);
            let mut sampler = Sampler::new(SamplerKind::OwenSobol, stream, index);
            estimator
                .incident_radiance(&ray, &mut sampler, &mut RayCounts::default())
                .g
        };
        (0..samples).map(seen).sum::<f64>() / f64::from(samples)
    };
    (0..400).map(look).collect()
}

/// Mean squared difference.
fn squared_error(found: &[f64], truth: &[f64]) -> f64 {
    let errors = found.iter().zip(truth).map(|(a, b)| (a - b) * (a - b));
    errors.sum::<f64>() / found.len() as f64
}

#[test]
fn c41_passes_come_nearer_to_the_truth_in_the_memory_of_one() {
    // Against very many other photons: direct light is sampled alike in all and cancels, and the path tracer meets this caustic too
    // rarely. The ratio scatters by about a third between seeds; 16^(-2/3) is 0.16. Passes that repeat the same photons have 0.5 and more.
    let scene = scene();
    let truth = floor(&*prepared(&method(400_000, 1), &scene, 77), 4);
    let few = |passes| PhotonMapping {
        // What one pass stores, with room for chance; that of all passes is 16 times as much.
        most_stored: 20_000,
        ..method(8000, passes)
    };
    let light = |passes| floor(&*prepared(&few(passes), &scene, 3), 4);
    let (one, many) = (light(1), light(16));
    let (before, after) = (squared_error(&one, &truth), squared_error(&many, &truth));
    assert!(after < 0.35 * before, "{after} {before}");
    // Nothing is lost or counted twice: the mean over the floor is the path tracer's to 3 %, of which its own noise is 1 %.
    let mean = |light: &[f64]| light.iter().sum::<f64>() / light.len() as f64;
    let path = mean(&floor(&*prepared(&Path::default(), &scene, 3), 128));
    let ratio = mean(&many) / path;
    assert!((ratio - 1.0).abs() < 0.03, "{ratio}");
}

#[test]
fn passes_are_the_same_on_any_number_of_threads_and_tell_how_far_they_are() {
    let scene = scene();
    let told = Mutex::new(Vec::new());
    let on = |n_threads| {
        let pool = rayon::ThreadPoolBuilder::new()
            .num_threads(n_threads)
            .build()
            .unwrap();
        pool.install(|| {
            let cancel = CancelToken::default();
            let progress = |p: Progress| told.lock().unwrap().push((p.done, p.total));
            let context = RenderContext {
                seed: 3,
                cancel: &cancel,
                progress: &progress,
            };
            let solution = method(6000, 3).solve(&scene, &context).unwrap();
            assert_eq!(solution.photons().unwrap().0, 2 * 3 * 6000);
            solution.to_bytes().unwrap()
        })
    };
    let one = on(1);
    let told = std::mem::take(&mut *told.lock().unwrap());
    assert!(
        told.iter()
            .all(|(done, total)| *total == 18_000 && done <= total)
    );
    assert!(told.contains(&(18_000, 18_000)) && told[0].0 < 18_000);
    assert!(one == on(2) && one == on(3));
}

#[test]
fn a_stopped_pass_ends_the_solution() {
    let scene = scene();
    let cancel = CancelToken::default();
    let progress = |p: Progress| {
        if p.done > p.total / 2 {
            cancel.cancel();
        }
    };
    let context = RenderContext {
        seed: 3,
        cancel: &cancel,
        progress: &progress,
    };
    let stopped = method(6000, 4).solve(&scene, &context).err();
    assert!(matches!(stopped, Some(RenderError::Cancelled { .. })));
}

#[test]
fn the_program_names_passes_where_memory_ends() {
    let folder = tempfile::tempdir().unwrap();
    let model = "protected void init() [ Axiom ==> \
        [ Translate(0, 0, 2) Rotate(-90, 0, 0) Parallelogram(1, 1).(setShader(WHITE), setLight(new AreaLight().(setPower(60)))) ] \
        [ Translate(0, 2, 0) Rotate(90, 0, 0) Parallelogram(4, 4) ] \
        [ Translate(0.4, 0, 0) Box(1, 0.5, 0.5) ]; ]\n";
    std::fs::write(folder.path().join("m.rgg"), model).unwrap();
    let run = |photons: &str, passes: &str| {
        let words = "render m.rgg -o a.png --steps 0 --size 16x16 --samples 1 --renderer photon --max-memory 30M";
        let mut command = std::process::Command::new(env!("CARGO_BIN_EXE_understory"));
        command.current_dir(folder.path()).args(words.split(' '));
        command.args([
            "--global-photons",
            photons,
            "--passes",
            passes,
            "--report",
            "r.json",
        ]);
        let done = command.output().unwrap();
        (
            done.status.code(),
            String::from_utf8_lossy(&done.stderr).into_owned(),
        )
    };
    let (code, text) = run("100000000", "1");
    assert_eq!(code, Some(3), "{text}");
    assert!(
        text.contains("--passes") && text.contains("--max-memory"),
        "{text}"
    );
    assert!(!folder.path().join("a.png").exists());
    let (code, text) = run("20000", "5");
    assert_eq!(code, Some(0), "{text}");
    let report = std::fs::read(folder.path().join("r.json")).unwrap();
    let report: serde_json::Value = serde_json::from_slice(&report).unwrap();
    assert_eq!(
        (&report["photons_emitted"], &report["solves"]),
        (&100_000.into(), &1.into())
    );
}
