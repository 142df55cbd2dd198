//! How fast models grow: new modules per second, queries over the whole graph, bytes per module, turns of loops, lines of
//! source.
//!
//! `cargo bench --bench growth` runs every case in a process of its own, on one thread and on all, and prints the best of
//! several runs beside a plain copy of memory on the same machine. `cargo bench --bench growth -- NAME` runs one case here.
#![allow(clippy::print_stdout, reason = "a benchmark prints its result")]

use std::fmt::Write as _;
use std::hint::black_box;
use std::process::Command;
use std::sync::{Arc, Mutex};
use std::time::Instant;

use understory::check::{SourceModel, check};
use understory::diag::SourceMap;
use understory::growth::{Growth, GrowthOptions};
use understory::syntax::parse;

/// A model whose last step is timed.
struct Case {
    name: &'static str,
    source: &'static str,
    /// Steps before the timed one.
    steps: u64,
    /// Types that a step replaces; all other nodes stay.
    replaced: &'static [&'static str],
}

const CASES: [Case; 7] = [
    Case {
        name: "Koch curve, context-free",
        source: "module K;
            protected void init() [ Axiom ==> K; ]
            public void run() [ K ==> K RU(60) K RU(-120) K RU(60) K; ]",
        steps: 10,
        replaced: &["K"],
    },
    Case {
        name: "Koch curve, F(x / 3)",
        source: "protected void init() [ Axiom ==> F(1); ]
            public void run() [ F(x) ==> F(x / 3) RU(60) F(x / 3) RU(-120) F(x / 3) RU(60) F(x / 3); ]",
        steps: 10,
        replaced: &["F"],
    },
    Case {
        name: "plant a of ABOP 1.24",
        source: "protected void init() [ Axiom ==> F(1); ]
            public void run() [ F ==> F(1) [RU(-25.7) F(1)] F(1) [RU(25.7) F(1)] F(1); ]",
        steps: 8,
        replaced: &["F"],
    },
    Case {
        name: "plant e of ABOP 1.24",
        source: "module X;
            protected void init() [ Axiom ==> X; ]
            public void run() [ X ==> F(1) [RU(-25.7) X] [RU(25.7) X] F(1) X; F ==> F(1) F(1); ]",
        steps: 11,
        replaced: &["F", "X"],
    },
    Case {
        name: "parametric tree",
        source: "module A(float x);
            protected void init() [ Axiom ==> A(1); ]
            public void run() [ A(x) ==> F(x) [RU(30) RH(90) A(x * 0.8)] [RU(-30) RH(90) A(x * 0.8)]; ]",
        steps: 19,
        replaced: &["A"],
    },
    Case {
        name: "tree with condition and random",
        source: "module A(float x);
            protected void init() [ Axiom ==> A(1); ]
            public void run() [ A(x), (x > 0.001) ==> F(x * random(0.9, 1.1))
                [RU(normal(30, 5)) RH(90) A(x * 0.8)] [RU(-30) RH(random(80, 100)) A(x * 0.8)]; ]",
        steps: 19,
        replaced: &["A"],
    },
    Case {
        name: "tree that keeps its apices, no template",
        source: "module A(float x);
            protected void init() [ Axiom ==> A(1); ]
            public void run() [ a:A(x) ==> F(x) RH(137.5) [RU(-40) A(x * 0.7)] RU(10) a { a[x] *= 0.9; }; ]",
        steps: 18,
        replaced: &[],
    },
];

/// Queries over all of the parametric tree.
const QUERIES: [&str; 3] = [
    "sum((* F *)[length])",
    "count((* x:F, (x[length] > 0.1) *))",
    "count((* F *))",
];

/// Loops of plain Java, with the number of turns of one step.
const LOOPS: [(&str, &str, f64); 3] = [
    (
        "array loop",
        "double[] a = new double[1000]; double s = 0;
         for (int k = 0; k < 3000; k++) { for (int i = 0; i < 1000; i++) { a[i] = a[i] + i * 0.5; } }
         println(a[999]);",
        3e6,
    ),
    (
        "integer loop",
        "int s = 0; for (int i = 0; i < 5000000; i++) { s += i % 7; } println(s);",
        5e6,
    ),
    (
        "sieve",
        "boolean[] c = new boolean[1000001]; int n = 0;
         for (int i = 2; i <= 1000000; i++) { if (!c[i]) { n++; for (int j = 2 * i; j <= 1000000; j += i) { c[j] = true; } } }
         println(n);",
        3.77e6,
    ),
];

/// Runs of each measurement; the best counts.
const RUNS: usize = 3;

fn main() {
    let wanted = std::env::args().skip(1).find(|arg| !arg.starts_with('-'));
    match wanted {
        Some(name) => run(&name),
        None => run_all(),
    }
}

/// Every case in a process of its own, so that each has its own peak of memory.
fn run_all() {
    let names = CASES.iter().map(|case| case.name);
    let names = names.chain(["copy", "queries", "loops", "parse"]);
    let Ok(this) = std::env::current_exe() else {
        return;
    };
    for name in names {
        for threads in ["1", "2"] {
            let mut command = Command::new(&this);
            command.arg(name).env("RAYON_NUM_THREADS", threads);
            let has_threads = CASES.iter().any(|case| case.name == name);
            if has_threads || threads == "1" {
                let output = command.output().expect("the benchmark can start itself");
                print!("{}", String::from_utf8_lossy(&output.stdout));
            }
        }
    }
}

fn run(name: &str) {
    match name {
        "copy" => copy(),
        "queries" => queries(),
        "loops" => loops(),
        "parse" => parse_time(),
        name => {
            for case in CASES.iter().filter(|case| case.name.contains(name)) {
                grow(case);
            }
        }
    }
}

/// A model that is checked and has no faults.
fn model(source: &str) -> understory::check::model::Model {
    let mut sources = SourceMap::default();
    let id = sources.add("model.rgg", source);
    let (ast, mut diagnostics) = parse(id, source);
    let name = "model".to_owned();
    let (model, found) = check(&[SourceModel { name, ast }]);
    diagnostics.append(found);
    assert!(diagnostics.is_empty(), "{diagnostics:?}");
    model
}

fn started(source: &str) -> (Growth, Arc<Mutex<String>>) {
    let printed = Arc::new(Mutex::new(String::new()));
    let sink = Arc::clone(&printed);
    let output = Box::new(move |text: &str| sink.lock().expect("one thread").push_str(text));
    let options = GrowthOptions::default();
    let mut growth =
        Growth::new(&model(source), options, output, Box::new(|| false)).expect("room");
    growth.init().expect("the model starts");
    (growth, printed)
}

/// New modules per second of the last step, by the clock and by the processor; peak memory over nodes.
fn grow(case: &Case) {
    let (mut best, mut work, mut new, mut total) = (f64::INFINITY, 0.0, 0, 0);
    for _ in 0..RUNS {
        let (mut growth, _) = started(case.source);
        growth.run(case.steps).expect("the model grows");
        let counts = growth.counts();
        let replaced = counts
            .iter()
            .filter(|(name, _)| case.replaced.contains(&name.as_str()));
        let stay = growth.total() - replaced.map(|(_, n)| n).sum::<usize>();
        let (start, busy) = (Instant::now(), busy_seconds());
        growth.step().expect("the model grows");
        best = best.min(start.elapsed().as_secs_f64());
        work += busy_seconds() - busy;
        total = growth.total();
        new = total - stay;
    }
    let bytes = status("VmHWM").map_or(f64::NAN, |bytes| bytes / total as f64);
    let threads = std::env::var("RAYON_NUM_THREADS").unwrap_or_default();
    println!(
        "{:39} {threads} thread(s) {:6.1} M new modules/s ({new} in {:.0} ms), {:.1} M per second of processor time, \
         {bytes:.0} bytes/module of {total}",
        case.name,
        new as f64 / best / 1e6,
        best * 1e3,
        (new * RUNS) as f64 / work / 1e6
    );
}

/// Processor time of all threads of this process so far, in seconds, if the system tells (in hundredths, on Linux).
fn busy_seconds() -> f64 {
    let text = std::fs::read_to_string("/proc/self/stat").unwrap_or_default();
    let after_name = text.rsplit(')').next().unwrap_or_default();
    let ticks = after_name.split_whitespace().skip(11).take(2);
    let ticks = ticks.filter_map(|ticks| ticks.parse::<f64>().ok());
    ticks.sum::<f64>() * 0.01
}

/// A figure of this process in bytes, if the system tells.
fn status(key: &str) -> Option<f64> {
    let text = std::fs::read_to_string("/proc/self/status").ok()?;
    let line = text.lines().find(|line| line.starts_with(key))?;
    Some(line.split_whitespace().nth(1)?.parse::<f64>().ok()? * 1024.0)
}

/// Bytes per second of a copy from one large block to another.
fn copy() {
    let from = vec![1_u8; 1 << 28];
    let mut to = vec![0_u8; 1 << 28];
    let seconds = best_of(5, || to.copy_from_slice(black_box(&from)));
    black_box(&to);
    let fresh = best_of(5, || drop(black_box(black_box(&from).clone())));
    println!(
        "copy of memory: {:.1} GB/s; into memory never used before: {:.1} GB/s",
        from.len() as f64 / seconds / 1e9,
        from.len() as f64 / fresh / 1e9
    );
}

fn best_of(runs: usize, mut f: impl FnMut()) -> f64 {
    let mut best = f64::INFINITY;
    for _ in 0..runs {
        let start = Instant::now();
        f();
        best = best.min(start.elapsed().as_secs_f64());
    }
    best
}

/// Nodes per second that a query looks at.
fn queries() {
    for query in QUERIES {
        let source = format!(
            "module A(float x);
            protected void init() {{ [ Axiom ==> A(1); ] derive(); for (int i : 1:18) {{ grow(); derive(); }} }}
            void grow() [ A(x) ==> F(x) [RU(30) RH(90) A(x * 0.8)] [RU(-30) RH(90) A(x * 0.8)]; ]
            public void run() {{ println({query}); }}"
        );
        let (mut growth, _) = started(&source);
        let seconds = best_of(RUNS, || growth.step().expect("the query runs"));
        let counts = growth.counts();
        let n = counts
            .iter()
            .find(|(name, _)| name == "F")
            .map_or(0, |(_, n)| *n);
        println!(
            "{query:40} {:6.1} M nodes/s ({n} in {:.2} ms)",
            n as f64 / seconds / 1e6,
            seconds * 1e3
        );
    }
}

/// Nanoseconds per turn of plain loops.
fn loops() {
    for (name, body, turns) in LOOPS {
        let source = format!("public void run() {{ {body} }}");
        let (mut growth, _) = started(&source);
        let seconds = best_of(RUNS, || growth.step().expect("the loop runs"));
        println!("{name:40} {:6.1} ns per turn", seconds * 1e9 / turns);
    }
}

/// Lines and bytes per second that are parsed, and lines that are parsed and checked.
fn parse_time() {
    let mut source = String::new();
    for i in 0..150 {
        let _ = writeln!(
            source,
            "module Organ{i}(float length, int age) extends F(length, 0.1) {{
                float area = 0; // of all leaves, m2
                float grown(float by) {{ return (length + by) * 1.5 / (age + 1); }}
            }}
            protected void grow{i}() [
                Organ{i}(x, n), (n > 3 && x < 10) ==> Organ{i}(x * 1.1, n + 1) [RU(30) RH(137.5 * n) Organ{i}(0.1, 0)];
                x:Organ{i} ::> {{ x[area] += Math.PI * sqr(x[length]) / 4 + 0.5 * x.grown(1); }}
            ]
            int count{i}() {{ return (int) count((* y:Organ{i}, (y[age] > 2) *)); }}
            "
        );
    }
    source.push_str("double sqr(double x) { return x * x; }\n");
    let lines = source.lines().count() as f64;
    let mut sources = SourceMap::default();
    let id = sources.add("model.rgg", source.as_str());
    let parsed = best_of(RUNS, || {
        let (_, diagnostics) = parse(id, black_box(&source));
        assert!(diagnostics.is_empty(), "{diagnostics:?}");
    });
    let checked = best_of(RUNS, || drop(model(black_box(&source))));
    println!(
        "parse: {:.1} MB/s, {:.0} k lines/s ({:.0} ms per 1500 lines); with the check {:.0} ms per 1500 lines",
        source.len() as f64 / parsed / 1e6,
        lines / parsed / 1e3,
        parsed / lines * 1.5e6,
        checked / lines * 1.5e6
    );
}
