//! The loop of watching: events in, runs out.

use super::desk::{Desk, Order};
use super::files::Follower;
use super::snapshot::Snapshot;
use crate::integrator::CancelToken;
use crate::pipeline::reads::Reads;
use crate::pipeline::world::World;
use std::panic::{AssertUnwindSafe, catch_unwind};
use std::path::{Path, PathBuf};
use std::sync::mpsc::{Receiver, RecvTimeoutError, Sender, channel};

/// What can happen while watching.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Event {
    /// Something happened to a file of the model; perhaps its content changed.
    Touched,
    /// The run under way ended, one way or another.
    RunFinished,
    /// The user wants to stop.
    Quit,
}

/// Who runs the model.
pub trait Runner: Send {
    /// Runs it once and tells the user how it went. `changed` names the files that gave reason to; empty at first.
    ///
    /// Ends early, without a word, when `cancel` is set.
    fn run(&mut self, changed: &[String], cancel: &CancelToken);

    /// The run before this call panicked: whatever it left half done is not to be trusted.
    fn recover(&mut self);
}

/// What is watched.
pub struct Watched<'w> {
    /// The machine.
    pub world: &'w dyn World,
    /// The model.
    pub model: &'w Path,
    /// What its runs read besides its texts.
    pub reads: Reads,
    /// Who hears of events of files; `None` where there are none.
    pub follower: Option<Follower>,
    /// Called whenever a run is told to end: it may sleep.
    pub interrupt: &'w dyn Fn(),
}

impl Watched<'_> {
    /// What there is now; events of all that is there are heard from now on.
    fn look(&mut self) -> Snapshot {
        let snapshot = Snapshot::take(self.world, self.model, &self.reads);
        if let Some(follower) = &mut self.follower {
            let mut files: Vec<PathBuf> = snapshot.paths().cloned().collect();
            files.extend(self.reads.paths());
            follower.follow(&files);
        }
        snapshot
    }
}

struct Job {
    changed: Vec<String>,
    cancel: CancelToken,
}

/// Runs `model` now and after each change, until [`Event::Quit`] or the end of events.
///
/// `sender` is the other end of `events`.
pub fn watch(
    watched: Watched<'_>,
    runner: &mut dyn Runner,
    sender: Sender<Event>,
    events: Receiver<Event>,
) {
    std::thread::scope(|scope| {
        let (jobs, work) = channel::<Job>();
        scope.spawn(move || {
            for job in work {
                let run = AssertUnwindSafe(|| runner.run(&job.changed, &job.cancel));
                if catch_unwind(run).is_err() {
                    runner.recover();
                }
                // Fails only when watching has ended.
                let _ = sender.send(Event::RunFinished);
            }
        });
        attend(watched, &jobs, &events);
    });
}

/// Owns the state; the only one to decide what is run.
fn attend(mut watched: Watched<'_>, jobs: &Sender<Job>, events: &Receiver<Event>) {
    let world = watched.world;
    let mut cancel = CancelToken::default();
    let start = |changed: Vec<String>, cancel: &CancelToken| {
        jobs.send(Job {
            changed,
            cancel: cancel.clone(),
        })
        .expect("invariant: the worker lives as long as its jobs");
    };
    let mut desk = Desk::new(watched.look(), world.now());
    start(Vec::new(), &cancel);
    loop {
        match events.recv_timeout(desk.patience(world.now())) {
            Ok(Event::Touched) => desk.touched(world.now()),
            Ok(Event::RunFinished) => desk.finished(world.now()),
            Ok(Event::Quit) | Err(RecvTimeoutError::Disconnected) => {
                cancel.cancel();
                (watched.interrupt)();
                return;
            }
            Err(RecvTimeoutError::Timeout) => {}
        }
        if !desk.patience(world.now()).is_zero() {
            continue;
        }
        let snapshot = watched.look();
        match desk.look(snapshot, world.now()) {
            Order::Nothing => {}
            Order::Cancel => {
                cancel.cancel();
                (watched.interrupt)();
            }
            Order::Start(changed) => {
                cancel = CancelToken::default();
                start(changed, &cancel);
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::pipeline::world::fake::FakeWorld;
    use std::time::Duration;

    /// Tells each run to the test, and does what the model's text says.
    struct Puppet<'a> {
        world: &'a FakeWorld,
        runs: Sender<String>,
    }

    impl Runner for Puppet<'_> {
        fn run(&mut self, changed: &[String], cancel: &CancelToken) {
            let text = self.world.read(Path::new("m/p.rgg")).unwrap_or_default();
            let text = String::from_utf8_lossy(&text).into_owned();
            self.runs.send(format!("{text} {changed:?}")).unwrap();
            match text.as_str() {
                "panic" => panic!("the test asks for it"),
                "forever" => {
                    while !cancel.is_cancelled() {
                        std::thread::yield_now();
                    }
                }
                _ => {}
            }
        }

        fn recover(&mut self) {
            self.runs.send("recovered".into()).unwrap();
        }
    }

    /// How long a test waits for what must come.
    const PATIENCE: Duration = Duration::from_secs(60);

    /// Ends watching however a test ends.
    struct Ending(Sender<Event>);

    impl Drop for Ending {
        fn drop(&mut self) {
            let _ = self.0.send(Event::Quit);
        }
    }

    /// Watches a world whose model says `one` while `test` runs; it is given the world, the next thing that the puppet tells,
    /// and a way to tell of a touch.
    fn watching(test: impl FnOnce(&FakeWorld, &dyn Fn() -> String, &dyn Fn())) {
        let world = FakeWorld::default();
        world.put("m/p.rgg", "one");
        let (runs, seen) = channel();
        let (sender, events) = channel();
        std::thread::scope(|scope| {
            let (world, own) = (&world, sender.clone());
            scope.spawn(move || {
                let mut puppet = Puppet { world, runs };
                let watched = Watched {
                    world,
                    model: Path::new("m/p.rgg"),
                    reads: Reads::default(),
                    follower: None,
                    interrupt: &|| {},
                };
                watch(watched, &mut puppet, own, events);
            });
            let ending = Ending(sender);
            let next = || seen.recv_timeout(PATIENCE).unwrap();
            test(world, &next, &|| ending.0.send(Event::Touched).unwrap());
        });
    }

    #[test]
    fn changes_run_again_whatever_the_last_run_did() {
        watching(|world, next, touch| {
            let change = |text: &str| {
                world.put("m/p.rgg", text);
                touch();
            };
            assert_eq!(next(), "one []");
            change("panic");
            assert_eq!(next(), "panic [\"p.rgg\"]");
            assert_eq!(next(), "recovered");
            change("forever");
            assert_eq!(next(), "forever [\"p.rgg\"]");
            change("two");
            assert_eq!(next(), "two [\"p.rgg\"]");
        });
    }

    #[test]
    fn where_the_file_system_tells_nothing_it_is_asked() {
        watching(|world, next, _| {
            assert_eq!(next(), "one []");
            // Nobody says that anything was touched.
            for text in ["two", "forever", "three"] {
                world.put("m/p.rgg", text);
                assert_eq!(next(), format!("{text} [\"p.rgg\"]"));
            }
        });
    }
}
