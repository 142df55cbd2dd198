//! `watch` as a user meets it: an editor saves, the picture follows, mistakes are survived; the page asks, and is answered.

#![allow(clippy::unwrap_used, reason = "a test fails by panicking")]
#![cfg(unix)]

#[path = "support/visitor.rs"]
mod visitor;

use serde_json::Value;
use std::fs;
use std::io::{BufRead, BufReader};
use std::path::PathBuf;
use std::process::{Child, Command, Stdio};
use std::sync::mpsc::{Receiver, channel};
use std::time::Duration;
use tempfile::TempDir;
use visitor::{PATIENCE, Visitor};

/// A model of one sphere.
fn ball(radius: &str) -> String {
    format!("protected void init() [ Axiom ==> Sphere({radius}); ]\n")
}

/// A model that grows, with numbers to change.
const PLANT: &str = "const float LENGTH = 0.5; // of a piece\nconst int PIECES = 2;\nmodule Bud;\n\
    protected void init() [ Axiom ==> Bud; ]\n\
    public void run() [ Bud ==> for (int i : 1 : PIECES) ( Cylinder(LENGTH, 0.2).(setShader(GREEN)) M(LENGTH) ) Bud; ]\n";

/// A running `watch`.
struct Watch {
    folder: TempDir,
    child: Child,
    lines: Receiver<String>,
}

impl Watch {
    fn start() -> Self {
        Self::of(
            &ball("1"),
            &["-o", "m.png", "--steps", "0", "--size", "24x16"],
        )
    }

    fn of(model: &str, arguments: &[&str]) -> Self {
        let folder = tempfile::tempdir().unwrap();
        fs::write(folder.path().join("m.rgg"), model).unwrap();
        Self::inside(folder, &[&["--port", "0"], arguments].concat())
    }

    fn inside(folder: TempDir, arguments: &[&str]) -> Self {
        let mut child = Command::new(env!("CARGO_BIN_EXE_understory"))
            .current_dir(folder.path())
            .env_remove("VISUAL")
            .env_remove("EDITOR")
            .args(["watch", "m.rgg", "--samples", "2"])
            .args(arguments)
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
        self.until(word).pop().unwrap()
    }

    /// All lines until one holds `word`.
    fn until(&self, word: &str) -> Vec<String> {
        let mut seen = Vec::new();
        loop {
            let line = self.lines.recv_timeout(PATIENCE);
            seen.push(
                line.unwrap_or_else(|_| {
                    panic!("no line with `{word}` after:\n{}", seen.join("\n"))
                }),
            );
            if seen.last().is_some_and(|line: &String| line.contains(word)) {
                return seen;
            }
        }
    }

    /// Somebody who looks at the page.
    fn visitor(&self) -> Visitor {
        let line = self.wait("http://localhost:");
        let port = line.split("localhost:").nth(1).unwrap();
        let port = port.split('/').next().unwrap().parse().unwrap();
        Visitor { port }
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

impl Drop for Watch {
    fn drop(&mut self) {
        // A test that failed leaves nothing running. One that ended well has waited for the end.
        let _ = self.child.kill();
        let _ = self.child.wait();
    }
}

/// How often a stage has run.
fn work(state: &Value, stage: &str) -> u64 {
    state["work"][stage].as_u64().unwrap()
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

    // Emptied, and filled only a while later.
    fs::write(watch.path("m.rgg"), "").unwrap();
    std::thread::sleep(Duration::from_millis(150));
    fs::write(watch.path("m.rgg"), ball("5")).unwrap();
    let seen = watch.until("m.png: 24x16");
    assert!(
        !seen.iter().any(|line| line == "waiting for a change"),
        "{seen:?}"
    );

    // Several files at once are one change.
    fs::write(watch.path("m.rgg"), ball("4")).unwrap();
    fs::write(watch.path("m.toml"), "[camera]\nfov = 39\n").unwrap();
    watch.wait("m.rgg, m.toml changed");
    watch.wait("m.png: 24x16");
    fs::remove_file(watch.path("m.toml")).unwrap();
    watch.wait("m.toml changed");
    watch.wait("m.png: 24x16");
    assert!(watch.picture() == last, "as it was");

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

#[test]
fn the_page_sees_pictures_errors_and_recovery() {
    let watch = Watch::of(&ball("1"), &["--steps", "0", "--size", "60x40"]);
    let visitor = watch.visitor();
    let mut events = visitor.events();
    let state = events.whole("a first picture", |_| true);
    assert_eq!(state["name"], "m.rgg");
    let number = state["frame"]["number"].as_u64().unwrap();
    let frame = visitor.get(&format!("/frame/{number}"));
    assert_eq!(frame.status, 200);
    assert!(frame.head.contains("image/png") && frame.body.starts_with(b"\x89PNG"));
    assert_eq!(visitor.get("/frame/999").status, 404);

    // The picture to be saved is the one that the command makes.
    let command = state["command"].as_str().unwrap();
    let words: Vec<&str> = command.split(' ').skip(1).collect();
    let made = Command::new(env!("CARGO_BIN_EXE_understory"))
        .current_dir(watch.folder.path())
        .args(&words)
        .output()
        .unwrap();
    assert!(made.status.success(), "{command}: {made:?}");
    assert!(
        visitor.get("/picture.png").body == watch.picture(),
        "{command}"
    );

    fs::write(
        watch.path("m.rgg"),
        "\n\nprotected void init() [ Axiom ==> Spher(1); ]",
    )
    .unwrap();
    let state = events.until("an error", |state| state["activity"] == "failed");
    let problem = &state["problems"][0];
    let place = &problem["place"];
    assert_eq!(
        (&place["line"], &place["name"]),
        (&3.into(), &"m.rgg".into())
    );
    assert!(place["text"].as_str().unwrap().contains("Spher(1)"));
    assert!(state["frame"].is_object(), "the last good picture stays");
    // … and can be looked at from elsewhere.
    let before = state["frame"]["number"].as_u64();
    let wish = r#"{"options":{"eye":"9,1,2","target":"0,0,0"}}"#;
    assert_eq!(visitor.post("/wish", wish).status, 204);
    let state = events.until("another view", |state| {
        let frame = &state["frame"];
        frame["is_final"] == true && frame["number"].as_u64() > before
    });
    assert_eq!(state["problems"].as_array().unwrap().len(), 1);

    fs::write(watch.path("m.rgg"), ball("2")).unwrap();
    let state = events.whole("recovery", |state| state["round"] == 3);
    assert_eq!(state["problems"], serde_json::json!([]));
    assert_eq!(state["changed"], serde_json::json!(["m.rgg"]));
    assert_eq!(watch.stop(), Some(0));
}

#[test]
fn each_change_repeats_only_what_it_touches() {
    let watch = Watch::of(PLANT, &["--steps", "2", "--size", "30x20"]);
    let visitor = watch.visitor();
    let mut events = visitor.events();
    let first = events.whole("a first picture", |_| true);
    assert_eq!((work(&first, "growths"), work(&first, "views")), (1, 1));

    // The same text again: nothing at all.
    fs::write(watch.path("m.rgg"), PLANT).unwrap();
    // The camera: only the view.
    let ask = |wish: &str| assert_eq!(visitor.post("/wish", wish).status, 204, "{wish}");
    ask(r#"{"options":{"eye":"9,1,2","target":"0,0,1"}}"#);
    let state = events.whole("another view", |state| work(state, "views") == 2);
    for stage in ["checks", "growths", "drawings", "accels", "solutions"] {
        assert_eq!(work(&state, stage), 1, "{stage} after a move of the camera");
    }
    assert_eq!(state["round"], 1, "the same text is no change");

    // The sun: no growth, no shapes.
    ask(r#"{"options":{"sun":"90,30"}}"#);
    let state = events.whole("another sun", |state| work(state, "scenes") == 2);
    for stage in ["checks", "growths", "drawings", "accels"] {
        assert_eq!(work(&state, stage), 1, "{stage} after a move of the sun");
    }

    // The renderer: the same scene.
    ask(r#"{"options":{"sun":"90,30","renderer":"raytracer"}}"#);
    let state = events.whole("another renderer", |state| work(state, "solutions") == 3);
    assert_eq!((work(&state, "growths"), work(&state, "scenes")), (1, 2));
    assert_eq!(state["options"]["renderer"]["text"], "raytracer");

    // A colour in the text: grown again, since a rule may ask for it, but no new acceleration structure.
    ask("{}");
    events.whole("the plant as it was", |state| work(state, "scenes") == 3);
    fs::write(watch.path("m.rgg"), PLANT.replace("GREEN", "RED")).unwrap();
    let state = events.whole("another colour", |state| state["round"] == 2);
    assert_eq!((work(&state, "growths"), work(&state, "accels")), (2, 1));
    fs::write(watch.path("m.rgg"), PLANT).unwrap();
    let state = events.whole("the first colour", |state| state["round"] == 3);
    assert_eq!((work(&state, "growths"), work(&state, "accels")), (3, 1));

    // Steps and constants: growth, and not a byte of the file.
    ask(r#"{"options":{"steps":"3"}}"#);
    let state = events.whole("another step", |state| work(state, "growths") == 4);
    assert_eq!(state["options"]["steps"]["text"], "3");
    ask(r#"{"constants":{"m.LENGTH":"0.75"}}"#);
    let state = events.whole("another length", |state| work(state, "growths") == 5);
    assert!(
        state["command"]
            .as_str()
            .unwrap()
            .ends_with("--set m.LENGTH=0.75")
    );
    assert_eq!(state["constants"][0]["text"], "0.5");
    assert_eq!(fs::read_to_string(watch.path("m.rgg")).unwrap(), PLANT);

    // … until it is to be written.
    assert_eq!(
        visitor
            .post("/write", r#"{"constants":{"m.LENGTH":"0.75"}}"#)
            .text(),
        "m.rgg"
    );
    events.whole("the file", |state| state["constants"][0]["text"] == "0.75");
    assert_eq!(
        fs::read_to_string(watch.path("m.rgg")).unwrap(),
        PLANT.replace("0.5;", "0.75;")
    );
    assert_eq!(watch.stop(), Some(0));
}

#[test]
fn files_that_a_model_reads_are_watched_as_its_texts_are() {
    let folder = tempfile::tempdir().unwrap();
    let at = |name: &str| folder.path().join(name);
    fs::create_dir(at("data")).unwrap();
    fs::write(at("data/radius.csv"), "1\n").unwrap();
    let model = "protected void init() { BufferedReader in = new BufferedReader(new FileReader(\"data/radius.csv\"));\n\
        float r = Float.parseFloat(in.readLine()); in.close(); [ Axiom ==> Sphere(r); ] }\n";
    fs::write(at("m.rgg"), model).unwrap();
    let arguments = [
        "--port",
        "0",
        "--steps",
        "0",
        "--size",
        "24x16",
        "--eye=0,-9,2",
        "--target=0,0,0",
        "-o",
        "m.png",
    ];
    let watch = Watch::inside(folder, &arguments);
    let mut events = watch.visitor().events();
    events.whole("a first picture", |_| true);
    let first = watch.picture();
    fs::write(watch.path("data/radius.csv"), "2\n").unwrap();
    let state = events.whole("other data", |state| state["round"] == 2);
    assert_eq!(state["changed"], serde_json::json!(["radius.csv"]));
    assert!(watch.picture() != first, "{state}");
    // Away and back again, as some tools save.
    fs::remove_file(watch.path("data/radius.csv")).unwrap();
    events.until("a complaint", |state| state["activity"] == "failed");
    fs::write(watch.path("data/radius.csv"), "1\n").unwrap();
    events.whole("the data that came back", |_| true);
    assert!(watch.picture() == first);
    assert_eq!(watch.stop(), Some(0));
}

#[test]
fn strangers_are_turned_away_and_no_path_is_told() {
    let watch = Watch::of(&ball("1"), &["--steps", "0", "--size", "24x16"]);
    let visitor = watch.visitor();
    let port = visitor.port;
    let page = visitor.get("/");
    assert!(page.status == 200 && page.text().contains("<!doctype html>"));
    assert!(page.head.to_lowercase().contains("content-security-policy"));
    let with = |lines: &str| {
        let request = format!("GET / HTTP/1.1\r\nConnection: close\r\n{lines}\r\n");
        visitor.say(&request).status
    };
    assert_eq!(with(&format!("Host: 127.0.0.1:{port}\r\n")), 200);
    assert_eq!(with(&format!("Host: evil.example:{port}\r\n")), 403);
    assert_eq!(
        with(&format!(
            "Host: localhost:{port}\r\nOrigin: http://evil.example\r\n"
        )),
        403
    );
    assert_eq!(
        with(&format!(
            "Host: localhost:{port}\r\nSec-Fetch-Site: cross-site\r\n"
        )),
        403
    );
    let unsigned = format!(
        "POST /wish HTTP/1.1\r\nHost: localhost:{port}\r\nConnection: close\r\n\
         Content-Type: application/json\r\nContent-Length: 2\r\n\r\n{{}}"
    );
    assert_eq!(visitor.say(&unsigned).status, 403);
    for (path, json) in [
        ("/wish", r#"{"options":{"sky":"/etc/passwd.exr"}}"#),
        ("/wish", r#"{"options":{"steps":"many"}}"#),
        ("/open", r#"{"file":0,"line":1,"column":1}"#),
        ("/open", r#"{"file":77,"line":1,"column":1}"#),
        ("/write", r#"{}"#),
    ] {
        assert_eq!(visitor.post(path, json).status, 422, "{path} {json}");
    }
    assert!(visitor.post("/wish", r#"{"x":1}"#).status >= 400);
    assert_eq!(visitor.get("/../../etc/passwd").status, 404);

    // Whatever goes wrong, no folder of the machine is named.
    let mut events = visitor.events();
    fs::remove_file(watch.path("m.rgg")).unwrap();
    let state = events.until("a missing model", |state| state["activity"] == "failed");
    assert!(!state["problems"].as_array().unwrap().is_empty());
    let folder = watch.folder.path().to_str().unwrap();
    assert!(!state.to_string().contains(folder), "{state}");
    fs::write(watch.path("m.rgg"), ball("2")).unwrap();
    events.whole("the model that came back", |state| {
        state["round"].as_u64() > Some(1)
    });
    assert_eq!(watch.stop(), Some(0));
}

#[test]
fn a_second_watch_takes_another_port_and_says_so() {
    let one = Watch::of(&ball("1"), &["--steps", "0", "--size", "24x16"]);
    let port = one.visitor().port;
    let folder = tempfile::tempdir().unwrap();
    fs::write(folder.path().join("m.rgg"), ball("2")).unwrap();
    let other = Watch::inside(folder, &["--port", &port.to_string(), "--steps", "0"]);
    let line = other.wait("http://localhost:");
    assert!(line.contains(&format!("port {port} is taken")), "{line}");
    assert!(!line.contains(&format!("localhost:{port}/")), "{line}");
    // Who leaves ends the events of who looks.
    let mut events = Visitor { port }.events();
    assert!(events.next().is_some());
    assert_eq!(one.stop(), Some(0));
    while events.next().is_some() {}
    assert_eq!(other.stop(), Some(0));
}

#[test]
fn once_makes_one_picture_and_ends() {
    let folder = tempfile::tempdir().unwrap();
    let run = |model: &str| {
        fs::write(folder.path().join("m.rgg"), model).unwrap();
        Command::new(env!("CARGO_BIN_EXE_understory"))
            .current_dir(folder.path())
            .args(["watch", "m.rgg", "--once", "-o", "m.png", "--size", "24x16"])
            .args(["--samples", "2", "--steps", "0"])
            .output()
            .unwrap()
    };
    let good = run(&ball("1"));
    assert_eq!(good.status.code(), Some(0), "{good:?}");
    assert!(folder.path().join("m.png").exists());
    assert_eq!(run("void init() [ Axiom ==> ").status.code(), Some(1));
}

#[test]
fn every_editor_has_its_way_of_saving() {
    let folder = tempfile::tempdir().unwrap();
    let at = |name: &str| folder.path().join(name);
    fs::create_dir(at("far")).unwrap();
    fs::write(at("far/model.rgg"), ball("1")).unwrap();
    // A link into a folder from which no events come: a look once a second finds what they miss.
    std::os::unix::fs::symlink("far/model.rgg", at("m.rgg")).unwrap();
    let watch = Watch::inside(folder, &["--port", "0", "--steps", "0", "--size", "24x16"]);
    let visitor = watch.visitor();
    let mut events = visitor.events();
    events.whole("a first picture", |_| true);
    let path = |name: &str| watch.path(name);
    type Save = fn(&dyn Fn(&str) -> PathBuf, &str);
    let styles: [(&str, Save); 6] = [
        ("behind a link", |at, text| {
            fs::write(at("far/model.rgg"), text).unwrap();
        }),
        ("emacs: a copy aside, then in place", |at, text| {
            fs::copy(at("m.rgg"), at("m.rgg~")).unwrap();
            fs::write(at("m.rgg"), text).unwrap();
        }),
        (
            "vim: moved aside, made anew, the old one removed",
            |at, text| {
                fs::rename(at("m.rgg"), at("m.rgg~")).unwrap();
                fs::write(at("m.rgg"), text).unwrap();
                fs::remove_file(at("m.rgg~")).unwrap();
            },
        ),
        (
            "gedit, VS Code's atomic way: a new file over the old one",
            |at, text| {
                fs::write(at(".m.rgg.tmp"), text).unwrap();
                fs::rename(at(".m.rgg.tmp"), at("m.rgg")).unwrap();
            },
        ),
        ("removed, and made again a moment later", |at, text| {
            fs::remove_file(at("m.rgg")).unwrap();
            std::thread::sleep(Duration::from_millis(60));
            fs::write(at("m.rgg"), text).unwrap();
        }),
        ("in pieces", |at, text| {
            use std::io::Write;
            let mut file = fs::File::create(at("m.rgg")).unwrap();
            for piece in text.as_bytes().chunks(20) {
                file.write_all(piece).unwrap();
                std::thread::sleep(Duration::from_millis(5));
            }
        }),
    ];
    for (number, (name, save)) in styles.iter().enumerate() {
        let radius = format!("1.{}", number + 1);
        save(&path, &ball(&radius));
        let saved = events.whole(name, |state| {
            state["round"].as_u64() > Some(1 + number as u64)
        });
        // What counts is what is seen: the picture of this radius.
        assert!(
            saved["problems"] == serde_json::json!([]),
            "{name}: {saved}"
        );
        let out = Command::new(env!("CARGO_BIN_EXE_understory"))
            .current_dir(watch.folder.path())
            .args(["render", "m.rgg", "-o", "r.png", "--steps", "0"])
            .args(["--size", "24x16", "--samples", "2"])
            .output()
            .unwrap();
        assert!(out.status.success(), "{out:?}");
        let made = fs::read(watch.path("r.png")).unwrap();
        fs::remove_file(watch.path("r.png")).unwrap();
        let mut shown = visitor.get("/picture.png").body;
        // A save in pieces may have been seen in the midst of it.
        while shown != made {
            events
                .next()
                .unwrap_or_else(|| panic!("{name}: not the last text"));
            shown = visitor.get("/picture.png").body;
        }
    }
    // Touched, not changed: nothing is done.
    let before = fs::read(watch.path("m.rgg")).unwrap();
    fs::write(watch.path("m.rgg"), before).unwrap();
    fs::write(watch.path("m.toml"), "[camera]\nfov = 20\n").unwrap();
    events.whole("the file beside it", |state| {
        state["changed"] == serde_json::json!(["m.toml"])
    });
    assert_eq!(watch.stop(), Some(0));
}

#[test]
fn a_full_disk_is_told_and_outlived() {
    let folder = tempfile::tempdir().unwrap();
    fs::create_dir(folder.path().join("disk")).unwrap();
    let disk = Disk::mount(&folder.path().join("disk"));
    fs::write(folder.path().join("m.rgg"), ball("1")).unwrap();
    let arguments = [
        "--port",
        "0",
        "--steps",
        "0",
        "--size",
        "60x40",
        "-o",
        "disk/m.png",
    ];
    let watch = Watch::inside(folder, &arguments);
    watch.wait("disk/m.png: 60x40");
    let good = fs::read(watch.path("disk/m.png")).unwrap();

    disk.fill();
    fs::write(watch.path("m.rgg"), ball("2")).unwrap();
    let seen = watch.until("waiting for a change").join("\n");
    assert!(seen.contains("m.png"), "which file: {seen}");
    // The last good picture is whole, and nothing lies beside it.
    disk.free();
    assert!(fs::read(watch.path("disk/m.png")).unwrap() == good);
    assert_eq!(fs::read_dir(watch.path("disk")).unwrap().count(), 1);

    fs::write(watch.path("m.rgg"), ball("3")).unwrap();
    watch.wait("disk/m.png: 60x40");
    assert!(fs::read(watch.path("disk/m.png")).unwrap() != good);
    drop(disk);
    assert_eq!(watch.stop(), Some(0));
}

/// A very small file system, or where none may be mounted, a folder that is not there for a while.
struct Disk {
    path: PathBuf,
    is_mounted: bool,
}

impl Disk {
    fn mount(path: &std::path::Path) -> Self {
        let mount = Command::new("mount")
            .args(["-t", "tmpfs", "-o", "size=64k", "tmpfs"])
            .arg(path)
            .stderr(Stdio::null())
            .status();
        Self {
            path: path.to_owned(),
            is_mounted: mount.is_ok_and(|status| status.success()),
        }
    }

    fn away(&self) -> PathBuf {
        self.path.with_extension("away")
    }

    /// From here on there is no room.
    fn fill(&self) {
        if !self.is_mounted {
            return fs::rename(&self.path, self.away()).unwrap();
        }
        use std::io::Write;
        let mut file = fs::File::create(self.path.join("ballast")).unwrap();
        while file.write_all(&[0; 512]).is_ok() {}
    }

    /// Here there is room again.
    fn free(&self) {
        if self.is_mounted {
            fs::remove_file(self.path.join("ballast")).unwrap();
        } else {
            fs::rename(self.away(), &self.path).unwrap();
        }
    }
}

impl Drop for Disk {
    fn drop(&mut self) {
        if self.is_mounted {
            // Lazily: the program still runs.
            let _ = Command::new("umount").arg("-l").arg(&self.path).status();
        }
    }
}

#[test]
fn many_saves_leak_nothing() {
    let watch = Watch::of(PLANT, &["--steps", "3", "--size", "30x20"]);
    let mut events = watch.visitor().events();
    events.whole("a first picture", |_| true);
    let memory = || {
        let status = fs::read_to_string(format!("/proc/{}/status", watch.child.id()));
        let status = status.unwrap_or_default();
        let line = status.lines().find_map(|line| line.strip_prefix("VmRSS:"));
        line.and_then(|line| line.trim().trim_end_matches(" kB").parse::<f64>().ok())
    };
    let mut early = None;
    for n in 1..=300_u64 {
        // Every tenth one is a mistake, every other one changes a rule.
        let text = match n % 10 {
            9 => PLANT.replace("Bud ==>", "Bud ==>> ==>"),
            _ => PLANT.replace("0.2)", &format!("0.{:02})", 10 + n % 83)),
        };
        fs::write(watch.path("m.rgg"), text).unwrap();
        events.until("the end of a round", |state| {
            let is_over = state["activity"] == "done" || state["activity"] == "failed";
            is_over && state["round"].as_u64() == Some(n + 1)
        });
        if n == 100 {
            early = memory();
        }
    }
    // Only Linux tells.
    if let Some((early, late)) = early.zip(memory()) {
        assert!(
            late < 1.1 * early,
            "{early} kB after 100 saves, {late} after 300"
        );
    }
    assert_eq!(watch.stop(), Some(0));
}
