//! Photon mapping: light is followed once from its sources, then every camera looks at what was stored.
//!
//! Source: [`Jensen1996`](crate::references#jensen1996) and [`Jensen2001`](crate::references#jensen2001). What is stored and what not:
//!
//! - Direct light is never stored. Each view asks the [sources](super::sources) for it.
//! - The *global* map holds light that has been scattered; the *caustic* map light that has only been mirrored or refracted on its way,
//!   for which photons are aimed at specular surfaces alone. Where no caustic photons are wanted the global map holds both.
//! - Photons are stored on matt surfaces only. What mirrors, glass and glossy surfaces show is followed from the camera.
//!
//! Nothing that is stored depends on a camera. Light that passed panes and alpha straight on counts as direct.
//!
//! ```text
//! stored      which photons are stored              radius      how large kernels are
//! spots       where irradiance is sampled           estimate    irradiance over the real area
//! irradiance  the samples, asked by views           pieces      leaves smaller than the kernel
//! pool        light that needles share              crossings   their area, counted by lines
//! coverage    what too few photons stand for
//! progressive passes in the memory of one           view        what views ask of the maps
//! trials      estimates from photons laid out by hand
//!                                                   solution    all of it, kept and as bytes
//! ```
//! Views are those of the [final gather](super::final_gather), with or without it.
//!
//! Its error is blur over the kernel, and noise of the photons in it that is the same in every view. Infinite planes that shine
//! light other surfaces only as direct light that rays from the camera meet in mirrors.

mod coverage;
mod crossings;
mod estimate;
mod irradiance;
mod pieces;
mod pool;
mod progressive;
mod radius;
mod solution;
mod spots;
mod stored;
pub(crate) mod trials;
mod view;

use super::carrier::Carrier;
use super::final_gather::{FinalGather, GatherSettings, View};
use super::medium::Bodies;
use super::photon::{Aim, Emission, Photons, trace};
use super::requirements::{Feature, Features, Requirements};
use super::sources::Sources;
use super::viewer::Viewer;
use super::{
    Integrator, Progress, RadianceEstimator, RenderContext, RenderError, Solution, Unreadable,
};
use crate::material::Material;
use crate::math::{Bounds3, rng};
use crate::scene::Scene;
use crate::scene::description::OrganId;
pub use coverage::{Coverage, ENOUGH};
use glam::DVec3;
use irradiance::IrradianceMap;
use pieces::PiecePower;
use progressive::Progressive;
use radius::Sizes;
pub use solution::PhotonSolution;
use spots::World;
use std::collections::BTreeMap;
use std::ops::Range;
use std::sync::{Arc, OnceLock};
use stored::{Collector, Stored, Wanted};

/// Bytes that a stored photon takes while the maps are made: itself, its copies in lists that are joined and sorted.
pub const BYTES_PER_PHOTON: u64 = (size_of::<Stored>() + 2 * size_of::<PiecePower>()) as u64;

/// Up to so many photons are followed without asking whether they will fit, and so many tell it.
const PLANNED: u64 = 1 << 20;
const PILOTS: u64 = 1 << 14;

/// Scatterings after which a photon is given up; chance ends almost all long before.
const LONGEST_PATH: u32 = 1024;

/// Photons for caustics where their number is not given.
pub const CAUSTIC_PHOTONS: u64 = 1_000_000;

/// Settings of photon mapping.
#[derive(Clone, Debug, PartialEq)]
pub struct PhotonMapping {
    /// Photons sent to all surfaces.
    pub global_photons: u64,
    /// Photons sent to mirrors and glass; `None`: a million where there are any.
    pub caustic_photons: Option<u64>,
    /// Area of the kernel, m²; `None`: for each place by the photons there.
    pub photon_area: Option<f64>,
    /// How often as many photons are sent, at least 1; the memory is that of one pass.
    pub passes: u32,
    /// How often a ray from the camera is followed through mirrors, glass and glossy surfaces.
    pub max_depth: u32,
    /// Rays of each [final gather](super::final_gather), up to [`MOST_GATHER_RAYS`](super::final_gather::MOST_GATHER_RAYS); 0: indirect
    /// light comes straight from the map.
    /// Without effect where caustics are in the map of all light, for want of photons of their own.
    pub final_gather: u32,
    /// Photons that may be stored.
    pub most_stored: u64,
    /// What is done even if the scene does not require it.
    pub kept: Features,
}

impl Default for PhotonMapping {
    fn default() -> Self {
        Self {
            global_photons: 1_000_000,
            caustic_photons: None,
            photon_area: None,
            passes: 1,
            max_depth: 8,
            final_gather: 0,
            most_stored: u64::from(u32::MAX - 1),
            kept: Features::NONE,
        }
    }
}

impl Integrator for PhotonMapping {
    fn prepare<'s>(
        &self,
        scene: &'s Scene,
        context: &RenderContext<'_>,
    ) -> Result<Box<dyn RadianceEstimator + 's>, RenderError> {
        let solution = self.solution(scene, context)?;
        Ok(Box::new(self.look(scene, Arc::new(solution), context.seed)))
    }

    fn solve(&self, scene: &Scene, context: &RenderContext<'_>) -> Result<Solution, RenderError> {
        let solution = self.solution(scene, context)?;
        Ok(Solution::Photons(Arc::new(solution)))
    }

    fn view<'s>(
        &self,
        scene: &'s Scene,
        solution: &Solution,
        context: &RenderContext<'_>,
    ) -> Result<Box<dyn RadianceEstimator + 's>, RenderError> {
        match solution {
            Solution::Photons(maps) => Ok(Box::new(self.look(scene, maps.clone(), context.seed))),
            Solution::Nothing | Solution::Radiosity(_) => self.prepare(scene, context),
        }
    }

    fn restore(&self, bytes: &[u8]) -> Result<Solution, Unreadable> {
        let solution = PhotonSolution::from_bytes(bytes)?;
        Ok(Solution::Photons(Arc::new(solution)))
    }
}

impl PhotonMapping {
    /// Photons for caustics in this scene: none where nothing is specular, unless they are kept.
    #[must_use]
    pub fn caustic_photons_of(&self, scene: &Scene) -> u64 {
        self.caustic_photons_if(&Requirements::of(scene, self.kept))
    }

    fn caustic_photons_if(&self, requirements: &Requirements) -> u64 {
        let is_required = [Feature::Bounces, Feature::Caustics];
        if !is_required
            .into_iter()
            .all(|feature| requirements.has(feature))
        {
            return 0;
        }
        self.caustic_photons.unwrap_or(CAUSTIC_PHOTONS)
    }

    fn look<'s>(
        &self,
        scene: &'s Scene,
        maps: Arc<PhotonSolution>,
        seed: u64,
    ) -> View<'s, PhotonSolution> {
        let requirements = Requirements::of(scene, self.kept);
        let carrier = Carrier {
            scene,
            bodies: Bodies::required(scene, &requirements),
            max_depth: self.max_depth,
        };
        let sources = Sources::required(scene, &requirements);
        View {
            viewer: Viewer { carrier, sources },
            gather: self.gather((scene, &requirements), &maps, seed),
            light: maps,
        }
    }

    /// How views find indirect light, unless straight in the maps.
    fn gather(
        &self,
        (scene, requirements): (&Scene, &Requirements),
        maps: &PhotonSolution,
        seed: u64,
    ) -> Option<Arc<FinalGather>> {
        // Rays that find light behind mirrors and glass leave it to the map of caustics; there must be one.
        let is_specular = scene.materials().iter().any(Material::is_specular);
        let has_caustics_apart = !is_specular || self.caustic_photons_if(requirements) > 0;
        let is_dark = !requirements.has(Feature::Bounces);
        if self.final_gather == 0 || !has_caustics_apart || is_dark {
            return None;
        }
        let settings = GatherSettings {
            rays: self.final_gather,
            max_depth: self.max_depth,
            seed,
        };
        Some(FinalGather::over(maps, scene, settings))
    }

    fn solution(
        &self,
        scene: &Scene,
        context: &RenderContext<'_>,
    ) -> Result<PhotonSolution, RenderError> {
        let requirements = Requirements::of(scene, self.kept);
        let n_caustic = self.caustic_photons_if(&requirements);
        let n_global = if requirements.has(Feature::Bounces) {
            self.global_photons
        } else {
            0
        };
        let wanted = if n_caustic == 0 {
            Wanted::Indirect
        } else {
            Wanted::IndirectWithoutCaustics
        };
        let scene = (scene, &requirements);
        let global = self.map(scene, wanted, n_global, context)?;
        let caustic = self.map(scene, Wanted::Caustics, n_caustic, context)?;
        Ok(PhotonSolution {
            emitted: (n_global + n_caustic) * u64::from(self.passes),
            stored: global.n_stored + caustic.n_stored,
            global: global.light,
            caustic: caustic.light,
            sources: global.coverage,
            specular: caustic.coverage,
            gather: OnceLock::new(),
        })
    }

    /// Follows the photons of all passes and makes those that are wanted ready.
    fn map(
        &self,
        (scene, requirements): (&Scene, &Requirements),
        wanted: Wanted,
        n: u64,
        context: &RenderContext<'_>,
    ) -> Result<Map, RenderError> {
        if n == 0 {
            return Ok(Map::default());
        }
        let aim = match wanted {
            // Kept where nothing is specular, they would have nothing to be aimed at.
            Wanted::Caustics if scene.materials().iter().any(Material::is_specular) => {
                Aim::Specular
            }
            _ => Aim::Everything,
        };
        let bounds = scene.bounds();
        let center = if bounds.is_empty() {
            DVec3::ZERO
        } else {
            bounds.center()
        };
        let world = World { scene, center };
        let seed = rng::hash(&[context.seed, aim as u64]);
        let emission = Emission::required(requirements, scene, aim, Bounds3::EMPTY);
        let mut pass = Pass {
            emission: &emission,
            world,
            wanted,
            photons: Photons::all(n * u64::from(self.passes), seed, LONGEST_PATH),
            n,
            n_passes: self.passes,
            most: self.most_stored.min(u64::from(u32::MAX - 1)),
            met: BTreeMap::new(),
        };
        pass.plan(context)?;
        let first = pass.photons(0, context)?;
        let mut n_stored = first.len() as u64;
        let sizes = match (self.photon_area, wanted) {
            (Some(area), _) => Sizes::Area(area),
            (None, Wanted::Caustics) => Sizes::Narrow,
            (None, _) => Sizes::Wide,
        };
        let mut light = Progressive::begin(world, first, sizes, self.passes);
        if let Some(light) = &mut light {
            for index in 1..self.passes {
                let photons = pass.photons(index, context)?;
                n_stored += photons.len() as u64;
                light.add(index + 1, photons);
            }
        }
        Ok(Map {
            light: light.map(Progressive::finish),
            n_stored,
            coverage: match wanted {
                // In the dark nothing is missing.
                _ if emission.is_dark() => None,
                Wanted::Caustics => {
                    let areas = scene.areas_of(Material::is_specular);
                    areas.map(|areas| Coverage::of_specular(&areas, &pass.met))
                }
                _ => Some(Coverage::of(emission.sent(pass.photons.n))),
            },
        })
    }
}

/// Light of all photons of a kind.
#[derive(Default)]
struct Map {
    /// `None` if none arrived.
    light: Option<IrradianceMap>,
    n_stored: u64,
    /// Of sources by the photons that look for all light, of mirrors and glass by those that are aimed at them; `None` if there are no such
    /// photons, or too many surfaces to ask.
    coverage: Option<Coverage>,
}

/// How the photons of passes are followed.
struct Pass<'a, 's> {
    emission: &'a Emission<'s>,
    world: World<'s>,
    wanted: Wanted,
    /// Those of all passes.
    photons: Photons,
    /// Photons of a pass.
    n: u64,
    n_passes: u32,
    /// Photons that may be stored at once.
    most: u64,
    /// Photons for caustics that met each specular organ.
    met: BTreeMap<OrganId, u64>,
}

impl Pass<'_, '_> {
    /// Follows a few photons and tells from them whether those of a pass will fit.
    fn plan(&mut self, context: &RenderContext<'_>) -> Result<(), RenderError> {
        if self.n <= PLANNED {
            return Ok(());
        }
        let silent = RenderContext {
            progress: &|_| {},
            ..*context
        };
        let n_stored = self.stored(0..PILOTS, &silent)?.len();
        // They are followed once more.
        self.met.clear();
        let expected = self.n / PILOTS * n_stored as u64;
        self.check(expected)
    }

    fn check(&self, n: u64) -> Result<(), RenderError> {
        if n <= self.most {
            return Ok(());
        }
        Err(RenderError::TooManyPhotons { n, most: self.most })
    }

    /// The photons of a pass, counted from 0.
    fn photons(
        &mut self,
        pass: u32,
        context: &RenderContext<'_>,
    ) -> Result<Vec<Stored>, RenderError> {
        let begin = u64::from(pass) * self.n;
        let total = u64::from(self.n_passes) * self.n;
        let progress = |progress: Progress| {
            (context.progress)(Progress {
                done: begin + progress.done,
                total,
            });
        };
        let context = RenderContext {
            progress: &progress,
            ..*context
        };
        self.stored(begin..begin + self.n, &context)
    }

    /// Those of a range of photons that are wanted, where they arrive.
    fn stored(
        &mut self,
        range: Range<u64>,
        context: &RenderContext<'_>,
    ) -> Result<Vec<Stored>, RenderError> {
        let World { scene, center } = self.world;
        let wanted = self.wanted;
        let collector = || Collector {
            scene,
            wanted,
            center,
            photons: Vec::new(),
            met: BTreeMap::new(),
        };
        let photons = Photons {
            range,
            ..self.photons.clone()
        };
        let mut stored: Vec<Stored> = Vec::new();
        let mut n_stored = 0;
        let (most, met) = (self.most, &mut self.met);
        let join = |block: Collector<'_>| {
            n_stored += block.photons.len() as u64;
            if n_stored <= most {
                stored.extend(block.photons);
            }
            for (organ, n) in block.met {
                *met.entry(organ).or_default() += n;
            }
        };
        trace(self.emission, &photons, context, collector, join)?;
        self.check(n_stored)?;
        Ok(stored)
    }
}
