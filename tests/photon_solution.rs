//! The light that photon mapping shares between cameras: solved once, kept, saved, read again, and refused where it does not fit.
//!
//! Numbers such as C-61 are those of the list of tests in the design notes.

#![allow(clippy::unwrap_used, reason = "a test may panic")]

#[path = "support/room.rs"]
#[allow(dead_code, reason = "other tests use the rest")]
mod room;

use glam::{DAffine3, DVec3};
use proptest::prelude::*;
use room::{Room, at, gray, square};
use std::fs;
use std::path::{Path, PathBuf};
use std::sync::Arc;
use tempfile::TempDir;
use understory::diag::{Diagnostics, SourceMap};
use understory::geometry::Shape;
use understory::integrator::{
    CancelToken, Integrator, PhotonMapping, RayCounts, RenderContext, Solution,
};
use understory::light::Light;
use understory::material::Material;
use understory::math::Ray;
use understory::options::{Options, Origin};
use understory::pipeline::audience::Audience;
use understory::pipeline::failure::Failure;
use understory::pipeline::making::{Made, Making, Partial};
use understory::pipeline::reel::Reel;
use understory::pipeline::report::Report;
use understory::pipeline::report::SolutionOrigin;
use understory::pipeline::solving::SolutionFiles;
use understory::pipeline::store::{PictureTarget, SolutionTarget};
use understory::pipeline::studio::{Keep, Studio};
use understory::pipeline::world::Machine;
use understory::sampler::{Sampler, SamplerKind};
use understory::scene::Scene;

/// Two balls on a floor, under a lamp.
const MODEL: &str = r"
protected void init() [
    Axiom ==>
        [ Translate(0, 0, 2.5) Rotate(-90, 0, 0) Parallelogram(0.5, 0.5).(setShader(WHITE), setLight(new AreaLight().(setPower(60)))) ]
        [ Translate(0, 1.5, 0) Rotate(90, 0, 0) Parallelogram(3, 3).(setShader(new RGBAShader(0.7, 0.6, 0.5))) ]
        [ Translate(0.6, 0.2, 0.4) Sphere(0.4).(setShader(new RGBAShader(0.3, 0.5, 0.7))) ]
        [ Translate(-0.5, 0, 0.3) Sphere(0.3).(setShader(new RGBAShader(0.8, 0.8, 0.8))) ];
]
";

struct Silent;

impl Audience for Silent {
    fn printed(&self, _: &str) {}

    fn warned(&self, _: &SourceMap, _: &Diagnostics) {}

    fn begins(&self, _: &'static str) {}

    fn progress(&self, _: u64, _: u64) {}

    fn ends(&self) {}
}

/// A folder with the model.
struct Bench {
    folder: TempDir,
    world: Machine,
}

impl Bench {
    fn new() -> Self {
        let folder = tempfile::tempdir().unwrap();
        fs::write(folder.path().join("m.rgg"), MODEL).unwrap();
        let world = Machine::new();
        Self { folder, world }
    }

    fn path(&self, name: &str) -> PathBuf {
        self.folder.path().join(name)
    }

    fn studio(&self, keep: Keep) -> Studio<'_> {
        Studio::new(&self.world, Arc::new(Silent), self.path("m.rgg"), keep)
    }

    /// Makes a picture (or a film, if the name has no suffix) as the commands do, and its report.
    fn make(
        &self,
        studio: &mut Studio<'_>,
        output: &str,
        flags: &[(&str, &str)],
    ) -> Result<(Made, serde_json::Value), Failure> {
        let mut options = Options::default();
        let usual = [
            ("renderer", "photon"),
            ("size", "24x16"),
            ("samples", "2"),
            ("steps", "0"),
            ("global-photons", "20000"),
            ("max-memory", "1G"),
        ];
        for (key, text) in usual.iter().chain(flags) {
            options.set(key, text, Origin::Flag).unwrap();
        }
        let opened = studio.read(&options)?;
        let mut run = studio.check(opened)?;
        let cancel = CancelToken::default();
        let making = Making {
            world: &self.world,
            audience: &Silent,
            cancel: &cancel,
            partial: Partial::Keep,
        };
        studio.seconds = Default::default();
        let path = self.path(output);
        let made = if path.extension().is_some() {
            let target = PictureTarget::new(&self.world, &path)?;
            making.picture(studio, &mut run, &target)?
        } else {
            fs::create_dir_all(&path).unwrap();
            let reel = Reel::new(&self.world, &path)?;
            making.film(studio, &mut run, &reel)?
        };
        let model = (&run.sources.map, run.sources.model_hash);
        let report = Report::new(
            &self.world,
            model,
            &run.options,
            &studio.seconds,
            made.effort,
            made.hash,
        );
        let report = serde_json::to_value(report.solved(made.solution)).unwrap();
        Ok((made, report))
    }

    /// The same in a studio of its own, with these files of solutions.
    fn with_files(
        &self,
        output: &str,
        flags: &[(&str, &str)],
        (read, save): (Option<&str>, Option<&str>),
    ) -> Result<(Made, serde_json::Value), Failure> {
        let mut studio = self.studio(Keep::Last);
        let save = save.map(|name| SolutionTarget::new(&self.world, &self.path(name)));
        studio.solution_files = SolutionFiles {
            read: read.map(|name| self.path(name)),
            save: save.transpose()?,
        };
        self.make(&mut studio, output, flags)
    }

    fn bytes(&self, name: &str) -> Vec<u8> {
        fs::read(self.path(name)).unwrap()
    }
}

fn message(result: Result<(Made, serde_json::Value), Failure>) -> String {
    match result {
        Err(Failure::World(text)) => text,
        other => panic!("{other:?}"),
    }
}

#[test]
fn what_only_the_camera_sees_does_not_solve_again() {
    let bench = Bench::new();
    let mut studio = bench.studio(Keep::All);
    let mut make = |flags: &[(&str, &str)]| {
        let (made, report) = bench.make(&mut studio, "a.png", flags).unwrap();
        let how = report["solution"].as_str().unwrap().to_owned();
        let n_solved = report["solves"].as_u64().unwrap();
        assert_eq!(report["photons_emitted"], 20_000);
        assert!(report["photons_stored"].as_u64().unwrap() > 100);
        (how, n_solved, made.hash)
    };
    let (how, n_solved, first) = make(&[]);
    assert_eq!((how.as_str(), n_solved), ("made", 1));
    // Camera, film, exposure, how far mirrors are followed.
    for flags in [
        [("eye", "3,-2,1.5")],
        [("size", "16x16")],
        [("samples", "3")],
        [("exposure", "1")],
        [("recursion-depth", "3")],
    ] {
        let (how, n_solved, _) = make(&flags);
        assert_eq!((how.as_str(), n_solved), ("kept", 0), "{flags:?}");
    }
    let (how, _, again) = make(&[]);
    assert_eq!((how.as_str(), again), ("kept", first));
    for flags in [
        [("photon-area", "0.02")],
        [("seed", "2")],
        [("sun", "90,50")],
    ] {
        let (how, n_solved, hash) = make(&flags);
        assert_eq!((how.as_str(), n_solved), ("made", 1), "{flags:?}");
        assert_ne!(hash, first, "{flags:?}");
    }
}

#[test]
fn frames_of_a_film_share_one_solution_and_other_methods_have_none() {
    let bench = Bench::new();
    let film = [("flight-frames", "5"), ("orbit", "true")];
    let (made, report) = bench
        .make(&mut bench.studio(Keep::Last), "frames", &film)
        .unwrap();
    assert_eq!((made.n_made, report["solves"].as_u64()), (5, Some(1)));
    assert_eq!(report["solution"], "made");
    let (_, report) = bench
        .make(
            &mut bench.studio(Keep::Last),
            "p.png",
            &[("renderer", "path")],
        )
        .unwrap();
    assert!(report["solution"].is_null() && report["photons_stored"].is_null());
    assert_eq!(report["solves"], 0);
}

#[test]
fn c61_a_saved_solution_gives_the_same_bytes_for_any_camera() {
    let bench = Bench::new();
    let camera = [("eye", "2,-3,2")];
    let fresh = bench
        .with_files("a.png", &[], (None, Some("s.light")))
        .unwrap();
    assert_eq!(fresh.0.solution.origin, Some(SolutionOrigin::Made));
    for (name, flags) in [("b", &[][..]), ("c", &camera)] {
        let (read, plain) = (format!("{name}-read.png"), format!("{name}.png"));
        let (made, report) = bench
            .with_files(&read, flags, (Some("s.light"), None))
            .unwrap();
        assert_eq!(
            (report["solution"].as_str(), report["solves"].as_u64()),
            (Some("read"), Some(0))
        );
        assert_eq!(report["photons_emitted"], 20_000);
        let solved = bench.with_files(&plain, flags, (None, None)).unwrap();
        assert_eq!(made.hash, solved.0.hash, "{name}");
        assert_eq!(bench.bytes(&read), bench.bytes(&plain));
    }
    // Of several passes.
    let passes = [("passes", "3"), ("global-photons", "5000")];
    let solved = bench
        .with_files("e.png", &passes, (None, Some("p.light")))
        .unwrap();
    let read = bench
        .with_files("f.png", &passes, (Some("p.light"), None))
        .unwrap();
    assert_eq!(solved.0.hash, read.0.hash);
    // Films too.
    let film = [("flight-frames", "3"), ("orbit", "true")];
    let one = bench
        .with_files("one", &film, (Some("s.light"), None))
        .unwrap();
    let other = bench.with_files("other", &film, (None, None)).unwrap();
    assert_eq!(one.0.hash, other.0.hash);
    // Read and written again it is the same file; with as many bytes for each photon as promised.
    bench
        .with_files("d.png", &[], (Some("s.light"), Some("t.light")))
        .unwrap();
    assert_eq!(bench.bytes("s.light"), bench.bytes("t.light"));
    let stored = fresh.1["photons_stored"].as_u64().unwrap();
    let size = bench.bytes("s.light").len() as u64;
    assert!(
        size <= 40 * stored + 10_000,
        "{size} bytes for {stored} photons"
    );
}

#[test]
fn a_solution_of_something_else_is_refused_with_what_differs() {
    let bench = Bench::new();
    bench
        .with_files("a.png", &[], (None, Some("s.light")))
        .unwrap();
    let refused =
        |flags: &[(&str, &str)]| message(bench.with_files("b.png", flags, (Some("s.light"), None)));
    for (key, before, now) in [
        ("global-photons", "20000", "30000"),
        ("photon-area", "auto", "0.5"),
        ("seed", "1", "9"),
        ("sun", "auto", "10,30"),
        ("caustic-photons", "auto", "7"),
        ("passes", "1", "2"),
    ] {
        let text = refused(&[(key, now)]);
        let expected = format!("`{key}` was `{before}` and is now `{now}`");
        assert!(
            text.contains(&expected) && text.contains("--save-solution"),
            "{text}"
        );
    }
    fs::write(bench.path("m.rgg"), MODEL.replace("0.4)", "0.45)")).unwrap();
    let text = refused(&[]);
    assert!(
        text.contains("the model") && text.contains("s.light"),
        "{text}"
    );
    assert!(!bench.path("b.png").exists());
}

#[test]
fn only_solutions_are_read_and_only_solutions_are_replaced() {
    let bench = Bench::new();
    fs::write(bench.path("thesis.light"), "forty pages of text").unwrap();
    let read = |name| message(bench.with_files("b.png", &[], (Some(name), None)));
    assert!(read("thesis.light").contains("not such a file"));
    assert!(read("missing.light").contains("no such file"));
    fs::create_dir(bench.path("folder")).unwrap();
    assert!(read("folder").contains("not an ordinary file"));
    let saved = message(bench.with_files("b.png", &[], (None, Some("thesis.light"))));
    assert!(saved.contains("not replaced"), "{saved}");
    assert_eq!(bench.bytes("thesis.light"), b"forty pages of text");
    for seed in ["1", "2"] {
        bench
            .with_files("a.png", &[("seed", seed)], (None, Some("s.light")))
            .unwrap();
    }
    assert!(
        bench
            .with_files("b.png", &[("seed", "2")], (Some("s.light"), None))
            .is_ok()
    );

    // Cut short, and with one byte changed, at any place.
    let whole = bench.bytes("s.light");
    for cut in [0, 5, 12, 15, 20, 100, whole.len() / 2, whole.len() - 1] {
        fs::write(bench.path("s.light"), &whole[..cut]).unwrap();
        let text = read("s.light");
        assert!(
            text.contains("damaged") || text.contains("not such"),
            "{cut}: {text}"
        );
    }
    for place in 0..40 {
        let mut file = whole.clone();
        let place = place * (whole.len() - 1) / 39;
        file[place] ^= 0x40;
        fs::write(bench.path("s.light"), &file).unwrap();
        let text = read("s.light");
        assert!(text.contains("cannot use"), "{place}: {text}");
    }
}

fn context(cancel: &CancelToken) -> RenderContext<'_> {
    RenderContext {
        seed: 3,
        cancel,
        progress: &|_| {},
    }
}

/// A floor, a ball that hides parts of it, small leaves, a mirror.
fn scene() -> Scene {
    let floor = Material::lambert(gray(0.6));
    let mut room = Room::default()
        .with(square(2.0), DAffine3::IDENTITY, floor.clone())
        .with(
            Shape::Sphere { radius: 0.3 },
            at(0.2, 0.0, 0.3),
            floor.clone(),
        )
        .with(
            Shape::Sphere { radius: 0.3 },
            at(-0.6, 0.0, 0.3),
            Material::mirror(gray(0.9)),
        );
    for i in 0..8 {
        room = room.with(
            square(0.04),
            at(0.1 * f64::from(i), 0.5, 0.4),
            floor.clone(),
        );
    }
    room.lit_by(Light::point(DVec3::new(0.0, 0.0, 2.0), gray(50.0)))
        .build()
}

fn method() -> PhotonMapping {
    PhotonMapping {
        global_photons: 20_000,
        caustic_photons: Some(5000),
        ..PhotonMapping::default()
    }
}

/// Some radiances, to the last bit.
fn looks(scene: &Scene, solution: &Solution) -> Vec<[u64; 3]> {
    let cancel = CancelToken::default();
    let view = method().view(scene, solution, &context(&cancel)).unwrap();
    let ray = |i: u32| {
        let to = DVec3::new(
            f64::from(i % 8) * 0.4 - 1.5,
            f64::from(i / 8) * 0.4 - 1.5,
            0.0,
        );
        let from = DVec3::new(0.5, -2.5, 3.0);
        Ray::new(from, (to - from).normalize())
    };
    let look = |i: u32| {
        let mut sampler = Sampler::new(SamplerKind::OwenSobol, 7, i);
        let seen = view.incident_radiance(&ray(i), &mut sampler, &mut RayCounts::default());
        seen.to_array().map(f64::to_bits)
    };
    (0..64).map(look).collect()
}

#[test]
fn solutions_come_back_from_their_bytes() {
    let scene = scene();
    let cancel = CancelToken::default();
    let solution = method().solve(&scene, &context(&cancel)).unwrap();
    let bytes = solution.to_bytes().unwrap();
    let again = method().restore(&bytes).unwrap();
    assert!(again.to_bytes().unwrap() == bytes);
    assert_eq!(again.photons(), solution.photons());
    let seen = looks(&scene, &solution);
    assert!(seen == looks(&scene, &again));
    // It is not all black, and is what `prepare` gives.
    let none = PhotonMapping {
        global_photons: 0,
        caustic_photons: Some(0),
        ..method()
    };
    let nothing = none.solve(&scene, &context(&cancel)).unwrap();
    assert!(seen != looks(&scene, &nothing));
    assert!(seen == looks(&scene, &Solution::Nothing));
}

proptest! {
    #![proptest_config(ProptestConfig { cases: 256, failure_persistence: None, ..ProptestConfig::default() })]

    /// Whatever the bytes are, they are refused or are a solution that can be looked at: no panic, no huge allocation.
    #[test]
    fn hostile_bytes_do_no_harm(
        changes in prop::collection::vec((any::<prop::sample::Index>(), any::<u8>()), 0..6),
        head in prop::collection::vec((0_usize..200, any::<u8>()), 0..4),
        cut in any::<prop::sample::Index>(),
        is_cut in prop::bool::weighted(0.3),
    ) {
        let (scene, whole) = shared();
        let mut bytes = whole.clone();
        for (at, value) in changes {
            let at = at.index(bytes.len());
            bytes[at] = value;
        }
        for (at, value) in head {
            bytes[at] = value;
        }
        if is_cut {
            bytes.truncate(cut.index(bytes.len()));
            prop_assert!(method().restore(&bytes).is_err());
        }
        if let Ok(solution) = method().restore(&bytes) {
            looks(scene, &solution);
        }
    }
}

/// A scene and its solution as bytes, made once.
fn shared() -> &'static (Scene, Vec<u8>) {
    static SHARED: std::sync::OnceLock<(Scene, Vec<u8>)> = std::sync::OnceLock::new();
    SHARED.get_or_init(|| {
        let scene = scene();
        let cancel = CancelToken::default();
        let few = PhotonMapping {
            global_photons: 2000,
            caustic_photons: Some(500),
            ..method()
        };
        let solution = few.solve(&scene, &context(&cancel)).unwrap();
        let bytes = solution.to_bytes().unwrap();
        (scene, bytes)
    })
}

#[test]
fn counts_beyond_the_file_ask_for_no_memory() {
    let (_, whole) = shared();
    // Emitted, stored, whether there is a map, its middle and size; then layers, spacing, samples.
    let layers = 8 + 8 + 1 + 4 * 8;
    for (at, size) in [(layers, 4), (layers + 4 + 8, 8)] {
        let mut bytes = whole.clone();
        bytes[at..at + size].fill(0xff);
        assert!(method().restore(&bytes).is_err());
    }
    assert!(method().restore(whole).is_ok());
}

#[test]
fn the_program_reads_what_it_writes_and_says_why_not() {
    let bench = Bench::new();
    let run = |words: &[&str]| {
        let mut command = std::process::Command::new(env!("CARGO_BIN_EXE_understory"));
        let usual = ["m.rgg", "--steps", "0", "--size", "16x16", "--samples", "1"];
        command.current_dir(bench.folder.path()).args(&words[..1]);
        let done = command.args(usual).args(&words[1..]).output().unwrap();
        let text = String::from_utf8_lossy(&done.stderr).into_owned();
        (done.status.code(), text)
    };
    let few = ["--renderer", "photon", "--global-photons", "5000"];
    let with = |first: &[&'static str], rest: &[&'static str]| run(&[first, rest].concat());
    let first = with(&["render", "-o", "a.png", "--save-solution", "s"], &few);
    assert_eq!(first.0, Some(0), "{}", first.1);
    let second = with(&["render", "-o", "b.png", "--solution", "s"], &few);
    assert_eq!(second.0, Some(0), "{}", second.1);
    assert_eq!(bench.bytes("a.png"), bench.bytes("b.png"));
    let flight = [
        "--orbit",
        "--flight-frames",
        "2",
        "--renderer",
        "photon",
        "--global-photons",
        "5000",
    ];
    let third = with(&["fly", "-o", "frames", "--solution", "s"], &flight);
    assert_eq!(third.0, Some(0), "{}", third.1);
    let (code, text) = with(
        &["render", "-o", "c.png", "--solution", "s"],
        &["--renderer", "photon"],
    );
    assert!(
        code == Some(3) && text.contains("`global-photons` was `5000`"),
        "{text}"
    );
    let (code, text) = with(&["render", "-o", "c.png", "--save-solution", "s"], &[]);
    assert!(
        code == Some(2) && text.contains("--renderer photon"),
        "{text}"
    );
    assert!(!Path::new(&bench.path("c.png")).exists());
}
