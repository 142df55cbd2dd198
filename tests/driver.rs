//! Filling a film: the same bytes for any number of threads and passes, cancellation, and the reported error.

#![allow(clippy::unwrap_used, reason = "a test may panic")]

#[path = "support/room.rs"]
#[allow(dead_code, reason = "other tests use the rest")]
mod room;

use glam::DVec3;
use room::shaded_ground;
use std::ops::ControlFlow;
use understory::camera::{Camera, View};
use understory::film::Filter;
use understory::integrator::driver::{FilmResult, FilmSettings, Refinement, render_view};
use understory::integrator::{CancelToken, Integrator, Path, RenderContext, RenderError};
use understory::math::angle::Angle;
use understory::sampler::SamplerKind;

fn picture(
    threads: usize,
    seed: u64,
    samples: u32,
    on_pass: &mut (dyn FnMut(&FilmResult) -> ControlFlow<()> + Send),
) -> Result<FilmResult, RenderError> {
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
        let mut stop_token = |result: &FilmResult| {
            let answer = on_pass(result);
            if seed == STOPPED_SEED {
                cancel.cancel();
            }
            answer
        };
        render_view(&*estimator, &camera, &settings, &context, &mut stop_token)
    })
}

/// With this seed `picture` is cancelled after its first pass.
const STOPPED_SEED: u64 = 999;

/// C-59, C-64: on any number of threads, and as far as it was made.
#[test]
fn bytes_do_not_depend_on_threads_or_passes() {
    let mut go_on = |_: &FilmResult| ControlFlow::Continue(());
    let one = picture(1, 3, 7, &mut go_on).unwrap();
    for threads in [2, 3, 7, 16] {
        assert_eq!(picture(threads, 3, 7, &mut go_on).unwrap(), one);
    }
    assert_ne!(picture(2, 4, 7, &mut go_on).unwrap().film, one.film);

    // Stopped after four samples, or never meant to have more: the same picture.
    let mut stop = |result: &FilmResult| {
        if result.report.samples_per_pixel >= 4 {
            ControlFlow::Break(())
        } else {
            ControlFlow::Continue(())
        }
    };
    let stopped = picture(2, 3, 7, &mut stop).unwrap();
    assert_eq!(stopped, picture(1, 3, 4, &mut go_on).unwrap());
    assert_eq!(stopped.film.n_samples(), 51 * 34 * 4);
}

/// C-64: what was cancelled holds whole samples, and nothing of it is left when the picture is made anew.
#[test]
fn cancelling_keeps_what_is_finished() {
    let mut passes = 0;
    let result = picture(2, STOPPED_SEED, 64, &mut |_| {
        passes += 1;
        ControlFlow::Continue(())
    });
    let Err(RenderError::Cancelled {
        partial: Some(partial),
    }) = result
    else {
        panic!("expected a cancelled render with a picture")
    };
    assert_eq!(passes, 1);
    assert!(partial.film.n_samples() >= 51 * 34);
}

#[test]
fn the_reported_error_is_the_error() {
    let mut go_on = |_: &FilmResult| ControlFlow::Continue(());
    let reference = picture(2, 5, 512, &mut go_on).unwrap().film.image();
    let rough = picture(2, 6, 16, &mut go_on).unwrap();
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
