//! The page of `watch` in a real browser: what a user sees, and does.
//!
//! Needs Chromium (`apt-get install chromium`); where there is none it says so and looks at nothing. With
//! `UNDERSTORY_NEEDS_BROWSER=1`, as in CI, that is a failure.

#![allow(clippy::unwrap_used, reason = "a test fails by panicking")]
#![cfg(unix)]

#[path = "support/browser.rs"]
#[allow(dead_code, reason = "each test that uses a browser uses a part of it")]
mod browser;
#[path = "support/watching.rs"]
mod watching;

use browser::{Browser, Shot};
use std::fs;
use std::process::Command;
use std::time::{Duration, Instant};
use watching::Watch;

/// Two balls side by side, and one more above with each step.
const MODEL: &str = "const float SIZE = 0.6; // of the balls below\nmodule Bud;\n\
    protected void init() [ Axiom ==> [Translate(-1, 0, 0) Sphere(SIZE).(setShader(RED))] \
    [Translate(1, 0, 0) Sphere(SIZE).(setShader(BLUE))] Bud; ]\n\
    public void run() [ Bud ==> M(1.2) Sphere(0.5).(setShader(GREEN)) Bud; ]\n";
/// A camera to the south: the red ball is to the left.
const CAMERA: &str =
    "steps = 0\n[camera]\neye = [0, -8, 1]\ntarget = [0, 0, 1]\n[sky]\nsun = [150, 50]\n";
/// Where the balls are in the picture.
const LEFT: (f64, f64) = (0.385, 0.66);
const RIGHT: (f64, f64) = (0.615, 0.66);
const ABOVE: (f64, f64) = (0.5, 0.466);

/// Whether a channel (0 red, 1 green, 2 blue) outshines the others at a place.
fn shows(shot: &Shot, channel: usize, (x, y): (f64, f64)) -> bool {
    let color = shot.at(x, y);
    let others = (0..3).filter(|other| *other != channel);
    others
        .map(|other| color[other])
        .all(|other| color[channel] > 1.3 * other + 20.0)
}

#[test]
fn a_session_in_a_real_browser() {
    let folder = tempfile::tempdir().unwrap();
    let Some(mut page) = Browser::start(1200, 900, folder.path()) else {
        assert!(
            std::env::var_os("UNDERSTORY_NEEDS_BROWSER").is_none(),
            "there is no Chromium"
        );
        eprintln!("there is no Chromium here: nothing was looked at");
        return;
    };
    let write = |name: &str, text: &str| fs::write(folder.path().join(name), text).unwrap();
    write("m.rgg", MODEL);
    write("m.toml", CAMERA);
    let (_watch, address) = Watch::start(folder.path(), "m.rgg", "--size 150x100 --quality draft");

    // The first picture.
    page.open(&address);
    page.until("document.querySelector('#stage')?.dataset.final === 'true'");
    page.until_seen("#stage", "a red and a blue ball", |shot| {
        shows(shot, 0, LEFT) && shows(shot, 2, RIGHT) && !shows(shot, 1, ABOVE)
    });

    // An edit.
    write("m.rgg", &MODEL.replace("RED", "GREEN"));
    page.until_seen("#stage", "a green ball", |shot| {
        shows(shot, 1, LEFT) && shows(shot, 2, RIGHT)
    });

    // An error, over the last good picture.
    write("m.rgg", &MODEL.replace("Sphere(SIZE)", "Spher(SIZE)"));
    page.until("document.querySelector('#problems mark')?.textContent.includes('Spher')");
    page.until("document.querySelector('#problems .place').textContent.startsWith('m.rgg:3')");
    assert_eq!(page.ask("document.querySelector('#picture').hidden"), false);
    let [red, _, blue] = page.shot("#stage").at(0.3, 0.1);
    assert!(blue > red + 5.0, "no sky above the error: {red} {blue}");

    // Recovery.
    write("m.rgg", MODEL);
    page.until("document.querySelector('#problems').hidden");
    page.until_seen("#stage", "a red ball again", |shot| shows(shot, 0, LEFT));

    // A drag over the height of the picture turns it half round.
    let [x, y, width, height] = page.place("#stage");
    page.drag((x + 0.2 * width, y + 0.5 * height), (height, 0.0));
    page.until_seen("#stage", "the balls from behind", |shot| {
        shows(shot, 2, LEFT) && shows(shot, 0, RIGHT)
    });
    page.until("document.querySelector('#command').textContent.includes('--eye=')");
    // And the keys turn it back by five degrees each.
    for _ in 0..36 {
        page.key("ArrowRight");
    }
    page.until_seen("#stage", "the balls from the front", |shot| {
        shows(shot, 0, LEFT) && shows(shot, 2, RIGHT)
    });

    // The slider of steps, by keyboard.
    page.ask("document.querySelector('#step').focus()");
    page.key("ArrowRight");
    page.until_seen("#stage", "a ball above", |shot| shows(shot, 1, ABOVE));

    // A number of the model, which writes nothing into its file.
    page.ask(
        "(() => { const field = document.querySelector('#number-rows input[type=number]'); \
         field.value = 0.01; field.dispatchEvent(new Event('change')); })()",
    );
    page.until_seen("#stage", "no balls below", |shot| {
        !shows(shot, 0, LEFT) && !shows(shot, 2, RIGHT) && shows(shot, 1, ABOVE)
    });
    assert_eq!(
        fs::read_to_string(folder.path().join("m.rgg")).unwrap(),
        MODEL
    );
    page.click("#revert");
    page.until_seen("#stage", "balls below", |shot| shows(shot, 0, LEFT));

    // Another renderer.
    page.click("#renderer input[value=raytracer]");
    page.until("document.querySelector('#command').textContent.includes('--renderer=raytracer')");
    page.until("document.querySelector('#activity').textContent === 'Finished'");
    page.until_seen("#stage", "the same by the ray tracer", |shot| {
        shows(shot, 0, LEFT) && shows(shot, 2, RIGHT) && shows(shot, 1, ABOVE)
    });

    // Saved: what the command makes, byte by byte.
    page.until("document.querySelector('#save').getAttribute('aria-disabled') === 'false'");
    page.click("#save");
    let saved = folder.path().join("m.png");
    let end = Instant::now() + Duration::from_secs(60);
    while !saved.exists() {
        assert!(Instant::now() < end, "nothing was saved");
        std::thread::sleep(Duration::from_millis(50));
    }
    let saved = fs::read(&saved).unwrap();
    fs::remove_file(folder.path().join("m.png")).unwrap();
    let command = page.ask("document.querySelector('#command').textContent");
    let words = command.as_str().unwrap().split(' ').skip(1);
    let made = Command::new(env!("CARGO_BIN_EXE_understory"))
        .current_dir(folder.path())
        .args(words)
        .output()
        .unwrap();
    assert!(made.status.success(), "{command}: {made:?}");
    assert!(
        saved == fs::read(folder.path().join("m.png")).unwrap(),
        "{command}"
    );
    assert_eq!(page.ask("performance.getEntriesByType('resource').every(e => e.name.startsWith(location.origin) || e.name.startsWith('blob:'))"), true);
}
