//! An exported room in a viewer that is not ours: three.js in a real browser, and the validator of those who made glTF.
//!
//! Needs Chromium, and both packages from the npm registry in a folder that `UNDERSTORY_NODE_MODULES` names
//! (`npm install --prefix /tmp/viewer three@0.170.0 gltf-validator@2.0.0-dev.3.10`, then `/tmp/viewer/node_modules`); where they are not,
//! it says so and looks at nothing.

#![allow(clippy::unwrap_used, reason = "a test fails by panicking")]
#![cfg(unix)]

#[path = "support/browser.rs"]
#[allow(dead_code, reason = "each test that uses a browser uses a part of it")]
mod browser;

use browser::Browser;
use std::fs;
use std::io::{BufRead, BufReader, Write};
use std::net::{TcpListener, TcpStream};
use std::path::{Path, PathBuf};
use std::process::Command;

/// The study's room with four lights, as its camera there sees it.
const ROOM: &str = concat!(
    env!("CARGO_MANIFEST_DIR"),
    "/examples/study/four_lights.rgg"
);
const SIZE: u32 = 256;
/// The page: nothing but the file, no light of its own.
const PAGE: &str = r#"<!doctype html><style>body { margin: 0; overflow: hidden } canvas { display: block }</style><canvas id="view" width="256" height="256"></canvas>
<script type="importmap">{ "imports": { "three": "/three/build/three.module.js" } }</script>
<script type="module">
import * as THREE from 'three';
import { GLTFLoader } from '/three/examples/jsm/loaders/GLTFLoader.js';
const renderer = new THREE.WebGLRenderer({ canvas: document.querySelector('#view'), antialias: true, preserveDrawingBuffer: true });
renderer.setSize(256, 256);
const scene = new THREE.Scene();
const camera = new THREE.PerspectiveCamera(37, 1, 0.01, 100);
camera.position.set(0, 1, 4.2);
camera.lookAt(0, 1, 0);
new GLTFLoader().load('/room.glb', room => {
  scene.add(room.scene);
  renderer.render(scene, camera);
  document.body.dataset.state = 'drawn';
}, undefined, error => document.body.append(error.message));
</script>"#;

/// Serves the page, the room and three.js to the browser, for as long as the test lives.
fn serve(folder: PathBuf, modules: PathBuf) -> String {
    let listener = TcpListener::bind(("127.0.0.1", 0)).unwrap();
    let address = format!("http://{}/", listener.local_addr().unwrap());
    std::thread::spawn(move || {
        for stream in listener.incoming().flatten() {
            let (folder, modules) = (folder.clone(), modules.clone());
            std::thread::spawn(move || answer(stream, &folder, &modules));
        }
    });
    address
}

fn answer(mut stream: TcpStream, folder: &Path, modules: &Path) {
    let mut lines = BufReader::new(&stream).lines().map_while(Result::ok);
    let request = lines.next().unwrap_or_default();
    for _ in lines.by_ref().take_while(|line| !line.is_empty()) {}
    let path = request.split(' ').nth(1).unwrap_or("/").to_owned();
    let (kind, body) = match path.as_str() {
        "/" => ("text/html", Ok(PAGE.as_bytes().to_vec())),
        "/room.glb" => ("model/gltf-binary", fs::read(folder.join("room.glb"))),
        path => ("text/javascript", fs::read(modules.join(&path[1..]))),
    };
    let (status, body) = match body {
        Ok(body) => ("200 OK", body),
        Err(_) => ("404 Not Found", Vec::new()),
    };
    let length = body.len();
    let head = format!(
        "HTTP/1.1 {status}\r\nContent-Type: {kind}\r\nContent-Length: {length}\r\nConnection: close\r\n\r\n"
    );
    // A browser that has gone does not matter.
    let _ = stream.write_all(head.as_bytes());
    let _ = stream.write_all(&body);
}

fn understory(folder: &Path, words: &[&str]) {
    let mut command = Command::new(env!("CARGO_BIN_EXE_understory"));
    let output = command.current_dir(folder).args(words).output().unwrap();
    let text = String::from_utf8_lossy(&output.stderr);
    assert!(output.status.success(), "{text}");
}

/// Errors and warnings that the validator finds.
fn validated(folder: &Path, modules: &Path) -> String {
    let script = "const fs = require('fs'); \
        require('gltf-validator').validateBytes(new Uint8Array(fs.readFileSync('room.glb'))) \
        .then(report => console.log(JSON.stringify(report.issues.messages.filter(message => message.severity < 2))))";
    let mut command = Command::new("node");
    command.current_dir(folder).args(["-e", script]);
    let output = command.env("NODE_PATH", modules).output().unwrap();
    String::from_utf8(output.stdout).unwrap().trim().to_owned()
}

/// The room is lit there as our own picture of the same solution is, within 6 % of white in the mean over squares of 16 × 16 pixels (8 of
/// 10 of them within 2.5 %): ours has sharp shadows, the file light at corners. It fails if colours are taken for sRGB (off by 20 % and
/// more), if the room is mirrored (walls change their colours), or turned.
#[test]
fn the_room_is_lit_in_three_js() {
    let Some(modules) = std::env::var_os("UNDERSTORY_NODE_MODULES").map(PathBuf::from) else {
        eprintln!("UNDERSTORY_NODE_MODULES is not set: no viewer was asked");
        return;
    };
    let folder = tempfile::tempdir().unwrap();
    let size = format!("{SIZE}x{SIZE}");
    let light = ["--renderer", "radiosity", "--exposure", "0"];
    let export = ["export", ROOM, "-o", "room.glb"];
    understory(folder.path(), &[&export[..], &light].concat());
    let ours = ["render", ROOM, "-o", "ours.png", "--size", &size];
    let calm = ["--samples", "16", "--supersampling", "auto"];
    understory(folder.path(), &[&ours[..], &light, &calm].concat());
    assert_eq!(validated(folder.path(), &modules), "[]");

    let mut page = Browser::start(SIZE, SIZE, folder.path()).unwrap();
    let address = serve(folder.path().into(), modules);
    page.open(&address);
    page.until("document.body?.dataset.state === 'drawn'");
    let theirs = page.shot("#view");
    if let Some(kept) = std::env::var_os("UNDERSTORY_KEEP") {
        page.keep(Path::new(&kept));
    }
    let ours = image::open(folder.path().join("ours.png"))
        .unwrap()
        .to_rgb8();
    let mut offs = Vec::new();
    for square in 0..256 {
        let (left, top) = (square % 16 * 16, square / 16 * 16);
        for channel in 0..3 {
            let pixels = (0..256).map(|i| (left + i % 16, top + i / 16));
            let off = pixels.map(|(x, y)| {
                let shown = theirs.pixel(x as usize, y as usize)[channel];
                f64::from(shown) - f64::from(ours.get_pixel(x, y)[channel])
            });
            offs.push((off.sum::<f64>() / 256.0).abs() / 255.0);
        }
    }
    offs.sort_by(f64::total_cmp);
    let (most, worst) = (offs[offs.len() * 8 / 10], offs[offs.len() - 1]);
    eprintln!("8 of 10 squares are off by at most {most:.4}, the worst by {worst:.4}");
    assert!(most < 0.025 && worst < 0.06, "{most} {worst}");
}
