//! Models of several files, written as users of GroIMP write them (`tests/models/`): parameters, organs and rules apart, Java
//! beside rules. They are free of errors and warnings, grow what they grew before, and can be seen.

#![allow(clippy::unwrap_used, reason = "a test fails by panicking")]

#[path = "support/opened.rs"]
mod opened;

use opened::Opened;
use std::fmt::Write;

/// What a model prints and grows in so many steps; it is also drawn, small.
fn facts(name: &str, steps: &str) -> String {
    let flags = [("steps", steps), ("size", "24x16"), ("samples", "2")];
    let model = Opened::new(format!("tests/models/{name}"), &flags);
    let growth = model.grow();
    let mut text = model.printed();
    for (module, n) in growth.counts() {
        let _ = writeln!(text, "{module} {n}");
    }
    let drawn = model.draw();
    let n = drawn.image.pixels.len() as f64;
    let mean = drawn
        .image
        .pixels
        .iter()
        .map(|p| p.luminance())
        .sum::<f64>()
        / n;
    assert!(
        mean.is_finite() && mean > 0.1,
        "{name}: mean radiance {mean}"
    );
    let size = drawn.bounds.max - drawn.bounds.min;
    let _ = writeln!(text, "size: {:.4} {:.4} {:.4} m", size.x, size.y, size.z);
    text
}

#[test]
fn maize() {
    insta::assert_snapshot!(facts("maize", "60"));
}

#[test]
fn greenhouse() {
    insta::assert_snapshot!(facts("greenhouse", "45"));
}

#[test]
fn orchard() {
    insta::assert_snapshot!(facts("orchard", "4"));
}
