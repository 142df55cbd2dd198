//! Whether `render` keeps its word: the error that `--error` promises, and the time that `--time` grants, over a corpus of scenes and seeds.
//!
//! `cargo bench --bench targets` takes the study's nine scenes, a tree, a crop row and a forest, 160 × 107 pixels each, ten seeds. Words after
//! `--` change that: `size=24x16 seeds=3 reference=256 error=0.05 time=2 only=cornell`; `error=0` or `time=0` leaves that part out.
//!
//! The error of a picture is that by path-traced ones with other random numbers, two made for that and those of the other seeds if path tracing
//! is what was chosen for them: the mean of (x - a)(x - b) over all pairs a, b of these, by their samples, has no bias by their noise; the
//! error is the mean of that over pixels, divided by r² + ε, r the mean of the others, ε = 0.01 · mean². Met means: its root over all but the
//! worst pixel in a thousand is at most what was promised, whatever the program itself says of it. That, and the root over all pixels, are
//! printed beside: single pixels that are far too bright are part of it, and neither halves nor checks, which measure by the picture's own
//! brightness, can tell how much too bright.
#![allow(clippy::print_stdout, reason = "a benchmark prints its result")]
#![allow(clippy::unwrap_used, reason = "a benchmark may panic")]

use std::path::{Path, PathBuf};
use std::sync::Arc;
use understory::diag::{Diagnostics, SourceMap};
use understory::integrator::CancelToken;
use understory::math::tolerance::DARK_PIXEL_FLOOR;
use understory::options::{Options, Origin};
use understory::pipeline::audience::Audience;
use understory::pipeline::making::{Made, Making, Partial};
use understory::pipeline::report::PhaseSeconds;
use understory::pipeline::store::PictureTarget;
use understory::pipeline::studio::{Keep, Run, Studio};
use understory::pipeline::world::Machine;
use understory::scene::Scene;

/// The corpus: name, model.
const SCENES: [(&str, &str); 12] = [
    ("complex_room", "examples/study/complex_room.rgg"),
    ("concave_mirror", "examples/study/concave_mirror.rgg"),
    ("cornell", "examples/study/cornell.rgg"),
    ("four_lights", "examples/study/four_lights.rgg"),
    ("half_open_door", "examples/study/half_open_door.rgg"),
    ("ring", "examples/study/ring.rgg"),
    ("three_columns", "examples/study/three_columns.rgg"),
    ("three_cubes", "examples/study/three_cubes.rgg"),
    ("two_spheres", "examples/study/two_spheres.rgg"),
    ("tree", "examples/poplar.rgg"),
    ("crop", "examples/crop.rgg"),
    ("forest", "examples/forest.rgg"),
];

/// Seeds of the references.
const REFERENCES: [u32; 2] = [9001, 9002];
/// Pixels left out at the worst end for the trimmed error.
const WORST: f64 = 0.001;
/// A time is kept if it is off by at most this part.
const KEPT: f64 = 0.1;

struct Silent;

impl Audience for Silent {
    fn printed(&self, _: &str) {}

    fn warned(&self, _: &SourceMap, _: &Diagnostics) {}

    fn begins(&self, _: &'static str) {}

    fn progress(&self, _: u64, _: u64) {}

    fn ends(&self) {}
}

/// What is measured.
struct Wanted {
    size: String,
    seeds: u32,
    reference: u32,
    error: f64,
    time: f64,
    only: String,
}

/// A picture as its command makes it.
struct Picture {
    /// Luminance of each pixel.
    pixels: Vec<f64>,
    made: Made,
    /// Seconds of light: choice, solution, samples, check.
    seconds: f64,
    renderer: String,
}

fn main() {
    let wanted = wanted();
    let folder = tempfile::tempdir().unwrap();
    let world = Machine::new();
    println!(
        "| scene | wish | met or kept | errors found (of all pixels) | errors told | seconds | renderers |\n\
         |---|---|---|---|---|---|---|"
    );
    let (mut n_met, mut n_all) = (0, 0);
    for (name, model) in SCENES
        .iter()
        .filter(|(name, _)| name.contains(&wanted.only))
    {
        let mut stage = Stage::new(&world, model, &wanted.size, folder.path().join("x.exr"));
        let references = REFERENCES.map(|seed| {
            let samples = wanted.reference.to_string();
            let set = [
                ("renderer", "path"),
                ("samples", &samples),
                ("supersampling", "auto"),
            ];
            stage.picture(seed, &set)
        });
        let wishes = [("error", wanted.error), ("time", wanted.time)];
        for (key, value) in wishes.into_iter().filter(|(_, value)| *value > 0.0) {
            let text = value.to_string();
            let pictures: Vec<Picture> = (1..=wanted.seeds)
                .map(|seed| stage.picture(seed, &[(key, &text)]))
                .collect();
            let met = row(name, (key, value), &pictures, &references);
            n_met += met;
            n_all += pictures.len();
        }
    }
    println!("\n{n_met} of {n_all}");
}

/// Prints a row of the table; how many pictures kept their word.
fn row(
    name: &str,
    (key, value): (&str, f64),
    pictures: &[Picture],
    references: &[Picture; 2],
) -> usize {
    let found: Vec<[f64; 2]> = (0..pictures.len())
        .map(|i| {
            let others = (0..pictures.len())
                .filter(|j| *j != i)
                .map(|j| &pictures[j]);
            let truths = others.filter(|other| other.renderer == "path");
            error(
                &pictures[i],
                &references.iter().chain(truths).collect::<Vec<_>>(),
            )
        })
        .collect();
    let is_met = |(picture, [_, most]): (&Picture, &[f64; 2])| match key {
        "error" => *most <= value,
        _ => (picture.seconds / value - 1.0).abs() <= KEPT,
    };
    let met = pictures
        .iter()
        .zip(&found)
        .filter(|pair| is_met(*pair))
        .count();
    let percent = |x: f64| format!("{:.2}", 100.0 * x);
    let join = |texts: Vec<String>| texts.join(" ");
    let told = |picture: &Picture| {
        let error = picture.made.effort.error;
        error.map_or("?".into(), |e| percent(e.relative))
    };
    let mut renderers: Vec<&str> = pictures.iter().map(|p| &*p.renderer).collect();
    renderers.sort_unstable();
    renderers.dedup();
    println!(
        "| {name} | {key} {value} | {met} of {} | {} | {} | {} | {} |",
        pictures.len(),
        join(
            found
                .iter()
                .map(|[all, most]| format!("{} ({})", percent(*most), percent(*all)))
                .collect()
        ),
        join(pictures.iter().map(told).collect()),
        join(
            pictures
                .iter()
                .map(|p| format!("{:.2}", p.seconds))
                .collect()
        ),
        renderers.join(" ")
    );
    met
}

/// Relative error of all pixels, and of all but the worst.
fn error(picture: &Picture, truths: &[&Picture]) -> [f64; 2] {
    let weights = truths
        .iter()
        .map(|truth| truth.made.effort.n_samples as f64);
    let weights: Vec<f64> = weights.collect();
    let all: f64 = weights.iter().sum();
    let own: f64 = weights.iter().map(|w| w * w).sum();
    // Pixel by pixel: what is true, and the product over pairs, without those of a picture with itself.
    let judged = |(i, x): (usize, &f64)| {
        let (mut truth, mut first, mut second) = (0.0, 0.0, 0.0);
        for (other, w) in truths.iter().zip(&weights) {
            let off = x - other.pixels[i];
            truth += w * other.pixels[i];
            first += w * off;
            second += w * w * off * off;
        }
        (truth / all, (first * first - second) / (all * all - own))
    };
    let judged: Vec<(f64, f64)> = picture.pixels.iter().enumerate().map(judged).collect();
    let mean = judged.iter().map(|(truth, _)| truth).sum::<f64>() / judged.len() as f64;
    let floor = DARK_PIXEL_FLOOR * mean * mean;
    let mut squares: Vec<f64> = judged
        .iter()
        .map(|(truth, square)| square / (truth * truth + floor))
        .collect();
    squares.sort_by(f64::total_cmp);
    let n_kept = ((1.0 - WORST) * squares.len() as f64) as usize;
    let root = |squares: &[f64]| {
        let mean = squares.iter().sum::<f64>() / squares.len() as f64;
        mean.max(0.0).sqrt()
    };
    [root(&squares), root(&squares[..n_kept])]
}

/// A scene that is there, and what pictures of it are made with.
struct Stage<'w> {
    world: &'w Machine,
    studio: Studio<'w>,
    run: Run,
    scene: Arc<Scene>,
    output: PathBuf,
}

impl<'w> Stage<'w> {
    fn new(world: &'w Machine, model: &str, size: &str, output: PathBuf) -> Self {
        let model = Path::new(env!("CARGO_MANIFEST_DIR")).join(model);
        let mut flags = Options::default();
        flags.set("size", size, Origin::Flag).unwrap();
        let mut studio = Studio::new(world, Arc::new(Silent), model, Keep::Last);
        let opened = studio.read(&flags).unwrap();
        let run = studio.check(opened).unwrap();
        let scene = studio.build(&run, &CancelToken::default()).unwrap();
        Self {
            world,
            studio,
            run,
            scene,
            output,
        }
    }

    /// A picture with this seed of its light; the plants stay.
    fn picture(&mut self, seed: u32, set: &[(&str, &str)]) -> Picture {
        let mut run = self.run.clone();
        let seed = seed.to_string();
        for (key, text) in [("seed", &*seed)].iter().chain(set) {
            run.options.set(key, text, Origin::Flag).unwrap();
        }
        let making = Making {
            world: self.world,
            audience: &Silent,
            cancel: &CancelToken::default(),
            partial: Partial::Keep,
        };
        self.studio.seconds = PhaseSeconds::default();
        let target = PictureTarget::new(self.world, &self.output).unwrap();
        let made = making
            .picture_of(&mut self.studio, &mut run, &self.scene, &target)
            .unwrap();
        let seconds = &self.studio.seconds;
        let image = image::open(&self.output).unwrap().into_rgb32f();
        let luminance = |p: &image::Rgb<f32>| {
            let [r, g, b] = p.0.map(f64::from);
            understory::color::Rgb::new(r, g, b).luminance()
        };
        Picture {
            pixels: image.pixels().map(luminance).collect(),
            made,
            seconds: seconds.prepare + seconds.render + seconds.check,
            renderer: run.options.renderer.text.clone(),
        }
    }
}

fn wanted() -> Wanted {
    let mut wanted = Wanted {
        size: "160x107".into(),
        seeds: 10,
        reference: 1024,
        error: 0.02,
        time: 5.0,
        only: String::new(),
    };
    for word in std::env::args() {
        match word.split_once('=') {
            Some(("size", text)) => wanted.size = text.into(),
            Some(("seeds", text)) => wanted.seeds = text.parse().unwrap(),
            Some(("reference", text)) => wanted.reference = text.parse().unwrap(),
            Some(("error", text)) => wanted.error = text.parse().unwrap(),
            Some(("time", text)) => wanted.time = text.parse().unwrap(),
            Some(("only", text)) => wanted.only = text.into(),
            _ => {}
        }
    }
    wanted
}
