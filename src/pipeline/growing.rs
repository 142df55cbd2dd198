//! The stages of the language: text → checked model → grown graph → shapes.

use super::audience::Audience;
use super::budget;
use super::failure::Failure;
use super::history::History;
use super::inputs::class_name;
use super::light_models::SceneLight;
use super::sources::{Sources, placeless};
use super::studio::Run;
use crate::check::SourceModel;
use crate::check::model::Model;
use crate::diag::{Diagnostic, Diagnostics};
use crate::eval;
use crate::eval::files::ModelFiles;
use crate::growth::{Growth, GrowthOptions};
use crate::integrator::CancelToken;
use crate::interpret::{self, DecodedPictures, Organs, Purpose, Sensor, Summary};
use crate::options::{Options, Origin};
use crate::scene::SceneError;
use crate::scene::description::SceneDescription;
use serde::Serialize;
use std::collections::{BTreeMap, BTreeSet};
use std::path::{Path, PathBuf};
use std::sync::Arc;

/// Memory that a typical organ takes in the graph, in bytes.
const BYTES_PER_MODULE: u64 = 64;

/// A grown model as geometry.
#[derive(Debug)]
pub struct Drawn {
    /// Its shapes, materials and lights.
    pub scene: SceneDescription,
    /// Which node each organ number stands for.
    pub organs: Arc<Organs>,
    /// What surroundings depend on.
    pub summary: Summary,
    /// What measures light; none in drawings for pictures.
    pub sensors: Vec<Sensor>,
    /// The plant that each organ belongs to; none in drawings for pictures.
    pub plants: Vec<u32>,
}

impl Drawn {
    /// A copy.
    ///
    /// # Errors
    /// If it was stopped.
    pub(super) fn copied(&self, cancel: &CancelToken) -> Result<Self, Failure> {
        let scene = self.scene.copied_unless(&|| cancel.is_cancelled());
        Ok(Self {
            scene: scene.ok_or(Failure::Stopped)?,
            organs: self.organs.clone(),
            summary: self.summary,
            sensors: self.sensors.clone(),
            plants: self.plants.clone(),
        })
    }
}

/// What `derive --json` writes.
#[derive(Debug, Serialize)]
pub struct Census {
    step: u64,
    modules: BTreeMap<String, usize>,
    total: usize,
    seconds: f64,
    seed: i64,
    hash: String,
}

/// Reads and checks the texts of a model.
pub fn check(sources: &Sources) -> (Model, Diagnostics) {
    let mut found = Diagnostics::default();
    let files: Vec<SourceModel> = sources
        .models
        .iter()
        .filter_map(|&id| Some((id, sources.map.file(id)?)))
        .map(|(id, file)| {
            let (ast, more) = crate::syntax::parse(id, &file.text);
            found.append(more);
            SourceModel {
                name: class_name(Path::new(&*file.name)),
                ast,
            }
        })
        .collect();
    if found.has_errors() {
        // What the checker would say of half a tree misleads.
        return (Model::default(), found);
    }
    let (model, more) = crate::check::check(&files);
    found.append(more);
    hint_at_files(sources, &mut found);
    if !found.has_errors() && model.init.is_none() && model.entries.is_empty() {
        let names: Vec<String> = sources
            .map
            .files()
            .iter()
            .take(files.len())
            .map(|f| format!("`{}`", f.name))
            .collect();
        let message = format!(
            "{} has neither `init` nor a method to step",
            names.join(", ")
        );
        let hint = "begin with `protected void init() [ Axiom ==> …; ]`";
        // What else is questionable about nothing is not news.
        found = placeless("empty-model", message).hint(hint).into();
    }
    (model, found)
}

/// Tells what of the unknown may stand in files that are missing or not read.
fn hint_at_files(sources: &Sources, found: &mut Diagnostics) {
    let mut told = BTreeSet::new();
    let unknown = found.iter_mut().filter(|d| d.slug.starts_with("unknown-"));
    for fault in unknown {
        let means = |path: &&PathBuf| fault.message.contains(&format!("`{}`", class_name(path)));
        if let Some(path) = sources.unread.iter().find(means) {
            let (file, class) = (path.display(), class_name(path));
            fault.hints.push(if path.extension().is_some_and(|e| e == "rgg") {
                format!("`{file}` is not read: `import static {class}.*;` makes it part of the model")
            } else {
                format!("`{file}` is not read: write what is used of it in a `.rgg` file")
            });
            continue;
        }
        let Some(file) = fault.primary.as_ref().map(|label| label.span.file) else {
            continue;
        };
        let by = sources.map.file(file).map_or("", |file| &*file.name);
        let all = sources.missing.iter().enumerate();
        for (number, missing) in all.filter(|(_, m)| m.by.display().to_string() == by) {
            if told.insert(number) {
                fault.hints.push(missing.to_string());
            }
        }
    }
}

/// Grows a model by the steps that the options ask for, within `memory` bytes; from the last of them that `history` knows on.
/// Also tells how many it knew.
///
/// # Errors
/// What goes wrong in the model, or that it was stopped.
pub(super) fn grow(
    run: &Run,
    files: Box<dyn ModelFiles>,
    memory: u64,
    audience: &Arc<dyn Audience>,
    cancel: &CancelToken,
    mut history: Option<&mut History>,
) -> Result<(Growth, u32), Failure> {
    let blame = |fault: Box<Diagnostic>| blame_growth(run, memory, cancel, *fault);
    let notebook = history.as_ref().map(|history| history.notebook());
    let mut growth = seed(run, memory, (audience, notebook), cancel).map_err(blame)?;
    growth.set_files(files);
    let n_steps = steps(&run.options, &growth);
    let known = match &mut history {
        Some(history) => history
            .resume(&mut growth, n_steps, &**audience)
            .map_err(blame)?,
        None => None,
    };
    if known.is_none() {
        growth.init().map_err(blame)?;
        if let Some(history) = &mut history {
            history.note(&mut growth, run, n_steps == 0);
        }
    }
    let first = known.unwrap_or(0);
    for step in first..n_steps {
        if cancel.is_cancelled() {
            return Err(Failure::Stopped);
        }
        growth.step().map_err(blame)?;
        if let Some(history) = &mut history {
            history.note(&mut growth, run, step + 1 == n_steps);
        }
        audience.progress(u64::from(step) + 1, u64::from(n_steps));
    }
    Ok((growth, first))
}

/// A model before `init`, within `memory` bytes, that prints to an audience and a notebook.
fn seed(
    run: &Run,
    memory: u64,
    (audience, notebook): (&Arc<dyn Audience>, Option<impl Fn(&str) + Send + 'static>),
    cancel: &CancelToken,
) -> Result<Growth, Box<Diagnostic>> {
    let limits = eval::Limits::default();
    let most = run.options.max_modules.value.get();
    let limits = eval::Limits {
        nodes: most.min(memory / BYTES_PER_MODULE),
        memory: limits.memory.min(memory),
        ..limits
    };
    let options = GrowthOptions {
        seed: run.options.seed.value,
        limits,
        entry: run.options.entry.value.clone(),
    };
    let listener = audience.clone();
    let output = Box::new(move |text: &str| {
        listener.printed(text);
        notebook.iter().for_each(|notebook| notebook(text));
    });
    let token = cancel.clone();
    let stop = Box::new(move || token.is_cancelled());
    let mut growth = Growth::new(&run.model, options, output, stop)?;
    growth.set_light_solver(Box::new(SceneLight {
        memory,
        body_nodes: most,
        cancel: cancel.clone(),
        audience: audience.clone(),
        pictures: DecodedPictures::default(),
    }));
    Ok(growth)
}

/// Grows a model by one more step.
///
/// # Errors
/// As [`grow`].
pub fn step(
    run: &Run,
    memory: u64,
    growth: &mut Growth,
    cancel: &CancelToken,
) -> Result<(), Failure> {
    let stepped = growth.step();
    stepped.map_err(|fault| blame_growth(run, memory, cancel, *fault))
}

/// What a fault of the grown model means to the user.
fn blame_growth(run: &Run, memory: u64, cancel: &CancelToken, mut fault: Diagnostic) -> Failure {
    if cancel.is_cancelled() {
        return Failure::Stopped;
    }
    let nodes = memory / BYTES_PER_MODULE;
    if fault.slug == "module-limit" && nodes < run.options.max_modules.value.get() {
        fault.message = format!(
            "the model grows beyond {nodes} modules, which is all that {} of memory can hold",
            budget::readable(memory)
        );
        fault.hints = vec![
            "does a rule multiply without end? `--max-memory` allows more, if the machine has it"
                .to_owned(),
        ];
    }
    Failure::model(&run.sources.map, fault)
}

/// How many steps to make. A model that has no step method is complete after `init`, unless the user asked for steps.
fn steps(options: &Options, growth: &Growth) -> u32 {
    let is_wanted =
        options.steps.origin != Origin::Default || options.entry.origin != Origin::Default;
    let has_entry = growth.entries().any(|name| name == options.entry.value);
    if has_entry || is_wanted {
        options.steps.value
    } else {
        0
    }
}

/// Turns a grown graph, for this purpose, into geometry of at most `memory` bytes, bodies of at most `--max-modules` nodes; also what is questionable about it.
///
/// # Errors
/// If a part of the model cannot be drawn.
pub fn draw(
    run: &Run,
    memory: u64,
    growth: &mut Growth,
    purpose: Purpose,
    cancel: &CancelToken,
) -> Result<(Drawn, Diagnostics), Failure> {
    let limits = interpret::Limits {
        memory,
        body_nodes: run.options.max_modules.value.get(),
        hidden: run.options.hide_layers.value,
        purpose,
        ..interpret::Limits::default()
    };
    let drawn: Result<_, interpret::Failure> = growth.drawing(|sketch| {
        let drawn = interpret::interpret(sketch, limits)?;
        let plants = match purpose {
            Purpose::LightModel => drawn.organs.plants(sketch.graph()),
            Purpose::Picture => vec![],
        };
        Ok((drawn, plants))
    });
    match drawn {
        Ok((drawn, plants)) => {
            let organs = Arc::new(drawn.organs);
            Ok((
                Drawn {
                    scene: drawn.scene,
                    organs,
                    summary: drawn.summary,
                    sensors: drawn.sensors,
                    plants,
                },
                drawn.warnings,
            ))
        }
        Err(fault) => Err(blame_growth(run, memory, cancel, *fault)),
    }
}

/// Blames the model for geometry that cannot be a scene.
pub fn blame(run: &Run, organs: &Organs, error: &SceneError) -> Failure {
    Failure::model(&run.sources.map, interpret::explain(error, organs))
}

/// What `derive --json` writes of a growth that took so many seconds.
pub fn census(growth: &Growth, seed: i64, seconds: f64) -> Census {
    Census {
        step: growth.steps(),
        modules: growth.counts().into_iter().collect(),
        total: growth.total(),
        seconds,
        seed,
        hash: format!("{:016x}", growth.hash()),
    }
}
