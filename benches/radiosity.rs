//! What radiosity has right: errors against the path tracer, beside one hemicube of 100 pixels on each patch, and with a final gather.
//!
//! `cargo bench --bench radiosity` takes about ten minutes on two cores; `-- only=columns reference=64` takes one scene, with fewer samples of
//! references: their noise makes errors uncertain, not larger. Scenes are the study's two of radiosity, 192
//! pixels wide, and the peers' S2, 160 wide.
//!
//! Errors are relative squared ones ([`understory::trade::metrics`]) of pixels and of the means of 8 × 8 of them, against two references by the
//! path tracer. Each solution is looked at twice, with other random numbers: the noise of views is taken off, and what is left is
//! the error of the solution (and of what a gather keeps).
#![allow(clippy::print_stdout, reason = "a benchmark prints its result")]
#![allow(clippy::unwrap_used, reason = "a benchmark may panic")]

#[path = "../tests/support/opened.rs"]
#[allow(dead_code, reason = "tests use the rest")]
mod opened;

use opened::Opened;
use std::ops::ControlFlow;
use std::path::Path as FilePath;
use std::time::Instant;
use understory::camera::Camera;
use understory::color::Rgb;
use understory::film::{Filter, LinearImage};
use understory::integrator::driver::{FilmSettings, Refinement, render_view};
use understory::integrator::radiosity::{FormFactorMethod, Solver};
use understory::integrator::{CancelToken, Integrator, Path, Radiosity, RenderContext, Solution};
use understory::sampler::SamplerKind;
use understory::scene::Scene;
use understory::trade::metrics::Truth;

/// Pixels along the edges of blocks whose means are compared.
const BLOCK: u32 = 8;

/// Samples of each pixel of each reference unless words say otherwise, and of a view.
const REFERENCE: &str = "512";
const VIEW: u32 = 16;

/// Seeds of references, of solutions, and of what views of them draw.
const REFERENCES: [u64; 2] = [101, 102];
const SOLUTION: u64 = 1;
const VIEWS: [u64; 2] = [11, 12];

fn main() {
    let word = |key: &str, usual: &str| {
        let found = std::env::args().find_map(|word| word.strip_prefix(key).map(str::to_owned));
        found.unwrap_or(usual.to_owned())
    };
    let (only, reference) = (word("only=", ""), word("reference=", REFERENCE));
    let reference = reference.parse().unwrap();
    println!(
        "{:<14} {:<34} {:>9} {:>9} {:>9} {:>8} {:>8}",
        "scene", "", "pixels", "8 x 8", "mean", "solve s", "view s"
    );
    for (model, size) in [
        ("study/four_lights", "192x192"),
        ("study/three_columns", "192x144"),
        ("peers/S2", "160x160"),
    ] {
        if model.contains(&only) {
            let judge = Judge::new(model, size, reference);
            rows()
                .iter()
                .for_each(|(name, method)| judge.row(name, method));
        }
    }
}

/// What is compared.
fn rows() -> Vec<(String, Radiosity)> {
    let ours = Radiosity::default();
    let gather = |method: &Radiosity, rays| Radiosity {
        final_gather: rays,
        ..method.clone()
    };
    let hemicube = Radiosity {
        solver: Some(Solver::Gather),
        form_factors: FormFactorMethod::Hemicube,
        hemicube_pixels: 100,
        hemicubes: 1,
        ..ours.clone()
    };
    let patches = |method: &Radiosity| Radiosity {
        subdivision_depth: 0,
        ..method.clone()
    };
    [
        ("default", ours.clone()),
        ("one hemicube of 100", hemicube.clone()),
        ("patches only", patches(&ours)),
        ("patches only, one hemicube of 100", patches(&hemicube)),
        ("patches only, gather 64", gather(&patches(&ours), 64)),
        ("patches only, gather 256", gather(&patches(&ours), 256)),
        ("default, gather 256", gather(&ours, 256)),
    ]
    .map(|(name, method)| (name.to_owned(), method))
    .into()
}

/// A scene, what looks at it, and the truth of what it sees.
struct Judge {
    name: &'static str,
    scene: std::sync::Arc<Scene>,
    camera: Camera,
    settings: FilmSettings,
    /// Of pixels and of blocks.
    truths: [Truth; 2],
}

impl Judge {
    fn new(model: &'static str, size: &str, reference: u32) -> Self {
        let path = FilePath::new(env!("CARGO_MANIFEST_DIR"));
        let path = path.join("examples").join(model).with_extension("rgg");
        let (scene, camera) = Opened::new(path, &[("size", size)]).scene();
        let (width, height) = size.split_once('x').unwrap();
        let settings = FilmSettings {
            width: width.parse().unwrap(),
            height: height.parse().unwrap(),
            samples_per_pixel: VIEW,
            filter: Filter::default(),
            sampler: SamplerKind::default(),
            refinement: Refinement::Everywhere,
        };
        let long = FilmSettings {
            samples_per_pixel: reference,
            ..settings
        };
        let looked = |seed| {
            look(
                &Path::default(),
                &scene,
                &Solution::Nothing,
                (&camera, &long),
                seed,
            )
        };
        let [a, b] = REFERENCES.map(looked);
        Self {
            name: model,
            truths: [Truth::new(&a, &b), Truth::new(&blocks(&a), &blocks(&b))],
            scene,
            camera,
            settings,
        }
    }

    fn row(&self, name: &str, method: &Radiosity) {
        let cancel = CancelToken::default();
        let begin = Instant::now();
        let solution = method.solve(&self.scene, &context(&cancel, SOLUTION));
        let solution = solution.unwrap();
        let solved = Instant::now();
        let view = (&self.camera, &self.settings);
        let views = VIEWS.map(|seed| look(method, &self.scene, &solution, view, seed));
        let viewed = solved.elapsed().as_secs_f64() / VIEWS.len() as f64;
        let of_blocks = views.each_ref().map(blocks);
        let [pixels, means] = &self.truths;
        let excess = pixels.excess(&views, &|_| true).unwrap().relative;
        println!(
            "{:<14} {name:<34} {:>9.6} {:>9.6} {:>+9.4} {:>8.2} {:>8.2}",
            self.name.rsplit_once('/').unwrap().1,
            pixels.decompose(&views).bias_squared,
            means.decompose(&of_blocks).bias_squared,
            excess,
            (solved - begin).as_secs_f64(),
            viewed
        );
    }
}

fn context(cancel: &CancelToken, seed: u64) -> RenderContext<'_> {
    RenderContext {
        seed,
        cancel,
        progress: &|_| {},
    }
}

/// A picture whose samples have this seed; what is gathered is that of the solution's.
fn look(
    method: &dyn Integrator,
    scene: &Scene,
    solution: &Solution,
    (camera, settings): (&Camera, &FilmSettings),
    seed: u64,
) -> LinearImage {
    let cancel = CancelToken::default();
    let view = method.view(scene, solution, &context(&cancel, SOLUTION));
    let view = view.unwrap();
    let context = context(&cancel, seed);
    let go_on = &mut |_: &_| ControlFlow::Continue(());
    let result = render_view(&*view, camera, settings, &context, go_on);
    result.unwrap().film.image()
}

/// Means of blocks; what is left over at the rims is left out.
fn blocks(image: &LinearImage) -> LinearImage {
    let (width, height) = (image.width / BLOCK, image.height / BLOCK);
    let mean = |at: u32| {
        let (left, top) = (at % width * BLOCK, at / width * BLOCK);
        let pixel = |k: u32| {
            let (x, y) = (left + k % BLOCK, top + k / BLOCK);
            image.pixels[(y * image.width + x) as usize]
        };
        let n = BLOCK * BLOCK;
        (0..n).map(pixel).sum::<Rgb>() / f64::from(n)
    };
    LinearImage {
        width,
        height,
        pixels: (0..width * height).map(mean).collect(),
    }
}
