//! Growth that begins where an edit first matters: the result is that of a growth from the beginning, byte by byte.

#![allow(clippy::unwrap_used, reason = "a test fails by panicking")]

use std::fs;
use std::path::{Path, PathBuf};
use std::sync::{Arc, Mutex};
use tempfile::TempDir;
use understory::diag::{Diagnostics, SourceMap};
use understory::growth::Growth;
use understory::integrator::CancelToken;
use understory::options::{Options, Origin};
use understory::pipeline::audience::Audience;
use understory::pipeline::studio::{Keep, Studio};
use understory::pipeline::world::Machine;

/// Keeps what a model prints.
#[derive(Default)]
struct Listener {
    printed: Mutex<String>,
}

impl Audience for Listener {
    fn printed(&self, text: &str) {
        self.printed.lock().unwrap().push_str(text);
    }

    fn warned(&self, _: &SourceMap, _: &Diagnostics) {}

    fn begins(&self, _: &'static str) {}

    fn progress(&self, _: u64, _: u64) {}

    fn ends(&self) {}
}

/// A studio that keeps what it can, over a model that is edited.
struct Desk<'w> {
    folder: TempDir,
    world: &'w Machine,
    listener: Arc<Listener>,
    studio: Studio<'w>,
}

impl<'w> Desk<'w> {
    fn new(world: &'w Machine) -> Self {
        let folder = tempfile::tempdir().unwrap();
        let (path, listener) = (folder.path().join("m.rgg"), Arc::new(Listener::default()));
        let studio = Studio::new(world, listener.clone(), path, Keep::All);
        Self {
            folder,
            world,
            listener,
            studio,
        }
    }

    fn path(&self) -> PathBuf {
        self.folder.path().join("m.rgg")
    }

    /// Grows this text by so many steps; `None` if it is no model.
    fn grow(&mut self, text: &str, steps: &str) -> Option<Grown> {
        fs::write(self.path(), text).unwrap();
        self.listener.printed.lock().unwrap().clear();
        let growth = grow(&mut self.studio, steps)?;
        Some(Grown::of(growth, &self.listener))
    }

    /// As if it were the first time.
    fn afresh(&self, text: &str, steps: &str) -> Option<Grown> {
        fs::write(self.path(), text).unwrap();
        let listener = Arc::new(Listener::default());
        let mut studio = Studio::new(self.world, listener.clone(), self.path(), Keep::Last);
        let growth = grow(&mut studio, steps)?;
        Some(Grown::of(growth, &listener))
    }
}

/// `options` is the number of steps, or that and the seed: `8 seed 2`.
fn grow(studio: &mut Studio<'_>, options: &str) -> Option<Result<Growth, String>> {
    let (steps, seed) = options.split_once(" seed ").unwrap_or((options, "1"));
    let mut flags = Options::default();
    flags.set("steps", steps, Origin::Flag).unwrap();
    flags.set("seed", seed, Origin::Flag).unwrap();
    let opened = studio.read(&flags).unwrap();
    let run = studio.check(opened).ok()?;
    let grown = studio.grow(&run, &CancelToken::default());
    Some(grown.map_err(|failure| format!("{failure:?}")))
}

/// All that can be told of a growth: its graph now and two steps on, with what it printed.
#[derive(Debug, PartialEq)]
struct Grown(Result<[String; 3], String>);

impl Grown {
    fn of(growth: Result<Growth, String>, listener: &Listener) -> Self {
        Self(growth.map(|mut growth| {
            let now = growth.tree_text();
            // What does not show yet (the generator, variables, the order of nodes) shows then.
            let later = match growth.run(2) {
                Ok(()) => growth.tree_text(),
                Err(fault) => fault.message.clone(),
            };
            let printed = listener.printed.lock().unwrap().clone();
            [now, later, printed]
        }))
    }
}

/// Rules that begin to matter in different steps, methods that are called late, constants, chance, shared objects, output.
const PLANT: &str = "const float LENGTH = 0.5;
const float LATE = 2 * LENGTH;
const RGBAShader BARK = new RGBAShader(0.2, 0.1, 0.1);
const Phong PETAL = new Phong().(setDiffuse(new RGBColor(0.4, 0.1, 0.3)));
module Bud(int age);
module Side(float vigour);
module Flower(float size);
module Leaf(float size) ==> F(0.1 * size) Parallelogram(size, 0.5);
int day = 0;
float[] sums = new float[3];
List<Float> seen = new ArrayList<Float>();
protected void init() {
  day = 0;
  [ Axiom ==> Bud(0); ]
}
void tell(int n) {
  println(\"day \" + n + \" \" + sums[n % 3]);
}
void flowering() [
  Flower(s), (s < 0.9) ==> Flower(1.5 * s);
  Leaf(s), (probability(0.3)) ==> Leaf(s + 0.01);
]
public void run() {
  day++;
  sums[day % 3] += random(0, 1);
  [
    Bud(a), (a < 3) ==> F(LENGTH) [RU(30) Side(1)] Bud(a + 1);
    Bud(a), (a >= 3) ==> F(LATE, 0.1).(setShader(BARK)) Bud(a + 1);
    Side(v), (v > 0.5) ==> F(0.3) [Leaf(0.2 + random(0, 0.1))] Side(0.8 * v);
    Side(v) ==> Flower(0.1);
  ]
  if (day > 5) {
    flowering();
  }
  if (day % 4 == 0) {
    seen.add(day);
    tell(day);
  }
}
";

#[test]
fn growth_begins_at_the_first_step_that_differs() {
    let world = Machine::new();
    let mut desk = Desk::new(&world);
    let mut text = PLANT.to_owned();
    let mut counts = (0, 0);
    // What is replaced by what, how many steps are grown, and how many of them are taken over.
    let edits: [(&str, &str, &str, u64); 14] = [
        ("", "", "8", 0),
        ("", "", "8", 8),
        ("day = 0;\n", "day = 0; // at first\n", "8", 8),
        // Rules, by their right-hand sides: first used in steps 4, 6 and 1.
        ("F(LATE, 0.1)", "F(LATE, 0.2)", "8", 3),
        ("Flower(0.1)", "Flower(0.12)", "8", 5),
        ("Bud(a + 1);", "RH(90) Bud(a + 1);", "8", 0),
        // By a left-hand side: there is no leaf before step 2, and no look at it before step 6.
        ("Flower(s), (s < 0.9)", "Flower(s), (s < 0.8)", "8", 5),
        // A method: first called in step 4.
        ("\"day \"", "\"on day \"", "8", 3),
        // A constant: read in step 4 and later.
        ("LATE = 2 *", "LATE = 3 *", "8", 3),
        ("RGBAShader(0.2", "RGBAShader(0.3", "8", 3),
        // What only drawing reads, and what nothing does.
        ("0.1 * size", "0.2 * size", "8", 8),
        ("RGBColor(0.4", "RGBColor(0.5", "8", 8),
        // Fewer steps, and more.
        ("", "", "5", 5),
        ("", "", "9", 8),
    ];
    for (old, new, steps, kept) in edits {
        text = text.replacen(old, new, 1);
        let grown = desk.grow(&text, steps).unwrap();
        assert_eq!(grown, desk.afresh(&text, steps).unwrap(), "{old} -> {new}");
        assert!(grown.0.is_ok(), "{grown:?}");
        let work = desk.studio.work;
        let total: u64 = steps.parse().unwrap();
        let (made, taken) = (work.steps - counts.0, work.kept_steps - counts.1);
        assert_eq!((made, taken), (total - kept, kept), "{old} -> {new}");
        counts = (work.steps, work.kept_steps);
    }
}

#[test]
fn a_mistake_on_the_way_loses_nothing() {
    let world = Machine::new();
    let mut desk = Desk::new(&world);
    desk.grow(PLANT, "8").unwrap();
    assert!(
        desk.grow(&PLANT.replace("Flower(0.1)", "Flower("), "8")
            .is_none()
    );
    // One that shows only while it grows, in step 6.
    let failing = PLANT.replace("Flower(0.1)", "Flower(1 / (day - day))");
    let failed = desk.grow(&failing, "8").unwrap();
    assert_eq!(failed, desk.afresh(&failing, "8").unwrap());
    assert!(failed.0.is_err());
    let grown = desk.grow(PLANT, "8").unwrap();
    assert_eq!(grown, desk.afresh(PLANT, "8").unwrap());
    assert_eq!(desk.studio.work.kept_steps, 5);
}

#[test]
fn what_depends_on_more_than_the_text_is_grown_from_where_it_does() {
    let world = Machine::new();
    let mut desk = Desk::new(&world);
    fs::write(desk.folder.path().join("t.csv"), "3\n").unwrap();
    let reading = PLANT.replace(
        "println(\"day \" + n + \" \" + sums[n % 3]);",
        "BufferedReader in = new BufferedReader(new FileReader(\"t.csv\")); sums[0] = Float.parseFloat(in.readLine()); in.close();",
    );
    for text in ["3\n", "4\n"] {
        fs::write(desk.folder.path().join("t.csv"), text).unwrap();
        let grown = desk.grow(&reading, "8").unwrap();
        assert_eq!(grown, desk.afresh(&reading, "8").unwrap());
        assert!(grown.0.is_ok(), "{grown:?}");
    }
    // The file is read in step 4.
    assert_eq!(desk.studio.work.kept_steps, 3);
}

#[test]
fn another_seed_is_another_growth() {
    let world = Machine::new();
    let mut desk = Desk::new(&world);
    let one = desk.grow(PLANT, "8").unwrap();
    let two = desk.grow(PLANT, "8 seed 2").unwrap();
    assert_eq!(two, desk.afresh(PLANT, "8 seed 2").unwrap());
    assert!(one != two && one.0.is_ok());
    assert_eq!(desk.studio.work.kept_steps, 0);
    // Only the growth before is known.
    assert_eq!(desk.grow(PLANT, "8").unwrap(), one);
    assert_eq!(desk.studio.work.kept_steps, 0);
}

/// A generator of numbers without any pretensions.
struct Chance(u64);

impl Chance {
    fn below(&mut self, n: usize) -> usize {
        self.0 = self
            .0
            .wrapping_mul(6_364_136_223_846_793_005)
            .wrapping_add(1_442_695_040_888_963_407);
        (self.0 >> 33) as usize % n
    }
}

/// A text with one line or one number changed.
fn edited(text: &str, chance: &mut Chance) -> String {
    let mut lines: Vec<String> = text.lines().map(str::to_owned).collect();
    let at = chance.below(lines.len());
    match chance.below(6) {
        0 => drop(lines.remove(at)),
        1 => lines.insert(at, lines[at].clone()),
        2 => lines.swap(at, chance_neighbour(at, text)),
        _ => {
            let digits: Vec<usize> = lines[at]
                .match_indices(|c: char| c.is_ascii_digit())
                .map(|(i, _)| i)
                .collect();
            if let Some(&digit) = digits.get(chance.below(digits.len().max(1))) {
                let new = chance.below(10).to_string();
                lines[at].replace_range(digit..=digit, &new);
            }
        }
    }
    lines.join("\n") + "\n"
}

fn chance_neighbour(at: usize, text: &str) -> usize {
    (at + 1).min(text.lines().count() - 1)
}

#[test]
fn whatever_is_edited_the_plant_is_the_one_grown_afresh() {
    let world = Machine::new();
    let mut desk = Desk::new(&world);
    let (mut chance, mut text) = (Chance(7), PLANT.to_owned());
    let (mut n_models, mut n_grown) = (0, 0);
    for round in 0..400 {
        // Now and then back to a model that is whole.
        if round % 8 == 0 {
            text = PLANT.to_owned();
        }
        let next = edited(&text, &mut chance);
        let steps = (5 + chance.below(5)).to_string();
        let grown = desk.grow(&next, &steps);
        assert_eq!(grown, desk.afresh(&next, &steps), "round {round}:\n{next}");
        let Some(grown) = grown else { continue };
        n_models += 1;
        n_grown += usize::from(grown.0.is_ok());
        text = next;
    }
    // Not blind: many edits were models, and much of what they had in common was taken over.
    let work = desk.studio.work;
    assert!(n_models > 150 && n_grown > 120, "{n_models} {n_grown}");
    assert!(work.kept_steps > work.steps / 4, "{work:?}");
}

#[test]
fn copies_stay_within_their_memory() {
    // Doubles with each step: copies of early steps are small, and those of late ones have no room.
    let world = Machine::new();
    let mut desk = Desk::new(&world);
    let text = "module A;\nprotected void init() [ Axiom ==> A; ]\npublic void run() [ A ==> F(1) [A] [A]; ]\n";
    fs::write(desk.path(), text).unwrap();
    let mut flags = Options::default();
    for (key, value) in [("steps", "14"), ("max-memory", "4M")] {
        flags.set(key, value, Origin::Flag).unwrap();
    }
    for _ in 0..2 {
        let opened = desk.studio.read(&flags).unwrap();
        let run = desk.studio.check(opened).unwrap();
        desk.studio.grow(&run, &CancelToken::default()).unwrap();
    }
    let work = desk.studio.work;
    assert!(work.kept_steps > 0 && work.kept_steps < 14, "{work:?}");
}

#[test]
fn the_examples_are_edited_as_they_are_grown() {
    let world = Machine::new();
    let course = Path::new(env!("CARGO_MANIFEST_DIR")).join("examples/course");
    let mut kept = 0;
    for name in [
        "01-poplar.rgg",
        "03-schoute.rgg",
        "04-two-blocks.rgg",
        "05-attims.rgg",
    ] {
        let text = fs::read_to_string(course.join(name)).unwrap();
        let mut desk = Desk::new(&world);
        let (mut chance, mut good) = (Chance(3), text.clone());
        for _ in 0..12 {
            let next = edited(&good, &mut chance);
            let grown = desk.grow(&next, "7");
            assert_eq!(grown, desk.afresh(&next, "7"), "{name}:\n{next}");
            if grown.is_some_and(|grown| grown.0.is_ok()) {
                good = next;
            }
        }
        kept += desk.studio.work.kept_steps;
    }
    assert!(kept > 40, "{kept}");
}
