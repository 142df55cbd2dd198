//! The command that runs again whenever an input changes, and serves the page.

use super::args::WatchArgs;
use super::commands::summary;
use super::outcome;
use super::shell::Shell;
use crate::options::{Command, Options};
use crate::pipeline::audience::Audience;
use crate::pipeline::constants::{self, Change};
use crate::pipeline::exposing;
use crate::pipeline::failure::Failure;
use crate::pipeline::inputs::Inputs;
use crate::pipeline::making::Made;
use crate::pipeline::reads::Reads;
use crate::pipeline::report::Phase;
use crate::pipeline::store::{JsonTarget, PictureTarget};
use crate::pipeline::studio::{Keep, Run, Studio};
use crate::pipeline::world::{Machine, World};
use crate::watch::editor::Editor;
use crate::watch::files::Follower;
use crate::watch::live::{Finished, Live, Outlet};
use crate::watch::page::{self, Service};
use crate::watch::problems;
use crate::watch::room::Room;
use crate::watch::telling::Both;
use crate::watch::wish::Wish;
use crate::watch::{Event, Watched, watch as attend};
use std::path::{Path, PathBuf};
use std::sync::Arc;
use std::sync::mpsc::{Receiver, Sender};
use std::thread::JoinHandle;

/// `watch`: makes the picture, shows it on a page, and makes it again whenever an input changes, until Ctrl-C.
pub(super) fn watch(
    shell: &Shell,
    args: &WatchArgs,
    sender: Sender<Event>,
    events: Receiver<Event>,
) -> Result<(), Failure> {
    let model = args.model.model.as_path();
    if args.manners.explain_options {
        return shell.explain(model, Command::Watch);
    }
    let editor = editor(args)?;
    let output = args.output.as_deref();
    let outlet = Pictures {
        shell,
        target: output
            .map(|output| PictureTarget::new(&shell.world, output))
            .transpose()?,
        report: shell.report_target(args.report.as_deref())?,
        room: Arc::new(Room::new(name(model), editor.is_some())),
    };
    let access = args.model.access()?;
    let audience: Arc<dyn Audience> =
        Arc::new(Both::new(shell.terminal.clone(), outlet.room.clone()));
    let listener = audience.clone();
    let reads = Reads::default();
    let shared = reads.clone();
    let fresh = move || {
        let path = model.to_owned();
        let mut studio = Studio::new(&shell.world, listener.clone(), path, Keep::All);
        studio.access = access.clone();
        studio.reads = shared.clone();
        studio
    };
    let told = (outlet.room.clone(), audience);
    let mut live = Live::new(&shell.world, (model, &shell.flags), told, &outlet, fresh);
    live.give(args.model.changes()?);
    if args.once {
        return live.once(&shell.cancel);
    }
    let follower = Follower::new(sender.clone());
    if let Err(error) = &follower {
        let why = format!("no file events here ({error}); looking once a second instead");
        shell.terminal.note(&why);
    }
    let desk = Desk {
        flags: shell.flags.clone(),
        model: model.to_owned(),
        editor,
    };
    let server = serve(shell, args, outlet.room.clone(), desk)?;
    let interrupt = || outlet.room.interrupt();
    let watched = Watched {
        world: &shell.world,
        model,
        reads,
        follower: follower.ok(),
        interrupt: &interrupt,
    };
    attend(watched, &mut live, sender, events);
    outlet.room.close();
    if let Some(server) = server {
        // A server that failed has said so.
        let _ = server.join();
    }
    Ok(())
}

/// The model's name without its folder.
fn name(model: &Path) -> String {
    let name = model.file_name().unwrap_or(model.as_os_str());
    name.to_string_lossy().into_owned()
}

fn editor(args: &WatchArgs) -> Result<Option<Editor>, Failure> {
    match &args.editor {
        Some(command) => match Editor::parse(command) {
            Ok(editor) => Ok(Some(editor)),
            Err(why) => Err(Failure::Usage(format!("--editor: {why}"))),
        },
        None => Ok(Editor::of_environment()),
    }
}

/// Starts the server and says where it is. Without any port there is no page, which matters less if there is a picture.
fn serve(
    shell: &Shell,
    args: &WatchArgs,
    room: Arc<Room>,
    desk: Desk,
) -> Result<Option<JoinHandle<()>>, Failure> {
    let bound = page::bind(args.port).and_then(|listener| {
        let port = listener.local_addr()?.port();
        Ok((listener, port))
    });
    let (listener, port) = match bound {
        Ok(bound) => bound,
        Err(error) if args.output.is_some() => {
            shell
                .terminal
                .note(&format!("no page: there is no free port ({error})"));
            return Ok(None);
        }
        Err(error) => return Err(Failure::World(format!("there is no free port: {error}"))),
    };
    let why = if port == args.port || args.port == 0 {
        String::new()
    } else {
        format!(" (port {} is taken)", args.port)
    };
    shell.terminal.note(&format!(
        "watching {}: open http://localhost:{port}/{why}",
        room.name()
    ));
    let terminal = shell.terminal.clone();
    let server = std::thread::spawn(move || {
        if let Err(error) = page::serve(listener, room, Arc::new(desk)) {
            terminal.note(&format!("the page is gone: {error}"));
        }
    });
    Ok(Some(server))
}

/// What the page may ask for.
struct Desk {
    flags: Options,
    model: PathBuf,
    editor: Option<Editor>,
}

impl Service for Desk {
    fn check(&self, wish: &Wish) -> Result<(), String> {
        wish.check(&self.flags)
    }

    fn write(&self, wish: &Wish) -> Result<String, String> {
        let hide = |error: Failure| {
            let problems = problems::of_failure(&error);
            problems
                .first()
                .map_or(String::new(), |problem| problem.message.clone())
        };
        let world = Machine::new();
        let inputs = Inputs::find(&world, &self.model).map_err(hide)?;
        let sources = inputs.read(&world).map_err(hide)?;
        let found = constants::find(&sources.map, &sources.models);
        let mut written = Vec::new();
        for &id in &sources.models {
            let Some(file) = sources.map.file(id) else {
                continue;
            };
            let stands_here = |change: &Change| {
                found
                    .iter()
                    .any(|c| c.span.file == id && c.id() == change.name)
            };
            let mut changes = wish.changes();
            changes.retain(stands_here);
            if changes.is_empty() {
                continue;
            }
            let text = constants::rewritten(&file.name, &file.text, &changes)?;
            let path = Path::new(&*file.name);
            let name = problems::last_part(&file.name);
            world
                .replace(path, text.as_bytes())
                .map_err(|error| format!("cannot write `{name}`: {error}"))?;
            written.push(name.to_owned());
        }
        if written.is_empty() {
            return Err("nothing to write: no constant is changed".to_owned());
        }
        Ok(written.join(", "))
    }

    fn open(&self, file: &Path, line: usize, column: usize) -> Result<(), String> {
        let Some(editor) = &self.editor else {
            return Err(
                "no editor is known: start `understory watch` with `--editor COMMAND`".to_owned(),
            );
        };
        editor
            .open(file, line, column)
            .map_err(|error| format!("the editor does not start: {error}"))
    }
}

/// Pictures in files, and lines on the terminal.
struct Pictures<'s> {
    shell: &'s Shell,
    target: Option<PictureTarget>,
    report: Option<JsonTarget>,
    room: Arc<Room>,
}

impl Outlet for Pictures<'_> {
    fn begins(&self, changed: &[String]) {
        if !changed.is_empty() {
            let line = format!("{} changed", changed.join(", "));
            self.shell.terminal.note(&line);
        }
    }

    fn finished(
        &self,
        run: &Run,
        studio: &mut Studio<'_>,
        finished: &Finished<'_>,
    ) -> Result<(), Failure> {
        let shell = self.shell;
        let hash = studio
            .seconds
            .time(&shell.world, Phase::Write, || match &self.target {
                Some(target) => {
                    let picture =
                        exposing::develop(finished.image, target.format(), finished.exposure);
                    target.write(&shell.world, &picture, &run.texts())
                }
                None => Ok(run.picture_key()),
            })?;
        let made = Made {
            effort: finished.effort,
            hash,
            is_whole: true,
            n_kept: 0,
            n_made: 1,
            warnings: finished.warnings.clone(),
            solution: finished.solution,
            flicker: None,
            has_film: false,
            notes: Vec::new(),
        };
        shell.report(self.report.as_ref(), run, studio, &made)?;
        shell.terminal.finish_stage();
        let name = self
            .target
            .as_ref()
            .map_or(Path::new("picture"), PictureTarget::path);
        shell.terminal.note(&summary(name, run, studio, &made));
        Ok(())
    }

    fn failed(&self, failure: &Failure) {
        self.shell.terminal.finish_stage();
        outcome::show(&self.shell.terminal, failure);
        self.shell.terminal.note("waiting for a change");
    }

    fn panicked(&self) {
        self.shell.terminal.finish_stage();
        let message = "error: understory itself failed on this model; that is a fault of the program, please report it\n";
        self.shell.terminal.tell(message);
    }
}
