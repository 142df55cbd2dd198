//! Settings from cheap to dear, for each way to make a picture.
//!
//! A [`Family`] is a line of settings in which one knob grows by factors of four and the others follow it as theory has it, so that
//! what is dear is spent where it helps most; its [`Rung`]s are settings of the table of options, and nothing else.

use super::fit::Floor;
use crate::options::preset::QUALITIES;
use crate::options::value::Renderer;
use crate::options::{Presets, TABLE};

/// A way to make pictures, from cheap to dear.
#[derive(Clone, Debug, PartialEq)]
pub struct Family {
    /// Its name, unlike all others.
    pub name: &'static str,
    /// What is turned up, for people.
    pub knob: &'static str,
    /// Its method.
    pub renderer: Renderer,
    /// Whether an error remains whatever the work.
    pub floor: Floor,
    /// The power by which the error falls with the knob, where theory knows it.
    pub theory: Option<f64>,
    /// Whether its settings are to be compared with others; those that only show how a method behaves are not.
    pub is_contender: bool,
    /// Its settings, from cheap to dear.
    pub rungs: Vec<Rung>,
}

/// One setting.
#[derive(Clone, Debug, PartialEq)]
pub struct Rung {
    /// How far the knob is turned.
    pub knob: f64,
    /// Options that differ from what the user has set.
    pub settings: Vec<(&'static str, String)>,
}

/// What is known of the scene when ladders are chosen.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Needs {
    /// Whether anything is a mirror or glass, or may be.
    pub has_specular: bool,
    /// Radius in metres of what there is to see.
    pub radius: f64,
}

/// Samples per pixel of the cheapest picture by methods whose light is solved before.
const FEW: u32 = 4;

/// The ladders for a scene; those of one method if only that is wanted.
#[must_use]
pub fn families(needs: Needs, only: Option<Renderer>) -> Vec<Family> {
    let all = vec![
        path(),
        photons(needs),
        gathered(needs),
        radiosity(),
        raytracer(),
        passes(needs),
        even_mesh(),
        areas(needs),
        presets("path, presets", Renderer::Path),
        presets("photon, presets", Renderer::Photon),
        presets("radiosity, presets", Renderer::Radiosity),
    ];
    let is_wanted = |family: &Family| only.is_none_or(|only| family.renderer == only);
    all.into_iter().filter(is_wanted).collect()
}

/// The n-th step of a ladder by factors of four.
fn fours(n: usize) -> impl Iterator<Item = u32> {
    (0..n).map(|k| 4_u32.pow(k as u32))
}

fn rung(knob: u32, settings: Vec<(&'static str, u32)>) -> Rung {
    let settings = settings.into_iter();
    Rung {
        knob: f64::from(knob),
        settings: settings
            .map(|(key, value)| (key, value.to_string()))
            .collect(),
    }
}

fn path() -> Family {
    Family {
        name: "path",
        knob: "samples",
        renderer: Renderer::Path,
        floor: Floor::None,
        theory: Some(1.0),
        is_contender: true,
        rungs: fours(8).map(|n| rung(n, vec![("samples", n)])).collect(),
    }
}

fn raytracer() -> Family {
    Family {
        name: "raytracer",
        knob: "samples",
        renderer: Renderer::Raytracer,
        floor: Floor::Some,
        theory: None,
        is_contender: true,
        rungs: fours(4).map(|n| rung(n, vec![("samples", n)])).collect(),
    }
}

/// Photons to all surfaces, and as many to mirrors and glass if there are any.
fn shares(needs: Needs, n: u32) -> [(&'static str, u32); 2] {
    let caustic = if needs.has_specular { n } else { 0 };
    [("global-photons", n), ("caustic-photons", caustic)]
}

/// Photons looked at directly. Noise is 1/(N r²) and the square of the blur r⁴, so with kernels that are chosen, r⁶ = 1/N, the error falls
/// with N^(2/3); that of samples falls with their number: twice as many for each four times as many photons is enough for long.
fn photons(needs: Needs) -> Family {
    let rungs = (0..6).map(|k| {
        let n = 25_000 * 4_u32.pow(k);
        let mut settings = shares(needs, n).to_vec();
        settings.extend([("final-gather", 0), ("samples", FEW << k.min(5))]);
        rung(n, settings)
    });
    Family {
        name: "photon",
        knob: "photons",
        renderer: Renderer::Photon,
        floor: Floor::None,
        theory: Some(2.0 / 3.0),
        is_contender: true,
        rungs: rungs.map(automatic_area).collect(),
    }
}

/// Photons by final gathering.
fn gathered(needs: Needs) -> Family {
    let rungs = (0..5).map(|k| {
        let n = 62_500 * 4_u32.pow(k);
        let mut settings = shares(needs, n).to_vec();
        settings.extend([
            ("final-gather", (64 << k).min(1024)),
            ("samples", FEW << k.min(5)),
        ]);
        rung(n, settings)
    });
    Family {
        name: "photon, gathered",
        knob: "photons",
        renderer: Renderer::Photon,
        floor: Floor::Some,
        theory: None,
        is_contender: true,
        rungs: rungs.map(automatic_area).collect(),
    }
}

/// Progressive photon mapping: with passes whose kernels shrink the error falls with the power 2/3 of their number
/// ([Knaus2011](crate::references#knaus2011), §4: the best of their α is 2/3).
fn passes(needs: Needs) -> Family {
    let rungs = fours(5).map(|n| {
        let mut settings = shares(needs, 25_000).to_vec();
        settings.extend([
            ("passes", n),
            ("final-gather", 0),
            ("samples", (4 * n).min(256)),
        ]);
        rung(n, settings)
    });
    Family {
        name: "photon, passes",
        knob: "passes",
        renderer: Renderer::Photon,
        floor: Floor::None,
        theory: Some(2.0 / 3.0),
        is_contender: true,
        rungs: rungs.map(automatic_area).collect(),
    }
}

/// What the area of photons does to bias and noise, their number staying as it is.
fn areas(needs: Needs) -> Family {
    let rungs = (0..6).map(|k| {
        // From half a hundredth of the radius of the scene on, by doubling.
        let radius = 0.005 * needs.radius * f64::from(1 << k);
        let area = std::f64::consts::PI * radius * radius;
        let mut rung = rung(1, shares(needs, 200_000).to_vec());
        rung.knob = area;
        rung.settings.extend([
            ("photon-area", area.to_string()),
            ("final-gather", "0".to_owned()),
            ("samples", "16".to_owned()),
        ]);
        rung
    });
    Family {
        name: "photon, area",
        knob: "photon area",
        renderer: Renderer::Photon,
        floor: Floor::Some,
        theory: None,
        is_contender: false,
        rungs: rungs.collect(),
    }
}

fn automatic_area(mut rung: Rung) -> Rung {
    rung.settings.push(("photon-area", "auto".to_owned()));
    rung
}

/// A threshold of splitting, how deep, pixels of the hemicube, samples.
const RADIOSITY: [(&str, u32, u32, u32); 6] = [
    ("0.5", 0, 8, 4),
    ("0.3", 1, 16, 4),
    ("0.15", 2, 24, 8),
    ("0.15", 3, 32, 16),
    ("0.05", 4, 48, 32),
    ("0.03", 5, 64, 64),
];

fn radiosity() -> Family {
    let rungs = RADIOSITY
        .iter()
        .zip(0..)
        .map(|((threshold, depth, pixels, samples), k)| Rung {
            knob: f64::from(4_u32.pow(k)),
            settings: vec![
                ("subdivision-threshold", (*threshold).to_owned()),
                ("subdivision-depth", depth.to_string()),
                ("hemicube-pixels", pixels.to_string()),
                ("final-gather", "auto".to_owned()),
                ("samples", samples.to_string()),
            ],
        });
    Family {
        name: "radiosity",
        knob: "step",
        renderer: Renderer::Radiosity,
        floor: Floor::Some,
        theory: None,
        is_contender: true,
        rungs: rungs.collect(),
    }
}

/// Every patch split alike, its number growing by four: linear light between corners has an error of h², so the squared error falls
/// with h⁴, the square of the number of patches, as far as light is smooth (theory: 2). Edges of shadows are not.
fn even_mesh() -> Family {
    let rungs = (0..5).map(|k: u32| {
        let mut rung = rung(
            4_u32.pow(k),
            vec![
                ("subdivision-depth", k),
                ("hemicube-pixels", 32),
                ("samples", 8),
            ],
        );
        rung.settings.extend([
            ("subdivision-threshold", "0".to_owned()),
            ("final-gather", "auto".to_owned()),
        ]);
        rung
    });
    Family {
        name: "radiosity, even mesh",
        knob: "patches",
        renderer: Renderer::Radiosity,
        floor: Floor::Some,
        theory: Some(2.0),
        is_contender: false,
        rungs: rungs.collect(),
    }
}

/// Options that presets change.
const PRESET: [&str; 8] = [
    "samples",
    "max-depth",
    "global-photons",
    "caustic-photons",
    "final-gather",
    "subdivision-threshold",
    "subdivision-depth",
    "hemicube-pixels",
];

/// What `--quality draft`, `preview` and `final` stand for unless somebody says otherwise.
fn presets(name: &'static str, renderer: Renderer) -> Family {
    let built_in = Presets::default();
    let rungs = QUALITIES.into_iter().map(|quality| {
        let values = built_in.of(quality, renderer);
        let value = |key: &'static str| {
            let preset = values.iter().find(|(known, _)| *known == key);
            let default = || {
                TABLE
                    .iter()
                    .find(|row| row.key == key)
                    .map_or("", |row| row.default)
            };
            (
                key,
                preset.map_or_else(default, |(_, text)| text).to_owned(),
            )
        };
        let matters = |key: &&'static str| match renderer {
            Renderer::Path => ["samples", "max-depth"].contains(key),
            Renderer::Photon => {
                !key.starts_with("sub") && !key.starts_with("hemi") && *key != "max-depth"
            }
            Renderer::Radiosity => {
                ["samples", "final-gather"].contains(key)
                    || key.starts_with("sub")
                    || key.starts_with("hemi")
            }
            Renderer::Raytracer => *key == "samples",
        };
        Rung {
            knob: 1.0 + f64::from(quality as u8),
            settings: PRESET.into_iter().filter(matters).map(value).collect(),
        }
    });
    let rungs: Vec<Rung> = rungs.collect();
    Family {
        name,
        knob: "preset",
        renderer,
        floor: Floor::Some,
        theory: None,
        is_contender: false,
        rungs: if renderer == Renderer::Photon {
            rungs.into_iter().map(automatic_area).collect()
        } else {
            rungs
        },
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::options::{Options, Origin};
    use std::collections::BTreeSet;

    #[test]
    fn every_rung_is_a_setting_that_exists_and_ladders_grow() {
        for has_specular in [false, true] {
            let needs = Needs {
                has_specular,
                radius: 3.0,
            };
            let families = families(needs, None);
            let names: BTreeSet<&str> = families.iter().map(|family| family.name).collect();
            assert_eq!(names.len(), families.len());
            for family in &families {
                assert!(family.rungs.len() >= 3, "{}", family.name);
                assert!(family.rungs.is_sorted_by(|a, b| a.knob < b.knob));
                for rung in &family.rungs {
                    let mut options = Options::default();
                    for (key, text) in &rung.settings {
                        options.set(key, text, Origin::Flag).unwrap();
                    }
                }
            }
        }
    }

    #[test]
    fn without_mirrors_no_photons_are_sent_to_them_and_one_method_may_be_wanted() {
        let needs = Needs {
            has_specular: false,
            radius: 1.0,
        };
        let found = families(needs, Some(Renderer::Photon));
        let ladders = found.iter().filter(|family| family.knob != "preset");
        let settings = ladders.flat_map(|f| &f.rungs).flat_map(|r| &r.settings);
        for (key, text) in settings.filter(|(key, _)| *key == "caustic-photons") {
            assert_eq!(text, "0", "{key}");
        }
        assert!(found.iter().all(|f| f.renderer == Renderer::Photon) && found.len() > 1);
    }
}
