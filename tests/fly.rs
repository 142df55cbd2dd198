//! Films: they are decoded again, killed and taken up again, made in parts, and asked for in impossible ways.

#![allow(clippy::unwrap_used, reason = "a test fails by panicking")]

#[cfg(unix)]
#[path = "support/browser.rs"]
#[allow(dead_code, reason = "the page of `watch` needs the rest")]
mod browser;
#[path = "support/opened.rs"]
#[allow(dead_code, reason = "flights only grow models with it")]
mod opened;

use assert_cmd::Command;
use image::AnimationDecoder;
use image::codecs::{gif::GifDecoder, png::PngDecoder, webp::WebPDecoder};
use std::collections::BTreeMap;
use std::fs;
use std::io::Cursor;
use std::path::{Path, PathBuf};
use std::process::{Output, Stdio};
use std::time::{Duration, Instant, SystemTime};
use tempfile::TempDir;

/// A small tree that grows.
const TREE: &str = "\
module Bud(float len) extends Sphere(0.05);
protected void init() [ Axiom ==> Bud(1); ]
public void run() [
    Bud(x) ==> F(x, 0.05) [ RU(40) Bud(x * 0.7) ] [ RU(-30) RH(90) Bud(x * 0.6) ];
]
";

/// Options of pictures that take no time.
const SMALL: &str = "--size 32x24 --samples 1 --max-depth 1 --threads 1 --flicker 0";

/// A folder with a model in it, gone after the test.
struct Bench {
    folder: TempDir,
}

impl Bench {
    fn new() -> Self {
        let bench = Self {
            folder: tempfile::tempdir().unwrap(),
        };
        bench.write("m.rgg", TREE);
        bench
    }

    fn path(&self, name: &str) -> PathBuf {
        self.folder.path().join(name)
    }

    fn write(&self, name: &str, text: &str) {
        fs::write(self.path(name), text).unwrap();
    }

    fn bytes(&self, name: &str) -> Vec<u8> {
        let path = self.path(name);
        fs::read(&path).unwrap_or_else(|error| panic!("{}: {error}", path.display()))
    }

    /// Runs the program in the folder; words are separated by single spaces, a `_` in a word is a space.
    fn run(&self, line: &str) -> Output {
        Command::new(env!("CARGO_BIN_EXE_understory"))
            .current_dir(self.folder.path())
            .args(line.split(' ').map(|word| word.replace('_', " ")))
            .timeout(Duration::from_secs(300))
            .output()
            .unwrap()
    }

    /// What a run says that must succeed.
    fn succeed(&self, line: &str) -> String {
        let output = self.run(line);
        let told = String::from_utf8(output.stderr).unwrap();
        assert_eq!(output.status.code(), Some(0), "{line}\n{told}");
        told
    }

    /// What a run says that must fail with this exit code.
    fn fail(&self, line: &str, code: i32) -> String {
        let output = self.run(line);
        let told = String::from_utf8(output.stderr).unwrap();
        assert_eq!(output.status.code(), Some(code), "{line}\n{told}");
        told
    }
}

fn frame(folder: &str, number: u32) -> String {
    format!("{folder}/frame-{number:06}.png")
}

/// 8-bit sRGB of a picture file.
fn pixels(file: &[u8]) -> Vec<u8> {
    image::load_from_memory(file)
        .unwrap()
        .into_rgb8()
        .into_raw()
}

/// The content of the first box of this name, anywhere in an MP4 file.
fn mp4_box<'a>(file: &'a [u8], name: &[u8; 4]) -> &'a [u8] {
    let at = file.windows(4).position(|w| w == name).unwrap();
    let size = u32::from_be_bytes(file[at - 4..at].try_into().unwrap()) as usize;
    &file[at + 4..at - 4 + size]
}

fn be(bytes: &[u8]) -> u32 {
    u32::from_be_bytes(bytes[..4].try_into().unwrap())
}

/// The pictures in an MP4 file, as an independent reader of boxes finds them.
fn mp4_frames(file: &[u8]) -> Vec<rusty_h264::YuvFrame> {
    let config = mp4_box(file, b"avcC");
    let mut stream = Vec::new();
    let mut unit = |bytes: &[u8]| {
        stream.extend_from_slice(&[0, 0, 0, 1]);
        stream.extend_from_slice(bytes);
    };
    let n = usize::from(u16::from_be_bytes([config[6], config[7]]));
    unit(&config[8..8 + n]);
    let rest = &config[8 + n..];
    let m = usize::from(u16::from_be_bytes([rest[1], rest[2]]));
    unit(&rest[3..3 + m]);
    // All pictures lie one behind the other from the first place on.
    let places = mp4_box(file, b"co64");
    let mut at = u64::from_be_bytes(places[8..16].try_into().unwrap()) as usize;
    let sizes = mp4_box(file, b"stsz");
    for size in sizes[12..].chunks(4).map(be) {
        let end = at + size as usize;
        while at < end {
            let length = be(&file[at..]) as usize;
            unit(&file[at + 4..at + 4 + length]);
            at += 4 + length;
        }
    }
    assert_eq!(at, file.len());
    rusty_h264::Decoder::new().decode_stream(&stream).unwrap()
}

/// Mean distance between the brightness of a decoded picture and that of its frame, in levels.
fn distance(decoded: &rusty_h264::YuvFrame, rgb: &[u8]) -> f64 {
    let luma = rgb.chunks(3).map(|p| {
        let [r, g, b] = [p[0], p[1], p[2]].map(f64::from);
        16.0 + (0.2126 * r + 0.7152 * g + 0.0722 * b) * 219.0 / 255.0
    });
    let differences = decoded
        .y
        .iter()
        .zip(luma)
        .map(|(y, l)| (f64::from(*y) - l).abs());
    differences.sum::<f64>() / decoded.y.len() as f64
}

#[test]
fn a_film_plays_as_many_frames_as_fast_and_as_long_as_it_says() {
    let bench = Bench::new();
    let told = bench.succeed(&format!(
        "fly m.rgg --steps 3 --orbit --flight-frames 9 --fps 12 -o a.mp4 {SMALL}"
    ));
    assert!(told.contains("9 frames, 12 per second, 0.75 s"), "{told}");
    let file = bench.bytes("a.mp4");
    let header = mp4_box(&file, b"mvhd");
    let (scale, duration) = (be(&header[12..]), be(&header[16..]));
    assert_eq!((scale % 12, duration * 12), (0, scale * 9));
    let frames = mp4_frames(&file);
    assert_eq!(frames.len(), 9);
    for (i, decoded) in (0..).zip(&frames) {
        assert_eq!((decoded.width, decoded.height), (32, 24));
        let own = pixels(&bench.bytes(&frame("a.mp4.frames", i)));
        let next = pixels(&bench.bytes(&frame("a.mp4.frames", (i + 1) % 9)));
        let (own, next) = (distance(decoded, &own), distance(decoded, &next));
        // Single samples are noise, the hardest picture for an encoder.
        assert!(own < 6.0 && own < next, "{i}: {own} {next}");
    }
}

#[test]
fn ffprobe_agrees_where_there_is_one() {
    let probe = |args: &[&str], folder: &Path| {
        let output = std::process::Command::new("ffprobe")
            .args(args)
            .current_dir(folder)
            .output();
        output
            .ok()
            .map(|output| String::from_utf8(output.stdout).unwrap())
    };
    let bench = Bench::new();
    bench.succeed(&format!(
        "fly m.rgg --orbit --flight-frames 50 --fps 24 -o a.mp4 {SMALL}"
    ));
    let wanted = "stream=codec_name,pix_fmt,width,height,avg_frame_rate,r_frame_rate,color_space,color_primaries,color_transfer,\
                  color_range,duration,nb_read_frames";
    let args = [
        "-v",
        "error",
        "-count_frames",
        "-show_entries",
        wanted,
        "-of",
        "default=nw=1",
        "a.mp4",
    ];
    let Some(told) = probe(&args, bench.folder.path()) else {
        return;
    };
    for line in [
        "codec_name=h264",
        "pix_fmt=yuv420p",
        "width=32",
        "height=24",
        "r_frame_rate=24/1",
        "avg_frame_rate=24/1",
        "color_space=bt709",
        "color_primaries=bt709",
        "color_transfer=bt709",
        "color_range=tv",
        "duration=2.083333",
        "nb_read_frames=50",
    ] {
        assert!(
            told.lines().any(|told| told == line),
            "{line} is not in\n{told}"
        );
    }
}

#[test]
fn lossless_films_hold_the_frames_themselves() {
    let bench = Bench::new();
    let fly = format!("fly m.rgg --orbit --flight-frames 5 --fps 8 {SMALL}");
    for film in ["a.png", "a.webp", "a.gif"] {
        bench.succeed(&format!("{fly} -o {film}"));
    }
    let cursor = |name: &str| Cursor::new(bench.bytes(name));
    let apng = PngDecoder::new(cursor("a.png"))
        .unwrap()
        .apng()
        .unwrap()
        .into_frames();
    let webp = WebPDecoder::new(cursor("a.webp")).unwrap().into_frames();
    let gif = GifDecoder::new(cursor("a.gif")).unwrap().into_frames();
    for (name, frames, is_exact) in [
        ("a.png", apng, true),
        ("a.webp", webp, true),
        ("a.gif", gif, false),
    ] {
        let frames = frames.collect_frames().unwrap();
        assert_eq!(frames.len(), 5, "{name}");
        let mut total = Duration::ZERO;
        for (i, shown) in (0..).zip(&frames) {
            total += Duration::from(shown.delay());
            let rgba = shown.buffer().as_raw();
            let rgb: Vec<u8> = rgba.chunks(4).flat_map(|p| [p[0], p[1], p[2]]).collect();
            let own = pixels(&bench.bytes(&frame(&format!("{name}.frames"), i)));
            if is_exact {
                assert!(rgb == own, "{name} {i}");
            } else {
                let off: f64 = rgb
                    .iter()
                    .zip(&own)
                    .map(|(a, b)| f64::from(a.abs_diff(*b)))
                    .sum();
                assert!(
                    off / (rgb.len() as f64) < 8.0,
                    "{name} {i}: {}",
                    off / rgb.len() as f64
                );
            }
        }
        let milliseconds = total.as_millis();
        // GIF counts hundredths: 5/8 s are 62.5 of them.
        assert!(
            (620..=630).contains(&milliseconds),
            "{name}: {milliseconds} ms"
        );
    }
}

#[test]
fn parts_make_the_same_film_as_one_run() {
    let bench = Bench::new();
    let fly = format!("fly m.rgg --turntable --sun 120,40 --flight-frames 7 {SMALL}");
    bench.succeed(&format!("{fly} -o whole.mp4"));
    let told = bench.succeed(&format!("{fly} -o parts.mp4 --frames 4..7"));
    assert!(told.contains("once all 7 frames are there"), "{told}");
    bench.succeed(&format!("{fly} -o parts.mp4 --frames 0..2"));
    assert!(!bench.path("parts.mp4").exists());
    let told = bench.succeed(&format!("{fly} -o parts.mp4 --frames 1..4"));
    assert!(told.contains("2 frames made, 1 kept"), "{told}");
    for i in 0..7 {
        assert!(
            bench.bytes(&frame("parts.mp4.frames", i))
                == bench.bytes(&frame("whole.mp4.frames", i)),
            "{i}"
        );
    }
    assert!(bench.bytes("parts.mp4") == bench.bytes("whole.mp4"));
}

/// Frames of the film that is broken off.
const FRAMES: u32 = 24;
/// How often it is broken off.
const KILLS: u32 = 20;

/// The frames of the film that is broken off, with the time of their last change. Each must be one of the whole film.
fn whole_frames(bench: &Bench) -> BTreeMap<u32, SystemTime> {
    let mut there = BTreeMap::new();
    for i in 0..FRAMES {
        let name = frame("killed.mp4.frames", i);
        let Ok(data) = fs::metadata(bench.path(&name)) else {
            continue;
        };
        let is_same = bench.bytes(&name) == bench.bytes(&frame("whole.mp4.frames", i));
        assert!(is_same, "{name} is not that of the whole film");
        there.insert(i, data.modified().unwrap());
    }
    there
}

/// Runs it until so many frames are there and a pause is over, then ends it: the system does, at once, or a user who is polite.
fn break_off(bench: &Bench, words: &str, n_frames: usize, pause: Duration, is_polite: bool) {
    let mut child = std::process::Command::new(env!("CARGO_BIN_EXE_understory"))
        .current_dir(bench.folder.path())
        .args(words.split(' '))
        .stderr(Stdio::null())
        .spawn()
        .unwrap();
    let count = || {
        (0..FRAMES)
            .filter(|i| bench.path(&frame("killed.mp4.frames", *i)).exists())
            .count()
    };
    while count() < n_frames && child.try_wait().unwrap().is_none() {
        std::thread::sleep(Duration::from_millis(1));
    }
    std::thread::sleep(pause);
    if is_polite && cfg!(unix) {
        // Fails if the film is made already.
        let _ = std::process::Command::new("kill")
            .args(["-INT", &child.id().to_string()])
            .stderr(Stdio::null())
            .status();
    } else {
        child.kill().unwrap();
    }
    child.wait().unwrap();
}

#[test]
fn a_run_that_is_killed_at_any_moment_goes_on_with_what_is_missing() {
    let bench = Bench::new();
    let words = format!(
        "fly m.rgg --steps 4 --orbit --flight-frames {FRAMES} --size 64x48 --samples 8 --threads 1 --flicker 0 -o"
    );
    let begin = Instant::now();
    bench.succeed(&format!("{words} whole.mp4"));
    let whole = begin.elapsed();
    let (mut there, mut n_resumed) = (BTreeMap::new(), 0);
    for kill in 0..KILLS {
        // None, one or two frames later, at any moment of a frame; without a frame, also while the program loads and grows.
        let more = kill % 3;
        let part = if more == 0 { 3 } else { FRAMES };
        let chance = understory::math::rng::hash(&[20, u64::from(kill)]) >> 40;
        let pause = (whole / part).mul_f64(chance as f64 / f64::from(1_u32 << 24));
        let n_frames = there.len() + more as usize;
        break_off(
            &bench,
            &format!("{words} killed.mp4"),
            n_frames,
            pause,
            kill % 4 == 3,
        );
        let now = whole_frames(&bench);
        for (i, changed) in &there {
            assert_eq!(
                now.get(i),
                Some(changed),
                "frame {i} is lost or was made again"
            );
        }
        n_resumed += u32::from(!there.is_empty());
        there = now;
        if bench.path("killed.mp4").exists() {
            assert!(
                bench.bytes("killed.mp4") == bench.bytes("whole.mp4"),
                "kill {kill}"
            );
            // Once more from the beginning: a finished film cannot be broken off.
            fs::remove_file(bench.path("killed.mp4")).unwrap();
            fs::remove_dir_all(bench.path("killed.mp4.frames")).unwrap();
            there.clear();
        }
    }
    assert!(n_resumed >= KILLS / 2, "only {n_resumed} runs found frames");
    let told = bench.succeed(&format!("{words} killed.mp4"));
    let missing = FRAMES as usize - there.len();
    assert!(told.contains(&format!("{missing} frames made")), "{told}");
    assert!(bench.bytes("killed.mp4") == bench.bytes("whole.mp4"));
}

/// Needs Chromium; with `UNDERSTORY_NEEDS_BROWSER=1`, as in CI, its absence is a failure.
#[test]
#[cfg(unix)]
fn films_play_in_a_browser() {
    let bench = Bench::new();
    // A ball that fills the middle while the sun goes round it: each frame has a color of its own there.
    bench.write(
        "b.rgg",
        "protected void init() [ Axiom ==> Sphere(1).(setShader(RED)); ]\n",
    );
    let fly = "fly b.rgg --key time=0_eye=0,-3,0_target=0,0,0_sun=180,60;time=2_sun=20,2 --fps 6 --size 160x120 --samples 4 --flicker 0";
    for film in ["a.mp4", "a.gif", "a.png", "a.webp"] {
        bench.succeed(&format!("{fly} -o {film}"));
    }
    let Some(mut browser) = browser::Browser::start(640, 480, bench.folder.path()) else {
        assert!(
            std::env::var_os("UNDERSTORY_NEEDS_BROWSER").is_none(),
            "there is no browser"
        );
        return;
    };
    let page = "<body style='margin:0'><video id=v src=a.mp4 muted preload=auto></video>\
                <img src=a.gif><img src=a.png><img src=a.webp></body>";
    bench.write("page.html", page);
    browser.open(&format!("file://{}", bench.path("page.html").display()));
    browser.until("document.readyState == 'complete'");
    let video = "document.getElementById('v')";
    browser.until(&format!("{video}.readyState == 4 || {video}.error != null"));
    assert!(browser.ask(&format!("{video}.error")).is_null());
    assert_eq!(browser.ask(&format!("{video}.videoWidth")), 160);
    assert_eq!(browser.ask(&format!("{video}.videoHeight")), 120);
    let duration = browser.ask(&format!("{video}.duration")).as_f64().unwrap();
    assert!((duration - 13.0 / 6.0).abs() < 0.002, "{duration}");

    // Each frame is there at its time, and none is black or broken.
    for i in 0..13 {
        let own = pixels(&bench.bytes(&frame("a.mp4.frames", i)));
        let middle = 3 * (60 * 160 + 80);
        let own = [own[middle], own[middle + 1], own[middle + 2]].map(f64::from);
        assert!(own[0] > 20.0, "frame {i} shows nothing: {own:?}");
        let time = (f64::from(i) + 0.5) / 6.0;
        browser.ask(&format!(
            "new Promise(done => {{ {video}.onseeked = () => done(1); {video}.currentTime = {time}; }})"
        ));
        // Screens follow later than seeking.
        browser.until_seen("#v", &format!("frame {i} as {own:?}"), |shot| {
            let shown = shot.at(0.5, 0.5);
            (0..3).all(|channel| (shown[channel] - own[channel]).abs() < 16.0)
        });
    }

    // Played from the beginning, it comes to its end without an error, and all frames were decoded.
    browser.ask(&format!(
        "new Promise(done => {{ {video}.onended = () => done(1); {video}.currentTime = 0; {video}.play(); }})"
    ));
    assert!(browser.ask(&format!("{video}.error")).is_null());
    let quality = format!("{video}.getVideoPlaybackQuality()");
    assert_eq!(browser.ask(&format!("{quality}.corruptedVideoFrames")), 0);
    let decoded = browser.ask(&format!("{quality}.totalVideoFrames"));
    assert!(decoded.as_u64().unwrap() >= 13, "{decoded}");

    // The other films are pictures of the same size.
    let sizes = "Promise.all([...document.images].map(i => i.decode().then(() => i.naturalWidth + 'x' + i.naturalHeight)))\
                 .then(all => all.join())";
    assert_eq!(browser.ask(sizes), "160x120,160x120,160x120");
}

#[test]
fn lens_and_shutter_blur_and_without_them_nothing_changes() {
    let bench = Bench::new();
    let fly = format!("fly m.rgg --steps 3 --orbit --flight-frames 8 --frames 0..2 -o f {SMALL}");
    bench.succeed(&fly);
    let sharp = pixels(&bench.bytes(&frame("f", 1)));
    assert!(
        bench
            .succeed(&format!("{fly} --shutter 0 --aperture none --focus auto"))
            .contains("0 frames made, 2 kept")
    );
    for blur in ["--shutter 0.5", "--aperture 0.2", "--aperture f/0.1"] {
        assert!(
            bench
                .succeed(&format!("{fly} {blur}"))
                .contains("2 frames made ("),
            "{blur}"
        );
        assert!(pixels(&bench.bytes(&frame("f", 1))) != sharp, "{blur}");
    }
    // The blur of a frame is part of what it is made from, though its moment is the same in a slower film.
    bench.succeed(&format!("{fly} --shutter 0.5"));
    let slower = fly.replace("--flight-frames 8", "--flight-frames 16");
    let told = bench
        .succeed(&format!("{slower} --frames 0..1 --shutter 0.5").replace(" --frames 0..2", ""));
    assert!(told.contains("1 frames made ("), "{told}");
    // A camera that stands still is sharp with an open shutter.
    let still = fly.replace(
        "--orbit --flight-frames 8",
        "--key time=0_eye=2,-4,1;time=1",
    );
    bench.succeed(&still);
    let closed = pixels(&bench.bytes(&frame("f", 1)));
    bench.succeed(&format!("{still} --shutter 1 --seed 1"));
    assert!(pixels(&bench.bytes(&frame("f", 1))) == closed);
    for (flags, word) in [
        ("--shutter 2", "0 (no blur) to 1"),
        ("--aperture 0", "diameter in metres"),
        ("--aperture f/x", "f/2.8"),
        ("--focus -1", "metres"),
    ] {
        let message = bench.fail(&format!("{fly} {flags}"), 2);
        assert!(message.contains(word), "{flags}: {message}");
    }
}

#[test]
fn frames_of_another_model_or_other_options_are_made_again() {
    let bench = Bench::new();
    let fly = format!("fly m.rgg --orbit --flight-frames 3 -o a.mp4 {SMALL}");
    bench.succeed(&fly);
    assert!(bench.succeed(&fly).contains("0 frames made, 3 kept"));
    assert!(
        bench
            .succeed(&format!("{fly} --seed 5"))
            .contains("3 frames made (")
    );
    let other = bench.bytes("a.mp4");
    bench.write("m.rgg", &TREE.replace("Sphere(0.05)", "Sphere(0.2)"));
    assert!(
        bench
            .succeed(&format!("{fly} --seed 5"))
            .contains("3 frames made (")
    );
    assert!(bench.bytes("a.mp4") != other);
    // A frame that is cut off is made again.
    let name = frame("a.mp4.frames", 1);
    let whole = bench.bytes(&name);
    fs::write(bench.path(&name), &whole[..whole.len() - 9]).unwrap();
    assert!(
        bench
            .succeed(&format!("{fly} --seed 5"))
            .contains("1 frames made, 2 kept")
    );
    assert!(bench.bytes(&name) == whole);
}

#[test]
fn linear_frames_are_kept_by_the_key_beside_them() {
    let bench = Bench::new();
    let fly = format!("fly m.rgg --orbit --flight-frames 3 -o f --frame-format exr {SMALL}");
    bench.succeed(&fly);
    assert!(
        bench
            .bytes("f/frame-000002.exr")
            .starts_with(&[0x76, 0x2f, 0x31, 0x01])
    );
    assert!(bench.succeed(&fly).contains("0 frames made, 3 kept"));
    assert!(
        bench
            .succeed(&format!("{fly} --seed 5"))
            .contains("3 frames made (")
    );
    let damaged = bench.bytes("f/frame-000000.exr");
    fs::write(bench.path("f/frame-000001.exr"), damaged).unwrap();
    assert!(
        bench
            .succeed(&format!("{fly} --seed 5"))
            .contains("1 frames made, 2 kept")
    );
    let message = bench.fail(&fly.replace("-o f", "-o b.mp4"), 2);
    assert!(message.contains("--frame-format"), "{message}");
}

#[test]
fn key_frames_in_the_file_beside_the_model_make_the_flight() {
    let bench = Bench::new();
    let keys = "[[fly.key]]\ntime = 0\neye = [0, -5, 1]\ntarget = [0, 0, 0.5]\nstep = 0\nsun = [90, 5]\n\
                [[fly.key]]\ntime = 1\neye = [2, -5, 1]\nstep = 3\nsun = [180, 60]\n";
    bench.write("m.toml", keys);
    let told = bench.succeed(&format!("fly m.rgg --fps 4 -o a.gif {SMALL}"));
    assert!(told.contains("5 frames, 4 per second"), "{told}");
    // The last frame is the picture of its moment, exposed as the brightest frame, which it is.
    bench.write("m.toml", "");
    bench.succeed(
        &format!(
            "render m.rgg --steps 3 --sun 180,60 --eye 2,-5,1 --target 0,0,0.5 -o last.png {SMALL}"
        )
        .replace(" --flicker 0", ""),
    );
    assert!(pixels(&bench.bytes("last.png")) == pixels(&bench.bytes(&frame("a.gif.frames", 4))));
}

/// A frame of key frames that ask for stops is the picture with so many more: the exposure of a film is that of its first frame here.
#[test]
fn key_frames_brighten_by_stops() {
    let bench = Bench::new();
    let keys = "--key time=0_eye=0,-4,1_target=0,0,1;time=1_stops=0;time=2_stops=3";
    bench.succeed(&format!(
        "fly m.rgg -o f {SMALL} {keys} --exposure -4 --flight-frames 3"
    ));
    let shown = |number: u32| pixels(&bench.bytes(&frame("f", number)));
    assert_eq!(shown(0), shown(1));
    bench.succeed(
        &format!("render m.rgg -o p.png {SMALL} --eye 0,-4,1 --target 0,0,1 --exposure -1")
            .replace(" --flicker 0", ""),
    );
    assert_eq!(shown(2), pixels(&bench.bytes("p.png")));
    assert_ne!(shown(2), shown(1));
}

#[test]
fn bad_paths_are_refused_with_what_is_wrong_and_where() {
    let bench = Bench::new();
    // So many steps that growth would not end: it must not begin.
    for (flags, word) in [
        ("", "--orbit"),
        ("--orbit --turntable", "two paths"),
        ("--key time=0", "one key frame"),
        ("--key time=1;time=0", "not after"),
        ("--key time=0;time=NaN", "from 0 up"),
        ("--key time=0;time=1_eye=1,NaN,2", "finite"),
        ("--key time=0;time=1_eye=1,2,3_target=1,2,3", "same point"),
        (
            "--flight-frames 25 --key time=0_eye=0,0,0_target=2,0,0;time=1_eye=2,0,0_target=0,0,0",
            "frame 12",
        ),
        ("--key time=0;time=1_step=-1", "from 0 up"),
        ("--key time=0;time=1e7", "1000000 frames"),
        ("--grow 3..3", "A less than B"),
        ("--orbit --frames 100..121", "--flight-frames 121"),
        ("--orbit --size 31x24", "--size 32x24"),
        ("--orbit --fps 0", "1 to 240"),
        ("--orbit --flight-frames 0", "1 to 1000000"),
        ("--orbit --even-speed", "key frames"),
    ] {
        let flags = if flags.is_empty() {
            String::new()
        } else {
            format!(" {flags}")
        };
        let size = if flags.contains("--size") {
            ""
        } else {
            " --size 32x24"
        };
        let message = bench.fail(
            &format!("fly m.rgg -o a.mp4 --steps 1000000{size}{flags}"),
            2,
        );
        assert!(message.contains(word), "{flags}: {message}");
    }
    for (keys, line, word) in [
        ("[[fly.key]]\ntime = 3\n", "m.toml:1", "one key frame"),
        ("[fly]\nkey = []\n", "m.toml:2", "no key frames"),
        (
            "[[fly.key]]\ntime = 3\n[[fly.key]]\ntime = 2\n",
            "m.toml:3",
            "not after",
        ),
        (
            "[[fly.key]]\ntime = 3\n[[fly.key]]\neye = [1, 2, 3]\n",
            "m.toml:3",
            "no `time`",
        ),
        (
            "[[fly.key]]\ntime = nan\n[[fly.key]]\ntime = 2\n",
            "m.toml:2",
            "from 0 up",
        ),
    ] {
        bench.write("m.toml", keys);
        let message = bench.fail(&format!("fly m.rgg -o a.mp4 --steps 1000000 {SMALL}"), 1);
        assert!(
            message.contains(word) && message.contains(line),
            "{keys}: {message}"
        );
    }
    assert!(!bench.path("a.mp4").exists() && !bench.path("a.mp4.frames").exists());
}

#[test]
fn a_step_that_cannot_be_reached_is_an_error() {
    let bench = Bench::new();
    bench.write("m.rgg", "protected void init() [ Axiom ==> F(1); ]\n");
    let message = bench.fail(&format!("fly m.rgg --grow 0..3 -o a.mp4 {SMALL}"), 1);
    assert!(message.contains("run"), "{message}");
}

#[test]
fn flicker_is_measured_and_told() {
    let bench = Bench::new();
    let line = "fly m.rgg --steps 3 --orbit --flight-frames 24 --frames 0..3 --size 48x32 --samples 4 --flicker 1 -o f --report r.json";
    let told = bench.succeed(line);
    assert!(told.contains("flicker "), "{told}");
    let report: serde_json::Value = serde_json::from_slice(&bench.bytes("r.json")).unwrap();
    let flicker = &report["flicker"];
    assert_eq!(flicker["pairs"], 1);
    let level = |name: &str| flicker[name].as_f64().unwrap();
    // Four light paths in a pixel are noisy.
    assert!(level("flicker_with_new_noise") > 1.0, "{flicker}");
    assert!(
        level("flicker") > 1.0 && level("flicker") <= level("change"),
        "{flicker}"
    );
    // Random numbers are those of the pixel, not of the frame: where nothing moves, nothing changes.
    let still = line
        .replace("--orbit", "--key time=0_eye=2,-4,1;time=1")
        .replace("-o f", "-o g");
    let told = bench.succeed(&still);
    assert!(told.contains("flicker 0.00 of 255"), "{told}");
}

#[test]
fn a_path_is_drawn_on_a_map_and_frames_on_a_sheet() {
    let bench = Bench::new();
    let fly = format!("fly m.rgg --orbit --flight-frames 6 {SMALL}");
    bench.succeed(&format!("{fly} --plan plan.png"));
    let map = image::load_from_memory(&bench.bytes("plan.png"))
        .unwrap()
        .into_rgb8();
    assert!(map.width() >= 700 || map.height() >= 700);
    let way = map
        .pixels()
        .filter(|pixel| pixel.0 == [200, 30, 30])
        .count();
    assert!(way > 500, "{way} pixels of the way");
    bench.succeed(&format!("{fly} -o f --sheet sheet.png"));
    let sheet = image::load_from_memory(&bench.bytes("sheet.png"))
        .unwrap()
        .into_rgb8();
    assert_eq!(sheet.dimensions(), (5 * 36 + 4, 2 * 28 + 4));
    let first = image::load_from_memory(&bench.bytes(&frame("f", 0)))
        .unwrap()
        .into_rgb8();
    assert_eq!(sheet.get_pixel(4 + 9, 4 + 7), first.get_pixel(9, 7));
}

#[test]
fn flights_over_and_through_keep_away_from_what_stands_there() {
    let bench = Bench::new();
    bench.write(
        "m.rgg",
        "protected void init() [ Axiom ==> [Plane] for (int i : -9:9) ([Translate(2 * i, 0, 0) F(6, 0.6)]); ]\n",
    );
    let keys = "--key time=0_eye=0,-8,1.7;time=2_eye=0,8,1.7 --fps 5 --sun 120,40";
    let moments = |folder: &str| -> Vec<[f64; 3]> {
        let eyes = (0..11).map(|i| {
            let file = bench.bytes(&frame(folder, i));
            let texts = understory::image::png_text::read(&file).unwrap();
            let (_, moment) = texts.into_iter().find(|(key, _)| key == "Moment").unwrap();
            let eye = moment
                .split("eye=[")
                .nth(1)
                .unwrap()
                .split(']')
                .next()
                .unwrap();
            let numbers: Vec<f64> = eye.split(", ").map(|n| n.parse().unwrap()).collect();
            [numbers[0], numbers[1], numbers[2]]
        });
        eyes.collect()
    };
    bench.succeed(&format!("fly m.rgg --walk 1.7 {keys} -o walk {SMALL}"));
    for [x, y, z] in moments("walk") {
        assert!((z - 1.7).abs() < 1e-6, "{x} {y} {z}");
        let nearest = (-9..=9).map(|i| (x - 2.0 * f64::from(i)).hypot(y));
        assert!(nearest.fold(f64::INFINITY, f64::min) > 0.4, "{x} {y}");
    }
    bench.succeed(&format!("fly m.rgg --flyover 3 {keys} -o over {SMALL}"));
    let over = moments("over");
    assert!(over.iter().all(|[_, _, z]| *z >= 3.0 - 1e-4));
    let [_, _, middle] = over[5];
    assert!(middle >= 9.0 - 1e-4, "{middle}");
    // A wall leaves no way.
    bench.write(
        "m.rgg",
        "protected void init() [ Axiom ==> [Plane] for (int i : 0:35) ([RH(10 * i) Translate(3, 0, 0) F(6, 0.6)]); ]\n",
    );
    let message = bench.fail(
        &format!("fly m.rgg --walk 1.7 --key time=0_eye=0,0,1.7;time=2_eye=0,8,1.7 -o no {SMALL}"),
        2,
    );
    assert!(message.contains("no way leads"), "{message}");
}

#[test]
fn organs_grow_between_steps() {
    let model = "module Bud(float len) extends Sphere(0.08);\nprotected void init() [ Axiom ==> F(1, 0.1) Bud(1); ]\n\
                 public void run() [ f:F ::> f.length = f.length + 1; Bud(x) ==> F(x, 0.04) Bud(x); ]\n";
    let bench = Bench::new();
    bench.write("m.rgg", model);
    let mut growth = opened::Opened::new(bench.path("m.rgg"), &[("steps", "0")]).grow();
    let earlier = growth.numbers();
    growth.step().unwrap();
    let young = growth.go_back(&earlier, 0.25);
    let tree = growth.tree_text();
    // The old internode goes from 1 to 2, the new one from 0 to 1, the new bud from 0 to its size.
    assert!(
        tree.contains("1.25") && tree.contains("0.25") && tree.contains("0.01"),
        "{tree}"
    );
    assert!(young.is_empty(), "{young:?}");

    // Frames at whole steps are the pictures of those steps; those between are neither of them.
    let fly =
        format!("fly m.rgg --grow 0..2 --flight-frames 5 --eye 0,-9,1 --target 0,0,1 -o f {SMALL}");
    bench.succeed(&fly);
    let shown: Vec<Vec<u8>> = (0..5)
        .map(|i| pixels(&bench.bytes(&frame("f", i))))
        .collect();
    for (i, pair) in shown.windows(2).enumerate() {
        assert!(pair[0] != pair[1], "frames {i} and {} are the same", i + 1);
    }
    bench.succeed(
        &fly.replace(
            "fly m.rgg --grow 0..2 --flight-frames 5",
            "render m.rgg --steps 1",
        )
        .replace("-o f", "-o one.png")
        .replace(" --flicker 0", ""),
    );
    let exposed_alike = |rgb: &[u8]| rgb.iter().map(|v| u64::from(*v)).sum::<u64>() as f64;
    let (film, alone) = (
        exposed_alike(&shown[2]),
        exposed_alike(&pixels(&bench.bytes("one.png"))),
    );
    assert!((film / alone - 1.0).abs() < 0.2, "{film} {alone}");
}

#[test]
#[cfg(unix)]
fn a_script_for_slurm_makes_the_same_film() {
    use std::os::unix::fs::PermissionsExt;
    let bench = Bench::new();
    let fly = "fly m.rgg --renderer photon --global-photons 2000 --orbit --flight-frames 6 --size 32x24 --samples 1 --threads 1";
    bench.succeed(&format!("{fly} -o whole.mp4"));
    bench.succeed(&format!("{fly} -o a.mp4 --slurm job.sh"));
    assert!(!bench.path("a.mp4.frames").exists());
    // A scheduler that does each job at once.
    bench.write(
        "sbatch",
        "#!/bin/bash\nset -e\nfor a in \"$@\"; do case \"$a\" in --array=*) array=${a#--array=};; esac; done\njob=\"${@: -1}\"\n\
         if [ -n \"$array\" ]; then for i in $(seq ${array%-*} ${array#*-}); do SLURM_ARRAY_TASK_ID=$i bash \"$job\"; done\n\
         else bash \"$job\"; fi\necho 17\n",
    );
    fs::set_permissions(bench.path("sbatch"), fs::Permissions::from_mode(0o755)).unwrap();
    let path = format!(
        "{}:{}",
        bench.folder.path().display(),
        std::env::var("PATH").unwrap()
    );
    let output = std::process::Command::new("bash")
        .arg("job.sh")
        .current_dir(bench.folder.path())
        .env("PATH", path)
        .output()
        .unwrap();
    let told = String::from_utf8_lossy(&output.stderr);
    assert!(output.status.success(), "{told}");
    assert!(String::from_utf8_lossy(&output.stdout).contains("submitted 17"));
    assert!(bench.path("a.mp4.solution").exists());
    assert!(bench.bytes("a.mp4") == bench.bytes("whole.mp4"));
}
