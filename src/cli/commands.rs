//! The commands that run once.

use super::args::{
    CheckArgs, DeriveArgs, ExportArgs, LightArgs, ModelArg, Print, RenderArgs, SolutionArgs,
};
use super::shell::Shell;
use crate::diag::render;
use crate::growth::Growth;
use crate::options::Command;
use crate::options::value::Renderer;
use crate::pipeline::budget;
use crate::pipeline::choosing::Wish;
use crate::pipeline::exporting;
use crate::pipeline::failure::Failure;
use crate::pipeline::growing;
use crate::pipeline::lighting;
use crate::pipeline::making::{Made, Partial};
use crate::pipeline::report::{LIGHT_REPORT_KEYS, LightReport, Phase};
use crate::pipeline::solving::SolutionFiles;
use crate::pipeline::store::{CsvTarget, GlbTarget, JsonTarget, PictureTarget, SolutionTarget};
use crate::pipeline::studio::{Keep, Run, Studio};
use crate::pipeline::viewpoint;
use crate::pipeline::world::World;
use std::path::Path;

/// Keys by which an earlier file of `derive --json` is known.
const DERIVE_KEYS: &[&str] = &["step", "modules", "total", "hash"];

/// `check`: reads and checks, writes nothing.
pub(super) fn check(shell: &Shell, args: &CheckArgs) -> Result<(), Failure> {
    let path = &args.model.model;
    let mut studio = studio(shell, &args.model)?;
    let opened = studio.read(&shell.flags)?;
    let options = opened.options.clone();
    let run = shell.on_threads(&options, || studio.check(opened))?;
    let odd = if run.warnings.is_empty() {
        String::new()
    } else {
        format!(", {}", render::summary(&run.warnings))
    };
    shell
        .terminal
        .note(&format!("{}: no errors{odd}", path.display()));
    Ok(())
}

/// `derive`: grows and prints.
pub(super) fn derive(shell: &Shell, args: &DeriveArgs) -> Result<(), Failure> {
    let path = &args.model.model;
    if args.manners.explain_options {
        return shell.explain(path, Command::Derive);
    }
    let json = args.json.as_deref();
    let json = json
        .map(|json| JsonTarget::new(&shell.world, json, DERIVE_KEYS))
        .transpose()?;
    let mut studio = studio(shell, &args.model)?;
    run(shell, &mut studio, |studio, run| {
        let growth = studio.grow(run, &shell.cancel)?;
        if let Some(what) = args.print {
            shell.terminal.print(&printed(&growth, what));
        }
        let seconds = studio.seconds.derive;
        let census = growing::census(&growth, run.options.seed.value, seconds);
        if let Some(json) = &json {
            json.write(&shell.world, &census)?;
        }
        let (step, total) = (growth.steps(), growth.total());
        let steps = if step == 1 { "step" } else { "steps" };
        shell.terminal.note(&format!(
            "{total} modules after {step} {steps} ({seconds:.2} s)"
        ));
        Ok(())
    })
}

fn printed(growth: &Growth, what: Print) -> String {
    let mut text = match what {
        Print::Tree => growth.tree_text(),
        Print::Counts => {
            let counts = growth.counts();
            counts
                .into_iter()
                .map(|(name, count)| format!("{name} {count}\n"))
                .collect()
        }
        Print::String => growth.string_text(),
    };
    if !text.ends_with('\n') {
        text.push('\n');
    }
    text
}

/// `render`: one picture.
pub(super) fn render(shell: &Shell, args: &RenderArgs) -> Result<(), Failure> {
    let path = &args.model.model;
    let output = match &args.output {
        _ if args.manners.explain_options => return shell.explain(path, Command::Render),
        Some(output) if !args.scene.explain_scene => output,
        _ => return explain_scene(shell, &args.model, |_| true),
    };
    let target = PictureTarget::new(&shell.world, output)?;
    let report = shell.report_target(args.report.as_deref())?;
    let mut studio = studio(shell, &args.model)?;
    studio.solution_files = solution_files(shell, &args.light, output)?;
    run(shell, &mut studio, |studio, run| {
        studio.solution_files.check(&run.options)?;
        Wish::check(&run.options, args.light.has_files())?;
        check_wishes(&shell.world, run)?;
        let made = shell.making(Partial::Keep).picture(studio, run, &target)?;
        shell.report(report.as_ref(), run, studio, &made)?;
        shell
            .terminal
            .note(&summary(target.path(), run, studio, &made));
        for note in &made.notes {
            shell.terminal.note(note);
        }
        finished(&made)
    })
}

/// `--explain-scene`: what the scene requires of some users, and nothing else.
pub(super) fn explain_scene(
    shell: &Shell,
    model: &ModelArg,
    is_asked: impl Fn(&str) -> bool + Send,
) -> Result<(), Failure> {
    let mut studio = studio(shell, model)?;
    run(shell, &mut studio, |studio, run| {
        studio.build(run, &shell.cancel)?;
        if let Some(requirements) = studio.requirements(run) {
            shell.terminal.print(&requirements.table_for(is_asked));
        }
        Ok(())
    })
}

/// `export`: the lit surfaces.
pub(super) fn export(shell: &Shell, args: &ExportArgs) -> Result<(), Failure> {
    let path = &args.model.model;
    let output = match &args.output {
        _ if args.manners.explain_options => return shell.explain(path, Command::Export),
        Some(output) if !args.scene.explain_scene => output,
        _ => return explain_scene(shell, &args.model, |_| true),
    };
    let target = GlbTarget::new(&shell.world, output)?;
    let mut studio = studio(shell, &args.model)?;
    studio.solution_files = solution_files(shell, &args.light, output)?;
    run(shell, &mut studio, |studio, run| {
        exporting::check(&run.options)?;
        studio.solution_files.check(&run.options)?;
        viewpoint::check(&run.sources, &run.options)?;
        let exported = shell.making(Partial::Drop).surfaces(studio, run, &target)?;
        shell.terminal.note(&format!(
            "{}: {} triangles, {} corners ({})",
            output.display(),
            exported.n_triangles,
            exported.n_corners,
            studio.seconds.summary()
        ));
        Ok(())
    })
}

/// `light`: the light on each organ.
pub(super) fn light(shell: &Shell, args: &LightArgs) -> Result<(), Failure> {
    let path = &args.model.model;
    let output = match &args.output {
        _ if args.manners.explain_options => return shell.explain(path, Command::Light),
        Some(output) if !args.scene.explain_scene => output,
        _ => return explain_light(shell, &args.model),
    };
    let target = CsvTarget::new(&shell.world, output, lighting::FIRST_COLUMNS)?;
    let report = args.report.as_deref();
    let report = report
        .map(|report| JsonTarget::new(&shell.world, report, LIGHT_REPORT_KEYS))
        .transpose()?;
    let mut studio = studio(shell, &args.model)?;
    run(shell, &mut studio, |studio, run| {
        let found = lighting::light(studio, run, &shell.cancel)?;
        let hash = studio.seconds.time(&shell.world, Phase::Write, || {
            target.write(&shell.world, &found.csv())
        })?;
        if let Some(report) = &report {
            let told = LightReport::new(&shell.world, run, &studio.seconds, &found, hash);
            report.write(&shell.world, &told)?;
        }
        let (file, seconds) = (output.display(), studio.seconds.summary());
        shell
            .terminal
            .note(&format!("{file}: {} ({seconds})", found.summary()));
        Ok(())
    })
}

/// `light --explain-scene`: what the scene that light is counted in requires, and nothing else.
fn explain_light(shell: &Shell, model: &ModelArg) -> Result<(), Failure> {
    let mut studio = studio(shell, model)?;
    run(shell, &mut studio, |studio, run| {
        let requirements = lighting::requirements(studio, run, &shell.cancel)?;
        let table = requirements.table_for(|user| user == "light");
        shell.terminal.print(&table);
        Ok(())
    })
}

/// Reads and checks the model of `studio` and works on it, on the threads that its options ask for.
pub(super) fn run<T: Send>(
    shell: &Shell,
    studio: &mut Studio<'_>,
    work: impl FnOnce(&mut Studio<'_>, &mut Run) -> Result<T, Failure> + Send,
) -> Result<T, Failure> {
    let opened = studio.read(&shell.flags)?;
    let options = opened.options.clone();
    shell.on_threads(&options, || {
        let mut run = studio.check(opened)?;
        work(studio, &mut run)
    })
}

/// A line about a picture that was written.
pub(super) fn summary(path: &Path, run: &Run, studio: &Studio<'_>, made: &Made) -> String {
    let error = match made.effort.error {
        Some(error) => format!(", estimated error {}", error.text()),
        // Path tracing is what other methods are judged by.
        None if run.options.renderer.value != Renderer::Path && made.is_whole => {
            ", error unknown (light is focused that path tracing does not find)".into()
        }
        None => String::new(),
    };
    let size = run.options.size.value;
    format!(
        "{}: {}x{}, {} samples per pixel{error}, seed {} ({})",
        path.display(),
        size.width,
        size.height,
        made.effort.samples_per_pixel,
        run.options.seed.value,
        studio.seconds.summary()
    )
}

/// Refuses what cannot be shown, before the model is grown.
pub(super) fn check_wishes(world: &dyn World, run: &Run) -> Result<(), Failure> {
    budget::check_picture(world, &run.options)?;
    viewpoint::check(&run.sources, &run.options)
}

pub(super) fn studio<'s>(shell: &'s Shell, model: &ModelArg) -> Result<Studio<'s>, Failure> {
    let path = model.model.clone();
    let mut studio = Studio::new(&shell.world, shell.terminal.clone(), path, Keep::Last);
    studio.access = model.access()?;
    studio.changes = model.changes()?;
    Ok(studio)
}

/// Where the light that all cameras share comes from and goes to.
pub(super) fn solution_files(
    shell: &Shell,
    args: &SolutionArgs,
    output: &Path,
) -> Result<SolutionFiles, Failure> {
    let save = args.save_solution.as_deref();
    if save == Some(output) {
        let message = "the picture and the solution cannot be the same file";
        return Err(Failure::Usage(message.into()));
    }
    let save = save.map(|save| SolutionTarget::new(&shell.world, save));
    Ok(SolutionFiles {
        read: args.solution.clone(),
        save: save.transpose()?,
    })
}

pub(super) fn finished(made: &Made) -> Result<(), Failure> {
    if made.is_whole {
        Ok(())
    } else {
        Err(Failure::Stopped)
    }
}
