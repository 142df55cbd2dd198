//! The methods there are to choose from, each with a ladder of settings: from rung to rung more of its dominant knob, the others tied to it.

use crate::options::value::Renderer;

/// The highest rung.
pub const TOP: u32 = 8;
/// Photons on the lowest rung; four times as many on each rung above.
const FIRST_PHOTONS: u64 = 50_000;
/// Photons of a pass: memory is that of one pass.
const PHOTONS_OF_PASS: u64 = FIRST_PHOTONS << 6;
/// Rays of a final gather up to this rung, and above.
const GATHER_RAYS: [&str; 2] = ["256", "1024"];
/// The highest rung with the fewer of them.
const FEW_RAYS: u32 = 3;
/// Radiosity, from rung to rung: threshold of subdivision, its depth, pixels of hemicubes.
const MESHES: [[&str; 3]; TOP as usize + 1] = [
    ["0.5", "1", "32"],
    ["0.3", "2", "32"],
    ["0.15", "3", "32"],
    ["0.08", "4", "64"],
    ["0.04", "5", "64"],
    ["0.02", "6", "128"],
    ["0.01", "7", "128"],
    ["0.005", "8", "256"],
    ["0.003", "9", "256"],
];

/// A method with a ladder of settings.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Family {
    /// Path tracing.
    Path,
    /// Standard ray tracing.
    Raytracer,
    /// Photon mapping, indirect light straight from the photons.
    PhotonMap,
    /// Photon mapping, indirect light gathered.
    PhotonGather,
    /// Radiosity.
    Radiosity,
}

impl Family {
    /// All, path tracing first: of equals it is preferred.
    pub const ALL: [Self; 5] = [
        Self::Path,
        Self::Raytracer,
        Self::PhotonMap,
        Self::PhotonGather,
        Self::Radiosity,
    ];

    /// The renderer that it is.
    #[must_use]
    pub fn renderer(self) -> Renderer {
        match self {
            Self::Path => Renderer::Path,
            Self::Raytracer => Renderer::Raytracer,
            Self::PhotonMap | Self::PhotonGather => Renderer::Photon,
            Self::Radiosity => Renderer::Radiosity,
        }
    }

    /// Whether it has more than one rung.
    #[must_use]
    pub fn has_rungs(self) -> bool {
        !matches!(self, Self::Path | Self::Raytracer)
    }

    /// What a rung up multiplies seconds for shared light by, and squared bias.
    ///
    /// Photons: MSE falls as their number to the power of -2/3 where kernels shrink with it
    /// ([`Hachisuka2008`](crate::references#hachisuka2008)). Radiosity: cells of half the size have a quarter of the error, a
    /// sixteenth of its square, where light is smooth; at shadows of indirect light much less is gained, so a quarter is expected.
    #[must_use]
    pub fn step(self) -> (f64, f64) {
        match self {
            Self::Path | Self::Raytracer => (1.0, 1.0),
            Self::PhotonMap | Self::PhotonGather => (4.0, 0.396_850_262_992_05),
            Self::Radiosity => (4.0, 0.25),
        }
    }

    /// Squared error by bias on the lowest rung where there is nothing to measure it by: what the study's scenes have.
    #[must_use]
    pub fn usual_bias(self) -> f64 {
        match self {
            Self::Path => 0.0,
            Self::Raytracer => 0.25,
            Self::PhotonMap => 0.02,
            Self::PhotonGather => 0.004,
            Self::Radiosity => 0.01,
        }
    }

    /// The options that it is on a rung, with their values.
    #[must_use]
    pub fn settings(self, rung: u32) -> Vec<(&'static str, String)> {
        let mut settings: Vec<(&str, String)> = Vec::new();
        let mut set = |key, text: &str| settings.push((key, text.to_owned()));
        match self {
            Self::Path => {
                set("renderer", "path");
                set("max-depth", "none");
            }
            Self::Raytracer => {
                set("renderer", "raytracer");
                set("recursion-depth", "8");
            }
            Self::PhotonMap | Self::PhotonGather => {
                let all = FIRST_PHOTONS << (2 * rung.min(TOP));
                let passes = all.div_ceil(PHOTONS_OF_PASS);
                let photons = (all / passes).to_string();
                let rays = match self {
                    Self::PhotonGather => GATHER_RAYS[usize::from(rung > FEW_RAYS)],
                    _ => "0",
                };
                set("renderer", "photon");
                set("global-photons", &photons);
                set("caustic-photons", &photons);
                set("photon-area", "auto");
                set("passes", &passes.to_string());
                set("final-gather", rays);
                set("recursion-depth", "8");
            }
            Self::Radiosity => {
                let [threshold, depth, pixels] = MESHES[rung.min(TOP) as usize];
                set("renderer", "radiosity");
                set("subdivision-threshold", threshold);
                set("subdivision-depth", depth);
                set("hemicube-pixels", pixels);
                set("final-gather", "auto");
                set("recursion-depth", "8");
            }
        }
        settings
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::options::{Options, Origin};

    #[test]
    fn every_rung_is_values_of_options_and_photons_are_four_times_as_many() {
        for family in Family::ALL {
            let mut before = None;
            for rung in 0..=TOP {
                let mut options = Options::default();
                for (key, text) in family.settings(rung) {
                    let origin = Origin::Chosen { over_file: false };
                    options.set(key, &text, origin).unwrap();
                    assert_eq!(options.entry_of(key).unwrap().text, text);
                }
                assert_eq!(options.renderer.value, family.renderer());
                let n = options.global_photons.value.0 * u64::from(options.passes.value.get());
                if family.renderer() == Renderer::Photon {
                    assert!(before.is_none_or(|before| n == 4 * before), "{n}");
                    assert!(options.global_photons.value.0 <= PHOTONS_OF_PASS);
                    before = Some(n);
                }
            }
        }
    }
}
