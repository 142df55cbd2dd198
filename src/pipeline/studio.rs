//! The stages of a run, each kept for the next run that has the same inputs.

use super::ages;
use super::audience::Audience;
use super::budget;
use super::charts;
use super::constants::Change;
use super::content_hash::ContentHash;
use super::failure::Failure;
use super::growing::{self, Drawn};
use super::history::History;
use super::inputs::Inputs;
use super::project_files::{self, Access, ProjectFiles};
use super::reads::{Reader, Reads};
use super::report::{Phase, PhaseSeconds, Work};
use super::solving::SolutionFiles;
use super::sources::Sources;
use super::surroundings::Outdoors;
use super::world::{World, folder_of};
use crate::check::model::Model;
use crate::diag::Diagnostics;
use crate::growth::Growth;
use crate::integrator::requirements::Requirements;
use crate::integrator::{CancelToken, Solution};
use crate::interpret::{Organs, Purpose};
use crate::light::SkyImage;
use crate::options::surroundings::SkyKind;
use crate::options::{Options, Origin, Stage};
use crate::scene::Scene;
use std::path::{Path, PathBuf};
use std::sync::{Arc, Weak};

/// A model that has been read, with the options that apply to it.
#[derive(Debug)]
pub struct Opened {
    /// Its texts.
    pub sources: Sources,
    /// Its options.
    pub options: Options,
    /// What is wrong with the file beside it.
    found: Diagnostics,
}

/// A model that has been read and checked, with the options that apply to it.
#[derive(Clone, Debug)]
pub struct Run {
    /// Its texts.
    pub sources: Sources,
    /// Its options.
    pub options: Options,
    /// The checked model.
    pub model: Arc<Model>,
    /// What it probably does not mean: warnings.
    pub warnings: Diagnostics,
    /// How much of one more step the model has grown, at least 0 and less than 1.
    pub part: f64,
}

/// Whether stages are kept after the next one is done.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Keep {
    /// Each stage gives its memory back as soon as the next one is done.
    Last,
    /// All stages stay for the next run.
    All,
}

/// Runs one model, perhaps many times, and repeats only what changed.
pub struct Studio<'w> {
    pub(super) world: &'w dyn World,
    pub(super) audience: Arc<dyn Audience>,
    path: PathBuf,
    pub(super) keep: Keep,
    /// What the model may use besides its own folder, and where its charts go.
    pub access: Access,
    /// Constants of the model that are to have other values.
    pub changes: Vec<Change>,
    /// The growth before.
    history: Option<History>,
    drawn: Option<(ContentHash, Drawn)>,
    pub(super) scene: Option<(ContentHash, Arc<Scene>)>,
    /// What the organ numbers of the scene built last stand for.
    pub organs: Option<Arc<Organs>>,
    /// The digest of the shapes of the scene built last.
    shapes: Option<(u64, Weak<Scene>)>,
    /// The light of that scene, with the key of both.
    pub(super) solution: Option<(ContentHash, Solution)>,
    /// Where the light is read from and written to.
    pub solution_files: SolutionFiles,
    /// What was read besides the texts.
    pub reads: Reads,
    /// Time spent since this was last reset.
    pub seconds: PhaseSeconds,
    /// What was done since this was made.
    pub work: Work,
}

impl Run {
    /// Equal for runs that grow the same graph.
    pub fn growth_key(&self) -> ContentHash {
        let key = self
            .sources
            .model_hash
            .with(&self.options.fingerprint(Stage::Growth));
        if self.part > 0.0 {
            key.with(&format!("{:?}", self.part))
        } else {
            key
        }
    }

    /// Equal for runs whose drawn models are the same.
    fn drawing_key(&self) -> ContentHash {
        self.growth_key()
            .with(&self.options.hide_layers.value.to_string())
    }

    /// Equal for runs with the same scene.
    pub fn scene_key(&self) -> ContentHash {
        self.growth_key()
            .with(&self.options.fingerprint(Stage::Scene))
    }

    /// Equal for runs with the same picture, of this version of the program.
    pub fn picture_key(&self) -> ContentHash {
        self.scene_key()
            .with(&self.options.fingerprint(Stage::Solution))
            .with(&self.options.fingerprint(Stage::View))
            .with(env!("CARGO_PKG_VERSION"))
    }

    /// What a picture tells of its making: program, model, seed, and the options that were set.
    pub fn texts(&self) -> Vec<(&'static str, String)> {
        let entries = self.options.entries();
        let set = entries
            .iter()
            .filter(|entry| !matches!(entry.row.stage, Stage::Machine | Stage::Flight))
            .filter(|entry| entry.origin != Origin::Default);
        let options: Vec<String> = set
            .map(|entry| format!("{}={}", entry.row.key, entry.text))
            .collect();
        vec![
            (
                "Software",
                format!("understory {}", env!("CARGO_PKG_VERSION")),
            ),
            ("Model", self.sources.model_hash.to_string()),
            ("Seed", self.options.seed.value.to_string()),
            ("Options", options.join(" ")),
        ]
    }
}

impl<'w> Studio<'w> {
    /// A studio for the model at `path`.
    pub fn new(
        world: &'w dyn World,
        audience: Arc<dyn Audience>,
        path: PathBuf,
        keep: Keep,
    ) -> Self {
        let seconds = PhaseSeconds::default();
        Self {
            world,
            audience,
            path,
            keep,
            access: Access::default(),
            changes: Vec::new(),
            history: None,
            drawn: None,
            scene: None,
            organs: None,
            shapes: None,
            solution: None,
            solution_files: SolutionFiles::default(),
            reads: Reads::default(),
            seconds,
            work: Work::default(),
        }
    }

    /// Reads the model and the file beside it.
    ///
    /// # Errors
    /// If one cannot be read.
    pub fn read(&mut self, flags: &Options) -> Result<Opened, Failure> {
        let (world, path, changes) = (self.world, &self.path, &self.changes);
        self.seconds.time(world, Phase::Read, || {
            let sources = Inputs::find(world, path)?.read_changed(world, changes)?;
            let (options, found) = sources.options(flags);
            Ok(Opened {
                sources,
                options,
                found,
            })
        })
    }

    /// Checks the model.
    ///
    /// # Errors
    /// If anything is wrong with it or the file beside it: all of it.
    pub fn check(&mut self, opened: Opened) -> Result<Run, Failure> {
        let Opened {
            sources,
            options,
            mut found,
        } = opened;
        self.work.checks += 1;
        let (model, more) = self
            .seconds
            .time(self.world, Phase::Read, || growing::check(&sources));
        found.append(more);
        if found.has_errors() {
            return Err(Failure::Model {
                sources: sources.map,
                found,
            });
        }
        if !found.is_empty() {
            self.audience.warned(&sources.map, &found);
        }
        Ok(Run {
            sources,
            options,
            model: Arc::new(model),
            warnings: found,
            part: 0.0,
        })
    }

    /// Grows the model.
    ///
    /// # Errors
    /// If growth fails, exceeds a budget, or was stopped.
    pub fn grow(&mut self, run: &Run, cancel: &CancelToken) -> Result<Growth, Failure> {
        self.audience.begins("growing");
        let memory = budget::memory(self.world, &run.options);
        let audience = &self.audience;
        self.reads.begin(Reader::Growth);
        let files = ProjectFiles::new(self.world, &self.path, &self.access);
        let files = Box::new(files.remembering(&self.reads));
        let (keeps, history, reads) = (self.keep == Keep::All, &mut self.history, &self.reads);
        let grown = self.seconds.time(self.world, Phase::Derive, || {
            *history = keeps.then(|| History::begin(history.take(), run, memory, reads));
            growing::grow(run, files, memory, audience, cancel, history.as_mut())
        });
        self.audience.ends();
        let (grown, n_known) = grown?;
        self.work.growths += 1;
        self.work.steps += grown.steps().saturating_sub(u64::from(n_known));
        self.work.kept_steps += u64::from(n_known);
        self.write_outputs(&grown)?;
        Ok(grown)
    }

    /// Writes what the model has written, and its charts where the user wants them.
    fn write_outputs(&self, growth: &Growth) -> Result<(), Failure> {
        let written = growth.written();
        let written = written.map(|(place, text)| {
            self.reads.wrote(Path::new(place), text.as_bytes());
            (place.to_owned(), text.to_owned())
        });
        project_files::write_all(self.world, written)?;
        let Some(folder) = &self.access.charts else {
            return Ok(());
        };
        for (table, kind) in growth.charts() {
            let path = folder.join(charts::file_name(&table.title));
            let path = path.to_string_lossy();
            let files = [
                (format!("{path}.csv"), charts::csv(&table)),
                (format!("{path}.svg"), charts::svg(&table, kind)),
            ];
            project_files::write_all(self.world, files)?;
        }
        Ok(())
    }

    /// Grows the model and builds its scene, as far as they are not there from the run before.
    ///
    /// # Errors
    /// As [`grow`](Self::grow), or if its geometry cannot be a scene.
    pub fn build(&mut self, run: &Run, cancel: &CancelToken) -> Result<Arc<Scene>, Failure> {
        if !self.reads.are_current(Reader::Growth, self.world) {
            (self.drawn, self.scene) = (None, None);
        }
        let panorama = self.panorama(run)?;
        let content = panorama.as_ref().map(|(_, file)| &file[..]);
        let key = run.scene_key().with(&ContentHash::of(content).to_string());
        if let Some((known, scene)) = &self.scene
            && *known == key
        {
            return Ok(scene.clone());
        }
        self.scene = None;
        self.solution = None;
        let mut drawn = self.draw(run, cancel)?;
        self.audience.begins("building the scene");
        let panorama = panorama
            .map(|(path, file)| decode(&path, &file))
            .transpose()?;
        let outdoors = Outdoors::new(&run.options, drawn.summary.has_light, panorama)?;
        outdoors.complete(&mut drawn.scene, &drawn.summary, &run.options);
        let stop = || cancel.is_cancelled();
        let digest = (self.keep == Keep::All).then(|| drawn.scene.shape_digest_unless(&stop));
        if stop() {
            return Err(Failure::Stopped);
        }
        let alike = self.alike(digest);
        self.work.accels += u64::from(alike.is_none());
        let is_built = alike.is_none();
        let before = self.shapes.as_ref().and_then(|(_, scene)| scene.upgrade());
        let built = self.seconds.time(self.world, Phase::Accel, || match alike {
            Some(alike) => alike.relit(drawn.scene),
            None => Scene::build_like(drawn.scene, before.as_deref(), &stop),
        });
        self.audience.ends();
        if cancel.is_cancelled() {
            return Err(Failure::Stopped);
        }
        let scene = built.map_err(|error| growing::blame(run, &drawn.organs, &error))?;
        self.organs = Some(drawn.organs);
        self.work.scenes += 1;
        if is_built {
            let (n_built, n_kept) = scene.prototypes();
            self.work.prototypes += n_built as u64;
            self.work.kept_prototypes += n_kept as u64;
        }
        let scene = Arc::new(scene);
        self.shapes = digest.map(|digest| (digest, Arc::downgrade(&scene)));
        self.scene = Some((key, scene.clone()));
        Ok(scene)
    }

    /// What the scene built last requires; `None` if there is none.
    #[must_use]
    pub fn requirements(&self, run: &Run) -> Option<Requirements> {
        let (_, scene) = self.scene.as_ref()?;
        Some(Requirements::of(scene, run.options.require.value))
    }

    /// The scene before, if somebody still has it and its shapes are those with this digest.
    fn alike(&self, digest: Option<u64>) -> Option<Arc<Scene>> {
        let (known, scene) = self.shapes.as_ref()?;
        digest
            .filter(|digest| digest == known)
            .and_then(|_| scene.upgrade())
    }

    /// Grows the model and draws it for a light model, with the light and the ground that the options ask for.
    ///
    /// # Errors
    /// As [`grow`](Self::grow), or if it cannot be drawn.
    pub(super) fn draw_for_light(
        &mut self,
        run: &Run,
        cancel: &CancelToken,
    ) -> Result<Drawn, Failure> {
        let panorama = self.panorama(run)?;
        let mut growth = self.grow(run, cancel)?;
        self.audience.begins("drawing");
        let memory = budget::memory(self.world, &run.options);
        let drawn = self.seconds.time(self.world, Phase::Scene, || {
            growing::draw(run, memory, &mut growth, Purpose::LightModel, cancel)
        });
        self.audience.ends();
        let (mut drawn, found) = drawn?;
        if !found.is_empty() {
            self.audience.warned(&run.sources.map, &found);
        }
        let panorama = panorama.map(|(path, file)| decode(&path, &file));
        let has_light = drawn.summary.has_light;
        let outdoors = Outdoors::new(&run.options, has_light, panorama.transpose()?)?;
        outdoors.complete(&mut drawn.scene, &drawn.summary, &run.options);
        Ok(drawn)
    }

    /// The panorama that the options name, as a file. Its path starts at the folder of who wrote it: the file beside the
    /// model, or the user.
    pub(super) fn panorama(&self, run: &Run) -> Result<Option<(PathBuf, Vec<u8>)>, Failure> {
        let SkyKind::Image(path) = &run.options.sky.value else {
            return Ok(None);
        };
        let sidecar = match run.options.sky.origin {
            Origin::Sidecar(span) => run.sources.map.file(span.file),
            Origin::Default | Origin::Preset(_) | Origin::Chosen { .. } | Origin::Flag => None,
        };
        let path = match sidecar {
            Some(file) => folder_of(Path::new(&*file.name)).join(path),
            None => path.clone(),
        };
        let file = self.world.read(&path);
        self.reads.begin(Reader::Scene);
        self.reads
            .record(Reader::Scene, &path, file.as_deref().ok());
        let file = file.map_err(|error| Failure::file("read", &path, &error))?;
        Ok(Some((path, file)))
    }

    /// Grows the model and turns it into geometry. The graph is given back at once: it is large, and what light needs of
    /// it is in the geometry.
    fn draw(&mut self, run: &Run, cancel: &CancelToken) -> Result<Drawn, Failure> {
        let key = run.drawing_key();
        if let Some((known, drawn)) = &self.drawn
            && *known == key
        {
            return drawn.copied(cancel);
        }
        self.drawn = None;
        let mut growth = self.grow(run, cancel)?;
        self.audience.begins("drawing");
        let memory = budget::memory(self.world, &run.options);
        let drawn = self.seconds.time(self.world, Phase::Scene, || {
            if run.part > 0.0 {
                ages::draw_between(run, memory, &mut growth, cancel)
            } else {
                growing::draw(run, memory, &mut growth, Purpose::Picture, cancel)
            }
        });
        self.audience.ends();
        let (drawn, found) = drawn?;
        self.work.drawings += 1;
        if !found.is_empty() {
            self.audience.warned(&run.sources.map, &found);
        }
        if self.keep == Keep::All {
            // Kept first: who stops the copying loses nothing.
            let (_, kept) = self.drawn.insert((key, drawn));
            return kept.copied(cancel);
        }
        Ok(drawn)
    }
}

/// The panorama in a file.
fn decode(path: &Path, file: &[u8]) -> Result<Arc<SkyImage>, Failure> {
    let image = SkyImage::decode(file).map_err(|error| {
        Failure::World(format!("cannot use `{}` as a sky: {error}", path.display()))
    })?;
    Ok(Arc::new(image))
}
