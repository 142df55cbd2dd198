//! From a model to picture files: one picture, or the frames of a film.

use super::audience::Audience;
use super::content_hash::ContentHash;
use super::exposing;
use super::failure::Failure;
use super::report::{Effort, Phase, SolutionFacts};
use super::store::PictureTarget;
use super::studio::{Run, Studio};
use super::viewing::Viewing;
use super::viewpoint;
use super::world::{Entry, World};
use crate::animation::{Flight, frame_name};
use crate::diag::{Diagnostic, Diagnostics, SourceMap, Span};
use crate::image::png_text;
use crate::integrator::CancelToken;
use crate::options::{Options, Stage};
use crate::scene::Scene;
use std::path::Path;

/// The text of a frame that tells what it was made from.
const FRAME_KEY: &str = "Frame key";

/// What came out of a run.
#[derive(Debug)]
pub struct Made {
    /// What it took.
    pub effort: Effort,
    /// Hash of the picture file; of all frames' files for a film.
    pub hash: ContentHash,
    /// Whether all that was asked for is there.
    pub is_whole: bool,
    /// Frames that were there already.
    pub n_kept: u32,
    /// Frames (or pictures) that were made.
    pub n_made: u32,
    /// What the pictures lack without showing it.
    pub warnings: Vec<&'static str>,
    /// The light that they share.
    pub solution: SolutionFacts,
}

/// What becomes of a picture that was stopped before it had all its samples.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Partial {
    /// It is written: the user wants what there is.
    Keep,
    /// It is dropped: what it shows is no longer true.
    Drop,
}

/// What making pictures needs besides the model.
#[derive(Clone, Copy)]
pub struct Making<'a> {
    /// Files and the clock.
    pub world: &'a dyn World,
    /// Who is told how far it is.
    pub audience: &'a dyn Audience,
    /// The wish to stop.
    pub cancel: &'a CancelToken,
    /// What becomes of a picture when it is stopped.
    pub partial: Partial,
}

impl Making<'_> {
    fn viewing<'v>(&'v self, run: &'v Run) -> Viewing<'v> {
        let Self {
            world,
            audience,
            cancel,
            ..
        } = *self;
        Viewing {
            world,
            audience,
            options: &run.options,
            cancel,
        }
    }

    /// Tells what pictures of the scene will lack, and gives it back.
    fn warn(&self, run: &Run, viewing: &Viewing<'_>, scene: &Scene) -> Vec<&'static str> {
        let warnings = viewing.shortcomings(scene);
        let mut found = Diagnostics::default();
        for text in &warnings {
            let hint =
                "a lamp with extent (an `AreaLight`) or rough glass gives a complete picture";
            found.push(Diagnostic {
                primary: None,
                ..Diagnostic::warning("missing-light", Span::default(), *text).hint(hint)
            });
        }
        if !warnings.is_empty() {
            self.audience.warned(&run.sources.map, &found);
        }
        warnings
    }

    /// Makes the picture of a run. Stopped early, the picture is written with the samples so far.
    ///
    /// # Errors
    /// If any stage fails, or it was stopped before there was a picture.
    pub fn picture(
        &self,
        studio: &mut Studio<'_>,
        run: &Run,
        target: &PictureTarget,
    ) -> Result<Made, Failure> {
        let scene = studio.build(run, self.cancel)?;
        let view = viewpoint::of_scene(&run.options, &scene);
        let camera = viewpoint::camera(&run.sources, &run.options, &view)?;
        let viewing = self.viewing(run);
        let warnings = self.warn(run, &viewing, &scene);

        self.audience.begins("preparing");
        let solved = studio.solve(run, &scene, &viewing)?;
        let (prepared, exposure) = studio.seconds.time(self.world, Phase::Prepare, || {
            let prepared = viewing.prepare(&scene, &solved.solution)?;
            let exposure = viewing.exposure(&scene, &prepared, &camera)?;
            Ok::<_, Failure>((prepared, exposure))
        })?;
        self.audience.begins("rendering");
        studio.work.views += 1;
        let shot = studio.seconds.time(self.world, Phase::Render, || {
            viewing.shoot(&prepared, &camera)
        })?;
        self.audience.ends();

        if !shot.is_whole && self.partial == Partial::Drop {
            return Err(Failure::Stopped);
        }
        let hash = studio.seconds.time(self.world, Phase::Write, || {
            let picture = exposing::develop(&shot.image, target.format(), exposure);
            target.write(self.world, &picture, &run.texts())
        })?;
        Ok(Made {
            effort: shot.effort,
            hash,
            is_whole: shot.is_whole,
            n_kept: 0,
            n_made: 1,
            warnings,
            solution: solved.facts,
        })
    }

    /// Makes the frames that the options ask for, in `folder`. Frames that are there already and were made from the same
    /// are kept. Stopped early, what is finished stays.
    ///
    /// # Errors
    /// If any stage fails.
    pub fn film(&self, studio: &mut Studio<'_>, run: &Run, folder: &Path) -> Result<Made, Failure> {
        if run.options.time.value.is_some() {
            // Frames that end by the clock would not be the same bytes twice.
            let message = "a film has no `time`: its frames end after `samples`";
            return Err(Failure::Usage(message.to_owned()));
        }
        check_frames(&run.options)?;
        let scene = studio.build(run, self.cancel)?;
        let start = viewpoint::of_scene(&run.options, &scene);
        let flight = Flight::orbit(start, run.options.flight_frames.value);
        let frames = run.options.frames.value.clone().unwrap_or(flight.all());
        let viewing = self.viewing(run);
        let warnings = self.warn(run, &viewing, &scene);

        // The exposure is that of the flight's first frame, whichever frames are made: it never flickers.
        self.audience.begins("preparing");
        let solved = studio.solve(run, &scene, &viewing)?;
        let (prepared, exposure) = studio.seconds.time(self.world, Phase::Prepare, || {
            let camera = viewpoint::camera(&run.sources, &run.options, &flight.view(0))?;
            let prepared = viewing.prepare(&scene, &solved.solution)?;
            let exposure = viewing.exposure(&scene, &prepared, &camera)?;
            Ok::<_, Failure>((prepared, exposure))
        })?;

        let film_key = run
            .picture_key()
            .with(&run.options.fingerprint(Stage::Flight));
        let audience = FilmAudience {
            audience: self.audience,
            n_frames: frames.len() as u64,
        };
        let mut film = FilmProgress {
            warnings,
            solution: solved.facts,
            ..FilmProgress::default()
        };
        audience.audience.begins("flying");
        for (index, frame) in frames.enumerate() {
            let path = folder.join(frame_name(frame));
            let key = film_key.with(&frame.to_string()).to_string();
            if let Some(hash) = self.kept(&path, &key)? {
                film.keep(hash);
                continue;
            }
            let camera = viewpoint::camera(&run.sources, &run.options, &flight.view(frame))?;
            let progress = FrameAudience {
                film: &audience,
                index: index as u64,
            };
            let viewing = Viewing {
                audience: &progress,
                ..viewing
            };
            let shot = studio.seconds.time(self.world, Phase::Render, || {
                viewing.shoot(&prepared, &camera)
            });
            let shot = match shot {
                Ok(shot) if shot.is_whole => shot,
                Ok(_) | Err(Failure::Stopped) => {
                    self.audience.ends();
                    return Ok(film.end(false));
                }
                Err(failure) => return Err(failure),
            };
            let hash = studio.seconds.time(self.world, Phase::Write, || {
                let target = PictureTarget::new(self.world, &path)?;
                let picture = exposing::develop(&shot.image, target.format(), exposure);
                let mut texts = run.texts();
                texts.push((FRAME_KEY, key));
                target.write(self.world, &picture, &texts)
            })?;
            film.make(hash, shot.effort);
        }
        self.audience.ends();
        Ok(film.end(true))
    }

    /// The hash of the frame at `path` if it is whole and was made from the same.
    fn kept(&self, path: &Path, key: &str) -> Result<Option<ContentHash>, Failure> {
        if self.world.entry(path) != Entry::File {
            return Ok(None);
        }
        let file = self
            .world
            .read(path)
            .map_err(|e| Failure::file("read", path, &e))?;
        let texts = png_text::read(&file).unwrap_or_default();
        let is_same = texts
            .iter()
            .any(|(name, value)| name == FRAME_KEY && value == key);
        Ok(is_same.then(|| ContentHash::of([&file[..]])))
    }
}

/// Refuses frames that the flight does not have.
fn check_frames(options: &Options) -> Result<(), Failure> {
    let length = options.flight_frames.value;
    match &options.frames.value {
        Some(frames) if frames.end > length.get() => Err(Failure::Usage(format!(
            "`frames` {}..{} reach beyond the flight's {length} frames; `--flight-frames {}` makes it longer",
            frames.start, frames.end, frames.end
        ))),
        _ => Ok(()),
    }
}

/// What has become of the frames so far.
#[derive(Default)]
struct FilmProgress {
    hashes: String,
    effort: Option<Effort>,
    n_kept: u32,
    n_made: u32,
    warnings: Vec<&'static str>,
    solution: SolutionFacts,
}

impl FilmProgress {
    fn keep(&mut self, hash: ContentHash) {
        self.hashes.push_str(&hash.to_string());
        self.n_kept += 1;
    }

    fn make(&mut self, hash: ContentHash, effort: Effort) {
        self.hashes.push_str(&hash.to_string());
        self.effort = Some(self.effort.map_or(effort, |all| all.and(effort)));
        self.n_made += 1;
    }

    fn end(self, is_whole: bool) -> Made {
        Made {
            effort: self.effort.unwrap_or_default(),
            hash: ContentHash::of([self.hashes.as_bytes()]),
            is_whole,
            n_kept: self.n_kept,
            n_made: self.n_made,
            warnings: self.warnings,
            solution: self.solution,
        }
    }
}

/// Turns the progress of single frames into that of the film.
struct FilmAudience<'a> {
    audience: &'a dyn Audience,
    n_frames: u64,
}

struct FrameAudience<'a> {
    film: &'a FilmAudience<'a>,
    index: u64,
}

impl Audience for FrameAudience<'_> {
    fn printed(&self, text: &str) {
        self.film.audience.printed(text);
    }

    fn warned(&self, sources: &SourceMap, found: &Diagnostics) {
        self.film.audience.warned(sources, found);
    }

    fn begins(&self, _: &'static str) {}

    fn progress(&self, done: u64, total: u64) {
        self.film
            .audience
            .progress(self.index * total + done, self.film.n_frames * total);
    }

    fn ends(&self) {}
}
