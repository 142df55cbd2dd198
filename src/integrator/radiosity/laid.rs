//! A scene with its patches, laid open: what tests of the parts of radiosity and [`crate::validation::extremes`] ask.

use super::analytic::NearForms;
use super::hemicube::Hemicubes;
use super::mesh::Mesh;
use super::rays::CosineRays;
use super::refine::{Refinement, refine};
use super::system::{FormFactors, Patch, PatchSide, Row, Solved};
use super::{
    CUBES, FormFactorMethod, RenderContext, Solver, gather, gathered_rows, shoot, stochastic,
};
use crate::color::Rgb;
use crate::integrator::RenderError;
use crate::integrator::carrier::Carrier;
use crate::integrator::medium::Bodies;
use crate::scene::Scene;
use crate::scene::description::MaterialId;

/// Bytes that rows may take which shooting keeps.
const ROOM: u64 = 1 << 30;

/// A scene with its patches.
pub(crate) struct Laid<'s> {
    pub(super) carrier: Carrier<'s>,
    pub(super) mesh: Mesh,
}

/// How form factors are found.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Means {
    /// Where they come from.
    pub(crate) method: FormFactorMethod,
    /// Rays of a row.
    pub(crate) n_rays: u32,
    /// Pixels along an edge of a hemicube.
    pub(crate) pixels: u32,
    /// Hemicubes along each side of a cell.
    pub(crate) cubes: u32,
}

impl Means {
    /// With so many rays and pixels.
    pub(crate) fn new(method: FormFactorMethod, n_rays: u32, pixels: u32) -> Self {
        Self {
            method,
            n_rays,
            pixels,
            cubes: CUBES,
        }
    }
}

/// A patch, for those who only look.
#[derive(Clone, Copy, Debug)]
pub(crate) struct PatchView {
    /// The face that it is part of.
    pub(crate) face: u32,
    /// m².
    pub(crate) area: f64,
    /// Whether the face is flat.
    pub(crate) is_flat: bool,
    /// What it is made of.
    pub(crate) material: MaterialId,
}

/// What the front of a patch does.
#[derive(Clone, Copy, Debug, Default)]
pub(crate) struct Front {
    /// What it reflects.
    pub(crate) rho: f64,
    /// Irradiance that it has from elsewhere, W/m².
    pub(crate) source: f64,
}

/// What solvers find, of fronts, and in how many steps.
#[derive(Clone, Debug)]
pub(crate) struct Fronts {
    /// Irradiance from other patches, W/m².
    pub(crate) irradiance: Vec<f64>,
    /// What is sent, W/m².
    pub(crate) radiosity: Vec<f64>,
    /// What is still to come, as a part of all.
    pub(crate) residual: f64,
    /// Whether that is as little as it was to be.
    pub(crate) is_converged: bool,
    /// Sweeps, salvos or iterations.
    pub(crate) steps: u32,
}

impl<'s> Laid<'s> {
    /// With at most about so many patches.
    pub(crate) fn cut(scene: &'s Scene, most: u64) -> Result<Self, RenderError> {
        let carrier = Carrier {
            scene,
            bodies: Bodies::new(scene),
            max_depth: 8,
        };
        let mesh = Mesh::new(scene, most);
        let mesh = mesh.map_err(|n| RenderError::TooManyPatches { n, most })?;
        Ok(Self { carrier, mesh })
    }

    /// All patches.
    pub(crate) fn patches(&self) -> Vec<PatchView> {
        let view = |node: &u32| {
            let node = &self.mesh.nodes[*node as usize];
            let chart = &self.mesh.charts[node.cell.chart as usize];
            PatchView {
                face: node.cell.chart,
                area: node.area,
                is_flat: chart.chart.is_flat(),
                material: chart.material,
            }
        };
        self.mesh.patches.iter().map(view).collect()
    }

    /// Green form factors from side `side` (0 front) of each of the wanted patches, to `2 · patch + side`.
    pub(crate) fn rows(
        &self,
        means: Means,
        side: usize,
        patches: impl Iterator<Item = usize>,
    ) -> Vec<Vec<(usize, f64)>> {
        let factors = self.factors(means);
        let row = |patch: usize| {
            let row = factors.row(self.mesh.patches[patch], side);
            row.entries().map(|(to, factor)| (to, factor.g)).collect()
        };
        patches.map(row).collect()
    }

    /// Solves for these fronts, in at most so many steps.
    pub(crate) fn solve(
        &self,
        (solver, means): (Solver, Means),
        fronts: &[Front],
        (tolerance, most_steps): (f64, u32),
        context: &RenderContext<'_>,
    ) -> Fronts {
        let patches = self.with_fronts(fronts);
        let mut steps = 0;
        let go_on = |_: f64| {
            steps += 1;
            steps < most_steps && !context.cancel.is_cancelled()
        };
        let solved = match solver {
            Solver::Gather => {
                let rows = self.all_rows(&*self.factors(means), &patches, context);
                gather::solve(&patches, &rows, tolerance, go_on)
            }
            Solver::Shoot => {
                let shots = shoot::Shots {
                    factors: &*self.factors(means),
                    nodes: &self.mesh.patches,
                    room: ROOM,
                };
                shoot::solve(&patches, &shots, tolerance, go_on)
            }
            Solver::Stochastic => {
                let rays = self.rays(means.n_rays);
                let n_rays = u64::from(means.n_rays) * patches.len() as u64;
                stochastic::solve(&patches, &rays, n_rays, tolerance, context.cancel, go_on)
            }
        };
        of_fronts(&solved, steps)
    }

    /// Patches and, at the end, elements where light differs from one to the next so that all are split, up to a depth and so many cells.
    pub(crate) fn split(
        mut self,
        depth: u32,
        most: usize,
        context: &RenderContext<'_>,
    ) -> [usize; 2] {
        let light = |mesh: &Mesh, first: usize| -> Vec<[Rgb; 2]> {
            let nodes = first..mesh.nodes.len();
            nodes.map(|at| [Rgb::splat((at % 7) as f64); 2]).collect()
        };
        let refinement = Refinement {
            threshold: 0.0,
            depth,
            most,
            size: super::size_of_scene(self.carrier.scene),
            cancel: context.cancel,
        };
        let n = self.mesh.patches.len();
        let mut irradiance = light(&self.mesh, 0);
        refine(
            &mut self.mesh,
            &mut irradiance,
            &refinement,
            &vec![1.0; n],
            light,
        );
        [n, self.mesh.elements().count()]
    }

    /// A back end.
    pub(super) fn factors(&self, means: Means) -> Box<dyn FormFactors + '_> {
        match means.method {
            FormFactorMethod::Rays => Box::new(self.rays(means.n_rays)),
            FormFactorMethod::Hemicube => {
                let (mesh, carrier) = (&self.mesh, &self.carrier);
                Box::new(Hemicubes::new(
                    mesh,
                    carrier,
                    1,
                    means.pixels,
                    means.cubes,
                    None,
                ))
            }
            FormFactorMethod::Analytic => Box::new(NearForms::new(self.rays(means.n_rays))),
        }
    }

    pub(super) fn rays(&self, n: u32) -> CosineRays<'_, 's> {
        CosineRays {
            mesh: &self.mesh,
            carrier: &self.carrier,
            seed: 1,
            n,
        }
    }

    /// Patches whose fronts do this.
    pub(super) fn with_fronts(&self, fronts: &[Front]) -> Vec<Patch> {
        let patch = |(node, front): (&u32, &Front)| {
            let area = self.mesh.nodes[*node as usize].area;
            let front = PatchSide {
                reflectance: Rgb::splat(front.rho),
                source: Rgb::splat(front.source),
                ..PatchSide::default()
            };
            Patch {
                area,
                weight: area,
                sides: [front, PatchSide::default()],
            }
        };
        self.mesh.patches.iter().zip(fronts).map(patch).collect()
    }

    pub(super) fn all_rows(
        &self,
        factors: &dyn FormFactors,
        patches: &[Patch],
        context: &RenderContext<'_>,
    ) -> Vec<Row> {
        gathered_rows(factors, patches, &self.mesh, context)
    }
}

fn of_fronts(solved: &Solved, steps: u32) -> Fronts {
    let fronts = |light: &[Rgb]| light.iter().step_by(2).map(|light| light.g).collect();
    Fronts {
        irradiance: fronts(&solved.irradiance),
        radiosity: fronts(&solved.radiosity),
        residual: solved.residual,
        is_converged: solved.is_converged,
        steps,
    }
}
