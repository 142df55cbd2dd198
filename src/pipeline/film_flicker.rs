//! How much a film flickers: pairs of its frames are made again with other random numbers.

use super::exposing;
use super::failure::Failure;
use super::filming::{Job, Shooting};
use super::frame::FrameAudience;
use super::reel::Reel;
use super::report::Phase;
use super::viewing::Viewing;
use crate::animation::flicker::{self, Flicker, FlickerMeter};
use crate::film::LinearImage;
use crate::image::{Format, Pixels};
use crate::options::Origin;

/// Added to the seed of frames that are rendered again to measure flicker.
const OTHER_SEED: i64 = 0x0066_6c69_636b_6572;

impl Shooting<'_, '_> {
    /// Renders pairs of frames again with other random numbers and compares.
    pub(super) fn flicker(
        &mut self,
        jobs: &[Job],
        frames: std::ops::Range<u32>,
        reel: &Reel,
        exposure: f64,
    ) -> Result<Option<Flicker>, Failure> {
        let pairs = flicker::pairs(frames.end - frames.start, self.base.flicker.value);
        let mut meter = FlickerMeter::default();
        for (index, first) in (0..).zip(&pairs) {
            let world = self.making.world;
            let at = frames.start + first;
            let pair = [&jobs[at as usize], &jobs[at as usize + 1]];
            let mut film = Vec::new();
            let mut again = Vec::new();
            for (second, job) in (0..).zip(pair) {
                let exposure = job.exposed(exposure);
                film.push(reel.shown(world, job.frame, exposure)?);
                let index = 2 * index + second;
                let n_frames = 2 * pairs.len() as u64;
                let image = match self.again(job, index, n_frames) {
                    Ok(Some(image)) => image,
                    // The film itself is there.
                    Ok(None) | Err(Failure::Stopped) => return Ok(None),
                    Err(failure) => return Err(failure),
                };
                let picture = exposing::develop(&image, Format::Png, exposure);
                match picture.pixels {
                    Pixels::Srgb(bytes) => again.push(bytes),
                    Pixels::Linear(_) => unreachable!("invariant: PNG is sRGB"),
                }
            }
            meter.add([&film[0], &film[1]], [&again[0], &again[1]]);
        }
        self.making.audience.ends();
        Ok(meter.result())
    }

    /// A frame made with other random numbers; `None` if it was stopped.
    fn again(
        &mut self,
        job: &Job,
        index: u64,
        n_frames: u64,
    ) -> Result<Option<LinearImage>, Failure> {
        let mut options = self.base.clone();
        let seed = options.seed.value.wrapping_add(OTHER_SEED).to_string();
        options
            .set("seed", &seed, Origin::Flag)
            .map_err(|error| Failure::Usage(error.to_string()))?;
        let base = self.base.clone();
        self.look(job, &base, |this, _, prepared| {
            this.making.audience.begins("measuring flicker");
            let progress = FrameAudience {
                audience: this.making.audience,
                index,
                n_frames,
            };
            let viewing = Viewing {
                audience: &progress,
                options: &options,
                ..this.making.viewing(this.run)
            };
            let world = this.making.world;
            let shoot = || viewing.take(prepared, &job.camera, this.until, &mut |_| {});
            let shot = this.studio.seconds.time(world, Phase::Render, shoot)?;
            Ok(shot.is_whole.then_some(shot.image))
        })
    }
}
