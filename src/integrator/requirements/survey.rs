//! Under which conditions features are required.

use super::feature::Feature;
use crate::integrator::radiosity::insides::seals;
use crate::light::Sky;
use crate::material::{Lobe, LobeKind, Material};
use crate::scene::Scene;

/// Boxes asked of the scene.
const BOXES: usize = 4096;

/// What a scene consists of, in numbers.
pub(super) struct Survey<'s> {
    scene: &'s Scene,
    /// Lamps that shine.
    n_lamps: usize,
    has_sun: bool,
    has_sky: bool,
    /// Whether what the sky shows below the horizon shines.
    has_land: bool,
    /// Surfaces that shine, endless planes left out.
    n_emitters: usize,
    /// Whether an endless plane may shine.
    has_shining_plane: bool,
}

impl<'s> Survey<'s> {
    pub(super) fn new(scene: &'s Scene) -> Self {
        let environment = scene.environment();
        let sun = environment.sun.as_ref();
        let lamps = scene.lights().iter();
        let (has_sky, has_land) = match &environment.sky {
            Sky::None => (false, false),
            Sky::Uniform(radiance) => (!radiance.is_black(), false),
            Sky::ClearSky {
                ground_albedo,
                strength,
                ..
            } => (*strength > 0.0, !ground_albedo.is_black()),
            Sky::Overcast {
                zenith,
                ground_albedo,
            } => (!zenith.is_black(), !ground_albedo.is_black()),
            Sky::Image { strength, .. } => (*strength > 0.0, false),
        };
        let mut materials = scene.materials().iter();
        let has_planes = scene.stats().planes > 0;
        Self {
            scene,
            n_lamps: lamps.filter(|lamp| !lamp.power(1.0).is_black()).count(),
            has_sun: sun.is_some_and(|sun| !sun.irradiance.is_black()),
            has_sky,
            has_land: has_sky && has_land,
            n_emitters: scene.emitters().len(),
            has_shining_plane: has_planes && materials.any(Material::is_emitter),
        }
    }

    /// Whether the scene requires a feature, and why.
    pub(super) fn look(&self, feature: Feature) -> (bool, String) {
        match feature {
            Feature::Bounces => self.bounces(),
            Feature::Caustics => self.any_material(
                "a mirror or glass",
                "mirrors or glass",
                Material::is_specular,
            ),
            Feature::UnaimedPhotons => self.unaimed_photons(),
            Feature::Guide => self.guide(),
            Feature::LightChoice => {
                let n = self.n_sources();
                (n > 1, counted(n, "source of light", "sources of light"))
            }
            Feature::LightHits => self.light_hits(),
            Feature::Bodies => {
                self.any_material("a body that absorbs", "bodies that absorb", |m| {
                    m.scattering()
                        .body()
                        .is_some_and(|inside| !inside.is_black())
                })
            }
            Feature::ClearShadows => {
                self.any_material("smooth glass", "smooth glass", is_clear_body)
            }
            Feature::UnaskedLight => self.unasked_light(),
            Feature::Insides => self.insides(),
            Feature::Coordinates => {
                self.any_material("painted with a picture", "painted with pictures", |m| {
                    m.pictures.is_some()
                })
            }
            Feature::Groups => {
                let (n, stats) = (self.scene.left_out().groups, self.scene.stats());
                let instances = counted(stats.instances, "instance", "instances");
                let dissolved = match n {
                    0 => "no group is used once or small".to_owned(),
                    n => counted(
                        n,
                        "group is used once or small",
                        "groups are used once or small",
                    ),
                };
                (n == 0, format!("{dissolved}; {instances}"))
            }
        }
    }

    fn n_sources(&self) -> usize {
        let others = [self.has_sun, self.has_sky, self.has_shining_plane];
        let others = others.into_iter().filter(|is_there| *is_there).count();
        self.n_lamps + self.n_emitters + others
    }

    /// Whether any material is like this, with how many are.
    fn any_material(
        &self,
        one: &str,
        many: &str,
        is_it: impl Fn(&Material) -> bool,
    ) -> (bool, String) {
        let materials = self.scene.materials();
        let n = materials.iter().filter(|material| is_it(material)).count();
        let all = materials.len();
        let why = match n {
            0 => format!("no material is {one} (0 of {all})"),
            1 => format!("a material is {one} (1 of {all})"),
            n => format!("materials are {many} ({n} of {all})"),
        };
        (n > 0, why)
    }

    fn bounces(&self) -> (bool, String) {
        if self.n_sources() == 0 {
            return (false, "nothing shines".into());
        }
        let materials = self.scene.materials();
        let n = materials
            .iter()
            .filter(|material| scatters(material))
            .count();
        let verb = match n {
            0 => "no material scatters light",
            1 => "a material scatters light",
            _ => "materials scatter light",
        };
        (n > 0, format!("{verb} ({n} of {})", materials.len()))
    }

    fn unaimed_photons(&self) -> (bool, String) {
        let scene = self.scene;
        let mut materials = scene.materials().iter();
        if materials.any(Material::is_specular) {
            let found = scene.extents_of(Material::is_specular, BOXES);
            if found.has_planes {
                return (true, "an endless plane is a mirror or glass".into());
            }
            let n = counted(found.boxes.len(), "box holds", "boxes hold");
            return (false, format!("{n} all mirrors and glass"));
        }
        match scene.stats().planes {
            0 => (false, "a box holds the scene".into()),
            n => (true, counted(n, "plane is", "planes are") + " endless"),
        }
    }

    fn guide(&self) -> (bool, String) {
        if self.has_sun || self.has_sky {
            return (false, "sun or sky light the scene evenly".into());
        }
        if self.n_emitters == 0 {
            return (false, "no surface shines, so none is met by luck".into());
        }
        self.any_material(
            "a mirror or glass",
            "mirrors or glass",
            Material::is_specular,
        )
    }

    fn light_hits(&self) -> (bool, String) {
        let (n, planes) = (self.n_emitters, self.has_shining_plane);
        let mut there = Vec::new();
        there.extend((n > 0).then(|| counted(n, "shining surface", "shining surfaces")));
        there.extend(planes.then(|| "a shining plane".to_owned()));
        there.extend(self.has_sky.then(|| "a sky".to_owned()));
        there.extend(self.has_sun.then(|| "the sun".to_owned()));
        if there.is_empty() {
            let lamps = counted(self.n_lamps, "lamp without extent", "lamps without extent");
            return (false, format!("no ray can meet light: {lamps}"));
        }
        (true, format!("rays can meet {}", there.join(", ")))
    }

    fn insides(&self) -> (bool, String) {
        let (n, all) = self.scene.closed_bodies(seals);
        match n {
            0 => (true, format!("no shape closes an opaque body (0 of {all})")),
            n => (
                false,
                format!("no light gets into closed bodies ({n} of {all} shapes)"),
            ),
        }
    }

    fn unasked_light(&self) -> (bool, String) {
        if self.has_shining_plane {
            return (true, "an endless plane may shine".into());
        }
        if self.has_land {
            return (true, "the sky shows land below the horizon".into());
        }
        self.any_material(
            "a mirror, glass or glossy",
            "mirrors, glass or glossy",
            |material| {
                let mut lobes = material.lobes.iter();
                lobes.any(|lobe| lobe.kind != LobeKind::Through)
            },
        )
    }
}

/// A number of things.
fn counted(n: usize, one: &str, many: &str) -> String {
    format!("{n} {}", if n == 1 { one } else { many })
}

/// Whether a material sends light anywhere but straight on.
fn scatters(material: &Material) -> bool {
    let sends = |is_front: bool| {
        let matt = material.most_sides()[usize::from(!is_front)];
        !(matt.reflectance.is_black() && matt.transmittance.is_black())
    };
    let bends = |lobe: &Lobe| lobe.kind != LobeKind::Through && !lobe.weight.is_black();
    material.alpha > 0.0 && (sends(true) || sends(false) || material.lobes.iter().any(bends))
}

/// Whether smooth glass begins behind it.
fn is_clear_body(material: &Material) -> bool {
    let mut lobes = material.lobes.iter();
    lobes.any(|lobe| lobe.is_body() && lobe.is_delta())
}
