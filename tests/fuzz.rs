//! Mutated models through reading, checking, three steps of growth and drawing: no panic, no hang, no memory blow-up.
//!
//! An input is a pure function of its number: a model of the corpus (all `.rgg` files below `tests/` and `examples/`) with a
//! few mutations of tokens, lines or bytes. Batches run in processes of their own with little memory, so that a stack
//! overflow or an allocation that fails is found as well; a batch that dies is run again in halves until one number is left.
//!
//! ```sh
//! cargo test --test fuzz                                                        # a short run
//! UNDERSTORY_FUZZ=10000000 cargo test --release --test fuzz -- --nocapture      # the long one
//! UNDERSTORY_FUZZ_PRINT=123456 cargo test --test fuzz -- --nocapture            # shows one input
//! ```
//! Inputs that once failed are kept in `tests/fuzz/`; being `.rgg` files, they are part of the corpus, and run unchanged first.

#![allow(clippy::unwrap_used, reason = "a test fails by panicking")]
#![allow(clippy::print_stdout, reason = "a long run tells how far it is")]

use std::fs;
use std::ops::Range;
use std::panic::{AssertUnwindSafe, catch_unwind};
use std::path::{Path, PathBuf};
use std::process::{Command, Stdio};
use std::sync::atomic::{AtomicU64, Ordering};
use std::sync::{Arc, Mutex};
use std::time::{Duration, Instant};
use understory::check::{SourceModel, check};
use understory::diag::SourceMap;
use understory::eval::Limits;
use understory::growth::{Growth, GrowthOptions};
use understory::interpret;
use understory::syntax::parse;

/// Inputs of a run that nobody asked to be longer.
const SHORT: u64 = 2_000;
/// Inputs of one process.
const BATCH: u64 = 2_000;
/// An input that takes longer is a hang. Budgets end each after a fraction of this, on a slow machine too.
const HANG: Duration = Duration::from_secs(30);
/// Address space of a process, KiB.
const ADDRESS_SPACE: u64 = 3 << 20;
/// Larger models of the corpus are left out: they would take most of the time.
const LARGEST: usize = 2_500;
/// Texts count as this much longer than they are, which stands for the cost of any input, bytes.
const SHORTEST: usize = 200;
/// Steps of each model.
const STEPS: u64 = 3;

/// Tokens that no model of the corpus may hold, or that are worth trying often.
const EXTRAS: &[&str] = &[
    "0",
    "-1",
    "1e308",
    "1e-308",
    "2147483647",
    "-2147483648",
    "9223372036854775807L",
    "0.0/0",
    "1/0",
    "null",
    "this",
    "super",
    "==>",
    "==>>",
    "::>",
    "-->",
    "<--",
    "+>",
    "(-->)*",
    "(-->)+",
    "(* F *)",
    "[",
    "]",
    "(",
    ")",
    "{",
    "}",
    ";",
    ",",
    "^",
    ":=",
    ":+=",
    "derive();",
    "Axiom",
    "F",
    "F(1)",
    "M(-1e300)",
    "RU(1e300)",
    "Scale(0)",
    "Sphere(-1)",
    "Box",
    "Instance(this)",
    "for (int i : 1:1000000)",
    "while (true)",
    "new int[2000000000]",
    "if (true)",
    "else",
    "module",
    "extends",
    "static",
    "const",
    "int",
    "float",
    "double",
    "String",
    "boolean",
    "void",
    "return",
    "\"",
    "'",
    "/*",
    "*/",
    "//",
    "\\u0000",
    "é",
    "\0",
    "sum((* F *)[length])",
    "count((* F, F *))",
    "setSeed(1)",
    "println",
    "random(0,1)",
    "irandom(1,0)",
    "%",
    "**",
    "<<",
    "?",
];

/// `SplitMix64`: small, and the same everywhere.
struct Random(u64);

impl Random {
    fn next(&mut self) -> u64 {
        self.0 = self.0.wrapping_add(0x9e37_79b9_7f4a_7c15);
        let mut z = self.0;
        z = (z ^ (z >> 30)).wrapping_mul(0xbf58_476d_1ce4_e5b9);
        z = (z ^ (z >> 27)).wrapping_mul(0x94d0_49bb_1331_11eb);
        z ^ (z >> 31)
    }

    fn below(&mut self, n: usize) -> usize {
        (self.next() % n.max(1) as u64) as usize
    }

    fn pick<'a, T>(&mut self, from: &'a [T]) -> &'a T {
        &from[self.below(from.len())]
    }
}

/// The models that inputs are made of.
struct Corpus {
    texts: Vec<String>,
    tokens: Vec<Vec<String>>,
    /// Running sums of the texts' shares of the inputs, which fall with their length: each text gets the same time, so that ten
    /// million inputs are not mostly a few long models.
    shares: Vec<f64>,
    /// How many, from the first, once failed.
    n_regressions: usize,
}

impl Corpus {
    fn read() -> Self {
        let root = Path::new(env!("CARGO_MANIFEST_DIR"));
        let mut files = Vec::new();
        collect(&root.join("tests/fuzz"), &mut files);
        let n_regressions = files.len();
        for folder in ["examples", "tests"] {
            let mut found = Vec::new();
            collect(&root.join(folder), &mut found);
            files.extend(
                found
                    .into_iter()
                    .filter(|file| !file.starts_with(root.join("tests/fuzz"))),
            );
        }
        let read = |file: &PathBuf| String::from_utf8_lossy(&fs::read(file).unwrap()).into_owned();
        let mut texts: Vec<String> = files.iter().map(read).collect();
        let mut at = 0;
        texts.retain(|text| {
            at += 1;
            at <= n_regressions || text.len() <= LARGEST
        });
        let tokens = texts.iter().map(|text| tokens(text)).collect();
        let mut sum = 0.0;
        let shares = texts.iter().map(|text| {
            sum += 1.0 / (SHORTEST + text.len()) as f64;
            sum
        });
        Self {
            shares: shares.collect(),
            texts,
            tokens,
            n_regressions,
        }
    }

    /// A text, short ones more often.
    fn pick(&self, random: &mut Random) -> &[String] {
        let total = self.shares.last().copied().unwrap_or(0.0);
        let at = (random.next() >> 11) as f64 / (1_u64 << 53) as f64 * total;
        let index = self.shares.partition_point(|share| *share <= at);
        &self.tokens[index.min(self.tokens.len() - 1)]
    }

    /// The input of this number.
    fn input(&self, number: u64) -> String {
        if let Some(text) = self.texts[..self.n_regressions].get(number as usize) {
            return text.clone();
        }
        let mut random = Random(number);
        let mut input = self.pick(&mut random).to_vec();
        // Mostly one, so that enough inputs are good enough to grow.
        let n_mutations = 1 + random.below(4) / 3 * random.below(4);
        for _ in 0..n_mutations {
            self.mutate(&mut input, &mut random);
        }
        let text = input.concat();
        if random.below(50) == 0 {
            damaged(text, &mut random)
        } else {
            text
        }
    }

    fn mutate(&self, input: &mut Vec<String>, random: &mut Random) {
        let at = random.below(input.len());
        let until = (at + 1 + random.below(8)).min(input.len());
        let from = random.pick(&self.tokens);
        let start = random.below(from.len());
        match random.below(20) {
            0 => drop(input.drain(at..until)),
            1 => {
                let piece = input[at..until].to_vec();
                input.splice(at..at, piece);
            }
            2 => {
                let other = random.below(input.len());
                input.swap(at, other);
            }
            3 => input.insert(at, (*random.pick::<&str>(EXTRAS)).to_owned()),
            4 => {
                let end = (start + 1 + random.below(20)).min(from.len());
                input.splice(at..at, from[start..end].to_vec());
            }
            // What keeps most inputs well formed, so that the later stages get to see them.
            5..8 => {
                let piece = group(from, start).to_vec();
                let old = group(input, at).len();
                let at = opening(input, at);
                input.splice(at..at + old, piece);
            }
            8..12 => {
                let piece = line(input, at).to_vec();
                let to = line_start(input, random.below(input.len()));
                input.splice(to..to, piece);
            }
            kind => {
                let is_number = kind < 16;
                let fits =
                    |token: &str| is_number == token.starts_with(|c: char| c.is_ascii_digit());
                let is_word = |token: &str| token.starts_with(|c: char| c.is_alphanumeric());
                let found = from
                    .iter()
                    .skip(start)
                    .find(|token| is_word(token) && fits(token));
                let extreme = (*random.pick::<&str>(&EXTRAS[..8])).to_owned();
                let word = match found {
                    Some(word) if random.below(4) > 0 => word.clone(),
                    _ => extreme,
                };
                let mut old = input.iter_mut().skip(at);
                if let Some(token) = old.find(|token| is_word(token) && fits(token)) {
                    *token = word;
                }
            }
        }
        if input.is_empty() {
            input.push(String::new());
        }
    }
}

/// Index of the first bracket that opens at or after `at`, or `at`.
fn opening(tokens: &[String], at: usize) -> usize {
    let is_open = |token: &String| matches!(token.as_str(), "(" | "[" | "{");
    let found = tokens.iter().skip(at).position(is_open);
    at + found.unwrap_or(0)
}

/// From that bracket to the one that closes it.
fn group(tokens: &[String], at: usize) -> &[String] {
    let start = opening(tokens, at);
    let mut depth = 0_i32;
    for (i, token) in tokens[start..].iter().enumerate() {
        depth += match token.as_str() {
            "(" | "[" | "{" => 1,
            ")" | "]" | "}" => -1,
            _ => 0,
        };
        if depth <= 0 {
            return &tokens[start..=start + i];
        }
    }
    &tokens[start..start]
}

fn is_break(token: &str) -> bool {
    token.contains('\n')
}

/// Where the line that `at` stands in begins.
fn line_start(tokens: &[String], at: usize) -> usize {
    let before = tokens[..at].iter().rposition(|token| is_break(token));
    before.map_or(0, |i| i + 1)
}

/// The line that `at` stands in.
fn line(tokens: &[String], at: usize) -> &[String] {
    let end = tokens[at..].iter().position(|token| is_break(token));
    &tokens[line_start(tokens, at)..end.map_or(tokens.len(), |i| at + i + 1)]
}

fn collect(folder: &Path, files: &mut Vec<PathBuf>) {
    let Ok(entries) = fs::read_dir(folder) else {
        return;
    };
    let mut paths: Vec<PathBuf> = entries.map(|entry| entry.unwrap().path()).collect();
    paths.sort();
    for path in paths {
        if path.is_dir() {
            collect(&path, files);
        } else if path.extension().is_some_and(|suffix| suffix == "rgg") {
            files.push(path);
        }
    }
}

/// Words, numbers, blanks and single other characters, so that their sequence is the text.
fn tokens(text: &str) -> Vec<String> {
    let class = |c: char| match c {
        c if c.is_alphanumeric() || c == '_' || c == '.' => 1,
        c if c.is_whitespace() => 2,
        '=' | '>' | ':' | '<' | '-' | '+' | '*' => 3,
        _ => 0,
    };
    let mut tokens: Vec<String> = Vec::new();
    let mut last = 0;
    for c in text.chars() {
        let this = class(c);
        match tokens.last_mut() {
            Some(token) if this != 0 && this == last => token.push(c),
            _ => tokens.push(c.to_string()),
        }
        last = this;
    }
    tokens
}

/// Damages a few bytes; what is not UTF-8 after that is replaced, as reading a file does not get further either.
fn damaged(text: String, random: &mut Random) -> String {
    let mut bytes = text.into_bytes();
    for _ in 0..1 + random.below(4) {
        if bytes.is_empty() {
            break;
        }
        let at = random.below(bytes.len());
        match random.below(3) {
            0 => bytes[at] = random.next() as u8,
            1 => drop(bytes.remove(at)),
            _ => bytes.truncate(at),
        }
    }
    String::from_utf8_lossy(&bytes).into_owned()
}

/// How far inputs came.
#[derive(Clone, Copy, Debug, Default)]
struct Reached {
    checked: u64,
    grown: u64,
    drawn: u64,
}

/// Sends one input all the way.
fn run(text: &str, reached: &mut Reached) {
    let mut sources = SourceMap::default();
    let file = sources.add("model.rgg", text);
    let (ast, mut found) = parse(file, text);
    let (model, checked) = check(&[SourceModel {
        name: "model.rgg".into(),
        ast,
    }]);
    found.append(checked);
    for diagnostic in found.sorted() {
        assert!(!diagnostic.message.is_empty());
    }
    if found.has_errors() {
        return;
    }
    reached.checked += 1;
    let options = GrowthOptions {
        limits: Limits {
            steps: 20_000,
            depth: 200,
            memory: 16 << 20,
            nodes: 5_000,
        },
        ..GrowthOptions::default()
    };
    let Ok(mut growth) = Growth::new(&model, options, Box::new(|_| {}), Box::new(|| false)) else {
        return;
    };
    let has_grown = growth.init().is_ok() && growth.run(STEPS).is_ok();
    reached.grown += u64::from(has_grown);
    let limits = interpret::Limits {
        memory: 64 << 20,
        body_depth: 50,
        body_nodes: 5_000,
        ..interpret::Limits::default()
    };
    reached.drawn += u64::from(interpret::interpret(&mut growth.sketch(), limits).is_ok());
}

/// The process of one batch: `UNDERSTORY_FUZZ_RANGE=A..B`.
#[test]
#[ignore = "started by the other test, once for each batch"]
fn batch() {
    let range = std::env::var("UNDERSTORY_FUZZ_RANGE").unwrap();
    let (from, to) = range.split_once("..").unwrap();
    let range: Range<u64> = from.parse().unwrap()..to.parse().unwrap();
    let corpus = Corpus::read();
    let now = Arc::new((AtomicU64::new(range.start), Mutex::new(Instant::now())));
    let watched = Arc::clone(&now);
    std::thread::spawn(move || {
        loop {
            std::thread::sleep(Duration::from_millis(500));
            if watched.1.lock().unwrap().elapsed() > HANG {
                println!("FAULT {} hangs", watched.0.load(Ordering::Relaxed));
                std::process::exit(3);
            }
        }
    });
    std::panic::set_hook(Box::new(|panic| println!("{panic}")));
    let mut reached = Reached::default();
    for number in range {
        now.0.store(number, Ordering::Relaxed);
        *now.1.lock().unwrap() = Instant::now();
        let text = corpus.input(number);
        if catch_unwind(AssertUnwindSafe(|| run(&text, &mut reached))).is_err() {
            println!("FAULT {number} panics");
        }
    }
    let Reached {
        checked,
        grown,
        drawn,
    } = reached;
    println!("REACHED {checked} {grown} {drawn}");
}

/// Runs a batch in a process of its own; what is wrong goes to `faults`.
fn run_batch(range: Range<u64>, faults: &Mutex<Vec<String>>) -> Reached {
    let this = std::env::current_exe().unwrap();
    let script =
        format!("ulimit -v {ADDRESS_SPACE}; exec \"$0\" --ignored --exact batch --nocapture");
    let output = Command::new("sh")
        .args(["-c", &script])
        .arg(this)
        .env(
            "UNDERSTORY_FUZZ_RANGE",
            format!("{}..{}", range.start, range.end),
        )
        .env("RUST_BACKTRACE", "0")
        .stderr(Stdio::piped())
        .output()
        .unwrap();
    let text = String::from_utf8_lossy(&output.stdout).into_owned();
    if let Some(line) = text.lines().find_map(|line| line.strip_prefix("REACHED ")) {
        if text.contains("FAULT ") {
            faults.lock().unwrap().push(text.clone());
        }
        let mut counts = line.split(' ').map(|count| count.parse().unwrap());
        let mut next = || counts.next().unwrap();
        return Reached {
            checked: next(),
            grown: next(),
            drawn: next(),
        };
    }
    if range.end - range.start == 1 {
        let fault = format!(
            "{} ends the process: {:?}\n{text}",
            range.start, output.status
        );
        faults.lock().unwrap().push(fault);
        return Reached::default();
    }
    let middle = range.start + (range.end - range.start) / 2;
    let halves = [
        run_batch(range.start..middle, faults),
        run_batch(middle..range.end, faults),
    ];
    Reached {
        checked: halves[0].checked + halves[1].checked,
        grown: halves[0].grown + halves[1].grown,
        drawn: halves[0].drawn + halves[1].drawn,
    }
}

#[test]
fn no_mutated_model_does_harm() {
    if let Ok(number) = std::env::var("UNDERSTORY_FUZZ_PRINT") {
        println!("{}", Corpus::read().input(number.parse().unwrap()));
        return;
    }
    let count = std::env::var("UNDERSTORY_FUZZ").map_or(SHORT, |count| count.parse().unwrap());
    let start = std::env::var("UNDERSTORY_FUZZ_START").map_or(0, |start| start.parse().unwrap());
    let (next, done) = (AtomicU64::new(start), AtomicU64::new(0));
    let (faults, total) = (Mutex::new(Vec::new()), Mutex::new(Reached::default()));
    let work = || {
        loop {
            let from = next.fetch_add(BATCH, Ordering::Relaxed);
            if from >= start + count {
                break;
            }
            let to = (from + BATCH).min(start + count);
            let reached = run_batch(from..to, &faults);
            let mut total = total.lock().unwrap();
            total.checked += reached.checked;
            total.grown += reached.grown;
            total.drawn += reached.drawn;
            let done = done.fetch_add(to - from, Ordering::Relaxed) + (to - from);
            println!(
                "{done} inputs, {} faults: {total:?}",
                faults.lock().unwrap().len()
            );
        }
    };
    std::thread::scope(|scope| {
        for _ in 0..std::thread::available_parallelism().map_or(1, usize::from) {
            scope.spawn(work);
        }
    });
    let faults = faults.into_inner().unwrap();
    assert!(faults.is_empty(), "{}", faults.join("\n"));
    // A corpus that hardly gets anywhere would test the parser only. About a tenth grows; every new example shifts it a little.
    assert!(
        total.into_inner().unwrap().grown * 12 > count,
        "few inputs grow"
    );
}
