//! `watch` as a user meets it: an editor saves, the picture follows, mistakes are survived.

#![allow(clippy::unwrap_used, reason = "a test fails by panicking")]
#![cfg(unix)]

use std::fs;
use std::io::{BufRead, BufReader};
use std::path::PathBuf;
use std::process::{Child, Command, Stdio};
use std::sync::mpsc::{Receiver, channel};
use std::time::Duration;
use tempfile::TempDir;

/// A model of one sphere.
fn ball(radius: &str) -> String {
    format!("protected void init() [ Axiom ==> Sphere({radius}); ]\n")
}

/// A running `watch`.
struct Watch {
    folder: TempDir,
    child: Child,
    lines: Receiver<String>,
}

impl Watch {
    fn start() -> Self {
        let folder = tempfile::tempdir().unwrap();
        fs::write(folder.path().join("m.rgg"), ball("1")).unwrap();
        let mut child = Command::new(env!("CARGO_BIN_EXE_understory"))
            .current_dir(folder.path())
            .args([
                "watch",
                "m.rgg",
                "-o",
                "m.png",
                "--size",
                "24x16",
                "--samples",
                "2",
            ])
            .args(["--steps", "0"])
            .stderr(Stdio::piped())
            .spawn()
            .unwrap();
        let stderr = BufReader::new(child.stderr.take().unwrap());
        let (sender, lines) = channel();
        std::thread::spawn(move || {
            for line in stderr.lines() {
                if sender.send(line.unwrap()).is_err() {
                    break;
                }
            }
        });
        Self {
            folder,
            child,
            lines,
        }
    }

    fn path(&self, name: &str) -> PathBuf {
        self.folder.path().join(name)
    }

    /// Waits until a line holds `word`, and returns it.
    fn wait(&self, word: &str) -> String {
        let mut seen = Vec::new();
        loop {
            match self.lines.recv_timeout(Duration::from_secs(60)) {
                Ok(line) if line.contains(word) => return line,
                Ok(line) => seen.push(line),
                Err(_) => panic!("no line with `{word}` after:\n{}", seen.join("\n")),
            }
        }
    }

    fn picture(&self) -> Vec<u8> {
        fs::read(self.path("m.png")).unwrap()
    }

    /// Sends Ctrl-C and returns the exit code.
    fn stop(mut self) -> Option<i32> {
        let id = self.child.id().to_string();
        assert!(
            Command::new("kill")
                .args(["-INT", &id])
                .status()
                .unwrap()
                .success()
        );
        self.child.wait().unwrap().code()
    }
}

#[test]
fn the_picture_follows_every_way_of_saving_and_survives_mistakes() {
    let watch = Watch::start();
    watch.wait("m.png: 24x16");
    let first = watch.picture();

    // Written in place.
    fs::write(watch.path("m.rgg"), ball("2")).unwrap();
    watch.wait("m.rgg changed");
    watch.wait("m.png: 24x16");

    // A new file renamed over the old one.
    fs::write(watch.path("m.rgg.new"), ball("3")).unwrap();
    fs::rename(watch.path("m.rgg.new"), watch.path("m.rgg")).unwrap();
    watch.wait("m.rgg changed");
    watch.wait("m.png: 24x16");

    // The old file moved aside and a new one made, as vim does.
    fs::rename(watch.path("m.rgg"), watch.path("m.rgg~")).unwrap();
    fs::write(watch.path("m.rgg"), ball("4")).unwrap();
    watch.wait("m.rgg changed");
    watch.wait("m.png: 24x16");
    let last = watch.picture();

    // Half typed: the error is shown with its line, the last good picture stays.
    fs::write(
        watch.path("m.rgg"),
        "\n\nprotected void init() [ Axiom ==> Sphere(",
    )
    .unwrap();
    watch.wait("m.rgg:3");
    watch.wait("waiting for a change");
    assert!(watch.picture() == last);

    // Only the camera changes: nothing is grown again.
    fs::write(watch.path("m.rgg"), ball("1")).unwrap();
    watch.wait("m.png: 24x16");
    assert!(
        watch.picture() == first,
        "the same model again, the same picture"
    );
    fs::write(watch.path("m.toml"), "[camera]\nfov = 20\n").unwrap();
    watch.wait("m.toml changed");
    watch.wait("m.png: 24x16");
    assert!(watch.picture() != first);
    assert_eq!(watch.stop(), Some(0));
}
