//! Filling a film: the reported error, and refinement. Threads, passes and cancellation: C-59 and C-64 of `tests/validation.rs`.

#![allow(clippy::unwrap_used, reason = "a test may panic")]

#[path = "support/room.rs"]
#[allow(dead_code, reason = "other tests use the rest")]
mod room;

use glam::{DVec2, DVec3};
use room::shaded_ground;
use std::ops::ControlFlow;
use understory::camera::{Camera, Lens, View};
use understory::color::Rgb;
use understory::film::Filter;
use understory::integrator::driver::{FilmResult, FilmSettings, Refinement, render_view};
use understory::integrator::{
    CancelToken, Integrator, Path, RadianceEstimator, RayCounts, RenderContext, RenderError,
};
use understory::math::Ray;
use understory::math::angle::Angle;
use understory::sampler::{Sampler, SamplerKind};

fn picture(threads: usize, seed: u64, samples: u32) -> Result<FilmResult, RenderError> {
    let scene = shaded_ground();
    let view = View {
        eye: DVec3::new(0.0, -6.0, 2.0),
        target: DVec3::new(0.0, 0.0, 0.5),
        up: DVec3::Z,
        fov: Angle::deg(40.0),
    };
    let camera = Camera::perspective(&view, 1.5).unwrap();
    let cancel = CancelToken::default();
    let context = RenderContext {
        seed,
        cancel: &cancel,
        progress: &|_| {},
    };
    let settings = FilmSettings {
        width: 51,
        height: 34,
        samples_per_pixel: samples,
        filter: Filter::Box,
        sampler: SamplerKind::OwenSobol,
        refinement: Refinement::Everywhere,
    };
    let estimator = Path::default().prepare(&scene, &context).unwrap();
    let pool = rayon::ThreadPoolBuilder::new()
        .num_threads(threads)
        .build()
        .unwrap();
    pool.install(|| {
        let mut go_on = |_: &FilmResult| ControlFlow::Continue(());
        render_view(&*estimator, &camera, &settings, &context, &mut go_on)
    })
}

#[test]
fn the_reported_error_is_the_error() {
    let reference = picture(2, 5, 512).unwrap().film.image();
    let rough = picture(2, 6, 16).unwrap();
    let image = rough.film.image();
    let mean =
        reference.pixels.iter().map(|p| p.luminance()).sum::<f64>() / image.pixels.len() as f64;
    let squared: f64 = image
        .pixels
        .iter()
        .zip(&reference.pixels)
        .map(|(a, b)| {
            let (a, b) = (a.luminance(), b.luminance());
            (a - b).powi(2) / (b * b + 0.01 * mean * mean)
        })
        .sum();
    let truth = (squared / image.pixels.len() as f64).sqrt();
    let estimate = rough.report.error.unwrap();
    let ratio = estimate.relative / truth;
    assert!(
        (0.8..1.25).contains(&ratio),
        "estimated {estimate:?}, true {truth}"
    );
    assert_eq!(rough.report.n_rejected, 0);
    assert!(rough.report.rays.total() > rough.film.n_samples());
}

/// The plane y = 2, white where x > 0.
struct Edge;

impl RadianceEstimator for Edge {
    fn incident_radiance(&self, ray: &Ray, _: &mut Sampler, _: &mut RayCounts) -> Rgb {
        let at = ray.origin + ray.direction * ((2.0 - ray.origin.y) / ray.direction.y);
        if at.x > 0.0 { Rgb::WHITE } else { Rgb::BLACK }
    }
}

/// Columns of the pictures of the edge, which show 4 m of it.
const COLUMNS: u32 = 200;

/// A camera at x, with the edge before it.
fn before_the_edge(x: f64) -> Camera {
    let view = View {
        eye: DVec3::new(x, 0.0, 0.0),
        target: DVec3::new(x, 1.0, 0.0),
        up: DVec3::Z,
        fov: Angle::deg(90.0),
    };
    Camera::perspective(&view, 1.0).unwrap()
}

/// The brightness of each column, with where its middle lies on the edge's plane.
fn profile(camera: &Camera) -> Vec<(f64, f64)> {
    let cancel = CancelToken::default();
    let context = RenderContext {
        seed: 3,
        cancel: &cancel,
        progress: &|_| {},
    };
    let settings = FilmSettings {
        width: COLUMNS,
        height: 2,
        samples_per_pixel: 256,
        filter: Filter::Box,
        sampler: SamplerKind::OwenSobol,
        refinement: Refinement::Everywhere,
    };
    let mut go_on = |_: &FilmResult| ControlFlow::Continue(());
    let film = render_view(&Edge, camera, &settings, &context, &mut go_on)
        .unwrap()
        .film;
    let column = |x: u32| 0.5 * (film.pixel(x, 0).mean().g + film.pixel(x, 1).mean().g);
    let place = |x: u32| 4.0 * ((f64::from(x) + 0.5) / f64::from(COLUMNS) - 0.5);
    (0..COLUMNS).map(|x| (place(x), column(x))).collect()
}

/// 512 well-spread samples a column: off by less than 0.02; a lens of twice the width, or samples that all share a point of the
/// lens or a moment, are off by more than 0.1 somewhere.
#[test]
fn edges_out_of_focus_and_in_motion_have_the_profile_of_the_closed_form() {
    let sharp = profile(&before_the_edge(0.0));
    assert!(sharp.iter().all(|(x, level)| *level == f64::from(*x > 0.0)));

    // A lens of 0.4 m, sharp at 1 m: a disk of 0.4 m at 2 m, of which the part beyond x is white.
    let lens = Lens {
        diameter: 0.4,
        focus: 1.0,
    };
    for (x, level) in profile(&before_the_edge(0.0).with_lens(lens)) {
        let s = (x / 0.2).clamp(-1.0, 1.0);
        let expected = 0.5 + (s * (1.0 - s * s).sqrt() + s.asin()) / std::f64::consts::PI;
        assert!((level - expected).abs() < 0.02, "{x}: {level} {expected}");
    }

    // The camera moves by 0.4 m while the shutter is open.
    let moving = before_the_edge(0.0).moving_through(&[before_the_edge(0.2), before_the_edge(0.4)]);
    for (x, level) in profile(&moving) {
        let expected = (1.0 + x / 0.4).clamp(0.0, 1.0);
        assert!((level - expected).abs() < 0.02, "{x}: {level} {expected}");
    }

    // Both at once are drawn independently: rays differ in both.
    let both = moving.with_lens(lens);
    let film = DVec2::splat(0.5);
    assert_ne!(
        both.ray_through(film, film, 0.0).origin,
        both.ray_through(film, film, 1.0).origin
    );
}
