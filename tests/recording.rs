//! The recording at the top of the README: a session with the page of `watch`, photographed step by step.
//!
//! ```sh
//! UNDERSTORY_RECORD=/tmp/frames cargo test --release --test recording
//! ffmpeg -y -f concat -i /tmp/frames/frames.txt -vf scale=900:-1 -c:v libwebp_anim -quality 60 -loop 0 .readme/watch.webp
//! ```
//!
//! Without the variable nothing is done. The folder then also holds the page in the dark, on a phone and with an error.

#![allow(clippy::unwrap_used, reason = "a test fails by panicking")]
#![cfg(unix)]

#[path = "support/browser.rs"]
#[allow(dead_code, reason = "each test that uses a browser uses a part of it")]
mod browser;
#[path = "support/watching.rs"]
mod watching;

use browser::Browser;
use std::fmt::Write;
use std::fs;
use std::path::{Path, PathBuf};
use std::time::{Duration, Instant};
use watching::Watch;

/// What is edited: the foxglove of the course.
const MODEL: &str = "examples/course/04-two-blocks.rgg";

/// Frames with how long each stands.
struct Reel {
    folder: PathBuf,
    list: String,
    n_frames: u32,
}

impl Reel {
    /// Photographs the page; the frame stands for so many seconds.
    fn frame(&mut self, page: &mut Browser, seconds: f64) {
        let name = format!("{:03}.png", self.n_frames);
        page.keep(&self.folder.join(&name));
        let _ = writeln!(self.list, "file {name}\nduration {seconds}");
        self.n_frames += 1;
    }

    /// Photographs the page while the picture gets better, until it is done or for so long.
    fn until_done(&mut self, page: &mut Browser, most: Duration) {
        let end = Instant::now() + most;
        while page.ask("document.querySelector('#stage').dataset.final === 'true'") != true
            && Instant::now() < end
        {
            self.frame(page, 0.3);
            std::thread::sleep(Duration::from_millis(600));
        }
        self.frame(page, 1.2);
    }
}

#[test]
fn a_session_is_recorded() {
    let Some(folder) = std::env::var_os("UNDERSTORY_RECORD").map(PathBuf::from) else {
        return;
    };
    fs::create_dir_all(&folder).unwrap();
    let desk = tempfile::tempdir().unwrap();
    let model = Path::new(env!("CARGO_MANIFEST_DIR")).join(MODEL);
    let text = fs::read_to_string(model).unwrap();
    let save = |text: &str| fs::write(desk.path().join("foxglove.rgg"), text).unwrap();
    save(&text);
    let options = "--steps 30 --size 480x320 --samples 16";
    let (_watch, address) = Watch::start(desk.path(), "foxglove.rgg", options);
    let mut page = Browser::start(1120, 700, desk.path()).unwrap();
    let mut reel = Reel {
        folder,
        list: String::new(),
        n_frames: 0,
    };
    let most = Duration::from_secs(20);

    // The first picture, from a first impression on.
    page.open(&address);
    page.until("document.querySelector('#picture')?.hidden === false");
    reel.until_done(&mut page, most);
    // An edit: larger flowers.
    save(&text.replace("Bell(0.012)", "Bell(0.03)"));
    page.until("document.querySelector('#stage').dataset.final !== 'true'");
    reel.until_done(&mut page, most);
    // A mistake, over the last good picture.
    save(&text.replace("Bell(0.012)", "Bel(0.03)"));
    page.until("document.querySelector('#problems').hidden === false");
    reel.frame(&mut page, 2.5);
    page.dress(1120, 700, true);
    page.keep(&reel.folder.join("error-dark.png"));
    page.dress(390, 1500, false);
    page.keep(&reel.folder.join("error-phone.png"));
    page.dress(1120, 700, false);
    // Recovery.
    save(&text.replace("Bell(0.012)", "Bell(0.03)"));
    page.until("document.querySelector('#problems').hidden");
    reel.until_done(&mut page, most);
    // Back to a young plant, by the slider.
    page.ask("document.querySelector('#step').focus()");
    for _ in 0..8 {
        page.key("ArrowLeft");
        page.key("ArrowLeft");
        std::thread::sleep(Duration::from_millis(400));
        reel.frame(&mut page, 0.35);
    }
    reel.until_done(&mut page, most);
    // Round it.
    let [x, y, width, height] = page.place("#stage");
    for _ in 0..4 {
        page.drag((x + width / 2.0, y + height / 2.0), (width / 12.0, 0.0));
        std::thread::sleep(Duration::from_millis(400));
        reel.frame(&mut page, 0.35);
    }
    reel.until_done(&mut page, most);
    // The last frame needs an end.
    let last = reel.list.lines().rev().nth(1).unwrap().to_owned();
    reel.list.push_str(&last);
    fs::write(reel.folder.join("frames.txt"), &reel.list).unwrap();
    page.dress(1120, 700, true);
    page.keep(&reel.folder.join("dark.png"));
    page.dress(390, 1700, false);
    page.keep(&reel.folder.join("phone.png"));
}
