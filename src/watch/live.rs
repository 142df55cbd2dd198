//! The picture that follows the model and the page: a first impression at once, then better ones, then the one that was
//! asked for; and all over again, from the first stage that differs, whenever the files or the wishes of the page do.

use super::command;
use super::early::Early;
use super::pace::Pace;
use super::problems::{self, Problem};
use super::room::{Room, Task};
use super::session::Runner;
use super::showing::{Sight, viewing};
use super::state::{self, Activity, Number};
use super::wish::Wish;
use crate::film::LinearImage;
use crate::integrator::{CancelToken, Solution};
use crate::options::{Options, Section};
use crate::pipeline::audience::Audience;
use crate::pipeline::constants::{self, Change};
use crate::pipeline::content_hash::ContentHash;
use crate::pipeline::failure::Failure;
use crate::pipeline::inputs::Inputs;
use crate::pipeline::report::{Effort, Phase, PhaseSeconds, SolutionFacts};
use crate::pipeline::studio::{Run, Studio};
use crate::pipeline::world::World;
use crate::pipeline::{budget, threads, viewpoint};
use crate::scene::Scene;
use std::panic::{AssertUnwindSafe, catch_unwind};
use std::path::{Path, PathBuf};
use std::sync::Arc;
use std::time::Duration;

/// Where pictures go besides the page, and who hears of them.
pub trait Outlet: Sync {
    /// A round begins because these files changed; none at first.
    fn begins(&self, changed: &[String]);

    /// A picture is as good as it was asked for. Writes it where that is wanted.
    ///
    /// # Errors
    /// If it cannot be written.
    fn finished(
        &self,
        run: &Run,
        studio: &mut Studio<'_>,
        made: &Finished<'_>,
    ) -> Result<(), Failure>;

    /// Something is wrong.
    fn failed(&self, failure: &Failure);

    /// The program itself is wrong.
    fn panicked(&self);
}

/// A picture as good as it was asked for.
#[derive(Debug)]
pub struct Finished<'a> {
    /// What the camera saw, linear.
    pub image: &'a LinearImage,
    /// The factor that it is shown with.
    pub exposure: f64,
    /// What it took.
    pub effort: Effort,
    /// What it lacks without showing it.
    pub warnings: Vec<&'static str>,
    /// The light that all cameras share.
    pub solution: SolutionFacts,
}

/// Makes pictures of one model.
pub struct Live<'s> {
    pub(super) world: &'s dyn World,
    model: PathBuf,
    flags: Options,
    /// Constants that the command line changes.
    given: Vec<Change>,
    pub(super) room: Arc<Room>,
    pub(super) audience: Arc<dyn Audience>,
    pub(super) outlet: &'s dyn Outlet,
    fresh: Box<dyn Fn() -> Studio<'s> + Send + 's>,
    pub(super) studio: Studio<'s>,
    pub(super) pace: Pace,
    /// The model as it was read last in this round, and the constants that it was read with.
    checked: Option<(Vec<Change>, Run)>,
    /// What was shown last.
    last: Option<(Run, Arc<Scene>)>,
    /// The factor that the picture before was shown with, if it suits the next.
    pub(super) exposure: Option<f64>,
    pub(super) is_once: bool,
}

impl<'s> Live<'s> {
    /// Pictures of `model` with these flags, told to these. `fresh` makes a studio with nothing in it.
    pub fn new(
        world: &'s dyn World,
        (model, flags): (&Path, &Options),
        (room, audience): (Arc<Room>, Arc<dyn Audience>),
        outlet: &'s dyn Outlet,
        fresh: impl Fn() -> Studio<'s> + Send + 's,
    ) -> Self {
        let studio = fresh();
        Self {
            world,
            model: model.to_owned(),
            flags: flags.clone(),
            given: Vec::new(),
            room,
            audience,
            outlet,
            fresh: Box::new(fresh),
            studio,
            pace: Pace::default(),
            checked: None,
            last: None,
            exposure: None,
            is_once: false,
        }
    }

    /// Gives constants of the model other values, over which those of the page win.
    pub fn give(&mut self, changes: Vec<Change>) {
        self.given = changes;
    }

    /// Makes the picture once, as if nobody looked.
    ///
    /// # Errors
    /// Whatever goes wrong.
    pub fn once(&mut self, cancel: &CancelToken) -> Result<(), Failure> {
        self.is_once = true;
        let task = Task {
            cancel: cancel.clone(),
            leave: cancel.clone(),
            ..self.room.take(true)
        };
        self.work(&task, cancel)
    }

    /// Does what a wish asks for, and then, from the same solution, what those after it ask for.
    fn work(&mut self, task: &Task, stop: &CancelToken) -> Result<(), Failure> {
        self.studio.seconds = PhaseSeconds::default();
        self.room.tell(|state| state.problems.clear());
        let run = self.checked(&task.wish)?;
        budget::check_picture(self.world, &run.options)?;
        viewpoint::check(&run.sources, &run.options)?;
        threads::pool(&run.options)?.install(|| {
            let scene = self.studio.build(&run, &task.cancel)?;
            self.look_at(run, &scene, task, stop, false)
        })
    }

    /// The checked model with the options of a wish.
    fn checked(&mut self, wish: &Wish) -> Result<Run, Failure> {
        let flags = wish.over(&self.flags);
        let (changes, numbers) = self.possible(wish)?;
        if let Some((known, run)) = &self.checked
            && *known == changes
        {
            let warnings = problems::of_diagnostics(&run.sources.map, &run.warnings);
            self.room.tell(|state| state.problems = warnings);
            return with_options(run, &flags);
        }
        self.audience.begins("reading");
        self.checked = None;
        self.studio.changes.clone_from(&changes);
        let opened = self.studio.read(&flags)?;
        let map = &opened.sources.map;
        let files = map.files().iter().map(|file| PathBuf::from(&*file.name));
        self.room.set_files(files.collect());
        let run = self.studio.check(opened)?;
        // Of a model with errors those that could be read are not all.
        self.room.tell(|state| state.constants = numbers);
        self.checked = Some((changes, run.clone()));
        Ok(run)
    }

    /// The constants that are changed: what the command line says, and over it what the page does, if the model still has
    /// it. And all that the model has.
    fn possible(&self, wish: &Wish) -> Result<(Vec<Change>, Vec<Number>), Failure> {
        if let Some((known, _)) = &self.checked
            && wish.constants.is_empty()
            && *known == self.given
        {
            return Ok((known.clone(), Vec::new()));
        }
        let sources =
            Inputs::find(self.world, &self.model)?.read_changed(self.world, &self.given)?;
        let found = constants::find(&sources.map, &sources.models);
        let mut wanted = wish.changes();
        wanted.retain(|change| found.iter().any(|constant| constant.id() == change.name));
        let is_free = |given: &&Change| {
            let mut wanted = wanted.iter();
            let means = |constant: &constants::Constant, name| constant.id() == name;
            !wanted.any(|change| {
                found
                    .iter()
                    .any(|c| c.is_called(&given.name) && means(c, change.name.as_str()))
            })
        };
        let given: Vec<Change> = self.given.iter().filter(is_free).cloned().collect();
        let numbers = found.iter().map(Number::from).collect();
        Ok((given.into_iter().chain(wanted).collect(), numbers))
    }

    /// Solves a scene and shows it, for as long as wishes ask for the same solution.
    fn look_at(
        &mut self,
        mut run: Run,
        scene: &Arc<Scene>,
        first: &Task,
        stop: &CancelToken,
        is_stale: bool,
    ) -> Result<(), Failure> {
        let solution = solution_key(&run);
        let audience = self.audience.clone();
        let viewing = viewing(self.world, &*audience, &run, &first.cancel);
        audience.begins("preparing");
        let view = viewpoint::of_scene(&run.options, scene);
        let room = self.room.clone();
        let mut early = Early {
            viewing,
            scene,
            camera: viewpoint::camera(&run.sources, &run.options, &view)?,
            room: &room,
            next: Duration::ZERO,
        };
        let is_once = self.is_once;
        let mut show = |so_far: &dyn Fn() -> Solution| {
            if !is_once {
                early.show(so_far);
            }
        };
        let solved = self
            .studio
            .solve_showing(&run, scene, &viewing, &mut show)?;
        solved.warn(viewing.audience, &run.sources.map);
        let start = self.world.now();
        let prepared = viewing.prepare(scene, &solved.solution)?;
        let time = self.world.now().saturating_sub(start);
        self.studio.seconds.add(Phase::Prepare, time);
        let warnings = viewing.shortcomings(scene);
        let lacks = warnings.iter().map(|text| Problem {
            is_warning: true,
            message: (*text).to_owned(),
            ..Problem::default()
        });
        self.room.tell(|state| state.problems.extend(lacks));
        self.exposure = None;
        if !is_stale {
            self.last = Some((run.clone(), scene.clone()));
        }
        let mut task = first.clone();
        loop {
            if !self.is_once {
                let next = self.room.take(false);
                if stop.is_cancelled() || next.wish.constants != first.wish.constants {
                    return Ok(());
                }
                run = with_options(&run, &next.wish.over(&self.flags))?;
                if solution_key(&run) != solution {
                    return Ok(());
                }
                if next.number != first.number && next.number != task.number {
                    self.studio.seconds = PhaseSeconds::default();
                }
                task = next;
            }
            let view = viewpoint::of_scene(&run.options, scene);
            let camera = viewpoint::camera(&run.sources, &run.options, &view)?;
            let options = state::values(&run.options);
            let command = command::render(&self.model, &run.options, &self.studio.changes);
            self.room.tell(|state| {
                state.view = Some(view.into());
                state.options = options;
                state.command = command;
            });
            let sight = Sight {
                run: &run,
                scene,
                prepared: &prepared,
                camera,
                task: &task,
                warnings: warnings.clone(),
                solution: solved.facts,
                is_stale,
            };
            match self.show(&sight) {
                Err(Failure::Stopped) if !self.is_once => {}
                Ok(()) if !self.is_once => self.room.wait(task.number, stop),
                other => return other,
            }
            if stop.is_cancelled() {
                return Ok(());
            }
        }
    }

    /// Tells what is wrong; the last good picture stays, and can be looked at from elsewhere.
    fn fail(&mut self, failure: &Failure) {
        self.audience.ends();
        self.outlet.failed(failure);
        let problems = problems::of_failure(failure);
        let (seconds, work) = (self.studio.seconds.clone(), self.studio.work);
        self.room.tell(|state| {
            state.problems = problems;
            state.activity = Activity::Failed;
            state.progress = None;
            state.seconds = seconds;
            state.work = work;
        });
    }

    /// Lets go of the scene that was shown last if there may be no memory for another one beside it.
    fn make_room(&mut self) {
        let memory = self.world.peak_memory().zip(self.world.free_memory());
        if memory.is_some_and(|(used, free)| used > free) {
            self.last = None;
        }
    }

    /// Waits for a wish after a failure. One for another view is granted from the last good scene.
    fn wait_after(&mut self, task: &Task, stop: &CancelToken) {
        self.room.wait(task.number, stop);
        let next = self.room.take(true);
        if stop.is_cancelled() || !next.wish.differs_in_view_only(&task.wish) {
            return;
        }
        let Some((run, scene)) = self.last.clone() else {
            return;
        };
        let shown = with_options(&run, &next.wish.over(&self.flags)).and_then(|run| {
            let pool = threads::pool(&run.options)?;
            pool.install(|| self.look_at(run, &scene, &next, stop, true))
        });
        // The failure that is shown already matters more.
        drop(shown);
    }
}

impl Runner for Live<'_> {
    fn run(&mut self, changed: &[String], stop: &CancelToken) {
        self.checked = None;
        self.make_room();
        self.outlet.begins(changed);
        self.room.tell(|state| {
            state.round += 1;
            state.changed = changed.to_vec();
            state.activity = Activity::default();
        });
        while !stop.is_cancelled() {
            let task = self.room.take(true);
            if stop.is_cancelled() {
                return;
            }
            // The page is answered even after a fault of the program.
            match catch_unwind(AssertUnwindSafe(|| self.work(&task, stop))) {
                // A newer wish, or the files, made it useless.
                Ok(Ok(()) | Err(Failure::Stopped)) => {}
                Err(_) => {
                    self.recover();
                    self.room.wait(task.number, stop);
                }
                Ok(Err(failure)) => {
                    self.fail(&failure);
                    self.wait_after(&task, stop);
                }
            }
        }
    }

    fn recover(&mut self) {
        self.studio = (self.fresh)();
        (self.checked, self.last) = (None, None);
        self.audience.ends();
        self.outlet.panicked();
        let problem = Problem {
            message: "understory itself failed on this model; that is a fault of the program, please report it".to_owned(),
            ..Problem::default()
        };
        self.room.tell(|state| {
            state.problems = vec![problem];
            state.activity = Activity::Failed;
        });
    }
}

/// The same model with other options of the command line.
fn with_options(run: &Run, flags: &Options) -> Result<Run, Failure> {
    let (options, found) = run.sources.options(flags);
    if found.has_errors() {
        let sources = run.sources.map.clone();
        return Err(Failure::Model { sources, found });
    }
    Ok(Run {
        options,
        ..run.clone()
    })
}

/// Equal for runs with the same scene and the same view-independent solution of it.
fn solution_key(run: &Run) -> ContentHash {
    let entries = run.options.entries();
    let render = entries.iter().filter(|entry| {
        let picture_only = [
            "size",
            "samples",
            "supersampling",
            "exposure",
            "time",
            "quality",
        ];
        entry.row.section == Section::Render && !picture_only.contains(&entry.row.key)
    });
    let text: Vec<String> = render
        .map(|entry| format!("{}={}", entry.row.key, entry.canonical()))
        .collect();
    run.scene_key().with(&text.join("\n"))
}
