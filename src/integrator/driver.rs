//! Fills a film with the answers of an estimator: tiles, threads, passes, progress, cancellation.
//!
//! Every sample is a pure function of (seed, pixel, sample number) and every pixel adds up its own samples in order, so the
//! bytes depend neither on the number of threads nor on how the samples are cut into passes.

use super::{Progress, RadianceEstimator, RayCounts, RenderContext, RenderError};
use crate::camera::Camera;
use crate::film::contrast::{self, PixelMask};
use crate::film::filter::FilterSampler;
use crate::film::{ErrorEstimate, Film, Filter, Pixel, Tile};
use crate::math::{Ray, rng};
use crate::sampler::{Sampler, SamplerKind, Use};
use glam::DVec2;
use rayon::prelude::*;
use std::ops::{ControlFlow, Range};
use std::sync::atomic::{AtomicU64, Ordering};

/// The picture that is wanted.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct FilmSettings {
    /// Width in pixels.
    pub width: u32,
    /// Height in pixels.
    pub height: u32,
    /// Samples per pixel; powers of two are spread best.
    pub samples_per_pixel: u32,
    /// How pixels weigh the light around them.
    pub filter: Filter,
    /// How samples are spread.
    pub sampler: SamplerKind,
    /// Which pixels get them all.
    pub refinement: Refinement,
}

/// Which pixels get all samples.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Refinement {
    /// All pixels.
    #[default]
    Everywhere,
    /// Two samples for each pixel, and all of them where those differ from each other or from their neighbours' by so much
    /// that an edge or noise would show. Too few for what is thinner than a pixel; meant for methods without noise.
    ByContrast,
}

/// What a render cost and how good it is.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct RenderReport {
    /// Samples per pixel in the picture; with [`Refinement::ByContrast`], of the pixels that got all.
    pub samples_per_pixel: u32,
    /// Ray queries of all samples.
    pub rays: RayCounts,
    /// Samples that were NaN or infinite and were left out; anything but 0 is a fault.
    pub n_rejected: u64,
    /// Estimated noise; `None` before the second sample.
    pub error: Option<ErrorEstimate>,
}

/// A picture and what it cost.
#[derive(Clone, Debug, PartialEq)]
pub struct FilmResult {
    /// The picture.
    pub film: Film,
    /// What it cost.
    pub report: RenderReport,
}

/// Largest number of samples per pixel between two calls of `on_pass`.
const LONGEST_PASS: u32 = 16;

/// Samples of each pixel after which it is decided which ones need more: one of each half.
const SAMPLES_TO_DECIDE: u32 = 2;

/// Renders one view.
///
/// After each pass (1, 1, 2, 4, 8, 16, 16 … samples per pixel) `on_pass` sees a valid picture; if it answers
/// [`ControlFlow::Break`], that picture is the result.
///
/// # Errors
/// [`RenderError::Cancelled`], with the picture so far, once the context is cancelled.
pub fn render_view(
    estimator: &dyn RadianceEstimator,
    camera: &Camera,
    settings: &FilmSettings,
    context: &RenderContext<'_>,
    on_pass: &mut dyn FnMut(&FilmResult) -> ControlFlow<()>,
) -> Result<FilmResult, RenderError> {
    let n_pixels = u64::from(settings.width) * u64::from(settings.height);
    let pass = Pass {
        estimator,
        camera,
        settings,
        context,
        filter: FilterSampler::new(settings.filter),
        done: AtomicU64::new(0),
        total: n_pixels * u64::from(settings.samples_per_pixel),
    };
    let mut wanted: Option<PixelMask> = None;
    let film = Film::new(settings.width, settings.height);
    let mut result = FilmResult {
        film,
        report: RenderReport::default(),
    };

    while result.report.samples_per_pixel < settings.samples_per_pixel {
        let start = result.report.samples_per_pixel;
        let end = start
            + start
                .clamp(1, LONGEST_PASS)
                .min(settings.samples_per_pixel - start);
        if start == SAMPLES_TO_DECIDE && settings.refinement == Refinement::ByContrast {
            wanted = Some(contrast::pixels_to_refine(&result.film));
        }
        let rays = pass.run(result.film.tiles_mut(), start..end, wanted.as_ref());
        result.report.rays += rays;
        result.report.n_rejected = result.film.n_rejected();
        if context.cancel.is_cancelled() {
            // Pixels that the interrupted pass has reached hold more samples than others; all are valid means.
            let partial = (start > 0).then(|| Box::new(result));
            return Err(RenderError::Cancelled { partial });
        }
        result.report.samples_per_pixel = end;
        result.report.error = result.film.error_estimate();
        if on_pass(&result).is_break() {
            break;
        }
    }
    Ok(result)
}

/// A pixel of a picture that is looked at by itself.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Spot {
    /// Its column.
    pub x: u32,
    /// Its row.
    pub y: u32,
    /// The samples that it has.
    pub pixel: Pixel,
}

/// Adds the samples of this range to some pixels of a view alone: the same samples that [`render_view`] would give them.
///
/// # Errors
/// [`RenderError::Cancelled`], without a picture, once the context is cancelled.
pub fn render_spots(
    estimator: &dyn RadianceEstimator,
    camera: &Camera,
    settings: &FilmSettings,
    (spots, samples): (&mut [Spot], Range<u32>),
    context: &RenderContext<'_>,
) -> Result<RayCounts, RenderError> {
    let n_each = u64::from(samples.end.saturating_sub(samples.start));
    let pass = Pass {
        estimator,
        camera,
        settings,
        context,
        filter: FilterSampler::new(settings.filter),
        done: AtomicU64::new(0),
        total: spots.len() as u64 * n_each,
    };
    let fill = |spot: &mut Spot| {
        let mut rays = RayCounts::default();
        pass.add(&mut spot.pixel, (spot.x, spot.y), &samples, &mut rays);
        pass.tell(n_each);
        rays
    };
    let rays = spots
        .par_iter_mut()
        .map(fill)
        .reduce(RayCounts::default, |mut a, b| {
            a += b;
            a
        });
    if context.cancel.is_cancelled() {
        return Err(RenderError::Cancelled { partial: None });
    }
    Ok(rays)
}

/// What all tiles of all passes share.
struct Pass<'a> {
    estimator: &'a dyn RadianceEstimator,
    camera: &'a Camera,
    settings: &'a FilmSettings,
    context: &'a RenderContext<'a>,
    filter: FilterSampler,
    done: AtomicU64,
    total: u64,
}

impl Pass<'_> {
    /// Adds the samples of this range to all tiles.
    fn run(
        &self,
        tiles: &mut [Tile],
        samples: Range<u32>,
        wanted: Option<&PixelMask>,
    ) -> RayCounts {
        tiles
            .par_iter_mut()
            .map(|tile| self.fill(tile, &samples, wanted))
            .reduce(RayCounts::default, |mut a, b| {
                a += b;
                a
            })
    }

    /// Adds the samples of this range to the pixels of a tile, or to those that are wanted.
    fn fill(&self, tile: &mut Tile, samples: &Range<u32>, wanted: Option<&PixelMask>) -> RayCounts {
        let mut rays = RayCounts::default();
        for (i, pixel) in (0..).zip(&mut tile.pixels) {
            let (x, y) = (tile.x + i % tile.width, tile.y + i / tile.width);
            if wanted.is_some_and(|mask| !mask.has(x, y)) {
                continue;
            }
            self.add(pixel, (x, y), samples, &mut rays);
            if self.context.cancel.is_cancelled() {
                return rays;
            }
        }
        self.tell(tile.pixels.len() as u64 * u64::from(samples.end - samples.start));
        rays
    }

    /// Adds the samples of this range to the pixel in this column and row.
    fn add(
        &self,
        pixel: &mut Pixel,
        (x, y): (u32, u32),
        samples: &Range<u32>,
        rays: &mut RayCounts,
    ) {
        for sample in samples.clone() {
            // A sample that gathers light over the hemisphere can take a millisecond.
            if self.context.cancel.is_cancelled() {
                return;
            }
            let mut sampler = self.sampler(x, y, sample);
            let ray = self.ray(x, y, &sampler);
            let radiance = self.estimator.incident_radiance(&ray, &mut sampler, rays);
            pixel.add(sample, radiance);
        }
    }

    /// Tells that so many more samples are done.
    fn tell(&self, n_samples: u64) {
        let done = self.done.fetch_add(n_samples, Ordering::Relaxed) + n_samples;
        (self.context.progress)(Progress {
            done,
            total: self.total,
        });
    }

    /// The sampler of one sample. The two halves of a pixel are scrambled independently.
    fn sampler(&self, x: u32, y: u32, sample: u32) -> Sampler {
        let half = u64::from(sample % 2);
        let stream = rng::hash(&[self.context.seed, u64::from(x), u64::from(y), half]);
        Sampler::new(self.settings.sampler, stream, sample / 2)
    }

    /// The ray of one sample of pixel (x, y).
    fn ray(&self, x: u32, y: u32, sampler: &Sampler) -> Ray {
        let film = self.film_point(x, y, sampler);
        let camera = self.camera;
        if !camera.has_lens() && !camera.moves() {
            return camera.ray(film);
        }
        camera.ray_through(film, sampler.point(Use::Lens), sampler.point(Use::Time).x)
    }

    /// The point of the film, in the unit square from the upper left, where this sample of pixel (x, y) falls.
    fn film_point(&self, x: u32, y: u32, sampler: &Sampler) -> DVec2 {
        let offset = self.filter.offset(sampler.point(Use::Direction));
        let size = DVec2::new(
            f64::from(self.settings.width),
            f64::from(self.settings.height),
        );
        (DVec2::new(f64::from(x), f64::from(y)) + offset) / size
    }
}
