//! `fly`: films.

use super::args::FlyArgs;
use super::commands::{check_wishes, finished, run, solution_files, studio};
use super::shell::Shell;
use crate::animation::FilmShape;
use crate::options::Command;
use crate::pipeline::course;
use crate::pipeline::failure::Failure;
use crate::pipeline::making::{Made, Partial};
use crate::pipeline::reel::Reel;

/// `fly`: the frames of a film, and the film.
pub(super) fn fly(shell: &Shell, args: &FlyArgs) -> Result<(), Failure> {
    let path = &args.model.model;
    let output = match &args.output {
        Some(output) if !args.manners.explain_options => output,
        _ => return shell.explain(path, Command::Fly),
    };
    let reel = Reel::new(&shell.world, output)?;
    let report = shell.report_target(args.report.as_deref())?;
    let mut studio = studio(shell, &args.model)?;
    studio.solution_files = solution_files(shell, &args.light, output)?;
    run(shell, &mut studio, |studio, run| {
        studio.solution_files.check(&run.options)?;
        course::check(&run.options)?;
        let shape = course::shape(&run.options);
        let reel = reel.with(run.options.frame_format.value, shape)?;
        check_wishes(&shell.world, run)?;
        if let Some(view) = course::decided(&run.options) {
            // What needs no scene is refused before there is a folder.
            course::cameras(run, &course::flight(&run.options, view))?;
        }
        reel.open(&shell.world)?;
        let made = shell.making(Partial::Drop).film(studio, run, &reel)?;
        shell.report(report.as_ref(), run, (&studio.seconds, studio.work), &made)?;
        let seconds = studio.seconds.summary();
        for line in summary(&reel, shape, &made, &seconds) {
            shell.terminal.note(&line);
        }
        finished(&made)
    })
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
