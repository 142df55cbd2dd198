//! Renderer and settings of a film for a wanted time or error.
//!
//! They are chosen once, before the first frame, and kept in a file beside the frames: each frame is made with them whenever and wherever it
//! is made, and depends on nothing else. A wanted time is that of all frames together, with the light that they share, from grown
//! scenes on; a wanted error is that of each frame. Methods are tried on the frame in the middle; on the first and the last one path tracing
//! alone tells how much noisier and slower they are.

use super::choosing::family::Family;
use super::choosing::law::{Known, Law, Offer};
use super::choosing::pilot::Pilot;
use super::choosing::{Chooser, Wish};
use super::content_hash::ContentHash;
use super::failure::Failure;
use super::filming::{Job, Shooting};
use super::reel::Reel;
use super::report::Phase;
use super::store::may_write;
use super::until::Until;
use super::viewing::Viewing;
use super::world::{Entry, World};
use crate::animation::Flight;
use crate::options::value::Renderer;
use crate::options::{Options, Origin};
use serde::Deserialize;
use std::collections::{BTreeMap, BTreeSet};
use std::fmt::Write;
use std::path::Path;

/// The file beside the frames.
const FILE: &str = "chosen.toml";
/// How it begins.
const HEAD: &str = "# understory: ";
/// Part of a wanted time that is planned with: single frames differ.
const PLANNED: f64 = 0.95;

/// What the file holds.
#[derive(Deserialize)]
struct Kept {
    /// A hash of all that the film is made from.
    film: String,
    /// Options with their values.
    #[serde(default)]
    chosen: BTreeMap<String, String>,
}

/// Path tracing on some frames, relative to the one in the middle.
struct Spread {
    /// The most noise of one frame.
    noise: f64,
    /// Seconds of a sample, on average.
    seconds: f64,
}

impl Shooting<'_, '_> {
    /// Chooses for all frames, or takes over what was chosen for them before.
    ///
    /// # Errors
    /// If it was stopped, or the file can be neither used nor written.
    pub(super) fn choose(
        &mut self,
        flight: &Flight,
        reel: &Reel,
        wish: Wish,
    ) -> Result<(), Failure> {
        let chooser = Chooser::new(&self.base, wish);
        let jobs = self.jobs(flight)?;
        let keys: Vec<&[u8]> = jobs.iter().map(|job| job.key.as_bytes()).collect();
        let key = ContentHash::of(keys).to_string();
        let path = reel.folder().join(FILE);
        let world = self.making.world;
        self.base = match read(world, &path, &key)? {
            Some(chosen) => chooser.apply(&chosen)?,
            None => {
                let chosen = self.measure(&jobs, &chooser)?;
                write(world, &path, &key, &chosen)?;
                chosen
            }
        };
        if let (Wish::Error(most), Renderer::Path, None) =
            (wish, self.base.renderer.value, chooser.samples)
        {
            self.until = Until::Error {
                most,
                expected: self.base.samples.value.get(),
            };
        }
        self.is_checked = true;
        Ok(())
    }

    /// The options for all frames.
    fn measure(&mut self, jobs: &[Job], chooser: &Chooser) -> Result<Options, Failure> {
        let Some(middle) = jobs.get(jobs.len() / 2) else {
            return Ok(self.base.clone());
        };
        let begin = self.making.world.now();
        let (offer, wanted) = self.offer(jobs, middle, chooser)?;
        let mut offer = offer;
        // The others, as path tracing finds them.
        let ends = [jobs.first(), jobs.last()].into_iter().flatten();
        let ends: Vec<&Job> = ends.filter(|job| job.frame != middle.frame).collect();
        let is_open = offer.law.sample > 0.0 && chooser.samples.is_none();
        if is_open && !(offer.offer.family == Family::Path && wanted.is_none()) {
            let spread = self.spread(&ends, &offer, chooser.wish)?;
            offer.law.sample *= spread.seconds;
            offer.law.noise *= spread.noise;
        }
        let samples = match (chooser.samples, chooser.wish, wanted) {
            (Some(n), ..) => n,
            (None, Wish::Seconds(seconds), Some(_)) => {
                let spent = self.making.world.now().saturating_sub(begin).as_secs_f64();
                let each = PLANNED * (seconds - spent).max(0.0) / jobs.len() as f64;
                offer.law.samples_within(each).max(1)
            }
            (None, Wish::Error(error), _) if offer.offer.family != Family::Path => {
                let n = offer.law.samples_for(error);
                n.map_or(offer.offer.samples, |n| n.max(offer.offer.samples))
            }
            (None, ..) => offer.offer.samples,
        };
        let Offer { family, rung, .. } = offer.offer;
        chooser.with(family, rung, Some(samples))
    }

    /// What is best for the frame in the middle, with its share of the time if time is what is wanted.
    fn offer(
        &mut self,
        jobs: &[Job],
        middle: &Job,
        chooser: &Chooser,
    ) -> Result<(Measured, Option<f64>), Failure> {
        let world = self.making.world;
        let begin = world.now();
        let n_scenes = jobs.iter().map(|job| job.scene.to_string());
        let n_scenes = n_scenes.collect::<BTreeSet<String>>().len() as f64;
        let n_frames = jobs.len() as f64;
        self.set_moment(middle.moment.step, middle.moment.sun)?;
        let scene = self.studio.build(self.run, self.making.cancel)?;
        let is_judged = Viewing::is_judged(&scene);
        self.making.audience.begins("measuring");
        let viewing = self.making.viewing(self.run);
        let (pilot, known) = self.studio.seconds.time(world, Phase::Prepare, || {
            let pilot = Pilot::new(&viewing, &scene, &middle.camera, chooser.wish)?;
            let known = chooser.explore(&viewing, (&scene, &middle.camera), &pilot)?;
            Ok::<_, Failure>((pilot, known))
        })?;
        // A frame pays for its part of what frames share.
        let part = n_scenes / n_frames;
        let of_frame = |known: &Known| Known {
            law: Law {
                shared: known.law.shared * part,
                ..known.law
            },
            ..*known
        };
        let known: Vec<Known> = known.iter().map(of_frame).collect();
        let spent = world.now().saturating_sub(begin).as_secs_f64();
        let wanted = match chooser.wish {
            Wish::Seconds(seconds) => Some((seconds - spent).max(0.0) / n_frames),
            Wish::Error(_) => None,
        };
        let best = chooser.best(&known, wanted.unwrap_or(f64::INFINITY));
        let offer = best.unwrap_or_else(|| chooser.last_resort(&known, is_judged));
        let law = known.iter().find(|known| known.family == offer.family);
        let law = law.map_or(Law::default(), |k| k.law.climbed(k.family, offer.rung));
        let measured = Measured {
            offer,
            law,
            path: pilot.path,
        };
        Ok((measured, wanted))
    }

    /// How other frames differ from the one that was measured.
    fn spread(
        &mut self,
        others: &[&Job],
        measured: &Measured,
        wish: Wish,
    ) -> Result<Spread, Failure> {
        let mut spread = Spread {
            noise: 1.0,
            seconds: 1.0,
        };
        let mut seconds = vec![1.0];
        for job in others {
            self.set_moment(job.moment.step, job.moment.sun)?;
            let scene = self.studio.build(self.run, self.making.cancel)?;
            self.making.audience.begins("measuring");
            let viewing = self.making.viewing(self.run);
            let new = || Pilot::new(&viewing, &scene, &job.camera, wish);
            let pilot = self
                .studio
                .seconds
                .time(self.making.world, Phase::Prepare, new)?;
            let ratio = |here: f64, there: f64| if there > 0.0 { here / there } else { 1.0 };
            spread.noise = spread
                .noise
                .max(ratio(pilot.path.noise, measured.path.noise));
            seconds.push(ratio(pilot.path.sample, measured.path.sample));
        }
        spread.seconds = seconds.iter().sum::<f64>() / seconds.len() as f64;
        Ok(spread)
    }
}

/// An offer with the law that it was made by, and that of path tracing.
struct Measured {
    offer: Offer,
    law: Law,
    path: Law,
}

/// What was chosen for the film with this key.
fn read(
    world: &dyn World,
    path: &Path,
    key: &str,
) -> Result<Option<Vec<(String, String)>>, Failure> {
    if world.entry(path) != Entry::File {
        return Ok(None);
    }
    let file = world
        .read(path)
        .map_err(|error| Failure::file("read", path, &error))?;
    let text = String::from_utf8_lossy(&file);
    // One of another film, or a damaged one, is written anew, unless somebody else wrote it.
    let kept: Option<Kept> = toml::from_str(&text).ok();
    let kept = kept.filter(|kept| kept.film == key);
    Ok(kept.map(|kept| kept.chosen.into_iter().collect()))
}

/// Keeps what was chosen.
fn write(world: &dyn World, path: &Path, key: &str, options: &Options) -> Result<(), Failure> {
    let mut text = format!(
        "{HEAD}settings that were chosen for all frames of this film. Without this file they are chosen anew.\n\
         film = \"{key}\"\n\n[chosen]\n"
    );
    for entry in options.entries() {
        if matches!(entry.origin, Origin::Chosen { .. }) {
            // Writing into a text does not fail. No chosen value has a quotation mark.
            let _ = writeln!(text, "{} = \"{}\"", entry.row.key, entry.text);
        }
    }
    may_write(world, path, "a file of chosen settings", |head| {
        HEAD.as_bytes().starts_with(head) || head.starts_with(HEAD.as_bytes())
    })?;
    world
        .replace(path, text.as_bytes())
        .map_err(|error| Failure::file("write", path, &error))
}
