//! What every setting of every method costs and gives, over a corpus of scenes: the table that presets are points of.
//!
//! `cargo bench --bench corpus` takes four minutes for each scene (`-- SECONDS` says otherwise) and writes `tests/corpus.csv`, which
//! `tests/presets.rs` judges the presets by. `-- only=door` measures the scenes with that in their name and leaves the others as they were;
//! what was measured before (in the folder for temporary files) is taken over, so that more seconds go on from there. Seconds are for a picture of the size that the scene asks for, measured at 96 pixels.
#![allow(clippy::print_stdout, reason = "a benchmark prints its result")]
#![allow(clippy::unwrap_used, reason = "a benchmark may panic")]

use std::fmt::Write;
use std::path::Path;
use std::sync::Arc;
use understory::integrator::CancelToken;
use understory::options::{Options, Origin};
use understory::pipeline::audience::Silent;
use understory::pipeline::studio::{Keep, Studio};
use understory::pipeline::world::Machine;
use understory::trade::results::Findings;
use understory::trade::{Folder, Means, Plan, measure};

/// The nine scenes of the study, a tree, a row of a crop, a stand and a forest.
const CORPUS: [&str; 13] = [
    "study/ring",
    "study/cornell",
    "study/concave_mirror",
    "study/four_lights",
    "study/three_columns",
    "study/half_open_door",
    "study/two_spheres",
    "study/three_cubes",
    "study/complex_room",
    "spruce",
    "crop",
    "dieback",
    "forest",
];

/// Longer side of the pictures.
const SIDE: f64 = 96.0;
const TABLE: &str = "tests/corpus.csv";

fn main() {
    let mut budget = 240.0;
    let mut only = String::new();
    for word in std::env::args().skip(1) {
        match (word.parse(), word.strip_prefix("only=")) {
            (Ok(seconds), _) => budget = seconds,
            (_, Some(name)) => only = name.into(),
            _ => {}
        }
    }
    let path = Path::new(env!("CARGO_MANIFEST_DIR")).join(TABLE);
    let before = std::fs::read_to_string(&path).unwrap_or_default();
    let mut table = String::from("scene,method,seconds,error,settings\n");
    for scene in CORPUS {
        if !scene.contains(&only) {
            let is_of_it = |line: &&str| line.split(',').next() == Some(scene);
            let rows = before.lines().filter(is_of_it);
            table.extend(rows.flat_map(|row| [row, "\n"]));
            continue;
        }
        let findings = find(scene, budget);
        let begin = table.len();
        for ladder in &findings.families {
            for rung in &ladder.rungs {
                let settings = rung
                    .settings
                    .iter()
                    .map(|(key, value)| format!("{key}={value}"));
                let settings: Vec<String> = settings.collect();
                let _ = writeln!(
                    table,
                    "{scene},\"{}\",{:.4},{:.5},{}",
                    ladder.name,
                    rung.seconds(1, findings.scale),
                    rung.resolved_error().sqrt(),
                    settings.join(" ")
                );
            }
            if let Some(end) = &ladder.end {
                println!("{scene}: {} ends: {end}", ladder.name);
            }
        }
        print!("{}", &table[begin..]);
    }
    std::fs::write(path, table).unwrap();
}

fn find(scene: &str, budget: f64) -> Findings {
    let world = Machine::new();
    let path = Path::new(env!("CARGO_MANIFEST_DIR")).join(format!("examples/{scene}.rgg"));
    let folder = std::env::temp_dir()
        .join("understory-corpus")
        .join(scene.replace('/', "-"));
    std::fs::create_dir_all(folder.parent().unwrap()).unwrap();
    let folder = Folder::open(&world, &folder).unwrap();
    let cancel = CancelToken::default();
    let mut studio = Studio::new(&world, Arc::new(Silent), path, Keep::Last);
    let opened = studio.read(&Options::default()).unwrap();
    let size = opened.options.size.value;
    let scale = SIDE / f64::from(size.width.max(size.height));
    let side = |pixels: u32| (f64::from(pixels) * scale).round();
    let mut flags = Options::default();
    let small = format!("{}x{}", side(size.width), side(size.height));
    flags.set("size", &small, Origin::Flag).unwrap();
    let opened = studio.read(&flags).unwrap();
    let run = studio.check(opened).unwrap();
    let plan = Plan { budget, seeds: 2 };
    let means = Means {
        world: &world,
        audience: &Silent,
        cancel: &cancel,
    };
    let findings = measure(&mut studio, &run, (&folder, plan), means).unwrap();
    Findings {
        scale: 1.0 / (scale * scale),
        ..findings
    }
}
