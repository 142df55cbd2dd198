//! `trade`: what accuracy costs.

use super::args::TradeArgs;
use super::commands::{check_wishes, explain_scene, run, studio};
use super::shell::Shell;
use crate::options::Command;
use crate::pipeline::failure::Failure;
use crate::trade::figures::percent;
use crate::trade::results::Findings;
use crate::trade::{self, Folder, Means, Plan, front};

/// `trade`: measures, and writes table, plots, page and presets.
pub(super) fn trade(shell: &Shell, args: &TradeArgs) -> Result<(), Failure> {
    let output = match &args.output {
        _ if args.manners.explain_options => {
            return shell.explain(&args.model.model, Command::Trade);
        }
        Some(output) if !args.scene.explain_scene => output,
        _ => return explain_scene(shell, &args.model, |user| user != "light"),
    };
    let plan = Plan {
        budget: f64::from(args.budget),
        seeds: args.seeds,
    };
    let mut studio = studio(shell, &args.model)?;
    run(shell, &mut studio, |studio, run| {
        check_wishes(&shell.world, run)?;
        let folder = Folder::open(&shell.world, output)?;
        let means = Means {
            world: &shell.world,
            audience: &*shell.terminal,
            cancel: &shell.cancel,
        };
        let findings = trade::measure(studio, run, (&folder, plan), means)?;
        trade::write_all(&folder, &findings)?;
        for line in summary(&folder, &findings) {
            shell.terminal.note(&line);
        }
        Ok(())
    })
}

/// Where the page is, and the presets.
fn summary(folder: &Folder<'_>, findings: &Findings) -> Vec<String> {
    let page = folder.path().join("index.html");
    let n: usize = findings
        .families
        .iter()
        .map(|ladder| ladder.rungs.len())
        .sum();
    let mut lines = vec![format!(
        "{}: {n} settings, {} seeds each, in {:.0} s; reference: {} samples per pixel by {}, its noise {:.2} %",
        page.display(),
        findings.seeds,
        findings.used,
        findings.reference.samples,
        findings.reference.method,
        percent(findings.reference.noise)
    )];
    for (name, point) in front::presets(findings) {
        lines.push(format!(
            "{name:>8}: {:.2} s, error {:.1} %: {}",
            point.seconds,
            percent(point.rung.resolved_error()),
            point.ladder.name
        ));
    }
    lines
}
