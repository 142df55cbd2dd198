//! Every example is free of errors and warnings, grows, and makes a picture of something.

#![allow(clippy::unwrap_used, reason = "a test fails by panicking")]

#[path = "support/opened.rs"]
mod opened;

use opened::Opened;
use std::path::{Path, PathBuf};
use understory::film::LinearImage;

fn example(name: &str, flags: &[(&str, &str)]) -> Opened {
    Opened::new(Path::new("examples").join(name), flags)
}

const SMALL: [(&str, &str); 2] = [("size", "32x32"), ("samples", "4")];

/// Neither black nor flat, and green where plants are.
fn assert_shows_something(name: &str, image: &LinearImage) {
    let luminances: Vec<f64> = image.pixels.iter().map(|pixel| pixel.luminance()).collect();
    let n = luminances.len() as f64;
    let mean = luminances.iter().sum::<f64>() / n;
    let variance = luminances.iter().map(|l| (l - mean).powi(2)).sum::<f64>() / n;
    assert!(mean > 1.0, "{name}: mean radiance {mean}");
    let contrast = variance.sqrt() / mean;
    assert!(contrast > 0.1, "{name}: contrast {contrast}");
    let n_green = image
        .pixels
        .iter()
        .filter(|p| p.g > 1.15 * p.r && p.g > 1.15 * p.b)
        .count();
    let least = if name == "koch.rgg" { 0 } else { 20 };
    assert!(n_green >= least, "{name}: {n_green} green pixels");
}

#[test]
fn all_examples_are_here() {
    let is_model = |path: &PathBuf| path.extension().is_some_and(|e| e == "rgg");
    let files = std::fs::read_dir("examples")
        .unwrap()
        .map(|entry| entry.unwrap().path());
    let mut names: Vec<String> = files
        .filter(is_model)
        .map(|path| path.file_name().unwrap().to_string_lossy().into_owned())
        .collect();
    names.sort();
    assert_eq!(
        names,
        [
            "bush.rgg",
            "crop.rgg",
            "dieback.rgg",
            "forest.rgg",
            "koch.rgg",
            "poplar.rgg",
            "spruce.rgg"
        ]
    );
}

#[test]
fn small_models_make_pictures() {
    // Heights in metres.
    for (name, heights) in [
        ("koch.rgg", 3.5..3.8),
        ("bush.rgg", 1.5..3.5),
        ("crop.rgg", 0.9..1.4),
        ("poplar.rgg", 8.0..14.0),
        ("spruce.rgg", 12.0..18.0),
    ] {
        let drawn = example(name, &SMALL).draw();
        let height = drawn.bounds.max.z;
        assert!(heights.contains(&height), "{name}: {height} m");
        assert_shows_something(name, &drawn.image);
    }
}

#[test]
fn a_still_life_of_meshes_and_curved_shapes() {
    let drawn = example("meshes/still.rgg", &SMALL).draw();
    let height = drawn.bounds.max.z;
    assert!((0.5..0.7).contains(&height), "{height} m");
    assert_shows_something("meshes/still.rgg", &drawn.image);
}

/// How bright a picture is, and how much of that differs from pixel to pixel.
fn looks(name: &str, image: &LinearImage) -> (f64, f64) {
    let luminances: Vec<f64> = image.pixels.iter().map(|pixel| pixel.luminance()).collect();
    assert!(luminances.iter().all(|l| l.is_finite()), "{name}");
    let n = luminances.len() as f64;
    let mean = luminances.iter().sum::<f64>() / n;
    let variance = luminances.iter().map(|l| (l - mean).powi(2)).sum::<f64>() / n;
    (mean, variance.sqrt() / mean)
}

/// The nine scenes of the study and the four of the peers, with both renderers: light arrives, something is seen, and what the
/// ray tracer sees of it, which leaves light out but adds none, is no brighter than what the path tracer sees.
#[test]
fn the_study_and_the_peers_are_rendered_both_ways() {
    let study = [
        "ring",
        "cornell",
        "concave_mirror",
        "four_lights",
        "three_columns",
        "half_open_door",
        "two_spheres",
        "three_cubes",
        "complex_room",
    ];
    let study = study.map(|name| format!("study/{name}.rgg"));
    let peers = [1, 2, 3, 4].map(|n| format!("peers/S{n}.rgg"));
    for name in study.iter().chain(&peers) {
        let shot = |renderer| {
            let flags = [
                ("renderer", renderer),
                ("size", "32x28"),
                ("supersampling", "2"),
            ];
            looks(name, &example(name, &flags).draw().image)
        };
        let (traced, followed) = (shot("raytracer"), shot("path"));
        for (renderer, (mean, contrast)) in [("raytracer", traced), ("path", followed)] {
            assert!(mean > 0.0, "{name}, {renderer}: black");
            assert!(contrast > 0.2, "{name}, {renderer}: contrast {contrast}");
        }
        assert!(
            traced.0 < 1.5 * followed.0,
            "{name}: {traced:?} {followed:?}"
        );
    }
}

#[test]
fn all_scenes_of_the_study_are_tested() {
    let files = std::fs::read_dir("examples/study").unwrap();
    let paths = files.map(|entry| entry.unwrap().path());
    let is_model = |path: &PathBuf| path.extension().is_some_and(|e| e == "rgg");
    assert_eq!(paths.filter(is_model).count(), 9);
}

/// Leaves that are pictures with holes: green where there is a leaf, and the ground is seen between the teeth.
#[test]
fn a_twig_of_cut_out_leaves() {
    let flags = [("size", "48x32"), ("samples", "4"), ("steps", "9")];
    let drawn = example("textures/lime.rgg", &flags).draw();
    assert_shows_something("textures/lime.rgg", &drawn.image);
}

/// The bytes of a textured picture do not depend on the number of threads.
#[test]
fn textured_pictures_are_the_same_for_any_number_of_threads() {
    let shot = |threads: usize| {
        let flags = [
            ("size", "40x32"),
            ("supersampling", "2"),
            ("renderer", "path"),
        ];
        let pool = rayon::ThreadPoolBuilder::new().num_threads(threads);
        let pool = pool.build().unwrap();
        let drawn = pool.install(|| example("study/complex_room.rgg", &flags).draw());
        let twig = [("size", "40x32"), ("samples", "2"), ("steps", "5")];
        let twig = pool.install(|| example("textures/lime.rgg", &twig).draw());
        [drawn.image.pixels, twig.image.pixels].concat()
    };
    let one = shot(1);
    assert!(shot(3) == one && shot(8) == one);
}

/// Branches die in the shade.
#[test]
fn shaded_branches_die_back() {
    let growth = example("dieback.rgg", &[("steps", "6")]).grow();
    let counts = growth.counts();
    let n_of = |name: &str| counts.iter().find(|(found, _)| found == name).unwrap().1;
    let (living, dead) = (n_of("Branch"), n_of("Stub"));
    assert_eq!(living + dead, 6 * 6 * 6 * 4);
    assert!(living > 300 && dead > 60, "{living} living, {dead} dead");
}

#[test]
fn the_poplar_has_thousands_of_leaves() {
    let counts = example("poplar.rgg", &[]).grow().counts();
    let n_leaves = counts.iter().find(|(name, _)| name == "Leaf").unwrap().1;
    assert!((4_000..40_000).contains(&n_leaves), "{n_leaves} leaves");
}

#[test]
fn a_snowflake_has_three_times_a_power_of_four_sides() {
    for n in 0..=4 {
        let steps = n.to_string();
        let counts = example("koch.rgg", &[("steps", &steps)]).grow().counts();
        let n_sides = counts.iter().find(|(name, _)| name == "Side").unwrap().1;
        // Flake k stops after k steps.
        let expected: usize = (0..=4_u32).map(|flake| 3 * 4_usize.pow(flake.min(n))).sum();
        assert_eq!(n_sides, expected);
    }
}

#[test]
fn the_forest_has_ten_thousand_trees() {
    // Younger than on its picture, which is quicker; the same trees stand at the same places.
    let flags = [SMALL.as_slice(), &[("steps", "20")]].concat();
    let forest = example("forest.rgg", &flags);
    assert_shows_something("forest.rgg", &forest.draw().image);
    let printed = forest.printed();
    let n_trees: usize = printed
        .trim()
        .strip_suffix(" trees")
        .unwrap()
        .parse()
        .unwrap();
    assert!(n_trees >= 10_000, "{printed}");
    let counts = forest.grow().counts();
    let n_of = |name: &str| counts.iter().find(|(found, _)| found == name).unwrap().1;
    // The young trees at the edge of the forest are instances too, but not counted.
    let n_drawn = n_of("Instance") + n_of("Tree");
    assert!(
        (n_trees..n_trees + 500).contains(&n_drawn),
        "{n_drawn} of {n_trees}"
    );
    assert!(n_of("Tree") >= 8, "{counts:?}");
}
