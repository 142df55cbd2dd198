//! What was measured.

use super::fit::Floor;
use crate::animation::flicker::Flicker;
use serde::{Deserialize, Serialize};

/// Everything that one measurement of a model found out.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Findings {
    /// The version that measured.
    pub understory_trade: String,
    /// The model's file.
    pub model: String,
    /// Hash of its texts.
    pub model_hash: String,
    /// Width and height in pixels of the pictures that were compared.
    pub size: [u32; 2],
    /// Pixels of the picture that is wanted over those of the pictures that were compared.
    pub scale: f64,
    /// Threads that worked.
    pub threads: usize,
    /// Other random numbers were tried so many times for each setting.
    pub seeds: u32,
    /// Seconds that were granted, and used in all runs so far.
    pub budget: f64,
    #[allow(missing_docs, reason = "see `budget`")]
    pub used: f64,
    /// The pictures that all others are compared with.
    pub reference: Reference,
    /// The ladders.
    pub families: Vec<Ladder>,
    /// What earlier runs have measured beside it, with other sizes, models or seeds.
    pub earlier: Vec<Measured>,
}

impl Findings {
    /// All settings that were ever measured.
    #[must_use]
    pub fn into_rungs(self) -> Vec<Measured> {
        let rungs = self.families.into_iter().flat_map(|ladder| ladder.rungs);
        rungs.chain(self.earlier).collect()
    }
}

/// The pictures that all others are compared with.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct Reference {
    /// What it belongs to: scene, camera, version.
    pub key: String,
    /// The method.
    pub method: String,
    /// What that method lacks, for people.
    pub lacks: Vec<String>,
    /// Samples per pixel, in both halves together.
    pub samples: u64,
    /// Seconds it took.
    pub seconds: f64,
    /// Relative squared noise of the mean of both halves.
    pub noise: f64,
}

/// What was measured of a family.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Ladder {
    /// Its name.
    pub name: String,
    /// What is turned up.
    pub knob: String,
    /// Whether it is compared with others.
    pub is_contender: bool,
    /// Whether an error may remain whatever the work.
    pub has_floor: bool,
    /// The power by which theory has the error fall with the knob.
    pub theory: Option<f64>,
    /// From cheap to dear.
    pub rungs: Vec<Measured>,
    /// Why there are not more.
    pub end: Option<String>,
}

/// What was measured of one setting. Errors are relative squared ones.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Measured {
    /// What it belongs to: reference, settings, seeds.
    pub key: String,
    /// How far the knob was turned.
    pub knob: f64,
    /// The options that make it.
    pub settings: Vec<(String, String)>,
    /// Seconds for the light that all cameras share.
    pub solve: f64,
    /// Seconds that the first view takes besides: what is gathered once it is seen, and kept for views of the same place.
    #[serde(default)]
    pub first: f64,
    /// Seconds for one view.
    pub view: f64,
    /// Mean over seeds, without the worst thousandth of the pixels.
    pub error: f64,
    /// Its standard error.
    pub error_deviation: f64,
    /// With all pixels.
    pub error_of_all: f64,
    /// The part of `error_of_all` that changes with the seed, and the part that does not.
    pub variance: f64,
    #[allow(missing_docs, reason = "see `variance`")]
    pub bias_squared: f64,
    /// All light in the picture, relative to the truth; with its standard error.
    pub energy: Option<[f64; 2]>,
    /// ꟻLIP: mean, and 95th percentile.
    pub flip: [f64; 2],
    /// How much a film flickers, in 8-bit levels.
    pub flicker: Option<Flicker>,
    /// Light of single objects, as `energy`.
    pub objects: Vec<ObjectBias>,
    /// Rays of one view.
    pub rays: u64,
    /// Patches of radiosity.
    pub patches: Option<u64>,
    /// Photons that were emitted.
    pub photons: Option<u64>,
    /// Pictures in the folder: as it looks, and how it differs.
    pub pictures: [String; 2],
}

/// How much too bright an object is.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct ObjectBias {
    /// What it is.
    pub name: String,
    /// Pixels whose middle shows it.
    pub pixels: usize,
    /// (found - true) / true.
    pub relative: f64,
    /// Its standard error.
    pub deviation: f64,
}

impl Ladder {
    /// Whether its error may have a floor, for fits.
    #[must_use]
    pub const fn floor(&self) -> Floor {
        if self.has_floor {
            Floor::Some
        } else {
            Floor::None
        }
    }
}

impl Measured {
    /// Seconds for so many cameras that see the same place, each of `scale` times as many pixels as were measured.
    ///
    /// What is gathered for neighbouring pixels grows with the picture, but more slowly: between not at all and in proportion.
    #[must_use]
    pub fn seconds(&self, cameras: u32, scale: f64) -> f64 {
        self.solve + scale.sqrt() * self.first + f64::from(cameras) * scale * self.view
    }

    /// The error, as far as it can be told from none: never less than its own uncertainty.
    #[must_use]
    pub fn resolved_error(&self) -> f64 {
        self.error.max(self.error_deviation).max(f64::MIN_POSITIVE)
    }
}

/// The table of all settings.
#[must_use]
pub fn csv(findings: &Findings) -> String {
    let mut out = String::from(FIRST_COLUMNS);
    out.push_str(
        ",settings,solve_s,first_s,view_s,relmse,relmse_se,relmse_all,variance,bias2,energy,energy_se,flip,flip_p95,flicker,rays,patches,photons\n",
    );
    for ladder in &findings.families {
        for rung in &ladder.rungs {
            let settings: Vec<String> = rung
                .settings
                .iter()
                .map(|(key, value)| format!("{key}={value}"))
                .collect();
            let [energy, deviation] = rung.energy.unwrap_or([f64::NAN; 2]);
            let count = |n: Option<u64>| n.map_or(String::new(), |n| n.to_string());
            let flicker = rung
                .flicker
                .map_or(String::new(), |f| format!("{:.4}", f.flicker));
            out.push_str(&format!(
                "\"{}\",{},{},{:.5},{:.5},{:.5},{:.4e},{:.2e},{:.4e},{:.4e},{:.4e},{:.4e},{:.2e},{:.4},{:.4},{flicker},{},{},{}\n",
                ladder.name,
                rung.knob,
                settings.join(" "),
                rung.solve,
                rung.first,
                rung.view,
                rung.error,
                rung.error_deviation,
                rung.error_of_all,
                rung.variance,
                rung.bias_squared,
                energy,
                deviation,
                rung.flip[0],
                rung.flip[1],
                rung.rays,
                count(rung.patches),
                count(rung.photons)
            ));
        }
    }
    out
}

/// By which an earlier table is known.
pub const FIRST_COLUMNS: &str = "family,knob";

#[cfg(test)]
mod tests {
    use super::*;
    use crate::trade::front::tests::measured;

    /// Light that is solved or gathered once is paid once; what is gathered grows with the side of the picture, a view with its area.
    #[test]
    fn what_is_kept_between_views_is_paid_once() {
        let rung = Measured {
            first: 10.0,
            ..measured(1.0, 100.0, 1.0, 0.1)
        };
        assert!((rung.seconds(1, 1.0) - 111.0).abs() < 1e-12);
        assert!((rung.seconds(1, 4.0) - 124.0).abs() < 1e-12);
        assert!((rung.seconds(100, 4.0) - 520.0).abs() < 1e-12);
    }
}
