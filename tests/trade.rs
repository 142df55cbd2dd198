//! `understory trade` as its user meets it: files, budget, stop and resume, presets.

#![allow(clippy::unwrap_used, reason = "a test may panic")]

use assert_cmd::Command;
use serde_json::Value;
use std::fs;
use std::path::Path;

/// A lamp over a matt floor with a ball: all methods can show it.
const MODEL: &str = "
const Shader GRAY = new RGBAShader(0.6, 0.6, 0.6);
protected void init() [
    Axiom ==>
        [ Translate(0, 0, 2) Rotate(-90, 0, 0) Parallelogram(1, 1).(setLight(new AreaLight().(setPower(40)))) ]
        [ Translate(0, 0, 0.4) Sphere(0.4).(setShader(GRAY)) ]
        [ Translate(0, 0, -0.1) Box(0.1, 4, 4).(setShader(GRAY)) ];
]
";

fn model(folder: &Path) -> String {
    let path = folder.join("ball.rgg");
    fs::write(&path, MODEL).unwrap();
    path.to_string_lossy().into_owned()
}

fn trade(model: &str, output: &Path, more: &[&str]) -> Command {
    let mut command = Command::cargo_bin("understory").unwrap();
    command.args(["trade", model, "-o"]).arg(output);
    command.args(["--seeds", "2", "--quiet"]).args(more);
    if !more.contains(&"--size") {
        command.args(["--size", "24x16"]);
    }
    command
}

fn findings(folder: &Path) -> Value {
    serde_json::from_slice(&fs::read(folder.join("trade.json")).unwrap()).unwrap()
}

/// Keys of all settings that were measured, with their errors.
fn measured(findings: &Value) -> Vec<(String, f64)> {
    let ladders = findings["families"].as_array().unwrap().iter();
    let rungs = ladders.flat_map(|ladder| ladder["rungs"].as_array().unwrap());
    rungs
        .map(|rung| {
            (
                rung["key"].as_str().unwrap().to_owned(),
                rung["error"].as_f64().unwrap(),
            )
        })
        .collect()
}

#[test]
fn everything_is_written_and_the_presets_are_those_of_the_front() {
    let folder = tempfile::tempdir().unwrap();
    let (model, out) = (model(folder.path()), folder.path().join("t"));
    trade(&model, &out, &["--budget", "20"]).assert().success();
    for name in [
        "index.html",
        "trade.csv",
        "trade.json",
        "presets.toml",
        "front-1.svg",
        "front-1000.svg",
    ] {
        assert!(fs::metadata(out.join(name)).unwrap().len() > 100, "{name}");
    }
    let found = findings(&out);
    let names: Vec<&str> = found["families"]
        .as_array()
        .unwrap()
        .iter()
        .map(|l| l["name"].as_str().unwrap())
        .collect();
    assert_eq!(
        names[..4],
        ["path", "photon", "photon, gathered", "radiosity"]
    );
    // How many are done in time is up to the machine.
    assert!(measured(&found).len() >= 4, "{:?}", measured(&found));
    let page = fs::read_to_string(out.join("index.html")).unwrap();
    for rung in found["families"][0]["rungs"].as_array().unwrap() {
        for picture in rung["pictures"].as_array().unwrap() {
            assert!(out.join(picture.as_str().unwrap()).exists());
        }
    }
    assert!(page.contains("ball.rgg") && page.contains("pictures/reference.png"));

    // The preset is what `render` uses, and says so.
    let presets: toml::Table = fs::read_to_string(out.join("presets.toml"))
        .unwrap()
        .parse()
        .unwrap();
    let draft = presets["draft"].as_table().unwrap();
    let mut command = Command::cargo_bin("understory").unwrap();
    let explained = command
        .args([
            "render",
            &model,
            "--explain-options",
            "--quality",
            "draft",
            "--presets",
        ])
        .arg(out.join("presets.toml"))
        .output()
        .unwrap();
    let explained = String::from_utf8(explained.stdout).unwrap();
    for (key, value) in draft {
        let line = explained
            .lines()
            .find(|line| line.split_whitespace().next() == Some(key))
            .unwrap();
        assert!(
            line.contains(value.as_str().unwrap()) && line.contains("preset draft"),
            "{line}"
        );
    }
}

/// What is known is kept to the last digit, seconds included: it is not measured again.
#[test]
fn a_measurement_goes_on_where_it_was() {
    let folder = tempfile::tempdir().unwrap();
    let (model, out) = (model(folder.path()), folder.path().join("t"));
    let flags = ["--renderer", "raytracer", "--budget", "15"];
    let run = || {
        trade(&model, &out, &flags).assert().success();
        findings(&out)
    };
    let (first, second) = (run(), run());
    assert_eq!(measured(&first).len(), 4, "the ladder ends: {first:#}");
    assert_eq!(first["families"], second["families"]);
    // Another size is another measurement, and what is known of the first one stays.
    trade(
        &model,
        &out,
        &[
            "--renderer",
            "raytracer",
            "--budget",
            "15",
            "--size",
            "16x16",
        ],
    )
    .assert()
    .success();
    let other = findings(&out);
    assert!(
        measured(&other)
            .iter()
            .all(|rung| !measured(&first).contains(rung))
    );
    assert_eq!(other["earlier"].as_array().unwrap().len(), 4);
}

/// Killed at any moment, what is in the folder is whole, and the next run uses it.
#[cfg(unix)]
#[test]
fn a_killed_measurement_leaves_whole_files() {
    let folder = tempfile::tempdir().unwrap();
    let (model, out) = (model(folder.path()), folder.path().join("t"));
    for milliseconds in [400, 900, 1700] {
        let program = assert_cmd::cargo::cargo_bin("understory");
        let mut child = std::process::Command::new(program)
            .args(["trade", &model, "-o"])
            .arg(&out)
            .args([
                "--size", "24x16", "--seeds", "2", "--quiet", "--budget", "20",
            ])
            .spawn()
            .unwrap();
        std::thread::sleep(std::time::Duration::from_millis(milliseconds));
        child.kill().unwrap();
        child.wait().unwrap();
        if let Ok(text) = fs::read(out.join("trade.json")) {
            serde_json::from_slice::<Value>(&text).unwrap();
        }
    }
    trade(&model, &out, &["--budget", "5"]).assert().success();
    assert!(out.join("index.html").exists());
}

#[test]
fn what_cannot_be_is_told() {
    let folder = tempfile::tempdir().unwrap();
    let model = model(folder.path());
    let photos = folder.path().join("photos");
    fs::create_dir(&photos).unwrap();
    fs::write(photos.join("cat.png"), "cat").unwrap();
    let refused = trade(&model, &photos, &[]).output().unwrap();
    assert_eq!(refused.status.code(), Some(3));
    assert!(String::from_utf8_lossy(&refused.stderr).contains("not an earlier measurement"));
    assert_eq!(fs::read_dir(&photos).unwrap().count(), 1);
    let out = folder.path().join("t");
    for (flags, code, text) in [
        (["--seeds", "1"], 2, "seeds"),
        (["--budget", "soon"], 2, "budget"),
        (["--renderer", "radiance"], 2, "radiosity"),
    ] {
        let output = trade(&model, &out, &flags).output().unwrap();
        assert_eq!(output.status.code(), Some(code), "{flags:?}");
        assert!(
            String::from_utf8_lossy(&output.stderr).contains(text),
            "{flags:?}"
        );
    }
    let toml = folder.path().join("wrong.toml");
    fs::write(&toml, "[draft]\nsmaples = 3\n").unwrap();
    let mut command = Command::cargo_bin("understory").unwrap();
    let output = command
        .args(["render", &model, "--explain-options", "--presets"])
        .arg(&toml)
        .output()
        .unwrap();
    assert_eq!(output.status.code(), Some(2));
    let error = String::from_utf8_lossy(&output.stderr).into_owned();
    assert!(
        error.contains("smaples") && error.contains("samples"),
        "{error}"
    );
}
