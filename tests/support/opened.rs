//! A model with its sidecar and some options, opened as the program opens it: grown, drawn, looked at.

use std::path::{Path, PathBuf};
use std::sync::{Arc, Mutex};
use std::time::Instant;
use understory::camera::Camera;
use understory::diag::{Diagnostics, SourceMap};
use understory::film::LinearImage;
use understory::growth::Growth;
use understory::integrator::CancelToken;
use understory::math::Bounds3;
use understory::options::{Options, Origin};
use understory::pipeline::audience::Audience;
use understory::pipeline::studio::{Keep, Run, Studio};
use understory::pipeline::viewing::Viewing;
use understory::pipeline::viewpoint;
use understory::pipeline::world::Machine;
use understory::scene::Scene;

/// Keeps what a model prints; a warning fails the test.
#[derive(Default)]
struct Listener {
    printed: Mutex<String>,
}

impl Audience for Listener {
    fn printed(&self, text: &str) {
        self.printed.lock().unwrap().push_str(text);
    }

    fn warned(&self, sources: &SourceMap, found: &Diagnostics) {
        panic!("{found:#?} in {sources:?}");
    }

    fn begins(&self, _: &'static str) {}

    fn progress(&self, _: u64, _: u64) {}

    fn ends(&self) {}
}

/// A model with some options of its own.
pub(crate) struct Opened {
    listener: Arc<Listener>,
    world: Machine,
    path: PathBuf,
    flags: Options,
}

/// What is drawn.
pub(crate) struct Drawn {
    pub(crate) image: LinearImage,
    /// Of all but the ground, in metres.
    pub(crate) bounds: Bounds3,
    /// Seconds for the light that all views share, and for this one.
    #[allow(dead_code, reason = "for benchmarks")]
    pub(crate) seconds: [f64; 2],
}

impl Opened {
    pub(crate) fn new(path: impl AsRef<Path>, flags: &[(&str, &str)]) -> Self {
        let mut options = Options::default();
        for (key, text) in flags {
            options.set(key, text, Origin::Flag).unwrap();
        }
        Self {
            listener: Arc::default(),
            world: Machine::new(),
            path: path.as_ref().to_owned(),
            flags: options,
        }
    }

    fn open(&self) -> (Studio<'_>, Run) {
        let (audience, path) = (self.listener.clone(), self.path.clone());
        let mut studio = Studio::new(&self.world, audience, path, Keep::Last);
        let run = studio
            .read(&self.flags)
            .and_then(|opened| studio.check(opened))
            .unwrap_or_else(|failure| panic!("{}: {failure:?}", self.path.display()));
        (studio, run)
    }

    pub(crate) fn grow(&self) -> Growth {
        let (mut studio, run) = self.open();
        studio
            .grow(&run, &CancelToken::default())
            .unwrap_or_else(|failure| panic!("{}: {failure:?}", self.path.display()))
    }

    /// What the model has printed in all its runs.
    pub(crate) fn printed(&self) -> String {
        self.listener.printed.lock().unwrap().clone()
    }

    /// Its scene, and the camera that looks at it.
    #[allow(dead_code, reason = "for benchmarks")]
    pub(crate) fn scene(&self) -> (Arc<Scene>, Camera) {
        let (mut studio, run) = self.open();
        self.built(&mut studio, &run)
    }

    fn built(&self, studio: &mut Studio<'_>, run: &Run) -> (Arc<Scene>, Camera) {
        let scene = studio
            .build(run, &CancelToken::default())
            .unwrap_or_else(|failure| panic!("{}: {failure:?}", self.path.display()));
        let view = viewpoint::of_scene(&run.options, &scene);
        let camera = viewpoint::camera(&run.sources, &run.options, &view).unwrap();
        (scene, camera)
    }

    /// Grows it and draws it.
    pub(crate) fn draw(&self) -> Drawn {
        let (mut studio, run) = self.open();
        let cancel = CancelToken::default();
        let (scene, camera) = self.built(&mut studio, &run);
        let viewing = Viewing {
            world: &self.world,
            audience: &*self.listener,
            options: &run.options,
            cancel: &cancel,
        };
        let begin = Instant::now();
        let solution = viewing.solve(&scene, &mut |_| {}).unwrap();
        let prepared = viewing.prepare(&scene, &solution).unwrap();
        let solved = Instant::now();
        let shot = viewing.shoot(&prepared, &camera).unwrap();
        Drawn {
            image: shot.image,
            bounds: scene.bounds(),
            seconds: [
                (solved - begin).as_secs_f64(),
                solved.elapsed().as_secs_f64(),
            ],
        }
    }
}
