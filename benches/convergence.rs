//! What more photons buy: error and seconds of photon mapping over their number and over *Photon area*, beside the path tracer.
//!
//! `cargo bench --bench convergence` takes about six minutes on two cores; `-- full` goes on to 100 million photons (passes of the memory
//! of one). Scenes are the study's boxes with caustics, seen at 128 × 128 pixels.
//!
//! Errors are relative squared ones, over 99 % of the pixels: of the pixels, where noise shows, and of the means of 4 × 4 of them, where light
//! that is misplaced shows. The reference is noisy itself, so it is rendered twice, by the path tracer with other random numbers:
//! (x - a)(x - b) has the mean (x - truth)², whatever the noise of a and b.
#![allow(clippy::print_stdout, reason = "a benchmark prints its result")]
#![allow(clippy::unwrap_used, reason = "a benchmark may panic")]

#[path = "../tests/support/opened.rs"]
#[allow(dead_code, reason = "tests use the rest")]
mod opened;

use opened::{Drawn, Opened};
use std::path::Path;
use understory::film::LinearImage;

/// Pixels along an edge of the picture, and of the blocks whose means are compared.
const SIZE: usize = 128;
const BLOCKS: [usize; 2] = [1, 4];

/// Samples of each pixel of each reference, of a picture of photon mapping, of a quick one, and of the path tracer's own.
const REFERENCE: u32 = 2048;
const VIEW: u32 = 16;
const QUICK: u32 = 4;
const PATH: u32 = 400;

/// Part of the blocks that are left out at the worst end: fireflies of references.
const WORST: f64 = 0.01;

fn main() {
    let is_full = std::env::args().any(|argument| argument == "full");
    for scene in ["cornell", "two_spheres"] {
        let judge = Judge::new(scene);
        judge.quick();
        judge.photons(is_full);
        judge.areas();
        judge.path();
    }
}

/// A scene and its references.
struct Judge {
    scene: &'static str,
    references: [LinearImage; 2],
}

impl Judge {
    fn new(scene: &'static str) -> Self {
        let reference = |seed: u32| path(scene, REFERENCE, seed).image;
        Self {
            scene,
            references: [reference(101), reference(102)],
        }
    }

    /// As few samples as will do, for many cameras.
    fn quick(&self) {
        println!("{}: {QUICK} samples, kernel chosen", self.scene);
        for n in [100_000, 400_000] {
            self.print(
                &format!("{n}"),
                &photon(self.scene, n / 2, (1, QUICK), "auto"),
            );
        }
    }

    /// Over the number of photons, half of which are sent to mirrors and glass. The kernel is chosen.
    fn photons(&self, is_full: bool) {
        println!("{}: photons, kernel chosen", self.scene);
        println!(
            "{:>12} {:>10} {:>10} {:>10} {:>8} {:>8}",
            "photons", "pixels", "4 x 4", "bias", "solve s", "view s"
        );
        for (n, passes) in [
            (25_000, 1),
            (100_000, 1),
            (400_000, 1),
            (1_600_000, 1),
            (6_400_000, 1),
            (6_400_000, 4),
            (6_400_000, 16),
        ] {
            if passes == 1 || is_full {
                let drawn = photon(self.scene, n / 2, (passes, VIEW), "auto");
                self.print(&format!("{}", n * passes), &drawn);
            }
        }
    }

    /// Over *Photon area*, with 400,000 photons.
    fn areas(&self) {
        println!(
            "{}: 400000 photons, photon area in square metres",
            self.scene
        );
        for area in [
            "0.0001", "0.0004", "0.0016", "0.0064", "0.0256", "0.1024", "0.4096",
        ] {
            self.print(area, &photon(self.scene, 200_000, (1, VIEW), area));
        }
    }

    /// The path tracer, and how long it would take to an error of 0.01 in pixels: its error falls with time.
    fn path(&self) {
        let drawn = path(self.scene, PATH, 1);
        self.print(&format!("path {PATH}"), &drawn);
        let error = self.error(&drawn.image, 1);
        println!(
            "path to 0.01 in pixels: {:.1} s",
            drawn.seconds[1] * error / 0.01
        );
    }

    fn print(&self, name: &str, drawn: &Drawn) {
        let [pixels, blocks] = BLOCKS.map(|size| self.error(&drawn.image, size));
        let [solve, view] = drawn.seconds;
        let bias = self.bias(&drawn.image);
        println!("{name:>12} {pixels:>10.6} {blocks:>10.6} {bias:>+10.4} {solve:>8.2} {view:>8.2}");
    }

    /// Relative squared error of blocks of this size.
    fn error(&self, image: &LinearImage, size: usize) -> f64 {
        let found = blocks(image, size);
        let [a, b] = self.references.each_ref().map(|image| blocks(image, size));
        let mean = a.iter().chain(&b).sum::<f64>() / (2 * a.len()) as f64;
        let dark = (0.01 * mean) * (0.01 * mean);
        let mut errors: Vec<f64> = (0..found.len())
            .map(|at| {
                let truth = 0.5 * (a[at] + b[at]);
                (found[at] - a[at]) * (found[at] - b[at]) / (truth * truth + dark)
            })
            .collect();
        errors.sort_by(|x, y| x.abs().total_cmp(&y.abs()));
        let n = ((1.0 - WORST) * errors.len() as f64) as usize;
        errors[..n].iter().sum::<f64>() / n as f64
    }

    /// Relative error of the mean.
    fn bias(&self, image: &LinearImage) -> f64 {
        let mean = |image: &LinearImage| blocks(image, SIZE)[0];
        let [a, b] = self.references.each_ref().map(mean);
        mean(image) / (0.5 * (a + b)) - 1.0
    }
}

/// Mean luminance of blocks of pixels.
fn blocks(image: &LinearImage, size: usize) -> Vec<f64> {
    let n = SIZE / size;
    let mut sums = vec![0.0; n * n];
    for (at, pixel) in image.pixels.iter().enumerate() {
        let (x, y) = (at % SIZE / size, at / SIZE / size);
        sums[y * n + x] += pixel.luminance() / (size * size) as f64;
    }
    sums
}

fn draw(scene: &str, flags: &[(&str, &str)]) -> Drawn {
    let file = format!("examples/study/{scene}.rgg");
    let size = format!("{SIZE}x{SIZE}");
    let mut all = vec![("size", size.as_str()), ("supersampling", "auto")];
    all.extend(flags);
    Opened::new(Path::new(env!("CARGO_MANIFEST_DIR")).join(file), &all).draw()
}

fn path(scene: &str, samples: u32, seed: u32) -> Drawn {
    let (samples, seed) = (samples.to_string(), seed.to_string());
    draw(
        scene,
        &[("renderer", "path"), ("samples", &samples), ("seed", &seed)],
    )
}

/// So many photons to all surfaces and as many to mirrors and glass, in each of so many passes.
fn photon(scene: &str, n: u64, (passes, samples): (u64, u32), area: &str) -> Drawn {
    let [n, passes, samples] = [n.to_string(), passes.to_string(), samples.to_string()];
    let flags = [
        ("renderer", "photon"),
        ("samples", samples.as_str()),
        ("global-photons", n.as_str()),
        ("caustic-photons", n.as_str()),
        ("passes", passes.as_str()),
        ("photon-area", area),
        ("final-gather", "0"),
    ];
    draw(scene, &flags)
}
