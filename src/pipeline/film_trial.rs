//! What the frames of a film really cost: some are made, all over it, before the number of samples is settled.

use super::choosing::law::Law;
use super::failure::Failure;
use super::filming::{Job, Shooting};
use super::report::Phase;
use super::spot_check::samples_of_half;
use super::until::Until;
use super::viewing::{Prepared, Shot, Viewing};
use crate::camera::Camera;
use crate::options::Options;
use crate::scene::Scene;

/// Frames that stand for a film, at most.
pub(super) const PLACES: usize = 5;
/// Part of the samples of a whole film that are taken to find out what its frames really cost.
const PART_OF_FRAMES: f64 = 0.1;

/// Some frames of a film, or all if it has no more: each in the middle of an equal part.
pub(super) fn places(jobs: &[Job]) -> Vec<&Job> {
    evenly(jobs.len(), PLACES).map(|at| &jobs[at]).collect()
}

/// Places of so many among all, or of all if there are no more.
pub(super) fn evenly(n_all: usize, most: usize) -> impl Iterator<Item = usize> {
    let n = n_all.min(most);
    (0..n).map(move |i| (2 * i + 1) * n_all / (2 * n))
}

/// How many frames are made on trial, and with how many samples besides twice a single one; none if they would be too large a part of the
/// film.
pub(super) fn shape(samples: u32, n_frames: usize) -> Option<(usize, u32)> {
    let all = PART_OF_FRAMES * n_frames as f64 * f64::from(samples);
    // These saturate.
    let n = ((all / 4.0) as usize).min(PLACES).min(n_frames);
    let samples = ((all / n.max(1) as f64 - 2.0) as u32).min(samples.max(2));
    (n > 0).then_some((n, samples))
}

impl Shooting<'_, '_> {
    /// What an average frame costs once the light is solved, found by making these frames of a film that shows a single scene: with one
    /// sample of each pixel, and with those of the second options. The check of a frame is that of one with the samples that are expected.
    pub(super) fn trial(
        &mut self,
        jobs: &[&Job],
        n_frames: usize,
        (one, more, expected): (&Options, &Options, u32),
    ) -> Result<Law, Failure> {
        let Some(first) = jobs.first() else {
            return Ok(Law::default());
        };
        self.with_options(more, first, |this| {
            this.look(first, more, |this, scene, prepared| {
                this.making.audience.begins("measuring");
                let viewing = this.making.viewing(this.run);
                let phases = &mut this.studio.seconds;
                phases.time(this.making.world, Phase::Prepare, || {
                    let costs = jobs
                        .iter()
                        .map(|job| costs(&viewing, (prepared, &job.camera), (one, more)));
                    let costs = costs.collect::<Result<Vec<(Law, Shot)>, Failure>>()?;
                    let laws: Vec<Law> = costs.iter().map(|(law, _)| *law).collect();
                    let shot = &costs[0].1;
                    let n_samples = shot.effort.n_samples.saturating_mul(expected.into())
                        / u64::from(more.samples.value.get());
                    let (judge, check) = check(&viewing, (scene, &first.camera), shot, n_samples)?;
                    let n_checks = PLACES.min(n_frames) as f64;
                    let mut law = mean_of(&laws, n_frames);
                    law.shared += (judge + check * n_checks) / n_frames as f64;
                    Ok(law)
                })
            })
        })
    }
}

/// Seconds of what checks, and of the check of a frame with so many samples in all, if it is checked.
fn check(
    viewing: &Viewing<'_>,
    (scene, camera): (&Scene, &Camera),
    shot: &Shot,
    n_samples: u64,
) -> Result<(f64, f64), Failure> {
    let now = || viewing.world.now().as_secs_f64();
    let begin = now();
    let Some(judge) = viewing.needed_judge(scene)? else {
        return Ok((0.0, 0.0));
    };
    let ready = now();
    let n = samples_of_half(n_samples);
    viewing.spot_check(&*judge, camera, shot, n)?;
    Ok((ready - begin, now() - ready))
}

/// What one frame costs: what is kept for later frames is `shared`.
fn costs(
    viewing: &Viewing<'_>,
    (prepared, camera): (&Prepared<'_>, &Camera),
    (one, more): (&Options, &Options),
) -> Result<(Law, Shot), Failure> {
    let now = || viewing.world.now().as_secs_f64();
    let make = |options| {
        let begin = now();
        let viewing = Viewing {
            options,
            ..*viewing
        };
        let shot = viewing.take(prepared, camera, Until::Samples, &mut |_| {})?;
        Ok::<_, Failure>((shot, now() - begin))
    };
    let (_, cold) = make(one)?;
    let (_, warm) = make(one)?;
    let (shot, long) = make(more)?;
    let samples = f64::from(more.samples.value.get());
    let sample = (long - warm).max(0.0) / (samples - 1.0).max(1.0);
    let law = Law {
        shared: (cold - warm).max(0.0),
        begin: (warm - sample).max(0.0),
        sample,
        ..Law::default()
    };
    Ok((law, shot))
}

/// What a frame costs on average, if what some have kept for later ones is all that there is to keep.
fn mean_of(costs: &[Law], n_frames: usize) -> Law {
    let mean = |of: fn(&Law) -> f64| costs.iter().map(of).sum::<f64>() / costs.len().max(1) as f64;
    Law {
        shared: mean(|law| law.shared) * costs.len() as f64 / n_frames as f64,
        begin: mean(|law| law.begin),
        sample: mean(|law| law.sample),
        ..Law::default()
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn frames_are_looked_at_all_over_a_film() {
        let found = |n| evenly(n, PLACES).collect::<Vec<usize>>();
        assert!(found(0).is_empty());
        assert_eq!(found(1), [0]);
        assert_eq!(found(5), [0, 1, 2, 3, 4]);
        assert_eq!(found(100), [10, 30, 50, 70, 90]);
    }

    /// Trials take a tenth of the samples of a film at most, none where frames are so few that they would take more.
    #[test]
    fn trials_are_a_small_part_of_a_film() {
        for (samples, n_frames) in [
            (1, 1),
            (1, 200),
            (2, 40),
            (8, 250),
            (1000, 3),
            (u32::MAX, 600),
        ] {
            let all = shape(samples, n_frames).map_or(0.0, |(n, m)| {
                assert!(n <= PLACES.min(n_frames) && (2..=samples.max(2)).contains(&m));
                n as f64 * (f64::from(m) + 2.0)
            });
            let film = f64::from(samples) * n_frames as f64;
            assert!(all <= PART_OF_FRAMES * film, "{samples} {n_frames} {all}");
        }
        assert_eq!(shape(1, 39), None);
        assert_eq!(shape(1, 40), Some((1, 2)));
        assert_eq!(shape(2, 40), Some((2, 2)));
        assert_eq!(shape(8, 250), Some((5, 8)));
    }

    /// Three frames of which one has paid two seconds for all: of ten frames each pays a fifth of that.
    #[test]
    fn what_is_kept_is_paid_once() {
        let law = |shared: f64, begin: f64, sample: f64| Law {
            shared,
            begin,
            sample,
            ..Law::default()
        };
        let found = mean_of(
            &[law(2.0, 1.0, 0.5), law(0.0, 3.0, 0.5), law(0.0, 2.0, 2.0)],
            10,
        );
        assert!((found.shared - 0.2).abs() < 1e-12, "{found:?}");
        assert!((found.begin - 2.0).abs() < 1e-12 && (found.sample - 1.0).abs() < 1e-12);
    }
}
