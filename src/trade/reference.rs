//! The pictures that all others are compared with.

use super::folder::PICTURES;
use super::metrics::{Truth, mean_image};
use super::objects::Objects;
use super::results::Reference;
use super::session::Session;
use super::shooting::set;
use crate::film::{LinearImage, tone};
use crate::math::rng;
use crate::math::tolerance::REFERENCE_NOISE;
use crate::options::Options;
use crate::pipeline::content_hash::ContentHash;
use crate::pipeline::exposing;
use crate::pipeline::failure::Failure;

/// Part of the budget for the reference.
const REFERENCE_SHARE: f64 = 0.3;
/// Samples per pixel of one batch of the reference, of its first one, and how many batches there are at most.
const BATCH: u32 = 64;
const FIRST_BATCH: u32 = 4;
const MOST_BATCHES: u32 = 1024;
/// From which the seeds of the reference are made.
const REFERENCE_SEED: u64 = 0x5EED_0F7B;

/// What the pictures are compared with.
pub(super) struct Standard {
    pub(super) truth: Truth,
    pub(super) exposure: f64,
    /// The reference as it looks.
    pub(super) seen: Vec<u8>,
    pub(super) objects: Objects,
}

impl Session<'_> {
    /// Adds to the reference as long as it has time, unless it is good enough.
    pub(super) fn reference(&mut self, key: ContentHash) -> Result<[LinearImage; 2], Failure> {
        let mut options = self.options.clone();
        set(&mut options, "renderer", "path");
        set(&mut options, "supersampling", "auto");
        let mut method = "path";
        let lacks = self
            .viewing(&options, self.means.cancel)
            .shortcomings(self.scene);
        if !lacks.is_empty() {
            // Light that no path from the camera finds: photons find it, pass by pass without bias in the end.
            for (key, value) in [
                ("renderer", "photon"),
                ("global-photons", "100000"),
                ("caustic-photons", "100000"),
                ("photon-area", "auto"),
                ("final-gather", "0"),
                ("passes", "16"),
            ] {
                set(&mut options, key, value);
            }
            method = "photon";
        }
        let key = key.with(method).to_string();
        let kept = self
            .folder
            .references()
            .filter(|_| self.findings.reference.key == key);
        let mut known = Reference {
            key,
            method: method.into(),
            lacks: lacks.iter().map(|&text| text.to_owned()).collect(),
            ..Reference::default()
        };
        let mut halves = None;
        if let Some(kept) = kept {
            known.samples = self.findings.reference.samples;
            known.seconds = self.findings.reference.seconds;
            halves = Some(kept);
        }
        let result = self.add_batches(&mut options, &mut known, &mut halves);
        if let Some(halves) = &halves {
            known.noise = Truth::new(&halves[0], &halves[1]).noise();
            known.seconds += self.elapsed();
            self.findings.reference = known;
            self.folder.keep_references(halves)?;
            self.keep()?;
        }
        result?;
        halves.ok_or(Failure::Stopped)
    }

    /// Adds pairs of pictures with other random numbers to both halves of the reference.
    fn add_batches(
        &self,
        options: &mut Options,
        known: &mut Reference,
        halves: &mut Option<[LinearImage; 2]>,
    ) -> Result<(), Failure> {
        let deadline = REFERENCE_SHARE * self.plan.budget;
        for _ in 0..MOST_BATCHES {
            let is_enough = halves.as_ref().is_some_and(|[a, b]| {
                known.seconds + self.elapsed() >= deadline
                    || Truth::new(a, b).noise() < REFERENCE_NOISE
            });
            if is_enough {
                break;
            }
            // The first pair is small, so that there is something to compare with soon.
            let samples = if known.samples == 0 {
                FIRST_BATCH
            } else {
                BATCH
            };
            set(options, "samples", &samples.to_string());
            let one = |half| {
                let seed = rng::hash(&[REFERENCE_SEED, known.samples, half]);
                self.take(options, seed, false, self.means.cancel)
            };
            let images = [one(0)?.0, one(1)?.0];
            let weight = f64::from(2 * samples) / (known.samples + u64::from(2 * samples)) as f64;
            *halves = Some(match halves.take() {
                None => images,
                Some([a, b]) => [mixed(&a, &images[0], weight), mixed(&b, &images[1], weight)],
            });
            known.samples += u64::from(2 * samples);
            self.tell();
        }
        Ok(())
    }

    pub(super) fn standard(
        &self,
        halves: &[LinearImage; 2],
        objects: Objects,
    ) -> Result<Standard, Failure> {
        let whole = mean_image(halves).ok_or(Failure::Stopped)?;
        let exposure = match self.options.exposure.value {
            Some(stops) => exposing::factor(stops),
            None => {
                let subject =
                    exposing::subject(self.scene, &self.cameras[0], whole.width, whole.height);
                tone::auto_exposure(&whole, &subject)
            }
        };
        let seen = tone::to_srgb8(&whole, exposure, tone::ToneCurve::default());
        let name = format!("{PICTURES}/reference.png");
        self.folder
            .picture(&name, seen.clone(), self.findings.size)?;
        Ok(Standard {
            truth: Truth::new(&halves[0], &halves[1]),
            exposure,
            seen,
            objects,
        })
    }
}

/// Both, the second one with this weight.
fn mixed(before: &LinearImage, new: &LinearImage, weight: f64) -> LinearImage {
    let pixels = before.pixels.iter().zip(&new.pixels);
    LinearImage {
        width: before.width,
        height: before.height,
        pixels: pixels
            .map(|(before, new)| before.lerp(*new, weight))
            .collect(),
    }
}
