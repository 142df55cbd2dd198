//! `light`: what each organ of a grown model gets of the light, as a table.

use super::budget::{self, readable};
use super::failure::Failure;
use super::growing::{self, Drawn};
use super::report::Phase;
use super::studio::{Run, Studio};
use crate::color::Rgb;
use crate::integrator::interception::{
    Interception, InterceptionError, Lighting, OrganLight, SensorField, Wanted,
};
use crate::integrator::photon::Plot;
use crate::integrator::requirements::Requirements;
use crate::integrator::{CancelToken, RenderContext};
use crate::interpret::Organs;
use crate::options::Options;
use crate::scene::Scene;
use glam::DVec2;
use std::fmt::Write;
use std::sync::Arc;

/// Batches of photons from whose differences standard errors are learnt.
const BATCHES: u32 = 16;
/// Scatterings after which a photon is given up where the options set no limit: only in closed rooms of mirrors.
const MOST_SCATTERINGS: u32 = 10_000;
/// How often a plot is put beside itself to each side at most.
const MOST_NEIGHBOURS: u32 = 20;

/// What a table of light begins with.
pub const FIRST_COLUMNS: &str = "organ,node,module";
/// What it goes on with: powers in W, each by red, green and blue, their sum and its standard error.
const OTHER_COLUMNS: &str = "copies,area_m2,hits,\
    absorbed_red,absorbed_green,absorbed_blue,absorbed,absorbed_error,\
    reflected_red,reflected_green,reflected_blue,reflected,reflected_error,\
    transmitted_red,transmitted_green,transmitted_blue,transmitted,transmitted_error,\
    received_front,received_back,received,received_error,\
    sensed_red,sensed_green,sensed_blue,sensed,plant";

/// The light on a grown model.
#[derive(Debug)]
pub struct FoundLight {
    /// What was found.
    pub lighting: Lighting,
    organs: Arc<Organs>,
    /// Surface of each organ, m², if it could be told.
    areas: Option<Vec<f64>>,
    /// What the sensors of each organ read on average, W/m².
    sensed: Vec<Option<Rgb>>,
    /// Whether a wanted error was asked for.
    has_wish: bool,
    /// The plant of each organ, if it belongs to one.
    plants: Vec<Option<u32>>,
}

/// Grows the model of a run and counts the light on its organs.
///
/// # Errors
/// If any stage fails, the plot is impossible, or it was stopped.
pub fn light(
    studio: &mut Studio<'_>,
    run: &Run,
    cancel: &CancelToken,
) -> Result<FoundLight, Failure> {
    let drawn = studio.draw_for_light(run, cancel)?;
    let (world, organs) = (studio.world, drawn.organs.clone());
    let mut plants: Vec<Option<u32>> = drawn.plants.iter().copied().map(Some).collect();
    let sensors = SensorField::new(drawn.sensors.clone())
        .map_err(|error| growing::blame(run, &organs, &error))?;
    let (scene, plot, areas) = build_telling(studio, run, drawn)?;

    for plane in scene.planes() {
        // The ground is no plant: how much light falls on it has no end.
        if let Some(plant) = plants.get_mut(plane.owner.0 as usize) {
            *plant = None;
        }
    }
    let how = settings(&run.options, budget::memory(world, &run.options), plants);
    let audience = studio.audience.clone();
    audience.begins("tracing light");
    let context = RenderContext {
        seed: run.options.seed.value.cast_unsigned(),
        cancel,
        progress: &|progress| audience.progress(progress.done, progress.total),
    };
    let n_organs = organs.list().len();
    let lighting = studio.seconds.time(world, Phase::Render, || {
        how.solve(&scene, n_organs, &sensors, plot, &context)
    });
    audience.ends();
    let lighting = lighting.map_err(|error| match error {
        InterceptionError::Cancelled => Failure::Stopped,
        InterceptionError::Memory { organs, bytes } => Failure::World(format!(
            "the light on {organs} organs needs {} of memory, more than `--max-memory` allows",
            readable(bytes)
        )),
    })?;
    Ok(FoundLight {
        sensed: readings(&sensors, &lighting, n_organs),
        lighting,
        organs,
        areas,
        has_wish: how.wanted != Wanted::default(),
        plants: how.plants,
    })
}

/// Grows the model of a run and looks at what counting the light on its organs requires.
///
/// # Errors
/// If the model cannot be grown, the plot is impossible, or it was stopped.
pub fn requirements(
    studio: &mut Studio<'_>,
    run: &Run,
    cancel: &CancelToken,
) -> Result<Requirements, Failure> {
    let drawn = studio.draw_for_light(run, cancel)?;
    let (scene, ..) = build_telling(studio, run, drawn)?;
    Ok(Requirements::of(&scene, run.options.require.value))
}

fn settings(options: &Options, memory: u64, plants: Vec<Option<u32>>) -> Interception {
    Interception {
        photons: options.photons.value.get(),
        batches: BATCHES,
        max_depth: options.max_depth.value.unwrap_or(MOST_SCATTERINGS),
        wanted: Wanted {
            of_organs: options.organ_error.value.map(|wanted| wanted.0),
            of_plants: options.plant_error.value.map(|wanted| wanted.0),
            of_total: options.total_error.value.map(|wanted| wanted.0),
        },
        most_photons: options.most_photons.value.get(),
        memory,
        plants,
        kept: options.require.value,
    }
}

/// The scene that light is traced in, the plot it stands in, and the areas of its organs.
type Built = (Scene, Option<Plot>, Option<Vec<f64>>);

/// Builds the scene, and says so.
fn build_telling(studio: &mut Studio<'_>, run: &Run, drawn: Drawn) -> Result<Built, Failure> {
    studio.audience.begins("building the scene");
    let built = studio
        .seconds
        .time(studio.world, Phase::Accel, || build(run, drawn));
    studio.audience.ends();
    built
}

fn build(run: &Run, drawn: Drawn) -> Result<Built, Failure> {
    let blame = |error| growing::blame(run, &drawn.organs, &error);
    let n_organs = drawn.organs.list().len();
    let Some(size) = run.options.periodic.value else {
        let scene = Scene::build(drawn.scene).map_err(blame)?;
        let areas = scene.areas(n_organs);
        return Ok((scene, None, areas));
    };
    let single = Scene::build(drawn.scene.clone()).map_err(blame)?;
    let (bounds, areas) = (single.bounds(), single.areas(n_organs));
    let shines = !single.emitters().is_empty();
    drop(single);
    let (plot, times) = plot_of(size.0, bounds, shines)?;
    let scene = drawn.scene.beside_itself(size.0, times);
    Ok((Scene::build(scene).map_err(blame)?, Some(plot), areas))
}

/// The plot of this size round a model, and how often it must be put beside itself to each side.
fn plot_of(
    size: DVec2,
    bounds: crate::math::Bounds3,
    shines: bool,
) -> Result<(Plot, [u32; 2]), Failure> {
    let usage = |text: &str| Failure::Usage(format!("`periodic` {},{}: {text}", size.x, size.y));
    let plot = Plot::new(size, bounds).ok_or_else(|| usage("the model is empty"))?;
    let times = plot.overhang(&bounds);
    if times.iter().any(|n| *n > MOST_NEIGHBOURS) {
        return Err(usage(
            "the plot is much smaller than the model; is it in metres?",
        ));
    }
    if times != [0; 2] && shines {
        return Err(usage(
            "the model hangs over the sides of the plot, which it may not if surfaces of it shine; make the plot larger",
        ));
    }
    Ok((plot, times))
}

/// What the sensors of each organ read on average, W/m².
fn readings(sensors: &SensorField, lighting: &Lighting, n_organs: usize) -> Vec<Option<Rgb>> {
    let mut sums = vec![(0_u32, Rgb::BLACK); n_organs];
    for (sensor, reading) in sensors.sensors().iter().zip(&lighting.sensed) {
        if let Some((n, sum)) = sums.get_mut(sensor.organ.0 as usize) {
            *n += 1;
            *sum += *reading;
        }
    }
    let mean = |(n, sum): (u32, Rgb)| (n > 0).then(|| sum / f64::from(n));
    sums.into_iter().map(mean).collect()
}

impl FoundLight {
    /// The table: a row for each organ, those of a grid of copies as the mean over these.
    #[must_use]
    pub fn csv(&self) -> String {
        let mut out = format!("{FIRST_COLUMNS},{OTHER_COLUMNS}\n");
        let lit = self.organs.list().iter().zip(&self.lighting.organs);
        for (number, (organ, light)) in (0_u32..).zip(lit) {
            let id = crate::scene::description::OrganId(number);
            let name = self.organs.type_name(id).unwrap_or("?");
            let _ = write!(
                out,
                "{number},{},{name},{}",
                organ.node.index(),
                organ.copies
            );
            let share = 1.0 / organ.copies.max(1) as f64;
            let area = self
                .areas
                .as_ref()
                .and_then(|areas| areas.get(number as usize));
            push(&mut out, area.map(|area| area * share));
            let _ = write!(out, ",{}", light.hits);
            push_light(&mut out, light, share);
            let sensed = self.sensed.get(number as usize).copied().flatten();
            let bands = sensed.map(Rgb::to_array);
            for band in 0..3 {
                push(&mut out, bands.map(|bands| bands[band]));
            }
            push(&mut out, sensed.map(|sensed| sensed.sum()));
            let plant = self.plants.get(number as usize).copied().flatten();
            push(&mut out, plant.map(f64::from));
            out.push('\n');
        }
        out
    }

    /// A line for the terminal.
    #[must_use]
    pub fn summary(&self) -> String {
        let Lighting {
            total, rest, books, ..
        } = &self.lighting;
        let watts = |power: Rgb| format!("{} W", rounded(power.sum(), 4));
        let elsewhere = if rest.hits > 0 {
            format!(", {} by the ground", watts(rest.absorbed))
        } else {
            String::new()
        };
        let wish = match (self.has_wish, self.lighting.is_reached) {
            (false, _) => "",
            (true, true) => ", the wanted error is reached",
            (true, false) => ", THE WANTED ERROR IS NOT REACHED: `--most-photons` allows more",
        };
        format!(
            "{} organs absorb {} ± {}{elsewhere}; of {} emitted towards the model {} escaped, {} lost; {} photons{wish}",
            self.lighting.organs.len(),
            watts(total.absorbed),
            rounded(total.errors.absorbed, 2),
            watts(books.emitted),
            watts(books.escaped),
            watts(books.lost),
            self.lighting.n_photons,
        )
    }
}

fn push_light(out: &mut String, light: &OrganLight, share: f64) {
    let errors = &light.errors;
    let kinds = [
        (light.absorbed, errors.absorbed),
        (light.reflected, errors.reflected),
        (light.transmitted, errors.transmitted),
    ];
    for (power, error) in kinds {
        for band in power.to_array() {
            push(out, Some(band * share));
        }
        push(out, Some(power.sum() * share));
        push(out, Some(error * share));
    }
    let sides = light.received.map(|power| power.sum() * share);
    for side in sides {
        push(out, Some(side));
    }
    push(out, Some(sides[0] + sides[1]));
    push(out, Some(errors.received * share));
}

/// Appends a number, or nothing where there is none.
fn push(out: &mut String, number: Option<f64>) {
    out.push(',');
    if let Some(number) = number {
        let _ = write!(out, "{}", rounded(number, 9));
    }
}

/// A number to so many digits, 0 without a sign.
fn rounded(number: f64, digits: usize) -> f64 {
    let text = format!("{number:.*e}", digits.saturating_sub(1));
    text.parse::<f64>().map_or(number, |number| number + 0.0)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::math::Bounds3;
    use glam::DVec3;

    #[test]
    fn numbers_are_rounded_to_digits_that_mean_something() {
        assert_eq!(rounded(1.234_567_890_123, 9), 1.234_567_89);
        assert_eq!(rounded(-0.0, 9).to_string(), "0");
        assert_eq!(rounded(123_456.0, 2), 120_000.0);
    }

    #[test]
    fn impossible_plots_are_refused() {
        let bounds = Bounds3::of([DVec3::ZERO, DVec3::new(3.0, 1.0, 1.0)]);
        let size = DVec2::new(2.0, 2.0);
        assert_eq!(plot_of(size, bounds, false).unwrap().1, [1, 0]);
        assert!(plot_of(size, bounds, true).is_err());
        assert!(plot_of(size * 1e-3, bounds, false).is_err());
        assert!(plot_of(size, Bounds3::EMPTY, false).is_err());
    }
}
