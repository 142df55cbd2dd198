//! How soon `watch` answers: the real program, its page, and a clock.
//!
//! `cargo bench --bench watch` measures models of about 1,000, 100,000 and 6 million modules: from saving to the first picture
//! fetched and to the diagnostics, from a move of the camera to its picture, and how soon each stage stops when its work has
//! become useless; at the end all of it once more as the table of the README. `cargo bench --bench watch -- saves 10000` saves a small model so often and prints the memory on the way.
#![allow(clippy::print_stdout, reason = "a benchmark prints its result")]
#![allow(clippy::unwrap_used, reason = "a benchmark fails by panicking")]

#[path = "../tests/support/visitor.rs"]
mod visitor;

use serde_json::Value;
use std::fs;
use std::io::{BufRead, BufReader};
use std::path::PathBuf;
use std::process::{Child, Command, Stdio};
use std::time::{Duration, Instant};
use tempfile::TempDir;
use visitor::{Events, Visitor};

/// Moves of the camera, and saves, of which the median is told.
const REPEATS: u32 = 9;

/// A plant of about 6 · 2^steps modules.
fn plant(angle: f64) -> String {
    format!(
        "module A(float x);\nprotected void init() [ Axiom ==> A(1); ]\npublic void run() [ A(x) ==> \
         F(x, 0.08 * x) [RU({angle:?}) RH(90) A(0.75 * x)] [RU(-35.0) RH(60) A(0.7 * x)]; ]\n"
    )
}

/// A running `watch` with who looks at it.
struct Session {
    folder: TempDir,
    child: Child,
    visitor: Visitor,
    events: Events,
}

impl Session {
    fn start(steps: u32, more: &[&str]) -> Self {
        let folder = tempfile::tempdir().unwrap();
        fs::write(folder.path().join("m.rgg"), plant(30.0)).unwrap();
        let mut child = Command::new(env!("CARGO_BIN_EXE_understory"))
            .current_dir(folder.path())
            .args([
                "watch",
                "m.rgg",
                "--port",
                "0",
                "--steps",
                &steps.to_string(),
            ])
            .args(more)
            .stderr(Stdio::piped())
            .spawn()
            .unwrap();
        let mut lines = BufReader::new(child.stderr.take().unwrap()).lines();
        let line = lines.find(|line| line.as_ref().unwrap().contains("localhost:"));
        let line = line.unwrap().unwrap();
        let port = line.split("localhost:").nth(1).unwrap();
        let port = port.split('/').next().unwrap().parse().unwrap();
        std::thread::spawn(move || lines.for_each(drop));
        let visitor = Visitor { port };
        Self {
            folder,
            child,
            visitor,
            events: visitor.events(),
        }
    }

    fn model(&self) -> PathBuf {
        self.folder.path().join("m.rgg")
    }

    fn ask(&self, options: &str) {
        let answer = self
            .visitor
            .post("/wish", &format!("{{\"options\":{{{options}}}}}"));
        assert_eq!(answer.status, 204, "{}", answer.text());
    }

    /// Waits for a picture after this one, fetches it, and gives its number.
    fn picture_after(&mut self, last: u64) -> u64 {
        let newer = |state: &Value| state["frame"]["number"].as_u64() > Some(last);
        loop {
            let state = self.events.until("a picture", newer);
            let number = state["frame"]["number"].as_u64().unwrap();
            let answer = self.visitor.get(&format!("/frame/{number}"));
            if answer.status == 200 {
                assert!(answer.head.contains("image/"), "{}", answer.head);
                return number;
            }
        }
    }

    /// Waits until a picture is as good as it was asked for; its number.
    fn rest(&mut self) -> u64 {
        let state = self.events.whole("a whole picture", |_| true);
        state["frame"]["number"].as_u64().unwrap()
    }

    /// Resident memory in bytes.
    fn memory(&self) -> u64 {
        let status = fs::read_to_string(format!("/proc/{}/status", self.child.id())).unwrap();
        let line = status.lines().find_map(|line| line.strip_prefix("VmRSS:"));
        let kibibytes = line.unwrap().trim().trim_end_matches(" kB");
        kibibytes.parse::<u64>().unwrap() * 1024
    }
}

impl Drop for Session {
    fn drop(&mut self) {
        let _ = self.child.kill();
        let _ = self.child.wait();
    }
}

fn median(mut times: Vec<Duration>) -> Duration {
    times.sort();
    times[times.len() / 2]
}

/// What was measured of one model, in milliseconds, by the name of its row.
#[derive(Default)]
struct Column {
    rows: Vec<(String, f64)>,
}

impl Column {
    /// Prints a figure and keeps it for the table.
    fn tell(&mut self, row: &str, milliseconds: f64) {
        println!("  {row:<32} {milliseconds:>8.1} ms");
        self.rows.push((row.to_owned(), milliseconds));
    }
}

/// Prints all columns as a table of Markdown; a row that a column lacks stays empty there.
fn table(columns: &[(&str, Column)]) {
    let names: Vec<&str> = columns.iter().map(|(name, _)| *name).collect();
    println!("\n| `cargo bench --bench watch` | {} |", names.join(" | "));
    println!("|---|{}", "---|".repeat(columns.len()));
    let mut rows: Vec<&str> = vec![];
    for (row, _) in columns.iter().flat_map(|(_, column)| &column.rows) {
        if !rows.contains(&row.as_str()) {
            rows.push(row);
        }
    }
    for row in rows {
        let cells = columns.iter().map(|(_, column)| {
            let figure = column.rows.iter().find(|(name, _)| name == row);
            figure.map_or(String::new(), |(_, ms)| match *ms {
                ms if ms < 10.0 => format!("{ms:.1} ms"),
                ms if ms < 1000.0 => format!("{ms:.0} ms"),
                ms => format!("{:.2} s", ms / 1000.0),
            })
        });
        println!("| {row} | {} |", cells.collect::<Vec<_>>().join(" | "));
    }
}

/// A picture that is done in a moment, so that what is measured begins at rest.
const QUICK: &[&str] = &["--samples", "1", "--renderer", "raytracer"];

/// From a save to its first picture: with the time that growing, drawing and building took of it.
fn saving(column: &mut Column, steps: u32, repeats: u32) {
    let mut session = Session::start(steps, QUICK);
    let mut last = session.rest();
    let (mut times, mut stages) = (Vec::new(), 0.0);
    for n in 1..=repeats {
        let text = plant(30.0 + f64::from(n));
        let start = Instant::now();
        fs::write(session.model(), text).unwrap();
        last = session.picture_after(last);
        times.push(start.elapsed());
        let round = u64::from(n) + 1;
        let state = session
            .events
            .whole("the end of it", |state| state["round"] == round);
        last = last.max(state["frame"]["number"].as_u64().unwrap());
        let seconds = &state["seconds"];
        let phase = |name: &str| seconds[name].as_f64().unwrap();
        stages = phase("read") + phase("derive") + phase("scene") + phase("accel");
    }
    let first = median(times);
    column.tell("save to first picture", 1e3 * first.as_secs_f64());
    column.tell("of which growing and building", 1e3 * stages);

    let mut times = Vec::new();
    for n in 0..REPEATS {
        let broken = plant(30.0).replace("A(1)", &format!("B{n}(1)"));
        let start = Instant::now();
        fs::write(session.model(), broken).unwrap();
        let name = format!("B{n}");
        session.events.until("a diagnostic", |state| {
            let problem = &state["problems"][0]["message"];
            problem
                .as_str()
                .is_some_and(|message| message.contains(&name))
        });
        times.push(start.elapsed());
    }
    let time = 1e3 * median(times).as_secs_f64();
    column.tell("save to diagnostics", time);
}

/// From a move of the camera to its picture.
fn dragging(column: &mut Column, steps: u32) {
    let mut session = Session::start(steps, &["--quality", "draft"]);
    let mut last = session.rest();
    let mut times = Vec::new();
    for n in 0..REPEATS {
        let eye = format!(
            "\"eye\":\"{},-8,3\",\"target\":\"0,0,1.5\"",
            f64::from(n) / 4.0
        );
        let start = Instant::now();
        session.ask(&eye);
        last = session.picture_after(last);
        times.push(start.elapsed());
        // The next move comes while the picture is made better.
        std::thread::sleep(Duration::from_millis(100));
    }
    let time = 1e3 * median(times).as_secs_f64();
    column.tell("drag to picture", time);
}

/// How soon each stage stops once a wish makes its work useless.
fn cancelling(column: &mut Column, steps: u32, stages: &[&str]) {
    let photons = ["--renderer", "photon", "--global-photons", "3000000"];
    let mut session = Session::start(steps, &photons);
    let told = |session: &mut Session, stage: &str| {
        let stage = stage.to_owned();
        session
            .events
            .until("the stage", |state| state["activity"]["busy"] == *stage);
    };
    for (n, stage) in stages.iter().enumerate() {
        told(&mut session, stage);
        // Somewhere inside of it.
        std::thread::sleep(Duration::from_millis(20));
        let start = Instant::now();
        // Another seed makes all there is useless.
        session.ask(&format!("\"seed\":\"{}\"", n + 2));
        session
            .events
            .until("the wish", |state| state["is_queued"] == true);
        session
            .events
            .until("work on it", |state| state["is_queued"] == false);
        let time = 1e3 * start.elapsed().as_secs_f64();
        column.tell(&format!("{stage} stops"), time);
    }
}

/// Memory over many saves.
fn saves(count: u32) {
    let mut session = Session::start(6, &["--samples", "1", "--size", "60x40"]);
    session.rest();
    let mut first = 0;
    for n in 1..=count {
        let text = match n % 10 {
            9 => "module A(".to_owned(),
            _ => plant(f64::from(n % 90)),
        };
        fs::write(session.model(), text).unwrap();
        let round = u64::from(n) + 1;
        session.events.until("an end of it", |state| {
            let is_over = state["activity"] == "done" || state["activity"] == "failed";
            is_over && state["round"] == round
        });
        if n == 100 {
            first = session.memory();
        }
        if n.is_multiple_of((count / 10).max(1)) {
            let memory = session.memory() as f64 / f64::from(1 << 20);
            println!("  after {n:>6} saves  {memory:>7.1} MiB");
        }
    }
    let growth = session.memory() as f64 / first.max(1) as f64 - 1.0;
    println!("  since save 100      {:>+7.1} %", 100.0 * growth);
}

fn main() {
    let words: Vec<String> = std::env::args()
        .skip(1)
        .filter(|w| w != "--bench")
        .collect();
    if let [what, count] = words.as_slice()
        && what == "saves"
    {
        println!("memory of a session");
        return saves(count.parse().unwrap());
    }
    let mut columns = vec![];
    for (name, steps, repeats) in [
        ("1,000 modules", 7, REPEATS),
        ("100,000 modules", 14, REPEATS),
        ("6 million modules", 20, 1),
    ] {
        if words.first().is_some_and(|word| !name.contains(word)) {
            continue;
        }
        println!("{name}");
        let mut column = Column::default();
        saving(&mut column, steps, repeats);
        dragging(&mut column, steps);
        let all = [
            "rendering",
            "preparing",
            "growing",
            "drawing",
            "building the scene",
        ];
        // The stages of small models are over before they could be stopped.
        let stages = match steps {
            20 => &all[..],
            _ => &all[..2],
        };
        cancelling(&mut column, steps, stages);
        columns.push((name, column));
    }
    table(&columns);
}
