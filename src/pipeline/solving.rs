//! The stage between scene and view: the light that all cameras share, kept, read or solved.

use super::audience::Audience;
use super::budget;
use super::content_hash::ContentHash;
use super::failure::Failure;
use super::report::{Phase, SolutionFacts, SolutionOrigin};
use super::solution_file::{self, Basis};
use super::store::SolutionTarget;
use super::studio::{Keep, Run, Studio};
use super::viewing::Viewing;
use super::world::{Entry, World};
use crate::diag::{Diagnostic, Diagnostics, SourceMap, Span};
use crate::integrator::Solution;
use crate::integrator::photon_map::{CAUSTIC_PHOTONS, Coverage, ENOUGH, PhotonSolution};
use crate::options::value::Renderer;
use crate::options::{Options, Stage};
use crate::scene::Scene;
use std::path::{Path, PathBuf};
use std::sync::Arc;

/// Where the light that all cameras share is read from and written to.
#[derive(Clone, Debug, Default)]
pub struct SolutionFiles {
    /// Read from here instead of solved.
    pub read: Option<PathBuf>,
    /// Written here.
    pub save: Option<SolutionTarget>,
}

impl SolutionFiles {
    /// The files that the user names, if the method of `options` has anything to write into them.
    ///
    /// # Errors
    /// If it has not.
    pub fn check(&self, options: &Options) -> Result<(), Failure> {
        let has_solution = match options.renderer.value {
            Renderer::Path | Renderer::Raytracer => false,
            Renderer::Photon | Renderer::Radiosity => true,
        };
        if has_solution || (self.read.is_none() && self.save.is_none()) {
            return Ok(());
        }
        Err(Failure::Usage(
            "`--solution` and `--save-solution` are for light that is solved once for all cameras: that of \
             `--renderer photon` and `--renderer radiosity`"
                .into(),
        ))
    }
}

/// The light that all cameras share.
pub struct Solved {
    /// The light.
    pub solution: Solution,
    /// Where it came from.
    pub facts: SolutionFacts,
    /// What it lacks, if it was solved for this: not told yet.
    pub warnings: Vec<Diagnostics>,
}

impl Solved {
    /// Tells people what it lacks.
    pub fn warn(&self, audience: &dyn Audience, sources: &SourceMap) {
        for warning in &self.warnings {
            audience.warned(sources, warning);
        }
    }
}

impl Studio<'_> {
    /// The light of a scene that [`build`](Self::build) made for the same run: read from the file that the user names, kept from the
    /// run before, or solved. Written where the user wants it.
    ///
    /// # Errors
    /// If the file cannot be read, is of something else or is damaged; if the light cannot be solved, or not be written.
    pub fn solve(
        &mut self,
        run: &Run,
        scene: &Arc<Scene>,
        viewing: &Viewing<'_>,
    ) -> Result<Solved, Failure> {
        self.solve_showing(run, scene, viewing, &mut |_| {})
    }

    /// The same; `early` is told when there is something to see while it is solved, and may ask for it.
    ///
    /// # Errors
    /// As [`solve`](Self::solve).
    pub fn solve_showing(
        &mut self,
        run: &Run,
        scene: &Arc<Scene>,
        viewing: &Viewing<'_>,
        early: &mut dyn FnMut(&dyn Fn() -> Solution),
    ) -> Result<Solved, Failure> {
        let world = self.world;
        let files = self.solution_files.clone();
        let basis = if files.read.is_some() || files.save.is_some() {
            let panorama = self.panorama(run)?;
            let sky = ContentHash::of(panorama.as_ref().map(|(_, file)| &file[..]));
            Some(Basis::new(run, scene, sky))
        } else {
            None
        };
        let (solution, origin) = match (&files.read, &basis) {
            (Some(path), Some(basis)) => {
                let read = || read(world, path, basis, viewing);
                let solution = self.seconds.time(world, Phase::Read, read)?;
                (solution, SolutionOrigin::Read)
            }
            _ => self.kept_or_solved(run, scene, viewing, early)?,
        };
        let warnings = match origin {
            SolutionOrigin::Made => lacks(&solution, viewing),
            SolutionOrigin::Kept | SolutionOrigin::Read => Vec::new(),
        };
        if let (Some(target), Some(basis), Some(content)) =
            (&files.save, &basis, solution.to_bytes())
        {
            self.seconds.time(world, Phase::Write, || {
                target.write(world, &solution_file::encode(basis, &content)?)
            })?;
        }
        let facts = match &solution {
            Solution::Nothing => SolutionFacts::default(),
            Solution::Photons(_) => SolutionFacts {
                origin: Some(origin),
                photons: solution.photons(),
                ..SolutionFacts::default()
            },
            Solution::Radiosity(solved) => SolutionFacts {
                origin: Some(origin),
                patches: Some(solved.patches),
                residual: Some(solved.residual),
                ..SolutionFacts::default()
            },
        };
        Ok(Solved {
            solution,
            facts,
            warnings,
        })
    }

    fn kept_or_solved(
        &mut self,
        run: &Run,
        scene: &Arc<Scene>,
        viewing: &Viewing<'_>,
        early: &mut dyn FnMut(&dyn Fn() -> Solution),
    ) -> Result<(Solution, SolutionOrigin), Failure> {
        let known = self.scene.as_ref();
        let known = known.filter(|(_, known)| Arc::ptr_eq(known, scene));
        let key = known.map(|(key, _)| key.with(&run.options.fingerprint(Stage::Solution)));
        if let (Some((known, solution)), Some(key)) = (&self.solution, key)
            && *known == key
        {
            return Ok((solution.clone(), SolutionOrigin::Kept));
        }
        // Its memory first, then that of the new one.
        self.solution = None;
        self.work.solutions += 1;
        let world = self.world;
        let solution = self
            .seconds
            .time(world, Phase::Prepare, || viewing.solve(scene, early))?;
        if self.keep == Keep::All {
            self.solution = key.map(|key| (key, solution.clone()));
        }
        Ok((solution, SolutionOrigin::Made))
    }
}

/// What light that was just solved lacks.
fn lacks(solution: &Solution, viewing: &Viewing<'_>) -> Vec<Diagnostics> {
    match solution {
        Solution::Nothing => Vec::new(),
        Solution::Photons(solved) => too_few(solved, viewing.options),
        Solution::Radiosity(solved) => {
            let memory = || budget::readable(budget::memory(viewing.world, viewing.options));
            let unfinished = (!solved.is_converged).then(|| unfinished(solved.residual));
            let coarser = (!solved.is_split).then(|| coarser(solved.patches, &memory()));
            unfinished.into_iter().chain(coarser).collect()
        }
    }
}

/// Tells that a solver gave up while this part of all light was still to come.
fn unfinished(residual: f64) -> Diagnostics {
    let text = format!(
        "radiosity did not converge: {:.2} % of all light was still to be sent when the solver gave up",
        100.0 * residual
    );
    let hint = "surfaces that lose no light (white on all sides of a closed room) have no solution: make them darker";
    warned("not-converged", text, hint)
}

/// Tells that patches could not be split as far as was wanted.
fn coarser(patches: u64, memory: &str) -> Diagnostics {
    let text = format!(
        "radiosity is coarser than was wanted: there is no memory for more elements of its {patches} patches than {memory} hold"
    );
    let hint = "use more `--max-memory`, a larger `--subdivision-threshold` or a smaller `--subdivision-depth`";
    warned("coarser", text, hint)
}

/// Tells which sources, and which mirrors and glass, so few photons stand for that their light may be missing.
fn too_few(solved: &PhotonSolution, options: &Options) -> Vec<Diagnostics> {
    let caustic = options
        .caustic_photons
        .value
        .map_or(CAUSTIC_PHOTONS, |n| n.0);
    let kinds = [
        (
            solved.sources,
            ("light sources that sent", "their light"),
            ("global-photons", options.global_photons.value.0),
        ),
        (
            solved.specular,
            ("mirrors and glass that were met by", "their caustics"),
            ("caustic-photons", caustic),
        ),
    ];
    let warning = |(coverage, (which, what), (key, n)): (Option<Coverage>, _, (_, u64))| {
        let Coverage { all, few, fewest } = coverage.filter(|found| found.few > 0)?;
        let text = format!(
            "{which} fewer than {ENOUGH} photons: {few} of {all} (the least: {fewest}); {what} may be missing or in spots, \
             and no estimate of the error sees that"
        );
        // As many as give the last one enough, if that can be told from what it has.
        let hint = match ENOUGH.checked_div(fewest) {
            Some(times) => format!("use `--{key} {}`", n.saturating_mul(times + 1)),
            None => format!("use many more `--{key}`"),
        };
        Some(warned("few-photons", text, hint))
    };
    kinds.into_iter().filter_map(warning).collect()
}

/// A single warning.
fn warned(code: &'static str, text: String, hint: impl Into<String>) -> Diagnostics {
    let mut found = Diagnostics::default();
    found.push(Diagnostic {
        primary: None,
        ..Diagnostic::warning(code, Span::default(), text).hint(hint)
    });
    found
}

/// The solution in a file.
fn read(
    world: &dyn World,
    path: &Path,
    basis: &Basis,
    viewing: &Viewing<'_>,
) -> Result<Solution, Failure> {
    let refused = |why: &dyn std::fmt::Display| {
        let path = path.display();
        Failure::World(format!("cannot use `{path}` as a solution: {why}"))
    };
    if matches!(world.entry(path), Entry::Folder | Entry::Device) {
        return Err(refused(&"it is not an ordinary file"));
    }
    // The file and what is in it are in memory together.
    let most = budget::memory(world, viewing.options) / 2;
    let file = world
        .read_up_to(path, most)
        .map_err(|error| Failure::file("read", path, &error))?;
    let content = solution_file::decode(&file, basis).map_err(|error| refused(&error))?;
    viewing
        .restore(content)
        .map_err(|error| refused(&solution_file::Refused::Damaged(error.0)))
}
