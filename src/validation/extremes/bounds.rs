//! Threads, stopping and going on, what is kept as bytes, and memory: C-59, C-61, C-64, C-65.

use super::super::check::{Check, Setting, Trouble};
use super::super::room::{Room, at, gray, square};
use super::looks::{around, coarse, differing, maps, seen, world};
use super::{Row, checks_of};
use crate::camera::{Camera, View};
use crate::color::Rgb;
use crate::film::Filter;
use crate::geometry::Shape;
use crate::integrator::driver::{FilmResult, FilmSettings, Refinement, render_view};
use crate::integrator::photon::{Aim, BLOCK, Emission, Onward, PhotonHit, Photons, Visitor, trace};
use crate::integrator::radiosity::Solver;
use crate::integrator::{
    CancelToken, Integrator, Path, PhotonMapping, Progress, Radiosity, RenderContext, RenderError,
    Solution,
};
use crate::light::Light;
use crate::material::Material;
use crate::math::angle::Angle;
use crate::sampler::SamplerKind;
use crate::scene::Scene;
use glam::DVec3;
use std::ops::ControlFlow;

/// Numbers of threads.
const THREADS: [usize; 5] = [1, 2, 3, 7, 16];

/// The checks: counts of faults, of which there must be none.
pub(super) fn checks() -> Vec<Check> {
    checks_of(ROWS)
}

/// Those that no setting changes.
const ROWS: [Row; 14] = [
    (
        "59",
        "C-59-picture",
        "51 × 34 pixels by paths on 1, 2, 3, 7 and 16 threads: films that are not the same to the bit",
        (0.0, 0.0),
        |setting| differing_on_threads(|| film(setting, 7, &mut |_| ControlFlow::Continue(()))),
    ),
    (
        "59",
        "C-59-photons",
        "20,000 photons on as many threads: maps that are not the same bytes",
        (0.0, 0.0),
        |setting| differing_on_threads(|| bytes_of(&maps(20_000, 20_000, None), setting)),
    ),
    (
        "59",
        "C-59-radiosity",
        "radiosity, gathered, on as many threads: solutions that are not the same bytes",
        (0.0, 0.0),
        |setting| differing_on_threads(|| bytes_of(&coarse(), setting)),
    ),
    (
        "59",
        "C-59-stochastic",
        "radiosity, stochastic, on as many threads: solutions that are not the same bytes",
        (0.0, 0.0),
        |setting| differing_on_threads(|| bytes_of(&stochastic(), setting)),
    ),
    (
        "59",
        "C-59-blocks",
        "photons in two parts, cut at a block: arrivals that are not the same as in one",
        (0.0, 0.0),
        in_two_parts,
    ),
    (
        "61",
        "C-61-photons",
        "a photon map, written and read: pixels that are not the same to the bit as without",
        (0.0, 0.0),
        |setting| read_back(&maps(20_000, 20_000, None), setting),
    ),
    (
        "61",
        "C-61-radiosity",
        "radiosity, written and read: pixels that are not the same to the bit as without",
        (0.0, 0.0),
        |setting| read_back(&coarse(), setting),
    ),
    (
        "61",
        "C-61-cut-short",
        "both, cut short in 200 places each and with 200 bits flipped: read although cut, or looked at with a panic",
        (0.0, 0.0),
        damaged,
    ),
    (
        "64",
        "C-64-passes",
        "a picture ended after 1, 2, 4 and 8 samples, and one of so many: films that are not the same to the bit",
        (0.0, 0.0),
        ended_early,
    ),
    (
        "64",
        "C-64-cancelled",
        "a picture cancelled after its first pass: no partial picture, or one without a sample for each pixel",
        (0.0, 0.0),
        cancelled_picture,
    ),
    (
        "64",
        "C-64-solutions",
        "photon maps and radiosity, cancelled at ten moments: neither told nor whole, never told, or different when made anew",
        (0.0, 0.0),
        cancelled_solutions,
    ),
    (
        "65",
        "C-65-photons",
        "50,000 photons where 1000 may be stored: not refused",
        (0.0, 0.0),
        |setting| {
            let few = PhotonMapping {
                most_stored: 1000,
                ..maps(50_000, 0, None)
            };
            let refused = few.solve(&world(1.0, DVec3::ZERO)?, &setting.context());
            Ok(f64::from(!matches!(
                refused,
                Err(RenderError::TooManyPhotons { most: 1000, .. })
            )))
        },
    ),
    (
        "65",
        "C-65-patches",
        "a world of 97 faces in 4 KiB: not refused",
        (0.0, 0.0),
        |setting| {
            let small = Radiosity {
                memory: 4096,
                ..coarse()
            };
            let refused = small.solve(&world(1.0, DVec3::ZERO)?, &setting.context());
            Ok(f64::from(!matches!(
                refused,
                Err(RenderError::TooManyPatches { .. })
            )))
        },
    ),
    (
        "65",
        "C-65-factors",
        "a floor and a wall of 200 patches with rows of 262,144 rays in 256 KiB, gathered: not refused",
        (0.0, 0.0),
        |setting| {
            let greedy = Radiosity {
                solver: Some(Solver::Gather),
                hemicube_pixels: 1024,
                memory: 256 << 10,
                ..coarse()
            };
            let scene = Room::default()
                .with(square(1.0), at(0., 0., 0.), Material::lambert(gray(0.5)))
                .with(square(1.0), at(0., 0., 1.), Material::lambert(gray(0.5)))
                .lit_by(Light::point(DVec3::Z * 0.5, gray(1.0)))
                .scene()?;
            let refused = greedy.solve(&scene, &setting.context());
            Ok(f64::from(!matches!(
                refused,
                Err(RenderError::TooManyFactors { .. })
            )))
        },
    ),
];

/// On how many numbers of threads something is not what it is on one.
pub(super) fn differing_on_threads<T: PartialEq + Send>(
    make: impl Fn() -> Result<T, Trouble> + Sync,
) -> Result<f64, Trouble> {
    let on = |n: usize| {
        let pool = rayon::ThreadPoolBuilder::new().num_threads(n).build()?;
        pool.install(&make)
    };
    let one = on(1)?;
    let mut n = 0;
    for threads in &THREADS[1..] {
        n += u32::from(on(*threads)? != one);
    }
    Ok(f64::from(n))
}

/// Radiosity by random shots.
fn stochastic() -> Radiosity {
    Radiosity {
        solver: Some(Solver::Stochastic),
        ..coarse()
    }
}

/// The film of the world, of so many samples a pixel.
fn film_with(
    context: &RenderContext<'_>,
    samples_per_pixel: u32,
    on_pass: &mut dyn FnMut(&FilmResult) -> ControlFlow<()>,
) -> Result<Result<FilmResult, RenderError>, Trouble> {
    let scene = world(1.0, DVec3::ZERO)?;
    let view = View {
        eye: DVec3::new(0.5, -4.0, 2.5),
        target: DVec3::new(0.0, 0.0, 0.4),
        up: DVec3::Z,
        fov: Angle::deg(50.0),
    };
    let camera = Camera::perspective(&view, 1.5)?;
    let settings = FilmSettings {
        width: 51,
        height: 34,
        samples_per_pixel,
        filter: Filter::Box,
        sampler: SamplerKind::OwenSobol,
        refinement: Refinement::Everywhere,
    };
    let estimator = Path::default().prepare(&scene, context)?;
    Ok(render_view(
        &*estimator,
        &camera,
        &settings,
        context,
        on_pass,
    ))
}

fn film(
    setting: &Setting<'_>,
    samples: u32,
    on_pass: &mut dyn FnMut(&FilmResult) -> ControlFlow<()>,
) -> Result<FilmResult, Trouble> {
    Ok(film_with(&setting.context(), samples, on_pass)??)
}

fn ended_early(setting: &Setting<'_>) -> Result<f64, Trouble> {
    let mut n = 0;
    for samples in [1, 2, 4, 8] {
        let mut stop = |result: &FilmResult| {
            if result.report.samples_per_pixel >= samples {
                ControlFlow::Break(())
            } else {
                ControlFlow::Continue(())
            }
        };
        let stopped = film(setting, 13, &mut stop)?;
        let whole = film(setting, samples, &mut |_| ControlFlow::Continue(()))?;
        n += u32::from(stopped != whole);
    }
    Ok(f64::from(n))
}

fn cancelled_picture(setting: &Setting<'_>) -> Result<f64, Trouble> {
    let cancel = CancelToken::default();
    let context = RenderContext {
        cancel: &cancel,
        ..setting.context()
    };
    let mut stop = |_: &FilmResult| {
        cancel.cancel();
        ControlFlow::Continue(())
    };
    let is_right = match film_with(&context, 64, &mut stop)? {
        Err(RenderError::Cancelled {
            partial: Some(partial),
        }) => partial.film.n_samples() >= 51 * 34,
        _ => false,
    };
    Ok(f64::from(!is_right))
}

fn bytes_of(method: &dyn Integrator, setting: &Setting<'_>) -> Result<Vec<u8>, Trouble> {
    let solution = method.solve(&world(1.0, DVec3::ZERO)?, &setting.context())?;
    let bytes = solution.to_bytes();
    bytes.ok_or_else(|| Trouble("nothing to keep".into()))
}

/// What is seen of the world by a solution.
fn shown(
    method: &dyn Integrator,
    scene: &Scene,
    solution: &Solution,
    setting: &Setting<'_>,
) -> Result<Vec<f64>, Trouble> {
    let estimator = method.view(scene, solution, &setting.context())?;
    let looks = around(DVec3::new(0.1, -1.0, 1.5), 300);
    let light = (0_u64..)
        .zip(&looks)
        .map(|(stream, ray)| seen(&*estimator, ray, stream, 2).g);
    Ok(light.collect())
}

fn read_back(method: &dyn Integrator, setting: &Setting<'_>) -> Result<f64, Trouble> {
    let scene = world(1.0, DVec3::ZERO)?;
    let solution = method.solve(&scene, &setting.context())?;
    let bytes = solution.to_bytes().unwrap_or_default();
    let again = method.restore(&bytes)?;
    if again.to_bytes() != Some(bytes) {
        return Err(Trouble("written again it has other bytes".into()));
    }
    let (one, other) = (
        shown(method, &scene, &solution, setting)?,
        shown(method, &scene, &again, setting)?,
    );
    if one.iter().all(|light| *light == 0.0) {
        return Err(Trouble("nothing is seen".into()));
    }
    Ok(differing(&one, &other))
}

/// What is cut short is no solution; what has other bits is, or is not.
fn damaged(setting: &Setting<'_>) -> Result<f64, Trouble> {
    let scene = world(1.0, DVec3::ZERO)?;
    let mut wrong = 0;
    let methods: [Box<dyn Integrator>; 2] = [Box::new(maps(500, 500, None)), Box::new(coarse())];
    for method in methods {
        let bytes = bytes_of(&*method, setting)?;
        for k in 0..200 {
            let cut = bytes.len() * k / 200;
            wrong += u32::from(method.restore(&bytes[..cut]).is_ok());
            let mut other = bytes.clone();
            other[cut] ^= 1 << (k % 8);
            if let Ok(solution) = method.restore(&other)
                && k.is_multiple_of(20)
            {
                // Whatever is seen: without a panic.
                shown(&*method, &scene, &solution, setting)?;
            }
        }
    }
    Ok(f64::from(wrong))
}

fn cancelled_solutions(setting: &Setting<'_>) -> Result<f64, Trouble> {
    let scene = world(1.0, DVec3::ZERO)?;
    let mut wrong = 0;
    // Photons tell how far they are after each pass at least.
    let photons = PhotonMapping {
        passes: 10,
        ..maps(2000, 0, None)
    };
    for method in [&photons as &dyn Integrator, &coarse(), &stochastic()] {
        let usual = bytes_of(method, setting)?;
        let mut n_told = 0;
        for tenth in 0..10 {
            let cancel = CancelToken::default();
            let progress = |progress: Progress| {
                if 10 * progress.done >= tenth * progress.total {
                    cancel.cancel();
                }
            };
            let context = RenderContext {
                cancel: &cancel,
                progress: &progress,
                ..setting.context()
            };
            match method.solve(&scene, &context) {
                Err(RenderError::Cancelled { .. }) => n_told += 1,
                // The wish came after the last that could be left out.
                Ok(solution) if solution.to_bytes().as_ref() == Some(&usual) => {}
                _ => wrong += 1,
            }
        }
        wrong += u32::from(n_told == 0) + u32::from(bytes_of(method, setting)? != usual);
    }
    Ok(f64::from(wrong))
}

/// Powers that arrive, one after the other.
#[derive(Default)]
struct Powers(Vec<Rgb>);

impl Visitor for Powers {
    fn arrives(&mut self, hit: &PhotonHit<'_>) -> Onward {
        self.0.push(hit.power);
        Onward::Go
    }
}

fn in_two_parts(setting: &Setting<'_>) -> Result<f64, Trouble> {
    let ball = Shape::Sphere { radius: 3.0 };
    let scene = Room::default()
        .with(ball, at(0., 0., 0.), Material::lambert(gray(0.6)))
        .with(
            square(0.5),
            at(0., 0., 0.),
            Material::leaf(gray(0.4), gray(0.3)),
        )
        .lit_by(Light::point(DVec3::new(0.1, 0.2, 1.0), gray(5.0)))
        .scene()?;
    let emission = Emission::new(&scene, Aim::Everything);
    let photons = Photons::all(2 * BLOCK + 100, setting.seed, 64);
    let of = |range| -> Result<Vec<Rgb>, Trouble> {
        let part = Photons {
            range,
            ..photons.clone()
        };
        let mut all = Vec::new();
        let join = |block: Powers| all.extend(block.0);
        trace(&emission, &part, &setting.context(), Powers::default, join)?;
        Ok(all)
    };
    let (whole, low, high) = (of(0..photons.n)?, of(0..BLOCK)?, of(BLOCK..photons.n)?);
    let parts = [low, high].concat();
    let pairs = whole.iter().zip(&parts).filter(|(a, b)| a != b).count();
    Ok((pairs + whole.len().abs_diff(parts.len())) as f64)
}
