//! The program as a user runs it: messages, exit codes, files, and nothing left behind.

#![allow(clippy::unwrap_used, reason = "a test fails by panicking")]

use assert_cmd::Command;
use std::collections::BTreeSet;
use std::fs;
use std::path::{Path, PathBuf};
use std::process::Output;
use std::time::Duration;
use tempfile::TempDir;

/// A small tree that grows.
const TREE: &str = "\
module Bud(float len) extends Sphere(0.05);
protected void init() [ Axiom ==> Bud(1); ]
public void run() [
    Bud(x) ==> F(x, 0.05) [ RU(40) Bud(x * 0.7) ] [ RU(-30) RH(90) Bud(x * 0.6) ];
]
";

/// A folder with a model in it, gone after the test.
struct Bench {
    folder: TempDir,
}

impl Bench {
    fn new(model: &str) -> Self {
        let bench = Self {
            folder: tempfile::tempdir().unwrap(),
        };
        bench.write("m.rgg", model);
        bench
    }

    fn path(&self, name: &str) -> PathBuf {
        self.folder.path().join(name)
    }

    fn write(&self, name: &str, text: &str) {
        fs::write(self.path(name), text).unwrap();
    }

    /// Runs the program in the folder; words are separated by single spaces.
    fn run(&self, line: &str) -> Output {
        Command::new(env!("CARGO_BIN_EXE_understory"))
            .current_dir(self.folder.path())
            .args(line.split(' '))
            .timeout(Duration::from_secs(120))
            .output()
            .unwrap()
    }

    fn succeed(&self, line: &str) -> String {
        let output = self.run(line);
        assert_eq!(
            output.status.code(),
            Some(0),
            "{line}\n{}",
            text(&output.stderr)
        );
        text(&output.stdout)
    }

    /// Runs what must fail with `code`, without a panic, and returns the message.
    fn fail(&self, line: &str, code: i32) -> String {
        let output = self.run(line);
        let message = text(&output.stderr);
        assert_eq!(output.status.code(), Some(code), "{line}\n{message}");
        assert!(!message.contains("panicked"), "{line}\n{message}");
        message
    }

    fn files(&self) -> BTreeSet<String> {
        let entries = fs::read_dir(self.folder.path()).unwrap();
        entries
            .map(|e| e.unwrap().file_name().to_string_lossy().into_owned())
            .collect()
    }
}

fn text(bytes: &[u8]) -> String {
    String::from_utf8_lossy(bytes).into_owned()
}

fn bytes(path: &Path) -> Vec<u8> {
    fs::read(path).unwrap_or_else(|error| panic!("{}: {error}", path.display()))
}

/// Flags of pictures that cost nothing.
const SMALL: &str = "--size 24x16 --samples 2";

#[test]
fn broken_models_give_one_clear_message_and_no_file() {
    let run = |body: &str| {
        format!("module A;\nprotected void init() [ Axiom ==> A; ]\npublic void run() {body}\n")
    };
    let cases = [
        ("syntax", run("[ A ==> F(1; ]"), "", &["m.rgg:3"][..]),
        (
            "unknown module",
            run("[ A ==> F(1) Intenode; ]"),
            "",
            &["Intenode", "m.rgg:3"][..],
        ),
        (
            "wrong arity",
            run("[ A ==> RU(1, 2, 3, 4, 5); ]"),
            "",
            &["RU", "m.rgg:3"][..],
        ),
        (
            "wrong type",
            run("{ int i = \"three\"; }"),
            "",
            &["String", "int", "m.rgg:3"][..],
        ),
        ("empty file", String::new(), "", &["m.rgg"][..]),
        (
            "geometry that is no number",
            run("[ A ==> Sphere(0.0 / 0.0); ]"),
            "",
            &["finite"][..],
        ),
        (
            "endless loop",
            run("{ while (true) { } }"),
            "",
            &["m.rgg:3"][..],
        ),
        (
            "exploding rule",
            run("[ A ==> A A; ]"),
            "--steps 60 --max-modules 5000",
            &["m.rgg:3"][..],
        ),
        (
            "exploding body",
            "module T(int d) ==> if (d > 0) (T(d - 1) F(random(1, 2)) T(d - 1));\n\
             protected void init() [ Axiom ==> T(60); ]\n"
                .to_owned(),
            "--max-modules 5000",
            &["m.rgg:1", "5000 nodes"][..],
        ),
    ];
    for (name, model, flags, expected) in cases {
        let bench = Bench::new(&model);
        let line = format!("render m.rgg -o m.png {SMALL} {flags}");
        let message = bench.fail(line.trim_end(), 1);
        for word in expected {
            assert!(message.contains(word), "{name}: no `{word}` in\n{message}");
        }
        assert_eq!(
            message.matches("Error").count(),
            1,
            "{name}: not one message\n{message}"
        );
        assert_eq!(
            bench.files(),
            BTreeSet::from(["m.rgg".to_owned()]),
            "{name}"
        );
    }
}

#[test]
fn a_model_that_cannot_be_read_is_the_worlds_fault() {
    let bench = Bench::new(TREE);
    let message = bench.fail("render none.rgg -o m.png", 3);
    assert!(
        message.contains("none.rgg") && message.contains("no such"),
        "{message}"
    );
    fs::create_dir(bench.path("folder.rgg")).unwrap();
    assert!(bench.fail("check folder.rgg", 3).contains("no `.rgg` file"));
    fs::write(bench.path("b.rgg"), [0x6d, 0xff, 0xfe]).unwrap();
    assert!(bench.fail("check b.rgg", 1).contains("UTF-8"));
    assert!(bench.fail("check m.txt", 2).contains("m.txt"));
}

#[test]
fn an_output_that_cannot_be_written_is_told_before_the_work() {
    let bench = Bench::new(TREE);
    bench.write("thesis.png", "forty pages of text");
    for (output, code, word) in [
        ("no/m.png", 3, "no such"),
        ("m.rgg/m.png", 3, "m.rgg"),
        ("thesis.png", 3, "not replaced"),
        ("m.bmp", 2, ".png"),
        ("m", 2, ".png"),
    ] {
        // So many steps that growth would not end: it must not begin.
        let message = bench.fail(&format!("render m.rgg -o {output} --steps 1000000"), code);
        assert!(message.contains(word), "{output}: {message}");
    }
    for (output, code, word) in [
        ("m.avi", 2, ".mp4"),
        ("no/m.mp4", 3, "no such"),
        ("thesis.png", 3, "not replaced"),
    ] {
        let message = bench.fail(
            &format!("fly m.rgg --orbit -o {output} --steps 1000000"),
            code,
        );
        assert!(message.contains(word), "{output}: {message}");
    }
    assert!(bench.fail("fly m.rgg -o f", 2).contains("--orbit"));
    assert_eq!(
        text(&bytes(&bench.path("thesis.png"))),
        "forty pages of text"
    );
    assert_eq!(bench.files().len(), 2);
}

#[test]
fn senseless_wishes_are_usage_errors() {
    let bench = Bench::new(TREE);
    for (flags, word) in [
        ("--samples 0", "from 1 up"),
        ("--size 0x5", "WIDTHxHEIGHT"),
        ("--size 1000000x1000000", "memory"),
        ("--eye 1,NaN,2", "finite"),
        ("--eye 1,2,3 --target 1,2,3", "same point"),
        ("--eye 0,0,9 --target 0,0,0 --up 0,0,1", "up"),
        ("--fov 0", "more than 0"),
        ("--fov 180", "less than 180"),
        ("--threads 0", "1 to 1024"),
        ("--renderer radiance", "`radiosity`"),
        ("--quality best", "draft"),
        ("--sun 0,95", "0 to 90"),
        ("--smaples 3", "--samples"),
    ] {
        let message = bench.fail(&format!("render m.rgg -o m.png {flags}"), 2);
        assert!(message.contains(word), "{flags}: {message}");
    }
    assert!(
        bench
            .fail("fly m.rgg --orbit -o f --frames 5..2", 2)
            .contains("A less than B")
    );
    assert_eq!(bench.files().len(), 1);
}

#[test]
fn a_view_straight_down_is_a_map() {
    let bench = Bench::new("protected void init() [ Axiom ==> F(1); ]\n");
    let line = format!("render m.rgg -o m.png {SMALL} --eye 0,0,5 --target 0,0,0");
    bench.succeed(&line);
    assert!(bench.fail(&format!("{line} --up 0,0,1"), 2).contains("up"));
}

/// The time is that of the whole film: what it allows is chosen once, and kept beside the frames.
#[test]
fn a_wanted_time_is_that_of_the_film() {
    let bench = Bench::new("protected void init() [ Axiom ==> F(1); ]\n");
    bench.write("m.toml", "[render]\ntime = 0.3\n");
    let line = "fly m.rgg --orbit --flight-frames 3 --flicker 0 -o f --size 24x16";
    bench.succeed(line);
    assert!(bench.path("f/chosen.toml").exists());
    let message = bench.fail(&format!("{line} --error 0.1"), 2);
    assert!(message.contains("`time` and `error`"), "{message}");
    let saved = "render m.rgg -o m.png --renderer photon --save-solution s --size 24x16";
    assert!(bench.fail(saved, 2).contains("--save-solution"));
}

#[test]
fn a_flight_has_no_frames_beyond_its_length() {
    let bench = Bench::new(TREE);
    let fly = format!("fly m.rgg --orbit --flight-frames 12 -o f {SMALL}");
    let message = bench.fail(&format!("{fly} --frames 10..13 --steps 1000000"), 2);
    for word in ["10..13", "12 frames", "--flight-frames 13"] {
        assert!(message.contains(word), "{message}");
    }
    bench.succeed(&format!("{fly} --frames 11..12"));
}

#[test]
fn budgets_are_blamed_by_their_names() {
    let bench = Bench::new(TREE);
    let message = bench.fail("derive m.rgg --steps 9 --max-memory 640", 1);
    assert!(message.contains("--max-memory"), "{message}");
    assert!(!message.contains("--max-modules"), "{message}");
    let message = bench.fail("derive m.rgg --steps 9 --max-modules 10", 1);
    assert!(message.contains("--max-modules"), "{message}");
}

#[test]
fn an_unknown_step_names_those_there_are_nearest_first() {
    let bench =
        Bench::new("public void sprout() [ ]\npublic void growUp() [ ]\npublic void run() [ ]\n");
    let message = bench.fail("derive m.rgg --entry growup", 1);
    assert!(message.contains("growUp, sprout, run"), "{message}");
    let message = bench.fail("derive m.rgg --entry nosuch", 1);
    assert!(message.contains("sprout, growUp, run"), "{message}");
}

/// Two to the sixtieth power of shapes, none like another.
const ENDLESS: &str = "\
module T(int d) ==> if (d > 0) ( T(d-1) RU(random(0,1)) F(0.1) T(d-1) );
protected void init() [ Axiom ==> T(60); ]
";

#[test]
fn bodies_without_end_are_stopped_by_a_budget_that_names_them() {
    let bench = Bench::new(ENDLESS);
    let line = format!("render m.rgg -o m.png {SMALL} --max-modules 20000");
    let message = bench.fail(&line, 1);
    for word in ["20000", "`T`", "m.rgg:1:"] {
        assert!(message.contains(word), "{message}");
    }
    assert_eq!(bench.files().len(), 1);
}

#[cfg(unix)]
#[test]
fn ctrl_c_stops_the_drawing() {
    let bench = Bench::new(ENDLESS);
    let line = format!("render m.rgg -o m.png {SMALL} --max-memory 1000000000000");
    let line = format!("{line} --max-modules 1000000000000");
    let mut child = std::process::Command::new(env!("CARGO_BIN_EXE_understory"))
        .current_dir(bench.folder.path())
        .args(line.split(' '))
        .stderr(std::process::Stdio::piped())
        .spawn()
        .unwrap();
    std::thread::sleep(Duration::from_millis(700));
    let asked = std::process::Command::new("kill")
        .args(["-INT", &child.id().to_string()])
        .status();
    assert!(asked.unwrap().success());
    // Not seen, the wish would leave it drawing until memory ends.
    let deadline = std::time::Instant::now() + Duration::from_secs(20);
    while child.try_wait().unwrap().is_none() && std::time::Instant::now() < deadline {
        std::thread::sleep(Duration::from_millis(20));
    }
    let _ = child.kill();
    let output = child.wait_with_output().unwrap();
    assert_eq!(output.status.code(), Some(3));
    assert!(text(&output.stderr).contains("stopped"));
}

#[test]
fn every_format_is_written_and_replaced() {
    let bench = Bench::new(TREE);
    for suffix in ["png", "jpg", "webp", "exr", "hdr"] {
        for _ in 0..2 {
            bench.succeed(&format!("render m.rgg -o m.{suffix} {SMALL} --quiet"));
        }
        let picture = image::open(bench.path(&format!("m.{suffix}")))
            .unwrap()
            .to_rgb32f();
        assert_eq!(picture.dimensions(), (24, 16), "{suffix}");
        let brightness: f32 = picture.as_raw().iter().sum();
        assert!(brightness > 1.0, "{suffix}: daylight is dark");
    }
}

#[test]
fn the_number_of_threads_does_not_change_a_byte() {
    let bench = Bench::new(TREE);
    for threads in 1..=3 {
        let line = format!("render m.rgg -o t{threads}.png --steps 3 {SMALL} --threads {threads}");
        bench.succeed(&line);
    }
    let first = bytes(&bench.path("t1.png"));
    assert!(first == bytes(&bench.path("t2.png")) && first == bytes(&bench.path("t3.png")));
    bench.succeed(&format!("render m.rgg -o s.png --steps 3 {SMALL} --seed 2"));
    assert!(first != bytes(&bench.path("s.png")));
}

#[test]
fn a_frame_is_the_same_whichever_part_of_the_flight_is_made() {
    let bench = Bench::new(TREE);
    let fly = format!("fly m.rgg --orbit --flight-frames 12 {SMALL}");
    bench.succeed(&format!("{fly} --frames 0..6 -o all"));
    bench.succeed(&format!("{fly} --frames 2..4 -o part"));
    for frame in ["frame-000002.png", "frame-000003.png"] {
        let all = bytes(&bench.path("all").join(frame));
        assert!(all == bytes(&bench.path("part").join(frame)), "{frame}");
    }
    assert_eq!(fs::read_dir(bench.path("part")).unwrap().count(), 2);
    let (one, two) = (
        bench.path("all/frame-000000.png"),
        bench.path("all/frame-000001.png"),
    );
    assert!(bytes(&one) != bytes(&two), "the camera does not move");
}

/// C-64.
#[test]
fn a_flight_goes_on_where_it_was_and_never_over_a_stranger() {
    let bench = Bench::new(TREE);
    let fly = format!("fly m.rgg --orbit --flight-frames 12 -o f {SMALL}");
    bench.succeed(&format!("{fly} --frames 0..3"));
    let whole = bytes(&bench.path("f/frame-000001.png"));
    fs::write(bench.path("f/frame-000001.png"), &whole[..whole.len() / 2]).unwrap();
    let output = bench.run(&format!("{fly} --frames 0..4"));
    let message = text(&output.stderr);
    assert!(message.contains("2 frames made, 2 kept"), "{message}");
    assert!(bytes(&bench.path("f/frame-000001.png")) == whole);
    let output = bench.run(&format!("{fly} --frames 0..2 --seed 5"));
    assert!(
        text(&output.stderr).contains("2 frames made ("),
        "other options, other frames"
    );
    fs::write(bench.path("f/frame-000007.png"), "a diary").unwrap();
    bench.fail(&format!("{fly} --frames 7..8"), 3);
    assert_eq!(bytes(&bench.path("f/frame-000007.png")), b"a diary");
}

#[test]
fn what_a_scene_requires_is_told_kept_and_reported() {
    let bench = Bench::new(TREE);
    let told = |flags: &str| {
        let text = bench.succeed(&format!("render m.rgg --explain-scene {flags}"));
        let line = text.lines().find(|line| line.starts_with("caustics "));
        line.unwrap().to_owned()
    };
    assert!(told("--seed 1").contains("left out  no material is a mirror or glass"));
    assert!(told("--require caustics,guide").contains("kept  "));
    bench.fail("render m.rgg --explain-scene --require shadows", 2);
    let of = |command: &str| bench.succeed(&format!("{command} m.rgg --explain-scene"));
    let (all, trade, light) = (of("render"), of("trade"), of("light"));
    assert_eq!(of("export"), all);
    assert_eq!(trade.lines().count(), all.lines().count());
    assert!(
        all.contains("light)") && !trade.contains("light)"),
        "{trade}"
    );
    let names = light.lines().map(|line| line.split(' ').next().unwrap());
    let names: Vec<&str> = names.collect();
    assert_eq!(
        names,
        ["unaimed-photons", "bodies", "coordinates", "groups"]
    );
    assert!(
        light.lines().all(|line| line.ends_with("(light)")),
        "{light}"
    );
    let kept = bench.succeed("light m.rgg --explain-scene --require bodies -o none.csv");
    assert!(kept.contains("bodies           kept  "), "{kept}");
    assert!(!bench.path("none.csv").exists());
    bench.succeed("trade m.rgg --explain-scene -o none");
    assert!(!bench.path("none").exists());
    let quick = "render m.rgg --size 16x12 --samples 1 --renderer photon --global-photons 500 --caustic-photons 500";
    bench.succeed(&format!("{quick} -o a.png --report a.json"));
    bench.succeed(&format!(
        "{quick} -o b.png --report b.json --require caustics"
    ));
    let report = |name: &str| -> serde_json::Value {
        serde_json::from_slice(&bytes(&bench.path(name))).unwrap()
    };
    let (a, b) = (report("a.json"), report("b.json"));
    // The files tell their options, so they differ; what is seen does not.
    let pixels = |name: &str| image::open(bench.path(name)).unwrap().to_rgb8();
    assert!(pixels("a.png") == pixels("b.png"));
    let state = |report: &serde_json::Value| {
        let all = report["requirements"].as_array().unwrap();
        let found = all.iter().find(|fact| fact["feature"] == "caustics");
        found.unwrap()["state"].clone()
    };
    assert_eq!((state(&a), state(&b)), ("left out".into(), "kept".into()));
    assert_eq!(
        (&a["photons_emitted"], &b["photons_emitted"]),
        (&500.into(), &1000.into())
    );
}

#[test]
fn the_file_beside_the_model_counts_and_its_mistakes_are_shown() {
    let bench = Bench::new(TREE);
    bench.write(
        "m.toml",
        "steps = 2\n[render]\nsize = [20, 10]\nsamples = 3\n",
    );
    let text = bench.succeed("render m.rgg -o m.png --explain-options --samples 5");
    let line = |key: &str| text.lines().find(|line| line.starts_with(key)).unwrap();
    assert!(line("size").ends_with("m.toml:3"), "{text}");
    assert!(line("samples").ends_with("command line"), "{text}");
    assert!(line("fov").ends_with("default"), "{text}");
    bench.succeed("render m.rgg -o m.png");
    assert_eq!(
        image::open(bench.path("m.png"))
            .unwrap()
            .to_rgb8()
            .dimensions(),
        (20, 10)
    );
    bench.write("m.toml", "steps = 2\n[render]\nsampels = 3\n");
    let message = bench.fail("render m.rgg -o m.png", 1);
    assert!(
        message.contains("m.toml:3") && message.contains("`samples`"),
        "{message}"
    );
}

#[test]
fn a_report_tells_everything() {
    let bench = Bench::new(TREE);
    bench.succeed(&format!("render m.rgg -o m.png {SMALL} --report r.json"));
    bench.succeed(&format!("render m.rgg -o m.png {SMALL} --report r.json"));
    let report: serde_json::Value = serde_json::from_slice(&bytes(&bench.path("r.json"))).unwrap();
    for phase in [
        "read", "derive", "scene", "accel", "prepare", "render", "write",
    ] {
        assert!(report["seconds"][phase].is_f64(), "{phase}");
    }
    assert_eq!(report["samples_per_pixel"], 2);
    assert!(report["rays"].as_u64().unwrap() >= 24 * 16 * 2);
    assert_eq!(report["options"]["size"]["origin"], "command line");
    assert_eq!(report["version"], env!("CARGO_PKG_VERSION"));

    // Samples that are asked for on the command line win over the grid of the file.
    bench.write("m.toml", "[render]\nsupersampling = 3\n");
    let samples = |flags: &str| {
        bench.succeed(&format!("render m.rgg -o m.png {flags} --report r.json"));
        let report: serde_json::Value =
            serde_json::from_slice(&bytes(&bench.path("r.json"))).unwrap();
        report["samples_per_pixel"].as_u64().unwrap()
    };
    assert_eq!(samples(SMALL), 2);
    assert_eq!(samples("--size 24x16"), 9);
    bench.write("notes.json", "[1, 2, 3]");
    let line = format!("render m.rgg -o m.png {SMALL} --report notes.json");
    assert!(bench.fail(&line, 3).contains("not replaced"));
}

#[test]
fn derive_prints_the_graph_and_writes_the_counts() {
    let bench = Bench::new(TREE);
    let counts = bench.succeed("derive m.rgg --steps 2 --print counts");
    assert!(counts.contains("Bud") && counts.contains('4'), "{counts}");
    assert!(
        bench
            .succeed("derive m.rgg --steps 1 --print string")
            .contains("F(1")
    );
    bench.succeed("derive m.rgg --steps 2 --json c.json");
    let json: serde_json::Value = serde_json::from_slice(&bytes(&bench.path("c.json"))).unwrap();
    assert_eq!(
        (&json["step"], &json["modules"]["Bud"]),
        (&2.into(), &4.into()),
        "{json:#}"
    );
    assert!(json["total"].as_u64().unwrap() > 4 && json["hash"].is_string());
}

#[test]
fn what_a_model_prints_goes_where_it_belongs() {
    let bench = Bench::new("protected void init() { println(\"hello \" + 6 * 7); }\n");
    assert_eq!(bench.succeed("derive m.rgg --steps 0"), "hello 42\n");
    let output = bench.run(&format!("render m.rgg -o m.png --steps 0 {SMALL}"));
    assert_eq!(text(&output.stdout), "");
    assert!(
        text(&output.stderr).contains("hello 42"),
        "{}",
        text(&output.stderr)
    );
}

#[test]
fn a_reader_that_has_seen_enough_is_no_failure() {
    use std::io::{BufRead, BufReader};
    use std::process::Stdio;
    let bench = Bench::new(TREE);
    let mut child = std::process::Command::new(env!("CARGO_BIN_EXE_understory"))
        .current_dir(bench.folder.path())
        .args(["derive", "m.rgg", "--steps", "12", "--print", "tree"])
        .stdout(Stdio::piped())
        .spawn()
        .unwrap();
    let mut line = String::new();
    BufReader::new(child.stdout.take().unwrap())
        .read_line(&mut line)
        .unwrap();
    assert_eq!(child.wait().unwrap().code(), Some(0));
}

#[test]
fn warnings_are_told_and_are_no_errors() {
    let bench = Bench::new(&format!("{TREE}module Idle;\n"));
    let output = bench.run("check m.rgg");
    let told = text(&output.stderr);
    assert_eq!(output.status.code(), Some(0), "{told}");
    for part in [
        "Warning: module `Idle` is never used",
        "m.rgg:6:8",
        "m.rgg: no errors, 1 warning\n",
    ] {
        assert!(told.contains(part), "{part}\n{told}");
    }
    let output = bench.run(&format!("render m.rgg -o m.png {SMALL}"));
    assert_eq!(text(&output.stderr).matches("never used").count(), 1);
    let output = bench.run("derive m.rgg --quiet");
    assert_eq!(output.status.code(), Some(0));
    assert_eq!(text(&output.stderr), "");
}

#[test]
fn quiet_is_quiet_and_help_is_help() {
    let bench = Bench::new(TREE);
    let output = bench.run(&format!("render m.rgg -o m.png {SMALL} --quiet"));
    assert_eq!(
        (text(&output.stdout), text(&output.stderr)),
        (String::new(), String::new())
    );
    for command in ["check", "derive", "render", "watch", "fly"] {
        let help = bench.succeed(&format!("{command} --help"));
        assert!(help.contains("Example"), "{help}");
    }
    assert!(bench.succeed("--help").contains("Exit codes"));
    assert!(
        bench
            .succeed("--version")
            .contains(env!("CARGO_PKG_VERSION"))
    );
}

#[test]
fn files_in_folders_are_imported_and_missing_ones_named() {
    let bench = Bench::new(
        "import static sub.Params.*;\nmodule A(int n);\nprotected void init() [ Axiom ==> A(size); ]\n",
    );
    fs::create_dir(bench.path("sub")).unwrap();
    bench.write("sub/Params.rgg", "static int size = 7;\n");
    for model in ["m.rgg", "."] {
        let tree = bench.succeed(&format!("derive {model} --print tree"));
        assert!(tree.contains("A(7)"), "{tree}");
    }
    fs::rename(bench.path("sub/Params.rgg"), bench.path("Parms.rgg")).unwrap();
    let message = bench.fail("check m.rgg", 1);
    for word in ["`size`", "`sub/Params.rgg`", "`Parms.rgg`"] {
        assert!(message.contains(word), "{message}");
    }
    bench.write("Tool.java", "class Tool { }\n");
    bench.write("m.rgg", "protected void init() { Tool t = null; }\n");
    let message = bench.fail("check m.rgg", 1);
    assert!(message.contains("`Tool.java` is not read"), "{message}");
}

#[test]
fn texts_are_made_of_up_to_eight_values() {
    let bench = Bench::new(
        "protected void init() { println(String.format(\"%d%d%d%d%d%d%d%d\", 1, 2, 3, 4, 5, 6, 7, 8)); }\n",
    );
    assert!(bench.succeed("derive m.rgg").starts_with("12345678\n"));
}

#[test]
fn a_model_lists_the_folder_of_its_data() {
    let bench = Bench::new(
        "import java.io.*;
protected void init() {
  File folder = new File(\"data/\"); File[] found = folder.listFiles(); String[] names = folder.list();
  for (int i = 0; i < found.length; i++) {
    println(names[i] + \" \" + found[i].getName() + \" \" + new BufferedReader(new FileReader(found[i])).readLine());
  }
  println(folder.isDirectory() + \" \" + found[0].isFile() + \" \" + found[0].getParent() + \" \" + new File(\"x\").exists());
  println(new File(\"none\").listFiles() == null);
}",
    );
    fs::create_dir_all(bench.path("data")).unwrap();
    for name in ["b.csv", "a.csv", ".hidden"] {
        bench.write(&format!("data/{name}"), name);
    }
    let printed = bench.succeed("derive m.rgg --steps 0");
    let expected = "a.csv a.csv a.csv\nb.csv b.csv b.csv\ntrue true data false\ntrue\n";
    assert!(printed.contains(expected), "{printed}");
    bench.write(
        "m.rgg",
        "protected void init() { new java.io.File(\"/etc\").list(); }",
    );
    let message = bench.fail("derive m.rgg --steps 0", 1);
    assert!(message.contains("--allow-path"), "{message}");
}

/// A model that reads a table from a place of its author's machine, counts its lines, and writes beside it.
const FROM_AFAR: &str = "import java.io.*;
protected void init() {
  BufferedReader r = new BufferedReader(new FileReader(\"C:\\\\Users\\\\me\\\\data\\\\in.csv\"));
  int n = 0; while (r.readLine() != null) n++;
  println(\"lines \" + n);
  PrintWriter w = new PrintWriter(new FileWriter(\"C:/Users/me/data/out.csv\")); w.println(n); w.close();
}";

#[test]
fn a_path_map_leads_foreign_paths_to_a_folder_of_the_user() {
    let bench = Bench::new(FROM_AFAR);
    fs::create_dir_all(bench.path("own")).unwrap();
    bench.write("own/in.csv", "a\nb\nc\n");
    let message = bench.fail("derive m.rgg --steps 0", 1);
    assert!(message.contains("--path-map"), "{message}");
    assert!(message.contains("m.rgg:3:"), "{message}");
    let printed = bench.succeed("derive m.rgg --steps 0 --path-map C:/Users/me/data=own");
    assert!(printed.contains("lines 3"), "{printed}");
    assert_eq!(
        fs::read_to_string(bench.path("own/out.csv"))
            .unwrap()
            .trim(),
        "3"
    );
    assert!(!bench.files().iter().any(|name| name.contains("Users")));
    let message = bench.fail("derive m.rgg --steps 0 --path-map nonsense", 2);
    assert!(message.contains("nonsense"), "{message}");
}

#[test]
fn nothing_outside_of_the_folder_is_touched_unless_it_is_allowed() {
    let outside = tempfile::tempdir().unwrap();
    let place = outside.path().display().to_string();
    fs::write(outside.path().join("in.txt"), "seen\n").unwrap();
    let bench = Bench::new(&format!(
        "import java.io.*;
protected void init() {{
  println(new BufferedReader(new FileReader(\"{place}/in.txt\")).readLine());
  PrintWriter w = new PrintWriter(new FileWriter(\"{place}/out.txt\")); w.println(\"written\"); w.close();
}}"
    ));
    let message = bench.fail("derive m.rgg --steps 0", 1);
    assert!(message.contains("--allow-path"), "{message}");
    assert!(message.contains("outside of its folder"), "{message}");
    assert!(!outside.path().join("out.txt").exists());
    let printed = bench.succeed(&format!("derive m.rgg --steps 0 --allow-path {place}"));
    assert!(printed.contains("seen"), "{printed}");
    let written = fs::read_to_string(outside.path().join("out.txt")).unwrap();
    assert_eq!(written.trim(), "written");
    // A neighbour whose name only begins alike is not allowed with it.
    fs::create_dir_all(outside.path().join("a")).unwrap();
    fs::create_dir_all(outside.path().join("ab")).unwrap();
    fs::write(outside.path().join("ab/in.txt"), "x").unwrap();
    bench.write(
        "m.rgg",
        &format!("protected void init() {{ new java.io.FileReader(\"{place}/ab/in.txt\"); }}"),
    );
    bench.fail(&format!("derive m.rgg --steps 0 --allow-path {place}/a"), 1);
    bench.fail(
        &format!("derive m.rgg --steps 0 --allow-path {place}/a/../a"),
        1,
    );
    bench.succeed(&format!("derive m.rgg --steps 0 --allow-path {place}/ab"));
}

#[test]
fn charts_are_written_where_they_are_wanted() {
    let bench = Bench::new(
        "module A(float x);
DatasetRef sizes = new DatasetRef(\"sizes\");
protected void init() [ { sizes.clear(); sizes.setColumnKey(0, \"length\"); chart(sizes, XY_PLOT); } Axiom ==> A(1); ]
public void run() [ A(x) ==> A(2 * x); { sizes.addRow().set(0, sum((* A *)[x])); } ]",
    );
    bench.succeed("derive m.rgg --steps 3");
    assert_eq!(bench.files(), BTreeSet::from(["m.rgg".to_owned()]));
    bench.succeed("derive m.rgg --steps 3 --charts plots");
    let names: BTreeSet<String> = fs::read_dir(bench.path("plots"))
        .unwrap()
        .map(|entry| entry.unwrap().file_name().to_string_lossy().into_owned())
        .collect();
    assert_eq!(
        names,
        BTreeSet::from(["sizes.csv".to_owned(), "sizes.svg".to_owned()])
    );
    let table = fs::read_to_string(bench.path("plots/sizes.csv")).unwrap();
    let lines: Vec<&str> = table.lines().collect();
    assert!(lines[0].contains("length"), "{table}");
    assert_eq!(lines.len(), 4, "{table}");
    assert!(
        lines[3].contains('4'),
        "the sum before the third step is applied: {table}"
    );
    let drawing = fs::read_to_string(bench.path("plots/sizes.svg")).unwrap();
    assert!(
        drawing.starts_with("<svg") || drawing.starts_with("<?xml"),
        "{drawing}"
    );
    assert!(drawing.contains("length"), "{drawing}");
}

/// Some of the quickest checks.
const QUICK: &str = "body";

#[test]
fn checks_are_chosen_by_name_and_kept_in_a_file() {
    let bench = Bench::new(TREE);
    let shown = bench.succeed(&format!("validate --only {QUICK} --json c.json --seed 7"));
    let json: serde_json::Value = serde_json::from_slice(&bytes(&bench.path("c.json"))).unwrap();
    let checks = json["checks"].as_array().unwrap();
    assert!(!checks.is_empty());
    // What is shown and what is kept are the same checks, and only those asked for.
    assert_eq!(shown.lines().count(), 1 + checks.len(), "{shown}");
    for (check, line) in checks.iter().zip(shown.lines().skip(1)) {
        let id = check["id"].as_str().unwrap();
        assert!(id.starts_with(QUICK) && line.starts_with(&format!("ok    {id}")));
        assert_eq!(check["ok"], true);
        assert!(
            check["expected"].is_f64() && check["measured"].is_f64(),
            "{check}"
        );
    }
    assert_eq!((&json["failed"], &json["seed"]), (&0.into(), &7.into()));
    assert_eq!(json["validated"], env!("CARGO_PKG_VERSION"));
    // Its own file is replaced, that of another is not.
    bench.succeed(&format!("validate --only {QUICK} --json c.json"));
    bench.write("notes.json", "[1, 2, 3]");
    let line = format!("validate --only {QUICK} --json notes.json");
    assert!(bench.fail(&line, 3).contains("not replaced"));
    let line = format!("validate --only {QUICK} --json no/such/folder.json");
    assert!(bench.fail(&line, 3).contains("no/such"));
}

#[test]
fn a_check_that_does_not_exist_is_a_usage_error_that_names_those_there_are() {
    let bench = Bench::new(TREE);
    let message = bench.fail("validate --only furnance --json c.json", 2);
    for word in ["`furnance`", "factor, lamp", "furnace", "sphere", "stack"] {
        assert!(message.contains(word), "{word}: {message}");
    }
    assert!(!bench.path("c.json").exists());
    // Every beginning that the message names is one.
    let names = message.trim().rsplit("begin with ").next().unwrap();
    assert!(
        names
            .split(", ")
            .all(|name| name.chars().all(char::is_lowercase)),
        "{names}"
    );
    let help = bench.succeed("validate --help");
    for code in ["0 all hold", "1 one differs", "2 no check", "3 a file"] {
        assert!(help.contains(code), "{code}: {help}");
    }
}

#[test]
fn the_extremes_are_kept_in_a_file_and_a_page() {
    let bench = Bench::new(TREE);
    let line = "validate --extremes --only C-63 --json c.json --page c.html";
    let shown = bench.succeed(line);
    let json: serde_json::Value = serde_json::from_slice(&bytes(&bench.path("c.json"))).unwrap();
    assert_eq!(
        (&json["failed"], &json["effort"]),
        (&0.into(), &"short".into())
    );
    let cases = json["cases"].as_array().unwrap();
    assert_eq!((cases.len(), &cases[0]["id"]), (1, &"C-63".into()));
    assert!(
        shown.lines().nth(1).unwrap().starts_with("ok    C-63"),
        "{shown}"
    );
    for check in cases[0]["checks"].as_array().unwrap() {
        assert!(check["ok"] == true && check["seconds"].is_f64(), "{check}");
        assert!(check["measured"].is_f64() && check["tolerance"].is_f64());
    }
    // The page needs nothing from elsewhere.
    let page = text(&bytes(&bench.path("c.html")));
    assert!(page.starts_with("<!doctype html>") && page.contains("C-63-zero"));
    for link in ["http:", "https:", "src=", "url(", "<script"] {
        assert!(!page.contains(link), "{link}");
    }
    // Its own page is replaced, that of another is not.
    bench.succeed(line);
    bench.write("notes.html", "<!doctype html>\n<p>mine</p>\n");
    let other = "validate --extremes --only C-63 --page notes.html";
    assert!(bench.fail(other, 3).contains("not replaced"));
    let message = bench.fail("validate --extremes --only C-73", 2);
    assert!(message.contains("C-1 to C-72"), "{message}");
    assert!(
        bench
            .fail("validate --page c.html", 2)
            .contains("--extremes")
    );
}

/// Photons that cost nothing.
const FEW: &str = "--global-photons 1000 --caustic-photons 1000";

/// A lamp over a floor, with what else is there.
fn lit_floor(more: &str) -> String {
    format!(
        "protected void init() [ Axiom ==> [ Translate(0, 1, 0) Rotate(90, 0, 0) Parallelogram(2, 2) ]\n\
         [ Translate(0, 0, 2) LightNode().(setLight(new PointLight().(setPower(100)))) ] {more}; ]\n"
    )
}

#[test]
fn light_that_a_picture_lacks_is_told_and_kept_in_the_report() {
    let glass = "[ Translate(0, 0, 1) Sphere(0.3).(setShader(new Glass(1.5))) ]";
    let told = "light that smooth curved glass throws onto other surfaces is missing";
    let look = |model: &str, renderer: &str| {
        let bench = Bench::new(model);
        let line =
            format!("render m.rgg -o m.png {SMALL} --renderer {renderer} {FEW} --report r.json");
        let output = bench.run(&line);
        let message = text(&output.stderr);
        assert_eq!(output.status.code(), Some(0), "{message}");
        let report: serde_json::Value =
            serde_json::from_slice(&bytes(&bench.path("r.json"))).unwrap();
        (message, report["warnings"].clone())
    };
    let (message, warnings) = look(&lit_floor(glass), "path");
    for part in [
        &format!("Warning: {told}") as &str,
        "`path` does not find light of a point, spot or parallel light",
        "a lamp with extent (an `AreaLight`) or rough glass gives a complete picture",
    ] {
        assert!(message.contains(part), "{part}\n{message}");
    }
    assert_eq!(message.matches(told).count(), 1, "{message}");
    let warnings = warnings.as_array().unwrap();
    assert!(warnings.len() == 1 && warnings[0].as_str().unwrap().starts_with(told));
    let radiosity = "radiosity --hemicube-pixels 2 --subdivision-depth 0";
    let (message, _) = look(&lit_floor(glass), radiosity);
    assert!(
        message.contains(told) && message.contains("`radiosity` does not find"),
        "{message}"
    );
    // Without glass nothing is missing; photons find what comes through it.
    for (model, renderer) in [(lit_floor(""), "path"), (lit_floor(glass), "photon")] {
        let (message, warnings) = look(&model, renderer);
        assert!(!message.contains("is missing"), "{renderer}\n{message}");
        assert_eq!(warnings, serde_json::json!([]), "{renderer}");
    }
}

/// C-18: a closed room in which no light is lost has no solution, which is said with what is missing.
#[test]
fn a_room_without_a_solution_is_told() {
    let look = |brightness: &str| {
        let bench = Bench::new(&format!(
            "protected void init() [ Axiom ==> [ Box(2, 2, 2).(setShader(new RGBAShader({brightness}))) ]\n\
             [ Translate(0, 0, 1) LightNode().(setLight(new PointLight().(setPower(100)))) ]; ]\n"
        ));
        let line = "render m.rgg -o m.png --size 8x8 --samples 1 --renderer radiosity --hemicube-pixels 2 --subdivision-depth 0";
        let output = bench.run(&format!("{line} --report r.json"));
        assert_eq!(output.status.code(), Some(0), "{}", text(&output.stderr));
        let report: serde_json::Value =
            serde_json::from_slice(&bytes(&bench.path("r.json"))).unwrap();
        (
            text(&output.stderr),
            report["solver_residual"].as_f64().unwrap(),
        )
    };
    let told = "radiosity did not converge";
    let (message, residual) = look("1, 1, 1");
    assert!(
        message.contains(told) && residual > 0.01,
        "{residual}\n{message}"
    );
    assert!(
        message.contains(&format!("{:.2} % of all light", 100.0 * residual)),
        "{message}"
    );
    let (message, residual) = look("0.9, 0.9, 0.9");
    assert!(!message.contains(told), "{message}");
    assert!(residual > 0.0 && residual <= 1e-3, "{residual}");
}

/// A bead that next to no photon meets, beside a ball of glass that thousands do, and a lamp that sends hardly any, are told with what to do.
#[test]
fn what_too_few_photons_stand_for_is_told() {
    let look = |bead: &str, dim: &str, photons: &str| {
        let bench = Bench::new(&format!(
            "protected void init() [ Axiom ==> [ Box(0.1, 4, 4) ]\n\
             [ Translate(0, 0, 1) Sphere(0.5).(setShader(new Glass(1.5))) ]\n\
             [ Translate(1, 0, 1) Sphere({bead}).(setShader(new Glass(1.5))) ]\n\
             [ Translate(0, 1, 4) LightNode().(setLight(new PointLight().(setPower(100)))) ]\n\
             [ Translate(0, 0, 3) LightNode().(setLight(new PointLight().(setPower({dim})))) ]; ]\n"
        ));
        let line = "render m.rgg -o m.png --size 8x8 --samples 1 --renderer photon";
        let output = bench.run(&format!("{line} {photons}"));
        assert_eq!(output.status.code(), Some(0), "{}", text(&output.stderr));
        text(&output.stderr)
    };
    let photons = "--global-photons 20000 --caustic-photons 20000";
    let message = look("0.2", "1", photons);
    assert!(!message.contains("fewer than 100 photons"), "{message}");
    let message = look("0.002", "1", photons);
    let told = "mirrors and glass that were met by fewer than 100 photons: 1 of 2 (";
    assert!(
        message.contains(told) && message.contains("`--caustic-photons"),
        "{message}"
    );
    assert!(!message.contains("light sources"), "{message}");
    let message = look(
        "0.2",
        "1e-9",
        "--global-photons 1000 --caustic-photons 20000",
    );
    let told = "light sources that sent fewer than 100 photons: 1 of 2 (";
    assert!(
        message.contains(told) && message.contains("use `--global-photons"),
        "{message}"
    );
    assert!(!message.contains("mirrors and glass"), "{message}");
}

#[test]
fn plants_are_numbered_and_their_errors_reached() {
    let bench = Bench::new(
        "module Stem extends F(0.5, 0.1);\n\
         protected void init() [ Axiom ==> [ Plane() ] for (int i : 0:2) ([ Translate(i, 0, 0) Stem [ RU(60) Stem ] ]); ]\n",
    );
    bench.succeed("light m.rgg -o o.csv --photons 4000 --plant-error 5% --report r.json");
    let table = fs::read_to_string(bench.path("o.csv")).unwrap();
    let mut rows = table
        .lines()
        .map(|line| line.split(',').collect::<Vec<_>>());
    let head = rows.next().unwrap();
    let column = |name: &str| head.iter().position(|at| *at == name).unwrap();
    let (module, plant) = (column("module"), column("plant"));
    let found: Vec<(String, String)> = rows
        .map(|row| (row[module].to_owned(), row[plant].to_owned()))
        .collect();
    let stem = |n: &str| ("Stem".to_owned(), n.to_owned());
    // The ground is no plant; the two stems of each are one.
    let mut expected = Vec::new();
    for n in ["0", "1", "2"] {
        expected.extend([stem(n), stem(n)]);
    }
    expected.push(("Plane".to_owned(), String::new()));
    assert_eq!(found, expected, "{table}");
}
