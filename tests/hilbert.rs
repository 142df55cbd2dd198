//! The three-dimensional Hilbert curve (Prusinkiewicz and Lindenmayer, The Algorithmic Beauty of Plants, 1990, figure 1.19): its
//! line goes through every cell of a cube exactly once: a test of the turtle's signs that needs no table.
//!
//! The rules of the book roll by half turns only, whose sign does not matter; then neither does that of a yaw, because the
//! mirror image of the curve is as good. So here half of the pitches are put together from rolls and a yaw, and the line stays in
//! the cube only if RU, RL and RH turn to the right sides together.

#![allow(clippy::unwrap_used, reason = "a test fails by panicking")]

use std::collections::BTreeSet;
use std::sync::{Arc, Mutex};
use understory::check::{SourceModel, check};
use understory::diag::SourceMap;
use understory::growth::{Growth, GrowthOptions};
use understory::syntax::parse;

const MODEL: &str = "
module A; module B; module C; module D;

protected void init() [ Axiom ==> A; ]

public void run() {
	grow();
	derive();
	for ((* f:F *)) {
		Point3d a = location(f);
		Point3d b = endlocation(f);
		println(a.x + \" \" + a.y + \" \" + a.z + \" \" + b.x + \" \" + b.y + \" \" + b.z);
	}
	println(\"end\");
}

void grow() [
RULES
]
";

/// The rules in the letters of the book. The pitches of the last two are written with rolls and yaws.
const RULES: [&str; 4] = [
    "A B-F+CFC+F-D&F^D-F+&&CFC+F+B//",
    "B A&F^CFB^F^D^^-F-D^|F^B|FC^F^A//",
    "C |D^|F^B-F+C^F^A&&FA&F^C+F+B^F^D//",
    "D |CFB-F+B|FA&F^A&&FB-F+B|FC//",
];

/// Which way each of the three axes turns: 1 as in the book.
type Signs = [i32; 3];

/// A letter of the book as commands of the turtle: + left, - right, & down, ^ up, / roll, | about.
fn command(letter: char, is_direct: bool, [up, left, head]: Signs) -> String {
    match letter {
        '+' => format!("RU({})", 90 * up),
        '-' => format!("RU({})", -90 * up),
        '&' if is_direct => format!("RL({})", 90 * left),
        '^' if is_direct => format!("RL({})", -90 * left),
        '&' => format!("RH({}) RU({}) RH({})", -90 * head, 90 * up, 90 * head),
        '^' => format!("RH({}) RU({}) RH({})", -90 * head, -90 * up, 90 * head),
        '/' => format!("RH({})", -90 * head),
        '|' => "RU(180)".to_owned(),
        other => other.to_string(),
    }
}

fn model(signs: Signs) -> String {
    let rules = RULES.map(|rule| {
        let (left, right) = rule.split_once(' ').unwrap();
        let is_direct = "AB".contains(left);
        let commands = right.chars().map(|c| command(c, is_direct, signs));
        let right: Vec<_> = commands.collect();
        format!("\t{left} ==> {};", right.join(" "))
    });
    MODEL.replace("RULES", &rules.join("\n"))
}

type Cell = [i64; 3];

/// The lines of the curves of the orders 1, 2, 3, …: from which cell to which.
fn curves(signs: Signs, n_orders: usize) -> Vec<Vec<[Cell; 2]>> {
    let text = model(signs);
    let mut sources = SourceMap::default();
    let id = sources.add("hilbert.rgg", text.as_str());
    let (ast, mut diagnostics) = parse(id, &text);
    let name = "hilbert".to_owned();
    let (model, found) = check(&[SourceModel { name, ast }]);
    diagnostics.append(found);
    assert!(diagnostics.is_empty(), "{diagnostics:?}");

    let printed = Arc::new(Mutex::new(String::new()));
    let sink = Arc::clone(&printed);
    let output = Box::new(move |text: &str| sink.lock().unwrap().push_str(text));
    let options = GrowthOptions::default();
    let mut growth = Growth::new(&model, options, output, Box::new(|| false)).unwrap();
    growth.init().unwrap();
    growth.run(n_orders as u64).unwrap();
    drop(growth);
    let printed = printed.lock().unwrap();
    let orders = printed.trim_end().trim_end_matches("end").split("end\n");
    orders
        .map(|lines| lines.lines().map(line).collect())
        .collect()
}

/// `0.0 0.0 0.0 1.0 0.0 0.0`; what is not near a cell's middle is an error of the turtle.
fn line(text: &str) -> [Cell; 2] {
    let mut numbers = text.split(' ').map(|word| {
        let x: f64 = word.parse().unwrap();
        assert!((x - x.round()).abs() < 1e-9, "between the cells: {text}");
        x.round() as i64
    });
    let mut cell = || [(); 3].map(|()| numbers.next().unwrap());
    [cell(), cell()]
}

/// Whether the lines are one way through all cells of a cube of 2^order cells a side, from neighbour to neighbour.
fn fills_the_cube(lines: &[[Cell; 2]], order: u32) -> bool {
    let is_step = |[a, b]: &[Cell; 2]| (0..3).map(|i| (a[i] - b[i]).abs()).sum::<i64>() == 1;
    assert!(lines.iter().all(is_step), "a line is one cell long");
    let starts: BTreeSet<Cell> = lines.iter().map(|line| line[0]).collect();
    let ends: BTreeSet<Cell> = lines.iter().map(|line| line[1]).collect();
    let cells: BTreeSet<Cell> = starts.union(&ends).copied().collect();
    let is_cube = (0..3).all(|i| {
        let low = cells.iter().map(|cell| cell[i]).min();
        let high = cells.iter().map(|cell| cell[i]).max();
        low.zip(high)
            .is_some_and(|(low, high)| high - low == 2_i64.pow(order) - 1)
    });
    // No cell is left twice, none is entered twice, and only one is never entered: a single way, no circles.
    let is_way = starts.len() == lines.len() && ends.len() == lines.len();
    is_cube && is_way && cells.len() == 8_usize.pow(order)
}

#[test]
fn the_curve_visits_every_cell_once() {
    let curves = curves([1, 1, 1], 3);
    assert_eq!(curves.len(), 3);
    for (order, lines) in (1..).zip(&curves) {
        assert_eq!(lines.len(), 8_usize.pow(order) - 1, "order {order}");
        assert!(fills_the_cube(lines, order), "order {order}");
    }
}

/// What the test above is worth: with one axis turning the other way the curve runs into itself.
#[test]
fn one_wrong_sign_is_seen() {
    for signs in [[-1, 1, 1], [1, -1, 1], [1, 1, -1]] {
        let lines = &curves(signs, 2)[1];
        assert!(!fills_the_cube(lines, 2), "{signs:?}");
    }
    // Two wrong signs are a reflection, and the mirror image of the curve is as good.
    for signs in [[-1, -1, 1], [1, -1, -1], [-1, 1, -1]] {
        let lines = &curves(signs, 2)[1];
        assert!(fills_the_cube(lines, 2), "{signs:?}");
    }
}
