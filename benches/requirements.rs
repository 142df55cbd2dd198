//! What is saved by leaving out what a scene does not require: each feature left out and kept, in turns, in one run.
//!
//! `cargo bench --bench requirements`, or with `-- only=groups,coordinates` some of them. Times are of processor time of all threads, the
//! best of several turns; the ratio is what counts. Pictures of both are the same (`tests/requirements.rs`).
#![allow(clippy::print_stdout, reason = "a benchmark prints its result")]
#![allow(clippy::unwrap_used, reason = "a benchmark may panic")]

#[path = "../tests/support/grouped.rs"]
#[allow(dead_code, reason = "tests use the rest")]
mod grouped;
#[path = "../tests/support/room.rs"]
#[allow(dead_code, reason = "tests use the rest")]
mod room;
#[path = "../tests/support/spared.rs"]
mod spared;

use glam::DVec3;
use rayon::prelude::*;
use rustix::time::{ClockId, clock_gettime};
use std::hint::black_box;
use understory::integrator::requirements::{Feature, Features, Requirements, State};
use understory::integrator::{
    CancelToken, Method, Path, PhotonMapping, Radiosity, RayCounts, Raytracer, RenderContext,
};
use understory::math::{Ray, rng};
use understory::sampler::{Sampler, SamplerKind};
use understory::scene::Scene;
use understory::scene::description::Extras;

/// Turns of each.
const TURNS: usize = 5;
/// Rays of a picture along each side.
const SIDE: u32 = 96;

/// A feature, the scene that spares it, the renderer, and samples of each ray.
const CASES: [(Feature, &str, &str, u32); 19] = [
    (Feature::Bounces, "black", "path", 32),
    (Feature::Bounces, "black", "photon", 1),
    (Feature::Bounces, "night", "radiosity", 1),
    (Feature::Caustics, "lamp", "photon", 1),
    (Feature::UnaimedPhotons, "mirror", "photon", 0),
    (Feature::Guide, "panel", "path", 16),
    (Feature::LightChoice, "lamp", "path", 16),
    (Feature::LightChoice, "panel", "path", 16),
    (Feature::LightHits, "lamp", "path", 16),
    (Feature::Bodies, "panel", "path", 16),
    (Feature::Bodies, "glass", "path", 16),
    (Feature::ClearShadows, "balls", "raytracer", 16),
    (Feature::ClearShadows, "day", "raytracer", 16),
    (Feature::UnaskedLight, "panel", "radiosity", 1),
    (Feature::Insides, "balls", "radiosity", 1),
    (Feature::Coordinates, "balls", "path", 16),
    (Feature::Coordinates, "balls", "raytracer", 16),
    (Feature::Groups, "twigs", "path", 16),
    (Feature::Groups, "twigs", "raytracer", 16),
];

fn renderer(name: &str, kept: Features) -> Method {
    match name {
        "path" => Method::Path(Path {
            kept,
            ..Path::default()
        }),
        "raytracer" => Method::Raytracer(Raytracer {
            kept,
            ..Raytracer::default()
        }),
        "photon" => Method::Photon(PhotonMapping {
            global_photons: 300_000,
            caustic_photons: Some(300_000),
            kept,
            ..PhotonMapping::default()
        }),
        "radiosity" => Method::Radiosity(Radiosity {
            kept,
            ..Radiosity::default()
        }),
        other => panic!("{other} is no renderer"),
    }
}

/// Seconds of processor time of this process.
fn cpu() -> f64 {
    let time = clock_gettime(ClockId::ProcessCPUTime);
    time.tv_sec as f64 + time.tv_nsec as f64 * 1e-9
}

/// Solves a scene and looks at it; gives by how many photons were stored, where only they matter.
fn work(scene: &Scene, method: &Method, samples: u32) -> f64 {
    let cancel = CancelToken::default();
    let context = RenderContext {
        seed: 1,
        cancel: &cancel,
        progress: &|_| {},
    };
    let integrator = method.integrator();
    if samples == 0 {
        let solution = integrator.solve(scene, &context).unwrap();
        return solution.photons().map_or(1.0, |(_, stored)| stored as f64);
    }
    let estimator = integrator.prepare(scene, &context).unwrap();
    let sum: f64 = (0..SIDE * SIDE)
        .into_par_iter()
        .map(|k| {
            let across = |i: u32| (f64::from(i) + 0.5) / f64::from(SIDE) * 2.0 - 1.0;
            let eye = DVec3::new(0.0, -4.0, 1.1);
            let to = DVec3::new(across(k % SIDE), -0.9, 1.0 + across(k / SIDE));
            let ray = Ray::new(eye, (to - eye).normalize());
            let sample = |index| {
                let mut sampler =
                    Sampler::new(SamplerKind::OwenSobol, rng::hash(&[u64::from(k)]), index);
                let mut rays = RayCounts::default();
                estimator.incident_radiance(&ray, &mut sampler, &mut rays).g
            };
            (0..samples).map(sample).sum::<f64>()
        })
        .sum();
    black_box(sum);
    1.0
}

/// A scene by its name, with a feature that scenes are built with kept, if it is one.
fn scene(what: &str, kept: Features) -> Scene {
    match what {
        "twigs" => grouped::twigs(kept.contains(Feature::Groups)),
        "balls" => {
            let extras = Extras {
                coordinates: kept.contains(Feature::Coordinates),
                ..Extras::default()
            };
            spared::balls().with_extras(extras).build()
        }
        _ => {
            let mut scenes = spared::scenes().into_iter();
            scenes.find(|(known, _)| *known == what).unwrap().1
        }
    }
}

/// Whether a case is among those asked for, or none is.
fn is_wanted(feature: Feature) -> bool {
    let only = std::env::args().find_map(|arg| Some(arg.strip_prefix("only=")?.to_owned()));
    only.is_none_or(|only| only.split(',').any(|name| name == feature.name()))
}

fn main() {
    println!("| left out | scene | renderer | why | without, s | with, s | saves |");
    println!("|---|---|---|---|---|---|---|");
    for (feature, what, name, samples) in CASES.into_iter().filter(|case| is_wanted(case.0)) {
        let kept = [Features::NONE, Features::NONE.with(feature)];
        let scenes = kept.map(|kept| scene(what, kept));
        let found = Requirements::of(&scenes[0], Features::NONE);
        let found = found
            .findings()
            .iter()
            .find(|found| found.feature == feature);
        let found = found.unwrap();
        assert_eq!(found.state, State::LeftOut, "{} in {what}", feature.name());
        // Photons that are aimed compare by the work for each that arrives; the map of all light is left out.
        let own = |kept: Features| match renderer(name, kept) {
            Method::Photon(photon) if samples == 0 => Method::Photon(PhotonMapping {
                global_photons: 0,
                ..photon
            }),
            method => method,
        };
        let methods = kept.map(own);
        let mut best = [f64::INFINITY; 2];
        for _ in 0..TURNS {
            for (at, best) in best.iter_mut().enumerate() {
                let start = cpu();
                let n = work(&scenes[at], &methods[at], samples);
                let scale = if samples == 0 { 100_000.0 } else { 1.0 };
                *best = best.min((cpu() - start) * scale / n);
            }
        }
        let saved = 100.0 * (1.0 - best[0] / best[1]);
        println!(
            "| `{}` | {what} | {name} | {} | {:.3} | {:.3} | {saved:.0} % |",
            feature.name(),
            found.why,
            best[0],
            best[1]
        );
    }
}
