//! Radiosity: what surfaces send each other is solved once, on the surfaces, for all cameras.
//!
//! Source: [`CohenWallace1993`](crate::references#cohenwallace1993). What is solved and what not:
//!
//! - Surfaces are cut into patches, each with a front and a back, so that leaves reflect and let through. Solved is what matt surfaces
//!   send to each other, for all channels at once.
//! - Direct light of lamps, sky and shining surfaces is asked for at points of each patch, and again by each view at the point that
//!   it sees: shadows are sharp however coarse the patches are, and nothing is counted twice.
//! - Mirrors, glass and gloss take part: rays between patches go on through them, and so do rays of views. Light that *sources* send
//!   through mirrors and glass onto matt surfaces is found by rays from patches alone: of lamps with extent and of the sky, but not of lamps
//!   without extent and of the disk of the sun.
//!
//! ```text
//! mesh      patches and elements         system      the equations, rows of form factors
//! refine    smaller elements             gather      Gauss and Seidel
//! vertices  between elements             shoot       progressive refinement
//! source    what light sources give      stochastic  all patches at once, nothing stored
//! view      what views ask of it         rays        form factors by rays
//! polygon   between polygons, on paper   hemicube    drawn onto half a cube
//! kept      as bytes                      solution    what is kept
//! insides   where no light is
//! painted   as a mesh with colours        analytic    on paper where that holds
//! laid      all of it, laid open for trials
//! ```
//! Its errors are the size of patches, and noise of rays that is the same in every view.

mod analytic;
mod gather;
mod hemicube;
pub(in crate::integrator) mod insides;
mod kept;
pub(crate) mod laid;
mod mesh;
mod painted;
mod polygon;
mod rays;
mod refine;
mod shoot;
mod solution;
mod source;
mod stochastic;
mod system;
#[cfg(test)]
mod tests;
mod vertices;
mod view;

use super::carrier::Carrier;
use super::final_gather::{FinalGather, GatherSettings, View};
use super::medium::Bodies;
use super::requirements::{Feature, Features, Requirements, has_focused_light};
use super::sources::Sources;
use super::viewer::Viewer;
use super::{Integrator, Progress, RadianceEstimator, RenderContext, RenderError};
use crate::color::Rgb;
use crate::math::functions::ln;
use crate::scene::Scene;
use analytic::NearForms;
use hemicube::Hemicubes;
use mesh::{Mesh, NONE};
use rayon::prelude::*;
use rays::CosineRays;
use refine::Refinement;
pub use solution::RadiositySolution;
use solution::{focused_on_patches, light_of, of_patches};
use source::Lighting;
use std::cell::RefCell;
use std::sync::atomic::{AtomicU64, Ordering};
use std::sync::{Arc, OnceLock};
use system::{FormFactors, Patch, Row, Solved};
use vertices::Vertices;

/// Bytes that a patch takes, with its faces, corners and light.
const BYTES_PER_PATCH: u64 = 1024;

/// Bytes that a factor of a row takes.
const BYTES_PER_FACTOR: u64 = size_of::<(u32, f32)>() as u64;

/// Hemicubes along each side of a cell.
const CUBES: u32 = 2;

/// Patches up to which rows are stored where nobody chooses a solver, and patches are split.
const FEW_PATCHES: usize = 20_000;

/// Part of all light that may be missing at the end.
const TOLERANCE: f64 = 1e-3;

/// Mirrors and glass after which a ray between patches is given up; chance ends almost all before.
const LONGEST_WAY: u32 = 64;

/// Steps in which progress of the solution is told.
const STEPS: f64 = 1000.0;

/// Width in coordinates of the smallest cells: their halves are still told apart.
const TOO_SMALL_TO_SPLIT: f64 = 1e-6;

/// How the equations are solved.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Solver {
    /// Each patch collects from all others, again and again; rows of form factors are stored.
    Gather,
    /// The brightest patches shoot what they have left; rows are stored while there is room.
    Shoot,
    /// All patches shoot rays, as many as they have light; nothing is stored.
    Stochastic,
}

/// Where form factors come from.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum FormFactorMethod {
    /// Rays with the density of the cosine.
    #[default]
    Rays,
    /// Hemicubes, GroIMP's method.
    Hemicube,
    /// Closed forms between flat patches that are near each other and wholly visible, rays elsewhere.
    Analytic,
}

/// Settings of radiosity.
#[derive(Clone, Debug, PartialEq)]
pub struct Radiosity {
    /// How the equations are solved; `None`: by gathering up to 20,000 patches, stochastically beyond.
    pub solver: Option<Solver>,
    /// Pixels along an edge of a hemicube; a row made of rays has a quarter of its square of them.
    pub hemicube_pixels: u32,
    /// Hemicubes along each side of a patch or element, at least 1; GroIMP has one, in the middle.
    pub hemicubes: u32,
    /// Edge of the hemicube, metres: what is nearer than half of it is not drawn; `None`: very near.
    pub hemicube_size: Option<f64>,
    /// Where form factors come from; the stochastic solver uses them only for the elements.
    pub form_factors: FormFactorMethod,
    /// Difference of light over an element as wide as a patch beyond which it is split, as a part of the light there.
    pub subdivision_threshold: f64,
    /// How often a patch is split at most.
    pub subdivision_depth: u32,
    /// How often a ray from the camera is followed through mirrors, glass and glossy surfaces.
    pub max_depth: u32,
    /// Rays of each [final gather](super::final_gather), up to [`MOST_GATHER_RAYS`](super::final_gather::MOST_GATHER_RAYS); 0: views show
    /// the light of elements as it is.
    pub final_gather: u32,
    /// Bytes that all of it may take.
    pub memory: u64,
    /// What is done even if the scene does not require it.
    pub kept: Features,
}

impl Default for Radiosity {
    fn default() -> Self {
        Self {
            solver: None,
            hemicube_pixels: 32,
            hemicube_size: None,
            form_factors: FormFactorMethod::Rays,
            subdivision_threshold: 0.15,
            subdivision_depth: 3,
            max_depth: 8,
            final_gather: 0,
            hemicubes: CUBES,
            memory: 1 << 32,
            kept: Features::NONE,
        }
    }
}

impl Integrator for Radiosity {
    fn prepare<'s>(
        &self,
        scene: &'s Scene,
        context: &RenderContext<'_>,
    ) -> Result<Box<dyn RadianceEstimator + 's>, RenderError> {
        let solution = self.solution(scene, context, &mut |_| {})?;
        Ok(Box::new(self.look(scene, Arc::new(solution), context.seed)))
    }

    fn solve(
        &self,
        scene: &Scene,
        context: &RenderContext<'_>,
    ) -> Result<super::Solution, RenderError> {
        self.solve_showing(scene, context, &mut |_| {})
    }

    fn solve_showing(
        &self,
        scene: &Scene,
        context: &RenderContext<'_>,
        early: &mut dyn FnMut(&dyn Fn() -> super::Solution),
    ) -> Result<super::Solution, RenderError> {
        let solution = self.solution(scene, context, early)?;
        Ok(super::Solution::Radiosity(Arc::new(solution)))
    }

    fn view<'s>(
        &self,
        scene: &'s Scene,
        solution: &super::Solution,
        context: &RenderContext<'_>,
    ) -> Result<Box<dyn RadianceEstimator + 's>, RenderError> {
        match solution {
            super::Solution::Radiosity(solution) if solution.fits(scene) => {
                Ok(Box::new(self.look(scene, solution.clone(), context.seed)))
            }
            _ => self.prepare(scene, context),
        }
    }

    fn restore(&self, bytes: &[u8]) -> Result<super::Solution, super::Unreadable> {
        let solution = RadiositySolution::from_bytes(bytes)?;
        Ok(super::Solution::Radiosity(Arc::new(solution)))
    }

    fn shortcomings(&self, scene: &Scene) -> Vec<&'static str> {
        let focused = "light that smooth curved glass throws onto other surfaces is missing: `radiosity` does not find \
                       light of a point, spot or parallel light or of the sun behind glass that bends it";
        let lacks = has_focused_light(scene);
        lacks.then_some(focused).into_iter().collect()
    }
}

/// What light is asked for with.
struct Light<'a, 's> {
    carrier: &'a Carrier<'s>,
    sources: &'a Sources<'s>,
    requirements: &'a Requirements,
    /// By face, whether its back is the inside of a body that no light is in.
    dark: &'a [bool],
}

/// Patches with their light.
struct Sent {
    patches: Vec<Patch>,
    solved: Solved,
    /// Whether what was found for patches is the noisy result of shots rather than of rows.
    is_shot: bool,
}

/// The light of elements by node, front and back.
struct Received {
    /// All that views do not ask for.
    irradiance: Vec<[Rgb; 2]>,
    /// The part of it that mirrors and glass threw there from sources.
    focused: Vec<[Rgb; 2]>,
    /// Whether they were split as far as was wanted.
    is_split: bool,
}

impl Radiosity {
    fn look<'s>(
        &self,
        scene: &'s Scene,
        solution: Arc<RadiositySolution>,
        seed: u64,
    ) -> View<'s, RadiositySolution> {
        let requirements = Requirements::of(scene, self.kept);
        let carrier = Carrier {
            scene,
            bodies: Bodies::required(scene, &requirements),
            max_depth: self.max_depth,
        };
        let sources = Sources::required(scene, &requirements);
        let gathers = self.final_gather > 0 && requirements.has(Feature::Bounces);
        let gather = gathers.then(|| {
            let settings = GatherSettings {
                rays: self.final_gather,
                max_depth: self.max_depth,
                seed,
            };
            FinalGather::over(&*solution, scene, settings)
        });
        View {
            viewer: Viewer { carrier, sources },
            light: solution,
            gather,
        }
    }

    fn solution(
        &self,
        scene: &Scene,
        context: &RenderContext<'_>,
        early: &mut dyn FnMut(&dyn Fn() -> super::Solution),
    ) -> Result<RadiositySolution, RenderError> {
        let requirements = Requirements::of(scene, self.kept);
        let carrier = Carrier {
            scene,
            bodies: Bodies::required(scene, &requirements),
            max_depth: LONGEST_WAY,
        };
        let sources = Sources::required(scene, &requirements);
        let mut mesh = self.mesh(scene)?;
        let dark = if requirements.has(Feature::Insides) {
            vec![false; mesh.charts.len()]
        } else {
            insides::sealed(scene, &mesh)
        };
        let light = Light {
            dark: &dark,
            carrier: &carrier,
            sources: &sources,
            requirements: &requirements,
        };
        let sent = self.solve_patches(&mesh, &light, context, early)?;
        let found = self.elements(&mut mesh, &sent, &light, context);
        if context.cancel.is_cancelled() {
            return Err(RenderError::Cancelled { partial: None });
        }
        let size = size_of_scene(scene);
        let is_focused = found.focused.iter().flatten().any(|l| !l.is_black());
        let focused = is_focused.then(|| Vertices::new(&mesh, &found.focused, size).values);
        Ok(RadiositySolution {
            vertices: Vertices::new(&mesh, &found.irradiance, size),
            focused,
            is_split: found.is_split,
            patches: mesh.patches.len() as u64,
            residual: sent.solved.residual,
            is_converged: sent.solved.is_converged,
            fits: OnceLock::from(true),
            gather: OnceLock::new(),
            mesh,
        })
    }

    /// Cuts the scene into as many patches as there is memory for.
    fn mesh(&self, scene: &Scene) -> Result<Mesh, RenderError> {
        let most = self.memory / BYTES_PER_PATCH;
        let most = most.min(u64::from(u32::MAX) / 8);
        Mesh::new(scene, most).map_err(|n| RenderError::TooManyPatches { n, most })
    }

    /// Rays of a row.
    fn rays_per_row(&self) -> u32 {
        (self.hemicube_pixels.saturating_mul(self.hemicube_pixels) / 4).max(1)
    }

    /// Finds what light sources give to patches, and what patches give to each other.
    fn solve_patches(
        &self,
        mesh: &Mesh,
        light: &Light<'_, '_>,
        context: &RenderContext<'_>,
        early: &mut dyn FnMut(&dyn Fn() -> super::Solution),
    ) -> Result<Sent, RenderError> {
        let carrier = light.carrier;
        let patches = self.lighting(mesh, light, context).patches();
        let solver = self.solver_for(&patches)?;
        let solved = match solver {
            Solver::Gather => {
                let factors = self.factors(mesh, carrier, context.seed);
                let rows = gathered_rows(&*factors, &patches, mesh, context);
                gather::solve(&patches, &rows, TOLERANCE, |left| tell(context, left))
            }
            Solver::Shoot => {
                let shots = shoot::Shots {
                    factors: &*self.factors(mesh, carrier, context.seed),
                    nodes: &mesh.patches,
                    room: self.memory / 4,
                };
                let size = size_of_scene(carrier.scene);
                shoot::solve_showing(&patches, &shots, TOLERANCE, |left, so_far| {
                    early(&|| {
                        let shown = RadiositySolution::early(mesh, &patches, &so_far(), size);
                        super::Solution::Radiosity(Arc::new(shown))
                    });
                    tell(context, left)
                })
            }
            Solver::Stochastic => {
                // As many as if insides were lit: the answer is the same without them.
                let sides = patches.iter().flat_map(|patch| &patch.sides);
                let n_sides = sides.filter(|side| side.scatters()).count() as u64;
                let rays = self.rays(mesh, carrier, context.seed);
                let n_rays = n_sides * u64::from(rays.n);
                stochastic::solve(&patches, &rays, n_rays, TOLERANCE, context.cancel, |left| {
                    tell(context, left)
                })
            }
        };
        if context.cancel.is_cancelled() {
            return Err(RenderError::Cancelled { partial: None });
        }
        Ok(Sent {
            patches,
            solved,
            is_shot: solver != Solver::Gather,
        })
    }

    fn lighting<'a, 's>(
        &self,
        mesh: &'a Mesh,
        light: &Light<'a, 's>,
        context: &RenderContext<'a>,
    ) -> Lighting<'a, 's> {
        Lighting {
            mesh,
            carrier: light.carrier,
            sources: light.sources,
            seed: context.seed,
            bounces: light.requirements.has(Feature::Bounces),
            dark: light.dark,
            n_stray: if light.requirements.has(Feature::UnaskedLight) {
                self.rays_per_row()
            } else {
                0
            },
            cancel: context.cancel,
        }
    }

    fn rays<'a, 's>(
        &self,
        mesh: &'a Mesh,
        carrier: &'a Carrier<'s>,
        seed: u64,
    ) -> CosineRays<'a, 's> {
        CosineRays {
            mesh,
            carrier,
            seed,
            n: self.rays_per_row(),
        }
    }

    /// What form factors come from.
    fn factors<'a>(
        &self,
        mesh: &'a Mesh,
        carrier: &'a Carrier<'_>,
        seed: u64,
    ) -> Box<dyn FormFactors + 'a> {
        let rays = self.rays(mesh, carrier, seed);
        match self.form_factors {
            FormFactorMethod::Rays => Box::new(rays),
            FormFactorMethod::Hemicube => {
                let (pixels, size) = (self.hemicube_pixels, self.hemicube_size);
                let cubes = self.hemicubes.max(1);
                Box::new(Hemicubes::new(mesh, carrier, seed, pixels, cubes, size))
            }
            FormFactorMethod::Analytic => Box::new(NearForms::new(rays)),
        }
    }

    /// Splits elements where light changes fast, and finds the light of all of them that views do not ask for.
    fn elements(
        &self,
        mesh: &mut Mesh,
        sent: &Sent,
        light: &Light<'_, '_>,
        context: &RenderContext<'_>,
    ) -> Received {
        let patches = &sent.patches;
        let first = if sent.is_shot && patches.len() <= FEW_PATCHES {
            self.received(mesh, 0, (sent, light), context)
        } else {
            let all = of_patches(mesh, patches, &sent.solved).into_iter();
            all.zip(focused_on_patches(mesh, patches)).collect()
        };
        let (mut irradiance, focused): (Vec<_>, Vec<_>) = first.into_iter().unzip();
        // What is found for new elements is split in two as it comes.
        let focused = RefCell::new(focused);
        let gathered = |mesh: &Mesh, first: usize| {
            let found = self.received(mesh, first, (sent, light), context);
            let (all, more): (Vec<_>, Vec<_>) = found.into_iter().unzip();
            focused.borrow_mut().extend(more);
            all
        };
        let refinement = Refinement {
            threshold: self.subdivision_threshold,
            depth: self.subdivision_depth,
            most: (self.memory / BYTES_PER_PATCH).min(u64::from(u32::MAX) / 2) as usize,
            size: size_of_scene(light.carrier.scene),
            cancel: context.cancel,
        };
        let is_split = patches.len() > FEW_PATCHES || {
            let light = light_of(patches, &sent.solved);
            refine::refine(mesh, &mut irradiance, &refinement, &light, gathered)
        };
        Received {
            irradiance,
            focused: focused.into_inner(),
            is_split,
        }
    }

    /// The light of elements from a number on, front and back: all that views do not ask for, and the part of it that mirrors and
    /// glass threw there.
    fn received(
        &self,
        mesh: &Mesh,
        first: usize,
        (sent, light): (&Sent, &Light<'_, '_>),
        context: &RenderContext<'_>,
    ) -> Vec<([Rgb; 2], [Rgb; 2])> {
        let factors = self.factors(mesh, light.carrier, context.seed);
        let lighting = self.lighting(mesh, light, context);
        let side = |at: usize, side: usize| {
            let node = &mesh.nodes[at];
            let is_wanted =
                node.children == NONE && sent.patches[node.patch as usize].sides[side].is_needed();
            if !is_wanted || context.cancel.is_cancelled() {
                return (Rgb::BLACK, Rgb::BLACK);
            }
            let row = factors.row(at as u32, side);
            let stray = lighting.stray(at as u32, side);
            (
                row.gather(&sent.solved.radiosity) + stray.all,
                stray.focused,
            )
        };
        let both = |at: usize| {
            let (front, back) = (side(at, 0), side(at, 1));
            ([front.0, back.0], [front.1, back.1])
        };
        (first..mesh.nodes.len())
            .into_par_iter()
            .map(both)
            .collect()
    }

    /// The solver that is asked for, or that suits so many patches.
    fn solver_for(&self, patches: &[Patch]) -> Result<Solver, RenderError> {
        let per_row = u64::from(self.rays_per_row()).min(2 * patches.len() as u64);
        let per_row = per_row * BYTES_PER_FACTOR + size_of::<Row>() as u64;
        let needed = sides_needed(patches) * per_row;
        let most = self.memory / 2;
        match self.solver {
            Some(Solver::Gather) if needed > most => {
                Err(RenderError::TooManyFactors { needed, most })
            }
            Some(solver) => Ok(solver),
            None if patches.len() > FEW_PATCHES || needed > most => Ok(Solver::Stochastic),
            None => Ok(Solver::Gather),
        }
    }
}

/// Sides of patches on which light does anything.
fn sides_needed(patches: &[Patch]) -> u64 {
    let sides = patches.iter().flat_map(|patch| &patch.sides);
    sides.filter(|side| side.is_needed()).count() as u64
}

/// The rows of all sides, in parallel, with progress.
fn gathered_rows(
    factors: &dyn FormFactors,
    patches: &[Patch],
    mesh: &Mesh,
    context: &RenderContext<'_>,
) -> Vec<Row> {
    let total = sides_needed(patches);
    let done = AtomicU64::new(0);
    let row = |side: usize| {
        let is_needed = patches[side / 2].sides[side % 2].is_needed();
        if !is_needed || context.cancel.is_cancelled() {
            return Row::default();
        }
        let row = factors.row(mesh.patches[side / 2], side % 2);
        let done = done.fetch_add(1, Ordering::Relaxed) + 1;
        if done.is_multiple_of(64) || done == total {
            (context.progress)(Progress { done, total });
        }
        row
    };
    (0..2 * patches.len()).into_par_iter().map(row).collect()
}

/// Tells how much light is left to shoot, as a share of the way there; whether to go on.
fn tell(context: &RenderContext<'_>, left: f64) -> bool {
    let share = (ln(left.max(TOLERANCE)) / ln(TOLERANCE)).clamp(0.0, 1.0);
    (context.progress)(Progress {
        done: (share * STEPS) as u64,
        total: STEPS as u64,
    });
    !context.cancel.is_cancelled()
}

/// How large a scene is, metres; 1 where there is nothing but planes.
fn size_of_scene(scene: &Scene) -> f64 {
    let bounds = scene.bounds();
    if bounds.is_empty() {
        return 1.0;
    }
    match bounds.diagonal().length() {
        size if size > 0.0 => size,
        _ => 1.0,
    }
}
