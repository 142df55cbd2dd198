//! Lit surfaces in files of glTF, read by a reader that is not ours.

#![allow(clippy::unwrap_used, reason = "a test may panic")]

use glam::DVec3;
use std::f64::consts::PI;
use std::fs;
use std::path::Path;
use std::process::{Command, Output};
use tempfile::TempDir;

/// A floor of 4 × 4 m, reflectance 0.5, a lamp 2 m above it that gives 100 W all round, a black cube and a ball beside.
const MODEL: &str = "
protected void init() [
    Axiom ==>
        [ Translate(0, 2, 0) Rotate(90, 0, 0) Parallelogram(4, 4).(setShader(new RGBAShader(0.5, 0.5, 0.5))) ]
        [ Translate(1, 0, 0.5) Box(0.4, 0.4, 0.4).(setShader(new RGBAShader(0, 0, 0))) ]
        [ Translate(-1, 0, 0.5) Sphere(0.2).(setShader(new RGBAShader(0, 0, 0))) ]
        [ Translate(0, 0, 2) LightNode.(setLight(new PointLight().(setPower(100)))) ];
]
";

/// The floor below; from its middle upwards.
const LAMP: DVec3 = DVec3::new(0.0, 0.0, 2.0);

fn folder() -> TempDir {
    let folder = tempfile::tempdir().unwrap();
    fs::write(folder.path().join("m.rgg"), MODEL).unwrap();
    folder
}

fn export(folder: &Path, words: &[&str]) -> Output {
    let mut command = Command::new(env!("CARGO_BIN_EXE_understory"));
    let usual = ["export", "m.rgg", "--steps", "0", "--exposure", "-3"];
    let none = ["--sun", "none", "--ground", "none"];
    command.current_dir(folder).args(usual).args(none);
    command.args(words).output().unwrap()
}

fn text(output: &Output) -> String {
    String::from_utf8_lossy(&output.stderr).into_owned()
}

/// Corners, colours and triangles, z up.
struct Read {
    positions: Vec<DVec3>,
    colors: Vec<[f32; 4]>,
    triangles: Vec<[u32; 3]>,
}

impl Read {
    fn new(bytes: &[u8]) -> Self {
        let gltf = gltf::Gltf::from_slice(bytes).unwrap();
        let blob = gltf.blob.as_deref().unwrap();
        let scene = gltf.default_scene().unwrap();
        let node = scene.nodes().find(|node| node.mesh().is_some()).unwrap();
        let (offset, ..) = node.transform().decomposed();
        let mesh = node.mesh().unwrap();
        let primitive = mesh.primitives().next().unwrap();
        assert!(primitive.material().unlit());
        let reader = primitive.reader(|buffer| (buffer.index() == 0).then_some(blob));
        let z_up = |[x, y, z]: [f32; 3]| {
            let at = [x + offset[0], y + offset[1], z + offset[2]].map(f64::from);
            DVec3::new(at[0], -at[2], at[1])
        };
        let indices: Vec<u32> = reader.read_indices().unwrap().into_u32().collect();
        let read = Self {
            positions: reader.read_positions().unwrap().map(z_up).collect(),
            colors: reader.read_colors(0).unwrap().into_rgba_f32().collect(),
            triangles: indices.as_chunks().0.to_vec(),
        };
        assert_eq!(indices.len(), 3 * read.triangles.len());
        assert_eq!(read.colors.len(), read.positions.len());
        assert!(
            indices
                .iter()
                .all(|corner| (*corner as usize) < read.positions.len())
        );
        read
    }

    /// Twice the area, and the way in which it is seen.
    fn normal(&self, triangle: [u32; 3]) -> DVec3 {
        let [a, b, c] = triangle.map(|corner| self.positions[corner as usize]);
        (b - a).cross(c - a)
    }

    /// Triangles all of whose corners are `there`.
    fn area(&self, there: impl Fn(DVec3) -> bool, along: DVec3) -> f64 {
        let is_there = |corner: &u32| there(self.positions[*corner as usize]);
        let triangles = self.triangles.iter();
        let faces = triangles.filter(|triangle| triangle.iter().all(is_there));
        faces
            .map(|triangle| 0.5 * self.normal(*triangle).dot(along).max(0.0))
            .sum()
    }
}

/// Whether a point of the floor is so near to the edge of a shadow that the light of neither side holds.
fn shade(at: DVec3) -> Option<bool> {
    let rim = 0.03;
    // The cube as it is drawn: half a metre above the floor, 0.4 m wide.
    let through_cube = |grow: f64| {
        (0..200).any(|k| {
            let p = at.lerp(LAMP, f64::from(k) / 200.0) - DVec3::new(1.0, 0.0, 0.7);
            p.abs().max_element() < 0.2 + grow
        })
    };
    let through_ball = |grow: f64| {
        let way = (LAMP - at).normalize();
        let to = DVec3::new(-1.0, 0.0, 0.5) - at;
        (to - way * to.dot(way)).length() < 0.2 + grow
    };
    let is_dark = |grow: f64| through_cube(grow) || through_ball(grow);
    (is_dark(-rim) == is_dark(rim)).then(|| is_dark(0.0))
}

#[test]
fn corners_have_the_light_that_falls_there() {
    let folder = folder();
    let words = [
        "--renderer",
        "radiosity",
        "--hemicube-pixels",
        "8",
        "-o",
        "m.glb",
    ];
    let done = export(folder.path(), &words);
    assert_eq!(done.status.code(), Some(0), "{}", text(&done));
    let bytes = fs::read(folder.path().join("m.glb")).unwrap();
    let read = Read::new(&bytes);
    // Upwards the floor has the light of the lamp, Φ/3 in each channel: Φ/3 / (4π) · cos/r² · ρ/π.
    let is_up = |triangle: &&[u32; 3]| read.normal(**triangle).z > 0.0;
    let mut n = [0, 0];
    for triangle in read.triangles.iter().filter(is_up) {
        for corner in triangle {
            let at = read.positions[*corner as usize];
            if at.z.abs() > 1e-6 || at.truncate().abs().max_element() > 1.99 {
                continue;
            }
            let Some(is_dark) = shade(at) else { continue };
            let way = LAMP - at;
            let cos = way.z / way.length();
            let radiance = 100.0 / 3.0 / (4.0 * PI) * cos / way.length_squared() * 0.5 / PI;
            let expected = if is_dark { 0.0 } else { radiance / 8.0 };
            for channel in &read.colors[*corner as usize][..3] {
                let found = f64::from(*channel);
                let off = (found - expected).abs();
                assert!(off < 0.02 * radiance / 8.0, "{at} {found} {expected}");
            }
            n[usize::from(is_dark)] += 1;
        }
    }
    assert!(n[0] > 1000 && n[1] > 50, "{n:?}");
    // Nothing is left open or counted twice, and the floor has a back.
    let floor = |at: DVec3| at.z.abs() < 1e-6;
    for way in [DVec3::Z, DVec3::NEG_Z] {
        let area = read.area(floor, way);
        assert!((area - 16.0).abs() < 1e-4, "{way} {area}");
    }
    // The ball is round, and its dark inside is left out.
    let ball = |at: DVec3| at.x < -0.7 && at.z > 0.2 && at.z < 0.8;
    let bulge = read.area(ball, DVec3::Z);
    assert!((bulge / (PI * 0.04) - 1.0).abs() < 0.03, "{bulge}");
    assert!(
        read.triangles
            .iter()
            .filter(|triangle| ball(read.positions[triangle[0] as usize]))
            .all(|triangle| {
                let at = read.positions[triangle[0] as usize];
                read.normal(*triangle).dot(at - DVec3::new(-1.0, 0.0, 0.5)) > 0.0
            })
    );
}

#[test]
fn the_file_is_the_same_for_any_number_of_threads() {
    let folder = folder();
    let files = ["1", "3"].map(|threads| {
        let name = format!("{threads}.glb");
        let words = [
            "--renderer",
            "radiosity",
            "--threads",
            threads,
            "--subdivision-depth",
            "0",
            "--hemicube-pixels",
            "4",
            "-o",
            &name,
        ];
        let done = export(folder.path(), &words);
        assert_eq!(done.status.code(), Some(0), "{}", text(&done));
        fs::read(folder.path().join(name)).unwrap()
    });
    assert!(files[0] == files[1]);
}

#[test]
fn what_cannot_be_exported_is_refused() {
    let folder = folder();
    let refused = |words: &[&str], code: i32, part: &str| {
        let done = export(folder.path(), words);
        let text = text(&done);
        assert!(
            done.status.code() == Some(code) && text.contains(part),
            "{words:?}: {text}"
        );
    };
    refused(&["-o", "m.glb"], 2, "--renderer radiosity");
    let radiosity = ["--renderer", "radiosity", "-o"];
    refused(&[&radiosity[..], &["m.obj"]].concat(), 2, "`.glb`");
    fs::write(folder.path().join("thesis.glb"), "forty pages of text").unwrap();
    refused(
        &[&radiosity[..], &["thesis.glb"]].concat(),
        3,
        "not replaced",
    );
    fs::write(
        folder.path().join("m.rgg"),
        "protected void init() [ Axiom ==> F(0); ]",
    )
    .unwrap();
    refused(&[&radiosity[..], &["m.glb"]].concat(), 3, "no surfaces");
    assert!(!folder.path().join("m.glb").exists());
}
