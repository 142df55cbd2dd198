//! The light that radiosity shares between cameras: saved, read again, and refused where it does not fit.

#![allow(clippy::unwrap_used, reason = "a test may panic")]

#[path = "support/room.rs"]
#[allow(dead_code, reason = "other tests use the rest")]
mod room;

use glam::{DAffine3, DVec3};
use proptest::prelude::*;
use room::{Room, at, gray, square};
use std::fs;
use std::process::Command;
use std::sync::OnceLock;
use understory::geometry::Shape;
use understory::integrator::radiosity::Solver;
use understory::integrator::{
    CancelToken, Integrator, Radiosity, RayCounts, RenderContext, Solution,
};
use understory::light::Light;
use understory::material::Material;
use understory::math::Ray;
use understory::sampler::{Sampler, SamplerKind};
use understory::scene::Scene;

fn context(cancel: &CancelToken) -> RenderContext<'_> {
    RenderContext {
        seed: 3,
        cancel,
        progress: &|_| {},
    }
}

/// Faces of all forms, a plane among them, and a mirror.
fn scene(radius: f64) -> Scene {
    let matt = Material::lambert(gray(0.6));
    let frustum = Shape::Frustum {
        length: 0.6,
        base_radius: 0.3,
        top_radius: 0.1,
        base_cap: true,
        top_cap: true,
    };
    let cube = Shape::Box {
        half_x: 0.2,
        half_y: 0.3,
        length: 0.4,
    };
    Room::default()
        .with(Shape::Plane, DAffine3::IDENTITY, matt.clone())
        .with(square(0.5), at(0.0, 0.8, 0.9), matt.clone())
        .with(Shape::Sphere { radius }, at(0.7, 0.0, 0.4), matt.clone())
        .with(frustum, at(-0.6, 0.0, 0.1), matt.clone())
        .with(cube, at(0.0, -0.7, 0.0), matt)
        .with(
            Shape::Disk { radius: 0.3 },
            at(0.0, 0.0, 0.5),
            Material::mirror(gray(0.9)),
        )
        .lit_by(Light::point(DVec3::new(0.3, 0.2, 2.0), gray(50.0)))
        .build()
}

fn method() -> Radiosity {
    Radiosity {
        hemicube_pixels: 6,
        subdivision_depth: 1,
        ..Radiosity::default()
    }
}

/// Some radiances, to the last bit.
fn looks(scene: &Scene, solution: &Solution) -> Vec<[u64; 3]> {
    let cancel = CancelToken::default();
    let view = method().view(scene, solution, &context(&cancel)).unwrap();
    let look = |i: u32| {
        let to = DVec3::new(
            f64::from(i % 8) * 0.3 - 1.0,
            f64::from(i / 8) * 0.3 - 1.0,
            0.2,
        );
        let from = DVec3::new(0.5, -2.5, 2.0);
        let ray = Ray::new(from, (to - from).normalize());
        let mut sampler = Sampler::new(SamplerKind::OwenSobol, 7, i);
        let seen = view.incident_radiance(&ray, &mut sampler, &mut RayCounts::default());
        seen.to_array().map(f64::to_bits)
    };
    (0..64).map(look).collect()
}

/// A scene and its solution as bytes, made once.
fn shared() -> &'static (Scene, Vec<u8>) {
    static SHARED: OnceLock<(Scene, Vec<u8>)> = OnceLock::new();
    SHARED.get_or_init(|| {
        let scene = scene(0.3);
        let cancel = CancelToken::default();
        let solution = method().solve(&scene, &context(&cancel)).unwrap();
        let bytes = solution.to_bytes().unwrap();
        let again = method().restore(&bytes).unwrap();
        assert!(again.to_bytes().unwrap() == bytes);
        assert!(looks(&scene, &solution) == looks(&scene, &again));
        (scene, bytes)
    })
}

#[test]
fn solutions_come_back_from_their_bytes() {
    let (scene, bytes) = shared();
    // Half as bright: the light is in the bytes, not found anew. It is their end: that of the corners.
    let n = bytes.len();
    let mut darker = bytes.clone();
    for corner in darker[n - 48 * 40..].as_chunks_mut().0 {
        *corner = (f64::from_le_bytes(*corner) * 0.5).to_le_bytes();
    }
    let whole = method().restore(bytes).unwrap();
    let darker = method().restore(&darker).unwrap();
    assert!(looks(scene, &whole) != looks(scene, &darker));
}

/// Of another scene it is not used, whatever the file says.
#[test]
fn a_solution_of_another_scene_is_found_anew() {
    let (_, bytes) = shared();
    let other = scene(0.25);
    let cancel = CancelToken::default();
    let own = method().solve(&other, &context(&cancel)).unwrap();
    let foreign = method().restore(bytes).unwrap();
    assert!(looks(&other, &own) == looks(&other, &foreign));
}

/// Shooting can be seen while it goes on: at once about as bright as in the end, for what is left is spread over all; and what comes
/// out in the end is not changed by looking.
#[test]
fn shooting_is_shown_on_the_way() {
    let scene = scene(0.3);
    let cancel = CancelToken::default();
    let shooting = Radiosity {
        solver: Some(Solver::Shoot),
        ..method()
    };
    let mut shown = Vec::new();
    let mut early = |so_far: &dyn Fn() -> Solution| {
        if shown.len() < 4 {
            shown.push(so_far());
        }
    };
    let solved = shooting
        .solve_showing(&scene, &context(&cancel), &mut early)
        .unwrap();
    let plain = shooting.solve(&scene, &context(&cancel)).unwrap();
    assert!(solved.to_bytes() == plain.to_bytes());
    assert!(shown.len() == 4, "{}", shown.len());
    let brightness = |solution: &Solution| {
        let looks = looks(&scene, solution);
        let channels = looks.as_flattened().iter();
        channels.map(|bits| f64::from_bits(*bits)).sum::<f64>()
    };
    let (first, last) = (brightness(&shown[0]), brightness(&solved));
    assert!((first / last - 1.0).abs() < 0.2, "{first} {last}");
    assert!(looks(&scene, &shown[0]) != looks(&scene, &solved));
}

/// What a mirror throws from a lamp is written apart, for gathers; files of before that end where it would begin are read as well, and
/// then rays of gathers find it: the same light but for noise. All that is gathered is found again from the bytes.
#[test]
fn what_mirrors_throw_is_kept_apart() {
    let lamp = Material::lambert(gray(0.0)).emitting(gray(20.0), gray(0.0));
    let down = DAffine3::from_rotation_x(std::f64::consts::PI);
    let upright = at(-1.0, 0.0, 0.5) * DAffine3::from_rotation_y(std::f64::consts::FRAC_PI_2);
    let scene = Room::default()
        .with(square(1.0), at(0.0, 0.0, 0.0), Material::lambert(gray(0.6)))
        .with(square(1.0), upright, Material::mirror(gray(0.9)))
        .with(square(0.8), at(0.0, 0.0, 1.5) * down, lamp)
        .build();
    let gathered = Radiosity {
        final_gather: 64,
        ..method()
    };
    let cancel = CancelToken::default();
    let mean = |solution: &Solution| {
        let view = gathered.view(&scene, solution, &context(&cancel)).unwrap();
        let look = |i: u32| {
            let from = DVec3::new(
                f64::from(i % 16) * 0.1 - 0.8,
                f64::from(i / 16) * 0.1 - 0.8,
                0.1,
            );
            let mut sampler = Sampler::new(SamplerKind::OwenSobol, 7, i);
            let ray = Ray::new(from, DVec3::NEG_Z);
            view.incident_radiance(&ray, &mut sampler, &mut RayCounts::default())
                .g
        };
        (0..256).map(look).sum::<f64>() / 256.0
    };
    let solution = gathered.solve(&scene, &context(&cancel)).unwrap();
    let bytes = solution.to_bytes().unwrap();
    let again = gathered.restore(&bytes).unwrap();
    assert!(again.to_bytes().unwrap() == bytes);
    assert_eq!(mean(&solution), mean(&again));
    // As much light at the end is what was thrown: as many corners.
    let plain = without_thrown(&bytes);
    let old = gathered.restore(plain).unwrap();
    let (new, old) = (mean(&solution), mean(&old));
    assert!((new / old - 1.0).abs() < 0.02, "{new} {old}");
    assert!(new != old);
}

/// The bytes up to the light at corners, which is followed by as much that was thrown.
fn without_thrown(bytes: &[u8]) -> &[u8] {
    let counted = |end: usize| {
        let light = (bytes.len() - end) / 2;
        let n = u64::from_le_bytes(bytes[end - 8..end].try_into().unwrap());
        (light > 0 && light.is_multiple_of(48) && n == (light / 48) as u64).then_some(end + light)
    };
    let end = (8..bytes.len()).rev().find_map(counted).unwrap();
    &bytes[..end]
}

/// A memory for 16,000 cells, and a wish for more of them (C-20): it is told, not passed over.
#[test]
fn what_memory_keeps_from_being_split_is_told() {
    let cancel = CancelToken::default();
    let is_split = |threshold| {
        let method = Radiosity {
            subdivision_threshold: threshold,
            subdivision_depth: 30,
            memory: 16 << 20,
            ..method()
        };
        match method.solve(&scene(0.3), &context(&cancel)).unwrap() {
            Solution::Radiosity(solution) => solution.is_split,
            other => panic!("{other:?}"),
        }
    };
    assert!(is_split(1e3));
    assert!(!is_split(0.0));
}

proptest! {
    #![proptest_config(ProptestConfig { cases: 128, failure_persistence: None, ..ProptestConfig::default() })]

    /// Whatever the bytes are, they are refused or are a solution that can be looked at: no panic, no huge allocation.
    #[test]
    fn hostile_bytes_do_no_harm(
        changes in prop::collection::vec((any::<prop::sample::Index>(), any::<u8>()), 0..6),
        cut in any::<prop::sample::Index>(),
        is_cut in prop::bool::weighted(0.3),
    ) {
        let (scene, whole) = shared();
        // Not in the faces: with others, looking would solve anew.
        let faces = 8 + 8 + 1 + 8 + 138 * u64::from_le_bytes(whole[17..25].try_into().unwrap()) as usize;
        let mut bytes = whole.clone();
        for (at, value) in changes {
            let at = faces + at.index(bytes.len() - faces);
            bytes[at] = value;
        }
        if is_cut {
            bytes.truncate(cut.index(bytes.len()));
            prop_assert!(method().restore(&bytes).is_err());
        }
        if let Ok(solution) = method().restore(&bytes) {
            looks(scene, &solution);
        }
    }

    #[test]
    fn hostile_heads_do_no_harm(changes in prop::collection::vec((0_usize..400, any::<u8>()), 1..6)) {
        let mut bytes = shared().1.clone();
        for (at, value) in changes {
            bytes[at] = value;
        }
        let _ = method().restore(&bytes);
    }
}

/// Two balls on a floor, under a lamp.
const MODEL: &str = r"
protected void init() [
    Axiom ==>
        [ Translate(0, 0, 2.5) Rotate(-90, 0, 0) Parallelogram(0.5, 0.5).(setShader(WHITE), setLight(new AreaLight().(setPower(60)))) ]
        [ Translate(0, 1.5, 0) Rotate(90, 0, 0) Parallelogram(3, 3).(setShader(new RGBAShader(0.7, 0.6, 0.5))) ]
        [ Translate(0.6, 0.2, 0.4) Sphere(0.4).(setShader(new RGBAShader(0.3, 0.5, 0.7))) ]
        [ Translate(-0.5, 0, 0.3) Sphere(0.3).(setShader(new RGBAShader(0.8, 0.8, 0.8))) ];
]
";

#[test]
fn the_program_reads_what_it_writes_and_says_why_not() {
    let folder = tempfile::tempdir().unwrap();
    fs::write(folder.path().join("m.rgg"), MODEL).unwrap();
    let run = |words: &[&str]| {
        let mut command = Command::new(env!("CARGO_BIN_EXE_understory"));
        let usual = [
            "--steps",
            "0",
            "--size",
            "24x16",
            "--samples",
            "1",
            "--hemicube-pixels",
            "8",
        ];
        command.current_dir(folder.path()).args([words[0], "m.rgg"]);
        let done = command.args(&words[1..]).args(usual).output().unwrap();
        let text = String::from_utf8_lossy(&done.stderr).into_owned();
        (done.status.code(), text)
    };
    let with = |rest: &[&str]| run(&[&["render", "--renderer", "radiosity"], rest].concat());
    let bytes = |name: &str| fs::read(folder.path().join(name)).unwrap();
    let eye = ["--eye", "2,-3,2"];
    for words in [
        &["-o", "a.png", "--save-solution", "s"][..],
        &["-o", "b.png", "--solution", "s", "--save-solution", "t"],
        &["-o", "c.png", "--solution", "s", eye[0], eye[1]],
        &["-o", "d.png", eye[0], eye[1]],
    ] {
        let (code, text) = with(words);
        assert_eq!(code, Some(0), "{words:?}: {text}");
    }
    assert_eq!(bytes("a.png"), bytes("b.png"));
    assert_eq!(bytes("c.png"), bytes("d.png"));
    assert_ne!(bytes("a.png"), bytes("c.png"));
    assert_eq!(bytes("s"), bytes("t"));
    let exported = run(&[
        "export",
        "--renderer",
        "radiosity",
        "--solution",
        "s",
        "-o",
        "m.glb",
    ]);
    // Of a picture, not of a mesh.
    assert!(exported.1.contains("--samples"), "{}", exported.1);
    for (words, part) in [
        (&["--seed", "2"][..], "`seed` was `1`"),
        (
            &["--subdivision-depth", "1"],
            "`subdivision-depth` was `3` and is now `1`",
        ),
        (&["--sun", "10,30"], "`sun`"),
    ] {
        let (code, text) = with(&[words, &["-o", "e.png", "--solution", "s"]].concat());
        assert!(
            code == Some(3) && text.contains(part) && text.contains("--save-solution"),
            "{text}"
        );
    }
    let (code, text) = run(&[
        "render",
        "--renderer",
        "photon",
        "-o",
        "e.png",
        "--solution",
        "s",
    ]);
    assert!(
        code == Some(3) && text.contains("`renderer` was `radiosity`"),
        "{text}"
    );
    let mut damaged = bytes("s");
    let middle = damaged.len() / 2;
    damaged[middle] ^= 0x40;
    fs::write(folder.path().join("s"), damaged).unwrap();
    let (code, text) = with(&["-o", "e.png", "--solution", "s"]);
    assert!(code == Some(3) && text.contains("damaged"), "{text}");
    assert!(!folder.path().join("e.png").exists());
}
