//! `fly`: films.

use super::args::FlyArgs;
use super::cluster;
use super::commands::{check_wishes, explain_scene, finished, run, solution_files, studio};
use super::shell::Shell;
use crate::animation::FilmShape;
use crate::image::{Format, Picture};
use crate::options::Command;
use crate::pipeline::choosing::Wish;
use crate::pipeline::course;
use crate::pipeline::failure::Failure;
use crate::pipeline::making::{Made, Partial};
use crate::pipeline::reel::Reel;
use crate::pipeline::store::{PictureTarget, ScriptTarget};
use crate::pipeline::studio::Run;
use std::path::Path;

/// `fly`: the frames of a film, and the film.
pub(super) fn fly(shell: &Shell, args: &FlyArgs) -> Result<(), Failure> {
    let path = &args.model.model;
    if args.manners.explain_options {
        return shell.explain(path, Command::Fly);
    }
    if args.scene.explain_scene {
        return explain_scene(shell, &args.model, |_| true);
    }
    let plan = picture_target(shell, args.plan.as_deref())?;
    let Some(output) = &args.output else {
        return match plan {
            Some(plan) => draw_plan(shell, args, &plan),
            None => shell.explain(path, Command::Fly),
        };
    };
    let reel = Reel::new(&shell.world, output)?;
    let sheet = picture_target(shell, args.sheet.as_deref())?;
    let report = shell.report_target(args.report.as_deref())?;
    let script = args.slurm.as_deref();
    let script = script
        .map(|script| ScriptTarget::new(&shell.world, script))
        .transpose()?;
    let mut studio = studio(shell, &args.model)?;
    studio.solution_files = solution_files(shell, &args.light, output)?;
    run(shell, &mut studio, |studio, run| {
        studio.solution_files.check(&run.options)?;
        Wish::check(&run.options, args.light.has_files())?;
        let shape = check(shell, run)?;
        let reel = reel.with(run.options.frame_format.value, shape)?;
        if let Some(script) = &script {
            return write_script(shell, run, output, script);
        }
        if let Some(plan) = &plan {
            let map = shell.making(Partial::Drop).plan(studio, run)?;
            put(shell, plan, &map, run)?;
        }
        reel.open(&shell.world)?;
        let made = shell.making(Partial::Drop).film(studio, run, &reel)?;
        shell.report(report.as_ref(), run, studio, &made)?;
        if let Some(sheet) = sheet.as_ref().filter(|_| made.is_whole) {
            let frames = run.options.frames.value.clone();
            let frames = frames.unwrap_or(0..shape.n_frames);
            put(shell, sheet, &reel.sheet(&shell.world, shape, frames)?, run)?;
        }
        let seconds = studio.seconds.summary();
        for line in summary(&reel, shape, &made, &seconds) {
            shell.terminal.note(&line);
        }
        for note in &made.notes {
            shell.terminal.note(note);
        }
        finished(&made)
    })
}

/// Refuses what cannot be a film before the model is grown, as far as that can be known.
fn check(shell: &Shell, run: &Run) -> Result<FilmShape, Failure> {
    course::check(&run.options)?;
    check_wishes(&shell.world, run)?;
    if let Some(view) = course::decided(&run.options) {
        course::cameras(run, &course::flight(&run.options, view))?;
    }
    Ok(course::shape(&run.options))
}

/// A map or a sheet to be: an ordinary picture.
fn picture_target(shell: &Shell, path: Option<&Path>) -> Result<Option<PictureTarget>, Failure> {
    let Some(path) = path else { return Ok(None) };
    let target = PictureTarget::new(&shell.world, path)?;
    match target.format() {
        Format::Png | Format::Jpeg | Format::Webp => Ok(Some(target)),
        Format::Exr | Format::Hdr => Err(Failure::Usage(format!(
            "`{}` would hold radiances: maps and sheets are .png, .jpg or .webp",
            path.display()
        ))),
    }
}

fn put(shell: &Shell, target: &PictureTarget, picture: &Picture, run: &Run) -> Result<(), Failure> {
    target.write(&shell.world, picture, &run.texts())?;
    shell.terminal.note(&format!(
        "{}: {}x{}",
        target.path().display(),
        picture.width,
        picture.height
    ));
    Ok(())
}

/// Only the map.
fn draw_plan(shell: &Shell, args: &FlyArgs, plan: &PictureTarget) -> Result<(), Failure> {
    let mut studio = studio(shell, &args.model)?;
    run(shell, &mut studio, |studio, run| {
        check(shell, run)?;
        let map = shell.making(Partial::Drop).plan(studio, run)?;
        put(shell, plan, &map, run)
    })
}

/// Only the script for a cluster.
fn write_script(
    shell: &Shell,
    run: &Run,
    output: &Path,
    target: &ScriptTarget,
) -> Result<(), Failure> {
    let here = |error: std::io::Error| {
        Failure::World(format!("cannot tell where this program is: {error}"))
    };
    let n_frames = course::shape(&run.options).n_frames;
    let words = cluster::without_parts(&shell.words);
    let text = cluster::script(&cluster::Plan {
        program: &std::env::current_exe().map_err(here)?,
        folder: &std::env::current_dir().map_err(here)?,
        words: &words,
        output,
        n_frames,
        options: &run.options,
    });
    target.write(&shell.world, &text)?;
    let file = target.path().display();
    shell.terminal.note(&format!(
        "{file}: {n_frames} frames; submit it with `bash {file}`"
    ));
    Ok(())
}

/// Lines about a film.
fn summary(reel: &Reel, shape: FilmShape, made: &Made, seconds: &str) -> Vec<String> {
    let kept = match made.n_kept {
        0 => String::new(),
        n => format!(", {n} kept"),
    };
    let frames = format!("{} frames made{kept} ({seconds})", made.n_made);
    let folder = reel.folder().display();
    let mut lines = Vec::new();
    match reel.film() {
        Some(film) if made.has_film => {
            let FilmShape {
                width,
                height,
                fps,
                n_frames,
            } = shape;
            let length = f64::from(n_frames) / f64::from(fps);
            lines.push(format!(
                "{}: {width}x{height}, {n_frames} frames, {fps} per second, {length:.2} s; {frames}",
                film.display()
            ));
            lines.push(format!("its frames are in {folder}, which can be removed"));
        }
        Some(film) if made.is_whole => {
            lines.push(format!("{folder}: {frames}"));
            lines.push(format!(
                "{} is written once all {} frames are there",
                film.display(),
                shape.n_frames
            ));
        }
        _ => lines.push(format!("{folder}: {frames}")),
    }
    if let Some(flicker) = made.flicker {
        lines.push(format!(
            "flicker {:.2} of 255 levels ({:.2} with new random numbers in each frame), of a change of {:.2} from frame to frame",
            flicker.flicker, flicker.flicker_with_new_noise, flicker.change
        ));
    }
    lines
}
